//! Wavefront OBJ, read by `tobj` behind a pass of our own.
//!
//! The pass reads statements line by line and decides what is wrong with which line; what remains is
//! clean text with points first and absolute indices, in one model, so that tobj can neither fail nor
//! split, cut, or shift anything. Objects, groups and materials are ours: a face belongs to the `o` and
//! `g` that were last named, whatever materials switch between them. Cost: two passes over the file,
//! some 3 times its size in memory while reading.

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read};
use std::path::Path;

use glam::DVec3;

use super::assemble::{Mesh, assemble};
use super::text::{Lines, keyword, name_of, number, without_mark, words};
use super::{Dropped, LoadOptions, Object, Part, Parts, Progress, Report, SceneError, mtl};
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
    let mut pass = Pass::new(source);
    let whole = text.len().max(1) as f32;
    let mut lines = Lines::new(text);
    while let Some((line, statement)) = lines.next() {
        if line % 16_384 == 0 {
            progress.report((1.0 - lines.left_bytes() as f32 / whole) * 0.4, "reading lines");
            if progress.cancelled() {
                return Err(SceneError::Cancelled(source.to_owned()));
            }
        }
        pass.statement(line, &statement);
    }
    if pass.faces.is_empty() {
        return Err(format(pass.why_empty(text)));
    }
    pass.drop_bad_faces();
    let mut mesh =
        pass.through_tobj(&Part { whole: progress, start: 0.4, length: 0.3 }).map_err(|e| match e {
            _ if progress.cancelled() => SceneError::Cancelled(source.to_owned()),
            why => format(format!("tobj refused it: {why}")),
        })?;
    pass.tell();
    let home = folder.map(|folder| mtl::Home { folder, model: name });
    mesh.materials = mtl::resolve(&pass.material_names, &pass.libraries, home, &mut pass.report);
    mesh.objects = std::mem::take(&mut pass.objects);
    assemble(mesh, name, source, options, pass.report, &Part { whole: progress, start: 0.7, length: 0.3 })
}

/// A face as the first pass understood it.
struct Statement {
    line: u32,
    /// Past its last corner in `Pass::corners`.
    end: u32,
    ids: u32,
    object: u32,
    material: u32,
    lost: Option<Dropped>,
}

struct Pass<'a> {
    source: &'a str,
    /// `v` lines that tobj will read, one a point whatever it was.
    clean: Vec<u8>,
    /// What is wrong with each point, if anything.
    faults: Vec<Option<Dropped>>,
    corners: Vec<u32>,
    faces: Vec<Statement>,
    names: (Vec<u8>, Vec<u8>),
    object_ids: BTreeMap<(Vec<u8>, Vec<u8>), u32>,
    objects: Vec<Object>,
    /// Object of the next face, once one has been made for the current names.
    object: Option<u32>,
    material_ids: BTreeMap<Vec<u8>, u32>,
    material_names: Vec<Vec<u8>>,
    material: Option<u32>,
    libraries: Vec<(usize, String)>,
    ignored: BTreeMap<&'static str, usize>,
    unknown: BTreeMap<Vec<u8>, (usize, usize)>,
    not_utf8: (usize, usize),
    report: Report,
}

/// More kinds of unknown statement than this are only counted together: such a file is not OBJ.
const MAX_UNKNOWN: usize = 32;

impl<'a> Pass<'a> {
    fn new(source: &'a str) -> Self {
        Self {
            source,
            clean: Vec::new(),
            faults: Vec::new(),
            corners: Vec::new(),
            faces: Vec::new(),
            names: Default::default(),
            object_ids: BTreeMap::new(),
            objects: Vec::new(),
            object: None,
            material_ids: BTreeMap::new(),
            material_names: Vec::new(),
            material: None,
            libraries: Vec::new(),
            ignored: BTreeMap::new(),
            unknown: BTreeMap::new(),
            not_utf8: (0, 0),
            report: Report::default(),
        }
    }

    fn note(&mut self, line: usize, why: impl std::fmt::Display) {
        self.report.note(format!("{}:{line}: {why}", self.source));
    }

