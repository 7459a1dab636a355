//! A box by its planes: where along the lines of sight it begins and ends.
//!
//! 1. The ray through a point of the image goes as far along each world axis as three linear functions of the
//!    image say ([`Rays`]), once a view.
//! 2. A plane of the box, square to an axis, is met at `1/w = ray / (plane − eye)` along it: linear over the
//!    image. Along a ray the box begins at the farthest of its front planes, at most one an axis, and ends at
//!    the nearest of its back planes ([`Planes`], six reciprocals in space). Front planes bound `1/w` from
//!    above, back planes from below.
//! 3. Over a cell of the pyramid that gives bounds, for four cells at a time ([`Over`]).
//!
//! Why the bounds hold for every fragment of what the box holds, at its pixel `q`, whose center the
//! rasterizer finds inside the snapped primitive:
//!
//! - `q` is a mean of the snapped vertices. The same mean of the unsnapped ones is a point `p` within half a
//!   grid step of `q` along each axis, 1/512 pixel, and of their depths that of the primitive's point `X`
//!   whose image `p` is, since `1/w` is linear over the image. `X` lies in the box, so its depth obeys all
//!   planes at `p`.
//! - A plane changes from `p` to `q` by at most its slopes times the distance: [`MARGIN_PX`] along each axis
//!   holds that, twice over, which leaves as much for the rounding of f64 on either side.
//! - The fragment's depth is that of `X`, or no nearer than [`DEPTH_SLACK`] before it
//!   (`raster`, the depth plane: it is lowered where rounding could do more, as in a sliver seen edge-on).
//!   Without that no bound but the nearest corner would hold: a depth plane followed beyond its triangle can
//!   come nearer than the box there.
//! - Depths are clamped to the range of the corners, so the nearest corner bounds them too.
//!
//! That the eye is between two planes of an axis, or on one of them, takes nothing away: neither is a front
//! plane then, both are back planes, but for one that the eye is on, which bounds nothing.
//!
//! Rounding: [`Rays`] are f64, relative to the eye like the rasterizer's own projection, and inverted exactly
//! but for some 2⁻⁵⁰. A plane over the image is f32: coefficients, two products and two sums are rounded,
//! each by at most 2⁻²⁴ of what the plane's terms can be over the image, together less than 2⁻²¹ of that;
//! `error` is twice as much, on each bound.

use crate::geometry::{Aabb, MARGIN_PX, Projection, Vector, View};
use crate::raster::{DEPTH_SLACK, Drawable, PyramidCell};

/// The ray through a point of the image at view depth 1, by world axes, relative to the eye.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rays {
    /// An axis each: change per column, per row, and the value in the upper left corner of the image.
    axes: [[f64; 3]; 3],
    eye: [f64; 3],
    /// Side of the root of the pyramid, pixels: no cell's middle lies farther out.
    side: f64,
}

impl Rays {
    /// Those of a view.
    pub fn new<S: Drawable>(view: &View<S>, projection: &Projection<S::Vector>) -> Self {
        let widen =
            |v: S::Vector| [0, 1, 2].map(|a| if a < S::Vector::AXES { f64::from(v.get(a)) } else { 0.0 });
        let last = S::Vector::AXES - 1;
        // Flatland has no row of its own for the image's y: its third axis stands for it.
        let y = if last == 2 { widen(projection.rows[1]) } else { [0.0, 0.0, 1.0] };
        let rows = [widen(projection.rows[0]), y, widen(projection.rows[last])];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        // The inverse of the rows, which are square to each other only up to their rounding.
        let columns = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])];
        let per_volume = 1.0 / (0..3).map(|a| rows[0][a] * columns[0][a]).sum::<f64>();
        let [across, down] = [view.width, view.height].map(|pixels| 2.0 * per_volume / f64::from(pixels));
        // From -1 to 1 across the image, and from 1 down to -1.
        let axis = |a: usize| {
            let corner = (columns[2][a] - columns[0][a] + columns[1][a]) * per_volume;
            [columns[0][a] * across, -columns[1][a] * down, corner]
        };
        let side = f64::from(view.width.max(view.height).next_power_of_two());
        Self { axes: [axis(0), axis(1), axis(2)], eye: widen(projection.eye), side }
    }
}

