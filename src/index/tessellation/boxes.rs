//! Cells that are boxes: the leaves of a binary tree that divides a box by axis-parallel planes.
//!
//! 1. The tree is built from a rule that divides a box, or makes it a leaf ([`BoxCells::build`]). An octree
//!    is such a tree too: its nodes are divided along each axis in turn.
//! 2. Neighbors are found by descending both sides of every dividing plane together ([`join`]), across levels
//!    of any difference, in O(pairs of neighbors + nodes). Departure: Section 4.3 of Klosowski and Silva 2000
//!    (Figure 9) walks up and down the octree from each leaf, and lets deeper leaves complete the lists of
//!    higher ones.

use super::{Adjacency, Cellular, Exit, Neighbor, Tessellation, Tried};
use crate::geometry::{Aabb, CellId, Vector};

/// Deeper than this no tree divides, so that recursion stays shallow. These are 32 halvings on
/// each of three axes, more than the 24 bits of f32 can tell apart.
const MAX_LEVEL: u32 = 96;

/// A node: divided at `split` along `axis`, or a leaf.
#[derive(Clone, Copy, Debug)]
struct Node<V> {
    bounds: Aabb<V>,
    split: f32,
    /// The axis, or [`Node::LEAF`].
    axis: u8,
    /// The first of two neighboring children, or the cell of a leaf.
    link: u32,
}

impl<V> Node<V> {
    const LEAF: u8 = u8::MAX;
    fn is_leaf(&self) -> bool {
        self.axis == Self::LEAF
    }
}

/// Leaves of a tree of boxes.
#[derive(Clone, Debug)]
pub struct BoxCells<V> {
    nodes: Vec<Node<V>>,
    /// The node of each cell.
    leaves: Vec<u32>,
    pub(super) adjacency: Adjacency<V>,
}

/// Where a tree divides a box: axis and place; `None` makes it a leaf.
pub(super) type Divide<'a, V> = dyn FnMut(&Aabb<V>, u32, &mut [V]) -> Option<(usize, f32)> + 'a;

impl<V: Vector> BoxCells<V> {
    /// Divides a box by the rule `divide`, a function of box, level and the points in the box. `None` when
    /// cancelled.
    pub(super) fn build(
        region: Aabb<V>,
        points: &mut [V],
        divide: &mut Divide<'_, V>,
        cancelled: impl Fn() -> bool,
    ) -> Option<Self> {
        let leaf = Node { bounds: region, split: 0.0, axis: Node::<V>::LEAF, link: 0 };
        let (mut nodes, mut leaves) = (vec![leaf], Vec::new());
        let mut open = vec![(0u32, 0u32, points)];
        // 1. Depth first, the lower child first, so cells are numbered along the tree and near ones have near
        // numbers.
        while let Some((at, level, points)) = open.pop() {
            if cancelled() {
                return None;
            }
            let bounds = nodes[at as usize].bounds;
            // A plane on a side of the box would leave a cell without volume, and rounding can put it there.
            let inside = |(axis, split): &(usize, f32)| {
                bounds.min.get(*axis) < *split && *split < bounds.max.get(*axis)
            };
            let Some((axis, split)) =
                (level < MAX_LEVEL).then(|| divide(&bounds, level, points)).flatten().filter(inside)
            else {
                nodes[at as usize].link = leaves.len() as u32;
                leaves.push(at);
                continue;
            };
            // Children are neighbors in the list, so one number names both.
            let first = nodes.len() as u32;
            let cut = |low: bool, a: usize, v: f32| if a == axis && low { split } else { v };
            let below = Aabb { min: bounds.min, max: V::from_fn(|a| cut(true, a, bounds.max.get(a))) };
            let above = Aabb { min: V::from_fn(|a| cut(true, a, bounds.min.get(a))), max: bounds.max };
            nodes.push(Node { bounds: below, ..leaf });
            nodes.push(Node { bounds: above, ..leaf });
            (nodes[at as usize].axis, nodes[at as usize].split, nodes[at as usize].link) =
                (axis as u8, split, first);
            // Points on the plane belong to the upper half, as in `locate`.
            let middle = partition(points, |p| p.get(axis) < split);
            let (low, high) = points.split_at_mut(middle);
            open.push((first + 1, level + 1, high));
            open.push((first, level + 1, low));
        }
        Some(Self::joined(nodes, leaves))
    }
    fn joined(nodes: Vec<Node<V>>, leaves: Vec<u32>) -> Self {
        // 2. Two leaves that touch are parted by exactly one plane: that of the last node above both.
        let mut pairs = Vec::new();
        for node in nodes.iter().filter(|n| !n.is_leaf()) {
            join(&nodes, node.link, node.link + 1, node.axis as usize, &mut pairs);
        }
        let adjacency = Adjacency::new(leaves.len(), pairs);
        Self { nodes, leaves, adjacency }
    }

