//! Advice: the simplest configuration that is right enough at the least time, for a scene and a path.
//!
//! What could be tried are all methods with their defaults, and each of their parameters by itself at other
//! values. To try all of it on all frames takes too long, so this is successive halving (Jamieson and
//! Talwalkar 2016, AISTATS, "Non-stochastic best arm identification and hyperparameter optimization"):
//!
//! 1. every method with its defaults, on a few frames;
//! 2. parameters of those methods that could still win, the fastest method first: its defaults took at most
//!    [`SLACK`] times as long as the best so far that is right enough, or it is fast and not right enough;
//! 3. the better half of all goes on to twice as many frames, until few are left; those of the best method's
//!    parameters that helped are also tried together;
//! 4. those few, beside plain drawing and frustum culling, on all frames in turn;
//! 5. the best of them is checked on the other half of the path's views, which none was chosen by. If it is
//!    not right enough there, or slower than frustum culling, the next one is.
//!
//! Most of the time goes into indexes, so none is built that cannot be advised: where nothing may be wrong,
//! none of what promises nothing; and none further than [`SLOW_INDEX`] times as long as that of the method's
//! defaults. What promises to be right is compared with the truth in the last two steps only.
//!
//! Methods remember from frame to frame, so the path is parted into stretches of frames that follow each
//! other: every second one is kept back. Of each of the others some frames are looked at, after one that does
//! not count: a few frames stand for all of the path.
//!
//! Of those within [`NOISE`] of the best the simplest is advised: the one with the fewest parameters set, and
//! among those the one that is listed first. Cost: some tenth of the frames of the full grid.

mod candidates;
mod course;
#[cfg(test)]
mod tests;

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
use super::timing::{Stopwatch, timed};
use crate::drawing::{Curve, Plot, Role, Series, Shape, Tradeoff, Tried};
use crate::geometry::View;
use crate::method::{Run, Settings, surfaces_of};
use crate::raster::Options;
use crate::scene::{Part, Progress, Scene};
use course::{Course, Frames, Ready};

/// A method whose defaults take longer than so many times the best is not looked into.
pub const SLACK: f64 = 1.6;
/// An index is given up when it takes longer than so many times that of the method's defaults.
pub const SLOW_INDEX: f64 = 3.0;
/// Times that differ by no more are the same.
pub const NOISE: f64 = 1.05;
/// Frames of each stretch in the first round, and flights of the first rounds and the last.
const FIRST: usize = 2;
const ROUGHLY: usize = 2;
const FLIGHTS: usize = 3;
/// Milliseconds that any index may take.
const ANY_INDEX: f64 = 100.0;
/// Frames of a stretch at least and at most, and stretches of either half at most: of a long path parts are
/// enough.
const STRETCH: usize = 4;
const LONGEST: usize = 12;
const STRETCHES: usize = 4;
/// So many go into the last round.
const LAST: usize = 4;
/// The methods that hide nothing, drawing all and frustum culling, are the first of the list, in this order,
/// and so the first trials.
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
        let is_right = trial.wrong_percent.map_or(trial.promises, |wrong| wrong <= self.most_wrong_percent);
        is_right && (trial.promises || self.most_wrong_percent > 0.0)
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
    /// Infinite while it was on none.
    pub time_ms: f64,
    /// Wrong pixels, per cent; `None` while they were not counted.
    pub wrong_percent: Option<f64>,
    /// What its index takes; `None` if that was given up.
    pub index_bytes: Option<usize>,
    /// What building it took, milliseconds, or until it was given up.
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
    /// Candidates that did well but on unseen views were not right enough, or slower than frustum culling.
    pub refused: Vec<usize>,
    /// Configurations that promise nothing, where only what promises will do: they were not tried.
    pub left_out: usize,
    /// Frames that were culled and drawn, and those that the full grid would have taken.
    pub cost: [usize; 2],
}

/// Stops a work that takes too long.
struct Within<'a> {
    whole: &'a dyn Progress,
    watch: Stopwatch,
    most_ms: f64,
}

impl Progress for Within<'_> {
    fn report(&self, fraction: f32, what: &'static str) {
        self.whole.report(fraction, what);
    }
    fn cancelled(&self) -> bool {
        self.watch.elapsed_ms() > self.most_ms || self.whole.cancelled()
    }
}

/// The candidates while they become fewer.
struct Halving<'a, S: World> {
    wish: Wish,
    course: Course<'a, S>,
    first: Arc<Scene<S>>,
    trials: Vec<Trial>,
    ready: Vec<Option<Ready<S>>>,
    left_out: usize,
}

