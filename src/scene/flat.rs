//! Flatland scenes: readable JSON files, described in `scenes2d/README.md`.
//!
//! Strict: a key that is not known is an error, since a mistyped one would be lost without a word. Errors
//! name the line. Segments without length and far too large ones are dropped and keep their id.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};
use serde::Deserialize;

use super::about::{About, Expectation};
use super::json::{Step, from_slice, line_of};
use super::mtl::GRAY;
use super::rounding::MAX_COORDINATE;
use super::source::stem;
use super::{Dropped, LoadOptions, Material, Object, Parts, Pose, Report, Scene, SceneError, views};
use crate::geometry::{Flat, MaterialId, ObjectId, PrimId, ViewPath};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    #[serde(default)]
    title: String,
    #[serde(default)]
    teaches: String,
    #[serde(default)]
    source: String,
    #[serde(default, alias = "license")]
    licence: String,
    segments: Vec<[f64; 4]>,
    #[serde(default)]
    objects: Vec<Vec<usize>>,
    #[serde(default)]
    object_names: Vec<String>,
    /// Color of each object, linear red, green, blue in 0..=1.
    #[serde(default)]
    colors: BTreeMap<String, [f32; 3]>,
    /// Names of objects that hide nothing.
    #[serde(default)]
    see_through: Vec<String>,
    /// Names of objects without a back.
    #[serde(default)]
    two_sided: Vec<String>,
    #[serde(default)]
    eyes: Vec<[f64; 4]>,
    #[serde(default)]
    walk: Vec<[f64; 4]>,
    bounds: Option<[f64; 4]>,
    fov_degrees: Option<f64>,
    /// Per object name: x, y and degrees counter-clockwise of each frame.
    #[serde(default)]
    motions: BTreeMap<String, Vec<[f64; 3]>>,
    #[serde(default)]
    expect: Vec<Fact>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fact {
    eye: usize,
    #[serde(default)]
    frame: usize,
    #[serde(default)]
    visible: Vec<usize>,
    #[serde(default)]
    hidden: Vec<usize>,
    #[serde(default)]
    outside: Vec<usize>,
}

/// Whole angle of view where the file gives none, degrees.
const FOV_DEGREES: f64 = 90.0;

/// Reads a flatland scene.
pub(super) fn read(bytes: &[u8], source: &str, options: &LoadOptions) -> Result<Scene<Flat>, SceneError> {
    let file: File = from_slice(bytes, source).map_err(|e| explain(e, bytes))?;
    let reader = Reader { bytes, source, options };
    let mut about = About {
        title: file.title.clone(),
        teaches: file.teaches.clone(),
        credit: file.source.clone(),
        license: file.licence.clone(),
        expect: vec![],
    };
    about.expect = reader.expect(&file)?;
    Ok(Scene::new(reader.parts(file)?)?.with_about(about))
}

