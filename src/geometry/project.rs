//! A box on the screen: which pixels it can cover, and how near it comes.
//!
//! All arithmetic is f64 on the f32 rows of the [`Projection`], relative to the eye, exactly as the
//! rasterizer does it, so what separates a box from what is drawn of its contents is the rasterizer's grid
//! alone.

use super::{Aabb, Projection, Vector};

/// A rectangle of pixels, half-open: columns `x0..x1`, rows `y0..y1`, row 0 at the top. Holds those whose
/// centers it holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// Past the last column.
    pub x1: u32,
    /// First row; 0 in flatland.
    pub y0: u32,
    /// Past the last row; 1 in flatland.
    pub y1: u32,
}

impl PixelRect {
    /// Whether it holds no pixel.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }
    /// Number of pixels.
    #[inline]
    pub fn area(&self) -> u64 {
        u64::from(self.x1.saturating_sub(self.x0)) * u64::from(self.y1.saturating_sub(self.y0))
    }
    /// What both hold.
    #[inline]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            x1: self.x1.min(other.x1),
            y0: self.y0.max(other.y0),
            y1: self.y1.min(other.y1),
        }
    }
    /// The pixels whose centers lie within [`MARGIN_PX`] of the span `low..high` (x, then y), of an image of
    /// this size.
    #[inline]
    pub fn around(low: [f64; 2], high: [f64; 2], width: u32, height: u32) -> Self {
        // Rounded by hand: the functions of the standard library are calls on machines that lack the
        // instruction.
        let first = |v: f64, size: u32| {
            let v = (v - (0.5 + MARGIN_PX)).clamp(0.0, f64::from(size));
            v as u32 + u32::from(f64::from(v as u32) < v)
        };
        let past = |v: f64, size: u32| {
            let v = v + (MARGIN_PX - 0.5);
            if v < 0.0 { 0 } else { (v.min(f64::from(size)) as u32 + 1).min(size) }
        };
        Self {
            x0: first(low[0], width),
            x1: past(high[0], width),
            y0: first(low[1], height),
            y1: past(high[1], height),
        }
    }
}

/// Where a box falls in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Footprint {
    /// Part of the box is nearer than the near plane (or the eye is in it): no finite rectangle
    /// bounds it, so it must be taken as covering everything at depth `near`.
    CrossesNear,
    /// Wholly before the near plane, beyond the far plane or beside the image.
    Outside,
    /// All that is drawn of what the box holds lies in these pixels, and no nearer than that.
    Seen(BoxImage),
}

/// A box's image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxImage {
    /// The pixels whose centers it can cover; empty where it falls between them.
    pub pixels: PixelRect,
    /// Depth (`1/w`) that nothing in the box is nearer than.
    pub nearest: f32,
}

/// How far from a box's image a pixel's center may be covered by what the box holds: the rasterizer moves
/// vertices to its grid of 1/256 pixel, by 1/362 pixel at most, and a point of a moved triangle moves no
/// farther. The rest is for the rounding of f64 on both sides.
pub const MARGIN_PX: f64 = 1.0 / 256.0;
/// Bound on the rounding of a view depth in f64, relative to the distance from the eye: three products and
/// sums, twice.
const DEPTH_SLACK: f64 = 16.0 * f64::EPSILON;

/// Projects a box conservatively into an image of `width` by `height` pixels (`height` 1 in flatland).
#[inline]
pub fn project_box<V: Vector>(
    projection: &Projection<V>,
    bounds: &Aabb<V>,
    near: f32,
    far: f32,
    width: u32,
    height: u32,
) -> Footprint {
    let image_axes = V::AXES - 1;
    let half = [f64::from(width) * 0.5, f64::from(height) * 0.5];
    let clips = corner_clips(projection, bounds);
    let w = &clips[image_axes];
    let [nearest, farthest] = extremes(w);
    let slack = reach(projection, bounds) * DEPTH_SLACK;
    if farthest < f64::from(near) - slack || nearest > f64::from(far) + slack {
        return Footprint::Outside;
    }
    if nearest <= f64::from(near) + slack {
        return Footprint::CrossesNear;
    }
    let (mut x, mut y) = ([0.0; 8], [half[1]; 8]);
    for i in 0..8 {
        let inverse = 1.0 / w[i];
        x[i] = half[0] + clips[0][i] * inverse * half[0];
        if image_axes == 2 {
            y[i] = half[1] - clips[1][i] * inverse * half[1];
        }
    }
    let (across, down) = (extremes(&x), extremes(&y));
    let (low, high) = ([across[0], down[0]], [across[1], down[1]]);
    let beside = (0..2).any(|a| high[a] < -MARGIN_PX || low[a] > 2.0 * half[a] + MARGIN_PX);
    if beside {
        return Footprint::Outside;
    }
    let pixels = PixelRect::around(low, high, width, height);
    Footprint::Seen(BoxImage { pixels, nearest: depth_of(nearest - slack, near) })
}

