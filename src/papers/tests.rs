//! The tables on small scenes, against numbers made by hand.

use super::*;
use crate::geometry::ViewPath;
use crate::scene::{LoadOptions, Quiet, load};
use std::collections::BTreeMap;

fn small(source: &str) -> AnyScene {
    load(source, &LoadOptions::default(), &Quiet).expect("a generated scene")
}

fn setup(frames: usize) -> Setup {
    Setup { frames, check_every: 2, size_px: Some([128, 96]), ..Setup::default() }
}

fn run(name: &str, scene: &AnyScene, setup: &Setup) -> Report {
    let report = Experiment::named(name)
        .expect("a name")
        .run(std::slice::from_ref(scene), setup, &Quiet)
        .expect("a report");
    for row in 0..report.table.rows.len() {
        assert_eq!(report.table.rows[row].len(), report.table.columns.len());
        if let Some(missed) = report.table.number(row, "missed_triangles") {
            assert_eq!(missed, 0.0, "{name}: row {row}");
            assert!(report.table.number(row, "checked_views").expect("a number") >= 1.0);
        }
    }
    assert!(report.plots.iter().all(|p| p.series.iter().any(|s| !s.points.is_empty())), "{name}");
    report
}

#[test]
fn table_1_is_what_the_draw_lists_say() {
    let scene = small("generate:building?polygons=6000");
    let AnyScene::Solid(solid) = &scene else { panic!("a building is in space") };
    let report = run("coorg-teller-table-1", &scene, &setup(12));
    let path: &ViewPath<Solid> = solid.paths().iter().find(|p| p.name == "figure 8").expect("its path");
    let n = path.views.len();
    let at = |k: usize| path.views[k % n].eye.position;
    let length: f32 = (0..n).map(|k| at(k).distance(at(k + 1))).sum();
    let mut views = path.walked(length / 12.0, 12).views;
    views.iter_mut().for_each(|v| (v.width, v.height) = (128, 96));
    let mut percent = Vec::new();
    for key in ["frustum", "large-occluders"] {
        let entry = Solid::method(key).expect("a method");
        let mut run = entry.ready(solid, &Settings::default(), &Quiet).expect("fine").expect("not cancelled");
        let shares = views.iter().map(|v| run.cull(v).prims.len() as f64 / solid.live().len() as f64);
        percent.push(100.0 * shares.sum::<f64>() / 12.0);
    }
    let ours = ["frustum_percent", "occlusion_percent"].map(|k| report.table.number(0, k).expect("a number"));
    assert!(
        (ours[0] - percent[0]).abs() < 1e-9 && (ours[1] - percent[1]).abs() < 1e-9,
        "{ours:?} for {percent:?}"
    );
    assert!(ours[0] > ours[1] && ours[1] > 0.0 && ours[0] < 100.0, "{ours:?}");
    let ratio = report.table.number(0, "reduction_ratio").expect("a number");
    assert!((ratio - percent[0] / percent[1]).abs() < 1e-9);
    // The paper's rows, as printed there.
    let paper = [1, 2].map(|r| {
        ["polygons", "frustum_percent", "occlusion_percent"]
            .map(|k| report.table.number(r, k).expect("a number"))
    });
    assert_eq!(paper, [[134_832.0, 19.7, 2.6], [108_841.0, 36.9, 5.6]]);
}

