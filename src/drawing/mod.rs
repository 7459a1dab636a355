//! A picture as a value: marks with roles, subjects and layers. No color, no GUI.
//!
//! A [`Drawing`] is in paper coordinates (points of 1/72 inch, y down) when it is a
//! `Drawing<Vec2>` with a size; the same list in world coordinates (`Drawing<S::Vector>`) is what
//! methods explain themselves with, and `figure` puts it on paper. Screen, SVG, PDF and PNG are
//! readers of one list, so they cannot disagree.

pub mod metrics;
mod plot;
pub mod words;

pub use plot::{Curve, Plot, Series, Shape, Tradeoff, Tried};

use std::sync::Arc;

use glam::Vec2;

use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Vector};

/// What a mark stands for, so that hovering, picking and SVG ids come free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// Decoration.
    #[default]
    None,
    /// A primitive of the scene.
    Prim(PrimId),
    /// A node of the index.
    Node(NodeId),
    /// An object of the scene.
    Object(ObjectId),
    /// A plane of the view frustum.
    Plane(u8),
    /// The Eye.
    Eye,
    /// A point of a chart or map, by its number: what was tried there, such as a configuration.
    Tried(u32),
}

/// Meaning, not color: the theme turns roles into stroke, fill, dash and hatch at the last moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Text, axes, frames.
    Ink,
    /// Secondary text, grids, ticks.
    Faint,
    /// The scene before anything is known about it.
    Scene,
    /// In the queue or not yet decided.
    Undecided,
    /// Entered, still open: some part of it was kept, some was not.
    Partial,
    /// In the answer.
    Visible,
    /// Culled by occlusion.
    Hidden,
    /// Culled as outside the view frustum.
    Outside,
    /// Culled as facing away from the Eye.
    FacesAway,
    /// Hides something.
    Occluder,
    /// Replaced by a stand-in, or left out by a budget.
    Approximated,
    /// Culled although it is visible.
    Wrong,
    /// What the current step is about.
    Current,
    /// What the person selected.
    Selected,
    /// The Eye, its frustum and line of sight.
    Eye,
    /// A plane or line that a test uses.
    Evidence,
    /// The paper itself.
    Paper,
}

impl Role {
    /// The states of a primitive or node, which a picture must keep apart without color too.
    pub const STATES: [Role; 9] = [
        Role::Undecided,
        Role::Partial,
        Role::Visible,
        Role::Hidden,
        Role::Outside,
        Role::FacesAway,
        Role::Occluder,
        Role::Approximated,
        Role::Wrong,
    ];
    /// Every role, in the order of legends.
    pub const ALL: [Role; 17] = [
        Role::Ink,
        Role::Faint,
        Role::Scene,
        Role::Undecided,
        Role::Partial,
        Role::Visible,
        Role::Hidden,
        Role::Outside,
        Role::FacesAway,
        Role::Occluder,
        Role::Approximated,
        Role::Wrong,
        Role::Current,
        Role::Selected,
        Role::Eye,
        Role::Evidence,
        Role::Paper,
    ];
    /// Kebab-case name: CSS class, layer name, legend key.
    pub fn name(self) -> &'static str {
        match self {
            Role::Ink => "ink",
            Role::Faint => "faint",
            Role::Scene => "scene",
            Role::Undecided => "undecided",
            Role::Partial => "partial",
            Role::Visible => "visible",
            Role::Hidden => "hidden",
            Role::Outside => "outside",
            Role::FacesAway => "faces-away",
            Role::Occluder => "occluder",
            Role::Approximated => "approximated",
            Role::Wrong => "wrong",
            Role::Current => "current",
            Role::Selected => "selected",
            Role::Eye => "eye",
            Role::Evidence => "evidence",
            Role::Paper => "paper",
        }
    }
}

/// Named groups of marks, painted in this order; groups of an SVG file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// Backgrounds.
    Ground,
    /// Areas under everything: regions, node interiors, the seen wedge.
    Areas,
    /// The scene's primitives.
    Scene,
    /// Node boxes.
    Nodes,
    /// The view frustum.
    Frustum,
    /// Planes, lines and samples that a test used.
    Evidence,
    /// Current and selected things.
    Emphasis,
    /// The Eye.
    Eye,
    /// Labels in the picture.
    Labels,
    /// Legend.
    Legend,
    /// Title and caption.
    Caption,
}

impl Layer {
    /// Kebab-case name of the group.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Ground => "ground",
            Layer::Areas => "areas",
            Layer::Scene => "scene",
            Layer::Nodes => "nodes",
            Layer::Frustum => "frustum",
            Layer::Evidence => "evidence",
            Layer::Emphasis => "emphasis",
            Layer::Eye => "eye",
            Layer::Labels => "labels",
            Layer::Legend => "legend",
            Layer::Caption => "caption",
        }
    }
}

/// Where a text's anchor point lies on its baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its beginning.
    Start,
    /// In the middle.
    Middle,
    /// At its end.
    End,
}

/// Which of the three embedded fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Font {
    /// Running text.
    Regular,
    /// Titles.
    Bold,
    /// Code and numbers.
    Mono,
}

/// An RGBA picture that is shown one pixel a cell, never smoothed.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Columns.
    pub width: u32,
    /// Rows; row 0 at the top.
    pub height: u32,
    /// `4 · width · height` bytes, not premultiplied, sRGB.
    pub rgba: Arc<[u8]>,
}

