//! The front door: from a path or a generator's name to a scene.

use std::path::Path;
use std::sync::Arc;

use super::source::{JSON_LIMIT_BYTES, LoadOptions, MODEL_LIMIT_BYTES, MOLECULE_LIMIT_BYTES, stem};
use super::text::{read_file, stand_in};
use super::{AnyScene, Progress, Scene, SceneError, flat, generate, gltf, obj, pdb, views, xyz};

/// Loads a scene: a path to `.obj`, `.gltf`, `.glb`, a molecule (`.pdb`, `.xyz`) or a flatland `.json`, or
/// `generate:NAME[?key=value&…]`.
/// Of several scenes in a glTF file `PATH?scene=NUMBER` chooses one.
///
/// # Errors
/// One sentence with the file and, where there is one, the line; [`SceneError::Cancelled`] if `progress` asks
/// to stop.
pub fn load(source: &str, options: &LoadOptions, progress: &dyn Progress) -> Result<AnyScene, SceneError> {
    if let Some(call) = source.strip_prefix("generate:") {
        return generate::scene(call, options, progress);
    }
    let path = Path::new(file_of(source));
    let Some(kind) = kind_of(source) else {
        return Err(SceneError::Format { path: source.to_owned(), why: unknown_kind(path) });
    };
    progress.report(0.0, "reading");
    let bytes = read_file(path, source, kind.limit_bytes())?;
    let mut scene =
        read(kind, &bytes, Some(path.parent().unwrap_or(Path::new(""))), source, options, progress)?;
    if let (AnyScene::Solid(solid), true) = (&mut scene, options.read_views) {
        let mut found = Vec::new();
        let mut notes = Vec::new();
        views::beside_model(path, solid.origin(), &mut found, &mut notes);
        if !(found.is_empty() && notes.is_empty()) {
            Arc::make_mut(solid).extend(found, notes);
        }
    }
    progress.report(1.0, "done");
    Ok(scene)
}

/// Loads a scene out of memory, such as a file that was dropped on a window. `source` is named in errors, and
/// its extension says what the bytes are. No file is opened: materials and buffers beside it are not there.
///
/// # Errors
/// As [`load`].
pub fn load_bytes(
    bytes: &[u8],
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<AnyScene, SceneError> {
    let format = |why: &str| SceneError::Format { path: source.to_owned(), why: why.into() };
    match kind_of(source) {
        Some(_) if let Some(why) = stand_in(bytes) => Err(format(why)),
        Some(kind) => read(kind, bytes, None, source, options, progress),
        None => Err(SceneError::Format { path: source.to_owned(), why: unread() }),
    }
}

/// What can be read.
const KNOWN: &str =
    "a scene is a path to .obj, .gltf, .glb, .pdb, .xyz or .json (flatland), or generate:NAME";

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Obj,
    Gltf,
    Pdb,
    Xyz,
    Flat,
}

impl Kind {
    fn limit_bytes(self) -> u64 {
        match self {
            Self::Obj | Self::Gltf => MODEL_LIMIT_BYTES,
            Self::Pdb | Self::Xyz => MOLECULE_LIMIT_BYTES,
            Self::Flat => JSON_LIMIT_BYTES,
        }
    }
}

/// The file that a source names: what is before `?scene=`.
pub fn file_of(source: &str) -> &str {
    match source.rsplit_once("?scene=") {
        Some((file, number)) if !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()) => file,
        _ => source,
    }
}

fn kind_of(source: &str) -> Option<Kind> {
    let extension = Path::new(file_of(source)).extension()?.to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "obj" => Some(Kind::Obj),
        "gltf" | "glb" => Some(Kind::Gltf),
        "pdb" => Some(Kind::Pdb),
        "xyz" => Some(Kind::Xyz),
        "json" => Some(Kind::Flat),
        _ => None,
    }
}

fn read(
    kind: Kind,
    bytes: &[u8],
    folder: Option<&Path>,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<AnyScene, SceneError> {
    let file = file_of(source);
    let name = stem(Path::new(file));
    // A number beyond all numbers is no scene either.
    let scene = source.strip_prefix(file).and_then(|rest| rest.strip_prefix("?scene="));
    let scene = scene.map(|number| number.parse().unwrap_or(usize::MAX));
    let parts = match kind {
        Kind::Flat => return flat::read(bytes, source, options).map(AnyScene::from),
        Kind::Obj => obj::read(bytes, folder, &name, source, options, progress)?,
        Kind::Gltf => gltf::read(bytes, folder, &name, source, scene, options, progress)?,
        Kind::Pdb => pdb::read(bytes, &name, source, options, progress)?,
        Kind::Xyz => xyz::read(bytes, &name, source, options, progress)?,
    };
    Scene::new(parts).map(AnyScene::from)
}

fn unknown_kind(path: &Path) -> String {
    if path.is_dir() {
        return format!("is a folder; {KNOWN}");
    }
    if !path.exists() {
        return format!("no such file, and no kind of scene either; {KNOWN}");
    }
    unread()
}

/// Why a file of this name is not read.
fn unread() -> String {
    format!("this kind of file cannot be read; {KNOWN}")
}
