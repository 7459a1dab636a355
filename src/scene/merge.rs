//! Merging coplanar neighbors into larger convex polygons: for the scene's own faces those of one object and
//! one material, for occluders whatever their object and material.
//!
//! Greedy, in the order of ids: a polygon swallows the neighbor across an edge as long as the two together
//! are planar and convex by the same test that faces of a file pass. The primitives stay as they are; only
//! [`Parts::faces`] grows. Cost: a sort of the edges, and O(n) merges of polygons of at most [`MAX_CORNERS`].

use glam::{DVec3, Vec3};

use super::polygon::{Cutter, Shape, newell};
use super::{Face, Parts, Progress, Scene, Surfaces};
use crate::geometry::{Flat, PrimId, Solid, orient2d};

/// Most corners of a merged polygon: more help no method, and bound the work.
const MAX_CORNERS: usize = 64;

struct Merger<'a> {
    points: &'a [Vec3],
    rings: Vec<Vec<u32>>,
    prims: Vec<Vec<PrimId>>,
    /// Object and material; only equals merge.
    kinds: Vec<(u32, u32)>,
    /// Directed edges and the polygon that they were made for, sorted.
    edges: Vec<(u32, u32, u32)>,
    /// The polygon that swallowed this one, or itself.
    into: Vec<u32>,
    cutter: Cutter,
    scratch: Vec<DVec3>,
}

/// Merges; see the module.
pub(super) fn merge_coplanar(parts: &mut Parts<Solid>, progress: &dyn Progress) {
    let mut merger = Merger::new(parts, &parts.points, false, |_| true);
    let before: Vec<usize> = merger.prims.iter().map(Vec::len).collect();
    if !merger.run(progress) {
        return;
    }
    let grown = |k: usize| if merger.prims[k].len() > before[k] { merger.prims[k].len() } else { 0 };
    let merged = (0..before.len()).map(grown).sum();
    let mut faces = merger.into_faces();
    faces.retain(|f| f.prims.len() > 1);
    parts.faces = faces;
    parts.report.merged_prims = merged;
}

impl Scene<Solid> {
    /// The live primitives as planar convex polygons, coplanar neighbors merged whatever their object and
    /// material: what occluders are, so none that shows what is behind it. Ordered by their first primitive.
    /// `None` when cancelled.
    pub fn convex_polygons(&self, surfaces: Surfaces, progress: &dyn Progress) -> Option<Vec<Face>> {
        let taken = |p| !surfaces.show_through(self, p);
        let mut merger = Merger::new(&self.tables.parts, self.points(), true, taken);
        merger.run(progress).then(|| merger.into_faces())
    }
}

impl Scene<Flat> {
    /// The live segments, those merged that continue each other exactly straight on: what occluders are in
    /// flatland, so none that shows what is behind it. The first primitive gives the direction. Ordered by
    /// their first primitive. `None` when cancelled.
    pub fn convex_polygons(&self, surfaces: Surfaces, progress: &dyn Progress) -> Option<Vec<Face>> {
        progress.report(0.0, "merging collinear segments");
        let taken = || self.live().iter().copied().filter(|p| !surfaces.show_through(self, *p));
        let mut next: Vec<(u32, PrimId)> = taken().filter_map(|p| Some((self.corners(p)?[0], p))).collect();
        next.sort_unstable();
        let mut ends: Vec<u32> = taken().filter_map(|p| Some(self.corners(p)?[1])).collect();
        ends.sort_unstable();
        let times =
            |list: &[u32], c: u32| list.partition_point(|e| *e <= c) - list.partition_point(|e| *e < c);
        // The one segment that goes on from a point at which one segment ends.
        let follower = |c: u32| {
            let first = next.partition_point(|e| e.0 < c);
            let found = next.get(first).filter(|e| e.0 == c)?;
            let alone = next.get(first + 1).is_none_or(|e| e.0 != c) && times(&ends, c) == 1;
            alone.then_some(found.1)
        };
        let at = |c: u32| self.points()[c as usize].as_dvec2();
        let goes_on = |[a, b]: [u32; 2], to: u32| {
            orient2d(at(a), at(b), at(to)) == 0.0 && (at(b) - at(a)).dot(at(to) - at(b)) > 0.0
        };
        let straight = |p: PrimId| {
            let corners = self.corners(p)?;
            let after = follower(corners[1])?;
            (after != p && goes_on(corners, self.corners(after)?[1])).then_some(after)
        };
        let mut continues = vec![false; self.prim_count()];
        taken().filter_map(straight).for_each(|p| continues[p.at()] = true);
        let heads = taken().filter(|p| !continues[p.at()]);
        let face = |head: PrimId| {
            let mut prims = vec![head];
            let mut last = head;
            while let Some(after) = straight(last) {
                prims.push(after);
                last = after;
            }
            let corners = vec![self.corners(head)?[0], self.corners(last)?[1]];
            prims.sort_unstable();
            Some(Face { corners, prims })
        };
        let mut faces: Vec<Face> = heads.filter_map(face).collect();
        faces.sort_by_key(|f| f.prims[0]);
        Some(faces)
    }
}