    /// The whole region.
    pub fn region(&self) -> Aabb<V> {
        self.nodes[0].bounds
    }
    fn cell(&self, cell: CellId) -> &Aabb<V> {
        &self.nodes[self.leaves[cell.at()] as usize].bounds
    }
    /// The tree as numbers, for [`BoxCells::of_tables`]: the region, then axis and split of each node, leaves
    /// with [`u32::MAX`].
    pub fn tables(&self) -> (Aabb<V>, Vec<(u32, f32)>) {
        let node = |n: &Node<V>| (if n.is_leaf() { u32::MAX } else { n.axis.into() }, n.split);
        (self.region(), self.in_order().into_iter().map(|at| node(&self.nodes[at as usize])).collect())
    }
    /// The nodes depth first, the lower child first: the order in which they are made again.
    fn in_order(&self) -> Vec<u32> {
        let (mut order, mut open) = (Vec::with_capacity(self.nodes.len()), vec![0]);
        while let Some(at) = open.pop() {
            order.push(at);
            let node = &self.nodes[at as usize];
            if !node.is_leaf() {
                open.extend([node.link + 1, node.link]);
            }
        }
        order
    }
    /// The tree of [`BoxCells::tables`]; `None` if they are not those of a tree.
    pub fn of_tables(region: Aabb<V>, table: &[(u32, f32)]) -> Option<Self> {
        let mut rows = table.iter();
        // The rule of the table's rows replaces the one that made them; the tree comes out the same, since
        // both divide in the same order.
        let mut short = !region.min.is_finite()
            || !region.max.is_finite()
            || (0..V::AXES).any(|a| region.min.get(a) >= region.max.get(a));
        let mut next = |bounds: &Aabb<V>, _: u32, _: &mut [V]| {
            let Some((axis, split)) = rows.next() else {
                short = true;
                return None;
            };
            let axis = *axis as usize;
            if axis < V::AXES && bounds.min.get(axis) < *split && *split < bounds.max.get(axis) {
                return Some((axis, *split));
            }
            // An axis whose plane misses the box is a fault; a leaf's row has no axis.
            short |= axis < V::AXES;
            None
        };
        let built = Self::build(region, &mut [], &mut next, || false)?;
        (!short && built.nodes.len() == table.len()).then_some(built)
    }
}

/// Moves what fits to the front and counts it.
fn partition<V: Copy>(points: &mut [V], fits: impl Fn(V) -> bool) -> usize {
    let mut front = 0;
    for at in 0..points.len() {
        if fits(points[at]) {
            points.swap(front, at);
            front += 1;
        }
    }
    front
}

/// Pairs the leaves of two subtrees, the first below and the second above a plane that both touch.
fn join<V: Vector>(
    nodes: &[Node<V>],
    below: u32,
    above: u32,
    axis: usize,
    pairs: &mut Vec<(CellId, Neighbor<V>)>,
) {
    // Below and above the plane.
    let (b, a) = (&nodes[below as usize], &nodes[above as usize]);
    // They must share more than an edge.
    let shares = |k: usize| {
        b.bounds.min.get(k).max(a.bounds.min.get(k)) < b.bounds.max.get(k).min(a.bounds.max.get(k))
    };
    if !(0..V::AXES).all(|k| k == axis || shares(k)) {
        return;
    }
    if !b.is_leaf() {
        // Of a node divided along the axis only the half at the plane touches it.
        let first = if b.axis as usize == axis { 1 } else { 0 };
        (first..2).for_each(|i| join(nodes, b.link + i, above, axis, pairs));
    // The same from above, once the lower side is a leaf.
    } else if !a.is_leaf() {
        let last = if a.axis as usize == axis { 1 } else { 2 };
        (0..last).for_each(|i| join(nodes, below, a.link + i, axis, pairs));
    } else {
        // Two leaves that share part of the plane: each lists the other.
        let normal = V::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
        pairs.push((CellId(b.link), Neighbor { cell: CellId(a.link), normal }));
        pairs.push((CellId(a.link), Neighbor { cell: CellId(b.link), normal: -normal }));
    }
}

