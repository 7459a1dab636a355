//! `cullscope explore`: opens the window.

use std::path::Path;

use super::CliError;
use super::methods::{find, settings};
use crate::app::{Shot, Start};
use crate::geometry::{Flat, Solid};
use crate::scene::file_of;

#[derive(clap::Args, Default)]
#[command(
    after_help = "Examples:\n  cullscope explore                                            what was open \
                  last\n  cullscope explore scenes2d/street.json --method frustum --set tree-height=6\n  \
                  cullscope explore model.obj --view walk.views.json"
)]
pub(super) struct Args {
    /// Scene to open: .obj, .gltf, .glb, .pdb, .xyz, a flatland .json, or generate:NAME[?key=value&…]
    scene: Option<String>,
    /// Method to start with; `cullscope methods` lists them
    #[arg(long, value_name = "METHOD")]
    method: Option<String>,
    /// Set a parameter of the method; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// View file: one view or a path
    #[arg(long, value_name = "FILE")]
    view: Option<String>,
    /// Session file, as saved by the explorer
    #[arg(long, value_name = "FILE")]
    session: Option<String>,
    /// Forget the saved layout of the window
    #[arg(long)]
    reset_layout: bool,
    /// Neither read nor write what was open last
    #[arg(long)]
    fresh: bool,
    /// Run a command of the explorer once the scene is there, such as last, theme-dark, go-to:40; may be
    /// given several times
    #[arg(long = "do", value_name = "COMMAND")]
    commands: Vec<String>,
    /// Write a picture of the window and quit
    #[arg(long, value_name = "FILE.png")]
    screenshot: Option<String>,
    /// Size of the window for --screenshot, in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x800", requires = "screenshot")]
    size: String,
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let start = start(args)?;
    if cfg!(all(unix, not(target_os = "macos")))
        && ["DISPLAY", "WAYLAND_DISPLAY"].iter().all(|v| std::env::var_os(v).is_none_or(|v| v.is_empty()))
    {
        return Err(CliError::work("display", "there is none: neither DISPLAY nor WAYLAND_DISPLAY is set")
            .with_help(
                "cull, step and figure work without a display; on a machine with a screen run this in \
                        a desktop session",
            ));
    }
    open(start)
}

fn start(args: &Args) -> Result<Start, CliError> {
    if let Some(method) = &args.method
        && let Err(error) = find::<Flat>(method)
        && find::<Solid>(method).is_err()
    {
        return Err(error);
    }
    for file in [&args.scene, &args.view, &args.session].into_iter().flatten() {
        if !file.starts_with("generate:") && !Path::new(file_of(file)).exists() {
            return Err(CliError::work(file.as_str(), "there is no such file"));
        }
    }
    let shot = match &args.screenshot {
        Some(path) => Some(Shot { path: path.clone(), size_px: size(&args.size)? }),
        None => None,
    };
    Ok(Start {
        scene: args.scene.clone(),
        method: args.method.clone(),
        settings: settings(&args.set)?,
        view: args.view.clone(),
        session: args.session.clone(),
        reset_layout: args.reset_layout,
        fresh: args.fresh,
        commands: args.commands.clone(),
        shot,
    })
}

fn size(text: &str) -> Result<[u32; 2], CliError> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.filter(|s: &[u32; 2]| s.iter().all(|v| (200..=8192).contains(v))).ok_or_else(|| {
        CliError::words(
            "--size",
            format!("`{text}` is not of the form 1280x800, with 200 to 8192 pixels a side"),
        )
    })
}

#[cfg(feature = "gui")]
fn open(start: Start) -> Result<(), CliError> {
    // The window library panics where a system library is missing; that is no fault of ours to report.
    let help = "on Debian and Ubuntu `make run` installs what a window needs; cull, step and figure work \
                without one";
    match std::panic::catch_unwind(|| crate::views::window::run(start)) {
        Ok(result) => result.map_err(|e| CliError::work("window", e.to_string()).with_help(help)),
        Err(_) => {
            Err(CliError::work("window", "it could not be opened; the reason stands above").with_help(help))
        }
    }
}

#[cfg(not(feature = "gui"))]
fn open(_: Start) -> Result<(), CliError> {
    Err(CliError::work("explore", "this program was built without its window")
        .with_help("build with the feature `gui`, which is on by default"))
}
