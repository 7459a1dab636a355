//! Georges 1995, Section 5.2: the box model and the model with a hidden dense body, as times of frames along
//! the scene's own path with obscuration culling and without; and the known weakness of depth at samples,
//! aliasing, against resolution.
//!
//! A frame of `hierarchical-z` ends with the image drawn, so its time is all of the frame; the others are
//! culled, then drawn.

use std::sync::Arc;

use super::flight::{about, path};
use super::walk::{ROUNDS, stop_or_go};
use super::{
    CHECKED, MISSED, Measured, PaperError, SCENE, SOURCE, Setup, Sweep, World, by_scene, column, method, part,
};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{View, ViewPath};
use crate::measure::table::{Cell, Table};
use crate::measure::timed;
use crate::measure::timing::median;
use crate::method::{Run, Settings};
use crate::raster::{Options, Target};
use crate::scene::{Part, Progress, Scene};
use crate::truth::Truth;

pub const METHOD: &str = "hierarchical-z";

fn ready<S: World>(
    key: &str,
    scene: &Arc<Scene<S>>,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, PaperError> {
    let entry = method::<S>(key);
    let known = entry.knobs(&Settings::default())?;
    let fits = |k: &String| key == METHOD || known.iter().any(|(knob, _)| knob.name == k);
    let settings =
        Settings(settings.0.iter().filter(|(k, _)| fits(k)).map(|(k, v)| (k.clone(), v.clone())).collect());
    entry.ready(scene, &settings, progress)?.ok_or(PaperError::Cancelled)
}

/// What was measured along a path.
struct Flight {
    /// Of each frame and way the median of the rounds, ms: everything drawn, frustum culling, obscuration
    /// culling.
    times: Vec<[f64; 3]>,
    drawn: Vec<[usize; 3]>,
    missed: usize,
    checked: usize,
}

/// Flies along a path in rounds, the three ways in turn at each frame.
fn fly<S: World>(
    scene: &Arc<Scene<S>>,
    path: &ViewPath<S>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<Flight, PaperError> {
    let mut runs = Vec::new();
    for (i, key) in ["z-buffer", "frustum", METHOD].into_iter().enumerate() {
        runs.push(ready(
            key,
            scene,
            &setup.settings,
            &part(progress, 0.05 * i as f32, 0.05 * (i + 1) as f32),
        )?);
    }
    let mut truth =
        Truth::new(scene, setup.settings.0.get("backface-culling").is_some_and(|v| v == "true"), 1, [1.0; 3]);
    let mut targets = [(); 3].map(|()| Target::default());
    let n = path.views.len();
    let mut rounds = vec![[const { Vec::new() }; 3]; n];
    let mut flight = Flight { times: Vec::new(), drawn: vec![[0; 3]; n], missed: 0, checked: 0 };
    for round in 0..ROUNDS {
        runs.iter_mut().for_each(|r| r.forget());
        for (k, view) in path.views.iter().enumerate() {
            stop_or_go(progress, 0.15 + 0.85 * (round * n + k) as f32 / (ROUNDS * n) as f32, "flying")?;
            // None always finds the triangles where another has just read them.
            for way in (0..3).map(|w| (w + k + round) % 3) {
                let (list, ms) = timed(|| frame(scene, &mut *runs[way], view, way < 2, &mut targets[way]));
                rounds[k][way].push(ms);
                flight.drawn[k][way] = list.len();
                if way == 2 && round == 0 && setup.check_every > 0 && k.is_multiple_of(setup.check_every) {
                    let mut kept = vec![false; scene.prim_count()];
                    list.iter().for_each(|p| kept[p.at()] = true);
                    flight.missed += truth.look(scene, view).iter().filter(|p| !kept[p.at()]).count();
                    flight.checked += 1;
                }
            }
        }
    }
    flight.times = rounds.into_iter().map(|ways| ways.map(median)).collect();
    Ok(flight)
}

/// A frame from the view to the finished image.
fn frame<S: World>(
    scene: &Scene<S>,
    run: &mut dyn Run<S>,
    view: &View<S>,
    draws: bool,
    target: &mut Target,
) -> Vec<crate::geometry::PrimId> {
    let list = run.cull(view);
    if draws {
        target.clear(view);
        S::draw(target, scene, view, &list.prims, &Options::default());
    }
    list.prims
}

/// The box model: with all objects in sight, and behind the box.
pub const BOX: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("situation", "situation", "", 0),
        column("all_drawn", "drawn, all", "triangles", 0),
        column("culled_drawn", "drawn, culled", "triangles", 0),
        column("all_fps", "all drawn", "frames/s", 1),
        column("frustum_fps", "frustum", "frames/s", 1),
        column("culled_fps", "obscuration", "frames/s", 1),
        column("gain_ratio", "gain over frustum", "times", 2),
        MISSED,
        CHECKED,
    ],
    flat: box_rows,
    solid: box_rows,
    paper: box_paper,
    plots: box_plots,
};

