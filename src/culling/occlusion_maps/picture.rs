//! What is seen of the method: occluders in the world, and pictures of the maps, of the depth estimation
//! buffer and of the choice of occluders.

use glam::{Vec2, vec2};

use super::depth::DepthBuffer;
use super::evidence::{Choice, Cover, Evidence, draw_choice};
use super::maps::Maps;
use super::overlap::Outcome;
use super::{DepthKind, OcclusionMaps};
use crate::culling::depth::picture::{Levels, Lit, Reads, WIDTH_PT, finished, last_reads, levels, stacked};
use crate::culling::depth::{DepthNote, Faces, place_in_view};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Pixels, Role, Subject, metrics};
use crate::geometry::{PixelRect, View};
use crate::index::Hierarchy;
use crate::method::Moment;
use crate::method::evidence::short;
use crate::raster::{DepthScale, Opacity, PyramidCell, shade_depth};

/// Names of the pictures.
pub(super) const PICTURES: &[&str] =
    &["occlusion maps", "occlusion maps, stacked", "depth estimation buffer", "choice of occluders"];

type At<'a, 'b, S> = &'a Moment<'b, S, OcclusionMaps>;

/// Draws the occluders so far, the depth estimation buffer, and the evidence of the step.
pub(super) fn explain<S: Faces>(moment: At<'_, '_, S>, to: &mut Drawing<S::Vector>) {
    let (index, view) = (moment.frame.index, moment.frame.view);
    draw_occluders(moment, to);
    draw_buffer(moment.state, view, to);
    match moment.note {
        Some(Evidence::Chosen(choice)) => {
            let bounds = Hierarchy::<S>::bounds(index, choice.candidate.node);
            draw_choice(choice, &bounds, view, to);
        }
        Some(note) => note.draw(moment.frame.scene, view, to),
        None => {}
    }
}

/// Occluders with more primitives than this are shown by their boxes.
const MOST_SHOWN: usize = 2000;

/// What was drawn into the maps so far, so that it is told from what is kept and what is culled (Figure 1).
fn draw_occluders<S: Faces>(moment: At<'_, '_, S>, to: &mut Drawing<S::Vector>) {
    let index = moment.frame.index;
    let cover = |n: &Evidence<S>| if let Evidence::Covered(c) = n { Some(*c) } else { None };
    let covers: Vec<Cover> = moment.notes.iter().filter_map(cover).collect();
    // What stands in for an occluder is nowhere else to be seen.
    let stands_in = |c: &Cover| index.stand_ins().filter(|_| c.drawn != c.node);
    let prims = |c: &Cover| {
        stands_in(c).map_or_else(|| Hierarchy::<S>::prims(index, c.node), |made| made.prims(c.node))
    };
    let are_few = covers.iter().map(|c| prims(c).len()).sum::<usize>() <= MOST_SHOWN;
    for cover in &covers {
        let node = Subject::Node(cover.node);
        if !are_few {
            to.bounds(Layer::Nodes, Role::Occluder, node, index.occluder_bounds(cover.node));
            continue;
        }
        let made = stands_in(cover);
        let scene = made.map_or(moment.frame.scene, |made| made.scene());
        for &prim in prims(cover) {
            let points: Vec<S::Vector> = scene.prim_points(prim).collect();
            let subject = if made.is_some() { node } else { Subject::Prim(prim) };
            match points.len() {
                2 => to.line(Layer::Evidence, Role::Occluder, subject, points),
                _ => to.push(Layer::Evidence, Role::Occluder, subject, Mark::Area(points)),
            }
        }
    }
}

/// The depth estimation buffer as a relief before the eye: entries that hold something, each across its part
/// of the view at its depth; in flatland lines, in space faces, those of one depth as one.
fn draw_buffer<S: Faces>(maps: &Maps<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
    let buffer = maps.buffer();
    for (entries, held) in alike(buffer) {
        let low = buffer.pixels([entries.x0, entries.y0], [view.width, view.height]);
        let high = buffer.pixels([entries.x1 - 1, entries.y1 - 1], [view.width, view.height]);
        let at = |x: u32, y: u32| place_in_view(view, [x, y], 1.0 / held);
        if S::CORNERS == 2 {
            let ends = [at(low.x0, 0), at(high.x1, 0)];
            to.line(Layer::Evidence, Role::Evidence, Subject::None, ends);
        } else {
            let corners = [(low.x0, low.y0), (high.x1, low.y0), (high.x1, high.y1), (low.x0, high.y1)];
            let face = Mark::Area(corners.map(|(x, y)| at(x, y)).to_vec());
            to.push(Layer::Evidence, Role::Evidence, Subject::None, face);
        }
    }
}

