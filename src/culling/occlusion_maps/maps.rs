//! The maps of a frame: the large state that a run changes and a film replays. What occluders cover, as tiles
//! and as levels of opacity, and how deep they are.

use super::depth::DepthBuffer;
use super::index::Databases;
use super::{Params, Samples};
use crate::culling::depth::{Faces, TileLevels, TileStep, Tiled};
use crate::geometry::{NodeId, PixelRect, PrimId, Space, View};
use crate::raster::{Opacity, PyramidCell};
use crate::scene::Scene;

/// A change of the maps. A run makes it, and a film makes it again from the note that holds its operands.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MapStep {
    /// Occluders count as far as this view depth only, world units: a single Z plane.
    Plane(f32),
    /// What a node holds is drawn, or stands in for one, with fronts only or from both sides.
    Cover(NodeId, bool),
    /// A farthest depth is written to entries of the depth estimation buffer.
    Write(PixelRect, f32),
    /// The levels are made of what is drawn.
    Build,
    /// Depths of a tile are worked out.
    Refresh(PyramidCell),
}

/// The maps.
#[derive(Clone, Debug)]
pub(crate) struct Maps<S: Faces> {
    /// What occluders cover, at the samples of the maps.
    tiled: Tiled<S>,
    opacity: Opacity,
    buffer: DepthBuffer,
    /// The view of the samples, once there is one.
    view: Option<View<S>>,
    /// Image pixels a side of a pixel of level 0, as a power of two.
    pixel: u32,
    /// Whether a plane cuts occluders off.
    has_plane: bool,
    /// Of each primitive whether it may show; all but those that are drawn and do not.
    shows: Vec<bool>,
    /// What is drawn.
    drawn: Vec<PrimId>,
}

impl<S: Faces> Default for Maps<S> {
    fn default() -> Self {
        Self {
            tiled: Tiled::default(),
            opacity: Opacity::default(),
            buffer: DepthBuffer::default(),
            view: None,
            pixel: 0,
            has_plane: false,
            shows: Vec::new(),
            drawn: Vec::new(),
        }
    }
}

/// Maps of the same view with the same in them.
impl<S: Faces> PartialEq for Maps<S> {
    fn eq(&self, other: &Self) -> bool {
        self.tiled == other.tiled && self.opacity == other.opacity && self.buffer == other.buffer
    }
}

/// The size of a pixel of level 0: image pixels a side, as a power of two. The least with which the longer
/// side has at most `resolution` of them.
fn side<S: Space>(view: &View<S>, resolution: u32) -> u32 {
    let longer = view.width.max(view.height);
    (0..32).find(|&shift| longer.div_ceil(1 << shift) <= resolution).unwrap_or(31)
}

