//! The theme's colors as egui knows them.

use eframe::egui::{Color32, Context, Style, Theme as EguiTheme};

use crate::app::State;
use crate::drawing::Role;
use crate::render::screen::{color, visuals};

/// Colors of panels.
pub struct PanelColors {
    /// Ground of pictures.
    pub canvas: Color32,
    /// Ground of the current line and row.
    pub lit_line: Color32,
    /// The position of the timeline, links.
    pub accent: Color32,
    /// Text.
    pub text: Color32,
    /// Secondary text.
    pub faint: Color32,
    /// Borders.
    pub border: Color32,
}

/// Colors of panels in the present theme.
pub fn panel(state: &State) -> PanelColors {
    let p = state.shown.theme.panel();
    PanelColors {
        canvas: color(p.canvas),
        lit_line: color(p.lit_line),
        accent: color(p.accent),
        text: color(p.text),
        faint: color(p.text_faint),
        border: color(p.border),
    }
}

/// The stroke color of a role in the present theme.
pub fn role(state: &State, role: Role) -> Color32 {
    color(state.shown.theme.style(role).stroke)
}

/// The color of the band around the marks of a role, or that of its lines if it has none.
pub fn halo(state: &State, role: Role) -> Color32 {
    let style = state.shown.theme.style(role);
    color(style.halo.map_or(style.stroke, |(halo, _)| halo))
}

/// Dresses egui in the theme; large type for a room.
pub fn dress(ctx: &Context, state: &State, is_large: bool) {
    let base = if state.shown.theme == crate::app::Theme::Dark { EguiTheme::Dark } else { EguiTheme::Light };
    ctx.set_theme(base);
    let mut style = Style { visuals: visuals(state.shown.theme), ..Style::default() };
    style.spacing.item_spacing = eframe::egui::vec2(6.0, 4.0);
    style.url_in_tooltip = true;
    // A menu is as high as it needs; it scrolls at the window's edge.
    style.spacing.default_area_size.y = f32::INFINITY;
    // Moves of a step are not smoothed: nothing slides that a person did not move.
    style.animation_time = 0.0;
    if is_large {
        for font in style.text_styles.values_mut() {
            font.size *= 1.35;
        }
    }
    ctx.set_style_of(base, style);
}
