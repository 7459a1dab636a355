//! The walk of an experiment: what is ready to run on a scene, views spread along its path, stretches of
//! frames at a speed, and the timing of those.

use std::sync::Arc;

use super::{BASELINE, METHOD, Measured, PaperError, Setup, World, method, part};
use crate::geometry::{PrimId, Vector, View, ViewPath};
use crate::measure::timing::median;
use crate::method::{Run, Settings};
use crate::raster::Target;
use crate::scene::{Part, Progress, Scene, figure_eight_path};
use crate::truth::Truth;

/// Stretches that a long walk is measured on, evenly spaced.
const STRETCHES: usize = 8;
/// Frames before each stretch that are culled and not measured, so that what is kept from frame to frame is
/// there.
const WARM: usize = 8;
/// Rounds whose median is the time of a frame.
pub const ROUNDS: usize = 3;
/// Keys of an invented path.
const KEYS: usize = 720;
/// The most frames of a walk, against scenes of another unit than the meter.
const MOST_FRAMES: f64 = 1e6;

/// A scene on which an experiment runs.
pub struct Site<'a, S: World> {
    pub scene: &'a Arc<Scene<S>>,
    pub setup: &'a Setup,
    path: ViewPath<S>,
    /// Its length once around, world units.
    length: f32,
    truth: Truth,
}

/// Frames one after the other: some to warm up, and those that count.
pub struct Stretch<S: World> {
    warm: Vec<View<S>>,
    pub frames: Vec<View<S>>,
}

/// Triangles missed, and views looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checked {
    pub missed: usize,
    pub views: usize,
}

/// A scene with both methods ready on it.
pub struct Both<'a, S: World> {
    pub site: Site<'a, S>,
    pub frustum: Box<dyn Run<S>>,
    pub occlusion: Box<dyn Run<S>>,
}

impl<'a, S: World> Both<'a, S> {
    /// Builds what both need; it is `done` of `progress` then.
    pub fn new(
        scene: &'a Arc<Scene<S>>,
        setup: &'a Setup,
        progress: &dyn Progress,
        done: f32,
    ) -> Result<Self, PaperError> {
        let site = Site::new(scene, setup);
        let frustum = site.frustum(&part(progress, 0.0, 0.25 * done))?;
        let occlusion = site.occlusion(&[], &part(progress, 0.25 * done, done))?;
        Ok(Self { site, frustum, occlusion })
    }
}

impl<'a, S: World> Site<'a, S> {
    pub fn new(scene: &'a Arc<Scene<S>>, setup: &'a Setup) -> Self {
        let brought = scene.paths().iter().find(|p| p.name == "figure 8");
        let mut path = brought.cloned().unwrap_or_else(|| figure_eight_path(scene, KEYS));
        if let Some([width, height]) = setup.size_px {
            let height = if S::Vector::AXES == 2 { 1 } else { height };
            path.views.iter_mut().for_each(|v| (v.width, v.height) = (width, height));
        }
        let n = path.views.len();
        let position = |k: usize| path.views[k % n].eye.position;
        let length = (0..n).map(|k| (position(k + 1) - position(k)).length()).sum();
        let one_sided = setup.settings.0.get("backface-culling").is_some_and(|v| v == "true");
        let truth = Truth::new(scene, one_sided, 1, [1.0; 3]);
        Self { scene, setup, path, length, truth }
    }

    pub fn about(&self) -> Measured {
        let (scene, path) = (self.scene, self.path.name.clone());
        Measured {
            name: scene.name().into(),
            source: scene.source().into(),
            prims: scene.live().len(),
            prim: S::PRIM,
            path,
        }
    }

