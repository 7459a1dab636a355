//! One occluder and one box: supporting and separating planes (Section 2).
//!
//! Everything here is about the viewpoint P, one edge e of the occluder, and a corner t of the box. P lies
//! inside the plane through e and t exactly if t lies on the occluder's side of the plane through P and e.
//! Inside all
//! *supporting* planes, every corner of the box lies on the occluder's side of every edge: full occlusion.
//! Inside all *separating* planes, some corner does: partial occlusion. Besides, the occluder's own plane
//! must separate P and the box; where it cuts the box, what lies behind it can still be occluded, so that is
//! partial too.
//!
//! # The margin
//! The answer is to hold for the image, so a point that is called hidden must be hidden at every pixel center
//! that any triangle through it could reach. Vertices are snapped to 1/256 pixel, so both outlines move by up
//! to ε = √2/512 pixel, together 2ε. It suffices that every corner t of the box lies inside the plane through
//! P and e by at least `lateral = δ·W` world units, with δ > 2ε pixels at unit depth and W the greatest view
//! depth of the box. Let s be the least distance of the box behind the occluder's plane, h the height of P
//! above it, |r| the distance of P from e's line, and ψ the angle between the plane through P and e and the
//! nearest tangent plane. No corner is nearer to the line than s, and none makes an angle with the plane
//! through P and e that is nearer to 0 than ψ or nearer to π than P's own height: so each is inside by
//! s·min(sin ψ, h/|r|) or more. As
//! `|r|·sin ψ` is P's distance from the supporting plane, the condition is
//! `s · min(distance, h) ≥ |r| · lateral`, plus what f64 rounds (see [`ROUNDING`]).
//! Depth: at the pixel, the occluder is nearer by s/(h·w) in 1/w, and snapping moves it by at most 2ε·px/h.
//! A fragment of either may be off by [`DEPTH_TILT`] of its depth, since planes go on a little beyond edges.
//! So `s ≥ lateral + (2·DEPTH_TILT + DEPTH_ROUNDING)·(h + thickness)` keeps it in front; where boxes hold
//! parts of primitives the share is greater (see `walk`).

use super::occluders::Occluders;
use super::space::{Point, Shape, corner};
use crate::geometry::{Aabb, View};
use crate::raster::DEPTH_TILT;

/// δ of the margin in pixels: 1/128, where 2ε is 1/181.
const SNAP_PX: f64 = 1.0 / 128.0;
/// Relative error of the 1/w that the rasterizer interpolates in 32 bits.
const DEPTH_ROUNDING: f64 = 1.0 / (1u32 << 17) as f64;
/// Relative error of a distance in f64, generously: a normal of products of exact differences, one sum of
/// three products, is within 20 roundings of 2⁻⁵³; a tangent corner that lost a tie is off by as much.
const ROUNDING: f64 = 1.0 / (1u64 << 46) as f64;

/// Relative error of a distance by a unit normal that is kept in 32 bits.
const NORMAL_ROUNDING: f64 = 1.0 / (1u32 << 22) as f64;

/// A plane through an edge of the occluder and a corner of the box. Kept in 32 bits: what is kept from frame
/// to frame is read from main memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane<V> {
    /// Unit length, toward the occluder.
    pub normal: V,
    /// The corner of the box.
    pub vertex: u8,
}

/// The two planes through an edge that touch the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Planes<V> {
    /// The edge's line meets the box.
    Crossing,
    /// Occluder and box on one side of the first; on opposite sides of the second. Where the occluder's plane
    /// cuts the box there is no such order.
    Tangent([Plane<V>; 2]),
}

/// The planes by edge; those of up to four edges lie where the relation lies.
#[derive(Clone, Debug)]
pub struct PlaneList<V> {
    few: [Planes<V>; 4],
    count: u8,
    many: Vec<Planes<V>>,
}

impl<V: Copy> PlaneList<V> {
    const EMPTY: Self = Self { few: [Planes::Crossing; 4], count: 0, many: Vec::new() };
    fn push(&mut self, planes: Planes<V>) {
        if let (Some(to), true) = (self.few.get_mut(self.count as usize), self.many.is_empty()) {
            *to = planes;
            self.count += 1;
        } else {
            // The fifth edge moves the first four, so that they all lie in one place.
            if self.many.is_empty() {
                self.many.extend_from_slice(&self.few);
            }
            self.many.push(planes);
        }
    }
}

impl<V> std::ops::Deref for PlaneList<V> {
    type Target = [Planes<V>];
    #[inline]
    fn deref(&self) -> &[Planes<V>] {
        if self.many.is_empty() { &self.few[..self.count as usize] } else { &self.many }
    }
}

