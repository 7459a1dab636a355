//! Figures 3 and 9 in flatland: how space is divided, and who is whose neighbor.

use std::sync::Arc;

use glam::{Vec2, vec2};

use crate::drawing::{Drawing, Font, Layer, Mark, Role, Subject};
use crate::figure::tools::{LABEL_PT, Maker, Plan, TWO_COLUMNS_PT, entry};
use crate::figure::{Panel, Paper, Swatch, panels};
use crate::geometry::{Aabb, CellId, Flat};
use crate::index::tessellation::{BoxCells, Fineness, SimplexCells, Tessellation, vertex_octree};
use crate::scene::{Scene, SceneError, example};

/// The side of the least cells, as a share of the scene's longest side.
const LEAF_SHARE: f32 = 0.1;
const SEED: u32 = 1;

fn quadtree(scene: &Scene<Flat>, leaf_share: f32) -> BoxCells<Vec2> {
    let never = || false;
    vertex_octree(scene, Fineness { leaf_share, ..Fineness::default() }, never)
        .unwrap_or_else(|| unreachable!("nobody cancels a figure"))
}

fn all<T: Tessellation<Flat>>(cells: &T) -> impl Iterator<Item = CellId> + use<T> {
    (0..cells.count() as u32).map(CellId)
}

fn segments(scene: &Scene<Flat>, role: Role, plan: &mut Plan) {
    for &prim in scene.live() {
        plan.world.line(Layer::Scene, role, Subject::Prim(prim), scene.prim_points(prim).collect::<Vec<_>>());
    }
}

/// The tessellations of Figure 3.
struct Divided {
    scene: Arc<Scene<Flat>>,
    boxes: BoxCells<Vec2>,
    simplices: SimplexCells<Flat>,
}

impl Divided {
    fn new() -> Result<Self, SceneError> {
        let scene = example("bottleneck")?;
        let boxes = quadtree(&scene, LEAF_SHARE);
        let simplices = SimplexCells::<Flat>::of_centers(&boxes, SEED, &|| false)
            .unwrap_or_else(|| unreachable!("nobody cancels a figure"));
        Ok(Self { scene, boxes, simplices })
    }
    /// A plan of the region with the scene's segments.
    fn plan(&self, role: Role) -> Plan {
        let region = self.boxes.region();
        let air = Vec2::splat(region.size().x * 0.01);
        let frame = Aabb { min: region.min - air, max: region.max + air };
        let mut plan = Plan::new(frame, (TWO_COLUMNS_PT - 20.0) / 3.0);
        segments(&self.scene, role, &mut plan);
        plan
    }
    fn tree(&self) -> Plan {
        let mut plan = self.plan(Role::Scene);
        for cell in all(&self.boxes) {
            let bounds = Tessellation::<Flat>::bounds(&self.boxes, cell);
            plan.world.bounds(Layer::Nodes, Role::Visible, Subject::None, &bounds);
        }
        plan
    }
    fn triangles(&self) -> Plan {
        let mut plan = self.plan(Role::Scene);
        for cell in all(&self.simplices) {
            let edges = Tessellation::<Flat>::edges(&self.simplices, cell);
            let corners: Vec<Vec2> = edges.iter().map(|e| e[0]).collect();
            plan.world.outline(Layer::Nodes, Role::Visible, Subject::None, corners);
        }
        // After the corners of the region.
        for &at in &self.simplices.tables().0[4..] {
            plan.world.push(Layer::Emphasis, Role::Ink, Subject::None, Mark::Dot { at, radius_pt: 1.7 });
        }
        plan
    }
}

/// Figure 3.
pub fn tessellation(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let divided = Divided::new()?;
    let (input, tree, triangles) = (divided.plan(Role::Ink), divided.tree(), divided.triangles());
    let Divided { scene, boxes, simplices } = divided;
    let leaves = Tessellation::<Flat>::count(&boxes);
    let content = panels(
        TWO_COLUMNS_PT,
        3,
        &[
            input.panel(format!("(a) {} segments", scene.live().len())),
            tree.panel(format!("(b) quadtree: {leaves} leaves")),
            triangles.panel(format!("(c) {} triangles", simplices.count())),
        ],
    );
    let legend = vec![
        entry(Role::Ink, Swatch::Line, "segment"),
        entry(Role::Visible, Swatch::Line, "cells: leaves of the quadtree (b), Delaunay triangles (c)"),
        entry(Role::Ink, Swatch::Dot, "center of a leaf, moved at random"),
    ];
    let caption = "How space is divided into cells, small where much is: a quadtree (in space an octree) is \
                   built over the end points of the segments, down to leaves shorter than 10 % of the \
                   longest side (the paper: 5 %). Either its leaves are the cells (b), or the triangles of \
                   the Delaunay triangulation of their centers (c), which are moved at random first, as they \
                   lie on a lattice. The corners of the region are vertices too. Scene bottleneck.";
    Ok(maker.page(Paper::TwoColumns, "An occupancy-based tessellation", legend, caption, &content))
}

/// Figure 9 looks at a leaf with smaller neighbors on one side, and at one of those.
struct Family {
    boxes: BoxCells<Vec2>,
    a: CellId,
    i: CellId,
}

