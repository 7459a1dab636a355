//! What roles look like: the only place with colors.
//!
//! Hues are those of Okabe and Ito ("Color Universal Design", 2008), which stay apart in all three
//! dichromacies. No state is told by its hue alone: each has a line style, a hatch or a sign of its own as
//! well, so that a gray print and every eye can tell them apart (a test checks both). Nothing means "good" or
//! "bad". Widths and dashes are in points.

use std::borrow::Cow;

use crate::drawing::Role;

pub use super::color_vision::{ColorVision, Rgb};
use super::color_vision::{linear, mix, readable};

/// The ground that a picture is made for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Theme {
    /// The explorer on a light ground.
    #[default]
    Light,
    /// The explorer on a dark ground.
    Dark,
    /// White paper, black ink.
    Print,
}

/// A theme as certain eyes see it; readers of drawings take one (or a plain [`Theme`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Look {
    /// The ground.
    pub theme: Theme,
    /// The eyes.
    pub vision: ColorVision,
}

impl From<Theme> for Look {
    fn from(theme: Theme) -> Self {
        Look { theme, vision: ColorVision::Full }
    }
}

/// A pattern over the inside of an area.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hatch {
    /// None.
    None,
    /// Parallel lines that rise to the right.
    Diagonal,
    /// Parallel lines that fall to the right.
    Falling,
    /// Lines in both directions.
    Cross,
    /// A grid of dots.
    Dots,
}

/// How the marks of a role are painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Color of lines and outlines, of hatches and of dots.
    pub stroke: Rgb,
    /// Width of lines and outlines.
    pub width_pt: f32,
    /// Lengths of dashes and gaps in turn; empty for a solid line.
    pub dash: &'static [f32],
    /// Color and opacity of the inside of areas; `None` leaves it empty.
    pub fill: Option<(Rgb, f32)>,
    /// Pattern over the inside.
    pub hatch: Hatch,
    /// Color and width of a band under the lines and around dots.
    pub halo: Option<(Rgb, f32)>,
    /// A character set over areas, lines and dots, and its color.
    pub sign: Option<(char, Rgb)>,
    /// Inside of dots: the stroke's color, or the paper's for hollow dots.
    pub dot: Rgb,
    /// Color of text; readable on the paper.
    pub text: Rgb,
}

/// Distance between the lines of a hatch.
pub const HATCH_PT: f32 = 3.6;
/// Width of the lines of a hatch; dots are twice as thick.
pub const HATCH_WIDTH_PT: f32 = 0.5;
/// Size of a role's sign.
pub const SIGN_PT: f32 = 9.0;

const BLACK: Rgb = [0, 0, 0];
const WHITE: Rgb = [255, 255, 255];
const ORANGE: Rgb = [230, 159, 0];
const GREEN: Rgb = [0, 158, 115];
const YELLOW: Rgb = [240, 228, 66];
const BLUE: Rgb = [0, 114, 178];
const VERMILLION: Rgb = [213, 94, 0];
const BROWN: Rgb = [150, 110, 70];
const PURPLE: Rgb = [204, 121, 167];

const SOLID: &[f32] = &[];
const DASHED: &[f32] = &[5.0, 2.5];
const DOTTED: &[f32] = &[0.9, 2.1];
const DASH_DOT: &[f32] = &[7.0, 2.0, 1.2, 2.0];
const DASH_DOTS: &[f32] = &[3.6, 1.5, 0.9, 1.5, 0.9, 1.5];
const LONG: &[f32] = &[9.0, 1.8];
const SHORT: &[f32] = &[2.4, 2.4];

/// The few colors that a theme is mixed from.
struct Base {
    paper: Rgb,
    ink: Rgb,
    /// Lines inside a halo.
    core: Rgb,
    faint: Rgb,
    scene: Rgb,
    outside: Rgb,
    blue: Rgb,
    sky: Rgb,
    orange: Rgb,
    green: Rgb,
    yellow: Rgb,
    vermillion: Rgb,
    purple: Rgb,
}

