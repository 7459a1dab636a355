//! Figures 5 to 8 of the paper, in space: joint occlusion as the viewpoint sees it, planes through an edge
//! that touch a box, the outlines of a box, and the codes of the regions between its extended outline.

use glam::{DVec2, Vec2, Vec3};

use super::regions::{Border, cells, holds, middle};
use crate::culling::anatomy::{Blockers, Tangent, outline_seen_from, sides_of_outline, tangent_corners};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};
use crate::figure::tools::{COLUMN_PT, LABEL_PT, Maker, NAME_PT, Plan, TWO_COLUMNS_PT, entry, name, view};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{Aabb, Solid};
use crate::scene::SceneError;

/// Occluders and a box, seen from the origin along −z.
struct Stage {
    label: &'static str,
    points: Vec<Vec3>,
    polygons: Vec<Vec<u32>>,
    target: Aabb<Vec3>,
    /// The edge whose line the box crosses.
    crossed: Option<[u32; 2]>,
}

fn bounds(min: [f32; 3], max: [f32; 3]) -> Aabb<Vec3> {
    Aabb { min: min.into(), max: max.into() }
}

/// The three stages of Figure 5.
fn stages() -> [Stage; 3] {
    let p = |points: &[[f32; 3]]| points.iter().map(|p| Vec3::from(*p)).collect();
    let folded = Stage {
        label: "(a) convex",
        points: p(&[
            [-3.0, -1.2, -8.0],
            [0.0, -1.2, -6.0],
            [3.0, -1.2, -8.0],
            [-3.0, 1.2, -8.0],
            [0.0, 1.2, -6.0],
            [3.0, 1.2, -8.0],
        ]),
        polygons: vec![vec![0, 1, 4, 3], vec![1, 2, 5, 4]],
        target: bounds([-2.2, -1.0, -12.0], [2.2, 1.0, -11.0]),
        crossed: None,
    };
    let crooked = Stage {
        label: "(b) not convex",
        points: p(&[
            [-2.0, -1.5, -6.0],
            [2.0, -1.5, -6.0],
            [2.0, -0.2, -6.0],
            [0.0, -0.2, -6.0],
            [-2.0, -0.2, -6.0],
            [0.0, 1.5, -6.0],
            [-2.0, 1.5, -6.0],
        ]),
        polygons: vec![vec![0, 1, 2, 3, 4], vec![4, 3, 5, 6]],
        target: bounds([-3.0, -1.8, -12.0], [-0.6, 1.6, -11.0]),
        crossed: Some([3, 2]),
    };
    let apart = Stage {
        label: "(c) disconnected",
        points: p(&[
            [-1.9, -1.2, -5.0],
            [0.2, -1.2, -5.0],
            [0.2, 1.2, -5.0],
            [-1.9, 1.2, -5.0],
            [-0.3, -1.4, -7.0],
            [2.5, -1.4, -7.0],
            [2.5, 1.4, -7.0],
            [-0.3, 1.4, -7.0],
        ]),
        polygons: vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7]],
        target: bounds([-2.6, -1.4, -12.0], [2.6, 1.4, -11.0]),
        crossed: None,
    };
    [folded, crooked, apart]
}

impl Stage {
    fn hiding(&self) -> Vec<usize> {
        Blockers::<Solid>::new(&self.points, &self.polygons).hiding(&self.target, Vec3::ZERO)
    }
    /// Draws the occluders, the outline of their union, and the box as the verdict colors it.
    fn draw(&self) -> Drawing<Vec3> {
        let mut world = Drawing::default();
        let point = |i: &u32| self.points[*i as usize];
        for polygon in &self.polygons {
            world.push(
                Layer::Scene,
                Role::Scene,
                Subject::None,
                Mark::Area(polygon.iter().map(point).collect()),
            );
            for (i, a) in polygon.iter().enumerate() {
                let b = polygon[(i + 1) % polygon.len()];
                let shared = self.polygons.iter().filter(|p| p.contains(a) && p.contains(&b)).count() > 1;
                let role = if shared { Role::Outside } else { Role::Ink };
                world.line(Layer::Nodes, role, Subject::None, [point(a), point(&b)]);
            }
        }
        let role = if self.hiding().is_empty() { Role::Visible } else { Role::Hidden };
        world.bounds(Layer::Evidence, role, Subject::None, &self.target);
        name(&mut world, self.target.corner(4) + Vec3::new(0.5, 0.3, 0.0), "T");
        if let Some([a, b]) = self.crossed {
            let (a, b) = (point(&a), point(&b));
            world.line(Layer::Emphasis, Role::Evidence, Subject::None, [a - (b - a) * 1.2, b]);
            name(&mut world, a + (b - a) * 0.5 + Vec3::Y * 0.12, "e");
        }
        world
    }
}

