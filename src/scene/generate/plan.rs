//! The floor plan of the building: rooms around a corridor in the shape of an 8.
//!
//! After the floors of Soda Hall that the papers walked through: offices along the outer walls, a ring of
//! corridors, and two blocks of inner rooms with a corridor between them. Metres; x east, z south, y up.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// Depth of a room from its door, m.
pub(super) const ROOM: f64 = 5.0;
/// Width of a corridor, m.
pub(super) const CORRIDOR: f64 = 2.4;
/// Height of the ceiling, m.
pub(super) const HEIGHT: f64 = 2.8;
/// Mean width of a room, m.
const WIDTH: f64 = 4.0;

/// A direction in the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// −z.
    North,
    /// +z.
    South,
    /// −x.
    West,
    /// +x.
    East,
}

/// A rectangle of the plan: `[x0, z0, x1, z1]`.
pub(super) type Rect = [f64; 4];

/// The corners of a rectangle `[u0, v0, u1, v1]` in order around it.
pub(super) fn corners([u0, v0, u1, v1]: Rect) -> [[f64; 2]; 4] {
    [[u0, v0], [u1, v0], [u1, v1], [u0, v1]]
}

/// A room, or a stretch of corridor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    pub(super) rect: Rect,
    /// The side with the door, and the door's middle along it.
    pub(super) door: Option<(Side, f64)>,
    /// The side with the window: an outer wall.
    pub(super) window: Option<Side>,
}

/// An opening in a wall: from, to, bottom, top.
pub(super) type Opening = [f64; 4];

/// A straight wall of the plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    /// Whether it runs along x (else along z).
    pub(super) along_x: bool,
    /// Its place across.
    pub(super) place: f64,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) opening: Option<Opening>,
}

/// Rooms, corridors and walls of a floor.
pub(super) struct Plan {
    pub(super) rooms: Vec<Room>,
    pub(super) corridors: Vec<Room>,
    pub(super) walls: Vec<Wall>,
    pub(super) size: [f64; 2],
}

/// A number in −1..1.
pub(super) fn signed(rng: &mut Pcg32) -> f64 {
    f64::from(rng.next_u32()) / f64::from(1u32 << 31) - 1.0
}

impl Plan {
    /// Plans a floor of about `rooms` rooms: `4m` inside, `4m + 14` along the outer walls.
    pub(super) fn new(rooms: u64, seed: u64) -> Self {
        let mut rng = Pcg32::new(seed, 1);
        let m = ((rooms.saturating_sub(14) + 4) / 8).max(1);
        let block = m as f64 * WIDTH;
        let width = 2.0 * ROOM + 3.0 * CORRIDOR + 2.0 * block;
        let depth = 4.0 * ROOM + 2.0 * CORRIDOR;
        let mut plan = Self { rooms: vec![], corridors: vec![], walls: vec![], size: [width, depth] };
        plan.outer_rows(m, &mut rng);
        for start in [ROOM + CORRIDOR, ROOM + 2.0 * CORRIDOR + block] {
            plan.block(start, block, m, &mut rng);
        }
        plan.corridors(block);
        plan
    }

    /// Middles of the corridors that run north to south: west, between the blocks, east.
    pub(super) fn aisles(&self) -> [f64; 3] {
        let edge = ROOM + CORRIDOR * 0.5;
        [edge, self.size[0] * 0.5, self.size[0] - edge]
    }
    /// Middles of the corridors that run west to east: north, south.
    pub(super) fn lanes(&self) -> [f64; 2] {
        let edge = ROOM + CORRIDOR * 0.5;
        [edge, self.size[1] - edge]
    }

