//! Cells and assignment as bytes, so that the preprocess is done once (Section 5.1): versioned, and checked
//! against scene and parameters.
//!
//! Little-endian: the magic with the version, SHA-256 of the scene in hex, the parameters that the cells
//! depend on, six tables with their lengths (the points or the region, the cells, four of the assignment),
//! and SHA-256 of all that.

use sha2::{Digest, Sha256};

use super::cells::Cells;
use super::{CellKind, Params};
use crate::geometry::{Aabb, Vector};
use crate::index::tessellation::{Assignment, BoxCells, Cellular, Simplex, SimplexCells};
use crate::method::Words;
use crate::scene::Scene;

/// First bytes of a file; the last one is the version.
const MAGIC: &[u8; 12] = b"cullscope-p1";
/// Bytes of the checksum at the end.
const CHECKSUM: usize = 32;
/// Tables in a file.
const TABLES: usize = 6;

/// What cells were made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    scene: String,
    /// Tessellation, leaf size, seed.
    params: [u32; 3],
}

impl Key {
    pub fn of<S: Cellular>(scene: &Scene<S>, params: &Params) -> Self {
        // Only what cells and assignment depend on: budgets and penalties are a matter of the frame.
        // Only one of the tessellations depends on the seed.
        let seed = if params.tessellation == CellKind::Delaunay { params.seed } else { 0 };
        let tessellation = params.tessellation.number() as u32;
        Self { scene: scene.hash_hex(), params: [tessellation, params.leaf_size, seed] }
    }
    fn describe(params: [u32; 3]) -> String {
        // The numbers come out of a file, so the first of them may stand for no tessellation.
        let [tessellation, leaf_size, seed] = params;
        format!(
            "tessellation={} leaf-size={leaf_size} seed={seed}",
            CellKind::WORDS.get(tessellation as usize).unwrap_or(&"?")
        )
    }
}

/// Bytes of cells and assignment.
pub fn write<S: Cellular>(key: &Key, cells: &Cells<S>, assignment: &Assignment) -> Vec<u8> {
    let axes = |p: &S::Vector| (0..S::Vector::AXES).map(|a| p.get(a).to_bits()).collect::<Vec<_>>();
    let (points, cells) = match cells {
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
    // Everything is a row of 32-bit words: reals by their bits, so that nothing is rounded.
    let tables: [Vec<u32>; TABLES] = [points, cells, own, own_starts, shared, shared_starts];
    let mut bytes = MAGIC.to_vec();
    bytes.extend(key.scene.as_bytes());
    let lengths = tables.iter().map(|t| t.len() as u32);
    let numbers = key.params.into_iter().chain(lengths).chain(tables.iter().flatten().copied());
    numbers.for_each(|n| bytes.extend(n.to_le_bytes()));
    let sum = Sha256::digest(&bytes);
    bytes.extend(sum);
    bytes
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
    let damaged = || "the file is damaged".to_owned();
    let (body, sum) = bytes.split_last_chunk::<CHECKSUM>().ok_or_else(damaged)?;
    let (magic, rest) = body.split_first_chunk::<12>().ok_or_else(damaged)?;
    // The version first, so that an older file is not called damaged; then the sum, so that what follows may
    // trust every length.
    if magic != MAGIC {
        return Err("it is no preprocess of layered-projection that this version reads".into());
    }
    if Sha256::digest(body).as_slice() != sum {
        return Err(damaged());
    }
    let (made_for, rest) = rest.split_at_checked(key.scene.len()).ok_or_else(damaged)?;
    if made_for != key.scene.as_bytes() {
        return Err("it was made for another scene".into());
    }
    let (words, []) = rest.as_chunks::<4>() else { return Err(damaged()) };
    let words: Vec<u32> = words.iter().map(|w| u32::from_le_bytes(*w)).collect();
    let (params, words) = words.split_first_chunk::<3>().ok_or_else(damaged)?;
    if *params != key.params {
        return Err(format!("it was made with {}", Key::describe(*params)));
    }
    let (lengths, mut words) = words.split_first_chunk::<TABLES>().ok_or_else(damaged)?;
    let mut tables: [Vec<u32>; TABLES] = Default::default();
    // Table by table, so that no length reaches past the words that there are.
    for (table, length) in tables.iter_mut().zip(lengths) {
        let (here, rest) = words.split_at_checked(*length as usize).ok_or_else(damaged)?;
        (*table, words) = (here.to_vec(), rest);
    }
    if !words.is_empty() {
        return Err(damaged());
    }
    // A file with a right sum may still be forged: both check that every number in it has a place.
    let [points, cells, own, own_starts, shared, shared_starts] = tables;
    let cells = cells_of(params[0], &points, &cells).ok_or_else(damaged)?;
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
