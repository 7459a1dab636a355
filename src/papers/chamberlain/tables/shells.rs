//! Section 3.1: cells of a level are drawn in a shell about the eye, and each shell holds as many of them.

use std::sync::Arc;

use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{Aabb, Eye, NodeId, Vector, View};
use crate::index::Hierarchy;
use crate::measure::columns::{SCENE, SOURCE, column, points, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::{checkpoint, part, ready};
use crate::measure::{Cell, Experiment, Measured, Setup, Table};
use crate::method::KnobValue;
use crate::papers::keys::COLOR_CUBES;
use crate::scene::{Progress, Scene};

pub const TABLE: Experiment = Experiment {
    name: "chamberlain-shells",
    method: COLOR_CUBES,
    scenes: &["generate:suspension"],
    title: "Chamberlain et al. 1996, Section 3.1: cells drawn of each level",
    summary: "A suspension of small triangles seen from its sides: as many cells of each level are drawn",
    notes: &[
        "Means over --frames views, 48 at most, each from a place near the middle of a side straight into \
         the scene, in images of 64 × 64 pixels.",
        "A level's cells are drawn from the depth at which they are as large as the threshold to twice that: \
         its shell. A shell is whole if it lies in the scene, as wide as the view is, and if no leaf is \
         larger than its cells; only whole ones are to hold alike many, so only those are compared with \
         their mean. The threshold is 16 pixels, since with cells of one pixel a scene would need 4,096 \
         times as many triangles for as many whole shells.",
        "The paper argues that each shell holds a constant number of cells, so that the number of cells \
         grows as the number of levels, a logarithm.",
    ],
    settings: &[("pixel-threshold", "16")],
    sweep: &SWEEP,
};

const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("level", "level", "", 0),
        column("cell_side", "side of a cell", "units", 2),
        column("shell_from", "shell from", "units", 1),
        column("shell_to", "to", "units", 1),
        column("whole", "whole", "", 0),
        column("drawn_cubes", "drawn", "cubes a view", 1),
        column("mean_ratio", "of the mean", "of whole shells", 2),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Views at most.
const MOST_VIEWS: usize = 48;
/// Width and height of an image, if nothing else is asked for, pixels.
const SIDE_PX: u32 = 64;
/// Half the angle of view has this tangent: 60° across and high.
const TANGENT: f32 = 0.577_350_3;

/// A view from near the middle of a side of a cube straight in.
fn view<S: World>(cube: &Aabb<S::Vector>, number: usize, [width, height]: [u32; 2]) -> View<S> {
    let (axes, side) = (S::Vector::AXES, cube.size().get(0));
    let (axis, is_upper) = (number / 2 % axes, number.is_multiple_of(2));
    // Spread evenly over the middle of the side, by multiples of the golden section and of its square.
    let aside = |k: usize| {
        let step = [0.618_034, 0.381_966][k % 2] * (number / (2 * axes)) as f32;
        (step.fract() - 0.5) * 0.1 * side
    };
    let sign = if is_upper { 1.0 } else { -1.0 };
    let position = S::Vector::from_fn(|a| {
        let middle = cube.center().get(a);
        if a == axis { middle + sign * 0.5 * side } else { middle + aside(a + usize::from(a > axis)) }
    });
    let target = S::Vector::from_fn(|a| position.get(a) - if a == axis { sign * side } else { 0.0 });
    let up = S::Vector::from_fn(|a| if a == (axis + 1) % axes { 1.0 } else { 0.0 });
    let eye = Eye { position, target, up, fov: 2.0 * TANGENT.atan(), near: 1e-3 * side, far: 2.0 * side };
    View { eye, width, height }
}

/// What is known of a level.
struct Shell {
    side: f32,
    from: f32,
    is_whole: bool,
    cubes: f64,
}

fn shells<S: World>(tree: &dyn Hierarchy<S>, counts: &[f64], threshold: f32, size: [u32; 2]) -> Vec<Shell> {
    let cube = tree.bounds(NodeId(0)).size().get(0);
    let is_leaf = |node: &NodeId| tree.children(*node).is_empty();
    let leaves = (0..tree.node_count()).map(|at| NodeId(at as u32)).filter(is_leaf);
    let highest = leaves.map(|node| tree.level(node) as usize).min().unwrap_or(0);
    let pixels = size[if S::Vector::AXES == 2 { 0 } else { 1 }] as f32 * 0.5 / TANGENT;
    let shell = |(level, &cubes): (usize, &f64)| {
        let side = cube / (1u32 << level.min(31)) as f32;
        let from = side * pixels / threshold;
        // The rounding of a shell that just fits is not to matter.
        let fits = |length: f32| length <= 1.001 * cube;
        let widest = size[0].max(size[1]) as f32 / size[1].max(1) as f32;
        let widest = if S::Vector::AXES == 2 { 1.0 } else { widest };
        let is_whole = level <= highest && fits(2.0 * from) && fits(4.0 * from * TANGENT * widest);
        Shell { side, from, is_whole, cubes }
    };
    counts.iter().enumerate().map(shell).collect()
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let mut run = ready(scene, COLOR_CUBES, setup, &[], &part(progress, 0.0, 0.5))?;
    let cube = run.hierarchy().bounds(NodeId(0));
    let size = setup.size_px.unwrap_or([SIDE_PX; 2]);
    let size = [size[0], if S::Vector::AXES == 2 { 1 } else { size[1] }];
    let (rest, frames) = (part(progress, 0.5, 1.0), setup.frames.min(MOST_VIEWS));
    let mut counts: Vec<f64> = Vec::new();
    for number in 0..frames {
        checkpoint(&rest, number as f32 / frames as f32, "counting cells")?;
        for one in run.cull(&view::<S>(&cube, number, size)).stand_ins {
            let level = run.hierarchy().level(one.node) as usize;
            counts.resize(counts.len().max(level + 1), 0.0);
            counts[level] += 1.0 / frames as f64;
        }
    }
    let is_threshold = |knob: &&(crate::method::Knob, KnobValue)| knob.0.name == "pixel-threshold";
    let threshold = run.knobs().iter().find(is_threshold).map_or(0.0, |(_, value)| match value {
        KnobValue::Real(value, _) => *value,
        _ => 0.0,
    });
    let shells = shells(run.hierarchy(), &counts, threshold, size);
    let whole: Vec<f64> = shells.iter().filter(|s| s.is_whole).map(|s| s.cubes).collect();
    let mean = whole.iter().sum::<f64>() / whole.len() as f64;
    let row = |(level, shell): (usize, &Shell)| {
        let cells = [
            (SOURCE.key, "measured".into()),
            (SCENE.key, scene.name().into()),
            ("level", level.into()),
            ("cell_side", f64::from(shell.side).into()),
            ("shell_from", f64::from(shell.from).into()),
            ("shell_to", f64::from(2.0 * shell.from).into()),
            ("whole", if shell.is_whole { "yes" } else { "no" }.into()),
            ("drawn_cubes", shell.cubes.into()),
            ("mean_ratio", shell.is_whole.then_some(shell.cubes / mean).into()),
        ];
        quoted(SWEEP.columns, cells)
    };
    let about = Measured {
        name: scene.name().into(),
        source: scene.source().into(),
        prims: scene.live().len(),
        prim: S::PRIM,
        path: "views from its sides".into(),
    };
    Ok((shells.iter().enumerate().map(row).collect(), about))
}

fn paper() -> Vec<Vec<Cell>> {
    let cells = [
        (SOURCE.key, "paper, Section 3.1".into()),
        (SCENE.key, "any that fills space evenly".into()),
        ("level", "each".into()),
        ("mean_ratio", "constant".into()),
    ];
    vec![quoted(SWEEP.columns, cells)]
}

fn plots(table: &Table) -> Vec<Plot> {
    let whole = table.columns.iter().position(|c| c.key == "whole").expect("a column");
    let of = |words: &str| {
        let rows: Vec<usize> =
            (0..table.rows.len()).filter(|r| table.rows[*r][whole] == Cell::from(words)).collect();
        points(table, &rows, "level", "drawn_cubes")
    };
    let groups: Vec<usize> = (0..table.rows.len()).collect();
    let series = vec![
        Series::new("of whole shells", Role::Visible, of("yes")),
        Series::new("of others", Role::Hidden, of("no")),
    ];
    vec![Plot {
        title: String::new(),
        x_label: "level".into(),
        y_label: "cells drawn in a view".into(),
        shape: Shape::Bars { groups: groups.iter().map(usize::to_string).collect(), stacked: false },
        series,
    }]
}
