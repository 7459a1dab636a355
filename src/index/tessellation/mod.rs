//! Space divided into convex cells, so that one can walk from cell to cell.
//!
//! Klosowski and Silva 2000, Sections 3.1 and 4.3: large cells where little is, small ones where much is, in
//! three ways: the leaves of an octree over the scene's vertices ([`vertex_octree`]), the Delaunay
//! triangulation of their perturbed centers ([`SimplexCells`]), and the leaves of a kD-tree, which the paper
//! names ([`vertex_kd_tree`]). Quadtree and triangles in flatland. Primitives are assigned to every cell that
//! they meet ([`Assignment`]). Cells are closed, cover the scene's bounds and overlap in their boundaries
//! only.

mod assignment;
mod boxes;
mod simplices;
mod space;
#[cfg(test)]
mod tests;
mod vertex_kd_tree;
mod vertex_octree;

pub use assignment::Assignment;
pub use boxes::BoxCells;
pub use simplices::{Simplex, SimplexCells};
pub use space::Cellular;
pub use vertex_kd_tree::vertex_kd_tree;
pub use vertex_octree::vertex_octree;

use crate::geometry::{Aabb, Beside, CellId, Space, Vector};
use crate::scene::Scene;

/// The other side of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor<V> {
    /// The cell there.
    pub cell: CellId,
    /// Unit normal of the shared face, toward that cell.
    pub normal: V,
}

/// How a straight way leaves a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// It does not: it ends inside.
    Ends,
    /// Through the face that the cell shares with this one.
    Into(CellId),
    /// Out of the region.
    Out,
}

/// Convex cells that tile a region.
pub trait Tessellation<S: Space>: Send + Sync {
    /// Number of cells, at least 1.
    fn count(&self) -> usize;
    /// Bounds of a cell.
    fn bounds(&self, cell: CellId) -> Aabb<S::Vector>;
    /// A point inside a cell.
    fn center(&self, cell: CellId) -> S::Vector;
    /// Whether a point lies in a cell or on its boundary.
    fn contains(&self, cell: CellId, point: S::Vector) -> bool;
    /// The cells that share a face with a cell, or part of one, by ascending id.
    fn neighbors(&self, cell: CellId) -> &[Neighbor<S::Vector>];
    /// A cell that contains a point, searched from the cell `near`; `None` outside of all.
    fn locate(&self, point: S::Vector, near: CellId) -> Option<CellId>;
    /// How the straight way from the center of a cell to a point leaves the cell. Through an edge it leaves
    /// into one of the neighbors there, always the same.
    fn exit(&self, from: CellId, point: S::Vector) -> Exit;
    /// Adds the cells that a primitive meets, at least one, searched from the cell `near`. The primitive lies
    /// in the region. O(cells met and their neighbors).
    fn meeting(&self, prim: &[S::Vector], near: CellId, tried: &mut Tried, to: &mut Vec<CellId>);
    /// The edges of a cell; those of a triangle run around it.
    fn edges(&self, cell: CellId) -> Vec<[S::Vector; 2]>;
    /// Bytes that it takes.
    fn bytes(&self) -> usize;
}

/// The cells that were tried for the primitive at hand.
#[derive(Clone, Debug, Default)]
pub struct Tried {
    /// For each cell the number of the last primitive that it was tried for.
    // Numbers and not flags: the next primitive begins without clearing the table, which is as long as all
    // cells, and looking a cell up takes the same time however many the primitive meets.
    last: Vec<u32>,
    number: u32,
    /// Where each corner of cells lies in regard to the primitive, with the primitive's number.
    beside: Vec<(u32, Beside)>,
}

impl Tried {
    /// Begins with another primitive, of so many cells.
    fn begin(&mut self, cells: usize) {
        if self.last.len() != cells || self.number == u32::MAX {
            self.beside.clear();
            self.last.clear();
            self.last.resize(cells, 0);
            self.number = 0;
        }
        self.number += 1;
    }
    #[inline]
    fn has(&self, cell: CellId) -> bool {
        self.last[cell.at()] == self.number
    }
    #[inline]
    fn add(&mut self, cell: CellId) {
        self.last[cell.at()] = self.number;
    }
}

/// The neighbors of all cells, one list after the other.
#[derive(Clone, Debug)]
struct Adjacency<V> {
    starts: Vec<u32>,
    neighbors: Vec<Neighbor<V>>,
}

impl<V: Vector> Adjacency<V> {
    /// Sorts pairs of a cell and a neighbor of it into lists for `count` cells.
    fn new(count: usize, mut pairs: Vec<(CellId, Neighbor<V>)>) -> Self {
        // By cell, then by neighbor: no two pairs are equal, so the order is one.
        pairs.sort_unstable_by_key(|(cell, n)| (*cell, n.cell));
        let mut starts = vec![0; count + 1];
        pairs.iter().for_each(|(cell, _)| starts[cell.at() + 1] += 1);
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        Self { starts, neighbors: pairs.into_iter().map(|(_, n)| n).collect() }
    }
    #[inline]
    fn of(&self, cell: CellId) -> &[Neighbor<V>] {
        &self.neighbors[self.starts[cell.at()] as usize..self.starts[cell.at() + 1] as usize]
    }
    fn bytes(&self) -> usize {
        self.starts.len() * 4 + self.neighbors.len() * size_of::<Neighbor<V>>()
    }
}

/// How fine a tessellation is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// A cell whose longest side is shorter than this share of the scene's longest side is not divided.
    pub leaf_share: f32,
    /// A cell of no more vertices than this is not divided.
    pub leaf_vertices: u32,
}

impl Default for Fineness {
    fn default() -> Self {
        // Section 4.3, footnote 4: a node with a side shorter than 5 % of the scene's longest is a leaf. The
        // number of vertices is not limited there.
        Self { leaf_share: 0.05, leaf_vertices: 0 }
    }
}

/// The points that live primitives use, in the order of their numbers.
fn vertices<S: Space>(scene: &Scene<S>) -> Vec<S::Vector> {
    // Welding and dropped primitives can leave points that nothing uses; they would refine cells for nothing.
    let mut used = vec![false; scene.points().len()];
    let corners = scene.live().iter().filter_map(|&p| scene.corners(p));
    corners.for_each(|c| c.as_ref().iter().for_each(|i| used[*i as usize] = true));
    scene.points().iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| *p).collect()
}

/// The cube (square in flatland) around the scene that tessellations fill, a little larger than its longest
/// side.
fn region<S: Space>(scene: &Scene<S>) -> Aabb<S::Vector> {
    /// So much larger that its sides stay apart from the scene's by more than rounding.
    const SLACK: f32 = 1.0 / 1024.0;
    let bounds = scene.bounds();
    let center = bounds.center();
    let longest = (0..S::Vector::AXES).map(|a| bounds.size().get(a)).fold(0.0, f32::max);
    let far = (0..S::Vector::AXES).map(|a| center.get(a).abs()).fold(0.0, f32::max);
    // The largest of three: the scene's half side; a share of its distance from the origin, for below that
    // f32 would not tell the sides apart; a number that is not 0.
    let half = S::Vector::splat((longest * (0.5 + SLACK)).max(far * SLACK).max(f32::MIN_POSITIVE / SLACK));
    Aabb { min: center - half, max: center + half }
}
