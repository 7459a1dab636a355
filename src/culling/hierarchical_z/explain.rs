//! The evidence of this method: as fields, as sentences, and as marks in the world.

use std::marker::PhantomData;

use super::line;
use super::simulation::{Job, Unit, Worked};
use crate::culling::depth::{Answer, Buffer, Faces, Listener, Read};
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Aabb, NodeId, PixelRect, PrimId, Vector, View};
use crate::method::evidence::{Facing, Tested, axes, integer, label, number, outline, short};
use crate::method::{Claim, Context, Event, Field, Note, Observer, Tallied, Tally, Value};
use crate::raster::{Extent, Options, PyramidCell};
use crate::scene::Scene;

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub enum Evidence<S: Faces> {
    /// A cube is on the visible list: it is drawn without a test (true), or was.
    Listed(NodeId, bool),
    /// A cube left the visible list.
    Unlisted(NodeId),
    /// A box against the frustum.
    Tested(Tested<S>),
    /// A cell of the pyramid was compared with a face of a cube's box.
    Read(NodeId, Read),
    /// A tile of the pyramid was brought up to date.
    Refreshed(PyramidCell),
    /// The tiles under a rectangle were brought up to date, unless more were stale than the number says.
    RefreshedUnder(PixelRect, u32),
    /// The whole pyramid was brought up to date.
    RefreshedAll,
    /// A cube's box was asked for.
    Answered(Answered<S>),
    /// A primitive was drawn, or left out because it lies behind its cells.
    Rasterized(Rasterized),
    /// A primitive that several cubes share was in none that can be seen.
    SharedUnseen(PrimId, NodeId),
    /// A primitive's orientation.
    Facing(Facing),
    /// What is due at the end of a frame.
    Checked(Check),
    /// A unit of the simulated machine worked.
    Worked(Worked),
}

/// Whether the visible list is checked at the end of a frame, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// Frames since the last check, this one included.
    pub frames: u32,
    /// Frames between checks.
    pub interval: u32,
    /// Cubes that came onto the list in this frame, and all on it.
    pub added: u32,
    pub listed: u32,
    /// The farthest depth of the image, `1/w`, in this frame and in the one before.
    pub farthest: [f32; 2],
    /// Whether it is made.
    pub is_due: bool,
}

/// Whose box is asked for, at which line of the pseudocode, and who is told of what the query reads.
pub struct Asked<'a, S, O> {
    node: NodeId,
    line: u8,
    watch: &'a mut O,
    space: PhantomData<S>,
}

impl<'a, S: Faces, O: Observer<Evidence<S>>> Asked<'a, S, O> {
    pub fn new(node: NodeId, line: u8, watch: &'a mut O) -> Self {
        Self { node, line, watch, space: PhantomData }
    }
}

impl<S: Faces, O: Observer<Evidence<S>>> Listener for Asked<'_, S, O> {
    #[inline]
    fn refreshes(&mut self, cell: PyramidCell) {
        self.watch.note(|| Evidence::Refreshed(cell));
    }
    #[inline]
    fn reads(&mut self, read: Read) {
        let node = self.node;
        self.watch.event(Event::Line(if read.face.is_none() && self.line == line::BEHIND {
            line::WHOLE
        } else {
            self.line
        }));
        self.watch.note(move || Evidence::Read(node, read));
    }
}

/// A box was asked for, and this was the answer.
#[derive(Clone, Copy, Debug)]
pub struct Answered<S: Faces> {
    pub node: NodeId,
    pub bounds: Aabb<S::Vector>,
    /// Pixels that it can cover; empty if it falls between them.
    pub pixels: PixelRect,
    pub answer: Answer,
    /// It reaches the near plane, so it counts as visible.
    pub crosses_near: bool,
}

/// A primitive was compared with its cells and drawn, or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rasterized {
    pub prim: PrimId,
    /// What was compared: where it can show and how near it comes, and the farthest depth held there. `None`
    /// if it covers no pixel or had to be clipped: then it is drawn without a test.
    pub operands: Option<(Extent, f32)>,
    pub is_hidden: bool,
    /// Whether the pyramid was asked.
    pub is_sieved: bool,
    pub backface_culling: bool,
    /// The part of the image it was drawn in, if not all.
    pub window: Option<PixelRect>,
}

