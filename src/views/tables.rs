//! The papers' tables, measured: which one, how far it is, the table, its chart, and files of both.

use eframe::egui::{self, Grid, RichText, ScrollArea, Sense};

use super::Answers;
use crate::app::{Command, Measured, State, Tables, tables};
use crate::measure::Table;
use crate::render::screen;

/// Shows the dialog's inside.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let size = ui.ctx().content_rect().size();
    let width = (size.x * 0.8).min(860.0);
    ui.set_width(width);
    ui.heading("Tables of the papers");
    let on = state
        .staged()
        .map_or("on generated scenes like the paper's".to_owned(), |s| format!("on {}", s.scene().name()));
    ui.label(format!("Measured {on}, beside the paper's own figures."));
    choices(state, width, ui, answers);
    let Some(measured) = state.measured.clone() else { return };
    ui.separator();
    // The rest of the dialog has its place below.
    let room = size.y * 0.8 - 190.0;
    ScrollArea::both().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
        ui.strong(measured.report.title);
        table(ui, &measured.report.table);
        ui.add_space(8.0);
        chart(state, &measured, width, ui);
    });
    ui.horizontal(|ui| {
        ui.label("Write as");
        for (format, what) in [
            ("csv", "The table, with every digit"),
            ("svg", "The chart"),
            ("pdf", "The chart"),
            ("png", "The chart"),
        ] {
            if ui.button(format.to_uppercase()).on_hover_text(what).clicked() {
                answers.push(Command::Tables(Tables::Export(format)));
            }
        }
    });
}

/// Buttons for the tables, and how far the one is that is measured.
fn choices(state: &State, width: f32, ui: &mut egui::Ui, answers: &mut Answers) {
    let busy = state.busy();
    let shown = state.measured.as_ref().map(|m| m.report.name);
    ui.horizontal_wrapped(|ui| {
        for (name, title, summary) in tables() {
            let short = title.split_once(", ").map_or(title, |t| t.1);
            let button = egui::Button::selectable(shown == Some(name), short);
            if ui.add_enabled(busy.is_none(), button).on_hover_text(summary).clicked() {
                answers.push(Command::Tables(Tables::Measure(name)));
            }
        }
    });
    let Some(busy) = busy else { return };
    ui.horizontal(|ui| {
        ui.add(egui::ProgressBar::new(busy.fraction).desired_width(width * 0.7).text(busy.what));
        if ui.button("Stop").on_hover_text("Stops measuring").clicked() {
            answers.push(Command::Tables(Tables::Stop));
        }
    });
}

fn chart(state: &State, measured: &Measured, width: f32, ui: &mut egui::Ui) {
    let paper = measured.chart.size_pt;
    let scale = (width - 24.0) / paper.x;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(paper.x, paper.y) * scale, Sense::hover());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Chart: {}", measured.report.title))
    });
    let painter = ui.painter_at(rect);
    screen::paint_paper(&painter, paper, state.shown.theme, rect.min, scale);
    screen::paint(&painter, &measured.chart, state.shown.theme, rect.min, scale);
}

/// A table as text in columns.
pub fn table(ui: &mut egui::Ui, table: &Table) {
    Grid::new("table").striped(true).spacing([14.0, 3.0]).show(ui, |ui| {
        for column in &table.columns {
            let unit = if column.unit.is_empty() { String::new() } else { format!("\n{}", column.unit) };
            ui.label(RichText::new(format!("{}{unit}", column.title)).strong());
        }
        ui.end_row();
        for row in 0..table.rows.len() {
            for column in 0..table.columns.len() {
                ui.label(RichText::new(table.shown(row, column)).monospace());
            }
            ui.end_row();
        }
    });
}
