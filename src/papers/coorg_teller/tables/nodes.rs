//! Section 4.1: how many nodes of the kD-tree are tested for occlusion in a frame, and what share of the
//! nodes in the view frustum that is: what spatial coherence saves.

use std::sync::Arc;

use super::both::Both;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{Frustum, FrustumTest, NodeId, View};
use crate::measure::columns::{
    CHECKED, MISSED, SCENE, SOURCE, by_scene, column, first_of_each, measured, quoted,
};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::part;
use crate::measure::timing::quantile;
use crate::measure::{Cell, Setup, Table};
use crate::method::{Event, Run, Verdict};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("tree_nodes", "tree", "nodes", 0),
        column("frustum_entered_nodes", "frustum enters", "nodes", 1),
        column("entered_nodes", "entered", "nodes", 1),
        column("entered_percent", "entered", "% of frustum's", 1),
        column("in_frustum_nodes", "in frustum", "nodes", 1),
        column("tested_nodes", "tested", "nodes", 1),
        column("tested_low_nodes", "low", "nodes", 1),
        column("tested_high_nodes", "high", "nodes", 1),
        column("tested_percent", "tested", "% of in frustum", 1),
        column("tested_low_percent", "low", "%", 1),
        column("tested_high_percent", "high", "%", 1),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// The ends of the ranges that the paper states for both models: nodes, and percent of those in the frustum.
const PAPER: [[f64; 2]; 2] = [[27.0, 35.0], [30.0, 40.0]];

/// Nodes whose box is not outside the frustum, whether or not the method came to them.
fn in_frustum<S: World>(run: &dyn Run<S>, view: &View<S>) -> usize {
    let (frustum, tree) = (view.frustum(), run.hierarchy());
    let inside = |n: &u32| {
        !matches!(frustum.test(&tree.bounds(NodeId(*n)), Frustum::<S::Vector>::ALL), FrustumTest::Outside(_))
    };
    (0..tree.node_count() as u32).filter(inside).count()
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let Both { walk, mut judge, mut frustum, mut occlusion } = Both::new(scene, setup, progress, 0.4)?;
    let views = walk.spread();
    // By frame: entered by frustum culling, entered, in the frustum, tested.
    let mut counts: Vec<[f64; 4]> = Vec::with_capacity(views.len());
    let checked = judge.each(&views, &part(progress, 0.4, 1.0), "counting nodes", |view| {
        let recording = occlusion.record(view, usize::MAX);
        let (mut entered, mut outside) = (0, 0);
        for event in recording.film.events() {
            entered += usize::from(matches!(event, Event::Entered(_)));
            outside += usize::from(matches!(event, Event::DecidedNode(_, Verdict::Outside)));
        }
        let before = frustum.count(view).1.nodes_entered as f64;
        counts.push([
            before,
            entered as f64,
            in_frustum(&*occlusion, view) as f64,
            (entered - outside) as f64,
        ]);
        recording.list.prims
    })?;
    let sum = |at: usize| counts.iter().map(|c| c[at]).sum::<f64>();
    let mean = |at: usize| sum(at) / counts.len() as f64;
    let quartiles = |of: &dyn Fn(&[f64; 4]) -> f64| {
        let mut list: Vec<f64> = counts.iter().map(of).collect();
        list.sort_unstable_by(f64::total_cmp);
        [0.25, 0.75].map(|q| quantile(&list, q))
    };
    let tested = quartiles(&|c| c[3]);
    let share = quartiles(&|c| 100.0 * c[3] / c[2].max(1.0));
    let numbers = [
        occlusion.hierarchy().node_count() as f64,
        mean(0),
        mean(1),
        100.0 * sum(1) / sum(0),
        mean(2),
        mean(3),
        tested[0],
        tested[1],
        100.0 * sum(3) / sum(2),
        share[0],
        share[1],
    ];
    let mut row = measured(&walk.about.name, [], numbers);
    row.extend(checked.cells());
    Ok((vec![row], walk.about))
}

fn paper() -> Vec<Vec<Cell>> {
    let [nodes, percent] = PAPER;
    vec![quoted(
        SWEEP.columns,
        [
            (SOURCE.key, "paper".into()),
            (SCENE.key, "Soda, City".into()),
            ("tested_low_nodes", nodes[0].into()),
            ("tested_high_nodes", nodes[1].into()),
            ("tested_low_percent", percent[0].into()),
            ("tested_high_percent", percent[1].into()),
        ],
    )]
}

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let panel = |y_label: &str, key: &str, range: [f64; 2], more: Option<(&str, &str)>| {
        let after = scenes.len();
        let groups =
            scenes.iter().map(|s| s.0.clone()).chain(["paper,\nlow".into(), "paper,\nhigh".into()]).collect();
        let mut series = vec![
            Series::new("tested for occlusion, mean", Role::Visible, first_of_each(table, key)),
            Series::new(
                "tested for occlusion, paper's range",
                Role::Hidden,
                range.iter().enumerate().map(|(i, v)| ((after + i) as f64, *v)).collect(),
            ),
        ];
        series.extend(more.map(|(label, key)| Series::new(label, Role::Scene, first_of_each(table, key))));
        Plot {
            title: String::new(),
            x_label: String::new(),
            y_label: y_label.into(),
            shape: Shape::Bars { groups, stacked: false },
            series,
        }
    };
    vec![
        panel(
            "kD-tree nodes a frame",
            "tested_nodes",
            PAPER[0],
            Some(("in the view frustum, mean", "in_frustum_nodes")),
        ),
        panel("% of the nodes in the view frustum", "tested_percent", PAPER[1], None),
    ]
}
