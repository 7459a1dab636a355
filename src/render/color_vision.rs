//! How a color looks to people with other eyes and on a gray printer.
//!
//! Dichromacies after Machado, Oliveira and Fernandes, "A Physiologically-based Model for Simulation of
//! Color Vision Deficiency", IEEE TVCG 15(6), 2009, doi:10.1109/TVCG.2009.113 (matrices for severity 1,
//! applied to linear RGB). Differences are CIE 1976 ΔE*ab under D65. Used for the preview and by the
//! tests of the theme.

use crate::raster::{self, srgb};

/// An sRGB color.
pub type Rgb = [u8; 3];

/// Whose eyes look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColorVision {
    /// Three cones, or a color printer.
    #[default]
    Full,
    /// A gray printer.
    Gray,
    /// No long-wave cones.
    Protanopia,
    /// No middle-wave cones.
    Deuteranopia,
    /// No short-wave cones.
    Tritanopia,
}

impl ColorVision {
    /// All of them, in the order of menus.
    pub const ALL: [ColorVision; 5] = [
        ColorVision::Full,
        ColorVision::Gray,
        ColorVision::Protanopia,
        ColorVision::Deuteranopia,
        ColorVision::Tritanopia,
    ];

    /// Name for menus.
    pub fn name(self) -> &'static str {
        match self {
            ColorVision::Full => "full color",
            ColorVision::Gray => "grayscale",
            ColorVision::Protanopia => "protanopia",
            ColorVision::Deuteranopia => "deuteranopia",
            ColorVision::Tritanopia => "tritanopia",
        }
    }

    /// A color as it is seen.
    pub fn see(self, color: Rgb) -> Rgb {
        let rows: [[f32; 3]; 3] = match self {
            ColorVision::Full => return color,
            ColorVision::Gray => [LUMINANCE; 3],
            ColorVision::Protanopia => [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
            ColorVision::Deuteranopia => [
                [0.367322, 0.860646, -0.227968],
                [0.280085, 0.672501, 0.047413],
                [-0.011820, 0.042940, 0.968881],
            ],
            ColorVision::Tritanopia => [
                [1.255528, -0.076749, -0.178779],
                [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900],
            ],
        };
        let seen = linear(color);
        rows.map(|row| (srgb(row.iter().zip(seen).map(|(a, b)| a * b).sum()) * 255.0).round() as u8)
    }
}

/// Weights of linear red, green and blue in the luminance (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// An sRGB color in linear light, as shaders blend it.
pub fn linear(color: Rgb) -> [f32; 3] {
    color.map(raster::linear)
}

/// Relative luminance, 0 for black and 1 for white.
pub fn luminance(color: Rgb) -> f32 {
    linear(color).iter().zip(LUMINANCE).map(|(a, b)| a * b).sum()
}

/// Contrast of two colors after WCAG 2: 1 for equal ones, 21 for black on white.
pub fn contrast(a: Rgb, b: Rgb) -> f32 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// CIE L*a*b* under D65.
fn lab(color: Rgb) -> [f32; 3] {
    let [r, g, b] = linear(color);
    let x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505;
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
    let [x, y, z] = [x, y, z].map(|t: f32| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Difference of two colors, ΔE*ab: about 2 is just seen, 20 is told apart at a glance.
pub fn difference(a: Rgb, b: Rgb) -> f32 {
    lab(a).iter().zip(lab(b)).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()
}

/// A color between two others, in sRGB: `t` = 0 gives `a`, 1 gives `b`.
pub fn mix(a: Rgb, b: Rgb, t: f32) -> Rgb {
    std::array::from_fn(|i| (f32::from(a[i]) * (1.0 - t) + f32::from(b[i]) * t).round() as u8)
}

/// The color nearest to `color`, on the way to `ink`, that has at least the given contrast on `paper`.
pub fn readable(color: Rgb, ink: Rgb, paper: Rgb, least: f32) -> Rgb {
    (0..=20).map(|i| mix(color, ink, i as f32 / 20.0)).find(|c| contrast(*c, paper) >= least).unwrap_or(ink)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert!((contrast([0; 3], [255; 3]) - 21.0).abs() < 1e-3);
        assert!(difference([255; 3], [0; 3]) > 99.0);
        assert_eq!(ColorVision::Gray.see([0, 0, 255]), [76; 3]);
        for vision in ColorVision::ALL {
            for gray in [[0; 3], [119; 3], [255; 3]] {
                assert!(
                    difference(vision.see(gray), gray) < 1.5,
                    "{vision:?} changes gray {gray:?} to {:?}",
                    vision.see(gray)
                );
            }
        }
    }

    #[test]
    fn red_and_green_fall_together_without_their_cones() {
        let (red, green) = ([200, 60, 40], [110, 120, 40]);
        let full = difference(red, green);
        assert!(
            difference(ColorVision::Deuteranopia.see(red), ColorVision::Deuteranopia.see(green)) < full / 2.0
        );
        assert!(
            difference(ColorVision::Tritanopia.see(red), ColorVision::Tritanopia.see(green)) > full / 2.0
        );
    }

    #[test]
    fn readable_colors_are_readable() {
        let c = readable([230, 159, 0], [20, 20, 20], [255; 3], 4.5);
        assert!(contrast(c, [255; 3]) >= 4.5 && difference(c, [20, 20, 20]) > 20.0);
    }
}
