//! Frames of a scene, flown by candidates in turn, and compared with what is visible.

use std::sync::Arc;

use super::super::deadline::Paced;
use super::super::experiment::{ExperimentError, World};
use super::super::harness::checkpoint;
use super::super::timing::{median, timed};
use super::{BACKGROUND, LONGEST, STRETCH, STRETCHES};
use crate::geometry::{PrimId, View};
use crate::method::DrawList;
use crate::raster::{Canvas, Options, Target};
use crate::scene::{Motion, Progress, Scene, Surfaces};
use crate::truth::Truth;

/// A candidate that is ready.
pub(super) struct Ready<S: World> {
    pub(super) run: Paced<S>,
    pub(super) options: Options,
    pub(super) surfaces: Surfaces,
}

/// Views that follow each other, with their numbers, of which scenes that move have a frame each.
type Stretch<S> = Vec<(usize, View<S>)>;

/// The scene and the view of each frame of a stretch.
type Posed<S> = Vec<(Arc<Scene<S>>, View<S>)>;

/// Frames of one half of the stretches.
#[derive(Clone, Copy)]
pub(super) struct Frames {
    /// Those that candidates are chosen by, or those kept back.
    pub(super) are_seen: bool,
    /// So many of each stretch at most, after one that does not count.
    pub(super) most: usize,
}

/// Frames of a scene.
pub(super) struct Course<'a, S: World> {
    scene: &'a Arc<Scene<S>>,
    motion: Motion<S>,
    /// What is chosen by, and what is kept back.
    seen: Vec<Stretch<S>>,
    unseen: Vec<Stretch<S>>,
    /// What is visible, for each way to take surfaces.
    truths: Vec<(Surfaces, Truth, Vec<PrimId>)>,
    images: (Target, Canvas),
    /// Frames that were culled and drawn so far.
    pub(super) flown: usize,
}

impl<'a, S: World> Course<'a, S> {
    /// Parts views into stretches and keeps every second one back; which ones, `is_odd_kept` says.
    pub(super) fn new(scene: &'a Arc<Scene<S>>, views: &[View<S>], is_odd_kept: bool) -> Self {
        // A single view is its own check.
        let views = if views.len() < 2 { [views, views].concat() } else { views.to_vec() };
        let count = 2 * (views.len() / (2 * STRETCH)).clamp(1, STRETCHES);
        let numbered: Vec<_> = views.into_iter().enumerate().collect();
        let n = numbered.len();
        let stretches = (0..count).map(|k| {
            let all = &numbered[k * n / count..(k + 1) * n / count];
            ((k % 2 == 1) == is_odd_kept, all[..all.len().min(LONGEST + 1)].to_vec())
        });
        let (unseen, seen): (Vec<_>, Vec<_>) = stretches.partition(|(is_kept, _)| *is_kept);
        let [seen, unseen] = [seen, unseen].map(|half| half.into_iter().map(|(_, some)| some).collect());
        let motion = Motion::new(scene);
        Self { scene, motion, seen, unseen, truths: Vec::new(), images: Default::default(), flown: 0 }
    }

    /// The scene at its first frame.
    pub(super) fn first(&mut self) -> Arc<Scene<S>> {
        self.motion.at(0)
    }
    /// How many frames these are.
    pub(super) fn count(&self, frames: Frames) -> usize {
        self.half(frames).iter().map(|some| (some.len().max(2) - 1).min(frames.most)).sum()
    }
    fn half(&self, frames: Frames) -> &[Stretch<S>] {
        if frames.are_seen { &self.seen } else { &self.unseen }
    }

    /// The stretches of some frames, the scene at each, the first of a stretch for warming up.
    pub(super) fn plan(&mut self, frames: Frames) -> Vec<Posed<S>> {
        let half = self.half(frames).to_vec();
        let motion = &mut self.motion;
        let one = |stretch: &Stretch<S>| {
            let some = stretch.iter().take(frames.most + 1);
            // Of a single view the same again.
            let again = stretch.iter().take(usize::from(stretch.len() == 1));
            some.chain(again).map(|&(number, view)| (motion.at(number), view)).collect()
        };
        half.iter().map(one).collect()
    }

