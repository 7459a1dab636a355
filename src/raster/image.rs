//! Triangles into an image.
//!
//! One thread: each triangle is set up and filled at once. Several: triangles are set up in chunks, then
//! bands of rows are filled, each by one thread, from all chunks. Both call the same two functions,
//! [`Frame::set_up`] and [`fill`], and a pixel keeps its winner whatever the order, so the bytes are equal.
//!
//! Rows of a small triangle are one vector: three edge functions, one mask. Rows of a wide one are spans,
//! whose ends follow from the edge functions by an exact division; then no edge is looked at per pixel.

use rayon::prelude::*;

use super::setup::{Setup, center};
use super::simd::{self, Lanes, Work};
use super::vertex::{Camera, Clip, NEEDS_CLIP, REJECTS, SUBPIXEL_BITS, Vertex};
use super::{Options, Target, check_size};
use crate::geometry::{PrimId, Solid, View, orient3d};
use crate::scene::Scene;

/// Buffers kept from draw to draw, so that drawing again takes no memory.
#[derive(Default)]
pub(super) struct Scratch {
    vertices: Vec<Vertex>,
    setups: Vec<Setup>,
    chunks: Vec<Chunk>,
}

/// The triangles that survive set-up, of a part of the primitives, and which of them each band needs.
#[derive(Default)]
struct Chunk {
    setups: Vec<Setup>,
    bands: Vec<Vec<u32>>,
}

/// Primitives in a chunk: enough that a chunk's cost hides its hand-over.
const CHUNK_PRIMS: usize = 4096;
/// Triangles set up before they are filled, on one thread: 25 KiB, which the first cache holds.
const BATCH_PRIMS: usize = 256;
/// Rows that memory is asked for ahead.
const PREFETCH_ROWS: usize = 2;
/// Rows in a band: at 1024 columns its depth and items take 256 KiB, which a core's cache holds.
const BAND_ROWS: usize = 32;

/// Draws triangles; see [`super::Drawable::draw`].
pub(super) fn draw(target: &mut Target, scene: &Scene<Solid>, view: &View<Solid>, prims: &[PrimId], options: &Options) {
    check_size(target, view);
    let threads = if options.threads == 0 { rayon::current_num_threads() } else { options.threads };
    let mut scratch = std::mem::take(&mut target.scratch);
    let camera = Camera::new(view);
    // A small subset projects its own corners; both ways call the same function.
    let points = if prims.len() * 2 >= scene.points().len() { scene.points() } else { &[] };
    scratch.vertices.resize(points.len(), Vertex::default());
    if threads <= 1 {
        simd::run(options.isa, Project { camera: &camera, points, vertices: &mut scratch.vertices });
    } else {
        let part = points.len().div_ceil(threads * 4).max(1024);
        let parts = points.par_chunks(part).zip(scratch.vertices.par_chunks_mut(part));
        parts.for_each(|(points, vertices)| simd::run(options.isa, Project { camera: &camera, points, vertices }));
    }
    let frame = Frame { scene, view, camera, vertices: &scratch.vertices, backface_culling: options.backface_culling };
    if threads <= 1 {
        let band = Band { depth: &mut target.depth, item: &mut target.item, first_row: 0, width: view.width as usize };
        simd::run(options.isa, DrawAll { frame: &frame, prims, setups: &mut scratch.setups, band });
    } else {
        draw_in_bands(&mut scratch.chunks, &frame, prims, target, options);
    }
    target.scratch = scratch;
}

/// Set-up by chunks of primitives, then filling by bands of rows.
fn draw_in_bands(chunks: &mut Vec<Chunk>, frame: &Frame, prims: &[PrimId], target: &mut Target, options: &Options) {
    let width = target.width as usize;
    let bands = (target.height as usize).div_ceil(BAND_ROWS);
    chunks.resize_with(prims.len().div_ceil(CHUNK_PRIMS), Chunk::default);
    chunks.par_iter_mut().zip(prims.par_chunks(CHUNK_PRIMS)).for_each(|(chunk, prims)| {
        chunk.setups.clear();
        chunk.bands.resize_with(bands, Vec::new);
        chunk.bands.iter_mut().for_each(Vec::clear);
        simd::run(options.isa, SetUp { frame, prims, chunk });
    });
    let rows = target.depth.par_chunks_mut(width * BAND_ROWS).zip(target.item.par_chunks_mut(width * BAND_ROWS));
    rows.enumerate().for_each(|(number, (depth, item))| {
        let band = Band { depth, item, first_row: (number * BAND_ROWS) as i32, width };
        simd::run(options.isa, FillBand { chunks, number, band });
    });
}

