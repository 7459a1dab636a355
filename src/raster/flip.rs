//! LDR-FLIP: how different two images look when one flips between them.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild. FLIP: A Difference Evaluator for
//! Alternating Images. Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020, DOI 10.1145/3406183; section
//! numbers below are the paper's. Images are sRGB seen at [`PIXELS_PER_DEGREE`]; pixels beyond the border
//! repeat it. All arithmetic is f64; the authors' program uses f32, and the means of its maps, taken in f64,
//! agree to about 1e-5. The mean that it prints is a sum in f32, which is 1 % off at 1920×1080 and 6 % at
//! 3840×2160. Departure: only the neighborhood of pixels that differ is looked at, since equal neighborhoods
//! give 0. Cost: about 250 operations a pixel of that neighborhood.

use std::f64::consts::PI;

/// The paper's default (Section 3): a 0.7 m wide screen of 3840 pixels, seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 3840.0 * (PI / 180.0);
/// Exponent of the color difference, Section 4.1.
const QC: f64 = 0.7;
/// Share of the largest color difference that is mapped to [`PT`], Section 4.1.
const PC: f64 = 0.4;
/// See [`PC`].
const PT: f64 = 0.95;
/// Width of the feature detectors in degrees, Section 4.2.
const FEATURE_DEGREES: f64 = 0.082;
/// Exponent of the feature difference, Section 4.2.
const QF: f64 = 0.5;

type Rgb = [f64; 3];

/// An image of three channels.
struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

/// A map of FLIP in two numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flip {
    /// Its mean.
    pub mean: f64,
    /// Share of the pixels whose difference is above [`SEEN`].
    pub seen_ratio: f64,
}

/// A difference of FLIP that counts as seen.
pub const SEEN: f64 = 0.1;

/// Mean FLIP of two RGBA images (alpha is ignored) of `width` × `height` pixels: 0 equal, 1 as different as
/// can be. Exactly 0 for equal images.
pub fn flip_mean(reference: &[u8], test: &[u8], width: usize, height: usize) -> f64 {
    flip(reference, test, width, height).mean
}

/// The same, and how many pixels differ so that it is seen.
pub fn flip(reference: &[u8], test: &[u8], width: usize, height: usize) -> Flip {
    let Some((out, map)) = differing(reference, test, width, height) else { return Flip::default() };
    let pixels = (width * height) as f64;
    let seen = map.iter().filter(|d| **d > SEEN).count();
    let rows = map.chunks(out.x1 - out.x0);
    let sum: f64 = rows.map(|row| row.iter().sum::<f64>()).sum();
    Flip { mean: sum / pixels, seen_ratio: seen as f64 / pixels }
}

/// The map of FLIP: how different each pixel looks, 0 to 1, row by row. Of images as in [`flip_mean`].
pub fn flip_map(reference: &[u8], test: &[u8], width: usize, height: usize) -> Vec<f32> {
    let mut whole = vec![0.0; width * height];
    if let Some((out, map)) = differing(reference, test, width, height) {
        for (row, y) in map.chunks(out.x1 - out.x0).zip(out.y0..) {
            let to = &mut whole[y * width + out.x0..][..row.len()];
            to.iter_mut().zip(row).for_each(|(to, from)| *to = *from as f32);
        }
    }
    whole
}

/// The part of the map in which it is not 0 for sure, row by row; `None` where the images are equal.
fn differing(reference: &[u8], test: &[u8], width: usize, height: usize) -> Option<(Region, Vec<f64>)> {
    let color_filters =
        [filter(&[(1.0, 0.0047)]), filter(&[(1.0, 0.0053)]), filter(&[(34.1, 0.04), (13.5, 0.025)])];
    let features = Features::new();
    // Every filter is as wide as the widest.
    let reach = color_filters.iter().map(|f| f.reach()).chain([features.reach]).max().unwrap_or(0);
    let changed = changed(reference, test, width, height)?;
    let out = changed.grown(reach, width, height);
    let input = out.grown(reach, width, height);
    let [reference, test] = [reference, test].map(|rgba| crop(rgba, width, &input));
    let map = map_of(&reference, &test, &color_filters, &features);
    let row = |y: usize| &map[(y - input.y0) * reference.width..][out.x0 - input.x0..out.x1 - input.x0];
    let part = (out.y0..out.y1).flat_map(row).copied().collect();
    Some((out, part))
}

/// Colors of differences, sRGB, at equal steps from 0 to 1: black, violet, red, yellow, white, each lighter
/// than the one before, so that the order shows without hue as well.
const SHADES: [[u8; 3]; 6] =
    [[0, 0, 0], [60, 16, 110], [140, 41, 129], [222, 73, 104], [254, 159, 109], [252, 253, 191]];

