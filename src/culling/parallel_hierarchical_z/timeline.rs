//! The timeline of the machine: who did what when.

use glam::{Vec2, vec2};

use super::evidence::Evidence;
use super::machine::{Job, Unit, Worked};
use crate::culling::depth::Faces;
use crate::culling::depth::picture::{WIDTH_PT, finished};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};

/// Left end of the bars, width of the column of shares at their right, and the rows.
const LEFT_PT: f32 = 78.0;
const SHARES_PT: f32 = 36.0;
const ROW_PT: f32 = 12.0;
const TOP_PT: f32 = 16.0;

/// A row a unit, time to the right.
pub(super) fn timeline<S: Faces>(notes: &[Evidence<S>]) -> Drawing {
    let work: Vec<Worked> =
        notes.iter().filter_map(|n| if let Evidence::Worked(w) = n { Some(*w) } else { None }).collect();
    let mut to = Drawing::default();
    // The width is the time so far, so that the first ticks can be told apart as well.
    let Some(end) = work.iter().map(|w| w.to).max() else {
        let text = "No unit of the machine has worked yet at this step.";
        to.text(Layer::Labels, Role::Faint, vec2(0.0, 12.0), 8.5, Anchor::Start, text);
        return finished(to, 20.0, "What every unit of the machine did when");
    };
    let mut units: Vec<Unit> = work.iter().map(|w| w.unit).collect();
    // Processors above renderers, as units are ordered.
    units.sort();
    units.dedup();
    for (k, unit) in units.iter().enumerate() {
        row(*unit, &work, TOP_PT + ROW_PT * k as f32, end, &mut to);
    }
    let bottom = TOP_PT + ROW_PT * units.len() as f32;
    let axis = [vec2(LEFT_PT, bottom + 1.0), vec2(place(end, end), bottom + 1.0)];
    to.line(Layer::Evidence, Role::Ink, Subject::None, axis);
    // Few, since only proportions matter: the costs are parameters.
    for tick in [0, end / 2, end] {
        let at = vec2(place(tick, end), bottom + 11.0);
        to.text(Layer::Labels, Role::Ink, at, 7.5, Anchor::Middle, format!("{tick} ticks"));
    }
    to.text(Layer::Labels, Role::Faint, vec2(WIDTH_PT, 10.0), 8.0, Anchor::End, "busy");
    let bottom = legend(bottom + 20.0, &mut to);
    finished(to, bottom, "What every unit of the machine did when")
}

/// Where a tick stands on paper.
fn place(tick: u32, end: u32) -> f32 {
    LEFT_PT + (WIDTH_PT - LEFT_PT - SHARES_PT) * tick as f32 / end.max(1) as f32
}

/// What a unit did, and the share of the frame in which it worked.
fn row(unit: Unit, work: &[Worked], y: f32, end: u32, to: &mut Drawing) {
    to.text(Layer::Labels, Role::Ink, vec2(0.0, y + 7.0), 8.0, Anchor::Start, unit.name());
    let mut busy = 0;
    for w in work.iter().filter(|w| w.unit == unit) {
        let role = match w.job {
            // These two share a look, but never a row: one is of processors, the other of renderers.
            Job::DrawVisible | Job::Rasterize => Role::Visible,
            Job::DrawFound => Role::Current,
            Job::Ask => Role::Evidence,
            Job::Recheck | Job::AskFarthest | Job::Farthest => Role::Undecided,
            Job::Wait => Role::Outside,
            Job::Answer if w.count == 0 => Role::Hidden,
            Job::Answer => Role::Evidence,
        };
        // Waiting has a bar, so that it is seen, but no share of the work.
        busy += if w.job == Job::Wait { 0 } else { w.to - w.from };
        // The shortest job is still to be seen.
        let (from, till) = (place(w.from, end), place(w.to, end).max(place(w.from, end) + 0.3));
        let (a, b) = (vec2(from, y), vec2(till, y + ROW_PT - 3.0));
        to.push(Layer::Areas, role, w.subject(), Mark::Area(rectangle(a, b)));
    }
    let share = format!("{} %", (100.0 * busy as f32 / end.max(1) as f32).round());
    to.text(Layer::Labels, Role::Faint, vec2(WIDTH_PT, y + 7.0), 8.0, Anchor::End, share);
}

/// What the bars mean, from `top` on; returns where it ends.
fn legend(top: f32, to: &mut Drawing) -> f32 {
    let entries = [
        (Role::Visible, "drawing what was visible, rasterizing"),
        (Role::Current, "drawing what was found"),
        (Role::Evidence, "asking; answer: seen"),
        (Role::Hidden, "answer: all enables off"),
        (Role::Undecided, "farthest depths, checks of lists"),
        (Role::Outside, "waiting"),
    ];
    let mut at = vec2(0.0, top);
    for (role, text) in entries {
        let width = metrics::width_pt(text, Font::Regular, 8.0) + 24.0;
        if at.x + width > WIDTH_PT {
            at = vec2(0.0, at.y + 12.0);
        }
        to.push(Layer::Legend, role, Subject::None, Mark::Area(rectangle(at, at + vec2(10.0, 8.0))));
        to.text(Layer::Legend, Role::Ink, at + vec2(13.0, 7.0), 8.0, Anchor::Start, text);
        at.x += width;
    }
    at.y + 14.0
}

fn rectangle(a: Vec2, b: Vec2) -> Vec<Vec2> {
    vec![a, vec2(b.x, a.y), b, vec2(a.x, b.y)]
}
