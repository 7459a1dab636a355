//! Boxes inside closed parts (Zhang et al. 1997, Section 8): twelve triangles, however finely a part is
//! tessellated.
//!
//! 1. *Parts* are primitives that hang together by edges (in flatland by ends). One is closed if along each
//!    edge as many primitives run one way as the other; then each point has a winding number.
//! 2. A part's bounds are cut at the coordinates of its points, of many evenly. A *cell* is inside if no
//!    primitive reaches into it, and its center has a winding number other than 0 (above 0 where only fronts
//!    are drawn): all of it then has. Rays along the first axis count it, by exact predicates.
//! 3. From each cell a box grows as far as all cells are inside; the largest one is taken, then the largest
//!    around a cell that is left, and so on. Boxes overlap, so that they leave no slits where they meet.
//! 4. Each is made smaller by a margin, and given to the nearest leaf that holds some of the part.
//!
//! Why nothing shows ([`Inside::is_deep_enough`]): the rasterizer moves corners by half a grid step an axis,
//! those of the box and those of the part. Take a sample that the box covers, and the point of the box there
//! before it was moved. All points of the part's surface are farther from it than both moves together, on
//! the screen and in depth. While corners are moved into their places the surface does not pass through that
//! point, so its winding number stays what it was; and since the part is closed and lies as a whole beyond
//! the near plane, its moved surface crosses the line of sight before that point. So it covers the sample,
//! nearer than the box does there.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use super::Made;
use crate::culling::occlusion_maps::leaves::Leaves;
use crate::geometry::{
    Aabb, NodeId, PrimId, Projection, Sets, Space, Vector, View, farthest_depth, nearest_depth, orient2d,
};
use crate::raster::{DEPTH_SLACK, Drawable};
use crate::scene::{Progress, Scene, Surfaces};

/// Most planes that cut a part along an axis.
const PLANES: usize = 9;
/// Most boxes of a part.
const BOXES: usize = 4;
/// A margin is this part of a box's shortest side, and at most this one of its longest. The first leaves most
/// of a thin wall, the second takes little off a block.
const OF_SHORTEST: f32 = 1.0 / 8.0;
const OF_LONGEST: f32 = 1.0 / 64.0;
/// Parts that are worked on between two looks at whether it was cancelled.
const AT_A_TIME: usize = 64;

/// What the boxes of a leaf lie in.
#[derive(Clone, Debug)]
pub(crate) struct Inside<V> {
    /// Bounds of the boxes.
    boxes: Aabb<V>,
    /// Bounds of the parts around them.
    parts: Aabb<V>,
    /// Nothing of a part's surface is nearer to its boxes, world units.
    margin: f32,
}

impl<V: Vector> Inside<V> {
    /// Whether the boxes lie so deep in their parts that nothing of them shows; see the module.
    pub fn is_deep_enough<S: Space<Vector = V>>(&self, view: &View<S>, projection: &Projection<V>) -> bool {
        // Wholly beyond the near plane: a surface that it cuts open is closed no more.
        let near = view.eye.near;
        if nearest_depth(projection, &self.parts, near) >= 1.0 / near {
            return false;
        }
        let (mut step, mut slope) = (0.0f64, 1.0f64);
        for (axis, pixels) in [view.width, view.height].into_iter().enumerate().take(V::AXES - 1) {
            // Half the image at depth 1.
            let half = 1.0 / f64::from(projection.rows[axis].length());
            step = step.max(2.0 * half / f64::from(pixels) / 256.0);
            slope += half * half;
        }
        // Half a step an axis for the box and half a one for the part, and as much again for rounding. Along
        // the line of sight fragments of both may differ from the surface by the slack, and so may those of
        // what is culled; that line is longer than the depth by the slope.
        let needed = 2.0 * 1.5 * step + 4.0 * DEPTH_SLACK * slope.sqrt();
        let farthest = 1.0 / f64::from(farthest_depth(projection, &self.boxes, near));
        f64::from(self.margin) >= needed * farthest
    }
}

/// A box in a part.
struct Found<V> {
    bounds: Aabb<V>,
    margin: f32,
    part: Aabb<V>,
    leaf: NodeId,
}

