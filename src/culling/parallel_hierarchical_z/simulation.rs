//! A frame of the machine, as a discrete-event simulation in whole ticks.
//!
//! Events are taken by time, then in the order in which they were made, so a frame is the same on every
//! computer. What is queried at a tick is answered from what was rasterized before it, by the same queries as
//! in the sequential form.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::Params;
use super::code::line;
use super::dealing::{Allotment, Processor, dealt, group_of};
use super::evidence::Evidence;
use super::machine::{Job, Machine, Unit, Volume, Worked, ticks};
use super::screen::Screen;
use crate::culling::cubes::{Check, CubeNote};
use crate::culling::depth::{
    Answer, Answered, Buffer, Decisive, DepthNote, Faces, Ground, Query, QueryReporter, Rasterized, Step,
    footprint, project_sphere,
};
use crate::drawing::Subject;
use crate::geometry::{
    Aabb, BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, View,
    nearest_depth,
};
use crate::index::Octree;
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Frame, Method, Observer, Verdict};
use crate::raster::Options;
use crate::scene::Scene;

/// What the machine keeps from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    /// What each processor has; none before the first frame.
    allotments: Vec<Allotment>,
    /// Primitives that each region received in the last frame.
    load: Vec<u32>,
}

/// A message to a renderer.
#[derive(Clone, Debug)]
enum Message {
    /// Primitives of a structure for a region.
    Draw { region: u32, node: NodeId, prims: Vec<PrimId> },
    /// A box for a region.
    Ask { region: u32, question: usize },
    /// Asks a renderer, for a processor, for the farthest depths of its regions.
    Farthest { renderer: u16, processor: u16 },
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    /// A processor is free.
    Free(u16),
    /// A message arrives.
    Arrives(usize),
    /// A renderer is done with a message.
    Done(u16, usize),
    /// An answer arrives.
    Answered(usize, bool),
    /// Farthest depths arrive: the number of the reply.
    Told(usize),
}

/// A box that was sent out.
struct Question<S: Faces> {
    processor: u16,
    /// The structures that it decides, as the processor numbers them.
    structures: Vec<usize>,
    /// Whether they are on the visible list and checked against the finished image.
    is_check: bool,
    node: NodeId,
    bounds: Aabb<S::Vector>,
    /// The box of all that is drawn with what it holds.
    whole: Aabb<S::Vector>,
    image: BoxImage,
    /// Regions that have not answered yet.
    open: u32,
    /// Whether any of them reported that something is left on.
    is_seen: bool,
    answer: Answer,
}

/// Farthest depths of regions, for a processor.
struct Reply {
    processor: u16,
    farthest: Vec<(u32, f32)>,
}

/// One frame of the machine.
pub(super) struct Simulation<'a, S: Faces, O> {
    index: &'a Octree<S::Vector>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    params: &'a Params,
    machine: &'a Machine,
    frustum: Frustum<S::Vector>,
    projection: Projection<S::Vector>,
    buffer: &'a mut Buffer<S>,
    lists: &'a mut Lists,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
    /// Shared primitives that were drawn, by id.
    drawn: Vec<bool>,
    /// Nodes whose structure is out of view, and those that are so with all below them.
    outside: Vec<bool>,
    wholly_outside: Vec<bool>,
    processors: Vec<Processor>,
    screen: Screen,
    /// The farthest depth of each region, if nothing was drawn in it since it was found.
    farthest: Vec<Option<f32>>,
    questions: Vec<Question<S>>,
    messages: Vec<Message>,
    replies: Vec<Reply>,
    /// Whether the image is finished and visible lists are checked.
    is_checking: bool,
    /// What happens at which tick; the second number keeps the order in which events were made.
    events: BinaryHeap<Reverse<(u32, u64, What)>>,
    made: u64,
    now: u32,
}

impl<'a, S: Faces, O: Observer<Evidence<S>>> Simulation<'a, S, O> {
    /// A frame that is yet to be run.
    pub fn new<M: Method<S, Params = Params, Index = Octree<S::Vector>>>(
        frame: &Frame<'a, S, M>,
        buffer: &'a mut Buffer<S>,
        lists: &'a mut Lists,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let Frame { index, scene, view, params, .. } = *frame;
        let nodes = index.nodes().len();
        Self {
            index,
            scene,
            view,
            params,
            machine: &params.machine,
            frustum: view.frustum(),
            projection: view.projection(),
            buffer,
            lists,
            out,
            watch,
            drawn: vec![false; scene.prim_count()],
            outside: vec![false; nodes],
            wholly_outside: vec![false; nodes],
            processors: Vec::new(),
            screen: Screen::default(),
            farthest: vec![],
            questions: vec![],
            messages: vec![],
            replies: vec![],
            is_checking: false,
            events: BinaryHeap::new(),
            made: 0,
            now: 0,
        }
    }