/// View depth of a depth, world units.
pub fn units(depth: f32) -> f32 {
    1.0 / depth
}

impl<S: Faces> Evidence<S> {
    /// Changes the large state as the run did.
    pub fn apply(&self, buffer: &mut Buffer<S>, scene: &Scene<S>) {
        match *self {
            Self::Refreshed(cell) => buffer.refresh(cell),
            Self::RefreshedUnder(pixels, most) => _ = buffer.refresh_under(pixels, most as usize),
            Self::RefreshedAll => buffer.refresh_all(),
            Self::Rasterized(n) if !n.is_hidden => {
                let options =
                    Options { backface_culling: n.backface_culling, window: n.window, ..Options::default() };
                // One by one leads where the run came to with many at once: what the pyramid holds, and so
                // what is left out, changes with its refreshes alone.
                if n.is_sieved {
                    buffer.draw(scene, &[n.prim], &options);
                } else {
                    buffer.draw_all(scene, &[n.prim], &options);
                }
            }
            _ => {}
        }
    }
    /// Draws the evidence in the world.
    pub fn draw(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        match self {
            Self::Tested(n) => n.draw(view, to),
            Self::Facing(n) => n.draw(scene, view, to),
            Self::Answered(n) => n.draw(view, to),
            Self::Rasterized(n) => {
                outline(scene, n.prim, to);
                if let Some((extent, held)) = n.operands {
                    behind(view, extent.pixels, extent.nearest, held, to);
                }
            }
            Self::SharedUnseen(prim, _) => outline(scene, *prim, to),
            Self::Read(_, n) => {
                let size = (view.width, view.height);
                behind(view, n.cell.pixels(size.0, size.1), n.nearest, n.held, to);
            }
            _ => {}
        }
    }
}

/// The lines of sight around some pixels, as far as the surfaces that are drawn there; and where the thing
/// asked for begins.
fn behind<S: Faces>(view: &View<S>, pixels: PixelRect, nearest: f32, held: f32, to: &mut Drawing<S::Vector>) {
    let projection = view.projection();
    let image_axes = S::Vector::AXES - 1;
    let at = |x: u32, y: u32, w: f32| {
        // The rows are orthogonal; dividing by the squared length undoes their scale.
        let image = [x as f32 / view.width as f32 * 2.0 - 1.0, 1.0 - y as f32 / view.height as f32 * 2.0];
        let forward = projection.rows[image_axes];
        let ray = (0..image_axes).fold(forward, |r, a| {
            let row = projection.rows[a];
            r + row * (image[a] / row.dot(row))
        });
        projection.eye + ray * w
    };
    let corners: &[(u32, u32)] = if image_axes == 1 {
        &[(pixels.x0, 0), (pixels.x1, 0)]
    } else {
        &[(pixels.x0, pixels.y0), (pixels.x1, pixels.y0), (pixels.x1, pixels.y1), (pixels.x0, pixels.y1)]
    };
    let (far, near) = (units(held).min(view.eye.far), units(nearest).min(view.eye.far));
    for &(x, y) in corners {
        to.line(Layer::Evidence, Role::Faint, Subject::None, [view.eye.position, at(x, y, far)]);
    }
    let section = |w: f32| corners.iter().map(|&(x, y)| at(x, y, w)).collect::<Vec<_>>();
    to.outline(Layer::Evidence, Role::Occluder, Subject::None, section(far));
    to.outline(Layer::Evidence, Role::Current, Subject::None, section(near));
    // At opposite corners, so that they do not meet.
    label(to, at(pixels.x0, pixels.y0, far), format!("drawn to {}", short(far)));
    label(to, at(pixels.x1, pixels.y1, near), format!("nearest {}", short(near)));
}

