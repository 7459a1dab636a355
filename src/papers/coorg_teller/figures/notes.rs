//! What the figures read of the method's notes.

use crate::geometry::{Flat, NodeId, ObjectId, PrimId};
use crate::method::{Field, Film, Value};

/// A test of a box against an occluder, as the film records it.
pub struct Test {
    pub node: Option<NodeId>,
    pub object: Option<ObjectId>,
    pub occluder: PrimId,
    pub occlusion: String,
    pub reused: bool,
}

/// The tests of a frame, in order.
pub fn tests(film: &dyn Film<Flat>) -> Vec<Test> {
    let test = |at: usize| {
        let (kind, fields) = film.fields(at);
        let value = |name: &str| fields.iter().find(|f: &&Field| f.name == name).map(|f| f.value.clone());
        let id = |name: &str| if let Some(Value::Integer(n)) = value(name) { Some(n as u32) } else { None };
        (kind == "OcclusionTested").then(|| Test {
            node: id("node").map(NodeId),
            object: id("object").map(ObjectId),
            occluder: PrimId(id("occluder_prim").unwrap_or_default()),
            occlusion: if let Some(Value::Word(w)) = value("occlusion") { w } else { String::new() },
            reused: value("reused") == Some(Value::Switch(true)),
        })
    };
    (0..film.events().len()).filter_map(test).collect()
}

/// The occluders chosen for the eye.
pub fn chosen(film: &dyn Film<Flat>) -> Vec<PrimId> {
    let prim = |at: usize| {
        let (kind, fields) = film.fields(at);
        let id = fields.iter().find_map(|f| {
            if let (&"prim", Value::Integer(n)) = (&f.name, &f.value) {
                Some(PrimId(*n as u32))
            } else {
                None
            }
        });
        if kind == "OccluderChosen" { id } else { None }
    };
    (0..film.events().len()).filter_map(prim).collect()
}
