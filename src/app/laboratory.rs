//! The laboratory at work: all methods are measured on the open scene's path, a point of the chart opens the
//! step at which it went wrong, and advice is asked for and used.

use std::sync::Arc;

use super::command::Command;
use super::findings::{Findings, Laboratory, Map};
use super::shown::Dialog;
use super::stage::Stage;
use super::state::State;
use super::worker::Job;
use crate::culling::Methods;
use crate::drawing::Subject;
use crate::geometry::{Space, Vector, View, ViewPath, each};
use crate::measure::advise::{Advice, Wish, defaults, variations};
use crate::measure::sweep::{Configuration, ErrorKind, Line, Place, Spec, results};
use crate::method::{Budget, KnobValue, Settings, Verdict};
use crate::raster::Drawable;

/// Frames of the path that are measured, flights, and the longer side of the images: enough to tell methods
/// apart, few enough to wait for.
const FRAMES: usize = 8;
const REPEATS: u32 = 2;
const LONGEST_PX: u32 = 512;
/// Longer side of images over the floor plan.
const TINY_PX: u32 = 192;
/// Views that advice looks at, at most.
const MOST_VIEWS: usize = 64;

impl State {
    /// Whether what was found is about the open scene.
    pub fn is_found_here(&self) -> bool {
        self.findings.serial == self.serial
    }
    pub(super) fn laboratory(&mut self, asked: Laboratory) {
        match asked {
            Laboratory::Measure => self.measure_methods(),
            Laboratory::Advise(percent) => self.ask_advice(f64::from(percent)),
            Laboratory::Stop => {
                self.worker.cancel();
                self.record_if_missing();
            }
            Laboratory::Open(number) => self.open_tried(number),
            Laboratory::Map => self.ask_map(),
            Laboratory::Stand(number) => {
                let Some(map) = self.findings.map.clone().filter(|_| self.is_found_here()) else { return };
                if let Some(spot) = map.found.grid.get(number as usize) {
                    self.stand(&map.of, &spot.eye, 0, vec!["first-wrong".into()]);
                }
            }
            Laboratory::Flip(number) => {
                let Some(map) = self.findings.map.clone().filter(|_| self.is_found_here()) else { return };
                if let Some(flip) = map.found.flips.get(number) {
                    let then = vec![format!("select:prim:{}", flip.prim.0), "why".into()];
                    self.stand(&map.of, &flip.eyes[1], map.frames[flip.after_view], then);
                }
            }
            Laboratory::Use => {
                let Some(advice) = self.findings.advice.clone() else { return };
                let chosen = advice.configuration().clone();
                self.dialog = Dialog::None;
                self.change(0, |s| (s.method, s.settings) = (chosen.method, chosen.settings));
            }
        }
    }

    fn measure_methods(&mut self) {
        let Some(stage) = &self.stage else { return };
        let (place, chosen) = (stage.get().place(), (self.method.clone(), self.settings.clone()));
        let (configurations, views) = each!(stage, s => (tried_on(s, &chosen), s.views().len()));
        let frames = self.frames_of(views, FRAMES);
        let scene = stage.get().scene();
        let spec = Spec {
            name: scene.name().to_owned(),
            frames: frames.len() as u32,
            repeats: REPEATS,
            size_px: None,
            error: ErrorKind::WrongPixels,
            scenes: vec![Place { source: scene.source().to_owned(), path: None }],
            configurations,
        };
        let job = each!(stage, s => Either({
            let name = s.paths[s.path].name.clone();
            let views = frames.iter().map(|&k| smaller(&s.views()[k])).collect();
            (s.scene.clone(), ViewPath { name, views })
        }));
        self.forget_others();
        let (advice, map) = (self.findings.advice.take(), self.findings.map.take());
        let (serial, path) = (self.serial, place.0);
        let spec_of_it = Some(spec.clone());
        self.findings =
            Findings { spec: spec_of_it, serial, frames, path, advice, map, ..Findings::default() };
        self.worker.ask("Measuring", Job::Sweep { job, spec: Box::new(spec) });
    }

    /// Numbers of the views of a path that stand for it, so many at most; where objects move, the first ones,
    /// since each view sees a frame of its own.
    fn frames_of(&self, views: usize, most: usize) -> Vec<usize> {
        let is_moving = self.staged().is_some_and(|stage| stage.frame_of_motion().is_some());
        let count = most.min(views);
        (0..count).map(|k| if is_moving { k } else { k * views / count }).collect()
    }

