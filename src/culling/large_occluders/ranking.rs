//! Occluders in the order of their area-angles from any point, without looking at all of them.
//!
//! A kD-tree over the occluders; no occluder below a node looks larger than the largest area there would, at
//! the nearest point of the node's box and head-on. So the best is found by opening, again and again, what
//! promises most. Cost: O(log occluders) for each one that is found where areas are alike.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::occluders::{Occluders, area_angle};
use super::space::{Point, Shape};
use crate::geometry::{Aabb, NodeId, PrimId, Vector};
use crate::index::{Hierarchy, KdTree};

/// Occluders in a leaf: an area-angle costs less than a place in the queue, which most are too small to get.
const LEAF: usize = 16;
/// What rounding may add to an area-angle in f64, generously.
const ROUNDING: f64 = 1.0 + 1e-12;

/// See the module.
#[derive(Clone, Debug)]
pub struct Ranking<V> {
    tree: KdTree<V>,
    /// By node, the largest area below it.
    largest: Vec<f64>,
}

impl<V: Vector> Ranking<V> {
    /// Of all occluders; `None` when cancelled.
    pub fn new<S: Shape<Vector = V>>(occluders: &Occluders<S>, cancelled: impl Fn() -> bool) -> Option<Self> {
        let boxes = (0..occluders.len() as u32).map(|id| (PrimId(id), Aabb::of(occluders.outline(id))));
        let height = occluders.len().div_ceil(LEAF).max(1).ilog2() + 2;
        let tree = KdTree::build(boxes, height, cancelled)?;
        let area = |node: usize| {
            let below = tree.prims_below(NodeId(node as u32));
            below.iter().map(|p| occluders.get(p.0).area).fold(0.0, f64::max)
        };
        let largest = (0..tree.nodes().len()).map(area).collect();
        Some(Self { tree, largest })
    }
    /// As seen from a point: the largest first, of equals the lower number; none whose area-angle is 0 or
    /// below `least`.
    pub fn from<'a, S: Shape<Vector = V>>(
        &'a self,
        occluders: &'a Occluders<S>,
        from: S::Point,
        least: f32,
    ) -> Search<'a, S> {
        let root = Found { score: f32::INFINITY, is_node: true, number: 0 };
        Search { ranking: self, occluders, from, least, open: BinaryHeap::from([root]) }
    }
    /// Bytes of the tables.
    pub fn bytes<S: Shape<Vector = V>>(&self) -> usize {
        Hierarchy::<S>::bytes(&self.tree) + self.largest.len() * size_of::<f64>()
    }
}

/// A node with a bound, or an occluder with its area-angle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Found {
    score: f32,
    is_node: bool,
    number: u32,
}

impl Eq for Found {}
impl PartialOrd for Found {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Found {
    fn cmp(&self, other: &Self) -> Ordering {
        // A node before an occluder that looks as large: it may hold one of lower number.
        let rank = |f: &Self| (f.is_node, std::cmp::Reverse(f.number));
        self.score.total_cmp(&other.score).then(rank(self).cmp(&rank(other)))
    }
}

/// A search under way.
pub struct Search<'a, S: Shape> {
    ranking: &'a Ranking<S::Vector>,
    occluders: &'a Occluders<S>,
    from: S::Point,
    least: f32,
    open: BinaryHeap<Found>,
}

impl<S: Shape> Search<'_, S> {
    /// The next largest with its area-angle. Boxes that are of no use are not opened.
    pub fn next(&mut self, is_useful: impl Fn(&Aabb<S::Vector>) -> bool) -> Option<(u32, f32)> {
        let nodes = self.ranking.tree.nodes();
        while let Some(Found { score, is_node, number }) = self.open.pop() {
            if !is_node {
                return Some((number, score));
            }
            let node = NodeId(number);
            if !is_useful(&nodes[node.at()].bounds) {
                continue;
            }
            if let Some(children) = nodes[node.at()].children() {
                let bounded = |NodeId(number)| Found { score: self.bound(number), is_node: true, number };
                // What is too small never gets into the queue, which is where the time goes.
                self.open.extend(children.map(bounded).into_iter().filter(|f| f.score >= self.least));
            } else {
                let of = |&PrimId(number): &PrimId| {
                    let score = area_angle(self.occluders.get(number), self.from) as f32;
                    Found { score, is_node: false, number }
                };
                let below = self.ranking.tree.prims_below(node);
                self.open.extend(below.iter().map(of).filter(|f| f.score > 0.0 && f.score >= self.least));
            }
        }
        None
    }

    /// What no area-angle below a node exceeds.
    fn bound(&self, node: u32) -> f32 {
        let bounds = &self.ranking.tree.nodes()[node as usize].bounds;
        let gap = |a: usize| {
            let (low, high) = (f64::from(bounds.min.get(a)), f64::from(bounds.max.get(a)));
            let at = self.from.get(a);
            (low - at).max(at - high).max(0.0)
        };
        let square: f64 = (0..S::Vector::AXES).map(|a| gap(a) * gap(a)).sum();
        let power = if S::Vector::AXES == 2 { square.sqrt() } else { square };
        (self.ranking.largest[node as usize] / power * ROUNDING) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, Solid};
    use crate::scene::Face;

    /// A search finds all that look at all large, in order, as looking at all of them does.
    fn check<S: Shape>(corners: u32) {
        let mut dice = Dice::new(5);
        for case in 0..60 {
            let n = 1 + dice.below(200);
            let mut number = |size: f32| {
                let v = dice.between(-size, size);
                // On a grid many look equally large.
                if case % 2 == 0 { v.round() } else { v }
            };
            let mut points = Vec::new();
            for _ in 0..n {
                let middle = S::Vector::from_fn(|_| number(20.0));
                points.extend((0..corners).map(|_| middle + S::Vector::from_fn(|_| number(2.0))));
            }
            let face = |i| Face { corners: (corners * i..corners * (i + 1)).collect(), prims: Vec::new() };
            let occluders = Occluders::<S>::new(&points, &(0..n).map(face).collect::<Vec<_>>());
            let from = S::widened(S::Vector::from_fn(|_| number(30.0)));
            let score = |id: u32| area_angle(occluders.get(id), from) as f32;
            let mut all: Vec<_> = (0..occluders.len() as u32).map(|id| (id, score(id))).collect();
            let least = if case % 3 == 0 { 0.02 } else { 0.0 };
            all.retain(|f| f.1 > 0.0 && f.1 >= least);
            all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            let ranking = Ranking::new(&occluders, || false).expect("not cancelled");
            let mut search = ranking.from(&occluders, from, least);
            let found: Vec<_> = std::iter::from_fn(|| search.next(|_| true)).collect();
            assert_eq!(found, all, "{} case {case}", S::NAME);
        }
    }

    #[test]
    fn a_search_finds_the_order_of_all() {
        check::<Flat>(2);
        check::<Solid>(3);
    }
}
