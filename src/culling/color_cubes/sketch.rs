//! What the method's pictures are put together from: lines of text, patches of color, images.

use glam::{Vec2, vec2};

use super::ColorCubes;
use super::evidence::Evidence;
use super::space::Projected;
use crate::drawing::{Anchor, Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::geometry::{NodeId, Space, View};
use crate::method::{Moment, Note};
use crate::raster::srgb_bytes;

/// A step as a picture sees it.
pub type At<'a, 'b, S> = &'a Moment<'b, S, ColorCubes>;

/// Size of text.
const TEXT_PT: f32 = 8.5;

/// Puts a line of text into a picture.
pub fn say(to: &mut Drawing, at: Vec2, text: impl Into<String>) {
    to.text(Layer::Labels, Role::Ink, at, TEXT_PT, Anchor::Start, text);
}

/// A premultiplied linear color as it is painted: sRGB, not premultiplied.
pub fn bytes([r, g, b, alpha]: [f32; 4]) -> [u8; 4] {
    let [r, g, b, _] = srgb_bytes([r, g, b].map(|c| c / alpha.max(1e-6)));
    [r, g, b, (alpha * 255.0 + 0.5) as u8]
}

/// A patch of color, with its coverage as its opacity.
pub fn patch(to: &mut Drawing, at: Vec2, side: f32, color: [f32; 4]) {
    let points =
        [vec2(0.0, 0.0), vec2(side, 0.0), vec2(side, side), vec2(0.0, side)].map(|p| at + p).to_vec();
    to.push(Layer::Areas, Role::Approximated, Subject::None, Mark::Swatch { points, rgba: bytes(color) });
}

/// How high an image of a view is that is so wide: a line of flatland as high as is well seen.
pub fn height_of<S: Space>(view: &View<S>, width: f32) -> f32 {
    if view.height == 1 { 24.0 } else { width * view.height as f32 / view.width as f32 }
}

/// Puts an image of a view's size into a picture, so wide, with a line of text above its upper left corner.
pub fn image<S: Space>(
    to: &mut Drawing,
    view: &View<S>,
    (at, width): (Vec2, f32),
    rgba: Vec<u8>,
    text: impl Into<String>,
) {
    say(to, at - vec2(0.0, 3.0), text);
    let pixels = Pixels { width: view.width, height: view.height, rgba: rgba.into() };
    let corners = [at, at + vec2(width, height_of(view, width))];
    to.push(Layer::Ground, Role::Paper, Subject::None, Mark::Image { corners, pixels });
}

/// The cell that the step is about, or the last one that was.
pub fn cell_of<S: Projected>(moment: At<'_, '_, S>) -> Option<NodeId> {
    let of = |note: &Evidence<S>| match note.subject() {
        Subject::Node(node) => Some(node),
        _ => None,
    };
    moment.note.and_then(of).or_else(|| moment.notes.iter().rev().find_map(of))
}
