//! The faces of color cubes: what is seen of a cell through each of its sides (Section 4).
//!
//! 1. A leaf's faces are its primitives, clipped to the cell, as they look along the axes: a small image,
//!    4×4 samples unless said otherwise, whose mean is the color, premultiplied by what is covered.
//! 2. An inner cell's faces are composed of its children's, column by column: the front one over the back
//!    one; the mean of the columns is the face (Figure 3). A child that holds nothing is clear. Or they are
//!    made as a leaf's.
//! 3. Where asked, what primitives show of themselves is not sampled but worked out ([`super::analytic`]).
//!
//! Colors are linear, under light that is fixed in the world: what the paper bakes cannot depend on the eye.

use super::analytic::{self, Surface};
use super::space::{Corners, Projected, Window};
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};
use crate::index::{CellTree, octant_of, octants_touched};
use crate::raster::{CubeFaces, VEIL, fixed_light};
use crate::scene::{Progress, Scene, Surfaces};

/// Linear color and coverage of each face, premultiplied; in the order of [`CubeFaces`].
pub type Faces = [[f32; 4]; 6];

/// How faces are made.
#[derive(Clone, Copy, Debug)]
pub struct Baking<'a, S: Space> {
    /// The scene.
    pub scene: &'a Scene<S>,
    /// Whether what turns away is seen, and light comes through.
    pub surfaces: Surfaces,
    /// Samples along a side of a face.
    pub side: u32,
    /// Whether areas are worked out where that can be, and not sampled.
    pub is_analytic: bool,
    /// Whether those of inner cells are composed of their children's.
    pub composes: bool,
}

/// What is made of each cell.
#[derive(Clone, Debug, Default)]
pub struct Baked {
    pub faces: Vec<CubeFaces>,
    /// How wrong its cube is, from where it is most so; nothing if that is not asked for.
    pub errors: Vec<f32>,
}

