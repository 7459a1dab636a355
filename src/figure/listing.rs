//! A method's pseudocode as a picture, with where it differs from the paper's.

use glam::vec2;

use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};
use crate::method::CodeLine;

/// Size of the text, if it is not so long that it must be smaller.
const TEXT_PT: f32 = 8.0;
/// Room for the numbers of lines.
const GUTTER_PT: f32 = 15.0;
/// The same where a line is lit, and where the bar before it stands.
const LIT_GUTTER_PT: f32 = 23.0;
const BAR_PT: f32 = 4.0;
/// Distance of the values from the line that they belong to, in its size.
const VALUES_GAP: f32 = 2.0;

/// A line of pseudocode as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'a> {
    /// The line.
    pub line: &'a CodeLine,
    /// Whether a run comes to it; other lines are gray.
    pub is_reached: bool,
    /// Of the line at which a run stands: the values that matter there, or nothing.
    pub lit: Option<String>,
}

impl<'a> Row<'a> {
    /// Lines of which no run is shown.
    pub fn all(code: &'a [CodeLine]) -> Vec<Self> {
        code.iter().map(|line| Self { line, is_reached: true, lit: None }).collect()
    }
}

/// Pseudocode `width_pt` wide. Below a line that differs from the paper's stands the paper's.
pub fn listing(rows: &[Row<'_>], width_pt: f32) -> Drawing {
    let gutter = if rows.iter().any(|r| r.lit.is_some()) { LIT_GUTTER_PT } else { GUTTER_PT };
    let width = |text: &str| metrics::width_pt(text, Font::Mono, 1.0);
    let widest = rows.iter().map(|r| width(r.line.text).max(width(&paper_line(r.line)))).fold(1.0, f32::max);
    let size_pt = ((width_pt - gutter) / widest).min(TEXT_PT);
    let (line_pt, mut y) = (size_pt * 1.4, 2.0);
    let mut paper = Drawing::default();
    for Row { line, is_reached, lit } in rows {
        let number = line.label.rsplit(':').next().unwrap_or_default();
        // A rule above each procedure.
        if number == "1" {
            let rule = y + line_pt * 0.35;
            paper.line(Layer::Ground, Role::Faint, Subject::None, [vec2(0.0, rule), vec2(width_pt, rule)]);
            y += line_pt * 0.6;
        }
        let mut text = |x: f32, y: f32, role: Role, anchor: Anchor, text: &str| {
            let mark = Mark::Text { at: vec2(x, y), text: text.into(), size_pt, anchor, font: Font::Mono };
            paper.push(Layer::Labels, role, Subject::None, mark);
        };
        y += line_pt;
        text(gutter - 5.0, y, Role::Faint, Anchor::End, number);
        let role = if *is_reached { Role::Ink } else { Role::Faint };
        text(gutter, y, role, Anchor::Start, line.text);
        if let Some(values) = lit {
            y = light(values, [gutter, y, width(line.text) * size_pt], size_pt, width_pt, &mut paper);
        }
        if !line.paper.is_empty() {
            y += line_pt;
            let mark = Mark::Text {
                at: vec2(gutter, y),
                text: paper_line(line),
                size_pt,
                anchor: Anchor::Start,
                font: Font::Mono,
            };
            paper.push(Layer::Labels, Role::Faint, Subject::None, mark);
        }
    }
    y += line_pt * 0.6;
    paper.line(Layer::Ground, Role::Faint, Subject::None, [vec2(0.0, y), vec2(width_pt, y)]);
    paper.size_pt = vec2(width_pt, y + 1.0);
    paper
}

/// Marks a line from `left` whose base is `first`, so long, and sets the values beside it, or below where
/// they do not fit; returns the base of the last of these lines.
fn light(
    values: &str,
    [left, first, length]: [f32; 3],
    size_pt: f32,
    width_pt: f32,
    paper: &mut Drawing,
) -> f32 {
    let beside = left + length + VALUES_GAP * size_pt;
    let fits = beside + metrics::width_pt(values, Font::Regular, size_pt) <= width_pt;
    let left = if fits { beside } else { left * 2.0 };
    let mut y = first;
    for part in metrics::wrap(values, Font::Regular, size_pt, width_pt - left) {
        y += if fits { 0.0 } else { size_pt * 1.4 };
        paper.text(Layer::Labels, Role::Evidence, vec2(left, y), size_pt, Anchor::Start, part);
    }
    let bar = [vec2(BAR_PT, first - size_pt * 0.75), vec2(BAR_PT, y)];
    paper.line(Layer::Emphasis, Role::Current, Subject::None, bar);
    y
}

/// What the paper has in the place of a line.
fn paper_line(line: &CodeLine) -> String {
    let indent = line.text.len() - line.text.trim_start().len();
    format!("{}paper: {}", " ".repeat(indent), line.paper)
}
