//! Dynamic occluder selection (Section 3.1): for each leaf of the kD-tree and each of some viewing
//! directions, the occluders that look largest from there.
//!
//! The measure is the area-angle −A (N·V) / |D|²: A the occluder's area, N its normal, D the vector from the
//! eye to its center, V the direction in which the eye sees it, D/|D|. (The paper calls V the viewing
//! direction; taken to be the Eye's line of sight, the walls along a corridor, which hide the rooms beside
//! it, would count for nothing.) In flatland it is A (N·V) / |D|. An occluder counts for a direction if some
//! part of it lies in the cone that an eye of up to 120° sees which looks within that direction's share of
//! the circle. One behind which the scene has no depth hides nothing, such as the ground, and is left out;
//! where back faces are culled, so is one that shows its back to all of the leaf.
//! A leaf can be large, so its list holds [`SPARE`] times as many as are used at once; those that look
//! largest from the eye itself, or from a detail object itself, are picked from it. An eye outside of the
//! scene's box is in no leaf: its list is made where it stands, and those of objects that it sees where they
//! stand ([`Selection::search`]).
//! Directions lie in the ground plane (in flatland: in the plane), evenly spaced, the first along x; in space
//! up and down follow.
//! Cost: O(leaves · (what the lists hold) · log(occluders)), in parallel over leaves; deterministic.

use rayon::prelude::*;

use super::occluders::{Occluders, area_angle};
use super::ranking::Ranking;
use super::space::{Point, Shape};
use crate::geometry::{Aabb, NodeId, Vector};
use crate::index::KdTree;
use crate::scene::Progress;

/// How many times as many occluders as are active a leaf's list holds. The list is ranked from the middle of
/// the leaf; from elsewhere in it the ranks differ, but what is largest from there is rarely beyond four
/// times the set. Each further one costs an area-angle a frame and some bytes for each leaf.
const SPARE: u32 = 4;
/// How many it holds at least: detail objects pick from the same list, and a small set of the Eye's would
/// leave them none that are near.
const LEAST: u32 = 64;
/// The least depth of the scene behind an occluder that is worth having, as a share of the scene's diagonal:
/// less than a room of a building, more than the unevenness of a ground, which looks largest from everywhere
/// and would fill the sets.
const DEPTH_SHARE: f64 = 0.02;
/// The least area-angle worth having, steradians, and radians in flatland: that of a square of 2° by 2°, a
/// thousandth of an image. What looks smaller hides nothing but what looks smaller still. Without a bound,
/// leaves at the border would look at all occluders for the directions that lead out of the scene.
const LEAST_ANGLE: [f32; 2] = [1e-3, 1e-2];
/// Bytes that the lists may take at most. Where a tall tree with many directions would need more, lists are
/// shorter, though never shorter than what is used at once.
const MOST_BYTES: usize = 128 << 20;

/// For each leaf and direction the best occluders, best first.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    ways: Vec<Way>,
    /// Number of the leaf at each node; meaningless elsewhere.
    leaf_of: Vec<u32>,
    /// Where the list of each leaf begins in `lists`, and one past the last.
    starts: Vec<u32>,
    /// The occluders that a leaf has for any direction, best first: the lists of neighboring directions are
    /// much alike.
    lists: Vec<u32>,
    /// For each of them a bit for every direction whose list it is in, in [`stride`] bytes.
    toward: Vec<u8>,
}

/// A viewing direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    /// Unit vector; the third component is 0 in flatland.
    along: [f64; 3],
    /// Cosine of the widest angle off it at which an occluder counts for it.
    cone: f64,
}

/// What lists are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Directions in the ground plane.
    pub directions: u32,
    /// How many occluders are active at most.
    pub most: u32,
    /// An occluder whose area-angle is below this share of the sum of those before it ends the list; 0:
    /// never.
    pub gain: f64,
    /// Whether occluders hide from their front only.
    pub one_sided: bool,
}

/// Bytes of a bit for each direction.
fn stride(ways: usize) -> usize {
    ways.div_ceil(8)
}

