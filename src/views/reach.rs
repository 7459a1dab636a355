//! The pointer and the keys in the pictures of space: orbiting, flying, grabbing the Eye, picking.

use eframe::egui::{self, Key, PointerButton, Pos2, Rect, pos2};
use glam::{Quat, Vec2, Vec3};

use super::Answers;
use super::handles::{self, Hand, Handle};
use crate::app::{Action, Command, Gesture, ObserverCamera, Stage, State};
use crate::drawing::Subject;
use crate::figure;
use crate::geometry::{Either, Solid, View};
use crate::method::Verdict;
use crate::render::gpu::SpaceCamera;
use crate::trace::State as Known;

/// Part of the Observer's distance to the Eye at which the turning handle stands.
const AIM: f32 = 0.12;

/// World ray through a point of the screen.
fn ray(view: &View<Solid>, rect: Rect, at: Pos2) -> (Vec3, Vec3) {
    let camera = SpaceCamera::from(view.eye);
    camera.ray(Vec2::new(at.x - rect.left(), at.y - rect.top()), [rect.width() as u32, rect.height() as u32])
}

/// The Observer's picture, with the Eye as it stands in it.
struct Outside<'a> {
    state: &'a State,
    stage: &'a Stage<Solid>,
    response: &'a egui::Response,
    view: &'a View<Solid>,
    /// Distance of the Eye from the Observer.
    depth: f32,
    /// Where the turning handle stands.
    aim: Vec3,
    /// The handles on the screen; `None` behind the Observer.
    position: Option<Pos2>,
    target: Option<Pos2>,
}

/// The Observer's picture: dragging turns, the wheel zooms, the Eye can be grabbed, a click selects.
pub fn observe(
    state: &State,
    stage: &Stage<Solid>,
    hand: &mut Hand,
    ui: &egui::Ui,
    response: &egui::Response,
    view: &View<Solid>,
    answers: &mut Answers,
) {
    let rect = response.rect;
    let camera = SpaceCamera::from(view.eye);
    let size = [rect.width() as u32, rect.height() as u32];
    let to_screen = |p: Vec3| camera.project(p, size).map(|at| rect.min + egui::vec2(at.x, at.y));
    let eye = &stage.view.eye;
    let depth = (eye.position - view.eye.position).length();
    let aim = eye.position + eye.forward() * (depth * AIM);
    let (position, target) = (to_screen(eye.position), to_screen(aim));
    let outside = Outside { state, stage, response, view, depth, aim, position, target };
    if state.shown.eye {
        handles::paint(state, &ui.painter_at(rect), response, position, target);
    }
    let mut observer = state.observer;
    outside.zoom(ui, &mut observer);
    outside.drag(hand, ui, &mut observer, answers);
    outside.click(&mut observer, answers);
    if observer != state.observer {
        answers.push(Command::Observe(observer));
    }
}

impl Outside<'_> {
    fn zoom(&self, ui: &egui::Ui, observer: &mut ObserverCamera) {
        let Some(at) = self.response.hover_pos() else { return };
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta()));
        let factor = (-scroll * 0.004).exp() / pinch;
        if factor != 1.0 {
            let rect = self.response.rect;
            let cursor = (at - rect.center()) / rect.size() * 2.0;
            observer.zoom(factor, Vec2::new(cursor.x, -cursor.y), rect.aspect_ratio());
        }
    }

    fn drag(&self, hand: &mut Hand, ui: &egui::Ui, observer: &mut ObserverCamera, answers: &mut Answers) {
        let (response, height) = (self.response, self.response.rect.height());
        let (shift, alt) = ui.input(|i| (i.modifiers.shift, i.modifiers.alt));
        if response.drag_started() {
            let at = ui.input(|i| i.pointer.press_origin()).unwrap_or(pos2(0.0, 0.0));
            let grabs = response.dragged_by(PointerButton::Primary) && !shift && !alt && self.state.shown.eye;
            hand.held = handles::under(at, self.position, self.target).filter(|_| grabs);
            hand.gesture += 1;
        }
        if response.dragged() {
            let delta = Vec2::new(response.drag_delta().x, response.drag_delta().y);
            // World units of a screen point at the Eye's depth, so that the Eye stays under the pointer.
            let unit = 2.0 * self.depth * (self.view.eye.fov * 0.5).tan() / height;
            let by = observer.rotation() * Vec3::new(delta.x * unit, -delta.y * unit, 0.0);
            match hand.held {
                Some(handle) => drag_eye(self.stage, handle, by, self.aim, hand.gesture, answers),
                None if response.dragged_by(PointerButton::Secondary) || shift => observer.pan(delta, height),
                None if alt => observer.roll += delta.x * 0.01,
                None => observer.orbit(-delta.x * 0.008, delta.y * 0.008),
            }
        }
        if response.drag_stopped() {
            hand.held = None;
        }
    }

    fn click(&self, observer: &mut ObserverCamera, answers: &mut Answers) {
        let clicked = self.response.interact_pointer_pos().filter(|_| self.response.clicked());
        let Some(at) = clicked else { return };
        self.response.request_focus();
        let (origin, direction) = ray(self.view, self.response.rect, at);
        let hit = figure::pick(self.stage.posed(), origin, direction, |p| self.stage.shows(p));
        if self.response.double_clicked() {
            match hit {
                // The point under the cursor becomes what the Observer turns around.
                Some((_, t)) => observer.pivot = (origin + direction * t).to_array(),
                None => answers.extend([Command::Select(Subject::None), Action::FrameSelection.into()]),
            }
        } else {
            let grabbed = handles::under(at, self.position, None).is_some() && self.state.shown.eye;
            answers.push(Command::Select(if grabbed {
                Subject::Eye
            } else {
                hit.map_or(Subject::None, |(p, _)| Subject::Prim(p))
            }));
        }
    }
}