    /// What was found about another scene is of no use.
    fn forget_others(&mut self) {
        if self.findings.serial != self.serial {
            self.findings = Findings { serial: self.serial, ..Findings::default() };
        }
    }

    fn ask_advice(&mut self, most_wrong_percent: f64) {
        let Some(stage) = &self.stage else { return };
        let frames = self.frames_of(each!(stage, s => s.views().len()), MOST_VIEWS);
        let job = each!(stage, s => Either({
            (s.scene.clone(), frames.iter().map(|&k| smaller(&s.views()[k])).collect::<Vec<_>>())
        }));
        let wish = Wish { most_wrong_percent, seed: 1 };
        self.forget_others();
        self.worker.ask("Looking for advice", Job::Advise { job, wish });
    }

    fn ask_map(&mut self) {
        let Some(stage) = &self.stage else { return };
        let of = Configuration { method: self.method.clone(), settings: self.settings.clone() };
        let frames = self.frames_of(each!(stage, s => s.views().len()), MOST_VIEWS);
        let job = each!(stage, s => Either({
            (s.scene.clone(), frames.iter().map(|&k| tiny(&s.views()[k])).collect::<Vec<_>>())
        }));
        self.forget_others();
        self.worker.ask("Looking around", Job::Map { job, of, frames });
    }

    /// Puts the Eye somewhere, looking as view `at` of the path does, with a method; commands follow once the
    /// film is there.
    fn stand(&mut self, of: &Configuration, eye: &[f32], at: usize, then: Vec<String>) {
        self.dialog = Dialog::None;
        self.change(0, |s| {
            (s.method, s.settings) = (of.method.clone(), of.settings.clone());
            let Some(stage) = &mut s.stage else { return };
            each!(stage, s => {
                let mut view = s.views()[at.min(s.views().len() - 1)];
                let to = Vector::from_fn(|a| eye.get(a).copied().unwrap_or_default());
                view.eye.target = to + (view.eye.target - view.eye.position);
                view.eye.position = to;
                s.view = s.fitted(view);
            });
        });
        self.commands.extend(then);
        if self.busy().is_none() {
            self.run_commands();
        }
    }

    pub(super) fn take_map(&mut self, map: Map) {
        self.findings.map = Some(Arc::new(map));
        self.record_if_missing();
    }

    /// Takes in what was measured since the last time; returns whether there was anything.
    pub(super) fn take_news(&mut self) -> bool {
        let news: Vec<Line> = self.worker.news();
        let has_some = !news.is_empty();
        news.into_iter().for_each(|line| self.findings.log.add(line));
        if let Some(spec) = self.findings.spec.as_ref().filter(|_| has_some) {
            self.findings.chart = results::charts_so_far(&self.findings.log, spec).pop();
        }
        has_some
    }

    pub(super) fn take_advice(&mut self, advice: Advice) {
        self.findings.advice = Some(Arc::new(advice));
        self.record_if_missing();
    }

    /// Opens a configuration in the frame with the largest error, or the costliest where none has any, and
    /// goes to the first step that went wrong.
    fn open_tried(&mut self, number: u32) {
        let Findings { spec: Some(spec), log, frames, path, serial, .. } = &self.findings else { return };
        let [scene, at] = results::of_number(spec, number);
        let Some(one) = spec.configurations.get(at).filter(|_| *serial == self.serial) else { return };
        let (scene, at) = (scene as u32, at as u32);
        let judged = log.judged.range((scene, at, 0)..(scene, at + 1, 0)).map(|(_, judged)| judged);
        let worst = judged
            .max_by(|a, b| results::error_of(a, spec.error).total_cmp(&results::error_of(b, spec.error)));
        let is_wrong = worst.is_some_and(|judged| results::error_of(judged, spec.error) > 0.0);
        let costliest = || {
            let timed = log.timed.range((scene, at, 0, 0)..(scene, at + 1, 0, 0)).map(|(_, timed)| timed);
            timed.max_by(|a, b| (a.cull_ms + a.draw_ms).total_cmp(&(b.cull_ms + b.draw_ms))).map(|t| t.frame)
        };
        let frame = if is_wrong { worst.map(|judged| judged.frame) } else { costliest() };
        let frame = frame.and_then(|k| frames.get(k as usize)).copied().unwrap_or(0);
        let (one, path): (Configuration, usize) = (one.clone(), *path);
        self.dialog = Dialog::None;
        let before = (self.film().is_some(), self.busy().is_some());
        self.change(0, |s| {
            (s.method, s.settings) = (one.method, one.settings);
            if let Some(stage) = &mut s.stage {
                stage.go(path, frame);
            }
        });
        let then = if is_wrong { "first-wrong" } else { "first" };
        self.commands.push(then.to_owned());
        // Nothing changed, so the film is there already.
        if before == (true, false) && self.busy().is_none() {
            self.run_commands();
        }
    }

