//! Cells that are simplices: the Delaunay triangulation of perturbed cell centers.
//!
//! Klosowski and Silva 2000, Section 4.3:
//!
//! 1. The centers of an octree's leaves, which lie on a lattice, are moved at random, by a seed.
//! 2. Their Delaunay triangulation makes the cells, with adjacency.
//!
//! Departure: the corners of the region are added, so that the cells cover the whole scene and not only the
//! convex hull of the centers; what reaches beyond that hull would belong to no cell.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::{Adjacency, BoxCells, Cellular, Exit, Neighbor, Tessellation, Tried};
use crate::geometry::{Aabb, Beside, CellId, Vector};

/// No neighbor.
pub(super) const NONE: u32 = u32::MAX;
/// A center is moved by at most this share of its cell's size along each axis. The paper gives no amount; at
/// an eighth it stays well inside its leaf.
const JITTER: f32 = 0.125;
/// A primitive that meets more cells than this is large beside them.
const MANY: usize = 64;
/// The vertices of the face opposite each vertex, so that the cell's inside is in front of the face.
const FACES: [[[usize; 3]; 4]; 2] =
    [[[1, 2, 0], [2, 0, 0], [0, 1, 0], [0, 0, 0]], [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]]];

/// A triangle (the first three entries) or a tetrahedron, positively oriented.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Simplex {
    /// Numbers of its points.
    pub vertices: [u32; 4],
    /// The simplex beyond the face opposite each vertex; [`u32::MAX`] if there is none.
    pub neighbors: [u32; 4],
}

/// Simplices that fill a convex region.
#[derive(Clone, Debug)]
pub struct SimplexCells<S: Cellular> {
    points: Vec<S::Vector>,
    cells: Vec<Simplex>,
    pub(super) adjacency: Adjacency<S::Vector>,
}

impl<S: Cellular> SimplexCells<S> {
    /// Corners of a simplex.
    const CORNERS: usize = S::Vector::AXES + 1;

    /// The Delaunay triangulation of the centers of boxes, moved at random. `None` when cancelled.
    pub fn of_centers(boxes: &BoxCells<S::Vector>, seed: u32, cancelled: &dyn Fn() -> bool) -> Option<Self> {
        let mut rng = Pcg32::new(seed.into(), 7);
        // 1. The corners of the region come first, and are not moved.
        let mut share = || ((rng.next_u32() >> 8) as f32 / (1u32 << 23) as f32 - 1.0) * JITTER;
        let mut points: Vec<S::Vector> = boxes.region().corners().collect();
        for cell in (0..Tessellation::<S>::count(boxes) as u32).map(CellId) {
            let size = Tessellation::<S>::bounds(boxes, cell).size();
            points
                .push(Tessellation::<S>::center(boxes, cell) + S::Vector::from_fn(|a| size.get(a) * share()));
        }
        // 2.
        let cells = S::triangulate(&points, cancelled)?;
        Some(Self::of(points, cells))
    }
    fn of(points: Vec<S::Vector>, cells: Vec<Simplex>) -> Self {
        let mut made =
            Self { points, cells, adjacency: Adjacency { starts: Vec::new(), neighbors: Vec::new() } };
        let mut pairs = Vec::with_capacity(made.cells.len() * Self::CORNERS);
        for (cell, simplex) in made.cells.iter().enumerate() {
            for face in (0..Self::CORNERS).filter(|f| simplex.neighbors[*f] != NONE) {
                // Face normals point inside, those of neighbors outside.
                let normal = -S::normal(&made.face(simplex, face)[..S::CORNERS]);
                let unit = normal * (1.0 / normal.length().max(f32::MIN_POSITIVE));
                pairs.push((
                    CellId(cell as u32),
                    Neighbor { cell: CellId(simplex.neighbors[face]), normal: unit },
                ));
            }
        }
        made.adjacency = Adjacency::new(made.cells.len(), pairs);
        made
    }
    /// Points and simplices, for [`SimplexCells::of_tables`].
    pub fn tables(&self) -> (&[S::Vector], &[Simplex]) {
        (&self.points, &self.cells)
    }
    /// The cells of [`SimplexCells::tables`]; `None` if they are not a triangulation's: numbers out of range,
    /// a cell that is not positive, faces that do not match.
    pub fn of_tables(points: Vec<S::Vector>, cells: Vec<Simplex>) -> Option<Self> {
        // Numbers first, since what follows uses them as places.
        let in_range = |c: &Simplex| {
            let corners = (0..Self::CORNERS).all(|i| (c.vertices[i] as usize) < points.len());
            corners
                && (0..Self::CORNERS)
                    .all(|i| c.neighbors[i] == NONE || (c.neighbors[i] as usize) < cells.len())
        };
        if cells.is_empty() || !points.iter().all(|p| p.is_finite()) || !cells.iter().all(in_range) {
            return None;
        }
        let made = Self { points, cells, adjacency: Adjacency { starts: Vec::new(), neighbors: Vec::new() } };
        // Every cell positive and every face matched: then walks from cell to cell stay in the tables.
        let sound = made.cells.iter().enumerate().all(|(cell, c)| {
            made.is_positive(c) && (0..Self::CORNERS).all(|f| made.matches(cell as u32, c, f))
        });
        sound.then(|| Self::of(made.points, made.cells))
    }
    fn is_positive(&self, cell: &Simplex) -> bool {
        let [face, last] =
            [self.face(cell, Self::CORNERS - 1), [self.points[cell.vertices[Self::CORNERS - 1] as usize]; 3]];
        S::side(&face[..S::CORNERS], last[0]) > 0.0
    }
    /// Whether the neighbor across a face has that face too, and knows its neighbor.
    fn matches(&self, cell: u32, simplex: &Simplex, face: usize) -> bool {
        let Some(other) = self.cells.get(simplex.neighbors[face] as usize) else { return true };
        let Some(back) = (0..Self::CORNERS).find(|k| other.neighbors[*k] == cell) else { return false };
        // As sets: the two cells name the corners of their common face in different orders.
        let others = |s: &Simplex, without: usize| {
            let mut list: Vec<u32> =
                (0..Self::CORNERS).filter(|k| *k != without).map(|k| s.vertices[k]).collect();
            list.sort_unstable();
            list
        };
        others(simplex, face) == others(other, back)
    }

