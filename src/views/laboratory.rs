//! Speed against error: the chart of all methods on the Eye's path, live, each point a way to its worst step;
//! and advice.

use eframe::egui::{self, DragValue, RichText, ScrollArea, Sense};
use glam::vec2;

use super::Answers;
use crate::app::{Command, Laboratory, Map, State};
use crate::drawing::{Drawing, Mark, Subject};
use crate::figure::tradeoff;
use crate::measure::advise::Advice;
use crate::render::screen;

/// Size of the chart on paper, before it is scaled to the dialog.
const CHART_PT: glam::Vec2 = vec2(430.0, 230.0);
/// A point is meant from this far away.
const NEAR_PX: f32 = 9.0;

/// Shows the dialog's inside. `most_wrong`: the share that is typed, per cent.
pub fn show(state: &State, most_wrong: &mut f32, ui: &mut egui::Ui, answers: &mut Answers) {
    let size = ui.ctx().content_rect().size();
    let width = (size.x * 0.8).min(820.0);
    ui.set_width(width);
    ui.heading("Speed against error");
    let Some(stage) = state.staged() else { return };
    ui.label(format!(
        "All methods on the Eye's path through {}, and every parameter of the chosen method at other values.",
        stage.scene().name()
    ));
    asked(state, most_wrong, width, ui, answers);
    ScrollArea::vertical().max_height(size.y * 0.8 - 150.0).auto_shrink([false, true]).show(ui, |ui| {
        if !state.is_found_here() {
            return;
        }
        let found = &state.findings;
        if let Some(advice) = &found.advice {
            advised(advice, ui, answers);
            ui.separator();
        }
        if let Some(chart) = &found.chart {
            let mut drawing = Drawing { size_pt: CHART_PT, ..Drawing::default() };
            tradeoff(&mut drawing, chart, [vec2(4.0, 4.0), CHART_PT - 4.0]);
            let name = format!("Chart: speed against error on {}", chart.title);
            let scale = (width - 16.0) / CHART_PT.x;
            if let Some((number, response)) = paint(state, &drawing, &name, scale, ui) {
                if response.clicked() {
                    answers.push(Command::Laboratory(Laboratory::Open(number)));
                }
                said(response, found.about(number));
            }
            ui.weak(
                "Up: slower. Right: more pixels of another color than the exact image's; what makes none \
                 stands in the band at the left. Dotted steps and rings: what nothing beats in both. Small \
                 dots: single frames. Click a point to go to the step at which it first went wrong, in its \
                 worst frame.",
            );
            ui.separator();
        }
        if let Some(map) = &found.map {
            mapped(state, map, width, ui, answers);
        }
    });
}

/// What can be asked for, and how far it is.
fn asked(state: &State, most_wrong: &mut f32, width: f32, ui: &mut egui::Ui, answers: &mut Answers) {
    let busy = state.busy();
    ui.horizontal_wrapped(|ui| {
        ui.add_enabled_ui(busy.is_none(), |ui| {
            let measure = ui.button("Measure").on_hover_text("The chart fills while it measures");
            if measure.clicked() {
                answers.push(Command::Laboratory(Laboratory::Measure));
            }
            ui.separator();
            let advise = ui.button("Advise").on_hover_text(
                "Looks for the simplest method and parameters that are right enough at the least time, and \
                 checks them on other views of the path",
            );
            if advise.clicked() {
                answers.push(Command::Laboratory(Laboratory::Advise(*most_wrong)));
            }
            let label = ui.label("wrong pixels at most").id;
            ui.add(DragValue::new(most_wrong).range(0.0..=100.0).speed(0.02).max_decimals(3).suffix(" %"))
                .labelled_by(label);
            ui.separator();
            let map = ui.button("Map").on_hover_text(
                "Looks over the floor plan and along the path for what the chosen method does wrong, and for \
                 what changes without cause",
            );
            if map.clicked() {
                answers.push(Command::Laboratory(Laboratory::Map));
            }
        });
    });
    let Some(busy) = busy else { return };
    ui.horizontal(|ui| {
        ui.add(egui::ProgressBar::new(busy.fraction).desired_width(width * 0.7).text(busy.what));
        if ui.button("Stop").on_hover_text("Stops; what is known stays").clicked() {
            answers.push(Command::Laboratory(Laboratory::Stop));
        }
    });
}

