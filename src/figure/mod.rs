//! (film, step, look) → drawing: every picture in the explorer and in the documentation.
//!
//! [`Page`] sets title, legend and caption around a picture. [`world`] draws a step in world coordinates,
//! [`Sheet`] and [`project`] put it on paper. [`pick()`] finds what lies under the pointer.

pub mod axis;
mod chart;
mod clip;
mod heat;
mod listing;
mod look;
pub mod page;
mod panels;
mod pick;
mod place;
mod solved;
pub mod tools;
mod tradeoff;

pub use chart::{chart, charts};
pub use clip::clip;
pub use heat::{Heat, heat_map};
pub use listing::{Row, listing};
pub use look::{Look, observer_above, role_of, world};
pub use page::{Entry, Page, Paper, Swatch};
pub use panels::{GRID_GAP_PT, Panel, Picture, grid, grid_cell_pt, labelled, panels, plate_labels};
pub use pick::{pick, pick_node, pick_segment};
pub use place::{Sheet, project};
pub use solved::{Face, solved};
pub use tradeoff::{tradeoff, tradeoff_charts, tradeoffs};
