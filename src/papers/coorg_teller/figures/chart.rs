//! Figures 9 and 11 of the paper: the pseudocode that the explorer steps through, and the area-angle against
//! the true solid angle, which is computed after van Oosterom and Strackee, "The Solid Angle of a Plane
//! Triangle", 1983.

use glam::{DVec3, Vec2, Vec3, vec2};

use crate::culling::anatomy::Blockers;
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject};
use crate::figure::axis::{Axis, axes};
use crate::figure::tools::{COLUMN_PT, LABEL_PT, Maker, NAME_PT, Plan, TWO_COLUMNS_PT, entry, eye};
use crate::figure::{Paper, Row, Sheet, Swatch, clip, listing};
use crate::geometry::{Aabb, Solid};
use crate::method::CodeLine;
use crate::papers::keys::LARGE_OCCLUDERS;
use crate::scene::{SceneError, example};

/// The lines that belong to the default parameters.
fn code(maker: &Maker<'_>) -> Result<Vec<CodeLine>, SceneError> {
    let scene = example("street")?;
    let film = maker.film(&scene, &eye(&scene, 0), LARGE_OCCLUDERS, &[]);
    let lines = film.card().code.iter().zip(0..).filter(|(_, line)| film.has_line(*line));
    Ok(lines.map(|(line, _)| *line).collect())
}

/// Figure 9: the algorithm. Below a line that differs from the paper's stands the paper's.
pub(super) fn pseudocode(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let paper = listing(&Row::all(&code(maker)?), COLUMN_PT);
    let caption = "The visibility algorithm, called with the root of the kD-tree, as the explorer steps \
                   through it: the selection of occluders, the recursion with view-frustum culling in front, \
                   TestOcclusion opened up, and the detail objects in Gather. In gray below a line: what the \
                   paper's says in its place.";
    Ok(maker.page(Paper::Column, "The visibility algorithm", Vec::new(), caption, &paper))
}

/// The solid angle of a triangle from a point, steradians.
fn solid_angle(corners: [DVec3; 3], from: DVec3) -> f64 {
    let [a, b, c] = corners.map(|p| p - from);
    let (x, y, z) = (a.length(), b.length(), c.length());
    let below = x * y * z + a.dot(b) * z + a.dot(c) * y + b.dot(c) * x;
    2.0 * a.dot(b.cross(c)).abs().atan2(below)
}

