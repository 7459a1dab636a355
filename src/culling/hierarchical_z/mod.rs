//! `hierarchical-z`: cubes of an octree that a z-pyramid hides are not drawn.
//!
//! Greene, Kass and Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993,
//! <https://doi.org/10.1145/166117.166147>, as Georges, "Obscuration Culling on Parallel Graphics
//! Architectures", UNC TR95-017, 1995, describes it. A frame ([`walk`]):
//!
//! 1. the cubes that were visible in the last frame are drawn, which almost completes the z-buffer
//!    (Section 3.3);
//! 2. the octree (Section 3.1) is visited front to back. A cube whose box the z-pyramid hides is dropped
//!    with all below it (Section 3.2); another one is drawn and goes onto the visible list;
//! 3. what the list holds and the finished image does not show leaves it (Section 3.3).
//!
//! The z-buffer and its pyramid are tiles ([`crate::raster::Tiles`]): pixels, tiles and blocks are the levels
//! that are asked. Where this differs from the papers, and why: [`DEPARTURES`]. Cost: O(visible cubes)
//! queries and the drawing of what they hold; memory O(cubes) from frame to frame.

mod code;
mod evidence;
mod index;
pub mod parts;
mod picture;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Arc;

use self::code::{CODE, DEPARTURES, STANDS, has_line};
pub(crate) use self::evidence::Evidence;
use self::index::CubeIndex;
use self::walk::{Scratch, Walk};
use super::cubes::Cubes;
use super::depth::picture::probe;
use super::depth::{DepthNote, Faces, Tiled};
use crate::drawing::Drawing;
use crate::method::{
    Card, DrawList, Event, Frame, Hiders, Knob, Knobs, Method, Moment, Observer, Shown, State, keeps_nothing,
    surface_knobs, words,
};
use crate::raster::DepthScale;
use crate::scene::{Progress, Scene, Surfaces};

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
    surfaces: Surfaces,
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
            surfaces: Surfaces::default(),
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
        /// Its box, by the planes toward the eye and away from it.
        Planes = "planes",
        /// The screen rectangle of its box.
        Rectangles = "rectangles",
        /// The sphere around it (Section 5.3).
        Sphere = "sphere",
    }
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
    type Index = CubeIndex<S>;
    type Memory = Memory;
    type State = Tiled<S>;
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
        stands: STANDS,
        departures: DEPARTURES,
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
            "how a cube is asked for: by the planes of its box, which stand for the faces of the paper; by \
             the screen rectangle of its box; or by that of the sphere around it",
            "Georges 1995, Sections 3.2 and 5.3",
        );
        knobs.words(query, &mut params.query);
        let test = Knob::new(
            "primitive-test",
            "",
            "primitives that begin behind every tile that they cover are not drawn either",
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
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self::Index>, String> {
        keeps_nothing(saved)?;
        Ok(CubeIndex::build(scene, params, progress))
    }
    fn moved(
        index: &mut Arc<Self::Index>,
        _: &mut Memory,
        scene: &Arc<Scene<S>>,
        _: &Params,
        _: &dyn Progress,
    ) -> Option<()> {
        // The cubes stay, and with them the visible list.
        Arc::make_mut(index).follow(scene);
        Some(())
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Memory,
        tiled: &mut Tiled<S>,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        let Memory { listed, frames, farthest, scratch } = memory;
        // Cubes that have no mark yet begin off the list.
        listed.resize(frame.index.octree().nodes().len(), false);
        // Without the list of the last frame every cube that is reached is queried, as in a first frame.
        if !frame.params.coherence {
            listed.fill(false);
        }
        let mut walk = Walk::new(frame, listed, scratch, tiled, out, watch);
        walk.run();
        // Section 3.3: against the final z-buffer, so after all is drawn. No list is kept without coherence.
        if frame.params.coherence {
            let (is_checked, now) = walk.check(*farthest, *frames + 1);
            (*frames, *farthest) = (if is_checked { 0 } else { *frames + 1 }, now);
        }
    }
    fn has_line(params: &Params, line: u8) -> bool {
        has_line(params, line)
    }
}

impl<S: Faces> State<S, HierarchicalZ> for Tiled<S> {
    // A copy of the tiles and of what they keep takes about as long as drawing this many primitives.
    const KEYFRAME_NOTES: usize = 1 << 13;
    fn begin(&mut self, frame: &Frame<'_, S, HierarchicalZ>) {
        self.clear(frame.view, frame.index.clusters(), frame.scene.prim_count());
    }
    fn release(&mut self) {
        Self::release(self);
    }
    fn apply(&mut self, _: &Scene<S>, note: &Evidence<S>) {
        // Everything else that is recorded leaves the tiles as they are.
        if let Some(step) = note.depth().and_then(|n| n.tile_step()) {
            self.step(step);
        }
    }
}

impl<S: Faces> Shown<S> for HierarchicalZ {
    fn hiders(_: &Frame<'_, S, Self>, notes: &[Self::Note], at: usize) -> Option<Hiders> {
        // What a cube holds is drawn at once, and each primitive of it is reported after that.
        let is_of_cube = |note: &&Evidence<S>| {
            matches!(note, Evidence::Facing(_) | Evidence::Depth(DepthNote::Rasterized(_)))
        };
        let until = at + notes[at..].iter().take_while(is_of_cube).count();
        let drawn = notes[..until].iter().filter_map(|note| note.depth()?.drawn());
        Some(Hiders::Drawn(drawn.collect()))
    }
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
        (which == 0).then(|| probe(&moment.state.levels(), moment.frame.view, at))?
    }
}
