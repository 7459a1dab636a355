//! Table 2's form: milliseconds to cull and to draw a frame, with view-frustum culling and with occlusion
//! culling.

use std::sync::Arc;

use super::both::Both;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{View, WALKING_STEP_M};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::{CHECKING, Moment, frame, part, times};
use crate::measure::{Cell, Setup, Table};
use crate::method::Run;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("frustum_cull_ms", "frustum cull", "ms", 3),
        column("frustum_draw_ms", "draw", "ms", 2),
        column("frustum_total_ms", "total", "ms", 2),
        column("occlusion_cull_ms", "occlusion cull", "ms", 3),
        column("occlusion_draw_ms", "draw", "ms", 2),
        column("occlusion_total_ms", "total", "ms", 2),
        column("speedup_ratio", "speedup", "times", 1),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Machine, scene, then cull and draw with frustum culling, cull and draw with occlusion culling, ms.
const PAPER: [(&str, &str, [f64; 4]); 4] = [
    ("Onyx", "Soda", [12.0, 83.0, 27.0, 10.0]),
    ("Onyx", "City", [11.0, 102.0, 29.0, 16.0]),
    ("Elan", "Soda", [13.0, 435.0, 32.0, 57.0]),
    ("Elan", "City", [12.0, 482.0, 34.0, 77.0]),
];

fn row(source: &str, scene: &str, [frustum_cull, frustum_draw, cull, draw]: [f64; 4]) -> Vec<Cell> {
    let (before, after) = (frustum_cull + frustum_draw, cull + draw);
    let numbers = [frustum_cull, frustum_draw, before, cull, draw, after, before / after];
    [source.into(), scene.into()].into_iter().chain(numbers.map(Cell::from)).collect()
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let Both { walk, mut judge, mut frustum, mut occlusion } = Both::new(scene, setup, progress, 0.2)?;
    let stretches = walk.stretches(WALKING_STEP_M);
    let walked: Vec<View<S>> = stretches.iter().flat_map(|s| s.frames.iter().copied()).collect();
    let mut target = Target::default();
    let mut frame = |run: &mut dyn Run<S>, view: &View<S>| frame(scene, run, view, &mut target).1;
    let mut swap = false;
    let all = times(stretches, &part(progress, 0.2, 0.9), |moment| {
        let Moment::Frame(view) = moment else {
            frustum.forget();
            occlusion.forget();
            return [0.0; 4];
        };
        // Neither always finds the triangles where the other has just read them.
        swap = !swap;
        let first = swap.then(|| frame(&mut *occlusion, view));
        let [frustum_cull, frustum_draw] = frame(&mut *frustum, view);
        let [cull, draw] = first.unwrap_or_else(|| frame(&mut *occlusion, view));
        [frustum_cull, frustum_draw, cull, draw]
    })?;
    occlusion.forget();
    let checked =
        judge.each(&walked, &part(progress, 0.9, 1.0), CHECKING, |view| occlusion.cull(view).prims)?;
    let mut row = row("measured", &walk.about.name, all);
    row.extend(checked.cells());
    Ok((vec![row], walk.about))
}

fn paper() -> Vec<Vec<Cell>> {
    let line = |(machine, scene, times): (&str, &str, [f64; 4])| {
        let mut row = row(&format!("paper, {machine}"), scene, times);
        row.extend([Cell::Missing, Cell::Missing]);
        row
    };
    PAPER.map(line).to_vec()
}

/// Two bars for each scene, culling below and drawing above.
fn panel(title: &str, scenes: &[(String, [f64; 4])], roles: [Role; 2], word: &str) -> Plot {
    let groups = scenes
        .iter()
        .flat_map(|(name, _)| [format!("{name}\nfrustum"), format!("{name}\nocclusion")])
        .collect();
    let bars = |of: [usize; 2]| {
        scenes
            .iter()
            .enumerate()
            .flat_map(move |(i, (_, t))| [(2.0 * i as f64, t[of[0]]), (2.0 * i as f64 + 1.0, t[of[1]])])
    };
    Plot {
        title: title.into(),
        x_label: String::new(),
        y_label: "time of a frame, ms".into(),
        shape: Shape::Bars { groups, stacked: true },
        series: vec![
            Series::new(format!("culling{word}"), roles[0], bars([0, 2]).collect()),
            Series::new(format!("drawing{word}"), roles[1], bars([1, 3]).collect()),
        ],
    }
}

fn plots(table: &Table) -> Vec<Plot> {
    let keys = ["frustum_cull_ms", "frustum_draw_ms", "occlusion_cull_ms", "occlusion_draw_ms"];
    let of = |row: usize| keys.map(|k| table.number(row, k).unwrap_or(0.0));
    let ours: Vec<_> = by_scene(table).into_iter().map(|(name, rows)| (name, of(rows[0]))).collect();
    let theirs = |machine: &str| {
        PAPER.iter().filter(|p| p.0 == machine).map(|p| (p.1.to_owned(), p.2)).collect::<Vec<_>>()
    };
    let quoted = [Role::Approximated, Role::Hidden];
    vec![
        panel("measured, software rasterizer", &ours, [Role::Occluder, Role::Visible], ""),
        panel("paper, SGI Onyx", &theirs("Onyx"), quoted, ", paper"),
        panel("paper, SGI Indigo² Elan", &theirs("Elan"), quoted, ", paper"),
    ]
}
