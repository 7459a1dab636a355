//! Sweeps: methods × parameters × scenes × frames, each configuration's speed beside its error.
//!
//! A [`Spec`] says what is run. [`fly`] runs what a [`Log`] does not hold yet and adds a [`Line`] for each
//! piece of the result as soon as it is known, so that a sweep can be ended at any time and taken up again,
//! and its parts can be run on several machines. All tables and charts are made from the log alone
//! ([`results`]): they are the same however it came about, but for times.
//!
//! Counts, images and errors repeat exactly and come from one flight along the path; times come from further
//! flights, in which all configurations take turns at a few frames each, in rotated order: caches are as warm
//! as in use, and drift of the machine falls on all of them.

mod fly;
mod log;
pub mod results;
mod spec;

pub use fly::{SweepError, fly, path};
pub use log::{Judged, Line, Log, LogError, Seen, Timed};
pub use spec::{Configuration, ErrorKind, Place, Spec, SpecError, named};

/// The configurations that part `part[0]` (from 1) of `part[1]` runs on scene `scene`, of so many.
pub fn share(scene: usize, configurations: usize, part: [u32; 2]) -> Vec<usize> {
    // Neighbors are often alike in cost, so they go to different machines.
    let is_ours = |at: &usize| (scene * configurations + at) as u32 % part[1] == part[0] - 1;
    (0..configurations).filter(is_ours).collect()
}
