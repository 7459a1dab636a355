//! Incremental construction: walk to the new point, dig out what its arrival refutes, fill the cavity with a
//! star.
//!
//! Bowyer and Watson 1981, in these steps:
//!
//! 1. The first points that span space make a tetrahedron; the space outside it is filled with tetrahedra
//!    that share a vertex at infinity, so that no case is special ([`Builder::first_cells`]).
//! 2. For each further point, in the order of [`super::order`]:
//! 3. walk from the last new cell to one whose sphere holds the point ([`Builder::locate`]); a point that is
//!    a vertex already is left out;
//! 4. dig: collect all cells whose spheres hold it, which hang together, and the faces around this cavity
//!    ([`Builder::dig`]);
//! 5. fill: put a cell between the point and each of those faces, in the places of the old cells first
//!    ([`Builder::fill`]);
//! 6. link: new cells that share an edge of the cavity's surface are neighbors ([`Builder::link`]).
//!
//! A point that lies exactly on a sphere does not refute it: each point is lifted by an infinitesimal amount,
//! far larger than those of all earlier points (Devillers and Teillaud, "Perturbations and Vertex Removal in
//! a 3D Delaunay Triangulation", SODA 2003), so the result is that of points in general position, and no
//! tetrahedron is flat.

use super::sign::Signs;
use super::{FACES, NONE};

/// The vertex at infinity.
const INFINITY: u32 = u32::MAX;
/// Points from one check for cancellation to the next.
const PATIENCE: u32 = 4096;

/// A tetrahedron while it is built. It is positive: vertex 3 lies where the first three are seen
/// counter-clockwise.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub struct Cell {
    pub vertices: [u32; 4],
    /// The face on the other side of the face opposite each vertex.
    pub across: [Side; 4],
}

/// A face of a cell, seen from that cell.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Side(u32);

impl Side {
    const NOWHERE: Self = Self(NONE);
    fn new(cell: u32, face: usize) -> Self {
        Self(cell << 2 | face as u32)
    }
    pub fn cell(self) -> u32 {
        self.0 >> 2
    }
    pub fn face(self) -> usize {
        (self.0 & 3) as usize
    }
}

impl Cell {
    /// The vertices of a face, counter-clockwise seen from the vertex opposite.
    #[inline]
    fn face(&self, face: usize) -> [u32; 3] {
        FACES[face].map(|k| self.vertices[k])
    }
    /// Which vertex is at infinity.
    #[inline]
    pub fn infinite(&self) -> Option<usize> {
        self.vertices.iter().position(|v| *v == INFINITY)
    }
    /// Whether it was dug out and its place not taken again.
    pub fn is_dead(&self) -> bool {
        self.vertices[0] == self.vertices[1]
    }
}

/// The triangulation of the points inserted so far.
pub struct Builder {
    signs: Signs,
    pub cells: Vec<Cell>,
    /// Pairs of a point that was left out and the vertex at the same place.
    pub duplicates: Vec<[u32; 2]>,
    /// What is known about each cell and the current point: `2 · turn` refuted, `2 · turn + 1` not.
    marks: Vec<u32>,
    turn: u32,
    /// Where the last walk ended.
    last: u32,
    unused: Vec<u32>,
    /// The refuted cells, and the sides of the cavity seen from without.
    cavity: Vec<u32>,
    walls: Vec<Side>,
    edges: Edges,
}

impl Builder {
    /// Inserts all points in their order; no cells if all lie in a plane. `None` when cancelled.
    pub fn triangulate(signs: Signs, cancelled: impl Fn() -> bool) -> Option<Self> {
        let count = signs.count() as u32;
        let mut builder = Self {
            signs,
            // A random point set has about 6.7 tetrahedra a point.
            cells: Vec::with_capacity(7 * count as usize),
            duplicates: Vec::new(),
            marks: Vec::with_capacity(7 * count as usize),
            turn: 0,
            last: 0,
            unused: Vec::new(),
            cavity: Vec::new(),
            walls: Vec::new(),
            edges: Edges::new(),
        };
        let Some(first) = builder.first_cells() else { return Some(builder) };
        // 2. The points stand in their order.
        for vertex in (0..count).filter(|v| !first.contains(v)) {
            if vertex.is_multiple_of(PATIENCE) && cancelled() {
                return None;
            }
            builder.insert(vertex);
        }
        Some(builder)
    }

