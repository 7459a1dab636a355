//! Signs on buttons, painted, so that they do not depend on a font.

use eframe::egui::{self, Color32, Pos2, Rect, Response, Sense, Stroke, Ui, pos2, vec2};

/// A sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// To the beginning.
    First,
    /// Back over a node.
    BackOver,
    /// One back.
    Back,
    /// Play.
    Play,
    /// Pause.
    Pause,
    /// One on.
    Forward,
    /// Over a node.
    Over,
    /// Out of a node.
    Out,
    /// To the end.
    Last,
    /// Something folded.
    Folded,
    /// Something unfolded.
    Unfolded,
    /// Light and dark.
    Theme,
    /// A full dot.
    Dot,
    /// A hollow dot.
    Ring,
    /// Here.
    Here,
}

/// A button with a sign, drawn like any other button.
pub fn button(ui: &mut Ui, icon: Icon, enabled: bool) -> Response {
    let size = vec2(ui.spacing().interact_size.y + 8.0, ui.spacing().interact_size.y);
    let button = egui::Button::new("").min_size(size);
    let response = ui.add_enabled(enabled, button);
    let color =
        if enabled { ui.style().interact(&response).fg_stroke.color } else { ui.visuals().weak_text_color() };
    paint(ui.painter(), icon, response.rect.shrink2(vec2(7.0, 4.0)), color);
    response
}

/// A sign without a frame; clicks if asked to.
pub fn plain(ui: &mut Ui, icon: Icon, sense: Sense, color: Color32) -> Response {
    let size = vec2(14.0, ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, sense);
    if response.has_focus() || response.hovered() && sense != Sense::hover() {
        ui.painter().rect_filled(rect, 2.0, ui.visuals().widgets.hovered.bg_fill);
    }
    paint(ui.painter(), icon, Rect::from_center_size(rect.center(), vec2(9.0, 9.0)), color);
    response
}

fn paint(painter: &egui::Painter, icon: Icon, rect: Rect, color: Color32) {
    let side = rect.height().min(rect.width());
    let r = Rect::from_center_size(rect.center(), vec2(side, side));
    let triangle = |r: Rect, right: bool| {
        let (tip, base) = if right { (r.right(), r.left()) } else { (r.left(), r.right()) };
        let points = vec![pos2(tip, r.center().y), pos2(base, r.bottom()), pos2(base, r.top())];
        painter.add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
    };
    let bar = |x: f32, w: f32| {
        painter.rect_filled(Rect::from_center_size(pos2(x, r.center().y), vec2(w, r.height())), 0.0, color);
    };
    let half = |left: bool| if left { r.with_max_x(r.center().x) } else { r.with_min_x(r.center().x) };
    match icon {
        Icon::Play => triangle(r, true),
        Icon::Pause => {
            [r.left() + side * 0.25, r.right() - side * 0.25].into_iter().for_each(|x| bar(x, side * 0.28))
        }
        Icon::Forward | Icon::Last => {
            triangle(r.with_max_x(r.right() - side * 0.25), true);
            bar(r.right() - side * 0.08, if icon == Icon::Last { side * 0.32 } else { 1.5 });
        }
        Icon::Back | Icon::First => {
            triangle(r.with_min_x(r.left() + side * 0.25), false);
            bar(r.left() + side * 0.08, if icon == Icon::First { side * 0.32 } else { 1.5 });
        }
        Icon::Over => [true, false].into_iter().for_each(|l| triangle(half(l), true)),
        Icon::BackOver => [true, false].into_iter().for_each(|l| triangle(half(l), false)),
        Icon::Out => out(painter, r, color),
        Icon::Folded => triangle(r, true),
        Icon::Unfolded => {
            let points = vec![r.left_top(), r.right_top(), r.center_bottom()];
            painter.add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
        }
        Icon::Theme => half_moon(painter, r, color),
        Icon::Dot => drop_shape(painter.circle_filled(r.center(), side * 0.5, color)),
        Icon::Ring => drop_shape(painter.circle_stroke(r.center(), side * 0.28, Stroke::new(1.0, color))),
        Icon::Here => triangle(r, true),
    }
}

/// A ring whose left half is filled.
fn half_moon(painter: &egui::Painter, r: Rect, color: Color32) {
    let radius = r.height() * 0.5;
    painter.circle_stroke(r.center(), radius, Stroke::new(1.5, color));
    let at = |k: i32| r.center() + egui::Vec2::angled((90.0 + 18.0 * k as f32).to_radians()) * radius;
    let half = (0..=10).map(at).collect::<Vec<Pos2>>();
    painter.add(egui::Shape::convex_polygon(half, color, Stroke::NONE));
}

/// An arrow that leaves upward.
fn out(painter: &egui::Painter, r: Rect, color: Color32) {
    let stroke = Stroke::new(1.8, color);
    let corner = pos2(r.center().x, r.bottom());
    painter.line_segment([r.left_bottom(), corner], stroke);
    painter.line_segment([corner, pos2(corner.x, r.top())], stroke);
    let tip = pos2(corner.x, r.top());
    let wing = r.width() * 0.32;
    painter.line_segment([tip, tip + vec2(-wing, wing)], stroke);
    painter.line_segment([tip, tip + vec2(wing, wing)], stroke);
}

fn drop_shape(_: egui::layers::ShapeIdx) {}
