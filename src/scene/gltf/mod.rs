//! glTF 2.0 and GLB, read by types of our own: only what is needed, with every bound checked (Khronos, "glTF
//! 2.0 Specification", 2021).
//!
//! Each node with a mesh becomes an object under its transform, and so does each of its instances; triangles,
//! strips and fans become triangles in the order of the node tree. Skins stand at their joints at rest, morph
//! targets at their default weights. The first animation becomes motions where it is rigid, cameras become
//! view paths. What is left out is said once, with names and counts. Cost: O(file), times the instances of
//! each mesh up to a limit.

mod camera;
mod codec;
mod container;
mod data;
mod file;
mod lost;
mod motion;
mod paint;
mod shape;
mod skin;
mod tree;

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use self::data::Data;
use self::file::{Gltf, Index, short};
use self::lost::{Lost, Sentence};
use self::motion::Clip;
use self::paint::{Alpha, Materials};
use self::shape::Shape;
use self::skin::Skin;
use self::tree::{Stand, Tree, turn};
use super::assemble::assemble;
use super::mesh::Mesh;
use super::report::counted;
use super::{Dropped, LoadOptions, Object, Part, Parts, Pose, Progress, Report, SceneError, palette};
use crate::geometry::{Aabb, Solid};

/// Points, corners and instances that every file may multiply to: some gigabytes of tables. A longer file may
/// have one a byte.
const FREE_INSTANCED: usize = 1 << 25;

const MORPHED: Sentence = [
    "1 primitive with morph targets, shown at the default weights",
    "# primitives with morph targets, shown at the default weights",
];
const BAD_SKIN: Sentence = [
    "1 skin is not valid, so its meshes stand where their nodes are",
    "# skins are not valid, so their meshes stand where their nodes are",
];
const UNSHOWN: Sentence =
    ["1 mesh is shown by no node of the scene", "# meshes are shown by no node of the scene"];
const BENT: Sentence =
    ["1 object scaled by the animation stands still", "# objects scaled by the animation stand still"];

/// Reads glTF JSON or GLB: the scene of this number, or the default one. Without a `folder` no buffer file is
/// opened.
pub(super) fn read(
    bytes: &[u8],
    folder: Option<&Path>,
    name: &str,
    source: &str,
    scene: Option<usize>,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let format = |why: String| SceneError::Format { path: source.to_owned(), why };
    let mut report = Report::default();
    let (gltf, chunk) = container::open(bytes, source, &mut report)?;
    lost::check(&gltf, &mut report).map_err(format)?;
    let roots = tree::roots(&gltf, scene, &mut report).map_err(format)?;
    let tree = Tree::walk(&gltf, &roots, source, progress)?;
    let data = Data::new(&gltf, chunk, folder, bytes.len());
    let mut reader = Reader::new(&gltf, &data, &tree);
    reader.nodes(source, progress)?;
    reader.tell(&mut report);
    let Reader { mut mesh, materials, placed, skinned, .. } = reader;
    if mesh.faces.is_empty() {
        return Err(format(why_empty(&gltf, &report)));
    }
    mesh.materials = materials.made;
    lost::left_out(&gltf, &mut report);
    let clip = Clip::read(&gltf, &data, &tree, &mut report);
    if !mesh.colors.is_empty() {
        palette::paint(&mut mesh, &mut report);
    }
    let part = Part { whole: progress, start: 0.5, length: 0.5 };
    let mut parts = assemble(mesh, name, source, options, report, &part)?;
    let moved = Moved { gltf: &gltf, tree: &tree, placed: &placed, skinned: &skinned };
    moved.attach(clip.as_ref(), &mut parts, progress);
    if progress.cancelled() {
        return Err(SceneError::Cancelled(source.to_owned()));
    }
    Ok(parts)
}

/// Why there is nothing to show: what there is, and the first of what was noticed.
fn why_empty(gltf: &Gltf, report: &Report) -> String {
    let (meshes, nodes) = (counted(gltf.meshes.len(), "mesh"), counted(gltf.nodes.len(), "node"));
    let mut why = format!("it has no triangles in its scene ({meshes}, {nodes})");
    for note in report.notes.iter().take(3) {
        why += "; ";
        why += note;
    }
    why
}

/// The primitives of a mesh.
type Shapes = Rc<Vec<Shape>>;

struct Reader<'a> {
    gltf: &'a Gltf,
    data: &'a Data<'a>,
    tree: &'a Tree,
    mesh: Mesh,
    materials: Materials,
    lost: Lost,
    /// The node with which each object moves, if it does not follow joints.
    placed: Vec<Option<Index>>,
    /// Objects that follow joints, and their skins.
    skinned: Vec<Index>,
    /// How many nodes show each mesh, and what was read of those that several show.
    uses: Vec<u32>,
    shapes: BTreeMap<Index, Shapes>,
    skins: BTreeMap<Index, Result<Rc<Skin>, String>>,
    /// Points, corners and instances that may still come.
    left: usize,
    most: usize,
}

