//! What a figure shows and how it is made, and the words for it in files and on the command line.

use serde::{Deserialize, Serialize};

use super::shown::Theme;
use crate::figure::Paper;

/// What a figure shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Picture {
    /// The scene from outside.
    #[default]
    Observer,
    /// What the Eye sees.
    Eye,
    /// The pseudocode.
    Code,
    /// A picture of the method, by its number.
    Own(usize),
}

/// How a figure is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Export {
    /// What it shows.
    pub picture: Picture,
    /// Its size.
    pub paper: Paper,
    /// Its colors.
    pub theme: Theme,
    /// Whether letters of SVG files are outlines.
    pub outline_text: bool,
    /// Width over height of the Observer's picture.
    pub aspect: f32,
    /// Whether surfaces of the Observer's picture of space are vectors that hide each other; else pixels.
    pub is_vector: bool,
}

/// How a figure was made, in its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// The command that makes it again, in the folder of the file.
    pub command: String,
    /// Word of the picture.
    pub picture: String,
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

/// Papers by the words of files and the command line.
pub const PAPERS: [(&str, Paper); 3] =
    [("column", Paper::Column), ("page", Paper::TwoColumns), ("slide", Paper::Slide)];

impl Export {
    /// The word of its paper; that of a page of any other size is `page`.
    pub fn paper_word(&self) -> &'static str {
        PAPERS.iter().find(|(_, paper)| *paper == self.paper).map_or("page", |(word, _)| word)
    }
    /// `fonts` or `paths`.
    pub fn text_word(&self) -> &'static str {
        if self.outline_text { "paths" } else { "fonts" }
    }
}

/// A name as one word of a file or of the command line.
pub fn word(name: &str) -> String {
    let parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-").to_lowercase()
}
