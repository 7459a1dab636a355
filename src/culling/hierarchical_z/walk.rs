//! The traversal of one frame, in the incremental and the two-pass form.

use super::code::line;
use super::evidence::Evidence;
use super::index::CubeIndex;
use super::{Form, Params, Volume};
use crate::culling::cubes::{Check, CubeNote};
use crate::culling::depth::{
    Answer, Answered, Asking, DepthNote, Faces, Ground, Rasterized, Stage, TileStep, Tiled, deciding, ends,
    footprint, project_sphere,
};
use crate::drawing::Subject;
use crate::geometry::{
    BoxImage, Footprint, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Projection, Space, Vector, View,
    nearest_depth,
};
use crate::index::{Octree, OctreeNode};
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Frame, Method, Observer, Verdict};
use crate::raster::{Fate, Question};
use crate::scene::Scene;

/// Buffers that frames reuse. A copy of the memory does not hold them.
#[derive(Default)]
pub(super) struct Scratch {
    /// Cubes that were drawn from the list.
    cubes: Vec<bool>,
    /// What became of the primitives of the cube at hand.
    fates: Vec<(PrimId, Fate)>,
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The traversal of one frame.
pub(super) struct Walk<'a, S: Faces, O> {
    index: &'a CubeIndex<S>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    frustum: Frustum<S::Vector>,
    projection: Projection<S::Vector>,
    params: &'a Params,
    tiled: &'a mut Tiled<S>,
    cubes: &'a mut [bool],
    fates: &'a mut Vec<(PrimId, Fate)>,
    listed: &'a mut [bool],
    /// Two-pass form: cubes that are drawn together with others.
    waiting: Vec<NodeId>,
    /// Visited cubes that passed primitives on to several children.
    passing: Vec<NodeId>,
    /// Cubes that came onto the list.
    added: u32,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
}

