//! The shape of a method, generic inside; [`super::Entry`] erases it, once a frame and never per node.

use std::sync::Arc;

use super::{Card, Knobs, Note, Observer};
use crate::drawing::Drawing;
use crate::geometry::{PrimId, Space, View};
use crate::index::Hierarchy;
use crate::raster::{
    Canvas, DepthScale, Drawable, Light, Options, StandIn, Target, averaged, paint, paint_in_order,
};
use crate::scene::{Progress, Scene};

/// What hides a thing, as far as the method knows that left it out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Hiders {
    /// Occluders, each by a primitive of it; and how many there are, of which not all may be named.
    Occluders(Vec<PrimId>, usize),
    /// What had been drawn by then, with whose depths it was compared: the opaque ones of these primitives.
    Drawn(Vec<PrimId>),
}

/// What a frame draws.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawList<S: Space> {
    /// Primitives in the order in which they are drawn; each at most once.
    pub prims: Vec<PrimId>,
    /// What is drawn in place of others, the nearest first: tested against the depths of the primitives,
    /// which it leaves as they are.
    pub stand_ins: Vec<StandIn<S::Vector>>,
    /// Whether both lists are drawn in one order instead, the farthest first, and stand-ins write depths.
    pub in_order: bool,
    /// Samples along each side of a pixel of its picture, which is their mean.
    pub samples: u32,
    /// The light under which it is to be seen.
    pub light: Light,
}

impl<S: Space> Default for DrawList<S> {
    fn default() -> Self {
        Self {
            prims: Vec::new(),
            stand_ins: Vec::new(),
            in_order: false,
            samples: 1,
            light: Light::default(),
        }
    }
}

impl<S: Space> DrawList<S> {
    /// The primitives by ascending id.
    pub fn ascending(&self) -> Vec<PrimId> {
        let mut ids = self.prims.clone();
        ids.sort_unstable();
        ids
    }
}

impl<S: Drawable> DrawList<S> {
    /// Makes a target the image of the primitives from a view, whatever it held. Stand-ins own no pixel of an
    /// item buffer: whoever shades the image paints them over it.
    pub fn redraw(&self, target: &mut Target, scene: &Scene<S>, view: &View<S>, options: &Options) {
        S::redraw(target, scene, view, &self.prims, options);
    }
    /// Makes a target that image, a pixel for each of the picture's samples, and a canvas what the stand-ins
    /// put over it: of no size where there are none, and where they are drawn in one order with the
    /// primitives.
    pub fn draw(
        &self,
        (image, canvas): (&mut Target, &mut Canvas),
        scene: &Scene<S>,
        view: &View<S>,
        options: &Options,
    ) {
        let view = &view.sampled(self.samples);
        self.redraw(image, scene, view, options);
        canvas.empty();
        if !self.stand_ins.is_empty() && !self.in_order {
            canvas.clear(view);
            canvas.composite(&self.stand_ins, image, view, options);
        }
    }
    /// The picture of all of it: RGBA, sRGB-encoded, row by row. `drawn`: its two parts drawn from that view;
    /// `shown`: the light and the background (linear).
    pub fn picture(
        &self,
        scene: &Scene<S>,
        view: &View<S>,
        drawn: (&Target, &Canvas),
        shown: (Light, [f32; 3]),
    ) -> Vec<u8> {
        let fine = view.sampled(self.samples);
        let rgba = if self.in_order && !self.stand_ins.is_empty() {
            paint_in_order(scene, &fine, (&self.prims, &self.stand_ins), shown)
        } else {
            paint(drawn.0, drawn.1, scene, &fine, shown)
        };
        if self.samples == 1 {
            return rgba;
        }
        averaged(
            &rgba,
            fine.width as usize,
            [fine.width / view.width, fine.height / view.height].map(|n| n as usize),
        )
    }
    /// The same under its own light, drawn anew.
    pub fn paint(
        &self,
        scene: &Scene<S>,
        view: &View<S>,
        options: &Options,
        background: [f32; 3],
    ) -> Vec<u8> {
        let (mut image, mut canvas) = (Target::default(), Canvas::default());
        self.draw((&mut image, &mut canvas), scene, view, options);
        self.picture(scene, view, (&image, &canvas), (self.light, background))
    }
}

/// Ends a frame from outside, such as at a deadline. Called with the primitives drawn since the last call;
/// returns true to end the frame.
pub type Limit<'a> = dyn Fn(&[PrimId]) -> bool + 'a;

/// One frame: everything that [`Method::cull`] reads and does not change.
pub struct Frame<'a, S: Space, M: Method<S>> {
    /// The index.
    pub index: &'a M::Index,
    /// The scene.
    pub scene: &'a Scene<S>,
    /// What is culled for.
    pub view: &'a View<S>,
    /// Parameters.
    pub params: &'a M::Params,
    /// What may end the frame early; a method that cannot be ended does not call it.
    pub limit: Option<&'a Limit<'a>>,
}

// Derived, they would ask the same of `M`.
impl<S: Space, M: Method<S>> Clone for Frame<'_, S, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Space, M: Method<S>> Copy for Frame<'_, S, M> {}

