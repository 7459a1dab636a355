//! Delaunay triangulation of points in space, with adjacency.
//!
//! Klosowski and Silva 2000, Section 4.3, tessellate space by it. Points are inserted one by one ([`build`])
//! in an order that makes the walk to each short ([`order`]); every decision is exact ([`sign`]). Degenerate
//! input is no special case: points on one sphere are told apart by a symbolic perturbation, a point that is
//! there already is left out and named, and points in one plane have no tetrahedra. In the plane the crate
//! `spade` does the same. Cost: expected O(n log n) for points as scenes have them, 32 bytes a tetrahedron,
//! about 6.7 tetrahedra a point.

mod build;
mod order;
mod sign;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use self::build::{Builder, Cell};
use self::sign::Signs;

/// No tetrahedron: what lies beyond a face of the convex hull.
const NONE: u32 = u32::MAX;

/// The vertices of the face opposite each vertex, counter-clockwise seen from that vertex.
const FACES: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// A tetrahedron. It is positive: the last vertex lies where the first three are seen counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tetrahedron {
    /// Numbers of its vertices among the points.
    pub vertices: [u32; 4],
    neighbors: [u32; 4],
}

impl Tetrahedron {
    /// The tetrahedron beyond the face opposite vertex `face < 4`; `None` on the convex hull.
    #[inline]
    pub fn neighbor(&self, face: usize) -> Option<u32> {
        Some(self.neighbors[face]).filter(|n| *n != NONE)
    }
    /// The vertices of the face opposite vertex `face < 4`, counter-clockwise seen from within.
    #[inline]
    pub fn face(&self, face: usize) -> [u32; 3] {
        FACES[face].map(|k| self.vertices[k])
    }
}

/// A frozen Delaunay triangulation.
#[derive(Clone, Debug)]
pub struct Delaunay {
    points: Vec<Vec3>,
    tetrahedra: Vec<Tetrahedron>,
    duplicates: Vec<[u32; 2]>,
}

impl Delaunay {
    /// Triangulates finite points; none of them need be distinct. `None` when cancelled.
    pub fn new(points: Vec<Vec3>, cancelled: impl Fn() -> bool) -> Option<Self> {
        let wide: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
        // 1. Points are numbered anew in the order of insertion, so that the builder counts upwards.
        let order = order::insertion_order(&wide);
        let sorted = order.iter().map(|&i| wide[i as usize]).collect();
        // 2. Cells over all of space, those at infinity included.
        let built = Builder::triangulate(Signs::new(sorted), cancelled)?;
        // 3. Back to the numbers of the points as given, without infinity.
        let duplicates = built.duplicates.iter().map(|pair| pair.map(|v| order[v as usize])).collect();
        Some(Self { points, tetrahedra: finite(&built.cells, &order), duplicates })
    }

    /// The points as given.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }
    /// The tetrahedra; none if all points lie in one plane.
    pub fn tetrahedra(&self) -> &[Tetrahedron] {
        &self.tetrahedra
    }
    /// Points that were left out, each with the point at the same place that stands for it.
    pub fn duplicates(&self) -> &[[u32; 2]] {
        &self.duplicates
    }
}

/// The cells without those at infinity, with the points' own numbers.
fn finite(cells: &[Cell], order: &[u32]) -> Vec<Tetrahedron> {
    // Finite cells are numbered in their order; `NONE` stays for those at infinity, and so names what lies
    // beyond the hull.
    let mut numbers = vec![NONE; cells.len()];
    let kept = numbers.iter_mut().zip(cells).filter(|(_, c)| !c.is_dead() && c.infinite().is_none());
    kept.enumerate().for_each(|(count, (number, _))| *number = count as u32);
    let alive = cells.iter().zip(&numbers).filter(|(_, n)| **n != NONE);
    let made = |cell: &Cell| Tetrahedron {
        vertices: cell.vertices.map(|v| order[v as usize]),
        neighbors: cell.across.map(|side| numbers[side.cell() as usize]),
    };
    alive.map(|(cell, _)| made(cell)).collect()
}