impl<S: World> Halving<'_, S> {
    /// Adds a candidate whose index may take so long; its number, or `None` if it is there already, cannot be
    /// advised or took too long.
    fn add(
        &mut self,
        configuration: Configuration,
        most_ms: f64,
        progress: &dyn Progress,
    ) -> Result<Option<usize>, ExperimentError> {
        if self.trials.iter().any(|trial| trial.configuration == configuration) {
            return Ok(None);
        }
        let entry = super::experiment::method::<S>(&configuration.method)?;
        let promises = entry.is_conservative(&configuration.settings)?;
        if !promises && self.wish.most_wrong_percent == 0.0 {
            self.left_out += 1;
            return Ok(None);
        }
        let within = Within { whole: progress, watch: Stopwatch::start(), most_ms };
        let (run, build_ms) = timed(|| entry.ready(&self.first, &configuration.settings, &within));
        let run = run?;
        if run.is_none() && progress.cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let index_bytes = run.as_ref().map(|run| run.hierarchy().bytes());
        self.ready.push(run.map(|run| self.bound(run)));
        let (frames, time_ms, wrong_percent) = (0, f64::INFINITY, None);
        self.trials.push(Trial {
            configuration,
            frames,
            time_ms,
            wrong_percent,
            index_bytes,
            build_ms,
            promises,
        });
        Ok(index_bytes.map(|_| self.trials.len() - 1))
    }
    fn bound(&self, run: Box<dyn Run<S>>) -> Ready<S> {
        let surfaces = surfaces_of(&run.knobs());
        let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
        Ready { run: Paced::new(run, &self.first), options, surfaces }
    }

    /// Tries some on so many frames of each stretch.
    fn try_on(
        &mut self,
        some: &[usize],
        most: usize,
        flights: usize,
        progress: &dyn Progress,
    ) -> Result<(), ExperimentError> {
        let frames = Frames { are_seen: true, most };
        let (numbers, mut runs) = chosen(&mut self.ready, some);
        let times = self.course.fly(&mut runs, frames, flights, &part(progress, 0.0, 0.7))?;
        for (number, time_ms) in numbers.into_iter().zip(times) {
            (self.trials[number].frames, self.trials[number].time_ms) = (self.course.count(frames), time_ms);
        }
        let unsure: Vec<usize> = some.iter().copied().filter(|&k| !self.trials[k].promises).collect();
        self.judge(&unsure, most, &part(progress, 0.7, 1.0))
    }
    /// Counts the wrong pixels of some on so many frames of each stretch.
    fn judge(&mut self, some: &[usize], most: usize, progress: &dyn Progress) -> Result<(), ExperimentError> {
        if some.is_empty() {
            return Ok(());
        }
        let (numbers, mut runs) = chosen(&mut self.ready, some);
        let wrong = self.course.judge(&mut runs, Frames { are_seen: true, most }, progress)?;
        for (number, [percent, _]) in numbers.into_iter().zip(wrong) {
            self.trials[number].wrong_percent = Some(percent);
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
    /// Lets go of what is not among some, but for the plain ones.
    fn keep(&mut self, some: &[usize]) {
        let dropped = self.ready.iter_mut().enumerate().filter(|(k, _)| *k > FRUSTUM && !some.contains(k));
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

/// Those of some that are ready, with their numbers.
fn chosen<'r, S: World>(
    ready: &'r mut [Option<Ready<S>>],
    some: &[usize],
) -> (Vec<usize>, Vec<&'r mut Ready<S>>) {
    let wanted = ready.iter_mut().enumerate().filter(|(k, _)| some.contains(k));
    wanted.filter_map(|(k, ready)| Some((k, ready.as_mut()?))).unzip()
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
    let others = [0, FRUSTUM].into_iter().filter(|k| !left.contains(k)).collect::<Vec<_>>();
    let left = [left, others].concat();
    halving.keep(&left);
    halving.try_on(&left, LONGEST, FLIGHTS, &part(progress, 0.9, 0.95))?;
    halving.judge(&left, LONGEST, &part(progress, 0.95, 0.97))?;
    // 5. The check.
    halving.checked(left, &part(progress, 0.97, 1.0))
}

fn begin<'a, S: World>(scene: &'a Arc<Scene<S>>, views: &[View<S>], wish: Wish) -> Halving<'a, S> {
    // Which half is kept back is decided by lot.
    let is_odd_kept = Pcg32::new(wish.seed, 17).next_u32().is_multiple_of(2);
    let mut course = Course::new(scene, views, is_odd_kept);
    let first = course.first();
    Halving { wish, course, first, trials: Vec::new(), ready: Vec::new(), left_out: 0 }
}

