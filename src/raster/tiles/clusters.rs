//! Occluders made ready to be drawn many at a time: clusters of quadrangles and triangles, or of segments.
//!
//! 1. Points at one place become one.
//! 2. Neighboring triangles that are about flat and convex together become a quadrangle ([`pair`]). Segments
//!    stay as they are.
//! 3. Each group is split at the medians of its longest axes to clusters of at most [`Clusters::MOST`]
//!    primitives, each with points of its own, as structures of arrays ([`split`]).
//!
//! Flatland lies in space at z = 0. Cost: O(n log n) time, about 60 bytes a triangle.

use std::ops::Range;

use glam::{DVec3, Vec3};

use super::Fate;
use super::ready::Told;

use crate::geometry::{Aabb, PrimId, Space, Vector};
use crate::scene::{Scene, Surfaces};

/// Boxes by axes, so that many are compared at a time; padded to whole vectors.
#[derive(Clone, Debug, Default)]
pub struct Boxes {
    pub(super) low: [Vec<f32>; 3],
    pub(super) high: [Vec<f32>; 3],
    count: usize,
    /// Sum of their greatest coordinates.
    pub(super) reach: f32,
}

impl Boxes {
    /// From boxes as they are, of either space.
    pub fn new<V: Vector>(boxes: impl IntoIterator<Item = Aabb<V>>) -> Self {
        let mut all = Self::default();
        for bounds in boxes {
            all.push(Aabb { min: widened(bounds.min), max: widened(bounds.max) });
            all.count += 1;
        }
        all.measure();
        // A vector reads up to 15 boxes past the last one; what it finds there is left out.
        (0..16).for_each(|_| all.push(Aabb { min: Vec3::ZERO, max: Vec3::ZERO }));
        all
    }
    /// Sums up their greatest coordinates.
    fn measure(&mut self) {
        let most = |v: &[f32]| v.iter().fold(0.0, |m: f32, x| m.max(x.abs()));
        self.reach = (0..3).map(|a| most(&self.low[a]).max(most(&self.high[a]))).sum();
    }
    fn put(&mut self, at: usize, bounds: Aabb<Vec3>) {
        for a in 0..3 {
            (self.low[a][at], self.high[a][at]) = (bounds.min[a], bounds.max[a]);
        }
    }
    fn push(&mut self, bounds: Aabb<Vec3>) {
        for a in 0..3 {
            self.low[a].push(bounds.min[a]);
            self.high[a].push(bounds.max[a]);
        }
    }
    /// How many.
    pub fn len(&self) -> usize {
        self.count
    }
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
    /// Both corners of one.
    #[inline(always)]
    pub(super) fn at(&self, i: usize) -> [[f32; 3]; 2] {
        [
            [self.low[0][i], self.low[1][i], self.low[2][i]],
            [self.high[0][i], self.high[1][i], self.high[2][i]],
        ]
    }
}

/// Primitives that are drawn together or not at all.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    /// Middle of its bounds, from which its planes are measured.
    pub middle: [f32; 3],
    /// Distance of its farthest point from the middle, or a little more.
    pub reach: f32,
    /// Its points and its primitives among all.
    pub points: Range<usize>,
    pub prims: Range<usize>,
}

/// Clusters of the occluders of a scene.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    pub(super) clusters: Vec<Cluster>,
    /// Their bounds.
    pub(super) boxes: Boxes,
    /// Coordinates of the points; the points of a cluster begin at a multiple of 16.
    pub(super) points: [Vec<f32>; 3],
    /// Corners of each primitive as numbers of points of its cluster, 16 bits each, lowest first; those of a
    /// triangle end with the same twice, those of a segment with its second end three times. They run
    /// clockwise on the screen where the front is seen; a segment has its front to the left. A quadrangle
    /// 0 1 2 3 is the triangles 0 1 2 and 0 2 3. [`TWO_SIDED`] is set where both sides are seen.
    pub(super) words: Vec<u64>,
    /// Whether any is.
    pub(super) any_two_sided: bool,
    /// Unit normals and offsets from the cluster's middle, of the first and the second triangle.
    pub(super) planes: [Vec<f32>; 8],
    /// The scene's primitives that a primitive is made of: twice the same for a triangle.
    pub(super) ids: Vec<[PrimId; 2]>,
    groups: Vec<Group>,
    /// Primitives that are in no cluster, group by group.
    apart: Vec<PrimId>,
    /// Clusters that hold something that moves, each with the scene's points that are its own.
    moving: Vec<(u32, Box<[u32]>)>,
}

