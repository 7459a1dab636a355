//! The only way that anything changes.

use super::any::{AnyStage, AnyView};
use super::camera::ObserverCamera;
use super::command::{Action, Command};
use super::open::{AnyOpened, Wanted};
use super::session::{Session, write_file};
use super::shown::{Breakpoint, Dialog, Gesture, Layout, LookIn, Surface, Theme};
use super::stage::{Flight, Stage};
use super::state::{Effect, State};
use super::undo::Inputs;
use super::why::Why;
use super::worker::{Done, Job, Request};
use crate::culling::DEFAULT_METHOD;
use crate::drawing::Subject;
use crate::geometry::{Either, each};
use crate::render::Format;

/// Selections that are remembered.
const SELECTIONS: usize = 200;

impl State {
    /// Carries out a command.
    pub fn apply(&mut self, command: impl Into<Command>) {
        let command = command.into();
        // A figure that is being made is of what was there when it began.
        if self.making.is_some() && command != Command::Do(Action::Cancel) {
            return;
        }
        match command {
            Command::Do(action) => self.act(action),
            Command::Open(source) => self.open(&source, None),
            Command::GoTo(step) => self.jump_to(step),
            Command::Select(subject) => self.select(subject),
            Command::Method(key) => self.change(0, |s| {
                s.settings.0.clear();
                s.method = key;
            }),
            Command::Set(name, value, gesture) => {
                self.change(gesture, |s| drop(s.settings.0.insert(name, value)));
            }
            Command::Eye(view, gesture) => self.move_eye(&view, gesture),
            Command::Frame(path, frame) => self.go_frame(path, frame, 0),
            Command::Observe(camera) => self.observe(camera),
            Command::List(listing) => self.listing = listing,
            Command::FlipShown(object) => self.flip_shown(object),
            Command::ShowWithout(objects) => self.show_without(objects),
            Command::Pixel(at) => self.look_into(at),
            Command::Filter(text) => self.filter = text,
            Command::Fold(at) => self.outline.toggle(at),
            Command::Detail(detail) => self.detail = detail,
            Command::Speed(speed) => self.speed = speed.clamp(0.25, 1e6),
            Command::Dialog(dialog) => self.dialog = dialog,
            Command::BreakLine(line) => self.flip(Breakpoint::Line(line)),
            Command::BreakVerdict(verdict) => self.flip(Breakpoint::Verdict(verdict)),
            Command::BreakNode(node) => self.flip(Breakpoint::Node(node)),
            Command::Note(i, text) => self.write_note(i, text),
            Command::Bookmark(i) => self.go_bookmark(i),
            Command::Unmark(i) => self.unmark(i),
            look @ (Command::Picture(_)
            | Command::Depths(_)
            | Command::Surface(_)
            | Command::LookIn(_)
            | Command::Layout(_)
            | Command::Scale(_)) => self.set_look(&look),
            Command::SaveTo(path) => self.save(&path),
            Command::Figures(export) => self.exporting = *export,
            Command::WriteFigure(export, path) => self.export_to(&export, &self.path_of(&path)),
            Command::Tables(asked) => self.tables(asked),
            Command::Laboratory(asked) => self.laboratory(asked),
            Command::Dismiss(i) => self.dismiss(i),
        }
        self.is_dirty = true;
        self.refresh();
    }

    /// Carries out a command about how things are shown.
    fn set_look(&mut self, command: &Command) {
        match command {
            Command::Picture(name) => self.show_picture(name),
            Command::Depths(scale) => self.depths = *scale,
            Command::Surface(surface) => self.shown.surface = *surface,
            Command::LookIn(way) => self.shown.look_in = *way,
            Command::Layout(layout) => self.set_layout(*layout),
            Command::Scale(scale) => self.shown.scale = scale.clamp(0.5, 4.0),
            _ => {}
        }
    }

    fn jump_to(&mut self, step: usize) {
        self.is_playing = false;
        self.go_to(step);
    }

    fn observe(&mut self, camera: ObserverCamera) {
        if camera.is_sound() {
            self.observer = camera;
            self.is_to_frame = false;
        }
    }

    fn write_note(&mut self, bookmark: usize, text: String) {
        if let Some(mark) = self.bookmarks.get_mut(bookmark) {
            mark.note = text;
        }
    }

