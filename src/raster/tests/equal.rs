//! The fast code equals the reference on random primitives of every awkward kind.

use super::*;

/// A random triangle of one of many kinds, some sharing corners with the one before.
fn triangle(dice: &mut Dice, kind: u32, before: [Vec3; 3]) -> [Vec3; 3] {
    let middle = dice.point(8.0);
    let around = |dice: &mut Dice, reach: f32| [(); 3].map(|()| middle + dice.point(reach));
    match kind {
        0 => around(dice, 0.05),
        1 => around(dice, 0.5),
        2 => around(dice, 4.0),
        3 => around(dice, 100.0),
        4 => around(dice, 1e6),
        5 => {
            // A sliver.
            let [a, b, _] = around(dice, 6.0);
            [a, b, a + (b - a) * dice.between(-0.5, 1.5) + dice.point(1e-3)]
        }
        6 => [before[1], before[2], middle],
        7 => [before[2], before[0], before[2] + dice.point(0.3)],
        // Around the eye: crosses the near plane.
        8 => [(); 3].map(|()| dice.point(0.3)),
        9 => [dice.point(0.02), dice.point(50.0), dice.point(50.0)],
        // Degenerate: two corners alike, or all on a line.
        10 => [middle, middle, dice.point(8.0)],
        11 => [middle, middle * 0.5, middle * 0.25],
        // On the grid's corners, for ties.
        12 => [(); 3].map(|()| at_px(64, f64::from(dice.below(65)), f64::from(dice.below(65)), 4.0)),
        13 => [(); 3]
            .map(|()| at_px(64, f64::from(dice.below(129)) * 0.5, f64::from(dice.below(129)) * 0.5, 4.0)),
        // Coplanar with another: equal depths.
        14 => before,
        _ => [(); 3].map(|()| dice.point(8.0).with_z(-3.0)),
    }
}

fn triangles(dice: &mut Dice, count: usize) -> Vec<[Vec3; 3]> {
    let mut list: Vec<[Vec3; 3]> = Vec::with_capacity(count);
    for _ in 0..count {
        let before = list.last().copied().unwrap_or_default();
        let kind = dice.below(16);
        list.push(triangle(dice, kind, before));
    }
    list
}

fn sides(one: bool) -> Surfaces {
    if one { ONE_SIDED } else { BOTH_SIDES }
}

/// The same, each third primitive see-through and each fourth with two sides, in every second round.
fn mixed<S: Space>(scene: Scene<S>, round: u32) -> Scene<S> {
    let is_mixed = round % 2 == 1;
    with_materials(scene, |p| is_mixed && p % 3 == 0, |p| is_mixed && p % 4 == 0)
}

fn random_view(dice: &mut Dice) -> View<Solid> {
    let (width, height) = (1 + dice.below(100), 1 + dice.below(80));
    let near = [1e-3, 0.1, 2.0][dice.below(3) as usize];
    let eye = if dice.below(2) == 0 {
        Eye { far: near + 20.0, ..straight_view(1, near, 1.0).eye }
    } else {
        let position = dice.point(3.0);
        let target = position + dice.point(1.0) + Vec3::X * 2.0;
        Eye {
            position,
            target,
            up: dice.point(1.0),
            fov: dice.between(0.02, 3.0),
            near,
            far: near + dice.between(1.0, 1e4),
        }
    };
    View { eye, width, height }
}

#[test]
fn triangles_equal_the_reference() {
    let dice = &mut Dice::new(1);
    let mut covered = 0;
    for round in 0..150 {
        let scene = mixed(soup(&triangles(dice, 60)), round);
        let view = if round % 3 == 0 { straight_view(64, 0.1, 30.0) } else { random_view(dice) };
        let image =
            assert_equal(&scene, &view, scene.live(), sides(round % 5 == 0), &format!("round {round}"));
        covered += image.item.iter().filter(|&&i| i != Target::NONE).count();
    }
    assert!(covered > 100_000, "the scenes show too little to test anything: {covered} pixels");
}

#[test]
fn single_triangles_equal_the_reference() {
    let dice = &mut Dice::new(2);
    for round in 0..3000 {
        let scene = mixed(soup(&triangles(dice, 2)), round);
        let view = if round % 2 == 0 { straight_view(64, 0.1, 30.0) } else { random_view(dice) };
        assert_equal(&scene, &view, &[PrimId(round % 2)], BOTH_SIDES, &format!("round {round}"));
    }
}

