//! The method and its parameters; a change is culled again at once, off this thread.

use eframe::egui::{self, ScrollArea};

use super::Answers;
use crate::app::{Action, Command, Gesture, State};
use crate::culling::Methods;
use crate::geometry::{Either, Flat, Solid, each};
use crate::method::{Budget, Derived, Knob, KnobValue};

/// Shows the parameters.
pub fn show(state: &State, gesture: &mut Gesture, ui: &mut egui::Ui, answers: &mut Answers) {
    ScrollArea::vertical().auto_shrink(false).id_salt("parameters").show(ui, |ui| {
        let found = state.film().and_then(|film| film.reel.derived());
        for (knob, value) in wanted(state) {
            edit(state, gesture, ui, knob, &value, answers);
            if let Some(found) = found.filter(|found| found.knob == knob.name) {
                derived(found, ui);
            }
        }
        if let Some(result) = state.result() {
            ui.add_space(4.0);
            // Rows above may be wider than the pane.
            ui.scope(|ui| {
                ui.set_max_width((ui.clip_rect().right() - ui.cursor().left() - 4.0).max(80.0));
                ui.label(result).on_hover_text("This frame, beside an image of everything");
            });
        }
        if !state.settings.0.is_empty() {
            super::action_button(state, ui, Action::ResetSettings, "Reset", answers);
        }
        ui.separator();
        eye(state, gesture, ui, answers);
        ui.add_space(4.0);
        if let Some(film) = state.film() {
            ui.weak(film.reel.card().summary);
        }
    });
}

/// What follows from a parameter, for the image that was culled for last: a sentence, and a table that is
/// opened with a click.
fn derived(derived: &Derived, ui: &mut egui::Ui) {
    ui.weak(&derived.note);
    egui::CollapsingHeader::new(derived.title).show(ui, |ui| {
        egui::Grid::new("derived").striped(true).spacing([10.0, 2.0]).show(ui, |ui| {
            for (i, row) in derived.rows.iter().enumerate() {
                for cell in row {
                    let text = egui::RichText::new(cell);
                    ui.label(if i == 0 { text.weak() } else { text.monospace() });
                }
                ui.end_row();
            }
        });
    });
}

/// Parameters as they are wanted now, which may be ahead of the film.
fn wanted(state: &State) -> Vec<(Knob, KnobValue)> {
    fn of<S: Methods>(state: &State) -> Vec<(Knob, KnobValue)> {
        S::method(&state.method).and_then(|m| m.knobs(&state.settings).ok()).unwrap_or_default()
    }
    match &state.stage {
        Some(Either::Flat(_)) => of::<Flat>(state),
        Some(Either::Solid(_)) => of::<Solid>(state),
        None => vec![],
    }
}

fn edit(
    state: &State,
    gesture: &mut Gesture,
    ui: &mut egui::Ui,
    knob: Knob,
    value: &KnobValue,
    answers: &mut Answers,
) {
    let help = format!("{}\n{}\n--set {}={value}", knob.meaning, knob.source, knob.name);
    let title = knob.name.replace('-', " ");
    let set = |text: String, gesture| Command::Set(knob.name.to_owned(), text, gesture);
    match value {
        KnobValue::Switch(on) => {
            let mut on = *on;
            if ui.checkbox(&mut on, &title).on_hover_text(&help).changed() {
                answers.push(set(on.to_string(), 0));
            }
        }
        KnobValue::Integer(v, range) => {
            let mut v = *v;
            let label = ui
                .label(if knob.unit.is_empty() { title.clone() } else { format!("{title} ({})", knob.unit) })
                .on_hover_text(&help);
            let response =
                ui.add(egui::Slider::new(&mut v, range.clone())).labelled_by(label.id).on_hover_text(&help);
            if response.drag_started() || (response.changed() && !response.dragged()) {
                *gesture += 1;
            }
            if response.changed() {
                answers.push(set(v.to_string(), *gesture));
            }
        }
        KnobValue::Real(v, range) => {
            let mut v = *v;
            let label = ui.label(&title).on_hover_text(&help);
            let slider = egui::Slider::new(&mut v, range.clone()).suffix(knob.unit);
            let response = ui.add(slider).labelled_by(label.id).on_hover_text(&help);
            if response.drag_started() || (response.changed() && !response.dragged()) {
                *gesture += 1;
            }
            if response.changed() {
                answers.push(set(v.to_string(), *gesture));
            }
        }
        KnobValue::Choice(chosen, options) => {
            let mut chosen = *chosen;
            let label = ui.label(&title).on_hover_text(&help);
            let combo =
                egui::ComboBox::from_id_salt(knob.name)
                    .show_index(ui, &mut chosen, options.len(), |i| options[i]);
            if combo.labelled_by(label.id).on_hover_text(&help).changed() {
                answers.push(set(options[chosen].to_owned(), 0));
            }
        }
        KnobValue::Budget(budget) => self::budget(state, gesture, ui, &title, &help, *budget, &set, answers),
    }
}

