//! Flatland from above: the Observer's view. Wheel zooms to the cursor, dragging pans, the Eye can be
//! grabbed.

use eframe::egui::{self, Pos2, Sense, pos2};
use glam::Vec2;

use super::handles::{self, Hand, Handle};
use super::{Answers, palette};
use crate::app::{Command, PoseKey, Stage, State};
use crate::drawing::{Drawing, Subject};
use crate::figure::{Look, Sheet};
use crate::geometry::{Either, Flat};
use crate::render::screen;

/// Distance of the turning handle from the Eye, points.
const AIM_PT: f32 = 54.0;

/// The step's marks in the plane, and the film, step and look that they were drawn for.
pub type World = ((u64, PoseKey, usize, Look), Drawing<Vec2>);

/// Shows flatland.
pub fn show(
    state: &State,
    stage: &Stage<Flat>,
    drawn: &mut Option<World>,
    hand: &mut Hand,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Observer view. {}", state.sentence()))
    });
    hand.is_picture_focused |= response.has_focus();
    if state.is_to_frame {
        let mut camera = state.observer;
        camera.frame_flat(
            &stage.framed(state.selection),
            &stage.posed().bounds(),
            rect.width() / rect.height().max(1.0),
        );
        answers.push(Command::Observe(camera));
    }
    hand.aspect = rect.aspect_ratio();
    let sheet = sheet(state, rect);
    let to_screen = |p: Vec2| {
        let p = sheet.to_paper(p);
        rect.min + egui::vec2(p.x, p.y)
    };
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, palette::panel(state).canvas);
    if let Some(recorded) = &stage.recorded {
        let look = state.look();
        let key = (recorded.serial, stage.pose_key(), state.step, look);
        if drawn.as_ref().is_none_or(|(k, _)| *k != key) {
            *drawn = stage.world(state.step, &look).map(|world| (key, world));
        }
        if let Some((_, world)) = drawn {
            let mut paper = Drawing { size_pt: Vec2::new(rect.width(), rect.height()), ..Drawing::default() };
            sheet.place(world, &mut paper);
            super::readable_labels(&mut paper);
            screen::paint(&painter, &paper, state.shown.theme, rect.min, 1.0);
        }
    }
    let eye = &stage.view.eye;
    let (position, ahead) = (to_screen(eye.position), Vec2::new(eye.forward().x, -eye.forward().y) * AIM_PT);
    let target = position + egui::vec2(ahead.x, ahead.y);
    handles::paint(state, &painter, &response, Some(position), Some(target));
    interact(state, stage, hand, ui, &response, &sheet, (position, target), answers);
    focus_ring(state, ui, &response);
}

/// A ring around the picture that has the keys.
pub fn focus_ring(state: &State, ui: &egui::Ui, response: &egui::Response) {
    if response.has_focus() {
        let stroke = egui::Stroke::new(2.0, palette::panel(state).accent);
        ui.painter().rect_stroke(response.rect, 0.0, stroke, egui::StrokeKind::Inside);
    }
}

fn sheet(state: &State, rect: egui::Rect) -> Sheet {
    let center = Vec2::new(state.observer.pivot[0], state.observer.pivot[1]);
    let scale = rect.height() / (2.0 * state.observer.distance).max(1e-6);
    Sheet { center, scale, middle_pt: Vec2::new(rect.width(), rect.height()) * 0.5 }
}

#[expect(clippy::too_many_arguments, reason = "what a panel is drawn from, and where its answers go")]
fn interact(
    state: &State,
    stage: &Stage<Flat>,
    hand: &mut Hand,
    ui: &egui::Ui,
    response: &egui::Response,
    sheet: &Sheet,
    (position, target): (Pos2, Pos2),
    answers: &mut Answers,
) {
    let origin = response.rect.min;
    let world = |p: Pos2| sheet.to_world(Vec2::new(p.x - origin.x, p.y - origin.y));
    let mut camera = state.observer;
    if let Some(at) = response.hover_pos() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta()));
        let factor = (-scroll * 0.004).exp() / pinch;
        if factor != 1.0 {
            camera.zoom_flat(factor, world(at));
        }
    }
    // A drag holds what lies under the point where the button went down, not where the drag was noticed.
    if response.drag_started() {
        let at = ui.input(|i| i.pointer.press_origin()).unwrap_or(pos2(0.0, 0.0));
        let primary = response.dragged_by(egui::PointerButton::Primary) && !ui.input(|i| i.modifiers.shift);
        hand.held = handles::under(at, Some(position), Some(target)).filter(|_| primary);
        hand.gesture += 1;
    }
    if response.dragged() {
        let delta = response.drag_delta();
        let by = Vec2::new(delta.x, -delta.y) / sheet.scale;
        let mut view = stage.view;
        match (hand.held, response.interact_pointer_pos()) {
            (Some(Handle::Position), _) => {
                view.eye.position += by;
                view.eye.target += by;
            }
            (Some(Handle::Target), Some(at)) => {
                let length = (view.eye.target - view.eye.position).length();
                let toward = (world(at) - view.eye.position).normalize_or(view.eye.forward());
                view.eye.target = view.eye.position + toward * length;
            }
            // Nothing is held: the picture itself is.
            _ => camera.slide(-by),
        }
        if hand.held.is_some() && delta != egui::Vec2::ZERO {
            answers.push(Command::Eye(Either::Flat(view), hand.gesture));
        }
    }
    if response.drag_stopped() {
        hand.held = None;
    }
    if response.clicked() {
        response.request_focus();
        if let Some(at) = response.interact_pointer_pos() {
            let subject = match handles::under(at, Some(position), None) {
                Some(_) => Subject::Eye,
                None => stage.pick(world(at), 6.0 / sheet.scale, state.step),
            };
            answers.push(Command::Select(subject));
        }
    }
    if response.double_clicked() {
        answers.push(crate::app::Action::FrameSelection.into());
    }
    if camera != state.observer {
        answers.push(Command::Observe(camera));
    }
}