impl<S: Projected> Baking<'_, S> {
    /// The faces of all cells of a tree, and if asked their errors; `None` when cancelled.
    pub fn bake(&self, tree: &CellTree<S::Vector>, measures: bool, progress: &dyn Progress) -> Option<Baked> {
        let count = tree.nodes().len();
        let mut work = Work {
            tree,
            progress,
            done: 0,
            faces: vec![[[0.0; 4]; 6]; count],
            errors: vec![0.0; if measures { count } else { 0 }],
            room: Room::default(),
        };
        let all = if tree.items().are_single() { Vec::new() } else { self.scene.live().to_vec() };
        self.bake_below(&mut work, 0, tree.root(), all)?;
        // From unrounded values, so that nothing adds up.
        Some(Baked { faces: work.faces.iter().map(CubeFaces::new).collect(), errors: work.errors })
    }

    /// The faces of a cell and all below it, in post-order (Section 4); `None` when cancelled. `prims`: the
    /// primitives of objects that are in it.
    fn bake_below(
        &self,
        work: &mut Work<'_, S>,
        at: usize,
        cell: &Aabb<S::Vector>,
        mut prims: Vec<PrimId>,
    ) -> Option<()> {
        let (tree, id) = (work.tree, NodeId(at as u32));
        let node = &tree.nodes()[at];
        let (is_composed, measures) = (self.composes && !node.is_leaf(), !work.errors.is_empty());
        if !node.is_leaf() {
            let mut parted: [Vec<PrimId>; 8] = Default::default();
            // Objects are large: of their primitives most are in other cells.
            for &prim in &prims {
                let octants = octants_touched(&Aabb::of(self.scene.prim_points(prim)), cell);
                let met = parted.iter_mut().enumerate().filter(|(octant, _)| octants >> octant & 1 == 1);
                met.for_each(|(_, to)| to.push(prim));
            }
            if is_composed && !measures {
                prims = Vec::new();
            }
            for (octant, prims) in parted.into_iter().enumerate() {
                if let Some(child) = node.child(octant) {
                    self.bake_below(work, child.at(), &octant_of(cell, octant), prims)?;
                }
            }
        }
        if tree.items().are_single() && (!is_composed || measures) {
            prims = held(tree, id);
        }
        work.faces[at] = match is_composed {
            true => composed::<S::Vector>(|octant, face| {
                node.child(octant).map_or([0.0; 4], |child| work.faces[child.at()][face])
            }),
            false => self.projected(cell, &prims, &mut work.room),
        };
        if measures {
            work.errors[at] = self.error(cell, &prims, &work.faces[at], &mut work.room);
        }
        work.is_going_on()
    }

    /// Faces of a cell from its primitives, of ascending ids.
    pub fn projected(&self, cell: &Aabb<S::Vector>, prims: &[PrimId], room: &mut Room<S>) -> Faces {
        if self.is_analytic {
            let sampled = Self { side: analytic::SIDE, is_analytic: false, ..*self };
            return self
                .worked_out(cell, prims, room)
                .unwrap_or_else(|| sampled.projected(cell, prims, room));
        }
        let mut faces = [[0.0; 4]; 6];
        self.project(cell, prims, room, |face, samples| faces[face] = mean(samples));
        faces
    }

    /// Faces of a cell by areas; `None` where that takes too long, or light comes through.
    fn worked_out(&self, cell: &Aabb<S::Vector>, prims: &[PrimId], room: &mut Room<S>) -> Option<Faces> {
        let lit = &mut room.lit;
        self.light(cell, prims, 1, lit);
        if lit.iter().any(|one| one.through) {
            return None;
        }
        let mut faces = [[0.0; 4]; 6];
        for axis in 0..S::Vector::AXES {
            let surface = |one: &Lit<S>| {
                let outline = S::outline(&one.corners, axis)?;
                Some(Surface { outline, color: one.color, seen: one.seen_along(axis) })
            };
            let surfaces: Vec<Surface> = lit.iter().filter_map(surface).collect();
            faces[2 * axis..][..2].copy_from_slice(&analytic::both_faces(&surfaces)?);
        }
        Some(faces)
    }

    /// The samples of each face, row by row, of a cell with these primitives.
    pub fn samples(&self, cell: &Aabb<S::Vector>, prims: &[PrimId]) -> Vec<Vec<[f32; 4]>> {
        let mut faces = Vec::new();
        self.project(cell, prims, &mut Room::default(), |_, samples| {
            faces.push(samples.iter().map(Sample::color).collect());
        });
        faces
    }

    /// Calls `each` with the samples of each face in turn, row by row.
    fn project(
        &self,
        cell: &Aabb<S::Vector>,
        prims: &[PrimId],
        room: &mut Room<S>,
        mut each: impl FnMut(usize, &[Sample]),
    ) {
        let Room { lit, samples } = room;
        self.light(cell, prims, self.side, lit);
        let (count, top) = (S::sample_count(self.side), f64::from(self.side));
        // Both sides of an axis at a time: a sample of the one is a sample of the other.
        for axis in 0..S::Vector::AXES {
            samples.clear();
            samples.resize(2 * count, Sample::default());
            let (lower, upper) = samples.split_at_mut(count);
            // Those that light comes through last, over what the others left.
            for through in self.ways() {
                for one in lit.iter().filter(|one| one.through == *through) {
                    let [from_below, from_above] = one.seen_along(axis);
                    S::cover(&one.corners, axis, self.side, |at, height| {
                        if from_below {
                            lower[at].put(height, one.color, *through);
                        }
                        if from_above {
                            upper[at].put(top - height, one.color, *through);
                        }
                    });
                }
            }
            each(2 * axis, lower);
            each(2 * axis + 1, upper);
        }
    }
    /// Whether light comes through: what is drawn first, and what last, if there can be such.
    fn ways(&self) -> &'static [bool] {
        if self.surfaces.any_through(self.scene) { &[false, true] } else { &[false] }
    }
    /// Primitives as the faces of a cell see them that have so many samples a side.
    fn light(&self, cell: &Aabb<S::Vector>, prims: &[PrimId], side: u32, to: &mut Vec<Lit<S>>) {
        let (scene, window) = (self.scene, Window::new(cell, side));
        to.clear();
        to.extend(prims.iter().map(|&prim| {
            let light = fixed_light(scene, prim);
            let is_one_sided = self.surfaces.one_sided && !scene.is_two_sided(prim);
            Lit {
                corners: window.corners(scene, prim),
                color: scene.color_of(prim).map(|c| c * light),
                through: self.surfaces.show_through(scene, prim),
                front: is_one_sided.then(|| scene.normal(prim)),
            }
        }));
    }

    /// How wrong a cell's cube is from between the axes, where no face was made: over all directions of which
    /// two components or more are not 0, the greatest difference of a channel between what its faces show, by
    /// their projected areas, and what is in the cell. (Along the axes the faces are what is in the cell, so
    /// an error measured there is nothing: Section 5.1 shows surfaces torn from 45°.)
    pub fn error(&self, cell: &Aabb<S::Vector>, prims: &[PrimId], faces: &Faces, room: &mut Room<S>) -> f32 {
        let mut worst = 0.0_f32;
        self.light(cell, prims, self.side, &mut room.lit);
        for number in 0..3usize.pow(S::Vector::AXES as u32) {
            let toward = S::Vector::from_fn(|a| (number / 3usize.pow(a as u32) % 3) as f32 - 1.0);
            let axes: Vec<usize> = (0..S::Vector::AXES).filter(|a| toward.get(*a) != 0.0).collect();
            if axes.len() < 2 {
                continue;
            }
            let mut off = [0.0; 4];
            for &axis in &axes {
                let cube = faces[2 * axis + usize::from(toward.get(axis) > 0.0)];
                let seen = self.seen_along(room, toward, axis);
                // Components are alike, so are the areas of the faces.
                (0..4).for_each(|c| off[c] += (cube[c] - seen[c]) / axes.len() as f32);
            }
            worst = off.iter().fold(worst, |worst, c| worst.max(c.abs()));
        }
        worst
    }

    /// What is seen of a cell through its face on an axis, looking from a direction with components of 1, −1
    /// and 0: the cell is sheared until that is along the axis.
    fn seen_along(&self, room: &mut Room<S>, toward: S::Vector, axis: usize) -> [f32; 4] {
        let Room { lit, samples } = room;
        samples.clear();
        samples.resize(S::sample_count(self.side), Sample::default());
        let (is_upper, side) = (toward.get(axis) > 0.0, f64::from(self.side));
        let depth = |height: f64| if is_upper { side - height } else { height };
        let mut slope = [0.0; 3];
        (0..S::Vector::AXES).filter(|a| *a != axis).for_each(|a| slope[a] = f64::from(toward.get(a)));
        for through in self.ways() {
            for one in lit.iter().filter(|one| one.through == *through && one.is_seen(toward)) {
                let sheared = one.corners.map(|p| {
                    let inward = depth(p[axis]);
                    std::array::from_fn(|a| p[a] + slope[a] * inward)
                });
                S::cover(&sheared, axis, self.side, |at, height| {
                    // What the ray meets after it has left the cell by another side is not in it.
                    let inward = depth(height);
                    let is_inside = (1..S::Vector::AXES).all(|k| {
                        let number = if k == 1 { at as u32 % self.side } else { at as u32 / self.side };
                        let place = f64::from(number) + 0.5;
                        (0.0..=side).contains(&(place - slope[(axis + k) % S::Vector::AXES] * inward))
                    });
                    if is_inside {
                        samples[at].put(inward, one.color, *through);
                    }
                });
            }
        }
        mean(samples)
    }
}

