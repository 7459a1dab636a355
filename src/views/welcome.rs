//! The start screen: examples one click away.

use eframe::egui::{self, RichText};

use super::Answers;
use crate::app::{Action, Command, Example, State, examples};

/// Size of a card, points.
const CARD: egui::Vec2 = egui::vec2(270.0, 132.0);
/// Between cards.
const GAP: f32 = 12.0;

/// Shows the start screen.
pub fn show(state: &State, kept: &mut Option<Vec<Example>>, ui: &mut egui::Ui, answers: &mut Answers) {
    let list = kept.get_or_insert_with(examples);
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            ui.set_max_width(760.0);
            ui.add_space(30.0);
            ui.heading(RichText::new("cullscope").size(34.0));
            ui.label("See how visibility culling decides what is drawn, one step at a time.");
            ui.add_space(16.0);
            if let Some(busy) = state.busy() {
                ui.add(egui::ProgressBar::new(busy.fraction).desired_width(420.0).text(busy.what));
                super::action_button(state, ui, Action::Cancel, "Cancel", answers);
                ui.add_space(12.0);
            }
            super::action_button(state, ui, Action::Open, "Open a scene…", answers);
            ui.weak("or drop a file here: .obj, .gltf, .glb, .pdb, .xyz, flatland .json, a session");
            ui.add_space(12.0);
        });
        let columns = ((ui.available_width() / (CARD.x + GAP)) as usize).clamp(1, 5);
        let margin = (ui.available_width() - columns as f32 * (CARD.x + GAP) + GAP) * 0.5;
        for row in list.chunks(columns) {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 0.0;
                ui.add_space(margin.max(0.0));
                for example in row {
                    card(ui, example, answers);
                    ui.add_space(GAP);
                }
            });
            ui.add_space(GAP);
        }
    });
}

fn card(ui: &mut egui::Ui, example: &Example, answers: &mut Answers) {
    let (rect, _) = ui.allocate_exact_size(CARD, egui::Sense::hover());
    ui.painter().rect_stroke(
        rect,
        4.0,
        ui.visuals().widgets.noninteractive.bg_stroke,
        egui::StrokeKind::Inside,
    );
    let inside =
        egui::UiBuilder::new().max_rect(rect.shrink(8.0)).layout(egui::Layout::top_down(egui::Align::Min));
    // A child of its own leaves the place of the next card to what was allocated above, however little it
    // fills.
    let ui = &mut ui.new_child(inside);
    ui.spacing_mut().item_spacing.y = 4.0;
    let open = ui.button(RichText::new(&example.title).strong()).on_hover_text(&example.source);
    open.widget_info(|| {
        egui::WidgetInfo::labeled(
            egui::Role::Button,
            true,
            format!("Open {} ({})", example.title, example.source),
        )
    });
    if open.clicked() {
        answers.push(Command::Open(example.source.clone()));
    }
    ui.add(egui::Label::new(&example.summary).wrap());
}