/// One culling method in one space.
pub trait Method<S: Space>: Sized + Send + Sync + 'static {
    /// Parameters.
    type Params: Default + Clone + PartialEq + Send + Sync;
    /// Built once per scene and parameters.
    type Index: Hierarchy<S> + 'static;
    /// What it keeps from frame to frame.
    type Memory: Default + Clone + Send;
    /// Large state of one frame (a pyramid, a queue), which a film replays; `()` if there is none.
    type State: State<S, Self>;
    /// Its evidence.
    type Note: Note<S>;
    /// Identity.
    const CARD: Card;

    /// Declares every parameter, once.
    fn knobs(params: &mut Self::Params, knobs: &mut dyn Knobs);
    /// Scene to index, around the bytes of [`Hierarchy::save`] if there are any; `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// Why the bytes do not fit the scene and the parameters. Without bytes there are none.
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Self::Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String>;
    /// Brings the index to another frame of the scene that it was built of, in which only points differ, and
    /// the memory to the index. `None` when cancelled; then nothing of them is of use. By default the index
    /// is built anew and the memory, which is of its nodes, is lost. A method that keeps its nodes builds the
    /// same index whatever frames came between.
    fn moved(
        index: &mut Arc<Self::Index>,
        memory: &mut Self::Memory,
        scene: &Arc<Scene<S>>,
        params: &Self::Params,
        progress: &dyn Progress,
    ) -> Option<()> {
        // Without saved bytes nothing can be wrong with them.
        *index = Arc::new(Self::build(scene, params, None, progress).ok().flatten()?);
        *memory = Self::Memory::default();
        Some(())
    }
    /// The method. There is no second copy of this function. `state` is at its beginning.
    fn cull<O: Observer<Self::Note>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Self::Memory,
        state: &mut Self::State,
        out: &mut DrawList<S>,
        watch: &mut O,
    );
    /// Whether with these parameters its answer includes every visible primitive.
    fn is_conservative(_: &Self::Params) -> bool {
        Self::CARD.conservative
    }
    /// Whether line `line` of the pseudocode belongs to these parameters; the others are not shown. Each
    /// that belongs to them is reached in some frame.
    fn has_line(_: &Self::Params, _line: u8) -> bool {
        true
    }
}

/// Refuses a saved preprocess, for methods that keep none.
///
/// # Errors
/// If there is one.
pub(crate) fn keeps_nothing(saved: Option<&[u8]>) -> Result<(), String> {
    saved.map_or(Ok(()), |_| Err("this method keeps no preprocess".into()))
}

/// Large state of a frame. A run and its film change it by the same functions: `cull` calls what
/// [`State::apply`] calls, with the operands that the note records, and conformance tests compare both after
/// the last note.
pub trait State<S: Space, M: Method<S>>: Clone + Default + PartialEq + Send + Sync + 'static {
    /// Notes between kept copies of the state in a film: about as many as take as long to replay as a copy
    /// takes to make. Denser ones make seeking slower.
    const KEYFRAME_NOTES: usize;
    /// Brings it to the beginning of a frame; memory is reused.
    fn begin(&mut self, frame: &Frame<'_, S, M>);
    /// Lets go of what the index lends it: the index is about to follow a motion, and is not to copy itself
    /// for the sake of the last frame.
    fn release(&mut self) {}
    /// Does again what the run did when it recorded the note.
    fn apply(&mut self, scene: &Scene<S>, note: &M::Note);
}

impl<S: Space, M: Method<S>> State<S, M> for () {
    const KEYFRAME_NOTES: usize = usize::MAX;
    fn begin(&mut self, _: &Frame<'_, S, M>) {}
    fn apply(&mut self, _: &Scene<S>, _: &M::Note) {}
}

/// A step of a film, as the method that was recorded sees it.
pub struct Moment<'a, S: Space, M: Method<S>> {
    /// The frame.
    pub frame: Frame<'a, S, M>,
    /// Its large state.
    pub state: &'a M::State,
    /// The evidence so far.
    pub notes: &'a [M::Note],
    /// The evidence that this step is about: it was just recorded, or it is that of the decision just made.
    pub note: Option<&'a M::Note>,
}

/// How a method is shown.
pub trait Shown<S: Space>: Method<S> {
    /// Draws, in world coordinates, what is private to the method at a step: its large state, and the
    /// evidence of the current note.
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>);
    /// What has been drawn up to a step, of a method that stands something for primitives; `None` for one
    /// that draws primitives alone, of which verdicts tell.
    fn drawn(_: &Moment<'_, S, Self>) -> Option<DrawList<S>> {
        None
    }
    /// What hides what is left out as hidden on the ground of `notes[at]`, of all notes of the frame; `None`
    /// where the method cannot tell, or it is no primitive.
    fn hiders(_: &Frame<'_, S, Self>, _notes: &[Self::Note], _at: usize) -> Option<Hiders> {
        None
    }
    /// Names of the method's pictures that are not of the world, such as of its image-space structures.
    const PICTURES: &'static [&'static str] = &[];
    /// Draws picture `which < PICTURES.len()` at a step, in paper coordinates with its size.
    fn picture(_: &Moment<'_, S, Self>, _which: usize, _scale: DepthScale) -> Drawing {
        Drawing::default()
    }
    /// What is under a point of that picture, in words.
    fn probe(_: &Moment<'_, S, Self>, _which: usize, _at: glam::Vec2) -> Option<String> {
        None
    }
    /// What follows from a parameter for the image of this frame, such as numbers that a paper derives from
    /// it; `None` if nothing does.
    fn derived(_: &Frame<'_, S, Self>) -> Option<Derived> {
        None
    }
}

/// What follows from a parameter, as a table for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Derived {
    /// Name of the parameter beside which it is shown.
    pub knob: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Headings, then the rows, each as long as these.
    pub rows: Vec<Vec<String>>,
    /// A sentence or two about it.
    pub note: String,
}
