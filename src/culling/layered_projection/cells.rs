//! The cells that space is divided into (Sections 3.1 and 4.3).
//!
//! All three ways begin with the vertices of the scene, as in Section 4.3: 1. an octree over them, whose
//! leaves are bounded in size; 2. its leaves as cells, or 3. the Delaunay triangulation of their perturbed
//! centers. The kD-tree, which Section 3.1 names without having tried it, takes the place of the octree.

use super::{CellKind, Params};
use crate::index::tessellation::{
    BoxCells, Cellular, Fineness, SimplexCells, Tessellation, vertex_kd_tree, vertex_octree,
};
use crate::scene::{Progress, Scene};

/// Cells of either shape.
#[derive(Clone, Debug)]
pub enum Cells<S: Cellular> {
    /// Of an octree or a kD-tree.
    Boxes(BoxCells<S::Vector>),
    /// Of a Delaunay triangulation.
    Simplices(SimplexCells<S>),
}

impl<S: Cellular> Cells<S> {
    /// Whatever they are.
    pub fn any(&self) -> &dyn Tessellation<S> {
        // Behind one interface, so that the traversal is written once (Section 4.2).
        match self {
            Self::Boxes(cells) => cells,
            Self::Simplices(cells) => cells,
        }
    }
    /// Divides the space of a scene. `None` when cancelled.
    pub fn build(scene: &Scene<S>, params: &Params, progress: &dyn Progress) -> Option<Self> {
        // Footnote 4 of Section 4.3: what is shorter than this share is a leaf. How many vertices a node
        // holds matters only if it holds none.
        let fineness = Fineness { leaf_share: params.leaf_size as f32 / 100.0, ..Fineness::default() };
        let cancelled = || progress.cancelled();
        match params.tessellation {
            CellKind::Octree => vertex_octree(scene, fineness, cancelled).map(Self::Boxes),
            CellKind::KdTree => vertex_kd_tree(scene, fineness, cancelled).map(Self::Boxes),
            CellKind::Delaunay => {
                // The same octree (Section 4.3), of which only the centers of the leaves go on.
                let boxes = vertex_octree(scene, fineness, cancelled)?;
                progress.report(0.5, "triangulating the cells' centers");
                SimplexCells::of_centers(&boxes, params.seed, &cancelled).map(Self::Simplices)
            }
        }
    }
}
