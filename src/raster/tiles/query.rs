//! Clusters and boxes asked: blocks first, then tiles, then what tiles do not decide.
//!
//! A box is hidden where it is behind all that is drawn. In the order of cost:
//!
//! 1. its nearest depth against the farthest of each block of 32×16 pixels, many blocks at a time;
//! 2. where it begins in those blocks ([`super::look`]) against the same; and whether it surely shows in one:
//!    it covers the block and begins before all that is drawn there;
//! 3. the same for tiles;
//! 4. of the tiles that are left, pixels that nothing covers; then a plane that nothing in the tile is
//!    farther than, and exact depths, each worked out when it is first asked for (`resolve`).

use super::clusters::{Boxes, Cluster, Clusters};
use super::look::{Asked, BLOCK, Look, Span, TILE};
use super::resolve::{cover, resolve};
use super::setup::Draw;
use super::wide::{self, Wide, Work};
use super::{Resolved, Tiles};
use crate::raster::simd::Isa;

/// What is said of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Something of it may be seen.
    Visible,
    /// Nothing drawn leaves a pixel for it.
    Hidden,
    /// It lies beside the view, or between pixel centers.
    Outside,
}

/// See [`Tiles::draw`].
pub(super) fn draw(tiles: &mut Tiles, clusters: &Clusters, one_sided: bool, isa: Isa) {
    wide::run(isa, DrawAll { tiles, clusters, one_sided });
}
/// See [`Tiles::hides_all`].
pub(super) fn hides_all(tiles: &mut Tiles, boxes: &Boxes, exact: bool, isa: Isa, answers: &mut Vec<Answer>) {
    wide::run(isa, AskAll { tiles, boxes, exact, answers });
}

impl Tiles {
    fn look(&self) -> Look {
        Look::new(&self.camera, f64::from(self.width), f64::from(self.height))
    }
}

/// All clusters, front to back.
struct DrawAll<'a> {
    tiles: &'a mut Tiles,
    clusters: &'a Clusters,
    one_sided: bool,
}

impl Work for DrawAll<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, clusters, one_sided } = self;
        tiles.forget();
        let look = tiles.look();
        let (mut seen, mut asked) = (Vec::new(), Vec::new());
        look.in_view(l, &clusters.boxes, &mut seen);
        front_to_back(&look, &clusters.boxes, &mut seen);
        look.project(l, &clusters.boxes, &seen, &mut asked);
        for a in &asked {
            let bounds = clusters.boxes.at(a.id as usize);
            if a.crosses_near || !l.apart(HiddenSoFar { tiles, look: &look, asked: a, bounds }) {
                let cluster = &clusters.clusters[a.id as usize];
                l.apart(DrawCluster { tiles, clusters, one_sided, cluster });
            }
        }
        Draw { l, tiles, clusters, one_sided }.flush();
    }
}

/// Orders boxes by their distance from the eye, equally far ones by number.
fn front_to_back(look: &Look, boxes: &Boxes, ids: &mut [i32]) {
    ids.sort_by_cached_key(|&i| {
        let [low, high] = boxes.at(i as usize);
        let off = |a: usize| (low[a] - look.eye[a]).max(look.eye[a] - high[a]).max(0.0);
        let square = off(0) * off(0) + off(1) * off(1) + off(2) * off(2);
        // Bits of floats that are not negative are ordered as they are.
        (square.to_bits(), i)
    });
}

/// One cluster, in a function of its own.
struct DrawCluster<'a> {
    tiles: &'a mut Tiles,
    clusters: &'a Clusters,
    one_sided: bool,
    cluster: &'a Cluster,
}

impl Work for DrawCluster<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, clusters, one_sided, cluster } = self;
        Draw { l, tiles, clusters, one_sided }.cluster(cluster);
    }
}

/// Many boxes.
struct AskAll<'a> {
    tiles: &'a mut Tiles,
    boxes: &'a Boxes,
    exact: bool,
    answers: &'a mut Vec<Answer>,
}

