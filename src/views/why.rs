//! Why the selected thing has the state it has, in sentences, each with the step that shows it.

use eframe::egui::{self, RichText, ScrollArea};

use super::Answers;
use crate::app::{Action, Because, Command, Filter, State};
use crate::drawing::Subject;
use crate::drawing::words::{capitalized, count};

/// A thing by its name.
pub fn subject_name(state: &State, subject: Subject) -> String {
    let Some(stage) = state.staged() else { return "nothing".into() };
    match subject {
        Subject::Prim(p) => format!("{} {p}", stage.scene().prim_name()),
        Subject::Node(n) => format!("node {n}"),
        Subject::Object(o) => format!("object {}", stage.scene().object_name(o)),
        Subject::Plane(i) => format!("plane {i} of the frustum"),
        Subject::Eye => "the Eye".into(),
        Subject::Tried(n) => format!("configuration {n}"),
        Subject::None => "nothing".into(),
    }
}

/// Shows the explanation.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(stage) = state.staged() else { return };
    if state.selection != Subject::None {
        let ground = egui::Frame::NONE.inner_margin(egui::Margin { top: 4, ..egui::Margin::ZERO });
        egui::Panel::bottom("why-actions").frame(ground).show(ui, |ui| actions(state, ui, answers));
    }
    ScrollArea::vertical().auto_shrink(false).id_salt("why").show(ui, |ui| {
        if state.selection == Subject::None {
            ui.label("Nothing is selected.");
            ui.weak(
                "Click a node or a primitive in a picture or in the event tree: here stands why it is \
                     drawn or not.",
            );
            let current = state.current_subject();
            if current != Subject::None
                && ui.button(format!("Select {}", subject_name(state, current))).clicked()
            {
                answers.push(Command::Select(current));
            }
            return;
        }
        ui.horizontal_wrapped(|ui| {
            ui.strong(capitalized(&subject_name(state, state.selection)));
            if let Subject::Prim(p) = state.selection {
                let object = stage.scene().object_of(p);
                let name = stage.scene().object_name(object);
                if !name.is_empty() && ui.link(name).on_hover_text("Select the object").clicked() {
                    answers.push(Command::Select(Subject::Object(object)));
                }
            }
        });
        if let Some(known) = state.why.standing(stage, state.step) {
            ui.label(known.text);
            ui.add_space(4.0);
        }
        for because in state.why.reasons() {
            reason(state, because, ui, answers);
        }
    });
}

/// What can be done about the selected thing; it stays in sight while the reasons are scrolled.
fn actions(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    ui.horizontal_wrapped(|ui| {
        super::action_button(state, ui, Action::PreviousOnSelected, "‹", answers);
        super::action_button(state, ui, Action::NextOnSelected, "›", answers);
        if matches!(state.selection, Subject::Node(_) | Subject::Prim(_)) {
            super::action_button(state, ui, Action::SelectParent, "Above", answers);
        }
        if let Some(filter) = Filter::about(state.selection) {
            super::action_button(state, ui, Action::Breakpoint, "Break", answers);
            let button = ui.button("Filter").on_hover_text("List only what happens to it");
            if button.clicked() {
                answers.push(Command::Filter(filter));
            }
        }
    });
}

/// A sentence of the explanation with its links: the present step is lit, what comes later is faint.
fn reason(state: &State, because: &Because, ui: &mut egui::Ui, answers: &mut Answers) {
    let is_here = because.step == Some(state.step);
    let mut text = RichText::new(&because.text);
    if is_here {
        text = text.background_color(super::palette::panel(state).lit_line);
    } else if because.step.is_some_and(|s| s > state.step) {
        text = text.weak();
    }
    ui.label(text);
    if because.step.is_some() || !because.by.is_empty() {
        ui.horizontal_wrapped(|ui| {
            match because.step {
                Some(_) if is_here => {
                    ui.weak("This is the present step.");
                }
                Some(step) if ui.link(format!("Go to step {}", count(step))).clicked() => {
                    answers.push(Command::GoTo(step));
                }
                _ => {}
            }
            for (subject, name) in &because.by {
                if ui.link(format!("Select {name}")).on_hover_text("What hides it").clicked() {
                    answers.push(Command::Select(*subject));
                }
            }
        });
    }
    ui.add_space(4.0);
}
