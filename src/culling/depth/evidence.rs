//! Evidence that methods with a z-pyramid record: what a query read and found, what was brought up to date,
//! what was drawn. As fields, as sentences, and as marks in the world.

use std::marker::PhantomData;

use super::answer::{Answer, Decisive, Summary};
use super::buffer::Step;
use super::faces::Faces;
use super::query::Listener;
use super::tiled::TileStep;
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Aabb, NodeId, PixelRect, PrimId, Vector, View};
use crate::method::evidence::{axes, integer, label, number, outline, short};
use crate::method::{Claim, Compared, Context, Event, Field, Note, Observer, Tallied, Tally, Value};
use crate::raster::{Hears, Options, Outcome, PyramidCell, Read};
use crate::scene::{Scene, Surfaces};

/// What happened to a buffer, or was read of it.
#[derive(Clone, Copy, Debug)]
pub enum DepthNote<S: Faces> {
    /// A cell of the pyramid was compared with a node's box.
    Read(NodeId, Read),
    /// A tile of the pyramid was brought up to date; or a block of tiles, or a tile by exact depths.
    Refreshed(PyramidCell),
    /// What a node holds, and was not drawn yet, was drawn into tiles: with fronts only, or from both sides.
    Drawn(NodeId, bool),
    /// A node's box was queried.
    Answered(Answered<S>),
    /// A primitive was drawn, or left out because it lies behind its cells.
    Rasterized(Rasterized),
}

/// A box was queried, and this was the answer.
#[derive(Clone, Copy, Debug)]
pub struct Answered<S: Faces> {
    /// Whose box.
    pub node: NodeId,
    /// The box.
    pub bounds: Aabb<S::Vector>,
    /// Pixels that it can cover; empty if it falls between them.
    pub pixels: PixelRect,
    /// What the query found.
    pub answer: Answer,
    /// What that rests on.
    pub ground: Ground,
    /// Whether its planes say where it begins; otherwise its rectangle is as near as its nearest point.
    pub is_by_planes: bool,
}

/// What an answer rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Cells of the pyramid, or that the box covers no pixel's center.
    Cells,
    /// The box reaches the near plane, so it counts as visible.
    CrossesNear,
    /// It lies beside the image, if by less than what the frustum's test allows for.
    BesideImage,
    /// A part of the image that it covers cannot be read, so it counts as visible.
    Unread,
    /// It lies behind the farthest depth of every region of the screen that it covers.
    Regions,
}

impl Ground {
    fn word(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::CrossesNear => "crosses-near",
            Self::BesideImage => "beside-image",
            Self::Unread => "unread",
            Self::Regions => "regions",
        }
    }
}

/// A primitive was compared with its cells and drawn, or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rasterized {
    /// Which.
    pub prim: PrimId,
    /// Among tiles the one in which it comes nearest to showing; `None` if it covers no pixel, or tiles are
    /// not asked.
    pub tile: Option<Read>,
    /// Whether it was left out.
    pub is_hidden: bool,
    /// Whether it was compared with what is drawn.
    pub is_tested: bool,
    /// Whether it was drawn only if it faces the eye, and whether it could be see-through.
    pub surfaces: Surfaces,
    /// The part of the image it was drawn in, if not all.
    pub window: Option<PixelRect>,
}

/// Reports what a query reads, as evidence about the node whose box is queried, at a line of a method's
/// pseudocode. `N` is the method's own note.
pub struct QueryReporter<'a, S, N, O> {
    node: NodeId,
    line: Option<u8>,
    watch: &'a mut O,
    kinds: PhantomData<(S, N)>,
}

impl<'a, S: Faces, N: From<DepthNote<S>>, O: Observer<N>> QueryReporter<'a, S, N, O> {
    /// What is reported about a node goes to `watch`; `line`: the one at which cells are compared, if any is.
    pub fn new(node: NodeId, line: Option<u8>, watch: &'a mut O) -> Self {
        Self { node, line, watch, kinds: PhantomData }
    }
}

