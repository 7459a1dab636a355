//! Pictures of what is not in the world: the levels of the pyramid beside each other and stacked, and the
//! lists of a method that remembers what was visible.
//!
//! They are drawn from the large state and the reads at a step, so what is lit is what the run read.

use glam::{Vec2, vec2};

use super::evidence::{Answered, DepthNote, comparison, place};
use super::faces::Faces;
pub use super::levels::Levels;
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Pixels, Role, Subject, metrics};
use crate::geometry::{NodeId, View};
use crate::raster::{DepthScale, Outcome, PyramidCell, Read, shade_depth};

/// Width of a picture in points.
pub const WIDTH_PT: f32 = 480.0;
const LABEL_PT: f32 = 7.5;
/// The least side of a cell in which its value has room.
const VALUE_ROOM_PT: f32 = 15.0;
/// Levels with more columns or rows are left out: their cells are far smaller than a point.
const MOST_COLUMNS: u32 = 1024;

/// A cell that was read, as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Lit {
    /// Which.
    pub cell: PyramidCell,
    /// What followed.
    pub role: Role,
    /// Where it is, and what was compared, in words.
    pub text: String,
}

/// What a query has read so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reads {
    /// In order.
    pub all: Vec<Lit>,
    /// The cell that the sentence of the step names: the one read last, or of an answer the one that decided.
    pub named: Option<PyramidCell>,
}

impl Reads {
    /// The read of the cell that is named; by its number.
    fn named(&self) -> Option<usize> {
        self.all.iter().rposition(|r| Some(r.cell) == self.named)
    }
}

/// The reads of the query that the last of some notes belongs to. `notes`: last first; `None` for what is no
/// note about depth.
pub fn last_reads<'a, S: Faces>(notes: impl Iterator<Item = Option<&'a DepthNote<S>>>) -> Reads {
    let (mut reads, mut whose, mut decisive): (Vec<Lit>, _, _) = (Vec::new(), None, None);
    for note in notes {
        match note {
            Some(DepthNote::Read(node, r)) if whose.is_none_or(|n| n == *node) => {
                let text = format!("{}: {}", place(r.cell), comparison(r));
                reads.push(Lit { cell: r.cell, role: role_of(r), text });
                whose = Some(*node);
            }
            // Made for the read that follows it, so it is part of the same query.
            Some(DepthNote::Refreshed(_)) => {}
            // A query ends with its answer: behind it only if nothing was read since.
            Some(DepthNote::Answered(a)) if reads.is_empty() && whose.is_none() => {
                (whose, decisive) = (Some(a.node), a.answer.decisive.map(|d| d.cell));
            }
            _ => break,
        }
    }
    reads.reverse();
    Reads { named: decisive.or(reads.last().map(|r| r.cell)), all: reads }
}

/// Where a level stands on paper: its corner, the size of a cell, and how far the image goes.
#[derive(Clone, Copy)]
struct Frame {
    level: u8,
    at: Vec2,
    cell: Vec2,
    end: Vec2,
}

impl Frame {
    /// A level whose image is `size` large; cells at the far edges may be cut.
    fn new<S: Faces>(of: &impl Levels, level: u8, at: Vec2, size: Vec2, view: &View<S>) -> Self {
        let cell = size * sides(of, level) / vec2(view.width as f32, view.height as f32);
        // A line of pixels has one row on every level.
        let cell = if view.height == 1 { vec2(cell.x, size.y) } else { cell };
        Self { level, at, cell, end: at + size }
    }
    fn rect(&self, cell: PyramidCell) -> [Vec2; 2] {
        let a = self.at + self.cell * vec2(cell.x.into(), cell.y.into());
        [a, (a + self.cell).min(self.end)]
    }
    fn cell_under(&self, at: Vec2) -> Option<PyramidCell> {
        let inside = at.cmpge(self.at).all() && at.cmplt(self.end).all();
        let place = (at - self.at) / self.cell;
        inside.then_some(PyramidCell { level: self.level, x: place.x as u16, y: place.y as u16 })
    }
}

/// Sides of the cells of a level, pixels.
fn sides(of: &impl Levels, level: u8) -> Vec2 {
    Vec2::from(of.shifts(level).map(|shift| (1u32 << shift) as f32))
}

