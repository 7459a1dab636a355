//! How polygons that are cut up in two ways compare on the pixel grid.

use super::DEPTH_TILT;
use super::setup::Plane;
use super::vertex::{Camera, NEEDS_CLIP, Vertex};
use crate::geometry::{Space, Vector, View};

/// A view, for asking what becomes of polygons once corners are snapped.
pub struct Turns(Camera);

impl Turns {
    /// Of a view.
    pub fn new<S: Space>(view: &View<S>) -> Self {
        Self(Camera::new(view))
    }
    /// Whether the triangles that a flat polygon is cut into (or the one segment) may stand for any others
    /// that it is cut into, with the same border: they cover no sample that those do not, and are nearer
    /// than those by no more than twice [`super::DEPTH_SLACK`].
    ///
    /// The triangles of either cut, by the signs of the ways round that they turn, cover a sample as often in
    /// sum as the border winds around it. If none of these turns another way than the others (flat ones turn
    /// neither way), what one of them covers the border winds around, so one of the others covers it too.
    /// Snapping may turn a narrow triangle over; it would cover what the border leaves out.
    ///
    /// A fragment's depth is that of a point of the plane within half a grid step. So it must not be steep:
    /// half a step changes its depth by [`DEPTH_TILT`] at most.
    pub fn may_stand_for<V: Vector>(&self, triangles: impl IntoIterator<Item = [V; 3]>) -> bool {
        let vertices = |t: [V; 3]| t.map(|p| self.0.vertex(self.0.clip(p)));
        let triangles: Vec<[Vertex; 3]> = triangles.into_iter().map(vertices).collect();
        let all = triangles.as_flattened();
        if all.iter().any(|v| v.outside() & NEEDS_CLIP != 0) {
            return false;
        }
        // A little less than what the rasterizer allows, so that rounding makes none of the others steep.
        let gentle = 0.9 * DEPTH_TILT * f64::from(all.iter().fold(f32::INFINITY, |low, v| low.min(v.z)));
        let mut way = 0;
        triangles.iter().all(|[a, b, c]| {
            // Exact: on the guard band differences stay below 2²³.
            let to = |x: i32, from: i32| i64::from(x) - i64::from(from);
            let area = to(b.x, a.x) * to(c.y, a.y) - to(b.y, a.y) * to(c.x, a.x);
            if area.signum() * way < 0 {
                return false;
            }
            way = if area == 0 { way } else { area.signum() };
            let plane = if area != 0 {
                Plane::of([a, b, c])
            } else if V::AXES == 2 && a.x != b.x {
                Plane::of_segment(*a, *b)
            } else {
                // It covers nothing.
                return true;
            };
            (f64::from(plane.dx).abs() + f64::from(plane.dy).abs()) * 0.5 <= gentle
        })
    }
}
