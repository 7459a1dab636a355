//! Opening a scene with its views, and the examples that are one click away.

use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use crate::drawing::words::capitalized;
use crate::geometry::{Either, Flat, Solid, ViewPath, each};
use crate::scene::{self, AnyScene, LoadOptions, Progress, Scene, SceneError};

/// A scene that the start screen offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Example {
    /// What it is called.
    pub title: String,
    /// What can be seen in it.
    pub summary: String,
    /// What to load.
    pub source: String,
}

/// A scene, and the views that were named with it.
pub type Opened<S> = (Arc<Scene<S>>, Option<ViewPath<S>>);
/// The same of either space.
pub type AnyOpened = Either<Opened<Flat>, Opened<Solid>>;

/// A scene to load, as a person or a session names it.
#[derive(Clone, Debug, Default)]
pub(super) struct Wanted {
    /// A path, `generate:NAME`, or the name of a scene that travels inside.
    pub(super) source: String,
    /// The hash that it must have, to be found again where its path leads nowhere; empty if any will do.
    pub(super) hash_hex: String,
    /// The folder from which its path leads.
    pub(super) folder: PathBuf,
}

impl Wanted {
    /// A source as it is typed.
    pub(super) fn named(source: &str) -> Self {
        Self { source: source.to_owned(), ..Self::default() }
    }
    /// The files that may be it, the likeliest first: where the path leads from the session's folder and from
    /// the working folder, then files of its name in and above the session's folder.
    fn places(&self) -> Vec<PathBuf> {
        let file = scene::file_of(&self.source);
        let (path, name) = (Path::new(file), file_name(file));
        let here = self.folder.canonicalize().unwrap_or_else(|_| self.folder.clone());
        let mut places = vec![self.folder.join(path), path.to_owned(), self.folder.join(&name)];
        // A path that leads up and down again: its last part may lie somewhere above.
        let inner: PathBuf = path.components().filter(|c| matches!(c, Component::Normal(_))).collect();
        places.extend(here.ancestors().take(ABOVE).map(|above| above.join(&inner)));
        places.extend(entries(&self.folder_or_dot()).into_iter().map(|inner| inner.join(&name)));
        places.retain(|p| p.is_file());
        let mut seen = std::collections::BTreeSet::new();
        places.retain(|p| seen.insert(p.canonicalize().unwrap_or_else(|_| p.clone())));
        places
    }
    /// Files beside the session that have another name and perhaps its content.
    fn namesakes(&self) -> Vec<PathBuf> {
        let ending = Path::new(scene::file_of(&self.source)).extension();
        let mut files: Vec<_> = entries(&self.folder_or_dot())
            .into_iter()
            .filter(|p| p.is_file() && is_scene(p) && p.extension() == ending)
            .collect();
        files.sort();
        files.truncate(NAMESAKES);
        files
    }
    fn folder_or_dot(&self) -> PathBuf {
        if self.folder.as_os_str().is_empty() { PathBuf::from(".") } else { self.folder.clone() }
    }
}

/// Files that are read to find a scene by its content.
const NAMESAKES: usize = 12;

/// The last part of a path.
pub(super) fn file_name(source: &str) -> String {
    Path::new(source).file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A scene's source as it is found from `folder`: a file by the way from there, without a folder by its whole
/// path; what is no file as it is.
pub(super) fn named_from(source: &str, folder: Option<&Path>) -> String {
    let (path, choice) = source.split_at(scene::file_of(source).len());
    let Some(file) = Path::new(path).canonicalize().ok().filter(|p| p.is_file()) else {
        return source.to_owned();
    };
    let whole = || file.to_string_lossy().into_owned() + choice;
    let Some(folder) = folder else { return whole() };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(folder) = folder.canonicalize() else { return whole() };
    let common = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return whole();
    }
    let up = folder.components().skip(common).map(|_| "..".to_owned());
    let down = file.components().skip(common).map(|c| c.as_os_str().to_string_lossy().into_owned());
    // With the separator that every system reads.
    up.chain(down).collect::<Vec<_>>().join("/") + choice
}

/// Loads a scene and, if named, a view file. The error is one line.
pub(super) fn load(
    wanted: &Wanted,
    views: Option<&str>,
    progress: &dyn Progress,
) -> Result<AnyOpened, String> {
    Ok(each!(find(wanted, progress)?, scene => Either({
        let path = views.map(|v| scene::read_views(v, scene.origin())).transpose();
        (scene, path.map_err(|e| e.to_string())?)
    })))
}

