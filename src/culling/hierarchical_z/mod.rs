//! `hierarchical-z`: cubes of an octree that a z-pyramid hides are not drawn.
//!
//! Greene, Kass and Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993,
//! <https://doi.org/10.1145/166117.166147>, as Georges, "Obscuration Culling on Parallel Graphics
//! Architectures", UNC TR95-017, 1995, describes it (Section 3), and Georges' parallel form (Sections 4 and
//! 5, [`simulation`]). The cubes that were visible in the last frame are drawn first, which almost completes
//! the z-buffer; the others are drawn if the z-pyramid does not hide their boxes ([`crate::culling::depth`]);
//! in the end those that cannot be seen leave the list of visible ones.
//!
//! Departures: the test asks for the bounds of what a cube holds, not for the cube; the pyramid is brought up
//! to date where it is read, not where it is drawn (see [`crate::raster::Pyramid`]); the list is kept as
//! marks on the tree, so cubes are drawn front to back; a cube on the list whose ancestor left it leaves with
//! it. Cost: O(visible cubes) queries and the drawing of what they hold; memory O(cubes) from frame to frame.

pub mod anatomy;
mod explain;
mod picture;
mod simulation;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use rayon::prelude::*;

pub use self::explain::Evidence;
use self::explain::{Answered, Asked, Check, Rasterized};
use self::simulation::{ALLOCATIONS, DISTRIBUTIONS, Lists, Machine, Simulation};
use crate::culling::depth::{
    Answer, Buffer, FaceImage, Faces, Held, Listener, Nobody, Query, footprint, project_sphere,
};
use crate::drawing::{Drawing, Subject};
use crate::geometry::{
    Aabb, BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, Space, Vector,
    View, nearest_depth,
};
use crate::index::{Octree, OctreeNode, Redistribution, Shape};
use crate::method::evidence::{Facing, Tested, prim_faces_away};
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State, Verdict,
    backface_knob, keeps_nothing,
};
use crate::raster::{DepthScale, Options, PyramidCell};
use crate::scene::{Progress, Scene};

/// The method.
pub struct HierarchicalZ;

/// Parameters of [`HierarchicalZ`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    coherence: bool,
    /// Index into [`FORMS`].
    form: usize,
    /// Index into [`QUERIES`].
    query: usize,
    primitive_test: bool,
    check_interval: u32,
    tree_levels: u32,
    leaf_primitives: u32,
    /// Index into [`Redistribution::ALL`].
    redistribution: usize,
    small_percent: u32,
    machine: Machine,
    backface_culling: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            coherence: true,
            form: 0,
            query: 0,
            primitive_test: true,
            check_interval: 0,
            tree_levels: 12,
            leaf_primitives: 0,
            redistribution: 0,
            small_percent: 12,
            machine: Machine::default(),
            backface_culling: false,
        }
    }
}

/// Ways through a frame: the paper's, where each cube is drawn as soon as it passes; and that of today's
/// engines, where all cubes are asked against the pyramid of what was visible before.
const FORMS: &[&str] = &["incremental", "two-pass"];
/// Volumes and how they are asked for: each front face as projected (the paper), its screen rectangle, a
/// sphere (Section 5.3).
const QUERIES: &[&str] = &["faces", "rectangles", "sphere"];

