//! Boxes, cushions, cylinders and balls, and the mesh they are collected in.
//!
//! Each is convex, and its quads are turned to face away from its center. The tessellation follows from one
//! number `detail ≥ 1`; the number of triangles grows with its square. A counting sink makes the same calls
//! and keeps nothing, so that a generator can find the detail that meets a budget.

use glam::DVec3;

pub(super) use crate::scene::circle::circle;
use crate::scene::mesh::{Mesh, RawFace};
use crate::scene::{Material, Object};

/// Where shapes go: into a mesh, or only into a count.
pub(super) struct Sink {
    mesh: Option<Mesh>,
    /// Triangles so far.
    pub(super) triangles: u64,
    object: u32,
    material: u32,
}

impl Sink {
    pub(super) fn counting() -> Self {
        Self { mesh: None, triangles: 0, object: 0, material: 0 }
    }
    pub(super) fn keeping(materials: &[(&str, [f32; 3])]) -> Self {
        let materials = materials.iter().map(|(name, color)| Material::new(*name, *color)).collect();
        Self { mesh: Some(Mesh { materials, ..Mesh::default() }), triangles: 0, object: 0, material: 0 }
    }
    pub(super) fn into_mesh(self) -> Mesh {
        self.mesh.unwrap_or_default()
    }
    /// What follows belongs to a new object. The name is only made where it is kept.
    pub(super) fn begin(&mut self, name: impl FnOnce() -> (String, String)) {
        if let Some(mesh) = &mut self.mesh {
            let (name, group) = name();
            self.object = mesh.objects.len() as u32;
            mesh.objects.push(Object { name, group, motion: None });
        }
    }
    /// What follows is made of this material (its place in the list given at the start).
    pub(super) fn paint(&mut self, material: u32) {
        self.material = material;
    }
    /// A convex planar polygon, turned so that its normal points along `outward`.
    pub(super) fn face(&mut self, corners: &[DVec3], outward: DVec3) {
        let turned = self.mesh.is_some() && crate::scene::polygon::newell(corners).dot(outward) < 0.0;
        self.push(corners, turned);
    }
    /// The same, but its fan begins at the first corner whichever way it is turned.
    pub(super) fn fan(&mut self, corners: &mut [DVec3], outward: DVec3) {
        if crate::scene::polygon::newell(corners).dot(outward) < 0.0 {
            corners[1..].reverse();
        }
        self.push(corners, false);
    }
    fn push(&mut self, corners: &[DVec3], turned: bool) {
        let ids = corners.len() as u32 - 2;
        self.triangles += u64::from(ids);
        let Some(mesh) = &mut self.mesh else { return };
        let first = mesh.points.len() as u32;
        mesh.points.extend_from_slice(corners);
        let numbers = first..first + corners.len() as u32;
        if turned {
            mesh.corners.extend(numbers.rev());
        } else {
            mesh.corners.extend(numbers);
        }
        let end = mesh.corners.len() as u32;
        mesh.faces.push(RawFace { end, ids, object: self.object, material: self.material, lost: None });
    }
}

/// Where a piece stands: local (right, up, away) to world, by a turn around the vertical or a mirror.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) origin: DVec3,
    pub(super) right: DVec3,
    pub(super) away: DVec3,
}

impl Frame {
    pub(super) fn at(&self, p: [f64; 3]) -> DVec3 {
        self.origin + self.right * p[0] + DVec3::Y * p[1] + self.away * p[2]
    }
    /// The same axes around another point.
    pub(super) fn moved(&self, p: [f64; 3]) -> Self {
        Self { origin: self.at(p), ..*self }
    }
}

/// The cells of a piece that has `cells` at detail 4, in proportion: steps of detail small enough to meet a
/// budget closely.
pub(super) fn parts(cells: u32, detail: u32) -> u32 {
    (cells * detail).div_ceil(4)
}

/// The six sides of a cube: an axis, and the two others.
const SIDES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// A box between two local corners: 12 triangles.
pub(super) fn block(sink: &mut Sink, frame: &Frame, low: [f64; 3], high: [f64; 3]) {
    rounded(sink, frame, low, high, 1, 0.0);
}

/// A box of `cells`² quads a side, its points pulled towards a ball by `roundness` of 0..1.
pub(super) fn rounded(
    sink: &mut Sink,
    frame: &Frame,
    low: [f64; 3],
    high: [f64; 3],
    cells: u32,
    roundness: f64,
) {
    let place = |unit: DVec3| {
        let p = unit * (1.0 - roundness) + unit.normalize() * roundness;
        frame.at(std::array::from_fn(|a| low[a] + (high[a] - low[a]) * (p[a] * 0.5 + 0.5)))
    };
    let center = place_center(frame, low, high);
    let step = |i: u32| 2.0 * f64::from(i) / f64::from(cells) - 1.0;
    for [axis, u, v] in SIDES {
        for side in [-1.0, 1.0] {
            let point = |i: u32, j: u32| {
                let mut unit = DVec3::ZERO;
                (unit[axis], unit[u], unit[v]) = (side, step(i), step(j));
                place(unit)
            };
            for i in 0..cells {
                for j in 0..cells {
                    let quad = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                    patch(sink, &quad, center, roundness > 0.0);
                }
            }
        }
    }
}