    fn dismiss(&mut self, notice: usize) {
        if notice < self.notices.len() {
            self.notices.remove(notice);
        }
    }

    fn unmark(&mut self, bookmark: usize) {
        if bookmark < self.bookmarks.len() {
            self.bookmarks.remove(bookmark);
        }
    }

    fn look_into(&mut self, pixel: Option<[u32; 2]>) {
        self.pixel.look_at(pixel);
        self.effects.extend(pixel.map(|_| Effect::ShowPixel));
    }

    fn show_picture(&mut self, name: &str) {
        match self.own_named(name) {
            Some(which) => self.own_picture = which,
            None => self.fail(format!("The method has no picture `{name}`.")),
        }
    }

    fn move_eye(&mut self, view: &AnyView, gesture: Gesture) {
        if self.is_eye_locked {
            return self.tell("The Eye is locked; press L to unlock it.");
        }
        self.change(gesture, |s| {
            let moved = s.stage.as_mut().is_some_and(|stage| stage.move_eye(view));
            if !moved {
                s.tell("The Eye cannot look from there.");
            }
        });
    }

    /// Updates what is derived from the rest: the rows of the event tree, and why the selected thing ends as
    /// it does.
    pub(super) fn refresh(&mut self) {
        let stage = self.stage.as_ref().map(|s| s.get());
        if let Some(stage) = stage {
            self.outline.refresh(stage, self.detail, &self.filter);
        }
        self.pixel.refresh(stage);
        if !self.why.is_of(stage, self.selection) {
            self.why = stage.map_or_else(Why::default, |stage| Why::of(stage, self.selection));
        }
    }

    /// Whether an action can be done now.
    pub fn can(&self, action: Action) -> bool {
        use super::command::Menu;
        let open = self.stage.is_some();
        match action {
            Action::Undo => self.can_undo().0,
            Action::Redo => self.can_undo().1,
            Action::SelectBack => !self.selected_before.is_empty(),
            Action::SelectForward => !self.selected_after.is_empty(),
            Action::Why
            | Action::SelectNone
            | Action::NextOnSelected
            | Action::PreviousOnSelected
            | Action::RunToCursor
            | Action::BackToCursor => self.selection != Subject::None,
            Action::HideObject | Action::IsolateObject => self.selected_object().is_some(),
            Action::ShowObjects => !self.unshown().is_empty(),
            Action::SelectParent => matches!(self.selection, Subject::Node(_) | Subject::Prim(_)),
            Action::SelectCurrent => self.current_subject() != Subject::None,
            Action::EyeHome => self.staged().is_some_and(|s| s.is_eye_moved()),
            Action::EyeHere => matches!(self.stage, Some(Either::Solid(_))) && !self.is_eye_locked,
            Action::Cancel => {
                self.busy().is_some() || self.dialog != Dialog::None || !self.notices.is_empty()
            }
            Action::ResetSettings => !self.settings.0.is_empty(),
            Action::Slower | Action::Faster | Action::ToggleDetail => true,
            Action::Start
            | Action::Reload
            | Action::Save
            | Action::SaveAs
            | Action::Figure
            | Action::ExportSvg
            | Action::ExportPdf
            | Action::ExportPng => open,
            Action::Report | Action::About | Action::FrameSelection | Action::Swap => open,
            Action::Laboratory => open,
            _ if (Action::Bookmark1..=Action::Bookmark10).contains(&action) => {
                self.bookmarks.len() > action as usize - Action::Bookmark1 as usize
            }
            Action::PlayPath => self.path_length() > 1,
            _ if action.info().menu == Menu::Step => !self.is_empty(),
            _ if action.info().menu == Menu::Edit => open,
            _ => true,
        }
    }

