//! The z-pyramid: the paper's example, any size, stale values, windows.

use super::*;

fn cell(level: u8, x: u16, y: u16) -> PyramidCell {
    PyramidCell { level, x, y }
}

/// An image of given view depths, as `1/w`, drawn at once.
pub(super) fn pyramid_of(width: u32, height: u32, depth: &[f32]) -> Pyramid {
    let mut pyramid = Pyramid::default();
    pyramid.clear(width, height, 0.0);
    pyramid.touch(PixelRect { x0: 0, x1: width, y0: 0, y1: height });
    pyramid.refresh_all(depth);
    pyramid
}

#[test]
fn figure_1_of_georges_1995() {
    let z = [4, 9, 8, 8, 4, 5, 1, 3, 6, 2, 2, 4, 2, 2, 2, 4];
    let depth = z.map(|z| 1.0 / z as f32);
    let pyramid = pyramid_of(4, 4, &depth);
    assert_eq!(pyramid.root(), 2, "three levels");
    let level_1 = [(0, 0, 9), (1, 0, 8), (0, 1, 6), (1, 1, 4)];
    for (x, y, farthest) in level_1 {
        assert_eq!(pyramid.farthest(&depth, cell(1, x, y)), 1.0 / farthest as f32, "({x}, {y})");
    }
    assert_eq!(pyramid.farthest(&depth, cell(2, 0, 0)), 1.0 / 9.0);
}

#[test]
fn any_size_has_a_pyramid() {
    let mut dice = Dice::new(5);
    for (width, height) in [
        (1, 1),
        (2, 1),
        (1, 7),
        (3, 3),
        (5, 1),
        (16, 16),
        (17, 16),
        (33, 47),
        (64, 1),
        (100, 1),
        (257, 3),
        (50, 200),
    ] {
        let depth: Vec<f32> = (0..width * height).map(|_| dice.between(0.1, 1.0)).collect();
        let pyramid = pyramid_of(width, height, &depth);
        assert_eq!(pyramid.size(pyramid.root()), (1, 1), "{width}×{height}");
        assert!(
            pyramid.root() == 0 || pyramid.size(pyramid.root() - 1) != (1, 1),
            "{width}×{height}: no level too many"
        );
        pyramid.assert_well_formed(&depth);
    }
}

/// Triangles of one pixel behind one that is drawn just before them: what is left out does not depend on how
/// many threads draw.
#[test]
fn what_a_pyramid_leaves_out_does_not_depend_on_threads() {
    let view = straight_view(64, 0.1, 100.0);
    let wall = [(-8.0, -8.0), (-8.0, 136.0), (136.0, -8.0)].map(|(x, y)| at_px(64, x, y, 2.0));
    let pixel = |k: u32| {
        let (x, y) = (f64::from(k % 64), f64::from(k / 64));
        [(0.1, 0.1), (0.1, 1.4), (1.4, 0.1)].map(|(dx, dy)| at_px(64, x + dx, y + dy, 3.0))
    };
    let triangles: Vec<_> = std::iter::once(wall).chain((0..64 * 64).map(pixel)).collect();
    let scene = soup(&triangles);
    let left_out = |threads: usize| {
        let (mut target, mut pyramid, mut hidden) = (Target::new(&view), Pyramid::default(), Vec::new());
        pyramid.clear(64, 64, 1.0 / view.eye.far);
        let sieve = Sieve { pyramid: &mut pyramid, hidden: &mut hidden };
        let options = Options { threads, ..Options::default() };
        Solid::sift(&mut target, sieve, &scene, &view, scene.live(), &options);
        hidden
    };
    let small = Solid::extent(&scene, &view, PrimId(700), &Options::default()).expect("covers a pixel");
    assert_eq!(small.pixels.area(), 1);
    assert_eq!(left_out(1), left_out(3));
}

#[test]
fn cells_cover_their_rectangles() {
    let mut dice = Dice::new(6);
    let depth: Vec<f32> = (0..100 * 70).map(|_| dice.between(0.1, 1.0)).collect();
    let pyramid = pyramid_of(100, 70, &depth);
    for _ in 0..20_000 {
        let (x0, y0) = (dice.below(100), dice.below(70));
        let r = PixelRect { x0, x1: x0 + 1 + dice.below(100 - x0), y0, y1: y0 + 1 + dice.below(70 - y0) };
        let holds = |p: PixelRect| p.x0 <= r.x0 && p.y0 <= r.y0 && p.x1 >= r.x1 && p.y1 >= r.y1;
        let one = pyramid.finest_over(r);
        assert!(holds(one.pixels(100, 70)), "{one:?} holds {r:?}");
        if one.level > 0 {
            let finer =
                cell(one.level - 1, (r.x0 >> (one.level - 1)) as u16, (r.y0 >> (one.level - 1)) as u16);
            assert!(!holds(finer.pixels(100, 70)), "{one:?} is the finest over {r:?}");
        }
        let (first, last) = pyramid.cover(r);
        assert!(last.x - first.x <= 1 && last.y - first.y <= 1, "at most four cells over {r:?}");
        let (a, b) = (first.pixels(100, 70), last.pixels(100, 70));
        assert!(holds(PixelRect { x0: a.x0, x1: b.x1, y0: a.y0, y1: b.y1 }));
        let truth = (r.y0..r.y1)
            .flat_map(|y| (r.x0..r.x1).map(move |x| (y * 100 + x) as usize))
            .map(|i| depth[i])
            .fold(f32::INFINITY, f32::min);
        assert!(pyramid.farthest_over(&depth, r) <= truth);
    }
}