    /// Runs candidates on frames, a stretch each in turn so that what they need is in the caches; for each
    /// the mean of the frames, of which each is the median of its flights, milliseconds.
    pub(super) fn fly(
        &mut self,
        runs: &mut [&mut Ready<S>],
        frames: Frames,
        flights: usize,
        progress: &dyn Progress,
    ) -> Result<Vec<f64>, ExperimentError> {
        let (plan, count) = (self.plan(frames), runs.len());
        let mut times: Vec<Vec<Vec<f64>>> = vec![Vec::new(); count];
        for flight in 0..flights {
            let mut before = 0;
            for (at, stretch) in plan.iter().enumerate() {
                let done = (flight * plan.len() + at) as f32 / (flights * plan.len()) as f32;
                for turn in 0..count {
                    checkpoint(progress, done, "timing")?;
                    let which = (turn + at + flight) % count;
                    runs[which].run.forget();
                    for (frame, (scene, view)) in stretch.iter().enumerate() {
                        let (_, ms) = self.frame(&mut *runs[which], (scene, view), progress)?;
                        if frame > 0 {
                            let times = &mut times[which];
                            times.resize(times.len().max(before + frame), Vec::new());
                            times[before + frame - 1].push(ms);
                        }
                    }
                }
                before += stretch.len() - 1;
            }
        }
        let mean = |all: Vec<Vec<f64>>| {
            let count = all.len().max(1) as f64;
            all.into_iter().map(median).sum::<f64>() / count
        };
        Ok(times.into_iter().map(mean).collect())
    }

    /// Wrong pixels of candidates on frames, per cent of all images, and of the worst one.
    pub(super) fn judge(
        &mut self,
        runs: &mut [&mut Ready<S>],
        frames: Frames,
        progress: &dyn Progress,
    ) -> Result<Vec<[f64; 2]>, ExperimentError> {
        let plan = self.plan(frames);
        let mut wrong = vec![[0.0, 0.0_f64]; runs.len()];
        let mut count = 0;
        for (at, stretch) in plan.iter().enumerate() {
            runs.iter_mut().for_each(|ready| ready.run.forget());
            for (frame, (scene, view)) in stretch.iter().enumerate() {
                checkpoint(progress, at as f32 / plan.len() as f32, "comparing with the truth")?;
                if frame > 0 {
                    self.look(runs, scene, view);
                    count += 1;
                }
                for (ready, wrong) in runs.iter_mut().zip(&mut wrong) {
                    let (list, _) = self.frame(ready, (scene, view), progress)?;
                    if frame > 0 {
                        let percent = self.wrong_percent(ready.surfaces, scene, view, &list);
                        *wrong = [wrong[0] + percent, wrong[1].max(percent)];
                    }
                }
            }
        }
        Ok(wrong.into_iter().map(|[sum, worst]| [sum / f64::from(count.max(1)), worst]).collect())
    }

    /// Culls and draws a frame: its list, and milliseconds.
    fn frame(
        &mut self,
        ready: &mut Ready<S>,
        (scene, view): (&Arc<Scene<S>>, &View<S>),
        progress: &dyn Progress,
    ) -> Result<(DrawList<S>, f64), ExperimentError> {
        if !ready.run.pose(scene, progress) {
            return Err(ExperimentError::Cancelled);
        }
        let (list, cull_ms) = timed(|| ready.run.cull(view));
        let images = (&mut self.images.0, &mut self.images.1);
        let ((), draw_ms) = timed(|| list.draw(images, scene, view, &ready.options));
        self.flown += 1;
        Ok((list, cull_ms + draw_ms))
    }

    /// Draws the whole scene, once for all candidates that take its surfaces alike.
    fn look(&mut self, runs: &[&mut Ready<S>], scene: &Scene<S>, view: &View<S>) {
        for ready in runs {
            if self.truths.iter().all(|(of, ..)| *of != ready.surfaces) {
                let truth = Truth::new(self.scene, ready.surfaces, 1, BACKGROUND);
                self.truths.push((ready.surfaces, truth, Vec::new()));
            }
        }
        for (_, truth, visible) in &mut self.truths {
            *visible = truth.look(scene, view);
        }
    }
    /// Wrong pixels of a list that was just drawn, of the view that was looked at, per cent.
    fn wrong_percent(
        &mut self,
        surfaces: Surfaces,
        scene: &Scene<S>,
        view: &View<S>,
        list: &DrawList<S>,
    ) -> f64 {
        let known = self.truths.iter_mut().find(|(of, ..)| *of == surfaces);
        let (_, truth, visible) = known.expect("one for each way to take surfaces");
        let judged = truth.compare(scene, view, visible.clone(), list, (&self.images.0, &self.images.1));
        100.0 * judged.wrong_pixel_ratio()
    }
}
