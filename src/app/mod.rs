//! The explorer without its window: state, commands, the worker thread, sessions.
//!
//! Views are functions of [`State`] and answer in [`Command`]s; [`State::apply`] is the only way that
//! anything changes. Nothing here knows a GUI, so every behavior is tested without one.

mod any;
mod apply;
mod camera;
mod canvas;
mod command;
mod concern;
mod export;
mod file;
mod filter;
mod findings;
mod floor;
mod hidden_by;
mod judged;
mod laboratory;
mod lanes;
mod layer_steps;
mod layers;
mod legend;
mod lines;
mod measured;
mod objects;
mod open;
mod outline;
mod painted;
mod pick;
mod pixel;
mod plate;
mod recall;
mod recipe;
mod session;
mod shown;
mod sight;
mod stage;
mod start;
mod state;
mod steps;
mod surfaces;
mod tables;
#[cfg(test)]
mod tests;
mod undo;
mod unshown;
mod why;
mod worker;

pub use any::{AnyStage, AnyView};
pub use camera::ObserverCamera;
pub use command::{Action, Command, Info, Menu, fuzzy};
pub use concern::Concern;
pub use export::recipe_in;
pub use file::{discard_unfinished, write_whole};
pub use filter::{Filter, FilterError};
pub use findings::{Findings, Laboratory, Map};
pub use floor::floor_map;
pub use lanes::{Cell, Lane, lanes};
pub use layers::{InLayer, Layers};
pub use lines::value;
pub use measured::{Measured, Tables, tables};
pub use objects::{By, Listing, ObjectRow, listed, object_title, objects};
pub use open::{AnyOpened, Example, Opened, examples};
pub use outline::Outline;
pub use pick::Column;
pub use pixel::PixelHistory;
pub use plate::{Export, Made, PAPERS, Picture, word};
pub use session::{Bookmark, Session, SessionError, write_file};
pub use shown::{Breakpoint, Dialog, Gesture, Layout, LookIn, Shown, Surface, Theme};
pub use stage::{AtPixel, HiddenBy, PoseKey, Reading, Recorded, SceneFacts, Stage, Staged, view_text};
pub use start::{Shot, Start};
pub use state::{Effect, Notice, State};
pub use why::{Because, Why, spoken, why};
pub use worker::{Busy, FILM_CAP_EVENTS};
