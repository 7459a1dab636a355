//! Geometry against sampling and double precision.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::dice::Dice;
use super::*;

fn random_view<S: Space>(dice: &mut Dice, spread: f32) -> View<S> {
    let position = S::Vector::from_fn(|_| dice.signed(spread));
    let toward = S::Vector::from_fn(|_| dice.signed(1.0) + 1e-3);
    let up = S::Vector::from_fn(|a| if a == 1 { 1.0 } else { dice.signed(0.3) });
    let near = 0.01 + dice.unit();
    let eye = Eye {
        position,
        target: position + toward,
        up,
        fov: 0.2 + dice.unit() * 2.5,
        near,
        far: near + 0.1 + dice.unit() * 100.0,
    };
    View {
        eye,
        width: 1 + dice.below(2000),
        height: if S::Vector::AXES == 2 { 1 } else { 1 + dice.below(2000) },
    }
}

fn random_box<V: Vector>(dice: &mut Dice, around: V) -> Aabb<V> {
    let scale = 10f32.powf(dice.signed(2.0));
    let center = around + V::from_fn(|_| dice.signed(4.0 * scale));
    let half = V::from_fn(|_| dice.unit() * scale);
    Aabb { min: center - half, max: center + half }
}

/// Image coordinates over depth and depth of a point, from the Eye's definition alone, in f64.
fn exact_clip<S: Space>(view: &View<S>, point: S::Vector) -> [f64; 3] {
    let at = |v: S::Vector, a: usize| if a < S::Vector::AXES { f64::from(v.get(a)) } else { 0.0 };
    let vec = |v: S::Vector| DVec3::new(at(v, 0), at(v, 1), at(v, 2));
    let eye = &view.eye;
    let forward = (vec(eye.target) - vec(eye.position)).normalize();
    let flat = S::Vector::AXES == 2;
    let up = if flat { DVec3::Z } else { vec(eye.up) };
    let right = forward.cross(up).normalize();
    let tan = (f64::from(eye.fov) / 2.0).tan();
    let aspect = if flat { 1.0 } else { f64::from(view.width) / f64::from(view.height) };
    let p = vec(point) - vec(eye.position);
    [
        right.dot(p) / (tan * aspect),
        if flat { 0.0 } else { right.cross(forward).dot(p) / tan },
        forward.dot(p),
    ]
}

fn sample_in<V: Vector>(dice: &mut Dice, bounds: &Aabb<V>) -> V {
    V::from_fn(|a| bounds.min.get(a) + (bounds.max.get(a) - bounds.min.get(a)) * dice.unit())
}

fn in_view<S: Space>(view: &View<S>, clip: [f64; 3], margin: f64) -> bool {
    let [x, y, w] = clip;
    let m = margin * w.abs().max(1e-9);
    x.abs() < w - m
        && (S::Vector::AXES == 2 || y.abs() < w - m)
        && w > f64::from(view.eye.near) + m
        && w < f64::from(view.eye.far) - m
}

/// A box called outside holds no point in view; a box called inside holds no point out of view; and
/// a box clearly beyond one plane is found.
fn frustum_check<S: Space>(seed: u64) {
    let mut dice = Dice::new(seed);
    let (mut outside, mut inside, mut missed) = (0, 0, 0);
    for _ in 0..20_000 {
        let view = random_view::<S>(&mut dice, 100.0);
        let bounds = random_box(&mut dice, view.eye.position);
        let points: Vec<S::Vector> =
            bounds.corners().chain((0..8).map(|_| sample_in(&mut dice, &bounds))).collect();
        let clips: Vec<_> = points.iter().map(|&p| exact_clip(&view, p)).collect();
        let test = view.frustum().test(&bounds, Frustum::<S::Vector>::ALL);
        assert_eq!(
            view.frustum().excludes(&bounds),
            matches!(test, FrustumTest::Outside(_)),
            "one test and all at a time: {bounds:?}"
        );
        match test {
            FrustumTest::Outside(test) => {
                outside += 1;
                assert!(test.far_corner < 0.0);
                assert!(
                    clips.iter().all(|&c| !in_view(&view, c, 0.0)),
                    "a box with a point in view was called outside"
                );
            }
            FrustumTest::Inside => {
                inside += 1;
                assert!(
                    clips.iter().all(|&c| in_view(&view, c, -1e-4)),
                    "a box with a point out of view was called inside"
                );
            }
            FrustumTest::Partial(mask) => {
                assert_ne!(mask, 0);
                let beyond = |f: &dyn Fn(&[f64; 3]) -> f64| {
                    clips.iter().all(|c| f(c) < -1e-3 * (c[0].abs() + c[1].abs() + c[2].abs() + 1.0))
                };
                let (near, far) = (f64::from(view.eye.near), f64::from(view.eye.far));
                missed += i32::from(
                    beyond(&|c| c[2] - near)
                        || beyond(&|c| far - c[2])
                        || beyond(&|c| c[2] - c[0])
                        || beyond(&|c| c[2] + c[0]),
                );
            }
        }
    }
    assert!(outside > 1000 && inside > 50, "the cases are mixed: {outside} outside, {inside} inside");
    assert_eq!(missed, 0, "boxes clearly beyond a plane that were not found");
}

