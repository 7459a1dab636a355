//! The image that many samples a pixel give, and how far another is from it.
//!
//! Whether a primitive shows is a matter of the pixels' centers; what an image should look like is not. The
//! reference is the mean of all samples of a pixel (a box filter) in linear light, encoded as sRGB last. It
//! is drawn some rows of pixels at a time, so that memory does not grow with the number of samples. Cost:
//! O(primitives · bands + samples).

use super::{Flip, Truth, flip, seen_from};
use crate::geometry::{PixelRect, PrimId, View};
use crate::raster::{Drawable, Light, Options, Target, Veil, srgb_bytes};
use crate::scene::Scene;

/// Samples that are kept at a time: 32 MB of depths and items.
const BAND_SAMPLES: usize = if cfg!(test) { 1 << 11 } else { 1 << 22 };

/// The image of a scene by many samples a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// RGBA, sRGB, row by row.
    pub rgba: Vec<u8>,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels; 1 in flatland.
    pub height: u32,
    /// Samples of a pixel across and down; in flatland across alone. Fewer than were asked for where an image
    /// of all samples would be wider or higher than [`crate::geometry::MAX_SIDE_PX`].
    pub samples: u32,
}

impl Reference {
    /// How far an image of the same size is from it; exactly 0 where they are equal.
    pub fn judge(&self, rgba: &[u8]) -> Flip {
        flip(&self.rgba, rgba, self.width as usize, self.height as usize)
    }
}

impl Truth {
    /// The image of the whole scene with `samples` × `samples` samples a pixel (in flatland `samples`), at
    /// least one: box filter in linear light, then sRGB.
    pub fn reference<S: Drawable>(
        &mut self,
        scene: &Scene<S>,
        view: &View<S>,
        samples: u32,
        light: Light,
    ) -> Reference {
        let fine = view.sampled(samples);
        let [samples, down] = [fine.width / view.width, fine.height / view.height];
        let prims = seen_from(&self.prims, &mut self.facing, self.surfaces, scene, view);
        let rows = (BAND_SAMPLES / (fine.width * down).max(1) as usize).max(1);
        let mut band = Band { target: Target::default(), first: 0, veils: Vec::new() };
        let mut rgba = Vec::with_capacity(4 * view.width as usize * view.height as usize);
        for first in (0..view.height).step_by(rows) {
            let height = (view.height - first).min(rows as u32) * down;
            band.first = first * down;
            band.target.clear_rows(&fine, height);
            S::draw_rows(&mut band.target, scene, &fine, prims, band.first, &self.options);
            band.look_through(scene, &fine, &self.options, light);
            // The light falls as it does in an image of one sample: it does not depend on the size.
            band.resolve([samples, down], self.background, |prim| light.color(scene, view, prim), &mut rgba);
        }
        Reference { rgba, width: view.width, height: view.height, samples }
    }
}

/// Some rows of samples.
struct Band {
    target: Target,
    /// Row of the image of all samples with which it begins.
    first: u32,
    /// What is seen through at each sample; empty if nothing is anywhere.
    veils: Vec<Veil>,
}

impl Band {
    /// Finds the see-through primitives before each sample.
    fn look_through<S: Drawable>(
        &mut self,
        scene: &Scene<S>,
        fine: &View<S>,
        options: &Options,
        light: Light,
    ) {
        self.veils.clear();
        if self.target.through.is_empty() {
            return;
        }
        self.veils.resize(self.target.item.len(), Veil::default());
        // What clipping cut up was drawn more than once.
        let mut prims = std::mem::take(&mut self.target.through);
        prims.sort_unstable();
        prims.dedup();
        let rows = PixelRect { x0: 0, x1: fine.width, y0: self.first, y1: self.first + self.target.height };
        let options = Options { window: Some(rows), ..*options };
        let before = self.first as usize * fine.width as usize;
        for prim in prims {
            let color = light.color(scene, fine, prim);
            S::fragments(scene, fine, prim, &options, &mut |at, depth| {
                let at = at - before;
                if depth >= self.target.depth[at] {
                    self.veils[at].add(color);
                }
            });
        }
    }

