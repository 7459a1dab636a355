//! `cullscope step`: a run step by step, as JSON Lines.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Map, Value as Json};

use super::methods::{params_json, refuse_clock};
use super::task::Task;
use super::{CliError, World, output};
use crate::geometry::{ViewPath, each};
use crate::scene::{Progress, Scene, write_views};
use crate::trace::Detail;
use crate::trace::format::{Header, write_film, write_header};

/// Events of a frame that are recorded before the rest is only counted.
pub(super) const FILM_CAP: usize = 10_000_000;

#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  cullscope step scenes2d/street.json --method frustum --detail coarse --out \
                  street.jsonl\n  cullscope trace check street.jsonl"
)]
pub(super) struct Args {
    #[command(flatten)]
    task: Task,
    /// `coarse` leaves out the lines of pseudocode
    #[arg(long, value_enum, default_value = "full")]
    detail: Fineness,
    /// Write to a file instead of standard output
    #[arg(long, value_name = "FILE.jsonl")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Fineness {
    Coarse,
    Full,
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    each!(args.task.load()?, scene => of(args, &scene))
}

fn of<S: World>(args: &Args, scene: &Arc<Scene<S>>) -> Result<(), CliError> {
    let mut ready = args.task.ready(scene)?;
    refuse_clock(&ready.run.knobs())?;
    let (detail, name) = match args.detail {
        Fineness::Coarse => (Detail::Coarse, "coarse"),
        Fineness::Full => (Detail::Full, "full"),
    };
    let params = params_json(&ready.run.knobs()).into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
    let header = header(scene, ready.run.card().key, params, &ready.path, name);
    output::emit(args.out.as_deref(), |to| {
        let mut to = Counted { to, bytes: 0 };
        write_header(&header, &mut to)?;
        let count = ready.path.views.len();
        for frame in 0..count {
            match ready.pose(frame) {
                Err(CliError::Interrupted) => return Ok(false),
                posed => posed.map_err(io::Error::other)?,
            };
            let film = ready.run.record(&ready.path.views[frame], FILM_CAP).film;
            let (done, part, events) = (frame as f32, 1.0 / count as f32, film.events().len().max(1) as f32);
            let stop = |at: usize| {
                ready.bar.report((done + at as f32 / events) * part, "writing steps");
                ready.bar.cancelled()
            };
            write_film(&*film, frame as u64, detail, &mut to, &stop)?;
            if ready.bar.cancelled() {
                return Ok(false);
            }
            if frame == 0 {
                forewarn(to.bytes, count);
            }
        }
        Ok(true)
    })
}

/// Says how much a path will write, where that is much.
fn forewarn(bytes_of_first: u64, frames: usize) {
    const MUCH: u64 = 256 << 20;
    let bytes = bytes_of_first.saturating_mul(frames as u64);
    if bytes >= MUCH && frames > 1 {
        let gigabytes = bytes as f64 / 1e9;
        output::say(&format!(
            "note: the trace of {frames} frames will take about {gigabytes:.1} GB; Ctrl-C ends it, \
             `--detail coarse` takes less, a view takes one frame"
        ));
    }
}

/// Counts the bytes that pass.
struct Counted<'a> {
    to: &'a mut dyn Write,
    bytes: u64,
}

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.to.write(bytes)?;
        self.bytes += written as u64;
        Ok(written)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

fn header<S: World>(
    scene: &Scene<S>,
    method: &str,
    params: Map<String, Json>,
    path: &ViewPath<S>,
    detail: &str,
) -> Header {
    // The text of a view file is an object.
    let view = serde_json::from_str(&write_views(path, scene.origin())).unwrap_or_default();
    let more = [
        ("space", S::NAME),
        ("scene_sha256", &scene.hash_hex()),
        ("cullscope", env!("CARGO_PKG_VERSION")),
        ("detail", detail),
    ];
    let more = more.iter().map(|(key, value)| ((*key).to_owned(), Json::from(*value))).collect();
    Header { scene: scene.source().to_owned(), method: method.to_owned(), params, view, more }
}
