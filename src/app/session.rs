//! The session file: the recipe of what is open, not the film. JSON with a version.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::any::ViewRecord;
use super::camera::ObserverCamera;
use super::file::write_whole;
use super::plate::Made;

/// Version that this program writes; it reads no later one.
pub const VERSION: u32 = 1;
/// Longest session file, bytes.
pub const LIMIT_BYTES: u64 = 16 << 20;

/// A step to come back to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bookmark {
    /// The step.
    pub step: usize,
    /// What the person wrote.
    #[serde(default)]
    pub note: String,
    /// Where the person looked from.
    #[serde(default)]
    pub observer: ObserverCamera,
}

/// What is selected, in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Picked {
    /// Nothing.
    #[default]
    None,
    /// A primitive.
    Prim(u32),
    /// A node.
    Node(u32),
    /// An object.
    Object(u32),
    /// The Eye.
    Eye,
}

/// A breakpoint, in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stop {
    /// The label of a line of pseudocode.
    Line(String),
    /// The name of a verdict.
    Verdict(String),
    /// A node.
    Node(u32),
    /// A primitive.
    Prim(u32),
    /// An object.
    Object(u32),
}

/// What is shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Shown {
    /// Primitives.
    pub prims: bool,
    /// Node boxes.
    pub nodes: bool,
    /// The Eye.
    pub eye: bool,
    /// Evidence.
    pub evidence: bool,
    /// Name of the surface style.
    pub surface: String,
    /// Name of the way to look in.
    pub look_in: String,
    /// Name of the theme.
    pub theme: String,
    /// Name of the layout.
    pub layout: String,
    /// Word of the method's picture.
    pub picture: String,
    /// Name of the scale of depths in such pictures.
    pub depths: String,
    /// Size of everything.
    pub scale: f32,
}

impl Default for Shown {
    fn default() -> Self {
        let word = String::new;
        Self {
            prims: true,
            nodes: true,
            eye: true,
            evidence: true,
            surface: word(),
            look_in: word(),
            theme: word(),
            layout: word(),
            picture: word(),
            depths: word(),
            scale: 1.0,
        }
    }
}

/// A session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// Format version.
    pub cullscope_session: u32,
    /// What to load; the path of a file is relative to the folder of the session file.
    pub scene: String,
    /// Hash of the scene then.
    #[serde(default)]
    pub scene_hash: String,
    /// Key of the method.
    #[serde(default)]
    pub method: String,
    /// Parameters that differ from their defaults.
    #[serde(default)]
    pub settings: BTreeMap<String, String>,
    /// View path and view in it.
    #[serde(default)]
    pub place: (usize, usize),
    /// The path that is followed, as a view file, if it did not come with the scene; it is then the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// The Eye.
    #[serde(default)]
    pub eye: Option<ViewRecord>,
    /// The step.
    #[serde(default)]
    pub step: usize,
    /// Whether steps are coarse.
    #[serde(default)]
    pub coarse: bool,
    /// What is selected.
    #[serde(default)]
    pub selected: Picked,
    /// Where the person looks from.
    #[serde(default)]
    pub observer: Option<ObserverCamera>,
    /// Bookmarks with notes.
    #[serde(default)]
    pub bookmarks: Vec<Bookmark>,
    /// Where runs stop.
    #[serde(default)]
    pub breakpoints: Vec<Stop>,
    /// Filter of the event tree.
    #[serde(default)]
    pub filter: String,
    /// Objects that are not shown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unshown: Vec<u32>,
    /// What is shown.
    #[serde(default)]
    pub shown: Shown,
    /// In a figure's file: how it was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub figure: Option<Made>,
}

/// Why a session was refused. Displays as one line.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The file could not be read or written.
    #[error("{path}: {why}")]
    Io {
        /// The path as given.
        path: String,
        /// The system's reason.
        why: std::io::Error,
    },
    /// The text is not a session.
    #[error("{path}: not a session file: {why}")]
    Syntax {
        /// The path as given.
        path: String,
        /// What is wrong, with line and column.
        why: serde_json::Error,
    },
    /// The file is longer than any session.
    #[error("{path}: too long for a session file")]
    TooLong {
        /// The path as given.
        path: String,
    },
    /// A picture without a session inside.
    #[error("{path}: this picture carries no session; only figures that cullscope wrote can be opened")]
    NoSession {
        /// The path as given.
        path: String,
    },
    /// The session was written by a later program.
    #[error("{path}: a session of version {found}; this program reads up to version {VERSION}")]
    TooNew {
        /// The path as given.
        path: String,
        /// Its version.
        found: u32,
    },
}

/// Writes a file whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub fn write_file(path: &str, bytes: &[u8]) -> Result<(), SessionError> {
    match write_whole(Path::new(path), |to| to.write_all(bytes).map(|()| true)) {
        Ok(_) => Ok(()),
        Err(why) => Err(SessionError::Io { path: path.into(), why }),
    }
}

impl Session {
    /// Reads a session out of text; `path` is named in errors.
    ///
    /// # Errors
    /// If it is none, or too new.
    pub fn parse(text: &str, path: &str) -> Result<Self, SessionError> {
        let session: Self =
            serde_json::from_str(text).map_err(|why| SessionError::Syntax { path: path.into(), why })?;
        if session.cullscope_session > VERSION {
            return Err(SessionError::TooNew { path: path.into(), found: session.cullscope_session });
        }
        Ok(session)
    }
    /// The text of the file.
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
    /// Reads a session file.
    ///
    /// # Errors
    /// If it cannot be read, is none, or is too new.
    pub fn read(path: &str) -> Result<Self, SessionError> {
        let io = |why| SessionError::Io { path: path.into(), why };
        let meta = std::fs::metadata(path).map_err(io)?;
        if !meta.is_file() || meta.len() > LIMIT_BYTES {
            return Err(SessionError::TooLong { path: path.into() });
        }
        Self::parse(&std::fs::read_to_string(path).map_err(io)?, path)
    }
    /// Writes a session file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &str) -> Result<(), SessionError> {
        write_file(path, self.text().as_bytes())
    }
    /// Whether a source is a session file by its name.
    pub fn is_named(source: &str) -> bool {
        source.ends_with(".session.json") || source.ends_with(".cullscope")
    }
}
