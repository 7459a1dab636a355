//! The evidence of this method: as fields, as sentences, and as marks in the world.

use super::LargeOccluders;
use super::index::Index;
use super::joint::{Candidate, Members};
use super::memory::Owner;
use super::occluders::Occluders;
use super::relation::{Classified, Decisive, EdgeTest, EyeSide, Margin, Occlusion, Planes, Reason, Relation};
use super::space::{Point, Shape, corner};
use crate::drawing::words::capitalized;
use crate::drawing::{Drawing, Layer, Mark, Role, Subject};
use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Vector, View};
use crate::method::evidence::{Facing, Tested, integer, label, number, outline as prim_outline, short};
use crate::method::{Claim, Compared, Context, Field, Frame, Hiders, Note, Tallied, Tally, Value};

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub enum Evidence<S: Shape> {
    /// An occluder is active in this frame.
    Chosen(Chosen),
    /// A box against the frustum.
    Tested(Tested<S>),
    /// The eye against the two planes through one edge of an occluder that touch a box.
    Edge(Edge),
    /// A box against one occluder.
    Related(Related),
    /// A box against connected occluders together.
    Joined(Joined),
    /// A primitive's orientation.
    Facing(Facing),
    /// A primitive with parts in several nodes.
    Parted(Parted),
}

/// A primitive with parts in several nodes was decided by them.
#[derive(Clone, Copy, Debug)]
pub struct Parted {
    pub prim: PrimId,
    /// The node with a part that may be seen; if there is none, that whose plane it crosses.
    pub node: NodeId,
    pub is_seen: bool,
}

/// An occluder was picked, by its area-angle from the eye, from the list of the eye's leaf and direction.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    pub occluder: u32,
    pub name: PrimId,
    // Kept, not looked up: a reader of the note has scene and view, and neither the lists nor the last frame.
    rank: u32,
    area_angle: f32,
    /// `None` for an Eye outside of the scene's box.
    leaf: Option<NodeId>,
    direction: u32,
    /// Not in the set of the frame before.
    new: bool,
}

impl Chosen {
    /// An occluder of a list with its rank there.
    pub fn of<S: Shape>(
        occluders: &Occluders<S>,
        id: u32,
        rank: usize,
        area_angle: f32,
        leaf: Option<NodeId>,
        direction: u32,
        new: bool,
    ) -> Self {
        Self { occluder: id, name: occluders.name(id), rank: rank as u32, area_angle, leaf, direction, new }
    }
}

/// The planes of an edge were tested, on the way to a [`Related`].
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    pub owner: Owner,
    pub occluder: u32,
    pub name: PrimId,
    side: i8,
    /// The edge, and how many the occluder has.
    pub edge: u8,
    edges: u8,
    /// `None`: the edge's line meets the box.
    pub test: Option<EdgeTest>,
}

impl Edge {
    /// The planes of edge `edge` of a relation were tested.
    pub fn of<S: Shape>(
        occluders: &Occluders<S>,
        owner: Owner,
        relation: &Relation<S>,
        edge: usize,
        test: Option<EdgeTest>,
    ) -> Self {
        let (occluder, side) = (relation.occluder, relation.side);
        let (edge, edges) = (edge as u8, relation.planes.len() as u8);
        Self { owner, occluder, name: occluders.name(occluder), side, edge, edges, test }
    }
    /// Whether the eye is outside of both planes, or of the separating one where that alone counts.
    fn fails(test: &EdgeTest) -> bool {
        test.separating <= 0.0 && (test.needed.is_finite() || test.supporting <= 0.0)
    }
    /// The plane that decided about the edge: whether it is the supporting one.
    fn is_by_supporting(test: &EdgeTest) -> bool {
        !Self::fails(test) && test.needed.is_finite()
    }
    fn result(&self) -> &'static str {
        match &self.test {
            None => "crossing",
            Some(test) if Self::fails(test) => "outside",
            Some(test) if test.supporting >= test.needed => "inside",
            Some(_) => "between",
        }
    }
    fn sentence<S: Shape>(&self, context: &Context<'_, S>) -> String {
        let plane = plane_word::<S>();
        let who = owner_name(context, self.owner);
        let head = format!(
            "{} {} of {} of the occluder of {} {}",
            if S::Vector::AXES == 2 { "End" } else { "Edge" },
            self.edge + 1,
            self.edges,
            S::PRIM,
            self.name
        );
        let Some(test) = self.test else {
            return format!("{head}: its line meets {who}, so no {plane} through it supports {who}.");
        };
        let (supporting, separating) = (test.supporting as f32, test.separating as f32);
        if Self::fails(&test) {
            return format!("{head}: the eye is outside its separating {plane}, by {}.", units(-separating));
        }
        if !test.needed.is_finite() {
            return format!(
                "{head}: the eye is inside its separating {plane} or its supporting one, which is all that \
                 counts, since the occluder cuts {who}."
            );
        }
        let head = format!("{head}: the eye is inside its separating {plane}, by {}", units(separating));
        let needed = short(test.needed as f32);
        if test.supporting < 0.0 {
            format!("{head}, and outside its supporting one, by {}.", units(-supporting))
        } else if test.supporting < test.needed {
            format!(
                "{head}; inside its supporting one by {}, less than the {needed} needed.",
                units(supporting)
            )
        } else {
            format!(
                "{head}, and inside its supporting one, by {}, where {needed} are needed.",
                units(supporting)
            )
        }
    }
    fn compared(&self) -> Option<Compared> {
        let test = self.test?;
        Some(if Self::is_by_supporting(&test) {
            Compared::of(("inside the supporting", test.supporting), ("needed", test.needed))
        } else {
            Compared::of(("inside the separating", test.separating), ("needed", 0.0))
        })
    }
}

