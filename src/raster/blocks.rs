//! An image by blocks of pixels, each filled while the first cache holds it.
//!
//! 1. Triangles are looked at for where they go: their pixel boxes, and what is nearest of them
//!    ([`Bins::find`]).
//! 2. Each block gets a list of those whose boxes meet it ([`Bins::deal`]).
//! 3. A block is emptied, or loaded, in memory of its own, where rows lie side by side and not a page apart;
//!    its triangles are filled, nearest first, and it goes out to the image ([`fill_band`]).
//!
//! Nearest first, a triangle all of which lies behind the farthest pixel of the block ends the block: those
//! after it are farther still. Most triangles of a scene that hides much are so never set up, for those of
//! one block are set up when they are filled.

use super::Target;
use super::fill::{Canvas, fill};
use super::frame::{Frame, Taker, Triangle};
use super::setup::Setup;
use super::simd::Lanes;
use super::vertex::Vertex;
use crate::geometry::{PixelRect, PrimId};

/// Rows of a block. Its depths and items take 32 KiB.
pub(super) const ROWS: usize = 32;
/// Columns of a block: long rows, since spans are filled along them.
const COLUMNS: usize = 128;
/// So many pixels more, that a vector may begin at any of the block.
const PAST: usize = 16;

/// A triangle that may cover pixels.
struct Found {
    corners: Corners,
    id: u32,
    /// Depth of its nearest corner.
    nearest: f32,
    /// The first and last blocks that its box meets, across and down.
    across: [u16; 2],
    down: [u16; 2],
}

/// Where the corners of a triangle are kept.
enum Corners {
    /// Among the frame's vertices.
    Shared([u32; 3]),
    /// Three from this one on, among those of the bins.
    Own(u32),
    /// It meets several blocks, and was set up once for all of them: its place among these.
    Ready(u32),
}

impl Found {
    /// Calls with the number of each block that it meets.
    #[inline(always)]
    fn each_block(&self, across: usize, mut to: impl FnMut(usize)) {
        for row in self.down[0]..=self.down[1] {
            for column in self.across[0]..=self.across[1] {
                to(usize::from(row) * across + usize::from(column));
            }
        }
    }
}

/// The triangles of some primitives, and which of them each block needs.
#[derive(Default)]
pub(super) struct Bins {
    found: Vec<Found>,
    own: Vec<Vertex>,
    ready: Vec<Setup>,
    /// How many triangles the bins before hold.
    before: u32,
    /// How many blocks they meet, each counted for itself.
    meetings: usize,
    /// Where the list of each block begins, and the end.
    starts: Vec<u32>,
    /// The lists: the depth turned round, so that the nearest is least, above the triangle's number.
    lists: Vec<u64>,
    /// What may show, and lets light through.
    pub through: Vec<PrimId>,
}

impl Taker for Bins {
    #[inline(always)]
    fn take(&mut self, frame: &Frame, t: Triangle) {
        let Some(rect) = Setup::bounds(t.v, &frame.window) else { return };
        let (bins, nearest) = (self, t.v[0].z.max(t.v[1].z).max(t.v[2].z));
        if !frame.fills(t.id) {
            bins.through.push(PrimId(t.id));
            return;
        }
        let block = |first: u32, past: u32, side: usize| {
            [(first as usize / side) as u16, ((past - 1) as usize / side) as u16]
        };
        let (across, down) = (block(rect.x0, rect.x1, COLUMNS), block(rect.y0, rect.y1, ROWS));
        let is_one = across[0] == across[1] && down[0] == down[1];
        let corners = match t.at {
            Some(at) if is_one => Corners::Shared(at),
            None if is_one => {
                bins.own.extend(t.v);
                Corners::Own(bins.own.len() as u32 - 3)
            }
            _ => {
                bins.ready.extend(Setup::new(t.v, t.id, t.whole, &frame.window));
                Corners::Ready(bins.ready.len() as u32 - 1)
            }
        };
        bins.meetings += usize::from(across[1] - across[0] + 1) * usize::from(down[1] - down[0] + 1);
        bins.found.push(Found { corners, id: t.id, nearest, across, down });
    }
}

impl Bins {
    /// Finds the triangles of some primitives.
    #[inline(always)]
    pub fn find(&mut self, frame: &Frame, prims: &[PrimId]) {
        self.found.clear();
        self.own.clear();
        self.ready.clear();
        self.meetings = 0;
        self.through.clear();
        frame.find(prims, self);
    }
    /// Makes the lists of the blocks of an image.
    #[inline(always)]
    pub fn deal(&mut self, width: usize, height: usize) {
        let across = width.div_ceil(COLUMNS);
        let blocks = across * height.div_ceil(ROWS);
        // Counted, then put in place. Two places further on: what is a block's end while it is filled is the
        // next one's beginning after.
        self.starts.clear();
        self.starts.resize(blocks + 2, 0);
        for found in &self.found {
            found.each_block(across, |block| self.starts[block + 2] += 1);
        }
        for block in 2..blocks + 2 {
            self.starts[block] += self.starts[block - 1];
        }
        self.lists.clear();
        self.lists.resize(self.meetings, 0);
        for (number, found) in self.found.iter().enumerate() {
            let key = u64::from(!found.nearest.to_bits()) << 32 | number as u64;
            found.each_block(across, |block| {
                let at = &mut self.starts[block + 1];
                self.lists[*at as usize] = key;
                *at += 1;
            });
        }
    }
    fn list(&self, block: usize) -> &[u64] {
        &self.lists[self.starts[block] as usize..self.starts[block + 1] as usize]
    }
    /// The part of a triangle in a block that it meets.
    #[inline(always)]
    fn set_up(&self, number: u32, frame: &Frame, block: &PixelRect) -> Option<Setup> {
        let found = &self.found[number as usize];
        let v = match found.corners {
            Corners::Shared([a, b, c]) => {
                [&frame.vertices[a as usize], &frame.vertices[b as usize], &frame.vertices[c as usize]]
            }
            Corners::Own(at) => {
                let own = &self.own[at as usize..at as usize + 3];
                [&own[0], &own[1], &own[2]]
            }
            Corners::Ready(at) => return self.ready[at as usize].within(block),
        };
        // Whether it is a whole primitive matters to its extent alone.
        Setup::new(v, found.id, true, &frame.window)
    }
}