/// The depth (`1/w`) that nothing in a box is nearer than; that of the near plane if the box reaches it.
#[inline]
pub fn nearest_depth<V: Vector>(projection: &Projection<V>, bounds: &Aabb<V>, near: f32) -> f32 {
    let clips = corner_clips(projection, bounds);
    let [nearest, _] = extremes(&clips[V::AXES - 1]);
    depth_of(nearest - reach(projection, bounds) * DEPTH_SLACK, near)
}

/// The depth (`1/w`) that nothing in a box is farther than, as far as it lies beyond the near plane.
#[inline]
pub fn farthest_depth<V: Vector>(projection: &Projection<V>, bounds: &Aabb<V>, near: f32) -> f32 {
    let clips = corner_clips(projection, bounds);
    let [_, farthest] = extremes(&clips[V::AXES - 1]);
    // A fragment's depth lies between those of its vertices, so the same slack bounds it on this side.
    depth_of(farthest + reach(projection, bounds) * DEPTH_SLACK, near)
}

/// `1/w` rounded to f32 as the rasterizer rounds it: rounding keeps the order, and what lies nearer than
/// `near` is cut off.
#[inline]
fn depth_of(w: f64, near: f32) -> f32 {
    (1.0 / w.max(f64::from(near))) as f32
}

/// A bound on the distance from the eye to any corner, each axis taken alone, world units.
#[inline]
fn reach<V: Vector>(projection: &Projection<V>, bounds: &Aabb<V>) -> f64 {
    let axis = |a: usize| {
        f64::from(
            (bounds.min.get(a) - projection.eye.get(a))
                .abs()
                .max((bounds.max.get(a) - projection.eye.get(a)).abs()),
        )
    };
    (0..V::AXES).map(axis).sum::<f64>() * f64::from(1.0 + f32::EPSILON)
}

/// Clip coordinates of the corners, a row each, in the order of [`Aabb::corner`]: sums of what each axis
/// adds. In flatland the four corners twice.
#[inline]
fn corner_clips<V: Vector>(projection: &Projection<V>, bounds: &Aabb<V>) -> [[f64; 8]; 3] {
    let mut clips = [[0.0; 8]; 3];
    let ends = |a: usize| {
        let eye = f64::from(projection.eye.get(a));
        [f64::from(bounds.min.get(a)) - eye, f64::from(bounds.max.get(a)) - eye]
    };
    let (x, y, z) = (ends(0), ends(1), if V::AXES == 3 { ends(2) } else { [0.0; 2] });
    for (row, clips) in projection.rows[..V::AXES].iter().zip(&mut clips) {
        let r: [f64; 3] = std::array::from_fn(|a| if a < V::AXES { f64::from(row.get(a)) } else { 0.0 });
        let (x, y, z) = (x.map(|e| r[0] * e), y.map(|e| r[1] * e), z.map(|e| r[2] * e));
        let xy = [x[0] + y[0], x[1] + y[0], x[0] + y[1], x[1] + y[1]];
        for (i, clip) in clips.iter_mut().enumerate() {
            *clip = xy[i & 3] + z[i >> 2];
        }
    }
    clips
}

/// The least and the greatest; none is NaN.
#[inline]
fn extremes(v: &[f64; 8]) -> [f64; 2] {
    // Halves against each other, which is SIMD; one after the other is not.
    let lesser = |a: f64, b: f64| if a < b { a } else { b };
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let (mut low, mut high) = (*v, *v);
    for half in [4, 2, 1] {
        for i in 0..half {
            (low[i], high[i]) = (lesser(low[i], low[i + half]), greater(high[i], high[i + half]));
        }
    }
    [low[0], high[0]]
}
