//! `hierarchical-z`: cubes of an octree that a z-pyramid hides are not drawn.
//!
//! Greene, Kass and Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993,
//! <https://doi.org/10.1145/166117.166147>, as Georges, "Obscuration Culling on Parallel Graphics
//! Architectures", UNC TR95-017, 1995, describes it. A frame ([`walk`]):
//!
//! 1. the cubes that were visible in the last frame are drawn, which almost completes the z-buffer
//!    (Section 3.3);
//! 2. the octree (Section 3.1) is visited front to back. A cube whose box the z-pyramid hides is dropped
//!    with all below it (Section 3.2, [`crate::culling::depth`]); another one is drawn and goes onto the
//!    visible list;
//! 3. what the list holds and the finished image does not show leaves it (Section 3.3).
//!
//! Departures: the query is for the bounds of what a cube holds, not for the cube; the pyramid is brought up
//! to date where it is read, not where it is drawn (see [`crate::raster::Pyramid`]); the list is kept as
//! marks on the tree, so cubes are drawn front to back; a cube on the list whose ancestor left it leaves with
//! it. Cost: O(visible cubes) queries and the drawing of what they hold; memory O(cubes) from frame to frame.

mod evidence;
pub mod parts;
mod picture;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Arc;

pub(crate) use self::evidence::Evidence;
use self::walk::{Scratch, Walk};
use super::cubes::Cubes;
use super::depth::picture::probe;
use super::depth::{Buffer, Faces};
use crate::drawing::Drawing;
use crate::index::Octree;
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State,
    backface_knob, keeps_nothing, words,
};
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene};

/// The method.
pub(crate) struct HierarchicalZ;

/// Parameters of [`HierarchicalZ`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Params {
    coherence: bool,
    form: Form,
    query: Volume,
    primitive_test: bool,
    check_interval: u32,
    cubes: Cubes,
    backface_culling: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            // The paper's way wherever there is a choice. Section 3.3: the visible list makes the z-buffer
            // "almost complete".
            coherence: true,
            form: Form::default(),
            query: Volume::default(),
            primitive_test: true,
            // Section 3.3: "At the end of each frame all objects on the visible list are checked".
            check_interval: 1,
            cubes: Cubes::default(),
            backface_culling: false,
        }
    }
}

words! {
    /// Ways through a frame.
    pub(crate) enum Form {
        /// Each cube is drawn as soon as it passes (the paper).
        Incremental = "incremental",
        /// All cubes are queried against the pyramid of what was visible before, as today's engines do.
        TwoPass = "two-pass",
    }
}

words! {
    /// Volumes that stand for a cube, and how they are queried.
    pub(crate) enum Volume {
        /// Each face toward the eye, as projected (the paper).
        Faces = "faces",
        /// The screen rectangle of its box.
        Rectangles = "rectangles",
        /// The sphere around it (Section 5.3).
        Sphere = "sphere",
    }
}

const CODE: &[CodeLine] = &[
    // Section 3.3.
    CodeLine::new("Frame:1", "Frame(visible list L)"),
    CodeLine::new("Frame:2", "  clear the z-buffer and the z-pyramid"),
    CodeLine::new("Frame:3", "  for each cube C of L in view, front to back"),
    CodeLine::new("Frame:4", "    Draw(C)"),
    CodeLine::new("Frame:5", "  Visit(root)"),
    CodeLine::new("Frame:6", "  if a check of L is due"),
    CodeLine::new("Frame:7", "    for each C of L in view: if Obscured(C), remove C"),
    // Section 3.1 for the tree; the list is that of Section 3.3.
    CodeLine::new("Visit:1", "Visit(cube C)"),
    CodeLine::new("Visit:2", "  if C is outside the view: return"),
    CodeLine::new("Visit:3", "  if C is not in L"),
    CodeLine::new("Visit:4", "    if Obscured(C): return"),
    CodeLine::new("Visit:5", "    add C to L; Draw(C)"),
    CodeLine::new("Visit:6", "  for each child D of C, front to back: Visit(D)"),
    // Section 3.1 for what is drawn once; Greene, Kass and Miller 1993, Section 3.2, for the test of a
    // primitive.
    CodeLine::new("Draw:1", "Draw(cube C)"),
    CodeLine::new("Draw:2", "  for each primitive p of C that is not drawn yet"),
    CodeLine::new("Draw:3", "    if p is behind its pyramid cells: skip it"),
    CodeLine::new("Draw:4", "    rasterize p; the pyramid follows"),
    // Section 3.2, but for the look at the few cells over the whole box.
    CodeLine::new("Obscured:1", "Obscured(cube C)"),
    CodeLine::new("Obscured:2", "  if C crosses the near plane: return false"),
    CodeLine::new("Obscured:3", "  if C is behind the few cells over its screen rectangle: return true"),
    CodeLine::new("Obscured:4", "  for each face F of C toward the eye"),
    CodeLine::new("Obscured:5", "    q := finest cell that covers F on the screen"),
    CodeLine::new("Obscured:6", "    if not Behind(F, q): return false"),
    CodeLine::new("Obscured:7", "  return true"),
    // Section 3.2: the descent "to higher resolutions".
    CodeLine::new("Behind:1", "Behind(face F, cell q)"),
    CodeLine::new("Behind:2", "  if the nearest depth of F is behind q: return true"),
    CodeLine::new("Behind:3", "  if q is a pixel or F covers q: return false"),
    CodeLine::new("Behind:4", "  for each cell r of the four below q that F touches"),
    CodeLine::new("Behind:5", "    if not Behind(F, r): return false"),
    CodeLine::new("Behind:6", "  return true"),
];