impl<S: Faces> Maps<S> {
    /// Empties them for a view.
    pub fn clear(&mut self, scene: &Scene<S>, view: &View<S>, params: &Params, index: &Databases<S>) {
        let pixel = side(view, params.map_resolution);
        let is_flat = S::CORNERS == 2;
        let map = |pixels: u32| pixels.div_ceil(1 << pixel);
        // Section 4.1: the maps have samples of their own, or, as with "multi-sampled anti-aliasing", so many
        // that none of the image's is left out.
        let (size, shift) = match params.samples.side() {
            None => ([view.width, view.height], pixel),
            Some(side) => {
                let rows = if is_flat { 1 } else { map(view.height) << side };
                ([map(view.width) << side, rows], side)
            }
        };
        let samples = View { width: size[0], height: size[1], ..*view };
        self.tiled.clear(&samples, index.clusters(), index.drawn_count(scene));
        self.opacity.clear(size, shift, is_flat);
        self.opacity.fill_holes(params.closing);
        self.buffer.clear([view.width, view.height], params.depth_resolution);
        (self.view, self.pixel, self.has_plane) = (Some(samples), pixel, false);
        // Of many primitives few are drawn.
        for prim in self.drawn.drain(..) {
            self.shows[prim.at()] = true;
        }
        // What stands in for occluders counts on.
        self.shows.resize(index.drawn_count(scene), true);
    }
    /// Lets go of the clusters, until they are emptied for a view.
    pub fn release(&mut self) {
        self.tiled.release();
    }
    /// Makes a change.
    pub fn step(&mut self, step: MapStep) {
        // A run and its film both come through here, so that the same operands make the same change.
        match step {
            MapStep::Plane(z) => {
                let Some(mut view) = self.view else { return };
                view.eye.far = z;
                self.tiled.empty(&view);
                self.has_plane = true;
            }
            MapStep::Cover(node, one_sided) => {
                self.tiled.gather(node, one_sided);
                for prim in self.tiled.gathered_of(node) {
                    self.shows[prim.at()] = false;
                    self.drawn.push(prim);
                }
            }
            MapStep::Write(touched, farthest) => self.buffer.write(touched, farthest),
            // A polygon that crosses the plane sets the bits of all its pixels: only depths tell those before
            // it from those beyond.
            MapStep::Build if self.has_plane => {
                drop(self.tiled.settle());
                let far = self.tiled.projected().map_or(0.0, |p| 1.0 / p.view.eye.far);
                let depths = self.tiled.depths();
                self.opacity.build_from_depths(&depths, far);
            }
            MapStep::Build => {
                for prim in self.tiled.settle() {
                    self.shows[prim.at()] = true;
                }
                self.opacity.build(self.tiled.tiles());
            }
            MapStep::Refresh(cell) => {
                self.tiled.step(TileStep::Refresh(cell));
            }
        }
    }
    /// The levels of opacity.
    pub fn opacity(&self) -> &Opacity {
        &self.opacity
    }
    /// Whether a primitive may show: it is no occluder, or one that was nearer in some tile than what was
    /// drawn before it.
    pub fn shows(&self, prim: PrimId) -> bool {
        self.shows[prim.at()]
    }
    /// The depth estimation buffer.
    pub fn buffer(&self) -> &DepthBuffer {
        &self.buffer
    }
    /// Image pixels a side of a pixel of level 0, as a power of two.
    pub fn pixel(&self) -> u32 {
        self.pixel
    }
    /// Of each sample whether an occluder covers it, row by row: from what is drawn, not from the levels.
    pub fn covered(&mut self) -> Vec<bool> {
        let [width, height] = self.opacity.samples();
        if self.has_plane {
            let far = self.tiled.projected().map_or(0.0, |p| 1.0 / p.view.eye.far);
            return self.tiled.depths().iter().map(|depth| *depth > far).collect();
        }
        let tiles = self.tiled.tiles();
        let at = |x: u32, y: u32| {
            let tile = PyramidCell { level: PyramidCell::TILE, x: (x / 8) as u16, y: (y / 4) as u16 };
            tiles.covered_pixels(tile) >> (8 * (y % 4) + x % 8) & 1 != 0
        };
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect()
    }
    /// The tiles that occluders are drawn into, for pictures.
    pub fn levels(&self) -> TileLevels {
        self.tiled.levels()
    }
    /// The same, for questions.
    pub fn tiled(&mut self) -> &mut Tiled<S> {
        &mut self.tiled
    }
    /// The samples that pixels of the image stand for, rounded outward.
    pub fn samples_of(&self, pixels: PixelRect, samples: Samples) -> PixelRect {
        if samples == Samples::Image {
            return pixels;
        }
        // Whole pixels of level 0, so that what is asked for is asked at all samples near it.
        let (low, past) = (|v: u32| v >> self.pixel, |v: u32| v.div_ceil(1 << self.pixel));
        let (shift, is_flat) = (self.opacity.shift(0), S::CORNERS == 2);
        PixelRect {
            x0: low(pixels.x0) << shift,
            x1: past(pixels.x1) << shift,
            y0: if is_flat { 0 } else { low(pixels.y0) << shift },
            y1: if is_flat { 1 } else { past(pixels.y1) << shift },
        }
    }
}
