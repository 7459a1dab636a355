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

use std::ops::Range;

use super::clusters::{Boxes, Cluster, Clusters};
use super::heard::{Hears, Nobody, Outcome, Read};
use super::look::{Asked, BLOCK, Look, PIXEL, Span, TILE};
use super::resolve::{cover, resolve};
use super::setup::Draw;
use super::wide::{self, Wide, Work};
use super::{Resolved, Tiles};
use crate::geometry::PixelRect;
use crate::raster::PyramidCell;
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

/// One group of [`Tiles::draw_groups`]; whether what fills no vector waits for the next.
pub(super) fn draw_group(
    tiles: &mut Tiles,
    clusters: &Clusters,
    group: usize,
    how: How<'_>,
    waits: bool,
    isa: Isa,
) {
    wide::run(isa, DrawGroup { tiles, clusters, group, how, waits });
}
/// See [`Tiles::gather`].
pub(super) fn gather(tiles: &mut Tiles, clusters: &Clusters, group: usize, one_sided: bool, isa: Isa) {
    let how = How { one_sided, skipped: &[], tested: false };
    wide::run(isa, DrawGroup { tiles, clusters, group, how, waits: true });
}
/// See [`Tiles::settle`].
pub(super) fn settle(tiles: &mut Tiles, clusters: &Clusters, isa: Isa) {
    wide::run(isa, Settle { tiles, clusters });
}
/// See [`Tiles::hides`].
pub(super) fn hides<H: Hears>(tiles: &mut Tiles, question: Question, isa: Isa, hears: &mut H) -> bool {
    wide::run(isa, Ask { tiles, question, hears })
}
/// See [`Tiles::refresh`].
pub(super) fn refresh_cell(tiles: &mut Tiles, cell: PyramidCell, isa: Isa) {
    wide::run(isa, Refresh { tiles, cell });
}

/// See [`Tiles::open`].
pub(super) fn open(tiles: &mut Tiles, tile: PyramidCell, nearest: f32, among: u32, isa: Isa) -> u32 {
    wide::run(isa, Open { tiles, tile, nearest, among })
}

/// How primitives are drawn.
#[derive(Clone, Copy)]
pub struct How<'a> {
    /// They have a front only, unless their material has two sides.
    pub one_sided: bool,
    /// Of each primitive of the scene whether it is drawn already; none if empty.
    pub skipped: &'a [bool],
    /// Front to back, without the clusters that are hidden when their turn comes; else all in their order.
    pub tested: bool,
}

/// What is asked for: what lies in a rectangle of pixels, no nearer than a depth; or a box there.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// The pixels that it can cover.
    pub pixels: PixelRect,
    /// Its nearest depth, `1/w`.
    pub nearest: f32,
    /// Least and greatest corner of the box, and of the box of all that is drawn with what it holds, which
    /// says how near that comes.
    pub boxes: Option<[[[f32; 3]; 2]; 2]>,
    /// Whether tiles that do not decide are shaded; else they count as showing it.
    pub exact: bool,
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
        let how = How { one_sided, skipped: &[], tested: true };
        draw_unhidden(l, tiles, clusters, 0..clusters.clusters.len(), how);
        Draw { l, tiles, clusters, one_sided, skipped: &[] }.flush();
    }
}

/// Draws those of some clusters that are not hidden when their turn comes, front to back. What fills no
/// vector waits.
#[inline(always)]
fn draw_unhidden<L: Wide>(l: L, tiles: &mut Tiles, clusters: &Clusters, range: Range<usize>, how: How<'_>) {
    let look = tiles.look;
    let (mut seen, mut asked, mut open) = (Vec::new(), Vec::new(), Vec::new());
    look.in_view(l, &clusters.boxes, &mut seen);
    seen.retain(|&i| range.contains(&(i as usize)));
    front_to_back(&look, &clusters.boxes, &mut seen);
    look.project(l, &clusters.boxes, &seen, &mut asked);
    for a in &asked {
        let own = Span::new(&look, &tiles.camera.eye, clusters.boxes.at(a.id as usize), a.nearest);
        let (spans, hears) = (Spans { own, whole: None }, &mut Nobody);
        // By tiles alone: most are far behind, and the others draw what hides more.
        let hidden = Fine { tiles, asked: a, spans, exact: false, open: &mut open, hears };
        if a.crosses_near || !(a.is_empty() || l.apart(hidden)) {
            let cluster = &clusters.clusters[a.id as usize];
            l.apart(DrawCluster { tiles, clusters, how, cluster });
        }
    }
}