    /// A positive tetrahedron of the first points that span space, and the infinite ones around it.
    fn first_cells(&mut self) -> Option<[u32; 4]> {
        let point = |v: u32| self.signs.point(v);
        let others = 1..self.signs.count() as u32;
        // 1. The first point that differs from point 0, the first off their line, the first off their plane.
        let b = others.clone().find(|&v| point(v) != point(0))?;
        // Three points are collinear if they are so seen along every axis.
        let turns = |v: &u32| {
            let along = |i: usize, j: usize| {
                let [p, q, r] = [0, b, *v].map(|v| glam::DVec2::new(point(v)[i], point(v)[j]));
                crate::geometry::orient2d(p, q, r) != 0.0
            };
            along(0, 1) || along(1, 2) || along(2, 0)
        };
        let c = others.clone().find(turns)?;
        let d = others.clone().find(|&v| self.signs.orient([0, b, c], v) != 0.0)?;
        let first = if self.signs.orient([0, b, c], d) > 0.0 { [0, b, c, d] } else { [0, c, b, d] };
        // Positive. Beyond each face lies the infinite cell of that face, which has it as its face 3.
        let inner = Cell { vertices: first, across: [0, 1, 2, 3].map(|face| Side::new(face + 1, 3)) };
        self.cells.push(inner);
        for face in 0..4 {
            let [p, q, r] = inner.face(face);
            self.cells.push(Cell {
                // The face seen from the other side, so two of its vertices change places.
                vertices: [p, r, q, INFINITY],
                across: [Side::NOWHERE, Side::NOWHERE, Side::NOWHERE, Side::new(0, face)],
            });
        }
        self.marks.resize(5, 0);
        // The four infinite cells are neighbors by the six edges, each met twice.
        self.edges.clear(12);
        (1..5).for_each(|cell| self.link(cell));
        Some(first)
    }

    /// A cell whose sphere the point lies in: the one that holds it, or an infinite one whose face it sees.
    fn locate(&self, vertex: u32) -> u32 {
        // 3. From the last new cell, or the finite one beside it: the order makes successive points near.
        let start = &self.cells[self.last as usize];
        let (mut at, mut from) = (start.infinite().map_or(self.last, |i| start.across[i].cell()), 4);
        // Through a face that has the point beyond it, never back through the one just passed (`from`; 4 is
        // none). This ends: in a Delaunay triangulation the cells along such a walk come nearer and nearer
        // (Edelsbrunner 1990).
        loop {
            let cell = &self.cells[at as usize];
            if cell.infinite().is_some() {
                return at;
            }
            let beyond = |face: &usize| *face != from && self.signs.orient(cell.face(*face), vertex) < 0.0;
            let Some(face) = (0..4).find(beyond) else { return at };
            (at, from) = (cell.across[face].cell(), cell.across[face].face());
        }
    }

    /// Whether the sphere of a cell holds the point, which no Delaunay cell's does.
    #[inline]
    fn refutes(&self, vertex: u32, cell: u32) -> bool {
        let cell = &self.cells[cell as usize];
        let Some(infinite) = cell.infinite() else { return self.signs.insphere(cell.vertices, vertex) > 0.0 };
        // The sphere of an infinite cell is the half-space beyond its face, and in the face's plane the
        // circle around it.
        let side = self.signs.orient(cell.face(infinite), vertex);
        if side != 0.0 {
            return side > 0.0;
        }
        let inner = &self.cells[cell.across[infinite].cell() as usize];
        self.signs.insphere(inner.vertices, vertex) > 0.0
    }

    fn insert(&mut self, vertex: u32) {
        // 3. A vertex at the same place would be one of the located cell's.
        let start = self.locate(vertex);
        let point = self.signs.point(vertex);
        let same = |v: &u32| *v != INFINITY && self.signs.point(*v) == point;
        if let Some(&kept) = self.cells[start as usize].vertices.iter().find(|v| same(v)) {
            self.duplicates.push([vertex, kept]);
            return;
        }
        self.dig(vertex, start);
        self.fill(vertex);
    }

