//! Table 1: the percentage of polygons drawn after view-frustum culling, and after occlusion culling as well.
//!
//! The paper's two columns, each by nodes of the tree alone and with objects one by one too: what Section 3.2
//! leaves out since an object is out of view is no gain of occlusion culling, so it is compared with
//! view-frustum culling that tests objects as well.

use std::sync::Arc;

use super::both::Both;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::Aabb;
use crate::measure::columns::{
    CHECKED, MISSED, SCENE, SOURCE, by_scene, column, first_of_each, measured, quoted,
};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::{part, ready};
use crate::measure::{Cell, Setup, Table};
use crate::papers::keys::LARGE_OCCLUDERS;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("polygons", "polygons", "", 0),
        column("frustum_percent", "frustum, nodes", "% drawn", 1),
        column("frustum_objects_percent", "and objects", "% drawn", 1),
        column("tree_percent", "occlusion, nodes", "% drawn", 1),
        column("occlusion_percent", "and objects", "% drawn", 1),
        column("tree_ratio", "nodes", "times", 1),
        column("reduction_ratio", "and objects", "times", 1),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Scene, polygons, percent after frustum culling, percent after occlusion culling.
const PAPER: [(&str, f64, f64, f64); 2] = [("Soda", 134_832.0, 19.7, 2.6), ("City", 108_841.0, 36.9, 5.6)];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let Both { walk, mut judge, mut frustum, mut occlusion } = Both::new(scene, setup, progress, 0.3)?;
    let nodes_only = [("detail-objects", "false")];
    let mut tree = ready(scene, LARGE_OCCLUDERS, setup, &nodes_only, &part(progress, 0.3, 0.5))?;
    let (views, bounds) = (walk.spread(), object_bounds(scene));
    let mut drawn = [0; 4];
    let checked = judge.each(&views, &part(progress, 0.5, 1.0), "culling", |view| {
        let (planes, in_view) = (view.frustum(), frustum.cull(view).prims);
        let is_out: Vec<bool> = bounds.iter().map(|b| planes.excludes(b)).collect();
        let by_objects = in_view.iter().filter(|p| !is_out[scene.object_of(**p).at()]).count();
        let list = occlusion.cull(view).prims;
        let counts = [in_view.len(), by_objects, tree.cull(view).prims.len(), list.len()];
        (0..4).for_each(|i| drawn[i] += counts[i]);
        list
    })?;
    let percent = drawn.map(|n| 100.0 * n as f64 / (views.len() * scene.live().len()) as f64);
    let ratio = |of: usize, to: usize| Cell::from((drawn[to] > 0).then(|| percent[of] / percent[to]));
    let polygons = [walk.about.prims.into()];
    let mut row = measured(&walk.about.name, polygons, percent);
    row.extend([ratio(0, 2), ratio(1, 3)]);
    row.extend(checked.cells());
    Ok((vec![row], walk.about))
}

/// Bounds of each object of a scene.
fn object_bounds<S: World>(scene: &Scene<S>) -> Vec<Aabb<S::Vector>> {
    let mut bounds = vec![Aabb::empty(); scene.objects().len()];
    for &prim in scene.live() {
        let of = &mut bounds[scene.object_of(prim).at()];
        *of = of.union(scene.prim_bounds(prim));
    }
    bounds
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |(scene, polygons, frustum, occlusion): (&str, f64, f64, f64)| {
        quoted(
            SWEEP.columns,
            [
                (SOURCE.key, "paper".into()),
                (SCENE.key, scene.into()),
                ("polygons", polygons.into()),
                ("frustum_percent", frustum.into()),
                ("occlusion_percent", occlusion.into()),
                ("reduction_ratio", (frustum / occlusion).into()),
            ],
        )
    };
    PAPER.map(row).to_vec()
}

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let after = scenes.len();
    let theirs = |of: fn(&(&str, f64, f64, f64)) -> f64| {
        PAPER.iter().enumerate().map(|(i, p)| ((after + i) as f64, of(p))).collect()
    };
    let names = scenes.iter().map(|s| s.0.clone());
    let groups = names.chain(PAPER.iter().map(|p| format!("{}\n(paper)", p.0))).collect();
    vec![Plot {
        title: String::new(),
        x_label: String::new(),
        y_label: "polygons drawn, % of the scene".into(),
        shape: Shape::Bars { groups, stacked: false },
        series: vec![
            Series::new("after frustum culling, nodes", Role::Scene, first_of_each(table, "frustum_percent")),
            Series::new("and objects", Role::Outside, first_of_each(table, "frustum_objects_percent")),
            Series::new(
                "after occlusion culling, nodes",
                Role::Occluder,
                first_of_each(table, "tree_percent"),
            ),
            Series::new("and objects", Role::Visible, first_of_each(table, "occlusion_percent")),
            Series::new("after frustum culling, paper", Role::Approximated, theirs(|p| p.2)),
            Series::new("after occlusion culling, paper", Role::Hidden, theirs(|p| p.3)),
        ],
    }]
}
