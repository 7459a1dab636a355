//! The legend, always there, and the small marks of states in lists. A mark is painted by the same
//! painter as the pictures, so it shows hue and pattern alike.

use eframe::egui::{self, Sense, vec2};
use glam::Vec2;

use crate::app::State;
use crate::drawing::words::count;
use crate::drawing::{Drawing, Layer, Mark, Role, Subject};
use crate::figure::role_of;
use crate::geometry::Either;
use crate::method::Verdict;
use crate::render::screen;
use crate::trace::{Counts, State as Known};

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

/// States that the legend names, with their words.
const STATES: [(Role, &str); 9] = [
    (Role::Scene, "not decided"),
    (Role::Partial, "open, partly in view"),
    (Role::Visible, "drawn"),
    (Role::Outside, "outside"),
    (Role::Hidden, "hidden"),
    (Role::Approximated, "left out or replaced"),
    (Role::Occluder, "active occluder"),
    (Role::Current, "this step"),
    (Role::Selected, "selected"),
];

/// The legend in one wrapping line: the states that this film has, then the marks of the moment.
pub fn show(state: &State, ui: &mut egui::Ui) {
    let Some(stage) = state.staged() else { return };
    let counts = |step| state.film().map_or(Counts::default(), |f| f.stamps.counts(step));
    let (end, here) = (counts(state.len()), counts(state.step));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let shown = stage.evidence_roles(state.step);
        for (role, words) in STATES {
            if role == Role::Occluder && !shown.contains(&role) {
                continue;
            }
            let verdicts: Vec<Verdict> = Counts::VERDICTS
                .into_iter()
                .filter(|&v| v != Verdict::Partial && role_of(Known::Decided(v)) == role)
                .collect();
            let total: usize = verdicts.iter().map(|&v| end.of(v)).sum();
            // A state that never occurs here would only be noise.
            if !verdicts.is_empty() && total == 0 && !matches!(role, Role::Visible | Role::Outside) {
                continue;
            }
            let now: usize = verdicts.iter().map(|&v| here.of(v)).sum();
            let text = match role {
                Role::Scene => format!("{words} {}", count(here.undecided)),
                _ if verdicts.is_empty() => words.to_owned(),
                _ => format!("{words} {}", count(now)),
            };
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                mark(state, ui, role);
                ui.label(text);
            });
            ui.add_space(6.0);
        }
        let unit = if matches!(state.stage, Some(Either::Flat(_))) { "segments" } else { "triangles" };
        ui.weak(format!("(counts in {unit})"));
    });
}
