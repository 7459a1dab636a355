//! The rules an image keeps: edges shared without gap or overlap, order, subsets, rays, the frustum.

use super::super::setup::{Plane, area};
use super::super::vertex::{Camera, Vertex};
use super::*;
use crate::geometry::{Frustum, FrustumTest};

/// One triangle of a straight view, corners in pixels, at view depth 4.
fn flat_triangle(size: u32, corners: [[f64; 2]; 3]) -> [Vec3; 3] {
    corners.map(|[x, y]| at_px(size, x, y, 4.0))
}

fn covered(target: &Target) -> Vec<(u32, u32)> {
    (0..target.height)
        .flat_map(|y| (0..target.width).map(move |x| (x, y)))
        .filter(|&(x, y)| pick(target, x, y).is_some())
        .collect()
}

#[test]
fn top_left_rule_by_hand() {
    let view = straight_view(8, 1.0, 10.0);
    let shown = |corners: [[f64; 2]; 3]| {
        let scene = soup(&[flat_triangle(8, corners)]);
        let image = assert_equal(&scene, &view, scene.live(), BOTH_SIDES, "by hand");
        // Corners in another order, and so turned around, cover the same.
        let turned = soup(&[flat_triangle(8, [corners[1], corners[0], corners[2]])]);
        assert_eq!(covered(&image), covered(&render(&turned, &view, turned.live())));
        covered(&image)
    };
    // Right angle at (1.5, 1.5): the left and top edges run through centers, which belong to it; the slanted
    // edge through (3.5, 1.5), (2.5, 2.5), (1.5, 3.5) is a right one, whose centers do not.
    assert_eq!(shown([[1.5, 1.5], [3.5, 1.5], [1.5, 3.5]]), [(1, 1), (2, 1), (1, 2)]);
    // Right angle at (3.5, 3.5): the slanted edge is a left one; the right and bottom edges lose theirs.
    assert_eq!(shown([[3.5, 3.5], [1.5, 3.5], [3.5, 1.5]]), [(2, 2)]);
    // Between centers.
    assert_eq!(shown([[0.6, 0.6], [1.4, 0.6], [1.4, 1.4]]), []);
    // A sliver of a pixel's 1/128 about a center.
    assert_eq!(shown([[2.0, 2.484375], [3.0, 2.484375], [2.5, 2.515625]]), [(2, 2)]);
    // Without area: on a line, at a point.
    assert_eq!(shown([[0.5, 0.5], [4.5, 4.5], [2.5, 2.5]]), []);
    assert_eq!(shown([[2.5, 2.5], [2.5, 2.5], [2.5, 2.5]]), []);
}

#[test]
fn left_rule_of_segments_by_hand() {
    let eye = Eye {
        position: Vec2::ZERO,
        target: Vec2::Y,
        up: Vec2::Y,
        fov: std::f32::consts::FRAC_PI_2,
        near: 1.0,
        far: 10.0,
    };
    let view = View { eye, width: 8, height: 1 };
    let at = |x: f32| Vec2::new((x / 4.0 - 1.0) * 4.0, 4.0);
    let shown = |a: f32, b: f32| {
        let scene = scene_of::<Flat>(vec![at(a), at(b)], vec![[0, 1]]);
        covered(&assert_equal(&scene, &view, scene.live(), BOTH_SIDES, "by hand"))
            .iter()
            .map(|c| c.0)
            .collect::<Vec<_>>()
    };
    assert_eq!(shown(1.5, 3.5), [1, 2]);
    assert_eq!(shown(3.5, 1.5), [1, 2]);
    assert_eq!(shown(1.51, 3.51), [2, 3]);
    assert!(shown(1.6, 2.4).is_empty());
    assert!(shown(2.5, 2.5).is_empty());
    assert_eq!(shown(-100.0, 100.0), [0, 1, 2, 3, 4, 5, 6, 7]);
}

