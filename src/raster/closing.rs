//! Area closing: small holes of a picture of bits are filled.
//!
//! A *hole* is a connected set of black samples, of those that nothing covers; it is filled if it has at most
//! so many. That is the area closing of Vincent ("Morphological Area Openings and Closings for Grey-scale
//! Images", in Shape in Picture, 1994, <https://doi.org/10.1007/978-3-662-03039-4_13>) of a binary image.
//!
//! Samples that touch at a corner belong to one hole (8-connected): what covers is then 4-connected, as the
//! two must differ for holes to be what coverings surround. With 4-connected holes a slit that runs askew,
//! one sample wide, would fall into single samples and be filled whatever its length.
//!
//! 1. Rows are cut into runs of black samples, and runs of neighboring rows that touch are joined
//!    (union-find).
//! 2. The runs of sets that are small enough are filled.
//!
//! Cost: O(tiles + runs), and nothing where no sample is black.

use crate::geometry::Sets;

/// Samples of a row `from..to`, all black.
struct Run {
    row: u32,
    from: u32,
    to: u32,
}

/// For each tile of 8×4 samples of an image, row by row, the black ones in holes of at most `most`: bit
/// `8 y + x`. `covered`: the samples of a tile that something covers, by column and row.
pub(super) fn small_holes(
    [width, height]: [u32; 2],
    most: u32,
    covered: impl Fn(u16, u16) -> u32,
) -> Vec<u32> {
    let (columns, rows) = (width.div_ceil(8), height.div_ceil(4));
    let mut filled = vec![0; (columns * rows) as usize];
    let (runs, firsts) = runs([width, height], covered);
    let mut joined = Sets::new(runs.len());
    for row in 1..height as usize {
        let (above, here) = (firsts[row - 1]..firsts[row], firsts[row]..firsts[row + 1]);
        join(&runs, above, here, &mut joined);
    }
    let mut sizes = vec![0u64; runs.len()];
    for (k, run) in runs.iter().enumerate() {
        sizes[joined.root(k as u32) as usize] += u64::from(run.to - run.from);
    }
    for (k, run) in runs.iter().enumerate() {
        if sizes[joined.root(k as u32) as usize] > u64::from(most) {
            continue;
        }
        // A tile at a time.
        let mut x = run.from;
        while x < run.to {
            let past = run.to.min((x / 8 + 1) * 8);
            let bits = (0xff >> (8 - (past - x))) << (x % 8);
            filled[(run.row / 4 * columns + x / 8) as usize] |= bits << (8 * (run.row % 4));
            x = past;
        }
    }
    filled
}

/// 1. The runs, by rows and from the left, and where those of each row begin.
fn runs([width, height]: [u32; 2], covered: impl Fn(u16, u16) -> u32) -> (Vec<Run>, Vec<usize>) {
    let (mut all, mut firsts) = (Vec::new(), vec![0]);
    for tile_row in 0..height.div_ceil(4) {
        let masks: Vec<u32> = (0..width.div_ceil(8))
            .map(|x| !covered(x as u16, tile_row as u16) & present_of_tile([width, height], [x, tile_row]))
            .collect();
        for row in 4 * tile_row..(4 * tile_row + 4).min(height) {
            for (x, mask) in masks.iter().enumerate() {
                let mut bits = mask >> (8 * (row % 4)) & 0xff;
                while bits != 0 {
                    let (low, length) =
                        (bits.trailing_zeros(), (bits >> bits.trailing_zeros()).trailing_ones());
                    bits &= !(((1 << length) - 1) << low);
                    let from = 8 * x as u32 + low;
                    // A run goes on from tile to tile.
                    match all.last_mut() {
                        Some(Run { row: same, to, .. }) if *same == row && *to == from => *to += length,
                        _ => all.push(Run { row, from, to: from + length }),
                    }
                }
            }
            firsts.push(all.len());
        }
    }
    (all, firsts)
}

/// Joins the runs of two neighboring rows that touch, if only at a corner.
fn join(runs: &[Run], above: std::ops::Range<usize>, here: std::ops::Range<usize>, joined: &mut Sets) {
    let mut first = above.start;
    for k in here {
        // Runs do not overlap, so what ends before this one begins touches none that follows.
        while first < above.end && runs[first].to < runs[k].from {
            first += 1;
        }
        for other in (first..above.end).take_while(|&o| runs[o].from <= runs[k].to) {
            joined.join(k as u32, other as u32);
        }
    }
}

/// The bits of a tile's samples that lie in the image.
pub(super) fn present_of_tile([width, height]: [u32; 2], [x, y]: [u32; 2]) -> u32 {
    let (columns, rows) = ((width - 8 * x).min(8), (height - 4 * y).min(4));
    let row = 0xff >> (8 - columns);
    (0..rows).fold(0, |bits, k| bits | row << (8 * k))
}
