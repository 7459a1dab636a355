//! What is missed because something is drawn in its place, told from what is lost.

use std::fs;

use super::{done, folder, json};

/// Three short walls in a row far off, each wider than a pixel, in a square of 12 at a distance of 100: with
/// 64 pixels over 60° that is 6.7 pixels, one color cube. None is drawn, all are seen, and all are in it.
#[test]
fn what_is_in_cubes_is_not_lost() {
    let here = folder("in-cubes");
    let walls = r#"{"name": "far", "segments": [[100,-6,100,-4], [100,-1,100,1], [100,4,100,6]]}"#;
    fs::write(here.join("far.json"), walls).expect("written");
    let cull = |set: &str| {
        let words = ["cull", "far.json", "--method", "color-cubes", "--truth", "--ids", "--set", set];
        let view = [
            "--eye", "0,0", "--target", "1,0", "--fov", "60", "--near", "1", "--far", "200", "--size", "64x1",
        ];
        json(&done(&here, &[&words[..], &view].concat()))["frames"][0].clone()
    };
    let frame = cull("pixel-threshold=8");
    let truth = &frame["truth"];
    let keys = ["visible_triangles", "missed_triangles", "approximated_triangles", "lost_triangles"];
    assert_eq!(keys.map(|key| truth[key].as_u64()), [3, 3, 3, 0].map(Some), "{frame}");
    assert_eq!((&frame["drawn_stand_ins"], &frame["drawn_triangles"]), (&1.into(), &0.into()));
    assert_eq!(
        (truth["missed_ids"].to_string(), truth["lost_ids"].to_string()),
        ("[0,1,2]".into(), "[]".into())
    );
    // Without cubes there is nothing to be told apart.
    let truth = &cull("pixel-threshold=0")["truth"];
    assert_eq!(keys.map(|key| truth[key].as_u64()), [Some(3), Some(0), None, None], "{truth}");
    assert!(truth["lost_ids"].is_null());
}

/// Where cells behind full cubes are left out, some of what is in them is lost: faces of one sample are full
/// or clear, and hide more than is there. Else nothing is.
#[test]
fn what_is_left_out_behind_cubes_is_lost() {
    let here = folder("behind-cubes");
    let [all, some] = ["none", "depth-and-opacity"].map(|what| {
        let occlusion = format!("occlusion={what}");
        let words = ["cull", "generate:tree?polygons=20000", "--method", "color-cubes"];
        let sets = ["--set", "pixel-threshold=8", "--set", "face-samples=1", "--set", &occlusion];
        let report =
            json(&done(&here, &[&words[..], &sets, &["--size", "128x128", "--truth", "--ids"]].concat()));
        let (mut lost, mut in_cubes) = (0, 0);
        for frame in report["frames"].as_array().expect("frames") {
            let truth = &frame["truth"];
            let of = |key: &str| truth[key].as_u64().unwrap_or_default();
            if frame["drawn_stand_ins"].is_null() {
                continue;
            }
            assert_eq!(of("lost_triangles") + of("approximated_triangles"), of("missed_triangles"), "{what}");
            let [lost_ids, missed_ids] =
                ["lost_ids", "missed_ids"].map(|key| truth[key].as_array().expect("ids"));
            assert_eq!(lost_ids.len() as u64, of("lost_triangles"), "{what}");
            assert!(lost_ids.iter().all(|id| missed_ids.contains(id)), "{what}");
            (lost, in_cubes) = (lost + of("lost_triangles"), in_cubes + of("approximated_triangles"));
        }
        [lost, in_cubes]
    });
    assert!(all[0] == 0 && all[1] > 100, "{all:?}");
    assert!(some[0] > 0 && some[1] > 100, "{some:?}");
}
