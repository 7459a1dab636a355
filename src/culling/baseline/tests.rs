//! The baselines against brute force.
