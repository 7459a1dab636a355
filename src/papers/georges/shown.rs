//! What Georges shows, and what of it is ours.

use crate::papers::shown::{Ours, Shown};

/// Its figures, plates and tables, in its own order.
pub const SHOWN: &[Shown] = &[
    Shown {
        number: "Figure 1",
        what: "Three levels of a z-pyramid, each value the farthest of four",
        ours: &[Ours::Figure("georges-figure-1")],
        instead: "",
    },
    Shown {
        number: "Figure 2",
        what: "A face is tested against that pyramid, from the level on which one sample covers it",
        ours: &[Ours::Figure("georges-figure-2")],
        instead: "",
    },
];