/// Square `0..size` cut into a random grid of quads of two triangles, with moved inner points.
fn cut_square(dice: &mut Dice, size: u32, cells: u32, on_centers: bool) -> Vec<[Vec3; 3]> {
    let step = f64::from(size) / f64::from(cells);
    let mut point = |i: u32, j: u32, inner: bool| {
        let mut moved = || {
            let by = f64::from(dice.between(-0.3, 0.3)) * step;
            if on_centers { by.round() + 0.5 } else { by }
        };
        let shift = if inner { [moved(), moved()] } else { [0.0; 2] };
        [f64::from(i) * step + shift[0], f64::from(j) * step + shift[1]]
    };
    let side = cells + 1;
    let grid: Vec<[f64; 2]> = (0..side * side)
        .map(|k| (k % side, k / side))
        .map(|(i, j)| point(i, j, i > 0 && j > 0 && i < cells && j < cells))
        .collect();
    let mut triangles = Vec::new();
    for k in (0..cells * cells).map(|k| (k / cells * side + k % cells) as usize) {
        let q = [grid[k], grid[k + 1], grid[k + 1 + side as usize], grid[k + side as usize]];
        let halves = if k % 2 == 0 { [[0, 1, 2], [2, 3, 0]] } else { [[0, 1, 3], [3, 1, 2]] };
        triangles.extend(halves.map(|t| flat_triangle(size, t.map(|c| q[c]))));
    }
    triangles
}

/// How many of the triangles, each drawn alone, cover each pixel.
fn owners(scene: &Scene<Solid>, view: &View<Solid>) -> Vec<u32> {
    let mut count = vec![0; (view.width * view.height) as usize];
    let mut target = Target::new(view);
    for &prim in scene.live() {
        target.clear(view);
        Solid::draw(&mut target, scene, view, &[prim], &Options::default());
        count.iter_mut().zip(&target.item).for_each(|(n, &i)| *n += u32::from(i != Target::NONE));
    }
    count
}

#[test]
fn every_pixel_of_a_cut_square_has_one_owner() {
    let dice = &mut Dice::new(11);
    for round in 0..40 {
        let size = [16, 40, 64][round % 3];
        let cells = 1 + dice.below(12);
        let scene = soup(&cut_square(dice, size, cells, round % 2 == 0 && cells < 5));
        let view = straight_view(size, 1.0, 10.0);
        assert!(
            owners(&scene, &view).iter().all(|&n| n == 1),
            "round {round}: a pixel has no owner or several"
        );
    }
}

#[test]
fn fans_across_the_near_plane_and_off_screen_are_watertight() {
    let dice = &mut Dice::new(12);
    for round in 0..60 {
        // A fan of a plane's triangles about a point on screen, with rim points anywhere around, behind
        // the eye too: the rays from the hub part the plane, so the visible part has one owner.
        // Five and more keep each triangle's angle below 180°.
        let spokes = 5 + dice.below(8);
        let reach = [3.0, 300.0, 1e5][round % 3];
        let hub = Vec3::new(dice.between(-0.5, 0.5), -1.0, -dice.between(2.0, 6.0));
        let rim: Vec<Vec3> = (0..spokes)
            .map(|k| {
                let turn = (k as f32 + dice.between(0.0, 0.8)) / spokes as f32 * std::f32::consts::TAU;
                hub + Vec3::new(turn.cos(), 0.0, turn.sin()) * reach * dice.between(0.5, 1.0)
            })
            .collect();
        let triangles: Vec<_> =
            (0..spokes as usize).map(|k| [hub, rim[k], rim[(k + 1) % spokes as usize]]).collect();
        let scene = soup(&triangles);
        let view = straight_view(60, 0.5, 1e6);
        let count = owners(&scene, &view);
        assert!(count.iter().all(|&n| n <= 1), "round {round}: a pixel has two owners");
        // No gap inside a column: the plane below the horizon covers a column from top to bottom.
        let together = assert_equal(&scene, &view, scene.live(), BOTH_SIDES, "fan");
        for x in 0..60 {
            let column: Vec<bool> = (0..60).map(|y| pick(&together, x, y).is_some()).collect();
            let changes = column.windows(2).filter(|w| w[0] != w[1]).count();
            assert!(changes <= 2, "round {round}: column {x} has a gap");
        }
    }
}

