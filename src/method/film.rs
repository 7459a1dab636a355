//! A finished recording of one frame, at any step.

use std::any::Any;
use std::sync::{Arc, Mutex, OnceLock};

use super::{
    Card, Claim, Compared, Context, Derived, DrawList, Event, Field, Frame, Hiders, Knob, KnobValue, Method,
    Moment, Note, Recorder, Shown, State, Verdict,
};
use crate::drawing::{Drawing, Subject};
use crate::geometry::{NodeId, Space, View};
use crate::index::Hierarchy;
use crate::raster::DepthScale;
use crate::scene::Scene;

/// A finished recording of one frame, as far as it does not depend on the space. Step `k` is the state after
/// the first `k` events.
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
    /// The kind of event `at < events().len()`; of evidence, that of the note.
    fn kind(&self, at: usize) -> &'static str;
    /// What event `at` is about; of evidence, what it was gathered about; of a line of pseudocode, what the
    /// event is about that comes of it.
    fn subject(&self, at: usize) -> Subject;
    /// Whether a line of the pseudocode belongs to the parameters of this recording.
    fn has_line(&self, line: u8) -> bool;
    /// The two numbers whose comparison gave the result of the evidence that is event `at`.
    fn compared(&self, at: usize) -> Option<Compared>;
    /// The evidence on which the decision that is event `at` rests: the latest before it about the same node
    /// or primitive, the primitive's object, or else the nearest open node around it; of several the one that
    /// claims the verdict. `None` if `at` is no decision, or rests on none.
    fn evidence_of(&self, at: usize) -> Option<usize>;
    /// The evidence that a step is about: what was just recorded, or the evidence of the decision just made.
    /// Queueing, leaving the node that was decided, and lines about the same change nothing about that.
    fn evidence_at(&self, step: usize) -> Option<usize>;
    /// What hides what is left out as hidden on the ground of the evidence that is event `at`; `None` where
    /// the method cannot tell.
    fn hiders(&self, at: usize) -> Option<Hiders>;
    /// The kind and the operands of event `at`, for traces and the inspector.
    fn fields(&self, at: usize) -> (&'static str, Vec<Field>);
    /// What event `at` did, in a sentence or two.
    fn sentence(&self, at: usize) -> String;
    /// What follows from a parameter for the image of the view.
    fn derived(&self) -> Option<&Derived>;
    /// Names of the method's pictures that are not of the world.
    fn pictures(&self) -> &'static [&'static str];
    /// Picture `which < pictures().len()` at a step, in paper coordinates, with depths in gray on this scale.
    fn picture(&self, step: usize, which: usize, scale: DepthScale) -> Drawing;
    /// What is under a point of such a picture, in words.
    fn probe(&self, step: usize, which: usize, at: glam::Vec2) -> Option<String>;
    /// The recording itself, for those who know its method: see [`notes`].
    fn as_any(&self) -> &dyn Any;
}

/// A finished recording of one frame. A `&dyn Film<S>` is a `&dyn Reel` where the space does not matter.
pub trait Film<S: Space>: Reel {
    /// The scene.
    fn scene(&self) -> &Arc<Scene<S>>;
    /// The view that was culled for.
    fn view(&self) -> &View<S>;
    /// The index.
    fn hierarchy(&self) -> &dyn Hierarchy<S>;
    /// What event `at` claims; `None` if it is no evidence, or claims nothing.
    fn claim(&self, at: usize) -> Option<Claim<S::Vector>>;
    /// Draws the method's private state and evidence at a step, in world coordinates.
    fn explain(&self, step: usize, to: &mut Drawing<S::Vector>);
    /// What has been drawn up to a step, of a method that stands something for primitives; `None` for one
    /// that draws primitives alone, of which verdicts tell.
    fn drawn(&self, step: usize) -> Option<DrawList<S>>;
}

/// The evidence of a film of method `M`, with the event that each piece is; nothing if it is another
/// method's.
pub fn notes<S: Space, M: Method<S>>(film: &dyn Film<S>) -> impl Iterator<Item = (usize, &M::Note)> {
    let own = film.as_any().downcast_ref::<Footage<S, M>>();
    own.into_iter().flat_map(|footage| {
        let of = |(at, event): (usize, &Event)| match event {
            Event::Noted(i) => Some((at, &footage.recorder.notes[*i as usize])),
            _ => None,
        };
        footage.recorder.events.iter().enumerate().filter_map(of)
    })
}

