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
//! Departures: the cost of an operation is a parameter, not that of a Pixel-Planes 5; a processor of the
//! hybrid distribution first queries the cube above several of its invisible structures (the paper leaves
//! open how it recombines its allotment into a tree); what is out of view is left out before the machine
//! begins, whole cubes at a time; marks of shared primitives are known to all processors at once, as on a
//! machine with shared memory; with dynamic allocation a renderer that is free gives its region up for the
//! next one (on the machine a region is finished when all its primitives are known), and a region that no
//! renderer holds counts as seen, since it cannot be queried; a sphere is compared by its screen rectangle.
//! Cost: O(jobs · log jobs) beside what is drawn and queried.

mod dealing;
mod evidence;
mod machine;
mod screen;
mod simulation;
#[cfg(test)]
mod tests;
mod timeline;

use std::sync::Arc;

pub(crate) use self::evidence::Evidence;
use self::machine::{Job, Machine, Worked};
use self::simulation::{Lists, Simulation};
use super::cubes::{CubeNote, Cubes};
use super::depth::{Buffer, DepthNote, Faces, picture};
use crate::drawing::Drawing;
use crate::index::Octree;
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State,
    backface_knob, keeps_nothing,
};
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene};

/// The method.
pub(crate) struct ParallelHierarchicalZ;

/// Parameters of [`ParallelHierarchicalZ`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Params {
    machine: Machine,
    coherence: bool,
    check_interval: u32,
    cubes: Cubes,
    backface_culling: bool,
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
            backface_culling: false,
        }
    }
}

const CODE: &[CodeLine] = &[
    // Section 4.1 for the structures, Section 5.1 for the regions.
    CodeLine::new("Frame:1", "Frame(structures, processors, renderers)"),
    CodeLine::new("Frame:2", "  in the first frame: deal the structures out to the processors"),
    CodeLine::new("Frame:3", "  leave out the structures outside the view"),
    CodeLine::new("Frame:4", "  give the regions of the screen to the renderers"),
    CodeLine::new("Frame:5", "  all at once: Process(its lists), Render(its regions)"),
    CodeLine::new("Frame:6", "  a shared primitive that no structure drew is hidden"),
    // Sections 4.2 and 5.1: not in every frame, since a test may take communication.
    CodeLine::new("Check:1", "Check(visible list V), when the image is finished"),
    CodeLine::new("Check:2", "  ask the renderers for the farthest depths"),
    CodeLine::new("Check:3", "  if n frames passed, many structures are new on V or the farthest depth shifted"),
    CodeLine::new("Check:4", "    for each C of V in view: send its box to its regions"),
    CodeLine::new("Check:5", "      when all have answered: move C to the invisible list, unless one saw it"),
    // Section 5.1, in the orders of Section 4.2. Section 5.3 adds the farthest depths, and that a processor
    // goes on while it waits.
    CodeLine::new("Process:1", "Process(visible list V, invisible list I)"),
    CodeLine::new("Process:2", "  for each C of V, by decreasing area on the screen"),
    CodeLine::new("Process:3", "    Draw(C)"),
    CodeLine::new("Process:4", "  ask the renderers for the farthest depths"),
    CodeLine::new("Process:5", "  for each C of I, by increasing number of primitives"),
    CodeLine::new("Process:6", "    if its box crosses the near plane: C is visible"),
    CodeLine::new("Process:7", "    else if its box covers no pixel: skip C"),
    CodeLine::new("Process:8", "    else if behind the farthest depth of its regions: skip C"),
    CodeLine::new("Process:9", "    else if no renderer holds one of its regions: C is visible"),
    CodeLine::new("Process:10", "    else send its box to its regions"),
    CodeLine::new("Process:11", "  when all regions of C have answered: skip C, unless one saw it"),
    CodeLine::new("Process:12", "    then move C to V; Draw(C)"),
    CodeLine::new("Process:13", "  wait while only answers are to come"),
    // Section 5: processors transform, renderers rasterize.
    CodeLine::new("Draw:1", "Draw(structure C)"),
    CodeLine::new("Draw:2", "  for each primitive p of C that is not drawn yet"),
    CodeLine::new("Draw:3", "    if p faces away: skip it"),
    CodeLine::new("Draw:4", "    transform p; send it to its regions"),
    // Sections 5 and 5.1: whether a pixel is left on is the all-enables-off bit after a box was rasterized
    // without being written.
    CodeLine::new("Render:1", "Render(regions), for each message in order of arrival"),
    CodeLine::new("Render:2", "  primitives: rasterize them"),
    CodeLine::new("Render:3", "  a box: compare its faces with the depths drawn so far"),
    CodeLine::new("Render:4", "    answer whether any pixel is left on"),
    CodeLine::new("Render:5", "  asked for the farthest depths: answer with those of its regions"),
];

/// Lines of [`CODE`] that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const DEAL: u8 = line(CODE, "Frame:2");
    pub const OUTSIDE: u8 = line(CODE, "Frame:3");
    pub const ALLOCATE: u8 = line(CODE, "Frame:4");
    pub const UNSEEN: u8 = line(CODE, "Frame:6");
    pub const CHECK_FARTHEST: u8 = line(CODE, "Check:2");
    pub const CHECK: u8 = line(CODE, "Check:3");
    pub const TAKE_LISTED: u8 = line(CODE, "Check:4");
    pub const UNLIST: u8 = line(CODE, "Check:5");
    pub const DRAW_VISIBLE: u8 = line(CODE, "Process:3");
    pub const ASK_FARTHEST: u8 = line(CODE, "Process:4");
    pub const TAKE: u8 = line(CODE, "Process:5");
    pub const NEAR: u8 = line(CODE, "Process:6");
    pub const NO_PIXEL: u8 = line(CODE, "Process:7");
    pub const FARTHEST: u8 = line(CODE, "Process:8");
    pub const UNHELD: u8 = line(CODE, "Process:9");
    pub const SEND_BOX: u8 = line(CODE, "Process:10");
    pub const DECIDE: u8 = line(CODE, "Process:11");
    pub const DRAW_FOUND: u8 = line(CODE, "Process:12");
    pub const WAIT: u8 = line(CODE, "Process:13");
    pub const FACES_AWAY: u8 = line(CODE, "Draw:3");
    pub const TRANSFORM: u8 = line(CODE, "Draw:4");
    pub const RASTERIZE: u8 = line(CODE, "Render:2");
    pub const COMPARE: u8 = line(CODE, "Render:3");
    pub const ANSWER: u8 = line(CODE, "Render:4");
    pub const FIND_FARTHEST: u8 = line(CODE, "Render:5");
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
        stands: &[],
        departures: &[],
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
        backface_knob(knobs, &mut params.backface_culling);
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
}

impl<S: Faces> State<S, ParallelHierarchicalZ> for Buffer<S> {
    // A copy of the images costs as much as drawing about this many primitives.
    const KEYFRAME_NOTES: usize = 1 << 14;
    fn begin(&mut self, frame: &Frame<'_, S, ParallelHierarchicalZ>) {
        // Queries read depths alone: where nobody looks at the image, it need not know its primitives.
        if frame.depths_only { self.clear_depths(frame.view) } else { self.clear(frame.view) }
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
