//! Figure 4: a surface that is large beside the leaves is torn where it is seen from between the axes.

use std::sync::Arc;

use glam::{Vec2, vec2};

use crate::drawing::{Drawing, Font, Layer, Mark, Role, Subject};
use crate::figure::tools::{Maker, Plan, TWO_COLUMNS_PT, entry};
use crate::figure::{Paper, Swatch, panels};
use crate::geometry::{Aabb, Eye, Flat, View};
use crate::method::{DrawList, Film};
use crate::papers::keys::COLOR_CUBES;
use crate::papers::paper::Figure;
use crate::raster::{Canvas, Options, StandIn, Target, render};
use crate::scene::{Parts, Scene, SceneError};

/// The figure.
pub const FIGURE: Figure = Figure {
    name: "chamberlain-figure-4",
    former: None,
    summary: "A contour on the grid of leaves, the opacities of their faces, and how it is torn off-axis",
    make: tearing,
};

/// Side of a leaf, and leaves along a side of the whole.
const LEAF: f32 = 1.0;
const LEAVES: f32 = 8.0;
/// Parts of the contour: so many that all leaves are of the last level.
const PARTS: u32 = 256;
/// Pixels of the image.
const PIXELS: u32 = 96;
/// The settings: leaves of the fourth level, which are 7 pixels large; those above are twice that.
const SETTINGS: [(&str, &str); 3] = [("tree-levels", "4"), ("pixel-threshold", "10"), ("face-samples", "32")];
/// A face of at least this coverage counts as nearly opaque.
const OPAQUE: f32 = 0.5;
/// A ray counts as torn where so much of the background shows.
const TORN: f32 = 0.1;
/// From the middle to the Eye: far, so that rays are as good as parallel.
const AWAY: f32 = 400.0;

/// A quarter of an egg, which bulges to the lower left, seen from there.
fn contour() -> Result<Arc<Scene<Flat>>, SceneError> {
    let point = |k: u32| {
        let (sine, cosine) = (f64::from(k) / f64::from(PARTS) * std::f64::consts::FRAC_PI_2).sin_cos();
        // From the upper left corner of the whole to the lower right one, so that these are its bounds; not
        // the same on both sides of its middle.
        let at = |v: f64| (f64::from(LEAVES) * (1.0 - v)) as f32;
        let (cosine, sine) = (cosine.powf(0.8), sine.powf(1.3));
        vec2(at(cosine), at(sine))
    };
    let points = (0..=PARTS).map(point).collect();
    let mut parts = Parts::<Flat>::simple("contour", points, (0..PARTS).map(|k| [k, k + 1]).collect());
    parts.materials[0].color = [0.05, 0.16, 0.35];
    Ok(Arc::new(Scene::new(parts)?))
}

/// From 45° between the axes.
fn off_axis() -> View<Flat> {
    let target = Vec2::splat(LEAVES * 0.5);
    let position = target - Vec2::splat(AWAY * std::f32::consts::FRAC_1_SQRT_2);
    let fov = 2.0 * (0.75 * LEAVES / AWAY).atan();
    let eye = Eye { position, target, up: Vec2::ZERO, fov, near: AWAY - 20.0, far: AWAY + 20.0 };
    View { eye, width: PIXELS, height: 1 }
}

/// What is shown.
struct Shot {
    film: Arc<dyn Film<Flat>>,
    list: DrawList<Flat>,
}

/// What shows at a pixel: whether the contour is there, and how much of the background shows through cubes.
struct Pixel {
    is_covered: bool,
    left: f32,
}

impl Shot {
    fn new(maker: &Maker<'_>) -> Result<Self, SceneError> {
        let film = maker.film(&contour()?, &off_axis(), COLOR_CUBES, &SETTINGS);
        let list = film.drawn(film.events().len()).unwrap_or_default();
        Ok(Self { film, list })
    }
    fn cubes(&self) -> &[StandIn<Vec2>] {
        &self.list.stand_ins
    }
    fn pixels(&self) -> Vec<Pixel> {
        let (scene, view) = (self.film.scene(), self.film.view());
        let geometry = render(&**scene, view, scene.live());
        let mut canvas = Canvas::default();
        canvas.clear(view);
        canvas.composite(self.cubes(), &render(&**scene, view, &[]), view, &Options::default());
        let covered = geometry.item.iter().map(|item| *item != Target::NONE);
        covered.zip(canvas.samples()).map(|(is_covered, [.., left])| Pixel { is_covered, left }).collect()
    }
    /// A picture of the leaves, with the contour if asked.
    fn plan(&self, has_contour: bool) -> Plan {
        let air = Vec2::splat(0.25);
        let frame = Aabb { min: -air, max: Vec2::splat(LEAVES) + air };
        let mut plan = Plan::new(frame, (TWO_COLUMNS_PT - 10.0) * 0.5);
        for cube in self.cubes() {
            let subject = Subject::Node(cube.node);
            plan.world.bounds(Layer::Ground, Role::Faint, subject, &cube.bounds);
        }
        if has_contour {
            let scene = self.film.scene();
            for prim in scene.live() {
                let ends: Vec<Vec2> = scene.prim_points(*prim).collect();
                plan.world.line(Layer::Scene, Role::Ink, Subject::Prim(*prim), ends);
            }
        }
        plan
    }
}

