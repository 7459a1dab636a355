//! `layered-projection`: draws what is most likely visible first, until a budget is spent.
//!
//! Klosowski and Silva, "The Prioritized-Layered Projection Algorithm for Visible Set Estimation", IEEE TVCG
//! 6(2), 2000, <https://doi.org/10.1109/2945.856993>. Its steps, by which the bodies refer to them:
//!
//! 1. Once per scene: divide space into cells that hold about equally much and assign the primitives to them
//!    (Sections 3.1 and 4.3, [`cells`], [`index`]).
//! 2. Begin with the cell that holds the Eye, or else the nearest one (Section 4.2).
//! 3. Take the cell of least solidity, an estimate of how much stands between it and the Eye, out of the
//!    front ([`front`]) and draw what is in it; end when the budget is spent (Figure 4, [`walk`]).
//! 4. Hand its solidity on to its neighbors, with a penalty for those that the Eye does not see through the
//!    shared face, and put them into the front; go to 3 (Figures 5 and 6).
//! 5. Extensions of Section 6: several seeds, queries of what the budget left out against the z-buffer, a
//!    budget that grows until the image is good enough, and solidity by what faces the Eye ([`rest`]).
//!
//! Two sets of rules ([`rules`]): `rules=paper` is Figures 4 and 5 as they are printed, `rules=ours`, the
//! default, differs where that finds more (`cullscope paper klosowski-silva-table-1` has both). Where they
//! differ, and other departures, stand with the pseudocode ([`code`]).
//! Cost: O(cells projected · log front) and the primitives in them; memory O(cells) a frame.

mod cells;
mod code;
mod explain;
mod front;
mod index;
mod later;
mod picture;
mod rest;
mod rules;
mod saved;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Arc;

pub use self::explain::{Evidence, Transferred};
pub use self::front::Front;
use self::index::Index;
pub use self::index::node_of;
use self::rules::{Occupancy, Rules, Traversal};
use self::walk::Walk;
use crate::culling::depth::Faces;
use crate::drawing::Drawing;
use crate::index::tessellation::Cellular;
use crate::method::{
    Budget, Card, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State, surface_knobs,
    words,
};
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub struct LayeredProjection;

words! {
    /// Which cells space is divided into; the order is part of saved files.
    enum CellKind {
        /// Leaves of an octree over the vertices.
        Octree = "octree",
        /// A Delaunay triangulation of those leaves' centers.
        Delaunay = "delaunay",
        /// Leaves of a kD-tree over the vertices.
        KdTree = "kd-tree",
    }
}

/// Parameters of [`LayeredProjection`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    tessellation: CellKind,
    budget: Budget,
    /// Per cent of the scene's longest side.
    leaf_size: u32,
    rules: Rules,
    /// What follows them where it is not set.
    how: Traversal,
    occupancy: Occupancy,
    seeds: u32,
    queries: bool,
    /// Per cent of the pixels; 0: the budget holds.
    quality: u32,
    seed: u32,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            // Of the paper's two the one that finds more (Section 5.2, Figure 12 a).
            tessellation: CellKind::Delaunay,
            // The largest budget of the paper's curves (Figures 10 and 11).
            budget: Budget::Percent(10.0),
            // The paper's (Section 4.3, footnote 4).
            leaf_size: 5,
            rules: Rules::Ours,
            how: Traversal::of(Rules::Ours),
            // The extensions of Section 6 are off: by default the method is that of Sections 3 and 4.
            occupancy: Occupancy::Count,
            seeds: 1,
            queries: false,
            quality: 0,
            seed: 1,
            surfaces: Surfaces::default(),
        }
    }
}

/// The paper, of which a parameter names the section.
macro_rules! section {
    ($section:literal) => {
        concat!("Klosowski and Silva 2000, Section ", $section)
    };
}

impl Params {
    /// Whether what the budget leaves is compared with the depths of what it drew.
    fn asks_depths(&self) -> bool {
        self.queries || self.quality > 0
    }
}