impl<S: Cellular> Tessellation<S> for BoxCells<S::Vector> {
    fn count(&self) -> usize {
        self.leaves.len()
    }
    fn bounds(&self, cell: CellId) -> Aabb<S::Vector> {
        *self.cell(cell)
    }
    fn center(&self, cell: CellId) -> S::Vector {
        self.cell(cell).center()
    }
    fn contains(&self, cell: CellId, point: S::Vector) -> bool {
        self.cell(cell).contains(point)
    }
    fn neighbors(&self, cell: CellId) -> &[Neighbor<S::Vector>] {
        self.adjacency.of(cell)
    }
    fn locate(&self, point: S::Vector, _: CellId) -> Option<CellId> {
        let mut node = &self.nodes[0];
        if !node.bounds.contains(point) {
            return None;
        }
        while !node.is_leaf() {
            // A point on a dividing plane goes up, so that one cell is found for it, always the same.
            let above = point.get(node.axis as usize) >= node.split;
            node = &self.nodes[node.link as usize + usize::from(above)];
        }
        Some(CellId(node.link))
    }
    fn exit(&self, from: CellId, point: S::Vector) -> Exit {
        let cell = self.cell(from);
        let center = cell.center();
        let way = point - center;
        // When the way passes the plane of the side ahead, on each axis; parts of its whole length.
        let at = |a: usize| match way.get(a) {
            0.0 => f32::INFINITY,
            w if w > 0.0 => (cell.max.get(a) - center.get(a)) / w,
            w => (cell.min.get(a) - center.get(a)) / w,
        };
        let axes = 0..S::Vector::AXES;
        let first = axes.clone().map(at).fold(f32::INFINITY, f32::min);
        if first >= 1.0 {
            return Exit::Ends;
        }
        // A neighbor is entered if it lies at the side passed first and holds the place of passage.
        let leads_into = |next: &Aabb<S::Vector>, a: usize| {
            let faces = if way.get(a) > 0.0 {
                cell.max.get(a) == next.min.get(a)
            } else {
                cell.min.get(a) == next.max.get(a)
            };
            let reaches = |k: usize| {
                (next.min.get(k)..=next.max.get(k)).contains(&(center.get(k) + way.get(k) * first))
            };
            faces && axes.clone().all(|k| k == a || reaches(k))
        };
        // Neighbors ascend by id, so on an edge the lowest wins.
        let through = |n: &&Neighbor<S::Vector>| {
            axes.clone().any(|a| at(a) == first && leads_into(self.cell(n.cell), a))
        };
        self.adjacency.of(from).iter().find(through).map_or(Exit::Out, |n| Exit::Into(n.cell))
    }
    fn meeting(&self, prim: &[S::Vector], _: CellId, _: &mut Tried, to: &mut Vec<CellId>) {
        let bounds = Aabb::of(prim.iter().copied());
        let start = to.len();
        // A stack on the stack: two entries a level are enough.
        let mut open = [0u32; 2 * MAX_LEVEL as usize];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let node = &self.nodes[open[count] as usize];
            if node.is_leaf() {
                to.push(CellId(node.link));
                continue;
            }
            let axis = node.axis as usize;
            // Bounds that touch a plane go to both sides: cells are closed.
            let (below, above) = (bounds.min.get(axis) <= node.split, bounds.max.get(axis) >= node.split);
            for (_, child) in [(above, 1), (below, 0)].into_iter().filter(|(met, _)| *met) {
                open[count] = node.link + child;
                count += 1;
            }
        }
        // Where the bounds meet one box only, so does the primitive. Where they meet several, a slanted one
        // may miss some.
        if to.len() > start + 1 {
            let mut kept = start;
            for at in start..to.len() {
                if S::meets_box(prim, self.cell(to[at])) {
                    to[kept] = to[at];
                    kept += 1;
                }
            }
            to.truncate(kept);
        }
    }
    fn edges(&self, cell: CellId) -> Vec<[S::Vector; 2]> {
        let bounds = self.cell(cell);
        Aabb::<S::Vector>::edges().map(|(i, k)| [bounds.corner(i), bounds.corner(k)]).collect()
    }
    fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node<S::Vector>>() + self.leaves.len() * 4 + self.adjacency.bytes()
    }
}
