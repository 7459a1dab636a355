//! Wavefront OBJ: points, polygons, names and material libraries (Wavefront, "Object Files (.obj)", version
//! 3.0).
//!
//! One pass over the statements, which decides what is wrong with which line and goes on. A face belongs to
//! the `o` and `g` that were last named, whatever materials switch between them. Curves, surfaces, lines and
//! points are counted and said. Cost: O(file); twice the file in memory while reading.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;

use super::assemble::assemble;
use super::mesh::{Mesh, RawFace};
use super::report::counted;
use super::text::{Lines, is_decimal_comma, keyword, name_of, number, without_mark, words};
use super::{Dropped, LoadOptions, Object, Part, Parts, Progress, Report, SceneError, mtl, palette};
use crate::geometry::Solid;

/// Reads OBJ text. Without a `folder` no material file is opened.
pub(super) fn read(
    bytes: &[u8],
    folder: Option<&Path>,
    name: &str,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let format = |why: String| SceneError::Format { path: source.to_owned(), why };
    let text = without_mark(bytes).map_err(|why| format(why.into()))?;
    let mut pass = Pass::new(source, progress);
    let whole = text.len().max(1) as f32;
    let mut lines = Lines::new(text);
    let mut count = 0;
    while let Some((line, statement)) = lines.next() {
        pass.statement(line, &statement);
        count += 1;
        if count % STATEMENTS == 0 || statement.len() > LONG_LINE {
            progress.report((1.0 - lines.left_bytes() as f32 / whole) * 0.6, "reading lines");
            if progress.cancelled() {
                return Err(SceneError::Cancelled(source.to_owned()));
            }
        }
    }
    pass.tell();
    if pass.mesh.faces.is_empty() {
        return Err(format(pass.why_empty(text)));
    }
    pass.drop_bad_faces();
    pass.scale_colors();
    let Pass { mut mesh, mut report, material_names, libraries, .. } = pass;
    let home = folder.map(|folder| mtl::Home { folder, model: name });
    mesh.materials = mtl::resolve(&material_names, &libraries, home, &mut report);
    if !mesh.colors.is_empty() {
        palette::paint(&mut mesh, &mut report);
    }
    assemble(mesh, name, source, options, report, &Part { whole: progress, start: 0.6, length: 0.4 })
}

/// Statements between two looks at the listener.
const STATEMENTS: usize = 16_384;
/// Bytes of a line after which one looks as well, and corners of a face.
const LONG_LINE: usize = 1 << 16;
/// More kinds of unknown statement than this are only counted together: such a file is not OBJ.
const MAX_UNKNOWN: usize = 32;
/// Colors are 0 to 1; where one is above this, they are bytes, as some programs write them.
const BYTES_ABOVE: f32 = 2.0;

struct Pass<'a> {
    source: &'a str,
    progress: &'a dyn Progress,
    mesh: Mesh,
    /// What is wrong with points that are bad.
    bad: BTreeMap<u32, Dropped>,
    /// Faces that name points beyond those read so far, and their lines.
    ahead: Vec<(usize, usize)>,
    names: (Vec<u8>, Vec<u8>),
    object_ids: BTreeMap<(Vec<u8>, Vec<u8>), u32>,
    /// Object of the next face, once one has been made for the current names.
    object: Option<u32>,
    material_ids: BTreeMap<Vec<u8>, u32>,
    material_names: Vec<Vec<u8>>,
    material: Option<u32>,
    libraries: Vec<(usize, String)>,
    ignored: BTreeMap<&'static str, usize>,
    curves: BTreeMap<Vec<u8>, usize>,
    unknown: BTreeMap<Vec<u8>, (usize, usize)>,
    not_utf8: (usize, usize),
    report: Report,
}

impl<'a> Pass<'a> {
    fn new(source: &'a str, progress: &'a dyn Progress) -> Self {
        Self {
            source,
            progress,
            mesh: Mesh::default(),
            bad: BTreeMap::new(),
            ahead: Vec::new(),
            names: Default::default(),
            object_ids: BTreeMap::new(),
            object: None,
            material_ids: BTreeMap::new(),
            material_names: Vec::new(),
            material: None,
            libraries: Vec::new(),
            ignored: BTreeMap::new(),
            curves: BTreeMap::new(),
            unknown: BTreeMap::new(),
            not_utf8: (0, 0),
            report: Report::default(),
        }
    }

