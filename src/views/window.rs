//! The window: egui's frame around the state, and what only the screen needs.

use eframe::egui::{self, Panel, ViewportCommand};
use egui_tiles::Tree;

use super::cache::Cache;
use super::dock::{self, Dock, Pane};
use super::keys::{Hook, Keys};
use super::{Answers, dialogs, menu, palette, status, welcome};
use crate::app::{Action, Command, Dialog, Effect, Layout, Session, Start, State, Theme};
use crate::drawing::Pixels;
use crate::render::screen;

/// The explorer.
pub struct App {
    /// Everything that the explorer knows.
    pub state: State,
    cache: Cache,
    tree: Tree<Pane>,
    keys: Keys,
    start: Start,
    /// Theme, layout and scale (in thousandths) that egui was set up for.
    dressed: Option<(Theme, Layout, u32)>,
    title: String,
    is_fullscreen: bool,
    /// Frames in a row in which nothing was waited for.
    quiet_frames: u32,
    is_shot: bool,
}

/// Frames without work before a screenshot is taken.
const QUIET_FRAMES: u32 = 8;
/// Keys in eframe's storage.
const LAYOUT: &str = "layout-2";
const SESSION: &str = "session-1";

impl App {
    /// The explorer as eframe wants it.
    pub fn new(cc: &eframe::CreationContext<'_>, start: Start) -> Self {
        let ctx = &cc.egui_ctx;
        screen::install_fonts(ctx);
        ctx.options_mut(|o| o.zoom_with_keyboard = false);
        let keys = Keys::default();
        ctx.add_plugin(Hook::new(keys.clone()));
        let mut state = State::new();
        let waker = ctx.clone();
        state.set_wake(move || waker.request_repaint());
        // Whatever is wrong with what was saved, the explorer starts without it.
        let kept = |key: &str| cc.storage.filter(|_| !start.fresh).and_then(|s| s.get_string(key));
        let last = kept(SESSION).and_then(|text| Session::parse(&text, "the last session").ok());
        state.start(&start, last);
        let layout = kept(LAYOUT)
            .filter(|_| !start.reset_layout)
            .and_then(|text| serde_json::from_str::<(String, Tree<Pane>)>(&text).ok());
        let layout = layout.filter(|(name, tree)| *name == state.shown.layout.name() && dock::is_sound(tree));
        let tree = layout.map_or_else(|| dock::tree(state.shown.layout), |(_, tree)| tree);
        Self {
            state,
            cache: Cache::default(),
            tree,
            keys,
            start,
            dressed: None,
            title: String::new(),
            is_fullscreen: false,
            quiet_frames: 0,
            is_shot: false,
        }
    }

    fn dress(&mut self, ctx: &egui::Context) {
        let shown = &self.state.shown;
        let wanted = (shown.theme, shown.layout, (shown.scale * 1000.0) as u32);
        if self.dressed != Some(wanted) {
            self.dressed = Some(wanted);
            palette::dress(ctx, &self.state, self.state.shown.layout == Layout::Lecture);
            ctx.set_zoom_factor(self.state.shown.scale);
        }
    }

    fn panels(&mut self, ui: &mut egui::Ui, frame: &eframe::Frame, answers: &mut Answers) {
        let state = &self.state;
        Panel::top("menu").show(ui, |ui| menu::show(state, ui, answers));
        if state.shown.layout == Layout::Lecture && state.stage.is_some() {
            Panel::bottom("caption").show(ui, |ui| status::caption(state, ui));
        }
        Panel::bottom("status").show(ui, |ui| status::show(state, ui, answers));
        if state.stage.is_some() {
            let mut dock = Dock { state, cache: &mut self.cache, answers, gpu: frame.wgpu_render_state() };
            let ground = egui::Frame::NONE.fill(ui.visuals().panel_fill);
            egui::CentralPanel::no_frame().frame(ground).show(ui, |ui| self.tree.ui(&mut dock, ui));
        } else {
            let examples = &mut self.cache.examples;
            egui::CentralPanel::default().show(ui, |ui| welcome::show(state, examples, ui, answers));
        }
        dialogs::show(state, &mut self.cache.typing, self.cache.hand.aspect, ui.ctx(), answers);
    }

    /// Prepares the hook of the keys for the next frame, whose keys it sees before any panel.
    fn prepare_keys(&mut self, ctx: &egui::Context) {
        let mut inbox = self.keys.inbox();
        inbox.enabled = Action::ALL.iter().map(|i| i.action).filter(|&a| self.state.can(a)).collect();
        inbox.is_picture_focused = self.cache.hand.is_picture_focused;
        inbox.is_flying = std::mem::take(&mut self.cache.hand.is_flying);
        inbox.is_typing = self.state.dialog != Dialog::None;
        if self.state.dialog != Dialog::None || egui::Popup::is_any_open(ctx) {
            // An open menu or dialog closes itself on Escape.
            inbox.enabled.remove(&Action::Cancel);
        }
        self.cache.hand.is_picture_focused = false;
    }

