//! The history of a pixel of the Eye's image, and the menu of the Eye's picture that asks for it.

use eframe::egui::{self, RichText, ScrollArea};

use super::handles::Hand;
use super::legend::verdict_mark;
use super::{Answers, objects};
use crate::app::{AtPixel, Command, Staged, State, object_title, spoken};
use crate::drawing::Subject;
use crate::drawing::words::count;
use crate::geometry::PrimId;

/// Entries that are told, at most.
const MOST: usize = 60;

/// Shows what covers the pixel, front to back.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(stage) = state.staged() else { return };
    place(state, stage, ui, answers);
    ScrollArea::vertical().auto_shrink(false).id_salt("pixel").show(ui, |ui| {
        let Some(said) = state.pixel.said(stage) else {
            ui.weak(
                "Ctrl+click a pixel in the Eye view, or choose it in the menu of the right button: here \
                 stands who draws it, and who was rejected there by which test.",
            );
            return;
        };
        ui.label(said);
        if state.has_stand_ins() {
            ui.weak("What is drawn in place of others is not in this list.");
        }
        ui.add_space(4.0);
        for (i, layer) in state.pixel.layers().iter().take(MOST).enumerate() {
            entry(state, stage, i, layer, ui, answers);
        }
        let more = state.pixel.layers().len().saturating_sub(MOST);
        if more > 0 {
            ui.weak(format!("{} more lie behind these.", count(more)));
        }
    });
}

/// The pixel by its numbers.
fn place(state: &State, stage: &dyn Staged, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some([width, height]) = stage.image_size() else { return };
    let at = state.pixel.at();
    let mut now = at.unwrap_or([width / 2, height / 2]);
    ui.horizontal(|ui| {
        for (axis, (name, size)) in [("column", width), ("row", height)].into_iter().enumerate() {
            ui.weak(name);
            let drag = egui::DragValue::new(&mut now[axis]).range(0..=size.saturating_sub(1));
            let response = ui.add(drag);
            response.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::TextInput, true, format!("Pixel {name}"))
            });
        }
        if at.is_none() && ui.button("Look").on_hover_text("Lists what covers this pixel").clicked() {
            answers.push(Command::Pixel(Some(now)));
        }
    });
    if at.is_some_and(|at| at != now) {
        answers.push(Command::Pixel(Some(now)));
    }
}

fn entry(
    state: &State,
    stage: &dyn Staged,
    i: usize,
    layer: &AtPixel,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let subject = Subject::Prim(layer.prim);
    let decision = layer.decision(stage);
    ui.horizontal_wrapped(|ui| {
        ui.weak(format!("{}.", i + 1));
        if let Some((_, verdict, _)) = &decision {
            verdict_mark(state, ui, *verdict);
        }
        let title = RichText::new(layer.title(stage));
        let title = if state.selection == subject { title.strong() } else { title };
        if ui.link(title).on_hover_text("Select it, and see why").clicked() {
            answers.push(Command::Select(subject));
        }
    });
    ui.horizontal_wrapped(|ui| match decision {
        Some((step, verdict, reason)) => {
            if step == state.step {
                ui.strong(format!("step {}", count(step)));
            } else if ui.link(format!("step {}", count(step))).on_hover_text("Go to the decision").clicked() {
                answers.extend([Command::Select(subject), Command::GoTo(step)]);
            }
            let text = RichText::new(format!("{}. {reason}", spoken(verdict)));
            ui.label(if step > state.step { text.weak() } else { text });
        }
        None => {
            ui.weak("not decided in this film");
        }
    });
    ui.add_space(4.0);
}

/// What the pointer asks of a pixel in the Eye's picture: with Ctrl its history at once, with the right
/// button a menu. `under`: the pixel and what is drawn there.
pub fn interact(
    state: &State,
    hand: &mut Hand,
    ui: &egui::Ui,
    response: &egui::Response,
    under: impl Fn(egui::Pos2) -> Option<([u32; 2], Option<PrimId>)>,
    answers: &mut Answers,
) {
    let at = || response.interact_pointer_pos().and_then(&under);
    if response.clicked() && ui.input(|i| i.modifiers.command) {
        answers.extend(at().map(|(pixel, _)| Command::Pixel(Some(pixel))));
    }
    if response.secondary_clicked() {
        hand.menu_of = at();
    }
    let Some((pixel, prim)) = hand.menu_of else { return };
    response.context_menu(|ui| {
        let [x, y] = pixel;
        if ui.button(format!("History of pixel ({x}, {y})")).clicked() {
            answers.push(Command::Pixel(Some(pixel)));
            ui.close();
        }
        let (Some(prim), Some(stage)) = (prim, state.staged()) else { return };
        let scene = stage.scene();
        if ui.button(format!("Select {} {prim}", scene.prim_name())).clicked() {
            answers.push(Command::Select(Subject::Prim(prim)));
            ui.close();
        }
        let object = scene.object_of(prim);
        objects::object_menu(state, object, &object_title(scene, object), ui, answers);
    });
}
