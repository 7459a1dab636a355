//! Samples that are full: boxes with colored faces let so little light through there that what is behind
//! them does not show.
//!
//! Boxes come in order, the nearest first, as over a [`super::Canvas`], and by the same arithmetic. Kept of
//! each sample is the share of light that comes through, and the depth at which the last box is entered that
//! took some of it. What begins behind that depth lies behind all of them. Geometry is not asked: where some
//! of it is before one of these boxes it is before what is behind them all as well, and hides it itself.
//!
//! Cost: O(samples in the rectangles about boxes); 8 bytes a sample.

use super::blend::{FULL, Rays, dim};
use super::{CubeFaces, PyramidCell};
use crate::geometry::{Aabb, PixelRect, Space, Vector, View};

/// How much light boxes let through, and from which depth on.
#[derive(Clone, Debug, Default)]
pub struct Saturation {
    rays: Rays,
    width: usize,
    /// Of each sample the share of the light that comes through.
    left: Vec<f32>,
    /// Where the last box is entered that it meets, `1/w`.
    depth: Vec<f32>,
}

/// Of the same boxes, from the same view: the rays follow from it.
impl PartialEq for Saturation {
    fn eq(&self, other: &Self) -> bool {
        (self.width, &self.left, &self.depth) == (other.width, &other.left, &other.depth)
    }
}

impl Saturation {
    /// No box in an image of the view's size.
    pub fn clear<S: Space>(&mut self, view: &View<S>) {
        (self.rays, self.width) = (Rays::new(view), view.width as usize);
        let count = self.width * view.height as usize;
        self.left.clear();
        self.left.resize(count, 1.0);
        self.depth.clear();
        self.depth.resize(count, f32::MAX);
    }
    /// Puts a box behind those that there are.
    pub fn put<V: Vector>(&mut self, bounds: &Aabb<V>, faces: &CubeFaces) {
        dim(&self.rays, self.width, bounds, faces, (&mut self.left, &mut self.depth));
    }
    /// The samples of a tile of 8×4, among some of the image, at which something shows that begins at a
    /// depth, `1/w`. Bit `8 y + x`.
    pub fn open(&self, tile: PyramidCell, among: PixelRect, nearest: f32) -> u32 {
        let (x, y) = (u32::from(tile.x) * 8, u32::from(tile.y) * 4);
        let mut open = 0;
        for row in among.y0.max(y)..among.y1.min(y + 4) {
            for column in among.x0.max(x)..among.x1.min(x + 8) {
                let at = row as usize * self.width + column as usize;
                // Equal depths show: what begins there may be before the box.
                let is_full = self.left[at] < FULL && nearest < self.depth[at];
                open |= u32::from(!is_full) << (8 * (row - y) + column - x);
            }
        }
        open
    }
}
