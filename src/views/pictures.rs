//! The method's own pictures: what it keeps that is not in the world, at the step.

use eframe::egui::{self, ComboBox, ScrollArea, Sense};
use glam::vec2;

use super::Answers;
use crate::app::{Command, State};
use crate::drawing::Drawing;
use crate::raster::DepthScale;
use crate::render::screen;

/// The picture that is shown.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// Film, step, picture and scale that it was drawn for.
    drawn: Option<((u64, usize, usize, DepthScale), Drawing)>,
}

/// Shows a picture, with what it is and how its depths are shaded.
pub fn show(state: &State, shown: &mut Shown, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(film) = state.film().filter(|f| !f.reel.pictures().is_empty()) else {
        ui.label("This method has no pictures of its own.");
        ui.weak(
            "Methods that keep an image, such as hierarchical-z with its pyramid of depths, show it here.",
        );
        return;
    };
    let names = film.reel.pictures();
    let mut which = state.own_picture.min(names.len() - 1);
    ui.horizontal_wrapped(|ui| {
        if ComboBox::from_id_salt("picture").show_index(ui, &mut which, names.len(), |i| names[i]).changed() {
            answers.push(Command::Picture(names[which].to_owned()));
        }
        let mut scale = DepthScale::ALL.iter().position(|s| *s == state.depths).unwrap_or(0);
        let depths = |i: usize| format!("depths {}", DepthScale::ALL[i].name());
        let combo = ComboBox::from_id_salt("depths");
        if combo.show_index(ui, &mut scale, DepthScale::ALL.len(), depths).changed() {
            answers.push(Command::Depths(DepthScale::ALL[scale]));
        }
    });
    let key = (film.serial, state.step, which, state.depths);
    if shown.drawn.as_ref().is_none_or(|(k, _)| *k != key) {
        shown.drawn = Some((key, film.reel.picture(state.step, which, state.depths)));
    }
    let Some((_, drawing)) = &shown.drawn else { return };
    ScrollArea::vertical().auto_shrink(false).id_salt("pictures").show(ui, |ui| {
        let scale = (ui.available_width() / drawing.size_pt.x.max(1.0)).clamp(0.3, 4.0);
        let size = egui::vec2(drawing.size_pt.x, drawing.size_pt.y) * scale;
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(
                egui::Role::Image,
                true,
                format!("{}. {}", drawing.title, state.sentence()),
            )
        });
        screen::paint(&ui.painter_at(rect), drawing, state.shown.theme, rect.min, scale);
        if let Some(at) = response.hover_pos() {
            let at = vec2(at.x - rect.min.x, at.y - rect.min.y) / scale;
            if let Some(text) = film.reel.probe(state.step, which, at) {
                response.on_hover_text_at_pointer(text);
            }
        }
    });
}
