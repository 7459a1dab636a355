//! The shape of a method, generic inside; `entry` erases it, once a frame and never per node.

use std::sync::Arc;

use super::{Knobs, Observer, event::Tallied};
use crate::drawing::Drawing;
use crate::geometry::{PrimId, Space, View};
use crate::index::Hierarchy;
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene};

/// One line of a method's pseudocode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeLine {
    /// Procedure and line, such as `Visible:4`.
    pub label: &'static str,
    /// The text, indented by two spaces a level.
    pub text: &'static str,
}

/// Who a method is. Menus, captions, `cullscope methods` and the documentation all read this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Card {
    /// Stable key of files and the command line.
    pub key: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// Authors, title, venue, year; section.
    pub paper: &'static str,
    /// Digital object identifier, or empty.
    pub doi: &'static str,
    /// Whether its answer always includes every visible primitive.
    pub conservative: bool,
    /// Its pseudocode; `Event::Line(i)` refers to line `i`.
    pub code: &'static [CodeLine],
}

/// What a frame draws.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DrawList {
    /// Primitives in the order in which they are drawn; each at most once.
    pub prims: Vec<PrimId>,
}

impl DrawList {
    /// The primitives by ascending id.
    pub fn ascending(&self) -> Vec<PrimId> {
        let mut ids = self.prims.clone();
        ids.sort_unstable();
        ids
    }
}

/// Ends a frame from outside, such as at a deadline: told the primitives drawn since it was told last, it
/// says whether that is enough.
pub type Limit = Arc<dyn Fn(&[PrimId]) -> bool + Send + Sync>;

/// A value of a note's field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A measured number.
    Number(f64),
    /// A count or an id.
    Integer(u64),
    /// Yes or no.
    Switch(bool),
    /// A word.
    Word(String),
    /// Several numbers.
    List(Vec<f64>),
}

/// An operand or result of a test, by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Snake-case name; units last, as in `margin_units`.
    pub name: &'static str,
    /// Its value.
    pub value: Value,
}

/// A piece of evidence of a method: the operands of one test, not only its result.
pub trait Note<S: Space>: Tallied + Copy + Send + Sync + 'static {
    /// What was done, in the past tense and camel case, such as `NodeClassified`.
    fn kind(&self) -> &'static str;
    /// Operands and results by name; the trace, the inspector and comparisons read these.
    fn fields(&self) -> Vec<Field>;
    /// What was done, in a sentence or two that a student understands.
    fn sentence(&self, scene: &Scene<S>) -> String;
}

/// One culling method in one space.
pub trait Method<S: Space>: Sized + Send + Sync + 'static {
    /// Parameters.
    type Params: Default + Clone + PartialEq + Send + Sync;
    /// Built once per scene and parameters.
    type Index: Hierarchy<S> + 'static;
    /// What it keeps from frame to frame.
    type Memory: Default + Clone + Send;
    /// Its evidence.
    type Note: Note<S>;
    /// Large state that is replayed rather than recorded (a pyramid, a map); `()` if there is none.
    type Dense: Clone + Send + Sync;
    /// Identity.
    const CARD: Card;

    /// Declares every parameter, once.
    fn knobs(params: &mut Self::Params, knobs: &mut dyn Knobs);
    /// Scene to index; `None` when cancelled.
    fn build(scene: &Arc<Scene<S>>, params: &Self::Params, progress: &dyn Progress) -> Option<Self::Index>;
    /// The part of the index that took long to build, as bytes that [`Method::restore`] reads; `None` if none
    /// did.
    fn save(_: &Self::Index) -> Option<Vec<u8>> {
        None
    }
    /// Builds the index around what [`Method::save`] kept; `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// Why the bytes do not fit the scene and the parameters.
    fn restore(
        _: &Arc<Scene<S>>,
        _: &Self::Params,
        _: &[u8],
        _: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        Err("this method keeps no preprocess".into())
    }
    /// The method. There is no second copy of this function.
    fn cull<O: Observer<Self::Note>>(
        index: &Self::Index,
        scene: &Scene<S>,
        view: &View<S>,
        params: &Self::Params,
        memory: &mut Self::Memory,
        out: &mut DrawList,
        watch: &mut O,
    );
    /// Whether what it keeps can change a later frame.
    const REMEMBERS: bool = size_of::<Self::Memory>() > 0;
    /// Sets what ends a frame from outside; whether the method asks it at all.
    fn limit(_: &mut Self::Memory, _: Option<Limit>) -> bool {
        false
    }
    /// Large state before the first event of a frame.
    fn dense(scene: &Scene<S>, view: &View<S>) -> Self::Dense;
    /// The only way large state changes: `cull` calls it as it works and a film calls it again, so
    /// replay cannot drift from the run.
    fn apply(dense: &mut Self::Dense, scene: &Scene<S>, note: &Self::Note);
    /// Notes between kept copies of large state in a film. Denser keyframes made seeking slower: copying a
    /// state costs as much as replaying about this many notes.
    const KEYFRAME_NOTES: usize = 64;
    /// Names of the method's pictures that are not of the world, such as of its image-space structures.
    const PICTURES: &'static [&'static str] = &[];
    /// Draws picture `which < PICTURES.len()` at one step, in paper coordinates with its size: from the large
    /// state and all notes up to that step, the current one last.
    fn picture(
        _dense: &Self::Dense,
        _view: &View<S>,
        _notes: &[Self::Note],
        _which: usize,
        _scale: DepthScale,
    ) -> Drawing {
        Drawing::default()
    }
    /// What is under a point of that picture, in words.
    fn probe(_dense: &Self::Dense, _view: &View<S>, _which: usize, _at: glam::Vec2) -> Option<String> {
        None
    }
    /// Draws, in world coordinates, what is private to the method at one step: its large state, and
    /// the evidence of the current note.
    fn explain(
        dense: &Self::Dense,
        scene: &Scene<S>,
        index: &Self::Index,
        view: &View<S>,
        note: Option<&Self::Note>,
        to: &mut Drawing<S::Vector>,
    );
}