/// The least area-angle worth having in a space.
pub fn least_angle<S: Shape>() -> f32 {
    LEAST_ANGLE[usize::from(S::Vector::AXES == 2)]
}

/// Cosine of the widest angle off a direction at which an occluder counts for it: 60° to the side of an eye
/// that itself looks up to half a step beside the direction.
fn cone(directions: u32) -> f64 {
    let off = std::f64::consts::PI * (1.0 / 3.0 + 1.0 / f64::from(directions.max(1)));
    // With one direction its share is the whole circle, so everything counts for it.
    if off < std::f64::consts::PI { cosine(off) } else { -1.0 }
}

/// The cosine by halving and a short series: library cosines differ from system to system in their last bits.
fn cosine(angle: f64) -> f64 {
    // At a sixteenth of the angle, below 0.4, four terms are exact to 10⁻¹⁰; each doubling quadruples the
    // error, which stays far below what changes a direction.
    let x = angle / 16.0;
    let square = x * x;
    let mut c = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    for _ in 0..4 {
        c = 2.0 * c * c - 1.0;
    }
    c
}

/// Unit direction `i` of `directions`, as its two components in the ground plane.
fn direction(i: u32, directions: u32) -> [f64; 2] {
    let angle = std::f64::consts::TAU * f64::from(i) / f64::from(directions);
    [cosine(angle), cosine(angle - std::f64::consts::FRAC_PI_2)]
}

/// The order of ranked occluders: the larger area-angle first, of equals the lower number.
fn better(a: &(u32, f32), b: &(u32, f32)) -> std::cmp::Ordering {
    // Like walls of a building have equal area-angles: the number decides, so that every build chooses the
    // same.
    b.1.total_cmp(&a.1).then(a.0.cmp(&b.0))
}

/// The occluders of a list by how large they look from a point, best first, with their area-angles from
/// there.
pub fn ranked_from<S: Shape>(
    occluders: &Occluders<S>,
    list: impl Iterator<Item = u32>,
    from: S::Point,
    into: &mut Vec<(u32, f32)>,
) {
    into.clear();
    into.extend(list.map(|id| (id, area_angle(occluders.get(id), from) as f32)));
    into.sort_unstable_by(better);
}

/// All directions of a space.
fn ways<S: Shape>(directions: u32) -> Vec<Way> {
    let level = |i: u32| {
        let [x, y] = direction(i, directions);
        Way { along: if S::Vector::AXES == 2 { [x, y, 0.0] } else { [x, 0.0, -y] }, cone: cone(directions) }
    };
    let mut all: Vec<Way> = (0..directions).map(level).collect();
    // "All possible viewing directions" (Section 3.1). With one, everything counts for it already; their
    // share reaches as far as halfway to the ground plane, an eighth of a circle, as that of one of four.
    if S::Vector::AXES == 3 && directions > 1 {
        all.extend([1.0, -1.0].map(|y| Way { along: [0.0, y, 0.0], cone: cone(4) }));
    }
    all
}

/// The component of a vector along a direction.
fn along<S: Shape>(v: S::Point, way: &Way) -> f64 {
    (0..S::Vector::AXES).map(|a| v.get(a) * way.along[a]).sum()
}

impl Selection {
    /// Ranks all occluders for all leaves and directions; `None` when cancelled.
    pub fn new<S: Shape>(
        tree: &KdTree<S::Vector>,
        occluders: &Occluders<S>,
        wanted: &Wanted,
        progress: &dyn Progress,
    ) -> Option<Self> {
        let cells = cells::<S>(tree);
        let ranking = Ranking::new(occluders, || progress.cancelled())?;
        let (ways, whole) = (ways::<S>(wanted.directions), tree.nodes()[0].bounds);
        let length = length(wanted, cells.len() * ways.len());
        let ranker = Ranker { occluders, ranking: &ranking, ways: &ways, whole, length, wanted };
        // Leaves are numbered in the order in which they are found.
        let mut leaf_of = vec![0; tree.nodes().len()];
        cells.iter().enumerate().for_each(|(k, (node, _))| leaf_of[node.at()] = k as u32);
        let (mut starts, mut lists, mut toward) = (vec![0], Vec::new(), Vec::new());
        // Some leaves at a time, so that progress can be shown and a person can cancel.
        for (i, some) in cells.chunks(LEAVES_AT_A_TIME).enumerate() {
            progress.report((i * LEAVES_AT_A_TIME) as f32 / cells.len() as f32, "selecting occluders");
            if progress.cancelled() {
                return None;
            }
            // Collected in the order of the leaves, whichever is ranked first.
            let ranked: Vec<_> = some.par_iter().map(|(_, cell)| ranker.rank(cell)).collect();
            for (list, bits) in ranked {
                lists.extend(list);
                toward.extend(bits);
                starts.push(lists.len() as u32);
            }
        }
        Some(Self { ways, leaf_of, starts, lists, toward })
    }

