//! A page for browsers that needs nothing beside itself: a chart whose marks name themselves under the
//! pointer, and tables that sort and can be searched.

use super::svg::escape;
use super::{Look, SvgOptions, svg};
use crate::drawing::Drawing;
use crate::measure::{Cell, Table};

/// The page around what is put in, with its style and its script.
const PAGE: &str = include_str!("page.html");
/// Rows of a table from which on it is shown folded.
const FOLDED: usize = 200;

/// A page with a title, a caption, a chart and tables with their titles. The first table's first column is
/// the number of a row: a mark of the chart about [`crate::drawing::Subject::Tried`] belongs to the row with
/// its number.
pub fn page(
    title: &str,
    caption: &str,
    chart: &Drawing,
    tables: &[(&str, &Table)],
    look: impl Into<Look>,
) -> String {
    let picture = svg(chart, look, &SvgOptions::default());
    let tables: String =
        tables.iter().enumerate().map(|(number, (title, table))| written(number, title, table)).collect();
    // What is put in is put in once: the pieces of the page are cut before.
    let mut pieces = PAGE.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        page += &match name {
            "title" => escape(title),
            "caption" => escape(caption),
            "chart" => picture.clone(),
            "tables" => tables.clone(),
            _ => String::new(),
        };
        page += rest;
    }
    page
}

fn written(number: usize, title: &str, table: &Table) -> String {
    let words = |c: usize| table.rows.iter().any(|row| matches!(row[c], Cell::Text(_)));
    let class = |c: usize| if words(c) { " class=\"words\"" } else { "" };
    let classes: Vec<&str> = (0..table.columns.len()).map(class).collect();
    let mut head = String::new();
    for (column, class) in table.columns.iter().zip(&classes) {
        let (title, unit) = (escape(column.title), escape(column.unit));
        head += &format!(
            "<th scope=\"col\"{class} data-title=\"{title}\" data-unit=\"{unit}\">{title}\
             <small>{unit}</small></th>"
        );
    }
    let mut rows = String::new();
    for (at, row) in table.rows.iter().enumerate() {
        let own = if let Some(Cell::Number(n)) = row.first() {
            format!(" data-number=\"{n}\"")
        } else {
            String::new()
        };
        rows += &format!("<tr{own}>");
        for (c, (cell, class)) in row.iter().zip(&classes).enumerate() {
            let value =
                if let Cell::Number(n) = cell { format!(" data-value=\"{n}\"") } else { String::new() };
            rows += &format!("<td{class}{value}>{}</td>", escape(&table.shown(at, c)));
        }
        rows += "</tr>\n";
    }
    let (count, title) = (table.rows.len(), escape(title));
    let search = format!(
        "<input type=\"search\" placeholder=\"only rows with …\" aria-label=\"search\" \
         data-of=\"#table-{number}\">"
    );
    let body = format!(
        "{search}<div class=\"wide\"><table id=\"table-{number}\">\n<thead><tr>{head}</tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n"
    );
    if count > FOLDED {
        format!("<details><summary>{title} ({count} rows)</summary>\n{body}</details>\n")
    } else {
        format!("<h2>{title}</h2>\n{body}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Layer, Mark, Role, Subject};
    use crate::measure::Column;
    use crate::render::Theme;
    use glam::vec2;

    /// What is put in cannot become a part of the page, and marks and rows have the numbers by which they are
    /// found.
    #[test]
    fn marks_and_rows_belong_together() {
        let column = |key, title, unit, decimals| Column { key, title, unit, decimals };
        let mut table = Table::new(&[column("number", "no.", "", 0), column("method", "method", "", 0)]);
        table.rows.push(vec![7usize.into(), "<script>\"a\" {{chart}}".into()]);
        let mut chart = Drawing { size_pt: vec2(40.0, 30.0), ..Drawing::default() };
        let dot = Mark::Dot { at: vec2(20.0, 10.0), radius_pt: 2.0 };
        chart.push(Layer::Emphasis, Role::Visible, Subject::Tried(7), dot);
        let page = page("A & B", "{{tables}}", &chart, &[("all", &table)], Theme::Print);
        assert!(page.contains("data-tried=\"7\"") && page.contains("<tr data-number=\"7\">"), "{page}");
        assert!(page.contains("<title>A &amp; B</title>"));
        assert!(page.contains("&lt;script&gt;") && page.contains("{{chart}}") && page.contains("{{tables}}"));
        assert_eq!(page.matches("<svg").count(), 1);
        assert!(!page.contains("http://") || !page.contains("src=\"http"), "nothing is fetched");
    }
}
