//! The evidence of this method: as fields, as sentences, and as marks in the world.

use super::DepthKind;
use super::budget::Adapted;
use super::depth::DepthTest;
use super::index::Counts;
use super::maps::MapStep;
use super::overlap::{MapRead, Outcome, Overlap};
use super::selection::Candidate;
use crate::culling::depth::{DepthNote, Faces, sight_lines};
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Aabb, NodeId, PixelRect, Space, View};
use crate::method::evidence::{Facing, Tested, axes, integer, label, number, short};
use crate::method::{Claim, Compared, Context, Field, Note, Tallied, Tally, Value};
use crate::raster::PyramidCell;
use crate::scene::Scene;

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Evidence<S: Faces> {
    /// A box against the frustum.
    Tested(Tested<S>),
    /// A primitive's orientation.
    Facing(Facing),
    /// Leaves of the occluder database in view, and what the database is.
    Gathered(u32, Counts),
    /// So many grid points about the eye, and how many leaves they see.
    LookedUp(u32, u32),
    /// A leaf became an occluder, or not.
    Chosen(Choice),
    /// The single Z plane, by its view depth, world units.
    Plane(f32),
    /// An occluder was drawn into the maps.
    Covered(Cover),
    /// An occluder's farthest depth was written to these entries.
    Written(NodeId, PixelRect, f32),
    /// The levels were made.
    Built(Built),
    /// A node holds an occluder.
    Holds(NodeId),
    /// A node's nearest depth against those of occluders.
    Compared(DepthCompared),
    /// What was read of tiles.
    Depth(DepthNote<S>),
    /// A map pixel was read for a node.
    Read(NodeId, MapRead, u32),
    /// What came of a node.
    Answered(Answered<S>),
    /// L and the distance limit of the next frame.
    Adapted(Adapted),
    /// Culling is turned off for this frame; so many more will follow.
    Paused(u32),
}

/// A candidate's turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice {
    pub candidate: Candidate,
    /// Polygons of occluders with it, and their limit.
    pub sum: u32,
    pub limit: u32,
    /// The distance limit, world units.
    pub reach: f32,
    pub is_taken: bool,
}

/// What was drawn of an occluder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cover {
    pub node: NodeId,
    /// The node whose groups were drawn: itself, or beyond all nodes what stands in for it.
    pub drawn: NodeId,
    /// Whether with fronts only; else from both sides.
    pub one_sided: bool,
}

/// The maps that were built.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Built {
    pub levels: u32,
    /// Columns and rows of level 0.
    pub size: [u32; 2],
    /// Samples a side of a pixel of level 0.
    pub side: u32,
    /// Black samples that a pixel may have.
    pub ignored: u32,
    /// Samples of holes that were filled, and how many such a hole has at most.
    pub filled: u32,
    pub closing: u32,
    /// Black samples of all, and how many there are.
    pub black: u32,
    pub samples: u32,
}

/// A node against the depths of occluders.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DepthCompared {
    pub node: NodeId,
    /// Its nearest depth, `1/w`.
    pub nearest: f32,
    pub test: DepthTest,
    /// The pixels of the part of the screen that decided.
    pub pixels: PixelRect,
    /// What the depths of occluders are.
    pub kind: DepthKind,
}

/// What an answer rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    /// It reaches the near plane.
    CrossesNear,
    /// It lies beside the image, if by less than what the frustum's test allows for.
    BesideImage,
    /// It covers no pixel's center.
    NoPixel,
    /// It is not behind the occluders.
    NotBehind,
    /// It is behind them; the overlap test decided.
    Overlap(Overlap),
}

/// A node was tested.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answered<S: Space> {
    pub node: NodeId,
    pub bounds: Aabb<S::Vector>,
    /// Pixels of the image that it can cover.
    pub pixels: PixelRect,
    pub ground: Ground,
    /// Whether it is culled, and whether that is proven.
    pub is_culled: bool,
    pub is_proven: bool,
}

