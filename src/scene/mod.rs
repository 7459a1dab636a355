//! What is looked at: load, generate, preprocess, validate. The only door for outside data.
//!
//! After [`Scene::new`] every coordinate is finite, every corner index is in range and there is at
//! least one live primitive, so nothing behind this door can fail.

mod about;
mod assemble;
mod atoms;
mod circle;
mod example;
mod flat;
mod generate;
mod gltf;
mod json;
mod load;
mod merge;
mod mesh;
mod mtl;
mod obj;
mod palette;
mod paths;
mod pdb;
mod polygon;
mod pose;
mod progress;
mod report;
mod rounding;
#[cfg(test)]
pub(crate) mod samples;
mod source;
mod surfaces;
mod text;
mod views;
mod xyz;

pub use about::{About, Expectation};
pub use assemble::MAX_PRIMS;
pub use example::example;
pub use generate::{Failure, Generator, GeneratorParam, Symptom, failures, generators};
pub use load::{file_of, load, load_bytes};
pub use paths::{figure_eight_path, motion_path, random_views};
pub use pose::Motion;
pub use progress::{Part, Progress, Quiet};
pub use report::{Dropped, Report, SceneError};
pub use rounding::MAX_COORDINATE;
pub use source::{LoadOptions, Recenter};
pub use surfaces::Surfaces;
pub use views::{parse_views, read_views, write_views};

use std::sync::Arc;

use glam::DVec3;
use sha2::{Digest, Sha256};

use crate::geometry::{
    Aabb, Either, Flat, MaterialId, ObjectId, PrimId, Solid, Space, View, ViewPath, faces_away,
};

/// A named part of a scene: an `o` or `g` of an OBJ file, a node of a glTF file, a flatland object.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name; unique names are not required.
    pub name: String,
    /// Name of the group it belongs to, or empty.
    pub group: String,
    /// Rigid motion, if it moves: one transform a frame, repeated; applied to the stored points, which then
    /// are its own. See [`Motion`].
    pub motion: Option<Arc<[Pose]>>,
}

/// A rigid transform: rotation by the unit quaternion `[x, y, z, w]`, then translation.
/// In flatland only rotation about z and translation in x, y are used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Unit quaternion.
    pub rotation: [f32; 4],
    /// World units.
    pub translation: [f32; 3],
}

/// How a primitive is colored, and what it lets through.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// Diffuse color (Kd), linear 0..1.
    pub color: [f32; 3],
    /// Whether light comes through, if only in places: blended, cut out by a mask, or transmissive. Such a
    /// primitive is drawn and hides nothing.
    pub see_through: bool,
    /// Whether it is seen from behind as well, so that back-face culling leaves it alone.
    pub two_sided: bool,
}

impl Material {
    /// An opaque material with a front only.
    pub fn new(name: impl Into<String>, color: [f32; 3]) -> Self {
        Self { name: name.into(), color, see_through: false, two_sided: false }
    }
}

/// A planar convex polygon (in flatland: a segment) made of one or more primitives. What occluders are.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Point indices in order, counter-clockwise seen from the front.
    pub corners: Vec<u32>,
    /// The primitives that tile it, ascending.
    pub prims: Vec<PrimId>,
}

/// Everything a reader or generator hands over; [`Scene::new`] validates it.
#[derive(Clone, Debug)]
pub struct Parts<S: Space> {
    /// Short name, such as the file's stem.
    pub name: String,
    /// Where it came from: a path as given, or `generate:NAME?…`.
    pub source: String,
    /// Shared points, world units, after `origin` was subtracted.
    pub points: Vec<S::Vector>,
    /// Corners of each primitive by [`PrimId`]; `None` was dropped and keeps its id.
    pub prims: Vec<Option<S::Corners>>,
    /// Object of each primitive.
    pub prim_object: Vec<ObjectId>,
    /// Material of each primitive.
    pub prim_material: Vec<MaterialId>,
    /// Planar convex polygons of more than one primitive. A primitive that none of them names stands for
    /// itself.
    pub faces: Vec<Face>,
    /// Objects by [`ObjectId`].
    pub objects: Vec<Object>,
    /// Materials by [`MaterialId`].
    pub materials: Vec<Material>,
    /// What was subtracted from the file's coordinates, for models far from their origin.
    pub origin: DVec3,
    /// View paths that came with it (in the same recentered coordinates), such as `eyes` and `walk`.
    pub paths: Vec<ViewPath<S>>,
    /// What was noticed while loading.
    pub report: Report,
}

