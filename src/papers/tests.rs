//! The papers: names, words, and the tables on small scenes against numbers made by hand.

use super::*;
use crate::culling::Methods;
use crate::drawing::{Mark, metrics};
use crate::figure::tools::Maker;
use crate::geometry::{Flat, Solid, ViewPath};
use crate::measure::{Cell, ExperimentError, Report, Setup, harness};
use crate::method::{Settings, When};
use crate::scene::{AnyScene, LoadOptions, Progress, Quiet, example, generators, load};
use std::collections::BTreeSet;

fn small(source: &str) -> AnyScene {
    load(source, &LoadOptions::default(), &Quiet).expect("a generated scene")
}

fn setup(frames: usize) -> Setup {
    Setup { frames, check_every: 2, size_px: Some([128, 96]), ..Setup::default() }
}

fn run(name: &str, scene: &AnyScene, setup: &Setup) -> Report {
    let report =
        table(name).expect("a name").run(std::slice::from_ref(scene), setup, &Quiet).expect("a report");
    for row in 0..report.table.rows.len() {
        assert_eq!(report.table.rows[row].len(), report.table.columns.len());
        if let Some(missed) = report.table.number(row, "missed_triangles") {
            assert_eq!(missed, 0.0, "{name}: row {row}");
            assert!(report.table.number(row, "checked_views").expect("a number") >= 1.0);
        }
    }
    let caption = report.caption();
    for (parameter, value) in &report.params {
        assert!(caption.contains(&format!("{parameter} {value}")), "{caption}");
    }
    for (parameter, values) in &report.varied {
        assert!(values.len() > 1, "{parameter}: {values:?}");
        assert!(caption.contains(&format!("{parameter} ({})", values.join(", "))), "{caption}");
    }
    let sections = caption.split_once(" departs from its paper in Section").map_or("", |(_, rest)| rest);
    assert!(report.departures.iter().all(|section| sections.contains(section)), "{caption}");
    assert_eq!(sections.is_empty(), report.departures.is_empty(), "{caption}");
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
    let nodes = [("detail-objects", "false")];
    for (key, pairs) in [("frustum", &[][..]), ("large-occluders", &nodes[..]), ("large-occluders", &[][..])]
    {
        let entry = Solid::method(key).expect("a method");
        let mut run = entry.ready(solid, &Settings::of(pairs), &Quiet).expect("fine").expect("not cancelled");
        let shares = views.iter().map(|v| run.cull(v).prims.len() as f64 / solid.live().len() as f64);
        percent.push(100.0 * shares.sum::<f64>() / 12.0);
    }
    let of = |key: &str| report.table.number(0, key).expect("a number");
    let ours = ["frustum_percent", "tree_percent", "occlusion_percent"].map(of);
    assert!(ours.iter().zip(&percent).all(|(a, b)| (a - b).abs() < 1e-9), "{ours:?} for {percent:?}");
    let like = of("frustum_objects_percent");
    assert!(ours[0] > like && like > ours[2] && ours[1] > ours[2] && ours[2] > 0.0, "{ours:?}, {like}");
    assert!((of("tree_ratio") - ours[0] / ours[1]).abs() < 1e-9);
    assert!((of("reduction_ratio") - like / ours[2]).abs() < 1e-9);
    // The paper's rows, as printed there.
    let paper = [1, 2].map(|r| {
        ["polygons", "frustum_percent", "occlusion_percent"]
            .map(|k| report.table.number(r, k).expect("a number"))
    });
    assert_eq!(paper, [[134_832.0, 19.7, 2.6], [108_841.0, 36.9, 5.6]]);
}

/// Measures a table on a small city, and checks its form and its number of rows.
fn city(name: &str, rows: usize) -> Report {
    let scene = small("generate:city?polygons=4000");
    let report = run(name, &scene, &Setup { check_every: 5, ..setup(10) });
    assert_eq!(report.table.rows.len(), rows, "{name}");
    // All runs of Klosowski and Silva cull back faces.
    let faces = format!("backface-culling {}", name.starts_with("klosowski-silva"));
    assert!(report.text().contains(report.title) && report.caption().contains(&faces));
    assert_eq!(report.json()["rows"].as_array().map(Vec::len), Some(rows));
    report
}