/// Numbers the triangles of all bins. Returns how many blocks they meet.
pub(super) fn number(bins: &mut [Bins]) -> usize {
    let (mut before, mut meetings) = (0, 0);
    for bins in bins {
        bins.before = before;
        before += bins.found.len() as u32;
        meetings += bins.meetings;
    }
    meetings
}

/// Some rows of an image, those of a row of blocks.
pub(super) struct Band<'a> {
    pub depth: &'a mut [f32],
    pub item: &'a mut [u32],
    /// Which of the image's bands it is.
    pub number: usize,
    /// Columns of the image.
    pub width: usize,
    /// The depth of an empty pixel where the image is made anew, whatever it holds; else what it holds stays.
    pub anew: Option<f32>,
}

/// A block of pixels while it is filled, and the triangles that it needs.
pub(super) struct Block {
    depth: Vec<f32>,
    item: Vec<u32>,
    list: Vec<u64>,
}

impl Default for Block {
    fn default() -> Self {
        let pixels = ROWS * COLUMNS + PAST;
        Self { depth: vec![0.0; pixels], item: vec![0; pixels], list: Vec::new() }
    }
}

/// Fills the blocks of a band.
#[inline(always)]
pub(super) fn fill_band<L: Lanes>(l: L, frame: &Frame, bins: &[Bins], block: &mut Block, band: Band) {
    let Band { depth, item, number, width, anew } = band;
    let across = width.div_ceil(COLUMNS);
    let (first_row, rows) = (number * ROWS, depth.len() / width);
    for column in 0..across {
        let x0 = column * COLUMNS;
        let columns = COLUMNS.min(width - x0);
        // Where a row of the block lies in the band, and in the block.
        let out = |row: usize| row * width + x0..row * width + x0 + columns;
        let own = |row: usize| row * COLUMNS..row * COLUMNS + columns;
        block.list.clear();
        for bins in bins {
            let list = bins.list(number * across + column);
            block.list.extend(list.iter().map(|entry| entry + u64::from(bins.before)));
        }
        match anew {
            Some(empty) => {
                block.depth.fill(empty);
                block.item.fill(Target::NONE);
            }
            None if block.list.is_empty() => continue,
            None => {
                for row in 0..rows {
                    block.depth[own(row)].copy_from_slice(&depth[out(row)]);
                    block.item[own(row)].copy_from_slice(&item[out(row)]);
                }
            }
        }
        let at = [x0 as u32, first_row as u32];
        let rect = PixelRect { x0: at[0], x1: at[0] + columns as u32, y0: at[1], y1: at[1] + rows as u32 };
        block.fill(l, frame, bins, &rect);
        for row in 0..rows {
            depth[out(row)].copy_from_slice(&block.depth[own(row)]);
            item[out(row)].copy_from_slice(&block.item[own(row)]);
        }
    }
}

impl Block {
    /// Fills the triangles of the list.
    #[inline(always)]
    fn fill<L: Lanes>(&mut self, l: L, frame: &Frame, bins: &[Bins], rect: &PixelRect) {
        let Self { depth, item, list } = self;
        let (columns, rows) = ((rect.x1 - rect.x0) as usize, (rect.y1 - rect.y0) as usize);
        let first = [rect.x0 as i32, rect.y0 as i32];
        let mut canvas = Canvas { depth, item, first, stride: COLUMNS };
        // Depths are not negative, so their bits are ordered as they are.
        list.sort_unstable();
        let (mut farthest, mut filled) = (0, 0);
        for entry in list {
            // Not where it is as far: there the id decides.
            if !((*entry >> 32) as u32) < farthest {
                break;
            }
            let number = *entry as u32;
            let bins = &bins[bins.partition_point(|bins| bins.before <= number) - 1];
            let Some(setup) = bins.set_up(number - bins.before, frame, rect) else { continue };
            fill(l, &setup, &mut canvas);
            // Looking for the farthest pixel pays once most of the block may have changed.
            filled += (setup.x1 - setup.x0) * (setup.y1 - setup.y0);
            if filled as usize > ROWS * COLUMNS {
                filled = 0;
                farthest = u32::MAX;
                for row in canvas.depth.chunks_exact(COLUMNS).take(rows) {
                    for depth in &row[..columns] {
                        farthest = farthest.min(depth.to_bits());
                    }
                }
            }
        }
    }
}