/// A plane of space is a line of flatland.
fn plane_word<S: Shape>() -> &'static str {
    if S::Vector::AXES == 2 { "line" } else { "plane" }
}

/// A length in a sentence.
fn units(length: f32) -> String {
    let length = short(length);
    if length == "1" { "1 unit".into() } else { format!("{length} units") }
}

/// A box was classified against an occluder.
#[derive(Clone, Copy, Debug)]
pub struct Related {
    pub owner: Owner,
    occluder: u32,
    pub name: PrimId,
    side: i8,
    pub occlusion: Occlusion,
    // How many planes there are, and how many of the supporting ones are satisfied: a picture makes them
    // again, but a sentence has no index to make them from.
    edges: u8,
    satisfied: u8,
    /// The planes were kept from an earlier frame.
    pub reused: bool,
    /// Distances of the box's nearest and farthest corner behind the occluder, and of the eye before it.
    behind: [f64; 2],
    height: f64,
    /// What decided.
    pub reason: Reason,
}

impl Related {
    /// The operands of a classification.
    #[expect(clippy::too_many_arguments, reason = "the operands of one test")]
    pub fn of<S: Shape>(
        occluders: &Occluders<S>,
        owner: Owner,
        relation: &Relation<S>,
        eye_side: &EyeSide<S>,
        seen: Classified,
        depth: f64,
        margin: Margin,
        reused: bool,
    ) -> Self {
        let thickness = occluders.thickness(relation.occluder);
        let tests = relation.edge_tests(eye_side, depth, margin).flatten();
        Self {
            owner,
            occluder: relation.occluder,
            name: occluders.name(relation.occluder),
            side: relation.side,
            occlusion: seen.occlusion,
            edges: relation.planes.len() as u8,
            satisfied: tests.filter(|test| test.supporting >= test.needed).count() as u8,
            reused,
            behind: relation.behind,
            height: eye_side.height,
            // The run itself never asks for it: notes are made only where someone listens.
            reason: relation.reason(eye_side, seen, thickness, depth, margin),
        }
    }
    fn result(&self) -> &'static str {
        match self.occlusion {
            Occlusion::None => "none",
            Occlusion::Partial => "partial",
            Occlusion::Full => "full",
        }
    }
    fn decisive(&self) -> Option<Decisive> {
        if let Reason::Plane(d) = self.reason { Some(d) } else { None }
    }

    fn sentence<S: Shape>(&self, context: &Context<'_, S>) -> String {
        let (who, by) = (owner_name(context, self.owner), occluder_name(context, self.name));
        let kept = if self.reused { " The planes were kept from an earlier frame." } else { "" };
        let plane = plane_word::<S>();
        let why = match self.reason {
            // Section 2: "A can occlude T only if the viewpoint lies in that half-space of A which does not
            // contain T."
            Reason::Before => format!("{who} lies wholly on the eye's side of {by}: no occlusion."),
            // A departure: the half-space of the paper says none here, but parts of the box may lie behind.
            Reason::Cut => format!(
                "The {plane} of {by} cuts {who}: only what lies behind it can be occluded, so partial \
                 occlusion."
            ),
            // Region 1 of Figure 2.
            Reason::Plane(d) if self.occlusion == Occlusion::None => format!(
                "The eye is outside a separating {plane} of {by} and {who}, by {}: no part of the one \
                 is behind the other.",
                units(-d.distance as f32)
            ),
            // Region 3 of Figure 2, by the plane with the least to spare: the answer is as sure as that one.
            Reason::Plane(d) if self.occlusion == Occlusion::Full => format!(
                "The eye is inside all {} supporting {plane}s of {by} and {who}; of the closest by {}, \
                 where {} are needed: full occlusion.",
                self.edges,
                units(d.distance as f32),
                short(d.needed as f32)
            ),
            // Region 2 of Figure 2.
            Reason::Plane(d) if d.distance < 0.0 => format!(
                "The eye is inside all separating {plane}s of {by} and {who}, but outside a supporting one, \
                 by {}: partial occlusion.",
                units(-d.distance as f32)
            ),
            Reason::Plane(d) => format!(
                "The eye is inside all supporting {plane}s of {by} and {who}, of the closest by {}, which is \
                 less than the {} that pixels need: partial occlusion.",
                units(d.distance as f32),
                short(d.needed as f32)
            ),
            Reason::Crossing(edge) => format!(
                "The eye is inside all separating {plane}s of {by} and {who}, but the line of edge {} meets \
                 {who}, so no {plane} through it supports {who}: partial occlusion.",
                edge + 1
            ),
            Reason::Near(needed) => format!(
                "{who} lies behind {by} by {}, less than the {} that pixels need: partial occlusion.",
                units(self.behind[0] as f32),
                short(needed as f32)
            ),
        };
        let mut why = why + kept;
        // Some begin with the name of the box, which is in lower case everywhere else.
        if let Some(first) = why.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        why
    }
    fn compared(&self) -> Option<Compared> {
        match self.reason {
            Reason::Before => {
                Some(Compared::of(("farthest corner behind", self.behind[1]), ("the plane", 0.0)))
            }
            Reason::Cut => Some(Compared::of(("nearest corner behind", self.behind[0]), ("the plane", 0.0))),
            Reason::Plane(d) if d.is_supporting => {
                Some(Compared::of(("inside the supporting", d.distance), ("needed", d.needed)))
            }
            Reason::Plane(d) => {
                Some(Compared::of(("inside the separating", d.distance), ("needed", d.needed)))
            }
            Reason::Crossing(_) => None,
            Reason::Near(needed) => {
                Some(Compared::of(("nearest corner behind", self.behind[0]), ("needed", needed)))
            }
        }
    }
    fn fields(&self) -> Vec<Field> {
        let word = |name, v: &str| Field { name, value: Value::Word(v.into()) };
        let mut fields = vec![
            owner_field(self.owner),
            integer("occluder", self.occluder),
            integer("occluder_prim", self.name.0),
            word("occlusion", self.result()),
            Field { name: "reused", value: Value::Switch(self.reused) },
            word("eye_side", if self.side > 0 { "front" } else { "back" }),
            number("eye_height_units", self.height),
            number("box_nearest_behind_units", self.behind[0]),
            number("box_farthest_behind_units", self.behind[1]),
            // "Full occlusion occurs when all of the supporting planes are satisfied" (Section 2).
            word("supporting_satisfied", &format!("{} of {}", self.satisfied, self.edges)),
            word(
                "reason",
                match self.reason {
                    Reason::Before => "before",
                    Reason::Cut => "cut",
                    Reason::Plane(d) if d.is_supporting => "supporting",
                    Reason::Plane(_) => "separating",
                    Reason::Crossing(_) => "crossing",
                    Reason::Near(_) => "near",
                },
            ),
        ];
        if let Some(d) = self.decisive() {
            fields.extend([
                integer("edge", u32::from(d.edge) + 1),
                integer("tangent_corner", d.vertex.into()),
                number("viewpoint_distance_units", d.distance),
                number("needed_units", d.needed),
                // Below 0 where the test failed, and by how much.
                number("margin_units", d.distance - d.needed),
            ]);
        }
        fields
    }
}

