//! Wavefront material files: the color of a material (`Kd`), and whether it is see-through.
//!
//! See-through is what the common readers take for it: `d` below 1 (also `d -halo`), else `Tr` above 0 (it is
//! 1 − `d`; where both stand `d` counts, as in tinyobjloader), or a mask `map_d`. `illum` 4, 6, 7 and 9,
//! which the format calls glass, and the filter `Tf` decide nothing: Maya writes `illum 4` and `Tf 1 1 1` for
//! opaque materials. Keywords count in any letter case. Textures and the rest of the format are told, not
//! read.
//!
//! Read by us because a library name may lead anywhere (`/dev/zero`, `../..`, a pipe): only regular
//! files inside the model's folder are opened. A name that leads elsewhere is looked for there by its last
//! part. A missing file or material leaves the default gray and a note.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::text::{
    Lines, beside, inside, is_decimal_comma, keyword, name_of, number, read_file, without_mark, words,
};
use super::{Material, Report};

/// Longest material file, bytes.
const LIMIT_BYTES: u64 = 64 << 20;
/// Most material files of one model that are opened.
const MAX_LIBRARIES: usize = 256;
/// Most names in a folder among which a file is looked for in other letter case.
const MAX_NAMES: usize = 100_000;
/// The color of what has none.
pub(super) const GRAY: [f32; 3] = [0.7; 3];

/// What the material files say of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Entry {
    /// `Kd`.
    color: Option<[f32; 3]>,
    /// `d`: 1 is opaque.
    dissolve: Option<f64>,
    /// `Tr`: 0 is opaque.
    transparency: Option<f64>,
    /// `map_d`.
    mask: bool,
    /// `map_Kd`.
    texture: bool,
    /// `illum` 4, 6, 7 or 9.
    glass: bool,
}

/// What names a material's library: the model's folder, and the model's own short name.
#[derive(Clone, Copy)]
pub(super) struct Home<'a> {
    pub(super) folder: &'a Path,
    pub(super) model: &'a str,
}

/// The materials of these names as the model spells them, in order; the empty name is the default. Names that
/// differ in any byte are different materials, even if they look alike. `libraries`: line and name.
pub(super) fn resolve(
    names: &[Vec<u8>],
    libraries: &[(usize, String)],
    home: Option<Home>,
    report: &mut Report,
) -> Vec<Material> {
    let mut shelf = Shelf { entries: BTreeMap::new(), unused: BTreeMap::new(), files: 0, report };
    if let Some(home) = home {
        for (line, library) in libraries.iter().take(MAX_LIBRARIES) {
            shelf.read_line(home, *line, library);
        }
        if shelf.files == 0 && names.iter().any(|n| !n.is_empty()) {
            shelf.read_pair(home);
        }
    }
    if libraries.len() > MAX_LIBRARIES {
        let all = libraries.len();
        shelf.report.note(format!("only the first {MAX_LIBRARIES} of {all} material files were read"));
    }
    let materials = names.iter().map(|name| shelf.material(name)).collect();
    shelf.tell_unused();
    materials
}

/// All that the material files of a model say.
struct Shelf<'a> {
    entries: BTreeMap<Vec<u8>, Entry>,
    /// Keywords that are not used, and how often they stand there.
    unused: BTreeMap<String, usize>,
    /// Files that were read.
    files: usize,
    report: &'a mut Report,
}

