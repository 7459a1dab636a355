//! Budgets in milliseconds: frames that are culled and drawn until a deadline (Klosowski and Silva 2000,
//! Section 3, <https://doi.org/10.1109/2945.856993>: "time-critical").
//!
//! The method reports what it drew every few hundred primitives; that is rasterized at once, and the frame
//! ends when another piece as slow as the slowest so far would miss the deadline. What is drawn then depends
//! on the machine, so a film is recorded with the number of primitives that the timed frame drew: it shows
//! that frame, on any machine. [`Paced`] gives a run whose budget is a time this behavior; [`frame_within`]
//! is one such frame.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use super::timing::{Stopwatch, timed};
use crate::geometry::{PrimId, View};
use crate::method::{Budget, DrawList, KnobValue, Limit, Recording, Run, Tally, surfaces_of};
use crate::raster::{Drawable, Options, Target};
use crate::scene::{Progress, Scene};

/// Timed frames that are remembered, so that a film shows the frame that was drawn.
const REMEMBERED: usize = 4096;

/// A frame that ended in time, or nearly.
pub struct TimedFrame<S: Drawable> {
    /// What was drawn.
    pub list: DrawList<S>,
    /// Its image.
    pub image: Target,
    /// From the view to the finished image, milliseconds.
    pub ms: f64,
}

/// The image while it is drawn.
struct Canvas {
    image: Target,
    watch: Stopwatch,
    longest_ms: f64,
    asked_ms: f64,
}

/// Culls and draws one frame, which ends at `ms` milliseconds after it began or before. `image` is reused. A
/// method that cannot be ended draws what it draws.
pub fn frame_within<S: Drawable>(
    run: &mut dyn Run<S>,
    scene: &Scene<S>,
    view: &View<S>,
    mut image: Target,
    ms: f64,
) -> TimedFrame<S> {
    if (image.width, image.height) != (view.width, view.height) {
        // Memory is fetched before the clock starts.
        image.clear(view);
    }
    let options = Options { surfaces: surfaces_of(&run.knobs()).both_sides(), ..Options::default() };
    let watch = Stopwatch::start();
    image.clear(view);
    let canvas = RefCell::new(Canvas { image, watch, longest_ms: 0.0, asked_ms: watch.elapsed_ms() });
    let limit = |prims: &[PrimId]| {
        let mut canvas = canvas.borrow_mut();
        S::draw(&mut canvas.image, scene, view, prims, &options);
        let now = canvas.watch.elapsed_ms();
        canvas.longest_ms = canvas.longest_ms.max(now - canvas.asked_ms);
        canvas.asked_ms = now;
        now + canvas.longest_ms >= ms
    };
    let list = run.cull_until(view, Some(&limit));
    TimedFrame { list, image: canvas.into_inner().image, ms: watch.elapsed_ms() }
}

/// Culls a frame: what it draws, and the time of each stage by name, milliseconds. Until the method names its
/// first stage, the state of the frame is cleared: `clear`.
pub fn stages_ms<S: Drawable>(
    run: &mut dyn Run<S>,
    view: &View<S>,
) -> (DrawList<S>, BTreeMap<&'static str, f64>) {
    let (watch, mut stages) = (Stopwatch::start(), BTreeMap::new());
    let mut last = ("clear", 0.0);
    let mut end = |next: &'static str| {
        let now = watch.elapsed_ms();
        let (name, since) = std::mem::replace(&mut last, (next, now));
        *stages.entry(name).or_default() += now - since;
    };
    let list = run.stages(view, &mut end);
    end("");
    (list, stages)
}

/// The milliseconds of a run's budget, if it is a time.
fn time_of<S: Drawable>(run: &dyn Run<S>) -> Option<f64> {
    run.knobs().into_iter().find_map(|(_, value)| match value {
        KnobValue::Budget(Budget::Milliseconds(ms)) => Some(f64::from(ms)),
        _ => None,
    })
}