impl<S: Faces> From<DepthNote<S>> for Evidence<S> {
    #[inline]
    fn from(note: DepthNote<S>) -> Self {
        Self::Depth(note)
    }
}

impl<S: Faces> Evidence<S> {
    /// The change of the maps that it records; `None` if nothing changed.
    pub(super) fn step(&self) -> Option<MapStep> {
        match *self {
            Self::Plane(z) => Some(MapStep::Plane(z)),
            Self::Covered(c) => Some(MapStep::Cover(c.drawn, c.one_sided)),
            Self::Written(_, touched, farthest) => Some(MapStep::Write(touched, farthest)),
            Self::Built(_) => Some(MapStep::Build),
            Self::Depth(DepthNote::Refreshed(cell)) => Some(MapStep::Refresh(cell)),
            _ => None,
        }
    }
    /// Draws the evidence in the world.
    pub(super) fn draw(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        match self {
            Self::Tested(n) => n.draw(view, to),
            Self::Facing(n) => n.draw(scene, view, to),
            Self::Depth(n) => n.draw(scene, view, to),
            Self::Compared(n) if n.test.held.is_finite() => {
                let what = match n.kind {
                    DepthKind::Plane => "Z plane",
                    DepthKind::Estimation => "occluders reach to",
                    DepthKind::Samples => "occluders drawn to",
                };
                sight_lines(view, n.pixels, n.nearest, (n.test.held, what), to);
            }
            Self::Answered(n) => {
                to.bounds(Layer::Emphasis, Role::Current, Subject::Node(n.node), &n.bounds);
            }
            // Marks of the maps have no place in the world; pictures show them. Occluders are shown at every
            // step, by whoever draws all of them.
            _ => {}
        }
    }
}

/// Draws the leaf whose turn it was, with what decided.
pub(super) fn draw_choice<S: Faces>(
    choice: &Choice,
    bounds: &Aabb<S::Vector>,
    view: &View<S>,
    to: &mut Drawing<S::Vector>,
) {
    let c = &choice.candidate;
    to.bounds(Layer::Emphasis, Role::Current, Subject::Node(c.node), bounds);
    let ends = [view.eye.position, bounds.center()];
    to.line(Layer::Evidence, Role::Evidence, Subject::Node(c.node), ends);
    label(to, (ends[0] + ends[1]) * 0.5, format!("{} units", short(c.distance)));
}

impl<S: Faces> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Tested(n) => n.tally(tally),
            Self::Facing(_) => Facing::tally(tally),
            Self::Gathered(n, _) => tally.add("occluders_in_view", (*n).into()),
            Self::Chosen(n) if n.is_taken => tally.add("occluder_polygons", n.candidate.polygons.into()),
            Self::Covered(..) => tally.add("occluders_drawn", 1),
            Self::Written(_, r, _) => tally.add("entries_written", r.area()),
            Self::Compared(n) => {
                tally.add("depth_tests", 1);
                tally.add("entries_read", n.test.reads.into());
            }
            Self::Depth(n) => n.tally(tally),
            Self::Read(..) => tally.add("map_pixels_read", 1),
            Self::Answered(n) => {
                if matches!(n.ground, Ground::Overlap(_)) {
                    tally.add("overlap_tests", 1);
                }
            }
            Self::LookedUp(_, leaves) => tally.add("leaves_listed", (*leaves).into()),
            Self::Chosen(_) | Self::Plane(_) | Self::Built(_) | Self::Holds(_) => {}
            Self::Adapted(_) | Self::Paused(_) => {}
        }
    }
}

