//! Section 3: how well the order of projection follows the layers of triangles, which it is meant to. The
//! paper defines the layering number ζ and says that the order approximates it; no figures.

use std::sync::Arc;

use super::ways::{
    BY_CENTROID, DELAUNAY, KD_TREE, Most, OCTREE, ORDER, PAPERS_DELAUNAY, PAPERS_OCTREE, RULES, Way, ready,
};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{at_rest, path};
use crate::measure::harness::{checkpoint, mean, part};
use crate::measure::{Setup, Table};
use crate::scene::{Progress, Scene};
use crate::truth::{layer_correlation, layering_numbers};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        ORDER,
        RULES,
        column("layers", "layers", "", 0),
        column("order_correlation", "rank correlation", "", 3),
        column("worst_correlation", "worst frame", "", 3),
        column("first_1_layer", "mean ζ of the first 1 %", "", 2),
        column("first_10_layer", "of the first 10 %", "", 2),
        column("all_layer", "of all", "", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

const WAYS: [Way; 6] = [PAPERS_DELAUNAY, PAPERS_OCTREE, DELAUNAY, OCTREE, KD_TREE, BY_CENTROID];
/// Shares of the scene's triangles of which the mean layer is given.
const FIRST: [f64; 3] = [0.01, 0.1, 1.0];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let mut runs = Vec::new();
    for (i, way) in WAYS.into_iter().enumerate() {
        let build = part(progress, 0.05 * i as f32, 0.05 * (i + 1) as f32);
        runs.extend(ready(scene, setup, way, &[Most::Percent(100.0)], &build)?);
    }
    let surfaces = setup.settings.surfaces();
    let mut deepest = 0;
    let mut found: Vec<Vec<[f64; 4]>> = vec![Vec::new(); WAYS.len()];
    for (k, view) in path.views.iter().enumerate() {
        checkpoint(progress, 0.3 + 0.7 * k as f32 / path.views.len() as f32, "ranking triangles by layers")?;
        let layers = layering_numbers(scene, view, surfaces);
        deepest = deepest.max(layers.iter().copied().max().unwrap_or(0));
        for (run, found) in runs.iter_mut().zip(&mut found) {
            let order: Vec<u32> = run.cull(view).prims.iter().map(|p| layers[p.at()]).collect();
            let [first, tenth, all] = FIRST.map(|share| {
                let count = (share * scene.live().len() as f64).ceil() as usize;
                let layers = order.iter().take(count).filter(|layer| **layer > 0);
                mean(layers.map(|layer| f64::from(*layer)))
            });
            found.push([layer_correlation(&order), first, tenth, all]);
        }
    }
    let about = at_rest(scene, &path);
    let row = |w: usize| {
        let of = |c: usize| found[w].iter().map(move |n| n[c]);
        let worst = of(0).fold(f64::INFINITY, f64::min);
        let numbers = [deepest.into(), mean(of(0)), worst, mean(of(1)), mean(of(2)), mean(of(3))];
        measured(&about.name, WAYS[w].cells(), numbers)
    };
    Ok(((0..WAYS.len()).map(row).collect(), about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let bars = |(name, rows): (String, Vec<usize>)| {
        let points = rows.iter().enumerate();
        let points = points.filter_map(|(i, &r)| Some((i as f64, table.number(r, "order_correlation")?)));
        Plot {
            title: name,
            x_label: String::new(),
            y_label: "rank correlation with ζ".into(),
            shape: Shape::Bars { groups: WAYS.map(|way| way.name()).to_vec(), stacked: false },
            series: vec![Series::new("order of projection", Role::Visible, points.collect())],
        }
    };
    by_scene(table).into_iter().map(bars).collect()
}
