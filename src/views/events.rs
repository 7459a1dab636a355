//! The event tree: every event, nested by the nodes that were entered; one line an event, only those in sight
//! are made.

use eframe::egui::{self, Align, RichText, ScrollArea, Sense, TextEdit};

use super::Answers;
use super::icons::{self, Icon};
use super::legend::verdict_mark;
use crate::app::{Command, Reading, SceneFacts, State};
use crate::drawing::Subject;
use crate::drawing::words::{count, spaced};
use crate::method::{Event, Reel};

/// Indent of a level.
const INDENT: f32 = 9.0;
/// Deepest indent: deeper levels stay readable.
const MAX_LEVELS: usize = 14;

/// How far the tree is scrolled, and what it is to do in the next frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scroll {
    /// Step, film and number of rows that it was last scrolled for.
    shown: Option<(usize, u64, usize)>,
    /// Points above what is in sight.
    offset: f32,
    /// Put the cursor into the filter.
    pub focus_filter: bool,
}

/// Shows the event tree.
pub fn show(state: &State, scroll: &mut Scroll, ui: &mut egui::Ui, answers: &mut Answers) {
    search(state, scroll, ui, answers);
    let rows = state.outline.rows();
    if let Some(error) = state.outline.error() {
        ui.colored_label(ui.visuals().error_fg_color, error.to_string());
    }
    let shown = if rows.len() == state.len() { String::new() } else { format!("{} of ", count(rows.len())) };
    ui.weak(format!("{shown}{} events", count(state.len())));
    let film = state.film();
    let lost = film.map_or(0, |f| f.reel.lost());
    if lost > 0 {
        ui.colored_label(
            ui.visuals().warn_fg_color,
            format!("Capped: {} later events were not kept.", count(lost as usize)),
        );
    }
    let height = ui.spacing().interact_size.y;
    let spacing = ui.spacing().item_spacing.y;
    let mut area = ScrollArea::vertical().auto_shrink(false).id_salt("events");
    // Bring the current row into sight when the step has changed.
    let here = (state.step, film.map_or(0, |f| f.serial), rows.len());
    if scroll.shown != Some(here) {
        scroll.shown = Some(here);
        let row = state.current().and_then(|at| state.outline.row_of(at)).unwrap_or(0);
        let (top, room) = (row as f32 * (height + spacing), ui.available_height());
        let seen = scroll.offset;
        if top < seen + height || top > seen + room - 2.0 * height {
            area = area.vertical_scroll_offset((top - room * 0.4).max(0.0));
        }
    }
    let output = area.show_rows(ui, height, rows.len(), |ui, range| {
        ui.set_min_width(ui.available_width());
        for row in range {
            if let (Some(stage), Some(film)) = (state.staged(), film) {
                line(state, stage.scene(), film, rows[row] as usize, ui, answers);
            }
        }
    });
    scroll.offset = output.state.clamped_offset().y;
}

fn search(state: &State, scroll: &mut Scroll, ui: &mut egui::Ui, answers: &mut Answers) {
    let mut text = state.filter.clone();
    ui.horizontal(|ui| {
        let room = ui.available_width() - if text.is_empty() { 0.0 } else { 30.0 };
        let edit = TextEdit::singleline(&mut text)
            .hint_text(
                "Filter: kind:node verdict:outside \
            under:12",
            )
            .desired_width(room);
        let response = ui.add(edit).on_hover_text(
            "Words that must hold, or must not after a “-”:\nkind:node  verdict:outside  node:5  prim:7  \
             under:12  under:door  \
             under:\"garage door\"  object:3  line:visible:3  depth>4",
        );
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Filter events"));
        if std::mem::take(&mut scroll.focus_filter) {
            response.request_focus();
        }
        if response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
            // Enter goes to the next row that passes.
            let rows = state.outline.rows();
            let next = rows.partition_point(|&r| (r as usize) < state.step);
            if let Some(&row) = rows.get(next).or_else(|| rows.first()) {
                answers.push(Command::GoTo(row as usize + 1));
            }
            response.request_focus();
        }
        if !text.is_empty() && ui.button("×").on_hover_text("Clear the filter").clicked() {
            text.clear();
        }
    });
    if text != state.filter {
        answers.push(Command::Filter(text));
    }
}

fn line(
    state: &State,
    scene: &dyn SceneFacts,
    film: Reading<'_>,
    at: usize,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let event = film.reel.events()[at];
    let depth = film.moves.depth(at).min(MAX_LEVELS);
    let is_current = state.current() == Some(at);
    let subject = film.reel.subject(at);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.add_space(depth as f32 * INDENT);
        let folds = matches!(event, Event::Entered(_));
        if folds {
            let is_folded = state.outline.is_folded(at as u32);
            let icon = if is_folded { Icon::Folded } else { Icon::Unfolded };
            let response = icons::plain(ui, icon, Sense::click(), ui.visuals().weak_text_color());
            let name =
                format!("{} {}", if is_folded { "Unfold" } else { "Fold" }, label(scene, film.reel, at));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            if response.clicked() {
                answers.push(Command::Fold(at as u32));
            }
        } else {
            ui.add_space(17.0);
        }
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Truncate);
        match event.verdict() {
            Some(verdict) => verdict_mark(state, ui, verdict),
            None => ui.add_space(0.0),
        }
        let future = at >= state.step;
        let mut text = RichText::new(label(scene, film.reel, at));
        if future {
            text = text.weak();
        }
        if is_current {
            text = text.strong().background_color(super::palette::panel(state).lit_line);
        }
        let selected = subject != Subject::None && subject == state.selection;
        let response = ui.selectable_label(selected, text);
        if response.clicked() {
            answers.push(Command::GoTo(at + 1));
            if subject != Subject::None {
                answers.push(Command::Select(subject));
            }
        }
        if is_current && state.is_playing {
            response.scroll_to_me(Some(Align::Center));
        }
    });
}

/// One line for an event.
fn label(scene: &dyn SceneFacts, reel: &dyn Reel, at: usize) -> String {
    let event = reel.events()[at];
    let kind = spaced(reel.kind(at));
    match event {
        Event::Line(i) => reel.card().code[i as usize].text.trim().to_owned(),
        Event::DecidedNode(n, v) => format!("node {n}: {}", v.name()),
        Event::DecidedPrim(p, v) => format!("{} {p}: {}", scene.prim_name(), v.name()),
        Event::Entered(n) => format!("node {n}"),
        Event::Left(n) => format!("end of node {n}"),
        _ => match reel.subject(at) {
            Subject::Node(n) => format!("{kind}, node {n}"),
            Subject::Prim(p) => format!("{kind}, {} {p}", scene.prim_name()),
            _ => kind,
        },
    }
}
