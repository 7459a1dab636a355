//! Cameras as view paths: one view, or one a frame where the animation moves the camera (glTF 2.0, 3.10).

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat4, DVec3};

use super::file::{Gltf, Index, Perspective, short};
use super::tree::Tree;
use crate::geometry::{Aabb, Eye, Solid, View, ViewPath};
use crate::scene::Report;
use crate::scene::report::counted;

/// Longer side of a camera's image, pixels.
const LONGER_SIDE: f64 = 1024.0;

/// Nodes of the scene that have a camera.
pub(super) fn nodes(gltf: &Gltf, tree: &Tree) -> Vec<Index> {
    let has = |n: &Index| tree.shown[*n as usize] && gltf.nodes[*n as usize].camera.is_some();
    tree.order.iter().copied().filter(has).collect()
}

/// The view paths of these nodes, in coordinates that had `origin` subtracted; `worlds` are those of the
/// frames of nodes that move.
pub(super) fn paths(
    gltf: &Gltf,
    tree: &Tree,
    nodes: &[Index],
    worlds: &BTreeMap<Index, Vec<DMat4>>,
    origin: DVec3,
    bounds: Aabb<glam::Vec3>,
    report: &mut Report,
) -> Vec<ViewPath<Solid>> {
    let (mut paths, mut names, mut without) = (Vec::new(), BTreeSet::new(), 0);
    for node in nodes {
        let at = *node as usize;
        let camera = gltf.nodes[at].camera.and_then(|c| gltf.cameras.get(c as usize)?.0.as_ref().ok());
        let Some((camera, lens)) = camera.and_then(|c| Some((c, c.perspective.as_ref()?))) else {
            without += 1;
            continue;
        };
        let name = gltf.nodes[at].name.as_deref().or(camera.name.as_deref()).filter(|n| !n.is_empty());
        let mut name = name.map_or_else(|| format!("camera_{at}"), short);
        if !names.insert(name.clone()) {
            name = format!("{name}_{at}");
            names.insert(name.clone());
        }
        let rest = std::slice::from_ref(&tree.worlds[at]);
        let stands = worlds.get(node).map_or(rest, Vec::as_slice);
        let views: Option<Vec<View<Solid>>> =
            stands.iter().map(|world| view(world, lens, origin, &bounds)).collect();
        match views {
            Some(views) => paths.push(ViewPath { name, views }),
            None => without += 1,
        }
    }
    if without > 0 {
        let they = if without == 1 { "it" } else { "they" };
        report.note(format!("{} left out: orthographic, or {they} cannot see", counted(without, "camera")));
    }
    paths
}

/// What a camera at `world` sees: along its own −z, with +y up, whatever its scale.
fn view(world: &DMat4, lens: &Perspective, origin: DVec3, bounds: &Aabb<glam::Vec3>) -> Option<View<Solid>> {
    let position = world.w_axis.truncate() - origin;
    let forward = world.transform_vector3(DVec3::NEG_Z).try_normalize()?;
    let up = world.transform_vector3(DVec3::Y).try_normalize()?;
    // Without a far plane it sees without end: here to the end of what there is.
    let reach = (bounds.center().as_dvec3() - position).length() + f64::from(bounds.diagonal());
    let far = lens.zfar.unwrap_or_else(|| reach.max(lens.znear * 2.0));
    // As far off as what is near, so that rounding the target does not turn the view.
    let target = position + forward * position.abs().max_element().max(1.0);
    let eye = Eye {
        position: position.as_vec3(),
        target: target.as_vec3(),
        up: up.as_vec3(),
        fov: lens.yfov as f32,
        near: lens.znear as f32,
        far: far as f32,
    };
    let aspect = lens.aspect_ratio.filter(|a| *a > 0.0 && a.is_finite()).unwrap_or(1.0);
    let side = |part: f64| (LONGER_SIDE * part.min(1.0)).round().clamp(1.0, LONGER_SIDE) as u32;
    eye.fault().is_none().then_some(View { eye, width: side(aspect), height: side(1.0 / aspect) })
}
