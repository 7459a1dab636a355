//! A walk at a constant speed: views spread along a path, stretches of frames one step apart, and the timing
//! of those.

use super::path::{at_rest, sized};
use super::ready::checkpoint;
use super::turns::ROUNDS;
use crate::geometry::{Vector, View, ViewPath};
use crate::measure::experiment::{ExperimentError, Setup, World};
use crate::measure::report::Measured;
use crate::measure::timing::median;
use crate::scene::{Part, Progress, Scene, figure_eight_path};

/// How [`times_of`] takes times, as a note under a table.
pub const WALK_TIMES: &str = "Wall-clock times on one thread, interleaved; of each frame the median of three \
                              rounds, then the mean over the frames of a walk, at walking speed where no \
                              other is named.";
/// Stretches that a long walk is measured on, evenly spaced.
const STRETCHES: usize = 8;
/// Frames before each stretch that are culled and not measured, so that what is kept from frame to frame is
/// there.
const WARM: usize = 8;
/// Keys of an invented path.
const KEYS: usize = 720;
/// The most frames of a walk, against scenes of another unit than the meter.
const MOST_FRAMES: f64 = 1e6;

/// A walk around a scene.
pub struct Walk<S: World> {
    /// What is measured.
    pub about: Measured,
    path: ViewPath<S>,
    /// Its length once around, world units.
    length: f32,
    /// Frames that are to be measured.
    frames: usize,
}

/// Frames one after the other: some to warm up, and those that count.
pub struct Stretch<S: World> {
    warm: Vec<View<S>>,
    /// The frames that count.
    pub frames: Vec<View<S>>,
}

impl<S: World> Walk<S> {
    /// Along the scene's path `figure 8`, or one through its middle if it has none.
    pub fn new(scene: &Scene<S>, setup: &Setup) -> Self {
        let own = scene.paths().iter().find(|p| p.name == "figure 8").cloned();
        let path = sized(own.unwrap_or_else(|| figure_eight_path(scene, KEYS)), setup);
        let n = path.views.len();
        let position = |k: usize| path.views[k % n].eye.position;
        let length = (0..n).map(|k| (position(k + 1) - position(k)).length()).sum();
        Self { about: at_rest(scene, &path), path, length, frames: setup.frames }
    }

    /// As many views as are to be measured, evenly spaced along the whole path.
    pub fn spread(&self) -> Vec<View<S>> {
        let n = self.frames;
        self.path.walked(self.length / n as f32, n).views
    }

    /// A walk around the path at `step` a frame: all of it, or stretches of it if it is longer than what is
    /// to be measured. They begin at the same places whatever the step.
    pub fn stretches(&self, step: f32) -> Vec<Stretch<S>> {
        let total = (f64::from(self.length) / f64::from(step)).ceil().clamp(1.0, MOST_FRAMES) as usize;
        let walk = self.path.walked(step, total).views;
        let stretch = |first: usize, count: usize| Stretch {
            warm: (0..WARM).map(|i| walk[(first + total * WARM + i - WARM) % total]).collect(),
            frames: (0..count).map(|i| walk[(first + i) % total]).collect(),
        };
        if total <= self.frames {
            return vec![stretch(0, total)];
        }
        let n = STRETCHES.min(self.frames);
        (0..n).map(|i| stretch(i * total / n, self.frames / n)).collect()
    }
}

/// Times `N` things a frame over the stretches of a walk, as [`times_of`] does of several walks.
///
/// # Errors
/// It was cancelled.
pub fn times<S: World, const N: usize>(
    stretches: Vec<Stretch<S>>,
    progress: &dyn Progress,
    frame: impl FnMut(Moment<'_, S>) -> [f64; N],
) -> Result<[f64; N], ExperimentError> {
    times_of(&[stretches], progress, frame).map(|all| all[0])
}

/// Times `N` things a frame over the stretches of several walks, stretch by stretch in turn, in rounds:
/// `frame` is called when a stretch begins, then for each of its frames. For each walk and thing the mean
/// over the frames of the median of its rounds, ms.
///
/// # Errors
/// It was cancelled.
pub fn times_of<S: World, const N: usize>(
    walks: &[Vec<Stretch<S>>],
    progress: &dyn Progress,
    mut frame: impl FnMut(Moment<'_, S>) -> [f64; N],
) -> Result<Vec<[f64; N]>, ExperimentError> {
    let mut sums = vec![([0.0; N], 0); walks.len()];
    let most = walks.iter().map(Vec::len).max().unwrap_or(0);
    let all = walks.iter().map(Vec::len).sum::<usize>().max(1) as f32;
    let turns = (0..most).flat_map(|i| {
        walks.iter().enumerate().filter_map(move |(w, stretches)| Some((w, stretches.get(i)?)))
    });
    for (turn, (w, stretch)) in turns.enumerate() {
        let part = Part { whole: progress, start: turn as f32 / all, length: 1.0 / all };
        let mut rounds = vec![Vec::with_capacity(ROUNDS); stretch.frames.len()];
        for round in 0..ROUNDS {
            frame(Moment::Begin);
            for view in &stretch.warm {
                frame(Moment::Frame(view));
            }
            for (k, view) in stretch.frames.iter().enumerate() {
                let done = (round * stretch.frames.len() + k) as f32 / (ROUNDS * stretch.frames.len()) as f32;
                checkpoint(&part, done, "timing")?;
                rounds[k].push(frame(Moment::Frame(view)));
            }
        }
        let (sum, count) = &mut sums[w];
        for times in &rounds {
            for (n, sum) in sum.iter_mut().enumerate() {
                *sum += median(times.iter().map(|t| t[n]).collect());
            }
        }
        *count += rounds.len();
    }
    Ok(sums.into_iter().map(|(sum, count)| sum.map(|s| s / count.max(1) as f64)).collect())
}

/// What is to be done now.
pub enum Moment<'a, S: World> {
    /// Forget: a walk begins.
    Begin,
    /// A frame; the time of one that warms up is not used.
    Frame(&'a View<S>),
}