    /// The method with the experiment's parameters and these on top.
    pub fn occlusion(
        &self,
        on_top: &[(&str, &str)],
        progress: &dyn Progress,
    ) -> Result<Box<dyn Run<S>>, PaperError> {
        let mut settings = self.setup.settings.clone();
        settings.0.extend(on_top.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())));
        let run = method::<S>(METHOD).ready(self.scene, &settings, progress)?;
        run.ok_or(PaperError::Cancelled)
    }
    /// View-frustum culling with those of the parameters that it has.
    pub fn frustum(&self, progress: &dyn Progress) -> Result<Box<dyn Run<S>>, PaperError> {
        let known = method::<S>(BASELINE).knobs(&Settings::default())?;
        let fits = |key: &String| known.iter().any(|(k, _)| k.name == key);
        let settings = Settings(
            self.setup
                .settings
                .0
                .iter()
                .filter(|(k, _)| fits(k))
                .map(|(k, v)| (k.clone(), v.clone()))
                .collect(),
        );
        let run = method::<S>(BASELINE).ready(self.scene, &settings, progress)?;
        run.ok_or(PaperError::Cancelled)
    }

    /// As many views as are to be measured, evenly spaced along the whole path.
    pub fn spread(&self) -> Vec<View<S>> {
        let n = self.setup.frames;
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
        if total <= self.setup.frames {
            return vec![stretch(0, total)];
        }
        let n = STRETCHES.min(self.setup.frames);
        (0..n).map(|i| stretch(i * total / n, self.setup.frames / n)).collect()
    }

    /// Compares answers to some of these views with the truth; the method walks all of them.
    pub fn check(
        &mut self,
        run: &mut dyn Run<S>,
        views: &[View<S>],
        progress: &dyn Progress,
    ) -> Result<Checked, PaperError> {
        self.each(views, progress, "comparing with the truth", |view| run.cull(view).prims)
    }
    /// Asks for the answer to each view, which is `what` is done, and compares some of them with the truth.
    pub fn each(
        &mut self,
        views: &[View<S>],
        progress: &dyn Progress,
        what: &'static str,
        mut answer: impl FnMut(&View<S>) -> Vec<PrimId>,
    ) -> Result<Checked, PaperError> {
        let mut checked = Checked::default();
        for (i, view) in views.iter().enumerate() {
            stop_or_go(progress, i as f32 / views.len() as f32, what)?;
            let drawn = answer(view);
            if self.setup.check_every > 0 && i.is_multiple_of(self.setup.check_every) {
                checked.add(self.missed(view, &drawn));
            }
        }
        Ok(checked)
    }
    /// How many primitives of the item buffer were not drawn.
    fn missed(&mut self, view: &View<S>, drawn: &[PrimId]) -> usize {
        let mut kept = vec![false; self.scene.prim_count()];
        drawn.iter().for_each(|p| kept[p.at()] = true);
        self.truth.look(self.scene, view).iter().filter(|p| !kept[p.at()]).count()
    }

    /// Draws on one thread; for timing.
    pub fn draw(&self, target: &mut Target, view: &View<S>, prims: &[PrimId]) {
        target.clear(view);
        S::draw(target, self.scene, view, prims, &crate::raster::Options::default());
    }
}

impl Checked {
    fn add(&mut self, missed: usize) {
        self.missed += missed;
        self.views += 1;
    }
    pub fn join(&mut self, other: Self) {
        self.missed += other.missed;
        self.views += other.views;
    }
}

/// Says how far the work is, and stops it if nobody wants it any more.
pub fn stop_or_go(progress: &dyn Progress, fraction: f32, what: &'static str) -> Result<(), PaperError> {
    progress.report(fraction, what);
    if progress.cancelled() { Err(PaperError::Cancelled) } else { Ok(()) }
}

/// Times `N` things a frame over the stretches of a walk; see [`times_of`].
pub fn times<S: World, const N: usize>(
    stretches: Vec<Stretch<S>>,
    progress: &dyn Progress,
    frame: impl FnMut(Moment<'_, S>) -> [f64; N],
) -> Result<[f64; N], PaperError> {
    times_of(&[stretches], progress, frame).map(|all| all[0])
}

/// Times `N` things a frame over the stretches of several walks, stretch by stretch in turn, in rounds:
/// `frame` is told when a stretch begins, then asked for each of its frames. For each walk and thing the mean
/// over the frames of the median of its rounds, ms.
pub fn times_of<S: World, const N: usize>(
    walks: &[Vec<Stretch<S>>],
    progress: &dyn Progress,
    mut frame: impl FnMut(Moment<'_, S>) -> [f64; N],
) -> Result<Vec<[f64; N]>, PaperError> {
    let mut sums = vec![([0.0; N], 0); walks.len()];
    let (most, all) = (
        walks.iter().map(Vec::len).max().unwrap_or(0),
        walks.iter().map(Vec::len).sum::<usize>().max(1) as f32,
    );
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
                stop_or_go(&part, done, "timing")?;
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
