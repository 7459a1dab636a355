//! The parallel form on a simulated machine: processors that own structures, renderers that own regions of
//! the screen.
//!
//! Georges 1995, Sections 4 and 5: structures (a bounding volume and its geometry, here a cube of the octree
//! and what it alone holds) are distributed over graphics processors. Each draws its visible structures by
//! decreasing area on the screen, then asks for its invisible ones by increasing number of primitives; a
//! renderer holds regions of 128 × 128 pixels, rasterizes what it is sent in the order of arrival, and
//! answers for a box with whether any pixel of the region is left on (the all-enables-off bit). Every n
//! frames all visible structures are checked against the finished image.
//!
//! A discrete-event simulation in whole ticks: events are taken by time, then in the order in which they were
//! made, so a frame is the same on every machine. What is asked at a tick is answered from what was
//! rasterized before it, by the same queries as in the sequential form.
//!
//! Departures: the cost of an operation is a parameter, not that of a Pixel-Planes 5; a processor of the
//! hybrid distribution asks first for the cube above several of its invisible structures (the paper leaves
//! open how it recombines its allotment into a tree); with dynamic allocation a region that no renderer holds
//! counts as seen, since it cannot be asked. Cost: O(jobs · log jobs) beside what is drawn and asked.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use super::explain::{Answered, Asked, Evidence, Rasterized};
use super::{Params, line};
use crate::culling::depth::{Answer, Buffer, Faces, Query, footprint};
use crate::drawing::Subject;
use crate::geometry::{
    Aabb, BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, View,
    nearest_depth,
};
use crate::index::Octree;
use crate::method::evidence::{Facing, Tested, prim_faces_away};
use crate::method::{DrawList, Event, Observer, Verdict};
use crate::raster::Options;
use crate::scene::Scene;

/// Side of a region of the screen in pixels (Section 5).
pub const REGION_PX: u32 = 128;
/// Levels of cubes that the structures of the coarse distribution are: whole subtrees go to one processor.
const COARSE_LEVEL: u8 = 2;

/// How structures go to processors (Section 4.1).
pub const DISTRIBUTIONS: &[&str] = &["hybrid", "structure", "primitive"];
/// How regions go to renderers (Section 5.1).
pub const ALLOCATIONS: &[&str] = &["static", "dynamic"];

/// The machine and what its operations cost, in ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    pub processors: u32,
    pub renderers: u32,
    /// Index into [`DISTRIBUTIONS`].
    pub distribution: usize,
    /// Index into [`ALLOCATIONS`].
    pub allocation: usize,
    /// A processor goes on with other structures while it waits for answers (Section 5.3).
    pub overlap: bool,
    /// A processor asks once for the farthest depth of each region and rejects by it alone (Section 5.3).
    pub farthest_first: bool,
    /// Ticks to transform a primitive (a box counts as twelve), to rasterize one in a region, to answer for a
    /// box, and for a message.
    pub transform: u32,
    pub rasterize: u32,
    pub answer: u32,
    pub message: u32,
}

impl Default for Machine {
    fn default() -> Self {
        Self {
            processors: 1,
            renderers: 4,
            distribution: 0,
            allocation: 0,
            overlap: true,
            farthest_first: true,
            transform: 10,
            rasterize: 2,
            answer: 4,
            message: 20,
        }
    }
}

/// Who worked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unit {
    Processor(u16),
    Renderer(u16),
}

/// What a unit did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Job {
    /// A processor transformed a structure from its visible list.
    DrawVisible,
    /// A processor transformed a structure that an answer let through.
    DrawFound,
    /// A processor transformed a box and sent it out.
    Ask,
    /// A processor had nothing to do but wait for answers.
    Wait,
    /// A renderer rasterized a structure's part in a region.
    Rasterize,
    /// A renderer answered for a box.
    Answer,
}