/// What every part of a draw reads.
struct Frame<'a> {
    scene: &'a Scene<Solid>,
    view: &'a View<Solid>,
    camera: Camera,
    /// All points projected, or none: then each triangle projects its own.
    vertices: &'a [Vertex],
    backface_culling: bool,
}

impl Frame<'_> {
    /// Appends the primitives that may cover a pixel, several times where clipping cuts one up.
    #[inline(always)]
    fn set_up(&self, prims: &[PrimId], setups: &mut Vec<Setup>) {
        let (width, height) = (self.view.width as i32, self.view.height as i32);
        for &prim in prims {
            let Some(corners) = self.scene.corners(prim) else { continue };
            let own;
            let [a, b, c] = if self.vertices.is_empty() {
                own = self.project(corners);
                [&own[0], &own[1], &own[2]]
            } else {
                [&self.vertices[corners[0] as usize], &self.vertices[corners[1] as usize], &self.vertices[corners[2] as usize]]
            };
            if a.outside & b.outside & c.outside & REJECTS != 0 || self.backface_culling && !self.shows_front(corners) {
                continue;
            }
            if (a.outside | b.outside | c.outside) & NEEDS_CLIP == 0 {
                setups.extend(Setup::new([a, b, c], prim.0, width, height));
            } else {
                self.set_up_clipped(prim, corners, setups);
            }
        }
    }

    #[inline(never)]
    fn project(&self, corners: [u32; 3]) -> [Vertex; 3] {
        corners.map(|c| self.camera.vertex(self.camera.clip(self.scene.points()[c as usize])))
    }

    #[inline(never)]
    fn set_up_clipped(&self, prim: PrimId, corners: [u32; 3], setups: &mut Vec<Setup>) {
        let (width, height) = (self.view.width as i32, self.view.height as i32);
        let corners = corners.map(|c| self.camera.clip(self.scene.points()[c as usize]));
        setups.extend(clip(&self.camera, corners).filter_map(|[a, b, c]| Setup::new([&a, &b, &c], prim.0, width, height)));
    }

    /// Whether the eye lies strictly on the side from which the corners run counter-clockwise.
    #[inline(never)]
    fn shows_front(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|c| self.scene.points()[c as usize].as_dvec3());
        orient3d(a, b, c, self.view.eye.position.as_dvec3()) > 0.0
    }
}

/// The triangles of what clipping leaves of a triangle, as a fan.
pub(super) fn clip(camera: &Camera, corners: [Clip; 3]) -> impl Iterator<Item = [Vertex; 3]> {
    let polygon = camera.clipped(&corners);
    let mut fan = [Vertex::default(); 8];
    for (to, &from) in fan.iter_mut().zip(polygon.corners()) {
        *to = camera.clipped_vertex(from);
    }
    (2..polygon.corners().len()).map(move |i| [fan[0], fan[i - 1], fan[i]])
}

/// Some rows of the image.
struct Band<'a> {
    depth: &'a mut [f32],
    item: &'a mut [u32],
    first_row: i32,
    width: usize,
}

/// Fills the rows of a triangle that lie in the band.
#[inline(always)]
fn fill<L: Lanes>(l: L, s: &Setup, band: &mut Band) {
    let y0 = s.y0.max(band.first_row);
    let y1 = s.y1.min(band.first_row + (band.depth.len() / band.width) as i32);
    if s.narrow && s.x1 - s.x0 <= L::N as i32 {
        fill_small(l, s, band, y0, y1);
    } else {
        fill_spans(l, s, band, y0, y1);
    }
}

/// Rows that fit a vector, with 32-bit edge functions.
#[inline(always)]
fn fill_small<L: Lanes>(l: L, s: &Setup, band: &mut Band, y0: i32, y1: i32) {
    let columns = (s.x1 - s.x0) as usize;
    // Closures would not be compiled for the instruction set, so the three edges are written out.
    let [a, b, c] = &s.edges;
    let skipped = y0 - s.y0;
    let mut edge_a = l.ramp(a.at as i32 + a.dy * skipped, a.dx);
    let mut edge_b = l.ramp(b.at as i32 + b.dy * skipped, b.dx);
    let mut edge_c = l.ramp(c.at as i32 + c.dy * skipped, c.dx);
    let (step_a, step_b, step_c) = (l.splat_i(a.dy), l.splat_i(b.dy), l.splat_i(c.dy));
    let along = l.mul(l.splat(s.plane.dx), l.ramp_f(center(s.x0) - s.plane.x, 1 << SUBPIXEL_BITS));
    let (low, high) = (l.splat(s.plane.low), l.splat(s.plane.high));
    for y in y0..y1 {
        let at = (y - band.first_row) as usize * band.width + s.x0 as usize;
        let inside = l.none_negative(edge_a, edge_b, edge_c);
        let z = l.clamp(l.add(l.splat(s.plane.at_row(y)), along), low, high);
        l.merge(&mut band.depth[at..at + columns], &mut band.item[at..at + columns], inside, z, s.id);
        (edge_a, edge_b, edge_c) = (l.add_i(edge_a, step_a), l.add_i(edge_b, step_b), l.add_i(edge_c, step_c));
    }
}

