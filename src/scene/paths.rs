//! Paths of views that are made rather than read: the figure-8 walkthrough, and random views for tests.

use glam::DVec2;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::Scene;
use crate::geometry::{Eye, Space, Vector, View, ViewPath, figure_eight, raise};

/// The figure-8 walkthrough of the papers' experiments through the middle of a scene, in `count` views of
/// 1024 pixels. In space at eye height, 1.6 units above the lowest point, or at half the height of a lower
/// scene.
pub fn figure_eight_path<S: Space>(scene: &Scene<S>, count: usize) -> ViewPath<S> {
    let bounds = scene.bounds();
    let flat = S::Vector::AXES == 2;
    // The ground plane's second axis is y in flatland and −z in space.
    let ground = |v: S::Vector| {
        DVec2::new(f64::from(v.get(0)), if flat { f64::from(v.get(1)) } else { -f64::from(v.get(2)) })
    };
    let half = (ground(bounds.size()).abs() * 0.35).max(DVec2::splat(1e-6));
    let height = f64::from(bounds.min.get(1)) + (f64::from(bounds.size().get(1)) * 0.5).min(1.6);
    let place = |p: DVec2| {
        if flat {
            S::Vector::from_fn(|a| p[a] as f32)
        } else {
            S::Vector::from_fn(|a| raise(p, height)[a] as f32)
        }
    };
    let reach = f64::from(bounds.diagonal()).max(1e-6);
    let views = figure_eight(ground(bounds.center()), half, count.max(1)).into_iter().map(|(at, along)| {
        let (position, target) = (place(at), place(at + along * reach * 0.1));
        View {
            eye: eye::<S>(position, target, reach as f32),
            width: 1024,
            height: if flat { 1 } else { 1024 },
        }
    });
    ViewPath { name: "figure 8".into(), views: views.collect() }
}

/// The path through the motions of a scene whose own `paths` are all shorter: `motion`, a view a frame, each
/// of them `view`. `None` where nothing moves, or a path is as long.
pub fn motion_path<S: Space>(scene: &Scene<S>, paths: &[ViewPath<S>], view: View<S>) -> Option<ViewPath<S>> {
    let count = scene.frame_count();
    let is_missing = count > 1 && paths.iter().all(|p| p.views.len() < count);
    is_missing.then(|| ViewPath { name: "motion".into(), views: vec![view; count] })
}

/// `count` views of 256 pixels from random points inside the scene's bounds in random directions.
pub fn random_views<S: Space>(scene: &Scene<S>, count: usize, seed: u64) -> Vec<View<S>> {
    let mut rng = Pcg32::new(seed, 31);
    let mut unit = move || (rng.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
    let bounds = scene.bounds();
    let reach = bounds.diagonal().max(1e-6);
    let view = |_| {
        let position = S::Vector::from_fn(|a| bounds.min.get(a) + bounds.size().get(a) * unit());
        // Directions are even over the sphere: points of a ball, the rest of the cube refused.
        let direction = loop {
            let d = S::Vector::from_fn(|_| unit() * 2.0 - 1.0);
            if (0.01..=1.0).contains(&d.dot(d)) {
                break d;
            }
        };
        let target = position + direction * (reach * 0.1);
        View {
            eye: eye::<S>(position, target, reach),
            width: 256,
            height: if S::Vector::AXES == 2 { 1 } else { 256 },
        }
    };
    (0..count).map(view).collect()
}

fn eye<S: Space>(position: S::Vector, target: S::Vector, reach: f32) -> Eye<S> {
    let up = S::Vector::from_fn(|a| if a == 1 { 1.0 } else { 0.0 });
    Eye { position, target, up, fov: 60f32.to_radians(), near: (reach * 1e-3).min(0.1), far: reach * 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Flat, Solid};
    use crate::scene::samples::soup;

    fn views_are_valid<S: Space>() {
        let scene = soup::<S>(5, 20);
        let views = random_views(&scene, 50, 3);
        assert_eq!(views, random_views(&scene, 50, 3));
        assert_ne!(views, random_views(&scene, 50, 4));
        assert!(views.iter().all(|v| v.eye.fault().is_none() && scene.bounds().contains(v.eye.position)));
        let path = figure_eight_path(&scene, 40);
        assert!(
            path.views.len() == 40
                && path
                    .views
                    .iter()
                    .all(|v| v.eye.fault().is_none() && scene.bounds().contains(v.eye.position))
        );
    }

    #[test]
    fn made_views_can_see_and_stay_inside() {
        views_are_valid::<Flat>();
        views_are_valid::<Solid>();
    }
}