/// What was recorded of one frame.
pub(super) struct Footage<S: Space, M: Method<S>> {
    scene: Arc<Scene<S>>,
    index: Arc<M::Index>,
    params: M::Params,
    knobs: Vec<(Knob, KnobValue)>,
    view: View<S>,
    recorder: Recorder<M::Note>,
    states: Mutex<States<M::State>>,
    /// Found when it is first asked for.
    evidence: OnceLock<Vec<Grounds>>,
    /// The same.
    derived: OnceLock<Option<Derived>>,
}

/// A decision, and the evidence that it rests on: both as places among the events.
#[derive(Clone, Copy)]
struct Grounds {
    decision: u32,
    evidence: u32,
}

/// Large state at some steps.
struct States<T> {
    /// (notes applied, state), ascending, filled as far as anyone has looked.
    keys: Vec<(usize, T)>,
    /// The one that was looked at last.
    last: Option<(usize, Arc<T>)>,
}

impl<S: Space, M: Shown<S>> Footage<S, M> {
    pub(super) fn new(
        scene: Arc<Scene<S>>,
        index: Arc<M::Index>,
        params: M::Params,
        knobs: Vec<(Knob, KnobValue)>,
        view: View<S>,
        recorder: Recorder<M::Note>,
    ) -> Self {
        let states = Mutex::new(States { keys: Vec::new(), last: None });
        let (evidence, derived) = (OnceLock::new(), OnceLock::new());
        Self { scene, index, params, knobs, view, recorder, states, evidence, derived }
    }
    fn frame(&self) -> Frame<'_, S, M> {
        let (scene, index, view, params) = (&*self.scene, &*self.index, &self.view, &self.params);
        Frame { index, scene, view, params, limit: None }
    }
    fn context(&self) -> Context<'_, S> {
        Context { scene: &self.scene, view: &self.view }
    }
    /// The notes among the first `step` events.
    fn notes_before(&self, step: usize) -> &[M::Note] {
        let events = &self.recorder.events[..step.min(self.recorder.events.len())];
        let last = events
            .iter()
            .rev()
            .find_map(|e| if let Event::Noted(i) = e { Some(*i as usize + 1) } else { None });
        &self.recorder.notes[..last.unwrap_or(0)]
    }
    /// Large state after the last note.
    pub(super) fn last_state(&self) -> Arc<M::State> {
        self.state_after(self.recorder.notes.len())
    }
    /// Large state after the first `seen` notes.
    fn state_after(&self, seen: usize) -> Arc<M::State> {
        if size_of::<M::State>() == 0 {
            return Arc::default();
        }
        let mut states = self.states.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let States { keys, last } = &mut *states;
        if keys.is_empty() {
            let mut first = M::State::default();
            first.begin(&self.frame());
            keys.push((0, first));
        }
        let nearest = keys.partition_point(|(at, _)| *at <= seen) - 1;
        // Mostly the step before was looked at last.
        let (mut at, mut state) = match last.take() {
            Some((at, state)) if (keys[nearest].0..=seen).contains(&at) => (at, state),
            _ => (keys[nearest].0, Arc::new(keys[nearest].1.clone())),
        };
        while at < seen {
            Arc::make_mut(&mut state).apply(&self.scene, &self.recorder.notes[at]);
            at += 1;
            if at.is_multiple_of(M::State::KEYFRAME_NOTES) && keys.last().is_some_and(|(last, _)| *last < at)
            {
                keys.push((at, (*state).clone()));
            }
        }
        *last = Some((at, state.clone()));
        state
    }
    /// The note that a step is about.
    fn note_at(&self, step: usize) -> Option<&M::Note> {
        match self.recorder.events[self.evidence_at(step)?] {
            Event::Noted(i) => self.recorder.notes.get(i as usize),
            _ => None,
        }
    }
    /// Does something with a step.
    fn at<T>(&self, step: usize, look: impl FnOnce(&Moment<'_, S, M>) -> T) -> T {
        let notes = self.notes_before(step);
        let state = self.state_after(notes.len());
        look(&Moment { frame: self.frame(), state: &state, notes, note: self.note_at(step) })
    }
    /// Whether the note that is event `at` claims what a verdict says.
    fn claims(&self, at: u32, verdict: Verdict) -> bool {
        let Event::Noted(i) = self.recorder.events[at as usize] else { return false };
        let claim = |i: u32| self.recorder.notes[i as usize].claim(&self.context());
        match verdict {
            Verdict::Outside => matches!(claim(i), Some(Claim::Outside { .. })),
            Verdict::FacesAway => matches!(claim(i), Some(Claim::FacesAway { .. })),
            Verdict::Hidden => matches!(claim(i), Some(Claim::Hidden)),
            _ => false,
        }
    }
    /// How many primitives were decided otherwise one by one since a node that is kept by event `at` was
    /// entered.
    fn left_out(&self, at: usize, node: NodeId) -> usize {
        let since = self.recorder.events[..at].iter().rev().take_while(|e| **e != Event::Entered(node));
        since.filter(|e| matches!(e, Event::DecidedPrim(_, v) if *v != Verdict::Visible)).count()
    }
    /// Goes through the film once and finds what each decision rests on. O(events + nodes + primitives).
    fn grounds(&self) -> Vec<Grounds> {
        const NONE: u32 = u32::MAX;
        let mut of_node = vec![NONE; self.index.node_count()];
        let mut of_prim = vec![NONE; self.scene.prim_count()];
        let mut of_object = vec![NONE; self.scene.objects().len()];
        let mut open: Vec<NodeId> = Vec::new();
        let mut found = Vec::new();
        for (at, event) in self.recorder.events.iter().enumerate() {
            let decision = at as u32;
            let evidence = match *event {
                Event::Noted(i) => {
                    match self.recorder.notes[i as usize].subject() {
                        Subject::Node(node) => of_node[node.at()] = decision,
                        Subject::Prim(prim) => of_prim[prim.at()] = decision,
                        Subject::Object(object) => of_object[object.at()] = decision,
                        _ => {}
                    }
                    continue;
                }
                Event::Entered(node) => {
                    open.push(node);
                    continue;
                }
                Event::Left(_) => {
                    open.pop();
                    continue;
                }
                Event::DecidedNode(node, _) if of_node[node.at()] != NONE => of_node[node.at()],
                // What was found of a node holds for all below it: a node that lies inside of all planes
                // saves its children the test.
                Event::DecidedNode(..) => {
                    open.iter().rev().map(|n| of_node[n.at()]).find(|at| *at != NONE).unwrap_or(NONE)
                }
                Event::DecidedPrim(prim, verdict) => {
                    // The node that is visited stands for what it holds.
                    let around = open.iter().rev().map(|n| of_node[n.at()]).find(|at| *at != NONE);
                    let own = [of_prim[prim.at()], of_object[self.scene.object_of(prim).at()]];
                    let known = own.into_iter().chain(around).filter(|at| *at != NONE);
                    // An object may have been decided for good in another node: what claims the verdict
                    // counts before what came later.
                    let claims = known.clone().filter(|at| self.claims(*at, verdict));
                    claims.max().or(known.max()).unwrap_or(NONE)
                }
                _ => continue,
            };
            if evidence != NONE {
                found.push(Grounds { decision, evidence });
            }
        }
        found
    }
}