/// The levels that are shown, and where; after them the place of the layers that are begun, if there are any.
fn frames<S: Faces>(of: &impl Levels, view: &View<S>) -> (Vec<Frame>, Option<Frame>, f32) {
    let (all, top) = (of.levels(), 12.0);
    let more = usize::from(of.begun().is_some());
    if S::CORNERS == 2 {
        // Strips of one width below each other: a cell stands right below those that it stands for.
        let frame = |k: usize, level: u8| {
            Frame::new(of, level, vec2(0.0, top + k as f32 * STRIP_PITCH_PT), vec2(WIDTH_PT, STRIP_PT), view)
        };
        let frames: Vec<Frame> = all.iter().enumerate().map(|(k, &level)| frame(k, level)).collect();
        let begun = (more > 0).then(|| frame(all.len(), 0));
        return (frames, begun, (all.len() + more) as f32 * STRIP_PITCH_PT);
    }
    let is_shown = |level: &u8| of.size(*level).into_iter().max() <= Some(MOST_COLUMNS);
    let shown: Vec<u8> = all.into_iter().filter(is_shown).collect();
    // All of one size, so that a place is found again on each, and coarse cells have room for their values.
    let count = shown.len() + more;
    let in_row = count.clamp(1, 4);
    // More between the rows, where the names of the levels stand.
    let gap = vec2(8.0, 16.0);
    let width = (WIDTH_PT - gap.x * (in_row - 1) as f32) / in_row as f32;
    let size = vec2(width, width * view.height as f32 / view.width.max(1) as f32);
    let at = |k: usize| vec2(0.0, top) + (size + gap) * vec2((k % in_row) as f32, (k / in_row) as f32);
    let frame = |(k, &level): (usize, &u8)| Frame::new(of, level, at(k), size, view);
    let frames = shown.iter().enumerate().map(frame).collect();
    let begun = (more > 0).then(|| Frame::new(of, 0, at(shown.len()), size, view));
    (frames, begun, count.div_ceil(in_row) as f32 * (size.y + gap.y))
}

/// Height of a strip and distance from one to the next, in flatland.
const STRIP_PT: f32 = 13.0;
const STRIP_PITCH_PT: f32 = 26.0;

/// Some cells of a level as an image, one cell a pixel.
fn image<S: Faces>(
    of: &impl Levels,
    view: &View<S>,
    level: u8,
    [x0, x1, y0, y1]: [u32; 4],
    scale: DepthScale,
) -> Pixels {
    let cell = |x: u32, y: u32| PyramidCell { level, x: x as u16, y: y as u16 };
    let cells: Vec<PyramidCell> = (y0..y1).flat_map(|y| (x0..x1).map(move |x| cell(x, y))).collect();
    let rgba = of.shades(&cells, 1.0 / view.eye.far, scale).into();
    Pixels { width: x1 - x0, height: y1 - y0, rgba }
}

/// The frame with the level's name and its image, and values where there is room.
fn draw_level<S: Faces>(
    of: &impl Levels,
    view: &View<S>,
    frame: &Frame,
    scale: DepthScale,
    to: &mut Drawing,
) {
    let [columns, rows] = of.size(frame.level);
    let title = of.title(frame.level);
    to.text(Layer::Labels, Role::Ink, frame.at - vec2(0.0, 3.0), LABEL_PT, Anchor::Start, title);
    // Whole cells first, then those that the image's edge cuts.
    // The pixels of an image mark are all of one size, which cut cells are not: they have marks of their own.
    let [across, down] = of.shifts(frame.level);
    let split = |cells: u32, pixels: u32, shift: u32| {
        if pixels >> shift == cells { vec![[0, cells]] } else { vec![[0, cells - 1], [cells - 1, cells]] }
    };
    for [y0, y1] in split(rows, view.height, down) {
        for [x0, x1] in split(columns, view.width, across).into_iter().filter(|_| y1 > y0) {
            if x1 > x0 {
                let cell = |x: u32, y: u32| PyramidCell { level: frame.level, x: x as u16, y: y as u16 };
                let corners = [frame.rect(cell(x0, y0))[0], frame.rect(cell(x1 - 1, y1 - 1))[1]];
                let pixels = image(of, view, frame.level, [x0, x1, y0, y1], scale);
                to.push(Layer::Scene, Role::Scene, Subject::None, Mark::Image { corners, pixels });
            }
        }
    }
    stale(of, frame, to);
    to.outline(
        Layer::Scene,
        Role::Faint,
        Subject::None,
        [frame.at, vec2(frame.end.x, frame.at.y), frame.end, vec2(frame.at.x, frame.end.y)],
    );
    for y in 0..rows as u16 {
        for x in 0..columns as u16 {
            let cell = PyramidCell { level: frame.level, x, y };
            // No number where it is stale: it would be read as the truth.
            let text = if of.is_stale(cell) { "stale".into() } else { of.value(cell, 1.0 / view.eye.far) };
            let width = metrics::width_pt(&text, Font::Regular, LABEL_PT) + 3.0;
            // All cells of a level are of one size: as a rule all have room for their values or none has.
            if frame.cell.x < width.max(VALUE_ROOM_PT) || frame.cell.y < LABEL_PT + 3.0 {
                return;
            }
            let [a, b] = frame.rect(cell);
            plate(to, (a + b) * 0.5, &text);
        }
    }
}