impl<S: Faces, N: From<DepthNote<S>>, O: Observer<N>> Listener for QueryReporter<'_, S, N, O> {
    #[inline]
    fn compares(&mut self) {
        // Whoever does not listen is not to pay for the call.
        if O::LISTENS
            && let Some(line) = self.line
        {
            self.watch.event(Event::Line(line));
        }
    }
    #[inline]
    fn refreshes(&mut self, cell: PyramidCell) {
        self.watch.note(|| DepthNote::Refreshed(cell).into());
    }
    #[inline]
    fn reads(&mut self, read: Read) {
        let node = self.node;
        self.watch.note(move || DepthNote::Read(node, read).into());
    }
}

/// Where a question about tiles stands: each is about to happen, or has just been decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The next block under what is asked for.
    Block,
    /// Whether it begins behind the block.
    BehindBlock,
    /// It covers the block, before all that is drawn there.
    CoversBlock,
    /// The next tile of a block.
    Tile,
    /// Whether it begins behind the tile.
    BehindTile,
    /// It covers the tile, and shows in it.
    CoversTile,
    /// The tile does not decide.
    Keep,
    /// The next of the tiles that did not, for its pixels that nothing covers.
    Kept,
    /// Whether it shows at one of these.
    Bare,
    /// The next of the same tiles, for the depths of its pixels.
    KeptStill,
    /// Whether it lies behind a plane that is known of the tile.
    Plane,
    /// The depths of the tile's pixels are worked out.
    Resolve,
    /// Whether it shows at a pixel.
    Pixel,
    /// It shows nowhere.
    Hidden,
}

/// Reports what a question about tiles reads, as evidence about the node that is asked for, at lines of a
/// method's pseudocode. `N` is the method's own note.
pub struct Asking<'a, S, N, O> {
    watch: &'a mut O,
    lines: fn(Stage) -> Option<u8>,
    /// Whose box it is; of what is no node nothing is said but what changes.
    node: Option<NodeId>,
    /// Where a closer look at a tile stands, if there is one.
    close: Option<Stage>,
    summary: Summary,
    kinds: PhantomData<(S, N)>,
}

impl<'a, S: Faces, N: From<DepthNote<S>>, O: Observer<N>> Asking<'a, S, N, O> {
    /// What is reported goes to `watch`.
    pub fn new(watch: &'a mut O, lines: fn(Stage) -> Option<u8>, node: Option<NodeId>) -> Self {
        Self { watch, lines, node, close: None, summary: Summary::default(), kinds: PhantomData }
    }
    /// The answer with what was read for it.
    pub fn answer(mut self, is_hidden: bool, nearest: f32) -> Answer {
        if is_hidden {
            self.reaches(Stage::Hidden);
        }
        self.summary.answer(is_hidden, nearest)
    }
    fn reaches(&mut self, stage: Stage) {
        if O::LISTENS
            && let Some(line) = (self.lines)(stage)
        {
            self.watch.event(Event::Line(line));
        }
    }
}