/// What became of a group: its clusters, and its primitives that are in none.
#[derive(Clone, Debug)]
struct Group {
    clusters: Range<usize>,
    apart: Range<usize>,
}

/// The bit of a word.
pub(super) const TWO_SIDED: u64 = 1 << 15;
/// The bits of a corner's number in its 16.
const CORNER: u64 = 0x1ff;
/// Two triangles whose normals differ by more than this cosine says stay apart: a bent quadrangle holds its
/// depth less tightly than its triangles.
const LEAST_COSINE: f64 = 0.9;
/// Sines of the corners of a quadrangle: flatter ones would turn over on the pixel grid.
const LEAST_SINE: f64 = 1e-3;

/// A triangle of the scene, its points welded; a segment ends with the same corner twice.
struct Triangle {
    corners: [u32; 3],
    is_two_sided: bool,
    id: PrimId,
}
/// One or two triangles, or a segment.
struct Prim {
    /// Those of a triangle end with the same twice, those of a segment with the same three times.
    corners: [u32; 4],
    is_two_sided: bool,
    /// Of a triangle or a segment twice.
    ids: [PrimId; 2],
}

/// The word of a primitive's first triangle, or of the second one.
pub(super) fn half(word: u64, second: bool) -> u64 {
    let at = |k: u32| word >> (16 * k) & CORNER;
    let [b, c] = if second { [at(2), at(3)] } else { [at(1), at(2)] };
    word & TWO_SIDED | at(0) | b << 16 | c << 32 | c << 48
}
/// A corner's number.
#[inline(always)]
pub(super) fn corner(word: u64, which: usize) -> usize {
    (word >> (16 * which) & CORNER) as usize
}
/// Whether a word is that of a quadrangle.
#[inline(always)]
pub(super) fn is_quadrangle(word: u64) -> bool {
    corner(word, 2) != corner(word, 3)
}
/// The same corners the other way round.
pub(super) fn reversed(word: u64) -> u64 {
    let at = |k: u32| word >> (16 * k) & CORNER;
    // A triangle ends with the same corner twice, whichever way round.
    let [b, c, d] = if at(2) == at(3) { [at(2), at(1), at(1)] } else { [at(3), at(2), at(1)] };
    word & TWO_SIDED | at(0) | b << 16 | c << 32 | d << 48
}

impl Clusters {
    /// Most primitives of a cluster: measured, the least time of 64 to 512.
    pub const MOST: usize = 128;

