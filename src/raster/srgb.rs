//! The sRGB encoding (IEC 61966-2-1), for whoever paints pixels.

/// A channel of linear light as an sRGB value, both from 0 to 1; what lies outside is clamped.
pub fn srgb(linear: f32) -> f32 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// A color of linear light as opaque sRGB bytes (RGBA).
pub fn srgb_bytes(linear: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = linear.map(|c| (srgb(c) * 255.0 + 0.5) as u8);
    [r, g, b, 255]
}

/// The linear light of an sRGB byte.
pub fn linear(byte: u8) -> f32 {
    let c = f32::from(byte) / 255.0;
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
