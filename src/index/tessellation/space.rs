//! What cells need of a space: contact with primitives, and the Delaunay triangulation of points.

use glam::{Vec2, Vec3};
use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::simplices::{NONE, Simplex};
use crate::geometry::{self, Aabb, Beside, Flat, Solid, Space};
use crate::index::{Delaunay, octant_of};

/// A space that can be divided into cells.
pub trait Cellular: Space {
    /// Whether a primitive meets a box.
    fn meets_box(prim: &[Self::Vector], bounds: &Aabb<Self::Vector>) -> bool;
    /// Which octants (quadrants) of a box a primitive meets, of those whose boxes its own touches, a bit
    /// each.
    fn meets_octants(prim: &[Self::Vector], cell: &Aabb<Self::Vector>, asked: u8) -> u8 {
        let is_met = |o: &usize| asked >> o & 1 == 1 && Self::meets_box(prim, &octant_of(cell, *o));
        (0..8).filter(is_met).fold(0, |bits, octant| bits | 1 << octant)
    }
    /// Whether a primitive meets a simplex, of which the first `AXES + 1` corners count.
    fn meets_simplex(prim: &[Self::Vector], simplex: &[Self::Vector; 4]) -> bool;
    /// Where a point lies in regard to a primitive.
    fn beside(prim: &[Self::Vector], point: Self::Vector) -> Beside;
    /// The Delaunay triangulation of finite points; no simplex if they do not span the space. `None` when
    /// cancelled.
    fn triangulate(points: &[Self::Vector], cancelled: &dyn Fn() -> bool) -> Option<Vec<Simplex>>;
}

impl Cellular for Flat {
    #[inline]
    fn meets_box(prim: &[Vec2], bounds: &Aabb<Vec2>) -> bool {
        geometry::segment_meets_box([prim[0], prim[1]], bounds)
    }
    #[inline]
    fn meets_simplex(prim: &[Vec2], [a, b, c, _]: &[Vec2; 4]) -> bool {
        geometry::segment_meets_triangle([prim[0], prim[1]], [*a, *b, *c])
    }
    #[inline]
    fn beside(prim: &[Vec2], point: Vec2) -> Beside {
        geometry::beside_segment([prim[0], prim[1]], point)
    }
    fn triangulate(points: &[Vec2], _: &dyn Fn() -> bool) -> Option<Vec<Simplex>> {
        // The crate refuses numbers whose squares vanish; they are as good as 0 beside any cell that has an
        // area.
        let flushed = |v: f32| if v.abs() < f32::MIN_POSITIVE { 0.0 } else { f64::from(v) };
        let list = points.iter().map(|p| Point2::new(flushed(p.x), flushed(p.y))).collect();
        // It can refuse nothing else: all points are finite.
        let Ok(made) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(list) else {
            return Some(Vec::new());
        };
        let mut numbers = vec![NONE; made.num_all_faces()];
        made.inner_faces().enumerate().for_each(|(number, face)| numbers[face.fix().index()] = number as u32);
        let simplex = |edges: [spade::handles::DirectedEdgeHandle<'_, Point2<f64>, (), (), ()>; 3]| {
            let (mut vertices, mut neighbors) = ([NONE; 4], [NONE; 4]);
            for i in 0..3 {
                // Edges run counter-clockwise; the next but one starts at the vertex opposite.
                vertices[i] = edges[i].from().fix().index() as u32;
                neighbors[(i + 2) % 3] =
                    edges[i].rev().face().as_inner().map_or(NONE, |f| numbers[f.fix().index()]);
            }
            Simplex { vertices, neighbors }
        };
        Some(made.inner_faces().map(|face| simplex(face.adjacent_edges())).collect())
    }
}

impl Cellular for Solid {
    fn meets_octants(prim: &[Vec3], cell: &Aabb<Vec3>, asked: u8) -> u8 {
        geometry::triangle_meets_octants([prim[0], prim[1], prim[2]], cell, asked)
    }
    #[inline]
    fn meets_box(prim: &[Vec3], bounds: &Aabb<Vec3>) -> bool {
        geometry::triangle_meets_box([prim[0], prim[1], prim[2]], bounds)
    }
    #[inline]
    fn meets_simplex(prim: &[Vec3], simplex: &[Vec3; 4]) -> bool {
        geometry::triangle_meets_tetrahedron([prim[0], prim[1], prim[2]], *simplex)
    }
    #[inline]
    fn beside(prim: &[Vec3], point: Vec3) -> Beside {
        geometry::beside_triangle([prim[0], prim[1], prim[2]], point)
    }
    fn triangulate(points: &[Vec3], cancelled: &dyn Fn() -> bool) -> Option<Vec<Simplex>> {
        let made = Delaunay::new(points.to_vec(), cancelled)?;
        let simplex = |t: &crate::index::Tetrahedron| Simplex {
            vertices: t.vertices,
            neighbors: [0, 1, 2, 3].map(|i| t.neighbor(i).unwrap_or(NONE)),
        };
        Some(made.tetrahedra().iter().map(simplex).collect())
    }
}
