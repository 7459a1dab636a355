//! The evidence of this method: as fields, as sentences, and as marks in the world.

use super::index::CubeTree;
use crate::culling::depth::{DepthNote, Faces, place};
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Aabb, NodeId, PixelRect, PrimId, Vector, View};
use crate::index::{CellTree, Hierarchy};
use crate::method::evidence::{Facing, Tested, axes, integer, label, number, outline, short};
use crate::method::{Claim, Compared, Context, Field, Note, Tallied, Tally, Value};
use crate::raster::{CubeFaces, PyramidCell};
use crate::scene::Scene;

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Evidence<S: Faces> {
    /// A cell against the frustum.
    Tested(Tested<S>),
    /// A cell's size on the screen against the threshold.
    Sized(Sized),
    /// How wrong a cell's cube is, against the bound.
    Erring(Erring),
    /// A color cube was drawn for a cell.
    Cube(CubeDrawn<S::Vector>),
    /// A cell's primitives were drawn, those that no other cell had drawn before.
    Geometry { node: NodeId, references: u32 },
    /// A primitive's orientation.
    Facing(Facing),
    /// What became of a primitive.
    Settled(Settled),
    /// What was read of the depths that are drawn so far, or changed.
    Depth(DepthNote<S>),
    /// A cell against the cubes that are drawn so far.
    Saturated(Saturated),
}

impl<S: Faces> From<DepthNote<S>> for Evidence<S> {
    fn from(note: DepthNote<S>) -> Self {
        Self::Depth(note)
    }
}

/// Whether a cell is behind geometry, or cubes that let hardly any light through, wherever it could show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Saturated {
    pub node: NodeId,
    /// Pixels that it can cover; none if it crosses the near plane.
    pub pixels: PixelRect,
    /// Its nearest depth, `1/w`.
    pub nearest: f32,
    /// The first tile in which more of it would show.
    pub open: Option<PyramidCell>,
    pub is_behind: bool,
}

/// A cell's size on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sized {
    pub node: NodeId,
    /// View depth of its center, world units.
    pub depth: f32,
    /// Its side at that depth, pixels; infinite about the eye.
    pub size: f32,
    /// Pixels up to which it is drawn as a cube.
    pub threshold: f32,
}

/// How wrong a cell's color cube is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Erring {
    pub node: NodeId,
    /// Greatest difference of a channel, 0 to 1, from where between the axes it is most wrong.
    pub error: f32,
    /// Side of the cell on the screen, pixels.
    pub size: f32,
    /// What error times area may be.
    pub bound: f32,
}

impl Erring {
    /// What is compared with the bound.
    fn of_area(&self) -> f32 {
        self.error * self.size * self.size
    }
}

/// A color cube in place of what a cell holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CubeDrawn<V> {
    pub node: NodeId,
    pub cell: Aabb<V>,
    pub faces: CubeFaces,
}

/// What became of a primitive: with which cell it was drawn, or below which cell all its cells lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Settled {
    /// It was drawn with the geometry of a cell.
    Drawn { prim: PrimId, node: NodeId },
    /// Of its cells some were drawn as cubes, and none as geometry.
    InCubes { prim: PrimId, node: NodeId },
    /// All of its cells are out of view.
    OutOfView { prim: PrimId, node: NodeId },
    /// All of its cells are out of view or behind geometry.
    Behind { prim: PrimId, node: NodeId },
    /// All of its cells are out of view, or behind geometry or cubes.
    BehindCubes { prim: PrimId, node: NodeId },
}

impl Settled {
    fn about(&self) -> (PrimId, NodeId) {
        match *self {
            Self::Drawn { prim, node }
            | Self::InCubes { prim, node }
            | Self::OutOfView { prim, node }
            | Self::Behind { prim, node }
            | Self::BehindCubes { prim, node } => (prim, node),
        }
    }
}