impl<S: Space> Parts<S> {
    /// One object of one material made of these primitives; for generators and tests.
    pub fn simple(name: &str, points: Vec<S::Vector>, prims: Vec<S::Corners>) -> Self {
        let n = prims.len();
        Self {
            name: name.to_owned(),
            source: name.to_owned(),
            points,
            prims: prims.into_iter().map(Some).collect(),
            prim_object: vec![ObjectId(0); n],
            prim_material: vec![MaterialId(0); n],
            faces: Vec::new(),
            objects: vec![Object { name: name.to_owned(), group: String::new(), motion: None }],
            materials: vec![Material::new("default", mtl::GRAY)],
            origin: DVec3::ZERO,
            paths: Vec::new(),
            report: Report::default(),
        }
    }
}

/// A validated scene. Frozen; shared by reference.
#[derive(Clone, Debug)]
pub struct Scene<S: Space> {
    /// All that stays from frame to frame where objects move; shared by the scenes of all frames.
    tables: Arc<Tables<S>>,
    points: Vec<S::Vector>,
    bounds: Aabb<S::Vector>,
    hash: [u8; 32],
    has_see_through: bool,
    frame: Option<usize>,
    about: Arc<About>,
}

/// A scene without its points.
#[derive(Clone, Debug)]
struct Tables<S: Space> {
    /// Its points are those of the scene.
    parts: Parts<S>,
    live: Vec<PrimId>,
    moving: Vec<PrimId>,
}

impl<S: Space> Scene<S> {
    /// The only door in.
    ///
    /// # Errors
    /// [`SceneError::Empty`] if no primitive is live, [`SceneError::Inconsistent`] if a table does not
    /// fit another one (a reader's fault, not the file's).
    pub fn new(mut parts: Parts<S>) -> Result<Self, SceneError> {
        parts.report.settle();
        let n = parts.prims.len();
        let bad = |what: &'static str| SceneError::Inconsistent { scene: parts.source.clone(), what };
        if parts.prim_object.len() != n || parts.prim_material.len() != n {
            return Err(bad("a per-primitive table has another length than the primitives"));
        }
        let in_points = |c: &u32| (*c as usize) < parts.points.len();
        if !parts.prims.iter().flatten().all(|c| c.as_ref().iter().all(in_points))
            || !parts.faces.iter().all(|f| f.corners.iter().all(in_points))
        {
            return Err(bad("a corner points past the last point"));
        }
        if !parts.points.iter().all(|p| crate::geometry::Vector::is_finite(*p)) {
            return Err(bad("a point is not finite"));
        }
        if parts.prim_object.iter().any(|o| o.at() >= parts.objects.len())
            || parts.prim_material.iter().any(|m| m.at() >= parts.materials.len())
        {
            return Err(bad("a primitive names an object or material that is not there"));
        }
        let live: Vec<PrimId> = (0..n as u32).map(PrimId).filter(|p| parts.prims[p.at()].is_some()).collect();
        if live.is_empty() {
            let why = parts.report.reasons();
            return Err(SceneError::Empty { scene: parts.source, prim: S::PRIM, why });
        }
        if parts.objects.iter().any(|o| o.motion.is_some()) {
            pose::split(&mut parts);
        }
        let hash = digest(&parts);
        // Asked before each primitive's own material, which most scenes then need not look up.
        let has_see_through =
            live.iter().any(|p| parts.materials[parts.prim_material[p.at()].at()].see_through);
        let moves = |p: &PrimId| parts.objects[parts.prim_object[p.at()].at()].motion.is_some();
        let moving = live.iter().copied().filter(moves).collect();
        let points = std::mem::take(&mut parts.points);
        let tables = Arc::new(Tables { parts, live, moving });
        let (frame, about) = (None, Arc::default());
        let mut scene = Self { bounds: Aabb::empty(), tables, points, hash, has_see_through, frame, about };
        scene.bounds = scene.live().iter().fold(Aabb::empty(), |b, &p| b.union(scene.prim_bounds(p)));
        Ok(scene)
    }

