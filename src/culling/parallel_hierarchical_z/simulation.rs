//! A frame of the machine, as a discrete-event simulation in whole ticks.
//!
//! Events are taken by time, then in the order in which they were made, so a frame is the same on every
//! computer. What is queried at a tick is answered from what was rasterized before it, by the same queries as
//! in the sequential form.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::dealing::{Dealer, Processor, Structure, group_of};
use super::evidence::Evidence;
use super::machine::{Job, Machine, Unit, Worked, ticks};
use super::screen::Screen;
use super::{Params, line};
use crate::culling::cubes::CubeNote;
use crate::culling::depth::{
    Answer, Answered, Buffer, DepthNote, Faces, Query, QueryReporter, Rasterized, Step, footprint,
};
use crate::drawing::Subject;
use crate::geometry::{
    Aabb, BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, View,
    nearest_depth,
};
use crate::index::Octree;
use crate::method::evidence::{Facing, Tested, prim_faces_away};
use crate::method::{DrawList, Event, Frame, Method, Observer, Verdict};
use crate::raster::{Options, PyramidCell};
use crate::scene::Scene;

/// Triangles of a box, which a processor transforms to query it.
const BOX_PRIMS: usize = 12;

/// What the machine keeps from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    /// For each processor the structures that were visible, as marks on the tree.
    visible: Vec<Vec<bool>>,
    /// Primitives that each region received.
    load: Vec<u32>,
    /// Frames since the last check.
    frames: u32,
}

/// A message to a renderer.
#[derive(Clone, Debug)]
enum Message {
    Draw { node: NodeId, prims: Vec<PrimId> },
    Ask { question: usize },
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    /// A processor is free.
    Free(u16),
    /// Message `1` arrives for region `0`.
    Arrives(u32, usize),
    /// A renderer is done with a message for a region.
    Done(u16, u32, usize),
    /// An answer arrives.
    Answered(usize, bool),
}