#[test]
fn depth_planes_go_through_unsnapped_corners_unless_they_would_go_far_off() {
    let dice = &mut Dice::new(16);
    let view = straight_view(1024, 0.1, 1e4);
    let camera = Camera::new(&view);
    let (mut through, mut steep) = (0, 0);
    for round in 0..20_000 {
        // Far from the eye and up to a few pixels wide: gentle ones, and ones that run into the depth.
        let middle = at_px(1024, 512.0, 512.0, f64::from(dice.between(5.0, 500.0)));
        let deep = Vec3::new(0.05, 0.05, [0.05, 5.0, 200.0][round % 3]);
        let corners = [(); 3].map(|()| middle + dice.point(1.0) * deep);
        let vertices = corners.map(|p| camera.vertex(camera.clip(p)));
        let v = [&vertices[0], &vertices[1], &vertices[2]];
        if area(v) == 0 || v.iter().any(|v| v.outside() != 0) {
            continue;
        }
        let plane = Plane::of(v);
        let off = |v: &Vertex, [x, y]: [f64; 2]| {
            let across = f64::from(plane.dx) * (f64::from(v.x - plane.x) + x);
            let down = f64::from(plane.dy) * (f64::from(v.y - plane.y) + y);
            // Slopes are rounded to 24 bits.
            let rounding = (across.abs() + down.abs() + f64::from(plane.z)) * 2f64.powi(-22);
            (f64::from(plane.z) + across + down - f64::from(v.z), rounding)
        };
        // Where its own rounding may bring it nearer it is lowered by that.
        let lowered = 1.1 * v.iter().map(|v| off(v, [0.0; 2]).1).sum::<f64>();
        // Over the snapped triangle its depth is nowhere far from that of the corners, mixed.
        for v in v {
            let (off, rounding) = off(v, [0.0; 2]);
            let most = DEPTH_TILT * f64::from(v.z) + rounding;
            assert!(-most - lowered <= off && off <= most, "round {round}: {off} off {}", v.z);
        }
        let is_through = v.iter().all(|v| {
            let (off, rounding) = off(v, v.rest());
            -rounding - lowered <= off && off <= rounding
        });
        let slope = (f64::from(plane.dx).abs() + f64::from(plane.dy).abs()) * 0.5;
        // Those through the snapped corners are steep, or as thin as the grid.
        assert!(
            is_through || slope > DEPTH_TILT * f64::from(plane.low) || area(v).abs() < 1 << 12,
            "{round}"
        );
        through += usize::from(is_through);
        steep += usize::from(!is_through);
    }
    assert!(through > 5000 && steep > 500, "{through} go through their corners, {steep} do not");
}

#[test]
fn order_and_hidden_members_leave_no_trace() {
    let dice = &mut Dice::new(13);
    for _ in 0..20 {
        let triangles: Vec<[Vec3; 3]> = (0..200)
            .map(|i| {
                let middle = dice.point(6.0);
                // Every fourth repeats: equal depths.
                if i % 4 == 3 {
                    [Vec3::NEG_Z * 5.0, Vec3::new(1.0, 0.0, -5.0), Vec3::new(0.0, 2.0, -5.0)]
                } else {
                    [(); 3].map(|()| middle + dice.point(1.2))
                }
            })
            .collect();
        let scene = soup(&triangles);
        let view = straight_view(48, 0.1, 20.0);
        let all = render(&scene, &view, scene.live());
        let mut order = scene.live().to_vec();
        dice.shuffle(&mut order);
        assert_eq!(render(&scene, &view, &order), all);
        let seen = visible(&all);
        assert!(seen.len() > 10 && seen.len() < 140 && seen.is_sorted(), "{} are visible", seen.len());
        let kept = render(&scene, &view, &seen);
        assert_eq!(kept, all);
        assert_eq!(kept.wrong_pixels(&all), 0);
        // A visible one taken away does leave one.
        assert!(render(&scene, &view, &seen[1..]).wrong_pixels(&all) > 0);
    }
}

/// Nearest triangle along the ray through a pixel's center, in f64 (Möller and Trumbore 1997), or `None`
/// if the ray runs too close to an edge or two hits are too close to tell.
fn ray_cast(triangles: &[[Vec3; 3]], view: &View<Solid>, x: u32, y: u32) -> Option<Option<(u32, f64)>> {
    let size = f64::from(view.width);
    let ray =
        DVec3::new((2.0 * f64::from(x) + 1.0) / size - 1.0, 1.0 - (2.0 * f64::from(y) + 1.0) / size, -1.0);
    let mut hits: Vec<(f64, u32)> = Vec::new();
    for (id, t) in triangles.iter().enumerate() {
        let [a, b, c] = t.map(|p| p.as_dvec3());
        let (u, v) = (b - a, c - a);
        let p = ray.cross(v);
        let det = u.dot(p);
        let q = (-a).cross(u);
        let (s, t, w) = ((-a).dot(p) / det, ray.dot(q) / det, v.dot(q) / det);
        let (near, far) = (f64::from(view.eye.near), f64::from(view.eye.far));
        // Barycentric coordinates change by this much over about a pixel's tenth at the hit.
        let slack = 0.1 * (2.0 / size) * w.abs() * (u.length().max(v.length()) + (c - b).length())
            / u.cross(v).length().max(1e-9)
            * (ray.length() * u.cross(v).length() / det.abs().max(1e-12));
        let least = s.min(t).min(1.0 - s - t);
        if least < -slack || w < near * 0.98 || w > far * 1.02 {
            continue;
        }
        if least < slack || w < near * 1.02 || w > far * 0.98 {
            return None;
        }
        hits.push((w, id as u32));
    }
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    match hits[..] {
        [] => Some(None),
        [(w, _), (next, _), ..] if next < w * 1.05 => None,
        [(w, id), ..] => Some(Some((id, w))),
    }
}

