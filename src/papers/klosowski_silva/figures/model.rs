//! Figure 3 in space: a car with an engine, the octree over its vertices, and the tetrahedra between the
//! centers of its leaves, all cut open along the middle of the car, since a whole tessellation would hide
//! itself.

use glam::Vec3;

use super::room::cut;
use crate::drawing::{Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, Tint, entry, view};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{CellId, PrimId, Solid, View};
use crate::index::tessellation::{BoxCells, Fineness, SimplexCells, Tessellation, vertex_octree};
use crate::raster::{render, shade};
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, load};

/// The side of the least leaves, as a share of the car's length.
const LEAF_SHARE: f32 = 0.1;
const SEED: u32 = 1;

/// The first of the generated cars.
fn car() -> Result<Scene<Solid>, SceneError> {
    let AnyScene::Solid(cars) = load("generate:cars?polygons=100000", &LoadOptions::default(), &Quiet)?
    else {
        unreachable!("cars are in space")
    };
    let mut parts = (*cars).clone().into_parts();
    for (prim, object) in parts.prims.iter_mut().zip(&parts.prim_object) {
        if parts.objects[object.at()].group != "car_0" {
            *prim = None;
        }
    }
    Scene::new(parts)
}

/// The car without its near half, as the observer sees it, with lines and dots over it.
fn panel(
    tint: Tint,
    car: &Scene<Solid>,
    observer: &View<Solid>,
    world: Drawing<Vec3>,
    label: String,
) -> Panel {
    let middle = car.bounds().center().z;
    let far: Vec<PrimId> =
        car.live().iter().copied().filter(|&p| car.prim_bounds(p).center().z < middle).collect();
    let rgba = shade(&render(car, observer, &far), car, observer, tint(Role::Paper));
    let pixels = Pixels { width: observer.width, height: observer.height, rgba: rgba.into() };
    Panel { label, picture: Picture::Over(pixels, world, *observer) }
}

/// The cells where the middle of the car cuts them.
fn cells(car: &Scene<Solid>, cells: &dyn Tessellation<Solid>) -> Drawing<Vec3> {
    let mut world = Drawing::default();
    for cell in (0..cells.count() as u32).map(CellId) {
        let points = cut(&cells.edges(cell), Vec3::Z, car.bounds().center().z);
        if points.len() > 2 {
            world.outline(Layer::Nodes, Role::Visible, Subject::None, points);
        }
    }
    world
}

/// The octree over the car's vertices, and the tetrahedra between the centers of its leaves.
fn divided(car: &Scene<Solid>) -> (BoxCells<Vec3>, SimplexCells<Solid>) {
    let never = || false;
    let cancelled = || -> ! { unreachable!("nobody cancels a figure") };
    let boxes = vertex_octree(car, Fineness { leaf_share: LEAF_SHARE, ..Fineness::default() }, never)
        .unwrap_or_else(|| cancelled());
    let simplices = SimplexCells::<Solid>::of_centers(&boxes, SEED, &never).unwrap_or_else(|| cancelled());
    (boxes, simplices)
}

/// The car, and over it the cells and the centers of leaves.
fn four_panels(
    tint: Tint,
    car: &Scene<Solid>,
    observer: &View<Solid>,
    boxes: &BoxCells<Vec3>,
    simplices: &SimplexCells<Solid>,
) -> Drawing {
    let octree = cells(car, boxes);
    let triangulation = cells(car, simplices);
    let mut centers = Drawing::default();
    let least = boxes.region().size().x * LEAF_SHARE;
    // After the corners of the region: centers near the cut.
    for &at in
        simplices.tables().0[8..].iter().filter(|p| (p.z - car.bounds().center().z).abs() < least * 0.5)
    {
        centers.push(Layer::Emphasis, Role::Ink, Subject::None, Mark::Dot { at, radius_pt: 1.6 });
    }
    let (leaves, tetrahedra) = (Tessellation::<Solid>::count(boxes), simplices.count());
    panels(
        TWO_COLUMNS_PT,
        2,
        &[
            panel(
                tint,
                car,
                observer,
                Drawing::default(),
                format!("(a) a car of {} triangles", car.live().len()),
            ),
            panel(tint, car, observer, octree, format!("(b) octree: {leaves} leaves")),
            panel(tint, car, observer, centers, "(c) centers of leaves, near the cut".into()),
            panel(tint, car, observer, triangulation, format!("(d) {tetrahedra} tetrahedra")),
        ],
    )
}

/// Figure 3 in space.
pub fn tessellation(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let tint = maker.tint;
    let car = car()?;
    let (boxes, simplices) = divided(&car);
    let bounds = car.bounds();
    // So far away that the picture is almost a plan.
    let observer = view(bounds.center() + Vec3::Z * 60.0, bounds.center(), 2.5, [480, 264]);

    let content = four_panels(tint, &car, &observer, &boxes, &simplices);
    let legend = vec![
        entry(Role::Visible, Swatch::Line, "cells where they are cut"),
        entry(Role::Ink, Swatch::Dot, "center of a leaf, moved at random"),
    ];
    let caption = "A car with an engine, cut open along its middle; the near half is left out. An octree is \
                   built over the vertices, down to leaves shorter than 10 % of the car's length (the paper: \
                   5 %); large leaves are empty. Either its leaves are the cells (b), or the centers of the \
                   leaves, moved at random (c), are the vertices of a Delaunay triangulation, whose \
                   tetrahedra are the cells (d): small ones in the body, large ones around it. Tetrahedra \
                   are cut in triangles and quadrangles. Scene generate:cars, one car.";
    Ok(maker.page(Paper::TwoColumns, "An occupancy-based tessellation of space", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_and_the_corners_of_the_region_are_the_vertices() {
        let (boxes, simplices) = divided(&car().expect("a scene"));
        let (leaves, vertices) = (Tessellation::<Solid>::count(&boxes), simplices.tables().0.len());
        assert_eq!(vertices, leaves + 8);
        // Between points in space are about 6.7 tetrahedra a point, fewer at the hull.
        let each = simplices.count() as f32 / vertices as f32;
        assert!((5.0..7.0).contains(&each), "{each}");
    }
}
