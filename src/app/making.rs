//! A figure that is being made, part by part: a window stays alive meanwhile, and a person can stop it.
//!
//! A part is one picture of one step. The parts of a page stand beside each other; several pages are those of
//! a PDF file or the pictures of an animation.

use rayon::prelude::*;

use super::plate::{Export, Form, MOVING_DPI, Picture, RATE};
use super::twin::Twin;
use crate::drawing::words::count;
use crate::drawing::{Drawing, Mark};
use crate::figure::page::Entry;
use crate::render::{self, Animation, Format, PngSize, RenderError, SvgOptions};

/// Pages of an animation that are painted at once, on all threads.
const BATCH: usize = 8;

/// What stands in one picture: its step and what it shows.
pub(super) type Part = (usize, Picture);

/// A figure that is being made.
pub struct Making {
    pub(super) export: Export,
    pub(super) format: Format,
    pub(super) recipe: String,
    /// The parts of each page.
    pub(super) pages: Vec<Vec<Part>>,
    pub(super) columns: usize,
    pub(super) least_below_pt: f32,
    /// Pages that are done, and parts of the next one.
    pub(super) done: usize,
    pub(super) cells: Vec<(Drawing, Vec<Entry>)>,
    /// Pages of a PDF file so far.
    drawn: Vec<Drawing>,
    animation: Option<Animation>,
    least_letters_pt: f32,
    /// The run of the flatland twin, where it is shown.
    pub(super) twin: Option<Twin>,
}

impl Making {
    /// Nothing of these pages yet, whose file carries a text.
    pub(super) fn new(export: &Export, format: Format, recipe: &str, pages: Vec<Vec<Part>>) -> Self {
        Self {
            export: export.clone(),
            format,
            recipe: recipe.to_owned(),
            pages,
            columns: 1,
            least_below_pt: 0.0,
            done: 0,
            cells: Vec::new(),
            drawn: Vec::new(),
            animation: None,
            least_letters_pt: f32::INFINITY,
            twin: None,
        }
    }
    /// The size of the smallest letters of its pages so far, points.
    pub fn least_letters_pt(&self) -> f32 {
        self.least_letters_pt
    }
    /// How many parts it has.
    pub fn parts(&self) -> usize {
        self.pages.iter().map(Vec::len).sum()
    }
    /// How far it is, 0 to 1.
    pub fn fraction(&self) -> f32 {
        let done: usize = self.pages[..self.done].iter().map(Vec::len).sum();
        (done + self.cells.len()) as f32 / self.parts().max(1) as f32
    }
    /// Whether only one picture stands on a page.
    pub(super) fn is_single(&self) -> bool {
        self.pages[0].len() == 1
    }
    /// Whether legend and caption must not move from page to page.
    pub(super) fn is_sequence(&self) -> bool {
        self.pages.len() > 1
    }
    /// The steps of a page that shows several.
    pub(super) fn steps(&self) -> Option<String> {
        let steps = self.export.steps.filter(|s| s.from != s.to && self.export.form == Form::Page)?;
        let stride = match steps.stride {
            1 => String::new(),
            2 => ", every other one,".into(),
            3 => ", every 3rd,".into(),
            n => format!(", every {}th,", count(n)),
        };
        Some(format!("Steps {} to {}{stride}", count(steps.from), count(steps.to)))
    }
    /// Takes the next page; the bytes of the file after the last one.
    pub(super) fn take(&mut self, drawing: Drawing) -> Result<Option<Vec<u8>>, String> {
        let is_last = self.done == self.pages.len();
        for item in &drawing.items {
            if let Mark::Text { size_pt, .. } = item.mark {
                self.least_letters_pt = self.least_letters_pt.min(size_pt);
            }
        }
        let (theme, recipe) = (self.export.theme, self.recipe.as_str());
        let made = match (self.export.form, self.format) {
            (Form::Page, Format::Svg) => {
                let options = SvgOptions { outline_text: self.export.outline_text, metadata: Some(recipe) };
                Ok(Some(render::svg(&drawing, theme, &options).into_bytes()))
            }
            (Form::Page, format) => render::export(&drawing, format, theme, recipe).map(Some),
            (Form::Pages, _) => {
                self.drawn.push(drawing);
                if !is_last {
                    return Ok(None);
                }
                render::pages(&self.drawn, theme, Some(recipe)).map(Some)
            }
            (Form::Animation(_), _) => {
                self.drawn.push(drawing);
                if !is_last && self.drawn.len() < BATCH {
                    return Ok(None);
                }
                self.animate(is_last)
            }
        };
        made.map_err(|e| e.to_string())
    }

    /// Adds the pages that wait to the animation; the bytes of the file after the last one.
    fn animate(&mut self, is_last: bool) -> Result<Option<Vec<u8>>, RenderError> {
        let pages = std::mem::take(&mut self.drawn);
        let theme = self.export.theme;
        let pixels: Vec<_> =
            pages.par_iter().map(|page| render::pixels(page, theme, PngSize::Dpi(MOVING_DPI))).collect();
        let mut animation = match self.animation.take() {
            Some(animation) => animation,
            None => {
                let rate = if let Form::Animation(rate) = self.export.form { rate } else { RATE };
                let texts = pages.first().map_or(Vec::new(), |page| render::texts(page, Some(&self.recipe)));
                Animation::new(self.pages.len(), rate, MOVING_DPI, texts)
            }
        };
        for pixels in pixels {
            animation.push(pixels?)?;
        }
        if is_last {
            return animation.finish().map(Some);
        }
        self.animation = Some(animation);
        Ok(None)
    }
}
