//! A tree of cells that are halved: an octree, in flatland a quadtree, whose leaves refer to all primitives
//! that meet them.
//!
//! Chamberlain, DeRose, Lischinski, Salesin and Snyder 1996, Section 4. Cells follow from halving the root,
//! so a node is 20 bytes. Making it:
//!
//! 1. the root is a cube about the scene, and refers to every primitive, with a share of 1 each; or to every
//!    object ([`Items`]), with a share of as many as it has primitives;
//! 2. a primitive goes to each child that it meets, by exact contact, and an object to each that boxes of its
//!    primitives meet; what lies on a dividing plane goes to the lower side. These share what the parent had
//!    of it equally;
//! 3. a cell is not divided if the caller says so, by the sum of its shares and the number of children that
//!    would hold something; nor where division would not part anything;
//! 4. children that would hold nothing are not made.
//!
//! The paper divides a primitive's cost by the number of cells in which it appears, which changes while the
//! tree grows; shares depend on the cells above alone, and their sum over the leaves is what it was at the
//! root. Cost: O(primitives · levels) tests of contact.

use std::ops::Range;
use std::sync::OnceLock;

use super::octree::{cube_around, octant_of};
use super::tessellation::Cellular;
use super::{Hierarchy, Items};
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};
use crate::scene::Scene;

/// A cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct CellNode {
    parent: u32,
    /// Of a leaf: how many of its references, its first ones, are to primitives that no other leaf meets.
    first_child: u32,
    first: u32,
    count: u32,
    /// Which children there are, a bit each; 0 of a leaf.
    pub octants: u8,
    /// Below the root, which is 0.
    pub level: u8,
    /// Which child of its parent it is: bit `a` says upper on axis `a`.
    pub octant: u8,
    /// Level of the deepest leaf at or below it.
    pub lowest: u8,
}

/// How many children come before one: of a mask and an octant.
static BEFORE: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut octant = 0;
        while octant < 8 {
            table[mask][octant] = (mask & ((1 << octant) - 1)).count_ones() as u8;
            octant += 1;
        }
        mask += 1;
    }
    table
};

impl CellNode {
    /// Whether it has no children.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.octants == 0
    }
    /// Its child of an octant, if there is one.
    #[inline]
    pub fn child(&self, octant: usize) -> Option<NodeId> {
        let before = BEFORE[usize::from(self.octants)][octant];
        (self.octants >> octant & 1 == 1).then(|| NodeId(self.first_child + u32::from(before)))
    }
    /// Its children; none of a leaf.
    pub fn children(&self) -> Range<u32> {
        self.first_child..self.first_child + self.octants.count_ones()
    }
}

/// The tree.
#[derive(Debug)]
pub struct CellTree<V> {
    root: Aabb<V>,
    nodes: Vec<CellNode>,
    /// What it refers to.
    items: Items,
    /// Of the leaves in the order in which they are reached, so that those below a node are in one piece. Of
    /// each leaf those that no other leaf has come first, ascending, then the rest, ascending.
    references: Vec<PrimId>,
    /// Made when it is first asked for: a traversal does not need it.
    whole: OnceLock<Wholes>,
}

/// Which primitives lie wholly at and below which node.
#[derive(Debug)]
struct Wholes {
    prims: Vec<PrimId>,
    /// Of each node: where its list begins, where what lies in no single child of it ends, and where it ends.
    spans: Vec<[u32; 3]>,
}

impl<V: Vector> CellTree<V> {
    /// Levels at most.
    pub const MOST_LEVELS: u32 = 20;