const CODE: &[CodeLine] = &[
    CodeLine { label: "Frame:1", text: "Frame(visible list L)" },
    CodeLine { label: "Frame:2", text: "  clear the z-buffer and the z-pyramid" },
    CodeLine { label: "Frame:3", text: "  for each cube C of L in view, front to back" },
    CodeLine { label: "Frame:4", text: "    Draw(C)" },
    CodeLine { label: "Frame:5", text: "  Visit(root)" },
    CodeLine { label: "Frame:6", text: "  if a check of L is due" },
    CodeLine { label: "Frame:7", text: "    for each C of L in view: if Obscured(C), remove C" },
    CodeLine { label: "Visit:1", text: "Visit(cube C)" },
    CodeLine { label: "Visit:2", text: "  if C is outside the view: return" },
    CodeLine { label: "Visit:3", text: "  if C is not in L" },
    CodeLine { label: "Visit:4", text: "    if Obscured(C): return" },
    CodeLine { label: "Visit:5", text: "    add C to L; Draw(C)" },
    CodeLine { label: "Visit:6", text: "  for each child D of C, front to back: Visit(D)" },
    CodeLine { label: "Draw:1", text: "Draw(cube C)" },
    CodeLine { label: "Draw:2", text: "  for each primitive p of C that is not drawn yet" },
    CodeLine { label: "Draw:3", text: "    if p is behind its pyramid cells: skip it" },
    CodeLine { label: "Draw:4", text: "    rasterize p; the pyramid follows" },
    CodeLine { label: "Obscured:1", text: "Obscured(cube C)" },
    CodeLine { label: "Obscured:2", text: "  if C crosses the near plane: return false" },
    CodeLine {
        label: "Obscured:3",
        text: "  if C is behind the few cells over its screen rectangle: return true",
    },
    CodeLine { label: "Obscured:4", text: "  for each face F of C toward the eye" },
    CodeLine { label: "Obscured:5", text: "    q := finest cell that covers F on the screen" },
    CodeLine { label: "Obscured:6", text: "    if not Behind(F, q): return false" },
    CodeLine { label: "Obscured:7", text: "  return true" },
    CodeLine { label: "Behind:1", text: "Behind(face F, cell q)" },
    CodeLine { label: "Behind:2", text: "  if the nearest depth of F is behind q: return true" },
    CodeLine { label: "Behind:3", text: "  if q is a pixel or F covers q: return false" },
    CodeLine { label: "Behind:4", text: "  for each cell r of the four below q that F touches" },
    CodeLine { label: "Behind:5", text: "    if not Behind(F, r): return false" },
    CodeLine { label: "Behind:6", text: "  return true" },
];

/// Lines of [`CODE`] that the run names.
mod line {
    pub const CLEAR: u8 = 1;
    pub const DRAW_LISTED: u8 = 3;
    pub const VISIT_ROOT: u8 = 4;
    pub const CHECK: u8 = 5;
    pub const UNLIST: u8 = 6;
    pub const OUTSIDE: u8 = 8;
    pub const IN_LIST: u8 = 9;
    pub const OBSCURED: u8 = 10;
    pub const ADD: u8 = 11;
    pub const CHILD: u8 = 12;
    pub const SKIP: u8 = 15;
    pub const RASTERIZE: u8 = 16;
    pub const NEAR: u8 = 18;
    pub const WHOLE: u8 = 19;
    pub const BEHIND: u8 = 25;
}

/// What is kept from frame to frame.
#[derive(Clone, Default)]
pub struct Memory {
    /// The visible list, as a mark for each cube.
    listed: Vec<bool>,
    /// Frames since the list was checked.
    frames: u32,
    /// The farthest depth of the last image.
    farthest: f32,
    /// The simulated machine's.
    lists: Lists,
    scratch: Scratch,
}

