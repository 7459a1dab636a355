//! Klosowski and Silva 2000, Section 5: how much of the visible set a budget finds, how many pixels are
//! wrong, how long a frame and the preprocess take; and what the paper claims without figures: that the
//! visible set is stable.
//!
//! Exactness is measured at every frame: the visible set is that of the item buffer (Section 4.4), and a
//! pixel is wrong if its shown bytes differ from those of the exact image. Cost: O(frames · ways) images of
//! the scene.

mod comparison;
mod deadline;
mod extensions;
mod frames;
mod overhead;
mod preprocess;
mod stability;
mod table_1;

pub use comparison::SWEEP as COMPARISON;
pub use deadline::SWEEP as DEADLINE;
pub use extensions::SWEEP as EXTENSIONS;
pub use frames::SWEEP as FRAMES;
pub use overhead::SWEEP as OVERHEAD;
pub use preprocess::SWEEP as PREPROCESS;
pub use stability::SWEEP as STABILITY;
pub use table_1::SWEEP as TABLE_1;

use std::sync::Arc;

use super::{Column, PaperError, Setup, World, column, method, part};
use crate::drawing::Role;
use crate::geometry::{PrimId, View};
use crate::measure::timed;
use crate::method::{RestoreError, Run, Settings};
use crate::raster::{Options, Target, shade};
use crate::scene::{Progress, Scene};
use crate::truth::Truth;

pub const METHOD: &str = "layered-projection";
/// Section 4.5.
const CENTROID: &str = "centroid";
const FRUSTUM: &str = "frustum";

/// The paper's budgets, per cent.
const BUDGETS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

/// Columns that several tables have.
const FRAME: Column = column(super::FRAME, "frame", "", 0);
const ORDER: Column = column("order", "order", "", 0);
const BUDGET: Column = column("budget_percent", "budget", "%", 0);

/// What the images have behind the scene, linear.
const BACKGROUND: [f32; 3] = [1.0; 3];

/// An order in which primitives are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    label: &'static str,
    /// Cells of the method; none for the baseline.
    tessellation: Option<&'static str>,
    role: Role,
}

const DELAUNAY: Way = Way { label: "Delaunay", tessellation: Some("delaunay"), role: Role::Visible };
const OCTREE: Way = Way { label: "octree", tessellation: Some("octree"), role: Role::Hidden };
const KD_TREE: Way = Way { label: "kD-tree", tessellation: Some("kd-tree"), role: Role::Partial };
const BY_CENTROID: Way = Way { label: "centroid", tessellation: None, role: Role::Outside };

/// How many primitives may be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Most {
    /// As the settings say.
    AsSet,
    Percent(f64),
}

type Runs<S> = Vec<Box<dyn Run<S>>>;

/// The settings that a method has, and those on top.
fn settings<S: World>(key: &str, setup: &Setup, on_top: &[(&str, String)]) -> Result<Settings, PaperError> {
    let known = method::<S>(key).knobs(&Settings::default())?;
    let fits = |k: &String| key == METHOD || known.iter().any(|(knob, _)| knob.name == k);
    let mut settings = Settings(
        setup.settings.0.iter().filter(|(k, _)| fits(k)).map(|(k, v)| (k.clone(), v.clone())).collect(),
    );
    settings.0.extend(on_top.iter().map(|(k, v)| ((*k).to_owned(), v.clone())));
    Ok(settings)
}

/// A way that is ready to run, once for each budget; what takes long is built once.
fn ready<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    way: Way,
    budgets: &[Most],
    progress: &dyn Progress,
) -> Result<Runs<S>, PaperError> {
    let key = if way.tessellation.is_some() { METHOD } else { CENTROID };
    let mut runs: Runs<S> = Vec::new();
    let mut saved = None;
    for (i, budget) in budgets.iter().enumerate() {
        let rest = part(progress, if i == 0 { 0.0 } else { 0.9 }, if i == 0 { 0.9 } else { 1.0 });
        let mut on_top: Vec<(&str, String)> =
            way.tessellation.iter().map(|t| ("tessellation", (*t).to_owned())).collect();
        if let Most::Percent(percent) = budget {
            on_top.push(("budget", format!("{percent}%")));
        }
        let settings = settings::<S>(key, setup, &on_top)?;
        let run = around(scene, key, &settings, saved.as_deref(), &rest)?;
        saved = saved.or_else(|| run.hierarchy().save());
        runs.push(run);
    }
    Ok(runs)
}

