//! Broken input, kind by kind, each with its outcome: one clear error, or the valid part and a report; and
//! valid files that are seldom, with the right values.

#[path = "broken/files.rs"]
mod files;
#[path = "broken/flat.rs"]
mod flat;
#[path = "broken/fuzz.rs"]
mod fuzz;
#[path = "broken/gltf.rs"]
mod gltf;
#[path = "files/gltf.rs"]
mod gltf_files;
#[path = "broken/materials.rs"]
mod materials;
#[path = "broken/molecules.rs"]
mod molecules;
#[path = "broken/obj.rs"]
mod obj;

use std::sync::Arc;

use cullscope::geometry::Solid;
use cullscope::scene::{AnyScene, Dropped, LoadOptions, Quiet, Scene, load_bytes};

/// Reads bytes as if they were the file `source`.
fn read(source: &str, bytes: &[u8]) -> Result<AnyScene, String> {
    load_bytes(bytes, source, &LoadOptions::default(), &Quiet).map_err(|e| {
        let said = e.to_string();
        assert!(!said.contains('\n'), "an error is one line: {said}");
        said
    })
}

fn solid(source: &str, bytes: &[u8]) -> Arc<Scene<Solid>> {
    match read(source, bytes) {
        Ok(AnyScene::Solid(scene)) => scene,
        other => panic!("{source} should load: {other:?}"),
    }
}

fn error(source: &str, bytes: &[u8]) -> String {
    match read(source, bytes) {
        Err(said) => said,
        Ok(AnyScene::Solid(s)) => {
            panic!("{source} should be refused, but has {} triangles: {:?}", s.live().len(), s.report())
        }
        Ok(AnyScene::Flat(s)) => {
            panic!("{source} should be refused, but has {} segments: {:?}", s.live().len(), s.report())
        }
    }
}

/// Ids, live ones, and the dropped ones by reason.
fn counts(scene: &Scene<Solid>) -> (usize, usize, Vec<(Dropped, usize)>) {
    (scene.prim_count(), scene.live().len(), scene.report().dropped.iter().map(|(k, v)| (*k, *v)).collect())
}
