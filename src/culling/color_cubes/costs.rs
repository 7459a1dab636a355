//! What a frame costs: below which cells it pays to look for cubes.
//!
//! Drawing a cell as geometry costs its primitives. Looking below it costs visits, a cube for each cell that
//! is small enough, and all the same each primitive of which some leaf is too large. So for each cell the
//! deepest level is found at which its cells must be small enough for the visit to be the cheaper way; a
//! frame asks whether they are, which is one comparison. (The paper refines until cells are small, and so
//! takes up to 2.5 times as long as for geometry alone: Table 2.)
//!
//! A cell whose cube is too wrong for its size is drawn as its cube from farther away only, as a larger one
//! would be. Cost: O(references · levels), once.

use crate::geometry::{NodeId, PrimId, Space, Vector};
use crate::index::{CellNode, CellTree};
use crate::scene::Scene;

/// What a visit, a cube and a reference that is read cost, and a primitive drawn by itself, in primitives
/// drawn with all others: times of `generate:tree` and of `generate:molecule`.
const VISIT: f32 = 0.8;
const CUBE: f32 = 2.0;
const REFERENCE: f32 = 0.15;
const ALONE: f32 = 1.1;

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

/// Of each node the deepest level whose cells must be no larger than the threshold, for it to be no loss to
/// look below it; 0 if it always is one. `excess`: of each node the error of its cube in shares of what is
/// allowed at the threshold; none if all are allowed.
pub fn pays<S: Space>(tree: &CellTree<S::Vector>, scene: &Scene<S>, excess: &[f32]) -> Vec<u8> {
    let nodes = tree.nodes();
    let counts = |(at, node): (usize, &CellNode)| match excess.get(at) {
        // It is as wrong as is allowed where its sides are so many times shorter.
        Some(excess) => level_above(node.level, excess.sqrt()),
        None => node.level,
    };
    let counts: Vec<u8> = nodes.iter().enumerate().map(counts).collect();
    let leaves = leaves(tree, scene.prim_count(), &counts);
    let mut weighing = Weighing { tree, leaves, counts, pays: vec![0; nodes.len()] };
    weighing.weigh(0);
    weighing.pays
}

/// The lowest level above one whose cells are so many times as large; 0 if there is none.
fn level_above(level: u8, times: f32) -> u8 {
    level.saturating_sub(times.max(1.0).log2().ceil() as u8)
}

/// Nodes whose costs are being added up.
struct Weighing<'a, V> {
    tree: &'a CellTree<V>,
    /// Of each item the level of the highest leaf that holds it, and how many do.
    leaves: Vec<(u8, u32)>,
    /// Of each node: it is drawn as its cube where cells of this level would be.
    counts: Vec<u8>,
    pays: Vec<u8>,
}

impl<V: Vector> Weighing<'_, V> {
    /// Costs at and below a node.
    fn weigh(&mut self, at: usize) -> Costs {
        let tree = self.tree;
        let node = &tree.nodes()[at];
        let level = usize::from(self.counts[at]);
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
        self.pays[at] = levels.rev().find(is_no_loss).unwrap_or(0) as u8;
        costs
    }
}

/// Of each item, by its first primitive, the level of the highest leaf that holds it, and how many do. A leaf
/// is as low as the lowest cell about it that can be drawn as its cube.
fn leaves<V: Vector>(tree: &CellTree<V>, prims: usize, counts: &[u8]) -> Vec<(u8, u32)> {
    let mut leaves = vec![(LEVELS as u8 - 2, 0); prims];
    let mut lowest = counts.to_vec();
    for (at, node) in tree.nodes().iter().enumerate() {
        let here = lowest[at];
        if !node.is_leaf() {
            node.children().for_each(|child| lowest[child as usize] = lowest[child as usize].max(here));
            continue;
        }
        for PrimId(prim) in tree.references(NodeId(at as u32)) {
            let (highest, count) = &mut leaves[*prim as usize];
            *highest = here.min(*highest);
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
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, Solid};
    use crate::index::Items;
    use crate::scene::samples;

    /// What a visit below a node costs where cells of a level are as large as the threshold, walked out; the
    /// primitives that are drawn go to a set.
    fn walked<V: Vector>(
        (tree, excess): (&CellTree<V>, &[f32]),
        at: u32,
        level: u8,
        drawn: &mut BTreeSet<PrimId>,
    ) -> f32 {
        let node = &tree.nodes()[at as usize];
        // In sizes of the threshold.
        let size = 2f32.powi(i32::from(level) - i32::from(node.level));
        if size <= 1.0 && excess.get(at as usize).is_none_or(|excess| excess * size * size <= 1.0) {
            return VISIT + CUBE;
        }
        if node.is_leaf() {
            let items = tree.references(NodeId(at));
            drawn.extend(items);
            return VISIT + REFERENCE * items.len() as f32;
        }
        VISIT + node.children().map(|child| walked((tree, excess), child, level, drawn)).sum::<f32>()
    }

    /// Of the whole scene the deepest level at which the walk costs no more than all primitives; with cubes
    /// that are so many times too wrong at most.
    fn is_as_walked<S: Projected>(most: f32) {
        let mut found = BTreeSet::new();
        for (seed, prims) in [(1, 40), (2, 400), (3, 4000), (4, 20_000)] {
            let scene = samples::soup::<S>(seed, prims);
            let tree = CellTree::build(&scene, Items::default(), 20, &is_small::<S>(1.0), &|| false);
            let tree = tree.expect("not cancelled");
            let mut dice = Dice::new(seed);
            let wrong = if most > 0.0 { tree.nodes().len() } else { 0 };
            let excess: Vec<f32> = (0..wrong).map(|_| dice.between(0.0, most)).collect();
            let lowest = tree.nodes()[0].lowest;
            let cost = |level: u8| {
                let mut drawn = BTreeSet::new();
                walked((&tree, &excess), 0, level, &mut drawn) + ALONE * drawn.len() as f32
            };
            let live = scene.live().len() as f32;
            // Sums of shares are rounded.
            let want = (1..=lowest).rev().find(|l| cost(*l) <= live * 1.0001).unwrap_or(0);
            let got = pays(&tree, &scene, &excess)[0];
            assert_eq!(got, want, "{prims}: {:?}", (1..=lowest).map(cost).collect::<Vec<_>>());
            found.insert(got);
        }
        assert!(found.len() > 1, "{found:?}");
    }

    #[test]
    fn looking_pays_where_a_walk_costs_less() {
        for most in [0.0, 2.0, 20.0] {
            is_as_walked::<Flat>(most);
            is_as_walked::<Solid>(most);
        }
    }
}
