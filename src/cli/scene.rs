//! `cullscope scene …`: what is in a scene, which generators there are, and conversion.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;

use super::methods::json_text;
use super::progress::Bar;
use super::view::paths;
use super::{CliError, World, convert, output, suggest};
use crate::geometry::{Vector, each};
use crate::scene::{
    AnyScene, LoadOptions, Recenter, Scene, SceneError, file_of, framing_view, generators, load,
};

/// What `cull` and `step` look at, and with what.
#[derive(clap::Args)]
pub(super) struct SceneArgs {
    /// A path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME[?key=value&…]
    #[arg(value_name = "SCENE")]
    scene: String,
    /// A method; `cullscope methods` lists them
    #[arg(long, short, value_name = "METHOD")]
    pub method: String,
    /// A parameter of the method; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl SceneArgs {
    /// Loads the scene.
    pub fn load(&self) -> Result<AnyScene, CliError> {
        open(&self.scene, &LoadOptions::default())
    }
}

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Print counts, bounds, groups, materials, memory, and what was dropped and why
    #[command(
        after_help = "Example:\n  cullscope scene info scenes3d/freedoom_e1m1/freedoom_e1m1.obj --json"
    )]
    Info {
        /// A path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME[?key=value&…]
        #[arg(value_name = "SCENE")]
        scene: String,
        /// Print JSON instead of text
        #[arg(long)]
        json: bool,
    },
    /// List the built-in generators
    #[command(after_help = "Example:\n  cullscope scene generators\n  cullscope scene info \
                      'generate:building?seed=7'")]
    Generators,
    /// Write a scene as OBJ with materials and views, or as a flatland JSON file; primitive ids stay
    #[command(
        after_help = "Example:\n  cullscope scene convert model.glb model.obj\n  cullscope scene convert \
                      survey.obj near-origin.obj --recenter always"
    )]
    Convert {
        /// What is read
        #[arg(value_name = "SCENE")]
        scene: String,
        /// What is written: .obj for a scene in space, .json for flatland
        #[arg(value_name = "OUT")]
        out: PathBuf,
        /// Whether coordinates are moved to the origin; `never` keeps those of the file
        #[arg(long, value_enum, default_value = "never")]
        recenter: Move,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Move {
    Always,
    Never,
}

pub(super) fn run(command: &Command) -> Result<(), CliError> {
    match command {
        Command::Info { scene, json } => {
            each!(open(scene, &LoadOptions::default())?, scene => info(&scene, *json))
        }
        Command::Generators => list_generators(),
        Command::Convert { scene, out, recenter } => {
            let recentered = *recenter == Move::Always;
            let recenter = if recentered { Recenter::Always } else { Recenter::Auto };
            convert::write(
                &open(scene, &LoadOptions { recenter, ..LoadOptions::default() })?,
                out,
                recentered,
            )
        }
    }
}

/// Loads a scene with a bar; what could not be found is answered with what is near.
pub(super) fn open(source: &str, options: &LoadOptions) -> Result<AnyScene, CliError> {
    let bar = Bar::new();
    load(source, options, &bar).map_err(|error| explained(source, error))
}

fn explained(source: &str, error: SceneError) -> CliError {
    if let Some(name) = source.strip_prefix("generate:") {
        let name = name.split('?').next().unwrap_or(name);
        let names: Vec<&str> = generators().iter().map(|g| g.name).collect();
        if matches!(error, SceneError::Cancelled(_)) {
            return CliError::Interrupted;
        }
        let text = error.to_string();
        let why = text.strip_prefix(source).and_then(|t| t.strip_prefix(": ")).unwrap_or(&text);
        let made = CliError::words(source, why);
        if !names.contains(&name) {
            return made.with_help(suggest::help(name, &names, "generators"));
        }
        return match near_word(source) {
            Some(near) => made.with_help(format!("did you mean `{near}`?")),
            None => made,
        };
    }
    let missing = matches!(&error, SceneError::Io { why, .. } if why.kind() == std::io::ErrorKind::NotFound)
        || !Path::new(file_of(source)).exists();
    let near = if missing { neighbor(Path::new(file_of(source))) } else { None };
    match near {
        Some(near) => CliError::work(source, "there is no such file").with_help(format!(
            "did you mean \
            `{near}`?"
        )),
        None if missing => CliError::work(source, "there is no such file").with_help(
            "a scene is a path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME (see \
                        `cullscope scene generators`)",
        ),
        None => error.into(),
    }
}

/// The word nearest to the first value in a generator's call that should be one and is none.
fn near_word(call: &str) -> Option<&'static str> {
    let (name, query) = call.strip_prefix("generate:")?.split_once('?')?;
    let params = generators().iter().find(|g| g.name == name)?.params;
    let near = |(key, value): (&str, &str)| {
        let words = params.iter().find(|p| p.name == key)?.words();
        if words.contains(&value) { None } else { suggest::nearest(value, words) }
    };
    query.split('&').filter_map(|pair| pair.split_once('=')).find_map(near)
}

/// The file in the same folder whose name is nearest.
fn neighbor(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|e| Some(e.ok()?.file_name().to_string_lossy().into_owned()));
    let names: BTreeSet<String> = names.take(10_000).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let near = suggest::nearest(&path.file_name()?.to_string_lossy(), &names)?;
    Some(path.with_file_name(near).display().to_string())
}

