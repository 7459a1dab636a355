//! Structures, how they are dealt out to processors, and in which order a processor takes them.

use std::cmp::Reverse;
use std::collections::{BTreeMap, VecDeque};

use super::machine::Distribution;
use crate::culling::depth::{Faces, footprint};
use crate::geometry::{Footprint, NodeId, PrimId, Projection, Vector, View};
use crate::index::Octree;

/// Levels of cubes whose subtrees are dealt as one where the distribution is by subtree.
const COARSE_LEVEL: u8 = 2;

/// A structure, "a bounding volume and its associated geometry" (Section 4.1), as one processor holds it: a
/// cube, and what it holds itself.
#[derive(Clone, Debug)]
pub(super) struct Structure {
    pub node: NodeId,
    /// Primitives that are the cube's alone, then those that it shares with others.
    pub prims: Vec<PrimId>,
    /// How many are its alone.
    pub own: usize,
    /// Whether it is on the processor's visible list; otherwise on its invisible one.
    pub is_listed: bool,
}

/// What a processor keeps from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Allotment {
    pub structures: Vec<Structure>,
    /// Frames since its visible list was checked.
    pub frames: u32,
    /// The farthest depth of the last image, as it was told; 0 before.
    pub farthest: f32,
}

/// One processor in a frame.
#[derive(Default)]
pub(super) struct Processor {
    /// Numbers of its visible structures, in their order.
    pub to_draw: VecDeque<usize>,
    /// Groups of invisible ones, in their order.
    pub to_ask: VecDeque<Vec<usize>>,
    /// Structures that answers let through.
    pub found: VecDeque<usize>,
    /// Visible ones that are checked against the finished image.
    pub to_check: VecDeque<usize>,
    /// Structures that came onto its visible list in this frame.
    pub added: u32,
    /// Replies on their way.
    pub waiting: u32,
    /// Since when it has been idle.
    pub idle: Option<u32>,
    /// Whether it has drawn something from its visible list.
    pub has_drawn: bool,
    /// Whether it has asked for the farthest depths.
    pub has_asked: bool,
    /// The farthest depth of each region as it was told; 0, farther than all, before.
    pub farthest: Vec<f32>,
}

/// Deals the structures of a tree out to so many processors (Section 4.1). It depends on no view:
/// "redistributing the structures to rebalance the lists every frame is too expensive" (Section 4.2).
pub(super) fn dealt<V: Vector>(
    index: &Octree<V>,
    distribution: Distribution,
    processors: usize,
) -> Vec<Allotment> {
    let mut to = vec![Allotment::default(); processors];
    let owner = if distribution == Distribution::Subtree { owners(index, processors) } else { vec![] };
    let mut dealt = 0;
    for at in 0..index.nodes().len() {
        let node = NodeId(at as u32);
        let (own, shared) = (index.own(node), index.shared(node));
        if own.is_empty() && shared.is_empty() {
            continue;
        }
        let whole = || Structure {
            node,
            prims: own.iter().chain(shared).copied().collect(),
            own: own.len(),
            is_listed: false,
        };
        match distribution {
            // Section 5.1: "The structures are passed out round-robin". The hybrid asks besides that nearby
            // areas go to different processors, which neighbors in the order of the tree do.
            Distribution::Structure | Distribution::Hybrid => to[dealt % processors].structures.push(whole()),
            Distribution::Subtree => to[owner[at]].structures.push(whole()),
            // The primitives of each structure in round-robin fashion.
            Distribution::Primitive => {
                for (p, allotment) in to.iter_mut().enumerate() {
                    let part = |of: &[PrimId], first: usize| -> Vec<PrimId> {
                        of.iter().skip(first).step_by(processors).copied().collect()
                    };
                    let mut prims = part(own, p);
                    let mine = prims.len();
                    // The turn goes on where those of the cube alone ended.
                    prims.extend(part(shared, (p + processors - own.len() % processors) % processors));
                    if !prims.is_empty() {
                        allotment.structures.push(Structure { node, prims, own: mine, is_listed: false });
                    }
                }
            }
        }
        dealt += 1;
    }
    to
}