/// The boxes of all leaves; `None` when cancelled.
pub fn boxes<S: Drawable>(
    leaves: &Leaves<'_, S>,
    surfaces: Surfaces,
    least: f32,
    progress: &dyn Progress,
) -> Option<BTreeMap<NodeId, Made<S>>> {
    let scene = leaves.scene;
    let leaf_of = leaves.of_prims();
    let parts = closed_parts(scene, surfaces);
    let mut made: BTreeMap<NodeId, Made<S>> = BTreeMap::new();
    for (i, some) in parts.chunks(AT_A_TIME).enumerate() {
        progress.report((i * AT_A_TIME) as f32 / parts.len() as f32, "looking for boxes inside");
        if progress.cancelled() {
            return None;
        }
        let of = |part: &Vec<PrimId>| in_part(leaves, part, &leaf_of, surfaces.one_sided, least);
        // Collected in the order of the parts, whichever is done first.
        let found: Vec<Vec<Found<S::Vector>>> = some.par_iter().map(of).collect();
        for Found { bounds, margin, part, leaf } in found.into_iter().flatten() {
            let of_leaf = made.entry(leaf).or_default();
            sides::<S>(&bounds).into_iter().for_each(|corners| of_leaf.add(corners, false));
            let all = of_leaf.inside.get_or_insert(Inside { boxes: bounds, parts: part, margin });
            (all.boxes, all.parts) = (all.boxes.union(bounds), all.parts.union(part));
            all.margin = all.margin.min(margin);
        }
    }
    Some(made)
}

/// 1. Closed parts, each by its primitives, ascending. What moves would take its boxes along.
fn closed_parts<S: Space>(scene: &Scene<S>, surfaces: Surfaces) -> Vec<Vec<PrimId>> {
    // Each primitive's edges with the way that it runs along them; in flatland its beginning and its end.
    let mut edges: Vec<([u32; 2], i32, PrimId)> = Vec::new();
    for &prim in scene.live().iter().filter(|p| !surfaces.show_through(scene, **p)) {
        let Some(corners) = scene.corners(prim) else { continue };
        let c = corners.as_ref();
        if S::CORNERS == 2 {
            edges.extend([([c[0]; 2], -1, prim), ([c[1]; 2], 1, prim)]);
        } else {
            edges.extend([[0, 1], [1, 2], [2, 0]].map(|[a, b]| {
                let (from, to) = (c[a], c[b]);
                ([from.min(to), from.max(to)], i32::from(from < to) - i32::from(to < from), prim)
            }));
        }
    }
    edges.sort_unstable();
    let mut joined = Sets::new(scene.prim_count());
    for along in edges.chunk_by(|a, b| a.0 == b.0) {
        for pair in along.windows(2) {
            joined.join(pair[0].2.0, pair[1].2.0);
        }
    }
    let mut parts: BTreeMap<u32, (Vec<PrimId>, bool)> = BTreeMap::new();
    for along in edges.chunk_by(|a, b| a.0 == b.0) {
        let is_even = along.iter().map(|e| e.1).sum::<i32>() == 0;
        let part = parts.entry(joined.root(along[0].2.0)).or_insert((Vec::new(), true));
        part.1 &= is_even && !along.iter().any(|e| scene.is_moving(e.2));
        part.0.extend(along.iter().map(|e| e.2));
    }
    let closed = parts.into_values().filter(|p| p.1).map(|(mut prims, _)| {
        prims.sort_unstable();
        prims.dedup();
        prims
    });
    closed.collect()
}

