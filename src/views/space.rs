//! Space, through the Eye and from outside, on the graphics card: scrubbing changes one number there.

use eframe::egui::{self, Sense};
use eframe::egui_wgpu::{self, RenderState, wgpu};
use glam::{Vec2, Vec3};

use super::handles::Hand;
use super::{Answers, palette, reach};
use crate::app::{Command, LookIn, PoseKey, Stage, Staged, State, Surface, Theme};
use crate::drawing::{Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::figure;
use crate::geometry::{Solid, View};
use crate::render::gpu::{self, NodeBoxes, Palette, Shown, SpaceCamera, SpaceLayer, SpaceStyle, ViewportId};
use crate::render::screen;

/// What lies on the graphics card.
#[derive(Clone, Debug, Default)]
pub struct Uploaded {
    scene: PoseKey,
    film: u64,
    /// The marks of a step, and the film, step and look that they were drawn for.
    marks: Option<((u64, usize, figure::Look), Drawing<Vec3>)>,
    /// What the Eye sees of a method that stands something for primitives, painted for a film, a step and a
    /// theme; nothing of other methods.
    painted: Option<((u64, usize, Theme), Option<Pixels>)>,
}

/// What the pictures of space need beside the state.
pub struct Tools<'a> {
    /// The graphics card, if there is one.
    pub gpu: Option<&'a RenderState>,
    /// What lies on it.
    pub uploaded: &'a mut Uploaded,
    /// What the person does.
    pub hand: &'a mut Hand,
}

/// Shows space: what the Eye sees, or what the Observer sees.
pub fn show(
    state: &State,
    stage: &Stage<Solid>,
    is_eye: bool,
    tools: Tools<'_>,
    ui: &mut egui::Ui,
    answers: &mut Answers,
) {
    let Tools { gpu, uploaded, hand } = tools;
    let (pane, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let name = if is_eye { "Eye view" } else { "Observer view" };
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, format!("{name}. {}", state.sentence()))
    });
    hand.is_picture_focused |= response.has_focus();
    ui.painter_at(pane).rect_filled(pane, 0.0, palette::panel(state).canvas);
    if !is_eye && state.is_to_frame {
        let mut camera = state.observer;
        camera.frame_solid(&stage.framed(state.selection), &stage.posed().bounds(), pane.aspect_ratio());
        answers.push(Command::Observe(camera));
    }
    let rect =
        if is_eye { fitted(pane, stage.view.width as f32 / stage.view.height.max(1) as f32) } else { pane };
    let rect = egui::emath::GuiRounding::round_to_pixels(rect, ui.ctx().pixels_per_point());
    let view =
        if is_eye { stage.view } else { state.observer.view(rect.width() as u32, rect.height() as u32) };
    match gpu {
        Some(gpu) => {
            upload(state, stage, uploaded, gpu);
            let is_painted = is_eye && paint(state, stage, uploaded, ui, rect);
            picture(state, stage, (is_eye, is_painted), ui, rect, &view);
        }
        None => {
            ui.painter().text(
                rect.center(),
                egui::Align2::CENTER_CENTER,
                "No graphics device",
                egui::FontId::default(),
                palette::panel(state).faint,
            );
        }
    }
    if !is_eye {
        hand.aspect = rect.aspect_ratio();
    }
    if is_eye {
        ui.painter_at(pane).rect_stroke(
            rect,
            0.0,
            egui::Stroke::new(1.0, palette::panel(state).border),
            egui::StrokeKind::Inside,
        );
        changed_depths(state, stage, ui, rect);
        reach::look_around(state, stage, hand, ui, &response, rect, answers);
    } else {
        labels(state, stage, uploaded, ui, rect, &view);
        reach::observe(state, stage, hand, ui, &response, &view, answers);
    }
    super::canvas::focus_ring(state, ui, &response);
}

