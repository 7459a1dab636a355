//! What of a glTF file is not shown, said once each with names and counts; and which extensions a file may
//! require without changing where its triangles are.

use std::collections::{BTreeMap, BTreeSet};

use super::file::{Gltf, Image, Lenient, Skin, Texture, TextureSampler};
use crate::scene::Report;
use crate::scene::report::counted;

/// Extensions that are read.
const READ: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
];

/// Beginnings of the names of those that concern materials, textures, lights, sounds, physics, data on things
/// or their behavior, or another description of the same geometry: not where triangles are at rest.
const HARMLESS: &[&str] = &[
    "ADOBE_materials_",
    "AGI_",
    "CESIUM_primitive_outline",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_materials_",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_geometry_metadata",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_gaussian_splatting",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_",
    "KHR_technique",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_lod",
    "MSFT_packing_",
    "MSFT_texture_",
    "NV_materials_",
    "OMI_",
    "VRM",
];

/// Whether every extension that is required is read or harmless; the others that are used become a note.
pub(super) fn check(gltf: &Gltf, report: &mut Report) -> Result<(), String> {
    let read = |name: &&String| READ.contains(&name.as_str());
    let harmless = |name: &&String| HARMLESS.iter().any(|h| name.starts_with(h));
    if let Some(needed) = gltf.extensions_required.iter().find(|e| !read(e) && !harmless(e)) {
        return Err(format!(
            "it requires the extension {needed}, which is not read; export it without, or convert it (for \
             instance with gltf-transform)"
        ));
    }
    let used = gltf.extensions_used.iter().chain(&gltf.extensions_required);
    let unread: BTreeSet<&str> = used.filter(|e| !read(e)).map(String::as_str).collect();
    if !unread.is_empty() {
        let names: Vec<&str> = unread.into_iter().collect();
        report.note(format!("extensions left out: {}", names.join(", ")));
    }
    Ok(())
}

/// Parts that are left out in any case: how many, and what is wrong with them.
pub(super) fn left_out(gltf: &Gltf, report: &mut Report) {
    let lights = gltf.extensions.lights.as_ref().map_or(0, |l| l.0.as_ref().map_or(0, |l| l.lights.len()));
    for (what, count) in [("texture", gltf.textures.len()), ("light", lights)] {
        if count > 0 {
            report.note(format!("{} left out", counted(count, what)));
        }
    }
    let wrap = |code: Option<u32>| code.is_none_or(|c| [33071, 33648, 10497].contains(&c));
    let filter =
        |code: Option<u32>| code.is_none_or(|c| [9728, 9729].contains(&c) || (9984..9988).contains(&c));
    let sampler =
        |s: &TextureSampler| wrap(s.wrap_s) && wrap(s.wrap_t) && filter(s.mag_filter) && filter(s.min_filter);
    let there = |index: Option<u32>, count: usize| index.is_none_or(|i| (i as usize) < count);
    let texture = |t: &Texture| {
        (t.source.is_some() || t.extensions.is_some())
            && there(t.source, gltf.images.len())
            && there(t.sampler, gltf.samplers.len())
    };
    let image = |i: &Image| i.uri.is_some() || i.buffer_view.is_some();
    let skin = |s: &Skin| s.joints.iter().all(|j| there(Some(*j), gltf.nodes.len()));
    faults("samplers", &gltf.samplers, sampler, report);
    faults("textures", &gltf.textures, texture, report);
    faults("images", &gltf.images, image, report);
    faults("skins", &gltf.skins, skin, report);
    faults("cameras", &gltf.cameras, |_| true, report);
    faults("materials", &gltf.materials, |_| true, report);
    let named = gltf.meshes.iter().flat_map(|m| &m.primitives).flat_map(|p| &p.attributes);
    let count = gltf.accessors.len() as u64;
    let bad = named.filter(|(_, index)| index.as_u64().is_none_or(|i| i >= count)).count();
    if bad > 0 {
        let attributes = counted(bad, "attribute");
        report.note(format!("{attributes} of primitives with accessors that are not there"));
    }
}

fn faults<T>(what: &str, list: &[Lenient<T>], right: impl Fn(&T) -> bool, report: &mut Report) {
    let wrong = |entry: &Lenient<T>| !entry.0.as_ref().is_ok_and(&right);
    let Some(first) = list.iter().position(wrong) else { return };
    let count = list.iter().filter(|e| wrong(e)).count();
    let why = list[first].0.as_ref().err().map_or("what it names is not there or unknown", |e| e.as_str());
    report.note(format!("{count} of {} {what} not valid (the first is {what}[{first}]: {why})", list.len()));
}

/// What is said of one part of a kind, and of several, whose number stands for `#`.
pub(super) type Sentence = [&'static str; 2];

/// What was noticed part by part, to be said once for all parts of a kind.
#[derive(Default)]
pub(super) struct Lost(BTreeMap<Sentence, Kind>);

#[derive(Default)]
struct Kind {
    parts: BTreeSet<(usize, usize)>,
    names: Vec<String>,
}

impl Lost {
    /// Names of a kind that are said.
    const NAMES: usize = 3;

    /// Notes a part, which counts once however often it is noted, and which is called `name`.
    pub(super) fn add(&mut self, sentence: Sentence, part: (usize, usize), name: impl FnOnce() -> String) {
        let kind = self.0.entry(sentence).or_default();
        if kind.parts.insert(part) && kind.names.len() <= Self::NAMES {
            let name = name();
            if !kind.names.contains(&name) {
                kind.names.push(name);
            }
        }
    }

    pub(super) fn tell(&self, report: &mut Report) {
        for ([one, several], kind) in &self.0 {
            let count = kind.parts.len();
            let said = if count == 1 { (*one).to_owned() } else { several.replace('#', &count.to_string()) };
            let more = if kind.names.len() > Self::NAMES { ", …" } else { "" };
            let names = kind.names[..kind.names.len().min(Self::NAMES)].join(", ");
            report.note(format!("{said} ({names}{more})"));
        }
    }
}
