//! The visibility preprocess (Zhang et al. 1997, Section 5.3.2): what can be seen from the points of a grid.
//!
//! 1. "The model space is subdivided by a uniform grid": points at equal distances along each axis, the first
//!    and the last a little outside of the scene, so that they see its outer faces too. A scene without a
//!    thickness has points on both sides.
//! 2. "Visibility is sampled at each grid point by surrounding the grid point with a cube and using an item
//!    buffer algorithm": six images of [`SIDE`]² pixels, in flatland four lines. Each pixel that shows
//!    something adds the solid angle of the pixel to the leaf that holds it.
//! 3. "Each grid point gets a list of visible objects": its leaves of the occluder database, with the angle
//!    under which each is seen.
//! 4. "At run-time, occluders can be chosen from visible object lists of grid points nearest to the viewing
//!    point": those at the corners of the grid's cell that holds the eye, 8 in space and 4 in flatland; of an
//!    eye outside, of the nearest cell. What a leaf has in their lists is summed, each by its trilinear
//!    weight. A point in a solid thing sees that thing only, and one from which nothing is seen adds nothing:
//!    the others make up for it.
//!
//! What moves is neither in the lists nor hides what is, so that they are right for every frame.
//! Cost: O(points · (primitives + pixels)) time, in parallel; 8 bytes for each leaf that a point sees.

use rayon::prelude::*;

use super::leaves::Leaves;
use crate::geometry::{Aabb, Eye, Frustum, FrustumTest, NodeId, PrimId, Space, Vector, View};
use crate::raster::{Drawable, Options, Target};
use crate::scene::{Progress, Surfaces};

/// Pixels a side of the images about a point. A line of flatland costs little, so it has more.
pub const SIDE: [u32; 2] = [64, 256];
/// Points that are worked on between two looks at whether it was cancelled.
const POINTS_AT_A_TIME: usize = 32;
/// By what share of its diagonal the grid is larger than the scene, on each side.
const MARGIN: f32 = 1.0 / 64.0;
/// Entries of all lists together, at most: 256 MB. Where there would be more, a point keeps those that look
/// largest, and at least [`LEAST`].
const MOST: usize = 1 << 25;
const LEAST: usize = 64;

/// What is seen from each point of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<V> {
    bounds: Aabb<V>,
    /// Points along each axis; 1 along the third in flatland.
    counts: [u32; 3],
    /// Where the list of each point begins, and the end; points by the first axis, then the second.
    starts: Vec<u32>,
    /// Leaves, ascending in each list, and the angle under which each is seen, steradians (radians in
    /// flatland).
    leaves: Vec<NodeId>,
    angles: Vec<f32>,
}

