//! Advice: the simplest configuration that is right enough at the least time, for a scene and a path.
//!
//! What could be tried are all methods with their defaults, and each of their parameters by itself at other
//! values. To try all of it on all frames takes too long, so this is successive halving (Jamieson and
//! Talwalkar 2016, AISTATS, "Non-stochastic best arm identification and hyperparameter optimization"):
//!
//! 1. every method with its defaults, on a few frames;
//! 2. parameters of those methods that could still win, method by method: it was at most [`SLACK`] times as
//!    slow as the best that is right enough, or is fast and not right enough. What is slower than that goes;
//! 3. the better half of all goes on to twice as many frames, until few are left; those of the best method's
//!    parameters that helped are also tried together;
//! 4. those few, beside plain drawing and frustum culling, on all frames in turn;
//! 5. the best of them is checked on the other half of the path's views, which none was chosen by. If it is
//!    not right enough there, the next one is.
//!
//! Methods remember from frame to frame, so the path is parted into stretches of frames that follow each
//! other: every second one is kept back. Of each of the others some frames are looked at, after one that does
//! not count: a few frames stand for all of the path.
//!
//! Of those within [`NOISE`] of the best the simplest is advised: the one with the fewest parameters set, and
//! among those the one that is listed first. Cost: some tenth of the frames of the full grid.

mod candidates;

pub use candidates::{defaults, variations};

use std::sync::Arc;

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::columns::column;
use super::deadline::Paced;
use super::experiment::{ExperimentError, World};
use super::harness::{checkpoint, part};
use super::sweep::{Configuration, results};
use super::table::{Cell, Table};
use super::timing::{median, timed};
use crate::drawing::{Curve, Plot, Role, Series, Shape, Tradeoff, Tried};
use crate::geometry::View;
use crate::method::{DrawList, Settings, surfaces_of};
use crate::raster::{Canvas, Options, Target};
use crate::scene::{Motion, Part, Progress, Scene, Surfaces};
use crate::truth::Truth;

/// A method whose defaults take longer than so many times the best is not looked into.
pub const SLACK: f64 = 1.6;
/// Times that differ by no more are the same.
pub const NOISE: f64 = 1.05;
/// Frames of each stretch in the first round, and flights of the last.
const FIRST: usize = 2;
const FLIGHTS: usize = 3;
/// Frames of a stretch at least and at most, and stretches of either half at most: of a long path parts are
/// enough.
const STRETCH: usize = 4;
const LONGEST: usize = 12;
const STRETCHES: usize = 4;
/// So many go into the last round.
const LAST: usize = 4;
/// The methods that hide nothing, drawing all and frustum culling, are the first of the list, in this order.
const PLAIN: usize = 2;
const FRUSTUM: usize = 1;
/// What the images have behind the scene, linear.
const BACKGROUND: [f32; 3] = [1.0; 3];

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Wrong pixels at most, per cent of all images together; 0 asks for a promise, since what happens to be
    /// right in some views need not be in others.
    pub most_wrong_percent: f64,
    /// Decides which half of the views is kept back.
    pub seed: u64,
}

impl Wish {
    /// Whether a configuration is right enough, as far as it was tried.
    fn is_met(&self, trial: &Trial) -> bool {
        trial.wrong_percent <= self.most_wrong_percent && (trial.promises || self.most_wrong_percent > 0.0)
    }
}

/// A configuration that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What.
    pub configuration: Configuration,
    /// Frames on which it was.
    pub frames: usize,
    /// From the view to the image, milliseconds: the mean of the frames, each the median of its flights.
    pub time_ms: f64,
    /// Wrong pixels, per cent.
    pub wrong_percent: f64,
    /// What its index takes.
    pub index_bytes: usize,
    /// What building it took, milliseconds.
    pub build_ms: f64,
    /// Whether it promises to draw all that is visible.
    pub promises: bool,
}

/// How something did on some frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flown {
    /// Frames.
    pub frames: usize,
    /// From the view to the image in the mean, milliseconds.
    pub time_ms: f64,
    /// Wrong pixels, per cent.
    pub wrong_percent: f64,
    /// Wrong pixels of the worst frame, per cent.
    pub worst_percent: f64,
}