impl<S: Space, M: Shown<S>> Reel for Footage<S, M> {
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
    fn kind(&self, at: usize) -> &'static str {
        match self.recorder.events[at] {
            Event::Noted(i) => self.recorder.notes[i as usize].kind(),
            event => event.kind(),
        }
    }
    fn subject(&self, at: usize) -> Subject {
        // A line is about what comes of it.
        let events = &self.recorder.events;
        let done = events[at..].iter().find(|e| !matches!(e, Event::Line(_)));
        match done {
            Some(Event::Noted(i)) => self.recorder.notes[*i as usize].subject(),
            Some(event) => event.subject(),
            None => Subject::None,
        }
    }
    fn has_line(&self, line: u8) -> bool {
        M::has_line(&self.params, line)
    }
    fn compared(&self, at: usize) -> Option<Compared> {
        match self.recorder.events[at] {
            Event::Noted(i) => self.recorder.notes[i as usize].compared(&self.context()),
            _ => None,
        }
    }
    fn evidence_of(&self, at: usize) -> Option<usize> {
        let grounds = self.evidence.get_or_init(|| self.grounds());
        let found = grounds.binary_search_by_key(&(at as u32), |g| g.decision).ok()?;
        Some(grounds[found].evidence as usize)
    }
    fn evidence_at(&self, step: usize) -> Option<usize> {
        let events = &self.recorder.events[..step.min(self.recorder.events.len())];
        let mut left = 0;
        let mut passes = |event: &&Event| {
            left += usize::from(matches!(event, Event::Left(_)));
            // The second node that is left is another one than was decided.
            matches!(event, Event::Line(_) | Event::Queued(..))
                || matches!(event, Event::Left(_)) && left == 1
        };
        let at = events.len().checked_sub(1 + events.iter().rev().take_while(&mut passes).count())?;
        let evidence = match events[at] {
            Event::Noted(_) => Some(at),
            Event::DecidedNode(..) | Event::DecidedPrim(..) => self.evidence_of(at),
            _ => None,
        };
        // A line goes on with what was found only if it is about the same.
        let goes_on = |found: &usize| match events.last() {
            Some(Event::Line(_)) => self.subject(events.len() - 1) == self.subject(*found),
            _ => true,
        };
        evidence.filter(goes_on)
    }
    fn hiders(&self, at: usize) -> Option<Hiders> {
        match self.recorder.events[at] {
            Event::Noted(i) => M::hiders(&self.frame(), &self.recorder.notes, i as usize),
            _ => None,
        }
    }
    fn fields(&self, at: usize) -> (&'static str, Vec<Field>) {
        let fields = match self.recorder.events[at] {
            Event::Noted(i) => self.recorder.notes[i as usize].fields(&self.context()),
            event => event.fields(M::CARD.code),
        };
        (self.kind(at), fields)
    }
    fn sentence(&self, at: usize) -> String {
        match self.recorder.events[at] {
            Event::Noted(i) => self.recorder.notes[i as usize].sentence(&self.context()),
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
            Event::DecidedNode(n, Verdict::Visible) => {
                kept_sentence::<S>(n, self.index.held(n), self.left_out(at, n))
            }
            Event::DecidedNode(n, v) => node_sentence::<S>(n.0, self.index.held(n), v),
            Event::DecidedPrim(p, v) => prim_sentence::<S>(p.0, v),
        }
    }
    fn derived(&self) -> Option<&Derived> {
        self.derived.get_or_init(|| M::derived(&self.frame())).as_ref()
    }
    fn pictures(&self) -> &'static [&'static str] {
        M::PICTURES
    }
    fn picture(&self, step: usize, which: usize, scale: DepthScale) -> Drawing {
        self.at(step, |moment| M::picture(moment, which, scale))
    }
    fn probe(&self, step: usize, which: usize, at: glam::Vec2) -> Option<String> {
        self.at(step, |moment| M::probe(moment, which, at))
    }
    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl<S: Space, M: Shown<S>> Film<S> for Footage<S, M> {
    fn scene(&self) -> &Arc<Scene<S>> {
        &self.scene
    }
    fn view(&self) -> &View<S> {
        &self.view
    }
    fn hierarchy(&self) -> &dyn Hierarchy<S> {
        &*self.index
    }
    fn claim(&self, at: usize) -> Option<Claim<S::Vector>> {
        match self.recorder.events[at] {
            Event::Noted(i) => self.recorder.notes[i as usize].claim(&self.context()),
            _ => None,
        }
    }
    fn explain(&self, step: usize, to: &mut Drawing<S::Vector>) {
        self.at(step, |moment| M::explain(moment, to));
    }
    fn drawn(&self, step: usize) -> Option<DrawList<S>> {
        self.at(step, M::drawn)
    }
}

