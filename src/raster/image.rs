//! Triangles into an image.
//!
//! 1. Points are projected to the pixel grid: all of them, or three for each primitive of a small subset.
//! 2. Primitives are dropped or clipped ([`super::frame`]).
//! 3. The rest are set up: pixel box, edge functions, depth plane ([`super::setup`]).
//! 4. They are filled ([`super::fill`]).
//!
//! Onto an image that holds something one thread runs steps 2 to 4 batch by batch. An image that is made anew
//! comes block by block ([`super::blocks`]), and so does any that several threads draw: they run step 2 on
//! chunks of primitives, then 3 and 4 on bands of blocks, each band by one thread from all chunks. A pixel
//! keeps its winner whatever the order, so the bytes are equal.

use rayon::prelude::*;

use super::blocks::{self, Band, Bins, Block, fill_band};
use super::fill::{Canvas, fill};
use super::frame::Frame;
use super::setup::Setup;
use super::simd::{self, Lanes, Work};
use super::vertex::{Camera, Vertex};
use super::{Options, Target, check_size};
use crate::geometry::{PixelRect, PrimId, Solid, View};
use crate::scene::Scene;

/// Buffers kept from draw to draw, so that drawing again takes no memory.
#[derive(Default)]
pub(super) struct Scratch {
    vertices: Vec<Vertex>,
    setups: Vec<Setup>,
    bins: Vec<Bins>,
}

/// Primitives in a chunk: enough that its work hides the cost of handing it to a thread.
const CHUNK_PRIMS: usize = 4096;
/// Triangles set up before they are filled, where that is done at once: 25 KiB, which the first cache holds.
const BATCH_PRIMS: usize = 256;
/// Lists of blocks may have so many entries together, 128 MiB; a scene of very many very large triangles
/// exceeds it, and is filled at once.
const MOST_ENTRIES: usize = if cfg!(test) { 1 << 13 } else { 1 << 24 };

/// Draws triangles; see [`super::Drawable`].
pub(super) fn draw(
    target: &mut Target,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
    options: &Options,
) {
    check_size(target, view);
    draw_onto(target, scene, view, prims, options, Onto::Image);
}

/// Draws onto rows of the image that are all the target holds; see [`super::Drawable::draw_rows`].
pub(super) fn draw_rows(
    target: &mut Target,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
    first: u32,
    options: &Options,
) {
    let window = PixelRect { x0: 0, x1: view.width, y0: first, y1: first + target.height };
    let options = Options { window: Some(window), threads: 1, ..*options };
    draw_onto(target, scene, view, prims, &options, Onto::Rows(first));
}

/// What is drawn onto.
#[derive(Clone, Copy)]
enum Onto {
    /// The image that the target holds.
    Image,
    /// The rows of it from this one on that the target holds.
    Rows(u32),
    /// Nothing: the depth of an empty pixel.
    Nothing(f32),
}

/// Makes the image anew; see [`super::Drawable::redraw`].
pub(super) fn redraw(
    target: &mut Target,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
    options: &Options,
) {
    let pixels = view.width as usize * view.height as usize;
    (target.width, target.height) = (view.width, view.height);
    // What is there stays: each block is emptied when it is filled.
    target.depth.resize(pixels, 0.0);
    target.item.resize(pixels, Target::NONE);
    target.through.clear();
    check_size(target, view);
    draw_onto(target, scene, view, prims, options, Onto::Nothing(1.0 / view.eye.far));
}

/// Points a primitive up to which all points of a scene are projected: as many as it has corners.
const BULK: usize = 3;