    /// Commands that come from outside the panels: keys, dropped files, the system's dialog.
    fn outside_world(&mut self, ctx: &egui::Context) -> Answers {
        let mut answers: Answers =
            std::mem::take(&mut self.keys.inbox().pressed).into_iter().map(Command::from).collect();
        let dropped =
            ctx.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_string_lossy().into_owned()));
        answers.extend(dropped.map(Command::Open));
        match self.cache.typing.chooser.answer() {
            Some(Some(path)) => answers.push(Command::Open(path)),
            Some(None) => self.state.tell("No file was chosen. If no dialog appeared, type the path."),
            None => {}
        }
        answers
    }

    fn effects(&mut self, ctx: &egui::Context) {
        for effect in std::mem::take(&mut self.state.effects) {
            match effect {
                Effect::Export(format) => {
                    self.state.export(format, self.cache.hand.aspect);
                }
                Effect::Copy(text) => ctx.copy_text(text),
                Effect::FullScreen => {
                    self.is_fullscreen = !self.is_fullscreen;
                    ctx.send_viewport_cmd(ViewportCommand::Fullscreen(self.is_fullscreen));
                }
                Effect::ResetLayout => self.tree = dock::tree(self.state.shown.layout),
                Effect::ShowPixel => {
                    // A layout without the list has at least its first sentence.
                    let said = self.state.staged().and_then(|stage| self.state.pixel.said(stage));
                    if !dock::bring(&mut self.tree, Pane::Pixel) {
                        said.into_iter().for_each(|said| self.state.tell(said));
                    }
                }
                Effect::FocusFilter => self.cache.scroll.focus_filter = true,
                Effect::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            }
        }
    }

    /// Writes the screenshot of the command line once the window has been quiet for some frames, and quits.
    fn shoot(&mut self, ctx: &egui::Context) {
        let Some(shot) = self.start.shot.clone().filter(|_| !self.is_shot) else { return };
        self.quiet_frames = if self.state.busy().is_none() { self.quiet_frames + 1 } else { 0 };
        ctx.request_repaint();
        // Layout and textures settle over some frames after the last change.
        if self.quiet_frames < QUIET_FRAMES {
            return;
        }
        self.is_shot = true;
        let quit = ctx.clone();
        ctx.request_screenshot(move |image: std::sync::Arc<egui::ColorImage>| {
            let rgba: Vec<u8> = image.pixels.iter().flat_map(|c| c.to_srgba_unmultiplied()).collect();
            let pixels =
                Pixels { width: image.size[0] as u32, height: image.size[1] as u32, rgba: rgba.into() };
            if let Err(error) = crate::app::write_file(&shot.path, &crate::render::png_pixels(&pixels)) {
                eprintln!("error: {error}");
            }
            quit.send_viewport_cmd(ViewportCommand::Close);
            quit.request_repaint();
        });
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.state.poll();
        self.dress(&ctx);
        // Keys and files come before the panels, which then show what they did in this frame.
        let mut answers = self.outside_world(&ctx);
        for command in answers.drain(..) {
            self.state.apply(command);
        }
        self.panels(ui, frame, &mut answers);
        // What the panels answer is not shown before the next frame.
        for command in answers {
            self.state.apply(command);
            ctx.request_repaint();
        }
        self.effects(&ctx);
        if self.state.tick(ctx.input(|i| i.stable_dt)) || self.state.is_making() {
            ctx.request_repaint();
        }
        self.prepare_keys(&ctx);
        let title = self
            .state
            .staged()
            .map_or("cullscope".to_owned(), |s| format!("{} – cullscope", s.scene().name()));
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        self.shoot(&ctx);
    }
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if self.start.fresh || self.start.shot.is_some() {
            return;
        }
        if let Ok(text) = serde_json::to_string(&(self.state.shown.layout.name(), &self.tree)) {
            storage.set_string(LAYOUT, text);
        }
        storage.set_string(SESSION, self.state.session_in(None).text());
    }
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// When there is no display or no way to draw on it.
pub fn run(start: Start) -> Result<(), eframe::Error> {
    let size = start.shot.as_ref().map_or([1280.0, 800.0], |s| [s.size_px[0] as f32, s.size_px[1] as f32]);
    let viewport = egui::ViewportBuilder::default()
        .with_inner_size(size)
        .with_min_inner_size([640.0, 420.0])
        .with_title("cullscope")
        .with_app_id("cullscope")
        .with_drag_and_drop(true);
    // A saved window position may lie on a screen that is gone: the window's place is not kept.
    let native = eframe::NativeOptions { viewport, persist_window: false, ..Default::default() };
    eframe::run_native("cullscope", native, Box::new(move |cc| Ok(Box::new(App::new(cc, start)))))
}
