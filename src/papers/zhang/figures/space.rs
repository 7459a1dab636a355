//! Scenes of space for the figures: runs on them, and plates, which show a scene from above, cut open, each
//! triangle in the color of what became of it.

use std::sync::Arc;

use glam::Vec3;

use super::notes::occluders;
use crate::drawing::{Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::figure::tools::{Maker, Tint};
use crate::figure::{Panel, Picture, role_of};
use crate::geometry::{Aabb, Frustum, PrimId, Solid, View};
use crate::method::Film;
use crate::papers::keys::OCCLUSION_MAPS;
use crate::raster::{render, shade, shade_with};
use crate::scene::{AnyScene, LoadOptions, Motion, Quiet, Scene, SceneError, framing_view, load};
use crate::trace::Stamps;

/// A scene of space.
pub fn solid(source: &str) -> Result<Arc<Scene<Solid>>, SceneError> {
    match load(source, &LoadOptions::default(), &Quiet)? {
        AnyScene::Solid(scene) => Ok(scene),
        AnyScene::Flat(_) => unreachable!("the generated scenes are in space"),
    }
}

/// A frame of a scene's path: where objects move, that frame of the scene.
pub struct Shot<'a> {
    pub source: &'a str,
    pub path: &'a str,
    pub frame: usize,
    pub size: [u32; 2],
    /// The angle of view over that of the path.
    pub angle: f32,
    pub settings: &'a [(&'a str, &'a str)],
}

impl Shot<'_> {
    /// The film of the method.
    pub fn film(&self, maker: &Maker<'_>) -> Result<Arc<dyn Film<Solid>>, SceneError> {
        let scene = solid(self.source)?;
        let views = &scene.paths().iter().find(|p| p.name == self.path).unwrap_or(&scene.paths()[0]).views;
        let [width, height] = self.size;
        let mut view = View { width, height, ..views[self.frame % views.len()] };
        view.eye.fov *= self.angle;
        let mut run = maker.ready(&scene, OCCLUSION_MAPS, self.settings);
        run.pose(&Motion::new(&scene).at(self.frame), &Quiet);
        Ok(run.record(&view, usize::MAX).film)
    }
}

/// What became of each primitive, by id, at the end of a film; occluders as such.
pub fn roles(film: &dyn Film<Solid>) -> Vec<Role> {
    let (stamps, end) = (Stamps::new(film), film.events().len());
    let count = film.scene().prim_count() as u32;
    let mut roles: Vec<Role> = (0..count).map(|p| role_of(stamps.prim(PrimId(p), end))).collect();
    occluders(film).iter().for_each(|p| roles[p.at()] = Role::Occluder);
    roles
}

/// A triangle that is no higher than this and wider than that is ground or floor, m.
const GROUND_M: [f32; 2] = [0.05, 1.5];

/// Which triangles a plate shows: those that begin below a height over the lowest point; and of these which
/// are ground or floor.
fn shown(scene: &Scene<Solid>, cut: f32) -> (Vec<PrimId>, Vec<bool>) {
    let floor = scene.bounds().min.y;
    let low = |p: &PrimId| scene.prim_bounds(*p).min.y < floor + cut;
    let prims: Vec<PrimId> = scene.live().iter().copied().filter(low).collect();
    let mut is_ground = vec![false; scene.prim_count()];
    for prim in &prims {
        let size = scene.prim_bounds(*prim).size();
        is_ground[prim.at()] = size.y < GROUND_M[0] && size.x.max(size.z) > GROUND_M[1];
    }
    (prims, is_ground)
}

/// An observer behind and far above the Eye, who sees some bounds.
fn above(bounds: &Aabb<Vec3>, eye: &View<Solid>, [width, height]: [u32; 2]) -> View<Solid> {
    let mut view = framing_view::<Solid>(bounds, width, height);
    let center = bounds.center();
    let distance = (view.eye.position - center).length();
    let ahead = eye.eye.forward().with_y(0.0).normalize_or(Vec3::NEG_Z);
    let aside = ahead.cross(Vec3::Y);
    let from = (aside * 0.25 - ahead * 0.45 + Vec3::Y * 0.85).normalize();
    view.eye.position = center + from * distance * NEARER;
    view.eye.target = center;
    view.eye.near = 0.05 * distance;
    view
}

/// A framing view leaves room for the sphere around what it frames, of which a low scene needs less.
const NEARER: f32 = 0.8;

/// A scene from above, cut open: triangles that begin above a height over the lowest point are left out. Each
/// has the color of a role; those outside the frustum are pale, and so are ground and floors, whose triangles
/// are large and reach far.
pub fn plate(
    tint: Tint<'_>,
    film: &dyn Film<Solid>,
    roles: &[Role],
    cut: f32,
    size: [u32; 2],
    label: String,
) -> Panel {
    let scene = film.scene();
    let (prims, is_ground) = shown(scene, cut);
    let standing = prims.iter().filter(|p| !is_ground[p.at()]);
    let bounds = standing.fold(Aabb::empty(), |sum, p| sum.union(scene.prim_bounds(*p)));
    let observer = above(&bounds.with(film.view().eye.position), film.view(), size);
    let image = render(&**scene, &observer, &prims);
    let paper = tint(Role::Paper);
    let pale = |role: Role, share: f32| {
        let color = tint(role);
        [0, 1, 2].map(|i| paper[i] + (color[i] - paper[i]) * share)
    };
    let color = |prim: PrimId| match roles[prim.at()] {
        _ if is_ground[prim.at()] => pale(Role::Outside, 0.2),
        Role::Outside => pale(Role::Outside, 0.55),
        role => tint(role),
    };
    let rgba = shade_with(&image, &**scene, &observer, paper, color).into();
    let mut world = Drawing::default();
    frustum(film, bounds.diagonal(), &mut world);
    let pixels = Pixels { width: observer.width, height: observer.height, rgba };
    Panel { label, picture: Picture::Over(pixels, world, observer) }
}

/// The Eye and the sides of its view.
fn frustum(film: &dyn Film<Solid>, reach: f32, world: &mut Drawing<Vec3>) {
    let view = film.view();
    let eye = view.eye.position;
    let corners = Frustum::corners(&view.projection(), view.eye.near, view.eye.far);
    // Its sides are where its left and its right corners are, in the middle of their height.
    let right = view.eye.forward().cross(view.eye.up).normalize();
    for side in [-1.0, 1.0] {
        let far = corners[4..].iter().filter(|c| (**c - eye).dot(right) * side > 0.0);
        let (sum, count) = far.fold((Vec3::ZERO, 0.0), |(sum, n), c| (sum + *c, n + 1.0));
        let along = (sum / f32::max(count, 1.0) - eye).normalize();
        world.line(Layer::Frustum, Role::Eye, Subject::Eye, [eye, eye + along * reach]);
    }
    world.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Dot { at: eye, radius_pt: 3.0 });
}

/// The image of some primitives from the view of a film, as pixels.
pub fn seen(tint: Tint<'_>, film: &dyn Film<Solid>, prims: &[PrimId]) -> Pixels {
    let (scene, view) = (film.scene(), film.view());
    let image = render(&**scene, view, prims);
    let rgba = shade(&image, &**scene, view, tint(Role::Paper)).into();
    Pixels { width: view.width, height: view.height, rgba }
}

/// What a film draws in the end.
pub fn kept(film: &dyn Film<Solid>) -> Vec<PrimId> {
    let (stamps, end) = (Stamps::new(film), film.events().len());
    let is_kept = |p: &PrimId| role_of(stamps.prim(*p, end)) == Role::Visible;
    film.scene().live().iter().copied().filter(is_kept).collect()
}
