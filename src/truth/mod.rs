//! Room truth.