/// What to use, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// What was asked for.
    pub wish: Wish,
    /// The number of the trial that is advised.
    pub chosen: usize,
    /// All that was tried, in the order in which it was.
    pub trials: Vec<Trial>,
    /// How the advised one did on the views that it was not chosen by, and frustum culling there.
    pub unseen: Flown,
    /// The plain method beside it that only leaves out what is out of view, on the same views.
    pub frustum: Flown,
    /// Candidates that did well but were not right enough on unseen views.
    pub refused: Vec<usize>,
    /// Frames that were culled and drawn, and those that the full grid would have taken.
    pub cost: [usize; 2],
}

/// A candidate that is ready.
struct Ready<S: World> {
    run: Paced<S>,
    options: Options,
    surfaces: Surfaces,
}

/// Views that follow each other, with their numbers, of which scenes that move have a frame each.
type Stretch<S> = Vec<(usize, View<S>)>;

/// Frames of a scene.
struct Course<'a, S: World> {
    scene: &'a Arc<Scene<S>>,
    motion: Motion<S>,
    /// What is chosen by, and what is kept back.
    seen: Vec<Stretch<S>>,
    unseen: Vec<Stretch<S>>,
    /// What is visible, for each way to take surfaces.
    truths: Vec<(Surfaces, Truth)>,
    images: (Target, Canvas),
    flown: usize,
}

impl<S: World> Course<'_, S> {
    /// Runs candidates in turn on `most` frames of each stretch of one half, after one that does not count;
    /// for each the times of frames and their wrong pixels.
    fn fly(
        &mut self,
        runs: &mut [&mut Ready<S>],
        (is_seen, most): (bool, usize),
        flights: usize,
        progress: &dyn Progress,
    ) -> Result<Vec<Flown>, ExperimentError> {
        let plan = if is_seen { self.seen.clone() } else { self.unseen.clone() };
        let count = runs.len();
        let mut times: Vec<Vec<Vec<f64>>> = vec![Vec::new(); count];
        let mut wrong: Vec<Vec<f64>> = vec![Vec::new(); count];
        for flight in 0..flights {
            let mut frame = 0;
            for (at, stretch) in plan.iter().enumerate() {
                let done = (flight * plan.len() + at) as f32 / (flights * plan.len()) as f32;
                checkpoint(progress, done, "trying")?;
                self.warm(runs, &stretch[0], progress)?;
                for &(number, view) in stretch.iter().skip(usize::from(stretch.len() > 1)).take(most) {
                    let scene = self.motion.at(number);
                    for turn in 0..count {
                        let which = (turn + frame + flight) % count;
                        let (ms, percent) =
                            self.frame(&mut *runs[which], (&scene, &view), flight == 0, progress)?;
                        if flight == 0 {
                            times[which].push(Vec::new());
                            wrong[which].push(percent);
                        }
                        times[which][frame].push(ms);
                    }
                    frame += 1;
                }
            }
        }
        let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len().max(1) as f64;
        let of = |(times, wrong): (Vec<Vec<f64>>, Vec<f64>)| Flown {
            frames: wrong.len(),
            time_ms: mean(&times.into_iter().map(median).collect::<Vec<_>>()),
            wrong_percent: mean(&wrong),
            worst_percent: wrong.iter().copied().fold(0.0, f64::max),
        };
        Ok(times.into_iter().zip(wrong).map(of).collect())
    }

    /// Lets candidates see a frame that does not count, from no memory.
    fn warm(
        &mut self,
        runs: &mut [&mut Ready<S>],
        (number, view): &(usize, View<S>),
        progress: &dyn Progress,
    ) -> Result<(), ExperimentError> {
        let scene = self.motion.at(*number);
        for ready in runs.iter_mut() {
            ready.run.forget();
            if !ready.run.pose(&scene, progress) {
                return Err(ExperimentError::Cancelled);
            }
            ready.run.cull(view);
        }
        Ok(())
    }

    /// Culls and draws a frame: milliseconds, and if it is judged its wrong pixels, per cent.
    fn frame(
        &mut self,
        ready: &mut Ready<S>,
        (scene, view): (&Arc<Scene<S>>, &View<S>),
        is_judged: bool,
        progress: &dyn Progress,
    ) -> Result<(f64, f64), ExperimentError> {
        if !ready.run.pose(scene, progress) {
            return Err(ExperimentError::Cancelled);
        }
        let (list, cull_ms) = timed(|| ready.run.cull(view));
        let images = (&mut self.images.0, &mut self.images.1);
        let ((), draw_ms) = timed(|| list.draw(images, scene, view, &ready.options));
        self.flown += 1;
        let wrong = if is_judged { self.wrong_percent(ready.surfaces, scene, view, &list) } else { 0.0 };
        Ok((cull_ms + draw_ms, wrong))
    }

    /// Wrong pixels of a list that was just drawn, per cent.
    fn wrong_percent(
        &mut self,
        surfaces: Surfaces,
        scene: &Scene<S>,
        view: &View<S>,
        list: &DrawList<S>,
    ) -> f64 {
        let known = self.truths.iter().position(|(of, _)| *of == surfaces);
        let known = known.unwrap_or_else(|| {
            self.truths.push((surfaces, Truth::new(self.scene, surfaces, 1, BACKGROUND)));
            self.truths.len() - 1
        });
        let judged = self.truths[known].1.judge(scene, view, list, (&self.images.0, &self.images.1));
        100.0 * judged.wrong_pixel_ratio()
    }
}

