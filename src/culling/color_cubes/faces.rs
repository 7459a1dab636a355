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
use super::space::Projected;
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};
use crate::index::CellTree;
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
        let mut faces: Vec<Faces> = vec![[[0.0; 4]; 6]; tree.nodes().len()];
        let mut errors = vec![0.0; if measures { faces.len() } else { 0 }];
        // Post-order: children have higher numbers. From unrounded values, so that nothing adds up.
        for (at, node) in tree.nodes().iter().enumerate().rev() {
            if at % 1024 == 0 {
                progress.report(1.0 - at as f32 / faces.len() as f32, "making color cubes");
                if progress.cancelled() {
                    return None;
                }
            }
            let is_composed = self.composes && !node.is_leaf();
            if is_composed {
                let of = |octant: usize, face: usize| node.child(octant).map(|child| faces[child.at()][face]);
                faces[at] = composed::<S::Vector>(|octant, face| of(octant, face).unwrap_or_default());
            }
            if is_composed && !measures {
                continue;
            }
            let (id, mut prims) = (NodeId(at as u32), tree.references(NodeId(at as u32)).to_vec());
            prims.sort_unstable();
            // Leaves below may share some, and light comes through each once.
            prims.dedup();
            let cell = tree.cell(id);
            if !is_composed {
                faces[at] = self.projected(&cell, &prims);
            }
            if measures {
                errors[at] = self.error(&cell, &prims, &faces[at]);
            }
        }
        Some(Baked { faces: faces.iter().map(CubeFaces::new).collect(), errors })
    }

    /// Faces of a cell from its primitives, of ascending ids.
    pub fn projected(&self, cell: &Aabb<S::Vector>, prims: &[PrimId]) -> Faces {
        if self.is_analytic {
            let faces = self.worked_out(cell, prims);
            return faces.unwrap_or_else(|| {
                Self { side: analytic::SIDE, is_analytic: false, ..*self }.projected(cell, prims)
            });
        }
        let mut faces = [[0.0; 4]; 6];
        for (face, samples) in faces.iter_mut().zip(self.samples(cell, prims)) {
            let sum =
                samples.iter().fold([0.0; 4], |sum: [f32; 4], c| std::array::from_fn(|k| sum[k] + c[k]));
            // Partial coverage is premultiplied: samples that show nothing count as black and clear.
            *face = sum.map(|c| c / samples.len() as f32);
        }
        faces
    }

    /// Faces of a cell by areas; `None` where that takes too long, or light comes through.
    fn worked_out(&self, cell: &Aabb<S::Vector>, prims: &[PrimId]) -> Option<Faces> {
        let lit: Vec<Lit<S>> = prims.iter().map(|&prim| self.lit(prim)).collect();
        if lit.iter().any(|one| one.through) {
            return None;
        }
        let mut faces = [[0.0; 4]; 6];
        for axis in 0..S::Vector::AXES {
            let surface = |one: &Lit<S>| {
                let outline = S::outline(&one.corners[..S::CORNERS], cell, axis)?;
                Some(Surface { outline, color: one.color, seen: one.seen_along(axis) })
            };
            let surfaces: Vec<Surface> = lit.iter().filter_map(surface).collect();
            faces[2 * axis..][..2].copy_from_slice(&analytic::both_faces(&surfaces)?);
        }
        Some(faces)
    }

    /// The samples of each face, row by row, of a cell with these primitives.
    pub fn samples(&self, cell: &Aabb<S::Vector>, prims: &[PrimId]) -> Vec<Vec<[f32; 4]>> {
        let count = S::sample_count(self.side);
        let lit: Vec<Lit<S>> = prims.iter().map(|&prim| self.lit(prim)).collect();
        let mut faces = Vec::new();
        // Both sides of an axis at a time: a sample of the one is a sample of the other.
        for axis in 0..S::Vector::AXES {
            let mut samples = vec![Sample::default(); 2 * count];
            for through in [false, true] {
                lit.iter().for_each(|one| self.see(cell, axis, one, through, &mut samples));
                if !self.surfaces.any_through(self.scene) {
                    break;
                }
            }
            faces.extend(samples.chunks(count).map(|face| face.iter().map(Sample::color).collect()));
        }
        faces
    }

    /// Draws a primitive of a cell into the samples of both faces of an axis, the lower face's first; those
    /// that light comes through last, over what the others left.
    fn see(&self, cell: &Aabb<S::Vector>, axis: usize, one: &Lit<S>, through: bool, samples: &mut [Sample]) {
        if one.through != through {
            return;
        }
        let [from_below, from_above] = one.seen_along(axis);
        let color = one.color;
        let (lower, upper) = samples.split_at_mut(samples.len() / 2);
        let size = f64::from(cell.size().get(axis));
        S::cover(&one.corners[..S::CORNERS], cell, axis, self.side, &mut |at, height| {
            if from_below {
                lower[at].put(height, color, through);
            }
            if from_above {
                upper[at].put(size - height, color, through);
            }
        });
    }
    /// A primitive as faces see it.
    fn lit(&self, prim: PrimId) -> Lit<S> {
        let scene = self.scene;
        let mut corners = [S::Vector::default(); 3];
        for (to, from) in corners.iter_mut().zip(scene.prim_points(prim)) {
            *to = from;
        }
        let light = fixed_light(scene, prim);
        let is_one_sided = self.surfaces.one_sided && !scene.is_two_sided(prim);
        Lit {
            corners,
            color: scene.color_of(prim).map(|c| c * light),
            through: self.surfaces.show_through(scene, prim),
            front: is_one_sided.then(|| scene.normal(prim)),
        }
    }

    /// How wrong a cell's cube is from between the axes, where no face was made: over all directions of which
    /// two components or more are not 0, the greatest difference of a channel between what its faces show, by
    /// their projected areas, and what is in the cell. (Along the axes the faces are what is in the cell, so
    /// an error measured there is nothing: Section 5.1 shows surfaces torn from 45°.)
    pub fn error(&self, cell: &Aabb<S::Vector>, prims: &[PrimId], faces: &Faces) -> f32 {
        let mut worst = 0.0_f32;
        let lit: Vec<Lit<S>> = prims.iter().map(|&prim| self.lit(prim)).collect();
        for number in 0..3usize.pow(S::Vector::AXES as u32) {
            let toward = S::Vector::from_fn(|a| (number / 3usize.pow(a as u32) % 3) as f32 - 1.0);
            let axes: Vec<usize> = (0..S::Vector::AXES).filter(|a| toward.get(*a) != 0.0).collect();
            if axes.len() < 2 {
                continue;
            }
            let mut off = [0.0; 4];
            for &axis in &axes {
                let cube = faces[2 * axis + usize::from(toward.get(axis) > 0.0)];
                let seen = self.seen_along(cell, &lit, toward, axis);
                // Components are alike, so are the areas of the faces.
                (0..4).for_each(|c| off[c] += (cube[c] - seen[c]) / axes.len() as f32);
            }
            worst = off.iter().fold(worst, |worst, c| worst.max(c.abs()));
        }
        worst
    }

    /// What is seen of a cell through its face on an axis, looking from a direction with components of 1, −1
    /// and 0: the cell is sheared until that is along the axis.
    fn seen_along(&self, cell: &Aabb<S::Vector>, lit: &[Lit<S>], toward: S::Vector, axis: usize) -> [f32; 4] {
        let mut samples = vec![Sample::default(); S::sample_count(self.side)];
        let (is_upper, size) = (toward.get(axis) > 0.0, cell.size());
        let depth = |height: f64| if is_upper { f64::from(size.get(axis)) - height } else { height };
        for through in [false, true] {
            for one in lit.iter().filter(|one| one.through == through && one.is_seen(toward)) {
                let sheared = one.corners.map(|p| {
                    let inward = depth(f64::from(p.get(axis) - cell.min.get(axis))) as f32;
                    S::Vector::from_fn(
                        |a| if a == axis { p.get(a) } else { p.get(a) + toward.get(a) * inward },
                    )
                });
                S::cover(&sheared[..S::CORNERS], cell, axis, self.side, &mut |at, height| {
                    // What the ray meets after it has left the cell by another side is not in it.
                    let inward = depth(height);
                    let is_inside = (1..S::Vector::AXES).all(|k| {
                        let a = (axis + k) % S::Vector::AXES;
                        let number = if k == 1 { at as u32 % self.side } else { at as u32 / self.side };
                        let extent = f64::from(size.get(a));
                        let place = (f64::from(number) + 0.5) / f64::from(self.side) * extent;
                        (0.0..=extent).contains(&(place - f64::from(toward.get(a)) * inward))
                    });
                    if is_inside {
                        samples[at].put(inward, one.color, through);
                    }
                });
            }
        }
        let sum = samples
            .iter()
            .map(Sample::color)
            .fold([0.0; 4], |sum: [f32; 4], c| std::array::from_fn(|k| sum[k] + c[k]));
        sum.map(|c| c / samples.len() as f32)
    }
}