/// Marks what is not up to date, in runs along the rows.
fn stale(of: &impl Levels, frame: &Frame, to: &mut Drawing) {
    // Below the level of tiles all cells of a tile are alike.
    let level = of.stale_level(frame.level);
    let [columns, rows] = of.size(level);
    let tile = Frame { level, cell: frame.cell * sides(of, level) / sides(of, frame.level), ..*frame };
    let tile = if frame.end.y - frame.at.y <= STRIP_PT {
        Frame { cell: vec2(tile.cell.x, frame.cell.y), ..tile }
    } else {
        tile
    };
    // Runs along a row; those of rows below each other that are alike are one rectangle.
    let mut open: Vec<([u32; 2], u32)> = Vec::new();
    // Over the shades and under the cells that were read: a hatch lets the gray beneath it be seen.
    let mut close = |[x0, x1]: [u32; 2], y0: u32, y1: u32| {
        let cell = |x: u32, y: u32| PyramidCell { level, x: x as u16, y: y as u16 };
        let ([a, _], [_, b]) = (tile.rect(cell(x0, y0)), tile.rect(cell(x1 - 1, y1 - 1)));
        to.push(
            Layer::Nodes,
            Role::Approximated,
            Subject::None,
            Mark::Area(vec![a, vec2(b.x, a.y), b, vec2(a.x, b.y)]),
        );
    };
    // One row past the last, which has no runs, closes those that are still open.
    for y in 0..=rows {
        let mut runs: Vec<[u32; 2]> = Vec::new();
        for x in
            (0..columns).filter(|&x| y < rows && of.is_stale(PyramidCell { level, x: x as u16, y: y as u16 }))
        {
            match runs.last_mut().filter(|run| run[1] == x) {
                Some(run) => run[1] += 1,
                None => runs.push([x, x + 1]),
            }
        }
        open.iter().filter(|(run, _)| !runs.contains(run)).for_each(|&(run, from)| close(run, from, y));
        open.retain(|(run, _)| runs.contains(run));
        for run in runs {
            if !open.iter().any(|(o, _)| *o == run) {
                open.push((run, y));
            }
        }
    }
}

/// Text on a piece of paper, about its middle.
fn plate(to: &mut Drawing, middle: Vec2, text: &str) {
    // The text must be legible over any gray and any hatch.
    let half = vec2(metrics::width_pt(text, Font::Regular, LABEL_PT) * 0.5 + 1.0, LABEL_PT * 0.55);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| middle + Vec2::from(c) * half);
    to.push(Layer::Evidence, Role::Paper, Subject::None, Mark::Area(corners.to_vec()));
    let at = middle + vec2(0.0, LABEL_PT * 0.35);
    to.push(
        Layer::Labels,
        Role::Ink,
        Subject::None,
        Mark::Text { at, text: text.into(), size_pt: LABEL_PT, anchor: Anchor::Middle, font: Font::Regular },
    );
}

/// How a read is lit.
fn role_of(read: &Read) -> Role {
    match read.outcome {
        // The states of nodes: what is hidden looks alike here and in the world.
        Outcome::Behind => Role::Hidden,
        Outcome::Descends => Role::Undecided,
        Outcome::Shows => Role::Visible,
    }
}

