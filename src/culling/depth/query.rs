//! Is a box hidden by what is drawn so far? (Georges 1995, Section 3.2.)
//!
//! The at most four cells of the z-pyramid that cover the box's screen rectangle hold the farthest depths
//! there. Where a box begins behind a cell's it is hidden; else the four cells below are asked that it
//! touches, down to the pixels.
//!
//! Departures: the paper projects each face toward the eye and compares the depth of its nearest vertex. Here
//! a box is asked by its planes ([`super::planes`]): over each cell they say where it begins at the nearest,
//! and whether it reaches the cell at all. That is nearer to the truth than a vertex, and there are no images
//! of faces to be made. Its nearest corner is compared first, which decides for most of what is hidden, and
//! only where it does not are the planes found. A cell that the box covers, beginning nearer than the
//! farthest thing in it, ends the descent: some pixel of it shows the box.
//!
//! Conservative at every pixel: what the box holds is drawn within [`crate::geometry::MARGIN_PX`] of its
//! image, hence in its screen rectangle; there its fragments are no nearer than [`Over::up`] says (the
//! argument is in [`super::planes`]), and it has none where [`Over::meets`] says so. Depths that are equal
//! count as visible, since ids then decide. A box out of view is recognized by the bound that also keeps its
//! contents undrawn ([`crate::geometry::Frustum::excludes`]). Of a primitive that several boxes share, one of
//! them holds the point that a fragment shows ([`super::planes`] calls it `X`), so each box answers for its
//! own image; how near it may come is taken from the box of all that is drawn with it.
//!
//! Cost: a box out of view takes one test of six planes at a time; one in view eight corners in SIMD and four
//! cells where they decide; at worst the pixels along its outline.

use super::answer::{Answer, Summary};
use super::buffer::{Buffer, Step};
use super::faces::Faces;
use super::planes::{Over, Planes, below, middle};
use crate::geometry::{Aabb, PixelRect};
use crate::raster::{Outcome, PyramidCell, Read};

/// Receives what a query reads, in order. It returns nothing, so a query with a listener and one without are
/// the same.
pub trait Listener {
    /// A cell is about to be compared with the box.
    fn compares(&mut self);
    /// The tile of a cell was out of date and is being brought up to date.
    fn refreshes(&mut self, cell: PyramidCell);
    /// A cell was compared with the box.
    fn reads(&mut self, read: Read);
}

/// Planes of a box, and of the whole if that is another one.
#[derive(Clone, Copy)]
struct Both {
    bounds: Planes,
    whole: Option<Planes>,
}

/// One query.
pub struct Query<'a, S: Faces, L> {
    /// What is drawn so far.
    buffer: &'a mut Buffer<S>,
    /// What receives the reads.
    listener: L,
    /// No nearer than that.
    nearest: f32,
    summary: Summary,
    /// The pixels that are asked for.
    pixels: PixelRect,
    /// A box, and the box of all that is drawn with what it holds; `None` for all of the pixels.
    asked: Option<[&'a Aabb<S::Vector>; 2]>,
    /// Their planes, once they are needed.
    planes: Option<Both>,
}

impl<'a, S: Faces, L: Listener> Query<'a, S, L> {
    /// A query for something that comes no nearer than a depth, `1/w`.
    pub fn new(buffer: &'a mut Buffer<S>, nearest: f32, listener: L) -> Self {
        let (summary, pixels) = (Summary::default(), PixelRect::default());
        Self { buffer, listener, nearest, summary, pixels, asked: None, planes: None }
    }

    /// Asks for a box by its planes at some of its pixels. `whole`: the box of all that is drawn with what
    /// it holds, which says how near that comes.
    #[inline]
    pub fn planes(
        mut self,
        bounds: &'a Aabb<S::Vector>,
        whole: &'a Aabb<S::Vector>,
        pixels: PixelRect,
    ) -> Answer {
        self.asked = Some([bounds, whole]);
        self.rectangle(pixels)
    }
    /// Asks for a rectangle of pixels.
    pub fn rectangle(mut self, pixels: PixelRect) -> Answer {
        self.pixels = pixels;
        // What covers no pixel's center cannot show.
        let is_hidden = pixels.is_empty() || self.is_behind_all();
        self.summary.answer(is_hidden, self.nearest)
    }

