//! The real program where objects move.

use std::fs;
use std::path::Path;

use super::{cullscope, done, folder, json, shipped, with};

#[test]
fn view_i_sees_frame_i_of_the_motions() {
    let here = folder("motion");
    let view = r#"{"eye":[0.5,-3],"target":[0.5,-2],"fov_degrees":80,"near":0.1,"far":100}"#;
    let views = format!("{{\"width\":512,\"views\":[{}]}}", [view; 10].join(","));
    fs::write(here.join("still.json"), views).expect("a written view");
    let door = shipped("scenes2d/moving_door.json");
    for method in ["large-occluders", "hierarchical-z"] {
        let task = [door.as_str(), "--method", method, "--view", "still.json"];
        let frames = &json(&done(&here, &with(&["cull", "--truth"], &task)))["frames"];
        let of = |frame: usize, key: &str| frames[frame]["truth"][key].as_u64().expect("a count");
        assert!((0..10).all(|f| of(f, "missed_triangles") + of(f, "wrong_pixels") == 0), "{method}");
        // The door opens, which the scene's facts say too.
        let visible = [0, 3, 9].map(|f| of(f, "visible_triangles"));
        assert!(visible[0] < visible[1] && visible[1] < visible[2], "{method}: {visible:?}");
        done(&here, &with(&["step", "--out", "steps.jsonl"], &task));
        assert!(done(&here, &["trace", "check", "steps.jsonl", "--prove"]).contains("proven"), "{method}");
    }
}

/// A wall 4 wide before a shelf 2 wide, seen from the origin along −z: it moves away by 0.5 a frame, of which
/// a second has 24. Written with its buffer beside it.
fn write_shutter(folder: &Path) {
    let numbers = |list: &[f32]| list.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let square = |half: f32, z: f32| {
        [[-half, -half], [half, -half], [half, half], [-half, half]].map(|[x, y]| [x, y, z]).concat()
    };
    let mut bytes: Vec<u8> = [0u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect();
    let parts = [
        numbers(&square(2.0, -4.0)),
        numbers(&square(1.0, -8.0)),
        numbers(&[0.0, 1.0]),
        numbers(&[0.0, 0.0, 0.0, 12.0, 0.0, 0.0]),
    ];
    let mut views = vec![serde_json::json!({"buffer": 0, "byteOffset": 0, "byteLength": 12})];
    for part in parts {
        views.push(serde_json::json!({"buffer": 0, "byteOffset": bytes.len(), "byteLength": part.len()}));
        bytes.extend(part);
    }
    let accessor = |bytes: usize, count: usize, kind: &str, number: u32| {
        let mut made = serde_json::json!({"bufferView": bytes, "count": count, "type": kind});
        made["componentType"] = number.into();
        made
    };
    let mesh =
        |at: usize| serde_json::json!({"primitives": [{"attributes": {"POSITION": at}, "indices": 0}]});
    let made = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": "shutter", "mesh": 0}, {"name": "shelf", "mesh": 1}],
        "meshes": [mesh(1), mesh(2)],
        "accessors": [accessor(0, 6, "SCALAR", 5123), accessor(1, 4, "VEC3", 5126),
            accessor(2, 4, "VEC3", 5126), accessor(3, 2, "SCALAR", 5126), accessor(4, 2, "VEC3", 5126)],
        "bufferViews": views,
        "buffers": [{"byteLength": bytes.len(), "uri": "shutter.bin"}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            "samplers": [{"input": 3, "output": 4}]}],
    });
    fs::write(folder.join("shutter.gltf"), made.to_string()).expect("a written scene");
    fs::write(folder.join("shutter.bin"), bytes).expect("a written buffer");
}

#[test]
fn a_shutter_hides_the_shelf_until_it_is_far_enough() {
    let here = folder("shutter");
    write_shutter(&here);
    let view = r#"{"eye":[0,0,0],"target":[0,0,-1],"fov_y_degrees":60}"#;
    let views = format!("{{\"width\":64,\"height\":64,\"views\":[{}]}}", [view; 27].join(","));
    fs::write(here.join("still.json"), views).expect("a written path");
    let all = json(&done(&here, &["methods", "--json"]));
    let conservative =
        all["methods"].as_array().expect("a list").iter().filter(|m| m["conservative"] == true);
    let mut hiding = 0;
    for method in conservative.map(|m| m["key"].as_str().expect("a key")) {
        let words = ["cull", "shutter.gltf", "--method", method, "--view", "still.json", "--truth"];
        let report = json(&done(&here, &words));
        let frames = report["frames"].as_array().expect("frames");
        assert_eq!(frames.len(), 27);
        for (i, frame) in frames.iter().enumerate() {
            let of = |key: &str| frame["truth"][key].as_u64().expect("a count");
            assert_eq!([of("missed_triangles"), of("wrong_pixels")], [0, 0], "{method}, frame {i}");
            assert!(frame["pose_ms"].is_number(), "{method}, frame {i}");
            // The shelf's left end is seen at 1/8 of its depth, so at x = −0.5 in the shutter's plane; the
            // shutter's left end is at x = −2 + 0.5 i there. After frame 24 it begins anew. At 60° one sees
            // 4 tan 30° = 2.31 to the side, so from frame 9 on the shutter is out of view.
            let frame_of_motion = i % 25;
            let left = -2.0 + 0.5 * frame_of_motion as f32;
            let wanted = if (-0.5..2.31).contains(&left) { 4 } else { 2 };
            // Where the two ends meet, a pixel may be either's.
            assert!(left == -0.5 || of("visible_triangles") == wanted, "{method}, frame {i}");
            hiding += usize::from(left < -0.5 && frame["drawn_triangles"] == 2);
        }
    }
    assert!(hiding >= 5 * 2, "methods that cull behind the shutter do so while it is shut: {hiding}");
    // A scene that brought no path has one through its motions.
    let info = done(&here, &["scene", "info", "shutter.gltf"]);
    assert!(info.contains("2 (1 moving, 25 frames)") && info.contains("motion (25 views)"), "{info}");
    let along = ["cull", "shutter.gltf", "--method", "frustum", "--path", "motion", "--size", "16x16"];
    assert_eq!(json(&done(&here, &along))["frames"].as_array().map(Vec::len), Some(25));
    let missing = cullscope(&here, &["cull", "shutter.gltf", "--method", "frustum", "--path", "walk"]);
    assert!(String::from_utf8_lossy(&missing.stderr).contains("motion"), "{missing:?}");
}
