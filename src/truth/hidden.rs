//! Is what a method called hidden really hidden? Asked of an image and of rays, not of the method's own
//! arithmetic.
//!
//! The image is that of the whole scene, drawn once a view by the plain reference of the rasterizer, without
//! what is see-through: that hides nothing, and is seen where it lies before all that the image shows. Of a
//! box it is asked at every pixel center whose ray meets the box: does the image show a surface that is
//! nearer than where that ray enters the box? Rays come from the definition of the Eye and meet boxes slab by
//! slab, all in f64. Of a primitive it is asked that it owns no pixel, or shows in none.
//!
//! Allowances, all in favor of the claim: vertices are snapped to 1/256 pixel, so a surface counts as being
//! as near as it is anywhere within [`SNAP_PX`] of the pixel's center, but no nearer than its nearest corner;
//! the axes of the view are rounded to 32 bits, so depths are compared with a relative slack of
//! [`DEPTH_SLACK`]. Where only the allowance makes a surface near enough it must not belong to the subject
//! itself, or else whatever fills the front of its own box would hide it.
//!
//! Cost: the image once, O(primitives × pixels in their boxes); a claim O(pixels in the box's rectangle).

use glam::DVec3;

use super::{all_visible, widened};
use crate::geometry::{PrimId, Vector, View};
use crate::raster::{Drawable, Options, Target};
use crate::scene::{Scene, Surfaces};

/// How far the snapping of its corners to 1/256 pixel can move a surface, pixels in each direction: half a
/// step, and as much again for the rounding of the view's axes over 16384 pixels.
const SNAP_PX: f64 = 1.0 / 256.0;
/// Relative allowance on depths: 32 half-ulps of 32 bits, twice what the rasterizer's axes and planes come
/// to.
const DEPTH_SLACK: f64 = 16.0 * f32::EPSILON as f64;

/// The image of a whole scene and the rays through its pixels.
pub(super) struct Sight<'a, S: Drawable> {
    scene: &'a Scene<S>,
    image: Target,
    /// Whether each primitive owns a pixel.
    seen: Vec<bool>,
    rays: Rays,
    near: f64,
    far: f64,
}

/// Rays through an image: at depth 1 a ray has come as far as `forward + right·x + up·y`, x and y from −1 to
/// 1.
struct Rays {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    width: u32,
    height: u32,
}

impl Rays {
    fn new<V: Vector, S: crate::geometry::Space<Vector = V>>(view: &View<S>) -> Self {
        let eye = &view.eye;
        let position = widened(eye.position);
        let forward = (widened(eye.target) - position).normalize();
        let tan = (f64::from(eye.fov) * 0.5).tan();
        let (right, up) = if V::AXES == 2 {
            (DVec3::new(forward.y, -forward.x, 0.0) * tan, DVec3::ZERO)
        } else {
            let across = forward.cross(widened(eye.up).normalize_or_zero());
            let right = across.try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
            (right * (tan * f64::from(view.width) / f64::from(view.height)), right.cross(forward) * tan)
        };
        Self { eye: position, forward, right, up, width: view.width, height: view.height }
    }

    /// The ray through a place of the image, pixels from its upper left corner.
    fn through(&self, x: f64, y: f64) -> DVec3 {
        let (x, y) = (2.0 * x / f64::from(self.width) - 1.0, 1.0 - 2.0 * y / f64::from(self.height));
        self.forward + self.right * x + self.up * y
    }

    /// The pixels that a box may cover, `[x0, x1, y0, y1]` half-open: all of them if part of it is not well
    /// before the eye.
    fn rectangle(&self, corners: &[DVec3; 8], near: f64) -> [u32; 4] {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in corners {
            let (r, depth) = (*corner - self.eye, (*corner - self.eye).dot(self.forward));
            if depth < near * 0.5 {
                return [0, self.width, 0, self.height];
            }
            let up = if self.up == DVec3::ZERO { 0.0 } else { r.dot(self.up) / self.up.length_squared() };
            let at = [r.dot(self.right) / self.right.length_squared() / depth, -up / depth];
            for a in 0..2 {
                low[a] = low[a].min(at[a]);
                high[a] = high[a].max(at[a]);
            }
        }
        let pixel = |v: f64, by: f64, size: u32| {
            ((v * 0.5 + 0.5) * f64::from(size) + by).clamp(0.0, f64::from(size)) as u32
        };
        let (w, h) = (self.width, self.height);
        [pixel(low[0], -1.0, w), pixel(high[0], 2.0, w), pixel(low[1], -1.0, h), pixel(high[1], 2.0, h)]
    }

