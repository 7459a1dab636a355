//! Room figure.
