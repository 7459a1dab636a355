//! The faces of color cubes: what is seen of a cell through each of its sides (Section 4).
//!
//! 1. A leaf's faces are its primitives, clipped to the cell, as they look along the axes: a small image,
//!    4×4 samples unless said otherwise, whose mean is the color, premultiplied by what is covered.
//! 2. An inner cell's faces are composed of its children's, column by column: the front one over the back one;
//!    the mean of the columns is the face (Figure 3). A child that holds nothing is clear. Or they are made as
//!    a leaf's.
//!
//! Colors are linear, under light that is fixed in the world: what the paper bakes cannot depend on the eye.

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
    /// Whether those of inner cells are composed of their children's.
    pub composes: bool,
}

impl<S: Projected> Baking<'_, S> {
    /// The faces of all cells of a tree; `None` when cancelled.
    pub fn bake(&self, tree: &CellTree<S::Vector>, progress: &dyn Progress) -> Option<Vec<CubeFaces>> {
        let mut faces: Vec<Faces> = vec![[[0.0; 4]; 6]; tree.nodes().len()];
        // Post-order: children have higher numbers. From unrounded values, so that nothing adds up.
        for (at, node) in tree.nodes().iter().enumerate().rev() {
            if at % 1024 == 0 {
                progress.report(1.0 - at as f32 / faces.len() as f32, "making color cubes");
                if progress.cancelled() {
                    return None;
                }
            }
            faces[at] = if self.composes && !node.is_leaf() {
                let of = |octant: usize, face: usize| node.child(octant).map(|child| faces[child.at()][face]);
                composed::<S::Vector>(|octant, face| of(octant, face).unwrap_or_default())
            } else {
                let mut prims = tree.references(NodeId(at as u32)).to_vec();
                if !node.is_leaf() {
                    // Leaves may share some, and light comes through each once.
                    prims.sort_unstable();
                    prims.dedup();
                }
                self.projected(&tree.cell(NodeId(at as u32)), &prims)
            };
        }
        Some(faces.iter().map(CubeFaces::new).collect())
    }

    /// Faces of a cell from its primitives, of ascending ids.
    pub fn projected(&self, cell: &Aabb<S::Vector>, prims: &[PrimId]) -> Faces {
        let mut faces = [[0.0; 4]; 6];
        for (face, samples) in faces.iter_mut().zip(self.samples(cell, prims)) {
            let sum =
                samples.iter().fold([0.0; 4], |sum: [f32; 4], c| std::array::from_fn(|k| sum[k] + c[k]));
            // Partial coverage is premultiplied: samples that show nothing count as black and clear.
            *face = sum.map(|c| c / samples.len() as f32);
        }
        faces
    }

    /// The samples of each face, row by row, of a cell with these primitives.
    pub fn samples(&self, cell: &Aabb<S::Vector>, prims: &[PrimId]) -> Vec<Vec<[f32; 4]>> {
        let count = S::sample_count(self.side);
        let mut faces = Vec::new();
        // Both sides of an axis at a time: a sample of the one is a sample of the other.
        for axis in 0..S::Vector::AXES {
            let mut samples = vec![Sample::default(); 2 * count];
            for through in [false, true] {
                prims.iter().for_each(|&p| self.see(cell, axis, p, through, &mut samples));
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
    fn see(&self, cell: &Aabb<S::Vector>, axis: usize, prim: PrimId, through: bool, samples: &mut [Sample]) {
        if self.surfaces.show_through(self.scene, prim) != through {
            return;
        }
        let mut corners = [S::Vector::default(); 3];
        for (to, from) in corners.iter_mut().zip(self.scene.prim_points(prim)) {
            *to = from;
        }
        let light = fixed_light(self.scene, prim);
        let color = self.scene.color_of(prim).map(|c| c * light);
        // From a face, what has its front toward that side is seen.
        let front = self.scene.normal(prim).get(axis);
        let is_seen =
            |sign: f32| !self.surfaces.one_sided || self.scene.is_two_sided(prim) || front * sign > 0.0;
        let (from_below, from_above) = (is_seen(-1.0), is_seen(1.0));
        let (lower, upper) = samples.split_at_mut(samples.len() / 2);
        let size = f64::from(cell.size().get(axis));
        S::cover(&corners[..S::CORNERS], cell, axis, self.side, &mut |at, height| {
            if from_below {
                lower[at].put(height, color, through);
            }
            if from_above {
                upper[at].put(size - height, color, through);
            }
        });
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