    /// The tree of items of a scene with so many levels at most. `stop`: whether a cell is not divided, by
    /// its sum of shares and the children that would hold something; it says so of fewer shares, and of more
    /// children, too. `None` when cancelled.
    pub fn build<S: Cellular<Vector = V>>(
        scene: &Scene<S>,
        items: Items,
        levels: u32,
        stop: &dyn Fn(f64, u32) -> bool,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<Self> {
        Self::build_in(cube_around(&scene.bounds()), scene, items, levels, stop, cancelled)
    }
    /// The same from another cube around the scene.
    pub fn build_in<S: Cellular<Vector = V>>(
        root: Aabb<V>,
        scene: &Scene<S>,
        items: Items,
        levels: u32,
        stop: &dyn Fn(f64, u32) -> bool,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let mut making = Making {
            scene,
            items: &items,
            boxes: items.boxes(scene),
            levels: levels.min(Self::MOST_LEVELS),
            stop,
            cancelled,
            nodes: vec![CellNode::leaf(0, 0, 0)],
            references: Vec::new(),
        };
        // 1. A triangle or segment costs 1 to draw.
        let mut all = Held::default();
        for item in items.all(scene) {
            let prims = items.prims(item);
            all.shares.push(Share { item, share: prims.len() as f32, parts: prims.len() as u32 });
            if !items.are_single() {
                all.parts.extend(prims.map(PrimId));
            }
        }
        making.divide(0, &root, all)?;
        let Making { mut nodes, mut references, .. } = making;
        own_first(scene, &mut nodes, &mut references);
        // Children follow their parents.
        for at in (1..nodes.len()).rev() {
            let (parent, lowest) = (nodes[at].parent as usize, nodes[at].lowest);
            nodes[parent].lowest = nodes[parent].lowest.max(lowest);
        }
        Some(Self { root, nodes, items, references, whole: OnceLock::new() })
    }
    /// All nodes; a node's number is its id, and children follow their parents.
    pub fn nodes(&self) -> &[CellNode] {
        &self.nodes
    }
    /// The root's cell.
    pub fn root(&self) -> &Aabb<V> {
        &self.root
    }
    /// What it refers to.
    pub fn items(&self) -> &Items {
        &self.items
    }
    /// What the leaves at and below a node refer to, in their order.
    pub fn references(&self, node: NodeId) -> &[PrimId] {
        let node = &self.nodes[node.at()];
        &self.references[node.first as usize..][..node.count as usize]
    }
    /// What a leaf refers to: what no other leaf does, and the rest.
    #[inline]
    pub fn of_leaf(&self, leaf: NodeId) -> (&[PrimId], &[PrimId]) {
        self.references(leaf).split_at(self.nodes[leaf.at()].first_child as usize)
    }
    /// The cell of a node, found from the root.
    pub fn cell(&self, node: NodeId) -> Aabb<V> {
        let (mut way, mut at) = (Vec::new(), node.at());
        while at > 0 {
            way.push(usize::from(self.nodes[at].octant));
            at = self.nodes[at].parent as usize;
        }
        way.iter().rev().fold(self.root, |cell, &octant| octant_of(&cell, octant))
    }
    /// The primitives that lie at and below a node, but in no single child of it.
    pub fn shared(&self, node: NodeId) -> &[PrimId] {
        let [first, own, _] = self.wholes().spans[node.at()];
        &self.wholes().prims[first as usize..own as usize]
    }
    fn wholes(&self) -> &Wholes {
        self.whole.get_or_init(|| Wholes::new(&self.nodes, &self.items, &self.references))
    }
    /// Bytes without what is made for stepping.
    pub fn bytes(&self) -> usize {
        let references = self.references.len() * size_of::<PrimId>();
        self.nodes.len() * size_of::<CellNode>() + references + self.items.bytes()
    }

    /// Its nodes, five words each, and its references, from which it is made again with the same root.
    pub fn tables(&self) -> [Vec<u32>; 2] {
        let words = |n: &CellNode| {
            let packed = u32::from_le_bytes([n.octants, n.level, n.octant, n.lowest]);
            [n.parent, n.first_child, n.first, n.count, packed]
        };
        [self.nodes.iter().flat_map(words).collect(), self.references.iter().map(|p| p.0).collect()]
    }
    /// The tree of [`CellTree::tables`] over items of a scene; `None` if they are not those of a tree over
    /// it.
    pub fn of_tables<S: Space<Vector = V>>(
        scene: &Scene<S>,
        items: Items,
        nodes: &[u32],
        references: Vec<u32>,
    ) -> Option<Self> {
        let node = |words: &[u32; 5]| {
            let [parent, first_child, first, count, packed] = *words;
            let [octants, level, octant, lowest] = packed.to_le_bytes();
            CellNode { parent, first_child, first, count, octants, level, octant, lowest }
        };
        let (words, rest) = nodes.as_chunks::<5>();
        let nodes: Vec<CellNode> = words.iter().map(node).collect();
        let references: Vec<PrimId> = references.into_iter().map(PrimId).collect();
        let is_whole = rest.is_empty() && are_a_tree(&nodes, V::AXES, references.len());
        let are_live = references.iter().all(|item| items.has(scene, *item));
        if !(is_whole && are_live) {
            return None;
        }
        // What is said to be met by one leaf alone must be so, or it would be drawn twice.
        let (mut again, mut sorted) = (nodes.clone(), references.clone());
        own_first(scene, &mut again, &mut sorted);
        let root = cube_around(&scene.bounds());
        (again == nodes && sorted == references).then(|| Self {
            root,
            nodes,
            items,
            references,
            whole: OnceLock::new(),
        })
    }
}

/// Whether nodes are a tree whose leaves share out so many references.
fn are_a_tree(nodes: &[CellNode], axes: usize, references: usize) -> bool {
    let Some(root) = nodes.first() else { return false };
    if (root.level, root.first, root.count as usize) != (0, 0, references) {
        return false;
    }
    let mut next = 1;
    let mut mentions = vec![false; nodes.len()];
    for (at, node) in nodes.iter().enumerate() {
        if node.octants >> ((1 << axes) - 1) > 1
            || u32::from(node.level) >= CellTree::<glam::Vec3>::MOST_LEVELS
        {
            return false;
        }
        let (mut first, mut octants, mut lowest) = (node.first, node.octants, node.level);
        for id in if node.is_leaf() { 0..0 } else { node.children() } {
            let Some(child) = nodes.get(id as usize).filter(|_| id as usize > at) else { return false };
            let octant = octants.trailing_zeros();
            octants &= octants.wrapping_sub(1);
            let is_ours = child.parent as usize == at && child.level == node.level + 1;
            if !is_ours || u32::from(child.octant) != octant || child.first != first || mentions[id as usize]
            {
                return false;
            }
            mentions[id as usize] = true;
            first = first.saturating_add(child.count);
            lowest = lowest.max(child.lowest);
            next += 1;
        }
        let is_filled = node.is_leaf() || first == node.first.saturating_add(node.count);
        if !is_filled || lowest != node.lowest {
            return false;
        }
    }
    next == nodes.len()
}

/// Sorts the references of each leaf: first those to primitives that no other leaf meets.
fn own_first<S: Space>(scene: &Scene<S>, nodes: &mut [CellNode], references: &mut [PrimId]) {
    let mut times = vec![0u32; scene.prim_count()];
    references.iter().for_each(|prim| times[prim.at()] += 1);
    for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
        let held = &mut references[node.first as usize..][..node.count as usize];
        held.sort_unstable_by_key(|prim| (times[prim.at()] > 1, *prim));
        node.first_child = held.partition_point(|prim| times[prim.at()] == 1) as u32;
    }
}

