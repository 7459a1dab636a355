//! The line below everything: what happened last in one sentence (announced to screen readers), work that
//! is waited for, messages; above it the legend.

use eframe::egui::{self, RichText};

use super::{Answers, legend};
use crate::app::{Action, Command, Layout, State};
use crate::drawing::Subject;

/// Shows the status and the legend.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    notices(state, ui, answers);
    if state.staged().is_none() {
        return;
    }
    legend::show(state, ui, answers);
    ui.separator();
    ui.horizontal(|ui| {
        if let Some(busy) = state.busy() {
            ui.add(egui::ProgressBar::new(busy.fraction).desired_width(120.0).text(busy.what));
            super::action_button(state, ui, Action::Cancel, "Cancel", answers);
        }
        let step = format!("Step {} of {}.", state.step, state.len());
        if state.shown.layout == Layout::Lecture {
            // The sentence stands in the caption, in large type.
            ui.label(step);
        } else {
            let layer = state.layer_sentence().unwrap_or_default();
            let text = format!("{step} {layer} {} {}", state.sentence(), marked(state));
            announced(ui, egui::Label::new(text).truncate());
        }
    });
}

/// What the pictures mark at this step, or that there is nothing to mark.
fn marked(state: &State) -> String {
    match state.current_subject() {
        _ if state.current().is_none() => String::new(),
        Subject::None => "(About no node or primitive: nothing is marked.)".into(),
        subject => format!("(Marked: {}.)", super::why::subject_name(state, subject)),
    }
}

/// A label that screen readers read out when it changes.
fn announced(ui: &mut egui::Ui, label: egui::Label) {
    let response = ui.add(label);
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_live(egui::accesskit::Live::Polite));
}

fn notices(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    for (i, notice) in state.notices.iter().enumerate() {
        ui.horizontal(|ui| {
            if ui.small_button("×").on_hover_text("Remove this message").clicked() {
                answers.push(Command::Dismiss(i));
            }
            let color = if notice.is_error { ui.visuals().error_fg_color } else { ui.visuals().text_color() };
            let head = if notice.is_error { "Error: " } else { "" };
            ui.add(egui::Label::new(RichText::new(format!("{head}{}", notice.text)).color(color)).wrap());
        });
    }
}

/// The caption of the lecture: the step's sentence in large type.
pub fn caption(state: &State, ui: &mut egui::Ui) {
    let size = egui::TextStyle::Heading.resolve(ui.style()).size;
    announced(ui, egui::Label::new(RichText::new(state.sentence()).size(size)).wrap());
    ui.weak(marked(state));
    if let Some(layer) = state.layer_sentence() {
        ui.label(layer);
    }
    let note =
        state.bookmarks.iter().find(|b| b.step == state.step).map(|b| b.note.as_str()).unwrap_or_default();
    if !note.is_empty() {
        ui.weak(note);
    }
}
