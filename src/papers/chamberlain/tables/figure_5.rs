//! Section 5.2, Figure 5: the time of a frame as a forest grows fourfold again and again, by the hierarchy
//! and by the geometry of all trees.

use std::sync::Arc;

use crate::culling::color_cubes::Projected;
use crate::culling::color_cubes::forest::{Counted, Forest, Stock};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{Vector, View};
use crate::measure::columns::{SCENE, SOURCE, column, points, quoted};
use crate::measure::experiment::{ExperimentError, Rows, Sweep, World};
use crate::measure::harness::{checkpoint, part, settings};
use crate::measure::{Cell, Experiment, Measured, Setup, Table, median, paired, timed};
use crate::papers::chamberlain::views::Place;
use crate::papers::keys::COLOR_CUBES;
use crate::raster::{Canvas, Options, Target};
use crate::scene::{Progress, Scene};

pub const TABLE: Experiment = Experiment {
    name: "chamberlain-figure-5",
    method: COLOR_CUBES,
    scenes: &["generate:tree"],
    title: "Chamberlain et al. 1996, Figure 5: rendering time as the scene grows",
    summary: "Forests of 1 to 1,048,576 trees, 55 billion triangles: time by color cubes and by geometry",
    notes: &[
        "Wall-clock times on one thread from the view to the finished depths and colors of samples, medians. \
         Trees are one stored tree that is seen from shifted eyes; the hierarchy stands over all of them, \
         and nothing is transformed or kept. Geometry is drawn tree by tree, those in view, which is kind \
         to it: one tree stays in the cache.",
        "Geometry is left out where it has more than 4 million triangles for each of --frames: by default \
         above 16,384 trees; the largest forests are drawn once.",
        "In the forest the eye stands between trees, at the same place for all sizes; from above the whole \
         square is in view, so that trees shrink as they become more. The paper's images have 124 × 124 \
         pixels of 2 × 2 samples, and cells no larger than a pixel are drawn as cubes, so 2 samples here.",
        "Growth: the exponent p of the power n^p that fits best from 256 trees on, of each column. An \
         exponent of 0 is no growth. The paper says that time grows as the logarithm; its own two numbers, \
         20 trees and 16,384 trees, are a power of 0.33. Its times follow from 39 million polygons a \
         second and 88 times.",
        "Working set: what is read of nodes, references and triangles, if each tree had its own; here all \
         share one tree's.",
    ],
    settings: &[],
    sweep: &SWEEP,
};

const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("view", "view", "", 0),
        column("image", "image", "samples", 0),
        column("trees", "trees", "", 0),
        column("triangles", "triangles", "", 0),
        column("hierarchy_ms", "color cubes", "ms", 2),
        column("geometry_ms", "geometry", "ms", 1),
        column("speedup_ratio", "faster", "times", 1),
        column("visited_cells", "visited", "cells", 0),
        column("drawn_cubes", "drawn", "cubes", 0),
        column("drawn_triangles", "drawn", "triangles", 0),
        column("working_set_mb", "working set", "MB", 2),
        column("time_power", "growth", "of time", 2),
        column("cells_power", "growth", "of visited", 2),
        column("memory_power", "growth", "of working set", 2),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// The largest forest has 4 to the power of it.
const LEVELS: u32 = 10;
/// The growth of what has so many trees is no matter of the near field any more.
const FIT_FROM: f64 = 256.0;
/// Triangles that are drawn at most as geometry in one image, for each frame that is asked for.
const MOST_TRIANGLES: u64 = 4_000_000;
/// Up to so many are drawn more than once.
const QUICK_TRIANGLES: u64 = 4_000_000;
/// Images of the paper's size, with two samples a side of a pixel, and large ones with one.
const SIZES: [(u32, &str); 2] = [(248, "2"), (1024, "1")];
const THRESHOLD: &str = "pixel-threshold";

/// What was measured of one forest from one view.
struct One {
    place: Place,
    size: [u32; 2],
    trees: u64,
    triangles: u64,
    hierarchy_ms: f64,
    geometry: Option<(f64, f64)>,
    counted: Counted,
}

