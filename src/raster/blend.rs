//! Color cubes over an image (Chamberlain, DeRose, Lischinski, Salesin and Snyder 1996, Section 3).
//!
//! Cubes come in order, the nearest first, and each goes *under* what a sample holds so far. Over is
//! associative (Porter and Duff 1984), so that is what the paper's quads drawn over each other from the back
//! give, and a sample that lets no more light through can be left alone.
//!
//! A sample meets a box where its ray does, by the planes of the box. The inverse of the depth at which a
//! ray passes a plane is a number of the ray times a number of the plane, the same for all boxes that share
//! the plane, and descends along the ray. So each depth belongs to one box of a grid: a wall of boxes has no
//! crack and no seam, however it is turned, and each sample meets one face of a box at most. Where a
//! primitive is drawn its corners lie on the pixel grid, by 1/362 pixel at most from where a ray has them.
//! (The paper draws faces as quads, by graphics hardware.)
//!
//! Eight samples are asked at a time, on lanes; the same bits come out on every machine.
//!
//! Cost: O(boxes + samples in the rectangles about them).

use std::ops::Range;

use rayon::prelude::*;

use super::simd::Isa;
use super::tiles::wide::{Wide, Work, each, run};
use super::{CubeFaces, Drawable, Options, StandIn, Target};
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector, View};
use crate::scene::{Scene, Surfaces};

/// A sample is full, and no more is put under it, when less than so much of the light comes through: a
/// quarter of a step of the 256 that are shown.
pub(super) const FULL: f32 = 1.0 / 1024.0;

/// What a sample holds where there is no box.
const CLEAR: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

/// Boxes of a space that is moved, with where the eye is in it.
type Moved<'a, V> = (V, &'a [StandIn<V>]);

/// What lies over an image, a sample a pixel.
#[derive(Clone, Debug, Default)]
pub struct Canvas {
    width: usize,
    /// Linear color, premultiplied, and the share of what is behind that shows. What is outside of the span
    /// of its row is of an earlier image.
    samples: Vec<[f32; 4]>,
    /// For each row the samples that a box came near: most views of few boxes leave most of an image alone.
    spans: Vec<[u32; 2]>,
}

/// By what shows of them.
impl PartialEq for Canvas {
    fn eq(&self, other: &Self) -> bool {
        self.width == other.width && self.samples().eq(other.samples())
    }
}

impl Canvas {
    /// Nothing over an image of the view's size.
    pub fn clear<S: Space>(&mut self, view: &View<S>) {
        self.width = view.width as usize;
        self.samples.resize(self.width * view.height as usize, CLEAR);
        self.spans.clear();
        self.spans.resize(view.height as usize, [0; 2]);
    }
    /// Nothing over an image of no size.
    pub fn empty(&mut self) {
        self.width = 0;
        self.spans.clear();
    }
    /// Linear color, premultiplied, and the share of what is behind that shows, of each pixel row by row.
    pub fn samples(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        let of = |row: usize, column: usize| {
            let [first, past] = self.spans[row].map(|c| c as usize);
            let is_known = (first..past).contains(&column);
            if is_known { self.samples[row * self.width + column] } else { CLEAR }
        };
        (0..self.spans.len()).flat_map(move |row| (0..self.width).map(move |column| of(row, column)))
    }
    /// Puts boxes under what there is, the nearest first, but for what the image hides of them. Boxes do not
    /// overlap. The image is left as it is.
    pub fn composite<S: Space>(
        &mut self,
        boxes: &[StandIn<S::Vector>],
        image: &Target,
        view: &View<S>,
        options: &Options,
    ) {
        self.composite_copies(&[(view.eye.position, boxes)], image, view, options);
    }
    /// The same with boxes of several spaces that differ by translations alone: each list with where the eye
    /// of the view is in its space. So boxes that are far from everything but the eye are as exact as others.
    pub fn composite_copies<S: Space>(
        &mut self,
        copies: &[Moved<'_, S::Vector>],
        image: &Target,
        view: &View<S>,
        options: &Options,
    ) {
        let rays = Rays::new(view);
        let threads = options.thread_count();
        // A band of rows is one thread's, which keeps the order; so the bytes do not depend on their number.
        let rows = (view.height as usize).div_ceil(threads.max(1)).max(1);
        let pixels = (rows * self.width).max(1);
        let width = self.width;
        let parts = self.samples.chunks_mut(pixels).zip(self.spans.chunks_mut(rows)).enumerate();
        let bands = parts.map(|(band, (samples, spans))| {
            let depths = &image.depth[band * pixels..][..samples.len()];
            let rows = Rows { first: band * rows, count: spans.len(), width };
            Laid { rays, copies, rows, under: Under { width, samples, depths, spans, faces: [CLEAR; 3] } }
        });
        let work = |band: Laid<'_, S::Vector>| run(Isa::best(), band);
        if threads <= 1 {
            bands.for_each(work);
        } else {
            bands.collect::<Vec<_>>().into_par_iter().for_each(work);
        }
    }
}

/// Lists of boxes laid under a band of rows.
struct Laid<'a, V> {
    rays: Rays,
    copies: &'a [Moved<'a, V>],
    rows: Rows,
    under: Under<'a>,
}

