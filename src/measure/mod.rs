//! Clocks: how long work takes, and fair comparison of several ways to do it. The only room that reads a
//! clock, so that nothing below it can depend on time. And what an [`Experiment`] is, with the harness that
//! all of them run in.

pub mod advise;
pub mod columns;
pub mod deadline;
pub mod experiment;
pub mod harness;
mod report;
pub mod stability;
pub mod sweep;
mod table;
pub mod timing;

pub use experiment::{Experiment, ExperimentError, Setup};
pub use report::{Measured, Report};
pub use table::{Cell, Column, Table};
pub use timing::{Paired, Stopwatch, median, paired, timed};