impl<'a> Reader<'a> {
    fn new(gltf: &'a Gltf, data: &'a Data<'a>, tree: &'a Tree) -> Self {
        let mut uses = vec![0; gltf.meshes.len()];
        for node in tree.order.iter().filter(|n| tree.shown[**n as usize]) {
            let mesh = gltf.nodes[*node as usize].mesh;
            if let Some(count) = mesh.and_then(|m| uses.get_mut(m as usize)) {
                *count += 1;
            }
        }
        Self {
            gltf,
            data,
            tree,
            mesh: Mesh::default(),
            materials: Materials::default(),
            lost: Lost::default(),
            placed: Vec::new(),
            skinned: Vec::new(),
            uses,
            shapes: BTreeMap::new(),
            skins: BTreeMap::new(),
            left: FREE_INSTANCED,
            most: FREE_INSTANCED,
        }
    }

    /// Makes the objects of all nodes that are shown.
    fn nodes(&mut self, source: &str, progress: &dyn Progress) -> Result<(), SceneError> {
        let format = |why: String| {
            // A buffer that cannot be read is the reason, whatever asked for it first.
            let why = self.data.fault().map_or(why, str::to_owned);
            SceneError::Format { path: source.to_owned(), why }
        };
        let (mut done, mut asked) = (0, 0);
        for (k, index) in self.tree.order.iter().enumerate() {
            // By what was made, since one node may hold everything.
            if k - asked > 1_024 || self.mesh.faces.len() - done > 65_536 {
                (done, asked) = (self.mesh.faces.len(), k);
                progress.report(k as f32 / self.tree.order.len() as f32 * 0.5, "reading meshes");
                if progress.cancelled() {
                    return Err(SceneError::Cancelled(source.to_owned()));
                }
            }
            if let Some(mesh) =
                self.gltf.nodes[*index as usize].mesh.filter(|_| self.tree.shown[*index as usize])
            {
                self.node(*index, mesh, progress).map_err(format)?;
            }
            if progress.cancelled() {
                return Err(SceneError::Cancelled(source.to_owned()));
            }
        }
        Ok(())
    }

    fn node(&mut self, index: Index, mesh: Index, progress: &dyn Progress) -> Result<(), String> {
        let node = &self.gltf.nodes[index as usize];
        let Some(named) = self.gltf.meshes.get(mesh as usize) else {
            return Err(format!(
                "node {index} shows mesh {mesh}, but there are only {}",
                self.gltf.meshes.len()
            ));
        };
        let name = node.name.as_deref().or(named.name.as_deref());
        let name = name.map_or_else(|| format!("node_{index}"), short);
        let above =
            self.tree.parents[index as usize].and_then(|p| self.gltf.nodes[p as usize].name.as_deref());
        let shapes = self.shapes(index, mesh)?;
        let skin = match node.skin {
            Some(skin) => self.skin(skin),
            None => None,
        };
        if let Some(skin) = skin.filter(|_| shapes.iter().any(|s| !s.influences.is_empty())) {
            let object = self.object(name, above.map_or(String::new(), short), None);
            self.skinned.extend(node.skin);
            return shapes.iter().try_for_each(|shape| self.place_skinned(shape, &skin, index, object));
        }
        let world = self.tree.worlds[index as usize];
        let Some(instances) = self.instances(index)? else {
            let object = self.object(name, above.map_or(String::new(), short), Some(index));
            return shapes.iter().try_for_each(|shape| self.place(shape, &world, object));
        };
        for (k, stand) in instances.iter().enumerate() {
            if progress.cancelled() {
                return Ok(());
            }
            let object = self.object(format!("{name}_{k}"), name.clone(), Some(index));
            let world = world * stand.matrix();
            shapes.iter().try_for_each(|shape| self.place(shape, &world, object))?;
        }
        Ok(())
    }

    fn object(&mut self, name: String, group: String, node: Option<Index>) -> u32 {
        self.mesh.objects.push(Object { name, group, motion: None });
        self.placed.push(node);
        self.mesh.objects.len() as u32 - 1
    }