impl Report {
    /// The number in a row under a column, which is there.
    fn at(&self, row: usize, key: &str) -> f64 {
        let number = self.table.number(row, key);
        number.unwrap_or_else(|| panic!("{}: row {row} has no {key}", self.name))
    }
    /// The numbers under some columns.
    fn row<const N: usize>(&self, row: usize, keys: [&str; N]) -> [f64; N] {
        keys.map(|key| self.at(row, key))
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

#[test]
fn coorg_teller_table_2_adds_up_and_quotes_the_paper() {
    let report = city("coorg-teller-table-2", 5);
    let [cull, draw, total] = report.row(0, ["frustum_cull_ms", "frustum_draw_ms", "frustum_total_ms"]);
    assert!(near(cull + draw, total) && total > 0.0);
    assert!(near(report.at(0, "speedup_ratio"), total / report.at(0, "occlusion_total_ms")));
    assert_eq!(report.at(1, "speedup_ratio"), 95.0 / 37.0);
}

#[test]
fn coorg_teller_table_3_is_relative_to_walking() {
    let report = city("coorg-teller-table-3", 7);
    assert_eq!(report.at(2, "cull_ratio"), 1.0);
    assert!(near(report.at(6, "cull_ratio"), report.at(6, "cull_ms") / report.at(2, "cull_ms")));
    assert_eq!(report.at(6, "paper_soda_ms"), 56.0);
}

#[test]
fn coorg_teller_nodes_are_fewer_at_each_step() {
    let report = city("coorg-teller-nodes", 2);
    let keys = ["tested_nodes", "entered_nodes", "in_frustum_nodes", "tree_nodes"];
    let [tested, entered, in_frustum, all] = report.row(0, keys);
    assert!(1.0 <= tested && tested <= entered && tested <= in_frustum && in_frustum <= all);
    assert!(near(report.at(0, "tested_percent"), 100.0 * tested / in_frustum));
    assert_eq!(report.row(1, ["tested_low_percent", "tested_high_percent"]), [30.0, 40.0]);
}

#[test]
fn coorg_teller_occluders_cull_more_when_they_are_more() {
    let report = city("coorg-teller-occluders", 16);
    let key = "occlusion_percent";
    assert!(report.at(6, key) < report.at(0, key), "64 occluders cull more than one");
    assert!(report.at(0, "active_occluders") <= 1.0);
    assert!(report.at(7, key) <= report.at(13, key), "a lower marginal gain takes more occluders");
}

#[test]
fn georges_box_hides_the_objects_behind_it() {
    let scene = small("generate:box-and-objects?polygons=6000");
    let report = run("georges-box", &scene, &Setup { check_every: 5, ..setup(10) });
    let keys = ["culled_drawn", "all_drawn", "gain_ratio", "culled_fps", "frustum_fps"];
    let [sight, behind] = [0, 1].map(|row| report.row(row, keys));
    assert!(behind[0] * 10.0 < sight[0], "{behind:?} behind the box, {sight:?} in sight");
    assert!(sight[0] <= sight[1] && sight[1] == behind[1]);
    assert!(near(sight[2], sight[3] / sight[4]));
    // The paper's rates in its own words: it prints no number for either.
    let fps = report.table.columns.iter().position(|c| c.key == "culled_fps").expect("a column");
    assert_eq!([2, 3].map(|row| report.table.shown(row, fps)), ["about 2–3", "near the monitor's rate"]);
}

#[test]
fn georges_flight_draws_less_than_is_in_the_frustum() {
    let report = city("georges-flight", 2);
    let [frustum, culled] = report.row(0, ["frustum_drawn", "culled_drawn"]);
    assert!(culled < 0.8 * frustum && culled > 0.0, "{culled} of {frustum}");
    let [frustum, culled, gain] = report.row(0, ["frustum_ms", "culled_ms", "gain_percent"]);
    assert!(near(gain, 100.0 * (frustum / culled - 1.0)));
}

#[test]
fn georges_aliasing_ends_where_the_image_is_fine() {
    let report = city("georges-aliasing", 6);
    let lost = [0, 1, 5].map(|row| report.at(row, "lost_triangles"));
    assert!(lost[0] > lost[1] && lost[1] >= lost[2], "{lost:?}");
    assert!(report.at(0, "lost_area_percent") > 0.0);
}

#[test]
fn klosowski_silva_table_1_finds_more_with_more() {
    let report = city("klosowski-silva-table-1", 7);
    let found = ["found_1_percent", "found_2_percent", "found_5_percent", "found_10_percent"];
    let wrong = ["worst_1_percent", "worst_2_percent", "worst_5_percent", "worst_10_percent"];
    for row in 0..5 {
        let (found, wrong) = (report.row(row, found), report.row(row, wrong));
        assert!(found.is_sorted() && found[0] > 5.0 && found[3] <= 100.0, "{found:?}");
        assert!(wrong[3] < wrong[0], "{wrong:?}");
    }
    assert_eq!(report.row(5, found), [51.0, 66.0, 80.0, 90.0]);
    assert_eq!(report.at(6, "worst_10_percent"), 12.0);
}

#[test]
fn klosowski_silva_frames_have_their_mean_first() {
    let report = city("klosowski-silva-frames", 22);
    let keys = ["found_1_triangles", "found_10_triangles", "visible_triangles"];
    // The paper's rules, then ours, on the same frames.
    for first in [0, 11] {
        let [one, ten, visible] = report.row(first, keys);
        assert!(one < ten && ten < visible, "{one} {ten} {visible}");
        for key in keys.into_iter().chain(["centroid_10_triangles", "budget_5_ms"]) {
            let mean = (1..11).map(|row| report.at(first + row, key)).sum::<f64>() / 10.0;
            assert!(near(mean, report.at(first, key)), "{key}");
        }
    }
    let same = ["visible_triangles", "centroid_10_triangles", "frustum_ms"];
    assert_eq!(report.row(0, same), report.row(11, same));
}

#[test]
fn klosowski_silva_comparison_sums_its_frames_up() {
    let report = city("klosowski-silva-comparison", 78);
    for order in 0..6 {
        let (mean, worst) = (2 * order, 2 * order + 1);
        let frames = 12 + 10 * order..22 + 10 * order;
        let found = frames.clone().map(|row| report.at(row, "found_percent"));
        assert_eq!(found.fold(f64::INFINITY, f64::min), report.at(worst, "found_percent"));
        assert!(report.at(mean, "wrong_percent") < report.at(worst, "wrong_percent"));
        for row in frames {
            let [cull, draw, total] = report.row(row, ["cull_ms", "draw_ms", "total_ms"]);
            assert!(near(cull + draw, total));
        }
    }
    // The paper's means and worst frames: Delaunay, octree, centroid.
    assert_eq!([72, 74, 76].map(|row| report.at(row, "found_percent")), [90.0, 64.0, 30.0]);
    assert_eq!([73, 75, 77].map(|row| report.at(row, "wrong_percent")), [4.0, 9.0, 40.0]);
}

#[test]
fn klosowski_silva_stability_knows_one_exact_set() {
    let report = city("klosowski-silva-stability", 20);
    let exact = report.at(0, "exact_change_percent");
    assert!(exact > 0.0 && exact < 50.0, "{exact}");
    for row in 0..20 {
        assert_eq!(
            report.at(row, "exact_change_percent"),
            exact,
            "the exact set knows no order and no budget"
        );
        let [mean, worst] = report.row(row, ["popped_pixels_percent", "worst_pixels_percent"]);
        assert!(mean <= worst && worst <= 100.0);
    }
}

#[test]
fn klosowski_silva_preprocess_triangulates_for_delaunay_only() {
    let report = city("klosowski-silva-preprocess", 5);
    let stages = ["dividing_ms", "triangulating_ms", "assigning_ms", "total_ms"];
    let rows = [0, 1, 2].map(|row| report.row(row, stages));
    assert!(rows[0][1] > 0.0 && rows[1][1] == 0.0 && rows[2][1] == 0.0, "{rows:?}");
    for (row, [dividing, triangulating, assigning, total]) in rows.into_iter().enumerate() {
        // Medians of three builds, each by itself.
        assert!(dividing.max(triangulating).max(assigning) <= total, "{total}");
        assert!(report.at(row, "references_ratio") >= 1.0, "every triangle is in a cell");
        let keys = ["cells_mb", "references_mb", "scene_mb", "overhead_percent"];
        let [cells, references, scene, overhead] = report.row(row, keys);
        assert!(near(overhead, 100.0 * (cells + references) / scene));
    }
    assert_eq!(report.at(3, "total_ms"), 70_000.0);
}

#[test]
fn klosowski_silva_overhead_is_over_frustum_culling() {
    let report = city("klosowski-silva-overhead", 26);
    for row in 1..26 {
        let [cull, draw, share, over] =
            report.row(row, ["cull_ms", "draw_ms", "cull_share_percent", "overhead_ms"]);
        assert!(near(share, 100.0 * cull / (cull + draw)) && near(over, cull - report.at(0, "cull_ms")));
    }
    let drawn = |row: usize| report.at(row, "drawn_triangles");
    for first in [1, 6, 11, 16, 21] {
        assert!((first..first + 4).all(|row| drawn(row) < drawn(row + 1)), "a budget is used");
        assert!(drawn(first + 4) <= drawn(0), "nothing outside the view is drawn");
    }
}

#[test]
fn klosowski_silva_extensions_keep_what_they_promise() {
    let report = city("klosowski-silva-extensions", 28);
    let names: Vec<&Cell> = report.table.rows.iter().map(|row| &row[2]).collect();
    let row = |form: &str, budget: usize| {
        let at = names.iter().position(|name| **name == form.into()).expect("a form");
        at + budget * 14
    };
    for budget in 0..2 {
        let queries = row("queries for the rest", budget);
        assert_eq!(report.row(queries, ["found_percent", "wrong_worst_percent"]), [100.0, 0.0]);
        assert!(report.at(row("quality 99 %", budget), "found_percent") >= 99.0);
        // Other solidities draw as much, in another order.
        let drawn =
            ["our rules", "ours, latest update"].map(|form| report.at(row(form, budget), "drawn_triangles"));
        assert_eq!(drawn[0], drawn[1]);
    }
}

#[test]
fn klosowski_silva_deadline_has_late_frames_only_where_they_overshoot() {
    let report = city("klosowski-silva-deadline", 16);
    for row in 0..16 {
        let keys = ["median_ms", "p99_ms", "worst_ms", "late_percent", "deadline_ms"];
        let [median, p99, worst, late, deadline] = report.row(row, keys);
        assert!(median <= p99 && p99 <= worst, "{median} {p99} {worst}");
        assert_eq!(late > 0.0, worst > deadline);
        assert_eq!(late > 0.0, report.table.number(row, "overshoot_ms").is_some());
    }
}

#[test]
fn klosowski_silva_layering_is_that_of_the_same_triangles() {
    let report = city("klosowski-silva-layering", 6);
    for row in 0..6 {
        let [mean, worst] = report.row(row, ["order_correlation", "worst_correlation"]);
        assert!(worst <= mean && mean < 1.0 && worst > -1.0, "{worst} {mean}");
        // What all orders draw in the end is the same.
        assert!(near(report.at(row, "all_layer"), report.at(0, "all_layer")));
        assert!(report.at(row, "first_1_layer") >= 1.0);
    }
    assert!(report.at(2, "order_correlation") > 0.1, "by layers rather than at random");
}

#[test]
fn zhang_frames_have_their_mean_first() {
    let scene = small("generate:city?polygons=4000");
    // Of so few polygons hardly any pay for maps.
    let settings = Settings::of(&[("adapt", "false"), ("occluder-budget", "400"), ("depth", "samples")]);
    let report = run("zhang-frames", &scene, &Setup { settings, ..setup(10) });
    assert_eq!(report.table.rows.len(), 14);
    let keys = ["in_view_triangles", "drawn_triangles", "culled_percent", "frustum_ms", "maps_ms"];
    for key in keys {
        let mean = (1..11).map(|row| report.at(row, key)).sum::<f64>() / 10.0;
        assert!(near(mean, report.at(0, key)), "{key}");
    }
    for row in 1..11 {
        let [in_view, drawn, culled, frustum, maps] = report.row(row, keys);
        assert!(near(culled, 100.0 * (in_view - drawn) / in_view), "{in_view} in view, {drawn} drawn");
        assert!(near(report.at(row, "speedup_ratio"), frustum / maps));
        assert!(near(report.at(row, "model_percent"), 100.0 * (1.0 - drawn / prims(&report))));
    }
    assert!(report.at(0, "culled_percent") > 10.0, "a street hides much");
    assert_eq!([11, 12, 13].map(|row| report.at(row, "speedup_ratio")), [5.0, 2.0, 5.0]);
}

/// Primitives of the scene that was measured.
fn prims(report: &Report) -> f64 {
    report.scenes[0].prims as f64
}

#[test]
fn zhang_stages_add_up_to_the_frame() {
    let report = city("zhang-stages", 2);
    let parts = ["clear", "select", "occluders", "maps", "cull", "draw"];
    let parts = parts.map(|stage| report.at(0, &format!("{stage}_percent")));
    assert!(parts.iter().all(|share| *share > 0.0), "{parts:?}");
    assert!(near(parts.iter().sum(), report.at(0, "total_percent")));
    assert!(near(parts[1] + parts[2], report.at(0, "chosen_and_drawn_percent")));
    let at = report.table.columns.iter().position(|c| c.key == "chosen_and_drawn_percent");
    assert_eq!(report.table.shown(1, at.expect("a column")), "10–25");
}

#[test]
fn zhang_claims_stand_beside_the_papers() {
    let report = city("zhang-claims", 6);
    let [all, database, share] = report.row(0, ["polygons", "database_polygons", "database_percent"]);
    assert!(all == prims(&report) && 0.0 < database && database <= all);
    assert!(near(share, 100.0 * database / all));
    let [mean, most] = report.row(0, ["model_percent", "most_percent"]);
    assert!(mean <= most && most < 100.0, "{mean} {most}");
    // Section 6.2 and Figure 1 as printed; 217,636 of 632,252.
    assert_eq!(report.row(2, ["polygons", "database_polygons"]), [632_252.0, 217_636.0]);
    assert!((report.at(2, "database_percent") - 34.4).abs() < 0.05);
    assert_eq!(report.at(3, "model_percent"), 82.7);
    assert_eq!([1, 2].map(|row| report.at(row, "construction_ms")), [9.0, 4.0]);
}

#[test]
fn zhang_overlap_is_the_same_three_ways() {
    let scene = small("generate:city?polygons=4000");
    let report = run("zhang-overlap", &scene, &Setup { rectangles: 3000, ..setup(8) });
    for row in 0..4 {
        let keys = ["rectangles", "finest_differences", "samples_differences"];
        assert_eq!(report.row(row, keys), [3000.0, 0.0, 0.0], "the answers are the same");
        let [hierarchy, finest, samples] =
            report.row(row, ["hierarchy_reads", "finest_reads", "samples_reads"]);
        assert!(finest <= samples && near(report.at(row, "saved_ratio"), finest / hierarchy));
        let covered = report.at(row, "covered_percent");
        assert!(covered > 1.0 && covered < 99.0, "{covered} % are covered");
    }
    assert!(report.at(0, "saved_ratio") > 1.5, "the hierarchy reads less");
    assert!(report.at(0, "covered_percent") <= report.at(3, "covered_percent"));
    assert!(report.at(4, "rectangles") > 0.0 && report.at(4, "hierarchy_reads") >= 1.0);
}

#[test]
fn zhang_construction_times_the_same_image() {
    let report = run("zhang-construction", &small("generate:city?polygons=4000"), &setup(2));
    assert_eq!(report.table.rows.len(), 6);
    // 256² and larger images have a finest map of 256², which takes six more to 4².
    assert!((0..4).all(|row| report.row(row, ["map_px", "levels"]) == [256.0, 7.0]));
    for row in 0..4 {
        let [a, b, ratio] = report.row(row, ["opacity_ms", "pyramid_ms", "opacity_ratio"]);
        assert!(a > 0.0 && b > 0.0 && near(ratio, a / b));
    }
    assert_eq!([4, 5].map(|row| report.at(row, "opacity_ms")), [9.0, 4.0]);
}

#[test]
fn zhang_thresholds_lose_no_more_than_their_bound() {
    let scene = small("generate:forest?polygons=20000");
    let settings = Settings::of(&[("occluder-budget", "8000")]);
    let report = run("zhang-thresholds", &scene, &Setup { size_px: Some([512, 512]), settings, ..setup(3) });
    assert_eq!(
        (0..5).map(|row| report.at(row, "ignored_samples")).collect::<Vec<_>>(),
        [0.0, 6.0, 12.0, 19.0, 32.0]
    );
    let exact = ["missed_visible", "wrong_pixels", "accepted_pixels", "bound_pixels"];
    assert_eq!(report.row(0, exact), [0.0; 4], "nothing is ignored");
    for row in 0..5 {
        let [wrong, black, bound] = report.row(row, ["wrong_pixels", "black_samples", "bound_pixels"]);
        assert!(wrong <= bound && black <= bound, "{wrong} wrong, {black} black, at most {bound}");
        assert_eq!(report.at(row, "over_bound_frames"), 0.0);
        assert!(report.at(row, "checked_frames") >= 2.0);
    }
    let of = |key: &str| (0..5).map(|row| report.at(row, key)).collect::<Vec<_>>();
    assert!(of("culled_percent").is_sorted() && of("house_percent").is_sorted());
    assert!(of("house_percent")[4] > of("house_percent")[0], "{:?}", of("house_percent"));
    assert!(of("missed_visible")[4] > 0.0, "what shows through holes is lost");
}

#[test]
fn zhang_open_views_turn_culling_off() {
    let report = run("zhang-open", &small("generate:terrain?polygons=20000"), &setup(12));
    let keys = ["on_percent", "covered_triangles", "occluder_triangles", "tests"];
    let [automatic, never] = [0, 1].map(|row| report.row(row, keys));
    assert_eq!(never[0], 100.0);
    assert!((automatic[0] - 25.0).abs() < 1e-9, "three frames of twelve: {automatic:?}");
    assert!(automatic[2] < never[2] && automatic[3] < never[3], "{automatic:?}, {never:?}");
    let in_view = report.at(0, "in_view_triangles");
    assert!(never[1] < 0.001 * in_view, "{} of {in_view} are behind others where nothing is", never[1]);
}

#[test]
fn chamberlain_forests_grow_fourfold_and_their_time_does_not() {
    let scene = small("generate:tree?polygons=2000");
    let report = run("chamberlain-figure-5", &scene, &Setup { size_px: Some([64, 64]), ..setup(2) });
    assert_eq!(report.table.rows.len(), 2 * 12 + 3);
    for first in [0, 12] {
        for level in 0..11 {
            let row = first + level;
            let trees = 4f64.powi(level as i32);
            assert_eq!(report.row(row, ["trees", "triangles"]), [trees, 2_000.0 * trees]);
            let [cells, drawn] = report.row(row, ["visited_cells", "drawn_triangles"]);
            assert!(cells >= 1.0 && drawn <= 2_000.0 * trees, "{cells} cells, {drawn} triangles");
            // A frame pays for 4 million triangles at most.
            let is_timed = report.table.number(row, "geometry_ms").is_some();
            assert_eq!(is_timed, level <= 5, "{trees} trees");
        }
        // Four thousand times as many trees, and not four times as many cells.
        let [few, many] = [4, 10].map(|level| report.at(first + level, "visited_cells"));
        assert!(many < 4.0 * few, "{few} cells, {many}");
        let grown = report.row(first + 11, ["cells_power", "memory_power"]);
        assert!(grown.iter().all(|p| p.abs() < 0.2), "{grown:?}");
    }
    let keys = ["trees", "triangles", "speedup_ratio"];
    assert_eq!(report.row(24, keys), [20.0, 1_049_400.0, 1.0]);
    let [trees, triangles, faster] = report.row(25, keys);
    assert!(trees == 16_384.0 && triangles == 859_668_480.0 && near(faster, 88.0));
    assert!((report.at(26, "time_power") - 0.33).abs() < 0.005);
}

/// Between a depth and its double a view 60° across and high holds 28/9 times its cube: where cells are drawn
/// from 2√3 of their sides on, 129 of them, and those that stick out of it.
#[test]
fn chamberlain_shells_hold_as_many_cells() {
    let scene = small("generate:suspension?polygons=100000");
    let report = run("chamberlain-shells", &scene, &Setup { size_px: Some([64, 64]), ..setup(24) });
    let whole = |row: &usize| report.table.number(*row, "mean_ratio").is_some();
    let rows: Vec<usize> = (0..report.table.rows.len()).filter(whole).collect();
    assert_eq!(
        rows,
        [3, 4],
        "of level 2 the shell is wider than the scene, at level 5 some are larger leaves"
    );
    for row in rows {
        let [side, from, to, cubes, ratio] =
            report.row(row, ["cell_side", "shell_from", "shell_to", "drawn_cubes", "mean_ratio"]);
        assert!((from - 12f64.sqrt() * side).abs() < 1e-3 * from && near(to, 2.0 * from));
        assert!(cubes > 129.0 && cubes < 2.0 * 129.0, "{cubes} cubes");
        assert!(ratio > 1.0 / 1.2 && ratio < 1.2, "{ratio}");
    }
}

#[test]
fn names_begin_with_their_papers_key_and_are_taken_once() {
    let mut names = BTreeSet::new();
    let mut once = |name: &'static str| assert!(names.insert(name), "{name} is taken twice");
    for paper in PAPERS {
        once(paper.key);
        let named = paper.figures.iter().map(|f| f.name).chain(paper.tables.iter().map(|t| t.name));
        for name in named {
            assert!(name.strip_prefix(paper.key).is_some_and(|rest| rest.starts_with('-')), "{name}");
            once(name);
        }
        paper.figures.iter().filter_map(|f| f.former).for_each(&mut once);
    }
    let [now, before] = ["coorg-teller-figure-4", "large-occluders-4"].map(|n| figure(n).expect("a figure"));
    assert!(now.name == "coorg-teller-figure-4" && before.name == now.name);
}

/// Kinds of things that a paper numbers, and how many it has of each.
type Numbered<'a> = (&'a str, &'a [(&'a str, usize)]);

