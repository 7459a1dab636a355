//! The view as boxes are asked in it, and where a box lies in the image: by pixels, and by its planes.
//!
//! Along the ray through a pixel a box begins at the farthest of its front planes and ends at the nearest of
//! its back planes. A plane square to axis `a` at distance `s` from the eye has the depth `1/w = r_a / s`
//! there, with `r_a` the ray's component at view depth 1, which is linear over the image. So six reciprocals
//! and three functions of the view bound where the box begins and ends in any cell of the image, many cells
//! at a time.
//!
//! Why no fragment of what the box holds is nearer than where it begins, in a cell grown by [`BESIDE_PX`]:
//! the depth there is, but for [`DEPTH_SLACK`] of it, that of a point of the box whose image is within half a
//! grid step of the pixel's center along each axis (see there); rounding in f32 adds less than as much again,
//! which [`NEARER`] holds. Nor is it nearer than the nearest corner.
//!
//! All is f32. Coordinates relative to the eye are off by 2⁻²⁴ of themselves, and by as much of the eye's
//! own; products and sums by a few times that. [`ROUNDING`] of both together is more.

use super::clusters::Boxes;
use super::wide::{Wide, each};
use crate::raster::DEPTH_SLACK;
use crate::raster::vertex::Camera;

/// What a fragment may be nearer by than where its box begins there, as a factor.
const NEARER: f64 = 1.0 + 2.0 * DEPTH_SLACK;
/// By how much farther out a pixel's center may lie than the image of what is drawn there, pixels, and more
/// than that for what is rounded of the image.
const BESIDE_PX: f32 = 0.01;
/// Half extents of the centers of a block, a tile and a pixel.
pub(super) const BLOCK: [f32; 2] = [15.5 + BESIDE_PX, 7.5 + BESIDE_PX];
pub(super) const TILE: [f32; 2] = [3.5 + BESIDE_PX, 1.5 + BESIDE_PX];
pub(super) const PIXEL: [f32; 2] = [BESIDE_PX, BESIDE_PX];
const ROUNDING: f32 = 1.0 / (1 << 20) as f32;

/// The view, with what f32 rounds of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Look {
    pub eye: [f32; 3],
    near: f32,
    half: [f32; 2],
    rows: [[f32; 3]; 3],
    /// The greatest part of each row, by which errors of coordinates grow.
    gain: [f32; 3],
    /// Sum of the eye's coordinates, whose rounding counts.
    remote: f32,
    /// Normals of the four sides and of the near plane, inward; nothing is inside below the offset.
    planes: [([f32; 3], f32); 5],
    /// For each axis the ray's component as a function `a·x + b·y + c` of the pixel.
    rays: [[f32; 3]; 3],
    /// What f32 may lose of it anywhere in the image.
    ray_error: [f32; 3],
}

impl Look {
    pub fn new(c: &Camera, width: f64, height: f64) -> Self {
        let r = c.rows.map(glam::DVec3::from);
        let narrow = |v: glam::DVec3| v.as_vec3().to_array();
        let side = |k: usize, sign: f64| (narrow((r[2] + r[k] * sign).normalize_or_zero()), 0.0);
        // Flatland has no row of y, and rays that do not change along it.
        let over = |r: glam::DVec3| if r == glam::DVec3::ZERO { r } else { r / r.length_squared() };
        let [x, y] = [over(r[0]), over(r[1])];
        let rays = [0, 1, 2].map(|a| [x[a] * 2.0 / width, -y[a] * 2.0 / height, r[2][a] - x[a] + y[a]]);
        let greatest = |[a, b, c]: [f64; 3]| a.abs() * width + b.abs() * height + c.abs();
        Self {
            eye: c.eye.map(|v| v as f32),
            near: c.near as f32,
            half: [width as f32 * 0.5, height as f32 * 0.5],
            rows: r.map(narrow),
            gain: r.map(|r| r.abs().max_element() as f32),
            remote: c.eye.iter().map(|v| v.abs()).sum::<f64>() as f32,
            planes: [side(0, 1.0), side(0, -1.0), side(1, 1.0), side(1, -1.0), (narrow(r[2]), c.near as f32)],
            rays: rays.map(|ray| ray.map(|v| v as f32)),
            ray_error: rays.map(|ray| greatest(ray) as f32 * ROUNDING),
        }
    }

