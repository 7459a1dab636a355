//! Cells and assignment as bytes, so that the preprocess is done once (Section 5.1).
//!
//! The parameters are those that the cells depend on; the tables are the points or the region, the cells, and
//! four of the assignment.

use super::cells::Cells;
use super::{CellKind, Params};
use crate::culling::saved::{self, Format, damaged};
use crate::geometry::{Aabb, Vector};
use crate::index::tessellation::{Assignment, BoxCells, Cellular, Simplex, SimplexCells};
use crate::method::Words;
use crate::scene::Scene;

const FORMAT: Format = Format { magic: b"cullscope-p1", method: "layered-projection", has_bytes: false };
/// Tables in a file.
const TABLES: usize = 6;

/// What cells were made for: tessellation, leaf size, seed.
pub type Key = saved::Key<3>;

pub fn key<S: Cellular>(scene: &Scene<S>, params: &Params) -> Key {
    // Only what cells and assignment depend on: budgets and penalties are a matter of the frame. Only one of
    // the tessellations depends on the seed.
    let seed = if params.tessellation == CellKind::Delaunay { params.seed } else { 0 };
    let tessellation = params.tessellation.number() as u32;
    Key { scene: scene.hash_hex(), params: [tessellation, params.leaf_size, seed] }
}

fn describe([tessellation, leaf_size, seed]: [u32; 3]) -> String {
    // The numbers come out of a file, so the first of them may stand for no tessellation.
    format!(
        "tessellation={} leaf-size={leaf_size} seed={seed}",
        CellKind::WORDS.get(tessellation as usize).unwrap_or(&"?")
    )
}

/// Bytes of cells and assignment.
pub fn write<S: Cellular>(key: &Key, cells: &Cells<S>, assignment: &Assignment) -> Vec<u8> {
    let axes = |p: &S::Vector| (0..S::Vector::AXES).map(|a| p.get(a).to_bits()).collect::<Vec<_>>();
    let (points, cells): (Vec<u32>, Vec<u32>) = match cells {
        Cells::Boxes(boxes) => {
            let (region, nodes) = boxes.tables();
            let nodes = nodes.into_iter().flat_map(|(axis, split)| [axis, split.to_bits()]).collect();
            ([region.min, region.max].iter().flat_map(axes).collect(), nodes)
        }
        Cells::Simplices(simplices) => {
            let (points, cells) = simplices.tables();
            (
                points.iter().flat_map(axes).collect(),
                cells.iter().flat_map(|c| [c.vertices, c.neighbors].concat()).collect::<Vec<_>>(),
            )
        }
    };
    let [own, own_starts, shared, shared_starts] = assignment.tables();
    FORMAT.write(key, &[&points, &cells, &own, &own_starts, &shared, &shared_starts], &[])
}

/// The cells and the assignment of some bytes.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read<S: Cellular>(
    bytes: &[u8],
    key: &Key,
    scene: &Scene<S>,
) -> Result<(Cells<S>, Assignment), String> {
    let (tables, _) = FORMAT.read::<3, TABLES>(bytes, key, describe)?;
    // A file with a right sum may still be forged: both check that every number in it has a place.
    let [points, cells, own, own_starts, shared, shared_starts] = tables;
    let cells = cells_of(key.params[0], &points, &cells).ok_or_else(damaged)?;
    let assignment =
        Assignment::of_tables([own, own_starts, shared, shared_starts], cells.any().count(), scene)
            .ok_or_else(damaged)?;
    Ok((cells, assignment))
}

fn cells_of<S: Cellular>(tessellation: u32, points: &[u32], cells: &[u32]) -> Option<Cells<S>> {
    let point = |p: &[u32]| S::Vector::from_fn(|a| f32::from_bits(p[a]));
    let points: Vec<S::Vector> = points.chunks_exact(S::Vector::AXES).map(point).collect();
    if CellKind::ALL.get(tessellation as usize) == Some(&CellKind::Delaunay) {
        // Four corners and four neighbors, in flatland too, where the last of each is not used.
        let (rows, []) = cells.as_chunks::<8>() else { return None };
        let simplex = |[a, b, c, d, e, f, g, h]: &[u32; 8]| Simplex {
            vertices: [*a, *b, *c, *d],
            neighbors: [*e, *f, *g, *h],
        };
        return SimplexCells::of_tables(points, rows.iter().map(simplex).collect()).map(Cells::Simplices);
    }
    // Boxes come out of a tree, so its region and splits say all of them.
    let (&[min, max], (rows, [])) = (&points[..], cells.as_chunks::<2>()) else { return None };
    let nodes: Vec<(u32, f32)> = rows.iter().map(|[axis, split]| (*axis, f32::from_bits(*split))).collect();
    BoxCells::of_tables(Aabb { min, max }, &nodes).map(Cells::Boxes)
}