/// Such as `1 sample`, `2 samples`.
fn count(n: u32, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

impl<S: Faces> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Tested(n) => n.kind(),
            Self::Facing(_) => "OrientationTested",
            Self::Gathered(..) => "OccludersGathered",
            Self::LookedUp(..) => "GridLookedUp",
            Self::Chosen(n) if n.is_taken => "OccluderChosen",
            Self::Chosen(_) => "OccluderRefused",
            Self::Plane(_) => "PlaneSet",
            Self::Covered(..) => "OccluderDrawn",
            Self::Written(..) => "DepthWritten",
            Self::Built(_) => "MapsBuilt",
            Self::Holds(_) => "OccluderHeld",
            Self::Compared(_) => "DepthCompared",
            Self::Depth(n) => n.kind(),
            Self::Read(..) => "MapRead",
            Self::Answered(_) => "OcclusionTested",
            Self::Adapted(_) => "BudgetAdapted",
            Self::Paused(_) => "CullingPaused",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Tested(n) => n.subject(),
            Self::Facing(n) => n.subject(),
            Self::Chosen(n) => Subject::Node(n.candidate.node),
            Self::Covered(c) => Subject::Node(c.node),
            Self::Written(n, ..) | Self::Holds(n) => Subject::Node(*n),
            Self::Compared(n) => Subject::Node(n.node),
            Self::Depth(n) => n.subject(),
            Self::Read(n, ..) => Subject::Node(*n),
            Self::Answered(n) => Subject::Node(n.node),
            Self::Gathered(..) | Self::LookedUp(..) | Self::Plane(_) | Self::Built(_) => Subject::None,
            Self::Adapted(_) | Self::Paused(_) => Subject::None,
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            Self::Depth(n) => n.claim(context),
            Self::Answered(n) if n.is_culled && n.is_proven => Some(Claim::Hidden),
            // Depth and overlap each are half of it.
            _ => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            Self::Depth(n) => n.compared(context),
            Self::Chosen(n) => Some(Compared::of(
                ("polygons of occluders", f64::from(n.sum)),
                ("their limit", f64::from(n.limit)),
            )),
            Self::Compared(n) if n.test.held.is_finite() => Some(Compared::of(
                ("nearest depth", (1.0 / n.nearest).into()),
                ("farthest occluder", (1.0 / n.test.held).into()),
            )),
            Self::Read(_, n, ignored) => {
                Some(Compared::of(("black samples", n.black.into()), ("ignored", (*ignored).into())))
            }
            _ => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Tested(n) => n.fields(context),
            Self::Facing(n) => n.fields(context),
            Self::Depth(n) => n.fields(context),
            Self::Gathered(n, c) => vec![
                integer("leaves", *n),
                integer("occluder_leaves", c.kept),
                integer("occluder_prims", c.kept_prims),
                integer("small", c.small),
                integer("redundant", c.redundant),
                integer("complex", c.complex),
            ],
            Self::LookedUp(points, leaves) => vec![integer("points", *points), integer("leaves", *leaves)],
            Self::Chosen(n) => n.fields(),
            Self::Plane(z) => vec![number("depth_units", (*z).into())],
            Self::Covered(c) => vec![
                integer("node", c.node.0),
                Field { name: "stand_in", value: Value::Switch(c.drawn != c.node) },
                Field { name: "one_sided", value: Value::Switch(c.one_sided) },
            ],
            Self::Written(n, r, farthest) => vec![
                integer("node", n.0),
                rectangle("entries", *r),
                number("farthest_depth_units", (1.0 / farthest).into()),
            ],
            Self::Built(n) => vec![
                integer("levels", n.levels),
                integer("columns", n.size[0]),
                integer("rows", n.size[1]),
                integer("samples_a_side", n.side),
                integer("black_samples", n.black),
                integer("samples", n.samples),
                integer("ignored_samples", n.ignored),
                integer("filled_samples", n.filled),
            ],
            Self::Holds(n) => vec![integer("node", n.0)],
            Self::Compared(n) => n.fields(),
            Self::Read(node, n, ignored) => n.fields(*node, *ignored),
            Self::Answered(n) => n.fields(),
            Self::Adapted(n) => n.fields(),
            Self::Paused(n) => vec![integer("frames_left", *n)],
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        match self {
            Self::Tested(n) => n.sentence(context),
            Self::Facing(n) => n.sentence(context),
            Self::Depth(n) => n.sentence(context),
            Self::Gathered(n, c) => format!(
                "The occluder database has {} in view of {}; {} are left out as small, {} as redundant, {} \
                 as complex.",
                leaves(*n),
                c.kept,
                c.small,
                c.redundant,
                c.complex
            ),
            Self::LookedUp(points, listed) => format!(
                "{} about the eye saw {}: these come first, the larger they looked.",
                if *points == 1 { "One grid point".into() } else { format!("{points} grid points") },
                if *listed == 0 { "no occluder".into() } else { leaves(*listed) }
            ),
            Self::Chosen(n) => n.sentence::<S>(),
            Self::Plane(z) => format!(
                "The Z plane lies {} units before the eye: occluders are drawn as far as it, and only what \
                 is wholly beyond it can be culled.",
                short(*z)
            ),
            Self::Covered(c) => format!(
                "What {} is drawn in white{}: it covers samples, and nothing else of it counts.",
                if c.drawn == c.node {
                    format!("node {} holds", c.node)
                } else {
                    format!("stands in for occluder {}", c.node)
                },
                if c.one_sided { ", as far as it faces the eye" } else { "" }
            ),
            Self::Written(n, r, farthest) => format!(
                "Occluder {n} touches {} of the depth estimation buffer: none of these may be nearer than \
                 its farthest corner, {} units.",
                if r.area() == 1 { "1 entry".into() } else { format!("{} entries", r.area()) },
                short(1.0 / farthest)
            ),
            Self::Built(n) => n.sentence(),
            Self::Holds(n) => format!(
                "Node {n} holds an occluder, which is not behind the occluders: it needs no test as a whole."
            ),
            Self::Compared(n) => n.sentence(),
            Self::Read(node, n, ignored) => n.sentence(*node, *ignored),
            Self::Answered(n) => n.sentence(),
            Self::Adapted(n) => n.sentence(S::PRIM),
            Self::Paused(n) => format!(
                "Culling did not pay lately, so this frame draws what is in view; it is tried again after \
                 {}.",
                count(*n, "frame")
            ),
        }
    }
}