/// The color of a difference, 0 to 1: sRGB.
pub fn difference_color(difference: f32) -> [u8; 3] {
    let at = difference.clamp(0.0, 1.0) * (SHADES.len() - 1) as f32;
    let from = (at as usize).min(SHADES.len() - 2);
    let share = at - from as f32;
    std::array::from_fn(|c| {
        let [a, b] = [from, from + 1].map(|k| f32::from(SHADES[k][c]));
        (a + (b - a) * share + 0.5) as u8
    })
}

/// A map of differences as an image: RGBA.
pub fn shade_differences(map: &[f32]) -> Vec<u8> {
    map.iter().map(|d| difference_color(*d)).flat_map(|[r, g, b]| [r, g, b, 255]).collect()
}

/// Half-open rectangle of pixels.
struct Region {
    x0: usize,
    x1: usize,
    y0: usize,
    y1: usize,
}

impl Region {
    fn grown(&self, by: usize, width: usize, height: usize) -> Self {
        Self {
            x0: self.x0.saturating_sub(by),
            x1: (self.x1 + by).min(width),
            y0: self.y0.saturating_sub(by),
            y1: (self.y1 + by).min(height),
        }
    }
}

/// The box around the pixels that differ.
fn changed(a: &[u8], b: &[u8], width: usize, height: usize) -> Option<Region> {
    let mut region = Region { x0: width, x1: 0, y0: height, y1: 0 };
    for (i, (p, q)) in a.chunks_exact(4).zip(b.chunks_exact(4)).enumerate() {
        if p[..3] != q[..3] {
            let (x, y) = (i % width, i / width);
            region = Region {
                x0: region.x0.min(x),
                x1: region.x1.max(x + 1),
                y0: region.y0.min(y),
                y1: region.y1.max(y + 1),
            };
        }
    }
    (region.x1 > 0).then_some(region)
}

/// A part of an sRGB image in linear RGB.
fn crop(rgba: &[u8], width: usize, region: &Region) -> Image {
    let linear: Vec<f64> = (0..256).map(|v| decode(f64::from(v) / 255.0)).collect();
    let at = |x: usize, y: usize| std::array::from_fn(|c| linear[usize::from(rgba[(y * width + x) * 4 + c])]);
    let pixels = (region.y0..region.y1).flat_map(|y| (region.x0..region.x1).map(move |x| at(x, y))).collect();
    Image { width: region.x1 - region.x0, height: region.y1 - region.y0, pixels }
}

fn map_of(reference: &Image, test: &Image, color: &[Spread; 3], features: &Features) -> Vec<f64> {
    let [reference, test] = [reference, test].map(|image| (perceived(image, color), features.of(image)));
    let most = hyab(&hunt(&[0.0, 1.0, 0.0]), &hunt(&[0.0, 0.0, 1.0])).powf(QC);
    let pixel = |i: usize| {
        let color = redistribute(hyab(&reference.0[i], &test.0[i]).powf(QC), most);
        let ([edge_r, point_r], [edge_t, point_t]) = (reference.1[i], test.1[i]);
        let feature =
            ((edge_r - edge_t).abs().max((point_r - point_t).abs()) / 2f64.sqrt()).powf(QF).clamp(0.0, 1.0);
        // Section 4.3: a difference of features makes a difference of colors more visible.
        color.powf(1.0 - feature)
    };
    (0..reference.0.len()).map(pixel).collect()
}

/// Section 4.1: small and medium differences use 95 % of the range.
fn redistribute(difference: f64, most: f64) -> f64 {
    let knee = PC * most;
    if difference < knee {
        difference * PT / knee
    } else {
        PT + (difference - knee) / (most - knee) * (1.0 - PT)
    }
}

/// Section 4.1: the image as the eye's contrast sensitivity lets it through, in Hunt-adjusted CIELAB.
fn perceived(image: &Image, filters: &[Spread; 3]) -> Vec<Rgb> {
    let opponent: Vec<Rgb> = image.pixels.iter().map(|p| opponent_of_xyz(xyz_of_linear(p))).collect();
    let opponent = Image { pixels: opponent, ..*image };
    let channels = [0, 1, 2].map(|c| filters[c].apply(&opponent, c));
    (0..image.pixels.len())
        .map(|i| {
            let linear = linear_of_xyz(xyz_of_opponent([channels[0][i], channels[1][i], channels[2][i]]));
            hunt(&linear.map(|v| v.clamp(0.0, 1.0)))
        })
        .collect()
}

/// One row of separable weights around a middle.
struct Kernel(Vec<f64>);

