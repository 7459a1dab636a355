//! The figures of Klosowski and Silva, "The Prioritized-Layered Projection Algorithm for Visible Set
//! Estimation", IEEE TVCG 6(2), 2000, made anew by running the method: Figures 1 to 3, 6, 7, 9 to 11, 13 and
//! 14, in flatland where that shows it better. They follow the paper's rules (`rules=paper`) unless they say
//! otherwise.

mod cells;
mod layering;
mod missed;
mod model;
mod notes;
mod room;
mod transfer;
mod walked;

use crate::papers::paper::Figure;

/// The figures, in the paper's order.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "klosowski-silva-figure-2",
        former: Some("layered-projection-2"),
        summary: "Cells that were projected and cells that were not, in a seminar room",
        make: room::snapshots,
    },
    Figure {
        name: "klosowski-silva-figure-3",
        former: Some("layered-projection-3"),
        summary: "Quadtree over the vertices, centers of its leaves, their triangulation",
        make: cells::tessellation,
    },
    Figure {
        name: "klosowski-silva-figure-3-space",
        former: Some("layered-projection-3-space"),
        summary: "Octree over a car's vertices and its tetrahedra, cut open",
        make: model::tessellation,
    },
    Figure {
        name: "klosowski-silva-figure-6",
        former: Some("layered-projection-6"),
        summary: "How solidity is handed on from a cell to its neighbors",
        make: transfer::solidity,
    },
    Figure {
        name: "klosowski-silva-figure-7",
        former: Some("layered-projection-7"),
        summary: "Four moments of the traversal, past a bottleneck",
        make: walked::moments,
    },
    Figure {
        name: "klosowski-silva-figure-9",
        former: Some("layered-projection-9"),
        summary: "Neighbors across levels of a quadtree, in both directions",
        make: cells::neighbors,
    },
    Figure {
        name: "klosowski-silva-figure-10",
        former: None,
        summary: "A city from above: all that is visible, and what a budget shows of it",
        make: missed::city,
    },
    Figure {
        name: "klosowski-silva-figure-11",
        former: None,
        summary: "Five cars: all that is visible, and what a budget shows of it",
        make: missed::cars,
    },
    Figure {
        name: "klosowski-silva-figure-14",
        former: Some("layered-projection-14"),
        summary: "Images and missed pixels with a budget: centroid, octree, Delaunay",
        make: missed::images,
    },
    Figure {
        name: "klosowski-silva-layers",
        former: None,
        summary: "Layers of primitives beside the order of their projection",
        make: layering::layers,
    },
];
