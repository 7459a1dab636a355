//! Colors out of Wavefront material files: `newmtl` and `Kd`, nothing else.
//!
//! Read by us because a library name may lead anywhere (`/dev/zero`, `../..`, a pipe): only regular
//! files inside the model's folder are opened. A missing file or material leaves the default gray and a note.

use std::collections::BTreeMap;
use std::path::Path;

use super::text::{Lines, beside, keyword, name_of, number, read_file, without_mark, words};
use super::{Material, Report};

/// Longest material file, bytes.
const LIMIT_BYTES: u64 = 64 << 20;
/// Most material files of one model that are opened.
const MAX_LIBRARIES: usize = 256;
/// The color of what has none.
pub(super) const GRAY: [f32; 3] = [0.7; 3];

/// The materials of these names, in order; the empty name is the default.
pub(super) fn resolve(
    names: &[String],
    libraries: &[(usize, String)],
    folder: Option<&Path>,
    report: &mut Report,
) -> Vec<Material> {
    let mut colors = BTreeMap::new();
    for (line, library) in libraries.iter().take(MAX_LIBRARIES) {
        if let Some(folder) = folder {
            read_library(folder, *line, library, &mut colors, report);
        }
    }
    if libraries.len() > MAX_LIBRARIES {
        report
            .note(format!("only the first {MAX_LIBRARIES} of {} material files were read", libraries.len()));
    }
    let mut missing = 0;
    let materials = names.iter().map(|name| match colors.get(name) {
        Some(color) => Material::new(name.clone(), *color),
        None if name.is_empty() => Material::new("default", GRAY),
        None => {
            missing += 1;
            if missing <= 8 {
                report.note(format!("material `{name}` is in no material file; it is gray"));
            }
            Material::new(name.clone(), GRAY)
        }
    });
    let materials = materials.collect();
    if missing > 8 {
        report.note(format!("{} more materials are in no material file; they are gray", missing - 8));
    }
    materials
}

/// A line names one file, or several with spaces between; a name may hold spaces itself.
fn read_library(
    folder: &Path,
    line: usize,
    names: &str,
    colors: &mut BTreeMap<String, [f32; 3]>,
    report: &mut Report,
) {
    let whole = beside(folder, names);
    let several: Vec<&str> = names.split_ascii_whitespace().collect();
    let names = if whole.is_ok() || several.len() < 2 { vec![names] } else { several };
    for name in names {
        let read = beside(folder, name)
            .and_then(|path| read_file(&path, name, LIMIT_BYTES).map_err(|e| e.to_string()));
        match read {
            Ok(bytes) => parse(&bytes, name, colors, report),
            Err(why) if why.starts_with(name) => report.note(format!("line {line}: material file {why}")),
            Err(why) => report.note(format!("line {line}: material file {name}: {why}")),
        }
    }
}

/// Reads the colors of a material file. The first definition of a name counts.
pub(super) fn parse(bytes: &[u8], file: &str, colors: &mut BTreeMap<String, [f32; 3]>, report: &mut Report) {
    let text = match without_mark(bytes) {
        Ok(text) => text,
        Err(why) => return report.note(format!("{file}: {why}")),
    };
    let mut current: Option<String> = None;
    for (line, statement) in Lines::new(text) {
        match keyword(&statement) {
            (b"newmtl", rest) => {
                let name = name_of(rest);
                if colors.contains_key(&name) {
                    report
                        .note(format!("{file}:{line}: material `{name}` is defined twice; the first counts"));
                    current = None;
                } else {
                    colors.insert(name.clone(), GRAY);
                    current = Some(name);
                }
            }
            (b"Kd", rest) => {
                let (Some(name), color) = (&current, color(rest)) else { continue };
                match color {
                    Some(color) => {
                        colors.insert(name.clone(), color);
                    }
                    None => report
                        .note(format!("{file}:{line}: `Kd` of `{name}` is not three numbers; it is gray")),
                }
            }
            _ => {}
        }
    }
}

/// `Kd r [g b]`: one number means gray (the format says so). Clamped to 0..1.
fn color(rest: &[u8]) -> Option<[f32; 3]> {
    let mut numbers = words(rest).map(number);
    let r = numbers.next()??;
    let (g, b) = match (numbers.next(), numbers.next()) {
        (None, _) => (r, r),
        (Some(g), Some(b)) => (g?, b?),
        _ => return None,
    };
    [r, g, b].iter().all(|c| c.is_finite()).then(|| [r, g, b].map(|c| c.clamp(0.0, 1.0) as f32))
}