    /// Makes clusters of primitives of a scene in groups; no cluster holds primitives of two groups. What
    /// lets light through hides nothing and is left out.
    pub fn new<'a, S: Space>(
        scene: &Scene<S>,
        surfaces: Surfaces,
        groups: impl IntoIterator<Item = &'a [PrimId]>,
    ) -> Self {
        let mut all = Self::default();
        all.extend(scene, surfaces, groups, 0);
        all
    }
    /// Adds groups of another scene, whose ids count on from `first`.
    pub fn extend<'a, S: Space>(
        &mut self,
        scene: &Scene<S>,
        surfaces: Surfaces,
        groups: impl IntoIterator<Item = &'a [PrimId]>,
        first: u32,
    ) {
        let points: Vec<Vec3> = scene.points().iter().map(|&p| widened(p)).collect();
        let (points, is_flat) = (&points[..], S::CORNERS == 2);
        let place = welded(points, &movers(scene));
        let box_of = |i: usize| {
            let [min, max] = self.boxes.at(i).map(Vec3::from_array);
            Aabb { min, max }
        };
        let mut boxes: Vec<Aabb<Vec3>> = (0..self.boxes.len()).map(box_of).collect();
        let mut own = vec![u32::MAX; points.len()];
        for group in groups {
            let (first_cluster, first_apart) = (boxes.len(), self.apart.len());
            let mut triangles = Vec::with_capacity(group.len());
            for &id in group {
                // 1. Points at one place are one.
                let Some(corners) = scene.corners(id) else { continue };
                let [a, b, c] = [0, 1, 2].map(|k| place[corners.as_ref()[k.min(S::CORNERS - 1)] as usize]);
                if surfaces.show_through(scene, id) || a == b || c == a || b == c && !is_flat {
                    self.apart.push(PrimId(id.0 + first));
                } else {
                    let (is_two_sided, id) = (scene.is_two_sided(id), PrimId(id.0 + first));
                    triangles.push(Triangle { corners: [a, b, c], is_two_sided, id });
                }
            }
            // 2. Quadrangles.
            let mut prims = if is_flat {
                let segment = |&Triangle { corners: [a, b, c], is_two_sided, id }: &Triangle| Prim {
                    corners: [a, b, c, c],
                    is_two_sided,
                    ids: [id; 2],
                };
                triangles.iter().map(segment).collect()
            } else {
                pair(points, &triangles)
            };
            // 3. Clusters.
            let mut parts = Vec::new();
            split(points, &mut prims, 0, &mut parts);
            for part in parts {
                let moves = prims[part.clone()]
                    .iter()
                    .any(|p| p.ids.iter().any(|&id| scene.is_moving(PrimId(id.0 - first))));
                let (bounds, used) = self.add(points, &prims[part], &mut own);
                if moves {
                    self.moving.push((boxes.len() as u32, used.into()));
                }
                boxes.push(bounds);
            }
            let (clusters, apart) = (first_cluster..boxes.len(), first_apart..self.apart.len());
            self.groups.push(Group { clusters, apart });
        }
        self.boxes = Boxes::new(boxes);
    }
    /// The primitives of a group, by its number, that are in no cluster: what lets light through, and those
    /// with two corners at one place, which cover nothing.
    pub fn apart(&self, group: usize) -> &[PrimId] {
        &self.apart[self.groups[group].apart.clone()]
    }
    /// The clusters of a group.
    pub(super) fn of_group(&self, group: usize) -> &[Cluster] {
        &self.clusters[self.range_of(group)]
    }
    /// Their numbers.
    pub(super) fn range_of(&self, group: usize) -> Range<usize> {
        self.groups[group].clusters.clone()
    }
    /// What became of the primitives of a group, from the tags of what faced the eye and of what showed.
    pub(super) fn fates(&self, group: usize, skipped: &[bool], told: &Told, to: &mut Vec<(PrimId, Fate)>) {
        let Some(first) = self.of_group(group).first().map(|c| c.prims.start) else { return };
        let past = self.of_group(group).last().map_or(first, |c| c.prims.end);
        // Of each primitive the parts that faced the eye, and above them those that showed.
        let mut parts = vec![0u8; past - first];
        // Other groups were drawn with it.
        let at = |t: i32| ((t >> 2) as usize).wrapping_sub(first);
        for t in &told.faced {
            parts.get_mut(at(*t)).into_iter().for_each(|part| *part |= (t & 3) as u8);
        }
        for t in &told.shown {
            parts.get_mut(at(*t)).into_iter().for_each(|part| *part |= ((t & 3) << 2) as u8);
        }
        let is_drawn = |id: PrimId| skipped.get(id.at()).is_some_and(|&is| is);
        for prim in self.of_group(group).iter().flat_map(|c| c.prims.clone()) {
            let (ids, parts) = (self.ids[prim], parts[prim - first]);
            let halves = if ids[0] == ids[1] { 1 } else { 2 };
            for (k, &id) in ids[..halves].iter().enumerate().filter(|(_, id)| !is_drawn(**id)) {
                let fate = match (parts >> k & 1, parts >> (k + 2) & 1) {
                    (0, _) => Fate::Away,
                    (_, 0) => Fate::Hidden,
                    _ => Fate::Shown,
                };
                to.push((id, fate));
            }
        }
    }
    /// The scene's primitives of some tags.
    pub(super) fn named(&self, tags: &[i32]) -> impl Iterator<Item = PrimId> {
        let ids = |tag: i32| {
            let [a, b] = self.ids[(tag >> 2) as usize];
            // A triangle is both of its parts.
            [(tag & 1 != 0).then_some(a), (tag & 2 != 0).then_some(b)]
        };
        tags.iter().flat_map(move |&tag| ids(tag)).flatten()
    }
    /// The scene's primitives of a group that are in clusters.
    pub fn prims_of(&self, group: usize) -> impl Iterator<Item = PrimId> {
        self.of_group(group).iter().flat_map(|c| self.ids[c.prims.clone()].as_flattened().iter().copied())
    }
    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        let columns = self.points.iter().chain(&self.planes).map(|v| size_of_val(&v[..])).sum::<usize>();
        let boxes = self.boxes.low.iter().chain(&self.boxes.high).map(|v| size_of_val(&v[..])).sum::<usize>();
        let prims = size_of_val(&self.words[..]) + size_of_val(&self.ids[..]) + size_of_val(&self.apart[..]);
        columns + boxes + prims + size_of_val(&self.clusters[..]) + size_of_val(&self.groups[..])
    }
    /// Appends a cluster and returns its bounds and its points. `own`: scratch, a number for each point, all
    /// unset.
    fn add(&mut self, points: &[Vec3], prims: &[Prim], own: &mut [u32]) -> (Aabb<Vec3>, Vec<u32>) {
        let (first_point, first_prim) = (self.points[0].len(), self.words.len());
        let mut used = Vec::new();
        for &Prim { corners, is_two_sided, ids } in prims {
            self.any_two_sided |= is_two_sided;
            self.ids.push(ids);
            let mut word = if is_two_sided { TWO_SIDED } else { 0 };
            for (k, &c) in corners.iter().enumerate() {
                if own[c as usize] == u32::MAX {
                    own[c as usize] = used.len() as u32;
                    used.push(c);
                    let p = points[c as usize];
                    self.points.iter_mut().zip([p.x, p.y, p.z]).for_each(|(to, v)| to.push(v));
                }
                word |= u64::from(own[c as usize]) << (16 * k);
            }
            self.words.push(word);
        }
        used.iter().for_each(|&c| own[c as usize] = u32::MAX);
        let (points_of, prims_of) = (first_point..self.points[0].len(), first_prim..self.words.len());
        self.pad();
        let at = self.clusters.len();
        self.clusters.push(Cluster { middle: [0.0; 3], reach: 0.0, points: points_of, prims: prims_of });
        (self.lay(at, points, &used), used)
    }
    /// Goes over to another frame of the scene: the same primitives in the same clusters, and points that
    /// have moved. Quadrangles may bend by what is rounded; set-up takes those apart that are not convex.
    pub fn follow<S: Space>(&mut self, scene: &Scene<S>) {
        let points: Vec<Vec3> = scene.points().iter().map(|&p| widened(p)).collect();
        let moving = std::mem::take(&mut self.moving);
        for (at, used) in &moving {
            let bounds = self.lay(*at as usize, &points, used);
            self.boxes.put(*at as usize, bounds);
        }
        self.boxes.measure();
        self.moving = moving;
    }
    /// Puts the points of a cluster, which are some of the scene's, and what follows from them. Its bounds.
    fn lay(&mut self, at: usize, points: &[Vec3], used: &[u32]) -> Aabb<Vec3> {
        let own: Vec<Vec3> = used.iter().map(|&c| points[c as usize]).collect();
        let Cluster { points: place, prims, .. } = self.clusters[at].clone();
        for k in 0..own.len().next_multiple_of(16) {
            // A vector is filled up with the last one.
            let p = own[k.min(own.len() - 1)].to_array();
            self.points.iter_mut().zip(p).for_each(|(to, v)| to[place.start + k] = v);
        }
        let bounds = Aabb::of(own.iter().copied());
        let middle = bounds.center();
        let from_middle = |p: Vec3| p.as_dvec3() - middle.as_dvec3();
        for prim in prims {
            let word = self.words[prim];
            for (k, half) in [half(word, false), half(word, is_quadrangle(word))].into_iter().enumerate() {
                let [a, b, c] = [0, 1, 2].map(|j| corner(half, j) as u32);
                // Corners run clockwise on the screen: the other way round about the normal.
                let n = normal(&own, [a, c, b]);
                let plane = [n.x, n.y, n.z, n.dot(from_middle(own[a as usize]))];
                self.planes[4 * k..].iter_mut().zip(plane).for_each(|(to, v)| to[prim] = v as f32);
            }
        }
        let reach = own.iter().map(|&p| from_middle(p).length()).fold(0.0, f64::max);
        let cluster = &mut self.clusters[at];
        cluster.middle = middle.to_array();
        // More than rounding to f32 takes away.
        cluster.reach = reach as f32 * 1.00001;
        bounds
    }
    /// Fills up the last vectors: the last point again, and primitives that no eye sees from the front.
    fn pad(&mut self) {
        for p in &mut self.points {
            let last = p.last().copied().unwrap_or_default();
            p.resize(p.len().next_multiple_of(16), last);
        }
        self.words.resize(self.words.len().next_multiple_of(16), 0);
        self.ids.resize(self.words.len(), [PrimId(0); 2]);
        for (k, plane) in self.planes.iter_mut().enumerate() {
            let beyond = if k % 4 == 3 { f32::MAX } else { 0.0 };
            plane.resize(self.words.len(), beyond);
        }
    }
}

