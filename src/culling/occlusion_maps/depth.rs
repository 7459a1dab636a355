//! The depth estimation buffer (Zhang et al. 1997, Section 5.2.2): for each part of the screen a depth that
//! no occluder there is farther than.
//!
//! An entry bounds all occluders whose rectangles touch it: each is taken as deep as the farthest corner of
//! its box. Depths are `1/w`, larger is nearer, so the farthest is the least. An entry that no occluder
//! touches says nothing: it holds +∞, and the overlap test alone decides there.

use crate::geometry::PixelRect;

/// The buffer.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DepthBuffer {
    columns: u32,
    rows: u32,
    /// Side of the part of the screen that an entry stands for, pixels.
    side: u32,
    entries: Vec<f32>,
}

/// What a test of the buffer found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthTest {
    /// Whether what was asked for is behind all occluders that it could overlap.
    pub is_behind: bool,
    /// The entry that decided: the first that is not nearer, or else the farthest.
    pub entry: [u32; 2],
    /// What it holds.
    pub held: f32,
    /// Entries that were read.
    pub reads: u32,
}

impl DepthBuffer {
    /// An empty one over an image, with at most `resolution` entries along its longer side.
    pub fn clear(&mut self, [width, height]: [u32; 2], resolution: u32) {
        self.side = width.max(height).div_ceil(resolution.max(1)).max(1);
        (self.columns, self.rows) = (width.div_ceil(self.side), height.div_ceil(self.side));
        self.entries.clear();
        self.entries.resize((self.columns * self.rows) as usize, f32::INFINITY);
    }
    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }
    /// The pixels that an entry stands for, in an image of this size.
    pub fn pixels(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> PixelRect {
        let span = |at: u32, end: u32| (at * self.side, ((at + 1) * self.side).min(end));
        let ((x0, x1), (y0, y1)) = (span(x, width), span(y, height));
        PixelRect { x0, x1, y0, y1 }
    }
    /// The entries that some pixels touch.
    pub fn touched(&self, pixels: PixelRect) -> PixelRect {
        let past = |v: u32| v.div_ceil(self.side);
        PixelRect {
            x0: pixels.x0 / self.side,
            x1: past(pixels.x1),
            y0: pixels.y0 / self.side,
            y1: past(pixels.y1),
        }
    }
    /// What an entry holds.
    pub fn held(&self, [x, y]: [u32; 2]) -> f32 {
        self.entries[(y * self.columns + x) as usize]
    }
    /// Writes an occluder's farthest depth to the entries that its rectangle touches: the farther stays.
    pub fn write(&mut self, touched: PixelRect, farthest: f32) {
        for y in touched.y0..touched.y1 {
            for x in touched.x0..touched.x1 {
                let entry = &mut self.entries[(y * self.columns + x) as usize];
                *entry = entry.min(farthest);
            }
        }
    }
    /// Whether something in these entries, no nearer than a depth, is behind all occluders. As deep is not
    /// behind: a flat occluder that faces the eye is as deep as itself.
    pub fn test(&self, touched: PixelRect, nearest: f32) -> DepthTest {
        let mut found =
            DepthTest { is_behind: true, entry: [touched.x0, touched.y0], held: f32::INFINITY, reads: 0 };
        for y in touched.y0..touched.y1 {
            for x in touched.x0..touched.x1 {
                let held = self.held([x, y]);
                found.reads += 1;
                if held < found.held {
                    (found.entry, found.held) = ([x, y], held);
                }
                if nearest >= held {
                    return DepthTest { is_behind: false, entry: [x, y], held, ..found };
                }
            }
        }
        found
    }
}
