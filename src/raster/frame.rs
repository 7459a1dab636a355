//! From primitives to triangles on the grid.
//!
//! Primitives out of view or turned away are dropped, and those that leave the grid are clipped. What is left
//! goes to whoever takes it ([`Taker`]): some set it up at once, some look first where it goes.

use glam::Vec3;

use super::setup::{Setup, center};
use super::vertex::{Camera, Clip, NEEDS_CLIP, REJECTS, Vertex};
use super::{Extent, Options, fill};
use crate::geometry::{PixelRect, PrimId, Solid, View, orient3d};
use crate::scene::{Scene, Surfaces};

/// What every part of a draw reads.
pub(super) struct Frame<'a> {
    pub scene: &'a Scene<Solid>,
    pub view: &'a View<Solid>,
    pub camera: Camera,
    /// All points projected, or none: then each primitive projects its own.
    pub vertices: &'a [Vertex],
    pub surfaces: Surfaces,
    /// Whether light comes through any primitive; else none is asked.
    pub any_through: bool,
    /// Nothing is drawn outside.
    pub window: PixelRect,
}

/// Primitives whose corners are read at a time.
const BATCH: usize = 64;

/// A triangle on the grid.
#[derive(Clone, Copy)]
pub(super) struct Triangle<'a> {
    pub v: [&'a Vertex; 3],
    /// Which of the frame's vertices these are; none where they are its own.
    pub at: Option<[u32; 3]>,
    pub id: u32,
    /// Whether it is the whole primitive, not a part that clipping left.
    pub whole: bool,
}

/// Who goes on with triangles.
pub(super) trait Taker {
    fn take(&mut self, frame: &Frame, triangle: Triangle);
}

impl Taker for Vec<Setup> {
    #[inline(always)]
    fn take(&mut self, frame: &Frame, t: Triangle) {
        self.extend(Setup::new(t.v, t.id, t.whole, &frame.window));
    }
}

impl Frame<'_> {
    /// Hands over the primitives that may cover a pixel, several times where clipping cuts one up.
    #[inline(always)]
    pub fn find(&self, prims: &[PrimId], taker: &mut impl Taker) {
        let mut live = [(PrimId(0), [0; 3]); BATCH];
        let mut own = [Vertex::default(); 3 * BATCH];
        let mut points = [Vec3::ZERO; 3 * BATCH];
        for prims in prims.chunks(BATCH) {
            // Corners are scattered in memory: read by themselves, many are under way at a time.
            let mut count = 0;
            for &prim in prims {
                if let Some(corners) = self.scene.corners(prim) {
                    live[count] = (prim, corners);
                    count += 1;
                }
            }
            let live = &live[..count];
            if self.vertices.is_empty() {
                for (points, (_, corners)) in points.chunks_exact_mut(3).zip(live) {
                    for (point, &c) in points.iter_mut().zip(corners) {
                        *point = self.scene.points()[c as usize];
                    }
                }
                // Side by side, many are projected at a time.
                for (own, &point) in own.iter_mut().zip(&points[..3 * count]) {
                    *own = self.camera.vertex(self.camera.clip(point));
                }
            }
            for (&(prim, corners), own) in live.iter().zip(own.chunks_exact(3)) {
                self.find_one(prim, corners, own, taker);
            }
        }
    }

    #[inline(always)]
    fn find_one(&self, prim: PrimId, corners: [u32; 3], own: &[Vertex], taker: &mut impl Taker) {
        let [a, b, c] = [corners[0] as usize, corners[1] as usize, corners[2] as usize];
        let (v, at) = if self.vertices.is_empty() {
            ([&own[0], &own[1], &own[2]], None)
        } else {
            ([&self.vertices[a], &self.vertices[b], &self.vertices[c]], Some(corners))
        };
        // All three corners beyond one plane: the cheap test, which drops most. The exact side of the eye
        // comes second, since it is slow.
        if v[0].outside() & v[1].outside() & v[2].outside() & REJECTS != 0
            || self.surfaces.one_sided && !self.shows_front(prim, corners)
        {
            return;
        }
        // Sides of the image need no clipping: the pixel box is cut to the window. The near plane does, and
        // the guard band, which is wider than any image; so clipping is rare.
        if (v[0].outside() | v[1].outside() | v[2].outside()) & NEEDS_CLIP == 0 {
            taker.take(self, Triangle { v, at, id: prim.0, whole: true });
        } else {
            self.find_clipped(prim, corners, taker);
        }
    }

    // Out of line, as the one below: rare, and not worth a copy for each instruction set.
    #[inline(never)]
    fn find_clipped(&self, prim: PrimId, corners: [u32; 3], taker: &mut impl Taker) {
        let corners = corners.map(|c| self.camera.clip(self.scene.points()[c as usize]));
        for [a, b, c] in clip(&self.camera, corners) {
            taker.take(self, Triangle { v: [&a, &b, &c], at: None, id: prim.0, whole: false });
        }
    }

    /// Whether a triangle is to be filled: what lets light through hides nothing.
    #[inline(always)]
    pub fn fills(&self, id: u32) -> bool {
        !(self.any_through && self.scene.is_see_through(PrimId(id)))
    }

    /// Whether the eye lies strictly on the side from which the corners run counter-clockwise, or there are
    /// two fronts.
    #[inline(never)]
    fn shows_front(&self, prim: PrimId, corners: [u32; 3]) -> bool {
        if self.scene.is_two_sided(prim) {
            return true;
        }
        let [a, b, c] = corners.map(|c| self.scene.points()[c as usize].as_dvec3());
        orient3d(a, b, c, self.view.eye.position.as_dvec3()) > 0.0
    }
}

