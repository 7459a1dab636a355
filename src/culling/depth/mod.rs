//! Depths drawn so far, and what they hide: the z-buffer with its z-pyramid, the query of a box against it,
//! and how both are recorded and shown. What methods that query depth share; it knows none of them. What a
//! query reads goes to a [`Listener`].
//!
//! [`Buffer::clear`] for a view, [`Buffer::draw`] primitives, then [`hides`] for boxes. A method whose large
//! state is the buffer changes it by [`Buffer::step`] alone, and records each change as a [`DepthNote`].

mod buffer;
mod evidence;
mod faces;
pub mod picture;
mod planes;
mod query;
#[cfg(test)]
mod tests;

pub use buffer::{Buffer, Step};
pub use evidence::{Answered, DepthNote, Ground, QueryReporter, Rasterized};
pub use faces::{Faces, footprint, project_sphere};
#[cfg(test)]
pub use query::Outcome;
pub use query::{Answer, At, Decisive, Held, Listener, Nobody, Query, hides, hides_all};