    /// Adds the pixels to an image: the mean of `across` × `down` samples each.
    fn resolve(
        &self,
        [across, down]: [u32; 2],
        background: [f32; 3],
        color: impl Fn(PrimId) -> [f32; 3],
        rgba: &mut Vec<u8>,
    ) {
        let width = self.target.width as usize;
        let share = 1.0 / f64::from(across * down);
        // Samples side by side mostly show the same.
        let mut last = (Target::NONE, background);
        let mut sums = vec![[0.0f64; 3]; width / across as usize];
        for row in 0..self.target.height as usize {
            for x in 0..width {
                let at = row * width + x;
                let item = self.target.item[at];
                if item != last.0 {
                    last = (item, if item == Target::NONE { background } else { color(PrimId(item)) });
                }
                let seen = self.veils.get(at).map_or(last.1, |veil| veil.over(last.1));
                let sum = &mut sums[x / across as usize];
                (0..3).for_each(|c| sum[c] += f64::from(seen[c]));
            }
            if (row + 1) % down as usize == 0 {
                for sum in &mut sums {
                    rgba.extend_from_slice(&srgb_bytes(sum.map(|s| (s * share) as f32)));
                    *sum = [0.0; 3];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::geometry::{Eye, Flat, Solid};
    use crate::raster::{render, shade};
    use crate::scene::{Material, Parts, Surfaces};

    fn truth<S: Drawable>(scene: &Scene<S>, background: [f32; 3]) -> Truth {
        Truth::new(scene, Surfaces::default(), 1, background)
    }

    /// Looks along −z through so small an angle that the light falls straight on what stands across.
    fn view(width: u32, height: u32) -> View<Solid> {
        let eye =
            Eye { position: Vec3::ZERO, target: -Vec3::Z, up: Vec3::Y, fov: 0.01, near: 0.1, far: 10.0 };
        View { eye, width, height }
    }

    /// A rectangle at depth 1 from `x` to `y`, both in halves of the image's height.
    fn plate(color: [f32; 3], see_through: bool, x: [f32; 2], y: [f32; 2]) -> Scene<Solid> {
        let half = 0.005f32.tan();
        let at = |x: f32, y: f32| Vec3::new(x * half, y * half, -1.0);
        let corners = vec![at(x[0], y[0]), at(x[1], y[0]), at(x[1], y[1]), at(x[0], y[1])];
        let mut parts = Parts::<Solid>::simple("plate", corners, vec![[0, 1, 2], [0, 2, 3]]);
        parts.materials[0] = Material { see_through, ..Material::new("plate", color) };
        Scene::new(parts).expect("a plate")
    }

    /// White on half a pixel before black: linear 0.5, which sRGB encodes as 188 (a mean of encoded values
    /// would be 128); on a quarter: 0.25, 137. A quarter of red: only that channel.
    #[test]
    fn a_pixel_has_the_mean_of_its_samples_in_linear_light() {
        let seen = |scene: &Scene<Solid>, samples| {
            truth(scene, [0.0; 3]).reference(scene, &view(1, 1), samples, Light::Headlight).rgba
        };
        let half = plate([1.0; 3], false, [-1.0, 0.0], [-1.0, 1.0]);
        assert_eq!(seen(&half, 16), [188, 188, 188, 255]);
        // Two samples across: one of them.
        assert_eq!(seen(&half, 2), [188, 188, 188, 255]);
        let quarter = plate([1.0; 3], false, [0.0, 1.0], [0.0, 1.0]);
        assert_eq!(seen(&quarter, 16), [137, 137, 137, 255]);
        let red = plate([1.0, 0.0, 0.0], false, [0.0, 1.0], [-1.0, 0.0]);
        assert_eq!(seen(&red, 16), [137, 0, 0, 255]);
        // One sample across and three down of 256: 3/256 is 28.
        let corner = plate([1.0; 3], false, [-1.0, -1.0 + 2.0 / 16.0], [-1.0, -1.0 + 6.0 / 16.0]);
        assert_eq!(seen(&corner, 16), [28, 28, 28, 255]);
    }

    /// A see-through primitive takes 0.4 of what it covers ([`crate::raster::shade`]): white on half a pixel
    /// gives 0.2, which is 124.
    #[test]
    fn what_is_seen_through_takes_its_share() {
        let glass = plate([1.0; 3], true, [-1.0, 0.0], [-1.0, 1.0]);
        let reference = truth(&glass, [0.0; 3]).reference(&glass, &view(1, 1), 16, Light::Headlight);
        assert_eq!(reference.rgba, [124, 124, 124, 255]);
    }

    /// A segment across half of the only pixel of a line.
    #[test]
    fn flatland_has_samples_across_alone() {
        let half = 0.005f32.tan();
        let points = vec![Vec2::new(0.0, 1.0), Vec2::new(half, 1.0)];
        let mut parts = Parts::<Flat>::simple("segment", points, vec![[0, 1]]);
        parts.materials[0] = Material::new("white", [1.0; 3]);
        let scene = Scene::new(parts).expect("a segment");
        let (position, up) = (Vec2::ZERO, Vec2::ZERO);
        let eye = Eye { position, target: Vec2::Y, up, fov: 0.01, near: 0.1, far: 10.0 };
        let view = View { eye, width: 1, height: 1 };
        let reference = truth(&scene, [0.0; 3]).reference(&scene, &view, 16, Light::Headlight);
        assert_eq!((reference.rgba, reference.samples), (vec![188, 188, 188, 255], 16));
    }

    /// Whatever the bands, each pixel is the mean of its samples of one large image.
    #[test]
    fn bands_leave_no_trace() {
        let scene = crate::scene::samples::soup::<Solid>(7, 300);
        let view = crate::scene::framing_view::<Solid>(&scene.bounds(), 37, 29);
        let background = [0.3, 0.4, 0.5];
        let mut truth = truth(&scene, background);
        let samples = 5;
        assert!(BAND_SAMPLES < (37 * 29 * samples * samples) as usize / 4, "several bands");
        let reference = truth.reference(&scene, &view, samples, Light::Headlight);
        let fine = View { width: 37 * samples, height: 29 * samples, ..view };
        let image = render(&scene, &fine, scene.live());
        let color = |x: u32, y: u32| match image.item[(y * fine.width + x) as usize] {
            Target::NONE => background,
            item => Light::Headlight.color(&scene, &view, PrimId(item)),
        };
        for (at, pixel) in reference.rgba.chunks_exact(4).enumerate() {
            let (x, y) = (at as u32 % 37 * samples, at as u32 / 37 * samples);
            let mut sum = [0.0f64; 3];
            for k in 0..samples * samples {
                let sample = color(x + k % samples, y + k / samples);
                (0..3).for_each(|c| sum[c] += f64::from(sample[c]));
            }
            let mean = sum.map(|s| (s / f64::from(samples * samples)) as f32);
            assert_eq!(pixel, srgb_bytes(mean), "pixel {at}");
        }
        // One sample a pixel is the image itself.
        let one = truth.reference(&scene, &view, 1, Light::Headlight);
        let plain = shade(&render(&scene, &view, scene.live()), &scene, &view, background);
        assert_eq!(one.rgba, plain);
        assert_eq!(truth.reference(&scene, &view, 1, Light::Headlight).judge(&plain), Flip::default());
        let far = truth.reference(&scene, &view, samples, Light::Headlight).judge(&plain);
        assert!(far.mean > 0.0 && far.seen_ratio > 0.0 && far.seen_ratio < 1.0, "{far:?}");
    }
}