/// Says in the Eye's picture that near and far are no longer those of its path.
pub fn changed_depths(state: &State, stage: &dyn Staged, ui: &egui::Ui, rect: egui::Rect) {
    let Some(text) = stage.changed_depths() else { return };
    let (colors, painter) = (palette::panel(state), ui.painter_at(rect));
    let galley = painter.layout(text, egui::FontId::proportional(12.0), colors.faint, rect.width() - 12.0);
    let at = rect.left_bottom() + egui::vec2(6.0, -galley.size().y - 4.0);
    painter.rect_filled(egui::Rect::from_min_size(at, galley.size()).expand(2.0), 2.0, colors.canvas);
    painter.galley(at, galley, colors.faint);
}

/// The largest rectangle of this aspect in the middle of another one.
fn fitted(pane: egui::Rect, aspect: f32) -> egui::Rect {
    let size = if pane.aspect_ratio() > aspect {
        egui::vec2(pane.height() * aspect, pane.height())
    } else {
        egui::vec2(pane.width(), pane.width() / aspect)
    };
    egui::Rect::from_center_size(pane.center(), size)
}

/// Paints what the Eye sees of a method that stands something for primitives; whether it is one.
fn paint(state: &State, stage: &Stage<Solid>, now: &mut Uploaded, ui: &egui::Ui, rect: egui::Rect) -> bool {
    let Some(recorded) = &stage.recorded else { return false };
    // While the Eye moves, the picture is that of the film, and is not shown where it no longer fits.
    if *recorded.film.view() != stage.view || state.shown.surface != Surface::Solid || !state.shown.prims {
        return false;
    }
    let key = (recorded.serial, state.step, state.shown.theme);
    if now.painted.as_ref().is_none_or(|(k, _)| *k != key) {
        let background = state.shown.theme.flat_linear(Role::Paper);
        let pixels = stage.drawn(state.step).and_then(|list| stage.painted(&list, background));
        now.painted = Some((key, pixels));
    }
    let Some((_, Some(pixels))) = &now.painted else { return false };
    let mut paper = Drawing { size_pt: Vec2::new(rect.width(), rect.height()), ..Drawing::default() };
    let mark = Mark::Image { corners: [Vec2::ZERO, paper.size_pt], pixels: pixels.clone() };
    paper.push(Layer::Ground, Role::Paper, Subject::None, mark);
    screen::paint(&ui.painter_at(rect), &paper, state.shown.theme, rect.min, 1.0);
    true
}

fn picture(
    state: &State,
    stage: &Stage<Solid>,
    (is_eye, is_painted): (bool, bool),
    ui: &egui::Ui,
    rect: egui::Rect,
    view: &View<Solid>,
) {
    let ppp = ui.ctx().pixels_per_point();
    let size_px = [(rect.width() * ppp).round() as u32, (rect.height() * ppp).round() as u32];
    let mut style = style(state, stage, is_eye, ppp);
    if is_painted {
        // What is drawn is painted already; over it comes what is marked.
        style.surface = gpu::Surface::Hidden;
        style.transparent = true;
    }
    let id = ViewportId(u32::from(is_eye));
    let call = Call { id, size_px, camera: view.eye.into(), style };
    ui.painter().add(egui_wgpu::Callback::new_paint_callback(rect, call));
}

/// Takes the scene, the film and the marks of the step to the graphics card, each when it has changed.
fn upload(state: &State, stage: &Stage<Solid>, now: &mut Uploaded, gpu: &RenderState) {
    let mut renderer = gpu.renderer.write();
    let resources = &mut renderer.callback_resources;
    if resources.get::<SpaceLayer>().is_none() {
        resources.insert(SpaceLayer::new(&gpu.device, gpu.target_format));
        *now = Uploaded::default();
    }
    let Some(layer) = resources.get_mut::<SpaceLayer>() else { return };
    if now.scene != stage.pose_key() {
        *now = Uploaded { scene: stage.pose_key(), ..Uploaded::default() };
        layer.set_scene(&gpu.device, stage.posed(), stage.shown_prims());
    }
    let Some(recorded) = &stage.recorded else { return };
    if now.film != recorded.serial {
        now.film = recorded.serial;
        layer.set_film(&gpu.device, &gpu.queue, &recorded.stamps, recorded.film.hierarchy(), &[]);
    }
    let look = figure::Look {
        prims: false,
        nodes: false,
        selected: Subject::None,
        current: Subject::None,
        ..state.look()
    };
    let key = (recorded.serial, state.step, look);
    if now.marks.as_ref().is_none_or(|(k, _)| *k != key) {
        let world = figure::world(&*recorded.film, &recorded.stamps, state.step, &look);
        layer.set_marks(&gpu.device, &gpu.queue, &world);
        now.marks = Some((key, world));
    }
}