impl<S: Faces> Answered<S> {
    fn draw(&self, view: &View<S>, to: &mut Drawing<S::Vector>) {
        to.bounds(Layer::Emphasis, Role::Current, Subject::Node(self.node), &self.bounds);
        if let (Some((cell, held)), false) = (self.answer.decisive, self.crosses_near) {
            behind(view, cell.pixels(view.width, view.height), self.answer.nearest, held, to);
        }
    }
    fn sentence(&self) -> String {
        let (node, near) = (self.node, short(units(self.answer.nearest)));
        if self.crosses_near {
            return format!("Node {node} reaches the near plane, so it counts as visible.");
        }
        let reads = self.answer.reads;
        let cells = if reads == 1 { "one cell was".into() } else { format!("{reads} cells were") };
        match (self.answer.decisive, self.answer.is_hidden) {
            (None, _) => {
                format!("The image of node {node} falls between the pixels' centers: nothing of it can show.")
            }
            (Some((cell, held)), true) => format!(
                "Node {node} is hidden: its nearest point, at depth {near}, lies behind all that is drawn in \
                 its place. {cells} read; the closest is {}, where the farthest thing drawn is at {}, nearer \
                 by {}.",
                place(cell),
                short(units(held)),
                short(units(self.answer.nearest) - units(held))
            ),
            (Some((cell, held)), false) => format!(
                "Node {node} may be seen: it comes as near as {near}, and {} shows nothing nearer than {}, \
                 which is {} beyond. {cells} read.",
                place(cell),
                short(units(held)),
                short(units(held) - units(self.answer.nearest))
            ),
        }
    }
    fn fields(&self) -> Vec<Field> {
        let mut fields = vec![
            integer("node", self.node.0),
            Field { name: "hidden", value: Value::Switch(self.answer.is_hidden) },
            Field { name: "crosses_near", value: Value::Switch(self.crosses_near) },
            number("nearest_depth_units", units(self.answer.nearest).into()),
            integer("cells_read", self.answer.reads),
            pixels_field(self.pixels),
            Field { name: "box_min", value: axes(self.bounds.min) },
            Field { name: "box_max", value: axes(self.bounds.max) },
        ];
        if let Some((cell, held)) = self.answer.decisive {
            fields.extend(cell_fields(cell));
            fields.push(number("held_depth_units", units(held).into()));
            fields
                .push(number("margin_units", f64::from(units(self.answer.nearest)) - f64::from(units(held))));
        }
        fields
    }
}

fn pixels_field(r: PixelRect) -> Field {
    Field { name: "pixels", value: Value::List([r.x0, r.x1, r.y0, r.y1].map(f64::from).to_vec()) }
}
fn cell_fields(cell: PyramidCell) -> [Field; 3] {
    [integer("level", cell.level.into()), integer("column", cell.x.into()), integer("row", cell.y.into())]
}

/// A cell in words.
pub fn place(cell: PyramidCell) -> String {
    match cell.level {
        0 => format!("pixel ({}, {})", cell.x, cell.y),
        level => format!("cell ({}, {}) of level {level}", cell.x, cell.y),
    }
}

impl<S: Faces> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Listed(_, is_drawn) => tally.add("cubes_drawn_from_list", (*is_drawn).into()),
            Self::Unlisted(_) => tally.add("cubes_unlisted", 1),
            Self::Tested(n) => n.tally(tally),
            Self::Read(..) => tally.add("cells_read", 1),
            Self::Refreshed(_) => tally.add("tiles_refreshed", 1),
            Self::RefreshedUnder(..) | Self::RefreshedAll => tally.add("refreshes", 1),
            Self::Answered(_) => tally.add("queries", 1),
            Self::Rasterized(n) => {
                tally.add(if n.is_hidden { "primitives_behind" } else { "primitives_drawn" }, 1)
            }
            Self::SharedUnseen(..) => tally.add("shared_primitives_unseen", 1),
            Self::Facing(_) => Facing::tally(tally),
            Self::Checked(n) => tally.add("checks", n.is_due.into()),
            Self::Worked(n) => n.tally(tally),
        }
    }
}

