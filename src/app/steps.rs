//! Moving through the film: stepping, running to breakpoints, playing.

use super::command::Action;
use super::session::Bookmark;
use super::shown::{Breakpoint, Dialog};
use super::stage::Reading;
use super::state::State;
use crate::drawing::Subject;
use crate::method::Event;
use crate::trace::{Detail, Moves};

impl State {
    /// Goes to a step; beyond the end is the end.
    pub(super) fn go_to(&mut self, step: usize) {
        self.step = step.min(self.len());
        let film = self.stage.as_ref().and_then(|s| s.get().film());
        if let (Some(film), Some(at)) = (film, self.step.checked_sub(1)) {
            self.outline.reveal(film, at);
        }
    }

    /// The step that an action leads to; `None` if the action is no move or leads nowhere.
    fn target_of(&self, action: Action) -> Option<usize> {
        let Reading { reel, moves, .. } = self.film()?;
        let (events, step, detail) = (reel.events(), self.step, self.detail);
        let at = self.current();
        match action {
            Action::Forward => Some(moves.forward(events, step, detail)),
            Action::Back => Some(moves.back(events, step, detail)),
            Action::Over => Some(moves.over(events, step, detail)),
            Action::BackOver => Some(moves.back_over(events, step, detail)),
            Action::Into => Some(moves.forward(events, step, Detail::Full)),
            Action::BackInto => Some(moves.back(events, step, Detail::Full)),
            Action::Out => Some(moves.out(events, step)),
            Action::BackOut => Some(moves.back_out(events, step)),
            Action::NextVerdict => moves.next(events, step, Moves::is_verdict),
            Action::PreviousVerdict => moves.previous(events, step, Moves::is_verdict),
            Action::NextSame | Action::PreviousSame => {
                let kind = reel.kind(at?);
                self.seek(action == Action::NextSame, |i| reel.kind(i) == kind)
            }
            Action::NextOnSelected
            | Action::PreviousOnSelected
            | Action::RunToCursor
            | Action::BackToCursor => {
                let wanted = Some(self.selection).filter(|s| *s != Subject::None)?;
                let forward = matches!(action, Action::NextOnSelected | Action::RunToCursor);
                self.seek(forward, |i| reel.subject(i) == wanted)
            }
            Action::Run => Some(self.seek(true, |i| self.stops_at(i)).unwrap_or(events.len())),
            Action::RunBack => Some(self.seek(false, |i| self.stops_at(i)).unwrap_or(0)),
            Action::First => Some(0),
            Action::Last => Some(events.len()),
            Action::PresentNext => match self.bookmarks.is_empty() {
                true => moves.next(events, step, Moves::is_verdict),
                false => self.bookmarks.iter().map(|b| b.step).find(|&s| s > step),
            },
            Action::PresentPrevious => match self.bookmarks.is_empty() {
                true => moves.previous(events, step, Moves::is_verdict),
                false => self.bookmarks.iter().rev().map(|b| b.step).find(|&s| s < step),
            },
            _ => None,
        }
    }

    /// The nearest step, forward or back, whose event `wanted` accepts.
    fn seek(&self, forward: bool, wanted: impl Fn(usize) -> bool) -> Option<usize> {
        if forward {
            (self.step..self.len()).find(|&i| wanted(i)).map(|i| i + 1)
        } else {
            (0..self.step.saturating_sub(1)).rev().find(|&i| wanted(i)).map(|i| i + 1)
        }
    }

    /// Whether a breakpoint stops at event `at`.
    pub fn stops_at(&self, at: usize) -> bool {
        let Some(Reading { reel, .. }) = self.film() else { return false };
        let event = reel.events()[at];
        self.breakpoints.iter().any(|b| match b {
            Breakpoint::Line(line) => event == Event::Line(*line),
            Breakpoint::Verdict(verdict) => event.verdict() == Some(*verdict),
            Breakpoint::Node(node) => reel.subject(at) == Subject::Node(*node),
            Breakpoint::Prim(prim) => reel.subject(at) == Subject::Prim(*prim),
        })
    }

