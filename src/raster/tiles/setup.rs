//! From clusters to primitives that are ready for windows.
//!
//! 1. Back faces are left out by the stored planes, before any point is touched ([`Draw::front_faces`]).
//! 2. The points of a cluster are projected, each once ([`Draw::project`]).
//! 3. Primitives are gathered sixteen at a time; those out of view are dropped, those that need clipping put
//!    aside, the others sorted by size into three rings, so that set-up always has full lanes
//!    ([`Draw::sort`]).
//! 4. Sixteen of a ring are set up ([`Draw::set_up`]): edges (`edges`), depth plane with a bound on its
//!    rounding (`plane`).

use super::Tiles;
use super::bins::Batch;
use super::clusters::{Cluster, Clusters, TWO_SIDED, corner, half, is_quadrangle, reversed};
use super::ready::{Corners, LARGE, MIDDLING, Pixels, Ready, SMALL, Told, greatest4, least4};
use super::wide::{Wide, Work, each};
use super::window::{Several, single};
use crate::geometry::{orient2d, orient3d};
use crate::raster::frame::clip;
use crate::raster::setup::area;
use crate::raster::vertex::{GUARD, NEEDS_CLIP, REJECTS, SUBPIXEL_BITS, Vertex};

/// Buffers of drawing, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Points of the cluster at hand.
    pub corners: Vec<Vertex>,
    /// Words of what faces the eye of it, with their tags; and of what needs clipping.
    front: Front,
    clipped: Vec<(u64, i32)>,
    /// Triangles that the grid turned over or that clipping made.
    turned: Vec<([Vertex; 3], i32)>,
    rings: [Ring; 3],
    pub ready: Option<Box<Ready>>,
    /// For each strip the tiles of a bin that a primitive may show in, covers whole, and its nearest depth.
    pub hits: Vec<(u64, u64, f32)>,
    pub told: Told,
    /// Segments that are kept.
    pub segments: usize,
}

/// Words and tags of what faces the eye. A tag says which primitive it is and which parts of it: the number
/// among all words, shifted by two, and a bit for each of the two triangles.
#[derive(Clone, Debug, Default)]
pub(super) struct Front {
    pub words: Vec<u64>,
    pub tags: Vec<i32>,
}

impl Front {
    fn push(&mut self, word: u64, prim: usize, parts: i32) {
        self.words.push(word);
        self.tags.push((prim as i32) << 2 | parts);
    }
}
/// Both triangles of a primitive.
const BOTH: i32 = 3;

impl Scratch {
    pub fn clear(&mut self, strips: usize) {
        self.rings.iter_mut().for_each(|r| r.count = 0);
        self.turned.clear();
        self.told.begin();
        self.segments = 0;
        self.hits.resize(strips, (0, 0, 0.0));
    }
    /// Whether primitives wait to be set up.
    pub fn waits(&self) -> bool {
        self.rings.iter().any(|ring| ring.count > 0) || !self.turned.is_empty()
    }
}

/// Primitives that wait to be set up: by columns x, y, z and packed of the four corners, and their tags.
#[derive(Clone, Debug)]
struct Ring {
    values: [[i32; 48]; 16],
    tags: [i32; 48],
    count: usize,
}

impl Default for Ring {
    fn default() -> Self {
        Self { values: [[0; 48]; 16], tags: [0; 48], count: 0 }
    }
}

/// Greatest sizes of small and middling primitives, pixels.
const SMALL_PX: i32 = 40;
const MIDDLING_PX: i32 = 256;

/// Draws clusters.
pub(super) struct Draw<'a, L> {
    pub l: L,
    pub tiles: &'a mut Tiles,
    pub clusters: &'a Clusters,
    pub one_sided: bool,
    /// Primitives of the scene that are drawn already; none if empty.
    pub skipped: &'a [bool],
}

