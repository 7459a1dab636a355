//! The stage, the view and the film of either space, and a view as a session file keeps it.

use serde::{Deserialize, Serialize};

use super::stage::{Recorded, Stage, Staged};
use crate::geometry::{Either, Eye, Flat, Solid, Space, Vector, View, each};
use crate::scene::AnyScene;

/// A stage of either space.
pub type AnyStage = Either<Stage<Flat>, Stage<Solid>>;
/// A view of either space.
pub type AnyView = Either<View<Flat>, View<Solid>>;
/// A recorded film of either space.
pub type AnyRecorded = Either<Recorded<Flat>, Recorded<Solid>>;

impl AnyStage {
    /// The stage without its space.
    pub fn get(&self) -> &dyn Staged {
        each!(self, s => s)
    }
    /// The Eye that culling uses.
    pub fn view(&self) -> AnyView {
        each!(self, s => Either(s.view))
    }
    /// The Eye with an image of another size; of flatland it has height 1.
    pub fn sized(&self, (width, height): (u32, u32)) -> AnyView {
        match self {
            Self::Flat(s) => Either::Flat(View { width, height: 1, ..s.view }),
            Self::Solid(s) => Either::Solid(View { width, height, ..s.view }),
        }
    }
    /// The scene.
    pub fn scene(&self) -> AnyScene {
        each!(self, s => Either(s.scene.clone()))
    }
    /// Sets the Eye if it is of this space and can see; returns whether it did.
    pub fn set_view(&mut self, view: &AnyView) -> bool {
        match (self, view) {
            (Either::Flat(s), Either::Flat(v)) if v.eye.fault().is_none() => s.view = *v,
            (Either::Solid(s), Either::Solid(v)) if v.eye.fault().is_none() => s.view = *v,
            _ => return false,
        }
        true
    }
    /// Moves the Eye as [`AnyStage::set_view`] does, with near and far fitted to where it stands then.
    pub fn move_eye(&mut self, view: &AnyView) -> bool {
        let fitted = match (&*self, view) {
            (Either::Flat(s), Either::Flat(v)) => Either::Flat(s.fitted(*v)),
            (Either::Solid(s), Either::Solid(v)) => Either::Solid(s.fitted(*v)),
            _ => return false,
        };
        self.set_view(&fitted)
    }
    /// Goes to a view of a path.
    pub fn go(&mut self, path: usize, frame: usize) {
        each!(self, s => s.go(path, frame));
    }
}

/// A view as a session file keeps it: every bit of every number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewRecord {
    eye: Vec<f32>,
    target: Vec<f32>,
    up: Vec<f32>,
    fov_radians: f32,
    near: f32,
    far: f32,
    width: u32,
    height: u32,
}

impl ViewRecord {
    fn of<S: Space>(view: &View<S>) -> Self {
        let list = |v: S::Vector| (0..S::Vector::AXES).map(|a| v.get(a)).collect();
        let e = &view.eye;
        let (eye, target, up) = (list(e.position), list(e.target), list(e.up));
        Self {
            eye,
            target,
            up,
            fov_radians: e.fov,
            near: e.near,
            far: e.far,
            width: view.width,
            height: view.height,
        }
    }
    fn view<S: Space>(&self) -> Option<View<S>> {
        let vector = |v: &[f32]| (v.len() == S::Vector::AXES).then(|| S::Vector::from_fn(|a| v[a]));
        let (position, target, up) = (vector(&self.eye)?, vector(&self.target)?, vector(&self.up)?);
        let eye = Eye { position, target, up, fov: self.fov_radians, near: self.near, far: self.far };
        let fits = |n: u32| (1..=16384).contains(&n);
        (eye.fault().is_none() && fits(self.width) && fits(self.height)).then_some(View {
            eye,
            width: self.width,
            height: self.height,
        })
    }
    /// The view again; `None` if it could not see.
    pub fn any(&self) -> Option<AnyView> {
        match self.eye.len() {
            2 => self.view().map(Either::Flat),
            _ => self.view().map(Either::Solid),
        }
    }
}

impl From<&AnyView> for ViewRecord {
    fn from(view: &AnyView) -> Self {
        each!(view, v => Self::of(v))
    }
}