/// Rectangles of entries that hold the same depth, from the top down; what no occluder touches is in none.
fn alike(buffer: &DepthBuffer) -> Vec<(PixelRect, f32)> {
    let [columns, rows] = buffer.size();
    let mut found: Vec<(PixelRect, f32)> = Vec::new();
    for y in 0..rows {
        let mut x0 = 0;
        while x0 < columns {
            let held = buffer.held([x0, y]);
            let x1 = (x0..columns).find(|&x| buffer.held([x, y]) != held).unwrap_or(columns);
            // It goes on below a run that is as wide.
            let is_above =
                |(r, depth): &&mut (PixelRect, f32)| r.y1 == y && (r.x0, r.x1) == (x0, x1) && *depth == held;
            match found.iter_mut().rev().find(is_above) {
                Some((above, _)) => above.y1 = y + 1,
                None if held.is_finite() => found.push((PixelRect { x0, x1, y0: y, y1: y + 1 }, held)),
                None => {}
            }
            x0 = x1;
        }
    }
    found
}

/// Draws picture `which`.
pub(super) fn picture<S: Faces>(moment: At<'_, '_, S>, which: usize, scale: DepthScale) -> Drawing {
    let (view, maps) = (moment.frame.view, moment.state);
    let of = MapLevels { opacity: maps.opacity(), pixel: maps.pixel() };
    // A frame without maps must not look as if nothing were covered.
    if moment.notes.iter().any(|n| matches!(n, Evidence::Paused(_))) {
        return paused();
    }
    // In the order of `PICTURES`.
    match which {
        0 => levels(&of, view, &reads(moment), scale),
        1 => stacked(&of, view, &reads(moment), scale),
        2 => depths(moment, scale),
        _ => choice(moment),
    }
}

/// In place of all pictures where culling is turned off.
fn paused() -> Drawing {
    let mut to = Drawing::default();
    let lines = [
        "There are no maps in this frame: culling did not pay in the frames before it, and is turned off for",
        "a while (adapt). Other frames, a larger scene, or adapt = false show it.",
    ];
    for (line, text) in lines.into_iter().enumerate() {
        let at = vec2(0.0, 12.0 + 11.0 * line as f32);
        to.text(Layer::Labels, Role::Ink, at, 8.5, Anchor::Start, text);
    }
    finished(to, 32.0, "Culling is turned off")
}

/// The map pixels of the test that the step belongs to.
fn reads<S: Faces>(moment: At<'_, '_, S>) -> Reads {
    let (mut reads, mut whose): (Vec<Lit>, _) = (Vec::new(), None);
    for note in moment.notes.iter().rev() {
        match note {
            Evidence::Read(node, read, _) if whose.is_none_or(|n| n == *node) => {
                let PyramidCell { level, x, y } = read.cell;
                let text = format!(
                    "level {level}, pixel ({x}, {y}): opacity {:.3}, {}",
                    read.opacity(),
                    read.outcome_text()
                );
                let role = match read.outcome {
                    // As in the world: what is hidden looks alike here and there.
                    Outcome::Opaque => Role::Hidden,
                    Outcome::Descends => Role::Undecided,
                    Outcome::Transparent | Outcome::TooTransparent => Role::Visible,
                };
                reads.push(Lit { cell: read.cell, role, text });
                whose = Some(*node);
            }
            // A test ends with its answer: behind it only if nothing was read since.
            Evidence::Answered(a) if reads.is_empty() && whose.is_none() => whose = Some(a.node),
            _ => break,
        }
    }
    reads.reverse();
    Reads { named: reads.last().map(|r| r.cell), all: reads }
}

/// The maps as levels.
struct MapLevels<'a> {
    opacity: &'a Opacity,
    /// Image pixels a side of a pixel of level 0, as a power of two.
    pixel: u32,
}

