//! What is really visible, how wrong an answer is, and an independent checker of certificates.
//!
//! Truth is an item buffer: a primitive is visible if it owns at least one pixel of the whole scene's image
//! at the view's resolution; a see-through one if it covers a pixel that shows nothing nearer. An answer is
//! right if its image is that of the whole scene, byte for byte, see-through primitives that are visible
//! included.
//!
//! So "visible" is said of a resolution, and of a grid: the rasterizer moves corners to 1/256 pixel, as
//! graphics hardware does. Against exact arithmetic on the same centers of pixels that changes 1 pixel in
//! 100,000 of the building that is generated and 7 of the city, nearly all on shared edges; but a primitive
//! that shows in a single pixel may owe it to the grid. Where many are thinner than a pixel
//! (`generate:thin-slabs`) a grid of 1/16 pixel changes 18 % of what is visible.

pub mod certificate;
mod hidden;
mod layering;
mod others;
mod reference;

pub use crate::raster::{Flip, SEEN, flip, flip_mean};
pub use layering::{Unranked, layer_correlation, layering_numbers, layering_numbers_within};
pub use others::{Disagreement, disagreement};
pub use reference::Reference;

use glam::DVec3;

use crate::geometry::{PrimId, Vector, View};
use crate::method::DrawList;
use crate::raster::{Canvas, Drawable, Options, Target, look_through, paint, visible};
use crate::scene::{Scene, Surfaces};

/// The exact answer of views of one scene; keeps its buffers from view to view.
pub struct Truth {
    prims: Vec<PrimId>,
    facing: Vec<PrimId>,
    surfaces: Surfaces,
    options: Options,
    all: Target,
    background: [f32; 3],
}

/// How an answer compares with the exact one.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Primitives that own a pixel of the whole scene's image, or show before what does, ascending.
    pub visible: Vec<PrimId>,
    /// Those of them that were not drawn, ascending.
    pub missed: Vec<PrimId>,
    /// Number of primitives drawn.
    pub drawn: usize,
    /// Pixels of the image.
    pub pixels: usize,
    /// Pixels whose color differs from the image of the whole scene, both in the light of the answer.
    pub wrong_pixels: usize,
    /// Pixels that show another primitive, or it at another depth, or lack a see-through one.
    pub wrong_items: usize,
    /// Mean LDR-FLIP between the two images; exactly 0 if they are equal.
    pub flip_mean: f64,
}

impl Judgement {
    /// Drawn visible primitives / visible primitives; 1 where nothing is visible.
    pub fn coverage_ratio(&self) -> f64 {
        if self.visible.is_empty() {
            1.0
        } else {
            (self.visible.len() - self.missed.len()) as f64 / self.visible.len() as f64
        }
    }
    /// Wrong pixels / pixels.
    pub fn wrong_pixel_ratio(&self) -> f64 {
        self.wrong_pixels as f64 / self.pixels.max(1) as f64
    }
    /// Drawn primitives / visible primitives; `None` where nothing is visible.
    pub fn overdraw(&self) -> Option<f64> {
        (!self.visible.is_empty()).then(|| self.drawn as f64 / self.visible.len() as f64)
    }
    /// Whether nothing is wrong at all.
    pub fn is_exact(&self) -> bool {
        self.missed.is_empty() && self.wrong_pixels == 0 && self.wrong_items == 0
    }
}

impl Truth {
    /// Truth of a scene whose surfaces are taken in some way; drawn by `threads`. Images have a `background`
    /// (linear).
    pub fn new<S: Drawable>(
        scene: &Scene<S>,
        surfaces: Surfaces,
        threads: usize,
        background: [f32; 3],
    ) -> Self {
        // Sides are told by the one rule that methods use, so the rasterizer draws both.
        Self {
            prims: scene.live().to_vec(),
            facing: Vec::new(),
            surfaces,
            options: Options { threads, surfaces: surfaces.both_sides(), ..Options::default() },
            all: Target::default(),
            background,
        }
    }

    /// Draws the whole scene; what is visible, ascending.
    pub fn look<S: Drawable>(&mut self, scene: &Scene<S>, view: &View<S>) -> Vec<PrimId> {
        let prims = seen_from(&self.prims, &mut self.facing, self.surfaces, scene, view);
        S::redraw(&mut self.all, scene, view, prims, &self.options);
        all_visible(&self.all, scene, view, &self.options)
    }
    /// The image that [`Truth::look`] drew last.
    pub fn image(&self) -> &Target {
        &self.all
    }

