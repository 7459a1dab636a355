//! Section 7: "the visible set is stable, that is, the algorithm does not have major popping artifacts". The
//! paper gives no figures. Measured between views a step of a walker apart: triangles that are visible in
//! both and drawn in one of them only, and pixels that show the same triangle in both exact images and are
//! right in one view and wrong in the other.

use std::sync::Arc;

use super::ways::{
    BUDGET, BUDGETS, BY_CENTROID, DELAUNAY, Most, OCTREE, ORDER, PAPERS_DELAUNAY, PAPERS_OCTREE, RULES, Way,
    ready,
};
use crate::drawing::{Plot, Series, Shape};
use crate::geometry::{PrimId, Vector, View, ViewPath, WALKING_STEP_M};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{at_rest, whole_path};
use crate::measure::harness::{Judge, checkpoint, part};
use crate::measure::{Setup, Table};
use crate::method::Run;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        ORDER,
        RULES,
        BUDGET,
        column("exact_change_percent", "visible set changes", "%", 2),
        column("drawn_change_percent", "its drawn part changes", "%", 2),
        column("popped_triangles_percent", "triangles that pop", "% of visible in both", 2),
        column("popped_pixels_percent", "pixels that pop", "% of the image", 3),
        column("worst_pixels_percent", "in the worst pair", "% of the image", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

const WAYS: [Way; 5] = [PAPERS_DELAUNAY, PAPERS_OCTREE, DELAUNAY, OCTREE, BY_CENTROID];
/// Places along the path at which a walker starts, evenly spaced.
const STARTS: usize = 8;

/// Stretches of views a step apart, together as many as are to be measured, two at least in each.
fn stretches<S: World>(path: &ViewPath<S>, frames: usize) -> Vec<Vec<View<S>>> {
    // The most views of a walk, against scenes of another unit than the meter.
    const MOST: f32 = 1e6;
    let length: f32 = path.views.windows(2).map(|w| (w[1].eye.position - w[0].eye.position).length()).sum();
    let each = (frames / STARTS).max(2);
    // Where the step would leave too few views for all, they overlap.
    let total = (length / WALKING_STEP_M).clamp(each as f32, MOST) as usize;
    let walk = path.walked(WALKING_STEP_M, total).views;
    let starts = STARTS.min(frames.div_ceil(2)).max(1);
    (0..starts)
        .map(|i| (total - each) * i / starts.max(2).saturating_sub(1))
        .map(|first| walk[first..first + each].to_vec())
        .collect()
}

/// What is known of a view: the exact visible set and items, and for each run what of it was drawn and which
/// pixels are wrong.
struct Known {
    visible: Vec<PrimId>,
    items: Vec<u32>,
    of_run: Vec<(Vec<bool>, Vec<bool>)>,
}

impl Known {
    fn of<S: World>(
        judge: &mut Judge<S>,
        runs: &mut [Box<dyn Run<S>>],
        scene: &Scene<S>,
        view: &View<S>,
    ) -> Self {
        let visible = judge.look(view).to_vec();
        let mut known = Self { visible, items: judge.image().item.clone(), of_run: Vec::new() };
        for run in runs {
            let list = run.cull(view).prims;
            let mut drawn = vec![false; scene.prim_count()];
            list.iter().for_each(|p| drawn[p.at()] = true);
            known.of_run.push((drawn, judge.compare(&list).wrong));
        }
        known
    }
}

/// Sums over pairs of views.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    exact_change: f64,
    drawn_change: f64,
    popped: f64,
    pixels: f64,
    worst: f64,
    pairs: usize,
}

fn percent(part: usize, of: usize) -> f64 {
    100.0 * part as f64 / of.max(1) as f64
}

