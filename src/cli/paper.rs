//! `cullscope paper`: the tables of the papers, measured here, beside the papers' own figures.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use super::error::reason;
use super::methods::{json_text, settings};
use super::progress::Bar;
use super::{CliError, output, scene, suggest};
use crate::figure::chart;
use crate::geometry::MAX_SIDE_PX;
use crate::measure::{Experiment, ExperimentError, Report, Setup};
use crate::papers::{self, PAPERS, Paper};
use crate::render::{self, RenderError, Theme};
use crate::scene::{AnyScene, LoadOptions, Part};

#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  cullscope paper coorg-teller-table-1\n  cullscope paper coorg-teller-table-3 \
                  --scene generate:city --format text,csv,svg --out tables\n  cullscope paper --list\n  \
                  cullscope paper coorg-teller\n\nA file for each format but text, which is printed. Times \
                  are wall clock on one thread; measure with a release build."
)]
pub(super) struct Args {
    /// Which tables; --list names them. The key of a paper lists its figures and tables instead
    #[arg(value_name = "NAME", conflicts_with_all = ["all", "list"])]
    names: Vec<String>,
    /// All of them
    #[arg(long, conflicts_with = "list")]
    all: bool,
    /// List the tables instead
    #[arg(long)]
    list: bool,
    /// A path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME[?key=value&…]; may be
    /// given several times [default: generated scenes that are likened to the paper's]
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// Frames that are measured on each scene
    #[arg(
        long,
        value_name = "N",
        default_value_t = 240,
        value_parser = clap::value_parser!(u32).range(1..=100_000)
    )]
    frames: u32,
    /// A parameter of the method; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Every how many frames the answer is compared with the truth; 0: never
    #[arg(long, value_name = "N", default_value_t = 8)]
    check_every: u32,
    /// Random rectangles that zhang-overlap asks maps about
    #[arg(
        long,
        value_name = "N",
        default_value_t = 100_000,
        value_parser = clap::value_parser!(u32).range(1..=100_000_000)
    )]
    rectangles: u32,
    /// Image size in pixels [default: that of the path]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Formats, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "text")]
    format: Vec<Format>,
    /// Folder for the files; it is made if it is missing
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
enum Format {
    /// Aligned, to standard output
    Text,
    /// The table, with every digit
    Csv,
    /// The table, its scenes and parameters, with every digit
    Json,
    /// The chart
    Svg,
    /// The chart
    Pdf,
    /// The chart
    Png,
}

pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |t: &str| t.trim().parse().ok().filter(|v| (1..=MAX_SIDE_PX).contains(v));
    let both = text.split_once(['x', 'X', '×']).and_then(|(w, h)| Some([side(w)?, side(h)?]));
    both.ok_or_else(|| format!("expected a width and a height from 1 to {MAX_SIDE_PX} such as 1024x1024"))
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    if args.list {
        let mut text = String::new();
        for experiment in papers::tables() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:<28} {}", experiment.name, experiment.summary);
        }
        return output::print(text.as_bytes());
    }
    if let [key] = &args.names[..]
        && let Some(paper) = PAPERS.iter().find(|paper| paper.key == key)
    {
        return output::print(contents(paper).as_bytes());
    }
    let experiments = chosen(args)?;
    let setup = Setup {
        frames: args.frames as usize,
        settings: settings(&args.set)?,
        check_every: args.check_every as usize,
        rectangles: args.rectangles as usize,
        size_px: args.size,
        ..Setup::default()
    };
    for experiment in &experiments {
        experiment.check(&setup.settings).map_err(explained)?;
    }
    let formats: BTreeSet<Format> = args.format.iter().copied().collect();
    let open = |sources: &[&str]| {
        sources.iter().map(|s| scene::open(s, &LoadOptions::default())).collect::<Result<Vec<_>, _>>()
    };
    let named = open(&args.scene.iter().map(String::as_str).collect::<Vec<_>>())?;
    let mut own: (&[&str], Vec<AnyScene>) = (&[], vec![]);
    if formats.iter().any(|f| *f != Format::Text) {
        fs::create_dir_all(&args.out)
            .map_err(|e| CliError::work(args.out.display().to_string(), reason(&e)))?;
    }
    for (i, experiment) in experiments.iter().enumerate() {
        let n = experiments.len() as f32;
        let bar = Bar::new();
        let part = Part { whole: &bar, start: i as f32 / n, length: 1.0 / n };
        if named.is_empty() && own.0 != experiment.scenes {
            own = (experiment.scenes, open(experiment.scenes)?);
        }
        let scenes = if named.is_empty() { &own.1 } else { &named };
        let report = experiment.run(scenes, &setup, &part).map_err(explained)?;
        drop(bar);
        for format in &formats {
            write(&report, *format, &args.out, &recipe(args, experiment))?;
        }
    }
    // Once, below all tables: what they compare with a paper is not quite what the paper ran.
    if formats.contains(&Format::Text) {
        let run = |paper: &&Paper| experiments.iter().any(|e| paper.tables.iter().any(|t| t.name == e.name));
        let text: String = PAPERS.iter().copied().filter(run).map(departures).collect();
        output::print(text.as_bytes())?;
    }
    Ok(())
}

