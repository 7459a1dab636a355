//! A method over the floor plan: at each place of a grid, what is wrong there, and what a small step changes
//! without cause.

use super::along::Found;
use super::seen::Watcher;
use crate::geometry::{Aabb, Vector, View};
use crate::measure::experiment::{ExperimentError, World};
use crate::measure::harness::checkpoint;
use crate::scene::Progress;

/// Length of a small step, as a share of the diagonal of the scene.
pub const STEP_SHARE: f32 = 1e-3;

/// A place of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// Column and row; columns go along x, rows along y in flatland and along z in space.
    pub cell: [usize; 2],
    /// Where the eye stands, a number an axis.
    pub eye: Vec<f32>,
    /// What was found there, and what changed by a step along each axis of the floor.
    pub found: Found,
}

/// The axes of the floor: x and y in flatland, x and z in space.
pub fn floor_axes<V: Vector>() -> [usize; 2] {
    [0, V::AXES - 1]
}

/// Looks from the middles of `side` × `side` cells over a floor, at the height, in the direction and with the
/// image of a view, and from `step` world units beside each along both axes of the floor. Each answer is one
/// without memory. Rows first.
///
/// # Errors
/// It was cancelled.
pub fn over_floor<S: World>(
    watcher: &mut Watcher<'_, S>,
    floor: &Aabb<S::Vector>,
    (view, side): (&View<S>, usize),
    step: f32,
    progress: &dyn Progress,
) -> Result<Vec<Spot>, ExperimentError> {
    let axes = floor_axes::<S::Vector>();
    let mut spots = Vec::with_capacity(side * side);
    for cell in (0..side * side).map(|k| [k % side, k / side]) {
        checkpoint(progress, spots.len() as f32 / (side * side) as f32, "looking over the floor plan")?;
        let middle = |k: usize| {
            let share = (cell[k] as f32 + 0.5) / side as f32;
            floor.min.get(axes[k]) + floor.size().get(axes[k]) * share
        };
        let here = S::Vector::from_fn(|a| match axes.iter().position(|axis| *axis == a) {
            Some(k) => middle(k),
            None => view.eye.position.get(a),
        });
        let mut look = |beside: Option<usize>| {
            let by = S::Vector::from_fn(|a| if Some(a) == beside { step } else { 0.0 });
            watcher.run().forget();
            watcher.look(0, &moved(view, here + by), progress).ok_or(ExperimentError::Cancelled)
        };
        let (seen, mut found) = (look(None)?, Found::default());
        found.see(&seen);
        for axis in axes {
            found.step(&look(Some(axis))?.since(&seen));
        }
        spots.push(Spot { cell, eye: (0..S::Vector::AXES).map(|a| here.get(a)).collect(), found });
    }
    Ok(spots)
}

/// The view from another place in the same direction.
pub(super) fn moved<S: World>(view: &View<S>, position: S::Vector) -> View<S> {
    let mut moved = *view;
    moved.eye.target = position + (view.eye.target - view.eye.position);
    moved.eye.position = position;
    moved
}
