//! Valid glTF files of every kind, made here, with the right values and where they stand in the "glTF 2.0
//! Specification" (Khronos, 2021) or an extension of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cullscope::geometry::{PrimId, Solid, Vector};
use cullscope::scene::{AnyScene, LoadOptions, Motion, Progress, Quiet, Scene, SceneError, load, load_bytes};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{self, IndexEncoding, VertexEncoding};
use serde_json::{Value, json};

use super::files::folder;
use super::gltf::base64;
use super::{error, solid};

const F32: u32 = 5126;
const U16: u32 = 5123;
const U8: u32 = 5121;

fn little(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A file in the making.
pub struct Made {
    pub json: Value,
    bytes: Vec<u8>,
}

impl Made {
    /// A square of two triangles from (0, 0, 0) to (1, 1, 0), shown by one node.
    pub fn square() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "panel", "mesh": 0}],
            "meshes": [{"name": "square", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [], "bufferViews": []
        });
        let mut made = Self { json, bytes: Vec::new() };
        made.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        let corners: Vec<u8> = [0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect();
        made.accessor(U16, "SCALAR", 6, &corners);
        made
    }
    fn list(&mut self, key: &str) -> &mut Vec<Value> {
        self.json[key].as_array_mut().expect("a list")
    }
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        self.list("bufferViews").push(view);
        self.list("bufferViews").len() - 1
    }
    fn accessor(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.list("accessors")
            .push(json!({"bufferView": view, "componentType": component, "type": shape, "count": count}));
        self.list("accessors").len() - 1
    }
    pub fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let width = match shape {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(F32, shape, values.len() / width, &little(values))
    }
    /// An animation of node 0, whose values are of this shape.
    pub fn animate(&mut self, path: &str, kind: &str, times: &[f32], shape: &str, values: &[f32]) {
        let (input, output) = (self.floats("SCALAR", times), self.floats(shape, values));
        self.json["animations"] = json!([{"name": "swing",
            "samplers": [{"input": input, "output": output, "interpolation": kind}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}]}]);
    }
    pub fn text(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.bytes));
        if json["buffers"].is_null() {
            json["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        }
        json.to_string().into_bytes()
    }
    fn scene(&self) -> Arc<Scene<Solid>> {
        solid("m.gltf", &self.text())
    }
}

fn bounds(scene: &Scene<Solid>) -> [[f32; 3]; 2] {
    [scene.bounds().min.to_array(), scene.bounds().max.to_array()]
}

fn names(scene: &Scene<Solid>) -> Vec<&str> {
    scene.objects().iter().map(|o| o.name.as_str()).collect()
}

#[test]
fn nothing_valid_is_refused() {
    // `extras` may be any value (Extras, JSON schema); `_NAME` belongs to applications (3.7.2.1); an accessor
    // without a view is zeros (3.6.2.1); a scene need not have nodes (scene schema); a channel without a node
    // is ignored (5.7); a texture's source may be an extension's (5.29).
    let square = Made::square().scene();
    type Change<'a> = &'a dyn Fn(&mut Made);
    let change: [(&str, Change); 9] = [
        ("extras", &|m| {
            for place in ["", "/asset", "/nodes/0", "/meshes/0/primitives/0", "/accessors/1", "/scenes/0"] {
                m.json.pointer_mut(place).expect("a part")["extras"] = json!("west wing");
            }
            m.json["meshes"][0]["extras"] = json!(7);
        }),
        ("own attribute", &|m| {
            m.json["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = json!(0);
        }),
        ("zeros", &|m| {
            m.list("accessors").push(json!({"componentType": F32, "type": "VEC2", "count": 4}));
            m.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(2);
        }),
        ("no nodes", &|m| m.json["scenes"] = json!([{"nodes": [0]}, {"name": "spare"}])),
        ("no node", &|m| {
            m.animate("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0; 6]);
            m.json["animations"][0]["channels"][0]["target"] = json!({"path": "translation"});
        }),
        ("texture", &|m| {
            m.json["images"] = json!([{"uri": "a.webp"}]);
            m.json["textures"] = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
        }),
        ("no scene", &|m| {
            m.json["scenes"] = json!([]);
            m.json["scene"] = Value::Null;
        }),
        ("min and max", &|m| m.json["accessors"][0]["min"] = json!([0, 0])),
        ("mark", &|m| m.json["asset"]["generator"] = json!("\u{feff}")),
    ];
    for (what, change) in change {
        let mut made = Made::square();
        change(&mut made);
        let scene = made.scene();
        assert_eq!((scene.live().len(), bounds(&scene)), (2, bounds(&square)), "{what}");
    }
    // Extensions on data, textures and materials, and on how things look or behave.
    for extension in [
        "EXT_structural_metadata",
        "EXT_mesh_features",
        "EXT_instance_features",
        "KHR_texture_basisu",
        "KHR_texture_transform",
        "EXT_texture_webp",
        "MSFT_texture_dds",
        "KHR_materials_unlit",
        "KHR_lights_punctual",
        "KHR_animation_pointer",
        "KHR_xmp_json_ld",
        "KHR_mesh_quantization",
    ] {
        let mut made = Made::square();
        made.json["extensionsRequired"] = json!([extension]);
        made.json["extensionsUsed"] = json!([extension, "ACME_paint"]);
        let notes = made.scene().report().notes.clone();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].starts_with("extensions left out: ACME_paint"), "{notes:?}");
    }
}

