//! `large-occluders`: conservative occlusion culling by a few large convex polygons.
//!
//! Coorg and Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997,
//! <https://doi.org/10.1145/253284.253312>. Its steps, by which the bodies refer to them:
//!
//! 1. Once per scene: a kD-tree, and for each of its leaves and some viewing directions the occluders that
//!    look largest from there (Section 3.1, [`index`], [`selection`]).
//! 2. Per frame: the active occluders are those of the leaf and direction of the Eye (Section 3.1).
//! 3. Visit the tree from the root (Figure 9, [`walk`]). Test each node's box against the active occluders by
//!    supporting and separating planes (Section 2, [`relation`]), one by one and as connected sets
//!    ([`joint`]); only those that partially occlude a node are passed to its children. The planes are kept
//!    from frame to frame (Section 3, [`memory`]).
//! 4. Test what survives object by object against the occluders near it (Section 3.2).
//!
//! Where it departs from the paper: `DEPARTURES`. Cost: O(occluders · nodes visited); memory O(nodes ·
//! occluders).

mod explain;
mod index;
mod joint;
mod memory;
mod occluders;
pub mod parts;
mod ranking;
mod relation;
#[cfg(test)]
mod said;
mod saved;
mod selection;
mod space;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Arc;

pub use self::explain::Evidence;
use self::index::Index;
use self::memory::Memory;
pub use self::memory::Owner;
pub use self::parts as anatomy;
use self::space::Shape;
use self::walk::Walk;
use crate::drawing::Drawing;
use crate::method::{
    Card, CodeLine, Departure, DrawList, Event, Frame, Hiders, Knob, Knobs, Method, Moment, Observer, Shown,
    State, When, surface_knobs,
};
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub struct LargeOccluders;

/// Parameters of [`LargeOccluders`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    tree_height: u32,
    cells: bool,
    occluders: u32,
    directions: u32,
    marginal_gain: u32,
    cache: bool,
    detail_objects: bool,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        // The paper's (Section 4): height 8, 32 occluders for each of 8 directions. All parts of the paper
        // are on; turned off, each shows what it is worth.
        Self {
            tree_height: 8,
            cells: false,
            occluders: 32,
            directions: 8,
            // Section 5 names an adaptive choice of k as future work.
            marginal_gain: 0,
            cache: true,
            detail_objects: true,
            // An occluder then hides from either side.
            surfaces: Surfaces::default(),
        }
    }
}

// Figure 9. Lines 2 and 3 of Visible are "Frustum Culling" of Section 3, TestOcclusion follows Section 2, and
// Gather tests the detail objects of Section 3.2.
const CODE: &[CodeLine] = &[
    CodeLine::new("Select:1", "S := the occluders of P's leaf and direction"),
    CodeLine::departing(
        "Select:2",
        "  those k of them that look largest from P",
        "the k that look largest from the leaf's center",
    ),
    CodeLine::new("Visible:1", "Visible(occluders S, node T, viewpoint P)"),
    CodeLine::new("Visible:2", "  if T lies outside the view frustum"),
    CodeLine::new("Visible:3", "    return"),
    CodeLine::new("Visible:4", "  TestOcclusion(S, T, P)"),
    CodeLine::departing(
        "Visible:5",
        "  if no A of S occludes T, nor the frustum cuts T",
        "if S does not occlude T",
    ),
    CodeLine::new("Visible:6", "    Gather(T)"),
    CodeLine::new("Visible:7", "  else if T is occluded"),
    CodeLine::new("Visible:8", "    return"),
    CodeLine::new("Visible:9", "  else if T is a leaf"),
    CodeLine::new("Visible:10", "    Gather(T)"),
    CodeLine::new("Visible:11", "  else S' := those of S that partially occlude T"),
    CodeLine::new("Visible:12", "    for each child T' of T: Visible(S', T', P)"),
    CodeLine::new("Visible:13", "    leave out what crosses T's plane and no leaf drew"),
    CodeLine::new("TestOcclusion:1", "TestOcclusion(S, T, P)"),
    CodeLine::new("TestOcclusion:2", "  for each A of S"),
    CodeLine::new("TestOcclusion:3", "    if T lies on P's side of A: A does not occlude T"),
    CodeLine::new("TestOcclusion:4", "    planes of A and T: kept ones, or made"),
    CodeLine::new("TestOcclusion:5", "    for each edge of A: test P against its planes"),
    CodeLine::departing(
        "TestOcclusion:6",
        "    if P satisfies all supporting planes by ε",
        "if P satisfies all supporting planes",
    ),
    CodeLine::new("TestOcclusion:7", "      T is occluded by A"),
    CodeLine::new("TestOcclusion:8", "    else if P satisfies all separating planes"),
    CodeLine::new("TestOcclusion:9", "      A partially occludes T"),
    CodeLine::new("TestOcclusion:10", "    else A does not occlude T"),
    CodeLine::departing(
        "TestOcclusion:11",
        "  if some of them jointly occlude T",
        "if connected ones jointly occlude T",
    ),
    CodeLine::new("TestOcclusion:12", "    T is occluded by them"),
    CodeLine::new("Gather:1", "Gather(T)"),
    CodeLine::new("Gather:2", "  draw all of T"),
    CodeLine::new("Gather:3", "  for each object D of T"),
    CodeLine::new("Gather:4", "    if D lies outside the view frustum: leave D out"),
    CodeLine::new("Gather:5", "    TestOcclusion(occluders near D, D, P)"),
    CodeLine::new("Gather:6", "    if D is occluded: leave D out"),
    CodeLine::new("Gather:7", "    else draw D"),
    CodeLine::new("Draw:1", "Draw(D): for each polygon p of D"),
    CodeLine::new("Draw:2", "  if p faces away from P: skip p"),
    CodeLine::new("Draw:3", "  else draw p"),
];

