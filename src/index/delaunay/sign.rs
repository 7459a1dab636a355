//! The two signs that the triangulation hangs on: fast where a bound on the rounding allows, exact elsewhere.
//!
//! Devillers and Pion, "Efficient Exact Geometric Predicates for Delaunay Triangulations", ALENEX 2003: a
//! semi-static filter compares the determinant with a constant times the largest coordinates. What it leaves
//! open is settled by integers if all points lie on a common grid (voxels, centers of octree cells), where
//! ties are the rule, and by Shewchuk's expansions otherwise. Points are `f32` widened to `f64`: a product of
//! five coordinates lies between 2⁻⁷⁴⁵ and 2⁶⁵⁰, so nothing under- or overflows.

use glam::DVec3;

use crate::geometry::{insphere, orient3d};

/// Half an ulp of 1.
const U: f64 = f64::EPSILON * 0.5;
/// Six products of three rounded differences, 8 roundings along the way of each: 48 u to first order.
const ORIENT_ERROR: f64 = 64.0 * U;
/// 72 products of five rounded differences, 17 roundings along the way of each: 1224 u to first order.
const INSPHERE_ERROR: f64 = 1280.0 * U;
/// Bits of a difference on the grid: 72 products of five of them stay below 2¹²⁷.
const GRID_BITS: f64 = (1u32 << 24) as f64;

/// The points, and how to settle ties among them.
pub struct Signs {
    points: Vec<DVec3>,
    /// Differences of points times this are whole numbers below `GRID_BITS`, and computed exactly.
    grid: Option<f64>,
}

impl Signs {
    /// `points` are `f32` numbers, finite.
    pub fn new(points: Vec<DVec3>) -> Self {
        let grid = grid(&points);
        Self { points, grid }
    }
    /// Number of points.
    pub fn count(&self) -> usize {
        self.points.len()
    }
    /// A point.
    #[inline]
    pub fn point(&self, vertex: u32) -> DVec3 {
        self.points[vertex as usize]
    }

    /// Positive if `d` lies on the side of the plane from which `a`, `b`, `c` are seen counter-clockwise; 0
    /// if on it.
    #[inline]
    pub fn orient(&self, [a, b, c]: [u32; 3], d: u32) -> f64 {
        // Relative to `d`: one rounding a difference, and a determinant of three rows instead of four.
        let origin = self.point(d);
        let [p, q, r] = [a, b, c].map(|v| self.point(v) - origin);
        let det = -p.dot(q.cross(r));
        // The filter: beyond this the sign cannot be wrong. The bound follows the size of each axis, so flat
        // scenes keep a sharp one.
        let most = p.abs().max(q.abs()).max(r.abs());
        if det.abs() > ORIENT_ERROR * most.x * most.y * most.z {
            det
        } else {
            self.orient_exactly([a, b, c, d])
        }
    }
    #[cold]
    fn orient_exactly(&self, vertices: [u32; 4]) -> f64 {
        let [a, b, c, d] = vertices.map(|v| self.point(v));
        let Some(scale) = self.grid else { return orient3d(a, b, c, d) };
        // Below 2²⁴, so a cross product stays below 2⁴⁹, and the sum is taken in 128 bits.
        let [p, q, r] = [a, b, c].map(|v| ((v - d) * scale).as_i64vec3());
        let det: i128 = (0..3).map(|i| i128::from(p[i]) * i128::from(q.cross(r)[i])).sum();
        -det.signum() as f64
    }

    /// For a positive tetrahedron: positive if `e` lies inside the sphere through its vertices; 0 if on it.
    #[inline]
    pub fn insphere(&self, tetrahedron: [u32; 4], e: u32) -> f64 {
        let center = self.point(e);
        let [p, q, r, s] = tetrahedron.map(|v| self.point(v) - center);
        // The determinant of five points by 2 × 2 minors in x and y, then 3 × 3 with z, then the squared
        // lengths: each minor is computed once.
        let minor = |a: DVec3, b: DVec3| a.x * b.y - b.x * a.y;
        let (pq, pr, ps, qr, qs, rs) =
            (minor(p, q), minor(p, r), minor(p, s), minor(q, r), minor(q, s), minor(r, s));
        let pqr = p.z * qr - q.z * pr + r.z * pq;
        let pqs = p.z * qs - q.z * ps + s.z * pq;
        let prs = p.z * rs - r.z * ps + s.z * pr;
        let qrs = q.z * rs - r.z * qs + s.z * qr;
        let det = (p.length_squared() * qrs - q.length_squared() * prs)
            + (r.length_squared() * pqs - s.length_squared() * pqr);
        let most = p.abs().max(q.abs()).max(r.abs()).max(s.abs());
        // A squared length has three such squares; the constant counts them.
        let longest = most.max_element();
        let error = INSPHERE_ERROR * most.x * most.y * most.z * longest * longest;
        if det.abs() > error { det } else { self.insphere_exactly(tetrahedron, e) }
    }
    #[cold]
    fn insphere_exactly(&self, tetrahedron: [u32; 4], e: u32) -> f64 {
        let center = self.point(e);
        let [a, b, c, d] = tetrahedron.map(|v| self.point(v));
        let Some(scale) = self.grid else { return insphere(a, b, c, d, center) };
        // Squared lengths below 3 · 2⁴⁸ fit 64 bits; their products with 3 × 3 minors need 128.
        let arms = [a, b, c, d].map(|v| ((v - center) * scale).as_i64vec3());
        // The determinant by its first column, the squared lengths; the rest of each row is an arm.
        let term = |i: usize| {
            let [q, r, s] = [1, 2, 3].map(|k| arms[if k <= i { k - 1 } else { k }]);
            let rest: i128 = (0..3).map(|a| i128::from(q[a]) * i128::from(r.cross(s)[a])).sum();
            i128::from(arms[i].dot(arms[i])) * if i.is_multiple_of(2) { rest } else { -rest }
        };
        (0..4).map(term).sum::<i128>().signum() as f64
    }
}

