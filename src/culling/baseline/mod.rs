//! The baselines of every comparison: draw everything, cull by the view frustum over a kD-tree, and
//! draw the nearest centroids up to a budget.

mod centroid;
mod explain;
mod frustum;
#[cfg(test)]
mod tests;
mod z_buffer;

pub use centroid::Centroid;
pub use explain::Evidence;
pub use frustum::Frustum;
pub use z_buffer::ZBuffer;
