//! A scene as a floor plan: walls between points of the ground, which flatland has as segments and space as
//! upright rectangles, so that one description makes both. Flatland's y is space's −z.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::geometry::{Eye, MaterialId, ObjectId, PrimId, Space, Vector, View, ViewPath, raise};
use crate::scene::{Dropped, Face, Material, Object, Parts, Pose, Report};

/// Height of a wall, and of the eye, before both are scaled.
const WALL: [f64; 2] = [0.0, 3.0];
const EYE: f64 = 1.5;
/// What stands behind walls is lower, so that they hide it in space as in flatland.
const LOW: [f64; 2] = [0.5, 2.5];
/// Side of the images, pixels.
const SIDE_PX: u32 = 128;

/// Materials by number.
pub(super) const STONE: u32 = 0;
pub(super) const COLORS: [u32; 3] = [1, 2, 3];
pub(super) const GLASS: u32 = 4;
pub(super) const SHEET: u32 = 5;

/// A wall from one point of the plan to another; its front is to the left of the way.
struct Wall {
    ends: [DVec2; 2],
    levels: [f64; 2],
    object: u32,
    material: u32,
}

/// A level rectangle, which space alone has.
struct Lid {
    corners: [DVec2; 2],
    level: f64,
    object: u32,
}

/// Where the eye stands and looks to, with both heights.
struct Stop {
    from: (DVec2, f64),
    to: (DVec2, f64),
}

/// A plan in the making.
pub(super) struct Layout {
    walls: Vec<Wall>,
    lids: Vec<Lid>,
    objects: Vec<Object>,
    /// Way of each object that moves, a place a frame.
    ways: BTreeMap<u32, Vec<DVec2>>,
    stops: Vec<Stop>,
    material: u32,
    /// Everything is multiplied by this, then moved by `offset`.
    pub(super) scale: f64,
    pub(super) offset: DVec2,
    pub(super) fov_degrees: f64,
    /// Depth of the near plane, before it is scaled.
    pub(super) near: f64,
}