impl Work for AskAll<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, boxes, exact, answers } = self;
        answers.clear();
        answers.resize(boxes.len(), Answer::Outside);
        finish(l, tiles);
        let look = tiles.look();
        let (mut seen, mut asked, mut open) = (Vec::new(), Vec::new(), Vec::new());
        look.in_view(l, boxes, &mut seen);
        look.project(l, boxes, &seen, &mut asked);
        for a in &asked {
            answers[a.id as usize] = if a.crosses_near {
                Answer::Visible
            } else if a.is_empty() {
                Answer::Outside
            } else if behind_blocks(l, tiles, a) {
                Answer::Hidden
            } else {
                let bounds = boxes.at(a.id as usize);
                let fine = Fine { tiles, look: &look, asked: a, bounds, exact, open: &mut open };
                if l.apart(fine) { Answer::Hidden } else { Answer::Visible }
            };
        }
    }
}

/// The farthest depth of every block, for many queries: while drawing only some are brought up to date.
#[inline(always)]
fn finish<L: Wide>(l: L, tiles: &mut Tiles) {
    for strip in 0..tiles.strips {
        for row in 0..tiles.block_rows {
            refresh(l, tiles, strip, row);
        }
    }
}
/// Brings the farthest depth of a block up to date.
#[inline(always)]
fn refresh<L: Wide>(l: L, tiles: &mut Tiles, strip: usize, row: usize) {
    let at = row * tiles.stride() + strip;
    tiles.block_far[at] = farthest(l, tiles, strip, row);
}
#[inline(always)]
fn farthest<L: Wide>(l: L, tiles: &Tiles, strip: usize, row: usize) -> f32 {
    let first = tiles.first_line(strip, row);
    let lines = &tiles.lines[first..first + 4];
    let mut far = l.load_farthest(lines);
    if L::N == 8 {
        far = l.min(far, l.load_farthest(&lines[2..]));
    }
    l.least(far)
}

/// 1. Whether the nearest depth is behind all blocks of the rectangle.
#[inline(always)]
fn behind_blocks<L: Wide>(l: L, tiles: &Tiles, a: &Asked) -> bool {
    let [left, right, top, bottom] = a.blocks();
    for row in top..bottom {
        for begin in (left..right).step_by(L::N) {
            if l.bits(reached(l, tiles, a, begin, row, right)) != 0 {
                return false;
            }
        }
    }
    true
}
/// Of the blocks of a row from one on, up to another, those that the nearest depth is not behind.
#[inline(always)]
fn reached<L: Wide>(l: L, tiles: &Tiles, a: &Asked, begin: usize, row: usize, past: usize) -> L::M {
    let far = l.load(&tiles.block_far[row * tiles.stride() + begin..]);
    l.both(l.first(past - begin), l.ge(l.splat(a.nearest), far))
}
/// 2. Of those the ones where the box may be, and is not behind all.
#[inline(always)]
fn open_blocks<L: Wide>(l: L, tiles: &Tiles, span: &Span, begin: usize, row: usize, reached: L::M) -> u32 {
    if l.bits(reached) == 0 {
        return 0;
    }
    let far = l.load(&tiles.block_far[row * tiles.stride() + begin..]);
    let (x, y) = row_of_blocks(l, begin, row);
    let (begins, ends) = span.outer(l, x, y, BLOCK);
    l.bits(l.both(reached, l.both(l.ge(begins, ends), l.ge(begins, far))))
}
/// Whether the box covers one of the blocks of a row and begins before all that is drawn in it.
#[inline(always)]
fn surely<L: Wide>(l: L, tiles: &Tiles, span: &Span, begin: usize, row: usize, past: usize) -> bool {
    let (x, y) = row_of_blocks(l, begin, row);
    let (begins, ends) = span.inner(l, x, y, BLOCK);
    let near = l.load(&tiles.block_near[row * tiles.stride() + begin..]);
    l.bits(l.both(l.first(past - begin), l.both(l.ge(begins, ends), l.ge(begins, near)))) != 0
}
/// Centers of the blocks from one on, along a row.
#[inline(always)]
fn row_of_blocks<L: Wide>(l: L, begin: usize, row: usize) -> (L::F, L::F) {
    let x = l.add(l.mul(l.lanes(), l.splat(32.0)), l.splat((32 * begin + 16) as f32));
    (x, l.splat((16 * row + 8) as f32))
}