/// One plane over the image: `1/w` where a ray meets it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sheet {
    across: f32,
    down: f32,
    corner: f32,
    /// By how much it changes per pixel along both axes together.
    slope: f32,
    /// Bound on the rounding of a value.
    error: f32,
}

/// Terms beyond this could overflow; planes that have such bound nothing.
const STEEPEST: f64 = 1e30;
/// Bound on the rounding of a value, relative to the greatest terms that it is made of.
const ROUNDING: f64 = 1.0 / (1 << 20) as f64;

impl Sheet {
    /// The plane at `offset` from the eye along an axis; `None` if the eye is on it or so near that it says
    /// nothing.
    #[inline]
    fn new([across, down, corner]: [f64; 3], side: f64, offset: f64) -> Option<Self> {
        let per = 1.0 / offset;
        let (across, down, corner) = (across * per, down * per, corner * per);
        let slope = across.abs() + down.abs();
        let terms = slope * side + corner.abs();
        // Where there is no reciprocal, the terms are infinite or no numbers.
        (terms < STEEPEST).then_some(Self {
            across: across as f32,
            down: down as f32,
            corner: corner as f32,
            slope: slope as f32,
            // Below the least normal number rounding is absolute.
            error: (terms * ROUNDING) as f32 + f32::MIN_POSITIVE,
        })
    }
    /// Values in the middle of four cells.
    #[inline(always)]
    fn at(&self, middles: &[[f32; 4]; 2]) -> [f32; 4] {
        std::array::from_fn(|k| self.across * middles[0][k] + (self.down * middles[1][k] + self.corner))
    }
    /// By how much a value anywhere within `half` of a middle, and the margin about that, can differ.
    #[inline(always)]
    fn reach(&self, half: f32) -> f32 {
        self.slope * (half + MARGIN_PX as f32) + self.error
    }
}

/// The planes of a box.
#[derive(Clone, Copy, Debug)]
pub struct Planes {
    front: [Sheet; 3],
    fronts: usize,
    back: [Sheet; 6],
    backs: usize,
}

/// What is known of a box over up to four cells. Depths are `1/w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Over {
    /// Whether it may show at a pixel of the cell.
    pub meets: [bool; 4],
    /// No fragment of what it holds is nearer than that in the cell.
    pub up: [f32; 4],
    /// It covers all pixels of the cell and begins at least that near at each; negative if it may not.
    pub fills: [f32; 4],
}

impl Planes {
    /// Those of a box.
    #[inline]
    pub fn new<V: Vector>(rays: &Rays, bounds: &Aabb<V>) -> Self {
        let mut planes =
            Self { front: [Sheet::default(); 3], fronts: 0, back: [Sheet::default(); 6], backs: 0 };
        for axis in 0..V::AXES {
            let [low, high] = [bounds.min, bounds.max].map(|c| f64::from(c.get(axis)) - rays.eye[axis]);
            let sheet = |offset: f64| Sheet::new(rays.axes[axis], rays.side, offset);
            // Whichever side of the planes the eye is on: what lies beyond the first of them has
            // `w · ray ≥ offset`, divided by the offset with its sign.
            let (front, backs) = if low > 0.0 {
                (sheet(low), [sheet(high), None])
            } else if high < 0.0 {
                (sheet(high), [sheet(low), None])
            } else {
                (None, [sheet(low), sheet(high)])
            };
            if let Some(front) = front {
                planes.front[planes.fronts] = front;
                planes.fronts += 1;
            }
            for back in backs.into_iter().flatten() {
                planes.back[planes.backs] = back;
                planes.backs += 1;
            }
        }
        planes
    }

