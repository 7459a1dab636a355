//! The Eye: what culling sees with. (Where the person looks from is the explorer's Observer camera,
//! a type of its own in `app`; no function that culls takes it.)

use glam::{DVec2, DVec3};

use super::{Frustum, Space, Vector};

/// The viewpoint that culling sees with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye<S: Space> {
    /// Where it stands, world units.
    pub position: S::Vector,
    /// A point it looks at; differs from `position`.
    pub target: S::Vector,
    /// Roughly up, not parallel to the line of sight; ignored in flatland.
    pub up: S::Vector,
    /// Whole angle of view in radians, in (0, π): vertical in space, horizontal in flatland.
    pub fov: f32,
    /// View depth of the near plane, > 0.
    pub near: f32,
    /// View depth of the far plane, > `near`.
    pub far: f32,
}

impl<S: Space> Eye<S> {
    /// Unit line of sight.
    pub fn forward(&self) -> S::Vector {
        let d = self.target - self.position;
        d * (1.0 / d.length().max(f32::MIN_POSITIVE))
    }
    /// Why this eye cannot see, if it cannot: not finite, target at the eye, angle or depths out of range.
    pub fn fault(&self) -> Option<&'static str> {
        let finite = self.position.is_finite() && self.target.is_finite() && self.up.is_finite();
        if !(finite && self.fov.is_finite() && self.near.is_finite() && self.far.is_finite()) {
            Some("a coordinate, the angle or a depth is not a finite number")
        } else if (self.target - self.position).length() <= f32::MIN_POSITIVE {
            Some("the target is at the eye, so there is no direction to look in")
        } else if !(self.fov > 1e-4 && self.fov < std::f32::consts::PI - 1e-4) {
            Some("the angle of view must lie between 0 and 180 degrees")
        } else if !(self.near > 0.0 && self.far > self.near) {
            Some("near must be greater than 0 and far greater than near")
        } else {
            None
        }
    }
}

/// The greatest width and height of an image, in pixels, that the arithmetic of the rasterizer is exact for.
pub const MAX_SIDE_PX: u32 = 16384;

/// An Eye and the image it sees into. A flatland image has height 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<S: Space> {
    /// The viewpoint.
    pub eye: Eye<S>,
    /// Image width in pixels, 1 to [`MAX_SIDE_PX`].
    pub width: u32,
    /// Image height in pixels, 1 to [`MAX_SIDE_PX`]; 1 in flatland.
    pub height: u32,
}

impl<S: Space> View<S> {
    /// The samples of its pixels as pixels of a larger image: so many along each side of a pixel, or as many
    /// as such an image may have, but one at least.
    pub fn sampled(&self, samples: u32) -> Self {
        let samples = samples.min(MAX_SIDE_PX / self.width.max(self.height).max(1)).max(1);
        let down = if S::Vector::AXES == 2 { 1 } else { samples };
        Self { width: self.width * samples, height: self.height * down, ..*self }
    }
    /// The linear map from world to clip space.
    pub fn projection(&self) -> Projection<S::Vector> {
        Projection::new(self)
    }
    /// The volume that is seen.
    pub fn frustum(&self) -> Frustum<S::Vector> {
        Frustum::new(&self.projection(), self.eye.near, self.eye.far)
    }
}

/// World to clip space: `clip = M (point − eye)`, with no translation left to round.
///
/// The last clip component `w` is the view depth (distance along the line of sight). The others are
/// image coordinates times `w`: a point is in view where `|clip[i]| ≤ w` and `near ≤ w ≤ far`.
/// Clip y points up. Depth buffers hold `1/w`, which is linear in screen space; larger is nearer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection<V> {
    /// Position of the eye.
    pub eye: V,
    /// Rows of `M`; the first `AXES` are used and the last of those is the unit line of sight.
    pub rows: [V; 4],
}