#[derive(Serialize)]
struct Info {
    cullscope: &'static str,
    scene: String,
    name: String,
    space: &'static str,
    triangles: usize,
    live: usize,
    dropped: BTreeMap<&'static str, usize>,
    points: usize,
    faces: usize,
    objects: usize,
    groups: Vec<String>,
    materials: usize,
    bounds: [Vec<f64>; 2],
    origin: [f64; 3],
    see_through: usize,
    two_sided: usize,
    moving_objects: usize,
    /// Of the longest motion.
    frames: usize,
    paths: Vec<PathInfo>,
    memory_bytes: usize,
    sha256: String,
    notes: Vec<String>,
    unsaid_notes: usize,
}

#[derive(Serialize)]
struct PathInfo {
    name: String,
    views: usize,
}

fn info<S: World>(scene: &Arc<Scene<S>>, json: bool) -> Result<(), CliError> {
    let corner = |v: S::Vector| {
        (0..S::Vector::AXES).map(|a| f64::from(v.get(a)) + scene.origin()[a]).collect::<Vec<_>>()
    };
    let groups: BTreeSet<String> =
        scene.objects().iter().map(|o| o.group.clone()).filter(|g| !g.is_empty()).collect();
    let info = Info {
        cullscope: env!("CARGO_PKG_VERSION"),
        scene: scene.source().to_owned(),
        name: scene.name().to_owned(),
        space: S::NAME,
        triangles: scene.prim_count(),
        live: scene.live().len(),
        dropped: scene.report().dropped.iter().map(|(why, n)| (why.label(), *n)).collect(),
        points: scene.points().len(),
        faces: scene.faces().len(),
        objects: scene.objects().len(),
        groups: groups.into_iter().collect(),
        materials: scene.materials().len(),
        bounds: [corner(scene.bounds().min), corner(scene.bounds().max)],
        origin: scene.origin().to_array(),
        see_through: scene.live().iter().filter(|p| scene.is_see_through(**p)).count(),
        two_sided: scene.live().iter().filter(|p| scene.is_two_sided(**p)).count(),
        moving_objects: scene.objects().iter().filter(|o| o.motion.is_some()).count(),
        frames: scene.frame_count(),
        paths: paths(scene, framing_view(&scene.bounds(), 1, 1))
            .iter()
            .map(|p| PathInfo { name: p.name.clone(), views: p.views.len() })
            .collect(),
        memory_bytes: scene.memory_bytes(),
        sha256: scene.hash_hex(),
        notes: scene.report().notes.clone(),
        unsaid_notes: scene.report().unsaid,
    };
    let text = if json { json_text(&info) } else { table::<S>(&info) };
    output::print(text.as_bytes())
}

fn table<S: World>(info: &Info) -> String {
    let mut text = String::new();
    let mut row = |key: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{key:<11}{value}");
    };
    let joined = |list: &[f64]| list.iter().map(|v| format!("{v:.4}")).collect::<Vec<_>>().join(", ");
    let listed = |list: &[String]| {
        if list.len() > 12 {
            format!(" ({}, …)", list[..12].join(", "))
        } else {
            format!(" ({})", list.join(", "))
        }
    };
    row("scene", format!("{} ({}, {})", info.scene, info.name, info.space));
    row(&format!("{}s", S::PRIM), format!("{} ({} live)", info.triangles, info.live));
    for (why, count) in &info.dropped {
        row("dropped", format!("{count} {why}"));
    }
    row("points", info.points.to_string());
    row("faces", format!("{} convex polygons", info.faces));
    let moving = match info.moving_objects {
        0 => "none moving".into(),
        n => format!("{n} moving, {} frames", info.frames),
    };
    row("objects", format!("{} ({moving})", info.objects));
    row(
        "groups",
        if info.groups.is_empty() {
            "0".into()
        } else {
            info.groups.len().to_string() + &listed(&info.groups)
        },
    );
    row("materials", info.materials.to_string());
    for (count, what) in [
        (info.see_through, "see-through: drawn, and hiding nothing"),
        (info.two_sided, "two-sided: they have no back"),
    ] {
        if count > 0 {
            row("surfaces", format!("{count} {}s {what}", S::PRIM));
        }
    }
    row("bounds", format!("[{}] to [{}]", joined(&info.bounds[0]), joined(&info.bounds[1])));
    if info.origin != [0.0; 3] {
        row("origin", format!("[{}] was subtracted", joined(&info.origin)));
    }
    for path in &info.paths {
        row("path", format!("{} ({} views)", path.name, path.views));
    }
    row("memory", format!("{:.1} MB", info.memory_bytes as f64 / 1e6));
    row("sha256", info.sha256.clone());
    for note in &info.notes {
        row("note", note.clone());
    }
    if info.unsaid_notes > 0 {
        row("note", format!("and {} more", info.unsaid_notes));
    }
    text
}

fn list_generators() -> Result<(), CliError> {
    let mut text = String::new();
    for g in generators() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "generate:{}: {}", g.name, g.meaning);
        for p in g.params {
            let range = match p.words() {
                [] => format!("{} to {}", p.min, p.max),
                words => words.join(", "),
            };
            let _ = writeln!(text, "    {}={}   {range}: {}", p.name, p.written(p.default), p.meaning);
        }
    }
    output::print(text.as_bytes())
}
