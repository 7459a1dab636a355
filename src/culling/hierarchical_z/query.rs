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

use super::buffer::Buffer;
use super::explain::{Evidence, Outcome, Read};
use super::space::{FaceImage, Faces};
use crate::culling::{Event, Observer};
use crate::geometry::{Aabb, BoxImage, NodeId, PixelRect, View};
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

/// One query.
pub struct Query<'a, S: Faces, B: Held<S>, O> {
    /// What is drawn so far.
    pub buffer: B,
    /// Whose box it is.
    pub node: NodeId,
    /// Who listens.
    pub watch: &'a mut O,
    /// Line of the pseudocode at which cells are compared.
    pub line: u8,
    pub answer: Answer,
    space: std::marker::PhantomData<S>,
}

impl<'a, S: Faces, B: Held<S>, O: Observer<Evidence<S>>> Query<'a, S, B, O> {
    pub fn new(buffer: B, node: NodeId, nearest: f32, line: u8, watch: &'a mut O) -> Self {
        Self { buffer, node, watch, line, answer: Answer { is_hidden: true, nearest, reads: 0, decisive: None }, space: std::marker::PhantomData }
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
            self.watch.note(|| Evidence::Refreshed(cell));
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
        let node = self.node;
        self.watch.event(Event::Line(self.line));
        self.watch.note(move || Evidence::Read(Read { node, face: number, cell, held, nearest, outcome }));
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
