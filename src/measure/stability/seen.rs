//! A method's answer at a view beside the exact one, and what changes from one view to the next.

use std::sync::Arc;

use crate::geometry::{PrimId, View};
use crate::measure::experiment::World;
use crate::method::{DrawList, Run, surfaces_of};
use crate::raster::{Canvas, Light, Options, Target, paint};
use crate::scene::{Motion, Progress, Scene, Surfaces};
use crate::truth::Truth;

/// What the images have behind the scene, linear.
const BACKGROUND: [f32; 3] = [1.0; 3];
/// Light of the images that are compared from view to view: one at the eye changes all colors at each step.
const LIGHT: Light = Light::Fixed;

/// An answer at a view, and how it differs from the exact one.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Primitives that show at the view's resolution, ascending.
    pub visible: Vec<PrimId>,
    /// Those of them that were not drawn, ascending.
    pub missed: Vec<PrimId>,
    /// Primitives that were drawn.
    pub drawn: usize,
    /// Pixels whose color differs from that of the exact image, as `cullscope cull --truth` counts them; of a
    /// picture with stand-ins, with these in it.
    pub wrong_pixels: usize,
    /// What the method counted of its own work, all counts added up.
    pub work: u64,
    /// The method's picture and the exact one, both under a light that is fixed in the world; RGBA.
    pictures: [Vec<u8>; 2],
}

impl Seen {
    /// Primitives that were drawn and do not show.
    pub fn kept(&self) -> usize {
        self.drawn - (self.visible.len() - self.missed.len())
    }
    /// Pixels of the image.
    pub fn pixels(&self) -> usize {
        self.pictures[0].len() / 4
    }
    /// What changed since another view of the same size.
    pub fn since(&self, before: &Self) -> Change {
        let stayed = before.visible.iter().filter(|p| self.visible.binary_search(p).is_ok());
        let lacks = |seen: &Self, p: &PrimId| seen.missed.binary_search(p).is_ok();
        let popped: Vec<PrimId> = stayed.copied().filter(|p| lacks(self, p) != lacks(before, p)).collect();
        let changed = before.visible.iter().filter(|p| self.visible.binary_search(p).is_err()).count()
            + self.visible.iter().filter(|p| before.visible.binary_search(p).is_err()).count();
        let pairs = |which: usize| {
            let [was, is] = [&before.pictures[which], &self.pictures[which]];
            was.chunks_exact(4).zip(is.chunks_exact(4))
        };
        let differ = |(was, is): (&[u8], &[u8])| was != is;
        let popped_pixels =
            pairs(0).map(differ).zip(pairs(1).map(differ)).filter(|(ours, exact)| *ours && !exact).count();
        Change { changed, popped, popped_pixels }
    }
}

/// What changed from one view to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Primitives that became visible or ceased to be, in the exact answer.
    pub changed: usize,
    /// Primitives that are visible at both views and were drawn at one of them only, ascending.
    pub popped: Vec<PrimId>,
    /// Pixels that differ between the method's pictures and do not between the exact ones.
    pub popped_pixels: usize,
}

/// A run with what it is compared with. Where objects move, it sees the scene of a frame.
pub struct Watcher<'a, S: World> {
    run: &'a mut dyn Run<S>,
    motion: Motion<S>,
    surfaces: Surfaces,
    truth: Truth,
    image: Target,
    canvas: Canvas,
}

impl<'a, S: World> Watcher<'a, S> {
    /// Of a run that was made ready for frame 0 of a scene.
    pub fn new(scene: &Arc<Scene<S>>, run: &'a mut dyn Run<S>) -> Self {
        let surfaces = surfaces_of(&run.knobs());
        let truth = Truth::new(scene, surfaces, 1, BACKGROUND);
        let (image, canvas) = (Target::default(), Canvas::default());
        Self { run, motion: Motion::new(scene), surfaces, truth, image, canvas }
    }
    /// The run, which stands at the frame that was looked at last.
    pub fn run(&mut self) -> &mut dyn Run<S> {
        self.run
    }
    /// Brings the run to a frame; `None` when cancelled.
    pub fn pose(&mut self, frame: usize, progress: &dyn Progress) -> Option<Arc<Scene<S>>> {
        let scene = self.motion.at(frame);
        self.run.pose(&scene, progress).then_some(scene)
    }
    /// What the run answers at a view of a frame, after what it remembers; `None` when cancelled.
    pub fn look(&mut self, frame: usize, view: &View<S>, progress: &dyn Progress) -> Option<Seen> {
        let scene = self.pose(frame, progress)?;
        let (list, tally) = self.run.count(view);
        let options = Options { surfaces: self.surfaces.both_sides(), ..Options::default() };
        list.draw((&mut self.image, &mut self.canvas), &scene, view, &options);
        let picture = list.picture(&scene, view, (&self.image, &self.canvas), (LIGHT, BACKGROUND));
        let judged = self.truth.judge(&scene, view, &list, (&self.image, &self.canvas));
        let exact = self.exact(&scene, view, list.samples, &options);
        Some(Seen {
            drawn: judged.drawn,
            wrong_pixels: judged.wrong_pixels,
            work: tally.named().values().sum(),
            visible: judged.visible,
            missed: judged.missed,
            pictures: [picture, exact],
        })
    }
    /// The exact picture of the view that was judged last.
    fn exact(&mut self, scene: &Scene<S>, view: &View<S>, samples: u32, options: &Options) -> Vec<u8> {
        if samples == 1 {
            return paint(self.truth.image(), &Canvas::default(), scene, view, (LIGHT, BACKGROUND));
        }
        let eye = view.eye.position;
        let there = |p: &PrimId| !self.surfaces.leave_out(scene, *p, eye);
        let prims = scene.live().iter().copied().filter(there).collect();
        let list = DrawList::<S> { prims, samples, ..DrawList::default() };
        list.draw((&mut self.image, &mut self.canvas), scene, view, options);
        list.picture(scene, view, (&self.image, &self.canvas), (LIGHT, BACKGROUND))
    }
}
