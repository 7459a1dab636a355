//! Where see-through primitives show: before what is drawn, whatever other see-through ones are there.

use super::{Drawable, Options, Target};
use crate::geometry::{PrimId, View};
use crate::scene::Scene;

/// Calls `visit` with each pixel of an image in which a see-through primitive shows, by its place row by row,
/// and the depth `1/w` of it there. At equal depth it shows: what is painted on a wall is seen. Of `prims`
/// those that are not see-through are passed over. The order of the calls is that of `prims`. Cost: O(covered
/// pixels).
///
/// # Panics
/// If the image has not the view's size.
pub fn look_through<S: Drawable>(
    target: &Target,
    scene: &Scene<S>,
    view: &View<S>,
    prims: &[PrimId],
    options: &Options,
    mut visit: impl FnMut(PrimId, usize, f32),
) {
    super::check_size(target, view);
    if !options.surfaces.any_through(scene) {
        return;
    }
    for &prim in prims.iter().filter(|p| options.surfaces.show_through(scene, **p)) {
        S::fragments(scene, view, prim, options, &mut |at, depth| {
            if depth >= target.depth[at] {
                visit(prim, at, depth);
            }
        });
    }
}
