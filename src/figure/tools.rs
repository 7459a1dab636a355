//! What figures of films share: a method run on a scene, a flatland picture of known scale for labels, and
//! pages of the widths that figures have.

use std::cell::RefCell;
use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use super::look::{Look, world};
use super::page::{Entry, Page, Paper, Swatch};
use super::panels::{Panel, Picture};
use crate::culling::Methods;
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};
use crate::geometry::{Aabb, Eye, Flat, Solid, View};
use crate::method::{Card, Film, Knob, KnobValue, Run, Settings, departs, settings_for};
use crate::scene::{Quiet, Scene};
use crate::trace::Stamps;

/// Colors for pictures made of pixels, linear 0..1, by role. The theme provides it.
pub type Tint<'a> = &'a dyn Fn(Role) -> [f32; 3];

/// Width of a picture over two columns, inside the margins.
pub const WIDTH_PT: f32 = 496.0;
/// Width of a picture in one column.
pub const COLUMN_PT: f32 = 232.0;
/// Width of a picture over two columns that keeps a little more air.
pub const TWO_COLUMNS_PT: f32 = 490.0;
/// Size of the names of things in a picture.
pub const NAME_PT: f32 = 10.0;
/// Size of other labels.
pub const LABEL_PT: f32 = 8.0;

/// Makes a figure. What it shows of methods is run here, so the caption can say with which parameters, and
/// where that departs from the methods' papers.
pub struct Maker<'a> {
    /// Colors of pixels.
    pub tint: Tint<'a>,
    runs: RefCell<Vec<Ran>>,
}

/// A run that a figure shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Ran {
    /// Its method.
    pub card: &'static Card,
    /// All parameters.
    pub knobs: Vec<(Knob, KnobValue)>,
    /// Those that have to be given, as the command line takes them.
    pub settings: Vec<(&'static str, String)>,
}

impl<'a> Maker<'a> {
    /// Nothing is run yet.
    pub fn new(tint: Tint<'a>) -> Self {
        Self { tint, runs: RefCell::default() }
    }
    /// A method ready to run on the scene of the figure. Method and settings are those of the figure's own
    /// text, so both exist.
    pub fn ready<S: Methods>(
        &self,
        scene: &Arc<Scene<S>>,
        method: &str,
        pairs: &[(&str, &str)],
    ) -> Box<dyn Run<S>> {
        let entry = S::method(method).expect("figures name methods that exist");
        let run = entry.ready(scene, &Settings::of(pairs), &Quiet).expect("figures use settings that exist");
        let run = run.expect("nobody cancels a figure");
        let knobs = run.knobs();
        let settings = settings_for(entry, &knobs);
        let ran = Ran { card: entry.card(), knobs, settings };
        let mut runs = self.runs.borrow_mut();
        if !runs.contains(&ran) {
            runs.push(ran);
        }
        run
    }
    /// The film of one frame of a method.
    pub fn film<S: Methods>(
        &self,
        scene: &Arc<Scene<S>>,
        view: &View<S>,
        method: &str,
        pairs: &[(&str, &str)],
    ) -> Arc<dyn Film<S>> {
        self.ready(scene, method, pairs).record(view, usize::MAX).film
    }
    /// What was run so far, each once.
    pub fn runs(&self) -> Vec<Ran> {
        self.runs.borrow().clone()
    }
    /// A page around a picture; below the caption stands what was run.
    pub fn page(
        &self,
        paper: Paper,
        title: &str,
        legend: Vec<Entry>,
        caption: impl Into<String>,
        content: &Drawing,
    ) -> Drawing {
        let caption = caption.into() + &self.made();
        Page { paper, title: title.into(), legend, caption, ..Page::default() }.compose(content)
    }
    /// What was run and where it departs from its papers, in sentences.
    fn made(&self) -> String {
        let runs = self.runs.borrow();
        if runs.is_empty() {
            return String::new();
        }
        let words = |ran: &Ran| {
            let settings = ran.settings.iter().map(|(name, value)| format!(" {name}={value}"));
            ran.card.key.to_owned() + &settings.collect::<String>()
        };
        let all: Vec<String> = runs.iter().map(words).collect();
        let mut text = format!(" {}: {}.", if all.len() == 1 { "Run" } else { "Runs" }, all.join("; "));
        for (i, ran) in runs.iter().enumerate() {
            let of_card = || runs.iter().filter(|r| r.card.key == ran.card.key);
            // Once for each method.
            if runs[..i].iter().all(|before| before.card.key != ran.card.key) {
                text +=
                    &departs(ran.card.key, &ran.card.departing(|d| of_card().any(|run| d.holds(&run.knobs))));
            }
        }
        text
    }
}

#[cfg(test)]
impl Maker<'_> {
    /// For tests that do not look at colors.
    pub fn gray() -> Self {
        Self::new(&|_| [0.5; 3])
    }
}