/// A picture; the point of it that is under the pointer, with what the pointer did.
fn paint(
    state: &State,
    drawing: &Drawing,
    name: &str,
    scale: f32,
    ui: &mut egui::Ui,
) -> Option<(u32, egui::Response)> {
    let size = drawing.size_pt;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(size.x, size.y) * scale, Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    let painter = ui.painter_at(rect);
    screen::paint_paper(&painter, size, state.shown.theme, rect.min, scale);
    screen::paint(&painter, drawing, state.shown.theme, rect.min, scale);
    let place = |at: glam::Vec2| rect.min + egui::vec2(at.x, at.y) * scale;
    let pointer = response.hover_pos()?;
    let points = drawing.items.iter().filter_map(|item| match (item.subject, &item.mark) {
        (Subject::Tried(number), Mark::Dot { at, radius_pt }) => {
            Some((number, place(*at), (radius_pt * scale).max(NEAR_PX)))
        }
        _ => None,
    });
    let near = points.map(|(number, at, reach)| (number, at, at.distance(pointer) / reach, reach));
    let nearest = near.filter(|n| n.2 < 1.0).min_by(|a, b| a.2.total_cmp(&b.2));
    let (number, at, _, reach) = nearest?;
    painter.circle_stroke(at, reach, egui::Stroke::new(1.5, ui.visuals().strong_text_color()));
    Some((number, response))
}

/// Says what is under the pointer.
fn said(response: egui::Response, text: Option<String>) {
    if let Some(text) = text {
        response.on_hover_cursor(egui::CursorIcon::PointingHand).on_hover_text_at_pointer(text);
    }
}

/// The map of wrong culls and popping, and where decisions flip.
fn mapped(state: &State, map: &Map, width: f32, ui: &mut egui::Ui, answers: &mut Answers) {
    let (path, grid) = (map.found.on_path(), map.found.on_grid());
    ui.label(format!(
        "{}: of {} places {} are wrong somewhere; {} pixels pop with a small step. Along the path {} \
         primitives that are visible were missed and {} popped.",
        map.of.label(),
        map.found.grid.len(),
        map.found.grid.iter().filter(|spot| !spot.found.is_exact()).count(),
        grid.popped_pixels,
        path.missed,
        path.popped,
    ));
    let scale = ((width - 16.0) / map.picture.size_pt.x).min(520.0 / map.picture.size_pt.y);
    if let Some((number, response)) = paint(state, &map.picture, "Map: stability", scale, ui) {
        if response.clicked() {
            answers.push(Command::Laboratory(Laboratory::Stand(number)));
        }
        said(response, map.about(number));
    }
    ui.weak("Click a dot to put the Eye there and go to the first step that went wrong.");
    for (number, flip) in map.found.flips.iter().enumerate() {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Go").on_hover_text("Puts the Eye where it is left out").clicked() {
                answers.push(Command::Laboratory(Laboratory::Flip(number)));
            }
            let [drawn, left_out] = &flip.decided;
            ui.label(format!(
                "Between views {} and {} primitive {} flips within {:.2e} units: {} here, {} there.",
                map.frames[flip.after_view],
                map.frames[flip.after_view + 1],
                flip.prim,
                flip.apart,
                drawn.verdict,
                left_out.verdict,
            ));
        });
        if let Some(compared) = &flip.decided[1].compared {
            ui.weak(format!("{} Compared: {compared}.", flip.decided[1].sentence));
        }
    }
}

fn advised(advice: &Advice, ui: &mut egui::Ui, answers: &mut Answers) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Advised:");
        ui.label(RichText::new(advice.configuration().label()).strong());
        if ui.button("Use this").on_hover_text("Chooses this method with these parameters").clicked() {
            answers.push(Command::Laboratory(Laboratory::Use));
        }
    });
    let (unseen, frustum) = (&advice.unseen, &advice.frustum);
    ui.label(format!(
        "On {} views that it was not chosen by: {:.3} ms a frame, {:.4} % of the pixels wrong.",
        unseen.frames, unseen.time_ms, unseen.wrong_percent
    ));
    if advice.is_plain() {
        ui.label("Occlusion culling does not pay here: nothing that was tried is faster and right enough.");
    } else {
        ui.label(format!("Frustum culling alone takes {:.3} ms there.", frustum.time_ms));
    }
    ui.collapsing(format!("All {} that were tried", advice.trials.len()), |ui| {
        super::tables::table(ui, &advice.table());
    });
}