impl Theme {
    /// Every theme, in the order of menus.
    pub const ALL: [Theme; 3] = [Theme::Light, Theme::Dark, Theme::Print];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Theme::Light => "light",
            Theme::Dark => "dark",
            Theme::Print => "print",
        }
    }

    fn base(self) -> Base {
        // Orange and purple are a little deeper than Okabe and Ito's on light grounds, blue and vermillion
        // lighter on dark ones: a thin line needs a contrast of 2 to be seen at all.
        let light = Base {
            paper: [252, 252, 251],
            ink: [28, 28, 30],
            core: [28, 28, 30],
            faint: [118, 118, 122],
            scene: [96, 100, 106],
            outside: [138, 138, 138],
            blue: BLUE,
            sky: [52, 148, 206],
            orange: [214, 140, 0],
            green: GREEN,
            yellow: YELLOW,
            vermillion: VERMILLION,
            purple: [178, 88, 140],
        };
        match self {
            Theme::Light => light,
            Theme::Print => Base {
                paper: WHITE,
                ink: BLACK,
                core: BLACK,
                faint: [96, 96, 96],
                scene: [80, 80, 80],
                outside: [128, 128, 128],
                ..light
            },
            Theme::Dark => Base {
                paper: [27, 29, 33],
                ink: [232, 232, 235],
                core: [20, 20, 24],
                faint: [150, 152, 158],
                scene: [158, 163, 172],
                outside: [128, 130, 136],
                blue: [74, 163, 223],
                sky: [138, 204, 244],
                orange: ORANGE,
                green: [50, 190, 148],
                yellow: YELLOW,
                vermillion: [240, 122, 40],
                purple: PURPLE,
            },
        }
    }

    /// Color of the paper.
    pub fn paper(self) -> Rgb {
        self.base().paper
    }

    /// How the marks of a role are painted.
    pub fn style(self, role: Role) -> Style {
        let b = self.base();
        let plain = |stroke: Rgb, width_pt: f32| Style {
            stroke,
            width_pt,
            dash: SOLID,
            fill: None,
            hatch: Hatch::None,
            halo: None,
            sign: None,
            dot: stroke,
            text: readable(stroke, b.ink, b.paper, 4.5),
        };
        match role {
            Role::Ink => Style { fill: Some((b.ink, 0.06)), ..plain(b.ink, 0.75) },
            Role::Faint => Style { fill: Some((b.faint, 0.08)), ..plain(mix(b.faint, b.paper, 0.35), 0.5) }
                .with_text(b.faint, &b),
            Role::Scene => Style { fill: Some((b.scene, 0.14)), ..plain(b.scene, 0.9) },
            Role::Undecided => Style { fill: Some((b.paper, 1.0)), dot: b.paper, ..plain(b.ink, 0.5) },
            Role::Partial => {
                Style { dash: LONG, fill: Some((b.sky, 0.10)), dot: b.paper, ..plain(b.sky, 0.9) }
            }
            Role::Visible => Style { fill: Some((b.blue, 0.45)), ..plain(b.blue, 1.3) },
            Role::Hidden => Style {
                dash: DASHED,
                hatch: Hatch::Diagonal,
                fill: Some((b.orange, 0.16)),
                ..plain(b.orange, 1.1)
            },
            Role::Outside => Style { dash: DOTTED, dot: b.paper, ..plain(b.outside, 0.9) },
            Role::FacesAway => Style {
                dash: SHORT,
                hatch: Hatch::Falling,
                dot: b.paper,
                ..plain(mix(BROWN, b.ink, 0.2), 0.9)
            },
            Role::Occluder => Style { fill: Some((b.ink, 0.62)), ..plain(b.ink, 3.2) },
            Role::Approximated => Style {
                dash: DASH_DOTS,
                hatch: Hatch::Cross,
                fill: Some((b.purple, 0.12)),
                ..plain(b.purple, 1.1)
            },
            Role::Wrong => Style {
                sign: Some(('!', b.ink)),
                fill: Some((b.vermillion, 0.40)),
                ..plain(b.vermillion, 2.0)
            },
            Role::Current => Style {
                halo: Some((b.yellow, 5.0)),
                fill: Some((b.yellow, 0.25)),
                text: b.ink,
                ..plain(b.core, 1.1)
            },
            Role::Selected => {
                Style { halo: Some((b.sky, 4.0)), dash: &[3.0, 1.5], text: b.ink, ..plain(b.core, 1.3) }
            }
            Role::Eye => Style { fill: Some((b.green, 0.10)), ..plain(b.green, 1.3) },
            Role::Evidence => Style {
                dash: DASH_DOT,
                fill: Some((b.purple, 0.10)),
                ..plain(mix(b.purple, b.ink, 0.35), 1.0)
            },
            Role::Paper => Style { fill: Some((b.paper, 1.0)), text: b.ink, ..plain(b.paper, 0.75) },
        }
    }

    /// Opaque color of a role for surfaces in space and for shaders; shading may darken it to a half.
    pub fn flat(self, role: Role) -> Rgb {
        let b = self.base();
        match role {
            Role::Ink | Role::Occluder => mix(b.ink, b.paper, 0.18),
            Role::Faint | Role::Outside => mix(b.outside, b.paper, 0.45),
            Role::FacesAway => mix(BROWN, b.ink, 0.2),
            Role::Scene => mix(b.scene, b.paper, 0.35),
            Role::Undecided => mix(b.paper, b.ink, 0.06),
            Role::Partial => b.sky,
            Role::Visible => b.blue,
            Role::Hidden => ORANGE,
            Role::Approximated => b.purple,
            Role::Wrong => VERMILLION,
            Role::Current => b.yellow,
            Role::Selected | Role::Eye => b.green,
            Role::Evidence => mix(b.purple, b.ink, 0.35),
            Role::Paper => b.paper,
        }
    }

    /// The [`flat`](Self::flat) color in linear light, for shaders.
    pub fn flat_linear(self, role: Role) -> [f32; 3] {
        linear(self.flat(role))
    }

    /// The `i`th color of a chart's lines; they repeat after seven, so charts vary the line style too.
    pub fn series(self, i: usize) -> Rgb {
        let b = self.base();
        [b.blue, b.orange, b.green, b.purple, b.vermillion, b.sky, b.ink][i % 7]
    }

    /// Colors of panels and widgets.
    pub fn panel(self) -> Panel {
        let b = self.base();
        let accent = readable(b.blue, b.ink, b.paper, 4.5);
        Panel {
            ground: if self == Theme::Dark { [34, 36, 41] } else { [243, 243, 242] },
            raised: if self == Theme::Dark { [52, 55, 62] } else { [228, 229, 230] },
            canvas: b.paper,
            border: mix(b.ink, b.paper, 0.8),
            text: b.ink,
            text_faint: readable(b.faint, b.ink, b.paper, 5.5),
            accent,
            selection: mix(b.blue, b.paper, 0.65),
            lit_line: mix(b.yellow, b.paper, if self == Theme::Dark { 0.72 } else { 0.45 }),
            warning: readable(b.orange, b.ink, b.paper, 5.0),
            error: readable(b.vermillion, b.ink, b.paper, 5.0),
        }
    }
}