fn box_rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, progress)?;
    let name = about(scene, &path).name;
    // A tenth of the path at either end.
    let n = path.views.len();
    let some = n.div_ceil(10);
    let row = |situation: &str, frames: std::ops::Range<usize>| {
        let mean = |f: &dyn Fn(usize) -> f64| frames.clone().map(f).sum::<f64>() / frames.len() as f64;
        let [all, frustum, culled] = [0, 1, 2].map(|way| 1000.0 / mean(&|k| flight.times[k][way]));
        let drawn = [0, 2].map(|way| mean(&|k| flight.drawn[k][way] as f64));
        let numbers = [drawn[0], drawn[1], all, frustum, culled, culled / frustum];
        let text = ["measured".into(), name.as_str().into(), situation.into()];
        text.into_iter()
            .chain(numbers.map(Cell::from))
            .chain([flight.missed.into(), flight.checked.into()])
            .collect()
    };
    Ok((vec![row("all in sight", 0..some), row("behind the box", n - some..n)], about(scene, &path)))
}

fn box_paper() -> Vec<Vec<Cell>> {
    let row = |situation: &str, fps: f64| {
        let mut row: Vec<Cell> =
            vec!["paper, Pixel-Planes 5".into(), "box and objects".into(), situation.into()];
        row.extend([
            Cell::Missing,
            Cell::Missing,
            Cell::Missing,
            Cell::Missing,
            fps.into(),
            Cell::Missing,
            Cell::Missing,
            Cell::Missing,
        ]);
        row
    };
    // "About 2-3 frames/second", then "near the monitor refresh rate", which was 60 or 72 Hz.
    vec![row("all in sight", 2.5), row("behind the box", 60.0)]
}

fn box_plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let series = |key: &str, label: &str, role: Role| {
            let points = rows
                .iter()
                .enumerate()
                .filter_map(|(i, &r)| Some((i as f64, table.number(r, key)?)))
                .collect();
            Series::new(label, role, points)
        };
        plots.push(Plot {
            title: name,
            x_label: String::new(),
            y_label: "frames a second".into(),
            shape: Shape::Bars {
                groups: vec!["all in sight".into(), "behind the box".into()],
                stacked: false,
            },
            series: vec![
                series("all_fps", "everything drawn", Role::Occluder),
                series("frustum_fps", "view-frustum culling", Role::Outside),
                series("culled_fps", "obscuration culling", Role::Visible),
            ],
        });
    }
    plots
}

/// The time of frames along a flight.
pub const FLIGHT: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("frames", "frames", "", 0),
        column("frustum_drawn", "drawn, frustum", "triangles", 0),
        column("culled_drawn", "drawn, obscuration", "triangles", 0),
        column("all_ms", "all drawn", "ms", 2),
        column("frustum_ms", "frustum", "ms", 2),
        column("culled_ms", "obscuration", "ms", 2),
        column("gain_percent", "frame rate gained", "%", 0),
        column("median_gain_percent", "median of frames", "%", 0),
        MISSED,
        CHECKED,
    ],
    flat: flight_rows,
    solid: flight_rows,
    paper: flight_paper,
    plots: flight_plots,
};

fn flight_rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, progress)?;
    let n = path.views.len() as f64;
    let mean = |way: usize| flight.times.iter().map(|t| t[way]).sum::<f64>() / n;
    let drawn = |way: usize| flight.drawn.iter().map(|d| d[way] as f64).sum::<f64>() / n;
    let each = median(flight.times.iter().map(|t| 100.0 * (t[1] / t[2] - 1.0)).collect());
    let numbers = [n, drawn(1), drawn(2), mean(0), mean(1), mean(2), 100.0 * (mean(1) / mean(2) - 1.0), each];
    let text: [Cell; 2] = ["measured".into(), about(scene, &path).name.as_str().into()];
    let row = text
        .into_iter()
        .chain(numbers.map(Cell::from))
        .chain([flight.missed.into(), flight.checked.into()])
        .collect();
    Ok((vec![row], about(scene, &path)))
}

fn flight_paper() -> Vec<Vec<Cell>> {
    let row = |percent: f64| {
        let mut row: Vec<Cell> = vec!["paper, Pixel-Planes 5".into(), "submarine, torpedo hidden".into()];
        row.extend([const { Cell::Missing }; 6]);
        row.extend([percent.into(), Cell::Missing, Cell::Missing, Cell::Missing]);
        row
    };
    vec![row(20.0), row(30.0)]
}