/// A point in space; flatland lies at z = 0.
fn widened<V: Vector>(p: V) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|a| if a < V::AXES { p.get(a) } else { 0.0 }))
}

/// For each point the object that moves it; none of them if nothing moves.
fn movers<S: Space>(scene: &Scene<S>) -> Vec<u32> {
    let mut movers = vec![u32::MAX; if scene.moving().is_empty() { 0 } else { scene.points().len() }];
    for &prim in scene.moving() {
        for &point in scene.corners(prim).iter().flat_map(|c| c.as_ref()) {
            movers[point as usize] = scene.object_of(prim).0;
        }
    }
    movers
}

/// For each point the first one at its place that moves with it.
fn welded(points: &[Vec3], movers: &[u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    // Zeros of either sign are one place.
    let key = |i: u32| (points[i as usize].to_array().map(|x| (x + 0.0).to_bits()), movers.get(i as usize));
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut first = vec![0; points.len()];
    for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
        same.iter().for_each(|&i| first[i as usize] = same[0]);
    }
    first
}

/// Pairs of triangles with a common edge whose union is about flat and convex, the flattest and most compact
/// first, and the triangles that are left. Turned round: what is counter-clockwise in space is clockwise on
/// the screen, whose rows go down.
fn pair(points: &[Vec3], triangles: &[Triangle]) -> Vec<Prim> {
    let mut candidates = candidates(points, triangles);
    candidates.sort_by(|x, y| x.worth.total_cmp(&y.worth).then(x.triangles.cmp(&y.triangles)));
    let mut used = vec![false; triangles.len()];
    let mut prims = Vec::with_capacity(triangles.len());
    for Candidate { triangles: [i, j], corners: [a, d, b, c], .. } in candidates {
        let (i, j) = (i as usize, j as usize);
        if !used[i] && !used[j] {
            (used[i], used[j]) = (true, true);
            // The triangles a c b and a b d.
            let ids = [triangles[i].id, triangles[j].id];
            prims.push(Prim { corners: [a, c, b, d], is_two_sided: triangles[i].is_two_sided, ids });
        }
    }
    let left = triangles.iter().zip(used).filter(|(_, used)| !used).map(|(t, _)| t);
    prims.extend(left.map(|&Triangle { corners: [a, b, c], is_two_sided, id }| Prim {
        corners: [a, c, b, b],
        is_two_sided,
        ids: [id; 2],
    }));
    prims
}

