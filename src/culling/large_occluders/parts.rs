//! The parts of the method by themselves: one eye, some occluders, one box. For figures, benchmarks and
//! tests, which all use the very functions that the method runs.

use super::joint::{Candidate, Scratch, jointly};
use super::occluders::{Occluders, area_angle};
use super::relation::{EyeSide, Margin, Planes, Relation};
use super::space::{Edge, Point as _, Shape, corner};
use crate::geometry::{Aabb, Vector, View};
use crate::scene::Face;

pub use super::relation::Occlusion;

/// A few occluders, out of any scene.
#[derive(Clone, Debug)]
pub struct Blockers<S: Shape> {
    occluders: Occluders<S>,
    margin: Margin,
}

/// A plane (a line in flatland) through an edge of an occluder and a corner of a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Tangent<V> {
    /// The edge: two points in space, one in flatland.
    pub edge: Vec<V>,
    /// The box corner where it touches.
    pub vertex: V,
    /// Unit normal, toward the occluder.
    pub normal: V,
    /// Signed distance of the eye from it, world units; positive inside.
    pub eye_distance: f64,
}

impl<S: Shape> Blockers<S> {
    /// Occluders from polygons (segments in flatland) over shared points, front side counter-clockwise.
    /// Polygons without area are left out, so check [`Blockers::len`].
    pub fn new(points: &[S::Vector], polygons: &[Vec<u32>]) -> Self {
        let faces: Vec<Face> =
            polygons.iter().map(|c| Face { corners: c.clone(), prims: Vec::new() }).collect();
        // Geometry first: the figures of Section 2 have no pixels. The primitives are missing since only a
        // traversal asks for them.
        Self { occluders: Occluders::new(points, &faces), margin: Margin::GEOMETRIC }
    }
    /// Uses the pixel margin of `view` instead of the geometric one.
    pub fn for_view(mut self, view: &View<S>) -> Self {
        self.margin = Margin::of(view);
        self
    }
    /// How many there are.
    pub fn len(&self) -> usize {
        self.occluders.len()
    }
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn candidate(&self, id: u32, bounds: &Aabb<S::Vector>, eye: S::Vector) -> Option<Candidate> {
        let eye_side = EyeSide::of(&self.occluders, id, S::widened(eye), self.margin);
        // Within the slab, or nearer to it than the margin allows: as in a run it hides nothing.
        if eye_side.side == 0 {
            return None;
        }
        let relation = Relation::new(&self.occluders, id, eye_side.side, bounds, false);
        // The distance, which the view depth never exceeds: the margin grows with depth, so this errs on the
        // safe side, and no line of sight is needed.
        let depth = bounds.corners().map(|c| (S::widened(c) - S::widened(eye)).length()).fold(0.0, f64::max);
        let seen = relation.classify(&eye_side, self.occluders.thickness(id), depth, self.margin);
        Some(Candidate { occluder: id, side: eye_side.side, seen })
    }
    /// What one occluder does to a box (Section 2).
    pub fn classify(&self, id: usize, bounds: &Aabb<S::Vector>, eye: S::Vector) -> Occlusion {
        self.candidate(id as u32, bounds, eye).map_or(Occlusion::None, |c| c.seen.occlusion)
    }
    /// The occluders that hide a box: one, or several together; empty if it is not hidden.
    pub fn hiding(&self, bounds: &Aabb<S::Vector>, eye: S::Vector) -> Vec<usize> {
        // As in TestOcclusion: one alone first, then those that partially occlude together.
        let all = (0..self.len() as u32).filter_map(|id| self.candidate(id, bounds, eye));
        let candidates: Vec<Candidate> = all.filter(|c| c.seen.occlusion != Occlusion::None).collect();
        if let Some(full) = candidates.iter().find(|c| c.seen.occlusion == Occlusion::Full) {
            return vec![full.occluder as usize];
        }
        let members = jointly(&self.occluders, &candidates, &mut Scratch::default());
        candidates
            .iter()
            .enumerate()
            .filter(|(i, _)| members >> i & 1 == 1)
            .map(|(_, c)| c.occluder as usize)
            .collect()
    }
    /// The supporting and the separating plane through each edge of an occluder, for an eye; `None` where the
    /// edge's line meets the box, empty where the box lies on the eye's side.
    pub fn planes(
        &self,
        id: usize,
        bounds: &Aabb<S::Vector>,
        eye: S::Vector,
    ) -> Vec<Option<[Tangent<S::Vector>; 2]>> {
        let eye_side = EyeSide::of(&self.occluders, id as u32, S::widened(eye), self.margin);
        // An eye in the occluder's plane is on no side; figures show the planes as from the front.
        let relation = Relation::new(
            &self.occluders,
            id as u32,
            if eye_side.side == 0 { 1 } else { eye_side.side },
            bounds,
            false,
        );
        let outline = self.occluders.outline(id as u32);
        let tangents = relation.planes.iter().enumerate().map(|(i, planes)| {
            let Planes::Tangent(pair) = planes else { return None };
            // Each end of a segment is an edge; an edge of a polygon runs on to the next corner.
            let edge = if outline.len() == 2 {
                vec![outline[i]]
            } else {
                vec![outline[i], outline[(i + 1) % outline.len()]]
            };
            Some((*pair).map(|plane| Tangent {
                vertex: S::rounded(corner::<S>(bounds, plane.vertex)),
                normal: plane.normal,
                // From the first corner of the edge, as the run measures: the plane contains it, so it needs
                // no offset.
                eye_distance: S::widened(plane.normal).dot(S::widened(eye) - S::widened(edge[0])),
                edge: edge.clone(),
            }))
        });
        tangents.collect()
    }
    /// The area-angle of an occluder from a point (Section 3.1).
    pub fn area_angle(&self, id: usize, from: S::Vector) -> f64 {
        area_angle(self.occluders.get(id as u32), S::widened(from))
    }
    /// The relation of every occluder to a box, made anew, for timing; `naive`: without the table. Returns a
    /// number that depends on all of them.
    pub fn make_relations(&self, bounds: &Aabb<S::Vector>, eye: S::Vector, naive: bool) -> f64 {
        // An Eye within a slab counts as in front: every occluder is to cost one relation.
        let side = |id: u32| EyeSide::of(&self.occluders, id, S::widened(eye), Margin::GEOMETRIC).side;
        let arm = |planes: &Planes<S::Vector>| {
            if let Planes::Tangent([plane, _]) = planes { f64::from(plane.normal.get(0)) } else { 1.0 }
        };
        let relation =
            |id: u32| Relation::new(&self.occluders, id, if side(id) < 0 { -1 } else { 1 }, bounds, naive);
        (0..self.len() as u32).map(|id| relation(id).planes.iter().map(arm).sum::<f64>()).sum()
    }
}

