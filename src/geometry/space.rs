//! The two spaces, and the little arithmetic that both share.

use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

use glam::{Vec2, Vec3, Vec4};

use super::{orient2d, orient3d};

/// A vector of any number of axes. Holds only what the shared structures (boxes, planes, trees) need.
pub trait Vector:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<f32, Output = Self>
{
    /// Number of axes.
    const AXES: usize;
    /// Component along `axis`, `axis < AXES`.
    fn get(self, axis: usize) -> f32;
    /// A vector made axis by axis.
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self;
    /// Inner product.
    fn dot(self, other: Self) -> f32;
    /// Component-wise least.
    fn min(self, other: Self) -> Self;
    /// Component-wise greatest.
    fn max(self, other: Self) -> Self;
    /// Component-wise absolute value.
    fn abs(self) -> Self;
    /// Whether no component is NaN or infinite.
    fn is_finite(self) -> bool;
    /// The same number on every axis.
    fn splat(v: f32) -> Self {
        Self::from_fn(|_| v)
    }
    /// Euclidean length.
    fn length(self) -> f32 {
        self.dot(self).sqrt()
    }
}

macro_rules! vector {
    ($t:ty, $axes:literal) => {
        impl Vector for $t {
            const AXES: usize = $axes;
            #[inline]
            fn get(self, axis: usize) -> f32 {
                self.as_ref()[axis]
            }
            #[inline]
            fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
                Self::from_array(std::array::from_fn(f))
            }
            #[inline]
            fn dot(self, other: Self) -> f32 {
                <$t>::dot(self, other)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                <$t>::min(self, other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                <$t>::max(self, other)
            }
            #[inline]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
        }
    };
}
vector!(Vec2, 2);
vector!(Vec3, 3);
vector!(Vec4, 4);

/// A space that methods can run in. It holds types, not tricks: arithmetic that one method needs
/// lives in a private trait of that method's folder.
pub trait Space: Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// `flatland` or `space`.
    const NAME: &'static str;
    /// What a primitive is called: `segment` or `triangle`.
    const PRIM: &'static str;
    /// Corners of a primitive: 2 or 3.
    const CORNERS: usize;
    /// Points and directions.
    type Vector: Vector;
    /// Point indices of one primitive: two of a segment, three of a triangle.
    type Corners: Copy + Debug + PartialEq + AsRef<[u32]> + Send + Sync + 'static;

    /// A primitive's corners from the first `CORNERS` of three indices.
    fn corners_from(indices: [u32; 3]) -> Self::Corners;
    /// The image axes (x, then y in space) of a view along the unit vector `forward`, unit length.
    /// `up` matters in space only; any `up` works, one parallel to `forward` is replaced.
    fn image_axes(forward: Self::Vector, up: Self::Vector) -> Vec<Self::Vector>;
    /// The exact sign of the side of a primitive on which a point lies: positive in front (where its
    /// normal points), 0 on its plane.
    fn side(corners: &[Self::Vector], point: Self::Vector) -> f64;
    /// A normal of the primitive, not unit: right-handed (counter-clockwise corners are seen from the
    /// side it points to). In flatland the normal of `a → b` points to its left.
    fn normal(corners: &[Self::Vector]) -> Self::Vector;
}

/// Flatland: the plane. Primitives are segments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flat;

/// Space. Primitives are triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solid;

impl Space for Flat {
    const NAME: &'static str = "flatland";
    const PRIM: &'static str = "segment";
    const CORNERS: usize = 2;
    type Vector = Vec2;
    type Corners = [u32; 2];

    fn corners_from([a, b, _]: [u32; 3]) -> [u32; 2] {
        [a, b]
    }
    fn image_axes(forward: Vec2, _up: Vec2) -> Vec<Vec2> {
        vec![Vec2::new(forward.y, -forward.x)]
    }
    fn side(corners: &[Vec2], point: Vec2) -> f64 {
        orient2d(corners[0].as_dvec2(), corners[1].as_dvec2(), point.as_dvec2())
    }
    fn normal(corners: &[Vec2]) -> Vec2 {
        (corners[1] - corners[0]).perp()
    }
}

impl Space for Solid {
    const NAME: &'static str = "space";
    const PRIM: &'static str = "triangle";
    const CORNERS: usize = 3;
    type Vector = Vec3;
    type Corners = [u32; 3];

    fn corners_from(indices: [u32; 3]) -> [u32; 3] {
        indices
    }
    fn image_axes(forward: Vec3, up: Vec3) -> Vec<Vec3> {
        let right = forward.cross(up).try_normalize();
        let right = right.unwrap_or_else(|| forward.any_orthonormal_vector());
        vec![right, right.cross(forward)]
    }
    fn side(corners: &[Vec3], point: Vec3) -> f64 {
        orient3d(corners[0].as_dvec3(), corners[1].as_dvec3(), corners[2].as_dvec3(), point.as_dvec3())
    }
    fn normal(corners: &[Vec3]) -> Vec3 {
        (corners[1] - corners[0]).cross(corners[2] - corners[0])
    }
}

/// Whether a primitive turns its back to the eye: the eye lies strictly behind the primitive's plane, by
/// exact arithmetic. The one rule for every method and for the rasterizer, so that they agree on
/// grazing primitives. `corners` are the primitive's `S::CORNERS` points.
#[inline]
pub fn faces_away<S: Space>(eye: S::Vector, corners: &[S::Vector]) -> bool {
    S::side(corners, eye) < 0.0
}