impl<S: World> Halving<'_, S> {
    /// 1. Every method with its defaults; where these cannot be advised, with what can.
    fn defaults(&mut self, progress: &dyn Progress) -> Result<Vec<usize>, ExperimentError> {
        let mut all = Vec::new();
        for (k, entry) in S::methods().iter().enumerate() {
            let some = Part::of(progress, k, S::methods().len() + 1);
            checkpoint(&some, 0.0, "building")?;
            let plain = self.add(defaults::<S>(*entry), f64::INFINITY, &some)?;
            all.extend(plain);
            if plain.is_none() {
                for one in variations::<S>(*entry) {
                    all.extend(self.add(one, f64::INFINITY, &some)?);
                }
            }
        }
        self.try_on(&all, FIRST, ROUGHLY, &part(progress, 0.9, 1.0))?;
        Ok(all)
    }

    /// 2. Parameters of what could win; what still could.
    fn widened(&mut self, plain: &[usize], progress: &dyn Progress) -> Result<Vec<usize>, ExperimentError> {
        let mut left = self.sorted(plain.to_vec());
        for (at, k) in left.clone().into_iter().enumerate() {
            let some = Part::of(progress, at, plain.len());
            // The best so far: others of this method's parameters may have made it better.
            if !self.could_win(k, &left) {
                left.retain(|&other| other != k);
                continue;
            }
            if !self.trials[k].configuration.settings.0.is_empty() {
                continue;
            }
            let entry = super::experiment::method::<S>(&self.trials[k].configuration.method)?;
            let (others, most_ms) = (variations::<S>(entry), self.trials[k].build_ms * SLOW_INDEX);
            let (building, mut added) = (part(&some, 0.0, 0.8), Vec::new());
            for (n, one) in others.iter().enumerate() {
                let some = Part::of(&building, n, others.len());
                checkpoint(&some, 0.0, "building")?;
                added.extend(self.add(one.clone(), most_ms.max(ANY_INDEX), &some)?);
            }
            self.try_on(&added, FIRST, ROUGHLY, &part(&some, 0.8, 1.0))?;
            left.extend(added);
            left = left.iter().copied().filter(|&k| self.could_win(k, &left)).collect();
            // An index of each would take too much memory; the plain ones take none.
            self.keep(&left);
        }
        Ok(left)
    }
    /// Whether a candidate may yet be the best of some.
    fn could_win(&self, number: usize, some: &[usize]) -> bool {
        let slack = if self.is_right(number) { SLACK } else { 1.0 };
        self.trials[number].time_ms <= self.best_ms(some) * slack
    }

    /// 3. The better half goes on to twice as many frames, until few are left.
    fn narrowed(
        &mut self,
        mut left: Vec<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<usize>, ExperimentError> {
        let best = self.sorted(left.clone()).first().copied();
        if let Some(joined) = best.and_then(|best| self.joined(best, &left)) {
            left.extend(self.add(joined, f64::INFINITY, progress)?);
        }
        let (mut on, mut rung) = (FIRST, 0.0);
        while left.len() > LAST {
            on = (on * 2).min(LONGEST);
            self.try_on(&left, on, ROUGHLY, &part(progress, rung, rung + 0.2))?;
            rung = (rung + 0.2).min(0.8);
            left = self.sorted(left);
            left.truncate(left.len().div_ceil(2).max(LAST));
            self.keep(&left);
        }
        Ok(left)
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
            let flown = self.unseen(&[chosen, FRUSTUM], progress)?;
            // The numbers of those that were flown ascend.
            let [unseen, frustum] =
                if chosen < FRUSTUM { [flown[0], flown[1]] } else { [flown[flown.len() - 1], flown[0]] };
            let is_right = unseen.wrong_percent <= self.wish.most_wrong_percent;
            let pays = chosen <= FRUSTUM || unseen.time_ms <= frustum.time_ms * NOISE;
            if is_right && pays || left.len() == 1 {
                let grid: usize = S::methods().iter().map(|m| 1 + variations::<S>(*m).len()).sum();
                let all = Frames { are_seen: true, most: LONGEST };
                let cost = [self.course.flown, grid * self.course.count(all) * FLIGHTS];
                let (wish, trials, left_out) = (self.wish, self.trials, self.left_out);
                return Ok(Advice { wish, chosen, trials, unseen, frustum, refused, left_out, cost });
            }
            refused.push(chosen);
            left.retain(|k| *k != chosen);
        }
    }
    /// How some did on the views that were kept back, in the order of their numbers.
    fn unseen(&mut self, some: &[usize], progress: &dyn Progress) -> Result<Vec<Flown>, ExperimentError> {
        let all = Frames { are_seen: false, most: LONGEST };
        let (_, mut runs) = chosen(&mut self.ready, some);
        let times = self.course.fly(&mut runs, all, FLIGHTS, &part(progress, 0.0, 0.5))?;
        let wrong = self.course.judge(&mut runs, all, &part(progress, 0.5, 1.0))?;
        let frames = self.course.count(all);
        let flown = |(time_ms, [wrong_percent, worst_percent]): (f64, [f64; 2])| Flown {
            frames,
            time_ms,
            wrong_percent,
            worst_percent,
        };
        Ok(times.into_iter().zip(wrong).map(flown).collect())
    }
}

impl Advice {
    /// Whether what is advised culls nothing but what is out of view.
    pub fn is_plain(&self) -> bool {
        self.chosen <= FRUSTUM
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
                "worse on unseen views"
            } else if trial.index_bytes.is_none() {
                "its index takes too long"
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
                trial.time_ms.is_finite().then_some(trial.time_ms).into(),
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
        (differs && trial.frames == plain.frames && trial.frames > 0).then_some(plain.time_ms - trial.time_ms)
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
            let of = self
                .trials
                .iter()
                .enumerate()
                .filter(|(_, t)| t.configuration.method == **method && t.frames > 0);
            let mut tried: Vec<Tried> = of
                .map(|(number, trial)| Tried {
                    number: number as u32,
                    error: trial.wrong_percent.unwrap_or(0.0),
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