#[test]
fn the_frustum_test_is_conservative_and_effective_in_flatland() {
    frustum_check::<Flat>(1);
}

#[test]
fn the_frustum_test_is_conservative_and_effective_in_space() {
    frustum_check::<Solid>(2);
}

#[test]
fn a_plane_mask_leaves_planes_out() {
    let view = random_view::<Solid>(&mut Dice::new(9), 1.0);
    let behind = view.eye.position - view.eye.forward() * 50.0;
    let bounds = Aabb { min: behind - Vec3::splat(0.1), max: behind + Vec3::splat(0.1) };
    assert!(matches!(view.frustum().test(&bounds, Frustum::<Vec3>::ALL), FrustumTest::Outside(_)));
    assert_eq!(view.frustum().test(&bounds, 0), FrustumTest::Inside, "no plane, no objection");
}

/// The pixel coordinates of a point in clip space; flatland points lie in the middle of the row.
fn pixel_of<S: Space>(view: &View<S>, clip: [f64; 3]) -> (f64, f64) {
    let x = (clip[0] / clip[2] * 0.5 + 0.5) * f64::from(view.width);
    let y = (0.5 - clip[1] / clip[2] * 0.5) * f64::from(view.height);
    (x, if S::Vector::AXES == 2 { 0.5 } else { y })
}

/// A point of a box that is in view lies within the box's footprint.
fn footprint_holds<S: Space>(view: &View<S>, bounds: &Aabb<S::Vector>, point: S::Vector) {
    let near = view.eye.near;
    let clip = exact_clip(view, point);
    match project_box(&view.projection(), bounds, near, view.eye.far, view.width, view.height) {
        Footprint::Outside => {
            assert!(!in_view(view, clip, 0.0), "a box with a point in view has no footprint")
        }
        Footprint::Seen(image) if in_view(view, clip, 0.0) => {
            let (r, (x, y)) = (image.pixels, pixel_of(view, clip));
            // Half a pixel: the rectangle holds centers.
            let holds = |from: u32, v: f64, to: u32| f64::from(from) - 0.5 <= v && v <= f64::from(to) + 0.5;
            assert!(holds(r.x0, x, r.x1) && holds(r.y0, y, r.y1), "({x}, {y}) lies outside {r:?}");
            assert!((1.0 / clip[2]) as f32 <= image.nearest, "a point is nearer than the nearest depth");
            assert_eq!(image.nearest, nearest_depth(&view.projection(), bounds, near));
        }
        _ => {}
    }
}

/// A footprint is no larger than the image of the box's exact corners, but for rounding and the margin.
fn footprint_is_tight<S: Space>(view: &View<S>, bounds: &Aabb<S::Vector>, image: &BoxImage) {
    let width = f64::from(view.width);
    let exact: Vec<f64> = bounds.corners().map(|c| pixel_of(view, exact_clip(view, c)).0).collect();
    let low = exact.iter().copied().fold(f64::INFINITY, f64::min).clamp(0.0, width);
    let high = exact.iter().copied().fold(f64::NEG_INFINITY, f64::max).clamp(0.0, width);
    let r = image.pixels;
    assert!(
        f64::from(r.x1 - r.x0) <= high - low + 1.0 + 2.0 * MARGIN_PX,
        "{r:?} is much wider than {low}..{high}"
    );
}