#[test]
fn a_fault_in_what_is_left_out_is_a_note() {
    let cases = [
        ("/samplers", json!([{"wrapS": 0}]), "1 of 1 samplers not valid (the first is samplers[0]: what it"),
        ("/textures", json!([{"source": 9}]), "1 of 1 textures not valid (the first is textures[0]: what it"),
        (
            "/images",
            json!([{}, {"uri": 3}]),
            "2 of 2 images not valid (the first is images[0]: what it names",
        ),
        (
            "/cameras",
            json!([{"perspective": {}}]),
            "1 of 1 cameras not valid (the first is cameras[0]: missing",
        ),
        (
            "/skins",
            json!([{"joints": [4]}]),
            "1 of 1 skins not valid (the first is skins[0]: what it names is",
        ),
        (
            "/materials",
            json!([{"doubleSided": 2}]),
            "1 of 1 materials not valid (the first is materials[0]: inv",
        ),
    ];
    let mut made = Made::square();
    for (place, value, _) in &cases {
        made.json[place.trim_start_matches('/')] = value.clone();
    }
    made.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(77);
    made.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let scene = made.scene();
    assert_eq!(scene.live().len(), 2);
    let notes = &scene.report().notes;
    for (_, _, want) in &cases {
        assert!(notes.iter().any(|n| n.starts_with(want)), "`{want}` in {notes:#?}");
    }
    assert!(
        notes.contains(&"1 attribute of primitives with accessors that are not there".into()),
        "{notes:?}"
    );
    assert_eq!(scene.materials()[0].name, "material_0");
}

#[test]
fn what_a_file_is_not_is_said() {
    let mut web = Made::square();
    web.json["buffers"] = json!([{"byteLength": 60, "uri": "https://example.com/a.bin"}]);
    let one = br#"{"asset":{"version":"1.0"},"scenes":{"s":{"nodes":["n"]}},"nodes":{"n":{"meshes":[]}}}"#;
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 36\n";
    let cases: [(&[u8], &str); 6] = [
        (one, "m.gltf: glTF 1.0 is not supported, only 2"),
        (
            &web.text(),
            "m.gltf: buffer file https://example.com/a.bin: it is an address on the web, and nothing is \
             fetched; put `a.bin` beside the model and name it there",
        ),
        (
            br#"{"asset":{"version":1,"generator":"old"},"nodes":{},"meshes":{}}"#,
            "m.gltf: glTF 1 is not supported, only 2",
        ),
        (pointer, "m.gltf: is a Git LFS pointer, not the file itself; `git lfs pull` brings the file"),
        (b"\x1f\x8b\x08\0", "m.gltf: is compressed with gzip; unpack it first (`gunzip`)"),
        (b"{\"scene\":0}", "m.gltf: it does not say which version of glTF it is (`asset.version`)"),
    ];
    for (bytes, want) in cases {
        assert_eq!(error("m.gltf", bytes), want);
    }
    // The same of a buffer beside the model and of every other kind of file.
    let home = folder("pointers");
    let mut made = Made::square();
    made.json["buffers"] = json!([{"byteLength": 60, "uri": "a.bin"}]);
    for (name, bytes) in [
        ("a.bin", pointer.to_vec()),
        ("m.gltf", made.text()),
        ("m.obj", pointer.to_vec()),
        ("m.glb", pointer.to_vec()),
        ("m.json", pointer.to_vec()),
    ] {
        std::fs::write(home.join(name), bytes).expect("written");
    }
    for name in ["m.gltf", "m.obj", "m.glb", "m.json"] {
        let path = home.join(name).to_string_lossy().into_owned();
        let said = load(&path, &LoadOptions::default(), &Quiet).expect_err("refused").to_string();
        assert!(said.contains("is a Git LFS pointer, not the file itself; `git lfs pull`"), "{said}");
    }
}

