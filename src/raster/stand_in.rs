//! What is drawn in place of geometry: a box whose faces have one color each (Chamberlain et al. 1996).

use crate::geometry::{Aabb, NodeId};

/// A box that stands for all that a node holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandIn<V> {
    /// What it stands for; for picking.
    pub node: NodeId,
    /// The box.
    pub bounds: Aabb<V>,
    /// Linear color and coverage of each face, premultiplied: two faces an axis, the lower one first; four
    /// are used in flatland.
    pub faces: [[f32; 4]; 6],
}
