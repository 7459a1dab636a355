//! One frame: occluders are chosen and drawn into the maps, then the model is culled by them.

use super::budget::{Budget, Work};
use super::code::line;
use super::depth::DepthTest;
use super::evidence::{Answered, Built, Choice, Cover, DepthCompared, Evidence, Ground};
use super::index::Databases;
use super::maps::{MapStep, Maps};
use super::overlap::{self, MapRead, Overlap, overlap_test};
use super::selection::{Candidate, Choosing, Known, Order};
use super::stand_ins::Kind;
use super::{DepthKind, Memory, Params, Samples};
use crate::culling::depth::{Asking, DepthNote, Faces, Rasterized, Stage, deciding, footprint};
use crate::drawing::Subject;
use crate::geometry::{
    Aabb, BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, View,
    farthest_depth, nearest_depth,
};
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Frame, Method, Observer, Verdict};
use crate::scene::Scene;

/// What a frame reuses. A copy of the memory does not hold it.
#[derive(Default)]
pub(super) struct Scratch {
    /// Nodes that hold an occluder of this frame.
    holds: Vec<bool>,
    occluders: Vec<NodeId>,
    /// Of each node the angle under which the grid points about the eye see it.
    angles: Vec<f32>,
    /// The key of the last candidate of the frame before.
    last: Option<f32>,
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// One frame.
pub(super) struct Walk<'a, S: Faces, O> {
    index: &'a Databases<S>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    params: &'a Params,
    frustum: Frustum<S::Vector>,
    projection: Projection<S::Vector>,
    maps: &'a mut Maps<S>,
    memory: &'a mut Memory,
    /// View depth of the Z plane as `1/w`, if there is one.
    plane: f32,
    work: Work,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
}

