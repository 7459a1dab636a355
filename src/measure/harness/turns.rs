//! Times of frames along a path: several runs in turn at each frame, in rounds.

use super::judge::draw;
use super::ready::checkpoint;
use crate::geometry::{PrimId, View};
use crate::measure::experiment::{ExperimentError, World};
use crate::measure::timing::{median, timed};
use crate::method::{Run, surfaces_of};
use crate::raster::Target;
use std::sync::Arc;

use crate::scene::{Motion, Progress, Quiet, Scene};

/// Rounds whose median is the time of a frame.
pub const ROUNDS: usize = 3;
/// How [`in_turns`] takes times, as a note under a table.
pub const FRAME_TIMES: &str = "Wall-clock times on one thread from the view to the finished image, \
                               interleaved; of each frame the median of three flights along the scene's own \
                               path.";

/// A run's turn at a frame.
pub struct Turn<'a, S: World> {
    /// Whether this is the first round, in which answers are judged.
    pub is_first_round: bool,
    /// Whether no other run had this frame before, in this round.
    pub is_first_run: bool,
    /// The frame, by number.
    pub frame: usize,
    /// The run, by number.
    pub run: usize,
    /// The view of the frame.
    pub view: &'a View<S>,
    /// What it sees: where objects move, the scene of the frame of this number.
    pub scene: &'a Arc<Scene<S>>,
}

/// Runs on a scene take turns at each view, in rounds; in each the next run begins, so that none always finds
/// the triangles where another has just read them. `take` does one turn, which is `what` is done, and returns
/// `N` times of it. For each frame and run the medians of its rounds.
///
/// # Errors
/// It was cancelled.
pub fn in_turns<S: World, const N: usize>(
    scene: &Arc<Scene<S>>,
    runs: &mut [Box<dyn Run<S>>],
    views: &[View<S>],
    progress: &dyn Progress,
    what: &'static str,
    mut take: impl FnMut(&mut dyn Run<S>, Turn<'_, S>) -> [f64; N],
) -> Result<Vec<Vec<[f64; N]>>, ExperimentError> {
    let (n, count) = (views.len(), runs.len());
    let mut motion = Motion::new(scene);
    let mut rounds = vec![vec![[const { Vec::new() }; N]; count]; n];
    for round in 0..ROUNDS {
        runs.iter_mut().for_each(|run| run.forget());
        for (frame, view) in views.iter().enumerate() {
            checkpoint(progress, (round * n + frame) as f32 / (ROUNDS * n) as f32, what)?;
            let scene = motion.at(frame);
            for at in 0..count {
                let run = (at + frame + round) % count;
                if !runs[run].pose(&scene, &Quiet) {
                    return Err(ExperimentError::Cancelled);
                }
                let (is_first_round, is_first_run) = (round == 0, at == 0);
                let turn = Turn { is_first_round, is_first_run, frame, run, view, scene: &scene };
                let times = take(&mut *runs[run], turn);
                (0..N).for_each(|i| rounds[frame][run][i].push(times[i]));
            }
        }
    }
    Ok(rounds.into_iter().map(|runs| runs.into_iter().map(|times| times.map(median)).collect()).collect())
}

/// Culls and draws a frame: what was drawn, and the time to cull and to draw, ms.
pub fn frame<S: World>(
    scene: &Scene<S>,
    run: &mut dyn Run<S>,
    view: &View<S>,
    target: &mut Target,
) -> (Vec<PrimId>, [f64; 2]) {
    let surfaces = surfaces_of(&run.knobs());
    let (list, cull_ms) = timed(|| run.cull(view).prims);
    let ((), draw_ms) = timed(|| draw(target, scene, view, &list, surfaces));
    (list, [cull_ms, draw_ms])
}

/// The mean of some values; 0 if there are none.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count.max(1))
}
