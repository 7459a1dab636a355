//! Depths drawn so far, and what they hide: the z-buffer with its z-pyramid, the query of a box against it,
//! and how both are recorded and shown. What methods that query depth share; it knows none of them. What a
//! query reads goes to a [`Listener`].
//!
//! [`Buffer::clear`] for a view, [`Buffer::draw`] primitives, then [`hides`] for boxes. A method whose large
//! state is the buffer changes it by [`Buffer::step`] alone, and records each change as a [`DepthNote`].

mod buffer;
mod evidence;
mod faces;
mod levels;
pub mod picture;
mod planes;
mod query;
#[cfg(test)]
mod tests;
mod tiled;

pub use buffer::{Buffer, Step};
pub use evidence::{Answered, Asking, DepthNote, Ground, QueryReporter, Rasterized, Stage};
pub use faces::{Faces, footprint, project_sphere};
pub use query::{Answer, At, Decisive, Nobody, Query, hides};
pub use tiled::{TileStep, Tiled, deciding};