impl<'a, S: Faces, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    /// A frame that is yet to be walked.
    pub(super) fn new<M: Method<S, Params = Params, Index = Databases<S>>>(
        frame: &Frame<'a, S, M>,
        memory: &'a mut Memory,
        maps: &'a mut Maps<S>,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let Frame { index, scene, view, params, .. } = *frame;
        let (frustum, projection) = (view.frustum(), view.projection());
        let (plane, work) = (f32::INFINITY, Work::default());
        Self { index, scene, view, params, frustum, projection, maps, memory, plane, work, out, watch }
    }
    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }

    /// Section 3: phase 1 makes the maps, phase 2 culls by them.
    pub(super) fn run(&mut self) {
        let is_on = self.make_maps();
        // Not node by node: of what is culled as a whole no leaf is entered.
        self.memory.drawn.fill(false);
        self.watch.stage("cull");
        self.line(line::ROOT);
        let prims = self.scene.live().len();
        self.work.in_view = prims as u32;
        self.cull(NodeId(0), Frustum::<S::Vector>::ALL, false);
        if self.params.adapts {
            self.line(line::ADAPT);
            let budget = &mut self.memory.budget;
            let adapted = if is_on { budget.adapt::<S>(self.work, prims) } else { budget.pause(self.work) };
            self.watch.note(move || Evidence::Adapted(adapted));
        }
    }
    /// Phase 1; whether occlusion culling is on.
    pub(super) fn make_maps(&mut self) -> bool {
        self.line(line::FRAME);
        let (nodes, prims) = (self.index.tree().nodes().len(), self.scene.live().len());
        self.memory.occluders.resize(nodes, false);
        self.memory.drawn.resize(nodes, false);
        if self.memory.budget.limit == 0 || !self.params.adapts {
            self.memory.budget = Budget::first::<S>(self.params.occluder_budget, prims);
        }
        self.memory.scratch.holds.clear();
        self.memory.scratch.holds.resize(nodes, false);
        if self.params.adapts {
            self.line(line::OFF);
        }
        let is_on = self.memory.budget.is_on();
        if is_on {
            self.watch.stage("select");
            self.choose();
            self.watch.stage("occluders");
            self.cover();
            self.watch.stage("maps");
            self.build();
        } else {
            let left = self.memory.budget.off;
            self.watch.note(move || Evidence::Paused(left));
        }
        is_on
    }

    /// Occluder selection (Section 5.3.2).
    fn choose(&mut self) {
        self.line(line::CANDIDATES);
        let limit = self.memory.budget.limit;
        let order = match self.params.depth {
            DepthKind::Plane => Order::Nearest,
            _ => Order::By(self.params.selection),
        };
        self.look_up();
        let Memory { occluders, drawn, scratch, .. } = &*self.memory;
        let known = Known { occluders, drawn, angles: &scratch.angles };
        let (index, view, frustum, projection) = (self.index, self.view, &self.frustum, &self.projection);
        let choosing = Choosing { index, view, frustum, projection, order, known };
        let mut last = scratch.last;
        let all = choosing.candidates(limit, &mut last);
        self.watch.event(Event::Line(line::SORT));
        self.watch.note(|| Evidence::Gathered(choosing.count(), index.counts()));
        self.memory.scratch.last = last;
        self.memory.occluders.fill(false);
        self.memory.scratch.occluders.clear();
        let reach = self.memory.budget.reach * self.scene.bounds().diagonal();
        let mut sum = 0;
        // Without a leaf that ends it, everything before the far plane may be an occluder.
        let mut plane = 1.0 / self.view.eye.far;
        for candidate in all {
            self.line(line::EACH);
            if self.params.adapts {
                self.line(line::BEYOND);
                if order != Order::Nearest && candidate.distance > reach {
                    self.refuse(candidate, sum, reach);
                    continue;
                }
            }
            self.line(line::EXCEEDS);
            if sum + candidate.polygons > limit {
                self.refuse(candidate, sum + candidate.polygons, reach);
                let bounds = self.index.occluder_bounds(candidate.node);
                plane = nearest_depth(&self.projection, bounds, self.view.eye.near);
                break;
            }
            sum += candidate.polygons;
            self.line(line::CHOOSE);
            let choice = Choice { candidate, sum, limit, reach, is_taken: true };
            self.watch.note(move || Evidence::Chosen(choice));
            self.take(candidate.node);
        }
        self.work.occluders = sum;
        if self.params.depth == DepthKind::Plane {
            // Section 5.2.1: everything beyond it is farther than any occluder, as far as that is drawn.
            self.line(line::PLANE);
            let z = 1.0 / plane;
            self.plane = 1.0 / z;
            self.watch.note(move || Evidence::Plane(z));
            self.maps.step(MapStep::Plane(z));
        }
    }
    /// What the grid points about the eye see (Section 5.3.2).
    fn look_up(&mut self) {
        let angles = &mut self.memory.scratch.angles;
        angles.clear();
        if let Some(grid) = self.index.grid() {
            let nodes = self.index.tree().nodes().len();
            let points = grid.angles_about(self.view.eye.position, nodes, angles);
            let leaves = angles.iter().filter(|a| **a > 0.0).count() as u32;
            self.line(line::LOOK_UP);
            self.watch.note(move || Evidence::LookedUp(points, leaves));
        }
    }
    fn refuse(&mut self, candidate: Candidate, sum: u32, reach: f32) {
        let limit = self.memory.budget.limit;
        let choice = Choice { candidate, sum, limit, reach, is_taken: false };
        self.watch.note(move || Evidence::Chosen(choice));
    }
    fn take(&mut self, leaf: NodeId) {
        self.memory.occluders[leaf.at()] = true;
        self.memory.scratch.occluders.push(leaf);
        // Up to the first that is known to hold one already.
        let mut at = leaf;
        while !self.memory.scratch.holds[at.at()] {
            self.memory.scratch.holds[at.at()] = true;
            match crate::index::Hierarchy::<S>::parent(self.index, at) {
                Some(parent) => at = parent,
                None => break,
            }
        }
    }

    /// Occluders are drawn, and their depths estimated (Sections 4.1 and 5.2.2).
    fn cover(&mut self) {
        let one_sided = self.params.surfaces.one_sided;
        let occluders = std::mem::take(&mut self.memory.scratch.occluders);
        for &node in &occluders {
            self.line(line::EACH_OCCLUDER);
            self.line(if self.params.occluders == Kind::Original { line::COVER } else { line::STAND_IN });
            let drawn = self.index.drawn_for(node, self.view, &self.projection);
            self.watch.note(move || Evidence::Covered(Cover { node, drawn, one_sided }));
            self.maps.step(MapStep::Cover(drawn, one_sided));
            if self.params.depth != DepthKind::Estimation {
                continue;
            }
            self.line(line::WRITE);
            let bounds = self.index.occluder_bounds(node);
            let pixels = match footprint(self.view, &self.projection, bounds) {
                Footprint::Seen(image) => image.pixels,
                // No rectangle bounds it.
                Footprint::CrossesNear => whole(self.view),
                Footprint::Outside => PixelRect::default(),
            };
            if !pixels.is_empty() {
                let touched = self.maps.buffer().touched(pixels);
                let farthest = farthest_depth(&self.projection, bounds, self.view.eye.near);
                self.watch.note(move || Evidence::Written(node, touched, farthest));
                self.maps.step(MapStep::Write(touched, farthest));
            }
        }
        self.memory.scratch.occluders = occluders;
    }
    /// The hierarchy of maps (Section 4.1).
    fn build(&mut self) {
        let closing = self.params.closing;
        if closing > 0 {
            self.line(line::FILL);
        }
        self.line(line::AVERAGE);
        self.maps.step(MapStep::Build);
        let maps = &self.maps;
        let ignored = self.params.ignored(maps.opacity());
        self.watch.note(move || {
            let opacity = maps.opacity();
            let top = opacity.levels() - 1;
            let [width, height] = opacity.samples();
            Evidence::Built(Built {
                levels: opacity.levels().into(),
                size: opacity.size(0),
                side: 1 << opacity.shift(0),
                ignored,
                closing,
                filled: opacity.cells(top).map(|c| opacity.filled(c)).sum(),
                black: opacity.cells(top).map(|c| opacity.black(c)).sum(),
                samples: width * height,
            })
        });
    }

    /// Whether boxes of any kind are culled by the maps of the frame, in order; `None` if one is out of view.
    pub(super) fn hides_all(&mut self, boxes: &[Aabb<S::Vector>]) -> Vec<Option<bool>> {
        let hides = |bounds: &Aabb<S::Vector>| match self.frustum.test(bounds, Frustum::<S::Vector>::ALL) {
            FrustumTest::Outside(_) => None,
            _ => Some(matches!(self.test(NodeId(0), bounds, false), Found::Culled { .. })),
        };
        boxes.iter().map(hides).collect()
    }

    /// Culls a node and all below it. `is_known`: whether a node above passed the first of both tests, and so
    /// this one does: it is behind the occluders, or, where depths of samples are compared, covered.
    fn cull(&mut self, id: NodeId, planes: u8, is_known: bool) {
        let node = &self.index.tree().nodes()[id.at()];
        let bounds = &node.bounds;
        self.watch.event(Event::Entered(id));
        self.line(line::CULL);
        self.line(line::OUTSIDE);
        let test = self.frustum.test(bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(id), bounds, planes, test)));
        let cutting = match test {
            FrustumTest::Outside(_) => {
                self.work.in_view -= self.index.tree().prims_below(id).len() as u32;
                return self.leave(id, Verdict::Outside);
            }
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        let found =
            if self.memory.budget.is_on() { self.test(id, bounds, is_known) } else { Found::Open(false) };
        let is_known = match found {
            Found::Culled { is_proven } => {
                self.work.culled += self.index.tree().prims_below(id).len() as u32;
                return self.leave(id, if is_proven { Verdict::Hidden } else { Verdict::Presumed });
            }
            Found::Open(is_known) => is_known,
        };
        self.line(line::LEAF);
        match node.children() {
            None => {
                self.draw(id);
                self.line(line::LEAF);
                self.leave(id, Verdict::Visible);
            }
            Some(children) => {
                self.line(line::CHILDREN);
                self.watch.event(Event::DecidedNode(id, Verdict::Partial));
                for child in children {
                    self.line(line::CHILDREN);
                    self.cull(child, cutting, is_known);
                }
                self.watch.event(Event::Left(id));
            }
        }
    }
    fn leave(&mut self, id: NodeId, verdict: Verdict) {
        self.watch.event(Event::DecidedNode(id, verdict));
        self.watch.event(Event::Left(id));
    }
    /// Section 3, phase 2: "only objects that fail one of the latter two tests (depth or overlap) are
    /// rendered".
    fn test(&mut self, id: NodeId, bounds: &Aabb<S::Vector>, is_known: bool) -> Found {
        if self.params.depth != DepthKind::Samples {
            self.line(line::HOLDS);
            // Neither in the buffer nor before the plane could it be behind itself.
            if self.memory.scratch.holds[id.at()] {
                self.watch.note(move || Evidence::Holds(id));
                return Found::Open(false);
            }
        }
        self.work.tests += 1;
        self.line(line::RECTANGLE);
        let image = footprint(self.view, &self.projection, bounds);
        self.line(line::NEAR);
        let image = match image {
            Footprint::CrossesNear => return self.answer(id, PixelRect::default(), Ground::CrossesNear),
            Footprint::Outside => {
                self.line(line::NO_PIXEL);
                return self.answer(id, PixelRect::default(), Ground::BesideImage);
            }
            Footprint::Seen(image) => image,
        };
        self.line(line::NO_PIXEL);
        if image.pixels.is_empty() {
            return self.answer(id, image.pixels, Ground::NoPixel);
        }
        if self.params.depth == DepthKind::Samples {
            return self.test_samples(id, image, is_known);
        }
        if !is_known && !self.is_behind(id, image) {
            return self.answer(id, image.pixels, Ground::NotBehind);
        }
        self.line(line::OVERLAP);
        let found = self.overlaps(id, image.pixels);
        self.line(line::OVERLAP);
        self.answer(id, image.pixels, Ground::Overlap(found))
    }
    /// The same where depths of samples are compared, which takes longer than to test overlap.
    fn test_samples(&mut self, id: NodeId, image: BoxImage, is_covered: bool) -> Found {
        let mut found = Overlap { is_covered, ..Overlap::default() };
        if !is_covered {
            self.line(line::NOT_COVERED);
            found = self.overlaps(id, image.pixels);
            self.line(line::NOT_COVERED);
        }
        let is_behind = found.is_covered && self.is_behind(id, image);
        let ground = if found.is_covered && !is_behind { Ground::NotBehind } else { Ground::Overlap(found) };
        match self.answer(id, image.pixels, ground) {
            // What was ignored for it is asked for anew below.
            Found::Open(_) => Found::Open(found.is_covered && found.ignored == 0),
            culled => culled,
        }
    }
    fn answer(&mut self, node: NodeId, pixels: PixelRect, ground: Ground) -> Found {
        let is_culled = match ground {
            Ground::CrossesNear | Ground::NotBehind => false,
            Ground::BesideImage | Ground::NoPixel => true,
            Ground::Overlap(found) => found.is_covered,
        };
        // Samples of the maps' own say nothing about those of the image, a hole that is ignored may show
        // something, and what is clustered may cover what no occluder does.
        let exact = self.params.samples == Samples::Image && self.params.occluders != Kind::Clustered;
        let is_sure = match ground {
            Ground::Overlap(found) => exact && found.ignored == 0,
            _ => true,
        };
        let is_proven = is_culled && is_sure;
        let bounds = self.index.tree().nodes()[node.at()].bounds;
        self.watch.note(move || {
            Evidence::Answered(Answered { node, bounds, pixels, ground, is_culled, is_proven })
        });
        if is_culled {
            Found::Culled { is_proven }
        } else {
            let is_behind = matches!(ground, Ground::Overlap(_));
            Found::Open(is_behind)
        }
    }

    /// The depth test (Section 5.2): whether a node is behind all occluders that it could overlap.
    fn is_behind(&mut self, node: NodeId, BoxImage { pixels, nearest }: BoxImage) -> bool {
        // Corners of boxes bound what is drawn and what it stands for. Depths of what is drawn do not.
        let exact = self.params.depth == DepthKind::Estimation;
        let nearer = self.index.stand_ins().filter(|_| !exact).map_or(0.0, |made| made.nearer());
        let nearest = nearest * (1.0 + nearer);
        let (test, place) = match self.params.depth {
            DepthKind::Plane => {
                self.line(line::BEHIND_PLANE);
                let (held, is_behind) = (self.plane, nearest < self.plane);
                (DepthTest { is_behind, entry: [0, 0], held, reads: 1 }, pixels)
            }
            DepthKind::Estimation => {
                self.line(line::BEHIND_ENTRIES);
                let buffer = self.maps.buffer();
                let test = buffer.test(buffer.touched(pixels), nearest);
                (test, buffer.pixels(test.entry, [self.view.width, self.view.height]))
            }
            DepthKind::Samples => {
                let samples = self.maps.samples_of(pixels, self.params.samples);
                let lines = |stage| (stage == Stage::Plane).then_some(line::BEHIND_SAMPLES);
                self.line(line::BEHIND_SAMPLES);
                let mut asking = Asking::new(&mut *self.watch, lines, Some(node));
                let is_behind = self.maps.tiled().is_behind(samples, nearest, &mut asking);
                let answer = asking.answer(is_behind, nearest);
                let held = answer.decisive.map_or(f32::INFINITY, |d| d.held);
                (DepthTest { is_behind, entry: [0, 0], held, reads: answer.reads }, pixels)
            }
        };
        let kind = self.params.depth;
        let compared = DepthCompared { node, nearest, test, pixels: place, kind };
        self.watch.note(move || Evidence::Compared(compared));
        test.is_behind
    }
    /// The overlap test (Section 5.1): whether a rectangle lies within what occluders cover.
    fn overlaps(&mut self, node: NodeId, pixels: PixelRect) -> Overlap {
        let samples = self.maps.samples_of(pixels, self.params.samples);
        let maps = self.maps.opacity();
        let (under, ignored) = (maps.under(samples), self.params.ignored(maps));
        let mut hears = Reporter { node, ignored, watch: &mut *self.watch, kinds: std::marker::PhantomData };
        overlap_test(maps, under, ignored, maps.start(under), &mut hears)
    }

    fn draw(&mut self, leaf: NodeId) {
        self.memory.drawn[leaf.at()] = true;
        self.line(line::DRAW);
        let prims = self.index.tree().prims_below(leaf);
        let one_sided = self.params.surfaces.one_sided;
        let is_occluder = self.memory.scratch.holds[leaf.at()] && self.params.knows_what_shows();
        if !one_sided && !is_occluder {
            self.line(line::DRAW_ALL);
            return self.out.prims.extend_from_slice(prims);
        }
        for &prim in prims {
            self.line(line::EACH_PRIM);
            if one_sided {
                self.line(line::FACES_AWAY);
                // Facing is a matter of each primitive and says nothing of the leaf.
                self.watch.note(move || Evidence::Facing(Facing::of(prim)));
                if self.scene.faces_away(prim, self.view.eye.position) {
                    self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
                    continue;
                }
            }
            if is_occluder {
                self.line(line::SHOWS_NOWHERE);
                if !self.maps.shows(prim) {
                    self.leave_out(prim);
                    continue;
                }
            }
            self.line(line::DRAW_PRIM);
            self.out.prims.push(prim);
            self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        }
    }
    /// Leaves out a primitive of an occluder that is known to show nowhere.
    fn leave_out(&mut self, prim: PrimId) {
        let (scene, view, surfaces) = (self.scene, self.view, self.params.surfaces);
        let tiles = self.maps.tiled().tiles();
        self.watch.note(move || {
            let tile = O::KEEPS.then(|| deciding(tiles, scene, view, prim)).flatten();
            let drawn = Rasterized { prim, tile, is_hidden: true, is_tested: true, surfaces, window: None };
            Evidence::Depth(DepthNote::Rasterized(drawn))
        });
        self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
        self.work.culled += 1;
    }
}

