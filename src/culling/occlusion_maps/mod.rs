//! `occlusion-maps`: what lies behind a few occluders, and within what they cover together, is not drawn.
//!
//! Zhang, Manocha, Hudson and Hoff, "Visibility Culling using Hierarchical Occlusion Maps", SIGGRAPH 1997,
//! <https://doi.org/10.1145/258734.258781>. Once, the occluder database is made ([`index`], Section 5.3.1).
//! A frame ([`walk`], Section 3):
//!
//! 1. occluders are chosen ([`selection`], Section 5.3.2), as many as the budget allows ([`budget`]), by
//!    lists of what a grid's points see if one is made ([`grid`]);
//! 2. they, or what stands in for them ([`stand_ins`], Section 8), are drawn in white ([`maps`]), their
//!    depths are estimated ([`depth`], Section 5.2), and the image is averaged down to a hierarchy of
//!    occlusion maps (Section 4, [`crate::raster::Opacity`]);
//! 3. the hierarchy of the model is visited: a node that is outside the frustum, or behind the occluders
//!    (Section 5.2) and within what they cover ([`overlap`], Section 5.1), is culled with all below it.
//!
//! With an opacity threshold below 1 small holes are ignored (Section 5.4), and what is culled because of
//! that is [`crate::method::Verdict::Presumed`]. Where this differs from the paper, and why: [`DEPARTURES`].
//! Cost: O(occluders drawn + map pixels + nodes visited).

mod budget;
mod code;
mod depth;
mod evidence;
mod grid;
mod index;
mod leaves;
mod maps;
mod overlap;
pub(crate) mod parts;
mod picture;
mod saved;
mod selection;
mod stand_ins;
#[cfg(test)]
mod tests;
mod thresholds;
mod walk;

use std::sync::Arc;

use self::budget::Budget;
use self::code::{CODE, DEPARTURES, STANDS, has_line};
pub(crate) use self::evidence::{Evidence, Ground};
use self::index::Databases;
use self::maps::Maps;
use self::selection::Selection;
use self::stand_ins::Kind;
use self::walk::{Scratch, Walk};
use super::depth::Faces;
use crate::drawing::Drawing;
use crate::geometry::Space;
use crate::method::{
    Card, Derived, DrawList, Event, Frame, Hiders, Knob, Knobs, Method, Moment, Observer, Shown, State,
    surface_knobs, words,
};
use crate::raster::{DepthScale, Opacity};
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub(crate) struct OcclusionMaps;

/// Parameters of [`OcclusionMaps`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Params {
    map_resolution: u32,
    samples: Samples,
    opacity_threshold: f32,
    depth: DepthKind,
    depth_resolution: u32,
    closing: u32,
    occluders: Kind,
    selection: Selection,
    /// Points of the grid along the longest side.
    grid: u32,
    /// 0: by the scene.
    occluder_budget: u32,
    occluder_size: u32,
    adapts: bool,
    /// 0: by the space.
    leaf_primitives: u32,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            // Section 6.1: "rendering occluders at 256×256 is a good trade-off".
            map_resolution: 256,
            samples: Samples::default(),
            // Section 5.4: "by default 1.0".
            opacity_threshold: 1.0,
            // Culls about twice as much as the estimation buffer, in less time.
            depth: DepthKind::Samples,
            // Section 5.2.2: "a coarse resolution (e.g. 64×64)".
            depth_resolution: 64,
            closing: 0,
            occluders: Kind::default(),
            selection: Selection::default(),
            grid: 16,
            occluder_budget: 0,
            occluder_size: 2,
            adapts: true,
            leaf_primitives: 0,
            surfaces: Surfaces::default(),
        }
    }
}

words! {
    /// Where maps are sampled.
    pub(crate) enum Samples {
        /// At all samples of the image, so that the maps are exact for it.
        Image = "image",
        /// Once a map pixel: the paper without antialiasing.
        One = "1",
        /// Four times a map pixel, as with antialiasing.
        Four = "4",
        /// Sixteen times.
        Sixteen = "16",
    }
}

impl Samples {
    /// Samples a side of a map pixel as a power of two; `None`: those of the image.
    fn side(self) -> Option<u32> {
        match self {
            Self::Image => None,
            Self::One => Some(0),
            Self::Four => Some(1),
            Self::Sixteen => Some(2),
        }
    }
}

words! {
    /// What is known of the depths of occluders.
    pub(crate) enum DepthKind {
        /// The depth estimation buffer (Section 5.2.2).
        Estimation = "estimation",
        /// A single Z plane (Section 5.2.1).
        Plane = "plane",
        /// Their own depths, at the samples that they cover.
        Samples = "samples",
    }
}

