//! Klosowski and Silva, Section 5: how much of the visible set a budget finds, how many pixels are wrong, how
//! long a frame and the preprocess take; and what the paper claims without numbers: that the visible set is
//! stable.
//!
//! Exactness is measured at every frame: the visible set is that of the item buffer (Section 4.4). Cost:
//! O(frames · ways) images of the scene.

mod comparison;
mod deadline;
mod extensions;
mod frames;
mod layering;
mod overhead;
mod preprocess;
mod stability;
mod table_1;
mod ways;

use crate::measure::Experiment;
use crate::measure::harness::FRAME_TIMES;
use crate::papers::keys::LAYERED_PROJECTION;

/// What the paper's large models are likened to.
const LARGE: &[&str] = &[FROM_ABOVE, "generate:city?polygons=500000", "generate:cars"];
/// A flight as in Figure 10 c, on which ordering by centroids fails as it did there.
const FROM_ABOVE: &str = "generate:city?polygons=500000&flight=1";
/// What the two ways through the city show.
const TWO_WAYS: &str = "Walking in the city's streets, centroids order about as well as cells do: what is \
                        nearest is what one sees. Flying around the city they fail as in the paper: the \
                        nearest triangles are furniture that roofs and walls hide.";
/// How what is found was measured.
const COVERED: &str = "Along the scene's own path. Visible is what owns a pixel of the item buffer; of each \
                       frame the share of it that was drawn, then the mean over the frames. A pixel is wrong \
                       if its color differs from the exact image's.";

/// All runs of the paper cull back faces (Section 5).
const AS_THEIRS: &[(&str, &str)] = &[("backface-culling", "true")];
/// What is called the paper's.
const RULED: &str = "The paper's rules are those of its Figures 4 and 5 as printed (`rules=paper`), with a \
                     penalty factor of 2, since it gives none; ours (`rules=ours`, the default) were chosen \
                     on the generated city and the generated cars. Back faces are culled unless set \
                     otherwise, as in the paper's runs.";

