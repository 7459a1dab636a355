//! What is asked for in the laboratory, and what was found: speed against error of all methods on the open
//! scene's path, and advice.

use std::sync::Arc;

use crate::drawing::{Drawing, Tradeoff};
use crate::measure::advise::Advice;
use crate::measure::stability::Stability;
use crate::measure::sweep::{Configuration, Log, Spec, results};

/// What to do in the laboratory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Laboratory {
    /// Measures all methods, and every parameter of the chosen one at other values, on the path.
    Measure,
    /// Looks for the simplest configuration that is right enough: wrong pixels at most, per cent.
    Advise(f32),
    /// Looks over the floor plan and along the path for wrong culls and popping of the chosen method.
    Map,
    /// Puts the Eye on a place of the map, by its number.
    Stand(u32),
    /// Puts the Eye where a decision flips, by its number, on the side where the primitive is left out.
    Flip(usize),
    /// Stops.
    Stop,
    /// Opens a configuration of the chart, by its number, in the frame that it did worst in.
    Open(u32),
    /// Uses what is advised.
    Use,
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// What is measured, once something was asked for.
    pub spec: Option<Spec>,
    /// What is known so far.
    pub log: Log,
    /// The chart of that.
    pub chart: Option<Tradeoff>,
    /// The number of the scene on stage that this is about.
    pub(super) serial: u64,
    /// Frames of the path that were measured, by their number in the path, which is this one.
    pub(super) frames: Vec<usize>,
    pub(super) path: usize,
    /// Advice on that path.
    pub advice: Option<Arc<Advice>>,
    /// How stable a method is.
    pub map: Option<Arc<Map>>,
}

/// How stable a method is on a scene, over its floor plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The method, with its parameters.
    pub of: Configuration,
    /// Numbers in the path of the views that were looked at.
    pub frames: Vec<usize>,
    /// What was found.
    pub found: Stability,
    /// The picture, on paper; its dots are about places of the grid.
    pub picture: Drawing,
}

impl Map {
    /// What was found at a place, in words.
    pub fn about(&self, number: u32) -> Option<String> {
        let spot = self.found.grid.get(number as usize)?;
        let (eye, found) = (&spot.eye, &spot.found);
        let place = eye.iter().map(|v| format!("{v:.3}")).collect::<Vec<_>>().join(", ");
        Some(format!(
            "Eye at {place}\n{} visible, {} of them missed\n{} wrong pixels\n{} pixels pop with a small step",
            found.visible, found.missed, found.wrong_pixels, found.popped_pixels
        ))
    }
}

impl Findings {
    /// Method, parameters, time and error of a configuration of the chart, in words.
    pub fn about(&self, number: u32) -> Option<String> {
        let (spec, chart) = (self.spec.as_ref()?, self.chart.as_ref()?);
        let tried = chart.curves.iter().flat_map(|c| &c.tried).find(|t| t.number == number)?;
        let [_, at] = results::of_number(spec, number);
        let label = spec.configurations.get(at)?.label();
        let error = format!("{:.4}", tried.error);
        let error = error.trim_end_matches('0').trim_end_matches('.');
        let frames = tried.frames.len();
        Some(format!(
            "{label}\n{:.3} ms a frame ({frames} frames)\n{}: {error}",
            tried.time_ms, chart.error_label
        ))
    }
}