    /// Carries out an action of the menu Step; returns whether it was one.
    pub(super) fn do_step(&mut self, action: Action) -> bool {
        match action {
            Action::PlayPause => {
                self.is_playing = !self.is_playing && !self.is_empty();
                self.pending = 0.0;
                if self.is_playing && self.step == self.len() {
                    self.go_to(0);
                }
            }
            Action::Slower => self.speed = (self.speed * 0.5).max(0.25),
            Action::Faster => self.speed = (self.speed * 2.0).min(1e6),
            Action::ToggleDetail => {
                self.detail = if self.detail == Detail::Full { Detail::Coarse } else { Detail::Full }
            }
            Action::GoTo => self.dialog = Dialog::GoTo,
            Action::Breakpoint => self.toggle_breakpoint(),
            Action::Bookmark => self.toggle_bookmark(),
            Action::PreviousFrame | Action::NextFrame => {
                let Some((path, frame)) = self.staged().map(|s| s.place()) else { return true };
                let next = if action == Action::NextFrame { frame + 1 } else { frame.saturating_sub(1) };
                self.go_frame(path, next);
            }
            _ if (Action::Bookmark1..=Action::Bookmark10).contains(&action) => {
                let nth = action as usize - Action::Bookmark1 as usize;
                match self.bookmarks.get(nth).cloned() {
                    Some(mark) => {
                        self.observer = mark.observer;
                        self.go_to(mark.step);
                    }
                    None => self.tell(format!("There is no bookmark {}.", nth + 1)),
                }
            }
            _ if action.info().menu == super::command::Menu::Step => {
                self.is_playing = false;
                match self.target_of(action) {
                    Some(step) => self.go_to(step),
                    None => self.tell(format!("{}: there is none.", action.info().title)),
                }
            }
            _ => return false,
        }
        true
    }

    fn toggle_breakpoint(&mut self) {
        let breakpoint = match (self.selection, self.line()) {
            (Subject::Node(node), _) => Breakpoint::Node(node),
            (Subject::Prim(prim), _) => Breakpoint::Prim(prim),
            (_, Some(line)) => Breakpoint::Line(line),
            _ => return self.tell("Select a node or a primitive, or step to a line, to set a breakpoint."),
        };
        self.flip(breakpoint);
    }

    pub(super) fn flip(&mut self, breakpoint: Breakpoint) {
        if !self.breakpoints.remove(&breakpoint) {
            self.breakpoints.insert(breakpoint);
        }
    }

    fn toggle_bookmark(&mut self) {
        match self.bookmarks.iter().position(|b| b.step == self.step) {
            Some(i) => {
                self.bookmarks.remove(i);
            }
            None => {
                let at = self.bookmarks.partition_point(|b| b.step < self.step);
                self.bookmarks
                    .insert(at, Bookmark { step: self.step, note: String::new(), observer: self.observer });
            }
        }
    }

    /// Moves a playing film on by some seconds; returns whether it still plays.
    pub fn tick(&mut self, seconds: f32) -> bool {
        if !self.is_playing || self.is_empty() {
            return false;
        }
        self.pending += seconds.clamp(0.0, 1.0) * self.speed;
        let whole = self.pending as usize;
        self.pending -= whole as f32;
        let Some(Reading { reel, moves, .. }) = self.film() else { return false };
        let mut step = self.step;
        for _ in 0..whole {
            let next = moves.forward(reel.events(), step, self.detail);
            let stop = (step..next).find(|&i| self.stops_at(i));
            step = stop.map_or(next, |i| i + 1);
            if stop.is_some() || step == reel.events().len() {
                self.is_playing = false;
                break;
            }
        }
        if whole > 0 {
            self.go_to(step);
        }
        self.is_playing
    }
}
