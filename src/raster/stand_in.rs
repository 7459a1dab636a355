//! What is drawn in place of geometry: a box whose faces have one color each, a color cube (Chamberlain,
//! DeRose, Lischinski, Salesin and Snyder 1996, Section 3).

use crate::geometry::{Aabb, NodeId};

/// A box that stands for all that a node holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandIn<V> {
    /// What it stands for; for picking.
    pub node: NodeId,
    /// The box.
    pub bounds: Aabb<V>,
    /// What is seen on its faces.
    pub faces: CubeFaces,
    /// How many primitives of the list are drawn before it, where the order of both matters.
    pub after: u32,
}

/// Linear color and coverage of each face of a box, premultiplied: two faces an axis, the lower one first;
/// four are used in flatland. Kept in 8 bits a channel: the coverage as it is, a color as its square root,
/// since equal steps of light show as bands where it is dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CubeFaces([[u8; 4]; 6]);

impl CubeFaces {
    /// Faces from their colors and coverages, each 0 to 1 and no color above its coverage.
    pub fn new(faces: &[[f32; 4]; 6]) -> Self {
        Self(faces.map(|[r, g, b, a]| {
            let alpha = (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
            // What is kept keeps the rule as well: no color above the coverage, as rounded.
            let most = ((f32::from(alpha) * (1.0 / 255.0)).sqrt() * 255.0) as u8;
            let root = |c: f32| ((c.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u8).min(most);
            [root(r), root(g), root(b), alpha]
        }))
    }
    /// Color and coverage of a face: number `2 · axis`, and one more for the upper side.
    #[inline]
    pub fn get(&self, face: usize) -> [f32; 4] {
        let [r, g, b, a] = self.0[face].map(|byte| f32::from(byte) * (1.0 / 255.0));
        [r * r, g * g, b * b, a]
    }
    /// As they are kept.
    pub fn bytes(&self) -> [[u8; 4]; 6] {
        self.0
    }
    /// From what [`CubeFaces::bytes`] returned; `None` if it cannot be that.
    pub fn of_bytes(bytes: [[u8; 4]; 6]) -> Option<Self> {
        let fits = |face: usize| {
            let [color @ .., alpha] = Self(bytes).get(face);
            color.iter().all(|c| *c <= alpha)
        };
        (0..6).all(fits).then_some(Self(bytes))
    }
}