    /// Short name.
    pub fn name(&self) -> &str {
        &self.tables.parts.name
    }
    /// Where it came from, as it may be given on the command line again.
    pub fn source(&self) -> &str {
        &self.tables.parts.source
    }
    /// All points.
    pub fn points(&self) -> &[S::Vector] {
        &self.points
    }
    /// Number of primitive ids, dropped ones included.
    pub fn prim_count(&self) -> usize {
        self.tables.parts.prims.len()
    }
    /// Ids of the primitives that exist, ascending; never empty.
    pub fn live(&self) -> &[PrimId] {
        &self.tables.live
    }
    /// Corner indices of a primitive, or `None` if it was dropped.
    #[inline]
    pub fn corners(&self, prim: PrimId) -> Option<S::Corners> {
        self.tables.parts.prims[prim.at()]
    }
    /// Corner points of a live primitive (two or three).
    #[inline]
    pub fn prim_points(&self, prim: PrimId) -> impl Iterator<Item = S::Vector> + '_ {
        let corners = self.tables.parts.prims[prim.at()];
        (0..S::CORNERS).filter_map(move |i| corners.map(|c| self.points[c.as_ref()[i] as usize]))
    }
    /// Bounds of a live primitive.
    #[inline]
    pub fn prim_bounds(&self, prim: PrimId) -> Aabb<S::Vector> {
        Aabb::of(self.prim_points(prim))
    }
    /// Object of a primitive.
    pub fn object_of(&self, prim: PrimId) -> ObjectId {
        self.tables.parts.prim_object[prim.at()]
    }
    /// Linear diffuse color of a primitive.
    pub fn color_of(&self, prim: PrimId) -> [f32; 3] {
        self.tables.parts.materials[self.tables.parts.prim_material[prim.at()].at()].color
    }
    /// Material of a primitive.
    pub fn material_of(&self, prim: PrimId) -> MaterialId {
        self.tables.parts.prim_material[prim.at()]
    }
    /// Whether light comes through a primitive, so that it hides nothing.
    #[inline]
    pub fn is_see_through(&self, prim: PrimId) -> bool {
        self.has_see_through
            && self.tables.parts.materials[self.tables.parts.prim_material[prim.at()].at()].see_through
    }
    /// Whether it does through any live primitive.
    pub fn has_see_through(&self) -> bool {
        self.has_see_through
    }
    /// Whether a primitive is seen from behind as from the front, where sides matter.
    #[inline]
    pub fn is_two_sided(&self, prim: PrimId) -> bool {
        self.tables.parts.materials[self.tables.parts.prim_material[prim.at()].at()].two_sided
    }
    /// Whether a live primitive turns its back to an eye and has one: strictly, in exact arithmetic.
    #[inline]
    pub fn faces_away(&self, prim: PrimId, eye: S::Vector) -> bool {
        if self.is_two_sided(prim) {
            return false;
        }
        let mut corners = [S::Vector::default(); 3];
        for (to, from) in corners.iter_mut().zip(self.prim_points(prim)) {
            *to = from;
        }
        faces_away::<S>(eye, &corners[..S::CORNERS])
    }
    /// All objects.
    pub fn objects(&self) -> &[Object] {
        &self.tables.parts.objects
    }
    /// All materials.
    pub fn materials(&self) -> &[Material] {
        &self.tables.parts.materials
    }
    /// Planar convex polygons.
    pub fn faces(&self) -> &[Face] {
        &self.tables.parts.faces
    }
    /// Bounds of all live primitives.
    pub fn bounds(&self) -> Aabb<S::Vector> {
        self.bounds
    }
    /// What was subtracted from the file's coordinates.
    pub fn origin(&self) -> DVec3 {
        self.tables.parts.origin
    }
    /// View paths that came with the scene.
    pub fn paths(&self) -> &[ViewPath<S>] {
        &self.tables.parts.paths
    }
    /// What was noticed while loading.
    pub fn report(&self) -> &Report {
        &self.tables.parts.report
    }
    /// What it is for, and facts to expect.
    pub fn about(&self) -> &About {
        &self.about
    }
    /// Adds view paths and notes that were found beside a model.
    fn extend(&mut self, paths: Vec<ViewPath<S>>, notes: Vec<String>) {
        // The only reference so far, so nothing is copied.
        let parts = &mut Arc::make_mut(&mut self.tables).parts;
        parts.paths.extend(paths);
        notes.into_iter().for_each(|n| parts.report.note(n));
    }
    /// The same scene, saying this about itself.
    pub fn with_about(mut self, about: About) -> Self {
        self.about = Arc::new(about);
        self
    }
    /// Live primitives of objects that move, ascending.
    pub fn moving(&self) -> &[PrimId] {
        &self.tables.moving
    }
    /// Whether a primitive belongs to an object that moves.
    #[inline]
    pub fn is_moving(&self, prim: PrimId) -> bool {
        self.objects()[self.object_of(prim).at()].motion.is_some()
    }
    /// The frame of its motions that it shows; `None` if it is as it was loaded.
    pub fn frame(&self) -> Option<usize> {
        self.frame
    }
    /// SHA-256 of the geometry (points, corners, objects, materials, motions), lower-case hex; of a frame of
    /// a scene that moves, of that hash and the frame's number.
    pub fn hash_hex(&self) -> String {
        self.hash.iter().map(|b| format!("{b:02x}")).collect()
    }
    /// Bytes that the tables take, names left out.
    pub fn memory_bytes(&self) -> usize {
        use std::mem::size_of;
        let faces: usize = self
            .tables
            .parts
            .faces
            .iter()
            .map(|f| size_of::<Face>() + 4 * (f.corners.len() + f.prims.len()))
            .sum();
        self.points.len() * size_of::<S::Vector>()
            + self.tables.parts.prims.len()
                * (size_of::<Option<S::Corners>>() + size_of::<ObjectId>() + size_of::<MaterialId>())
            + self.tables.live.len() * size_of::<PrimId>()
            + faces
    }
    /// The parts again, to make another scene of them.
    pub fn into_parts(self) -> Parts<S> {
        Parts { points: self.points, ..Arc::unwrap_or_clone(self.tables).parts }
    }
    /// Normal of a live primitive, not of unit length; see [`Space::normal`].
    #[inline]
    pub fn normal(&self, prim: PrimId) -> S::Vector {
        let mut p = [S::Vector::default(); 3];
        for (to, from) in p.iter_mut().zip(self.prim_points(prim)) {
            *to = from;
        }
        S::normal(&p[..S::CORNERS])
    }
}