    /// The corners of a face, of which the first `S::CORNERS` count.
    #[inline]
    fn face(&self, cell: &Simplex, face: usize) -> [S::Vector; 3] {
        FACES[S::Vector::AXES - 2][face].map(|k| self.points[cell.vertices[k] as usize])
    }
    /// The exact sign of the side of a face on which a point lies; positive inside.
    #[inline]
    fn side(&self, cell: &Simplex, face: usize, point: S::Vector) -> f64 {
        S::side(&self.face(cell, face)[..S::CORNERS], point)
    }
    /// Whether a primitive meets a cell, if where its corners lie says so. Each corner is looked at once for
    /// a primitive, and has some twenty cells.
    fn told_by_corners(&self, prim: &[S::Vector], cell: CellId, tried: &mut Tried) -> Option<bool> {
        tried.beside.resize(self.points.len(), Default::default());
        let number = tried.number;
        let vertices = self.cells[cell.at()].vertices;
        Beside::meet(vertices[..Self::CORNERS].iter().map(|&vertex| {
            let known = &mut tried.beside[vertex as usize];
            if known.0 != number {
                *known = (number, S::beside(prim, self.points[vertex as usize]));
            }
            known.1
        }))
    }
    #[inline]
    pub(super) fn corners(&self, cell: CellId) -> [S::Vector; 4] {
        let vertices = self.cells[cell.at()].vertices;
        std::array::from_fn(|k| self.points[vertices[if k < Self::CORNERS { k } else { 0 }] as usize])
    }
}

/// The mean of a simplex's corners.
#[inline]
fn middle<S: Cellular>(corners: &[S::Vector; 4]) -> S::Vector {
    let count = S::Vector::AXES + 1;
    corners[..count].iter().fold(S::Vector::default(), |sum, p| sum + *p * (1.0 / count as f32))
}