    /// The depths between which a ray is in a box; `None` if it misses it.
    fn meets(&self, ray: DVec3, low: DVec3, high: DVec3) -> Option<(f64, f64)> {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for a in 0..3 {
            let (from, to) = (low[a] - self.eye[a], high[a] - self.eye[a]);
            if ray[a] == 0.0 {
                if from > 0.0 || to < 0.0 {
                    return None;
                }
                continue;
            }
            let (t, u) = (from / ray[a], to / ray[a]);
            enter = enter.max(t.min(u));
            leave = leave.min(t.max(u));
        }
        (enter <= leave).then_some((enter, leave))
    }
}

impl<'a, S: Drawable> Sight<'a, S> {
    /// Draws the whole scene, its surfaces taken in some way.
    pub fn new(scene: &'a Scene<S>, view: &View<S>, surfaces: Surfaces) -> Self {
        let is_there = |p: &PrimId| !surfaces.leave_out(scene, *p, view.eye.position);
        let prims: Vec<PrimId> = scene.live().iter().copied().filter(is_there).collect();
        let mut image = Target::new(view);
        let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
        S::draw_reference(&mut image, scene, view, &prims, &options);
        let mut seen = vec![false; scene.prim_count()];
        all_visible(&image, scene, view, &options).iter().for_each(|p| seen[p.at()] = true);
        Self {
            scene,
            image,
            seen,
            rays: Rays::new(view),
            near: f64::from(view.eye.near),
            far: f64::from(view.eye.far),
        }
    }

    /// Whether a primitive owns no pixel.
    pub fn unseen(&self, prim: PrimId) -> Result<(), String> {
        if self.seen[prim.at()] {
            Err(format!("the {} {prim} is called hidden and owns a pixel", S::PRIM))
        } else {
            Ok(())
        }
    }

    /// Whether every ray that meets a box meets a surface before, one that is not of `own` (ascending) where
    /// it is close.
    pub fn behind(&self, low: DVec3, high: DVec3, own: &[PrimId]) -> Result<(), String> {
        let corners = std::array::from_fn(|k| {
            DVec3::select(glam::BVec3::new(k & 1 == 0, k & 2 == 0, k & 4 == 0), low, high)
        });
        let depths = corners.map(|c: DVec3| (c - self.rays.eye).dot(self.rays.forward));
        let nearest = depths.into_iter().fold(f64::INFINITY, f64::min);
        let [x0, x1, y0, y1] = self.rays.rectangle(&corners, self.near);
        for y in y0..y1 {
            for x in x0..x1 {
                let at = y as usize * self.rays.width as usize + x as usize;
                let (shown, item) = (f64::from(self.image.depth[at]), self.image.item[at]);
                // Nearer than the whole box: no need to ask where the ray enters it.
                if item != Target::NONE && nearest > 0.0 && shown * nearest > 1.0 + DEPTH_SLACK {
                    continue;
                }
                let ray = self.rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let Some((enter, leave)) = self.rays.meets(ray, low, high) else { continue };
                let enter = enter.max(self.near);
                // What is not within the depths of the view is not drawn.
                if leave < self.near || enter > self.far {
                    continue;
                }
                if item == Target::NONE {
                    return Err(format!(
                        "at pixel ({x}, {y}) a ray enters the box at depth {enter}, and no surface is shown"
                    ));
                }
                if !self.is_before(shown, PrimId(item), enter, own) {
                    let found = 1.0 / shown;
                    return Err(format!(
                        "at pixel ({x}, {y}) a ray enters the box at depth {enter}, and the surface shown \
                         lies at {found}"
                    ));
                }
            }
        }
        Ok(())
    }

    /// Whether a primitive that a pixel shows, at depth 1/`shown`, is nearer than `enter`.
    fn is_before(&self, shown: f64, prim: PrimId, enter: f64, own: &[PrimId]) -> bool {
        if shown * enter > 1.0 + DEPTH_SLACK {
            return true;
        }
        let (slope, nearest) = self.reach(prim);
        let reach = shown + slope.min((nearest - shown).max(0.0));
        reach * enter >= 1.0 - DEPTH_SLACK && own.binary_search(&prim).is_err()
    }

