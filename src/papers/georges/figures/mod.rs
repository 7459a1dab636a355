//! Figures of Georges, "Obscuration Culling on Parallel Graphics Architectures", UNC TR95-017, 1995, made
//! anew (1 and 2), and of what the method `hierarchical-z` does on scenes: its pyramid, its queries, its
//! octree, its simulated machine.

mod frames;
mod notes;
mod pyramid;

use crate::papers::paper::Figure;

/// The figures.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "georges-figure-1",
        former: Some("hierarchical-z-1"),
        summary: "The three levels of a simple z-pyramid",
        make: pyramid::simple_pyramid,
    },
    Figure {
        name: "georges-figure-2",
        former: Some("hierarchical-z-2"),
        summary: "A face is tested against the z-pyramid, level by level",
        make: pyramid::simple_query,
    },
    Figure {
        name: "georges-query",
        former: Some("hierarchical-z-query"),
        summary: "What a query reads of the pyramid over an office",
        make: pyramid::office_query,
    },
    Figure {
        name: "georges-stack",
        former: Some("hierarchical-z-stack"),
        summary: "The z-pyramid over the image",
        make: pyramid::office_stack,
    },
    Figure {
        name: "georges-flatland",
        former: Some("hierarchical-z-flatland"),
        summary: "A cube of a quadtree is asked for, and the strips of its pyramid",
        make: pyramid::flatland_query,
    },
    Figure {
        name: "georges-quadtree",
        former: Some("hierarchical-z-quadtree"),
        summary: "A quadtree's cubes by state, and what is drawn",
        make: frames::quadtree,
    },
    Figure {
        name: "georges-timeline",
        former: Some("hierarchical-z-timeline"),
        summary: "What processors and renderers do when, for three ways to deal structures out",
        make: frames::timelines,
    },
];
