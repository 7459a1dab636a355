//! Dynamic occluder selection (Section 3.1): for each leaf of the kD-tree and each of some viewing
//! directions, the occluders that look largest from there.
//!
//! The measure is the area-angle −A (N·V) / |D|²: A the occluder's area, N its normal, D the vector from the
//! eye to its center, V the direction in which the eye sees it, D/|D|. (The paper calls V the viewing
//! direction; taken to be the Eye's line of sight, the walls along a corridor, which hide the rooms beside
//! it, would count for nothing.) In flatland it is A (N·V) / |D|. An occluder counts for a direction if some
//! part of it lies in the cone that an eye of up to 120° sees which looks within that direction's share of
//! the circle. One behind which the scene has no depth hides nothing, such as the ground, and is left out.
//! A leaf can be large, so its list holds [`SPARE`] times as many as are used at once; those that look
//! largest from the eye itself, or from a detail object itself, are picked from it.
//! Directions lie in the ground plane (in flatland: in the plane), evenly spaced, the first along x.
//! Cost: O(leaves · directions · polygons), in parallel over leaves; deterministic.

use rayon::prelude::*;

use super::occluders::{Occluder, Occluders};
use super::space::{Point, Shape};
use crate::geometry::{Aabb, NodeId, Vector};
use crate::index::KdTree;
use crate::scene::Progress;

/// How many times as many occluders as are active a leaf's list holds. The list is ranked from the middle of
/// the leaf; from elsewhere in it the ranks differ, but what is largest from there is rarely beyond four
/// times the set. Each further one costs an area-angle a frame and 8 bytes for each leaf and direction.
const SPARE: u32 = 4;
/// How many it holds at least: detail objects pick from the same list, and a small set of the Eye's would
/// leave them none that are near.
const LEAST: u32 = 64;
/// The least depth of the scene behind an occluder that is worth having, as a share of the scene's diagonal:
/// less than a room of a building, more than the unevenness of a ground, which looks largest from everywhere
/// and would fill the sets.
const DEPTH_SHARE: f64 = 0.02;

/// For each leaf and direction the best occluders, best first.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// The directions, in the ground plane.
    directions: Vec<[f64; 2]>,
    /// Number of the leaf at each node; meaningless elsewhere.
    leaf_of: Vec<u32>,
    /// Where the list of each leaf and direction begins in `lists`, and one past the last.
    starts: Vec<u32>,
    /// Occluders with their area-angles.
    lists: Vec<(u32, f32)>,
}

/// The area-angle of an occluder from a point: an estimate of the solid angle (in flatland: the angle) that
/// it subtends.
pub fn area_angle<S: Shape>(occluder: &Occluder<S>, from: S::Point) -> f64 {
    let toward = occluder.center - from;
    let distance = toward.length();
    // The amount without the sign of the paper, which makes only the front count: here occluders hide from
    // both sides. At the very center no angle is defined, and 0 keeps the occluder out.
    let power = if S::Vector::AXES == 2 { distance } else { distance * distance };
    if power > 0.0 { occluder.area * (occluder.normal.dot(toward) / distance).abs() / power } else { 0.0 }
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

/// Those of a list that look largest from a point, best first, at most `most`, with their area-angles from
/// there.
pub fn largest_from<'a, S: Shape>(
    occluders: &Occluders<S>,
    list: impl Iterator<Item = &'a (u32, f32)>,
    from: S::Point,
    most: u32,
    into: &mut Vec<(u32, f32)>,
) {
    into.clear();
    into.extend(list.map(|&(id, _)| (id, area_angle(occluders.get(id), from) as f32)));
    // Select, then sort only what is left: lists are a multiple of what is used.
    if into.len() > most as usize {
        into.select_nth_unstable_by(most as usize, better);
        into.truncate(most as usize);
    }
    into.sort_unstable_by(better);
}

/// All directions.
fn ways(directions: u32) -> Vec<[f64; 2]> {
    (0..directions).map(|i| direction(i, directions)).collect()
}

/// The component of a vector along a direction of the ground plane: x and −z in space, x and y in flatland.
fn along<S: Shape>(v: S::Point, [x, y]: [f64; 2]) -> f64 {
    if S::Vector::AXES == 2 { v.get(0) * x + v.get(1) * y } else { v.get(0) * x - v.get(2) * y }
}

impl Selection {
    /// Ranks all occluders for all leaves and directions; `None` when cancelled. `gain`: an occluder whose
    /// area-angle is below this share of the sum of those before it ends the list; 0 for never.
    pub fn new<S: Shape>(
        tree: &KdTree<S::Vector>,
        occluders: &Occluders<S>,
        [directions, most]: [u32; 2],
        gain: f64,
        progress: &dyn Progress,
    ) -> Option<Self> {
        let cells = cells::<S>(tree);
        // Leaves are numbered in the order in which they are found; lists lie by leaf, then by direction.
        let mut leaf_of = vec![0; tree.nodes().len()];
        cells.iter().enumerate().for_each(|(k, (node, _))| leaf_of[node.at()] = k as u32);
        let mut lists: Vec<Vec<(u32, f32)>> = Vec::new();
        // Some leaves at a time, so that progress can be shown and a person can cancel.
        for (i, some) in cells.chunks(LEAVES_AT_A_TIME).enumerate() {
            progress.report((i * LEAVES_AT_A_TIME) as f32 / cells.len() as f32, "selecting occluders");
            if progress.cancelled() {
                return None;
            }
            let ranked: Vec<_> = some
                // Collected in the order of the leaves, whichever is ranked first.
                .par_iter()
                .map(|(_, cell)| {
                    rank::<S>(occluders, &tree.nodes()[0].bounds, cell, [directions, most], gain)
                })
                .collect();
            lists.extend(ranked.into_iter().flatten());
        }
        let mut starts = vec![0];
        starts.extend(lists.iter().scan(0, |sum, list| {
            *sum += list.len() as u32;
            Some(*sum)
        }));
        Some(Self { directions: ways(directions), leaf_of, starts, lists: lists.concat() })
    }