/// Centers of the tiles of a block, a vector of them.
#[inline(always)]
fn tiles_of_block<L: Wide>(l: L, strip: usize, row: usize, part: usize) -> (L::F, L::F) {
    let (column, line) = l.tiles();
    (
        l.add(l.mul(column, l.splat(8.0)), l.splat((32 * strip + 4) as f32)),
        l.add(l.mul(line, l.splat(4.0)), l.splat((16 * row + part * L::N + 2) as f32)),
    )
}
/// 3. The tiles of a block that do not hide a box.
#[inline(always)]
fn open_tiles<L: Wide>(l: L, tiles: &Tiles, span: &Span, a: &Asked, strip: usize, row: usize) -> u32 {
    let mut open = 0;
    for part in 0..16 / L::N {
        let first = tiles.first_line(strip, row) + part * (L::N / 4);
        let far = l.load_farthest(&tiles.lines[first..]);
        let (x, y) = tiles_of_block(l, strip, row, part);
        let (begins, ends) = span.outer(l, x, y, TILE);
        open |= l.bits(l.both(l.ge(begins, ends), l.ge(begins, far))) << (part * L::N);
    }
    open & a.tiles(strip, row)
}
/// Those that surely show a box: it covers all of the tile, and something in the tile is not covered, or
/// nothing in the block is nearer.
#[inline(always)]
fn sure_tiles<L: Wide>(l: L, tiles: &Tiles, span: &Span, strip: usize, row: usize) -> u32 {
    let before = l.splat(tiles.block_near[row * tiles.stride() + strip]);
    let mut sure = 0;
    for part in 0..16 / L::N {
        let first = tiles.first_line(strip, row) + part * (L::N / 4);
        let ever = l.load_ever(&tiles.lines[first..]);
        let (x, y) = tiles_of_block(l, strip, row, part);
        let (begins, ends) = span.inner(l, x, y, TILE);
        let may_be_hidden = l.without(l.eq_i(ever, l.splat_i(-1)), l.ge(begins, before));
        sure |= l.bits(l.without(l.ge(begins, ends), may_be_hidden)) << (part * L::N);
    }
    sure
}

/// Whether a cluster is hidden by what is drawn so far, from tiles alone.
struct HiddenSoFar<'a> {
    tiles: &'a mut Tiles,
    look: &'a Look,
    asked: &'a Asked,
    bounds: [[f32; 3]; 2],
}

impl Work for HiddenSoFar<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Wide>(self, l: L) -> bool {
        let Self { tiles, look, asked: a, bounds } = self;
        if a.is_empty() {
            return true;
        }
        let span = Span::new(look, &tiles.camera.eye, bounds, a.nearest);
        let [left, right, top, bottom] = a.blocks();
        for row in top..bottom {
            for begin in (left..right).step_by(L::N) {
                let may = reached(l, tiles, a, begin, row, right);
                let mut bits = open_blocks(l, tiles, &span, begin, row, may);
                while bits != 0 {
                    let strip = begin + bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    if open_tiles(l, tiles, &span, a, strip, row) != 0 {
                        return false;
                    }
                    // What was drawn since is known now.
                    refresh(l, tiles, strip, row);
                }
            }
        }
        true
    }
}

/// Whether a box is hidden that the blocks of its rectangle did not hide by its nearest depth.
struct Fine<'a> {
    tiles: &'a mut Tiles,
    look: &'a Look,
    asked: &'a Asked,
    bounds: [[f32; 3]; 2],
    exact: bool,
    /// Scratch: blocks with the tiles that did not decide.
    open: &'a mut Vec<(usize, u32)>,
}

