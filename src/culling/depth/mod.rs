//! Depths drawn so far, and what they hide: tiles ([`Tiled`]), or the z-buffer with its z-pyramid
//! ([`Buffer`]), what is asked of them, and how all this is recorded and shown. What methods that ask for
//! depth share; it knows none of them.
//!
//! [`Tiled::clear`] for a view, [`Tiled::step`] to draw what a node holds, then [`Tiled::hides`]; what is
//! read goes to an [`Asking`]. Or [`Buffer::clear`], [`Buffer::step`] to draw primitives, then a [`Query`]
//! for a box, and a [`QueryReporter`]. A method whose large state is either changes it by its `step` alone,
//! and records each change as a [`DepthNote`].

mod answer;
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

pub use answer::{Answer, Decisive, Summary};
pub use buffer::{Buffer, Step};
pub use evidence::{
    Answered, Asking, DepthNote, Ground, QueryReporter, Rasterized, Stage, place, place_in_view, sight_lines,
};
pub use faces::{Faces, footprint, project_sphere};
pub use levels::TileLevels;
pub use query::Query;
pub use tiled::{TileStep, Tiled, deciding, ends};
