//! `cullscope sweep`: speed against error, of many methods with many parameters on many scenes.
//!
//! Its folder holds a log, to which a line is added for each piece of the result as soon as it is known, and
//! what is made of the log once all is known. So a sweep that was ended can go on, and parts of it that ran
//! on several machines can be put together.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::error::reason;
use super::progress::Bar;
use super::{CliError, World, output, scene, suggest};
use crate::figure::tradeoffs;
use crate::geometry::each;
use crate::measure::sweep::{
    Line, Log, LogError, Place, Spec, SpecError, SweepError, fly, named, path, results, share,
};
use crate::measure::{ExperimentError, Table};
use crate::render::{self, Theme};
use crate::scene::{AnyScene, LoadOptions, Part, Scene, write_views};

#[derive(clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Examples:\n  cullscope sweep examples/sweeps/cross-method.toml --out cross\n  cullscope \
                  sweep spec.toml --shard 2/4 --out part-2\n  cullscope sweep merge part-1 part-2 part-3 \
                  part-4 --out all\n\nA spec:\n  scenes = [\"generate:city\", { source = \"a.obj\", path = \
                  \"walk\" }]\n  frames = 12\n  repeats = 3\n  size = [512, 512]\n  [[method]]\n  key = \
                  \"frustum\"\n  [[method]]\n  key = \"layered-projection\"\n  set = { budget = [\"1%\", \
                  \"5%\"] }    # one configuration for each value"
)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// What to run, a TOML file
    #[arg(value_name = "SPEC.toml", required = true)]
    spec: Option<PathBuf>,
    #[command(flatten)]
    to: To,
    /// Run one part of several, such as 2/4; `sweep merge` puts them together
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<[u32; 2]>,
    /// Go on with the sweep that the folder holds
    #[arg(long)]
    resume: bool,
}

#[derive(clap::Args)]
struct To {
    /// Folder of the results [default: the spec's name and `-sweep`]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Put together what parts of a sweep found; the same but for times as if one had run all
    #[command(after_help = "Example:\n  cullscope sweep merge part-1 part-2 part-3 part-4 --out all")]
    Merge {
        /// Folders of the parts
        #[arg(value_name = "DIR", required = true)]
        parts: Vec<PathBuf>,
        #[command(flatten)]
        to: To,
    },
}

/// Names of files in a folder of results.
const SPEC: &str = "spec.toml";
const LOG: &str = "log.jsonl";

fn shard(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some([i.parse().ok()?, n.parse().ok()?]));
    let fits = |[i, n]: &[u32; 2]| *i >= 1 && i <= n && *n <= 100_000;
    parts.filter(fits).ok_or_else(|| "expected a part and the number of parts such as 2/4".into())
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    match (&args.command, &args.spec) {
        (Some(Command::Merge { parts, to }), _) => merge(parts, to),
        (None, Some(spec)) => sweep(args, spec),
        (None, None) => Ok(()),
    }
}

fn text_of(path: &Path) -> Result<String, CliError> {
    fs::read_to_string(path).map_err(|e| CliError::work(path.display().to_string(), reason(&e)))
}

fn spec_of(path: &Path, text: &str) -> Result<Spec, CliError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Spec::parse(text, &name).map_err(|fault| explained(&path.display().to_string(), fault))
}

/// What is wrong with a spec, and what is near it.
fn explained(place: &str, fault: SpecError) -> CliError {
    let error = CliError::work(place.to_owned(), fault.to_string());
    if fault.known.is_empty() {
        return error;
    }
    let known: Vec<&str> = fault.known.iter().map(String::as_str).collect();
    error.with_help(suggest::help(&fault.what, &known, "known"))
}

