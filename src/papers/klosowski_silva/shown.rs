//! What Klosowski and Silva show, and what of it is ours.

use crate::papers::keys::LAYERED_PROJECTION;
use crate::papers::shown::{Ours, Own, Shown};

/// Its figures, plates and tables, in its own order.
pub const SHOWN: &[Shown] = &[
    Shown {
        number: "Figure 1",
        what: "An office with cells that were projected and cells, such as those behind the desk, that \
            were not",
        ours: &[Ours::Figure("klosowski-silva-figure-2")],
        instead: "the model of the office is not public; a generated seminar room takes its place, the \
            same as in Figure 2",
    },
    Shown {
        number: "Figure 2",
        what: "The traversal stopped in a seminar room, over Delaunay cells and over an octree",
        ours: &[Ours::Figure("klosowski-silva-figure-2")],
        instead: "the room of Soda Hall is not public; a generated one with as many triangles takes its \
            place",
    },
    Shown {
        number: "Figure 3",
        what: "From a car to an octree over its vertices to a triangulation of the leaves' centers",
        ours: &[Ours::Figure("klosowski-silva-figure-3"), Ours::Figure("klosowski-silva-figure-3-space")],
        instead: "the model of the car is not public; a generated one takes its place, and flatland \
            shows each stage flat",
    },
    Shown {
        number: "Figure 4",
        what: "The loop over the front as pseudocode",
        ours: &[Ours::Own(Own {
            name: "klosowski-silva-figure-4",
            scene: "scenes2d/bottleneck.json",
            method: LAYERED_PROJECTION,
            more: &["--set", "rules=paper", "--step", "26", "--picture", "pseudocode"],
        })],
        instead: "",
    },
    Shown {
        number: "Figure 5",
        what: "How the solidity of a cell is updated, as pseudocode",
        ours: &[Ours::Own(Own {
            name: "klosowski-silva-figure-5",
            scene: "scenes2d/bottleneck.json",
            method: LAYERED_PROJECTION,
            more: &["--set", "rules=paper", "--step", "1401", "--picture", "pseudocode"],
        })],
        instead: "",
    },
    Shown {
        number: "Figure 6",
        what: "How solidity is handed on from a cell to its two neighbors",
        ours: &[Ours::Figure("klosowski-silva-figure-6")],
        instead: "",
    },
    Shown {
        number: "Figure 7",
        what: "Four moments of a traversal in flatland, past a bottleneck",
        ours: &[Ours::Figure("klosowski-silva-figure-7")],
        instead: "",
    },
    Shown {
        number: "Figure 8",
        what: "The window of the authors' program",
        ours: &[],
        instead: "shows no algorithm: our own window, `cullscope explore scenes2d/bottleneck.json \
            --method layered-projection`, takes its place",
    },
    Shown {
        number: "Figure 9",
        what: "Neighbors in an octree across its levels",
        ours: &[Ours::Figure("klosowski-silva-figure-9")],
        instead: "",
    },
    Shown {
        number: "Figure 10",
        what: "A city: visible triangles found and time by frame for four budgets, and images of all \
            that is visible and of a tenth",
        ours: &[Ours::Figure("klosowski-silva-figure-10"), Ours::Table("klosowski-silva-frames")],
        instead: "the model of the city is not public; a generated one whose houses are furnished takes \
            its place",
    },
    Shown {
        number: "Figure 11",
        what: "Five cars: the same charts and images",
        ours: &[Ours::Figure("klosowski-silva-figure-11"), Ours::Table("klosowski-silva-frames")],
        instead: "the model of the cars is not public; generated ones with engines take their place",
    },
    Shown {
        number: "Figure 12",
        what: "A city frame by frame by three orders: visible polygons found, wrong pixels, time",
        ours: &[Ours::Table("klosowski-silva-comparison")],
        instead: "",
    },
    Shown {
        number: "Figure 13",
        what: "Images of a seminar room by three orders",
        ours: &[Ours::Figure("klosowski-silva-figure-14")],
        instead: "the room is not public: as in Figure 2; the images are the upper row of \
            klosowski-silva-figure-14",
    },
    Shown {
        number: "Figure 14",
        what: "The pixels of these images that are wrong",
        ours: &[Ours::Figure("klosowski-silva-figure-14")],
        instead: "",
    },
    Shown {
        number: "Figure 15",
        what: "The seminar room by three orders: visible polygons found, and wrong pixels",
        ours: &[Ours::Table("klosowski-silva-comparison")],
        instead: "",
    },
    Shown {
        number: "Table 1",
        what: "Share of the visible polygons that four budgets find",
        ours: &[Ours::Table("klosowski-silva-table-1")],
        instead: "",
    },
];
