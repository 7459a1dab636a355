//! What methods share that cull the cubes of an octree: its parameters, and what is recorded of cubes and of
//! primitives that several of them share.

use crate::drawing::Subject;
use crate::geometry::{NodeId, PrimId, Space};
use crate::index::{Octree, Redistribution, Shape};
use crate::method::evidence::integer;
use crate::method::{Context, Field, Knob, Knobs, Note, Tallied, Tally, Words};
use crate::scene::{Progress, Scene};

/// How the octree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cubes {
    pub(crate) tree_levels: u32,
    /// 0: by the space.
    pub(crate) leaf_primitives: u32,
    pub(crate) redistribution: Redistribution,
    pub(crate) small_percent: u32,
}

impl Default for Cubes {
    fn default() -> Self {
        Self {
            // Section 3.1 gives no number for these: neither a depth of the tree, nor primitives of a leaf,
            // nor when a primitive is "small" compared to its cube.
            tree_levels: 12,
            leaf_primitives: 0,
            // Section 3.1: the strategy of the original algorithm.
            redistribution: Redistribution::Hybrid,
            small_percent: 12,
        }
    }
}

impl Words for Redistribution {
    const ALL: &'static [Self] = &Redistribution::ALL;
    const WORDS: &'static [&'static str] = &["hybrid", "parent", "grown", "split"];
}

impl Cubes {
    /// Declares the parameters.
    pub(crate) fn knobs(&mut self, knobs: &mut dyn Knobs) {
        let source = "Georges 1995, Section 3.1";
        knobs.integer(
            Knob::new("tree-levels", "levels", "levels of the octree at most", source),
            1..=Shape::MOST_LEVELS,
            &mut self.tree_levels,
        );
        knobs.integer(
            Knob::new(
                // Section 3.1: "The subdivision criteria is most commonly based on number of primitives in
                // the cell".
                "leaf-primitives",
                "",
                "a cube with no more primitives is not divided; 0: 128 triangles, 8 segments",
                source,
            ),
            0..=100_000,
            &mut self.leaf_primitives,
        );
        // Section 3.1 names three ways and what is wrong with each, then the hybrid of the original
        // algorithm: tiny primitives that straddle a boundary are not to share the visibility of a large
        // cube.
        let crossing = Knob::new(
            "redistribution",
            "",
            "where a primitive goes that crosses a cube's dividing planes: hybrid (stays, or if small to all \
             children it overlaps), parent (stays), grown (to one child, whose bounds grow), split (parts to \
             all children)",
            source,
        );
        knobs.words(crossing, &mut self.redistribution);
        knobs.integer(
            Knob::new(
                "small-percent",
                "%",
                "a primitive is small if it is no longer than this part of its cube",
                source,
            ),
            0..=100,
            &mut self.small_percent,
        );
    }
    /// The octree of a scene; `None` when cancelled.
    pub(crate) fn build<S: Space>(
        &self,
        scene: &Scene<S>,
        progress: &dyn Progress,
    ) -> Option<Octree<S::Vector>> {
        progress.report(0.0, "building the octree");
        let shape = Shape {
            levels: self.tree_levels,
            // Parameters are declared for any space, and the best number depends on it: 0 waits for the space
            // until here.
            leaf_prims: if self.leaf_primitives == 0 { leaf_prims::<S>() } else { self.leaf_primitives },
            redistribution: self.redistribution,
            small: self.small_percent as f32 / 100.0,
        };
        // Dropped primitives are never drawn, so no cube is to hold them.
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        Octree::build(boxes, &shape, &|| progress.cancelled())
    }
}

/// Primitives of a cube that is not divided. In space a test costs about as much as drawing a dozen
/// triangles, and most cubes that are queried again and again are visible: 128 was the best of 16 to 128 on
/// generated rooms and cities. Flatland scenes are small and are there to be looked at.
fn leaf_prims<S: Space>() -> u32 {
    if S::CORNERS == 2 { 8 } else { 128 }
}

/// What is recorded of cubes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CubeNote {
    /// A cube left the visible list.
    Unlisted(NodeId),
    /// A primitive that several cubes share was in none that can be seen; the cube that passed it on.
    SharedUnseen(PrimId, NodeId),
}

impl Tallied for CubeNote {
    fn tally(&self, tally: &mut Tally) {
        tally.add(
            match self {
                Self::Unlisted(_) => "cubes_unlisted",
                Self::SharedUnseen(..) => "shared_primitives_unseen",
            },
            1,
        );
    }
}

impl<S: Space> Note<S> for CubeNote {
    fn kind(&self) -> &'static str {
        match self {
            Self::Unlisted(_) => "CubeUnlisted",
            Self::SharedUnseen(..) => "SharedUnseen",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Unlisted(node) => Subject::Node(*node),
            // The decision that follows is about the primitive; the cube is a field.
            Self::SharedUnseen(prim, _) => Subject::Prim(*prim),
        }
    }
    fn fields(&self, _: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Unlisted(node) => vec![integer("node", node.0)],
            Self::SharedUnseen(prim, node) => vec![integer("prim", prim.0), integer("node", node.0)],
        }
    }
    fn sentence(&self, _: &Context<'_, S>) -> String {
        match self {
            Self::Unlisted(n) => format!(
                "Node {n} cannot be seen in the finished image; it leaves the visible list with all below it."
            ),
            Self::SharedUnseen(prim, node) => format!(
                "The {} {prim} lies in several cubes below node {node}; none of them can be seen.",
                S::PRIM
            ),
        }
    }
}