/// As counted in the papers by hand.
const PRINTED: [Numbered<'_>; 6] = [
    ("baselines", &[]),
    ("coorg-teller", &[("Figure", 13), ("Table", 3)]),
    ("georges", &[("Figure", 2)]),
    ("klosowski-silva", &[("Figure", 15), ("Table", 1)]),
    ("zhang", &[("Figure", 13)]),
    ("chamberlain", &[("Figure", 5), ("Plate", 5), ("Table", 2)]),
];

#[test]
fn the_gallery_has_everything_that_a_paper_numbers_once() {
    assert_eq!(PRINTED.len(), PAPERS.len());
    for (paper, (key, kinds)) in PAPERS.iter().zip(PRINTED) {
        let all = kinds.iter().flat_map(|(kind, count)| (1..=*count).map(move |n| format!("{kind} {n}")));
        let numbers = paper.shown.iter().map(|s| s.number.trim_end_matches(" (color plate)").to_owned());
        assert_eq!((paper.key, numbers.collect::<Vec<_>>()), (key, all.collect()));
        for Shown { number, what, ours, instead } in paper.shown {
            assert!(!ours.is_empty() || !instead.is_empty(), "{key}: {number} is neither ours nor excused");
            for text in [what, instead] {
                assert!(!text.ends_with('.') && !text.contains(['|', '"', '<']), "{key}: {number}: {text}");
            }
        }
    }
}

