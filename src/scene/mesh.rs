//! What readers and generators hand over: polygons over shared points of 64 bits.

use glam::DVec3;

use super::{Dropped, Material, Object};

/// A face of the source, in file order.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawFace {
    /// Past its last corner in [`Mesh::corners`]; it begins where the one before ends.
    pub(super) end: u32,
    /// Triangle ids that it takes: n − 2 of its n corners in the source.
    pub(super) ids: u32,
    pub(super) object: u32,
    pub(super) material: u32,
    /// Why it is not there; then it has no corners.
    pub(super) lost: Option<Dropped>,
}

/// Polygons over shared points.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) points: Vec<DVec3>,
    /// Color at each point, 0..1 ([`Mesh::NO_COLOR`] where there is none); empty if no point has one.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) corners: Vec<u32>,
    pub(super) faces: Vec<RawFace>,
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
}

impl Mesh {
    /// A point without a color.
    pub(super) const NO_COLOR: [f32; 3] = [f32::NAN; 3];

    /// Adds a face of these corners.
    pub(super) fn push(&mut self, corners: &[u32], object: u32, material: u32) {
        self.corners.extend_from_slice(corners);
        let ids = (corners.len() as u32).saturating_sub(2);
        self.faces.push(RawFace { end: self.corners.len() as u32, ids, object, material, lost: None });
    }
    /// Adds a face that is not there but takes ids.
    pub(super) fn push_lost(&mut self, ids: u32, object: u32, material: u32, why: Dropped) {
        self.faces.push(RawFace { end: self.corners.len() as u32, ids, object, material, lost: Some(why) });
    }
    /// The corners of each face, in order.
    pub(super) fn rings(&self) -> impl Iterator<Item = &[u32]> {
        let mut start = 0;
        self.faces.iter().map(move |face| {
            let ring = &self.corners[start..face.end as usize];
            start = face.end as usize;
            ring
        })
    }
}