impl Kernel {
    fn sampled(reach: usize, f: impl Fn(f64) -> f64) -> Self {
        Self((0..=2 * reach).map(|i| f(i as f64 - reach as f64)).collect())
    }
    fn reach(&self) -> usize {
        self.0.len() / 2
    }
    /// Weighted sums along x (`step` (1, 0)) or y, the border repeated.
    fn along(&self, from: &[f64], width: usize, height: usize, vertical: bool) -> Vec<f64> {
        let reach = self.reach() as isize;
        let clamp = |v: isize, size: usize| v.clamp(0, size as isize - 1) as usize;
        let mut to = Vec::with_capacity(from.len());
        for y in 0..height {
            for x in 0..width {
                let tap = |(k, weight): (usize, &f64)| {
                    let offset = k as isize - reach;
                    let at = if vertical {
                        clamp(y as isize + offset, height) * width + x
                    } else {
                        y * width + clamp(x as isize + offset, width)
                    };
                    weight * from[at]
                };
                to.push(self.0.iter().enumerate().map(tap).sum());
            }
        }
        to
    }
}

/// A sum of isotropic Gaussians whose weights sum to 1.
struct Spread(Vec<(f64, Kernel)>);

/// Section 4.1, Equation 2 and Table 1: the contrast sensitivity function as Gaussians `(a, b)` in space.
fn filter(terms: &[(f64, f64)]) -> Spread {
    // The reach of the widest of all channels, as in the authors' programs.
    let reach = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let kernels = terms.iter().map(|&(a, b)| {
        let gauss = |i: f64| (-(PI * i / PIXELS_PER_DEGREE).powi(2) / b).exp();
        (a * (PI / b).sqrt(), Kernel::sampled(reach, gauss))
    });
    let mut spread = Spread(kernels.collect());
    let total: f64 = spread.0.iter().map(|(weight, k)| weight * k.0.iter().sum::<f64>().powi(2)).sum();
    spread.0.iter_mut().for_each(|(weight, _)| *weight /= total);
    spread
}

impl Spread {
    fn reach(&self) -> usize {
        self.0.iter().map(|(_, k)| k.reach()).max().unwrap_or(0)
    }
    fn apply(&self, image: &Image, channel: usize) -> Vec<f64> {
        let from: Vec<f64> = image.pixels.iter().map(|p| p[channel]).collect();
        let mut sum = vec![0.0; from.len()];
        for (weight, kernel) in &self.0 {
            let rows = kernel.along(&from, image.width, image.height, false);
            let both = kernel.along(&rows, image.width, image.height, true);
            sum.iter_mut().zip(both).for_each(|(s, v)| *s += weight * v);
        }
        sum
    }
}

/// Section 4.2: detectors of edges (first derivative of a Gaussian) and points (second derivative).
struct Features {
    reach: usize,
    gauss: Kernel,
    edge: Kernel,
    point: Kernel,
}

impl Features {
    fn new() -> Self {
        let sd = 0.5 * FEATURE_DEGREES * PIXELS_PER_DEGREE;
        let reach = (3.0 * sd).ceil() as usize;
        let gauss = |i: f64| (-i * i / (2.0 * sd * sd)).exp();
        Self {
            reach,
            gauss: balanced(Kernel::sampled(reach, gauss)),
            edge: balanced(Kernel::sampled(reach, |i| -i * gauss(i))),
            point: balanced(Kernel::sampled(reach, |i| (i * i / (sd * sd) - 1.0) * gauss(i))),
        }
    }
    /// Strength of edges and of points in the achromatic channel, per pixel.
    fn of(&self, image: &Image) -> Vec<[f64; 2]> {
        let (w, h) = (image.width, image.height);
        let light: Vec<f64> =
            image.pixels.iter().map(|p| (opponent_of_xyz(xyz_of_linear(p))[0] + 16.0) / 116.0).collect();
        let strength = |detector: &Kernel| {
            let x = self.gauss.along(&detector.along(&light, w, h, false), w, h, true);
            let y = detector.along(&self.gauss.along(&light, w, h, false), w, h, true);
            x.into_iter().zip(y).map(|(x, y)| x.hypot(y)).collect::<Vec<f64>>()
        };
        strength(&self.edge).into_iter().zip(strength(&self.point)).map(|(e, p)| [e, p]).collect()
    }
}

/// Positive weights that sum to 1 and negative ones that sum to −1.
fn balanced(kernel: Kernel) -> Kernel {
    let positive: f64 = kernel.0.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -kernel.0.iter().filter(|w| **w < 0.0).sum::<f64>();
    Kernel(kernel.0.into_iter().map(|w| if w < 0.0 { w / negative } else { w / positive }).collect())
}

