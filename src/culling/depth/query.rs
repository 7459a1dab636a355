//! Is a box hidden by what is drawn so far? (Georges 1995, Section 3.2.)
//!
//! For each face of the box that faces the eye: the finest cell of the z-pyramid that covers the face's screen
//! rectangle holds the farthest depth there. If the box's nearest point lies behind it, the face is hidden; else the
//! four cells below are asked that the face touches, down to the pixels that it covers.
//!
//! Departures: the depth that is compared is that of the box's nearest corner for every face (the paper takes each
//! face's own nearest vertex). Mostly it is the same corner; where it is not, a triangle that the rasterizer snapped to
//! its grid may come nearer than the face it shows through, but never nearer than the whole box. And a cell that the
//! face covers wholly and that is not farther ends the descent: some pixel of it shows the face.
//!
//! Conservative at every pixel: what the box holds is drawn within [`crate::geometry::MARGIN_PX`] of the image of
//! the box, hence of one of its front faces, and its fragments are no nearer than its nearest vertex; depths that are
//! equal count as visible, since ids then decide.
//! Cost: a few cells where coarse levels decide; at worst the pixels along the face's outline.

use super::{Buffer, FaceImage, Faces, footprint};
use crate::culling::evidence::short;
use crate::geometry::{Aabb, BoxImage, Footprint, PixelRect, View};
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
    /// The cell that decided and the depth it holds: of the hidden ones the one with the least margin, or the one that
    /// shows the box. `None` where no cell was read: the box covers no pixel.
    pub decisive: Option<(PyramidCell, f32)>,
}

impl Answer {
    /// Takes in what another part of the image says.
    pub fn join(&mut self, other: &Self) {
        self.reads += other.reads;
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
    /// Number of the face among those that face the eye.
    pub face: u8,
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
        format!("face {}, cell {}: {then}", short(1.0 / self.nearest), short(1.0 / self.held))
    }
}

/// Who hears what a query reads, in order. It cannot answer, so a query that is heard and one that is not are the same.
pub trait Listener {
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
        Buffer::refresh(self, cell);
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

/// Whether a box is hidden by what is drawn for the buffer's view, by its front faces; `None` if it lies outside the view. A box
/// that reaches the near plane is not hidden.
pub fn hides<S: Faces>(buffer: impl Held<S>, bounds: &Aabb<S::Vector>, listener: impl Listener) -> Option<Answer> {
    let (view, projection) = *buffer.buffer().view()?;
    match footprint(&view, &projection, bounds) {
        Footprint::Outside => None,
        Footprint::CrossesNear => Some(Answer { is_hidden: false, nearest: 1.0 / view.eye.near, reads: 0, decisive: None }),
        Footprint::Seen(image) => Some(Query::new(buffer, image.nearest, listener).faces(bounds, &image, &view)),
    }
}

/// One query.
pub struct Query<S: Faces, B: Held<S>, L> {
    /// What is drawn so far.
    pub buffer: B,
    /// Who listens.
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
    pub fn faces_in(mut self, bounds: &Aabb<S::Vector>, image: &BoxImage, view: &View<S>, window: PixelRect) -> Answer {
        let (faces, count) = S::front(bounds, view.eye.position);
        for (number, face) in faces[..count].iter().enumerate() {
            let mut face = S::image(*face, image, view.width, view.height);
            face.pixels = face.pixels.intersection(window);
            if !self.face(number as u8, &face) {
                break;
            }
        }
        self.answer
    }

    /// Asks for one face.
    pub fn face(&mut self, number: u8, face: &FaceImage) -> bool {
        if !face.pixels.is_empty() {
            let cell = self.buffer.buffer().pyramid().finest_over(face.pixels);
            self.answer.is_hidden &= self.behind(number, face, cell);
        }
        self.answer.is_hidden
    }

    /// Whether the face lies behind all that is drawn in a cell.
    fn behind(&mut self, number: u8, face: &FaceImage, cell: PyramidCell) -> bool {
        let nearest = self.answer.nearest;
        let mut held = self.buffer.buffer().farthest(cell);
        if nearest >= held && self.buffer.would_refresh(cell) {
            self.listener.refreshes(cell);
            self.buffer.refresh(cell);
            held = self.buffer.buffer().farthest(cell);
        }
        self.answer.reads += 1;
        let pixels = cell.pixels(self.buffer.buffer().target().width, self.buffer.buffer().target().height);
        let outcome = if nearest < held {
            Outcome::Behind
        } else if cell.level == 0 || cell.level <= TILE_LEVEL && face.covers(pixels) {
            Outcome::Shows
        } else {
            Outcome::Descends
        };
        self.listener.reads(Read { face: number, cell, held, nearest, outcome });
        match outcome {
            Outcome::Behind => {
                if self.answer.decisive.is_none_or(|(_, least)| held < least) {
                    self.answer.decisive = Some((cell, held));
                }
                true
            }
            Outcome::Shows => {
                self.answer.decisive = Some((cell, held));
                false
            }
            Outcome::Descends => self.below(number, face, cell),
        }
    }

    /// Whether the face lies behind all that is drawn in the cells below one.
    fn below(&mut self, number: u8, face: &FaceImage, cell: PyramidCell) -> bool {
        let (width, height) = (self.buffer.buffer().target().width, self.buffer.buffer().target().height);
        for k in 0..4 {
            let child = PyramidCell { level: cell.level - 1, x: cell.x * 2 + (k & 1), y: cell.y * 2 + (k >> 1) };
            if face.touches(child.pixels(width, height)) && !self.behind(number, face, child) {
                return false;
            }
        }
        true
    }
}

/// The highest level whose cells know when they are stale: below it a cell that is not farther shows a pixel; above it
/// it may only be out of date.
const TILE_LEVEL: u8 = 4;
