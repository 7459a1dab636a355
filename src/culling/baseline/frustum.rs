//! `frustum`: view-frustum culling over a kD-tree.
//!
//! Clark 1976 (hierarchical view-frustum culling); the tree is that of Coorg and Teller 1997,
//! Section 4. Planes that a node lies wholly inside of are not tested again below it. A node is culled
//! only where it lies outside a plane by more than the bound on the rounding error (see
//! [`crate::geometry::Frustum`]), so no visible primitive is lost. Primitives of a leaf that the frustum
//! cuts are drawn without a test of their own, as in the paper.
//! Cost: O(nodes that touch the frustum's boundary + primitives drawn).

use std::sync::Arc;

use super::explain::Evidence;
use crate::drawing::{Drawing, Subject};
use crate::geometry::{self, FrustumTest, NodeId, Space, View};
use crate::index::KdTree;
use crate::method::evidence::{Facing, Tested};
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, Verdict,
    keeps_nothing, surface_knobs,
};
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub struct Frustum;

/// Parameters of [`Frustum`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    tree_height: u32,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        // The paper's height: about 250 nodes.
        Self { tree_height: 8, surfaces: Surfaces::default() }
    }
}

const CODE: &[CodeLine] = &[
    CodeLine::new("Visible:1", "Visible(node T, planes P)"),
    CodeLine::new("Visible:2", "  if T lies outside a plane of P"),
    CodeLine::new("Visible:3", "    return"),
    CodeLine::new("Visible:4", "  P' := the planes of P that cut T"),
    CodeLine::new("Visible:5", "  if P' is empty or T is a leaf"),
    CodeLine::new("Visible:6", "    Gather(T)"),
    CodeLine::new("Visible:7", "  else for each child T' of T"),
    CodeLine::new("Visible:8", "    Visible(T', P')"),
    CodeLine::new("Gather:1", "Gather(T)"),
    CodeLine::new("Gather:2", "  draw all of T"),
    CodeLine::new("Gather:3", "  for each polygon p of T"),
    CodeLine::new("Gather:4", "    if p faces away from the eye"),
    CodeLine::new("Gather:5", "      skip p"),
    CodeLine::new("Gather:6", "    draw p"),
];

/// Lines that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const VISIBLE: u8 = line(CODE, "Visible:1");
    pub const TEST: u8 = line(CODE, "Visible:2");
    pub const OUTSIDE: u8 = line(CODE, "Visible:3");
    pub const CUTTING: u8 = line(CODE, "Visible:4");
    pub const WHOLE: u8 = line(CODE, "Visible:5");
    pub const CALL_GATHER: u8 = line(CODE, "Visible:6");
    pub const CHILDREN: u8 = line(CODE, "Visible:7");
    pub const CHILD: u8 = line(CODE, "Visible:8");
    pub const GATHER: u8 = line(CODE, "Gather:1");
    pub const DRAW_ALL: u8 = line(CODE, "Gather:2");
    pub const EACH: u8 = line(CODE, "Gather:3");
    pub const FACING: u8 = line(CODE, "Gather:4");
    pub const SKIP: u8 = line(CODE, "Gather:5");
    pub const DRAW: u8 = line(CODE, "Gather:6");
}