/// Colors of panels and widgets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Ground of panels.
    pub ground: Rgb,
    /// Buttons, fields, headers.
    pub raised: Rgb,
    /// Ground of pictures and text editors.
    pub canvas: Rgb,
    /// Separators.
    pub border: Rgb,
    /// Text.
    pub text: Rgb,
    /// Secondary text.
    pub text_faint: Rgb,
    /// Links, focus, the position of the timeline.
    pub accent: Rgb,
    /// Ground of selected rows and text.
    pub selection: Rgb,
    /// Ground of the current line of pseudocode and of the current row.
    pub lit_line: Rgb,
    /// Text of warnings.
    pub warning: Rgb,
    /// Text of errors.
    pub error: Rgb,
}

impl Style {
    fn with_text(self, color: Rgb, base: &Base) -> Style {
        Style { text: readable(color, base.ink, base.paper, 4.5), ..self }
    }
}

impl Look {
    /// How the marks of a role are painted.
    pub fn style(self, role: Role) -> Style {
        let style = self.theme.style(role);
        let see = |c| self.vision.see(c);
        Style {
            stroke: see(style.stroke),
            fill: style.fill.map(|(c, a)| (see(c), a)),
            halo: style.halo.map(|(c, w)| (see(c), w)),
            sign: style.sign.map(|(sign, c)| (sign, see(c))),
            dot: see(style.dot),
            text: see(style.text),
            ..style
        }
    }

    /// The styles of all roles, for readers of many marks; `styles[role as usize]`.
    pub fn styles(self) -> [Style; Role::ALL.len()] {
        Role::ALL.map(|role| self.style(role))
    }

    /// Color of the paper.
    pub fn paper(self) -> Rgb {
        self.vision.see(self.theme.paper())
    }