    /// By how much 1/depth of a primitive's plane changes within [`SNAP_PX`], and 1/depth of its nearest
    /// corner.
    fn reach(&self, prim: PrimId) -> (f64, f64) {
        let p: Vec<DVec3> = self.scene.prim_points(prim).map(|p| widened(p) - self.rays.eye).collect();
        let normal = if S::Vector::AXES == 2 {
            DVec3::new(p[0].y - p[1].y, p[1].x - p[0].x, 0.0)
        } else {
            (p[1] - p[0]).cross(p[2] - p[0])
        };
        // On a ray 1/depth is normal·ray / normal·corner, and it changes as the ray does.
        let step = |axis: DVec3, size: u32| (normal.dot(axis) * 2.0 / f64::from(size)).abs();
        let change =
            (step(self.rays.right, self.rays.width) + step(self.rays.up, self.rays.height)) * SNAP_PX;
        let slope = change / normal.dot(p[0]).abs();
        let nearest = p.iter().map(|c| 1.0 / c.dot(self.rays.forward).max(self.near)).fold(0.0, f64::max);
        // An edge-on surface may be anywhere between its corners.
        (if slope.is_finite() { slope } else { f64::INFINITY }, nearest)
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::geometry::{Eye, Flat, Solid};
    use crate::scene::Parts;

    /// A wall 4 m before the eye that hides everything behind it within 14 degrees, and a thing behind it.
    fn flatland() -> (Scene<Flat>, View<Flat>) {
        let points = [[-1.0, 4.0], [1.0, 4.0], [-0.5, 8.0], [0.5, 8.0]].map(Vec2::from).to_vec();
        let scene = Scene::new(Parts::simple("wall", points, vec![[1, 0], [3, 2]])).expect("a scene");
        let eye = Eye { position: Vec2::ZERO, target: Vec2::Y, up: Vec2::X, fov: 1.5, near: 0.1, far: 100.0 };
        (scene, View { eye, width: 256, height: 1 })
    }

    /// The same in space, looking along −z.
    fn space() -> (Scene<Solid>, View<Solid>) {
        let corner = |half: f32, z: f32| {
            [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]].map(Vec3::from)
        };
        let points = [corner(1.0, -4.0), corner(0.5, -8.0)].concat();
        let scene =
            Scene::new(Parts::simple("wall", points, vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]))
                .expect("a scene");
        let eye =
            Eye { position: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov: 1.0, near: 0.1, far: 100.0 };
        (scene, View { eye, width: 120, height: 90 })
    }

    /// Boxes by half width, nearest and farthest depth, aside by how much; and whether each is hidden.
    const BOXES: [([f64; 4], bool); 10] = [
        ([0.5, 6.0, 8.0, 0.0], true),
        ([1.9, 8.0, 9.0, 0.0], true),
        ([2.3, 8.0, 9.0, 0.0], false),
        ([0.5, 8.0, 9.0, 3.0], false),
        ([0.5, 2.0, 3.0, 0.0], false),
        ([0.2, 3.0, 6.0, 0.0], false),
        ([0.2, 4.0, 6.0, 0.0], true),
        ([0.2, -1.0, 1.0, 0.0], false),
        // Out of view, behind the eye and beside the image: no ray meets it.
        ([0.5, -9.0, -8.0, 0.0], true),
        ([0.5, 8.0, 9.0, 40.0], true),
    ];

    #[test]
    fn boxes_are_hidden_where_every_ray_meets_the_wall_first() {
        let ((flat, flat_view), (solid, solid_view)) = (flatland(), space());
        let (line, image) = (
            Sight::new(&flat, &flat_view, Surfaces::default()),
            Sight::new(&solid, &solid_view, Surfaces::default()),
        );
        for ([half, near, far, aside], hidden) in BOXES {
            let (low, high) = (DVec3::new(aside - half, near, 0.0), DVec3::new(aside + half, far, 0.0));
            assert_eq!(
                line.behind(low, high, &[]).is_ok(),
                hidden,
                "flatland: {half} from {near} to {far}, {aside} aside"
            );
            let (low, high) = (DVec3::new(aside - half, -half, -far), DVec3::new(aside + half, half, -near));
            assert_eq!(
                image.behind(low, high, &[]).is_ok(),
                hidden,
                "space: {half} from {near} to {far}, {aside} aside"
            );
        }
        // A wall does not hide the box that it is itself the front of.
        let wall = [PrimId(0), PrimId(1)];
        assert!(line.behind(DVec3::new(-0.2, 4.0, 0.0), DVec3::new(0.2, 6.0, 0.0), &wall[..1]).is_err());
        assert!(image.behind(DVec3::new(-0.2, -0.2, -6.0), DVec3::new(0.2, 0.2, -4.0), &wall).is_err());
        assert!(line.unseen(PrimId(0)).is_err() && line.unseen(PrimId(1)).is_ok());
        assert!(image.unseen(PrimId(0)).is_err() && image.unseen(PrimId(2)).is_ok());
    }

    #[test]
    fn what_faces_away_hides_nothing_where_sides_matter() {
        let one_sided = Surfaces { one_sided: true, ..Surfaces::default() };
        let (mut scene, view) = flatland();
        let (low, high) = (DVec3::new(-0.5, 6.0, 0.0), DVec3::new(0.5, 8.0, 0.0));
        assert!(Sight::new(&scene, &view, one_sided).behind(low, high, &[]).is_ok());
        let mut parts = scene.clone().into_parts();
        parts.prims[0] = Some([0, 1]);
        scene = Scene::new(parts).expect("a scene");
        assert!(Sight::new(&scene, &view, one_sided).behind(low, high, &[]).is_err());
        assert!(Sight::new(&scene, &view, Surfaces::default()).behind(low, high, &[]).is_ok());
    }
}