/// The pixels that a triangle can cover and its nearest depth; see [`super::Drawable::extent`].
pub(super) fn extent(
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prim: PrimId,
    options: &Options,
) -> Option<Extent> {
    let setups = set_up_alone(scene, view, prim, options);
    // Clipping may leave several triangles, or one that is not the whole primitive.
    let [setup] = setups[..] else { return None };
    setup.whole.then(|| Extent { pixels: setup.rect(), nearest: setup.plane.high })
}

/// A primitive made ready by itself: the triangles that clipping leaves of it.
fn set_up_alone(scene: &Scene<Solid>, view: &View<Solid>, prim: PrimId, options: &Options) -> Vec<Setup> {
    let (camera, window) = (Camera::new(view), options.window_of(view));
    let surfaces = options.surfaces;
    let frame = Frame { scene, view, camera, vertices: &[], surfaces, any_through: false, window };
    let mut setups = Vec::new();
    frame.find(&[prim], &mut setups);
    setups
}

/// The pixels that a primitive covers, with its depth there; see [`super::Drawable::fragments`].
pub(super) fn fragments(
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prim: PrimId,
    options: &Options,
    visit: &mut dyn FnMut(usize, f32),
) {
    for s in set_up_alone(scene, view, prim, options) {
        let inverse = s.edges.map(|e| e.inverse());
        for y in s.y0..s.y1 {
            let (mut begin, mut end) = ([0; 1], [s.x1 - s.x0; 1]);
            for (edge, &inverse) in s.edges.iter().zip(&inverse) {
                fill::narrow(edge, inverse, y - s.y0, &mut begin, &mut end);
            }
            let row = y as usize * view.width as usize;
            for x in s.x0 + begin[0]..s.x0 + end[0] {
                // The formula that [`super::reference`] writes down.
                let along = s.plane.dx * (center(x) - s.plane.x) as f32;
                visit(row + x as usize, (s.plane.at_row(y) + along).max(s.plane.low).min(s.plane.high));
            }
        }
    }
}

/// The triangles of what clipping leaves of a triangle, as a fan from its least corner: the same ones
/// wherever the triangle's corners begin and whichever way round they run.
pub(super) fn clip(camera: &Camera, corners: [Clip; 3]) -> impl Iterator<Item = [Vertex; 3]> {
    let polygon = camera.clipped(&corners);
    let corners = polygon.corners();
    let least = (1..corners.len()).fold(0, |least, i| if corners[i] < corners[least] { i } else { least });
    let mut fan = [Vertex::default(); 8];
    for (to, &from) in fan.iter_mut().zip(corners.iter().cycle().skip(least).take(corners.len())) {
        *to = camera.clipped_vertex(from);
    }
    (2..polygon.corners().len()).map(move |i| [fan[0], fan[i - 1], fan[i]])
}
