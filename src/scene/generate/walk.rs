//! Ways through generated scenes: a walk in the shape of an 8 along straight stretches with rounded corners,
//! and flights whose line of sight is led too. Shared by all generators.

use std::ops::{Add, Mul};

use glam::{DVec3, Vec3};

use super::shapes::circle;
use crate::geometry::{Eye, Solid, View, ViewPath};

/// Height of a walker's eyes above the ground, m.
pub(super) const EYE: f64 = 1.6;
/// Views of a walk.
const VIEWS: usize = 240;

/// How a walk goes round its corners and where it looks.
pub(super) struct Manner {
    /// A corner is cut from so far before it to so far after it, m. At most half a stretch.
    pub(super) round: f64,
    /// It looks at the point so far ahead on the way, m.
    pub(super) ahead: f64,
    /// Far plane, m.
    pub(super) far: f64,
}

/// Once around the closed polyline of `stops`; `origin` is what was subtracted from the scene's coordinates.
pub(super) fn figure_8(stops: &[DVec3], manner: &Manner, origin: DVec3) -> ViewPath<Solid> {
    let mut line = Vec::new();
    for (i, corner) in stops.iter().enumerate() {
        let to = |other: DVec3| (other - *corner).normalize() * manner.round;
        let (from, on) = (stops[(i + stops.len() - 1) % stops.len()], stops[(i + 1) % stops.len()]);
        // A parabola that touches both stretches stays between them.
        let (a, b) = (*corner + to(from), *corner + to(on));
        line.extend(
            (0..=8)
                .map(|k| f64::from(k) / 8.0)
                .map(|t| a * ((1.0 - t) * (1.0 - t)) + *corner * (2.0 * t * (1.0 - t)) + b * (t * t)),
        );
    }
    line.push(line[0]);
    let lengths: Vec<f64> = line.windows(2).map(|w| w[0].distance(w[1])).collect();
    let step = lengths.iter().sum::<f64>() / VIEWS as f64;
    let at = |mut s: f64| {
        for (w, length) in line.windows(2).zip(&lengths) {
            if s <= *length {
                return w[0].lerp(w[1], s / length);
            }
            s -= length;
        }
        line[0]
    };
    let view = |k: usize| {
        let (here, there) =
            (at(step * k as f64), at((step * k as f64 + manner.ahead) % (step * VIEWS as f64)));
        sight(here - origin, there - origin, manner.far)
    };
    ViewPath { name: "figure 8".into(), views: (0..VIEWS).map(view).collect() }
}

/// The view from one point to another.
pub(super) fn sight(from: DVec3, to: DVec3, far: f64) -> View<Solid> {
    let eye = Eye {
        position: from.as_vec3(),
        target: to.as_vec3(),
        up: Vec3::Y,
        fov: 60f32.to_radians(),
        near: 0.1,
        far: far as f32,
    };
    View { eye, width: 1024, height: 1024 }
}

/// The view from one point to another in the image of Chamberlain et al. (1996, Table 2): 124×124 pixels, and
/// 60° across. `distance` tells how near and far what is seen begins and ends.
pub(super) fn small_view(from: DVec3, to: DVec3, distance: f64) -> View<Solid> {
    let mut view = sight(from, to, 4.0 * distance);
    view.eye.near = (0.01 * distance) as f32;
    (view.width, view.height) = (124, 124);
    view
}

/// Views of all that `points` span: at the four distances of Chamberlain et al. (1996, Table 2), 1.75, 3.5, 7
/// and 14 radii from the middle, `degrees` about the vertical; and a flight there from the farthest to the
/// nearest. The radius is half the diagonal of the bounds.
pub(super) fn around(points: &[Vec3], degrees: u32) -> [ViewPath<Solid>; 2] {
    let (low, high) = points
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let (middle, radius) = ((low + high) * 0.5, 0.5 * low.distance(high));
    let (c, s) = circle(degrees, 360);
    let eye = |radii: f64| middle + DVec3::new(s, 0.0, c) * (radii * radius);
    let distances = [1.75, 3.5, 7.0, 14.0];
    let views = distances.iter().map(|d| small_view(eye(*d), middle, d * radius)).collect();
    let stops: Vec<_> = distances.iter().rev().map(|d| (eye(*d), middle)).collect();
    let mut approach = flight(&stops, 120, 16.0 * radius, DVec3::ZERO);
    approach.views.iter_mut().for_each(|v| v.eye.near = (0.1 * radius) as f32);
    [ViewPath { name: "distances".into(), views }, ViewPath { name: "approach".into(), ..approach }]
}

/// A flight past stops, each where the eye is and what it looks at, along the curve of [`spline`]. As many
/// views between each two.
pub(super) fn flight(stops: &[(DVec3, DVec3)], views: u32, far: f64, origin: DVec3) -> ViewPath<Solid> {
    let view = |k: u32| {
        let t = f64::from(k) / f64::from(views - 1);
        let [from, to] = [spline(stops.len(), |k| stops[k].0, t), spline(stops.len(), |k| stops[k].1, t)];
        sight(from - origin, to - origin, far)
    };
    ViewPath { name: "flight".into(), views: (0..views).map(view).collect() }
}

/// The point at `t`, 0..1, of a quadratic B-spline of `count` stops: it stays within the triangles of three
/// stops in a row and goes through the first and the last.
pub(super) fn spline<T>(count: usize, stop: impl Fn(usize) -> T, t: f64) -> T
where
    T: Mul<f64, Output = T> + Add<Output = T>,
{
    // From the middle of a doubled first stop to that of a doubled last one.
    let way = t * count as f64;
    let span = (way as usize).min(count - 1);
    let t = way - span as f64;
    let [before, here, after] = [span.saturating_sub(1), span, (span + 1).min(count - 1)].map(stop);
    let weights = [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t * (1.0 - t), 0.5 * t * t];
    before * weights[0] + here * weights[1] + after * weights[2]
}

/// The first primitive that the walk of a scene goes through, if any: its object's name and the view before
/// it. A walk in the shape of an 8 is closed, a flight is not.
#[cfg(test)]
pub(super) fn touched(scene: &crate::scene::Scene<Solid>) -> Option<(String, usize)> {
    let walk: Vec<DVec3> = scene.paths()[0].views.iter().map(|v| v.eye.position.as_dvec3()).collect();
    let side = |a, b, c, d| crate::geometry::orient3d(a, b, c, d) > 0.0;
    let closed = scene.paths()[0].name == "figure 8";
    for (i, &a) in walk.iter().enumerate().take(walk.len() - usize::from(!closed)) {
        let b = walk[(i + 1) % walk.len()];
        let (low, high) = (a.min(b).as_vec3(), a.max(b).as_vec3());
        for &prim in scene.live() {
            let bounds = scene.prim_bounds(prim);
            if bounds.min.cmpgt(high).any() || bounds.max.cmplt(low).any() {
                continue;
            }
            let p: Vec<DVec3> = scene.prim_points(prim).map(Vec3::as_dvec3).collect();
            let apart = side(p[0], p[1], p[2], a) == side(p[0], p[1], p[2], b);
            let turns = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| side(a, b, p[i], p[j]));
            if !apart && turns[0] == turns[1] && turns[1] == turns[2] {
                return Some((scene.objects()[scene.object_of(prim).at()].name.clone(), i));
            }
        }
    }
    None
}