/// Occluders were found to hide a box together.
#[derive(Clone, Copy, Debug)]
pub struct Joined {
    owner: Owner,
    count: u32,
    candidates: u32,
    /// The first of them, and how many edges cancelled.
    members: [u32; MEMBERS],
    shared: u32,
}

/// Members of a joint set that a note names.
const MEMBERS: usize = 16;

impl Joined {
    /// The members of a set that [`super::jointly`] found.
    pub fn of<S: Shape>(
        occluders: &Occluders<S>,
        owner: Owner,
        candidates: &[Candidate],
        members: Members,
    ) -> Self {
        let mut joined =
            Self { owner, count: 0, candidates: candidates.len() as u32, members: [0; MEMBERS], shared: 0 };
        for (_, candidate) in candidates.iter().enumerate().filter(|(i, _)| members >> i & 1 == 1) {
            // Beyond the array they are only counted: notes are copied, so their size is fixed.
            if let Some(to) = joined.members.get_mut(joined.count as usize) {
                *to = candidate.occluder;
            }
            joined.count += 1;
            // Edges whose plane the eye is outside of: they passed since another member has them too.
            joined.shared += (occluders.keys(candidate.occluder).len() as u32)
                .saturating_sub(candidate.seen.inside.count_ones());
        }
        joined
    }
    fn members(&self) -> &[u32] {
        &self.members[..(self.count as usize).min(MEMBERS)]
    }
}

