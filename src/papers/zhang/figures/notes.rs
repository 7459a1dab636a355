//! What the figures read of the method's notes.

use crate::culling::depth::Faces;
use crate::culling::occlusion_maps::{Evidence, Ground, OcclusionMaps};
use crate::geometry::{NodeId, PrimId};
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

/// The primitives that were drawn as occluders.
pub fn occluders<S: Faces>(film: &dyn Film<S>) -> Vec<PrimId> {
    let node = |note: &Evidence<S>| if let Evidence::Covered(c) = note { Some(c.node) } else { None };
    let nodes: Vec<NodeId> = notes::<S, OcclusionMaps>(film).filter_map(|(_, note)| node(note)).collect();
    nodes.iter().flat_map(|node| film.hierarchy().prims(*node).to_vec()).collect()
}

/// How many nodes were tested.
pub fn tests<S: Faces>(film: &dyn Film<S>) -> usize {
    notes::<S, OcclusionMaps>(film).filter(|(_, note)| matches!(note, Evidence::Answered(_))).count()
}

/// The step after the levels were made.
pub fn built<S: Faces>(film: &dyn Film<S>) -> usize {
    let at = notes::<S, OcclusionMaps>(film).find(|(_, note)| matches!(note, Evidence::Built(_)));
    at.map_or(film.events().len(), |(at, _)| at + 1)
}

/// Black samples of the maps, of all.
pub fn black<S: Faces>(film: &dyn Film<S>) -> [u32; 2] {
    let of = |note: &Evidence<S>| {
        if let Evidence::Built(built) = note { Some([built.black, built.samples]) } else { None }
    };
    notes::<S, OcclusionMaps>(film).find_map(|(_, note)| of(note)).unwrap_or_default()
}

/// What became of a primitive in the second phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It is outside the frustum.
    Outside,
    /// It is in a leaf that is not tested, since that is an occluder.
    Occluder,
    /// Not all of its leaf is behind the occluders.
    Before,
    /// All of it is behind, but not within what they cover.
    Shows,
    /// It is culled.
    Culled,
}

/// What became of each primitive, by id.
pub fn fates<S: Faces>(film: &dyn Film<S>) -> Vec<Fate> {
    let mut fates = vec![Fate::Outside; film.scene().prim_count()];
    let mut all = |node: NodeId, fate: Fate| {
        film.hierarchy().prims(node).iter().for_each(|prim| fates[prim.at()] = fate);
    };
    // Children come after their parents, and are better known.
    for (_, note) in notes::<S, OcclusionMaps>(film) {
        match note {
            Evidence::Tested(test) if test.result() == "outside" => {
                if let crate::drawing::Subject::Node(node) = test.subject() {
                    all(node, Fate::Outside);
                }
            }
            Evidence::Holds(node) => all(*node, Fate::Occluder),
            Evidence::Answered(answer) => {
                let fate = match answer.ground {
                    _ if answer.is_culled => Fate::Culled,
                    Ground::Overlap(_) => Fate::Shows,
                    _ => Fate::Before,
                };
                all(answer.node, fate);
            }
            _ => {}
        }
    }
    fates
}