impl<V: Vector> Work for Laid<'_, V> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(mut self, l: L) {
        for (eye, boxes) in self.copies {
            self.rays.eye = widened(*eye);
            meet(l, &self.rays, &self.rows, boxes, &mut self.under);
        }
    }
}

/// The rays of a view's samples. Flatland has no third axis and no rows: they are 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rays {
    /// Image axes across and up, as the projection scales them, and the line of sight.
    rows: [[f64; 3]; 3],
    eye: [f64; 3],
    near: f64,
    /// The direction of a sample is `origin + column · right + row · down`: along it the view depth grows by
    /// as much as is multiplied with it.
    origin: [f64; 3],
    right: [f64; 3],
    down: [f64; 3],
    /// Half the image, pixels.
    half: [f64; 2],
}

fn widened<V: Vector>(v: V) -> [f64; 3] {
    std::array::from_fn(|a| if a < V::AXES { f64::from(v.get(a)) } else { 0.0 })
}

impl Rays {
    pub(super) fn new<S: Space>(view: &View<S>) -> Self {
        let (projection, axes) = (view.projection(), S::Vector::AXES);
        let half = [f64::from(view.width) * 0.5, f64::from(view.height) * 0.5];
        let mut rays = Self {
            rows: [[0.0; 3], [0.0; 3], widened(projection.rows[axes - 1])],
            eye: widened(projection.eye),
            near: f64::from(view.eye.near),
            origin: widened(projection.rows[axes - 1]),
            right: [0.0; 3],
            down: [0.0; 3],
            half,
        };
        for (axis, &half) in half.iter().enumerate().take(axes - 1) {
            let row = widened(projection.rows[axis]);
            rays.rows[axis] = row;
            let length = row.iter().map(|c| c * c).sum::<f64>();
            // Rows are square to each other, so dividing by the squared length undoes their scale.
            let sign = if axis == 0 { 1.0 } else { -1.0 };
            let step = row.map(|c| sign * c / (length * half));
            // From the middle of the image to the center of its first pixel.
            (0..3).for_each(|a| rays.origin[a] += step[a] * (0.5 - half));
            *(if axis == 0 { &mut rays.right } else { &mut rays.down }) = step;
        }
        rays
    }

    /// The directions of eight samples.
    #[inline(always)]
    fn along<L: Wide>(&self, l: L, columns: L::F, rows: L::F) -> [L::F; 3] {
        let splat = each!(3; a => {
            let [origin, right, down] = [self.origin[a], self.right[a], self.down[a]];
            [l.splat(origin as f32), l.splat(right as f32), l.splat(down as f32)]
        });
        each!(3; a => {
            let [origin, right, down] = splat[a];
            l.add(l.add(origin, l.mul(columns, right)), l.mul(rows, down))
        })
    }
}

