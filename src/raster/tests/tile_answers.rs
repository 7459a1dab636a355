//! What tiles answer, against the planes of each box in f64 at each pixel.

use std::ops::Range;

use super::tiles::{ROUNDS, drawn, image, mixed, random_box, random_view, sizes};
use super::*;
use crate::geometry::Aabb;

/// Where a box begins (the nearest and the farthest of its front) and ends (the same of its back) along the
/// lines of sight through a square, `1/w`.
struct Depths {
    begins: [f64; 2],
    ends: [f64; 2],
}

impl Depths {
    /// Of a square of half a side about a pixel's center. The box is met from the farthest of its front
    /// planes on to the nearest of its back planes; the eye is between two planes that are both back planes.
    fn new(sight: &Sight, bounds: &Aabb<Vec3>, pixel: [u32; 2], half: f64) -> Self {
        let [x, y] = pixel.map(|p| f64::from(p) + 0.5);
        let corners =
            [[x - half, y - half], [x + half, y - half], [x - half, y + half], [x + half, y + half]];
        let rays = corners.map(|at| sight.ray(at));
        let mut depths = Self { begins: [f64::MAX; 2], ends: [0.0; 2] };
        for axis in 0..3 {
            let [low, high] = [bounds.min, bounds.max].map(|p| f64::from(p[axis]) - sight.eye[axis]);
            for (offset, is_front) in [(low, low > 0.0), (high, high < 0.0)] {
                let over = rays.map(|ray| ray[axis] / offset);
                let (far, near) = over.iter().fold((f64::MAX, f64::MIN), |(f, n), &v| (f.min(v), n.max(v)));
                let [first, second] = if is_front { &mut depths.begins } else { &mut depths.ends }.each_mut();
                let bound = |to: &mut f64, v: f64| *to = if is_front { to.min(v) } else { to.max(v) };
                if offset != 0.0 {
                    bound(first, near);
                    bound(second, far);
                }
            }
        }
        depths
    }
}

/// Columns and rows that the corners of a box reach, and one more.
fn reach(view: &View<Solid>, bounds: &Aabb<Vec3>) -> [Range<u32>; 2] {
    let projection = view.projection();
    let image = bounds.corners().map(|p| projection.clip(p).as_dvec3()).map(|c| c / c.z);
    let [low, high] = image.fold([DVec3::MAX, DVec3::MIN], |[l, h], p| [l.min(p), h.max(p)]);
    let cut = |from: f64, to: f64, side: u32| {
        let pixel = |v: f64| ((v + 1.0) * 0.5 * f64::from(side)).clamp(0.0, f64::from(side)) as u32;
        pixel(from).saturating_sub(1)..(pixel(to) + 2).min(side)
    };
    [cut(low.x, high.x, view.width), cut(-high.y, -low.y, view.height)]
}

/// A small box about a point that shows at a pixel's center, many of them at the image's border, about as
/// deep as what is drawn there.
fn box_at_a_pixel(dice: &mut Dice, view: &View<Solid>, truth: &Target) -> Aabb<Vec3> {
    let pixel = [view.width, view.height].map(|side| match dice.below(4) {
        0 => 0,
        1 => side - 1,
        _ => dice.below(side),
    });
    let depth = truth.depth[(pixel[1] * view.width + pixel[0]) as usize];
    let w = [1.0, 1.01, 1.2, dice.between(0.3, 1.0)][dice.below(4) as usize] / depth;
    let at = Sight::new(view).point(pixel.map(|p| f64::from(p) + 0.5), f64::from(w));
    let half = w * dice.between(0.1, 4.0) / view.height as f32;
    Aabb { min: at - half * dice.unit(), max: at + half }
}

/// Whether a box surely shows at some pixel, beginning before all that is drawn there; and whether it may.
fn by_pixels(view: &View<Solid>, truth: &Target, bounds: &Aabb<Vec3>) -> (bool, bool) {
    let (sight, [columns, rows]) = (Sight::new(view), reach(view, bounds));
    let (mut shows, mut may_show) = (false, false);
    for pixel in rows.flat_map(|y| columns.clone().map(move |x| [x, y])) {
        let depth = truth.depth[(pixel[1] * view.width + pixel[0]) as usize];
        // Where nothing is drawn all may show, if only beyond the far plane.
        let held = f64::from(if depth > 1.0 / view.eye.far { depth } else { 0.0 });
        // More than what boxes are grown by: a hundredth of a pixel, and twice `DEPTH_SLACK`.
        let around = Depths::new(&sight, bounds, pixel, 0.03);
        if around.begins[0] * 1.0005 >= around.ends[1].max(held) {
            may_show = true;
            let center = Depths::new(&sight, bounds, pixel, 0.0);
            shows |= center.begins[1] > 1.0001 * center.ends[0].max(f64::from(depth));
        }
    }
    (shows, may_show)
}

/// What surely begins before all that is drawn at some pixel is visible, and what surely begins behind it at
/// every pixel is not.
#[test]
fn answers_are_those_of_the_planes_at_each_pixel() {
    let (mut dice, mut counts) = (Dice::new(77), [0usize; 2]);
    for round in 0..ROUNDS / 2 {
        let (width, height) = sizes(round);
        let mut view = random_view(&mut dice, width, height);
        let mut parts = mixed(&mut dice, 100).into_parts();
        // Far from the origin coordinates are rounded by more.
        let off = dice.point([0.0, 0.0, 30.0, 3000.0][round as usize % 4]);
        parts.points.iter_mut().for_each(|p| *p += off);
        (view.eye.position, view.eye.target) = (view.eye.position + off, view.eye.target + off);
        let scene = Scene::new(parts).expect("the moved scene is valid");
        let truth = image(&scene, &view, ONE_SIDED);
        let mut a_box = |k: u32| match k % 2 {
            0 => {
                let Aabb { min, max } = random_box(&mut dice);
                Aabb { min: min + off, max: max + off }
            }
            _ => box_at_a_pixel(&mut dice, &view, &truth),
        };
        let mut boxes: Vec<Aabb<Vec3>> = (0..200).map(&mut a_box).collect();
        boxes.retain(|b| b.corners().all(|p| view.projection().depth(p) > 0.1));
        let mut answers = Vec::new();
        let mut tiles = drawn(&scene, &view, ONE_SIDED, Isa::best());
        tiles.hides_all(&Boxes::new(boxes.iter().copied()), true, Isa::best(), &mut answers);
        for (bounds, &answer) in boxes.iter().zip(&answers) {
            let (shows, may_show) = by_pixels(&view, &truth, bounds);
            counts[usize::from(answer == Answer::Visible)] += 1;
            assert!(!shows || answer == Answer::Visible, "{bounds:?} is {answer:?} and shows: {view:?}");
            assert!(may_show || answer != Answer::Visible, "{bounds:?} is visible and nowhere is: {view:?}");
        }
    }
    assert!(counts.iter().all(|&c| c > 1000), "hidden, visible: {counts:?}");
}
