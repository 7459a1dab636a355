//! `color-cubes`: cells that are small on the screen are drawn as cubes of a few colors.
//!
//! Chamberlain, DeRose, Lischinski, Salesin and Snyder, "Fast Rendering of Complex Environments Using a
//! Spatial Hierarchy", Graphics Interface 1996, <https://doi.org/10.20380/GI1996.15>. Once (Section 4):
//!
//! 1. an octree is built, until drawing a leaf costs no more than drawing cubes for its parts
//!    ([`crate::index::CellTree`]);
//! 2. each cell gets a color cube: six faces, a color and an opacity each, as what is in the cell looks along
//!    the axes ([`faces`]).
//!
//! A frame (Section 3, [`walk`]): a cell outside the frustum is culled; one that is no larger than the
//! threshold on the screen is drawn as its cube; a larger leaf is drawn as geometry, each primitive once; any
//! other is visited child by child. What the cubes look like over each other and over geometry:
//! [`crate::raster::Canvas`].
//!
//! Cells that do not show can be left out ([`hiding`]). Else it leaves nothing out, but stands cubes for what
//! they are [`crate::method::Verdict::Approximated`] by; with a threshold of 0 it is the z-buffer. Where this
//! differs from the paper, and why: [`DEPARTURES`].
//! Cost: O(cells visited + primitives of near leaves); the paper argues for O(log n) (Section 3.1).

mod analytic;
#[cfg(test)]
mod analytic_tests;
mod code;
mod costs;
mod evidence;
mod faces;
pub(crate) mod forest;
mod hiding;
#[cfg(test)]
mod hiding_tests;
mod index;
mod picture;
mod saved;
#[cfg(test)]
mod shared_tests;
mod sketch;
mod so_far;
mod space;
#[cfg(test)]
mod tests;
mod turning;
mod walk;

use std::sync::Arc;

use self::code::{CODE, DEPARTURES, STANDS, has_line};
pub(crate) use self::evidence::Evidence;
use self::hiding::{Drawn, Hiding};
use self::index::CubeTree;
pub(crate) use self::space::Projected;
use self::walk::Walk;
use crate::drawing::Drawing;
use crate::index::CellTree;
use crate::method::{
    Card, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, surface_knobs, words,
};
use crate::raster::{DepthScale, Light};
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub(crate) struct ColorCubes;

/// Parameters of [`ColorCubes`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Params {
    pixel_threshold: f32,
    tree_levels: u32,
    cube_cost: f32,
    primitives: Primitives,
    faces: Coverage,
    face_samples: u32,
    interior: Interior,
    error_bound: f32,
    order: Order,
    occlusion: Occlusion,
    samples: u32,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            // Section 3: "no more than a pixel on the display".
            pixel_threshold: 1.0,
            tree_levels: CellTree::<glam::Vec3>::MOST_LEVELS,
            // Section 4: what its faces cost.
            cube_cost: 1.0,
            primitives: Primitives::default(),
            faces: Coverage::default(),
            // Section 4: "typically, 4×4 pixels".
            face_samples: 4,
            interior: Interior::default(),
            // The paper has no such bound.
            error_bound: 0.0,
            order: Order::default(),
            // The paper has none (Section 6).
            occlusion: Occlusion::default(),
            // The paper has 2 (Section 5), against tearing and flicker of geometry.
            samples: 1,
            surfaces: Surfaces::default(),
        }
    }
}

words! {
    /// What is drawn at once and has one cost (Section 4).
    pub(crate) enum Primitives {
        /// Each triangle, in flatland each segment.
        Triangles = "triangles",
        /// All of an object, such as a sphere of a molecule.
        Objects = "objects",
    }
}

words! {
    /// How it is found what primitives cover of a face (Section 4).
    pub(crate) enum Coverage {
        /// The mean of samples.
        Sampled = "sampled",
        /// By areas.
        Analytic = "analytic",
    }
}

words! {
    /// How faces of inner cells are made (Section 4).
    pub(crate) enum Interior {
        /// From those of the children (Figure 3).
        Composed = "composed",
        /// From the primitives, as those of leaves.
        Direct = "direct",
    }
}