fn leaves(n: u32) -> String {
    if n == 1 { "one leaf".into() } else { format!("{n} leaves") }
}
fn rectangle(name: &'static str, r: PixelRect) -> Field {
    Field { name, value: Value::List([r.x0, r.x1, r.y0, r.y1].map(f64::from).to_vec()) }
}

impl Choice {
    fn fields(&self) -> Vec<Field> {
        let c = &self.candidate;
        vec![
            integer("node", c.node.0),
            number("distance_units", c.distance.into()),
            number("size", c.size.into()),
            number("grid_angle", c.angle.into()),
            integer("polygons", c.polygons),
            integer("sum", self.sum),
            integer("limit", self.limit),
            number("distance_limit_units", self.reach.into()),
            Field { name: "taken", value: Value::Switch(self.is_taken) },
            Field { name: "kept", value: Value::Switch(c.is_kept) },
        ]
    }
    fn sentence<S: Space>(&self) -> String {
        let (c, prim) = (&self.candidate, S::PRIM);
        let (node, distance) = (c.node, short(c.distance));
        let holds = count(c.polygons, prim);
        let kept = match (c.is_kept, c.angle > 0.0) {
            (true, _) => ", and was of use in the last frame".to_owned(),
            (_, true) => format!(
                ", and seen from the grid under {} {}",
                short(c.angle),
                if S::CORNERS == 2 { "rad" } else { "sr" }
            ),
            _ => String::new(),
        };
        if self.is_taken {
            format!(
                "Node {node}, {distance} units away{kept}, is an occluder: its {holds} make {} of at most \
                 {}.",
                self.sum, self.limit
            )
        } else if c.distance > self.reach {
            format!(
                "Node {node} is {distance} units away, beyond the distance limit of {}: it is no occluder.",
                short(self.reach)
            )
        } else {
            format!(
                "Node {node}, {distance} units away, would be the next occluder, but its {holds} would make \
                 {}, more than L = {}: no more occluders are chosen.",
                self.sum, self.limit
            )
        }
    }
}

