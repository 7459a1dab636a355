//! What the figures read of the method's notes.

use crate::culling::anatomy::Occlusion;
use crate::culling::large_occluders::{Evidence, LargeOccluders, Owner};
use crate::geometry::{Flat, NodeId, ObjectId, PrimId};
use crate::method::{Film, notes};

/// A test of a box against an occluder.
pub struct Test {
    /// Whose box, if a node's.
    pub node: Option<NodeId>,
    /// Whose box, if a detail object's.
    pub object: Option<ObjectId>,
    /// The occluder, by its first primitive.
    pub occluder: PrimId,
    /// What of the box it hides.
    pub occlusion: Occlusion,
    /// Whether its planes were kept from an earlier frame.
    pub reused: bool,
}

/// The tests of a frame, in order.
pub fn tests(film: &dyn Film<Flat>) -> Vec<Test> {
    let test = |(_, note): (usize, &Evidence<Flat>)| {
        let Evidence::Related(test) = note else { return None };
        let (node, object) = match test.owner {
            Owner::Node(node) => (Some(node), None),
            Owner::Object(object) => (None, Some(object)),
        };
        let (occluder, occlusion, reused) = (test.name, test.occlusion, test.reused);
        Some(Test { node, object, occluder, occlusion, reused })
    };
    notes::<Flat, LargeOccluders>(film).filter_map(test).collect()
}

/// The occluders chosen for the eye.
pub fn chosen(film: &dyn Film<Flat>) -> Vec<PrimId> {
    let prim = |(_, note): (usize, &Evidence<Flat>)| match note {
        Evidence::Chosen(occluder) => Some(occluder.name),
        _ => None,
    };
    notes::<Flat, LargeOccluders>(film).filter_map(prim).collect()
}
