//! Sections 6.1 and 7.2: the time to make all levels of opacity, beside a z-pyramid of the same image, and
//! averages beside minima.

use std::hint::black_box;
use std::sync::Arc;

use super::fly::{counted, mapper};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{PixelRect, View};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{draw, part};
use crate::measure::timing::{median, paired};
use crate::measure::{Cell, Setup, Table};
use crate::raster::{Pyramid, Target};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("side_px", "image side", "px", 0),
        column("map_px", "finest map", "px", 0),
        column("levels", "levels", "", 0),
        column("opacity_ms", "all levels of opacity", "ms", 3),
        column("pyramid_ms", "z-pyramid", "ms", 3),
        column("opacity_ratio", "of that", "times", 2),
        column("maps_ms", "maps with occluders", "ms", 3),
        column("buffer_ms", "z-buffer, pyramid", "ms", 3),
        column("maps_ratio", "of that", "times", 2),
        column("average_ms", "2 × 2 averages", "ms", 4),
        column("minimum_ms", "2 × 2 minima", "ms", 4),
        column("average_ratio", "of that", "times", 2),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Sides of the square image.
const SIDES: [u32; 4] = [256, 512, 1024, 2048];
/// Views that are timed, and rounds at each.
const VIEWS: usize = 8;
const ROUNDS: usize = 9;
/// Side of the map that plain loops average down, and of the last one (Section 6.1).
const PLAIN: usize = 256;
const LAST: usize = 4;

/// Makes all levels over a square of numbers, of 2×2 numbers of the level below each; returns the sum of the
/// last, so that nothing is left out.
fn levels(finest: &[f32], room: &mut [Vec<f32>], of: impl Fn([f32; 4]) -> f32) -> f32 {
    let mut side = PLAIN;
    for level in 0..room.len() {
        let (done, rest) = room.split_at_mut(level);
        let below = done.last().map_or(finest, |v| &v[..]);
        let rows = below.chunks_exact(2 * side);
        for (to, pair) in rest[0].chunks_exact_mut(side / 2).zip(rows) {
            let (upper, lower) = pair.split_at(side);
            for ((to, a), b) in to.iter_mut().zip(upper.chunks_exact(2)).zip(lower.chunks_exact(2)) {
                *to = of([a[0], a[1], b[0], b[1]]);
            }
        }
        side /= 2;
    }
    room.last().map_or(0.0, |last| last.iter().sum())
}

