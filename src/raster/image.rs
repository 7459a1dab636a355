//! Triangles into an image.
//!
//! 1. Points are projected to the pixel grid: all of them, or three for each primitive of a small subset.
//! 2. Primitives out of view or turned away are dropped, those that leave the grid are clipped, and the rest
//!    are set up: pixel box, edge functions, depth plane ([`Frame::set_up`]).
//! 3. With a pyramid, triangles that it proves hidden are left out ([`hides`]).
//! 4. Triangles are filled ([`fill`]). Rows of a small one are one vector: three edge functions, one mask.
//!    Rows of a wide one are spans, whose ends follow from the edge functions by an exact division; then no
//!    edge is evaluated per pixel.
//!
//! One thread runs steps 2 to 4 batch by batch. Several run 2 and 3 on chunks of primitives, then 4 on bands
//! of rows, each band by one thread from all chunks. Both call the same functions, and a pixel keeps its
//! winner whatever the order, so the bytes are equal.

use rayon::prelude::*;

use super::pyramid::Pyramid;
use super::setup::{Edge, Setup, center};
use super::simd::{self, Lanes, Work};
use super::vertex::{Camera, Clip, NEEDS_CLIP, REJECTS, SUBPIXEL_BITS, Vertex};
use super::{Extent, Options, Sieve, Target, check_size};
use crate::geometry::{PixelRect, PrimId, Solid, View, orient3d};
use crate::scene::{Scene, Surfaces};

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
    /// What the pyramid hides.
    hidden: Vec<PrimId>,
    /// What may show, and lets light through.
    through: Vec<PrimId>,
}

/// Primitives in a chunk: enough that its work hides the cost of handing it to a thread.
const CHUNK_PRIMS: usize = 4096;
/// Triangles set up before they are filled, on one thread: 25 KiB, which the first cache holds.
const BATCH_PRIMS: usize = 256;
/// Rows in a band: at 1024 columns its depth and items take 256 KiB, which a core's cache holds.
const BAND_ROWS: usize = 32;

/// Draws triangles, all or those that a pyramid does not hide; see [`super::Drawable`].
pub(super) fn draw(
    target: &mut Target,
    sieve: Option<Sieve>,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
    options: &Options,
) {
    check_size(target, view);
    let threads = if options.threads == 0 { rayon::current_num_threads() } else { options.threads };
    let mut scratch = std::mem::take(&mut target.scratch);
    let camera = Camera::new(view);
    // 1. Projecting every point costs at most two projections a primitive here, and its own corners three.
    // The code is the same either way, and so are the vertices.
    let points = if prims.len() * 2 >= scene.points().len() { scene.points() } else { &[] };
    scratch.vertices.resize(points.len(), Vertex::default());
    if threads <= 1 {
        simd::run(options.isa, Project { camera: &camera, points, vertices: &mut scratch.vertices });
    } else {
        // Four parts a thread, so that one slow part does not keep the others waiting; none so small that
        // handing it over costs more than projecting it.
        let part = points.len().div_ceil(threads * 4).max(1024);
        let parts = points.par_chunks(part).zip(scratch.vertices.par_chunks_mut(part));
        parts.for_each(|(points, vertices)| {
            simd::run(options.isa, Project { camera: &camera, points, vertices })
        });
    }
    // 2 to 4, on the calling thread or on several.
    let window = options.window_of(view);
    let frame = Frame {
        scene,
        view,
        camera,
        vertices: &scratch.vertices,
        surfaces: options.surfaces,
        any_through: options.surfaces.any_through(scene),
        window,
    };
    if threads <= 1 {
        let band = Band {
            depth: &mut target.depth,
            item: &mut target.item,
            first_row: 0,
            width: view.width as usize,
        };
        let (setups, through) = (&mut scratch.setups, &mut target.through);
        simd::run(options.isa, DrawAll { frame: &frame, sieve, prims, setups, through, band });
    } else {
        draw_in_bands(&mut scratch.chunks, &frame, sieve, prims, target, options);
    }
    target.scratch = scratch;
}

