//! The plan of the city: a slightly crooked grid of streets, and rings of houses around the yards of its
//! blocks.
//!
//! Cells of a grid whose nodes are moved a little; each is drawn in by half a street on every side. Houses
//! are cut out along straight lines of a cell's own coordinates (u, v), so that neighbors have the same
//! corners to the last bit and their walls join without a gap. Metres; x east, z south, y up.

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::plan::{Rect, corners, divide, signed};

/// Four corners in the order north-west, north-east, south-east, south-west; side k runs from corner k to k +
/// 1.
pub(super) type Quad = [DVec3; 4];

/// Top of the pavements above the street, m.
pub(super) const CURB: f64 = 0.15;
/// From floor to floor, m.
pub(super) const STOREY: f64 = 3.0;
/// Rise of a roof's ridge or tip above the eaves, m.
pub(super) const RISE: f64 = 3.0;
/// Width of a pavement, m.
const PAVEMENT: f64 = 2.6;
/// Depth of a house from the street, m.
const DEPTH: f64 = 10.0;
/// Mean width of a house, m.
const WIDTH: f64 = 9.5;
/// Width of a passage between two houses, m.
const PASSAGE: f64 = 2.4;
/// Width of the meadows around the city, m.
const MEADOW: f64 = 36.0;

/// What covers a house.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Roof {
    Flat,
    /// A ridge from the side to the house before to the side to the house after.
    Gabled,
    /// Four slopes to a tip.
    Tent,
}

/// A house that shares a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbor {
    pub(super) eaves: f64,
    pub(super) roof: Roof,
}

/// A house of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct House {
    pub(super) ground: Quad,
    pub(super) storeys: u32,
    pub(super) roof: Roof,
    /// Number of its color.
    pub(super) paint: u32,
    /// Sides to the house before and after it in the ring.
    pub(super) ends: [usize; 2],
    /// Which sides face a street.
    pub(super) street: [bool; 4],
    /// The house that joins on each side.
    pub(super) joined: [Option<Neighbor>; 4],
}

impl House {
    /// Height of the eaves, m.
    pub(super) fn eaves(&self) -> f64 {
        CURB + STOREY * f64::from(self.storeys) + 0.3
    }
}

/// A cell of the grid: a block, a park (no houses), or a meadow at the city's border.
pub(super) struct Cell {
    /// Up to the streets' edges.
    pub(super) ground: Quad,
    pub(super) houses: Vec<House>,
    pub(super) meadow: bool,
}

/// The whole city.
pub(super) struct City {
    /// Blocks from west to east and from north to south; cells are one more on each side.
    pub(super) blocks: [usize; 2],
    pub(super) cells: Vec<Cell>,
    nodes: Vec<DVec3>,
}

