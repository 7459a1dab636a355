//! Structures, how they are dealt out to processors, and in which order a processor takes them.

use std::cmp::Reverse;
use std::collections::{BTreeMap, VecDeque};

use super::machine::Distribution;
use crate::culling::depth::{Faces, footprint};
use crate::geometry::{Footprint, NodeId, PrimId, Projection, Vector, View};
use crate::index::Octree;

/// Levels of cubes that the structures of the coarse distribution are: whole subtrees go to one processor.
const COARSE_LEVEL: u8 = 2;

/// A structure, "a bounding volume and its associated geometry" (Section 4.1), as one processor holds it: a
/// cube, and what it holds itself.
#[derive(Clone, Debug)]
pub(super) struct Structure {
    pub node: NodeId,
    pub prims: Vec<PrimId>,
}

/// One processor.
#[derive(Default)]
pub(super) struct Processor {
    pub structures: Vec<Structure>,
    /// Numbers of its visible structures, in their order.
    pub to_draw: VecDeque<usize>,
    /// Groups of invisible ones, in their order.
    pub to_ask: VecDeque<Vec<usize>>,
    /// Structures that answers let through.
    pub found: VecDeque<usize>,
    /// Questions on their way.
    pub waiting: u32,
    /// Since when it has been idle.
    pub idle: Option<u32>,
    /// The farthest depth of each region as it was read, empty before.
    pub farthest: Vec<f32>,
}

/// Deals structures out in the order of the tree.
pub(super) struct Dealer {
    pub distribution: Distribution,
    /// Structures and coarse cubes so far.
    dealt: usize,
    coarse: usize,
}

impl Dealer {
    pub fn new(distribution: Distribution) -> Self {
        Self { distribution, dealt: 0, coarse: 0 }
    }
    /// The tree's next node begins, at this level.
    pub fn enter(&mut self, level: u8) {
        self.coarse += usize::from(level <= COARSE_LEVEL);
    }
    /// Gives a structure to whom it belongs (Section 4.1).
    pub fn deal(&mut self, node: NodeId, prims: Vec<PrimId>, to: &mut [Processor]) {
        let count = to.len();
        match self.distribution {
            // "Keep individual structures together on a single processor", but deal them finely, so that
            // nearby areas are distributed equally.
            Distribution::Hybrid => to[self.dealt % count].structures.push(Structure { node, prims }),
            // Cubes follow their parents in the tree: what lies below a coarse cube goes where it went.
            Distribution::Structure => to[self.coarse % count].structures.push(Structure { node, prims }),
            // The primitives of each structure in round-robin fashion.
            Distribution::Primitive => {
                for (p, processor) in to.iter_mut().enumerate() {
                    let part: Vec<_> = prims.iter().skip(p).step_by(count).copied().collect();
                    if !part.is_empty() {
                        processor.structures.push(Structure { node, prims: part });
                    }
                }
            }
        }
        self.dealt += 1;
    }
}

impl Processor {
    /// Sorts its lists: visible structures by decreasing area on the screen, invisible ones by increasing
    /// number of primitives (Section 4.2). `visible`: a mark for each node.
    pub fn sort<S: Faces>(
        &mut self,
        distribution: Distribution,
        visible: &[bool],
        index: &Octree<S::Vector>,
        view: &View<S>,
        projection: &Projection<S::Vector>,
    ) {
        let (mut shown, mut hidden): (Vec<usize>, Vec<usize>) =
            (0..self.structures.len()).partition(|&s| visible[self.structures[s].node.at()]);
        // What covers most fills the z-buffer fastest. The area is that of the box's screen rectangle.
        let area =
            |s: &usize| match footprint(view, projection, &index.nodes()[self.structures[*s].node.at()].held)
            {
                Footprint::Seen(image) => image.pixels.area(),
                Footprint::Outside => 0,
                Footprint::CrossesNear => u64::MAX,
            };
        shown.sort_by_key(|s| (Reverse(area(s)), *s));
        // What costs most waits longest, while other processors fill the z-buffer.
        hidden.sort_by_key(|&s| (self.structures[s].prims.len(), s));
        // "Once the structures have been distributed, each processor can recombine its own allotment into a
        // tree": here by one query for several. The paper leaves open how.
        let groups = if distribution == Distribution::Hybrid { self.grouped(index, &hidden) } else { vec![] };
        let mut in_group = vec![false; self.structures.len()];
        groups.iter().flatten().for_each(|&s| in_group[s] = true);
        let single = hidden.into_iter().filter(|&s| !in_group[s]).map(|s| vec![s]);
        let mut to_ask: Vec<Vec<usize>> = groups.into_iter().chain(single).collect();
        let work = |group: &Vec<usize>| group.iter().map(|&s| self.structures[s].prims.len()).sum::<usize>();
        to_ask.sort_by_key(|g| (work(g), g[0]));
        (self.to_draw, self.to_ask) = (shown.into(), to_ask.into());
    }
    /// Invisible structures below the same cube of a coarse level, two or more.
    fn grouped<V: Vector>(&self, index: &Octree<V>, hidden: &[usize]) -> Vec<Vec<usize>> {
        let mut groups: BTreeMap<NodeId, Vec<usize>> = BTreeMap::new();
        for &s in hidden {
            groups.entry(group_of(index, self.structures[s].node)).or_default().push(s);
        }
        groups.into_values().filter(|g| g.len() > 1).collect()
    }
    /// Takes in structures that may be seen: one is drawn, of several each is queried.
    pub fn let_through(&mut self, group: Vec<usize>) {
        match group[..] {
            [s] => self.found.push_back(s),
            _ => group.into_iter().rev().for_each(|s| self.to_ask.push_front(vec![s])),
        }
    }
}

/// The cube that stands for a group of structures, this one among them.
pub(super) fn group_of<V: Vector>(index: &Octree<V>, node: NodeId) -> NodeId {
    // One level finer than what the coarse distribution deals out: a part of the scene that mostly is seen or
    // is not seen as a whole.
    std::iter::successors(Some(node), |n| index.parent_of(*n))
        .find(|n| index.nodes()[n.at()].level <= COARSE_LEVEL + 1)
        .unwrap_or(node)
}