impl One {
    fn of<S: Projected + World>(forest: &Forest<'_, S>, place: Place, view: &View<S>, frames: usize) -> Self {
        let (_, counted) = forest.count(view);
        let (options, mut canvas) = (Options::default(), Canvas::default());
        let [mut image, mut whole] = [Target::default(), Target::default()];
        let mut hierarchy = || forest.draw(&forest.cull(view), (&mut image, &mut canvas), view, &options);
        let mut geometry = || _ = forest.draw_geometry(&mut whole, view, &options);
        let rounds = frames.clamp(1, 5);
        let (hierarchy_ms, geometry) =
            if forest.prims() <= QUICK_TRIANGLES.min(MOST_TRIANGLES * frames as u64) {
                let both = paired(rounds, &mut hierarchy, &mut geometry);
                (both.a_ms, Some((both.b_ms, both.ratio)))
            } else {
                hierarchy();
                let ms = median((0..rounds).map(|_| timed(&mut hierarchy).1).collect());
                let is_drawn = forest.prims() <= MOST_TRIANGLES * frames as u64;
                (ms, is_drawn.then(|| timed(geometry).1).map(|all| (all, all / ms)))
            };
        Self {
            place,
            size: [view.width, view.height],
            trees: forest.copies(),
            triangles: forest.prims(),
            hierarchy_ms,
            geometry,
            counted,
        }
    }
    fn names(&self, source: &str, scene: &str) -> [(&'static str, Cell); 4] {
        [
            (SOURCE.key, source.into()),
            (SCENE.key, scene.into()),
            ("view", self.place.name().into()),
            ("image", format!("{} × {}", self.size[0], self.size[1]).as_str().into()),
        ]
    }
    fn row(&self, scene: &str) -> Vec<Cell> {
        let count = |count: u64| Cell::from(count as f64);
        let numbers = [
            ("trees", count(self.trees)),
            ("triangles", count(self.triangles)),
            ("hierarchy_ms", self.hierarchy_ms.into()),
            ("geometry_ms", self.geometry.map(|g| g.0).into()),
            ("speedup_ratio", self.geometry.map(|g| g.1).into()),
            ("visited_cells", count(self.counted.cells)),
            ("drawn_cubes", count(self.counted.cubes)),
            ("drawn_triangles", count(self.counted.prims)),
            ("working_set_mb", (self.counted.bytes as f64 * 1e-6).into()),
        ];
        quoted(SWEEP.columns, self.names("measured", scene).into_iter().chain(numbers))
    }
}

/// The exponent of the power that fits points best: the slope of a straight line through their logarithms, by
/// least squares. Nothing through fewer than two places.
fn power(points: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.into_iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (over, under) =
        logs.iter().fold((0.0, 0.0), |(o, u), p| (o + (p.0 - x) * (p.1 - y), u + (p.0 - x) * (p.0 - x)));
    (under > 0.0).then(|| over / under)
}

/// The row that says how all of a view grew.
fn growth(series: &[One], scene: &str) -> Option<Vec<Cell>> {
    let of = |value: fn(&One) -> f64| {
        power(series.iter().map(|one| (one.trees as f64, value(one))).filter(|p| p.0 >= FIT_FROM))
    };
    let numbers = [
        ("time_power", of(|one| one.hierarchy_ms).into()),
        ("cells_power", of(|one| one.counted.cells as f64).into()),
        ("memory_power", of(|one| one.counted.bytes as f64).into()),
    ];
    let names = series.first()?.names("growth from 256 trees", scene);
    Some(quoted(SWEEP.columns, names.into_iter().chain(numbers)))
}

fn rows<S: World + Projected>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let sizes: Vec<([u32; 2], &str)> = match setup.size_px {
        Some(size) => vec![(size, SIZES[0].1)],
        None => SIZES.map(|(side, threshold)| ([side; 2], threshold)).to_vec(),
    };
    let mut rows = Vec::new();
    for (number, &(size, threshold)) in sizes.iter().enumerate() {
        let own = setup.settings.0.contains_key(THRESHOLD);
        let on_top = [(THRESHOLD, threshold)];
        let settings = settings::<S>(COLOR_CUBES, setup, if own { &[] } else { &on_top })?;
        let [first, last] = [0, 1].map(|k| (number + k) as f32 / sizes.len() as f32);
        let stock = Stock::new(scene, &settings, &part(progress, first, first + 0.02))?;
        let stock = stock.ok_or(ExperimentError::Cancelled)?;
        let rest = part(progress, first + 0.02, last);
        let size = [size[0], if S::Vector::AXES == 2 { 1 } else { size[1] }];
        for (at, place) in [Place::Within, Place::Above].into_iter().enumerate() {
            let mut series = Vec::new();
            for levels in 0..=LEVELS {
                let done = at as f32 * 0.5 + 0.5 * (levels as f32 / (LEVELS + 1) as f32);
                checkpoint(&rest, done, "drawing forests")?;
                let view = place.view(&stock, 1 << levels, size);
                series.push(One::of(&stock.forest(levels), place, &view, setup.frames));
            }
            rows.extend(series.iter().map(|one| one.row(scene.name())));
            rows.extend(growth(&series, scene.name()));
        }
    }
    let about = Measured {
        name: scene.name().into(),
        source: scene.source().into(),
        prims: scene.live().len(),
        prim: S::PRIM,
        path: "two views of a square of copies".into(),
    };
    Ok((rows, about))
}

