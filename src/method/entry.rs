//! Methods as the rest of the house sees them: erased once a frame, `Entry → Run → Film`.

use std::marker::PhantomData;
use std::sync::{Arc, Mutex};

use super::knobs::{Apply, Collect, SetBudget};
use super::{
    Budget, Card, DrawList, Event, Field, Knob, KnobValue, Knobs, Limit, Method, Note, Recorder,
    SettingError, Settings, Tally, Unobserved, Verdict,
};
use crate::drawing::Drawing;
use crate::geometry::{Space, View};
use crate::index::Hierarchy;
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene};

/// A method of a space.
pub trait Entry<S: Space>: Sync {
    /// Identity.
    fn card(&self) -> &'static Card;
    /// All parameters with the values that `settings` give them.
    ///
    /// # Errors
    /// A setting that names no parameter, or whose value does not fit.
    fn knobs(&self, settings: &Settings) -> Result<Vec<(Knob, KnobValue)>, SettingError>;
    /// Builds the index; ready to run on the scene. `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// As [`Entry::knobs`].
    fn ready(
        &self,
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Box<dyn Run<S>>>, SettingError>;
    /// As [`Entry::ready`], with the part of the index that [`Run::save`] returned earlier.
    ///
    /// # Errors
    /// As [`Entry::knobs`], and if the bytes do not fit the scene and the settings.
    fn restore(
        &self,
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        saved: &[u8],
        progress: &dyn Progress,
    ) -> Result<Option<Box<dyn Run<S>>>, RestoreError>;
}

/// Why a saved preprocess was not taken. Displays as one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// A setting does not fit.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The bytes do not fit.
    #[error("{0}")]
    Saved(String),
}

/// A method bound to a scene and parameters, with what it remembers from frame to frame.
pub trait Run<S: Space>: Send {
    /// Identity.
    fn card(&self) -> &'static Card;
    /// Parameters with their values.
    fn knobs(&self) -> Vec<(Knob, KnobValue)>;
    /// The index.
    fn hierarchy(&self) -> &dyn Hierarchy<S>;
    /// One frame at full speed.
    fn cull(&mut self, view: &View<S>) -> DrawList;
    /// The same function, counted.
    fn count(&mut self, view: &View<S>) -> (DrawList, Tally);
    /// The same function, recorded: the first `cap` events.
    fn record(&mut self, view: &View<S>, cap: usize) -> Recording<S>;
    /// Forgets all earlier frames.
    fn forget(&mut self);
    /// What took long to build, for [`Entry::restore`]; `None` if nothing did.
    fn save(&self) -> Option<Vec<u8>>;
    /// Whether earlier frames can matter at all.
    fn remembers(&self) -> bool;
    /// Sets what ends the frames to come early, until it is set anew or everything is forgotten; whether the
    /// method asks it.
    fn limit(&mut self, limit: Option<Limit>) -> bool;
    /// Sets the budget, if the method has one; the index stays.
    fn set_budget(&mut self, budget: Budget);
}

/// A recorded frame.
pub struct Recording<S: Space> {
    /// What was drawn.
    pub list: DrawList,
    /// What happened.
    pub film: Arc<dyn Film<S>>,
}

/// A finished recording of one frame, as far as it does not depend on the space. Step `k` is the state after the
/// first `k` events.
pub trait Reel: Send + Sync {
    /// Identity of the method.
    fn card(&self) -> &'static Card;
    /// Parameters with their values.
    fn knobs(&self) -> &[(Knob, KnobValue)];
    /// The shared facts, in order.
    fn events(&self) -> &[Event];
    /// Events that happened after the film was full; 0 if the film is whole.
    fn lost(&self) -> u64;
    /// Bytes of events and notes.
    fn bytes(&self) -> usize;
    /// The kind and the operands of event `at < events().len()`; kind is that of the note for `Noted`.
    fn fields(&self, at: usize) -> (&'static str, Vec<Field>);
    /// What event `at` did, in a sentence or two.
    fn sentence(&self, at: usize) -> String;
    /// Names of the method's pictures that are not of the world.
    fn pictures(&self) -> &'static [&'static str];
    /// Picture `which < pictures().len()` at a step, in paper coordinates, with depths in gray on this scale.
    fn picture(&self, step: usize, which: usize, scale: DepthScale) -> Drawing;
    /// What is under a point of such a picture, in words.
    fn probe(&self, step: usize, which: usize, at: glam::Vec2) -> Option<String>;
}

