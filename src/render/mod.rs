//! Readers of drawings: SVG, PDF, PNG, pages for browsers and the screen; and the theme, the only place with
//! colors.
//!
//! A reader adds no mark of its own. What a role needs beyond one stroke (halo, hatch, sign) is decided once,
//! in `piece.rs`, so that all readers show the same picture. Every file format carries the recipe of the
//! figure, which [`recipe`] reads back.

mod animation;
pub mod color_vision;
mod export;
mod face;
#[cfg(feature = "gui")]
pub mod gpu;
mod hatch;
mod html;
mod number;
mod pdf;
mod piece;
mod png;
mod raster;
#[cfg(feature = "gui")]
pub mod screen;
mod svg;
pub mod theme;

pub use animation::Animation;
pub use export::{Format, export};
pub use html::page;
pub use pdf::{pages, pdf};
pub use png::png_pixels;
pub use raster::{PngSize, pixels, png, texts};
pub use svg::{SvgOptions, svg};
pub use theme::{Look, Theme};

/// What can go wrong while a drawing is read.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The picture would be empty or too large for memory.
    #[error("a picture of {width_px} × {height_px} pixels cannot be made (at least 1, at most 20000 a side)")]
    Size {
        /// Columns asked for.
        width_px: f32,
        /// Rows asked for.
        height_px: f32,
    },
    /// PDF allows no such page.
    #[error("a page of {width_pt} × {height_pt} points cannot be made (at least 1, at most 14400 a side)")]
    Page {
        /// Its width.
        width_pt: f32,
        /// Its height.
        height_pt: f32,
    },
    /// The rasterizer refused the drawing.
    #[error("the picture could not be rasterized: {0}")]
    Picture(String),
    /// There is no such format of figures.
    #[error("`{0}` is no format of figures: expected svg, pdf or png")]
    Format(String),
    /// The PDF writer refused the drawing.
    #[error("the PDF file could not be written: {0}")]
    Pdf(String),
}

/// The recipe that a figure file carries, whichever of the formats it has; `None` if there is none.
pub fn recipe(bytes: &[u8]) -> Option<String> {
    if bytes.starts_with(b"\x89PNG") {
        return png::recipe(bytes);
    }
    if bytes.starts_with(b"%PDF") {
        return pdf::recipe(bytes);
    }
    svg::recipe(std::str::from_utf8(bytes).ok()?)
}