#[test]
fn only_the_first_buffer_may_be_the_binary_chunk() {
    // 3.6.1.2: "glTF Buffer referring to GLB-stored BIN chunk, MUST be the first element of buffers array".
    let mut made = Made::square();
    made.json["buffers"] = json!([{"byteLength": 4}, {"byteLength": 60}]);
    for view in made.list("bufferViews") {
        view["buffer"] = json!(1);
    }
    let (mut text, chunk) = (made.text(), made.bytes.clone());
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + text.len() as u32 + chunk.len() as u32).to_le_bytes());
    for (kind, part) in [(b"JSON", &text), (b"BIN\0", &chunk)] {
        glb.extend((part.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(part);
    }
    let said = error("m.glb", &glb);
    assert_eq!(said, "m.glb: buffer 1 has no URI, and only buffer 0 may be the binary chunk of a GLB");
}

#[test]
fn instances_are_objects() {
    // EXT_mesh_gpu_instancing: each is the node's transform times T · R · S of the instance.
    let mut made = Made::square();
    let moved = made.floats("VEC3", &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 5.0, 0.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turned = made.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half, 0.0, 0.0, 0.0, 1.0]);
    let scaled = made.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0, -1.0, 1.0]);
    made.json["nodes"][0]["translation"] = json!([10, 0, 0]);
    made.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing":
        {"attributes": {"TRANSLATION": moved, "ROTATION": turned, "SCALE": scaled}}});
    let scene = made.scene();
    assert_eq!((scene.live().len(), names(&scene)), (6, vec!["panel_0", "panel_1", "panel_2"]));
    assert_eq!(scene.objects()[2].group, "panel");
    // The second is twice as large and turned by a quarter to the left, about (15, 0, 0).
    let second = scene.prim_bounds(PrimId(2)).union(scene.prim_bounds(PrimId(3)));
    let off = |a: f32, b: f32| (a - b).abs() < 1e-5;
    assert!(off(second.min.x, 13.0) && off(second.max.x, 15.0) && off(second.max.y, 2.0), "{second:?}");
    // The third is mirrored, and still has its front in front.
    let third = scene.prim_bounds(PrimId(4));
    assert!(off(third.min.y, 4.0) && off(third.max.y, 5.0), "{third:?}");
    assert!(scene.live().iter().all(|p| scene.normal(*p).get(2) > 0.0), "a mirrored front is a front");
    made.json["accessors"][moved]["count"] = json!(2);
    let said = error("m.gltf", &made.text());
    assert_eq!(said, "m.gltf: node 0: its instances: their attributes have different counts");
}

/// The square bound to two joints: its lower points to the first, its upper ones to the second.
fn skinned() -> Made {
    let mut made = Made::square();
    let joints = made.accessor(U8, "VEC4", 4, &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let weights = made.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(4));
    let attributes = &mut made.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    made.json["skins"] = json!([{"joints": [1, 2]}]);
    made.json["nodes"] = json!([
        {"name": "panel", "mesh": 0, "skin": 0, "translation": [50, 0, 0], "scale": [100, 100, 100]},
        {"name": "hip", "translation": [0, 0, -6], "children": [2]},
        {"name": "head", "translation": [0, 2, 0]}
    ]);
    made.json["scenes"][0]["nodes"] = json!([0, 1]);
    made
}

