//! Stability over the floor plan of a scene, as a picture whose dots are places.

use glam::Vec2;

use crate::drawing::Drawing;
use crate::figure::{Heat, heat_map};
use crate::geometry::{Space, Vector};
use crate::measure::stability::{Stability, floor_axes};
use crate::scene::Scene;

/// Lines of a floor plan that a map shows.
const MOST_LINES: usize = 20_000;

/// The grid over the floor plan: where pixels pop or are wrong. A dot is about the place of the grid with its
/// number ([`crate::drawing::Subject::Tried`]).
pub fn floor_map<S: Space>(scene: &Scene<S>, title: String, found: &Stability, side: usize) -> Drawing {
    let [u, v] = floor_axes::<S::Vector>();
    // In space z points toward the reader of a plan.
    let turn = if S::Vector::AXES == 2 { 1.0 } else { -1.0 };
    let flat = |p: S::Vector| Vec2::new(p.get(u), turn * p.get(v));
    let corners = found.floor.each_ref().map(|corner| Vec2::new(corner[u], turn * corner[v]));
    let mut plan = Vec::new();
    for &prim in scene.live() {
        let points: Vec<Vec2> = scene.prim_points(prim).map(flat).collect();
        plan.extend((1..points.len()).map(|k| [points[k - 1], points[k]]).filter(|[a, b]| a != b));
    }
    plan.truncate(MOST_LINES);
    let value = |k: usize| (found.grid[k].found.popped_pixels + found.grid[k].found.wrong_pixels) as f64;
    // The map begins with the row of the least y.
    let row = |k: usize| if turn > 0.0 { k / side } else { side - 1 - k / side };
    let numbers: Vec<usize> = (0..side * side).map(|k| row(k) * side + k % side).collect();
    let values: Vec<f64> = numbers.iter().map(|k| value(*k)).collect();
    heat_map(&Heat {
        title,
        what: "pixels that are wrong or popped",
        cells: [side, side],
        values: &values,
        numbers: &numbers,
        bounds: [corners[0].min(corners[1]), corners[0].max(corners[1])],
        plan: &plan,
    })
}