/// Buffers that frames reuse. A copy of the memory does not hold them.
#[derive(Default)]
struct Scratch {
    /// Shared primitives that this frame has drawn, by id.
    drawn: Vec<bool>,
    /// Cubes that were drawn from the list.
    cubes: Vec<bool>,
    /// Primitives of the cube at hand.
    prims: Vec<PrimId>,
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Fewer primitives are drawn on one thread: handing them out would take longer.
const PARALLEL_PRIMS: usize = 2048;
/// The share of new cubes on the list from which on it is checked early (Georges 1995, Section 4.2: "a large
/// number").
const MANY_ADDED: u32 = 4;
/// The change of the farthest depth, as a factor, from which on the list is checked early ("a rapid shift").
const RAPID_SHIFT: f32 = 1.5;

impl<S: Faces> Method<S> for HierarchicalZ {
    type Params = Params;
    type Index = Octree<S::Vector>;
    type Memory = Memory;
    type State = Buffer<S>;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "hierarchical-z",
        name: "Hierarchical z-buffer: obscuration culling with octree and z-pyramid",
        summary: "Draws the cubes that were visible before, then those of an octree whose boxes a pyramid of \
                  farthest depths does not hide.",
        paper: "Georges. Obscuration Culling on Parallel Graphics Architectures. UNC TR95-017, 1995; after \
                Greene, Kass and Miller. Hierarchical Z-Buffer Visibility. SIGGRAPH 1993.",
        doi: "10.1145/166117.166147",
        conservative: true,
        code: CODE,
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let source = "Georges 1995, Section 3.3";
        knobs.switch(
            Knob::new(
                "coherence",
                "",
                "what was visible in the last frame is drawn first, without a test",
                source,
            ),
            &mut params.coherence,
        );
        let form = Knob::new(
            "form",
            "",
            "incremental: a cube is drawn as soon as it passes its test, as in the paper; two-pass: all \
             cubes are tested against what was visible before, as engines do today",
            source,
        );
        knobs.choice(form, FORMS, &mut params.form);
        let query = Knob::new(
            "query",
            "",
            "how a cube is asked for: by its front faces as projected, by their screen rectangles, or by the \
             sphere around it",
            "Georges 1995, Sections 3.2 and 5.3",
        );
        knobs.choice(query, QUERIES, &mut params.query);
        let test = Knob::new(
            "primitive-test",
            "",
            "primitives behind their pyramid cells are not drawn either",
            "Greene, Kass and Miller 1993, Section 3.2",
        );
        knobs.switch(test, &mut params.primitive_test);
        let check = Knob::new(
            "check-interval",
            "frames",
            "how often the visible list is checked against the finished image; 0: every frame, in the \
             parallel form every 30",
            "Georges 1995, Sections 4.2 and 5.1",
        );
        knobs.integer(check, 0..=1000, &mut params.check_interval);
        let source = "Georges 1995, Section 3.1";
        knobs.integer(
            Knob::new("tree-levels", "levels", "levels of the octree at most", source),
            1..=Shape::MOST_LEVELS,
            &mut params.tree_levels,
        );
        knobs.integer(
            Knob::new(
                "leaf-primitives",
                "",
                "a cube with no more primitives is not divided; 0: 128 triangles, 8 segments",
                source,
            ),
            0..=100_000,
            &mut params.leaf_primitives,
        );
        let crossing = Knob::new(
            "redistribution",
            "",
            "where a primitive goes that crosses a cube's dividing planes: hybrid (stays, or if small to all \
             children it overlaps), parent (stays), grown (to one child, whose bounds grow), split (parts to \
             all children)",
            source,
        );
        knobs.choice(crossing, &Redistribution::WORDS, &mut params.redistribution);
        knobs.integer(
            Knob::new(
                "small-percent",
                "%",
                "a primitive is small if it is no longer than this part of its cube",
                source,
            ),
            0..=100,
            &mut params.small_percent,
        );
        machine_knobs(&mut params.machine, knobs);
        backface_knob(knobs, &mut params.backface_culling);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        keeps_nothing(saved)?;
        progress.report(0.0, "building the octree");
        let shape = Shape {
            levels: params.tree_levels,
            leaf_prims: if params.leaf_primitives == 0 { leaf_prims::<S>() } else { params.leaf_primitives },
            redistribution: Redistribution::ALL[params.redistribution],
            small: params.small_percent as f32 / 100.0,
        };
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        Ok(Octree::build(boxes, &shape, &|| progress.cancelled()))
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Memory,
        buffer: &mut Buffer<S>,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        let Frame { index, scene, view, params, .. } = *frame;
        watch.event(Event::FrameBegan);
        memory.listed.resize(index.nodes().len(), false);
        if !params.coherence {
            memory.listed.fill(false);
        }
        let Scratch { drawn, cubes, prims } = &mut memory.scratch;
        cubes.clear();
        cubes.resize(index.nodes().len(), false);
        drawn.clear();
        drawn.resize(scene.prim_count(), false);
        if params.machine.processors > 1 {
            Simulation::new(index, scene, view, params, buffer, drawn, &mut memory.lists, out, watch).run();
            return;
        }
        // Not asked of the rasterizer, since each cube's primitives are asked as they are gathered.
        let options = Options { backface_culling: false, threads: threads(), ..Options::default() };
        let frustum = view.frustum();
        let mut walk = Walk {
            index,
            scene,
            view,
            frustum,
            projection: view.projection(),
            params,
            options,
            buffer,
            drawn,
            cubes,
            prims,
            listed: &mut memory.listed,
            waiting: Vec::new(),
            asked: Vec::new(),
            passing: Vec::new(),
            added: 0,
            out,
            watch,
        };
        walk.run();
        let check = walk.check_due(memory.farthest, memory.frames + 1);
        if check.is_due {
            walk.check(NodeId(0), Frustum::<S::Vector>::ALL);
        }
        (memory.frames, memory.farthest) = (if check.is_due { 0 } else { check.frames }, check.farthest[0]);
    }
}