#[test]
fn every_experiment_fills_its_table() {
    let scene = small("generate:city?polygons=4000");
    let rows = BTreeMap::from([
        ("coorg-teller-table-1", 3),
        ("coorg-teller-table-2", 5),
        ("coorg-teller-table-3", 7),
        ("coorg-teller-nodes", 2),
        ("coorg-teller-occluders", 16),
        ("georges-box", 4),
        ("georges-flight", 3),
        ("georges-aliasing", 6),
        ("klosowski-silva-table-1", 5),
        ("klosowski-silva-frames", 11),
        ("klosowski-silva-comparison", 54),
        ("klosowski-silva-stability", 12),
        ("klosowski-silva-preprocess", 5),
        ("klosowski-silva-overhead", 16),
        ("klosowski-silva-extensions", 18),
        ("klosowski-silva-deadline", 8),
    ]);
    assert_eq!(rows.len(), EXPERIMENTS.len());
    for (name, count) in rows {
        let report = run(name, &scene, &Setup { check_every: 5, ..setup(10) });
        assert_eq!(report.table.rows.len(), count, "{name}");
        assert!(report.text().contains(report.title) && report.caption().contains("backface-culling false"));
        assert_eq!(report.json()["rows"].as_array().map(Vec::len), Some(count));
        let number = |key: &str| report.table.number(0, key).unwrap_or_else(|| panic!("{name}: {key}"));
        match name {
            "coorg-teller-table-2" => {
                let sum = number("frustum_cull_ms") + number("frustum_draw_ms");
                assert!((sum - number("frustum_total_ms")).abs() < 1e-12 && sum > 0.0);
                assert_eq!(report.table.number(1, "speedup_ratio"), Some(95.0 / 37.0));
            }
            "coorg-teller-table-3" => {
                assert_eq!(report.table.number(2, "cull_ratio"), Some(1.0));
                assert_eq!(report.table.number(6, "paper_soda_ms"), Some(56.0));
            }
            "coorg-teller-nodes" => {
                assert!(
                    number("tested_nodes") <= number("in_frustum_nodes")
                        && number("in_frustum_nodes") <= number("tree_nodes")
                );
                assert!(number("tested_nodes") <= number("entered_nodes") && number("tested_nodes") >= 1.0);
            }
            "coorg-teller-occluders" => {
                // One occluder culls less than 64, and never more than 64 are active.
                assert!(
                    number("occlusion_percent")
                        >= report.table.number(6, "occlusion_percent").expect("a number")
                );
                assert!(number("active_occluders") <= 1.0);
            }
            _ => {}
        }
    }
}

#[test]
fn flatland_has_tables_too() {
    let scene = AnyScene::Flat(crate::scene::example("freedoom_e1m1").expect("a built-in scene"));
    let report = run("coorg-teller-table-1", &scene, &setup(6));
    let [frustum, occlusion] =
        ["frustum_percent", "occlusion_percent"].map(|k| report.table.number(0, k).expect("a number"));
    assert!(frustum >= occlusion && occlusion > 0.0);
}

#[test]
fn stretches_begin_at_the_same_places_whatever_the_speed() {
    let AnyScene::Solid(scene) = small("generate:building?polygons=3000") else {
        panic!("a building is in space")
    };
    let setup = setup(16);
    let site = walk::Site::new(&scene, &setup);
    let begins =
        |step: f32| site.stretches(step).iter().map(|s| s.frames[0].eye.position).collect::<Vec<_>>();
    let (slow, fast) = (begins(0.01), begins(0.1));
    assert_eq!((slow.len(), fast.len()), (8, 8));
    assert!(slow.iter().zip(&fast).all(|(a, b)| a.distance(*b) < 0.25), "{slow:?} {fast:?}");
    let all = site.stretches(1e4);
    assert!(all.len() == 1 && all[0].frames.len() == 1);
    // The step is the one that was asked for, and the frames together are what was asked for.
    let frames = &site.stretches(0.05)[3].frames;
    assert!((frames[0].eye.position.distance(frames[1].eye.position) - 0.05).abs() < 5e-3);
    assert_eq!(site.stretches(0.05).iter().map(|s| s.frames.len()).sum::<usize>(), 16);
}

#[test]
fn wrong_parameters_and_cancelling_are_told() {
    struct Stop;
    impl Progress for Stop {
        fn report(&self, _: f32, _: &'static str) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let scene = [small("generate:building?polygons=3000")];
    for experiment in EXPERIMENTS {
        assert!(
            matches!(experiment.run(&scene, &setup(4), &Stop), Err(PaperError::Cancelled)),
            "{}",
            experiment.name
        );
        let settings = Settings(BTreeMap::from([("occluder".into(), "3".into())]));
        assert!(matches!(
            experiment.run(&scene, &Setup { settings, ..setup(4) }, &Quiet),
            Err(PaperError::Setting(_))
        ));
    }
}