    /// Over four cells of a level, given by their middles and by how far their outermost pixels' centers are
    /// from these. `nearest`: the depth of the nearest corner.
    #[inline]
    pub fn over(&self, middles: &[[f32; 4]; 2], half: f32, nearest: f32) -> Over {
        // Where the box begins: at most and at least, over all pixels of a cell; and where it ends.
        let (mut begins, mut least) = ([nearest; 4], [nearest; 4]);
        let (mut ends, mut most) = ([0.0_f32; 4], [0.0_f32; 4]);
        let lesser = |a: f32, b: f32| if a < b { a } else { b };
        let greater = |a: f32, b: f32| if a > b { a } else { b };
        for sheet in &self.front[..self.fronts] {
            let (values, reach) = (sheet.at(middles), sheet.reach(half));
            for k in 0..4 {
                begins[k] = lesser(begins[k], values[k] + reach);
                least[k] = lesser(least[k], values[k] - reach);
            }
        }
        for sheet in &self.back[..self.backs] {
            let (values, reach) = (sheet.at(middles), sheet.reach(half));
            for k in 0..4 {
                ends[k] = greater(ends[k], values[k] - reach);
                most[k] = greater(most[k], values[k] + reach);
            }
        }
        Over {
            meets: std::array::from_fn(|k| begins[k] >= ends[k]),
            // What the rasterizer's own rounding may add; the nearest corner holds without it.
            up: begins.map(|depth| lesser(depth + depth.abs() * DEPTH_SLACK as f32, nearest)),
            fills: std::array::from_fn(|k| if least[k] >= most[k] { least[k] } else { -1.0 }),
        }
    }
}

/// Middles of the four cells below one, and half the distance of their outermost pixels' centers.
#[inline]
pub fn below(cell: PyramidCell) -> ([[f32; 4]; 2], f32) {
    let side = (1u32 << (cell.level - 1)) as f32;
    // Whole numbers and halves below 2¹⁶: exact.
    let (x, y) = (f32::from(cell.x) * 2.0, f32::from(cell.y) * 2.0);
    let across = [0.5, 1.5, 0.5, 1.5].map(|k| (x + k) * side);
    let down = [0.5, 0.5, 1.5, 1.5].map(|k| (y + k) * side);
    ([across, down], (side - 1.0) * 0.5)
}

