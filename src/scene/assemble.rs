//! From polygons with 64-bit points, as readers and generators make them, to the tables of a scene.
//!
//! In order: recenter, round to 32 bits, merge identical points, cut polygons into triangles, drop what
//! cannot be drawn. Each dropped triangle keeps its id. Cost: O(n).

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::merge::merge_coplanar;
use super::polygon::{Cutter, Shape, turn_edges};
use super::{
    Dropped, Face, LoadOptions, Material, Object, Parts, Progress, Recenter, Report, SceneError, palette,
};
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
    /// Color at each point, 0..1 ([`Mesh::NO_COLOR`] where there is none); empty if no point has one.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) corners: Vec<u32>,
    pub(super) faces: Vec<RawFace>,
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
}

impl Mesh {
    /// A point without a color.
    pub(super) const NO_COLOR: [f32; 3] = [f32::NAN; 3];

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
    mut mesh: Mesh,
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
    if !mesh.colors.is_empty() {
        palette::paint(&mut mesh, &mut report);
    }
    let stopped = || SceneError::Cancelled(source.to_owned());
    progress.report(0.0, "choosing the origin");
    let origin = choose_origin(&mesh, options.recenter, progress).ok_or_else(stopped)?;
    if origin != DVec3::ZERO {
        report.note(format!(
            "recentered: ({}, {}, {}) was subtracted from all coordinates",
            origin.x, origin.y, origin.z
        ));
    }
    let (mut points, usable) = round(&mesh.points, origin);
    progress.report(0.1, "merging points");
    let same_as = if options.weld {
        weld(&points, &usable, progress).ok_or_else(stopped)?
    } else {
        (0..points.len() as u32).collect()
    };
    let mut cut = Cut { prims: Vec::with_capacity(count), ..Cut::default() };
    let source_of = Source { mesh: &mesh, points: &points, usable: &usable, same_as: &same_as, options };
    let mut start = 0;
    for (k, face) in mesh.faces.iter().enumerate() {
        if k % 65_536 == 0 {
            progress.report(0.2 + 0.8 * k as f32 / mesh.faces.len() as f32, "cutting polygons");
            if progress.cancelled() {
                return Err(stopped());
            }
        }
        let corners = &mesh.corners[start..face.end as usize];
        start = face.end as usize;
        if corners.len() > LONG_WORK && progress.cancelled() {
            return Err(stopped());
        }
        if !cut.face(face, corners, &source_of) {
            let count = corners.len();
            report.note_each("polygon: too long", format_args!("{count} corners"), || {
                format!("a concave polygon of {count} corners is too long to be cut, so it was left out")
            });
        }
    }
    let spoiled = spoiled(&mesh, origin, progress).ok_or_else(stopped)?;
    if spoiled > 0 {
        let lost = cut.dropped.get(&Dropped::Rounded).copied().unwrap_or(0);
        report.note(price(&mesh.points, origin, spoiled, lost));
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

/// What to subtract: nothing, unless 32-bit coordinates would lose detail. `None` when cancelled.
///
/// A model whose middle is farther away than [`FAR`] times its extent goes to the origin as a whole. Else, if
/// there are faces that rounding spoils, the middle of the bounds and the median of the faces are tried (the
/// median is where most of a model is that has a marker or another site far off), and what spoils the fewest
/// is taken if that saves more than one face in [`WORTH`]. Rounded, so that short decimals stay short.
fn choose_origin(mesh: &Mesh, recenter: Recenter, progress: &dyn Progress) -> Option<DVec3> {
    /// At 16 extents from the origin, 4 of the 24 bits of a coordinate are spent on the distance.
    const FAR: f64 = 16.0;
    const WORTH: usize = 100;
    if recenter == Recenter::Never {
        return Some(DVec3::ZERO);
    }
    let usable = mesh.points.iter().filter(|p| p.abs().max_element() <= MAX_COORDINATE);
    let (low, high) = usable.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (center, extent) = ((low + high) * 0.5, (high - low).max_element());
    if !center.is_finite() || extent <= 0.0 {
        return Some(DVec3::ZERO);
    }
    let middle = on_grid(center, extent);
    if recenter == Recenter::Always || center.abs().max_element() > FAR * extent {
        return Some(middle);
    }
    let lost = spoiled(mesh, DVec3::ZERO, progress)?;
    if lost * WORTH < mesh.faces.len() || lost == 0 {
        return Some(DVec3::ZERO);
    }
    let mut best = (lost, DVec3::ZERO);
    for origin in [middle, median(mesh)] {
        let count = spoiled(mesh, origin, progress)?;
        if count < best.0 {
            best = (count, origin);
        }
    }
    let saved = lost - best.0;
    Some(if saved > 0 && saved * WORTH >= mesh.faces.len() { best.1 } else { DVec3::ZERO })
}

/// A point on a grid as wide as the power of two at or below `width`: the exponent bits alone.
fn on_grid(point: DVec3, width: f64) -> DVec3 {
    let grid = f64::from_bits(width.to_bits() & 0x7ff0_0000_0000_0000);
    let point = (point / grid).round() * grid;
    if point.is_finite() { point } else { DVec3::ZERO }
}

/// The corners of each face, in order.
fn rings(mesh: &Mesh) -> impl Iterator<Item = &[u32]> {
    let mut start = 0;
    mesh.faces.iter().map(move |face| {
        let ring = &mesh.corners[start..face.end as usize];
        start = face.end as usize;
        ring
    })
}

/// The median of the faces' first corners, an axis at a time; on a grid of 64 extents of the face next to it.
fn median(mesh: &Mesh) -> DVec3 {
    let at = |c: u32| mesh.points[c as usize];
    let firsts = rings(mesh).filter_map(|ring| ring.first().map(|c| at(*c)));
    let mut firsts: Vec<DVec3> = firsts.filter(|p| p.abs().max_element() <= MAX_COORDINATE).collect();
    if firsts.is_empty() {
        return DVec3::ZERO;
    }
    let half = firsts.len() / 2;
    let middle = DVec3::from_array([0, 1, 2].map(|axis| {
        firsts.select_nth_unstable_by(half, |a, b| a[axis].total_cmp(&b[axis]));
        firsts[half][axis]
    }));
    let near = rings(mesh)
        .filter(|ring| !ring.is_empty())
        .min_by(|a, b| {
            let distance = |ring: &[u32]| at(ring[0]).distance_squared(middle);
            distance(a).total_cmp(&distance(b))
        })
        .unwrap_or_default();
    let extent = near.iter().map(|c| (at(*c) - at(near[0])).abs().max_element()).fold(0.0, f64::max);
    if extent > 0.0 { on_grid(middle, 64.0 * extent) } else { middle }
}

/// How many faces rounding to 32 bits relative to `origin` spoils. `None` when cancelled.
fn spoiled(mesh: &Mesh, origin: DVec3, progress: &dyn Progress) -> Option<usize> {
    let mut count = 0;
    for (k, ring) in rings(mesh).enumerate() {
        if k % 65_536 == 0 && progress.cancelled() {
            return None;
        }
        count += usize::from(is_spoiled(ring, |c| mesh.points[c as usize] - origin));
    }
    Some(count)
}

/// Whether the vector area of a polygon changes by more than an eighth when its corners are rounded to 32
/// bits.
fn is_spoiled(ring: &[u32], place: impl Fn(u32) -> DVec3) -> bool {
    let &[first, second, _, ..] = ring else { return false };
    let (start, rounded) = (place(first), place(first).as_vec3().as_dvec3());
    let sides = |c: u32| (place(c) - start, place(c).as_vec3().as_dvec3() - rounded);
    let mut before = sides(second);
    let (mut exact, mut found) = (DVec3::ZERO, DVec3::ZERO);
    for &corner in &ring[2..] {
        let next = sides(corner);
        exact += before.0.cross(next.0);
        found += before.1.cross(next.1);
        before = next;
    }
    64.0 * (found - exact).length_squared() > exact.length_squared()
}

/// What rounding costs, in words.
fn price(points: &[DVec3], origin: DVec3, spoiled: usize, lost: usize) -> String {
    let usable = points.iter().map(|p| *p - origin).filter(|p| p.abs().max_element() <= MAX_COORDINATE);
    let shift = |p: DVec3| (p.as_vec3().as_dvec3() - p).abs().max_element();
    let greatest = usable.map(shift).fold(0.0, f64::max);
    // One digit that is not zero.
    let digits = (-greatest.max(1e-30).log10()).ceil().max(0.0) as usize;
    format!(
        "rounding to 32 bits moves points by up to {greatest:.digits$} units; it changes the area of \
         {spoiled} faces by more than an eighth, and {lost} triangles are lost by it"
    )
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

/// For each point the least index of a point at the same place. `None` when cancelled.
///
/// An open hash table that is filled in order, so the answer is the same everywhere. Should its places be
/// taken so often that somebody must have meant it, the indices are sorted instead.
fn weld(points: &[Vec3], usable: &[bool], progress: &dyn Progress) -> Option<Vec<u32>> {
    const NONE: u32 = u32::MAX;
    let key = |i: u32| points[i as usize].to_array().map(f32::to_bits);
    let mut same_as: Vec<u32> = (0..points.len() as u32).collect();
    let bits = (points.len() * 2).next_power_of_two().trailing_zeros().max(1);
    let mut table = vec![NONE; 1 << bits];
    let mut steps_left = 64 * points.len() + 4096;
    for i in 0..points.len() as u32 {
        if i % 65_536 == 0 && progress.cancelled() {
            return None;
        }
        if !usable[i as usize] {
            continue;
        }
        let [x, y, z] = key(i);
        // Multiplied by large odd numbers, so that the high bits depend on all.
        let mixed = (u64::from(x) | u64::from(y) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ u64::from(z).wrapping_mul(0xc2b2_ae3d_27d4_eb4f).rotate_left(31);
        let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mut at = (mixed >> (64 - bits)) as usize;
        while table[at] != NONE && key(table[at]) != [x, y, z] {
            at = (at + 1) & (table.len() - 1);
            steps_left -= 1;
            if steps_left == 0 {
                return Some(weld_by_sorting(points, usable));
            }
        }
        if table[at] == NONE {
            table[at] = i;
        }
        same_as[i as usize] = table[at];
    }
    Some(same_as)
}

fn weld_by_sorting(points: &[Vec3], usable: &[bool]) -> Vec<u32> {
    let key = |i: u32| points[i as usize].to_array().map(f32::to_bits);
    let mut same_as: Vec<u32> = (0..points.len() as u32).collect();
    let mut order: Vec<u32> = same_as.iter().copied().filter(|i| usable[*i as usize]).collect();
    order.sort_unstable_by_key(|i| (key(*i), *i));
    for run in order.chunk_by(|a, b| key(*a) == key(*b)) {
        run.iter().for_each(|i| same_as[*i as usize] = run[0]);
    }
    same_as
}

/// What faces are made of.
struct Source<'a> {
    mesh: &'a Mesh,
    /// Rounded to 32 bits.
    points: &'a [Vec3],
    usable: &'a [bool],
    same_as: &'a [u32],
    options: &'a LoadOptions,
}

impl Source<'_> {
    /// Why a triangle of these corners of the source has no area that 32-bit arithmetic can see.
    fn why_flat(&self, corners: [u32; 3]) -> Dropped {
        let [a, b, c] = corners.map(|i| self.mesh.points[i as usize]);
        let (u, v) = (b - a, c - a);
        // What decimals lose on their way to 64 bits, twice over.
        let size = a.abs().max(b.abs()).max(c.abs()).max_element();
        let noise = 4.0 * f64::EPSILON * size * (u.abs().max_element() + v.abs().max_element());
        if u.cross(v).abs().max_element() <= noise { Dropped::Degenerate } else { Dropped::Rounded }
    }
}

/// The tables that grow face by face.
#[derive(Default)]
struct Cut {
    prims: Vec<Option<[u32; 3]>>,
    prim_object: Vec<ObjectId>,
    prim_material: Vec<MaterialId>,
    faces: Vec<Face>,
    dropped: BTreeMap<Dropped, usize>,
    cutter: Cutter,
    ring: Vec<u32>,
    ring_points: Vec<DVec3>,
}

impl Cut {
    /// Adds the triangles of a face; `false` if it is too long to be cut.
    fn face(&mut self, face: &RawFace, corners: &[u32], source: &Source) -> bool {
        let first = self.prims.len();
        let end = first + face.ids as usize;
        self.prim_object.resize(end, ObjectId(face.object));
        self.prim_material.resize(end, MaterialId(face.material));
        let unusable = || corners.iter().find(|c| !source.usable[**c as usize]);
        let lost = face.lost.or_else(|| {
            let point = source.mesh.points[*unusable()? as usize];
            Some(if point.is_finite() { Dropped::TooFar } else { Dropped::NotFinite })
        });
        if let Some(why) = lost {
            self.prims.resize(end, None);
            *self.dropped.entry(why).or_default() += face.ids as usize;
            return true;
        }
        self.ring.clear();
        self.ring.extend(corners.iter().map(|c| source.same_as[*c as usize]));
        if let [a, b, c] = self.ring[..] {
            self.push_triangle([a, b, c], || [corners[0], corners[1], corners[2]], source);
            return true;
        }
        self.ring_points.clear();
        self.ring_points.extend(self.ring.iter().map(|c| source.points[*c as usize].as_dvec3()));
        let shape = self.cutter.cut(&self.ring_points);
        let mut triangles = std::mem::take(&mut self.cutter.triangles);
        let ring = &self.ring;
        turn_edges(triangles.as_chunks_mut::<3>().0, &self.ring_points, |t| {
            has_area(t.map(|i| source.points[ring[i as usize] as usize]))
        });
        for t in triangles.as_chunks::<3>().0 {
            let triangle = t.map(|i| self.ring[i as usize]);
            self.push_triangle(triangle, || t.map(|i| corners[i as usize]), source);
        }
        self.cutter.triangles = triangles;
        // A border that goes back along itself spans fewer triangles.
        let missing = end - self.prims.len();
        self.prims.resize(end, None);
        if missing > 0 {
            let why = if shape == Shape::TooLong { Dropped::TooLong } else { Dropped::Degenerate };
            *self.dropped.entry(why).or_default() += missing;
        }
        if shape == Shape::Convex {
            self.push_face(first, end);
        }
        shape != Shape::TooLong
    }

    /// `of` tells the corners in the source.
    fn push_triangle(&mut self, corners: [u32; 3], of: impl FnOnce() -> [u32; 3], source: &Source) {
        let keep = !source.options.drop_degenerate || has_area(corners.map(|c| source.points[c as usize]));
        self.prims.push(keep.then_some(corners));
        if !keep {
            *self.dropped.entry(source.why_flat(of())).or_default() += 1;
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
