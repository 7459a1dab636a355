//! A path walked at a speed: views at equal steps along the closed polyline through a path's eyes.
//!
//! How dense the path's own views are does not matter, so walks of two paths, or of one path at two speeds,
//! compare. Cost: O(views of the path + views of the walk · log).

use super::{Eye, Space, Vector, View, ViewPath};

/// How far a walker gets from one frame to the next, m: 1.4 m/s, the speed at which people prefer to walk
/// (Browning et al. 2006), at 30 frames a second.
pub const WALKING_STEP_M: f32 = 1.4 / 30.0;

/// Least distance from an eye to its target in parts of its distance from the origin: the line of sight then
/// keeps 14 of the 24 bits of a coordinate.
const TARGET: f32 = 1e-3;

impl<S: Space> ViewPath<S> {
    /// `count` views (at least one) that begin at the path's first view and get on by `step` (world units,
    /// along the way) each. After the last view the way goes straight to the first and on; a negative step
    /// goes backwards. Directions turn evenly from one view to the next. A turn on the spot takes no way, so
    /// it is a jump.
    pub fn walked(&self, step: f32, count: usize) -> Self {
        let n = self.views.len();
        let position = |k: usize| self.views[k % n].eye.position;
        // Where each view stands on the way, and at the end the length of the whole.
        let mut marks = Vec::with_capacity(n + 1);
        let mut length = 0.0f64;
        marks.push(length);
        for k in 0..n {
            length += f64::from((position(k + 1) - position(k)).length());
            marks.push(length);
        }
        let step = if step.is_finite() && length > 0.0 && length.is_finite() { f64::from(step) } else { 0.0 };
        let at = |frame: usize| {
            let s = if step == 0.0 { 0.0 } else { (frame as f64 * step).rem_euclid(length) };
            // The last view at or before `s`; the walk's first view is the path's.
            let k = if s == 0.0 { 0 } else { marks.partition_point(|m| *m <= s).clamp(1, n) - 1 };
            let t = if s == 0.0 { 0.0 } else { (s - marks[k]) / (marks[k + 1] - marks[k]) };
            between(&self.views[k], &self.views[(k + 1) % n], t.clamp(0.0, 1.0) as f32)
        };
        Self { name: self.name.clone(), views: (0..count.max(1)).map(at).collect() }
    }
}

