//! The selection as bytes, so that the preprocess is done once: versioned, and checked against scene and
//! parameters.
//!
//! Little-endian: the magic with the version, SHA-256 of the scene in hex, the parameters that the selection
//! depends on, four lengths, three tables of numbers, one of bytes, and SHA-256 of all that.

use sha2::{Digest, Sha256};

use super::selection::Selection;
use super::space::Shape;

/// First bytes of a file; the last one is the version.
const MAGIC: &[u8; 12] = b"cullscope-o2";
/// Bytes of the checksum at the end.
const CHECKSUM: usize = 32;

/// How many parameters the selection depends on.
const PARAMS: usize = 6;

/// What a selection was made for: the scene's hash; levels of the tree, whether its boxes are cells,
/// directions, occluders, marginal gain, whether back faces are culled.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub scene: String,
    pub params: [u32; PARAMS],
}

/// Bytes of a selection.
pub fn write(key: &Key, selection: &Selection) -> Vec<u8> {
    let (leaf_of, starts, lists, toward) = selection.tables();
    let mut bytes = MAGIC.to_vec();
    // A hash is always equally long, so it needs no length.
    bytes.extend(key.scene.as_bytes());
    let lengths = [leaf_of.len(), starts.len(), lists.len(), toward.len()].map(|n| n as u32);
    let numbers = key.params.iter().chain(&lengths).chain(leaf_of).chain(starts).chain(lists);
    numbers.for_each(|n| bytes.extend(n.to_le_bytes()));
    bytes.extend(toward);
    let sum = Sha256::digest(&bytes);
    bytes.extend(sum);
    bytes
}

/// The selection of some bytes, for a tree of `nodes` nodes and `occluders` candidates.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read<S: Shape>(bytes: &[u8], key: &Key, nodes: usize, occluders: usize) -> Result<Selection, String> {
    let damaged = || "the file is damaged".to_owned();
    let Some((body, sum)) = bytes.split_last_chunk::<CHECKSUM>() else { return Err(damaged()) };
    let Some((magic, rest)) = body.split_first_chunk::<12>() else { return Err(damaged()) };
    // The version first, so that an older file is not called damaged; then the sum, so that what follows may
    // trust every length.
    if magic != MAGIC {
        return Err("it is no preprocess of large-occluders that this version reads".into());
    }
    if Sha256::digest(body).as_slice() != sum {
        return Err(damaged());
    }
    let (scene, rest) = rest.split_at_checked(key.scene.len()).ok_or_else(damaged)?;
    if scene != key.scene.as_bytes() {
        return Err("it was made for another scene".into());
    }
    let mut rest = rest;
    let mut words = |count: usize| -> Option<Vec<u32>> {
        let (taken, left) = rest.split_at_checked(count.checked_mul(4)?)?;
        rest = left;
        Some(taken.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect())
    };
    let params = words(PARAMS).ok_or_else(damaged)?;
    if params != key.params {
        return Err(format!(
            "it was made with {} levels, cells={} directions={} occluders={} marginal-gain={} \
             backface-culling={} see-through={}",
            params[0],
            params[1] == 1,
            params[2],
            params[3],
            params[4],
            params[5] & 1 == 1,
            if params[5] & 2 == 2 { "solid" } else { "clear" }
        ));
    }
    let lengths = words(4).ok_or_else(damaged)?;
    let mut table = |i: usize| words(lengths[i] as usize).ok_or_else(damaged);
    let tables = [table(0)?, table(1)?, table(2)?];
    if rest.len() != lengths[3] as usize {
        return Err(damaged());
    }
    // A right sum says that nothing was damaged, and not that the numbers fit: each that serves as a place is
    // checked. The directions themselves are made again from how many there are.
    Selection::of_tables::<S>(params[2], tables, rest.to_vec(), nodes, occluders).ok_or_else(damaged)
}