/// The inverse of where planes lie that are square to an axis, from the eye. What is at the eye belongs to
/// the lower side, as a box does not have its upper planes.
#[inline(always)]
fn inverse<L: Wide>(l: L, place: L::F, is_above: L::M) -> L::F {
    // Not infinite, since a ray along the plane multiplies it with 0.
    let size = l.min(l.div(l.splat(1.0), l.abs(place)), l.splat(f32::MAX));
    l.pick(is_above, size, l.sub(l.splat(0.0), size))
}

/// The sum of products.
#[inline(always)]
fn dot<L: Wide>(l: L, a: &[L::F; 3], b: &[L::F; 3]) -> L::F {
    l.add(l.mul(a[0], b[0]), l.add(l.mul(a[1], b[1]), l.mul(a[2], b[2])))
}

/// How far the rectangle about a box is widened, pixels: more than places in it are rounded by, some 2⁻²² of
/// at most 16,384 pixels.
const SLACK_PX: f32 = 1.0 / 64.0;

/// Eight boxes, as rays meet them: along each axis the inverse depth of a ray is what is here times the ray's
/// direction.
#[derive(Clone, Copy, Default)]
struct Eight {
    /// Where one is entered, and what is added to that: if the eye is between the planes, more than any
    /// depth.
    enters: [[f32; 8]; 3],
    between: [[f32; 8]; 3],
    /// Where it is left: by the farther plane, or by that of both which is ahead.
    leaves: [[[f32; 8]; 2]; 3],
    /// Those of which the upper face is toward the eye, a bit each.
    upper: [u32; 3],
    /// The first column and row of the samples that may meet it, and those past the last.
    first: [[i32; 8]; 2],
    past: [[i32; 8]; 2],
}

impl Eight {
    /// Eight boxes at most, relative to the eye.
    #[inline(always)]
    fn new<L: Wide, V: Vector>(l: L, rays: &Rays, image: &Rows, boxes: &[StandIn<V>]) -> Self {
        // Flatland's third axis has the eye between the planes.
        let (mut low, mut high) = ([[-1.0; 8]; 3], [[1.0; 8]; 3]);
        for (k, one) in boxes.iter().enumerate().take(8) {
            for (a, (low, high)) in low.iter_mut().zip(&mut high).enumerate().take(V::AXES) {
                (low[k], high[k]) = (one.bounds.min.get(a), one.bounds.max.get(a));
            }
        }
        let eye = each!(3; a => l.splat_d(rays.eye[a]));
        let min = each!(3; a => l.narrow(l.sub_d(l.to_d(l.load(&low[a])), eye[a])));
        let max = each!(3; a => l.narrow(l.sub_d(l.to_d(l.load(&high[a])), eye[a])));
        let mut eight = Self::default();
        eight.part(l, &min, &max);
        eight.find(l, rays, image, (&min, &max));
        eight
    }

    /// The planes, by where they are.
    #[inline(always)]
    fn part<L: Wide>(&mut self, l: L, min: &[L::F; 3], max: &[L::F; 3]) {
        let (zero, most) = (l.splat(0.0), l.splat(f32::MAX));
        for (a, (&min, &max)) in min.iter().zip(max).enumerate() {
            let (is_above, is_not_below) = (l.gt(min, zero), l.gt(max, zero));
            let (low, high) = (inverse(l, min, is_above), inverse(l, max, is_not_below));
            l.store(&mut self.enters[a], l.pick(is_above, low, l.pick(is_not_below, zero, high)));
            l.store(&mut self.between[a], l.pick(is_above, zero, l.pick(is_not_below, most, zero)));
            l.store(&mut self.leaves[a][0], l.pick(is_above, high, low));
            l.store(&mut self.leaves[a][1], l.pick(is_not_below, high, low));
            self.upper[a] = !l.bits(is_not_below);
        }
    }