#[test]
fn windows_put_together_are_the_image() {
    let mut dice = Dice::new(7);
    let triangles: Vec<[Vec3; 3]> = (0..200).map(|_| [(); 3].map(|()| dice.point(6.0))).collect();
    let scene = soup(&triangles);
    let view = straight_view(90, 0.1, 100.0);
    let whole = render(&scene, &view, scene.live());
    for threads in [1, 3] {
        let mut target = Target::new(&view);
        for (y0, y1) in [(0, 40), (40, 90)] {
            for (x0, x1) in [(0, 33), (33, 64), (64, 90)] {
                let window = Some(PixelRect { x0, x1, y0, y1 });
                Solid::draw(
                    &mut target,
                    &scene,
                    &view,
                    scene.live(),
                    &Options { threads, window, ..Options::default() },
                );
                let inside =
                    |i: usize| (x0..x1).contains(&(i as u32 % 90)) && (y0..y1).contains(&(i as u32 / 90));
                assert!((0..90 * 90).filter(|&i| inside(i)).all(|i| target.item[i] == whole.item[i]));
            }
        }
        assert!(target == whole);
    }
}

/// A primitive that the near plane or the border of the grid cuts falls into parts; where the pyramid hides
/// one of them, another may show. Each part at the near plane comes as near as that, so only those at the
/// border can be hidden by themselves.
#[test]
fn parts_of_a_primitive_are_not_judged() {
    let mut dice = Dice::new(8);
    let view = straight_view(64, 0.1, 100.0);
    let mut cut = 0;
    for round in 0..2000 {
        let edge = f64::from(dice.between(8.0, 56.0));
        let [a, b, c, d] =
            [(-4.0, -4.0), (-4.0, 68.0), (edge, 68.0), (edge, -4.0)].map(|(x, y)| at_px(64, x, y, 0.2));
        let [p, q] = [(); 2].map(|()| {
            at_px(
                64,
                f64::from(dice.between(0.0, 64.0)),
                f64::from(dice.between(0.0, 64.0)),
                f64::from(dice.between(1.0, 20.0)),
            )
        });
        let behind = Vec3::new(dice.between(-3.0, 3.0), dice.between(-3.0, 3.0), dice.between(0.5, 5.0));
        let aside = at_px(64, f64::from(dice.between(2e4, 1e6)), f64::from(dice.signed(1e5)), 20.0);
        let scene = soup(&[[a, b, c], [a, c, d], [p, q, if round % 2 == 0 { behind } else { aside }]]);
        let (mut target, mut pyramid, mut hidden) = (Target::new(&view), Pyramid::default(), Vec::new());
        pyramid.clear(64, 64, 1.0 / view.eye.far);
        for part in scene.live().chunks(2) {
            Solid::sift(
                &mut target,
                Sieve { pyramid: &mut pyramid, hidden: &mut hidden },
                &scene,
                &view,
                part,
                &Options::default(),
            );
            pyramid.refresh_all(&target.depth);
        }
        cut += usize::from(
            Solid::extent(&scene, &view, PrimId(2), &Options::default()).is_none()
                && target.item.contains(&2),
        );
        assert!(hidden.iter().all(|h| !target.item.contains(&h.0)), "what is called hidden shows");
    }
    assert!(cut > 100, "{cut} show and are cut");
}

/// A wall that reaches beyond the border of the grid on all sides is cut to a square, and that in two.
/// One is nearer at a corner than what hides the whole image, the other nowhere: hidden by itself, it says
/// nothing of the wall.
#[test]
fn the_far_part_of_a_wall_does_not_hide_the_wall() {
    let view = straight_view(64, 0.1, 1000.0);
    // 1/w = 0.1 − s (x + y), with x and y from −1 to 1 over the image; the border of the grid is at ±512.
    let wall = [(530.0, 530.0), (-5000.0, 530.0), (530.0, -5000.0)].map(|(x, y): (f64, f64)| {
        let w = 1.0 / (0.1 - 0.00009 * (x + y));
        Vec3::new((x * w) as f32, (y * w) as f32, -w as f32)
    });
    let curtain = [(-8.0, -8.0), (-8.0, 136.0), (136.0, -8.0)].map(|(x, y)| at_px(64, x, y, 1.0 / 0.105));
    let scene = soup(&[curtain, wall]);
    assert_eq!(Solid::extent(&scene, &view, PrimId(1), &Options::default()), None, "it is cut");
    for threads in [1, 3] {
        let (mut target, mut pyramid, mut hidden) = (Target::new(&view), Pyramid::default(), Vec::new());
        pyramid.clear(64, 64, 1.0 / view.eye.far);
        for prim in [PrimId(0), PrimId(1)] {
            let sieve = Sieve { pyramid: &mut pyramid, hidden: &mut hidden };
            let options = Options { threads, ..Options::default() };
            Solid::sift(&mut target, sieve, &scene, &view, &[prim], &options);
            pyramid.refresh_all(&target.depth);
        }
        assert_eq!(hidden, [], "{threads} threads");
    }
}
