//! The pseudocode: the current line lit, the values of the current event beside it, breakpoints at lines.

use eframe::egui::{self, RichText, ScrollArea, Sense};

use super::icons::{self, Icon};
use super::inspector::value;
use super::{Answers, palette};
use crate::app::{Breakpoint, Command, State};
use crate::method::{CodeLine, Event, Verdict};
use crate::trace::Counts;

/// Shows the pseudocode.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(film) = state.film() else { return };
    let card = film.reel.card();
    let lit = state.line();
    let values = values(state);
    ui.horizontal_wrapped(|ui| {
        ui.weak("Stop at");
        let end = film.stamps.counts(state.len());
        for verdict in Counts::VERDICTS.into_iter().filter(|&v| end.of(v) > 0 || v == Verdict::Outside) {
            let mut stops = state.breakpoints.contains(&Breakpoint::Verdict(verdict));
            if ui
                .checkbox(&mut stops, verdict.name())
                .on_hover_text("A run (F5) stops at every such verdict")
                .changed()
            {
                answers.push(Command::BreakVerdict(verdict));
            }
        }
    });
    // A step scrolls to its line; in between the person may scroll away.
    let is_new = ui.data_mut(|d| {
        d.get_temp_mut_or_default::<Option<usize>>(ui.scope_id().with("shown step")).replace(state.step)
    }) != Some(state.step);
    let width = ui.available_width() - ui.spacing().scroll.bar_width;
    ScrollArea::both().auto_shrink(false).id_salt("code").show(ui, |ui| {
        let right = ui.cursor().left() + width;
        let size = fitting_size(ui, card.code, width);
        for (i, line) in card.code.iter().enumerate() {
            let i = i as u8;
            let is_lit = lit == Some(i);
            let row = ui.horizontal(|ui| line_row(state, ui, i, line, is_lit, size, answers)).response;
            let mut shown = row.rect;
            if is_lit && !values.is_empty() {
                shown = shown.union(values_beside(state, ui, row.rect, right, &values));
            }
            if is_lit && is_new {
                ui.scroll_to_rect(shown, None);
            }
        }
    });
}

/// Size of type in which every line fits into a panel of that width, if it can be read.
fn fitting_size(ui: &egui::Ui, code: &[CodeLine], width: f32) -> f32 {
    const LEAST: f32 = 10.0;
    /// Breakpoint, mark, padding and the gaps between.
    const BEFORE: f32 = 48.0;
    let body = egui::TextStyle::Body.resolve(ui.style()).size;
    let longest = code.iter().map(|l| l.text.chars().count()).max().unwrap_or(0);
    let advance = ui.fonts_mut(|f| f.glyph_width(&egui::FontId::monospace(body), 'M'));
    (body * (width - BEFORE) / (longest as f32 * advance).max(1.0)).clamp(LEAST.min(body), body)
}

/// A line of pseudocode: its breakpoint, a mark at the current one, its text.
fn line_row(
    state: &State,
    ui: &mut egui::Ui,
    i: u8,
    line: &CodeLine,
    is_lit: bool,
    size: f32,
    answers: &mut Answers,
) {
    ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
    ui.spacing_mut().item_spacing.x = 4.0;
    let stops = state.breakpoints.contains(&Breakpoint::Line(i));
    let (icon, color) = if stops {
        (Icon::Dot, ui.visuals().error_fg_color)
    } else {
        (Icon::Ring, palette::panel(state).border)
    };
    let response =
        icons::plain(ui, icon, Sense::click(), color).on_hover_text("Stop at this line, or no longer (F9)");
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::CheckBox, true, stops, format!("Breakpoint at {}", line.label))
    });
    if response.clicked() {
        answers.push(Command::BreakLine(i));
    }
    let here = if is_lit { palette::panel(state).text } else { egui::Color32::TRANSPARENT };
    icons::plain(ui, Icon::Here, Sense::hover(), here);
    let mut text = RichText::new(line.text).monospace().size(size);
    if is_lit {
        text = text.background_color(palette::panel(state).lit_line);
    }
    let response = ui
        .selectable_label(false, text)
        .on_hover_text(format!("{}\nClick: to the next time that it runs", line.label));
    if response.clicked()
        && let Some(step) = next_time(state, i)
    {
        answers.push(Command::GoTo(step));
    }
}

/// The values beside their line where they fit, else below it, wrapped at the panel's edge.
fn values_beside(state: &State, ui: &mut egui::Ui, row: egui::Rect, right: f32, values: &str) -> egui::Rect {
    const GAP: f32 = 16.0;
    let text = RichText::new(values).color(palette::panel(state).accent);
    let galley = egui::WidgetText::from(text.clone()).into_galley(
        ui,
        Some(egui::TextWrapMode::Extend),
        f32::INFINITY,
        egui::TextStyle::Body,
    );
    if row.right() + GAP + galley.size().x <= right {
        let place = egui::Rect::from_min_max(
            egui::pos2(row.right() + GAP, row.top()),
            egui::pos2(right, row.bottom()),
        );
        let left = egui::Layout::left_to_right(egui::Align::Center);
        return ui
            .scope_builder(egui::UiBuilder::new().max_rect(place).layout(left), |ui| ui.label(text))
            .response
            .rect;
    }
    let indent = 3.0 * GAP;
    let width = (right - row.left() - indent).max(60.0);
    let wrapped = ui.horizontal(|ui| {
        ui.add_space(indent);
        ui.vertical(|ui| {
            ui.set_max_width(width);
            ui.add(egui::Label::new(text).wrap());
        });
    });
    wrapped.response.rect
}

/// The next time that a line runs; from the beginning if it does not run again.
fn next_time(state: &State, line: u8) -> Option<usize> {
    let events = state.events();
    let at = |i: &usize| events[*i] == Event::Line(line);
    (state.step..events.len()).find(at).or_else(|| (0..events.len()).find(at)).map(|i| i + 1)
}

/// The values that matter at this step: of the event itself, at a line of pseudocode those of the evidence
/// around it.
fn values(state: &State) -> String {
    let (Some(film), Some(at)) = (state.film(), state.current()) else { return String::new() };
    let event = film.reel.events()[at];
    let is_line = matches!(event, Event::Line(_) | Event::FrameBegan);
    let shown = if is_line { film.reel.evidence_at(state.step) } else { Some(at) };
    let Some(i) = shown else { return String::new() };
    let fields = film.reel.fields(i).1;
    fields
        .iter()
        .take(4)
        .map(|f| format!("{} {}", f.name.replace('_', " "), value(&f.value)))
        .collect::<Vec<_>>()
        .join(" · ")
}
