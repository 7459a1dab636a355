//! The parts of the method by themselves: frames whose work is counted, and their maps, to be asked about
//! rectangles. For tables, which look at the very functions that the method runs.

use std::sync::Arc;

use super::evidence::{Evidence, Ground};
use super::index::{Counts, Databases};
use super::maps::{MapStep, Maps};
use super::overlap::{Hears, MapRead, Step, overlap_test};
use super::walk::Walk;
use super::{Memory, OcclusionMaps, Params};
use crate::culling::depth::Faces;
use crate::geometry::{Aabb, NodeId, PixelRect, PrimId, Solid, View};
use crate::method::{
    DrawList, Event, Frame, Method, Observer, SettingError, Settings, State, Unobserved, Verdict, params,
};
use crate::raster::{Opacity, PyramidCell};
use crate::scene::{Progress, Scene};

/// Key of the method whose parts these are.
pub(crate) const METHOD: &str = <OcclusionMaps as Method<Solid>>::CARD.key;

/// The method on a scene, with what it keeps from frame to frame.
pub(crate) struct Mapper<S: Faces> {
    scene: Arc<Scene<S>>,
    index: Arc<Databases<S>>,
    params: Params,
    memory: Memory,
    maps: Maps<S>,
    watch: Watch,
}

/// What a frame did, in primitives where nothing else is said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counted {
    /// In the frustum: of leaves that are not outside it as wholes.
    pub in_view: usize,
    /// Of these culled, proven and presumed.
    pub hidden: usize,
    pub presumed: usize,
    /// Of those culled within what the occluders cover; the others lie beside the image or between the
    /// centers of its pixels.
    pub covered: usize,
    /// Of the occluders.
    pub occluders: usize,
    /// Tests of depth and of overlap.
    pub depth_tests: usize,
    pub overlap_tests: usize,
    /// Map pixels that these read.
    pub map_reads: usize,
    /// Whether occlusion culling was on.
    pub is_on: bool,
}

/// What a frame ignored (Zhang et al. 1997, Section 5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ignored {
    /// Pixels of level 0 that counted as opaque for something that was culled, though samples of them are
    /// black.
    pub map_pixels: usize,
    /// These black samples.
    pub samples: usize,
    /// Black samples that a pixel may have at most.
    pub most: usize,
}

/// A question about a rectangle, answered in three ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    /// By the hierarchy (Figure 8), and the map pixels that were read.
    pub hierarchy: (bool, u32),
    /// By level 0 alone, pixel by pixel until one is not opaque.
    pub finest: (bool, u32),
    /// By the samples of these pixels, one by one.
    pub samples: (bool, u32),
}

