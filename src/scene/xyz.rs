//! Molecules as lists of atoms, `.xyz` (the format of the program XMol): the number of atoms, a comment, and
//! a line an atom: symbol or atomic number, x, y and z in Å. What follows on such a line is not read.
//!
//! Of several frames in one file the first is read, and the others are counted. The first line that makes no
//! sense is an error. Cost: O(file).

use std::collections::BTreeMap;

use glam::DVec3;

use super::atoms::{Atom, Element, MOST_ATOMS, scene, too_many};
use super::report::counted;
use super::text::{Lines, is_decimal_comma, name_of, number, without_mark};
use super::{LoadOptions, Object, Parts, Progress, Report, SceneError};
use crate::geometry::Solid;

/// Atoms between two looks at the listener.
const ATOMS: usize = 16_384;

/// Reads a molecule.
pub(super) fn read(
    bytes: &[u8],
    name: &str,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let format = |why: &str| SceneError::Format { path: source.to_owned(), why: why.to_owned() };
    let fail = |line: usize, why: String| SceneError::Syntax { path: source.to_owned(), line, why };
    let text = without_mark(bytes).map_err(format)?;
    let mut lines = Lines::new(text);
    let Some((line, first)) = lines.plain() else { return Err(format("the file is empty")) };
    let Some(count) = whole(first) else {
        let first = name_of(&first[..first.len().min(24)]);
        return Err(fail(
            line,
            format!("`{}` is not the number of atoms, with which an XYZ file begins", first.trim()),
        ));
    };
    if count == 0 {
        return Err(fail(line, "there are no atoms: the number of atoms is 0".into()));
    }
    if count > MOST_ATOMS {
        return Err(too_many(source, line));
    }
    let mut last = lines.plain().map_or(line, |(line, _)| line);
    let mut atoms = Vec::new();
    let mut unknown = BTreeMap::new();
    for k in 0..count {
        let Some((line, written)) = lines.plain() else {
            let why = format!(
                "the file ends after {k} of {}, the number in its first line",
                counted(count, "atom")
            );
            return Err(fail(last, why));
        };
        last = line;
        let (element, place) = atom(written, &mut unknown).map_err(|why| fail(line, why))?;
        let object =
            Object { name: format!("{}_{}", element.symbol(), k + 1), group: String::new(), motion: None };
        atoms.push(Atom { element, place, object });
        if k % ATOMS == 0 {
            progress.report(0.5 * k as f32 / count as f32, "reading atoms");
            if progress.cancelled() {
                return Err(SceneError::Cancelled(source.to_owned()));
            }
        }
    }
    let report = rest(&mut lines, source);
    scene(atoms, &unknown, (name, source), options, report, progress)
}

fn whole(line: &[u8]) -> Option<usize> {
    std::str::from_utf8(line).ok()?.trim().parse().ok()
}

/// The atom of a line, or what is wrong with it.
fn atom(line: &[u8], unknown: &mut BTreeMap<String, usize>) -> Result<(Element, DVec3), String> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
    let Some(symbol) = words.next() else {
        return Err("an empty line stands where an atom should: symbol, x, y, z".into());
    };
    let mut place = DVec3::ZERO;
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let Some(word) = words.next() else {
            return Err(format!(
                "an atom has no {axis}; a line is a symbol, x, y and z, with spaces between"
            ));
        };
        place[k] = match number(word) {
            Some(value) if value.is_finite() => value,
            Some(_) => {
                return Err(format!("{axis} of an atom is not finite; give it a place or leave it out"));
            }
            None => {
                let point = if is_decimal_comma(word) { "; numbers have a point, not a comma" } else { "" };
                let word = name_of(&word[..word.len().min(24)]);
                return Err(format!("`{word}` is not a number, where {axis} of an atom should be{point}"));
            }
        };
    }
    let element = element(symbol);
    if element == Element(0) {
        *unknown.entry(name_of(&symbol[..symbol.len().min(8)])).or_default() += 1;
    }
    Ok((element, place))
}

/// An element by its atomic number, or by its symbol, after which a label may follow, as in `C12` or `H_a`.
fn element(word: &[u8]) -> Element {
    if let Some(number) = whole(word) {
        return if number <= 118 { Element(number as u8) } else { Element(0) };
    }
    let letters = word.iter().position(|b| !b.is_ascii_alphabetic()).unwrap_or(word.len());
    Element::of(&word[..letters]).unwrap_or_default()
}

/// What comes after the first frame.
fn rest(lines: &mut Lines, source: &str) -> Report {
    let mut report = Report::default();
    let (mut frames, mut skip) = (0, 0);
    while let Some((line, text)) = lines.plain() {
        if skip > 0 {
            skip -= 1;
        } else if let Some(count) = whole(text) {
            frames += 1;
            skip = count.saturating_add(1);
        } else if !text.trim_ascii().is_empty() {
            report.note(format!("{source}:{line}: what follows the atoms from here on is not read"));
            break;
        }
    }
    if frames > 0 {
        report
            .note(format!("{source}: {} left out: the first one is shown", counted(frames, "further frame")));
    }
    report
}
