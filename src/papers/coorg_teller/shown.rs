//! What Coorg and Teller show, and what of it is ours.

use crate::papers::keys::LARGE_OCCLUDERS;
use crate::papers::shown::{Ours, Own, Shown};

/// Its figures, plates and tables, in its own order.
pub const SHOWN: &[Shown] = &[
    Shown {
        number: "Figure 1",
        what: "From one viewpoint: which walls are occluders, and what they hide",
        ours: &[Ours::Own(Own {
            name: "coorg-teller-figure-1",
            scene: "scenes2d/city_blocks.json",
            method: LARGE_OCCLUDERS,
            more: &["--do", "show-nodes"],
        })],
        instead: "",
    },
    Shown {
        number: "Figure 2",
        what: "Supporting and separating planes of an occluder and a box, and the three regions between \
            them",
        ours: &[Ours::Figure("coorg-teller-figure-2")],
        instead: "",
    },
    Shown {
        number: "Figure 3",
        what: "Two occluders that share an edge hide together what neither hides alone",
        ours: &[Ours::Figure("coorg-teller-figure-3")],
        instead: "",
    },
    Shown {
        number: "Figure 4",
        what: "Why the plane through a shared edge counts where that edge is on the silhouette",
        ours: &[Ours::Figure("coorg-teller-figure-4")],
        instead: "",
    },
    Shown {
        number: "Figure 5",
        what: "Three silhouettes of several occluders: convex, not convex, disconnected",
        ours: &[Ours::Figure("coorg-teller-figure-5")],
        instead: "",
    },
    Shown {
        number: "Figure 6",
        what: "The two planes through an occluder's edge that touch a box",
        ours: &[Ours::Figure("coorg-teller-figure-6")],
        instead: "",
    },
    Shown {
        number: "Figure 7",
        what: "The outline of a box by where the viewpoint lies",
        ours: &[Ours::Figure("coorg-teller-figure-7")],
        instead: "",
    },
    Shown {
        number: "Figure 8",
        what: "Regions around the projected box by code, each with its tangent corners",
        ours: &[Ours::Figure("coorg-teller-figure-8")],
        instead: "",
    },
    Shown {
        number: "Figure 9",
        what: "The algorithm as pseudocode",
        ours: &[Ours::Figure("coorg-teller-figure-9")],
        instead: "",
    },
    Shown {
        number: "Figure 10",
        what: "Nodes of a kD-tree classified for two viewpoints in a row",
        ours: &[Ours::Figure("coorg-teller-figure-10")],
        instead: "",
    },
    Shown {
        number: "Figure 11",
        what: "What goes into the estimate of how large an occluder looks",
        ours: &[Ours::Figure("coorg-teller-figure-11")],
        instead: "",
    },
    Shown {
        number: "Figure 12",
        what: "Small objects and the occluders near them",
        ours: &[Ours::Figure("coorg-teller-figure-12")],
        instead: "",
    },
    Shown {
        number: "Figure 13 (color plate)",
        what: "Moments of walks through the models, with what is drawn and what is hidden",
        ours: &[
            Ours::Own(Own {
                name: "coorg-teller-figure-13-building",
                scene: "generate:building",
                method: LARGE_OCCLUDERS,
                more: &["--do", "frame:0:20", "--do", "look-in-cut", "--do", "show-nodes"],
            }),
            Ours::Own(Own {
                name: "coorg-teller-figure-13-city",
                scene: "generate:city",
                method: LARGE_OCCLUDERS,
                more: &["--do", "frame:0:60", "--do", "show-nodes"],
            }),
        ],
        instead: "the floor of Soda Hall and the bought city are not public; a generated office floor \
            and a generated city of as many polygons take their place, walked in a figure 8 as in the \
            paper",
    },
    Shown {
        number: "Table 1",
        what: "Polygons drawn with view-frustum culling alone and with occlusion culling",
        ours: &[Ours::Table("coorg-teller-table-1")],
        instead: "",
    },
    Shown {
        number: "Table 2",
        what: "Time to cull and to draw on two workstations",
        ours: &[Ours::Table("coorg-teller-table-2")],
        instead: "the two workstations are gone: the machine at hand is measured and stands beside the \
            paper's times",
    },
    Shown {
        number: "Table 3",
        what: "Time to cull against the speed of the walker",
        ours: &[Ours::Table("coorg-teller-table-3")],
        instead: "",
    },
];