impl Shelf<'_> {
    fn material(&mut self, name: &[u8]) -> Material {
        if name.is_empty() {
            return Material::new("default", GRAY);
        }
        let shown = name_of(name);
        let place = format!("`{shown}`");
        let Some(entry) = self.entries.get(name).copied() else {
            self.report.note_each("mtl: missing", &place, || {
                format!("material {place} is in no material file; it is gray")
            });
            return Material::new(shown, GRAY);
        };
        let mut say = |kind: &'static str, what: &str| {
            self.report.note_each(kind, &place, || format!("material {place}: {what}"));
        };
        match (entry.color, entry.texture) {
            (Some(_), true) => {
                say("mtl: textured", "its texture (`map_Kd`) is not read; it has the color of its `Kd`");
            }
            (None, true) => {
                say("mtl: texture alone", "its texture (`map_Kd`) is not read; without `Kd` it is gray");
            }
            (None, false) => say("mtl: no color", "it has no `Kd`; it is gray"),
            (Some(_), false) => {}
        }
        let opaque = match (entry.dissolve, entry.transparency) {
            (Some(d), Some(tr)) if (d < 1.0) != (tr > 0.0) => {
                say("mtl: both", "`d` and `Tr` contradict each other; `d` counts");
                d >= 1.0
            }
            (Some(d), _) => d >= 1.0,
            (None, Some(tr)) => tr <= 0.0,
            (None, None) => true,
        };
        let see_through = entry.mask || !opaque;
        if entry.glass && !see_through {
            say("mtl: glass", "`illum` says that it is glass, no `d`, `Tr` or `map_d` does; it is opaque");
        }
        Material { see_through, ..Material::new(shown, entry.color.unwrap_or(GRAY)) }
    }

    /// A line names one file, or several with spaces between; a name may hold spaces itself.
    fn read_line(&mut self, home: Home, line: usize, text: &str) {
        let several: Vec<&str> = text.split_ascii_whitespace().take_while(|w| !w.starts_with('#')).collect();
        let is_mtl = |w: &&str| w.to_ascii_lowercase().ends_with(".mtl");
        let whole = beside(home.folder, text).is_ok()
            || several.len() < 2
            || (!several.iter().all(is_mtl) && ways(home.folder, text).is_some());
        for name in if whole { vec![text] } else { several } {
            let bytes = match beside(home.folder, name) {
                Ok(path) => read_file(&path, name, LIMIT_BYTES),
                Err(why) => match ways(home.folder, name) {
                    Some((path, found)) => {
                        self.report.note_each("mtl: elsewhere", format_args!("line {line}: {name}"), || {
                            format!("line {line}: material file {name}: `{found}` beside the model was read")
                        });
                        read_file(&path, name, LIMIT_BYTES)
                    }
                    None => {
                        self.missing(line, format!("{name}: {why}"));
                        continue;
                    }
                },
            };
            match bytes {
                Ok(bytes) => self.parse(&bytes, name),
                Err(why) => self.missing(line, why.to_string()),
            }
        }
    }

    fn missing(&mut self, line: usize, why: String) {
        let place = format!("line {line}");
        self.report.note_each("mtl: no file", &place, || format!("{place}: material file {why}"));
    }

    /// The file that has the model's own name, if both were renamed together.
    fn read_pair(&mut self, home: Home) {
        let Some((path, found)) = ways(home.folder, &format!("{}.mtl", home.model)) else { return };
        if let Ok(bytes) = read_file(&path, &found, LIMIT_BYTES) {
            self.report.note(format!("materials were read from `{found}`, which has the model's name"));
            self.parse(&bytes, &found);
        }
    }

    /// Reads a material file. The first definition of a name counts.
    fn parse(&mut self, bytes: &[u8], file: &str) {
        self.files += 1;
        let text = match without_mark(bytes) {
            Ok(text) => text,
            Err(why) => return self.report.note(format!("{file}: {why}")),
        };
        let mut name: Vec<u8> = Vec::new();
        let mut current: Option<Entry> = None;
        for (line, statement) in Lines::new(text) {
            let (key, rest) = keyword(&statement);
            if key.eq_ignore_ascii_case(b"newmtl") {
                self.close(&mut name, &mut current);
                name.extend_from_slice(rest);
                if self.entries.contains_key(&name) {
                    let place = format!("{file}:{line}");
                    self.report.note_each("mtl: twice", &place, || {
                        format!("{place}: material `{}` is defined twice; the first counts", name_of(&name))
                    });
                } else {
                    current = Some(Entry::default());
                }
            } else if let Some(entry) = &mut current
                && let Err(why) = entry.set(key, rest, &mut self.unused)
            {
                let (place, key) = (format!("{file}:{line}"), name_of(key));
                self.report.note_each("mtl: number", &place, || {
                    format!("{place}: `{key}` of `{}` {why}, so it does not count", name_of(&name))
                });
            }
        }
        self.close(&mut name, &mut current);
    }

    fn close(&mut self, name: &mut Vec<u8>, current: &mut Option<Entry>) {
        let name = std::mem::take(name);
        if let Some(entry) = current.take() {
            self.entries.insert(name, entry);
        }
    }

    fn tell_unused(&mut self) {
        if self.unused.is_empty() {
            return;
        }
        let told = self.unused.iter().take(24).map(|(key, count)| format!("`{key}` ({count})"));
        let told = told.collect::<Vec<_>>().join(", ");
        let more = if self.unused.len() > 24 { ", …" } else { "" };
        self.report.note(format!("not used of material files, with how often it stands there: {told}{more}"));
    }
}