/// The clusters of a group.
struct DrawGroup<'a> {
    tiles: &'a mut Tiles,
    clusters: &'a Clusters,
    group: usize,
    how: How<'a>,
    /// What fills no vector waits for the next group.
    waits: bool,
}

impl Work for DrawGroup<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, clusters, group, how, waits } = self;
        tiles.forget();
        if how.tested {
            draw_unhidden(l, tiles, clusters, clusters.range_of(group), how);
        } else {
            for cluster in clusters.of_group(group) {
                l.apart(DrawCluster { tiles, clusters, how, cluster });
            }
        }
        if !waits {
            // Whoever asks next is to see all of it.
            Draw { l, tiles, clusters, one_sided: how.one_sided, skipped: how.skipped }.flush();
        }
    }
}

/// What waits.
struct Settle<'a> {
    tiles: &'a mut Tiles,
    clusters: &'a Clusters,
}

impl Work for Settle<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, clusters } = self;
        Draw { l, tiles, clusters, one_sided: false, skipped: &[] }.flush();
        finish(l, tiles);
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
    how: How<'a>,
    cluster: &'a Cluster,
}

impl Work for DrawCluster<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, clusters, how: How { one_sided, skipped, .. }, cluster } = self;
        Draw { l, tiles, clusters, one_sided, skipped }.cluster(cluster);
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
        let look = tiles.look;
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
                let span = Span::new(&look, &tiles.camera.eye, boxes.at(a.id as usize), a.nearest);
                let (spans, hears) = (Spans { own: span, whole: None }, &mut Nobody);
                let fine = Fine { tiles, asked: a, spans, exact, open: &mut open, hears };
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
/// Brings the farthest depth of a block up to date. Whether it was not.
#[inline(always)]
pub(super) fn refresh<L: Wide>(l: L, tiles: &mut Tiles, strip: usize, row: usize) -> bool {
    let at = row * tiles.stride() + strip;
    let far = farthest(l, tiles, strip, row);
    std::mem::replace(&mut tiles.block_far[at], far) != far
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
pub(super) fn reached<L: Wide>(
    l: L,
    tiles: &Tiles,
    a: &Asked,
    begin: usize,
    row: usize,
    past: usize,
) -> L::M {
    let far = l.load(&tiles.block_far[row * tiles.stride() + begin..]);
    l.both(l.first(past - begin), l.ge(l.splat(a.nearest), far))
}
/// 2. Of those the ones where it may be, and is not behind all.
#[inline(always)]
fn open_blocks<L: Wide>(l: L, tiles: &Tiles, spans: &Spans, begin: usize, row: usize, reached: L::M) -> u32 {
    if l.bits(reached) == 0 {
        return 0;
    }
    let far = l.load(&tiles.block_far[row * tiles.stride() + begin..]);
    let (x, y) = row_of_blocks(l, begin, row);
    let (begins, meets) = spans.outer(l, x, y, BLOCK);
    l.bits(l.both(reached, l.both(meets, l.ge(begins, far))))
}
/// Of the blocks of a row those that it covers, beginning before all that is drawn there.
#[inline(always)]
fn surely<L: Wide>(l: L, tiles: &Tiles, spans: &Spans, begin: usize, row: usize, past: usize) -> u32 {
    let (x, y) = row_of_blocks(l, begin, row);
    let (begins, ends) = spans.own.inner(l, x, y, BLOCK);
    let near = l.load(&tiles.block_near[row * tiles.stride() + begin..]);
    l.bits(l.both(l.first(past - begin), l.both(l.ge(begins, ends), l.ge(begins, near))))
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
fn open_tiles<L: Wide>(l: L, tiles: &Tiles, spans: &Spans, a: &Asked, strip: usize, row: usize) -> u32 {
    let mut open = 0;
    for part in 0..16 / L::N {
        let first = tiles.first_line(strip, row) + part * (L::N / 4);
        let far = l.load_farthest(&tiles.lines[first..]);
        let (x, y) = tiles_of_block(l, strip, row, part);
        let (begins, meets) = spans.outer(l, x, y, TILE);
        open |= l.bits(l.both(meets, l.ge(begins, far))) << (part * L::N);
    }
    open & a.tiles(strip, row)
}
/// Those that surely show a box: it covers all of the tile, and something in the tile is not covered, or
/// nothing in the block is nearer.
#[inline(always)]
fn sure_tiles<L: Wide>(l: L, tiles: &Tiles, spans: &Spans, a: &Asked, strip: usize, row: usize) -> u32 {
    let before = l.splat(tiles.block_near[row * tiles.stride() + strip]);
    let mut sure = 0;
    for part in 0..16 / L::N {
        let first = tiles.first_line(strip, row) + part * (L::N / 4);
        let ever = l.load_ever(&tiles.lines[first..]);
        let (x, y) = tiles_of_block(l, strip, row, part);
        let (begins, ends) = spans.own.inner(l, x, y, TILE);
        let may_be_hidden = l.without(l.eq_i(ever, l.splat_i(-1)), l.ge(begins, before));
        sure |= l.bits(l.without(l.ge(begins, ends), may_be_hidden)) << (part * L::N);
    }
    // What is asked for by its rectangle alone lies everywhere, but for what the rectangle leaves out, and
    // beyond the image nothing is seen.
    sure & a.tiles_inside(strip, row, tiles.is_flat)
}

/// A box, and the box of all that is drawn with what it holds, where that is another one: it says how near
/// that comes, and the box itself where it may be.
#[derive(Clone, Copy)]
struct Spans {
    own: Span,
    whole: Option<Span>,
}

impl Spans {
    /// Over cells the nearest depths at which it begins, and where it may be.
    #[inline(always)]
    fn outer<L: Wide>(&self, l: L, x: L::F, y: L::F, half: [f32; 2]) -> (L::F, L::M) {
        let (begins, ends) = self.own.outer(l, x, y, half);
        let meets = l.ge(begins, ends);
        match &self.whole {
            Some(whole) => (whole.outer(l, x, y, half).0, meets),
            None => (begins, meets),
        }
    }
    /// The pixels of a tile where it may be, and not behind depths.
    #[inline(always)]
    fn pixels<L: Wide>(&self, l: L, at: [i32; 2], depths: &[f32; 32]) -> u32 {
        match &self.whole {
            Some(whole) => self.own.pixels(l, at, None) & whole.pixels(l, at, Some(depths)),
            None => self.own.pixels(l, at, Some(depths)),
        }
    }
    fn is_below(&self, floor: &[f32; 3], at: [i32; 2]) -> bool {
        self.whole.as_ref().unwrap_or(&self.own).is_below(floor, at)
    }
}

/// One question from outside.
struct Ask<'a, H> {
    tiles: &'a mut Tiles,
    question: Question,
    hears: &'a mut H,
}

impl<H: Hears> Work for Ask<'_, H> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Wide>(self, l: L) -> bool {
        let Self { tiles, question: Question { pixels: p, nearest, boxes, exact }, hears } = self;
        let (x0, x1, y0, y1) = (p.x0 as i32, p.x1 as i32, p.y0 as i32, p.y1 as i32);
        let asked = &Asked { id: 0, x0, x1, y0, y1, nearest, crosses_near: false };
        // What covers no pixel's center cannot show.
        if asked.is_empty() {
            return true;
        }
        let (look, eye) = (&tiles.look, &tiles.camera.eye);
        let spans = match boxes {
            Some([own, whole]) if whole == own => {
                Spans { own: Span::new(look, eye, own, nearest), whole: None }
            }
            Some([own, whole]) => {
                let whole = Some(Span::new(look, eye, whole, nearest));
                Spans { own: Span::new(look, eye, own, nearest), whole }
            }
            None => Spans { own: Span::everywhere(nearest), whole: None },
        };
        let (open, exact) = (&mut Vec::new(), exact && tiles.keeps);
        Fine { tiles, asked, spans, exact, open, hears }.run(l)
    }
}