/// Draws onto what the target holds, or onto nothing.
fn draw_onto(
    target: &mut Target,
    scene: &Scene<Solid>,
    view: &View<Solid>,
    prims: &[PrimId],
    options: &Options,
    onto: Onto,
) {
    let threads = options.thread_count();
    let mut scratch = std::mem::take(&mut target.scratch);
    let camera = Camera::new(view);
    // 1. Each point once, or each corner of each primitive, whatever are fewer. The code is the same either
    // way, and so are the vertices.
    let points = if prims.len() * BULK >= scene.points().len() { scene.points() } else { &[] };
    scratch.vertices.resize(points.len(), Vertex::default());
    // Four parts a thread, so that one slow part does not keep the others waiting; none so small that handing
    // it over costs more than projecting it.
    let part = points.len().div_ceil(threads * 4).max(1024);
    let parts = points.chunks(part).zip(scratch.vertices.chunks_mut(part)).collect();
    for_all(
        threads,
        parts,
        || (),
        |(), (points, vertices)| {
            simd::run(options.isa, Project { camera: &camera, points, vertices });
        },
    );
    let frame = Frame {
        scene,
        view,
        camera,
        vertices: &scratch.vertices,
        surfaces: options.surfaces,
        any_through: options.surfaces.any_through(scene),
        window: options.window_of(view),
    };
    let (anew, first) = match onto {
        Onto::Image => (None, 0),
        Onto::Rows(first) => (None, first as i32),
        Onto::Nothing(depth) => (Some(depth), 0),
    };
    // 2 to 4.
    let by_blocks = (threads > 1 || anew.is_some())
        && draw_blocks(target, &frame, prims, options, &mut scratch.bins, anew);
    if !by_blocks {
        if let Some(depth) = anew {
            target.depth.fill(depth);
            target.item.fill(Target::NONE);
        }
        let (depth, item, stride) = (&mut target.depth, &mut target.item, view.width as usize);
        let canvas = Canvas { depth, item, first: [0, first], stride };
        let (setups, through) = (&mut scratch.setups, &mut target.through);
        simd::run(options.isa, DrawAll { frame: &frame, prims, setups, through, canvas });
    }
    target.scratch = scratch;
}

/// Does all jobs, on the calling thread or on those of the pool. Each has a state that is handed from job to
/// job.
fn for_all<J: Send, S>(
    threads: usize,
    jobs: Vec<J>,
    state: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, J) + Sync + Send,
) {
    if threads <= 1 {
        let mut state = state();
        jobs.into_iter().for_each(|job| work(&mut state, job));
    } else {
        jobs.into_par_iter().for_each_init(state, work);
    }
}

/// Chunks of primitives into bins, then bands of blocks from these. Returns whether it did: not where the
/// lists would be too long.
fn draw_blocks(
    target: &mut Target,
    frame: &Frame,
    prims: &[PrimId],
    options: &Options,
    bins: &mut Vec<Bins>,
    anew: Option<f32>,
) -> bool {
    let (width, height, threads) = (target.width as usize, target.height as usize, options.thread_count());
    let size = if threads <= 1 { prims.len().max(1) } else { CHUNK_PRIMS };
    bins.resize_with(prims.len().div_ceil(size), Bins::default);
    for_all(
        threads,
        bins.iter_mut().zip(prims.chunks(size)).collect(),
        || (),
        |(), (bins, prims)| {
            simd::run(options.isa, Find { frame, prims, bins });
        },
    );
    if blocks::number(bins) > MOST_ENTRIES {
        return false;
    }
    for_all(threads, bins.iter_mut().collect(), || (), |(), bins| bins.deal(width, height));
    // In the order of the chunks, not of the threads that finished them.
    for bins in bins.iter() {
        target.through.extend_from_slice(&bins.through);
    }
    // No pixel lies in two bands, so bands need no locks.
    let pixels = width * blocks::ROWS;
    let bands = target.depth.chunks_mut(pixels).zip(target.item.chunks_mut(pixels)).enumerate();
    let bands = bands.map(|(number, (depth, item))| Band { depth, item, number, width, anew }).collect();
    for_all(threads, bands, Block::default, |block, band| {
        simd::run(options.isa, FillBand { frame, bins, block, band });
    });
    true
}

struct Find<'a> {
    frame: &'a Frame<'a>,
    prims: &'a [PrimId],
    bins: &'a mut Bins,
}

impl Work for Find<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        self.bins.find(self.frame, self.prims);
    }
}

struct FillBand<'a> {
    frame: &'a Frame<'a>,
    bins: &'a [Bins],
    block: &'a mut Block,
    band: Band<'a>,
}

impl Work for FillBand<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { frame, bins, block, band } = self;
        fill_band(l, frame, bins, block, band);
    }
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
    /// Receives the see-through primitives that may show.
    through: &'a mut Vec<PrimId>,
    canvas: Canvas<'a>,
}

impl Work for DrawAll<'_> {
    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) {
        // In batches: a setup is filled while it is still in the first cache.
        for prims in self.prims.chunks(BATCH_PRIMS) {
            self.setups.clear();
            self.frame.find(prims, self.setups);
            for setup in self.setups.iter() {
                if !self.frame.fills(setup.id) {
                    self.through.push(PrimId(setup.id));
                    continue;
                }
                fill(l, setup, &mut self.canvas);
            }
        }
    }
}