#[test]
fn near_crossing_triangles_agree_with_rays() {
    let dice = &mut Dice::new(14);
    let (mut compared, mut hits) = (0, 0);
    for round in 0..150 {
        let reach = [2.0, 10.0, 500.0][round % 3];
        let triangles: Vec<[Vec3; 3]> = (0..4).map(|_| [(); 3].map(|()| dice.point(reach))).collect();
        let view = straight_view(32, 0.5, 60.0);
        let scene = soup(&triangles);
        let image = render(&scene, &view, scene.live());
        for (x, y) in (0..32).flat_map(|y| (0..32).map(move |x| (x, y))) {
            let Some(expected) = ray_cast(&triangles, &view, x, y) else { continue };
            compared += 1;
            assert_eq!(pick(&image, x, y), expected.map(|e| PrimId(e.0)), "round {round}, pixel ({x}, {y})");
            if let Some((_, w)) = expected {
                hits += 1;
                let depth = 1.0 / f64::from(image.depth[(y * 32 + x) as usize]);
                assert!(
                    (depth - w).abs() < 0.03 * w,
                    "round {round}, pixel ({x}, {y}): depth {depth}, by ray {w}"
                );
            }
        }
    }
    assert!(compared > 80_000 && hits > 10_000, "too few rays are clear: {compared} pixels, {hits} hits");
}

#[test]
fn outside_the_frustum_means_no_fragment() {
    let dice = &mut Dice::new(15);
    let mut outside = 0;
    for _ in 0..20_000 {
        let position = dice.point(100.0);
        let eye = Eye {
            position,
            target: position + dice.point(1.0),
            up: dice.point(1.0),
            fov: dice.between(0.1, 2.5),
            near: 0.25,
            far: 50.0,
        };
        let view = View { eye, width: 64, height: 16 };
        // Triangles just beyond a plane: from the volume's corners, moved outwards by little or nothing.
        let corners = Frustum::corners(&view.projection(), eye.near, eye.far);
        let frustum: Frustum<Vec3> = view.frustum();
        let (normal, offset) = frustum.plane(dice.below(6) as usize);
        let on: Vec<Vec3> =
            corners.into_iter().filter(|&c| (normal.dot(c - position) + offset).abs() < 0.01).collect();
        let by = [0.0, 1e-6, 1e-4, 1e-2][dice.below(4) as usize];
        let triangle = [(); 3].map(|()| {
            on[dice.below(on.len() as u32) as usize] + dice.point(0.02) * by
                - normal * by * dice.between(0.0, 30.0)
        });
        let scene = soup(&[triangle]);
        if let FrustumTest::Outside(_) = frustum.test(&scene.bounds(), Frustum::<Vec3>::ALL) {
            outside += 1;
            assert_eq!(
                visible(&render(&scene, &view, scene.live())),
                [],
                "{triangle:?} is outside and shows"
            );
        }
    }
    assert!(outside > 800, "too few are outside: {outside}");
}

#[test]
fn far_and_near_planes_hold_per_fragment() {
    let view = straight_view(256, 2.0, 8.0);
    // A wall along the line of sight, from before the near to beyond the far plane.
    let wall = [Vec3::new(1.0, -9.0, -0.5), Vec3::new(1.0, 9.0, -0.5), Vec3::new(1.0, 0.0, -40.0)];
    let scene = soup(&[wall]);
    let image = assert_equal(&scene, &view, scene.live(), BOTH_SIDES, "wall");
    let depths: Vec<f32> =
        image.item.iter().zip(&image.depth).filter(|p| *p.0 == 0).map(|p| 1.0 / p.1).collect();
    let (least, most) = depths.iter().fold((f32::MAX, 0f32), |(l, m), &d| (l.min(d), m.max(d)));
    assert!((2.0..2.3).contains(&least) && most <= 8.0 && most > 7.0, "depths {least} to {most}");
}

