//! The traversal of one frame, in the incremental and the two-pass form.

use rayon::prelude::*;

use super::code::line;
use super::evidence::Evidence;
use super::{Form, Params, Volume};
use crate::culling::cubes::{Check, CubeNote};
use crate::culling::depth::{
    Answer, Answered, At, Buffer, DepthNote, Faces, Ground, Held, Listener, Nobody, Query, QueryReporter,
    Rasterized, Step, footprint, project_sphere,
};
use crate::drawing::Subject;
use crate::geometry::{
    BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, Space, Vector, View,
    nearest_depth,
};
use crate::index::{Octree, OctreeNode};
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Frame, Method, Observer, Verdict};
use crate::raster::Options;
use crate::scene::Scene;

/// Buffers that frames reuse. A copy of the memory does not hold them.
#[derive(Default)]
pub(super) struct Scratch {
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
/// Threads that draw: all of the pool that the run was put into, or the calling one alone.
fn threads() -> usize {
    rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads())
}

/// The traversal of one frame.
pub(super) struct Walk<'a, S: Faces, O> {
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
    /// Two-pass form: cubes that are drawn together with others; and what was queried ahead.
    waiting: Vec<NodeId>,
    asked: Vec<Option<bool>>,
    /// Visited cubes that passed primitives on to several children.
    passing: Vec<NodeId>,
    /// Cubes that came onto the list.
    added: u32,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
}

