//! What the figures read of the method's notes.

use crate::culling::depth::Faces;
use crate::culling::occlusion_maps::{Evidence, Ground, OcclusionMaps};
use crate::method::{Film, notes};

/// The step before the answer for a node that is culled and for which many map pixels were read, but no more
/// than fit a picture. The end of the film if there is none.
pub fn culled_node<S: Faces>(film: &dyn Film<S>, most: u32) -> usize {
    let reads = |note: &Evidence<S>| match note {
        Evidence::Answered(n) if n.is_culled => match n.ground {
            Ground::Overlap(found) if found.reads <= most => Some(found.reads),
            _ => None,
        },
        _ => None,
    };
    let answers = notes::<S, OcclusionMaps>(film).filter_map(|(at, note)| Some((reads(note)?, at)));
    let best = answers.max_by_key(|(reads, at)| (*reads, usize::MAX - at));
    best.map_or(film.events().len(), |(_, at)| at)
}

/// How many primitives were drawn as occluders.
pub fn occluder_prims<S: Faces>(film: &dyn Film<S>) -> u32 {
    let polygons = |note: &Evidence<S>| match note {
        Evidence::Chosen(choice) if choice.is_taken => Some(choice.candidate.polygons),
        _ => None,
    };
    notes::<S, OcclusionMaps>(film).filter_map(|(_, note)| polygons(note)).sum()
}