    /// The primitives of a mesh as a node shows it. They are kept where other nodes show them alike.
    fn shapes(&mut self, node: Index, mesh: Index) -> Result<Shapes, String> {
        let shown = &self.gltf.nodes[node as usize];
        let alike = shown.weights.is_none() && shown.skin.is_none() && self.uses[mesh as usize] > 1;
        if let Some(shapes) = self.shapes.get(&mesh).filter(|_| alike) {
            return Ok(shapes.clone());
        }
        let own = &self.gltf.meshes[mesh as usize];
        let reader = shape::Reader {
            gltf: self.gltf,
            data: self.data,
            // "If defined on a node, they override those of the mesh" (3.7.2.2).
            weights: shown.weights.as_ref().unwrap_or(&own.weights),
            skinned: shown.skin.is_some(),
            most: FREE_INSTANCED.max(self.data.file_bytes()),
        };
        let mut shapes = Vec::new();
        for (k, primitive) in own.primitives.iter().enumerate() {
            let at = (mesh as usize, k);
            if !primitive.targets.is_empty() {
                let name = || self.gltf.mesh_name(at.0);
                self.lost.add(MORPHED, at, name);
            }
            let read = reader.read(at, &mut self.lost);
            shapes.extend(read.map_err(|why| format!("mesh {mesh}, primitive {k}: {why}"))?);
        }
        let shapes = Rc::new(shapes);
        if alike {
            self.shapes.insert(mesh, shapes.clone());
        }
        Ok(shapes)
    }

    /// A skin, unless it is not valid, which becomes a note.
    fn skin(&mut self, index: Index) -> Option<Rc<Skin>> {
        let read = || Skin::read(self.gltf, self.data, self.tree, index).map(Rc::new);
        let skin = self.skins.entry(index).or_insert_with(read);
        skin.clone()
            .map_err(|why| {
                self.lost.add(BAD_SKIN, (index as usize, 0), || format!("skin {index}: {why}"));
            })
            .ok()
    }

    /// Where the instances of a node's mesh stand in the node (EXT_mesh_gpu_instancing).
    fn instances(&mut self, index: Index) -> Result<Option<Vec<Stand>>, String> {
        let extensions = self.gltf.nodes[index as usize].extensions.as_ref();
        let Some(instancing) = extensions.and_then(|e| e.instancing.as_ref()) else { return Ok(None) };
        let fail = |why: String| format!("node {index}: its instances: {why}");
        let attributes = &instancing.attributes;
        let named = [attributes.translation, attributes.rotation, attributes.scale];
        let mut counts = named.into_iter().flatten().map(|a| Ok(self.data.accessor(a).map_err(fail)?.count));
        let Some(count) = counts.next().transpose()? else { return Ok(None) };
        if counts.collect::<Result<Vec<_>, String>>()?.iter().any(|c| *c != count) {
            return Err(fail("their attributes have different counts".into()));
        }
        self.spend(count).map_err(fail)?;
        let mut stands =
            vec![
                Stand { translation: DVec3::ZERO, rotation: glam::DQuat::IDENTITY, scale: DVec3::ONE };
                count
            ];
        if let Some(accessor) = attributes.translation {
            let all = self.data.vectors::<3>(accessor).map_err(fail)?;
            stands.iter_mut().zip(all).for_each(|(s, v)| s.translation = DVec3::from_array(v));
        }
        if let Some(accessor) = attributes.rotation {
            let all = self.data.vectors::<4>(accessor).map_err(fail)?;
            stands.iter_mut().zip(all).for_each(|(s, v)| s.rotation = turn(v));
        }
        if let Some(accessor) = attributes.scale {
            let all = self.data.vectors::<3>(accessor).map_err(fail)?;
            stands.iter_mut().zip(all).for_each(|(s, v)| s.scale = DVec3::from_array(v));
        }
        Ok(Some(stands))
    }

    fn spend(&mut self, count: usize) -> Result<(), String> {
        // What was read since has made the file longer.
        let most = FREE_INSTANCED.max(self.data.file_bytes());
        self.left += most - self.most;
        self.most = most;
        self.left = self
            .left
            .checked_sub(count)
            .ok_or_else(|| format!("its instances come to over {most} points or corners"))?;
        Ok(())
    }

    fn place_skinned(&mut self, shape: &Shape, skin: &Skin, node: Index, object: u32) -> Result<(), String> {
        if shape.influences.is_empty() {
            return self.place(shape, &self.tree.worlds[node as usize], object);
        }
        let points = skin.place(&shape.points, &shape.influences);
        let points = points.map_err(|why| format!("node {node}: {why}"))?;
        self.add(shape, points.into_iter(), skin.is_mirrored(), object)
    }

    fn place(&mut self, shape: &Shape, world: &DMat4, object: u32) -> Result<(), String> {
        // "The determinant of the transform is negative: the winding order is reversed" (3.7.4).
        let points = shape.points.iter().map(|p| world.transform_point3(*p));
        self.add(shape, points, world.determinant() < 0.0, object)
    }

