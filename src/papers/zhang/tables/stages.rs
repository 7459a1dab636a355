//! Figure 10: the stages of a frame as shares of a frame without occlusion culling.

use std::sync::Arc;

use super::fly::{STAGES, fly};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column, measured, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("frustum_ms", "frame without", "ms", 2),
        column("clear_percent", "maps emptied", "% of it", 1),
        column("select_percent", "occluders chosen", "%", 1),
        column("occluders_percent", "drawn", "%", 1),
        column("maps_percent", "hierarchy made", "%", 1),
        column("cull_percent", "culled", "%", 1),
        column("draw_percent", "the rest drawn", "%", 1),
        column("total_percent", "frame with", "%", 1),
        column("chosen_and_drawn_percent", "occluders, both", "%", 1),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, &[], progress)?;
    let about = about(scene, &path);
    let without = flight.mean(|f| f.frustum_ms);
    let shares: [f64; STAGES.len()] = std::array::from_fn(|i| 100.0 * flight.mean(|f| f.stages[i]) / without);
    let [clear, select, occluders, maps, cull, draw] = shares;
    let total = shares.iter().sum();
    let numbers = [without, clear, select, occluders, maps, cull, draw, total, select + occluders];
    let mut row = measured(&about.name, [], numbers);
    row.extend(flight.checked.cells());
    Ok((vec![row], about))
}

fn paper() -> Vec<Vec<Cell>> {
    let cells = [
        (SOURCE.key, "paper".into()),
        (SCENE.key, "all three models".into()),
        ("chosen_and_drawn_percent", "10–25".into()),
    ];
    vec![quoted(SWEEP.columns, cells)]
}

/// What the bars are made of, from the bottom up.
const BARS: [(&str, &str, Role); 6] = [
    ("clear_percent", "maps emptied", Role::Undecided),
    ("select_percent", "occluders chosen", Role::Partial),
    ("occluders_percent", "occluders drawn", Role::Occluder),
    ("maps_percent", "hierarchy of maps made", Role::Approximated),
    ("cull_percent", "culled", Role::Hidden),
    ("draw_percent", "the rest drawn", Role::Visible),
];

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    // Beside each scene's bar stands the frame without occlusion culling, which is 100 %.
    let groups = scenes.iter().flat_map(|(name, _)| [format!("{name}\nwithout"), format!("{name}\nwith")]);
    let whole = (0..scenes.len()).map(|i| (2.0 * i as f64, 100.0)).collect();
    let mut series = vec![Series::new("frame without occlusion culling", Role::Outside, whole)];
    for (key, label, role) in BARS {
        let of = |(i, (_, rows)): (usize, &(String, Vec<usize>))| {
            Some((2.0 * i as f64 + 1.0, table.number(rows[0], key)?))
        };
        series.push(Series::new(label, role, scenes.iter().enumerate().filter_map(of).collect()));
    }
    vec![Plot {
        title: "Stages of a frame".into(),
        x_label: String::new(),
        y_label: "time, % of a frame without".into(),
        shape: Shape::Bars { groups: groups.collect(), stacked: true },
        series,
    }]
}
