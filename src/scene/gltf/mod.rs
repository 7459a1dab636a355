//! glTF 2.0 and GLB through the crate `gltf`: its JSON and its validation; containers, buffers and accessors
//! are read here, with every bound checked (Khronos, "glTF 2.0 Specification", 2021).
//!
//! Each node with a mesh becomes an object under its transform; triangles, strips and fans become triangles
//! in the order of the node tree. The first animation becomes motions where it is rigid. Textures, skins and
//! morph targets are left out with a note. Cost: O(file), times the instances of each mesh up to a limit.

mod data;
mod motion;

use std::collections::BTreeMap;
use std::path::Path;

use ::gltf::json::Root;
use ::gltf::json::validation::{Checked, Error as Fault, Validate};
use ::gltf::material::AlphaMode;
use ::gltf::mesh::Mode;
use ::gltf::{Document, Node, Primitive, Semantic};
use glam::{DMat4, DVec3};

use self::data::Data;
use super::assemble::{Mesh, assemble};
use super::mtl::GRAY;
use super::text::without_mark;
use super::{Dropped, LoadOptions, Material, Object, Part, Parts, Progress, Report, SceneError, json};
use crate::geometry::Solid;

/// Most points and most triangles that instances may multiply to: some gigabytes of tables.
const MAX_INSTANCED: usize = 1 << 25;

/// Extensions that a file may require without changing where its triangles are.
const HARMLESS: &[&str] = &[
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "EXT_texture_",
    "KHR_mesh_quantization",
    "EXT_lights_",
    "KHR_xmp",
];

/// Reads glTF JSON or GLB. Without a `folder` no buffer file is opened.
pub(super) fn read(
    bytes: &[u8],
    folder: Option<&Path>,
    name: &str,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let format = |why: String| SceneError::Format { path: source.to_owned(), why };
    let (text, blob) =
        if bytes.starts_with(b"glTF") { split_glb(bytes).map_err(format)? } else { (bytes, None) };
    let root = root(text, source)?;
    let mut report = Report::default();
    check(&root, &mut report).map_err(format)?;
    let document = Document::from_json_without_validation(root);
    let data = Data::read(&document, blob, folder).map_err(format)?;
    let mut reader = Reader::new(&document, data, report);
    reader.tree(source, progress)?;
    let Reader { mesh, report, placed, data, .. } = reader;
    if mesh.faces.is_empty() {
        let meshes = document.meshes().count();
        return Err(format(format!(
            "it has no triangles in its scene ({meshes} meshes, {} nodes)",
            document.nodes().count()
        )));
    }
    let mut parts =
        assemble(mesh, name, source, options, report, &Part { whole: progress, start: 0.5, length: 0.5 })?;
    motion::attach(&document, &data, &placed, &mut parts);
    Ok(parts)
}

/// JSON text and binary chunk of a GLB container.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    fn word(bytes: &[u8], at: usize) -> Option<u32> {
        bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err("the GLB header is cut off".into());
    };
    if version != 2 {
        return Err(format!("GLB version {version} is not supported, only 2"));
    }
    if length as usize > bytes.len() {
        return Err(format!("the GLB says it has {length} bytes, but the file has {}", bytes.len()));
    }
    let bytes = &bytes[..length as usize];
    let (mut text, mut blob, mut at) = (None, None, 12);
    while let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) {
        let Some(chunk) = bytes.get(at + 8..).and_then(|rest| rest.get(..size as usize)) else {
            return Err(format!(
                "the GLB chunk at byte {at} says it has {size} bytes, but the file ends before"
            ));
        };
        match &kind.to_le_bytes() {
            b"JSON" if text.is_none() => text = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            _ => {}
        }
        // Chunks are padded to four bytes.
        at += 8 + (size as usize).next_multiple_of(4);
    }
    text.map(|t| (t, blob)).ok_or_else(|| "the GLB has no JSON chunk".into())
}

fn root(text: &[u8], source: &str) -> Result<Root, SceneError> {
    let text =
        without_mark(text).map_err(|why| SceneError::Format { path: source.to_owned(), why: why.into() })?;
    // Padding of the chunk, which some writers make of zeros.
    let end = text.iter().rposition(|b| *b != 0).map_or(0, |e| e + 1);
    json::from_slice(&text[..end], source)
}

