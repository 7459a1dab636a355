//! Methods ready to run with the settings of an experiment, and what long work does at each step.

use std::sync::Arc;

use crate::measure::experiment::{ExperimentError, Setup, World, method};
use crate::method::{RestoreError, Run, Settings};
use crate::scene::{Part, Progress, Scene};

/// Those of the experiment's settings that a method has, and these on top. What is to be run with them is
/// kept in the setup, for the caption.
///
/// # Errors
/// There is no such method.
pub fn settings<S: World>(
    key: &str,
    setup: &Setup,
    on_top: &[(&str, &str)],
) -> Result<Settings, ExperimentError> {
    let known = method::<S>(key)?.knobs(&Settings::default())?;
    let mut settings = setup.settings.clone();
    settings.0.retain(|key, _| known.iter().any(|(knob, _)| knob.name == key));
    settings.0.extend(Settings::of(on_top).0);
    let run = (key.to_owned(), method::<S>(key)?.knobs(&settings)?);
    let mut ran = setup.ran.borrow_mut();
    if !ran.contains(&run) {
        ran.push(run);
    }
    Ok(settings)
}

/// A method with those settings, ready to run.
///
/// # Errors
/// There is no such method, a value on top does not fit, or it was cancelled.
pub fn ready<S: World>(
    scene: &Arc<Scene<S>>,
    key: &str,
    setup: &Setup,
    on_top: &[(&str, &str)],
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, ExperimentError> {
    restore_or_build(scene, key, &settings::<S>(key, setup, on_top)?, None, progress)
}

/// A method ready to run, restored from what an earlier run saved if that fits, otherwise built.
///
/// # Errors
/// As [`ready`].
pub fn restore_or_build<S: World>(
    scene: &Arc<Scene<S>>,
    key: &str,
    settings: &Settings,
    saved: Option<&[u8]>,
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, ExperimentError> {
    let entry = method::<S>(key)?;
    let run = match saved.map(|saved| entry.restore(scene, settings, saved, progress)) {
        Some(Ok(run)) => run,
        Some(Err(RestoreError::Setting(error))) => return Err(error.into()),
        Some(Err(RestoreError::Saved(_))) | None => entry.ready(scene, settings, progress)?,
    };
    run.ok_or(ExperimentError::Cancelled)
}

/// Reports how far the work is.
///
/// # Errors
/// It was cancelled.
pub fn checkpoint(progress: &dyn Progress, fraction: f32, what: &'static str) -> Result<(), ExperimentError> {
    progress.report(fraction, what);
    if progress.cancelled() { Err(ExperimentError::Cancelled) } else { Ok(()) }
}

/// The part of a work from `start` to `end`, both from 0 to 1.
pub fn part(whole: &dyn Progress, start: f32, end: f32) -> Part<'_> {
    Part { whole, start, length: end - start }
}
