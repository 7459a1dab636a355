//! Tests of the z-buffer: against the plain reference, against rays, and of the rules it keeps.

mod blend;
mod equal;
mod limits;
pub(crate) mod moved_edge;
mod opacity;
mod pyramid;
mod rules;
mod saturation;
mod tile_answers;
mod tile_edges;
mod tile_questions;
mod tiles;

use glam::{DVec3, Vec2, Vec3};

use super::*;
use crate::geometry::Eye;
use crate::geometry::dice::Dice;
use crate::scene::{Material, Parts, Surfaces};

/// A scene of one object and one material.
pub(super) fn scene_of<S: Space>(points: Vec<S::Vector>, prims: Vec<S::Corners>) -> Scene<S> {
    let mut parts = Parts::simple("test", points, prims);
    parts.materials[0].color = [0.5; 3];
    Scene::new(parts).expect("the test's scene is valid")
}

/// Primitives with two sides.
pub(super) const BOTH_SIDES: Surfaces = Surfaces { one_sided: false, solid: false };
/// Primitives with a front only.
pub(super) const ONE_SIDED: Surfaces = Surfaces { one_sided: true, solid: false };

/// The same with some primitives, by their place, of other materials: `see_through` and `two_sided` ones.
pub(super) fn with_materials<S: Space>(
    scene: Scene<S>,
    see_through: impl Fn(usize) -> bool,
    two_sided: impl Fn(usize) -> bool,
) -> Scene<S> {
    let mut parts = scene.into_parts();
    for material in 1..4 {
        let (see_through, two_sided) = (material & 1 == 1, material & 2 == 2);
        parts.materials.push(Material { see_through, two_sided, ..parts.materials[0].clone() });
    }
    for (at, material) in parts.prim_material.iter_mut().enumerate() {
        material.0 = u32::from(see_through(at)) | u32::from(two_sided(at)) << 1;
    }
    Scene::new(parts).expect("the test's scene is valid")
}