impl Built {
    fn sentence(&self) -> String {
        let covered = 100.0 * f64::from(self.samples - self.black) / f64::from(self.samples.max(1));
        let [columns, rows] = self.size;
        let threshold = if self.ignored == 0 {
            "a pixel counts as opaque if nothing of it is black".to_owned()
        } else {
            format!("a pixel counts as opaque with up to {}", count(self.ignored, "black sample"))
        };
        let filled = if self.closing == 0 {
            String::new()
        } else {
            format!(" with {} of holes of at most {} filled", count(self.filled, "sample"), self.closing)
        };
        format!(
            "The occluders cover {covered:.1} % of the samples{filled}. Averaged, they make {} of occlusion \
             maps, the finest of {columns} × {rows}; {threshold}.",
            count(self.levels, "level")
        )
    }
}

impl DepthCompared {
    fn fields(&self) -> Vec<Field> {
        vec![
            integer("node", self.node.0),
            Field { name: "behind", value: Value::Switch(self.test.is_behind) },
            number("nearest_depth_units", (1.0 / self.nearest).into()),
            number("held_depth_units", (1.0 / self.test.held).into()),
            integer("entries_read", self.test.reads),
            rectangle("pixels", self.pixels),
        ]
    }
    fn sentence(&self) -> String {
        let (node, nearest, held) = (self.node, short(1.0 / self.nearest), short(1.0 / self.test.held));
        let [x, y] = self.test.entry;
        let place = match self.kind {
            DepthKind::Plane => "the Z plane".to_owned(),
            DepthKind::Estimation => format!("entry ({x}, {y})"),
            DepthKind::Samples => "a covered sample".to_owned(),
        };
        match (self.test.is_behind, self.test.held.is_finite()) {
            (true, false) if self.kind == DepthKind::Samples => {
                format!("No sample under node {node} is covered: only the overlap test can tell.")
            }
            (true, false) => {
                format!("No occluder touches an entry under node {node}: only the overlap test can tell.")
            }
            (true, true) => format!(
                "Node {node} begins at depth {nearest}, behind every occluder that it could overlap; the \
                 farthest reaches to {held}, at {place}."
            ),
            (false, _) => format!(
                "Node {node} begins at depth {nearest}, not behind {place}, which lies as far as {held}: it \
                 may stand before an occluder."
            ),
        }
    }
}

/// One word for an outcome.
fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Opaque => "opaque",
        Outcome::Transparent => "transparent",
        Outcome::TooTransparent => "too-transparent",
        Outcome::Descends => "descend",
    }
}

impl MapRead {
    /// The pixel's opacity, 0 to 1.
    pub(super) fn opacity(&self) -> f64 {
        1.0 - f64::from(self.black) / f64::from(self.present)
    }
    /// What followed, as it is written beside a pixel.
    pub(super) fn outcome_text(&self) -> &'static str {
        match self.outcome {
            Outcome::Opaque => "opaque",
            Outcome::Transparent => "not opaque, and there is no finer map",
            Outcome::TooTransparent => "too transparent, and all of it lies in the rectangle: end",
            Outcome::Descends => "not opaque: descend",
        }
    }
    fn fields(&self, node: NodeId, ignored: u32) -> Vec<Field> {
        vec![
            integer("node", node.0),
            integer("level", self.cell.level.into()),
            integer("column", self.cell.x.into()),
            integer("row", self.cell.y.into()),
            integer("black_samples", self.black),
            integer("samples", self.present),
            number("opacity", self.opacity()),
            integer("ignored_samples", ignored),
            Field { name: "inside", value: Value::Switch(self.is_inside) },
            Field { name: "outcome", value: Value::Word(word(self.outcome).into()) },
        ]
    }
    fn sentence(&self, node: NodeId, ignored: u32) -> String {
        let PyramidCell { level, x, y } = self.cell;
        format!(
            "Pixel ({x}, {y}) of level {level} under node {node} has opacity {:.3}: {} of {} are black, \
             where {ignored} may be. {}.",
            self.opacity(),
            self.black,
            count(self.present, "sample"),
            capital(self.outcome_text())
        )
    }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