/// The scene that is wanted: the first with its hash, else the first where its path leads.
fn find(wanted: &Wanted, progress: &dyn Progress) -> Result<AnyScene, String> {
    let read = |source: &str| scene::load(source, &LoadOptions::default(), progress);
    let is_it = |scene: &AnyScene| each!(scene, s => s.hash_hex()) == wanted.hash_hex;
    if wanted.hash_hex.is_empty() {
        let source = wanted.source.as_str();
        return read(source).or_else(|error| inside(source, error)).map_err(|e| e.to_string());
    }
    // A path from the working folder is what one would type.
    let choice = &wanted.source[scene::file_of(&wanted.source).len()..];
    let typed = |place: &Path| named_from(&place.to_string_lossy(), Some(Path::new(""))) + choice;
    let (mut first, mut failed) = (None, None);
    for place in wanted.places() {
        match read(&typed(&place)) {
            Ok(scene) if is_it(&scene) => return Ok(scene),
            Ok(scene) => first = first.or(Some(scene)),
            Err(error) => failed = failed.or(Some(error)),
        }
    }
    if first.is_none()
        && let Ok(scene) = read(&wanted.source).or_else(|error| inside(&wanted.source, error))
    {
        return Ok(scene);
    }
    let by_content = || wanted.namesakes().iter().filter_map(|p| read(&typed(p)).ok()).find(is_it);
    match (first, failed) {
        (first, None) => by_content().or(first).ok_or_else(|| {
            format!(
                "{}: the scene of this session was not found, neither there nor by its content in {}",
                wanted.source,
                wanted.folder_or_dot().display()
            )
        }),
        (Some(first), _) => Ok(by_content().unwrap_or(first)),
        (None, Some(error)) => by_content().ok_or_else(|| error.to_string()),
    }
}

/// The scene that travels inside the program, where the file of its name is not there.
fn inside(source: &str, error: SceneError) -> Result<AnyScene, SceneError> {
    if Path::new(source).exists() {
        return Err(error);
    }
    let name = Path::new(source).file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let name = name.trim_end_matches(".json").trim_end_matches(".flat");
    scene::example(name).map(AnyScene::Flat).map_err(|_| error)
}

/// Folders of examples, looked for in the working folder and above the program.
const FOLDERS: [&str; 2] = ["scenes2d", "scenes3d"];
/// How far above the program folders are looked for: `target/release/cullscope` lies three deep.
const ABOVE: usize = 4;
/// Longest description that is read, bytes.
const DESCRIPTION_BYTES: u64 = 4 << 20;

/// What the start screen offers: the scenes in the examples' folders, then the generators.
pub fn examples() -> Vec<Example> {
    let mut list: Vec<Example> = FOLDERS.iter().flat_map(|f| folder(f)).collect();
    if list.is_empty() {
        list.push(Example {
            title: "Freedoom E1M1".into(),
            summary: "A game level in flatland, seen from above.".into(),
            source: "scenes2d/freedoom_e1m1/freedoom_e1m1.flat.json".into(),
        });
    }
    list.extend(scene::generators().iter().map(|g| Example {
        title: title(g.name),
        summary: g.meaning.to_owned(),
        source: format!("generate:{}", g.name),
    }));
    list
}

/// Scenes in a folder of examples and one level below.
fn folder(name: &str) -> Vec<Example> {
    let here = [PathBuf::from(name)];
    let program = std::env::current_exe().unwrap_or_default();
    let above = program.ancestors().skip(1).take(ABOVE).map(|p| p.join(name)).collect::<Vec<_>>();
    let Some(root) = here.into_iter().chain(above).find(|p| p.is_dir()) else { return vec![] };
    let inner = entries(&root).into_iter().filter(|p| p.is_dir()).flat_map(|p| entries(&p));
    let mut files: Vec<PathBuf> = entries(&root).into_iter().chain(inner).filter(|p| is_scene(p)).collect();
    files.sort();
    files.iter().map(|p| example(p)).collect()
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).map(|d| d.flatten().map(|e| e.path()).collect()).unwrap_or_default()
}

fn is_scene(path: &Path) -> bool {
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let is_model = [".obj", ".gltf", ".glb", ".pdb", ".xyz"].iter().any(|e| name.ends_with(e));
    is_model
        || (name.ends_with(".json") && !name.ends_with(".views.json") && !name.ends_with(".session.json"))
}

fn example(path: &Path) -> Example {
    let source = path.to_string_lossy().into_owned();
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = stem.trim_end_matches(".flat").to_owned();
    let is_flat = source.ends_with(".json");
    let space = if is_flat { "Flatland" } else { "Space" };
    let (mut name, mut summary) = (title(&stem), format!("{space}."));
    if is_flat && std::fs::metadata(path).is_ok_and(|m| m.is_file() && m.len() < DESCRIPTION_BYTES) {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let file: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        let word =
            |key: &str| file.get(key).and_then(|v| v.as_str()).filter(|t| !t.is_empty()).map(str::to_owned);
        name = word("title").unwrap_or(name);
        summary = word("teaches").unwrap_or(summary);
    } else if let Some(line) = path.parent().and_then(|p| std::fs::read_to_string(p.join("SOURCE.txt")).ok())
    {
        let about = line
            .lines()
            .map(str::trim)
            .find(|l| !l.is_empty() && !l.starts_with("Name:"))
            .unwrap_or_default();
        let about = about.split_once(": ").map_or(about, |(_, rest)| rest);
        summary = format!("{space}. {}", about.split([',', ';', '(']).next().unwrap_or_default().trim());
    }
    Example { title: name, summary, source }
}

/// `freedoom_e1m1` as `Freedoom e1m1`.
fn title(stem: &str) -> String {
    capitalized(&stem.replace(['_', '-'], " "))
}