impl Sums {
    /// Adds a pair of views in which run `r` was used.
    fn add(&mut self, a: &Known, b: &Known, r: usize) {
        let ((drawn_a, wrong_a), (drawn_b, wrong_b)) = (&a.of_run[r], &b.of_run[r]);
        let in_b: Vec<bool> = {
            let mut set = vec![false; drawn_b.len()];
            b.visible.iter().for_each(|p| set[p.at()] = true);
            set
        };
        let both = || a.visible.iter().filter(|p| in_b[p.at()]);
        let of_both = both().count();
        self.exact_change += percent(
            a.visible.len() + b.visible.len() - 2 * of_both,
            a.visible.len() + b.visible.len() - of_both,
        );
        let kept = |known: &Known, drawn: &[bool]| known.visible.iter().filter(|p| drawn[p.at()]).count();
        let (kept_a, kept_b) = (kept(a, drawn_a), kept(b, drawn_b));
        let kept_both = both().filter(|p| drawn_a[p.at()] && drawn_b[p.at()]).count();
        self.drawn_change += percent(kept_a + kept_b - 2 * kept_both, kept_a + kept_b - kept_both);
        self.popped += percent(both().filter(|p| drawn_a[p.at()] != drawn_b[p.at()]).count(), of_both);
        let same = |i: &usize| a.items[*i] == b.items[*i] && a.items[*i] != Target::NONE;
        let pixels = percent(
            (0..a.items.len()).filter(same).filter(|&i| wrong_a[i] != wrong_b[i]).count(),
            a.items.len(),
        );
        self.pixels += pixels;
        self.worst = self.worst.max(pixels);
        self.pairs += 1;
    }
    fn means(&self) -> [f64; 5] {
        let n = self.pairs.max(1) as f64;
        [self.exact_change / n, self.drawn_change / n, self.popped / n, self.pixels / n, self.worst]
    }
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = whole_path(scene, setup);
    let mut runs = Vec::new();
    for (i, way) in WAYS.into_iter().enumerate() {
        runs.extend(ready(
            scene,
            setup,
            way,
            &BUDGETS.map(Most::Percent),
            &part(progress, 0.06 * i as f32, 0.06 * (i + 1) as f32),
        )?);
    }
    let mut judge = Judge::new(scene, setup);
    let mut sums = vec![Sums::default(); runs.len()];
    let all = stretches(&path, setup.frames);
    for (i, stretch) in all.iter().enumerate() {
        runs.iter_mut().for_each(|r| r.forget());
        let mut before: Option<Known> = None;
        for (k, view) in stretch.iter().enumerate() {
            let done = (i * stretch.len() + k) as f32 / (all.len() * stretch.len()) as f32;
            checkpoint(progress, 0.3 + 0.7 * done, "comparing a view with the next")?;
            let known = Known::of(&mut judge, &mut runs, scene, view);
            if let Some(before) = &before {
                (0..runs.len()).for_each(|r| sums[r].add(before, &known, r));
            }
            before = Some(known);
        }
    }
    let about = at_rest(scene, &path);
    let row = |r: usize| {
        let (way, budget) = (WAYS[r / BUDGETS.len()], BUDGETS[r % BUDGETS.len()]);
        measured(&about.name, way.cells().into_iter().chain([budget.into()]), sums[r].means())
    };
    Ok(((0..runs.len()).map(row).collect(), about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        for (key, what, y_label) in [
            ("popped_triangles_percent", "triangles that pop", "% of those visible in both views"),
            ("popped_pixels_percent", "pixels that pop", "% of the image"),
        ] {
            let series = WAYS
                .iter()
                .zip(rows.chunks(BUDGETS.len()))
                .map(|(way, rows)| Series::new(way.name(), way.role, points(table, rows, BUDGET.key, key)));
            plots.push(Plot {
                title: format!("{name}: {what}"),
                x_label: "budget, % of the triangles".into(),
                y_label: y_label.into(),
                shape: Shape::Lines { logarithmic: true, ticks: BUDGETS.to_vec() },
                series: series.collect(),
            });
        }
    }
    plots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_pops_is_what_changes_though_the_exact_image_does_not() {
        let id = |list: &[u32]| list.iter().copied().map(PrimId).collect::<Vec<_>>();
        let set = |list: &[usize]| (0..4).map(|i| list.contains(&i)).collect::<Vec<bool>>();
        // 0 and 1 are visible in both, 2 only before, 3 only after; 1 is drawn before and not after.
        let a = Known {
            visible: id(&[0, 1, 2]),
            items: vec![0, 0, 1, 2],
            of_run: vec![(set(&[0, 1]), set(&[3]))],
        };
        let b = Known {
            visible: id(&[0, 1, 3]),
            items: vec![0, 0, 1, 3],
            of_run: vec![(set(&[0, 3]), set(&[2]))],
        };
        let mut sums = Sums::default();
        sums.add(&a, &b, 0);
        // Visible: 2 of 4 change. Drawn and visible: {0, 1} to {0, 3}, 2 of 3 change. 1 of the 2 visible in
        // both pops. Pixel 2 shows triangle 1 in both and is wrong after; pixel 3 shows another triangle.
        let want = [50.0, 200.0 / 3.0, 50.0, 25.0, 25.0];
        assert!(sums.means().iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", sums.means());
        sums.add(&b, &b, 0);
        assert_eq!(sums.means()[3], 12.5, "nothing pops where nothing moves");
    }
}