/// Lines that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const SELECT: u8 = line(CODE, "Select:1");
    pub const PICK: u8 = line(CODE, "Select:2");
    pub const VISIBLE: u8 = line(CODE, "Visible:1");
    pub const FRUSTUM: u8 = line(CODE, "Visible:2");
    pub const OUTSIDE: u8 = line(CODE, "Visible:3");
    pub const TEST: u8 = line(CODE, "Visible:4");
    pub const FREE: u8 = line(CODE, "Visible:5");
    pub const GATHER_FREE: u8 = line(CODE, "Visible:6");
    pub const IS_OCCLUDED: u8 = line(CODE, "Visible:7");
    pub const OCCLUDED: u8 = line(CODE, "Visible:8");
    pub const IS_LEAF: u8 = line(CODE, "Visible:9");
    pub const GATHER_LEAF: u8 = line(CODE, "Visible:10");
    pub const PASS: u8 = line(CODE, "Visible:11");
    pub const CHILD: u8 = line(CODE, "Visible:12");
    pub const CROSSING: u8 = line(CODE, "Visible:13");
    pub const TEST_OCCLUSION: u8 = line(CODE, "TestOcclusion:1");
    pub const EACH: u8 = line(CODE, "TestOcclusion:2");
    pub const BEFORE: u8 = line(CODE, "TestOcclusion:3");
    pub const PLANES: u8 = line(CODE, "TestOcclusion:4");
    pub const EDGE: u8 = line(CODE, "TestOcclusion:5");
    pub const SUPPORTING: u8 = line(CODE, "TestOcclusion:6");
    pub const FULL: u8 = line(CODE, "TestOcclusion:7");
    pub const SEPARATING: u8 = line(CODE, "TestOcclusion:8");
    pub const PARTIAL: u8 = line(CODE, "TestOcclusion:9");
    pub const NONE: u8 = line(CODE, "TestOcclusion:10");
    pub const JOINTLY: u8 = line(CODE, "TestOcclusion:11");
    pub const JOINT: u8 = line(CODE, "TestOcclusion:12");
    pub const GATHER: u8 = line(CODE, "Gather:1");
    pub const DRAW_ALL: u8 = line(CODE, "Gather:2");
    pub const OBJECT: u8 = line(CODE, "Gather:3");
    pub const OBJECT_OUTSIDE: u8 = line(CODE, "Gather:4");
    pub const DETAIL: u8 = line(CODE, "Gather:5");
    pub const OBJECT_OCCLUDED: u8 = line(CODE, "Gather:6");
    pub const DRAW_OBJECT: u8 = line(CODE, "Gather:7");
    pub const POLYGON: u8 = line(CODE, "Draw:1");
    pub const FACING: u8 = line(CODE, "Draw:2");
    pub const DRAW: u8 = line(CODE, "Draw:3");
}