impl<S: Faces, N: From<DepthNote<S>>, O: Observer<N>> Hears for Asking<'_, S, N, O> {
    const LISTENS: bool = O::LISTENS;
    fn reads(&mut self, read: Read) {
        let Some(node) = self.node else { return };
        let [next, ask, shows] = match read.cell.level {
            PyramidCell::BLOCK => [Some(Stage::Block), Some(Stage::BehindBlock), Some(Stage::CoversBlock)],
            PyramidCell::TILE if self.close.is_none() => {
                [Some(Stage::Tile), Some(Stage::BehindTile), Some(Stage::CoversTile)]
            }
            0 if self.close == Some(Stage::Plane) => [None, Some(Stage::Pixel), None],
            // Depths that were just worked out.
            _ if self.close == Some(Stage::Resolve) => [None, Some(Stage::Pixel), None],
            // The line is reached already.
            _ => [None; 3],
        };
        next.into_iter().chain(ask).for_each(|stage| self.reaches(stage));
        self.watch.note(move || DepthNote::Read(node, read).into());
        self.summary.take(&read);
        match read.outcome {
            Outcome::Shows => shows.into_iter().for_each(|stage| self.reaches(stage)),
            Outcome::Descends if read.cell.level == PyramidCell::TILE => self.reaches(Stage::Keep),
            Outcome::Behind | Outcome::Descends => {}
        }
    }
    fn looks_closer(&mut self, at_depths: bool) {
        let [next, ask] =
            if at_depths { [Stage::KeptStill, Stage::Plane] } else { [Stage::Kept, Stage::Bare] };
        self.reaches(next);
        self.reaches(ask);
        self.close = Some(ask);
    }
    fn refreshes(&mut self, cell: PyramidCell) {
        if cell.level == PyramidCell::TILE {
            self.reaches(Stage::Resolve);
            self.close = Some(Stage::Resolve);
        }
        // Whoever is asked for: a film brings up to date what the run did.
        self.watch.note(|| DepthNote::Refreshed(cell).into());
    }
}

/// View depth of a depth, world units.
pub fn units(depth: f32) -> f32 {
    // Notes keep 1/w, the very number that was compared; it is inverted for readers alone.
    1.0 / depth
}

impl<S: Faces> DepthNote<S> {
    /// The change of the buffer that it records; `None` if nothing changed.
    pub fn step<'a>(&'a self, scene: &'a Scene<S>) -> Option<Step<'a, S>> {
        match self {
            Self::Refreshed(cell) => Some(Step::Refresh(*cell)),
            Self::Rasterized(n) if !n.is_hidden => {
                // How many threads drew is not recorded, since the image does not depend on it.
                let options = Options { surfaces: n.surfaces, window: n.window, ..Options::default() };
                let prims = std::slice::from_ref(&n.prim);
                Some(Step::Draw { scene, prims, options })
            }
            // What was only looked at, or left out, changes neither a pixel nor a tile.
            Self::Read(..) | Self::Answered(_) | Self::Rasterized(_) => None,
            // Tiles change by steps of their own.
            Self::Drawn(..) => None,
        }
    }
    /// The change of tiles that it records; `None` if nothing changed.
    pub fn tile_step(&self) -> Option<TileStep> {
        match *self {
            Self::Refreshed(cell) => Some(TileStep::Refresh(cell)),
            Self::Drawn(node, one_sided) => Some(TileStep::Draw(node, one_sided)),
            _ => None,
        }
    }
    /// Draws the evidence in the world.
    pub fn draw(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        match self {
            Self::Answered(n) => n.draw(view, to),
            Self::Rasterized(n) => {
                outline(scene, n.prim, to);
                if let Some(r) = &n.tile {
                    sight_lines(view, r.cell.pixels(view.width, view.height), r.nearest, (r.held, DRAWN), to);
                }
            }
            Self::Read(_, n) => {
                let size = (view.width, view.height);
                sight_lines(view, n.cell.pixels(size.0, size.1), n.nearest, (n.held, DRAWN), to);
            }
            // A tile has no place in the world; the pictures of the pyramid show it.
            Self::Refreshed(_) | Self::Drawn(..) => {}
        }
    }
}

impl<S: Faces> Tallied for DepthNote<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Read(..) => tally.add("cells_read", 1),
            Self::Refreshed(_) => tally.add("tiles_refreshed", 1),
            Self::Drawn(..) => tally.add("cubes_drawn", 1),
            Self::Answered(_) => tally.add("queries", 1),
            Self::Rasterized(n) => {
                tally.add(if n.is_hidden { "primitives_behind" } else { "primitives_drawn" }, 1)
            }
        }
    }
}

