//! Keys of the methods that the papers are about, each spelled once here; a test holds that every one is a
//! method of both spaces.

/// Everything drawn.
pub const Z_BUFFER: &str = "z-buffer";
/// View-frustum culling.
pub const FRUSTUM: &str = "frustum";
/// Nearest first, until a budget is spent.
pub const CENTROID: &str = "centroid";
/// Coorg and Teller.
pub const LARGE_OCCLUDERS: &str = "large-occluders";
/// Georges, after Greene, Kass and Miller.
pub const HIERARCHICAL_Z: &str = "hierarchical-z";
/// Georges, on a machine of many processors.
pub const PARALLEL_HIERARCHICAL_Z: &str = "parallel-hierarchical-z";
/// Klosowski and Silva.
pub const LAYERED_PROJECTION: &str = "layered-projection";
/// Zhang, Manocha, Hudson and Hoff.
pub const OCCLUSION_MAPS: &str = "occlusion-maps";
/// Chamberlain, DeRose, Lischinski, Salesin and Snyder.
pub const COLOR_CUBES: &str = "color-cubes";