/// What the faces of a space's cubes are called, in the order of [`CubeFaces`].
pub(super) const FACE_NAMES: [&str; 6] = ["−x", "+x", "−y", "+y", "−z", "+z"];

impl<V: Vector> CubeDrawn<V> {
    /// The numbers of the faces that an eye sees.
    pub fn facing(&self, eye: V) -> impl Iterator<Item = usize> + '_ {
        (0..2 * V::AXES).filter(move |face| {
            let axis = face / 2;
            match face % 2 {
                0 => eye.get(axis) < self.cell.min.get(axis),
                _ => eye.get(axis) > self.cell.max.get(axis),
            }
        })
    }
}

impl<S: Faces> Evidence<S> {
    /// The primitives that it says were drawn: those of a cell wholly in it, unless each was looked at.
    pub(super) fn drawn<'a>(&'a self, index: &'a CubeTree<S>, looks_at_each: bool) -> &'a [PrimId] {
        match self {
            Self::Settled(Settled::Drawn { prim, .. }) => std::slice::from_ref(prim),
            Self::Geometry { node, .. } if !looks_at_each => index.prims(*node),
            _ => &[],
        }
    }
    /// Draws the evidence in the world.
    pub(super) fn draw(
        &self,
        scene: &Scene<S>,
        view: &View<S>,
        tree: &CellTree<S::Vector>,
        to: &mut Drawing<S::Vector>,
    ) {
        match self {
            Self::Tested(n) => n.draw(view, to),
            Self::Facing(n) => n.draw(scene, view, to),
            Self::Settled(n) => outline(scene, n.about().0, to),
            Self::Cube(n) => {
                to.bounds(Layer::Emphasis, Role::Current, Subject::Node(n.node), &n.cell);
            }
            Self::Sized(n) => n.draw(&tree.cell(n.node), to),
            Self::Erring(n) => {
                to.bounds(Layer::Emphasis, Role::Current, Subject::Node(n.node), &tree.cell(n.node));
            }
            Self::Geometry { node, .. } | Self::Saturated(Saturated { node, .. }) => {
                to.bounds(Layer::Emphasis, Role::Current, Subject::Node(*node), &tree.cell(*node));
            }
            Self::Depth(n) => n.draw(scene, view, to),
        }
    }
}

impl Sized {
    /// Draws the size as text beside the middle of the cell.
    fn draw<V: Vector>(&self, cell: &Aabb<V>, to: &mut Drawing<V>) {
        to.bounds(Layer::Emphasis, Role::Current, Subject::Node(self.node), cell);
        label(to, cell.center(), format!("{} px", pixels(self.size)));
    }
}

/// A size for people: infinite about the eye.
fn pixels(size: f32) -> String {
    if size.is_finite() { short(size) } else { "∞".into() }
}

impl<S: Faces> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Tested(n) => n.tally(tally),
            Self::Sized(_) => tally.add("cells_sized", 1),
            Self::Erring(n) => tally.add("cubes_refused", (n.of_area() > n.bound).into()),
            Self::Cube(_) => tally.add("cubes_drawn", 1),
            Self::Geometry { references, .. } => {
                tally.add("cells_drawn_as_geometry", 1);
                tally.add("references_read", (*references).into());
            }
            Self::Facing(_) => Facing::tally(tally),
            Self::Settled(Settled::Drawn { .. }) => {}
            Self::Settled(Settled::InCubes { .. }) => tally.add("shared_primitives_in_cubes", 1),
            Self::Settled(_) => tally.add("shared_primitives_unseen", 1),
            // Its own word: cubes are something else here.
            Self::Depth(DepthNote::Drawn(..)) => tally.add("leaves_drawn_into_depths", 1),
            Self::Depth(n) => {
                let is_hidden = matches!(n, DepthNote::Answered(a) if a.answer.is_hidden);
                tally.add("cells_hidden", is_hidden.into());
                n.tally(tally);
            }
            Self::Saturated(n) => tally.add("cells_behind_cubes", n.is_behind.into()),
        }
    }
}