/// Draws the lower face of each cube on an axis: solid or dashed, with its opacity beside it.
fn faces(plan: &mut Plan, cubes: &[StandIn<Vec2>], axis: usize, is_named: bool) {
    for cube in cubes {
        let alpha = cube.faces.get(2 * axis)[3];
        // A little inside, so that those of neighbors stay apart.
        let (low, high) = (cube.bounds.min + 0.06, cube.bounds.max - 0.06);
        let end = if axis == 0 { vec2(low.x, high.y) } else { vec2(high.x, low.y) };
        let role = if alpha >= OPAQUE { Role::Visible } else { Role::Hidden };
        plan.world.line(Layer::Evidence, role, Subject::Node(cube.node), [low, end]);
        if is_named {
            let text = format!("{alpha:.2}");
            let aside = if axis == 0 { vec2(0.42, 0.5) } else { vec2(0.5, 0.24) };
            plan.label(cube.bounds.min + aside * LEAF, 6.5, Font::Regular, &text);
        }
    }
}

/// The bands of rays on which the background shows although the contour is there, with how much of it.
fn torn(plan: &mut Plan, shot: &Shot, pixels: &[Pixel]) {
    let view = shot.film.view();
    let forward = view.eye.forward();
    let across = vec2(forward.y, -forward.x);
    let half = (view.eye.fov * 0.5).tan() * AWAY;
    let edge = |at: usize| view.eye.target + across * (2.0 * half * at as f32 / PIXELS as f32 - half);
    let is_torn = |pixel: &Pixel| pixel.is_covered && pixel.left > TORN;
    let mut from = 0;
    for band in pixels.chunk_by(|a, b| is_torn(a) == is_torn(b)) {
        let past = from + band.len();
        if is_torn(&band[0]) {
            let ends = [edge(from), edge(past)];
            let corners = [(0, -0.8), (1, -0.8), (1, 0.8), (0, 0.8)];
            let corners = corners.map(|(k, share): (usize, f32)| ends[k] + forward * (share * LEAVES));
            plan.world.push(Layer::Areas, Role::Eye, Subject::None, Mark::Area(corners.to_vec()));
            let left = band.iter().map(|p| p.left).sum::<f32>() / band.len() as f32;
            let at = (ends[0] + ends[1]) * 0.5 + forward * (0.33 * LEAVES);
            plan.plate(at, 7.0, Font::Bold, &format!("{:.0} %", left * 100.0));
        }
        from = past;
    }
}

/// What is seen, in numbers.
fn caption(pixels: &[Pixel]) -> String {
    let covered: Vec<&Pixel> = pixels.iter().filter(|p| p.is_covered).collect();
    let through = covered.iter().filter(|p| p.left > TORN).count();
    let mean = covered.iter().map(|p| p.left).sum::<f32>() / covered.len().max(1) as f32;
    let most = covered.iter().map(|p| p.left).fold(0.0, f32::max);
    format!(
        "Flatland. The contour hides all that is behind it, from wherever it is seen. Each leaf's cube knows \
         how much of it is covered from the left and from below (b, c): half of a face or more (solid), or \
         less (dashed). From 45° a ray may enter and leave a row of cubes through faces that are nearly \
         transparent (d): in an image of {PIXELS} pixels the contour covers {}; on {through} of these more \
         than a tenth of the background shows, {:.0} % at most, {:.0} % on the mean of all. Bands: \
         the rays of those pixels, with the mean of each band.",
        covered.len(),
        most * 100.0,
        mean * 100.0
    )
}

fn tearing(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let shot = Shot::new(maker)?;
    let pixels = shot.pixels();
    let mut from_left = shot.plan(false);
    faces(&mut from_left, shot.cubes(), 0, true);
    let mut from_below = shot.plan(false);
    faces(&mut from_below, shot.cubes(), 1, true);
    let mut aslant = shot.plan(false);
    torn(&mut aslant, &shot, &pixels);
    (0..2).for_each(|axis| faces(&mut aslant, shot.cubes(), axis, false));
    let content = panels(
        TWO_COLUMNS_PT,
        2,
        &[
            shot.plan(true).panel("(a) the contour and the leaves that it crosses"),
            from_left.panel("(b) faces seen from the left, with their opacities"),
            from_below.panel("(c) faces seen from below"),
            aslant.panel("(d) seen from 45°: where the background shows through"),
        ],
    );
    let legend = vec![
        entry(Role::Ink, Swatch::Line, "contour"),
        entry(Role::Visible, Swatch::Line, "a face, nearly opaque"),
        entry(Role::Hidden, Swatch::Line, "a face, nearly transparent"),
        entry(Role::Eye, Swatch::Area, "rays on which the background shows"),
    ];
    let title = "Chamberlain et al. 1996, Figure 4: why surfaces are torn";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption(&pixels), &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All leaves are cubes of the last level on a grid of side 1; opacities along an axis add up to what is
    /// seen from there, which is the whole side; and off-axis something shows that should not.
    #[test]
    fn the_contour_is_whole_along_the_axes_and_torn_between() {
        let shot = Shot::new(&Maker::gray()).expect("a contour");
        assert!(shot.list.prims.is_empty() && shot.cubes().len() > 10);
        for cube in shot.cubes() {
            assert!((cube.bounds.size() - Vec2::splat(LEAF)).abs().max_element() < 1e-4, "{:?}", cube.bounds);
        }
        for axis in 0..2 {
            // No two leaves of a row hide the same, since the contour goes one way: coverages add up.
            let sum: f32 = shot.cubes().iter().map(|cube| cube.faces.get(2 * axis)[3]).sum();
            assert!((sum - LEAVES).abs() < 0.25, "axis {axis}: {sum} of {LEAVES} leaves");
        }
        let pixels = shot.pixels();
        let torn = pixels.iter().filter(|p| p.is_covered && p.left > TORN).count();
        assert!(torn > 3 && torn < PIXELS as usize / 2, "{torn}");
    }
}