/// Everything that the crate's validation says, except on extensions that do not matter here.
fn check(root: &Root, report: &mut Report) -> Result<(), String> {
    let harmless = |name: &String| HARMLESS.iter().any(|h| name.starts_with(h));
    if let Some(needed) = root.extensions_required.iter().find(|e| !harmless(e)) {
        return Err(format!("it requires the extension {needed}, which is not supported"));
    }
    if !root.asset.version.starts_with("2.") {
        return Err(format!("glTF version {} is not supported, only 2", root.asset.version));
    }
    // The crate's validation looks this one up without asking whether it is there.
    let positions = root
        .meshes
        .iter()
        .flat_map(|m| &m.primitives)
        .filter_map(|p| p.attributes.get(&Checked::Valid(Semantic::Positions)));
    if let Some(bad) = positions.map(|p| p.value()).find(|p| *p >= root.accessors.len()) {
        return Err(format!(
            "a mesh has its positions in accessor {bad}, but there are only {}",
            root.accessors.len()
        ));
    }
    let mut faults = Vec::new();
    root.validate(root, ::gltf::json::Path::new, &mut |path, fault| {
        let place = path().to_string();
        // Bounds of positions are not needed, and a primitive without positions is left out with a note.
        let needless = place.contains("\"POSITION\"") && !matches!(fault, Fault::IndexOutOfBounds);
        if !needless && !matches!(fault, Fault::Unsupported) {
            faults.push(format!("{place}: {fault}"));
        }
    });
    if let Some(first) = faults.first() {
        return Err(format!("{first} ({} faults)", faults.len()));
    }
    for (what, count) in [("skins", root.skins.len()), ("textures", root.textures.len())] {
        if count > 0 {
            report.note(format!("{count} {what} left out"));
        }
    }
    Ok(())
}

/// An object that was placed: its node, and the world transform of the node at rest.
struct Placed {
    node: usize,
    world: DMat4,
}

