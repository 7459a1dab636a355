//! Tables of results: rows of text and numbers under columns with units, as aligned text, CSV and JSON.
//!
//! Text is rounded to what a reader needs; CSV and JSON have every digit, so that reading them back gives the
//! same numbers.

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use crate::drawing::words::grouped;

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name in CSV and JSON, its unit last, such as `cull_ms`.
    pub key: &'static str,
    /// Heading for people.
    pub title: &'static str,
    /// Unit; may be empty.
    pub unit: &'static str,
    /// Decimals in text.
    pub decimals: usize,
}

/// What stands in a row under a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number in the column's unit.
    Number(f64),
    /// Nothing is known.
    Missing,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}
impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Number(value) } else { Self::Missing }
    }
}
impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Self::Number(value as f64)
    }
}
impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

/// A table. Every row has a cell for every column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// From left to right.
    pub columns: Vec<Column>,
    /// From top to bottom.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table.
    pub fn new(columns: &[Column]) -> Self {
        Self { columns: columns.to_vec(), rows: Vec::new() }
    }

    /// The number in a row under the column with this key.
    pub fn number(&self, row: usize, key: &str) -> Option<f64> {
        let at = self.columns.iter().position(|c| c.key == key)?;
        match self.rows.get(row)?.get(at)? {
            Cell::Number(value) => Some(*value),
            _ => None,
        }
    }

    /// A cell as people read it.
    pub fn shown(&self, row: usize, column: usize) -> String {
        match &self.rows[row][column] {
            Cell::Text(text) => text.clone(),
            Cell::Number(value) => grouped(*value, self.columns[column].decimals),
            Cell::Missing => "–".into(),
        }
    }

    /// Aligned text: headings, units, a rule, rows; numbers to the right.
    pub fn text(&self) -> String {
        let count = self.columns.len();
        let mut lines: Vec<Vec<String>> = vec![
            self.columns.iter().map(|c| c.title.to_owned()).collect(),
            self.columns.iter().map(|c| c.unit.to_owned()).collect(),
        ];
        lines.extend((0..self.rows.len()).map(|r| (0..count).map(|c| self.shown(r, c)).collect()));
        let width = |c: usize| lines.iter().map(|l| l[c].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..count).map(width).collect();
        let words = |c: usize| self.rows.iter().any(|r| matches!(r[c], Cell::Text(_)));
        let left: Vec<bool> = (0..count).map(words).collect();
        let mut text = String::new();
        for (i, line) in lines.iter().enumerate() {
            let cells: Vec<String> = line
                .iter()
                .enumerate()
                .map(
                    |(c, t)| {
                        if left[c] { format!("{t:<0$}", widths[c]) } else { format!("{t:>0$}", widths[c]) }
                    },
                )
                .collect();
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}", cells.join("  ").trim_end());
            if i == 1 {
                let _ = writeln!(
                    text,
                    "{}",
                    "-".repeat(widths.iter().sum::<usize>() + 2 * count.saturating_sub(1))
                );
            }
        }
        text
    }

    /// Comma-separated values (RFC 4180 but for its line ends, which are plain), keys first.
    pub fn csv(&self) -> String {
        let cell = |cell: &Cell| match cell {
            Cell::Text(text) => text.clone(),
            Cell::Number(value) => value.to_string(),
            Cell::Missing => String::new(),
        };
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing to memory cannot fail, and all rows are as long as the head.
        let _ = writer.write_record(self.columns.iter().map(|c| c.key));
        for row in &self.rows {
            let _ = writer.write_record(row.iter().map(cell));
        }
        String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
    }

    /// The rows as JSON objects by key.
    pub fn json(&self) -> Json {
        let cell = |cell: &Cell| match cell {
            Cell::Text(text) => json!(text),
            // Counts read better without a decimal point.
            Cell::Number(value) if value.fract() == 0.0 && value.abs() < 1e15 => json!(*value as i64),
            Cell::Number(value) => json!(value),
            Cell::Missing => Json::Null,
        };
        let row = |row: &Vec<Cell>| {
            self.columns.iter().zip(row).map(|(c, v)| (c.key.to_owned(), cell(v))).collect::<Map<_, _>>()
        };
        self.rows.iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Table {
        let column = |key, title, unit, decimals| Column { key, title, unit, decimals };
        let mut table = Table::new(&[
            column("scene", "scene", "", 0),
            column("polygons", "polygons", "", 0),
            column("drawn_percent", "drawn", "%", 1),
        ]);
        table.rows.push(vec!["a \"b\", c".into(), 134_832usize.into(), (1.0 / 3.0).into()]);
        table.rows.push(vec!["city".into(), 7usize.into(), f64::NAN.into()]);
        table
    }

    #[test]
    fn csv_keeps_every_digit_and_quotes_words() {
        assert_eq!(
            sample().csv(),
            "scene,polygons,drawn_percent\n\"a \"\"b\"\", c\",134832,0.3333333333333333\ncity,7,\n"
        );
    }

    #[test]
    fn text_is_aligned() {
        let want = "scene     polygons  drawn\n                        %\n-------------------------\na \
                    \"b\", c   134,832    0.3\ncity             7      –\n";
        assert_eq!(sample().text(), want);
    }

    #[test]
    fn json_has_the_keys() {
        let json = sample().json();
        assert_eq!(json[0]["polygons"], 134_832);
        assert_eq!(json[0]["drawn_percent"], 1.0 / 3.0);
        assert!(json[1]["drawn_percent"].is_null());
        assert_eq!(
            (
                sample().number(0, "polygons"),
                sample().number(1, "drawn_percent"),
                sample().number(0, "scene")
            ),
            (Some(134_832.0), None, None)
        );
    }
}