#[test]
fn what_the_gallery_names_exists() {
    let mut names: BTreeSet<&str> = figures().map(|f| f.name).chain(tables().map(|t| t.name)).collect();
    for (paper, ours) in PAPERS.iter().flat_map(|p| p.shown.iter().flat_map(|s| s.ours).map(move |o| (p, o)))
    {
        match ours {
            Ours::Figure(name) => assert!(paper.figures.iter().any(|f| f.name == *name), "{name}"),
            Ours::Table(name) => assert!(paper.tables.iter().any(|t| t.name == *name), "{name}"),
            Ours::Own(own) => {
                let rest = own.name.strip_prefix(paper.key);
                assert!(rest.is_some_and(|rest| rest.starts_with('-')), "{}", own.name);
                assert!(names.insert(own.name), "{} is taken twice", own.name);
                assert!(paper.methods.contains(&own.method), "{}", own.name);
            }
        }
    }
    for own in owns() {
        let generated = own.scene.strip_prefix("generate:").map(|rest| rest.split('?').next());
        let exists = match generated {
            Some(name) => generators().iter().any(|g| Some(g.name) == name),
            None => std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(own.scene).is_file(),
        };
        assert!(exists, "{}: there is no scene {}", own.name, own.scene);
        let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@".contains(c);
        let quoted = own.words().into_iter().find(|word| !word.chars().all(is_plain));
        assert_eq!(quoted, None, "{}: a shell needs quotes", own.name);
    }
}