/// Triangles with points of their own.
pub(super) fn soup(triangles: &[[Vec3; 3]]) -> Scene<Solid> {
    let points = triangles.iter().flatten().copied().collect();
    scene_of(points, (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// An eye at the origin that looks along −z, 90° high, so that pixel (x, y) of an image of `size` by
/// `size` pixels lies at `((2x − size) / size, (size − 2y) / size, −1)`.
pub(super) fn straight_view(size: u32, near: f32, far: f32) -> View<Solid> {
    let fov = std::f32::consts::FRAC_PI_2;
    let eye = Eye { position: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov, near, far };
    View { eye, width: size, height: size }
}

/// The point at view depth `w` that shows at column `x` and row `y` (pixel corners are integers) of a
/// [`straight_view`].
pub(super) fn at_px(size: u32, x: f64, y: f64, w: f64) -> Vec3 {
    let half = f64::from(size) * 0.5;
    DVec3::new((x / half - 1.0) * w, (1.0 - y / half) * w, -w).as_vec3()
}

/// The lines of sight of a view, in f64.
pub(super) struct Sight {
    pub(super) eye: DVec3,
    /// Change of the ray at view depth 1 a column and a row, and the ray at the image's upper left corner.
    across: DVec3,
    down: DVec3,
    corner: DVec3,
}

impl Sight {
    pub(super) fn new(view: &View<Solid>) -> Self {
        let rows = view.projection().rows.map(Vec3::as_dvec3);
        // Rows are square to each other.
        let [x, y] = [0, 1].map(|k| rows[k] / rows[k].length_squared());
        Self {
            eye: view.eye.position.as_dvec3(),
            across: x * 2.0 / f64::from(view.width),
            down: -y * 2.0 / f64::from(view.height),
            corner: rows[2] - x + y,
        }
    }
    /// The ray through a point of the image (pixel corners are integers), at view depth 1.
    pub(super) fn ray(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.across * x + self.down * y + self.corner
    }
    /// The point at view depth `w` on it.
    pub(super) fn point(&self, at: [f64; 2], w: f64) -> Vec3 {
        (self.eye + self.ray(at) * w).as_vec3()
    }
}

/// Every way to draw that this machine has: instruction sets and threads. Reports once which sets it lacks,
/// and so no test here sees.
pub(super) fn all_options(surfaces: Surfaces) -> Vec<Options> {
    let (here, missing): (Vec<Isa>, Vec<Isa>) =
        [Isa::Portable, Isa::Avx2, Isa::Avx512].into_iter().partition(|&i| i <= Isa::best());
    static REPORT: std::sync::Once = std::sync::Once::new();
    REPORT.call_once(|| {
        for isa in missing {
            eprintln!("not tested, this machine lacks it: {}", isa.label());
        }
    });
    here.into_iter()
        .flat_map(|isa| [1, 3].map(|threads| Options { surfaces, threads, isa, window: None }))
        .collect()
}

/// Asserts that every way to draw gives the reference's bytes, and returns the image.
pub(super) fn assert_equal<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    prims: &[PrimId],
    surfaces: Surfaces,
    what: &str,
) -> Target {
    let mut expected = Target::new(view);
    S::draw_reference(&mut expected, scene, view, prims, &Options { surfaces, ..Options::default() });
    for options in all_options(surfaces) {
        let mut target = Target::new(view);
        S::draw(&mut target, scene, view, prims, &options);
        // Onto what another image left.
        let mut anew = Target::new(&View { width: view.width + 5, ..*view });
        anew.depth.fill(f32::INFINITY);
        S::redraw(&mut anew, scene, view, prims, &options);
        assert!(anew == expected, "{what}, {options:?}: made anew, {} pixels", anew.wrong_pixels(&expected));
        assert_eq!(
            shown_through(scene, view, &anew, &options),
            shown_through(scene, view, &expected, &options),
            "{what}, {options:?}: made anew, see-through primitives"
        );
        assert_eq!(
            shown_through(scene, view, &target, &options),
            shown_through(scene, view, &expected, &options),
            "{what}, {options:?}: see-through primitives and their pixels"
        );
        if let Some(i) = (0..target.item.len()).find(|&i| {
            target.item[i] != expected.item[i] || target.depth[i].to_bits() != expected.depth[i].to_bits()
        }) {
            let (x, y) = (i % view.width as usize, i / view.width as usize);
            panic!(
                "{what}, {options:?}: pixel ({x}, {y}) shows {} at {}, expected {} at {}",
                target.item[i], target.depth[i], expected.item[i], expected.depth[i]
            );
        }
    }
    fragments_equal_the_reference(scene, view, prims, surfaces, what);
    extents_hold_what_is_drawn(scene, view, prims, surfaces, what);
    expected
}

/// The see-through primitives that were drawn and show, with their pixels.
fn shown_through<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    target: &Target,
    options: &Options,
) -> Vec<(PrimId, usize)> {
    let mut shown = Vec::new();
    look_through(target, scene, view, &target.through, options, |prim, at, _| shown.push((prim, at)));
    shown.sort_unstable();
    shown.dedup();
    shown
}

/// Asserts of some primitives that they cover what the reference fills when it draws them alone, at its
/// depths.
fn fragments_equal_the_reference<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    prims: &[PrimId],
    surfaces: Surfaces,
    what: &str,
) {
    let options = Options { surfaces: Surfaces { solid: true, ..surfaces }, ..Options::default() };
    for &prim in prims.iter().take(6) {
        let (mut alone, mut filled) = (Target::new(view), Target::new(view));
        S::draw_reference(&mut alone, scene, view, &[prim], &options);
        S::fragments(scene, view, prim, &options, &mut |at, depth| {
            // As the z-buffer does: nothing shows beyond the far plane.
            if depth >= filled.depth[at] {
                (filled.depth[at], filled.item[at]) = (depth, prim.0);
            }
        });
        assert_eq!(filled.wrong_pixels(&alone), 0, "{what}: fragments of {prim}");
    }
}

/// Asserts of some primitives that what is drawn of them alone lies in their extents, no nearer than these
/// say.
fn extents_hold_what_is_drawn<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    prims: &[PrimId],
    surfaces: Surfaces,
    what: &str,
) {
    let options = Options { surfaces: Surfaces { solid: true, ..surfaces }, ..Options::default() };
    for &prim in prims.iter().step_by(prims.len().div_ceil(20).max(1)) {
        let Some(Extent { pixels, nearest }) = S::extent(scene, view, prim, &options) else { continue };
        let mut alone = Target::new(view);
        S::draw(&mut alone, scene, view, &[prim], &options);
        for at in (0..alone.item.len()).filter(|&at| alone.item[at] == prim.0) {
            let (x, y) = (at as u32 % view.width, at as u32 / view.width);
            let is_in = (pixels.x0..pixels.x1).contains(&x) && (pixels.y0..pixels.y1).contains(&y);
            assert!(is_in && alone.depth[at] <= nearest, "{what}: extent of {prim} at ({x}, {y})");
        }
    }
}