    fn outer_rows(&mut self, m: u64, rng: &mut Pcg32) {
        let [width, depth] = self.size;
        // Rooms in the corners reach past the corridor's corner, where their door is.
        let corner = ROOM + CORRIDOR;
        for north in [true, false] {
            let mut cuts = vec![0.0];
            cuts.extend(divide(corner, width - corner, 2 * m, rng));
            cuts.push(width);
            let (outer, inner) = if north { (0.0, ROOM) } else { (depth, depth - ROOM) };
            let (door, window) = if north { (Side::South, Side::North) } else { (Side::North, Side::South) };
            for (i, w) in cuts.windows(2).enumerate() {
                let at = if i == 0 {
                    w[1] - CORRIDOR * 0.5
                } else if i + 2 == cuts.len() {
                    w[0] + CORRIDOR * 0.5
                } else {
                    door_at(w[0], w[1], rng)
                };
                let rect = [w[0], outer.min(inner), w[1], outer.max(inner)];
                self.rooms.push(Room { rect, door: Some((door, at)), window: Some(window) });
                self.wall(true, inner, w[0], w[1], Some(doorway(at)));
                self.wall(true, outer, w[0], w[1], Some(window_in(w[0], w[1])));
            }
            for place in &cuts[1..cuts.len() - 1] {
                self.wall(false, *place, outer.min(inner), outer.max(inner), None);
            }
        }
        for west in [true, false] {
            let cuts = divide(ROOM, depth - ROOM, 3, rng);
            let (outer, inner) = if west { (0.0, ROOM) } else { (width, width - ROOM) };
            let (door, window) = if west { (Side::East, Side::West) } else { (Side::West, Side::East) };
            for w in cuts.windows(2) {
                let at = door_at(w[0], w[1], rng);
                let rect = [outer.min(inner), w[0], outer.max(inner), w[1]];
                self.rooms.push(Room { rect, door: Some((door, at)), window: Some(window) });
                self.wall(false, inner, w[0], w[1], Some(doorway(at)));
                self.wall(false, outer, w[0], w[1], Some(window_in(w[0], w[1])));
            }
            for place in &cuts[1..cuts.len() - 1] {
                self.wall(true, *place, outer.min(inner), outer.max(inner), None);
            }
            // The outer walls of the corner rooms.
            for [from, to] in [[0.0, ROOM], [depth - ROOM, depth]] {
                self.wall(false, outer, from, to, Some(window_in(from, to)));
            }
        }
    }

    /// Two rows of inner rooms, back to back.
    fn block(&mut self, start: f64, length: f64, m: u64, rng: &mut Pcg32) {
        let (top, bottom) = (ROOM + CORRIDOR, self.size[1] - ROOM - CORRIDOR);
        let spine = (top + bottom) * 0.5;
        for (front, door) in [(top, Side::North), (bottom, Side::South)] {
            let cuts = divide(start, start + length, m, rng);
            for w in cuts.windows(2) {
                let at = door_at(w[0], w[1], rng);
                self.rooms.push(Room {
                    rect: [w[0], front.min(spine), w[1], front.max(spine)],
                    door: Some((door, at)),
                    window: None,
                });
                self.wall(true, front, w[0], w[1], Some(doorway(at)));
            }
            for place in &cuts[1..cuts.len() - 1] {
                self.wall(false, *place, front.min(spine), front.max(spine), None);
            }
        }
        self.wall(true, spine, start, start + length, None);
        for place in [start, start + length] {
            self.wall(false, place, top, bottom, None);
        }
    }

    fn corridors(&mut self, block: f64) {
        let [width, depth] = self.size;
        let mut stretch = |rect: Rect| self.corridors.push(Room { rect, door: None, window: None });
        for z in [ROOM, depth - ROOM - CORRIDOR] {
            stretch([ROOM, z, width * 0.5 - CORRIDOR * 0.5, z + CORRIDOR]);
            stretch([width * 0.5 - CORRIDOR * 0.5, z, width - ROOM, z + CORRIDOR]);
        }
        for k in 0..3 {
            let x = ROOM + f64::from(k) * (block + CORRIDOR);
            stretch([x, ROOM + CORRIDOR, x + CORRIDOR, depth - ROOM - CORRIDOR]);
        }
    }

    fn wall(&mut self, along_x: bool, place: f64, from: f64, to: f64, opening: Option<Opening>) {
        self.walls.push(Wall { along_x, place, from, to, opening });
    }
}

/// `n + 1` places from `from` to `to`, the inner ones moved a little.
pub(super) fn divide(from: f64, to: f64, n: u64, rng: &mut Pcg32) -> Vec<f64> {
    let step = (to - from) / n as f64;
    let inner = (1..n).map(|i| from + step * (i as f64 + 0.12 * signed(rng)));
    std::iter::once(from).chain(inner).chain(std::iter::once(to)).collect()
}

/// A door stands left or right of the middle, a metre from the wall at least.
fn door_at(from: f64, to: f64, rng: &mut Pcg32) -> f64 {
    let side = if signed(rng) < 0.0 { 0.28 } else { 0.72 };
    from + (to - from) * side
}

fn doorway(at: f64) -> Opening {
    [at - 0.475, at + 0.475, 0.0, 2.1]
}

fn window_in(from: f64, to: f64) -> Opening {
    let middle = (from + to) * 0.5;
    let half = ((to - from) * 0.5 - 0.6).min(1.4);
    [middle - half, middle + half, 0.9, 2.3]
}