/// A cell is brought up to date, as a question does it: a block from its tiles, a tile by exact depths.
struct Refresh<'a> {
    tiles: &'a mut Tiles,
    cell: PyramidCell,
}

impl Work for Refresh<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { tiles, cell } = self;
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        if cell.level == PyramidCell::BLOCK {
            refresh(l, tiles, x, y);
        } else {
            let (block, tile) = place_of(tiles, cell);
            look_closer(l, tiles, block, tile);
        }
    }
}

/// Of the pixels of a tile those that do not lie before a depth.
struct Open<'a> {
    tiles: &'a mut Tiles,
    tile: PyramidCell,
    nearest: f32,
    among: u32,
}

impl Work for Open<'_> {
    type Output = u32;
    #[inline(always)]
    fn run<L: Wide>(self, l: L) -> u32 {
        let Self { tiles, tile, nearest, among } = self;
        let (block, tile) = place_of(tiles, tile);
        let known = tiles.resolved.at[block][tile];
        if known == Resolved::NOT || tiles.resolved.floors[known as usize].1 == Resolved::NOT {
            look_closer(l, tiles, block, tile);
        }
        let floor = tiles.resolved.floors[tiles.resolved.at[block][tile] as usize];
        let depths = &tiles.resolved.depths[floor.1 as usize];
        let mut open = 0;
        for at in (0..32).step_by(L::N) {
            open |= l.bits(l.ge(l.splat(nearest), l.load(&depths[at..]))) << at;
        }
        open & among
    }
}