/// Two triangles that make a quadrangle.
struct Candidate {
    /// Less is better: steps of bending, and within a step the long common edge first.
    worth: f64,
    triangles: [u32; 2],
    corners: [u32; 4],
}

fn candidates(points: &[Vec3], triangles: &[Triangle]) -> Vec<Candidate> {
    let at = |i: u32| points[i as usize].as_dvec3();
    let normals: Vec<DVec3> = triangles.iter().map(|t| normal(points, t.corners)).collect();
    let mut edges: Vec<([u32; 2], u32)> = (0u32..)
        .zip(triangles)
        .flat_map(|(i, t)| [[0, 1], [1, 2], [2, 0]].map(|[a, b]| ([t.corners[a], t.corners[b]], i)))
        .collect();
    edges.sort_unstable();
    let mut found = Vec::new();
    for &([a, b], i) in &edges {
        // The neighbors run along their common edge the other way.
        let from = edges.partition_point(|e| e.0 < [b, a]);
        for &(_, j) in edges[from..].iter().take_while(|e| e.0 == [b, a]) {
            let (t, u) = (&triangles[i as usize], &triangles[j as usize]);
            let (n, m) = (normals[i as usize], normals[j as usize]);
            if j <= i || t.is_two_sided != u.is_two_sided || n.dot(m) < LEAST_COSINE {
                continue;
            }
            let other = |t: [u32; 3]| t.into_iter().find(|&c| c != a && c != b);
            let (Some(c), Some(d)) = (other(t.corners), other(u.corners)) else { continue };
            let corners = [a, d, b, c];
            if is_convex(&corners.map(at), (n + m).normalize_or_zero()) {
                let size = at(a).distance(at(b)) + at(c).distance(at(d));
                let bent = n.dot(at(d) - at(a)).abs() / size;
                let worth = (bent * 64.0).floor() - at(a).distance(at(b)) / size;
                found.push(Candidate { worth, triangles: [i, j], corners });
            }
        }
    }
    found
}

