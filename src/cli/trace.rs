//! `cullscope trace`: whether a recorded run keeps to the trace format, on demand whether it is true, and
//! what it shows as figures.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::sync::Arc;

use serde_json::Value as Json;

use super::methods::find;
use super::plates::Files;
use super::progress::Bar;
use super::snapshot::{Begin, Shot};
use super::step::FILM_CAP;
use super::{CliError, World, error::reason, output, scene};
use crate::app::{AnyOpened, Opened, State};
use crate::geometry::{Either, ViewPath, each};
use crate::method::Settings;
use crate::scene::{LoadOptions, Motion, Part, Progress, Scene, parse_views};
use crate::trace::Detail;
use crate::trace::format::{self, Header, Summary, write_film, write_header};
use crate::truth::certificate::check_film;

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Validate a trace and name its first bad line
    #[command(
        after_help = "Example:\n  cullscope trace check run.jsonl\n  cullscope trace check run.jsonl --prove"
    )]
    Check {
        /// A trace, as `cullscope step` writes it
        #[arg(value_name = "FILE")]
        file: String,
        /// Run its method again on its scene: every line must be the same, and what was called outside or
        /// hidden must be
        #[arg(long)]
        prove: bool,
    },
    /// Write figures of a step of a trace, once it is proven
    #[command(
        after_help = "Example:\n  cullscope trace figure run.jsonl --first-hidden --picture observer,eye \
                      --as page"
    )]
    Figure(Box<FigureArgs>),
}

#[derive(clap::Args)]
pub(super) struct FigureArgs {
    /// A trace, as `cullscope step` writes it
    #[arg(id = "scene", value_name = "FILE")]
    file: String,
    /// Which of its frames
    #[arg(long, value_name = "N", default_value_t = 0)]
    frame: usize,
    #[command(flatten)]
    files: Files,
    #[command(flatten)]
    shot: Shot,
}

pub(super) fn run(command: &Command) -> Result<(), CliError> {
    match command {
        Command::Check { file, prove } => check(file, *prove),
        Command::Figure(args) => figure(args),
    }
}

fn summary(file: &str) -> Result<Summary, CliError> {
    format::check(read(file)?).map_err(|e| CliError::work(format!("{file}:{}", e.line()), e.why()))
}

fn check(file: &str, prove: bool) -> Result<(), CliError> {
    let summary = summary(file)?;
    let (method, scene) = (&summary.header.method, &summary.header.scene);
    let text = format!(
        "{file}: valid: {} events in {} frames of `{method}` on {scene}\n",
        summary.events, summary.frames
    );
    if !prove {
        return output::print(text.as_bytes());
    }
    let scene = scene::open(scene, &LoadOptions::default())?;
    let proven = each!(scene, scene => proven(file, &summary.header, &scene));
    output::print((text + &proven?).as_bytes())
}

fn read(file: &str) -> Result<BufReader<File>, CliError> {
    File::open(file).map(BufReader::new).map_err(|e| CliError::work(file, reason(&e)))
}

/// Steps of figures are events of the run in full, also where the trace has the coarse ones only.
fn figure(args: &FigureArgs) -> Result<(), CliError> {
    let (file, header) = (args.file.as_str(), summary(&args.file)?.header);
    let filter = args.shot.filter()?;
    let begin = match scene::open(&header.scene, &LoadOptions::default())? {
        Either::Flat(scene) => begin(file, &header, &scene, args.frame, Either::Flat)?,
        Either::Solid(scene) => begin(file, &header, &scene, args.frame, Either::Solid)?,
    };
    let bar = Bar::new();
    let mut state = State::new();
    (state.method, state.settings) = (header.method.clone(), parameters(&header));
    args.shot.stage(&mut state, begin, None, &bar)?;
    args.shot.write(&mut state, filter.as_ref(), &args.files, &bar)
}

