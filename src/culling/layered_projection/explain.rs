//! The evidence of this method: as fields, as sentences, and as marks in the world.

use super::LayeredProjection;
use super::front::Front;
use super::index::{Index, cell_of, node_of};
use super::rules::{Penalizing, Transfer};
use crate::culling::depth::{Answer, Faces};
use crate::drawing::{Drawing, Layer, Mark, Role, Subject};
use crate::geometry::{CellId, NodeId, PrimId, Vector, View};
use crate::index::tessellation::Cellular;
use crate::method::evidence::{self, Facing, Tested, axes, integer, label, number, short};
use crate::method::{self, Claim, Context, Field, Frame, Note, Tallied, Tally, Value, Words};
use crate::scene::Scene;

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub enum Evidence<S: Cellular> {
    /// A cell to begin with was found.
    Seeded(Seeded),
    /// A box against the frustum.
    Tested(Tested<S>),
    /// A primitive's orientation.
    Facing(Facing),
    /// Solidity was handed on.
    Transferred(Transferred<S::Vector>),
    /// A cell was projected.
    Projected(Projected),
    /// A primitive was drawn that meets several cells.
    Drawn(Drawn),
    /// The budget is spent, and a cell's box was compared with the z-buffer.
    Queried(Queried),
    /// The same of a primitive that no cell drew.
    Compared(Compared),
    /// The budget is spent, and what the rest could still change was found.
    Bounded(Bounded),
    /// The budget is spent, and nothing asks for more.
    Spent(Spent),
    /// The front is empty.
    Ended(Ended),
    /// A cell or a primitive that the budget left out.
    LeftOut(LeftOut),
    /// A primitive that no cell in view holds.
    Unreached(Unreached),
}

/// A cell from which the front grows.
#[derive(Clone, Copy, Debug)]
pub struct Seeded {
    pub cell: CellId,
    /// From the Eye, world units; 0 if the cell holds it.
    pub distance: f32,
    pub origin: Origin,
}

/// Why a front begins at a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// It holds the Eye.
    Eye,
    /// It is the closest to the Eye, which is outside of all cells.
    Closest,
    /// The Eye is outside of all cells, and of those in view that hold something its box is the nearest.
    Nearest,
    /// It is the first that holds something on a ray from the Eye.
    Ray,
    /// The front had run dry, and of the cells in view that hold something and were not reached its box is
    /// the nearest.
    Again,
}

/// The operands of Figure 5.
#[derive(Clone, Copy, Debug)]
pub struct Transferred<V> {
    pub a: CellId,
    pub b: CellId,
    /// |A| and ρ_max.
    pub held: u32,
    pub most: u32,
    /// What A adds: |A| / ρ_max, or the part of it that faces the Eye.
    // Kept besides the two, whose quotient it is only where every primitive counts one.
    pub share: f32,
    /// v, a unit vector: where the Eye looks, or from the Eye to the center of B.
    pub sight: V,
    /// n(B), unit normal of the shared face toward B.
    pub normal: V,
    pub transfer: Transfer,
    /// The part of ρ(A) that is handed on: v · n(B), or 1.
    pub along: f32,
    /// ρ(A).
    pub of_a: f32,
    pub star_shaped: bool,
    /// How a penalty is applied, if it is not star-shaped.
    pub penalizing: Penalizing,
    /// ρ(B), penalty included.
    pub solidity: f32,
    /// What B had in the front.
    pub before: Option<f32>,
    /// Whether B keeps that.
    pub keeps: bool,
}

impl Origin {
    fn word(self) -> &'static str {
        match self {
            Self::Eye => "eye",
            Self::Closest => "closest",
            Self::Nearest => "nearest",
            Self::Ray => "ray",
            Self::Again => "again",
        }
    }
}

impl<V> Transferred<V> {
    /// ρ(B) before the penalty.
    pub fn sum(&self) -> f32 {
        // Not kept: the same operations on the same operands give what the run had, to the last bit.
        self.share + self.along * self.of_a
    }
}

