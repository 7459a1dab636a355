//! The legend, always there, and the small marks of states in lists. A mark is painted by the same
//! painter as the pictures, so it shows hue and pattern alike.

use eframe::egui::{self, Sense, vec2};
use glam::Vec2;

use super::Answers;
use crate::app::{Action, State};
use crate::drawing::{Drawing, Layer, Mark, Role, Subject};
use crate::figure::role_of;
use crate::geometry::Either;
use crate::method::Verdict;
use crate::render::screen;
use crate::trace::State as Known;

/// Size of a mark.
const MARK: egui::Vec2 = vec2(18.0, 12.0);

/// A small sample of a role.
pub fn mark(state: &State, ui: &mut egui::Ui, role: Role) {
    let (rect, _) = ui.allocate_exact_size(MARK, Sense::hover());
    let mut sample = Drawing::<Vec2> { size_pt: Vec2::new(MARK.x, MARK.y), ..Default::default() };
    let (a, b) = (Vec2::new(2.0, 2.0), Vec2::new(MARK.x - 2.0, MARK.y - 2.0));
    let corners = vec![a, Vec2::new(b.x, a.y), b, Vec2::new(a.x, b.y)];
    sample.push(Layer::Legend, role, Subject::None, Mark::Area(corners));
    screen::paint(ui.painter(), &sample, state.shown.theme, rect.min, 1.0);
}

/// A small sample of a verdict.
pub fn verdict_mark(state: &State, ui: &mut egui::Ui, verdict: Verdict) {
    mark(state, ui, role_of(Known::Decided(verdict)));
}

/// The legend in one wrapping line: the states that this film has, then the marks of the moment.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (role, text) in state.legend() {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                mark(state, ui, role);
                ui.label(text);
            });
            ui.add_space(6.0);
        }
        let unit = if matches!(state.stage, Some(Either::Flat(_))) { "segments" } else { "triangles" };
        ui.weak(format!("(counts in {unit})"));
        if state.unshown_words().is_some() && ui.link("Show all objects").clicked() {
            answers.push(Action::ShowObjects.into());
        }
    });
}
