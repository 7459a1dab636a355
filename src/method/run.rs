//! Methods as the rest of the house sees them: erased once a frame, `Entry → Run → Film`.

use std::marker::PhantomData;
use std::sync::Arc;

use super::film::Footage;
use super::knobs::{Apply, Collect, SetBudget};
use super::{
    Budget, Card, DrawList, Event, Film, Frame, Knob, KnobValue, Knobs, Limit, Method, Observer, Recorder,
    SettingError, Settings, Shown, State, Tally, Unobserved,
};
use crate::geometry::{Space, View};
use crate::index::Hierarchy;
use crate::scene::{Progress, Scene};

/// A method of a space.
pub trait Entry<S: Space>: Sync {
    /// Identity.
    fn card(&self) -> &'static Card;
    /// Names of its pictures that are not of the world.
    fn pictures(&self) -> &'static [&'static str];
    /// All parameters with the values that `settings` give them.
    ///
    /// # Errors
    /// A setting that names no parameter, or whose value does not fit.
    fn knobs(&self, settings: &Settings) -> Result<Vec<(Knob, KnobValue)>, SettingError>;
    /// Whether with these settings its answer includes every visible primitive.
    ///
    /// # Errors
    /// As [`Entry::knobs`].
    fn is_conservative(&self, settings: &Settings) -> Result<bool, SettingError>;
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
    /// As [`Entry::ready`], with the part of the index that [`Hierarchy::save`] returned earlier.
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
///
/// A frame may be given a [`Limit`] that ends it early; a method that cannot be ended does not call it.
pub trait Run<S: Space>: Send {
    /// Identity.
    fn card(&self) -> &'static Card;
    /// Parameters with their values.
    fn knobs(&self) -> Vec<(Knob, KnobValue)>;
    /// Goes over to another frame of the scene that it was made ready for (see [`crate::scene::Motion`]);
    /// what it remembers stays as far as it is still true. False when cancelled; then the run is of no use.
    fn pose(&mut self, scene: &Arc<Scene<S>>, progress: &dyn Progress) -> bool;
    /// The index.
    fn hierarchy(&self) -> &dyn Hierarchy<S>;
    /// One frame at full speed.
    fn cull(&mut self, view: &View<S>) -> DrawList<S> {
        self.cull_until(view, None)
    }
    /// The same function, counted.
    fn count(&mut self, view: &View<S>) -> (DrawList<S>, Tally) {
        self.count_until(view, None)
    }
    /// The same function, recorded: the first `cap` events.
    fn record(&mut self, view: &View<S>, cap: usize) -> Recording<S> {
        self.record_until(view, None, cap)
    }
    /// As [`Run::cull`], with a limit.
    fn cull_until(&mut self, view: &View<S>, limit: Option<&Limit<'_>>) -> DrawList<S>;
    /// As [`Run::count`], with a limit.
    fn count_until(&mut self, view: &View<S>, limit: Option<&Limit<'_>>) -> (DrawList<S>, Tally);
    /// As [`Run::record`], with a limit.
    fn record_until(&mut self, view: &View<S>, limit: Option<&Limit<'_>>, cap: usize) -> Recording<S>;
    /// The same function at full speed; `at` is called with the name of each stage of the frame as it begins.
    fn stages(&mut self, view: &View<S>, at: &mut dyn FnMut(&'static str)) -> DrawList<S>;
    /// Whether the large state of the last frame is that of a film after its last note; `None` if the film is
    /// not a whole one of this method.
    fn ended_like(&self, film: &dyn Film<S>) -> Option<bool>;
    /// Sets the budget, if the method has one; the index stays.
    fn set_budget(&mut self, budget: Budget);
    /// Forgets all earlier frames.
    fn forget(&mut self);
    /// Whether earlier frames can matter at all.
    fn remembers(&self) -> bool;
}

/// A recorded frame.
pub struct Recording<S: Space> {
    /// What was drawn.
    pub list: DrawList<S>,
    /// What happened.
    pub film: Arc<dyn Film<S>>,
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

/// The settings that give a method these parameters, in the order of their declaration: those that are not
/// what the defaults and the settings before them make of them, so that of a preset nothing is named that
/// follows from it.
pub fn settings_for<S: Space>(
    entry: &dyn Entry<S>,
    knobs: &[(Knob, KnobValue)],
) -> Vec<(&'static str, String)> {
    let (mut settings, mut named) = (Settings::default(), Vec::new());
    for (at, (knob, value)) in knobs.iter().enumerate() {
        let value = value.to_string();
        if !entry.knobs(&settings).is_ok_and(|so_far| so_far[at].1.to_string() == value) {
            settings.0.insert(knob.name.to_owned(), value.clone());
            named.push((knob.name, value));
        }
    }
    named
}

impl<S: Space, M: Shown<S>> Entry<S> for Of<M> {
    fn card(&self) -> &'static Card {
        const { &M::CARD }
    }
    fn knobs(&self, settings: &Settings) -> Result<Vec<(Knob, KnobValue)>, SettingError> {
        params::<S, M>(settings).map(|p| listed::<S, M>(&p))
    }
    fn is_conservative(&self, settings: &Settings) -> Result<bool, SettingError> {
        params::<S, M>(settings).map(|p| M::is_conservative(&p))
    }
    fn pictures(&self) -> &'static [&'static str] {
        M::PICTURES
    }
    fn ready(
        &self,
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Box<dyn Run<S>>>, SettingError> {
        let params = params::<S, M>(settings)?;
        // Without saved bytes nothing can be wrong with them.
        let index = M::build(scene, &params, None, progress).unwrap_or_default();
        Ok(index.map(|index| Bound::<S, M>::boxed(scene, index, params)))
    }
    fn restore(
        &self,
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        saved: &[u8],
        progress: &dyn Progress,
    ) -> Result<Option<Box<dyn Run<S>>>, RestoreError> {
        let params = params::<S, M>(settings)?;
        let index = M::build(scene, &params, Some(saved), progress).map_err(RestoreError::Saved)?;
        Ok(index.map(|index| Bound::<S, M>::boxed(scene, index, params)))
    }
}

struct Bound<S: Space, M: Method<S>> {
    scene: Arc<Scene<S>>,
    index: Arc<M::Index>,
    params: M::Params,
    memory: M::Memory,
    /// Of the last frame; its memory is that of the next.
    state: M::State,
    /// The most events and notes of a film so far. With room for as many the next one need not be copied
    /// whenever it grows.
    longest: [usize; 2],
}

impl<S: Space, M: Shown<S>> Bound<S, M> {
    fn boxed(scene: &Arc<Scene<S>>, index: M::Index, params: M::Params) -> Box<dyn Run<S>> {
        let (scene, index) = (scene.clone(), Arc::new(index));
        let (memory, state) = (M::Memory::default(), M::State::default());
        Box::new(Self { scene, index, params, memory, state, longest: [0; 2] })
    }
    fn run<O: Observer<M::Note>>(
        &mut self,
        view: &View<S>,
        limit: Option<&Limit<'_>>,
        watch: &mut O,
    ) -> DrawList<S> {
        let (index, scene, params) = (&*self.index, &*self.scene, &self.params);
        let frame = Frame { index, scene, view, params, limit };
        let mut list = DrawList::default();
        self.state.begin(&frame);
        M::cull(&frame, &mut self.memory, &mut self.state, &mut list, watch);
        list
    }
}

impl<S: Space, M: Shown<S>> Run<S> for Bound<S, M> {
    fn card(&self) -> &'static Card {
        const { &M::CARD }
    }
    fn knobs(&self) -> Vec<(Knob, KnobValue)> {
        listed::<S, M>(&self.params)
    }
    fn pose(&mut self, scene: &Arc<Scene<S>>, progress: &dyn Progress) -> bool {
        // The same frame, or nothing moves.
        if Arc::ptr_eq(&self.scene, scene) {
            return true;
        }
        self.state.release();
        if M::moved(&mut self.index, &mut self.memory, scene, &self.params, progress).is_none() {
            return false;
        }
        self.scene = scene.clone();
        true
    }
    fn hierarchy(&self) -> &dyn Hierarchy<S> {
        &*self.index
    }
    fn cull_until(&mut self, view: &View<S>, limit: Option<&Limit<'_>>) -> DrawList<S> {
        self.run(view, limit, &mut Unobserved)
    }
    fn stages(&mut self, view: &View<S>, at: &mut dyn FnMut(&'static str)) -> DrawList<S> {
        self.run(view, None, &mut Stages(at))
    }
    fn count_until(&mut self, view: &View<S>, limit: Option<&Limit<'_>>) -> (DrawList<S>, Tally) {
        let mut tally = Tally::default();
        (self.run(view, limit, &mut tally), tally)
    }
    fn record_until(&mut self, view: &View<S>, limit: Option<&Limit<'_>>, cap: usize) -> Recording<S> {
        let mut recorder = Recorder::new(cap);
        recorder.expect(self.longest[0], self.longest[1]);
        let list = self.run(view, limit, &mut recorder);
        self.longest =
            [self.longest[0].max(recorder.events.len()), self.longest[1].max(recorder.notes.len())];
        recorder.events.shrink_to_fit();
        recorder.notes.shrink_to_fit();
        let (scene, index, params) = (self.scene.clone(), self.index.clone(), self.params.clone());
        let film = Footage::<S, M>::new(scene, index, params, self.knobs(), *view, recorder);
        Recording { list, film: Arc::new(film) }
    }
    fn ended_like(&self, film: &dyn Film<S>) -> Option<bool> {
        let footage = film.as_any().downcast_ref::<Footage<S, M>>().filter(|_| film.lost() == 0)?;
        Some(*footage.last_state() == self.state)
    }
    fn set_budget(&mut self, budget: Budget) {
        M::knobs(&mut self.params, &mut SetBudget(budget));
    }
    fn forget(&mut self) {
        self.memory = M::Memory::default();
    }
    fn remembers(&self) -> bool {
        size_of::<M::Memory>() > 0
    }
}

/// Hears only where a stage begins.
struct Stages<'a>(&'a mut dyn FnMut(&'static str));

impl<N> Observer<N> for Stages<'_> {
    const LISTENS: bool = false;
    #[inline(always)]
    fn event(&mut self, _: Event) {}
    #[inline(always)]
    fn note(&mut self, _: impl FnOnce() -> N) {}
    fn stage(&mut self, name: &'static str) {
        (self.0)(name);
    }
}
