//! Chamberlain, DeRose, Lischinski, Salesin and Snyder, measured: what the hierarchy takes (Table 1), how
//! much faster frames are (Table 2, Section 5), what images look like (Sections 5 and 5.1), how time grows
//! with the number of trees (Section 5.2, Figure 5), and that each level of the hierarchy is drawn as often
//! as any other (Section 3.1).
//!
//! Cost: O(frames) images of the scene; of forests O(levels · (cells visited + triangles drawn)).

mod built;
mod errors;
mod figure_5;
mod frames;
mod samples;
mod shells;
mod tearing;

use crate::measure::Experiment;
use crate::papers::keys::COLOR_CUBES;

/// What the paper's models are likened to.
const MODELS: &[&str] = &["generate:tree", "generate:molecule", "generate:terrain-island"];
/// How images are drawn.
const IMAGES: &str = "Images have 2 × 2 samples a pixel, as the paper's have; a threshold is of pixels. \
                      Times are wall clock on one thread from the view to the finished samples, the two \
                      ways in turn, medians; how much faster is the median of the ratios.";
const COUNTS: &str = "Counts are the same on every machine; times are not.";

/// The tables.
pub const TABLES: &[Experiment] = &[
    Experiment {
        name: "chamberlain-table-1",
        method: COLOR_CUBES,
        scenes: MODELS,
        title: "Chamberlain et al. 1996, Table 1: what the hierarchy takes",
        summary: "Levels, nodes and bytes of the hierarchy, and the time to make it and to read it again",
        notes: &[
            "Overhead is what is kept beside the scene: nodes with their faces, and references. Built: the \
             octree and all color cubes, on one thread, from the scene in memory. Loaded: from bytes in \
             memory, all of it checked. The paper's times are of an SGI Onyx of 1995 and include the disk.",
            COUNTS,
        ],
        settings: &[],
        sweep: &built::SWEEP,
    },
    Experiment {
        name: "chamberlain-table-2",
        method: COLOR_CUBES,
        scenes: MODELS,
        title: "Chamberlain et al. 1996, Table 2 and Section 5: frames with and without the hierarchy",
        summary: "Time of a frame with geometry and with color cubes, by distance and by size of the image",
        notes: &[
            IMAGES,
            "A turn of the hierarchy is as many frames as take about as long as one of geometry, 32 at most: \
             after a long frame the caches hold nothing of a short one.",
            COUNTS,
        ],
        settings: &[],
        sweep: &frames::SWEEP,
    },
    Experiment {
        name: "chamberlain-errors",
        method: COLOR_CUBES,
        scenes: &["generate:tree", "generate:molecule"],
        title: "Chamberlain et al. 1996, Section 5: how far images are from what they should look like",
        summary: "Differences (FLIP) of images with and without cubes from a reference, and how they flicker",
        notes: &[
            "The reference has 16 × 16 samples a pixel. FLIP is the mean over the image: 0 where nothing \
             differs. Flicker: how far each frame of a flight is from the one before, less how far the \
             reference is; the paper says that the results \"animate well\". Geometry of 2 × 2 samples is \
             what the paper's cubes were shown beside.",
        ],
        settings: &[],
        sweep: &errors::SWEEP,
    },
    Experiment {
        name: "chamberlain-tearing",
        method: COLOR_CUBES,
        scenes: &["generate:bust"],
        title: "Chamberlain et al. 1996, Section 5.1: surfaces torn, and kept whole by a bound",
        summary: "How much background shows through a closed surface, by the bound on a cube's error",
        notes: &[
            IMAGES,
            "Seen through: what background is mixed into samples that geometry covers, as a sum over the \
             image. A bound of 0 is the paper's form, which refuses no cube.",
        ],
        settings: &[],
        sweep: &tearing::SWEEP,
    },
    figure_5::TABLE,
    shells::TABLE,
];
