//! Columns that several tables have, and what charts read of rows.

use super::table::{Cell, Column, Table};

/// Whether a row was measured, or what printed it.
pub const SOURCE: Column = Column { key: "source", title: "source", unit: "", decimals: 0 };
/// Name of the scene.
pub const SCENE: Column = Column { key: "scene", title: "scene", unit: "", decimals: 0 };
/// Triangles that are visible and were not drawn.
pub const MISSED: Column =
    Column { key: "missed_triangles", title: "missed", unit: "triangles", decimals: 0 };
/// Key of the column of tables that have a row for each frame.
pub const FRAME: &str = "frame";
/// Views whose answers were compared with the truth.
pub const CHECKED: Column = Column { key: "checked_views", title: "checked", unit: "views", decimals: 0 };

/// A column.
pub const fn column(key: &'static str, title: &'static str, unit: &'static str, decimals: usize) -> Column {
    Column { key, title, unit, decimals }
}

/// The rows of each scene, in order, with its name.
pub fn by_scene(table: &Table) -> Vec<(String, Vec<usize>)> {
    let mut scenes: Vec<(String, Vec<usize>)> = Vec::new();
    let Some(at) = table.columns.iter().position(|c| c.key == SCENE.key) else { return scenes };
    for (r, row) in table.rows.iter().enumerate() {
        let Cell::Text(name) = &row[at] else { continue };
        match scenes.last_mut().filter(|(last, _)| last == name) {
            Some((_, rows)) => rows.push(r),
            None => scenes.push((name.clone(), vec![r])),
        }
    }
    scenes
}

/// Bars of a chart with a group for each scene: the number of the scene, and what its first row has in the
/// column `key`.
pub fn first_of_each(table: &Table, key: &str) -> Vec<(f64, f64)> {
    let of = |(i, (_, rows)): (usize, (String, Vec<usize>))| Some((i as f64, table.number(rows[0], key)?));
    by_scene(table).into_iter().enumerate().filter_map(of).collect()
}

/// Points of a line through these rows: what they have in the columns `x` and `y`, where they have both.
pub fn points(table: &Table, rows: &[usize], x: &str, y: &str) -> Vec<(f64, f64)> {
    rows.iter().filter_map(|&r| Some((table.number(r, x)?, table.number(r, y)?))).collect()
}

/// The same of those rows alone that have a number in the column `key`.
pub fn points_where(
    table: &Table,
    rows: &[usize],
    (key, number): (&str, f64),
    x: &str,
    y: &str,
) -> Vec<(f64, f64)> {
    let is_of = |r: &usize| table.number(*r, key) == Some(number);
    let rows: Vec<usize> = rows.iter().copied().filter(is_of).collect();
    points(table, &rows, x, y)
}

/// A measured row: the scene, more cells, then numbers.
pub fn measured<const N: usize>(
    scene: &str,
    cells: impl IntoIterator<Item = Cell>,
    numbers: [f64; N],
) -> Vec<Cell> {
    let names = [Cell::from("measured"), scene.into()];
    names.into_iter().chain(cells).chain(numbers.map(Cell::from)).collect()
}

/// A row that a paper printed: what it has under these columns, and nothing under the others.
pub fn quoted<'a>(columns: &[Column], cells: impl IntoIterator<Item = (&'a str, Cell)>) -> Vec<Cell> {
    let mut row = vec![Cell::Missing; columns.len()];
    for (key, cell) in cells {
        let at = columns.iter().position(|c| c.key == key).expect("a paper's cell is under a column");
        row[at] = cell;
    }
    row
}
