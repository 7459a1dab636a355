//! What a method is: the one shape that all methods share, what they report while they work, and how a run
//! becomes a film. It knows no method; those are in [`crate::culling`].

mod card;
mod contract;
mod event;
pub mod evidence;
mod film;
mod knobs;
mod note;
mod run;
#[cfg(test)]
mod tests;
mod words;

pub(crate) use card::line;
pub use card::{Card, CodeLine, Departure, When, departs};
pub(crate) use contract::keeps_nothing;
pub use contract::{Derived, DrawList, Frame, Hiders, Limit, Method, Moment, Shown, State};
pub use event::{Event, Observer, Recorder, Tallied, Tally, Unobserved, Verdict};
pub use film::{Film, Reel, notes};
pub(crate) use knobs::surface_knobs;
pub use knobs::{Budget, Knob, KnobValue, Knobs, SettingError, Settings, is_of_surfaces, surfaces_of};
pub use note::{Claim, Compared, Context, Field, Note, Value};
pub use run::{Entry, Recording, RestoreError, Run, settings_for};
pub(crate) use run::{Of, params};
pub use words::Words;
pub(crate) use words::words;