    /// The boxes that are not surely out of view.
    #[inline(always)]
    pub fn in_view<L: Wide>(&self, l: L, boxes: &Boxes, seen: &mut Vec<i32>) {
        // For all of them alike: the eye's coordinates once for the difference and once for their own
        // rounding.
        let slack = (boxes.reach + 2.0 * self.remote) * ROUNDING;
        seen.clear();
        seen.resize(boxes.len() + 16, 0);
        let mut count = 0;
        for first in (0..boxes.len()).step_by(L::N) {
            let low = each!(3; a => l.sub(l.load(&boxes.low[a][first..]), l.splat(self.eye[a])));
            let high = each!(3; a => l.sub(l.load(&boxes.high[a][first..]), l.splat(self.eye[a])));
            let mut inside = l.first(boxes.len() - first);
            for (n, offset) in &self.planes {
                // The corner farthest inward.
                let end = each!(3; a => l.mul(if n[a] > 0.0 { high[a] } else { low[a] }, l.splat(n[a])));
                let inward = l.add(l.add(end[0], end[1]), end[2]);
                inside = l.both(inside, l.ge(inward, l.splat(offset - slack)));
            }
            let numbers = l.add_i(l.truncate(l.lanes()), l.splat_i(first as i32));
            l.compress(&mut seen[count..], inside, numbers);
            count += l.bits(inside).count_ones() as usize;
        }
        seen.truncate(count);
    }

    /// The pixels that boxes can cover, and their nearest depths.
    #[inline(always)]
    pub fn project<L: Wide>(&self, l: L, boxes: &Boxes, seen: &[i32], asked: &mut Vec<Asked>) {
        asked.clear();
        for ids in seen.chunks(L::N) {
            let mut ends = [[0.0f32; 16]; 6];
            for (lane, &i) in ids.iter().enumerate() {
                for a in 0..3 {
                    ends[a][lane] = boxes.low[a][i as usize];
                    ends[a + 3][lane] = boxes.high[a][i as usize];
                }
            }
            let low = each!(3; a => l.sub(l.load(&ends[a]), l.splat(self.eye[a])));
            let high = each!(3; a => l.sub(l.load(&ends[a + 3]), l.splat(self.eye[a])));
            let [x, y, w] = each!(3; r => self.corners(l, r, &low, &high));
            let most = each!(3; a => l.max(l.abs(low[a]), l.abs(high[a])));
            let reach = l.add(l.add(l.add(most[0], most[1]), most[2]), l.splat(self.remote));
            let error = l.mul(reach, l.splat(ROUNDING));
            let least = l.sub(least8(l, &w), l.mul(error, l.splat(self.gain[2])));
            let crosses = l.bits(l.ge(l.splat(self.near), least));
            let nearest = l.mul(l.div(l.splat(1.0), least), l.splat(1.0 + ROUNDING));
            let (left, right) = self.ends(l, 0, &x, &w, l.mul(error, nearest));
            let (bottom, top) = self.ends(l, 1, &y, &w, l.mul(error, nearest));
            let sides = [
                self.cut(l, left, 0, 1.0, -BESIDE_PX),
                self.cut(l, right, 0, 1.0, BESIDE_PX),
                self.cut(l, top, 1, -1.0, -BESIDE_PX),
                self.cut(l, bottom, 1, -1.0, BESIDE_PX),
            ];
            let (mut pixels, mut depths) = ([[0; 16]; 4], [0.0; 16]);
            for (to, v) in pixels.iter_mut().zip(sides) {
                l.store_i(to, v);
            }
            l.store(&mut depths, nearest);
            for (lane, &id) in ids.iter().enumerate() {
                let [x0, x1, y0, y1] = [pixels[0][lane], pixels[1][lane], pixels[2][lane], pixels[3][lane]];
                let crosses_near = crosses >> lane & 1 != 0;
                asked.push(Asked { id: id as u32, x0, x1, y0, y1, nearest: depths[lane], crosses_near });
            }
        }
    }
    /// One coordinate of the eight corners: sums of parts that two or four of them share.
    #[inline(always)]
    fn corners<L: Wide>(&self, l: L, row: usize, low: &[L::F; 3], high: &[L::F; 3]) -> [L::F; 8] {
        let m = each!(3; a => l.splat(self.rows[row][a]));
        let [x, y, z] = each!(3; a => [l.mul(m[a], low[a]), l.mul(m[a], high[a])]);
        each!(8; k => l.add(l.add(x[k & 1], y[k >> 1 & 1]), z[k >> 2]))
    }
    /// The ends of an image axis that corners reach, from −1 to 1 over the image. `error`: of a coordinate,
    /// over the least `w`.
    #[inline(always)]
    fn ends<L: Wide>(&self, l: L, row: usize, p: &[L::F; 8], w: &[L::F; 8], error: L::F) -> (L::F, L::F) {
        let q = each!(8; k => l.div(p[k], w[k]));
        let (low, high) = (least8(l, &q), greatest8(l, &q));
        // A quotient errs by what its upper part does, and by its size times what its lower part does.
        let size = l.max(l.abs(low), l.abs(high));
        let wrong = l.add(l.splat(self.gain[row]), l.mul(size, l.splat(self.gain[2])));
        let wrong = l.mul(l.mul(error, wrong), l.splat(2.0));
        (l.sub(low, wrong), l.add(high, wrong))
    }
    /// The first pixel whose center is at or after an end.
    #[inline(always)]
    fn cut<L: Wide>(&self, l: L, end: L::F, axis: usize, sign: f32, more: f32) -> L::I {
        let half = self.half[axis];
        let v = l.add(l.mul(end, l.splat(sign * half)), l.splat(half + more - 0.5));
        l.ceil(l.max(l.min(v, l.splat(2.0 * half)), l.splat(0.0)))
    }
}

