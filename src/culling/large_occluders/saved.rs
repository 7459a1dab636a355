//! The selection as bytes, so that the preprocess is done once: three tables of numbers and one of bytes.

use super::selection::Selection;
use super::space::Shape;
use crate::culling::saved::{self, Format, damaged};

const FORMAT: Format = Format { magic: b"cullscope-o2", method: "large-occluders", has_bytes: true };

/// How many parameters the selection depends on.
const PARAMS: usize = 6;

/// What a selection was made for: levels of the tree, whether its boxes are cells, directions, occluders,
/// marginal gain, whether back faces are culled.
pub type Key = saved::Key<PARAMS>;

/// Bytes of a selection.
pub fn write(key: &Key, selection: &Selection) -> Vec<u8> {
    let (leaf_of, starts, lists, toward) = selection.tables();
    FORMAT.write(key, &[leaf_of, starts, lists], toward)
}

fn describe(params: [u32; PARAMS]) -> String {
    format!(
        "{} levels, cells={} directions={} occluders={} marginal-gain={} backface-culling={} see-through={}",
        params[0],
        params[1] == 1,
        params[2],
        params[3],
        params[4],
        params[5] & 1 == 1,
        if params[5] & 2 == 2 { "solid" } else { "open" }
    )
}

/// The selection of some bytes, for a tree of `nodes` nodes and `occluders` candidates.
///
/// # Errors
/// Why they do not fit: damaged, of another version, scene or parameters.
pub fn read<S: Shape>(bytes: &[u8], key: &Key, nodes: usize, occluders: usize) -> Result<Selection, String> {
    let (tables, toward) = FORMAT.read::<PARAMS, 3>(bytes, key, describe)?;
    // A right sum says that nothing was damaged, and not that the numbers fit: each that serves as a place is
    // checked. The directions themselves are made again from how many there are.
    Selection::of_tables::<S>(key.params[2], tables, toward, nodes, occluders).ok_or_else(damaged)
}