impl<S: Faces> Note<S> for DepthNote<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Read(..) => "CellRead",
            Self::Refreshed(_) => "TileRefreshed",
            Self::Drawn(..) => "CubeDrawn",
            // Georges 1995, Section 3.3, calls a query an obscuration test.
            Self::Answered(_) => "ObscurationTested",
            Self::Rasterized(n) if n.is_hidden => "PrimitiveBehind",
            Self::Rasterized(_) => "PrimitiveRasterized",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Read(n, _) => Subject::Node(*n),
            // It follows the reads of its query, so it is the note that the node's verdict rests on.
            Self::Answered(n) => Subject::Node(n.node),
            Self::Rasterized(n) => Subject::Prim(n.prim),
            Self::Drawn(n, _) => Subject::Node(*n),
            // Of no node, even where a query caused it: no verdict may rest on a refresh.
            Self::Refreshed(_) => Subject::None,
        }
    }
    fn claim(&self, _: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Answered(n) if n.answer.is_hidden => Some(Claim::Hidden),
            Self::Rasterized(n) if n.is_hidden => Some(Claim::Hidden),
            // A cell hides a part of a box at most.
            _ => None,
        }
    }
    fn compared(&self, _: &Context<'_, S>) -> Option<Compared> {
        // View depths: what is farther than the farthest thing drawn is hidden.
        let depths = |nearest: f32, held: f32| {
            let (nearest, held) = (units(nearest).into(), units(held).into());
            Compared::of(("nearest depth", nearest), ("farthest drawn", held))
        };
        match self {
            Self::Read(_, n) => Some(depths(n.nearest, n.held)),
            Self::Answered(n) => n.answer.decisive.map(|d| depths(d.nearest, d.held)),
            Self::Rasterized(n) => n.tile.map(|r| depths(r.nearest, r.held)),
            Self::Refreshed(_) | Self::Drawn(..) => None,
        }
    }
    fn fields(&self, _: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Read(node, n) => {
                let mut fields = vec![integer("node", node.0)];
                fields.extend(cell_fields(n.cell));
                // View depths, so that they compare with lengths in the world.
                fields.push(number("box_depth_units", units(n.nearest).into()));
                fields.push(number("held_depth_units", units(n.held).into()));
                fields.push(Field { name: "outcome", value: Value::Word(word(n.outcome).into()) });
                fields
            }
            Self::Refreshed(cell) => cell_fields(*cell).to_vec(),
            Self::Drawn(node, one_sided) => {
                vec![integer("node", node.0), Field { name: "one_sided", value: Value::Switch(*one_sided) }]
            }
            Self::Answered(n) => n.fields(),
            Self::Rasterized(n) => n.fields(),
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        let far = 1.0 / context.view.eye.far;
        match self {
            Self::Read(node, n) => {
                format!("The box of node {node} against {}: {}.", place(n.cell), comparison(n))
            }
            Self::Refreshed(cell) if cell.level == PyramidCell::BLOCK => {
                format!(
                    "All tiles of {} hide it, so what the block holds is brought up to date.",
                    place(*cell)
                )
            }
            Self::Refreshed(cell) if cell.level == PyramidCell::TILE => format!(
                "Masks and bounds do not decide in {}: the depths of its pixels are worked out, from the \
                 primitives that were drawn there.",
                place(*cell)
            ),
            Self::Refreshed(cell) => {
                format!(
                    "Something was drawn under {} since it was read: its tile is brought up to date, with \
                     all values above.",
                    place(*cell)
                )
            }
            Self::Drawn(node, one_sided) => format!(
                "What node {node} holds is drawn into the tiles{}, many {}s at a time. What became of each \
                 follows.",
                if *one_sided { ", as far as it faces the eye" } else { "" },
                S::PRIM
            ),
            Self::Answered(n) => n.sentence(far),
            Self::Rasterized(n) => n.sentence(context.scene, far),
        }
    }
}

/// The point of the world at a corner of a pixel, so far along the line of sight; `w`: view depth, world
/// units.
pub fn place_in_view<S: Faces>(view: &View<S>, [x, y]: [u32; 2], w: f32) -> S::Vector {
    let projection = view.projection();
    let image_axes = S::Vector::AXES - 1;
    // The rows are orthogonal; dividing by the squared length undoes their scale.
    let image = [x as f32 / view.width as f32 * 2.0 - 1.0, 1.0 - y as f32 / view.height as f32 * 2.0];
    let ray = (0..image_axes).fold(projection.rows[image_axes], |r, a| {
        let row = projection.rows[a];
        r + row * (image[a] / row.dot(row))
    });
    projection.eye + ray * w
}