impl<S: Faces> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Tested(n) => n.kind(),
            Self::Sized(_) => "CellSized",
            Self::Erring(_) => "CubeMeasured",
            Self::Cube(_) => "CubeDrawn",
            Self::Geometry { .. } => "GeometryDrawn",
            Self::Facing(_) => "OrientationTested",
            Self::Settled(Settled::Drawn { .. }) => "PrimitiveDrawn",
            Self::Settled(_) => "SharedSettled",
            Self::Depth(DepthNote::Drawn(..)) => "DepthsDrawn",
            Self::Depth(n) => n.kind(),
            Self::Saturated(_) => "SaturationTested",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Tested(n) => n.subject(),
            Self::Sized(n) => Subject::Node(n.node),
            Self::Erring(n) => Subject::Node(n.node),
            Self::Cube(n) => Subject::Node(n.node),
            Self::Geometry { node, .. } => Subject::Node(*node),
            Self::Facing(n) => n.subject(),
            Self::Settled(n) => Subject::Prim(n.about().0),
            // That its depths are drawn is no reason for its verdict.
            Self::Depth(DepthNote::Drawn(..)) => Subject::None,
            Self::Depth(n) => n.subject(),
            Self::Saturated(n) => Subject::Node(n.node),
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            // Nothing of it lies in the view volume, so nothing of it shows.
            Self::Settled(Settled::OutOfView { .. } | Settled::Behind { .. }) => Some(Claim::Hidden),
            Self::Depth(n) => n.claim(context),
            // A cube stands for what it stands for; that proves nothing.
            _ => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            Self::Erring(n) => {
                Some(Compared::of(("error times area", n.of_area().into()), ("bound", n.bound.into())))
            }
            Self::Sized(n) => {
                Some(Compared::of(("size in pixels", n.size.into()), ("threshold", n.threshold.into())))
            }
            Self::Depth(n) => n.compared(context),
            _ => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Tested(n) => n.fields(context),
            Self::Facing(n) => n.fields(context),
            Self::Sized(n) => vec![
                integer("node", n.node.0),
                number("depth_units", n.depth.into()),
                number("size_px", n.size.into()),
                number("threshold_px", n.threshold.into()),
            ],
            Self::Erring(n) => vec![
                integer("node", n.node.0),
                number("error_ratio", n.error.into()),
                number("size_px", n.size.into()),
                number("bound_px", n.bound.into()),
            ],
            Self::Cube(n) => {
                let channels = |face: usize| n.faces.get(face).map(f64::from);
                let faces = (0..2 * S::Vector::AXES).flat_map(channels).collect();
                vec![
                    integer("node", n.node.0),
                    Field { name: "box_min", value: axes(n.cell.min) },
                    Field { name: "box_max", value: axes(n.cell.max) },
                    Field { name: "faces_rgba", value: Value::List(faces) },
                ]
            }
            Self::Geometry { node, references } => {
                vec![integer("node", node.0), integer("references", *references)]
            }
            Self::Settled(n) => {
                let (prim, node) = n.about();
                vec![integer("prim", prim.0), integer("node", node.0)]
            }
            Self::Depth(n) => n.fields(context),
            Self::Saturated(n) => n.fields(),
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        let name = S::PRIM;
        match self {
            Self::Tested(n) => n.sentence(context),
            Self::Facing(n) => n.sentence(context),
            Self::Sized(n) => size_sentence(n),
            Self::Erring(n) => format!(
                "From where the color cube of node {} is most wrong, it is so by {:.0} % in a channel; times \
                 its area on the screen that is {} against a bound of {}, so it is {}.",
                n.node,
                n.error * 100.0,
                short(n.of_area()),
                short(n.bound),
                if n.of_area() <= n.bound { "drawn" } else { "not drawn" }
            ),
            Self::Cube(n) => {
                let facing: Vec<usize> = n.facing(context.view.eye.position).collect();
                let covers =
                    |f: &usize| format!("{} covers {:.0} %", FACE_NAMES[*f], n.faces.get(*f)[3] * 100.0);
                let list = facing.iter().map(covers).collect::<Vec<_>>().join(", ");
                let verb = if facing.len() == 1 { "faces" } else { "face" };
                format!(
                    "The color cube of node {} is drawn: {} of its faces {verb} the eye. {list}.",
                    n.node,
                    facing.len()
                )
            }
            Self::Geometry { node, references: 1 } => format!("Node {node} is drawn as geometry: 1 {name}."),
            Self::Geometry { node, references } => format!(
                "Node {node} is drawn as geometry: {references} {name}s, but for those that other nodes had \
                 drawn before."
            ),
            Self::Settled(n) => n.sentence(name),
            Self::Depth(DepthNote::Drawn(node, _)) => format!(
                "The geometry of node {node} is drawn into the depths, by which cells are found that are \
                 behind it."
            ),
            Self::Depth(n) => n.sentence(context),
            Self::Saturated(n) => n.sentence(),
        }
    }
}

