//! Flatland through the Eye: its image is one line of pixels. Above the line each column stands as high as
//! what it shows is near, as in the first games with walls. What a method stands for segments has its own
//! colors.

use eframe::egui::{self, Align2, Color32, FontId, Rangef, Rect, Sense, Stroke, pos2, vec2};

use super::handles::Hand;
use super::{Answers, palette};
use crate::app::{Column, Command, Gesture, PoseKey, Stage, State, Theme};
use crate::drawing::words::{Room, short};
use crate::drawing::{Role, Subject};
use crate::figure::role_of;
use crate::geometry::{Either, Flat, PrimId, View};
use crate::method::Verdict;
use crate::render::screen;
use crate::trace::State as Known;

/// The gesture of turning the Eye in its picture: all turns in a row are one step of undo.
const LOOK_GESTURE: Gesture = Gesture::MAX;
/// Height of the strip itself.
const STRIP: f32 = 22.0;

/// What the columns of an image were rendered for: the scene as it was posed, and the view.
type Rendered = (PoseKey, View<Flat>);

/// The columns of the image, and the scene and view that they were rendered for; and those of what is drawn
/// of a method that stands something for segments.
#[derive(Default)]
pub struct Image {
    rendered: Option<(Rendered, Vec<Column>)>,
    painted: Option<((u64, usize, Theme), Option<Painted>)>,
}

/// What a method that stands something for segments has drawn: the color of each column, and how far what it
/// shows is.
struct Painted {
    colors: Vec<Color32>,
    nearest: Vec<Option<f32>>,
}

/// Shows what the Eye sees.
pub fn show(
    state: &State,
    stage: &Stage<Flat>,
    kept: &mut Image,
    hand: &mut Hand,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(
            egui::Role::Image,
            true,
            "Eye view: the one line of pixels that the Eye sees",
        )
    });
    hand.is_picture_focused |= response.has_focus();
    let painter = ui.painter_at(rect);
    let colors = palette::panel(state);
    painter.rect_filled(rect, 0.0, colors.canvas);
    let key = (stage.pose_key(), stage.view);
    if kept.rendered.as_ref().is_none_or(|(k, _)| *k != key) {
        kept.rendered = Some((key, stage.image()));
    }
    find_painted(state, stage, kept);
    let Some((_, image)) = &kept.rendered else { return };
    let per_column = rect.width() / image.len().max(1) as f32;
    match &kept.painted {
        Some((_, Some(painted))) => paint_drawn(painted, &painter, rect),
        _ => paint_columns(state, stage, image, &painter, rect),
    }
    underline(state, stage, &painter, rect);
    painter.rect_stroke(layout(rect).1, 0.0, Stroke::new(1.0, colors.border), egui::StrokeKind::Outside);
    let distinct: std::collections::BTreeSet<_> = image.iter().flat_map(seen).map(|(p, _)| p).collect();
    let plural = if distinct.len() == 1 { "" } else { "s" };
    let text = format!("{} pixels, {} segment{plural} seen", image.len(), distinct.len());
    painter.text(
        pos2(rect.left() + 6.0, rect.top() + 4.0),
        Align2::LEFT_TOP,
        text,
        FontId::proportional(12.0),
        colors.faint,
    );
    super::space::changed_depths(state, stage, ui, layout(rect).0);
    let column = |x: f32| ((x - rect.left()) / per_column.max(1e-6)) as usize;
    let under = |at: egui::Pos2| {
        let shown = image.get(column(at.x))?;
        let nearest = shown.opaque.or(shown.through.last().copied()).map(|(prim, _)| prim);
        Some(([column(at.x) as u32, 0], nearest))
    };
    super::pixel::interact(state, hand, ui, &response, under, answers);
    interact(stage, image, per_column, &response, answers);
    super::canvas::focus_ring(state, ui, &response);
}

/// All that a column shows, from far to near.
fn seen(column: &Column) -> impl Iterator<Item = (PrimId, f32)> {
    column.opaque.into_iter().chain(column.through.iter().copied())
}

/// How much of what is behind see-through segments is covered by one.
const VEIL: f32 = 0.3;

/// Paints each column twice: as a wall as high as it is near, and as a pixel of the strip; see-through ones
/// over what is behind them.
fn paint_columns(state: &State, stage: &Stage<Flat>, image: &[Column], painter: &egui::Painter, rect: Rect) {
    let (walls, strip) = layout(rect);
    let rim = Stroke::new(1.0, palette::panel(state).canvas);
    let nearest = image.iter().flat_map(seen).map(|(_, d)| d).fold(f32::INFINITY, f32::min);
    let per_column = rect.width() / image.len().max(1) as f32;
    for (i, column) in image.iter().enumerate() {
        let x = rect.left() + i as f32 * per_column;
        let width = Rangef::new(x, x + per_column.max(1.0));
        for (prim, depth) in seen(column) {
            let known = stage.recorded.as_ref().map_or(Known::Unseen, |r| r.stamps.prim(prim, state.step));
            let is_veil = column.opaque.is_none_or(|(p, _)| p != prim);
            let style = palette::role(state, role_of(known)).gamma_multiply(if is_veil { VEIL } else { 1.0 });
            let half = walls.height() * 0.46 * (nearest / depth).sqrt();
            let band = Rangef::new(walls.center().y - half, walls.center().y + half);
            let faded = style.gamma_multiply(0.35 + 0.65 * (nearest / depth).sqrt());
            // What was culled has gaps: every other pair of columns is left out.
            let culled = matches!(known, Known::Decided(v) if v != Verdict::Visible && v != Verdict::Partial);
            if !culled || (i / 2) % 2 == 0 {
                painter.rect_filled(Rect::from_x_y_ranges(width, band), 0.0, faded);
            }
            painter.rect_filled(Rect::from_x_y_ranges(width, strip.y_range()), 0.0, style);
            // Neighbors of one role stay apart.
            if i == 0 || seen(&image[i - 1]).all(|(p, _)| p != prim) {
                painter.vline(x, band, rim);
                painter.vline(x, strip.y_range(), rim);
            }
        }
    }
}

