//! `cullscope stability`: where a small step changes what a method draws without cause, and why.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;

use super::error::reason;
use super::methods::{find, settings};
use super::progress::Bar;
use super::view::ViewArgs;
use super::{CliError, World, output, scene};
use crate::app::floor_map;
use crate::geometry::each;
use crate::measure::experiment::ExperimentError;
use crate::measure::stability::{
    Ask, Decided, Flip, Proof, Stability, grid_table, path_table, stability, summary,
};
use crate::measure::{Column, Table};
use crate::method::{Budget, Entry, KnobValue, Settings};
use crate::render::{SvgOptions, Theme, svg};
use crate::scene::{LoadOptions, Motion, Part, Scene};

/// Longer side of images without `--size`, pixels.
const SIDE_PX: u32 = 256;
/// Columns that are printed; the files have all.
const PRINTED: [&str; 11] = [
    "scene",
    "method",
    "where",
    "views",
    "visible",
    "missed",
    "wrong_pixels",
    "changed",
    "popped",
    "popped_pixels",
    "margin",
];

const HELP: &str = concat!(
    "Example:\n  cullscope stability 'generate:failure?case=slivers' --method centroid --out found\n",
    "\nWithout views: all of the scene's first path; without --size: images of at most 256 pixels a side. ",
    "`popped` are primitives that are visible at two neighboring views and drawn at one of them only, and ",
    "pixels that change in the method's image and not in the exact one; over the grid, from each place by ",
    "a thousandth of the scene's diagonal along both axes of the floor."
);

#[derive(clap::Args)]
#[command(after_help = HELP)]
pub(super) struct Args {
    /// Paths to scenes, or generate:NAME[?key=value&…]
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<String>,
    /// A method; without it, all with their defaults
    #[arg(long, short, value_name = "METHOD")]
    method: Option<String>,
    /// A parameter of the method; may be given several times
    #[arg(long, value_name = "KEY=VALUE", requires = "method")]
    set: Vec<String>,
    #[command(flatten)]
    view: ViewArgs,
    /// Cells along each axis of the floor; 0: no grid
    #[arg(
        long,
        value_name = "N",
        default_value_t = 16,
        value_parser = clap::value_parser!(u32).range(0..=512)
    )]
    grid: u32,
    /// Popping steps of the path that are narrowed to where the decision flips
    #[arg(
        long,
        value_name = "N",
        default_value_t = 3,
        value_parser = clap::value_parser!(u32).range(0..=1000)
    )]
    flips: u32,
    /// Make the decisions of the path again, by an independent checker in f64 and exact predicates, and count
    /// those within N units in the last place of flipping
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        value_parser = clap::value_parser!(u32).range(0..=1_000_000)
    )]
    prove: u32,
    /// Folder for path.csv, grid.csv and a map of each grid as SVG; it is made if it is missing
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What all scenes and methods gave.
#[derive(Default)]
struct Results {
    summary: Table,
    path: Table,
    grid: Table,
    flips: String,
    /// Names of maps, and the maps.
    maps: Vec<(String, String)>,
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let settings = settings(&args.set)?;
    let mut results = Results::default();
    for (at, source) in args.scenes.iter().enumerate() {
        let loaded = scene::open(source, &LoadOptions::default())?;
        let share = (at, args.scenes.len());
        each!(loaded, scene => of(args, &scene, &settings, share, &mut results))?;
    }
    if let Some(folder) = &args.out {
        write(folder, &results)?;
    }
    let shown = only(&results.summary, &PRINTED);
    output::print(format!("{}{}", shown.text(), results.flips).as_bytes())
}

fn of<S: World>(
    args: &Args,
    scene: &Arc<Scene<S>>,
    settings: &Settings,
    (at, count): (usize, usize),
    to: &mut Results,
) -> Result<(), CliError> {
    let entries: Vec<&dyn Entry<S>> = match &args.method {
        Some(key) => vec![find::<S>(key)?],
        None => S::methods().to_vec(),
    };
    let views = args.view.path(scene, SIDE_PX)?.views;
    let ask =
        Ask { grid: args.grid as usize, flips: args.flips as usize, ulps: args.prove, ..Ask::default() };
    let bar = Bar::new();
    let whole = Part::of(&bar, at, count);
    for (k, entry) in entries.iter().enumerate() {
        without_clock(*entry, settings)?;
        let here = Part::of(&whole, k, entries.len());
        let first = Motion::new(scene).at(0);
        let run = entry.ready(&first, settings, &Part { whole: &here, start: 0.0, length: 0.1 })?;
        let mut run = run.ok_or(CliError::Interrupted)?;
        let rest = Part { whole: &here, start: 0.1, length: 0.9 };
        let found = stability(scene, &mut *run, &views, &ask, &rest).map_err(explained)?;
        let names = [scene.name(), entry.card().key];
        summary(&mut to.summary, names, &found.on_path(), &found.on_grid());
        path_table(&mut to.path, names, &found.path);
        grid_table(&mut to.grid, names, &found.grid, scene.origin().to_array());
        for flip in &found.flips {
            to.flips += &told::<S>(names, flip, scene.origin(), found.tolerance);
        }
        if let Some(proof) = &found.proof {
            to.flips += &again(names, proof, args.prove);
        }
        if !found.grid.is_empty() && args.out.is_some() {
            to.maps.push((file_name(&to.maps, names), map(scene, entry.card().key, &found, ask.grid)));
        }
    }
    Ok(())
}