    /// Goes to the first step that left out something that is visible.
    pub(super) fn go_first_wrong(&mut self) {
        let Some(stage) = &self.stage else { return };
        match each!(stage, s => first_wrong(s)) {
            Some((step, subject)) => {
                self.go_to(step);
                self.apply(Command::Select(subject));
            }
            None if self.film().is_some() => {
                self.tell("Nothing went wrong here: all that is visible is drawn.");
            }
            None => {}
        }
    }
}

/// The step that first decided against a visible primitive, and that primitive; where each has something
/// drawn in its place, the first of those.
fn first_wrong<S: Drawable>(stage: &Stage<S>) -> Option<(usize, Subject)> {
    let recorded = stage.recorded.as_ref()?;
    let film = &recorded.film;
    let decided = recorded.truth.visible.iter().map(|&prim| {
        // What was never decided was left out when the film ended.
        let end = (film.events().len(), Verdict::OverBudget);
        let (step, verdict) = recorded.stamps.prim_decision(prim).unwrap_or(end);
        (verdict == Verdict::Approximated, step, prim, verdict)
    });
    let wrong = decided.filter(|(.., verdict)| *verdict != Verdict::Visible);
    let first = wrong.min_by_key(|(is_stood_for, step, prim, _)| (*is_stood_for, *step, prim.0))?;
    Some((first.1, Subject::Prim(first.2)))
}

/// All methods with their defaults, those that have a budget with others, and the chosen one with each of its
/// parameters at other values.
fn tried_on<S: Methods + Drawable>(
    _: &Stage<S>,
    (method, settings): &(String, Settings),
) -> Vec<Configuration> {
    let mut all = Vec::new();
    for entry in S::methods() {
        all.push(defaults::<S>(*entry));
        let is_chosen = entry.card().key == method;
        let knobs = entry.knobs(&Settings::default()).unwrap_or_default();
        let is_budget = |name: &str| {
            knobs.iter().any(|(knob, value)| {
                knob.name == name && matches!(value, KnobValue::Budget(Budget::Percent(_)))
            })
        };
        let others = variations::<S>(*entry);
        all.extend(others.into_iter().filter(|one| is_chosen || one.settings.0.keys().any(|k| is_budget(k))));
        let now = Configuration { method: method.clone(), settings: settings.clone() };
        if is_chosen && !all.contains(&now) {
            all.push(now);
        }
    }
    all
}

/// The view with a smaller image, if it is large.
fn smaller<S: Space>(view: &View<S>) -> View<S> {
    at_most(view, LONGEST_PX)
}

/// The view with an image that can be looked at from hundreds of places.
fn tiny<S: Space>(view: &View<S>) -> View<S> {
    at_most(view, TINY_PX)
}

