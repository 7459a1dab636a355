//! A kD-tree over a scene's vertices, whose leaves are cells.
//!
//! Klosowski and Silva 2000, Section 3.1, name kD-trees among the possible tessellations. Departure from the
//! usual one: the dividing plane through the median vertex is kept off the sides of the node, so that cells
//! do not become slivers. Cost: O(vertices · levels).

use super::{BoxCells, Fineness, region, vertices};
use crate::geometry::{Aabb, Space, Vector};
use crate::scene::Scene;

/// The least share of a node's side that either half gets.
const LEAST_HALF: f32 = 0.25;

/// The leaves of the kD-tree: each node is divided across its longest side. `None` when cancelled.
pub fn vertex_kd_tree<S: Space>(
    scene: &Scene<S>,
    fineness: Fineness,
    cancelled: impl Fn() -> bool,
) -> Option<BoxCells<S::Vector>> {
    let region = region(scene);
    let least = region.size().get(0) * fineness.leaf_share;
    let mut divide = |bounds: &Aabb<S::Vector>, _: u32, points: &mut [S::Vector]| {
        let size = bounds.size();
        let axis =
            (1..S::Vector::AXES).fold(0, |best, a| if size.get(a) > size.get(best) { a } else { best });
        if points.len() <= fineness.leaf_vertices as usize || size.get(axis) < least {
            return None;
        }
        // The median vertex balances the halves; equal coordinates may put more than half on one side.
        let middle = points.len() / 2;
        let median =
            points.select_nth_unstable_by(middle, |p, q| p.get(axis).total_cmp(&q.get(axis))).1.get(axis);
        let (low, high) = (bounds.min.get(axis), bounds.max.get(axis));
        // Off the sides of the node.
        let rim = (high - low) * LEAST_HALF;
        Some((axis, median.clamp(low + rim, high - rim)))
    };
    BoxCells::build(region, &mut vertices(scene), &mut divide, cancelled)
}