impl<S: Faces> State<S, HierarchicalZ> for Buffer<S> {
    // A copy of the images costs as much as drawing about this many primitives.
    const KEYFRAME_NOTES: usize = 1 << 14;
    fn begin(&mut self, frame: &Frame<'_, S, HierarchicalZ>) {
        if frame.depths_only { self.clear_depths(frame.view) } else { self.clear(frame.view) }
    }
    fn apply(&mut self, scene: &Scene<S>, note: &Evidence<S>) {
        note.apply(self, scene);
    }
}

impl<S: Faces> Shown<S> for HierarchicalZ {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        if let Some(note) = moment.note {
            note.draw(moment.frame.scene, moment.frame.view, to);
        }
    }
    const PICTURES: &'static [&'static str] = picture::PICTURES;
    fn picture(moment: &Moment<'_, S, Self>, which: usize, scale: DepthScale) -> Drawing {
        picture::picture(moment.state, moment.frame.view, moment.notes, which, scale)
    }
    fn probe(moment: &Moment<'_, S, Self>, which: usize, at: glam::Vec2) -> Option<String> {
        picture::probe(moment.state, moment.frame.view, which, at)
    }
}

/// Primitives of a cube that is not divided. In space a test costs about as much as drawing a dozen
/// triangles, and most cubes that are asked for again and again are visible: 128 was the best of 16 to 128 on
/// generated rooms and cities. Flatland scenes are small and are there to be looked at.
fn leaf_prims<S: Space>() -> u32 {
    if S::CORNERS == 2 { 8 } else { 128 }
}

/// The parameters of the simulated machine.
fn machine_knobs(machine: &mut Machine, knobs: &mut dyn Knobs) {
    let four = "Georges 1995, Section 4.1";
    let five = "Georges 1995, Section 5.1";
    let processors = Knob::new(
        "processors",
        "",
        "graphics processors of a simulated parallel machine; 1: the sequential form, without simulation",
        five,
    );
    knobs.integer(processors, 1..=256, &mut machine.processors);
    knobs.integer(
        Knob::new(
            "renderers",
            "",
            "renderers of the simulated machine, which share the screen's regions of 128 × 128 pixels",
            five,
        ),
        1..=256,
        &mut machine.renderers,
    );
    let distribution = Knob::new(
        "distribution",
        "",
        "what a processor of the simulated machine gets: structures dealt finely (hybrid), whole parts of \
         the scene (structure), or a part of every structure (primitive)",
        four,
    );
    knobs.choice(distribution, DISTRIBUTIONS, &mut machine.distribution);
    let allocation = Knob::new(
        "allocation",
        "",
        "static: every region has its renderer all the time; dynamic: the busiest regions first, the others \
         when a renderer is free",
        five,
    );
    knobs.choice(allocation, ALLOCATIONS, &mut machine.allocation);
    let source = "Georges 1995, Section 5.3";
    knobs.switch(
        Knob::new("overlap-queries", "", "a simulated processor goes on while it waits for answers", source),
        &mut machine.overlap,
    );
    knobs.switch(
        Knob::new(
            "farthest-shortcut",
            "",
            "a simulated processor first compares a box with the farthest depth of each region",
            source,
        ),
        &mut machine.farthest_first,
    );
    let source = "Georges 1995, Section 4.2";
    knobs.integer(
        Knob::new("transform-cost", "ticks", "simulated time to transform a primitive", source),
        1..=10_000,
        &mut machine.transform,
    );
    knobs.integer(
        Knob::new("rasterize-cost", "ticks", "simulated time to rasterize a primitive in a region", source),
        1..=10_000,
        &mut machine.rasterize,
    );
    knobs.integer(
        Knob::new("answer-cost", "ticks", "simulated time in which a renderer answers for a box", source),
        1..=10_000,
        &mut machine.answer,
    );
    knobs.integer(
        Knob::new(
            "message-cost",
            "ticks",
            "simulated time of a message between a processor and a renderer",
            source,
        ),
        0..=10_000,
        &mut machine.message,
    );
}

