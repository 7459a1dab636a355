//! Molecules of the Protein Data Bank, `.pdb` (wwPDB, "Protein Data Bank Contents Guide: Atomic Coordinate
//! Entry Format Description", version 3.3, coordinate section).
//!
//! Fixed columns: of `ATOM` and `HETATM` 13–16 name, 17 alternate position, 18–20 residue, 22 chain, 23–27
//! number, 31–54 x, y and z in Å, 77–78 element. Read are the first model and, of each residue that has
//! alternates, the position that comes first; waters are atoms as any, in a group of their own. What is left
//! out is said. The first record that makes no sense is an error. Cost: O(file).

use std::collections::BTreeMap;

use glam::DVec3;

use super::atoms::{Atom, Element, MOST_ATOMS, scene, too_many};
use super::report::counted;
use super::text::{Lines, name_of, number, without_mark};
use super::{LoadOptions, Object, Parts, Progress, Report, SceneError};
use crate::geometry::Solid;

/// Residues that are water, as programs name it.
const WATERS: [&[u8]; 7] = [b"HOH", b"WAT", b"H2O", b"DOD", b"TIP", b"TP3", b"SOL"];
/// Elements that an atom of a chain has whose name begins with such a letter.
const OF_CHAINS: &[u8] = b"CHNOPS";
/// Lines between two looks at the listener.
const LINES: usize = 16_384;

/// Reads a molecule.
pub(super) fn read(
    bytes: &[u8],
    name: &str,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let format = |why: String| SceneError::Format { path: source.to_owned(), why };
    let text = without_mark(bytes).map_err(|why| format(why.into()))?;
    let mut pass = Pass { source, ..Pass::default() };
    let mut lines = Lines::new(text);
    let whole = text.len().max(1) as f32;
    while let Some((line, record)) = lines.plain() {
        pass.record(line, record)?;
        if line % LINES == 0 {
            progress.report((1.0 - lines.left_bytes() as f32 / whole) * 0.5, "reading atoms");
            if progress.cancelled() {
                return Err(SceneError::Cancelled(source.to_owned()));
            }
        }
    }
    if pass.atoms.is_empty() {
        return Err(format(why_empty(text).into()));
    }
    let report = pass.told();
    scene(pass.atoms, &pass.unknown, (name, source), options, report, progress)
}

/// A residue: its chain, number and insertion code.
type Residue = (u8, [u8; 5]);

#[derive(Default)]
struct Pass<'a> {
    source: &'a str,
    atoms: Vec<Atom>,
    /// Which alternate position is taken of a residue that has any.
    taken: BTreeMap<Residue, u8>,
    alternates: usize,
    waters: usize,
    /// Atoms whose element was told by their name.
    by_name: usize,
    unknown: BTreeMap<String, usize>,
    models: usize,
    /// Whether the first model has ended.
    ended: bool,
    /// Atoms after that.
    later: usize,
}

impl Pass<'_> {
    fn record(&mut self, line: usize, record: &[u8]) -> Result<(), SceneError> {
        match columns(record, 1, 6).trim_ascii() {
            b"ATOM" | b"HETATM" if self.ended => self.later += 1,
            b"ATOM" | b"HETATM" => return self.atom(line, record),
            b"MODEL" => {
                self.models += 1;
                self.ended |= self.models > 1;
            }
            b"ENDMDL" | b"END" => self.ended |= !self.atoms.is_empty(),
            _ => {}
        }
        Ok(())
    }

    fn atom(&mut self, line: usize, record: &[u8]) -> Result<(), SceneError> {
        let residue: Residue = (byte(record, 22), std::array::from_fn(|k| byte(record, 23 + k)));
        let alternate = byte(record, 17);
        if alternate != b' ' && *self.taken.entry(residue).or_insert(alternate) != alternate {
            self.alternates += 1;
            return Ok(());
        }
        if self.atoms.len() == MOST_ATOMS {
            return Err(too_many(self.source, line));
        }
        let place = self.place(line, record)?;
        let element = self.element(record);
        let of = columns(record, 18, 20).trim_ascii();
        let is_water = WATERS.contains(&of);
        self.waters += usize::from(is_water);
        let chain = residue.0;
        let group = match () {
            _ if is_water => "water".to_owned(),
            _ if chain == b' ' => String::new(),
            _ => format!("chain {}", name_of(&[chain])),
        };
        let words = [columns(record, 13, 16), of, &residue.1].map(|w| name_of(w.trim_ascii()));
        self.atoms.push(Atom {
            element,
            place,
            object: Object { name: words.join(" "), group, motion: None },
        });
        Ok(())
    }

    fn place(&self, line: usize, record: &[u8]) -> Result<DVec3, SceneError> {
        let fail = |why: String| Err(SceneError::Syntax { path: self.source.to_owned(), line, why });
        let mut place = DVec3::ZERO;
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let (first, last) = (31 + 8 * k, 38 + 8 * k);
            let word = columns(record, first, last).trim_ascii();
            place[k] = match number(word) {
                Some(value) if value.is_finite() => value,
                Some(_) => {
                    return fail(format!("{axis} of an atom is not finite; give it a place or leave it out"));
                }
                None if word.is_empty() => {
                    return fail(format!(
                        "an atom has no {axis}, which stands in columns {first} to {last}; the columns of a \
                         PDB file are fixed, with spaces and no tabs"
                    ));
                }
                None => {
                    let word = name_of(word);
                    return fail(format!(
                        "`{word}` is not a number; columns {first} to {last} hold {axis} of an atom, and the \
                         columns of a PDB file are fixed"
                    ));
                }
            };
        }
        Ok(place)
    }

    /// The element of columns 77–78, or that of the atom's name.
    fn element(&mut self, record: &[u8]) -> Element {
        if let Some(element) = Element::of(columns(record, 77, 78).trim_ascii()) {
            return element;
        }
        let name = columns(record, 13, 16);
        let found = named(name, record.starts_with(b"HETATM"));
        if found.is_some() {
            self.by_name += 1;
        } else {
            let written = [columns(record, 77, 78), name].into_iter().map(<[u8]>::trim_ascii);
            let written = written.into_iter().find(|w| !w.is_empty()).unwrap_or_default();
            *self.unknown.entry(name_of(written)).or_default() += 1;
        }
        found.unwrap_or_default()
    }

    fn told(&self) -> Report {
        let mut report = Report::default();
        let mut note = |count: usize, so: &str| {
            if count > 0 {
                report.note(format!("{}: {} {so}", self.source, counted(count, "atom")));
            }
        };
        note(self.waters, "of water, in the group `water`");
        note(
            self.alternates,
            "in alternate positions left out: of each residue the position that comes first is shown",
        );
        note(self.by_name, "without an element in columns 77 and 78, so it was told by their names");
        note(self.later, "of further models left out: the first model is shown");
        report
    }
}