/// A cell was taken from the front and drawn.
#[derive(Clone, Copy, Debug)]
pub struct Projected {
    pub cell: CellId,
    pub rank: u32,
    pub solidity: f32,
    /// The least solidity of the rest of the front.
    pub next: Option<f32>,
    pub held: u32,
    /// Of these, drawn now.
    pub drawn: u32,
    /// Of these, left out since the budget ended.
    pub cut_off: u32,
    /// Of the budget.
    pub left: u32,
    pub is_in_view: bool,
}

/// A primitive that meets several cells was drawn: with the first of them, or with none, where a wanted
/// quality asked for it.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    pub prim: PrimId,
    pub cell: Option<CellId>,
}

/// A cell that the budget left out was compared with what is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Queried {
    pub cell: CellId,
    pub solidity: f32,
    pub answer: Answer,
}

/// A primitive that meets several cells, none of which was drawn, was compared with what is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    pub prim: PrimId,
    /// Its nearest depth in the tile in which it comes nearest to showing, and the farthest that is drawn
    /// there, `1/w`; `None` where it covers no pixel, or only its bounds may show.
    pub depths: Option<[f32; 2]>,
    pub is_hidden: bool,
}

/// How much of the image the rest could still change.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    /// Of the image, and how much is allowed.
    pub share: f32,
    pub most: f32,
    /// Primitives drawn so far.
    pub drawn: u32,
}

/// The budget was spent with a cell.
#[derive(Clone, Copy, Debug)]
pub struct Spent {
    pub cell: CellId,
    pub solidity: f32,
    /// Cells projected, and primitives drawn.
    pub cells: u32,
    pub drawn: u32,
    /// Primitives of this cell that are left out.
    pub cut_off: u32,
}

/// The front is empty.
#[derive(Clone, Copy, Debug)]
pub struct Ended {
    pub cells: u32,
    pub left: u32,
}

/// What the budget left out, and how much more of it would have drawn it.
#[derive(Clone, Copy, Debug)]
pub struct LeftOut {
    /// The cell that was left out, or that would have drawn the primitive.
    pub cell: CellId,
    pub prim: Option<PrimId>,
    /// Solidity and place in the front, from 1, when the budget was spent; `None` if it did not wait there.
    pub queued: Option<(f32, u32)>,
    /// The cell that was projected last, and its solidity.
    pub last: CellId,
    pub of_last: f32,
    /// Primitives that the budget was too small by: for the primitive, or for all of the cell.
    pub more: u32,
}

/// A primitive none of whose cells is in view.
#[derive(Clone, Copy, Debug)]
pub struct Unreached {
    pub prim: PrimId,
}

/// Projected cells that are numbered in a picture, the latest ones: far more than fit at [`LABELS_APART`],
/// since cells in one place take each other's room.
const NUMBERED: usize = 64;
/// The least distance of two labels, as a part of the scene's diagonal: at the width of a figure a number of
/// three digits fits.
const LABELS_APART: f32 = 0.06;
/// Cells of the front that are outlined in space, where more would hide each other and the scene.
const NEXT_IN_SPACE: usize = 24;
/// Cells of the front that are tried as labels in a picture of flatland: at [`LABELS_APART`] about as many
/// fit a square.
const LABELED: usize = 200;

impl<S: Cellular> Evidence<S> {
    /// Changes the front as the run did, which calls the same functions where it records these notes.
    pub fn apply(&self, front: &mut Front) {
        match self {
            // As in `Walk::grow_from`: where a front begins, nothing was handed on.
            Self::Seeded(n) => front.put(n.cell, 0.0, true),
            // B keeps its value and, what matters among equals, its time stamp.
            Self::Transferred(n) if n.keeps => {}
            Self::Transferred(n) => front.put(n.b, n.solidity, n.star_shaped),
            Self::Projected(n) => front.project(n.cell),
            // One that is not hidden leaves by the note of its projection.
            Self::Queried(n) if n.answer.is_hidden => front.leave_out(n.cell),
            _ => {}
        }
    }
}