/// The processor of each node where whole subtrees are dealt out: each to the processor that has the fewest
/// primitives, so that shares differ by no more than the largest subtree.
fn owners<V: Vector>(index: &Octree<V>, processors: usize) -> Vec<usize> {
    let nodes = index.nodes();
    // A cube above the coarse level is dealt alone, one of it with all below it.
    let head = |at: usize| {
        let chain = std::iter::successors(Some(NodeId(at as u32)), |n| index.parent_of(*n));
        chain.into_iter().find(|n| nodes[n.at()].level <= COARSE_LEVEL).map_or(at, NodeId::at)
    };
    let mut load = vec![0; nodes.len()];
    for at in 0..nodes.len() {
        let node = NodeId(at as u32);
        load[head(at)] += index.own(node).len() + index.shared(node).len();
    }
    let (mut owner, mut share) = (vec![0; nodes.len()], vec![0; processors]);
    for at in 0..nodes.len() {
        let head = head(at);
        if head == at {
            let least = (0..processors).min_by_key(|&p| (share[p], p)).unwrap_or_default();
            share[least] += load[at];
            owner[at] = least;
        } else {
            // Parents come before their children.
            owner[at] = owner[head];
        }
    }
    owner
}

impl Processor {
    /// Sorts its lists: visible structures by decreasing area on the screen, invisible ones by increasing
    /// number of primitives (Section 4.2). `outside`: a mark for each node whose structure is out of view.
    pub fn sort<S: Faces>(
        &mut self,
        structures: &[Structure],
        distribution: Distribution,
        outside: &[bool],
        index: &Octree<S::Vector>,
        view: &View<S>,
        projection: &Projection<S::Vector>,
    ) {
        let in_view = (0..structures.len()).filter(|&s| !outside[structures[s].node.at()]);
        let (mut shown, mut hidden): (Vec<usize>, Vec<usize>) =
            in_view.partition(|&s| structures[s].is_listed);
        // What covers most fills the z-buffer fastest. The area is that of the box's screen rectangle.
        let area =
            |s: &usize| match footprint(view, projection, &index.nodes()[structures[*s].node.at()].held) {
                Footprint::Seen(image) => image.pixels.area(),
                Footprint::Outside => 0,
                Footprint::CrossesNear => u64::MAX,
            };
        shown.sort_by_cached_key(|s| (Reverse(area(s)), *s));
        // What costs most waits longest, while other processors fill the z-buffer.
        hidden.sort_by_key(|&s| (structures[s].prims.len(), s));
        // "Once the structures have been distributed, each processor can recombine its own allotment into a
        // tree": here by one query for several. The paper leaves open how.
        let groups =
            if distribution == Distribution::Hybrid { grouped(structures, index, &hidden) } else { vec![] };
        let mut in_group = vec![false; structures.len()];
        groups.iter().flatten().for_each(|&s| in_group[s] = true);
        let single = hidden.into_iter().filter(|&s| !in_group[s]).map(|s| vec![s]);
        let mut to_ask: Vec<Vec<usize>> = groups.into_iter().chain(single).collect();
        let work = |group: &Vec<usize>| group.iter().map(|&s| structures[s].prims.len()).sum::<usize>();
        to_ask.sort_by_cached_key(|g| (work(g), g[0]));
        (self.to_draw, self.to_ask) = (shown.into(), to_ask.into());
    }
    /// Takes in structures that may be seen: one is drawn, of several each is queried.
    pub fn let_through(&mut self, group: Vec<usize>) {
        match group[..] {
            [s] => self.found.push_back(s),
            _ => group.into_iter().rev().for_each(|s| self.to_ask.push_front(vec![s])),
        }
    }
}

/// Invisible structures below the same cube of a coarse level, two or more.
fn grouped<V: Vector>(structures: &[Structure], index: &Octree<V>, hidden: &[usize]) -> Vec<Vec<usize>> {
    let mut groups: BTreeMap<NodeId, Vec<usize>> = BTreeMap::new();
    for &s in hidden {
        groups.entry(group_of(index, structures[s].node)).or_default().push(s);
    }
    groups.into_values().filter(|g| g.len() > 1).collect()
}

/// The cube that stands for a group of structures, this one among them.
pub(super) fn group_of<V: Vector>(index: &Octree<V>, node: NodeId) -> NodeId {
    // One level finer than the subtrees of a distribution: a part of the scene that mostly is seen or is not
    // seen as a whole.
    std::iter::successors(Some(node), |n| index.parent_of(*n))
        .find(|n| index.nodes()[n.at()].level <= COARSE_LEVEL + 1)
        .unwrap_or(node)
}
