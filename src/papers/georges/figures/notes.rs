//! What the figures read of the method's notes.

use crate::geometry::Space;
use crate::method::{Event, Film, Value};

/// The step at which the answer for a hidden node is given that read many cells, but no more than fit a
/// picture; its node.
pub fn hidden_query<S: Space>(film: &dyn Film<S>, most: u64) -> usize {
    let reads = |at: usize| {
        let (kind, fields) = film.fields(at);
        let is_hidden = fields.iter().any(|f| f.name == "hidden" && f.value == Value::Switch(true));
        let reads = fields.iter().find_map(|f| {
            if let ("cells_read", Value::Integer(n)) = (f.name, &f.value) { Some(*n) } else { None }
        });
        (kind == "ObscurationTested" && is_hidden).then_some(reads?).filter(|n| *n <= most)
    };
    let noted = (0..film.events().len()).filter(|&at| matches!(film.events()[at], Event::Noted(_)));
    let best = noted.filter_map(|at| Some((reads(at)?, at))).max_by_key(|(n, at)| (*n, usize::MAX - at));
    // The last read is right before the answer.
    best.map_or(film.events().len(), |(_, at)| at)
}
