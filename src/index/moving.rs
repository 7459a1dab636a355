//! Which boxes of a tree follow primitives that move.
//!
//! A tree keeps its nodes and what they list; only boxes change. They depend on the present places alone, not
//! on the way there. A box gets looser the farther something moves from where it was when the tree was built.
//! Found once in O(primitives); a frame then costs O(references to what moves + nodes above them).

use std::ops::Range;

use crate::geometry::{NodeId, PrimId};

/// The nodes of a tree that what moves has a part in.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moving<B> {
    pub lists: Vec<List<B>>,
    prims: Vec<PrimId>,
    /// The nodes of `lists` and all above them, children before parents.
    pub nodes: Vec<NodeId>,
}

/// A node that lists primitives that move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct List<B> {
    pub node: NodeId,
    /// The boxes of what else it lists.
    pub still: B,
    range: Range<u32>,
}

impl<B> Moving<B> {
    /// `listed`: what each of `count` nodes lists; `still`: the boxes of those that `moves` leaves out.
    pub fn new<'a>(
        count: usize,
        listed: impl Fn(NodeId) -> [&'a [PrimId]; 2],
        parent: impl Fn(NodeId) -> Option<NodeId>,
        moves: impl Fn(PrimId) -> bool,
        mut still: impl FnMut(NodeId, &mut dyn Iterator<Item = PrimId>) -> B,
    ) -> Self {
        let (mut lists, mut prims, mut is_above) = (Vec::new(), Vec::new(), vec![false; count]);
        for node in (0..count as u32).map(NodeId) {
            let all = || listed(node).into_iter().flatten().copied();
            let first = prims.len() as u32;
            prims.extend(all().filter(|p| moves(*p)));
            let range = first..prims.len() as u32;
            if range.is_empty() {
                continue;
            }
            lists.push(List { node, still: still(node, &mut all().filter(|p| !moves(*p))), range });
            let mut up = Some(node);
            while let Some(at) = up.filter(|at| !is_above[at.at()]) {
                is_above[at.at()] = true;
                up = parent(at);
            }
        }
        // Parents come before their children in the list of nodes.
        let nodes = (0..count as u32).rev().map(NodeId).filter(|n| is_above[n.at()]).collect();
        Self { lists, prims, nodes }
    }
    /// The primitives of a list that move.
    pub fn of(&self, list: &List<B>) -> &[PrimId] {
        &self.prims[list.range.start as usize..list.range.end as usize]
    }
}
