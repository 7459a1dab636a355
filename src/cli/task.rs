//! What `cull` and `step` have in common: a scene, a method that is ready to run on it, and views.

use std::sync::Arc;

use super::methods::{find, settings};
use super::progress::Bar;
use super::scene::SceneArgs;
use super::view::ViewArgs;
use super::{CliError, World};
use crate::culling::Run;
use crate::geometry::ViewPath;
use crate::measure::timed;
use crate::scene::{AnyScene, Scene};

/// Options that say what to run, on what, and from where.
#[derive(clap::Args)]
pub(super) struct Task {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    view: ViewArgs,
}

/// A task that can begin.
pub(super) struct Ready<S: World> {
    pub run: Box<dyn Run<S>>,
    pub path: ViewPath<S>,
    pub build_ms: f64,
    /// Waits and listens for Ctrl-C since before the index was built.
    pub bar: Bar,
}

impl Task {
    /// Loads the scene.
    pub fn load(&self) -> Result<AnyScene, CliError> {
        self.scene.load()
    }

    /// Checks the words before the work, then builds the index.
    pub fn ready<S: World>(&self, scene: &Arc<Scene<S>>) -> Result<Ready<S>, CliError> {
        let entry = find::<S>(&self.scene.method)?;
        let settings = settings(&self.scene.set)?;
        entry.knobs(&settings)?;
        let path = self.view.views(scene)?;
        let bar = Bar::new();
        let (run, build_ms) = timed(|| entry.ready(scene, &settings, &bar));
        let run = run?.ok_or(CliError::Interrupted)?;
        Ok(Ready { run, path, build_ms, bar })
    }
}
