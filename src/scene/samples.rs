//! Small scenes for unit tests.

use std::sync::Arc;

use super::{Parts, Scene};
use crate::geometry::Space;
use crate::geometry::dice::Dice;

/// `n` small primitives strewn in a box of ±10 units around the origin.
pub fn soup<S: Space>(seed: u64, n: u32) -> Arc<Scene<S>> {
    let mut dice = Dice::new(seed);
    let corners = S::CORNERS as u32;
    let mut points = Vec::new();
    for _ in 0..n {
        let center: S::Vector = dice.vector(10.0);
        points.extend((0..corners).map(|_| center + dice.vector(0.8)));
    }
    let prims = (0..n).map(|i| S::corners_from(std::array::from_fn(|k| i * corners + k as u32))).collect();
    Arc::new(Scene::new(Parts::simple("soup", points, prims)).expect("a valid scene"))
}
