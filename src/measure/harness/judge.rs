//! The judge: the exact answer to a view by item buffer, and how other answers differ from it. A pixel is
//! wrong if its shown bytes differ from those of the exact image.

use std::sync::Arc;

use super::ready::checkpoint;
use crate::geometry::{PrimId, View};
use crate::measure::experiment::{ExperimentError, Setup, World};
use crate::measure::table::Cell;
use crate::raster::{Options, Target, shade};
use crate::scene::{Progress, Scene, Surfaces};
use crate::truth::{Truth, missing};

/// What long work says it does while answers are compared.
pub const CHECKING: &str = "comparing with the truth";
/// What the images have behind the scene, linear.
const BACKGROUND: [f32; 3] = [1.0; 3];

/// The exact answer to the view that it looked at last.
pub struct Judge<S: World> {
    scene: Arc<Scene<S>>,
    /// Every how many views [`Judge::each`] compares; 0: never.
    every: usize,
    truth: Truth,
    surfaces: Surfaces,
    view: Option<View<S>>,
    visible: Vec<PrimId>,
    /// The exact image as shown; empty until it is compared with.
    exact: Vec<u8>,
    target: Target,
}

/// How an answer differs from the exact one.
pub struct Difference {
    /// Visible primitives that were drawn.
    pub found: usize,
    /// The same as a share of the visible ones, per cent: ε of Klosowski and Silva 2000, Section 3.
    pub coverage_percent: f64,
    /// Of each pixel, whether it is wrong.
    pub wrong: Vec<bool>,
}

impl Difference {
    /// Wrong pixels, per cent of the image.
    pub fn wrong_percent(&self) -> f64 {
        100.0 * self.wrong.iter().filter(|w| **w).count() as f64 / self.wrong.len().max(1) as f64
    }
}

/// Triangles missed, and views whose answers were compared with the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checked {
    /// Triangles missed.
    pub missed: usize,
    /// Views compared.
    pub views: usize,
}

impl Checked {
    /// Adds what was found at other views.
    pub fn join(&mut self, other: Self) {
        self.missed += other.missed;
        self.views += other.views;
    }
    /// Under the columns `MISSED` and `CHECKED`.
    pub fn cells(self) -> [Cell; 2] {
        [self.missed.into(), self.views.into()]
    }
}

impl<S: World> Judge<S> {
    /// Of a scene, whose surfaces are taken as the experiment's settings say.
    pub fn new(scene: &Arc<Scene<S>>, setup: &Setup) -> Self {
        let surfaces = setup.settings.surfaces();
        Self {
            scene: scene.clone(),
            surfaces,
            every: setup.check_every,
            truth: Truth::new(scene, surfaces, 1, BACKGROUND),
            view: None,
            visible: Vec::new(),
            exact: Vec::new(),
            target: Target::default(),
        }
    }

    /// Goes over to another frame of the scene.
    pub fn pose(&mut self, scene: &Arc<Scene<S>>) {
        self.scene.clone_from(scene);
    }
    /// Finds what is visible, ascending.
    pub fn look(&mut self, view: &View<S>) -> &[PrimId] {
        self.visible = self.truth.look(&*self.scene, view);
        self.view = Some(*view);
        self.exact.clear();
        &self.visible
    }
    /// What is visible at the view that it looked at last, ascending.
    pub fn visible(&self) -> &[PrimId] {
        &self.visible
    }
    /// The image of the view that it looked at last.
    pub fn image(&self) -> &Target {
        self.truth.image()
    }

    /// How what was drawn differs, for the view that it looked at last.
    pub fn compare(&mut self, drawn: &[PrimId]) -> Difference {
        let missed = missing(&self.visible, drawn, self.scene.prim_count()).len();
        let (all, found) = (self.visible.len(), self.visible.len() - missed);
        let coverage_percent = if all == 0 { 100.0 } else { 100.0 * found as f64 / all as f64 };
        let Some(view) = &self.view else { return Difference { found, coverage_percent, wrong: Vec::new() } };
        if self.exact.is_empty() {
            self.exact = shade(self.truth.image(), &*self.scene, view, BACKGROUND);
        }
        draw(&mut self.target, &self.scene, view, drawn, self.surfaces);
        let image = shade(&self.target, &*self.scene, view, BACKGROUND);
        let wrong = self.exact.chunks_exact(4).zip(image.chunks_exact(4)).map(|(a, b)| a != b).collect();
        Difference { found, coverage_percent, wrong }
    }

    /// Compares the answer to view number `i` with the truth, if it is the turn of that.
    pub fn check(&mut self, i: usize, view: &View<S>, drawn: &[PrimId]) -> Checked {
        if self.every == 0 || !i.is_multiple_of(self.every) {
            return Checked::default();
        }
        self.look(view);
        Checked { missed: missing(&self.visible, drawn, self.scene.prim_count()).len(), views: 1 }
    }
    /// Asks for the answer to each view, which is `what` is done, and compares some of them with the truth.
    ///
    /// # Errors
    /// It was cancelled.
    pub fn each(
        &mut self,
        views: &[View<S>],
        progress: &dyn Progress,
        what: &'static str,
        mut answer: impl FnMut(&View<S>) -> Vec<PrimId>,
    ) -> Result<Checked, ExperimentError> {
        let mut checked = Checked::default();
        for (i, view) in views.iter().enumerate() {
            checkpoint(progress, i as f32 / views.len() as f32, what)?;
            let drawn = answer(view);
            checked.join(self.check(i, view, &drawn));
        }
        Ok(checked)
    }
}

/// Draws, on one thread, primitives that are known to face the eye where that matters.
pub fn draw<S: World>(
    target: &mut Target,
    scene: &Scene<S>,
    view: &View<S>,
    prims: &[PrimId],
    surfaces: Surfaces,
) {
    let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
    S::redraw(target, scene, view, prims, &options);
}