/// A view file where a scene is expected is a likely slip, worth its own words.
fn explain(error: SceneError, bytes: &[u8]) -> SceneError {
    match error {
        SceneError::Syntax { path, line, why }
            if why.starts_with("unknown field `views`") || why.starts_with("unknown field `width`") =>
        {
            let why = "this is a view file, not a flatland scene; give it with --view".to_owned();
            SceneError::Syntax { path, line, why }
        }
        SceneError::Syntax { path, line, .. } if bytes.trim_ascii_start().starts_with(b"[") => {
            SceneError::Syntax { path, line, why: "a flatland scene is a JSON object, { … }".into() }
        }
        SceneError::Syntax { path, line, why } if bytes.trim_ascii().is_empty() => {
            SceneError::Syntax { path, line, why: format!("the file is empty ({why})") }
        }
        other => other,
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    source: &'a str,
    options: &'a LoadOptions,
}

impl Reader<'_> {
    fn fail<T>(&self, path: &[Step], why: impl Into<String>) -> Result<T, SceneError> {
        Err(SceneError::Syntax {
            path: self.source.to_owned(),
            line: line_of(self.bytes, path),
            why: why.into(),
        })
    }

    fn parts(&self, file: File) -> Result<Parts<Flat>, SceneError> {
        use Step::Key;
        let mut report = Report::default();
        if file.segments.is_empty() {
            return self.fail(&[Key("segments")], "there are no segments in it");
        }
        let fov = file.fov_degrees.unwrap_or(FOV_DEGREES);
        if !(fov > 0.1 && fov < 179.0) {
            return self
                .fail(&[Key("fov_degrees")], format!("fov_degrees must lie between 0.1 and 179, not {fov}"));
        }
        let prim_object = self.object_of_segments(&file, &mut report)?;
        let objects = self.objects(&file, prim_object.iter().map(|o| o.at() + 1).max().unwrap_or(0))?;
        let (materials, of_object) = self.materials(&file, &objects)?;
        let (points, prims) = self.segments(&file, &mut report);
        let mut parts = Parts {
            name: file.name.clone().unwrap_or_else(|| stem(Path::new(self.source))),
            source: self.source.to_owned(),
            points,
            prims,
            prim_material: prim_object.iter().map(|o| of_object[o.at()]).collect(),
            prim_object,
            faces: Vec::new(),
            objects,
            materials,
            origin: DVec3::ZERO,
            paths: Vec::new(),
            report,
        };
        let extent = file.bounds.unwrap_or_else(|| extent(&parts.points));
        for (key, stands) in [("eyes", &file.eyes), ("walk", &file.walk)] {
            if let Some(path) = self.path(key, stands, fov, extent)? {
                parts.paths.push(path);
            }
        }
        Ok(parts)
    }

    fn object_of_segments(&self, file: &File, report: &mut Report) -> Result<Vec<ObjectId>, SceneError> {
        use Step::{At, Key};
        let count = file.segments.len();
        let mut of = vec![None; count];
        for (o, segments) in file.objects.iter().enumerate() {
            for (k, &s) in segments.iter().enumerate() {
                let here = [Key("objects"), At(o), At(k)];
                match of.get_mut(s) {
                    None => {
                        return self.fail(
                            &here,
                            format!("object {o} names segment {s}, but there are only {count}"),
                        );
                    }
                    Some(Some(other)) => {
                        return self
                            .fail(&here, format!("segment {s} is in object {other} and in object {o}"));
                    }
                    Some(free) => *free = Some(o),
                }
            }
        }
        let loose = of.iter().filter(|o| o.is_none()).count();
        if loose > 0 && !file.objects.is_empty() {
            report.note(format!("{loose} segments are in no object; they make up one more, `rest`"));
        }
        Ok(of.into_iter().map(|o| ObjectId(o.unwrap_or(file.objects.len()) as u32)).collect())
    }

    /// Objects with their names and motions; `used` is at most one more than the file lists: the rest.
    fn objects(&self, file: &File, used: usize) -> Result<Vec<Object>, SceneError> {
        use Step::{At, Key};
        let count = file.objects.len();
        if !file.object_names.is_empty() && file.object_names.len() != count {
            let names = file.object_names.len();
            return self
                .fail(&[Key("object_names")], format!("there are {names} object_names for {count} objects"));
        }
        let name = |o: usize| match file.object_names.get(o) {
            Some(name) => name.clone(),
            None if o < count => format!("object_{o}"),
            None if count == 0 => "walls".into(),
            None => "rest".into(),
        };
        let mut objects: Vec<Object> = (0..used.max(count))
            .map(|o| Object { name: name(o), group: String::new(), motion: None })
            .collect();
        for (moved, frames) in &file.motions {
            let here = [Key("motions"), Key(moved.as_str())];
            if frames.is_empty() {
                return self.fail(&here, format!("the motion of `{moved}` has no frames"));
            }
            let bad = frames.iter().position(|f| !f.iter().all(|v| v.abs() <= MAX_COORDINATE));
            if let Some(k) = bad {
                return self.fail(
                    &[here[0], here[1], At(k)],
                    format!("frame {k} of the motion of `{moved}` is too large"),
                );
            }
            let motion: Arc<[Pose]> = frames.iter().map(|f| pose(*f)).collect();
            let mut found = false;
            for object in objects.iter_mut().filter(|o| o.name == *moved) {
                object.motion = Some(motion.clone());
                found = true;
            }
            if !found {
                return self.fail(&here, format!("there is no object `{moved}` to move"));
            }
        }
        Ok(objects)
    }

    /// Materials, and which of them each object has: the default, or one by the object's name.
    fn materials(
        &self,
        file: &File,
        objects: &[Object],
    ) -> Result<(Vec<Material>, Vec<MaterialId>), SceneError> {
        use Step::{At, Key};
        let mut named: BTreeMap<&str, Material> = BTreeMap::new();
        let plain = |name: &str| Material::new(name, GRAY);
        for (name, color) in &file.colors {
            let here = [Key("colors"), Key(name.as_str())];
            if !color.iter().all(|c| (0.0..=1.0).contains(c)) {
                return self.fail(&here, format!("the color of `{name}` must be three numbers from 0 to 1"));
            }
            self.find(objects, name, &here, "color")?;
            named.insert(name, Material::new(name.clone(), *color));
        }
        for (i, name) in file.see_through.iter().enumerate() {
            self.find(objects, name, &[Key("see_through"), At(i)], "see through")?;
            named.entry(name).or_insert_with(|| plain(name)).see_through = true;
        }
        for (i, name) in file.two_sided.iter().enumerate() {
            self.find(objects, name, &[Key("two_sided"), At(i)], "give two sides")?;
            named.entry(name).or_insert_with(|| plain(name)).two_sided = true;
        }
        let place = |o: &Object| named.keys().position(|n| *n == o.name).map_or(0, |at| at + 1);
        let of_object = objects.iter().map(|o| MaterialId(place(o) as u32)).collect();
        let materials = [Material::new("default", GRAY)].into_iter().chain(named.into_values());
        Ok((materials.collect(), of_object))
    }

    fn find(&self, objects: &[Object], name: &str, here: &[Step], what: &str) -> Result<(), SceneError> {
        if objects.iter().any(|o| o.name == name) {
            return Ok(());
        }
        self.fail(here, format!("there is no object `{name}` to {what}"))
    }

    fn segments(&self, file: &File, report: &mut Report) -> (Vec<Vec2>, Vec<Option<[u32; 2]>>) {
        let mut places = BTreeMap::new();
        let mut points = Vec::new();
        let mut prims = Vec::with_capacity(file.segments.len());
        let mut reused = 0;
        for &[x0, y0, x1, y1] in &file.segments {
            if ![x0, y0, x1, y1].iter().all(|c| c.abs() <= MAX_COORDINATE) {
                report.drop(Dropped::NotFinite, 1);
                prims.push(None);
                continue;
            }
            // −0 becomes 0, so that equal points have equal bits.
            let ends = [[x0, y0], [x1, y1]].map(|[x, y]| Vec2::new(x as f32, y as f32) + Vec2::ZERO);
            if ends[0] == ends[1] && self.options.drop_degenerate {
                report.drop(Dropped::Degenerate, 1);
                prims.push(None);
                continue;
            }
            prims.push(Some(ends.map(|p| {
                let next = points.len() as u32;
                let id = if self.options.weld {
                    *places.entry(p.to_array().map(f32::to_bits)).or_insert(next)
                } else {
                    next
                };
                if id == next {
                    points.push(p);
                } else {
                    reused += 1;
                }
                id
            })));
        }
        report.merged_points = reused;
        (points, prims)
    }

    fn path(
        &self,
        key: &str,
        stands: &[[f64; 4]],
        fov: f64,
        [left, low, right, high]: [f64; 4],
    ) -> Result<Option<ViewPath<Flat>>, SceneError> {
        let diagonal = (right - left).hypot(high - low);
        let diagonal =
            if diagonal.is_finite() && diagonal > 0.0 { diagonal.min(MAX_COORDINATE) } else { 1.0 };
        // Near enough to cut nothing that an eye in free space stands before, and far behind everything, also
        // from far off.
        let near = (diagonal * 1e-4).min(0.05) as f32;
        let far = |x: f64, y: f64| {
            let away = (x - (left + right) * 0.5).hypot(y - (low + high) * 0.5);
            let reach = if away.is_finite() { away.min(MAX_COORDINATE) + diagonal } else { 0.0 };
            reach.max(diagonal * 4.0) as f32
        };
        let mut list = Vec::with_capacity(stands.len());
        for (i, stand) in stands.iter().enumerate() {
            match views::flat_view(*stand, fov, near, far(stand[0], stand[1])) {
                Ok(view) => list.push(view),
                Err(why) => return self.fail(&[Step::Key(key), Step::At(i)], format!("{key} {i}: {why}")),
            }
        }
        Ok((!list.is_empty()).then(|| ViewPath { name: key.to_owned(), views: list }))
    }

    fn expect(&self, file: &File) -> Result<Vec<Expectation>, SceneError> {
        use Step::{At, Key};
        let mut facts = Vec::with_capacity(file.expect.len());
        for (i, fact) in file.expect.iter().enumerate() {
            if fact.eye >= file.eyes.len() {
                let why =
                    format!("fact {i} is about eye {}, but there are only {}", fact.eye, file.eyes.len());
                return self.fail(&[Key("expect"), At(i), Key("eye")], why);
            }
            let prims = |key: &'static str, list: &[usize]| {
                if let Some(k) = list.iter().position(|s| *s >= file.segments.len()) {
                    let why = format!(
                        "fact {i} names segment {}, but there are only {}",
                        list[k],
                        file.segments.len()
                    );
                    return self.fail(&[Key("expect"), At(i), Key(key), At(k)], why);
                }
                Ok(list.iter().map(|s| PrimId(*s as u32)).collect())
            };
            facts.push(Expectation {
                eye: fact.eye,
                frame: fact.frame,
                visible: prims("visible", &fact.visible)?,
                hidden: prims("hidden", &fact.hidden)?,
                outside: prims("outside", &fact.outside)?,
            });
        }
        Ok(facts)
    }
}

fn extent(points: &[Vec2]) -> [f64; 4] {
    let (low, high) = points
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(p.as_dvec2()), h.max(p.as_dvec2())));
    [low.x, low.y, high.x, high.y]
}

/// Rotation about the flatland origin, then translation.
fn pose([x, y, degrees]: [f64; 3]) -> Pose {
    let half = (degrees * 0.5).to_radians();
    Pose {
        rotation: [0.0, 0.0, half.sin() as f32, half.cos() as f32],
        translation: [x as f32, y as f32, 0.0],
    }
}
