//! The method's own pictures: what it keeps that is not in the world, at the step.

use eframe::egui::{self, ComboBox, ScrollArea, Sense};
use glam::vec2;

use crate::app::State;
use crate::drawing::Drawing;
use crate::raster::DepthScale;
use crate::render::screen;

/// Which picture is shown, and the picture itself.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    which: usize,
    scale: DepthScale,
    /// Film, step, picture and scale that it was drawn for.
    drawn: Option<((u64, usize, usize, DepthScale), Drawing)>,
}

/// Shows a picture, with what it is and how its depths are shaded.
pub fn show(state: &State, shown: &mut Shown, ui: &mut egui::Ui) {
    let Some(film) = state.film().filter(|f| !f.reel.pictures().is_empty()) else {
        ui.label("This method has no pictures of its own.");
        ui.weak(
            "Methods that keep an image, such as hierarchical-z with its pyramid of depths, show it here.",
        );
        return;
    };
    let names = film.reel.pictures();
    shown.which = shown.which.min(names.len() - 1);
    ui.horizontal_wrapped(|ui| {
        ComboBox::from_id_salt("picture").show_index(ui, &mut shown.which, names.len(), |i| names[i]);
        let mut scale = DepthScale::ALL.iter().position(|s| *s == shown.scale).unwrap_or(0);
        let depths = |i: usize| format!("depths {}", DepthScale::ALL[i].name());
        ComboBox::from_id_salt("depths").show_index(ui, &mut scale, DepthScale::ALL.len(), depths);
        shown.scale = DepthScale::ALL[scale];
    });
    let key = (film.serial, state.step, shown.which, shown.scale);
    if shown.drawn.as_ref().is_none_or(|(k, _)| *k != key) {
        shown.drawn = Some((key, film.reel.picture(state.step, shown.which, shown.scale)));
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
            if let Some(text) = film.reel.probe(state.step, shown.which, at) {
                response.on_hover_text_at_pointer(text);
            }
        }
    });
}
