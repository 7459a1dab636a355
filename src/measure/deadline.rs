//! Budgets in milliseconds: frames that are culled and drawn until a deadline (Klosowski and Silva 2000,
//! Section 3, <https://doi.org/10.1109/2945.856993>: "time-critical").
//!
//! The method tells what it drew every few hundred primitives; that is rasterized at once, and the frame ends
//! where the next piece, should it take as long as the longest so far, would end behind the deadline. What is
//! drawn then depends on the machine, so a film is recorded with the number of primitives that the timed
//! frame drew: it shows that frame, on any machine. [`paced`] gives a run whose budget is a time this
//! behavior; [`frame_within`] is one such frame.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::timing::Stopwatch;
use crate::geometry::{PrimId, View};
use crate::index::Hierarchy;
use crate::method::{Budget, DrawList, Knob, KnobValue, Limit, Recording, Run, SettingError, Tally};
use crate::raster::{Drawable, Options, Target};
use crate::scene::Scene;

/// Timed frames that are remembered, so that a film shows the frame that was drawn.
const REMEMBERED: usize = 4096;

/// A frame that ended in time, or nearly.
pub struct TimedFrame {
    /// What was drawn.
    pub list: DrawList,
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
    scene: &Arc<Scene<S>>,
    view: &View<S>,
    mut image: Target,
    ms: f64,
) -> TimedFrame {
    if (image.width, image.height) != (view.width, view.height) {
        // Memory is fetched before the clock starts.
        image.clear(view);
    }
    let watch = Stopwatch::start();
    image.clear(view);
    let canvas = Arc::new(Mutex::new(Canvas { image, watch, longest_ms: 0.0, asked_ms: watch.elapsed_ms() }));
    let limit: Limit = {
        let (canvas, scene, view) = (canvas.clone(), scene.clone(), *view);
        Arc::new(move |prims: &[PrimId]| {
            let mut canvas = canvas.lock().unwrap_or_else(PoisonError::into_inner);
            S::draw(&mut canvas.image, &scene, &view, prims, &Options::default());
            let now = canvas.watch.elapsed_ms();
            canvas.longest_ms = canvas.longest_ms.max(now - canvas.asked_ms);
            canvas.asked_ms = now;
            now + canvas.longest_ms >= ms
        })
    };
    run.limit(Some(limit));
    let list = run.cull(view);
    run.limit(None);
    let image = std::mem::take(&mut canvas.lock().unwrap_or_else(PoisonError::into_inner).image);
    TimedFrame { list, image, ms: watch.elapsed_ms() }
}

/// The milliseconds of a run's budget, if it is a time.
fn time_of<S: Drawable>(run: &dyn Run<S>) -> Option<f64> {
    run.knobs().into_iter().find_map(|(_, value)| match value {
        KnobValue::Budget(Budget::Milliseconds(ms)) => Some(f64::from(ms)),
        _ => None,
    })
}

/// A run that keeps the deadline which its budget names, if it names one.
///
/// # Errors
/// The budget is a time, and the method asks nobody when to end.
pub fn paced<S: Drawable>(
    mut run: Box<dyn Run<S>>,
    scene: &Arc<Scene<S>>,
) -> Result<Box<dyn Run<S>>, SettingError> {
    let Some(ms) = time_of(&*run) else { return Ok(run) };
    if !run.limit(None) {
        let expected =
            format!("a number of primitives or a share: `{}` cannot be ended at a deadline", run.card().key);
        return Err(SettingError::BadValue {
            key: "budget",
            value: Budget::Milliseconds(ms as f32).to_string(),
            expected,
        });
    }
    Ok(Box::new(Paced { run, scene: scene.clone(), ms, image: Target::default(), drawn: Vec::new() }))
}

struct Paced<S: Drawable> {
    run: Box<dyn Run<S>>,
    scene: Arc<Scene<S>>,
    ms: f64,
    image: Target,
    /// How many primitives the timed frame of a view drew.
    drawn: Vec<(View<S>, u32)>,
}

impl<S: Drawable> Paced<S> {
    /// Does something with the number of primitives that the timed frame of the view drew in place of the
    /// time.
    fn counted<T>(&mut self, view: &View<S>, work: impl FnOnce(&mut dyn Run<S>) -> T) -> T {
        let known = self.drawn.iter().rev().find(|(of, _)| of == view).map(|(_, n)| *n);
        let count = known.unwrap_or_else(|| self.cull(view).prims.len() as u32);
        let drawn = AtomicUsize::new(0);
        // Also ended from outside, as the timed frame was: what a method does after a budget of its own does
        // not follow.
        let limit: Limit = Arc::new(move |prims: &[PrimId]| {
            drawn.fetch_add(prims.len(), Ordering::Relaxed) + prims.len() >= count as usize
        });
        self.run.set_budget(Budget::Count(count));
        self.run.limit(Some(limit));
        let result = work(&mut *self.run);
        self.run.limit(None);
        self.run.set_budget(Budget::Milliseconds(self.ms as f32));
        result
    }
}

impl<S: Drawable> Run<S> for Paced<S> {
    fn card(&self) -> &'static crate::method::Card {
        self.run.card()
    }
    fn knobs(&self) -> Vec<(Knob, KnobValue)> {
        self.run.knobs()
    }
    fn hierarchy(&self) -> &dyn Hierarchy<S> {
        self.run.hierarchy()
    }
    fn cull(&mut self, view: &View<S>) -> DrawList {
        let frame = frame_within(&mut *self.run, &self.scene, view, std::mem::take(&mut self.image), self.ms);
        self.image = frame.image;
        if self.drawn.len() == REMEMBERED {
            self.drawn.clear();
        }
        self.drawn.push((*view, frame.list.prims.len() as u32));
        frame.list
    }
    fn count(&mut self, view: &View<S>) -> (DrawList, Tally) {
        self.counted(view, |run| run.count(view))
    }
    fn record(&mut self, view: &View<S>, cap: usize) -> Recording<S> {
        self.counted(view, |run| run.record(view, cap))
    }
    fn forget(&mut self) {
        self.run.forget();
    }
    fn save(&self) -> Option<Vec<u8>> {
        self.run.save()
    }
    fn remembers(&self) -> bool {
        self.run.remembers()
    }
    fn limit(&mut self, limit: Option<Limit>) -> bool {
        self.run.limit(limit)
    }
    fn set_budget(&mut self, budget: Budget) {
        self.run.set_budget(budget);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::Methods;
    use crate::geometry::{Flat, Solid};
    use crate::method::Settings;
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
        let settings = Settings(pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect());
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
            let mut run =
                paced(ready::<S>("layered-projection", budget, scene), scene).expect("it can be ended");
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
        let mut asking = paced(asking, scene).expect("it can be ended");
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

    #[test]
    fn a_method_that_cannot_be_ended_says_so() {
        let scene = samples::soup::<Flat>(1, 30);
        let error =
            paced(ready::<Flat>("centroid", "5ms", &scene), &scene).err().expect("refused").to_string();
        assert!(error.contains("budget=5ms") && error.contains("centroid"), "{error}");
        assert!(paced(ready::<Flat>("centroid", "5%", &scene), &scene).is_ok());
    }
}