/// A square of side 2 around the origin, across z.
const SQUARE: [Vec3; 4] = [
    Vec3::new(-1.0, -1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
];

/// Area-angle by the method's own function, and the true solid angle.
fn both(from: Vec3) -> [f64; 2] {
    let square = Blockers::<Solid>::new(&SQUARE, &[vec![0, 1, 2, 3]]);
    let [a, b, c, d] = SQUARE.map(|p| p.as_dvec3());
    let eye = from.as_dvec3();
    [square.area_angle(0, from), solid_angle([a, b, c], eye) + solid_angle([a, c, d], eye)]
}

fn at_distance(distance: f64) -> [f64; 2] {
    both(Vec3::Z * distance as f32)
}

/// Distance of the viewpoint in the chart over obliqueness, units.
const AWAY: f64 = 4.0;

fn at_angle(degrees: f64) -> [f64; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    both(Vec3::new((AWAY * sine) as f32, 0.0, (AWAY * cosine) as f32))
}

/// What a chart shows: an x axis, a y axis, and for each x both values.
struct Chart {
    x: Axis,
    y: Axis,
    rows: Vec<(f64, [f64; 2])>,
    label: &'static str,
}

impl Chart {
    fn draw(&self, to: &mut Drawing, min: Vec2, max: Vec2) {
        let mut lines = Drawing::default();
        let [low, high] = axes(to, &self.x, &self.y, min, max);
        for (which, role) in [(1, Role::Visible), (0, Role::Evidence)] {
            let place = |(x, values): &(f64, [f64; 2])| {
                vec2(
                    low.x + self.x.place(*x) * (high.x - low.x),
                    high.y - self.y.place(values[which]) * (high.y - low.y),
                )
            };
            lines.line(Layer::Evidence, role, Subject::None, self.rows.iter().map(place).collect::<Vec<_>>());
        }
        clip(&mut lines, low, high);
        to.items.extend(lines.items);
        to.text(
            Layer::Labels,
            Role::Ink,
            vec2((min.x + max.x) * 0.5, max.y + LABEL_PT * 1.6),
            LABEL_PT,
            Anchor::Middle,
            self.label,
        );
    }
}

/// The parameters of the area-angle, in cross section.
fn parameters(width_pt: f32) -> Plan {
    let mut plan = Plan::new(Aabb { min: Vec2::new(-3.0, -4.6), max: Vec2::new(3.0, 1.6) }, width_pt);
    let (p, ends) = (Vec2::new(1.3, -4.0), [Vec2::new(1.7, -0.5), Vec2::new(-1.9, 0.5)]);
    let center = (ends[0] + ends[1]) * 0.5;
    let normal = (ends[1] - ends[0]).perp().normalize();
    for end in ends {
        plan.line(Role::Faint, p, end);
    }
    plan.world.line(Layer::Emphasis, Role::Occluder, Subject::None, ends);
    let mut arrow =
        |role, a: Vec2, b: Vec2| plan.world.push(Layer::Emphasis, role, Subject::None, Mark::Arrow(a, b));
    arrow(Role::Evidence, p, center);
    arrow(Role::Ink, center, center + normal * 1.5);
    let toward = (center - p).normalize();
    arrow(Role::Eye, p, p + toward * 1.3);
    let mut say = |at: Vec2, text: &str| plan.plate(at, NAME_PT, Font::Bold, text);
    say(ends[1] * 0.6 + Vec2::Y * 0.5, "A");
    say(center + normal * 1.5 - Vec2::X * 0.4, "N");
    say(p + toward * 0.8 - Vec2::X * 0.55, "V");
    say(p + (center - p) * 0.62 + Vec2::X * 0.45, "D");
    plan.viewpoint(p, "P");
    plan
}

/// Draws the parameters of the area-angle into the upper left of a page, `size` large.
fn draw_parameters(to: &mut Drawing, size: Vec2) {
    let plan = parameters(size.x);
    let mut sketch = Drawing::default();
    let corners = [Vec2::ZERO, size];
    Sheet::fit(&plan.frame, corners[0], corners[1]).place(&plan.world, &mut sketch);
    clip(&mut sketch, corners[0], corners[1]);
    to.items.extend(sketch.items);
    to.text(
        Layer::Labels,
        Role::Ink,
        vec2(size.x * 0.5, size.y + LABEL_PT * 1.6),
        LABEL_PT,
        Anchor::Middle,
        "(a) parameters, in cross section",
    );
}

/// The charts: by distance and by obliqueness.
fn charts() -> [Chart; 2] {
    let axis =
        |label: &str, low: f64, high: f64, logarithmic| Axis { label: label.into(), low, high, logarithmic };
    [
        Chart {
            x: axis("distance, units", 0.1, 100.0, true),
            y: axis("solid angle, sr", 1e-4, 1e3, true),
            rows: (0..=60)
                .map(|i| 10f64.powf(f64::from(i) / 20.0 - 1.0))
                .map(|d| (d, at_distance(d)))
                .collect(),
            label: "(b) by distance, seen head-on",
        },
        Chart {
            x: axis("angle between V and −N, degrees", 0.0, 90.0, false),
            y: axis("solid angle, sr", 0.0, 0.3, false),
            rows: (0..=90).step_by(3).map(|a| (f64::from(a), at_angle(f64::from(a)))).collect(),
            label: "(c) by obliqueness, 4 units away",
        },
    ]
}

/// Figure 11: the area-angle, its parameters, and what it estimates.
pub(super) fn area_angle(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    const HEIGHT_PT: f32 = 140.0;
    const GAP_PT: f32 = 12.0;
    let width = (TWO_COLUMNS_PT - 2.0 * GAP_PT) / 3.0;
    let left = |i: usize| (width + GAP_PT) * i as f32;
    let mut paper =
        Drawing { size_pt: vec2(TWO_COLUMNS_PT, HEIGHT_PT + LABEL_PT * 2.0), ..Drawing::default() };
    draw_parameters(&mut paper, vec2(width, HEIGHT_PT));
    for (i, chart) in charts().iter().enumerate() {
        chart.draw(&mut paper, vec2(left(i + 1), 0.0), vec2(left(i + 1) + width, HEIGHT_PT));
    }
    let legend = vec![
        entry(Role::Evidence, Swatch::Line, "area-angle −A (N·V) / |D|²"),
        entry(Role::Visible, Swatch::Line, "true solid angle"),
        entry(Role::Occluder, Swatch::Line, "occluder of area A and normal N"),
        entry(Role::Eye, Swatch::Line, "viewing direction V"),
    ];
    let caption = "The area-angle estimates the solid angle that an occluder takes up from the viewpoint P; \
                   D leads to the occluder's center, and V is the direction in which P sees it. The charts \
                   compare the two for a square of side 2. Like the solid angle it grows with the area and \
                   falls with the square of the distance and the cosine of obliqueness. Nearby it is too \
                   large: half a side away nearly twice the solid angle, which is 2π at most. That does no \
                   harm, since such an occluder comes first anyway.";
    Ok(maker.page(Paper::TwoColumns, "Area-angle and solid angle", legend, caption, &paper))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::metrics;

    #[test]
    fn the_true_solid_angle_is_true() {
        // From its middle each face of a cube takes up a sixth of the sphere.
        let [_, face] = at_distance(1.0);
        assert!((face - std::f64::consts::TAU / 3.0).abs() < 1e-12, "{face}");
        // A square from above its middle: 4 asin(1 / (1 + d²)) for half side 1.
        for d in [0.1, 0.5, 3.0, 40.0] {
            let [_, angle] = at_distance(d);
            let d = f64::from(d as f32);
            assert!((angle / (4.0 * (1.0 / (1.0 + d * d)).asin()) - 1.0).abs() < 1e-9, "{d}: {angle}");
        }
    }

    #[test]
    fn the_area_angle_is_good_from_afar_and_too_large_nearby() {
        let ratio = |[estimate, truth]: [f64; 2]| estimate / truth;
        assert!((ratio(at_distance(30.0)) - 1.0).abs() < 0.01);
        assert!((ratio(at_distance(1.0)) - 1.91).abs() < 0.01 && ratio(at_distance(0.2)) > 5.0);
        for degrees in [0.0, 30.0, 60.0, 85.0] {
            assert!((ratio(at_angle(degrees)) - 1.0).abs() < 0.12, "{degrees}: {:?}", at_angle(degrees));
        }
        assert!((at_angle(60.0)[0] / at_angle(0.0)[0] - 0.5).abs() < 1e-6, "it falls with the cosine");
    }

    #[test]
    fn the_pseudocode_fits_its_column() {
        let drawing = pseudocode(&Maker::gray()).expect("a figure");
        for item in &drawing.items {
            let Mark::Text { at, text, size_pt, anchor, font } = &item.mark else { continue };
            let [low, high] = metrics::text_box(*at, text, *font, *size_pt, *anchor);
            assert!(low.x >= -0.1 && high.x <= drawing.size_pt.x + 0.1 && *size_pt > 6.0, "{text}");
        }
    }
}
