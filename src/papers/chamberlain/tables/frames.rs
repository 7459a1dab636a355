//! Table 2 and the island of Section 5: frames with and without the hierarchy, by distance and by size of the
//! image.

use std::sync::Arc;

use super::samples::{Images, SAMPLES, color_cubes, geometry, sampled};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{Aabb, Space, Vector, View};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points_where, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, whole_path};
use crate::measure::harness::{checkpoint, part};
use crate::measure::timing::paired;
use crate::measure::{Cell, Setup, Table};
use crate::method::DrawList;
use crate::raster::Options;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("side_px", "image side", "px", 0),
        column("distance_radii", "distance", "radii", 2),
        column("geometry_ms", "geometry", "ms", 3),
        column("cubes_ms", "hierarchy", "ms", 3),
        column("speedup_ratio", "faster", "times", 2),
        column("cubes", "cubes drawn", "", 0),
        column("drawn_triangles", "triangles drawn", "", 0),
        column("visited_cells", "cells in view visited", "", 0),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Sides of the square image, pixels: the paper's for one object and, up to the largest of Section 5, others.
const SIDES: [u32; 4] = [64, 124, 256, 1024];
/// Views of a path that are timed at most, and rounds of each.
const VIEWS: usize = 8;
const ROUNDS: usize = 31;
/// Frames in a turn of the hierarchy at most.
const MOST_FRAMES: f64 = 32.0;

/// How far an eye is from the middle of a scene, in halves of the diagonal of its box.
pub fn distance<S: Space>(bounds: &Aabb<S::Vector>, view: &View<S>) -> f64 {
    let radius = bounds.size().length() * 0.5;
    f64::from((view.eye.position - bounds.center()).length() / radius)
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let mut path = whole_path(scene, setup);
    let every = path.views.len().div_ceil(VIEWS.min(setup.frames)).max(1);
    path.views = path.views.iter().copied().step_by(every).collect();
    let options = Options { surfaces: setup.settings.surfaces().both_sides(), ..Options::default() };
    let mut whole = geometry(scene, setup, &part(progress, 0.0, 0.05))?;
    let mut cubes = color_cubes(scene, setup, &[], &part(progress, 0.05, 0.4))?;
    let mut images = [(); 2].map(|()| Images::default());
    let mut rows = Vec::new();
    let sides = setup.size_px.map_or(SIDES.to_vec(), |[width, _]| vec![width]);
    let count = sides.len() * path.views.len();
    for side in sides {
        for view in &path.views {
            checkpoint(progress, 0.4 + 0.6 * rows.len() as f32 / count as f32, "timing frames")?;
            let view = sampled(view, side, SAMPLES);
            let [first, second] = &mut images;
            let mut list = DrawList::default();
            let mut frame = || list = first.frame(&mut *cubes, scene, &view, &options);
            let mut other = || _ = second.frame(&mut *whole, scene, &view, &options);
            // Turns of about the same length: a frame that follows a far longer one finds nothing in the
            // caches that its own kind has left there.
            let once = paired(1, &mut frame, &mut other);
            let frames = (once.b_ms / once.a_ms.max(1e-6)).clamp(1.0, MOST_FRAMES) as usize;
            let pair = paired(ROUNDS, || (0..frames).for_each(|_| frame()), other);
            let frames = frames as f64;
            let (_, tally) = cubes.count(&view);
            let visited = tally.named().get("cells_sized").copied().unwrap_or_default();
            let numbers = [
                side.into(),
                distance(&scene.bounds(), &view),
                pair.b_ms,
                pair.a_ms / frames,
                pair.ratio * frames,
                list.stand_ins.len() as f64,
                list.prims.len() as f64,
                visited as f64,
            ];
            rows.push(measured(scene.name(), [], numbers));
        }
    }
    Ok((rows, about(scene, &path)))
}

/// Scene, image side, distance, seconds with geometry and with the hierarchy, and triangles drawn (Table 2).
/// Of the island Section 5 prints ratios alone.
type Printed = (&'static str, f64, f64, [f64; 3]);
const TABLE_2: [Printed; 8] = [
    ("tree, 52,470", 124.0, 1.75, [0.212, 0.503, 42_568.0]),
    ("tree, 52,470", 124.0, 3.5, [0.211, 0.397, 26_585.0]),
    ("tree, 52,470", 124.0, 7.0, [0.208, 0.156, 5_985.0]),
    ("tree, 52,470", 124.0, 14.0, [0.207, 0.038, 632.0]),
    ("molecule, 5,227,200", 124.0, 1.75, [5.774, 10.544, 4_286_400.0]),
    ("molecule, 5,227,200", 124.0, 3.5, [5.741, 1.251, 3_200.0]),
    ("molecule, 5,227,200", 124.0, 7.0, [5.526, 0.213, 0.0]),
    ("molecule, 5,227,200", 124.0, 14.0, [5.179, 0.038, 0.0]),
];
const ISLAND: [(f64, f64); 2] = [(64.0, 22.7), (1024.0, 1.7)];

fn paper() -> Vec<Vec<Cell>> {
    let row = |(scene, side, distance, [geometry, hierarchy, triangles]): Printed| {
        let cells = [
            (SOURCE.key, "paper, Table 2".into()),
            (SCENE.key, scene.into()),
            ("side_px", side.into()),
            ("distance_radii", distance.into()),
            ("geometry_ms", (geometry * 1e3).into()),
            ("cubes_ms", (hierarchy * 1e3).into()),
            ("speedup_ratio", (geometry / hierarchy).into()),
            ("drawn_triangles", triangles.into()),
        ];
        quoted(SWEEP.columns, cells)
    };
    let island = |(side, faster): (f64, f64)| {
        let cells = [
            (SOURCE.key, "paper, Section 5".into()),
            (SCENE.key, "island, 3,642,224".into()),
            ("side_px", side.into()),
            ("speedup_ratio", faster.into()),
        ];
        quoted(SWEEP.columns, cells)
    };
    TABLE_2.map(row).into_iter().chain(ISLAND.map(island)).collect()
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |(name, rows): (String, Vec<usize>)| {
        let mut sides: Vec<f64> = rows.iter().filter_map(|&r| table.number(r, "side_px")).collect();
        sides.dedup();
        let roles = [Role::Approximated, Role::Visible, Role::Occluder, Role::Ink];
        let series = sides.iter().zip(roles.into_iter().cycle()).map(|(side, role)| {
            let line = points_where(table, &rows, ("side_px", *side), "distance_radii", "speedup_ratio");
            Series::new(format!("{side} pixels"), role, line)
        });
        Plot {
            title: format!("{name}: how many times as fast as geometry"),
            x_label: "distance from the middle, radii".into(),
            y_label: "times as fast".into(),
            shape: Shape::Lines { logarithmic: true, ticks: Vec::new() },
            series: series.collect(),
        }
    };
    by_scene(table).into_iter().map(plot).collect()
}
