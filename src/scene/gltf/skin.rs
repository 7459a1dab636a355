//! Skins: a mesh whose points follow joints (glTF 2.0, section 3.7.3), with the joints at rest.

use glam::{DMat4, DVec3};

use super::data::Data;
use super::file::{Gltf, Index};
use super::tree::Tree;

/// Which joints a point follows, and how much each.
pub(super) type Influences = Vec<(Vec<[u32; 4]>, Vec<[f64; 4]>)>;

/// The joints of a skin.
pub(super) struct Skin {
    /// From the mesh as it was bound to the world.
    matrices: Vec<DMat4>,
}

impl Skin {
    pub(super) fn read(gltf: &Gltf, data: &Data, tree: &Tree, index: Index) -> Result<Self, String> {
        let skin = gltf.skins.get(index as usize).ok_or_else(|| format!("there is no skin {index}"))?;
        let skin = skin.0.as_ref().map_err(Clone::clone)?;
        let count = skin.joints.len();
        if count == 0 {
            return Err("it has no joints".into());
        }
        let bound = match skin.inverse_bind_matrices {
            // Compared before any is read.
            Some(accessor) if data.accessor(accessor)?.count < count => {
                return Err(format!("its {count} joints have fewer inverse bind matrices"));
            }
            Some(accessor) => data.vectors::<16>(accessor)?,
            None => Vec::new(),
        };
        let matrix = |(k, joint): (usize, &Index)| {
            let world = tree.worlds.get(*joint as usize);
            let bound = bound.get(k).map_or(DMat4::IDENTITY, DMat4::from_cols_array);
            world.map(|w| *w * bound).ok_or_else(|| format!("there is no node {joint} for a joint"))
        };
        Ok(Self { matrices: skin.joints.iter().enumerate().map(matrix).collect::<Result<_, _>>()? })
    }

    /// Points where the joints put them. "The transforms of the node with the skin are ignored" (3.7.3.3):
    /// where they are is what the joints alone say.
    pub(super) fn place(&self, points: &[DVec3], influences: &Influences) -> Result<Vec<DVec3>, String> {
        let place = |(i, point): (usize, &DVec3)| {
            let (mut moved, mut whole) = (DVec3::ZERO, 0.0);
            for (joints, weights) in influences {
                for (joint, weight) in joints[i].iter().zip(weights[i]).filter(|(_, w)| *w != 0.0) {
                    moved += self.joint(*joint)?.transform_point3(*point) * weight;
                    whole += weight;
                }
            }
            // Weights should come to 1; rounded ones miss it by a little.
            if whole > 0.0 {
                return Ok(moved / whole);
            }
            Ok(self.joint(influences[0].0[i][0])?.transform_point3(*point))
        };
        points.iter().enumerate().map(place).collect()
    }

    fn joint(&self, joint: u32) -> Result<&DMat4, String> {
        let count = self.matrices.len();
        self.matrices
            .get(joint as usize)
            .ok_or_else(|| format!("a point follows joint {joint}, but its skin has only {count}"))
    }

    /// Whether the joints turn the mesh inside out.
    pub(super) fn is_mirrored(&self) -> bool {
        self.matrices.iter().filter(|m| m.determinant() < 0.0).count() * 2 > self.matrices.len()
    }
}
