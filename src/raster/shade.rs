//! A color image of an item image: flat-shaded, one color a primitive; and of color cubes over it.
//!
//! See-through primitives are laid over it. How much of what is behind shows through one is not asked: files
//! say it by textures as often as by numbers. Each takes [`VEIL`] of a pixel, and their colors are averaged,
//! so that their order does not matter (Bavoil and Myers 2008, "Order Independent Transparency with Dual
//! Depth Peeling", Section 4: weighted average).

use super::blend::draw_in_order;
use super::{Canvas, Drawable, Options, StandIn, Target, linear, look_through, srgb_bytes};
use crate::geometry::{PrimId, Space, Vector, View};
use crate::scene::Scene;

/// Share of a material's color that faces seen edge-on keep; the rest grows with the cosine.
const AMBIENT: f32 = 0.35;

/// Share of a pixel that one see-through primitive covers.
pub const VEIL: f32 = 0.4;

/// Where the light comes from. Brightness is `0.35 + 0.65 |cos|` of the angle between a primitive's normal
/// and the direction to it, both sides alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Light {
    /// From the eye: what faces it is bright.
    #[default]
    Headlight,
    /// From above and aside, the same from wherever it is seen: what is to be kept in a color has to be lit
    /// so.
    Fixed,
}

/// Direction to the fixed light, of unit length: for each space the first axes.
const FIXED: [[f32; 3]; 2] = [[0.6, 0.8, 0.0], [0.36, 0.8, 0.48]];

/// Brightness of a primitive under the fixed light.
pub fn fixed_light<S: Space>(scene: &Scene<S>, prim: PrimId) -> f32 {
    brightness(scene.normal(prim), S::Vector::from_fn(|a| FIXED[S::Vector::AXES - 2][a]))
}

/// Brightness of a face with this normal in light from there.
fn brightness<V: Vector>(normal: V, toward: V) -> f32 {
    let lengths = normal.length() * toward.length();
    // A primitive without area, or one at the eye, counts as facing it.
    let cosine = if lengths > 0.0 { (normal.dot(toward) / lengths).abs().min(1.0) } else { 1.0 };
    AMBIENT + (1.0 - AMBIENT) * cosine
}

impl Light {
    /// Brightness of a primitive.
    fn on<S: Space>(self, scene: &Scene<S>, view: &View<S>, prim: PrimId) -> f32 {
        match self {
            Self::Headlight => headlight(scene, view, prim),
            Self::Fixed => fixed_light(scene, prim),
        }
    }
    /// The linear color of a primitive under it, as an image shows it.
    pub fn color<S: Space>(self, scene: &Scene<S>, view: &View<S>, prim: PrimId) -> [f32; 3] {
        let brightness = self.on(scene, view, prim);
        scene.color_of(prim).map(|c| c * brightness)
    }
}

/// The image of what was drawn and, over it, what a canvas holds (nothing, if that is of no size). RGBA,
/// sRGB-encoded, row by row; with an empty canvas, under a headlight, the same as [`shade`].
pub fn paint<S: Drawable>(
    image: &Target,
    canvas: &Canvas,
    scene: &Scene<S>,
    view: &View<S>,
    (light, background): (Light, [f32; 3]),
) -> Vec<u8> {
    let mut pixels = shade_lit(image, scene, view, (light, background), |prim| scene.color_of(prim));
    for (pixel, [r, g, b, left]) in pixels.chunks_exact_mut(4).zip(canvas.samples()) {
        if left < 1.0 {
            let behind = [pixel[0], pixel[1], pixel[2]].map(linear);
            let mixed = std::array::from_fn(|c| [r, g, b][c] + left * behind[c]);
            pixel.copy_from_slice(&srgb_bytes(mixed));
        }
    }
    pixels
}

/// The image whose pixels are the means, in linear light, of `across` × `down` pixels each of an image so
/// wide; both RGBA, sRGB-encoded, row by row.
pub fn averaged(rgba: &[u8], width: usize, [across, down]: [usize; 2]) -> Vec<u8> {
    let share = 1.0 / (across * down) as f32;
    let lights: Vec<f32> = (0..=255).map(|byte| linear(byte) * share).collect();
    let mut pixels = Vec::with_capacity(rgba.len() / (across * down));
    for rows in rgba.chunks_exact(4 * width * down) {
        for column in 0..width / across {
            let mut sum = [0.0; 3];
            for row in rows.chunks_exact(4 * width) {
                for sample in row[4 * across * column..][..4 * across].chunks_exact(4) {
                    (0..3).for_each(|c| sum[c] += lights[usize::from(sample[c])]);
                }
            }
            pixels.extend_from_slice(&srgb_bytes(sum));
        }
    }
    pixels
}