/// What a depth is that was drawn.
const DRAWN: &str = "drawn to";

/// The lines of sight around some pixels, as far as the surfaces that are drawn there; and where the thing
/// queried begins. `held`: that depth, and what it is.
pub fn sight_lines<S: Faces>(
    view: &View<S>,
    pixels: PixelRect,
    nearest: f32,
    (held, what): (f32, &str),
    to: &mut Drawing<S::Vector>,
) {
    let at = |x: u32, y: u32, w: f32| place_in_view(view, [x, y], w);
    let corners: &[(u32, u32)] = if S::CORNERS == 2 {
        &[(pixels.x0, 0), (pixels.x1, 0)]
    } else {
        &[(pixels.x0, pixels.y0), (pixels.x1, pixels.y0), (pixels.x1, pixels.y1), (pixels.x0, pixels.y1)]
    };
    // Where nothing was drawn the far plane's depth is held, whose inverse may be rounded to beyond it.
    let (far, near) = (units(held).min(view.eye.far), units(nearest).min(view.eye.far));
    // A line of sight ends at what is drawn: what is queried lies beyond its end if it is hidden, and before
    // it if it is not.
    for &(x, y) in corners {
        to.line(Layer::Evidence, Role::Faint, Subject::None, [view.eye.position, at(x, y, far)]);
    }
    let section = |w: f32| corners.iter().map(|&(x, y)| at(x, y, w)).collect::<Vec<_>>();
    // Both depths as sections of the same cone of sight: which of them is nearer is all that was compared.
    to.outline(Layer::Evidence, Role::Occluder, Subject::None, section(far));
    to.outline(Layer::Evidence, Role::Current, Subject::None, section(near));
    // At opposite corners, so that they do not meet.
    label(to, at(pixels.x0, pixels.y0, far), format!("{what} {}", short(far)));
    label(to, at(pixels.x1, pixels.y1, near), format!("nearest {}", short(near)));
}

impl<S: Faces> DepthNote<S> {
    /// The primitive that was drawn, if one was.
    pub fn drawn(&self) -> Option<PrimId> {
        if let Self::Rasterized(Rasterized { prim, is_hidden: false, .. }) = self {
            Some(*prim)
        } else {
            None
        }
    }
}

