//! What every reader knows about a source: how it is to be loaded, how long it may be, and its short name.

use std::path::Path;

/// Longest model file, bytes. Tables take up to about 14 times the file (a face of two bytes a corner).
pub(super) const MODEL_LIMIT_BYTES: u64 = 2 << 30;
/// Longest file of a molecule, bytes.
pub(super) const MOLECULE_LIMIT_BYTES: u64 = 512 << 20;
/// Longest flatland scene or view file, bytes.
pub(super) const JSON_LIMIT_BYTES: u64 = 256 << 20;

/// When coordinates are moved to the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Recenter {
    /// Where the model is so far from its origin that 32-bit coordinates would lose detail.
    #[default]
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// What happens to a scene on its way in.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadOptions {
    /// Merge points at the same place.
    pub weld: bool,
    /// Drop triangles without area (segments without length); they keep their ids.
    pub drop_degenerate: bool,
    /// Merge coplanar neighbors of one object and one material into convex polygons.
    pub merge_coplanar: bool,
    /// Move far-off coordinates to the origin.
    pub recenter: Recenter,
    /// Read the view paths beside the model: `NAME.views.json` and `NAME.walk.views.json`.
    pub read_views: bool,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            weld: true,
            drop_degenerate: true,
            merge_coplanar: false,
            recenter: Recenter::Auto,
            read_views: true,
        }
    }
}

/// The last part of a path without its extension; of `NAME.flat.json` the `NAME`.
pub(super) fn stem(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    stem.strip_suffix(".flat").map(str::to_owned).unwrap_or(stem)
}
