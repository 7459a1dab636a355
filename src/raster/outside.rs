//! Boxes out of view, many at a time, on the best instruction set that the machine has.

use super::simd::{Lanes, Work, run_best};
use crate::geometry::{Aabb, Frustum, Vector};

struct Outside<'a, V> {
    frustum: &'a Frustum<V>,
    boxes: &'a [Aabb<V>],
    bits: &'a mut Vec<u16>,
}

impl<V: Vector> Work for Outside<'_, V> {
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        // Lanes of arrays: what the compiler makes of them follows from the instruction set around it.
        for boxes in self.boxes.chunks(16) {
            self.bits.push(self.frustum.excludes_each(boxes));
        }
    }
}

/// Which of some boxes lie wholly outside a view volume, as [`Frustum::excludes`] says: a bit each.
pub fn outside<V: Vector>(frustum: &Frustum<V>, boxes: &[Aabb<V>], bits: &mut Vec<u16>) {
    bits.clear();
    run_best(Outside { frustum, boxes, bits });
}
