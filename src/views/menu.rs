//! The menus and the bar below them: scene, method, theme.

use eframe::egui;

use super::Answers;
use super::icons::Icon;
use crate::app::{Action, Command, Dialog, LookIn, Menu, SceneFacts, State, Surface, Theme};
use crate::drawing::words::count;

/// Room for the buttons at the right.
const AT_RIGHT: f32 = 178.0;

/// Shows the menus.
pub fn show(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    ui.horizontal_wrapped(|ui| {
        for menu in Menu::ALL {
            ui.menu_button(menu.title(), |ui| {
                egui::ScrollArea::vertical().max_height(ui.ctx().content_rect().height() * 0.85).show(
                    ui,
                    |ui| {
                        for info in Action::ALL.iter().filter(|i| i.menu == menu) {
                            // Ten lines of bookmarks would only be in the way.
                            if (Action::Bookmark1..=Action::Bookmark10).contains(&info.action)
                                && !state.can(info.action)
                            {
                                continue;
                            }
                            let is_on = state.is_on(info.action);
                            let button = egui::Button::selectable(is_on, info.title)
                                .shortcut_text(*info.keys.first().unwrap_or(&""));
                            if ui
                                .add_enabled(state.can(info.action), button)
                                .on_hover_text(info.help)
                                .clicked()
                            {
                                answers.push(info.action.into());
                                ui.close();
                            }
                        }
                    },
                );
            });
        }
        ui.separator();
        if let Some(stage) = state.staged() {
            method(state, ui, answers);
            if matches!(state.stage, Some(crate::geometry::Either::Solid(_))) {
                surface(state, ui, answers);
                look_in(state, ui, answers);
            }
            let boxes = egui::Button::selectable(state.shown.nodes, "Boxes");
            if ui.add(boxes).on_hover_text(Action::ShowNodes.info().help).clicked() {
                answers.push(Action::ShowNodes.into());
            }
            ui.separator();
            scene_link(stage.scene(), ui, answers);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            super::action_button(state, ui, Action::Keys, "?", answers);
            super::action_button(state, ui, Action::Palette, "Commands", answers);
            let next = match state.shown.theme {
                Theme::Light => Action::ThemeDark,
                Theme::Dark => Action::ThemePrint,
                Theme::Print => Action::ThemeLight,
            };
            super::icon_button(state, ui, next, Icon::Theme, answers);
        });
    });
}

/// The scene by name and size; a click tells what was noticed while it was loaded.
fn scene_link(scene: &dyn SceneFacts, ui: &mut egui::Ui, answers: &mut Answers) {
    let report = scene.report();
    let text = format!("{}: {} {}s", scene.name(), count(scene.live_count()), scene.prim_name());
    let has_news = report.dropped_total() > 0 || !report.notes.is_empty();
    let text = if has_news { format!("{text} (!)") } else { text };
    // The buttons at the right come after it and would be painted over its end.
    let font = egui::TextStyle::Body.resolve(ui.style());
    let width = ui.fonts_mut(|f| f.layout_no_wrap(text.clone(), font, egui::Color32::BLACK).size().x);
    let text = if width > ui.available_width() - AT_RIGHT { scene.name().to_owned() } else { text };
    if ui.link(text).on_hover_text("Loading report").clicked() {
        answers.push(Command::Dialog(Dialog::Report));
    }
}

fn method(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let methods = state.staged().map(|s| s.methods()).unwrap_or_default();
    let now = methods.iter().find(|m| m.key == state.method).map_or(state.method.as_str(), |m| m.name);
    let combo = egui::ComboBox::from_id_salt("method").selected_text(now).width(230.0).show_ui(ui, |ui| {
        for card in methods {
            if ui.selectable_label(card.key == state.method, card.name).on_hover_text(card.summary).clicked()
            {
                answers.push(Command::Method(card.key.to_owned()));
            }
        }
    });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Method"));
}

fn look_in(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let now = state.shown.look_in;
    let text = if now == LookIn::Off { "look in…" } else { now.title() };
    let combo = egui::ComboBox::from_id_salt("look in").selected_text(text).width(90.0).show_ui(ui, |ui| {
        for way in LookIn::ALL {
            if ui.selectable_label(way == now, way.title()).clicked() {
                answers.push(Command::LookIn(way));
            }
        }
    });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Look in"));
}

fn surface(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    let combo = egui::ComboBox::from_id_salt("surface")
        .selected_text(state.shown.surface.name())
        .width(90.0)
        .show_ui(ui, |ui| {
            for surface in Surface::ALL {
                if ui.selectable_label(surface == state.shown.surface, surface.name()).clicked() {
                    answers.push(Command::Surface(surface));
                }
            }
        });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Surfaces"));
}