impl Layout {
    pub(super) fn new() -> Self {
        Self {
            walls: Vec::new(),
            lids: Vec::new(),
            objects: Vec::new(),
            ways: BTreeMap::new(),
            stops: Vec::new(),
            material: STONE,
            scale: 1.0,
            offset: DVec2::ZERO,
            fov_degrees: 60.0,
            near: 0.05,
        }
    }
    /// What follows is a new object.
    pub(super) fn begin(&mut self, name: impl Into<String>) {
        self.objects.push(Object { name: name.into(), group: String::new(), motion: None });
    }
    /// The object begun last moves so, a place a frame.
    pub(super) fn moves(&mut self, way: Vec<[f64; 2]>) {
        self.ways.insert(self.object(), way.into_iter().map(DVec2::from).collect());
    }
    /// What follows is made of this.
    pub(super) fn paint(&mut self, material: u32) {
        self.material = material;
    }
    fn object(&self) -> u32 {
        self.objects.len() as u32 - 1
    }
    /// A wall of full height.
    pub(super) fn wall(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.piece(from, to, WALL);
    }
    /// A wall between two heights.
    pub(super) fn piece(&mut self, from: [f64; 2], to: [f64; 2], levels: [f64; 2]) {
        let ends = [from, to].map(DVec2::from);
        self.walls.push(Wall { ends, levels, object: self.object(), material: self.material });
    }
    /// A closed block around a point, its fronts outside.
    pub(super) fn block(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], levels: [f64; 2]) {
        let corners = [[x - w, y - h], [x - w, y + h], [x + w, y + h], [x + w, y - h]];
        for k in 0..4 {
            self.piece(corners[k], corners[(k + 1) % 4], levels);
        }
        self.lid(corners[0], corners[2], levels[1]);
    }
    /// A roof over a rectangle.
    pub(super) fn lid(&mut self, low: [f64; 2], high: [f64; 2], level: f64) {
        let corners = [low, high].map(DVec2::from);
        self.lids.push(Lid { corners, level, object: self.object() });
    }
    /// A block of its own object that walls hide.
    pub(super) fn crate_at(&mut self, at: [f64; 2], half: [f64; 2]) {
        self.begin(format!("crate {}", self.objects.len()));
        self.paint(COLORS[self.objects.len() % COLORS.len()]);
        self.block(at, half, LOW);
        self.paint(STONE);
    }
    /// Crates in columns and rows over a rectangle.
    pub(super) fn crates(&mut self, low: [f64; 2], high: [f64; 2], [columns, rows]: [u32; 2]) {
        let [w, h] = [(high[0] - low[0]) / f64::from(columns), (high[1] - low[1]) / f64::from(rows)];
        for k in 0..columns * rows {
            let (i, j) = (f64::from(k % columns), f64::from(k / columns));
            self.crate_at([low[0] + (i + 0.5) * w, low[1] + (j + 0.5) * h], [0.3 * w, 0.3 * h]);
        }
    }
    /// A row of upright pieces along x, each its own object and color: `count` of `width`, from `left` on,
    /// `pitch` apart.
    pub(super) fn row(&mut self, y: f64, left: f64, count: u32, [pitch, width]: [f64; 2]) {
        for k in 0..count {
            let x = left + f64::from(k) * pitch;
            self.begin(format!("piece {}", self.objects.len()));
            self.paint(COLORS[k as usize % COLORS.len()]);
            self.piece([x + width, y], [x, y], LOW);
        }
        self.paint(STONE);
    }
    /// The path goes on here.
    pub(super) fn look(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.look_from(from, EYE, to, EYE);
    }
    /// The same from another height.
    pub(super) fn look_from(&mut self, from: [f64; 2], height: f64, to: [f64; 2], level: f64) {
        self.stops.push(Stop { from: (from.into(), height), to: (to.into(), level) });
    }

    /// The point over a place of the plan.
    fn point<S: Space>(&self, at: DVec2, level: f64) -> S::Vector {
        let at = at * self.scale + self.offset;
        // −0 becomes 0, so that equal points have equal bits.
        if S::Vector::AXES == 2 {
            return S::Vector::from_fn(|a| at[a] as f32 + 0.0);
        }
        let at: DVec3 = raise(at, level * self.scale);
        S::Vector::from_fn(|a| at[a] as f32 + 0.0)
    }
    fn path<S: Space>(&self) -> ViewPath<S> {
        let view = |stop: &Stop| {
            let eye = Eye {
                position: self.point::<S>(stop.from.0, stop.from.1),
                target: self.point::<S>(stop.to.0, stop.to.1),
                up: S::Vector::from_fn(|a| if a == 1 && S::Vector::AXES == 3 { 1.0 } else { 0.0 }),
                fov: self.fov_degrees.to_radians() as f32,
                near: (self.near * self.scale) as f32,
                far: (200.0 * self.scale) as f32,
            };
            View { eye, width: SIDE_PX, height: if S::Vector::AXES == 2 { 1 } else { SIDE_PX } }
        };
        ViewPath { name: "failure".into(), views: self.stops.iter().map(view).collect() }
    }
    /// The tables of a scene, with the path.
    pub(super) fn parts<S: Space>(mut self, name: &str, source: &str) -> Parts<S> {
        let mut tables = Tables::<S>::default();
        for wall in &self.walls {
            let [[a, b], [low, high]] = [wall.ends, wall.levels.map(DVec2::splat)];
            let ring: Vec<S::Vector> = match S::Vector::AXES {
                2 => vec![self.point::<S>(a, 0.0), self.point::<S>(b, 0.0)],
                // Seen from the left of the way, counter-clockwise.
                _ => [(b, low.x), (a, low.x), (a, high.x), (b, high.x)]
                    .map(|(at, level)| self.point::<S>(at, level))
                    .to_vec(),
            };
            tables.add(&ring, wall.object, wall.material);
        }
        for lid in self.lids.iter().filter(|_| S::Vector::AXES == 3) {
            let [low, high] = lid.corners;
            let ring = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
            tables.add(&ring.map(|at| self.point::<S>(at, lid.level)), lid.object, STONE);
        }
        let scale = self.scale;
        for (object, way) in &self.ways {
            let pose = |at: &DVec2| {
                let [x, y] = (*at * scale).to_array();
                let translation = if S::Vector::AXES == 2 { [x, y, 0.0] } else { [x, 0.0, -y] };
                Pose { rotation: [0.0, 0.0, 0.0, 1.0], translation: translation.map(|v| v as f32) }
            };
            let poses: Arc<[Pose]> = way.iter().map(pose).collect();
            self.objects[*object as usize].motion = Some(poses);
        }
        let path = self.path::<S>();
        let mut report = Report::default();
        report.drop(Dropped::Rounded, tables.dropped);
        Parts {
            name: name.to_owned(),
            source: source.to_owned(),
            points: tables.points,
            prims: tables.prims,
            prim_object: tables.prim_object,
            prim_material: tables.prim_material,
            faces: tables.faces,
            objects: self.objects,
            materials: materials(),
            origin: DVec3::ZERO,
            paths: vec![path],
            report,
        }
    }
}

