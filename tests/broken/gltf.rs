//! Broken glTF and GLB files, made from a small valid one.

use cullscope::geometry::{PrimId, Vector};
use cullscope::scene::Dropped::{NotFinite, OutOfRange};
use cullscope::scene::Motion;

use super::{counts, error, solid};

/// Base64 of these bytes, without padding.
pub fn base64(bytes: &[u8]) -> String {
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0u32, |w, b| w << 8 | u32::from(*b)) << (8 * (3 - chunk.len()));
        (0..=chunk.len()).for_each(|k| out.push(digits[(word >> (18 - 6 * k) & 63) as usize] as char));
    }
    out
}

/// Four points of a square and six indices of 16 bits: 60 bytes.
pub fn buffer() -> Vec<u8> {
    let points: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
    points.iter().flat_map(|p| p.to_le_bytes()).chain(indices.iter().flat_map(|i| i.to_le_bytes())).collect()
}

/// A valid file of two triangles.
pub fn valid() -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"name":"house","children":[1],"translation":[10,0,0]}},{{"name":"wall","mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
"materials":[{{"name":"brick","pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.25,0.125,1]}}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],
"buffers":[{{"byteLength":60,"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
        base64(&buffer())
    )
}

/// The valid file as a GLB.
pub fn glb() -> Vec<u8> {
    let text = valid();
    let at = text.find(",\"uri\"").expect("a uri");
    let mut text = format!("{}}}]}}", &text[..at]).into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &buffer())] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    let length = (out.len() as u32).to_le_bytes();
    out[8..12].copy_from_slice(&length);
    out
}

fn changed(from: &str, to: &str) -> String {
    let text = valid();
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

#[test]
fn the_valid_file_loads_both_ways() {
    for (source, bytes) in [("m.gltf", valid().into_bytes()), ("m.glb", glb()), ("wrong_name.gltf", glb())] {
        let scene = solid(source, &bytes);
        assert_eq!(counts(&scene), (2, 2, vec![]), "{source}");
        assert_eq!((scene.objects()[0].name.as_str(), scene.objects()[0].group.as_str()), ("wall", "house"));
        assert_eq!(scene.color_of(PrimId(0)), [0.5, 0.25, 0.125]);
        assert_eq!(scene.bounds().min.to_array(), [10.0, 0.0, 0.0]);
    }
}

#[test]
fn strips_fans_and_mirrors_keep_their_winding() {
    for (mode, indices, count) in [(5, [0u16, 1, 3, 2, 0, 0], 4), (6, [0, 1, 2, 3, 0, 0], 4)] {
        let mut bytes = buffer();
        bytes[48..].copy_from_slice(&indices.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<_>>());
        let text = changed("\"indices\":1", &format!("\"mode\":{mode},\"indices\":1"))
            .replace("\"count\":6", &format!("\"count\":{count}"));
        let text = text.replace(&base64(&buffer()), &base64(&bytes));
        let scene = solid("m.gltf", text.as_bytes());
        assert_eq!(scene.live().len(), 2);
        assert!(scene.live().iter().all(|p| scene.normal(*p).get(2) > 0.0), "mode {mode}");
        let mirrored = text.replace("\"translation\":[10,0,0]", "\"scale\":[-1,1,1]");
        let scene = solid("m.gltf", mirrored.as_bytes());
        assert!(
            scene.live().iter().all(|p| scene.normal(*p).get(2) > 0.0),
            "a mirrored front is still a front"
        );
    }
}

#[test]
fn broken_files_are_refused() {
    let many: String = "1,".repeat(2000);
    let cases = [
        (changed("\"version\":\"2.0\"", "\"version\":\"1.0\""), "m.gltf: glTF 1.0 is not supported, only 2"),
        (
            changed(
                "\"scene\":0",
                "\"extensionsUsed\":[\"ACME_shape\"],\"extensionsRequired\":[\"ACME_shape\"],\"scene\":0",
            ),
            "m.gltf: it requires the extension ACME_shape, which is not read; export it without, or",
        ),
        (changed("\"children\":[1]", "\"children\":[0]"), "m.gltf: node 0 is in the tree twice"),
        (changed("\"children\":[1]", "\"children\":[1,1]"), "m.gltf: node 1 is in the tree twice"),
        (
            changed("\"indices\":1", "\"indices\":1,\"mode\":1"),
            "m.gltf: it has no triangles in its scene (1 mesh, 2 nodes); 1 primitive of points or lines \
             left out (mesh 0)",
        ),
        (
            changed("\"nodes\":[0]", "\"nodes\":[]"),
            "m.gltf: it has no triangles in its scene (1 mesh, 2 nodes); 1 mesh is shown by no node of the \
             scene (mesh 0)",
        ),
        (
            changed("\"byteLength\":60", "\"byteLength\":61"),
            "m.gltf: buffer 0 should have 61 bytes, but there are only 60",
        ),
        (
            changed("\"count\":6", "\"count\":7"),
            "m.gltf: mesh 0, primitive 0: accessor 1: 7 items of 2 bytes do not fit into buffer view 1",
        ),
        (
            changed("\"count\":4,", "\"count\":18446744073709551615,"),
            "m.gltf: mesh 0, primitive 0: its instances come to over 33554432 points or corners",
        ),
        (
            changed(
                "\"bufferView\":0,\"componentType\":5126,\"count\":4,",
                "\"componentType\":5126,\"count\":20000000,",
            ),
            "m.gltf: mesh 0, primitive 0: accessor 0: 20000000 items and no data, out of proportion to the",
        ),
        (
            changed(
                "\"bufferView\":0,\"componentType\":5126,\"count\":4,",
                "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5123},\
                 \"values\":{\"bufferView\":0}},\"componentType\":5126,\"count\":20000000,",
            ),
            "m.gltf: mesh 0, primitive 0: accessor 0: 20000000 items and no data, out of proportion",
        ),
        (
            changed("\"byteOffset\":48,", "\"byteOffset\":49,"),
            "m.gltf: mesh 0, primitive 0: accessor 1: buffer view 1 lies outside of buffer 0",
        ),
        (
            changed("\"type\":\"VEC3\"", "\"type\":\"VEC2\"")
                .replace("\"min\":[0,0,0],\"max\":[1,1,0]", "\"min\":[0,0],\"max\":[1,1]"),
            "m.gltf: mesh 0, primitive 0: accessor 0: needs 3 numbers an item",
        ),
        (
            changed("\"componentType\":5123", "\"componentType\":5126"),
            "m.gltf: mesh 0, primitive 0: accessor 1: its numbers must be unsigned and whole",
        ),
        (
            changed("base64,", "base64,!!!"),
            "m.gltf: buffer 0: its base64 is broken: Invalid symbol 33, offset 0.",
        ),
        (changed(";base64,", ","), "m.gltf: buffer 0: only base64 data URIs are read"),
        (changed("data:application/octet-stream;base64,", "../"), "m.gltf: buffer file"),
        (
            changed("\"POSITION\":0", "\"POSITION\":7"),
            "m.gltf: mesh 0, primitive 0: there is no accessor 7, but only 2",
        ),
        (changed("\"mesh\":0", "\"mesh\":5"), "m.gltf: node 1 shows mesh 5, but there are only 1"),
        (
            changed("\"buffer\":0,\"byteOffset\":48", "\"buffer\":3,\"byteOffset\":48"),
            "m.gltf: mesh 0, primitive 0: accessor 1: there is no buffer 3",
        ),
        (changed("\"VEC3\"", "\"VEC9\""), "m.gltf: mesh 0, primitive 0: accessor 0: needs 3 numbers an item"),
        ("".to_owned(), "m.gltf:1: EOF while parsing a value"),
        ("{\n\"asset\":{\"version\":\"2.0\"},\n\"nodes\":[}".to_owned(), "m.gltf:3: expected value"),
        (changed("\"nodes\":[0]", &format!("\"nodes\":[{many}1]")), "m.gltf: node 1 is in the tree twice"),
    ];
    for (text, want) in cases {
        let said = error("m.gltf", text.as_bytes());
        assert!(said.starts_with(want), "`{said}` should begin with `{want}`");
    }
}

#[test]
fn broken_containers_are_refused() {
    let good = glb();
    let with = |at: usize, bytes: [u8; 4]| {
        let mut out = good.clone();
        out[at..at + 4].copy_from_slice(&bytes);
        out
    };
    let cases = [
        (good[..7].to_vec(), "the GLB header is cut off"),
        (with(4, [1, 0, 0, 0]), "GLB version 1 is not supported, only 2"),
        (with(8, [12, 0, 0, 0]), "the GLB has no JSON chunk"),
        (with(8, [0xff; 4]), "the GLB says it has 4294967295 bytes, but the file has "),
        (good[..good.len() - 1].to_vec(), "the GLB says it has "),
        (
            with(12, [0xff; 4]),
            "the GLB chunk at byte 12 says it has 4294967295 bytes, but the file ends before",
        ),
        (with(16, *b"ABCD"), "the GLB has no JSON chunk"),
    ];
    for (bytes, want) in cases {
        let said = error("m.glb", &bytes);
        assert!(said.starts_with(&format!("m.glb: {want}")), "`{said}` should begin with `{want}`");
    }
    let bin = good.len() - 64;
    assert_eq!(&good[bin..bin + 4], b"BIN\0");
    assert_eq!(
        error("m.glb", &with(bin, *b"ABC\0")),
        "m.glb: buffer 0 is the binary chunk, but there is none"
    );
}

#[test]
fn bad_triangles_are_dropped_and_keep_their_ids() {
    let mut bytes = buffer();
    bytes[48 + 10] = 9;
    let far = valid().replace(&base64(&buffer()), &base64(&bytes));
    assert_eq!(counts(&solid("m.gltf", far.as_bytes())), (2, 1, vec![(OutOfRange, 1)]));
    let mut bytes = buffer();
    bytes[36..40].copy_from_slice(&f32::NAN.to_le_bytes());
    let nan = valid().replace(&base64(&buffer()), &base64(&bytes));
    assert_eq!(counts(&solid("m.gltf", nan.as_bytes())), (2, 1, vec![(NotFinite, 1)]));
    let spare = changed("\"count\":6", "\"count\":5");
    let scene = solid("m.gltf", spare.as_bytes());
    assert_eq!(counts(&scene), (1, 1, vec![]));
    assert_eq!(scene.report().notes, ["1 primitive ends with corners that make no triangle (mesh 0)"]);
}

#[test]
fn sparse_values_are_bounds_checked() {
    // Index 3 moves to (0, 2, 0); then index 4, which is not there.
    for (index, ok) in [(3u8, true), (4, false)] {
        let mut bytes = buffer();
        bytes.extend([index, 0, 0, 0]);
        bytes.extend([0.0f32, 2.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
        let text = valid()
            .replace(&base64(&buffer()), &base64(&bytes))
            .replace("\"byteLength\":60", "\"byteLength\":76")
            .replace(
                "\"byteLength\":12}]",
                "\"byteLength\":12},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":4},{\"buffer\":0,\
                 \"byteOffset\":64,\"byteLength\":12}]",
            )
            .replace(
                "\"max\":[1,1,0]}",
                "\"max\":[1,2,0],\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":2,\
                 \"componentType\":5121},\"values\":{\"bufferView\":3}}}",
            );
        if ok {
            assert_eq!(solid("m.gltf", text.as_bytes()).bounds().max.to_array(), [11.0, 2.0, 0.0]);
        } else {
            assert_eq!(
                error("m.gltf", text.as_bytes()),
                "m.gltf: mesh 0, primitive 0: accessor 0: sparse index 4 is past its 4 items"
            );
        }
    }
}

/// The valid file with an animation of one property of the wall.
pub fn animated(path: &str) -> String {
    let mut bytes = buffer();
    bytes.extend([0.0f32, 1.0].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend([0.0f32, 0.0, 0.0, 24.0, 0.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
    valid()
        .replace(&base64(&buffer()), &base64(&bytes))
        .replace("\"byteLength\":60", "\"byteLength\":92")
        .replace(
            "\"byteLength\":12}]",
            "\"byteLength\":12},{\"buffer\":0,\"byteOffset\":60,\
             \"byteLength\":8},{\"buffer\":0,\"byteOffset\":68,\"byteLength\":24}]",
        )
        .replace(
            "\"type\":\"SCALAR\"}]",
            "\"type\":\"SCALAR\"},{\"bufferView\":2,\"componentType\":5126,\"count\":2,\
                 \"type\":\"SCALAR\",\"min\":[0],\"max\":[1]},{\"bufferView\":3,\"componentType\":5126,\
                  \"count\":2,\"type\":\"VEC3\"}]",
        )
        .replace(
            "\"scene\":0",
            &format!(
                "\"animations\":[{{\"channels\":[{{\"sampler\":0,\"target\":{{\"node\":1,\
                 \"path\":\"{path}\"}}}}],\"samplers\":[{{\"input\":2,\"output\":3}}]}}],\"scene\":0"
            ),
        )
}

#[test]
fn a_rigid_animation_becomes_a_motion() {
    let scene = solid("m.gltf", animated("translation").as_bytes());
    assert_eq!(scene.frame_count(), 25);
    assert_eq!(Motion::new(&scene).at(12).bounds().min.to_array(), [22.0, 0.0, 0.0]);
    for bad in [animated("sideways"), animated("scale").replace("\"node\":1", "\"node\":77")] {
        let still = solid("m.gltf", bad.as_bytes());
        assert_eq!(still.frame_count(), 1);
        assert_eq!(
            still.report().notes,
            ["animation left out: it names a sampler, node or property that is not there"]
        );
    }
    let grown = solid("m.gltf", animated("scale").as_bytes());
    assert_eq!(grown.frame_count(), 1);
    assert_eq!(grown.report().notes, ["1 object scaled by the animation stands still (`wall`)"]);
}

#[test]
fn a_chunk_that_is_not_padded_is_followed_at_once() {
    // Section 4.4.3.1 asks for padding; some writers leave it out, others do not count it.
    let good = glb();
    let length = u32::from_le_bytes([good[12], good[13], good[14], good[15]]) as usize;
    assert_eq!(length % 4, 0);
    for (spaces, padding) in [(1, 0), (2, 0), (1, 3), (2, 2)] {
        let mut bytes = good[..20 + length].to_vec();
        bytes.extend(vec![b' '; spaces]);
        bytes[12..16].copy_from_slice(&((length + spaces) as u32).to_le_bytes());
        bytes.extend(vec![0; padding]);
        bytes.extend(&good[20 + length..]);
        let whole = (bytes.len() as u32).to_le_bytes();
        bytes[8..12].copy_from_slice(&whole);
        assert_eq!(counts(&solid("m.glb", &bytes)), (2, 2, vec![]), "{spaces} {padding}");
    }
}