impl<S: Cellular> Tessellation<S> for SimplexCells<S> {
    fn count(&self) -> usize {
        self.cells.len()
    }
    fn bounds(&self, cell: CellId) -> Aabb<S::Vector> {
        Aabb::of(self.corners(cell))
    }
    fn center(&self, cell: CellId) -> S::Vector {
        middle::<S>(&self.corners(cell))
    }
    fn contains(&self, cell: CellId, point: S::Vector) -> bool {
        let simplex = &self.cells[cell.at()];
        // Exact signs, so that a point lies in some cell, and in two only on a face.
        (0..Self::CORNERS).all(|face| self.side(simplex, face, point) >= 0.0)
    }
    fn neighbors(&self, cell: CellId) -> &[Neighbor<S::Vector>] {
        self.adjacency.of(cell)
    }
    /// Walks through faces that have the point beyond them. This ends in a Delaunay triangulation; others
    /// come from damaged files only, and there the number of steps ends it.
    fn locate(&self, point: S::Vector, near: CellId) -> Option<CellId> {
        let mut at = near;
        // No such walk visits a cell twice.
        for _ in 0..=self.cells.len() {
            let simplex = &self.cells[at.at()];
            let Some(face) = (0..Self::CORNERS).find(|face| self.side(simplex, *face, point) < 0.0) else {
                return Some(at);
            };
            if simplex.neighbors[face] == NONE {
                return None;
            }
            at = CellId(simplex.neighbors[face]);
        }
        None
    }
    fn exit(&self, from: CellId, point: S::Vector) -> Exit {
        let corners = self.corners(from);
        let center = middle::<S>(&corners);
        let way = point - center;
        // When the way meets the plane of each face; parts of 1.
        let (mut first, mut through) = (f32::INFINITY, NONE);
        for (face, [a, b, c]) in FACES[S::Vector::AXES - 2].into_iter().enumerate().take(Self::CORNERS) {
            let inward = S::normal(&[corners[a], corners[b], corners[c]][..S::CORNERS]);
            let speed = -inward.dot(way);
            let at = if speed > 0.0 { inward.dot(center - corners[a]) / speed } else { f32::INFINITY };
            if at < first {
                (first, through) = (at, self.cells[from.at()].neighbors[face]);
            }
        }
        match through {
            _ if first >= 1.0 => Exit::Ends,
            NONE => Exit::Out,
            cell => Exit::Into(CellId(cell)),
        }
    }
    fn meeting(&self, prim: &[S::Vector], near: CellId, tried: &mut Tried, to: &mut Vec<CellId>) {
        let start = to.len();
        tried.begin(self.cells.len());
        let first = self.locate(prim[0], near).unwrap_or(near);
        tried.add(first);
        to.push(first);
        // The cells that meet a connected set hang together by faces: breadth first, the list is the queue.
        let mut seen = start;
        while seen < to.len() {
            let at = to[seen];
            // Read once for all faces: with many cells most of the time goes into fetching corners.
            let (corners, neighbors) = (self.corners(at), self.cells[at.at()].neighbors);
            for face in (0..Self::CORNERS).filter(|f| neighbors[*f] != NONE) {
                let next = CellId(neighbors[face]);
                // In the order of cost: tried already, some corner at or beyond the face, the separating
                // axes. Those say the same whichever face a cell is reached by, so it is tried once, met or
                // not. Of a primitive that meets many cells some corner is beyond nearly every face.
                if tried.has(next) {
                    continue;
                }
                let sides = FACES[S::Vector::AXES - 2][face].map(|k| corners[k]);
                let reaches = |p: &S::Vector| S::side(&sides[..S::CORNERS], *p) <= 0.0;
                let is_large = seen - start >= MANY;
                if is_large || prim.iter().any(reaches) {
                    tried.add(next);
                    let told = if is_large { self.told_by_corners(prim, next, tried) } else { None };
                    if told.unwrap_or_else(|| S::meets_simplex(prim, &self.corners(next))) {
                        to.push(next);
                    }
                }
            }
            seen += 1;
        }
    }
    fn edges(&self, cell: CellId) -> Vec<[S::Vector; 2]> {
        let corners = self.corners(cell);
        if S::Vector::AXES == 2 {
            return (0..3).map(|i| [corners[i], corners[(i + 1) % 3]]).collect();
        }
        (0..4).flat_map(|i| (i + 1..4).map(move |k| [corners[i], corners[k]])).collect()
    }
    fn bytes(&self) -> usize {
        self.points.len() * size_of::<S::Vector>()
            + self.cells.len() * size_of::<Simplex>()
            + self.adjacency.bytes()
    }
}