    /// The occluders that count for a direction as seen from any point, the one that looks largest first,
    /// until `take` has enough of them: for places that no list serves.
    pub fn search<S: Shape>(
        &self,
        occluders: &Occluders<S>,
        ranking: &Ranking<S::Vector>,
        from: S::Point,
        direction: u32,
        mut take: impl FnMut(u32, f32) -> bool,
    ) {
        let way = &self.ways[direction as usize];
        let (mut search, mut places) = (ranking.from(occluders, from, 0.0), Vec::new());
        while let Some((id, score)) = search.next(|bounds| Ball::of::<S>(bounds, from).reaches::<S>(way)) {
            places_of(occluders, id, from, &mut places);
            if is_toward::<S>(&places, way) && !take(id, score) {
                return;
            }
        }
    }

    /// The number of the direction nearest to a line of sight.
    pub fn direction_of<S: Shape>(&self, sight: S::Point) -> u32 {
        // The ways are of unit length, and the length of the sight is the same in every comparison.
        let alike = |way: &Way| along::<S>(sight, way);
        let mut best = 0;
        for (i, way) in self.ways.iter().enumerate().skip(1) {
            // The first of equals.
            if alike(way) > alike(&self.ways[best]) {
                best = i;
            }
        }
        best as u32
    }
    /// The best occluders of a leaf and direction, by area-angle from the middle of the leaf, best first.
    pub fn list(&self, leaf: NodeId, direction: u32) -> impl Iterator<Item = u32> {
        let at = self.leaf_of[leaf.at()] as usize;
        let (range, stride) =
            (self.starts[at] as usize..self.starts[at + 1] as usize, stride(self.ways.len()));
        let (byte, bit) = (direction as usize / 8, direction % 8);
        range.filter(move |i| self.toward[i * stride + byte] >> bit & 1 == 1).map(|i| self.lists[i])
    }
    /// The tables, to be saved: leaf numbers by node, starts of lists, lists, and for whom they are.
    pub fn tables(&self) -> (&[u32], &[u32], &[u32], &[u8]) {
        (&self.leaf_of, &self.starts, &self.lists, &self.toward)
    }
    /// A selection from its tables, if they fit each other and a tree of `nodes` nodes and `occluders`
    /// occluders.
    pub fn of_tables<S: Shape>(
        directions: u32,
        [leaf_of, starts, lists]: [Vec<u32>; 3],
        toward: Vec<u8>,
        nodes: usize,
        occluders: usize,
    ) -> Option<Self> {
        // All that `list` takes for granted: slices in order and within the lists, two starts for every leaf,
        // bits for every entry, and occluders that exist.
        let ways = ways::<S>(directions);
        let ascending = starts.windows(2).all(|w| w[0] <= w[1]) && starts.first() == Some(&0);
        let whole = starts.last().is_some_and(|&end| end as usize == lists.len());
        let leaves = leaf_of.iter().max().map_or(0, |&most| most as usize + 1);
        let fits = leaf_of.len() == nodes && starts.len() == leaves + 1;
        let known = lists.iter().all(|&id| (id as usize) < occluders);
        let marked = toward.len() == lists.len() * stride(ways.len());
        (ascending && whole && fits && known && marked).then_some(Self {
            ways,
            leaf_of,
            starts,
            lists,
            toward,
        })
    }
    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        self.toward.len() + (self.lists.len() + self.starts.len() + self.leaf_of.len()) * size_of::<u32>()
    }
    /// Every occluder that some list names, ascending.
    pub fn named(&self) -> Vec<u32> {
        let mut all = self.lists.clone();
        all.sort_unstable();
        all.dedup();
        all
    }
    /// The same lists after the occluders were numbered anew: by their place in `kept`, ascending.
    pub fn renumbered(mut self, kept: &[u32]) -> Self {
        for id in &mut self.lists {
            *id = kept.partition_point(|k| k < id) as u32;
        }
        self
    }
}