impl<S: Space> Method<S> for Frustum {
    type Params = Params;
    type Index = KdTree<S::Vector>;
    type Memory = ();
    // Nothing builds up from step to step: a film shows the evidence of each step alone.
    type State = ();
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "frustum",
        name: "View-frustum culling over a kD-tree",
        summary: "Walks a kD-tree from the root and drops every node that lies outside a plane of the view \
                  frustum.",
        paper: "Clark. Hierarchical Geometric Models for Visible Surface Algorithms. CACM 19(10), 1976; \
                kD-tree as in Coorg and Teller, Real-Time Occlusion Culling for Models with Large Occluders, \
                I3D 1997, Section 4.",
        doi: "10.1145/360349.360354",
        conservative: true,
        code: CODE,
        stands: &[
            ("NodeClassified", &["Visible:2"]),
            ("OrientationTested", &["Gather:4"]),
            ("NodeDecided outside", &["Visible:3"]),
            ("NodeDecided partial", &["Visible:7"]),
            ("NodeDecided visible", &["Visible:6"]),
            ("PrimDecided faces-away", &["Gather:5"]),
            ("PrimDecided visible", &["Gather:6"]),
        ],
        departures: &[],
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let (meaning, source) =
            ("levels of the kD-tree; 8 gives 255 nodes", "Coorg and Teller 1997, Section 4");
        let height = Knob::new("tree-height", "levels", meaning, source);
        knobs.integer(height, 1..=24, &mut params.tree_height);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        // Bytes that are passed here were saved for another method: refused, so that the mistake shows.
        keeps_nothing(saved)?;
        progress.report(0.0, "building the kD-tree");
        // Every primitive lies in one leaf only, so none is drawn twice and none needs a mark.
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let Some(mut tree) = KdTree::build(boxes, params.tree_height, || progress.cancelled()) else {
            return Ok(None);
        };
        tree.refit(scene);
        Ok(Some(tree))
    }
    fn moved(
        index: &mut Arc<Self::Index>,
        (): &mut (),
        scene: &Arc<Scene<S>>,
        _: &Params,
        _: &dyn Progress,
    ) -> Option<()> {
        Arc::make_mut(index).refit(scene);
        Some(())
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        (): &mut (),
        (): &mut (),
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        let Frame { index, scene, view, params, .. } = *frame;
        watch.event(Event::FrameBegan);
        watch.stage("visit");
        let frustum = view.frustum();
        let mut walk =
            Walk { index, scene, view, frustum, backface_culling: params.surfaces.one_sided, out, watch };
        // All planes are open at the root. Each is closed for a whole subtree, where a node lies inside of
        // it.
        walk.visible(NodeId(0), geometry::Frustum::<S::Vector>::ALL);
    }
    fn has_line(params: &Params, line: u8) -> bool {
        match line {
            line::CHILDREN | line::CHILD => params.tree_height > 1,
            line::DRAW_ALL => !params.surfaces.one_sided,
            line::EACH | line::FACING | line::SKIP | line::DRAW => params.surfaces.one_sided,
            _ => true,
        }
    }
}

impl<S: Space> Shown<S> for Frustum {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        if let Some(note) = moment.note {
            note.draw(moment.frame.scene, moment.frame.view, to);
        }
    }
}

/// One traversal.
struct Walk<'a, S: Space, O> {
    index: &'a KdTree<S::Vector>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    frustum: geometry::Frustum<S::Vector>,
    backface_culling: bool,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
}

impl<S: Space, O: Observer<Evidence<S>>> Walk<'_, S, O> {
    /// Visible of the pseudocode: a node, and the planes that cut all nodes above it.
    fn visible(&mut self, id: NodeId, planes: u8) {
        let index = self.index;
        let node = &index.nodes()[id.at()];
        self.watch.event(Event::Entered(id));
        self.line(line::VISIBLE);
        self.line(line::TEST);
        // Lines 2 and 4 by one test: it ends at the first plane that the box lies outside of, or else returns
        // those that cut it.
        let test = self.frustum.test(&node.bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(id), &node.bounds, planes, test)));
        // Lines 2 to 8. A node inside all planes is drawn whole, without a test below it; so is a leaf, since
        // a test for each primitive would cost about what drawing it costs.
        if !matches!(test, FrustumTest::Outside(_)) {
            self.line(line::CUTTING);
            self.line(line::WHOLE);
        }
        match (test, node.children()) {
            (FrustumTest::Outside(_), _) => {
                self.line(line::OUTSIDE);
                self.watch.event(Event::DecidedNode(id, Verdict::Outside));
            }
            (FrustumTest::Partial(cutting), Some(children)) => {
                // Decided before its children are, so that a film shows it open while they are visited.
                self.line(line::CHILDREN);
                self.watch.event(Event::DecidedNode(id, Verdict::Partial));
                for child in children {
                    self.line(line::CHILD);
                    self.visible(child, cutting);
                }
            }
            (FrustumTest::Inside | FrustumTest::Partial(_), _) => {
                self.line(line::CALL_GATHER);
                self.gather(id);
                // Back in Visible: what Gather did not skip is drawn.
                self.line(line::CALL_GATHER);
                self.watch.event(Event::DecidedNode(id, Verdict::Visible));
            }
        }
        self.watch.event(Event::Left(id));
    }

    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }

    fn gather(&mut self, id: NodeId) {
        self.line(line::GATHER);
        // The primitives below a node lie in one piece: without back-face culling none is looked at.
        let prims = self.index.prims_below(id);
        if !self.backface_culling {
            self.line(line::DRAW_ALL);
            self.out.prims.extend_from_slice(prims);
            return;
        }
        let (scene, view) = (self.scene, self.view);
        for &prim in prims {
            self.line(line::EACH);
            self.line(line::FACING);
            // Facing is a matter of each primitive and says nothing of a node, so it comes last. Each is
            // decided by name, since the verdict about the node would call all of them visible.
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            if scene.faces_away(prim, view.eye.position) {
                self.line(line::SKIP);
                self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            } else {
                self.line(line::DRAW);
                self.out.prims.push(prim);
                self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            }
        }
    }
}
