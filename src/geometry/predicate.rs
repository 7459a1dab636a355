//! Exact signs, for decisions that a structure hangs on.
//!
//! Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997,
//! through the crate `robust`.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// Positive if `a`, `b`, `c` turn counter-clockwise, negative if clockwise, exactly 0 if collinear.
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Positive if `d` lies on the side of the plane from which `a`, `b`, `c` are seen counter-clockwise,
/// negative if on the other, exactly 0 if coplanar.
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    -robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// For `a`, `b`, `c`, `d` with `orient3d(a, b, c, d) > 0`: positive if `e` lies inside the sphere through
/// them, negative if outside, exactly 0 if on it.
pub fn insphere(a: DVec3, b: DVec3, c: DVec3, d: DVec3, e: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    robust::insphere(coord(b), coord(a), coord(c), coord(d), coord(e))
}