/// What a viewport shows.
pub fn style(state: &State, stage: &Stage<Solid>, is_eye: bool, pixels_per_point: f32) -> SpaceStyle {
    let palette = Palette::of(state.shown.theme);
    let base =
        if is_eye { SpaceStyle::eye(state.step, palette) } else { SpaceStyle::observer(state.step, palette) };
    let mut style = SpaceStyle { pixels_per_point, ..base };
    if is_eye {
        // What is not decided yet is hinted at, so that the picture is never empty.
        style.undecided = Shown::Ghost;
    }
    style.surface = match state.shown.surface {
        _ if !state.shown.prims => gpu::Surface::Hidden,
        Surface::Wire => gpu::Surface::Wireframe,
        Surface::Solid | Surface::Translucent => gpu::Surface::Solid,
    };
    if state.shown.surface == Surface::Translucent {
        (style.kept, style.undecided, style.ghost) = (Shown::Ghost, Shown::Ghost, 0.3);
    }
    if !is_eye {
        match state.shown.look_in {
            LookIn::Off => {}
            LookIn::Cut => style.section = Some((-Vec3::Y, stage.view.eye.position.y)),
            LookIn::Faces => style.only_fronts = true,
        }
    }
    if !state.shown.nodes {
        style.nodes = NodeBoxes::None;
    }
    // Their patterns would hide the colors of what stands for them.
    style.stand_ins = state.shown.evidence && stage.drawn(0).is_some();
    let current = state.current_subject();
    style.highlights = vec![(current, Role::Current), (state.selection, Role::Selected)];
    style.highlights.retain(|(s, _)| *s != Subject::None);
    style
}

struct Call {
    id: ViewportId,
    size_px: [u32; 2],
    camera: SpaceCamera,
    style: SpaceStyle,
}

impl egui_wgpu::CallbackTrait for Call {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _: &egui_wgpu::ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut egui_wgpu::CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(layer) = resources.get_mut::<SpaceLayer>() {
            layer.render(device, queue, encoder, self.id, self.size_px, &self.camera, &self.style);
        }
        vec![]
    }
    fn paint(
        &self,
        _: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &egui_wgpu::CallbackResources,
    ) {
        if let Some(layer) = resources.get::<SpaceLayer>() {
            layer.blit(self.id, pass);
        }
    }
}

/// The labels of the evidence, over the picture.
fn labels(
    state: &State,
    stage: &Stage<Solid>,
    uploaded: &Uploaded,
    ui: &egui::Ui,
    rect: egui::Rect,
    view: &View<Solid>,
) {
    let Some((_, marks)) = &uploaded.marks else { return };
    if stage.recorded.is_none() || !state.shown.evidence {
        return;
    }
    let texts = marks
        .items
        .iter()
        .filter(|i| i.layer == Layer::Labels && matches!(i.mark, Mark::Text { .. }))
        .cloned()
        .collect();
    let size = Vec2::new(rect.width(), rect.height());
    let mut paper = Drawing { size_pt: size, ..Drawing::default() };
    figure::project(&Drawing { items: texts, ..Drawing::default() }, view, Vec2::ZERO, size, &mut paper);
    super::readable_labels(&mut paper);
    screen::paint(&ui.painter_at(rect), &paper, state.shown.theme, rect.min, 1.0);
}
