//! The evidence of this method: as fields, as sentences, and as marks in the world.

use super::machine::Worked;
use crate::culling::cubes::CubeNote;
use crate::culling::depth::{DepthNote, Faces};
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::View;
use crate::index::Octree;
use crate::method::evidence::{Facing, Tested, outline};
use crate::method::{Claim, Compared, Context, Field, Note, Tallied, Tally};
use crate::scene::Scene;

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Evidence<S: Faces> {
    /// The box of a structure that holds a primitive, against the frustum.
    Tested(Tested<S>),
    /// A primitive's orientation.
    Facing(Facing),
    /// What was read of the image and its pyramid, or changed.
    Depth(DepthNote<S>),
    /// What became of a structure, or of a primitive that structures share.
    Cube(CubeNote),
    /// A unit of the machine worked.
    Worked(Worked),
}

impl<S: Faces> From<DepthNote<S>> for Evidence<S> {
    #[inline]
    fn from(note: DepthNote<S>) -> Self {
        Self::Depth(note)
    }
}

impl<S: Faces> Evidence<S> {
    /// What of it is about the image and its pyramid.
    pub(super) fn depth(&self) -> Option<&DepthNote<S>> {
        // What a film applies again and the pictures of the pyramid look through.
        if let Self::Depth(note) = self { Some(note) } else { None }
    }
    /// Draws the evidence in the world.
    pub(super) fn draw(
        &self,
        index: &Octree<S::Vector>,
        scene: &Scene<S>,
        view: &View<S>,
        to: &mut Drawing<S::Vector>,
    ) {
        match self {
            Self::Tested(n) => n.draw(view, to),
            Self::Facing(n) => n.draw(scene, view, to),
            Self::Depth(n) => n.draw(scene, view, to),
            Self::Cube(CubeNote::SharedDrawn(prim, _) | CubeNote::SharedUnseen(prim, _)) => {
                outline(scene, *prim, to);
            }
            // The cells that were read for it are notes of their own.
            Self::Cube(CubeNote::Unlisted { .. } | CubeNote::Checked(_)) => {}
            Self::Worked(n) => {
                // The world shows whose geometry it is; which unit and when is for the timeline. While a
                // processor waits there is nothing to show.
                if let subject @ Subject::Node(node) = n.subject() {
                    to.bounds(Layer::Emphasis, Role::Current, subject, &index.nodes()[node.at()].bounds);
                }
            }
        }
    }
}

impl<S: Faces> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Tested(n) => n.tally(tally),
            Self::Facing(_) => Facing::tally(tally),
            Self::Depth(n) => n.tally(tally),
            Self::Cube(n) => n.tally(tally),
            Self::Worked(n) => n.tally(tally),
        }
    }
}

impl<S: Faces> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Tested(n) => n.kind(),
            Self::Facing(_) => "OrientationTested",
            Self::Depth(n) => n.kind(),
            Self::Cube(n) => Note::<S>::kind(n),
            Self::Worked(n) => n.kind(),
        }
    }
    fn subject(&self) -> Subject {
        match self {
            // A cube with all below it, or a primitive where the box is that of what its structure holds:
            // below the same cube lie other structures, which this test does not reject.
            Self::Tested(n) => n.subject(),
            Self::Facing(n) => n.subject(),
            Self::Depth(n) => n.subject(),
            Self::Cube(n) => Note::<S>::subject(n),
            Self::Worked(n) => n.subject(),
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            Self::Depth(n) => n.claim(context),
            Self::Cube(n) => n.claim(context),
            // That a unit worked proves nothing.
            Self::Worked(_) => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            Self::Depth(n) => n.compared(context),
            Self::Cube(n) => Note::<S>::compared(n, context),
            // Work takes time, and compares nothing.
            Self::Worked(_) => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Tested(n) => n.fields(context),
            Self::Facing(n) => n.fields(context),
            Self::Depth(n) => n.fields(context),
            Self::Cube(n) => n.fields(context),
            // No context: a simulated clock is kept nowhere else, so the note holds all.
            Self::Worked(n) => n.fields(),
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        match self {
            Self::Tested(n) => n.sentence(context),
            Self::Facing(n) => n.sentence(context),
            Self::Depth(n) => n.sentence(context),
            Self::Cube(n) => n.sentence(context),
            Self::Worked(n) => n.sentence(),
        }
    }
}