/// Whether something is hidden.
struct Fine<'a, H> {
    tiles: &'a mut Tiles,
    asked: &'a Asked,
    spans: Spans,
    exact: bool,
    /// Scratch: blocks with the tiles that did not decide.
    open: &'a mut Vec<(usize, u32)>,
    hears: &'a mut H,
}

impl<H: Hears> Work for Fine<'_, H> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Wide>(mut self, l: L) -> bool {
        let a = self.asked;
        let [left, right, top, bottom] = a.blocks();
        // What shows mostly shows in the middle.
        let middle = ((left + right) / 2).saturating_sub(8).max(left);
        if self.exact && self.shows_surely(l, middle, (top + bottom) / 2, right) {
            return false;
        }
        self.open.clear();
        for row in top..bottom {
            for begin in (left..right).step_by(L::N) {
                let may = reached(l, self.tiles, a, begin, row, right);
                let mut bits = open_blocks(l, self.tiles, &self.spans, begin, row, may);
                if bits != 0 && self.exact && self.shows_surely(l, begin, row, right) {
                    return false;
                }
                let mut told = begin;
                while bits != 0 {
                    let strip = begin + bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    told = self.tell_blocks(l, row, told, strip + 1);
                    let found = open_tiles(l, self.tiles, &self.spans, a, strip, row);
                    let sure = if self.exact {
                        found & sure_tiles(l, self.tiles, &self.spans, a, strip, row)
                    } else {
                        found
                    };
                    self.tell_tiles(l, strip, row, sure);
                    if sure != 0 {
                        return false;
                    }
                    if found == 0 {
                        self.refresh(l, strip, row);
                    } else {
                        self.open.push((row * self.tiles.strips + strip, found));
                    }
                }
                self.tell_blocks(l, row, told, right.min(begin + L::N));
            }
        }
        // 4. First the pixels that nothing covers, then exact depths. (Closures would not be compiled for the
        // instruction set.)
        for k in 0..self.open.len() {
            if self.shows_bare(l, self.open[k]) {
                return false;
            }
        }
        for k in 0..self.open.len() {
            if self.shows(l, self.open[k]) {
                return false;
            }
        }
        true
    }
}