#[test]
fn a_skinned_mesh_stands_at_its_joints() {
    // 3.7.3.3: "the transforms of the skinned mesh node are ignored"; each point is at the weighted sum of
    // joint world transform times inverse bind matrix.
    let made = skinned();
    assert_eq!(bounds(&made.scene()), [[0.0, 0.0, -6.0], [1.0, 3.0, -6.0]]);
    let mut bound = skinned();
    let mut inverse = [0.0f32; 32];
    for k in 0..4 {
        (inverse[5 * k], inverse[16 + 5 * k]) = (1.0, 1.0);
    }
    inverse[16 + 13] = -2.0;
    let matrices = bound.floats("MAT4", &inverse);
    bound.json["skins"][0]["inverseBindMatrices"] = json!(matrices);
    assert_eq!(bounds(&bound.scene()), [[0.0, 0.0, -6.0], [1.0, 1.0, -6.0]]);
    // Joints that mirror turn the triangles over.
    let mut mirrored = skinned();
    mirrored.json["nodes"][1]["scale"] = json!([-1, 1, 1]);
    let scene = mirrored.scene();
    assert!(scene.live().iter().all(|p| scene.normal(*p).get(2) > 0.0), "a mirrored front is a front");
    let mut few = skinned();
    few.json["skins"][0]["joints"] = json!([1]);
    assert_eq!(
        error("m.gltf", &few.text()),
        "m.gltf: node 0: a point follows joint 1, but its skin has only 1"
    );
    let mut bad = skinned();
    bad.json["skins"][0]["joints"] = json!([1, 9]);
    let scene = bad.scene();
    assert_eq!(bounds(&scene)[0], [50.0, 0.0, 0.0]);
    let note = "1 skin is not valid, so its meshes stand where their nodes are (skin 0: there is no node 9 \
                for a joint)";
    assert!(scene.report().notes.contains(&note.to_owned()), "{:?}", scene.report().notes);
}

#[test]
fn the_animation_of_joints_is_named_as_lost() {
    let mut made = skinned();
    made.animate("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]);
    // The skinned node's own motion does not count either.
    assert_eq!(made.scene().frame_count(), 1);
    assert_eq!(made.scene().report().notes, [""; 0]);
    made.json["animations"][0]["channels"][0]["target"]["node"] = json!(1);
    let scene = made.scene();
    assert_eq!(scene.frame_count(), 1);
    let note = "the animation of the joints of 1 skinned object left out: shown at rest";
    assert_eq!(scene.report().notes, [note]);
}

#[test]
fn morph_targets_stand_at_their_default_weights() {
    // 3.7.2.2: mesh weights are the default, a node's override them; a target may be sparse.
    let mut made = Made::square();
    let up = made.floats("VEC3", &[0.0, 0.0, 4.0].repeat(4));
    let (at, by) = (made.view(&[2, 0, 0, 0]), made.view(&little(&[10.0, 0.0, 0.0])));
    made.list("accessors").push(json!({"componentType": F32, "type": "VEC3", "count": 4, "sparse":
        {"count": 1, "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": by}}}));
    made.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": up}, {"POSITION": up + 1}]);
    assert_eq!(bounds(&made.scene()), [[0.0; 3], [1.0, 1.0, 0.0]]);
    made.json["meshes"][0]["weights"] = json!([0.5, 0]);
    assert_eq!(bounds(&made.scene()), [[0.0, 0.0, 2.0], [1.0, 1.0, 2.0]]);
    made.json["nodes"][0]["weights"] = json!([0, 1]);
    let scene = made.scene();
    assert_eq!(bounds(&scene), [[0.0; 3], [11.0, 1.0, 0.0]]);
    let note = "1 primitive with morph targets, shown at the default weights (`square`)";
    assert_eq!(scene.report().notes, [note]);
}

#[test]
fn sparse_indices_and_sparse_zeros_are_read() {
    // 3.6.2.3: sparse values replace those of the view, or zeros where there is none.
    let mut made = Made::square();
    let (at, to) = (made.view(&[5]), made.view(&1u16.to_le_bytes()));
    made.json["accessors"][1]["sparse"] = json!({"count": 1,
        "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": to}});
    let scene = made.scene();
    assert_eq!(scene.corners(PrimId(1)), Some([0, 2, 1]), "the last corner is point 1");
    let mut made = Made::square();
    let (at, to) = (made.view(&[1, 2]), made.view(&little(&[3.0, 0.0, 0.0, 0.0, 3.0, 0.0])));
    made.json["accessors"][0] = json!({"componentType": F32, "type": "VEC3", "count": 4, "sparse":
        {"count": 2, "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": to}}});
    let scene = made.scene();
    assert_eq!((scene.live().len(), bounds(&scene)), (1, [[0.0; 3], [3.0, 3.0, 0.0]]));
}