/// What makes whole numbers of all differences, if they share a grid of few bits.
fn grid(points: &[DVec3]) -> Option<f64> {
    let coordinates = points.iter().flat_map(|p| p.to_array()).filter(|v| *v != 0.0);
    // The exponent of the last bit set. No `f32` is subnormal as an `f64`.
    let last_bit = |v: f64| {
        ((v.to_bits() >> 52 & 0x7ff) as i32) - 1075
            + (v.to_bits() & ((1 << 52) - 1) | 1 << 52).trailing_zeros() as i32
    };
    // The finest of all last bits is the step of the grid; its inverse is a power of two, so products with it
    // are exact.
    let exponent = coordinates.map(last_bit).min()?;
    let scale = f64::from_bits(((1023 - exponent) as u64) << 52);
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    ((high - low).max_element() * scale < GRID_BITS).then_some(scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::dice::Dice;

    #[test]
    fn signs_are_those_of_exact_expansions() {
        let mut dice = Dice::new(3);
        let (mut ties, mut inside) = (0, 0);
        for case in 0..6000 {
            // Small grids, where ties abound; large ones; numbers of very different size; and no grid at all.
            let mut number = || {
                let v = dice.bits();
                match case % 4 {
                    0 => f64::from(v % 4) - 2.0,
                    1 => f64::from(v >> 8) * 0.125,
                    2 => f64::from(
                        (v & 0xffff) as f32 * (f64::from((v >> 16) as i32 % 200 - 100).exp2() as f32),
                    ),
                    _ => f64::from(v as f32 * 1.0e-9),
                }
            };
            let points: Vec<DVec3> = (0..5).map(|_| DVec3::new(number(), number(), number())).collect();
            let [a, b, c, d, e] = std::array::from_fn(|i| points[i]);
            let signs = Signs::new(points);
            assert!(signs.grid.is_some() || case % 4 > 1);
            let orient = orient3d(a, b, c, d);
            assert_eq!(sign(signs.orient([0, 1, 2], 3)), sign(orient), "case {case}");
            if orient == 0.0 {
                continue;
            }
            let (order, want) = if orient > 0.0 {
                ([0, 1, 2, 3], insphere(a, b, c, d, e))
            } else {
                ([0, 2, 1, 3], insphere(a, c, b, d, e))
            };
            assert_eq!(sign(signs.insphere(order, 4)), sign(want), "case {case}");
            ties += u32::from(want == 0.0);
            inside += u32::from(want > 0.0);
        }
        assert!(ties > 100 && inside > 100, "{ties} ties, {inside} inside");
    }
    fn sign(v: f64) -> i8 {
        i8::from(v > 0.0) - i8::from(v < 0.0)
    }

    #[test]
    fn the_sphere_through_a_unit_tetrahedron() {
        let points = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 1], [2, 2, 2], [3, 3, 3]];
        let signs = Signs::new(points.map(|p| glam::IVec3::from(p).as_dvec3()).to_vec());
        assert!(
            signs.orient([0, 1, 2], 3) > 0.0
                && signs.orient([0, 2, 1], 3) < 0.0
                && signs.orient([0, 1, 2], 2) == 0.0
        );
        assert!(signs.insphere([0, 1, 2, 3], 4) > 0.0, "its center is inside");
        assert!(signs.insphere([0, 1, 2, 3], 5) == 0.0, "the far corner of the cube is on it");
        assert!(signs.insphere([0, 1, 2, 3], 6) < 0.0);
    }
}
