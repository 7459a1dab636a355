//! Segments into a line of pixels: the flatland image.
//!
//! The rules of the image, one dimension down: a segment covers the centers from its left end (included)
//! to its right end (excluded); one seen end-on covers none.

use super::setup::{Plane, center, pixels};
use super::vertex::{Camera, Clip, NEEDS_CLIP, REJECTS, Vertex};
use super::{Extent, Options, Target, check_size};
use crate::geometry::{Flat, PixelRect, PrimId, View, orient2d};
use crate::scene::Scene;

/// Draws segments; see [`super::Drawable`]. A line has few pixels
/// and no rows to share out, so it runs on one thread.
pub(super) fn draw(
    target: &mut Target,
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prims: &[PrimId],
    options: &Options,
) {
    check_size(target, view);
    let camera = Camera::new(view);
    for &prim in prims {
        let Some(Seen { pixels, plane, .. }) = set_up(&camera, scene, view, prim, options) else {
            continue;
        };
        // What lets light through hides nothing.
        if options.surfaces.show_through(scene, prim) {
            target.through.push(prim);
            continue;
        }
        for x in pixels.x0..pixels.x1 {
            let z = depth_at(&plane, x);
            let (depth, item) = (&mut target.depth[x as usize], &mut target.item[x as usize]);
            if z > *depth || z == *depth && prim.0 < *item {
                (*depth, *item) = (z, prim.0);
            }
        }
    }
}

/// The pixels that a segment can cover and its nearest depth; see [`super::Drawable::extent`].
pub(super) fn extent(
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prim: PrimId,
    options: &Options,
) -> Option<Extent> {
    let Seen { pixels, plane, whole } = set_up(&Camera::new(view), scene, view, prim, options)?;
    whole.then_some(Extent { pixels, nearest: plane.high })
}

/// The pixels that a segment covers, with its depth there; see [`super::Drawable::fragments`].
pub(super) fn fragments(
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prim: PrimId,
    options: &Options,
    visit: &mut dyn FnMut(usize, f32),
) {
    if let Some(Seen { pixels, plane, .. }) = set_up(&Camera::new(view), scene, view, prim, options) {
        (pixels.x0..pixels.x1).for_each(|x| visit(x as usize, depth_at(&plane, x)));
    }
}

/// The formula of [`super::reference`]; clamped, so that no pixel is nearer than `plane.high`, an end.
pub(super) fn depth_at(plane: &Plane, x: u32) -> f32 {
    (plane.z + plane.dx * (center(x as i32) - plane.x) as f32).max(plane.low).min(plane.high)
}

/// A segment ready to be drawn.
struct Seen {
    pixels: PixelRect,
    plane: Plane,
    /// Whether clipping left it as it is.
    whole: bool,
}

/// The pixels of `from..to` that a segment covers, half-open.
pub(super) fn columns(a: &Vertex, b: &Vertex, from: u32, to: u32) -> (i32, i32) {
    // Left-inclusive: a center exactly under the right end belongs to the next segment.
    pixels(a.x.min(b.x), a.x.max(b.x) - 1, from, to)
}

/// Makes a segment ready; `None` if it covers no center.
fn set_up(
    camera: &Camera,
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prim: PrimId,
    options: &Options,
) -> Option<Seen> {
    let ([a, b], whole) = clipped(camera, scene, view, prim, options)?;
    let window = options.window_of(view);
    let (first, past) = columns(&a, &b, window.x0, window.x1);
    let pixels = PixelRect { x0: first.max(0) as u32, x1: past.max(0) as u32, y0: 0, y1: 1 };
    // A segment seen end-on, or between two centers, covers nothing.
    (first < past).then(|| Seen { pixels, plane: Plane::of_segment(a, b), whole })
}

/// The ends of a segment on the grid, clipped if need be; `None` if it is out of view, dropped, or shows
/// its back and that is culled.
pub(super) fn segment(
    camera: &Camera,
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prim: PrimId,
    options: &Options,
) -> Option<[Vertex; 2]> {
    clipped(camera, scene, view, prim, options).map(|(ends, _)| ends)
}

/// The same, and whether clipping left the segment whole.
fn clipped(
    camera: &Camera,
    scene: &Scene<Flat>,
    view: &View<Flat>,
    prim: PrimId,
    options: &Options,
) -> Option<([Vertex; 2], bool)> {
    let points = scene.corners(prim)?.map(|c| scene.points()[c as usize]);
    let clip = points.map(|p| camera.clip(p));
    let [a, b] = clip.map(|c| camera.vertex(c));
    // In the order of cost, as for triangles.
    if a.outside() & b.outside() & REJECTS != 0 {
        return None;
    }
    let [p, q] = points.map(|p| p.as_dvec2());
    if options.surfaces.one_sided
        && !scene.is_two_sided(prim)
        && orient2d(p, q, view.eye.position.as_dvec2()) <= 0.0
    {
        return None;
    }
    if (a.outside() | b.outside()) & NEEDS_CLIP == 0 {
        return Some(([a, b], true));
    }
    cut(camera, &clip).map(|ends| (ends, false))
}

/// The ends of what clipping leaves of a segment.
pub(super) fn cut(camera: &Camera, ends: &[Clip; 2]) -> Option<[Vertex; 2]> {
    // Two ends are left, or none.
    match *camera.clipped(ends).corners() {
        [a, b] => Some([a, b].map(|c| camera.clipped_vertex(c))),
        _ => None,
    }
}
