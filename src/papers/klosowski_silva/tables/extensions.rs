//! Section 6: what each extension of the method does, beside the paper's rules and ours, and what each
//! difference between those does.

use std::sync::Arc;

use super::ways::BUDGET;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{at_rest, path};
use crate::measure::harness::{Judge, checkpoint, frame, part, ready, restore_or_build, settings};
use crate::measure::{Setup, Table};
use crate::papers::keys::LAYERED_PROJECTION;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("form", "form", "", 0),
        BUDGET,
        column("drawn_triangles", "drawn", "triangles", 0),
        column("found_percent", "found", "% of visible", 1),
        column("wrong_mean_percent", "wrong pixels, mean", "%", 2),
        column("wrong_worst_percent", "worst frame", "%", 2),
        column("cull_ms", "cull", "ms", 2),
        column("draw_ms", "draw", "ms", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// A form of the method: its name and the parameters that make it.
type Form = (&'static str, &'static [(&'static str, &'static str)]);

const FORMS: [Form; 14] = [
    ("the paper's rules", &[("rules", "paper")]),
    ("paper's, front in view", &[("rules", "paper"), ("front", "in-view")]),
    ("paper's, whole transfer", &[("rules", "paper"), ("transfer", "whole")]),
    ("paper's, v of the cell", &[("rules", "paper"), ("view-direction", "cell")]),
    ("paper's, penalty added", &[("rules", "paper"), ("penalty-as", "sum"), ("penalty", "30")]),
    ("paper's, star-shaped update", &[("rules", "paper"), ("update", "star-shaped")]),
    ("our rules", &[]),
    ("ours, latest update", &[("update", "latest")]),
    ("front-facing count", &[("occupancy", "front-facing")]),
    ("64 seeds", &[("seeds", "64")]),
    ("quality 90 %", &[("quality", "90")]),
    ("quality 99 %", &[("quality", "99")]),
    ("queries for the rest", &[("queries", "true")]),
    ("queries, 64 seeds", &[("queries", "true"), ("seeds", "64")]),
];
/// Budgets, per cent.
const STARTS: [f64; 2] = [1.0, 10.0];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let mut runs = Vec::new();
    let saved = ready(scene, LAYERED_PROJECTION, setup, &[], &part(progress, 0.0, 0.2))?.hierarchy().save();
    let quick = part(progress, 0.2, 0.3);
    for (budget, (_, form)) in STARTS.iter().flat_map(|b| FORMS.iter().map(move |f| (b, f))) {
        let budget = format!("{budget}%");
        let on_top = [*form, &[("budget", budget.as_str())]].concat();
        let settings = settings::<S>(LAYERED_PROJECTION, setup, &on_top)?;
        runs.push(restore_or_build(scene, LAYERED_PROJECTION, &settings, saved.as_deref(), &quick)?);
    }
    let (mut judge, mut target, n) = (Judge::new(scene, setup), Target::default(), path.views.len());
    let mut sums = vec![[0.0f64; 6]; runs.len()];
    for (k, view) in path.views.iter().enumerate() {
        checkpoint(progress, 0.3 + 0.7 * k as f32 / n as f32, "comparing forms of the method")?;
        judge.look(view);
        for (run, sum) in runs.iter_mut().zip(&mut sums) {
            let (list, [cull, draw]) = frame(scene, &mut **run, view, &mut target);
            let difference = judge.compare(&list);
            let wrong = difference.wrong_percent();
            let add = [list.len() as f64, difference.coverage_percent, wrong, 0.0, cull, draw];
            (0..6).for_each(|i| sum[i] += add[i] / n as f64);
            sum[3] = sum[3].max(wrong);
        }
    }
    let about = at_rest(scene, &path);
    let row = |at: usize| {
        let form = FORMS[at % FORMS.len()].0.into();
        measured(&about.name, [form, STARTS[at / FORMS.len()].into()], sums[at])
    };
    Ok(((0..sums.len()).map(row).collect(), about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let bars = |(name, rows): (String, Vec<usize>)| {
        let series = |at: usize, role: Role| {
            let some = rows.iter().skip(at * FORMS.len()).take(FORMS.len()).enumerate();
            let points =
                some.filter_map(|(i, &r)| Some((i as f64, table.number(r, "found_percent")?))).collect();
            Series::new(format!("budget {} %", STARTS[at]), role, points)
        };
        Plot {
            title: name,
            x_label: String::new(),
            y_label: "visible triangles found, %".into(),
            shape: Shape::Bars { groups: FORMS.map(|f| f.0.to_owned()).to_vec(), stacked: false },
            series: vec![series(0, Role::Partial), series(1, Role::Visible)],
        }
    };
    by_scene(table).into_iter().map(bars).collect()
}
