//! Pixels as PNG files, and the recipe that a file carries.

use crate::drawing::Pixels;

/// Keyword of the chunk that carries the recipe.
pub(super) const RECIPE_KEY: &str = "cullscope-recipe";

/// A picture as a PNG file, pixel by pixel.
pub fn png_pixels(pixels: &Pixels) -> Vec<u8> {
    encode(pixels, &[], None)
}

/// A PNG file of pixels, with texts (iTXt chunks) and a resolution. Rows that are missing are black; an
/// opaque picture is written without its alpha channel.
pub(super) fn encode(pixels: &Pixels, texts: &[(&str, &str)], dpi: Option<f32>) -> Vec<u8> {
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
    encoder.set_compression(png::Compression::Balanced);
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
    // Writing to memory cannot fail, and the length was made to fit.
    if let Ok(mut writer) = encoder.write_header() {
        let _ = writer.write_image_data(if opaque { &rgb } else { data });
    }
    out
}

/// The recipe in a PNG file.
pub(super) fn recipe(bytes: &[u8]) -> Option<String> {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    reader.info().utf8_text.iter().find(|t| t.keyword == RECIPE_KEY).and_then(|t| t.get_text().ok())
}
