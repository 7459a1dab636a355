//! Small scenes for unit tests.

use std::sync::Arc;

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::{Material, Object, Parts, Report, Scene};
use crate::geometry::{MaterialId, ObjectId, Space, Vector};

/// `n` small primitives strewn in a box of ±10 units around the origin.
pub fn soup<S: Space>(seed: u64, n: u32) -> Arc<Scene<S>> {
    let mut rng = Pcg32::new(seed, 77);
    let mut signed = |scale: f32| ((rng.next_u32() >> 8) as f32 / (1 << 23) as f32 - 1.0) * scale;
    let corners = S::CORNERS as u32;
    let mut points = Vec::new();
    for _ in 0..n {
        let center = S::Vector::from_fn(|_| signed(10.0));
        points.extend((0..corners).map(|_| center + S::Vector::from_fn(|_| signed(0.8))));
    }
    let prims =
        (0..n).map(|i| Some(S::corners_from(std::array::from_fn(|k| i * corners + k as u32)))).collect();
    let parts = Parts {
        name: "soup".into(),
        source: format!("soup {seed}"),
        points,
        prims,
        prim_object: vec![ObjectId(0); n as usize],
        prim_material: vec![MaterialId(0); n as usize],
        faces: vec![],
        objects: vec![Object { name: "soup".into(), group: String::new(), motion: None }],
        materials: vec![Material { name: "gray".into(), color: [0.5; 3] }],
        origin: DVec3::ZERO,
        paths: vec![],
        report: Report::default(),
    };
    Arc::new(Scene::new(parts).expect("a valid scene"))
}