/// A finished recording of one frame. A `&dyn Film<S>` is a `&dyn Reel` where the space does not matter.
pub trait Film<S: Space>: Reel {
    /// The scene.
    fn scene(&self) -> &Arc<Scene<S>>;
    /// The view that was culled for.
    fn view(&self) -> &View<S>;
    /// The index.
    fn hierarchy(&self) -> &dyn Hierarchy<S>;
    /// Draws the method's private state and evidence at a step, in world coordinates.
    fn explain(&self, step: usize, to: &mut Drawing<S::Vector>);
}

pub(crate) struct Of<M>(PhantomData<fn() -> M>);

impl<M> Of<M> {
    pub(crate) const NEW: Self = Self(PhantomData);
}

/// A method's parameters as these settings give them.
pub(crate) fn params<S: Space, M: Method<S>>(settings: &Settings) -> Result<M::Params, SettingError> {
    let mut params = M::Params::default();
    let known = listed::<S, M>(&params);
    if let Some(key) = settings.0.keys().find(|k| known.iter().all(|(knob, _)| knob.name != k.as_str())) {
        let known = known.iter().map(|(k, _)| k.name).collect::<Vec<_>>().join(", ");
        return Err(SettingError::Unknown { method: M::CARD.key, key: key.clone(), known });
    }
    let mut apply = Apply { settings, error: None };
    M::knobs(&mut params, &mut apply);
    apply.error.map_or(Ok(params), Err)
}

fn listed<S: Space, M: Method<S>>(params: &M::Params) -> Vec<(Knob, KnobValue)> {
    let mut collect = Collect::default();
    M::knobs(&mut params.clone(), &mut collect as &mut dyn Knobs);
    collect.0
}

impl<S: Space, M: Method<S>> Entry<S> for Of<M> {
    fn card(&self) -> &'static Card {
        const { &M::CARD }
    }
    fn knobs(&self, settings: &Settings) -> Result<Vec<(Knob, KnobValue)>, SettingError> {
        params::<S, M>(settings).map(|p| listed::<S, M>(&p))
    }
    fn ready(
        &self,
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Box<dyn Run<S>>>, SettingError> {
        let params = params::<S, M>(settings)?;
        Ok(M::build(scene, &params, progress).map(|index| Bound::<S, M>::boxed(scene, index, params)))
    }
    fn restore(
        &self,
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        saved: &[u8],
        progress: &dyn Progress,
    ) -> Result<Option<Box<dyn Run<S>>>, RestoreError> {
        let params = params::<S, M>(settings)?;
        let index = M::restore(scene, &params, saved, progress).map_err(RestoreError::Saved)?;
        Ok(index.map(|index| Bound::<S, M>::boxed(scene, index, params)))
    }
}

struct Bound<S: Space, M: Method<S>> {
    scene: Arc<Scene<S>>,
    index: Arc<M::Index>,
    params: M::Params,
    memory: M::Memory,
}

impl<S: Space, M: Method<S>> Bound<S, M> {
    fn boxed(scene: &Arc<Scene<S>>, index: M::Index, params: M::Params) -> Box<dyn Run<S>> {
        Box::new(Self { scene: scene.clone(), index: Arc::new(index), params, memory: M::Memory::default() })
    }
}

