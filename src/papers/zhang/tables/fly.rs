//! A flight along the scene's own path: what each frame counts, and the times of its stages in turn with
//! those of view-frustum culling.

use std::sync::Arc;

use crate::culling::depth::Faces;
use crate::culling::occlusion_maps::parts::{Counted, Mapper};
use crate::geometry::{PrimId, View, ViewPath};
use crate::measure::columns::{self, column};
use crate::measure::deadline::stages_ms;
use crate::measure::experiment::World;
use crate::measure::harness::{Checked, Judge, checkpoint, draw, in_turns, mean, part, ready, settings};
use crate::measure::timing::timed;
use crate::measure::{Column, ExperimentError, Setup};
use crate::method::surfaces_of;
use crate::papers::keys::{FRUSTUM, OCCLUSION_MAPS};
use crate::raster::Target;
use crate::scene::{Motion, Progress, Scene};

/// A column that several tables have.
pub const FRAME: Column = column(columns::FRAME, "frame", "", 0);

/// Stages of a frame, in the order of [`Times`]; the last is drawing what is kept.
pub const STAGES: [&str; 6] = ["clear", "select", "occluders", "maps", "cull", "draw"];
/// Times of the stages, ms.
pub type Times = [f64; STAGES.len()];

/// A frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flown {
    /// What it did.
    pub counted: Counted,
    /// Triangles that it drew.
    pub drawn: usize,
    /// From the view to the finished image with view-frustum culling alone, ms.
    pub frustum_ms: f64,
    /// The same with occlusion culling, by stage.
    pub stages: Times,
    /// The time to draw what shows in that image, as if it were known, ms.
    pub visible_ms: f64,
}

impl Flown {
    /// From the view to the finished image, ms.
    pub fn ms(&self) -> f64 {
        self.stages.iter().sum()
    }
    /// What is culled of what is in view, per cent.
    pub fn culled_percent(&self) -> f64 {
        let c = &self.counted;
        100.0 * (c.hidden + c.presumed) as f64 / c.in_view.max(1) as f64
    }
}

/// The method counted along a path: `each` gets every frame, with what it draws.
///
/// # Errors
/// A setting that does not fit, or it was cancelled.
pub fn counted<S: World + Faces>(
    scene: &Arc<Scene<S>>,
    mapper: &mut Mapper<S>,
    views: &[View<S>],
    progress: &dyn Progress,
    mut each: impl FnMut(usize, &Arc<Scene<S>>, &mut Mapper<S>, &[PrimId], Counted),
) -> Result<(), ExperimentError> {
    let mut motion = Motion::new(scene);
    for (k, view) in views.iter().enumerate() {
        checkpoint(progress, k as f32 / views.len() as f32, "counting")?;
        let scene = motion.at(k);
        if !mapper.pose(&scene, progress) {
            return Err(ExperimentError::Cancelled);
        }
        let (list, counted) = mapper.cull(view);
        each(k, &scene, mapper, &list.prims, counted);
    }
    Ok(())
}

/// The method with the experiment's settings, ready to be counted.
///
/// # Errors
/// As [`counted`].
pub fn mapper<S: World + Faces>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    on_top: &[(&str, &str)],
    progress: &dyn Progress,
) -> Result<Mapper<S>, ExperimentError> {
    let settings = settings::<S>(OCCLUSION_MAPS, setup, on_top)?;
    Mapper::new(scene, &settings, progress)?.ok_or(ExperimentError::Cancelled)
}

/// What was measured along a path.
pub struct Flight {
    pub frames: Vec<Flown>,
    /// The answers against the truth, of views at which nothing may be missed.
    pub checked: Checked,
    /// Primitives of the occluder database.
    pub database: usize,
}

impl Flight {
    /// The mean over the frames.
    pub fn mean(&self, of: impl Fn(&Flown) -> f64) -> f64 {
        mean(self.frames.iter().map(of))
    }
}

/// Flies along a path; `on_top`: settings on top of the experiment's.
///
/// # Errors
/// A setting that does not fit, or it was cancelled.
pub fn fly<S: World + Faces>(
    scene: &Arc<Scene<S>>,
    path: &ViewPath<S>,
    setup: &Setup,
    on_top: &[(&str, &str)],
    progress: &dyn Progress,
) -> Result<Flight, ExperimentError> {
    let mut frames = vec![Flown::default(); path.views.len()];
    let (mut judge, mut checked) = (Judge::new(scene, setup), Checked::default());
    let mut counting = mapper(scene, setup, on_top, &part(progress, 0.0, 0.05))?;
    let database = counting.database().kept_prims as usize;
    let some = part(progress, 0.05, 0.25);
    counted(scene, &mut counting, &path.views, &some, |k, scene, _, drawn, counted| {
        judge.pose(scene);
        checked.join(judge.check(k, &path.views[k], drawn));
        (frames[k].counted, frames[k].drawn) = (counted, drawn.len());
    })?;
    // Its memory is worth more to what is timed.
    drop(counting);
    let mut runs = vec![
        ready(scene, FRUSTUM, setup, &[], &part(progress, 0.25, 0.27))?,
        ready(scene, OCCLUSION_MAPS, setup, on_top, &part(progress, 0.27, 0.35))?,
    ];
    let mut targets = [(); 3].map(|()| Target::default());
    let rest = part(progress, 0.35, 1.0);
    let times = in_turns(scene, &mut runs, &path.views, &rest, "flying", |run, turn| {
        let surfaces = surfaces_of(&run.knobs());
        let (list, stages) = stages_ms(run, turn.view);
        let target = &mut targets[turn.run];
        let ((), draw_ms) = timed(|| draw(target, turn.scene, turn.view, &list.prims, surfaces));
        // Behind the stages, the time of what shows alone.
        let mut times = [0.0; STAGES.len() + 1];
        for (time, stage) in times.iter_mut().zip(STAGES) {
            *time = stages.get(stage).copied().unwrap_or_default();
        }
        times[STAGES.len() - 1] = draw_ms;
        if turn.run == 1 {
            let (visible, alone) = (shown(target), &mut targets[2]);
            times[STAGES.len()] = timed(|| draw(alone, turn.scene, turn.view, &visible, surfaces)).1;
        }
        times
    })?;
    for (frame, times) in frames.iter_mut().zip(times) {
        frame.frustum_ms = times[0].iter().sum();
        let [stages @ .., visible_ms] = times[1];
        (frame.stages, frame.visible_ms) = (stages, visible_ms);
    }
    Ok(Flight { frames, checked, database })
}

/// The primitives that own a pixel of an image, ascending.
fn shown(image: &Target) -> Vec<PrimId> {
    let mut items: Vec<u32> = image.item.iter().copied().filter(|item| *item != Target::NONE).collect();
    items.sort_unstable();
    items.dedup();
    items.into_iter().map(PrimId).collect()
}

/// How much of a scene of so many primitives is not drawn, per cent.
pub fn of_model(prims: usize, drawn: f64) -> f64 {
    100.0 * (1.0 - drawn / prims.max(1) as f64)
}