    fn note(&mut self, line: usize, why: impl std::fmt::Display) {
        self.report.note(format!("{}:{line}: {why}", self.source));
    }

    /// Says of the first line of a kind what is wrong with `what`, and of the others only their lines.
    fn note_line(&mut self, line: usize, kind: &'static str, what: impl std::fmt::Display, so: &str) {
        let source = self.source;
        self.report.note_each(kind, format_args!("line {line}"), || {
            format!("{source}:{line}: {what} {kind}, so {so}")
        });
    }

    fn statement(&mut self, line: usize, statement: &[u8]) {
        let (key, rest) = keyword(statement);
        match key {
            b"v" => self.point(line, rest),
            b"f" | b"fo" => self.face(line, rest),
            b"vt" | b"vn" | b"s" | b"" => {}
            _ if key.starts_with(b"#") => {}
            _ => self.seldom(line, key, rest),
        }
    }

    /// Statements other than points and faces.
    fn seldom(&mut self, line: usize, key: &[u8], rest: &[u8]) {
        if std::str::from_utf8(rest).is_err() || !key.is_ascii() {
            self.not_utf8 = (if self.not_utf8.1 == 0 { line } else { self.not_utf8.0 }, self.not_utf8.1 + 1);
        }
        match key {
            b"o" => self.rename(|n| n.0 = rest.to_vec()),
            b"g" => self.rename(|n| n.1 = rest.to_vec()),
            b"usemtl" => self.use_material(rest),
            b"mtllib" => self.libraries.push((line, name_of(rest))),
            b"l" => *self.ignored.entry("line element").or_default() += 1,
            b"p" => *self.ignored.entry("point element").or_default() += 1,
            b"vp" | b"curv" | b"curv2" | b"surf" | b"deg" | b"cstype" | b"bmat" | b"step" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"mg" => {
                *self.curves.entry(key.to_vec()).or_default() += 1
            }
            b"usemap" | b"maplib" => *self.ignored.entry("texture statement").or_default() += 1,
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"ctech"
            | b"stech" => {}
            _ => self.unknown_statement(line, key),
        }
    }

    fn unknown_statement(&mut self, line: usize, key: &[u8]) {
        let key = if self.unknown.len() < MAX_UNKNOWN || self.unknown.contains_key(key) {
            &key[..key.len().min(24)]
        } else {
            b"others"
        };
        self.unknown.entry(key.to_vec()).or_insert((line, 0)).1 += 1;
    }

    /// `v x y z`, also with a weight (`w`, which polygons do not use), a color (`r g b`), or both.
    fn point(&mut self, line: usize, rest: &[u8]) {
        let mut numbers = [0.0; 7];
        let (mut count, mut comma) = (0, false);
        for word in words(rest).take(numbers.len()) {
            let Some(value) = number(word) else {
                comma = is_decimal_comma(word);
                break;
            };
            numbers[count] = value;
            count += 1;
        }
        let [x, y, z, ..] = numbers;
        let mut place = DVec3::new(x, y, z);
        let so = "faces at this point are dropped";
        if count < 3 || !place.is_finite() {
            place = DVec3::ZERO;
            let why = if count < 3 { Dropped::Malformed } else { Dropped::NotFinite };
            match why {
                Dropped::NotFinite => self.note_line(line, "is not finite", "a coordinate", so),
                _ if comma => {
                    self.note_line(line, "has a comma where a number has its point", "a coordinate", so)
                }
                _ => self.note_line(line, "needs three numbers", "`v`", so),
            }
            self.bad.insert(self.mesh.points.len() as u32, why);
        }
        if count >= 6 {
            let color = [0, 1, 2].map(|k| numbers[count - 3 + k] as f32);
            self.mesh.colors.resize(self.mesh.points.len(), Mesh::NO_COLOR);
            self.mesh.colors.push(color);
        }
        self.mesh.points.push(place);
    }