/// Columns of a record, counted from 1 and both included, as far as it has them.
fn columns(record: &[u8], first: usize, last: usize) -> &[u8] {
    let end = last.min(record.len());
    record.get(first - 1..end).unwrap_or_default()
}

/// A column of a record; a space where it ends before.
fn byte(record: &[u8], column: usize) -> u8 {
    record.get(column - 1).copied().unwrap_or(b' ')
}

/// The element that an atom's name tells. A symbol of one letter stands in the second of its four columns,
/// one of two letters begins in the first; but names of hydrogens may fill all four, and in chains (`ATOM`)
/// the first column is often used for a single letter.
fn named(name: &[u8], is_other: bool) -> Option<Element> {
    let letters = name.iter().position(u8::is_ascii_alphabetic).map_or(&name[..0], |at| &name[at..]);
    let one = letters.get(..1).and_then(Element::of);
    let two = letters.get(..2).and_then(Element::of);
    let fills = name.len() == 4 && !name.contains(&b' ') && letters.first() == Some(&b'H');
    let begins = name.first().is_some_and(u8::is_ascii_alphabetic);
    let of_chain = !is_other && letters.first().is_some_and(|l| OF_CHAINS.contains(l));
    if begins && !fills && !of_chain { two.or(one) } else { one.or(two) }
}

fn why_empty(text: &[u8]) -> &'static str {
    let head = text.trim_ascii_start();
    match () {
        _ if head.is_empty() => "the file is empty",
        _ if head.starts_with(b"data_") => "this is mmCIF, not PDB; save it as PDB",
        _ if head.starts_with(b"<") => "this is HTML or XML, not PDB",
        _ if head.starts_with(b"PK\x03\x04") => "this is a ZIP archive, not PDB; unpack it first",
        _ => "there is no atom in it: no line begins with ATOM or HETATM",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// wwPDB format 3.3, ATOM, details: "CA" is an alpha carbon from the second column and calcium from the
    /// first.
    #[test]
    fn names_tell_elements_by_their_columns() {
        let symbol = |name: &[u8], is_other| named(name, is_other).map_or("?", Element::symbol);
        let others: [(&[u8], &str); 8] = [
            (b" CA ", "C"),
            (b"CA  ", "Ca"),
            (b"FE  ", "Fe"),
            (b"CL1 ", "Cl"),
            (b" O5'", "O"),
            (b"HO5'", "H"),
            (b"1HG2", "H"),
            (b" D1 ", "H"),
        ];
        for (name, want) in others {
            assert_eq!(symbol(name, true), want, "{}", name_of(name));
        }
        let chains: [(&[u8], &str); 6] =
            [(b" CA ", "C"), (b"CA  ", "C"), (b"HG11", "H"), (b"ZN  ", "Zn"), (b" N  ", "N"), (b"    ", "?")];
        for (name, want) in chains {
            assert_eq!(symbol(name, false), want, "{}", name_of(name));
        }
    }

    /// The atom that is one too many is told by its line.
    #[test]
    fn atoms_are_counted_to_the_limit() {
        let atom = Atom {
            element: Element(6),
            place: DVec3::ZERO,
            object: Object { name: String::new(), group: String::new(), motion: None },
        };
        let record = b"ATOM      1  CA  MET A   1       1.000   2.000   3.000";
        let with =
            |atoms: usize| Pass { source: "many.pdb", atoms: vec![atom.clone(); atoms], ..Pass::default() };
        let mut pass = with(MOST_ATOMS - 1);
        assert!(pass.record(8, record).is_ok() && pass.atoms.len() == MOST_ATOMS);
        let fault = pass.record(9, record).expect_err("one too many").to_string();
        assert!(fault.starts_with("many.pdb:9: there are more than 1048576 atoms"), "{fault}");
    }
}