/// Whether light comes through the square when it has this material, and whether it has a back.
fn material(material: &Value, with: impl FnOnce(&mut Made)) -> (bool, bool) {
    let mut made = Made::square();
    made.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    made.json["materials"] = json!([material]);
    made.json["images"] = json!([{"uri": "a.png"}, {"uri": "a.JPG"}]);
    made.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    with(&mut made);
    let scene = made.scene();
    let material = &scene.materials()[scene.material_of(PrimId(0)).at()];
    (material.see_through, !material.two_sided)
}

#[test]
fn materials_say_what_they_let_through() {
    // 3.9.4: OPAQUE ignores alpha, MASK compares it with the cutoff (0.5), BLEND covers by it; a texture may
    // hold any alpha, a JPEG none. KHR_materials_transmission: what is behind is seen.
    let factor = |alpha: f64| json!({"baseColorFactor": [1, 1, 1, alpha]});
    let texture = |index: u32| json!({"baseColorTexture": {"index": index}});
    let cases = [
        (json!({}), false),
        (json!({"pbrMetallicRoughness": factor(0.1)}), false),
        (json!({"alphaMode": "BLEND", "pbrMetallicRoughness": factor(0.9)}), true),
        (json!({"alphaMode": "BLEND", "pbrMetallicRoughness": factor(1.0)}), false),
        (json!({"alphaMode": "BLEND", "pbrMetallicRoughness": texture(0)}), true),
        (json!({"alphaMode": "BLEND", "pbrMetallicRoughness": texture(1)}), false),
        (json!({"alphaMode": "MASK", "pbrMetallicRoughness": factor(0.6)}), false),
        (json!({"alphaMode": "MASK", "pbrMetallicRoughness": factor(0.4)}), true),
        (json!({"alphaMode": "MASK", "alphaCutoff": 0.1, "pbrMetallicRoughness": factor(0.4)}), false),
        (json!({"alphaMode": "MASK", "pbrMetallicRoughness": texture(0)}), true),
        (json!({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.2}}}), true),
        (json!({"extensions": {"KHR_materials_transmission": {}}}), false),
        (
            json!({"alphaMode": "BLEND", "extensions": {"KHR_materials_pbrSpecularGlossiness":
                {"diffuseFactor": [1, 0, 0, 0.5]}}}),
            true,
        ),
    ];
    for (given, want) in cases {
        assert_eq!(material(&given, |_| ()), (want, true), "{given}");
    }
    // 3.9.5: a double-sided material has no back.
    assert_eq!(material(&json!({"doubleSided": true}), |_| ()), (false, false));
    // 3.9.2: the alpha of COLOR_0 multiplies that of the factor.
    for (alpha, mode, want) in
        [(0.3, "BLEND", true), (0.3, "MASK", true), (1.0, "BLEND", false), (0.3, "OPAQUE", false)]
    {
        let colors = |m: &mut Made| {
            let colors = m.floats("VEC4", &[1.0, 1.0, 1.0, alpha].repeat(4));
            m.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
        };
        assert_eq!(material(&json!({"alphaMode": mode}), colors), (want, true), "{alpha} {mode}");
    }
}

#[test]
fn colors_at_points_color_triangles() {
    // 3.9.2: COLOR_0 is a linear multiplier of the base color; a triangle takes the mean of its corners.
    let mut made = Made::square();
    let colors = [[255u8, 0, 0, 255], [255, 0, 0, 255], [255, 0, 0, 255], [255, 255, 255, 255]].concat();
    let colors = made.accessor(U8, "VEC4", 4, &colors);
    made.json["accessors"][colors]["normalized"] = json!(true);
    made.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    made.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    made.json["materials"] = json!([{"name": "paint",
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}}]);
    let scene = made.scene();
    assert_eq!(scene.color_of(PrimId(0)), [0.5, 0.0, 0.0]);
    let [r, g, b] = scene.color_of(PrimId(1));
    assert!(r == 0.5 && (g - 1.0 / 3.0).abs() < 1e-6 && g == b, "{r} {g} {b}");
    assert_eq!(
        scene.report().notes,
        ["colors at points: the mean of the corners for 2 faces, in 2 materials"]
    );
}

#[test]
fn hidden_nodes_are_left_out_with_all_below() {
    // KHR_node_visibility: "false" hides the node and everything below it.
    let mut made = Made::square();
    made.json["nodes"] = json!([
        {"name": "shown", "mesh": 0, "children": [1]},
        {"extensions": {"KHR_node_visibility": {"visible": false}}, "children": [2, 3]},
        {"mesh": 0, "translation": [5, 0, 0]},
        {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}}
    ]);
    let scene = made.scene();
    assert_eq!((scene.live().len(), names(&scene)), (2, vec!["shown"]));
    assert_eq!(scene.report().notes, ["2 nodes with a mesh or camera hidden by KHR_node_visibility"]);
}