    fn face(&mut self, line: usize, rest: &[u8]) {
        let start = self.mesh.corners.len();
        let points = self.mesh.points.len();
        let (mut lost, mut count, mut last) = (None, 0u32, 0);
        for word in words(rest) {
            count += 1;
            match corner(word, points) {
                Ok(index) => {
                    last = last.max(index);
                    self.mesh.corners.push(index);
                }
                Err(why) => lost = lost.or(Some((why, name_of(&word[..word.len().min(24)])))),
            }
            if (count as usize).is_multiple_of(LONG_LINE) && self.progress.cancelled() {
                break;
            }
        }
        if count < 3 {
            self.mesh.corners.truncate(start);
            let kind = "needs three corners";
            return self.note_line(line, kind, format_args!("a face of {count}"), "it was left out");
        }
        let (object, material) = (self.current_object(), self.current_material());
        if let Some(((why, kind), word)) = lost {
            self.mesh.corners.truncate(start);
            self.note_line(line, kind, format_args!("corner `{word}`"), DROPPED);
            self.mesh.push_lost(count - 2, object, material, why);
            return;
        }
        if last as usize >= points {
            self.ahead.push((self.mesh.faces.len(), line));
        }
        let end = self.mesh.corners.len() as u32;
        self.mesh.faces.push(RawFace { end, ids: count - 2, object, material, lost: None });
    }

    fn rename(&mut self, change: impl FnOnce(&mut (Vec<u8>, Vec<u8>))) {
        change(&mut self.names);
        self.object = None;
    }

    fn current_object(&mut self) -> u32 {
        if let Some(object) = self.object {
            return object;
        }
        let objects = &mut self.mesh.objects;
        let next = objects.len() as u32;
        let id = *self.object_ids.entry(self.names.clone()).or_insert(next);
        if id == next {
            let (o, g) = (name_of(&self.names.0), name_of(&self.names.1));
            let (name, group) = if !o.is_empty() {
                (o, g)
            } else if g.is_empty() {
                ("default".into(), g)
            } else {
                (g, String::new())
            };
            objects.push(Object { name, group, motion: None });
        }
        self.object = Some(id);
        id
    }

    fn use_material(&mut self, name: &[u8]) {
        let next = self.material_names.len() as u32;
        let id = *self.material_ids.entry(name.to_vec()).or_insert(next);
        if id == next {
            self.material_names.push(name.to_vec());
        }
        self.material = Some(id);
    }

    fn current_material(&mut self) -> u32 {
        if self.material.is_none() {
            self.use_material(b"");
        }
        self.material.unwrap_or(0)
    }

    /// Now that all points are known: faces at points that are missing or bad are dropped.
    fn drop_bad_faces(&mut self) {
        if self.ahead.is_empty() && self.bad.is_empty() {
            return;
        }
        let Mesh { points, corners, faces, .. } = &mut self.mesh;
        let (mut start, mut kept) = (0, 0);
        let count = points.len();
        let mut ahead = self.ahead.iter().peekable();
        for (k, face) in faces.iter_mut().enumerate() {
            let range = start..face.end as usize;
            start = range.end;
            let line = ahead.next_if(|a| a.0 == k).map(|a| a.1);
            let past = corners[range.clone()].iter().find(|c| line.is_some() && **c as usize >= count);
            if let (Some(line), Some(past)) = (line, past) {
                let (source, past) = (self.source, u64::from(*past) + 1);
                self.report.note_each("obj: past the last", format_args!("line {line}"), || {
                    format!("{source}:{line}: corner {past} is past the last of {count} points, so {DROPPED}")
                });
                face.lost = Some(Dropped::OutOfRange);
            } else if !self.bad.is_empty() && face.lost.is_none() {
                face.lost = corners[range.clone()].iter().find_map(|c| self.bad.get(c).copied());
            }
            if face.lost.is_none() {
                corners.copy_within(range.clone(), kept);
                kept += range.len();
            }
            face.end = kept as u32;
        }
        corners.truncate(kept);
    }

