//! Room raster.
