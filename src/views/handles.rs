//! The Eye in the hand: where it is grabbed, and what dragging does.
//!
//! Two handles: the Eye itself moves it, the one ahead of it turns it. Points are of the screen.

use eframe::egui::{self, CursorIcon, Pos2, Response, Stroke};

use super::palette;
use crate::app::{Gesture, State};
use crate::drawing::Role;
use crate::geometry::PrimId;

/// A part of the Eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// Moves it.
    Position,
    /// Turns it.
    Target,
}

/// What the person does in the pictures, from frame to frame, and what the window is to know of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hand {
    /// The part of the Eye that the pointer holds.
    pub held: Option<Handle>,
    /// Number of the present gesture, for undo.
    pub gesture: Gesture,
    /// Whether letters carried the Eye in the last frame.
    pub flew: bool,
    /// Whether the Eye's picture takes letters to fly.
    pub is_flying: bool,
    /// Whether a picture has the focus.
    pub is_picture_focused: bool,
    /// Width over height of the Observer's picture.
    pub aspect: f32,
    /// The pixel of the Eye's picture whose menu is open, and what is drawn there.
    pub menu_of: Option<([u32; 2], Option<PrimId>)>,
}

/// How near the pointer must come.
const REACH: f32 = 13.0;

/// The handle under a point.
pub fn under(at: Pos2, position: Option<Pos2>, target: Option<Pos2>) -> Option<Handle> {
    let near = |p: Option<Pos2>| p.is_some_and(|p| p.distance(at) <= REACH);
    if near(target) {
        Some(Handle::Target)
    } else if near(position) {
        Some(Handle::Position)
    } else {
        None
    }
}

/// Paints the handles; the one under the pointer is larger.
pub fn paint(
    state: &State,
    painter: &egui::Painter,
    response: &Response,
    position: Option<Pos2>,
    target: Option<Pos2>,
) {
    if state.is_eye_locked {
        return;
    }
    let hovered = response.hover_pos().and_then(|at| under(at, position, target));
    let (fill, rim) = (palette::role(state, Role::Eye), palette::panel(state).canvas);
    let dot = |at: Option<Pos2>, handle, radius: f32| {
        let Some(at) = at else { return };
        let radius = if hovered == Some(handle) { radius + 2.0 } else { radius };
        painter.circle(at, radius, fill, Stroke::new(1.5, rim));
    };
    dot(position, Handle::Position, 6.0);
    dot(target, Handle::Target, 4.5);
    if hovered.is_some() {
        painter.ctx().set_cursor_icon(CursorIcon::Grab);
    }
}