impl Levels for MapLevels<'_> {
    fn levels(&self) -> Vec<u8> {
        (0..self.opacity.levels()).collect()
    }
    fn size(&self, level: u8) -> [u32; 2] {
        self.opacity.size(level)
    }
    fn shifts(&self, level: u8) -> [u32; 2] {
        [self.pixel + u32::from(level); 2]
    }
    fn name(&self) -> &'static str {
        "hierarchy of occlusion maps"
    }
    fn title(&self, level: u8) -> String {
        let [columns, rows] = self.opacity.size(level);
        format!("level {level}, {columns} × {rows}")
    }
    fn shades(&self, cells: &[PyramidCell], _: f32, _: DepthScale) -> Vec<u8> {
        // Section 6.1: occluders are white.
        let gray = |c: &PyramidCell| (self.opacity.opacity(*c) * 255.0).round() as u8;
        cells.iter().map(gray).flat_map(|v| [v, v, v, 255]).collect()
    }
    fn value(&self, cell: PyramidCell, _: f32) -> String {
        // Three digits tell what is opaque from what is nearly so.
        match self.opacity.black(cell) {
            0 => "1".into(),
            n if n == self.opacity.present(cell) => "0".into(),
            _ => format!("{:.3}", self.opacity.opacity(cell)).trim_start_matches('0').into(),
        }
    }
    fn words(&self, cell: PyramidCell, _: f32) -> String {
        format!(
            "level {}, pixel ({}, {}): opacity {:.3}, {} of {} samples black",
            cell.level,
            cell.x,
            cell.y,
            self.opacity.opacity(cell),
            self.opacity.black(cell),
            self.opacity.present(cell)
        )
    }
}

/// What is under a point of picture 0, in words.
pub(super) fn probe<S: Faces>(moment: At<'_, '_, S>, at: Vec2) -> Option<String> {
    let maps = moment.state;
    let of = MapLevels { opacity: maps.opacity(), pixel: maps.pixel() };
    crate::culling::depth::picture::probe(&of, moment.frame.view, at)
}

/// What is known of the occluders' depths.
fn depths<S: Faces>(moment: At<'_, '_, S>, scale: DepthScale) -> Drawing {
    let mut notes = moment.notes.iter().rev();
    match moment.frame.params.depth {
        DepthKind::Estimation => buffer(moment, scale),
        DepthKind::Plane => {
            let z = notes.find_map(|n| if let Evidence::Plane(z) = n { Some(z) } else { None });
            let text = z.map_or("No plane is set yet.".into(), |z| {
                format!("A single Z plane, {} units before the eye, stands for all depths.", short(*z))
            });
            let mut to = Drawing::default();
            to.text(Layer::Labels, Role::Ink, vec2(0.0, 12.0), 8.5, Anchor::Start, text);
            finished(to, 20.0, "The Z plane")
        }
        DepthKind::Samples => {
            let notes =
                notes.map(|n| if let Evidence::Depth(note) = n { Some(note) } else { None::<&DepthNote<S>> });
            levels(&moment.state.levels(), moment.frame.view, &last_reads(notes), scale)
        }
    }
}

/// The depth estimation buffer in gray, the nearer an entry the darker, and in numbers where there is room.
fn buffer<S: Faces>(moment: At<'_, '_, S>, scale: DepthScale) -> Drawing {
    let (buffer, view) = (moment.state.buffer(), moment.frame.view);
    let mut to = Drawing::default();
    let [columns, rows] = buffer.size();
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
    let held: Vec<f32> = all.map(|at| buffer.held(at)).collect();
    // What no occluder touches is as empty as the sky.
    let far = 1.0 / view.eye.far;
    let shown: Vec<f32> = held.iter().map(|d| if d.is_finite() { *d } else { far }).collect();
    let height = if rows == 1 { 13.0 } else { WIDTH_PT * rows as f32 / columns as f32 };
    let [a, b] = [vec2(0.0, 12.0), vec2(WIDTH_PT, 12.0 + height)];
    let title = format!("{columns} × {rows} entries: the farthest depth of the occluders that touch each");
    to.text(Layer::Labels, Role::Ink, vec2(0.0, 9.0), 7.5, Anchor::Start, title);
    let rgba = shade_depth(&shown, &shown, far, scale).into();
    let pixels = Pixels { width: columns, height: rows, rgba };
    to.push(Layer::Scene, Role::Scene, Subject::None, Mark::Image { corners: [a, b], pixels });
    to.outline(Layer::Scene, Role::Faint, Subject::None, [a, vec2(b.x, a.y), b, vec2(a.x, b.y)]);
    let cell = (b - a) / vec2(columns as f32, rows as f32);
    numbers(&held, columns, cell, a, &mut to);
    light_entry(moment, cell, a, &mut to);
    let empty = held.iter().filter(|d| !d.is_finite()).count();
    let text = format!("{empty} of {} entries are touched by no occluder.", held.len());
    to.text(Layer::Labels, Role::Faint, vec2(0.0, b.y + 11.0), 8.5, Anchor::Start, text);
    finished(to, b.y + 18.0, "The depth estimation buffer")
}

