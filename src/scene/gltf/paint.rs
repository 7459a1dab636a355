//! Materials: color, what light comes through, and whether there is a back (glTF 2.0, section 3.9).
//!
//! A surface has one color here; where a mesh has colors at its points, each triangle takes their mean later
//! ([`crate::scene::palette`]). See-through is what is blended or cut
//! out by an alpha below 1 (of the factor or of a point) or by a texture that may hold one (any but a JPEG),
//! and what transmits light. Light that is only scattered (KHR_materials_diffuse_transmission) shows nothing
//! of what is behind.

use std::collections::BTreeMap;

use super::file::{AlphaMode, Base, Gltf, Image, Index, Material, TextureUse};
use crate::scene::mtl::GRAY;

/// The materials that were used so far.
#[derive(Default)]
pub(super) struct Materials {
    ids: BTreeMap<(Option<Index>, bool), u32>,
    pub(super) made: Vec<crate::scene::Material>,
}

impl Materials {
    /// The material of a triangle, through whose points light may come.
    pub(super) fn id(&mut self, gltf: &Gltf, material: Option<Index>, through: bool) -> u32 {
        let next = self.made.len() as u32;
        let id = *self.ids.entry((material, through)).or_insert(next);
        if id == next {
            self.made.push(make(gltf, material, through));
        }
        id
    }
}

/// How a primitive's own material treats the alpha of its points.
pub(super) struct Alpha {
    mode: AlphaMode,
    factor: f64,
    cutoff: f64,
}

impl Alpha {
    pub(super) fn of(gltf: &Gltf, material: Option<Index>) -> Self {
        let material = material.and_then(|m| gltf.materials.get(m as usize)?.0.as_ref().ok());
        material.map_or(Self { mode: AlphaMode::Opaque, factor: 1.0, cutoff: 0.5 }, |m| Self {
            mode: m.alpha_mode,
            factor: f64::from(base(m).base_color_factor.unwrap_or([1.0; 4])[3]),
            cutoff: m.alpha_cutoff.unwrap_or(0.5),
        })
    }

    /// Whether a point of this alpha lets light through.
    pub(super) fn lets_through(&self, alpha: f64) -> bool {
        match self.mode {
            AlphaMode::Opaque => false,
            AlphaMode::Mask => alpha * self.factor < self.cutoff,
            AlphaMode::Blend => alpha * self.factor < 1.0,
        }
    }
}

fn make(gltf: &Gltf, index: Option<Index>, through: bool) -> crate::scene::Material {
    let material = index.map(|i| gltf.materials.get(i as usize).and_then(|m| m.0.as_ref().ok()));
    let own = material.flatten();
    let factor = own.map_or([1.0; 4], |m| base(m).base_color_factor.unwrap_or([1.0; 4]));
    let name = match index {
        None => "default".to_owned(),
        Some(i) => own.and_then(|m| m.name.as_deref()).map_or(format!("material_{i}"), super::file::short),
    };
    let color = if own.is_none() { GRAY } else { [factor[0], factor[1], factor[2]] };
    let color = color.map(|c| if c.is_finite() { c.clamp(0.0, 1.0) } else { GRAY[0] });
    crate::scene::Material {
        see_through: through || own.is_some_and(|m| see_through(gltf, m)),
        two_sided: own.is_some_and(|m| m.double_sided),
        ..crate::scene::Material::new(name, color)
    }
}

/// The model of the material that is shown: the older one, where it is there, is the richer.
fn base(material: &Material) -> &Base {
    material.extensions.specular_glossiness.as_ref().unwrap_or(&material.pbr_metallic_roughness)
}

fn see_through(gltf: &Gltf, material: &Material) -> bool {
    let base = base(material);
    let textured = base.base_color_texture.as_ref().is_some_and(|t| has_alpha(gltf, t));
    let alpha = f64::from(base.base_color_factor.unwrap_or([1.0; 4])[3]);
    let blended = match material.alpha_mode {
        AlphaMode::Opaque => false,
        AlphaMode::Mask => textured || alpha < material.alpha_cutoff.unwrap_or(0.5),
        AlphaMode::Blend => textured || alpha < 1.0,
    };
    blended || material.extensions.transmission.as_ref().is_some_and(|t| t.transmission_factor > 0.0)
}

/// Whether a texture may hold an alpha below 1, as far as its kind tells: the picture itself is not read.
fn has_alpha(gltf: &Gltf, texture: &TextureUse) -> bool {
    let texture = gltf.textures.get(texture.index as usize).and_then(|t| t.0.as_ref().ok());
    let Some(texture) = texture.filter(|t| t.extensions.is_none()) else { return true };
    let image = texture.source.and_then(|s| gltf.images.get(s as usize)?.0.as_ref().ok());
    !image.is_some_and(is_jpeg)
}

fn is_jpeg(image: &Image) -> bool {
    let uri = image.uri.as_deref().unwrap_or_default();
    let ends = |with: &str| {
        uri.len()
            .checked_sub(with.len())
            .and_then(|at| uri.get(at..))
            .is_some_and(|e| e.eq_ignore_ascii_case(with))
    };
    image.mime_type.as_deref() == Some("image/jpeg")
        || uri.starts_with("data:image/jpeg")
        || ends(".jpg")
        || ends(".jpeg")
}
