//! The explorer's window: panels that read [`State`] and answer in commands.
//!
//! A panel is `fn(&State, &mut Ui, &mut Answers)`: it shows the state and adds the commands that the person
//! gives. What only the screen needs (cached drawings, half-typed text) is kept in `cache::Cache`,
//! and each panel is given its part.

mod cache;
mod canvas;
mod code;
mod dialogs;
mod dock;
mod events;
mod figure;
mod handles;
mod icons;
mod inspector;
mod keys;
mod laboratory;
mod legend;
mod menu;
mod objects;
mod palette;
mod parameters;
mod pictures;
mod pixel;
mod reach;
mod space;
mod status;
mod strip;
mod tables;
mod timeline;
mod welcome;
mod why;
pub mod window;

use eframe::egui;
use glam::Vec2;

use crate::app::{Action, Command, State};
use crate::drawing::{Drawing, Mark};
use crate::figure as paper;

/// The commands that the person gives in a frame.
pub type Answers = Vec<Command>;

/// A button with a sign for an action.
fn icon_button(
    state: &State,
    ui: &mut egui::Ui,
    action: Action,
    icon: icons::Icon,
    answers: &mut Answers,
) -> egui::Response {
    let button = icons::button(ui, icon, state.can(action));
    bound(state, button, action, answers)
}

/// A button for an action with its title (or another text), gray when the action cannot be done.
fn action_button(
    state: &State,
    ui: &mut egui::Ui,
    action: Action,
    text: &str,
    answers: &mut Answers,
) -> egui::Response {
    let button = ui.add_enabled(state.can(action), egui::Button::new(text));
    bound(state, button, action, answers)
}

/// Binds a button to an action: help and key on hover, the title for screen readers, the command on a click.
fn bound(state: &State, button: egui::Response, action: Action, answers: &mut Answers) -> egui::Response {
    let info = action.info();
    let keys = info.keys.first().map_or(String::new(), |k| format!("  ({k})"));
    let button = button.on_hover_text(format!("{}{keys}\n{}", info.title, info.help));
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, state.can(action), info.title));
    if button.clicked() {
        answers.push(action.into());
    }
    button
}

/// Least size of text in pictures, points of egui: that of the panels' small text. Figures have smaller type,
/// but they are read from paper.
const LABEL: f32 = 12.0;

/// Makes the labels of a picture on screen large enough to read, and keeps those of evidence inside it and
/// off what lies below them.
fn readable_labels(paper: &mut Drawing) {
    for item in &mut paper.items {
        if let Mark::Text { size_pt, .. } = &mut item.mark {
            *size_pt = size_pt.max(LABEL);
        }
    }
    let size = paper.size_pt;
    paper::plate_labels(paper, Vec2::ZERO, size);
}
