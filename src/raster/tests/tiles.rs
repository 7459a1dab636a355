//! Tiles: their exact depths are those of the image, what they claim is never nearer, instruction sets leave
//! no trace, and no box is called hidden that owns a pixel.

use glam::DVec2;

use super::*;
use crate::geometry::{Aabb, Vector};

pub(super) const SETS: [Isa; 3] = [Isa::Portable, Isa::Avx2, Isa::Avx512];

/// A scene of everything that tiles treat apart: boxes that pair to quadrangles, bent pairs, slivers,
/// triangles from less than a pixel to far beyond the image, some of them before and behind the eye.
pub(super) fn mixed(dice: &mut Dice, count: usize) -> Scene<Solid> {
    let (mut points, mut prims) = (Vec::new(), Vec::<[u32; 3]>::new());
    for _ in 0..count {
        let first = points.len() as u32;
        let size = [0.02, 0.3, 3.0, 30.0][dice.below(4) as usize];
        let at = Vec3::new(dice.signed(8.0), dice.signed(8.0), dice.between(-20.0, 3.0));
        match dice.below(4) {
            0 => {
                let half = Vec3::new(dice.unit(), dice.unit(), dice.unit()) * size;
                points
                    .extend((0..8).map(|k| {
                        at + half * Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32)
                    }));
                let faces =
                    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
                prims.extend(
                    faces
                        .iter()
                        .flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]].map(|t| t.map(|c| c + first))),
                );
            }
            1 => {
                let (u, v) = (dice.point(size), dice.point(size));
                let bend = dice.point(size * 0.1);
                points.extend([at, at + u, at + u + v + bend, at + v]);
                prims.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c| c + first)));
            }
            2 => {
                let (along, off) = (dice.point(size), dice.point(size * 0.001));
                points.extend([at, at + along, at + along * dice.unit() + off]);
                prims.push([first, first + 1, first + 2]);
            }
            _ => {
                points.extend([at, at + dice.point(size), at + dice.point(size)]);
                prims.push([first, first + 1, first + 2]);
            }
        }
    }
    with_materials(scene_of(points, prims), |at| at % 17 == 3, |at| at % 5 < 2)
}
/// The same in flatland: walls of houses, and segments from far below a pixel to far beyond the image, some
/// edge-on, some before and behind the eye. `scale`: all lengths times that.
pub(super) fn flat_mixed(dice: &mut Dice, count: usize, scale: f32) -> Scene<Flat> {
    let (mut points, mut prims) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let first = points.len() as u32;
        let size: f32 = [0.001, 0.02, 0.3, 3.0, 30.0, 1e5][dice.below(6) as usize];
        let at = Vec2::new(dice.signed(8.0), dice.between(-20.0, 3.0));
        match dice.below(4) {
            0 => {
                let half = Vec2::new(dice.unit(), dice.unit()) * size.min(3.0);
                points.extend(
                    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| at + half * Vec2::from(c)),
                );
                // Counter-clockwise corners have the left within: turned round, the front is outside.
                prims.extend([[1, 0], [2, 1], [3, 2], [0, 3]].map(|t| t.map(|c| c + first)));
            }
            1 => {
                // About toward the eyes.
                let along = Vec2::new(dice.signed(0.01), dice.signed(1.0)) * size;
                points.extend([at, at + along]);
                prims.push([first, first + 1]);
            }
            _ => {
                points.extend([at, at + dice.vector::<Vec2>(size)]);
                prims.push([first, first + 1]);
            }
        }
    }
    points.iter_mut().for_each(|p| *p *= scale);
    with_materials(scene_of(points, prims), |at| at % 17 == 3, |at| at % 5 < 2)
}
pub(super) fn flat_view(dice: &mut Dice, width: u32, scale: f32) -> View<Flat> {
    let position = dice.vector::<Vec2>(3.0) * scale;
    let eye = Eye {
        position,
        target: position + Vec2::new(dice.signed(0.5), -1.0),
        up: Vec2::Y,
        fov: dice.between(0.3, 2.2),
        near: 0.05 * scale,
        far: 60.0 * scale,
    };
    View { eye, width, height: 1 }
}
/// Width of the line, and the scale of all lengths: in some rounds depths are so great that nothing is said
/// of slopes.
pub(super) fn flat_size(round: u32) -> (u32, f32) {
    ([1, 7, 8, 31, 33, 200, 1024][round as usize % 7], if round % 10 == 9 { 1e-33 } else { 1.0 })
}
pub(super) fn random_view(dice: &mut Dice, width: u32, height: u32) -> View<Solid> {
    let position = dice.point(3.0);
    let eye = Eye {
        position,
        target: position + Vec3::new(dice.signed(0.5), dice.signed(0.5), -1.0),
        up: Vec3::Y,
        fov: dice.between(0.3, 2.2),
        near: 0.05,
        far: 60.0,
    };
    View { eye, width, height }
}
pub(super) fn sizes(round: u32) -> (u32, u32) {
    [(64, 64), (97, 53), (33, 130), (1, 1), (320, 200), (700, 40)][round as usize % 6]
}
pub(super) fn drawn<S: Drawable>(scene: &Scene<S>, view: &View<S>, surfaces: Surfaces, isa: Isa) -> Tiles {
    // Groups of all sizes: clusters of a few primitives, and some that are split.
    let groups: Vec<&[PrimId]> = scene.live().chunks(37).collect();
    let clusters = Clusters::new(scene, surfaces, groups);
    let mut tiles = Tiles::default();
    tiles.clear(view, true);
    tiles.draw(&clusters, surfaces.one_sided, isa);
    tiles
}
pub(super) fn image<S: Drawable>(scene: &Scene<S>, view: &View<S>, surfaces: Surfaces) -> Target {
    let mut target = Target::new(view);
    S::draw(&mut target, scene, view, scene.live(), &Options { surfaces, ..Options::default() });
    target
}