/// Lights the cells that a query read, numbered in order, the one that the sentence names most.
fn light(reads: &Reads, frames: &[Frame], to: &mut Drawing) {
    for (number, read) in reads.all.iter().enumerate() {
        // A level whose cells are too fine to be shown has no frame.
        let Some(frame) = frames.iter().find(|f| f.level == read.cell.level) else { continue };
        let [a, b] = frame.rect(read.cell);
        let corners = [a, vec2(b.x, a.y), b, vec2(a.x, b.y)];
        to.outline(Layer::Emphasis, read.role, Subject::None, corners);
        if Some(number) == reads.named() {
            to.outline(
                Layer::Emphasis,
                Role::Current,
                Subject::None,
                // Outside the first outline, so that how the read ended is still seen.
                corners.map(|c| c + (c - (a + b) * 0.5).signum() * 1.5),
            );
        }
        // A cell may be read again, for another part of the image; the first time writes all its numbers.
        let same = |r: &&(usize, &Lit)| r.1.cell == read.cell;
        let all: Vec<(usize, &Lit)> = reads.all.iter().enumerate().collect();
        let numbers: Vec<String> = all.iter().filter(same).map(|(n, _)| (n + 1).to_string()).collect();
        let text = format!("{}.", numbers.join(", "));
        let room =
            b.x - a.x - metrics::width_pt(&text, Font::Regular, LABEL_PT) > 2.0 && b.y - a.y > 2.0 * LABEL_PT;
        if room && numbers[0] == (number + 1).to_string() {
            let half = vec2(metrics::width_pt(&text, Font::Regular, LABEL_PT) * 0.5, LABEL_PT * 0.55);
            plate(to, a + half + 2.0, &text);
        }
    }
}

/// The last comparisons in words, below a picture that ends at `top`; returns where they end.
fn comparisons(reads: &Reads, top: f32, to: &mut Drawing) -> f32 {
    const LINES: usize = 6;
    let (named, reads) = (reads.named(), &reads.all);
    // The last ones, and before them the one that this step is about; it alone is in ink.
    let first = reads.len().saturating_sub(LINES);
    let shown: Vec<usize> = match named.filter(|n| *n < first) {
        Some(earlier) => std::iter::once(earlier).chain(first + 1..reads.len()).collect(),
        None => (first..reads.len()).collect(),
    };
    for (line, (number, read)) in shown.into_iter().map(|n| (n, &reads[n])).enumerate() {
        let text = format!("{}. {}", number + 1, read.text);
        to.text(
            Layer::Labels,
            if Some(number) == named { Role::Ink } else { Role::Faint },
            vec2(0.0, top + 11.0 * (line + 1) as f32),
            8.5,
            Anchor::Start,
            text,
        );
    }
    // In words, since nothing is lit then; the picture is as high as with one read.
    if reads.is_empty() {
        to.text(
            Layer::Labels,
            Role::Faint,
            vec2(0.0, top + 11.0),
            8.5,
            Anchor::Start,
            "No cell is being read at this step.",
        );
    }
    top + 11.0 * (reads.len() - first).max(1) as f32 + 5.0
}

/// The levels side by side, each as large as the others; in flatland strips below each other.
pub fn levels<S: Faces>(of: &impl Levels, view: &View<S>, reads: &Reads, scale: DepthScale) -> Drawing {
    let (frames, begun, height) = frames(of, view);
    let mut to = Drawing::default();
    frames.iter().for_each(|f| draw_level(of, view, f, scale, &mut to));
    if let (Some(frame), Some(depths)) = (begun, of.begun()) {
        to.text(
            Layer::Labels,
            Role::Ink,
            frame.at - vec2(0.0, 3.0),
            LABEL_PT,
            Anchor::Start,
            "masks: nearer layers",
        );
        let rgba = shade_depth(depths, of.depths(), 1.0 / view.eye.far, scale).into();
        let pixels = Pixels { width: view.width, height: view.height, rgba };
        let corners = [frame.at, frame.end];
        to.push(Layer::Scene, Role::Scene, Subject::None, Mark::Image { corners, pixels });
        let [a, b] = corners;
        to.outline(Layer::Scene, Role::Faint, Subject::None, [a, vec2(b.x, a.y), b, vec2(a.x, b.y)]);
    }
    light(reads, &frames, &mut to);
    let mut bottom = comparisons(reads, 4.0 + height, &mut to);
    if to.items.iter().any(|i| i.role == Role::Approximated) {
        // Explained only where it occurs.
        let text = "Cross-hatched: drawn into since it was last read, so it holds too far a depth; it is \
                    brought up to date when it is read.";
        to.text(Layer::Labels, Role::Faint, vec2(0.0, bottom + 8.0), 8.0, Anchor::Start, text);
        bottom += 12.0;
    }
    let title = format!("The levels of the {}", of.name());
    finished(to, bottom, &title)
}

