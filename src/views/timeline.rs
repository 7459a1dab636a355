//! The timeline: the moves, the lanes with every event, scrubbing, the path's frames.

use eframe::egui::{self, Align2, FontId, Rect, Sense, Stroke, pos2, vec2};

use super::icons::Icon;
use super::{Answers, palette};
use crate::app::{Action, Breakpoint, Cell, Command, Concern, Lane, Staged, State, lanes};
use crate::drawing::words::count;
use crate::drawing::{Role, Subject};
use crate::figure::role_of;
use crate::method::{Event, Verdict};
use crate::trace::{Detail, State as Known};

/// Marks of one kind that a person can tell apart.
const MARKS: usize = 500;
/// Room for the names of lanes.
const NAMES: f32 = 72.0;

/// The cells of the lanes, and the film and width that they were counted for.
pub type Lanes = ((u64, usize), [Vec<Cell>; 4]);

/// The events about what the step is about, and the film and the thing that they were looked up for.
pub type About = ((u64, Subject), Vec<usize>);

/// What the timeline keeps.
#[derive(Default)]
pub struct Kept {
    lanes: Option<Lanes>,
    about: Option<About>,
}

/// Shows the timeline.
pub fn show(state: &State, kept: &mut Kept, ui: &mut egui::Ui, answers: &mut Answers) {
    let Some(stage) = state.staged() else { return };
    moves(state, ui, answers);
    frames(state, stage, ui, answers);
    let lost = state.film().map_or(0, |f| f.reel.lost());
    if lost > 0 {
        let text = format!(
            "This film is capped: it shows the first {} events; {} more happened.",
            count(state.len()),
            count(lost as usize)
        );
        ui.colored_label(ui.visuals().warn_fg_color, text);
    }
    scrubber(state, kept, ui, answers);
}

fn moves(state: &State, ui: &mut egui::Ui, answers: &mut Answers) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for (action, icon) in [
            (Action::First, Icon::First),
            (Action::BackOver, Icon::BackOver),
            (Action::Back, Icon::Back),
            (Action::PlayPause, if state.is_playing { Icon::Pause } else { Icon::Play }),
            (Action::Forward, Icon::Forward),
            (Action::Over, Icon::Over),
            (Action::Out, Icon::Out),
            (Action::Last, Icon::Last),
        ] {
            super::icon_button(state, ui, action, icon, answers);
        }
        ui.add_space(4.0);
        let label = ui.label("Step");
        let mut step = state.step;
        let response =
            ui.add(egui::DragValue::new(&mut step).range(0..=state.len()).speed(0.2)).labelled_by(label.id);
        if response.changed() {
            answers.push(Command::GoTo(step));
        }
        ui.label(format!("of {}", count(state.len())));
        ui.add_space(4.0);
        let mut speed = state.speed;
        // One widget, so that the name and the number wrap together.
        let drag = egui::DragValue::new(&mut speed)
            .range(0.25..=1e6)
            .speed(state.speed * 0.02)
            .prefix("Speed ")
            .suffix("/s")
            .max_decimals(1);
        if ui.add(drag).on_hover_text("Events a second (− and +)").changed() {
            answers.push(Command::Speed(speed));
        }
        let mut coarse = state.detail == Detail::Coarse;
        if ui.checkbox(&mut coarse, "coarse").on_hover_text(Action::ToggleDetail.info().help).changed() {
            answers.push(Command::Detail(if coarse { Detail::Coarse } else { Detail::Full }));
        }
    });
}