impl<'a, S: Faces, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    /// A frame that is yet to be walked.
    pub(super) fn new<M: Method<S, Params = Params, Index = CubeIndex<S>>>(
        frame: &Frame<'a, S, M>,
        listed: &'a mut [bool],
        scratch: &'a mut Scratch,
        tiled: &'a mut Tiled<S>,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let Frame { index, scene, view, params, .. } = *frame;
        let Scratch { cubes, fates } = scratch;
        cubes.clear();
        cubes.resize(index.octree().nodes().len(), false);
        Self {
            index,
            scene,
            view,
            frustum: view.frustum(),
            projection: view.projection(),
            params,
            tiled,
            cubes,
            fates,
            listed,
            waiting: Vec::new(),
            passing: Vec::new(),
            added: 0,
            out,
            watch,
        }
    }
    fn octree(&self) -> &'a Octree<S::Vector> {
        self.index.octree()
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
        if self.is_two_pass() && self.params.coherence {
            self.line(line::DRAW_KEPT);
            self.draw_together();
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
        let farthest = if interval == 1 { 0.0 } else { self.tiled.tiles().farthest() };
        let listed = self.listed.iter().filter(|l| **l).count() as u32;
        let check = Check::new([frames, interval], [self.added, listed], [farthest, before]);
        self.line(line::CHECK);
        self.watch.note(move || Evidence::Cube(CubeNote::Checked(check)));
        if check.due.is_some() {
            self.unlist(NodeId(0), Frustum::<S::Vector>::ALL);
        }
        (check.due.is_some(), farthest)
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

    /// Draws the cubes that are on the list and in view.
    fn draw_listed(&mut self, id: NodeId, planes: u8) {
        // Nothing below it is drawn from the list either, whatever marks there are.
        if !self.listed[id.at()] {
            return;
        }
        let node = &self.octree().nodes()[id.at()];
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
        for child in front_to_back(self.octree(), node, self.view) {
            self.draw_listed(child, cutting);
        }
    }

    fn visit(&mut self, id: NodeId, planes: u8) {
        let index = self.octree();
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
            let is_obscured = self.is_obscured(id, true);
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

    /// Draws what the cubes hold that were kept.
    fn draw_together(&mut self) {
        std::mem::take(&mut self.waiting).into_iter().for_each(|node| self.draw(node));
    }
    /// Draws what a cube holds and is not drawn yet, and reports what became of each primitive.
    fn draw(&mut self, id: NodeId) {
        self.line(line::DRAW_CUBE);
        if self.octree().own(id).is_empty() && self.octree().shared(id).is_empty() {
            return;
        }
        let one_sided = self.params.surfaces.one_sided;
        self.line(line::TILES);
        self.watch.note(|| Evidence::Depth(DepthNote::Drawn(id, one_sided)));
        let mut fates = std::mem::take(self.fates);
        fates.clear();
        fates.extend_from_slice(self.tiled.step(TileStep::Draw(id, one_sided)));
        self.line(line::EACH);
        for &(prim, fate) in &fates {
            self.tell(prim, fate);
        }
        *self.fates = fates;
    }
    /// Reports what became of a primitive of a cube that was drawn, and lists it if it may show.
    fn tell(&mut self, prim: PrimId, fate: Fate) {
        let (scene, view, surfaces) = (self.scene, self.view, self.params.surfaces);
        // One seen edge-on faces neither way; it covers nothing, and is hidden.
        let may_be_away = fate == Fate::Away || fate == Fate::Apart && surfaces.one_sided;
        if may_be_away && scene.faces_away(prim, view.eye.position) {
            self.line(line::FACES_AWAY);
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            return self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
        }
        let is_tested = self.params.primitive_test;
        if is_tested {
            self.line(line::TEST);
        }
        let is_hidden = is_tested
            && match fate {
                Fate::Shown => false,
                Fate::Hidden | Fate::Away => true,
                // What hides nothing is in no tile, so it is asked for by its box.
                Fate::Apart => self.hides_apart(prim),
            };
        if !is_hidden {
            self.line(line::LIST);
        }
        let tiles = self.tiled.tiles();
        self.watch.note(move || {
            let tile = (is_tested && O::KEEPS).then(|| deciding(tiles, scene, view, prim)).flatten();
            let drawn = Rasterized { prim, tile, is_hidden, is_tested, surfaces, window: None };
            Evidence::Depth(DepthNote::Rasterized(drawn))
        });
        if is_hidden {
            self.line(line::SKIP);
            self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
        } else {
            self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            self.out.prims.push(prim);
        }
    }
    /// Whether a primitive that is in no cluster is hidden, by tiles alone.
    fn hides_apart(&mut self, prim: PrimId) -> bool {
        let bounds = self.scene.prim_bounds(prim);
        let mut asking = Asking::new(&mut *self.watch, |_: Stage| None, None);
        self.tiled.hides_box(&bounds, false, &mut asking).is_none_or(|(is_hidden, _)| is_hidden)
    }

    /// Whether the tiles hide a cube. `exact`: where they do not decide, the depths of their pixels do.
    fn is_obscured(&mut self, node: NodeId, exact: bool) -> bool {
        let cube = &self.octree().nodes()[node.at()];
        let question = question(cube, self.view, &self.projection, self.params);
        self.line(line::QUERY);
        self.line(line::NEAR);
        let decided = |is_hidden: bool, nearest: f32| Answer { is_hidden, nearest, reads: 0, decisive: None };
        let is_by_planes = self.params.query == Volume::Planes;
        let (pixels, answer, ground) = match question {
            Asked::Decided(Ground::CrossesNear) => {
                self.line(line::CROSSES);
                (PixelRect::default(), decided(false, 1.0 / self.view.eye.near), Ground::CrossesNear)
            }
            Asked::Decided(ground) => {
                self.line(line::NO_PIXEL);
                (PixelRect::default(), decided(true, 1.0 / self.view.eye.near), ground)
            }
            Asked::Open(image, nearest) if image.pixels.is_empty() => {
                self.line(line::NO_PIXEL);
                (image.pixels, decided(true, nearest), Ground::Cells)
            }
            Asked::Open(image, nearest) => {
                self.line(match self.params.query {
                    Volume::Planes => line::BOX,
                    Volume::Rectangles => line::RECTANGLE,
                    Volume::Sphere => line::SPHERE,
                });
                let boxes = is_by_planes.then(|| [ends::<S>(&cube.bounds), ends::<S>(&cube.whole)]);
                let question = Question { pixels: image.pixels, nearest, boxes, exact };
                let mut asking = Asking::new(&mut *self.watch, line_of, Some(node));
                let is_hidden = self.tiled.hides(question, &mut asking);
                (image.pixels, asking.answer(is_hidden, nearest), Ground::Cells)
            }
        };
        let bounds = cube.bounds;
        self.watch.note(move || {
            let answered = Answered { node, bounds, pixels, answer, ground, is_by_planes };
            Evidence::Depth(DepthNote::Answered(answered))
        });
        answer.is_hidden
    }

    /// Reports the primitives that a cube passed on and none of its children drew.
    fn report_unseen(&mut self, id: NodeId) {
        for &prim in self.octree().passed(id) {
            if !self.tiled.is_drawn(prim) {
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
        let node = &self.octree().nodes()[id.at()];
        let cutting = match self.frustum.test(&node.bounds, planes) {
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.line(line::EACH_CHECKED);
        self.line(line::CHECK_OBSCURED);
        // By tiles alone: most of the list is visible, and to be sure of the rest costs more than it saves.
        let is_obscured = self.is_obscured(id, false);
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
            self.octree().nodes()[id.at()].children().for_each(|child| self.unmark(NodeId(child)));
        }
    }
}

/// What there is to query for a cube.
enum Asked {
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
) -> Asked {
    let is_sphere = params.query == Volume::Sphere;
    match if is_sphere {
        project_sphere(view, &node.whole)
    } else {
        footprint(view, projection, &node.bounds)
    } {
        // The sphere is that about the wholes already.
        Footprint::Seen(image) if is_sphere || node.whole == node.bounds => Asked::Open(image, image.nearest),
        // A shared primitive is drawn as a whole, and the part outside the cube may come nearer.
        Footprint::Seen(image) => Asked::Open(image, nearest_depth(projection, &node.whole, view.eye.near)),
        // Beside the view, but not by enough for the frustum's test.
        Footprint::Outside => Asked::Decided(Ground::BesideImage),
        Footprint::CrossesNear => Asked::Decided(Ground::CrossesNear),
    }
}

/// The lines of a question.
fn line_of(stage: Stage) -> Option<u8> {
    Some(match stage {
        Stage::Block => line::BLOCK,
        Stage::BehindBlock => line::BEHIND_BLOCK,
        Stage::CoversBlock => line::COVERS_BLOCK,
        Stage::Tile => line::TILE,
        Stage::BehindTile => line::BEHIND_TILE,
        Stage::CoversTile => line::COVERS_TILE,
        Stage::Keep => line::KEEP_TILE,
        Stage::Kept => line::KEPT,
        Stage::Bare => line::BARE,
        Stage::KeptStill => line::KEPT_STILL,
        Stage::Plane => line::PLANE,
        Stage::Resolve => line::RESOLVE,
        Stage::Pixel => line::PIXEL,
        Stage::Hidden => line::ALL_HIDDEN,
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