#[expect(clippy::too_many_arguments, reason = "what a panel is drawn from, and where its answers go")]
fn budget(
    state: &State,
    gesture: &mut Gesture,
    ui: &mut egui::Ui,
    title: &str,
    help: &str,
    now: Budget,
    set: &dyn Fn(String, Gesture) -> Command,
    answers: &mut Answers,
) {
    let most = state.staged().map_or(1, |s| s.scene().live_count()) as u32;
    let label = ui.label(title).on_hover_text(help);
    ui.horizontal(|ui| {
        let (mut next, response) = match now {
            Budget::Percent(mut p) => {
                let response = ui.add(egui::Slider::new(&mut p, 0.0..=100.0).suffix(" %").max_decimals(1));
                (Budget::Percent(p), response)
            }
            Budget::Count(mut n) => {
                let response = ui.add(egui::Slider::new(&mut n, 0..=most).logarithmic(true));
                (Budget::Count(n), response)
            }
            Budget::Milliseconds(mut ms) => {
                let response = ui.add(
                    egui::Slider::new(&mut ms, 0.1..=1000.0).logarithmic(true).suffix(" ms").max_decimals(1),
                );
                (Budget::Milliseconds(ms), response)
            }
        };
        let response = response.labelled_by(label.id).on_hover_text(help);
        if response.drag_started() || (response.changed() && !response.dragged()) {
            *gesture += 1;
        }
        let drawn = now.of(most as usize) as u32;
        let share = Budget::Percent((drawn as f32 * 100.0 / most.max(1) as f32 * 10.0).round() / 10.0);
        let kinds = [
            ("%", "A share of the scene", share),
            ("n", "A number", Budget::Count(drawn)),
            ("ms", "A time to cull and draw", Budget::Milliseconds(5.0)),
        ];
        for (name, meaning, start) in kinds {
            let is_now = std::mem::discriminant(&start) == std::mem::discriminant(&now);
            if ui.selectable_label(is_now, name).on_hover_text(meaning).clicked() && !is_now {
                next = start;
                *gesture += 1;
            }
        }
        if next != now {
            answers.push(set(next.to_string(), *gesture));
        }
    });
}

/// The Eye in numbers.
fn eye(state: &State, gesture: &mut Gesture, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(stage) = &state.stage else { return };
    ui.horizontal_wrapped(|ui| {
        ui.strong("Eye");
        super::action_button(
            state,
            ui,
            Action::LockEye,
            if state.is_eye_locked { "Locked" } else { "Lock" },
            answers,
        );
        super::action_button(state, ui, Action::EyeHome, "Back to path", answers);
        if matches!(stage, Either::Solid(_)) {
            super::action_button(state, ui, Action::EyeHere, "From here", answers);
        }
    });
    let mut view = stage.view();
    let extent = each!(stage, s => s.scene.bounds().diagonal());
    let speed = f64::from(extent) * 0.002;
    ui.add_enabled_ui(!state.is_eye_locked, |ui| {
        egui::Grid::new("eye").num_columns(2).spacing([8.0, 2.0]).show(ui, |ui| {
            let mut changed = false;
            let mut began = false;
            let mut drag = |ui: &mut egui::Ui, name: &str, widget: egui::DragValue<'_>| {
                let response = ui.add(widget);
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
                began |= response.drag_started() || (response.changed() && !response.dragged());
                changed |= response.changed();
            };
            match &mut view {
                Either::Flat(v) => {
                    vector(
                        ui,
                        "position",
                        speed,
                        &mut [&mut v.eye.position.x, &mut v.eye.position.y],
                        &mut drag,
                    );
                    vector(ui, "target", speed, &mut [&mut v.eye.target.x, &mut v.eye.target.y], &mut drag);
                    lens(ui, &mut v.eye.fov, &mut v.eye.near, &mut v.eye.far, speed, &mut drag);
                }
                Either::Solid(v) => {
                    let (p, t) = (&mut v.eye.position, &mut v.eye.target);
                    vector(ui, "position", speed, &mut [&mut p.x, &mut p.y, &mut p.z], &mut drag);
                    vector(ui, "target", speed, &mut [&mut t.x, &mut t.y, &mut t.z], &mut drag);
                    lens(ui, &mut v.eye.fov, &mut v.eye.near, &mut v.eye.far, speed, &mut drag);
                }
            }
            if began {
                *gesture += 1;
            }
            if changed {
                answers.push(Command::Eye(view, *gesture));
            }
        });
    });
}

type Drag<'a> = dyn FnMut(&mut egui::Ui, &str, egui::DragValue<'_>) + 'a;

fn vector(ui: &mut egui::Ui, name: &str, speed: f64, axes: &mut [&mut f32], drag: &mut Drag<'_>) {
    ui.weak(name);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (axis, value) in axes.iter_mut().enumerate() {
            drag(
                ui,
                &format!("Eye {name} {}", ["x", "y", "z"][axis]),
                egui::DragValue::new(*value).speed(speed).max_decimals(2),
            );
        }
    });
    ui.end_row();
}

fn lens(ui: &mut egui::Ui, fov: &mut f32, near: &mut f32, far: &mut f32, speed: f64, drag: &mut Drag<'_>) {
    ui.weak("angle");
    let mut degrees = fov.to_degrees();
    drag(
        ui,
        "Eye angle",
        egui::DragValue::new(&mut degrees).range(1.0..=170.0).suffix("°").speed(0.3).max_decimals(1),
    );
    // Only a real change may pass through degrees, which round.
    if degrees != fov.to_degrees() {
        *fov = degrees.to_radians();
    }
    ui.end_row();
    ui.weak("near, far");
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let (least, most) = (f64::from(*near) * 1.001, f64::from(*far) * 0.999);
        drag(
            ui,
            "Eye near",
            egui::DragValue::new(near).range(1e-4..=most).speed(speed * 0.1).max_decimals(3),
        );
        drag(ui, "Eye far", egui::DragValue::new(far).range(least..=1e9).speed(speed).max_decimals(1));
    });
    ui.end_row();
}
