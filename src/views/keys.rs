//! Keys, taken before egui uses them to move the focus or to scroll, unless a text field has the focus.
//!
//! All shortcuts are matched in one pass, those with the most modifiers first; an action that cannot be
//! done now does not swallow its key.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard};

use eframe::egui::{self, Event, Key, Modifiers};

use crate::app::Action;

/// What the keys need to know, and what was pressed.
#[derive(Default)]
pub struct Inbox {
    /// Actions that can be done now.
    pub enabled: BTreeSet<Action>,
    /// Whether a picture has the focus, so that Tab swaps the views.
    pub is_picture_focused: bool,
    /// Whether a text field or a dialog has the keys.
    pub is_typing: bool,
    /// Whether the pictures take letters to fly.
    pub is_flying: bool,
    /// Actions whose keys were pressed.
    pub pressed: Vec<Action>,
}

/// The inbox, shared between the window and the hook.
#[derive(Clone, Default)]
pub struct Keys(Arc<Mutex<Inbox>>);

impl Keys {
    /// The inbox.
    pub fn inbox(&self) -> MutexGuard<'_, Inbox> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// Keys of an action, as egui knows them.
pub fn chord(text: &str) -> Option<(Modifiers, Key)> {
    let mut modifiers = Modifiers::NONE;
    let mut rest = text;
    loop {
        let (more, after) = match rest {
            _ if rest.starts_with("Ctrl+") => (Modifiers::COMMAND, &rest[5..]),
            _ if rest.starts_with("Shift+") => (Modifiers::SHIFT, &rest[6..]),
            _ if rest.starts_with("Alt+") => (Modifiers::ALT, &rest[4..]),
            _ => break,
        };
        modifiers |= more;
        rest = after;
    }
    let key = match rest {
        "[" => Key::OpenBracket,
        "]" => Key::CloseBracket,
        "?" => Key::Questionmark,
        name => Key::from_name(name)?,
    };
    Some((modifiers, key))
}

fn bindings() -> Vec<(Modifiers, Key, Action)> {
    let each = |i: &'static crate::app::Info| {
        i.keys.iter().filter_map(move |k| chord(k).map(|(m, key)| (m, key, i.action)))
    };
    let mut all: Vec<_> = Action::ALL.iter().flat_map(each).collect();
    let weight = |m: &Modifiers| usize::from(m.command || m.ctrl) + usize::from(m.shift) + usize::from(m.alt);
    all.sort_by_key(|(m, ..)| std::cmp::Reverse(weight(m)));
    all
}

/// The hook.
pub struct Hook {
    keys: Keys,
    bindings: Vec<(Modifiers, Key, Action)>,
}

impl Hook {
    /// A hook that fills an inbox.
    pub fn new(keys: Keys) -> Self {
        Self { keys, bindings: bindings() }
    }
}

/// Letters that fly.
const FLY: [Key; 6] = [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E];

impl egui::Plugin for Hook {
    fn debug_name(&self) -> &'static str {
        "cullscope keys"
    }
    fn input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        let typing = ctx.text_edit_focused();
        let mut inbox = self.keys.inbox();
        let inbox = &mut *inbox;
        let mut taken_text: Vec<Key> = vec![];
        input.events.retain(|event| {
            let Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
            let plain = !modifiers.command && !modifiers.ctrl && !modifiers.alt;
            let is_function = key.name().starts_with('F') && key.name().len() > 1;
            if (typing || inbox.is_typing)
                && ((plain && !is_function) || edits_text(*modifiers, *key))
                && *key != Key::Escape
            {
                return true;
            }
            if *key == Key::Tab && !inbox.is_picture_focused
                || (inbox.is_flying && plain && FLY.contains(key))
            {
                return true;
            }
            // `?` needs Shift on most keyboards.
            let fits = |m: &Modifiers, k: &Key| {
                k == key && (modifiers.matches_exact(*m) || (*k == Key::Questionmark && plain))
            };
            let found = self.bindings.iter().find(|(m, k, a)| fits(m, k) && inbox.enabled.contains(a));
            let Some((.., action)) = found else { return true };
            inbox.pressed.push(*action);
            taken_text.push(*key);
            false
        });
        // A key that was taken must not type its letter either.
        if !taken_text.is_empty() {
            input.events.retain(|e| !matches!(e, Event::Text(_)));
        }
    }
}

/// Chords that a text field needs for itself.
fn edits_text(modifiers: Modifiers, key: Key) -> bool {
    let arrows = [
        Key::ArrowLeft,
        Key::ArrowRight,
        Key::ArrowUp,
        Key::ArrowDown,
        Key::Home,
        Key::End,
        Key::Backspace,
        Key::Delete,
    ];
    arrows.contains(&key)
        || ((modifiers.command || modifiers.ctrl)
            && [Key::A, Key::C, Key::V, Key::X, Key::Z, Key::Y].contains(&key))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_table_is_a_key() {
        for info in Action::ALL {
            for keys in info.keys {
                assert!(chord(keys).is_some(), "{}: {keys}", info.name);
            }
        }
        let all = bindings();
        let at = |text| all.iter().position(|(m, k, _)| chord(text) == Some((*m, *k)));
        assert!(at("Ctrl+Shift+S") < at("Ctrl+S"));
    }
}