fn at_most<S: Space>(view: &View<S>, most_px: u32) -> View<S> {
    let longest = view.width.max(view.height);
    if longest <= most_px {
        return *view;
    }
    let side = |n: u32| (n * most_px / longest).max(1);
    let height = if S::Vector::AXES == 2 { 1 } else { side(view.height) };
    View { width: side(view.width), height, ..*view }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Action;
    use crate::geometry::Either;

    fn opened(source: &str) -> State {
        let mut state = State::new();
        state.apply(Command::Open(source.into()));
        state.block_until_idle();
        assert!(state.film().is_some(), "{:?}", state.notices);
        state
    }

    /// The chart has every method; a point of it opens what it stands for, where it first went wrong.
    #[test]
    fn a_point_of_the_chart_opens_its_worst_step() {
        let mut state = opened("street");
        state.apply(Command::Laboratory(Laboratory::Measure));
        state.block_until_idle();
        let chart = state.findings.chart.clone().expect("a chart");
        let methods: Vec<&str> = state.staged().expect("a stage").methods().iter().map(|m| m.key).collect();
        assert_eq!(chart.curves.iter().map(|c| c.label.as_str()).collect::<Vec<_>>(), methods);
        assert!(state.film().is_some(), "the film that was there is there again");
        let tried = || chart.curves.iter().flat_map(|curve| curve.tried.iter().map(move |t| (curve, t)));
        let (curve, worst) = tried().max_by(|a, b| a.1.error.total_cmp(&b.1.error)).expect("some");
        assert!(worst.error > 1.0, "a small budget is seen");
        let about = state.findings.about(worst.number).expect("words");
        assert!(about.starts_with(&curve.label) && about.contains("wrong pixels"), "{about}");
        state.apply(Command::Laboratory(Laboratory::Open(worst.number)));
        state.block_until_idle();
        assert_eq!((&state.method, state.dialog), (&curve.label, Dialog::None));
        let Subject::Prim(prim) = state.selection else { panic!("{:?}", state.selection) };
        let decided = state.film().and_then(|f| f.stamps.prim_decision(prim));
        assert!(state.step > 0 && decided.is_none_or(|(step, _)| step == state.step), "{decided:?}");
        assert!(decided.is_none_or(|(_, verdict)| verdict != Verdict::Visible));
        // Of what is exact the costliest frame, and nothing is wrong in it.
        let (curve, exact) = tried().find(|(c, t)| c.label == methods[1] && t.error == 0.0).expect("frustum");
        state.apply(Command::Laboratory(Laboratory::Open(exact.number)));
        state.block_until_idle();
        assert_eq!((&state.method, state.step), (&curve.label, 0));
        state.apply(Action::FirstWrong);
        let said = state.notices.last().expect("a notice");
        assert!(!said.is_error && said.text.starts_with("Nothing went wrong"), "{said:?}");
        // What was found about another scene is not shown.
        state.apply(Command::Open("tree".into()));
        state.block_until_idle();
        assert!(!state.is_found_here());
    }

    #[test]
    fn advice_is_used() {
        let mut state = opened("street");
        state.apply(Command::Laboratory(Laboratory::Advise(0.0)));
        state.block_until_idle();
        let advice = state.findings.advice.clone().expect("advice");
        assert!(advice.unseen.wrong_percent == 0.0 && advice.cost[0] < advice.cost[1]);
        state.apply(Command::Laboratory(Laboratory::Use));
        state.block_until_idle();
        let chosen = advice.configuration();
        assert_eq!((&state.method, &state.settings), (&chosen.method, &chosen.settings));
        state.apply(Action::Undo);
        state.block_until_idle();
        assert!(state.settings.0.is_empty(), "using it can be taken back");
    }

    /// A dot of the map, and a flip, put the Eye there.
    #[test]
    fn places_of_the_map_can_be_visited() {
        let mut state = opened("street");
        state.apply(Command::Method("centroid".into()));
        state.block_until_idle();
        state.apply(Command::Laboratory(Laboratory::Map));
        state.block_until_idle();
        let map = state.findings.map.clone().expect("a map");
        assert!(map.found.grid.len() > 100 && map.of.method == "centroid");
        let wrong = map.found.grid.iter().position(|spot| spot.found.missed > 0).expect("a wrong place");
        let dots = map.picture.items.iter().filter(|i| i.subject == Subject::Tried(wrong as u32)).count();
        assert_eq!(dots, 1, "it has a dot");
        assert!(map.about(wrong as u32).is_some_and(|text| text.contains("missed")));
        state.apply(Command::Laboratory(Laboratory::Stand(wrong as u32)));
        state.block_until_idle();
        let Some(Either::Flat(stage)) = &state.stage else { panic!("a flat stage") };
        let at = stage.view.eye.position;
        assert_eq!(vec![at.x, at.y], map.found.grid[wrong].eye);
        assert!(matches!(state.selection, Subject::Prim(_)), "{:?}", state.notices);
        if let Some(flip) = map.found.flips.first() {
            state.apply(Command::Laboratory(Laboratory::Flip(0)));
            state.block_until_idle();
            assert_eq!(state.selection, Subject::Prim(flip.prim));
            // Again, where nothing has to be culled anew.
            state.apply(Command::Select(Subject::None));
            state.apply(Command::Laboratory(Laboratory::Flip(0)));
            state.block_until_idle();
            assert_eq!(state.selection, Subject::Prim(flip.prim));
        }
    }

    /// What was measured until a stop stays.
    #[test]
    fn measuring_can_be_stopped() {
        let mut state = opened("street");
        state.apply(Command::Laboratory(Laboratory::Measure));
        state.apply(Command::Laboratory(Laboratory::Stop));
        state.block_until_idle();
        assert!(state.busy().is_none() && state.film().is_some());
    }
}
