//! Sections 4.3 and 5.1: random rectangles asked of the hierarchy, of level 0 and of the samples.

use std::sync::Arc;

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::fly::{counted, mapper};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::PixelRect;
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::part;
use crate::measure::harness::path::{about, path};
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("threshold", "threshold", "", 2),
        column("rectangles", "asked about", "rectangles", 0),
        column("covered_percent", "covered", "%", 1),
        column("finest_differences", "level 0 differs", "answers", 0),
        column("samples_differences", "samples differ", "answers", 0),
        column("hierarchy_reads", "reads, hierarchy", "a rectangle", 2),
        column("finest_reads", "level 0", "a rectangle", 2),
        column("samples_reads", "samples", "a rectangle", 1),
        column("saved_ratio", "fewer than level 0", "times", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// Opacity thresholds, each with what it adds up to.
const THRESHOLDS: [f32; 4] = [1.0, 0.9, 0.7, 0.5];

/// Sums over rectangles.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    asked: usize,
    covered: usize,
    differences: [usize; 2],
    reads: [f64; 3],
}

/// A rectangle of pixels in an image; of any size, or small.
fn rectangle(rng: &mut Pcg32, [width, height]: [u32; 2], is_small: bool) -> PixelRect {
    let mut below = |n: u32| ((u64::from(rng.next_u32()) * u64::from(n)) >> 32) as u32;
    let mut span = |end: u32| {
        let (a, b) = (below(end), below(end));
        if is_small {
            // Up to a sixteenth of the image, as most boxes of a model are.
            let past = (a + 1 + b / 16).min(end);
            return [a, past];
        }
        [a.min(b), a.max(b) + 1]
    };
    let ([x0, x1], [y0, y1]) = (span(width), span(height));
    PixelRect { x0, x1, y0, y1 }
}

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let mut mapper = mapper(scene, setup, &[], &part(progress, 0.0, 0.1))?;
    let (mut sums, mut rng) = ([Sums::default(); THRESHOLDS.len()], Pcg32::new(5, 54));
    let (mut tests, mut reads, n) = (0, 0, path.views.len());
    counted(scene, &mut mapper, &path.views, &part(progress, 0.1, 1.0), |k, _, mapper, _, counted| {
        (tests, reads) = (tests + counted.overlap_tests, reads + counted.map_reads);
        let covered = mapper.covered();
        // As many at each frame, and together as many as are wanted.
        for i in setup.rectangles * k / n..setup.rectangles * (k + 1) / n {
            let samples = rectangle(&mut rng, mapper.opacity().samples(), i % 2 == 0);
            for (threshold, sums) in THRESHOLDS.into_iter().zip(&mut sums) {
                let asked = mapper.ask(&covered, samples, mapper.black_at(threshold));
                let (answer, _) = asked.hierarchy;
                sums.asked += 1;
                sums.covered += usize::from(answer);
                for (differences, other) in sums.differences.iter_mut().zip([asked.finest, asked.samples]) {
                    *differences += usize::from(other.0 != answer);
                }
                let all = [asked.hierarchy, asked.finest, asked.samples];
                sums.reads.iter_mut().zip(all).for_each(|(sum, (_, reads))| *sum += f64::from(reads));
            }
        }
    })?;
    let about = about(scene, &path);
    let mut rows = Vec::new();
    for (threshold, sums) in THRESHOLDS.into_iter().zip(&sums) {
        let each = |sum: f64| sum / sums.asked.max(1) as f64;
        let [hierarchy, finest, samples] = sums.reads.map(each);
        let numbers = [
            // Two digits are what it says.
            (f64::from(threshold) * 100.0).round() / 100.0,
            sums.asked as f64,
            100.0 * each(sums.covered as f64),
            sums.differences[0] as f64,
            sums.differences[1] as f64,
            hierarchy,
            finest,
            samples,
            finest / hierarchy,
        ];
        rows.push(measured(&about.name, [], numbers));
    }
    let mut own: Vec<Cell> = measured(&about.name, ["boxes of the frames".into(), tests.into()], []);
    own.extend([(); 3].map(|()| Cell::Missing));
    own.push((reads as f64 / f64::from(tests.max(1) as u32)).into());
    own.extend([(); 3].map(|()| Cell::Missing));
    rows.push(own);
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |(name, rows): (String, Vec<usize>)| {
        let series = |(key, label, role): (&str, &str, Role)| {
            Series::new(label, role, points(table, &rows, "threshold", key))
        };
        let ways = [
            ("finest_reads", "level 0 alone", Role::Outside),
            ("hierarchy_reads", "hierarchy", Role::Visible),
        ];
        Plot {
            title: name,
            x_label: "opacity threshold".into(),
            y_label: "map pixels read a rectangle".into(),
            shape: Shape::Lines { logarithmic: true, ticks: vec![0.5, 0.7, 0.9, 1.0] },
            series: ways.map(series).to_vec(),
        }
    };
    by_scene(table).into_iter().map(plot).collect()
}
