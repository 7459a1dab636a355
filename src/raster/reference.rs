//! The z-buffer in the plainest code, which the fast one must equal byte for byte.
//!
//! Per pixel: 128-bit edge functions and the depth formula as it is written down. It shares projection,
//! clipping and the depth plane's coefficients with the fast code, since they define the image.
//! Cost: O(primitives × pixels in their boxes).

use super::frame::clip;
use super::line::segment;
use super::setup::{Plane, area, center};
use super::vertex::{Camera, Vertex};
use super::{Options, Target, check_size};
use crate::geometry::{Flat, PrimId, Solid, View, orient3d};
use crate::scene::Scene;

/// Triangles into an image; see [`super::Drawable::draw_reference`].
pub(super) fn draw_image(
    target: &mut Target,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
    options: &Options,
) {
    check_size(target, view);
    let camera = Camera::new(view);
    for &prim in prims {
        let Some(corners) = scene.corners(prim) else { continue };
        let [a, b, c] = corners.map(|c| scene.points()[c as usize]);
        if options.surfaces.show_through(scene, prim) {
            target.through.push(prim);
            continue;
        }
        if options.surfaces.one_sided
            && !scene.is_two_sided(prim)
            && orient3d(a.as_dvec3(), b.as_dvec3(), c.as_dvec3(), view.eye.position.as_dvec3()) <= 0.0
        {
            continue;
        }
        // Clipping leaves a triangle that needs none as it is.
        for triangle in clip(&camera, [a, b, c].map(|p| camera.clip(p))) {
            draw_triangle(target, triangle, prim.0);
        }
    }
}

fn draw_triangle(target: &mut Target, v: [Vertex; 3], id: u32) {
    let area = area([&v[0], &v[1], &v[2]]);
    if area == 0 {
        return;
    }
    // From the corners as given: which of two equally far vertices it starts from is part of the formula.
    let plane = Plane::of([&v[0], &v[1], &v[2]]);
    let [a, b, c] = if area > 0 { v } else { [v[0], v[2], v[1]] };
    // A pixel more than needed on each side; `covers` decides.
    let range = |low: i32, high: i32, size: u32| (low / 256 - 1).max(0)..(high / 256 + 2).min(size as i32);
    for y in range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), target.height) {
        for x in range(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), target.width) {
            if covers(a, b, x, y) && covers(b, c, x, y) && covers(c, a, x, y) {
                put(target, x, y, &plane, id);
            }
        }
    }
}

/// Whether a pixel's center lies on the inner side of an edge, or on it where it is a top or left edge.
fn covers(from: Vertex, to: Vertex, x: i32, y: i32) -> bool {
    let (dx, dy) = (i128::from(to.x) - i128::from(from.x), i128::from(to.y) - i128::from(from.y));
    let (px, py) = (i128::from(center(x)) - i128::from(from.x), i128::from(center(y)) - i128::from(from.y));
    // 128 bits, so that no bound on coordinates has to be argued.
    let side = dx * py - dy * px;
    let (is_left, is_top) = (dy < 0, dy == 0 && dx > 0);
    side > 0 || side == 0 && (is_left || is_top)
}

/// Keeps the nearer of what is there and the primitive, at equal depth the lower id.
fn put(target: &mut Target, x: i32, y: i32, plane: &Plane, id: u32) {
    let across = plane.dx * (center(x) - plane.x) as f32;
    let down = plane.dy * (center(y) - plane.y) as f32;
    let z = ((plane.z + down) + across).max(plane.low).min(plane.high);
    let at = y as usize * target.width as usize + x as usize;
    if z > target.depth[at] || z == target.depth[at] && id < target.item[at] {
        (target.depth[at], target.item[at]) = (z, id);
    }
}

/// Segments into a line of pixels; see [`super::Drawable::draw_reference`].
pub(super) fn draw_line(
    target: &mut Target,
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prims: &[PrimId],
    options: &Options,
) {
    check_size(target, view);
    let camera = Camera::new(view);
    for &prim in prims {
        let Some([a, b]) = segment(&camera, scene, view, prim, options) else { continue };
        if options.surfaces.show_through(scene, prim) {
            target.through.push(prim);
            continue;
        }
        let (left, right) = (a.x.min(b.x), a.x.max(b.x));
        for x in 0..view.width as i32 {
            if left <= center(x) && center(x) < right {
                let plane = Plane::of_segment(a, b);
                // Row 0, where the plane does not change downwards.
                put(target, x, 0, &plane, prim.0);
            }
        }
    }
}