words! {
    /// In which order cubes and geometry are drawn.
    pub(crate) enum Order {
        /// Geometry first, then cubes front to back, which hide nothing from each other: one right picture.
        Exact = "exact",
        /// All back to front, by cells, and cubes write depths (Section 5.1).
        Paper = "paper",
    }
}

words! {
    /// What hides cells that are behind it.
    pub(crate) enum Occlusion {
        /// Nothing.
        None = "none",
        /// Geometry.
        Depth = "depth",
        /// Geometry, and cubes that together let hardly any light through.
        DepthAndOpacity = "depth-and-opacity",
    }
}

impl Params {
    /// Whether cells can be hidden. Back to front there is nothing yet before any of them, and between the
    /// samples of pixels that are asked for a cell may show.
    fn hides(&self) -> bool {
        let can = self.order == Order::Exact && self.primitives == Primitives::Triangles && self.samples == 1;
        self.occlusion != Occlusion::None && can
    }
    /// Whether cubes can hide them.
    fn hides_behind_cubes(&self) -> bool {
        self.occlusion == Occlusion::DepthAndOpacity && self.hides()
    }
    /// Whether it is measured how wrong cubes are.
    fn measures(&self) -> bool {
        self.error_bound > 0.0
    }
    /// What an error is multiplied with to be 1 where a cube at the threshold may just be drawn.
    fn inverse_most_error(&self) -> f32 {
        self.pixel_threshold * self.pixel_threshold / self.error_bound
    }
    fn is_analytic(&self) -> bool {
        self.faces == Coverage::Analytic
    }
    fn composes(&self) -> bool {
        self.interior == Interior::Composed
    }
}

/// Declares how cells are divided, and which are drawn as cubes.
fn cell_knobs<S: Projected>(params: &mut Params, knobs: &mut dyn Knobs) {
    let threshold = Knob::new(
        "pixel-threshold",
        "pixels",
        "a cell no larger on the screen is drawn as its color cube; 0: none is, and the image is that of \
         the z-buffer",
        "Chamberlain et al. 1996, Section 3",
    );
    // Larger ones are for looking at the cubes.
    knobs.real(threshold, 0.0..=256.0, &mut params.pixel_threshold);
    let levels = Knob::new(
        "tree-levels",
        "levels",
        "levels of the octree at most; where cells are small enough is found by what drawing them costs",
        "Chamberlain et al. 1996, Section 4",
    );
    knobs.integer(levels, 1..=CellTree::<S::Vector>::MOST_LEVELS, &mut params.tree_levels);
    let cost = Knob::new(
        "cube-cost",
        "times",
        "what drawing a cube costs beside the 6 triangles (in flatland 2 segments) of its faces that can \
         be toward the eye, when cells are divided; less, such as 0.5, makes smaller leaves and a larger \
         tree, which is the faster one where drawing a cube takes less time than so many triangles",
        "Chamberlain et al. 1996, Section 4",
    );
    knobs.real(cost, 0.1..=10.0, &mut params.cube_cost);
}

/// Declares how faces are made.
fn face_knobs(params: &mut Params, knobs: &mut dyn Knobs) {
    let primitives = Knob::new(
        "primitives",
        "",
        "what is drawn at once: triangles, each by itself (in flatland each segment); objects, all of an \
         object, such as a sphere of a molecule, which takes far fewer references",
        "Chamberlain et al. 1996, Sections 4 and 5",
    );
    knobs.words(primitives, &mut params.primitives);
    let faces = Knob::new(
        "faces",
        "",
        "how a face is made from primitives: sampled, the mean of samples; analytic, by the areas that \
         show, but by 64×64 samples (in flatland 64) where light comes through one or very many are seen",
        "Chamberlain et al. 1996, Section 4",
    );
    knobs.words(faces, &mut params.faces);
    let samples = Knob::new(
        "face-samples",
        "samples",
        "samples along a side of a face, of which its color is the mean: 4 gives 4×4, in flatland 4",
        "Chamberlain et al. 1996, Section 4",
    );
    knobs.integer(samples, 1..=64, &mut params.face_samples);
    let interior = Knob::new(
        "interior",
        "",
        "faces of inner cells: composed, those of the front children over those of the back ones, \
         averaged; direct, made from the primitives as those of leaves, in more time",
        "Chamberlain et al. 1996, Section 4",
    );
    knobs.words(interior, &mut params.interior);
}

