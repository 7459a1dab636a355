//! The culling methods, and the one shape they share.
//!
//! A method is written once and watched: [`Method::cull`] is generic over an [`Observer`] that returns
//! nothing and sees no state, so the function that runs at full speed is the one that is stepped.
//! To add a method: make a folder, implement [`Method`], add a `mod` line and a line in each list below.

pub(crate) mod baseline;
mod cubes;
pub(crate) mod depth;
pub(crate) mod hierarchical_z;
pub(crate) mod large_occluders;
pub(crate) mod layered_projection;
pub(crate) mod parallel_hierarchical_z;

pub use hierarchical_z::parts as hierarchical_z_parts;
pub use large_occluders::anatomy;

use crate::geometry::{Flat, Solid, Space};
use crate::method::{Entry, Of};

/// Every method that runs in flatland, in the order of menus.
pub static FLAT: &[&dyn Entry<Flat>] = &[
    &Of::<baseline::ZBuffer>::NEW,
    &Of::<baseline::Frustum>::NEW,
    &Of::<baseline::Centroid>::NEW,
    &Of::<large_occluders::LargeOccluders>::NEW,
    &Of::<hierarchical_z::HierarchicalZ>::NEW,
    &Of::<parallel_hierarchical_z::ParallelHierarchicalZ>::NEW,
    &Of::<layered_projection::LayeredProjection>::NEW,
];
/// Every method that runs in space, in the order of menus.
pub static SOLID: &[&dyn Entry<Solid>] = &[
    &Of::<baseline::ZBuffer>::NEW,
    &Of::<baseline::Frustum>::NEW,
    &Of::<baseline::Centroid>::NEW,
    &Of::<large_occluders::LargeOccluders>::NEW,
    &Of::<hierarchical_z::HierarchicalZ>::NEW,
    &Of::<parallel_hierarchical_z::ParallelHierarchicalZ>::NEW,
    &Of::<layered_projection::LayeredProjection>::NEW,
];

/// Key of the method that a new session begins with: the simplest one that leaves something out.
pub const DEFAULT_METHOD: &str = "frustum";

/// The methods of a space, for code that is generic over it.
pub trait Methods: Space {
    /// Its list.
    fn methods() -> &'static [&'static dyn Entry<Self>];
    /// The method with this key.
    fn method(key: &str) -> Option<&'static dyn Entry<Self>> {
        Self::methods().iter().copied().find(|m| m.card().key == key)
    }
}
impl Methods for Flat {
    fn methods() -> &'static [&'static dyn Entry<Self>] {
        FLAT
    }
}
impl Methods for Solid {
    fn methods() -> &'static [&'static dyn Entry<Self>] {
        SOLID
    }
}