/// What does not change about an occluder and a box while the eye stays on one side of the occluder.
#[derive(Clone, Debug)]
pub struct Relation<S: Shape> {
    pub occluder: u32,
    /// On which side of the occluder the eye is: 1 in front, −1 behind.
    pub side: i8,
    /// Distances of the box's nearest and farthest corner behind the occluder, world units; negative: on the
    /// eye's side.
    pub behind: [f64; 2],
    /// Greatest distance of a tangent corner from its edge, world units; for the error bound.
    arm: f64,
    /// Diagonal of the box.
    diagonal: f64,
    /// By edge; empty where the box lies wholly on the eye's side.
    pub planes: PlaneList<S::Vector>,
}

/// The kinds of occlusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occlusion {
    /// Region 1 of Figure 2.
    None,
    /// Region 2: part of the box may be hidden.
    Partial,
    /// Region 3: all of it is.
    Full,
}

/// What an occluder does to a box, as seen from an eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Classified {
    pub occlusion: Occlusion,
    /// The edges, as bits, whose supporting plane the eye is inside of by more than the margin.
    pub inside: u64,
    /// Whether the box lies behind the occluder's plane by more than the margin.
    pub behind: bool,
}

/// The eye against the two planes of an edge: signed distances, world units, positive inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeTest {
    /// From the supporting plane.
    pub supporting: f64,
    /// What that must reach for full occlusion; infinite where the occluder's plane cuts the box.
    pub needed: f64,
    /// From the separating plane, which must exceed 0.
    pub separating: f64,
}

/// A plane that decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decisive {
    /// Whether it is a supporting plane; a separating one otherwise.
    pub is_supporting: bool,
    /// The edge, and the corner of the box, that span the plane.
    pub edge: u8,
    pub vertex: u8,
    /// Signed distance of the eye from the plane, world units; positive inside.
    pub distance: f64,
    /// What it must reach.
    pub needed: f64,
}

/// What decided a classification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// The box lies wholly on the eye's side of the occluder.
    Before,
    /// The occluder's plane cuts the box: only what lies behind it can be occluded.
    Cut,
    /// The first separating plane that the eye is outside of; for partial and full occlusion the supporting
    /// plane that it is least inside of.
    Plane(Decisive),
    /// The line of this edge meets the box, so no plane through it supports the box.
    Crossing(u8),
    /// The box lies behind the occluder's plane by less than this distance, world units, which pixels need.
    Near(f64),
}

/// An occluder as the eye sees it in one frame.
#[derive(Clone, Debug, Default)]
pub struct EyeSide<S: Shape> {
    /// 1: the eye is in front; −1: behind; 0: it cannot hide anything from here.
    pub side: i8,
    /// Distance of the eye from the occluder's slab, world units.
    pub height: f64,
    /// By edge: the eye from the edge's first corner, that vector's length, and the eye's distance from the
    /// edge's line.
    pub edges: Vec<(S::Point, f64, f64)>,
    /// The greatest of those distances.
    reach: f64,
}

/// What a view demands before it calls anything hidden.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    /// World units per unit of view depth.
    pub lateral: f64,
    /// How much nearer than what it hides an occluder must be, relative to its distance.
    pub depth: f64,
    /// Least height of the eye above an occluder: below it the near plane may cut a hole that the eye looks
    /// through.
    pub height: f64,
}

impl Margin {
    /// Occlusion in the sense of geometry: no pixels, no near plane; only what f64 rounds is on the safe
    /// side.
    pub const GEOMETRIC: Self = Self { lateral: 0.0, depth: DEPTH_ROUNDING, height: 0.0 };
    /// The margin of a view.
    pub fn of<S: Shape>(view: &View<S>) -> Self {
        let tan = f64::from(view.eye.fov * 0.5).tan();
        // The field of view spans the height of an image of space, and the width of one of flatland.
        let pixels = if Relation::<S>::AXES > 2 { view.height } else { view.width };
        // A ray within the image makes at most this angle with the line of sight; a hundredth for the snapped
        // border.
        let secant = (1.0 + Self::spread(view).powi(2)).sqrt();
        Self {
            lateral: SNAP_PX * 2.0 * tan / f64::from(pixels),
            depth: 2.0 * DEPTH_TILT + DEPTH_ROUNDING,
            height: f64::from(view.eye.near) * secant * 1.01,
        }
    }
    /// The tangent of the angle from the line of sight to a corner of the image.
    pub fn spread<S: Shape>(view: &View<S>) -> f64 {
        let tan = f64::from(view.eye.fov * 0.5).tan();
        let aspect = f64::from(view.width) / f64::from(view.height.max(1));
        if Relation::<S>::AXES > 2 { tan * (1.0 + aspect * aspect).sqrt() } else { tan }
    }
}

