//! What the figures read of the method's notes.

use crate::culling::depth::{DepthNote, Faces};
use crate::culling::hierarchical_z::{Evidence, HierarchicalZ};
use crate::method::{Film, notes};

/// The step before the answer for a hidden node that read many cells, but no more than fit a picture: its
/// last read is right before it. The end of the film if there is none.
pub fn hidden_query<S: Faces>(film: &dyn Film<S>, most: u32) -> usize {
    let reads = |note: &Evidence<S>| match note {
        Evidence::Depth(DepthNote::Answered(n)) if n.answer.is_hidden && n.answer.reads <= most => {
            Some(n.answer.reads)
        }
        _ => None,
    };
    let answers = notes::<S, HierarchicalZ>(film).filter_map(|(at, note)| Some((reads(note)?, at)));
    let best = answers.max_by_key(|(reads, at)| (*reads, usize::MAX - at));
    best.map_or(film.events().len(), |(_, at)| at)
}