impl<'a> Merger<'a> {
    /// All polygons of `parts` that are taken; `mixed`: those of different objects and materials merge too.
    fn new(parts: &Parts<Solid>, points: &'a [Vec3], mixed: bool, takes: impl Fn(PrimId) -> bool) -> Self {
        let mut covered = vec![false; parts.prims.len()];
        let mut polygons: Vec<(Vec<u32>, Vec<PrimId>)> = Vec::new();
        for face in &parts.faces {
            face.prims.iter().for_each(|p| covered[p.at()] = true);
            // A face has one material.
            if !takes(face.prims[0]) {
                continue;
            }
            polygons.push((face.corners.clone(), face.prims.clone()));
        }
        for (p, corners) in parts.prims.iter().enumerate().filter(|(p, _)| !covered[*p]) {
            let prim = PrimId(p as u32);
            if let Some(corners) = corners.filter(|_| takes(prim)) {
                polygons.push((corners.to_vec(), vec![prim]));
            }
        }
        polygons.sort_by_key(|(_, prims)| prims[0]);
        let kind = |p: PrimId| {
            if mixed { (0, 0) } else { (parts.prim_object[p.at()].0, parts.prim_material[p.at()].0) }
        };
        let kinds = polygons.iter().map(|(_, prims)| kind(prims[0])).collect();
        let (rings, prims): (Vec<_>, Vec<_>) = polygons.into_iter().unzip();
        let mut edges: Vec<(u32, u32, u32)> = Vec::new();
        for (k, ring) in rings.iter().enumerate() {
            edges.extend(sides(ring).map(|(a, b)| (a, b, k as u32)));
        }
        edges.sort_unstable();
        let into = (0..rings.len() as u32).collect();
        Self { points, rings, prims, kinds, edges, into, cutter: Cutter::default(), scratch: Vec::new() }
    }

    /// Merges what can be merged; whether it was not cancelled.
    fn run(&mut self, progress: &dyn Progress) -> bool {
        for polygon in 0..self.rings.len() {
            if polygon % 16_384 == 0 {
                progress.report(polygon as f32 / self.rings.len() as f32, "merging coplanar neighbors");
                if progress.cancelled() {
                    return false;
                }
            }
            if self.into[polygon] == polygon as u32 {
                while self.grow(polygon) {}
            }
        }
        true
    }

    /// The polygons that are left, by their first primitive.
    fn into_faces(self) -> Vec<Face> {
        let Self { rings, prims, into, .. } = self;
        let left = rings.into_iter().zip(prims).enumerate().filter(|(k, _)| into[*k] == *k as u32);
        let face = |(_, (corners, mut prims)): (usize, (Vec<u32>, Vec<PrimId>))| {
            prims.sort_unstable();
            Face { corners, prims }
        };
        let mut faces: Vec<Face> = left.map(face).collect();
        faces.sort_by_key(|f| f.prims[0]);
        faces
    }

    fn root(&mut self, mut polygon: u32) -> u32 {
        while self.into[polygon as usize] != polygon {
            let above = self.into[polygon as usize];
            self.into[polygon as usize] = self.into[above as usize];
            polygon = above;
        }
        polygon
    }

    /// The one polygon that has this directed edge; `None` if there are none or several.
    fn owner(&mut self, a: u32, b: u32) -> Option<u32> {
        let first = self.edges.partition_point(|e| (e.0, e.1) < (a, b));
        let found = *self.edges.get(first).filter(|e| (e.0, e.1) == (a, b))?;
        let several = self.edges.get(first + 1).is_some_and(|e| (e.0, e.1) == (a, b));
        (!several).then(|| self.root(found.2))
    }

    /// Swallows one neighbor; whether there was one to swallow.
    fn grow(&mut self, polygon: usize) -> bool {
        for k in 0..self.rings[polygon].len() {
            let ring = &self.rings[polygon];
            let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
            let Some(other) = self.owner(b, a).map(|o| o as usize) else { continue };
            if other == polygon
                || self.kinds[other] != self.kinds[polygon]
                || !self.faces_alike(polygon, other)
            {
                continue;
            }
            let Some(joined) =
                join(&self.rings[polygon], &self.rings[other]).filter(|j| j.len() <= MAX_CORNERS)
            else {
                continue;
            };
            self.load(&joined);
            if self.cutter.cut(&self.scratch) == Shape::Convex {
                self.rings[polygon] = joined;
                self.rings[other] = Vec::new();
                let prims = std::mem::take(&mut self.prims[other]);
                self.prims[polygon].extend(prims);
                self.into[other] = polygon as u32;
                return true;
            }
        }
        false
    }