fn footprint_check<S: Space>(seed: u64) {
    let mut dice = Dice::new(seed);
    let mut rects = 0;
    for _ in 0..20_000 {
        let view = random_view::<S>(&mut dice, 100.0);
        let bounds = random_box(&mut dice, view.eye.position);
        for _ in 0..16 {
            footprint_holds(&view, &bounds, sample_in(&mut dice, &bounds));
        }
        let (near, far) = (view.eye.near, view.eye.far);
        let footprint = project_box(&view.projection(), &bounds, near, far, view.width, view.height);
        if let Footprint::Seen(image) = footprint {
            rects += 1;
            footprint_is_tight(&view, &bounds, &image);
        }
    }
    assert!(rects > 500, "only {rects} rectangles");
}

#[test]
fn footprints_hold_what_is_in_view_in_flatland() {
    footprint_check::<Flat>(3);
}

#[test]
fn footprints_hold_what_is_in_view_in_space() {
    footprint_check::<Solid>(4);
}

#[test]
fn a_box_around_the_eye_or_across_the_near_plane_is_not_guessed() {
    let mut dice = Dice::new(5);
    for _ in 0..1000 {
        let view = random_view::<Solid>(&mut dice, 10.0);
        let around =
            Aabb { min: view.eye.position - Vec3::splat(2.0), max: view.eye.position + Vec3::splat(2.0) };
        assert_eq!(
            project_box(&view.projection(), &around, view.eye.near, view.eye.far, 64, 64),
            Footprint::CrossesNear
        );
    }
}

fn eye3(target: Vec3) -> Eye<Solid> {
    Eye { position: Vec3::ZERO, target, up: Vec3::Y, fov: 90f32.to_radians(), near: 1.0, far: 10.0 }
}

#[test]
fn clip_space_is_right_handed_with_y_up() {
    let view = View { eye: eye3(Vec3::NEG_Z), width: 200, height: 100 };
    let clip = view.projection().clip(Vec3::new(4.0, 2.0, -2.0));
    assert!(clip.abs_diff_eq(Vec3::new(2.0, 2.0, 2.0), 1e-6), "{clip}");
    assert_eq!(view.projection().depth(Vec3::new(0.0, 0.0, -7.0)), 7.0);
    let eye = Eye::<Flat> {
        position: Vec2::ZERO,
        target: Vec2::Y,
        up: Vec2::ZERO,
        fov: 90f32.to_radians(),
        near: 1.0,
        far: 10.0,
    };
    let clip = View { eye, width: 100, height: 1 }.projection().clip(Vec2::new(3.0, 3.0));
    assert!(
        clip.abs_diff_eq(Vec2::new(3.0, 3.0), 1e-6),
        "to the right of an eye that looks up the page: {clip}"
    );
}

#[test]
fn looking_straight_up_still_gives_an_image() {
    let view = View { eye: eye3(Vec3::Y), width: 10, height: 10 };
    let rows = view.projection().rows;
    assert!(rows.iter().take(3).all(|r| r.is_finite() && r.length() > 0.9));
    assert!(rows[0].dot(rows[1]).abs() < 1e-6 && rows[0].dot(rows[2]).abs() < 1e-6);
}

#[test]
fn frustum_corners_lie_on_their_planes() {
    let mut dice = Dice::new(6);
    for _ in 0..200 {
        let view = random_view::<Solid>(&mut dice, 10.0);
        let frustum = view.frustum();
        let corners = Frustum::corners(&view.projection(), view.eye.near, view.eye.far);
        for (plane, on) in [
            (0, [0, 3, 4, 7]),
            (1, [1, 2, 5, 6]),
            (2, [0, 1, 4, 5]),
            (3, [2, 3, 6, 7]),
            (4, [0, 1, 2, 3]),
            (5, [4, 5, 6, 7]),
        ] {
            let (n, d) = frustum.plane(plane);
            for i in on {
                let distance = n.dot(corners[i] - frustum.eye) + d;
                assert!(
                    distance.abs() <= 1e-3 * (corners[i] - frustum.eye).length(),
                    "corner {i}, plane {plane}: {distance}"
                );
            }
        }
    }
}

