//! `cullscope cull`: what a method draws for each view, how long it takes, and how right it is.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use serde_json::Value as Json;

use super::methods::params_json;
use super::task::{Ready, Task};
use super::{CliError, World, output};
use crate::drawing::{Pixels, Role};
use crate::geometry::{PrimId, View, each};
use crate::measure::timed;
use crate::method::{DrawList, Verdict, Words, surfaces_of};
use crate::raster::{Canvas, Light, Options, Target};
use crate::render::{Theme, png_pixels};
use crate::scene::{Progress, Scene};
use crate::trace::Stamps;
use crate::truth::{Flip, Judgement, Truth};

#[derive(clap::Args)]
#[command(after_help = "Example:\n  cullscope cull scenes3d/freedoom_e1m1.obj --method frustum --set \
                  tree-height=10 --truth --ids --image kept.png\n\nTimes are wall clock on one thread unless \
                  --threads says otherwise; measure with a release build.")]
pub(super) struct Args {
    #[command(flatten)]
    task: Task,
    /// Compare with the exact answer at the view's resolution; of what is missed, tell what is drawn as
    /// stand-ins from what is lost
    #[arg(long)]
    truth: bool,
    /// Print the ids of what was drawn, and with --truth of what was missed and what was lost
    #[arg(long)]
    ids: bool,
    /// Write an image of what was drawn; several views give NAME-000.png, NAME-001.png, …
    #[arg(long, value_name = "FILE.png")]
    image: Option<PathBuf>,
    /// Light of the image: headlight, at the eye, or fixed in the world. Without it, that of the method
    #[arg(long, value_name = "LIGHT", value_parser = clap::builder::PossibleValuesParser::new(Light::WORDS))]
    light: Option<String>,
    /// Write the result to a file instead of standard output
    #[arg(long, value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Threads that draw
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u32).range(1..=256)
    )]
    threads: u32,
}

#[derive(Serialize)]
struct Report {
    cullscope: &'static str,
    scene: String,
    triangles: usize,
    method: &'static str,
    params: BTreeMap<&'static str, Json>,
    build_ms: f64,
    index_bytes: usize,
}

#[derive(Serialize)]
struct Frame {
    view: usize,
    drawn_triangles: usize,
    /// What was drawn in place of others.
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn_stand_ins: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    drawn_ids: Option<Vec<u32>>,
    /// What moving the scene took, and bringing the index to it; of scenes that move.
    #[serde(skip_serializing_if = "Option::is_none")]
    pose_ms: Option<f64>,
    cull_ms: f64,
    draw_ms: f64,
    stages_ms: BTreeMap<&'static str, f64>,
    counters: BTreeMap<&'static str, u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<TruthReport>,
}

impl Frame {
    /// What was listed, and how long it took.
    fn of<S: World>(
        args: &Args,
        view: usize,
        list: &DrawList<S>,
        stages_ms: &BTreeMap<&'static str, f64>,
        [cull_ms, draw_ms]: [f64; 2],
    ) -> Self {
        Self {
            view,
            drawn_triangles: list.prims.len(),
            drawn_stand_ins: Some(list.stand_ins.len()).filter(|n| *n > 0),
            drawn_ids: args.ids.then(|| numbers(&list.ascending())),
            pose_ms: None,
            cull_ms: rounded(cull_ms),
            draw_ms: rounded(draw_ms),
            stages_ms: stages_ms.iter().map(|(name, ms)| (*name, rounded(*ms))).collect(),
            counters: BTreeMap::new(),
            truth: None,
        }
    }
}

#[derive(Serialize)]
struct TruthReport {
    visible_triangles: usize,
    missed_triangles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    missed_ids: Option<Vec<u32>>,
    /// The same in two parts, where something stands in for primitives.
    #[serde(flatten)]
    parted: Option<Parted>,
    coverage_ratio: f64,
    wrong_pixels: usize,
    wrong_pixel_ratio: f64,
    flip_mean: f64,
    /// Where something stands in for primitives: how far the image is from that of 16 × 16 samples a pixel.
    #[serde(flatten)]
    reference: Option<AgainstReference>,
    overdraw: Option<f64>,
    /// What was missed, as long as it is yet to be parted.
    #[serde(skip)]
    missed: Vec<PrimId>,
}