    /// The rectangles that no sample outside of which meets a box.
    #[inline(always)]
    fn find<L: Wide>(&mut self, l: L, rays: &Rays, image: &Rows, (min, max): (&[L::F; 3], &[L::F; 3])) {
        let (half, zero, one) = (l.splat(0.5), l.splat(0.0), l.splat(1.0));
        let middle = each!(3; a => l.mul(l.add(min[a], max[a]), half));
        let reach = each!(3; a => l.mul(l.sub(max[a], min[a]), half));
        let forward = each!(3; a => l.splat(rays.rows[2][a] as f32));
        let depth = dot(l, &forward, &middle);
        let nearest = l.sub(depth, dot(l, &each!(3; a => l.abs(forward[a])), &reach));
        let is_ahead = l.gt(nearest, l.splat(rays.near as f32));
        let (inverse, most) = (l.div(one, depth), l.div(one, nearest));
        for axis in 0..2 {
            let count = l.splat([image.width, image.count][axis] as f32);
            let offset = l.splat([0.0, image.first as f32][axis]);
            let half = rays.half[axis] as f32;
            let row = each!(3; a => l.splat(rays.rows[axis][a] as f32));
            // A point `middle + d` lies at `(row · middle + row · d) / (depth + forward · d)`, which differs
            // from the middle's place by `(row − place · forward) · d / (depth + forward · d)`.
            let place = l.mul(dot(l, &row, &middle), inverse);
            let slope = each!(3; a => l.abs(l.sub(row[a], l.mul(place, forward[a]))));
            let spread = dot(l, &slope, &reach);
            let sign = if axis == 0 { half } else { -half };
            let center = l.sub(l.add(l.splat(half), l.mul(l.splat(sign), place)), offset);
            let reach = l.add(l.mul(l.splat(half), l.mul(spread, most)), l.splat(SLACK_PX));
            let low = l.sub(l.sub(center, reach), l.splat(0.5));
            let high = l.add(l.add(center, reach), l.splat(0.5));
            let low = l.pick(is_ahead, l.max(zero, l.min(count, low)), zero);
            let high = l.pick(is_ahead, l.max(zero, l.min(count, high)), count);
            l.store_i(&mut self.first[axis], l.ceil(low));
            l.store_i(&mut self.past[axis], l.truncate(high));
        }
    }

    /// Which of eight rays enter a box, the inverse depths, and the axes along which.
    #[inline(always)]
    fn of_rays<L: Wide>(&self, l: L, k: usize, along: &[L::F; 3], most: L::F) -> (L::M, L::F, L::I) {
        let (mut enters, mut leaves, mut axis) = (l.splat(f32::MAX), l.splat(0.0), l.splat_i(0));
        for (a, &along) in along.iter().enumerate() {
            let enter = l.add(l.mul(along, l.splat(self.enters[a][k])), l.splat(self.between[a][k]));
            let is_later = l.gt(enters, enter);
            enters = l.pick(is_later, enter, enters);
            axis = l.pick_i(is_later, l.splat_i(a as i32), axis);
            let [first, second] = self.leaves[a];
            leaves = l.max(l.mul(along, l.splat(first[k])), leaves);
            leaves = l.max(l.mul(along, l.splat(second[k])), leaves);
        }
        // Where it leaves is the next box's. A box about the eye has no face toward it.
        (l.both(l.gt(enters, leaves), l.ge(most, enters)), enters, axis)
    }
}

/// Rows of an image.
struct Rows {
    /// Number of the first, how many, and pixels in each.
    first: usize,
    count: usize,
    width: usize,
}

/// What is done with samples whose rays meet boxes.
trait Samples {
    /// The next box has these faces, and turns these toward the eye, one an axis.
    fn next(&mut self, faces: &CubeFaces, toward: [usize; 3]);
    /// Some samples of a row may be met.
    #[inline(always)]
    fn near(&mut self, _row: usize, _columns: &Range<usize>) {}
    /// A sample meets the box at a depth, `1/w`, by its face along an axis.
    fn meet(&mut self, at: usize, depth: f32, axis: usize);
}

/// Samples are asked in blocks.
const BLOCK: [usize; 2] = [4, 2];

