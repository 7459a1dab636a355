//! The one harness of all experiments: methods ready to run on a scene ([`ready()`]), the views that they are
//! run at ([`path`](mod@path), [`Walk`]), their times ([`in_turns`], [`times_of`]), and the judge of their
//! answers ([`Judge`]).

mod judge;
mod load;
pub mod path;
mod ready;
mod turns;
mod walk;

pub use judge::{CHECKING, Checked, Difference, Judge, draw};
pub use load::under_load;
pub use ready::{checkpoint, part, ready, restore_or_build, settings};
pub use turns::{FRAME_TIMES, ROUNDS, Turn, frame, in_turns, mean};
pub use walk::{Moment, Stretch, WALK_TIMES, Walk, times, times_of};