impl<S: Space, M: Method<S>> Run<S> for Bound<S, M> {
    fn card(&self) -> &'static Card {
        const { &M::CARD }
    }
    fn knobs(&self) -> Vec<(Knob, KnobValue)> {
        listed::<S, M>(&self.params)
    }
    fn hierarchy(&self) -> &dyn Hierarchy<S> {
        &*self.index
    }
    fn cull(&mut self, view: &View<S>) -> DrawList {
        let mut list = DrawList::default();
        M::cull(&self.index, &self.scene, view, &self.params, &mut self.memory, &mut list, &mut Unobserved);
        list
    }
    fn count(&mut self, view: &View<S>) -> (DrawList, Tally) {
        let (mut list, mut tally) = (DrawList::default(), Tally::default());
        M::cull(&self.index, &self.scene, view, &self.params, &mut self.memory, &mut list, &mut tally);
        (list, tally)
    }
    fn record(&mut self, view: &View<S>, cap: usize) -> Recording<S> {
        let (mut list, mut recorder) = (DrawList::default(), Recorder::new(cap));
        M::cull(&self.index, &self.scene, view, &self.params, &mut self.memory, &mut list, &mut recorder);
        recorder.events.shrink_to_fit();
        recorder.notes.shrink_to_fit();
        let film = FilmOf::<S, M> {
            scene: self.scene.clone(),
            index: self.index.clone(),
            knobs: self.knobs(),
            view: *view,
            states: Mutex::new(States { keys: vec![(0, M::dense(&self.scene, view))], last: None }),
            recorder,
        };
        Recording { list, film: Arc::new(film) }
    }
    fn forget(&mut self) {
        self.memory = M::Memory::default();
    }
    fn save(&self) -> Option<Vec<u8>> {
        M::save(&self.index)
    }
    fn remembers(&self) -> bool {
        M::REMEMBERS
    }
    fn limit(&mut self, limit: Option<Limit>) -> bool {
        M::limit(&mut self.memory, limit)
    }
    fn set_budget(&mut self, budget: Budget) {
        M::knobs(&mut self.params, &mut SetBudget(budget));
    }
}

struct FilmOf<S: Space, M: Method<S>> {
    scene: Arc<Scene<S>>,
    index: Arc<M::Index>,
    knobs: Vec<(Knob, KnobValue)>,
    view: View<S>,
    recorder: Recorder<M::Note>,
    states: Mutex<States<M::Dense>>,
}

impl<S: Space, M: Method<S>> FilmOf<S, M> {
    /// The notes among the first `step` events.
    fn notes_before(&self, step: usize) -> &[M::Note] {
        let events = &self.recorder.events[..step.min(self.recorder.events.len())];
        let last = events
            .iter()
            .rev()
            .find_map(|e| if let Event::Noted(i) = e { Some(*i as usize + 1) } else { None });
        &self.recorder.notes[..last.unwrap_or(0)]
    }
    /// Large state after the first `seen` notes.
    fn dense_after(&self, seen: usize) -> Arc<M::Dense> {
        let mut states = self.states.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let States { keys, last } = &mut *states;
        let nearest = keys.partition_point(|(at, _)| *at <= seen) - 1;
        // Mostly the step before was looked at last.
        let (mut at, mut dense) = match last.take() {
            Some((at, dense)) if (keys[nearest].0..=seen).contains(&at) => (at, dense),
            _ => (keys[nearest].0, Arc::new(keys[nearest].1.clone())),
        };
        while at < seen && size_of::<M::Dense>() > 0 {
            M::apply(Arc::make_mut(&mut dense), &self.scene, &self.recorder.notes[at]);
            at += 1;
            if at.is_multiple_of(M::KEYFRAME_NOTES) && keys.last().is_some_and(|(last, _)| *last < at) {
                keys.push((at, (*dense).clone()));
            }
        }
        *last = Some((at, dense.clone()));
        dense
    }
}

/// Large state at some steps.
struct States<D> {
    /// (notes applied, state), ascending, filled as far as anyone has looked.
    keys: Vec<(usize, D)>,
    /// The one that was looked at last.
    last: Option<(usize, Arc<D>)>,
}

