//! Starting with what the command line names or what was open last, and saving it.

use std::collections::BTreeSet;
use std::path::Path;

use super::any::ViewRecord;
use super::camera::ObserverCamera;
use super::command::{Action, Command};
use super::findings::Laboratory;
use super::measured::{Tables, tables};
use super::open::{Wanted, file_name, named_from};
use super::plate::word;
use super::session::{Picked, Session, Shown as Kept, Stop, VERSION};
use super::shown::{Breakpoint, Detail, Dialog, Layout, LookIn, Shown, Surface, Theme};
use super::start::Start;
use super::state::{Notice, State};
use crate::drawing::Subject;
use crate::geometry::{NodeId, ObjectId, PrimId, each};
use crate::method::Settings;
use crate::raster::DepthScale;
use crate::trace::Counts;

impl State {
    /// What is open, as a session that is kept in a file (or, without one, wherever the explorer likes): the
    /// scene is named as it is found from there.
    pub fn session_in(&self, file: Option<&str>) -> Session {
        let mut session = self.session();
        let folder = file.map(|f| Path::new(f).parent().unwrap_or(Path::new("")));
        session.scene = named_from(&session.scene, folder);
        session
    }

    /// What is open, as a session.
    pub fn session(&self) -> Session {
        let stage = self.staged();
        let path = stage.and_then(|s| s.brought_path());
        let s = &self.shown;
        Session {
            cullscope_session: VERSION,
            scene: stage.map_or(String::new(), |s| s.scene().source().to_owned()),
            scene_hash: stage.map_or(String::new(), |s| s.scene().hash_hex()),
            method: self.method.clone(),
            settings: self.settings.0.clone(),
            place: match (&path, stage.map_or((0, 0), |s| s.place())) {
                (Some(_), (_, frame)) => (0, frame),
                (None, place) => place,
            },
            path,
            eye: self.stage.as_ref().map(|s| ViewRecord::from(&s.view())),
            step: self.step,
            coarse: self.detail == Detail::Coarse,
            selected: picked(self.selection),
            observer: Some(self.observer),
            bookmarks: self.bookmarks.clone(),
            breakpoints: self.breakpoints.iter().filter_map(|b| self.stop(*b)).collect(),
            filter: self.filter.clone(),
            unshown: self.unshown().into_iter().map(|object| object.0).collect(),
            shown: Kept {
                prims: s.prims,
                nodes: s.nodes,
                eye: s.eye,
                evidence: s.evidence,
                surface: s.surface.name().into(),
                look_in: s.look_in.name().into(),
                theme: s.theme.name().into(),
                layout: s.layout.name().into(),
                scale: s.scale,
                picture: self.own_word(self.own_picture),
                depths: self.depths.name().into(),
            },
            figure: None,
        }
    }

    /// The word of a picture of the method; of the first one nothing.
    pub(super) fn own_word(&self, which: usize) -> String {
        let names = self.film().map_or(&[][..], |f| f.reel.pictures());
        names.get(which).filter(|_| which > 0).map_or_else(String::new, |n| word(n))
    }