impl<S: Faces> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Listed(..) => "CubeListed",
            Self::Unlisted(_) => "CubeUnlisted",
            Self::Tested(n) => n.kind(),
            Self::Read(..) => "CellRead",
            Self::Refreshed(_) => "TileRefreshed",
            Self::RefreshedUnder(..) => "TilesRefreshed",
            Self::RefreshedAll => "PyramidRefreshed",
            Self::Answered(_) => "ObscurationTested",
            Self::Rasterized(n) => {
                if n.is_hidden {
                    "PrimitiveBehind"
                } else {
                    "PrimitiveRasterized"
                }
            }
            Self::SharedUnseen(..) => "SharedUnseen",
            Self::Facing(_) => "OrientationTested",
            Self::Checked(_) => "ListChecked",
            Self::Worked(n) => n.kind(),
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Listed(n, _) | Self::Unlisted(n) | Self::Read(n, _) => Subject::Node(*n),
            Self::Tested(n) => n.subject(),
            Self::Answered(n) => Subject::Node(n.node),
            Self::Rasterized(n) => Subject::Prim(n.prim),
            Self::SharedUnseen(prim, _) => Subject::Prim(*prim),
            Self::Facing(n) => n.subject(),
            Self::Worked(n) => Subject::Node(n.node),
            Self::Refreshed(_) | Self::RefreshedUnder(..) | Self::RefreshedAll | Self::Checked(_) => {
                Subject::None
            }
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            _ => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Listed(n, _) | Self::Unlisted(n) => vec![integer("node", n.0)],
            Self::Tested(n) => n.fields(context),
            Self::Read(node, n) => {
                let mut fields = vec![integer("node", node.0)];
                fields.extend(n.face.map(|face| integer("face", face.into())));
                fields.extend(cell_fields(n.cell));
                fields.push(number("face_depth_units", units(n.nearest).into()));
                fields.push(number("held_depth_units", units(n.held).into()));
                fields.push(Field { name: "outcome", value: Value::Word(n.outcome.word().into()) });
                fields
            }
            Self::Refreshed(cell) => cell_fields(*cell).to_vec(),
            Self::RefreshedUnder(pixels, most) => vec![pixels_field(*pixels), integer("most_tiles", *most)],
            Self::RefreshedAll => vec![],
            Self::Answered(n) => n.fields(),
            Self::Rasterized(n) => {
                let mut fields = vec![
                    integer("prim", n.prim.0),
                    Field { name: "hidden", value: Value::Switch(n.is_hidden) },
                ];
                if let Some((extent, held)) = n.operands {
                    fields.push(pixels_field(extent.pixels));
                    fields.push(number("nearest_depth_units", units(extent.nearest).into()));
                    fields.push(number("held_depth_units", units(held).into()));
                    fields.push(number(
                        "margin_units",
                        f64::from(units(extent.nearest)) - f64::from(units(held)),
                    ));
                }
                fields
            }
            Self::SharedUnseen(prim, node) => vec![integer("prim", prim.0), integer("node", node.0)],
            Self::Facing(n) => n.fields(context),
            Self::Checked(n) => vec![
                Field { name: "due", value: Value::Switch(n.is_due) },
                integer("frames", n.frames),
                integer("interval", n.interval),
                integer("added", n.added),
                integer("listed", n.listed),
                number("farthest_units", units(n.farthest[0]).into()),
                number("farthest_before_units", units(n.farthest[1]).into()),
            ],
            Self::Worked(n) => n.fields(),
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        match self {
            Self::Listed(n, true) => {
                format!("Node {n} was visible in the last frame, so it is drawn at once, without a test.")
            }
            Self::Listed(n, false) => format!(
                "Node {n} is on the visible list: it was drawn at the start of the frame, without a test."
            ),
            Self::Unlisted(n) => format!(
                "Node {n} cannot be seen in the finished image; it leaves the visible list with all below it."
            ),
            Self::Tested(n) => n.sentence(context),
            Self::Read(node, n) => {
                let what = n.face.map_or("The whole box".to_owned(), |face| format!("Face {}", face + 1));
                format!("{what} of node {node} against {}: {}.", place(n.cell), n.comparison())
            }
            Self::Refreshed(cell) => {
                format!(
                    "Something was drawn under {} since it was read: its tile is brought up to date, with \
                     all values above.",
                    place(*cell)
                )
            }
            Self::RefreshedUnder(_, most) => {
                format!(
                    "The pyramid is brought up to date where the next cube falls, if no more than {most} \
                     tiles are stale there."
                )
            }
            Self::RefreshedAll => "The whole pyramid is brought up to date.".into(),
            Self::Answered(n) => n.sentence(),
            Self::Rasterized(n) => n.sentence::<S>(),
            Self::SharedUnseen(prim, node) => format!(
                "The {} {prim} lies in several cubes below node {node}; none of them can be seen.",
                S::PRIM
            ),
            Self::Facing(n) => n.sentence(context),
            Self::Checked(n) => n.sentence(),
            Self::Worked(n) => n.sentence(),
        }
    }
}