impl<S: Shape> EyeSide<S> {
    /// How `eye` sees an occluder.
    pub fn of(occluders: &Occluders<S>, id: u32, eye: S::Point, margin: Margin) -> Self {
        let mut eye_side = Self::default();
        eye_side.look(occluders, id, eye, margin);
        eye_side
    }
    /// Looks again, at an occluder of any kind.
    pub fn look(&mut self, occluders: &Occluders<S>, id: u32, eye: S::Point, margin: Margin) {
        let occluder = occluders.get(id);
        let at = occluder.normal.dot(eye - occluder.anchor);
        let [low, high] = occluder.slab;
        // Within the slab the height is negative: the eye sees the occluder from its edge, if at all.
        let (side, height) = if at > high { (1, at - high) } else { (-1, low - at) };
        (self.side, self.height, self.reach) = (side, height, 0.0);
        self.edges.clear();
        if height.is_nan() || height < margin.height {
            self.side = 0;
            return;
        }
        for edge in occluders.edges(id) {
            let r = eye - edge.from;
            let distance = S::distance(edge, r);
            self.reach = self.reach.max(distance);
            self.edges.push((r, r.length(), distance));
        }
    }
}

impl<S: Shape> Relation<S> {
    /// Computes the planes; `naive` looks at every corner of the box instead of the table.
    pub fn new(occluders: &Occluders<S>, id: u32, side: i8, bounds: &Aabb<S::Vector>, naive: bool) -> Self {
        let occluder = occluders.get(id);
        // Distances behind the slab, not the plane: of a polygon that is planar only up to rounding, what
        // lies within the slab is neither before nor behind it.
        let [low, high] = occluders.heights(id, bounds);
        let behind = if side > 0 {
            [occluder.slab[0] - high, occluder.slab[0] - low]
        } else {
            [low - occluder.slab[1], high - occluder.slab[1]]
        };
        let diagonal = (corner::<S>(bounds, (1 << Self::AXES) - 1) - corner::<S>(bounds, 0)).length();
        let mut relation = Self { occluder: id, side, behind, arm: 0.0, diagonal, planes: PlaneList::EMPTY };
        // Wholly on the eye's side nothing of the box can be hidden, whatever the planes: none are made.
        if behind[1] > 0.0 {
            let edges = occluders.edges(id);
            for edge in edges {
                let touched = if naive { S::tangents_naive(edge, bounds) } else { S::tangents(edge, bounds) };
                let planes =
                    touched.map_or(Planes::Crossing, |touched| relation.tangent(edge, touched, bounds));
                relation.planes.push(planes);
            }
        }
        relation
    }

    const AXES: usize = <S::Vector as crate::geometry::Vector>::AXES;

    fn tangent(
        &mut self,
        edge: &super::space::Edge<S::Point>,
        touched: [u8; 2],
        bounds: &Aabb<S::Vector>,
    ) -> Planes<S::Vector> {
        // Section 2.1: only planes through edges of the occluder and corners of the box. Those through its
        // corners and edges of the box are left out, which leaves full occlusion exact.
        let side = f64::from(self.side);
        let arms = touched.map(|vertex| corner::<S>(bounds, vertex) - edge.from);
        let normals = arms.map(|arm| S::through(edge, arm) * side);
        // A corner on the edge's line spans no plane with it: the line meets the box there.
        if normals.iter().any(|normal| normal.length() == 0.0) {
            return Planes::Crossing;
        }
        let normals = normals.map(|normal| normal * (1.0 / normal.length()));
        let plane = |i: usize| Plane { normal: S::rounded(normals[i]), vertex: touched[i] };
        self.arm = self.arm.max(arms[0].length()).max(arms[1].length());
        // The other corner lies on the positive side of the supporting plane.
        Planes::Tangent(if normals[0].dot(arms[1]) >= 0.0 {
            [plane(0), plane(1)]
        } else {
            [plane(1), plane(0)]
        })
    }