impl<V: Vector> Grid<V> {
    /// A grid without lists: `most` points along the longest side, and as dense along the others.
    pub fn new(bounds: &Aabb<V>, most: u32) -> Self {
        // 1. Of a scene that is a point the margin comes from its place, so that it is no less than rounding.
        let reach = (0..V::AXES).map(|a| bounds.max.get(a).abs().max(bounds.min.get(a).abs()));
        let least = reach.fold(1e-6, f32::max) * 1e-3;
        let margin = V::splat((bounds.diagonal() * MARGIN).max(least));
        let bounds = Aabb { min: bounds.min - margin, max: bounds.max + margin };
        let size = bounds.size();
        let longest = (0..V::AXES).map(|a| size.get(a)).fold(0.0, f32::max);
        let along = |axis: usize| match most {
            _ if axis >= V::AXES => 1,
            0 | 1 => 1,
            // At least one on each side.
            _ => ((size.get(axis) / longest * (most - 1) as f32).round() as u32 + 1).max(2),
        };
        let counts = [along(0), along(1), along(2)];
        Self { bounds, counts, starts: vec![0], leaves: Vec::new(), angles: Vec::new() }
    }
    /// How many points it has.
    pub fn len(&self) -> usize {
        self.counts.iter().map(|&n| n as usize).product()
    }
    /// Where a point is.
    pub fn place(&self, point: usize) -> V {
        let [wide, high, _] = self.counts.map(|n| n as usize);
        let at = [point % wide, point / wide % high, point / (wide * high)];
        V::from_fn(|a| {
            let (low, high) = (self.bounds.min.get(a), self.bounds.max.get(a));
            // A single one stands in the middle.
            let share = if self.counts[a] == 1 { 0.5 } else { at[a] as f32 / (self.counts[a] - 1) as f32 };
            low + (high - low) * share
        })
    }
    /// The list of a point.
    pub fn list(&self, point: usize) -> impl Iterator<Item = (NodeId, f32)> {
        let range = self.starts[point] as usize..self.starts[point + 1] as usize;
        self.leaves[range.clone()].iter().copied().zip(self.angles[range].iter().copied())
    }
    /// The points about a place, with their weights, which are 1 together; none of weight 0.
    pub fn about(&self, place: V) -> impl Iterator<Item = (usize, f32)> {
        // 4. Trilinear: along each axis the point before and the one after, by how near they are.
        let (mut before, mut share) = ([0usize; 3], [0.0f32; 3]);
        for a in (0..V::AXES).filter(|&a| self.counts[a] > 1) {
            let cells = self.counts[a] - 1;
            let (low, high) = (self.bounds.min.get(a), self.bounds.max.get(a));
            let at = ((place.get(a) - low) / (high - low) * cells as f32).clamp(0.0, cells as f32);
            before[a] = (at as usize).min(cells as usize - 1);
            share[a] = at - before[a] as f32;
        }
        let [wide, high, _] = self.counts.map(|n| n as usize);
        (0..1usize << V::AXES).filter_map(move |corner| {
            let (mut at, mut weight) = (before, 1.0);
            for a in 0..V::AXES {
                let is_after = corner >> a & 1 == 1;
                at[a] += usize::from(is_after);
                weight *= if is_after { share[a] } else { 1.0 - share[a] };
            }
            (weight > 0.0).then_some(((at[2] * high + at[1]) * wide + at[0], weight))
        })
    }
    /// For each node the angle under which the points about a place see it, by their weights; and how many
    /// points that are.
    pub fn angles_about(&self, place: V, nodes: usize, to: &mut Vec<f32>) -> u32 {
        to.clear();
        to.resize(nodes, 0.0);
        let mut count = 0;
        for (point, weight) in self.about(place) {
            self.list(point).for_each(|(leaf, angle)| to[leaf.at()] += weight * angle);
            count += 1;
        }
        count
    }
    /// Where the lists begin, their leaves and angles.
    pub fn tables(&self) -> (&[u32], &[NodeId], &[f32]) {
        (&self.starts, &self.leaves, &self.angles)
    }
    /// The grid with these lists, if they fit it.
    pub fn with(self, starts: Vec<u32>, leaves: Vec<NodeId>, angles: Vec<f32>) -> Option<Self> {
        // All that `list` takes for granted.
        let ascending = starts.windows(2).all(|w| w[0] <= w[1]) && starts.first() == Some(&0);
        let whole = starts.last().is_some_and(|&end| end as usize == leaves.len());
        let fits = starts.len() == self.len() + 1 && leaves.len() == angles.len();
        (ascending && whole && fits).then_some(Self { starts, leaves, angles, ..self })
    }
    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.leaves.len() + self.angles.len())
    }
    /// Makes the lists; `None` when cancelled.
    pub fn fill<S: Drawable<Vector = V>>(
        mut self,
        leaves: &Leaves<'_, S>,
        surfaces: Surfaces,
        progress: &dyn Progress,
    ) -> Option<Self> {
        let points: Vec<usize> = (0..self.len()).collect();
        let longest = (MOST / points.len()).max(LEAST);
        let leaf_of = leaves.of_prims();
        for (i, some) in points.chunks(POINTS_AT_A_TIME).enumerate() {
            progress.report((i * POINTS_AT_A_TIME) as f32 / points.len() as f32, "looking from grid points");
            if progress.cancelled() {
                return None;
            }
            // Collected in the order of the points, whichever is done first.
            let look = |buffer: &mut ItemBuffer<S>, &point: &usize| {
                buffer.look(leaves, &leaf_of, self.place(point), &self.bounds, longest)
            };
            let lists: Vec<_> =
                some.par_iter().map_init(|| ItemBuffer::new(leaves, surfaces), look).collect();
            for (leaf, angle) in lists.into_iter().flat_map(|list| {
                self.starts.push(self.starts[self.starts.len() - 1] + list.len() as u32);
                list
            }) {
                self.leaves.push(leaf);
                self.angles.push(angle);
            }
        }
        Some(self)
    }
}