/// One mark; points are on paper or in a world, sizes (`_pt`) are always on paper.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark<P> {
    /// A polyline, or an outline if closed.
    Line {
        /// Its points.
        points: Vec<P>,
        /// Whether the last point joins the first.
        closed: bool,
    },
    /// A filled convex polygon with its outline.
    Area(Vec<P>),
    /// A filled convex polygon in a color that is data, such as a cube face's; its outline is that of its
    /// role, so that nothing is told by color alone.
    Swatch {
        /// Its corners.
        points: Vec<P>,
        /// sRGB, and opacity; not premultiplied.
        rgba: [u8; 4],
    },
    /// A filled convex polygon that hides what was painted before it, of which only some sides are outlined,
    /// in the pattern of its role.
    Facet {
        /// Its corners.
        points: Vec<P>,
        /// Whether the side from each corner to the next one is outlined.
        is_edge: Vec<bool>,
        /// sRGB; without it there is the outline alone.
        rgb: Option<[u8; 3]>,
    },
    /// A line with an arrow head at its end.
    Arrow(P, P),
    /// A filled circle.
    Dot {
        /// Its center.
        at: P,
        /// Its radius.
        radius_pt: f32,
    },
    /// A line of text.
    Text {
        /// Its anchor on the baseline.
        at: P,
        /// The words.
        text: String,
        /// Font size.
        size_pt: f32,
        /// Where the anchor is.
        anchor: Anchor,
        /// Which font.
        font: Font,
    },
    /// A pixel picture in the rectangle from the first corner (top left) to the second.
    Image {
        /// Top left and bottom right.
        corners: [P; 2],
        /// The picture.
        pixels: Pixels,
    },
}

impl<P: Copy> Mark<P> {
    /// The same mark with each point moved; sizes on paper stay.
    pub fn mapped(&self, f: impl Fn(P) -> P) -> Self {
        let mut mark = self.clone();
        match &mut mark {
            Self::Line { points, .. }
            | Self::Area(points)
            | Self::Swatch { points, .. }
            | Self::Facet { points, .. } => {
                points.iter_mut().for_each(|p| *p = f(*p));
            }
            Self::Arrow(a, b) => (*a, *b) = (f(*a), f(*b)),
            Self::Dot { at, .. } | Self::Text { at, .. } => *at = f(*at),
            Self::Image { corners, .. } => *corners = corners.map(f),
        }
        mark
    }
}

/// A mark with what it means.
#[derive(Clone, Debug, PartialEq)]
pub struct Item<P> {
    /// The shape.
    pub mark: Mark<P>,
    /// Its meaning.
    pub role: Role,
    /// What it stands for.
    pub subject: Subject,
    /// Its group.
    pub layer: Layer,
}

/// Marks in paint order (readers paint layer by layer, in order within a layer).
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing<P = Vec2> {
    /// Width and height on paper; zero for a drawing in world coordinates.
    pub size_pt: Vec2,
    /// The marks.
    pub items: Vec<Item<P>>,
    /// One line for file metadata and screen readers.
    pub title: String,
    /// What the picture shows, for people who do not see it.
    pub description: String,
}

impl<P> Default for Drawing<P> {
    fn default() -> Self {
        Self { size_pt: Vec2::ZERO, items: Vec::new(), title: String::new(), description: String::new() }
    }
}

impl Font {
    /// The three fonts.
    pub const ALL: [Font; 3] = [Font::Regular, Font::Bold, Font::Mono];
    /// Name of the CSS class and of the family in a GUI.
    pub fn name(self) -> &'static str {
        match self {
            Font::Regular => "regular",
            Font::Bold => "bold",
            Font::Mono => "mono",
        }
    }
}

impl<P> Drawing<P> {
    /// Adds a mark.
    pub fn push(&mut self, layer: Layer, role: Role, subject: Subject, mark: Mark<P>) {
        self.items.push(Item { mark, role, subject, layer });
    }
    /// Adds a line of points.
    pub fn line(&mut self, layer: Layer, role: Role, subject: Subject, points: impl Into<Vec<P>>) {
        self.push(layer, role, subject, Mark::Line { points: points.into(), closed: false });
    }
    /// Adds a closed outline.
    pub fn outline(&mut self, layer: Layer, role: Role, subject: Subject, points: impl Into<Vec<P>>) {
        self.push(layer, role, subject, Mark::Line { points: points.into(), closed: true });
    }
    /// Adds text in the regular font.
    pub fn text(
        &mut self,
        layer: Layer,
        role: Role,
        at: P,
        size_pt: f32,
        anchor: Anchor,
        text: impl Into<String>,
    ) {
        self.push(
            layer,
            role,
            Subject::None,
            Mark::Text { at, text: text.into(), size_pt, anchor, font: Font::Regular },
        );
    }
    /// Items in the order in which they are painted: by layer, then as added.
    pub fn painted(&self) -> Vec<&Item<P>> {
        let mut items: Vec<_> = self.items.iter().collect();
        items.sort_by_key(|i| i.layer);
        items
    }
}

impl Drawing {
    /// The same drawing larger or smaller, with its text; the widths of lines stay.
    pub fn scaled(mut self, factor: f32) -> Self {
        self.size_pt *= factor;
        for item in &mut self.items {
            item.mark = item.mark.mapped(|p| p * factor);
            match &mut item.mark {
                Mark::Text { size_pt, .. } => *size_pt *= factor,
                Mark::Dot { radius_pt, .. } => *radius_pt *= factor,
                _ => {}
            }
        }
        self
    }
}

impl<V: Vector> Drawing<V> {
    /// Adds the edges of a box: one outline in the plane, twelve lines in space.
    pub fn bounds(&mut self, layer: Layer, role: Role, subject: Subject, bounds: &Aabb<V>) {
        if V::AXES == 2 {
            self.outline(layer, role, subject, [0, 1, 3, 2].map(|i| bounds.corner(i)));
        } else {
            for (a, b) in Aabb::<V>::edges() {
                self.line(layer, role, subject, [bounds.corner(a), bounds.corner(b)]);
            }
        }
    }
}