#[test]
fn cameras_are_view_paths() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    // 3.10: a camera looks along −z of its node with +y up, whatever the node's scale; yfov in radians.
    let mut made = Made::square();
    made.json["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.25, "zfar": 80, "aspectRatio": 2}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}
    ]);
    made.json["nodes"] = json!([
        {"name": "dolly", "children": [1]},
        {"name": "eye", "camera": 0, "translation": [3, 0, 0], "scale": [2, 2, 2],
         "rotation": [0, half, 0, half]},
        {"camera": 1}, {"camera": 2}, {"mesh": 0}
    ]);
    made.json["scenes"][0]["nodes"] = json!([0, 2, 3, 4]);
    let scene = made.scene();
    let [eye, other] = scene.paths() else { panic!("{:?}", scene.paths()) };
    assert_eq!((eye.name.as_str(), eye.views.len(), other.name.as_str()), ("eye", 1, "camera_3"));
    let view = eye.views[0];
    assert_eq!((view.width, view.height, view.eye.fov), (1024, 512, 0.5));
    assert_eq!((view.eye.near, view.eye.far, view.eye.position.to_array()), (0.25, 80.0, [3.0, 0.0, 0.0]));
    assert!(
        (view.eye.forward() - glam::Vec3::NEG_X).length() < 1e-6,
        "a quarter to the left: {:?}",
        view.eye
    );
    assert!(other.views[0].eye.far > 2.0, "without zfar it sees without end");
    assert_eq!(scene.report().notes, ["1 camera left out: orthographic, or it cannot see"]);
    // Where the animation moves it, frame i of the path is frame i of the motion.
    made.animate("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0, 0.0, 0.0, 0.0, 24.0, 0.0]);
    let scene = made.scene();
    assert_eq!(scene.paths()[0].views.len(), 25);
    assert_eq!(scene.paths()[0].views[7].eye.position.to_array(), [3.0, 7.0, 0.0]);
}

#[test]
fn a_scene_can_be_chosen() {
    // 3.5.1: `scene` names the default; without it the first is loaded here.
    let mut made = Made::square();
    made.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [7, 0, 0]}]);
    made.json["scenes"] = json!([{"nodes": [0]}, {"name": "annex", "nodes": [1]}]);
    let from = |source: &str, made: &Made| bounds(&solid(source, &made.text()))[0][0];
    assert_eq!((from("m.gltf", &made), from("m.gltf?scene=1", &made)), (0.0, 7.0));
    made.json["scene"] = json!(1);
    assert_eq!((from("m.gltf", &made), from("m.gltf?scene=0", &made)), (7.0, 0.0));
    let note = "scene 1 `annex` of 2 is loaded; `?scene=NUMBER` after the file's name chooses another";
    assert!(made.scene().report().notes.contains(&note.to_owned()), "{:?}", made.scene().report().notes);
    assert_eq!(
        error("m.gltf?scene=2", &made.text()),
        "m.gltf?scene=2: it has no scene 2, but only 2 (the first is 0)"
    );
    made.json["scene"] = json!(5);
    assert_eq!(from("m.gltf", &made), 0.0);
    let home = folder("scenes");
    std::fs::write(home.join("m.gltf"), made.text()).expect("written");
    let path = format!("{}?scene=1", home.join("m.gltf").display());
    let Ok(AnyScene::Solid(scene)) = load(&path, &LoadOptions::default(), &Quiet) else { panic!("{path}") };
    assert_eq!((scene.name(), scene.source(), bounds(&scene)[0][0]), ("m", path.as_str(), 7.0));
}

#[test]
fn a_cubic_spline_goes_by_its_tangents() {
    // Appendix C.4: from 0 to 0 in one second with the tangents 8 and −8: at the middle 8/8 + 8/8 = 2.
    let mut made = Made::square();
    let values = [[0.0; 9], [0.0; 9]].concat();
    made.animate("translation", "CUBICSPLINE", &[0.0, 1.0], "VEC3", &values);
    let view = made.json["accessors"][3]["bufferView"].as_u64().expect("a view") as usize;
    let at = made.json["bufferViews"][view]["byteOffset"].as_u64().expect("an offset") as usize;
    // x of the first key's out-tangent, and of the second key's in-tangent.
    made.bytes[at + 24..at + 28].copy_from_slice(&8f32.to_le_bytes());
    made.bytes[at + 36..at + 40].copy_from_slice(&(-8f32).to_le_bytes());
    let scene = made.scene();
    let mut motion = Motion::new(&scene);
    assert_eq!(motion.at(12).bounds().min.to_array(), [2.0, 0.0, 0.0]);
    assert_eq!(motion.at(24).bounds().min.to_array(), [0.0; 3]);
}

