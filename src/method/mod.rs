//! What a method is: the one shape that all methods share, what they report while they work, and how a run becomes
//! a film. It knows no method; those are in [`crate::culling`].

mod contract;
mod entry;
#[cfg(test)]
mod entry_tests;
mod event;
pub mod evidence;
mod knobs;

pub use contract::{Card, CodeLine, DrawList, Field, Limit, Method, Note, Value};
pub use entry::{Entry, Film, Recording, Reel, RestoreError, Run};
pub(crate) use entry::{Of, params};
pub use event::{Event, Observer, Recorder, Tallied, Tally, Unobserved, Verdict};
pub(crate) use knobs::backface_knob;
pub use knobs::{Budget, Knob, KnobValue, Knobs, SettingError, Settings};
