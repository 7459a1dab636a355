//! What a frame costs: below which cells it pays to look for cubes.
//!
//! Drawing a cell as geometry costs its primitives. Looking below it costs visits, a cube for each cell that
//! is small enough, and all the same each primitive of which some leaf is too large. So for each cell the
//! deepest level is found at which its cells must be small enough for the visit to be the cheaper way; a
//! frame asks whether they are, which is one comparison. (The paper refines until cells are small, and so
//! takes up to
//! 2.5 times as long as for geometry alone: Table 2.) Cost: O(references · levels), once.

use crate::geometry::{NodeId, PrimId, Space, Vector};
use crate::index::CellTree;
use crate::scene::Scene;

/// What a visit, a cube and a reference that is read cost, and a primitive drawn by itself, in primitives
/// drawn with all others: times of `generate:tree` and of `generate:molecule`.
const VISIT: f32 = 1.0;
const CUBE: f32 = 4.0;
const REFERENCE: f32 = 0.1;
const ALONE: f32 = 1.5;

/// Levels at most.
const LEVELS: usize = CellTree::<glam::Vec3>::MOST_LEVELS as usize + 1;

/// Costs below a cell by the level from which on its cells are drawn as cubes.
#[derive(Clone, Copy)]
struct Costs {
    /// Visits, cubes and references read.
    extra: [f32; LEVELS],
    /// Primitives drawn all the same: each counts in all its leaves together once.
    drawn: [f32; LEVELS],
}

/// Of each node the deepest level from which on its cells must be drawn as cubes, for it to be no loss to
/// look below it; its own level if it always is one.
pub fn pays<S: Space>(tree: &CellTree<S::Vector>, scene: &Scene<S>) -> Vec<u8> {
    let pays = tree.nodes().iter().map(|node| node.level).collect();
    let mut weighing = Weighing { tree, leaves: leaves(tree, scene.prim_count()), pays };
    weighing.weigh(0);
    weighing.pays
}

/// Nodes whose costs are being added up.
struct Weighing<'a, V> {
    tree: &'a CellTree<V>,
    /// Of each item the level of the highest leaf that holds it, and how many do.
    leaves: Vec<(u8, u32)>,
    pays: Vec<u8>,
}

impl<V: Vector> Weighing<'_, V> {
    /// Costs at and below a node.
    fn weigh(&mut self, at: usize) -> Costs {
        let tree = self.tree;
        let node = &tree.nodes()[at];
        let level = usize::from(node.level);
        let mut costs = Costs { extra: [VISIT; LEVELS], drawn: [0.0; LEVELS] };
        costs.extra[..=level].fill(VISIT + CUBE);
        if node.is_leaf() {
            let items = tree.references(NodeId(at as u32));
            costs.extra[level + 1..].iter_mut().for_each(|c| *c += REFERENCE * items.len() as f32);
            for &item in items {
                let (highest, count) = self.leaves[item.at()];
                let prims = tree.items().prims(item).len() as f32;
                // Where cells of a level are cubes, it is drawn if some leaf of it is higher.
                costs.drawn[usize::from(highest) + 1] += prims / count as f32;
            }
            (1..LEVELS).for_each(|l| costs.drawn[l] += costs.drawn[l - 1]);
            return costs;
        }
        for child in node.children() {
            let child = self.weigh(child as usize);
            (0..LEVELS).for_each(|l| costs.drawn[l] += child.drawn[l]);
            (level + 1..LEVELS).for_each(|l| costs.extra[l] += child.extra[l]);
        }
        let is_no_loss = |l: &usize| costs.extra[*l] + ALONE * costs.drawn[*l] <= costs.drawn[LEVELS - 1];
        let levels = level + 1..=usize::from(node.lowest);
        self.pays[at] = levels.rev().find(is_no_loss).unwrap_or(level) as u8;
        costs
    }
}

/// Of each item, by its first primitive, the level of the highest leaf that holds it, and how many do.
fn leaves<V: Vector>(tree: &CellTree<V>, prims: usize) -> Vec<(u8, u32)> {
    let mut leaves = vec![(LEVELS as u8 - 2, 0); prims];
    for (at, node) in tree.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        for PrimId(prim) in tree.references(NodeId(at as u32)) {
            let (highest, count) = &mut leaves[*prim as usize];
            *highest = node.level.min(*highest);
            *count += 1;
        }
    }
    leaves
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::culling::color_cubes::index::is_small;
    use crate::culling::color_cubes::space::Projected;
    use crate::geometry::{Flat, Solid};
    use crate::index::Items;
    use crate::scene::samples;

    /// What a visit below a node costs where the cells of a level are drawn as cubes, walked out; the
    /// primitives that are drawn go to a set.
    fn walked<V: Vector>(tree: &CellTree<V>, at: u32, cubes: u8, drawn: &mut BTreeSet<PrimId>) -> f32 {
        let node = &tree.nodes()[at as usize];
        if node.level >= cubes {
            return VISIT + CUBE;
        }
        if node.is_leaf() {
            let items = tree.references(NodeId(at));
            drawn.extend(items);
            return VISIT + REFERENCE * items.len() as f32;
        }
        VISIT + node.children().map(|child| walked(tree, child, cubes, drawn)).sum::<f32>()
    }

    /// Of the whole scene the deepest level at which the walk costs no more than all primitives.
    fn is_as_walked<S: Projected>() {
        let mut found = BTreeSet::new();
        for (seed, prims) in [(1, 40), (2, 400), (3, 4000), (4, 20_000)] {
            let scene = samples::soup::<S>(seed, prims);
            let tree = CellTree::build(&scene, Items::default(), 20, &is_small::<S>, &|| false);
            let tree = tree.expect("not cancelled");
            let lowest = tree.nodes()[0].lowest;
            let cost = |cubes: u8| {
                let mut drawn = BTreeSet::new();
                walked(&tree, 0, cubes, &mut drawn) + ALONE * drawn.len() as f32
            };
            let live = scene.live().len() as f32;
            // Sums of shares are rounded.
            let want = (1..=lowest).rev().find(|l| cost(*l) <= live * 1.0001).unwrap_or(0);
            let got = pays(&tree, &scene)[0];
            assert_eq!(got, want, "{prims}: {:?}", (1..=lowest).map(cost).collect::<Vec<_>>());
            found.insert(got);
        }
        assert!(found.len() > 1, "{found:?}");
    }

    #[test]
    fn looking_pays_where_a_walk_costs_less() {
        is_as_walked::<Flat>();
        is_as_walked::<Solid>();
    }
}
