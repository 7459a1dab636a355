//! Which leaves of the occluder database are drawn as occluders (Zhang et al. 1997, Section 5.3.2).

use std::cmp::Ordering;

use super::index::Databases;
use crate::geometry::{Aabb, Frustum, FrustumTest, NodeId, Projection, Space, Vector, View, nearest_depth};
use crate::method::words;
use crate::raster::Drawable;

words! {
    /// By what occluders are chosen.
    pub(crate) enum Selection {
        /// The nearest to the eye (the paper).
        Distance = "distance",
        /// Those that look largest.
        Size = "size",
        /// The nearest of those that could be seen in the last frame.
        Visible = "visible",
        /// Those that look largest from the grid points about the eye, as far as they are seen from there;
        /// then the nearest of the others.
        Grid = "grid",
    }
}

/// A leaf that may become an occluder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub node: NodeId,
    /// From the eye to the middle of its box, world units.
    pub distance: f32,
    /// About the solid angle of its box: the square of its diagonal over that of its distance.
    pub size: f32,
    /// The angle under which the grid points about the eye see it, weighted; 0 where they do not.
    pub angle: f32,
    /// Primitives that are drawn of it.
    pub polygons: u32,
    /// Whether it comes before its turn: it was an occluder, or could be seen, in the last frame.
    pub is_kept: bool,
}

/// By what candidates are put in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    By(Selection),
    /// By their nearest points: with a single Z plane all before it are occluders (Section 5.2.1).
    Nearest,
}

/// What is known beforehand, by node: what was an occluder in the last frame, and what was drawn.
pub(crate) struct Known<'a> {
    pub occluders: &'a [bool],
    pub drawn: &'a [bool],
    /// By node the angles of the grid points about the eye; empty where none is asked.
    pub angles: &'a [f32],
}

/// A set that was chosen in the last frame stays while it ranks within so many times the limit.
const KEEPS: f32 = 1.25;

/// A leaf by what puts it in order.
struct Ranked {
    /// Less is earlier.
    key: f32,
    node: NodeId,
}

impl Ranked {
    /// Equal ones by number, so that every run takes the same.
    fn order(&self, other: &Self) -> Ordering {
        self.key.total_cmp(&other.key).then(self.node.cmp(&other.node))
    }
}

/// More than rounding may take from the least distance to a box, or add to its depth.
const ROUNDING: f32 = 1.0 - 1e-6;

/// How much farther than the last frame's candidates those of the next are looked for at first.
const FARTHER: f32 = 1.25;

/// What candidates are chosen from, and how they are put in order.
pub(crate) struct Choosing<'a, S: Space> {
    pub index: &'a Databases<S>,
    pub view: &'a View<S>,
    pub frustum: &'a Frustum<S::Vector>,
    pub projection: &'a Projection<S::Vector>,
    pub order: Order,
    pub known: Known<'a>,
}