fn flight_plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let bars = |key: &str, label: &str, role: Role| {
        let points = scenes
            .iter()
            .enumerate()
            .filter_map(|(i, (_, rows))| Some((i as f64, table.number(rows[0], key)?)))
            .collect();
        Series::new(label, role, points)
    };
    vec![Plot {
        title: "Time of a frame".into(),
        x_label: String::new(),
        y_label: "ms, mean along the flight".into(),
        shape: Shape::Bars { groups: scenes.iter().map(|(name, _)| name.clone()).collect(), stacked: false },
        series: vec![
            bars("all_ms", "everything drawn", Role::Occluder),
            bars("frustum_ms", "view-frustum culling", Role::Outside),
            bars("culled_ms", "obscuration culling", Role::Visible),
        ],
    }]
}

/// Sides of the square image at which aliasing is measured, and of the one that is taken for the truth.
const SIDES: [u32; 6] = [16, 32, 64, 128, 256, 512];
const TRUTH_SIDE: u32 = 2048;
/// Views that aliasing is measured at.
const ALIASING_VIEWS: usize = 8;

/// What samples miss, against resolution.
pub const ALIASING: Sweep = Sweep {
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
    flat: aliasing_rows,
    solid: aliasing_rows,
    paper: Vec::new,
    plots: aliasing_plots,
};

fn aliasing_rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, &Setup { frames: ALIASING_VIEWS, ..setup.clone() });
    let mut run = ready(METHOD, scene, &setup.settings, &part(progress, 0.0, 0.1))?;
    let sized = |view: &View<S>, side: u32| View {
        width: side,
        height: if S::CORNERS == 2 { 1 } else { side },
        ..*view
    };
    let mut rows = Vec::new();
    let mut sums = vec![[0.0; 3]; SIDES.len()];
    let (mut missed, n) = (vec![0; SIDES.len()], path.views.len());
    let whole = Part { whole: progress, start: 0.1, length: 0.9 };
    for (k, view) in path.views.iter().enumerate() {
        stop_or_go(&whole, k as f32 / n as f32, "comparing with a fine image")?;
        let fine = crate::raster::render(&**scene, &sized(view, TRUTH_SIDE), scene.live());
        let seen = crate::raster::visible(&fine);
        for (i, &side) in SIDES.iter().enumerate() {
            let view = sized(view, side);
            run.forget();
            let mut kept = vec![false; scene.prim_count()];
            run.cull(&view).prims.iter().for_each(|p| kept[p.at()] = true);
            let lost = seen.iter().filter(|p| !kept[p.at()]).count() as f64;
            let area = fine.item.iter().filter(|&&i| i != Target::NONE && !kept[i as usize]).count() as f64;
            let add = [lost, 100.0 * lost / seen.len().max(1) as f64, 100.0 * area / fine.item.len() as f64];
            (0..3).for_each(|c| sums[i][c] += add[c] / n as f64);
            let coarse = crate::raster::render(&**scene, &view, scene.live());
            missed[i] += crate::raster::visible(&coarse).iter().filter(|p| !kept[p.at()]).count();
        }
    }
    for (i, side) in SIDES.iter().enumerate() {
        let mut row: Vec<Cell> =
            vec!["measured".into(), about(scene, &path).name.as_str().into(), f64::from(*side).into()];
        row.extend(sums[i].map(Cell::from));
        row.extend([missed[i].into(), n.into()]);
        rows.push(row);
    }
    Ok((rows, about(scene, &path)))
}

fn aliasing_plots(table: &Table) -> Vec<Plot> {
    let plot = |key: &str, y_label: &str| Plot {
        title: String::new(),
        x_label: "side of the image, pixels".into(),
        y_label: y_label.into(),
        shape: Shape::Lines { logarithmic: true, ticks: SIDES.map(f64::from).to_vec() },
        series: by_scene(table)
            .into_iter()
            .enumerate()
            .map(|(i, (name, rows))| {
                let points = rows
                    .iter()
                    .filter_map(|&r| Some((table.number(r, "side_px")?, table.number(r, key)?)))
                    .collect();
                Series::new(
                    name,
                    [Role::Visible, Role::Hidden, Role::Occluder, Role::Approximated][i % 4],
                    points,
                )
            })
            .collect(),
    };
    vec![
        plot("lost_percent", "triangles lost, % of those seen at 2048²"),
        plot("lost_area_percent", "area lost, % of the image"),
    ]
}