/// A paper: what it is, its figures, its tables.
fn contents(paper: &Paper) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for source in paper.sources() {
        let _ = writeln!(text, "{}", source.title);
        if !source.doi.is_empty() {
            let _ = writeln!(text, "https://doi.org/{}", source.doi);
        }
    }
    let _ = writeln!(text, "methods: {}", paper.methods.join(", "));
    let figures = paper.figures.iter().map(|f| (f.name, f.summary)).collect();
    let tables = paper.tables.iter().map(|t| (t.name, t.summary)).collect();
    let lists: [(&str, Vec<(&str, &str)>); 2] = [("figures", figures), ("tables", tables)];
    for (what, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
        let _ = writeln!(text, "\n{what}:");
        for (name, summary) in list {
            let _ = writeln!(text, "  {name:<32} {summary}");
        }
    }
    text + &departures(paper)
}

/// Where what is run differs from a paper, as lines of text; nothing where it does not.
fn departures(paper: &Paper) -> String {
    let mut text = String::new();
    for (method, departures) in paper.departures() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n{method} departs from the paper (why: cullscope methods):");
        for departure in departures {
            let _ = writeln!(text, "  Section {}: {}", departure.section, departure.what);
        }
    }
    text
}

fn explained(error: ExperimentError) -> CliError {
    match error {
        ExperimentError::Setting(error) => error.into(),
        ExperimentError::Cancelled => CliError::Interrupted,
        error @ ExperimentError::UnknownMethod(_) => CliError::work("paper", error.to_string()),
    }
}

/// The call that makes the same again.
fn recipe(args: &Args, experiment: &Experiment) -> String {
    let mut text = format!("cullscope paper {} --frames {}", experiment.name, args.frames);
    let mut add =
        |option: &str, words: &[String]| words.iter().for_each(|w| text += &format!(" {option} {w}"));
    add("--scene", &args.scene);
    add("--set", &args.set);
    text
}

fn write(report: &Report, format: Format, folder: &Path, recipe: &str) -> Result<(), CliError> {
    let failed = |e: RenderError| CliError::work(report.name, e.to_string());
    let painted = |format: render::Format| {
        let drawing = chart(report.title, &report.plots, &report.caption());
        render::export(&drawing, format, Theme::Print, recipe)
            .map(|bytes| (format.name(), bytes))
            .map_err(failed)
    };
    let (extension, bytes) = match format {
        Format::Text => return output::print((report.text() + "\n").as_bytes()),
        Format::Csv => ("csv", report.table.csv().into_bytes()),
        Format::Json => ("json", json_text(&report.json()).into_bytes()),
        Format::Svg => painted(render::Format::Svg)?,
        Format::Pdf => painted(render::Format::Pdf)?,
        Format::Png => painted(render::Format::Png)?,
    };
    let path = folder.join(format!("{}.{extension}", report.name));
    output::write_file(&path, |to| to.write_all(&bytes).map(|()| true))?;
    output::say(&path.display().to_string());
    Ok(())
}

fn chosen(args: &Args) -> Result<Vec<&'static Experiment>, CliError> {
    let known: Vec<&str> = papers::tables().map(|t| t.name).collect();
    if args.all {
        return Ok(papers::tables().collect());
    }
    if args.names.is_empty() {
        let keys: Vec<&str> = PAPERS.iter().map(|paper| paper.key).collect();
        return Err(CliError::words("paper", "no table is named").with_help(format!(
            "give a NAME or --all; tables: {}; papers: {}",
            known.join(", "),
            keys.join(", ")
        )));
    }
    let find = |name: &String| {
        let missing = || {
            let help = match papers::figure(name) {
                Some(figure) => format!("it is a figure: `cullscope figure {}` makes it", figure.name),
                None => suggest::help(name, &known, "tables"),
            };
            CliError::words(name.as_str(), "there is no such table").with_help(help)
        };
        papers::table(name).ok_or_else(missing)
    };
    args.names.iter().map(find).collect()
}
