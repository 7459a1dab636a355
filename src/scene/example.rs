//! Flatland scenes that travel inside the program, for its built-in figures and its start screen.

use std::sync::Arc;

use super::{LoadOptions, Scene, SceneError, flat};
use crate::geometry::Flat;

/// Name and file of each.
const EXAMPLES: &[(&str, &str, &[u8])] = &[
    ("street", "scenes2d/street.json", include_bytes!("../../scenes2d/street.json")),
    (
        "freedoom_e1m1",
        "scenes2d/freedoom_e1m1/freedoom_e1m1.flat.json",
        include_bytes!("../../scenes2d/freedoom_e1m1/freedoom_e1m1.flat.json"),
    ),
    (
        "occluder_and_box",
        "scenes2d/occluder_and_box.json",
        include_bytes!("../../scenes2d/occluder_and_box.json"),
    ),
    (
        "connected_occluders",
        "scenes2d/connected_occluders.json",
        include_bytes!("../../scenes2d/connected_occluders.json"),
    ),
    (
        "silhouette_edge",
        "scenes2d/silhouette_edge.json",
        include_bytes!("../../scenes2d/silhouette_edge.json"),
    ),
    ("two_viewpoints", "scenes2d/two_viewpoints.json", include_bytes!("../../scenes2d/two_viewpoints.json")),
    ("bottleneck", "scenes2d/bottleneck.json", include_bytes!("../../scenes2d/bottleneck.json")),
    ("forest", "scenes2d/forest.json", include_bytes!("../../scenes2d/forest.json")),
    ("figure5", "scenes2d/figure5.json", include_bytes!("../../scenes2d/figure5.json")),
    ("tree", "scenes2d/tree.json", include_bytes!("../../scenes2d/tree.json")),
    ("molecule", "scenes2d/molecule.json", include_bytes!("../../scenes2d/molecule.json")),
    ("venetian_blind", "scenes2d/venetian_blind.json", include_bytes!("../../scenes2d/venetian_blind.json")),
    ("detail_objects", "scenes2d/detail_objects.json", include_bytes!("../../scenes2d/detail_objects.json")),
];

/// A flatland scene by name.
///
/// # Errors
/// [`SceneError::Format`] if there is none of this name.
pub fn example(name: &str) -> Result<Arc<Scene<Flat>>, SceneError> {
    match EXAMPLES.iter().find(|e| e.0 == name) {
        Some((_, source, bytes)) => flat::read(bytes, source, &LoadOptions::default()).map(Arc::new),
        None => Err(SceneError::Format {
            path: name.to_owned(),
            why: "there is no example scene of this name".into(),
        }),
    }
}
