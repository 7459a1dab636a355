//! `cullscope scene convert`: a scene as OBJ with materials and views, or as a flatland JSON file.
//!
//! Primitive ids stay: a primitive that was dropped is written as one without extent, which is dropped again
//! when it is read. Coordinates are written so that they read back as the same 32-bit numbers. Names that a
//! line cannot hold and names that stand twice are changed, so that objects stay apart; that is said, and so
//! is what the format has no words for.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use serde_json::{Map, Value as Json, json};

use super::{CliError, output};
use crate::geometry::{Flat, ObjectId, PrimId, Solid, Vector, View};
use crate::scene::{AnyScene, Expectation, Material, Scene, write_views};

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
            let names = Names::of(scene);
            write_text(&out.with_extension("mtl"), &materials(scene, &names.materials))?;
            output::write_file(out, |to| obj(scene, &names, origin, out, to).map(|()| true))?;
            losses(scene, &names).iter().for_each(|line| output::say(line));
            Ok(())
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

/// A name that survives as the rest of a line: no breaks, no space around it, no `\` that joins lines.
fn on_a_line(name: &str) -> String {
    let kept: String = name.trim().chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    match kept.strip_suffix('\\') {
        Some(rest) => format!("{rest}_"),
        None => kept,
    }
}

/// Names under which everything is written.
struct Names {
    /// Name and group of each object.
    objects: Vec<(String, String)>,
    materials: Vec<String>,
}

impl Names {
    fn of(scene: &Scene<Solid>) -> Self {
        let mut taken = BTreeSet::new();
        let objects = scene.objects().iter().map(|o| {
            let group = on_a_line(&o.group);
            (unique(&on_a_line(&o.name), &mut taken, |name| (name, group.clone())), group)
        });
        let objects = objects.collect();
        let mut taken = BTreeSet::new();
        let materials = scene.materials().iter();
        let materials = materials.map(|m| unique(&on_a_line(&m.name), &mut taken, |name| name)).collect();
        Self { objects, materials }
    }
}

/// The name, or with the first number from 2 on under which it does not stand yet.
fn unique<K: Ord>(name: &str, taken: &mut BTreeSet<K>, key: impl Fn(String) -> K) -> String {
    let name = if name.is_empty() { "_" } else { name };
    let tries = std::iter::once(name.to_owned()).chain((2u64..).map(|k| format!("{name}.{k}")));
    for tried in tries {
        if taken.insert(key(tried.clone())) {
            return tried;
        }
    }
    name.to_owned()
}

/// A line for each kind of thing that is not written as it was.
fn losses(scene: &Scene<Solid>, names: &Names) -> Vec<String> {
    let used: BTreeSet<ObjectId> = scene.live().iter().map(|p| scene.object_of(*p)).collect();
    let objects = scene.objects();
    let renamed: Vec<String> = objects
        .iter()
        .zip(&names.objects)
        .filter(|(o, (name, group))| o.name != *name || o.group != *group)
        .map(|(o, (name, _))| format!("`{}` as `{name}`", on_a_line(&o.name)))
        .collect();
    let listed = |what: &str, noun: &str, list: Vec<String>| {
        let (count, more) = (list.len(), if list.len() > 4 { ", …" } else { "" });
        let noun = if count == 1 { noun.to_owned() } else { format!("{noun}s") };
        let first = list.iter().take(4).cloned().collect::<Vec<_>>().join(", ");
        (count > 0).then(|| format!("{what}: {count} {noun} ({first}{more})"))
    };
    let quoted = |name: &String| format!("`{}`", on_a_line(name));
    let moving = objects.iter().filter(|o| o.motion.is_some()).map(|o| quoted(&o.name)).collect();
    let empty = (0..objects.len()).filter(|o| !used.contains(&ObjectId(*o as u32)));
    let empty = empty.map(|o| quoted(&objects[o].name)).collect();
    let of = |keep: fn(&Material) -> bool| {
        scene.materials().iter().filter(|m| keep(m)).map(|m| quoted(&m.name)).collect()
    };
    let lines = [
        listed("written under another name, to stay apart and on a line", "object", renamed),
        listed("written at rest, since OBJ holds no motion", "object", moving),
        listed("not written, since nothing of it is drawn", "object", empty),
        listed("written with `d 0.5`, since how see-through is not known", "material", of(|m| m.see_through)),
        listed("two-sided, which OBJ cannot say", "material", of(|m| m.two_sided)),
    ];
    lines.into_iter().flatten().collect()
}

