//! `layered-projection`: draws what is most likely visible first, until a budget is spent.
//!
//! Klosowski and Silva, "The Prioritized-Layered Projection Algorithm for Visible Set Estimation", IEEE TVCG
//! 6(2), 2000, <https://doi.org/10.1109/2945.856993>. Space is divided into cells ([`index`]); from the cell
//! of the Eye on, the front ([`front`]) grows over neighbors, and always the cell is projected that has the
//! least solidity: an estimate of how much stands between it and the Eye, handed on from cell to cell
//! (Figures 4 to 6, [`walk`]).
//!
//! Departures: the view direction of the transfer is that from the Eye to the cell's center, for a single one
//! says nothing near the rim of a wide view; a transfer against the view direction counts as none, not as
//! negative; where a cell is cut by the view volume, its primitives are tested one by one, as the paper's
//! baseline does; where the front runs dry before the budget does, the nearest cell in view that was not
//! reached starts a new one, so that with an unlimited budget nothing is missed. The penalty is added: the
//! paper leaves it open, and a factor leaves the solidity 0 of empty space as it is, through which the front
//! flows around everything and takes what is behind for as good as what is seen. Two parameters go beyond the
//! paper by default, for they find more (`cullscope paper klosowski-silva-table-1`): `transfer=whole` hands
//! on all solidity in place of its part v · n, for through the oblique faces of tetrahedra that part shrinks
//! from cell to cell; `update=star-shaped` lets the value stand that came through the face toward the Eye,
//! where in the paper the latest one replaces it. `transfer=aligned`, `update=latest` is the paper's
//! arithmetic. Cost: O(cells projected · log front) and the primitives in them; memory O(cells) a frame.

mod explain;
mod front;
mod index;
mod picture;
mod rest;
mod saved;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Arc;

pub use self::explain::{Evidence, Transferred};
pub use self::front::Front;
use self::index::Index;
pub use self::index::node_of;
use self::walk::Walk;
use crate::culling::depth::Faces;
use crate::drawing::Drawing;
use crate::index::tessellation::Cellular;
use crate::method::{
    Budget, Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State,
    backface_knob,
};
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene};

/// The method.
pub struct LayeredProjection;

/// Parameters of [`LayeredProjection`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Which of [`Params::TESSELLATIONS`].
    tessellation: usize,
    budget: Budget,
    /// Per cent of the scene's longest side.
    leaf_size: u32,
    /// Which of [`Params::TRANSFERS`].
    transfer: usize,
    /// Added to the solidity of a cell that is not star-shaped, per cent of a cell that holds ρ_max
    /// primitives.
    penalty: u32,
    /// Which of [`Params::UPDATES`].
    update: usize,
    /// Which of [`Params::OCCUPANCIES`].
    occupancy: usize,
    seeds: u32,
    queries: bool,
    /// Per cent of the pixels; 0: the budget holds.
    quality: u32,
    seed: u32,
    backface_culling: bool,
}

impl Params {
    const TESSELLATIONS: &'static [&'static str] = &["octree", "delaunay", "kd-tree"];
    const DELAUNAY: usize = 1;
    const KD_TREE: usize = 2;
    const TRANSFERS: &'static [&'static str] = &["aligned", "whole"];
    const WHOLE: usize = 1;
    const UPDATES: &'static [&'static str] = &["latest", "star-shaped"];
    const STAR_SHAPED: usize = 1;
    const OCCUPANCIES: &'static [&'static str] = &["count", "front-facing"];
    const FRONT_FACING: usize = 1;
}

impl Default for Params {
    fn default() -> Self {
        Self {
            tessellation: Self::DELAUNAY,
            budget: Budget::Percent(10.0),
            leaf_size: 5,
            transfer: Self::WHOLE,
            penalty: 30,
            update: Self::STAR_SHAPED,
            occupancy: 0,
            seeds: 1,
            queries: false,
            quality: 0,
            seed: 1,
            backface_culling: false,
        }
    }
}

const CODE: &[CodeLine] = &[
    CodeLine { label: "RenderingLoop:1", text: "while the front F is not empty" },
    CodeLine { label: "RenderingLoop:2", text: "  c := the cell of least solidity of F" },
    CodeLine { label: "RenderingLoop:3", text: "  project c" },
    CodeLine { label: "RenderingLoop:4", text: "  if the budget is spent" },
    CodeLine { label: "RenderingLoop:5", text: "    break" },
    CodeLine { label: "RenderingLoop:6", text: "  for each cell n adjacent to c" },
    CodeLine { label: "RenderingLoop:7", text: "    if n is projected or out of view" },
    CodeLine { label: "RenderingLoop:8", text: "      continue" },
    CodeLine { label: "RenderingLoop:9", text: "    ρ := UpdateSolidity(n, c)" },
    CodeLine { label: "RenderingLoop:10", text: "    enqueue n with ρ" },
    CodeLine { label: "UpdateSolidity:1", text: "ρ(B) := |A| / ρ_max + (v · n(B)) ρ(A)" },
    CodeLine { label: "UpdateSolidity:2", text: "if B is not star-shaped toward the eye" },
    CodeLine { label: "UpdateSolidity:3", text: "  ρ(B) := ρ(B) + penalty" },
    CodeLine { label: "UpdateSolidity:4", text: "return ρ(B)" },
    CodeLine { label: "Section 6", text: "after the budget: project c unless the z-buffer hides it" },
];

