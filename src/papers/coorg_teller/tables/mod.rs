//! The tables of Coorg and Teller, Section 4, and what Section 5 leaves open. They walk the scene's path
//! `figure 8` (where a scene has none, one through its middle), at [`crate::geometry::WALKING_STEP_M`] a
//! frame where the method remembers.

mod both;
mod nodes;
mod occluders;
mod table_1;
mod table_2;
mod table_3;

use crate::measure::Experiment;
use crate::measure::harness::WALK_TIMES;
use crate::papers::keys::LARGE_OCCLUDERS;

/// What the paper's models are likened to.
const WALKED: &[&str] = &["generate:building", "generate:city"];

/// The tables.
pub const TABLES: &[Experiment] = &[
    Experiment {
        name: "coorg-teller-table-1",
        method: LARGE_OCCLUDERS,
        scenes: WALKED,
        title: "Coorg and Teller 1997, Table 1: polygons drawn",
        summary: "Percent of the polygons drawn after view-frustum culling and after occlusion culling",
        notes: &[
            "Averages over views evenly spaced along the whole path.",
            "By nodes: what Figure 9 decides with whole nodes of the tree. And objects: detail objects \
             (Section 3.2) one by one as well; for the frustum every object whose box is out of view. The \
             paper does not say how its frustum column was made; its ratio stands beside ours with objects.",
        ],
        settings: &[],
        sweep: &table_1::SWEEP,
    },
    Experiment {
        name: "coorg-teller-table-2",
        method: LARGE_OCCLUDERS,
        scenes: WALKED,
        title: "Coorg and Teller 1997, Table 2: time to cull and to draw",
        summary: "Milliseconds to cull and to draw a frame, with view-frustum culling and with occlusion \
                  culling",
        notes: &[
            WALK_TIMES,
            "We draw with a software rasterizer, the paper with graphics hardware of its time.",
        ],
        settings: &[],
        sweep: &table_2::SWEEP,
    },
    Experiment {
        name: "coorg-teller-table-3",
        method: LARGE_OCCLUDERS,
        scenes: WALKED,
        title: "Coorg and Teller 1997, Table 3: time in visibility against speed",
        summary: "Time to cull a frame against the speed of the walker, with and without planes kept from \
                  frame to frame",
        notes: &[
            WALK_TIMES,
            "Ours is all of culling, view-frustum tests and gathering included; the paper leaves out the \
             view-frustum tests.",
        ],
        settings: &[],
        sweep: &table_3::SWEEP,
    },
    Experiment {
        name: "coorg-teller-nodes",
        method: LARGE_OCCLUDERS,
        scenes: WALKED,
        title: "Coorg and Teller 1997, Section 4.1: nodes tested for occlusion",
        summary: "kD-tree nodes tested for occlusion a frame, and their share of those in the view frustum",
        notes: &[
            "Low and high are the quartiles over the frames; for the paper, the ends of the range that it \
             states for both models.",
        ],
        settings: &[],
        sweep: &nodes::SWEEP,
    },
    Experiment {
        name: "coorg-teller-occluders",
        method: LARGE_OCCLUDERS,
        scenes: WALKED,
        title: "Coorg and Teller 1997, Section 5: how many occluders",
        summary: "Polygons drawn and time to cull against the number of occluders, fixed or by their \
                  marginal gain",
        notes: &[
            WALK_TIMES,
            "The paper has 32 occluders and states no figures for others; by marginal gain at most 64 are \
             taken.",
        ],
        settings: &[],
        sweep: &occluders::SWEEP,
    },
];