/// A box that was sent out.
struct Question<S: Faces> {
    processor: u16,
    /// The structures that it decides, as the processor numbers them.
    structures: Vec<usize>,
    node: NodeId,
    bounds: Aabb<S::Vector>,
    image: BoxImage,
    /// Regions that have not answered yet.
    open: u32,
    /// Whether any of them reported that something is left on.
    is_seen: bool,
    answer: Answer,
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
    processors: Vec<Processor>,
    screen: Screen,
    questions: Vec<Question<S>>,
    messages: Vec<Message>,
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
            processors: Vec::new(),
            screen: Screen::default(),
            questions: vec![],
            messages: vec![],
            events: BinaryHeap::new(),
            made: 0,
            now: 0,
        }
    }

    /// Runs the frame.
    pub fn run(mut self) {
        self.watch.stage("simulate");
        // 1. Section 4.1.
        self.distribute();
        // 2. Section 5.1. Memory of the last frame decides only where the allocation is dynamic.
        self.watch.event(Event::Line(line::ALLOCATE));
        let View { width, height, .. } = *self.view;
        self.screen = Screen::new(width, height, self.machine, &mut self.lists.load);
        self.lists.load.fill(0);
        // 3. Every processor begins on its own; "the visible and invisible stages of rendering will not be
        // synchronized among the processors" (Section 4.2).
        for p in 0..self.processors.len() {
            self.after(0, What::Free(p as u16));
        }
        while let Some(Reverse((now, _, what))) = self.events.pop() {
            self.now = now;
            match what {
                What::Free(p) => self.next_of_processor(p),
                What::Arrives(region, message) => {
                    if let Some(r) = self.screen.arrive(region, message) {
                        self.next_of_renderer(r);
                    }
                }
                What::Done(r, region, message) => self.done(r, region, message),
                What::Answered(question, is_seen) => self.answered(question, is_seen),
            }
            // Section 5.1, dynamic allocation: "when a renderer finishes it is assigned the next available
            // region".
            if self.events.is_empty() {
                self.screen.release().into_iter().for_each(|r| self.next_of_renderer(r));
            }
        }
        self.report_unseen();
        // 4. Sections 4.2 and 5.1.
        self.watch.stage("check");
        self.check();
    }
    fn after(&mut self, ticks: u32, what: What) {
        self.made += 1;
        self.events.push(Reverse((self.now.saturating_add(ticks), self.made, what)));
    }
    /// A unit works from now on, for so many ticks.
    fn works(&mut self, p: u16, job: Job, cost: u32, node: NodeId, count: usize) {
        let (from, to) = (self.now, self.now.saturating_add(cost));
        let (unit, count) = (Unit::Processor(p), count as u32);
        self.watch.note(move || Evidence::Worked(Worked { unit, job, from, to, node, region: 0, count }));
    }

    /// Deals the structures in view out and sorts each processor's lists (Sections 4.1 and 4.2).
    fn distribute(&mut self) {
        self.watch.event(Event::Line(line::DEAL));
        let (count, nodes) = (self.machine.processors as usize, self.index.nodes().len());
        // Marks stay where processors or nodes became more: these begin as invisible (Section 5.1).
        self.lists.visible.resize(count, vec![]);
        self.lists.visible.iter_mut().for_each(|v| v.resize(nodes, false));
        if !self.params.coherence {
            self.lists.visible.iter_mut().for_each(|v| v.fill(false));
        }
        self.processors.resize_with(count, Processor::default);
        let mut dealer = Dealer::new(self.machine.distribution);
        for at in 0..nodes {
            let node = NodeId(at as u32);
            dealer.enter(self.index.nodes()[at].level);
            let held = self.index.own(node).iter().chain(self.index.shared(node));
            let prims: Vec<PrimId> = held.copied().collect();
            if !prims.is_empty() && !self.is_outside(node) {
                dealer.deal(node, prims, &mut self.processors);
            }
        }
        for (processor, visible) in self.processors.iter_mut().zip(&self.lists.visible) {
            processor.sort(dealer.distribution, visible, self.index, self.view, &self.projection);
        }
    }
    /// Whether a structure is out of view. It keeps its place on the lists (Section 5.1): what leaves the
    /// view by turning is mostly still visible when the view turns back.
    fn is_outside(&mut self, node: NodeId) -> bool {
        let (all, held) = (Frustum::<S::Vector>::ALL, &self.index.nodes()[node.at()].held);
        let test = self.frustum.test(held, all);
        let is_outside = matches!(test, FrustumTest::Outside(_));
        if is_outside {
            self.watch.event(Event::Entered(node));
            for &prim in self.index.own(node) {
                // Of each primitive, not of the node: what lies below it is another structure.
                let subject = Subject::Prim(prim);
                self.watch.note(move || Evidence::Tested(Tested::of(subject, held, all, test)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            }
            self.watch.event(Event::Left(node));
        }
        is_outside
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
            self.watch.note(move || Evidence::Worked(waited));
        }
        let processor = &mut self.processors[p as usize];
        // Section 5.1: first its visible list, then the invisible one. What an answer let through comes
        // before both: it waits for nothing, and it may hide what is queried next.
        if let Some(s) = processor.found.pop_front() {
            self.watch.event(Event::Line(line::DRAW_FOUND));
            self.transform(p, s, Job::DrawFound);
        } else if let Some(s) = processor.to_draw.pop_front() {
            self.watch.event(Event::Line(line::DRAW_VISIBLE));
            self.transform(p, s, Job::DrawVisible);
        } else if processor.waiting > 0 && !self.machine.overlap {
            // Without the overlap of Section 5.3 it waits for the reply before it queries again.
            processor.idle = Some(now);
        } else if let Some(group) = processor.to_ask.pop_front() {
            self.ask(p, group);
        } else if processor.waiting > 0 {
            processor.idle = Some(now);
        }
    }

    /// Transforms a structure and sends it to the renderers of its regions.
    fn transform(&mut self, p: u16, s: usize, job: Job) {
        let Structure { node, prims } = self.processors[p as usize].structures[s].clone();
        self.lists.visible[p as usize][node.at()] = true;
        let cost = ticks(self.machine.transform, prims.len());
        // All that is decided until it is left rests on this.
        self.watch.event(Event::Entered(node));
        self.watch.event(Event::Line(line::TRANSFORM));
        self.works(p, job, cost, node, prims.len());
        self.watch.event(Event::DecidedNode(node, Verdict::Partial));
        let mut bins: BTreeMap<u32, Vec<PrimId>> = BTreeMap::new();
        for prim in prims {
            self.bin(node, prim, &mut bins);
        }
        // By ascending region, so that messages of the same tick have an order.
        for (region, prims) in bins {
            self.lists.load[region as usize] += prims.len() as u32;
            self.send(region, Message::Draw { node, prims }, cost);
        }
        self.watch.event(Event::Left(node));
        self.after(cost, What::Free(p));
    }
    /// Puts a primitive of a structure into the bins of the regions that it may cover, unless it is drawn
    /// already or turns its back.
    fn bin(&mut self, node: NodeId, prim: PrimId, bins: &mut BTreeMap<u32, Vec<PrimId>>) {
        // Section 3.1: a shared primitive is marked when it is drawn, so that it is drawn once.
        let is_shared = self.index.shared(node).contains(&prim);
        if is_shared && std::mem::replace(&mut self.drawn[prim.at()], true) {
            return;
        }
        let (scene, view) = (self.scene, self.view);
        if self.params.backface_culling && prim_faces_away(scene, view.eye.position, prim) {
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            return;
        }
        self.out.prims.push(prim);
        self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        let all = PixelRect { x0: 0, x1: view.width, y0: 0, y1: view.height };
        // A primitive that has to be clipped may cover anything.
        let pixels = S::extent(scene, view, prim, &self.options()).map_or(all, |e| e.pixels);
        self.screen.regions(pixels).into_iter().for_each(|r| bins.entry(r).or_default().push(prim));
    }
    fn options(&self) -> Options {
        Options { backface_culling: self.params.backface_culling, ..Options::default() }
    }
    /// Sends a message that is ready after so many ticks.
    fn send(&mut self, region: u32, message: Message, ready: u32) {
        self.messages.push(message);
        // The number is also the order of making, by which a renderer chooses between its regions.
        let number = self.messages.len() - 1;
        self.after(ready.saturating_add(self.machine.message), What::Arrives(region, number));
    }

    /// Queries structures that were invisible: one by its box, several first by the cube above them.
    fn ask(&mut self, p: u16, structures: Vec<usize>) {
        let first = self.processors[p as usize].structures[structures[0]].node;
        let is_group = structures.len() > 1;
        let node = if is_group { group_of(self.index, first) } else { first };
        let n = &self.index.nodes()[node.at()];
        let (bounds, whole) = if is_group { (n.bounds, n.whole) } else { (n.held, n.held_whole) };
        // "The triangles composing the bounding box are transformed and sent to the Renderers" (5.1).
        let cost = ticks(self.machine.transform, BOX_PRIMS);
        self.works(p, Job::Ask, cost, node, structures.len());
        let (image, crosses_near) = self.image(&bounds);
        // A shared primitive is drawn as a whole, and the part outside the cube may come nearer.
        let nearest = nearest_depth(&self.projection, &whole, self.view.eye.near);
        let answer = Answer { is_hidden: true, nearest, reads: 0, decisive: None };
        let regions = self.screen.regions(image.pixels);
        let open = regions.len() as u32;
        // A departure: with dynamic allocation a region that no renderer holds cannot be queried and counts
        // as seen. The paper concludes that the allocation has to be static (Section 5.1).
        let is_seen = crosses_near || regions.iter().any(|&r| !self.screen.is_held(r));
        let question = Question { processor: p, structures, node, bounds, image, open, is_seen, answer };
        self.questions.push(question);
        let number = self.questions.len() - 1;
        if crosses_near {
            self.watch.event(Event::Line(line::NEAR));
            self.decide(number, true);
        } else if regions.is_empty() {
            // It falls between the pixels' centers.
            self.decide(number, false);
        } else if let Some(closest) = self.behind_farthest(p, &regions, nearest) {
            self.watch.event(Event::Line(line::FARTHEST));
            let question = &mut self.questions[number];
            question.is_seen = false;
            question.answer = Answer { reads: open, decisive: Some(closest), ..answer };
            self.decide(number, false);
        } else if is_seen {
            // A region is not held.
            self.decide(number, false);
        } else {
            self.watch.event(Event::Line(line::SEND_BOX));
            self.processors[p as usize].waiting += 1;
            for region in regions {
                self.send(region, Message::Ask { question: number }, cost);
            }
        }
        self.after(cost, What::Free(p));
    }
    /// Where a box falls in the image, nowhere if it is out of view; and whether it crosses the near plane.
    fn image(&self, bounds: &Aabb<S::Vector>) -> (BoxImage, bool) {
        let nearest = 1.0 / self.view.eye.near;
        let nowhere = BoxImage { corners_px: [[0.0; 2]; 8], pixels: PixelRect::default(), nearest };
        match footprint(self.view, &self.projection, bounds) {
            Footprint::Seen(image) => (image, false),
            Footprint::Outside => (nowhere, false),
            Footprint::CrossesNear => (nowhere, true),
        }
    }
    /// The shortcut of Section 5.3: if a box lies behind the farthest depth of all its regions, that of the
    /// closest one. The processor reads these once, "after the visible list has been rendered, when the
    /// z-buffer should be almost-complete anyway".
    fn behind_farthest(&mut self, p: u16, regions: &[u32], nearest: f32) -> Option<(PyramidCell, f32)> {
        if !self.machine.farthest_first {
            return None;
        }
        if self.processors[p as usize].farthest.is_empty() {
            self.watch.note(|| Evidence::Depth(DepthNote::RefreshedAll));
            self.buffer.step(Step::RefreshAll);
            let windows = (0..self.screen.count() as u32).map(|r| self.screen.window(r));
            self.processors[p as usize].farthest = windows.map(|w| self.buffer.farthest_over(w)).collect();
        }
        // Depths only come nearer while a frame is drawn: what was read earlier is never too near.
        let farthest = &self.processors[p as usize].farthest;
        let closest =
            regions.iter().min_by(|a, b| farthest[**a as usize].total_cmp(&farthest[**b as usize]))?;
        let held = farthest[*closest as usize];
        (nearest < held).then(|| (self.screen.cell(*closest), held))
    }

    /// What a renderer that is free does next: the oldest message of the regions it holds.
    fn next_of_renderer(&mut self, r: u16) {
        let Some((message, region)) = self.screen.begin(r) else { return };
        let cost = self.cost_of(message);
        self.after(cost, What::Done(r, region, message));
    }
    fn cost_of(&self, message: usize) -> u32 {
        match &self.messages[message] {
            Message::Draw { prims, .. } => ticks(self.machine.rasterize, prims.len()),
            Message::Ask { .. } => self.machine.answer,
        }
    }
    /// A renderer has finished a message: now it takes effect.
    fn done(&mut self, r: u16, region: u32, message: usize) {
        let window = self.screen.window(region);
        let (unit, to) = (Unit::Renderer(r), self.now);
        let from = to.saturating_sub(self.cost_of(message));
        match self.messages[message].clone() {
            Message::Draw { node, prims } => {
                self.watch.event(Event::Line(line::RASTERIZE));
                let (job, count) = (Job::Rasterize, prims.len() as u32);
                self.watch
                    .note(move || Evidence::Worked(Worked { unit, job, from, to, node, region, count }));
                self.rasterize(&prims, window);
            }
            Message::Ask { question } => {
                let Question { image, bounds, node, answer: Answer { nearest, .. }, .. } =
                    self.questions[question];
                let lines = [line::COMPARE, line::COMPARE];
                let reporter = QueryReporter::new(node, lines, &mut *self.watch);
                // A departure: the paper's renderer compares all pixels at once and has no use for a pyramid
                // (Section 5). The answer is the same.
                let query = Query::new(&mut *self.buffer, nearest, reporter);
                let answer = query.faces_in(&bounds, &image, self.view, window);
                self.watch.event(Event::Line(line::ANSWER));
                let (job, count) = (Job::Answer, u32::from(!answer.is_hidden));
                self.watch
                    .note(move || Evidence::Worked(Worked { unit, job, from, to, node, region, count }));
                self.questions[question].answer.join(&answer);
                self.after(self.machine.message, What::Answered(question, !answer.is_hidden));
            }
        }
        self.screen.end(r);
        self.next_of_renderer(r);
    }
    /// Rasterizes primitives in a region, without a test of their own.
    fn rasterize(&mut self, prims: &[PrimId], window: PixelRect) {
        let options = Options { window: Some(window), ..self.options() };
        for &prim in prims {
            // Section 5: a renderer compares at every pixel at once, so nothing is tested before, and there
            // are no operands to record.
            let rasterized = Rasterized {
                prim,
                operands: None,
                is_hidden: false,
                is_sieved: false,
                backface_culling: options.backface_culling,
                window: options.window,
            };
            self.watch.note(move || Evidence::Depth(DepthNote::Rasterized(rasterized)));
        }
        self.buffer.step(Step::Draw { scene: self.scene, prims, options, is_sieved: false });
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
            self.decide(number, false);
            if self.processors[p as usize].idle.is_some() {
                self.next_of_processor(p);
            }
        }
    }
    /// All answers are there: structures that may be seen are let through, the others are hidden.
    fn decide(&mut self, number: usize, crosses_near: bool) {
        let q = &mut self.questions[number];
        q.answer.is_hidden = !q.is_seen;
        let (p, node, is_seen) = (q.processor, q.node, q.is_seen);
        let group = std::mem::take(&mut q.structures);
        let (bounds, pixels, answer) = (q.bounds, q.image.pixels, q.answer);
        // All that is decided until it is left rests on this answer.
        self.watch.event(Event::Entered(node));
        self.watch.event(Event::Line(line::DECIDE));
        self.watch.note(move || {
            Evidence::Depth(DepthNote::Answered(Answered { node, bounds, pixels, answer, crosses_near }))
        });
        if is_seen {
            self.processors[p as usize].let_through(group);
        } else {
            for s in group {
                let Structure { node, prims } = &self.processors[p as usize].structures[s];
                // A shared primitive may show in another structure.
                let shared = self.index.shared(*node);
                for &prim in prims.iter().filter(|prim| !shared.contains(prim)) {
                    self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
                }
            }
        }
        self.watch.event(Event::Left(node));
    }

    /// Reports the shared primitives that no structure drew.
    fn report_unseen(&mut self) {
        for at in 0..self.index.nodes().len() as u32 {
            for &prim in self.index.passed(NodeId(at)) {
                if !std::mem::replace(&mut self.drawn[prim.at()], true) {
                    self.watch.note(|| Evidence::Cube(CubeNote::SharedUnseen(prim, NodeId(at))));
                    self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
                }
            }
        }
    }
    /// Every n frames takes off all visible lists what the finished image does not show (Sections 4.2 and
    /// 5.1). No tick is charged for it: it follows the frame.
    fn check(&mut self) {
        self.lists.frames += 1;
        if self.lists.frames < self.params.check_interval {
            return;
        }
        self.lists.frames = 0;
        for at in 0..self.index.nodes().len() {
            if self.lists.visible.iter().all(|visible| !visible[at]) {
                continue;
            }
            let (node, n) = (NodeId(at as u32), &self.index.nodes()[at]);
            // What is out of view keeps its place.
            let Footprint::Seen(image) = footprint(self.view, &self.projection, &n.held) else { continue };
            let nearest = nearest_depth(&self.projection, &n.held_whole, self.view.eye.near);
            let reporter = QueryReporter::new(node, [line::CHECK, line::CHECK], &mut *self.watch);
            let query = Query::new(&mut *self.buffer, nearest, reporter);
            if query.faces(&n.held, &image, self.view).is_hidden {
                self.lists.visible.iter_mut().for_each(|v| v[at] = false);
                self.watch.note(|| Evidence::Cube(CubeNote::Unlisted(node)));
            }
        }
    }
}
