//! The view frustum and its conservative box test.

use super::{Aabb, Projection, Vector};

/// The planes of a view volume, relative to the eye: `n·(x − eye) + d ≥ 0` inside, `n` of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum<V> {
    /// Position of the eye.
    pub eye: V,
    normals: [V; 6],
    offsets: [f32; 6],
    /// The same by axes, for all planes at a time; the last ones repeat the first.
    by_axis: [[f32; 8]; 3],
    offsets_of_all: [f32; 8],
}

/// The result of one box against one plane, with its operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneTest {
    /// Number of the plane, see [`Frustum::plane_name`].
    pub plane: u8,
    /// Signed distance of the box corner that lies deepest inside the plane, world units.
    pub far_corner: f32,
    /// Signed distance of the opposite corner, world units.
    pub near_corner: f32,
    /// Bound on the rounding error of either distance, world units.
    pub error: f32,
}

impl PlaneTest {
    /// The whole box is outside, whatever the rounding was.
    #[inline]
    pub fn is_outside(&self) -> bool {
        self.far_corner < -self.error
    }
    /// The whole box is inside.
    #[inline]
    pub fn is_inside(&self) -> bool {
        self.near_corner >= 0.0
    }
}

/// The result of a box against the planes of a frustum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrustumTest {
    /// Wholly outside one plane.
    Outside(PlaneTest),
    /// Neither proven outside nor inside; the bits are the planes that still cut the box.
    Partial(u8),
    /// Wholly inside every plane tested.
    Inside,
}

/// Rounding allowance: a distance is a difference (½ ulp), at most 3 products and 3 sums, and a
/// normal rounded twice; that is below 8 ulp of the sum of magnitudes. Twice that also covers the
/// rasterizer's own rounding of the same expression, so a primitive called outside never reaches a pixel.
const ERROR_ULPS: f32 = 16.0 * (f32::EPSILON * 0.5);

impl<V: Vector> Frustum<V> {
    /// Number of planes: 4 in flatland, 6 in space.
    pub const PLANES: usize = 2 * V::AXES;
    /// Mask of all planes.
    pub const ALL: u8 = (1u16 << Self::PLANES).wrapping_sub(1) as u8;

    pub(super) fn new(projection: &Projection<V>, near: f32, far: f32) -> Self {
        let forward = projection.rows[V::AXES - 1];
        let mut frustum = Self {
            eye: projection.eye,
            normals: [forward; 6],
            offsets: [0.0; 6],
            by_axis: [[0.0; 8]; 3],
            offsets_of_all: [0.0; 8],
        };
        let unit = |v: V| v * (1.0 / v.length());
        for axis in 0..V::AXES - 1 {
            frustum.normals[2 * axis] = unit(forward + projection.rows[axis]);
            frustum.normals[2 * axis + 1] = unit(forward - projection.rows[axis]);
        }
        let last = 2 * (V::AXES - 1);
        (frustum.normals[last], frustum.offsets[last]) = (forward, -near);
        (frustum.normals[last + 1], frustum.offsets[last + 1]) = (-forward, far);
        for lane in 0..8 {
            let plane = lane % Self::PLANES;
            frustum.offsets_of_all[lane] = frustum.offsets[plane];
            (0..V::AXES).for_each(|a| frustum.by_axis[a][lane] = frustum.normals[plane].get(a));
        }
        frustum
    }