#[inline(always)]
fn least8<L: Wide>(l: L, v: &[L::F; 8]) -> L::F {
    let half = each!(4; k => l.min(v[k], v[k + 4]));
    l.min(l.min(half[0], half[1]), l.min(half[2], half[3]))
}
#[inline(always)]
fn greatest8<L: Wide>(l: L, v: &[L::F; 8]) -> L::F {
    let half = each!(4; k => l.max(v[k], v[k + 4]));
    l.max(l.max(half[0], half[1]), l.max(half[2], half[3]))
}

/// A box in view: its number, the pixels that it can cover, half-open, and its nearest depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub id: u32,
    pub x0: i32,
    pub x1: i32,
    pub y0: i32,
    pub y1: i32,
    pub nearest: f32,
    /// It reaches the near plane: nothing finite bounds it.
    pub crosses_near: bool,
}

impl Asked {
    /// Whether no pixel's center is in its rectangle.
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }
    /// Blocks of its rectangle: left, right, top, bottom, half-open.
    #[inline(always)]
    pub fn blocks(&self) -> [usize; 4] {
        let past = |v: i32, side: u32| ((v - 1) >> side) as usize + 1;
        [(self.x0 >> 5) as usize, past(self.x1, 5), (self.y0 >> 4) as usize, past(self.y1, 4)]
    }
    /// The pixels of a tile, given by its first one, that lie in its rectangle.
    #[inline(always)]
    pub fn pixels(&self, [x, y]: [i32; 2]) -> u32 {
        let range = |from: i32, past: i32, most: i32| (from.clamp(0, most), past.clamp(0, most));
        let (x0, x1) = range(self.x0 - x, self.x1 - x, 8);
        let (y0, y1) = range(self.y0 - y, self.y1 - y, 4);
        let across = ((1u64 << x1) - (1 << x0)) * 0x0101_0101;
        (across & ((1u64 << (8 * y1)) - (1 << (8 * y0)))) as u32
    }
    /// The tiles of a block that lie in its rectangle as wholes; those of a line are one row high.
    #[inline(always)]
    pub fn tiles_inside(&self, strip: usize, row: usize, is_flat: bool) -> u32 {
        let (left, top) = (32 * strip as i32, 16 * row as i32);
        let range = |from: i32, past: i32, side: u32| {
            let first = ((from + (1 << side) - 1) >> side).clamp(0, 4);
            (first, (past >> side).clamp(first, 4))
        };
        let (x0, x1) = range(self.x0 - left, self.x1 - left, 3);
        let (y0, y1) = if is_flat { (0, 1) } else { range(self.y0 - top, self.y1 - top, 2) };
        let across = ((1u32 << x1) - (1 << x0)) * 0x1111;
        across & ((1u32 << (4 * y1)) - (1 << (4 * y0)))
    }
    /// The tiles of a block that its rectangle touches.
    #[inline(always)]
    pub fn tiles(&self, strip: usize, row: usize) -> u32 {
        let (left, top) = (32 * strip as i32, 16 * row as i32);
        let (first, last) = (((self.x0 - left) >> 3).max(0), ((self.x1 - 1 - left) >> 3).min(3));
        let across = (0xfu32 << first) & (0xf >> (3 - last));
        let (first, last) = (((self.y0 - top) >> 2).max(0), ((self.y1 - 1 - top) >> 2).min(3));
        (across * 0x1111) & (0xffff << (4 * first)) & (0xffff >> (12 - 4 * last))
    }
}