/// A run that keeps the deadline which its budget names, if it names one; in all else it is the run.
pub struct Paced<S: Drawable> {
    run: Box<dyn Run<S>>,
    scene: Arc<Scene<S>>,
    image: Target,
    /// How many primitives the timed frame of a view drew, by the frame of the scene.
    drawn: Vec<(View<S>, Option<usize>, u32)>,
}

impl<S: Drawable> Deref for Paced<S> {
    type Target = dyn Run<S>;
    fn deref(&self) -> &(dyn Run<S> + 'static) {
        &*self.run
    }
}
impl<S: Drawable> DerefMut for Paced<S> {
    fn deref_mut(&mut self) -> &mut (dyn Run<S> + 'static) {
        &mut *self.run
    }
}

impl<S: Drawable> Paced<S> {
    /// Paces a run on its scene.
    pub fn new(run: Box<dyn Run<S>>, scene: &Arc<Scene<S>>) -> Self {
        Self { run, scene: scene.clone(), image: Target::default(), drawn: Vec::new() }
    }
    /// As [`Run::pose`].
    pub fn pose(&mut self, scene: &Arc<Scene<S>>, progress: &dyn Progress) -> bool {
        let posed = self.run.pose(scene, progress);
        if posed {
            self.scene.clone_from(scene);
        }
        posed
    }
    /// As [`Run::cull`], until the deadline.
    pub fn cull(&mut self, view: &View<S>) -> DrawList<S> {
        let Some(ms) = time_of(&*self.run) else { return self.run.cull(view) };
        let frame = frame_within(&mut *self.run, &self.scene, view, std::mem::take(&mut self.image), ms);
        self.image = frame.image;
        if self.drawn.len() == REMEMBERED {
            self.drawn.clear();
        }
        self.drawn.push((*view, self.scene.frame(), frame.list.prims.len() as u32));
        frame.list
    }
    /// As [`Paced::cull`], with the time of each stage of the frame by name, milliseconds; a frame that ends
    /// at a deadline draws as it culls, and has one stage.
    pub fn stages_ms(&mut self, view: &View<S>) -> (DrawList<S>, BTreeMap<&'static str, f64>) {
        if time_of(&*self.run).is_some() {
            let (list, ms) = timed(|| self.cull(view));
            return (list, BTreeMap::from([("cull-and-draw", ms)]));
        }
        stages_ms(&mut *self.run, view)
    }
    /// As [`Run::count`], of the frame that [`Paced::cull`] drew.
    pub fn count(&mut self, view: &View<S>) -> (DrawList<S>, Tally) {
        self.counted(view, |run, limit| run.count_until(view, limit))
    }
    /// As [`Run::record`], of the frame that [`Paced::cull`] drew.
    pub fn record(&mut self, view: &View<S>, cap: usize) -> Recording<S> {
        self.counted(view, |run, limit| run.record_until(view, limit, cap))
    }
    /// Does something with the number of primitives that the timed frame of the view drew in place of the
    /// time.
    fn counted<T>(
        &mut self,
        view: &View<S>,
        work: impl FnOnce(&mut dyn Run<S>, Option<&Limit<'_>>) -> T,
    ) -> T {
        let Some(ms) = time_of(&*self.run) else { return work(&mut *self.run, None) };
        let now = (view, self.scene.frame());
        let known = self.drawn.iter().rev().find(|(of, frame, _)| (of, *frame) == now).map(|d| d.2);
        let count = known.unwrap_or_else(|| self.cull(view).prims.len() as u32);
        let drawn = Cell::new(0);
        // Also ended from outside, as the timed frame was: what a method does after a budget of its own does
        // not follow.
        let limit = |prims: &[PrimId]| {
            drawn.set(drawn.get() + prims.len());
            drawn.get() >= count as usize
        };
        self.run.set_budget(Budget::Count(count));
        let result = work(&mut *self.run, Some(&limit));
        self.run.set_budget(Budget::Milliseconds(ms as f32));
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::Methods;
    use crate::geometry::{Flat, Solid};
    use crate::method::{Knob, Settings};
    use crate::raster::render;
    use crate::scene::{Quiet, random_views, samples};

    fn ready<S: Methods + Drawable>(method: &str, budget: &str, scene: &Arc<Scene<S>>) -> Box<dyn Run<S>> {
        ready_with(method, &[("budget", budget)], scene)
    }
    fn ready_with<S: Methods + Drawable>(
        method: &str,
        pairs: &[(&str, &str)],
        scene: &Arc<Scene<S>>,
    ) -> Box<dyn Run<S>> {
        let settings = Settings::of(pairs);
        S::method(method)
            .expect("listed")
            .ready(scene, &settings, &Quiet)
            .expect("it fits")
            .expect("not cancelled")
    }

    fn ends<S: Methods + Drawable>(scene: &Arc<Scene<S>>) {
        let mut all = ready::<S>("layered-projection", "100%", scene);
        let view = random_views(scene, 1, 1)[0];
        let whole = all.cull(&view);
        // At once, and never: whatever the machine does.
        for (budget, is_all) in [("0.000001ms", false), ("1000000ms", true)] {
            let mut run = Paced::new(ready::<S>("layered-projection", budget, scene), scene);
            let list = run.cull(&view);
            assert_eq!(list.prims, whole.prims[..list.prims.len()]);
            assert_eq!(
                list.prims.len() == whole.prims.len(),
                is_all,
                "{budget}: {} of {}",
                list.prims.len(),
                whole.prims.len()
            );
            let recording = run.record(&view, usize::MAX);
            assert_eq!(
                (&recording.list, &run.count(&view).0),
                (&list, &list),
                "the film shows the frame that was drawn"
            );
            let budget_of = |knobs: &[(Knob, KnobValue)]| {
                knobs.iter().find(|(k, _)| k.name == "budget").map(|(_, v)| v.to_string())
            };
            assert_eq!(budget_of(recording.film.knobs()), Some(list.prims.len().to_string()));
            assert_eq!(budget_of(&run.knobs()).as_deref(), Some(budget));
        }
        let asking =
            ready_with("layered-projection", &[("budget", "0.000001ms"), ("queries", "true")], scene);
        let mut asking = Paced::new(asking, scene);
        let list = asking.cull(&view);
        assert!(list.prims.len() < whole.prims.len(), "a deadline also ends what follows a budget");
        assert_eq!(asking.record(&view, usize::MAX).list, list);
        let frame = frame_within(&mut *all, scene, &view, Target::default(), 1e9);
        assert_eq!(frame.image.item, render(scene, &view, &frame.list.prims).item);
    }

    #[test]
    fn frames_end_at_their_deadline_and_films_show_them() {
        ends(&samples::soup::<Flat>(1, 3000));
        ends(&samples::soup::<Solid>(1, 3000));
    }

    fn names_its_stages<S: Methods + Drawable>(scene: &Arc<Scene<S>>) {
        let view = random_views(scene, 1, 3)[0];
        for entry in S::methods() {
            let ready =
                || entry.ready(scene, &Settings::default(), &Quiet).expect("defaults").expect("ready");
            let (list, stages) = Paced::new(ready(), scene).stages_ms(&view);
            let key = entry.card().key;
            assert_eq!(list, ready().cull(&view), "{key}: the same frame");
            assert!(stages.len() > 1 && stages.values().all(|ms| *ms >= 0.0), "{key}: {stages:?}");
        }
    }

    #[test]
    fn every_method_names_the_stages_of_its_frames() {
        names_its_stages(&samples::soup::<Flat>(2, 200));
        names_its_stages(&samples::soup::<Solid>(2, 200));
    }

    #[test]
    fn a_method_that_cannot_be_ended_says_so() {
        let settings = |budget: &str| Settings([("budget".to_owned(), budget.to_owned())].into());
        let knobs = |budget: &str| Flat::method("centroid").expect("listed").knobs(&settings(budget));
        let error = knobs("5ms").expect_err("refused").to_string();
        assert!(error.contains("budget=5ms") && error.contains("cannot be ended"), "{error}");
        assert!(knobs("5%").is_ok());
    }
}
