//! What stands in front of everything else: palette, keys, go to step, open, save, report, about.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

use eframe::egui::{self, Grid, Key, Modal, RichText, ScrollArea, TextEdit};

use super::Answers;
use crate::app::{Action, Command, Dialog, Menu, State, fuzzy};
use crate::drawing::words::count;
use crate::geometry::{Flat, Solid};

/// What is typed and chosen in the open dialog.
#[derive(Default)]
pub struct Typing {
    /// Which dialog it is for.
    dialog: Dialog,
    text: String,
    /// Chosen row of the palette.
    row: usize,
    /// Wrong pixels that advice may have, per cent.
    most_wrong: f32,
    /// What is chosen for a figure.
    figure: super::figure::Choice,
    /// The system's dialog.
    pub chooser: Chooser,
}

/// The system's dialog to choose a scene, on a thread of its own, so that the window goes on.
#[derive(Default)]
pub struct Chooser(Option<Receiver<Option<String>>>);

impl Chooser {
    fn is_open(&self) -> bool {
        self.0.is_some()
    }
    fn open(&mut self) {
        let (send, receive) = channel();
        self.0 = Some(receive);
        std::thread::spawn(move || {
            let dialog = rfd::FileDialog::new()
                .set_title("Open a scene")
                .add_filter("Scenes", &["obj", "gltf", "glb", "pdb", "xyz", "json"]);
            let _ = send.send(dialog.pick_file().map(|p| p.to_string_lossy().into_owned()));
        });
    }
    /// The path that was chosen (`Some(None)` if none was), once; `None` while nothing is answered.
    pub fn answer(&mut self) -> Option<Option<String>> {
        let answer = match self.0.as_ref()?.try_recv() {
            Ok(path) => path,
            Err(TryRecvError::Empty) => return None,
            // The thread is gone without an answer.
            Err(TryRecvError::Disconnected) => None,
        };
        self.0 = None;
        Some(answer)
    }
}

/// Shows the open dialog, if there is one. `aspect` is that of the Observer's window.
pub fn show(state: &State, typing: &mut Typing, aspect: f32, ctx: &egui::Context, answers: &mut Answers) {
    if state.dialog == Dialog::None {
        typing.dialog = Dialog::None;
        return;
    }
    let is_new = typing.dialog != state.dialog;
    if is_new {
        typing.dialog = state.dialog;
        typing.row = 0;
        typing.text = match state.dialog {
            Dialog::GoTo => state.step.to_string(),
            Dialog::SaveAs => state.session_path.clone().unwrap_or_else(|| default_name(state)),
            _ => String::new(),
        };
    }
    let response = Modal::new(egui::Id::unique("dialog")).show(ctx, |ui| {
        ui.set_max_height(ctx.content_rect().height() * 0.8);
        match state.dialog {
            Dialog::Palette => palette(state, typing, ui, is_new, answers),
            Dialog::Keys => keys(ui),
            Dialog::GoTo => go_to(state, typing, ui, is_new, answers),
            Dialog::Open => open(typing, ui, is_new, answers),
            Dialog::SaveAs => save(typing, ui, is_new, answers),
            Dialog::Figure => super::figure::show(state, &mut typing.figure, aspect, ui, answers),
            Dialog::Report => report(state, ui),
            Dialog::About => about(state, ui),
            Dialog::Tables => super::tables::show(state, ui, answers),
            Dialog::Failures => failures(ui, answers),
            Dialog::Laboratory => super::laboratory::show(state, &mut typing.most_wrong, ui, answers),
            Dialog::None => {}
        }
        let has_own = matches!(
            state.dialog,
            Dialog::None | Dialog::Palette | Dialog::GoTo | Dialog::Open | Dialog::SaveAs | Dialog::Figure
        );
        if !has_own && ui.button("Close").clicked() {
            answers.push(Command::Dialog(Dialog::None));
        }
    });
    if response.should_close() {
        answers.push(Command::Dialog(Dialog::None));
    }
}

fn default_name(state: &State) -> String {
    format!("{}.session.json", state.staged().map_or("untitled", |s| s.scene().name()))
}

fn field(ui: &mut egui::Ui, text: &mut String, label: &str, hint: &str, focus: bool) -> egui::Response {
    let response = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(420.0));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, label));
    if focus {
        response.request_focus();
    }
    response
}

