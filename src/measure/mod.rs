//! Clocks: how long work takes, and fair comparison of two ways to do it. The only room that reads a
//! clock, so that nothing below it can depend on time.

pub mod timing;

pub use timing::{Paired, Stopwatch, paired, timed};
