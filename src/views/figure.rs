//! The dialog of figures: what they show, of which size, in which colors, and where they go.

use std::path::Path;

use eframe::egui::{self, DragValue, Grid, TextEdit};

use super::Answers;
use crate::app::{Command, Dialog, Export, Form, Picture, RATE, State, Steps, Theme};
use crate::drawing::words::count;
use crate::figure::{Paper, page::PT_PER_MM};
use crate::geometry::Either;
use crate::render::{Animation, Format};

/// Pictures of a method in a row.
const OWN_IN_ROW: usize = 3;

/// What is chosen in the dialog beyond the figure itself.
pub struct Choice {
    /// The file's format.
    format: Format,
    /// Where it goes, once a person wrote it.
    path: Option<String>,
}

impl Default for Choice {
    fn default() -> Self {
        Self { format: Format::Svg, path: None }
    }
}

/// Shows the dialog. `aspect` is that of the Observer's window, width over height.
pub fn show(state: &State, choice: &mut Choice, aspect: f32, ui: &mut egui::Ui, answers: &mut Answers) {
    let mut export = state.exporting.clone();
    ui.heading("Figure");
    Grid::new("figure").num_columns(2).spacing([12.0, 8.0]).show(ui, |ui| {
        ui.label("Shows");
        pictures(state, &mut export, ui);
        ui.end_row();
        ui.label("Steps");
        steps(state, &mut export, choice, ui);
        ui.end_row();
        ui.label("Size");
        size(&mut export, ui);
        ui.end_row();
        ui.label("Shape");
        shape(&mut export, aspect, ui);
        ui.end_row();
        ui.label("Colors");
        ui.horizontal(|ui| {
            for theme in Theme::ALL {
                ui.selectable_value(&mut export.theme, theme, theme.name());
            }
        });
        ui.end_row();
        if matches!(state.stage, Some(Either::Solid(_))) {
            ui.label("Surfaces");
            ui.horizontal(|ui| {
                ui.selectable_value(&mut export.is_vector, false, "pixels, as on screen");
                let vectors = ui.selectable_value(&mut export.is_vector, true, "vectors");
                vectors.on_hover_text("They hide each other; what was culled is outlined with dashes.");
            });
            ui.end_row();
        }
        ui.label("File");
        ui.horizontal(|ui| {
            for format in Format::ALL {
                let fits = export.fits(format);
                let button = egui::Button::selectable(choice.format == format, format.name());
                let response = ui.add_enabled(fits.is_ok(), button);
                let response =
                    fits.err().map_or(response.clone(), |why| response.on_disabled_hover_text(why));
                if response.clicked() {
                    choice.format = format;
                }
            }
            if choice.format == Format::Svg {
                ui.checkbox(&mut export.outline_text, "letters as outlines")
                    .on_hover_text("The same in every program, but no longer text");
            }
        });
        ui.end_row();
    });
    if let Some(format) = Format::ALL.into_iter().find(|f| export.fits(*f).is_ok())
        && export.fits(choice.format).is_err()
    {
        choice.format = format;
    }
    file(state, &export, choice, aspect, ui, answers);
    if export != state.exporting {
        answers.push(Command::Figures(Box::new(export)));
    }
}

fn pictures(state: &State, export: &mut Export, ui: &mut egui::Ui) {
    let own = state.film().map_or(&[][..], |film| film.reel.pictures());
    let shared =
        [(Picture::Observer, "Observer view"), (Picture::Eye, "Eye view"), (Picture::Code, "pseudocode")];
    let twin = matches!(state.stage, Some(Either::Solid(_))).then_some((Picture::Twin, "flatland twin"));
    let shared: Vec<(Picture, &str)> = shared.into_iter().chain(twin).collect();
    let own: Vec<(Picture, &str)> =
        own.iter().enumerate().map(|(i, name)| (Picture::Own(i), *name)).collect();
    ui.vertical(|ui| {
        for row in [&shared[..]].into_iter().chain(own.chunks(OWN_IN_ROW)) {
            ui.horizontal(|ui| {
                for &(picture, name) in row {
                    let mut is_shown = export.shown().contains(&picture);
                    if ui.checkbox(&mut is_shown, name).changed() {
                        let mut pictures = export.shown().to_vec();
                        pictures.retain(|p| *p != picture);
                        pictures.extend(is_shown.then_some(picture));
                        pictures.sort();
                        export.pictures = pictures;
                    }
                }
            });
        }
    });
}

