//! How the surfaces of a scene are taken: whether they have a back, and whether light comes through.

use super::Scene;
use crate::geometry::{PrimId, Space};

/// How the surfaces of a scene are taken, by methods, truth and rasterizer alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Surfaces {
    /// Primitives have a front only, unless their material has two sides: one that faces away is not there.
    pub one_sided: bool,
    /// See-through primitives hide what is behind them, as if they were opaque.
    pub solid: bool,
}

impl Surfaces {
    /// The same for primitives of which those that turn away were left out already.
    pub fn both_sides(self) -> Self {
        Self { one_sided: false, ..self }
    }
    /// Whether a live primitive is not there for an eye, since it turns its back.
    #[inline]
    pub fn leave_out<S: Space>(self, scene: &Scene<S>, prim: PrimId, eye: S::Vector) -> bool {
        self.one_sided && scene.faces_away(prim, eye)
    }
    /// Whether what is behind a primitive shows through it.
    #[inline]
    pub fn show_through<S: Space>(self, scene: &Scene<S>, prim: PrimId) -> bool {
        !self.solid && scene.is_see_through(prim)
    }
    /// Whether that is so of any primitive.
    pub fn any_through<S: Space>(self, scene: &Scene<S>) -> bool {
        !self.solid && scene.has_see_through()
    }
}