/// Set-up by chunks of primitives, then filling by bands of rows.
fn draw_in_bands(
    chunks: &mut Vec<Chunk>,
    frame: &Frame,
    mut sieve: Option<Sieve>,
    prims: &[PrimId],
    target: &mut Target,
    options: &Options,
) {
    let width = target.width as usize;
    let bands = (target.height as usize).div_ceil(BAND_ROWS);
    // 2 and 3. The pyramid is read as it was before the draw: what one chunk draws must not decide what
    // another leaves out, or the list of hidden primitives would depend on timing.
    let held = sieve.as_ref().map(|s| (&*s.pyramid, &target.depth[..]));
    chunks.resize_with(prims.len().div_ceil(CHUNK_PRIMS), Chunk::default);
    chunks.par_iter_mut().zip(prims.par_chunks(CHUNK_PRIMS)).for_each(|(chunk, prims)| {
        chunk.setups.clear();
        chunk.hidden.clear();
        chunk.through.clear();
        chunk.bands.resize_with(bands, Vec::new);
        chunk.bands.iter_mut().for_each(Vec::clear);
        simd::run(options.isa, SetUp { frame, held, prims, chunk });
    });
    // In the order of the chunks, not of the threads that finished them.
    chunks.iter().for_each(|chunk| target.through.extend_from_slice(&chunk.through));
    if let Some(sieve) = &mut sieve {
        for chunk in chunks.iter() {
            sieve.hidden.extend_from_slice(&chunk.hidden);
            chunk.setups.iter().for_each(|s| sieve.pyramid.touch(s.rect()));
        }
    }
    // 4. No pixel lies in two bands, so bands need no locks. Without items each band gets an empty slice.
    let mut items: Vec<&mut [u32]> = target.item.chunks_mut(width * BAND_ROWS).collect();
    items.resize_with(bands, Default::default);
    target.depth.par_chunks_mut(width * BAND_ROWS).zip(items).enumerate().for_each(
        |(number, (depth, item))| {
            let band = Band { depth, item, first_row: (number * BAND_ROWS) as i32, width };
            simd::run(options.isa, FillBand { chunks, number, band });
        },
    );
}

/// What every part of a draw reads.
struct Frame<'a> {
    scene: &'a Scene<Solid>,
    view: &'a View<Solid>,
    camera: Camera,
    /// All points projected, or none: then each triangle projects its own.
    vertices: &'a [Vertex],
    surfaces: Surfaces,
    /// Whether light comes through any primitive; else none is asked.
    any_through: bool,
    /// Nothing is drawn outside.
    window: PixelRect,
}

impl Frame<'_> {
    /// Appends the primitives that may cover a pixel, several times where clipping cuts one up.
    #[inline(always)]
    fn set_up(&self, prims: &[PrimId], setups: &mut Vec<Setup>) {
        for &prim in prims {
            let Some(corners) = self.scene.corners(prim) else { continue };
            // Step 1 for a small subset.
            let own;
            let [a, b, c] = if self.vertices.is_empty() {
                own = self.project(corners);
                [&own[0], &own[1], &own[2]]
            } else {
                [
                    &self.vertices[corners[0] as usize],
                    &self.vertices[corners[1] as usize],
                    &self.vertices[corners[2] as usize],
                ]
            };
            // All three corners beyond one plane: the cheap test, which drops most. The exact side of the eye
            // comes second, since it is slow.
            if a.outside() & b.outside() & c.outside() & REJECTS != 0
                || self.surfaces.one_sided && !self.shows_front(prim, corners)
            {
                continue;
            }
            // Sides of the image need no clipping: the pixel box is cut to the window. The near plane does,
            // and the guard band, which is wider than any image; so clipping is rare.
            if (a.outside() | b.outside() | c.outside()) & NEEDS_CLIP == 0 {
                setups.extend(Setup::new([a, b, c], prim.0, true, &self.window));
            } else {
                self.set_up_clipped(prim, corners, setups);
            }
        }
    }

    // Out of line, as the two below: rare, and not worth a copy for each instruction set.
    #[inline(never)]
    fn project(&self, corners: [u32; 3]) -> [Vertex; 3] {
        corners.map(|c| self.camera.vertex(self.camera.clip(self.scene.points()[c as usize])))
    }

    #[inline(never)]
    fn set_up_clipped(&self, prim: PrimId, corners: [u32; 3], setups: &mut Vec<Setup>) {
        let corners = corners.map(|c| self.camera.clip(self.scene.points()[c as usize]));
        setups.extend(
            clip(&self.camera, corners)
                .filter_map(|[a, b, c]| Setup::new([&a, &b, &c], prim.0, false, &self.window)),
        );
    }

    /// Whether a triangle is to be filled: what lets light through hides nothing.
    #[inline(always)]
    fn fills(&self, setup: &Setup) -> bool {
        !(self.any_through && self.scene.is_see_through(PrimId(setup.id)))
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
    frame.set_up(&[prim], &mut setups);
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
                narrow(edge, inverse, y - s.y0, &mut begin, &mut end);
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

/// Some rows of the image.
struct Band<'a> {
    depth: &'a mut [f32],
    /// Empty where only depths are drawn.
    item: &'a mut [u32],
    first_row: i32,
    width: usize,
}

