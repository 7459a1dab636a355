//! The words that commands, state, undo and session share: what is shown and how, where runs stop.

use crate::geometry::{NodeId, PrimId};
use crate::method::Verdict;

pub use crate::render::theme::Theme;
pub use crate::trace::Detail;

/// Joins changes that belong together, such as those of one drag, into one step of undo; 0 joins nothing.
pub type Gesture = u64;

/// The dialog in front of everything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialog {
    /// No dialog.
    #[default]
    None,
    /// The command palette.
    Palette,
    /// The key sheet.
    Keys,
    /// The number of a step.
    GoTo,
    /// A scene to open.
    Open,
    /// A name to save under.
    SaveAs,
    /// What was noticed while loading.
    Report,
    /// The method and its paper.
    About,
    /// The papers' tables.
    Tables,
}

/// A set of panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// All panels.
    #[default]
    Debug,
    /// For a room: big type, few panels, a caption.
    Lecture,
    /// The picture alone.
    Figure,
    /// The method's own pictures beside the scene.
    Pictures,
}

impl Layout {
    /// Every layout, in the order of menus.
    pub const ALL: [Layout; 4] = [Layout::Debug, Layout::Lecture, Layout::Figure, Layout::Pictures];
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Debug => "debug",
            Self::Lecture => "lecture",
            Self::Figure => "figure",
            Self::Pictures => "pictures",
        }
    }
}

/// How surfaces in space are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// Opaque.
    #[default]
    Solid,
    /// Edges only.
    Wire,
    /// Seen through.
    Translucent,
}

impl Surface {
    /// Every style, in the order of menus.
    pub const ALL: [Surface; 3] = [Surface::Solid, Surface::Wire, Surface::Translucent];
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::Wire => "wireframe",
            Self::Translucent => "translucent",
        }
    }
}

/// What is shown and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Primitives.
    pub prims: bool,
    /// Node boxes.
    pub nodes: bool,
    /// The Eye and its frustum.
    pub eye: bool,
    /// Evidence of the current event.
    pub evidence: bool,
    /// How surfaces are drawn.
    pub surface: Surface,
    /// Colors.
    pub theme: Theme,
    /// Panels.
    pub layout: Layout,
    /// Size of everything.
    pub scale: f32,
}

impl Default for Shown {
    fn default() -> Self {
        Self {
            prims: true,
            nodes: true,
            eye: true,
            evidence: true,
            surface: Surface::Solid,
            theme: Theme::Light,
            layout: Layout::Debug,
            scale: 1.0,
        }
    }
}

/// Where a run stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Breakpoint {
    /// At a line of pseudocode.
    Line(u8),
    /// At a verdict.
    Verdict(Verdict),
    /// At everything about a node.
    Node(NodeId),
    /// At everything about a primitive.
    Prim(PrimId),
}
