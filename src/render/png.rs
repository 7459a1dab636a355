//! Pixels as PNG files, and the recipe that a file carries.

use glam::Vec2;
use png::Compression;

use crate::drawing::Pixels;

/// Keyword of the chunk that carries the recipe.
pub(super) const RECIPE_KEY: &str = "cullscope-recipe";

/// A picture is enlarged to no more pixels than this: more of them are too small to be seen smoothed.
const MOST_PIXELS: u64 = 512 * 512;

/// A picture with each pixel repeated, for a place of some size on paper. Many programs smooth what they
/// enlarge, whatever the file asks for: a z-buffer of 4 × 4 cells becomes a blur there. Enlarged beforehand,
/// it has hard edges in all of them; pictures of many pixels stay as they are.
pub(super) fn enlarged(pixels: &Pixels, size_pt: Vec2) -> Pixels {
    let [width, height] = [pixels.width.max(1), pixels.height.max(1)];
    // What is smoothed at an edge is one pixel wide: a 16th of a cell, yet no more than 0.1 mm, and less than
    // half of that only makes files larger.
    let wanted = |size_pt: f32, cells: u32| {
        let cell = size_pt / cells as f32;
        ((cell / (cell / 16.0).clamp(0.15, 0.3)).ceil() as u32).clamp(1, 1024)
    };
    let mut times = [wanted(size_pt.x, width), wanted(size_pt.y, height)];
    while [width, height, times[0], times[1]].iter().map(|n| u64::from(*n)).product::<u64>() > MOST_PIXELS
        && times != [1, 1]
    {
        times = times.map(|t| (t / 2).max(1));
    }
    let [across, down] = times.map(|t| t as usize);
    let mut rgba = Vec::with_capacity(pixels.rgba.len() * across * down);
    for row in pixels.rgba.chunks_exact(4 * width as usize) {
        let long: Vec<u8> = row.chunks_exact(4).flat_map(|cell| cell.repeat(across)).collect();
        rgba.extend(long.repeat(down));
    }
    Pixels { width: width * times[0], height: height * times[1], rgba: rgba.into() }
}

/// A picture as a PNG file, pixel by pixel.
pub fn png_pixels(pixels: &Pixels) -> Vec<u8> {
    encode(pixels, &[], None, Compression::Balanced)
}

/// The same for a picture that is read at once and not kept.
pub(super) fn png_passing(pixels: &Pixels) -> Vec<u8> {
    encode(pixels, &[], None, Compression::Fastest)
}

/// A PNG file of pixels, with texts (iTXt chunks) and a resolution. Rows that are missing are black; an
/// opaque picture is written without its alpha channel.
pub(super) fn encode(
    pixels: &Pixels,
    texts: &[(&str, &str)],
    dpi: Option<f32>,
    compression: Compression,
) -> Vec<u8> {
    let (width, height, rgba) = (pixels.width.max(1), pixels.height.max(1), &pixels.rgba[..]);
    let mut whole;
    let length = 4 * width as usize * height as usize;
    let data = if rgba.len() == length {
        rgba
    } else {
        whole = rgba.to_vec();
        whole.resize(length, 0);
        &whole
    };
    let opaque = data.chunks_exact(4).all(|p| p[3] == 255);
    let rgb: Vec<u8> =
        if opaque { data.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect() } else { Vec::new() };
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(compression);
    describe(&mut encoder, texts, dpi);
    // Writing to memory cannot fail, and the length was made to fit.
    if let Ok(mut writer) = encoder.write_header() {
        let _ = writer.write_image_data(if opaque { &rgb } else { data });
    }
    out
}

/// Adds texts and a resolution to a file that is about to be written.
pub(super) fn describe<W: std::io::Write>(
    encoder: &mut png::Encoder<'_, W>,
    texts: &[(&str, &str)],
    dpi: Option<f32>,
) {
    if let Some(dpi) = dpi {
        let per_meter = (dpi / 0.0254).round() as u32;
        encoder.set_pixel_dims(Some(png::PixelDimensions {
            xppu: per_meter,
            yppu: per_meter,
            unit: png::Unit::Meter,
        }));
    }
    for (key, text) in texts {
        // Keywords are our own and valid; texts may be anything.
        let _ = encoder.add_itxt_chunk((*key).to_owned(), (*text).to_owned());
    }
}

/// The recipe in a PNG file.
pub(super) fn recipe(bytes: &[u8]) -> Option<String> {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    reader.info().utf8_text.iter().find(|t| t.keyword == RECIPE_KEY).and_then(|t| t.get_text().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pictures_are_enlarged_and_large_ones_kept() {
        let of = |width: u32, height: u32| {
            let cell = |i: u32| [i as u8, (i >> 8) as u8, (i >> 16) as u8, 255];
            Pixels { width, height, rgba: (0..width * height).flat_map(cell).collect::<Vec<u8>>().into() }
        };
        for (width, height, size_pt) in [
            (4, 4, Vec2::splat(150.0)),
            (1, 1, Vec2::splat(300.0)),
            (64, 1, Vec2::new(474.0, 12.0)),
            (64, 48, Vec2::new(114.0, 85.0)),
            (240, 240, Vec2::splat(157.0)),
            (320, 240, Vec2::splat(1e9)),
            (256, 1, Vec2::new(297.6, 1.77)),
            (3, 2, Vec2::splat(f32::NAN)),
        ] {
            let (small, large) = (of(width, height), enlarged(&of(width, height), size_pt));
            let times = [large.width / width, large.height / height];
            assert_eq!([large.width % width, large.height % height], [0, 0], "{width} × {height}");
            assert!(u64::from(large.width) * u64::from(large.height) <= MOST_PIXELS, "{width} × {height}");
            let smeared = size_pt / Vec2::new(large.width as f32, large.height as f32);
            let hard = smeared.is_nan() || smeared.max_element() <= 0.6;
            assert!(hard || width > 200, "{width} × {height}: {smeared}");
            for (x, y) in
                (0..large.width).flat_map(|x| [0, large.height / 2, large.height - 1].map(|y| (x, y)))
            {
                let texel =
                    |p: &Pixels, x: u32, y: u32| p.rgba[4 * (y * p.width + x) as usize..][..4].to_vec();
                assert_eq!(texel(&large, x, y), texel(&small, x / times[0], y / times[1]), "{x}, {y}");
            }
        }
        assert_eq!(enlarged(&of(320, 240), Vec2::splat(200.0)), of(320, 240));
    }
}
