//! How fast a model of a million triangles is read, beside `tobj` and `gltf` alone, which check less and make
//! no scene: in turn, out of memory, medians.
//! `cargo bench --no-default-features --bench loading`.

use std::fmt::Write as _;
use std::hint::black_box;

use cullscope::geometry::Solid;
use cullscope::measure::timing::paired;
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, load, load_bytes};
use serde_json::json;

const ROUNDS: usize = 7;

/// The scene as OBJ text.
fn obj(scene: &Scene<Solid>) -> Vec<u8> {
    let mut text = String::new();
    for p in scene.points() {
        _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for &prim in scene.live() {
        let [a, b, c] = scene.corners(prim).expect("live").map(|c| c + 1);
        _ = writeln!(text, "f {a} {b} {c}");
    }
    text.into_bytes()
}

/// The scene as GLB: one mesh of 32-bit indices.
fn glb(scene: &Scene<Solid>) -> Vec<u8> {
    let points: Vec<u8> =
        scene.points().iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    let corners = scene.live().iter().flat_map(|&p| scene.corners(p).expect("live"));
    let indices: Vec<u8> = corners.flat_map(u32::to_le_bytes).collect();
    let bounds = scene.bounds();
    let mut json = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": scene.points().len(), "type": "VEC3",
             "min": bounds.min.to_array(), "max": bounds.max.to_array()},
            {"bufferView": 1, "componentType": 5125, "count": indices.len() / 4, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": points.len()},
            {"buffer": 0, "byteOffset": points.len(), "byteLength": indices.len()},
        ],
        "buffers": [{"byteLength": points.len() + indices.len()}],
    })
    .to_string();
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let blob = [points, indices].concat();
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut bytes = b"glTF".to_vec();
    bytes.extend([word(2), word(28 + json.len() + blob.len()), word(json.len())].concat());
    bytes.extend(b"JSON");
    bytes.extend(json.as_bytes());
    bytes.extend(word(blob.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(blob);
    bytes
}

fn ours(bytes: &[u8], source: &str) -> usize {
    match load_bytes(bytes, source, &LoadOptions::default(), &Quiet).expect("a valid model") {
        AnyScene::Solid(scene) => scene.live().len(),
        AnyScene::Flat(_) => 0,
    }
}

fn tobj_alone(bytes: &[u8]) -> usize {
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let (models, _) =
        tobj::load_obj_buf(&mut &bytes[..], &options, |_| Ok(Default::default())).expect("a model");
    models.iter().map(|m| black_box(&m.mesh.indices).len() / 3).sum()
}

fn gltf_alone(bytes: &[u8]) -> usize {
    let file = gltf::Gltf::from_slice(bytes).expect("a model");
    let (mut count, mut sum) = (0, [0f32; 3]);
    for mesh in file.meshes() {
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|_| file.blob.as_deref());
            let points: Vec<[f32; 3]> = reader.read_positions().expect("points").collect();
            let indices: Vec<u32> = reader.read_indices().expect("indices").into_u32().collect();
            sum = black_box(points)[0];
            count += black_box(indices).len() / 3;
        }
    }
    black_box(sum);
    count
}

fn main() {
    let made = load("generate:city?polygons=1000000", &LoadOptions::default(), &Quiet).expect("a city");
    let AnyScene::Solid(scene) = made else { panic!("a model in space") };
    type Alone = fn(&[u8]) -> usize;
    let pairs: [(&str, &str, Vec<u8>, Alone); 2] =
        [("m.obj", "tobj", obj(&scene), tobj_alone), ("m.glb", "gltf", glb(&scene), gltf_alone)];
    for (source, peer, bytes, alone) in &pairs {
        assert_eq!(ours(bytes, source), alone(bytes), "{source}: both read the same triangles");
        let times = paired(ROUNDS, || _ = ours(bytes, source), || _ = alone(bytes));
        let megabytes = bytes.len() as f64 / 1e6;
        println!(
            "{source}: {} triangles, {megabytes:.1} MB: ours {:.0} ms ({:.0} MB/s), {peer} alone {:.0} ms \
             ({:.0} MB/s): {:.2} of its time",
            scene.live().len(),
            times.a_ms,
            megabytes / times.a_ms * 1e3,
            times.b_ms,
            megabytes / times.b_ms * 1e3,
            1.0 / times.ratio,
        );
    }
}