impl<'a, S: Faces, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    /// A frame that is yet to be walked.
    pub(super) fn new<M: Method<S, Params = Params, Index = Octree<S::Vector>>>(
        frame: &Frame<'a, S, M>,
        listed: &'a mut [bool],
        scratch: &'a mut Scratch,
        buffer: &'a mut Buffer<S>,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let Frame { index, scene, view, params, .. } = *frame;
        let Scratch { drawn, cubes, prims } = scratch;
        cubes.clear();
        cubes.resize(index.nodes().len(), false);
        drawn.clear();
        drawn.resize(scene.prim_count(), false);
        Self {
            index,
            scene,
            view,
            frustum: view.frustum(),
            projection: view.projection(),
            params,
            // The rasterizer need not look for back faces, since each cube's primitives are tested as they
            // are gathered.
            options: Options {
                surfaces: params.surfaces.both_sides(),
                threads: threads(),
                ..Options::default()
            },
            buffer,
            drawn,
            cubes,
            prims,
            listed,
            waiting: Vec::new(),
            asked: Vec::new(),
            passing: Vec::new(),
            added: 0,
            out,
            watch,
        }
    }

    /// Steps 1 and 2: draws the visible list, then visits the tree.
    pub(super) fn run(&mut self) {
        self.line(line::FRAME);
        self.line(line::CLEAR);
        // 1. Section 3.3: what was visible in the last frame mostly still is.
        self.watch.stage("draw-listed");
        if self.params.coherence {
            self.line(line::EACH_LISTED);
            self.draw_listed(NodeId(0), Frustum::<S::Vector>::ALL);
        }
        if self.is_two_pass() {
            if self.params.coherence {
                self.line(line::DRAW_KEPT);
                self.draw_together();
            }
            // Nothing is drawn during the visit, so all queries read the same pyramid: once is enough.
            self.line(line::REFRESH_ALL);
            self.refresh(DepthNote::RefreshedAll);
            // A listener is to hear every read in the order of the traversal.
            if self.options.threads > 1 && !O::LISTENS {
                self.ask_ahead();
            }
        }
        // 2. Section 3.2: everything else is drawn unless the pyramid hides its box.
        self.watch.stage("visit");
        self.line(line::VISIT_ROOT);
        self.visit(NodeId(0), Frustum::<S::Vector>::ALL);
        if self.is_two_pass() {
            self.line(line::DRAW_FOUND);
            self.draw_together();
        }
        // A primitive that several cubes share is known to be hidden only when all of them were visited.
        if self.params.cubes.may_share() {
            self.line(line::EACH_SHARED);
            for node in std::mem::take(&mut self.passing) {
                self.report_unseen(node);
            }
        }
    }
    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }

    /// Step 3: takes off the list what the finished image hides, if a check is due (Section 4.2).
    /// `before`: the farthest depth of the frame before, 0 if there was none; `frames`: how many since the
    /// last check. Returns whether it was due, and the farthest depth.
    pub(super) fn check(&mut self, before: f32, frames: u32) -> (bool, f32) {
        self.watch.stage("check");
        let interval = self.params.check_interval;
        // Where every frame checks, nothing is to be decided by the farthest depth.
        let farthest = if interval == 1 { 0.0 } else { self.buffer.farthest_of_all() };
        let listed = self.listed.iter().filter(|l| **l).count() as u32;
        let check = Check::new([frames, interval], [self.added, listed], [farthest, before]);
        self.line(line::CHECK);
        self.watch.note(move || Evidence::Cube(CubeNote::Checked(check)));
        if check.due.is_some() {
            self.unlist(NodeId(0), Frustum::<S::Vector>::ALL);
        }
        (check.due.is_some(), farthest)
    }

    /// Brings the pyramid up to date in the way that a note says.
    fn refresh(&mut self, note: DepthNote<S>) {
        self.watch.note(move || Evidence::Depth(note));
        if let Some(step) = note.step(self.scene) {
            self.buffer.step(step);
        }
    }
    fn is_two_pass(&self) -> bool {
        self.params.form == Form::TwoPass
    }
    /// Draws a cube at one line, now, or keeps it at another, to be drawn with others.
    fn draw_or_keep(&mut self, id: NodeId, [draw, keep]: [u8; 2]) {
        if self.is_two_pass() {
            self.line(keep);
            self.waiting.push(id);
        } else {
            self.line(draw);
            self.draw(id);
        }
    }

    /// Two-pass form on several threads: queries all cubes that the visit will query, level by level. The
    /// pyramid does not change meanwhile, so the answers are those of one query after the other.
    fn ask_ahead(&mut self) {
        self.asked.clear();
        self.asked.resize(self.index.nodes().len(), None);
        // What threads share: the observer is not among it.
        let (index, buffer, frustum, cubes) = (self.index, &*self.buffer, &self.frustum, &*self.cubes);
        let (view, projection, params) = (self.view, &self.projection, self.params);
        let is_hidden = |id: NodeId| {
            let node = &index.nodes()[id.at()];
            match question(node, view, projection, params) {
                Question::Decided(ground) => ground != Ground::CrossesNear,
                Question::Open(image, nearest) => {
                    ask(Query::new(buffer, nearest, Nobody), params, node, image.pixels).is_hidden
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
            // A level at a time: below a hidden cube nothing is queried.
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
        // Nothing below it is drawn from the list either, whatever marks there are.
        if !self.listed[id.at()] {
            return;
        }
        let node = &self.index.nodes()[id.at()];
        let cutting = match self.frustum.test(&node.bounds, planes) {
            // Section 5.1: it keeps its mark. What leaves the view by turning is mostly still visible
            // when the view turns back.
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.line(line::EACH_LISTED);
        self.watch.note(|| Evidence::Listed(id, true));
        self.cubes[id.at()] = true;
        self.draw_or_keep(id, [line::DRAW_LISTED, line::KEEP_LISTED]);
        for child in front_to_back(self.index, node, self.view) {
            self.draw_listed(child, cutting);
        }
    }

    fn visit(&mut self, id: NodeId, planes: u8) {
        let index = self.index;
        let node = &index.nodes()[id.at()];
        self.watch.event(Event::Entered(id));
        self.line(line::VISIT);
        self.line(line::VIEW);
        // Planes that the parent lies wholly inside of are not tested again.
        let test = self.frustum.test(&node.bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(id), &node.bounds, planes, test)));
        let cutting = match test {
            FrustumTest::Outside(_) => return self.leave(id, line::OUTSIDE, Verdict::Outside),
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        if self.params.coherence {
            self.line(line::UNLISTED);
        }
        if self.cubes[id.at()] {
            self.watch.note(|| Evidence::Listed(id, false));
            self.watch.event(Event::DecidedNode(id, Verdict::Partial));
        } else {
            self.line(line::OBSCURED);
            let ahead = self.asked.get(id.at()).copied().flatten();
            // Threads must not decide anything: what was asked ahead is what would be asked here.
            debug_assert!(ahead.is_none_or(|ahead| ahead == self.is_obscured(id)), "asked ahead: {id:?}");
            let is_obscured = ahead.unwrap_or_else(|| self.is_obscured(id));
            self.line(line::OBSCURED);
            if is_obscured {
                return self.leave(id, line::HIDDEN, Verdict::Hidden);
            }
            self.watch.event(Event::DecidedNode(id, Verdict::Partial));
            // Section 3.3: what the query does not reject is visible from now on.
            if self.params.coherence {
                self.line(line::ADD);
                self.listed[id.at()] = true;
                self.added += 1;
            }
            self.draw_or_keep(id, [line::DRAW, line::KEEP]);
        }
        if !index.passed(id).is_empty() {
            self.passing.push(id);
        }
        self.line(line::CHILDREN);
        for child in front_to_back(index, node, self.view) {
            self.line(line::CHILD);
            self.visit(child, cutting);
        }
        self.watch.event(Event::Left(id));
    }
    fn leave(&mut self, id: NodeId, line: u8, verdict: Verdict) {
        self.line(line);
        self.watch.event(Event::DecidedNode(id, verdict));
        self.watch.event(Event::Left(id));
    }

    /// Draws what a cube holds and is not drawn yet.
    fn draw(&mut self, id: NodeId) {
        self.line(line::DRAW_CUBE);
        self.prims.clear();
        self.gather(id);
        if self.prims.is_empty() {
            return;
        }
        let bounds = &self.index.nodes()[id.at()].bounds;
        if self.params.primitive_test
            && let Footprint::Seen(image) = footprint(self.view, &self.projection, bounds)
        {
            // A departure: the paper's pyramid is always up to date (Section 3.2). Here no more tiles are
            // refreshed than there are primitives that could be left out because of it.
            self.line(line::REFRESH);
            let (pixels, most) = (image.pixels, self.prims.len() as u32);
            self.refresh(DepthNote::RefreshedUnder(pixels, most));
        }
        self.rasterize();
    }
    /// Draws what the cubes hold that were kept, all at once.
    fn draw_together(&mut self) {
        self.line(line::DRAW_CUBE);
        self.prims.clear();
        std::mem::take(&mut self.waiting).into_iter().for_each(|node| self.gather(node));
        self.rasterize();
    }
    /// Adds what a cube holds, is not drawn yet and faces the eye to the primitives at hand.
    fn gather(&mut self, id: NodeId) {
        self.line(line::GATHER);
        let (index, scene, view) = (self.index, self.scene, self.view);
        let first = self.prims.len();
        self.prims.extend_from_slice(index.own(id));
        // Section 3.1: a small primitive that crosses dividing planes is marked when it is drawn, so that it
        // is drawn once.
        for &prim in index.shared(id) {
            if !std::mem::replace(&mut self.drawn[prim.at()], true) {
                self.prims.push(prim);
            }
        }
        if !self.params.surfaces.one_sided {
            return;
        }
        // In place: the primitives of other cubes before `first` stay.
        let mut kept = first;
        for at in first..self.prims.len() {
            let prim = self.prims[at];
            if scene.faces_away(prim, view.eye.position) {
                self.line(line::FACES_AWAY);
                self.watch.note(move || Evidence::Facing(Facing::of(prim)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            } else {
                self.prims[kept] = prim;
                kept += 1;
            }
        }
        self.prims.truncate(kept);
    }

    /// Draws the primitives at hand, and reports what became of each.
    fn rasterize(&mut self) {
        let threads = if self.prims.len() < PARALLEL_PRIMS { 1 } else { self.options.threads };
        let (scene, options) = (self.scene, &Options { threads, ..self.options });
        // Greene, Kass and Miller 1993, Section 3.2: the pyramid also rejects single primitives.
        let is_sieved = self.params.primitive_test;
        let step = Step::Draw { scene, prims: self.prims, options: *options, is_sieved };
        let hidden = self.buffer.step(step).to_vec();
        // What was left out comes in the order of the primitives.
        let mut next_hidden = hidden.iter().peekable();
        self.line(line::EACH);
        for at in 0..self.prims.len() {
            let prim = self.prims[at];
            let is_hidden = next_hidden.next_if(|&&h| h == prim).is_some();
            if is_sieved {
                self.line(line::TEST);
            }
            if !is_hidden {
                self.line(line::RASTERIZE);
            }
            let buffer = &*self.buffer;
            self.watch.note(move || {
                // What was compared can still be read after drawing, which refreshes nothing.
                let operands = is_sieved.then(|| buffer.operands(scene, prim, options)).flatten();
                let (surfaces, window) = (options.surfaces, None);
                let rasterized = Rasterized { prim, operands, is_hidden, is_sieved, surfaces, window };
                Evidence::Depth(DepthNote::Rasterized(rasterized))
            });
            if is_hidden {
                self.line(line::SKIP);
                self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
            } else {
                self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
                self.out.prims.push(prim);
            }
        }
    }

    /// Whether the pyramid hides a cube.
    fn is_obscured(&mut self, node: NodeId) -> bool {
        let cube = &self.index.nodes()[node.at()];
        let question = question(cube, self.view, &self.projection, self.params);
        self.line(line::QUERY);
        self.line(line::NEAR);
        let decided = |is_hidden: bool, nearest: f32| Answer { is_hidden, nearest, reads: 0, decisive: None };
        let (pixels, answer, ground) = match question {
            Question::Decided(Ground::CrossesNear) => {
                self.line(line::CROSSES);
                (PixelRect::default(), decided(false, 1.0 / self.view.eye.near), Ground::CrossesNear)
            }
            Question::Decided(ground) => {
                self.line(line::NO_PIXEL);
                (PixelRect::default(), decided(true, 1.0 / self.view.eye.near), ground)
            }
            Question::Open(image, nearest) if image.pixels.is_empty() => {
                self.line(line::NO_PIXEL);
                (image.pixels, decided(true, nearest), Ground::Cells)
            }
            Question::Open(image, nearest) => {
                self.line(match self.params.query {
                    Volume::Planes => line::PLANES,
                    Volume::Rectangles => line::RECTANGLE,
                    Volume::Sphere => line::SPHERE,
                });
                let reporter = QueryReporter::new(node, line_of, &mut *self.watch);
                let query = Query::new(&mut *self.buffer, nearest, reporter);
                (image.pixels, ask(query, self.params, cube, image.pixels), Ground::Cells)
            }
        };
        let (bounds, is_by_planes) = (cube.bounds, self.params.query == Volume::Planes);
        self.watch.note(move || {
            let answered = Answered { node, bounds, pixels, answer, ground, is_by_planes };
            Evidence::Depth(DepthNote::Answered(answered))
        });
        answer.is_hidden
    }

    /// Reports the primitives that a cube passed on and none of its children drew.
    fn report_unseen(&mut self, id: NodeId) {
        for &prim in self.index.passed(id) {
            if !self.drawn[prim.at()] {
                self.line(line::UNSEEN);
                self.watch.note(|| Evidence::Cube(CubeNote::SharedUnseen(prim, id)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
            }
        }
    }

    /// Takes cubes off the list that the finished image hides.
    fn unlist(&mut self, id: NodeId, planes: u8) {
        if !self.listed[id.at()] {
            return;
        }
        let node = &self.index.nodes()[id.at()];
        let cutting = match self.frustum.test(&node.bounds, planes) {
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.line(line::EACH_CHECKED);
        self.line(line::CHECK_OBSCURED);
        let is_obscured = self.is_obscured(id);
        self.line(line::CHECK_OBSCURED);
        if is_obscured {
            self.line(line::UNLIST);
            self.unmark(id);
            self.watch.note(|| Evidence::Cube(CubeNote::Unlisted { node: id, processor: None }));
            return;
        }
        for child in node.children() {
            self.unlist(NodeId(child), cutting);
        }
    }
    /// Takes a cube and all below it off the list.
    fn unmark(&mut self, id: NodeId) {
        // Nothing is listed below a cube that is not: a mark that stayed would list a cube again that was
        // hidden in the last frame, as soon as one above it is seen.
        if std::mem::replace(&mut self.listed[id.at()], false) {
            self.index.nodes()[id.at()].children().for_each(|child| self.unmark(NodeId(child)));
        }
    }
}

/// What there is to query for a cube.
enum Question {
    /// Nothing: it reaches the near plane and counts as visible, or lies beside the image.
    Decided(Ground),
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
    let is_sphere = params.query == Volume::Sphere;
    match if is_sphere {
        project_sphere(view, &node.whole)
    } else {
        footprint(view, projection, &node.bounds)
    } {
        // The sphere is that about the wholes already.
        Footprint::Seen(image) if is_sphere || node.whole == node.bounds => {
            Question::Open(image, image.nearest)
        }
        // A shared primitive is drawn as a whole, and the part outside the cube may come nearer.
        Footprint::Seen(image) => {
            Question::Open(image, nearest_depth(projection, &node.whole, view.eye.near))
        }
        // Beside the view, but not by enough for the frustum's test.
        Footprint::Outside => Question::Decided(Ground::BesideImage),
        Footprint::CrossesNear => Question::Decided(Ground::CrossesNear),
    }
}

/// Queries a cube in the way that the parameters say.
fn ask<S: Faces, B: Held<S>, L: Listener>(
    query: Query<'_, S, B, L>,
    params: &Params,
    node: &OctreeNode<S::Vector>,
    pixels: PixelRect,
) -> Answer {
    match params.query {
        Volume::Planes => query.planes(&node.bounds, &node.whole, pixels),
        Volume::Rectangles | Volume::Sphere => query.rectangle(pixels),
    }
}

/// The lines of a query.
fn line_of(at: At) -> Option<u8> {
    Some(match at {
        At::Cell => line::CELL,
        At::AskCell => line::ASK_CELL,
        At::Seen => line::SEEN,
        At::Hidden => line::ALL_HIDDEN,
        At::Descent => line::DESCENT,
        At::Compare => line::COMPARE,
        At::Hides => line::HIDES,
        At::Covers => line::COVERS,
        At::Shows => line::SHOWS,
        At::Below => line::BELOW,
        At::AskBelow => line::ASK_BELOW,
        At::BelowShows => line::BELOW_SHOWS,
        At::BelowHides => line::BELOW_HIDES,
    })
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
    // Equally near ones by number, so that every run has the same order.
    order.sort();
    order.into_iter().take(node.children().len()).map(|(_, child)| child)
}