/// What the explorer begins with for a frame of a trace that is what its method tells.
fn begin<S: World>(
    file: &str,
    header: &Header,
    scene: &Arc<Scene<S>>,
    frame: usize,
    wrap: fn(Opened<S>) -> AnyOpened,
) -> Result<Begin, CliError> {
    proven(file, header, scene)?;
    let path = views(file, header, scene)?;
    let count = path.views.len();
    if frame >= count {
        let said = format!("{file} has frames 0 to {}", count - 1);
        return Err(CliError::words(format!("--frame {frame}"), said));
    }
    Ok(Begin { opened: wrap((scene.clone(), Some(path))), eye: None, path: None, frame })
}

fn parameters(header: &Header) -> Settings {
    let text = |value: &Json| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    Settings(header.params.iter().map(|(key, value)| (key.clone(), text(value))).collect())
}

fn views<S: World>(file: &str, header: &Header, scene: &Scene<S>) -> Result<ViewPath<S>, CliError> {
    let view = Json::Object(header.view.clone()).to_string();
    Ok(parse_views(view.as_bytes(), file, scene.origin())?)
}

/// Runs what the header says, compares it with the file line by line, and checks the certificates of every
/// frame.
fn proven<S: World>(file: &str, header: &Header, scene: &Arc<Scene<S>>) -> Result<String, CliError> {
    if header.more.get("scene_sha256").is_some_and(|hash| *hash != scene.hash_hex()) {
        return Err(CliError::work(
            file,
            format!("{} is not the scene of this trace any more", header.scene),
        ));
    }
    let (settings, path) = (parameters(header), views(file, header, scene)?);
    let bar = Bar::new();
    let entry = find::<S>(&header.method)?;
    let mut motion = Motion::new(scene);
    let mut run = entry.ready(&motion.at(0), &settings, &bar)?.ok_or(CliError::Interrupted)?;
    let detail =
        if header.more.get("detail").is_some_and(|d| d == "coarse") { Detail::Coarse } else { Detail::Full };
    let mut same = Same { theirs: read(file)?, line: 1, buffer: Vec::new() };
    let differs = |e: io::Error| {
        CliError::work(file, reason(&e))
            .with_help("the trace was made by another version, with a preprocess, or altered")
    };
    write_header(header, &mut same).map_err(differs)?;
    let (mut certificates, mut lost) = (0, 0);
    for (frame, view) in path.views.iter().enumerate() {
        let part = Part::of(&bar, frame, path.views.len());
        part.report(0.0, "proving");
        if bar.cancelled() || !run.pose(&motion.at(frame), &part) {
            return Err(CliError::Interrupted);
        }
        let film = run.record(view, FILM_CAP).film;
        certificates += check_film(&*film)
            .map_err(|e| CliError::work(format!("{file}: frame {frame}"), e.to_string()))?;
        lost += film.lost();
        write_film(&*film, frame as u64, detail, &mut same, &|_| false).map_err(differs)?;
    }
    same.end().map_err(differs)?;
    let unseen = if lost > 0 {
        format!("; {lost} events past the {FILM_CAP} of a frame were not looked at")
    } else {
        String::new()
    };
    Ok(format!("{file}: proven: {certificates} certificates in {} frames{unseen}\n", path.views.len()))
}

/// Takes what is written and asks that a file holds the same bytes.
struct Same<R> {
    theirs: R,
    line: u64,
    buffer: Vec<u8>,
}

impl<R: Read> Same<R> {
    fn differs(&self, what: &str) -> io::Error {
        io::Error::other(format!("line {} {what}", self.line))
    }
    /// That nothing follows.
    fn end(mut self) -> io::Result<()> {
        if self.theirs.read(&mut [0])? == 0 {
            Ok(())
        } else {
            Err(self.differs("and what follows is not told by the method"))
        }
    }
}

impl<R: Read> Write for Same<R> {
    fn write(&mut self, ours: &[u8]) -> io::Result<usize> {
        self.buffer.resize(ours.len(), 0);
        let read = self.theirs.read_exact(&mut self.buffer);
        let equal = ours.iter().zip(&self.buffer).take_while(|(a, b)| a == b).count();
        self.line += ours[..equal].iter().filter(|b| **b == b'\n').count() as u64;
        match read {
            Err(e) if e.kind() != io::ErrorKind::UnexpectedEof => Err(e),
            Ok(()) if equal == ours.len() => Ok(equal),
            _ => Err(self.differs("is not what the method tells")),
        }
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
