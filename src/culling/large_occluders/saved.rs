//! The selection as bytes, so that the preprocess is done once: versioned, and checked against scene and
//! parameters.
//!
//! Little-endian: the magic with the version, SHA-256 of the scene in hex, the four parameters that the
//! selection depends on, three lengths, three tables, and SHA-256 of all that.

use sha2::{Digest, Sha256};

use super::selection::Selection;

/// First bytes of a file; the last one is the version.
const MAGIC: &[u8; 12] = b"cullscope-o1";
/// Bytes of the checksum at the end.
const CHECKSUM: usize = 32;

/// What a selection was made for: the scene's hash; tree height, directions, occluders, marginal gain.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub scene: String,
    pub params: [u32; 4],
}

/// Bytes of a selection.
pub fn write(key: &Key, selection: &Selection) -> Vec<u8> {
    // Area-angles by their bits, so that a restored selection is the same to the last of them.
    let (leaf_of, starts, lists) = selection.tables();
    let mut bytes = MAGIC.to_vec();
    // A hash is always equally long, so it needs no length.
    bytes.extend(key.scene.as_bytes());
    let lengths = [leaf_of.len(), starts.len(), lists.len()].map(|n| n as u32);
    let numbers = key.params.iter().chain(&lengths).chain(leaf_of).chain(starts).copied();
    let lists = lists.iter().flat_map(|(id, score)| [*id, score.to_bits()]);
    numbers.chain(lists).for_each(|n| bytes.extend(n.to_le_bytes()));
    let sum = Sha256::digest(&bytes);
    bytes.extend(sum);
    bytes
}

/// The selection of some bytes, for a tree of `nodes` nodes and `occluders` candidates.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read(bytes: &[u8], key: &Key, nodes: usize, occluders: usize) -> Result<Selection, String> {
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
    let (words, []) = rest.as_chunks::<4>() else { return Err(damaged()) };
    let words: Vec<u32> = words.iter().map(|w| u32::from_le_bytes(*w)).collect();
    let (params, words) = words.split_first_chunk::<4>().ok_or_else(damaged)?;
    if *params != key.params {
        let [height, directions, most, gain] = params;
        return Err(format!(
            "it was made with tree-height={height} directions={directions} occluders={most} \
             marginal-gain={gain}"
        ));
    }
    let (lengths, words) = words.split_first_chunk::<3>().ok_or_else(damaged)?;
    let [leaf_of, starts, lists] = lengths.map(|n| n as usize);
    if words.len() != leaf_of + starts + 2 * lists {
        return Err(damaged());
    }
    let pairs = words[leaf_of + starts..].chunks_exact(2).map(|w| (w[0], f32::from_bits(w[1]))).collect();
    // A right sum says that nothing was damaged, and not that the numbers fit: each that serves as a place is
    // checked. The directions themselves are made again from how many there are.
    let tables = (words[..leaf_of].to_vec(), words[leaf_of..leaf_of + starts].to_vec(), pairs);
    Selection::of_tables(params[1], tables, nodes, occluders).ok_or_else(damaged)
}
