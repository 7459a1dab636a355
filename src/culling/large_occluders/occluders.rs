//! Occluders made ready: their edges, the slab that holds them, and which edges they share.

use std::ops::Range;

use super::space::{Edge, Point, Shape, corners_of};
use crate::geometry::{Aabb, PrimId, Vector};
use crate::scene::Face;

/// Most corners of an occluder: a mask of its edges fits a word.
pub const MAX_EDGES: usize = 64;

/// A convex polygon that may hide things; a segment in flatland.
#[derive(Clone, Debug)]
pub struct Occluder<S: Shape> {
    /// Unit normal toward its front.
    pub normal: S::Point,
    /// Its first corner.
    pub anchor: S::Point,
    /// Its corners lie between these signed distances from the plane through `anchor`, world units: polygons
    /// of a file are planar only up to rounding, so an occluder's plane is a thin slab.
    pub slab: [f64; 2],
    /// Mean of its corners.
    pub center: S::Point,
    /// Area in square units (length in flatland).
    pub area: f64,
    /// Which of the faces it was made of.
    pub source: u32,
    /// Its edges in [`Occluders::edges`].
    edges: Range<u32>,
    /// Its primitives in [`Occluders::prims`].
    prims: Range<u32>,
}

/// The occluders of a scene by number, and their tables.
#[derive(Clone, Debug)]
pub struct Occluders<S: Shape> {
    all: Vec<Occluder<S>>,
    edges: Vec<Edge<S::Point>>,
    /// For each edge the number of its pair of corners, which edges of other occluders have too; and its
    /// sense.
    keys: Vec<(u32, bool)>,
    key_count: usize,
    prims: Vec<PrimId>,
}

impl<S: Shape> Occluder<S> {
    /// With these corners; `None` without area.
    fn of(corners: &[S::Point], source: u32, edges: Range<u32>, prims: Range<u32>) -> Option<Self> {
        // Without area there is no normal, and nothing to hide behind.
        let vector = S::area(corners);
        let area = vector.length();
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        // From the sum over all corners: where rounding bent the polygon, a normal from three of them would
        // depend on which three.
        let (normal, anchor) = (vector * (1.0 / area), corners[0]);
        let heights = corners.iter().map(|c| normal.dot(*c - anchor));
        // From 0, at which the anchor itself lies.
        let slab = heights.fold([0.0f64; 2], |[low, high], h| [low.min(h), high.max(h)]);
        // The mean of the corners, not the centroid of the area: it serves to choose occluders and to label
        // them, and no claim rests on it.
        let center =
            corners.iter().fold(S::Point::default(), |sum, c| sum + *c) * (1.0 / corners.len() as f64);
        Some(Self { normal, anchor, slab, center, area, source, edges, prims })
    }
}

impl<S: Shape> Occluders<S> {
    /// Makes ready those faces that can hide anything: at most [`MAX_EDGES`] corners and some area.
    pub fn new(points: &[S::Vector], faces: &[Face]) -> Self {
        // Rebuilt with fewer faces, the same ones come out alike: nothing depends on the others but numbers.
        let mut made =
            Self { all: Vec::new(), edges: Vec::new(), keys: Vec::new(), key_count: 0, prims: Vec::new() };
        let mut names: Vec<([u32; 2], u32)> = Vec::new();
        for (source, face) in faces.iter().enumerate().filter(|(_, f)| f.corners.len() <= MAX_EDGES) {
            let corners = corners_of::<S>(points, &face.corners);
            let (edge, prim) = (made.edges.len() as u32, made.prims.len() as u32);
            let edges = edge..edge + corners.len() as u32;
            let prims = prim..prim + face.prims.len() as u32;
            let Some(occluder) = Occluder::of(&corners, source as u32, edges, prims) else { continue };
            // Tables beside each other, not a vector for each: testing reads edges of many occluders in a
            // row.
            for i in 0..corners.len() {
                let (name, sense) = S::edge_key(&face.corners, i);
                names.push((name, made.edges.len() as u32));
                made.edges.push(S::edge(&corners, i));
                made.keys.push((0, sense));
            }
            // Kept for back-face culling, which asks each of them exactly, and for the name.
            made.prims.extend(&face.prims);
            made.all.push(occluder);
        }
        // Equal corner pairs get equal numbers: whether two occluders share an edge is then a comparison.
        names.sort_unstable();
        for (i, (name, edge)) in names.iter().enumerate() {
            made.key_count += usize::from(i == 0 || names[i - 1].0 != *name);
            made.keys[*edge as usize].0 = made.key_count as u32 - 1;
        }
        made
    }