/// Figure 5: joint occlusion, as seen from the viewpoint.
pub(super) fn joint_occlusion(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let seen = view(Vec3::ZERO, Vec3::NEG_Z, 34.0, [400, 300]);
    let panel = |stage: &Stage| {
        let verdict = match stage.hiding().len() {
            0 => "found visible".to_owned(),
            n => format!("hidden by {n} together"),
        };
        Panel { label: format!("{}: {verdict}", stage.label), picture: Picture::Space(stage.draw(), seen) }
    };
    let content = panels(TWO_COLUMNS_PT, 3, &stages().each_ref().map(panel));
    let legend = vec![
        entry(Role::Scene, Swatch::Area, "occluder"),
        entry(Role::Ink, Swatch::Line, "edge of an occluder"),
        entry(Role::Outside, Swatch::Line, "shared edge: its supporting plane is ignored"),
        entry(Role::Hidden, Swatch::Line, "box T, found hidden"),
        entry(Role::Visible, Swatch::Line, "box T, found visible"),
        entry(Role::Evidence, Swatch::Line, "line of edge e, which T crosses"),
    ];
    let caption = "Three sets of occluders as seen from the viewpoint. In all three they hide the box T \
                   behind them, though none does alone. (a) Connected occluders with a convex silhouette: \
                   the plane through the edge they share is ignored and T lies inside all others, so it is \
                   found hidden. (b) Connected, but the silhouette is not convex: T crosses the line of edge \
                   e, so the test fails. (c) Disconnected: no edge is ignored, and the test fails. Both \
                   failures are on the safe side: T is drawn.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Joint occlusion in space, seen from the viewpoint",
        legend,
        caption,
        &content,
    ))
}

/// A piece of a tangent plane: the edge moved along the plane, through the vertex and past it both ways.
fn sheet(tangent: &Tangent<Vec3>, before: f32, past: f32) -> Vec<Vec3> {
    let [a, b] = [tangent.edge[0], tangent.edge[1]];
    let along = (b - a).normalize();
    let arm = tangent.vertex - a;
    let across = arm - along * arm.dot(along);
    vec![a - across * before, b - across * before, b + across * past, a + across * past]
}

/// The occluder of Figure 6.
const POLYGON: [Vec3; 4] = [
    Vec3::new(-1.3, -1.1, 0.0),
    Vec3::new(1.3, -1.1, 0.0),
    Vec3::new(1.3, 1.1, 0.0),
    Vec3::new(-1.3, 1.1, 0.0),
];

/// The supporting and the separating plane through an edge.
type Planes = [Tangent<Vec3>; 2];

/// The box of Figure 6, and the planes through each edge of the occluder.
fn planes_of_polygon() -> (Aabb<Vec3>, Vec<Option<Planes>>) {
    let target = bounds([-0.9, -0.8, -4.6], [0.8, 0.8, -3.0]);
    let blockers = Blockers::<Solid>::new(&POLYGON, &[vec![0, 1, 2, 3]]);
    (target, blockers.planes(0, &target, Vec3::new(0.0, 0.0, 4.0)))
}

/// Draws the occluder, the box, and both planes through an edge.
fn draw_planes(target: &Aabb<Vec3>, [supporting, separating]: &Planes) -> Drawing<Vec3> {
    let mut world = Drawing::default();
    world.push(Layer::Scene, Role::Occluder, Subject::None, Mark::Area(POLYGON.to_vec()));
    for (tangent, role, before, past) in
        [(separating, Role::Partial, 0.35, 1.15), (supporting, Role::Evidence, 0.35, 1.15)]
    {
        let corners = sheet(tangent, before, past);
        world.push(Layer::Evidence, role, Subject::None, Mark::Area(corners.clone()));
        let arrow = (corners[2] + corners[3]) * 0.5;
        world.push(Layer::Evidence, role, Subject::None, Mark::Arrow(arrow, arrow + tangent.normal * 0.8));
        world.push(Layer::Emphasis, role, Subject::None, Mark::Dot { at: tangent.vertex, radius_pt: 3.0 });
    }
    world.bounds(Layer::Nodes, Role::Ink, Subject::None, target);
    world.line(Layer::Emphasis, Role::Current, Subject::None, supporting.edge.clone());
    name(&mut world, supporting.edge[0].lerp(supporting.edge[1], 0.5) + Vec3::X * 0.45, "E");
    name(&mut world, target.center() + Vec3::Y * (target.size().y * 0.5), "T");
    world
}

