//! What a figure shows and how it is made, and the words for it in files and on the command line.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::shown::Theme;
use crate::figure::Paper;
use crate::render::Format;

/// What a figure shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Picture {
    /// The scene from outside.
    #[default]
    Observer,
    /// What the Eye sees.
    Eye,
    /// The pseudocode.
    Code,
    /// In space: the flatland twin.
    Twin,
    /// A picture of the method, by its number.
    Own(usize),
}

/// Steps of a run, one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// The first.
    pub from: usize,
    /// The last, if the stride leads to it.
    pub to: usize,
    /// How many at a time, at least 1.
    pub stride: usize,
}

impl Steps {
    /// Each of them.
    pub fn all(self) -> impl Iterator<Item = usize> {
        (self.from..=self.to).step_by(self.stride.max(1))
    }
}

impl fmt::Display for Steps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self { from, to, stride: 1 } => write!(f, "{from}..{to}"),
            Self { from, to, stride } => write!(f, "{from}..{to}..{stride}"),
        }
    }
}

impl FromStr for Steps {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<usize>> = text.split("..").map(|part| part.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[from, to]) if from <= to => Ok(Self { from, to, stride: 1 }),
            Some(&[from, to, stride]) if from <= to && stride > 0 => Ok(Self { from, to, stride }),
            _ => Err("expected steps such as 0..40 or 0..400..10".into()),
        }
    }
}

/// How several steps are one file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Form {
    /// Beside each other on one page.
    #[default]
    Page,
    /// The pages of a PDF file.
    Pages,
    /// An animated PNG file, of so many a second.
    Animation(f32),
}

impl Form {
    /// Its word in files and on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Page => "page",
            Self::Pages => "pages",
            Self::Animation(_) => "animation",
        }
    }
}

/// Pixels an inch of pictures of space, and of those that move, which are for screens.
const DPI: f32 = 300.0;
pub(super) const MOVING_DPI: f32 = 150.0;

/// Steps a second of an animation, unless others are asked for.
pub const RATE: f32 = 10.0;

/// How a figure is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// What it shows, several beside each other; nothing stands for the Observer's picture.
    pub pictures: Vec<Picture>,
    /// The steps that it shows; `None`: the one at hand.
    pub steps: Option<Steps>,
    /// How these are one file.
    pub form: Form,
    /// Its size.
    pub paper: Paper,
    /// Its colors.
    pub theme: Theme,
    /// Whether letters of SVG files are outlines.
    pub outline_text: bool,
    /// Width over height of the Observer's picture; `None`: to fit the scene.
    pub aspect: Option<f32>,
    /// Whether surfaces of the Observer's picture of space are vectors that hide each other; else pixels.
    pub is_vector: bool,
}

/// How a figure was made, in its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// The command that makes it again, in the folder of the file.
    pub command: String,
    /// Words of the pictures, with commas.
    pub picture: String,
    /// See [`Export::steps`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<String>,
    /// Word of the [`Form`], where there are steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// Steps a second of an animation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f32>,
    /// Word of the paper.
    pub paper: String,
    /// Name of the theme.
    pub theme: String,
    /// `fonts` or `paths`.
    pub text: String,
    /// Width over height of the Observer's picture.
    pub aspect: f32,
    /// See [`Export::is_vector`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub vectors: bool,
}

impl Default for Export {
    /// The Observer's picture as wide as a page, in print.
    fn default() -> Self {
        Self {
            pictures: Vec::new(),
            steps: None,
            form: Form::Page,
            paper: Paper::TwoColumns,
            theme: Theme::Print,
            outline_text: false,
            aspect: None,
            is_vector: false,
        }
    }
}

impl Export {
    /// What it shows, at least one.
    pub fn shown(&self) -> &[Picture] {
        if self.pictures.is_empty() { &[Picture::Observer] } else { &self.pictures }
    }
    pub(super) fn dpi(&self) -> f32 {
        if matches!(self.form, Form::Animation(_)) { MOVING_DPI } else { DPI }
    }
    /// `fonts` or `paths`.
    pub fn text_word(&self) -> &'static str {
        if self.outline_text { "paths" } else { "fonts" }
    }
    /// That its form has files of this format.
    ///
    /// # Errors
    /// Which it has, in a line.
    pub fn fits(&self, format: Format) -> Result<(), String> {
        match (self.form, format) {
            (Form::Page, _) | (Form::Pages, Format::Pdf) | (Form::Animation(_), Format::Png) => Ok(()),
            (Form::Pages, _) => Err("only pdf has several pages".into()),
            (Form::Animation(_), _) => Err("animations are png".into()),
        }
    }
}

/// A name as one word of a file or of the command line.
pub fn word(name: &str) -> String {
    let parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-").to_lowercase()
}