/// The candidates while they become fewer.
struct Halving<'a, S: World> {
    wish: Wish,
    course: Course<'a, S>,
    first: Arc<Scene<S>>,
    trials: Vec<Trial>,
    ready: Vec<Option<Ready<S>>>,
}

impl<S: World> Halving<'_, S> {
    /// Adds a candidate; its number, or `None` if it is there already.
    fn add(
        &mut self,
        configuration: Configuration,
        progress: &dyn Progress,
    ) -> Result<Option<usize>, ExperimentError> {
        if self.trials.iter().any(|trial| trial.configuration == configuration) {
            return Ok(None);
        }
        let entry = super::experiment::method::<S>(&configuration.method)?;
        let (run, build_ms) = timed(|| entry.ready(&self.first, &configuration.settings, progress));
        let run = run?.ok_or(ExperimentError::Cancelled)?;
        let surfaces = surfaces_of(&run.knobs());
        let (index_bytes, promises) = (run.hierarchy().bytes(), run.is_conservative());
        let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
        self.ready.push(Some(Ready { run: Paced::new(run, &self.first), options, surfaces }));
        let (frames, time_ms, wrong_percent) = (0, f64::INFINITY, 0.0);
        self.trials.push(Trial {
            configuration,
            frames,
            time_ms,
            wrong_percent,
            index_bytes,
            build_ms,
            promises,
        });
        Ok(Some(self.trials.len() - 1))
    }

    /// Tries some on so many frames of each stretch.
    fn try_on(
        &mut self,
        some: &[usize],
        frames: usize,
        flights: usize,
        progress: &dyn Progress,
    ) -> Result<(), ExperimentError> {
        let chosen = self.ready.iter_mut().enumerate().filter(|(k, _)| some.contains(k));
        let (numbers, mut runs): (Vec<usize>, Vec<&mut Ready<S>>) =
            chosen.filter_map(|(k, ready)| Some((k, ready.as_mut()?))).unzip();
        let results = self.course.fly(&mut runs, (true, frames), flights, progress)?;
        for (number, result) in numbers.into_iter().zip(results) {
            let trial = &mut self.trials[number];
            (trial.frames, trial.time_ms) = (result.frames, result.time_ms);
            trial.wrong_percent = result.wrong_percent;
        }
        Ok(())
    }

    fn is_right(&self, number: usize) -> bool {
        self.wish.is_met(&self.trials[number])
    }

    /// Some by their times, those that are right enough first.
    fn sorted(&self, mut some: Vec<usize>) -> Vec<usize> {
        let key = |&k: &usize| (!self.is_right(k), self.trials[k].time_ms);
        some.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        some
    }
    /// The least time of those that are right enough.
    fn best_ms(&self, some: &[usize]) -> f64 {
        let right = some.iter().filter(|&&k| self.is_right(k));
        right.map(|&k| self.trials[k].time_ms).fold(f64::INFINITY, f64::min)
    }
    /// Lets go of what is not among some.
    fn keep(&mut self, some: &[usize]) {
        let dropped = self.ready.iter_mut().enumerate().filter(|(k, _)| !some.contains(k));
        dropped.for_each(|(_, ready)| *ready = None);
    }
    /// The settings of a method's candidates that were right enough and faster than its defaults, joined.
    fn joined(&self, best: usize, some: &[usize]) -> Option<Configuration> {
        let method = &self.trials[best].configuration.method;
        let of = |k: &usize| self.trials[*k].configuration.method == *method;
        let plain = some.iter().find(|k| of(k) && self.trials[**k].configuration.settings.0.is_empty())?;
        let limit = self.trials[*plain].time_ms / NOISE;
        let mut joined = Settings::default();
        for &k in &self.sorted(some.to_vec()) {
            if of(&k) && self.is_right(k) && self.trials[k].time_ms < limit {
                for (name, value) in &self.trials[k].configuration.settings.0 {
                    joined.0.entry(name.clone()).or_insert_with(|| value.clone());
                }
            }
        }
        (joined.0.len() > 1).then(|| Configuration { method: method.clone(), settings: joined })
    }
}