/// A reference to an item with the part of its cost that the cell bears.
#[derive(Clone, Copy)]
struct Share {
    item: PrimId,
    share: f32,
    /// Of an object: how many of its primitives the cell meets, by their boxes.
    parts: u32,
}

/// What a cell in the making holds.
#[derive(Default)]
struct Held {
    shares: Vec<Share>,
    /// Those primitives of objects, one object after the other: objects are large, and of their primitives
    /// most are in other cells.
    parts: Vec<PrimId>,
}

/// A tree in the making.
struct Making<'a, S: Space> {
    scene: &'a Scene<S>,
    items: &'a Items,
    /// Of objects.
    boxes: Vec<Aabb<S::Vector>>,
    levels: u32,
    stop: &'a dyn Fn(f64, u32) -> bool,
    cancelled: &'a dyn Fn() -> bool,
    nodes: Vec<CellNode>,
    references: Vec<PrimId>,
}

impl CellNode {
    fn leaf(parent: u32, level: u8, octant: u8) -> Self {
        Self { parent, first_child: 0, first: 0, count: 0, octants: 0, level, octant, lowest: level }
    }
}

impl<S: Cellular> Making<'_, S> {
    /// Divides a node's cell, or makes it a leaf; `None` when cancelled.
    fn divide(&mut self, at: usize, cell: &Aabb<S::Vector>, list: Held) -> Option<()> {
        if (self.cancelled)() {
            return None;
        }
        let first = self.references.len() as u32;
        match self.parted(at, cell, &list) {
            None => self.references.extend(list.shares.iter().map(|s| s.item)),
            Some(lists) => {
                drop(list);
                let (level, first_child) = (self.nodes[at].level + 1, self.nodes.len() as u32);
                // 4. The children stand side by side, each before all that is below it.
                let is_held = |(_, list): &(usize, &Held)| !list.shares.is_empty();
                for (octant, _) in lists.iter().enumerate().filter(is_held) {
                    self.nodes.push(CellNode::leaf(at as u32, level, octant as u8));
                    self.nodes[at].octants |= 1 << octant;
                }
                self.nodes[at].first_child = first_child;
                let held = lists.into_iter().enumerate().filter(|(_, list)| !list.shares.is_empty());
                for (child, (octant, list)) in held.enumerate() {
                    self.divide(first_child as usize + child, &octant_of(cell, octant), list)?;
                }
            }
        }
        let node = &mut self.nodes[at];
        (node.first, node.count) = (first, self.references.len() as u32 - first);
        Some(())
    }

    /// What each child of a cell would get; `None` if the cell is not divided.
    fn parted(&self, at: usize, cell: &Aabb<S::Vector>, list: &Held) -> Option<[Held; 8]> {
        // 3. One child is the least.
        let sum: f64 = list.shares.iter().map(|s| f64::from(s.share)).sum();
        if u32::from(self.nodes[at].level) + 1 >= self.levels || (self.stop)(sum, 1) {
            return None;
        }
        // Where numbers are too coarse to halve a side, no plane lies between its ends.
        let center = cell.center();
        let halves = |a: usize| cell.min.get(a) < center.get(a) && center.get(a) < cell.max.get(a);
        if !(0..S::Vector::AXES).all(halves) {
            return None;
        }
        // 2. To each child that it meets.
        let mut lists: [Held; 8] = Default::default();
        let mut parts = &list.parts[..];
        for one in &list.shares {
            let mut counts = [0; 8];
            let octants = if self.items.are_single() {
                self.octants_of(one.item, cell)
            } else {
                let of_item;
                (of_item, parts) = parts.split_at(one.parts as usize);
                self.part_object(one.item, of_item, cell, (&mut lists, &mut counts))
            };
            let share = one.share / octants.count_ones().max(1) as f32;
            for (octant, to) in lists.iter_mut().enumerate().filter(|(octant, _)| octants >> octant & 1 == 1)
            {
                to.shares.push(Share { share, parts: counts[octant], ..*one });
            }
        }
        let held = lists.iter().filter(|l| !l.shares.is_empty()).count();
        let is_same = |l: &Held| l.shares.is_empty() || l.shares.len() == list.shares.len();
        let parts_nothing = held > 1 && lists.iter().all(is_same);
        // For one child the answer is known.
        let is_small = held > 1 && (self.stop)(sum, held as u32);
        (held > 0 && !parts_nothing && !is_small).then_some(lists)
    }

    /// Gives each child of a cell the primitives of an object that it meets, and counts them; which children
    /// meet the object, a bit each.
    fn part_object(
        &self,
        item: PrimId,
        parts: &[PrimId],
        cell: &Aabb<S::Vector>,
        (lists, counts): (&mut [Held; 8], &mut [u32; 8]),
    ) -> u8 {
        // About the corners of its box there may be nothing of it.
        let met = octants_touched(&self.boxes[self.items.number(item)], cell);
        let mut filled = 0;
        for &prim in parts {
            let octants = octants_touched(&Aabb::of(self.scene.prim_points(prim)), cell) & met;
            filled |= octants;
            let mut left = octants;
            while left != 0 {
                let octant = left.trailing_zeros() as usize;
                left &= left - 1;
                lists[octant].parts.push(prim);
                counts[octant] += 1;
            }
        }
        filled
    }

    /// Which children of a cell a primitive of it meets, a bit each.
    fn octants_of(&self, item: PrimId, cell: &Aabb<S::Vector>) -> u8 {
        let mut corners = [S::Vector::default(); 3];
        for (to, from) in corners.iter_mut().zip(self.scene.prim_points(item)) {
            *to = from;
        }
        let corners = &corners[..S::CORNERS];
        let met = octants_touched(&Aabb::of(corners.iter().copied()), cell);
        // A slanted one misses some of those that its box meets.
        if met.count_ones() > 1 { S::meets_octants(corners, cell, met) } else { met }
    }
}