/// Kinds of events and the lines at which they stand.
const STANDS: &[(&str, &[&str])] = &[
    ("OccluderChosen", &["Select:2"]),
    ("NodeClassified", &["Visible:2"]),
    ("NodeDecided outside", &["Visible:3"]),
    ("NodeDecided hidden", &["Visible:8"]),
    ("NodeDecided partial", &["Visible:11"]),
    ("NodeDecided visible", &["Visible:6", "Visible:10"]),
    ("EdgeTested", &["TestOcclusion:5"]),
    ("OcclusionTested", &["TestOcclusion:3", "TestOcclusion:7", "TestOcclusion:9", "TestOcclusion:10"]),
    ("JointlyOccluded", &["TestOcclusion:12"]),
    ("ObjectClassified", &["Gather:4"]),
    ("PrimDecided outside", &["Gather:4"]),
    ("PrimDecided hidden", &["Gather:6", "Visible:13"]),
    ("PartSeen", &["Gather:2", "Gather:7", "Visible:13"]),
    ("PartsUnseen", &["Visible:13"]),
    ("PrimDecided visible", &["Gather:2", "Gather:7", "Visible:13", "Draw:3"]),
    ("OrientationTested", &["Draw:2"]),
    ("PrimDecided faces-away", &["Draw:2"]),
];

/// Where the method differs from the paper.
const DEPARTURES: &[Departure] = &[
    Departure {
        section: "2",
        what: "occlusion is demanded with a margin",
        why: "so that it also holds at the pixels of a rasterizer, which snaps corners and rounds depths",
        when: When::Always,
    },
    Departure {
        section: "2",
        what: "where an occluder's plane cuts a box, the occlusion is partial, and of each edge one of both \
               planes will do",
        why: "what lies behind the plane can still be occluded; the paper's half-space condition would pass \
              no occluder on from the root, which every occluder cuts",
        when: When::Always,
    },
    Departure {
        section: "2",
        what: "the jointly occluding set is the largest one that passes, not a whole connected component",
        why: "one member that fails would otherwise spoil a set that hides the box without it",
        when: When::Always,
    },
    Departure {
        section: "3",
        what: "a node that no occluder hides is gathered only if the frustum does not cut it either",
        why: "its children may still lie outside the view",
        when: When::Always,
    },
    Departure {
        section: "3.1",
        what: "the list of a leaf and direction is four times as long as k, and of it those k are taken that \
               look largest from the eye itself",
        why: "a leaf may be large, and what looks large from its center need not from elsewhere in it",
        when: When::Always,
    },
    Departure {
        section: "3.1",
        what: "an eye outside of the scene's box is in no leaf: all occluders are ranked where it stands",
        why: "a leaf at the border lists what can hide something from within, such as a wall from the inside",
        when: When::Always,
    },
    Departure {
        section: "3.1",
        what: "only occluders that can hide something from where the eye is are active: of one-sided ones \
               those that face it",
        why: "the others would take the places of those that hide something",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "detail objects are tested against the occluders that hide a part of their node as well",
        why: "what is large from the eye may hide an object from whose center it looks small",
        when: When::With("detail-objects", "true"),
    },
    Departure {
        section: "3.2",
        what: "detail objects are also tested against the frustum",
        why: "objects are far smaller than the boxes of leaves, which stick out of the view",
        when: When::With("detail-objects", "true"),
    },
    Departure {
        section: "3.2",
        what: "an object of at least 4 primitives whose diagonal is at most 5 % of the scene's is a detail \
               object",
        why: "the paper leaves open which objects are small",
        when: When::With("detail-objects", "true"),
    },
];

/// The paper, of which a parameter names the section.
macro_rules! section {
    ($section:literal) => {
        concat!("Coorg and Teller 1997, Section ", $section)
    };
}

