//! The culling methods, and the one shape they share.
//!
//! A method is written once and watched: [`Method::cull`] is generic over an [`Observer`] that returns
//! nothing and sees no state, so the function that runs at full speed is the one that is stepped.
//! To add a method: make a folder, implement [`Method`], add a `mod` line and a line in each list below.

mod baseline;
mod depth;
mod entry;
#[cfg(test)]
mod entry_tests;
mod event;
mod evidence;
mod hierarchical_z;
mod knobs;
mod large_occluders;
mod layered_projection;
mod method;

pub use entry::{Entry, Film, Recording, RestoreError, Run};
pub use event::{Event, Observer, Recorder, Tallied, Tally, Unobserved, Verdict};
pub use hierarchical_z::anatomy as obscuration;
pub use knobs::{Budget, Knob, KnobValue, Knobs, SettingError, Settings};
pub use large_occluders::anatomy;
pub use method::{Card, CodeLine, DrawList, Field, Limit, Method, Note, Value};

use crate::geometry::{Flat, Solid, Space};

/// Every method that runs in flatland, in the order of menus.
pub static FLAT: &[&dyn Entry<Flat>] = &[
    &entry::Of::<baseline::ZBuffer>::NEW,
    &entry::Of::<baseline::Frustum>::NEW,
    &entry::Of::<baseline::Centroid>::NEW,
    &entry::Of::<large_occluders::LargeOccluders>::NEW,
    &entry::Of::<hierarchical_z::HierarchicalZ>::NEW,
    &entry::Of::<layered_projection::LayeredProjection>::NEW,
];
/// Every method that runs in space, in the order of menus.
pub static SOLID: &[&dyn Entry<Solid>] = &[
    &entry::Of::<baseline::ZBuffer>::NEW,
    &entry::Of::<baseline::Frustum>::NEW,
    &entry::Of::<baseline::Centroid>::NEW,
    &entry::Of::<large_occluders::LargeOccluders>::NEW,
    &entry::Of::<hierarchical_z::HierarchicalZ>::NEW,
    &entry::Of::<layered_projection::LayeredProjection>::NEW,
];

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
