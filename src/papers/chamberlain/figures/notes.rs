//! What the figures read of the method's notes.

use crate::culling::color_cubes::{ColorCubes, Evidence, Projected};
use crate::geometry::NodeId;
use crate::method::{Film, notes};

/// How many cells were drawn as color cubes.
pub fn cubes<S: Projected>(film: &dyn Film<S>) -> usize {
    notes::<S, ColorCubes>(film).filter(|(_, note)| matches!(note, Evidence::Cube(_))).count()
}

/// How many cells were drawn as geometry.
pub fn leaves<S: Projected>(film: &dyn Film<S>) -> usize {
    notes::<S, ColorCubes>(film).filter(|(_, note)| matches!(note, Evidence::Geometry { .. })).count()
}

/// The step at which the first cell with children was drawn as a cube; the end of the film if none was.
pub fn step_of_inner_cell<S: Projected>(film: &dyn Film<S>) -> usize {
    let has_children = |node: NodeId| !film.hierarchy().children(node).is_empty();
    let drawn = |note: &Evidence<S>| matches!(note, Evidence::Cube(c) if has_children(c.node));
    notes::<S, ColorCubes>(film).find(|(_, n)| drawn(n)).map_or(film.events().len(), |(at, _)| at + 1)
}