impl Settled {
    /// `name`: what a primitive is called.
    fn sentence(&self, name: &str) -> String {
        match self {
            Self::Drawn { prim, node } => {
                format!("The {name} {prim} is drawn, with node {node}; other nodes do not draw it again.")
            }
            Self::InCubes { prim, node } => format!(
                "The {name} {prim} lies in several nodes below node {node}, of which none was drawn as \
                 geometry: it is in color cubes alone."
            ),
            Self::OutOfView { prim, node } => format!(
                "The {name} {prim} lies in several nodes below node {node}, and all of these are outside the \
                 view."
            ),
            Self::Behind { prim, node } => format!(
                "The {name} {prim} lies in several nodes below node {node}; each of these is outside the \
                 view or behind what is drawn."
            ),
            Self::BehindCubes { prim, node } => format!(
                "The {name} {prim} lies in several nodes below node {node}; each of these is outside the \
                 view, or behind what is drawn, color cubes among it."
            ),
        }
    }
}

impl Saturated {
    fn fields(&self) -> Vec<Field> {
        let PixelRect { x0, x1, y0, y1 } = self.pixels;
        let pixels = Value::List([x0, x1, y0, y1].map(f64::from).to_vec());
        let mut fields = vec![
            integer("node", self.node.0),
            Field { name: "hidden", value: Value::Switch(self.is_behind) },
            number("nearest_depth_units", (1.0 / self.nearest).into()),
            Field { name: "pixels", value: pixels },
        ];
        if let Some(tile) = self.open {
            fields.extend([integer("column", tile.x.into()), integer("row", tile.y.into())]);
        }
        fields
    }
    fn sentence(&self) -> String {
        let node = self.node;
        match self.open {
            _ if self.is_behind => format!(
                "Node {node} is left out: wherever it could show it is behind geometry, or behind color \
                 cubes that together let less than 1/1024 of it through."
            ),
            Some(tile) => format!(
                "Node {node} may be seen: in {} neither geometry nor the color cubes before it hide it \
                 everywhere.",
                place(tile)
            ),
            None => format!("Node {node} crosses the near plane, so it counts as visible."),
        }
    }
}

fn size_sentence(n: &Sized) -> String {
    let (node, threshold) = (n.node, short(n.threshold));
    if !n.size.is_finite() {
        return format!(
            "Node {node} is about the eye or behind its near plane, so it is as large as can be."
        );
    }
    let (verb, then) = match n.size <= n.threshold {
        true => ("no larger than", "its color cube stands for it"),
        false => ("larger than", "a color cube would show"),
    };
    format!(
        "A side of node {node} is {} of a pixel wide on the screen, at depth {}: {verb} the threshold of \
         {threshold}, so {then}.",
        pixels(n.size),
        short(n.depth)
    )
}