/// IEC 61966-2-1.
fn decode(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Rows of linear sRGB to CIE XYZ under D65.
const TO_XYZ: [Rgb; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

fn times(rows: &[Rgb; 3], v: &Rgb) -> Rgb {
    rows.map(|r| r[0] * v[0] + r[1] * v[1] + r[2] * v[2])
}

fn xyz_of_linear(rgb: &Rgb) -> Rgb {
    times(&TO_XYZ, rgb)
}

/// XYZ of white.
fn white() -> Rgb {
    xyz_of_linear(&[1.0, 1.0, 1.0])
}

/// By Cramer's rule.
fn linear_of_xyz(xyz: Rgb) -> Rgb {
    let column = |c: usize| [TO_XYZ[0][c], TO_XYZ[1][c], TO_XYZ[2][c]];
    let cross =
        |a: Rgb, b: Rgb| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: Rgb, b: Rgb| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [r, g, b] = [column(0), column(1), column(2)];
    let (gb, br, rg) = (cross(g, b), cross(b, r), cross(r, g));
    let det = dot(r, gb);
    [dot(xyz, gb) / det, dot(xyz, br) / det, dot(xyz, rg) / det]
}

/// Section 4.1: YCxCz, a linearized CIELAB, in which contrast is filtered.
fn opponent_of_xyz(xyz: Rgb) -> Rgb {
    let w = white();
    let [x, y, z] = [xyz[0] / w[0], xyz[1] / w[1], xyz[2] / w[2]];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_of_opponent([y, cx, cz]: Rgb) -> Rgb {
    let w = white();
    let y = (y + 16.0) / 116.0;
    [(cx / 500.0 + y) * w[0], y * w[1], (y - cz / 200.0) * w[2]]
}

/// CIELAB of linear RGB with Hunt's effect: chroma grows with lightness.
fn hunt(linear: &Rgb) -> Rgb {
    let (xyz, w) = (xyz_of_linear(linear), white());
    let delta = 6.0f64 / 29.0;
    let f = |t: f64| if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 };
    let [x, y, z] = [f(xyz[0] / w[0]), f(xyz[1] / w[1]), f(xyz[2] / w[2])];
    let (light, a, b) = (116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z));
    [light, 0.01 * light * a, 0.01 * light * b]
}

/// The HyAB distance (Abasi, Amani Tehran, Fairchild 2020): city block in lightness, Euclidean in chroma.
fn hyab(p: &Rgb, q: &Rgb) -> f64 {
    (p[0] - q[0]).abs() + (p[1] - q[1]).hypot(p[2] - q[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    type Maker = fn(usize, usize, usize, usize) -> [[u8; 3]; 2];

    fn images(width: usize, height: usize, make: Maker) -> [Vec<u8>; 2] {
        let both: Vec<_> = (0..width * height).map(|i| make(i % width, i / width, width, height)).collect();
        [0, 1].map(|k| both.iter().flat_map(|p| [p[k][0], p[k][1], p[k][2], 255]).collect())
    }

    fn gradient(x: usize, y: usize, w: usize, h: usize) -> [[u8; 3]; 2] {
        let a = [(x * 255 / (w - 1)) as u8, (y * 255 / (h - 1)) as u8, 128];
        let inside = (w / 4..w / 2).contains(&x) && (h / 4..h / 2).contains(&y);
        [a, if inside { [250, 240, 30] } else { a }]
    }
    fn noise(x: usize, y: usize, w: usize, _: usize) -> [[u8; 3]; 2] {
        let hash = |s: usize| (((((y * w + x) * 3 + s) as u64 * 2_654_435_761) & 0xffff_ffff) >> 13) as u8;
        [[0, 1, 2], [1000, 1001, 1002]].map(|s| s.map(hash))
    }
    fn pixel(x: usize, y: usize, w: usize, h: usize) -> [[u8; 3]; 2] {
        let a = [90, 120, 60];
        [a, if (x, y) == (w / 2, h / 2) { [200, 40, 40] } else { a }]
    }
    fn line(x: usize, _: usize, _: usize, _: usize) -> [[u8; 3]; 2] {
        let a = [(x * 7 % 256) as u8, 200, (x * 3 % 256) as u8];
        [a, if (10..14).contains(&x) { [255; 3] } else { a }]
    }

    /// Means of the error maps of the authors' own program, the package `flip-evaluator` 1.7 of PyPI:
    /// `evaluate(reference, test, "LDR", applyMagma=False)` on the images above as f32 / 255.
    #[test]
    fn means_agree_with_the_authors_program() {
        let cases: [(&str, usize, usize, Maker, f64); 7] = [
            ("gradient", 64, 48, gradient, 0.131_362_6),
            ("gradient, wide", 128, 16, gradient, 0.180_385_5),
            ("noise", 40, 30, noise, 0.571_632_4),
            ("black to white", 32, 32, |_, _, _, _| [[0; 3], [255; 3]], 0.967_388_2),
            ("green to blue", 32, 32, |_, _, _, _| [[0, 255, 0], [0, 0, 255]], 1.0),
            ("one pixel", 64, 64, pixel, 0.000_675_123),
            ("flatland", 200, 1, line, 0.053_365_86),
        ];
        for (name, w, h, make, want) in cases {
            let [a, b] = images(w, h, make);
            let got = flip_mean(&a, &b, w, h);
            assert!(
                (got - want).abs() < 2e-5 * want.max(0.05),
                "{name}: {got}, the authors' program gives {want}"
            );
            let back = flip_mean(&b, &a, w, h);
            assert!(
                (back - got).abs() < 1e-12,
                "{name}: the difference of a pair does not depend on its order"
            );
        }
    }

    #[test]
    fn equal_images_do_not_differ_at_all() {
        let [a, _] = images(50, 20, noise);
        assert_eq!(flip_mean(&a, &a, 50, 20), 0.0);
        let transparent: Vec<u8> = a.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2], 0]).collect();
        assert_eq!(flip_mean(&a, &transparent, 50, 20), 0.0);
    }

    /// Black beside white differs everywhere; one pixel in 4,096 only around itself: the reach of its
    /// features is that of the filters, 10 pixels (Section 4.2), and fades long before that.
    #[test]
    fn pixels_whose_difference_is_seen_are_counted() {
        let [a, b] = images(32, 32, |_, _, _, _| [[0; 3], [255; 3]]);
        assert_eq!(flip(&a, &b, 32, 32).seen_ratio, 1.0);
        let [a, b] = images(64, 64, pixel);
        let Flip { mean, seen_ratio } = flip(&a, &b, 64, 64);
        assert!((1.0 / 4096.0..40.0 / 4096.0).contains(&seen_ratio), "{seen_ratio}");
        // What is above a tenth is at most ten times the whole.
        assert!(seen_ratio * SEEN < mean, "{seen_ratio} and {mean}");
        assert_eq!(flip(&a, &a, 64, 64), Flip::default());
    }

    #[test]
    fn looking_only_near_the_difference_changes_nothing() {
        // A change in a corner of a large image: the whole map, summed, is what the neighborhood gives.
        let [a, mut b] = images(120, 90, gradient);
        b.copy_from_slice(&a);
        b[(88 * 120 + 3) * 4] ^= 0x80;
        let [ra, rb] = [&a, &b].map(|rgba| crop(rgba, 120, &Region { x0: 0, x1: 120, y0: 0, y1: 90 }));
        let filters =
            [filter(&[(1.0, 0.0047)]), filter(&[(1.0, 0.0053)]), filter(&[(34.1, 0.04), (13.5, 0.025)])];
        let whole = map_of(&ra, &rb, &filters, &Features::new()).iter().sum::<f64>() / (120.0 * 90.0);
        let near = flip_mean(&a, &b, 120, 90);
        assert!(near > 0.0 && (whole - near).abs() < 1e-12, "{whole} and {near}");
    }

    #[test]
    fn the_map_is_what_the_mean_is_of_and_colors_go_up_from_black() {
        let [a, b] = images(64, 48, gradient);
        let map = flip_map(&a, &b, 64, 48);
        let mean = map.iter().map(|d| f64::from(*d)).sum::<f64>() / map.len() as f64;
        assert!((mean - flip_mean(&a, &b, 64, 48)).abs() < 1e-6, "{mean}");
        // Far from the square that differs nothing does; in its middle it is seen.
        assert!(map[47 * 64 + 63] == 0.0 && f64::from(map[18 * 64 + 24]) > SEEN);
        assert_eq!(flip_map(&a, &a, 64, 48), vec![0.0; 64 * 48]);
        assert_eq!([0.0, 0.2, 1.0, 7.0].map(difference_color), [SHADES[0], SHADES[1], SHADES[5], SHADES[5]]);
        let light = |k: i32| difference_color(k as f32 / 50.0).iter().map(|c| u32::from(*c)).sum::<u32>();
        assert!((0..50).all(|k| light(k) < light(k + 1)), "lighter step by step");
        assert_eq!(shade_differences(&[0.0, 0.2]), [0, 0, 0, 255, 60, 16, 110, 255]);
    }
}