impl<S: Projected> Method<S> for ColorCubes {
    type Params = Params;
    type Index = CubeTree<S>;
    type Memory = ();
    // Where nothing hides cells it is empty: what is drawn follows from the evidence of each step alone.
    type State = Drawn<S>;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "color-cubes",
        name: "Color cubes: an octree whose small cells are drawn as cubes",
        summary: "Draws cells of an octree that are small on the screen as cubes with a color and an opacity \
                  for each face, and only large leaves as geometry.",
        paper: "Chamberlain, DeRose, Lischinski, Salesin and Snyder. Fast Rendering of Complex Environments \
                Using a Spatial Hierarchy. Graphics Interface 1996.",
        doi: "10.20380/GI1996.15",
        conservative: false,
        code: CODE,
        stands: STANDS,
        departures: DEPARTURES,
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        cell_knobs::<S>(params, knobs);
        face_knobs(params, knobs);
        let bound = Knob::new(
            "error-bound",
            "pixels",
            "a cell is drawn as its cube only if it is wrong by no more than this: its error, 0 to 1, from \
             where between the axes it is most so, times its area in pixels. Surfaces that would be torn \
             stay geometry; 0: errors are not measured, and no cell is refused",
            "Chamberlain et al. 1996, Sections 5.1 and 6",
        );
        knobs.real(bound, 0.0..=100.0, &mut params.error_bound);
        let order = Knob::new(
            "order",
            "",
            "exact: geometry first, and cubes tested against it, front to back; paper: cell by cell, back to \
             front, cubes writing depths, so that geometry within a cube shows or not by the order of cells",
            "Chamberlain et al. 1996, Section 5.1",
        );
        knobs.words(order, &mut params.order);
        let occlusion = Knob::new(
            "occlusion",
            "",
            "cells that are left out because they do not show, with order=exact, primitives=triangles and \
             samples=1: none; depth, those behind geometry that is drawn before them; depth-and-opacity, \
             those behind color cubes as well that let less than 1/1024 of the light through",
            "Chamberlain et al. 1996, Section 6",
        );
        knobs.words(occlusion, &mut params.occlusion);
        let samples = Knob::new(
            "samples",
            "samples",
            "samples along each side of a pixel, geometry and cubes alike, of which the picture is the mean: \
             2 gives 2×2, in flatland 2, as the paper has it. What is drawn stays the same",
            "Chamberlain et al. 1996, Section 5",
        );
        knobs.integer(samples, 1..=2, &mut params.samples);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        CubeTree::build(scene, params, saved, progress)
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        (): &mut (),
        drawn: &mut Drawn<S>,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        // Faces were made in this light.
        out.light = Light::Fixed;
        out.in_order = frame.params.order == Order::Paper;
        out.samples = frame.params.samples;
        let walk = Walk::new((frame.index, frame.scene), frame.view, frame.params, out, watch);
        walk.hiding(Hiding::new(frame, drawn)).run();
    }
    fn is_conservative(params: &Params) -> bool {
        params.pixel_threshold == 0.0
    }
    fn has_line(params: &Params, line: u8) -> bool {
        has_line(params, line)
    }
}

impl<S: Projected> Shown<S> for ColorCubes {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        picture::explain(moment, to);
    }
    fn drawn(moment: &Moment<'_, S, Self>) -> Option<DrawList<S>> {
        Some(so_far::drawn(moment))
    }
    const PICTURES: &'static [&'static str] = picture::PICTURES;
    fn picture(moment: &Moment<'_, S, Self>, which: usize, _: DepthScale) -> Drawing {
        picture::picture(moment, which)
    }
}