/// Figure 6: the two planes through an edge of a polygon that touch a box.
pub(super) fn tangent_planes(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let (target, planes) = planes_of_polygon();
    let Some(through_edge) = &planes[1] else { unreachable!("the edge's line does not meet the box") };
    let world = draw_planes(&target, through_edge);
    let observer = view(Vec3::new(7.0, 5.5, 5.0), Vec3::new(0.2, -0.15, -1.2), 32.0, [400, 300]);
    let content = panels(
        COLUMN_PT,
        1,
        &[Panel {
            label: "Seen from the side; the viewpoint is before the occluder.".into(),
            picture: Picture::Space(world, observer),
        }],
    );
    let legend = vec![
        entry(Role::Occluder, Swatch::Area, "occluder"),
        entry(Role::Current, Swatch::Line, "its edge E"),
        entry(Role::Evidence, Swatch::Area, "supporting plane"),
        entry(Role::Evidence, Swatch::Dot, "its tangent vertex"),
        entry(Role::Partial, Swatch::Area, "separating plane"),
        entry(Role::Partial, Swatch::Dot, "its tangent vertex"),
    ];
    let caption = "The two planes through an edge E of a polygon that touch a box T, each at a tangent \
                   vertex (dot). The supporting plane has the box and the polygon on one side, the \
                   separating plane on opposite sides. Arrows point to the inside, the polygon's side.";
    Ok(maker.page(Paper::Column, "Tangent planes through an edge", legend, caption, &content))
}

/// The box of Figures 7 and 8.
fn the_box() -> Aabb<Vec3> {
    bounds([-1.4, -0.9, -1.1], [1.4, 0.9, 1.1])
}

/// Figure 7: the outlines of a box from the three kinds of places.
pub(super) fn silhouettes(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let target = the_box();
    let panel = |(place, from): (&str, Vec3)| {
        let outline = outline_seen_from(from, &target);
        let at = |i: u8| target.corner(i as usize);
        let mut world = Drawing::default();
        world.bounds(Layer::Nodes, Role::Faint, Subject::None, &target);
        for (i, &a) in outline.iter().enumerate() {
            let b = outline[(i + 1) % outline.len()];
            world.push(Layer::Evidence, Role::Eye, Subject::None, Mark::Arrow(at(a), at(b)));
        }
        for &i in &outline {
            let at = at(i) + at(i).normalize() * 0.24;
            let mark = Mark::Text {
                at,
                text: i.to_string(),
                size_pt: LABEL_PT,
                anchor: Anchor::Middle,
                font: Font::Bold,
            };
            world.push(Layer::Labels, Role::Ink, Subject::None, mark);
        }
        let order = outline.iter().map(u8::to_string).collect::<Vec<_>>().join(" ");
        let seen = view(from, Vec3::ZERO, 3.9f32.atan2(from.length()).to_degrees() * 1.35, [360, 300]);
        Panel { label: format!("{place}: {order}"), picture: Picture::Space(world, seen) }
    };
    let places = [
        ("before a face", Vec3::new(0.5, 0.35, 5.5)),
        ("beside an edge", Vec3::new(4.6, 0.35, 4.0)),
        ("off a corner", Vec3::new(3.8, 3.2, 4.2)),
    ];
    let content = panels(TWO_COLUMNS_PT, 3, &places.map(panel));
    let legend = vec![
        entry(Role::Eye, Swatch::Line, "outline, directed"),
        entry(Role::Faint, Swatch::Line, "other edges of the box"),
    ];
    let caption = "The outline of an axis-aligned box as seen from the origin depends only on where the \
                   origin lies against the box's three slabs: below, inside or above on each axis. Of these \
                   27 places 6 are before a face and give 4 corners, 12 beside an edge and 8 off a corner \
                   give 6; inside there is none. So a table holds them all. Bit a of a corner's number says \
                   whether it lies at the upper end of axis a.";
    Ok(maker.page(Paper::TwoColumns, "Silhouettes of a box", legend, caption, &content))
}