impl<S: Shape> Method<S> for LargeOccluders {
    type Params = Params;
    type Index = Index<S>;
    type Memory = Memory<S>;
    type State = Active;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "large-occluders",
        name: "Large occluders",
        summary: "Drops every node of a kD-tree that one large convex polygon, or connected ones together, \
                  hide from the Eye.",
        paper: "Coorg and Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997.",
        doi: "10.1145/253284.253312",
        conservative: true,
        code: CODE,
        stands: STANDS,
        departures: DEPARTURES,
    };
    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let meaning =
            "levels of the kD-tree; 8 gives 255 nodes; 0: as many as leave a few dozen primitives a leaf";
        let height = Knob::new("tree-height", "levels", meaning, section!("4"));
        knobs.integer(height, 0..=24, &mut params.tree_height);
        let meaning = "boxes end at the planes that divide the tree, with what crosses them on both sides; \
                       otherwise each primitive is on one side and boxes grow to hold it";
        knobs.switch(Knob::new("cells", "", meaning, section!("4")), &mut params.cells);
        let meaning = "how many occluders are active at most, k in the paper";
        // A set of candidates is a word of 64 bits (see `joint`).
        knobs.integer(Knob::new("occluders", "", meaning, section!("3.1")), 1..=64, &mut params.occluders);
        let meaning = "viewing directions that have a set of their own";
        knobs.integer(Knob::new("directions", "", meaning, section!("3.1")), 1..=64, &mut params.directions);
        let meaning = "leaves out an occluder whose area-angle is below this share of the sum of the better \
                       ones; 0: never";
        let source = "our own: Section 5 only says that strategies for choosing k are under investigation";
        let gain = Knob::new("marginal-gain", "%", meaning, source);
        knobs.integer(gain, 0..=100, &mut params.marginal_gain);
        let meaning = "keeps planes from frame to frame";
        knobs.switch(Knob::new("cache", "", meaning, section!("3")), &mut params.cache);
        let meaning = "tests what survives object by object against the occluders near it";
        knobs.switch(Knob::new("detail-objects", "", meaning, section!("3.2")), &mut params.detail_objects);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Index<S>>, String> {
        Index::build(scene, params, saved, progress)
    }
    fn moved(
        index: &mut Arc<Index<S>>,
        memory: &mut Memory<S>,
        scene: &Arc<Scene<S>>,
        params: &Params,
        progress: &dyn Progress,
    ) -> Option<()> {
        if !Arc::make_mut(index).follow(scene, memory) {
            *index = Arc::new(Index::build(scene, params, None, progress).ok().flatten()?);
            *memory = Memory::default();
        }
        Some(())
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Memory<S>,
        active: &mut Active,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        // The memory goes over to the next frame; the state is this frame's alone, and is what a film shows
        // between steps.
        Walk::new(frame, memory, active, out, watch).run();
    }
    fn has_line(params: &Params, line: u8) -> bool {
        match line {
            line::PASS | line::CHILD => params.tree_height != 1,
            line::CROSSING => params.cells && params.tree_height != 1,
            // The root holds the occluders themselves, so none can hide it.
            line::OCCLUDED => params.tree_height != 1,
            // An object may have one of the active occluders and another of those near it.
            line::JOINTLY | line::JOINT => {
                params.detail_objects || params.occluders > 1 && params.tree_height != 1
            }
            line::DRAW_ALL => !params.detail_objects,
            line::OBJECT..=line::DRAW_OBJECT => params.detail_objects,
            line::POLYGON..=line::DRAW => params.surfaces.one_sided,
            _ => true,
        }
    }
}

/// The occluders that are active in a frame, in the order in which they were chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Active(Vec<u32>);

impl Active {
    fn choose(&mut self, occluder: u32) {
        // The run and its film change the set here and nowhere else, so they cannot drift apart.
        self.0.push(occluder);
    }
}

impl<S: Shape> State<S, LargeOccluders> for Active {
    // A copy is at most 64 numbers, made in about the time that a thousand notes, nearly all of which change
    // nothing, take to replay; beside so many notes it takes no memory that counts.
    const KEYFRAME_NOTES: usize = 1024;
    fn begin(&mut self, _: &Frame<'_, S, LargeOccluders>) {
        self.0.clear();
    }
    fn apply(&mut self, _: &Scene<S>, note: &Evidence<S>) {
        // All other notes are about boxes and leave the set as it is.
        if let Evidence::Chosen(n) = note {
            self.choose(n.occluder);
        }
    }
}

impl<S: Shape> Shown<S> for LargeOccluders {
    fn hiders(_: &Frame<'_, S, Self>, notes: &[Self::Note], at: usize) -> Option<Hiders> {
        explain::hiders(notes, at)
    }
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        explain::draw(&moment.state.0, &moment.frame, moment.note, to);
    }
}
