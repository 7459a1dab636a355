//! Is a box hidden by what is drawn so far? (Georges 1995, Section 3.2.)
//!
//! First the at most four cells that cover the box's screen rectangle, and where one does not decide, those
//! of the next two levels in it: what lies behind all of them is hidden, which decides for most of what is.
//! Then, for each face of the box that faces the eye: the finest cell of the z-pyramid that covers the face's
//! screen rectangle holds the farthest depth there. If the box's nearest point lies behind it, the face is
//! hidden; else the four cells below are asked that the face touches, down to the pixels that it covers.
//!
//! Departures: the depth that is compared is that of the box's nearest corner for every face (the paper takes
//! each face's own nearest vertex). Mostly it is the same corner; where it is not, a triangle that the
//! rasterizer snapped to its grid may come nearer than the face it shows through, but never nearer than the
//! whole box. And a cell that the face covers wholly and that is not farther ends the descent: some pixel of
//! it shows the face.
//!
//! Conservative at every pixel: what the box holds is drawn within [`crate::geometry::MARGIN_PX`] of the
//! image of the box, hence in its screen rectangle and so near to the image of one of its front faces; its
//! fragments are no nearer than the box's nearest vertex; and depths that are equal count as visible, since
//! ids then decide. A box out of view is recognized by the bound that also keeps its contents undrawn
//! ([`crate::geometry::Frustum::excludes`]). Cost: a box out of view takes one test of six planes at a time;
//! one in view eight corners in SIMD and four cells where they decide; at worst the pixels along the outlines
//! of its faces.

use super::buffer::{Buffer, Step};
use super::faces::{FaceImage, Faces, footprint};
use crate::geometry::{Aabb, BoxImage, Footprint, PixelRect, View};
use crate::method::evidence::short;
use crate::raster::PyramidCell;

/// How a query ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Whether nothing of the box can be seen.
    pub is_hidden: bool,
    /// The volume's nearest depth, `1/w`.
    pub nearest: f32,
    /// Cells that were read.
    pub reads: u32,
    /// The cell that decided and the depth it holds: of the hidden ones the one with the least margin, or the
    /// one that shows the box. `None` where no cell was read: the box covers no pixel.
    pub decisive: Option<(PyramidCell, f32)>,
}

impl Answer {
    /// Takes in what another part of the image says.
    pub fn join(&mut self, other: &Self) {
        self.reads += other.reads;
        // Depths are 1/w. A cell that shows the box holds no more than the box's nearest depth, and one that
        // hides it more: the least of all shows the box, or else hides it by the least margin.
        let decides = match (self.decisive, other.decisive) {
            (Some((_, a)), Some((_, b))) => b < a,
            (None, b) => b.is_some(),
            (_, None) => false,
        };
        if decides {
            self.decisive = other.decisive;
        }
    }
}

/// How a cell compared with a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The face lies behind all that is drawn in the cell.
    Behind,
    /// It may not; the cells below are asked.
    Descends,
    /// A pixel that the face covers shows nothing nearer.
    Shows,
}

impl Outcome {
    /// One word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Behind => "behind",
            Self::Descends => "descend",
            Self::Shows => "visible",
        }
    }
}

/// A cell of the pyramid was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Read {
    /// Number of the face among those that face the eye; `None` for the rectangle of the whole box.
    pub face: Option<u8>,
    /// The cell.
    pub cell: PyramidCell,
    /// Its farthest depth and the box's nearest, `1/w`.
    pub held: f32,
    pub nearest: f32,
    /// What followed.
    pub outcome: Outcome,
}

impl Read {
    /// The comparison as it is written beside a cell, such as `face 6, cell 9: not behind, descend`.
    pub fn comparison(&self) -> String {
        let then = match self.outcome {
            Outcome::Behind => "behind",
            Outcome::Descends => "not behind, descend",
            Outcome::Shows => "not behind: visible",
        };
        let what = if self.face.is_some() { "face" } else { "box" };
        format!("{what} {}, cell {}: {then}", short(1.0 / self.nearest), short(1.0 / self.held))
    }
}

