//! The ends of the ranges: the largest images, depths at the edge of f32, empty input; and the color image.

use super::*;

#[test]
fn widest_and_highest_images() {
    let dice = &mut Dice::new(21);
    for (width, height) in [(MAX_SIDE_PX, 3), (3, MAX_SIDE_PX), (2500, 40)] {
        let triangles: Vec<[Vec3; 3]> = (0..100)
            .map(|i| {
                let reach = [3.0, 30.0, 3e4][i % 3];
                let middle = dice.point(reach);
                [(); 3].map(|()| middle + dice.point(reach * 0.3))
            })
            .collect();
        let scene = soup(&triangles);
        let view = View { width, height, ..straight_view(1, 0.01, 1e5) };
        let image = assert_equal(&scene, &view, scene.live(), BOTH_SIDES, &format!("{width}×{height}"));
        assert!(visible(&image).len() > 3);
    }
}

#[test]
fn extreme_depths_stay_finite_and_equal() {
    let dice = &mut Dice::new(22);
    for (near, far, reach) in
        [(1e-38, 1e38, 1e-37), (1e-30, 1e30, 1e20), (1e-3, f32::MAX, 1e37), (f32::MIN_POSITIVE, 1.0, 1e-37)]
    {
        let triangles: Vec<[Vec3; 3]> = (0..30).map(|_| [(); 3].map(|()| dice.point(reach))).collect();
        let scene = soup(&triangles);
        let image = assert_equal(
            &scene,
            &straight_view(24, near, far),
            scene.live(),
            BOTH_SIDES,
            &format!("near {near}"),
        );
        assert!(image.depth.iter().all(|d| d.is_finite()), "near {near}: a depth is not finite");
    }
}

#[test]
fn nothing_drawn_shows_nothing() {
    let scene = soup(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let view = straight_view(5, 1.0, 4.0);
    for image in [render(&scene, &view, &[]), assert_equal(&scene, &view, &[], BOTH_SIDES, "nothing")] {
        assert_eq!(visible(&image), []);
        assert!(image.item.iter().all(|&i| i == Target::NONE) && image.depth.iter().all(|&d| d == 0.25));
        assert_eq!(pick(&image, 5, 0), None);
        assert_eq!(pick(&image, 0, 0), None);
    }
}

#[test]
fn a_target_can_be_used_again() {
    let dice = &mut Dice::new(23);
    let mut target = Target::default();
    for round in 0..12 {
        let triangles: Vec<[Vec3; 3]> =
            (0..1 + round * 40 % 90).map(|_| [(); 3].map(|()| dice.point(5.0))).collect();
        let scene = soup(&triangles);
        let view =
            View { width: 1 + dice.below(90), height: 1 + dice.below(90), ..straight_view(1, 0.1, 50.0) };
        target.clear(&view);
        Solid::draw(
            &mut target,
            &scene,
            &view,
            scene.live(),
            &Options { threads: 1 + round % 3, ..Options::default() },
        );
        assert_eq!(target, render(&scene, &view, scene.live()));
    }
}

#[test]
fn shading_by_angle_and_choice() {
    // One triangle faces the eye, one is seen at a slant.
    let face = [at_px(16, 0.0, 16.0, 4.0), at_px(16, 8.0, 16.0, 4.0), at_px(16, 4.0, 0.0, 4.0)];
    let slant = [at_px(16, 8.0, 16.0, 2.0), at_px(16, 16.0, 16.0, 9.0), at_px(16, 12.0, 0.0, 3.0)];
    let scene = soup(&[face, slant]);
    let view = straight_view(16, 1.0, 10.0);
    let image = render(&scene, &view, scene.live());
    let at = |pixels: &[u8], x: usize, y: usize| [0, 1, 2, 3].map(|c| pixels[(y * 16 + x) * 4 + c]);
    let pixels = shade(&image, &scene, &view, [1.0, 1.0, 1.0]);
    assert_eq!(pixels.len(), 16 * 16 * 4);
    assert_eq!(at(&pixels, 0, 0), [255; 4]);
    let (bright, dim) = (at(&pixels, 4, 12), at(&pixels, 12, 12));
    assert!(bright[0] > dim[0] && dim[0] > 80 && bright[0] < 189 && bright[3] == 255, "{bright:?} {dim:?}");
    let by_state =
        shade_with(
            &image,
            &scene,
            &view,
            [0.0; 3],
            |p| if p.0 == 0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] },
        );
    let (a, b) = (at(&by_state, 4, 12), at(&by_state, 12, 12));
    assert!(a[0] > 200 && a[1] == 0 && b[1] > 80 && b[0] == 0 && at(&by_state, 0, 0) == [0, 0, 0, 255]);
}

#[test]
fn instruction_sets_are_ordered_by_width() {
    assert!(Isa::Portable < Isa::Avx2 && Isa::Avx2 < Isa::Avx512);
    assert!(Isa::best() >= Isa::Portable && !Isa::best().label().is_empty());
}