/// A stretch of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worked {
    pub unit: Unit,
    pub job: Job,
    /// First tick and the one past the last.
    pub from: u32,
    pub to: u32,
    pub node: NodeId,
    /// The region, for renderers.
    pub region: u32,
    /// Primitives, or whether the renderer saw any pixel left on.
    pub count: u32,
}

/// What the machine keeps from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Lists {
    /// For each processor the structures that were visible.
    visible: Vec<Vec<bool>>,
    /// Primitives that each region received.
    load: Vec<u32>,
    /// Frames since the last check.
    frames: u32,
}

/// A structure as one processor holds it.
#[derive(Clone, Debug)]
struct Structure {
    node: NodeId,
    prims: Vec<PrimId>,
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

/// A box that was asked for.
struct Question<S: Faces> {
    processor: u16,
    /// The structures that it decides, as the processor numbers them.
    structures: Vec<usize>,
    node: NodeId,
    bounds: Aabb<S::Vector>,
    image: BoxImage,
    nearest: f32,
    /// Regions that have not answered yet, and whether any said that something is left on.
    open: u32,
    is_seen: bool,
    answer: Answer,
}

/// One processor.
#[derive(Default)]
struct Processor {
    structures: Vec<Structure>,
    /// Numbers of structures: the visible ones in their order, then groups of invisible ones.
    to_draw: VecDeque<usize>,
    to_ask: VecDeque<Vec<usize>>,
    /// Structures that answers let through.
    found: VecDeque<usize>,
    /// Questions on their way.
    waiting: u32,
    /// Since when it has been idle.
    idle: Option<u32>,
    /// The farthest depth of each region as it was asked for, empty before.
    farthest: Vec<f32>,
}

/// One frame of the machine.
pub struct Simulation<'a, S: Faces, O> {
    pub index: &'a Octree<S::Vector>,
    pub scene: &'a Scene<S>,
    pub view: &'a View<S>,
    pub params: &'a Params,
    pub machine: &'a Machine,
    pub options: Options,
    pub frustum: Frustum<S::Vector>,
    pub projection: Projection<S::Vector>,
    pub buffer: &'a mut Buffer<S>,
    pub drawn: &'a mut [bool],
    pub lists: &'a mut Lists,
    pub out: &'a mut DrawList<S>,
    pub watch: &'a mut O,
    state: State<S>,
}

struct State<S: Faces> {
    processors: Vec<Processor>,
    questions: Vec<Question<S>>,
    messages: Vec<Message>,
    /// Queue of each region, and which renderer holds it.
    queues: Vec<VecDeque<usize>>,
    holder: Vec<Option<u16>>,
    busy: Vec<bool>,
    events: BinaryHeap<Reverse<(u32, u64, What)>>,
    made: u64,
    now: u32,
    columns: u32,
}

impl<S: Faces> Default for State<S> {
    fn default() -> Self {
        Self {
            processors: vec![],
            questions: vec![],
            messages: vec![],
            queues: vec![],
            holder: vec![],
            busy: vec![],
            events: BinaryHeap::new(),
            made: 0,
            now: 0,
            columns: 0,
        }
    }
}

impl<'a, S: Faces, O: Observer<Evidence<S>>> Simulation<'a, S, O> {
    #[expect(clippy::too_many_arguments, reason = "the parts of a frame, each borrowed")]
    pub fn new(
        index: &'a Octree<S::Vector>,
        scene: &'a Scene<S>,
        view: &'a View<S>,
        params: &'a Params,
        buffer: &'a mut Buffer<S>,
        drawn: &'a mut [bool],
        lists: &'a mut Lists,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let options = Options { backface_culling: params.backface_culling, ..Options::default() };
        let (machine, frustum, projection) = (&params.machine, view.frustum(), view.projection());
        Self {
            index,
            scene,
            view,
            params,
            machine,
            options,
            frustum,
            projection,
            buffer,
            drawn,
            lists,
            out,
            watch,
            state: State::default(),
        }
    }