fn materials(scene: &Scene<Solid>, names: &[String]) -> String {
    let mut text = String::new();
    for (material, name) in scene.materials().iter().zip(names) {
        let [r, g, b] = material.color;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "newmtl {name}\nKd {r} {g} {b}");
        if material.see_through {
            text += "d 0.5\n";
        }
    }
    text
}

fn obj(scene: &Scene<Solid>, names: &Names, origin: DVec3, out: &Path, to: &mut dyn Write) -> io::Result<()> {
    writeln!(to, "# {}: {} triangles, ids in this order", on_a_line(scene.name()), scene.prim_count())?;
    let library = out.with_extension("mtl");
    writeln!(to, "mtllib {}", library.file_name().unwrap_or_default().to_string_lossy())?;
    for point in scene.points() {
        let [x, y, z] = [0, 1, 2].map(|a| coordinate(point.get(a), origin[a]));
        writeln!(to, "v {x} {y} {z}")?;
    }
    let (mut object, mut material, mut in_group) = (None, None, "");
    for prim in (0..scene.prim_count() as u32).map(PrimId) {
        if object.replace(scene.object_of(prim)) != Some(scene.object_of(prim)) {
            let (name, group) = &names.objects[scene.object_of(prim).at()];
            writeln!(to, "o {name}")?;
            if group != in_group {
                writeln!(to, "{}", format!("g {group}").trim_end())?;
                in_group = group;
            }
        }
        if material.replace(scene.material_of(prim)) != Some(scene.material_of(prim)) {
            writeln!(to, "usemtl {}", names.materials[scene.material_of(prim).at()])?;
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
    // Colors and motions go by name.
    let mut taken = BTreeSet::new();
    let names: Vec<String> =
        scene.objects().iter().map(|o| unique(&o.name, &mut taken, |name| name)).collect();
    head.insert("object_names".into(), names.iter().map(|n| Json::from(&**n)).collect());
    head.insert("colors".into(), colors(scene, &names, objects));
    head.insert("motions".into(), motions(scene, &names));
    let of = |is: fn(&Scene<Flat>, PrimId) -> bool| {
        let has = |prims: &&Vec<u32>| prims.first().is_some_and(|p| is(scene, PrimId(*p)));
        names
            .iter()
            .zip(objects)
            .filter(|(_, prims)| has(prims))
            .map(|(name, _)| Json::from(&**name))
            .collect()
    };
    head.insert("see_through".into(), of(|scene, p| scene.is_see_through(p)));
    head.insert("two_sided".into(), of(|scene, p| scene.is_two_sided(p)));
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
fn colors(scene: &Scene<Flat>, names: &[String], objects: &[Vec<u32>]) -> Json {
    let color = |prim: &u32| scene.color_of(PrimId(*prim)).map(number).to_vec();
    let colors = names.iter().zip(objects).filter_map(|(name, prims)| Some((name, color(prims.first()?))));
    json!(colors.collect::<BTreeMap<_, _>>())
}

/// Frames by object name: x, y and degrees.
fn motions(scene: &Scene<Flat>, names: &[String]) -> Json {
    let frame = |pose: &crate::scene::Pose| {
        let degrees = (2.0 * f64::from(pose.rotation[2]).atan2(f64::from(pose.rotation[3]))).to_degrees();
        json!([number(pose.translation[0]), number(pose.translation[1]), (degrees * 1e4).round() / 1e4])
    };
    let moving = scene
        .objects()
        .iter()
        .zip(names)
        .filter_map(|(o, name)| Some((name, o.motion.as_ref()?.iter().map(frame).collect::<Vec<_>>())));
    json!(moving.collect::<BTreeMap<_, _>>())
}