/// Where a query stands: each is about to happen, or has just been decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// A cell over the rectangle of the whole box is compared.
    Whole,
    /// All of these hide it: nothing of the box can be seen.
    WholeHides,
    /// The next face of the box.
    Face,
    /// The finest cell that covers it is found.
    Finest,
    /// Whether the face is behind that cell is asked, or has been answered.
    AskFace,
    /// A face may be seen, and so may the box.
    Seen,
    /// No face can be seen.
    Hidden,
    /// A face and a cell of the descent.
    Descent,
    /// They are compared.
    Compare,
    /// The cell hides the face.
    Hides,
    /// It does not; whether it shows the face is asked.
    Covers,
    /// It shows it.
    Shows,
    /// The next cell below it.
    Below,
    /// Whether the face is behind that one is asked, or has been answered.
    AskBelow,
    /// One of the cells below shows the face.
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
    /// A cell was compared with a face.
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

/// What is drawn so far, to be read and perhaps to be brought up to date.
pub trait Held<S: Faces> {
    fn buffer(&self) -> &Buffer<S>;
    /// Whether the tile of a cell is stale and may be brought up to date.
    fn would_refresh(&self, cell: PyramidCell) -> bool;
    fn refresh(&mut self, cell: PyramidCell);
}

impl<S: Faces> Held<S> for &mut Buffer<S> {
    fn buffer(&self) -> &Buffer<S> {
        self
    }
    #[inline]
    fn would_refresh(&self, cell: PyramidCell) -> bool {
        self.pyramid().is_stale(cell)
    }
    fn refresh(&mut self, cell: PyramidCell) {
        self.step(Step::Refresh(cell));
    }
}

/// For several threads at once; what is stale stays so.
impl<S: Faces> Held<S> for &Buffer<S> {
    fn buffer(&self) -> &Buffer<S> {
        self
    }
    fn would_refresh(&self, _: PyramidCell) -> bool {
        false
    }
    fn refresh(&mut self, _: PyramidCell) {}
}

/// Whether a box is hidden by what is drawn for the buffer's view, by its front faces; `None` if it lies
/// outside the view. A box that reaches the near plane is not hidden.
#[inline]
pub fn hides<S: Faces>(
    buffer: impl Held<S>,
    bounds: &Aabb<S::Vector>,
    listener: impl Listener,
) -> Option<Answer> {
    let seen = buffer.buffer().projected()?;
    // All planes at a time, by the bound that keeps primitives out of the image.
    if seen.frustum.excludes(bounds) {
        return None;
    }
    let view = seen.view;
    match footprint(&view, &seen.projection, bounds) {
        Footprint::Outside => None,
        Footprint::CrossesNear => {
            // No finite rectangle bounds what reaches the near plane, so no cell can decide.
            Some(Answer { is_hidden: false, nearest: 1.0 / view.eye.near, reads: 0, decisive: None })
        }
        Footprint::Seen(image) => {
            Some(Query::new(buffer, image.nearest, listener).faces(bounds, &image, &view))
        }
    }
}

/// One query.
pub struct Query<S: Faces, B: Held<S>, L> {
    /// What is drawn so far.
    pub buffer: B,
    /// What receives the reads.
    pub listener: L,
    pub answer: Answer,
    space: std::marker::PhantomData<S>,
}

impl<S: Faces, B: Held<S>, L: Listener> Query<S, B, L> {
    pub fn new(buffer: B, nearest: f32, listener: L) -> Self {
        let answer = Answer { is_hidden: true, nearest, reads: 0, decisive: None };
        Self { buffer, listener, answer, space: std::marker::PhantomData }
    }

