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

use super::buffer::{Buffer, Step};
use super::faces::{Faces, footprint};
use super::planes::{Over, Planes, below, middle};
use crate::geometry::{Aabb, Footprint, PixelRect};
use crate::raster::{Outcome, PyramidCell, Read};

/// A cell that decided, and the two depths that were compared there, `1/w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decisive {
    pub cell: PyramidCell,
    /// The farthest depth that it holds.
    pub held: f32,
    /// The nearest at which what was asked for begins in it.
    pub nearest: f32,
}

impl Decisive {
    /// The cell of a read.
    pub(super) fn of(read: &Read) -> Self {
        Self { cell: read.cell, held: read.held, nearest: read.nearest }
    }
    /// By how much the cell hides it, `1/w`; negative or 0 if it does not.
    pub(super) fn margin(&self) -> f32 {
        self.held - self.nearest
    }
}

/// How a query ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Whether nothing of the box can be seen.
    pub is_hidden: bool,
    /// The volume's nearest depth, `1/w`.
    pub nearest: f32,
    /// Cells that were read.
    pub reads: u32,
    /// The cell that decided: the one that shows the box, or of those that hide it the one with the least
    /// margin. `None` where none decided: the box covers no pixel.
    pub decisive: Option<Decisive>,
}

impl Answer {
    /// Takes in what another part of the image says.
    pub fn join(&mut self, other: &Self) {
        self.reads += other.reads;
        // A cell that shows the box has no margin, and one that hides it has: the least of all shows the box,
        // or else hides it by the least.
        let decides = match (self.decisive, other.decisive) {
            (Some(a), Some(b)) => b.margin() < a.margin(),
            (None, b) => b.is_some(),
            (_, None) => false,
        };
        if decides {
            self.decisive = other.decisive;
        }
    }
}

/// Where a query stands: each is about to happen, or has just been decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// The next of the cells over the box.
    Cell,
    /// Whether the box is behind it is asked, or has been answered.
    AskCell,
    /// The box may be seen.
    Seen,
    /// It cannot.
    Hidden,
    /// A cell of the descent.
    Descent,
    /// It is compared.
    Compare,
    /// The cell hides the box.
    Hides,
    /// It does not; whether it shows the box is asked.
    Covers,
    /// It shows it.
    Shows,
    /// The next cell below it.
    Below,
    /// Whether the box is behind that one is asked, or has been answered.
    AskBelow,
    /// One of the cells below shows the box.
    BelowShows,
    /// None does.
    BelowHides,
}

/// Receives what a query reads, in order. It returns nothing, so a query with a listener and one without are
/// the same.
pub trait Listener {
    /// The query has come so far.
    #[inline(always)]
    fn reaches(&mut self, _: At) {}
    /// The tile of a cell was out of date and is being brought up to date.
    fn refreshes(&mut self, cell: PyramidCell);
    /// A cell was compared with the box.
    fn reads(&mut self, read: Read);
}

/// Nobody listens; compiles to nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nobody;

impl Listener for Nobody {
    #[inline(always)]
    fn refreshes(&mut self, _: PyramidCell) {}
    #[inline(always)]
    fn reads(&mut self, _: Read) {}
}

/// Whether a box is hidden by what is drawn for the buffer's view, by its planes; `None` if it lies outside
/// the view. A box that reaches the near plane is not hidden.
#[inline]
pub fn hides<S: Faces>(
    buffer: &mut Buffer<S>,
    bounds: &Aabb<S::Vector>,
    listener: impl Listener,
) -> Option<Answer> {
    let seen = buffer.projected()?;
    // All planes at a time, by the bound that keeps primitives out of the image.
    if seen.frustum.excludes(bounds) {
        return None;
    }
    let view = &seen.view;
    match footprint(view, &seen.projection, bounds) {
        Footprint::Outside => None,
        Footprint::CrossesNear => {
            // No finite rectangle bounds what reaches the near plane, so no cell can decide.
            Some(Answer { is_hidden: false, nearest: 1.0 / view.eye.near, reads: 0, decisive: None })
        }
        Footprint::Seen(image) => {
            Some(Query::new(buffer, image.nearest, listener).planes(bounds, bounds, image.pixels))
        }
    }
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
    answer: Answer,
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
        let answer = Answer { is_hidden: true, nearest, reads: 0, decisive: None };
        Self { buffer, listener, answer, pixels: PixelRect::default(), asked: None, planes: None }
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
        self.over(pixels);
        self.answer
    }
    /// Asks for a rectangle of pixels.
    pub fn rectangle(mut self, pixels: PixelRect) -> Answer {
        self.over(pixels);
        self.answer
    }

    fn over(&mut self, pixels: PixelRect) {
        self.pixels = pixels;
        // What covers no pixel's center cannot show.
        if pixels.is_empty() {
            return;
        }
        // A departure from Section 3.2, which begins at "the single finest resolution pixel in the pyramid
        // that still completely covers the bounding box area": what lies across a border of large cells
        // would begin far up.
        let (first, last) = self.buffer.pyramid().cover(pixels);
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                let cell = PyramidCell { level: first.level, x, y };
                // Where the nearest corner does not decide, the planes are asked.
                let mut known = [self.answer.nearest, -1.0];
                if self.answer.nearest >= self.buffer.farthest(cell) {
                    let pixels = self.pixels_of(cell);
                    let over = self.of_cells(&middle(cell), [pixels; 4]);
                    if !over.meets[0] {
                        continue;
                    }
                    known = [over.up[0], over.fills[0]];
                }
                self.listener.reaches(At::Cell);
                self.listener.reaches(At::AskCell);
                let is_behind = self.behind(cell, known);
                self.listener.reaches(At::AskCell);
                // One cell that it may be seen in is enough.
                if !is_behind {
                    self.answer.is_hidden = false;
                    self.listener.reaches(At::Seen);
                    return;
                }
            }
        }
        self.listener.reaches(At::Hidden);
    }

    /// What is known of the box over four cells of a level, given by their middles.
    #[inline]
    fn of_cells(&mut self, (middles, half): &([[f32; 4]; 2], f32), pixels: [PixelRect; 4]) -> Over {
        let nearest = self.answer.nearest;
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
        self.listener.reaches(At::Descent);
        self.listener.reaches(At::Compare);
        self.answer.reads += 1;
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
        self.listener.reads(Read { cell, held, nearest: up, outcome });
        if outcome != Outcome::Behind {
            self.listener.reaches(At::Covers);
        }
        let here = Decisive { cell, held, nearest: up };
        match outcome {
            Outcome::Behind => {
                self.listener.reaches(At::Hides);
                // Kept is the cell with the least margin.
                if self.answer.decisive.is_none_or(|least| here.margin() < least.margin()) {
                    self.answer.decisive = Some(here);
                }
                true
            }
            Outcome::Shows => {
                self.listener.reaches(At::Shows);
                self.answer.decisive = Some(here);
                false
            }
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
            self.listener.reaches(At::Below);
            self.listener.reaches(At::AskBelow);
            let is_behind = self.behind(children[k], [over.up[k], over.fills[k]]);
            self.listener.reaches(At::AskBelow);
            if !is_behind {
                self.listener.reaches(At::BelowShows);
                return false;
            }
        }
        self.listener.reaches(At::BelowHides);
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