impl<S: Cellular> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Seeded(_) => tally.add("seeds", 1),
            Self::Tested(n) => n.tally(tally),
            Self::Facing(_) => Facing::tally(tally),
            Self::Transferred(n) => {
                tally.add("solidities_updated", 1);
                tally.add("penalties", (!n.star_shaped).into());
                // Those for which Figure 4 has to remove and reinsert.
                tally.add("cells_requeued", (n.before.is_some() && !n.keeps).into());
            }
            Self::Projected(n) => {
                tally.add("cells_projected", 1);
                // Each costs a step of the traversal and none of the budget.
                tally.add("empty_cells_projected", (n.held == 0).into());
            }
            Self::Queried(n) => {
                tally.add("cells_asked", 1);
                tally.add("cells_hidden", n.answer.is_hidden.into());
            }
            Self::Bounded(_) => tally.add("bounds_found", 1),
            Self::Drawn(_)
            | Self::Compared(_)
            | Self::Spent(_)
            | Self::Ended(_)
            | Self::LeftOut(_)
            | Self::Unreached(_) => {}
        }
    }
}

impl<S: Cellular> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Seeded(_) => "CellSeeded",
            Self::Tested(n) => n.kind(),
            Self::Facing(_) => "OrientationTested",
            Self::Transferred(_) => "SolidityTransferred",
            Self::Projected(_) => "CellProjected",
            Self::Drawn(_) => "PrimDrawn",
            Self::Queried(_) => "CellAsked",
            Self::Compared(_) => "PrimCompared",
            Self::Bounded(_) => "DoubtBounded",
            Self::Spent(_) => "BudgetSpent",
            Self::Ended(_) => "TraversalEnded",
            Self::LeftOut(LeftOut { prim: None, .. }) => "CellLeftOut",
            Self::LeftOut(_) => "PrimLeftOut",
            Self::Unreached(_) => "PrimUnreached",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Seeded(n) => Subject::Node(node_of(n.cell)),
            Self::Tested(n) => n.subject(),
            Self::Facing(n) => n.subject(),
            Self::Transferred(n) => Subject::Node(node_of(n.b)),
            Self::Projected(n) => Subject::Node(node_of(n.cell)),
            Self::Drawn(n) => Subject::Prim(n.prim),
            Self::Queried(n) => Subject::Node(node_of(n.cell)),
            Self::Compared(n) => Subject::Prim(n.prim),
            Self::Spent(n) => Subject::Node(node_of(n.cell)),
            Self::LeftOut(n) => n.prim.map_or(Subject::Node(node_of(n.cell)), Subject::Prim),
            Self::Unreached(n) => Subject::Prim(n.prim),
            // About all cells, which are below the root.
            Self::Bounded(_) | Self::Ended(_) => Subject::Node(NodeId(0)),
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            Self::Queried(n) => n.answer.is_hidden.then_some(Claim::Hidden),
            Self::Compared(n) => n.is_hidden.then_some(Claim::Hidden),
            Self::Unreached(_) => Some(Claim::Hidden),
            // Solidity is a guess: it proves nothing.
            Self::Seeded(_)
            | Self::Transferred(_)
            | Self::Projected(_)
            | Self::Drawn(_)
            | Self::Bounded(_)
            | Self::Spent(_)
            | Self::Ended(_)
            | Self::LeftOut(_) => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<method::Compared> {
        let of = |found: (&'static str, f32), with: (&'static str, f32)| {
            Some(method::Compared::of((found.0, found.1.into()), (with.0, with.1.into())))
        };
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            Self::Transferred(n) => of(("its solidity", n.solidity), ("in the front", n.before?)),
            Self::Projected(n) => of(("its solidity", n.solidity), ("the next least", n.next?)),
            // Buffers hold 1/w, people compare depths.
            Self::Queried(n) => {
                let d = n.answer.decisive?;
                of(("nearest depth", 1.0 / d.nearest), ("farthest drawn there", 1.0 / d.held))
            }
            Self::Compared(n) => {
                let [nearest, held] = n.depths?.map(|depth| 1.0 / depth);
                of(("nearest depth", nearest), ("farthest drawn there", held))
            }
            Self::Bounded(n) => of(("% that could change", 100.0 * n.share), ("% allowed", 100.0 * n.most)),
            Self::LeftOut(n) => of(("its solidity", n.queued?.0), ("of the last projected", n.of_last)),
            Self::Seeded(_) | Self::Drawn(_) | Self::Spent(_) | Self::Ended(_) | Self::Unreached(_) => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        let word = |name, v: &str| Field { name, value: Value::Word(v.into()) };
        let switch = |name, v| Field { name, value: Value::Switch(v) };
        match self {
            Self::Seeded(n) => vec![
                integer("node", node_of(n.cell).0),
                number("distance_units", n.distance.into()),
                word("origin", n.origin.word()),
            ],
            Self::Tested(n) => n.fields(context),
            Self::Facing(n) => n.fields(context),
            Self::Transferred(n) => transfer_fields(n),
            Self::Projected(n) => vec![
                integer("node", node_of(n.cell).0),
                integer("rank", n.rank),
                number("solidity", n.solidity.into()),
                integer("held", n.held),
                integer("drawn", n.drawn),
                integer("left_out", n.cut_off),
                integer("budget_left", n.left),
                switch("in_view", n.is_in_view),
            ],
            Self::Drawn(n) => {
                let cell = n.cell.map(|cell| integer("node", node_of(cell).0));
                [integer("prim", n.prim.0)].into_iter().chain(cell).collect()
            }
            Self::Queried(n) => vec![
                integer("node", node_of(n.cell).0),
                number("solidity", n.solidity.into()),
                // In the cell that decided. Without one the box covers no pixel or reaches the near plane.
                number("nearest", n.answer.decisive.map_or(n.answer.nearest, |d| d.nearest).into()),
                number("held", n.answer.decisive.map_or(0.0, |d| d.held.into())),
                integer("reads", n.answer.reads),
                switch("hidden", n.answer.is_hidden),
            ],
            Self::Compared(n) => {
                let depths = n.depths.map_or(Vec::new(), |d| d.map(f64::from).to_vec());
                vec![
                    integer("prim", n.prim.0),
                    Field { name: "nearest_and_held", value: Value::List(depths) },
                    switch("hidden", n.is_hidden),
                ]
            }
            Self::Bounded(n) => vec![
                number("share", n.share.into()),
                number("allowed", n.most.into()),
                integer("drawn", n.drawn),
            ],
            Self::Spent(n) => vec![
                integer("node", node_of(n.cell).0),
                number("solidity", n.solidity.into()),
                integer("cells", n.cells),
                integer("drawn", n.drawn),
                integer("left_out", n.cut_off),
            ],
            Self::Ended(n) => vec![integer("cells", n.cells), integer("budget_left", n.left)],
            Self::LeftOut(n) => left_out_fields(n),
            Self::Unreached(n) => vec![integer("prim", n.prim.0)],
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        let prims = S::PRIM;
        match self {
            Self::Seeded(n) => seed_sentence(n),
            Self::Tested(n) => n.sentence(context),
            Self::Facing(n) => n.sentence(context),
            Self::Transferred(n) => transfer_sentence::<S>(n),
            Self::Projected(n) => projection_sentence::<S>(n),
            Self::Drawn(Drawn { prim, cell: Some(cell) }) => format!(
                "Node {} is the first projected of the cells that the {prims} {prim} meets: it is drawn.",
                node_of(*cell)
            ),
            Self::Drawn(Drawn { prim, cell: None }) => format!(
                "The {prims} {prim} may reach through the near plane, so nothing bounds what it could \
                 change: it is drawn."
            ),
            Self::Queried(n) => query_sentence(n, 1.0 / context.view.eye.far),
            Self::Compared(n) => comparison_sentence::<S>(n),
            Self::Bounded(n) => format!(
                "After {} {prims}s what is left could still change {} % of the image; {} % are allowed: {}.",
                n.drawn,
                short(100.0 * n.share),
                short(100.0 * n.most),
                if n.share > n.most { "the budget grows by half" } else { "that is enough" }
            ),
            // Not the same to a student: a spent budget may leave out what is visible, an empty front has
            // left nothing in view.
            Self::Spent(n) => format!(
                "The budget is spent with node {}, projected as number {} at solidity {}, after {}. {} left \
                 out.",
                node_of(n.cell),
                n.cells,
                short(n.solidity),
                many(n.drawn, S::PRIM),
                match n.cut_off {
                    0 => "Nothing in it is".to_owned(),
                    1 => format!("1 {prims} in it is"),
                    more => format!("{more} {prims}s in it are"),
                }
            ),
            Self::Ended(n) => {
                format!(
                    "The front is empty after {}; {} of the budget left.",
                    many(n.cells, "cell"),
                    is(n.left)
                )
            }
            Self::LeftOut(n) => left_out_sentence::<S>(n),
            Self::Unreached(n) => {
                format!("No cell that the {prims} {} meets is in view: nothing of it can be seen.", n.prim)
            }
        }
    }
}

