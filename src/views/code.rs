//! The pseudocode: the current line lit, the values of the current event beside it, breakpoints at lines.

use eframe::egui::{self, RichText, ScrollArea, Sense};

use super::icons::{self, Icon};
use super::{Answers, palette};
use crate::app::{Breakpoint, Command, Layout, Reading, State};
use crate::method::{Card, CodeLine, Event, Verdict};
use crate::trace::Counts;

/// The lines that a film reaches, and the film.
pub type Reached = (u64, Vec<bool>);

/// Least sizes of type: on a desk, and on a wall.
const LEAST: f32 = 11.0;
const LEAST_IN_A_ROOM: f32 = 15.0;
/// Indent of what stands below a line.
const INDENT: f32 = 48.0;

/// Shows the pseudocode: of its lines those that the parameters have.
pub fn show(state: &State, kept: &mut Option<Reached>, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(film) = state.film() else { return };
    let card = film.reel.card();
    if kept.as_ref().is_none_or(|(serial, _)| *serial != film.serial) {
        *kept = Some((film.serial, (0..card.code.len()).map(|i| state.reaches(i as u8)).collect()));
    }
    let Some((_, reached)) = kept else { return };
    let lit = state.line();
    let values = state.values();
    stops(state, film, ui, answers);
    // A step, a film or another size of the panel scrolls to the line; in between one may scroll away.
    let shown = (state.step, film.serial, ui.available_height() as u32);
    let is_new = ui.data_mut(|d| {
        let id = ui.scope_id().with("shown step");
        d.get_temp_mut_or_default::<Option<(usize, u64, u32)>>(id).replace(shown)
    }) != Some(shown);
    let width = ui.available_width() - ui.spacing().scroll.bar_width;
    ScrollArea::vertical().auto_shrink(false).id_salt("code").show(ui, |ui| {
        let right = ui.cursor().left() + width;
        let least = if state.shown.layout == Layout::Lecture { LEAST_IN_A_ROOM } else { LEAST };
        let size = fitting_size(ui, card.code, width, least);
        for (i, line) in card.code.iter().enumerate().filter(|(i, _)| film.reel.has_line(*i as u8)) {
            let row = Row {
                number: i as u8,
                line,
                is_lit: lit == Some(i as u8),
                is_reached: reached.get(i).copied().unwrap_or(false),
                size,
            };
            let shown = ui.horizontal(|ui| row.show(state, ui, answers)).response.rect;
            let mut shown = shown;
            if row.is_lit && !values.is_empty() {
                shown = shown.union(values_beside(state, ui, shown, right, &values));
            }
            if !line.paper.is_empty() {
                aside(ui, right, &format!("paper: {}", line.paper.trim()));
            }
            if row.is_lit && is_new {
                // With the lines around it.
                ui.scroll_to_rect(shown.expand2(egui::vec2(0.0, 2.0 * size)), None);
            }
        }
        departures(card, ui, right);
    });
}

/// The verdicts at which a run can stop.
fn stops(state: &State, film: Reading<'_>, ui: &mut egui::Ui, answers: &mut Answers) {
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
}

/// Where the method differs from its paper on purpose.
fn departures(card: &Card, ui: &mut egui::Ui, right: f32) {
    if card.departures.is_empty() {
        return;
    }
    ui.add_space(6.0);
    let title = format!("Departures from the paper ({})", card.departures.len());
    egui::CollapsingHeader::new(title).id_salt(card.key).show(ui, |ui| {
        for d in card.departures {
            let text = format!("{}: {}. Why: {}.", d.section, d.what, d.why);
            ui.set_max_width((right - ui.cursor().left()).max(60.0));
            ui.add(egui::Label::new(text).wrap());
        }
    });
}

/// A remark below a line, wrapped at the panel's edge.
fn aside(ui: &mut egui::Ui, right: f32, text: &str) {
    ui.horizontal(|ui| {
        ui.add_space(INDENT);
        ui.vertical(|ui| {
            ui.set_max_width((right - ui.cursor().left()).max(60.0));
            ui.add(egui::Label::new(RichText::new(text).weak().italics()).wrap());
        });
    });
}

/// Size of type in which every line fits into a panel of that width, if it can be read.
fn fitting_size(ui: &egui::Ui, code: &[CodeLine], width: f32, least: f32) -> f32 {
    /// Breakpoint, mark, padding and the gaps between.
    const BEFORE: f32 = 48.0;
    let body = egui::TextStyle::Body.resolve(ui.style()).size;
    let longest = code.iter().map(|l| l.text.chars().count()).max().unwrap_or(0);
    let advance = ui.fonts_mut(|f| f.glyph_width(&egui::FontId::monospace(body), 'M'));
    (body * (width - BEFORE) / (longest as f32 * advance).max(1.0)).clamp(least.min(body), body)
}

/// A line of pseudocode.
struct Row<'a> {
    number: u8,
    line: &'a CodeLine,
    is_lit: bool,
    /// Whether this film ever comes to it.
    is_reached: bool,
    size: f32,
}

impl Row<'_> {
    /// Its breakpoint, a mark at the current one, its text; faint where this film never comes.
    fn show(&self, state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
        ui.spacing_mut().item_spacing.x = 4.0;
        let stops = state.breakpoints.contains(&Breakpoint::Line(self.number));
        let (icon, color) = match (stops, self.is_reached) {
            (true, true) => (Icon::Dot, ui.visuals().error_fg_color),
            (true, false) => (Icon::Dot, palette::panel(state).border),
            (false, _) => (Icon::Ring, palette::panel(state).border),
        };
        let (label, never) = (self.line.label, "This frame never comes to this line.");
        let help = if self.is_reached { "Stop at this line, or no longer (F9)" } else { never };
        let response = icons::plain(ui, icon, Sense::click(), color).on_hover_text(help);
        response.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, true, stops, format!("Breakpoint at {label}"))
        });
        if response.clicked() {
            answers.push(Command::BreakLine(self.number));
        }
        let here = if self.is_lit { palette::panel(state).text } else { egui::Color32::TRANSPARENT };
        icons::plain(ui, Icon::Here, Sense::hover(), here);
        let mut text = RichText::new(self.line.text).monospace().size(self.size);
        if self.is_lit {
            text = text.background_color(palette::panel(state).lit_line);
        }
        if !self.is_reached {
            text = text.weak();
        }
        let click = if self.is_reached { "Click: to the next time that it runs" } else { never };
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Wrap);
        let response = ui.selectable_label(false, text).on_hover_text(format!("{label}\n{click}"));
        if response.clicked()
            && let Some(step) = next_time(state, self.number)
        {
            answers.push(Command::GoTo(step));
        }
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
    let indent = INDENT;
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
