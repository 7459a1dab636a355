//! Table 1: what the hierarchy takes to be made, kept and read again.

use std::sync::Arc;

use super::samples::{Images, SAMPLES, sampled};
use crate::drawing::Plot;
use crate::measure::columns::{SCENE, SOURCE, column, measured, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, whole_path};
use crate::measure::harness::{checkpoint, part, ready, restore_or_build, settings};
use crate::measure::timing::{median, timed};
use crate::measure::{Cell, Setup, Table};
use crate::papers::keys::COLOR_CUBES;
use crate::raster::Options;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("primitives", "primitives", "", 0),
        column("triangles", "triangles", "", 0),
        column("levels", "levels", "", 0),
        column("nodes", "nodes", "", 0),
        column("overhead_bytes", "overhead", "bytes", 0),
        column("triangle_bytes", "a triangle", "bytes", 1),
        column("build_s", "built in", "s", 3),
        column("load_s", "loaded in", "s", 3),
        column("first_frame_s", "loaded and drawn in", "s", 3),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Times that the tree is built and read, of which the median is taken.
const ROUNDS: usize = 3;
const SIDE: u32 = 124;

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = whole_path(scene, setup);
    let side = setup.size_px.map_or(SIDE, |[width, _]| width);
    let mut rows = Vec::new();
    let ways = ["triangles", "objects"];
    for (number, way) in ways.into_iter().enumerate() {
        // Objects that are the whole scene, or single primitives, say nothing more.
        if way == "objects" && scene.objects().len() < 2 {
            continue;
        }
        let on_top = [("primitives", way)];
        let (mut builds, mut loads, mut firsts) = (Vec::new(), Vec::new(), Vec::new());
        let mut numbers = [0.0; 3];
        for round in 0..ROUNDS.min(setup.frames) {
            let at = |step: f32| (number as f32 + (round as f32 + step) / ROUNDS as f32) / ways.len() as f32;
            checkpoint(progress, at(0.0), "building")?;
            let some = part(progress, at(0.0), at(0.7));
            let (run, build_ms) = timed(|| ready(scene, COLOR_CUBES, setup, &on_top, &some));
            let run = run?;
            let hierarchy = run.hierarchy();
            let nodes = hierarchy.node_count();
            let levels = (0..nodes as u32).map(|id| hierarchy.level(crate::geometry::NodeId(id)) + 1).max();
            numbers = [f64::from(levels.unwrap_or(0)), nodes as f64, hierarchy.bytes() as f64];
            let saved = hierarchy.save().unwrap_or_default();
            drop(run);
            let some = part(progress, at(0.7), at(0.9));
            let given = settings::<S>(COLOR_CUBES, setup, &on_top)?;
            let (run, load_ms) = timed(|| restore_or_build(scene, COLOR_CUBES, &given, Some(&saved), &some));
            let mut run = run?;
            let mut images = Images::default();
            let view = sampled(&path.views[0], side, SAMPLES);
            let ((), draw_ms) = timed(|| _ = images.frame(&mut *run, scene, &view, &Options::default()));
            builds.push(build_ms * 1e-3);
            loads.push(load_ms * 1e-3);
            firsts.push((load_ms + draw_ms) * 1e-3);
        }
        let [levels, nodes, bytes] = numbers;
        let triangles = scene.live().len() as f64;
        let times = [builds, loads, firsts].map(median);
        let numbers = [triangles, levels, nodes, bytes, bytes / triangles, times[0], times[1], times[2]];
        rows.push(measured(scene.name(), [way.into()], numbers));
    }
    Ok((rows, about(scene, &path)))
}

/// Scene, triangles, levels, nodes, bytes; seconds to make the octree, the cubes, and to load (Table 1).
const PAPER: [(&str, [f64; 4], [f64; 3]); 3] = [
    ("tree", [52_470.0, 9.0, 6_967.0, 1_017_250.0], [248.0, 164.0, 0.8]),
    ("molecule, 6,534 spheres", [5_227_200.0, 25.0, 343_483.0, 24_492_482.0], [1_099.0, 3_979.0, 20.0]),
    ("island", [3_642_224.0, 15.0, 238_321.0, 52_561_676.0], [4_382.0, 2_143.0, 28.0]),
];

fn paper() -> Vec<Vec<Cell>> {
    let row =
        |(scene, [triangles, levels, nodes, bytes], [octree, cubes, load]): (&str, [f64; 4], [f64; 3])| {
            let cells = [
                (SOURCE.key, "paper, Table 1".into()),
                (SCENE.key, scene.into()),
                ("triangles", triangles.into()),
                ("levels", levels.into()),
                ("nodes", nodes.into()),
                ("overhead_bytes", bytes.into()),
                ("triangle_bytes", (bytes / triangles).into()),
                ("build_s", (octree + cubes).into()),
                ("load_s", load.into()),
            ];
            quoted(SWEEP.columns, cells)
        };
    PAPER.map(row).to_vec()
}

fn plots(_: &Table) -> Vec<Plot> {
    Vec::new()
}