/// Paints what a method stands for segments up to the step, if that has changed; nothing of other methods,
/// and while the film is not that of the present Eye.
fn find_painted(state: &State, stage: &Stage<Flat>, kept: &mut Image) {
    let Some(recorded) = stage.recorded.as_ref().filter(|r| *r.film.view() == stage.view) else {
        kept.painted = None;
        return;
    };
    let key = (recorded.serial, state.step, state.shown.theme);
    if kept.painted.as_ref().is_some_and(|(k, _)| *k == key) {
        return;
    }
    let painted = stage.drawn(state.step).and_then(|list| {
        let pixels = stage.painted(&list, state.shown.theme.flat_linear(Role::Paper))?;
        let colors = pixels.rgba.chunks_exact(4).map(|p| screen::color([p[0], p[1], p[2]])).collect();
        Some(Painted { colors, nearest: stage.nearest_drawn(&list) })
    });
    kept.painted = Some((key, painted));
}

/// Paints the columns of what is drawn in their own colors.
fn paint_drawn(painted: &Painted, painter: &egui::Painter, rect: Rect) {
    let (walls, strip) = layout(rect);
    let nearest = painted.nearest.iter().flatten().copied().fold(f32::INFINITY, f32::min);
    let per_column = rect.width() / painted.colors.len().max(1) as f32;
    for (i, (color, depth)) in painted.colors.iter().zip(&painted.nearest).enumerate() {
        let x = rect.left() + i as f32 * per_column;
        let width = Rangef::new(x, x + per_column.max(1.0));
        if let Some(depth) = depth {
            let half = walls.height() * 0.46 * (nearest / depth).sqrt();
            let band = Rangef::new(walls.center().y - half, walls.center().y + half);
            painter.rect_filled(Rect::from_x_y_ranges(width, band), 0.0, *color);
        }
        painter.rect_filled(Rect::from_x_y_ranges(width, strip.y_range()), 0.0, *color);
    }
}

/// What is selected stands below the strip, what the step is about on it.
fn underline(state: &State, stage: &Stage<Flat>, painter: &egui::Painter, rect: Rect) {
    let strip = layout(rect).1;
    for (subject, role, y) in [
        (state.selection, Role::Selected, strip.bottom() + 4.0),
        (state.current_subject(), Role::Current, strip.top() - 4.0),
    ] {
        if let Some((from, to)) = stage.extent_of(subject) {
            let x = |ndc: f32| rect.left() + (ndc * 0.5 + 0.5) * rect.width();
            let place = Rangef::new(x(from), x(to).max(x(from) + 8.0));
            painter.hline(place, y, Stroke::new(5.0, palette::halo(state, role)));
            painter.hline(place, y, Stroke::new(1.5, palette::role(state, role)));
        }
    }
}

/// The walls above, the strip of pixels below.
fn layout(rect: Rect) -> (Rect, Rect) {
    let strip =
        Rect::from_min_size(pos2(rect.left(), rect.bottom() - STRIP - 12.0), vec2(rect.width(), STRIP));
    (rect.with_max_y(strip.top() - 8.0).with_min_y(rect.top() + 20.0), strip)
}

fn interact(
    stage: &Stage<Flat>,
    image: &[Column],
    per_column: f32,
    response: &egui::Response,
    answers: &mut Answers,
) {
    // Through glass one clicks what is behind it, if there is anything.
    let under = |x: f32| {
        let column = image.get(((x - response.rect.left()) / per_column.max(1e-6)) as usize)?;
        column.opaque.or(column.through.last().copied())
    };
    if response.clicked() {
        response.request_focus();
        if let Some(at) = response.interact_pointer_pos() {
            answers.push(Command::Select(under(at.x).map_or(Subject::None, |(p, _)| Subject::Prim(p))));
        }
    }
    // Dragging turns the Eye, as looking around does.
    if response.dragged() && response.drag_delta().x != 0.0 {
        let mut view = stage.view;
        let turn = response.drag_delta().x / response.rect.width().max(1.0) * view.eye.fov;
        let toward = glam::Vec2::from_angle(turn).rotate(view.eye.target - view.eye.position);
        view.eye.target = view.eye.position + toward;
        answers.push(Command::Eye(Either::Flat(view), LOOK_GESTURE));
    }
    if let Some((prim, depth)) = response.hover_pos().and_then(|at| under(at.x)) {
        response
            .clone()
            .on_hover_text_at_pointer(format!("segment {prim}, {} units away", short(depth, Room::Row)));
    }
}