/// A method ready to run, around what an earlier one saved if it fits.
fn around<S: World>(
    scene: &Arc<Scene<S>>,
    key: &str,
    settings: &Settings,
    saved: Option<&[u8]>,
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, PaperError> {
    let entry = method::<S>(key);
    let run = match saved.map(|saved| entry.restore(scene, settings, saved, progress)) {
        Some(Ok(run)) => run,
        Some(Err(RestoreError::Setting(error))) => return Err(error.into()),
        Some(Err(RestoreError::Saved(_))) | None => entry.ready(scene, settings, progress)?,
    };
    run.ok_or(PaperError::Cancelled)
}

/// View-frustum culling, ready to run.
fn frustum<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, PaperError> {
    method::<S>(FRUSTUM)
        .ready(scene, &settings::<S>(FRUSTUM, setup, &[])?, progress)?
        .ok_or(PaperError::Cancelled)
}

/// Whether the settings say that primitives have one side.
fn one_sided(setup: &Setup) -> bool {
    setup.settings.0.get("backface-culling").is_some_and(|v| v == "true")
}

/// The exact answer to a view, and how another one differs.
struct Judge {
    truth: Truth,
    /// What is visible, and the exact image as shown.
    visible: Vec<PrimId>,
    exact: Vec<u8>,
    kept: Vec<bool>,
    target: Target,
}

/// How an answer differs.
struct Verdict {
    /// Visible primitives that were drawn.
    found: usize,
    /// Of each pixel, whether it is wrong.
    wrong: Vec<bool>,
}

impl Verdict {
    /// Wrong pixels, per cent of the image.
    fn wrong_percent(&self) -> f64 {
        100.0 * self.wrong.iter().filter(|w| **w).count() as f64 / self.wrong.len().max(1) as f64
    }
}

impl Judge {
    fn new<S: World>(scene: &Scene<S>, setup: &Setup) -> Self {
        let truth = Truth::new(scene, one_sided(setup), 1, BACKGROUND);
        Self {
            truth,
            visible: Vec::new(),
            exact: Vec::new(),
            kept: vec![false; scene.prim_count()],
            target: Target::default(),
        }
    }
    /// Finds out what is exact.
    fn look<S: World>(&mut self, scene: &Scene<S>, view: &View<S>) {
        self.visible = self.truth.look(scene, view);
        self.exact = shade(self.truth.image(), scene, view, BACKGROUND);
    }
    /// Compares what was drawn for the view that it looked at last.
    fn judge<S: World>(&mut self, scene: &Scene<S>, view: &View<S>, drawn: &[PrimId]) -> Verdict {
        drawn.iter().for_each(|p| self.kept[p.at()] = true);
        let found = self.visible.iter().filter(|p| self.kept[p.at()]).count();
        drawn.iter().for_each(|p| self.kept[p.at()] = false);
        draw(&mut self.target, scene, view, drawn);
        let image = shade(&self.target, scene, view, BACKGROUND);
        Verdict {
            found,
            wrong: self.exact.chunks_exact(4).zip(image.chunks_exact(4)).map(|(a, b)| a != b).collect(),
        }
    }
    /// Found visible primitives, per cent of the visible ones: ε of Section 3.
    fn coverage_percent(&self, verdict: &Verdict) -> f64 {
        if self.visible.is_empty() { 100.0 } else { 100.0 * verdict.found as f64 / self.visible.len() as f64 }
    }
}

/// Draws on one thread.
fn draw<S: World>(target: &mut Target, scene: &Scene<S>, view: &View<S>, prims: &[PrimId]) {
    target.clear(view);
    S::draw(target, scene, view, prims, &Options::default());
}

/// What was drawn, and the time to cull and to draw, ms.
fn frame<S: World>(
    scene: &Scene<S>,
    run: &mut dyn Run<S>,
    view: &View<S>,
    target: &mut Target,
) -> (Vec<PrimId>, [f64; 2]) {
    let (list, cull_ms) = timed(|| run.cull(view).prims);
    let ((), draw_ms) = timed(|| draw(target, scene, view, &list));
    (list, [cull_ms, draw_ms])
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count.max(1))
}
