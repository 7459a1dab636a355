//! Drawings as pixels and PNG pictures, through our own SVG and our own fonts only: no system font, no date.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, fontdb};

use crate::drawing::{Drawing, Font, Pixels, metrics};

use super::RenderError;
use super::png::{RECIPE_KEY, encode};
use super::svg::{SvgOptions, write};
use super::theme::Look;

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
///
/// # Errors
/// If the picture would be empty or too large, or the rasterizer refuses the drawing.
pub fn png(
    drawing: &Drawing,
    look: impl Into<Look>,
    size: PngSize,
    metadata: Option<&str>,
) -> Result<Vec<u8>, RenderError> {
    let (pixels, dpi) = pixels_of(drawing, look.into(), size)?;
    let texts = texts(drawing, metadata);
    let texts: Vec<(&str, &str)> = texts.iter().map(|(key, text)| (*key, text.as_str())).collect();
    Ok(encode(&pixels, &texts, Some(dpi), png::Compression::Balanced))
}

/// What a PNG file says of a drawing, by keyword.
pub fn texts(drawing: &Drawing, metadata: Option<&str>) -> Vec<(&'static str, String)> {
    let all = [
        ("Title", drawing.title.as_str()),
        ("Description", drawing.description.as_str()),
        (RECIPE_KEY, metadata.unwrap_or("")),
    ];
    all.into_iter().filter(|(_, text)| !text.is_empty()).map(|(key, text)| (key, text.to_owned())).collect()
}

/// A drawing as pixels.
///
/// # Errors
/// If the picture would be empty or too large, or the rasterizer refuses the drawing.
pub fn pixels(drawing: &Drawing, look: impl Into<Look>, size: PngSize) -> Result<Pixels, RenderError> {
    Ok(pixels_of(drawing, look.into(), size)?.0)
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