    /// Brings those with these numbers and faces to where their points are now. False if one of them has no
    /// area there.
    pub fn follow(&mut self, points: &[S::Vector], moving: &[(u32, Face)]) -> bool {
        for (id, face) in moving {
            let corners = corners_of::<S>(points, &face.corners);
            let Occluder { source, edges, prims, .. } = self.all[*id as usize].clone();
            let Some(occluder) = Occluder::of(&corners, source, edges.clone(), prims) else { return false };
            self.all[*id as usize] = occluder;
            for (i, edge) in edges.enumerate() {
                self.edges[edge as usize] = S::edge(&corners, i);
            }
        }
        true
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.all.len()
    }
    /// One of them.
    #[inline]
    pub fn get(&self, id: u32) -> &Occluder<S> {
        &self.all[id as usize]
    }
    /// The edges of one.
    #[inline]
    pub fn edges(&self, id: u32) -> &[Edge<S::Point>] {
        let r = &self.all[id as usize].edges;
        &self.edges[r.start as usize..r.end as usize]
    }
    /// For each edge of one the number of its corner pair and its sense.
    #[inline]
    pub fn keys(&self, id: u32) -> &[(u32, bool)] {
        let r = &self.all[id as usize].edges;
        &self.keys[r.start as usize..r.end as usize]
    }
    /// Number of different corner pairs.
    pub fn key_count(&self) -> usize {
        self.key_count
    }
    /// The primitives that tile one, ascending.
    pub fn prims(&self, id: u32) -> &[PrimId] {
        let r = &self.all[id as usize].prims;
        &self.prims[r.start as usize..r.end as usize]
    }
    /// The outline of one, for drawing.
    pub fn outline(&self, id: u32) -> Vec<S::Vector> {
        // Nothing is lost: the corners were 32 bits wide before they were widened.
        self.edges(id).iter().map(|e| S::rounded(e.from)).collect()
    }
    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        self.all.len() * size_of::<Occluder<S>>()
            + self.edges.len() * size_of::<Edge<S::Point>>()
            + self.keys.len() * size_of::<(u32, bool)>()
            + self.prims.len() * size_of::<PrimId>()
    }
    /// Thickness of an occluder's slab, world units.
    #[inline]
    pub fn thickness(&self, id: u32) -> f64 {
        let [low, high] = self.all[id as usize].slab;
        high - low
    }
    /// The first primitive of an occluder, by which people name it.
    pub fn name(&self, id: u32) -> PrimId {
        self.prims(id).first().copied().unwrap_or_default()
    }

    /// Whether an occluder's slab cuts or touches a box.
    pub fn cuts(&self, id: u32, bounds: &Aabb<S::Vector>) -> bool {
        // By the slab and not a plane in it: what lies within is neither before nor behind the occluder for
        // certain.
        let ([low, high], slab) = (self.heights(id, bounds), self.all[id as usize].slab);
        low <= slab[1] && slab[0] <= high
    }
    /// Signed distances of a box from the plane through an occluder's first corner: of its lowest and its
    /// highest corner.
    #[inline]
    pub fn heights(&self, id: u32, bounds: &Aabb<S::Vector>) -> [f64; 2] {
        let occluder = &self.all[id as usize];
        // Axis by axis the lower and the higher end: two corners in place of all.
        let (mut low, mut high) = (0.0, 0.0);
        for axis in 0..S::Vector::AXES {
            // Relative to the anchor: differences of widened coordinates are exact, so a scene far from the
            // origin loses nothing.
            let (n, o) = (occluder.normal.get(axis), occluder.anchor.get(axis));
            let (a, b) =
                (n * (f64::from(bounds.min.get(axis)) - o), n * (f64::from(bounds.max.get(axis)) - o));
            low += a.min(b);
            high += a.max(b);
        }
        [low, high]
    }
}

/// The area-angle of an occluder from a point: an estimate of the solid angle (in flatland: the angle) that
/// it subtends.
pub fn area_angle<S: Shape>(occluder: &Occluder<S>, from: S::Point) -> f64 {
    let toward = occluder.center - from;
    let distance = toward.length();
    // The amount without the sign of the paper, which makes only the front count: here occluders hide from
    // both sides. At the very center no angle is defined, and 0 keeps the occluder out.
    let power = if S::Vector::AXES == 2 { distance } else { distance * distance };
    if power > 0.0 { occluder.area * (occluder.normal.dot(toward) / distance).abs() / power } else { 0.0 }
}
