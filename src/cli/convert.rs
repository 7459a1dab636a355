//! `cullscope scene convert`: a scene as OBJ with materials and views, or as a flatland JSON file.
//!
//! Primitive ids stay: a primitive that was dropped is written as one without extent, which is dropped again
//! when it is read. Coordinates are written so that they read back as the same 32-bit numbers.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use serde_json::{Map, Value as Json, json};

use super::{CliError, output};
use crate::geometry::{Flat, ObjectId, PrimId, Solid, Vector, View};
use crate::scene::{AnyScene, Expectation, Object, Scene, write_views};

/// Writes `scene` to `out`; `recentered` keeps its origin subtracted.
pub(super) fn write(scene: &AnyScene, out: &Path, recentered: bool) -> Result<(), CliError> {
    let extension = out.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match (scene, extension.as_str()) {
        (AnyScene::Solid(scene), "obj") => {
            let origin = if recentered { DVec3::ZERO } else { scene.origin() };
            for path in scene.paths() {
                let ending = if path.name == "walk" { "walk.views.json" } else { "views.json" };
                write_text(&out.with_extension(ending), &write_views(path, origin))?;
            }
            write_text(&out.with_extension("mtl"), &materials(scene))?;
            output::write_file(out, |to| obj(scene, origin, out, to).map(|()| true))
        }
        (AnyScene::Flat(scene), "json") => write_text(out, &flat_json(scene)),
        (AnyScene::Solid(_), _) => Err(wrong_kind(out, "a scene in space is written as .obj")),
        (AnyScene::Flat(_), _) => Err(wrong_kind(out, "a flatland scene is written as .json")),
    }
}

fn wrong_kind(out: &Path, why: &str) -> CliError {
    CliError::words(out.display().to_string(), why)
}

fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    output::write_file(path, |to| to.write_all(text.as_bytes()).map(|()| true))
}

/// A name that survives as one word of a line.
fn word(name: &str) -> String {
    let kept: String =
        name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
    if kept.is_empty() { "_".into() } else { kept }
}

fn materials(scene: &Scene<Solid>) -> String {
    let mut text = String::new();
    for (i, material) in scene.materials().iter().enumerate() {
        let [r, g, b] = material.color;
        // Writing to a string cannot fail. The number keeps equal names apart.
        let _ = writeln!(text, "newmtl {}.{i}\nKd {r} {g} {b}", word(&material.name));
    }
    text
}