/// The primitives of the items that the leaves at and below a cell refer to, ascending.
pub fn held<V: Vector>(tree: &CellTree<V>, id: NodeId) -> Vec<PrimId> {
    let mut items = tree.references(id).to_vec();
    items.sort_unstable();
    // Leaves below may share some, and light comes through each once.
    items.dedup();
    let mut prims = Vec::new();
    tree.items().extend(&mut prims, &items);
    prims
}

/// Faces in the making.
struct Work<'a, S: Space> {
    tree: &'a CellTree<S::Vector>,
    progress: &'a dyn Progress,
    done: usize,
    faces: Vec<Faces>,
    errors: Vec<f32>,
    room: Room<S>,
}

impl<S: Space> Work<'_, S> {
    /// Counts a cell that is done; `None` when cancelled.
    fn is_going_on(&mut self) -> Option<()> {
        self.done += 1;
        if self.done.is_multiple_of(1024) {
            self.progress.report(self.done as f32 / self.faces.len() as f32, "making color cubes");
            return (!self.progress.cancelled()).then_some(());
        }
        Some(())
    }
}

/// A primitive as the faces of a cell see it.
struct Lit<S: Space> {
    corners: Corners,
    /// Under the fixed light.
    color: [f32; 3],
    /// Whether light comes through it.
    through: bool,
    /// Where its front is, if it has no other side.
    front: Option<S::Vector>,
}