    /// Whether what an action shows or chooses is shown or chosen now.
    pub fn is_on(&self, action: Action) -> bool {
        let s = &self.shown;
        match action {
            Action::ShowPrims => s.prims,
            Action::ShowNodes => s.nodes,
            Action::ShowEye => s.eye,
            Action::ShowEvidence => s.evidence,
            Action::Swap => self.is_swapped,
            Action::PlayPath => self.is_path_playing,
            Action::LockEye => self.is_eye_locked,
            Action::SurfaceSolid => s.surface == Surface::Solid,
            Action::SurfaceWire => s.surface == Surface::Wire,
            Action::SurfaceClear => s.surface == Surface::Translucent,
            Action::LookInOff => s.look_in == LookIn::Off,
            Action::LookInCut => s.look_in == LookIn::Cut,
            Action::LookInFaces => s.look_in == LookIn::Faces,
            Action::ThemeLight => s.theme == Theme::Light,
            Action::ThemeDark => s.theme == Theme::Dark,
            Action::ThemePrint => s.theme == Theme::Print,
            Action::LayoutDebug => s.layout == Layout::Debug,
            Action::LayoutLecture => s.layout == Layout::Lecture,
            Action::LayoutFigure => s.layout == Layout::Figure,
            Action::LayoutPictures => s.layout == Layout::Pictures,
            _ => false,
        }
    }

    fn act(&mut self, action: Action) {
        let is_done = |s: &mut Self| s.do_step(action) || s.edit(action) || s.show_objects(action);
        if !self.can(action) || is_done(self) || self.show(action) {
            return;
        }
        match action {
            Action::Open => {
                self.dialog = Dialog::Open;
            }
            Action::Start => {
                self.worker.cancel();
                self.stage = None;
                self.step = 0;
                self.selection = Subject::None;
            }
            Action::Reload => {
                if let Some(source) = self.staged().map(|s| s.scene().source().to_owned()) {
                    self.recall = Some(self.session());
                    self.load(Wanted::named(&source), None);
                }
            }
            Action::Save => match self.session_path.clone() {
                Some(path) => self.save(&path),
                None => self.dialog = Dialog::SaveAs,
            },
            Action::SaveAs => self.dialog = Dialog::SaveAs,
            Action::ExportSvg => self.effects.push(Effect::Export(Format::Svg)),
            Action::ExportPdf => self.effects.push(Effect::Export(Format::Pdf)),
            Action::ExportPng => self.effects.push(Effect::Export(Format::Png)),
            Action::Figure => self.dialog = Dialog::Figure,
            Action::Cancel if self.dialog != Dialog::None => self.dialog = Dialog::None,
            Action::Cancel if self.busy().is_some() => {
                self.worker.cancel();
                self.making = None;
                self.recall = None;
                self.tell("Cancelled.");
            }
            Action::Cancel => {
                self.notices.pop();
            }
            Action::Quit => self.effects.push(Effect::Quit),
            _ => {}
        }
    }

    /// Carries out an action of the menu Edit; returns whether it was one.
    fn edit(&mut self, action: Action) -> bool {
        match action {
            Action::Undo | Action::Redo => self.undo(action == Action::Undo),
            Action::SelectBack => {
                if let Some(subject) = self.selected_before.pop() {
                    self.selected_after.push(self.selection);
                    self.selection = subject;
                }
            }
            Action::SelectForward => {
                if let Some(subject) = self.selected_after.pop() {
                    self.selected_before.push(self.selection);
                    self.selection = subject;
                }
            }
            Action::SelectNone => self.select(Subject::None),
            Action::SelectCurrent => self.select(self.current_subject()),
            Action::SelectEye => self.select(Subject::Eye),
            Action::SelectParent => {
                let Some(stage) = self.staged() else { return true };
                let above = match self.selection {
                    Subject::Node(node) => stage.parent(node),
                    Subject::Prim(prim) => stage.leaf_of(prim),
                    _ => None,
                };
                match above {
                    Some(node) => self.select(Subject::Node(node)),
                    None => self.tell("There is no node above it."),
                }
            }
            Action::Why => match self.staged().and_then(|stage| self.why.decided(stage)) {
                Some(step) => self.go_to(step),
                None => self.tell("Nothing was decided about it in this film."),
            },
            Action::CopyEye => {
                let text = self.staged().map(|s| s.eye_text()).unwrap_or_default();
                self.effects.push(Effect::Copy(text));
                self.tell("The Eye was copied in the words of the command line.");
            }
            Action::EyeHome => self.change(0, |s| {
                if let Some(stage) = &mut s.stage {
                    let (path, frame) = stage.get().place();
                    stage.go(path, frame);
                }
            }),
            Action::EyeHere => {
                let camera = self.observer;
                self.change(0, |s| {
                    if let Some(Either::Solid(stage)) = &mut s.stage {
                        let (look, mut view) = (camera.view(1, 1).eye, stage.view);
                        (view.eye.position, view.eye.target, view.eye.up) =
                            (look.position, look.target, look.up);
                        stage.view = stage.fitted(view);
                    }
                });
            }
            Action::LockEye => self.is_eye_locked = !self.is_eye_locked,
            Action::Flight => self.fly(),
            Action::ResetSettings => self.change(0, |s| s.settings.0.clear()),
            _ => return false,
        }
        true
    }