/// A primitive as faces see it.
struct Lit<S: Space> {
    corners: [S::Vector; 3],
    /// Under the fixed light.
    color: [f32; 3],
    /// Whether light comes through it.
    through: bool,
    /// Where its front is, if it has no other side.
    front: Option<S::Vector>,
}

impl<S: Space> Lit<S> {
    /// Whether it is seen from a direction.
    fn is_seen(&self, toward: S::Vector) -> bool {
        self.front.is_none_or(|front| front.dot(toward) > 0.0)
    }
    /// Whether it is seen along an axis, from below and from above.
    fn seen_along(&self, axis: usize) -> [bool; 2] {
        [-1.0, 1.0].map(|sign| self.is_seen(S::Vector::from_fn(|a| if a == axis { sign } else { 0.0 })))
    }
}

/// What is seen at a sample of a face.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    /// The nearest to the face that hides what is behind: how far from it, and its color.
    nearest: Option<(f64, [f32; 3])>,
    /// How many it is seen through, and the sum of their colors.
    layers: u32,
    veil: [f32; 3],
}

impl Sample {
    fn put(&mut self, depth: f64, color: [f32; 3], through: bool) {
        // Of equally near ones the first stays, which is that of the lowest id, as in the z-buffer.
        let is_nearer = self.nearest.is_none_or(|(nearest, _)| depth < nearest);
        match through {
            false if is_nearer => self.nearest = Some((depth, color)),
            true if is_nearer => {
                self.layers += 1;
                (0..3).for_each(|c| self.veil[c] += color[c]);
            }
            _ => {}
        }
    }
    /// Premultiplied: each layer takes as much of a sample as where it is drawn as geometry.
    fn color(&self) -> [f32; 4] {
        let (color, alpha) = self.nearest.map_or(([0.0; 3], 0.0), |(_, color)| (color, 1.0));
        let through = (1.0 - VEIL).powi(self.layers as i32);
        let mean = self.veil.map(|sum| sum / self.layers.max(1) as f32);
        let mixed: [f32; 3] = std::array::from_fn(|c| color[c] * through + mean[c] * (1.0 - through));
        [mixed[0], mixed[1], mixed[2], alpha * through + (1.0 - through)]
    }
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
