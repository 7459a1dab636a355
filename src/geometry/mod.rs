//! Points, boxes, planes, eyes and frusta, once for flatland (2D) and space (3D).
//!
//! Conventions: right-handed, y up, radians, world units. A half-space is *inside* where `n·x + d ≥ 0`.
//! All view arithmetic is done relative to the eye (`point − eye` first), so its rounding error is
//! relative to the distance from the eye and not to the distance from the origin.

mod bounds;
#[cfg(test)]
pub(crate) mod dice;
mod either;
mod eye;
mod frustum;
mod id;
mod overlap;
mod predicate;
mod project;
mod sets;
mod space;
#[cfg(test)]
mod tests;
mod walk;

pub use bounds::Aabb;
pub use either::Either;
pub(crate) use either::each;
pub use eye::{Eye, MAX_SIDE_PX, Projection, View, ViewPath, figure_eight, raise};
pub use frustum::{Frustum, FrustumTest, PlaneTest};
pub use id::{CellId, MaterialId, NodeId, ObjectId, PrimId};
pub use overlap::{
    Beside, beside_segment, beside_triangle, segment_meets_box, segment_meets_triangle, triangle_meets_box,
    triangle_meets_octants, triangle_meets_tetrahedron,
};
pub use predicate::{insphere, orient2d, orient3d};
pub use project::{BoxImage, Footprint, MARGIN_PX, PixelRect, farthest_depth, nearest_depth, project_box};
pub use sets::Sets;
pub use space::{Flat, Solid, Space, Vector, faces_away};
pub use walk::WALKING_STEP_M;
