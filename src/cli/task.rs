//! What `cull` and `step` have in common: a scene, a method that is ready to run on it, and views.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::reason;
use super::methods::{find, settings};
use super::progress::Bar;
use super::scene::SceneArgs;
use super::view::ViewArgs;
use super::{CliError, World, output};
use crate::geometry::ViewPath;
use crate::measure::deadline::Paced;
use crate::measure::timed;
use crate::method::RestoreError;
use crate::scene::{AnyScene, Motion, Part, Scene};

/// Options that say what to run, on what, and from where.
#[derive(clap::Args)]
pub(super) struct Task {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    view: ViewArgs,
    /// Keep what takes long to build, such as chosen occluders: FILE is read if it is there, else written
    #[arg(long, value_name = "FILE")]
    preprocess: Option<PathBuf>,
}

/// A task that can begin.
pub(super) struct Ready<S: World> {
    pub run: Paced<S>,
    /// The scene of each view.
    pub motion: Motion<S>,
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

    /// Checks the words before the work, then builds the index for the first view's frame of the scene.
    pub fn ready<S: World>(&self, scene: &Arc<Scene<S>>) -> Result<Ready<S>, CliError> {
        let entry = find::<S>(&self.scene.method)?;
        let settings = settings(&self.scene.set)?;
        entry.knobs(&settings)?;
        let path = self.view.views(scene)?;
        let mut motion = Motion::new(scene);
        let first = motion.at(0);
        let bar = Bar::new();
        let saved = self.saved()?;
        let (run, build_ms) = timed(|| match &saved {
            Some(bytes) => entry.restore(&first, &settings, bytes, &bar).map_err(|e| self.refused(&e)),
            None => entry.ready(&first, &settings, &bar).map_err(CliError::from),
        });
        let run = Paced::new(run?.ok_or(CliError::Interrupted)?, &first);
        if let (Some(path), None) = (&self.preprocess, saved) {
            let Some(bytes) = run.hierarchy().save() else {
                return Err(CliError::words(
                    "--preprocess",
                    format!("the method `{}` has nothing that takes long to build", run.card().key),
                ));
            };
            output::write_file(path, |to| to.write_all(&bytes).map(|()| true))?;
        }
        Ok(Ready { run, motion, path, build_ms, bar })
    }

    /// The bytes of `--preprocess`, if the file is there.
    fn saved(&self) -> Result<Option<Vec<u8>>, CliError> {
        let Some(path) = self.preprocess.as_ref().filter(|p| p.exists()) else { return Ok(None) };
        fs::read(path).map(Some).map_err(|e| CliError::work(path.display().to_string(), reason(&e)))
    }

    fn refused(&self, error: &RestoreError) -> CliError {
        let file = self.preprocess.as_deref().unwrap_or(Path::new("")).display().to_string();
        match error {
            RestoreError::Setting(error) => error.clone().into(),
            RestoreError::Saved(why) => {
                CliError::work(file, why.clone()).with_help("delete the file, and it is made anew")
            }
        }
    }
}

impl<S: World> Ready<S> {
    /// Brings the run to the scene that view `at` of the path sees: where objects move, that of the frame of
    /// this number.
    pub fn pose(&mut self, at: usize) -> Result<Arc<Scene<S>>, CliError> {
        let scene = self.motion.at(at);
        let part = Part::of(&self.bar, at, self.path.views.len());
        if self.run.pose(&scene, &part) { Ok(scene) } else { Err(CliError::Interrupted) }
    }
}
