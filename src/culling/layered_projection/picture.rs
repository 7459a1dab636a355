//! Pictures of what is not in the world: the front as the list that it is, and how solid the cells were that
//! were projected.

use glam::vec2;

use super::explain::{Evidence, many};
use super::front::Front;
use super::index::node_of;
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject};
use crate::index::tessellation::Cellular;
use crate::method::evidence::short;

/// Names of the pictures.
pub const PICTURES: &[&str] = &["front as a list", "solidity of projected cells"];

/// Size of a picture in points.
const WIDTH_PT: f32 = 480.0;
const ROWS: usize = 28;
const ROW_PT: f32 = 11.0;
const TOP_PT: f32 = 24.0;
/// Most bars of the chart; more cells share a bar, of which the most solid counts.
const BARS: usize = 240;

/// Draws picture `which`.
pub fn picture<S: Cellular>(front: &Front, notes: &[Evidence<S>], which: usize) -> Drawing {
    if which == 0 { list(front, notes) } else { chart::<S>(notes) }
}

/// The front in the order in which it will be taken if nothing is put in again, and what was taken last.
fn list<S: Cellular>(front: &Front, notes: &[Evidence<S>]) -> Drawing {
    let mut to = Drawing::default();
    let (queue, count) = (front.first(ROWS), front.count());
    heading(&mut to, 0.0, format!("The front, least solid first: {}", many(count as u32, "cell")));
    heading(&mut to, 300.0, format!("Projected, the latest first: {}", front.projected().len()));
    // On the left the queue; bars are relative to the longest one shown.
    // Not 0, since widths are divided by it: all cells of a front may have solidity 0.
    let most = queue.iter().map(|q| q.solidity).fold(f32::MIN_POSITIVE, f32::max);
    for (row, queued) in queue.iter().enumerate() {
        let y = TOP_PT + ROW_PT * row as f32;
        let how = if queued.is_star_shaped { "" } else { ", penalized" };
        text(
            &mut to,
            0.0,
            y,
            Role::Ink,
            format!("{}. node {}: {}{how}", row + 1, node_of(queued.cell), short(queued.solidity)),
        );
        let width = 110.0 * queued.solidity / most;
        // In two colors, since a penalized cell waits for where it is and not only for what stands before it.
        let role = if queued.is_star_shaped { Role::Undecided } else { Role::Hidden };
        bar(&mut to, role, Subject::Node(node_of(queued.cell)), [150.0, y - 7.0, 150.0 + width.max(0.5), y]);
    }
    let left_out = count - queue.len();
    if left_out > 0 {
        text(&mut to, 0.0, TOP_PT + ROW_PT * ROWS as f32, Role::Faint, format!("and {left_out} more"));
    }
    // On the right what was taken out, read from the end of the notes: only the rows shown are visited.
    let projected =
        notes.iter().rev().filter_map(|n| if let Evidence::Projected(p) = n { Some(p) } else { None });
    for (row, p) in projected.take(ROWS).enumerate() {
        let y = TOP_PT + ROW_PT * row as f32;
        text(
            &mut to,
            300.0,
            y,
            Role::Ink,
            format!("#{}: node {}, {}, drew {}", p.rank + 1, node_of(p.cell), short(p.solidity), p.drawn),
        );
    }
    finished(to, TOP_PT + ROW_PT * (ROWS + 1) as f32, "The front")
}

/// How solid each projected cell was when it was taken, in the order of projection: a flat line is one layer,
/// a step the next.
fn chart<S: Cellular>(notes: &[Evidence<S>]) -> Drawing {
    let mut to = Drawing::default();
    let taken: Vec<_> = notes
        .iter()
        .filter_map(
            |n| if let Evidence::Projected(p) = n { Some((p.cell, p.solidity, p.drawn)) } else { None },
        )
        .collect();
    let cells = many(taken.len() as u32, "cell");
    heading(&mut to, 0.0, format!("Solidity of the {cells} projected so far, in their order"));
    let most = taken.iter().map(|t| t.1).fold(f32::MIN_POSITIVE, f32::max);
    let (left, right, top, bottom) = (44.0, WIDTH_PT - 6.0, TOP_PT + 4.0, 190.0);
    let each = taken.len().div_ceil(BARS).max(1);
    let width = (right - left) / taken.len().div_ceil(each).max(1) as f32;
    // One bar for several cells if there are too many; a chunk draws if one of its cells does.
    for (at, some) in taken.chunks(each).enumerate() {
        // The most solid, not their mean, which would flatten the steps between layers.
        let Some(tallest) = some.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        let draws = some.iter().any(|t| t.2 > 0);
        let x = left + width * at as f32;
        let y = bottom - (bottom - top) * tallest.1 / most;
        // A cell that draws nothing costs no budget: those bars show the price of the traversal alone.
        let role = if draws { Role::Visible } else { Role::Outside };
        bar(
            &mut to,
            role,
            Subject::Node(node_of(tallest.0)),
            [x, y.min(bottom - 0.8), x + (width * 0.85).max(0.3), bottom],
        );
    }
    // The axes, and the key of the two colors.
    to.line(Layer::Evidence, Role::Ink, Subject::None, [vec2(left, bottom), vec2(right, bottom)]);
    for (share, y) in [(0.0, bottom), (1.0, top)] {
        to.text(Layer::Labels, Role::Ink, vec2(left - 4.0, y + 3.0), 8.0, Anchor::End, short(share * most));
    }
    text(&mut to, left, bottom + 12.0, Role::Ink, "first".into());
    to.text(Layer::Labels, Role::Ink, vec2(right, bottom + 12.0), 8.0, Anchor::End, "latest");
    bar(&mut to, Role::Visible, Subject::None, [left, bottom + 20.0, left + 10.0, bottom + 28.0]);
    text(&mut to, left + 14.0, bottom + 27.0, Role::Ink, "drew something".into());
    bar(&mut to, Role::Outside, Subject::None, [left + 100.0, bottom + 20.0, left + 110.0, bottom + 28.0]);
    text(&mut to, left + 114.0, bottom + 27.0, Role::Ink, "empty, or drawn before".into());
    finished(to, bottom + 34.0, "Solidity of projected cells")
}

fn heading(to: &mut Drawing, x: f32, text: String) {
    let mark = Mark::Text { at: vec2(x, 10.0), text, size_pt: 9.0, anchor: Anchor::Start, font: Font::Bold };
    to.push(Layer::Labels, Role::Ink, Subject::None, mark);
}
fn text(to: &mut Drawing, x: f32, y: f32, role: Role, text: String) {
    to.text(Layer::Labels, role, vec2(x, y), 8.0, Anchor::Start, text);
}
fn bar(to: &mut Drawing, role: Role, subject: Subject, [x0, y0, x1, y1]: [f32; 4]) {
    to.push(
        Layer::Areas,
        role,
        subject,
        Mark::Area(vec![vec2(x0, y0), vec2(x1, y0), vec2(x1, y1), vec2(x0, y1)]),
    );
}
fn finished(mut to: Drawing, bottom: f32, title: &str) -> Drawing {
    to.size_pt = vec2(WIDTH_PT, bottom);
    to.title = title.into();
    to
}
