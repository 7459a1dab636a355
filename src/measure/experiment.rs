//! What an experiment is: a table that is measured on scenes, beside the numbers that a paper printed.
//!
//! An [`Experiment`] is a value: a name, and what it runs on each scene. The papers' models and machines are
//! not ours, so shares and ratios compare and milliseconds do not. Whatever is measured, the answers of a
//! method that promises to draw all that is visible are checked: the triangles that an item buffer shows and
//! the method did not draw are counted (0 expected).

use std::cell::RefCell;
use std::sync::Arc;

use super::columns::SCENE;
use super::report::{Measured, Report};
use super::table::{Cell, Column, Table};
use crate::culling::Methods;
use crate::drawing::Plot;
use crate::drawing::words::grouped;
use crate::geometry::{Flat, Solid};
use crate::method::{Entry, Knob, KnobValue, SettingError, Settings, settings_for};
use crate::raster::Drawable;
use crate::scene::{AnyScene, Part, Progress, Scene};

/// A space in which experiments work.
pub trait World: Methods + Drawable {}
impl<S: Methods + Drawable> World for S {}

/// Key of a method, and all its parameters.
type Ran = (String, Vec<(Knob, KnobValue)>);

/// What an experiment is run with.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Frames that are measured on each scene (at each speed, at each value of a parameter); at least 1.
    pub frames: usize,
    /// Parameters of the method; those that a method it is compared with has too are given to that as well.
    pub settings: Settings,
    /// Every how many of the measured frames the answer is compared with the truth; 0: never.
    pub check_every: usize,
    /// Random rectangles that a table asks maps about.
    pub rectangles: usize,
    /// Size of the image, if not that of the path.
    pub size_px: Option<[u32; 2]>,
    /// What was run so far.
    pub ran: RefCell<Vec<Ran>>,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            frames: 240,
            settings: Settings::default(),
            check_every: 8,
            rectangles: 100_000,
            size_px: None,
            ran: RefCell::default(),
        }
    }
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// A parameter that the method does not have, or whose value does not fit.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// An experiment names a method that this build does not have.
    #[error("there is no method `{0}`")]
    UnknownMethod(String),
    /// It was stopped.
    #[error("stopped as asked")]
    Cancelled,
}

/// The method with this key.
///
/// # Errors
/// There is none.
pub fn method<S: Methods>(key: &str) -> Result<&'static dyn Entry<S>, ExperimentError> {
    S::method(key).ok_or_else(|| ExperimentError::UnknownMethod(key.to_owned()))
}

/// A table of a paper, or the answer to a question that it leaves open.
pub struct Experiment {
    /// Kebab-case name.
    pub name: &'static str,
    /// Title of the result.
    pub title: &'static str,
    /// One line for lists.
    pub summary: &'static str,
    /// Key of the method that it is about.
    pub method: &'static str,
    /// What it is measured on where no scene is named.
    pub scenes: &'static [&'static str],
    /// What is to be known for reading the table.
    pub notes: &'static [&'static str],
    /// Parameters that it gives another value than the method does, where none is set.
    pub settings: &'static [(&'static str, &'static str)],
    /// What it does.
    pub sweep: &'static Sweep,
}

/// What an experiment does.
pub struct Sweep {
    /// The columns of its table.
    pub columns: &'static [Column],
    /// The rows of a scene of flatland.
    pub flat: Measure<Flat>,
    /// The rows of a scene of space.
    pub solid: Measure<Solid>,
    /// The paper's rows.
    pub paper: fn() -> Vec<Vec<Cell>>,
    /// Charts of the measured rows; they know the paper's numbers.
    pub plots: fn(&Table) -> Vec<Plot>,
}

/// Rows of a table, with the scene that they were measured on.
pub type Rows = Result<(Vec<Vec<Cell>>, Measured), ExperimentError>;

/// Measures a scene.
pub type Measure<S> = fn(&Arc<Scene<S>>, &Setup, &dyn Progress) -> Rows;

impl Experiment {
    /// Whether the parameters are fine.
    ///
    /// # Errors
    /// As [`Experiment::run`].
    pub fn check(&self, settings: &Settings) -> Result<(), ExperimentError> {
        Ok(method::<Solid>(self.method)?.knobs(settings).map(drop)?)
    }

    /// Runs it on scenes, one after the other.
    ///
    /// # Errors
    /// A parameter that does not fit; or it was cancelled.
    pub fn run(
        &self,
        scenes: &[AnyScene],
        setup: &Setup,
        progress: &dyn Progress,
    ) -> Result<Report, ExperimentError> {
        self.check(&setup.settings)?;
        let mut setup = Setup { frames: setup.frames.max(1), ..setup.clone() };
        for (key, value) in self.settings {
            setup.settings.0.entry((*key).to_owned()).or_insert_with(|| (*value).to_owned());
        }
        let mut table = Table::new(self.sweep.columns);
        let mut measured = Vec::new();
        for (i, scene) in scenes.iter().enumerate() {
            let part = Part::of(progress, i, scenes.len());
            let (mut rows, mut about) = match scene {
                AnyScene::Flat(scene) => (self.sweep.flat)(scene, &setup, &part)?,
                AnyScene::Solid(scene) => (self.sweep.solid)(scene, &setup, &part)?,
            };
            // A scene's name distinguishes its rows.
            if measured.iter().any(|m: &Measured| m.name == about.name) {
                about.name += &format!(", {}", grouped(about.prims as f64, 0));
                let at = table.columns.iter().position(|c| c.key == SCENE.key);
                rows.iter_mut()
                    .filter_map(|r| r.get_mut(at?))
                    .for_each(|cell| *cell = about.name.as_str().into());
            }
            table.rows.extend(rows);
            measured.push(about);
        }
        let plots = (self.sweep.plots)(&table);
        table.rows.extend((self.sweep.paper)());
        let entry = method::<Solid>(self.method)?;
        let ran = setup.ran.take().into_iter().filter(|(key, _)| key == self.method);
        let runs: Vec<_> = ran.map(|(_, knobs)| knobs).collect();
        let departures = entry.card().departing(|d| runs.iter().any(|knobs| d.holds(knobs)));
        let (params, varied) = parameters(entry, &runs);
        let (name, title, notes) = (self.name, self.title, self.notes.to_vec());
        Ok(Report {
            name,
            title,
            table,
            plots,
            scenes: measured,
            doi: entry.card().doi,
            method: self.method,
            params,
            varied,
            departures,
            frames: setup.frames,
            notes,
        })
    }
}

/// Parameters that are the same in all runs, and the others with their values in the order of first use; of
/// those that follow from others nothing is said.
type Parameters = (Vec<(&'static str, String)>, Vec<(&'static str, Vec<String>)>);

fn parameters(entry: &dyn Entry<Solid>, runs: &[Vec<(Knob, KnobValue)>]) -> Parameters {
    let given: Vec<_> = runs.iter().map(|knobs| settings_for(entry, knobs)).collect();
    let (mut same, mut varied) = (Vec::new(), Vec::new());
    for (at, (knob, _)) in runs.first().into_iter().flatten().enumerate() {
        let mut values: Vec<String> = Vec::new();
        for value in runs.iter().map(|knobs| knobs[at].1.to_string()) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        if values.len() == 1 {
            same.extend(values.pop().map(|value| (knob.name, value)));
        } else if given.iter().flatten().any(|(name, _)| *name == knob.name) {
            varied.push((knob.name, values));
        }
    }
    (same, varied)
}