/// Where the eye of Figure 8 stands, and the plane that it projects to.
struct Projected {
    from: Vec3,
    axes: [Vec3; 3],
}

impl Projected {
    fn new(from: Vec3) -> Self {
        let forward = -from.normalize();
        let right = forward.cross(Vec3::Y).normalize();
        Self { from, axes: [right, right.cross(forward), forward] }
    }
    fn flat(&self, p: Vec3) -> DVec2 {
        let d = (p - self.from).as_dvec3();
        let [x, y, z] = self.axes.map(|a| a.as_dvec3().dot(d));
        DVec2::new(x, y) / z
    }
    /// The direction of a point of the plane, as the far end of an edge that begins at the eye.
    fn edge_to(&self, q: DVec2) -> Vec3 {
        let [x, y, z] = self.axes.map(|a| a.as_dvec3());
        (self.from.as_dvec3() + (x * q.x + y * q.y + z)).as_vec3()
    }
}

/// The cells between the extended lines of an outline, each with its code.
fn coded_cells(projected: &Projected, target: &Aabb<Vec3>, frame: &Aabb<DVec2>) -> Vec<(u8, Vec<DVec2>)> {
    let corner = |i: u8| projected.flat(target.corner(i as usize));
    let outline = outline_seen_from(projected.from, target);
    let line = |i: usize| {
        let (a, b) = (corner(outline[i]), corner(outline[(i + 1) % outline.len()]));
        Border { at: a, normal: (b - a).perp() }
    };
    let borders: Vec<Border> = (0..outline.len()).map(line).collect();
    let code = |cell: &Vec<DVec2>| sides_of_outline(projected.from, projected.edge_to(middle(cell)), target);
    cells(frame, &borders).into_iter().map(|c| (code(&c), c)).collect()
}

/// What Figure 8 looks at.
fn figure_8() -> (Projected, Aabb<DVec2>) {
    let half = DVec2::new(0.50, 0.40);
    (Projected::new(Vec3::new(5.4, 4.6, 6.0)), Aabb { min: -half, max: half })
}

/// Sizes of codes: the lesser where a cell is small.
const CODE_PT: [f32; 2] = [6.5, 5.5];

/// Where in a cell a code fits, nearest to its middle; `None` where the cell is too small.
fn room(cell: &[DVec2], text: &str, size_pt: f32, unit: f32, lines: &[[Vec2; 2]]) -> Option<Vec2> {
    let half = (Vec2::new(metrics::width_pt(text, Font::Mono, size_pt) * 0.5 + 1.0, size_pt * 0.45 + 0.5)
        * unit)
        .as_dvec2();
    let center = middle(cell);
    let [low, high] = cell.iter().fold([center; 2], |[a, b], p| [a.min(*p), b.max(*p)]);
    let fits = |at: &DVec2| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .iter()
            .all(|c| holds(cell, *at + DVec2::from(*c) * half))
    };
    let clear = |at: &DVec2| lines.iter().all(|[a, b]| !crosses(a.as_dvec2(), b.as_dvec2(), *at, half));
    let places = (0..=30).flat_map(|i| (0..=30).map(move |j| DVec2::new(f64::from(i), f64::from(j)) / 30.0));
    let places = places.map(|t| low + (high - low) * t).chain([center]).filter(fits).filter(clear);
    places.min_by(|a, b| (*a - center).length().total_cmp(&(*b - center).length())).map(|p| p.as_vec2())
}

/// Whether a segment meets the box of half size `half` around `at`, to within a 64th of its length.
fn crosses(a: DVec2, b: DVec2, at: DVec2, half: DVec2) -> bool {
    (0..=64).any(|i| (a.lerp(b, f64::from(i) / 64.0) - at).abs().cmple(half).all())
}

/// Fills the regions and sets their codes where they fit beside the tangents.
fn draw_codes(plan: &mut Plan, all: &[(u8, Vec<DVec2>)], tangents: &[[Vec2; 2]]) {
    for (code, cell) in all {
        plan.area(Role::Faint, cell);
        let inside = *code == 0 || *code == 63;
        if inside {
            plan.area(Role::Scene, cell);
        }
        let text = format!("{code:06b}");
        if let Some((at, size_pt)) =
            CODE_PT.into_iter().find_map(|size| Some((room(cell, &text, size, plan.unit, tangents)?, size)))
        {
            plan.label(at, size_pt, Font::Mono, &text);
        }
    }
}