impl Entry {
    /// Takes what a statement says; what is wrong with it, if anything.
    fn set(
        &mut self,
        key: &[u8],
        rest: &[u8],
        unused: &mut BTreeMap<String, usize>,
    ) -> Result<(), &'static str> {
        let first = || words(rest).find(|w| !w.starts_with(b"-halo")).ok_or("has no number");
        match key.to_ascii_lowercase().as_slice() {
            b"kd" => self.color = Some(color(rest)?),
            b"d" => self.dissolve = Some(finite(first()?)?),
            b"tr" => self.transparency = Some(finite(first()?)?),
            b"map_d" => self.mask = !rest.is_empty(),
            b"map_kd" => self.texture = !rest.is_empty(),
            b"illum" => {
                self.glass = first().is_ok_and(|w| matches!(w, b"4" | b"6" | b"7" | b"9"));
            }
            b"" | [b'#', ..] => {}
            _ => *unused.entry(name_of(&key[..key.len().min(24)])).or_default() += 1,
        }
        Ok(())
    }
}

/// `Kd r [g b]`: one number means gray (the format says so). Clamped to 0..1.
fn color(rest: &[u8]) -> Result<[f32; 3], &'static str> {
    let mut numbers = words(rest).map(finite);
    let r = numbers.next().ok_or("is not three numbers")??;
    let (g, b) = match (numbers.next(), numbers.next()) {
        (None, _) => (r, r),
        (Some(g), Some(b)) => (g?, b?),
        _ => return Err("is not three numbers"),
    };
    Ok([r, g, b].map(|c| c.clamp(0.0, 1.0) as f32))
}

fn finite(word: &[u8]) -> Result<f64, &'static str> {
    match number(word) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err("is not finite"),
        None if is_decimal_comma(word) => Err("has a comma where a number has its point"),
        None => Err("is not made of numbers"),
    }
}

/// The file in the model's folder that a name may mean which names none as it stands, and how it is called
/// there: without quotes or a comment, by the last part of its path, in other letter case.
fn ways(folder: &Path, name: &str) -> Option<(PathBuf, String)> {
    let bare = name.find(" #").map_or(name, |at| &name[..at]);
    let bare = bare.trim().trim_matches(['"', '\'']);
    let last = bare.rsplit(['/', '\\']).next().unwrap_or(bare).trim();
    if last.is_empty() {
        return None;
    }
    let mut tries = [bare, last].into_iter();
    if let Some(found) = tries.find_map(|t| Some((beside(folder, t).ok()?, t.to_owned()))) {
        return found.0.is_file().then_some(found);
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let names = fs::read_dir(here).ok()?.take(MAX_NAMES).filter_map(|entry| Some(entry.ok()?.file_name()));
    let mut alike: Vec<_> =
        names.filter(|n| n.to_string_lossy().to_lowercase() == last.to_lowercase()).collect();
    alike.sort();
    let found = alike.first()?;
    Some((inside(folder, Path::new(found)).ok()?, found.to_string_lossy().into_owned()))
}
