//! Views and paths of views as JSON, in and out.
//!
//! Space:
//!
//! ```json
//! {"width":W,"height":H,"views":[
//!   {"eye":[x,y,z],"target":[x,y,z],"up":[0,1,0],"fov_y_degrees":60,"near":0.1,"far":1000}]}
//! ```
//!
//! Flatland: two numbers a vector, no `up`, `fov_degrees`, height 1. Files hold the model's own coordinates;
//! the scene's origin is subtracted on the way in and added on the way out.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;

use super::SceneError;
use super::json::{Step, from_slice, line_of};
use super::source::{JSON_LIMIT_BYTES, stem};
use super::text::read_file;
use crate::geometry::{Eye, Flat, Solid, Space, Vector, View, ViewPath};

/// Greatest width and height of an image, pixels.
const MAX_PIXELS: u32 = 16_384;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    width: Option<u32>,
    height: Option<u32>,
    views: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    eye: Vec<f64>,
    target: Vec<f64>,
    up: Option<Vec<f64>>,
    fov_y_degrees: Option<f64>,
    fov_degrees: Option<f64>,
    near: Option<f64>,
    far: Option<f64>,
}

/// Reads a view file for a scene whose points had `origin` subtracted.
///
/// # Errors
/// What is wrong, with the file and the line.
pub fn read_views<S: Space>(path: &str, origin: DVec3) -> Result<ViewPath<S>, SceneError> {
    parse_views(&read_file(Path::new(path), path, JSON_LIMIT_BYTES)?, path, origin)
}

/// Reads views out of JSON text; `source` is named in errors.
///
/// # Errors
/// What is wrong, with the line.
pub fn parse_views<S: Space>(bytes: &[u8], source: &str, origin: DVec3) -> Result<ViewPath<S>, SceneError> {
    let file: File = from_slice(bytes, source)?;
    let fail = |path: &[Step], why: String| SceneError::Syntax {
        path: source.to_owned(),
        line: line_of(bytes, path),
        why,
    };
    let flat = S::Vector::AXES == 2;
    let (width, height) = (file.width.unwrap_or(1024), file.height.unwrap_or(if flat { 1 } else { 1024 }));
    for (key, size) in [("width", width), ("height", height)] {
        if !(1..=MAX_PIXELS).contains(&size) {
            return Err(fail(
                &[Step::Key(key)],
                format!("{key} must be 1 to {MAX_PIXELS} pixels, not {size}"),
            ));
        }
    }
    if flat && height != 1 {
        return Err(fail(&[Step::Key("height")], format!("a flatland image has height 1, not {height}")));
    }
    if file.views.is_empty() {
        return Err(fail(&[Step::Key("views")], "there are no views in it".into()));
    }
    let mut views = Vec::with_capacity(file.views.len());
    for (i, entry) in file.views.iter().enumerate() {
        let eye = eye_of::<S>(entry, origin);
        let eye = eye.and_then(|e: Eye<S>| e.fault().map_or(Ok(e), |why| Err(why.into())));
        views.push(View {
            eye: eye.map_err(|why| fail(&[Step::Key("views"), Step::At(i)], format!("view {i}: {why}")))?,
            width,
            height,
        });
    }
    Ok(ViewPath { name: file.name.unwrap_or_else(|| path_name(source)), views })
}

/// `walk` of `NAME.walk.views.json`, else `views`.
fn path_name(source: &str) -> String {
    let file = Path::new(source).file_name().map(|f| f.to_string_lossy().into_owned()).unwrap_or_default();
    let name =
        file.strip_suffix(".views.json").and_then(|f| f.rsplit_once('.')).map(|(_, name)| name.to_owned());
    name.filter(|n| !n.is_empty()).unwrap_or_else(|| "views".into())
}

fn eye_of<S: Space>(entry: &Entry, origin: DVec3) -> Result<Eye<S>, String> {
    let axes = S::Vector::AXES;
    let vector = |what: &str, v: &[f64], origin: DVec3| {
        if v.len() != axes {
            return Err(format!("`{what}` needs {axes} numbers in {}, not {}", S::NAME, v.len()));
        }
        Ok(S::Vector::from_fn(|a| (v[a] - origin[a]) as f32))
    };
    let degrees = match (axes, entry.fov_y_degrees, entry.fov_degrees) {
        (2, None, Some(d)) | (3, Some(d), None) => d,
        (2, None, None) => 90.0,
        (_, None, None) => 60.0,
        (2, ..) => {
            return Err(
                "flatland has `fov_degrees`, the angle across the image, and no `fov_y_degrees`".into()
            );
        }
        _ => return Err("space has `fov_y_degrees`, the vertical angle, and no `fov_degrees`".into()),
    };
    let up = match &entry.up {
        Some(_) if axes == 2 => return Err("there is no `up` in flatland".into()),
        Some(up) => vector("up", up, DVec3::ZERO)?,
        None => S::Vector::from_fn(|a| if a == 1 { 1.0 } else { 0.0 }),
    };
    Ok(Eye {
        position: vector("eye", &entry.eye, origin)?,
        target: vector("target", &entry.target, origin)?,
        up,
        fov: degrees.to_radians() as f32,
        near: entry.near.unwrap_or(0.1) as f32,
        far: entry.far.unwrap_or(1000.0) as f32,
    })
}

