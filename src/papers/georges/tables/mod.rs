//! The models of Georges, Section 5.2, and the known weakness of depth at samples.

mod aliasing;
mod box_model;
mod flight;
mod fly;

use crate::measure::Experiment;
use crate::measure::harness::FRAME_TIMES;
use crate::papers::keys::HIERARCHICAL_Z;

/// The tables.
pub const TABLES: &[Experiment] = &[
    Experiment {
        name: "georges-box",
        method: HIERARCHICAL_Z,
        scenes: &["generate:box-and-objects"],
        title: "Georges 1995, Section 5.2: a box that hides a row of objects",
        summary: "Frames a second with the objects in sight and behind the box, with obscuration culling and \
                  without",
        notes: &[
            FRAME_TIMES,
            "The paper's system has one processor. It says of the rate behind the box only that it is near \
             that of the monitor, which it does not state.",
        ],
        settings: &[],
        sweep: &box_model::SWEEP,
    },
    Experiment {
        name: "georges-flight",
        method: HIERARCHICAL_Z,
        scenes: &["generate:machine-room", "generate:building", "generate:city"],
        title: "Georges 1995, Section 5.2: a hidden dense body",
        summary: "Time of a frame along a flight, with obscuration culling and without; the paper gains 20 \
                  to 30 percent",
        notes: &[
            FRAME_TIMES,
            "The paper's 20 to 30 percent are for frames in which the dense body is in the view frustum and \
             hidden.",
        ],
        settings: &[],
        sweep: &flight::SWEEP,
    },
    Experiment {
        name: "georges-aliasing",
        method: HIERARCHICAL_Z,
        scenes: &["generate:thin-slabs", "generate:building?polygons=20000"],
        title: "What samples miss: aliasing of the z-buffer against resolution",
        summary: "Triangles that a fine image shows and obscuration culling at a coarse one does not draw",
        notes: &[
            "Fine: 2048 × 2048. What falls between the samples of the coarse image is not drawn; at its own \
             resolution nothing is missed.",
        ],
        settings: &[],
        sweep: &aliasing::SWEEP,
    },
];
