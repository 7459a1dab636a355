//! Color cubes over an image (Chamberlain, DeRose, Lischinski, Salesin and Snyder 1996, Section 3).
//!
//! Cubes come in order, the nearest first, and each goes *under* what a sample holds so far. Over is
//! associative (Porter and Duff 1984), so that is what the paper's quads drawn over each other from the back
//! give, and a sample that lets no more light through can be left alone.
//!
//! A sample meets a box where its ray does, by the planes of the box. The depths at which a ray passes planes
//! are found from the ray and the plane alone, the same for all boxes that share one, and they ascend along
//! the ray. Each depth belongs to one box of a grid: a wall of boxes has no crack and no seam, however it is
//! turned, and each sample meets one face of a box at most. Where a primitive is drawn its corners lie on the
//! pixel grid, by 1/362 pixel at most from where a ray has them. (The paper draws faces as quads, by graphics
//! hardware.)
//!
//! Cost: O(boxes + samples in the rectangles about them).

use std::ops::Range;

use rayon::prelude::*;

use super::{CubeFaces, Drawable, Options, StandIn, Target};
use crate::geometry::{Aabb, PrimId, Space, Vector, View};
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
            Band { first: band * rows, width, samples, depths, spans, clear: CLEAR }
        });
        let work = |mut band: Band<'_, [f32; 4], &[f32]>| {
            let mut rays = rays;
            for (eye, boxes) in copies {
                rays.eye = widened(*eye);
                for one in *boxes {
                    // Tested against the z-buffer, which the paper's cubes write as well. A full sample shows
                    // nothing more.
                    let under = |sample: &mut [f32; 4], face: usize| put_under(sample, one.faces.get(face));
                    band.meet(&rays, &one.bounds, |sample| sample[3] < FULL, under);
                }
            }
        };
        if threads <= 1 {
            bands.for_each(work);
        } else {
            bands.collect::<Vec<_>>().into_par_iter().for_each(work);
        }
    }
}

/// A face under what a sample holds: what is seen of it is the share that shows (Porter and Duff 1984).
#[inline(always)]
fn put_under(sample: &mut [f32; 4], face: [f32; 4]) {
    let left = sample[3];
    for channel in 0..3 {
        sample[channel] += left * face[channel];
    }
    sample[3] = left * (1.0 - face[3]);
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

    /// Columns and rows of a rectangle that no sample outside of which meets a box; it may stick out of the
    /// image.
    #[inline]
    fn rectangle<V: Vector>(&self, min: &[f64; 3], max: &[f64; 3]) -> [[f64; 2]; 2] {
        let (mut middle, mut reach) = ([0.0; 3], [0.0; 3]);
        for a in 0..3 {
            (middle[a], reach[a]) = ((min[a] + max[a]) * 0.5, (max[a] - min[a]) * 0.5);
        }
        let forward = self.rows[2];
        let dot = |row: &[f64; 3]| row[0] * middle[0] + row[1] * middle[1] + row[2] * middle[2];
        let spread =
            |row: &[f64; 3]| row[0].abs() * reach[0] + row[1].abs() * reach[1] + row[2].abs() * reach[2];
        let depth = dot(&forward);
        let nearest = depth - spread(&forward);
        if nearest <= self.near {
            return [[f64::NEG_INFINITY, f64::INFINITY]; 2];
        }
        let (inverse, most_inverse) = (1.0 / depth, 1.0 / nearest);
        let mut spans = [[self.half[0]; 2], [self.half[1]; 2]];
        for (axis, row) in self.rows[..V::AXES - 1].iter().enumerate() {
            // A point `middle + d` lies at `(row · middle + row · d) / (depth + forward · d)`, which differs
            // from the middle's place `at` by `(row − at · forward) · d / (depth + forward · d)`.
            let at = dot(row) * inverse;
            let slope = std::array::from_fn(|a| row[a] - at * forward[a]);
            let most = spread(&slope) * most_inverse;
            let sign = if axis == 0 { 1.0 } else { -1.0 };
            let (center, reach) = (self.half[axis] * (1.0 + sign * at), self.half[axis] * most);
            spans[axis] = [center - reach, center + reach];
        }
        spans
    }

    /// View depth at which a sample's ray enters a box (relative to the eye), and the number of the face.
    #[inline(always)]
    fn enter<V: Vector>(
        &self,
        column: f64,
        row: f64,
        min: &[f64; 3],
        max: &[f64; 3],
    ) -> Option<(f64, usize)> {
        let (mut enters, mut leaves, mut face) = (f64::NEG_INFINITY, f64::INFINITY, 0);
        // Flatland's third is not asked.
        let along: [f64; 3] =
            std::array::from_fn(|a| self.origin[a] + column * self.right[a] + row * self.down[a]);
        // All at once, as one division of several numbers.
        let inverse = along.map(|along| 1.0 / along);
        for a in 0..V::AXES {
            if along[a] == 0.0 {
                // The ray stays between two planes for ever, or never is: the upper one is the next box's.
                if min[a] > 0.0 || max[a] <= 0.0 {
                    return None;
                }
                continue;
            }
            let (low, high) = (min[a] * inverse[a], max[a] * inverse[a]);
            let is_up = along[a] > 0.0;
            let (first, last) = if is_up { (low, high) } else { (high, low) };
            let is_later = first > enters;
            enters = if is_later { first } else { enters };
            face = if is_later { 2 * a + usize::from(!is_up) } else { face };
            leaves = if last < leaves { last } else { leaves };
        }
        // Where it leaves is the next box's. A box about the eye has no face toward it.
        (enters < leaves && enters >= self.near).then_some((enters, face))
    }
}

