//! From polygons with 64-bit points, as readers and generators make them, to the tables of a scene.
//!
//! In order: recenter, round to 32 bits, merge identical points, cut polygons into triangles, drop what
//! cannot be drawn. Each dropped triangle keeps its id. Cost: O(n log n) for n points (a sort), O(n) else.

use glam::{DVec3, Vec3};

use super::merge::merge_coplanar;
use super::polygon::{Cutter, Shape};
use super::{Dropped, Face, LoadOptions, Material, Object, Parts, Progress, Recenter, Report, SceneError};
use crate::geometry::{MaterialId, ObjectId, PrimId, Solid};

/// Greatest magnitude of a coordinate, world units: a product of three of them still fits 32 bits.
pub const MAX_COORDINATE: f64 = 1e12;
/// Most primitives of a scene: ids and three corners each must stay countable in 32 bits.
pub const MAX_PRIMS: usize = 1 << 29;

/// Corners of a polygon that take long enough to ask first whether anybody still waits.
const LONG_WORK: usize = 4_096;

/// A face of the source, in file order.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawFace {
    /// Past its last corner in [`Mesh::corners`]; it begins where the one before ends.
    pub(super) end: u32,
    /// Triangle ids that it takes: n − 2 of its n corners in the source.
    pub(super) ids: u32,
    pub(super) object: u32,
    pub(super) material: u32,
    /// Why it is not there; then it has no corners.
    pub(super) lost: Option<Dropped>,
}

/// Polygons over shared points.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) points: Vec<DVec3>,
    pub(super) corners: Vec<u32>,
    pub(super) faces: Vec<RawFace>,
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
}

impl Mesh {
    /// Adds a face of these corners.
    pub(super) fn push(&mut self, corners: &[u32], object: u32, material: u32) {
        self.corners.extend_from_slice(corners);
        let ids = (corners.len() as u32).saturating_sub(2);
        self.faces.push(RawFace { end: self.corners.len() as u32, ids, object, material, lost: None });
    }
    /// Adds a face that is not there but takes ids.
    pub(super) fn push_lost(&mut self, ids: u32, object: u32, material: u32, why: Dropped) {
        self.faces.push(RawFace { end: self.corners.len() as u32, ids, object, material, lost: Some(why) });
    }
}

/// Makes the tables of a scene out of a mesh. `name` and `source` as in [`Parts`].
pub(super) fn assemble(
    mesh: Mesh,
    name: &str,
    source: &str,
    options: &LoadOptions,
    mut report: Report,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let count: usize = mesh.faces.iter().map(|f| f.ids as usize).sum();
    if count > MAX_PRIMS {
        return Err(SceneError::Format {
            path: source.to_owned(),
            why: format!("{count} triangles are more than the limit of {MAX_PRIMS}"),
        });
    }
    let origin = choose_origin(&mesh.points, options.recenter);
    if origin != DVec3::ZERO {
        report.note(format!(
            "recentered: ({}, {}, {}) was subtracted from all coordinates",
            origin.x, origin.y, origin.z
        ));
    }
    let (mut points, usable) = round(&mesh.points, origin);
    let same_as = if options.weld { weld(&points, &usable) } else { (0..points.len() as u32).collect() };
    let mut cut = Cut { prims: Vec::with_capacity(count), ..Cut::default() };
    let mut start = 0;
    for (k, face) in mesh.faces.iter().enumerate() {
        if k % 65_536 == 0 {
            progress.report(k as f32 / mesh.faces.len() as f32, "cutting polygons");
            if progress.cancelled() {
                return Err(SceneError::Cancelled(source.to_owned()));
            }
        }
        let corners = &mesh.corners[start..face.end as usize];
        start = face.end as usize;
        if corners.len() > LONG_WORK && progress.cancelled() {
            return Err(SceneError::Cancelled(source.to_owned()));
        }
        if !cut.face(face, corners, &points, &usable, &same_as, options) {
            report.note(format!(
                "a concave polygon of {} corners is too long to be cut, so it was left out",
                corners.len()
            ));
        }
    }
    let Cut { mut prims, prim_object, prim_material, mut faces, dropped, .. } = cut;
    dropped.into_iter().for_each(|(why, count)| report.drop(why, count));
    let merged = compact(&mut points, &mut prims, &mut faces);
    if options.weld && merged > 0 {
        report.merged_points = mesh.points.len() - points.len();
    }
    let mut parts = Parts {
        name: name.to_owned(),
        source: source.to_owned(),
        points,
        prims,
        prim_object,
        prim_material,
        faces,
        objects: mesh.objects,
        materials: mesh.materials,
        origin,
        paths: Vec::new(),
        report,
    };
    if options.merge_coplanar {
        merge_coplanar(&mut parts, progress);
    }
    Ok(parts)
}