/// Whether the corners turn one way about a normal, by clearly more than rounding.
fn is_convex(corners: &[DVec3; 4], about: DVec3) -> bool {
    (0..4).all(|k| {
        let (u, v) = (corners[(k + 1) % 4] - corners[k], corners[(k + 2) % 4] - corners[(k + 1) % 4]);
        u.cross(v).dot(about) > LEAST_SINE * u.length() * v.length()
    })
}

/// Orders primitives so that those of a part are neighbors in space, and lists the parts; `first` is the
/// place of the first one.
fn split(points: &[Vec3], prims: &mut [Prim], first: usize, parts: &mut Vec<Range<usize>>) {
    if prims.len() <= Clusters::MOST {
        if !prims.is_empty() {
            parts.push(first..first + prims.len());
        }
        return;
    }
    let center = |p: &Prim| p.corners.iter().map(|&c| points[c as usize]).sum::<Vec3>();
    let extent = Aabb::of(prims.iter().map(center)).size();
    let axis = (0..3).fold(0, |best, a| if extent[a] > extent[best] { a } else { best });
    let middle = prims.len() / 2;
    prims.select_nth_unstable_by(middle, |a, b| {
        // Equal centers in the order of their corners, so that every run splits alike.
        center(a)[axis].total_cmp(&center(b)[axis]).then(a.corners.cmp(&b.corners))
    });
    let (low, high) = prims.split_at_mut(middle);
    split(points, low, first, parts);
    split(points, high, first + middle, parts);
}

/// Unit normal of a triangle, on the side from which it runs counter-clockwise; of a segment, whose last
/// corners are one, in flatland to its left; 0 where it has none.
fn normal(points: &[Vec3], corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|i| points[i as usize].as_dvec3());
    let (u, v) = (b - a, c - a);
    let n = if corners[1] == corners[2] { DVec3::new(-u.y, u.x, 0.0) } else { u.cross(v) };
    n.normalize_or_zero()
}