impl<S: Space, M: Method<S>> Reel for FilmOf<S, M> {
    fn card(&self) -> &'static Card {
        const { &M::CARD }
    }
    fn knobs(&self) -> &[(Knob, KnobValue)] {
        &self.knobs
    }
    fn events(&self) -> &[Event] {
        &self.recorder.events
    }
    fn lost(&self) -> u64 {
        self.recorder.lost
    }
    fn bytes(&self) -> usize {
        self.recorder.events.len() * size_of::<Event>() + self.recorder.notes.len() * size_of::<M::Note>()
    }
    fn fields(&self, at: usize) -> (&'static str, Vec<Field>) {
        match self.recorder.events[at] {
            Event::Noted(i) => {
                (self.recorder.notes[i as usize].kind(), self.recorder.notes[i as usize].fields())
            }
            event => super::event::fields(event, M::CARD.code),
        }
    }
    fn sentence(&self, at: usize) -> String {
        match self.recorder.events[at] {
            Event::Noted(i) => self.recorder.notes[i as usize].sentence(&self.scene),
            Event::Line(i) => {
                format!("Line {}: {}", M::CARD.code[i as usize].label, M::CARD.code[i as usize].text.trim())
            }
            Event::FrameBegan => format!("A frame of {} begins: nothing is decided yet.", M::CARD.name),
            Event::Entered(n) => {
                let (below, level) = (counted::<S>(self.index.held(n)), self.index.level(n));
                format!("The traversal enters node {n} (level {level}), which holds {below}.")
            }
            Event::Left(n) => format!("The traversal leaves node {n}."),
            Event::Queued(n, key) => format!("Node {n} is queued with priority {key}."),
            Event::DecidedNode(n, v) => node_sentence::<S>(n.0, self.index.held(n), v),
            Event::DecidedPrim(p, v) => prim_sentence::<S>(p.0, v),
        }
    }
    fn pictures(&self) -> &'static [&'static str] {
        M::PICTURES
    }
    fn picture(&self, step: usize, which: usize, scale: DepthScale) -> Drawing {
        let notes = self.notes_before(step);
        M::picture(&self.dense_after(notes.len()), &self.view, notes, which, scale)
    }
    fn probe(&self, step: usize, which: usize, at: glam::Vec2) -> Option<String> {
        M::probe(&self.dense_after(self.notes_before(step).len()), &self.view, which, at)
    }
}

impl<S: Space, M: Method<S>> Film<S> for FilmOf<S, M> {
    fn scene(&self) -> &Arc<Scene<S>> {
        &self.scene
    }
    fn view(&self) -> &View<S> {
        &self.view
    }
    fn hierarchy(&self) -> &dyn Hierarchy<S> {
        &*self.index
    }
    fn explain(&self, step: usize, to: &mut Drawing<S::Vector>) {
        let events = &self.recorder.events[..step.min(self.recorder.events.len())];
        let dense =
            self.dense_after(if size_of::<M::Dense>() == 0 { 0 } else { self.notes_before(step).len() });
        // A decision is shown together with the evidence right before it.
        let note = events.iter().rev().take(3).find_map(|e| {
            if let Event::Noted(i) = e { Some(&self.recorder.notes[*i as usize]) } else { None }
        });
        M::explain(&dense, &self.scene, &self.index, &self.view, note, to);
    }
}

/// Such as `1 segment` or `12 triangles`.
fn counted<S: Space>(n: usize) -> String {
    format!("{n} {}{}", S::PRIM, if n == 1 { "" } else { "s" })
}

fn node_sentence<S: Space>(node: u32, below: usize, verdict: Verdict) -> String {
    let below = counted::<S>(below);
    match verdict {
        Verdict::Outside => {
            format!("Node {node} is outside the view and dropped with all below it: {below}.")
        }
        Verdict::Hidden => format!("Node {node} is hidden and dropped with all below it: {below}."),
        Verdict::Partial => {
            format!("Node {node} cannot be decided as a whole; its parts are looked at one by one.")
        }
        Verdict::Visible => format!("Node {node} is kept with all below it: {below}."),
        Verdict::Approximated => format!("A stand-in is drawn for node {node} and all below it: {below}."),
        Verdict::OverBudget => {
            format!("Node {node} is left out with all below it, {below}: the budget is spent.")
        }
    }
}

fn prim_sentence<S: Space>(prim: u32, verdict: Verdict) -> String {
    let name = S::PRIM;
    match verdict {
        Verdict::Outside => format!("The {name} {prim} is not drawn: it is outside the view or faces away."),
        Verdict::Hidden => format!("The {name} {prim} is hidden and not drawn."),
        Verdict::Partial => format!("The {name} {prim} is undecided."),
        Verdict::Visible => format!("The {name} {prim} is drawn."),
        Verdict::Approximated => format!("A stand-in is drawn for the {name} {prim}."),
        Verdict::OverBudget => format!("The {name} {prim} is left out: the budget is spent."),
    }
}