/// The plain reference is the image itself, which equals [`mod@super::super::reference`].
#[test]
fn exact_depths_are_those_of_the_image_on_every_instruction_set() {
    let mut dice = Dice::new(71);
    for round in 0..ROUNDS {
        let scene = mixed(&mut dice, 20 + round as usize * 7 % 400);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        exact_depths_are_those_of_the_image(&scene, &view, round);
    }
}
#[test]
fn exact_depths_of_flatland_are_those_of_the_line_on_every_instruction_set() {
    let (mut dice, mut covered) = (Dice::new(75), 0);
    for round in 0..10 * ROUNDS {
        let (width, scale) = flat_size(round);
        let scene = flat_mixed(&mut dice, 1 + round as usize * 7 % 400, scale);
        let view = flat_view(&mut dice, width, scale);
        covered += exact_depths_are_those_of_the_image(&scene, &view, round);
    }
    assert!(covered > 100_000, "the scenes show too little to test anything: {covered} pixels");
}
/// Returns how many pixels are covered.
fn exact_depths_are_those_of_the_image<S: Drawable>(scene: &Scene<S>, view: &View<S>, round: u32) -> usize {
    let surfaces = [BOTH_SIDES, ONE_SIDED][round as usize % 2];
    let truth = image(scene, view, surfaces);
    let first = drawn(scene, view, surfaces, Isa::Portable);
    for isa in SETS {
        let mut tiles = drawn(scene, view, surfaces, isa);
        assert!(tiles == first, "{} left a trace in round {round}", isa.label());
        let depths = tiles.depths(isa);
        for (at, (&is, &should)) in depths.iter().zip(&truth.depth).enumerate() {
            let (x, y) = (at as u32 % view.width, at as u32 / view.width);
            assert_eq!(is.to_bits(), should.to_bits(), "({x}, {y}) holds {is}, not {should}; {round}");
        }
    }
    truth.item.iter().filter(|&&i| i != Target::NONE).count()
}
pub(super) const ROUNDS: u32 = 120;

