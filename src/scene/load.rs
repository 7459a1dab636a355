//! The front door: from a path or a generator's name to a scene.

use std::path::Path;

use super::text::read_file;
use super::{AnyScene, Progress, SceneError, flat, generate, gltf, obj, views};

/// Longest model file, bytes. Tables take up to about 14 times the file (a face of two bytes a corner).
pub(super) const MODEL_LIMIT_BYTES: u64 = 2 << 30;
/// Longest flatland scene or view file, bytes.
pub(super) const JSON_LIMIT_BYTES: u64 = 256 << 20;

/// When coordinates are moved to the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Recenter {
    /// Where the model is so far from its origin that 32-bit coordinates would lose detail.
    #[default]
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// What happens to a scene on its way in.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Merge points at the same place.
    pub weld: bool,
    /// Drop triangles without area (segments without length); they keep their ids.
    pub drop_degenerate: bool,
    /// Merge coplanar neighbors of one object and one material into convex polygons.
    pub merge_coplanar: bool,
    /// Move far-off coordinates to the origin.
    pub recenter: Recenter,
    /// Read the view paths beside the model: `NAME.views.json` and `NAME.walk.views.json`.
    pub read_views: bool,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { weld: true, drop_degenerate: true, merge_coplanar: false, recenter: Recenter::Auto, read_views: true }
    }
}

/// Loads a scene: a path to `.obj`, `.gltf`, `.glb` or a flatland `.json`, or `generate:NAME[?key=value&…]`.
///
/// # Errors
/// One sentence with the file and, where there is one, the line; [`SceneError::Cancelled`] if `progress` asks to stop.
pub fn load(source: &str, options: &LoadOptions, progress: &dyn Progress) -> Result<AnyScene, SceneError> {
    if let Some(call) = source.strip_prefix("generate:") {
        return super::Scene::new(generate::generate(call, options, progress)?).map(AnyScene::from);
    }
    let path = Path::new(source);
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let scene = match extension.as_str() {
        "obj" => obj::load(path, source, options, progress)?,
        "gltf" | "glb" => gltf::load(path, source, options, progress)?,
        "json" => return flat::read(&read_file(path, source, JSON_LIMIT_BYTES)?, source, options).map(AnyScene::from),
        _ => return Err(SceneError::Format { path: source.to_owned(), why: unknown_kind(path) }),
    };
    let mut parts = scene;
    if options.read_views {
        views::attach(path, &mut parts);
    }
    progress.report(1.0, "done");
    super::Scene::new(parts).map(AnyScene::from)
}

fn unknown_kind(path: &Path) -> String {
    let known = "a scene is a path to .obj, .gltf, .glb or .json (flatland), or generate:NAME";
    if path.is_dir() {
        return format!("is a folder; {known}");
    }
    if !path.exists() {
        return format!("no such file, and no kind of scene either; {known}");
    }
    format!("this kind of file cannot be read; {known}")
}

/// The last part of a path without its extension; of `NAME.flat.json` the `NAME`.
pub(super) fn stem(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    stem.strip_suffix(".flat").map(str::to_owned).unwrap_or(stem)
}
