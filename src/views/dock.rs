//! Panels and where they stand.

use eframe::egui;
use egui_tiles::{Container, Linear, LinearDir, SimplificationOptions, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

use super::cache::Cache;
use super::space::Tools;
use super::{
    Answers, canvas, code, events, inspector, objects, parameters, pictures, pixel, space, strip, timeline,
    why,
};
use crate::app::{Layout, State};
use crate::geometry::Either;

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Pane {
    /// The event tree.
    Events,
    /// What the Eye sees.
    Eye,
    /// What the Observer sees.
    Observer,
    /// Why the selected thing has its state.
    Why,
    /// The current event and the selected thing.
    Inspector,
    /// The method and its parameters.
    Parameters,
    /// The film.
    Timeline,
    /// The pseudocode.
    Code,
    /// The method's own pictures.
    Pictures,
    /// The objects of the scene.
    Objects,
    /// The history of a pixel.
    Pixel,
}

impl Pane {
    /// Its title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Events => "Events",
            Self::Eye => "Eye view",
            Self::Observer => "Observer view",
            Self::Why => "Why",
            Self::Inspector => "Inspector",
            Self::Parameters => "Parameters",
            Self::Timeline => "Timeline",
            Self::Code => "Pseudocode",
            Self::Pictures => "Pictures",
            Self::Objects => "Objects",
            Self::Pixel => "Pixel",
        }
    }
    const ALL: [Pane; 11] = [
        Self::Events,
        Self::Eye,
        Self::Observer,
        Self::Why,
        Self::Inspector,
        Self::Parameters,
        Self::Timeline,
        Self::Code,
        Self::Pictures,
        Self::Objects,
        Self::Pixel,
    ];
}

/// The panels of a layout.
pub fn tree(layout: Layout) -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let root = match layout {
        Layout::Debug => debug(&mut tiles),
        Layout::Lecture => {
            let [eye, observer, code] = [Pane::Eye, Pane::Observer, Pane::Code].map(|p| tiles.insert_pane(p));
            let right = linear(&mut tiles, LinearDir::Vertical, &[(eye, 1.0), (code, 1.2)]);
            linear(&mut tiles, LinearDir::Horizontal, &[(observer, 2.0), (right, 1.0)])
        }
        Layout::Figure => tiles.insert_pane(Pane::Observer),
        Layout::Pictures => {
            let [observer, pictures, timeline, code] =
                [Pane::Observer, Pane::Pictures, Pane::Timeline, Pane::Code].map(|p| tiles.insert_pane(p));
            let left =
                linear(&mut tiles, LinearDir::Vertical, &[(observer, 1.6), (code, 1.3), (timeline, 0.8)]);
            linear(&mut tiles, LinearDir::Horizontal, &[(left, 1.0), (pictures, 1.5)])
        }
    };
    Tree::new(egui::Id::unique("panels"), root, tiles)
}

fn debug(tiles: &mut Tiles<Pane>) -> TileId {
    let [events, eye, observer, why, inspector, parameters, timeline, code, own, objects, pixel] =
        Pane::ALL.map(|p| tiles.insert_pane(p));
    let eye = tiles.insert_tab_tile(vec![eye, own]);
    let events = tiles.insert_tab_tile(vec![events, objects]);
    let inspector = tiles.insert_tab_tile(vec![inspector, pixel]);
    let pictures = linear(tiles, LinearDir::Horizontal, &[(eye, 1.0), (observer, 1.25)]);
    let side = linear(tiles, LinearDir::Vertical, &[(why, 1.5), (inspector, 1.0), (parameters, 1.0)]);
    let below = linear(tiles, LinearDir::Horizontal, &[(timeline, 1.3), (code, 1.0)]);
    let middle = linear(tiles, LinearDir::Vertical, &[(pictures, 2.1), (below, 1.0)]);
    linear(tiles, LinearDir::Horizontal, &[(events, 0.95), (middle, 3.0), (side, 1.0)])
}

fn linear(tiles: &mut Tiles<Pane>, dir: LinearDir, parts: &[(TileId, f32)]) -> TileId {
    let mut linear = Linear::new(dir, parts.iter().map(|p| p.0).collect());
    parts.iter().for_each(|(id, share)| linear.shares.set_share(*id, *share));
    tiles.insert_new(egui_tiles::Tile::Container(Container::Linear(linear)))
}

