//! The history of a pixel of the Eye's image: all that would be drawn there if nothing were culled, front to
//! back, as the rasterizer has it at the pixel's center; what became of each, and what the frame shows.

use super::hidden_by::named;
use super::stage::{AtPixel, Stage, Staged};
use super::why::spoken;
use crate::drawing::words::{Room, count, short};
use crate::geometry::{PixelRect, PrimId};
use crate::method::{Verdict, surfaces_of};
use crate::raster::{Drawable, Options};

/// The pixel that is looked into, and what was found there.
#[derive(Clone, Debug, Default)]
pub struct PixelHistory {
    /// Column and row, from the top left.
    at: Option<[u32; 2]>,
    /// The film that it was found in.
    film: Option<u64>,
    layers: Vec<AtPixel>,
}

impl PixelHistory {
    /// The pixel.
    pub fn at(&self) -> Option<[u32; 2]> {
        self.at
    }
    /// What covers it, front to back.
    pub fn layers(&self) -> &[AtPixel] {
        &self.layers
    }
    pub(super) fn look_at(&mut self, at: Option<[u32; 2]>) {
        *self = Self { at, ..Self::default() };
    }
    /// Finds what covers the pixel in the film on stage, if that is not known.
    pub(super) fn refresh(&mut self, stage: Option<&dyn Staged>) {
        let film = stage.and_then(|s| s.film()).map(|film| film.serial);
        if self.at.is_none() || film == self.film {
            return;
        }
        self.film = film;
        self.layers = stage.zip(self.at).map_or(vec![], |(stage, at)| stage.layers_at(at));
    }
    /// What the frame shows at the pixel, and whether that is what an image of everything shows.
    pub fn said(&self, stage: &dyn Staged) -> Option<String> {
        let ([x, y], film, scene) = (self.at?, stage.film()?, stage.scene());
        let verdict = |prim: PrimId| film.stamps.prim_decision(prim).map(|(_, verdict)| verdict);
        let is_drawn = |layer: &&AtPixel| verdict(layer.prim) == Some(Verdict::Visible);
        let n = self.layers.len();
        let (plural, verb) = if n == 1 { ("", "covers") } else { ("s", "cover") };
        let head = format!("Pixel ({x}, {y}): {} {}{plural} {verb} it.", count(n), scene.prim_name());
        let opaque = || self.layers.iter().filter(|layer| !layer.is_through);
        let (first, shown) = (opaque().next(), opaque().find(is_drawn));
        let tail = match (first, shown) {
            (None, _) => "Nothing opaque is to be seen there.".to_owned(),
            (Some(first), Some(shown)) if first == shown => {
                format!("The frame shows the nearest, {}.", named(scene, shown.prim))
            }
            (Some(first), shown) => {
                let instead = shown.map_or("nothing".to_owned(), |layer| named(scene, layer.prim));
                let state = verdict(first.prim).map_or("not decided", spoken);
                format!(
                    "The nearest, {}, is {state}: of {}s the frame shows {instead} there.",
                    named(scene, first.prim),
                    scene.prim_name()
                )
            }
        };
        Some(format!("{head} {tail}"))
    }
}

impl AtPixel {
    /// What it is and how far, such as `triangle 12 of door, 3.21 away`.
    pub fn title(&self, stage: &dyn Staged) -> String {
        let through = if self.is_through { ", see-through" } else { "" };
        format!("{}, {} away{through}", named(stage.scene(), self.prim), short(self.depth, Room::Row))
    }
    /// The step that decided it, the verdict, and in a sentence on what that rests.
    pub fn decision(&self, stage: &dyn Staged) -> Option<(usize, Verdict, String)> {
        let film = stage.film()?;
        let (step, verdict) = film.stamps.prim_decision(self.prim)?;
        let ground = film.reel.evidence_of(step - 1).unwrap_or(step - 1);
        Some((step, verdict, film.reel.sentence(ground)))
    }
}