/// What a tile claims while nothing was looked at closer: no pixel is farther, and what was ever covered is.
#[test]
fn a_tile_claims_nothing_nearer_than_its_farthest_pixel() {
    let mut dice = Dice::new(72);
    for round in 0..ROUNDS {
        let scene = mixed(&mut dice, 200);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        let truth = image(&scene, &view, ONE_SIDED);
        let tiles = drawn(&scene, &view, ONE_SIDED, Isa::best());
        tiles.assert_claims(&truth.depth);
    }
    for round in 0..10 * ROUNDS {
        let (width, scale) = flat_size(round);
        // Few segments leave layers that are begun.
        let scene = flat_mixed(&mut dice, [200, 20][round as usize % 2], scale);
        let view = flat_view(&mut dice, width, scale);
        let truth = image(&scene, &view, ONE_SIDED);
        let tiles = drawn(&scene, &view, ONE_SIDED, Isa::best());
        tiles.assert_claims(&truth.depth);
    }
}

/// A random box, many of them small, or thin, or around what is drawn.
pub(super) fn random_box(dice: &mut Dice) -> Aabb<Vec3> {
    let size = [0.05, 0.5, 4.0][dice.below(3) as usize];
    let at = Vec3::new(dice.signed(8.0), dice.signed(8.0), dice.between(-25.0, 4.0));
    let half = Vec3::new(dice.unit(), dice.unit(), dice.unit()) * size;
    Aabb { min: at - half, max: at + half }
}

/// The same in flatland.
pub(super) fn flat_box(dice: &mut Dice, scale: f32) -> Aabb<Vec2> {
    let size = [0.05, 0.5, 4.0][dice.below(3) as usize];
    let at = Vec2::new(dice.signed(8.0), dice.between(-25.0, 4.0));
    let half = Vec2::new(dice.unit(), dice.unit()) * size;
    Aabb { min: (at - half) * scale, max: (at + half) * scale }
}

#[test]
fn a_hidden_box_owns_no_pixel_and_answers_do_not_depend_on_the_instruction_set() {
    let (mut dice, mut counts) = (Dice::new(73), [0usize; 3]);
    for round in 0..ROUNDS / 2 {
        let scene = mixed(&mut dice, 150);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        let boxes: Vec<Aabb<Vec3>> = (0..300).map(|_| random_box(&mut dice)).collect();
        hidden_boxes_own_nothing(&mut dice, &scene, &view, &boxes, &mut counts);
    }
    assert!(counts.iter().all(|&c| c > 500), "visible, hidden, outside: {counts:?}");
}
#[test]
fn a_hidden_box_of_flatland_owns_no_pixel_and_answers_do_not_depend_on_the_instruction_set() {
    let (mut dice, mut counts) = (Dice::new(76), [0usize; 3]);
    for round in 0..2 * ROUNDS {
        let (width, scale) = flat_size(round);
        let scene = flat_mixed(&mut dice, [10, 40, 150][round as usize % 3], scale);
        let view = flat_view(&mut dice, width, scale);
        let boxes: Vec<Aabb<Vec2>> = (0..100).map(|_| flat_box(&mut dice, scale)).collect();
        hidden_boxes_own_nothing(&mut dice, &scene, &view, &boxes, &mut counts);
    }
    assert!(counts.iter().all(|&c| c > 500), "visible, hidden, outside: {counts:?}");
}
pub(super) fn straight_line(width: u32) -> View<Flat> {
    let fov = std::f32::consts::FRAC_PI_2;
    let (position, target, up) = (Vec2::ZERO, Vec2::NEG_Y, Vec2::Y);
    View { eye: Eye { position, target, up, fov, near: 0.1, far: 50.0 }, width, height: 1 }
}