impl City {
    /// Plans a city of `blocks` blocks with houses (at least 2), about four wide where it is three deep.
    pub(super) fn new(blocks: u64, seed: u64) -> Self {
        let rng = &mut Pcg32::new(seed, 1);
        let deep = ((blocks as f64 * 0.75).sqrt() + 0.5).floor().max(1.0) as usize;
        let wide = (blocks as usize).div_ceil(deep).max(2);
        let xs = lines(wide, 46.0, rng);
        let zs = lines(deep, 42.0, rng);
        let mut nodes = Vec::new();
        for (j, z) in zs.iter().enumerate() {
            for (i, x) in xs.iter().enumerate() {
                let within = |k: usize, n: usize| if k == 0 || k + 1 == n { 0.0 } else { 1.8 };
                let (dx, dz) = (within(i, xs.len()) * signed(rng), within(j, zs.len()) * signed(rng));
                nodes.push(DVec3::new(x + dx, 0.0, z + dz));
            }
        }
        let half = |n: usize, rng: &mut Pcg32| -> Vec<f64> {
            // The border itself is no street.
            (0..n).map(|k| if k == 0 || k + 1 == n { 0.0 } else { 4.2 + 0.7 * signed(rng) }).collect()
        };
        let (columns, rows) = (half(xs.len(), rng), half(zs.len(), rng));
        let mut city = Self { blocks: [wide, deep], cells: Vec::new(), nodes };
        let mut left = blocks.max(2);
        for j in 0..deep + 2 {
            for i in 0..wide + 2 {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| city.node(i, j));
                let ground = inset(&corners, [rows[j], columns[i + 1], rows[j + 1], columns[i]]);
                let meadow = i == 0 || j == 0 || i > wide || j > deep;
                let mut cell = Cell { ground, houses: Vec::new(), meadow };
                if !meadow && left > 0 {
                    left -= 1;
                    cell.houses = ring(&inset(&ground, [PAVEMENT; 4]), rng);
                }
                city.cells.push(cell);
            }
        }
        city
    }

    /// Where street lines cross; lines 0 and the last are the border.
    pub(super) fn node(&self, i: usize, j: usize) -> DVec3 {
        self.nodes[j * (self.blocks[0] + 3) + i]
    }
    /// A cell; those at the border are meadows.
    pub(super) fn cell(&self, i: usize, j: usize) -> &Cell {
        &self.cells[j * (self.blocks[0] + 2) + i]
    }
    /// Street lines of the walk: three from north to south, two from west to east, well inside if there are
    /// enough.
    pub(super) fn walked_lines(&self) -> ([usize; 3], [usize; 2]) {
        let [wide, deep] = self.blocks;
        ([1 + wide / 4, 1 + wide / 2, 1 + wide - wide / 4], [1 + deep / 3, 1 + deep - deep / 3])
    }
    /// Length of the diagonal, m.
    pub(super) fn diagonal(&self) -> f64 {
        self.node(0, 0).distance(self.node(self.blocks[0] + 2, self.blocks[1] + 2))
    }
}

/// Street lines around `n` blocks and the two borders.
fn lines(n: usize, size: f64, rng: &mut Pcg32) -> Vec<f64> {
    let mut at = 0.0;
    let mut lines = vec![at];
    for k in 0..n + 2 {
        at += if k == 0 || k == n + 1 { MEADOW } else { size * (1.0 + 0.12 * signed(rng)) };
        lines.push(at);
    }
    lines
}

/// A quad with each side moved in by its distance.
fn inset(quad: &Quad, by: [f64; 4]) -> Quad {
    let along = |k: usize| (quad[(k + 1) % 4] - quad[k]).normalize();
    let side = |k: usize| {
        let t = along(k);
        // North-west, north-east, … goes clockwise seen from above, so the inside is to the right.
        (quad[k] + DVec3::new(-t.z, 0.0, t.x) * by[k], t)
    };
    std::array::from_fn(|k| {
        let ((p, s), (q, t)) = (side((k + 3) % 4), side(k));
        let d = q - p;
        p + s * ((d.x * t.z - d.z * t.x) / (s.x * t.z - s.z * t.x))
    })
}

/// A point of a quad by its own coordinates: u east, v south, 0..1.
fn within(quad: &Quad, u: f64, v: f64) -> DVec3 {
    (quad[0] * (1.0 - u) + quad[1] * u) * (1.0 - v) + (quad[3] * (1.0 - u) + quad[2] * u) * v
}

/// A piece of ground for a house.
struct Lot {
    /// Its corner in the north-west and that in the south-east: `[u0, v0, u1, v1]` of the block.
    place: Rect,
    /// Sides to the lot before and after it in the ring.
    ends: [usize; 2],
    /// Which sides face a street.
    street: [bool; 4],
}

impl Lot {
    /// Corner lots face two streets.
    fn is_corner(&self) -> bool {
        self.street.iter().filter(|s| **s).count() == 2
    }
}

