//! The lists of a grid as bytes, so that the preprocess is done once: where they begin, their leaves, and the
//! angles of these.

use super::Params;
use super::grid::Grid;
use super::leaves::Leaves;
use crate::culling::saved::{self, Format, damaged};
use crate::geometry::{NodeId, Space, Vector};
use crate::scene::Scene;

const FORMAT: Format = Format { magic: b"cullscope-z1", method: "occlusion-maps", has_bytes: false };

/// What lists were made for: points along the longest side, primitives of a leaf, what is too small for the
/// occluder database, and how surfaces are taken.
pub type Key = saved::Key<4>;

/// The key of a scene and parameters.
pub fn key<S: Space>(scene: &Scene<S>, params: &Params) -> Key {
    // Only what lists depend on: all else is a matter of the frame.
    let surfaces = u32::from(params.surfaces.one_sided) | u32::from(params.surfaces.solid) << 1;
    let params = [params.grid, params.leaf_prims::<S>(), params.occluder_size, surfaces];
    Key { scene: scene.hash_hex(), params }
}

fn describe([grid, leaf, size, surfaces]: [u32; 4]) -> String {
    format!(
        "grid={grid} leaf-primitives={leaf} occluder-size={size} backface-culling={} see-through={}",
        surfaces & 1 == 1,
        if surfaces & 2 == 2 { "solid" } else { "open" }
    )
}

/// Bytes of a grid's lists.
pub fn write<V: Vector>(key: &Key, grid: &Grid<V>) -> Vec<u8> {
    let (starts, leaves, angles) = grid.tables();
    let leaves: Vec<u32> = leaves.iter().map(|leaf| leaf.0).collect();
    let angles: Vec<u32> = angles.iter().map(|angle| angle.to_bits()).collect();
    FORMAT.write(key, &[starts, &leaves, &angles], &[])
}

/// The grid with the lists of some bytes.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read<S: Space>(
    bytes: &[u8],
    key: &Key,
    grid: Grid<S::Vector>,
    leaves: &Leaves<'_, S>,
) -> Result<Grid<S::Vector>, String> {
    let ([starts, listed, angles], _) = FORMAT.read::<4, 3>(bytes, key, describe)?;
    // A right sum says that nothing was damaged, and not that the numbers fit: each leaf must be one of the
    // occluder database, and each angle a number to sort by.
    let angles: Vec<f32> = angles.into_iter().map(f32::from_bits).collect();
    let listed: Vec<NodeId> = listed.into_iter().map(NodeId).collect();
    if !listed.iter().all(|&leaf| leaves.is_one(leaf)) || !angles.iter().all(|a| a.is_finite() && *a >= 0.0) {
        return Err(damaged());
    }
    grid.with(starts, listed, angles).ok_or_else(damaged)
}