fn sweep(args: &Args, file: &Path) -> Result<(), CliError> {
    let text = text_of(file)?;
    let spec = spec_of(file, &text)?;
    let out = args.to.out.clone().unwrap_or_else(|| format!("{}-sweep", spec.name).into());
    let place = file.display().to_string();
    let scenes = opened(&spec, &place)?;
    fs::create_dir_all(&out).map_err(|e| CliError::work(out.display().to_string(), reason(&e)))?;
    let mut log = Log::default();
    let journal = out.join(LOG);
    if journal.exists() {
        let held = format!("{} holds a sweep", out.display());
        if !args.resume {
            return Err(CliError::work("--out", held).with_help("give --resume to go on, or another folder"));
        }
        read(&mut log, &journal, &spec)?;
    }
    let mut journal = Journal::open(journal, &spec, &log)?;
    let text = named(&text, &spec);
    output::write_file(&out.join(SPEC), |to| to.write_all(text.as_bytes()).map(|()| true))?;
    let bar = Bar::new();
    for (number, scene) in scenes.iter().enumerate() {
        let part = Part::of(&bar, number, scenes.len());
        let ours = share(number, spec.configurations.len(), args.shard.unwrap_or([1, 1]));
        forget_peak();
        let mut keep = |line: &Line| journal.keep(line);
        let flown = each!(scene, scene => {
            let views = path(scene, &spec.scenes[number], &spec).map_err(|e| failed(&place, e))?;
            let (to, text) = (out.join(format!("views-{number}.json")), write_views(&views, scene.origin()));
            output::write_file(&to, |to| to.write_all(text.as_bytes()).map(|()| true))?;
            fly((&spec, number), scene, &views, &ours, &mut log, &mut keep, &part)
        });
        flown.map_err(|e| failed(&place, e)).map_err(|e| still(e, &out))?;
        if let Some(peak_bytes) = peak_bytes().filter(|_| !ours.is_empty()) {
            let line = Line::Memory { scene: number as u32, peak_bytes };
            journal.keep(&line).map_err(|why| CliError::work(out.display().to_string(), why))?;
            log.add(line);
        }
    }
    drop(bar);
    finish(&spec, &log, &out)
}

/// What an interruption leaves.
fn still(error: CliError, out: &Path) -> CliError {
    if matches!(error, CliError::Interrupted) {
        output::say(&format!("what was measured is in {}; --resume goes on", out.display()));
    }
    error
}

/// All scenes of a spec, and whether its methods run on them: better before the work than after an hour.
fn opened(spec: &Spec, place: &str) -> Result<Vec<AnyScene>, CliError> {
    let mut scenes = Vec::new();
    for wanted in &spec.scenes {
        let found = scene::open(&wanted.source, &LoadOptions::default())?;
        each!(&found, scene => fits(scene, wanted, spec, place))?;
        scenes.push(found);
    }
    Ok(scenes)
}

fn fits<S: World>(scene: &Scene<S>, wanted: &Place, spec: &Spec, place: &str) -> Result<(), CliError> {
    for one in &spec.configurations {
        one.check::<S>().map_err(|fault| explained(place, fault))?;
    }
    path(scene, wanted, spec).map(drop).map_err(|e| failed(place, e))
}

fn failed(place: &str, error: SweepError) -> CliError {
    match error {
        SweepError::Experiment(ExperimentError::Cancelled) => CliError::Interrupted,
        SweepError::Path { ref name, ref known } => {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = match known.is_empty() {
                true => "it has none: leave `path` out, and one is invented".to_owned(),
                false => suggest::help(name, &known, "paths"),
            };
            CliError::work(place.to_owned(), error.to_string()).with_help(help)
        }
        error => CliError::work(place.to_owned(), error.to_string()),
    }
}

fn read(log: &mut Log, journal: &Path, spec: &Spec) -> Result<(), CliError> {
    let named = |why: LogError| CliError::work(journal.display().to_string(), why.to_string());
    log.read(&text_of(journal)?, spec).map_err(named)
}

/// The log's file; each line is there once it is kept.
struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens it behind its last whole line, and begins it where nothing is known yet.
    fn open(path: PathBuf, spec: &Spec, log: &Log) -> Result<Self, CliError> {
        let failed = |e: std::io::Error| CliError::write(&path.display().to_string(), &e);
        let file = OpenOptions::new().create(true).read(true).append(true).open(&path).map_err(failed)?;
        let whole = fs::read(&path).map_err(failed)?.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        file.set_len(whole as u64).map_err(failed)?;
        let mut journal = Self { path, file };
        if log.is_empty() {
            let place = journal.path.display().to_string();
            journal.keep(&Line::head(spec)).map_err(|why| CliError::work(place, why))?;
        }
        Ok(journal)
    }
    fn keep(&mut self, line: &Line) -> Result<(), String> {
        // One call a line: what a crash cuts off is the end of the last one.
        let kept = self.file.write_all(line.text().as_bytes());
        kept.map_err(|e| format!("{} could not be written: {}", self.path.display(), reason(&e)))
    }
}

