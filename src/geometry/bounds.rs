//! Axis-aligned boxes.

use super::Vector;

/// Axis-aligned box in world units; closed: its faces belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<V> {
    /// Least corner.
    pub min: V,
    /// Greatest corner.
    pub max: V,
}

impl<V: Vector> Aabb<V> {
    /// The box that holds nothing: neutral for [`Aabb::union`] and [`Aabb::with`].
    pub fn empty() -> Self {
        Self { min: V::splat(f32::INFINITY), max: V::splat(f32::NEG_INFINITY) }
    }
    /// Smallest box that holds all points; [`Aabb::empty`] for none.
    pub fn of(points: impl IntoIterator<Item = V>) -> Self {
        points.into_iter().fold(Self::empty(), Self::with)
    }
    /// Smallest box that holds this one and a point.
    #[inline]
    pub fn with(self, point: V) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }
    /// Smallest box that holds both.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
    /// Whether it holds no point at all.
    pub fn is_empty(&self) -> bool {
        (0..V::AXES).any(|a| self.min.get(a) > self.max.get(a))
    }
    /// Middle of the box.
    pub fn center(&self) -> V {
        self.min * 0.5 + self.max * 0.5
    }
    /// Side lengths.
    pub fn size(&self) -> V {
        self.max - self.min
    }
    /// Length of the diagonal.
    pub fn diagonal(&self) -> f32 {
        self.size().length()
    }
    /// Whether the point lies in the box or on its surface.
    pub fn contains(&self, point: V) -> bool {
        (0..V::AXES).all(|a| (self.min.get(a)..=self.max.get(a)).contains(&point.get(a)))
    }
    /// Whether `other` lies in this box wholly.
    pub fn encloses(&self, other: &Self) -> bool {
        self.contains(other.min) && self.contains(other.max)
    }
    /// Whether the boxes share a point.
    pub fn touches(&self, other: &Self) -> bool {
        (0..V::AXES).all(|a| self.min.get(a) <= other.max.get(a) && other.min.get(a) <= self.max.get(a))
    }
    /// Number of corners, `2^AXES`.
    pub const CORNERS: usize = 1 << V::AXES;
    /// Corner `i < CORNERS`: bit `a` of `i` chooses max over min on axis `a`.
    #[inline]
    pub fn corner(&self, i: usize) -> V {
        V::from_fn(|a| if i >> a & 1 == 1 { self.max.get(a) } else { self.min.get(a) })
    }
    /// All corners, in the order of [`Aabb::corner`].
    pub fn corners(&self) -> impl Iterator<Item = V> + '_ {
        (0..Self::CORNERS).map(|i| self.corner(i))
    }
    /// The box's edges as pairs of corner numbers: 4 in the plane, 12 in space.
    pub fn edges() -> impl Iterator<Item = (usize, usize)> {
        (0..V::AXES)
            .flat_map(|a| (0..Self::CORNERS).filter(move |i| i >> a & 1 == 0).map(move |i| (i, i | 1 << a)))
    }
}