/// An occluder by the first primitive of its face, and by its object where that has a name.
fn occluder_name<S: Shape>(context: &Context<'_, S>, prim: PrimId) -> String {
    let object = context.scene.object_of(prim);
    let name = context.scene.objects().get(object.at()).map_or("", |o| &o.name);
    let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
    format!("the occluder of {} {prim}{of}", S::PRIM)
}

fn owner_name<S: Shape>(context: &Context<'_, S>, owner: Owner) -> String {
    let object = |o: ObjectId| context.scene.objects().get(o.at()).map_or("", |object| &object.name);
    match owner {
        Owner::Node(n) => format!("node {n}"),
        Owner::Object(o) => format!("object {o} {}", object(o)).trim_end().to_owned(),
    }
}

/// What hides what a note says is hidden: the occluder, or those that do so together.
pub fn hiders<S: Shape>(notes: &[Evidence<S>], at: usize) -> Option<Hiders> {
    match &notes[at] {
        Evidence::Related(n) if n.occlusion == Occlusion::Full => Some(Hiders::Occluders(vec![n.name], 1)),
        Evidence::Joined(joined) => {
            // Occluders are named where they were chosen, before all tests.
            let name = |member: &u32| {
                notes.iter().find_map(|note| match note {
                    Evidence::Chosen(chosen) if chosen.occluder == *member => Some(chosen.name),
                    _ => None,
                })
            };
            let named = joined.members().iter().filter_map(name).collect();
            Some(Hiders::Occluders(named, joined.count as usize))
        }
        _ => None,
    }
}

fn owner_field(owner: Owner) -> Field {
    match owner {
        Owner::Node(n) => integer("node", n.0),
        Owner::Object(o) => integer("object", o.0),
    }
}

fn owner_subject(owner: Owner) -> Subject {
    match owner {
        Owner::Node(n) => Subject::Node(n),
        Owner::Object(o) => Subject::Object(o),
    }
}

impl<S: Shape> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Chosen(n) => {
                tally.add("occluders_active", 1);
                // How much of the set changes: little while the viewer moves smoothly (Section 3.1).
                tally.add("occluders_exchanged", n.new.into());
            }
            Self::Tested(n) => n.tally(tally),
            Self::Related(n) => {
                tally.add("occluders_tested", 1);
                // Reused against made: what temporal coherence is worth (Section 3), by counts and not by a
                // clock.
                tally.add("relations_reused", n.reused.into());
                tally.add("relations_made", (!n.reused).into());
                // Apart, since the tests of Section 3.2 come on top of those of the tree.
                tally.add(if matches!(n.owner, Owner::Node(_)) { "node_tests" } else { "object_tests" }, 1);
            }
            Self::Edge(_) => tally.add("edges_tested", 1),
            Self::Joined(_) => tally.add("joint_occlusions", 1),
            Self::Facing(_) => Facing::tally(tally),
            Self::Parted(n) => tally.add("parted_primitives_unseen", (!n.is_seen).into()),
        }
    }
}