#[test]
fn papers_are_about_methods_that_exist() {
    for key in PAPERS.iter().flat_map(|paper| paper.methods) {
        assert!(Flat::method(key).is_some() && Solid::method(key).is_some(), "{key}");
    }
    for paper in PAPERS {
        assert!(paper.tables.iter().all(|table| paper.methods.contains(&table.method)), "{}", paper.key);
        assert!(paper.sources().iter().all(|source| !source.title.is_empty()), "{}", paper.key);
    }
    let doi = |key: &str| PAPERS.iter().find(|p| p.key == key).expect("a paper").sources()[0].doi;
    assert_eq!(doi("coorg-teller"), "10.1145/253284.253312");
}

#[test]
fn an_unknown_method_is_an_error() {
    let sweep = table("coorg-teller-table-1").expect("a table").sweep;
    let experiment = Experiment {
        name: "",
        title: "",
        summary: "",
        method: "large-occluder",
        scenes: &[],
        notes: &[],
        settings: &[],
        sweep,
    };
    let error = experiment.check(&Settings::default()).expect_err("no such method");
    assert!(matches!(&error, ExperimentError::UnknownMethod(key) if key == "large-occluder"), "{error}");
}

#[test]
fn no_text_of_a_figure_sticks_out_or_is_too_small() {
    for figure in figures() {
        let (name, page) = (figure.name, figure.drawing(&|_| [0.0; 3]).expect("a figure"));
        for item in &page.items {
            let Mark::Text { at, text, size_pt, anchor, font } = &item.mark else { continue };
            let [low, high] = metrics::text_box(*at, text, *font, *size_pt, *anchor);
            assert!(low.x >= 0.0 && high.x <= page.size_pt.x && high.y <= page.size_pt.y, "{name}: {text}");
            assert!(*size_pt > 5.0, "{name}: {text} has {size_pt} pt");
        }
    }
}