fn entered(ui: &egui::Ui, response: &egui::Response) -> bool {
    response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter))
}

fn palette(state: &State, typing: &mut Typing, ui: &mut egui::Ui, is_new: bool, answers: &mut Answers) {
    let (up, down) = ui.input_mut(|i| {
        (
            i.consume_key(egui::Modifiers::NONE, Key::ArrowUp),
            i.consume_key(egui::Modifiers::NONE, Key::ArrowDown),
        )
    });
    let response = field(ui, &mut typing.text, "Command", "Type a command", is_new);
    let mut found: Vec<_> =
        Action::ALL.iter().filter_map(|i| Some((fuzzy(&typing.text, i.title)?, i))).collect();
    if !typing.text.is_empty() {
        found.sort_by_key(|(score, i)| (std::cmp::Reverse(*score), i.action));
    }
    if response.changed() {
        typing.row = 0;
    }
    typing.row =
        (typing.row + usize::from(down)).saturating_sub(usize::from(up)).min(found.len().saturating_sub(1));
    let mut chosen = None;
    ScrollArea::vertical().max_height(360.0).auto_shrink(false).show(ui, |ui| {
        ui.set_width(420.0);
        for (row, (_, info)) in found.iter().enumerate() {
            let keys = info.keys.first().copied().unwrap_or_default();
            let button = egui::Button::selectable(row == typing.row, info.title)
                .shortcut_text(keys)
                .min_size(egui::vec2(410.0, 0.0));
            let response = ui.add_enabled(state.can(info.action), button).on_hover_text(info.help);
            if row == typing.row && (up || down) {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                chosen = Some(info.action);
            }
        }
    });
    if entered(ui, &response) {
        chosen = found.get(typing.row).map(|(_, i)| i.action);
    }
    if let Some(action) = chosen {
        answers.push(Command::Dialog(Dialog::None));
        answers.push(action.into());
    }
}

fn keys(ui: &mut egui::Ui) {
    ui.heading("Keys");
    ScrollArea::vertical().max_height(ui.ctx().content_rect().height() * 0.66).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            for menus in [&[Menu::Step][..], &[Menu::File, Menu::Edit], &[Menu::View, Menu::Help]] {
                ui.vertical(|ui| {
                    for menu in menus {
                        ui.strong(menu.title());
                        Grid::new(menu.title()).num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
                            let bookmark = |a| (Action::Bookmark2..=Action::Bookmark10).contains(&a);
                            for info in Action::ALL
                                .iter()
                                .filter(|i| i.menu == *menu && !i.keys.is_empty() && !bookmark(i.action))
                            {
                                ui.label(RichText::new(info.keys.join("  ")).monospace());
                                ui.label(info.title).on_hover_text(info.help);
                                ui.end_row();
                            }
                        });
                        ui.add_space(6.0);
                    }
                });
                ui.add_space(14.0);
            }
        });
        ui.weak(
            "In the Eye view of space: W A S D and Q E fly, Shift faster, Ctrl slower, dragging looks \
                 around.",
        );
        ui.weak(
            "In the Observer view: drag to turn, Shift+drag or right drag to pan, wheel to zoom, \
                 Alt+drag to roll.",
        );
    });
}

fn go_to(state: &State, typing: &mut Typing, ui: &mut egui::Ui, is_new: bool, answers: &mut Answers) {
    ui.heading("Go to step");
    ui.label(format!("0 to {}; a share such as 50% works too.", count(state.len())));
    let response = field(ui, &mut typing.text, "Step number", "", is_new);
    let typed = typing.text.trim();
    let step = match typed.strip_suffix('%') {
        Some(share) => share
            .trim()
            .parse::<f64>()
            .ok()
            .map(|p| (p / 100.0 * state.len() as f64).round().max(0.0) as usize),
        None => typed.parse().ok(),
    };
    let enter = entered(ui, &response);
    let button = ui.add_enabled(step.is_some(), egui::Button::new("Go"));
    if let Some(step) = step.filter(|_| enter || button.clicked()) {
        answers.extend([Command::GoTo(step), Command::Dialog(Dialog::None)]);
    } else if enter {
        response.request_focus();
    }
}