impl<V: Vector> Projection<V> {
    fn new<S: Space<Vector = V>>(view: &View<S>) -> Self {
        let eye = &view.eye;
        let forward = eye.forward();
        let tan = (f64::from(eye.fov) * 0.5).tan();
        let aspect = f64::from(view.width) / f64::from(view.height.max(1));
        // In flatland `fov` is the angle across the image; in space it is the vertical angle.
        let scales = if V::AXES == 2 { [1.0 / tan, 0.0] } else { [1.0 / (tan * aspect), 1.0 / tan] };
        let mut rows = [V::default(); 4];
        for (row, (axis, scale)) in
            rows.iter_mut().zip(S::image_axes(forward, eye.up).into_iter().zip(scales))
        {
            *row = axis * scale as f32;
        }
        rows[V::AXES - 1] = forward;
        Self { eye: eye.position, rows }
    }
    /// Clip coordinates of a world point; `w` is the last component.
    #[inline]
    pub fn clip(&self, point: V) -> V {
        let relative = point - self.eye;
        V::from_fn(|a| self.rows[a].dot(relative))
    }
    /// View depth of a world point.
    #[inline]
    pub fn depth(&self, point: V) -> f32 {
        self.rows[V::AXES - 1].dot(point - self.eye)
    }
}

/// One view or a sequence of them: keyframes, a walk, an orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewPath<S: Space> {
    /// What it is called, such as `walk`.
    pub name: String,
    /// The views in order; never empty.
    pub views: Vec<View<S>>,
}

impl<S: Space> ViewPath<S> {
    /// A path of one view.
    pub fn single(view: View<S>) -> Self {
        Self { name: "view".into(), views: vec![view] }
    }
    /// The path resampled with `between` views added between each two keyframes, through the keyframes,
    /// smoothly: Catmull–Rom on position and target (Catmull and Rom 1974), linear in the rest.
    pub fn smoothed(&self, between: usize) -> Self {
        let n = self.views.len();
        let mut views = Vec::with_capacity(n + between * n.saturating_sub(1));
        for i in 0..n {
            views.push(self.views[i]);
            if i + 1 == n {
                break;
            }
            let key = |k: isize| &self.views[(i as isize + k).clamp(0, n as isize - 1) as usize];
            for step in 1..=between {
                let t = step as f32 / (between + 1) as f32;
                views.push(blend([key(-1), key(0), key(1), key(2)], t));
            }
        }
        Self { name: self.name.clone(), views }
    }
}

fn blend<S: Space>(keys: [&View<S>; 4], t: f32) -> View<S> {
    let spline = |p: [S::Vector; 4]| {
        let (t2, t3) = (t * t, t * t * t);
        p[0] * (-0.5 * t3 + t2 - 0.5 * t)
            + p[1] * (1.5 * t3 - 2.5 * t2 + 1.0)
            + p[2] * (-1.5 * t3 + 2.0 * t2 + 0.5 * t)
            + p[3] * (0.5 * t3 - 0.5 * t2)
    };
    let mix = |f: fn(&Eye<S>) -> f32| f(&keys[1].eye) * (1.0 - t) + f(&keys[2].eye) * t;
    let position = spline(keys.map(|k| k.eye.position));
    let mut target = spline(keys.map(|k| k.eye.target));
    if (target - position).length() <= f32::EPSILON * position.length().max(1.0) {
        target = position + keys[1].eye.forward();
    }
    let up = keys[1].eye.up * (1.0 - t) + keys[2].eye.up * t;
    let eye = Eye { position, target, up, fov: mix(|e| e.fov), near: mix(|e| e.near), far: mix(|e| e.far) };
    View { eye, ..*keys[1] }
}

/// The figure-8 walkthrough of the papers' experiments: the Gerono lemniscate `(cos t, sin t cos t)` scaled
/// to `half_extent`, traversed once in `count` steps, looking along the tangent. Returns position and unit
/// direction in the ground plane.
pub fn figure_eight(center: DVec2, half_extent: DVec2, count: usize) -> Vec<(DVec2, DVec2)> {
    let at = |k: usize| {
        let t = std::f64::consts::TAU * k as f64 / count.max(1) as f64;
        let p = center + half_extent * DVec2::new(t.cos(), 2.0 * t.sin() * t.cos());
        let d = half_extent * DVec2::new(-t.sin(), 2.0 * (2.0 * t).cos());
        (p, d.normalize_or(DVec2::X))
    };
    (0..count).map(at).collect()
}

/// A point `(x, y)` of the ground plane at `height` in space: flatland's y is space's −z.
pub fn raise(ground: DVec2, height: f64) -> DVec3 {
    DVec3::new(ground.x, height, -ground.y)
}