/// Advises on a scene that is seen from some views. Half of them are kept back for the check; of a single one
/// there is no check.
///
/// # Errors
/// It was cancelled, or a method does not run.
pub fn advise<S: World>(
    scene: &Arc<Scene<S>>,
    views: &[View<S>],
    wish: Wish,
    progress: &dyn Progress,
) -> Result<Advice, ExperimentError> {
    let mut halving = begin(scene, views, wish);
    let plain = halving.defaults(&part(progress, 0.0, 0.3))?;
    let left = halving.widened(&plain, &part(progress, 0.3, 0.7))?;
    let left = halving.narrowed(left, &part(progress, 0.7, 0.9))?;
    // 4. The last few beside the plain ones, on all frames.
    let others = plain.iter().copied().take(PLAIN).filter(|k| !left.contains(k)).collect::<Vec<_>>();
    let left = [left, others].concat();
    halving.keep(&left);
    for &k in &left {
        if halving.ready[k].is_none() {
            halving.renew(k, progress)?;
        }
    }
    halving.try_on(&left, LONGEST, FLIGHTS, &part(progress, 0.9, 0.96))?;
    // 5. The check.
    halving.checked(left, &part(progress, 0.96, 1.0))
}

fn begin<'a, S: World>(scene: &'a Arc<Scene<S>>, views: &[View<S>], wish: Wish) -> Halving<'a, S> {
    // A single view is its own check.
    let views = if views.len() < 2 { [views, views].concat() } else { views.to_vec() };
    let count = 2 * (views.len() / (2 * STRETCH)).clamp(1, STRETCHES);
    let numbered: Vec<_> = views.into_iter().enumerate().collect();
    let n = numbered.len();
    // Which half is kept back is decided by lot.
    let kept = 1 - (Pcg32::new(wish.seed, 17).next_u32() % 2) as usize;
    let stretches = (0..count).map(|k| {
        let all = &numbered[k * n / count..(k + 1) * n / count];
        (k % 2 == kept, all[..all.len().min(LONGEST + 1)].to_vec())
    });
    let (unseen, seen): (Vec<_>, Vec<_>) = stretches.partition(|(is_kept, _)| *is_kept);
    let [seen, unseen] = [seen, unseen].map(|half| half.into_iter().map(|(_, some)| some).collect());
    let mut motion = Motion::new(scene);
    let first = motion.at(0);
    let course =
        Course { scene, motion, seen, unseen, truths: Vec::new(), images: Default::default(), flown: 0 };
    Halving { wish, course, first, trials: Vec::new(), ready: Vec::new() }
}