    /// Asks for a box by its front faces, each as it is projected.
    pub fn faces(self, bounds: &Aabb<S::Vector>, image: &BoxImage, view: &View<S>) -> Answer {
        self.faces_in(bounds, image, view, PixelRect { x0: 0, x1: view.width, y0: 0, y1: view.height })
    }
    /// The same within a window of the image.
    pub fn faces_in(
        mut self,
        bounds: &Aabb<S::Vector>,
        image: &BoxImage,
        view: &View<S>,
        window: PixelRect,
    ) -> Answer {
        // A departure: first the few cells over the whole box, which decide for most of what is hidden.
        // It may decide: the box's pixels are those within `MARGIN_PX` of its image, and so hold every pixel
        // where something in the box can show.
        if self.behind_whole(image.pixels.intersection(window)) {
            self.listener.reaches(At::WholeHides);
            return self.answer;
        }
        // Section 3.2: "if all faces are invisible, the cube's contents can be disregarded". Only faces
        // toward the eye can be seen; the others lie behind them.
        let (faces, count) = S::front(bounds, view.eye.position);
        for (number, face) in faces[..count].iter().enumerate() {
            self.listener.reaches(At::Face);
            // Each face's pixels have the same margin: what is drawn near to the box's image is near to that
            // of one of these faces, so nothing is lost between them.
            let mut face = S::image(*face, image, view.width, view.height);
            face.pixels = face.pixels.intersection(window);
            // One face that may be seen is enough.
            if !self.face(number as u8, &face) {
                self.listener.reaches(At::Seen);
                return self.answer;
            }
        }
        self.listener.reaches(At::Hidden);
        self.answer
    }

    /// Asks for one face.
    pub fn face(&mut self, number: u8, face: &FaceImage) -> bool {
        // A face without a pixel's center cannot show.
        if !face.pixels.is_empty() {
            // Section 3.2: "the single finest resolution pixel in the pyramid that still completely covers
            // the bounding box area".
            self.listener.reaches(At::Finest);
            let cell = self.buffer.buffer().pyramid().finest_over(face.pixels);
            self.listener.reaches(At::AskFace);
            self.answer.is_hidden &= self.behind(number, face, cell);
            self.listener.reaches(At::AskFace);
        }
        self.answer.is_hidden
    }

