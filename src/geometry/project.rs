//! A box on the screen: a conservative rectangle and its nearest depth.

use super::{Aabb, Projection, Vector};

/// Where a box falls in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Footprint {
    /// Part of the box is nearer than the near plane (or the eye is in it): no finite rectangle
    /// bounds it, so it must be taken as covering everything at depth `near`.
    CrossesNear,
    /// Wholly before the near plane, beyond the far plane or beside the image.
    Outside,
    /// Everything of the box that is in view lies in this rectangle and no nearer than this depth.
    Rect(ScreenRect),
}

/// Half-open pixel rectangle `x0..x1` by `y0..y1`, row 0 at the top, with the nearest view depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenRect {
    /// First column.
    pub x0: u32,
    /// Past the last column.
    pub x1: u32,
    /// First row; 0 in flatland.
    pub y0: u32,
    /// Past the last row; 1 in flatland.
    pub y1: u32,
    /// A view depth that no point of the box is nearer than, world units.
    pub nearest_depth: f32,
}

/// Pixels added on each side: projected coordinates of points in view carry a relative error of a few
/// ulp of 1 (all arithmetic is relative to the eye), times half the image; 1/64 pixel covers that and
/// the rasterizer's 1/256-pixel grid up to 16384 pixels.
const MARGIN_PX: f32 = 1.0 / 64.0;
/// Relative allowance on depths: 16 half-ulps, as for the frustum's planes.
const DEPTH_SLACK: f32 = 16.0 * (f32::EPSILON * 0.5);

/// Projects a box conservatively into an image of `width` by `height` pixels (`height` 1 in flatland).
pub fn project_box<V: Vector>(projection: &Projection<V>, bounds: &Aabb<V>, near: f32, far: f32, width: u32, height: u32) -> Footprint {
    let image_axes = V::AXES - 1;
    let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    let (mut nearest, mut farthest, mut size) = (f32::INFINITY, f32::NEG_INFINITY, 0f32);
    for corner in bounds.corners() {
        let clip = projection.clip(corner);
        let w = clip.get(image_axes);
        nearest = nearest.min(w);
        farthest = farthest.max(w);
        size = size.max((corner - projection.eye).length());
        for a in 0..image_axes {
            low[a] = low[a].min(clip.get(a) / w);
            high[a] = high[a].max(clip.get(a) / w);
        }
    }
    let slack = size * DEPTH_SLACK;
    if farthest < near - slack || nearest > far + slack {
        return Footprint::Outside;
    }
    if nearest <= near + slack {
        return Footprint::CrossesNear;
    }
    // A centre c + ½ is covered at most where the closed interval reaches it.
    let span = |from: f32, to: f32, pixels: u32| {
        let at = |v: f32| (v * 0.5 + 0.5) * pixels as f32;
        let first = (at(from) - MARGIN_PX).floor().clamp(0.0, pixels as f32);
        let last = (at(to) + MARGIN_PX).ceil().clamp(0.0, pixels as f32);
        (first as u32, last as u32)
    };
    let (x0, x1) = span(low[0], high[0], width);
    let (y0, y1) = if image_axes == 2 { span(-high[1], -low[1], height) } else { (0, 1) };
    if x0 >= x1 || y0 >= y1 {
        return Footprint::Outside;
    }
    Footprint::Rect(ScreenRect { x0, x1, y0, y1, nearest_depth: (nearest - slack).max(near) })
}