#[test]
fn a_kind_of_loss_is_said_once() {
    let mut made = Made::square();
    let point = made.json["meshes"][0]["primitives"][0].clone();
    let mut lines = point.clone();
    lines["mode"] = json!(1);
    made.json["meshes"] = json!([{"name": "walls", "primitives": [point]},
        {"name": "wires", "primitives": [lines]}, {"primitives": [lines, lines]},
        {"name": "spare", "primitives": []}]);
    let nodes: Vec<Value> = (0..150).map(|k| json!({"mesh": k % 3})).collect();
    made.json["scenes"][0]["nodes"] = json!((0..150).collect::<Vec<_>>());
    made.json["nodes"] = json!(nodes);
    made.json["textures"] = json!([{"source": 0}, {"source": 0}]);
    made.json["images"] = json!([{"uri": "a.png"}]);
    made.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    let notes = made.scene().report().notes.clone();
    let want = [
        "1 mesh is shown by no node of the scene (`spare`)",
        "3 primitives of points or lines left out (`wires`, mesh 2)",
        "2 textures left out",
        "1 light left out",
    ];
    assert_eq!(notes, want);
}

#[test]
fn compressed_geometry_is_unpacked() {
    // KHR_draco_mesh_compression: the square, compressed by an encoder of its own.
    let draco = "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgEBAQADAwEwARADACiCmAAAAAAA/wcAAAAAAAAAAAAAAAA\
                 AAAAAgD8L";
    let mut made = Made::square();
    made.json["buffers"] =
        json!([{"byteLength": 75, "uri": format!("data:application/octet-stream;base64,{draco}")}]);
    made.json["bufferViews"] = json!([{"buffer": 0, "byteLength": 75}]);
    made.json["accessors"] = json!([{"componentType": F32, "type": "VEC3", "count": 4},
        {"componentType": U16, "type": "SCALAR", "count": 6}]);
    made.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    made.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    let scene = made.scene();
    assert_eq!((scene.live().len(), bounds(&scene)), (2, [[0.0; 3], [1.0, 1.0, 0.0]]));
    assert!(scene.live().iter().all(|p| scene.normal(*p).get(2) > 0.0), "fronts in front");
    made.json["bufferViews"][0]["byteLength"] = json!(40);
    let said = error("m.gltf", &made.text());
    assert!(said.starts_with("m.gltf: mesh 0, primitive 0: its Draco data cannot be unpacked: "), "{said}");
    // Where the accessor has a view, that is the same unpacked.
    let mut fallback = Made::square();
    fallback.json["meshes"][0]["primitives"][0]["extensions"] =
        made.json["meshes"][0]["primitives"][0]["extensions"].clone();
    assert_eq!(fallback.scene().live().len(), 2);
}

#[test]
fn compressed_views_are_unpacked() {
    // EXT_meshopt_compression: the view's own buffer may be a placeholder without data.
    let square = Made::square();
    let work = &mut Workspace::default();
    let positions = codec::encode_vertex_buffer(&square.bytes[..48], 4, 12, VertexEncoding::default(), work)
        .expect("encoded");
    let corners =
        codec::encode_index_buffer(&[0, 1, 2, 0, 2, 3], IndexEncoding::default(), work).expect("encoded");
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mut made = Made::square();
        made.bytes = [positions.clone(), corners.clone()].concat();
        let (first, whole) = (positions.len(), made.bytes.len());
        let uri = format!("data:application/octet-stream;base64,{}", base64(&made.bytes));
        made.json["buffers"] = json!([{"byteLength": whole, "uri": uri},
            {"byteLength": 60, "extensions": {(name): {"fallback": true}}}]);
        made.json["bufferViews"] = json!([
            {"buffer": 1, "byteLength": 48, "byteStride": 12, "extensions": {(name): {"buffer": 0,
                "byteLength": first, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}}},
            {"buffer": 1, "byteOffset": 48, "byteLength": 12, "extensions": {(name): {"buffer": 0,
                "byteOffset": first, "byteLength": whole - first, "byteStride": 2, "count": 6,
                "mode": "TRIANGLES"}}}
        ]);
        made.json["extensionsRequired"] = json!([name]);
        let scene = made.scene();
        assert_eq!((scene.live().len(), bounds(&scene)), (2, [[0.0; 3], [1.0, 1.0, 0.0]]), "{name}");
        made.json["bufferViews"][0]["extensions"][name]["byteLength"] = json!(20);
        let said = error("m.gltf", &made.text());
        assert!(said.contains("buffer view 0: its meshopt data cannot be unpacked: "), "{said}");
        made.json["bufferViews"][0]["extensions"][name]["count"] = json!(90_000_000);
        let said = error("m.gltf", &made.text());
        assert!(said.contains("out of proportion to the file"), "{said}");
    }
}