impl<S: Faces> Answered<S> {
    fn draw(&self, view: &View<S>, to: &mut Drawing<S::Vector>) {
        to.bounds(Layer::Emphasis, Role::Current, Subject::Node(self.node), &self.bounds);
        // What says where it begins: the planes that face the eye.
        let fronts = if self.is_by_planes { S::front(&self.bounds, view.eye.position) } else { Vec::new() };
        for face in fronts {
            to.outline(Layer::Emphasis, Role::Current, Subject::Node(self.node), face);
        }
        if let Some(d) = self.answer.decisive {
            sight_lines(view, d.cell.pixels(view.width, view.height), d.nearest, (d.held, DRAWN), to);
        }
    }
    /// `far`: the depth of an empty pixel.
    fn sentence(&self, far: f32) -> String {
        let node = self.node;
        let near = |d: &Decisive| short(units(d.nearest));
        let by = |d: &Decisive| short((units(d.nearest) - units(d.held)).abs());
        let reads = self.answer.reads;
        let cells = if reads == 1 { "One cell was read".into() } else { format!("{reads} cells were read") };
        match (self.ground, self.answer.decisive, self.answer.is_hidden) {
            (Ground::CrossesNear, ..) => {
                format!("Node {node} crosses the near plane, so it counts as visible.")
            }
            (Ground::BesideImage, ..) => {
                format!("The box of node {node} lies beside the image: nothing of it can show.")
            }
            (Ground::Unread, ..) => format!(
                "Node {node} counts as visible: a region of the screen that it covers is held by no renderer \
                 and cannot be queried."
            ),
            (Ground::Regions, Some(d), _) => format!(
                "Node {node} is hidden: its nearest point, at depth {}, lies behind the farthest depth of \
                 every region that it covers; of these the farthest is {}, nearer by {}.",
                near(&d),
                short(units(d.held)),
                by(&d)
            ),
            (_, Some(d), true) => format!(
                "Node {node} is hidden: wherever it could show, it lies behind all that is drawn. {cells}; \
                 the closest is {}, where it begins at depth {} and the farthest thing drawn is at {}, \
                 nearer by {}.",
                place(d.cell),
                near(&d),
                short(units(d.held)),
                by(&d)
            ),
            (_, Some(d), false) => format!(
                "Node {node} may be seen: it comes as near as {}, and {}. {cells}.",
                near(&d),
                shown(d.cell, d.held, far, &format!("{} behind that", by(&d)))
            ),
            (_, None, true) => {
                format!("The image of node {node} covers no pixel's center: nothing of it can show.")
            }
            (_, None, false) => {
                format!("Node {node} counts as visible: what is drawn in its place could not be read.")
            }
        }
    }
    fn fields(&self) -> Vec<Field> {
        let mut fields = vec![
            integer("node", self.node.0),
            Field { name: "hidden", value: Value::Switch(self.answer.is_hidden) },
            Field { name: "ground", value: Value::Word(self.ground.word().into()) },
            number("nearest_depth_units", units(self.answer.nearest).into()),
            integer("cells_read", self.answer.reads),
            pixels_field(self.pixels),
            // Recorded and not looked up by the node: methods query different bounds of one.
            Field { name: "box_min", value: axes(self.bounds.min) },
            Field { name: "box_max", value: axes(self.bounds.max) },
        ];
        if let Some(d) = self.answer.decisive {
            // Of the cells that hide it the closest call, or the one that shows it; the other reads are notes
            // of their own.
            fields.extend(cell_fields(d.cell));
            fields.push(number("box_depth_units", units(d.nearest).into()));
            fields.push(number("held_depth_units", units(d.held).into()));
            fields.push(number("margin_units", f64::from(units(d.nearest)) - f64::from(units(d.held))));
        }
        fields
    }
}

fn pixels_field(r: PixelRect) -> Field {
    // Half-open along both axes, as the rectangle is.
    Field { name: "pixels", value: Value::List([r.x0, r.x1, r.y0, r.y1].map(f64::from).to_vec()) }
}
fn cell_fields(cell: PyramidCell) -> [Field; 3] {
    // Of tiles the levels are pixel, tile and block.
    let level = match cell.level {
        PyramidCell::TILE => 1,
        PyramidCell::BLOCK => 2,
        level => level,
    };
    [integer("level", level.into()), integer("column", cell.x.into()), integer("row", cell.y.into())]
}

/// One word for an outcome, as tables have it.
pub fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Behind => "behind",
        Outcome::Descends => "descend",
        Outcome::Shows => "visible",
    }
}

/// The comparison of a read as it is written beside a cell, such as `box 6, cell 9: not behind, descend`.
pub fn comparison(read: &Read) -> String {
    let then = match read.outcome {
        Outcome::Behind => "behind",
        Outcome::Descends => "not behind, descend",
        Outcome::Shows => "not behind: visible",
    };
    let cell = match read.cell.level {
        0 => "pixel",
        PyramidCell::TILE => "tile",
        PyramidCell::BLOCK => "block",
        _ => "cell",
    };
    format!("box {}, {cell} {}: {then}", short(1.0 / read.nearest), short(1.0 / read.held))
}