/// A view of a flatland scene: an eye of its file, counted round and round.
pub fn eye(scene: &Scene<Flat>, number: usize) -> View<Flat> {
    let views = &scene.paths()[0].views;
    views[number % views.len()]
}

/// A view in space.
pub fn view(position: Vec3, target: Vec3, fov_degrees: f32, [width, height]: [u32; 2]) -> View<Solid> {
    let eye = Eye { position, target, up: Vec3::Y, fov: fov_degrees.to_radians(), near: 0.05, far: 1000.0 };
    View { eye, width, height }
}

/// The bounds of a flatland scene and the eye, with a little air.
pub fn airy(scene: &Scene<Flat>, eye: Vec2) -> Aabb<Vec2> {
    let b = scene.bounds().with(eye);
    let air = Vec2::splat(b.diagonal() * 0.02);
    Aabb { min: b.min - air, max: b.max + air }
}

/// A step of a flatland film.
pub fn flat_panel(film: &dyn Film<Flat>, step: usize, look: &Look, label: String) -> Panel {
    let stamps = Stamps::new(film);
    let frame = airy(film.scene(), film.view().eye.position);
    Panel { label, picture: Picture::Flat(world(film, &stamps, step, look), frame) }
}

/// An entry of a legend.
pub fn entry(role: Role, swatch: Swatch, label: &str) -> Entry {
    Entry { role, label: label.into(), swatch }
}

/// Sets a name into a picture of space.
pub fn name(world: &mut Drawing<Vec3>, at: Vec3, text: &str) {
    let mark =
        Mark::Text { at, text: text.into(), size_pt: NAME_PT, anchor: Anchor::Middle, font: Font::Bold };
    world.push(Layer::Labels, Role::Ink, Subject::None, mark);
}

/// A flatland picture in world coordinates whose scale on paper is known, so that labels can be set on
/// plates.
pub struct Plan {
    /// The picture.
    pub world: Drawing<Vec2>,
    /// What of the world is shown.
    pub frame: Aabb<Vec2>,
    /// World units a point.
    pub unit: f32,
}

impl Plan {
    /// An empty picture of `frame`, `width_pt` wide on paper.
    pub fn new(frame: Aabb<Vec2>, width_pt: f32) -> Self {
        Self { world: Drawing::default(), frame, unit: frame.size().x / width_pt }
    }
    /// The frame in doubles.
    pub fn wide(&self) -> Aabb<DVec2> {
        Aabb { min: self.frame.min.as_dvec2(), max: self.frame.max.as_dvec2() }
    }
    /// Fills a polygon.
    pub fn area(&mut self, role: Role, points: &[DVec2]) {
        let corners = points.iter().map(|p| p.as_vec2()).collect();
        self.world.push(Layer::Areas, role, Subject::None, Mark::Area(corners));
    }
    /// A line of evidence.
    pub fn line(&mut self, role: Role, a: Vec2, b: Vec2) {
        self.world.line(Layer::Evidence, role, Subject::None, [a, b]);
    }
    /// A dot.
    pub fn dot(&mut self, role: Role, at: Vec2, radius_pt: f32) {
        self.world.push(Layer::Eye, role, Subject::None, Mark::Dot { at, radius_pt });
    }
    /// A label whose middle is `at`, on a piece of paper, moved into the frame.
    pub fn plate(&mut self, at: Vec2, size_pt: f32, font: Font, text: &str) {
        let half = Vec2::new(metrics::width_pt(text, font, size_pt) * 0.5 + 1.5, size_pt * 0.58) * self.unit;
        let at = at.clamp(self.frame.min + half, self.frame.max - half);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| at + Vec2::from(c) * half);
        self.world.push(Layer::Labels, Role::Paper, Subject::None, Mark::Area(corners.to_vec()));
        self.label(at, size_pt, font, text);
    }
    /// A label whose middle is `at`.
    pub fn label(&mut self, at: Vec2, size_pt: f32, font: Font, text: &str) {
        let at = at - Vec2::new(0.0, size_pt * 0.35 * self.unit);
        let mark = Mark::Text { at, text: text.into(), size_pt, anchor: Anchor::Middle, font };
        self.world.push(Layer::Labels, Role::Ink, Subject::None, mark);
    }
    /// A viewpoint with its name.
    pub fn viewpoint(&mut self, at: Vec2, name: &str) {
        self.dot(Role::Eye, at, 3.5);
        let half = metrics::width_pt(name, Font::Bold, NAME_PT) * 0.5;
        self.plate(at + Vec2::new(half + 6.5, -2.0) * self.unit, NAME_PT, Font::Bold, name);
    }
    /// The picture with a label below it.
    pub fn panel(self, label: impl Into<String>) -> Panel {
        Panel { label: label.into(), picture: Picture::Flat(self.world, self.frame) }
    }
}