impl<S: Drawable> Choosing<'_, S> {
    /// The leaves of the occluder database in the frustum, in the order in which they are taken, as far as
    /// they can be within the limit. `last`: the key of the last of them, kept from frame to frame to look no
    /// farther than needed, which changes nothing of what is found.
    pub fn candidates(&self, limit: u32, last: &mut Option<f32>) -> Vec<Candidate> {
        let most = KEEPS * limit as f32;
        let mut ranked = self.first();
        ranked.sort_unstable_by(Ranked::order);
        let mut sum = self.cut(&mut ranked, most);
        let firsts = ranked.len();
        if sum <= most {
            // Keys are distances, or angles and depths with the sign turned.
            let farther =
                last.map_or(f32::INFINITY, |key| if key < 0.0 { key / FARTHER } else { key * FARTHER });
            let mut others = self.others(farther);
            if farther.is_finite() && sum + self.sum(&others) <= most {
                others = self.others(f32::INFINITY);
            }
            self.sort_first(&mut others, most - sum);
            sum += self.sum(&others);
            *last = others.last().filter(|_| sum > most).map(|r| r.key);
            ranked.append(&mut others);
        }
        let found = ranked.iter().enumerate().map(|(i, r)| {
            let is_kept = match self.order {
                // "Temporal coherence": while it is about as near as what is chosen, a set does not flicker.
                Order::By(Selection::Distance) => self.known.occluders[r.node.at()],
                Order::By(Selection::Visible) => i < firsts,
                _ => false,
            };
            self.candidate(r.node, is_kept)
        });
        let mut found: Vec<Candidate> = found.collect();
        found.sort_by_key(|c| !c.is_kept);
        found
    }
    /// How many there are.
    pub fn count(&self) -> u32 {
        (self.first().len() + self.others(f32::INFINITY).len()) as u32
    }

    /// Those that come before all others.
    fn first(&self) -> Vec<Ranked> {
        let flagged: Vec<usize> = match self.order {
            Order::By(Selection::Visible) => {
                (0..self.known.drawn.len()).filter(|&at| self.known.drawn[at]).collect()
            }
            // What moves is in no list (Section 5.5: "no pre-processing"): it follows by its distance, as
            // does all else that the grid points do not see.
            Order::By(Selection::Grid) => {
                (0..self.known.angles.len()).filter(|&at| self.known.angles[at] > 0.0).collect()
            }
            _ => Vec::new(),
        };
        let leaves = flagged.into_iter().map(|at| NodeId(at as u32)).filter(|&node| {
            self.index.tree().nodes()[node.at()].children().is_none()
                && self.cutting(node, Frustum::<S::Vector>::ALL).is_some()
                && self.may_be_one(node)
        });
        let key = |node: NodeId| match self.order {
            Order::By(Selection::Grid) => -self.angle(node),
            _ => self.key(self.index.occluder_bounds(node)),
        };
        leaves.map(|node| Ranked { key: key(node), node }).collect()
    }
    /// All others whose key is not beyond one.
    fn others(&self, farthest: f32) -> Vec<Ranked> {
        let mut to = Vec::new();
        self.gather((NodeId(0), Frustum::<S::Vector>::ALL), farthest, &mut to);
        to
    }
    /// Frustum culling of the occluder database (Section 3, phase 1).
    fn gather(&self, (id, planes): (NodeId, u8), farthest: f32, to: &mut Vec<Ranked>) {
        let Some(cutting) = self.cutting(id, planes) else { return };
        let bounds = self.index.occluder_bounds(id);
        match self.index.tree().nodes()[id.at()].children() {
            Some(children) => {
                if self.floor(bounds) <= farthest {
                    children.into_iter().for_each(|child| self.gather((child, cutting), farthest, to));
                }
            }
            None => {
                let key = self.key(bounds);
                if key <= farthest && !self.is_first(id) && self.may_be_one(id) {
                    to.push(Ranked { key, node: id });
                }
            }
        }
    }
    fn sum(&self, ranked: &[Ranked]) -> f32 {
        ranked.iter().map(|r| self.polygons(r.node) as f32).sum()
    }
    /// Leaves those that come first, as they stand, until they hold more than `most` primitives. Their sum.
    fn cut(&self, ranked: &mut Vec<Ranked>, most: f32) -> f32 {
        let mut sum = 0.0;
        let is_past = |r: &Ranked| {
            sum += self.polygons(r.node) as f32;
            sum > most
        };
        let end = ranked.iter().position(is_past).map_or(ranked.len(), |at| at + 1);
        ranked.truncate(end);
        sum
    }
    /// Leaves those that come first, in order, and hold more than `most` primitives together, or all.
    fn sort_first(&self, ranked: &mut Vec<Ranked>, most: f32) {
        // To put all in order would take longer than to draw what is chosen of them.
        let (mut count, mut sorted, mut sum) = (64, 0, 0.0);
        while sorted < ranked.len() {
            count = count.min(ranked.len());
            if count < ranked.len() {
                ranked[sorted..].select_nth_unstable_by(count - sorted, Ranked::order);
            }
            ranked[sorted..count].sort_unstable_by(Ranked::order);
            for at in sorted..count {
                sum += self.polygons(ranked[at].node) as f32;
                if sum > most {
                    return ranked.truncate(at + 1);
                }
            }
            sorted = count;
            count *= 4;
        }
    }
    /// The planes of the frustum that cut a node with occluders in it; `None` if it has none or is outside.
    fn cutting(&self, id: NodeId, planes: u8) -> Option<u8> {
        if !self.index.has_occluders(id) {
            return None;
        }
        match self.frustum.test(self.index.occluder_bounds(id), planes) {
            FrustumTest::Outside(_) => None,
            FrustumTest::Partial(cutting) => Some(cutting),
            FrustumTest::Inside => Some(0),
        }
    }
    /// Where nothing may be drawn for a leaf, it is no candidate.
    fn may_be_one(&self, leaf: NodeId) -> bool {
        self.index.stand_ins().is_none() || self.polygons(leaf) > 0
    }
    fn polygons(&self, leaf: NodeId) -> u32 {
        self.index.occluder_prims(leaf, self.view, self.projection)
    }
    fn angle(&self, leaf: NodeId) -> f32 {
        self.known.angles.get(leaf.at()).copied().unwrap_or(0.0)
    }
    fn is_first(&self, leaf: NodeId) -> bool {
        match self.order {
            Order::By(Selection::Visible) => self.known.drawn[leaf.at()],
            Order::By(Selection::Grid) => self.angle(leaf) > 0.0,
            _ => false,
        }
    }
    fn key(&self, bounds: &Aabb<S::Vector>) -> f32 {
        match self.order {
            Order::By(Selection::Size) => -size_of(bounds, distance_of(bounds, self.view)),
            Order::By(_) => distance_of(bounds, self.view),
            // Larger depths are nearer.
            Order::Nearest => -nearest_depth(self.projection, bounds, self.view.eye.near),
        }
    }
    /// No key of a box inside is less.
    fn floor(&self, bounds: &Aabb<S::Vector>) -> f32 {
        let eye = self.view.eye.position;
        let least = (eye.max(bounds.min).min(bounds.max) - eye).length() * ROUNDING;
        match self.order {
            Order::By(Selection::Size) => -size_of(bounds, least) / ROUNDING,
            Order::By(_) => least,
            Order::Nearest => -nearest_depth(self.projection, bounds, self.view.eye.near) / ROUNDING,
        }
    }
    fn candidate(&self, node: NodeId, is_kept: bool) -> Candidate {
        let bounds = self.index.occluder_bounds(node);
        let distance = distance_of(bounds, self.view);
        Candidate {
            node,
            distance,
            size: size_of(bounds, distance),
            angle: self.angle(node),
            polygons: self.polygons(node),
            is_kept,
        }
    }
}

/// "The distance between the viewer and the center of an object's bounding volume."
fn distance_of<S: Space>(bounds: &Aabb<S::Vector>, view: &View<S>) -> f32 {
    (bounds.center() - view.eye.position).length()
}
/// About the solid angle of a box at a distance.
fn size_of<V: Vector>(bounds: &Aabb<V>, distance: f32) -> f32 {
    let across = bounds.diagonal() / distance.max(f32::MIN_POSITIVE);
    across * across
}