    /// Runs the frame.
    pub fn run(mut self) {
        self.watch.stage("simulate");
        self.line(line::FRAME);
        // 1. Section 4.1.
        self.deal();
        self.leave_out();
        self.sort();
        // 2. Section 5.1. Memory of the last frame decides only where the allocation is dynamic.
        self.line(line::ALLOCATE);
        let View { width, height, .. } = *self.view;
        self.screen = Screen::new(width, height, self.machine, &mut self.lists.load);
        self.farthest = vec![None; self.screen.count()];
        // 3. Every processor begins on its own; "the visible and invisible stages of rendering will not be
        // synchronized among the processors" (Section 4.2).
        self.line(line::START);
        for p in 0..self.processors.len() {
            self.line(line::PROCESS);
            self.after(0, What::Free(p as u16));
        }
        self.simulate();
        self.report_unseen();
        // 4. Sections 4.2 and 5.1. Without coherence every structure is queried anew in each frame.
        if self.params.coherence {
            self.watch.stage("check");
            self.line(line::CHECK_ALL);
            self.check();
        }
    }
    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }
    /// Takes events until nothing is left to happen.
    fn simulate(&mut self) {
        while let Some(Reverse((now, _, what))) = self.events.pop() {
            self.now = now;
            match what {
                What::Free(p) => self.next_of_processor(p),
                What::Arrives(message) => self.arrives(message),
                What::Done(r, message) => self.done(r, message),
                What::Answered(question, is_seen) => self.answered(question, is_seen),
                What::Told(reply) => self.told(reply),
            }
        }
    }
    fn after(&mut self, ticks: u32, what: What) {
        self.made += 1;
        self.events.push(Reverse((self.now.saturating_add(ticks), self.made, what)));
    }
    /// A processor works from now on, for so many ticks.
    fn works(&mut self, p: u16, job: Job, cost: u32, node: NodeId, count: usize) {
        let (from, to) = (self.now, self.now.saturating_add(cost));
        let (unit, count) = (Unit::Processor(p), count as u32);
        self.watch.note(move || Evidence::Worked(Worked { unit, job, from, to, node, region: 0, count }));
    }
    /// A renderer has worked until now, for so many ticks.
    fn has_worked(&mut self, r: u16, job: Job, cost: u32, node: NodeId, region: u32, count: usize) {
        let (from, to) = (self.now.saturating_sub(cost), self.now);
        let (unit, count) = (Unit::Renderer(r), count as u32);
        self.watch.note(move || Evidence::Worked(Worked { unit, job, from, to, node, region, count }));
    }

    /// Deals the structures out, once (Section 4.1). All begin as invisible (Section 5.1).
    fn deal(&mut self) {
        let count = self.machine.processors as usize;
        if self.lists.allotments.is_empty() {
            self.line(line::DEAL);
            self.lists.allotments = dealt(self.index, self.machine.distribution, count);
        }
        if !self.params.coherence {
            let structures = self.lists.allotments.iter_mut().flat_map(|a| &mut a.structures);
            structures.for_each(|s| s.is_listed = false);
        }
        self.processors.resize_with(count, Processor::default);
    }
    /// Leaves out what is out of view: cubes with all below them, and structures of cubes that are not. They
    /// keep their places on the lists (Section 5.1): what leaves the view by turning is mostly still visible
    /// when the view turns back.
    fn leave_out(&mut self) {
        let all = Frustum::<S::Vector>::ALL;
        self.line(line::OUTSIDE);
        for at in 0..self.index.nodes().len() {
            let node = NodeId(at as u32);
            if self.index.parent_of(node).is_some_and(|parent| self.wholly_outside[parent.at()]) {
                (self.outside[at], self.wholly_outside[at]) = (true, true);
                continue;
            }
            let n = &self.index.nodes()[at];
            let test = self.frustum.test(&n.bounds, all);
            if matches!(test, FrustumTest::Outside(_)) {
                (self.outside[at], self.wholly_outside[at]) = (true, true);
                self.watch.event(Event::Entered(node));
                self.line(line::OUTSIDE);
                let bounds = &n.bounds;
                self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(node), bounds, all, test)));
                self.watch.event(Event::DecidedNode(node, Verdict::Outside));
                self.watch.event(Event::Left(node));
                continue;
            }
            let (held, own) = (&n.held, self.index.own(node));
            let test = self.frustum.test(held, all);
            // Also where it is empty: then nobody has such a structure.
            if matches!(test, FrustumTest::Outside(_)) {
                self.outside[at] = true;
                self.line(line::OUTSIDE);
                for &prim in own {
                    // Of each primitive, not of the node: what lies below it are other structures.
                    let subject = Subject::Prim(prim);
                    self.watch.note(move || Evidence::Tested(Tested::of(subject, held, all, test)));
                    self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
                }
            }
        }
    }
    /// Sorts each processor's lists (Section 4.2).
    fn sort(&mut self) {
        let (index, view, distribution) = (self.index, self.view, self.machine.distribution);
        for (processor, allotment) in self.processors.iter_mut().zip(&self.lists.allotments) {
            let structures = &allotment.structures;
            processor.sort(structures, distribution, &self.outside, index, view, &self.projection);
        }
    }

    /// What a processor that is free does next.
    fn next_of_processor(&mut self, p: u16) {
        let now = self.now;
        let processor = &mut self.processors[p as usize];
        if let Some(since) = processor.idle.take()
            && since < now
        {
            let (unit, job, node) = (Unit::Processor(p), Job::Wait, NodeId(0));
            let waited = Worked { unit, job, from: since, to: now, node, region: 0, count: 0 };
            self.line(line::WAIT);
            self.watch.note(move || Evidence::Worked(waited));
        }
        let processor = &mut self.processors[p as usize];
        // Section 5.1: first its visible list, then the invisible one. What an answer let through comes
        // before both: it waits for nothing, and it may hide what is queried next.
        if let Some(s) = processor.found.pop_front() {
            processor.added += 1;
            self.line(line::DRAW_FOUND);
            self.transform(p, s, Job::DrawFound);
        } else if let Some(s) = processor.to_draw.pop_front() {
            processor.has_drawn = true;
            self.line(line::EACH_VISIBLE);
            self.line(line::DRAW_VISIBLE);
            self.transform(p, s, Job::DrawVisible);
        } else if processor.waiting > 0 && !self.machine.overlap {
            // Without the overlap of Section 5.3 it waits for the reply before it queries again.
            processor.idle = Some(now);
        } else if self.machine.farthest_first
            && processor.has_drawn
            && !processor.has_asked
            && !processor.to_ask.is_empty()
        {
            // Section 5.3: "a good time to do this might be after the visible list has been rendered, when
            // the z-buffer should be almost-complete anyway".
            self.line(line::ASK_FARTHEST);
            self.ask_farthest(p);
        } else if let Some(group) = processor.to_ask.pop_front() {
            self.line(line::TAKE);
            if group.len() > 1 {
                self.line(line::GROUP);
            }
            self.line(line::ASK);
            self.ask(p, group, false);
        } else if let Some(s) = processor.to_check.pop_front() {
            self.line(line::EACH_CHECKED);
            self.line(line::RECHECK);
            self.ask(p, vec![s], true);
        } else if processor.waiting > 0 {
            processor.idle = Some(now);
        }
    }

    /// Transforms a structure and sends it to the renderers of its regions.
    fn transform(&mut self, p: u16, s: usize, job: Job) {
        let structure = &mut self.lists.allotments[p as usize].structures[s];
        structure.is_listed = true;
        let (node, own) = (structure.node, structure.own);
        let prims = structure.prims.clone();
        let cost = ticks(self.machine.transform, prims.len());
        // All that is decided until it is left rests on this.
        self.watch.event(Event::Entered(node));
        self.line(line::DRAW);
        self.works(p, job, cost, node, prims.len());
        self.watch.event(Event::DecidedNode(node, Verdict::Partial));
        let mut bins: BTreeMap<u32, Vec<PrimId>> = BTreeMap::new();
        for (k, prim) in prims.into_iter().enumerate() {
            self.line(line::EACH);
            let is_shared = k >= own;
            // Section 3.1: a shared primitive is marked when it is drawn, so that it is drawn once.
            if is_shared && std::mem::replace(&mut self.drawn[prim.at()], true) {
                self.line(line::DRAWN);
            } else {
                self.bin(node, prim, is_shared, &mut bins);
            }
        }
        // By ascending region, so that messages of the same tick have an order.
        for (region, prims) in bins {
            self.lists.load[region as usize] += prims.len() as u32;
            self.send(Message::Draw { region, node, prims }, cost);
        }
        self.watch.event(Event::Left(node));
        self.after(cost, What::Free(p));
    }
    /// Puts a primitive of a structure into the bins of the regions that it may cover, unless it turns its
    /// back.
    fn bin(&mut self, node: NodeId, prim: PrimId, is_shared: bool, bins: &mut BTreeMap<u32, Vec<PrimId>>) {
        let (scene, view) = (self.scene, self.view);
        if self.params.surfaces.leave_out(scene, prim, view.eye.position) {
            self.line(line::FACES_AWAY);
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            return;
        }
        self.line(line::TRANSFORM);
        if is_shared {
            // It is not the structure's alone: that the structure is drawn is no evidence about it.
            self.watch.note(|| Evidence::Cube(CubeNote::SharedDrawn(prim, node)));
        }
        self.out.prims.push(prim);
        self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        let all = PixelRect { x0: 0, x1: view.width, y0: 0, y1: view.height };
        // A primitive that has to be clipped may cover anything.
        let pixels = S::extent(scene, view, prim, &self.options()).map_or(all, |e| e.pixels);
        self.screen.regions(pixels).into_iter().for_each(|r| bins.entry(r).or_default().push(prim));
    }
    fn options(&self) -> Options {
        Options { surfaces: self.params.surfaces, ..Options::default() }
    }
    /// Sends a message that is ready after so many ticks.
    fn send(&mut self, message: Message, ready: u32) {
        self.messages.push(message);
        let number = self.messages.len() - 1;
        self.after(ready.saturating_add(self.machine.message), What::Arrives(number));
    }
    /// Asks every renderer for the farthest depths of its regions (Section 5.3).
    fn ask_farthest(&mut self, p: u16) {
        // About as much as to send out one primitive; the paper gives no cost.
        let cost = self.machine.transform;
        self.works(p, Job::AskFarthest, cost, NodeId(0), 0);
        let processor = &mut self.processors[p as usize];
        processor.has_asked = true;
        processor.waiting += u32::from(self.screen.renderers());
        processor.farthest = vec![0.0; self.screen.count()];
        for renderer in 0..self.screen.renderers() {
            self.send(Message::Farthest { renderer, processor: p }, cost);
        }
        self.after(cost, What::Free(p));
    }

    /// Queries structures of one of a processor's lists: one by its box, several first by the cube above
    /// them.
    fn ask(&mut self, p: u16, structures: Vec<usize>, is_check: bool) {
        let first = self.lists.allotments[p as usize].structures[structures[0]].node;
        let is_group = structures.len() > 1;
        let node = if is_group { group_of(self.index, first) } else { first };
        let n = &self.index.nodes()[node.at()];
        let (bounds, whole) = if is_group { (n.bounds, n.whole) } else { (n.held, n.held_whole) };
        // "The triangles composing the bounding box are transformed and sent to the Renderers" (5.1).
        let (cost, job) = (self.machine.volume_cost(), if is_check { Job::Recheck } else { Job::Ask });
        self.line(line::QUERY);
        self.line(if self.machine.query == Volume::Faces { line::BOX } else { line::SPHERE });
        self.works(p, job, cost, node, structures.len());
        let (image, ground) = self.image(&bounds, &whole);
        let answer = Answer { is_hidden: true, nearest: image.nearest, reads: 0, decisive: None };
        let regions = self.screen.regions(image.pixels);
        let (open, is_seen) = (regions.len() as u32, false);
        let question = Question {
            processor: p,
            structures,
            is_check,
            node,
            bounds,
            whole,
            image,
            open,
            is_seen,
            answer,
        };
        self.questions.push(question);
        let number = self.questions.len() - 1;
        if ground == Ground::CrossesNear {
            self.questions[number].is_seen = true;
            self.decide(number, ground, line::NEAR);
        } else if regions.is_empty() {
            // It lies beside the image, or falls between the pixels' centers.
            self.decide(number, ground, line::NO_PIXEL);
        } else if let Some(closest) = self.behind_farthest(p, &regions, image.nearest) {
            self.questions[number].answer.decisive = Some(closest);
            self.decide(number, Ground::Regions, line::FARTHEST);
        } else if regions.iter().any(|&r| !self.screen.is_held(r)) {
            // With dynamic allocation "only the regions currently assigned to renderers would be accessible"
            // (Section 5.1).
            self.questions[number].is_seen = true;
            self.decide(number, Ground::Unread, line::UNHELD);
        } else {
            self.line(line::SEND);
            if self.machine.overlap {
                self.line(line::MEANWHILE);
            }
            self.processors[p as usize].waiting += 1;
            for region in regions {
                self.send(Message::Ask { region, question: number }, cost);
            }
        }
        self.after(cost, What::Free(p));
    }
    /// Where what stands for a structure falls in the image and how near it comes; nowhere if that decides.
    fn image(&self, bounds: &Aabb<S::Vector>, whole: &Aabb<S::Vector>) -> (BoxImage, Ground) {
        let near = self.view.eye.near;
        let nowhere = BoxImage { pixels: PixelRect::default(), nearest: 1.0 / near };
        let footprint = match self.machine.query {
            Volume::Faces => footprint(self.view, &self.projection, bounds),
            // It is about the wholes already.
            Volume::Sphere => project_sphere(self.view, whole),
        };
        match footprint {
            Footprint::Seen(image) if self.machine.query == Volume::Faces => {
                // A shared primitive is drawn as a whole, and the part outside the cube may come nearer.
                let nearest = nearest_depth(&self.projection, whole, near);
                (BoxImage { nearest, ..image }, Ground::Cells)
            }
            Footprint::Seen(image) => (image, Ground::Cells),
            Footprint::Outside => (nowhere, Ground::BesideImage),
            Footprint::CrossesNear => (nowhere, Ground::CrossesNear),
        }
    }
    /// The shortcut of Section 5.3: if a box lies behind the farthest depth of all its regions, that of the
    /// closest one.
    fn behind_farthest(&self, p: u16, regions: &[u32], nearest: f32) -> Option<Decisive> {
        if !self.machine.farthest_first {
            return None;
        }
        // Depths only come nearer while a frame is drawn: what was told earlier is never too near. What was
        // not told is 0, farther than all.
        let told = &self.processors[p as usize].farthest;
        let farthest = |r: u32| told.get(r as usize).copied().unwrap_or(0.0);
        let closest = regions.iter().copied().min_by(|&a, &b| farthest(a).total_cmp(&farthest(b)))?;
        let held = farthest(closest);
        (nearest < held).then(|| Decisive { cell: self.screen.cell(closest), held, nearest })
    }

    /// A message arrives at the renderer that it is for, or waits for one that takes its region.
    fn arrives(&mut self, message: usize) {
        let renderer = match self.messages[message] {
            Message::Draw { region, .. } | Message::Ask { region, .. } => self.screen.arrive(region, message),
            Message::Farthest { renderer, .. } => {
                self.screen.arrive_at(renderer, message);
                Some(renderer)
            }
        };
        if let Some(renderer) = renderer {
            self.next_of_renderer(renderer);
        }
    }
    /// What a renderer that is free does next: the oldest message, or the next region that waits.
    fn next_of_renderer(&mut self, r: u16) {
        if self.screen.take_next(r) {
            self.line(line::TAKE_REGION);
        }
        if let Some(message) = self.screen.begin(r) {
            self.after(self.cost_of(r, message), What::Done(r, message));
        }
    }
    fn cost_of(&self, r: u16, message: usize) -> u32 {
        match &self.messages[message] {
            Message::Draw { prims, .. } => ticks(self.machine.rasterize, prims.len()),
            Message::Ask { .. } => self.machine.answer,
            Message::Farthest { .. } => ticks(self.machine.answer, self.screen.held_by(r).len().max(1)),
        }
    }
    /// A renderer has finished a message: now it takes effect.
    fn done(&mut self, r: u16, message: usize) {
        let cost = self.cost_of(r, message);
        self.line(line::RENDER);
        match self.messages[message].clone() {
            Message::Draw { region, node, prims } => {
                self.line(line::RASTERIZE);
                self.has_worked(r, Job::Rasterize, cost, node, region, prims.len());
                self.rasterize(&prims, region);
            }
            Message::Ask { region, question } => {
                let is_seen = self.compare(question, region);
                self.line(line::ANSWER);
                let node = self.questions[question].node;
                self.has_worked(r, Job::Answer, cost, node, region, is_seen.into());
                self.after(self.machine.message, What::Answered(question, is_seen));
            }
            Message::Farthest { processor, .. } => {
                let held = self.screen.held_by(r);
                let farthest: Vec<_> = held.into_iter().map(|k| (k, self.farthest_of(k))).collect();
                self.line(line::FIND_FARTHEST);
                self.has_worked(r, Job::Farthest, cost, NodeId(0), 0, farthest.len());
                self.replies.push(Reply { processor, farthest });
                self.after(self.machine.message, What::Told(self.replies.len() - 1));
            }
        }
        self.screen.end(r);
        self.next_of_renderer(r);
    }
    /// Rasterizes primitives in a region, without a test of their own.
    fn rasterize(&mut self, prims: &[PrimId], region: u32) {
        let options = Options { window: Some(self.screen.window(region)), ..self.options() };
        for &prim in prims {
            // Section 5: a renderer compares at every pixel at once, so nothing is tested before.
            let rasterized = Rasterized {
                prim,
                tile: None,
                is_hidden: false,
                is_tested: false,
                surfaces: options.surfaces,
                window: options.window,
            };
            self.watch.note(move || Evidence::Depth(DepthNote::Rasterized(rasterized)));
        }
        self.buffer.step(Step::Draw { scene: self.scene, prims, options });
        self.farthest[region as usize] = None;
    }
    /// Compares a box with what is drawn in a region: whether any pixel of it is left on.
    fn compare(&mut self, question: usize, region: u32) -> bool {
        let Question { image, bounds, whole, node, .. } = self.questions[question];
        let pixels = image.pixels.intersection(self.screen.window(region));
        let line = match self.machine.query {
            Volume::Faces => line::COMPARE_BOX,
            Volume::Sphere => line::COMPARE_SPHERE,
        };
        let reporter = QueryReporter::new(node, Some(line), &mut *self.watch);
        // A departure: the paper's renderer compares all pixels at once and has no use for a pyramid (Section
        // 5). The answer is the same.
        let query = Query::new(&mut *self.buffer, image.nearest, reporter);
        let answer = match self.machine.query {
            Volume::Faces => query.planes(&bounds, &whole, pixels),
            Volume::Sphere => query.rectangle(pixels),
        };
        self.questions[question].answer.join(&answer);
        !answer.is_hidden
    }
    /// The farthest depth in a region: "the capability of a renderer to quickly determine a global maximum z
    /// depth over all pixel-processors" (Section 5.3).
    fn farthest_of(&mut self, region: u32) -> f32 {
        let (window, buffer) = (self.screen.window(region), &*self.buffer);
        *self.farthest[region as usize].get_or_insert_with(|| buffer.farthest_in(window))
    }

    /// An answer has come back.
    fn answered(&mut self, number: usize, is_seen: bool) {
        let question = &mut self.questions[number];
        question.open -= 1;
        question.is_seen |= is_seen;
        // Section 5.1: hidden only if it is "invisible in all screen regions it covers".
        if question.open == 0 {
            let p = question.processor;
            self.processors[p as usize].waiting -= 1;
            self.decide(number, Ground::Cells, line::DECIDE);
            self.wake(p);
        }
    }
    /// Farthest depths have come back.
    fn told(&mut self, reply: usize) {
        let Reply { processor: p, farthest } = &self.replies[reply];
        let (p, processor) = (*p, &mut self.processors[*p as usize]);
        for &(region, depth) in farthest {
            processor.farthest[region as usize] = depth;
        }
        processor.waiting -= 1;
        if self.is_checking && processor.waiting == 0 {
            self.check_list(p);
        }
        self.wake(p);
    }
    fn wake(&mut self, p: u16) {
        if self.processors[p as usize].idle.is_some() {
            self.next_of_processor(p);
        }
    }
    /// All answers are there: structures that may be seen are let through or stay on the list, the others are
    /// hidden or leave it.
    fn decide(&mut self, number: usize, ground: Ground, line: u8) {
        let q = &mut self.questions[number];
        q.answer.is_hidden = !q.is_seen;
        let (p, node, is_check, is_seen) = (q.processor, q.node, q.is_check, q.is_seen);
        let group = std::mem::take(&mut q.structures);
        let (bounds, pixels, answer) = (q.bounds, q.image.pixels, q.answer);
        // All that is decided until it is left rests on this answer.
        self.watch.event(Event::Entered(node));
        self.line(line);
        let is_by_planes = self.machine.query == Volume::Faces;
        self.watch.note(move || {
            let answered = Answered { node, bounds, pixels, answer, ground, is_by_planes };
            Evidence::Depth(DepthNote::Answered(answered))
        });
        // Back where it was asked.
        match (is_check, is_seen) {
            (false, true) => {
                self.line(if group.len() > 1 { line::EACH_OF_GROUP } else { line::FOUND });
                self.processors[p as usize].let_through(group);
            }
            (false, false) => {
                self.line(line::HIDDEN);
                let structures = &self.lists.allotments[p as usize].structures;
                for s in group {
                    // A shared primitive may show in another structure.
                    for &prim in &structures[s].prims[..structures[s].own] {
                        self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
                    }
                }
            }
            (true, true) => {}
            (true, false) => {
                self.line(line::UNLIST);
                let structures = &mut self.lists.allotments[p as usize].structures;
                group.into_iter().for_each(|s| structures[s].is_listed = false);
                self.watch.note(|| Evidence::Cube(CubeNote::Unlisted { node, processor: Some(p) }));
            }
        }
        self.watch.event(Event::Left(node));
    }

    /// Reports the shared primitives that no structure drew.
    fn report_unseen(&mut self) {
        if !self.params.cubes.may_share() {
            return;
        }
        self.line(line::EACH_SHARED);
        // What is passed on by a cube that is out of view was decided with it.
        for at in 0..self.index.nodes().len() {
            if self.wholly_outside[at] {
                continue;
            }
            let node = NodeId(at as u32);
            for &prim in self.index.passed(node) {
                if !std::mem::replace(&mut self.drawn[prim.at()], true) {
                    self.line(line::UNSEEN);
                    self.watch.note(|| Evidence::Cube(CubeNote::SharedUnseen(prim, node)));
                    self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
                }
            }
        }
    }
    /// When the image is finished, takes off the visible lists what it does not show, where that is due. The
    /// processors go on where they ended, so it costs ticks as all they do.
    fn check(&mut self) {
        self.is_checking = true;
        // Where every frame checks, nothing is to be decided by the farthest depth.
        let asks = self.params.check_interval > 1;
        for p in 0..self.processors.len() as u16 {
            self.line(line::CHECK);
            let processor = &mut self.processors[p as usize];
            // What was told while the image was drawn is out of date.
            (processor.has_asked, processor.farthest) = (true, vec![]);
            if asks {
                self.line(line::CHECK_FARTHEST);
                self.ask_farthest(p);
            } else {
                self.check_list(p);
                self.after(0, What::Free(p));
            }
        }
        self.simulate();
    }
    /// Decides whether a processor checks its visible list, by the rules of Section 4.2.
    fn check_list(&mut self, p: u16) {
        let (allotment, processor) =
            (&mut self.lists.allotments[p as usize], &mut self.processors[p as usize]);
        allotment.frames += 1;
        let farthest = processor.farthest.iter().copied().reduce(f32::min).unwrap_or(0.0);
        let listed = allotment.structures.iter().filter(|s| s.is_listed).count() as u32;
        let frames = [allotment.frames, self.params.check_interval];
        let check = Check::new(frames, [processor.added, listed], [farthest, allotment.farthest]);
        let check = Check { processor: Some(p), ..check };
        allotment.farthest = farthest;
        if check.due.is_some() {
            allotment.frames = 0;
            let structures = allotment.structures.iter().enumerate();
            // What is out of view keeps its place.
            let in_view = structures.filter(|(_, s)| s.is_listed && !self.outside[s.node.at()]);
            processor.to_check = in_view.map(|(s, _)| s).collect();
        }
        self.line(line::DUE);
        self.watch.note(move || Evidence::Cube(CubeNote::Checked(check)));
    }
}