    /// Carries out an action of the menus View and Help; returns whether it was one.
    fn show(&mut self, action: Action) -> bool {
        let shown = &mut self.shown;
        match action {
            Action::Find => self.effects.push(Effect::FocusFilter),
            Action::FoldAll | Action::UnfoldAll => {
                if let Some(film) = self.stage.as_ref().and_then(|s| s.get().film()) {
                    self.outline.fold_all(film.reel.events(), action == Action::FoldAll);
                }
            }
            Action::FrameSelection => self.is_to_frame = true,
            Action::Swap => self.is_swapped = !self.is_swapped,
            Action::ShowPrims => shown.prims = !shown.prims,
            Action::ShowNodes => shown.nodes = !shown.nodes,
            Action::ShowEye => shown.eye = !shown.eye,
            Action::ShowEvidence => shown.evidence = !shown.evidence,
            Action::SurfaceSolid => shown.surface = Surface::Solid,
            Action::SurfaceWire => shown.surface = Surface::Wire,
            Action::SurfaceClear => shown.surface = Surface::Translucent,
            Action::CycleSurface => shown.surface = Surface::ALL[(shown.surface as usize + 1) % 3],
            Action::LookInOff | Action::LookInCut | Action::LookInFaces | Action::CycleLookIn => {
                shown.look_in = match action {
                    Action::LookInOff => LookIn::Off,
                    Action::LookInCut => LookIn::Cut,
                    Action::LookInFaces => LookIn::Faces,
                    _ => LookIn::ALL[(shown.look_in as usize + 1) % 3],
                }
            }
            Action::ThemeLight => shown.theme = Theme::Light,
            Action::ThemeDark => shown.theme = Theme::Dark,
            Action::ThemePrint => shown.theme = Theme::Print,
            _ if (Action::LayoutDebug..=Action::LayoutPictures).contains(&action) => {
                self.set_layout(Layout::ALL[action as usize - Action::LayoutDebug as usize]);
            }
            Action::ResetLayout => self.effects.push(Effect::ResetLayout),
            Action::ScaleUp => shown.scale = (shown.scale * 1.1).min(4.0),
            Action::ScaleDown => shown.scale = (shown.scale / 1.1).max(0.5),
            Action::ScaleReset => shown.scale = 1.0,
            Action::FullScreen => self.effects.push(Effect::FullScreen),
            _ => match dialog_of(action) {
                Some(dialog) => self.dialog = dialog,
                None => return false,
            },
        }
        true
    }

    fn set_layout(&mut self, layout: Layout) {
        self.shown.layout = layout;
        self.effects.push(Effect::ResetLayout);
    }

    fn select(&mut self, subject: Subject) {
        if subject == self.selection {
            return;
        }
        if !self.is_there(subject) {
            return self.fail("There is no such thing to select.");
        }
        self.selected_before.push(self.selection);
        if self.selected_before.len() > SELECTIONS {
            self.selected_before.remove(0);
        }
        self.selected_after.clear();
        self.selection = subject;
    }

    /// Whether a thing is in the scene, or in the film's index; before there is one, everything is.
    fn is_there(&self, subject: Subject) -> bool {
        let Some(stage) = self.staged() else { return true };
        match subject {
            Subject::Prim(prim) => stage.scene().has_prim(prim),
            Subject::Object(object) => object.at() < stage.scene().object_count(),
            Subject::Node(node) => stage.film().is_none_or(|film| node.at() < film.node_count()),
            _ => true,
        }
    }

    fn inputs(&self) -> Option<Inputs> {
        let stage = self.stage.as_ref()?;
        Some(Inputs {
            method: self.method.clone(),
            settings: self.settings.clone(),
            place: stage.get().place(),
            view: stage.view(),
        })
    }

    /// Changes something that culling depends on: undoable, and the film is recorded again.
    pub(super) fn change(&mut self, gesture: u64, change: impl FnOnce(&mut Self)) {
        let before = self.inputs();
        change(self);
        if before != self.inputs()
            && let Some(before) = before
        {
            if let Some(stage) = &mut self.stage {
                each!(stage, s => s.keep_flying());
            }
            self.history.push(before, gesture);
            self.record();
        }
    }

