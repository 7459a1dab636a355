//! What depth at samples misses, against resolution.

use std::sync::Arc;

use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{PrimId, View};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{Checked, checkpoint, part, ready};
use crate::measure::{Setup, Table};
use crate::papers::keys::HIERARCHICAL_Z;
use crate::raster::{render, visible};
use crate::scene::{Progress, Scene};
use crate::truth::missing;

/// Sides of the square image at which aliasing is measured, and of the one that is taken for the truth.
const SIDES: [u32; 6] = [16, 32, 64, 128, 256, 512];
const TRUTH_SIDE: u32 = 2048;
/// Views that aliasing is measured at.
const ALIASING_VIEWS: usize = 8;

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("side_px", "image side", "px", 0),
        column("lost_triangles", "seen at 2048² and not drawn", "triangles", 1),
        column("lost_percent", "of those seen", "%", 2),
        column("lost_area_percent", "of the image", "%", 4),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, &Setup { frames: ALIASING_VIEWS, ..setup.clone() });
    let mut run = ready(scene, HIERARCHICAL_Z, setup, &[], &part(progress, 0.0, 0.1))?;
    let sized = |view: &View<S>, side: u32| View {
        width: side,
        height: if S::CORNERS == 2 { 1 } else { side },
        ..*view
    };
    let mut rows = Vec::new();
    let mut sums = vec![[0.0; 3]; SIDES.len()];
    let (mut missed, n) = (vec![0; SIDES.len()], path.views.len());
    let rest = part(progress, 0.1, 1.0);
    for (k, view) in path.views.iter().enumerate() {
        checkpoint(&rest, k as f32 / n as f32, "comparing with a fine image")?;
        let fine = render(&**scene, &sized(view, TRUTH_SIDE), scene.live());
        let seen = visible(&fine);
        for (i, &side) in SIDES.iter().enumerate() {
            let view = sized(view, side);
            run.forget();
            let drawn = run.cull(&view).prims;
            let lost = missing(&seen, &drawn, scene.prim_count());
            let area = fine.item.iter().filter(|&&i| lost.binary_search(&PrimId(i)).is_ok()).count() as f64;
            let count = lost.len() as f64;
            let add =
                [count, 100.0 * count / seen.len().max(1) as f64, 100.0 * area / fine.item.len() as f64];
            (0..3).for_each(|c| sums[i][c] += add[c] / n as f64);
            let coarse = render(&**scene, &view, scene.live());
            missed[i] += missing(&visible(&coarse), &drawn, scene.prim_count()).len();
        }
    }
    let about = about(scene, &path);
    for (i, side) in SIDES.iter().enumerate() {
        let mut row = measured(&about.name, [f64::from(*side).into()], sums[i]);
        row.extend(Checked { missed: missed[i], views: n }.cells());
        rows.push(row);
    }
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |key: &str, y_label: &str| Plot {
        title: String::new(),
        x_label: "side of the image, pixels".into(),
        y_label: y_label.into(),
        shape: Shape::Lines { logarithmic: true, ticks: SIDES.map(f64::from).to_vec() },
        series: by_scene(table)
            .into_iter()
            .enumerate()
            .map(|(i, (name, rows))| {
                let role = [Role::Visible, Role::Hidden, Role::Occluder, Role::Approximated][i % 4];
                Series::new(name, role, points(table, &rows, "side_px", key))
            })
            .collect(),
    };
    vec![
        plot("lost_percent", "triangles lost, % of those seen at 2048²"),
        plot("lost_area_percent", "area lost, % of the image"),
    ]
}
