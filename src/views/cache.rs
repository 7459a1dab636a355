//! What only the screen needs, from frame to frame: pictures drawn once, half-typed text, what the pointer
//! holds. Each panel is given its own part.

use super::handles::Hand;
use super::{canvas, code, dialogs, events, objects, pictures, space, strip, timeline};
use crate::app::Example;

/// The parts, by the panels that keep them.
#[derive(Default)]
pub struct Cache {
    /// Of all pictures, and of the numbers of the Eye.
    pub hand: Hand,
    /// Of flatland from above.
    pub world: Option<canvas::World>,
    /// Of flatland through the Eye.
    pub image: strip::Image,
    /// Of space.
    pub uploaded: space::Uploaded,
    /// Of the method's own pictures.
    pub picture: pictures::Shown,
    /// Of the timeline.
    pub timeline: timeline::Kept,
    /// Of the pseudocode.
    pub code: Option<code::Reached>,
    /// Of the event tree.
    pub scroll: events::Scroll,
    /// Of the list of objects.
    pub objects: objects::Kept,
    /// Of the dialogs.
    pub typing: dialogs::Typing,
    /// Of the start screen.
    pub examples: Option<Vec<Example>>,
}
