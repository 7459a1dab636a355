//! Room culling.