impl<S: World> Halving<'_, S> {
    /// 1. Every method with its defaults; their numbers are those of the list of methods.
    fn defaults(&mut self, progress: &dyn Progress) -> Result<Vec<usize>, ExperimentError> {
        let mut all = Vec::new();
        for (k, entry) in S::methods().iter().enumerate() {
            let some = Part::of(progress, k, S::methods().len() + 1);
            checkpoint(&some, 0.0, "building")?;
            all.extend(self.add(defaults::<S>(*entry), &some)?);
        }
        self.try_on(&all, FIRST, 1, &part(progress, 0.9, 1.0))?;
        Ok(all)
    }

    /// 2. Parameters of what could win; what still could.
    fn widened(&mut self, plain: &[usize], progress: &dyn Progress) -> Result<Vec<usize>, ExperimentError> {
        let best = self.best_ms(plain);
        let could =
            |of: &Self, k: usize| of.trials[k].time_ms <= if of.is_right(k) { best * SLACK } else { best };
        let mut left: Vec<usize> = plain.iter().copied().filter(|&k| could(self, k)).collect();
        self.keep(&left);
        for (at, k) in left.clone().into_iter().enumerate() {
            let some = Part::of(progress, at, plain.len());
            let others = variations::<S>(S::methods()[k]);
            let (building, mut added) = (part(&some, 0.0, 0.8), Vec::new());
            for (n, one) in others.iter().enumerate() {
                let some = Part::of(&building, n, others.len());
                checkpoint(&some, 0.0, "building")?;
                added.extend(self.add(one.clone(), &some)?);
            }
            self.try_on(&added, FIRST, 1, &part(&some, 0.8, 1.0))?;
            left.extend(added.into_iter().filter(|&k| could(self, k)));
            // An index of each would take too much memory.
            self.keep(&left);
        }
        Ok(left)
    }

    /// 3. The better half goes on to twice as many frames, until few are left.
    fn narrowed(
        &mut self,
        mut left: Vec<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<usize>, ExperimentError> {
        let best = self.sorted(left.clone()).first().copied();
        if let Some(joined) = best.and_then(|best| self.joined(best, &left)) {
            left.extend(self.add(joined, progress)?);
        }
        let (mut on, mut rung) = (FIRST, 0.0);
        while left.len() > LAST {
            on = (on * 2).min(LONGEST);
            self.try_on(&left, on, 1, &part(progress, rung, rung + 0.2))?;
            rung = (rung + 0.2).min(0.8);
            left = self.sorted(left);
            left.truncate(left.len().div_ceil(2).max(LAST));
            self.keep(&left);
        }
        Ok(left)
    }

    /// Makes a candidate ready again.
    fn renew(&mut self, number: usize, progress: &dyn Progress) -> Result<(), ExperimentError> {
        let configuration = self.trials[number].configuration.clone();
        let entry = super::experiment::method::<S>(&configuration.method)?;
        let run = entry.ready(&self.first, &configuration.settings, progress)?;
        let run = run.ok_or(ExperimentError::Cancelled)?;
        let surfaces = surfaces_of(&run.knobs());
        let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
        self.ready[number] = Some(Ready { run: Paced::new(run, &self.first), options, surfaces });
        Ok(())
    }

    /// The simplest of the best that is right enough on unseen views, too.
    fn checked(mut self, left: Vec<usize>, progress: &dyn Progress) -> Result<Advice, ExperimentError> {
        let mut left = self.sorted(left);
        let mut refused = Vec::new();
        loop {
            let limit = self.best_ms(&left) * NOISE;
            let simple = |k: &usize| (self.trials[*k].configuration.settings.0.len(), *k);
            let near = left.iter().copied().filter(|&k| self.is_right(k) && self.trials[k].time_ms <= limit);
            // What draws all is always right.
            let Some(chosen) = near.min_by_key(simple) else { return Err(ExperimentError::Cancelled) };
            let mut wanted: Vec<usize> = vec![chosen, FRUSTUM];
            wanted.dedup();
            let numbered = self.ready.iter_mut().enumerate().filter(|(k, _)| wanted.contains(k));
            let (numbers, mut runs): (Vec<usize>, Vec<&mut Ready<S>>) =
                numbered.filter_map(|(k, ready)| Some((k, ready.as_mut()?))).unzip();
            let results = self.course.fly(&mut runs, (false, LONGEST), FLIGHTS, progress)?;
            let of = |number: usize| {
                numbers.iter().position(|&k| k == number).map(|at| results[at]).unwrap_or_default()
            };
            let result = of(chosen);
            if result.wrong_percent <= self.wish.most_wrong_percent || left.len() == 1 {
                let grid: usize = S::methods().iter().map(|m| 1 + variations::<S>(*m).len()).sum();
                let frames: usize = self.course.seen.iter().map(|some| some.len().max(2) - 1).sum();
                let cost = [self.course.flown, grid * frames * FLIGHTS];
                let (wish, trials, frustum) = (self.wish, self.trials, of(FRUSTUM));
                return Ok(Advice { wish, chosen, trials, unseen: result, frustum, refused, cost });
            }
            refused.push(chosen);
            left.retain(|k| *k != chosen);
        }
    }
}