/// Which children of a cell a box in it meets, a bit each.
pub fn octants_touched<V: Vector>(bounds: &Aabb<V>, cell: &Aabb<V>) -> u8 {
    let center = cell.center();
    let (mut octants, mut met) = ([1u8, 0, 0], 0u8);
    for (a, sides) in octants.iter_mut().enumerate().take(V::AXES) {
        let (low, high, plane) = (bounds.min.get(a), bounds.max.get(a), center.get(a));
        // On the plane alone: the lower side.
        *sides = u8::from(low < plane || high <= plane) | u8::from(high > plane) << 1;
    }
    for octant in 0..1usize << V::AXES {
        let meets = (0..V::AXES).all(|a| octants[a] >> (octant >> a & 1) & 1 == 1);
        met |= u8::from(meets) << octant;
    }
    met
}

impl Wholes {
    fn new(nodes: &[CellNode], items: &Items, references: &[PrimId]) -> Self {
        const NEVER: u32 = u32::MAX;
        let count = references.iter().map(|p| p.at() + 1).max().unwrap_or(0);
        // Of each item the lowest node that holds all of it.
        let mut owner = vec![NEVER; count];
        for (at, node) in nodes.iter().enumerate().filter(|(_, n)| n.is_leaf()) {
            for prim in &references[node.first as usize..][..node.count as usize] {
                let known = &mut owner[prim.at()];
                *known = if *known == NEVER { at as u32 } else { above_both(nodes, *known, at as u32) };
            }
        }
        let mut held = vec![0u32; nodes.len()];
        let owned = || owner.iter().enumerate().filter(|(_, o)| **o != NEVER);
        owned().for_each(|(item, o)| held[*o as usize] += items.prims(PrimId(item as u32)).len() as u32);
        // Each node before all that is below it.
        let (mut spans, mut next, mut open) = (vec![[0; 3]; nodes.len()], 0, vec![(0, false)]);
        while let Some((at, is_done)) = open.pop() {
            let (node, id): (&CellNode, u32) = (&nodes[at as usize], at);
            if is_done {
                spans[id as usize][2] = next;
                continue;
            }
            spans[id as usize] = [next, next + held[id as usize], 0];
            next += held[id as usize];
            open.push((id, true));
            if !node.is_leaf() {
                open.extend(node.children().rev().map(|child| (child, false)));
            }
        }
        let mut prims = vec![PrimId(0); next as usize];
        let mut to: Vec<u32> = spans.iter().map(|span| span[0]).collect();
        for (item, &at) in owned() {
            for prim in items.prims(PrimId(item as u32)) {
                prims[to[at as usize] as usize] = PrimId(prim);
                to[at as usize] += 1;
            }
        }
        Self { prims, spans }
    }
}

/// The lowest node that two nodes are at or below.
fn above_both(nodes: &[CellNode], mut a: u32, mut b: u32) -> u32 {
    while a != b {
        let (lower, other) = if nodes[a as usize].level >= nodes[b as usize].level { (a, b) } else { (b, a) };
        (a, b) = (nodes[lower as usize].parent, other);
    }
    a
}

impl<S: Space> Hierarchy<S> for CellTree<S::Vector> {
    fn node_count(&self) -> usize {
        self.nodes.len()
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        self.cell(node)
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        (node.at() > 0).then(|| NodeId(self.nodes[node.at()].parent))
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        let node = &self.nodes[node.at()];
        if node.is_leaf() { 0..0 } else { node.children() }
    }
    fn level(&self, node: NodeId) -> u32 {
        self.nodes[node.at()].level.into()
    }
    fn prims(&self, node: NodeId) -> &[PrimId] {
        let [first, _, end] = self.wholes().spans[node.at()];
        &self.wholes().prims[first as usize..end as usize]
    }
    fn held(&self, node: NodeId) -> usize {
        self.items.count(self.references(node))
    }
    fn bytes(&self) -> usize {
        CellTree::bytes(self)
    }
}