/// The image of primitives and boxes in the order of a list, the farthest first; see `draw_in_order`. RGBA,
/// sRGB-encoded, row by row.
pub fn paint_in_order<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    list: (&[PrimId], &[StandIn<S::Vector>]),
    (light, background): (Light, [f32; 3]),
) -> Vec<u8> {
    let color = |prim| light.color(scene, view, prim);
    draw_in_order(scene, view, list, background, color).into_iter().flat_map(srgb_bytes).collect()
}

/// The image in the scene's own colors under a light at the eye: material color times `0.35 + 0.65 |cos|` of
/// the angle between the face's normal and the direction to the eye, both sides alike. `background` (linear)
/// fills the rest. RGBA, sRGB-encoded, row by row.
pub fn shade<S: Drawable>(
    target: &Target,
    scene: &Scene<S>,
    view: &View<S>,
    background: [f32; 3],
) -> Vec<u8> {
    shade_with(target, scene, view, background, |prim| scene.color_of(prim))
}

/// The same with a color (linear 0..1) chosen for each primitive, such as by its state.
pub fn shade_with<S: Drawable>(
    target: &Target,
    scene: &Scene<S>,
    view: &View<S>,
    background: [f32; 3],
    color: impl FnMut(PrimId) -> [f32; 3],
) -> Vec<u8> {
    shade_lit(target, scene, view, (Light::Headlight, background), color)
}

fn shade_lit<S: Drawable>(
    target: &Target,
    scene: &Scene<S>,
    view: &View<S>,
    (light, background): (Light, [f32; 3]),
    mut color: impl FnMut(PrimId) -> [f32; 3],
) -> Vec<u8> {
    let mut lit = |prim: PrimId| {
        let light = light.on(scene, view, prim);
        color(prim).map(|c| c * light)
    };
    let empty = srgb_bytes(background);
    // Each primitive is shaded once; alpha 0 marks those not met yet.
    let mut palette = vec![[0u8; 4]; scene.prim_count()];
    let mut pixels = Vec::with_capacity(target.item.len() * 4);
    for &item in &target.item {
        if item == Target::NONE {
            pixels.extend_from_slice(&empty);
            continue;
        }
        let entry = &mut palette[item as usize];
        if entry[3] == 0 {
            *entry = srgb_bytes(lit(PrimId(item)));
        }
        pixels.extend_from_slice(entry);
    }
    for (at, veil) in veils(target, scene, view, &mut lit) {
        let item = target.item[at];
        let behind = if item == Target::NONE { background } else { lit(PrimId(item)) };
        pixels[4 * at..4 * at + 4].copy_from_slice(&srgb_bytes(veil.over(behind)));
    }
    pixels
}

/// The see-through primitives of a pixel: how many, and the sum of their linear colors in steps, whole
/// numbers so that the order of adding leaves no trace.
#[derive(Clone, Copy, Default)]
pub(crate) struct Veil {
    layers: u32,
    color: [u64; 3],
}

impl Veil {
    /// Lays a primitive of this linear color over the pixel.
    pub(crate) fn add(&mut self, color: [f32; 3]) {
        self.layers += 1;
        for (sum, c) in self.color.iter_mut().zip(color) {
            *sum += (c.clamp(0.0, 1.0) * STEPS) as u64;
        }
    }
    /// What is seen of this linear color through them.
    pub(crate) fn over(self, behind: [f32; 3]) -> [f32; 3] {
        if self.layers == 0 {
            return behind;
        }
        let through = (1.0 - VEIL).powi(self.layers as i32);
        let mean = self.color.map(|sum| sum as f32 / (STEPS * self.layers as f32));
        std::array::from_fn(|c| behind[c] * through + mean[c] * (1.0 - through))
    }
}

/// Steps of a linear color from 0 to 1.
const STEPS: f32 = 65_536.0;