/// Finds the samples whose rays meet boxes, box by box.
#[inline(always)]
fn meet<L: Wide, V: Vector>(l: L, rays: &Rays, image: &Rows, boxes: &[StandIn<V>], to: &mut impl Samples) {
    let most = l.splat((1.0 / rays.near) as f32);
    // Lanes go across a block and then down.
    let right = l.load(&[0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]);
    let below = l.load(&[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    let (mut depths, mut axes) = ([0.0; 8], [0; 8]);
    for some in boxes.chunks(8) {
        let eight = Eight::new(l, rays, image, some);
        for (k, one) in some.iter().enumerate() {
            let columns = eight.first[0][k] as usize..eight.past[0][k] as usize;
            let rows = eight.first[1][k] as usize..eight.past[1][k] as usize;
            if columns.is_empty() || rows.is_empty() {
                continue;
            }
            to.next(&one.faces, each!(3; a => 2 * a + (eight.upper[a] >> k & 1) as usize));
            for row in rows.clone() {
                to.near(row, &columns);
            }
            let past_column = l.splat(columns.end as f32);
            let past_row = l.splat((rows.end + image.first) as f32);
            for row in rows.step_by(BLOCK[1]) {
                let y = l.add(l.splat((row + image.first) as f32), below);
                for column in columns.clone().step_by(BLOCK[0]) {
                    let x = l.add(l.splat(column as f32), right);
                    let along = rays.along(l, x, y);
                    let (is_met, enters, axis) = eight.of_rays(l, k, &along, most);
                    let is_inside = l.both(l.gt(past_column, x), l.gt(past_row, y));
                    let mut bits = l.bits(l.both(is_met, is_inside));
                    l.store(&mut depths, enters);
                    l.store_i(&mut axes, axis);
                    while bits != 0 {
                        let lane = bits.trailing_zeros() as usize & 7;
                        bits &= bits - 1;
                        let at = (row + lane / BLOCK[0]) * image.width + column + lane % BLOCK[0];
                        to.meet(at, depths[lane], axes[lane] as usize);
                    }
                }
            }
        }
    }
}

/// Samples under which boxes are put, unless the image hides them.
struct Under<'a> {
    width: usize,
    samples: &'a mut [[f32; 4]],
    depths: &'a [f32],
    /// The samples of each row that are known; the others are to be cleared.
    spans: &'a mut [[u32; 2]],
    /// Color and coverage along each axis.
    faces: [[f32; 4]; 3],
}

impl Samples for Under<'_> {
    #[inline(always)]
    fn next(&mut self, faces: &CubeFaces, toward: [usize; 3]) {
        for (to, face) in self.faces.iter_mut().zip(toward) {
            *to = faces.get(face);
        }
    }
    /// Makes the samples of a row known as far as they are not.
    #[inline(always)]
    fn near(&mut self, row: usize, columns: &Range<usize>) {
        let [first, past] = self.spans[row].map(|c| c as usize);
        if first <= columns.start && columns.end <= past {
            return;
        }
        let there = &mut self.samples[row * self.width..][..self.width];
        let (low, high) = match first == past {
            true => (columns.start, columns.end),
            false => (first.min(columns.start), past.max(columns.end)),
        };
        // In between as well, so that a span is enough to tell.
        let (known, past) = if first == past { (high, high) } else { (first, past) };
        there[low..known].fill(CLEAR);
        there[past..high].fill(CLEAR);
        self.spans[row] = [low as u32, high as u32];
    }
    /// A face under what a sample holds: what is seen of it is the share that shows (Porter and Duff 1984).
    #[inline(always)]
    fn meet(&mut self, at: usize, depth: f32, axis: usize) {
        let sample = &mut self.samples[at];
        let left = sample[3];
        // Tested against the z-buffer, which the paper's cubes write as well. A full sample shows nothing
        // more.
        if left < FULL || depth < self.depths[at] {
            return;
        }
        let [r, g, b, alpha] = self.faces[axis];
        *sample = [sample[0] + left * r, sample[1] + left * g, sample[2] + left * b, left * (1.0 - alpha)];
    }
}

/// Samples of which boxes take light.
struct Dimmed<'a> {
    left: &'a mut [f32],
    depth: &'a mut [f32],
    through: [f32; 3],
}