/// What to subtract: nothing, unless the middle is farther away than [`FAR`] times the extent, where 32-bit
/// coordinates would lose detail. Rounded, so that short decimals stay short.
fn choose_origin(points: &[DVec3], recenter: Recenter) -> DVec3 {
    /// At 16 extents from the origin, 4 of the 24 bits of a coordinate are spent on the distance.
    const FAR: f64 = 16.0;
    if recenter == Recenter::Never {
        return DVec3::ZERO;
    }
    let usable = points.iter().filter(|p| p.abs().max_element() <= MAX_COORDINATE);
    let (low, high) = usable.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (center, extent) = ((low + high) * 0.5, (high - low).max_element());
    if !center.is_finite()
        || extent <= 0.0
        || (recenter == Recenter::Auto && center.abs().max_element() <= FAR * extent)
    {
        return DVec3::ZERO;
    }
    // The power of two at or below the extent: the exponent bits alone.
    let grid = f64::from_bits(extent.to_bits() & 0x7ff0_0000_0000_0000);
    let origin = (center / grid).round() * grid;
    if origin.is_finite() { origin } else { DVec3::ZERO }
}

/// 32-bit points, and which of them may be used. `+ 0.0` turns −0 into 0, so that equal points have equal
/// bits.
fn round(points: &[DVec3], origin: DVec3) -> (Vec<Vec3>, Vec<bool>) {
    let rounded = points.iter().map(|p| {
        let p = *p - origin;
        let usable = p.abs().max_element() <= MAX_COORDINATE && p.is_finite();
        (if usable { p.as_vec3() + Vec3::ZERO } else { Vec3::ZERO }, usable)
    });
    rounded.unzip()
}

/// For each point the least index of a point at the same place. Sorts indices, for the same answer
/// everywhere.
fn weld(points: &[Vec3], usable: &[bool]) -> Vec<u32> {
    let key = |i: u32| points[i as usize].to_array().map(f32::to_bits);
    let mut same_as: Vec<u32> = (0..points.len() as u32).collect();
    let mut order: Vec<u32> = same_as.iter().copied().filter(|i| usable[*i as usize]).collect();
    order.sort_unstable_by_key(|i| (key(*i), *i));
    for run in order.chunk_by(|a, b| key(*a) == key(*b)) {
        run.iter().for_each(|i| same_as[*i as usize] = run[0]);
    }
    same_as
}

/// The tables that grow face by face.
#[derive(Default)]
struct Cut {
    prims: Vec<Option<[u32; 3]>>,
    prim_object: Vec<ObjectId>,
    prim_material: Vec<MaterialId>,
    faces: Vec<Face>,
    dropped: Vec<(Dropped, usize)>,
    cutter: Cutter,
    ring: Vec<u32>,
    ring_points: Vec<DVec3>,
}

