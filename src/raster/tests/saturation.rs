//! Full samples, by hand: how many boxes it takes, and from which depth on they hide.

use glam::{vec2, vec3};

use super::*;
use crate::geometry::{Aabb, Flat};
use crate::raster::{CubeFaces, PyramidCell, Saturation};

fn tile(x: u16, y: u16) -> PyramidCell {
    PyramidCell { level: PyramidCell::TILE, x, y }
}

/// Opaque: full at once, where it is and behind the depth at which its face lies. An eye at the origin looks
/// along −z at a square from −1 to 1 at depth 4, which an image of 16 pixels, 8 units wide there, shows in
/// its middle 4×4.
#[test]
fn an_opaque_box_hides_what_begins_behind_its_face() {
    let view = straight_view(16, 0.1, 100.0);
    let all = PixelRect { x0: 0, x1: 16, y0: 0, y1: 16 };
    let mut full = Saturation::default();
    full.clear(&view);
    let opaque = CubeFaces::new(&[[0.0, 0.0, 0.0, 1.0]; 6]);
    full.put(&Aabb { min: vec3(-1.0, -1.0, -6.0), max: vec3(1.0, 1.0, -4.0) }, &opaque);
    let open = |depth: f32| full.open(tile(0, 1), all, 1.0 / depth);
    // Rows 4 to 7 and columns 0 to 7 of the image: of them columns 6 and 7 of rows 6 and 7 are covered.
    let covered = 0b1100_0000 << 16 | 0b1100_0000_u32 << 24;
    assert_eq!(open(5.0), !covered);
    assert_eq!(open(4.0), u32::MAX, "what begins in its face shows");
    assert_eq!(open(3.0), u32::MAX);
    // Of some pixels only.
    let some = PixelRect { x0: 5, x1: 7, y0: 7, y1: 16 };
    assert_eq!(full.open(tile(0, 1), some, 0.2), 0b0010_0000 << 24);
    assert_eq!(full.open(tile(1, 3), all, 0.2), u32::MAX);
}

/// Each box keeps half of the light (128 of 255, so a little more): after nine more than 1/1024 comes
/// through, and less after ten. They hide what begins behind the last one that took some, not the first.
#[test]
fn ten_halves_are_full() {
    let (position, target) = (vec2(0.0, -1.0), vec2(0.0, 0.0));
    let fov = std::f32::consts::FRAC_PI_2;
    let eye = Eye { position, target, up: vec2(0.0, 1.0), fov, near: 0.1, far: 100.0 };
    let view = View::<Flat> { eye, width: 8, height: 1 };
    let all = PixelRect { x0: 0, x1: 8, y0: 0, y1: 1 };
    let mut full = Saturation::default();
    full.clear(&view);
    let half = CubeFaces::new(&[[0.2, 0.1, 0.0, 0.5]; 6]);
    for k in 0..12 {
        // Entered at depth k + 1, k + 2, …
        let low = k as f32;
        full.put(&Aabb { min: vec2(-20.0, low), max: vec2(20.0, low + 1.0) }, &half);
        let open = |depth: f32| full.open(tile(0, 0), all, 1.0 / depth);
        let want = if k < 9 { 0xff } else { 0 };
        assert_eq!(open(50.0), want, "{} boxes", k + 1);
        // Those that come after the tenth are behind what is full, and change nothing.
        let [before, behind] = [open(9.99), open(10.01)];
        assert_eq!([before, behind], [0xff, want], "{} boxes", k + 1);
    }
}