fn place_center(frame: &Frame, low: [f64; 3], high: [f64; 3]) -> DVec3 {
    frame.at(std::array::from_fn(|a| (low[a] + high[a]) * 0.5))
}

/// A quad facing away from `center`; a bent one as two triangles.
fn patch(sink: &mut Sink, quad: &[DVec3; 4], center: DVec3, bent: bool) {
    let outward = (quad[0] + quad[2]) * 0.5 - center;
    if bent {
        sink.face(&[quad[0], quad[1], quad[2]], outward);
        sink.face(&[quad[0], quad[2], quad[3]], outward);
    } else {
        sink.face(quad, outward);
    }
}

/// An upright cylinder or cone frustum: `sides` quads around, `stacks` up, and two caps.
pub(super) fn tube(sink: &mut Sink, frame: &Frame, height: f64, radii: [f64; 2], sides: u32, stacks: u32) {
    let ring = |level: u32| -> Vec<DVec3> {
        let t = f64::from(level) / f64::from(stacks);
        let radius = radii[0] + (radii[1] - radii[0]) * t;
        (0..sides)
            .map(|k| circle(k, sides))
            .map(|(c, s)| frame.at([c * radius, height * t, s * radius]))
            .collect()
    };
    let mut below = ring(0);
    sink.face(&below, -DVec3::Y);
    for level in 1..=stacks {
        let above = ring(level);
        let center = frame.at([0.0, height * (f64::from(level) - 0.5) / f64::from(stacks), 0.0]);
        for k in 0..sides as usize {
            let next = (k + 1) % sides as usize;
            patch(sink, &[below[k], below[next], above[next], above[k]], center, true);
        }
        below = above;
    }
    sink.face(&below, DVec3::Y);
}

/// A ball of `around` by `rows` cells, scaled per axis.
pub(super) fn ball(sink: &mut Sink, frame: &Frame, radii: [f64; 3], around: u32, rows: u32) {
    let center = frame.at([0.0; 3]);
    let point = |i: u32, k: u32| {
        let (up, out) = circle(i, 2 * rows);
        let (c, s) = circle(k % around, around);
        frame.at([radii[0] * out * c, radii[1] * up, radii[2] * out * s])
    };
    for i in 0..rows {
        for k in 0..around {
            let quad = [point(i, k), point(i, k + 1), point(i + 1, k + 1), point(i + 1, k)];
            let outward = (quad[0] + quad[2]) * 0.5 - center;
            match i {
                0 => sink.face(&[quad[0], quad[2], quad[3]], outward),
                _ if i + 1 == rows => sink.face(&quad[..3], outward),
                _ => patch(sink, &quad, center, true),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_shapes_enclose_their_volume_and_count_what_they_keep() {
        let frame = Frame { origin: DVec3::new(1.0, 2.0, 3.0), right: -DVec3::Z, away: DVec3::X };
        type Shape = fn(&mut Sink, &Frame);
        let shapes: [(Shape, f64); 4] = [
            (|s, f| block(s, f, [0.0, 0.0, 0.0], [1.0, 2.0, 3.0]), 6.0),
            (|s, f| rounded(s, f, [0.0; 3], [1.0; 3], 4, 0.0), 1.0),
            (|s, f| tube(s, f, 2.0, [1.0, 1.0], 256, 3), 2.0 * std::f64::consts::PI),
            (|s, f| ball(s, f, [1.0; 3], 128, 64), 4.0 / 3.0 * std::f64::consts::PI),
        ];
        for (shape, want) in shapes {
            let (mut kept, mut counted) = (Sink::keeping(&[("m", [1.0; 3])]), Sink::counting());
            kept.begin(|| ("a".into(), "b".into()));
            shape(&mut kept, &frame);
            shape(&mut counted, &frame);
            assert_eq!(kept.triangles, counted.triangles);
            let mesh = kept.into_mesh();
            let (mut volume, mut start) = (0.0, 0);
            for face in &mesh.faces {
                let corner = |k: usize| mesh.points[mesh.corners[k] as usize];
                for k in start + 1..face.end as usize - 1 {
                    volume += corner(start).dot(corner(k).cross(corner(k + 1))) / 6.0;
                }
                start = face.end as usize;
            }
            assert!((volume - want).abs() < 2e-3 * want, "{volume} instead of {want}");
        }
    }
}
