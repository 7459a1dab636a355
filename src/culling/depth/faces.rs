//! What stands for a box: its front faces, its place in the image, and the sphere around it.

use crate::geometry::{
    Aabb, BoxImage, Flat, Footprint, PixelRect, Projection, Solid, Space, Vector, View, project_box,
};
use crate::raster::Drawable;

/// Spaces whose boxes have faces. What differs between flatland and space is how these are shown.
pub trait Faces: Drawable {
    /// The faces of a box that face the eye, at most one an axis, as corners in order around them (the two
    /// ends of a side in flatland).
    fn front(bounds: &Aabb<Self::Vector>, eye: Self::Vector) -> Vec<Vec<Self::Vector>> {
        // Between the planes of an axis, or on one of them, the eye sees neither face from its front.
        let ends = (0..Self::Vector::AXES).filter_map(|axis| {
            let upper = eye.get(axis) > bounds.max.get(axis);
            (upper || eye.get(axis) < bounds.min.get(axis)).then_some((axis, upper))
        });
        let corners = |(axis, upper): (usize, bool)| {
            // A corner's number has a bit an axis, set at the upper end; one bit changes from each corner to
            // the next, so that they follow each other around the face.
            let first = usize::from(upper) << axis;
            let turned = |by: usize| 1 << ((axis + by) % Self::Vector::AXES);
            Self::around(turned(1), turned(2)).iter().map(|c| bounds.corner(first | c)).collect()
        };
        ends.map(corners).collect()
    }
    /// Corners around a face, from the bits of its other axes.
    fn around(b: usize, c: usize) -> Vec<usize>;
}

impl Faces for Flat {
    fn around(b: usize, _: usize) -> Vec<usize> {
        vec![0, b]
    }
}

impl Faces for Solid {
    fn around(b: usize, c: usize) -> Vec<usize> {
        vec![0, b, b | c, c]
    }
}

/// Where a box falls in the image.
pub fn footprint<S: Faces>(
    view: &View<S>,
    projection: &Projection<S::Vector>,
    bounds: &Aabb<S::Vector>,
) -> Footprint {
    project_box(projection, bounds, view.eye.near, view.eye.far, view.width, view.height)
}

/// The sphere about a box is taken larger by this part, for rounding.
const SPHERE_SLACK: f64 = 1e-5;

/// The screen rectangle and the nearest depth of the sphere about a box (Georges 1995, Section 5.3). Where
/// the sphere reaches the near plane, so may the box.
pub fn project_sphere<S: Space>(view: &View<S>, bounds: &Aabb<S::Vector>) -> Footprint {
    let projection = view.projection();
    let image_axes = S::Vector::AXES - 1;
    let dot = |row: S::Vector, v: S::Vector| {
        (0..S::Vector::AXES).map(|a| f64::from(row.get(a)) * f64::from(v.get(a))).sum::<f64>()
    };
    let center = bounds.center() - projection.eye;
    // Its size and its place are both rounded: the first share is for the one, the second for the other.
    let radius =
        f64::from(bounds.diagonal()) * 0.5 * (1.0 + SPHERE_SLACK) + f64::from(center.length()) * SPHERE_SLACK;
    let w = dot(projection.rows[image_axes], center);
    if w + radius < f64::from(view.eye.near) || w - radius > f64::from(view.eye.far) {
        return Footprint::Outside;
    }
    if w - radius <= f64::from(view.eye.near) {
        return Footprint::CrossesNear;
    }
    let (mut low, mut high) = ([0.5; 2], [0.5; 2]);
    for (a, pixels) in [view.width, view.height].into_iter().enumerate().take(image_axes) {
        let row = projection.rows[a];
        let scale = dot(row, row).sqrt();
        let across = dot(row, center) / scale;
        // The two lines through the eye that touch the sphere, in the plane of the axis and the line of
        // sight.
        // The whole sphere lies beyond the near plane here, so only rounding can make the quotient exceed 1.
        let (middle, half) = (across.atan2(w), (radius / across.hypot(w)).min(1.0).asin());
        // Rows run downward, the second axis of the view upward.
        let place = |angle: f64| angle.tan() * scale * if a == 0 { 1.0 } else { -1.0 };
        let ends = [place(middle - half), place(middle + half)].map(|v| (v * 0.5 + 0.5) * f64::from(pixels));
        (low[a], high[a]) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    }
    let pixels = PixelRect::around(low, high, view.width, view.height);
    Footprint::Seen(BoxImage { pixels, nearest: (1.0 / (w - radius)) as f32 })
}