    /// Collects the refuted cells, which hang together, and the walls around them.
    fn dig(&mut self, vertex: u32, start: u32) {
        // 4. Marks of earlier turns are smaller than those of this one, so nothing is reset from point to
        // point.
        self.turn += 1;
        let (refuted, kept) = (2 * self.turn, 2 * self.turn + 1);
        self.cavity.clear();
        self.walls.clear();
        self.marks[start as usize] = refuted;
        self.cavity.push(start);
        let mut seen = 0;
        // Breadth first: the list of the cavity is the queue. Each cell is tested once.
        while let Some(&cell) = self.cavity.get(seen) {
            seen += 1;
            for side in self.cells[cell as usize].across {
                let next = side.cell();
                let mut mark = self.marks[next as usize];
                if mark < refuted {
                    mark = if self.refutes(vertex, next) { refuted } else { kept };
                    self.marks[next as usize] = mark;
                    if mark == refuted {
                        self.cavity.push(next);
                    }
                }
                // A face between a refuted and a kept cell is a wall.
                if mark == kept {
                    self.walls.push(side);
                }
            }
        }
    }

    /// Puts a cell between the point and each wall of the cavity.
    fn fill(&mut self, vertex: u32) {
        // 5. Three edges a wall; each is met by the two walls that share it.
        self.edges.clear(3 * self.walls.len());
        self.unused.append(&mut self.cavity);
        for i in 0..self.walls.len() {
            let wall = self.walls[i];
            let [p, q, r] = self.cells[wall.cell() as usize].face(wall.face());
            // Opposite the new point (vertex 3) lies the cell behind the wall.
            let cell = Cell {
                vertices: [p, r, q, vertex],
                across: [Side::NOWHERE, Side::NOWHERE, Side::NOWHERE, wall],
            };
            let at = match self.unused.pop() {
                Some(at) => {
                    self.cells[at as usize] = cell;
                    at
                }
                None => {
                    self.cells.push(cell);
                    self.marks.push(0);
                    self.cells.len() as u32 - 1
                }
            };
            // The kept cell's neighbor across the wall was refuted; the new cell takes its place.
            self.cells[wall.cell() as usize].across[wall.face()] = Side::new(at, 3);
            self.link(at);
            self.last = at;
        }
        // A cavity may have fewer walls than cells: what is left over is dead until a later point needs it.
        for &at in &self.unused {
            self.cells[at as usize].vertices = [INFINITY; 4];
        }
    }

    /// Joins the first three faces of a new cell to those of other new cells, which share an edge of a wall
    /// with it.
    #[inline]
    fn link(&mut self, at: u32) {
        // 6. Faces 0 to 2 hold the new point; each is known by its edge in the wall.
        let [p, q, r, _] = self.cells[at as usize].vertices;
        for (face, edge) in [[q, r], [r, p], [p, q]].into_iter().enumerate() {
            let side = Side::new(at, face);
            if let Some(other) = self.edges.meet(edge, side) {
                self.cells[at as usize].across[face] = other;
                self.cells[other.cell() as usize].across[other.face()] = side;
            }
        }
    }
}

/// The edges of the walls, each of which is met twice. An open hash table that is cleared by a new stamp.
struct Edges {
    slots: Vec<Slot>,
    stamp: u32,
}

#[derive(Clone, Copy)]
struct Slot {
    stamp: u32,
    edge: [u32; 2],
    side: Side,
}

impl Edges {
    fn new() -> Self {
        Self { slots: Vec::new(), stamp: 0 }
    }
    /// Forgets all edges and makes room for this many.
    fn clear(&mut self, edges: usize) {
        // At least twice as many slots as edges, so that probes stay short.
        self.stamp += 1;
        if self.slots.len() < 2 * edges {
            let empty = Slot { stamp: 0, edge: [0; 2], side: Side::NOWHERE };
            self.slots = vec![empty; (2 * edges).next_power_of_two().max(256)];
        }
    }
    /// The side that met this edge before; remembers this side if none did.
    #[inline]
    fn meet(&mut self, [a, b]: [u32; 2], side: Side) -> Option<Side> {
        // Both walls name the edge, in opposite directions.
        let edge = [a.min(b), a.max(b)];
        let mask = self.slots.len() - 1;
        // Multiplication by 2⁶⁴ over the golden ratio (Knuth) mixes upwards, so the high bits choose the
        // slot.
        let mixed = (u64::from(edge[0]) << 32 | u64::from(edge[1])).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut at = (mixed >> 40) as usize & mask;
        loop {
            let slot = &mut self.slots[at];
            // A slot of an earlier stamp is as good as empty.
            if slot.stamp != self.stamp {
                *slot = Slot { stamp: self.stamp, edge, side };
                return None;
            }
            if slot.edge == edge {
                return Some(slot.side);
            }
            at = (at + 1) & mask;
        }
    }
}