fn open(typing: &mut Typing, ui: &mut egui::Ui, is_new: bool, answers: &mut Answers) {
    ui.heading("Open a scene");
    ui.label(
        "A path to .obj, .gltf, .glb, .pdb, .xyz, a flatland .json or a session file, or generate:NAME.",
    );
    let response = field(ui, &mut typing.text, "Path of the scene", "scenes2d/street.json", is_new);
    let enter = entered(ui, &response);
    ui.horizontal(|ui| {
        let typed = typing.text.trim().to_owned();
        if (ui.add_enabled(!typed.is_empty(), egui::Button::new("Open")).clicked() || enter)
            && !typed.is_empty()
        {
            answers.push(Command::Open(typed));
        }
        if ui
            .add_enabled(!typing.chooser.is_open(), egui::Button::new("Browse…"))
            .on_hover_text("The system's dialog, where there is one")
            .clicked()
        {
            typing.chooser.open();
        }
        if ui.button("Close").clicked() {
            answers.push(Command::Dialog(Dialog::None));
        }
    });
}

fn save(typing: &mut Typing, ui: &mut egui::Ui, is_new: bool, answers: &mut Answers) {
    ui.heading("Save the session");
    let response = field(ui, &mut typing.text, "Path of the session", "NAME.session.json", is_new);
    let enter = entered(ui, &response);
    ui.horizontal(|ui| {
        let typed = typing.text.trim().to_owned();
        if (ui.add_enabled(!typed.is_empty(), egui::Button::new("Save")).clicked() || enter)
            && !typed.is_empty()
        {
            answers.push(Command::SaveTo(typed));
        }
        if ui.button("Close").clicked() {
            answers.push(Command::Dialog(Dialog::None));
        }
    });
}

fn report(state: &State, ui: &mut egui::Ui) {
    let Some(scene) = state.staged().map(|s| s.scene()) else { return };
    let report = scene.report();
    ui.heading("Loading report");
    ui.label(format!("{} from {}", scene.name(), scene.source()));
    ui.label(format!(
        "{} {}s in {} objects",
        count(scene.live_count()),
        scene.prim_name(),
        count(scene.object_count())
    ));
    let (moving, frames) = scene.motions();
    if moving > 0 {
        ui.label(format!("{} of them move, in {} frames", count(moving), count(frames)));
    }
    if report.dropped.is_empty() {
        ui.label("Nothing was dropped.");
    }
    for (why, dropped) in &report.dropped {
        ui.label(format!("{} dropped: {}", count(*dropped), why.label()));
    }
    ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
        for note in &report.notes {
            ui.add(egui::Label::new(note).wrap());
        }
        if report.unsaid > 0 {
            ui.weak(format!("… and {} more", count(report.unsaid)));
        }
    });
}

/// The catalogue of failures: what fails, why, and the scene in both spaces.
fn failures(ui: &mut egui::Ui, answers: &mut Answers) {
    ui.set_width((ui.ctx().content_rect().width() * 0.8).min(760.0));
    ui.heading("Scenes where methods fail");
    ui.label("Each opens at the view at which it happens. Tests hold every method to what is said here.");
    ScrollArea::vertical().max_height(ui.ctx().content_rect().height() * 0.6).show(ui, |ui| {
        for failure in crate::scene::failures() {
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                ui.strong(failure.name);
                for (space, source) in [("2D", failure.source::<Flat>()), ("3D", failure.source::<Solid>())] {
                    let button = ui.button(space).on_hover_text(&source);
                    button.widget_info(|| {
                        let text = format!("Open {} in {space}", failure.name);
                        egui::WidgetInfo::labeled(egui::Role::Button, true, text)
                    });
                    if button.clicked() {
                        answers.push(Command::Open(source));
                    }
                }
            });
            ui.add(egui::Label::new(failure.meaning).wrap());
        }
    });
}

fn about(state: &State, ui: &mut egui::Ui) {
    let Some(card) = state.film().map(|f| f.reel.card()) else { return };
    ui.set_max_width(460.0);
    ui.heading(card.name);
    ui.label(card.summary);
    ui.add_space(4.0);
    ui.weak(card.paper);
    if !card.doi.is_empty() {
        ui.hyperlink_to(format!("doi:{}", card.doi), format!("https://doi.org/{}", card.doi));
    }
    ui.label(if card.conservative {
        "Conservative: it never leaves out anything that can be seen."
    } else {
        "Not conservative: it may leave out what can be seen."
    });
}