/// The same of one cell, four times.
#[inline]
pub fn middle(cell: PyramidCell) -> ([[f32; 4]; 2], f32) {
    let side = (1u32 << cell.level) as f32;
    let at = |k: u16| [(f32::from(k) + 0.5) * side; 4];
    ([at(cell.x), at(cell.y)], (side - 1.0) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Eye, Flat, Footprint, Solid, project_box};
    use crate::raster::Options;
    use crate::scene::{Parts, Scene};

    fn random_view<S: Drawable>(dice: &mut Dice, most: u32) -> View<S> {
        let position = dice.vector::<S::Vector>(5.0);
        let [target, up] = [(); 2].map(|()| position + dice.vector::<S::Vector>(1.0));
        let fov = dice.between(0.2, 2.4);
        let eye = Eye { position, target, up: up - position, fov, near: 0.05, far: 300.0 };
        let height = if S::CORNERS == 2 { 1 } else { 1 + dice.below(most) };
        View { eye, width: 1 + dice.below(most), height }
    }
    /// The ray through a point of the image.
    fn ray(rays: &Rays, [x, y]: [f64; 2]) -> [f64; 3] {
        rays.axes.map(|[across, down, corner]| across * x + down * y + corner)
    }

    /// A ray is what the projection maps to its point, at depth 1.
    fn rays_are_projected_back<S: Drawable>() {
        let mut dice = Dice::new(31);
        for _ in 0..2000 {
            let view = random_view::<S>(&mut dice, 3000);
            let (projection, last) = (view.projection(), S::Vector::AXES - 1);
            let size = [view.width, view.height].map(f64::from);
            let at = size.map(|pixels| pixels * f64::from(dice.unit()));
            let ray = ray(&Rays::new(&view, &projection), at);
            let along =
                |row: S::Vector| (0..S::Vector::AXES).map(|a| f64::from(row.get(a)) * ray[a]).sum::<f64>();
            assert!((along(projection.rows[last]) - 1.0).abs() < 1e-12);
            for axis in 0..last {
                let want = (2.0 * at[axis] / size[axis] - 1.0) * if axis == 0 { 1.0 } else { -1.0 };
                assert!((along(projection.rows[axis]) - want).abs() < 1e-11, "{want} along {axis}");
            }
        }
    }
    #[test]
    fn a_ray_is_projected_to_its_point() {
        rays_are_projected_back::<Flat>();
        rays_are_projected_back::<Solid>();
    }

    /// The bounds of a plane over a cell hold to the ends of the margin, in images of any size.
    #[test]
    fn a_plane_over_a_cell_lies_between_its_bounds() {
        let mut dice = Dice::new(32);
        for round in 0..20_000 {
            let view = random_view::<Solid>(&mut dice, [64, 1024, 16384][round % 3]);
            let rays = Rays::new(&view, &view.projection());
            let axis = dice.below(3) as usize;
            let offset = f64::from(dice.signed(1.0) * [0.01, 1.0, 100.0][dice.below(3) as usize]);
            let Some(sheet) = Sheet::new(rays.axes[axis], rays.side, offset) else { continue };
            let level = dice.below(1 + rays.side.log2() as u32);
            let [x, y] = [view.width, view.height].map(|pixels| (dice.below(pixels) >> level) as u16);
            let (middles, half) = middle(PyramidCell { level: level as u8, x, y });
            let grown = f64::from(half) + MARGIN_PX;
            for corner in 0..4 {
                let end = |bit: u32| if corner >> bit & 1 == 0 { -grown } else { grown };
                let at = [f64::from(middles[0][0]) + end(0), f64::from(middles[1][0]) + end(1)];
                let exact = ray(&rays, at)[axis] / offset;
                let (value, reach) = (sheet.at(&middles)[0], sheet.reach(half));
                let [low, high] = [value - reach, value + reach].map(f64::from);
                assert!(low <= exact && exact <= high, "{low}..{high} holds {exact}: {sheet:?}");
            }
        }
    }

    /// A box in front of the eye. Many have a corner whose image lies close to a pixel's center.
    fn random_box<S: Drawable>(dice: &mut Dice, view: &View<S>, rays: &Rays) -> Aabb<S::Vector> {
        let pixel = [view.width, view.height].map(|pixels| f64::from(dice.below(pixels)) + 0.5);
        let off: f64 = [0.0, 1.0 / 300.0, 20.0][dice.below(3) as usize];
        let at = pixel.map(|p| p + off * f64::from(dice.signed(1.0)));
        let at = if S::CORNERS == 2 { [at[0], 0.5] } else { at };
        let (ray, depth) = (ray(rays, at), f64::from(dice.between(0.3, 20.0)));
        let corner = S::Vector::from_fn(|a| (rays.eye[a] + ray[a] * depth) as f32);
        let size = [0.01, 1.0, 10.0][dice.below(3) as usize];
        let other = corner + S::Vector::from_fn(|_| dice.signed(size) * dice.unit());
        Aabb::of([corner, other])
    }
    /// A primitive in the box: on its corners, edges and faces and within, some of them seen edge-on.
    fn random_corners<S: Drawable>(
        dice: &mut Dice,
        bounds: &Aabb<S::Vector>,
        eye: S::Vector,
    ) -> Vec<S::Vector> {
        let mut point = || {
            S::Vector::from_fn(|a| {
                let share = dice.unit();
                let (low, high) = (bounds.min.get(a), bounds.max.get(a));
                let between = (low + (high - low) * dice.unit()).clamp(low, high);
                if share < 0.4 {
                    low
                } else if share < 0.8 {
                    high
                } else {
                    between
                }
            })
        };
        let mut corners: Vec<S::Vector> = (0..S::CORNERS).map(|_| point()).collect();
        if S::CORNERS == 3 && dice.below(3) == 0 {
            // In the plane of the first two and the eye, but for rounding.
            let between = corners[0] + (corners[1] - corners[0]) * dice.unit();
            let last = eye + (between - eye) * dice.between(0.5, 2.0);
            if bounds.contains(last) {
                corners[2] = last;
            }
        }
        corners
    }

    /// No fragment of what a box holds is nearer than its planes say, over cells of any level, nor lies where
    /// they say that it does not reach.
    fn fragments_obey_planes<S: Drawable>(seed: u64, make: fn(u32) -> S::Corners) {
        let (mut dice, mut fragments) = (Dice::new(seed), 0);
        for _ in 0..BOXES {
            let view = random_view::<S>(&mut dice, 24);
            let (projection, eye) = (view.projection(), &view.eye);
            let rays = Rays::new(&view, &projection);
            let bounds = random_box(&mut dice, &view, &rays);
            let footprint = project_box(&projection, &bounds, eye.near, eye.far, view.width, view.height);
            let Footprint::Seen(image) = footprint else { continue };
            let planes = Planes::new(&rays, &bounds);
            let points = (0..4).flat_map(|_| random_corners::<S>(&mut dice, &bounds, eye.position));
            let prims = (0..4).map(|k| make(k * S::CORNERS as u32)).collect();
            let Ok(scene) = Scene::<S>::new(Parts::simple("held", points.collect(), prims)) else { continue };
            for &prim in scene.live() {
                S::fragments(&scene, &view, prim, &Options::default(), &mut |place, depth| {
                    let [x, y] = [place as u32 % view.width, place as u32 / view.width];
                    fragments += 1;
                    for level in 0..=rays.side.log2() as u32 {
                        let cell = PyramidCell {
                            level: level as u8,
                            x: (x >> level) as u16,
                            y: (y >> level) as u16,
                        };
                        let (middles, half) = middle(cell);
                        let over = planes.over(&middles, half, image.nearest);
                        assert!(over.meets[0], "a fragment at ({x}, {y}), where {bounds:?} is not: {view:?}");
                        assert!(
                            depth <= over.up[0],
                            "a fragment at ({x}, {y}) is at {}, {bounds:?} at {}: {view:?}",
                            1.0 / depth,
                            1.0 / over.up[0]
                        );
                    }
                });
            }
        }
        assert!(fragments > BOXES, "{fragments} fragments");
    }
    /// Random boxes of each space.
    const BOXES: u32 = 20_000;

    #[test]
    fn no_fragment_is_nearer_than_the_planes_of_its_box_in_flatland() {
        fragments_obey_planes::<Flat>(33, |k| [k, k + 1]);
    }
    #[test]
    fn no_fragment_is_nearer_than_the_planes_of_its_box_in_space() {
        fragments_obey_planes::<Solid>(34, |k| [k, k + 1, k + 2]);
    }

    /// The four cells below one are where they are asked for one by one.
    #[test]
    fn four_cells_are_asked_for_as_one_is() {
        let mut dice = Dice::new(35);
        for _ in 0..2000 {
            let view = random_view::<Solid>(&mut dice, 100);
            let rays = Rays::new(&view, &view.projection());
            let planes = Planes::new(&rays, &random_box(&mut dice, &view, &rays));
            let cell = PyramidCell {
                level: 1 + dice.below(4) as u8,
                x: dice.below(9) as u16,
                y: dice.below(9) as u16,
            };
            let (middles, half) = below(cell);
            let four = planes.over(&middles, half, 3.0);
            for k in 0..4_u16 {
                let child =
                    PyramidCell { level: cell.level - 1, x: cell.x * 2 + (k & 1), y: cell.y * 2 + (k >> 1) };
                let (middles, half) = middle(child);
                let (one, k) = (planes.over(&middles, half, 3.0), usize::from(k));
                let of = |o: &Over, k: usize| (o.meets[k], o.up[k], o.fills[k]);
                assert_eq!(of(&four, k), of(&one, 0));
            }
        }
    }
}