/// What Section 5.2 prints: where both take the same time, and the largest forest.
const TREE: f64 = 52_470.0;
const CROSSOVER: f64 = 20.0;
const MOST: f64 = 16_384.0;
const SPEEDUP: f64 = 88.0;
/// "Equivalent to 39 million raw polygons per second", in milliseconds.
const RATE: f64 = 39_000.0;

/// Trees, and the time by color cubes and by geometry that follows, ms.
fn paper_times() -> [[f64; 3]; 2] {
    // Geometry takes as long for a polygon wherever it is.
    [(CROSSOVER, SPEEDUP / RATE), (MOST, 1.0 / RATE)]
        .map(|(trees, ms)| [trees, trees * TREE * ms, trees * TREE * (SPEEDUP / RATE)])
}

fn paper() -> Vec<Vec<Cell>> {
    let names = |source: &str| [(SOURCE.key, source.into()), (SCENE.key, "tree".into())];
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for [trees, hierarchy, geometry] in paper_times() {
        let numbers = [
            ("trees", trees.into()),
            ("triangles", (trees * TREE).into()),
            ("hierarchy_ms", hierarchy.into()),
            ("geometry_ms", geometry.into()),
            ("speedup_ratio", (geometry / hierarchy).into()),
        ];
        rows.push(quoted(SWEEP.columns, names("paper, Section 5.2").into_iter().chain(numbers)));
    }
    let grown = power(paper_times().map(|[trees, hierarchy, _]| (trees, hierarchy)));
    let numbers = [("time_power", grown.into())];
    rows.push(quoted(SWEEP.columns, names("paper, from these two").into_iter().chain(numbers)));
    rows
}

fn plots(table: &Table) -> Vec<Plot> {
    let at = |key: &str| table.columns.iter().position(|c| c.key == key).expect("a column");
    let (view, image) = (at("view"), at("image"));
    let mut images: Vec<&Cell> = table.rows.iter().map(|row| &row[image]).collect();
    images.dedup();
    images.truncate(SIZES.len());
    let line = |size: &Cell, place: Place, key: &str, label: &str, role| {
        let is_of = |row: &Vec<Cell>| row[image] == *size && row[view] == Cell::from(place.name());
        let rows: Vec<usize> = (0..table.rows.len()).filter(|r| is_of(&table.rows[*r])).collect();
        Series::new(format!("{label}, {}", place.name()), role, points(table, &rows, "triangles", key))
    };
    let plot = |title: String, y_label: &str, series: Vec<Series>| Plot {
        title,
        x_label: "triangles".into(),
        y_label: y_label.into(),
        shape: Shape::Powers,
        series,
    };
    let mut plots = Vec::new();
    for (number, size) in images.iter().enumerate() {
        let Cell::Text(title) = size else { continue };
        let mut series = vec![
            line(size, Place::Within, "hierarchy_ms", "color cubes", Role::Visible),
            line(size, Place::Above, "hierarchy_ms", "color cubes", Role::Evidence),
            line(size, Place::Within, "geometry_ms", "geometry", Role::Scene),
            line(size, Place::Above, "geometry_ms", "geometry", Role::Ink),
        ];
        if number == 0 {
            let quote = |k: usize| paper_times().map(|times| (times[0] * TREE, times[k])).to_vec();
            series.push(Series::new("paper, color cubes", Role::Approximated, quote(1)));
            series.push(Series::new("paper, geometry", Role::Outside, quote(2)));
        }
        plots.push(plot(title.clone(), "time, ms", series));
    }
    if let Some(size) = images.first() {
        let visited = [(Place::Within, Role::Visible), (Place::Above, Role::Evidence)]
            .map(|(place, role)| line(size, place, "visited_cells", "color cubes", role));
        plots.push(plot(String::new(), "visited cells", visited.to_vec()));
    }
    plots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_found() {
        let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-12);
        assert!(near(power([(1.0, 3.0), (4.0, 6.0), (16.0, 12.0)]), 0.5));
        assert!(near(power([(2.0, 7.0), (8.0, 7.0)]), 0.0));
        // One off the line: the slope of (0, 0), (1, 1), (2, 1), by hand 1/2.
        let e = std::f64::consts::E;
        assert!(near(power([(1.0, 1.0), (e, e), (e * e, e)]), 0.5));
        assert!(power([(2.0, 7.0)]).is_none());
        // From 20 to 16,384 trees the paper's time grows 9.31 times, for 819.2 times as many.
        let [[few, short, same], [many, long, _]] = paper_times();
        assert_eq!(short, same);
        assert!((long / short - 9.31).abs() < 0.01 && many / few == 819.2);
        assert!((power(paper_times().map(|t| (t[0], t[1]))).expect("two") - 0.332_6).abs() < 1e-3);
    }
}