/// The tables.
pub const TABLES: &[Experiment] = &[
    Experiment {
        name: "klosowski-silva-table-1",
        method: LAYERED_PROJECTION,
        scenes: LARGE,
        title: "Klosowski and Silva 2000, Table 1: visible coverage ratio",
        summary: "Share of the visible triangles that a budget finds, by cells and by centroid, and the \
                  worst frame's wrong pixels",
        notes: &[
            COVERED,
            RULED,
            TWO_WAYS,
            "The paper's most wrong pixels are stated without a budget; they are shown at the largest.",
        ],
        settings: AS_THEIRS,
        sweep: &table_1::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-frames",
        method: LAYERED_PROJECTION,
        scenes: LARGE,
        title: "Klosowski and Silva 2000, Figures 10 and 11: what budgets find, frame by frame",
        summary: "Visible triangles found and time of a frame at budgets of 1, 2, 5 and 10 percent, frame by \
                  frame",
        notes: &[
            COVERED,
            RULED,
            FRAME_TIMES,
            "The paper's frames are 4 times faster at 5 percent (City) and over 10 times at 1 percent (5 Car \
             Body/Engine) than with everything drawn.",
        ],
        settings: AS_THEIRS,
        sweep: &frames::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-comparison",
        method: LAYERED_PROJECTION,
        scenes: &[FROM_ABOVE, "generate:city?polygons=500000", "generate:seminar-room"],
        title: "Klosowski and Silva 2000, Figures 12 and 15: cells and centroid compared",
        summary: "Visible triangles found, wrong pixels and time of a frame by Delaunay, octree, kD-tree and \
                  centroid, frame by frame",
        notes: &[
            COVERED,
            RULED,
            FRAME_TIMES,
            TWO_WAYS,
            "The paper's centroid order has 7 to 40 percent of the pixels wrong; its Delaunay cells find \
             over 90 percent.",
        ],
        settings: AS_THEIRS,
        sweep: &comparison::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-stability",
        method: LAYERED_PROJECTION,
        scenes: &["generate:city?polygons=500000", "generate:seminar-room"],
        title: "Klosowski and Silva 2000, Section 7: is the visible set stable?",
        summary: "What pops between views a step apart: triangles and pixels that change though the exact \
                  image does not",
        notes: &[
            "Between two views a walker's step apart (4.7 cm), means over the pairs. A triangle pops that is \
             visible in both views and drawn in one of them; a pixel pops that shows the same triangle in \
             both exact images and is right in one view and wrong in the other. A set changes by its share \
             of those that are in either view's set and not in both. The paper says that nothing major pops, \
             without figures.",
            RULED,
        ],
        settings: AS_THEIRS,
        sweep: &stability::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-preprocess",
        method: LAYERED_PROJECTION,
        scenes: &["generate:city?polygons=500000", "generate:cars", "generate:city?polygons=1000000"],
        title: "Klosowski and Silva 2000, Section 5.1: preprocess",
        summary: "Time of the preprocess by stage, cells, references a triangle, and memory",
        notes: &[
            "Medians of three builds in turn, one thread. A reference takes 4 bytes; cells are all the rest \
             of the index, neighbors and normals included; the scene is all that we keep of it. Overhead: \
             cells and references against the scene; in the paper, against its triangles.",
            "The paper's 14.7 MB are what it prints, but hardly what it means: at 4 bytes a reference, which \
             make its 3.6 MB for the City, 810,000 times 2.13 references take 6.9 MB, and 14.7 is 2.13 times \
             that. The total would be some 13 MB, an overhead of 16 percent instead of 24.",
        ],
        settings: AS_THEIRS,
        sweep: &preprocess::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-overhead",
        method: LAYERED_PROJECTION,
        scenes: LARGE,
        title: "Klosowski and Silva 2000, Section 5.2.3: overhead over view-frustum culling",
        summary: "Time of the traversal beside view-frustum culling, by cells and budget, alone and as a \
                  share of a frame",
        notes: &[
            FRAME_TIMES,
            RULED,
            "View-frustum culling walks a kD-tree and keeps nodes whole; a frame of it is culled, and all \
             that was kept is drawn. At 100 percent all that is in view is drawn, triangle by triangle.",
        ],
        settings: AS_THEIRS,
        sweep: &overhead::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-extensions",
        method: LAYERED_PROJECTION,
        scenes: LARGE,
        title: "Klosowski and Silva 2000, Section 6: extensions",
        summary: "What the paper's rules and ours find, each difference between them alone, and each \
                  extension: solidities, seeds, a wanted quality, queries",
        notes: &[COVERED, RULED, "With a quality or queries the budget is where they begin."],
        settings: AS_THEIRS,
        sweep: &extensions::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-deadline",
        method: LAYERED_PROJECTION,
        scenes: LARGE,
        title: "Klosowski and Silva 2000, Section 3: time-critical frames",
        summary: "How long frames take that end at a deadline, on an idle and on a loaded machine, and how \
                  far they overshoot",
        notes: &[
            "Loaded: two more busy threads for each core. A frame is culled and drawn on one thread.",
            RULED,
        ],
        settings: AS_THEIRS,
        sweep: &deadline::SWEEP,
    },
    Experiment {
        name: "klosowski-silva-layering",
        method: LAYERED_PROJECTION,
        scenes: LARGE,
        title: "Klosowski and Silva 2000, Section 3: projected by layers?",
        summary: "Rank correlation of the order of projection with the layering numbers that it is to follow",
        notes: &[
            "Along the scene's own path, means over the frames. The layering number ζ of a triangle is the \
             smallest rank that it has at any pixel, by distance; by fragments of every triangle, exact. \
             Order: Kendall's rank correlation of ζ and the place in the order of projection, over the pairs \
             of triangles of different ζ: 1 by layers, 0 at random, −1 back to front. Triangles that cover \
             no pixel are left out. The paper defines ζ and measures none.",
            RULED,
        ],
        settings: AS_THEIRS,
        sweep: &layering::SWEEP,
    },
];