/// Draws the directed outline with the numbers of its corners.
fn draw_outline(plan: &mut Plan, outline: &[u8], corner: impl Fn(u8) -> Vec2) {
    for (i, &a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        plan.world.push(Layer::Emphasis, Role::Eye, Subject::None, Mark::Arrow(corner(a), corner(b)));
        let out = corner(a).normalize() * 7.0 * plan.unit;
        plan.plate(corner(a) + out, LABEL_PT, Font::Bold, &a.to_string());
    }
}

/// Draws the projected edge e and the tangents from it, which touch the box at two corners.
fn draw_tangents(plan: &mut Plan, e: Vec2, touched: [Vec2; 2], tangents: [[Vec2; 2]; 2]) {
    for (vertex, [from, to]) in touched.into_iter().zip(tangents) {
        plan.line(Role::Evidence, from, to);
        plan.dot(Role::Evidence, vertex, 2.5);
    }
    plan.dot(Role::Occluder, e, 3.0);
    plan.plate(e + Vec2::new(8.0, 0.0) * plan.unit, NAME_PT, Font::Bold, "e");
}

/// Figure 8: the regions between the extended outline and their codes.
pub(super) fn outline_codes(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let target = the_box();
    let (projected, wide) = figure_8();
    let mut plan = Plan::new(Aabb { min: wide.min.as_vec2(), max: wide.max.as_vec2() }, COLUMN_PT);
    let corner = |i: u8| projected.flat(target.corner(i as usize)).as_vec2();
    let e = Vec2::new(0.36, -0.05);
    let [Some(touched), _] =
        tangent_corners::<Solid>(projected.from, projected.edge_to(e.as_dvec2()), &target)
    else {
        unreachable!("the edge's projection lies beside the box")
    };
    let tangents = touched.map(|v| [e, corner(v) + (corner(v) - e) * 0.2]);
    draw_codes(&mut plan, &coded_cells(&projected, &target, &wide), &tangents);
    let outline = outline_seen_from(projected.from, &target);
    draw_outline(&mut plan, &outline, corner);
    draw_tangents(&mut plan, e, touched.map(corner), tangents);
    let code = sides_of_outline(projected.from, projected.edge_to(e.as_dvec2()), &target);
    let content = panels(
        COLUMN_PT,
        1,
        &[plan.panel(format!("e: code {code:06b}, tangent vertices {} and {}", touched[0], touched[1]))],
    );
    let legend = vec![
        entry(Role::Eye, Swatch::Line, "silhouette, directed, extended (gray)"),
        entry(Role::Scene, Swatch::Area, "projection of the box"),
        entry(Role::Occluder, Swatch::Dot, "projection e of an occluder's edge"),
        entry(Role::Evidence, Swatch::Line, "tangent from e"),
    ];
    let caption = format!(
        "A box off whose corner the origin lies, projected from the origin. An occluder's edge that begins \
         at the origin projects to a point e. The bits of its code are the signs of dot products with the \
         six directed silhouette lines; the right-most bit is that of the line that begins at vertex {}, and \
         so on around. All points of a region have the same tangent vertices, so a table gives them by the \
         code.",
        outline[0]
    );
    Ok(maker.page(Paper::Column, "Codes of the regions around a box", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PrimId;
    use crate::raster;
    use crate::scene::{Parts, Scene};
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    /// Triangles of the occluders, then of the box.
    fn scene(stage: &Stage, without: Option<usize>) -> Scene<Solid> {
        let mut points = stage.points.clone();
        let mut prims: Vec<[u32; 3]> = Vec::new();
        for (i, polygon) in stage.polygons.iter().enumerate() {
            let fan = polygon[1..].windows(2).map(|w| [polygon[0], w[0], w[1]]);
            prims.extend(fan.filter(|_| without != Some(i)));
        }
        let first = points.len() as u32;
        points.extend(stage.target.corners());
        let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        prims.extend(
            faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).map(|t| t.map(|i| i + first)),
        );
        Scene::new(Parts::simple("stage", points, prims)).expect("a scene")
    }

    fn box_is_seen(stage: &Stage, without: Option<usize>) -> bool {
        let scene = scene(stage, without);
        let seen = view(Vec3::ZERO, Vec3::NEG_Z, 34.0, [800, 600]);
        let first_of_box = PrimId(scene.prim_count() as u32 - 12);
        raster::visible(&raster::render(&scene, &seen, scene.live())).iter().any(|p| *p >= first_of_box)
    }

    #[test]
    fn in_all_three_stages_the_box_is_hidden_by_both_and_by_neither_alone() {
        let found: Vec<usize> = stages().iter().map(|s| s.hiding().len()).collect();
        assert_eq!(found, [2, 0, 0], "only the convex silhouette is found");
        for stage in stages() {
            assert!(!box_is_seen(&stage, None), "{}", stage.label);
            for i in 0..2 {
                assert!(box_is_seen(&stage, Some(i)), "{} without {i}", stage.label);
            }
        }
    }

    #[test]
    fn outlines_are_the_convex_hull_of_the_projected_box() {
        let target = the_box();
        for (from, count) in
            [(Vec3::new(0.5, 0.35, 5.5), 4), (Vec3::new(4.6, 0.35, 4.0), 6), (Vec3::new(3.8, 3.2, 4.2), 6)]
        {
            let (outline, projected) = (outline_seen_from(from, &target), Projected::new(from));
            assert_eq!(outline.len(), count);
            let corners: Vec<DVec2> = target.corners().map(|c| projected.flat(c)).collect();
            let turns: Vec<bool> = (0..count)
                .flat_map(|i| {
                    let (a, b) = (corners[outline[i] as usize], corners[outline[(i + 1) % count] as usize]);
                    corners
                        .iter()
                        .map(move |c| (b - a).perp_dot(*c - a))
                        .filter(|t| t.abs() > 1e-9)
                        .map(|t| t > 0.0)
                        .collect::<Vec<_>>()
                })
                .collect();
            assert!(
                turns.windows(2).all(|w| w[0] == w[1]),
                "all corners lie on one side of every line of the outline"
            );
        }
    }

    #[test]
    fn every_region_has_one_code_and_one_pair_of_tangent_vertices() {
        let target = the_box();
        let (projected, frame) = figure_8();
        let all = coded_cells(&projected, &target, &frame);
        let mut codes: Vec<u8> = all.iter().map(|c| c.0).collect();
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), all.len(), "no code stands for two regions");
        let mut rng = Pcg32::seed_from_u64(8);
        let mut number = || f64::from(rng.next_u32()) / f64::from(u32::MAX) - 0.5;
        for _ in 0..2000 {
            let q = frame.max * 2.0 * DVec2::new(number(), number());
            let Some((code, cell)) = all.iter().find(|(_, c)| holds(c, q)) else {
                panic!("{q} is in no cell")
            };
            if (0..cell.len())
                .any(|i| (cell[(i + 1) % cell.len()] - cell[i]).normalize().perp_dot(q - cell[i]) < 1e-4)
            {
                continue;
            }
            assert_eq!(*code, sides_of_outline(projected.from, projected.edge_to(q), &target));
            let touched = |q: DVec2| {
                tangent_corners::<Solid>(projected.from, projected.edge_to(q), &target).map(|t| {
                    t.map(|mut t| {
                        t.sort_unstable();
                        t
                    })
                })
            };
            let [table, naive] = touched(q);
            assert_eq!(table, naive, "{q}");
            assert_eq!(table, touched(middle(cell))[0], "{q}");
        }
    }

    #[test]
    fn tangent_planes_touch_the_box_and_part_or_join_it_with_the_occluder() {
        let (target, planes) = planes_of_polygon();
        for [supporting, separating] in planes.into_iter().flatten() {
            let least_and_most = |t: &Tangent<Vec3>, of: &[Vec3]| {
                let d = of.iter().map(|p| t.normal.dot(*p - t.edge[0]));
                d.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], h| [a.min(h), b.max(h)])
            };
            let corners: Vec<Vec3> = target.corners().collect();
            for plane in [&supporting, &separating] {
                let [low, high] = least_and_most(plane, &POLYGON);
                assert!(low > -1e-5 && high > 0.1, "the occluder is inside: {low} {high}");
                assert!(
                    plane.normal.dot(plane.vertex - plane.edge[0]).abs() < 1e-5,
                    "the vertex is on the plane"
                );
            }
            assert!(least_and_most(&supporting, &corners)[0] > -1e-5);
            assert!(least_and_most(&separating, &corners)[1] < 1e-5);
        }
    }
}