    /// What plane `i < PLANES` is called.
    pub fn plane_name(i: usize) -> &'static str {
        let last = 2 * (V::AXES - 1);
        match i {
            _ if i == last => "near",
            _ if i == last + 1 => "far",
            0 => "left",
            1 => "right",
            2 => "bottom",
            _ => "top",
        }
    }
    /// Unit inward normal and offset of plane `i < PLANES`: inside is `n·(x − eye) + d ≥ 0`.
    pub fn plane(&self, i: usize) -> (V, f32) {
        (self.normals[i], self.offsets[i])
    }

    /// Tests a box against one plane, by the corners extreme along its normal.
    #[inline]
    pub fn test_plane(&self, plane: usize, bounds: &Aabb<V>) -> PlaneTest {
        let (normal, offset) = (self.normals[plane], self.offsets[plane]);
        let (mut far, mut near, mut size) = (offset, offset, offset.abs());
        for axis in 0..V::AXES {
            let n = normal.get(axis);
            let low = n * (bounds.min.get(axis) - self.eye.get(axis));
            let high = n * (bounds.max.get(axis) - self.eye.get(axis));
            far += low.max(high);
            near += low.min(high);
            size += low.abs().max(high.abs());
        }
        PlaneTest { plane: plane as u8, far_corner: far, near_corner: near, error: size * ERROR_ULPS }
    }

    /// Tests a box against the planes in `mask`. Conservative: the result is `Outside` only where the
    /// distance exceeds the bound on its rounding error.
    #[inline]
    pub fn test(&self, bounds: &Aabb<V>, mask: u8) -> FrustumTest {
        let mut cutting = 0;
        for plane in (0..Self::PLANES).filter(|p| mask >> p & 1 == 1) {
            let test = self.test_plane(plane, bounds);
            if test.is_outside() {
                return FrustumTest::Outside(test);
            }
            cutting |= u8::from(!test.is_inside()) << plane;
        }
        if cutting == 0 { FrustumTest::Inside } else { FrustumTest::Partial(cutting) }
    }

    /// Whether a box lies wholly outside one of the planes: the very arithmetic of [`Frustum::test`], all
    /// planes at a time.
    #[inline]
    pub fn excludes(&self, bounds: &Aabb<V>) -> bool {
        let (mut far, mut size) = (self.offsets_of_all, self.offsets_of_all.map(f32::abs));
        for axis in 0..V::AXES {
            let (min, max) =
                (bounds.min.get(axis) - self.eye.get(axis), bounds.max.get(axis) - self.eye.get(axis));
            for (lane, n) in self.by_axis[axis].into_iter().enumerate() {
                let (low, high) = (n * min, n * max);
                far[lane] += if low > high { low } else { high };
                size[lane] += if low.abs() > high.abs() { low.abs() } else { high.abs() };
            }
        }
        let mut outside = 0;
        for lane in 0..8 {
            outside |= u32::from(far[lane] < -(size[lane] * ERROR_ULPS));
        }
        outside != 0
    }

    /// [`Frustum::excludes`] of up to 16 boxes at a time, a bit each, by the same arithmetic: of two products
    /// with one normal the greater and the larger are known before they are made.
    #[inline(always)]
    pub fn excludes_each(&self, boxes: &[Aabb<V>]) -> u16 {
        let (mut low, mut high, mut size) = ([[0.0_f32; 16]; 3], [[0.0_f32; 16]; 3], [[0.0_f32; 16]; 3]);
        for (lane, bounds) in boxes.iter().take(16).enumerate() {
            for axis in 0..V::AXES {
                let eye = self.eye.get(axis);
                let (min, max) = (bounds.min.get(axis) - eye, bounds.max.get(axis) - eye);
                (low[axis][lane], high[axis][lane]) = (min, max);
                size[axis][lane] = if min.abs() > max.abs() { min.abs() } else { max.abs() };
            }
        }
        let mut outside = [false; 16];
        for plane in 0..Self::PLANES {
            let (mut far, mut sum) = ([self.offsets[plane]; 16], [self.offsets[plane].abs(); 16]);
            for axis in 0..V::AXES {
                let n = self.normals[plane].get(axis);
                let deepest = if n > 0.0 { &high[axis] } else { &low[axis] };
                for lane in 0..16 {
                    far[lane] += n * deepest[lane];
                    sum[lane] += n.abs() * size[axis][lane];
                }
            }
            for lane in 0..16 {
                outside[lane] |= far[lane] < -(sum[lane] * ERROR_ULPS);
            }
        }
        (0..boxes.len().min(16)).fold(0, |bits, lane| bits | u16::from(outside[lane]) << lane)
    }

    /// The corners of the volume: first the near ones, then the far ones, in the order of the image
    /// (flatland: left, right; space: lower left, lower right, upper right, upper left).
    pub fn corners(projection: &Projection<V>, near: f32, far: f32) -> Vec<V> {
        let signs: &[[f32; 2]] = if V::AXES == 2 {
            &[[-1.0, 0.0], [1.0, 0.0]]
        } else {
            &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        };
        let forward = projection.rows[V::AXES - 1];
        let ray = |s: &[f32; 2]| {
            // Rows are orthogonal; dividing by the squared length undoes their scale.
            (0..V::AXES - 1).fold(forward, |r, a| {
                let row = projection.rows[a];
                r + row * (s[a] / row.dot(row))
            })
        };
        [near, far]
            .iter()
            .flat_map(|&d| signs.iter().map(move |s| (d, s)))
            .map(|(d, s)| projection.eye + ray(s) * d)
            .collect()
    }
}