#[test]
fn time_and_memory_go_with_the_file() {
    // Frames are made only of nodes that move and carry something.
    let mut made = Made::square();
    made.animate("translation", "LINEAR", &[0.0, 25.0], "VEC3", &[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]);
    let mut nodes = vec![made.json["nodes"][0].clone()];
    nodes.resize(200_001, json!({}));
    made.json["nodes"] = json!(nodes);
    let text = made.text();
    let start = Instant::now();
    assert_eq!(solid("m.gltf", &text).frame_count(), 600);
    assert!(start.elapsed().as_secs_f64() < 5.0, "{:?}", start.elapsed());
    // Many channels that name one accessor of millions of zeros: the counts do not agree.
    let mut made = Made::square();
    made.animate("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0; 6]);
    made.list("accessors").push(json!({"componentType": F32, "type": "VEC3", "count": 900_000_000_u64}));
    let zeros = made.list("accessors").len() - 1;
    made.json["animations"][0]["samplers"][0]["output"] = json!(zeros);
    let channel = made.json["animations"][0]["channels"][0].clone();
    made.json["animations"][0]["channels"] = json!(vec![channel; 5_000]);
    let scene = made.scene();
    assert_eq!(scene.report().notes, ["animation left out: a channel has 2 times and 900000000 values"]);
    // Zeros that agree, of many lists: all together they stay in proportion.
    let mut made = Made::square();
    made.list("accessors").push(json!({"componentType": F32, "type": "VEC3", "count": 900_000}));
    let zeros = made.list("accessors").len() - 1;
    let primitive = json!({"attributes": {"POSITION": zeros}});
    made.json["meshes"][0]["primitives"] = json!(vec![primitive; 100]);
    let said = error("m.gltf", &made.text());
    assert!(said.ends_with("900000 items and no data, out of proportion to the file"), "{said}");
    // A group's name is repeated by each child: a long one is cut.
    let mut made = Made::square();
    made.json["nodes"] = json!([{"name": "n".repeat(100_000), "children": [1]}, {"mesh": 0}]);
    assert_eq!(made.scene().objects()[0].group.len(), 200);
}

#[test]
fn reading_can_be_cancelled_everywhere() {
    /// Asks to stop at the `n`th question.
    struct StopAt(usize, AtomicUsize);
    impl Progress for StopAt {
        fn report(&self, _: f32, _: &'static str) {}
        fn cancelled(&self) -> bool {
            self.1.fetch_add(1, Ordering::Relaxed) >= self.0
        }
    }
    let mut made = Made::square();
    made.animate("translation", "LINEAR", &[0.0, 25.0], "VEC3", &[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]);
    let mut nodes = vec![json!({"mesh": 0}); 20_000];
    nodes.push(json!({"children": (0..20_000).collect::<Vec<_>>()}));
    made.json["nodes"] = json!(nodes);
    made.json["animations"][0]["channels"][0]["target"]["node"] = json!(20_000);
    made.json["scenes"][0]["nodes"] = json!([20_000]);
    let text = made.text();
    let mut stops = 0;
    for at in [0, 1, 3, 10, 1_000, 20_001, 20_010] {
        let stop = StopAt(at, AtomicUsize::new(0));
        match load_bytes(&text, "m.gltf", &LoadOptions::default(), &stop) {
            Err(SceneError::Cancelled(_)) => stops += 1,
            other => assert!(other.is_ok() && stop.1.load(Ordering::Relaxed) <= at, "asked, and went on"),
        }
    }
    assert!(stops >= 5, "{stops}");
}
