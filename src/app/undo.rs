//! Undo: what culling depended on before each change.

use super::any::AnyView;
use super::shown::Gesture;
use crate::method::Settings;

/// All that culling depends on, beside the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    pub(super) method: String,
    pub(super) settings: Settings,
    pub(super) place: (usize, usize),
    pub(super) view: AnyView,
}

/// Changes that can be taken back.
#[derive(Clone, Debug, Default)]
pub struct History {
    before: Vec<(Inputs, Gesture)>,
    after: Vec<Inputs>,
}

/// Changes that are kept.
const LIMIT: usize = 500;

impl History {
    /// Called before a change; changes of one gesture are taken back together.
    pub(super) fn push(&mut self, now: Inputs, gesture: Gesture) {
        self.after.clear();
        if gesture != 0 && self.before.last().is_some_and(|(_, last)| *last == gesture) {
            return;
        }
        self.before.push((now, gesture));
        if self.before.len() > LIMIT {
            self.before.remove(0);
        }
    }
    pub(super) fn undo(&mut self, now: Inputs) -> Option<Inputs> {
        let (inputs, _) = self.before.pop()?;
        self.after.push(now);
        Some(inputs)
    }
    pub(super) fn redo(&mut self, now: Inputs) -> Option<Inputs> {
        let inputs = self.after.pop()?;
        self.before.push((now, 0));
        Some(inputs)
    }
    pub(super) fn can(&self) -> (bool, bool) {
        (!self.before.is_empty(), !self.after.is_empty())
    }
    pub(super) fn clear(&mut self) {
        self.before.clear();
        self.after.clear();
    }
}