struct Reader<'a> {
    document: &'a Document,
    data: Data,
    mesh: Mesh,
    report: Report,
    placed: Vec<Placed>,
    material_ids: BTreeMap<Option<usize>, u32>,
    points_wanted: usize,
    triangles_wanted: usize,
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document, data: Data, report: Report) -> Self {
        Self {
            document,
            data,
            mesh: Mesh::default(),
            report,
            placed: Vec::new(),
            material_ids: BTreeMap::new(),
            points_wanted: 0,
            triangles_wanted: 0,
        }
    }

    /// Walks the nodes of the default scene (or the first, or all), depth first, without recursion.
    fn tree(&mut self, source: &str, progress: &dyn Progress) -> Result<(), SceneError> {
        let format = |why: String| SceneError::Format { path: source.to_owned(), why };
        let count = self.document.nodes().len();
        let mut seen = vec![false; count];
        let roots: Vec<Node> = match self.document.default_scene().or_else(|| self.document.scenes().next()) {
            Some(scene) => scene.nodes().collect(),
            None => {
                let mut child = vec![false; count];
                self.document
                    .nodes()
                    .flat_map(|n| n.children().map(|c| c.index()).collect::<Vec<_>>())
                    .for_each(|c| child[c] = true);
                self.document.nodes().filter(|n| !child[n.index()]).collect()
            }
        };
        let mut stack: Vec<(Node, DMat4, String)> =
            roots.into_iter().rev().map(|n| (n, DMat4::IDENTITY, String::new())).collect();
        let mut done = 0;
        while let Some((node, above, group)) = stack.pop() {
            if std::mem::replace(&mut seen[node.index()], true) {
                return Err(format(format!("node {} is in the tree twice", node.index())));
            }
            done += 1;
            if done % 256 == 0 {
                progress.report(done as f32 / count as f32 * 0.5, "reading nodes");
                if progress.cancelled() {
                    return Err(SceneError::Cancelled(source.to_owned()));
                }
            }
            let world = above * motion::local(&node);
            self.node(&node, world, &group).map_err(format)?;
            let name = node.name().unwrap_or("").to_owned();
            let children: Vec<Node> = node.children().collect();
            stack.extend(children.into_iter().rev().map(|c| (c, world, name.clone())));
        }
        Ok(())
    }

    fn node(&mut self, node: &Node, world: DMat4, group: &str) -> Result<(), String> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let name =
            node.name().or(mesh.name()).map_or_else(|| format!("node_{}", node.index()), str::to_owned);
        let object = self.mesh.objects.len() as u32;
        self.mesh.objects.push(Object { name, group: group.to_owned(), motion: None });
        self.placed.push(Placed { node: node.index(), world });
        for primitive in mesh.primitives() {
            self.primitive(&primitive, world, object)
                .map_err(|why| format!("mesh {}, primitive {}: {why}", mesh.index(), primitive.index()))?;
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, world: DMat4, object: u32) -> Result<(), String> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.report
                .note(format!("mesh primitive {} is made of points or lines; left out", primitive.index()));
            return Ok(());
        }
        if primitive.morph_targets().len() > 0 {
            self.report.note(format!("morph targets of primitive {} left out", primitive.index()));
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.report.note(format!("mesh primitive {} has no positions; left out", primitive.index()));
            return Ok(());
        };
        let corners = primitive.indices().map_or(positions.count(), |i| i.count());
        self.points_wanted = self.points_wanted.saturating_add(positions.count());
        self.triangles_wanted = self.triangles_wanted.saturating_add(corners);
        if self.points_wanted.max(self.triangles_wanted) > MAX_INSTANCED {
            return Err(format!("its instances come to over {MAX_INSTANCED} points or corners"));
        }
        let places = self.data.floats(&positions, 3)?;
        let count = places.len() / 3;
        let indices = match primitive.indices() {
            Some(accessor) => self.data.indices(&accessor)?,
            None => (0..count as u32).collect(),
        };
        let material = self.material(&primitive.material());
        let base = self.mesh.points.len() as u32;
        let at = |p: &[f64; 3]| world.transform_point3(DVec3::from_array(*p));
        self.mesh.points.extend(places.as_chunks::<3>().0.iter().map(at));
        // A mirroring transform turns triangles over.
        let mirrored = world.determinant() < 0.0;
        for [a, b, c] in triangles(mode, &indices) {
            if [a, b, c].iter().any(|i| *i as usize >= count) {
                self.mesh.push_lost(1, object, material, Dropped::OutOfRange);
            } else {
                let [b, c] = if mirrored { [c, b] } else { [b, c] };
                self.mesh.push(&[base + a, base + b, base + c], object, material);
            }
        }
        let spare = if mode == Mode::Triangles { indices.len() % 3 } else { 0 };
        if spare > 0 {
            self.report.note(format!(
                "primitive {}: the last {spare} of {} corners make no triangle",
                primitive.index(),
                indices.len()
            ));
        }
        Ok(())
    }

    fn material(&mut self, material: &::gltf::Material) -> u32 {
        let next = self.mesh.materials.len() as u32;
        let id = *self.material_ids.entry(material.index()).or_insert(next);
        if id == next {
            let [r, g, b, _] = material.pbr_metallic_roughness().base_color_factor();
            let (name, color) = match material.index() {
                None => ("default".to_owned(), GRAY),
                Some(i) => {
                    (material.name().map_or_else(|| format!("material_{i}"), str::to_owned), [r, g, b])
                }
            };
            let color = color.map(|c| if c.is_finite() { c.clamp(0.0, 1.0) } else { GRAY[0] });
            self.mesh.materials.push(Material {
                see_through: see_through(material),
                two_sided: material.double_sided(),
                ..Material::new(name, color)
            });
        }
        id
    }
}

/// Whether light comes through somewhere (glTF 2.0, 3.9.4; KHR_materials_transmission). A texture may hold any
/// alpha, so one that is blended or cut out by its texture counts; an opaque material ignores alpha.
fn see_through(material: &::gltf::Material) -> bool {
    let pbr = material.pbr_metallic_roughness();
    let (alpha, texture) = (pbr.base_color_factor()[3], pbr.base_color_texture().is_some());
    let blended = match material.alpha_mode() {
        AlphaMode::Opaque => false,
        AlphaMode::Mask => texture || alpha < material.alpha_cutoff().unwrap_or(0.5),
        AlphaMode::Blend => texture || alpha < 1.0,
    };
    blended || material.transmission().is_some_and(|t| t.transmission_factor() > 0.0)
}

/// The triangles that a list of corners stands for; every second one of a strip is turned over.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            .collect(),
        Mode::TriangleFan => {
            indices.get(1..).unwrap_or(&[]).windows(2).map(|w| [indices[0], w[0], w[1]]).collect()
        }
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}