fn frames(state: &State, stage: &dyn Staged, ui: &mut egui::Ui, answers: &mut Answers) {
    let (names, (path, frame)) = (stage.paths(), stage.place());
    if names.len() == 1 && names[0].1 == 1 {
        return;
    }
    ui.horizontal(|ui| {
        ui.label("View");
        if names.len() > 1 {
            let combo = egui::ComboBox::from_id_salt("path")
                .selected_text(&names[path].0)
                .width(90.0)
                .show_ui(ui, |ui| {
                    for (i, (name, count)) in names.iter().enumerate() {
                        if ui.selectable_label(i == path, format!("{name} ({count})")).clicked() {
                            answers.push(Command::Frame(i, 0));
                        }
                    }
                });
            combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "View path"));
        }
        let icon = if state.is_path_playing { Icon::Pause } else { Icon::Play };
        super::icon_button(state, ui, Action::PlayPath, icon, answers);
        super::action_button(state, ui, Action::PreviousFrame, "[", answers);
        let last = names[path].1 - 1;
        let mut at = frame;
        // Room for what comes after it.
        let after = if stage.is_eye_moved() { 175.0 } else { 110.0 };
        let width = (ui.available_width() - after).clamp(40.0, 400.0);
        ui.spacing_mut().slider_width = width;
        let slider = egui::Slider::new(&mut at, 0..=last).show_value(false);
        let response = ui.add_enabled(last > 0, slider);
        response.widget_info(|| egui::WidgetInfo::slider(last > 0, at as f64, "View of the path"));
        if response.changed() {
            answers.push(Command::Frame(path, at));
        }
        super::action_button(state, ui, Action::NextFrame, "]", answers);
        ui.label(format!("{} of {}", frame + 1, last + 1));
        if stage.is_eye_moved() {
            ui.weak("(moved)");
        }
    });
}

/// The bar of the film: the steps from left to right.
struct Bar {
    rect: Rect,
    steps: usize,
}

impl Bar {
    fn per_step(&self) -> f32 {
        self.rect.width() / self.steps as f32
    }
    fn x_of(&self, step: usize) -> f32 {
        self.rect.left() + step as f32 * self.per_step()
    }
    fn step_at(&self, x: f32) -> usize {
        (((x - self.rect.left()) / self.per_step()).round().max(0.0) as usize).min(self.steps)
    }
}

fn scrubber(state: &State, kept: &mut Kept, ui: &mut egui::Ui, answers: &mut Answers) {
    let size = vec2(ui.available_width(), ui.available_height().max(40.0));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::slider(true, state.step as f64, "Timeline"));
    let Some(film) = state.film() else { return };
    let events = film.reel.events();
    let bar = Bar { rect: rect.with_min_x(rect.left() + NAMES), steps: events.len() };
    if events.is_empty() || bar.rect.width() < 4.0 {
        return;
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let step = bar.step_at(at.x);
        answers.push(Command::GoTo(step));
        let subject = step.checked_sub(1).map_or(Subject::None, |event| film.reel.subject(event));
        if response.clicked() && subject != Subject::None {
            answers.push(Command::Select(subject));
        }
    }
    let columns = bar.rect.width().max(1.0) as usize;
    let key = (film.serial, columns);
    if kept.lanes.as_ref().is_none_or(|(k, _)| *k != key) {
        kept.lanes = Some((key, lanes(events, columns)));
    }
    let Some((_, lanes)) = &kept.lanes else { return };
    let painter = ui.painter_at(rect);
    paint_about(state, &mut kept.about, &bar, &painter);
    paint_lanes(state, lanes, &bar, &painter, rect);
    marks(state, events, &painter, &bar);
    let (x, accent) = (bar.x_of(state.step), palette::panel(state).accent);
    painter.vline(x, rect.y_range(), Stroke::new(2.0, accent));
    painter.circle_filled(pos2(x, rect.top() + 3.0), 4.0, accent);
    if let Some(at) = response.hover_pos().filter(|p| bar.rect.contains(*p)) {
        let step = bar.step_at(at.x);
        let text = step.checked_sub(1).map_or("before the first event".into(), |i| film.reel.sentence(i));
        response.on_hover_text_at_pointer(format!("Step {step}: {text}"));
    }
}

/// Bands behind the lanes where the film is about the same thing as this step.
fn paint_about(state: &State, kept: &mut Option<About>, bar: &Bar, painter: &egui::Painter) {
    let (Some(film), Some(stage)) = (state.film(), state.staged()) else { return };
    let subject = state.current_subject();
    let key = (film.serial, subject);
    if kept.as_ref().is_none_or(|(k, _)| *k != key) {
        let concern = Concern::of(film, stage.scene(), subject);
        let about = (0..film.reel.events().len()).filter(|&i| concern.holds(i)).take(MARKS).collect();
        *kept = Some((key, about));
    }
    let Some((_, about)) = kept else { return };
    let (color, width) = (palette::halo(state, Role::Current), bar.per_step().clamp(3.0, 8.0));
    for &event in about.iter() {
        painter.vline(bar.x_of(event + 1), bar.rect.y_range(), Stroke::new(width, color));
    }
}