    /// Begins a flight, or ends it: its views become a path of the stage, and a view file.
    fn fly(&mut self) {
        let Some(stage) = &mut self.stage else { return };
        let (frames, text) = match each!(stage, s => s.fly()) {
            Flight::Begun => {
                return self.tell(
                    "The flight is recorded: move the Eye, and choose the same command again to end it.",
                );
            }
            Flight::Dropped => return self.tell("The flight is dropped: the Eye was not moved."),
            Flight::Ended { frames, text } => (frames, text),
        };
        let scene = self.staged().map_or("scene", |s| s.scene().name()).replace(['/', '\\', ' '], "-");
        let path = self.path_of(&format!("{scene}-flight.views.json"));
        match write_file(&path, text.as_bytes()) {
            Ok(()) => {
                self.tell(format!("The flight of {frames} views is a path now, and was written to {path}."))
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn undo(&mut self, back: bool) {
        let Some(now) = self.inputs() else { return };
        let Some(wanted) = (if back { self.history.undo(now) } else { self.history.redo(now) }) else {
            return;
        };
        if let Some(stage) = &mut self.stage {
            stage.go(wanted.place.0, wanted.place.1);
            stage.set_view(&wanted.view);
        }
        (self.method, self.settings) = (wanted.method, wanted.settings);
        self.record();
    }

    pub(super) fn go_frame(&mut self, path: usize, frame: usize, gesture: Gesture) {
        self.change(gesture, |s| {
            if let Some(stage) = &mut s.stage {
                stage.go(path, frame);
            }
        });
    }

    /// Opens a scene or a session file.
    pub(super) fn open(&mut self, source: &str, views: Option<String>) {
        self.dialog = Dialog::None;
        let is_figure = super::export::is_figure(source);
        if is_figure || Session::is_named(source) {
            match if is_figure { super::export::session_in(source) } else { Session::read(source) } {
                Ok(session) => {
                    self.session_path = Some(source.to_owned()).filter(|_| !is_figure);
                    self.restore(session, Some(source));
                }
                Err(error) => self.fail(error.to_string()),
            }
            return;
        }
        self.recall = None;
        self.load(Wanted::named(source), views);
    }

    /// Puts a scene on stage that was loaded elsewhere, with the views that were named for it, and records it
    /// with the method and the parameters that are wanted.
    pub fn put(&mut self, scene: AnyOpened) {
        self.recall = None;
        self.put_on_stage(scene);
    }

    /// Lets culling see from here, as it is: near and far stay.
    pub fn see_from(&mut self, view: &AnyView) {
        self.change(0, |s| {
            if let Some(stage) = &mut s.stage {
                stage.set_view(view);
            }
        });
    }

    /// Carries out a command by its name, such as `step` or `go-to:12`.
    ///
    /// # Errors
    /// If there is no such command, or what it says went wrong, in a line.
    pub fn speak(&mut self, text: &str) -> Result<(), String> {
        self.notices.clear();
        self.order(text)?;
        self.block_until_idle();
        self.notices.iter().find(|n| n.is_error).map_or(Ok(()), |n| Err(n.text.clone()))
    }

    /// The same without waiting for what it takes.
    ///
    /// # Errors
    /// If there is no such command.
    pub fn order(&mut self, text: &str) -> Result<(), String> {
        let command = super::recall::spoken_command(text).ok_or("this is not a command of the explorer")?;
        self.apply(command);
        Ok(())
    }

    pub(super) fn load(&mut self, wanted: Wanted, views: Option<String>) {
        (self.is_playing, self.is_path_playing) = (false, false);
        self.worker.ask(&format!("Opening {}", wanted.source), Job::Load { wanted, views });
    }

    /// Records the film of what is wanted now.
    pub(super) fn record(&mut self) {
        let Some(stage) = &self.stage else { return };
        let (method, settings, cap) = (self.method.clone(), self.settings.clone(), self.film_cap);
        let request = each!(stage, s => Either(Request {
            scene: s.scene.clone(),
            scene_serial: s.serial,
            method,
            settings,
            before: s.views()[..s.frame].to_vec(),
            view: s.view,
            cap,
        }));
        self.worker.ask("Culling", Job::Record(request));
    }

    /// Takes in what the worker has finished; returns whether anything changed.
    pub fn poll(&mut self) -> bool {
        self.take(false)
    }

    /// Waits until nothing is being waited for. For tests and for commands that are run one after the other.
    pub fn block_until_idle(&mut self) {
        while self.busy().is_some() {
            self.take(true);
        }
        self.take(false);
    }

    fn take(&mut self, wait: bool) -> bool {
        if self.making.is_some() {
            self.make();
            return true;
        }
        let Some(done) = self.worker.answer(wait) else { return self.take_news() };
        self.take_news();
        match done {
            Done::Loaded(opened) => self.put_on_stage(opened),
            Done::LoadFailed(text) => {
                self.recall = None;
                self.fail(text);
            }
            Done::Recorded(recorded) => self.take_film(recorded),
            Done::Measured(measured) => {
                self.take_table(*measured);
                self.run_commands();
            }
            Done::Swept => {
                self.record_if_missing();
                self.run_commands();
            }
            Done::Advised(advice) => {
                self.take_advice(*advice);
                self.run_commands();
            }
            Done::Mapped(map) => {
                self.take_map(*map);
                self.run_commands();
            }
            Done::Layered { layers, action } => self.take_layers(layers, action),
            Done::RecordFailed(text) => self.fail(text),
            Done::Cancelled => {}
        }
        self.refresh();
        true
    }

    fn put_on_stage(&mut self, opened: AnyOpened) {
        self.serial += 1;
        let stage: AnyStage = each!(opened, (scene, path) => Either(Stage::new(scene, path, self.serial)));
        let name = stage.get().scene().name().to_owned();
        let dropped = stage.get().scene().report().dropped_total();
        if !stage.get().methods().iter().any(|m| m.key == self.method) {
            self.method = DEFAULT_METHOD.into();
            self.settings.0.clear();
        }
        // Framed for a window of common shape; the window itself does it again for its own.
        match &stage {
            Either::Flat(s) => self.observer.frame_flat(&s.scene.bounds(), &s.scene.bounds(), 4.0 / 3.0),
            Either::Solid(s) => self.observer.frame_solid(&s.scene.bounds(), &s.scene.bounds(), 4.0 / 3.0),
        }
        self.stage = Some(stage);
        // Another scene has another shape and another run.
        (self.exporting.aspect, self.exporting.steps) = (None, None);
        (self.step, self.selection) = (0, Subject::None);
        self.selected_before.clear();
        self.selected_after.clear();
        self.bookmarks.clear();
        self.breakpoints.clear();
        self.history.clear();
        self.notices.retain(|n| !n.is_error);
        self.filter.clear();
        self.is_to_frame = true;
        if dropped > 0 {
            self.tell(format!("{name}: {dropped} primitives were dropped; see the loading report."));
        }
        if let Some(session) = self.recall.clone() {
            self.recall_inputs(&session);
        }
        self.record();
    }

    fn take_film(&mut self, recorded: super::any::AnyRecorded) {
        // A step at the end stays at the end; any other keeps its number.
        let was_at_end = !self.is_empty() && self.step == self.len();
        match (&mut self.stage, recorded) {
            (Some(Either::Flat(stage)), Either::Flat(film)) => stage.recorded = Some(film),
            (Some(Either::Solid(stage)), Either::Solid(film)) => stage.recorded = Some(film),
            _ => return,
        }
        let nodes = self.film().map_or(0, |f| f.node_count());
        if matches!(self.selection, Subject::Node(n) if n.at() >= nodes) {
            self.selection = Subject::None;
        }
        if let Some(session) = self.recall.take() {
            self.recall_rest(&session);
        }
        self.step = if was_at_end { self.len() } else { self.step.min(self.len()) };
        self.run_commands();
    }
}

/// The dialog that an action opens.
fn dialog_of(action: Action) -> Option<Dialog> {
    Some(match action {
        Action::Palette => Dialog::Palette,
        Action::Keys => Dialog::Keys,
        Action::Report => Dialog::Report,
        Action::About => Dialog::About,
        Action::Tables => Dialog::Tables,
        Action::Laboratory => Dialog::Laboratory,
        Action::Failures => Dialog::Failures,
        _ => return None,
    })
}
