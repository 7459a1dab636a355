//! The words that commands, state, undo and session share: what is shown and how, where runs stop.

use crate::geometry::{NodeId, ObjectId, PrimId};
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
    /// What a figure shows and how it looks.
    Figure,
    /// What was noticed while loading.
    Report,
    /// The method and its paper.
    About,
    /// The papers' tables.
    Tables,
    /// Speed against error, and advice.
    Laboratory,
    /// Scenes where methods fail.
    Failures,
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

/// How the Observer looks into what is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LookIn {
    /// Not at all: a roof hides what is below it.
    #[default]
    Off,
    /// What lies higher than the Eye is cut away.
    Cut,
    /// Faces that turn their back to the Observer are left out.
    Faces,
}

impl LookIn {
    /// Every way, in the order of menus.
    pub const ALL: [LookIn; 3] = [LookIn::Off, LookIn::Cut, LookIn::Faces];
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Cut => "cut",
            Self::Faces => "faces",
        }
    }
    /// Its name in menus.
    pub fn title(self) -> &'static str {
        match self {
            Self::Off => "closed",
            Self::Cut => "cut above the Eye",
            Self::Faces => "without backs",
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
    /// How the Observer looks into what is closed.
    pub look_in: LookIn,
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
            look_in: LookIn::Off,
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
    /// At everything about an object or a primitive of it.
    Object(ObjectId),
}