fn obj(scene: &Scene<Solid>, origin: DVec3, out: &Path, to: &mut dyn Write) -> io::Result<()> {
    writeln!(to, "# {}: {} triangles, ids in this order", word(scene.name()), scene.prim_count())?;
    let library = out.with_extension("mtl");
    writeln!(to, "mtllib {}", library.file_name().unwrap_or_default().to_string_lossy())?;
    for point in scene.points() {
        let [x, y, z] = [0, 1, 2].map(|a| coordinate(point.get(a), origin[a]));
        writeln!(to, "v {x} {y} {z}")?;
    }
    let (mut object, mut material) = (None, None);
    for prim in (0..scene.prim_count() as u32).map(PrimId) {
        if object.replace(scene.object_of(prim)) != Some(scene.object_of(prim)) {
            let Object { name, group, .. } = &scene.objects()[scene.object_of(prim).at()];
            writeln!(to, "o {}", word(name))?;
            if !group.is_empty() {
                writeln!(to, "g {}", word(group))?;
            }
        }
        if material.replace(scene.material_of(prim)) != Some(scene.material_of(prim)) {
            let at = scene.material_of(prim).at();
            writeln!(to, "usemtl {}.{at}", word(&scene.materials()[at].name))?;
        }
        let [a, b, c] = scene.corners(prim).map_or([1, 1, 1], |corners| corners.map(|c| c + 1));
        writeln!(to, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// The shortest decimal that reads back the same, moved back by the origin.
fn coordinate(value: f32, origin: f64) -> String {
    if origin == 0.0 { value.to_string() } else { (f64::from(value) + origin).to_string() }
}

/// A number as JSON: the shortest decimal of its 32 bits.
fn number(value: f32) -> Json {
    value.to_string().parse::<f64>().map_or(Json::Null, Json::from)
}

/// A flatland scene file, one segment a line.
fn flat_json(scene: &Scene<Flat>) -> String {
    let ids = |o: usize| {
        (0..scene.prim_count() as u32).filter(move |p| scene.object_of(PrimId(*p)) == ObjectId(o as u32))
    };
    let objects: Vec<Vec<u32>> = (0..scene.objects().len()).map(|o| ids(o).collect()).collect();
    let mut text = String::from("{\n");
    for (key, value) in &head(scene, &objects) {
        let _ = writeln!(text, "{}: {value},", Json::from(key.as_str()));
    }
    let lines = |list: Vec<String>| list.join(",\n");
    let _ = writeln!(
        text,
        "\"objects\": [\n{}\n],",
        lines(objects.iter().map(|o| json!(o).to_string()).collect())
    );
    let segments = (0..scene.prim_count() as u32).map(|p| {
        // A dropped segment keeps its id as one without length.
        let ends: Vec<f32> = scene.prim_points(PrimId(p)).flat_map(|v| [v.x, v.y]).collect();
        json!(if ends.is_empty() { vec![number(0.0); 4] } else { ends.into_iter().map(number).collect() })
            .to_string()
    });
    let _ = writeln!(text, "\"segments\": [\n{}\n]\n}}", lines(segments.collect()));
    text
}

/// What stands before the objects and segments, without what is empty.
fn head(scene: &Scene<Flat>, objects: &[Vec<u32>]) -> Map<String, Json> {
    let about = scene.about();
    let mut head = Map::new();
    head.insert("name".into(), scene.name().into());
    for (key, text) in [
        ("title", &about.title),
        ("teaches", &about.teaches),
        ("source", &about.credit),
        ("licence", &about.license),
    ] {
        if !text.is_empty() {
            head.insert(key.into(), text.as_str().into());
        }
    }
    head.insert("object_names".into(), scene.objects().iter().map(|o| Json::from(&*o.name)).collect());
    head.insert("colors".into(), colors(scene, objects));
    head.insert("motions".into(), motions(scene));
    for path in scene.paths().iter().filter(|p| p.name == "eyes" || p.name == "walk") {
        let stand = |v: &View<Flat>| {
            let (p, d) = (v.eye.position, v.eye.target - v.eye.position);
            json!([number(p.x), number(p.y), number(d.x), number(d.y)])
        };
        head.insert(path.name.clone(), path.views.iter().map(stand).collect());
        // The shortest decimal of the angle; one angle serves the whole file.
        let fov = path.views[0].eye.fov.to_degrees();
        head.insert("fov_degrees".into(), number((fov * 1e4).round() / 1e4));
    }
    head.insert("expect".into(), about.expect.iter().map(expectation).collect());
    head.retain(|_, v| !v.as_array().is_some_and(Vec::is_empty) && !v.as_object().is_some_and(Map::is_empty));
    head
}

/// What is expected of one view, as ids.
fn expectation(e: &Expectation) -> Json {
    let list = |prims: &[PrimId]| prims.iter().map(|p| p.0).collect::<Vec<_>>();
    let [visible, hidden, outside] = [&e.visible, &e.hidden, &e.outside].map(|prims| list(prims));
    json!({ "eye": e.eye, "frame": e.frame, "visible": visible, "hidden": hidden, "outside": outside })
}

/// Color by object name, of the object's first segment.
fn colors(scene: &Scene<Flat>, objects: &[Vec<u32>]) -> Json {
    let mut colors = BTreeMap::new();
    for (object, prims) in scene.objects().iter().zip(objects) {
        if let Some(first) = prims.first() {
            colors
                .entry(object.name.clone())
                .or_insert_with(|| scene.color_of(PrimId(*first)).map(number).to_vec());
        }
    }
    json!(colors)
}

/// Frames by object name: x, y and degrees.
fn motions(scene: &Scene<Flat>) -> Json {
    let frame = |pose: &crate::scene::Pose| {
        let degrees = (2.0 * f64::from(pose.rotation[2]).atan2(f64::from(pose.rotation[3]))).to_degrees();
        json!([number(pose.translation[0]), number(pose.translation[1]), (degrees * 1e4).round() / 1e4])
    };
    let moving = scene
        .objects()
        .iter()
        .filter_map(|o| Some((o.name.clone(), o.motion.as_ref()?.iter().map(frame).collect::<Vec<_>>())));
    json!(moving.collect::<BTreeMap<_, _>>())
}
