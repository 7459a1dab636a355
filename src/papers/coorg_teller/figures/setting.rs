//! What the flatland figures of this folder have in common: a setting of occluders and a box.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use super::regions::{Border, area, middle};
use crate::culling::anatomy::{Blockers, Tangent};
use crate::drawing::{Font, Layer, Role, Subject};
use crate::figure::tools::{NAME_PT, Plan};
use crate::geometry::{Aabb, Flat, PrimId};
use crate::scene::{Scene, SceneError, example};

/// The middle of the largest of some cells.
pub(super) fn largest<'a>(cells: impl Iterator<Item = &'a Vec<DVec2>>) -> Option<Vec2> {
    cells.max_by(|a, b| area(a).total_cmp(&area(b))).map(|c| middle(c).as_vec2())
}

/// The occluders A, B, … and the box T of a flatland scene.
pub(super) struct Setting {
    pub(super) scene: Arc<Scene<Flat>>,
    pub(super) blockers: Blockers<Flat>,
    /// Name and ends of each occluder.
    pub(super) occluders: Vec<(String, [Vec2; 2])>,
    pub(super) target: Aabb<Vec2>,
}

impl Setting {
    pub(super) fn of(scene: &str) -> Result<Self, SceneError> {
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
    pub(super) fn eye(&self, number: usize) -> Vec2 {
        self.scene.paths()[0].views[number].eye.position
    }
    /// The tangents through each end of an occluder: supporting, separating.
    pub(super) fn tangents(&self, id: usize) -> Vec<[Tangent<Vec2>; 2]> {
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
    pub(super) fn draw(&self, plan: &mut Plan, sides: &[f32]) {
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
pub(super) fn draw_tangent(plan: &mut Plan, role: Role, tangent: &Tangent<Vec2>) {
    let (end, vertex) = (tangent.edge[0], tangent.vertex);
    let along = (end - vertex).normalize();
    let reach = plan.frame.diagonal();
    plan.line(role, vertex - along * (plan.unit * 16.0), end + along * reach);
    plan.dot(role, vertex, 1.8);
}
