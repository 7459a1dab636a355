//! cullscope: a visual explorer and step-through debugger of visibility culling.
//!
//! The house has one direction. A room uses only rooms above it in this list, never a peer;
//! `tests/tidy.rs` holds the walls and `ARCHITECTURE.md` is the map.
//!
//! | rank | room | what |
//! |---|---|---|
//! | 0 | [`geometry`] | points, boxes, planes, frusta, eyes, exact predicates |
//! | 1 | [`scene`] | what is looked at: load, generate, preprocess, validate |
//! | 2 | [`drawing`] | a picture as a value |
//! | 2 | [`raster`] | depth lines and images, item buffers |
//! | 3 | [`index`] | spatial trees |
//! | 4 | [`method`] | what a method is: the shape they share, what they report, runs and films |
//! | 5 | [`culling`] | the methods, and the list of them |
//! | 5 | [`trace`] | a finished run at any step |
//! | 5 | [`truth`] | exact visibility, error measures, the checker of certificates |
//! | 6 | [`figure`] | a step as a drawing |
//! | 6 | [`measure`] | clocks: timing and comparison |
//! | 7 | [`papers`] | the papers: their figures and tables, made anew |
//! | 7 | [`render`] | readers of drawings: SVG, PDF, PNG, screen |
//! | 8 | [`app`] | the explorer's state and commands |
//! | 9 | `views` | the explorer's panels (feature `gui`) |
//! | 9 | [`cli`] | the command line |

pub mod app;
pub mod cli;
pub mod culling;
pub mod drawing;
pub mod figure;
pub mod geometry;
pub mod index;
pub mod measure;
pub mod method;
pub mod papers;
pub mod raster;
pub mod render;
pub mod scene;
pub mod trace;
pub mod truth;
#[cfg(feature = "gui")]
pub mod views;