/// 2. to 4. for a part.
fn in_part<S: Space>(
    leaves: &Leaves<'_, S>,
    prims: &[PrimId],
    leaf_of: &[Option<NodeId>],
    one_sided: bool,
    least: f32,
) -> Vec<Found<S::Vector>> {
    let scene = leaves.scene;
    let part = prims.iter().fold(Aabb::empty(), |b, &p| b.union(scene.prim_bounds(p)));
    let mut of_part: Vec<NodeId> = prims.iter().filter_map(|p| leaf_of[p.at()]).collect();
    of_part.sort_unstable();
    of_part.dedup();
    if of_part.is_empty() || part.diagonal() < least {
        return Vec::new();
    }
    let Some(mut cells) = Cells::new(scene, prims, one_sided) else { return Vec::new() };
    let mut found = Vec::new();
    while found.len() < BOXES {
        let Some(bounds) = cells.largest_box() else { break };
        let size = |a: usize| bounds.max.get(a) - bounds.min.get(a);
        let sides = || (0..S::Vector::AXES).map(size);
        let (shortest, longest) = (sides().fold(f32::INFINITY, f32::min), sides().fold(0.0, f32::max));
        let inset = S::Vector::splat((shortest * OF_SHORTEST).min(longest * OF_LONGEST));
        let inner = Aabb { min: bounds.min + inset, max: bounds.max - inset };
        // By how much it really is smaller, far from the origin.
        let gap = |a: usize| (inner.min.get(a) - bounds.min.get(a)).min(bounds.max.get(a) - inner.max.get(a));
        let margin = (0..S::Vector::AXES).map(gap).fold(f32::INFINITY, f32::min);
        let far = |leaf: &NodeId| (leaves.tree.nodes()[leaf.at()].bounds.center() - inner.center()).length();
        let nearest = of_part.iter().min_by(|a, b| far(a).total_cmp(&far(b)).then(a.cmp(b)));
        if let Some(&leaf) = nearest.filter(|_| inner.diagonal() >= least && margin > 0.0) {
            found.push(Found { bounds: inner, margin, part, leaf });
        }
    }
    found
}

/// The bounds of a part in cells.
struct Cells<V> {
    /// Where the cells along each axis begin, and the end.
    planes: [Vec<f32>; 3],
    /// Whether each cell is inside, and is in no box so far.
    inside: Vec<bool>,
    is_left: Vec<bool>,
    /// How many cells before each corner of cells, along all axes, are inside.
    sums: Vec<u32>,
    kinds: std::marker::PhantomData<V>,
}

/// Cells of a box, by axes.
type Span = [Range<usize>; 3];