impl Params {
    /// Whether it is looked from the points of a grid: a single Z plane is a choice of its own.
    fn uses_grid(&self) -> bool {
        self.selection == Selection::Grid && self.depth != DepthKind::Plane
    }
    /// Primitives of a leaf, at most.
    fn leaf_prims<S: Space>(&self) -> u32 {
        // A test costs about as much as a few dozen triangles; flatland is there to be looked at.
        match self.leaf_primitives {
            0 if S::CORNERS == 2 => 1,
            0 => 16,
            n => n,
        }
    }
    /// Whether it is known of occluders what of them shows: the maps have the samples of the image, and
    /// nothing is cut off.
    fn knows_what_shows(&self) -> bool {
        self.samples == Samples::Image && self.depth != DepthKind::Plane
    }
    /// Black samples that a map pixel has at most to count as opaque (Section 5.4).
    fn ignored(&self, maps: &Opacity) -> u32 {
        // O_0 = 1 − n/m_0. A share such as 0.9 is not a binary fraction: what misses a whole number by less
        // than its rounding is that number.
        ((1.0 - f64::from(self.opacity_threshold)) * f64::from(maps.whole()) + 1e-4) as u32
    }
}

/// What is kept from frame to frame.
#[derive(Clone, Default)]
pub(crate) struct Memory {
    budget: Budget,
    /// Of each node whether it was an occluder in the last frame, and whether it is a leaf that was drawn.
    occluders: Vec<bool>,
    drawn: Vec<bool>,
    scratch: Scratch,
}

impl<S: Faces> Method<S> for OcclusionMaps {
    type Params = Params;
    type Index = Databases<S>;
    type Memory = Memory;
    type State = Maps<S>;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "occlusion-maps",
        name: "Hierarchical occlusion maps",
        summary: "Draws a few near occluders into a map of what is covered, and drops every node that lies \
                  behind them and within the map.",
        paper: "Zhang, Manocha, Hudson and Hoff. Visibility Culling using Hierarchical Occlusion Maps. \
                SIGGRAPH 1997.",
        doi: "10.1145/258734.258781",
        conservative: true,
        code: CODE,
        stands: STANDS,
        departures: DEPARTURES,
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        map_knobs(params, knobs);
        selection_knobs(params, knobs);
        occluder_knobs(params, knobs);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        Databases::build(scene, params, saved, progress)
    }
    fn moved(
        index: &mut Arc<Self::Index>,
        _: &mut Memory,
        scene: &Arc<Scene<S>>,
        params: &Params,
        _: &dyn Progress,
    ) -> Option<()> {
        // The nodes stay, and with them what was chosen and drawn last.
        Arc::make_mut(index).follow(scene, params);
        Some(())
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Memory,
        maps: &mut Maps<S>,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        Walk::new(frame, memory, maps, out, watch).run();
    }
    fn is_conservative(params: &Params) -> bool {
        // Stand-ins that preserve occlusion change what is culled, not what is seen.
        let preserves = params.occluders != Kind::Clustered;
        let ignores = params.opacity_threshold < 1.0 || params.closing > 0;
        params.samples == Samples::Image && preserves && !ignores
    }
    fn has_line(params: &Params, line: u8) -> bool {
        has_line(params, line)
    }
}

/// Parameters of the maps.
fn map_knobs(params: &mut Params, knobs: &mut dyn Knobs) {
    let resolution = Knob::new(
        "map-resolution",
        "pixels",
        "pixels of the finest occlusion map along its longer side, at most: each is a square of image \
         pixels, a power of two a side",
        "Zhang et al. 1997, Sections 4.1 and 6.1",
    );
    // Below 8 there would be one map only for images of any size.
    knobs.integer(resolution, 8..=4096, &mut params.map_resolution);
    let samples = Knob::new(
        "samples",
        "",
        "where the maps are sampled: image, at every pixel center of the image, so that they are exact for \
         it; 1, 4 or 16 times a map pixel, as the paper's smaller image without and with antialiasing, \
         which may cull what is visible",
        "Zhang et al. 1997, Section 4.1",
    );
    knobs.words(samples, &mut params.samples);
    let threshold = Knob::new(
        "opacity-threshold",
        "",
        "opacity from which a pixel of the finest map counts as opaque; coarser maps follow from it. Below 1 \
         small holes are ignored, and what shows through them is lost",
        "Zhang et al. 1997, Section 5.4",
    );
    // Below a half a pixel that is mostly empty would count as opaque.
    knobs.real(threshold, 0.5..=1.0, &mut params.opacity_threshold);
    let closing = Knob::new(
        "closing",
        "samples",
        "holes of up to so many black samples of the maps are filled: area closing, which unlike a threshold \
         tells a hole from a slit. What shows through them is lost; 0 fills none",
        "Vincent 1994; Zhang et al. 1997, Section 5.4",
    );
    knobs.integer(closing, 0..=10_000, &mut params.closing);
    let depth = Knob::new(
        "depth",
        "",
        "what is known of the occluders' depths: estimation, for parts of the screen the farthest corner of \
         any of their boxes; plane, a single Z plane before which all occluders lie; samples, their own \
         depths at the samples that they cover",
        "Zhang et al. 1997, Section 5.2",
    );
    knobs.words(depth, &mut params.depth);
    let entries = Knob::new(
        "depth-resolution",
        "entries",
        "entries of the depth estimation buffer along the longer side of the screen",
        "Zhang et al. 1997, Section 5.2.2",
    );
    knobs.integer(entries, 1..=1024, &mut params.depth_resolution);
}