    pub(super) fn save(&mut self, path: &str) {
        match self.session_in(Some(path)).write(path) {
            Ok(()) => {
                self.session_path = Some(path.to_owned());
                self.dialog = Dialog::None;
                self.tell(format!("Saved as {path}."));
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Opens the scene of a session, which was read from a file or is the last one that the explorer kept;
    /// the rest follows when it is loaded.
    pub fn restore(&mut self, session: Session, file: Option<&str>) {
        self.recall_look(&session);
        if session.scene.is_empty() {
            return;
        }
        let folder = Path::new(file.unwrap_or_default()).parent().unwrap_or(Path::new("")).to_owned();
        let wanted = Wanted { source: session.scene.clone(), hash_hex: session.scene_hash.clone(), folder };
        self.recall = Some(session);
        self.load(wanted, None);
    }

    /// A breakpoint as a file keeps it; `None` of a line that this method has not.
    fn stop(&self, breakpoint: Breakpoint) -> Option<Stop> {
        Some(match breakpoint {
            Breakpoint::Line(line) => {
                Stop::Line(self.film()?.reel.card().code.get(usize::from(line))?.label.into())
            }
            Breakpoint::Verdict(verdict) => Stop::Verdict(verdict.name().into()),
            Breakpoint::Node(n) => Stop::Node(n.0),
            Breakpoint::Prim(p) => Stop::Prim(p.0),
            Breakpoint::Object(o) => Stop::Object(o.0),
        })
    }

    /// The breakpoint that a file names, if this film has it.
    fn breakpoint(&self, stop: &Stop) -> Option<Breakpoint> {
        let film = self.film()?;
        let scene = self.staged()?.scene();
        match stop {
            Stop::Line(label) => {
                let line = film.reel.card().code.iter().position(|l| l.label == *label)?;
                Some(Breakpoint::Line(line as u8))
            }
            Stop::Verdict(name) => {
                Counts::VERDICTS.into_iter().find(|v| v.name() == *name).map(Breakpoint::Verdict)
            }
            Stop::Node(n) => Some(NodeId(*n)).filter(|n| n.at() < film.node_count()).map(Breakpoint::Node),
            Stop::Prim(p) => Some(PrimId(*p)).filter(|p| scene.has_prim(*p)).map(Breakpoint::Prim),
            Stop::Object(o) => {
                Some(ObjectId(*o)).filter(|o| o.at() < scene.object_count()).map(Breakpoint::Object)
            }
        }
    }

    fn recall_look(&mut self, session: &Session) {
        let kept = &session.shown;
        let scale = DepthScale::ALL.into_iter().find(|s| s.name() == kept.depths);
        self.depths = scale.unwrap_or_default();
        let named = Shown::default();
        self.shown = Shown {
            prims: kept.prims,
            nodes: kept.nodes,
            eye: kept.eye,
            evidence: kept.evidence,
            surface: Surface::ALL.into_iter().find(|s| s.name() == kept.surface).unwrap_or(named.surface),
            look_in: LookIn::ALL.into_iter().find(|l| l.name() == kept.look_in).unwrap_or(named.look_in),
            theme: Theme::ALL.into_iter().find(|t| t.name() == kept.theme).unwrap_or(named.theme),
            layout: Layout::ALL.into_iter().find(|l| l.name() == kept.layout).unwrap_or(named.layout),
            scale: if kept.scale.is_finite() { kept.scale.clamp(0.5, 4.0) } else { 1.0 },
        };
    }

    /// The number of the method's picture with this word.
    pub(super) fn own_named(&self, wanted: &str) -> Option<usize> {
        self.film()?.reel.pictures().iter().position(|name| word(name) == word(wanted))
    }

    /// What culling depends on, before the film is recorded.
    pub(super) fn recall_inputs(&mut self, session: &Session) {
        let Some(stage) = &mut self.stage else { return };
        let scene = stage.get().scene();
        let text = if !session.scene_hash.is_empty() && session.scene_hash != scene.hash_hex() {
            format!("{} is not the scene that was saved: its content has changed.", scene.source())
        } else if file_name(scene.source()) != file_name(&session.scene) {
            format!("The saved scene was found by its content: it is {} now.", scene.source())
        } else {
            String::new()
        };
        self.notices.extend((!text.is_empty()).then_some(Notice { is_error: false, text }));
        let methods = stage.get().methods();
        if methods.iter().any(|m| m.key == session.method) {
            self.method = session.method.clone();
            self.settings = Settings(session.settings.clone());
        }
        if let Some(Err(why)) = session.path.as_ref().map(|text| each!(stage, s => s.bring(text))) {
            self.notices.push(Notice { is_error: true, text: why.to_string() });
        }
        stage.go(session.place.0, session.place.1);
        if let Some(view) = session.eye.as_ref().and_then(|v| v.any()) {
            stage.set_view(&view);
        }
    }

    /// What refers to the film, once it is there.
    pub(super) fn recall_rest(&mut self, session: &Session) {
        let Some(stage) = self.staged() else { return };
        let (objects, nodes) = (stage.scene().object_count(), stage.film().map_or(0, |f| f.node_count()));
        self.selection = match session.selected {
            Picked::Prim(p) if stage.scene().has_prim(PrimId(p)) => Subject::Prim(PrimId(p)),
            Picked::Node(n) if (n as usize) < nodes => Subject::Node(NodeId(n)),
            Picked::Object(o) if (o as usize) < stage.scene().object_count() => Subject::Object(ObjectId(o)),
            Picked::Eye => Subject::Eye,
            _ => Subject::None,
        };
        self.own_picture = self.own_named(&session.shown.picture).unwrap_or_default();
        self.detail = if session.coarse { Detail::Coarse } else { Detail::Full };
        self.filter = session.filter.clone();
        let unshown = session.unshown.iter().map(|&id| ObjectId(id)).filter(|id| id.at() < objects);
        self.show_without(unshown.collect());
        let end = self.len();
        self.bookmarks =
            session.bookmarks.iter().filter(|b| b.step <= end && b.observer.is_sound()).cloned().collect();
        self.bookmarks.sort_by_key(|b| b.step);
        self.breakpoints = session.breakpoints.iter().filter_map(|stop| self.breakpoint(stop)).collect();
        if self.breakpoints.len() < session.breakpoints.len() {
            self.tell("Some breakpoints of the session fit nothing in this film and are left out.");
        }
        if let Some(observer) = session.observer.filter(|o| o.is_sound()) {
            self.observer = observer;
            self.is_to_frame = false;
        }
        self.step = session.step.min(end);
        // A figure opened is the figure that is written again.
        match session.figure.as_ref().map(|made| self.export_like(made)) {
            Some(Ok(export)) => self.exporting = export,
            Some(Err(why)) => self.tell(format!("How the figure was made is not known: {why}.")),
            None => {}
        }
    }

    /// Starts with what the command line names, or else with what was open last, or else with nothing.
    pub fn start(&mut self, start: &Start, last: Option<Session>) {
        let last = last.filter(|_| !start.fresh);
        if let Some(key) = &start.method {
            self.method = key.clone();
        }
        self.settings = start.settings.clone();
        self.commands = start.commands.clone();
        match (&start.session, &start.scene, last) {
            (Some(path), _, _) => self.open(path, None),
            (None, Some(source), last) => {
                if let Some(last) = &last {
                    self.recall_look(last);
                }
                self.open(source, start.view.clone());
            }
            (None, None, Some(last)) => self.restore(last, None),
            (None, None, None) => {}
        }
        if self.stage.is_none() && self.busy().is_none() {
            self.run_commands();
        }
    }

    /// Runs the commands that the explorer was started with, up to one that makes it wait.
    pub(super) fn run_commands(&mut self) {
        while !self.commands.is_empty() && self.busy().is_none() {
            let text = self.commands.remove(0);
            match spoken_command(&text) {
                Some(command) => self.apply(command),
                None => self.fail(format!("`{text}` is not a command")),
            }
        }
    }
}

/// A command by its name, `step` or `go-to:12`.
pub(super) fn spoken_command(text: &str) -> Option<Command> {
    if let Some(action) = Action::named(text) {
        return Some(action.into());
    }
    let (word, value) = text.split_once(':')?;
    let number = || value.parse::<u32>().ok();
    Some(match word {
        "go-to" => Command::GoTo(number()? as usize),
        // A view of the first path, or `PATH:VIEW`.
        "frame" => match value.split_once(':') {
            Some((path, view)) => Command::Frame(path.parse().ok()?, view.parse().ok()?),
            None => Command::Frame(0, number()? as usize),
        },
        "method" => Command::Method(value.to_owned()),
        "filter" => Command::Filter(value.to_owned()),
        "paper-table" => Command::Tables(Tables::Measure(tables().map(|t| t.0).find(|name| *name == value)?)),
        "laboratory" => Command::Laboratory(match value.split_once('=') {
            Some(("advise", percent)) => Laboratory::Advise(percent.parse().ok()?),
            Some(("open", number)) => Laboratory::Open(number.parse().ok()?),
            Some(("stand", number)) => Laboratory::Stand(number.parse().ok()?),
            Some(("flip", number)) => Laboratory::Flip(number.parse().ok()?),
            Some(_) => return None,
            None if value == "measure" => Laboratory::Measure,
            None if value == "use" => Laboratory::Use,
            None if value == "map" => Laboratory::Map,
            None => return None,
        }),
        "pixel" => {
            let (x, y) = value.split_once(',')?;
            Command::Pixel(Some([x.parse().ok()?, y.parse().ok()?]))
        }
        "scale" => Command::Scale(value.parse().ok()?),
        "set" => {
            let (name, value) = value.split_once('=')?;
            Command::Set(name.to_owned(), value.to_owned(), 0)
        }
        "select" => match value.split_once(':')? {
            ("node", n) => Command::Select(Subject::Node(NodeId(n.parse().ok()?))),
            ("prim", n) => Command::Select(Subject::Prim(PrimId(n.parse().ok()?))),
            ("object", n) => Command::Select(Subject::Object(ObjectId(n.parse().ok()?))),
            _ => return None,
        },
        "hide" => Command::ShowWithout(spoken_numbers(value)?.into_iter().map(ObjectId).collect()),
        "observe" => Command::Observe(ObserverCamera::parse(value)?),
        "picture" => Command::Picture(value.to_owned()),
        "depths" => Command::Depths(DepthScale::ALL.into_iter().find(|s| s.name() == value)?),
        _ => return None,
    })
}

/// Numbers and ranges of them, such as `1,4-9`, as `hide` takes them.
fn spoken_numbers(text: &str) -> Option<BTreeSet<u32>> {
    let mut all = BTreeSet::new();
    for part in text.split(',') {
        let (from, to) = part.split_once('-').unwrap_or((part, part));
        let (from, to) = (from.parse::<u32>().ok()?, to.parse::<u32>().ok()?);
        all.extend((from <= to && to - from < MOST_HIDDEN).then_some(from..=to)?);
    }
    Some(all)
}

/// The same in words.
pub(super) fn numbers_spoken(numbers: impl IntoIterator<Item = u32>) -> String {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for n in numbers {
        match ranges.last_mut() {
            Some((_, to)) if *to + 1 == n => *to = n,
            _ => ranges.push((n, n)),
        }
    }
    let word = |(from, to): &(u32, u32)| if from == to { format!("{from}") } else { format!("{from}-{to}") };
    ranges.iter().map(word).collect::<Vec<_>>().join(",")
}

/// Numbers in a range of `hide`, at most.
const MOST_HIDDEN: u32 = 1 << 24;

/// A thing as `select` takes it.
pub(super) fn spoken_subject(subject: Subject) -> Option<String> {
    match subject {
        Subject::Prim(p) => Some(format!("prim:{p}")),
        Subject::Node(n) => Some(format!("node:{n}")),
        Subject::Object(o) => Some(format!("object:{o}")),
        _ => None,
    }
}

fn picked(subject: Subject) -> Picked {
    match subject {
        Subject::Prim(p) => Picked::Prim(p.0),
        Subject::Node(n) => Picked::Node(n.0),
        Subject::Object(o) => Picked::Object(o.0),
        Subject::Eye => Picked::Eye,
        _ => Picked::None,
    }
}