fn merge(parts: &[PathBuf], to: &To) -> Result<(), CliError> {
    let first = parts[0].join(SPEC);
    let text = text_of(&first)?;
    let spec = spec_of(&first, &text)?;
    let out = to.out.clone().unwrap_or_else(|| format!("{}-sweep", spec.name).into());
    if out.join(LOG).exists() {
        return Err(CliError::work("--out", format!("{} holds a sweep", out.display()))
            .with_help("give another folder"));
    }
    let mut log = Log::default();
    for part in parts {
        read(&mut log, &part.join(LOG), &spec)?;
    }
    let [missing, all] = log.missing(&spec);
    if missing > 0 {
        output::say(&format!("{missing} of {all} configurations are not finished; they are left out"));
    }
    fs::create_dir_all(&out).map_err(|e| CliError::work(out.display().to_string(), reason(&e)))?;
    let views = (0..spec.scenes.len()).map(|number| format!("views-{number}.json"));
    for name in views {
        if let Some(found) = parts.iter().map(|part| part.join(&name)).find(|path| path.exists()) {
            let bytes = text_of(&found)?;
            output::write_file(&out.join(&name), |to| to.write_all(bytes.as_bytes()).map(|()| true))?;
        }
    }
    output::write_file(&out.join(SPEC), |to| to.write_all(text.as_bytes()).map(|()| true))?;
    output::write_file(&out.join(LOG), |to| to.write_all(log.text(&spec).as_bytes()).map(|()| true))?;
    finish(&spec, &log, &out)
}

/// Writes tables, chart and report, and prints the configurations.
fn finish(spec: &Spec, log: &Log, out: &Path) -> Result<(), CliError> {
    let tables: [(&str, &str, Table); 4] = [
        ("configurations", "Configurations", results::configurations(log, spec)),
        ("frames", "Frames", results::frames(log, spec)),
        ("stages", "Stages of culling", results::stages(log, spec)),
        ("counts", "What the methods counted", results::counts(log, spec)),
    ];
    let mut files: Vec<(String, Vec<u8>)> = vec![("results.jsonl".into(), log.text(spec).into_bytes())];
    files.extend(tables.iter().map(|(name, _, table)| (format!("{name}.csv"), table.csv().into_bytes())));
    let charts = results::charts(log, spec);
    let recipe = "cullscope sweep spec.toml";
    let caption = caption(spec);
    let title = format!("Speed against error: {}", spec.name);
    let drawing = tradeoffs(&title, &charts, &caption);
    for format in render::Format::ALL {
        let bytes = render::export(&drawing, format, Theme::Print, recipe)
            .map_err(|e| CliError::work("chart", e.to_string()))?;
        files.push((format!("chart.{}", format.name()), bytes));
    }
    let shown: Vec<(&str, &Table)> = tables.iter().map(|(_, title, table)| (*title, table)).collect();
    // The page has title and caption of its own.
    let page = render::page(&title, &caption, &tradeoffs("", &charts, ""), &shown, Theme::Print);
    files.push(("report.html".into(), page.into_bytes()));
    for (name, bytes) in &files {
        output::write_file(&out.join(name), |to| to.write_all(bytes).map(|()| true))?;
    }
    output::print(tables[0].2.text().as_bytes())?;
    output::say(&format!("{}", out.join("report.html").display()));
    Ok(())
}

/// What is to be known for reading the chart.
fn caption(spec: &Spec) -> String {
    format!(
        "{} frames of each scene's path. Wall-clock times on one thread from the view to the finished \
         image; all configurations take turns at each frame. A dot is the mean frame of a configuration, of \
         medians over {} flights; its bar goes from the fastest flight to the slowest. Gray: single frames. \
         Error: {}, of the images together; what makes none stands in the band at the left, a line for each \
         method. Steps and rings: the Pareto front, configurations that nothing beats in both.",
        spec.frames,
        spec.repeats,
        spec.error.label(),
    )
}

/// Forgets how much memory was held at most, where the system can.
fn forget_peak() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// How much memory was held at most since then, where the system says.
fn peak_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    kilobytes.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kb| kb * 1024)
}