    fn statement(&mut self, line: usize, statement: &[u8]) {
        let (key, rest) = keyword(statement);
        if !key.starts_with(b"#") && !statement.is_ascii() && std::str::from_utf8(statement).is_err() {
            self.not_utf8 = (if self.not_utf8.1 == 0 { line } else { self.not_utf8.0 }, self.not_utf8.1 + 1);
        }
        match key {
            b"v" => self.point(line, rest),
            b"f" | b"fo" => self.face(line, rest),
            b"o" => self.rename(|n| n.0 = rest.to_vec()),
            b"g" => self.rename(|n| n.1 = rest.to_vec()),
            b"usemtl" => self.use_material(rest),
            b"mtllib" => self.libraries.push((line, name_of(rest))),
            b"vt" | b"vn" | b"s" => {}
            b"l" => *self.ignored.entry("line elements").or_default() += 1,
            b"p" => *self.ignored.entry("point elements").or_default() += 1,
            b"vp" | b"curv" | b"curv2" | b"surf" | b"deg" | b"cstype" | b"bmat" | b"step" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"mg" => {
                *self.ignored.entry("free-form statements").or_default() += 1
            }
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap" | b"maplib" | b"shadow_obj"
            | b"trace_obj" | b"ctech" | b"stech" => {}
            _ if key.is_empty() || key.starts_with(b"#") => {}
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

    fn point(&mut self, line: usize, rest: &[u8]) {
        let mut coordinates = words(rest);
        let three: [Option<(&[u8], f64)>; 3] =
            std::array::from_fn(|_| coordinates.next().and_then(|w| Some((w, number(w)?))));
        let fault = match three {
            [Some(x), Some(y), Some(z)] if [x.1, y.1, z.1].iter().all(|c| c.is_finite()) => {
                for (word, _) in [x, y, z] {
                    self.clean.push(b' ');
                    self.clean.extend_from_slice(word);
                }
                None
            }
            [Some(_), Some(_), Some(_)] => {
                self.note(line, "a coordinate is not finite, so faces at this point are dropped");
                Some(Dropped::NotFinite)
            }
            _ => {
                self.note(line, "`v` needs three numbers, so faces at this point are dropped");
                Some(Dropped::Malformed)
            }
        };
        if fault.is_some() {
            self.clean.extend_from_slice(b" 0 0 0");
        }
        self.clean.push(b'\n');
        self.faults.push(fault);
    }

    fn face(&mut self, line: usize, rest: &[u8]) {
        let start = self.corners.len();
        let mut lost = None;
        let mut count = 0u32;
        for word in words(rest) {
            count += 1;
            match self.corner(word) {
                Ok(index) => self.corners.push(index),
                Err(why) => lost = lost.or(Some((why, name_of(&word[..word.len().min(24)])))),
            }
        }
        if count < 3 {
            self.corners.truncate(start);
            self.note(line, format_args!("a face needs three corners, not {count}, so it was left out"));
            return;
        }
        if let Some((why, word)) = &lost {
            self.corners.truncate(start);
            self.note(line, format_args!("corner `{word}` {}, so the face is dropped", why_corner(*why)));
        }
        let (object, material) = (self.current_object(), self.current_material());
        let end = self.corners.len() as u32;
        self.faces.push(Statement {
            line: line as u32,
            end,
            ids: count - 2,
            object,
            material,
            lost: lost.map(|l| l.0),
        });
    }

    /// The 0-based point that a word such as `7`, `-1` or `7/2/3` names. It may lie ahead in the file.
    fn corner(&self, word: &[u8]) -> Result<u32, Dropped> {
        let index = word.split(|b| *b == b'/').next().unwrap_or(word);
        let index: i64 =
            std::str::from_utf8(index).ok().and_then(|i| i.parse().ok()).ok_or(Dropped::Malformed)?;
        let at = if index < 0 { self.faults.len() as i64 + index } else { index - 1 };
        u32::try_from(at).map_err(|_| Dropped::OutOfRange)
    }

    fn rename(&mut self, change: impl FnOnce(&mut (Vec<u8>, Vec<u8>))) {
        change(&mut self.names);
        self.object = None;
    }

    fn current_object(&mut self) -> u32 {
        if let Some(object) = self.object {
            return object;
        }
        let next = self.objects.len() as u32;
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
            self.objects.push(Object { name, group, motion: None });
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
        let (mut start, mut kept) = (0, 0);
        let points = self.faults.len();
        let mut notes = Vec::new();
        for face in &mut self.faces {
            let range = start..face.end as usize;
            start = range.end;
            for &c in self.corners[range.clone()].iter().filter(|_| face.lost.is_none()) {
                let fault =
                    if c as usize >= points { Some(Dropped::OutOfRange) } else { self.faults[c as usize] };
                if fault == Some(Dropped::OutOfRange) && notes.len() <= Report::MAX_NOTES {
                    let line = face.line;
                    notes.push(format!(
                        "{}:{line}: corner {} is past the last of {points} points, so the face is dropped",
                        self.source,
                        u64::from(c) + 1
                    ));
                }
                if fault.is_some() {
                    face.lost = fault;
                    break;
                }
            }
            if face.lost.is_none() {
                self.corners.copy_within(range.clone(), kept);
                kept += range.len();
            }
            face.end = kept as u32;
        }
        self.corners.truncate(kept);
        notes.into_iter().for_each(|n| self.report.note(n));
    }

    /// Hands the clean text to tobj and takes points and corners from it.
    fn through_tobj(&mut self, progress: &dyn Progress) -> Result<Mesh, tobj::LoadError> {
        let mut mesh = Mesh::default();
        let clean = std::mem::take(&mut self.clean);
        let whole = clean.len() + self.corners.len() * 8;
        let points = PointLines { text: &clean, at: 0, fresh: true };
        let faces =
            FaceLines { corners: &self.corners, faces: &self.faces, start: 0, line: Vec::new(), at: 0 };
        let mut reader = BufReader::with_capacity(
            1 << 16,
            Watched { inner: points.chain(faces), progress, read: 0, whole },
        );
        let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
        let (models, _) = tobj::load_obj_buf(&mut reader, &options, |_| Ok(Default::default()))?;
        if let Some(model) = models.into_iter().next() {
            mesh.points =
                model.mesh.positions.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)).collect();
            mesh.corners = model.mesh.indices;
        }
        let faces = std::mem::take(&mut self.faces);
        let raw = |f: Statement| super::assemble::RawFace {
            end: f.end,
            ids: f.ids,
            object: f.object,
            material: f.material,
            lost: f.lost,
        };
        mesh.faces = faces.into_iter().map(raw).collect();
        Ok(mesh)
    }

