//! `parallel-hierarchical-z`: obscuration culling on a simulated machine of processors, which own structures,
//! and renderers, which own regions of the screen.
//!
//! Georges, "Obscuration Culling on Parallel Graphics Architectures", UNC TR95-017, 1995, Sections 4 and 5.
//! A structure is a bounding volume and its geometry: here a cube of an octree and what it holds itself. A
//! frame ([`simulation`]):
//!
//! 1. structures are dealt out to processors, once (Section 4.1, [`dealing`]);
//! 2. regions of 128 × 128 pixels are given to renderers (Section 5.1, [`screen`]);
//! 3. each processor draws its visible structures by decreasing area on the screen, then queries its
//!    invisible ones by increasing number of primitives (Sections 4.2 and 5.1); meanwhile each renderer
//!    rasterizes what arrives, and answers for a box with whether any pixel of a region is left on (the
//!    all-enables-off bit);
//! 4. every n frames, or early, each processor checks its visible structures against the finished image
//!    (Sections 4.2 and 5.1).
//!
//! Its image is a z-buffer with a pyramid ([`Buffer`]), not tiles as elsewhere: a renderer rasterizes the
//! primitives that arrive, in its region alone, and answers for that region as it is at that tick. Tiles take
//! what a cube holds at once and all over the image, so that a region would know of primitives that have not
//! reached its renderer.
//!
//! Where this differs from the paper, and why: [`DEPARTURES`]. Cost: O(jobs · log jobs) beside what is drawn
//! and queried.

mod code;
mod dealing;
mod evidence;
mod machine;
mod screen;
mod simulation;
#[cfg(test)]
mod tests;
mod timeline;

use std::sync::Arc;

use self::code::{CODE, DEPARTURES, STANDS, has_line};
pub(crate) use self::evidence::Evidence;
use self::machine::{Job, Machine, Worked};
use self::simulation::{Lists, Simulation};
use super::cubes::{CubeNote, Cubes};
use super::depth::{Buffer, DepthNote, Faces, picture};
use crate::drawing::Drawing;
use crate::index::Octree;
use crate::method::{
    Card, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State, keeps_nothing,
    surface_knobs,
};
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub(crate) struct ParallelHierarchicalZ;

/// Parameters of [`ParallelHierarchicalZ`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Params {
    machine: Machine,
    coherence: bool,
    check_interval: u32,
    cubes: Cubes,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            machine: Machine::default(),
            // Section 5.1: each processor draws its visible list first.
            coherence: true,
            // Section 5.1.
            check_interval: 30,
            cubes: Cubes::default(),
            surfaces: Surfaces::default(),
        }
    }
}

/// What is kept from frame to frame.
#[derive(Clone, Default)]
pub(crate) struct Memory {
    lists: Lists,
}

impl<S: Faces> Method<S> for ParallelHierarchicalZ {
    type Params = Params;
    type Index = Octree<S::Vector>;
    type Memory = Memory;
    type State = Buffer<S>;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "parallel-hierarchical-z",
        name: "Parallel hierarchical z-buffer: obscuration culling on a simulated machine",
        summary: "Deals the cubes of an octree out to simulated processors, which draw what was visible and \
                  query renderers, each with regions of the screen, for the rest.",
        paper: "Georges. Obscuration Culling on Parallel Graphics Architectures. UNC TR95-017, 1995, \
                Sections 4 and 5.",
        doi: "",
        conservative: true,
        code: CODE,
        stands: STANDS,
        departures: DEPARTURES,
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        params.machine.unit_knobs(knobs);
        params.machine.cost_knobs(knobs);
        let coherence = Knob::new(
            "coherence",
            "",
            "what was visible in the last frame is drawn first, without a test",
            "Georges 1995, Sections 3.3 and 4.2",
        );
        knobs.switch(coherence, &mut params.coherence);
        let check = Knob::new(
            "check-interval",
            "frames",
            "how often the visible lists are checked against the finished image",
            "Georges 1995, Sections 4.2 and 5.1",
        );
        knobs.integer(check, 1..=1000, &mut params.check_interval);
        params.cubes.knobs(knobs);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        keeps_nothing(saved)?;
        Ok(params.cubes.build(scene, progress))
    }
    fn moved(
        index: &mut Arc<Self::Index>,
        _: &mut Memory,
        scene: &Arc<Scene<S>>,
        _: &Params,
        _: &dyn Progress,
    ) -> Option<()> {
        // The cubes stay, and with them what the lists say of them.
        Arc::make_mut(index).refit(scene);
        Some(())
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Memory,
        buffer: &mut Buffer<S>,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        // Drawing is simulated as well: what a box is compared with depends on what has arrived by then.
        Simulation::new(frame, buffer, &mut memory.lists, out, watch).run();
    }
    fn has_line(params: &Params, line: u8) -> bool {
        has_line(params, line)
    }
}

impl<S: Faces> State<S, ParallelHierarchicalZ> for Buffer<S> {
    // A copy of the images costs as much as drawing about this many primitives.
    const KEYFRAME_NOTES: usize = 1 << 14;
    fn begin(&mut self, frame: &Frame<'_, S, ParallelHierarchicalZ>) {
        self.clear(frame.view);
    }
    fn apply(&mut self, scene: &Scene<S>, note: &Evidence<S>) {
        // Everything else that is recorded leaves the buffer as it is.
        if let Some(step) = note.depth().and_then(|n| n.step(scene)) {
            self.step(step);
        }
    }
}

impl<S: Faces> Shown<S> for ParallelHierarchicalZ {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        if let Some(note) = moment.note {
            let Frame { index, scene, view, .. } = moment.frame;
            note.draw(index, scene, view, to);
        }
    }
    const PICTURES: &'static [&'static str] =
        &["z-pyramid", "z-pyramid, stacked", "visible lists", "parallel timeline"];
    fn picture(moment: &Moment<'_, S, Self>, which: usize, scale: DepthScale) -> Drawing {
        let (buffer, view) = (moment.state, moment.frame.view);
        let reads = || picture::last_reads(moment.notes.iter().rev().map(Evidence::depth));
        match which {
            0 => picture::levels(buffer, view, &reads(), scale),
            1 => picture::stacked(buffer, view, &reads(), scale),
            // These two are drawn from the notes alone.
            2 => lists(moment.notes),
            _ => timeline::timeline(moment.notes),
        }
    }
    fn probe(moment: &Moment<'_, S, Self>, which: usize, at: glam::Vec2) -> Option<String> {
        // Of the pictures only the levels beside each other show cells that are not askew.
        (which == 0).then(|| picture::probe(moment.state, moment.frame.view, at))?
    }
}

/// What was drawn from the lists or found, in order, and what came of every box that was queried.
fn lists<S: Faces>(notes: &[Evidence<S>]) -> Drawing {
    let mut lists = picture::Lists::default();
    for note in notes {
        match note {
            // When a processor takes it, not when its parts arrive; once for each processor that has a share
            // of it.
            Evidence::Worked(Worked { job: Job::DrawVisible, node, .. }) => {
                lists.drawn.push((*node, "from a list"))
            }
            Evidence::Worked(Worked { job: Job::DrawFound, node, .. }) => {
                lists.drawn.push((*node, "passed its test"))
            }
            Evidence::Depth(DepthNote::Answered(a)) => lists.query(a),
            Evidence::Cube(CubeNote::Checked(_)) => lists.is_checking = true,
            Evidence::Cube(CubeNote::Unlisted { node, .. }) => lists.unlisted.push(*node),
            _ => {}
        }
    }
    lists.draw()
}
