//! A finished run at any step.
//!
//! Three kinds of state, three costs: *stamps* (when each node and primitive was decided: O(1) at any
//! step, usable in a shader), *folds* (counts: O(log n)), and *keyframes* under large state, which the
//! film itself keeps. Step `k` is the state after the first `k` events.

pub mod format;
mod moves;
mod stamps;
#[cfg(test)]
mod tests;

pub use moves::{Detail, Moves};
pub use stamps::{Counts, Stamp, Stamps, State};
