//! The selection as bytes, so that a preprocess is done once: versioned, and checked against scene and parameters.