/// The step at hand, or several and how they are one file.
fn steps(state: &State, export: &mut Export, choice: &mut Choice, ui: &mut egui::Ui) {
    let last = state.len();
    ui.vertical(|ui| {
        ui.horizontal(|ui| {
            let this = format!("this one ({})", count(state.step));
            if ui.selectable_label(export.steps.is_none(), this).clicked() {
                (export.steps, export.form) = (None, Form::Page);
            }
            if ui.selectable_label(export.steps.is_some(), "several").clicked() && export.steps.is_none() {
                let stride = last.div_ceil(12).max(1);
                export.steps = Some(Steps { from: 0, to: last, stride });
            }
        });
        let Some(steps) = &mut export.steps else { return };
        ui.horizontal(|ui| {
            ui.label("from");
            ui.add(DragValue::new(&mut steps.from).range(0..=steps.to));
            ui.label("to");
            ui.add(DragValue::new(&mut steps.to).range(steps.from..=last));
            ui.label("every");
            ui.add(DragValue::new(&mut steps.stride).range(1..=last.max(1)));
            ui.weak(format!("{} steps", count(steps.all().count())));
        });
        ui.horizontal(|ui| {
            let rate = if let Form::Animation(rate) = export.form { rate } else { RATE };
            for (form, title, format) in [
                (Form::Page, "on one page", None),
                (Form::Pages, "pages of a PDF", Some(Format::Pdf)),
                (Form::Animation(rate), "animated PNG", Some(Format::Png)),
            ] {
                if ui.selectable_label(export.form.word() == form.word(), title).clicked() {
                    export.form = form;
                    choice.format = format.unwrap_or(choice.format);
                }
            }
            if let Form::Animation(rate) = &mut export.form {
                ui.add(DragValue::new(rate).range(Animation::RATES).speed(0.1).suffix(" a second"));
            }
        });
    });
}

fn size(export: &mut Export, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        for (paper, title) in [
            (Paper::Column, "column, 84 mm"),
            (Paper::TwoColumns, "page, 175 mm"),
            (Paper::Slide, "slide, 16:9"),
        ] {
            ui.selectable_value(&mut export.paper, paper, title);
        }
        let mut width_mm = export.paper.width_pt() / PT_PER_MM;
        let field = DragValue::new(&mut width_mm).range(20.0..=1000.0).suffix(" mm").max_decimals(1);
        if ui.add(field).on_hover_text("Any other width; the height is what it must be").changed() {
            export.paper = Paper::Custom { width_mm, height_mm: None };
        }
    });
}

/// Width over height of the Observer's picture.
fn shape(export: &mut Export, window: f32, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        if ui.selectable_label(export.aspect.is_none(), "as the window").clicked() {
            export.aspect = None;
        }
        for (aspect, title) in [(1.0, "1:1"), (4.0 / 3.0, "4:3"), (16.0 / 9.0, "16:9")] {
            ui.selectable_value(&mut export.aspect, Some(aspect), title);
        }
        let mut ratio = export.aspect.unwrap_or(window);
        if ui.add(DragValue::new(&mut ratio).range(0.65..=5.0).speed(0.01).max_decimals(2)).changed() {
            export.aspect = Some(ratio);
        }
    });
}

/// The path and the buttons.
fn file(
    state: &State,
    export: &Export,
    choice: &mut Choice,
    aspect: f32,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let made = || {
        let name = format!("{}.{}", state.figure_name(export, 1), choice.format.name());
        state.folder.join(name).to_string_lossy().into_owned()
    };
    let mut path = choice.path.clone().unwrap_or_else(made);
    // What a person wrote keeps its name, whatever the format becomes.
    if choice.path.is_some() {
        path = Path::new(&path).with_extension(choice.format.name()).to_string_lossy().into_owned();
    }
    let response = ui.add(TextEdit::singleline(&mut path).desired_width(520.0));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "File of the figure"));
    if response.changed() {
        choice.path = Some(path.clone());
    }
    let is_there = Path::new(&path).exists();
    let parent = Path::new(&path).parent().map(Path::to_owned);
    let folder = parent.filter(|f| !f.as_os_str().is_empty() && !f.is_dir());
    ui.weak(match &folder {
        Some(folder) => format!("There is no folder {}.", folder.display()),
        None if is_there => "A file of this name exists; it will be replaced.".into(),
        None => "The file opens in the explorer where you are now.".into(),
    });
    ui.horizontal(|ui| {
        let title = if is_there { "Replace" } else { "Write" };
        let can = folder.is_none() && state.film().is_some();
        if ui.add_enabled(can, egui::Button::new(title)).clicked() {
            let export = Export { aspect: Some(export.aspect.unwrap_or(aspect)), ..export.clone() };
            answers.push(Command::WriteFigure(Box::new(export), path));
            choice.path = None;
        }
        if ui.button("Close").clicked() {
            answers.push(Command::Dialog(Dialog::None));
        }
    });
}
