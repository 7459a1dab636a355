//! Primitives on their way to windows: vectors of corners, sixteen that are set up, and what became of them.

use super::wide::{Wide, each};

/// Sizes of primitives, up to so many pixels. Of small ones edge functions are exact in 32 bits all over;
/// of middling ones floats hold them wherever they decide; large ones take doubles.
pub(super) const SMALL: u8 = 0;
pub(super) const MIDDLING: u8 = 1;
pub(super) const LARGE: u8 = 2;

/// The corners of a vector of primitives, by their columns.
#[derive(Clone, Copy)]
pub(super) struct Corners<L: Wide> {
    pub x: [L::I; 4],
    pub y: [L::I; 4],
    pub z: [L::F; 4],
    pub packed: [L::I; 4],
}

/// A box of pixels each, half-open.
#[derive(Clone, Copy)]
pub(super) struct Pixels<L: Wide> {
    pub x0: L::I,
    pub x1: L::I,
    pub y0: L::I,
    pub y1: L::I,
}

impl<L: Wide> Corners<L> {
    /// What the snap took from columns and rows, 1024ths of a step; as the vertex packs it.
    #[inline(always)]
    pub fn rests(&self, l: L) -> [[L::I; 4]; 2] {
        [
            each!(4; k => l.shift_right::<20>(l.shift_up::<12>(self.packed[k]))),
            each!(4; k => l.shift_right::<20>(self.packed[k])),
        ]
    }
    /// The way from one corner to another along an axis before snapping, in steps.
    #[inline(always)]
    pub fn way(&self, l: L, rest: &[[L::I; 4]; 2], axis: usize, to: usize, from: usize) -> L::F {
        let v = if axis == 0 { &self.x } else { &self.y };
        let more = l.to_f(l.sub_i(rest[axis][to], rest[axis][from]));
        l.add(l.to_f(l.sub_i(v[to], v[from])), l.mul(more, l.splat(1.0 / 1024.0)))
    }
    /// The farthest and the nearest depth of the corners.
    #[inline(always)]
    pub fn ends(&self, l: L) -> (L::F, L::F) {
        let z = &self.z;
        (l.min(l.min(z[0], z[1]), l.min(z[2], z[3])), l.max(l.max(z[0], z[1]), l.max(z[2], z[3])))
    }
}

/// Sixteen primitives that are set up.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct Ready {
    /// Pixels of their boxes, half-open.
    pub x0: [i32; 16],
    pub x1: [i32; 16],
    pub y0: [i32; 16],
    pub y1: [i32; 16],
    /// Edge functions at the center of the first pixel of the first block, and what they change a row and
    /// (turned round) a column, divided by 256 and rounded down: `e + ex·row − ey·column`.
    pub e: [[i32; 16]; 4],
    pub ex: [[i32; 16]; 4],
    pub ey: [[i32; 16]; 4],
    /// The same as floats, with 1/ey and what keeps the rounding of a quotient from mattering.
    pub ef: [[f32; 16]; 4],
    pub exf: [[f32; 16]; 4],
    pub per_ey: [[f32; 16]; 4],
    pub bias: [[f32; 16]; 4],
    /// All ones where the pixels left of the crossing are inside.
    pub flip: [[i32; 16]; 4],
    /// Of large primitives, from the first pixel of the image.
    pub wide_e: [[f64; 16]; 4],
    pub wide_ex: [[f64; 16]; 4],
    pub wide_per_ey: [[f64; 16]; 4],
    pub wide_bias: [[f64; 16]; 4],
    /// Depth in the first tile of the first block: bounds, and the changes from tile to tile.
    pub far: [f32; 16],
    pub near: [f32; 16],
    pub along: [f32; 16],
    pub down: [f32; 16],
    /// Lower bound at the first pixel of the first block.
    pub floor: [f32; 16],
    /// Of its corners.
    pub farthest: [f32; 16],
    pub nearest: [f32; 16],
}

/// What became of what was drawn, by tags, where someone asks.
#[derive(Clone, Debug, Default)]
pub(super) struct Told {
    pub is_asked: bool,
    /// What faced the eye.
    pub faced: Vec<i32>,
    /// What may show.
    pub shown: Vec<i32>,
}

impl Told {
    pub fn begin(&mut self) {
        self.faced.clear();
        self.shown.clear();
    }
}

#[inline(always)]
pub(super) fn least4<L: Wide>(l: L, v: [L::I; 4]) -> L::I {
    l.min_i(l.min_i(v[0], v[1]), l.min_i(v[2], v[3]))
}
#[inline(always)]
pub(super) fn greatest4<L: Wide>(l: L, v: [L::I; 4]) -> L::I {
    l.max_i(l.max_i(v[0], v[1]), l.max_i(v[2], v[3]))
}