impl Work for Fine<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Wide>(self, l: L) -> bool {
        let Self { tiles, look, asked: a, bounds, exact, open } = self;
        let span = Span::new(look, &tiles.camera.eye, bounds, a.nearest);
        let [left, right, top, bottom] = a.blocks();
        // What shows mostly shows in the middle.
        let middle = ((left + right) / 2).saturating_sub(8).max(left);
        if exact && surely(l, tiles, &span, middle, (top + bottom) / 2, right) {
            return false;
        }
        open.clear();
        for row in top..bottom {
            for begin in (left..right).step_by(L::N) {
                let may = reached(l, tiles, a, begin, row, right);
                let mut bits = open_blocks(l, tiles, &span, begin, row, may);
                if bits != 0 && exact && surely(l, tiles, &span, begin, row, right) {
                    return false;
                }
                while bits != 0 {
                    let strip = begin + bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let found = open_tiles(l, tiles, &span, a, strip, row);
                    if found == 0 {
                        continue;
                    }
                    if !exact || found & sure_tiles(l, tiles, &span, strip, row) != 0 {
                        return false;
                    }
                    open.push((row * tiles.strips + strip, found));
                }
            }
        }
        // 4. First the pixels that nothing covers, then exact depths.
        for &(block, found) in open.iter() {
            if shows_bare(l, tiles, &span, block, found) {
                return false;
            }
        }
        for &(block, found) in open.iter() {
            if shows(l, tiles, &span, block, found) {
                return false;
            }
        }
        true
    }
}

/// The first pixel of a tile of a block.
#[inline(always)]
fn first_pixel(tiles: &Tiles, block: usize, tile: usize) -> [i32; 2] {
    let (row, strip) = (block / tiles.strips, block % tiles.strips);
    [(32 * strip + 8 * (tile & 3)) as i32, (16 * row + 4 * (tile >> 2)) as i32]
}
/// The pixels of a tile that lie in the image.
#[inline(always)]
fn in_image(tiles: &Tiles, [x, y]: [i32; 2]) -> u32 {
    let (columns, rows) = ((tiles.width - x).clamp(0, 8), (tiles.height - y).clamp(0, 4));
    let across = (1u32 << columns) - 1;
    ((u64::from(across * 0x0101_0101)) & ((1u64 << (8 * rows)) - 1)) as u32
}
/// Whether a box may show at a pixel of these tiles that nothing covers.
#[inline(always)]
fn shows_bare<L: Wide>(l: L, tiles: &Tiles, span: &Span, block: usize, mut found: u32) -> bool {
    let (row, strip) = (block / tiles.strips, block % tiles.strips);
    while found != 0 {
        let tile = found.trailing_zeros() as usize;
        found &= found - 1;
        let at = first_pixel(tiles, block, tile);
        let line = &tiles.lines[tiles.first_line(strip, row) + (tile >> 2)];
        let bare = !line.ever[tile & 3] & in_image(tiles, at);
        if bare != 0 && span.pixels(l, at, None) & bare != 0 {
            return true;
        }
    }
    false
}
/// Whether a box may show at a pixel of these tiles, by exact depths where nothing less decides.
#[inline(always)]
fn shows<L: Wide>(l: L, tiles: &mut Tiles, span: &Span, block: usize, mut found: u32) -> bool {
    while found != 0 {
        let tile = found.trailing_zeros() as usize;
        found &= found - 1;
        let pixel = first_pixel(tiles, block, tile);
        let known = tiles.resolved.at[block][tile];
        let at = if known == Resolved::NOT { cover(tiles, block, tile) } else { known as usize };
        if span.is_below(&tiles.resolved.floors[at].0, pixel) {
            continue;
        }
        if tiles.resolved.floors[at].1 == Resolved::NOT {
            resolve(l, tiles, block, tile);
            refresh(l, tiles, block % tiles.strips, block / tiles.strips);
            if span.is_below(&tiles.resolved.floors[at].0, pixel) {
                continue;
            }
        }
        let depths = &tiles.resolved.depths[tiles.resolved.floors[at].1 as usize];
        if span.pixels(l, pixel, Some(depths)) & in_image(tiles, pixel) != 0 {
            return true;
        }
    }
    false
}
