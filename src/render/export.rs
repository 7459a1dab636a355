//! A drawing as the bytes of a figure file, whichever the format.

use std::str::FromStr;

use super::raster::PngSize;
use super::svg::SvgOptions;
use super::{Look, RenderError, pdf, png, svg};
use crate::drawing::Drawing;

/// Dots an inch of PNG figures: what journals ask for.
const DPI: f32 = 300.0;

/// A file format of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Format {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Document Format.
    Pdf,
    /// Portable Network Graphics, at 300 dots an inch.
    Png,
}

impl Format {
    /// Every format, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Svg, Self::Pdf, Self::Png];

    /// Its name, which is also the extension of its files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Pdf => "pdf",
            Self::Png => "png",
        }
    }
}

impl FromStr for Format {
    type Err = RenderError;
    fn from_str(name: &str) -> Result<Self, RenderError> {
        let found = Self::ALL.into_iter().find(|f| f.name() == name);
        found.ok_or_else(|| RenderError::Format(name.to_owned()))
    }
}

/// A drawing as the bytes of a file that carries its recipe, which [`super::recipe`] reads back.
///
/// # Errors
/// If the drawing's paper is empty or too large for the format, or its writer refuses it.
pub fn export(
    drawing: &Drawing,
    format: Format,
    look: impl Into<Look>,
    recipe: &str,
) -> Result<Vec<u8>, RenderError> {
    match format {
        Format::Svg => {
            let options = SvgOptions { metadata: Some(recipe), ..SvgOptions::default() };
            Ok(svg(drawing, look, &options).into_bytes())
        }
        Format::Pdf => pdf(drawing, look, Some(recipe)),
        Format::Png => png(drawing, look, PngSize::Dpi(DPI), Some(recipe)),
    }
}