/// Visible primitives that were not drawn, in two parts.
#[derive(Serialize)]
struct Parted {
    /// Those that something is drawn in place of.
    approximated_triangles: usize,
    /// The others.
    lost_triangles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    lost_ids: Option<Vec<u32>>,
}

#[derive(Serialize)]
struct AgainstReference {
    flip_reference: f64,
    flip_reference_seen_ratio: f64,
}

/// Samples of a pixel a side of the image that one with stand-ins is compared with.
const REFERENCE_SAMPLES: u32 = 16;

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    each!(args.task.load()?, scene => of(args, &scene))
}

fn of<S: World>(args: &Args, scene: &Arc<Scene<S>>) -> Result<(), CliError> {
    let mut ready = args.task.ready(scene)?;
    let pool = (args.threads > 1)
        .then(|| rayon::ThreadPoolBuilder::new().num_threads(args.threads as usize).build());
    let pool = pool.transpose().map_err(|e| CliError::work("--threads", e.to_string()))?;
    let mut work = || frames(args, scene, &mut ready);
    let frames = match &pool {
        Some(pool) => pool.install(&mut work)?,
        None => work()?,
    };
    let Ready { run, build_ms, bar, .. } = ready;
    drop(bar);
    let report = Report {
        cullscope: env!("CARGO_PKG_VERSION"),
        scene: scene.source().to_owned(),
        triangles: scene.prim_count(),
        method: run.card().key,
        params: params_json(&run.knobs()),
        build_ms: rounded(build_ms),
        index_bytes: run.hierarchy().bytes(),
    };
    output::emit(args.out.as_deref(), |to| write_report(&report, &frames, to).map(|()| true))
}

/// Every frame of the path twice: timed, then counted, each time from no memory, so that what a method keeps
/// from frame to frame is what it would keep.
fn frames<S: World>(args: &Args, scene: &Scene<S>, ready: &mut Ready<S>) -> Result<Vec<Frame>, CliError> {
    let count = ready.path.views.len();
    let surfaces = surfaces_of(&ready.run.knobs());
    let background = Theme::Print.flat_linear(Role::Paper);
    let mut truth = args.truth.then(|| Truth::new(scene, surfaces, args.threads as usize, background));
    let (mut target, mut canvas) = (Target::default(), Canvas::default());
    let options =
        Options { threads: args.threads as usize, surfaces: surfaces.both_sides(), ..Options::default() };
    let mut frames = Vec::with_capacity(count);
    ready.run.forget();
    for i in 0..count {
        ready.bar.report(i as f32 / (count + 1) as f32, "culling and drawing");
        if ready.bar.cancelled() {
            return Err(CliError::Interrupted);
        }
        let (scene, pose_ms) = timed(|| ready.pose(i));
        let (scene, view) = (&*scene?, &ready.path.views[i]);
        let ((list, stages_ms), cull_ms) = timed(|| ready.run.stages_ms(view));
        let ((), draw_ms) = timed(|| list.draw((&mut target, &mut canvas), scene, view, &options));
        let light = light(args).unwrap_or(list.light);
        let picture = || list.picture(scene, view, (&target, &canvas), (light, background));
        if let Some(path) = &args.image {
            write_image(&output::numbered(path, i, count), view, picture())?;
        }
        let truth = truth.as_mut().map(|t| {
            let judged = t.judge(scene, view, &list, (&target, &canvas));
            let seen = || t.reference(scene, view, REFERENCE_SAMPLES, light).judge(&picture());
            truth_report(args, judged, (!list.stand_ins.is_empty()).then(seen))
        });
        frames.push(Frame {
            truth,
            pose_ms: scene.frame().map(|_| rounded(pose_ms)),
            ..Frame::of(args, i, &list, &stages_ms, [cull_ms, draw_ms])
        });
    }
    part_missed(args, ready, &mut frames)?;
    ready.run.forget();
    for (i, frame) in frames.iter_mut().enumerate() {
        ready.pose(i)?;
        let (list, tally) = ready.run.count(&ready.path.views[i]);
        debug_assert_eq!(list.prims.len(), frame.drawn_triangles, "a counted run draws the same");
        frame.counters = tally.named();
    }
    Ok(frames)
}