impl<L: Wide> Draw<'_, L> {
    /// Draws what faces the eye of a cluster.
    #[inline(always)]
    pub fn cluster(&mut self, c: &Cluster) {
        let mut front = std::mem::take(&mut self.tiles.scratch.front);
        front.words.clear();
        front.tags.clear();
        self.front_faces(c, &mut front);
        if let Some(&last) = front.words.last() {
            let told = &mut self.tiles.scratch.told;
            if told.is_asked {
                told.faced.extend_from_slice(&front.tags);
            }
            self.project(c);
            if self.tiles.is_flat {
                self.segments(c, &front);
            } else {
                // Whole vectors: the last word again, and its lanes left out.
                let count = front.words.len();
                front.words.resize(count.next_multiple_of(16), last);
                front.tags.resize(front.words.len(), 0);
                let tags = front.tags.chunks_exact(16);
                for (k, (words, tags)) in front.words.chunks_exact(16).zip(tags).enumerate() {
                    self.gather(words, tags, count - 16 * k);
                }
                self.clip_all(c);
            }
        }
        self.tiles.scratch.front = front;
    }
    /// Draws what waits.
    #[inline(always)]
    pub fn flush(&mut self) {
        loop {
            for size in [LARGE, MIDDLING, SMALL] {
                while self.tiles.scratch.rings[size as usize].count > 0 {
                    let count = self.tiles.scratch.rings[size as usize].count.min(16);
                    self.l.apart(SetUp { draw: self, size, count });
                }
            }
            // Set-up may have turned some round.
            if self.tiles.scratch.turned.is_empty() {
                return;
            }
            self.sort_turned();
        }
    }

    /// 1. The words of what shows its front, or either side where both are seen.
    #[inline(always)]
    fn front_faces(&self, c: &Cluster, front: &mut Front) {
        let (l, camera, all) = (self.l, &self.tiles.camera, self.clusters);
        let off = |a: usize| (camera.eye[a] - f64::from(c.middle[a])) as f32;
        let eye = [off(0), off(1), off(2)];
        let v = each!(3; a => l.splat(eye[a]));
        // Rounding of the planes, of the eye and of the five operations, each 2⁻²⁴ of what is summed up.
        let error = (eye[0].abs() + eye[1].abs() + eye[2].abs() + c.reach) * (1.0 / (1 << 20) as f32);
        for first in c.prims.clone().step_by(L::N) {
            let valid = l.first(c.prims.end - first);
            let (a, b) = (self.side(&v, first, 0), self.side(&v, first, 4));
            let both = l.both(valid, l.both(l.gt(a, l.splat(error)), l.gt(b, l.splat(error))));
            let away = l.both(valid, l.both(l.gt(l.splat(-error), a), l.gt(l.splat(-error), b)));
            let rest = l.without(l.without(valid, both), away);
            let (mut whole, mut turned, mut rest) = (l.bits(both), l.bits(away), l.bits(rest));
            if self.one_sided && !all.any_two_sided {
                turned = 0;
            }
            if !self.skipped.is_empty() {
                let open = !self.drawn(first);
                (whole, turned, rest) = (whole & open, turned & open, rest & open);
            }
            while whole != 0 {
                let prim = first + whole.trailing_zeros() as usize;
                front.push(all.words[prim], prim, BOTH);
                whole &= whole - 1;
            }
            while turned != 0 {
                let prim = first + turned.trailing_zeros() as usize;
                if !self.one_sided || all.words[prim] & TWO_SIDED != 0 {
                    front.push(reversed(all.words[prim]), prim, BOTH);
                }
                turned &= turned - 1;
            }
            while rest != 0 {
                self.front_parts(c, first + rest.trailing_zeros() as usize, front);
                rest &= rest - 1;
            }
        }
    }
    /// Of a vector of primitives those whose triangles are all drawn already.
    #[inline(never)]
    fn drawn(&self, first: usize) -> u32 {
        let ids = self.clusters.ids[first..].iter().take(L::N).enumerate();
        let is_drawn = |id: crate::geometry::PrimId| self.skipped[id.at()];
        ids.map(|(lane, ids)| u32::from(is_drawn(ids[0]) && is_drawn(ids[1])) << lane).sum()
    }
    /// How far the eye lies before the planes of a vector of primitives; `which`: their first column.
    #[inline(always)]
    fn side(&self, eye: &[L::F; 3], first: usize, which: usize) -> L::F {
        let l = self.l;
        let [x, y, z, offset] = each!(4; j => l.load(&self.clusters.planes[which + j][first..]));
        l.add(l.mul(eye[0], x), l.add(l.mul(eye[1], y), l.sub(l.mul(eye[2], z), offset)))
    }
    /// The parts of one primitive that are seen, decided exactly, as they run on the screen.
    #[inline(never)]
    fn front_parts(&self, c: &Cluster, prim: usize, front: &mut Front) {
        let word = self.clusters.words[prim];
        let is_two_sided = !self.one_sided || word & TWO_SIDED != 0;
        let shows = [half(word, false), half(word, true)].map(|w| self.shows_front(c, w));
        let mut put = |word: u64, shows_front: bool, parts: i32| match (shows_front, is_two_sided) {
            (true, _) => front.push(word, prim, parts),
            (false, true) => front.push(reversed(word), prim, parts),
            (false, false) => {}
        };
        if !is_quadrangle(word) || shows[0] == shows[1] {
            put(word, shows[0], BOTH);
        } else {
            put(half(word, false), shows[0], 1);
            put(half(word, true), shows[1], 2);
        }
    }
    fn shows_front(&self, c: &Cluster, word: u64) -> bool {
        // The exact predicate of the rasterizer; the corners run the other way round.
        let [a, b, d] = self.points_of(c, word).map(|p| p.as_dvec3());
        if self.tiles.is_flat {
            let eye = glam::DVec3::from(self.tiles.camera.eye);
            return orient2d(a.truncate(), b.truncate(), eye.truncate()) > 0.0;
        }
        orient3d(a, d, b, glam::DVec3::from(self.tiles.camera.eye)) > 0.0
    }
    pub(super) fn points_of(&self, c: &Cluster, word: u64) -> [glam::Vec3; 3] {
        std::array::from_fn(|j| {
            let at = c.points.start + corner(word, j);
            glam::Vec3::from(self.clusters.points.each_ref().map(|p| p[at]))
        })
    }

    /// 2. The points of a cluster on the grid, by the arithmetic of [`Camera::vertex`].
    #[inline(always)]
    fn project(&mut self, c: &Cluster) {
        let (l, k) = (self.l, self.tiles.camera);
        let count = c.points.len().next_multiple_of(16);
        self.tiles.scratch.corners.resize(count, Vertex::default());
        let rows = each!(3; r => each!(3; a => l.splat_d(k.rows[r][a])));
        let eye = each!(3; a => l.splat_d(k.eye[a]));
        let corners = self.tiles.scratch.corners.chunks_exact_mut(L::N);
        for (at, to) in (c.points.start..c.points.start + count).step_by(L::N).zip(corners) {
            let r = each!(3; a => l.sub_d(l.to_d(l.load(&self.clusters.points[a][at..])), eye[a]));
            let [x, y, w] = each!(3; i => l.add_d(
                l.add_d(l.mul_d(rows[i][0], r[0]), l.mul_d(rows[i][1], r[1])),
                l.mul_d(rows[i][2], r[2])
            ));
            let inverse = l.div_d(l.splat_d(1.0), w);
            let middle = [l.splat_d(k.middle[0]), l.splat_d(k.middle[1])];
            let column = l.add_d(middle[0], l.mul_d(l.mul_d(x, inverse), middle[0]));
            let row = l.sub_d(middle[1], l.mul_d(l.mul_d(y, inverse), middle[1]));
            let z = l.min(l.narrow(inverse), l.splat(f32::MAX));
            let is_near = l.gt_d(l.splat_d(k.near), w);
            let off = l.max_d(l.abs_d(l.sub_d(column, middle[0])), l.abs_d(l.sub_d(row, middle[1])));
            let is_off = l.without(l.gt_d(off, l.splat_d(GUARD)), is_near);
            let is_beyond = l.without(l.gt(l.splat(k.depth_far), z), is_near);
            let minus = l.sub_d(l.splat_d(0.0), w);
            let sides = [l.gt_d(minus, x), l.gt_d(x, w), l.gt_d(minus, y), l.gt_d(y, w)];
            let mut outside = l.or(l.or(bit(l, is_beyond, 4), bit(l, is_near, 5)), bit(l, is_off, 6));
            for (k, side) in sides.into_iter().enumerate() {
                outside = l.or(outside, bit(l, side, k));
            }
            let (cx, cy) = (l.nearest(column), l.nearest(row));
            // As [`Vertex`] packs it: 12 bits each of what the snap took.
            let rest_x = l.and(beyond(l, column, cx), l.splat_i(0xfff));
            let rests = l.or(l.shift_up::<8>(rest_x), l.shift_up::<20>(beyond(l, row, cy)));
            l.store_corners(to, [cx, cy, l.bits_of(z), l.or(outside, rests)]);
        }
    }

    /// 3. Sixteen words, `count` of which are meant.
    #[inline(always)]
    fn gather(&mut self, words: &[u64], tags: &[i32], count: usize) {
        let l = self.l;
        for first in (0..count.min(16)).step_by(L::N) {
            let words = &words[first..first + L::N];
            let tags = &tags[first..first + L::N];
            let v: [[L::I; 4]; 4] = each!(4; k => l.gather(&self.tiles.scratch.corners, words, k));
            let all = l.and(l.and(v[0][3], v[1][3]), l.and(v[2][3], v[3][3]));
            let any = l.or(l.or(v[0][3], v[1][3]), l.or(v[2][3], v[3][3]));
            let zero = l.splat_i(0);
            let meant = l.first(count - first);
            let valid = l.both(meant, l.eq_i(l.and(all, l.splat_i(REJECTS as i32)), zero));
            let clip = l.without(valid, l.eq_i(l.and(any, l.splat_i(NEEDS_CLIP as i32)), zero));
            let mut bits = l.bits(clip);
            while bits != 0 {
                let lane = bits.trailing_zeros() as usize;
                let (word, tag) = (words[lane], tags[lane]);
                bits &= bits - 1;
                self.tiles.scratch.clipped.push((half(word, false), tag));
                if is_quadrangle(word) {
                    self.tiles.scratch.clipped.push((half(word, true), tag));
                }
            }
            self.sort(v, l.load_i(tags), l.without(valid, clip));
        }
        self.set_up_full();
    }
    /// Drops what covers no pixel's center; the rest waits in the ring of its size.
    #[inline(always)]
    fn sort(&mut self, v: [[L::I; 4]; 4], tags: L::I, valid: L::M) {
        let l = self.l;
        let (x, y) = (each!(4; k => v[k][0]), each!(4; k => v[k][1]));
        let (low_x, high_x) = (least4(l, x), greatest4(l, x));
        let (low_y, high_y) = (least4(l, y), greatest4(l, y));
        let p = self.pixels(low_x, high_x, low_y, high_y);
        let live = l.both(valid, l.both(l.gt_i(p.x1, p.x0), l.gt_i(p.y1, p.y0)));
        if l.bits(live) == 0 {
            return;
        }
        let size = l.max_i(l.sub_i(high_x, low_x), l.sub_i(high_y, low_y));
        let not_small = l.both(live, l.gt_i(size, l.splat_i(SMALL_PX << SUBPIXEL_BITS)));
        let large = l.both(live, l.gt_i(size, l.splat_i(MIDDLING_PX << SUBPIXEL_BITS)));
        let masks = [l.without(live, not_small), l.without(not_small, large), large];
        for (ring, mask) in self.tiles.scratch.rings.iter_mut().zip(masks) {
            let count = l.bits(mask).count_ones() as usize;
            if count != 0 {
                for (j, corner) in v.iter().enumerate() {
                    for (k, &value) in corner.iter().enumerate() {
                        l.compress(&mut ring.values[4 * k + j][ring.count..], mask, value);
                    }
                }
                l.compress(&mut ring.tags[ring.count..], mask, tags);
                ring.count += count;
            }
        }
    }
    /// Sets up what fills a vector. Looked for after sixteen, on every instruction set, so that the order of
    /// drawing is the same.
    #[inline(always)]
    fn set_up_full(&mut self) {
        for size in [SMALL, MIDDLING, LARGE] {
            if self.tiles.scratch.rings[size as usize].count >= 16 {
                self.l.apart(SetUp { draw: self, size, count: 16 });
            }
        }
    }
    /// Up to 16 triangles that the grid turned over, or that clipping made, into the rings.
    fn sort_turned(&mut self) {
        let at = self.tiles.scratch.turned.len().saturating_sub(16);
        let some: Vec<([Vertex; 3], i32)> = self.tiles.scratch.turned.drain(at..).collect();
        self.l.apart(SortTurned { draw: self, some });
    }
    /// The parts of what crosses the near plane or the guard band.
    fn clip_all(&mut self, c: &Cluster) {
        for (word, tag) in std::mem::take(&mut self.tiles.scratch.clipped) {
            let camera = self.tiles.camera;
            for [a, b, c] in clip(&camera, self.points_of(c, word).map(|p| camera.clip(p))) {
                put_turned([a, b, c], tag, &mut self.tiles.scratch.turned);
            }
        }
        while self.tiles.scratch.turned.len() >= 16 {
            self.sort_turned();
        }
    }

    /// The pixels whose centers lie in a box on the grid, cut to the image.
    #[inline(always)]
    fn pixels(&self, low_x: L::I, high_x: L::I, low_y: L::I, high_y: L::I) -> Pixels<L> {
        let l = self.l;
        Pixels {
            x0: l.max_i(l.shift_right::<8>(l.add_i(low_x, l.splat_i(127))), l.splat_i(0)),
            x1: l.min_i(l.shift_right::<8>(l.add_i(high_x, l.splat_i(128))), l.splat_i(self.tiles.width)),
            y0: l.max_i(l.shift_right::<8>(l.add_i(low_y, l.splat_i(127))), l.splat_i(0)),
            y1: l.min_i(l.shift_right::<8>(l.add_i(high_y, l.splat_i(128))), l.splat_i(self.tiles.height)),
        }
    }

    /// 4. Sixteen of a ring, or the last ones: set up, then drawn.
    #[inline(always)]
    fn set_up<const SIZE: u8>(&mut self, count: usize) {
        let l = self.l;
        let (mut batch, tags) = take(&mut self.tiles.scratch.rings[SIZE as usize], count);
        let mut ready = self.tiles.scratch.ready.take().unwrap_or_default();
        let (mut live, mut one) = (0, 0);
        for first in (0..count).step_by(L::N) {
            let found = self.set_up_part::<SIZE>(&batch, &tags, &mut ready, first, count - first);
            live |= found.0 << first;
            one |= found.1 << first;
        }
        let id = self.tiles.bins.kept.len() as u32 * 16;
        let mut hits = 0u32;
        let mut bits = live & one;
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            hits |= u32::from(single(l, self.tiles, &ready, lane, id + lane as u32)) << lane;
        }
        let mut bits = live & !one;
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let tiles = &mut *self.tiles;
            let hit = l.apart(Several::<SIZE> { tiles, ready: &ready, lane, id: id + lane as u32 });
            hits |= u32::from(hit) << lane;
        }
        let told = &mut self.tiles.scratch.told;
        let mut bits = if told.is_asked { hits } else { 0 };
        while bits != 0 {
            told.shown.push(tags[bits.trailing_zeros() as usize]);
            bits &= bits - 1;
        }
        if hits != 0 && self.tiles.keeps {
            for i in 0..16 {
                // From tile to tile, eight columns and four rows.
                let floor = [ready.floor[i], ready.along[i] * 0.125, ready.down[i] * 0.25];
                batch.floor.iter_mut().zip(floor).for_each(|(to, v)| to[i] = v);
                (batch.column[i], batch.row[i]) = (ready.x0[i] & !31, ready.y0[i] & !15);
            }
            self.tiles.bins.kept.push(batch);
        }
        self.tiles.scratch.ready = Some(ready);
    }

    /// A vector of them from `first` on. Returns which of its lanes are to be drawn, and which of these in a
    /// single window.
    #[inline(always)]
    fn set_up_part<const SIZE: u8>(
        &mut self,
        batch: &Batch,
        tags: &[i32; 16],
        t: &mut Ready,
        first: usize,
        count: usize,
    ) -> (u32, u32) {
        let l = self.l;
        let [x, y, z, packed] = &batch.corners;
        let c = Corners::<L> {
            x: each!(4; k => l.load_i(&x[k][first..])),
            y: each!(4; k => l.load_i(&y[k][first..])),
            z: each!(4; k => l.of_bits(l.load_i(&z[k][first..]))),
            packed: each!(4; k => l.load_i(&packed[k][first..])),
        };
        let p = self.pixels(least4(l, c.x), greatest4(l, c.x), least4(l, c.y), greatest4(l, c.y));
        let shape = self.shape::<SIZE>(&c);
        // Not convex on the grid or turned over by it, or a quadrangle with a half so thin that its plane may
        // be much steeper than both together: by its triangles, each as it runs on the grid.
        let meant = l.first(count);
        let apart = l.both(meant, l.either(shape.bad, l.without(shape.thin, shape.is_triangle)));
        let mut bits = l.bits(apart);
        while bits != 0 {
            let lane = first + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            for part in [[0, 1, 2], [0, 2, 3]] {
                put_turned(part.map(|j| batch.corner(j, lane)), tags[lane], &mut self.tiles.scratch.turned);
            }
        }
        let mut live = l.without(l.without(meant, apart), shape.flat);
        if l.bits(live) == 0 {
            return (0, 0);
        }
        for (to, v) in [(&mut t.x0, p.x0), (&mut t.x1, p.x1), (&mut t.y0, p.y0), (&mut t.y1, p.y1)] {
            l.store_i(&mut to[first..], v);
        }
        if SIZE == LARGE {
            self.wide_edges(t, first, &c);
            self.wide_plane(t, first, &c, &p, shape.thin);
            // Larger ones have no edges for a single window.
            return (l.bits(live), 0);
        }
        live = l.without(live, self.edges::<SIZE>(t, first, &c, &p));
        if l.bits(live) != 0 {
            self.plane::<SIZE>(t, first, &c, &p, shape.thin);
        }
        // One window of 32×16 pixels, which begins at any line.
        let last = l.shift_right::<5>(l.sub_i(p.x1, l.splat_i(1)));
        let below = l.add_i(l.and(p.y0, l.splat_i(!3)), l.splat_i(17));
        let one = l.both(l.eq_i(l.shift_right::<5>(p.x0), last), l.gt_i(below, p.y1));
        (l.bits(live), l.bits(one))
    }

    /// What the grid made of primitives.
    #[inline(always)]
    fn shape<const SIZE: u8>(&self, c: &Corners<L>) -> Shape<L> {
        let l = self.l;
        let off = each!(3; k => [l.sub_i(c.x[k + 1], c.x[0]), l.sub_i(c.y[k + 1], c.y[0])]);
        let [b, c2, d] = off;
        // A quadrangle by any difference, not by the place on the grid alone: its two halves have two planes.
        let same_place = l.both(l.eq_i(c.x[2], c.x[3]), l.eq_i(c.y[2], c.y[3]));
        let same_depth = l.eq_i(l.bits_of(c.z[2]), l.bits_of(c.z[3]));
        let is_triangle = l.both(l.both(same_place, same_depth), l.eq_i(c.packed[2], c.packed[3]));
        let zero = l.splat_i(0);
        let [x, y] = [l.max_i(c2[0], l.sub_i(zero, c2[0])), l.max_i(c2[1], l.sub_i(zero, c2[1]))];
        let diagonal = l.max_i(x, y);
        // Twice the areas of the triangles 012, 023, 013 and 123.
        if SIZE == SMALL {
            let (one, two) = (cross(l, b, c2), cross(l, c2, d));
            let (three, sum) = (cross(l, b, d), l.add_i(one, two));
            let any = l.or(l.or(one, two), l.or(three, l.sub_i(sum, three)));
            let thin = l.gt_i(l.shift_up::<3>(diagonal), l.min_i(one, two));
            let thin_one = l.gt_i(l.shift_up::<3>(diagonal), one);
            let thin = l.either(l.both(is_triangle, thin_one), l.without(thin, is_triangle));
            return Shape { bad: l.gt_i(zero, any), flat: l.eq_i(sum, zero), thin, is_triangle };
        }
        let (one, two) = (cross_d(l, b, c2), cross_d(l, c2, d));
        let (three, sum) = (cross_d(l, b, d), l.add_d(one, two));
        let o = l.splat_d(0.0);
        let least = l.min_d(l.min_d(one, two), l.min_d(three, l.sub_d(sum, three)));
        let flat = l.without(l.first(16), l.either(l.gt_d(sum, o), l.gt_d(o, sum)));
        let eight = l.mul_d(l.int_to_d(diagonal), l.splat_d(8.0));
        let thin = l.either(
            l.both(is_triangle, l.gt_d(eight, one)),
            l.without(l.gt_d(eight, l.min_d(one, two)), is_triangle),
        );
        Shape { bad: l.gt_d(o, least), flat, thin, is_triangle }
    }
}

