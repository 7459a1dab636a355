//! Everything that the explorer knows.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use super::any::AnyStage;
use super::camera::ObserverCamera;
use super::findings::Findings;
use super::making::Making;
use super::measured::Measured;
use super::objects::Listing;
use super::outline::Outline;
use super::pixel::PixelHistory;
use super::plate::Export;
use super::session::{Bookmark, Session};
use super::shown::{Breakpoint, Detail, Dialog, Shown};
use super::stage::{Reading, Staged};
use super::undo::History;
use super::why::Why;
use super::worker::{Busy, FILM_CAP_EVENTS, Worker};
use crate::culling::DEFAULT_METHOD;
use crate::drawing::Subject;
use crate::figure::Look;
use crate::method::{Event, Settings};
use crate::raster::DepthScale;
use crate::render::Format;

/// Something that the person should read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Whether something failed.
    pub is_error: bool,
    /// One or two sentences.
    pub text: String,
}

/// What only the window can do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Write the picture on screen as `svg`, `pdf` or `png`.
    Export(Format),
    /// Put text on the clipboard.
    Copy(String),
    /// Fill the screen, or not.
    FullScreen,
    /// Put every panel back.
    ResetLayout,
    /// Bring the history of the pixel to the front.
    ShowPixel,
    /// Put the cursor into the filter.
    FocusFilter,
    /// Close.
    Quit,
}

/// Everything that the explorer knows.
pub struct State {
    /// The scene on stage, if there is one.
    pub stage: Option<AnyStage>,
    /// Key of the wanted method.
    pub method: String,
    /// Wanted parameters that differ from their defaults.
    pub settings: Settings,
    /// The step: 0 is before the first event.
    pub step: usize,
    /// How fine steps are.
    pub detail: Detail,
    /// Whether the film plays.
    pub is_playing: bool,
    /// Whether the Eye goes along its path.
    pub is_path_playing: bool,
    /// Events a second.
    pub speed: f32,
    /// What is selected.
    pub selection: Subject,
    pub(super) selected_before: Vec<Subject>,
    pub(super) selected_after: Vec<Subject>,
    /// Where runs stop.
    pub breakpoints: BTreeSet<Breakpoint>,
    /// Steps to come back to, by step.
    pub bookmarks: Vec<Bookmark>,
    /// Where the person looks from.
    pub observer: ObserverCamera,
    /// Whether the Observer's picture is to bring the selection, or everything, into sight when it is next
    /// shown: it alone knows its shape. It answers with where the Observer stands then.
    pub is_to_frame: bool,
    /// Whether the Eye view stands where the Observer view was.
    pub is_swapped: bool,
    /// Whether the Eye cannot be moved.
    pub is_eye_locked: bool,
    /// What is shown and how.
    pub shown: Shown,
    /// How figures of the window are made.
    pub exporting: Export,
    /// The figure that is being made, and its path.
    pub(super) making: Option<(Making, String)>,
    /// Which picture of the method is shown.
    pub own_picture: usize,
    /// How depths are shaded in it.
    pub depths: DepthScale,
    /// The dialog in front of everything else.
    pub dialog: Dialog,
    /// Filter of the event tree.
    pub filter: String,
    /// Rows of the event tree.
    pub outline: Outline,
    /// Why the selected thing ends as it does.
    pub why: Why,
    /// Which objects are listed.
    pub listing: Listing,
    /// The pixel that is looked into.
    pub pixel: PixelHistory,
    /// The table that was measured last.
    pub measured: Option<Arc<Measured>>,
    /// What was found in the laboratory.
    pub findings: Findings,
    /// Messages, the newest last.
    pub notices: Vec<Notice>,
    /// What the window has to do.
    pub effects: Vec<Effect>,
    /// Whether something changed since the session was saved.
    pub is_dirty: bool,
    /// The session file.
    pub session_path: Option<String>,
    /// Where files go whose names the explorer makes; empty for the working folder.
    pub folder: PathBuf,
    pub(super) history: History,
    pub(super) worker: Worker,
    /// The session that is being opened, until its scene and film are there.
    pub(super) recall: Option<Session>,
    /// Events that a film keeps.
    pub(super) film_cap: usize,
    /// Events that playing has yet to show, less than one after each tick.
    pub(super) pending: f32,
    /// Views that playing the path has yet to show, less than one after each.
    pub(super) pending_views: f32,
    /// Number of the scene that was put on stage last.
    pub(super) serial: u64,
    /// Commands of the start that are still to run.
    pub(super) commands: Vec<String>,
}

impl Default for State {
    fn default() -> Self {
        Self::new()
    }
}