/// Depths that boxes are tested against (`1/w`).
trait Depths {
    /// Whether a box that a sample's ray enters at this depth is before what is there.
    fn is_before(&mut self, at: usize, depth: f32) -> bool;
}

/// Those of an image, which stay.
impl Depths for &[f32] {
    #[inline(always)]
    fn is_before(&mut self, at: usize, depth: f32) -> bool {
        depth >= self[at]
    }
}

/// Those that boxes write.
impl Depths for &mut [f32] {
    fn is_before(&mut self, at: usize, depth: f32) -> bool {
        let is_before = depth >= self[at];
        if is_before {
            self[at] = depth;
        }
        is_before
    }
}

/// Rows of the image, with what is asked and changed there.
struct Band<'a, T, D> {
    /// Number of its first row.
    first: usize,
    width: usize,
    samples: &'a mut [T],
    depths: D,
    /// The samples of each row that are known; none where all are.
    spans: &'a mut [[u32; 2]],
    /// What the others are to be.
    clear: T,
}

/// How far the rectangle about a box is widened, pixels: more than its rounding.
const SLACK_PX: f64 = 1e-6;

/// The numbers of the samples of a row or column of so many whose centers lie in a span.
#[inline(always)]
fn samples_in([low, high]: [f64; 2], count: usize) -> Range<usize> {
    let first = (low - 0.5 - SLACK_PX).clamp(0.0, count as f64);
    let past = (high + 0.5 + SLACK_PX).clamp(0.0, count as f64);
    // Rounded up and down by the conversion: functions of the standard library are calls on machines that
    // lack the instruction.
    let up = first as usize + usize::from((first as usize as f64) < first);
    up..past as usize
}

impl<T: Copy, D: Depths> Band<'_, T, D> {
    /// Makes the samples of a row known as far as they are not.
    #[inline]
    fn know(&mut self, row: usize, columns: &Range<usize>) {
        let Some(span) = self.spans.get_mut(row) else { return };
        let [first, past] = span.map(|c| c as usize);
        if first <= columns.start && columns.end <= past || columns.is_empty() {
            return;
        }
        let there = &mut self.samples[row * self.width..][..self.width];
        let (low, high) = match first == past {
            true => (columns.start, columns.end),
            false => (first.min(columns.start), past.max(columns.end)),
        };
        // In between as well, so that a span is enough to tell.
        let (known, past) = if first == past { (high, high) } else { (first, past) };
        there[low..known].fill(self.clear);
        there[past..high].fill(self.clear);
        *span = [low as u32, high as u32];
    }

    /// Finds the samples whose rays meet a box before the image, but for those that are skipped: each
    /// with the number of the face by which it is entered.
    #[inline]
    fn meet<V: Vector>(
        &mut self,
        rays: &Rays,
        bounds: &Aabb<V>,
        skips: impl Fn(&T) -> bool,
        mut hit: impl FnMut(&mut T, usize),
    ) {
        let (mut min, mut max) = (widened(bounds.min), widened(bounds.max));
        for a in 0..V::AXES {
            min[a] -= rays.eye[a];
            max[a] -= rays.eye[a];
        }
        let [across, down] = rays.rectangle::<V>(&min, &max);
        let first = self.first as f64;
        let rows = self.samples.len() / self.width.max(1);
        let columns = samples_in(across, self.width);
        for row in samples_in([down[0] - first, down[1] - first], rows) {
            self.know(row, &columns);
            for column in columns.clone() {
                let at = row * self.width + column;
                if skips(&self.samples[at]) {
                    continue;
                }
                let place = (column as f64, (row + self.first) as f64);
                let Some((depth, face)) = rays.enter::<V>(place.0, place.1, &min, &max) else { continue };
                let depth = (1.0 / depth) as f32;
                if self.depths.is_before(at, depth) {
                    hit(&mut self.samples[at], face);
                }
            }
        }
    }
}

/// Those at which samples meet the last box, whatever is there.
struct Last<'a>(&'a mut [f32]);

impl Depths for Last<'_> {
    fn is_before(&mut self, at: usize, depth: f32) -> bool {
        self.0[at] = depth;
        true
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
    let mut band = Band { first: 0, width, samples: left, depths: Last(depth), spans: &mut [], clear: 1.0 };
    band.meet(rays, bounds, |left| *left < FULL, |left, face| *left *= 1.0 - faces.get(face)[3]);
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
        let Some(one) = one else { break };
        let (samples, depths) = (&mut colors[..], &mut image.depth[..]);
        let (width, spans) = (view.width as usize, &mut [][..]);
        let mut band = Band { first: 0, width, samples, depths, spans, clear: background };
        band.meet(
            &rays,
            &one.bounds,
            |_| false,
            |there, face| {
                let [r, g, b, alpha] = one.faces.get(face);
                *there = std::array::from_fn(|c| [r, g, b][c] + (1.0 - alpha) * there[c]);
            },
        );
    }
    colors
}