    /// Runs the frame; returns the tick at which the last unit is done.
    pub fn run(mut self) -> u32 {
        self.distribute();
        self.allocate();
        for p in 0..self.state.processors.len() {
            self.after(0, What::Free(p as u16));
        }
        while let Some(Reverse((now, _, what))) = self.state.events.pop() {
            self.state.now = now;
            match what {
                What::Free(p) => self.next_of_processor(p),
                What::Arrives(region, message) => {
                    self.state.queues[region as usize].push_back(message);
                    if let Some(r) = self.state.holder[region as usize] {
                        self.next_of_renderer(r);
                    }
                }
                What::Done(r, region, message) => self.done(r, region, message),
                What::Answered(question, is_seen) => self.answered(question, is_seen),
            }
            if self.state.events.is_empty() {
                self.release_regions();
            }
        }
        self.finish();
        self.state.now
    }
    fn after(&mut self, ticks: u32, what: What) {
        self.state.made += 1;
        self.state.events.push(Reverse((self.state.now.saturating_add(ticks), self.state.made, what)));
    }
    fn note_work(&mut self, work: Worked) {
        self.watch.note(move || Evidence::Worked(work));
    }

    /// Deals the structures out and sorts each processor's lists.
    fn distribute(&mut self) {
        let count = self.machine.processors as usize;
        let nodes = self.index.nodes().len();
        self.lists.visible.resize(count, vec![]);
        self.lists.visible.iter_mut().for_each(|v| v.resize(nodes, false));
        if !self.params.coherence {
            self.lists.visible.iter_mut().for_each(|v| v.fill(false));
        }
        self.state.processors.resize_with(count, Processor::default);
        let (mut dealt, mut coarse) = (0, 0);
        for at in 0..nodes {
            let node = NodeId(at as u32);
            if self.index.nodes()[at].level <= COARSE_LEVEL {
                coarse += 1;
            }
            let prims: Vec<PrimId> =
                self.index.own(node).iter().chain(self.index.shared(node)).copied().collect();
            if prims.is_empty() || self.drop_outside(node) {
                continue;
            }
            match DISTRIBUTIONS[self.machine.distribution] {
                "primitive" => {
                    for (p, processor) in self.state.processors.iter_mut().enumerate() {
                        let part: Vec<_> = prims.iter().skip(p).step_by(count).copied().collect();
                        if !part.is_empty() {
                            processor.structures.push(Structure { node, prims: part });
                        }
                    }
                }
                "structure" => {
                    self.state.processors[coarse % count].structures.push(Structure { node, prims })
                }
                _ => self.state.processors[dealt % count].structures.push(Structure { node, prims }),
            }
            dealt += 1;
        }
        (0..count).for_each(|p| self.sort_lists(p));
    }

