//! Stability: where a small step of the eye changes what a method draws though nothing changes in truth
//! (popping), what it leaves out wrongly, and how near its decisions are to the opposite ones.
//!
//! A primitive *pops* between two neighboring views where it is visible at both and drawn at one of them
//! only; a pixel pops where it differs between the method's pictures and does not between the exact ones, all
//! under a light that is fixed in the world. A method that draws all that is visible pops nowhere.

mod along;
mod flip;
mod grid;
mod margin;
mod proof;
mod seen;
mod tables;

pub use along::{Found, Station, along};
pub use flip::{Decided, Flip, narrowed};
pub use grid::{STEP_SHARE, Spot, floor_axes, over_floor};
pub use margin::relative;
pub use proof::{Proof, proof};
pub use seen::{Change, Seen, Watcher};
pub use tables::{grid_table, path_table, summary};

use std::cmp::Reverse;
use std::sync::Arc;

use super::experiment::{ExperimentError, World};
use super::harness::part;
use crate::geometry::{Aabb, Vector, View};
use crate::method::Run;
use crate::scene::{Progress, Scene};

/// What is to be found out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ask {
    /// Cells of the grid along each axis of the floor; 0: no grid.
    pub grid: usize,
    /// Popping steps of the path that are narrowed, those with the most popped pixels first.
    pub flips: usize,
    /// How near together the eyes on both sides of a flip are to be, as a share of the scene's diagonal.
    pub tolerance_share: f32,
    /// If not 0, the decisions of the path are made again by the independent checker, and those are counted
    /// that are within so many units in the last place of flipping.
    pub ulps: u32,
}

impl Default for Ask {
    fn default() -> Self {
        Self { grid: 16, flips: 3, tolerance_share: 1e-6, ulps: 0 }
    }
}

/// How stable a method is on a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// A row a view of the path.
    pub path: Vec<Station>,
    /// A row a place of the grid.
    pub grid: Vec<Spot>,
    /// What the grid covers, the scene and the eyes of the path: least and greatest corner, a number an axis.
    pub floor: [Vec<f32>; 2],
    /// Where decisions flip between views of the path.
    pub flips: Vec<Flip>,
    /// How near together the eyes on both sides of a flip were to be, world units.
    pub tolerance: f32,
    /// What became of the path's decisions when they were made again, if that was asked for.
    pub proof: Option<Proof>,
}

impl Stability {
    /// All of the path together.
    pub fn on_path(&self) -> Found {
        joined(self.path.iter().map(|s| &s.found))
    }
    /// All of the grid together.
    pub fn on_grid(&self) -> Found {
        joined(self.grid.iter().map(|s| &s.found))
    }
}

fn joined<'a>(all: impl Iterator<Item = &'a Found>) -> Found {
    let mut sum = Found::default();
    all.for_each(|found| sum.join(found));
    sum
}

/// Follows the views of a path and looks over the floor that scene and path take up, from the first one's
/// height and direction. `run` was made ready for frame 0 of the scene; view i sees frame i where objects
/// move, the grid frame 0.
///
/// # Errors
/// It was cancelled.
pub fn stability<S: World>(
    scene: &Arc<Scene<S>>,
    run: &mut dyn Run<S>,
    views: &[View<S>],
    ask: &Ask,
    progress: &dyn Progress,
) -> Result<Stability, ExperimentError> {
    let tolerance = scene.bounds().diagonal() * ask.tolerance_share;
    let mut watcher = Watcher::new(scene, run);
    let path = along(&mut watcher, views, true, &part(progress, 0.0, 0.3))?;
    let mut popping: Vec<usize> = (1..path.len()).filter(|at| !path[*at].popped.is_empty()).collect();
    popping.sort_by_key(|at| Reverse((path[*at].found.popped_pixels, path[*at].popped.len())));
    let mut flips = Vec::new();
    for (k, at) in popping.into_iter().take(ask.flips).enumerate() {
        let here = part(progress, 0.3 + 0.1 * k as f32 / ask.flips as f32, 0.4);
        let between = (at - 1, [&views[at - 1], &views[at]]);
        flips.extend(narrowed(&mut watcher, between, path[at].popped[0], tolerance, &here)?);
    }
    let eyes = Aabb::of(views.iter().map(|view| view.eye.position));
    let floor = scene.bounds().union(eyes);
    let mut grid = Vec::new();
    if let (Some(view), true) = (views.first(), ask.grid > 0) {
        let step = scene.bounds().diagonal() * STEP_SHARE;
        grid = over_floor(&mut watcher, &floor, (view, ask.grid), step, &part(progress, 0.4, 1.0))?;
    }
    let again = part(progress, 0.95, 1.0);
    let proof = (ask.ulps > 0).then(|| proof(&mut watcher, views, ask.ulps, &again)).transpose()?;
    let corner = |v: S::Vector| (0..S::Vector::AXES).map(|a| v.get(a)).collect();
    let floor = [corner(floor.min), corner(floor.max)];
    Ok(Stability { path, grid, floor, flips, tolerance, proof })
}