/// Houses around a yard, clockwise from the north-west.
fn ring(line: &Quad, rng: &mut Pcg32) -> Vec<House> {
    let length = |a: usize, b: usize| line[a].distance(line[b]);
    let size = [length(0, 1).min(length(3, 2)), length(0, 3).min(length(1, 2))];
    let lots = lots(size, rng);
    let mut houses = Vec::with_capacity(lots.len());
    let mut apart = Vec::with_capacity(lots.len());
    for mut lot in lots {
        let passage = !lot.is_corner() && rng.next_u32().is_multiple_of(5);
        if passage {
            // The side towards the house before is drawn back.
            let step = PASSAGE / size[1 - lot.ends[0] % 2];
            let (place, sign) = [(1, 1.0), (2, -1.0), (3, -1.0), (0, 1.0)][lot.ends[0]];
            lot.place[place] += sign * step;
        }
        apart.push(passage);
        houses.push(house(line, &lot, rng));
    }
    join(&mut houses, &apart);
    houses
}

/// The lots around a block of this width and depth in meters, clockwise from the north-west.
fn lots([wide, deep]: [f64; 2], rng: &mut Pcg32) -> Vec<Lot> {
    let (du, dv) = (DEPTH / wide, DEPTH / deep);
    let inner = |part: f64, whole: f64, rng: &mut Pcg32| {
        divide(part, 1.0 - part, ((1.0 - 2.0 * part) * whole / WIDTH + 0.5).floor().max(1.0) as u64, rng)
    };
    let mut lots = Vec::new();
    // Each side of the ring begins with the corner house at its start.
    for side in 0..4 {
        let corner = [
            [0.0, 0.0, du, dv],
            [1.0 - du, 0.0, 1.0, dv],
            [1.0 - du, 1.0 - dv, 1.0, 1.0],
            [0.0, 1.0 - dv, du, 1.0],
        ][side];
        let (before, opposite, after) = ((side + 3) % 4, (side + 2) % 4, (side + 1) % 4);
        lots.push(Lot {
            place: corner,
            ends: [opposite, after],
            street: std::array::from_fn(|k| k == side || k == before),
        });
        let cuts = if side % 2 == 0 { inner(du, wide, rng) } else { inner(dv, deep, rng) };
        let mut row: Vec<Rect> = cuts
            .windows(2)
            .map(|w| match side {
                0 => [w[0], 0.0, w[1], dv],
                1 => [1.0 - du, w[0], 1.0, w[1]],
                2 => [w[0], 1.0 - dv, w[1], 1.0],
                _ => [0.0, w[0], du, w[1]],
            })
            .collect();
        // Cuts ascend, but the ring runs west along the south side and north along the west side.
        if side >= 2 {
            row.reverse();
        }
        let street = std::array::from_fn(|k| k == side);
        lots.extend(row.into_iter().map(|place| Lot { place, ends: [before, after], street }));
    }
    lots
}

/// A house of a random kind on a lot; nothing joins it yet.
fn house(line: &Quad, lot: &Lot, rng: &mut Pcg32) -> House {
    let ground = corners(lot.place).map(|[u, v]| within(line, u, v));
    let roof = match (lot.is_corner(), rng.next_u32() % 3) {
        (_, 0) => Roof::Flat,
        (true, _) => Roof::Tent,
        (false, _) => Roof::Gabled,
    };
    let (storeys, paint) = (2 + rng.next_u32() % 4, rng.next_u32());
    House { ground, storeys, roof, paint, ends: lot.ends, street: lot.street, joined: [None; 4] }
}

/// Makes each house of a ring and the next one neighbors, unless the next one stands `apart`.
fn join(houses: &mut [House], apart: &[bool]) {
    for k in 0..houses.len() {
        let next = (k + 1) % houses.len();
        if !apart[next] {
            let seen = |h: &House| Neighbor { eaves: h.eaves(), roof: h.roof };
            let (here, there) = (seen(&houses[k]), seen(&houses[next]));
            let (end, start) = (houses[k].ends[1], houses[next].ends[0]);
            houses[k].joined[end] = Some(there);
            houses[next].joined[start] = Some(here);
        }
    }
}