/// Depths in numbers, where all entries have room for them.
fn numbers(held: &[f32], columns: u32, cell: Vec2, first: Vec2, to: &mut Drawing) {
    const NUMBER_PT: f32 = 6.5;
    let texts: Vec<String> =
        held.iter().map(|d| if d.is_finite() { short(1.0 / d) } else { String::new() }).collect();
    let wide = |text: &String| metrics::width_pt(text, Font::Regular, NUMBER_PT) + 3.0;
    if cell.y < NUMBER_PT + 3.0 || texts.iter().any(|text| wide(text) > cell.x) {
        return;
    }
    for (i, text) in texts.into_iter().enumerate().filter(|(_, text)| !text.is_empty()) {
        let place = vec2((i as u32 % columns) as f32, (i as u32 / columns) as f32);
        let middle = first + cell * (place + 0.5);
        let half = vec2(wide(&text) * 0.5, NUMBER_PT * 0.6);
        let (low, high) = (middle - half, middle + half);
        let corners = vec![low, vec2(high.x, low.y), high, vec2(low.x, high.y)];
        to.push(Layer::Evidence, Role::Paper, Subject::None, Mark::Area(corners));
        let at = middle + vec2(0.0, NUMBER_PT * 0.35);
        to.text(Layer::Labels, Role::Ink, at, NUMBER_PT, Anchor::Middle, text);
    }
}

/// The entries that the step wrote, or the one that decided.
fn light_entry<S: Faces>(moment: At<'_, '_, S>, cell: Vec2, first: Vec2, to: &mut Drawing) {
    let (low, past, role) = match moment.note {
        Some(Evidence::Written(_, r, _)) => ([r.x0, r.y0], [r.x1, r.y1], Role::Occluder),
        Some(Evidence::Compared(n)) => {
            let [x, y] = n.test.entry;
            let role = if n.test.is_behind { Role::Hidden } else { Role::Visible };
            ([x, y], [x + 1, y + 1], role)
        }
        _ => return,
    };
    let at = |[x, y]: [u32; 2]| first + cell * vec2(x as f32, y as f32);
    let (a, b) = (at(low), at(past));
    to.outline(Layer::Emphasis, role, Subject::None, [a, vec2(b.x, a.y), b, vec2(a.x, b.y)]);
}

/// The candidates in their order, with the sum of their polygons against L.
fn choice<S: Faces>(moment: At<'_, '_, S>) -> Drawing {
    const ROWS: usize = 28;
    let choices: Vec<&Choice> = moment
        .notes
        .iter()
        .filter_map(|n| if let Evidence::Chosen(choice) = n { Some(choice) } else { None })
        .collect();
    let mut to = Drawing::default();
    let limit = choices.first().map_or(0, |c| c.limit);
    let title = format!("Leaves in the order in which they are chosen, up to L = {limit} polygons");
    let mark = Mark::Text {
        at: vec2(0.0, 10.0),
        text: title,
        size_pt: 9.0,
        anchor: Anchor::Start,
        font: Font::Bold,
    };
    to.push(Layer::Labels, Role::Ink, Subject::None, mark);
    // The latest rows, which are those that the step has added.
    let first = choices.len().saturating_sub(ROWS);
    for (line, (n, choice)) in choices.iter().enumerate().skip(first).enumerate() {
        let y = 24.0 + 11.0 * line as f32;
        let c = &choice.candidate;
        let role = if choice.is_taken { Role::Ink } else { Role::Faint };
        let fate = match (choice.is_taken, c.is_kept) {
            (true, true) => "occluder, kept from the last frame",
            (true, false) => "occluder",
            (false, _) if c.distance > choice.reach => "beyond the distance limit",
            (false, _) => "would exceed L",
        };
        let cells = [
            format!("{}. node {}", n + 1, c.node),
            format!("{} units", short(c.distance)),
            format!("{} polygons", c.polygons),
            format!("sum {}", choice.sum),
            fate.to_owned(),
        ];
        for (text, x) in cells.into_iter().zip([0.0, 95.0, 175.0, 255.0, 330.0]) {
            to.text(Layer::Labels, role, vec2(x, y), 8.0, Anchor::Start, text);
        }
    }
    // As high with few rows as with many: the picture keeps its size from step to step.
    finished(to, 24.0 + 11.0 * ROWS as f32, "The choice of occluders")
}
