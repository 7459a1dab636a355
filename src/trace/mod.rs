//! Room trace.
