//! The tree and its faces as bytes, so that they are made once: nodes, references, and six faces a node.

use super::Params;
use crate::culling::saved::{self, Format, damaged};
use crate::geometry::{Space, Vector};
use crate::index::CellTree;
use crate::raster::CubeFaces;
use crate::scene::Scene;

const FORMAT: Format = Format { magic: b"cullscope-c1", method: "color-cubes", has_bytes: false };

/// What a tree was made for: levels at most, samples of a face, whether inner faces are composed, and how
/// surfaces are taken.
pub type Key = saved::Key<4>;

/// The key of a scene and parameters.
pub fn key<S: Space>(scene: &Scene<S>, params: &Params) -> Key {
    // Only what the tree depends on: the threshold is a matter of the frame.
    let surfaces = u32::from(params.surfaces.one_sided) | u32::from(params.surfaces.solid) << 1;
    let params = [params.tree_levels, params.face_samples, params.composes().into(), surfaces];
    Key { scene: scene.hash_hex(), params }
}

fn describe([levels, samples, composed, surfaces]: [u32; 4]) -> String {
    format!(
        "tree-levels={levels} face-samples={samples} interior={} backface-culling={} see-through={}",
        if composed == 1 { "composed" } else { "direct" },
        surfaces & 1 == 1,
        if surfaces & 2 == 2 { "solid" } else { "clear" }
    )
}

/// Bytes of a tree with its faces.
pub fn write<V: Vector>(key: &Key, tree: &CellTree<V>, faces: &[CubeFaces]) -> Vec<u8> {
    let [nodes, references] = tree.tables();
    let faces: Vec<u32> = faces.iter().flat_map(|f| f.bytes().map(u32::from_le_bytes)).collect();
    FORMAT.write(key, &[&nodes, &references, &faces], &[])
}

/// The tree of some bytes with its faces.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read<S: Space>(
    bytes: &[u8],
    key: &Key,
    scene: &Scene<S>,
) -> Result<(CellTree<S::Vector>, Vec<CubeFaces>), String> {
    let ([nodes, references, faces], _) = FORMAT.read::<4, 3>(bytes, key, describe)?;
    // A right sum says that nothing was damaged, and not that the numbers fit.
    let tree = CellTree::of_tables(scene, &nodes, references).ok_or_else(damaged)?;
    let (cubes, rest) = faces.as_chunks::<6>();
    let of = |words: &[u32; 6]| CubeFaces::of_bytes(words.map(u32::to_le_bytes));
    let cubes: Option<Vec<CubeFaces>> = cubes.iter().map(of).collect();
    let fits = |cubes: &Vec<CubeFaces>| rest.is_empty() && cubes.len() == tree.nodes().len();
    let cubes = cubes.filter(fits).ok_or_else(damaged)?;
    Ok((tree, cubes))
}