/// Threads that draw: all of the pool that the run was put into, or the calling one alone.
fn threads() -> usize {
    rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads())
}

/// The traversal of one frame.
struct Walk<'a, S: Faces, O> {
    index: &'a Octree<S::Vector>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    frustum: Frustum<S::Vector>,
    projection: Projection<S::Vector>,
    params: &'a Params,
    options: Options,
    buffer: &'a mut Buffer<S>,
    drawn: &'a mut [bool],
    cubes: &'a mut [bool],
    prims: &'a mut Vec<PrimId>,
    listed: &'a mut [bool],
    /// Two-pass form: cubes that are drawn together with others; and what was asked ahead.
    waiting: Vec<NodeId>,
    asked: Vec<Option<bool>>,
    /// Visited cubes that passed primitives on to several children.
    passing: Vec<NodeId>,
    /// Cubes that came onto the list.
    added: u32,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
}

impl<S: Faces, O: Observer<Evidence<S>>> Walk<'_, S, O> {
    fn run(&mut self) {
        self.watch.event(Event::Line(line::CLEAR));
        self.draw_listed(NodeId(0), Frustum::<S::Vector>::ALL);
        if self.is_two_pass() {
            let listed = std::mem::take(&mut self.waiting);
            self.draw_together(listed);
            self.watch.note(|| Evidence::RefreshedAll);
            self.buffer.refresh_all();
            if self.options.threads > 1 && !O::LISTENS {
                self.ask_ahead();
            }
        }
        self.watch.event(Event::Line(line::VISIT_ROOT));
        self.visit(NodeId(0), Frustum::<S::Vector>::ALL);
        if self.is_two_pass() {
            let found = std::mem::take(&mut self.waiting);
            self.draw_together(found);
        }
        for node in std::mem::take(&mut self.passing) {
            self.say_unseen(node);
        }
    }

    fn is_two_pass(&self) -> bool {
        FORMS[self.params.form] == "two-pass"
    }
    /// Draws a cube, now or with others.
    fn draw_or_wait(&mut self, id: NodeId) {
        if self.is_two_pass() { self.waiting.push(id) } else { self.draw(id) }
    }

    /// Two-pass form on several threads: asks for all cubes that will be asked for, level by level. The
    /// pyramid does not change meanwhile, so the answers are those that asking one by one would give. Not
    /// done while somebody listens, who is to hear of every cell.
    fn ask_ahead(&mut self) {
        self.asked.clear();
        self.asked.resize(self.index.nodes().len(), None);
        // What threads share; who listens is not among it.
        let (index, buffer, frustum, cubes) = (self.index, &*self.buffer, &self.frustum, &*self.cubes);
        let (view, projection, params) = (self.view, &self.projection, self.params);
        let is_hidden = |id: NodeId| {
            let node = &index.nodes()[id.at()];
            match question(node, view, projection, params) {
                Question::Decided { crosses_near } => !crosses_near,
                Question::Open(image, nearest) => {
                    ask(Query::new(buffer, nearest, Nobody), params, &node.bounds, &image, view).is_hidden
                }
            }
        };
        let ask = |&(id, planes): &(NodeId, u8)| match frustum.test(&index.nodes()[id.at()].bounds, planes) {
            FrustumTest::Outside(_) => None,
            FrustumTest::Partial(cutting) => Some((id, cutting, !cubes[id.at()] && is_hidden(id))),
            FrustumTest::Inside => Some((id, 0, !cubes[id.at()] && is_hidden(id))),
        };
        let mut level = vec![(NodeId(0), Frustum::<S::Vector>::ALL)];
        while !level.is_empty() {
            let answers: Vec<_> = level.par_iter().filter_map(ask).collect();
            level.clear();
            for (id, cutting, is_hidden) in answers {
                self.asked[id.at()] = Some(is_hidden);
                if !is_hidden {
                    level.extend(index.nodes()[id.at()].children().map(|c| (NodeId(c), cutting)));
                }
            }
        }
    }

    /// Draws the cubes that are on the list and in view.
    fn draw_listed(&mut self, id: NodeId, planes: u8) {
        if !self.listed[id.at()] {
            return;
        }
        let node = &self.index.nodes()[id.at()];
        let cutting = match self.frustum.test(&node.bounds, planes) {
            // It keeps its mark: who looks back will mostly see it again.
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.watch.event(Event::Line(line::DRAW_LISTED));
        self.watch.note(|| Evidence::Listed(id, true));
        self.cubes[id.at()] = true;
        self.draw_or_wait(id);
        for child in front_to_back(self.index, node, self.view) {
            self.draw_listed(child, cutting);
        }
    }

    fn visit(&mut self, id: NodeId, planes: u8) {
        let index = self.index;
        let node = &index.nodes()[id.at()];
        self.watch.event(Event::Entered(id));
        self.watch.event(Event::Line(line::OUTSIDE));
        let test = self.frustum.test(&node.bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(id), &node.bounds, planes, test)));
        let cutting = match test {
            FrustumTest::Outside(_) => return self.leave(id, Verdict::Outside),
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.watch.event(Event::Line(line::IN_LIST));
        // A mark below a cube that left the list says nothing: such a cube was not drawn.
        if self.cubes[id.at()] {
            self.watch.note(|| Evidence::Listed(id, false));
            self.watch.event(Event::DecidedNode(id, Verdict::Partial));
        } else {
            self.watch.event(Event::Line(line::OBSCURED));
            let ahead = self.asked.get(id.at()).copied().flatten();
            if ahead.unwrap_or_else(|| self.is_obscured(id)) {
                return self.leave(id, Verdict::Hidden);
            }
            self.watch.event(Event::DecidedNode(id, Verdict::Partial));
            self.watch.event(Event::Line(line::ADD));
            self.listed[id.at()] = true;
            self.added += 1;
            self.draw_or_wait(id);
        }
        if !index.passed(id).is_empty() {
            self.passing.push(id);
        }
        for child in front_to_back(index, node, self.view) {
            self.watch.event(Event::Line(line::CHILD));
            self.visit(child, cutting);
        }
        self.watch.event(Event::Left(id));
    }
    fn leave(&mut self, id: NodeId, verdict: Verdict) {
        self.watch.event(Event::DecidedNode(id, verdict));
        self.watch.event(Event::Left(id));
    }

    /// Draws what a cube holds and is not drawn yet.
    fn draw(&mut self, id: NodeId) {
        self.prims.clear();
        self.gather(id);
        if self.prims.is_empty() {
            return;
        }
        let bounds = &self.index.nodes()[id.at()].bounds;
        if self.params.primitive_test
            && let Footprint::Seen(image) = footprint(self.view, &self.projection, bounds)
        {
            let (pixels, most) = (image.pixels, self.prims.len());
            self.watch.note(move || Evidence::RefreshedUnder(pixels, most as u32));
            self.buffer.refresh_under(pixels, most);
        }
        self.rasterize();
    }
    /// Draws what several cubes hold, all at once.
    fn draw_together(&mut self, nodes: Vec<NodeId>) {
        self.prims.clear();
        nodes.into_iter().for_each(|node| self.gather(node));
        self.rasterize();
    }
    /// Adds what a cube holds, is not drawn yet and faces the eye to the primitives at hand.
    fn gather(&mut self, id: NodeId) {
        let (index, scene, view) = (self.index, self.scene, self.view);
        let first = self.prims.len();
        self.prims.extend_from_slice(index.own(id));
        for &prim in index.shared(id) {
            if !std::mem::replace(&mut self.drawn[prim.at()], true) {
                self.prims.push(prim);
            }
        }
        if !self.params.backface_culling {
            return;
        }
        let mut kept = first;
        for at in first..self.prims.len() {
            let prim = self.prims[at];
            if prim_faces_away(scene, view.eye.position, prim) {
                self.watch.note(move || Evidence::Facing(Facing::of(prim)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            } else {
                self.prims[kept] = prim;
                kept += 1;
            }
        }
        self.prims.truncate(kept);
    }

    /// Draws the primitives at hand, and says of each what became of it.
    fn rasterize(&mut self) {
        let threads = if self.prims.len() < PARALLEL_PRIMS { 1 } else { self.options.threads };
        let (scene, options) = (self.scene, &Options { threads, ..self.options });
        let is_sieved = self.params.primitive_test;
        let hidden = if is_sieved {
            self.buffer.draw(scene, self.prims, options).to_vec()
        } else {
            self.buffer.draw_all(scene, self.prims, options);
            vec![]
        };
        let mut next_hidden = hidden.iter().peekable();
        for &prim in self.prims.iter() {
            let is_hidden = next_hidden.next_if(|&&h| h == prim).is_some();
            let buffer = &*self.buffer;
            self.watch.event(Event::Line(if is_hidden { line::SKIP } else { line::RASTERIZE }));
            self.watch.note(move || {
                let operands = buffer.operands(scene, prim, options);
                Evidence::Rasterized(Rasterized {
                    prim,
                    operands,
                    is_hidden,
                    is_sieved,
                    backface_culling: options.backface_culling,
                    window: None,
                })
            });
            self.watch
                .event(Event::DecidedPrim(prim, if is_hidden { Verdict::Hidden } else { Verdict::Visible }));
            if !is_hidden {
                self.out.prims.push(prim);
            }
        }
    }

    /// Whether the pyramid hides a cube.
    fn is_obscured(&mut self, node: NodeId) -> bool {
        let bounds = self.index.nodes()[node.at()].bounds;
        match question(&self.index.nodes()[node.at()], self.view, &self.projection, self.params) {
            Question::Decided { crosses_near } => {
                if crosses_near {
                    self.watch.event(Event::Line(line::NEAR));
                }
                self.answered(node, &bounds, crosses_near)
            }
            Question::Open(image, nearest) => {
                let query =
                    Query::new(&mut *self.buffer, nearest, Asked::new(node, line::BEHIND, &mut *self.watch));
                let answer = ask(query, self.params, &bounds, &image, self.view);
                self.watch.note(move || {
                    Evidence::Answered(Answered {
                        node,
                        bounds,
                        pixels: image.pixels,
                        answer,
                        crosses_near: false,
                    })
                });
                answer.is_hidden
            }
        }
    }
    /// Notes the answer for a box that needs no cell.
    fn answered(&mut self, node: NodeId, bounds: &Aabb<S::Vector>, crosses_near: bool) -> bool {
        let (bounds, nearest) = (*bounds, 1.0 / self.view.eye.near);
        let answer = Answer { is_hidden: !crosses_near, nearest, reads: 0, decisive: None };
        self.watch.note(move || {
            Evidence::Answered(Answered { node, bounds, pixels: PixelRect::default(), answer, crosses_near })
        });
        answer.is_hidden
    }

    /// Says of the primitives that a cube passed on which of them no child could show.
    fn say_unseen(&mut self, id: NodeId) {
        for &prim in self.index.passed(id) {
            if !self.drawn[prim.at()] {
                self.watch.note(|| Evidence::SharedUnseen(prim, id));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
            }
        }
    }

    /// Whether the list is to be checked in this frame (Georges 1995, Section 4.2): at fixed intervals, or
    /// early where many cubes were added or the farthest depth shifted.
    fn check_due(&mut self, before: f32, frames: u32) -> Check {
        let interval = self.params.check_interval.max(1);
        let farthest = if interval == 1 { before } else { self.farthest() };
        let (added, listed) = (self.added, self.listed.iter().filter(|l| **l).count() as u32);
        let shift = if before > 0.0 { (farthest / before).max(before / farthest) } else { 1.0 };
        let is_due = self.params.coherence
            && (frames >= interval || added * MANY_ADDED > listed || shift > RAPID_SHIFT);
        let check = Check { frames, interval, added, listed, farthest: [farthest, before], is_due };
        self.watch.event(Event::Line(line::CHECK));
        self.watch.note(move || Evidence::Checked(check));
        check
    }
    /// The farthest depth of the image.
    fn farthest(&mut self) -> f32 {
        self.watch.note(|| Evidence::RefreshedAll);
        self.buffer.refresh_all();
        self.buffer.farthest(PyramidCell { level: self.buffer.pyramid().root() as u8, x: 0, y: 0 })
    }
    /// Takes cubes off the list that the finished image hides.
    fn check(&mut self, id: NodeId, planes: u8) {
        if !self.listed[id.at()] {
            return;
        }
        let node = &self.index.nodes()[id.at()];
        let cutting = match self.frustum.test(&node.bounds, planes) {
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.watch.event(Event::Line(line::UNLIST));
        if self.is_obscured(id) {
            self.listed[id.at()] = false;
            self.watch.note(|| Evidence::Unlisted(id));
            return;
        }
        for child in node.children() {
            self.check(NodeId(child), cutting);
        }
    }
}

/// What there is to ask for a cube.
enum Question {
    /// Nothing: it reaches the near plane and counts as visible, or lies beside the view.
    Decided { crosses_near: bool },
    /// Whether what lies in this image, and no nearer than this depth, is hidden.
    Open(BoxImage, f32),
}

/// What is asked of the pyramid for a cube, if anything.
fn question<S: Faces>(
    node: &OctreeNode<S::Vector>,
    view: &View<S>,
    projection: &Projection<S::Vector>,
    params: &Params,
) -> Question {
    let is_sphere = QUERIES[params.query] == "sphere";
    match if is_sphere {
        project_sphere(view, &node.whole)
    } else {
        footprint(view, projection, &node.bounds)
    } {
        Footprint::Seen(image) if is_sphere || node.whole == node.bounds => {
            Question::Open(image, image.nearest)
        }
        Footprint::Seen(image) => {
            Question::Open(image, nearest_depth(projection, &node.whole, view.eye.near))
        }
        // Beside the view, but not by enough for the frustum's test.
        Footprint::Outside => Question::Decided { crosses_near: false },
        Footprint::CrossesNear => Question::Decided { crosses_near: true },
    }
}

/// Asks for a box in the way that the parameters say.
fn ask<S: Faces, B: Held<S>, L: Listener>(
    mut query: Query<S, B, L>,
    params: &Params,
    bounds: &Aabb<S::Vector>,
    image: &BoxImage,
    view: &View<S>,
) -> Answer {
    if QUERIES[params.query] == "faces" {
        return query.faces(bounds, image, view);
    }
    query.face(0, &FaceImage::rectangle(image.pixels));
    query.answer
}

/// The children of a cube, those on the eye's side first.
fn front_to_back<S: Space>(
    index: &Octree<S::Vector>,
    node: &OctreeNode<S::Vector>,
    view: &View<S>,
) -> impl Iterator<Item = NodeId> {
    let center = node.cube.center();
    let eye: u8 = (0..S::Vector::AXES).map(|a| u8::from(view.eye.position.get(a) > center.get(a)) << a).sum();
    // A child is nearer the fewer dividing planes lie between it and the eye.
    let mut order = [(u32::MAX, NodeId(0)); 8];
    for (to, child) in order.iter_mut().zip(node.children()) {
        *to = ((index.nodes()[child as usize].octant ^ eye).count_ones(), NodeId(child));
    }
    order.sort();
    order.into_iter().take(node.children().len()).map(|(_, child)| child)
}
