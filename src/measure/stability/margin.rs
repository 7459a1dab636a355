//! How near a decision was to the opposite one.

use crate::geometry::{Space, View};
use crate::method::{Compared, Run, Verdict};

/// Events of a frame that are recorded; of a longer one no margin is told.
const MOST_EVENTS: usize = 4_000_000;

/// How far the two numbers of a test are apart, as a share of the larger one: 0 where they are equal.
pub fn relative(compared: &Compared) -> f64 {
    let (found, with) = (compared.found.1, compared.with.1);
    let size = found.abs().max(with.abs());
    if size > 0.0 { (found - with).abs() / size } else { 0.0 }
}

/// The least of these among the decisions of a frame that left something out; `None` where no evidence tells
/// both numbers. Records the frame, after what the run remembers.
pub(super) fn margin<S: Space>(run: &mut dyn Run<S>, view: &View<S>) -> Option<f64> {
    let film = run.record(view, MOST_EVENTS).film;
    if film.lost() > 0 {
        return None;
    }
    let decided = film.events().iter().enumerate().filter(|(_, event)| {
        event.verdict().is_some_and(|v| !matches!(v, Verdict::Partial | Verdict::Visible))
    });
    let margins = decided.filter_map(|(at, _)| Some(relative(&film.compared(film.evidence_of(at)?)?)));
    margins.reduce(f64::min)
}
