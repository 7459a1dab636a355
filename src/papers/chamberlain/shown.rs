//! What Chamberlain, DeRose, Lischinski, Salesin and Snyder show, and what of it is ours.

use crate::papers::shown::{Ours, Shown};

/// Its figures, plates and tables, in its own order.
pub const SHOWN: &[Shown] = &[
    Shown {
        number: "Figure 1",
        what: "What is drawn of a quadtree: near leaves, color cubes farther off, nothing outside the view",
        ours: &[Ours::Figure("chamberlain-figure-1")],
        instead: "",
    },
    Shown {
        number: "Figure 2",
        what: "The traversal as pseudocode",
        ours: &[Ours::Figure("chamberlain-figure-2")],
        instead: "the page was not at hand: ours follows what the text says of it",
    },
    Shown {
        number: "Figure 3",
        what: "The face of a cell composed of the faces of its children",
        ours: &[Ours::Figure("chamberlain-figure-3")],
        instead: "",
    },
    Shown {
        number: "Figure 4",
        what: "Why a surface is torn when it is seen from between the axes",
        ours: &[Ours::Figure("chamberlain-figure-4")],
        instead: "",
    },
    Shown {
        number: "Figure 5",
        what: "Time of a frame against the number of trees, by geometry and by color cubes",
        ours: &[Ours::Table("chamberlain-figure-5")],
        instead: "",
    },
    Shown {
        number: "Plate 1",
        what: "A tree at four distances: geometry, color cubes, and these enlarged",
        ours: &[Ours::Figure("chamberlain-plate-1")],
        instead: "the model is not public; a generated tree with as many triangles takes its place",
    },
    Shown {
        number: "Plate 2",
        what: "A protein at four distances: the same",
        ours: &[Ours::Figure("chamberlain-plate-2")],
        instead: "the model is not public; a generated molecule takes its place",
    },
    Shown {
        number: "Plate 3",
        what: "An island with trees: geometry, and color cubes",
        ours: &[Ours::Figure("chamberlain-plate-3")],
        instead: "the model is not public; a generated island takes its place",
    },
    Shown {
        number: "Plate 4",
        what: "A bust whose surface color cubes tear",
        ours: &[Ours::Figure("chamberlain-plate-4")],
        instead: "the model of the bust is not public; a generated one takes its place",
    },
    Shown {
        number: "Plate 5",
        what: "1, 16, 64 and 4,096 trees by color cubes",
        ours: &[Ours::Figure("chamberlain-plate-5")],
        instead: "",
    },
    Shown {
        number: "Table 1",
        what: "Size of the hierarchy of three models, and the time to make and to load it",
        ours: &[Ours::Table("chamberlain-table-1")],
        instead: "",
    },
    Shown {
        number: "Table 2",
        what: "Time of a frame with geometry and with color cubes, by distance",
        ours: &[Ours::Table("chamberlain-table-2")],
        instead: "the graphics workstation is gone: the machine at hand is measured and stands beside the \
            paper's times",
    },
];
