//! The operands of the current event, the facts of the selected thing, and the nodes that are open.

use eframe::egui::{self, Grid, RichText, ScrollArea};

use super::Answers;
use super::why::subject_name;
use crate::app::{Action, Command, State, value};
use crate::drawing::Subject;
use crate::drawing::words::{capitalized, count, spaced};

/// Shows the inspector.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(stage) = state.staged() else { return };
    ScrollArea::vertical().auto_shrink(false).id_salt("inspector").show(ui, |ui| {
        match state.film().zip(state.current()) {
            Some((film, at)) => {
                let (kind, fields) = film.reel.fields(at);
                ui.strong(format!("Step {}: {}", state.step, spaced(kind)));
                rows(ui, "event", fields.iter().map(|f| (f.name.replace('_', " "), value(&f.value))));
            }
            None => {
                ui.strong("Step 0: before the first event");
            }
        }
        let stack = state.film().map_or(vec![], |f| f.moves.stack(f.reel.events(), state.step));
        if !stack.is_empty() {
            ui.add_space(6.0);
            ui.horizontal_wrapped(|ui| {
                ui.strong("Open nodes");
                for node in stack {
                    let selected = state.selection == Subject::Node(node);
                    if ui
                        .selectable_label(selected, node.to_string())
                        .on_hover_text(format!("Select node {node}"))
                        .clicked()
                    {
                        answers.push(Command::Select(Subject::Node(node)));
                    }
                }
            });
        }
        truth(state, ui, answers);
        bookmarks(state, ui, answers);
        if state.selection != Subject::None {
            ui.add_space(6.0);
            ui.strong(capitalized(&subject_name(state, state.selection)));
            rows(
                ui,
                "subject",
                stage.facts(state.selection).into_iter().map(|(name, text)| (name.to_owned(), text)),
            );
        }
    });
}

/// Missing primitives that are named, at most.
const NAMED: usize = 8;

/// The whole frame beside an image of everything.
fn truth(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(judged) = state.judged() else { return };
    ui.add_space(6.0);
    ui.strong("The frame and the truth").on_hover_text("What the run draws, beside an image of everything");
    rows(ui, "truth", state.judged_rows().into_iter());
    if judged.missed.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.weak("missing:");
        for &prim in judged.missed.iter().take(NAMED) {
            let subject = Subject::Prim(prim);
            let is_selected = state.selection == subject;
            let link = ui.selectable_label(is_selected, subject_name(state, subject));
            if link.on_hover_text("Select it, and see why it was left out").clicked() {
                answers.push(Command::Select(subject));
            }
        }
        if judged.missed.len() > NAMED {
            ui.weak(format!("and {} more", count(judged.missed.len() - NAMED)));
        }
    });
    super::action_button(state, ui, Action::FirstWrong, "First wrong decision", answers);
}

/// Steps to come back to, with notes.
fn bookmarks(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    if state.bookmarks.is_empty() {
        return;
    }
    ui.add_space(6.0);
    ui.strong("Bookmarks");
    for (i, mark) in state.bookmarks.iter().enumerate() {
        ui.horizontal(|ui| {
            if ui.link(format!("{}: step {}", i + 1, mark.step)).clicked() {
                answers.push(Command::Bookmark(i));
            }
            let mut note = mark.note.clone();
            let edit = egui::TextEdit::singleline(&mut note)
                .hint_text("note")
                .desired_width(ui.available_width() - 28.0);
            let response = ui.add(edit);
            response.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::TextInput, true, format!("Note of bookmark {}", i + 1))
            });
            if note != mark.note {
                answers.push(Command::Note(i, note));
            }
            let remove = ui.small_button("×").on_hover_text("Remove this bookmark");
            remove.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Remove bookmark {}", i + 1))
            });
            if remove.clicked() {
                answers.push(Command::Unmark(i));
            }
        });
    }
}

fn rows(ui: &mut egui::Ui, id: &str, rows: impl Iterator<Item = (String, String)>) {
    Grid::new(id).num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for (name, text) in rows {
            ui.weak(name);
            ui.add(egui::Label::new(RichText::new(text).monospace()).wrap());
            ui.end_row();
        }
    });
}
