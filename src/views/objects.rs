//! The objects of the scene: search, sort, select, hide. Only rows in sight are made, so that ten thousand
//! are as quick as ten.

use eframe::egui::{self, Align, Layout, RichText, ScrollArea, TextEdit};

use super::Answers;
use super::legend::verdict_mark;
use crate::app::{Action, By, Command, Listing, ObjectRow, SceneFacts, State, listed, object_title, objects};
use crate::drawing::words::count;
use crate::drawing::{Role, Subject};

/// The rows, and what they were made for.
#[derive(Debug, Default)]
pub struct Kept {
    rows: Vec<ObjectRow>,
    of: Option<(u64, usize)>,
    order: Vec<u32>,
    listing: Option<Listing>,
}

impl Kept {
    fn refresh(&mut self, state: &State) {
        let (Some(stage), Some(film)) = (state.staged(), state.film()) else {
            *self = Self::default();
            return;
        };
        let of = Some((film.serial, state.step));
        let is_new = self.of != of;
        if is_new {
            (self.rows, self.of) = (objects(stage, state.step), of);
        }
        if is_new || self.listing.as_ref() != Some(&state.listing) {
            self.order = listed(&self.rows, stage.scene(), &state.listing);
            self.listing = Some(state.listing.clone());
        }
    }
}

/// Shows the list.
pub fn show(state: &State, kept: &mut Kept, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(stage) = state.staged() else { return };
    kept.refresh(state);
    head(state, ui, answers);
    let (all, unshown) = (kept.rows.len(), state.unshown());
    let of = if kept.order.len() == all { String::new() } else { format!("{} of ", count(kept.order.len())) };
    ui.horizontal_wrapped(|ui| {
        ui.weak(format!("{of}{} objects", count(all)));
        if !unshown.is_empty() && ui.link("Show all").on_hover_text("Shows every object again").clicked() {
            answers.push(Action::ShowObjects.into());
        }
    });
    let height = ui.spacing().interact_size.y;
    ScrollArea::vertical().auto_shrink(false).id_salt("objects").show_rows(
        ui,
        height,
        kept.order.len(),
        |ui, range| {
            ui.set_min_width(ui.available_width());
            for &row in &kept.order[range] {
                let row = &kept.rows[row as usize];
                line(state, stage.scene(), row, !unshown.contains(&row.id), ui, answers);
            }
        },
    );
}

/// Search and order.
fn head(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let mut listing = state.listing.clone();
    let edit = TextEdit::singleline(&mut listing.text).hint_text("Search objects");
    let response = ui.add(edit.desired_width(ui.available_width()));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search objects"));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.weak("by");
        for by in By::ALL {
            let is_it = listing.by == by;
            let sign = match (is_it, listing.is_reversed) {
                (false, _) => "",
                (true, false) => " ↓",
                (true, true) => " ↑",
            };
            let label = ui.selectable_label(is_it, format!("{}{sign}", by.title()));
            if label.on_hover_text("Sorts by it; again to turn the order around").clicked() {
                listing.is_reversed = is_it && !listing.is_reversed;
                listing.by = by;
            }
        }
    });
    if listing != state.listing {
        answers.push(Command::List(listing));
    }
}

fn line(
    state: &State,
    scene: &dyn SceneFacts,
    row: &ObjectRow,
    is_shown: bool,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let (name, (standing, verdict)) = (object_title(scene, row.id), row.state());
    let counts = format!("{} of {}", count(row.drawn), count(row.prims));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let mut shown = is_shown;
        let tick = ui.checkbox(&mut shown, "").on_hover_text("Whether it is shown; it is culled as before");
        tick.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_shown, format!("Show {name}"))
        });
        if shown != is_shown {
            answers.push(Command::FlipShown(row.id));
        }
        match verdict {
            Some(verdict) => verdict_mark(state, ui, verdict),
            None => super::legend::mark(state, ui, Role::Scene),
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // Beside the bar by which the list is scrolled.
            ui.add_space(6.0);
            ui.label(RichText::new(&counts).weak())
                .on_hover_text(format!("{counts} {}s drawn", scene.prim_name()));
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Truncate);
                let subject = Subject::Object(row.id);
                let text = RichText::new(&name);
                let text = if is_shown { text } else { text.weak() };
                let response = ui.selectable_label(state.selection == subject, text);
                response.widget_info(|| {
                    let label = format!("{name}: {standing}, {counts} drawn");
                    egui::WidgetInfo::labeled(egui::Role::Button, true, label)
                });
                let response = response.on_hover_text(format!("{name}: {standing}, {counts} drawn"));
                if response.clicked() {
                    answers.push(Command::Select(subject));
                }
                if response.double_clicked() {
                    answers.push(Action::FrameSelection.into());
                }
                response.context_menu(|ui| object_menu(state, row.id, &name, ui, answers));
            });
        });
    });
}

/// What can be done about an object, in a menu.
pub fn object_menu(
    state: &State,
    object: crate::geometry::ObjectId,
    name: &str,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let select = || Command::Select(Subject::Object(object));
    let is_shown = !state.unshown().contains(&object);
    let actions = [
        (format!("Select {name}"), vec![select()]),
        (format!("Frame {name}"), vec![select(), Action::FrameSelection.into()]),
        (format!("{} {name}", if is_shown { "Hide" } else { "Show" }), vec![Command::FlipShown(object)]),
        (format!("Show only {name}"), vec![select(), Action::IsolateObject.into()]),
        ("Show all objects".to_owned(), vec![Action::ShowObjects.into()]),
    ];
    for (text, commands) in actions {
        if ui.button(text).clicked() {
            answers.extend(commands);
            ui.close();
        }
    }
}