impl<S: Faces> Answered<S> {
    fn fields(&self) -> Vec<Field> {
        let (ground, found) = match self.ground {
            Ground::CrossesNear => ("crosses-near", Overlap::default()),
            Ground::BesideImage => ("beside-image", Overlap::default()),
            Ground::NoPixel => ("no-pixel", Overlap::default()),
            Ground::NotBehind => ("not-behind", Overlap::default()),
            Ground::Overlap(found) => ("overlap", found),
        };
        vec![
            integer("node", self.node.0),
            Field { name: "culled", value: Value::Switch(self.is_culled) },
            Field { name: "proven", value: Value::Switch(self.is_proven) },
            Field { name: "ground", value: Value::Word(ground.into()) },
            integer("map_pixels_read", found.reads),
            integer("ignored_black_samples", found.ignored),
            rectangle("pixels", self.pixels),
            Field { name: "box_min", value: axes(self.bounds.min) },
            Field { name: "box_max", value: axes(self.bounds.max) },
        ]
    }
    fn sentence(&self) -> String {
        let node = self.node;
        match self.ground {
            Ground::CrossesNear => {
                format!("Node {node} reaches the near plane: no rectangle bounds it, so it may be seen.")
            }
            Ground::BesideImage => {
                format!("The box of node {node} lies beside the image: nothing of it can show.")
            }
            Ground::NoPixel => {
                format!("The rectangle of node {node} covers no pixel's center: nothing of it can show.")
            }
            Ground::NotBehind => format!(
                "Node {node} is not behind all occluders that it could overlap, so it may be seen, whatever \
                 they cover."
            ),
            Ground::Overlap(found) => {
                let reads = match found.reads {
                    1 => "One map pixel was read".to_owned(),
                    n => format!("{n} map pixels were read"),
                };
                match (self.is_culled, self.is_proven, found.ignored) {
                    (true, true, _) => format!(
                        "Node {node} is hidden: it is behind the occluders, and its rectangle lies within \
                         what they cover. {reads}."
                    ),
                    (true, false, 0) => format!(
                        "Node {node} is culled, though not proven hidden: it is behind the occluders, and \
                         its rectangle lies within what is drawn of them at the samples of the maps, which \
                         may be more than they cover. {reads}."
                    ),
                    (true, false, n) => format!(
                        "Node {node} is culled, though not proven hidden: {} in the map pixels under it are \
                         ignored as small holes. {reads}.",
                        count(n, "black sample")
                    ),
                    (false, ..) => format!(
                        "Node {node} may be seen: something under its rectangle is not covered. {reads}."
                    ),
                }
            }
        }
    }
}

impl Adapted {
    fn fields(&self) -> Vec<Field> {
        vec![
            integer("in_view", self.work.in_view),
            integer("culled", self.work.culled),
            integer("occluder_polygons", self.work.occluders),
            integer("tests", self.work.tests),
            integer("limit_before", self.limit[0]),
            integer("limit", self.limit[1]),
            number("distance_limit_share", self.reach[1].into()),
            Field { name: "on", value: Value::Switch(self.is_on) },
        ]
    }
    fn sentence(&self, prim: &str) -> String {
        let work = &self.work;
        let head = format!(
            "Of {} in view {} were culled, with {} of occluders and {}.",
            count(work.in_view, prim),
            work.culled,
            count(work.occluders, "polygon"),
            count(work.tests, "test")
        );
        let [before, after] = self.limit;
        let limit = match after.cmp(&before) {
            std::cmp::Ordering::Greater => format!("Few were: L grows from {before} to {after}."),
            std::cmp::Ordering::Less => {
                format!("Enough were, with more occluders than it takes: L shrinks from {before} to {after}.")
            }
            std::cmp::Ordering::Equal => format!("L stays at {after}."),
        };
        let off = if self.is_on { "" } else { " Culling did not pay: it is turned off for a while." };
        format!("{head} {limit}{off}")
    }
}