    /// Whether a rectangle that holds the box's image lies behind the at most four cells that cover it, or
    /// those a little below.
    fn behind_whole(&mut self, pixels: PixelRect) -> bool {
        if pixels.is_empty() {
            return true;
        }
        let (first, last) = self.buffer.buffer().pyramid().cover(pixels);
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                if !self.behind_part(pixels, PyramidCell { level: first.level, x, y }, FINER) {
                    // The cells found so far hide parts of the rectangle, which decides nothing.
                    self.answer.decisive = None;
                    return false;
                }
            }
        }
        true
    }
    /// Whether the part of the rectangle inside a cell lies behind the cell's depth, descending at most
    /// `finer` levels.
    fn behind_part(&mut self, pixels: PixelRect, cell: PyramidCell, finer: u8) -> bool {
        self.listener.reaches(At::Whole);
        let held = self.look_at(cell);
        let nearest = self.answer.nearest;
        // Conservative in rounding: `nearest` is rounded to f32 as fragments are, which keeps the order, so
        // no fragment of the contents exceeds it; and the cell holds a depth that no pixel under it is
        // farther than.
        let outcome = if nearest < held { Outcome::Behind } else { Outcome::Descends };
        self.listener.reads(Read { face: None, cell, held, nearest, outcome });
        if outcome == Outcome::Behind {
            self.least(cell, held);
            return true;
        }
        if finer == 0 || cell.level == 0 {
            return false;
        }
        let level = cell.level - 1;
        // Of the two children along an axis those that the rectangle meets.
        let along = |at: u16, first: u32, past: u32| {
            (2 * at).max((first >> level) as u16)..=(2 * at + 1).min(((past - 1) >> level) as u16)
        };
        for y in along(cell.y, pixels.y0, pixels.y1) {
            for x in along(cell.x, pixels.x0, pixels.x1) {
                if !self.behind_part(pixels, PyramidCell { level, x, y }, finer - 1) {
                    return false;
                }
            }
        }
        true
    }
    /// What the pyramid holds for a cell, brought up to date where that could decide.
    #[inline]
    fn look_at(&mut self, cell: PyramidCell) -> f32 {
        self.answer.reads += 1;
        let held = self.buffer.buffer().farthest(cell);
        // A stale cell holds too far a depth: what is behind it is hidden all the same, and only what is not
        // is worth a refresh.
        if self.answer.nearest >= held && self.buffer.would_refresh(cell) {
            self.listener.refreshes(cell);
            self.buffer.refresh(cell);
            return self.buffer.buffer().farthest(cell);
        }
        held
    }
    /// Keeps the cell with the least margin.
    #[inline]
    fn least(&mut self, cell: PyramidCell, held: f32) {
        if self.answer.decisive.is_none_or(|(_, least)| held < least) {
            self.answer.decisive = Some((cell, held));
        }
    }

    /// Whether the face lies behind all that is drawn in a cell.
    fn behind(&mut self, number: u8, face: &FaceImage, cell: PyramidCell) -> bool {
        self.listener.reaches(At::Descent);
        self.listener.reaches(At::Compare);
        let held = self.look_at(cell);
        let nearest = self.answer.nearest;
        // Section 3.2: obscured if "the closest face z is further than the sample z". Depths are 1/w, so
        // farther is less. Equal depths count as seen, since ids then decide.
        let outcome = if nearest < held {
            Outcome::Behind
        } else if cell.level == 0 || cell.level <= TILE_LEVEL && face.covers(self.pixels(cell)) {
            Outcome::Shows
        } else {
            Outcome::Descends
        };
        self.listener.reads(Read { face: Some(number), cell, held, nearest, outcome });
        if outcome != Outcome::Behind {
            self.listener.reaches(At::Covers);
        }
        match outcome {
            Outcome::Behind => {
                self.listener.reaches(At::Hides);
                self.least(cell, held);
                true
            }
            Outcome::Shows => {
                self.listener.reaches(At::Shows);
                self.answer.decisive = Some((cell, held));
                false
            }
            Outcome::Descends => self.below(number, face, cell),
        }
    }

    /// Whether the face lies behind all that is drawn in the cells below one.
    fn below(&mut self, number: u8, face: &FaceImage, cell: PyramidCell) -> bool {
        // "Descending to higher resolutions and seeing if all samples the face intersects are closer."
        // A cell that the face does not touch cannot show it: "the face may not necessarily overlap the
        // particular maximum-depth pixel". Beyond the edge of the image a cell has no pixel to touch.
        for k in 0..4 {
            let child =
                PyramidCell { level: cell.level - 1, x: cell.x * 2 + (k & 1), y: cell.y * 2 + (k >> 1) };
            if !face.touches(self.pixels(child)) {
                continue;
            }
            self.listener.reaches(At::Below);
            self.listener.reaches(At::AskBelow);
            let is_behind = self.behind(number, face, child);
            self.listener.reaches(At::AskBelow);
            if !is_behind {
                self.listener.reaches(At::BelowShows);
                return false;
            }
        }
        self.listener.reaches(At::BelowHides);
        true
    }
    #[inline]
    fn pixels(&self, cell: PyramidCell) -> PixelRect {
        let target = self.buffer.buffer().target();
        cell.pixels(target.width, target.height)
    }
}

/// Levels by which the cells over a whole box are refined before its faces are queried: one look at four
/// cells takes in up to 16 times the box's rectangle, one at the cells two levels below hardly more than it.
const FINER: u8 = 2;
/// The highest level whose cells know when they are stale: below it a cell that is not farther shows a pixel;
/// above it it may only be out of date.
const TILE_LEVEL: u8 = 4;