/// How the levels are stacked on paper: the image's unit square at each of them.
struct Stack {
    /// Right along the base, and how far the back edge leans to the right.
    base: f32,
    lean: f32,
    /// From the back edge to the front one, and from one level to the next.
    depth: f32,
    rise: f32,
    /// Where the back edge of level 0 is.
    top: f32,
}

impl Stack {
    fn at(&self, k: usize, p: Vec2) -> Vec2 {
        let y = self.top - self.rise * k as f32 - self.depth * (1.0 - p.y) + self.depth;
        vec2(self.lean * (1.0 - p.y) + self.base * p.x, y)
    }
    fn quad(&self, k: usize, a: Vec2, b: Vec2) -> [Vec2; 4] {
        [a, vec2(b.x, a.y), b, vec2(a.x, b.y)].map(|p| self.at(k, p))
    }
    /// Rows of the sheared image of a level, each a thin picture of its own.
    fn rows(
        &self,
        k: usize,
        (down, height): (u32, u32),
        [columns, rows]: [u32; 2],
        all: &Pixels,
        to: &mut Drawing,
    ) {
        // The mark of an image is an upright rectangle, so the lean is made of steps: a row of pixels is cut
        // into several where there are few.
        let thin = rows.max((self.depth as u32).min(64));
        for line in 0..thin {
            let row = ((line * height / thin) >> down).min(rows - 1) as usize;
            let (y0, y1) = (line as f32 / thin as f32, (line + 1) as f32 / thin as f32);
            let rgba: Vec<u8> =
                all.rgba[row * columns as usize * 4..(row + 1) * columns as usize * 4].to_vec();
            let (a, b) = (self.at(k, vec2(0.0, y0)), self.at(k, vec2(1.0, y1)));
            // A little overlap, so that no paper shows between two of them.
            let corners = [vec2(a.x, a.y), vec2(a.x + self.base, b.y + 0.2)];
            let pixels = Pixels { width: columns, height: 1, rgba: rgba.into() };
            to.push(Layer::Scene, Role::Scene, Subject::None, Mark::Image { corners, pixels });
        }
    }
}

/// The levels above each other, seen askew, the image at the bottom.
pub fn stacked<S: Faces>(of: &impl Levels, view: &View<S>, reads: &Reads, scale: DepthScale) -> Drawing {
    let shown: Vec<u8> = of.levels().into_iter().filter(|&l| of.size(l)[0] <= MOST_COLUMNS).collect();
    let (base, lean, rise) = (WIDTH_PT * 0.62, WIDTH_PT * 0.2, 46.0);
    let depth = (base * 0.45 * view.height as f32 / view.width.max(1) as f32).clamp(14.0, base * 0.6);
    let top = 14.0 + rise * shown.len().saturating_sub(1) as f32;
    let stack = Stack { base, lean, depth, rise, top };
    let mut to = Drawing::default();
    // From the image up: what is drawn later lies on top, as the upper level does.
    for (k, &level) in shown.iter().enumerate() {
        let [columns, rows] = of.size(level);
        let pixels = image(of, view, level, [0, columns, 0, rows], scale);
        let corners = stack.quad(k, Vec2::ZERO, Vec2::ONE);
        to.push(Layer::Scene, Role::Paper, Subject::None, Mark::Area(corners.to_vec()));
        stack.rows(k, (of.shifts(level)[1], view.height), [columns, rows], &pixels, &mut to);
        to.outline(Layer::Scene, Role::Faint, Subject::None, corners);
        let side = sides(of, level) / vec2(view.width as f32, view.height as f32);
        for (number, read) in reads.all.iter().enumerate().filter(|(_, r)| r.cell.level == level) {
            let a = side * vec2(read.cell.x.into(), read.cell.y.into());
            let lit = stack.quad(k, a, (a + side).min(Vec2::ONE));
            to.outline(Layer::Emphasis, read.role, Subject::None, lit);
            if Some(number) == reads.named() {
                let middle = (lit[0] + lit[2]) * 0.5;
                let around = lit.map(|c| c + (c - middle).signum() * 1.5);
                to.outline(Layer::Emphasis, Role::Current, Subject::None, around);
            }
        }
        let name = vec2(lean + base + 6.0, stack.at(k, vec2(1.0, 0.0)).y + 4.0);
        let text = of.title(level);
        to.text(Layer::Labels, Role::Ink, name, LABEL_PT, Anchor::Start, text);
    }
    let bottom = comparisons(reads, top + depth + 2.0, &mut to);
    let title = format!("The {} over the image", of.name());
    finished(to, bottom, &title)
}