impl<H: Hears> Fine<'_, H> {
    #[inline(always)]
    fn shows_surely<L: Wide>(&mut self, l: L, begin: usize, row: usize, past: usize) -> bool {
        let sure = surely(l, self.tiles, &self.spans, begin, row, past);
        if H::LISTENS && sure != 0 {
            let strip = begin + sure.trailing_zeros() as usize;
            self.tell(l, BLOCK, PyramidCell::BLOCK, [strip, row], Some(Outcome::Shows));
        }
        sure != 0
    }
    /// Brings a block up to date whose tiles hide what its own depth does not.
    #[inline(always)]
    fn refresh<L: Wide>(&mut self, l: L, strip: usize, row: usize) {
        if refresh(l, self.tiles, strip, row) {
            self.hears.refreshes(cell_at(PyramidCell::BLOCK, [strip, row]));
        }
    }
    /// Whether it may show at a pixel of these tiles that nothing covers.
    #[inline(always)]
    fn shows_bare<L: Wide>(&mut self, l: L, (block, mut found): (usize, u32)) -> bool {
        let (row, strip) = (block / self.tiles.strips, block % self.tiles.strips);
        while found != 0 {
            let tile = found.trailing_zeros() as usize;
            found &= found - 1;
            self.hears.looks_closer(false);
            let at = first_pixel(self.tiles, block, tile);
            let line = &self.tiles.lines[self.tiles.first_line(strip, row) + (tile >> 2)];
            let bare = !line.ever[tile & 3] & self.asked.pixels(at);
            let shows = if bare == 0 { 0 } else { self.spans.own.pixels(l, at, None) & bare };
            if shows != 0 {
                if H::LISTENS {
                    self.tell_pixel(l, at, shows.trailing_zeros(), self.tiles.camera.depth_far);
                }
                return true;
            }
        }
        false
    }
    /// Whether it may show at a pixel of these tiles, by exact depths where nothing less decides.
    #[inline(always)]
    fn shows<L: Wide>(&mut self, l: L, (block, mut found): (usize, u32)) -> bool {
        while found != 0 {
            let tile = found.trailing_zeros() as usize;
            found &= found - 1;
            self.hears.looks_closer(true);
            let pixel = first_pixel(self.tiles, block, tile);
            let known = self.tiles.resolved.at[block][tile];
            let at = if known == Resolved::NOT { cover(self.tiles, block, tile) } else { known as usize };
            if self.is_below(l, at, pixel) {
                continue;
            }
            if self.tiles.resolved.floors[at].1 == Resolved::NOT {
                look_closer(l, self.tiles, block, tile);
                self.hears.refreshes(tile_at(pixel));
                if self.is_below(l, at, pixel) {
                    continue;
                }
            }
            let depths = self.tiles.resolved.depths[self.tiles.resolved.floors[at].1 as usize];
            let shows = self.spans.pixels(l, pixel, &depths) & self.asked.pixels(pixel);
            if H::LISTENS {
                self.tell_exact(l, pixel, &depths, shows);
            }
            if shows != 0 {
                return true;
            }
        }
        false
    }
    /// Whether it lies behind the plane that is known of a tile.
    #[inline(always)]
    fn is_below<L: Wide>(&mut self, l: L, at: usize, pixel: [i32; 2]) -> bool {
        let floor = self.tiles.resolved.floors[at].0;
        let is_below = self.spans.is_below(&floor, pixel);
        if H::LISTENS && is_below {
            let nearest = self.spans.begins_at(l, [pixel[0] as f32 + 4.0, pixel[1] as f32 + 2.0]);
            // Both in the middle of the tile; it lies behind the plane all over it.
            self.hears.reads(Read {
                cell: tile_at(pixel),
                held: floor[0],
                nearest,
                outcome: Outcome::Behind,
            });
        }
        is_below
    }
}

/// A cell by its column and row.
pub(super) fn cell_at(level: u8, [x, y]: [usize; 2]) -> PyramidCell {
    PyramidCell { level, x: x as u16, y: y as u16 }
}
/// The tile at its first pixel.
pub(super) fn tile_at([x, y]: [i32; 2]) -> PyramidCell {
    cell_at(PyramidCell::TILE, [x as usize / 8, y as usize / 4])
}
/// The block of a tile, and its number there.
#[inline(always)]
fn place_of(tiles: &Tiles, tile: PyramidCell) -> (usize, usize) {
    let (x, y) = (usize::from(tile.x), usize::from(tile.y));
    (y / 4 * tiles.strips + x / 4, y % 4 * 4 + x % 4)
}
/// Works out the depths of a tile's pixels.
#[inline(always)]
pub(super) fn look_closer<L: Wide>(l: L, tiles: &mut Tiles, block: usize, tile: usize) {
    if tiles.resolved.at[block][tile] == Resolved::NOT {
        cover(tiles, block, tile);
    }
    resolve(l, tiles, block, tile);
    refresh(l, tiles, block % tiles.strips, block / tiles.strips);
}

