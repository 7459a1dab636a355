//! (film, step, look) → drawing: every picture in the explorer and in the documentation.
//!
//! [`world`] draws a step in world coordinates, [`Sheet`] and [`project`] put it on paper.

mod clip;
mod look;
mod panels;
mod place;

pub use clip::clip;
pub use look::{Look, observer_above, role_of, world};
pub use panels::{Panel, Picture, panels};
pub use place::{Sheet, project};