/// The views about a point that meet in it, which together see all around: along each axis there and back.
pub fn views_about<S: Space>(point: S::Vector, bounds: &Aabb<S::Vector>) -> Vec<View<S>> {
    let axes = S::Vector::AXES;
    let unit = |axis: usize, length: f32| S::Vector::from_fn(|a| if a == axis { length } else { 0.0 });
    let side = SIDE[usize::from(axes == 2)];
    // From the point to the farthest corner and beyond; as near as makes no difference.
    let reach = bounds.diagonal() * 2.0;
    let view = |(axis, length): (usize, f32)| {
        let eye = Eye {
            position: point,
            // As far away as the scene is large: a step of 1 may be lost in rounding.
            target: point + unit(axis, length * reach),
            up: unit((axis + 1) % axes, 1.0),
            fov: std::f32::consts::FRAC_PI_2,
            near: reach * 1e-5,
            far: reach,
        };
        View { eye, width: side, height: if axes == 2 { 1 } else { side } }
    };
    (0..axes).flat_map(|axis| [1.0, -1.0].map(|length| (axis, length))).map(view).collect()
}

/// The angle that each pixel of such a view is seen under, row by row: its area on the image plane at
/// distance 1, by (1 + u² + v²)^(−3/2), in flatland its length by (1 + u²)^(−1).
pub fn pixel_angles<S: Space>() -> Vec<f64> {
    let is_flat = S::CORNERS == 2;
    let side = SIDE[usize::from(is_flat)];
    let step = 2.0 / f64::from(side);
    let at = |k: u32| (f64::from(k) + 0.5) * step - 1.0;
    if is_flat {
        return (0..side).map(|x| step / (1.0 + at(x) * at(x))).collect();
    }
    let pixel = |x: u32, y: u32| {
        let square = 1.0 + at(x) * at(x) + at(y) * at(y);
        step * step / (square * square.sqrt())
    };
    (0..side).flat_map(|y| (0..side).map(move |x| pixel(x, y))).collect()
}

/// What a point looks with; used again for the next one.
struct ItemBuffer<S: Space> {
    target: Target,
    options: Options,
    prims: Vec<PrimId>,
    pixels: Vec<f64>,
    /// Of each node the angle under which it is seen, and the nodes of which it is not 0.
    angles: Vec<f64>,
    found: Vec<NodeId>,
    kinds: std::marker::PhantomData<S>,
}

