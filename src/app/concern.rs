//! Which events of a film are about a thing: a primitive with the object that it belongs to, an object with
//! all of its primitives; and the decisions that took them in without naming them, with the evidence on which
//! these rest.

use super::stage::{Reading, SceneFacts};
use crate::drawing::Subject;

/// A thing, and the decisions that hold for it.
pub struct Concern<'a> {
    film: Reading<'a>,
    scene: &'a dyn SceneFacts,
    subject: Subject,
    /// Events that decided the primitive, or a primitive of the object, and what they rest on; ascending.
    decisions: Vec<usize>,
}

impl<'a> Concern<'a> {
    /// Looks up once what decided the thing. O(primitives) for an object.
    pub fn of(film: Reading<'a>, scene: &'a dyn SceneFacts, subject: Subject) -> Self {
        let prims = match subject {
            Subject::Prim(prim) if scene.has_prim(prim) => vec![prim],
            Subject::Object(object) => scene.prims_of(object),
            _ => vec![],
        };
        let decided = |&p: &_| film.stamps.prim_decision(p).map(|(at, _)| at - 1);
        let mut decisions: Vec<usize> = prims.iter().filter_map(decided).collect();
        decisions.sort_unstable();
        decisions.dedup();
        let grounds: Vec<usize> = decisions.iter().filter_map(|&at| film.reel.evidence_of(at)).collect();
        decisions.extend(grounds);
        decisions.sort_unstable();
        decisions.dedup();
        Self { film, scene, subject, decisions }
    }
    /// Whether event `at` is about it.
    pub fn holds(&self, at: usize) -> bool {
        let about = self.film.reel.subject(at);
        let same = match (self.subject, about) {
            (Subject::Object(object), Subject::Prim(prim)) => self.scene.object_of(prim) == object,
            // Tests of a small object are tests of each of its primitives.
            (Subject::Prim(prim), Subject::Object(object)) => {
                self.scene.has_prim(prim) && self.scene.object_of(prim) == object
            }
            (wanted, about) => wanted == about && wanted != Subject::None,
        };
        same || self.decisions.binary_search(&at).is_ok()
    }
}
