//! Joint occlusion by connected occluders (Section 2).
//!
//! Occluders that partially occlude a box hide it together where the eye lies inside all their supporting
//! planes but those through edges that two of them share and lie on opposite sides of as seen from the eye.
//! Why that suffices: walk the border of their union as seen from the eye, each edge with its occluder on the
//! left; an edge that two share from opposite sides is walked both ways and cancels. If a point of the box
//! lies to the left of all that is left, every step turns counter-clockwise around it, so the border winds
//! around it, so some occluder covers it; and the box lies behind all their planes. A shared edge with both
//! on one side (a silhouette edge, Figure 4) does not cancel; an outline that is not convex (Figure 5 b) has
//! an edge whose line the box crosses; occluders that share nothing (5 c) keep all their edges.
//!
//! The largest set that passes is found by striking out, until nothing changes, each occluder with a failed
//! edge that no other one cancels. Whatever passes survives, since an edge that fails here fails in every
//! smaller set; so components need no separate search. Where more than two occluders share an edge the better
//! ranked ones are paired. Cost: O(edges of the candidates) a pass, rarely more than three passes.

use super::occluders::Occluders;
use super::relation::Classified;
use super::space::Shape;

/// An occluder that partially occludes the box, by rank.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    pub occluder: u32,
    /// On which side of it the eye is.
    pub side: i8,
    pub seen: Classified,
}

/// Tables by corner pair, kept from call to call.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// How many surviving candidates have the edge in each sense.
    count: Vec<[u8; 2]>,
    /// How many of them were passed in the walk by rank.
    passed: Vec<[u8; 2]>,
}

/// A set of candidates, by their place in the list.
pub type Members = u64;
/// How many candidates such a set has places for.
pub const MOST_CANDIDATES: usize = Members::BITS as usize;

/// The largest set of candidates that jointly hides the box; 0 if none does. At most 64 candidates.
pub fn jointly<S: Shape>(
    occluders: &Occluders<S>,
    candidates: &[Candidate],
    scratch: &mut Scratch,
) -> Members {
    // Only what lies wholly behind an occluder's plane can be hidden by it together with others.
    let mut alive: Members = 0;
    for (i, candidate) in candidates.iter().enumerate() {
        alive |= u64::from(candidate.seen.behind) << i;
    }
    // Only the first call grows them; every call leaves them at 0.
    scratch.count.resize(occluders.key_count(), [0; 2]);
    scratch.passed.resize(occluders.key_count(), [0; 2]);
    loop {
        // 1. How many of those left have each edge, in either sense.
        let before = alive;
        for candidate in living(candidates, before) {
            for &(key, sense) in occluders.keys(candidate.occluder) {
                scratch.count[key as usize][sense_seen(candidate, sense)] += 1;
            }
        }
        // 2. Strike out who has a failed edge that none of the others cancels: the k-th of one sense is
        // paired with the k-th of the other.
        for (i, candidate) in candidates.iter().enumerate().filter(|(i, _)| before >> i & 1 == 1) {
            for (edge, &(key, sense)) in occluders.keys(candidate.occluder).iter().enumerate() {
                let sense = sense_seen(candidate, sense);
                let at = scratch.passed[key as usize][sense];
                scratch.passed[key as usize][sense] += 1;
                let cancelled = at < scratch.count[key as usize][1 - sense];
                if candidate.seen.inside >> edge & 1 == 0 && !cancelled {
                    alive &= !(1 << i);
                }
            }
        }
        // 3. Clear what was counted, and nothing else: the tables are as long as the scene has edges.
        for candidate in living(candidates, before) {
            for &(key, _) in occluders.keys(candidate.occluder) {
                (scratch.count[key as usize], scratch.passed[key as usize]) = ([0; 2], [0; 2]);
            }
        }
        if alive == before || alive == 0 {
            return alive;
        }
    }
}

fn living(candidates: &[Candidate], alive: Members) -> impl Iterator<Item = &Candidate> {
    candidates.iter().enumerate().filter(move |(i, _)| alive >> i & 1 == 1).map(|(_, c)| c)
}

/// The sense of an edge as seen from the eye: mirrored from behind.
fn sense_seen(candidate: &Candidate, sense: bool) -> usize {
    usize::from(sense == (candidate.side > 0))
}