impl<S: Shape> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Chosen(_) => "OccluderChosen",
            Self::Tested(n) => n.kind(),
            Self::Edge(_) => "EdgeTested",
            Self::Related(_) => "OcclusionTested",
            Self::Joined(_) => "JointlyOccluded",
            Self::Facing(_) => "OrientationTested",
            Self::Parted(n) if n.is_seen => "PartSeen",
            Self::Parted(_) => "PartsUnseen",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Chosen(n) => Subject::Prim(n.name),
            Self::Tested(n) => n.subject(),
            Self::Edge(n) => owner_subject(n.owner),
            Self::Related(n) => owner_subject(n.owner),
            Self::Joined(n) => owner_subject(n.owner),
            Self::Facing(n) => n.subject(),
            // The decision that follows is about the primitive; the node is a field.
            Self::Parted(n) => Subject::Prim(n.prim),
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            // Partial occlusion proves nothing by itself; a joint set is noted only where it hides the box.
            Self::Related(n) => (n.occlusion == Occlusion::Full).then_some(Claim::Hidden),
            Self::Joined(_) => Some(Claim::Hidden),
            Self::Parted(n) => (!n.is_seen).then_some(Claim::Hidden),
            // A choice decides what is tested, not what is hidden, and an edge is but one of several.
            Self::Chosen(_) | Self::Edge(_) => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            Self::Edge(n) => n.compared(),
            Self::Related(n) => n.compared(),
            Self::Chosen(_) | Self::Joined(_) | Self::Parted(_) => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        let switch = |name, v| Field { name, value: Value::Switch(v) };
        match self {
            Self::Chosen(n) => vec![
                // First by the primitive, which the scene has too; occluders are numbered by this index.
                integer("prim", n.name.0),
                integer("occluder", n.occluder),
                integer("rank", n.rank),
                number("area_angle", n.area_angle.into()),
                // Missing where the Eye is in no leaf.
                n.leaf.map_or(Field { name: "leaf", value: Value::Word("none".into()) }, |leaf| {
                    integer("leaf", leaf.0)
                }),
                integer("direction", n.direction),
                switch("new", n.new),
            ],
            Self::Parted(n) => vec![integer("prim", n.prim.0), integer("node", n.node.0)],
            Self::Tested(n) => n.fields(context),
            Self::Edge(n) => {
                let mut fields = vec![
                    owner_field(n.owner),
                    integer("occluder", n.occluder),
                    integer("occluder_prim", n.name.0),
                    // From 1, as in the sentence.
                    integer("edge", u32::from(n.edge) + 1),
                    Field { name: "result", value: Value::Word(n.result().into()) },
                ];
                if let Some(test) = n.test {
                    fields.push(number("separating_distance_units", test.separating));
                    fields.push(number("supporting_distance_units", test.supporting));
                    if test.needed.is_finite() {
                        fields.push(number("needed_units", test.needed));
                    }
                }
                fields
            }
            Self::Related(n) => n.fields(),
            Self::Joined(n) => vec![
                owner_field(n.owner),
                integer("members", n.count),
                Field {
                    name: "occluders",
                    value: Value::List(n.members().iter().map(|&m| m.into()).collect()),
                },
                integer("partial_occluders", n.candidates),
                // "By ignoring the supporting planes through non-silhouette shared edges" (Section 2).
                integer("shared_edges_ignored", n.shared),
            ],
            Self::Facing(n) => n.fields(context),
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        match self {
            Self::Chosen(n) => format!(
                // Leaf and direction are named too: the pick is from their list, so that they decide what can
                // be active.
                "{} is active, number {} by area-angle ({}) as seen from the Eye, of those that can hide \
                 anything and {} direction {}{}.",
                capitalized(&occluder_name(context, n.name)),
                n.rank + 1,
                short(n.area_angle),
                n.leaf.map_or("lie toward".to_owned(), |leaf| format!("are listed for leaf {leaf} and")),
                n.direction,
                if n.new { "; it was not in the frame before" } else { "" }
            ),
            Self::Tested(n) => n.sentence(context),
            Self::Edge(n) => n.sentence(context),
            Self::Related(n) => n.sentence(context),
            Self::Joined(n) => format!(
                "{} occluders hide {} together: the eye is inside all their supporting {}s but those through \
                 edges that two of them share from opposite sides ({} in all).",
                n.count,
                owner_name(context, n.owner),
                plane_word::<S>(),
                n.shared
            ),
            Self::Facing(n) => n.sentence(context),
            Self::Parted(n) if n.is_seen => format!(
                "The {} {} has parts in several nodes; that in node {} may be seen.",
                S::PRIM,
                n.prim,
                n.node
            ),
            Self::Parted(n) => format!(
                "The {} {} crosses the plane that divides node {}; each of its parts lies in a node that is \
                 out of view or hidden.",
                S::PRIM,
                n.prim,
                n.node
            ),
        }
    }
}

