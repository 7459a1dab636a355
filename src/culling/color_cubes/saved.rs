//! The tree and its faces as bytes, so that they are made once: nodes, references, six faces a node, and
//! their errors if they were measured.

use super::faces::Baked;
use super::{Params, Primitives};
use crate::culling::saved::{self, Format, damaged};
use crate::geometry::{Space, Vector};
use crate::index::{CellTree, Items};
use crate::raster::CubeFaces;
use crate::scene::Scene;

const FORMAT: Format = Format { magic: b"cullscope-c3", method: "color-cubes", has_bytes: false };

/// What a tree was made for: levels at most, what a cube costs, whether it refers to objects, samples of a
/// face, whether inner faces are composed, whether errors are measured, how surfaces are taken, and whether
/// faces are worked out.
pub type Key = saved::Key<8>;
/// Which of these says whether errors are measured.
const MEASURED: usize = 5;

/// The key of a scene and parameters.
pub fn key<S: Space>(scene: &Scene<S>, params: &Params) -> Key {
    // Only what the tree depends on: the threshold is a matter of the frame.
    let surfaces = u32::from(params.surfaces.one_sided) | u32::from(params.surfaces.solid) << 1;
    let (composes, measures) = (params.composes().into(), params.measures().into());
    let is_analytic = params.is_analytic().into();
    let objects = u32::from(params.primitives == Primitives::Objects);
    let Params { tree_levels, face_samples, cube_cost, .. } = *params;
    let params =
        [tree_levels, cube_cost.to_bits(), objects, face_samples, composes, measures, surfaces, is_analytic];
    Key { scene: scene.hash_hex(), params }
}

fn describe(params: [u32; 8]) -> String {
    let [levels, cost, objects, samples, composed, measured, surfaces, analytic] = params;
    format!(
        "tree-levels={levels} cube-cost={} primitives={} faces={} face-samples={samples} interior={} \
         error-bound={} backface-culling={} see-through={}",
        f32::from_bits(cost),
        if objects == 1 { "objects" } else { "triangles" },
        if analytic == 1 { "analytic" } else { "sampled" },
        if composed == 1 { "composed" } else { "direct" },
        if measured == 1 { "above 0" } else { "0" },
        surfaces & 1 == 1,
        if surfaces & 2 == 2 { "solid" } else { "open" }
    )
}

/// Bytes of a tree with its faces.
pub fn write<V: Vector>(key: &Key, tree: &CellTree<V>, baked: &Baked) -> Vec<u8> {
    let [nodes, references] = tree.tables();
    let faces: Vec<u32> = baked.faces.iter().flat_map(|f| f.bytes().map(u32::from_le_bytes)).collect();
    let errors: Vec<u32> = baked.errors.iter().map(|e| e.to_bits()).collect();
    FORMAT.write(key, &[&nodes, &references, &faces, &errors], &[])
}

/// The tree of some bytes with its faces.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read<S: Space>(
    bytes: &[u8],
    key: &Key,
    scene: &Scene<S>,
    items: Items,
) -> Result<(CellTree<S::Vector>, Baked), String> {
    let ([nodes, references, faces, errors], _) = FORMAT.read::<8, 4>(bytes, key, describe)?;
    // A right sum says that nothing was damaged, and not that the numbers fit.
    let tree = CellTree::of_tables(scene, items, &nodes, references).ok_or_else(damaged)?;
    let (cubes, rest) = faces.as_chunks::<6>();
    let of = |words: &[u32; 6]| CubeFaces::of_bytes(words.map(u32::to_le_bytes));
    let cubes: Option<Vec<CubeFaces>> = cubes.iter().map(of).collect();
    let fits = |cubes: &Vec<CubeFaces>| rest.is_empty() && cubes.len() == tree.nodes().len();
    let cubes = cubes.filter(fits).ok_or_else(damaged)?;
    let errors: Vec<f32> = errors.into_iter().map(f32::from_bits).collect();
    let count = if key.params[MEASURED] == 1 { cubes.len() } else { 0 };
    if errors.len() != count || !errors.iter().all(|e| (0.0..=1.0).contains(e)) {
        return Err(damaged());
    }
    Ok((tree, Baked { faces: cubes, errors }))
}