/// Whether a saved tree can be shown: every panel at most once, a root that is there, a picture among them.
pub fn is_sound(tree: &Tree<Pane>) -> bool {
    let mut panes: Vec<Pane> = tree
        .tiles
        .tiles()
        .filter_map(|t| if let egui_tiles::Tile::Pane(p) = t { Some(*p) } else { None })
        .collect();
    let count = panes.len();
    panes.sort_unstable();
    panes.dedup();
    panes.len() == count
        && panes.contains(&Pane::Observer)
        && tree.root.is_some_and(|r| tree.tiles.get(r).is_some())
}

/// Brings a panel to the front of those in its place; returns whether the layout has it.
pub fn bring(tree: &mut Tree<Pane>, pane: Pane) -> bool {
    tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(other) if *other == pane))
}

/// The panel that stands where `pane` does: swapped views stand in each other's place.
fn seen(state: &State, pane: Pane) -> Pane {
    match (pane, state.is_swapped) {
        (Pane::Eye, true) => Pane::Observer,
        (Pane::Observer, true) => Pane::Eye,
        (other, _) => other,
    }
}

/// Shows the panels.
pub struct Dock<'a> {
    /// What is shown.
    pub state: &'a State,
    /// What only the screen needs.
    pub cache: &'a mut Cache,
    /// What is asked.
    pub answers: &'a mut Answers,
    /// The graphics card.
    pub gpu: Option<&'a eframe::egui_wgpu::RenderState>,
}

impl egui_tiles::Behavior<Pane> for Dock<'_> {
    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        seen(self.state, *pane).title().into()
    }
    fn pane_ui(&mut self, ui: &mut egui::Ui, _: TileId, pane: &mut Pane) -> UiResponse {
        let pane = seen(self.state, *pane);
        let (state, cache, answers) = (self.state, &mut *self.cache, &mut *self.answers);
        ui.push_id(pane as u8, |ui| match pane {
            Pane::Eye | Pane::Observer => match &state.stage {
                Some(Either::Flat(stage)) if pane == Pane::Observer => {
                    canvas::show(state, stage, &mut cache.world, &mut cache.hand, ui, answers)
                }
                Some(Either::Flat(stage)) => {
                    strip::show(state, stage, &mut cache.image, &mut cache.hand, ui, answers)
                }
                Some(Either::Solid(stage)) => {
                    let tools = Tools { gpu: self.gpu, uploaded: &mut cache.uploaded, hand: &mut cache.hand };
                    space::show(state, stage, pane == Pane::Eye, tools, ui, answers)
                }
                None => {}
            },
            _ => {
                egui::Frame::NONE.inner_margin(egui::Margin::symmetric(8, 4)).show(ui, |ui| match pane {
                    Pane::Events => events::show(state, &mut cache.scroll, ui, answers),
                    Pane::Objects => objects::show(state, &mut cache.objects, ui, answers),
                    Pane::Pixel => pixel::show(state, ui, answers),
                    Pane::Why => why::show(state, ui, answers),
                    Pane::Inspector => inspector::show(state, ui, answers),
                    Pane::Parameters => parameters::show(state, &mut cache.hand.gesture, ui, answers),
                    Pane::Timeline => timeline::show(state, &mut cache.timeline, ui, answers),
                    Pane::Pictures => pictures::show(state, &mut cache.picture, ui, answers),
                    _ => code::show(state, &mut cache.code, ui, answers),
                });
            }
        });
        UiResponse::None
    }
    fn simplification_options(&self) -> SimplificationOptions {
        // Every panel keeps a title that it can be moved by.
        SimplificationOptions { all_panes_must_have_tabs: true, ..Default::default() }
    }
    fn tab_bar_height(&self, style: &egui::Style) -> f32 {
        style.spacing.interact_size.y + 4.0
    }
    fn tab_bar_color(&self, visuals: &egui::Visuals) -> egui::Color32 {
        visuals.widgets.inactive.bg_fill
    }
    fn tab_text_color(
        &self,
        visuals: &egui::Visuals,
        _: &Tiles<Pane>,
        _: TileId,
        state: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if state.active { visuals.text_color() } else { visuals.weak_text_color() }
    }
    fn gap_width(&self, _: &egui::Style) -> f32 {
        3.0
    }
    fn min_size(&self) -> f32 {
        90.0
    }
}