    /// Adds a primitive whose points are these in the world.
    fn add(
        &mut self,
        shape: &Shape,
        points: impl ExactSizeIterator<Item = DVec3>,
        mirrored: bool,
        object: u32,
    ) -> Result<(), String> {
        let count = points.len();
        self.spend(count.max(3 * shape.triangles.len()))?;
        let base = self.mesh.points.len() as u32;
        self.mesh.points.extend(points);
        self.mesh.corners.reserve(3 * shape.triangles.len());
        self.mesh.faces.reserve(shape.triangles.len());
        if !shape.colors.is_empty() {
            self.mesh.colors.resize(base as usize, Mesh::NO_COLOR);
            self.mesh.colors.extend(shape.colors.iter().map(|[r, g, b, _]| [*r, *g, *b].map(|c| c as f32)));
        }
        let alpha = Alpha::of(self.gltf, shape.material);
        let lets_through = |i: &u32| shape.colors.get(*i as usize).is_some_and(|c| alpha.lets_through(c[3]));
        let mut last = false;
        let mut material = self.materials.id(self.gltf, shape.material, last);
        for corners in &shape.triangles {
            let through = corners.iter().any(lets_through);
            if through != last {
                (last, material) = (through, self.materials.id(self.gltf, shape.material, through));
            }
            if corners.iter().any(|i| *i as usize >= count) {
                self.mesh.push_lost(1, object, material, Dropped::OutOfRange);
            } else {
                let [a, b, c] = corners.map(|i| base + i);
                self.mesh.push(&if mirrored { [a, c, b] } else { [a, b, c] }, object, material);
            }
        }
        Ok(())
    }

    fn tell(&mut self, report: &mut Report) {
        for (mesh, _) in self.uses.iter().enumerate().filter(|(_, uses)| **uses == 0) {
            self.lost.add(UNSHOWN, (mesh, 0), || self.gltf.mesh_name(mesh));
        }
        if self.tree.hidden > 0 {
            let nodes = counted(self.tree.hidden, "node");
            report.note(format!("{nodes} with a mesh or camera hidden by KHR_node_visibility"));
        }
        self.lost.tell(report);
    }
}

/// What the animation moves.
struct Moved<'a> {
    gltf: &'a Gltf,
    tree: &'a Tree,
    placed: &'a [Option<Index>],
    skinned: &'a [Index],
}

impl Moved<'_> {
    /// Gives the objects their motions and makes the cameras view paths.
    fn attach(&self, clip: Option<&Clip>, parts: &mut Parts<Solid>, progress: &dyn Progress) {
        let cameras = camera::nodes(self.gltf, self.tree);
        let nodes = self.placed.iter().flatten().chain(&cameras).copied();
        let worlds = match clip.map(|clip| clip.sample(self.gltf, self.tree, nodes, progress)) {
            Some(Ok(worlds)) => worlds,
            Some(Err(why)) => {
                parts.report.note(format!("animation left out: {why}"));
                BTreeMap::new()
            }
            None => BTreeMap::new(),
        };
        let still = Pose { rotation: [0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };
        let motions: BTreeMap<Index, Option<Arc<[Pose]>>> = worlds
            .iter()
            .map(|(node, list)| {
                let poses = motion::poses(list, &self.tree.worlds[*node as usize], parts.origin);
                (*node, poses.map(Arc::from))
            })
            .collect();
        let mut bent = Lost::default();
        for (k, (object, node)) in parts.objects.iter_mut().zip(self.placed).enumerate() {
            match node.and_then(|n| motions.get(&n)) {
                Some(Some(poses)) if poses.iter().any(|p| *p != still) => object.motion = Some(poses.clone()),
                Some(None) => {
                    bent.add(BENT, (k, 0), || format!("`{}`", object.name));
                }
                _ => {}
            }
        }
        bent.tell(&mut parts.report);
        if let Some(clip) = clip {
            self.tell_of_joints(clip, &mut parts.report);
        }
        let bounds = Aabb::of(parts.points.iter().copied());
        let report = &mut parts.report;
        parts.paths = camera::paths(self.gltf, self.tree, &cameras, &worlds, parts.origin, bounds, report);
    }

    fn tell_of_joints(&self, clip: &Clip, report: &mut Report) {
        let moves = |skin: &&Index| {
            let skin = self.gltf.skins.get(**skin as usize).and_then(|s| s.0.as_ref().ok());
            skin.is_some_and(|s| s.joints.iter().any(|j| clip.moving.get(*j as usize) == Some(&true)))
        };
        let count = self.skinned.iter().filter(moves).count();
        if count > 0 {
            let objects = counted(count, "skinned object");
            report.note(format!("the animation of the joints of {objects} left out: shown at rest"));
        }
    }
}
