//! Coplanar neighbors of a leaf as one polygon, cut into fewer triangles (Zhang et al. 1997, Section 8).
//!
//! Neighboring triangles of a leaf whose corners lie exactly on one plane, and which have one border
//! together, are cut anew along that border. Every corner of the border is kept, so that its image
//! is the same to the last sample; corners inside are not needed, and each saves two triangles. Triangles are
//! cut off as ears, none of which is flat. In flatland segments that go on straight become one.
//!
//! Depth: on one plane the new triangles are as deep as the old ones, but for rounding and for what the
//! rasterizer's slack allows ([`crate::raster::Turns::may_stand_for`]). Where a single Z plane or depths at
//! samples are compared, what is culled must be farther by that.

use std::collections::BTreeMap;

use glam::{DVec2, dvec2};

use super::{Made, corners_of};
use crate::geometry::{PrimId, Sets, Space, Vector, orient2d};
use crate::scene::Scene;

/// Most corners of a border: cutting takes time cubic in them.
const MOST_CORNERS: usize = 64;

/// What is made of the primitives of a leaf.
pub fn merge<S: Space>(scene: &Scene<S>, prims: &[PrimId]) -> Made<S> {
    let mut made = Made::default();
    if S::CORNERS == 2 {
        chain(scene, prims, &mut made);
        return made;
    }
    for plane in coplanar(scene, prims) {
        let first = made.prims.len() as u32;
        match cut_anew(scene, &plane) {
            Some(triangles) => {
                let is_two_sided = scene.is_two_sided(plane[0]);
                triangles.into_iter().for_each(|corners| made.add(corners, is_two_sided));
                made.polygons.push(first..made.prims.len() as u32);
            }
            None => plane.iter().for_each(|&p| made.keep(scene, p)),
        }
    }
    made
}

/// Triangles in sets, each in the order given: those that share an edge, run along it in opposite ways, lie
/// exactly on one plane and have as many fronts are of one.
fn coplanar<S: Space>(scene: &Scene<S>, prims: &[PrimId]) -> Vec<Vec<PrimId>> {
    let corners =
        |p: PrimId| scene.corners(p).map(|c| [c.as_ref()[0], c.as_ref()[1], c.as_ref()[S::CORNERS - 1]]);
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let mut joined = Sets::new(prims.len());
    for (at, &prim) in prims.iter().enumerate() {
        let Some([a, b, c]) = corners(prim) else { continue };
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.insert([from, to], at);
            let Some(&other) = edges.get(&[to, from]) else { continue };
            let on = corners_of(scene, prims[other]);
            let is_flat = corners_of(scene, prim).iter().all(|&p| S::side(&on, p) == 0.0);
            let same = scene.is_two_sided(prim) == scene.is_two_sided(prims[other]);
            // Folded back on each other they are two.
            if is_flat && same && scene.normal(prim).dot(scene.normal(prims[other])) > 0.0 {
                joined.join(at as u32, other as u32);
            }
        }
    }
    let mut sets: BTreeMap<u32, Vec<PrimId>> = BTreeMap::new();
    (0..).zip(prims).for_each(|(at, &prim)| sets.entry(joined.root(at)).or_default().push(prim));
    sets.into_values().collect()
}

/// Segments, those that go on exactly straight as one. On the line of samples the images of two that meet,
/// rounded or not, are the image of their union.
fn chain<S: Space>(scene: &Scene<S>, prims: &[PrimId], made: &mut Made<S>) {
    let ends = |p: PrimId| scene.corners(p).map(|c| [c.as_ref()[0], c.as_ref()[1]]);
    // The one segment that begins at a point, and how many end there.
    let (mut begins, mut others) = (BTreeMap::<u32, Vec<PrimId>>::new(), BTreeMap::<u32, u32>::new());
    for &prim in prims {
        let Some([a, b]) = ends(prim) else { continue };
        begins.entry(a).or_default().push(prim);
        *others.entry(b).or_default() += 1;
    }
    let at = |c: u32| flat(scene.points()[c as usize], [0, 1]);
    let follower = |prim: PrimId| {
        let [a, b] = ends(prim)?;
        let [next] = begins.get(&b)?[..] else { return None };
        let c = ends(next)?[1];
        let straight = orient2d(at(a), at(b), at(c)) == 0.0 && (at(b) - at(a)).dot(at(c) - at(b)) > 0.0;
        let same = scene.is_two_sided(prim) == scene.is_two_sided(next);
        (straight && same && others[&b] == 1 && next != prim).then_some(next)
    };
    let mut follows = std::collections::BTreeSet::new();
    prims.iter().filter_map(|&p| follower(p)).for_each(|p| _ = follows.insert(p));
    for &head in prims.iter().filter(|p| !follows.contains(p)) {
        let mut last = head;
        while let Some(next) = follower(last) {
            last = next;
        }
        let (a, b) = (corners_of(scene, head)[0], corners_of(scene, last)[1]);
        if head != last {
            let at = made.prims.len() as u32;
            made.polygons.push(at..at + 1);
        }
        made.add([a, b, b], scene.is_two_sided(head));
    }
}

