//! What a method draws that stands something for primitives, seen through the Eye: in its own colors, since
//! verdicts about primitives tell nothing of what is seen.

use super::stage::Stage;
use crate::drawing::Pixels;
use crate::geometry::{Flat, View};
use crate::method::{DrawList, Film, surfaces_of};
use crate::raster::{self, Canvas, Drawable, Options, StandIn, Target};
use crate::truth::{Judgement, Truth};

/// Compares what a film's run drew with all of its scene.
pub(super) fn judge<S: Drawable>(film: &dyn Film<S>, list: &DrawList<S>) -> Judgement {
    let (scene, view, surfaces) = (film.scene(), film.view(), surfaces_of(film.knobs()));
    // What turns away is not in the list.
    let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
    let (mut image, mut canvas) = (Target::default(), Canvas::default());
    list.draw((&mut image, &mut canvas), scene, view, &options);
    Truth::new(scene, surfaces, 1, [1.0; 3]).judge(scene, view, list, (&image, &canvas))
}

impl<S: Drawable> Stage<S> {
    /// What has been drawn up to a step, of a method that stands something for primitives; `None` of others,
    /// and without a film.
    pub fn drawn(&self, step: usize) -> Option<DrawList<S>> {
        let mut list = self.recorded.as_ref()?.film.drawn(step)?;
        list.prims.retain(|&prim| self.shows(prim));
        Some(list)
    }
    /// The image of such a list from where the film's Eye is, over a background (linear).
    pub fn painted(&self, list: &DrawList<S>, background: [f32; 3]) -> Option<Pixels> {
        let film = &self.recorded.as_ref()?.film;
        // What turns away is not in the list.
        let surfaces = surfaces_of(film.knobs()).both_sides();
        let options = Options { surfaces, ..Options::default() };
        let (scene, view) = (film.scene(), film.view());
        let rgba = list.paint(scene, view, &options, background).into();
        Some(Pixels { width: view.width, height: view.height, rgba })
    }
}

impl Stage<Flat> {
    /// How far the nearest is that each column of such a list's image shows; `None` where there is nothing.
    pub fn nearest_drawn(&self, list: &DrawList<Flat>) -> Vec<Option<f32>> {
        let Some(film) = self.recorded.as_ref().map(|r| &r.film) else { return Vec::new() };
        let (scene, view) = (film.scene(), film.view());
        let image = raster::render(&**scene, view, &list.prims);
        let depth = |(item, depth): (&u32, &f32)| (*item != Target::NONE).then_some(1.0 / depth);
        let mut nearest: Vec<Option<f32>> = image.item.iter().zip(&image.depth).map(depth).collect();
        for one in &list.stand_ins {
            let Some((columns, depth)) = extent(one, view) else { continue };
            for there in &mut nearest[columns] {
                *there = Some(there.map_or(depth, |before| before.min(depth)));
            }
        }
        nearest
    }
}

/// The columns that a box of flatland takes up, at least one, and how far its middle is; `None` if it is not
/// wholly before the eye.
fn extent(one: &StandIn<glam::Vec2>, view: &View<Flat>) -> Option<(std::ops::Range<usize>, f32)> {
    let projection = view.projection();
    let clip = one.bounds.corners().map(|p| projection.clip(p));
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for corner in clip {
        if corner.y < view.eye.near {
            return None;
        }
        let at = (corner.x / corner.y * 0.5 + 0.5) * view.width as f32;
        (low, high) = (low.min(at), high.max(at));
    }
    let width = view.width as usize;
    let columns = (low.max(0.0) as usize)..(high.max(0.0).ceil() as usize).min(width);
    (columns.start < columns.end).then(|| (columns, projection.clip(one.bounds.center()).y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::Methods;
    use crate::method::Settings;
    use crate::scene::{Quiet, example};
    use crate::trace::{Moves, Stamps};
    use std::sync::Arc;

    /// A stage with the whole film of a frame.
    fn stage(method: &str, pairs: &[(&str, &str)]) -> (Stage<Flat>, DrawList<Flat>) {
        let scene = example("tree").expect("an example");
        let entry = Flat::method(method).expect("a method");
        let run = entry.ready(&scene, &Settings::of(pairs), &Quiet).expect("settings that exist");
        let mut stage = Stage::new(scene, None, 1);
        stage.view.width = 96;
        let recording = run.expect("not cancelled").record(&stage.view, usize::MAX);
        let film = recording.film;
        let (stamps, moves) = (Arc::new(Stamps::new(&*film)), Arc::new(Moves::new(film.events())));
        let truth = Arc::new(judge(&*film, &recording.list));
        stage.recorded = Some(super::super::Recorded { film, stamps, moves, serial: 1, layers: None, truth });
        (stage, recording.list)
    }

    /// The picture of the last step is that of the run itself, whichever the order of drawing.
    #[test]
    fn the_eye_sees_what_the_run_drew() {
        let mut images = Vec::new();
        for order in ["exact", "paper"] {
            let (stage, list) = stage("color-cubes", &[("pixel-threshold", "8"), ("order", order)]);
            let recorded = stage.recorded.as_ref().expect("a film");
            let (view, end) = (recorded.film.view(), recorded.film.events().len());
            let drawn = stage.drawn(end).expect("cubes");
            assert!(drawn.stand_ins.len() > 5 && drawn.stand_ins.len() == list.stand_ins.len());
            let want = list.paint(recorded.film.scene(), view, &Options::default(), [1.0; 3]);
            let shown = stage.painted(&drawn, [1.0; 3]).expect("an image").rgba;
            assert_eq!(&*shown, want, "{order}");
            // Before the first cube there is nothing.
            let none = stage.painted(&stage.drawn(0).expect("a list"), [1.0; 3]).expect("an image").rgba;
            assert!(none.iter().all(|byte| *byte == 255));
            // Where something is seen it has a distance.
            let nearest = stage.nearest_drawn(&drawn);
            let is_seen = |at: usize| shown[4 * at..4 * at + 3] != [255; 3];
            assert!((0..nearest.len()).all(|at| !is_seen(at) || nearest[at].is_some()));
            assert!((0..nearest.len()).any(is_seen) && nearest.contains(&None));
            images.push(shown);
        }
    }

    #[test]
    fn of_methods_that_draw_primitives_alone_verdicts_tell() {
        let (stage, _) = stage("frustum", &[]);
        assert!(stage.drawn(1_000_000).is_none());
    }
}
