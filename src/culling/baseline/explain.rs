//! The baselines' evidence: as fields, as sentences and as marks in the world.

use crate::drawing::{Drawing, Layer, Mark, Role, Subject};
use crate::geometry::{NodeId, PrimId, Space, View};
use crate::method::evidence::{Facing, Tested, integer, label, middle, number, outline, short};
use crate::method::{Claim, Compared, Context, Field, Note, Tallied, Tally};
use crate::scene::Scene;

/// What a baseline records.
#[derive(Clone, Copy, Debug)]
pub enum Evidence<S: Space> {
    /// A box against the frustum.
    Tested(Tested<S>),
    /// A primitive's orientation.
    Facing(Facing),
    /// A primitive's place in the order.
    Distance(Distance<S>),
    /// A node of which no test is made.
    Untested(NodeId),
}

/// A primitive got its place in the order of centroids.
#[derive(Clone, Copy, Debug)]
pub struct Distance<S: Space> {
    prim: PrimId,
    centroid: S::Vector,
    distance: f32,
    // Kept, not looked up: the rank takes the whole order, and the budget is a parameter. A reader of the
    // note has the scene and the view only.
    rank: u32,
    budget: u32,
}

impl<S: Space> Distance<S> {
    /// The operands of the ordering for a primitive at `rank`, of which `budget` are drawn.
    pub fn of(scene: &Scene<S>, prim: PrimId, squared: f32, rank: usize, budget: usize) -> Self {
        Self {
            prim,
            centroid: middle(scene, prim),
            // The run compares squares, people read lengths; both have the same order.
            distance: squared.sqrt(),
            rank: rank as u32,
            budget: budget as u32,
        }
    }
    fn sentence(&self) -> String {
        // From 1, as people count; the field counts from 0.
        let (prim, rank, budget) = (self.prim, self.rank + 1, self.budget);
        let head = format!(
            "The centroid of {} {prim} is {} units from the eye, number {rank} in the order",
            S::PRIM,
            short(self.distance)
        );
        // Rank and budget decide and nothing else: the sentence names both, so that a student sees that
        // visibility had no say.
        if self.rank < self.budget {
            format!(
                "{head}: it is drawn, {} of the budget of {budget} are left.",
                self.budget - self.rank - 1
            )
        } else {
            format!("{head}: the budget of {budget} is spent, it is left out.")
        }
    }
    fn draw(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        outline(scene, self.prim, to);
        // What the order is by: the way from the Eye to the centroid, whatever stands between.
        to.line(
            Layer::Evidence,
            Role::Evidence,
            Subject::Prim(self.prim),
            [view.eye.position, self.centroid],
        );
        // The centroid itself: a large polygon may begin much nearer, which is where this order goes wrong.
        to.push(
            Layer::Evidence,
            Role::Evidence,
            Subject::Prim(self.prim),
            Mark::Dot { at: self.centroid, radius_pt: 2.5 },
        );
        label(to, (view.eye.position + self.centroid) * 0.5, format!("{} units", short(self.distance)));
    }
}

impl<S: Space> Evidence<S> {
    /// Draws the evidence in the world.
    pub fn draw(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        match self {
            Self::Tested(n) => n.draw(view, to),
            Self::Facing(n) => n.draw(scene, view, to),
            Self::Distance(n) => n.draw(scene, view, to),
            // There is nothing to show of a test that is not made.
            Self::Untested(_) => {}
        }
    }
}

impl<S: Space> Tallied for Evidence<S> {
    #[inline]
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Tested(n) => n.tally(tally),
            Self::Facing(_) => Facing::tally(tally),
            // One a primitive in view: the length of the list that is sorted.
            Self::Distance(_) => tally.add("primitives_sorted", 1),
            Self::Untested(_) => {}
        }
    }
}

impl<S: Space> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Tested(n) => n.kind(),
            Self::Facing(_) => "OrientationTested",
            Self::Distance(_) => "CentroidRanked",
            Self::Untested(_) => "NodeUntested",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Tested(n) => n.subject(),
            Self::Facing(n) => n.subject(),
            Self::Distance(n) => Subject::Prim(n.prim),
            Self::Untested(node) => Subject::Node(*node),
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            // To be far away is no proof of being hidden: what the budget leaves out may be visible.
            Self::Distance(_) | Self::Untested(_) => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            // The first of the order has rank 0: as many ranks fit as the budget has primitives.
            Self::Distance(n) => Some(Compared::of(("rank", n.rank.into()), ("budget", n.budget.into()))),
            Self::Untested(_) => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Tested(n) => n.fields(context),
            Self::Facing(n) => n.fields(context),
            Self::Distance(n) => {
                vec![
                    integer("prim", n.prim.0),
                    number("distance_units", n.distance.into()),
                    integer("rank", n.rank),
                    integer("budget", n.budget),
                ]
            }
            Self::Untested(node) => vec![integer("node", node.0)],
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        match self {
            Self::Tested(n) => n.sentence(context),
            Self::Facing(n) => n.sentence(context),
            Self::Distance(n) => n.sentence(),
            Self::Untested(_) => "No test is made for the scene as a whole or in part: every primitive is \
                                  drawn, and the depth buffer decides at each pixel which one is seen."
                .into(),
        }
    }
}