/// A segment that begins 0.4 grid steps after a pixel's center is snapped to it and covers it, as the only
/// pixel of its tile. Its plane has passed the depth of its end there, to which the pixel is cut; bounds hold
/// that.
#[test]
fn bounds_of_flatland_hold_a_depth_that_is_cut_to_the_end_of_its_segment() {
    let view = straight_line(32);
    // Who looks down −y has −x to the right.
    let at = |x: f64, w: f64| DVec2::new((1.0 - x / 16.0) * w, -w).as_vec2();
    for [near, far] in [[5.0, 6.0], [6.0, 5.0]] {
        let points = vec![at(7.5 + 0.4 / 256.0, near), at(20.0, far)];
        let scene: Scene<Flat> = scene_of(points, vec![[0, 1]]);
        let truth = image(&scene, &view, BOTH_SIDES);
        assert_eq!((truth.item[6], truth.item[7]), (Target::NONE, 0));
        assert_eq!(truth.depth[7], 1.0 / near as f32);
        drawn(&scene, &view, BOTH_SIDES, Isa::best()).assert_claims(&truth.depth);
    }
}
/// What is drawn in a group is told apart: the back of a segment, one behind another, one beside the view.
#[test]
fn a_group_of_flatland_tells_what_became_of_each_segment() {
    let wall = |y: f32, from: f32, to: f32| [Vec2::new(from, y), Vec2::new(to, y)];
    // The left of a segment toward +x is +y, where the eye is.
    let walls = [wall(-5.0, -9.0, 9.0), wall(-6.0, -1.0, 1.0), wall(-3.0, 1.0, -1.0), wall(-4.0, 6.0, 8.0)];
    let walls = walls.into_iter().chain([wall(-3.0, -1.0, 1.0)]);
    let points: Vec<Vec2> = walls.flatten().collect();
    let scene: Scene<Flat> = scene_of(points, (0..5).map(|k| [2 * k, 2 * k + 1]).collect());
    let clusters = Clusters::new(&scene, ONE_SIDED, scene.live().chunks(1));
    let mut tiles = Tiles::default();
    tiles.clear(&straight_line(33), true);
    let fates: Vec<(PrimId, Fate)> = (0..5)
        .flat_map(|group| {
            let (how, mut fates) = (How { one_sided: true, skipped: &[], tested: false }, Vec::new());
            tiles.draw_groups(&clusters, &[(group, how)], Isa::best(), &mut fates);
            fates
        })
        .collect();
    let should = [Fate::Shown, Fate::Hidden, Fate::Away, Fate::Hidden, Fate::Shown];
    assert_eq!(fates, (0..).map(PrimId).zip(should).collect::<Vec<_>>());
}
/// A wall across the line hides what is behind it by tiles alone, also in the tile that the edge of the image
/// cuts, and only from its front.
#[test]
fn a_wall_of_flatland_hides_by_tiles_alone() {
    for width in [1, 7, 8, 31, 33, 200, 1024] {
        let view = straight_line(width);
        // The left of a segment toward +x is +y, where the eye is.
        let wall = [Vec2::new(-90.0, -5.0), Vec2::new(90.0, -5.0)];
        let behind = [Vec2::new(-30.0, -9.0), Vec2::new(30.0, -6.0)];
        let before = [Vec2::new(-1.0, -4.0), Vec2::new(1.0, -3.0)];
        let beside = [Vec2::new(6.0, -4.0), Vec2::new(7.0, -3.0)];
        let boxes = Boxes::new([behind, before, beside].map(|[min, max]| Aabb { min, max }));
        let shown = [Answer::Visible, Answer::Visible, Answer::Outside];
        let hidden = [Answer::Hidden, Answer::Visible, Answer::Outside];
        for (corners, should) in [([0, 1], hidden), ([1, 0], shown)] {
            let scene: Scene<Flat> = scene_of(wall.to_vec(), vec![corners]);
            let mut answers = Vec::new();
            drawn(&scene, &view, ONE_SIDED, Isa::best()).hides_all(&boxes, false, Isa::best(), &mut answers);
            assert_eq!(answers, should, "{width} pixels, the wall's corners {corners:?}");
        }
    }
}
fn hidden_boxes_own_nothing<S: Drawable>(
    dice: &mut Dice,
    scene: &Scene<S>,
    view: &View<S>,
    boxes: &[Aabb<S::Vector>],
    counts: &mut [usize; 3],
) {
    let truth = image(scene, view, ONE_SIDED);
    let all = Boxes::new(boxes.iter().copied());
    let ask = |isa: Isa, exact: bool| {
        let mut answers = Vec::new();
        drawn(scene, view, ONE_SIDED, isa).hides_all(&all, exact, isa, &mut answers);
        answers
    };
    let (exact, coarse) = (ask(Isa::best(), true), ask(Isa::best(), false));
    for isa in SETS {
        assert_eq!((&ask(isa, true), &ask(isa, false)), (&exact, &coarse), "{}", isa.label());
    }
    for (bounds, (&exact, &coarse)) in boxes.iter().zip(exact.iter().zip(&coarse)) {
        counts[exact as usize] += 1;
        assert!(coarse != Answer::Hidden || exact == Answer::Hidden, "only tiles hide {bounds:?}");
        if exact != Answer::Visible {
            owns_nothing(dice, bounds, view, &truth);
        }
    }
}
/// Primitives of a box, on its corners, edges and faces and within, win no pixel.
pub(super) fn owns_nothing<S: Drawable>(
    dice: &mut Dice,
    bounds: &Aabb<S::Vector>,
    view: &View<S>,
    truth: &Target,
) {
    let mut point = || {
        S::Vector::from_fn(|a| {
            let (low, high) = (bounds.min.get(a), bounds.max.get(a));
            match dice.below(5) {
                0 | 1 => low,
                2 | 3 => high,
                _ => (low + (high - low) * dice.unit()).clamp(low, high),
            }
        })
    };
    let corners = S::CORNERS as u32;
    let points = (0..12 * corners).map(|_| point()).collect();
    let prims = (0..12).map(|k| S::corners_from([0, 1, 2].map(|c| corners * k + c))).collect();
    let inside: Scene<S> = scene_of(points, prims);
    for &prim in inside.live() {
        S::fragments(&inside, view, prim, &Options::default(), &mut |at, depth| {
            let (x, y) = (at as u32 % view.width, at as u32 / view.width);
            assert!(
                depth < truth.depth[at],
                "{bounds:?} shows at ({x}, {y}), {depth} before {}: {view:?}",
                truth.depth[at]
            );
        });
    }
}

