//! Random numbers for unit tests, the same on every machine.

use glam::Vec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

use super::Vector;

/// Seeded dice.
pub(crate) struct Dice(Pcg64Mcg);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::new(u128::from(seed) << 64 | 0xcafe_f00d_d15e_a5e5))
    }
    /// Any 32 bits.
    pub(crate) fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }
    /// A whole number of 0..n, n > 0.
    pub(crate) fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }
    /// A number of 0..1.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1u32 << 24) as f32
    }
    /// A number of low..high.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
    /// A number of ±`reach`.
    pub(crate) fn signed(&mut self, reach: f32) -> f32 {
        self.between(-reach, reach)
    }
    /// A point of the cube of ±`reach` around the origin.
    pub(crate) fn point(&mut self, reach: f32) -> Vec3 {
        self.vector(reach)
    }
    /// The same of any space.
    pub(crate) fn vector<V: Vector>(&mut self, reach: f32) -> V {
        V::from_fn(|_| self.signed(reach))
    }
    /// A point whose coordinates are whole numbers of 0..n.
    pub(crate) fn grid_point<V: Vector>(&mut self, n: u32) -> V {
        V::from_fn(|_| self.below(n) as f32)
    }
    pub(crate) fn shuffle<T>(&mut self, list: &mut [T]) {
        for i in (1..list.len()).rev() {
            list.swap(i, self.below(i as u32 + 1) as usize);
        }
    }
}
