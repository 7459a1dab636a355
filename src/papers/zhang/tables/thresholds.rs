//! Section 5.4, Figures 6 and 7: a house behind trees at several opacity thresholds. What is culled, what is
//! missed by it, and the bound: a pixel is wrong only where an accepted map pixel is black, and such a pixel
//! has at most n black samples.

use std::sync::Arc;

use super::fly::{counted, mapper};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::{PrimId, View};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{Judge, part};
use crate::measure::{Cell, ExperimentError, Setup, Table};
use crate::scene::{Object, Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("threshold", "threshold", "", 3),
        column("ignored_samples", "n, black samples ignored", "a map pixel", 0),
        column("house_percent", "house culled", "% of it in view", 1),
        column("culled_percent", "culled", "% of those in view", 1),
        column("drawn_triangles", "drawn", "triangles", 0),
        column("missed_visible", "visible and missed", "triangles", 1),
        column("wrong_pixels", "wrong", "pixels", 1),
        column("wrong_percent", "wrong", "% of the image", 4),
        column("accepted_pixels", "accepted with holes", "map pixels", 1),
        column("black_samples", "black in them", "samples", 1),
        column("bound_pixels", "n × accepted", "pixels", 1),
        column("over_bound_frames", "wrong beyond that", "frames", 0),
        column("checked_frames", "checked", "frames", 0),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// The paper's example is the second.
const THRESHOLDS: [f64; 5] = [1.0, 0.902, 0.8, 0.7, 0.5];
/// Objects of this name or group are what stands behind.
const HOUSE: &str = "house";

/// Sums over the frames of a threshold.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    most: usize,
    house: [usize; 2],
    culled_percent: f64,
    drawn: usize,
    missed: usize,
    wrong: usize,
    pixels: usize,
    accepted: usize,
    black: usize,
    over: usize,
    checked: usize,
}

impl Sums {
    /// The row of a threshold over so many frames.
    fn row(&self, name: &str, threshold: f64, frames: usize) -> Vec<Cell> {
        let [each, of_checked] = [frames as f64, self.checked.max(1) as f64];
        let percent = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
        let house = (self.house[1] > 0).then(|| percent(self.house[0], self.house[1]));
        let numbers = [
            self.culled_percent / each,
            self.drawn as f64 / each,
            self.missed as f64 / of_checked,
            self.wrong as f64 / of_checked,
            percent(self.wrong, self.pixels),
            self.accepted as f64 / each,
            self.black as f64 / each,
            (self.most * self.accepted) as f64 / each,
        ];
        let mut row = measured(name, [threshold.into(), self.most.into(), house.into()], numbers);
        row.extend([self.over.into(), self.checked.into()]);
        row
    }
}

/// Runs along the views with a threshold; `house`: of each object whether it is what stands behind.
fn sums<S: World + Faces>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    views: &[View<S>],
    judge: &mut Judge<S>,
    house: &[bool],
    threshold: f64,
    progress: &dyn Progress,
) -> Result<Sums, ExperimentError> {
    let text = threshold.to_string();
    let mut mapper = mapper(scene, setup, &[("opacity-threshold", &text)], &part(progress, 0.0, 0.1))?;
    let mut sums = Sums::default();
    counted(scene, &mut mapper, views, &part(progress, 0.1, 1.0), |k, scene, mapper, drawn, counted| {
        let in_house = |prim: &PrimId| house[scene.object_of(*prim).at()];
        let ignored = mapper.ignored();
        let culled = mapper.culled().filter(in_house).count();
        sums.most = ignored.most;
        sums.house[0] += culled;
        sums.house[1] += culled + drawn.iter().filter(|p| in_house(p)).count();
        let all_culled = (counted.hidden + counted.presumed) as f64;
        sums.culled_percent += 100.0 * all_culled / counted.in_view.max(1) as f64;
        sums.drawn += drawn.len();
        (sums.accepted, sums.black) = (sums.accepted + ignored.map_pixels, sums.black + ignored.samples);
        if setup.check_every > 0 && k.is_multiple_of(setup.check_every) {
            judge.pose(scene);
            let visible = judge.look(&views[k]).len();
            let difference = judge.compare(drawn);
            let wrong = difference.wrong.iter().filter(|w| **w).count();
            sums.missed += visible - difference.found;
            (sums.wrong, sums.pixels) = (sums.wrong + wrong, sums.pixels + difference.wrong.len());
            sums.over += usize::from(wrong > ignored.most * ignored.map_pixels);
            sums.checked += 1;
        }
    })?;
    Ok(sums)
}

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let about = about(scene, &path);
    let is_house = |object: &Object| object.name == HOUSE || object.group == HOUSE;
    let house: Vec<bool> = scene.objects().iter().map(is_house).collect();
    let (mut judge, mut rows) = (Judge::new(scene, setup), Vec::new());
    for (i, threshold) in THRESHOLDS.into_iter().enumerate() {
        let some = part(progress, 0.2 * i as f32, 0.2 * (i + 1) as f32);
        let sums = sums(scene, setup, &path.views, &mut judge, &house, threshold, &some)?;
        rows.push(sums.row(&about.name, threshold, path.views.len()));
    }
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let plot = |what: &str, y_label: &str, lines: &[(&str, &str, Role)]| Plot {
            title: format!("{name}: {what}"),
            x_label: "opacity threshold".into(),
            y_label: y_label.into(),
            shape: Shape::Lines { logarithmic: true, ticks: vec![0.5, 0.7, 0.8, 0.9, 1.0] },
            series: lines
                .iter()
                .map(|(key, label, role)| Series::new(*label, *role, points(table, &rows, "threshold", key)))
                .collect(),
        };
        let culled = [
            ("house_percent", "of the house", Role::Hidden),
            ("culled_percent", "of all in view", Role::Visible),
        ];
        plots.push(plot("culled", "triangles culled, %", &culled));
        let lost = [
            ("wrong_pixels", "wrong pixels", Role::Wrong),
            ("black_samples", "black samples that are ignored", Role::Outside),
        ];
        plots.push(plot("lost", "pixels", &lost));
    }
    plots
}