/// The same tiles for one frame after another, asked between draws.
#[test]
fn tiles_are_used_again() {
    let (mut dice, mut tiles) = (Dice::new(78), Tiles::default());
    for round in 0..ROUNDS / 4 {
        let scene = mixed(&mut dice, 60);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        let (first, second) = scene.live().split_at(scene.live().len() / 2);
        let boxes = Boxes::new((0..50).map(|_| random_box(&mut dice)));
        tiles.clear(&view, true);
        for part in 0..2 {
            tiles.draw(&Clusters::new(&scene, ONE_SIDED, [[first, second][part]]), true, Isa::best());
            let mut truth = Target::new(&view);
            let options = Options { surfaces: ONE_SIDED, ..Options::default() };
            Solid::draw(&mut truth, &scene, &view, [first, scene.live()][part], &options);
            // What was asked leaves no depth behind that more drawing makes wrong.
            tiles.hides_all(&boxes, true, Isa::best(), &mut Vec::new());
            tiles.assert_claims(&truth.depth);
            assert!(tiles.depths(Isa::best()) == truth.depth, "round {round}, part {part}");
        }
    }
}

/// A square over columns `x0..x1` of an image of 8×8 pixels and its upper four rows, `depth` its `1/w`.
fn half_tile([x0, x1]: [f64; 2], depth: f64) -> [[Vec3; 3]; 2] {
    let [a, b, c, d] = [[x0, 0.0], [x1, 0.0], [x1, 4.0], [x0, 4.0]].map(|[x, y]| at_px(8, x, y, 1.0 / depth));
    [[a, b, c], [a, c, d]]
}

