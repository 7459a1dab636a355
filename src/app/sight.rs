//! What the Eye sees, as a figure: of space an image, of flatland the one line of pixels with the walls above
//! it.

use std::collections::BTreeSet;

use glam::{Vec2, vec2};

use super::pick::Column;
use super::plate::Export;
use super::shown::Surface;
use super::stage::Stage;
use super::state::State;
use crate::drawing::words::count;
use crate::drawing::{Anchor, Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::figure::page::{self, Entry, Swatch};
use crate::figure::{Panel, Picture, panels, role_of};
use crate::geometry::{Either, Flat, PrimId, Solid, each};
use crate::method::Verdict;
use crate::render::theme::{Rgb, Theme};
use crate::trace::State as Known;

/// Heights of the walls, of the strip of pixels and of what is around them, points.
const WALLS_PT: f32 = 110.0;
const STRIP_PT: f32 = 16.0;
const GAP_PT: f32 = 9.0;
const TEXT_PT: f32 = 8.0;
/// Rows of the image of the walls.
const ROWS: u32 = 256;
/// How much of what is behind a see-through segment is covered by it.
const VEIL: f32 = 0.3;

/// What a column shows, the farthest first.
type Bands = Vec<Band>;

/// A thing in a column.
#[derive(Clone, Copy)]
struct Band {
    /// Its color as a wall, which fades with the distance, and as a pixel of the strip.
    wall: Rgb,
    pixel: Rgb,
    /// Half its height as a wall, of the whole.
    half: f32,
    subject: Subject,
}

impl State {
    /// Whether the method stands something for primitives.
    pub fn has_stand_ins(&self) -> bool {
        self.stage.as_ref().is_some_and(|stage| each!(stage, s => s.drawn(0).is_some()))
    }
    /// The Eye's picture with a label below it, no larger than the room apart from the label, and its
    /// legend.
    pub(super) fn seen(&self, export: &Export, room: Vec2, label: String) -> Option<(Drawing, Vec<Entry>)> {
        match self.stage.as_ref()? {
            Either::Flat(stage) => self.strip(stage, export, room, &label),
            Either::Solid(stage) => self.image(stage, export, room, label),
        }
    }

    fn image(
        &self,
        stage: &Stage<Solid>,
        export: &Export,
        room: Vec2,
        label: String,
    ) -> Option<(Drawing, Vec<Entry>)> {
        let mut view = stage.view;
        let aspect = view.width as f32 / view.height.max(1) as f32;
        // A panel is at most so much higher than it is wide.
        let width = room.x.min(room.y * aspect).min(room.x * aspect * 1.6).max(20.0);
        let mut ask = self.ask(export, true);
        let painted = (self.shown.surface == Surface::Solid && self.shown.prims)
            .then(|| stage.drawn(self.step))
            .flatten()
            .and_then(|list| stage.painted(&list, export.theme.flat_linear(Role::Paper)));
        let is_painted = painted.is_some();
        ask.shown.prims &= !is_painted;
        let size = Vec2::new(width, width / aspect) * ask.pixels_per_point;
        (view.width, view.height) = (size.x.round().max(1.0) as u32, size.y.round().max(1.0) as u32);
        let (pixels, over) = stage.surfaces(&view, &ask)?;
        let marks = page::legend(&over);
        let picture = Picture::Over(painted.unwrap_or(pixels), over, view);
        let mut entries = self.entries(marks);
        // What was left out is not in this picture; what stands for something has colors of its own.
        entries.retain(|e| match e.role {
            Role::Scene | Role::Visible => !is_painted,
            role => matches!(role, Role::Current | Role::Selected | Role::Evidence | Role::Paper),
        });
        Some((panels(width, 1, &[Panel { label, picture }]), entries))
    }

    fn strip(
        &self,
        stage: &Stage<Flat>,
        export: &Export,
        room: Vec2,
        label: &str,
    ) -> Option<(Drawing, Vec<Entry>)> {
        let columns = self.columns(stage, export.theme);
        let walls = [vec2(0.0, 2.0 * TEXT_PT), vec2(room.x, 2.0 * TEXT_PT + WALLS_PT)];
        let strip = [vec2(0.0, walls[1].y + GAP_PT), vec2(room.x, walls[1].y + GAP_PT + STRIP_PT)];
        let mut paper =
            Drawing { size_pt: vec2(room.x, strip[1].y + GAP_PT + 1.8 * TEXT_PT), ..Drawing::default() };
        let ground = export.theme.paper();
        for (corners, rows) in [(walls, ROWS), (strip, 1)] {
            let pixels = image(&columns, rows, ground);
            paper.push(Layer::Ground, Role::Scene, Subject::None, Mark::Image { corners, pixels });
        }
        rims(&columns, [walls, strip], &mut paper);
        let [a, b] = strip;
        paper.outline(Layer::Labels, Role::Faint, Subject::None, [a, vec2(b.x, a.y), b, vec2(a.x, b.y)]);
        self.underline(stage, strip, &mut paper);
        let seen: BTreeSet<Subject> = columns.iter().flatten().map(|band| band.subject).collect();
        let plural = if seen.len() == 1 { "" } else { "s" };
        let text = format!("{} pixels, {} segment{plural} seen", count(columns.len()), count(seen.len()));
        let text = if stage.drawn(0).is_some() { format!("{} pixels", count(columns.len())) } else { text };
        paper.text(Layer::Labels, Role::Faint, vec2(0.0, TEXT_PT), TEXT_PT, Anchor::Start, text);
        let at = vec2(room.x * 0.5, paper.size_pt.y - 0.4 * TEXT_PT);
        paper.text(Layer::Labels, Role::Ink, at, TEXT_PT, Anchor::Middle, label.to_owned());
        let mut entries = self.entries(Vec::new());
        entries.retain(|e| !matches!(e.role, Role::Partial | Role::Occluder));
        entries.iter_mut().filter(|e| matches!(e.role, Role::Current | Role::Selected)).for_each(|e| {
            e.swatch = Swatch::Line;
        });
        Some((paper, entries))
    }

    /// What is selected stands below the strip, what the step is about on it.
    fn underline(&self, stage: &Stage<Flat>, strip: [Vec2; 2], paper: &mut Drawing) {
        let width = strip[1].x;
        for (subject, role, y) in [
            (self.selection, Role::Selected, strip[1].y + 4.0),
            (self.current_subject(), Role::Current, strip[0].y - 4.0),
        ] {
            let Some((from, to)) = stage.extent_of(subject) else { continue };
            let x = |ndc: f32| (ndc * 0.5 + 0.5) * width;
            let ends = [vec2(x(from), y), vec2(x(to).max(x(from) + 4.0).min(width), y)];
            paper.line(Layer::Emphasis, role, subject, ends);
        }
    }

    /// What each column shows: what a method stands for segments in its own colors, else segments by state.
    fn columns(&self, stage: &Stage<Flat>, theme: Theme) -> Vec<Bands> {
        let half = |nearest: f32, depth: f32| 0.46 * (nearest / depth).sqrt();
        if let Some(list) = stage.drawn(self.step)
            && let Some(pixels) = stage.painted(&list, theme.flat_linear(Role::Paper))
        {
            let depths = stage.nearest_drawn(&list);
            let nearest = depths.iter().flatten().copied().fold(f32::INFINITY, f32::min);
            let colors = pixels.rgba.as_chunks::<4>().0.iter().map(|p| [p[0], p[1], p[2]]);
            let band = |(color, depth): (Rgb, &Option<f32>)| {
                let of =
                    |d| Band { wall: color, pixel: color, half: half(nearest, d), subject: Subject::None };
                depth.map(of).into_iter().collect()
            };
            return colors.zip(&depths).map(band).collect();
        }
        let image = stage.image();
        let all = |c: &Column| c.opaque.into_iter().chain(c.through.iter().copied()).collect::<Vec<_>>();
        let nearest = image.iter().flat_map(all).map(|(_, d)| d).fold(f32::INFINITY, f32::min);
        let bands = |(i, column): (usize, &Column)| {
            let mut under = [theme.paper(); 2];
            let band = |(prim, depth): (PrimId, f32)| {
                let known = stage.recorded.as_ref().map_or(Known::Unseen, |r| r.stamps.prim(prim, self.step));
                let is_veil = column.opaque.is_none_or(|(p, _)| p != prim);
                let near = (nearest / depth).sqrt();
                let alpha = if is_veil { VEIL } else { 1.0 };
                let culled = matches!(known, Known::Decided(v)
                    if v != Verdict::Visible && v != Verdict::Partial);
                // What was culled has gaps: every other pair of columns is left out.
                let wall = if culled && (i / 2) % 2 == 1 { 0.0 } else { alpha * (0.35 + 0.65 * near) };
                let color = theme.style(role_of(known)).stroke;
                under = [mixed(under[0], color, wall), mixed(under[1], color, alpha)];
                let [wall, pixel] = under;
                Band { wall, pixel, half: half(nearest, depth), subject: Subject::Prim(prim) }
            };
            all(column).into_iter().map(band).collect()
        };
        image.iter().enumerate().map(bands).collect()
    }
}

/// Columns as an image of so many rows; of one row each shows the whole of what is nearest.
fn image(columns: &[Bands], rows: u32, ground: Rgb) -> Pixels {
    let mut rgba = Vec::with_capacity(4 * columns.len() * rows as usize);
    for row in 0..rows {
        let away = ((row as f32 + 0.5) / rows as f32 - 0.5).abs();
        for column in columns {
            let shown = column.iter().rev().find(|band| rows == 1 || away <= band.half);
            let [r, g, b] = shown.map_or(ground, |band| if rows == 1 { band.pixel } else { band.wall });
            rgba.extend([r, g, b, 255]);
        }
    }
    Pixels { width: columns.len() as u32, height: rows, rgba: rgba.into() }
}

/// Neighbors of one role stay apart.
fn rims(columns: &[Bands], places: [[Vec2; 2]; 2], paper: &mut Drawing) {
    for i in 1..columns.len() {
        let (Some(a), Some(b)) = (columns[i - 1].last(), columns[i].last()) else { continue };
        if a.subject == b.subject {
            continue;
        }
        for [min, max] in places {
            let x = min.x + (max.x - min.x) * i as f32 / columns.len() as f32;
            let ends = [vec2(x, min.y), vec2(x, max.y)];
            paper.line(Layer::Areas, Role::Paper, Subject::None, ends);
        }
    }
}

fn mixed(under: Rgb, over: Rgb, alpha: f32) -> Rgb {
    let mix = |i: usize| (f32::from(under[i]) * (1.0 - alpha) + f32::from(over[i]) * alpha + 0.5) as u8;
    [mix(0), mix(1), mix(2)]
}
