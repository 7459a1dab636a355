//! What is read of the JSON of a glTF file, as it stands there (glTF 2.0, section 5).
//!
//! Everything else is skipped, whatever it is: `extras` of any kind, attributes that belong to applications,
//! extensions. Nothing here is compared with anything else: whoever follows an index asks if it is there.

use std::collections::BTreeMap;

use serde::de::{DeserializeOwned, Deserializer};
use serde::{Deserialize, de::IgnoredAny};
use serde_json::Value;

/// A place in one of the lists.
pub(super) type Index = u32;

/// A part that can be left out: what is wrong with it where it cannot be read.
pub(super) struct Lenient<T>(pub(super) Result<T, String>);

impl<'de, T: DeserializeOwned> Deserialize<'de> for Lenient<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Ok(Self(T::deserialize(Value::deserialize(from)?).map_err(|e| e.to_string())))
    }
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Gltf {
    pub(super) asset: Asset,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
    pub(super) extensions: RootExtensions,
    pub(super) scene: Option<Index>,
    pub(super) scenes: Vec<Scene>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) materials: Vec<Lenient<Material>>,
    pub(super) skins: Vec<Lenient<Skin>>,
    pub(super) cameras: Vec<Lenient<Camera>>,
    pub(super) animations: Vec<Lenient<Animation>>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<View>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) textures: Vec<Lenient<Texture>>,
    pub(super) images: Vec<Lenient<Image>>,
    pub(super) samplers: Vec<Lenient<TextureSampler>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    version: Value,
}

impl Asset {
    /// The version, which old files give as a number; empty if there is none.
    pub(super) fn version(&self) -> String {
        match &self.version {
            Value::String(version) => short(version),
            Value::Number(version) => version.to_string(),
            _ => String::new(),
        }
    }
}

/// What tells a file of another version, whose other parts have other shapes.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Head {
    pub(super) asset: Asset,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) lights: Option<Lenient<Lights>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Lights {
    pub(super) lights: Vec<IgnoredAny>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) name: Option<String>,
    pub(super) nodes: Vec<Index>,
}

/// Boxes keep the many nodes small that neither move nor show anything.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<Index>,
    pub(super) mesh: Option<Index>,
    pub(super) skin: Option<Index>,
    pub(super) camera: Option<Index>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    pub(super) weights: Option<Vec<f64>>,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    pub(super) visibility: Option<Visibility>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Instancing {
    pub(super) attributes: InstanceAttributes,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct InstanceAttributes {
    pub(super) translation: Option<Index>,
    pub(super) rotation: Option<Index>,
    pub(super) scale: Option<Index>,
}

#[derive(Deserialize)]
#[serde(default)]
pub(super) struct Visibility {
    pub(super) visible: bool,
}

impl Default for Visibility {
    fn default() -> Self {
        Self { visible: true }
    }
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Vec<f64>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, Value>,
    pub(super) indices: Option<Index>,
    pub(super) material: Option<Index>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Vec<BTreeMap<String, Value>>,
    pub(super) extensions: PrimitiveExtensions,
}

/// The accessor of an attribute.
pub(super) fn attribute(attributes: &BTreeMap<String, Value>, name: &str) -> Result<Option<Index>, String> {
    let index = |v: &Value| v.as_u64().and_then(|i| Index::try_from(i).ok());
    match attributes.get(name) {
        None => Ok(None),
        Some(value) => index(value).map(Some).ok_or_else(|| format!("its {name} names no accessor")),
    }
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Draco>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Draco {
    pub(super) buffer_view: Index,
    pub(super) attributes: BTreeMap<String, u32>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: Base,
    pub(super) alpha_mode: AlphaMode,
    pub(super) alpha_cutoff: Option<f64>,
    pub(super) double_sided: bool,
    pub(super) extensions: MaterialExtensions,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum AlphaMode {
    #[default]
    Opaque,
    Mask,
    Blend,
}

/// What colors a surface, in either of the two models of materials.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Base {
    #[serde(alias = "diffuseFactor")]
    pub(super) base_color_factor: Option<[f32; 4]>,
    #[serde(alias = "diffuseTexture")]
    pub(super) base_color_texture: Option<TextureUse>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureUse {
    pub(super) index: Index,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) specular_glossiness: Option<Base>,
    #[serde(rename = "KHR_materials_transmission", alias = "ADOBE_materials_thin_transparency")]
    pub(super) transmission: Option<Transmission>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub(super) transmission_factor: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) joints: Vec<Index>,
    pub(super) inverse_bind_matrices: Option<Index>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    pub(super) perspective: Option<Perspective>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Perspective {
    pub(super) aspect_ratio: Option<f64>,
    pub(super) yfov: f64,
    pub(super) zfar: Option<f64>,
    pub(super) znear: f64,
}

#[derive(Deserialize)]
pub(super) struct Animation {
    pub(super) name: Option<String>,
    pub(super) channels: Vec<Channel>,
    pub(super) samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: Index,
    pub(super) target: Target,
}

#[derive(Deserialize)]
pub(super) struct Target {
    pub(super) node: Option<Index>,
    pub(super) path: String,
}

#[derive(Deserialize)]
pub(super) struct Sampler {
    pub(super) input: Index,
    pub(super) output: Index,
    #[serde(default)]
    pub(super) interpolation: Interpolation,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum Interpolation {
    #[default]
    Linear,
    Step,
    CubicSpline,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<Index>,
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: Index,
    #[serde(default)]
    pub(super) byte_offset: usize,
    /// Of the indices alone.
    #[serde(default)]
    pub(super) component_type: u32,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: Index,
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
    pub(super) extensions: Option<Box<ViewExtensions>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub(super) meshopt: Option<Meshopt>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt {
    pub(super) buffer: Index,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: usize,
    pub(super) count: usize,
    pub(super) mode: String,
    #[serde(default)]
    pub(super) filter: Option<String>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: usize,
    pub(super) uri: Option<String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Texture {
    pub(super) source: Option<Index>,
    pub(super) sampler: Option<Index>,
    /// Another picture than `source` may count.
    pub(super) extensions: Option<IgnoredAny>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Image {
    pub(super) uri: Option<String>,
    pub(super) mime_type: Option<String>,
    pub(super) buffer_view: Option<Index>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureSampler {
    pub(super) mag_filter: Option<u32>,
    pub(super) min_filter: Option<u32>,
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

impl Gltf {
    /// What a mesh is called where something is said of it.
    pub(super) fn mesh_name(&self, mesh: usize) -> String {
        match self.meshes.get(mesh).and_then(|m| m.name.as_deref()).filter(|n| !n.is_empty()) {
            Some(name) => format!("`{}`", short(name)),
            None => format!("mesh {mesh}"),
        }
    }
}

/// A name on one line. A very long one is cut, since every child of a group repeats the group's.
pub(super) fn short(name: &str) -> String {
    const LONGEST: usize = 200;
    name.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect()
}
