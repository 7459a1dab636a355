//! Zhang, Manocha, Hudson and Hoff, Section 6.2, measured: how much faster frames are and what is culled
//! (Figures 1 and 9), where the time goes (Figure 10), and what the paper says without a figure or a number:
//! that the hierarchy of maps saves reads (Section 4.3), what thresholds lose (5.4), what it costs where
//! nothing is hidden (7), and that averages are made faster than minima (7.2).
//!
//! Exactness is checked against the item buffer. Cost: O(frames) images of the scene.

mod claims;
mod closing;
mod construction;
mod fly;
mod frames;
mod occluders;
mod open;
mod overlap;
mod seen;
mod stages;
mod thresholds;

use crate::measure::Experiment;
use crate::measure::harness::FRAME_TIMES;
use crate::papers::keys::OCCLUSION_MAPS;

/// What the paper's models are likened to, with as many polygons.
const MODELS: &[&str] =
    &["generate:city?polygons=312524", "generate:machine-room?polygons=632252", "generate:swarm"];
/// How smaller ones are measured.
const SMALLER: &str = "With as many polygons as the paper's models; --scene generate:city?polygons=20000 \
                       and so on measures smaller ones.";
/// What is compared.
const BESIDES: &str = "Without occlusion culling means with view-frustum culling alone, which the paper's \
                       frames have as well.";

/// The tables.
pub const TABLES: &[Experiment] = &[
    Experiment {
        name: "zhang-frames",
        method: OCCLUSION_MAPS,
        scenes: MODELS,
        title: "Zhang et al. 1997, Figure 9: frames with and without occlusion culling",
        summary: "Time of a frame with and without occlusion culling, and what is culled, frame by frame",
        notes: &[FRAME_TIMES, BESIDES, SMALLER, "Counts are the same on every machine; times are not."],
        settings: &[],
        sweep: &frames::SWEEP,
    },
    Experiment {
        name: "zhang-stages",
        method: OCCLUSION_MAPS,
        scenes: MODELS,
        title: "Zhang et al. 1997, Figure 10: stages of a frame",
        summary: "Stages of a frame as shares of a frame without occlusion culling",
        notes: &[
            FRAME_TIMES,
            "Shares of the mean frame without occlusion culling. The paper draws bars and prints one number: \
             occluders, their choice and their drawing, take 10 to 25 percent. Here drawing them writes \
             their depths too.",
            BESIDES,
            SMALLER,
        ],
        settings: &[],
        sweep: &stages::SWEEP,
    },
    Experiment {
        name: "zhang-claims",
        method: OCCLUSION_MAPS,
        scenes: MODELS,
        title: "Zhang et al. 1997, Sections 1 and 6: what the paper says in numbers",
        summary: "The occluder database, what is culled, the time to make maps, and how much faster frames \
                  are",
        notes: &[
            FRAME_TIMES,
            BESIDES,
            SMALLER,
            "Culled of the model: outside the view or hidden, as in the paper's Figure 1. Making the maps is \
             averaging alone, without drawing the occluders; beside it the standard deviation over the \
             frames, where the paper says \"around 0.5 milliseconds\". Its machines are of 1995 and 1996.",
        ],
        settings: &[],
        sweep: &claims::SWEEP,
    },
    Experiment {
        name: "zhang-overlap",
        method: OCCLUSION_MAPS,
        scenes: &["generate:city?polygons=100000", "generate:forest"],
        title: "Zhang et al. 1997, Sections 4.3 and 5.1: what the hierarchy saves",
        summary: "Random rectangles asked of the hierarchy, of level 0 and of the samples: same answers, \
                  fewer reads",
        notes: &[
            "Half of the rectangles are of any size, half are small; they are spread over the maps of all \
             frames. Asked three ways: of the hierarchy (Figure 8), of level 0 pixel by pixel, and of the \
             samples of these pixels one by one; the last two stop at the first pixel that is not opaque. \
             Differences are answers unlike the hierarchy's: 0 expected. --rectangles says how many are \
             asked about; the last row is of the boxes that the frames themselves asked about.",
        ],
        settings: &[("adapt", "false")],
        sweep: &overlap::SWEEP,
    },
    Experiment {
        name: "zhang-construction",
        method: OCCLUSION_MAPS,
        scenes: &["generate:city?polygons=312524"],
        title: "Zhang et al. 1997, Sections 6.1 and 7.2: the time to make the maps",
        summary: "All levels of opacity against a whole z-pyramid of the same image, and averages against \
                  minima",
        notes: &[
            "Wall-clock times on one thread; each pair in turn, medians over the frames. Section 7.2 says \
             that averages are made faster than minima and maxima, \"due to the absence of branch \
             instructions\". Levels of opacity are counted from the masks of tiles that the occluders are \
             drawn into; the z-pyramid is brought up to date whole from the depths of the same image. Maps \
             with occluders: these chosen and drawn, all levels made; beside it the same occluders drawn \
             into a z-buffer, and its pyramid. Plain loops average and take minima of the same 256 × 256 \
             numbers down to 4 × 4: here a minimum is one instruction, as is a sum.",
        ],
        settings: &[("adapt", "false")],
        sweep: &construction::SWEEP,
    },
    Experiment {
        name: "zhang-thresholds",
        method: OCCLUSION_MAPS,
        scenes: &["generate:forest"],
        title: "Zhang et al. 1997, Section 5.4, Figures 6 and 7: what thresholds cull and what they lose",
        summary: "A house behind trees at thresholds from 1 to 0.5: what is culled, what is missed, and the \
                  bound on wrong pixels",
        notes: &[
            "Means over the frames. Maps of at most 64 × 64 pixels, as in the paper's example, in which 25 \
             black samples of 16 × 16 are 1 − 25/256 = 0.902. All that grows may be an occluder, small as \
             leaves are. Visible is what owns a pixel of the item buffer; a pixel is wrong if its color \
             differs from the exact image's. The bound on wrong pixels is n times the map pixels that are \
             accepted with holes; below it, the black samples that these have.",
        ],
        settings: &[
            ("adapt", "false"),
            ("map-resolution", "64"),
            ("occluder-budget", "60000"),
            ("occluder-size", "0"),
            ("depth", "samples"),
        ],
        sweep: &thresholds::SWEEP,
    },
    Experiment {
        name: "zhang-open",
        method: OCCLUSION_MAPS,
        scenes: &["generate:terrain"],
        title: "Zhang et al. 1997, Section 7: the cost where nothing is hidden",
        summary: "Hills from above: what occlusion culling costs over view-frustum culling, turned off \
                  automatically and not",
        notes: &[
            FRAME_TIMES,
            "\"Occlusion culling should be turned off\" where it culls less than it costs; the paper says \
             nothing of how that is known, and gives no number. Time over frustum culling is the median over \
             the frames of the ratio of both times.",
        ],
        settings: &[],
        sweep: &open::SWEEP,
    },
    occluders::TABLE,
    closing::TABLE,
];
