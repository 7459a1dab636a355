//! From polygons with 64-bit points, as readers and generators make them, to the tables of a scene.
//!
//! In order: recenter, round to 32 bits, merge identical points, cut polygons into triangles, drop what
//! cannot be drawn. Each dropped triangle keeps its id. Cost: O(n).

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::merge::merge_coplanar;
use super::mesh::{Mesh, RawFace};
use super::polygon::{Cutter, Shape, turn_edges};
use super::rounding::{choose_origin, price, round, spoiled};
use super::{Dropped, Face, LoadOptions, Parts, Progress, Report, SceneError};
use crate::geometry::{MaterialId, ObjectId, PrimId, Solid};

/// Most primitives of a scene: ids and three corners each must stay countable in 32 bits.
pub const MAX_PRIMS: usize = 1 << 29;

/// Corners of a polygon that take long enough to ask first whether anybody still waits.
const LONG_WORK: usize = 4_096;

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
    let taken = Source { mesh: &mesh, points: &points, usable: &usable, same_as: &same_as, options };
    let cut = Cut::all(&taken, count, &mut report, progress).ok_or_else(stopped)?;
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
    /// The triangles of all faces; `None` when cancelled.
    fn all(source: &Source, count: usize, report: &mut Report, progress: &dyn Progress) -> Option<Self> {
        let mut cut = Self { prims: Vec::with_capacity(count), ..Self::default() };
        let faces = &source.mesh.faces;
        for (k, (face, corners)) in faces.iter().zip(source.mesh.rings()).enumerate() {
            if k % 65_536 == 0 {
                progress.report(0.2 + 0.8 * k as f32 / faces.len() as f32, "cutting polygons");
            }
            if (k % 65_536 == 0 || corners.len() > LONG_WORK) && progress.cancelled() {
                return None;
            }
            if !cut.face(face, corners, source) {
                let count = corners.len();
                report.note_each("polygon: too long", format_args!("{count} corners"), || {
                    format!("a concave polygon of {count} corners is too long to be cut, so it was left out")
                });
            }
        }
        Some(cut)
    }

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