/// A leaf whose neighbors in one direction are smaller, two at least, and lie well inside the region.
fn family(scene: &Scene<Flat>) -> Option<Family> {
    let boxes = quadtree(scene, 0.1);
    let side = |c: CellId| Tessellation::<Flat>::bounds(&boxes, c).size().x;
    let to_the_right = |c: CellId| {
        Tessellation::<Flat>::neighbors(&boxes, c)
            .iter()
            .filter(|n| n.normal.x > 0.5)
            .map(|n| n.cell)
            .collect::<Vec<_>>()
    };
    let a = all(&boxes).filter(|&c| {
        let right = to_the_right(c);
        right.len() == 2 && right.iter().all(|&n| side(n) < side(c))
    });
    // The one with most neighbors in all; the first of equals.
    let a = a.max_by_key(|&c| (Tessellation::<Flat>::neighbors(&boxes, c).len(), std::cmp::Reverse(c)))?;
    let i = to_the_right(a)[0];
    Some(Family { a, i, boxes })
}

/// A cell, its neighbors, and an arrow to each through the side that they share.
fn neighborhood(scene: &Scene<Flat>, family: &Family, cell: CellId, frame: Aabb<Vec2>, label: &str) -> Panel {
    let boxes = &family.boxes;
    let bounds = |c: CellId| Tessellation::<Flat>::bounds(boxes, c);
    let corners = |c: CellId| [0, 1, 3, 2].map(|k| bounds(c).corner(k)).to_vec();
    let mut plan = Plan::new(frame, (TWO_COLUMNS_PT - 10.0) / 2.0);
    segments(scene, Role::Faint, &mut plan);
    for c in all(boxes) {
        plan.world.outline(Layer::Nodes, Role::Scene, Subject::None, corners(c));
    }
    let neighbors = Tessellation::<Flat>::neighbors(boxes, cell);
    plan.world.push(Layer::Areas, Role::Current, Subject::None, Mark::Area(corners(cell)));
    for neighbor in neighbors {
        plan.world.push(Layer::Areas, Role::Visible, Subject::None, Mark::Area(corners(neighbor.cell)));
        // The middle of what both sides have in common.
        let (x, y) = (bounds(cell), bounds(neighbor.cell));
        let through = (x.min.max(y.min) + x.max.min(y.max)) * 0.5;
        let reach = neighbor.normal * bounds(family.i).size().x * 0.34;
        plan.world.push(
            Layer::Evidence,
            Role::Evidence,
            Subject::None,
            Mark::Arrow(through - reach, through + reach),
        );
    }
    let mut names = vec![(family.a, 'A')];
    let right =
        Tessellation::<Flat>::neighbors(boxes, family.a).iter().filter(|n| n.normal.x > 0.5).map(|n| n.cell);
    names.extend(right.zip('I'..));
    for (c, name) in names {
        let at = bounds(c).center();
        plan.plate(at, LABEL_PT + 1.0, Font::Bold, &name.to_string());
    }
    plan.panel(label.to_owned())
}

/// Figure 9.
pub fn neighbors(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("bottleneck")?;
    let family = family(&scene).unwrap_or_else(|| unreachable!("the scene has such leaves; a test says so"));
    let (boxes, side) = (&family.boxes, Tessellation::<Flat>::bounds(&family.boxes, family.a).size().x);
    let center = Tessellation::<Flat>::bounds(boxes, family.a).center() + vec2(side * 0.4, 0.0);
    let half = vec2(side * 1.5, side * 1.15);
    let frame = Aabb { min: center - half, max: center + half };
    let counts = [family.a, family.i].map(|c| Tessellation::<Flat>::neighbors(boxes, c).len());
    let content = panels(
        TWO_COLUMNS_PT,
        2,
        &[
            neighborhood(
                &scene,
                &family,
                family.a,
                frame,
                &format!("A has {} neighbors, among them I and J", counts[0]),
            ),
            neighborhood(
                &scene,
                &family,
                family.i,
                frame,
                &format!("I has {} neighbors, among them A", counts[1]),
            ),
        ],
    );
    let legend = vec![
        entry(Role::Current, Swatch::Area, "a leaf"),
        entry(Role::Visible, Swatch::Area, "its neighbors"),
        entry(Role::Evidence, Swatch::Line, "normal of the shared side"),
        entry(Role::Faint, Swatch::Line, "segments of the scene"),
    ];
    let caption = "Leaves of a quadtree are neighbors where they share a side or a part of one, whatever \
                   their levels; corners do not count. Going up to the common ancestor and down again finds \
                   neighbors of the same size or larger only: from I to A, but not from A to I and J. Here \
                   both sides of every dividing line are descended together, which gives all pairs, each in \
                   both directions. Scene bottleneck, leaf-size 10 %.";
    Ok(maker.page(Paper::TwoColumns, "Neighbors across levels", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangles_are_as_many_as_their_vertices_allow() {
        let Divided { boxes, simplices, .. } = Divided::new().expect("a scene");
        let leaves = Tessellation::<Flat>::count(&boxes);
        let vertices = simplices.tables().0.len();
        assert_eq!(vertices, leaves + 4, "the centers of the leaves and the corners of the region");
        // Euler: n points, of which h are on the hull, have 2n − 2 − h triangles; the hull is the region.
        assert_eq!(simplices.count(), 2 * vertices - 2 - 4);
    }

    #[test]
    fn neighbors_know_each_other_across_levels() {
        let scene = example("bottleneck").expect("a scene");
        let family = family(&scene).expect("such leaves");
        let of = |c: CellId| {
            Tessellation::<Flat>::neighbors(&family.boxes, c).iter().map(|n| n.cell).collect::<Vec<_>>()
        };
        assert!(of(family.a).contains(&family.i) && of(family.i).contains(&family.a));
        let size = |c: CellId| Tessellation::<Flat>::bounds(&family.boxes, c).size().x;
        assert!((size(family.a) / size(family.i) - 2.0).abs() < 1e-4, "a level apart");
    }
}