#[test]
fn flatland_has_tables_too() {
    let scene = AnyScene::Flat(example("freedoom_e1m1").expect("a built-in scene"));
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
    let walk = harness::Walk::new(&scene, &setup(16));
    let begins =
        |step: f32| walk.stretches(step).iter().map(|s| s.frames[0].eye.position).collect::<Vec<_>>();
    let (slow, fast) = (begins(0.01), begins(0.1));
    assert_eq!((slow.len(), fast.len()), (8, 8));
    assert!(slow.iter().zip(&fast).all(|(a, b)| a.distance(*b) < 0.25), "{slow:?} {fast:?}");
    let all = walk.stretches(1e4);
    assert!(all.len() == 1 && all[0].frames.len() == 1);
    // The step is the one that was asked for, and the frames together are what was asked for.
    let frames = &walk.stretches(0.05)[3].frames;
    assert!((frames[0].eye.position.distance(frames[1].eye.position) - 0.05).abs() < 5e-3);
    assert_eq!(walk.stretches(0.05).iter().map(|s| s.frames.len()).sum::<usize>(), 16);
}

#[test]
fn wrong_parameters_and_cancelling_are_errors() {
    struct Stop;
    impl Progress for Stop {
        fn report(&self, _: f32, _: &'static str) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let scene = [small("generate:building?polygons=3000")];
    for experiment in tables() {
        assert!(
            matches!(experiment.run(&scene, &setup(4), &Stop), Err(ExperimentError::Cancelled)),
            "{}",
            experiment.name
        );
        let settings = Settings::of(&[("occluder", "3")]);
        assert!(matches!(
            experiment.run(&scene, &Setup { settings, ..setup(4) }, &Quiet),
            Err(ExperimentError::Setting(_))
        ));
    }
}

/// The runs that a caption names, with all their parameters; none if it names no run.
fn named_runs(caption: &str) -> Vec<(String, String)> {
    let list = [" Run: ", " Runs: "].into_iter().find_map(|head| caption.rsplit_once(head));
    let Some((_, list)) = list else { return vec![] };
    let list = list.split(". ").next().unwrap_or_default().trim_end_matches('.');
    let knobs_of = |words: &str| {
        let mut words = words.split(' ');
        let key = words.next().expect("a method");
        let mut settings = Settings::default();
        words.for_each(|pair| settings.parse(pair).expect("a setting"));
        let knobs = Solid::method(key).expect("a method").knobs(&settings).expect("parameters that exist");
        (key.to_owned(), format!("{:?}", knobs.iter().map(|(_, v)| v.to_string()).collect::<Vec<_>>()))
    };
    list.split("; ").map(knobs_of).collect()
}

#[test]
fn captions_name_what_was_run_and_where_it_departs() {
    let (mut with_runs, mut with_departures) = (0, 0);
    for figure in figures() {
        let maker = Maker::gray();
        let caption = (figure.make)(&maker).expect("a figure").description;
        let runs = maker.runs();
        let ran = |run: &crate::figure::tools::Ran| {
            let values: Vec<String> = run.knobs.iter().map(|(_, v)| v.to_string()).collect();
            (run.card.key.to_owned(), format!("{values:?}"))
        };
        // Whoever types the words of the caption has the very runs.
        assert_eq!(named_runs(&caption), runs.iter().map(ran).collect::<Vec<_>>(), "{caption}");
        with_runs += usize::from(!runs.is_empty());
        for run in &runs {
            let head = format!("{} departs from its paper in Section", run.card.key);
            let sections = caption.split_once(&head).map_or("", |(_, rest)| rest);
            let held: Vec<&str> =
                run.card.departures.iter().filter(|d| d.holds(&run.knobs)).map(|d| d.section).collect();
            assert!(held.iter().all(|section| sections.contains(section)), "{held:?}: {caption}");
            assert_eq!(sections.is_empty(), held.is_empty(), "{caption}");
            with_departures += usize::from(!held.is_empty());
        }
    }
    assert!(with_runs > 15 && with_departures > 12, "{with_runs}, {with_departures}");
}

#[test]
fn departures_depend_on_parameters_that_exist() {
    let mut depend = 0;
    for entry in Solid::methods() {
        for departure in entry.card().departures {
            let (When::With(name, word) | When::Without(name, word)) = departure.when else { continue };
            let knobs = entry.knobs(&Settings::of(&[(name, word)])).expect("a parameter with this value");
            assert_eq!(departure.holds(&knobs), matches!(departure.when, When::With(..)), "{departure:?}");
            depend += 1;
        }
    }
    assert!(depend > 15, "{depend}");
}

#[test]
fn with_the_papers_rules_only_what_these_leave_open_departs() {
    let entry = Flat::method("layered-projection").expect("a method");
    let sections = |pairs: &[(&str, &str)]| {
        let knobs = entry.knobs(&Settings::of(pairs)).expect("parameters");
        entry.card().departing(|d| d.holds(&knobs))
    };
    assert_eq!(sections(&[]), ["3.2", "4.2", "4.3", "5"]);
    // The penalty's factor, where nothing is said; how the border of the view and cells are found.
    let papers = [("rules", "paper"), ("backface-culling", "true"), ("tessellation", "octree")];
    assert_eq!(sections(&papers), ["3.2", "4.2", "4.3"]);
    let knobs = entry.knobs(&Settings::of(&papers)).expect("parameters");
    let held = entry.card().departures.iter().filter(|d| d.holds(&knobs));
    assert_eq!(held.count(), 3, "all others are ours alone");
}