/// What the picture of the visible list shows: nodes with what became of them, in order.
#[derive(Default)]
pub struct Lists {
    /// Drawn, and why.
    pub drawn: Vec<(NodeId, &'static str)>,
    /// Queried while the frame was drawn, and the answer.
    pub queried: Vec<(NodeId, String)>,
    /// Whether the frame is drawn and the list is being checked.
    pub is_checking: bool,
    /// Queried then.
    pub checked: Vec<(NodeId, String)>,
    /// Taken off the list.
    pub unlisted: Vec<NodeId>,
}

impl Lists {
    /// The answer for a node's box.
    pub fn query<S: Faces>(&mut self, a: &Answered<S>) {
        let seen = if a.answer.is_hidden { "hidden" } else { "seen" };
        let reads = a.answer.reads;
        let cells = if reads == 1 { "cell" } else { "cells" };
        let to = if self.is_checking { &mut self.checked } else { &mut self.queried };
        to.push((a.node, format!("{seen}, {reads} {cells}")));
    }
    /// The lists beside each other, each with its last rows.
    pub fn draw(&self) -> Drawing {
        const ROWS: usize = 28;
        let mut to = Drawing::default();
        let mut column = |x: f32, title: String, rows: Vec<String>| {
            let (at, size_pt) = (vec2(x, 10.0), 9.0);
            let mark = Mark::Text { at, text: title, size_pt, anchor: Anchor::Start, font: Font::Bold };
            to.push(Layer::Labels, Role::Ink, Subject::None, mark);
            // The latest rows, which are those that the step has added.
            let first = rows.len().saturating_sub(ROWS);
            for (line, row) in rows.into_iter().skip(first).enumerate() {
                let at = vec2(x, 24.0 + 11.0 * line as f32);
                to.text(Layer::Labels, Role::Ink, at, 8.0, Anchor::Start, row);
            }
        };
        let answers = |answers: &[(NodeId, String)]| {
            answers.iter().map(|(node, answer)| format!("node {node}: {answer}")).collect()
        };
        let drawn = self.drawn.iter().enumerate();
        column(
            0.0,
            format!("Drawn, in this order: {}", self.drawn.len()),
            drawn.map(|(i, (node, why))| format!("{}. node {node}: {why}", i + 1)).collect(),
        );
        column(140.0, format!("Asked for: {}", self.queried.len()), answers(&self.queried));
        // Against the finished image: nothing is drawn because of it.
        column(265.0, format!("Asked at the end: {}", self.checked.len()), answers(&self.checked));
        column(
            390.0,
            format!("Left the list: {}", self.unlisted.len()),
            self.unlisted.iter().map(|node| format!("node {node}")).collect(),
        );
        // As high with few rows as with many: the picture keeps its size from step to step.
        finished(to, 24.0 + 11.0 * ROWS as f32, "The visible list")
    }
}

/// A picture that ends at `bottom`, with its title.
pub fn finished(mut to: Drawing, bottom: f32, title: &str) -> Drawing {
    to.size_pt = vec2(WIDTH_PT, bottom);
    to.title = title.into();
    to
}

/// The value of the cell under a point of [`levels`], in words.
pub fn probe<S: Faces>(of: &impl Levels, view: &View<S>, at: Vec2) -> Option<String> {
    let cell = frames(of, view).0.iter().find_map(|f| f.cell_under(at))?;
    let stale =
        if of.is_stale(cell) { " as far as it is known; drawn into since it was last read" } else { "" };
    Some(format!("{}{stale}", of.words(cell, 1.0 / view.eye.far)))
}