#[test]
fn backfaces_are_skipped_when_asked() {
    let front = flat_triangle(8, [[1.0, 7.0], [7.0, 7.0], [4.0, 1.0]]);
    let scene = soup(&[front, [front[0], front[2], front[1]]]);
    let view = straight_view(8, 1.0, 10.0);
    let culling = Options { surfaces: ONE_SIDED, ..Options::default() };
    let shows = |id: u32, options: &Options| {
        let mut target = Target::new(&view);
        Solid::draw(&mut target, &scene, &view, &[PrimId(id)], options);
        !visible(&target).is_empty()
    };
    assert!(shows(0, &culling) && !shows(1, &culling));
    assert!(shows(0, &Options::default()) && shows(1, &Options::default()));
}

#[test]
fn what_is_see_through_hides_nothing_and_is_seen_before_what_it_stands_in_front_of() {
    // A pane before a wall, the wall, and behind the wall what nobody sees, solid and see-through.
    let square = |w: f32| [[1.0, 7.0], [7.0, 7.0], [4.0, 1.0]].map(|[x, y]| at_px(8, x, y, f64::from(w)));
    let triangles = [square(2.0), square(4.0), square(6.0), square(6.0)];
    let scene = with_materials(soup(&triangles), |p| p == 0 || p == 3, |_| false);
    let view = straight_view(8, 1.0, 10.0);
    let image = assert_equal(&scene, &view, scene.live(), BOTH_SIDES, "pane");
    assert_eq!(visible(&image), [PrimId(1)]);
    let options = Options::default();
    let mut seen: Vec<PrimId> = Vec::new();
    look_through(&image, &scene, &view, scene.live(), &options, |prim, _, _| seen.push(prim));
    seen.dedup();
    assert_eq!(seen, [PrimId(0)]);
    // Taken as solid, the pane is all that shows.
    let solid = Surfaces { solid: true, ..BOTH_SIDES };
    let image = assert_equal(&scene, &view, scene.live(), solid, "solid pane");
    assert_eq!((visible(&image), image.through.len()), (vec![PrimId(0)], 0));
    // On the wall itself it is seen.
    let scene = with_materials(soup(&[square(4.0), square(4.0)]), |p| p == 1, |_| false);
    let image = assert_equal(&scene, &view, scene.live(), BOTH_SIDES, "paint");
    let mut pixels = 0;
    look_through(&image, &scene, &view, scene.live(), &options, |_, _, _| pixels += 1);
    assert_eq!(pixels, image.item.iter().filter(|i| **i == 0).count());
    // And its color is mixed with what is behind, whatever the order in which it was drawn.
    let layers = [square(2.0), square(3.0), square(4.0)];
    let mut parts = with_materials(soup(&layers), |p| p < 2, |_| false).into_parts();
    parts.prim_material[1].0 = 3;
    parts.materials[3] = Material { color: [1.0, 0.0, 0.0], see_through: true, ..parts.materials[3].clone() };
    let scene = Scene::new(parts).expect("a scene");
    let pictures = [[0, 1, 2], [1, 0, 2], [2, 1, 0]].map(|order| {
        let image = render(&scene, &view, &order.map(PrimId));
        shade(&image, &scene, &view, [1.0; 3])
    });
    assert!(pictures.iter().all(|p| *p == pictures[0]));
    let plain = shade(&render(&scene, &view, &[PrimId(2)]), &scene, &view, [1.0; 3]);
    assert!(pictures[0] != plain, "two panes change the picture");
}

/// A sliver seen edge-on, a grid step high at a corner a hundred times nearer than its far edge, which runs
/// through pixel centers: these have the edge's depth. The changes along x and y are some 10⁵ times that and
/// cancel, so that f32 leaves little of it.
#[test]
fn no_fragment_of_a_sliver_is_nearer_than_the_sliver() {
    let mut on_the_edge = 0;
    for k in 0..64 {
        let view = straight_view(512, 0.1, 1e4);
        let step = f64::from(k % 8 + 1) / 256.0 * if k % 2 == 0 { 1.0 } else { -1.0 };
        let (from, to) = (0.5 + f64::from(k), 500.5 - f64::from(k / 2));
        let apex = 250.5 + f64::from(k / 3);
        let ends = [at_px(512, from, from, 100.0), at_px(512, to, to, 100.0)];
        let scene = soup(&[[ends[0], ends[1], at_px(512, apex + step, apex, 1.0)]]);
        Solid::fragments(&scene, &view, PrimId(0), &Options::default(), &mut |at, depth| {
            if at / 512 == at % 512 {
                on_the_edge += 1;
                let most = 0.01 * (1.0 + DEPTH_SLACK);
                assert!(f64::from(depth) <= most, "sliver {k}: {depth} at {} on its far edge", at % 512);
            }
        });
    }
    assert!(on_the_edge > 1000, "{on_the_edge} pixels");
}