    /// The pixels of a picture (RGBA) as they are seen.
    pub fn see(self, rgba: &[u8]) -> Cow<'_, [u8]> {
        if self.vision == ColorVision::Full {
            return Cow::Borrowed(rgba);
        }
        let seen = |p: &[u8]| {
            let [r, g, b] = self.vision.see([p[0], p[1], p[2]]);
            [r, g, b, p[3]]
        };
        Cow::Owned(rgba.chunks_exact(4).flat_map(seen).collect())
    }

    /// Opaque color of a role for surfaces in space.
    pub fn flat(self, role: Role) -> Rgb {
        self.vision.see(self.theme.flat(role))
    }
}

#[cfg(test)]
mod tests {
    use super::super::color_vision::{contrast, difference};
    use super::*;

    fn pairs() -> impl Iterator<Item = (Role, Role)> {
        Role::STATES.iter().enumerate().flat_map(|(i, a)| Role::STATES[i + 1..].iter().map(|b| (*a, *b)))
    }

    /// Whether lines and areas of two styles differ by more than hue: dash, sign, halo, or a width that the
    /// eye takes for another one (by 0.7 pt and by half). Hatches do not count, as lines have none.
    fn differ_in_form(a: &Style, b: &Style) -> bool {
        let (thin, thick) = (a.width_pt.min(b.width_pt), a.width_pt.max(b.width_pt));
        a.dash != b.dash
            || a.sign.map(|s| s.0) != b.sign.map(|s| s.0)
            || a.halo.is_some() != b.halo.is_some()
            || (thick - thin >= 0.7 && thick >= 1.5 * thin)
    }

    #[test]
    fn styles_are_found_by_role() {
        let look = Look::from(Theme::Dark);
        let styles = look.styles();
        assert!(Role::ALL.iter().all(|role| styles[*role as usize] == look.style(*role)));
    }

    #[test]
    fn states_differ_in_form() {
        for theme in Theme::ALL {
            for (a, b) in pairs() {
                assert!(
                    differ_in_form(&theme.style(a), &theme.style(b)),
                    "{theme:?}: {a:?} and {b:?} differ by hue only"
                );
            }
        }
    }

    #[test]
    fn states_differ_in_color_for_every_eye() {
        for theme in Theme::ALL {
            for vision in ColorVision::ALL {
                for (a, b) in pairs() {
                    let look = Look { theme, vision };
                    let (p, q) = (look.style(a), look.style(b));
                    let apart = difference(p.stroke, q.stroke) >= 12.0;
                    assert!(
                        apart || differ_in_form(&p, &q),
                        "{look:?}: {a:?} and {b:?}: {}",
                        difference(p.stroke, q.stroke)
                    );
                    assert!(
                        vision != ColorVision::Full
                            || difference(p.stroke, q.stroke) >= 12.0
                            || (a, b) == (Role::Undecided, Role::Occluder)
                    );
                }
            }
        }
    }

    #[test]
    fn flat_colors_differ_for_every_eye_with_color() {
        for theme in Theme::ALL {
            for vision in [
                ColorVision::Full,
                ColorVision::Protanopia,
                ColorVision::Deuteranopia,
                ColorVision::Tritanopia,
            ] {
                for (a, b) in pairs() {
                    let look = Look { theme, vision };
                    let d = difference(look.flat(a), look.flat(b));
                    assert!(d >= 12.0, "{look:?}: {a:?} and {b:?}: {d}");
                }
            }
        }
    }

    #[test]
    fn lines_are_seen_and_text_is_read() {
        for theme in Theme::ALL {
            for role in Role::ALL {
                let (style, paper) = (theme.style(role), theme.paper());
                assert!(
                    contrast(style.text, paper) >= 4.5,
                    "{theme:?} {role:?} text {}",
                    contrast(style.text, paper)
                );
                let line = contrast(style.halo.map_or(style.stroke, |h| h.0), paper)
                    .max(contrast(style.stroke, paper));
                assert!(
                    role == Role::Paper || line >= if role == Role::Faint { 1.7 } else { 2.5 },
                    "{theme:?} {role:?} line {line}"
                );
            }
            let p = theme.panel();
            for (text, ground) in [
                (p.text, p.ground),
                (p.text_faint, p.ground),
                (p.error, p.ground),
                (p.warning, p.ground),
                (p.text, p.raised),
                (p.text, p.selection),
                (p.text, p.lit_line),
                (p.accent, p.canvas),
            ] {
                assert!(
                    contrast(text, ground) >= 4.5,
                    "{theme:?} {text:?} on {ground:?}: {}",
                    contrast(text, ground)
                );
            }
        }
    }
}