/// Such as `1 cell` or `12 cells`.
pub(super) fn many(count: u32, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Such as `1 is` or `12 are`.
fn is(count: u32) -> String {
    format!("{count} {}", if count == 1 { "is" } else { "are" })
}

fn projection_sentence<S: Cellular>(n: &Projected) -> String {
    let taken = format!(
        "Node {} has the least solidity of the front, {}; it is projected as number {}",
        node_of(n.cell),
        short(n.solidity),
        n.rank + 1
    );
    let left = format!("{} of the budget left", is(n.left));
    if !n.is_in_view {
        return format!("{taken}. It is out of view, so nothing of it is drawn; {left}.");
    }
    if n.held == 0 {
        return format!("{taken}. It is empty; {left}.");
    }
    // "Now": the others were drawn with an earlier cell, were culled, or found no budget.
    let drawn = format!("of the {} that meet it {} drawn now", many(n.held, S::PRIM), is(n.drawn));
    match n.cut_off {
        0 => format!("{taken}: {drawn}; {left}."),
        cut_off => format!("{taken}: {drawn} and {} left out, for the budget ends here.", is(cut_off)),
    }
}

/// The operands of a transfer.
fn transfer_fields<V: Vector>(n: &Transferred<V>) -> Vec<Field> {
    let word = |name, v: &str| Field { name, value: Value::Word(v.into()) };
    let switch = |name, v| Field { name, value: Value::Switch(v) };
    vec![
        // By their nodes, the numbers by which every view and trace names cells.
        integer("from_node", node_of(n.a).0),
        integer("node", node_of(n.b).0),
        integer("held", n.held),
        integer("rho_max", n.most),
        number("share", n.share.into()),
        Field { name: "view_direction", value: axes(n.sight) },
        Field { name: "normal", value: axes(n.normal) },
        number("alignment", n.along.into()),
        number("from_solidity", n.of_a.into()),
        // Before the penalty; `solidity` is after it.
        number("transferred", n.sum().into()),
        switch("star_shaped", n.star_shaped),
        word("penalty_as", n.penalizing.word()),
        number("solidity", n.solidity.into()),
        switch("keeps", n.keeps),
    ]
}

fn left_out_fields(n: &LeftOut) -> Vec<Field> {
    let mut fields: Vec<Field> = n.prim.map(|prim| integer("prim", prim.0)).into_iter().collect();
    fields.push(integer("node", node_of(n.cell).0));
    if let Some((solidity, place)) = n.queued {
        fields.extend([number("solidity", solidity.into()), integer("place", place)]);
    }
    fields.extend([
        integer("last_node", node_of(n.last).0),
        number("last_solidity", n.of_last.into()),
        integer("budget_short", n.more),
    ]);
    fields
}

fn left_out_sentence<S: Cellular>(n: &LeftOut) -> String {
    let (node, last, of_last) = (node_of(n.cell), node_of(n.last), short(n.of_last));
    let larger = format!("With a budget larger by {}", n.more);
    if n.cell == n.last {
        let name = n.prim.map_or_else(|| format!("all of node {node}"), |p| format!("the {} {p}", S::PRIM));
        return format!(
            "The budget ended in node {node}, of solidity {of_last}. {larger} {name} would be drawn."
        );
    }
    // Why it was not its turn, in the terms of the front.
    let waits = match n.queued {
        Some((solidity, place)) => format!(
            "waits at place {place} of the front with solidity {}, and the last cell projected, node {last}, \
             had {of_last}",
            short(solidity)
        ),
        None => {
            format!("is not in the front yet; the last cell projected, node {last}, had solidity {of_last}")
        }
    };
    match n.prim {
        Some(prim) => format!(
            "Of the cells that the {} {prim} meets node {node} would draw it first. It {waits}. {larger} the \
             {} would be drawn.",
            S::PRIM,
            S::PRIM
        ),
        None => format!("Node {node} {waits}. {larger} all in it that is in view would be drawn."),
    }
}

fn seed_sentence(n: &Seeded) -> String {
    let (node, distance) = (node_of(n.cell), short(n.distance));
    match n.origin {
        Origin::Eye => format!("The Eye is in the cell of node {node}: the front begins there."),
        Origin::Closest => format!(
            "The Eye is outside of all cells; the cell closest to it is node {node}, {distance} units away: \
             the front begins there."
        ),
        Origin::Nearest => format!(
            "The Eye is outside of all cells. Of those in view that hold something node {node} has the \
             nearest box, {distance} units away: the front begins there."
        ),
        Origin::Ray => {
            format!(
                "On a ray from the Eye, {distance} units away, node {node} is the first that holds \
                 something: the front begins there too."
            )
        }
        Origin::Again => {
            format!(
                "The front is empty and budget is left. Of the cells in view that hold something and were \
                 not reached node {node} has the nearest box, {distance} units away: a new front begins \
                 there."
            )
        }
    }
}

fn comparison_sentence<S: Cellular>(n: &Compared) -> String {
    let name = format!("The {} {}", S::PRIM, n.prim);
    let end = if n.is_hidden { "it is hidden" } else { "it is drawn" };
    // Buffers hold 1/w; sentences give depths, of which the greater is the farther.
    match n.depths.map(|depths| depths.map(|depth| short(1.0 / depth))) {
        Some([nearest, held]) => format!(
            "{name} begins at depth {nearest}, and the farthest that is drawn where it would show is at \
             {held}: {end}."
        ),
        None if n.is_hidden => format!("{name} covers no pixel's center: {end}."),
        None => format!("By its bounds the {} {} may show: {end}.", S::PRIM, n.prim),
    }
}

/// `empty` is what the buffer holds where nothing is drawn.
fn query_sentence(n: &Queried, empty: f32) -> String {
    let node = node_of(n.cell);
    let depth = |v: f32| short(1.0 / v);
    match (n.answer.is_hidden, n.answer.decisive) {
        (true, Some(d)) => {
            format!(
                "Node {node} begins at depth {}, behind {}, the farthest that is drawn where it would show: \
                 it is hidden.",
                depth(d.nearest),
                depth(d.held)
            )
        }
        // It is in view, but nothing of it could be drawn.
        (true, None) => format!("Node {node} covers no pixel's center: it is hidden."),
        (false, Some(d)) if d.held <= empty => {
            format!("Somewhere where node {node} would show nothing is drawn yet: it is projected.")
        }
        (false, Some(d)) => {
            format!(
                "Node {node} begins at depth {}, and somewhere where it would show the farthest thing drawn \
                 is at {}, not before it: it is projected.",
                depth(d.nearest),
                depth(d.held)
            )
        }
        (false, None) => format!("Node {node} reaches the near plane: it is projected."),
    }
}

fn transfer_sentence<S: Cellular>(n: &Transferred<S::Vector>) -> String {
    let (a, b) = (node_of(n.a), node_of(n.b));
    // The formula of line 1 that ran, with names, then with numbers.
    let (part, product) = match n.transfer {
        Transfer::Whole => ("ρ(A)", short(n.of_a)),
        Transfer::Aligned => ("(v · n) ρ(A)", format!("{} × {}", short(n.along), short(n.of_a))),
    };
    // The same division as the run's: equal results say how primitives were counted, or that it does not
    // matter.
    let (name, share) = if n.share == n.held as f32 / n.most.max(1) as f32 {
        ("|A| / ρ_max", format!("{} / {}", n.held, n.most))
    } else {
        ("what of A faces the Eye, of ρ_max", short(n.share))
    };
    let terms = format!("{share} + {product} = {}", short(n.sum()));
    // Why a penalty is due, in terms of the ray that the picture shows.
    let star = if n.star_shaped {
        String::new()
    } else {
        let penalized = match n.penalizing {
            Penalizing::Factor => "times the penalty factor it has",
            Penalizing::Sum => "with the penalty added it has",
        };
        format!(
            " The way from its center to the Eye does not leave through that face: it is not star-shaped, \
             and {penalized} {}.",
            short(n.solidity)
        )
    };
    // Old and new value together explain why a cell moves in the queue.
    let before = match n.before {
        Some(v) if n.keeps => format!(" It keeps the {} that it has in the front.", short(v)),
        Some(v) => format!(" It had {} in the front.", short(v)),
        None => String::new(),
    };
    format!("Node {a} hands its solidity on to node {b}: {name} + {part} = {terms}.{star}{before}")
}

/// Numbers the latest projected cells and writes the solidities of the front, the latest and the least solid
/// first, as far as labels do not meet when the whole scene is shown.
fn labels<S: Cellular>(front: &Front, scene: &Scene<S>, index: &Index<S>, to: &mut Drawing<S::Vector>) {
    // In world units: zooming in makes room, and the labels stay those of the whole picture.
    let apart = scene.bounds().diagonal() * LABELS_APART;
    let numbered = front.projected().iter().enumerate().rev().take(NUMBERED);
    let projected = numbered.map(|(at, &cell)| (cell, format!("#{}", at + 1)));
    let front = front.first(LABELED).into_iter().map(|q| (q.cell, short(q.solidity)));
    // First come, first served: the projected ones, which are few and certain, before the front.
    let mut taken: Vec<S::Vector> = Vec::new();
    for (cell, text) in projected.chain(front) {
        let at = index.cells.any().center(cell);
        if taken.iter().all(|&t| (t - at).length() > apart) {
            taken.push(at);
            label(to, at, text);
        }
    }
}

/// Draws the front, the latest projected cells, and the evidence of a note.
pub fn draw<S: Cellular + Faces>(
    front: &Front,
    frame: &Frame<'_, S, LayeredProjection>,
    note: Option<&Evidence<S>>,
    to: &mut Drawing<S::Vector>,
) {
    let Frame { index, scene, view, .. } = *frame;
    // The front itself: in the plane all of it, in space what is next.
    let shown = if S::Vector::AXES == 2 { usize::MAX } else { NEXT_IN_SPACE };
    let next = front.first(shown).into_iter();
    next.for_each(|queued| outline(index, queued.cell, Layer::Nodes, Role::Undecided, to));
    if S::Vector::AXES == 2 {
        labels(front, scene, index, to);
    }
    // What the step is about, over it.
    match note {
        Some(Evidence::Tested(n)) => n.draw(view, to),
        Some(Evidence::Facing(n)) => n.draw(scene, view, to),
        Some(Evidence::Seeded(n)) => {
            outline(index, n.cell, Layer::Emphasis, Role::Current, to);
            to.line(
                Layer::Evidence,
                Role::Evidence,
                Subject::Node(node_of(n.cell)),
                [view.eye.position, index.cells.any().center(n.cell)],
            );
        }
        Some(Evidence::Projected(n)) => outline(index, n.cell, Layer::Emphasis, Role::Current, to),
        Some(Evidence::Queried(n)) => {
            let role = if n.answer.is_hidden { Role::Hidden } else { Role::Current };
            outline(index, n.cell, Layer::Emphasis, role, to);
        }
        Some(Evidence::Drawn(n)) => {
            n.cell.into_iter().for_each(|cell| outline(index, cell, Layer::Emphasis, Role::Partial, to));
            evidence::outline(scene, n.prim, to);
        }
        Some(Evidence::Compared(n)) => evidence::outline(scene, n.prim, to),
        Some(Evidence::Transferred(n)) => draw_transfer(n, index, view, to),
        Some(Evidence::Spent(n)) => outline(index, n.cell, Layer::Emphasis, Role::Current, to),
        // Beside the cell that it waits for the one that was the last before it.
        Some(Evidence::LeftOut(n)) => {
            outline(index, n.last, Layer::Emphasis, Role::Partial, to);
            outline(index, n.cell, Layer::Emphasis, Role::Current, to);
            n.prim.into_iter().for_each(|prim| evidence::outline(scene, prim, to));
        }
        Some(Evidence::Unreached(n)) => evidence::outline(scene, n.prim, to),
        // About all cells, so there is no place to point at.
        Some(Evidence::Bounded(_) | Evidence::Ended(_)) | None => {}
    }
}

/// Figure 6: both cells, the normal of the face between them, the view direction, and the ray of the
/// star-shape test.
fn draw_transfer<S: Cellular>(
    n: &Transferred<S::Vector>,
    index: &Index<S>,
    view: &View<S>,
    to: &mut Drawing<S::Vector>,
) {
    let cells = index.cells.any();
    // The two cells: A, just projected, and B beside it.
    outline(index, n.a, Layer::Emphasis, Role::Partial, to);
    outline(index, n.b, Layer::Emphasis, Role::Current, to);
    let (a, b) = (cells.center(n.a), cells.center(n.b));
    // As long as shows in the cell and does not reach the next one.
    let length = 0.4 * cells.bounds(n.b).diagonal();
    let subject = Subject::Node(node_of(n.b));
    // Both unit vectors from the center of A at one length, so that v · n is read off the angle.
    to.push(Layer::Evidence, Role::Evidence, subject, Mark::Arrow(a, a + n.normal * length));
    label(to, a + n.normal * length, "n".into());
    to.push(Layer::Evidence, Role::Eye, subject, Mark::Arrow(a, a + n.sight * length));
    label(to, a + n.sight * length, "v".into());
    // The test for the penalty: whether this ray leaves B through the face to A.
    to.line(
        Layer::Evidence,
        if n.star_shaped { Role::Faint } else { Role::Hidden },
        subject,
        [b, view.eye.position],
    );
    to.push(Layer::Evidence, Role::Evidence, subject, Mark::Dot { at: b, radius_pt: 2.5 });
}

fn outline<S: Cellular>(
    index: &Index<S>,
    cell: CellId,
    layer: Layer,
    role: Role,
    to: &mut Drawing<S::Vector>,
) {
    debug_assert_eq!(cell_of(node_of(cell)), Some(cell), "a cell and its node name each other");
    // By the edges of the cell: the boxes of tetrahedra overlap, and the faces matter that solidity goes
    // through.
    for edge in index.cells.any().edges(cell) {
        to.line(layer, role, Subject::Node(node_of(cell)), edge);
    }
}