    /// Drops a structure out of view; it keeps its place on the lists (Section 5.1).
    fn drop_outside(&mut self, node: NodeId) -> bool {
        let (all, frustum, held) =
            (Frustum::<S::Vector>::ALL, &self.frustum, &self.index.nodes()[node.at()].held);
        let test = frustum.test(held, all);
        let is_outside = matches!(test, FrustumTest::Outside(_));
        if is_outside {
            for &prim in self.index.own(node) {
                self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(node), held, all, test)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            }
        }
        is_outside
    }

    /// Visible structures by decreasing area on the screen, invisible ones by increasing number of primitives
    /// (Section 4.2).
    fn sort_lists(&mut self, p: usize) {
        let processor = &self.state.processors[p];
        let (mut visible, mut hidden): (Vec<usize>, Vec<usize>) = (0..processor.structures.len())
            .partition(|&s| self.lists.visible[p][processor.structures[s].node.at()]);
        let area = |s: &usize| match footprint(
            self.view,
            &self.projection,
            &self.index.nodes()[processor.structures[*s].node.at()].held,
        ) {
            Footprint::Seen(image) => image.pixels.area(),
            Footprint::Outside => 0,
            Footprint::CrossesNear => u64::MAX,
        };
        visible.sort_by_key(|s| (Reverse(area(s)), *s));
        hidden.sort_by_key(|&s| (processor.structures[s].prims.len(), s));
        let groups = if DISTRIBUTIONS[self.machine.distribution] == "hybrid" {
            self.grouped(p, &hidden)
        } else {
            vec![]
        };
        let mut in_group = vec![false; processor.structures.len()];
        groups.iter().flatten().for_each(|&s| in_group[s] = true);
        let single = hidden.into_iter().filter(|&s| !in_group[s]).map(|s| vec![s]);
        let mut to_ask: Vec<Vec<usize>> = groups.into_iter().chain(single).collect();
        let work =
            |group: &Vec<usize>| group.iter().map(|&s| processor.structures[s].prims.len()).sum::<usize>();
        to_ask.sort_by_key(|g| (work(g), g[0]));
        (self.state.processors[p].to_draw, self.state.processors[p].to_ask) = (visible.into(), to_ask.into());
    }
    /// Invisible structures of one processor below the same cube of a coarse level, two or more.
    fn grouped(&self, p: usize, hidden: &[usize]) -> Vec<Vec<usize>> {
        let mut groups: std::collections::BTreeMap<NodeId, Vec<usize>> = Default::default();
        for &s in hidden {
            groups.entry(self.group_of(self.state.processors[p].structures[s].node)).or_default().push(s);
        }
        groups.into_values().filter(|g| g.len() > 1).collect()
    }
    fn group_of(&self, node: NodeId) -> NodeId {
        let above = |n: &NodeId| self.index.parent_of(*n);
        std::iter::successors(Some(node), above)
            .find(|n| self.index.nodes()[n.at()].level <= COARSE_LEVEL + 1)
            .unwrap_or(node)
    }

    /// Gives regions to renderers: all of them at once, or the busiest of the last frame.
    fn allocate(&mut self) {
        let (width, height) = (self.view.width, self.view.height);
        self.state.columns = width.div_ceil(REGION_PX);
        let regions = (self.state.columns * height.div_ceil(REGION_PX)) as usize;
        let renderers = self.machine.renderers as usize;
        self.state.queues = vec![VecDeque::new(); regions];
        self.state.busy = vec![false; renderers];
        self.state.holder = (0..regions).map(|r| Some((r % renderers) as u16)).collect();
        self.lists.load.resize(regions, 0);
        if ALLOCATIONS[self.machine.allocation] == "dynamic" {
            self.state.holder.fill(None);
            for (renderer, region) in self.busiest().into_iter().take(renderers).enumerate() {
                self.state.holder[region] = Some(renderer as u16);
            }
        }
        self.lists.load.fill(0);
    }
    fn busiest(&self) -> Vec<usize> {
        let mut regions: Vec<usize> = (0..self.lists.load.len()).collect();
        regions.sort_by_key(|&r| (Reverse(self.lists.load[r]), r));
        regions
    }
    /// Dynamic allocation: whoever is idle takes regions that nobody held, when all else is done.
    fn release_regions(&mut self) {
        let renderers = self.machine.renderers as usize;
        let free: Vec<usize> = (0..self.state.queues.len())
            .filter(|&r| self.state.holder[r].is_none() && !self.state.queues[r].is_empty())
            .collect();
        for (k, region) in free.into_iter().enumerate() {
            self.state.holder[region] = Some((k % renderers) as u16);
            self.next_of_renderer((k % renderers) as u16);
        }
    }
    fn window(&self, region: u32) -> PixelRect {
        let (x, y) = (region % self.state.columns * REGION_PX, region / self.state.columns * REGION_PX);
        PixelRect {
            x0: x,
            x1: (x + REGION_PX).min(self.view.width),
            y0: y,
            y1: (y + REGION_PX).min(self.view.height),
        }
    }
    fn regions(&self, pixels: PixelRect) -> Vec<u32> {
        if pixels.is_empty() {
            return vec![];
        }
        let rows = pixels.y0 / REGION_PX..=(pixels.y1 - 1) / REGION_PX;
        rows.flat_map(|row| {
            (pixels.x0 / REGION_PX..=(pixels.x1 - 1) / REGION_PX).map(move |c| row * self.state.columns + c)
        })
        .collect()
    }

    /// What a processor that is free does next.
    fn next_of_processor(&mut self, p: u16) {
        let now = self.state.now;
        let processor = &mut self.state.processors[p as usize];
        if let Some(since) = processor.idle.take()
            && since < now
        {
            self.note_work(Worked {
                unit: Unit::Processor(p),
                job: Job::Wait,
                from: since,
                to: now,
                node: NodeId(0),
                region: 0,
                count: 0,
            });
        }
        let processor = &mut self.state.processors[p as usize];
        if let Some(s) = processor.found.pop_front() {
            self.transform(p, s, Job::DrawFound);
        } else if let Some(s) = processor.to_draw.pop_front() {
            self.transform(p, s, Job::DrawVisible);
        } else if processor.waiting > 0 && !self.machine.overlap {
            processor.idle = Some(now);
        } else if let Some(group) = processor.to_ask.pop_front() {
            self.ask(p, group);
        } else if processor.waiting > 0 {
            processor.idle = Some(now);
        }
    }

    /// Transforms a structure and sends it to the renderers of its regions.
    fn transform(&mut self, p: u16, s: usize, job: Job) {
        let Structure { node, prims } = self.state.processors[p as usize].structures[s].clone();
        self.lists.visible[p as usize][node.at()] = true;
        let cost = self.machine.transform * prims.len() as u32;
        let (from, to) = (self.state.now, self.state.now + cost);
        self.note_work(Worked {
            unit: Unit::Processor(p),
            job,
            from,
            to,
            node,
            region: 0,
            count: prims.len() as u32,
        });
        self.watch.event(Event::DecidedNode(node, Verdict::Partial));
        let mut bins: std::collections::BTreeMap<u32, Vec<PrimId>> = Default::default();
        for prim in prims {
            // A shared primitive that another structure has drawn.
            let is_shared = self.index.shared(node).contains(&prim);
            if is_shared && std::mem::replace(&mut self.drawn[prim.at()], true) {
                continue;
            }
            let (scene, view) = (self.scene, self.view);
            if self.options.backface_culling && prim_faces_away(scene, view.eye.position, prim) {
                self.watch.note(move || Evidence::Facing(Facing::of(prim)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
                continue;
            }
            self.out.prims.push(prim);
            self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            let all = PixelRect { x0: 0, x1: view.width, y0: 0, y1: view.height };
            let pixels = S::extent(scene, view, prim, &self.options).map_or(all, |e| e.pixels);
            self.regions(pixels).into_iter().for_each(|r| bins.entry(r).or_default().push(prim));
        }
        for (region, prims) in bins {
            self.lists.load[region as usize] += prims.len() as u32;
            self.state.messages.push(Message::Draw { node, prims });
            let message = self.state.messages.len() - 1;
            self.after(cost + self.machine.message, What::Arrives(region, message));
        }
        self.after(cost, What::Free(p));
    }

    /// Asks for structures that were invisible: for one by its box, for several first by the cube above them.
    fn ask(&mut self, p: u16, group: Vec<usize>) {
        let processor = &self.state.processors[p as usize];
        let first = processor.structures[group[0]].node;
        let node = if group.len() == 1 { first } else { self.group_of(first) };
        let n = &self.index.nodes()[node.at()];
        let (bounds, whole) = if group.len() == 1 { (n.held, n.held_whole) } else { (n.bounds, n.whole) };
        let cost = self.machine.transform * 12;
        let (from, to) = (self.state.now, self.state.now + cost);
        self.watch.event(Event::Line(line::OBSCURED));
        self.note_work(Worked {
            unit: Unit::Processor(p),
            job: Job::Ask,
            from,
            to,
            node,
            region: 0,
            count: group.len() as u32,
        });
        let image = match footprint(self.view, &self.projection, &bounds) {
            Footprint::Seen(image) => image,
            Footprint::Outside => {
                BoxImage { corners_px: [[0.0; 2]; 8], pixels: PixelRect::default(), nearest: 0.0 }
            }
            Footprint::CrossesNear => {
                self.let_through(p, group);
                return self.after(cost, What::Free(p));
            }
        };
        let nearest = nearest_depth(&self.projection, &whole, self.view.eye.near);
        let regions = self.regions(image.pixels);
        let answer = Answer { is_hidden: true, nearest, reads: 0, decisive: None };
        let question = Question {
            processor: p,
            structures: group,
            node,
            bounds,
            image,
            nearest,
            open: regions.len() as u32,
            is_seen: false,
            answer,
        };
        self.state.questions.push(question);
        let number = self.state.questions.len() - 1;
        let unheld = regions.iter().any(|&r| self.state.holder[r as usize].is_none());
        if regions.is_empty() || self.behind_farthest(p, &regions, nearest) {
            self.decide(number);
        } else if unheld {
            self.state.questions[number].is_seen = true;
            self.decide(number);
        } else {
            self.state.processors[p as usize].waiting += 1;
            for region in regions {
                self.state.messages.push(Message::Ask { question: number });
                let message = self.state.messages.len() - 1;
                self.after(cost + self.machine.message, What::Arrives(region, message));
            }
        }
        self.after(cost, What::Free(p));
    }
    /// The maximum-depth shortcut: whether a box lies behind the farthest depth of all its regions, as this
    /// processor asked for it once, after its visible list (Section 5.3).
    fn behind_farthest(&mut self, p: u16, regions: &[u32], nearest: f32) -> bool {
        if !self.machine.farthest_first {
            return false;
        }
        if self.state.processors[p as usize].farthest.is_empty() {
            self.watch.note(|| Evidence::RefreshedAll);
            self.buffer.refresh_all();
            let all = (0..self.state.queues.len() as u32)
                .map(|r| self.buffer.farthest_over(self.window(r)))
                .collect();
            self.state.processors[p as usize].farthest = all;
        }
        regions.iter().all(|&r| nearest < self.state.processors[p as usize].farthest[r as usize])
    }

    /// What a renderer that is free does next: the oldest message of the regions it holds.
    fn next_of_renderer(&mut self, r: u16) {
        if self.state.busy[r as usize] {
            return;
        }
        let regions = (0..self.state.queues.len()).filter(|&k| self.state.holder[k] == Some(r));
        let oldest = regions.filter_map(|k| Some((*self.state.queues[k].front()?, k))).min();
        let Some((message, region)) = oldest else { return };
        self.state.queues[region].pop_front();
        self.state.busy[r as usize] = true;
        let cost = match &self.state.messages[message] {
            Message::Draw { prims, .. } => self.machine.rasterize * prims.len() as u32,
            Message::Ask { .. } => self.machine.answer,
        };
        self.after(cost, What::Done(r, region as u32, message));
    }
    /// A renderer has finished a message: now it takes effect.
    fn done(&mut self, r: u16, region: u32, message: usize) {
        let window = self.window(region);
        let to = self.state.now;
        let unit = Unit::Renderer(r);
        match self.state.messages[message].clone() {
            Message::Draw { node, prims } => {
                let from = to - self.machine.rasterize * prims.len() as u32;
                self.note_work(Worked {
                    unit,
                    job: Job::Rasterize,
                    from,
                    to,
                    node,
                    region,
                    count: prims.len() as u32,
                });
                let options = Options { window: Some(window), ..self.options };
                for &prim in &prims {
                    let rasterized = Rasterized {
                        prim,
                        operands: None,
                        is_hidden: false,
                        is_sieved: false,
                        backface_culling: options.backface_culling,
                        window: Some(window),
                    };
                    self.watch.note(move || Evidence::Rasterized(rasterized));
                }
                self.buffer.draw_all(self.scene, &prims, &options);
            }
            Message::Ask { question } => {
                let (image, bounds, node, nearest) = {
                    let q = &self.state.questions[question];
                    (q.image, q.bounds, q.node, q.nearest)
                };
                let query =
                    Query::new(&mut *self.buffer, nearest, Asked::new(node, line::BEHIND, &mut *self.watch));
                let answer = query.faces_in(&bounds, &image, self.view, window);
                self.note_work(Worked {
                    unit,
                    job: Job::Answer,
                    from: to - self.machine.answer,
                    to,
                    node,
                    region,
                    count: (!answer.is_hidden).into(),
                });
                self.state.questions[question].answer.join(&answer);
                self.after(self.machine.message, What::Answered(question, !answer.is_hidden));
            }
        }
        self.state.busy[r as usize] = false;
        self.next_of_renderer(r);
    }

    /// An answer has come back.
    fn answered(&mut self, number: usize, is_seen: bool) {
        let question = &mut self.state.questions[number];
        question.open -= 1;
        question.is_seen |= is_seen;
        if question.open == 0 {
            let p = question.processor;
            self.state.processors[p as usize].waiting -= 1;
            self.decide(number);
            if self.state.processors[p as usize].idle.is_some() {
                self.next_of_processor(p);
            }
        }
    }
    /// All answers are there.
    fn decide(&mut self, number: usize) {
        let q = &mut self.state.questions[number];
        q.answer.is_hidden = !q.is_seen;
        let (p, node, group) = (q.processor, q.node, std::mem::take(&mut q.structures));
        let answered = Answered {
            node,
            bounds: q.bounds,
            pixels: q.image.pixels,
            answer: q.answer,
            crosses_near: false,
        };
        if q.is_seen {
            self.watch.note(move || Evidence::Answered(answered));
            return self.let_through(p, group);
        }
        for s in group {
            let structure = &self.state.processors[p as usize].structures[s];
            let own =
                structure.prims.iter().filter(|&prim| !self.index.shared(structure.node).contains(prim));
            for &prim in own {
                self.watch.note(move || Evidence::Answered(answered));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
            }
        }
    }
    /// Structures that may be seen: one is drawn, of several each is asked for.
    fn let_through(&mut self, p: u16, group: Vec<usize>) {
        let processor = &mut self.state.processors[p as usize];
        match group[..] {
            [s] => processor.found.push_back(s),
            _ => group.into_iter().rev().for_each(|s| processor.to_ask.push_front(vec![s])),
        }
    }

    /// The end of the frame: the check of the lists, and what was said of nobody.
    fn finish(&mut self) {
        for at in 0..self.index.nodes().len() as u32 {
            for &prim in self.index.passed(NodeId(at)) {
                if !std::mem::replace(&mut self.drawn[prim.at()], true) {
                    self.watch.note(|| Evidence::SharedUnseen(prim, NodeId(at)));
                    self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
                }
            }
        }
        self.lists.frames += 1;
        let interval =
            if self.params.check_interval == 0 { CHECK_FRAMES } else { self.params.check_interval };
        if self.lists.frames < interval {
            return;
        }
        self.lists.frames = 0;
        for at in 0..self.index.nodes().len() {
            if (0..self.lists.visible.len()).all(|p| !self.lists.visible[p][at]) {
                continue;
            }
            let n = &self.index.nodes()[at];
            let Footprint::Seen(image) = footprint(self.view, &self.projection, &n.held) else { continue };
            let nearest = nearest_depth(&self.projection, &n.held_whole, self.view.eye.near);
            let query = Query::new(
                &mut *self.buffer,
                nearest,
                Asked::new(NodeId(at as u32), line::UNLIST, &mut *self.watch),
            );
            if query.faces(&n.held, &image, self.view).is_hidden {
                self.lists.visible.iter_mut().for_each(|v| v[at] = false);
                self.watch.note(|| Evidence::Unlisted(NodeId(at as u32)));
            }
        }
    }
}

/// Frames between checks of the visible lists, if not set (Section 5.1).
const CHECK_FRAMES: u32 = 30;