/// A cell in words.
pub fn place(cell: PyramidCell) -> String {
    match cell.level {
        // Level 0 is the image itself and is not called a cell.
        0 => format!("pixel ({}, {})", cell.x, cell.y),
        PyramidCell::TILE => format!("tile ({}, {})", cell.x, cell.y),
        PyramidCell::BLOCK => format!("block ({}, {})", cell.x, cell.y),
        level => format!("cell ({}, {}) of level {level}", cell.x, cell.y),
    }
}

/// What a cell holds that does not hide something: `behind` says how it lies against that.
fn shown(cell: PyramidCell, held: f32, far: f32, behind: &str) -> String {
    // A cell holds the farthest depth in it, which is at some of its pixels; nearer things may be at others.
    match (cell.level, held <= far) {
        (0, true) => format!("nothing is drawn yet at {}", place(cell)),
        (0, false) => format!("the thing drawn at {} is at {}, {behind}", place(cell), short(units(held))),
        (_, true) => format!("somewhere in {} nothing is drawn yet", place(cell)),
        (_, false) => format!(
            "somewhere in {} the farthest thing drawn is at {}, {behind}",
            place(cell),
            short(units(held))
        ),
    }
}

impl Rasterized {
    fn fields(&self) -> Vec<Field> {
        let mut fields = vec![
            integer("prim", self.prim.0),
            Field { name: "hidden", value: Value::Switch(self.is_hidden) },
        ];
        if let Some(r) = &self.tile {
            // A hidden primitive has a positive margin: it begins so far behind what is drawn.
            let (nearest, held) = (units(r.nearest), units(r.held));
            fields.extend(cell_fields(r.cell));
            fields.push(number("nearest_depth_units", nearest.into()));
            fields.push(number("held_depth_units", held.into()));
            fields.push(number("margin_units", f64::from(nearest) - f64::from(held)));
        }
        fields
    }
    /// `far`: the depth of an empty pixel.
    fn sentence<S: Faces>(&self, scene: &Scene<S>, far: f32) -> String {
        let mut text = match &self.tile {
            Some(read) => self.in_tiles::<S>(read, far),
            None => self.drawn::<S>(),
        };
        if !self.is_hidden && self.surfaces.show_through(scene, self.prim) {
            text += " It is see-through, so it leaves the depths as they are and hides nothing.";
        }
        text
    }
    /// What became of it in tiles; `read`: where it comes nearest to showing.
    fn in_tiles<S: Faces>(&self, read: &Read, far: f32) -> String {
        let (kind, prim, tile) = (S::PRIM, self.prim, place(read.cell));
        let (near, held) = (short(units(read.nearest)), short(units(read.held)));
        if self.is_hidden {
            format!(
                "The {kind} {prim} is left out: in every tile that it covers it lies behind all that is \
                 drawn. The closest is {tile}, where it begins at depth {near} and the farthest thing drawn \
                 is at {held}."
            )
        } else if read.held <= far {
            format!(
                "The {kind} {prim} is drawn: in {tile} it comes as near as {near}, and as far as the tile \
                 knows, nothing is drawn yet somewhere in it."
            )
        } else {
            format!(
                "The {kind} {prim} is drawn: in {tile} it comes as near as {near}, and as far as the tile \
                 knows, the farthest thing drawn in it is at {held}."
            )
        }
    }
    fn drawn<S: Faces>(&self) -> String {
        let (kind, prim) = (S::PRIM, self.prim);
        // Drawn in a part of the image, it is not tested: there is nothing to compare in the sentence.
        if let Some(w) = self.window {
            return format!(
                "The {kind} {prim} is rasterized in columns {} to {} and rows {} to {} of the image.",
                w.x0,
                w.x1 - 1,
                w.y0,
                w.y1 - 1
            );
        }
        if self.is_hidden {
            format!("The {kind} {prim} is left out: it lies beside the image or between pixel centers.")
        } else if self.is_tested {
            format!(
                "The {kind} {prim} is drawn: by its bounds it may show, though it covers no pixel's \
                     center."
            )
        } else {
            format!("The {kind} {prim} is drawn; no primitive is tested by itself.")
        }
    }
}
