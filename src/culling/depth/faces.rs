//! What differs between flatland and space: the faces of a box, and what of the image one covers.

use crate::geometry::{
    Aabb, BoxImage, Flat, Footprint, MARGIN_PX, PixelRect, Projection, Solid, Space, Vector, View,
    project_box,
};
use crate::raster::Drawable;

/// Faces of boxes and their images.
pub trait Faces: Drawable {
    /// The faces of a box that face the eye, at most one an axis: corner numbers in order around the face
    /// (two ends of a side in flatland), `[0; 4]` beyond the count.
    fn front(bounds: &Aabb<Self::Vector>, eye: Self::Vector) -> ([[u8; 4]; 3], usize) {
        let (mut faces, mut count) = ([[0; 4]; 3], 0);
        // A line of sight enters a box, which is convex, through a face that faces the eye: these faces cover
        // all of its image. Between the planes of an axis, or on one of them, the eye sees neither face from
        // its front.
        for axis in 0..Self::Vector::AXES {
            let upper = eye.get(axis) > bounds.max.get(axis);
            if upper || eye.get(axis) < bounds.min.get(axis) {
                faces[count] = Self::around(axis, upper);
                count += 1;
            }
        }
        (faces, count)
    }
    /// The corners of the face at the upper or lower end of an axis.
    fn around(axis: usize, upper: bool) -> [u8; 4];
    /// The image of a face.
    fn image(face: [u8; 4], image: &BoxImage, width: u32, height: u32) -> FaceImage;
}

/// What of the image a face covers: a rectangle of pixels and, in space, the convex quadrangle in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceImage {
    /// The pixels whose centers it can cover.
    pub pixels: PixelRect,
    sides: Sides,
}

/// Four sides as lines `x·a + y·b + c`, negative outside, and [`MARGIN_PX`] in the same measure, which is the
/// pixel times the side's length. All zero where there is none: it bounds nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sides {
    a: [f64; 4],
    b: [f64; 4],
    c: [f64; 4],
    margin: [f64; 4],
}

impl FaceImage {
    /// A face that covers a rectangle.
    pub fn rectangle(pixels: PixelRect) -> Self {
        Self { pixels, sides: Sides::default() }
    }
    /// Whether it may cover the center of a pixel of the rectangle.
    #[inline]
    pub fn touches(&self, cell: PixelRect) -> bool {
        let both = cell.intersection(self.pixels);
        if both.is_empty() {
            return false;
        }
        let (center, half) = centers(both);
        let s = &self.sides;
        // The greatest value that a side's line takes over the centers: where even that is outside by more
        // than the margin, the face reaches none of them.
        // All four at a time: which of them rejects is not to be foreseen.
        (0..4).fold(true, |all, i| all & (s.distance(i, center) + s.spread(i, half) >= -s.margin[i]))
    }
    /// Whether it covers the centers of all pixels of the rectangle.
    #[inline]
    pub fn covers(&self, cell: PixelRect) -> bool {
        let r = self.pixels;
        let inside = cell.x0 >= r.x0 && cell.x1 <= r.x1 && cell.y0 >= r.y0 && cell.y1 <= r.y1;
        let (center, half) = centers(cell);
        let s = &self.sides;
        // The least value over the centers, without the margin of the sides. To be wrong here would end a
        // descent too early, which keeps a box and never drops one.
        inside && (0..4).fold(true, |all, i| all & (s.distance(i, center) >= s.spread(i, half)))
    }
}

impl Sides {
    #[inline(always)]
    fn distance(&self, i: usize, at: [f64; 2]) -> f64 {
        self.a[i] * at[0] + self.b[i] * at[1] + self.c[i]
    }
    #[inline(always)]
    fn spread(&self, i: usize, half: [f64; 2]) -> f64 {
        self.a[i].abs() * half[0] + self.b[i].abs() * half[1]
    }
}

/// Middle and half extent of the centers of a rectangle's pixels.
#[inline]
fn centers(r: PixelRect) -> ([f64; 2], [f64; 2]) {
    // Centers lie at halves, so the outermost ones are half a pixel inside the edges.
    let (x, y) = (f64::from(r.x0 + r.x1), f64::from(r.y0 + r.y1));
    let (w, h) = (f64::from(r.x1 - r.x0) - 1.0, f64::from(r.y1 - r.y0) - 1.0);
    ([x * 0.5, y * 0.5], [w * 0.5, h * 0.5])
}
/// The bounds of a face's corners on the screen.
#[inline]
fn rect(corners: &[[f64; 2]], width: u32, height: u32) -> PixelRect {
    let (mut low, mut high) = (corners[0], corners[0]);
    for c in &corners[1..] {
        for a in 0..2 {
            low[a] = if c[a] < low[a] { c[a] } else { low[a] };
            high[a] = if c[a] > high[a] { c[a] } else { high[a] };
        }
    }
    PixelRect::around(low, high, width, height)
}

impl Faces for Flat {
    fn around(axis: usize, upper: bool) -> [u8; 4] {
        // A corner's number has a bit an axis, set at the upper end.
        let first = u8::from(upper) << axis;
        [first, first | 1 << (1 - axis), 0, 0]
    }
    fn image(face: [u8; 4], image: &BoxImage, width: u32, _: u32) -> FaceImage {
        // In one row of pixels nothing slants: the rectangle is the whole image of a side.
        FaceImage::rectangle(rect(
            &[image.corners_px[face[0] as usize], image.corners_px[face[1] as usize]],
            width,
            1,
        ))
    }
}

/// A face whose image is smaller than this, in pixels squared, is taken as its rectangle: its sides have no
/// direction.
const LEAST_AREA: f64 = 1e-6;

impl Faces for Solid {
    fn around(axis: usize, upper: bool) -> [u8; 4] {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let first = u8::from(upper) << axis;
        // One bit changes from each corner to the next, so that they follow each other around the face.
        [first, first | 1 << b, first | 1 << b | 1 << c, first | 1 << c]
    }
    fn image(face: [u8; 4], image: &BoxImage, width: u32, height: u32) -> FaceImage {
        let p = face.map(|c| image.corners_px[c as usize]);
        let mut face = FaceImage::rectangle(rect(&p, width, height));
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        // From its diagonals: twice the area, and its sign tells which way round the image runs.
        let area = cross(minus(p[2], p[0]), minus(p[3], p[1]));
        if area.abs() < LEAST_AREA {
            return face;
        }
        // Normals inward whichever way that is.
        let turn = area.signum();
        for i in 0..4 {
            let (from, along) = (p[i], minus(p[(i + 1) % 4], p[i]));
            let length_2 = along[0] * along[0] + along[1] * along[1];
            // A side of no length bounds nothing.
            if length_2 > 1e-18 {
                let n = [-along[1] * turn, along[0] * turn];
                (face.sides.a[i], face.sides.b[i]) = (n[0], n[1]);
                face.sides.c[i] = -(n[0] * from[0] + n[1] * from[1]);
                face.sides.margin[i] = length_2.sqrt() * MARGIN_PX;
            }
        }
        face
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
    Footprint::Seen(BoxImage { corners_px: [[0.0; 2]; 8], pixels, nearest: (1.0 / (w - radius)) as f32 })
}
