//! Clocks: how long work takes, and fair comparison of two ways to do it. The only room that reads a
//! clock, so that nothing below it can depend on time. And the experiments of the papers, as [`paper`].

pub mod deadline;
pub mod paper;
mod table;
pub mod timing;

pub use table::{Cell, Column, Table};
pub use timing::{Paired, Stopwatch, median, paired, timed};
