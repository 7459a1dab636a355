//! What the explorer starts with.

use crate::method::Settings;

/// What the explorer starts with; by default, with what was open last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// A scene: a path, or `generate:NAME`.
    pub scene: Option<String>,
    /// Key of the method.
    pub method: Option<String>,
    /// Its parameters.
    pub settings: Settings,
    /// A view file.
    pub view: Option<String>,
    /// A session file.
    pub session: Option<String>,
    /// Forgets the saved layout.
    pub reset_layout: bool,
    /// Neither reads nor writes what was open last.
    pub fresh: bool,
    /// Commands to run once everything is loaded, by name; `go-to:N`, `select:node:N`, `select:prim:N` and
    /// `frame:N` take a number.
    pub commands: Vec<String>,
    /// Writes a picture of the window and quits.
    pub shot: Option<Shot>,
}

/// A picture of the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shot {
    /// The PNG file to write.
    pub path: String,
    /// Size of the window's content, pixels.
    pub size_px: [u32; 2],
}