impl<S: Faces> Mapper<S> {
    /// Builds what is built once; `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// A setting that does not fit the method.
    pub fn new(
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, SettingError> {
        let params = params::<S, OcclusionMaps>(settings)?;
        // It fails only on a saved preprocess, and none is given.
        let index = OcclusionMaps::build(scene, &params, None, progress).unwrap_or_default();
        let (memory, maps, watch) = (Memory::default(), Maps::default(), Watch::default());
        Ok(index.map(|index| Self {
            scene: scene.clone(),
            index: Arc::new(index),
            params,
            memory,
            maps,
            watch,
        }))
    }
    /// Goes over to another frame of the scene; false when cancelled.
    pub fn pose(&mut self, scene: &Arc<Scene<S>>, progress: &dyn Progress) -> bool {
        if Arc::ptr_eq(&self.scene, scene) {
            return true;
        }
        State::<S, OcclusionMaps>::release(&mut self.maps);
        let moved =
            OcclusionMaps::moved(&mut self.index, &mut self.memory, scene, &self.params, progress).is_some();
        if moved {
            self.scene.clone_from(scene);
        }
        moved
    }
    /// A frame, with what is remembered of the last one: what it draws, and what it did.
    pub fn cull(&mut self, view: &View<S>) -> (DrawList<S>, Counted) {
        let Self { scene, index, params, memory, maps, watch } = self;
        let frame = Frame { index: &**index, scene: &**scene, view, params, limit: None };
        let mut list = DrawList::default();
        *watch = Watch { counted: Counted { is_on: true, ..Counted::default() }, ..Watch::default() };
        // As a run does it.
        State::<S, OcclusionMaps>::begin(maps, &frame);
        OcclusionMaps::cull(&frame, memory, maps, &mut list, watch);
        let prims = |nodes: &[NodeId]| nodes.iter().map(|n| index.tree().prims_below(*n).len()).sum();
        let [hidden, presumed, kept, covered]: [usize; 4] =
            [&watch.hidden, &watch.presumed, &watch.kept, &watch.within].map(|nodes| prims(nodes));
        // Of what is kept some of the occluders' own is known to be hidden.
        let alone = watch.alone.len();
        let (hidden, kept) = (hidden + alone, kept - alone);
        let in_view = hidden + presumed + kept;
        (list, Counted { in_view, hidden, presumed, covered, ..watch.counted })
    }
    /// The maps of a frame alone (Section 3, phase 1), with nobody listening.
    pub fn make_maps(&mut self, view: &View<S>) {
        let Self { scene, index, params, memory, maps, .. } = self;
        let frame = Frame { index: &**index, scene: &**scene, view, params, limit: None };
        let mut list = DrawList::default();
        State::<S, OcclusionMaps>::begin(maps, &frame);
        Walk::new::<OcclusionMaps>(&frame, memory, maps, &mut list, &mut Unobserved).make_maps();
    }
    /// Whether boxes are culled by the maps of the last frame, in order; `None` if one is out of view.
    /// `view`: that of the frame.
    pub fn hides_all(&mut self, view: &View<S>, boxes: &[Aabb<S::Vector>]) -> Vec<Option<bool>> {
        let Self { scene, index, params, memory, maps, .. } = self;
        let frame = Frame { index: &**index, scene: &**scene, view, params, limit: None };
        let mut list = DrawList::default();
        Walk::new::<OcclusionMaps>(&frame, memory, maps, &mut list, &mut Unobserved).hides_all(boxes)
    }
    /// What the last frame culled because it is hidden, proven or presumed.
    pub fn culled(&self) -> impl Iterator<Item = PrimId> {
        let nodes = self.watch.hidden.iter().chain(&self.watch.presumed);
        let of_nodes = nodes.flat_map(|node| self.index.tree().prims_below(*node));
        of_nodes.chain(&self.watch.alone).copied()
    }
    /// What the last frame drew into the maps.
    pub fn occluders(&self) -> Vec<PrimId> {
        self.watch.covered.iter().flat_map(|node| self.index.tree().prims_below(*node)).copied().collect()
    }
    /// What the last frame ignored.
    pub fn ignored(&self) -> Ignored {
        let opacity = self.maps.opacity();
        let most = self.params.ignored(opacity);
        let [columns, rows] = opacity.size(0);
        let mut seen = vec![false; (columns * rows) as usize];
        let mut ignored = Ignored { most: most as usize, ..Ignored::default() };
        // All pixels of level 0 under the rectangle of what is culled are opaque, wherever its test began.
        for pixels in &self.watch.guessed {
            let under = opacity.under(self.maps.samples_of(*pixels, self.params.samples));
            for (x, y) in cells(under) {
                let black = opacity.black(PyramidCell { level: 0, x: x as u16, y: y as u16 }) as usize;
                let seen = &mut seen[(y * columns + x) as usize];
                if black > 0 && !std::mem::replace(seen, true) {
                    ignored.map_pixels += 1;
                    ignored.samples += black;
                }
            }
        }
        ignored
    }
    /// What the occluder database holds.
    pub fn database(&self) -> Counts {
        self.index.counts()
    }
    /// The maps of the last frame.
    pub fn opacity(&self) -> &Opacity {
        self.maps.opacity()
    }
    /// Makes the levels anew of what is drawn, as a frame does.
    pub fn build_levels(&mut self) {
        self.maps.step(MapStep::Build);
    }
    /// Black samples that an opaque pixel may have with this opacity threshold.
    pub fn black_at(&self, threshold: f32) -> u32 {
        Params { opacity_threshold: threshold, ..self.params }.ignored(self.maps.opacity())
    }
    /// Of each sample of the last frame's maps whether an occluder covers it, row by row.
    pub fn covered(&mut self) -> Vec<bool> {
        self.maps.covered()
    }
    /// Whether some samples lie within what is covered, where an opaque pixel may have so many black samples;
    /// `covered`: what [`Mapper::covered`] says.
    pub fn ask(&self, covered: &[bool], samples: PixelRect, black: u32) -> Asked {
        let opacity = self.maps.opacity();
        let under = opacity.under(samples);
        let found = overlap_test(opacity, under, black, opacity.start(under), &mut Deaf);
        let (mut finest, mut brute) = ((true, 0), (true, 0));
        for (x, y) in cells(under) {
            finest.1 += 1;
            if opacity.black(PyramidCell { level: 0, x: x as u16, y: y as u16 }) > black {
                finest.0 = false;
                break;
            }
        }
        let [width, height] = opacity.samples();
        let side = 1 << opacity.shift(0);
        for (x, y) in cells(under) {
            let high = if height == 1 { 0..1 } else { y * side..((y + 1) * side).min(height) };
            let across = x * side..((x + 1) * side).min(width);
            let all = high.flat_map(|y| across.clone().map(move |x| (x, y)));
            let mut open = 0;
            for (x, y) in all {
                brute.1 += 1;
                open += u32::from(!covered[(y * width + x) as usize]);
            }
            if open > black {
                brute.0 = false;
                break;
            }
        }
        Asked { hierarchy: (found.is_covered, found.reads), finest, samples: brute }
    }
}

/// Columns and rows of a rectangle, row by row.
fn cells(r: PixelRect) -> impl Iterator<Item = (u32, u32)> {
    (r.y0..r.y1).flat_map(move |y| (r.x0..r.x1).map(move |x| (x, y)))
}

/// Hears nothing of an overlap test.
struct Deaf;

impl Hears for Deaf {
    fn reaches(&mut self, _: Step) {}
    fn reads(&mut self, _: MapRead) {}
}

/// What is remembered of a frame.
#[derive(Default)]
struct Watch {
    counted: Counted,
    hidden: Vec<NodeId>,
    presumed: Vec<NodeId>,
    kept: Vec<NodeId>,
    /// Primitives of occluders that are known to be hidden.
    alone: Vec<PrimId>,
    /// Of the culled ones those that lie within what the occluders cover.
    within: Vec<NodeId>,
    /// Nodes that were drawn into the maps.
    covered: Vec<NodeId>,
    /// Rectangles of what was culled without proof.
    guessed: Vec<PixelRect>,
}

impl<S: Faces> Observer<Evidence<S>> for Watch {
    fn event(&mut self, event: Event) {
        match event {
            Event::DecidedNode(node, Verdict::Hidden) => self.hidden.push(node),
            Event::DecidedNode(node, Verdict::Presumed) => self.presumed.push(node),
            Event::DecidedNode(node, Verdict::Visible) => self.kept.push(node),
            Event::DecidedPrim(prim, Verdict::Hidden) => self.alone.push(prim),
            _ => {}
        }
    }
    fn note(&mut self, note: impl FnOnce() -> Evidence<S>) {
        match note() {
            Evidence::Chosen(choice) if choice.is_taken => {
                self.counted.occluders += choice.candidate.polygons as usize;
            }
            Evidence::Covered(cover) => self.covered.push(cover.node),
            Evidence::Compared(_) => self.counted.depth_tests += 1,
            Evidence::Read(..) => self.counted.map_reads += 1,
            Evidence::Answered(answer) => {
                if matches!(answer.ground, Ground::Overlap(_)) {
                    self.counted.overlap_tests += 1;
                    self.within.extend(answer.is_culled.then_some(answer.node));
                }
                if answer.is_culled && !answer.is_proven {
                    self.guessed.push(answer.pixels);
                }
            }
            Evidence::Paused(_) => self.counted.is_on = false,
            _ => {}
        }
    }
}