fn drag_eye(
    stage: &Stage<Solid>,
    handle: Handle,
    by: Vec3,
    aim: Vec3,
    gesture: Gesture,
    answers: &mut Answers,
) {
    if by == Vec3::ZERO {
        return;
    }
    let mut view = stage.view;
    let eye = &mut view.eye;
    match handle {
        Handle::Position => {
            eye.position += by;
            eye.target += by;
        }
        Handle::Target => {
            let length = (eye.target - eye.position).length();
            eye.target = eye.position + (aim + by - eye.position).normalize_or(eye.forward()) * length;
        }
    }
    answers.push(Command::Eye(Either::Solid(view), gesture));
}

/// The Eye's picture: dragging looks around, letters fly, a click selects.
pub fn look_around(
    state: &State,
    stage: &Stage<Solid>,
    hand: &mut Hand,
    ui: &egui::Ui,
    response: &egui::Response,
    rect: Rect,
    answers: &mut Answers,
) {
    let hit = |at: Pos2| {
        let (origin, direction) = ray(&stage.view, rect, at);
        let drawn = |p| {
            let known = stage.recorded.as_ref().map_or(Known::Unseen, |r| r.stamps.prim(p, state.step));
            stage.shows(p)
                && matches!(
                    known,
                    Known::Unseen | Known::Open | Known::Decided(Verdict::Visible | Verdict::Partial)
                )
        };
        figure::pick(stage.posed(), origin, direction, drawn).map(|(prim, _)| prim)
    };
    if let Some(at) = response.interact_pointer_pos().filter(|p| response.clicked() && rect.contains(*p)) {
        response.request_focus();
        answers.push(Command::Select(hit(at).map_or(Subject::None, Subject::Prim)));
    }
    let under = |at: Pos2| {
        let [x, y] = [(at.x - rect.left()) / rect.width(), (at.y - rect.top()) / rect.height()];
        let pixel = [x * stage.view.width as f32, y * stage.view.height as f32].map(|n| n as u32);
        rect.contains(at).then(|| (pixel, hit(at)))
    };
    super::pixel::interact(state, hand, ui, response, under, answers);
    hand.is_flying |= response.has_focus();
    let mut view = stage.view;
    let eye = &mut view.eye;
    if response.drag_started() {
        response.request_focus();
        hand.gesture += 1;
    }
    let delta = response.drag_delta();
    if response.dragged() && delta != egui::Vec2::ZERO {
        let forward = eye.target - eye.position;
        let unit = eye.fov / rect.height().max(1.0);
        let right = forward.cross(eye.up).normalize_or(Vec3::X);
        let turn = Quat::from_axis_angle(eye.up.normalize_or(Vec3::Y), delta.x * unit);
        let turned = turn * Quat::from_axis_angle(right, delta.y * unit) * forward;
        // Looking straight up or down would leave no way to tell left from right.
        if turned.normalize_or(Vec3::Z).cross(eye.up.normalize_or(Vec3::Y)).length() > 0.05 {
            eye.target = eye.position + turned;
        }
    }
    if response.has_focus() && !state.is_eye_locked {
        let by = flight(ui, stage, hand);
        eye.position += by;
        eye.target += by;
    }
    if view != stage.view {
        answers.push(Command::Eye(Either::Solid(view), hand.gesture));
    }
}

/// How far the letters that are held carry the Eye in this frame.
fn flight(ui: &egui::Ui, stage: &Stage<Solid>, hand: &mut Hand) -> Vec3 {
    let eye = &stage.view.eye;
    let forward = eye.forward();
    let right = forward.cross(eye.up).normalize_or(Vec3::X);
    let up = eye.up.normalize_or(Vec3::Y);
    let held = |i: &egui::InputState| {
        let axes = [
            (Key::W, forward),
            (Key::S, -forward),
            (Key::D, right),
            (Key::A, -right),
            (Key::E, up),
            (Key::Q, -up),
        ];
        axes.iter().filter(|(k, _)| i.key_down(*k)).fold(Vec3::ZERO, |sum, (_, v)| sum + *v)
    };
    let (toward, seconds, shift, slow) = ui.input(|i| {
        (held(i), i.stable_dt.min(0.1), i.modifiers.shift, i.modifiers.command || i.modifiers.ctrl)
    });
    if toward == Vec3::ZERO {
        hand.flew = false;
        return Vec3::ZERO;
    }
    if !std::mem::replace(&mut hand.flew, true) {
        hand.gesture += 1;
    }
    ui.ctx().request_repaint();
    let speed = stage.scene.bounds().diagonal()
        * 0.08
        * if shift {
            4.0
        } else if slow {
            0.25
        } else {
            1.0
        };
    toward.normalize_or_zero() * speed * seconds
}