#[test]
fn an_eye_that_cannot_see_says_why() {
    let good = eye3(Vec3::NEG_Z);
    assert_eq!(good.fault(), None);
    let faults = [
        Eye { position: Vec3::NAN, ..good },
        Eye { target: Vec3::ZERO, ..good },
        Eye { fov: 0.0, ..good },
        Eye { fov: 3.2, ..good },
        Eye { near: 0.0, ..good },
        Eye { far: 0.5, ..good },
        Eye { far: f32::INFINITY, ..good },
    ];
    assert!(faults.iter().all(|e| e.fault().is_some()));
}

#[test]
fn a_smoothed_path_passes_through_its_keyframes_and_stays_level() {
    let view = |x: f32| View {
        eye: Eye {
            position: Vec3::new(x, 1.7, x * x),
            target: Vec3::new(x + 1.0, 1.7, 0.0),
            ..eye3(Vec3::X)
        },
        width: 8,
        height: 8,
    };
    let path = ViewPath { name: "walk".into(), views: (0..4).map(|i| view(i as f32)).collect() };
    let smooth = path.smoothed(9);
    assert_eq!(smooth.views.len(), 31);
    for i in 0..4 {
        assert_eq!(smooth.views[i * 10], path.views[i]);
    }
    assert!(smooth.views.iter().all(|v| (v.eye.position.y - 1.7).abs() < 1e-5));
    let step =
        smooth.views.windows(2).map(|w| (w[1].eye.position - w[0].eye.position).length()).fold(0.0, f32::max);
    assert!(step < 1.0, "no jump: {step}");
}

#[test]
fn the_figure_eight_closes_and_crosses_its_middle() {
    let points = figure_eight(DVec2::new(3.0, 4.0), DVec2::new(10.0, 5.0), 400);
    let gap = points[0].0.distance(points[399].0);
    let longest = points.windows(2).map(|w| w[0].0.distance(w[1].0)).fold(0.0, f64::max);
    assert!(gap <= longest * 1.01);
    let near: Vec<bool> = points.iter().map(|p| p.0.distance(DVec2::new(3.0, 4.0)) < longest).collect();
    assert_eq!(near.windows(2).filter(|w| !w[0] && w[1]).count(), 2, "two passes through the middle");
    assert!(points.iter().all(|p| (p.1.length() - 1.0).abs() < 1e-12));
    assert_eq!(raise(DVec2::new(1.0, 2.0), 3.0), DVec3::new(1.0, 3.0, -2.0));
}

#[test]
fn orientation_is_exact_where_rounding_would_lie() {
    let a = DVec2::new(0.5, 0.5);
    let (b, c) = (DVec2::new(12.0, 12.0), DVec2::new(24.0, 24.0));
    assert_eq!(orient2d(a, b, c), 0.0);
    let up = DVec2::new(0.5, 0.5 + f64::EPSILON);
    assert!(orient2d(up, b, c) > 0.0 && orient2d(up, c, b) < 0.0);
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    assert!(orient3d(x, y, z, DVec3::ONE) > 0.0, "seen counter-clockwise from outside");
    assert!(orient3d(x, y, z, DVec3::ZERO) < 0.0);
    assert_eq!(orient3d(x, y, z, DVec3::new(0.25, 0.25, 0.5)), 0.0);
}

#[test]
fn front_is_where_corners_run_counter_clockwise() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert!(!faces_away::<Solid>(Vec3::Z, &triangle) && faces_away::<Solid>(-Vec3::Z, &triangle));
    assert!(!faces_away::<Solid>(Vec3::new(5.0, 5.0, 0.0), &triangle), "edge on is not away");
    let segment = [Vec2::ZERO, Vec2::X];
    assert!(!faces_away::<Flat>(Vec2::Y, &segment) && faces_away::<Flat>(-Vec2::Y, &segment));
}

#[test]
fn boxes_know_their_corners_and_edges() {
    let b = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) };
    assert_eq!(Aabb::of(b.corners()), b);
    assert_eq!(Aabb::<Vec3>::edges().count(), 12);
    assert_eq!(Aabb::<Vec2>::edges().count(), 4);
    let length: f32 = Aabb::<Vec3>::edges().map(|(i, j)| (b.corner(i) - b.corner(j)).length()).sum();
    assert_eq!(length, 24.0);
    assert!(Aabb::<Vec3>::empty().is_empty() && !b.is_empty() && b.encloses(&b) && b.touches(&b));
}