impl State {
    /// Nothing open, and the default method.
    pub fn new() -> Self {
        Self {
            stage: None,
            method: DEFAULT_METHOD.into(),
            settings: Settings::default(),
            step: 0,
            detail: Detail::Full,
            is_playing: false,
            is_path_playing: false,
            speed: 10.0,
            selection: Subject::None,
            selected_before: vec![],
            selected_after: vec![],
            breakpoints: BTreeSet::new(),
            bookmarks: vec![],
            observer: ObserverCamera::default(),
            is_to_frame: false,
            is_swapped: false,
            is_eye_locked: false,
            shown: Shown::default(),
            exporting: Export::default(),
            making: None,
            own_picture: 0,
            depths: DepthScale::default(),
            dialog: Dialog::None,
            filter: String::new(),
            outline: Outline::default(),
            why: Why::default(),
            listing: Listing::default(),
            pixel: PixelHistory::default(),
            measured: None,
            findings: Findings::default(),
            notices: vec![],
            effects: vec![],
            is_dirty: false,
            session_path: None,
            folder: PathBuf::new(),
            history: History::default(),
            worker: Worker::start(),
            recall: None,
            film_cap: FILM_CAP_EVENTS,
            pending: 0.0,
            pending_views: 0.0,
            serial: 0,
            commands: vec![],
        }
    }
    /// The stage as panels see it that do not care about the space.
    pub fn staged(&self) -> Option<&dyn Staged> {
        self.stage.as_ref().map(|s| s.get())
    }
    /// The recorded film, once there is one.
    pub fn film(&self) -> Option<Reading<'_>> {
        self.staged()?.film()
    }
    /// Events of the film; none before it is recorded.
    pub fn events(&self) -> &[Event] {
        self.film().map_or(&[], |f| f.reel.events())
    }
    /// Number of events of the film.
    pub fn len(&self) -> usize {
        self.events().len()
    }
    /// Whether there is nothing to step through.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The event that happened last, if one did.
    pub fn current(&self) -> Option<usize> {
        self.step.checked_sub(1).filter(|&i| i < self.len())
    }
    /// What is being waited for.
    pub fn busy(&self) -> Option<Busy> {
        let making = || {
            let (making, path) = self.making.as_ref()?;
            Some(Busy { what: format!("making {path}"), fraction: making.fraction() })
        };
        self.worker.busy().or_else(making)
    }
    /// Called from the worker thread whenever there is something new to show.
    pub fn set_wake(&self, wake: impl Fn() + Send + Sync + 'static) {
        self.worker.set_wake(wake);
    }
    /// What happened last, in one sentence, and at the end what came of it: the status line, the caption, and
    /// what screen readers say.
    pub fn sentence(&self) -> String {
        let Some(stage) = self.staged() else { return "Nothing is open.".into() };
        match (stage.film(), self.current()) {
            (None, _) => format!("{} is open; nothing is recorded yet.", stage.scene().name()),
            (Some(_), None) => "Before the first event: nothing is decided yet.".into(),
            (Some(film), Some(at)) => {
                let end = self.result().filter(|_| self.step == self.len());
                let sentence = film.reel.sentence(at);
                let stop = if sentence.ends_with('.') { "" } else { "." };
                let end = end.map(|result| format!("{stop} The end: {result}")).unwrap_or_default();
                sentence + &end
            }
        }
    }
    /// The line of pseudocode at this step.
    pub fn line(&self) -> Option<u8> {
        let film = self.film()?;
        film.moves.line(film.reel.events(), self.step)
    }
    /// What the current event is about; nothing if it is about no single thing.
    pub fn current_subject(&self) -> Subject {
        let (Some(film), Some(at)) = (self.film(), self.current()) else { return Subject::None };
        film.reel.subject(at)
    }
    /// What is on screen in a picture of this state.
    pub fn look(&self) -> Look {
        let s = &self.shown;
        Look {
            prims: s.prims,
            nodes: s.nodes,
            eye: s.eye,
            evidence: s.evidence,
            selected: self.selection,
            current: self.current_subject(),
        }
    }
    /// Shows the person a message.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.notice(false, text.into());
    }
    /// Shows the person what failed.
    pub fn fail(&mut self, text: impl Into<String>) {
        self.notice(true, text.into());
    }
    fn notice(&mut self, is_error: bool, text: String) {
        let notice = Notice { is_error, text };
        self.notices.retain(|n| *n != notice);
        self.notices.push(notice);
        // Only the newest are worth the room.
        let extra = self.notices.len().saturating_sub(4);
        self.notices.drain(..extra);
    }
    /// The path of a file whose name the explorer makes.
    pub(super) fn path_of(&self, name: &str) -> String {
        self.folder.join(name).to_string_lossy().into_owned()
    }
    /// Whether there is anything to undo, and to redo.
    pub fn can_undo(&self) -> (bool, bool) {
        self.history.can()
    }
}