impl<V: Vector> Cells<V> {
    fn new<S: Space<Vector = V>>(scene: &Scene<S>, prims: &[PrimId], one_sided: bool) -> Option<Self> {
        let planes =
            std::array::from_fn(
                |axis| if axis < V::AXES { cuts(scene, prims, axis) } else { vec![0.0, 1.0] },
            );
        let (inside, is_left, sums, kinds) = (Vec::new(), Vec::new(), Vec::new(), std::marker::PhantomData);
        let mut cells = Self { planes, inside, is_left, sums, kinds };
        let [wide, high, deep] = cells.counts();
        let count = wide * high * deep;
        if count == 0 {
            return None;
        }
        let (mut is_free, mut windings) = (vec![true; count], vec![0; count]);
        for &prim in prims {
            let mut corners = [V::default(); 3];
            for (to, from) in corners.iter_mut().zip(scene.prim_points(prim)) {
                *to = from;
            }
            let corners = &corners[..S::CORNERS];
            let bounds = Aabb::of(corners.iter().copied());
            cells.each(&cells.reached(&bounds), |at, bounds| {
                // Beside its plane, or as far as its face lies in it.
                let sides = || bounds.corners().map(|c| S::side(corners, c));
                let beside = sides().all(|s| s >= 0.0) || sides().all(|s| s <= 0.0);
                // One without a plane is beside it everywhere.
                is_free[at] &= beside && sides().any(|s| s != 0.0);
            });
            let rays = cells.rays_through(&bounds);
            cells.each(&rays, |at, bounds| windings[at] += crossing::<S>(corners, bounds.center()));
        }
        let is_in = |winding: &i32| if one_sided { *winding > 0 } else { *winding != 0 };
        cells.inside = is_free.iter().zip(&windings).map(|(free, winding)| *free && is_in(winding)).collect();
        // A center that rounding puts on a side of its cell is none.
        let (all, mut flat) = (cells.all(), vec![false; count]);
        cells.each(&all, |at, bounds| {
            let center = bounds.center();
            flat[at] = (0..V::AXES)
                .any(|a| !(bounds.min.get(a) < center.get(a) && center.get(a) < bounds.max.get(a)));
        });
        cells.inside.iter_mut().zip(flat).for_each(|(inside, flat)| *inside &= !flat);
        cells.is_left.clone_from(&cells.inside);
        cells.sum_up();
        Some(cells)
    }
    fn counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|a| self.planes[a].len() - 1)
    }
    fn all(&self) -> Span {
        self.counts().map(|n| 0..n)
    }
    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        let [wide, high, _] = self.counts();
        (z * high + y) * wide + x
    }
    fn bounds(&self, cells: &Span) -> Aabb<V> {
        let at = |end: fn(&Range<usize>) -> usize| V::from_fn(|a| self.planes[a][end(&cells[a])]);
        Aabb { min: at(|r| r.start), max: at(|r| r.end) }
    }
    /// The cells along the first axis whose centers are level with a box along the others.
    fn rays_through(&self, bounds: &Aabb<V>) -> Span {
        let mut rays = self.all();
        for (axis, cells) in rays.iter_mut().enumerate().take(V::AXES).skip(1) {
            let planes = &self.planes[axis];
            let center = |i: &usize| planes[*i] * 0.5 + planes[*i + 1] * 0.5;
            let hit = |i: &usize| (bounds.min.get(axis)..=bounds.max.get(axis)).contains(&center(i));
            let first = cells.clone().find(hit).unwrap_or(0);
            *cells = first..cells.clone().rev().find(hit).map_or(first, |last| last + 1);
        }
        rays
    }
    /// Makes the sums.
    fn sum_up(&mut self) {
        let [wide, high, deep] = self.counts();
        self.sums = vec![0; (wide + 1) * (high + 1) * (deep + 1)];
        for z in 1..=deep {
            for y in 1..=high {
                let mut row = 0;
                for x in 1..=wide {
                    row += u32::from(self.inside[self.number([x - 1, y - 1, z - 1])]);
                    let before =
                        self.sum([x, y - 1, z]) + self.sum([x, y, z - 1]) - self.sum([x, y - 1, z - 1]);
                    self.sums[(z * (high + 1) + y) * (wide + 1) + x] = row + before;
                }
            }
        }
    }
    fn sum(&self, [x, y, z]: [usize; 3]) -> u32 {
        let [wide, high, _] = self.counts();
        self.sums[(z * (high + 1) + y) * (wide + 1) + x]
    }
    /// Whether all cells of a box are inside.
    fn are_inside(&self, [x, y, z]: &Span) -> bool {
        let up_to = |z: usize| {
            let (a, b) = (self.sum([x.end, y.end, z]), self.sum([x.start, y.start, z]));
            a + b - self.sum([x.start, y.end, z]) - self.sum([x.end, y.start, z])
        };
        (up_to(z.end) - up_to(z.start)) as usize == x.len() * y.len() * z.len()
    }
    /// Calls `visit` with the number and the bounds of each cell of a box.
    fn each(&self, cells: &Span, mut visit: impl FnMut(usize, &Aabb<V>)) {
        for z in cells[2].clone() {
            for y in cells[1].clone() {
                for x in cells[0].clone() {
                    let cell = [x..x + 1, y..y + 1, z..z + 1];
                    visit(self.number([x, y, z]), &self.bounds(&cell));
                }
            }
        }
    }
    /// The cells that a box reaches into: one that it touches only is not among them.
    fn reached(&self, bounds: &Aabb<V>) -> Span {
        let mut cells = self.all();
        for (axis, range) in cells.iter_mut().enumerate().take(V::AXES) {
            let planes = &self.planes[axis];
            let first = planes[1..].partition_point(|p| *p <= bounds.min.get(axis));
            let past = planes.partition_point(|p| *p < bounds.max.get(axis)).min(planes.len() - 1);
            *range = first..past.max(first);
        }
        cells
    }
    /// 3. The largest box of cells inside around one that is left, which is then left no more.
    fn largest_box(&mut self) -> Option<Aabb<V>> {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let [wide, high, _] = self.counts();
        let seed = |at: usize| [at % wide, at / wide % high, at / (wide * high)].map(|i| i..i + 1);
        let mut best: Option<(f64, Span)> = None;
        for at in (0..self.inside.len()).filter(|&at| self.is_left[at]) {
            // The third axis of flatland has one cell.
            for order in &ORDERS[..if V::AXES == 2 { 3 } else { 6 }] {
                let grown = self.grown(seed(at), order);
                let size = self.bounds(&grown).size();
                let volume: f64 = (0..V::AXES).map(|a| f64::from(size.get(a))).product();
                if best.as_ref().is_none_or(|b| volume > b.0) {
                    best = Some((volume, grown));
                }
            }
        }
        let (_, cells) = best?;
        let mut taken = Vec::new();
        self.each(&cells, |at, _| taken.push(at));
        taken.into_iter().for_each(|at| self.is_left[at] = false);
        Some(self.bounds(&cells))
    }
    /// A box grown along the axes in order, down and up, as far as all of its cells are inside.
    fn grown(&self, mut cells: Span, order: &[usize; 3]) -> Span {
        for &axis in order {
            let with = |cells: &Span, slab: Range<usize>| {
                let mut some = cells.clone();
                some[axis] = slab;
                some
            };
            while cells[axis].start > 0
                && self.are_inside(&with(&cells, cells[axis].start - 1..cells[axis].start))
            {
                cells[axis].start -= 1;
            }
            while cells[axis].end < self.counts()[axis]
                && self.are_inside(&with(&cells, cells[axis].end..cells[axis].end + 1))
            {
                cells[axis].end += 1;
            }
        }
        cells
    }
}