/// How long a list is, of so many.
fn length(wanted: &Wanted, lists: usize) -> usize {
    // An entry is a number and some bits, if no two directions had it in common.
    let entry = size_of::<u32>() + stride(wanted.directions as usize);
    let (most, affordable) = (wanted.most as usize, MOST_BYTES / entry / lists.max(1));
    (most * SPARE as usize).max(LEAST as usize).min(affordable.max(most))
}

/// Leaves that are ranked between two looks at the progress: enough for every core to have several, few
/// enough for a cancel to be noticed in a fraction of a second.
const LEAVES_AT_A_TIME: usize = 32;

/// The leaf whose cell holds a point: the splitting planes divide all of space, whatever the boxes hold.
pub fn leaf_at<S: Shape>(tree: &KdTree<S::Vector>, point: S::Vector) -> NodeId {
    let mut at = NodeId(0);
    while let Some([low, high]) = tree.nodes()[at.at()].children() {
        let node = &tree.nodes()[at.at()];
        // A point on the plane goes to the lower half, so that it lies in one leaf only.
        at = if point.get(node.axis as usize) <= node.split { low } else { high };
    }
    at
}

/// Leaves with the part of the tree's box that their splitting planes leave them.
fn cells<S: Shape>(tree: &KdTree<S::Vector>) -> Vec<(NodeId, Aabb<S::Vector>)> {
    let mut open = vec![(NodeId(0), tree.nodes()[0].bounds)];
    let mut cells = Vec::new();
    while let Some((id, cell)) = open.pop() {
        let node = &tree.nodes()[id.at()];
        let Some([low, high]) = node.children() else {
            cells.push((id, cell));
            continue;
        };
        let cut = |v: S::Vector| {
            S::Vector::from_fn(|a| if a == node.axis as usize { node.split } else { v.get(a) })
        };
        // The lower half is pushed last and so comes first: leaves are numbered from low to high.
        open.push((high, Aabb { min: cut(cell.min), max: cell.max }));
        open.push((low, Aabb { min: cell.min, max: cut(cell.max) }));
    }
    cells
}

/// Makes the lists of leaves.
struct Ranker<'a, S: Shape> {
    occluders: &'a Occluders<S>,
    ranking: &'a Ranking<S::Vector>,
    ways: &'a [Way],
    /// Bounds of the scene.
    whole: Aabb<S::Vector>,
    length: usize,
    wanted: &'a Wanted,
}

/// The list of a direction while it grows.
#[derive(Clone, Copy, Default)]
struct Growing {
    length: usize,
    sum: f64,
    is_done: bool,
}