impl Advice {
    /// Whether what is advised culls nothing but what is out of view.
    pub fn is_plain(&self) -> bool {
        self.chosen < PLAIN
    }
    /// What is advised.
    pub fn configuration(&self) -> &Configuration {
        &self.trials[self.chosen].configuration
    }
    /// All that was tried, the best first: those that are right enough by time, then the others.
    pub fn table(&self) -> Table {
        let mut table = Table::new(&[
            column("number", "no.", "", 0),
            column("method", "method", "", 0),
            column("parameters", "parameters", "", 0),
            column("frames", "frames", "", 0),
            column("frame_ms", "frame", "ms", 3),
            column("gain_ms", "gains", "ms", 3),
            column("wrong_pixels_percent", "wrong pixels", "%", 4),
            column("index_bytes", "index", "bytes", 0),
            column("build_ms", "building", "ms", 1),
            column("verdict", "", "", 0),
        ]);
        let mut order: Vec<usize> = (0..self.trials.len()).collect();
        let is_right = |k: usize| self.wish.is_met(&self.trials[k]);
        let key = |k: &usize| (!is_right(*k), self.trials[*k].time_ms);
        order.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        // The advised one first, whatever the noise.
        order.retain(|k| *k != self.chosen);
        order.insert(0, self.chosen);
        for k in order {
            let trial = &self.trials[k];
            let label = trial.configuration.label();
            let params = label[trial.configuration.method.len()..].trim_start();
            let verdict = if k == self.chosen {
                "advised"
            } else if self.refused.contains(&k) {
                "not right enough on unseen views"
            } else if !is_right(k) && trial.wrong_percent <= self.wish.most_wrong_percent {
                "promises nothing"
            } else if !is_right(k) {
                "not right enough"
            } else {
                ""
            };
            table.rows.push(vec![
                k.into(),
                trial.configuration.method.as_str().into(),
                params.into(),
                trial.frames.into(),
                trial.time_ms.into(),
                self.gain_ms(k).into(),
                trial.wrong_percent.into(),
                trial.index_bytes.into(),
                trial.build_ms.into(),
                if verdict.is_empty() { Cell::Missing } else { verdict.into() },
            ]);
        }
        table
    }
    /// What a trial gains over its method's defaults, milliseconds a frame; `None` of defaults, and where the
    /// two were tried on different frames.
    fn gain_ms(&self, number: usize) -> Option<f64> {
        let trial = &self.trials[number];
        let is_plain = |t: &&Trial| {
            t.configuration.method == trial.configuration.method && t.configuration.settings.0.is_empty()
        };
        let plain = self.trials.iter().find(is_plain)?;
        let differs = !trial.configuration.settings.0.is_empty();
        (differs && trial.frames == plain.frames).then_some(plain.time_ms - trial.time_ms)
    }
    /// All that was tried as speed against error, and what the parameters of the advised method gain.
    pub fn charts(&self) -> (Tradeoff, Option<Plot>) {
        let mut methods: Vec<&str> = Vec::new();
        for trial in &self.trials {
            if !methods.contains(&trial.configuration.method.as_str()) {
                methods.push(&trial.configuration.method);
            }
        }
        let curve = |(k, method): (usize, &&str)| {
            let of = self.trials.iter().enumerate().filter(|(_, t)| t.configuration.method == **method);
            let mut tried: Vec<Tried> = of
                .map(|(number, trial)| Tried {
                    number: number as u32,
                    error: trial.wrong_percent,
                    time_ms: trial.time_ms,
                    spread_ms: [trial.time_ms; 2],
                    frames: Vec::new(),
                })
                .collect();
            tried.sort_by(|a, b| a.error.total_cmp(&b.error));
            let label = (*method).to_owned();
            let all = self.trials.iter().map(|t| &t.configuration).filter(|c| c.method == label);
            let is_row = results::is_row(all);
            Curve { label, role: results::role(k), tried, is_row }
        };
        let tradeoff = Tradeoff {
            title: "All that was tried".into(),
            error_label: "wrong pixels, %".into(),
            curves: methods.iter().enumerate().map(curve).collect(),
        };
        (tradeoff, self.gains())
    }
    fn gains(&self) -> Option<Plot> {
        let method = &self.configuration().method;
        let mut gains: Vec<(String, f64)> = (0..self.trials.len())
            .filter(|&k| self.trials[k].configuration.method == *method)
            .filter_map(|k| Some((self.trials[k].configuration.label(), self.gain_ms(k)?)))
            .collect();
        gains.sort_by(|a, b| b.1.total_cmp(&a.1));
        gains.truncate(8);
        let name = |label: &str| label[method.len()..].trim_start().replace([' ', '='], "\n");
        let groups: Vec<String> = gains.iter().map(|(label, _)| name(label)).collect();
        // Bars begin at zero: what costs has none.
        let points = gains.iter().enumerate().map(|(k, (_, ms))| (k as f64, ms.max(0.0))).collect();
        (!gains.is_empty()).then(|| Plot {
            title: format!("What other values of {method} gain over its defaults"),
            x_label: String::new(),
            y_label: "gain, ms a frame".into(),
            shape: Shape::Bars { groups, stacked: false },
            series: vec![Series::new("gain", Role::Visible, points)],
        })
    }
}