/// Where a part is cut along an axis, ascending.
fn cuts<S: Space>(scene: &Scene<S>, prims: &[PrimId], axis: usize) -> Vec<f32> {
    let mut at: Vec<f32> = prims.iter().flat_map(|&p| scene.prim_points(p)).map(|p| p.get(axis)).collect();
    at.sort_by(f32::total_cmp);
    at.dedup();
    if let (Some(&low), Some(&high), true) = (at.first(), at.last(), at.len() > PLANES) {
        let steps = (PLANES - 1) as f32;
        at = (0..PLANES).map(|k| low + (high - low) * (k as f32 / steps)).collect();
        // The part ends where its last point is.
        at[PLANES - 1] = high;
        at.dedup();
    }
    at
}

/// By how much a ray from a point along the first axis changes the winding number where it crosses a
/// primitive: 1 where it leaves by its front, −1 where it enters, 0 where it passes by. Points on an edge
/// count for one of the primitives that meet there, as though the point stood a little farther along the
/// second axis, and less so along the third.
fn crossing<S: Space>(corners: &[S::Vector], from: S::Vector) -> i32 {
    let flat = |p: S::Vector| glam::dvec2(f64::from(p.get(1)), f64::from(p.get(S::Vector::AXES - 1)));
    let at = flat(from);
    // The first axis of the normal, exactly, and whether the ray meets the primitive's image.
    let (toward, is_met) = if S::CORNERS == 2 {
        let (a, b) = (flat(corners[0]).x, flat(corners[1]).x);
        (a - b, (a <= at.x) != (b <= at.x))
    } else {
        let [a, b, c] = [flat(corners[0]), flat(corners[1]), flat(corners[2])];
        let mut is_met = false;
        for (u, v) in [(a, b), (b, c), (c, a)] {
            let turn = orient2d(u, v, at);
            is_met ^= (u.y <= at.y) != (v.y <= at.y) && if u.y <= v.y { turn > 0.0 } else { turn < 0.0 };
        }
        (orient2d(a, b, c), is_met)
    };
    let side = S::side(corners, from);
    match (is_met, toward > 0.0, side < 0.0) {
        (true, true, true) => 1,
        (true, false, false) if toward < 0.0 && side > 0.0 => -1,
        _ => 0,
    }
}

/// The sides of a box, seen from outside: two triangles a face, in flatland segments.
fn sides<S: Space>(bounds: &Aabb<S::Vector>) -> Vec<[S::Vector; 3]> {
    let corner = |i: usize| bounds.corner(i);
    if S::CORNERS == 2 {
        return [[0, 2], [2, 3], [3, 1], [1, 0]].map(|[a, b]| [corner(a), corner(b), corner(b)]).into();
    }
    let mut all = Vec::new();
    for axis in 0..3 {
        // A corner's number has a bit an axis, set at the upper end. Around the upper face these run
        // counter-clockwise as seen from beyond it.
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let upper = [0, u, u | v, v].map(|c| corner(c | 1 << axis));
        let lower = [0, v, u | v, u].map(corner);
        for [a, b, c, d] in [upper, lower] {
            all.extend([[a, b, c], [a, c, d]]);
        }
    }
    all
}
