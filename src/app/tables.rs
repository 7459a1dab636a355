//! The papers' tables in the explorer: an experiment runs on the worker, on the open scene or on the default
//! ones, and its table and chart stay until the next one.

use std::sync::Arc;

use super::any::Any;
use super::session::write_file;
use super::state::{State, Theme};
use super::worker::Job;
use crate::drawing::Drawing;
use crate::figure::chart;
use crate::measure::{ExperimentError, Report, Setup};
use crate::method::Settings;
use crate::papers;
use crate::render::{self, PngSize, SvgOptions};
use crate::scene::{AnyScene, LoadOptions, Part, Progress, load};

/// Frames a scene: few enough to wait for.
const FRAMES: usize = 96;
/// Resolution of PNG files, for print.
const DPI: f32 = 300.0;

/// What is asked about tables.
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

impl State {
    pub(super) fn tables(&mut self, asked: Tables) {
        match asked {
            Tables::Measure(name) => {
                let scene = self.stage.as_ref().map(|stage| match stage {
                    Any::Flat(s) => AnyScene::Flat(s.scene.clone()),
                    Any::Solid(s) => AnyScene::Solid(s.scene.clone()),
                });
                // The parameters that are set are taken over if they are those of its method.
                let is_its = papers::table(name).is_some_and(|e| e.method == self.method);
                let settings = if is_its { self.settings.clone() } else { Settings::default() };
                self.worker.ask("Measuring", Job::Measure { name, scene, settings });
            }
            Tables::Stop => {
                self.worker.cancel();
                self.record_if_missing();
            }
            Tables::Export(format) => self.export_table(format),
        }
    }

    pub(super) fn take_table(&mut self, measured: Measured) {
        self.measured = Some(Arc::new(measured));
        self.record_if_missing();
    }

    /// Measuring takes the place of a film that was being recorded.
    fn record_if_missing(&mut self) {
        if self.staged().is_some_and(|s| !s.has_film()) {
            self.record();
        }
    }

    fn export_table(&mut self, format: &str) {
        let Some(measured) = self.measured.clone() else {
            return self.fail("There is no table to export yet.");
        };
        let Measured { report, chart } = &*measured;
        let recipe = format!("cullscope paper {} --frames {}", report.name, report.frames);
        let bytes = match format {
            "csv" => Ok(report.table.csv().into_bytes()),
            "svg" => Ok(render::svg(
                chart,
                Theme::Print,
                &SvgOptions { metadata: Some(&recipe), ..SvgOptions::default() },
            )
            .into_bytes()),
            "pdf" => render::pdf(chart, Theme::Print, Some(&recipe)),
            _ => render::png(chart, Theme::Print, PngSize::Dpi(DPI), Some(&recipe)),
        };
        let path = format!("{}.{format}", report.name);
        match bytes.map_err(|e| e.to_string()).and_then(|b| write_file(&path, &b).map_err(|e| e.to_string()))
        {
            Ok(()) => self.tell(format!("The table was written to {path}.")),
            Err(error) => self.fail(error),
        }
    }
}
