//! What was found, as tables: a row a view of the path, a row a place of the grid, and a row a method.

use super::along::{Found, Station};
use super::grid::Spot;
use crate::measure::table::{Cell, Column, Table};

const fn column(key: &'static str, title: &'static str, unit: &'static str, decimals: usize) -> Column {
    Column { key, title, unit, decimals }
}

const WHERE: [Column; 2] = [column("scene", "scene", "", 0), column("method", "method", "", 0)];
const FOUND: [Column; 9] = [
    column("visible", "visible", "", 0),
    column("missed", "missed", "", 0),
    column("kept", "kept unseen", "", 0),
    column("wrong_pixels", "wrong", "px", 0),
    column("changed", "changed", "", 0),
    column("popped", "popped", "", 0),
    column("popped_pixels", "popped", "px", 0),
    column("work", "work", "counts", 0),
    column("margin", "least margin", "", 6),
];

/// Under the columns of `FOUND`.
fn cells(found: &Found) -> Vec<Cell> {
    // Nothing changes where there is no step.
    let step = |n: usize| (found.steps > 0).then_some(n).into();
    vec![
        found.visible.into(),
        found.missed.into(),
        found.kept.into(),
        found.wrong_pixels.into(),
        step(found.changed),
        step(found.popped),
        step(found.popped_pixels),
        (found.work as f64).into(),
        found.margin.into(),
    ]
}

fn table(first: &[Column]) -> Table {
    Table::new(&[&WHERE[..], first, &FOUND].concat())
}

fn named([scene, method]: [&str; 2]) -> Vec<Cell> {
    vec![scene.into(), method.into()]
}

/// Appends a row for each view of a path; `to` is a table that this function began, or an empty one.
pub fn path_table(to: &mut Table, names: [&str; 2], path: &[Station]) {
    if to.columns.is_empty() {
        *to = table(&[column("view", "view", "", 0)]);
    }
    let row =
        |(at, station): (usize, &Station)| [named(names), vec![at.into()], cells(&station.found)].concat();
    to.rows.extend(path.iter().enumerate().map(row));
}

/// Appends a row for each place of a grid, in the file's own coordinates: `origin` is what was subtracted
/// from them. As [`path_table`].
pub fn grid_table(to: &mut Table, names: [&str; 2], grid: &[Spot], origin: [f64; 3]) {
    if to.columns.is_empty() {
        *to = table(&[
            column("column", "column", "", 0),
            column("row", "row", "", 0),
            column("eye_x", "x", "", 3),
            column("eye_y", "y", "", 3),
            column("eye_z", "z", "", 3),
        ]);
    }
    let row = |spot: &Spot| {
        let eye = |a: usize| Cell::from(spot.eye.get(a).map(|v| f64::from(*v) + origin[a]));
        let place = vec![spot.cell[0].into(), spot.cell[1].into(), eye(0), eye(1), eye(2)];
        [named(names), place, cells(&spot.found)].concat()
    };
    to.rows.extend(grid.iter().map(row));
}

/// Appends a row for all of the path, and one for all of the grid if there is one. As [`path_table`].
pub fn summary(to: &mut Table, names: [&str; 2], path: &Found, grid: &Found) {
    if to.columns.is_empty() {
        *to = table(&[column("where", "where", "", 0), column("views", "views", "", 0)]);
    }
    for (place, found) in [("path", path), ("grid", grid)].into_iter().filter(|(_, f)| f.views > 0) {
        let first = vec![Cell::from(place), found.views.into()];
        to.rows.push([named(names), first, cells(found)].concat());
    }
}