/// Averages and minima of the same numbers, in turn, ms.
fn plain() -> [f64; 2] {
    // Such as a depth image: no two alike.
    let finest: Vec<f32> = (0..PLAIN * PLAIN).map(|i| (i * 7919 % 10_007) as f32 / 10_007.0).collect();
    let sides = std::iter::successors(Some(PLAIN / 2), |side| Some(side / 2)).take_while(|s| *s >= LAST);
    let room: Vec<Vec<f32>> = sides.map(|side| vec![0.0; side * side]).collect();
    let (mut a, mut b) = (room.clone(), room);
    let average = |[a, b, c, d]: [f32; 4]| (a + b + (c + d)) * 0.25;
    let least = |a: f32, b: f32| if a < b { a } else { b };
    let minimum = |[a, b, c, d]: [f32; 4]| least(least(a, b), least(c, d));
    let pair = paired(
        101,
        || _ = black_box(levels(black_box(&finest), &mut a, average)),
        || _ = black_box(levels(black_box(&finest), &mut b, minimum)),
    );
    [pair.a_ms, pair.b_ms]
}

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, &Setup { frames: VIEWS.min(setup.frames), ..setup.clone() });
    let mut mapper = mapper(scene, setup, &[], &part(progress, 0.0, 0.2))?;
    let surfaces = setup.settings.surfaces();
    let (mut target, mut pyramid) = (Target::default(), Pyramid::default());
    let mut rows = Vec::new();
    let [average, minimum] = plain();
    for (i, side) in SIDES.into_iter().enumerate() {
        let sized =
            |view: &View<S>| View { width: side, height: if S::CORNERS == 2 { 1 } else { side }, ..*view };
        let views: Vec<View<S>> = path.views.iter().map(sized).collect();
        let mut times = [const { Vec::new() }; 4];
        let some = part(progress, 0.2 + 0.2 * i as f32, 0.4 + 0.2 * i as f32);
        counted(scene, &mut mapper, &views, &some, |k, scene, mapper, _, _| {
            draw(&mut target, scene, &views[k], &mapper.occluders(), surfaces);
            pyramid.clear(target.width, target.height, 1.0 / views[k].eye.far);
            let all = PixelRect { x0: 0, x1: target.width, y0: 0, y1: target.height };
            let pair = paired(
                ROUNDS,
                || mapper.build_levels(),
                || {
                    pyramid.touch(all);
                    pyramid.refresh_all(&target.depth);
                },
            );
            times[0].push(pair.a_ms);
            times[1].push(pair.b_ms);
            let occluders = mapper.occluders();
            let pair = paired(
                ROUNDS,
                || mapper.make_maps(&views[k]),
                || {
                    draw(&mut target, scene, &views[k], &occluders, surfaces);
                    pyramid.touch(all);
                    pyramid.refresh_all(&target.depth);
                },
            );
            times[2].push(pair.a_ms);
            times[3].push(pair.b_ms);
        })?;
        let [opacity, whole, maps, buffer] = times.map(median);
        let [columns, levels] = [mapper.opacity().size(0)[0].into(), f64::from(mapper.opacity().levels())];
        let plain = [average, minimum, average / minimum];
        let of = [opacity / whole, maps / buffer];
        let numbers = [side.into(), columns, levels, opacity, whole, of[0], maps, buffer, of[1]];
        let mut row = measured(scene.name(), [], numbers);
        row.extend(plain.map(Cell::from));
        rows.push(row);
    }
    Ok((rows, about(scene, &path)))
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |machine: &str, ms: f64| {
        let cells = [
            (SOURCE.key, format!("paper, {machine}").as_str().into()),
            (SCENE.key, "any".into()),
            ("side_px", 1024usize.into()),
            ("map_px", 256usize.into()),
            ("opacity_ms", ms.into()),
            ("average_ratio", "below 1".into()),
        ];
        quoted(SWEEP.columns, cells)
    };
    vec![row("Max Impact", 9.0), row("InfiniteReality", 4.0)]
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |(name, rows): (String, Vec<usize>)| {
        let series = |(key, label, role): (&str, &str, Role)| {
            Series::new(label, role, points(table, &rows, "side_px", key))
        };
        let ways = [
            ("opacity_ms", "all levels of opacity", Role::Visible),
            ("pyramid_ms", "z-pyramid brought up to date", Role::Outside),
        ];
        Plot {
            title: name,
            x_label: "side of the image, pixels".into(),
            y_label: "ms".into(),
            shape: Shape::Lines { logarithmic: true, ticks: SIDES.map(f64::from).to_vec() },
            series: ways.map(series).to_vec(),
        }
    };
    by_scene(table).into_iter().map(plot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_loops_average_and_take_minima() {
        let mut room: Vec<Vec<f32>> = vec![vec![0.0; 128 * 128], vec![0.0; 64 * 64]];
        // Columns of 0 and 1 in turn, on even rows.
        let finest: Vec<f32> = (0..PLAIN * PLAIN)
            .map(|i| if i % 2 == 1 && (i / PLAIN).is_multiple_of(2) { 1.0 } else { 0.0 })
            .collect();
        let sum = levels(&finest, &mut room, |v| v.iter().sum::<f32>() * 0.25);
        assert_eq!((room[0][5], room[1][7], sum), (0.25, 0.25, 0.25 * 64.0 * 64.0));
        assert_eq!(levels(&finest, &mut room, |v| v.into_iter().fold(9.0, f32::min)), 0.0);
    }
}
