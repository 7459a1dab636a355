//! What a viewport shows, and what roles look like in it. Colors come from the theme.

use glam::Vec3;

use crate::drawing::{Layer, Role, Subject};
use crate::render::theme::{Hatch, Look};

/// What a role looks like. Colors are sRGB bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Surfaces in full light.
    pub flat: [u8; 3],
    /// Lines, outlines and patterns.
    pub stroke: [u8; 3],
    /// Width of lines.
    pub width_pt: f32,
    /// Two dashes with the gap after each; zeros for a solid line.
    pub dash_pt: [f32; 4],
    /// Inside of areas and its opacity, 0..1.
    pub fill: ([u8; 3], f32),
    /// Band under lines and around dots, and how far it reaches beyond them; 0 for none.
    pub halo_pt: ([u8; 3], f32),
    /// Inside of dots.
    pub dot: [u8; 3],
    /// Pattern over surfaces and areas.
    pub hatch: Hatch,
}

/// The look of every role.
#[derive(Clone, Debug, PartialEq)]
pub struct Palette {
    /// Behind everything.
    pub paper: [u8; 3],
    /// By role, in the order of [`Role::ALL`].
    pub paints: [Paint; Role::ALL.len()],
}

impl Palette {
    /// The palette of a theme, as certain eyes see it.
    pub fn of(look: impl Into<Look>) -> Self {
        let look = look.into();
        let paint = |role| {
            let style = look.style(role);
            let mut dash_pt = [0.0; 4];
            dash_pt.iter_mut().zip(style.dash).for_each(|(to, from)| *to = *from);
            let (halo, width_pt) = style.halo.unwrap_or((look.paper(), 0.0));
            Paint {
                flat: look.flat(role),
                stroke: style.stroke,
                width_pt: style.width_pt,
                dash_pt,
                fill: style.fill.unwrap_or((look.paper(), 0.0)),
                halo_pt: (halo, ((width_pt - style.width_pt) * 0.5).max(0.0)),
                dot: style.dot,
                // A surface has no outline to be dotted, so its inside is.
                hatch: if role == Role::Outside { Hatch::Dots } else { style.hatch },
            }
        };
        Self { paper: look.paper(), paints: Role::ALL.map(paint) }
    }
}

/// What triangles are colored by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// What was decided about them.
    #[default]
    State,
    /// Their material.
    Material,
}

/// How triangles are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// Filled.
    #[default]
    Solid,
    /// Their edges only; sides inside a flat face are left out.
    Wireframe,
    /// Filled, with edges.
    Both,
    /// Not at all.
    Hidden,
}

/// How triangles of one state are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shown {
    /// As the [`Surface`] says.
    #[default]
    Solid,
    /// See-through, hiding nothing.
    Ghost,
    /// Not at all.
    Not,
}

/// Which node boxes are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NodeBoxes {
    /// None.
    #[default]
    None,
    /// Where the traversal stands: nodes decided as a whole, leaves, and those still open.
    Frontier,
    /// All that were entered, from one level to another, both included.
    Levels(u32, u32),
}

/// What a viewport shows.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceStyle {
    /// The step whose state is shown; scrubbing changes only this.
    pub step: usize,
    /// What triangles are colored by.
    pub color_by: ColorBy,
    /// How triangles are drawn.
    pub surface: Surface,
    /// Triangles in the answer.
    pub kept: Shown,
    /// Triangles culled, approximated or left out.
    pub culled: Shown,
    /// Triangles not yet decided.
    pub undecided: Shown,
    /// Leave out triangles that turn their back to the camera: opens rooms to a look from above.
    pub only_fronts: bool,
    /// Cut away points with `n·p + d < 0`.
    pub section: Option<(Vec3, f32)>,
    /// Node boxes.
    pub nodes: NodeBoxes,
    /// Whether what stands for triangles is among the marks: then neither these are drawn nor boxes of nodes
    /// that they are in.
    pub stand_ins: bool,
    /// Layers of the marks that are left out.
    pub without: Vec<Layer>,
    /// Triangles, nodes and objects outlined in a role, such as selected and current ones.
    pub highlights: Vec<(Subject, Role)>,
    /// Opacity of ghosts, 0..1.
    pub ghost: f32,
    /// Opacity of lines behind surfaces, 0..1.
    pub behind: f32,
    /// Pixels a point: widths and patterns scale with it.
    pub pixels_per_point: f32,
    /// Leave the background transparent.
    pub transparent: bool,
    /// What roles look like.
    pub palette: Palette,
}

impl SpaceStyle {
    /// For an Observer: everything, what was culled as ghosts, the frontier of nodes.
    pub fn observer(step: usize, palette: Palette) -> Self {
        Self {
            step,
            color_by: ColorBy::State,
            surface: Surface::Solid,
            kept: Shown::Solid,
            culled: Shown::Ghost,
            undecided: Shown::Solid,
            only_fronts: false,
            section: None,
            nodes: NodeBoxes::Frontier,
            stand_ins: false,
            without: Vec::new(),
            highlights: Vec::new(),
            ghost: 0.25,
            behind: 0.25,
            pixels_per_point: 1.0,
            transparent: false,
            palette,
        }
    }
    /// For the Eye: only what the answer holds so far, with no help lines.
    pub fn eye(step: usize, palette: Palette) -> Self {
        Self {
            culled: Shown::Not,
            undecided: Shown::Not,
            nodes: NodeBoxes::None,
            without: vec![Layer::Frustum, Layer::Eye, Layer::Evidence, Layer::Areas],
            ..Self::observer(step, palette)
        }
    }
    /// Whether and how triangles of a role are drawn.
    pub(super) fn shown(&self, role: Role) -> Shown {
        match role {
            Role::Approximated if self.stand_ins => Shown::Not,
            Role::Visible => self.kept,
            Role::Scene | Role::Undecided => self.undecided,
            // What was culled wrongly is never only a ghost.
            Role::Wrong if self.culled == Shown::Ghost => Shown::Solid,
            _ => self.culled,
        }
    }
}