impl<S: Cellular + Faces> Method<S> for LayeredProjection {
    type Params = Params;
    type Index = Index<S>;
    // Solidity depends on the Eye and is found anew in every frame, as in the paper.
    type Memory = ();
    type State = Front;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "layered-projection",
        name: "Prioritized-layered projection",
        summary: "Divides space into cells and projects those first that least is likely to stand in front \
                  of, until a budget of primitives is spent.",
        paper: "Klosowski and Silva. The Prioritized-Layered Projection Algorithm for Visible Set \
                Estimation. IEEE TVCG 6(2), 2000.",
        doi: "10.1109/2945.856993",
        conservative: false,
        code: code::CODE,
        stands: code::STANDS,
        departures: code::DEPARTURES,
    };
    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        paper_knobs(params, knobs);
        extension_knobs(params, knobs);
        let meaning = "decides how the centers of cells are moved before they are triangulated";
        knobs.integer(Knob::new("seed", "", meaning, section!("4.3")), 0..=u32::MAX, &mut params.seed);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Index<S>>, String> {
        match saved {
            // Bytes that do not fit are an error, not a reason to build in silence: building may take long.
            Some(bytes) => Index::restore(scene, params, bytes).map(Some),
            None => Ok(Index::build(scene, params, progress)),
        }
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        (): &mut (),
        front: &mut Front,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        Walk::new(frame, front, out, watch).run();
    }
    fn has_line(params: &Params, line: u8) -> bool {
        code::has_line(params, line)
    }
    fn is_conservative(params: &Params) -> bool {
        // Queries decide about all that the budget leaves; a budget of everything leaves nothing. A time may
        // leave something even with queries: it ends them too. A wanted quality of all pixels lets the budget
        // grow until none can change.
        !matches!(params.budget, Budget::Milliseconds(_))
            && (params.queries || params.quality == 100 || params.budget == Budget::Percent(100.0))
    }
}

/// Parameters of Sections 3 and 4.
fn paper_knobs(params: &mut Params, knobs: &mut dyn Knobs) {
    let cells = Knob::new("tessellation", "", "which cells space is divided into", section!("4.3"));
    knobs.words(cells, &mut params.tessellation);
    let meaning = "how much is drawn: a number of primitives, a share of the scene such as 10%, or what fits \
                   into a time such as 5ms";
    knobs.budget(Knob::new("budget", "primitives", meaning, section!("3")), true, &mut params.budget);
    let meaning = "a cell shorter than this share of the scene's longest side is not divided";
    knobs.integer(Knob::new("leaf-size", "%", meaning, section!("4.3")), 1..=100, &mut params.leaf_size);
    rules::knobs(&mut params.rules, &mut params.how, knobs);
}

/// Parameters of the extensions in Section 6.
fn extension_knobs(params: &mut Params, knobs: &mut dyn Knobs) {
    let meaning = "how a cell's primitives count: each as one, as in the paper, or by the cosine toward the \
                   eye of those that face it";
    knobs.words(Knob::new("occupancy", "", meaning, section!("6")), &mut params.occupancy);
    let meaning = "cells from which the front grows: that of the eye, and the first with primitives on rays \
                   into the view";
    knobs.integer(Knob::new("seeds", "", meaning, section!("6")), 1..=10_000, &mut params.seeds);
    let meaning = "after the budget each cell left is asked against the z-buffer and drawn unless hidden, so \
                   that nothing visible is missed";
    knobs.switch(Knob::new("queries", "", meaning, section!("6")), &mut params.queries);
    let meaning =
        "the budget grows until at least so many of the pixels can no longer change; 0: it does not grow";
    knobs.integer(Knob::new("quality", "%", meaning, section!("6")), 0..=100, &mut params.quality);
}

impl<S: Cellular + Faces> State<S, LayeredProjection> for Front {
    // A copy takes up to 28 bytes a cell, a note with its events about 100. So with 100,000 cells (the
    // paper's largest scene has 60,000, Section 5.1) all keyframes together take less memory than the film,
    // however long it is; `tests` holds it to that. Replaying this many notes takes some milliseconds, so
    // that seeking stays within one displayed frame.
    const KEYFRAME_NOTES: usize = 1 << 15;
    fn begin(&mut self, frame: &Frame<'_, S, LayeredProjection>) {
        self.clear(frame.index.count());
    }
    fn apply(&mut self, _: &Scene<S>, note: &Evidence<S>) {
        note.apply(self);
    }
}

impl<S: Cellular + Faces> Shown<S> for LayeredProjection {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        explain::draw(moment.state, &moment.frame, moment.note, to);
    }
    const PICTURES: &'static [&'static str] = picture::PICTURES;
    // No picture shows depths, so their scale is not used.
    fn picture(moment: &Moment<'_, S, Self>, which: usize, _: DepthScale) -> Drawing {
        picture::picture(moment.state, moment.notes, which)
    }
}
