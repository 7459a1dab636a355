//! Runs what is missing of a sweep on one scene.

use std::sync::Arc;

use super::log::{Judged, Line, Log, Seen, Timed as TimedFrame};
use super::spec::{Place, Spec};
use crate::geometry::{PrimId, Vector, ViewPath};
use crate::measure::deadline::Paced;
use crate::measure::experiment::{ExperimentError, World};
use crate::measure::harness::{checkpoint, part};
use crate::measure::timing::timed;
use crate::method::{DrawList, Tally, surfaces_of};
use crate::raster::{Canvas, Options, Target};
use crate::scene::{Motion, Part, Progress, Scene, Surfaces, figure_eight_path, motion_path};
use crate::truth::{Judgement, Truth};

/// What the images have behind the scene, linear.
const BACKGROUND: [f32; 3] = [1.0; 3];
/// Frames that a configuration flies before the next one has its turn: what it needs is in the caches but for
/// the first of them, and a slow moment of the machine still meets all.
const LEG: u32 = 8;
/// Frames at the least from which an invented path is made.
const KEYS: u32 = 8;

/// Why a sweep ended before its end.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A method does not run, or it was stopped.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A scene has no path of the name that the spec gives.
    #[error("the scene has no path `{name}`")]
    Path {
        /// The name.
        name: String,
        /// Those that it has.
        known: Vec<String>,
    },
    /// A line could not be kept.
    #[error("{0}")]
    Kept(String),
}

/// Keeps a line, such as in a file; an error says why it could not.
pub type Keep<'a> = dyn FnMut(&Line) -> Result<(), String> + 'a;

/// The views of a scene that a spec flies: as many as it has frames, evenly spaced along the path; where
/// objects move, the first ones.
///
/// # Errors
/// There is no such path.
pub fn path<S: World>(scene: &Scene<S>, place: &Place, spec: &Spec) -> Result<ViewPath<S>, SweepError> {
    let own = scene.paths();
    let first =
        || own.first().cloned().unwrap_or_else(|| figure_eight_path(scene, spec.frames.max(KEYS) as usize));
    let mut path = match &place.path {
        None => first(),
        Some(name) => {
            let moving = motion_path(scene, own, first().views[0]);
            let all = || own.iter().chain(&moving);
            let known = || all().map(|p| p.name.clone()).collect();
            let found = all().find(|p| p.name == *name).cloned();
            found.ok_or_else(|| SweepError::Path { name: name.clone(), known: known() })?
        }
    };
    let (n, count) = (path.views.len(), spec.frames as usize);
    // What moves is seen frame by frame; else the frames stand for the whole path.
    let is_moving = !scene.moving().is_empty();
    path.views = (0..count).map(|k| path.views[if is_moving { k % n } else { k * n / count }]).collect();
    if let Some([width, height]) = spec.size_px {
        let height = if S::Vector::AXES == 2 { 1 } else { height };
        path.views.iter_mut().for_each(|view| (view.width, view.height) = (width, height));
    }
    Ok(path)
}

/// Configurations of one scene on their way.
struct Flight<'a, S: World> {
    spec: &'a Spec,
    number: u32,
    scene: &'a Arc<Scene<S>>,
    path: ViewPath<S>,
    runs: Vec<(u32, Paced<S>)>,
    log: &'a mut Log,
    keep: &'a mut Keep<'a>,
    images: (Target, Canvas),
}