/// How occluders are chosen.
fn selection_knobs(params: &mut Params, knobs: &mut dyn Knobs) {
    let source = "Zhang et al. 1997, Section 5.3.2";
    let selection = Knob::new(
        "selection",
        "",
        "by what occluders are chosen: distance, the nearest; size, those that look largest; visible, the \
         nearest of those that could be seen in the last frame; grid, those that look largest from the grid \
         points about the eye (grid=), and after these the nearest. With depth=plane it is the nearest point \
         that counts",
        source,
    );
    knobs.words(selection, &mut params.selection);
    let grid = Knob::new(
        "grid",
        "points",
        "points along the longest side of the scene from which it is looked at once, for selection=grid; \
         what moves is not seen from them",
        source,
    );
    knobs.integer(grid, 1..=64, &mut params.grid);
    let budget = Knob::new(
        "occluder-budget",
        "polygons",
        "L, how many polygons occluders have together in the first frame; 0: 1 % of the scene's and at least \
         500, in flatland 10 %",
        source,
    );
    knobs.integer(budget, 0..=100_000_000, &mut params.occluder_budget);
    let adapts = Knob::new(
        "adapt",
        "",
        "L and the distance limit follow what is culled, and culling is turned off where it does not pay",
        "Zhang et al. 1997, Sections 6.2 and 7",
    );
    knobs.switch(adapts, &mut params.adapts);
}

/// What occluders are.
fn occluder_knobs(params: &mut Params, knobs: &mut dyn Knobs) {
    let drawn = Knob::new(
        "occluders",
        "",
        "what is drawn of an occluder: original, what it holds; merged, its coplanar primitives as polygons, \
         in fewer triangles; largest, the largest of them, three quarters by area; inner, boxes inside its \
         closed parts; clustered, points closer than occluder-size as one, which may cull what is visible",
        "Zhang et al. 1997, Sections 6.2 and 8",
    );
    knobs.words(drawn, &mut params.occluders);
    let source = "Zhang et al. 1997, Section 5.3.1";
    let size =
        Knob::new("occluder-size", "‰", "what is smaller than this part of the scene is no occluder", source);
    knobs.integer(size, 0..=1000, &mut params.occluder_size);
    let leaf = Knob::new(
        "leaf-primitives",
        "",
        "primitives of an object, a leaf of the hierarchy, at most; 0: 16 triangles, 1 segment",
        "Zhang et al. 1997, Section 6.2",
    );
    knobs.integer(leaf, 0..=100_000, &mut params.leaf_primitives);
}

impl<S: Faces> State<S, OcclusionMaps> for Maps<S> {
    // A copy of the maps takes about as long as so many notes, most of which change nothing.
    const KEYFRAME_NOTES: usize = 1 << 13;
    fn begin(&mut self, frame: &Frame<'_, S, OcclusionMaps>) {
        self.clear(frame.scene, frame.view, frame.params, frame.index);
    }
    fn release(&mut self) {
        Maps::release(self);
    }
    fn apply(&mut self, _: &Scene<S>, note: &Evidence<S>) {
        if let Some(step) = note.step() {
            self.step(step);
        }
    }
}

impl<S: Faces> Shown<S> for OcclusionMaps {
    fn hiders(frame: &Frame<'_, S, Self>, notes: &[Self::Note], at: usize) -> Option<Hiders> {
        let (mut drawn, prims) = (Vec::new(), |leaf| frame.index.tree().prims_below(leaf));
        for note in &notes[..at] {
            match note {
                Evidence::Covered(c) if c.drawn == c.node => drawn.extend_from_slice(prims(c.node)),
                // What stands in for an occluder is not of the scene, and a plane cuts occluders.
                Evidence::Covered(_) | Evidence::Plane(_) => return None,
                _ => {}
            }
        }
        Some(Hiders::Drawn(drawn))
    }
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        picture::explain(moment, to);
    }
    const PICTURES: &'static [&'static str] = picture::PICTURES;
    fn picture(moment: &Moment<'_, S, Self>, which: usize, scale: DepthScale) -> Drawing {
        picture::picture(moment, which, scale)
    }
    fn probe(moment: &Moment<'_, S, Self>, which: usize, at: glam::Vec2) -> Option<String> {
        // Of the pictures only the levels beside each other show pixels that are not askew.
        (which == 0).then(|| picture::probe(moment, at))?
    }
    fn derived(frame: &Frame<'_, S, Self>) -> Option<Derived> {
        Some(thresholds::table(frame))
    }
}
