//! The baselines of every comparison: draw everything, cull by the view frustum over a kD-tree, and
//! draw the nearest centroids up to a budget.

mod centroid;
mod explain;
mod frustum;
#[cfg(test)]
mod tests;
mod z_buffer;

pub use centroid::Centroid;
pub use frustum::Frustum;
pub use z_buffer::ZBuffer;

use super::{Knob, Knobs};
use crate::geometry::{PrimId, Space, faces_away};
use crate::scene::Scene;

/// The parameter that every method has.
fn backface_knob(knobs: &mut dyn Knobs, value: &mut bool) {
    let knob = Knob {
        name: "backface-culling",
        unit: "",
        meaning: "primitives have one side: those that face away from the eye are neither drawn nor part of the truth",
        source: "Klosowski and Silva 2000, Section 5",
    };
    knobs.switch(knob, value);
}

/// Whether a live primitive turns its back to the eye.
#[inline]
fn prim_faces_away<S: Space>(scene: &Scene<S>, eye: S::Vector, prim: PrimId) -> bool {
    let mut corners = [S::Vector::default(); 3];
    for (to, from) in corners.iter_mut().zip(scene.prim_points(prim)) {
        *to = from;
    }
    faces_away::<S>(eye, &corners[..S::CORNERS])
}