    fn tell(&mut self) {
        for (what, count) in std::mem::take(&mut self.ignored) {
            self.report.note(format!("{}: {count} {what} ignored", self.source));
        }
        let (line, count) = self.not_utf8;
        if count > 0 {
            self.note(
                line,
                format_args!(
                    "not UTF-8 from here on in {count} lines; names are shown as far as they can be"
                ),
            );
        }
        for (key, (line, count)) in std::mem::take(&mut self.unknown) {
            self.note(line, format_args!("unknown statement `{}`, {count} times, ignored", name_of(&key)));
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
        let lines = self.ignored.get("line elements").copied().unwrap_or(0);
        format!("it has no faces ({} points and {lines} line elements)", self.faults.len())
    }
}

fn why_corner(why: Dropped) -> &'static str {
    match why {
        Dropped::OutOfRange => "names a point before the first one",
        _ => "is not a number",
    }
}

/// ` x y z` lines with the `v` in front of each.
struct PointLines<'a> {
    text: &'a [u8],
    at: usize,
    fresh: bool,
}

impl Read for PointLines<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut written = 0;
        while written < out.len() && self.at < self.text.len() {
            if self.fresh {
                out[written] = b'v';
                written += 1;
                self.fresh = false;
                continue;
            }
            let rest = &self.text[self.at..];
            let end = rest.iter().position(|b| *b == b'\n').map_or(rest.len(), |e| e + 1);
            let count = end.min(out.len() - written);
            out[written..written + count].copy_from_slice(&rest[..count]);
            self.fresh = count == end;
            self.at += count;
            written += count;
        }
        Ok(written)
    }
}

/// `f` lines of the faces that are there.
struct FaceLines<'a> {
    corners: &'a [u32],
    faces: &'a [Statement],
    start: usize,
    line: Vec<u8>,
    at: usize,
}

impl Read for FaceLines<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while self.at == self.line.len() {
            let Some((face, rest)) = self.faces.split_first() else { return Ok(0) };
            self.faces = rest;
            if face.lost.is_some() {
                continue;
            }
            self.line.clear();
            self.at = 0;
            self.line.push(b'f');
            for c in &self.corners[self.start..face.end as usize] {
                push_decimal(&mut self.line, *c + 1);
            }
            self.start = face.end as usize;
            self.line.push(b'\n');
        }
        let count = out.len().min(self.line.len() - self.at);
        out[..count].copy_from_slice(&self.line[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}

fn push_decimal(line: &mut Vec<u8>, mut value: u32) {
    let mut digits = [b' '; 11];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    line.extend_from_slice(&digits[at - 1..]);
}

/// Reports the progress of a reader, and ends it with an error when it was cancelled.
struct Watched<'a, R> {
    inner: R,
    progress: &'a dyn Progress,
    read: usize,
    whole: usize,
}

impl<R: Read> Read for Watched<'_, R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.progress.cancelled() {
            return Err(io::Error::other("cancelled"));
        }
        let mut count = 0;
        // Whole buffers: the inner readers hand out a line at a time.
        while count < out.len() {
            match self.inner.read(&mut out[count..])? {
                0 => break,
                n => count += n,
            }
        }
        self.read += count;
        self.progress.report(self.read as f32 / self.whole.max(1) as f32, "reading points and faces");
        Ok(count)
    }
}