impl<S: Shape> Ranker<'_, S> {
    /// What a leaf has for any direction, and for which.
    fn rank(&self, cell: &Aabb<S::Vector>) -> (Vec<u32>, Vec<u8>) {
        let from = S::widened(cell.center());
        let mut growing = vec![Growing::default(); self.ways.len()];
        let (mut list, mut toward, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let mut search = self.ranking.from(self.occluders, from, least_angle::<S>());
        // Once for the leaf: the directions share the order and differ in what counts. Full lists ask for
        // nothing more, so most of the scene is never looked at.
        while growing.iter().any(|g| !g.is_done) {
            let next = search.next(|bounds| {
                let ball = Ball::of::<S>(bounds, from);
                self.ways.iter().zip(&growing).any(|(way, g)| !g.is_done && ball.reaches::<S>(way))
            });
            let Some((id, score)) = next else { break };
            if !self.can_hide(id, cell, from) {
                continue;
            }
            let at = toward.len();
            toward.resize(at + stride(self.ways.len()), 0);
            places_of(self.occluders, id, from, &mut places);
            for (i, way) in self.ways.iter().enumerate() {
                if self.grows(&mut growing[i], score) && is_toward::<S>(&places, way) {
                    growing[i].length += 1;
                    growing[i].sum += f64::from(score);
                    toward[at + i / 8] |= 1 << (i % 8);
                }
            }
            if toward[at..].iter().all(|b| *b == 0) {
                toward.truncate(at);
            } else {
                list.push(id);
            }
        }
        (list, toward)
    }
    /// Whether a list takes more, and what looks as large as this: it is full, or what follows adds too
    /// little beside those before it.
    fn grows(&self, list: &mut Growing, score: f32) -> bool {
        let adds_little = list.sum > 0.0 && f64::from(score) < self.wanted.gain * list.sum;
        list.is_done |= adds_little || list.length == self.length;
        !list.is_done
    }
    fn can_hide(&self, id: u32, cell: &Aabb<S::Vector>, from: S::Point) -> bool {
        if !self.wanted.one_sided {
            return has_depth(self.occluders, id, &self.whole, from);
        }
        // From its front, which some of the leaf must lie on.
        let ([_, high], [low, _]) =
            (self.occluders.heights(id, cell), self.occluders.heights(id, &self.whole));
        high > 0.0 && -low > enough::<S>(&self.whole)
    }
}

/// The depth of the scene that is worth an occluder, world units.
fn enough<S: Shape>(whole: &Aabb<S::Vector>) -> f64 {
    f64::from(whole.diagonal()) * DEPTH_SHARE
}

/// Whether the scene has depth on the side of an occluder that a point does not lie on.
pub fn has_depth<S: Shape>(
    occluders: &Occluders<S>,
    id: u32,
    whole: &Aabb<S::Vector>,
    from: S::Point,
) -> bool {
    let [low, high] = occluders.heights(id, whole);
    let occluder = occluders.get(id);
    (if occluder.normal.dot(from - occluder.anchor) > 0.0 { -low } else { high }) > enough::<S>(whole)
}

/// The center of an occluder, its corners and the middles between, from a point on, with their distances.
fn places_of<S: Shape>(occluders: &Occluders<S>, id: u32, from: S::Point, into: &mut Vec<(S::Point, f64)>) {
    let center = occluders.get(id).center;
    let middles = occluders.edges(id).iter().flat_map(|e| [e.from, (e.from + center) * 0.5]);
    into.clear();
    into.extend(std::iter::once(center).chain(middles).map(|p| (p - from, (p - from).length())));
}

/// Whether some of the places of an occluder lies within a cone.
fn is_toward<S: Shape>(places: &[(S::Point, f64)], way: &Way) -> bool {
    // A few points stand for the polygon: where they miss, some culling is lost, and never anything visible.
    places.iter().any(|(v, length)| along::<S>(*v, way) >= way.cone * length)
}

/// A ball about a box, as seen from a point.
struct Ball<P> {
    center: P,
    distance: f64,
    radius: f64,
}

impl<P: Point> Ball<P> {
    fn of<S: Shape<Point = P>>(bounds: &Aabb<S::Vector>, from: P) -> Self {
        let center = S::widened(bounds.center()) - from;
        // The center and the diagonal were rounded to 32 bits.
        let radius = f64::from(bounds.diagonal()) * 0.5 * (1.0 + 1e-6);
        Self { center, distance: center.length(), radius }
    }
    /// Whether some point of it may lie within a cone.
    fn reaches<S: Shape<Point = P>>(&self, way: &Way) -> bool {
        // What `is_toward` compares changes by no more than 1 + |cosine| a unit of way.
        along::<S>(self.center, way) - way.cone * self.distance >= -self.radius * (1.0 + way.cone.abs())
    }
}