/// The view at `t` of the way from `a` to `b`, 0..1.
fn between<S: Space>(a: &View<S>, b: &View<S>, t: f32) -> View<S> {
    if t == 0.0 {
        return *a;
    }
    let near = if t < 0.5 { a } else { b };
    let mix = |f: fn(&Eye<S>) -> f32| f(&a.eye) * (1.0 - t) + f(&b.eye) * t;
    let turn = |a: S::Vector, b: S::Vector, near: S::Vector| {
        let sum = a * (1.0 - t) + b * t;
        // Opposite directions leave nothing between them.
        if sum.length() > 1e-3 { sum * (1.0 / sum.length()) } else { near }
    };
    let unit = |v: S::Vector| v * (1.0 / v.length().max(f32::MIN_POSITIVE));
    let position = a.eye.position * (1.0 - t) + b.eye.position * t;
    let forward = turn(a.eye.forward(), b.eye.forward(), near.eye.forward());
    let up = turn(unit(a.eye.up), unit(b.eye.up), near.eye.up);
    let distance = mix(|e| (e.target - e.position).length()).max(position.length() * TARGET);
    let eye = Eye {
        position,
        target: position + forward * distance,
        up,
        fov: mix(|e| e.fov),
        near: mix(|e| e.near),
        far: mix(|e| e.far),
    };
    View { eye, ..*near }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};

    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, Solid, figure_eight, raise};

    fn eight(keys: usize, scale: f64, at: f64) -> ViewPath<Solid> {
        let views =
            figure_eight(DVec2::splat(at), DVec2::new(2.0, 1.0) * scale, keys).into_iter().map(|(p, d)| {
                let (position, target) = (raise(p, 1.6).as_vec3(), raise(p + d * scale, 1.6).as_vec3());
                View {
                    eye: Eye { position, target, up: Vec3::Y, fov: 1.0, near: 0.1, far: 100.0 },
                    width: 64,
                    height: 48,
                }
            });
        ViewPath { name: "8".into(), views: views.collect() }
    }
    fn length<S: Space>(path: &ViewPath<S>) -> f32 {
        let n = path.views.len();
        (0..n).map(|k| (path.views[(k + 1) % n].eye.position - path.views[k].eye.position).length()).sum()
    }

    /// Angle between two vectors.
    fn angle(a: Vec3, b: Vec3) -> f32 {
        a.normalize().dot(b.normalize()).clamp(-1.0, 1.0).acos()
    }

    /// Two eyes are as far apart as the step, less what the bends between them cut off; the line of sight
    /// turns no faster than from key to key, the seam included; and the walk goes round.
    #[test]
    fn eyes_are_evenly_spaced_whatever_the_keys() {
        for keys in [60, 240, 1001] {
            let path = eight(keys, 20.0, 0.0);
            let whole = length(&path);
            let eye = |k: usize| path.views[k % keys].eye;
            let edge = |k: usize| eye(k + 1).position - eye(k).position;
            let shortest = (0..keys).map(|k| edge(k).length()).fold(f32::INFINITY, f32::min);
            let bend = (0..keys).map(|k| angle(edge(k), edge(k + 1))).fold(0.0, f32::max);
            let rate = (0..keys)
                .map(|k| angle(eye(k).forward(), eye(k + 1).forward()) / edge(k).length())
                .fold(0.0, f32::max);
            for factor in [0.25f32, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
                let step = WALKING_STEP_M * factor;
                let count = (whole / step) as usize + 50;
                let walk = path.walked(step, count);
                assert_eq!(walk.views[0], path.views[0]);
                // A way that bends by θ in all keeps at least cos(θ/2) of its length.
                let least = step * (0.5 * bend * (1.0 + (step / shortest).floor())).cos();
                for (k, w) in walk.views.windows(2).enumerate() {
                    let apart = (w[1].eye.position - w[0].eye.position).length();
                    assert!(
                        apart <= step + 2e-5 && apart >= least - 2e-5,
                        "{keys} keys, x{factor}, frame {k}: {apart} for {step}"
                    );
                    let turn = angle(w[1].eye.forward(), w[0].eye.forward());
                    assert!(
                        turn < 1.1 * rate * step + 2e-3,
                        "{keys} keys, x{factor}, frame {k}: turned by {turn}"
                    );
                }
                // Once around, the walk is back where it began, but for a part of a step.
                let back = &walk.views[(whole / step).round() as usize].eye;
                assert!((back.position - path.views[0].eye.position).length() < step + 1e-2);
            }
        }
    }

    #[test]
    fn any_walk_is_finite_and_without_fault() {
        let mut dice = Dice::new(5);
        let mut signed = |scale: f32| dice.signed(scale);
        for round in 0..300 {
            let (far_away, n) = ([0.0, 10.0, 1e6][round % 3], 1 + round % 7);
            let eye = |signed: &mut dyn FnMut(f32) -> f32| {
                let position = Vec3::from_fn(|_| far_away + signed(5.0));
                let target = position + Vec3::from_fn(|_| signed(2.0) + 0.3).normalize() * 2.0;
                Eye::<Solid> { position, target, up: Vec3::Y, fov: 1.0 + signed(0.5), near: 0.1, far: 50.0 }
            };
            let mut views: Vec<View<Solid>> =
                (0..n).map(|_| View { eye: eye(&mut signed), width: 64, height: 48 }).collect();
            // Eyes that stand where the one before does, and eyes that look back.
            if round % 5 == 0 {
                views.push(views[0]);
            }
            if round % 4 == 0 {
                let mut back = views[0];
                back.eye.target = back.eye.position * 2.0 - back.eye.target;
                back.eye.position.x += 1.0;
                back.eye.target.x += 1.0;
                views.push(back);
            }
            let path = ViewPath { name: "any".into(), views };
            assert!(path.views.iter().all(|v| v.eye.fault().is_none()), "round {round}: the path itself");
            for step in
                [0.0, WALKING_STEP_M * 0.25, WALKING_STEP_M * 16.0, -0.3, 1e9, f32::NAN, f32::INFINITY]
            {
                let walk = path.walked(step, 100);
                assert_eq!((walk.views.len(), walk.views[0]), (100, path.views[0]));
                assert!(walk.views.iter().all(|v| v.eye.fault().is_none()), "round {round}, step {step}");
            }
        }
    }

    #[test]
    fn standing_and_single_views_stay() {
        let path = eight(40, 10.0, 3.0);
        assert!(path.walked(0.0, 20).views.iter().all(|v| *v == path.views[0]));
        let single = ViewPath::single(path.views[7]);
        assert!(single.walked(WALKING_STEP_M, 20).views.iter().all(|v| *v == path.views[7]));
        assert_eq!(path.walked(1.0, 0).views.len(), 1);
        // Backwards is the same way.
        let (on, back) = (path.walked(length(&path) / 7.0, 8), path.walked(length(&path) / -7.0, 8));
        for k in 0..8 {
            assert!((on.views[k].eye.position - back.views[7 - k].eye.position).length() < 1e-3, "{k}");
        }
        // Flatland walks too.
        let eye = |x: f32, y: f32| Eye::<Flat> {
            position: glam::Vec2::new(x, y),
            target: glam::Vec2::new(9.0, 9.0),
            up: glam::Vec2::Y,
            fov: 1.0,
            near: 0.1,
            far: 50.0,
        };
        let views =
            [eye(0.0, 0.0), eye(3.0, 0.0), eye(3.0, 4.0)].map(|eye| View { eye, width: 64, height: 1 });
        let walk = ViewPath { name: "triangle".into(), views: views.to_vec() }.walked(2.0, 7);
        assert!(
            (walk.views[6].eye.position - glam::Vec2::ZERO).length() < 1e-5
                && (walk.views[2].eye.position.y - 1.0).abs() < 1e-5
        );
    }
}