/// Rows of any width, from the exact ends of their spans.
#[inline(always)]
fn fill_spans<L: Lanes>(l: L, s: &Setup, band: &mut Band, y0: i32, y1: i32) {
    let inverse = [s.edges[0].inverse(), s.edges[1].inverse(), s.edges[2].inverse()];
    let (low, high, slope) = (l.splat(s.plane.low), l.splat(s.plane.high), l.splat(s.plane.dx));
    let ahead = band.width * PREFETCH_ROWS;
    for y in y0..y1 {
        let (mut begin, mut end) = (0, s.x1 - s.x0);
        for (edge, &inverse) in s.edges.iter().zip(&inverse) {
            let e = edge.at + i64::from(edge.dy) * i64::from(y - s.y0);
            if edge.dx > 0 {
                begin = begin.max(-quotient(e, inverse));
            } else if edge.dx < 0 {
                end = end.min(quotient(e, inverse) + 1);
            } else if e < 0 {
                end = 0;
            }
        }
        let row = (y - band.first_row) as usize * band.width;
        let base = l.splat(s.plane.at_row(y));
        let (mut x, end) = (s.x0 + begin, s.x0 + end);
        while x < end {
            let at = row + x as usize;
            let past = row + end.min(x + L::N as i32) as usize;
            // Rows are a page apart, which hardware does not foresee.
            l.prefetch(band.depth.get(at + ahead));
            l.prefetch(band.item.get(at + ahead));
            let along = l.mul(slope, l.ramp_f(center(x) - s.plane.x, 1 << SUBPIXEL_BITS));
            let z = l.clamp(l.add(base, along), low, high);
            l.merge(&mut band.depth[at..past], &mut band.item[at..past], l.all(), z, s.id);
            x += L::N as i32;
        }
    }
}

/// Floor of `e / d`, given `inverse` = 1/d, limited to ±2¹⁶, which is off every image. Exact: edges are
/// shorter than 2²³, so a quotient that is no integer is 2⁻²³ or more below the next one, and the
/// product errs by less than 2⁻³⁴; adding 2⁻²⁶ keeps both on their side.
#[inline(always)]
fn quotient(e: i64, inverse: f64) -> i32 {
    const LIMIT: f64 = 65536.0;
    const NUDGE: f64 = 1.0 / (1 << 26) as f64;
    let q = (e as f64 * inverse + NUDGE).clamp(-LIMIT, LIMIT);
    // Truncation rounds down once the value is not negative.
    (q + LIMIT) as i32 - LIMIT as i32
}

struct Project<'a> {
    camera: &'a Camera,
    points: &'a [glam::Vec3],
    vertices: &'a mut [Vertex],
}

impl Work for Project<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        for (vertex, &point) in self.vertices.iter_mut().zip(self.points) {
            *vertex = self.camera.vertex(self.camera.clip(point));
        }
    }
}

struct DrawAll<'a> {
    frame: &'a Frame<'a>,
    prims: &'a [PrimId],
    setups: &'a mut Vec<Setup>,
    band: Band<'a>,
}

impl Work for DrawAll<'_> {
    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        for prims in self.prims.chunks(BATCH_PRIMS) {
            self.setups.clear();
            self.frame.set_up(prims, self.setups);
            for setup in self.setups.iter() {
                fill(l, setup, &mut self.band);
            }
        }
    }
}

struct SetUp<'a> {
    frame: &'a Frame<'a>,
    prims: &'a [PrimId],
    chunk: &'a mut Chunk,
}

impl Work for SetUp<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Chunk { setups, bands } = self.chunk;
        self.frame.set_up(self.prims, setups);
        for (number, setup) in setups.iter().enumerate() {
            let (first, last) = (setup.y0 as usize / BAND_ROWS, (setup.y1 - 1) as usize / BAND_ROWS);
            bands[first..=last].iter_mut().for_each(|band| band.push(number as u32));
        }
    }
}

struct FillBand<'a> {
    chunks: &'a [Chunk],
    number: usize,
    band: Band<'a>,
}

impl Work for FillBand<'_> {
    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        for chunk in self.chunks {
            for &setup in &chunk.bands[self.number] {
                fill(l, &chunk.setups[setup as usize], &mut self.band);
            }
        }
    }
}