/// A scene of either space.
pub type AnyScene = Either<Arc<Scene<Flat>>, Arc<Scene<Solid>>>;

impl From<Scene<Flat>> for AnyScene {
    fn from(scene: Scene<Flat>) -> Self {
        Self::Flat(Arc::new(scene))
    }
}

impl From<Scene<Solid>> for AnyScene {
    fn from(scene: Scene<Solid>) -> Self {
        Self::Solid(Arc::new(scene))
    }
}

fn digest<S: Space>(parts: &Parts<S>) -> [u8; 32] {
    use crate::geometry::Vector;
    /// Hands the hash whole blocks: a call for every number would take longer than the hashing.
    struct Blocks(Sha256, Vec<u8>);
    impl Blocks {
        fn update(&mut self, bytes: impl AsRef<[u8]>) {
            self.1.extend_from_slice(bytes.as_ref());
            if self.1.len() > 1 << 15 {
                self.0.update(&self.1);
                self.1.clear();
            }
        }
    }
    let mut hash = Blocks(Sha256::new(), Vec::new());
    hash.update(S::NAME);
    for p in &parts.points {
        (0..S::Vector::AXES).for_each(|a| hash.update(p.get(a).to_le_bytes()));
    }
    for (i, corners) in parts.prims.iter().enumerate() {
        match corners {
            Some(c) => c.as_ref().iter().for_each(|k| hash.update(k.to_le_bytes())),
            None => hash.update(u32::MAX.to_le_bytes()),
        }
        hash.update(parts.prim_object[i].0.to_le_bytes());
        let material = &parts.materials[parts.prim_material[i].at()];
        material.color.iter().for_each(|c| hash.update(c.to_le_bytes()));
        // Only what departs from the plain material, so that plain scenes keep the hash that old traces name.
        if material.see_through || material.two_sided {
            hash.update([u8::from(material.see_through), u8::from(material.two_sided)]);
        }
    }
    // Likewise only what moves.
    for (i, object) in parts.objects.iter().enumerate() {
        for pose in object.motion.iter().flat_map(|m| m.iter()) {
            hash.update((i as u32).to_le_bytes());
            pose.rotation.iter().chain(&pose.translation).for_each(|v| hash.update(v.to_le_bytes()));
        }
    }
    hash.0.update(&hash.1);
    hash.0.finalize().into()
}

/// A view that frames the whole scene: from the front, right and above in space; from below in flatland. Its
/// depths reach from a thousandth of the scene's diagonal to a diagonal beyond it, so that one can walk in.
pub fn framing_view<S: Space>(bounds: &Aabb<S::Vector>, width: u32, height: u32) -> View<S> {
    use crate::geometry::{Eye, Vector};
    let fov = 60f32.to_radians();
    let center = bounds.center();
    let radius = (bounds.diagonal() * 0.5).max(1e-3);
    let toward =
        S::Vector::from_fn(|a| if S::Vector::AXES == 2 { [0.0, -1.0][a] } else { [0.6, 0.5, 0.8][a] });
    let distance = radius / (fov * 0.5).sin() * 1.05;
    let position = center + toward * (distance / toward.length());
    let up = S::Vector::from_fn(|a| if a == 1 { 1.0 } else { 0.0 });
    let eye = Eye { position, target: center, up, fov, near: radius * 2e-3, far: distance + radius * 3.0 };
    View { eye, width, height: if S::Vector::AXES == 2 { 1 } else { height } }
}