/// Points and what is made of them, in the making; points at the same place are one.
struct Tables<S: Space> {
    places: BTreeMap<Vec<u32>, u32>,
    points: Vec<S::Vector>,
    prims: Vec<Option<S::Corners>>,
    prim_object: Vec<ObjectId>,
    prim_material: Vec<MaterialId>,
    faces: Vec<Face>,
    dropped: usize,
}

impl<S: Space> Default for Tables<S> {
    fn default() -> Self {
        let (points, prims, prim_object) = (Vec::new(), Vec::new(), Vec::new());
        let (prim_material, faces) = (Vec::new(), Vec::new());
        Self { places: BTreeMap::new(), points, prims, prim_object, prim_material, faces, dropped: 0 }
    }
}

impl<S: Space> Tables<S> {
    /// A segment, or a rectangle as two triangles. What rounding left without extent keeps its id.
    fn add(&mut self, ring: &[S::Vector], object: u32, material: u32) {
        let corners: Vec<u32> = ring.iter().map(|p| self.place(*p)).collect();
        let fan: &[[usize; 3]] = if ring.len() == 2 { &[[0, 1, 1]] } else { &[[0, 1, 2], [0, 2, 3]] };
        let first = self.prims.len() as u32;
        for at in fan {
            let [a, b, c] = at.map(|i| corners[i]);
            let is_there = a != b && (S::CORNERS == 2 || (b != c && a != c));
            self.prims.push(is_there.then(|| S::corners_from([a, b, c])));
            self.dropped += usize::from(!is_there);
            self.prim_object.push(ObjectId(object));
            self.prim_material.push(MaterialId(material));
        }
        let prims: Vec<PrimId> = (first..self.prims.len() as u32).map(PrimId).collect();
        if prims.len() > 1 && prims.iter().all(|p| self.prims[p.at()].is_some()) {
            self.faces.push(Face { corners, prims });
        }
    }
    fn place(&mut self, point: S::Vector) -> u32 {
        let key = (0..S::Vector::AXES).map(|a| point.get(a).to_bits()).collect();
        let next = self.points.len() as u32;
        let at = *self.places.entry(key).or_insert(next);
        if at == next {
            self.points.push(point);
        }
        at
    }
}

fn materials() -> Vec<Material> {
    let plain = |name: &str, color| Material::new(name, color);
    vec![
        plain("stone", [0.55, 0.53, 0.5]),
        plain("red", [0.62, 0.08, 0.05]),
        plain("blue", [0.05, 0.16, 0.52]),
        plain("yellow", [0.78, 0.55, 0.05]),
        Material { see_through: true, ..plain("glass", [0.5, 0.7, 0.75]) },
        Material { two_sided: true, ..plain("sheet", [0.72, 0.68, 0.58]) },
    ]
}