#[test]
fn images_of_awkward_sizes_equal_the_reference() {
    let dice = &mut Dice::new(4);
    let mut covered = 0;
    // Narrower than a vector, and sides about multiples of a block's 128 columns and 32 rows.
    for [width, height] in [[1, 1], [7, 5], [33, 17], [128, 32], [129, 33], [257, 129], [300, 64]] {
        for round in 0..6 {
            // In one round a list that is long enough to be dealt to several threads' chunks.
            let scene = mixed(soup(&triangles(dice, if round == 2 { 4500 } else { 90 })), round);
            let eye = if round % 2 == 0 { straight_view(1, 0.1, 30.0).eye } else { random_view(dice).eye };
            let view = View { eye, width, height };
            let what = format!("{width}×{height}, round {round}");
            let image = assert_equal(&scene, &view, scene.live(), sides(round == 1), &what);
            covered += image.item.iter().filter(|&&i| i != Target::NONE).count();
        }
    }
    assert!(covered > 200_000, "the scenes show too little to test anything: {covered} pixels");
}

#[test]
fn what_is_as_far_as_the_farthest_pixel_may_show() {
    // Facing walls over the whole image, at one depth, in the order of falling ids: when the last comes, all
    // that a block holds is as near as it is.
    let wall = [Vec3::new(-90.0, -90.0, -4.0), Vec3::new(90.0, -90.0, -4.0), Vec3::new(0.0, 90.0, -4.0)];
    let scene = soup(&[wall; 6]);
    let view = View { width: 300, ..straight_view(100, 0.1, 30.0) };
    let prims: Vec<PrimId> = (0..6).rev().map(PrimId).collect();
    let image = assert_equal(&scene, &view, &prims, BOTH_SIDES, "walls");
    assert!(image.item.iter().all(|&item| item == 0), "the least id of equally near ones");
}

#[test]
fn an_image_made_anew_is_empty_outside_its_window() {
    let dice = &mut Dice::new(5);
    let mut covered = 0;
    for round in 0..40 {
        let scene = mixed(soup(&triangles(dice, 60)), round);
        let view = View { width: 300, height: 100, ..random_view(dice) };
        let whole = render(&scene, &view, scene.live());
        let (x0, y0) = (dice.below(200), dice.below(80));
        let window = PixelRect { x0, x1: x0 + 1 + dice.below(100), y0, y1: y0 + 1 + dice.below(20) };
        let mut expected = Target::new(&view);
        for (y, x) in (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (y, x))) {
            let at = (y * view.width + x) as usize;
            (expected.depth[at], expected.item[at]) = (whole.depth[at], whole.item[at]);
        }
        covered += expected.item.iter().filter(|&&i| i != Target::NONE).count();
        for options in all_options(BOTH_SIDES) {
            let mut target = whole.clone();
            let options = Options { window: Some(window), ..options };
            Solid::redraw(&mut target, &scene, &view, scene.live(), &options);
            assert_eq!(target.wrong_pixels(&expected), 0, "round {round}, {options:?}");
        }
    }
    assert!(covered > 5_000, "the windows show too little to test anything: {covered} pixels");
}

#[test]
fn segments_equal_the_reference() {
    let dice = &mut Dice::new(3);
    for round in 0..500 {
        let count = 40;
        let reach = [0.5, 5.0, 1e5][dice.below(3) as usize];
        let points: Vec<Vec2> = (0..count * 2).map(|_| dice.point(reach).truncate()).collect();
        let scene: Scene<Flat> = scene_of(
            points,
            (0..count).map(|s| [2 * s, (2 * s + 1 + dice.below(2)) % (2 * count)]).collect(),
        );
        let scene = mixed(scene, round);
        let position = dice.point(1.0).truncate();
        let target = position + Vec2::new(1.5, 0.0) + dice.point(1.0).truncate();
        let eye = Eye { position, target, up: Vec2::Y, fov: dice.between(0.1, 3.0), near: 0.01, far: 40.0 };
        let view = View { eye, width: 1 + dice.below(300), height: 1 };
        assert_equal(&scene, &view, scene.live(), sides(round % 3 == 0), &format!("round {round}"));
    }
}