/// Runs what `log` lacks of some configurations (by number) on scene `number` of a spec along a path with as
/// many views as the spec has frames ([`path()`]), and adds it.
///
/// # Errors
/// A configuration does not fit, a line could not be kept, or it was cancelled: what was kept holds.
pub fn fly<'a, S: World>(
    (spec, number): (&'a Spec, usize),
    scene: &'a Arc<Scene<S>>,
    path: &ViewPath<S>,
    configurations: &[usize],
    log: &'a mut Log,
    keep: &'a mut Keep<'a>,
    progress: &dyn Progress,
) -> Result<(), SweepError> {
    let (path, number) = (path.clone(), number as u32);
    let mut flight =
        Flight { spec, number, scene, path, runs: Vec::new(), log, keep, images: Default::default() };
    let (frames, rounds) = (spec.frames, spec.repeats);
    let is_missing = |log: &Log, c: u32| {
        let is_timed = |round| log.is_timed(number, c, frames, round);
        !(log.is_judged(number, c, frames) && (0..rounds).all(is_timed))
    };
    let wanted: Vec<u32> = configurations.iter().map(|&c| c as u32).collect();
    if !wanted.iter().any(|&c| is_missing(flight.log, c)) {
        return Ok(());
    }
    flight.open()?;
    // All of them, so that each has the same neighbors whenever its times are taken.
    flight.build(&wanted, &part(progress, 0.0, 0.2))?;
    flight.judge(&part(progress, 0.2, 0.5))?;
    for round in 0..rounds {
        let some = part(progress, 0.5, 1.0);
        let some = Part::of(&some, round as usize, rounds as usize);
        if !wanted.iter().all(|&c| flight.log.is_timed(number, c, frames, round)) {
            flight.time(round, &some)?;
        }
    }
    Ok(())
}

