//! A paper's table, measured on the open scene or on the default ones, with its chart.

use crate::drawing::Drawing;
use crate::figure::chart;
use crate::measure::{ExperimentError, Report, Setup};
use crate::method::Settings;
use crate::papers;
use crate::scene::{AnyScene, LoadOptions, Part, Progress, load};

/// Frames in each scene: few enough to wait for.
const FRAMES: usize = 96;

/// What to do with the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tables {
    /// Measures the table with this name.
    Measure(&'static str),
    /// Stops measuring.
    Stop,
    /// Writes the table as `csv`, or its chart as `svg`, `pdf` or `png`, into the working folder.
    Export(&'static str),
}

/// A table that was measured, with its chart on paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The table.
    pub report: Report,
    /// The chart.
    pub chart: Drawing,
}

/// Names and titles of all tables, for lists.
pub fn tables() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    papers::tables().map(|t| (t.name, t.title, t.summary))
}

/// Runs on the worker.
pub(super) fn measure(
    name: &str,
    scene: Option<AnyScene>,
    settings: Settings,
    progress: &dyn Progress,
) -> Result<Measured, String> {
    let experiment = papers::table(name).ok_or_else(|| format!("there is no table `{name}`"))?;
    let mut start = 0.0;
    let mut scenes: Vec<AnyScene> = scene.into_iter().collect();
    if scenes.is_empty() {
        let share = 0.2 / experiment.scenes.len() as f32;
        for (i, source) in experiment.scenes.iter().enumerate() {
            let part = Part { whole: progress, start: share * i as f32, length: share };
            scenes.push(load(source, &LoadOptions::default(), &part).map_err(|e| e.to_string())?);
        }
        start = 0.2;
    }
    let setup = Setup { frames: FRAMES, settings, ..Setup::default() };
    let rest = Part { whole: progress, start, length: 1.0 - start };
    let report = experiment.run(&scenes, &setup, &rest).map_err(|e: ExperimentError| e.to_string())?;
    let chart = chart(report.title, &report.plots, &report.caption());
    Ok(Measured { report, chart })
}