    /// The number of the direction nearest to a line of sight.
    pub fn direction_of<S: Shape>(&self, sight: S::Point) -> u32 {
        // The ways are of unit length, and the length of the sight is the same in every comparison.
        let alike = |way: &[f64; 2]| along::<S>(sight, *way);
        let mut best = 0;
        for (i, way) in self.directions.iter().enumerate().skip(1) {
            // The first of equals.
            if alike(way) > alike(&self.directions[best]) {
                best = i;
            }
        }
        best as u32
    }
    /// The best occluders of a leaf and direction with their area-angles from the middle of the leaf, best
    /// first.
    pub fn list(&self, leaf: NodeId, direction: u32) -> &[(u32, f32)] {
        let at = self.leaf_of[leaf.at()] as usize * self.directions.len() + direction as usize;
        &self.lists[self.starts[at] as usize..self.starts[at + 1] as usize]
    }
    /// The tables, to be saved: leaf numbers by node, starts of lists, lists.
    pub fn tables(&self) -> (&[u32], &[u32], &[(u32, f32)]) {
        (&self.leaf_of, &self.starts, &self.lists)
    }
    /// A selection from its tables, if they fit each other and a tree of `nodes` nodes and `occluders`
    /// occluders.
    pub fn of_tables(
        directions: u32,
        (leaf_of, starts, lists): (Vec<u32>, Vec<u32>, Vec<(u32, f32)>),
        nodes: usize,
        occluders: usize,
    ) -> Option<Self> {
        // All that `list` takes for granted: slices in order and within the lists, two starts for every leaf
        // and direction, and occluders that exist.
        let ascending = starts.windows(2).all(|w| w[0] <= w[1]) && starts.first() == Some(&0);
        let whole = starts.last().is_some_and(|&end| end as usize == lists.len());
        let leaves = leaf_of.iter().max().map_or(0, |&most| most as usize + 1);
        let fits = leaf_of.len() == nodes && starts.len() == leaves * directions as usize + 1;
        let known = lists.iter().all(|l| (l.0 as usize) < occluders);
        (ascending && whole && fits && known).then(|| Self {
            directions: ways(directions),
            leaf_of,
            starts,
            lists,
        })
    }
    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        self.lists.len() * size_of::<(u32, f32)>()
            + (self.starts.len() + self.leaf_of.len()) * size_of::<u32>()
    }
    /// Every occluder that some list names, ascending.
    pub fn named(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.lists.iter().map(|l| l.0).collect();
        // Ascending, for `renumbered` searches in it.
        all.sort_unstable();
        all.dedup();
        all
    }
    /// The same lists after the occluders were numbered anew: by their place in `kept`, ascending.
    pub fn renumbered(mut self, kept: &[u32]) -> Self {
        for (id, _) in &mut self.lists {
            *id = kept.partition_point(|k| k < id) as u32;
        }
        self
    }
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

/// The lists of one leaf, direction by direction.
fn rank<S: Shape>(
    occluders: &Occluders<S>,
    whole: &Aabb<S::Vector>,
    cell: &Aabb<S::Vector>,
    [directions, most]: [u32; 2],
    gain: f64,
) -> Vec<Vec<(u32, f32)>> {
    let from = S::widened(cell.center());
    let enough = f64::from(whole.diagonal()) * DEPTH_SHARE;
    let has_depth = |id: u32| {
        let [low, high] = occluders.heights(id, whole);
        let occluder = occluders.get(id);
        // How far the scene reaches on the side that the leaf does not lie on.
        (if occluder.normal.dot(from - occluder.anchor) > 0.0 { -low } else { high }) > enough
    };
    // Once for the leaf; the directions share the order and differ in what counts.
    let mut scored: Vec<(u32, f32)> =
        occluders.all().iter().enumerate().map(|(id, o)| (id as u32, area_angle(o, from) as f32)).collect();
    scored.retain(|s| s.1 > 0.0 && has_depth(s.0));
    scored.sort_unstable_by(better);
    let cosine = cone(directions);
    let list = |i: u32| {
        let toward = direction(i, directions);
        let mut sum = 0.0;
        let mut list = Vec::new();
        for &(id, score) in &scored {
            // Full, or what follows adds too little beside those before it.
            if list.len() == (most * SPARE).max(LEAST) as usize || sum > 0.0 && f64::from(score) < gain * sum
            {
                break;
            }
            if is_toward(occluders, id, from, toward, cosine) {
                sum += f64::from(score);
                list.push((id, score));
            }
        }
        list
    };
    (0..directions).map(list).collect()
}

/// Whether some corner of an occluder, its center, or the middle between the two lies within a cone.
fn is_toward<S: Shape>(
    occluders: &Occluders<S>,
    id: u32,
    from: S::Point,
    toward: [f64; 2],
    cosine: f64,
) -> bool {
    // A few points stand for the polygon: where they miss, some culling is lost, and never anything visible.
    let center = occluders.get(id).center;
    let within = |p: S::Point| {
        let v = p - from;
        along::<S>(v, toward) >= cosine * v.length()
    };
    let corners = || occluders.edges(id).iter().map(|e| e.from);
    within(center) || corners().any(|c| within(c) || within((c + center) * 0.5))
}