/// Draws the active occluders, and the evidence of a note.
pub fn draw<S: Shape>(
    active: &[u32],
    frame: &Frame<'_, S, LargeOccluders>,
    note: Option<&Evidence<S>>,
    to: &mut Drawing<S::Vector>,
) {
    let Frame { index, scene, view, .. } = *frame;
    // The set first, so that what the step is about is drawn over it.
    for &id in active {
        outline(index, id, Layer::Evidence, Role::Occluder, to);
    }
    match note {
        Some(Evidence::Tested(n)) => n.draw(view, to),
        Some(Evidence::Facing(n)) => n.draw(scene, view, to),
        Some(Evidence::Chosen(n)) => {
            outline(index, n.occluder, Layer::Emphasis, Role::Current, to);
            // D of Figure 11, from the Eye to the center of the occluder.
            let center = S::rounded(index.occluders.get(n.occluder).center);
            to.line(Layer::Evidence, Role::Evidence, Subject::Prim(n.name), [view.eye.position, center]);
            label(to, (view.eye.position + center) * 0.5, format!("area-angle {}", short(n.area_angle)));
        }
        Some(Evidence::Edge(n)) => {
            let pair = Pair { owner: n.owner, occluder: n.occluder, side: n.side };
            let test = n.test.map(|test| (n.edge, test));
            let decisive = test.map(|(edge, test)| (edge, Edge::is_by_supporting(&test)));
            let distance = test.map(|(_, test)| match Edge::is_by_supporting(&test) {
                true => ("supporting", test.supporting),
                false => ("separating", test.separating),
            });
            draw_pair(&pair, Some(n.edge), decisive, distance, index, view, to);
        }
        Some(Evidence::Related(n)) => {
            let pair = Pair { owner: n.owner, occluder: n.occluder, side: n.side };
            let decisive = n.decisive().map(|d| (d.edge, d.is_supporting));
            let name = |d: Decisive| if d.is_supporting { "supporting" } else { "separating" };
            let distance = n.decisive().map(|d| (name(d), d.distance));
            draw_pair(&pair, None, decisive, distance, index, view, to);
        }
        Some(Evidence::Joined(n)) => {
            to.bounds(Layer::Emphasis, Role::Current, owner_subject(n.owner), &index.bounds_of(n.owner));
            for &id in n.members() {
                outline(index, id, Layer::Emphasis, Role::Occluder, to);
            }
            shadow(n, index, view, to);
        }
        Some(Evidence::Parted(n)) => prim_outline(scene, n.prim, to),
        None => {}
    }
}

fn outline<S: Shape>(index: &Index<S>, id: u32, layer: Layer, role: Role, to: &mut Drawing<S::Vector>) {
    let points = index.occluders.outline(id);
    let subject = Subject::Prim(index.occluders.name(id));
    // An outline is closed: a segment would go forth and back.
    if points.len() == 2 {
        to.line(layer, role, subject, points);
    } else {
        to.outline(layer, role, subject, points);
    }
}

/// The border lines of what a set hides: from the eye past the members' corners to behind the box.
fn shadow<S: Shape>(note: &Joined, index: &Index<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
    let bounds = index.bounds_of(note.owner);
    let eye = view.eye.position;
    // Past the farthest corner, so that the lines frame the whole box.
    let reach = bounds.corners().map(|c| (c - eye).length()).fold(0.0, f32::max);
    for &id in note.members() {
        for corner in index.occluders.outline(id) {
            let ray = corner - eye;
            // Where the Eye stands on a corner there is no ray, and nothing may be divided by 0.
            let far = eye + ray * (reach / ray.length().max(f32::MIN_POSITIVE));
            to.line(Layer::Evidence, Role::Faint, Subject::None, [corner, far]);
        }
    }
}