impl<S: Drawable> ItemBuffer<S> {
    fn new(leaves: &Leaves<'_, S>, surfaces: Surfaces) -> Self {
        Self {
            target: Target::default(),
            options: Options { surfaces, ..Options::default() },
            prims: Vec::new(),
            pixels: pixel_angles::<S>(),
            angles: vec![0.0; leaves.tree.nodes().len()],
            found: Vec::new(),
            kinds: std::marker::PhantomData,
        }
    }
    /// 2. and 3.: the leaves that are seen from a point, ascending, of these the `longest` that look largest.
    fn look(
        &mut self,
        leaves: &Leaves<'_, S>,
        leaf_of: &[Option<NodeId>],
        point: S::Vector,
        bounds: &Aabb<S::Vector>,
        longest: usize,
    ) -> Vec<(NodeId, f32)> {
        for view in views_about::<S>(point, bounds) {
            self.prims.clear();
            self.gather(leaves, &view.frustum(), (NodeId(0), Frustum::<S::Vector>::ALL));
            S::redraw(&mut self.target, leaves.scene, &view, &self.prims, &self.options);
            for (&item, &angle) in self.target.item.iter().zip(&self.pixels) {
                // What is no occluder hides what is.
                let Some(leaf) = leaf_of.get(item as usize).copied().flatten() else { continue };
                if self.angles[leaf.at()] == 0.0 {
                    self.found.push(leaf);
                }
                self.angles[leaf.at()] += angle;
            }
        }
        let angle = |leaf: &NodeId| (*leaf, self.angles[leaf.at()] as f32);
        let mut list: Vec<(NodeId, f32)> = self.found.iter().map(angle).collect();
        self.found.drain(..).for_each(|leaf| self.angles[leaf.at()] = 0.0);
        if list.len() > longest {
            list.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            list.truncate(longest);
        }
        list.sort_by_key(|(leaf, _)| *leaf);
        list
    }
    /// What stands still in a view, from a node on.
    fn gather(&mut self, leaves: &Leaves<'_, S>, view: &Frustum<S::Vector>, (id, planes): (NodeId, u8)) {
        let node = &leaves.tree.nodes()[id.at()];
        let cutting = match view.test(&node.bounds, planes) {
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        match node.children().filter(|_| cutting > 0) {
            Some(children) => children.into_iter().for_each(|c| self.gather(leaves, view, (c, cutting))),
            None => {
                let moves = !leaves.scene.moving().is_empty();
                let still = |p: &&PrimId| !(moves && leaves.scene.is_moving(**p));
                self.prims.extend(leaves.tree.prims_below(id).iter().filter(still));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3, vec2, vec3};

    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, Solid};
    use crate::index::KdTree;
    use crate::scene::{Parts, Quiet, Scene};

    #[test]
    fn pixels_of_a_cube_fill_the_sphere() {
        use std::f64::consts::{PI, TAU};
        let all = |pixels: Vec<f64>, faces: f64| pixels.iter().sum::<f64>() * faces;
        let (sphere, circle) = (all(pixel_angles::<Solid>(), 6.0), all(pixel_angles::<Flat>(), 4.0));
        assert!((sphere / (4.0 * PI) - 1.0).abs() < 6e-5, "{sphere}");
        assert!((circle / TAU - 1.0).abs() < 6e-5, "{circle}");
        // A face of a cube is a sixth.
        assert!((sphere / 6.0 - 2.0 * PI / 3.0).abs() < 1e-3);
    }

    #[test]
    fn views_about_a_point_see_all_around() {
        let mut dice = Dice::new(3);
        let bounds = Aabb { min: Vec3::splat(-4.0), max: Vec3::splat(9.0) };
        let views = views_about::<Solid>(vec3(1.0, 2.0, 3.0), &bounds);
        for _ in 0..1000 {
            let p = vec3(1.0, 2.0, 3.0) + dice.point(1.0);
            let sees = |v: &&View<Solid>| {
                let clip = v.projection().clip(p);
                clip.z > 0.0 && clip.x.abs() <= clip.z && clip.y.abs() <= clip.z
            };
            assert_eq!(views.iter().filter(sees).count(), 1, "{p}");
        }
        assert_eq!(views_about::<Flat>(Vec2::ZERO, &Aabb { min: Vec2::ZERO, max: Vec2::ONE }).len(), 4);
    }

    #[test]
    fn points_are_as_dense_along_every_axis_and_weighted_by_nearness() {
        let bounds = Aabb { min: Vec3::ZERO, max: vec3(64.0, 16.0, 0.0) };
        let grid = Grid::new(&bounds, 16);
        // 66 by 18 by 2 with the margin, of 15 steps of 4.4.
        assert_eq!(grid.counts, [16, 5, 2], "a scene without a thickness has points on both sides");
        assert!(grid.place(0).z < 0.0 && grid.place(grid.len() - 1).z > 0.0);
        assert!(grid.place(0).x < -1.0 && grid.place(15).x > 65.0);
        let mut dice = Dice::new(4);
        for _ in 0..1000 {
            let place = vec3(dice.between(0.0, 64.0), dice.between(0.0, 16.0), dice.between(-1.0, 1.0));
            let about: Vec<_> = grid.about(place).collect();
            let mean = about.iter().fold(Vec3::ZERO, |m, &(point, w)| m + grid.place(point) * w);
            assert!(about.len() <= 8 && (about.iter().map(|a| a.1).sum::<f32>() - 1.0).abs() < 1e-5);
            assert!(mean.distance(place) < 1e-3, "linear between points: {mean} for {place}");
        }
        // Outside, the nearest; at a point, that one alone.
        assert_eq!(grid.about(vec3(-900.0, -900.0, -900.0)).collect::<Vec<_>>(), [(0, 1.0)]);
        let one = Grid::new(&bounds, 1);
        assert_eq!((one.len(), one.about(Vec3::ZERO).collect::<Vec<_>>()), (1, vec![(0, 1.0)]));
        assert!((one.place(0) - vec3(32.0, 8.0, 0.0)).length() < 1e-4);
        for point in [Vec2::ZERO, vec2(1e6, -1e6)] {
            let grid = Grid::new(&Aabb { min: point, max: point }, 16);
            assert!((0..grid.len()).all(|p| grid.place(p).is_finite() && grid.place(p) != point));
        }
    }

    /// A room of four walls with a wall across, whose halves see nothing of each other; one segment a leaf.
    #[test]
    fn lists_hold_what_is_seen_and_how_large() {
        let corners = [[0.0, 0.0], [16.0, 0.0], [16.0, 8.0], [0.0, 8.0], [8.0, 0.0], [8.0, 8.0]];
        let points = corners.iter().map(|&[x, y]| vec2(x, y)).collect();
        let prims = vec![[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0], [4, 5]];
        let scene = Scene::new(Parts::<Flat>::simple("rooms", points, prims)).expect("valid");
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let tree = KdTree::build(boxes, 4, || false).expect("not cancelled");
        let occluders = vec![true; tree.nodes().len()];
        let leaves = Leaves { scene: &scene, tree: &tree, occluders: &occluders };
        let made = || {
            let grid = Grid::new(&scene.bounds(), 11);
            grid.fill(&leaves, Surfaces::default(), &Quiet).expect("not cancelled")
        };
        let grid = made();
        assert!(grid == made(), "threads leave no trace");
        let of = |prim: u32| {
            let leaf = (0..tree.nodes().len() as u32)
                .map(NodeId)
                .find(|&n| tree.nodes()[n.at()].is_leaf() && tree.prims_below(n) == [PrimId(prim)]);
            leaf.expect("a leaf a segment")
        };
        let mut inside = 0;
        for point in 0..grid.len() {
            let place = grid.place(point);
            let list: Vec<_> = grid.list(point).collect();
            assert!(list.windows(2).all(|w| w[0].0 < w[1].0) && list.iter().all(|l| l.1 > 0.0));
            // In the rooms, and not in the wall between them.
            if !scene.bounds().contains(place) || (place.x - 8.0).abs() < 0.1 {
                continue;
            }
            inside += 1;
            let sum: f32 = list.iter().map(|l| l.1).sum();
            assert!((sum - std::f32::consts::TAU).abs() < 0.01, "walls all around: {sum}");
            let other = if place.x < 8.0 { [1, 2, 3] } else { [0, 4, 5] };
            assert!(list.iter().all(|l| !other.map(of).contains(&l.0)), "through the wall from {place}");
            // The wall across, by its ends.
            let angle = (vec2(8.0, 0.0) - place).angle_to(vec2(8.0, 8.0) - place).abs();
            let found = list.iter().find(|l| l.0 == of(6)).map_or(0.0, |l| l.1);
            assert!((found - angle).abs() < 0.05, "{found} for {angle} from {place}");
        }
        assert!(inside > 20, "{inside} points in the rooms");
    }
}