/// Writes a path as JSON text, one view a line; what [`parse_views`] reads back is the same view, bit for
/// bit, where `origin` is zero.
pub fn write_views<S: Space>(path: &ViewPath<S>, origin: DVec3) -> String {
    let (width, height) = path.views.first().map_or((1024, 1024), |v| (v.width, v.height));
    let vector = |v: S::Vector, origin: DVec3| {
        let numbers: Vec<String> = (0..S::Vector::AXES).map(|a| coordinate(v.get(a), origin[a])).collect();
        format!("[{}]", numbers.join(","))
    };
    let mut text = format!(
        "{{\"name\":{},\"width\":{width},\"height\":{height},\"views\":[",
        serde_json::Value::from(path.name.as_str())
    );
    for (i, View { eye, .. }) in path.views.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let (up, angle) = match S::Vector::AXES {
            2 => (String::new(), "fov_degrees"),
            _ => (format!("\"up\":{},", vector(eye.up, DVec3::ZERO)), "fov_y_degrees"),
        };
        let (position, target, fov) =
            (vector(eye.position, origin), vector(eye.target, origin), degrees(eye.fov));
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{comma}\n{{\"eye\":{position},\"target\":{target},{up}\"{angle}\":{fov},\"near\":{},\
             \"far\":{}}}",
            eye.near, eye.far
        );
    }
    text.push_str("\n]}\n");
    text
}

fn coordinate(value: f32, origin: f64) -> String {
    if origin == 0.0 { value.to_string() } else { (f64::from(value) + origin).to_string() }
}

/// The shortest decimal that reads back as the same angle.
fn degrees(radians: f32) -> String {
    let exact = f64::from(radians).to_degrees();
    let short = (0..7).map(|digits| format!("{exact:.digits$}"));
    short
        .into_iter()
        .find(|s| s.parse::<f64>().is_ok_and(|d| d.to_radians() as f32 == radians))
        .unwrap_or_else(|| exact.to_string())
}

/// The paths that lie beside a model. A broken one becomes a note.
pub(super) fn beside_model(
    model: &Path,
    origin: DVec3,
    paths: &mut Vec<ViewPath<Solid>>,
    notes: &mut Vec<String>,
) {
    for ending in ["views.json", "walk.views.json"] {
        let file = model.with_file_name(format!("{}.{ending}", stem(model)));
        if !file.is_file() {
            continue;
        }
        match read_views::<Solid>(&file.to_string_lossy(), origin) {
            Ok(path) => paths.push(path),
            Err(why) => notes.push(format!("view path left out: {why}")),
        }
    }
}

/// A flatland eye that stands at `[x, y]` and looks along `[dx, dy]`.
pub(super) fn flat_view(
    stand: [f64; 4],
    fov_degrees: f64,
    near: f32,
    far: f32,
) -> Result<View<Flat>, &'static str> {
    let [x, y, dx, dy] = stand;
    let position = glam::Vec2::new(x as f32, y as f32);
    let target = glam::Vec2::new((x + dx) as f32, (y + dy) as f32);
    let eye = Eye { position, target, up: glam::Vec2::Y, fov: fov_degrees.to_radians() as f32, near, far };
    eye.fault().map_or(Ok(View { eye, width: 1024, height: 1 }), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_survive_writing_and_reading() {
        let eye = Eye::<Solid> {
            position: glam::Vec3::new(0.1, -2.7, 1e-7),
            target: glam::Vec3::new(1e6, 3.3, 0.0),
            up: glam::Vec3::new(0.0, 0.6, 0.8),
            fov: 47.25f32.to_radians(),
            near: 0.01,
            far: 123456.7,
        };
        let path =
            ViewPath { name: "to \"and\" fro".into(), views: vec![View { eye, width: 640, height: 480 }; 3] };
        let text = write_views(&path, DVec3::ZERO);
        assert_eq!(parse_views::<Solid>(text.as_bytes(), "t", DVec3::ZERO).expect("valid"), path);
        assert!(text.contains("\"fov_y_degrees\":47.25,"), "{text}");
        let flat = flat_view([1.5, 2.0, 0.0, -1.0], 60.0, 0.1, 50.0).expect("valid");
        let path = ViewPath::<Flat> { name: "f".into(), views: vec![flat] };
        let text = write_views(&path, DVec3::ZERO);
        assert_eq!(parse_views::<Flat>(text.as_bytes(), "t", DVec3::ZERO).expect("valid"), path);
    }

    #[test]
    fn the_origin_moves_eyes_and_not_directions() {
        let text = br#"{"views":[{"eye":[500000,20,4649776],"target":[500001,20,4649776],"up":[0,1,0]}]}"#;
        let origin = DVec3::new(500000.0, 0.0, 4649776.0);
        let path = parse_views::<Solid>(text, "far.walk.views.json", origin).expect("valid");
        assert_eq!(path.name, "walk");
        assert_eq!(path.views[0].eye.position, glam::Vec3::new(0.0, 20.0, 0.0));
        assert_eq!(path.views[0].eye.forward(), glam::Vec3::X);
        assert!(write_views(&path, origin).contains("[500001,20,4649776]"));
    }
}