/// The lanes one below the other, each with its name on the left.
fn paint_lanes(state: &State, lanes: &[Vec<Cell>; 4], bar: &Bar, painter: &egui::Painter, rect: Rect) {
    let height = rect.height() / Lane::ALL.len() as f32;
    let colors = palette::panel(state);
    let font = FontId::proportional((height * 0.7).clamp(8.0, 13.0));
    let width = bar.per_step().clamp(1.0, 6.0);
    for (row, lane) in Lane::ALL.into_iter().enumerate() {
        let top = rect.top() + row as f32 * height;
        let lane_rect = Rect::from_min_size(pos2(rect.left(), top), vec2(rect.width(), height));
        let name_at = pos2(rect.left(), lane_rect.center().y);
        painter.text(name_at, Align2::LEFT_CENTER, lane.name(), font.clone(), colors.faint);
        painter.hline(rect.x_range(), lane_rect.bottom(), Stroke::new(1.0, colors.border));
        let cells = &lanes[lane as usize];
        let deepest = cells.iter().map(|c| c.depth).max().unwrap_or(0).max(1);
        for (column, cell) in cells.iter().enumerate().filter(|(_, c)| c.count > 0) {
            let corner = pos2(bar.rect.left() + column as f32, lane_rect.top() + 2.0);
            let place = Rect::from_min_size(corner, vec2(width, height - 4.0));
            paint_cell(state, painter, lane, cell, deepest, place);
        }
    }
}

fn paint_cell(state: &State, painter: &egui::Painter, lane: Lane, cell: &Cell, deepest: u32, rect: Rect) {
    match (lane, cell.main_verdict()) {
        (Lane::Walk, _) => {
            let rise = rect.height() * cell.depth as f32 / deepest as f32;
            let low = Rect::from_min_max(pos2(rect.left(), rect.bottom() - rise.max(1.0)), rect.max);
            painter.rect_filled(low, 0.0, palette::role(state, Role::Faint));
        }
        (_, Some(verdict)) => {
            // Form as well as hue: what is kept fills the lane, what is culled hangs in its upper half.
            let kept = matches!(verdict, Verdict::Visible);
            let part = match verdict {
                _ if kept => rect,
                Verdict::Partial => rect.shrink2(vec2(0.0, rect.height() * 0.35)),
                _ => rect.with_max_y(rect.center().y),
            };
            painter.rect_filled(part, 0.0, palette::role(state, role_of(Known::Decided(verdict))));
        }
        _ => {
            painter.rect_filled(
                rect.shrink2(vec2(0.0, rect.height() * 0.3)),
                0.0,
                palette::role(state, Role::Evidence),
            );
        }
    }
}

/// Bookmarks as flags, breakpoints at verdicts as dots, up to as many as a person can tell apart.
fn marks(state: &State, events: &[Event], painter: &egui::Painter, bar: &Bar) {
    let colors = palette::panel(state);
    for (i, bookmark) in state.bookmarks.iter().enumerate() {
        let x = bar.x_of(bookmark.step);
        painter.vline(x, bar.rect.y_range(), Stroke::new(1.0, colors.text));
        painter.text(
            pos2(x + 2.0, bar.rect.top()),
            Align2::LEFT_TOP,
            (i + 1).to_string(),
            FontId::proportional(10.0),
            colors.text,
        );
    }
    let dot = |i: usize| {
        painter.circle_filled(pos2(bar.x_of(i + 1), bar.rect.bottom() - 3.0), 2.5, colors.text);
    };
    if state.breakpoints.iter().any(|b| !matches!(b, Breakpoint::Verdict(_))) {
        let stops = state.stops();
        (0..events.len()).filter(|&i| stops(i)).take(MARKS).for_each(dot);
    } else {
        let wanted =
            |e: &Event| e.verdict().is_some_and(|v| state.breakpoints.contains(&Breakpoint::Verdict(v)));
        let stops = events.iter().enumerate().filter(|(_, e)| wanted(e)).take(MARKS);
        stops.for_each(|(i, _)| dot(i));
    }
}
