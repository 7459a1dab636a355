//! Drawings as PNG pictures, through our own SVG and our own fonts only: no system font, no date.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, fontdb};

use crate::drawing::{Drawing, Font, Pixels, metrics};

use super::RenderError;
use super::svg::{SvgOptions, write};
use super::theme::Look;

/// Keyword of the chunk that carries the recipe.
pub(super) const RECIPE_KEY: &str = "cullscope-recipe";

/// The longest side that is written, in pixels; more is a slip of the finger and would take gigabytes.
const LONGEST_PX: f32 = 20_000.0;

/// How large a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PngSize {
    /// Pixels to an inch of paper.
    Dpi(f32),
    /// Pixels across; the height follows.
    WidthPx(u32),
}

/// A drawing as a PNG file.
pub fn png(
    drawing: &Drawing,
    look: impl Into<Look>,
    size: PngSize,
    metadata: Option<&str>,
) -> Result<Vec<u8>, RenderError> {
    let (pixels, dpi) = pixels_of(drawing, look.into(), size)?;
    let texts: Vec<(&str, &str)> = [
        ("Title", drawing.title.as_str()),
        ("Description", drawing.description.as_str()),
        (RECIPE_KEY, metadata.unwrap_or("")),
    ]
    .into_iter()
    .filter(|(_, text)| !text.is_empty())
    .collect();
    Ok(encode_at(pixels.width, pixels.height, &pixels.rgba, &texts, Some(dpi)))
}

/// A drawing as pixels.
pub fn pixels(drawing: &Drawing, look: impl Into<Look>, size: PngSize) -> Result<Pixels, RenderError> {
    Ok(pixels_of(drawing, look.into(), size)?.0)
}

/// A picture as a PNG file, pixel by pixel.
pub fn png_pixels(pixels: &Pixels) -> Vec<u8> {
    encode(pixels.width, pixels.height, &pixels.rgba, &[])
}

fn pixels_of(drawing: &Drawing, look: Look, size: PngSize) -> Result<(Pixels, f32), RenderError> {
    let paper = drawing.size_pt;
    let scale = match size {
        PngSize::Dpi(dpi) => dpi / 72.0,
        PngSize::WidthPx(width) => width as f32 / paper.x,
    };
    let px = (paper * scale).round();
    if !(px.is_finite() && px.min_element() >= 1.0 && px.max_element() <= LONGEST_PX) {
        return Err(RenderError::Size { width_px: px.x, height_px: px.y });
    }
    let text = write(drawing, look, &SvgOptions::default(), false);
    let options = usvg::Options {
        fontdb: fonts(),
        font_family: metrics::family(Font::Regular).to_owned(),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(&text, &options).map_err(|e| RenderError::Picture(e.to_string()))?;
    let mut pixmap =
        Pixmap::new(px.x as u32, px.y as u32).ok_or(RenderError::Size { width_px: px.x, height_px: px.y })?;
    let transform = Transform::from_scale(px.x / tree.size().width(), px.y / tree.size().height());
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    let rgba: Vec<u8> = pixmap
        .pixels()
        .iter()
        .map(|p| p.demultiply())
        .flat_map(|p| [p.red(), p.green(), p.blue(), p.alpha()])
        .collect();
    Ok((Pixels { width: pixmap.width(), height: pixmap.height(), rgba: rgba.into() }, scale * 72.0))
}

fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    FONTS
        .get_or_init(|| {
            let mut fonts = fontdb::Database::new();
            for font in Font::ALL {
                fonts.load_font_data(metrics::font_bytes(font).to_vec());
            }
            fonts.set_sans_serif_family(metrics::family(Font::Regular));
            fonts.set_monospace_family(metrics::family(Font::Mono));
            Arc::new(fonts)
        })
        .clone()
}

/// A PNG file of RGBA pixels with texts (iTXt chunks). Rows that are missing are black.
pub(super) fn encode(width: u32, height: u32, rgba: &[u8], texts: &[(&str, &str)]) -> Vec<u8> {
    encode_at(width, height, rgba, texts, None)
}

fn encode_at(width: u32, height: u32, rgba: &[u8], texts: &[(&str, &str)], dpi: Option<f32>) -> Vec<u8> {
    let (width, height) = (width.max(1), height.max(1));
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
    let mut encoder = ::png::Encoder::new(&mut out, width, height);
    encoder.set_color(if opaque { ::png::ColorType::Rgb } else { ::png::ColorType::Rgba });
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::Balanced);
    if let Some(dpi) = dpi {
        let per_meter = (dpi / 0.0254).round() as u32;
        encoder.set_pixel_dims(Some(::png::PixelDimensions {
            xppu: per_meter,
            yppu: per_meter,
            unit: ::png::Unit::Meter,
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
    let reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    reader.info().utf8_text.iter().find(|t| t.keyword == RECIPE_KEY).and_then(|t| t.get_text().ok())
}
