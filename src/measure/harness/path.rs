//! A scene's own path, with as many views as are to be measured.

use crate::geometry::{Vector, ViewPath};
use crate::measure::experiment::{Setup, World};
use crate::measure::report::Measured;
use crate::scene::{Scene, figure_eight_path};

/// The scene's first path, or views around it, resampled to about as many views as are to be measured.
pub fn path<S: World>(scene: &Scene<S>, setup: &Setup) -> ViewPath<S> {
    let mut path = whole_path(scene, setup);
    let between = (setup.frames / path.views.len().max(1)).saturating_sub(1);
    if between > 0 {
        path = path.smoothed(between);
    } else if path.views.len() > setup.frames {
        let n = path.views.len();
        path.views = (0..setup.frames).map(|i| path.views[i * n / setup.frames]).collect();
    }
    path
}

/// That path with all of its own views, at the size that was asked for.
pub fn whole_path<S: World>(scene: &Scene<S>, setup: &Setup) -> ViewPath<S> {
    let own = scene.paths().first().cloned();
    sized(own.unwrap_or_else(|| figure_eight_path(scene, setup.frames)), setup)
}

/// A path at the size that was asked for.
pub(super) fn sized<S: World>(mut path: ViewPath<S>, setup: &Setup) -> ViewPath<S> {
    if let Some([width, height]) = setup.size_px {
        let height = if S::Vector::AXES == 2 { 1 } else { height };
        path.views.iter_mut().for_each(|v| (v.width, v.height) = (width, height));
    }
    path
}

/// As [`about`], of what is measured with all that moves where it was loaded.
pub fn at_rest<S: World>(scene: &Scene<S>, path: &ViewPath<S>) -> Measured {
    let mut about = about(scene, path);
    if !scene.moving().is_empty() {
        about.path += ", what moves at rest";
    }
    about
}

/// The scene and the path that were measured.
pub fn about<S: World>(scene: &Scene<S>, path: &ViewPath<S>) -> Measured {
    Measured {
        name: scene.name().into(),
        source: scene.source().into(),
        prims: scene.live().len(),
        prim: S::PRIM,
        path: path.name.clone(),
    }
}