impl<S: World> Flight<'_, S> {
    fn keep(&mut self, line: Line) -> Result<(), SweepError> {
        (self.keep)(&line).map_err(SweepError::Kept)?;
        self.log.add(line);
        Ok(())
    }

    fn open(&mut self) -> Result<(), SweepError> {
        let (scene, view) = (self.scene, &self.path.views[0]);
        let seen = Seen {
            scene: self.number,
            name: scene.name().to_owned(),
            path: self.path.name.clone(),
            prims: scene.live().len() as u64,
            prim: S::PRIM.to_owned(),
            size_px: [view.width, view.height],
        };
        if self.log.scenes.get(&self.number) == Some(&seen) { Ok(()) } else { self.keep(Line::Scene(seen)) }
    }

    /// Makes configurations ready on the first frame of the scene.
    fn build(&mut self, configurations: &[u32], progress: &dyn Progress) -> Result<(), SweepError> {
        let first = Motion::new(self.scene).at(0);
        for (k, &configuration) in configurations.iter().enumerate() {
            let some = Part::of(progress, k, configurations.len());
            checkpoint(&some, 0.0, "building")?;
            let one = &self.spec.configurations[configuration as usize];
            let entry = crate::measure::experiment::method::<S>(&one.method)?;
            let (run, build_ms) = timed(|| entry.ready(&first, &one.settings, &some));
            let run = run.map_err(ExperimentError::from)?.ok_or(ExperimentError::Cancelled)?;
            let index_bytes = run.hierarchy().bytes() as u64;
            self.runs.push((configuration, Paced::new(run, &first)));
            if !self.log.built.contains_key(&(self.number, configuration)) {
                let scene = self.number;
                self.keep(Line::Built { scene, configuration, build_ms, index_bytes })?;
            }
        }
        Ok(())
    }

    /// A flight in which answers are counted and compared with the truth.
    fn judge(&mut self, progress: &dyn Progress) -> Result<(), SweepError> {
        let frames = self.spec.frames;
        let is_judged = |log: &Log, c: u32| log.is_judged(self.number, c, frames);
        let mut judged: Vec<usize> = Vec::new();
        // What is visible depends on how surfaces are taken, and is the same for all that take them alike.
        let mut truths: Vec<(Surfaces, Truth, Vec<PrimId>)> = Vec::new();
        for (at, (configuration, run)) in self.runs.iter_mut().enumerate() {
            if !is_judged(self.log, *configuration) {
                run.forget();
                judged.push(at);
                let surfaces = surfaces_of(&run.knobs());
                if truths.iter().all(|known| known.0 != surfaces) {
                    truths.push((surfaces, Truth::new(self.scene, surfaces, 1, BACKGROUND), Vec::new()));
                }
            }
        }
        let mut motion = Motion::new(self.scene);
        for frame in 0..if judged.is_empty() { 0 } else { frames } {
            let (scene, view) = (motion.at(frame as usize), self.path.views[frame as usize]);
            for (_, truth, visible) in &mut truths {
                *visible = truth.look(&*scene, &view);
            }
            for (done, &at) in judged.iter().enumerate() {
                let done = (frame as f32 + done as f32 / judged.len() as f32) / frames as f32;
                checkpoint(progress, done, "comparing with the truth")?;
                let (configuration, run) = &mut self.runs[at];
                if !run.pose(&scene, progress) {
                    return Err(ExperimentError::Cancelled.into());
                }
                let (list, tally) = run.count(&view);
                let (configuration, surfaces) = (*configuration, surfaces_of(&run.knobs()));
                let options = options(run);
                list.draw((&mut self.images.0, &mut self.images.1), &scene, &view, &options);
                let known = truths.iter_mut().find(|known| known.0 == surfaces);
                let (_, truth, visible) = known.expect("one for each way to take surfaces");
                let images = (&self.images.0, &self.images.1);
                let judged = truth.compare(&scene, &view, visible.clone(), &list, images);
                let at = (self.number, configuration, frame);
                self.keep(Line::Judged(line_of(at, &list, &tally, &judged)))?;
            }
        }
        Ok(())
    }

    /// A flight in which all configurations take turns and are timed.
    fn time(&mut self, round: u32, progress: &dyn Progress) -> Result<(), SweepError> {
        let (frames, count) = (self.spec.frames, self.runs.len());
        let mut motion = Motion::new(self.scene);
        self.runs.iter_mut().for_each(|(_, run)| run.forget());
        // Legs of other rounds begin at other frames, so that no frame is the first of one in all of them.
        let (mut at, mut end) = (0, LEG - 3 * round % LEG);
        while at < frames {
            let leg: Vec<_> = (at..end.min(frames)).map(|frame| (frame, motion.at(frame as usize))).collect();
            for turn in 0..count {
                checkpoint(progress, at as f32 / frames as f32, "timing")?;
                // Another one begins at each leg and in each flight.
                let which = (turn + (at + round) as usize) % count;
                for (frame, scene) in &leg {
                    self.timed_frame((which, *frame, round), scene, progress)?;
                }
            }
            (at, end) = (end, end + LEG);
        }
        Ok(())
    }

    fn timed_frame(
        &mut self,
        (which, frame, round): (usize, u32, u32),
        scene: &Arc<Scene<S>>,
        progress: &dyn Progress,
    ) -> Result<(), SweepError> {
        let (configuration, run) = &mut self.runs[which];
        let (configuration, view) = (*configuration, self.path.views[frame as usize]);
        if !run.pose(scene, progress) {
            return Err(ExperimentError::Cancelled.into());
        }
        let ((list, stages), cull_ms): ((DrawList<S>, _), _) = timed(|| run.stages_ms(&view));
        let options = options(run);
        let images = (&mut self.images.0, &mut self.images.1);
        let ((), draw_ms) = timed(|| list.draw(images, scene, &view, &options));
        let stages_ms = stages.into_iter().map(|(name, ms)| (name.to_owned(), ms)).collect();
        let scene = self.number;
        self.keep(Line::Timed(TimedFrame { scene, configuration, frame, round, cull_ms, draw_ms, stages_ms }))
    }
}

/// A frame of a configuration on a scene, by their numbers.
fn line_of<S: World>(
    (scene, configuration, frame): (u32, u32, u32),
    list: &DrawList<S>,
    tally: &Tally,
    judged: &Judgement,
) -> Judged {
    Judged {
        scene,
        configuration,
        frame,
        drawn: list.prims.len() as u64,
        stand_ins: list.stand_ins.len() as u64,
        visible: judged.visible.len() as u64,
        missed: judged.missed.len() as u64,
        pixels: judged.pixels as u64,
        wrong_pixels: judged.wrong_pixels as u64,
        flip: judged.flip_mean,
        counts: tally.named().into_iter().map(|(name, n)| (name.to_owned(), n)).collect(),
    }
}

/// How lists of a run are drawn: on one thread, and what turns away is not in them.
fn options<S: World>(run: &Paced<S>) -> Options {
    Options { surfaces: surfaces_of(&run.knobs()).both_sides(), ..Options::default() }
}
