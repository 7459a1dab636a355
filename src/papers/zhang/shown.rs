//! What Zhang, Manocha, Hudson and Hoff show, and what of it is ours.

use crate::papers::keys::OCCLUSION_MAPS;
use crate::papers::shown::{Ours, Own, Shown};

/// Its figures, plates and tables, in its own order.
pub const SHOWN: &[Shown] = &[
    Shown {
        number: "Figure 1",
        what: "A model from above in three colors: occluders, what is kept, what is culled",
        ours: &[Ours::Figure("zhang-figure-1")],
        instead: "the submarine's machine room is not public; a game level takes its place, and a \
            generated machine room in Figure 13",
    },
    Shown {
        number: "Figure 2",
        what: "The pipeline in two phases: making the maps, culling with them",
        ours: &[Ours::Figure("zhang-figure-2")],
        instead: "",
    },
    Shown {
        number: "Figure 3",
        what: "The hierarchy of maps, with the pixels that belong to one pixel of the top",
        ours: &[Ours::Figure("zhang-figure-3")],
        instead: "the torus is left out: the occluders of a street take its place, so that the levels \
            are those of a frame",
    },
    Shown {
        number: "Figure 4",
        what: "Averaging a map by drawing it as a texture at half its size",
        ours: &[Ours::Figure("zhang-figure-4")],
        instead: "",
    },
    Shown {
        number: "Figure 5",
        what: "Where the nearest objects are not the best occluders",
        ours: &[Ours::Figure("zhang-figure-5")],
        instead: "",
    },
    Shown {
        number: "Figure 6",
        what: "Trees before a house, the holes among their leaves, and the maps",
        ours: &[Ours::Figure("zhang-figure-6")],
        instead: "the model is not public; generated trees and a generated house take its place",
    },
    Shown {
        number: "Figure 7",
        what: "The trees' view without approximate culling and with it",
        ours: &[Ours::Figure("zhang-figure-7")],
        instead: "the model is not public; a forest in flatland shows what small gaps let through, and \
            the table zhang-thresholds counts it in space",
    },
    Shown {
        number: "Figure 8",
        what: "The overlap test as pseudocode",
        ours: &[
            Ours::Own(Own {
                name: "zhang-figure-8-pseudocode",
                scene: "scenes2d/holes.json",
                method: OCCLUSION_MAPS,
                more: &["--first-hidden", "--picture", "pseudocode"],
            }),
            Ours::Figure("zhang-figure-8"),
        ],
        instead: "",
    },
    Shown {
        number: "Figure 9",
        what: "Frame rate and share culled along paths through three models",
        ours: &[Ours::Figure("zhang-figure-9"), Ours::Table("zhang-frames")],
        instead: "the three models are not public; a generated city, swarm and machine room of as many \
            polygons take their place, and times are those of the machine at hand",
    },
    Shown {
        number: "Figure 10",
        what: "The time of a frame by stage, as a share of the time without occlusion culling",
        ours: &[Ours::Figure("zhang-figure-10"), Ours::Table("zhang-stages")],
        instead: "the same models; the figure counts what is drawn, the table measures times",
    },
    Shown {
        number: "Figure 11",
        what: "The city from above",
        ours: &[Ours::Figure("zhang-figure-11")],
        instead: "the model of London is not public; a generated city takes its place",
    },
    Shown {
        number: "Figure 12",
        what: "Moving animals and teapots",
        ours: &[Ours::Figure("zhang-figure-12")],
        instead: "the model is not public; a generated swarm of animals and teapots takes its place",
    },
    Shown {
        number: "Figure 13",
        what: "The machine room from above",
        ours: &[Ours::Figure("zhang-figure-13")],
        instead: "the model is not public; a generated machine room takes its place",
    },
];