/// Coordinates along two axes.
fn flat<V: Vector>(p: V, [u, v]: [usize; 2]) -> DVec2 {
    dvec2(f64::from(p.get(u)), f64::from(p.get(v)))
}

/// Triangles of a plane with their border, if there are fewer than now.
fn cut_anew<S: Space>(scene: &Scene<S>, prims: &[PrimId]) -> Option<Vec<[S::Vector; 3]>> {
    let corners =
        |p: &PrimId| scene.corners(*p).map(|c| [c.as_ref()[0], c.as_ref()[1], c.as_ref()[S::CORNERS - 1]]);
    let triangles: Vec<[u32; 3]> = prims.iter().filter_map(corners).collect();
    let ring = border(&triangles)?;
    if ring.len() > MOST_CORNERS || ring.len() - 2 >= triangles.len() {
        return None;
    }
    let point = |c: u32| scene.points()[c as usize];
    // The largest triangle's plane, exactly: a dent, however small, may hold something.
    let plane =
        prims.iter().max_by(|a, b| scene.normal(**a).length().total_cmp(&scene.normal(**b).length()))?;
    let on = corners_of(scene, *plane);
    if triangles.as_flattened().iter().any(|&c| S::side(&on, point(c)) != 0.0) {
        return None;
    }
    // Along the plane's longest axis everything keeps its exact coordinates.
    let n = scene.normal(*plane).abs();
    let axis = (0..S::Vector::AXES).fold(0, |best, a| if n.get(a) > n.get(best) { a } else { best });
    let axes = [(axis + 1) % 3, (axis + 2) % 3];
    let places: Vec<DVec2> = ring.iter().map(|&c| flat(point(c), axes)).collect();
    let cut = ears(&places)?;
    Some(cut.into_iter().map(|t| t.map(|k| point(ring[k]))).collect())
}

/// The border of triangles as one ring of corners, in the way round that theirs have; `None` if there are
/// several, or it meets itself.
fn border(triangles: &[[u32; 3]]) -> Option<Vec<u32>> {
    let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            // Where two triangles meet, one runs along the edge the other way.
            *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    for ([low, high], times) in edges {
        let (from, to) = if times > 0 { (low, high) } else { (high, low) };
        if times.abs() > 1 || times != 0 && next.insert(from, to).is_some() {
            return None;
        }
    }
    let first = *next.keys().next()?;
    let (mut ring, mut at) = (vec![first], *next.get(&first)?);
    while at != first && ring.len() < next.len() {
        ring.push(at);
        at = *next.get(&at)?;
    }
    (at == first && ring.len() == next.len() && ring.len() >= 3).then_some(ring)
}

/// A simple polygon as triangles of its corners, none of them flat, by cutting off ears; `None` where that
/// fails.
fn ears(places: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let mut ring: Vec<usize> = (0..places.len()).collect();
    // Twice the area, whose sign says which way round it runs.
    let area: f64 = (0..places.len()).map(|k| places[k].perp_dot(places[(k + 1) % places.len()])).sum();
    let turns = |[a, b, c]: [usize; 3]| orient2d(places[a], places[b], places[c]) * area.signum();
    let mut triangles = Vec::new();
    while ring.len() > 3 {
        let n = ring.len();
        let ear = |k: usize| [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]];
        let is_free = |[a, b, c]: [usize; 3], p: usize| {
            [a, b, c].contains(&p) || [[a, b, p], [b, c, p], [c, a, p]].into_iter().any(|t| turns(t) < 0.0)
        };
        let found = (0..n).find(|&k| turns(ear(k)) > 0.0 && ring.iter().all(|&p| is_free(ear(k), p)))?;
        triangles.push(ear(found));
        ring.remove(found);
    }
    let last = [ring[0], ring[1], ring[2]];
    triangles.push(last);
    (turns(last) > 0.0).then_some(triangles)
}
