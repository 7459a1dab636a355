//! The papers' tables in the explorer: an experiment runs on the worker, and its table and chart stay until
//! the next one.

use std::sync::Arc;

use super::measured::{Measured, Tables};
use super::session::write_file;
use super::shown::Theme;
use super::state::State;
use super::worker::Job;
use crate::method::Settings;
use crate::papers;
use crate::render;

impl State {
    pub(super) fn tables(&mut self, asked: Tables) {
        match asked {
            Tables::Measure(name) => {
                let scene = self.stage.as_ref().map(|stage| stage.scene());
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
    pub(super) fn record_if_missing(&mut self) {
        if self.stage.is_some() && self.film().is_none() {
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
            painted => {
                painted.parse().and_then(|format| render::export(chart, format, Theme::Print, &recipe))
            }
        };
        let path = self.path_of(&format!("{}.{format}", report.name));
        match bytes.map_err(|e| e.to_string()).and_then(|b| write_file(&path, &b).map_err(|e| e.to_string()))
        {
            Ok(()) => self.tell(format!("The table was written to {path}.")),
            Err(error) => self.fail(error),
        }
    }
}