/// Fills the rows of a triangle that lie in the band; ids too if there are `ITEMS`.
#[inline(always)]
fn fill<const ITEMS: bool, L: Lanes>(l: L, s: &Setup, band: &mut Band) {
    let y0 = s.y0.max(band.first_row);
    let y1 = s.y1.min(band.first_row + (band.depth.len() / band.width) as i32);
    // 4a needs edge functions that fit 32-bit lanes and a box no wider than a vector.
    if s.narrow && s.x1 - s.x0 <= L::N as i32 {
        fill_small::<ITEMS, L>(l, s, band, y0, y1);
    } else {
        fill_spans::<ITEMS, L>(l, s, band, y0, y1);
    }
}

/// Rows that fit a vector, with 32-bit edge functions.
#[inline(always)]
fn fill_small<const ITEMS: bool, L: Lanes>(l: L, s: &Setup, band: &mut Band, y0: i32, y1: i32) {
    let columns = l.first((s.x1 - s.x0) as usize);
    // Closures would not be compiled for the instruction set, so the three edges are written out.
    let [a, b, c] = &s.edges;
    // 4a. The edge functions at the first row's centers; each further row adds the edge's step (Pineda 1988).
    let skipped = y0 - s.y0;
    let mut edge_a = l.ramp(a.at as i32 + a.dy * skipped, a.dx);
    let mut edge_b = l.ramp(b.at as i32 + b.dy * skipped, b.dx);
    let mut edge_c = l.ramp(c.at as i32 + c.dy * skipped, c.dx);
    let (step_a, step_b, step_c) = (l.splat_i(a.dy), l.splat_i(b.dy), l.splat_i(c.dy));
    // What depth adds along the row is the same in every row. It is not summed up step by step: a pixel's
    // depth may depend on its place alone.
    let along = l.mul(l.splat(s.plane.dx), l.to_f(l.ramp(center(s.x0) - s.plane.x, 1 << SUBPIXEL_BITS)));
    let (low, high, ids) = (l.splat(s.plane.low), l.splat(s.plane.high), l.splat_i(s.id as i32));
    for y in y0..y1 {
        let at = (y - band.first_row) as usize * band.width + s.x0 as usize;
        let inside = l.none_negative(edge_a, edge_b, edge_c, columns);
        // No nearer than the nearest vertex, whatever the rounding: the test against the pyramid counts on
        // it.
        let z = l.clamp(l.add(l.splat(s.plane.at_row(y)), along), low, high);
        merge::<ITEMS, L>(l, band, at, inside, z, ids);
        (edge_a, edge_b, edge_c) =
            (l.add_i(edge_a, step_a), l.add_i(edge_b, step_b), l.add_i(edge_c, step_c));
    }
}

/// Neighboring pixels of a band from one on, a vector of them or as many as there are.
#[inline(always)]
fn merge<const ITEMS: bool, L: Lanes>(l: L, band: &mut Band, at: usize, inside: L::M, z: L::F, ids: L::I) {
    // To the end of the band, all of which is ours: so that nearly all vectors are whole ones.
    if ITEMS {
        l.merge(&mut band.depth[at..], &mut band.item[at..], inside, z, ids);
    } else {
        l.merge_depth(&mut band.depth[at..], inside, z);
    }
}