/// A plane of a box over the image: `1/w = a·x + b·y + c`, and how far that may be off.
#[derive(Clone, Copy, Default)]
struct Sheet {
    a: f32,
    b: f32,
    c: f32,
    off: f32,
}

impl Sheet {
    /// Square to an axis at a distance from the eye; with a factor.
    #[inline(always)]
    fn new(look: &Look, axis: usize, distance: f64, factor: f64) -> Self {
        let s = (factor / distance) as f32;
        let [a, b, c] = look.rays[axis];
        Self { a: a * s, b: b * s, c: c * s, off: s.abs() * look.ray_error[axis] }
    }
    /// By how much it differs within half extents, and may be off.
    #[inline(always)]
    fn reach(&self, [x, y]: [f32; 2]) -> f32 {
        self.a.abs() * x + self.b.abs() * y + self.off
    }
    #[inline(always)]
    fn at<L: Wide>(&self, l: L, x: L::F, y: L::F, more: f32) -> L::F {
        l.add(l.add(l.mul(x, l.splat(self.a)), l.mul(y, l.splat(self.b))), l.splat(self.c + more))
    }
}

/// Where a box begins (the least of its front planes' depths) and ends (the greatest of its back planes').
#[derive(Clone, Copy, Default)]
pub(super) struct Span {
    front: [Sheet; 3],
    fronts: usize,
    back: [Sheet; 6],
    backs: usize,
    nearest: f32,
}

