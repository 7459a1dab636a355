//! Section 5.1, Plate 4 and Figure 4: surfaces torn from between the axes, and the bound that keeps them
//! whole.

use std::sync::Arc;

use super::samples::{Images, SAMPLES, color_cubes, geometry, sampled};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::View;
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points_where};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, whole_path};
use crate::measure::harness::{checkpoint, part};
use crate::measure::timing::paired;
use crate::measure::{Setup, Table};
use crate::method::DrawList;
use crate::raster::{Options, Target};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("error_bound", "error bound", "pixels", 3),
        column("view", "view", "", 0),
        column("torn_px", "seen through", "pixels", 2),
        column("covered_px", "of the surface's", "pixels", 0),
        column("cubes", "cubes drawn", "", 0),
        column("drawn_triangles", "triangles drawn", "", 0),
        column("speedup_ratio", "faster than geometry", "times", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// No bound, as the paper has none, and bounds.
const BOUNDS: [&str; 4] = ["0", "1", "0.3", "0.1"];
const SIDE: u32 = 124;
const ROUNDS: usize = 9;
/// Views of a path at most.
const VIEWS: usize = 10;

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let mut path = whole_path(scene, setup);
    let every = path.views.len().div_ceil(VIEWS.min(setup.frames)).max(1);
    path.views = path.views.iter().copied().step_by(every).collect();
    let options = Options { surfaces: setup.settings.surfaces().both_sides(), ..Options::default() };
    let side = setup.size_px.map_or(SIDE, |[width, _]| width);
    let mut whole = geometry(scene, setup, &part(progress, 0.0, 0.02))?;
    let mut images = [(); 2].map(|()| Images::default());
    let mut rows = Vec::new();
    for (number, bound) in BOUNDS.into_iter().enumerate() {
        let [start, end] = [number, number + 1].map(|n| 0.02 + 0.98 * n as f32 / BOUNDS.len() as f32);
        let some = part(progress, start, end);
        let mut cubes = color_cubes(scene, setup, &[("error-bound", bound)], &part(&some, 0.0, 0.5))?;
        for (k, view) in path.views.iter().enumerate() {
            checkpoint(&some, 0.5 + 0.5 * k as f32 / path.views.len() as f32, "timing frames")?;
            let view = sampled(view, side, SAMPLES);
            let [first, second] = &mut images;
            let mut list = DrawList::default();
            let pair = paired(
                ROUNDS,
                || list = first.frame(&mut *cubes, scene, &view, &options),
                || _ = second.frame(&mut *whole, scene, &view, &options),
            );
            let [torn, covered] = torn(first, &second.target, &view);
            let numbers = [
                bound.parse().unwrap_or_default(),
                k as f64,
                torn,
                covered,
                list.stand_ins.len() as f64,
                list.prims.len() as f64,
                pair.ratio,
            ];
            rows.push(measured(scene.name(), [], numbers));
        }
    }
    Ok((rows, about(scene, &path)))
}

/// How much of the background shows where geometry hides it, and how much geometry covers; pixels.
fn torn<S: World>(drawn: &Images, geometry: &Target, view: &View<S>) -> [f64; 2] {
    let left: Vec<f32> = drawn.canvas.samples().map(|[.., left]| left).collect();
    let (mut torn, mut covered) = (0.0, 0.0);
    for (at, &item) in geometry.item.iter().enumerate() {
        if item != Target::NONE {
            covered += 1.0;
            // Of no size where there are no cubes.
            let through = left.get(at).copied().unwrap_or(1.0);
            torn += if drawn.target.item[at] == Target::NONE { f64::from(through) } else { 0.0 };
        }
    }
    let samples = f64::from(if view.height == 1 { SAMPLES } else { SAMPLES * SAMPLES });
    [torn / samples, covered / samples]
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |(name, rows): (String, Vec<usize>)| {
        let roles = [Role::Approximated, Role::Partial, Role::Occluder, Role::Visible];
        let series = BOUNDS.iter().zip(roles).map(|(bound, role)| {
            let of = ("error_bound", bound.parse().unwrap_or_default());
            Series::new(
                format!("error bound {bound}"),
                role,
                points_where(table, &rows, of, "view", "torn_px"),
            )
        });
        Plot {
            title: format!("{name}: torn as the eye turns"),
            x_label: "view".into(),
            y_label: "background seen through the surface, pixels".into(),
            shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
            series: series.collect(),
        }
    };
    by_scene(table).into_iter().map(plot).collect()
}