/// Pixels before which see-through primitives were drawn, with these.
fn veils<S: Drawable>(
    target: &Target,
    scene: &Scene<S>,
    view: &View<S>,
    lit: &mut impl FnMut(PrimId) -> [f32; 3],
) -> Vec<(usize, Veil)> {
    // What was drawn several times, since clipping cut it up, is one layer.
    let mut prims = target.through.clone();
    prims.sort_unstable();
    prims.dedup();
    let mut veils = vec![Veil::default(); if prims.is_empty() { 0 } else { target.item.len() }];
    let mut last: Option<(PrimId, [f32; 3])> = None;
    look_through(target, scene, view, &prims, &Options::default(), |prim, at, _| {
        let (_, color) = match &mut last {
            Some(known) if known.0 == prim => *known,
            other => *other.insert((prim, lit(prim))),
        };
        veils[at].add(color);
    });
    veils.into_iter().enumerate().filter(|(_, veil)| veil.layers > 0).collect()
}

/// Brightness of a face under a light at the eye.
fn headlight<S: Space>(scene: &Scene<S>, view: &View<S>, prim: PrimId) -> f32 {
    // One direction a primitive, that from its middle: flat shading needs no more.
    let middle =
        scene.prim_points(prim).fold(S::Vector::default(), |sum, p| sum + p) * (1.0 / S::CORNERS as f32);
    brightness(scene.normal(prim), view.eye.position - middle)
}

/// How depths become gray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum DepthScale {
    /// By the logarithm of the view depth.
    #[default]
    Logarithmic,
    /// By the view depth.
    Linear,
    /// By rank: as many pixels of every gray.
    Equalized,
}

impl DepthScale {
    /// Every scale, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Logarithmic, Self::Linear, Self::Equalized];
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Logarithmic => "logarithmic",
            Self::Linear => "linear",
            Self::Equalized => "equalized",
        }
    }
}

/// A gray picture of depths (`1/w`): near is dark, far is light, on the scale of the depths that occur in
/// `all`; `empty`, where nothing was drawn, is white. RGBA.
pub fn shade_depth(depths: &[f32], all: &[f32], empty: f32, scale: DepthScale) -> Vec<u8> {
    let drawn = all.iter().copied().filter(|d| *d > empty);
    let (nearest, farthest) = drawn.clone().fold((0f32, f32::INFINITY), |(n, f), d| (n.max(d), f.min(d)));
    // Sorted from near to far.
    let mut ranks: Vec<f32> = if scale == DepthScale::Equalized { drawn.collect() } else { vec![] };
    ranks.sort_by(|a, b| b.total_cmp(a));
    let share = |d: f32| match scale {
        DepthScale::Logarithmic => (nearest / d).ln() / (nearest / farthest).ln(),
        DepthScale::Linear => (1.0 / d - 1.0 / nearest) / (1.0 / farthest - 1.0 / nearest),
        DepthScale::Equalized => ranks.partition_point(|r| *r > d) as f32 / ranks.len() as f32,
    };
    // The lightest gray stays apart from white.
    let gray = |d: f32| {
        if d <= empty {
            255
        } else {
            // Where all depths are equal, the scale has no length and the share is not a number.
            (20.0 + 205.0 * Some(share(d)).filter(|s| s.is_finite()).unwrap_or(0.0).clamp(0.0, 1.0)) as u8
        }
    };
    depths.iter().map(|&d| gray(d)).flat_map(|g| [g, g, g, 255]).collect()
}

#[cfg(test)]
mod tests {
    use super::averaged;

    /// Black and white halves are half the light, 188 of 255 encoded; three of four quarters are 225.
    #[test]
    fn pixels_are_averaged_in_linear_light() {
        let row = |bytes: [u8; 6]| bytes.map(|b| [b, b, b, 255]).concat();
        let image = [row([0, 255, 0, 255, 7, 7]), row([255, 0, 255, 255, 7, 7])].concat();
        let small: Vec<_> = averaged(&image, 6, [2, 2]).chunks(4).map(|p| (p[0], p[2], p[3])).collect();
        assert_eq!(small, [(188, 188, 255), (225, 225, 255), (7, 7, 255)]);
        // Flatland's rows are one.
        assert_eq!(averaged(&image[..24], 6, [3, 1]).iter().step_by(4).collect::<Vec<_>>(), [&156, &156]);
    }
}