    /// Compares an answer with the whole scene. `drawn`: the images of its two parts from that view
    /// ([`DrawList::draw`]). Whether a primitive shows is asked at the centers of pixels, whatever the
    /// picture is made of.
    pub fn judge<S: Drawable>(
        &mut self,
        scene: &Scene<S>,
        view: &View<S>,
        list: &DrawList<S>,
        drawn: (&Target, &Canvas),
    ) -> Judgement {
        let visible = self.look(scene, view);
        self.compare(scene, view, visible, list, drawn)
    }
    /// The same of the view that was looked at last, where that was `visible`.
    pub fn compare<S: Drawable>(
        &mut self,
        scene: &Scene<S>,
        view: &View<S>,
        visible: Vec<PrimId>,
        list: &DrawList<S>,
        drawn: (&Target, &Canvas),
    ) -> Judgement {
        let missed = missing(&visible, &list.prims, scene.prim_count());
        let wrong_items = if list.samples == 1 {
            self.wrong_items(scene, view, &missed, drawn.0)
        } else {
            let mut image = Target::default();
            list.redraw(&mut image, scene, view, &self.options);
            self.wrong_items(scene, view, &missed, &image)
        };
        let (mut wrong_pixels, mut flip) = (0, 0.0);
        // Where all pixels show the same at the same depth, so do the pictures, but for what is over them.
        if wrong_items > 0 || list.samples > 1 || !list.stand_ins.is_empty() {
            let reference = self.shown(scene, view, list);
            let test = list.picture(scene, view, drawn, (list.light, self.background));
            wrong_pixels =
                reference.chunks_exact(4).zip(test.chunks_exact(4)).filter(|(a, b)| a != b).count();
            if wrong_pixels > 0 {
                flip = flip_mean(&reference, &test, view.width as usize, view.height as usize);
            }
        }
        let (drawn, pixels) = (list.prims.len(), view.width as usize * view.height as usize);
        Judgement { visible, missed, drawn, pixels, wrong_pixels, wrong_items, flip_mean: flip }
    }
    /// The picture of the whole scene that was looked at last, in the light and samples of an answer.
    fn shown<S: Drawable>(&mut self, scene: &Scene<S>, view: &View<S>, list: &DrawList<S>) -> Vec<u8> {
        if list.samples == 1 {
            return paint(&self.all, &Canvas::default(), scene, view, (list.light, self.background));
        }
        let prims = seen_from(&self.prims, &mut self.facing, self.surfaces, scene, view).to_vec();
        let whole = DrawList { prims, samples: list.samples, light: list.light, ..DrawList::default() };
        whole.paint(scene, view, &self.options, self.background)
    }
    fn wrong_items<S: Drawable>(
        &self,
        scene: &Scene<S>,
        view: &View<S>,
        missed: &[PrimId],
        image: &Target,
    ) -> usize {
        let mut lacking = vec![false; self.all.item.len()];
        look_through(&self.all, scene, view, missed, &self.options, |_, at, _| lacking[at] = true);
        (0..lacking.len()).filter(|&at| lacking[at] || self.all.differs(image, at)).count()
    }
}

/// Those of `prims` that have a side that can be seen from the eye; `facing` is where they are kept.
fn seen_from<'a, S: Drawable>(
    prims: &'a [PrimId],
    facing: &'a mut Vec<PrimId>,
    surfaces: Surfaces,
    scene: &Scene<S>,
    view: &View<S>,
) -> &'a [PrimId] {
    if !surfaces.one_sided {
        return prims;
    }
    let eye = view.eye.position;
    facing.clear();
    facing.extend(prims.iter().copied().filter(|&p| !surfaces.leave_out(scene, p, eye)));
    facing
}

/// The primitives that show in an image, see-through ones among them, ascending.
fn all_visible<S: Drawable>(
    image: &Target,
    scene: &Scene<S>,
    view: &View<S>,
    options: &Options,
) -> Vec<PrimId> {
    let mut seen = visible(image);
    let mut before = seen.len();
    look_through(image, scene, view, &image.through, options, |prim, _, _| {
        // A primitive's pixels come one after the other.
        if seen[before..].last() != Some(&prim) {
            seen.push(prim);
        }
    });
    before = seen.len() - before;
    if before > 0 {
        seen.sort_unstable();
        // What clipping cut up was drawn more than once.
        seen.dedup();
    }
    seen
}

/// Those of the visible primitives of a scene of `prim_count` that were not drawn, in the order of `visible`.
pub fn missing(visible: &[PrimId], drawn: &[PrimId], prim_count: usize) -> Vec<PrimId> {
    let mut kept = vec![false; prim_count];
    drawn.iter().for_each(|p| kept[p.at()] = true);
    visible.iter().copied().filter(|p| !kept[p.at()]).collect()
}

fn widened<V: Vector>(v: V) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|a| if a < V::AXES { f64::from(v.get(a)) } else { 0.0 }))
}