/// The relations of some occluders to some boxes, made once and kept.
#[derive(Clone, Debug)]
pub struct Kept<S: Shape> {
    relations: Vec<Relation<S>>,
    depths: Vec<f64>,
}

impl<S: Shape> Blockers<S> {
    /// The relations of all occluders to boxes, for an eye.
    pub fn keep(&self, boxes: &[Aabb<S::Vector>], eye: S::Vector) -> Kept<S> {
        // A pixel margin may take a side away, but it cannot turn it round: the geometric one is enough here.
        let side = |id: u32| {
            if EyeSide::of(&self.occluders, id, S::widened(eye), Margin::GEOMETRIC).side < 0 { -1 } else { 1 }
        };
        // Box by box, so that [`Blockers::check`] can take them apart again.
        let all = boxes.iter().flat_map(|b| (0..self.len() as u32).map(move |id| (b, id)));
        let relations = all.map(|(b, id)| Relation::new(&self.occluders, id, side(id), b, false)).collect();
        let depth = |b: &Aabb<S::Vector>| {
            b.corners().map(|c| (S::widened(c) - S::widened(eye)).length()).fold(0.0, f64::max)
        };
        Kept { relations, depths: boxes.iter().map(depth).collect() }
    }
    /// Classifies kept relations from an eye on the same sides of the occluders, for timing; each occluder is
    /// prepared once, as in a frame. Returns how many are partial, and how many full.
    pub fn check(&self, kept: &Kept<S>, eye: S::Vector) -> [usize; 2] {
        let eye_sides: Vec<EyeSide<S>> = (0..self.len() as u32)
            .map(|id| EyeSide::of(&self.occluders, id, S::widened(eye), self.margin))
            .collect();
        let mut counts = [0; 2];
        // As many relations a box as there are occluders, at least 1, since a chunk must not be empty. A
        // relation for the other side of its occluder says nothing, as in a run.
        for (relations, depth) in kept.relations.chunks(self.len().max(1)).zip(&kept.depths) {
            for (relation, eye_side) in relations.iter().zip(&eye_sides).filter(|(r, s)| r.side == s.side) {
                let seen = relation.classify(
                    eye_side,
                    self.occluders.thickness(relation.occluder),
                    *depth,
                    self.margin,
                );
                counts[0] += usize::from(seen.occlusion == Occlusion::Partial);
                counts[1] += usize::from(seen.occlusion == Occlusion::Full);
            }
        }
        counts
    }
}

/// One of the two of [`tangent_corners`], for timing: by table, or by looking at every corner.
pub fn tangent_corners_by<S: Shape>(
    from: S::Vector,
    to: S::Vector,
    bounds: &Aabb<S::Vector>,
    naive: bool,
) -> Option<[u8; 2]> {
    let edge = Edge { from: S::widened(from), along: S::widened(to) - S::widened(from) };
    if naive { S::tangents_naive(&edge, bounds) } else { S::tangents(&edge, bounds) }
}

/// The two box corners at which planes through an edge touch it, by table and by looking at every corner
/// (Section 2.1); `None` where the edge's line meets the box. In flatland `to` is not used.
pub fn tangent_corners<S: Shape>(
    from: S::Vector,
    to: S::Vector,
    bounds: &Aabb<S::Vector>,
) -> [Option<[u8; 2]>; 2] {
    let edge = Edge { from: S::widened(from), along: S::widened(to) - S::widened(from) };
    [S::tangents(&edge, bounds), S::tangents_naive(&edge, bounds)]
}

pub use super::space::{outline_seen_from, sides_of_outline};