/// Lines of [`CODE`] that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const CLEAR: u8 = line(CODE, "Frame:2");
    pub const DRAW_LISTED: u8 = line(CODE, "Frame:4");
    pub const VISIT_ROOT: u8 = line(CODE, "Frame:5");
    pub const CHECK: u8 = line(CODE, "Frame:6");
    pub const UNLIST: u8 = line(CODE, "Frame:7");
    pub const OUTSIDE: u8 = line(CODE, "Visit:2");
    pub const IN_LIST: u8 = line(CODE, "Visit:3");
    pub const OBSCURED: u8 = line(CODE, "Visit:4");
    pub const ADD: u8 = line(CODE, "Visit:5");
    pub const CHILD: u8 = line(CODE, "Visit:6");
    pub const SKIP: u8 = line(CODE, "Draw:3");
    pub const RASTERIZE: u8 = line(CODE, "Draw:4");
    pub const NEAR: u8 = line(CODE, "Obscured:2");
    pub const WHOLE: u8 = line(CODE, "Obscured:3");
    pub const BEHIND: u8 = line(CODE, "Behind:2");
}

/// What is kept from frame to frame.
#[derive(Clone, Default)]
pub(crate) struct Memory {
    /// The visible list, as a mark for each cube.
    listed: Vec<bool>,
    /// Frames since the list was checked.
    frames: u32,
    /// The farthest depth of the last image.
    farthest: f32,
    scratch: Scratch,
}

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
        stands: &[],
        departures: &[],
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let source = "Georges 1995, Section 3.3";
        let coherence = Knob::new(
            "coherence",
            "",
            "what was visible in the last frame is drawn first, without a test",
            source,
        );
        knobs.switch(coherence, &mut params.coherence);
        let form = Knob::new(
            "form",
            "",
            "incremental: a cube is drawn as soon as it passes its test, as in the paper; two-pass: all \
             cubes are tested against what was visible before, as engines do today",
            source,
        );
        knobs.words(form, &mut params.form);
        // Section 5.3: "Spheres could be used as another type of bounding volume".
        let query = Knob::new(
            "query",
            "",
            "how a cube is asked for: by its front faces as projected, by their screen rectangles, or by the \
             sphere around it",
            "Georges 1995, Sections 3.2 and 5.3",
        );
        knobs.words(query, &mut params.query);
        let test = Knob::new(
            "primitive-test",
            "",
            "primitives behind their pyramid cells are not drawn either",
            "Greene, Kass and Miller 1993, Section 3.2",
        );
        knobs.switch(test, &mut params.primitive_test);
        // Section 4.2: if tests are expensive, "the full recheck can be done after a fixed number of frames".
        let check = Knob::new(
            "check-interval",
            "frames",
            "how often the visible list is checked against the finished image",
            "Georges 1995, Sections 3.3 and 4.2",
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
        let Memory { listed, frames, farthest, scratch } = memory;
        // Cubes that have no mark yet begin off the list.
        listed.resize(frame.index.nodes().len(), false);
        // Without the list of the last frame every cube that is reached is queried, as in a first frame.
        if !frame.params.coherence {
            listed.fill(false);
        }
        let mut walk = Walk::new(frame, listed, scratch, buffer, out, watch);
        walk.run();
        // Section 3.3: against the final z-buffer, so after all is drawn. No list is kept without coherence.
        if frame.params.coherence {
            let (is_checked, now) = walk.check(*farthest, *frames + 1);
            (*frames, *farthest) = (if is_checked { 0 } else { *frames + 1 }, now);
        }
    }
}

impl<S: Faces> State<S, HierarchicalZ> for Buffer<S> {
    // A copy of the images costs as much as drawing about this many primitives.
    const KEYFRAME_NOTES: usize = 1 << 14;
    fn begin(&mut self, frame: &Frame<'_, S, HierarchicalZ>) {
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
        // Of the pictures only the levels beside each other show cells that are not askew.
        (which == 0).then(|| probe(moment.state, moment.frame.view, at))?
    }
}