impl Cut {
    /// Adds the triangles of a face; `false` if it is too long to be cut.
    fn face(
        &mut self,
        face: &RawFace,
        corners: &[u32],
        points: &[Vec3],
        usable: &[bool],
        same_as: &[u32],
        options: &LoadOptions,
    ) -> bool {
        let first = self.prims.len();
        let end = first + face.ids as usize;
        self.prim_object.resize(end, ObjectId(face.object));
        self.prim_material.resize(end, MaterialId(face.material));
        let lost =
            face.lost.or_else(|| corners.iter().any(|c| !usable[*c as usize]).then_some(Dropped::NotFinite));
        if let Some(why) = lost {
            self.prims.resize(end, None);
            self.dropped.push((why, face.ids as usize));
            return true;
        }
        self.ring.clear();
        self.ring.extend(corners.iter().map(|c| same_as[*c as usize]));
        if let [a, b, c] = self.ring[..] {
            let triangle = [a, b, c];
            self.push_triangle(triangle, points, options);
            return true;
        }
        self.ring_points.clear();
        self.ring_points.extend(self.ring.iter().map(|c| points[*c as usize].as_dvec3()));
        let shape = self.cutter.cut(&self.ring_points);
        let triangles = std::mem::take(&mut self.cutter.triangles);
        for t in triangles.as_chunks::<3>().0 {
            let triangle = t.map(|i| self.ring[i as usize]);
            self.push_triangle(triangle, points, options);
        }
        self.cutter.triangles = triangles;
        // Ear clipping leaves out corners on a straight border: fewer triangles, the same shape.
        let missing = end - self.prims.len();
        self.prims.resize(end, None);
        if missing > 0 {
            let why = if shape == Shape::TooLong { Dropped::Malformed } else { Dropped::Degenerate };
            self.dropped.push((why, missing));
        }
        if shape == Shape::Convex {
            self.push_face(first, end);
        }
        shape != Shape::TooLong
    }

    fn push_triangle(&mut self, corners: [u32; 3], points: &[Vec3], options: &LoadOptions) {
        let keep = !options.drop_degenerate || has_area(corners.map(|c| points[c as usize]));
        self.prims.push(keep.then_some(corners));
        if !keep {
            self.dropped.push((Dropped::Degenerate, 1));
        }
    }

    fn push_face(&mut self, first: usize, end: usize) {
        let mut corners = self.ring.clone();
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let prims: Vec<PrimId> =
            (first..end).filter(|p| self.prims[*p].is_some()).map(|p| PrimId(p as u32)).collect();
        if corners.len() > 3 && prims.len() > 1 {
            self.faces.push(Face { corners, prims });
        }
    }
}

/// Whether a triangle has an area that 32-bit arithmetic can see: the exact products decide, and its
/// 32-bit normal must not have vanished.
pub(super) fn has_area(p: [Vec3; 3]) -> bool {
    let [a, b, c] = p.map(Vec3::as_dvec3);
    (b - a).cross(c - a) != DVec3::ZERO && (p[1] - p[0]).cross(p[2] - p[0]) != Vec3::ZERO
}

/// Leaves out points that nothing uses, in order; returns how many went.
fn compact(points: &mut Vec<Vec3>, prims: &mut [Option<[u32; 3]>], faces: &mut [Face]) -> usize {
    let mut used = vec![false; points.len()];
    prims
        .iter()
        .flatten()
        .flatten()
        .chain(faces.iter().flat_map(|f| &f.corners))
        .for_each(|c| used[*c as usize] = true);
    let before = points.len();
    let mut to = vec![0u32; before];
    let mut next = 0;
    for (i, keep) in used.into_iter().enumerate() {
        if keep {
            points[next as usize] = points[i];
            to[i] = next;
            next += 1;
        }
    }
    points.truncate(next as usize);
    points.shrink_to_fit();
    prims
        .iter_mut()
        .flatten()
        .flatten()
        .chain(faces.iter_mut().flat_map(|f| &mut f.corners))
        .for_each(|c| *c = to[*c as usize]);
    before - points.len()
}