    fn scale_colors(&mut self) {
        let colors = &mut self.mesh.colors;
        if !colors.is_empty() {
            colors.resize(self.mesh.points.len(), Mesh::NO_COLOR);
        }
        if colors.iter().flatten().any(|c| *c > BYTES_ABOVE) {
            colors.iter_mut().flatten().for_each(|c| *c /= 255.0);
        }
    }

    fn tell(&mut self) {
        for (what, count) in std::mem::take(&mut self.ignored) {
            self.report.note(format!("{}: {} ignored", self.source, counted(count, what)));
        }
        if !self.curves.is_empty() {
            let told = self.curves.iter().map(|(key, count)| format!("`{}` ({count})", name_of(key)));
            let told = told.collect::<Vec<_>>().join(", ");
            self.report.note(format!("{}: curves and surfaces are not read: {told}", self.source));
        }
        let (line, count) = self.not_utf8;
        if count > 0 {
            self.note(
                line,
                format_args!(
                    "not UTF-8 from here on in {}; names are shown as far as they can be",
                    counted(count, "line")
                ),
            );
        }
        let mut unknown: Vec<_> = self.unknown.iter().collect();
        unknown.sort_unstable_by_key(|(_, (line, _))| *line);
        for (key, (line, count)) in unknown {
            let small = key.to_ascii_lowercase();
            let is_known = matches!(small.as_slice(), b"v" | b"f" | b"o" | b"g" | b"usemtl" | b"mtllib");
            let hint = if is_known { "; keywords are in small letters" } else { "" };
            let (source, key) = (self.source, name_of(key));
            self.report.note_each(
                "obj: unknown",
                format_args!("`{key}` in {}", counted(*count, "line")),
                || {
                    let lines = counted(*count, "line");
                    format!("{source}:{line}: unknown statement `{key}` in {lines} ignored{hint}")
                },
            );
        }
    }

    fn why_empty(&self, text: &[u8]) -> String {
        let head = text.trim_ascii_start();
        let begins =
            |with: &str| head.get(..with.len()).is_some_and(|h| h.eq_ignore_ascii_case(with.as_bytes()));
        let is_stl = begins("solid") && self.unknown.contains_key(&b"facet"[..]);
        let looks = match () {
            _ if head.is_empty() => "the file is empty",
            _ if is_stl => "this is an STL file, not an OBJ",
            _ if begins("<") => "this is HTML or XML, not an OBJ",
            _ if begins("ply") => "this is a PLY file, not an OBJ",
            _ if begins("glTF") => "this is a GLB file, not an OBJ",
            _ if begins("PK\x03\x04") => "this is a ZIP archive, not an OBJ",
            _ if begins("{") => "this is JSON, not an OBJ",
            _ => "",
        };
        if !looks.is_empty() {
            return looks.into();
        }
        let mut report = self.report.clone();
        report.settle();
        format!("it has no faces ({}){}", counted(self.mesh.points.len(), "point"), report.reasons())
    }
}

const DROPPED: &str = "the face is dropped";

/// The 0-based point that a word such as `7`, `-1` or `7/2/3` names, or what is wrong with it. It may lie
/// ahead in the file.
fn corner(word: &[u8], points: usize) -> Result<u32, (Dropped, &'static str)> {
    let negative = word.starts_with(b"-");
    let digits = if negative || word.starts_with(b"+") { &word[1..] } else { word };
    let mut value: u64 = 0;
    let mut length = 0;
    for byte in digits {
        match byte {
            b'0'..=b'9' => value = value.saturating_mul(10).saturating_add(u64::from(byte - b'0')),
            b'/' => break,
            _ => return Err((Dropped::Malformed, "is not a number")),
        }
        length += 1;
    }
    let before = Err((Dropped::OutOfRange, "names a point before the first one"));
    match (length, negative) {
        (0, _) => Err((Dropped::Malformed, "is not a number")),
        (_, false) if value == 0 => before,
        (_, false) => {
            u32::try_from(value - 1).map_err(|_| (Dropped::OutOfRange, "names a point past any last one"))
        }
        // The last point is -1; there are fewer than 2^32.
        (_, true) => match (points as u64).checked_sub(value) {
            Some(at) if value > 0 => Ok(at as u32),
            _ => before,
        },
    }
}
