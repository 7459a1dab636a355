//! Zhang, Manocha, Hudson and Hoff: what is drawn of occluders (Sections 6.2 and 8), and which holes are
//! ignored (5.4). Cost: O(frames) images of the scene.

mod closing;
mod occluders;
mod seen;

use crate::measure::Experiment;

/// The tables.
pub const TABLES: &[Experiment] = &[occluders::TABLE, closing::TABLE];