impl Span {
    /// Everywhere, no nearer than a depth.
    pub fn everywhere(nearest: f32) -> Self {
        Self { nearest, ..Self::default() }
    }
    #[inline(always)]
    pub fn new(look: &Look, eye: &[f64; 3], [low, high]: [[f32; 3]; 2], nearest: f32) -> Self {
        let mut span = Self { nearest, ..Self::default() };
        for a in 0..3 {
            let (low, high) = (f64::from(low[a]) - eye[a], f64::from(high[a]) - eye[a]);
            let backs = if low > 0.0 || high < 0.0 {
                let (front, back) = if low > 0.0 { (low, high) } else { (high, low) };
                span.front[span.fronts] = Sheet::new(look, a, front, NEARER);
                span.fronts += 1;
                [back, 0.0]
            } else {
                // Between the planes, or on one: it has begun, and ends at either; one that the eye is on
                // bounds nothing.
                [low, high]
            };
            for back in backs {
                if back != 0.0 {
                    span.back[span.backs] = Sheet::new(look, a, back, 1.0);
                    span.backs += 1;
                }
            }
        }
        span
    }
    /// Bounds over cells with these centers and half extents, in pixels: where it begins at most and where it
    /// ends at least. Where it begins before it ends, it misses the cell.
    #[inline(always)]
    pub fn outer<L: Wide>(&self, l: L, x: L::F, y: L::F, half: [f32; 2]) -> (L::F, L::F) {
        let (mut begins, mut ends) = (l.splat(self.nearest), l.splat(0.0));
        for f in &self.front[..self.fronts] {
            begins = l.min(begins, f.at(l, x, y, f.reach(half)));
        }
        for f in &self.back[..self.backs] {
            ends = l.max(ends, f.at(l, x, y, -f.reach(half)));
        }
        (begins, ends)
    }
    /// The other way round: where it begins at least and where it ends at most. Where it begins after it
    /// ends, it covers the cell.
    #[inline(always)]
    pub fn inner<L: Wide>(&self, l: L, x: L::F, y: L::F, half: [f32; 2]) -> (L::F, L::F) {
        let (mut begins, mut ends) = (l.splat(self.nearest), l.splat(0.0));
        for f in &self.front[..self.fronts] {
            begins = l.min(begins, f.at(l, x, y, -f.reach(half)));
        }
        for f in &self.back[..self.backs] {
            ends = l.max(ends, f.at(l, x, y, f.reach(half)));
        }
        (begins, ends)
    }
    /// Whether one of its front planes lies behind a plane over the tile at a pixel that nothing there is
    /// farther than: two linear functions are compared at the tile's corners.
    #[inline(always)]
    pub fn is_below(&self, [at, a, b]: &[f32; 3], [x, y]: [i32; 2]) -> bool {
        let (x, y) = (x as f32 + 4.0, y as f32 + 2.0);
        let mut is_below = false;
        for f in &self.front[..self.fronts] {
            let before = f.a * x + f.b * y + (f.c + f.off) - at;
            is_below |= before + (f.a - a).abs() * TILE[0] + (f.b - b).abs() * TILE[1] < 0.0;
        }
        is_below
    }
    /// The pixels of the tile at a pixel where it may be, and if depths are given not behind them.
    #[inline(always)]
    pub fn pixels<L: Wide>(&self, l: L, [x, y]: [i32; 2], depths: Option<&[f32; 32]>) -> u32 {
        let (column, row) = l.pixels();
        let x = l.add(l.to_f(column), l.splat(x as f32 + 0.5));
        let y = l.add(l.to_f(row), l.splat(y as f32 + 0.5));
        let mut begins = [l.splat(self.nearest); 4];
        for f in &self.front[..self.fronts] {
            for (part, begins) in begins[..32 / L::N].iter_mut().enumerate() {
                let y = l.add(y, l.splat((part * L::N / 8) as f32));
                *begins = l.min(*begins, f.at(l, x, y, f.reach(PIXEL)));
            }
        }
        let mut on = [l.first(16); 4];
        if let Some(depths) = depths {
            let mut any = 0;
            for (part, on) in on[..32 / L::N].iter_mut().enumerate() {
                *on = l.ge(begins[part], l.load(&depths[part * L::N..]));
                any |= l.bits(*on);
            }
            // Most of what is hidden is so by its front alone.
            if any == 0 {
                return 0;
            }
        }
        for f in &self.back[..self.backs] {
            for (part, on) in on[..32 / L::N].iter_mut().enumerate() {
                let y = l.add(y, l.splat((part * L::N / 8) as f32));
                *on = l.both(*on, l.ge(begins[part], f.at(l, x, y, -f.reach(PIXEL))));
            }
        }
        let mut all = 0;
        for (part, &on) in on[..32 / L::N].iter().enumerate() {
            all |= l.bits(on) << (part * L::N);
        }
        all
    }
}
