//! Depths drawn so far, and what they hide: the z-buffer with its z-pyramid, and the query of a box against
//! it. What methods that ask for depth share; it knows none of them. Who wants to hear what a query reads is
//! a [`Listener`].
//!
//! [`Buffer::begin`] for a view, [`Buffer::draw`] primitives, then [`hides`] for boxes.

mod buffer;
mod faces;
mod query;

pub use buffer::Buffer;
pub use faces::{FaceImage, Faces, footprint, project_sphere};
pub use query::{Answer, Held, Listener, Nobody, Outcome, Query, Read, hides};
