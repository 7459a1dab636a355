//! The evidence of this method: as fields, as sentences, and as marks in the world.

use crate::culling::cubes::CubeNote;
use crate::culling::depth::{DepthNote, Faces};
use crate::drawing::{Drawing, Subject};
use crate::geometry::{NodeId, View};
use crate::method::evidence::{Facing, Tested, integer, outline};
use crate::method::{Claim, Compared, Context, Field, Note, Tallied, Tally};
use crate::scene::Scene;

/// What the method records.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Evidence<S: Faces> {
    /// A cube is on the visible list: it is drawn without a test (true), or was.
    Listed(NodeId, bool),
    /// A box against the frustum.
    Tested(Tested<S>),
    /// A primitive's orientation.
    Facing(Facing),
    /// What was read of the image and its pyramid, or changed.
    Depth(DepthNote<S>),
    /// What became of a cube, of a primitive that cubes share, or of the list.
    Cube(CubeNote),
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
    pub(super) fn draw(&self, scene: &Scene<S>, view: &View<S>, to: &mut Drawing<S::Vector>) {
        match self {
            Self::Tested(n) => n.draw(view, to),
            Self::Facing(n) => n.draw(scene, view, to),
            Self::Depth(n) => n.draw(scene, view, to),
            Self::Cube(CubeNote::SharedDrawn(prim, _) | CubeNote::SharedUnseen(prim, _)) => {
                outline(scene, *prim, to);
            }
            // Marks on the tree and counts have no place in the world.
            Self::Listed(..) | Self::Cube(CubeNote::Unlisted { .. } | CubeNote::Checked(_)) => {}
        }
    }
}

impl<S: Faces> Tallied for Evidence<S> {
    fn tally(&self, tally: &mut Tally) {
        match self {
            // The visit meets a cube of the list once more, and draws nothing for it.
            Self::Listed(_, is_drawn) => tally.add("cubes_drawn_from_list", (*is_drawn).into()),
            Self::Tested(n) => n.tally(tally),
            Self::Facing(_) => Facing::tally(tally),
            Self::Depth(n) => n.tally(tally),
            Self::Cube(n) => n.tally(tally),
        }
    }
}

impl<S: Faces> Note<S> for Evidence<S> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Listed(..) => "CubeListed",
            Self::Tested(n) => n.kind(),
            Self::Facing(_) => "OrientationTested",
            Self::Depth(n) => n.kind(),
            Self::Cube(n) => Note::<S>::kind(n),
        }
    }
    fn subject(&self) -> Subject {
        match self {
            // Without a query the verdict of a cube rests on its mark.
            Self::Listed(n, _) => Subject::Node(*n),
            Self::Tested(n) => n.subject(),
            Self::Facing(n) => n.subject(),
            Self::Depth(n) => n.subject(),
            Self::Cube(n) => Note::<S>::subject(n),
        }
    }
    fn claim(&self, context: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::Tested(n) => n.claim(context),
            Self::Facing(n) => n.claim(context),
            Self::Depth(n) => n.claim(context),
            Self::Cube(n) => n.claim(context),
            // A mark proves nothing.
            Self::Listed(..) => None,
        }
    }
    fn compared(&self, context: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Tested(n) => n.compared(context),
            Self::Facing(n) => n.compared(context),
            Self::Depth(n) => n.compared(context),
            Self::Cube(n) => Note::<S>::compared(n, context),
            Self::Listed(..) => None,
        }
    }
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Listed(n, _) => vec![integer("node", n.0)],
            Self::Tested(n) => n.fields(context),
            Self::Facing(n) => n.fields(context),
            Self::Depth(n) => n.fields(context),
            Self::Cube(n) => n.fields(context),
        }
    }
    fn sentence(&self, context: &Context<'_, S>) -> String {
        match self {
            // A cube may have been out of view since, or not have been checked.
            Self::Listed(n, true) => format!(
                "Node {n} is on the visible list, since it could be seen when it was last tested: it is \
                 drawn at once, without a test."
            ),
            Self::Listed(n, false) => format!(
                "Node {n} is on the visible list: it was drawn at the start of the frame, without a test."
            ),
            Self::Tested(n) => n.sentence(context),
            Self::Facing(n) => n.sentence(context),
            Self::Depth(n) => n.sentence(context),
            Self::Cube(n) => n.sentence(context),
        }
    }
}
