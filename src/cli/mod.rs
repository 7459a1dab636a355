//! The command line: one file a subcommand. Parses, calls the rooms below, prints.
//!
//! Results go to standard output or to `--out`, messages and progress to standard error. Exit status: 0 done,
//! 1 the work failed, 2 the words of the call are off. An error is one line, `error: WHAT: WHY`, and if it
//! helps one line `help: …`.

mod advise;
mod bench;
mod convert;
mod cull;
mod error;
mod explore;
mod figure;
mod gallery;
mod methods;
mod output;
mod paper;
mod plates;
mod progress;
mod remake;
mod scene;
mod snapshot;
mod stability;
mod step;
mod suggest;
mod sweep;
mod task;
mod trace;
mod truth;
mod view;
mod words;

pub use error::CliError;

use std::ffi::OsString;

use clap::{Parser, Subcommand};

use crate::culling::Methods;
use crate::raster::Drawable;

/// A space in which commands work.
trait World: Methods + Drawable {}
impl<S: Methods + Drawable> World for S {}

#[derive(Parser)]
#[command(
    name = "cullscope",
    version,
    about = "A visual explorer and step-through debugger of visibility culling",
    after_help = "Examples:\n  cullscope                                     open the explorer\n  cullscope \
                  cull model.obj --method frustum --truth\n  cullscope step scenes2d/street.json --method \
                  frustum | head\n\nA SCENE is a path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, \
                  or generate:NAME[?key=value&…].",
    disable_help_subcommand = true
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Open the explorer (the same as no command at all)
    Explore(explore::Args),
    /// Cull a scene for each view and print what was drawn, how long it took and how right it is
    Cull(cull::Args),
    /// Write a run step by step, as JSON Lines
    Step(step::Args),
    /// Write figures as SVG, PDF or PNG: built-in ones, or any step of any scene
    Figure(figure::Args),
    /// Measure the tables of the papers, beside the papers' own figures
    Paper(paper::Args),
    /// Compare our images with those of a graphics device
    Truth(truth::Args),
    /// Chart speed against error, of methods with their parameters on scenes
    Sweep(sweep::Args),
    /// Find the simplest configuration that is right enough at the least time
    Advise(advise::Args),
    /// Find where a small step of the eye changes what is drawn without cause, and which test decides there
    Stability(stability::Args),
    /// Measure on an input that other programs read too
    #[command(subcommand)]
    Bench(bench::Command),
    /// List the methods and their parameters
    Methods(methods::Args),
    /// Look into scenes and convert them
    #[command(subcommand)]
    Scene(scene::Command),
    /// Check recorded runs, and make figures of them
    #[command(subcommand)]
    Trace(trace::Command),
}

/// Runs the command line with these words, the program's name first.
///
/// # Errors
/// What the caller should print and exit with; see [`CliError`].
pub fn run(words: impl IntoIterator<Item = OsString>) -> Result<(), CliError> {
    let cli = match Cli::try_parse_from(words) {
        Ok(cli) => cli,
        Err(e) => return words::explain(&e),
    };
    match cli.command {
        None => explore::run(&explore::Args::default()),
        Some(Command::Explore(args)) => explore::run(&args),
        Some(Command::Cull(args)) => cull::run(&args),
        Some(Command::Step(args)) => step::run(&args),
        Some(Command::Figure(args)) => figure::run(&args),
        Some(Command::Paper(args)) => paper::run(&args),
        Some(Command::Truth(args)) => truth::run(&args),
        Some(Command::Sweep(args)) => sweep::run(&args),
        Some(Command::Advise(args)) => advise::run(&args),
        Some(Command::Stability(args)) => stability::run(&args),
        Some(Command::Bench(command)) => bench::run(&command),
        Some(Command::Methods(args)) => methods::run(&args),
        Some(Command::Scene(command)) => scene::run(&command),
        Some(Command::Trace(command)) => trace::run(&command),
    }
}
