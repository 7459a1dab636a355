//! What the figures of this folder share: a flatland picture with labels, a cast of occluders and a box,
//! pages.

use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use super::regions::{Border, area, middle};
use crate::culling::anatomy::{Blockers, Tangent};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};
use crate::figure::{Entry, Page, Panel, Paper, Picture, Swatch};
use crate::geometry::{Aabb, Eye, Flat, PrimId, Solid, View};
use crate::scene::{Scene, SceneError, example};

/// Width of a picture in one column and over two, inside the margins.
pub(in crate::figure) const COLUMN_PT: f32 = 232.0;
pub(in crate::figure) const TWO_COLUMNS_PT: f32 = 490.0;
/// Sizes of labels.
pub(in crate::figure) const NAME_PT: f32 = 10.0;
pub(in crate::figure) const LABEL_PT: f32 = 8.0;

/// An entry of a legend.
pub(in crate::figure) fn entry(role: Role, swatch: Swatch, label: &str) -> Entry {
    Entry { role, label: label.into(), swatch }
}

/// A page around a picture.
pub(in crate::figure) fn page(
    paper: Paper,
    title: &str,
    legend: Vec<Entry>,
    caption: impl Into<String>,
    content: &Drawing,
) -> Drawing {
    Page { paper, title: title.into(), legend, caption: caption.into() }.compose(content)
}

/// A flatland picture in world coordinates whose scale on paper is known, so that labels can be set on
/// plates.
pub(in crate::figure) struct Plan {
    pub(in crate::figure) world: Drawing<Vec2>,
    pub(in crate::figure) frame: Aabb<Vec2>,
    /// World units a point.
    pub(in crate::figure) unit: f32,
}

impl Plan {
    pub(in crate::figure) fn new(frame: Aabb<Vec2>, width_pt: f32) -> Self {
        Self { world: Drawing::default(), frame, unit: frame.size().x / width_pt }
    }
    pub(in crate::figure) fn wide(&self) -> Aabb<DVec2> {
        Aabb { min: self.frame.min.as_dvec2(), max: self.frame.max.as_dvec2() }
    }
    pub(in crate::figure) fn area(&mut self, role: Role, points: &[DVec2]) {
        self.world.push(
            Layer::Areas,
            role,
            Subject::None,
            Mark::Area(points.iter().map(|p| p.as_vec2()).collect()),
        );
    }
    pub(in crate::figure) fn line(&mut self, role: Role, a: Vec2, b: Vec2) {
        self.world.line(Layer::Evidence, role, Subject::None, [a, b]);
    }
    pub(in crate::figure) fn dot(&mut self, role: Role, at: Vec2, radius_pt: f32) {
        self.world.push(Layer::Eye, role, Subject::None, Mark::Dot { at, radius_pt });
    }
    /// A label whose middle is `at`, on a piece of paper.
    pub(in crate::figure) fn plate(&mut self, at: Vec2, size_pt: f32, font: Font, text: &str) {
        let half = Vec2::new(metrics::width_pt(text, font, size_pt) * 0.5 + 1.5, size_pt * 0.58) * self.unit;
        let at = at.clamp(self.frame.min + half, self.frame.max - half);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| at + Vec2::from(c) * half);
        self.world.push(Layer::Labels, Role::Paper, Subject::None, Mark::Area(corners.to_vec()));
        self.label(at, size_pt, font, text);
    }
    /// A label whose middle is `at`.
    pub(in crate::figure) fn label(&mut self, at: Vec2, size_pt: f32, font: Font, text: &str) {
        let at = at - Vec2::new(0.0, size_pt * 0.35 * self.unit);
        let mark = Mark::Text { at, text: text.into(), size_pt, anchor: Anchor::Middle, font };
        self.world.push(Layer::Labels, Role::Ink, Subject::None, mark);
    }
    /// A viewpoint with its name.
    pub(in crate::figure) fn viewpoint(&mut self, at: Vec2, name: &str) {
        self.dot(Role::Eye, at, 3.5);
        let half = metrics::width_pt(name, Font::Bold, NAME_PT) * 0.5;
        self.plate(at + Vec2::new(half + 6.5, -2.0) * self.unit, NAME_PT, Font::Bold, name);
    }
    pub(in crate::figure) fn panel(self, label: impl Into<String>) -> Panel {
        Panel { label: label.into(), picture: Picture::Flat(self.world, self.frame) }
    }
}

/// The middle of the largest of some cells.
pub(in crate::figure) fn largest<'a>(cells: impl Iterator<Item = &'a Vec<DVec2>>) -> Option<Vec2> {
    cells.max_by(|a, b| area(a).total_cmp(&area(b))).map(|c| middle(c).as_vec2())
}

