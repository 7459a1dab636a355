//! The figures of Klosowski and Silva, "The Prioritized-Layered Projection Algorithm for Visible Set
//! Estimation", IEEE TVCG 6(2), 2000, made anew by running the method: Figures 2, 3, 6, 7, 9, 13 and 14, in
//! flatland where that shows it better.

mod cells;
mod missed;
mod model;
mod room;
mod transfer;
mod walked;

use crate::figure::builtin::Row;

/// The figures, in the paper's order.
pub const FIGURES: &[Row] = &[
    (
        "layered-projection-2",
        "Cells that were projected and cells that were not, in a seminar room",
        room::snapshots,
    ),
    (
        "layered-projection-3",
        "Quadtree over the vertices, centers of its leaves, their triangulation",
        cells::tessellation,
    ),
    (
        "layered-projection-3-space",
        "Octree over a car's vertices and its tetrahedra, cut open",
        model::tessellation,
    ),
    ("layered-projection-6", "How solidity is handed on from a cell to its neighbors", transfer::solidity),
    ("layered-projection-7", "Four moments of the traversal, past a bottleneck", walked::moments),
    ("layered-projection-9", "Neighbors across levels of a quadtree, in both directions", cells::neighbors),
    (
        "layered-projection-14",
        "Images and missed pixels with a budget: centroid, octree, Delaunay",
        missed::images,
    ),
];

/// Key of the method.
const METHOD: &str = "layered-projection";