impl Samples for Dimmed<'_> {
    #[inline(always)]
    fn next(&mut self, faces: &CubeFaces, toward: [usize; 3]) {
        for (to, face) in self.through.iter_mut().zip(toward) {
            *to = 1.0 - faces.get(face)[3];
        }
    }
    #[inline(always)]
    fn meet(&mut self, at: usize, depth: f32, axis: usize) {
        if self.left[at] >= FULL {
            self.left[at] *= self.through[axis];
            self.depth[at] = depth;
        }
    }
}

/// A box, and what it is put before, over or behind.
struct One<'a, V, T> {
    rays: &'a Rays,
    rows: Rows,
    one: StandIn<V>,
    to: T,
}

impl<V: Vector, T: Samples> Work for One<'_, V, T> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(mut self, l: L) {
        meet(l, self.rays, &self.rows, std::slice::from_ref(&self.one), &mut self.to);
    }
}

/// Takes off the light that comes through each sample of an image what a box behind all others keeps, and
/// notes where it is entered, but for samples that are full. `left`, `depth`: of each sample, row by row.
pub(super) fn dim<V: Vector>(
    rays: &Rays,
    width: usize,
    bounds: &Aabb<V>,
    faces: &CubeFaces,
    (left, depth): (&mut [f32], &mut [f32]),
) {
    let rows = Rows { first: 0, count: left.len() / width.max(1), width };
    let one = StandIn { node: NodeId(0), bounds: *bounds, faces: *faces, after: 0 };
    run(Isa::best(), One { rays, rows, one, to: Dimmed { left, depth, through: [1.0; 3] } });
}

/// Samples over which boxes are put, which write their depths.
struct Over<'a> {
    colors: &'a mut [[f32; 3]],
    depths: &'a mut [f32],
    faces: [[f32; 4]; 3],
}

impl Samples for Over<'_> {
    #[inline(always)]
    fn next(&mut self, faces: &CubeFaces, toward: [usize; 3]) {
        for (to, face) in self.faces.iter_mut().zip(toward) {
            *to = faces.get(face);
        }
    }
    #[inline(always)]
    fn meet(&mut self, at: usize, depth: f32, axis: usize) {
        if depth < self.depths[at] {
            return;
        }
        self.depths[at] = depth;
        let ([r, g, b, alpha], [red, green, blue]) = (self.faces[axis], self.colors[at]);
        let through = 1.0 - alpha;
        self.colors[at] = [r + through * red, g + through * green, b + through * blue];
    }
}

/// The image of primitives and boxes drawn in the order of a list, the farthest first: each box goes over
/// what is there and writes its depths, so that what comes later and is farther is lost (Section 5.1). Light
/// comes through nothing but boxes. Linear colors, row by row; `color` is that of a primitive.
pub fn draw_in_order<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    (prims, boxes): (&[PrimId], &[StandIn<S::Vector>]),
    background: [f32; 3],
    color: impl Fn(PrimId) -> [f32; 3],
) -> Vec<[f32; 3]> {
    let surfaces = Surfaces { solid: true, ..Surfaces::default() };
    let options = Options { surfaces, ..Options::default() };
    let (mut image, rays) = (Target::new(view), Rays::new(view));
    let mut colors = vec![background; image.depth.len()];
    let mut next = 0;
    let ends = boxes.iter().map(|one| (one.after as usize, Some(one))).chain([(prims.len(), None)]);
    for (end, one) in ends {
        if end > next {
            S::draw(&mut image, scene, view, &prims[next..end], &options);
            // What shows of these is told by their items, which are taken off again.
            for (color_there, item) in colors.iter_mut().zip(&mut image.item) {
                if *item != Target::NONE {
                    *color_there = color(PrimId(*item));
                    *item = Target::NONE;
                }
            }
            next = end;
        }
        let Some(&one) = one else { break };
        let (colors, depths, width) = (&mut colors[..], &mut image.depth[..], view.width as usize);
        let rows = Rows { first: 0, count: view.height as usize, width };
        let to = Over { colors, depths, faces: [CLEAR; 3] };
        run(Isa::best(), One { rays: &rays, rows, one, to });
    }
    colors
}
