//! Segments into a line of pixels: the flatland image.
//!
//! The rules of the image, one dimension down: a segment covers the centers from its left end (included)
//! to its right end (excluded); one seen end-on covers none.

use super::setup::{Plane, center, pixels};
use super::vertex::{Camera, NEEDS_CLIP, REJECTS, Vertex};
use super::{Options, Target, check_size};
use crate::geometry::{Flat, PrimId, View, orient2d};
use crate::scene::Scene;

/// Draws segments; see [`super::Drawable::draw`]. A line has few pixels and no rows to share out, so it
/// runs on one thread.
pub(super) fn draw(target: &mut Target, scene: &Scene<Flat>, view: &View<Flat>, prims: &[PrimId], options: &Options) {
    check_size(target, view);
    let camera = Camera::new(view);
    for &prim in prims {
        let Some([a, b]) = segment(&camera, scene, view, prim, options) else { continue };
        // Left-inclusive: a center exactly under the right end belongs to the next segment.
        let (first, past) = pixels(a.x.min(b.x), a.x.max(b.x) - 1, view.width as i32);
        if first >= past {
            continue;
        }
        let plane = Plane::of_segment(a, b);
        let covered = first as usize..past as usize;
        for ((x, depth), item) in (first..past).zip(&mut target.depth[covered.clone()]).zip(&mut target.item[covered]) {
            let z = (plane.z + plane.dx * (center(x) - plane.x) as f32).max(plane.low).min(plane.high);
            if z > *depth || z == *depth && prim.0 < *item {
                (*depth, *item) = (z, prim.0);
            }
        }
    }
}

/// The ends of a segment on the grid, clipped if need be; `None` if it is out of view, dropped, or shows
/// its back and that is culled.
pub(super) fn segment(camera: &Camera, scene: &Scene<Flat>, view: &View<Flat>, prim: PrimId, options: &Options) -> Option<[Vertex; 2]> {
    let points = scene.corners(prim)?.map(|c| scene.points()[c as usize]);
    let clip = points.map(|p| camera.clip(p));
    let [a, b] = clip.map(|c| camera.vertex(c));
    if a.outside & b.outside & REJECTS != 0 {
        return None;
    }
    let [p, q] = points.map(|p| p.as_dvec2());
    if options.backface_culling && orient2d(p, q, view.eye.position.as_dvec2()) <= 0.0 {
        return None;
    }
    if (a.outside | b.outside) & NEEDS_CLIP == 0 {
        return Some([a, b]);
    }
    match *camera.clipped(&clip).corners() {
        [a, b] => Some([a, b].map(|c| camera.clipped_vertex(c))),
        _ => None,
    }
}
