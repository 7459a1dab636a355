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

#[test]
fn cells_cover_their_rectangles() {
    let (mut dice, pyramid) = (Dice::new(6), pyramid_of(100, 70, &[0.5; 100 * 70]));
    for _ in 0..20_000 {
        let (x0, y0) = (dice.below(100), dice.below(70));
        let r = PixelRect { x0, x1: x0 + 1 + dice.below(100 - x0), y0, y1: y0 + 1 + dice.below(70 - y0) };
        let holds = |p: PixelRect| p.x0 <= r.x0 && p.y0 <= r.y0 && p.x1 >= r.x1 && p.y1 >= r.y1;
        let (first, last) = pyramid.cover(r);
        assert!(last.x - first.x <= 1 && last.y - first.y <= 1, "at most four cells over {r:?}");
        let (a, b) = (first.pixels(100, 70), last.pixels(100, 70));
        assert!(holds(PixelRect { x0: a.x0, x1: b.x1, y0: a.y0, y1: b.y1 }));
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

/// While an image is drawn, tile by tile brought up to date or not: what is not stale is right, and nothing
/// is held nearer than it is.
#[test]
fn a_pyramid_that_is_read_while_the_image_is_drawn_holds_nothing_too_near() {
    let mut dice = Dice::new(8);
    for round in 0..40 {
        let triangles: Vec<[Vec3; 3]> = (0..40).map(|_| [(); 3].map(|()| dice.point(6.0))).collect();
        let (scene, view) = (soup(&triangles), straight_view([64, 90, 17][round % 3], 0.1, 100.0));
        let (mut target, mut pyramid) = (Target::new(&view), Pyramid::default());
        pyramid.clear(view.width, view.height, 1.0 / view.eye.far);
        for part in scene.live().chunks(8) {
            let (x0, y0) = (dice.below(view.width), dice.below(view.height));
            let (x1, y1) = (x0 + 1 + dice.below(view.width - x0), y0 + 1 + dice.below(view.height - y0));
            let window = PixelRect { x0, x1, y0, y1 };
            let options = Options { window: Some(window), ..Options::default() };
            Solid::draw(&mut target, &scene, &view, part, &options);
            pyramid.touch(window);
            pyramid.assert_well_formed(&target.depth);
            let (x, y) = (dice.below(view.width.div_ceil(16)), dice.below(view.height.div_ceil(16)));
            pyramid.refresh(&target.depth, cell(4, x as u16, y as u16));
            assert!(!pyramid.is_stale(cell(4, x as u16, y as u16)));
            pyramid.assert_well_formed(&target.depth);
        }
    }
}