/// What came of a node.
enum Found {
    Culled {
        is_proven: bool,
    },
    /// It may be seen; whether all of it passes the first of both tests.
    Open(bool),
}

fn whole<S: Faces>(view: &View<S>) -> PixelRect {
    PixelRect { x0: 0, x1: view.width, y0: 0, y1: view.height }
}

/// Reports the overlap test at the lines of Figure 8.
struct Reporter<'a, S, O> {
    node: NodeId,
    ignored: u32,
    watch: &'a mut O,
    kinds: std::marker::PhantomData<S>,
}

impl<S: Faces, O: Observer<Evidence<S>>> overlap::Hears for Reporter<'_, S, O> {
    #[inline]
    fn reaches(&mut self, step: overlap::Step) {
        use overlap::Step;
        if !O::LISTENS {
            return;
        }
        let line = match step {
            Step::Each => line::TEST_EACH,
            Step::Check => line::CHECK,
            Step::Compare => line::COMPARE,
            Step::Opaque => line::OPAQUE,
            Step::Finest => line::FINEST,
            Step::Transparent => line::TRANSPARENT,
            Step::TooTransparent => line::TOO_TRANSPARENT,
            Step::Ends => line::ENDS,
            Step::Descend => line::DESCEND,
            Step::Covered => line::COVERED,
        };
        if step == Step::Each {
            self.watch.event(Event::Line(line));
            return self.watch.event(Event::Line(line::TEST_CHECK));
        }
        self.watch.event(Event::Line(line));
    }
    #[inline]
    fn reads(&mut self, read: MapRead) {
        let (node, ignored) = (self.node, self.ignored);
        self.watch.note(move || Evidence::Read(node, read, ignored));
    }
}