/// Rows whose spans are found at a time: the arithmetic of many rows is SIMD, that of one is not.
const SPAN_ROWS: usize = 16;

/// Rows of any width, from the exact ends of their spans.
#[inline(always)]
fn fill_spans<const ITEMS: bool, L: Lanes>(l: L, s: &Setup, band: &mut Band, y0: i32, y1: i32) {
    // 4b. Three divisions a triangle; spans then take multiplications only.
    let inverse = [s.edges[0].inverse(), s.edges[1].inverse(), s.edges[2].inverse()];
    let (low, high, slope) = (l.splat(s.plane.low), l.splat(s.plane.high), l.splat(s.plane.dx));
    let (ids, next) = (l.splat_i(s.id as i32), l.splat_i((L::N as i32) << SUBPIXEL_BITS));
    let mut y = y0;
    while y < y1 {
        // Each edge cuts off its part of the spans of the next rows.
        let (mut begin, mut end) = ([0; SPAN_ROWS], [s.x1 - s.x0; SPAN_ROWS]);
        for (edge, &inverse) in s.edges.iter().zip(&inverse) {
            narrow(edge, inverse, y - s.y0, &mut begin, &mut end);
        }
        for (k, y) in (y..y1.min(y + SPAN_ROWS as i32)).enumerate() {
            if begin[k] >= end[k] {
                continue;
            }
            let x = s.x0 + begin[k];
            let first = (y - band.first_row) as usize * band.width + x as usize;
            let past = first + (end[k] - begin[k]) as usize;
            let base = l.splat(s.plane.at_row(y));
            let mut way = l.ramp(center(x) - s.plane.x, 1 << SUBPIXEL_BITS);
            // Every pixel between the ends is covered, so no vector but the last needs a mask.
            let depths = band.depth[first..past].chunks_exact_mut(L::N);
            let left = depths.len() * L::N;
            if ITEMS {
                for (depth, item) in depths.zip(band.item[first..past].chunks_exact_mut(L::N)) {
                    let z = l.clamp(l.add(base, l.mul(slope, l.to_f(way))), low, high);
                    l.merge(depth, item, l.first(L::N), z, ids);
                    way = l.add_i(way, next);
                }
            } else {
                for depth in depths {
                    let z = l.clamp(l.add(base, l.mul(slope, l.to_f(way))), low, high);
                    l.merge_depth(depth, l.first(L::N), z);
                    way = l.add_i(way, next);
                }
            }
            if first + left < past {
                let z = l.clamp(l.add(base, l.mul(slope, l.to_f(way))), low, high);
                merge::<ITEMS, L>(l, band, first + left, l.first(past - first - left), z, ids);
            }
        }
        y += SPAN_ROWS as i32;
    }
}

/// Takes from the spans of some rows, the first of them `skipped` rows below the triangle's first, what lies
/// beyond an edge.
#[inline(always)]
fn narrow<const ROWS: usize>(
    edge: &Edge,
    inverse: f64,
    skipped: i32,
    begin: &mut [i32; ROWS],
    end: &mut [i32; ROWS],
) {
    // Edge functions are whole numbers below 2⁴⁸, so doubles hold them and their sums exactly.
    let (at, dy) = (edge.at as f64 + f64::from(edge.dy) * f64::from(skipped), f64::from(edge.dy));
    // The columns with `e + dx · x ≥ 0`. Rising: from ⌈−e / dx⌉ = −⌊e / dx⌋ on.
    if edge.dx > 0 {
        for (k, begin) in begin.iter_mut().enumerate() {
            *begin = (*begin).max(-quotient(at + dy * k as f64, inverse));
        }
    // Falling: up to ⌊e / −dx⌋.
    } else if edge.dx < 0 {
        for (k, end) in end.iter_mut().enumerate() {
            *end = (*end).min(quotient(at + dy * k as f64, inverse) + 1);
        }
    } else {
        for (k, end) in end.iter_mut().enumerate() {
            *end = if at + dy * (k as f64) < 0.0 { 0 } else { *end };
        }
    }
}