impl<S: Drawable> Stage<S> {
    /// What covers the center of a pixel of the film's image, front to back.
    pub(super) fn covering(&self, [x, y]: [u32; 2]) -> Vec<AtPixel> {
        let Some(film) = self.recorded.as_ref().map(|r| &r.film) else { return vec![] };
        let (scene, view, surfaces) = (&**film.scene(), film.view(), surfaces_of(film.knobs()));
        if x >= view.width || y >= view.height {
            return vec![];
        }
        let window = Some(PixelRect { x0: x, x1: x + 1, y0: y, y1: y + 1 });
        let options = Options { surfaces: surfaces.both_sides(), window, ..Options::default() };
        let mut found = Vec::new();
        for &prim in scene.live() {
            if surfaces.leave_out(scene, prim, view.eye.position) {
                continue;
            }
            S::fragments(scene, view, prim, &options, &mut |_, depth| {
                if depth >= 1.0 / view.eye.far {
                    found.push((depth, prim));
                }
            });
        }
        // As the z-buffer does: the nearer first, at equal depth the lower id; clipping may leave two parts.
        found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        found.dedup_by_key(|(_, prim)| *prim);
        let layer = |(depth, prim): (f32, PrimId)| {
            let is_through = surfaces.show_through(scene, prim);
            AtPixel { prim, depth: 1.0 / depth, is_through }
        };
        found.into_iter().map(layer).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::command::Command;
    use super::super::state::State;
    use super::super::tests::opened_with as opened;
    use super::*;
    use crate::geometry::{Either, each};
    use crate::raster::{Target, render};
    use crate::scene::failures;

    /// Some pixels of a scene: the nearest opaque thing is what an image of everything shows; how many pixels
    /// were empty and how many had more than one layer.
    fn looked_at(state: &mut State) -> [usize; 2] {
        let image: Target = each!(state.stage.as_ref().expect("a stage"), s => {
            render(&**s.posed(), &s.view, s.scene.live())
        });
        let (mut empty, mut deep) = (0, 0);
        for at in (0..image.item.len()).step_by(image.item.len() / 37 + 1) {
            let pixel = [at as u32 % image.width, at as u32 / image.width];
            state.apply(Command::Pixel(Some(pixel)));
            let (stage, pixel) = (state.staged().expect("a stage"), &state.pixel);
            let layers = pixel.layers();
            assert!(layers.windows(2).all(|w| w[0].depth <= w[1].depth));
            let nearest = layers.iter().find(|layer| !layer.is_through).map(|layer| layer.prim);
            assert_eq!(nearest, Some(PrimId(image.item[at])).filter(|p| p.0 != Target::NONE), "{pixel:?}");
            let said = pixel.said(stage).expect("a sentence");
            match nearest {
                None => empty += usize::from(said.contains("Nothing opaque")),
                Some(prim) => assert!(said.contains(&named(stage.scene(), prim)), "{said}"),
            }
            deep += usize::from(layers.len() > 1);
            for layer in layers {
                let (step, verdict, reason) = layer.decision(stage).expect("decided");
                let film = state.film().expect("a film");
                assert_eq!(film.stamps.prim_decision(layer.prim), Some((step, verdict)));
                assert!(reason.ends_with('.'), "{reason}");
            }
        }
        [empty, deep]
    }

    #[test]
    fn a_pixel_tells_all_that_covers_it() {
        for (source, method) in [
            ("freedoom_e1m1", "large-occluders"),
            ("generate:building?polygons=2000&seed=3", "hierarchical-z"),
            ("scenes2d/shop_window.json", "z-buffer"),
        ] {
            let mut state = opened(source, method);
            assert!(looked_at(&mut state)[1] > 3, "{source}");
        }
        // The list follows the film, and is asked for again by its numbers.
        let mut state = opened("freedoom_e1m1", "frustum");
        state.apply(Command::Pixel(Some([5, 0])));
        let before = state.pixel.layers().to_vec();
        let Some(Either::Flat(mut view)) = state.stage.as_ref().map(|s| s.view()) else { panic!("flatland") };
        view.eye.target = view.eye.position - (view.eye.target - view.eye.position);
        state.apply(Command::Eye(Either::Flat(view), 0));
        state.block_until_idle();
        assert!(state.pixel.at() == Some([5, 0]) && state.pixel.layers() != before);
    }

    /// Where the frame lacks what is nearest, it says what it shows instead.
    #[test]
    fn a_wrong_pixel_says_what_is_missing() {
        let failure = failures().iter().find(|f| f.name == "pixel-holes").expect("a scene");
        let mut state = opened(&failure.source::<crate::geometry::Flat>(), "centroid");
        state.apply(Command::Set("budget".into(), "5%".into(), 0));
        state.block_until_idle();
        let [width, _] = state.staged().and_then(|s| s.image_size()).expect("an image");
        let said: Vec<String> = (0..width)
            .map(|x| {
                state.apply(Command::Pixel(Some([x, 0])));
                state.pixel.said(state.staged().expect("a stage")).expect("a sentence")
            })
            .collect();
        assert!(said.iter().any(|said| said.contains("The nearest, ")), "{said:?}");
        assert!(said.iter().any(|said| said.contains("The frame shows the nearest, ")), "{said:?}");
    }
}
