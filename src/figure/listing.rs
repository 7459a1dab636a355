//! A method's pseudocode as a picture, with where it differs from the paper's.

use glam::vec2;

use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};
use crate::method::CodeLine;

/// Size of the text, if it is not so long that it must be smaller.
const TEXT_PT: f32 = 8.0;
/// Room for the numbers of lines.
const GUTTER_PT: f32 = 15.0;

/// Pseudocode `width_pt` wide. Below a line that differs from the paper's stands the paper's.
pub fn listing(code: &[CodeLine], width_pt: f32) -> Drawing {
    let paper_line = |line: &CodeLine| {
        let indent = line.text.len() - line.text.trim_start().len();
        format!("{}paper: {}", " ".repeat(indent), line.paper)
    };
    let width = |text: &str| metrics::width_pt(text, Font::Mono, 1.0);
    let widest = code.iter().map(|l| width(l.text).max(width(&paper_line(l)))).fold(1.0, f32::max);
    let size_pt = ((width_pt - GUTTER_PT) / widest).min(TEXT_PT);
    let (line_pt, mut y) = (size_pt * 1.4, 2.0);
    let mut paper = Drawing::default();
    for line in code {
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
        text(GUTTER_PT - 5.0, y, Role::Faint, Anchor::End, number);
        text(GUTTER_PT, y, Role::Ink, Anchor::Start, line.text);
        if !line.paper.is_empty() {
            y += line_pt;
            text(GUTTER_PT, y, Role::Faint, Anchor::Start, &paper_line(line));
        }
    }
    y += line_pt * 0.6;
    paper.line(Layer::Ground, Role::Faint, Subject::None, [vec2(0.0, y), vec2(width_pt, y)]);
    paper.size_pt = vec2(width_pt, y + 1.0);
    paper
}