/// Floor of `e / d`, given `inverse` = 1/d, limited to ±2¹⁶, which is off every image. Exact: edges are
/// shorter than 2²³, so a quotient that is no integer is 2⁻²³ or more below the next one, and the
/// product errs by less than 2⁻³⁴; adding 2⁻²⁶ keeps both on their side.
#[inline(always)]
fn quotient(e: f64, inverse: f64) -> i32 {
    const LIMIT: f64 = 65536.0;
    const NUDGE: f64 = 1.0 / (1 << 26) as f64;
    let q = (e * inverse + NUDGE).clamp(-LIMIT, LIMIT);
    // Truncation rounds down once the value is not negative.
    // SAFETY: the clamped value plus `LIMIT` lies in 0..=2¹⁷ and is not NaN: `e` is finite, and `inverse` is
    // that of an edge that is not horizontal.
    #[expect(unsafe_code, reason = "the checked conversion is not SIMD")]
    let floor: i32 = unsafe { (q + LIMIT).to_int_unchecked() };
    floor - LIMIT as i32
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
    sieve: Option<Sieve<'a>>,
    prims: &'a [PrimId],
    setups: &'a mut Vec<Setup>,
    /// Receives the see-through primitives that may show.
    through: &'a mut Vec<PrimId>,
    band: Band<'a>,
}

impl Work for DrawAll<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        if self.band.item.is_empty() { self.fill::<false, L>(l) } else { self.fill::<true, L>(l) }
    }
}

impl DrawAll<'_> {
    #[inline(always)]
    fn fill<const ITEMS: bool, L: Lanes>(mut self, l: L) {
        // In batches: a setup is filled while it is still in the first cache.
        for prims in self.prims.chunks(BATCH_PRIMS) {
            self.setups.clear();
            self.frame.set_up(prims, self.setups);
            for setup in self.setups.iter() {
                if let Some(sieve) = &mut self.sieve
                    && hides(sieve.pyramid, self.band.depth, setup)
                {
                    sieve.hidden.push(PrimId(setup.id));
                    continue;
                }
                if !self.frame.fills(setup) {
                    self.through.push(PrimId(setup.id));
                    continue;
                }
                if let Some(sieve) = &mut self.sieve {
                    // Values above it stay as they are until a refresh: too far, which is safe.
                    sieve.pyramid.touch(setup.rect());
                }
                fill::<ITEMS, L>(l, setup, &mut self.band);
            }
        }
    }
}

/// Whether the pyramid proves that a triangle shows nowhere. A part of a primitive is never judged: another
/// part may show.
#[inline(always)]
fn hides(pyramid: &Pyramid, depth: &[f32], setup: &Setup) -> bool {
    setup.whole && setup.plane.high < pyramid.farthest_over(depth, setup.rect())
}

struct SetUp<'a> {
    frame: &'a Frame<'a>,
    /// The pyramid and its image as they were before the draw.
    held: Option<(&'a Pyramid, &'a [f32])>,
    prims: &'a [PrimId],
    chunk: &'a mut Chunk,
}

impl Work for SetUp<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Chunk { setups, bands, hidden, through } = self.chunk;
        self.frame.set_up(self.prims, setups);
        // 3. On several threads against the pyramid before the draw, so fewer may be hidden than on one.
        if let Some((pyramid, depth)) = self.held {
            setups.retain(|setup| {
                let is_hidden = hides(pyramid, depth, setup);
                if is_hidden {
                    hidden.push(PrimId(setup.id));
                }
                !is_hidden
            });
        }
        if self.frame.any_through {
            setups.retain(|setup| {
                let fills = self.frame.fills(setup);
                if !fills {
                    through.push(PrimId(setup.id));
                }
                fills
            });
        }
        // Each band lists the triangles that reach into its rows, in order.
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
    fn run<L: Lanes>(self, l: L) {
        if self.band.item.is_empty() { self.fill::<false, L>(l) } else { self.fill::<true, L>(l) }
    }
}

impl FillBand<'_> {
    #[inline(always)]
    fn fill<const ITEMS: bool, L: Lanes>(mut self, l: L) {
        for chunk in self.chunks {
            for &setup in &chunk.bands[self.number] {
                fill::<ITEMS, L>(l, &chunk.setups[setup as usize], &mut self.band);
            }
        }
    }
}