/// The masked update of Hasselgren, Andersson and Akenine-Möller 2016, Section 3.2, by hand: what the upper
/// tile is known to hold at the farthest, after each of the squares that come into it.
#[test]
fn a_tile_keeps_the_layer_that_says_more() {
    let view = straight_view(8, 1.0, 10.0);
    let (left, right, all) = ([0.0, 4.0], [4.0, 8.0], [0.0, 8.0]);
    for (squares, farthest) in [
        // Both halves cover it: the farther of them.
        (vec![(left, 0.5), (right, 0.4)], 0.4),
        // A whole cover farther than what was begun leaves that: the other half then completes it.
        (vec![(left, 0.5), (all, 0.25), (right, 0.5)], 0.5),
        // One that is nearer ends it: a half of the same depth begins anew.
        (vec![(left, 0.25), (all, 0.5), (right, 0.8)], 0.5),
        // What was begun so far behind the next that it would pull it back is given up.
        (vec![(left, 0.2), (right, 0.8), (left, 0.8)], 0.8),
        // Not so what was begun less far behind it than before what was known.
        (vec![(left, 0.5), (right, 0.8)], 0.5),
        // Squares that lie behind change nothing.
        (vec![(all, 0.5), (left, 0.4), (right, 0.4)], 0.5),
    ] {
        let mut tiles = Tiles::default();
        tiles.clear(&view, true);
        for &(columns, depth) in &squares {
            let scene = soup(&half_tile(columns, depth));
            tiles.draw(&Clusters::new(&scene, BOTH_SIDES, [scene.live()]), false, Isa::best());
        }
        // Boxes behind the tile, a little nearer and farther than that.
        let behind =
            |w: f64| Aabb::of([at_px(8, 1.0, 1.0, w), at_px(8, 7.0, 3.0, w), at_px(8, 4.0, 2.0, w * 1.01)]);
        let boxes = Boxes::new([behind(1.01 / farthest), behind(0.99 / farthest)]);
        let mut answers = Vec::new();
        tiles.hides_all(&boxes, false, Isa::best(), &mut answers);
        assert_eq!(answers, [Answer::Hidden, Answer::Visible], "{squares:?}");
    }
}

/// Clusters are drawn front to back: of what is behind a wall nothing is kept, in whichever order they are
/// given. The wall is as many primitives as are set up at a time, so none of it waits.
#[test]
fn a_wall_is_drawn_before_what_it_hides() {
    let view = straight_view(64, 1.0, 100.0);
    let wall = (0..16).flat_map(|k| {
        let (x, y) = (f64::from(k % 4) * 16.0, f64::from(k / 4) * 16.0);
        // Each at a depth of its own: no two of them make a quadrangle.
        let [a, b, c, d] = [[0.0, 0.0], [16.0, 0.0], [16.0, 16.0], [0.0, 16.0]]
            .map(|[right, down]| at_px(64, x + right, y + down, 2.0 + f64::from(k) / 64.0));
        [[a, b, c], [a, c, d]]
    });
    let behind = (0..40).map(|k| {
        let at = f64::from(k) + 10.0;
        [at_px(64, at, at, 4.0), at_px(64, at + 9.0, at, 5.0), at_px(64, at, at + 9.0, 6.0)]
    });
    let scene = soup(&behind.chain(wall).collect::<Vec<_>>());
    let (behind, wall) = scene.live().split_at(40);
    let tiles = |groups: &[&[PrimId]]| {
        let mut tiles = Tiles::default();
        tiles.clear(&view, true);
        tiles.draw(&Clusters::new(&scene, BOTH_SIDES, groups.iter().copied()), false, Isa::best());
        // A question brings blocks up to date, which drawing does for some.
        tiles.hides_all(&Boxes::new::<Vec3>([]), true, Isa::best(), &mut Vec::new());
        tiles
    };
    assert!(tiles(&[behind]) != tiles(&[]), "without the wall it is drawn");
    for groups in [[behind, wall], [wall, behind]] {
        assert!(tiles(&groups) == tiles(&[wall]), "something behind the wall left a trace");
    }
}

/// Of a quadrangle's four corners any may come first, and either way round: the plane and the parts that
/// clipping leaves do not change.
#[test]
fn a_triangle_is_the_same_wherever_its_corners_begin() {
    let mut dice = Dice::new(74);
    for _ in 0..3000 {
        let mut at = || {
            Vec3::new(dice.signed(3.0), dice.signed(3.0), [-4.0, dice.signed(6.0)][dice.below(2) as usize])
        };
        let t = [at(), at(), at()];
        let view = straight_view(24, 0.05, 50.0);
        let depths = |t: [Vec3; 3]| render(&soup(&[t]), &view, &[PrimId(0)]).depth;
        let first = depths(t);
        for k in [[1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0]] {
            assert_eq!(first, depths(k.map(|i: usize| t[i])), "{t:?} by {k:?}");
        }
    }
}