/// What the grid made of primitives.
struct Shape<L: Wide> {
    /// Turned over, or not convex.
    bad: L::M,
    /// Without area.
    flat: L::M,
    /// The first triangle, or either of a quadrangle, is lower than some six grid steps over the diagonal: so
    /// low that the half step by which corners are moved may tilt its plane by more than bounds allow for.
    thin: L::M,
    is_triangle: L::M,
}

/// Twice the area between two ways of at most 40 pixels: exact in 32 bits.
#[inline(always)]
fn cross<L: Wide>(l: L, a: [L::I; 2], b: [L::I; 2]) -> L::I {
    l.sub_i(l.mul_i(a[0], b[1]), l.mul_i(a[1], b[0]))
}
/// The same of any length, exact in doubles.
#[inline(always)]
fn cross_d<L: Wide>(l: L, a: [L::I; 2], b: [L::I; 2]) -> L::D {
    let (p, q) = (l.mul_d(l.int_to_d(a[0]), l.int_to_d(b[1])), l.mul_d(l.int_to_d(a[1]), l.int_to_d(b[0])));
    l.sub_d(p, q)
}
#[inline(always)]
fn bit<L: Wide>(l: L, m: L::M, k: usize) -> L::I {
    l.pick_i(m, l.splat_i(1 << k), l.splat_i(0))
}
/// What the snap took from a coordinate, 1024ths of a step.
#[inline(always)]
fn beyond<L: Wide>(l: L, v: L::D, snapped: L::I) -> L::I {
    l.nearest(l.mul_d(l.sub_d(v, l.int_to_d(snapped)), l.splat_d(1024.0)))
}
/// Takes up to 16 out of a ring.
#[inline(always)]
fn take(ring: &mut Ring, count: usize) -> (Batch, [i32; 16]) {
    let (mut corners, mut tags) = ([[[0; 16]; 4]; 4], [0; 16]);
    for (to, column) in corners.as_flattened_mut().iter_mut().zip(&mut ring.values) {
        to.copy_from_slice(&column[..16]);
        column.copy_within(16..32, 0);
    }
    tags.copy_from_slice(&ring.tags[..16]);
    ring.tags.copy_within(16..32, 0);
    ring.count -= count;
    (Batch { corners, floor: [[0.0; 16]; 3], column: [0; 16], row: [0; 16] }, tags)
}