/// An occluder and a box.
struct Pair {
    owner: Owner,
    occluder: u32,
    side: i8,
}

/// Draws an occluder, a box and their planes: all, or those of one edge. `decisive` is the edge and whether
/// its supporting plane is emphasized, or else the separating one; `distance` is that of the eye from it.
fn draw_pair<S: Shape>(
    pair: &Pair,
    only: Option<u8>,
    decisive: Option<(u8, bool)>,
    distance: Option<(&str, f64)>,
    index: &Index<S>,
    view: &View<S>,
    to: &mut Drawing<S::Vector>,
) {
    let bounds = index.bounds_of(pair.owner);
    to.bounds(Layer::Emphasis, Role::Current, owner_subject(pair.owner), &bounds);
    outline(index, pair.occluder, Layer::Emphasis, Role::Current, to);
    // The same function that the run called; it depends on nothing but its arguments.
    let relation = Relation::new(&index.occluders, pair.occluder, pair.side, &bounds, false);
    let mut plane = |edge: usize, vertex: u8, role: Role| {
        draw_plane::<S>(index, pair, edge, vertex, role, view, &bounds, to);
    };
    for (i, planes) in relation.planes.iter().enumerate() {
        let Planes::Tangent([supporting, separating]) = planes else { continue };
        if only.is_some_and(|only| usize::from(only) != i) {
            continue;
        }
        let emphasized = decisive.filter(|(edge, _)| usize::from(*edge) == i).map(|(_, is)| is);
        // In space both planes of every edge would cover the picture.
        let both = S::Vector::AXES == 2 || only.is_some();
        if emphasized == Some(false) || both {
            let role = if emphasized == Some(false) { Role::Evidence } else { Role::Faint };
            plane(i, separating.vertex, role);
        }
        if emphasized != Some(false) || both {
            let role = if emphasized == Some(true) { Role::Evidence } else { Role::Faint };
            plane(i, supporting.vertex, role);
        }
    }
    if let Some((name, distance)) = distance {
        let side = if distance < 0.0 { "outside" } else { "inside" };
        let text = format!("{name} {}: {} {side}", plane_word::<S>(), units(distance.abs() as f32));
        label(to, view.eye.position, text);
    }
}

/// A plane through an edge and a corner of the box, from the box past the edge toward the eye: a line in
/// flatland, in space the triangle between the corner and the edge, drawn out.
#[expect(clippy::too_many_arguments, reason = "the operands of one test, and where it is drawn")]
fn draw_plane<S: Shape>(
    index: &Index<S>,
    pair: &Pair,
    edge: usize,
    vertex: u8,
    role: Role,
    view: &View<S>,
    bounds: &Aabb<S::Vector>,
    to: &mut Drawing<S::Vector>,
) {
    let at = corner::<S>(bounds, vertex);
    let ends = index.occluders.edges(pair.occluder);
    let flat = S::Vector::AXES == 2;
    let ends =
        if flat { vec![ends[edge].from] } else { vec![ends[edge].from, ends[(edge + 1) % ends.len()].from] };
    // A little past the Eye, so that one sees on which side of the plane it is.
    let reach = (S::widened(view.eye.position) - at).length() * 1.15;
    let drawn_out = |p: S::Point| {
        let ray = p - at;
        let length = ray.length().max(f64::MIN_POSITIVE);
        S::rounded(at + ray * (reach.max(length) / length))
    };
    let mut points = vec![S::rounded(at)];
    points.extend(ends.iter().map(|&e| drawn_out(e)));
    let subject = owner_subject(pair.owner);
    if flat {
        to.line(Layer::Evidence, role, subject, points);
    } else if role == Role::Evidence {
        // Only the plane that decided is filled: filled planes through all edges would cover it.
        to.push(Layer::Evidence, role, subject, Mark::Area(points));
    } else {
        to.outline(Layer::Evidence, role, subject, points);
    }
    // The tangent corner of Section 2.1.
    to.push(Layer::Evidence, role, subject, Mark::Dot { at: S::rounded(at), radius_pt: 2.0 });
}