/// What is told to who listens: the very numbers that were compared, made once more.
impl<H: Hears> Fine<'_, H> {
    /// Compares one cell, given by column and row, and tells it; `None`: what follows is that it hides or is
    /// below it, and nothing where it does not reach. Sides of cells follow from their half extents.
    fn tell<L: Wide>(&mut self, l: L, half: [f32; 2], level: u8, [x, y]: [usize; 2], shows: Option<Outcome>) {
        let cell = cell_at(level, [x, y]);
        let (column, row) =
            if level == PyramidCell::BLOCK { (32 * x + 16, 16 * y + 8) } else { (8 * x + 4, 4 * y + 2) };
        let held = if level == PyramidCell::BLOCK {
            self.tiles.block_far[y * self.tiles.stride() + x]
        } else {
            self.tiles.lines[x / 4 * self.tiles.rows + y].far[x % 4]
        };
        let (begins, meets) = self.spans.outer(l, l.splat(column as f32), l.splat(row as f32), half);
        let nearest = self.asked.nearest;
        // Its nearest depth alone is compared first, and decides without the planes.
        let read = if level == PyramidCell::BLOCK && nearest < held {
            Read { cell, held, nearest, outcome: Outcome::Behind }
        } else if l.bits(meets) & 1 == 0 && shows.is_none() {
            return;
        } else {
            let nearest = l.least(begins);
            let outcome = if nearest < held { Outcome::Behind } else { shows.unwrap_or(Outcome::Descends) };
            Read { cell, held, nearest, outcome }
        };
        self.hears.reads(read);
    }
    /// Blocks of a row from one up to another; returns the other.
    #[inline(always)]
    fn tell_blocks<L: Wide>(&mut self, l: L, row: usize, from: usize, past: usize) -> usize {
        if H::LISTENS {
            (from..past).for_each(|strip| self.tell(l, BLOCK, PyramidCell::BLOCK, [strip, row], None));
        }
        past
    }
    /// The tiles of a block, up to the first of those that are `sure` to show it.
    #[inline(always)]
    fn tell_tiles<L: Wide>(&mut self, l: L, strip: usize, row: usize, sure: u32) {
        if !H::LISTENS {
            return;
        }
        let touched = self.asked.tiles(strip, row);
        for tile in (0..16).filter(|k| touched >> k & 1 == 1) {
            let at = [4 * strip + (tile & 3), 4 * row + (tile >> 2)];
            let is_sure = sure >> tile & 1 == 1;
            self.tell(l, TILE, PyramidCell::TILE, at, is_sure.then_some(Outcome::Shows));
            if is_sure {
                return;
            }
        }
    }
    /// The pixel of a tile where it shows.
    fn tell_pixel<L: Wide>(&mut self, l: L, [x, y]: [i32; 2], bit: u32, held: f32) {
        let (x, y) = (x as usize + bit as usize % 8, y as usize + bit as usize / 8);
        let nearest = self.spans.begins_at(l, [x as f32 + 0.5, y as f32 + 0.5]);
        self.hears.reads(Read { cell: cell_at(0, [x, y]), held, nearest, outcome: Outcome::Shows });
    }
    /// The pixel where it shows, or if none does of those where it may be the one that hides it by the least.
    fn tell_exact<L: Wide>(&mut self, l: L, at: [i32; 2], depths: &[f32; 32], shows: u32) {
        if shows != 0 {
            let bit = shows.trailing_zeros();
            return self.tell_pixel(l, at, bit, depths[bit as usize]);
        }
        let on = self.spans.own.pixels(l, at, None) & self.asked.pixels(at);
        let read = |bit: u32| {
            let (x, y) = (at[0] as usize + bit as usize % 8, at[1] as usize + bit as usize / 8);
            let nearest = self.spans.begins_at(l, [x as f32 + 0.5, y as f32 + 0.5]);
            Read { cell: cell_at(0, [x, y]), held: depths[bit as usize], nearest, outcome: Outcome::Behind }
        };
        let reads = (0..32).filter(|bit| on >> bit & 1 == 1).map(read);
        let least = reads.reduce(|a, b| if b.held - b.nearest < a.held - a.nearest { b } else { a });
        if let Some(least) = least {
            self.hears.reads(least);
        }
    }
}

impl Spans {
    /// The nearest depth at which it begins at a point of the image, as at a pixel's center.
    fn begins_at<L: Wide>(&self, l: L, [x, y]: [f32; 2]) -> f32 {
        l.least(self.outer(l, l.splat(x), l.splat(y), PIXEL).0)
    }
}

/// The first pixel of a tile of a block.
#[inline(always)]
pub(super) fn first_pixel(tiles: &Tiles, block: usize, tile: usize) -> [i32; 2] {
    let (row, strip) = (block / tiles.strips, block % tiles.strips);
    [(32 * strip + 8 * (tile & 3)) as i32, (16 * row + 4 * (tile >> 2)) as i32]
}
