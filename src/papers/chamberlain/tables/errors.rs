//! Section 5: how far the images are from what they should look like, and how much they flicker from frame to
//! frame ("softer, more anti-aliased", "animates well").

use std::sync::Arc;

use super::frames::distance;
use super::samples::{Images, SAMPLES, color_cubes, geometry, sampled};
use crate::drawing::Plot;
use crate::geometry::{View, ViewPath};
use crate::measure::columns::{SCENE, SOURCE, column, measured};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::about;
use crate::measure::harness::{checkpoint, mean, part};
use crate::measure::{Cell, Setup, Table};
use crate::method::Run;
use crate::raster::{Light, Options};
use crate::scene::{Progress, Scene};
use crate::truth::{Truth, flip};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("path", "path", "", 0),
        column("distance_radii", "distance", "radii", 2),
        column("views", "views", "", 0),
        column("cubes_flip", "cubes", "FLIP", 4),
        column("geometry_flip", "geometry, 1 sample", "FLIP", 4),
        column("sampled_flip", "geometry, 2×2", "FLIP", 4),
        column("flip_ratio", "cubes of 1 sample", "times", 2),
        column("cubes_flicker", "cubes flicker", "FLIP", 4),
        column("geometry_flicker", "geometry flickers", "FLIP", 4),
        column("flicker_ratio", "of that", "times", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// The image, pixels a side, and samples a pixel of the image that all are compared with.
const SIDE: u32 = 124;
const REFERENCE: u32 = 16;
/// Frames of a flight whose changes are compared.
const FLIGHT: usize = 24;

/// The pictures of a view.
struct Seen {
    reference: Vec<u8>,
    cubes: Vec<u8>,
    geometry: Vec<u8>,
    sampled: Vec<u8>,
}

/// What sees them.
struct Looking<'a, S: World> {
    scene: &'a Scene<S>,
    options: Options,
    side: u32,
    truth: Truth,
    whole: Box<dyn Run<S>>,
    cubes: Box<dyn Run<S>>,
    images: Images,
}

impl<S: World> Looking<'_, S> {
    fn look(&mut self, view: &View<S>) -> Seen {
        let (scene, one, fine) = (self.scene, sampled(view, self.side, 1), sampled(view, self.side, SAMPLES));
        let mut seen = |run: &mut dyn Run<S>, view: &View<S>, samples: u32| {
            let list = self.images.frame(run, scene, view, &self.options);
            self.images.picture(&list, scene, view, samples)
        };
        Seen {
            cubes: seen(&mut *self.cubes, &fine, SAMPLES),
            geometry: seen(&mut *self.whole, &one, 1),
            sampled: seen(&mut *self.whole, &fine, SAMPLES),
            reference: self.truth.reference(scene, &one, REFERENCE, Light::Fixed).rgba,
        }
    }
    /// How far the pictures of each view are from the reference: cubes, geometry of one sample, and of more.
    fn errors(&self, seen: &[Seen]) -> [Vec<f64>; 3] {
        let of: [fn(&Seen) -> &[u8]; 3] = [|s| &s.cubes, |s| &s.geometry, |s| &s.sampled];
        of.map(|of| seen.iter().map(|s| self.flip(&s.reference, of(s))).collect())
    }
    /// What changes from view to view beyond what changes in the reference, in the mean: of cubes, and of
    /// geometry of one sample.
    fn flicker(&self, seen: &[Seen]) -> [f64; 2] {
        let change = |pair: &[Seen], of: fn(&Seen) -> &[u8]| self.flip(of(&pair[0]), of(&pair[1]));
        let of: [fn(&Seen) -> &[u8]; 2] = [|s| &s.cubes, |s| &s.geometry];
        of.map(|of| mean(seen.windows(2).map(|pair| change(pair, of) - change(pair, |s| &s.reference))))
    }
    /// How far two images of the size are from each other.
    fn flip(&self, a: &[u8], b: &[u8]) -> f64 {
        flip(a, b, self.side as usize, a.len() / 4 / self.side as usize).mean
    }
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let options = Options { surfaces: setup.settings.surfaces().both_sides(), ..Options::default() };
    let mut looking = Looking {
        scene,
        options,
        side: setup.size_px.map_or(SIDE, |[width, _]| width),
        truth: Truth::new(scene, setup.settings.surfaces(), 1, [1.0; 3]),
        whole: geometry(scene, setup, &part(progress, 0.0, 0.05))?,
        cubes: color_cubes(scene, setup, &[], &part(progress, 0.05, 0.3))?,
        images: Images::default(),
    };
    let paths = paths(scene, setup);
    let count: usize = paths.iter().map(|path| path.views.len()).sum();
    let mut rows = Vec::new();
    let mut done = 0;
    for (number, path) in paths.iter().enumerate() {
        let mut seen = Vec::new();
        for view in &path.views {
            checkpoint(progress, 0.3 + 0.7 * done as f32 / count as f32, "drawing and comparing")?;
            seen.push(looking.look(view));
            done += 1;
        }
        let errors = looking.errors(&seen);
        let row = |distance: Cell, views: usize, [cubes, geometry, sampled]: [f64; 3], flicker: [Cell; 3]| {
            let cells = [path.name.as_str().into(), distance, views.into()];
            let mut row = measured(scene.name(), cells, [cubes, geometry, sampled, cubes / geometry]);
            row.extend(flicker);
            row
        };
        if number == 0 {
            for (k, view) in path.views.iter().enumerate() {
                let far = distance(&scene.bounds(), view).into();
                rows.push(row(far, 1, errors.each_ref().map(|e| e[k]), [const { Cell::Missing }; 3]));
            }
            continue;
        }
        let [cubes, geometry] = looking.flicker(&seen);
        let flicker = [cubes, geometry, cubes / geometry].map(Cell::from);
        let errors = errors.map(|e| mean(e.into_iter()));
        rows.push(row(Cell::Missing, path.views.len(), errors, flicker));
    }
    let mut about = about(scene, &paths[0]);
    about.path = paths.iter().map(|path| path.name.as_str()).collect::<Vec<_>>().join(", ");
    Ok((rows, about))
}

/// The scene's paths: of the first single views are compared, of the others a stretch of frames that follow
/// each other.
fn paths<S: World>(scene: &Arc<Scene<S>>, setup: &Setup) -> Vec<ViewPath<S>> {
    let first = crate::measure::harness::path::whole_path(scene, setup);
    let flights = scene.paths().iter().skip(1).cloned();
    let short = |mut path: ViewPath<S>| {
        path.views.truncate(FLIGHT.min(setup.frames.max(2)));
        path
    };
    [first].into_iter().chain(flights).map(short).collect()
}

fn plots(_: &Table) -> Vec<Plot> {
    Vec::new()
}