    /// The classification from an eye. `thickness`: of the occluder's slab; `depth`: the greatest view depth
    /// of the box.
    #[inline]
    pub fn classify(&self, eye_side: &EyeSide<S>, thickness: f64, depth: f64, margin: Margin) -> Classified {
        let mut found = Classified { occlusion: Occlusion::None, inside: 0, behind: false };
        if self.planes.is_empty() {
            return found;
        }
        // s, `lateral` and the condition on depth of the module's margin.
        let [s, _] = self.behind;
        let lateral = margin.lateral * depth.max(0.0);
        found.behind = s > 0.0
            && s >= lateral + margin.depth * (eye_side.height + thickness + s)
            && s * eye_side.height >= eye_side.reach * lateral;
        let (lateral, blur) = self.blurred(lateral);
        // Figure 2: outside one separating plane is region 1, inside all supporting ones region 3, the rest
        // region 2.
        let mut inside = 0;
        for (i, (planes, &(r, length, distance))) in self.planes.iter().zip(&eye_side.edges).enumerate() {
            let Planes::Tangent([supporting, separating]) = planes else { continue };
            let (reached, touched) =
                (S::widened(supporting.normal).dot(r), S::widened(separating.normal).dot(r));
            // Where the occluder's plane cuts the box, either corner will do.
            let partial = if s > 0.0 { touched > 0.0 } else { touched > 0.0 || reached > 0.0 };
            if !partial {
                found.behind = false;
                return found;
            }
            // s · distance ≥ |r| · lateral, with what rounding may add.
            inside |= u64::from(reached * s >= distance * lateral + blur * length) << i;
        }
        // Joint occlusion argues with these bits, so they too count only behind the occluder's plane.
        found.inside = if found.behind { inside } else { 0 };
        // At least one edge here and at most 64, so the shift is sound.
        let all = u64::MAX >> (64 - self.planes.len());
        found.occlusion = if found.inside == all { Occlusion::Full } else { Occlusion::Partial };
        found
    }

    /// What a lost tie between two tangent corners may turn a plane by, on top of `lateral`; and what
    /// rounding may move it.
    #[inline]
    fn blurred(&self, lateral: f64) -> (f64, f64) {
        let s = self.behind[0];
        (lateral + ROUNDING * self.arm * self.diagonal / s, ROUNDING * (self.arm + s) + NORMAL_ROUNDING * s)
    }

    /// The tests that a classification made, edge by edge, up to the one that ended it; `None` where the line
    /// of the edge meets the box.
    pub fn edge_tests(
        &self,
        eye_side: &EyeSide<S>,
        depth: f64,
        margin: Margin,
    ) -> impl Iterator<Item = Option<EdgeTest>> {
        let s = self.behind[0];
        let (lateral, blur) = self.blurred(margin.lateral * depth.max(0.0));
        let mut ended = false;
        self.planes.iter().zip(&eye_side.edges).map_while(move |(planes, &(r, length, distance))| {
            if ended {
                return None;
            }
            let Planes::Tangent([supporting, separating]) = planes else { return Some(None) };
            let supporting = S::widened(supporting.normal).dot(r);
            let separating = S::widened(separating.normal).dot(r);
            let needed = if s > 0.0 { (distance * lateral + blur * length) / s } else { f64::INFINITY };
            ended = separating <= 0.0 && (s > 0.0 || supporting <= 0.0);
            Some(Some(EdgeTest { supporting, needed, separating }))
        })
    }

    /// What decided a classification; for explanations.
    pub fn reason(
        &self,
        eye_side: &EyeSide<S>,
        seen: Classified,
        thickness: f64,
        depth: f64,
        margin: Margin,
    ) -> Reason {
        let s = self.behind[0];
        if self.planes.is_empty() {
            return Reason::Before;
        }
        let decisive = |edge: usize, test: EdgeTest, is_supporting: bool| {
            let Planes::Tangent([supporting, separating]) = self.planes[edge] else { return None };
            let edge = edge as u8;
            Some(if is_supporting {
                let (distance, needed) = (test.supporting, test.needed);
                Decisive { is_supporting, edge, vertex: supporting.vertex, distance, needed }
            } else {
                Decisive {
                    is_supporting,
                    edge,
                    vertex: separating.vertex,
                    distance: test.separating,
                    needed: 0.0,
                }
            })
        };
        let tests = || self.edge_tests(eye_side, depth, margin).enumerate();
        if seen.occlusion == Occlusion::None {
            // The last test is the one that failed.
            let failed = tests().last().and_then(|(edge, test)| decisive(edge, test?, false));
            return failed.map_or(Reason::Before, Reason::Plane);
        }
        if s <= 0.0 {
            return Reason::Cut;
        }
        let spare = |d: &Decisive| d.distance - d.needed;
        let closest = tests()
            .filter_map(|(edge, test)| decisive(edge, test?, true))
            .min_by(|a, b| spare(a).total_cmp(&spare(b)));
        let crossing = self.planes.iter().position(|planes| matches!(planes, Planes::Crossing));
        match (closest, crossing) {
            (Some(d), _) if spare(&d) < 0.0 || seen.occlusion == Occlusion::Full => Reason::Plane(d),
            (_, Some(edge)) => Reason::Crossing(edge as u8),
            // Inside of all planes and not called hidden: what is left of `classify` are its two conditions
            // on the distance behind the occluder's plane.
            _ => {
                let lateral = margin.lateral * depth.max(0.0);
                let front = lateral + margin.depth * (eye_side.height + thickness + s);
                Reason::Near(front.max(eye_side.reach * lateral / eye_side.height))
            }
        }
    }
}
