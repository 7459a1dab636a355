//! The culling methods, and the list of them. What a method is says [`crate::method`].
//!
//! A method is written once and watched: [`crate::method::Method::cull`] is generic over an observer that
//! returns nothing and sees no state, so the function that runs at full speed is the one that is stepped.
//! To add a method: make a folder, implement [`crate::method::Method`] and [`crate::method::Shown`], add its
//! `mod` line and its line in the list below.

pub(crate) mod baseline;
pub(crate) mod color_cubes;
mod cubes;
pub(crate) mod depth;
pub(crate) mod hierarchical_z;
pub(crate) mod large_occluders;
pub(crate) mod layered_projection;
pub(crate) mod occlusion_maps;
pub(crate) mod parallel_hierarchical_z;
mod saved;

pub use hierarchical_z::parts as hierarchical_z_parts;
pub use large_occluders::anatomy;
pub(crate) use occlusion_maps::parts as occlusion_maps_parts;

use crate::geometry::{Flat, Solid, Space};
use crate::method::{Entry, Of};

/// The list of methods, in the order of menus: each runs in flatland and in space.
macro_rules! methods {
    ($($method:ty,)*) => {
        /// Every method that runs in flatland.
        pub static FLAT: &[&dyn Entry<Flat>] = &[$(&Of::<$method>::NEW,)*];
        /// Every method that runs in space.
        pub static SOLID: &[&dyn Entry<Solid>] = &[$(&Of::<$method>::NEW,)*];
    };
}

methods! {
    baseline::ZBuffer,
    baseline::Frustum,
    baseline::Centroid,
    large_occluders::LargeOccluders,
    hierarchical_z::HierarchicalZ,
    parallel_hierarchical_z::ParallelHierarchicalZ,
    layered_projection::LayeredProjection,
    occlusion_maps::OcclusionMaps,
    color_cubes::ColorCubes,
}

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