/// The occluders A, B, … and the box T of a flatland scene.
pub(in crate::figure) struct Cast {
    pub(in crate::figure) scene: Arc<Scene<Flat>>,
    pub(in crate::figure) blockers: Blockers<Flat>,
    /// Name and ends of each occluder.
    pub(in crate::figure) occluders: Vec<(String, [Vec2; 2])>,
    pub(in crate::figure) target: Aabb<Vec2>,
}

impl Cast {
    pub(in crate::figure) fn of(scene: &str) -> Result<Self, SceneError> {
        let scene = example(scene)?;
        let name = |p: PrimId| scene.objects()[scene.object_of(p).at()].name.as_str();
        let (targets, blocking): (Vec<PrimId>, Vec<PrimId>) =
            scene.live().iter().partition(|&&p| name(p) == "T");
        let target = targets.iter().fold(Aabb::empty(), |sum, &p| sum.union(scene.prim_bounds(p)));
        let polygons: Vec<Vec<u32>> =
            blocking.iter().filter_map(|&p| scene.corners(p)).map(|c| c.to_vec()).collect();
        let ends = |p: PrimId| scene.prim_points(p).collect::<Vec<_>>();
        let occluders = blocking.iter().map(|&p| (name(p).to_owned(), [ends(p)[0], ends(p)[1]])).collect();
        Ok(Self { blockers: Blockers::new(scene.points(), &polygons), occluders, target, scene })
    }
    pub(in crate::figure) fn eye(&self, number: usize) -> Vec2 {
        self.scene.paths()[0].views[number].eye.position
    }
    /// The tangents through each end of an occluder: supporting, separating.
    pub(in crate::figure) fn tangents(&self, id: usize) -> Vec<[Tangent<Vec2>; 2]> {
        let [a, b] = self.occluders[id].1;
        // A point on each side of the occluder; the lines depend on no more than the side.
        let aside = [1.0, -1.0].map(|s| (a + b) * 0.5 + (b - a).perp() * s);
        aside.iter().flat_map(|&eye| self.blockers.planes(id, &self.target, eye)).flatten().collect()
    }
    /// Every line at which something can change: the occluders' own and their tangents.
    pub(super) fn borders(&self) -> Vec<Border> {
        let border = |at: Vec2, normal: Vec2| Border { at: at.as_dvec2(), normal: normal.as_dvec2() };
        let mut all = Vec::new();
        for (id, (_, [a, b])) in self.occluders.iter().enumerate() {
            all.push(border(*a, (*b - *a).perp()));
            all.extend(self.tangents(id).iter().flatten().map(|t| border(t.edge[0], t.normal)));
        }
        all
    }
    /// Draws the occluders and the box with their names; `sides`: 1 for a name before an occluder, −1 behind
    /// it.
    pub(in crate::figure) fn draw(&self, plan: &mut Plan, sides: &[f32]) {
        let target = self.target;
        plan.world.bounds(Layer::Emphasis, Role::Ink, Subject::None, &target);
        plan.label(target.center(), NAME_PT, Font::Bold, "T");
        for ((name, [a, b]), side) in self.occluders.iter().zip(sides) {
            plan.world.line(Layer::Emphasis, Role::Occluder, Subject::None, [*a, *b]);
            let side = (*b - *a).perp().normalize() * 9.0 * side * plan.unit;
            plan.plate((*a + *b) * 0.5 + side, NAME_PT, Font::Bold, name);
        }
    }
}

/// A tangent through an end of an occluder, from behind the box to far on the viewer's side.
pub(in crate::figure) fn draw_tangent(plan: &mut Plan, role: Role, tangent: &Tangent<Vec2>) {
    let (end, vertex) = (tangent.edge[0], tangent.vertex);
    let along = (end - vertex).normalize();
    let reach = plan.frame.diagonal();
    plan.line(role, vertex - along * (plan.unit * 16.0), end + along * reach);
    plan.dot(role, vertex, 1.8);
}

/// A view in space.
pub(in crate::figure) fn view(
    position: Vec3,
    target: Vec3,
    fov_degrees: f32,
    [width, height]: [u32; 2],
) -> View<Solid> {
    let eye = Eye { position, target, up: Vec3::Y, fov: fov_degrees.to_radians(), near: 0.05, far: 1000.0 };
    View { eye, width, height }
}

/// Sets a name into a picture of space.
pub(in crate::figure) fn name(world: &mut Drawing<Vec3>, at: Vec3, text: &str) {
    let mark =
        Mark::Text { at, text: text.into(), size_pt: NAME_PT, anchor: Anchor::Middle, font: Font::Bold };
    world.push(Layer::Labels, Role::Ink, Subject::None, mark);
}