impl<S: Space> Lit<S> {
    /// Whether it is seen from a direction.
    #[inline]
    fn is_seen(&self, toward: S::Vector) -> bool {
        self.front.is_none_or(|front| front.dot(toward) > 0.0)
    }
    /// Whether it is seen along an axis, from below and from above.
    fn seen_along(&self, axis: usize) -> [bool; 2] {
        [-1.0, 1.0].map(|sign| self.is_seen(S::Vector::from_fn(|a| if a == axis { sign } else { 0.0 })))
    }
}

/// Room for what is seen of a cell, kept from one to the next.
pub struct Room<S: Space> {
    lit: Vec<Lit<S>>,
    samples: Vec<Sample>,
}

impl<S: Space> Default for Room<S> {
    fn default() -> Self {
        Self { lit: Vec::new(), samples: Vec::new() }
    }
}

/// What is seen at a sample of a face.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// How far from the face the nearest is that hides what is behind, infinite if there is none; its color.
    depth: f64,
    color: [f32; 3],
    /// How many it is seen through, and the sum of their colors.
    layers: u32,
    veil: [f32; 3],
}

impl Default for Sample {
    fn default() -> Self {
        Self { depth: f64::INFINITY, color: [0.0; 3], layers: 0, veil: [0.0; 3] }
    }
}

impl Sample {
    #[inline]
    fn put(&mut self, depth: f64, color: [f32; 3], through: bool) {
        // Of equally near ones the first stays, which is that of the lowest id, as in the z-buffer.
        if depth >= self.depth {
            return;
        }
        if through {
            self.layers += 1;
            (0..3).for_each(|c| self.veil[c] += color[c]);
        } else {
            (self.depth, self.color) = (depth, color);
        }
    }
    /// Premultiplied: each layer takes as much of a sample as where it is drawn as geometry.
    fn color(&self) -> [f32; 4] {
        let (color, alpha) = (self.color, if self.depth.is_finite() { 1.0 } else { 0.0 });
        if self.layers == 0 {
            return [color[0], color[1], color[2], alpha];
        }
        let through = (1.0 - VEIL).powi(self.layers as i32);
        let mean = self.veil.map(|sum| sum / self.layers as f32);
        let mixed: [f32; 3] = std::array::from_fn(|c| color[c] * through + mean[c] * (1.0 - through));
        [mixed[0], mixed[1], mixed[2], alpha * through + (1.0 - through)]
    }
}

/// Partial coverage is premultiplied: samples that show nothing count as black and clear.
fn mean(samples: &[Sample]) -> [f32; 4] {
    let sum = samples.iter().map(Sample::color);
    let sum = sum.fold([0.0; 4], |sum: [f32; 4], c| std::array::from_fn(|k| sum[k] + c[k]));
    sum.map(|c| c / samples.len() as f32)
}

/// A front face over a back face, premultiplied (Porter and Duff 1984).
pub fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|c| front[c] + (1.0 - front[3]) * back[c])
}

/// The faces of an inner cell from those of its children, by octant and face (Section 4, Figure 3).
pub fn composed<V: Vector>(of: impl Fn(usize, usize) -> [f32; 4]) -> Faces {
    let mut to = [[0.0; 4]; 6];
    for (face, to) in to.iter_mut().enumerate().take(2 * V::AXES) {
        let (axis, is_upper) = (face / 2, face % 2);
        // A column for each octant that lies at the face; the one behind it differs in that axis.
        let columns = (0..1usize << V::AXES).filter(|octant| octant >> axis & 1 == is_upper);
        let count = (1 << (V::AXES - 1)) as f32;
        for octant in columns {
            let column = over(of(octant, face), of(octant ^ 1 << axis, face));
            (0..4).for_each(|c| to[c] += column[c] / count);
        }
    }
    to
}