impl Rasterized {
    fn sentence<S: Faces>(&self) -> String {
        let (kind, prim) = (S::PRIM, self.prim);
        match self.operands {
            None => format!(
                "The {kind} {prim} is drawn without a test: it covers no pixel's center, or it is cut by the \
                 near plane or the image's wide border."
            ),
            Some((extent, held)) => {
                let (near, held) = (units(extent.nearest), units(held));
                if self.is_hidden {
                    format!(
                        "The {kind} {prim} is left out: its nearest point, at depth {}, lies behind all that \
                         is drawn in its cells, which is no farther than {}.",
                        short(near),
                        short(held)
                    )
                } else {
                    format!(
                        "The {kind} {prim} is drawn: it comes as near as {}, and its cells show nothing \
                         nearer than {} somewhere.",
                        short(near),
                        short(held)
                    )
                }
            }
        }
    }
}

impl Unit {
    /// Its name on the timeline.
    pub fn name(self) -> String {
        match self {
            Self::Processor(p) => format!("processor {p}"),
            Self::Renderer(r) => format!("renderer {r}"),
        }
    }
}

impl Worked {
    fn tally(&self, tally: &mut Tally) {
        let (busy, ticks) = match self.job {
            Job::DrawVisible | Job::DrawFound => ("structures_drawn", "ticks_transforming"),
            Job::Ask => ("boxes_sent", "ticks_asking"),
            Job::Wait => ("waits", "ticks_waiting"),
            Job::Rasterize => ("rasterizations", "ticks_rasterizing"),
            Job::Answer => ("answers", "ticks_answering"),
        };
        tally.add(busy, 1);
        tally.add(ticks, (self.to - self.from).into());
        tally.at_least("ticks_of_frame", self.to.into());
    }
    fn kind(&self) -> &'static str {
        match self.job {
            Job::DrawVisible => "VisibleDrawn",
            Job::DrawFound => "FoundDrawn",
            Job::Ask => "BoxSent",
            Job::Wait => "Waited",
            Job::Rasterize => "RegionRasterized",
            Job::Answer => "RegionAnswered",
        }
    }
    fn fields(&self) -> Vec<Field> {
        vec![
            Field { name: "unit", value: Value::Word(self.unit.name()) },
            integer("node", self.node.0),
            integer("from_ticks", self.from),
            integer("to_ticks", self.to),
            integer("region", self.region),
            integer("count", self.count),
        ]
    }
    fn sentence(&self) -> String {
        let (who, node, count, region) = (self.unit.name(), self.node, self.count, self.region);
        let what = match self.job {
            Job::DrawVisible => format!(
                "transforms and sends out node {node}, which is on its visible list: {count} primitives"
            ),
            Job::DrawFound => {
                format!("transforms and sends out node {node}, which a renderer saw: {count} primitives")
            }
            Job::Ask if count > 1 => {
                format!("asks for the box of node {node}, for {count} of its structures at once")
            }
            Job::Ask => format!("asks for the box of node {node}"),
            Job::Wait => "waits for answers".into(),
            Job::Rasterize => format!("rasterizes {count} primitives of node {node} in region {region}"),
            Job::Answer if count == 0 => format!(
                "answers for the box of node {node} in region {region}: all enables off, nothing of it shows"
            ),
            Job::Answer => {
                format!("answers for the box of node {node} in region {region}: some pixel of it shows")
            }
        };
        format!("Ticks {} to {}: {who} {what}.", self.from, self.to)
    }
}

impl Check {
    fn sentence(&self) -> String {
        let of = format!(
            "{} of {} cubes are new on the visible list, {} frames since it was checked",
            self.added, self.listed, self.frames
        );
        if self.is_due {
            format!("{of}: every cube on it is asked against the finished image.")
        } else {
            format!("{of}: no check is due before {}.", self.interval)
        }
    }
}