/// A triangle as it runs clockwise on the grid, unless it covers nothing there.
fn put_turned([a, b, c]: [Vertex; 3], tag: i32, to: &mut Vec<([Vertex; 3], i32)>) {
    match area([&a, &b, &c]) {
        0 => {}
        1.. => to.push(([a, b, c], tag)),
        _ => to.push(([a, c, b], tag)),
    }
}

/// Sixteen of a ring, as a piece of work of its own.
struct SetUp<'a, 'b, L> {
    draw: &'b mut Draw<'a, L>,
    size: u8,
    count: usize,
}

impl<M: Wide> Work for SetUp<'_, '_, M> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Draw { tiles, clusters, one_sided, skipped, .. } = self.draw;
        let mut draw = Draw { l, tiles, clusters, one_sided: *one_sided, skipped };
        match self.size {
            SMALL => draw.set_up::<SMALL>(self.count),
            MIDDLING => draw.set_up::<MIDDLING>(self.count),
            _ => draw.set_up::<LARGE>(self.count),
        }
    }
}

/// Triangles that were turned round.
struct SortTurned<'a, 'b, L> {
    draw: &'b mut Draw<'a, L>,
    some: Vec<([Vertex; 3], i32)>,
}

impl<M: Wide> Work for SortTurned<'_, '_, M> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Draw { tiles, clusters, one_sided, skipped, .. } = self.draw;
        let mut draw = Draw { l, tiles, clusters, one_sided: *one_sided, skipped };
        let (mut values, mut tags) = ([[0; 16]; 16], [0; 16]);
        for (i, (t, tag)) in self.some.iter().enumerate() {
            tags[i] = *tag;
            for j in 0..4 {
                let c = t[j.min(2)];
                let v = [c.x, c.y, c.z.to_bits() as i32, c.packed as i32];
                v.into_iter().enumerate().for_each(|(k, v)| values[4 * k + j][i] = v);
            }
        }
        for first in (0..self.some.len()).step_by(L::N) {
            let v = each!(4; j => each!(4; k => l.load_i(&values[4 * k + j][first..])));
            draw.sort(v, l.load_i(&tags[first..]), l.first(self.some.len() - first));
        }
        draw.set_up_full();
    }
}
