//! The octree over a scene's vertices (a quadtree in flatland), whose leaves are cells.
//!
//! Klosowski and Silva 2000, Section 4.3: a node that holds vertices is divided until its side is shorter
//! than 5 % of the scene's longest side (footnote 4). Its root is a cube around the scene. Cost: O(vertices ·
//! levels).

use super::{BoxCells, Fineness, region, vertices};
use crate::geometry::{Space, Vector};
use crate::scene::Scene;

/// The octree's leaves. `None` when cancelled.
pub fn vertex_octree<S: Space>(
    scene: &Scene<S>,
    fineness: Fineness,
    cancelled: impl Fn() -> bool,
) -> Option<BoxCells<S::Vector>> {
    let region = region(scene);
    let axes = S::Vector::AXES;
    let least = region.size().get(0) * fineness.leaf_share;
    let mut divide = |bounds: &crate::geometry::Aabb<S::Vector>, level: u32, points: &mut [S::Vector]| {
        // Three levels of the binary tree are one of the octree, two of the quadtree.
        let axis = level as usize % axes;
        // An octree's node is divided along all axes or none: the first one decides.
        let whole =
            axis != 0 || (points.len() > fineness.leaf_vertices as usize && bounds.size().get(0) >= least);
        whole.then(|| (axis, bounds.center().get(axis)))
    };
    BoxCells::build(region, &mut vertices(scene), &mut divide, cancelled)
}
