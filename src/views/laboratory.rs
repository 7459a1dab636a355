//! Speed against error: the chart of all methods on the Eye's path, live, each point a way to its worst step;
//! and advice.

use eframe::egui::{self, DragValue, RichText, ScrollArea, Sense};
use glam::vec2;

use super::Answers;
use crate::app::{Command, Laboratory, State};
use crate::drawing::{Drawing, Mark, Subject, Tradeoff};
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
        let found = &state.findings;
        if let Some(chart) = found.chart.as_ref().filter(|_| state.is_found_here()) {
            paint(state, chart, width - 16.0, ui, answers);
            ui.weak(
                "Up: slower. Right: more pixels of another color than the exact image's; what makes none \
                 stands at the left. Steps and rings: what nothing beats in both. Small dots: single frames. \
                 Click a point to go to the step at which it first went wrong, in its worst frame.",
            );
        }
        if let Some(advice) = found.advice.as_ref().filter(|_| state.is_found_here()) {
            ui.separator();
            advised(advice, ui, answers);
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

fn paint(state: &State, chart: &Tradeoff, width: f32, ui: &mut egui::Ui, answers: &mut Answers) {
    let mut drawing = Drawing { size_pt: CHART_PT, ..Drawing::default() };
    tradeoff(&mut drawing, chart, [vec2(4.0, 4.0), CHART_PT - 4.0]);
    let scale = width / CHART_PT.x;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(CHART_PT.x, CHART_PT.y) * scale, Sense::click());
    response.widget_info(|| {
        let text = format!("Chart: speed against error on {}", chart.title);
        egui::WidgetInfo::labeled(egui::Role::Image, true, text)
    });
    let painter = ui.painter_at(rect);
    screen::paint_paper(&painter, CHART_PT, state.shown.theme, rect.min, scale);
    screen::paint(&painter, &drawing, state.shown.theme, rect.min, scale);
    let place = |at: glam::Vec2| rect.min + egui::vec2(at.x, at.y) * scale;
    let Some(pointer) = response.hover_pos() else { return };
    let points = drawing.items.iter().filter_map(|item| match (item.subject, &item.mark) {
        (Subject::Tried(number), Mark::Dot { at, .. }) => Some((number, place(*at))),
        _ => None,
    });
    let near = points.map(|(number, at)| (number, at, at.distance(pointer)));
    let nearest = near.filter(|n| n.2 < NEAR_PX).min_by(|a, b| a.2.total_cmp(&b.2));
    let Some((number, at, _)) = nearest else { return };
    let color = ui.visuals().strong_text_color();
    painter.circle_stroke(at, NEAR_PX * 0.8, egui::Stroke::new(1.5, color));
    if response.clicked() {
        answers.push(Command::Laboratory(Laboratory::Open(number)));
    }
    if let Some(text) = state.findings.about(number) {
        response.on_hover_cursor(egui::CursorIcon::PointingHand).on_hover_text_at_pointer(text);
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