    fn load(&mut self, ring: &[u32]) {
        self.scratch.clear();
        self.scratch.extend(ring.iter().map(|c| self.points[*c as usize].as_dvec3()));
    }

    /// A quick look: normals that differ by more than a hundredth of a degree or so cannot be of one plane.
    fn faces_alike(&mut self, a: usize, b: usize) -> bool {
        let [m, n] = [a, b].map(|k| {
            self.scratch.clear();
            self.scratch.extend(self.rings[k].iter().map(|c| self.points[*c as usize].as_dvec3()));
            newell(&self.scratch).normalize_or_zero()
        });
        m.dot(n) > 1.0 - 1e-7
    }
}

fn sides(ring: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()]))
}

/// The border of two polygons together, if what they share is one unbroken chain of edges.
fn join(p: &[u32], q: &[u32]) -> Option<Vec<u32>> {
    let (n, m) = (p.len(), q.len());
    let shared: Vec<bool> = sides(p).map(|(a, b)| sides(q).any(|e| e == (b, a))).collect();
    let count = shared.iter().filter(|s| **s).count();
    // The chain begins where a shared edge follows one that is not.
    let start = (0..n).find(|k| shared[*k] && !shared[(k + n - 1) % n])?;
    if count == 0 || count + 1 > n || count + 1 > m || !(0..count).all(|k| shared[(start + k) % n]) {
        return None;
    }
    let (first, last) = (p[start], p[(start + count) % n]);
    let back = q.iter().position(|c| *c == last)?;
    // Round p from the end of the chain to its beginning, then round q likewise.
    let mut ring: Vec<u32> = (0..=n - count).map(|k| p[(start + count + k) % n]).collect();
    ring.extend((1..m - count).map(|k| q[(back + count + k) % m]));
    let unique = |c: &u32| ring.iter().filter(|d| *d == c).count() == 1;
    (q[(back + count) % m] == first && ring.iter().all(unique)).then_some(ring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LoadOptions, Quiet, Scene, load_bytes};

    fn merged(text: &str) -> std::sync::Arc<Scene<Solid>> {
        let options = LoadOptions { merge_coplanar: true, ..LoadOptions::default() };
        match load_bytes(text.as_bytes(), "m.obj", &options, &Quiet) {
            Ok(crate::scene::AnyScene::Solid(scene)) => scene,
            other => panic!("{other:?}"),
        }
    }

    /// A grid of `n` by `n` cells of two triangles; `lift` bends it.
    fn grid(n: u32, lift: impl Fn(u32, u32) -> f64) -> String {
        let mut text = String::new();
        (0..=n).for_each(|j| (0..=n).for_each(|i| text += &format!("v {i} {} {j}\n", lift(i, j))));
        for j in 0..n {
            for i in 0..n {
                let k = j * (n + 1) + i + 1;
                text += &format!("f {} {} {}\nf {} {} {}\n", k, k + n + 2, k + 1, k, k + n + 1, k + n + 2);
            }
        }
        text
    }

    #[test]
    fn a_flat_grid_becomes_one_polygon_and_a_folded_one_two() {
        let flat = merged(&grid(6, |_, _| 0.0));
        assert_eq!((flat.faces().len(), flat.faces()[0].prims.len()), (1, 72));
        assert_eq!(flat.report().merged_prims, 72);
        let folded = merged(&grid(6, |i, _| f64::from(i.abs_diff(3)) * 0.5));
        assert_eq!(folded.faces().iter().map(|f| f.prims.len()).collect::<Vec<_>>(), [36, 36]);
    }

    #[test]
    fn each_primitive_lies_in_one_polygon_of_the_same_area() {
        let hills = merged(&grid(12, |i, j| if (i * 7 + j * 5) % 11 == 0 { 0.4 } else { 0.0 }));
        let mut seen = vec![false; hills.prim_count()];
        for face in hills.faces() {
            let corners: Vec<DVec3> =
                face.corners.iter().map(|c| hills.points()[*c as usize].as_dvec3()).collect();
            assert_eq!(Cutter::default().cut(&corners), Shape::Convex);
            let area: f64 = face.prims.iter().map(|p| f64::from(hills.normal(*p).length())).sum();
            assert!((newell(&corners).length() - area).abs() < 1e-4 * area);
            for p in &face.prims {
                assert!(!std::mem::replace(&mut seen[p.at()], true), "{p} is in two polygons");
            }
        }
        assert!(hills.faces().len() > 5);
    }

    #[test]
    fn objects_and_materials_stay_apart() {
        let scene = merged("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n");
        assert!(scene.faces().is_empty());
        let same = merged("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
        assert_eq!(same.faces()[0].corners.len(), 4);
    }
}