/// Numbers of the lines that events refer to.
mod line {
    pub const TAKE: u8 = 1;
    pub const PROJECT: u8 = 2;
    pub const SPENT: u8 = 4;
    pub const SKIP: u8 = 7;
    pub const ENQUEUE: u8 = 9;
    pub const PENALTY: u8 = 12;
    pub const ASK: u8 = 14;
}

/// The paper, of which a parameter names the section.
macro_rules! section {
    ($section:literal) => {
        concat!("Klosowski and Silva 2000, Section ", $section)
    };
}

impl<S: Cellular + Faces> Method<S> for LayeredProjection {
    type Params = Params;
    type Index = Index<S>;
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
        code: CODE,
    };
    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let cells = Knob::new("tessellation", "", "which cells space is divided into", section!("4.3"));
        knobs.choice(cells, Params::TESSELLATIONS, &mut params.tessellation);
        let budget = Knob::new(
            "budget",
            "primitives",
            "how much is drawn: a number of primitives, a share of the scene such as 10%, or what fits into \
             a time such as 5ms",
            section!("3"),
        );
        knobs.budget(budget, true, &mut params.budget);
        let leaf = Knob::new(
            "leaf-size",
            "%",
            "a cell shorter than this share of the scene's longest side is not divided",
            section!("4.3"),
        );
        knobs.integer(leaf, 1..=100, &mut params.leaf_size);
        let meaning =
            "how much of a cell's solidity its neighbor gets: v · n of it, as in the paper, or the whole";
        knobs.choice(
            Knob::new("transfer", "", meaning, section!("3.2")),
            Params::TRANSFERS,
            &mut params.transfer,
        );
        let meaning = "added to the solidity of a cell that the eye does not see through the face it is \
                       reached by; 100 is a full cell";
        knobs.integer(Knob::new("penalty", "%", meaning, section!("3.2")), 0..=1000, &mut params.penalty);
        let meaning = "what a cell in the front keeps: the latest solidity, as in the paper, or that from \
                       the face the eye sees it through";
        knobs.choice(Knob::new("update", "", meaning, section!("3.2")), Params::UPDATES, &mut params.update);
        let meaning = "how a cell's primitives count: each as one, as in the paper, or by the cosine toward \
                       the eye of those that face it";
        knobs.choice(
            Knob::new("occupancy", "", meaning, section!("6")),
            Params::OCCUPANCIES,
            &mut params.occupancy,
        );
        let meaning = "cells from which the front grows: that of the eye, and the first with primitives on \
                       rays into the view";
        knobs.integer(Knob::new("seeds", "", meaning, section!("6")), 1..=10_000, &mut params.seeds);
        let meaning = "after the budget each cell left is asked against the z-buffer and drawn unless \
                       hidden, so that nothing visible is missed";
        knobs.switch(Knob::new("queries", "", meaning, section!("6")), &mut params.queries);
        let meaning =
            "the budget grows until at least so many of the pixels can no longer change; 0: it does not grow";
        knobs.integer(Knob::new("quality", "%", meaning, section!("6")), 0..=100, &mut params.quality);
        let seed = Knob::new(
            "seed",
            "",
            "decides how the centers of cells are moved before they are triangulated",
            section!("4.3"),
        );
        knobs.integer(seed, 0..=u32::MAX, &mut params.seed);
        backface_knob(knobs, &mut params.backface_culling);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Index<S>>, String> {
        match saved {
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
    fn is_conservative(params: &Params) -> bool {
        // Queries decide about all that the budget leaves; a budget of everything leaves nothing.
        !matches!(params.budget, Budget::Milliseconds(_))
            && (params.queries || params.budget == Budget::Percent(100.0))
    }
}

impl<S: Cellular + Faces> State<S, LayeredProjection> for Front {
    // A copy of the front takes far longer than replaying a change of it.
    const KEYFRAME_NOTES: usize = 2048;
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
    fn picture(moment: &Moment<'_, S, Self>, which: usize, _: DepthScale) -> Drawing {
        picture::picture(moment.state, moment.notes, which)
    }
}