/// Such as `1 segment` or `12 triangles`.
fn counted<S: Space>(n: usize) -> String {
    format!("{n} {}{}", S::PRIM, if n == 1 { "" } else { "s" })
}

fn kept_sentence<S: Space>(node: NodeId, below: usize, left_out: usize) -> String {
    match left_out {
        0 => format!("Node {node} is kept with all below it: {}.", counted::<S>(below)),
        _ => format!(
            "Node {node} is kept, without the {} of its {} that {} decided one by one.",
            left_out,
            counted::<S>(below),
            if left_out == 1 { "was" } else { "were" }
        ),
    }
}

fn node_sentence<S: Space>(node: u32, below: usize, verdict: Verdict) -> String {
    let below = counted::<S>(below);
    match verdict {
        Verdict::Outside => {
            format!("Node {node} is outside the view and dropped with all below it: {below}.")
        }
        Verdict::Hidden => format!("Node {node} is hidden and dropped with all below it: {below}."),
        Verdict::FacesAway => format!("Node {node} faces away and is dropped with all below it: {below}."),
        Verdict::Presumed => {
            format!("Node {node} is taken to be hidden and dropped with all below it: {below}. Not proven.")
        }
        Verdict::Partial => {
            format!("Node {node} is neither kept nor dropped as a whole; its parts are looked at one by one.")
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
        Verdict::Outside => format!("The {name} {prim} is not drawn: it is outside the view."),
        Verdict::FacesAway => format!("The {name} {prim} is not drawn: it faces away from the eye."),
        Verdict::Hidden => format!("The {name} {prim} is hidden and not drawn."),
        Verdict::Presumed => format!("The {name} {prim} is taken to be hidden, not proven, and not drawn."),
        Verdict::Partial => format!("The {name} {prim} is undecided."),
        Verdict::Visible => format!("The {name} {prim} is drawn."),
        Verdict::Approximated => format!("A stand-in is drawn for the {name} {prim}."),
        Verdict::OverBudget => format!("The {name} {prim} is left out: the budget is spent."),
    }
}
