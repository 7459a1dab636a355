//! Moving through the film: stepping, running to breakpoints, playing.

use super::command::Action;
use super::concern::Concern;
use super::session::Bookmark;
use super::shown::{Breakpoint, Dialog, Gesture};
use super::stage::Reading;
use super::state::State;
use crate::drawing::Subject;
use crate::method::Event;
use crate::trace::{Detail, Moves};

/// Views a second of a path that plays.
const VIEWS_PER_SECOND: f32 = 12.0;
/// All views that playing a path comes to are one step of undo.
const PATH_GESTURE: Gesture = Gesture::MAX - 1;

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
                let concern = Concern::of(self.film()?, self.staged()?.scene(), wanted);
                self.seek(forward, |i| concern.holds(i))
            }
            Action::Run => self.seek(true, self.stops()),
            Action::RunBack => self.seek(false, self.stops()),
            Action::First => Some(0),
            Action::Last => Some(events.len()),
            Action::PresentNext => moves.next(events, step, Moves::is_verdict),
            Action::PresentPrevious => moves.previous(events, step, Moves::is_verdict),
            _ => None,
        }
    }

    /// Why an action leads nowhere.
    fn no_target(&self, action: Action) -> String {
        match action {
            Action::Run | Action::RunBack if self.breakpoints.is_empty() => {
                "There is no breakpoint. F9 sets one at the selected thing or at this line.".into()
            }
            Action::Run => "No breakpoint stops a run after this step.".into(),
            Action::RunBack => "No breakpoint stops a run before this step.".into(),
            _ => format!("{}: there is none.", action.info().title),
        }
    }

    /// Whether this film ever comes to a line of pseudocode.
    pub fn reaches(&self, line: u8) -> bool {
        self.events().contains(&Event::Line(line))
    }

    /// Goes to a bookmark, and looks from where the person looked then.
    pub(super) fn go_bookmark(&mut self, nth: usize) {
        let Some(mark) = self.bookmarks.get(nth) else {
            return self.tell(format!("There is no bookmark {}.", nth + 1));
        };
        let (step, observer) = (mark.step, mark.observer);
        self.is_playing = false;
        self.observer = observer;
        self.is_to_frame = false;
        self.go_to(step);
    }

    /// The nearest step, forward or back, whose event `wanted` accepts.
    fn seek(&self, forward: bool, wanted: impl Fn(usize) -> bool) -> Option<usize> {
        if forward {
            (self.step..self.len()).find(|&i| wanted(i)).map(|i| i + 1)
        } else {
            (0..self.step.saturating_sub(1)).rev().find(|&i| wanted(i)).map(|i| i + 1)
        }
    }

    /// Whether a breakpoint stops at an event: what depends on the things that they are at is looked up once.
    pub fn stops(&self) -> impl Fn(usize) -> bool + '_ {
        let at_thing = |b: &Breakpoint| match b {
            Breakpoint::Node(node) => Some(Subject::Node(*node)),
            Breakpoint::Prim(prim) => Some(Subject::Prim(*prim)),
            Breakpoint::Object(object) => Some(Subject::Object(*object)),
            Breakpoint::Line(_) | Breakpoint::Verdict(_) => None,
        };
        let concern = |thing| Some(Concern::of(self.film()?, self.staged()?.scene(), thing));
        let things: Vec<Concern<'_>> =
            self.breakpoints.iter().filter_map(at_thing).filter_map(concern).collect();
        let events = self.events();
        move |at| {
            let named = match events[at] {
                Event::Line(line) => self.breakpoints.contains(&Breakpoint::Line(line)),
                event => event.verdict().is_some_and(|v| self.breakpoints.contains(&Breakpoint::Verdict(v))),
            };
            named || things.iter().any(|t| t.holds(at))
        }
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
            Action::PlayPath => {
                self.is_path_playing = !self.is_path_playing;
                self.pending_views = 0.0;
                // Before the first event there is nothing to see of any film.
                if self.is_path_playing && self.step == 0 {
                    self.go_to(self.len());
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
                self.go_frame(path, next, 0);
            }
            _ if (Action::Bookmark1..=Action::Bookmark10).contains(&action) => {
                self.go_bookmark(action as usize - Action::Bookmark1 as usize);
            }
            Action::PresentNext | Action::PresentPrevious if !self.bookmarks.is_empty() => {
                let (step, mut marks) = (self.step, self.bookmarks.iter());
                let slide = match action {
                    Action::PresentNext => marks.position(|b| b.step > step),
                    _ => marks.rposition(|b| b.step < step),
                };
                match slide {
                    Some(i) => self.go_bookmark(i),
                    None => self.tell(format!("{}: there is none.", action.info().title)),
                }
            }
            Action::FirstWrong => {
                self.is_playing = false;
                self.go_first_wrong();
            }
            Action::NextLayer | Action::PreviousLayer => {
                self.is_playing = false;
                self.go_layer(action);
            }
            _ if action.info().menu == super::command::Menu::Step => {
                self.is_playing = false;
                match self.target_of(action) {
                    Some(step) => self.go_to(step),
                    None => self.tell(self.no_target(action)),
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
            (Subject::Object(object), _) => Breakpoint::Object(object),
            (_, Some(line)) => Breakpoint::Line(line),
            _ => {
                return self.tell(
                    "Select a node, a primitive or an object, or step to a line, to set a breakpoint.",
                );
            }
        };
        self.flip(breakpoint);
    }

    pub(super) fn flip(&mut self, breakpoint: Breakpoint) {
        if self.breakpoints.remove(&breakpoint) {
            return;
        }
        self.breakpoints.insert(breakpoint);
        if let (Breakpoint::Line(line), Some(film)) = (breakpoint, self.film())
            && !self.reaches(line)
            && let Some(line) = film.reel.card().code.get(usize::from(line))
        {
            self.tell(format!("This frame never comes to {}: no run will stop there.", line.label));
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

    /// Moves what plays on by some seconds, the film and the path; returns whether something still plays.
    pub fn tick(&mut self, seconds: f32) -> bool {
        let goes_on = self.tick_path(seconds);
        self.tick_film(seconds) || goes_on
    }

    /// Views of the path that is followed; 0 if nothing is open.
    pub(super) fn path_length(&self) -> usize {
        self.staged().map_or(0, |s| s.paths()[s.place().0].1)
    }

    fn tick_path(&mut self, seconds: f32) -> bool {
        self.is_path_playing &= self.path_length() > 1;
        let Some((path, frame)) = self.staged().map(|s| s.place()).filter(|_| self.is_path_playing) else {
            return false;
        };
        self.pending_views = (self.pending_views + seconds.max(0.0) * VIEWS_PER_SECOND).min(1.0);
        // A view stays until its film is there, so that each is seen.
        if self.pending_views >= 1.0 && self.busy().is_none() {
            self.pending_views = 0.0;
            self.go_frame(path, (frame + 1) % self.path_length(), PATH_GESTURE);
            self.refresh();
        }
        true
    }

    fn tick_film(&mut self, seconds: f32) -> bool {
        if !self.is_playing || self.is_empty() {
            return false;
        }
        self.pending += seconds.clamp(0.0, 1.0) * self.speed;
        let whole = self.pending as usize;
        self.pending -= whole as f32;
        let Some(Reading { reel, moves, .. }) = self.film() else { return false };
        let (mut step, stops) = (self.step, self.stops());
        let mut goes_on = true;
        for _ in 0..whole {
            let next = moves.forward(reel.events(), step, self.detail);
            let stop = (step..next).find(|&i| stops(i));
            step = stop.map_or(next, |i| i + 1);
            goes_on = stop.is_none() && step < reel.events().len();
            if !goes_on {
                break;
            }
        }
        drop(stops);
        self.is_playing = goes_on;
        if whole > 0 {
            self.go_to(step);
        }
        self.is_playing
    }
}