/// What fits into a time differs from run to run, and would be taken for popping.
fn without_clock<S: World>(entry: &dyn Entry<S>, settings: &Settings) -> Result<(), CliError> {
    let timed = |(_, value): &(_, KnobValue)| matches!(value, KnobValue::Budget(Budget::Milliseconds(_)));
    match entry.knobs(settings)?.iter().find(|knob| timed(knob)) {
        Some((knob, value)) => Err(CliError::words(
            format!("--set {}={value}", knob.name),
            "what fits into a time differs from run to run, so everything would pop",
        )
        .with_help("give a number of primitives or a share, such as 10%")),
        None => Ok(()),
    }
}

fn explained(error: ExperimentError) -> CliError {
    match error {
        ExperimentError::Setting(error) => error.into(),
        ExperimentError::Cancelled => CliError::Interrupted,
        error @ ExperimentError::UnknownMethod(_) => CliError::work("stability", error.to_string()),
    }
}

/// A flip as lines of text, in the file's own coordinates.
fn told<S: World>([scene, method]: [&str; 2], flip: &Flip, origin: DVec3, tolerance: f32) -> String {
    let place = |eye: &[f32]| {
        let axes = eye.iter().enumerate().map(|(a, v)| (f64::from(*v) + origin[a]).to_string());
        axes.collect::<Vec<_>>().join(",")
    };
    let mut text = format!(
        "\n{scene}, {method}, between views {} and {}: {} {} flips within {} units (asked: {tolerance}).\n",
        flip.after_view,
        flip.after_view + 1,
        S::PRIM,
        flip.prim,
        flip.apart,
    );
    for (side, what) in ["drawn", "left out"].into_iter().enumerate() {
        let shows = if flip.shows[side] { "" } else { ", where it is out of sight" };
        let (eye, decided) = (place(&flip.eyes[side]), decision(&flip.decided[side]));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {what:<8} from {eye}{shows}: {decided}");
    }
    text
}

/// What became of decisions that were made again.
fn again([scene, method]: [&str; 2], proof: &Proof, ulps: u32) -> String {
    let [frames, skipped] = proof.frames;
    let mut text = format!(
        "\n{scene}, {method}: {} claims of {frames} frames made again and accepted; of {} decisions that \
         tell both numbers {} are within {ulps} ulp of flipping.\n",
        proof.proven, proof.told, proof.near,
    );
    for (frame, why) in &proof.refused {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  not accepted in frame {frame}: {why}");
    }
    if skipped > 0 {
        let _ = writeln!(text, "  {skipped} frames have too many events and were left out");
    }
    text
}

/// A decision with its operands.
fn decision(decided: &Decided) -> String {
    let Some(step) = decided.step else { return "the method does not say why.".into() };
    let mut text = format!("{} at step {step}.", decided.verdict);
    if !decided.sentence.is_empty() {
        text += &format!(" {}", decided.sentence);
    }
    if let Some(compared) = &decided.compared {
        text += &format!(" Compared: {compared}.");
    }
    text
}

/// Some columns of a table, in this order.
fn only(table: &Table, keys: &[&str]) -> Table {
    let places: Vec<usize> =
        keys.iter().filter_map(|key| table.columns.iter().position(|c| c.key == *key)).collect();
    let columns: Vec<Column> = places.iter().map(|at| table.columns[*at]).collect();
    let rows = table.rows.iter().map(|row| places.iter().map(|at| row[*at].clone()).collect()).collect();
    Table { columns, rows }
}

/// `SCENE-METHOD.svg`, with a number where there is one of that name.
fn file_name(taken: &[(String, String)], names: [&str; 2]) -> String {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
    let stem: String = names.join("-").chars().map(plain).collect();
    let name = |k: usize| if k == 0 { format!("{stem}.svg") } else { format!("{stem}-{k}.svg") };
    (0..=taken.len()).map(name).find(|n| taken.iter().all(|(t, _)| t != n)).unwrap_or_default()
}

/// The map of a grid as SVG.
fn map<S: World>(scene: &Scene<S>, method: &str, found: &Stability, side: usize) -> String {
    let recipe = format!("cullscope stability {} --method {method} --grid {side}", scene.source());
    let options = SvgOptions { outline_text: false, metadata: Some(&recipe) };
    svg(&floor_map(scene, format!("{}: {method}", scene.name()), found, side), Theme::Print, &options)
}

fn write(folder: &Path, results: &Results) -> Result<(), CliError> {
    fs::create_dir_all(folder).map_err(|e| CliError::work(folder.display().to_string(), reason(&e)))?;
    let tables = [("path.csv", &results.path), ("grid.csv", &results.grid)];
    let tables = tables.into_iter().filter(|(_, table)| !table.rows.is_empty());
    let files = tables.map(|(name, table)| (name.to_owned(), table.csv()));
    for (name, text) in files.chain(results.maps.iter().cloned()) {
        output::write_file(&folder.join(name), |to| to.write_all(text.as_bytes()).map(|()| true))?;
    }
    Ok(())
}