    /// Whether nothing of it shows at any of the pixels.
    fn is_behind_all(&mut self) -> bool {
        // A departure from Section 3.2, which begins at "the single finest resolution pixel in the pyramid
        // that still completely covers the bounding box area": what lies across a border of large cells
        // would begin far up.
        let (first, last) = self.buffer.pyramid().cover(self.pixels);
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                let cell = PyramidCell { level: first.level, x, y };
                // Where the nearest corner does not decide, the planes are asked.
                let mut known = [self.nearest, -1.0];
                if self.nearest >= self.buffer.farthest(cell) {
                    let pixels = self.pixels_of(cell);
                    let over = self.of_cells(&middle(cell), [pixels; 4]);
                    if !over.meets[0] {
                        continue;
                    }
                    known = [over.up[0], over.fills[0]];
                }
                // One cell that it may be seen in is enough.
                if !self.behind(cell, known) {
                    return false;
                }
            }
        }
        true
    }

    /// What is known of the box over four cells of a level, given by their middles.
    #[inline]
    fn of_cells(&mut self, (middles, half): &([[f32; 4]; 2], f32), pixels: [PixelRect; 4]) -> Over {
        let nearest = self.nearest;
        let Some([bounds, whole]) = self.asked else {
            let r = self.pixels;
            let holds = |c: PixelRect| c.x0 >= r.x0 && c.x1 <= r.x1 && c.y0 >= r.y0 && c.y1 <= r.y1;
            let fills = pixels.map(|c| if holds(c) { nearest } else { -1.0 });
            return Over { meets: [true; 4], up: [nearest; 4], fills };
        };
        let rays = self.buffer.rays();
        let planes = self.planes.get_or_insert_with(|| Both {
            bounds: Planes::new(rays, bounds),
            whole: (whole != bounds).then(|| Planes::new(rays, whole)),
        });
        let over = planes.bounds.over(middles, *half, nearest);
        // A shared primitive is drawn as a whole, and the part outside the cube may come nearer; but where
        // this box does not reach, the other cubes answer for it.
        let up = planes.whole.map_or(over.up, |w| w.over(middles, *half, nearest).up);
        Over { up, ..over }
    }

    /// Whether nothing of the box shows in a cell: `up` and `fills` of [`Over`] there.
    fn behind(&mut self, cell: PyramidCell, [up, fills]: [f32; 2]) -> bool {
        self.listener.compares();
        let mut held = self.buffer.farthest(cell);
        // A stale cell holds too far a depth: what is behind it is hidden all the same, and only what is not
        // is worth a refresh.
        if up >= held && self.buffer.pyramid().is_stale(cell) {
            self.listener.refreshes(cell);
            self.buffer.step(Step::Refresh(cell));
            held = self.buffer.farthest(cell);
        }
        // Section 3.2: obscured if "the closest face z is further than the sample z". Depths are 1/w, so
        // farther is less. Equal depths count as seen, since ids then decide.
        let outcome = if up < held {
            Outcome::Behind
        } else if cell.level == 0 || fills >= held && self.is_known(cell) {
            Outcome::Shows
        } else {
            Outcome::Descends
        };
        let read = Read { cell, held, nearest: up, outcome };
        self.listener.reads(read);
        self.summary.take(&read);
        match outcome {
            Outcome::Behind => true,
            Outcome::Shows => false,
            Outcome::Descends => self.below(cell),
        }
    }

    /// Whether nothing of the box shows in the cells below one.
    fn below(&mut self, cell: PyramidCell) -> bool {
        // "Descending to higher resolutions and seeing if all samples the face intersects are closer."
        // A cell that the box does not touch cannot show it: "the face may not necessarily overlap the
        // particular maximum-depth pixel". Beyond the edge of the image a cell has no pixel to touch.
        let children = [0, 1, 2, 3].map(|k| PyramidCell {
            level: cell.level - 1,
            x: cell.x * 2 + (k & 1),
            y: cell.y * 2 + (k >> 1),
        });
        let pixels = children.map(|c| self.pixels_of(c));
        let over = self.of_cells(&below(cell), pixels);
        for k in 0..4 {
            if !over.meets[k] || pixels[k].intersection(self.pixels).is_empty() {
                continue;
            }
            if !self.behind(children[k], [over.up[k], over.fills[k]]) {
                return false;
            }
        }
        true
    }
    /// Whether the depth of a cell is that of a pixel of it. Above the tiles it may be out of date.
    fn is_known(&self, cell: PyramidCell) -> bool {
        cell.level <= TILE_LEVEL && !self.buffer.pyramid().is_stale(cell)
    }
    #[inline]
    fn pixels_of(&self, cell: PyramidCell) -> PixelRect {
        let target = self.buffer.target();
        cell.pixels(target.width, target.height)
    }
}

/// The highest level whose cells know when they are stale.
const TILE_LEVEL: u8 = 4;
