//! The order in which points are inserted: random rounds, along a space-filling curve within each.
//!
//! 1. Amenta, Choi and Rote, "Incremental Constructions con BRIO", SoCG 2003: each point belongs to the last
//!    round with probability 3/4, else to the one before with 3/4, and so on. Such a biased randomized order
//!    keeps the expected cost of random insertion, and within a round the points may come in any order.
//! 2. Within a round they come along a Hilbert curve (Skilling, "Programming the Hilbert Curve", 2004): each
//!    is found a few tetrahedra away from the last.
//!
//! Departure: the paper halves from round to round; four points to one make half as many rounds, each of
//! which crosses all of space once. Cost: O(n log n).

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// Bits of each coordinate along the curve; three of them and the round fit 64 bits.
const BITS: u32 = 20;
/// Points that the first round holds at least, on average: few enough that long walks among them cost little.
const FIRST_ROUND: u32 = 64;
/// The last round at most: 3 · 20 bits of the curve and 4 of the round fill the key.
const MOST_ROUNDS: u32 = 15;

/// The numbers of the points in the order of insertion. The same points give the same order.
pub fn insertion_order(points: &[DVec3]) -> Vec<u32> {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    // One scale for all axes: cells of the grid are cubes, as the curve wants them.
    let scale = f64::from((1 << BITS) - 1) / (high - low).max_element().max(f64::MIN_POSITIVE);
    // Each round has four times the points of the one before.
    let last = ((points.len() as u32 / FIRST_ROUND).max(1).ilog2() / 2).min(MOST_ROUNDS);
    let mut rng = Pcg32::new(1, 3);
    let mut keys: Vec<(u64, u32)> = Vec::with_capacity(points.len());
    for (number, point) in points.iter().enumerate() {
        // 1. Pairs of leading zeros come with probability 1/4 each.
        let round = last - (rng.next_u32().leading_zeros() / 2).min(last);
        // 2. The round above the place on the curve: one sort does both.
        let cell = ((*point - low) * scale).to_array().map(|v| v as u32);
        keys.push((u64::from(round) << (3 * BITS) | along_hilbert(cell), number as u32));
    }
    keys.sort_unstable();
    keys.into_iter().map(|(_, number)| number).collect()
}

/// The place of a cell of the grid on the Hilbert curve through all of them.
fn along_hilbert(mut cell: [u32; 3]) -> u64 {
    // Skilling's transform: undo the rotations and reflections of the curve's pieces, from the largest ones
    // down.
    for bit in (1..BITS).rev() {
        let (half, below) = (1 << bit, (1 << bit) - 1);
        for axis in 0..3 {
            if cell[axis] & half != 0 {
                cell[0] ^= below;
            } else {
                let exchanged = (cell[0] ^ cell[axis]) & below;
                cell[0] ^= exchanged;
                cell[axis] ^= exchanged;
            }
        }
    }
    // The steps of a Hilbert curve follow a Gray code.
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let flips = (1..BITS)
        .rev()
        .filter(|bit| cell[2] >> bit & 1 == 1)
        .fold(0, |flips, bit| flips ^ ((1u32 << bit) - 1));
    // The bits of the axes take turns, the highest first.
    let [x, y, z] = cell.map(|v| spread(v ^ flips));
    x << 2 | y << 1 | z
}

/// Moves bit `i` of a number to bit `3 i`.
fn spread(v: u32) -> u64 {
    const STEPS: [(u32, u64); 5] = [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ];
    STEPS.iter().fold(u64::from(v), |v, (shift, mask)| (v | v << shift) & mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_on_the_curve_are_neighbors_in_space() {
        // The 8³ cells of the finest level at the origin: consecutive places are cells that share a face.
        let cells = (0..512u32).map(|i| [i & 7, i >> 3 & 7, i >> 6]);
        let mut places: Vec<_> = cells.map(|cell| (along_hilbert(cell), cell)).collect();
        places.sort_unstable();
        for pair in places.windows(2) {
            let step: u32 = (0..3).map(|a| pair[0].1[a].abs_diff(pair[1].1[a])).sum();
            assert_eq!((step, pair[1].0 - pair[0].0), (1, 1), "{pair:?}");
        }
    }

    #[test]
    fn every_point_comes_once_and_early_rounds_are_small() {
        let points: Vec<_> =
            (0..5000).map(|i| DVec3::new(f64::from(i % 17), f64::from(i % 31), f64::from(i))).collect();
        let mut order = insertion_order(&points);
        let spread = |part: &[u32]| part.iter().max().expect("some") - part.iter().min().expect("some");
        assert!(spread(&order[..100]) > 4000, "the first round is a sample of all");
        order.sort_unstable();
        assert!(order.into_iter().eq(0..5000));
    }
}