/// Events of a frame from which verdicts are read: some 160 MB and what their evidence takes.
const MOST_EVENTS: usize = 10_000_000;

/// Tells what is missed because something is drawn in its place from what is lost, by the verdicts of the
/// same frames, recorded. Of a frame with more than [`MOST_EVENTS`] it is not said.
fn part_missed<S: World>(args: &Args, ready: &mut Ready<S>, frames: &mut [Frame]) -> Result<(), CliError> {
    if frames.iter().all(|frame| frame.truth.is_none() || frame.drawn_stand_ins.is_none()) {
        return Ok(());
    }
    ready.run.forget();
    for (i, frame) in frames.iter_mut().enumerate() {
        ready.pose(i)?;
        let film = ready.run.record(&ready.path.views[i], MOST_EVENTS).film;
        let Some(truth) = frame.truth.as_mut().filter(|_| frame.drawn_stand_ins.is_some()) else { continue };
        if film.lost() > 0 {
            continue;
        }
        let stamps = Stamps::new(&*film);
        let is_lost = |p: &PrimId| !matches!(stamps.prim_decision(*p), Some((_, Verdict::Approximated)));
        let lost: Vec<PrimId> = truth.missed.iter().copied().filter(is_lost).collect();
        truth.parted = Some(Parted {
            approximated_triangles: truth.missed.len() - lost.len(),
            lost_triangles: lost.len(),
            lost_ids: args.ids.then(|| numbers(&lost)),
        });
    }
    Ok(())
}

/// The light that was asked for.
fn light(args: &Args) -> Option<Light> {
    let word = args.light.as_ref()?;
    Light::ALL.iter().copied().find(|light| light.word() == word)
}

fn write_image<S: World>(place: &Path, view: &View<S>, rgba: Vec<u8>) -> Result<(), CliError> {
    let picture = Pixels { width: view.width, height: view.height, rgba: rgba.into() };
    output::write_file(place, |to| to.write_all(&png_pixels(&picture)).map(|()| true))
}

/// One object; each frame on a line of its own.
fn write_report(report: &Report, frames: &[Frame], to: &mut dyn Write) -> io::Result<()> {
    let head = serde_json::to_string(report)?;
    write!(to, "{},\n\"frames\":[", head.trim_end_matches('}'))?;
    for (i, frame) in frames.iter().enumerate() {
        to.write_all(if i == 0 { b"\n" } else { b",\n" })?;
        serde_json::to_writer(&mut *to, frame)?;
    }
    to.write_all(b"\n]}\n")
}

fn truth_report(args: &Args, judged: Judgement, reference: Option<Flip>) -> TruthReport {
    TruthReport {
        reference: reference
            .map(|f| AgainstReference { flip_reference: f.mean, flip_reference_seen_ratio: f.seen_ratio }),
        visible_triangles: judged.visible.len(),
        missed_triangles: judged.missed.len(),
        missed_ids: args.ids.then(|| numbers(&judged.missed)),
        parted: None,
        coverage_ratio: judged.coverage_ratio(),
        wrong_pixels: judged.wrong_pixels,
        wrong_pixel_ratio: judged.wrong_pixel_ratio(),
        flip_mean: judged.flip_mean,
        overdraw: judged.overdraw(),
        missed: judged.missed,
    }
}

fn numbers(ids: &[PrimId]) -> Vec<u32> {
    ids.iter().map(|p| p.0).collect()
}

/// Milliseconds to the tenth of a microsecond.
fn rounded(ms: f64) -> f64 {
    (ms * 1e4).round() / 1e4
}
