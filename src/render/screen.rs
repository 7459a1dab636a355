//! Drawings on an egui painter: the same pieces as in files, in our fonts.
//!
//! Cost: marks outside the clip rectangle cost a bounding box; ten thousand marks fit into a frame. Picture
//! marks become textures (nearest filter), kept while they are shown.

use std::collections::BTreeMap;
use std::sync::Arc;

use eframe::egui::epaint::{CircleShape, Mesh, PathShape, PathStroke, TextShape};
use eframe::egui::{
    self, Color32, ColorImage, FontData, FontDefinitions, FontFamily, FontId, Pos2, Rect, Shape, Stroke,
    TextureHandle, TextureOptions,
};
use glam::{Vec2, vec2};

use crate::drawing::{Drawing, Font, Pixels, metrics};

use super::hatch::hatching;
use super::piece::{self, Line, Paint, Piece};
use super::theme::{ColorVision, HATCH_PT, HATCH_WIDTH_PT, Hatch, Look, Rgb, Theme};

/// A color of the theme for egui.
pub fn color([r, g, b]: Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}

fn color_with([r, g, b]: Rgb, alpha: f32) -> Color32 {
    Color32::from_rgba_unmultiplied(r, g, b, (alpha.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// The egui family of one of our fonts; [`install_fonts`] must have run.
pub fn family(font: Font) -> FontFamily {
    FontFamily::Name(format!("cullscope-{}", font.name()).into())
}

/// Registers our three fonts as families of their own and as egui's proportional and monospace fonts; egui's
/// stay behind them for icons.
pub fn install_fonts(ctx: &egui::Context) {
    let mut fonts = FontDefinitions::default();
    for font in Font::ALL {
        let name = format!("cullscope-{}", font.name());
        fonts.font_data.insert(name.clone(), Arc::new(FontData::from_static(metrics::font_bytes(font))));
        let general = if font == Font::Mono { FontFamily::Monospace } else { FontFamily::Proportional };
        let mut names = vec![name.clone()];
        names.extend(
            fonts
                .families
                .get(&general)
                .into_iter()
                .flatten()
                .filter(|n| !n.starts_with("cullscope-"))
                .cloned(),
        );
        if font != Font::Bold {
            fonts.families.insert(general, names.clone());
        }
        fonts.families.insert(family(font), names);
    }
    ctx.set_fonts(fonts);
}

/// Colors of egui's widgets for a theme.
pub fn visuals(theme: Theme) -> egui::Visuals {
    let panel = theme.panel();
    let mut v = if theme == Theme::Dark { egui::Visuals::dark() } else { egui::Visuals::light() };
    let (text, border) = (color(panel.text), Stroke::new(1.0, color(panel.border)));
    v.panel_fill = color(panel.ground);
    v.window_fill = color(panel.ground);
    v.window_stroke = border;
    v.extreme_bg_color = color(panel.canvas);
    v.text_edit_bg_color = Some(color(panel.canvas));
    v.faint_bg_color = color(panel.raised).gamma_multiply(0.5);
    v.code_bg_color = color(panel.raised);
    v.hyperlink_color = color(panel.accent);
    v.warn_fg_color = color(panel.warning);
    v.error_fg_color = color(panel.error);
    v.weak_text_color = Some(color(panel.text_faint));
    v.selection.bg_fill = color(panel.selection);
    v.selection.stroke = Stroke::new(1.0, text);
    for (widget, raised) in [
        (&mut v.widgets.noninteractive, false),
        (&mut v.widgets.inactive, true),
        (&mut v.widgets.hovered, true),
        (&mut v.widgets.active, true),
        (&mut v.widgets.open, true),
    ] {
        widget.fg_stroke = Stroke::new(widget.fg_stroke.width, text);
        if raised {
            widget.bg_fill = color(panel.raised);
            widget.weak_bg_fill = color(panel.raised);
        }
    }
    v.widgets.noninteractive.bg_stroke = border;
    v.widgets.hovered.bg_stroke = Stroke::new(1.0, color(panel.accent));
    v.widgets.active.bg_stroke = Stroke::new(1.5, color(panel.accent));
    v
}

/// Paints the paper of a drawing of that size.
pub fn paint_paper(painter: &egui::Painter, size_pt: Vec2, look: impl Into<Look>, origin: Pos2, scale: f32) {
    let size = egui::vec2(size_pt.x, size_pt.y) * scale;
    painter.rect_filled(Rect::from_min_size(origin, size), 0.0, color(look.into().paper()));
}

/// Paints a drawing so that its paper's corner is at `origin` and a point of 1/72 inch is `scale` points of
/// egui.
pub fn paint(painter: &egui::Painter, drawing: &Drawing, look: impl Into<Look>, origin: Pos2, scale: f32) {
    let scale = if scale.is_finite() { scale.max(1e-3) } else { return };
    let look = look.into();
    let clip = painter.clip_rect();
    let window = [clip.min, clip.max].map(|p| vec2(p.x - origin.x, p.y - origin.y) / scale);
    if !painter.is_visible() || !clip.is_positive() || !window.iter().all(|p| p.is_finite()) {
        return;
    }
    let own = family(Font::Regular);
    let installed = painter.fonts(|f| f.definitions().families.contains_key(&own));
    let families = Font::ALL.map(|f| match (installed, f) {
        (true, _) => family(f),
        (false, Font::Mono) => FontFamily::Monospace,
        (false, _) => FontFamily::Proportional,
    });
    let mut screen =
        Screen { painter, vision: look.vision, origin, scale, window, families, shapes: Vec::new() };
    piece::each_piece(drawing, look, |_, piece, paint| screen.piece(piece, paint));
    painter.extend(screen.shapes);
}

struct Screen<'a> {
    painter: &'a egui::Painter,
    vision: ColorVision,
    origin: Pos2,
    scale: f32,
    /// What is seen of the paper: minimum and maximum.
    window: [Vec2; 2],
    families: [FontFamily; 3],
    shapes: Vec<Shape>,
}

impl Screen<'_> {
    fn at(&self, p: Vec2) -> Pos2 {
        self.origin + egui::vec2(p.x, p.y) * self.scale
    }

    fn seen(&self, min: Vec2, max: Vec2) -> bool {
        // Wide enough for every halo and outline.
        let margin = 8.0;
        let [low, high] = self.window;
        (max + margin).cmpge(low).all() && (min - margin).cmple(high).all()
    }

    fn piece(&mut self, piece: &Piece, paint: &Paint) {
        match &piece.shape {
            piece::Shape::Path { points, closed } => {
                let (min, max) = points
                    .iter()
                    .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
                if self.seen(min, max) {
                    self.path(points, *closed, paint);
                }
            }
            piece::Shape::Circle { at, radius_pt } => {
                if self.seen(*at - *radius_pt, *at + *radius_pt) {
                    self.circle(self.at(*at), radius_pt * self.scale, paint);
                }
            }
            piece::Shape::Text(line) => {
                let [min, max] = metrics::text_box(line.at, line.text, line.font, line.size_pt, line.anchor);
                if self.seen(min, max) {
                    self.text(
                        line,
                        paint.fill.map_or(Color32::PLACEHOLDER, |(c, alpha)| color_with(c, alpha)),
                    );
                }
            }
            piece::Shape::Image { min, max, pixels } => {
                if self.seen(*min, *max) {
                    self.image(Rect::from_min_max(self.at(*min), self.at(*max)), pixels);
                }
            }
        }
    }

    fn path(&mut self, points: &[Vec2], closed: bool, paint: &Paint) {
        // There and back: egui would make nothing of two corners of 180 degrees.
        let closed = closed && points.len() > 2;
        if let Some((fill, alpha)) = paint.fill {
            let polygon = points.iter().map(|p| self.at(*p)).collect();
            self.shapes.push(Shape::convex_polygon(polygon, color_with(fill, alpha), PathStroke::NONE));
        }
        if let Some((hatch, stroke)) = paint.hatch {
            self.hatch(points, hatch, stroke);
        }
        let Some(stroke) = &paint.stroke else { return };
        let line = Stroke::new(stroke.width_pt * self.scale, color(stroke.color));
        if stroke.dash.is_empty() {
            let points = points.iter().map(|p| self.at(*p)).collect();
            let path =
                if closed { PathShape::closed_line(points, line) } else { PathShape::line(points, line) };
            self.shapes.push(path.into());
            return;
        }
        let mut mesh = Mesh::default();
        for_each_dash(points, closed, stroke.dash, self.window, |a, b| {
            add_quad(&mut mesh, self.at(a), self.at(b), line)
        });
        self.shapes.push(mesh.into());
    }

    fn circle(&mut self, center: Pos2, radius: f32, paint: &Paint) {
        if let Some((fill, alpha)) = paint.fill {
            self.shapes.push(CircleShape::filled(center, radius, color_with(fill, alpha)).into());
        }
        let Some(stroke) = &paint.stroke else { return };
        // egui strokes the outside of a circle, files its rim.
        let (width, color) = (stroke.width_pt * self.scale, color(stroke.color));
        let inner = radius - width / 2.0;
        let shape = if inner > 0.0 {
            CircleShape::stroke(center, inner, Stroke::new(width, color))
        } else {
            CircleShape::filled(center, radius + width / 2.0, color)
        };
        self.shapes.push(shape.into());
    }

    fn hatch(&mut self, points: &[Vec2], hatch: Hatch, stroke: Rgb) {
        // Zoomed far out, a hatch is a tint.
        if HATCH_PT * self.scale < 1.5 {
            let polygon = points.iter().map(|p| self.at(*p)).collect();
            self.shapes.push(Shape::convex_polygon(
                polygon,
                color_with(stroke, HATCH_WIDTH_PT / HATCH_PT),
                PathStroke::NONE,
            ));
            return;
        }
        let found = hatching(points, hatch, self.window);
        let line = Stroke::new((HATCH_WIDTH_PT * self.scale).max(0.5), color(stroke));
        let mut mesh = Mesh::default();
        for [a, b] in found.lines {
            add_quad(&mut mesh, self.at(a), self.at(b), line);
        }
        for at in found.dots {
            let (center, r) = (self.at(at), HATCH_WIDTH_PT * self.scale);
            add_quad(
                &mut mesh,
                center - egui::vec2(r, 0.0),
                center + egui::vec2(r, 0.0),
                Stroke::new(2.0 * r, line.color),
            );
        }
        self.shapes.push(mesh.into());
    }

    fn text(&mut self, line: &Line, color: Color32) {
        // Quarters of a point keep the atlas of glyphs small while a picture is zoomed.
        let size = (line.size_pt * self.scale * 4.0).round().max(4.0) / 4.0;
        if size > 400.0 {
            return;
        }
        let font = FontId::new(size, self.families[line.font as usize].clone());
        let galley = self.painter.layout_no_wrap(line.text.to_owned(), font, color);
        let Some(baseline) =
            galley.rows.first().and_then(|row| Some(row.pos.y + row.row.glyphs.first()?.pos.y))
        else {
            return;
        };
        let start = metrics::start_pt(line.at.x, line.text, line.font, line.size_pt, line.anchor);
        let corner = self.at(vec2(start, line.at.y)) - egui::vec2(0.0, baseline);
        self.shapes.push(TextShape::new(corner, galley, color).into());
    }

    fn image(&mut self, rect: Rect, pixels: &Pixels) {
        let texture = texture(self.painter.ctx(), pixels, self.vision);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        self.shapes.push(Shape::image(texture, rect, whole, Color32::WHITE));
    }
}

/// A line as two triangles with soft edges; cheaper than a path for the thousands of dashes of a picture.
fn add_quad(mesh: &mut Mesh, a: Pos2, b: Pos2, stroke: Stroke) {
    let along = (b - a).normalized();
    // The edges fade over one point, half of it inside; thinner lines fade as a whole.
    let strength = stroke.width.min(1.0);
    let (inner, outer) = ((stroke.width - 1.0).max(0.0) / 2.0, (stroke.width.max(1.0) + 1.0) / 2.0);
    let solid = stroke.color.gamma_multiply(strength);
    let first = mesh.vertices.len() as u32;
    for (side, c) in
        [(-outer, Color32::TRANSPARENT), (-inner, solid), (inner, solid), (outer, Color32::TRANSPARENT)]
    {
        let offset = along.rot90() * side;
        mesh.colored_vertex(a + offset, c);
        mesh.colored_vertex(b + offset, c);
    }
    for i in 0..3 {
        if i == 1 && inner == 0.0 {
            continue;
        }
        let v = first + 2 * i;
        mesh.add_triangle(v, v + 1, v + 2);
        mesh.add_triangle(v + 1, v + 2, v + 3);
    }
}

/// Calls `put` with each dash of a line as far as it may be seen; dashes that turn a corner come in parts.
fn for_each_dash(
    points: &[Vec2],
    closed: bool,
    dash: &[f32],
    window: [Vec2; 2],
    mut put: impl FnMut(Vec2, Vec2),
) {
    let period: f32 = dash.iter().sum();
    let edges = if closed { points.len() } else { points.len().saturating_sub(1) };
    let mut walked = 0.0;
    for i in 0..edges {
        let (a, b) = (points[i], points[(i + 1) % points.len()]);
        let length = a.distance(b);
        if let Some((from, to)) = clip(a, b, window).filter(|_| length > 1e-6 && period > 0.0) {
            let unit = (b - a) / length;
            let mut t = from * length;
            let mut phase = (walked + t).rem_euclid(period);
            let mut k = 0;
            while phase >= dash[k] {
                phase -= dash[k];
                k = (k + 1) % dash.len();
            }
            while t < to * length {
                let end = (t + dash[k] - phase).min(to * length);
                if k % 2 == 0 {
                    put(a + unit * t, a + unit * end);
                }
                // A step too small for the size of t would stand still.
                t = end.max(t + t * 1e-6 + 1e-3);
                phase = 0.0;
                k = (k + 1) % dash.len();
            }
        }
        walked = (walked + length).rem_euclid(period.max(1e-3));
    }
}

/// The part of an edge inside a window (Liang and Barsky), as fractions of the edge.
fn clip(a: Vec2, b: Vec2, [low, high]: [Vec2; 2]) -> Option<(f32, f32)> {
    let (mut from, mut to) = (0.0_f32, 1.0_f32);
    let d = b - a;
    for axis in 0..2 {
        if d[axis] == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let (s, t) = ((low[axis] - a[axis]) / d[axis], (high[axis] - a[axis]) / d[axis]);
        from = from.max(s.min(t));
        to = to.min(s.max(t));
    }
    (from < to).then_some((from, to))
}

/// Textures of the pictures on screen, by the address of their pixels, which they keep alive, and the eyes.
#[derive(Clone, Default)]
struct Textures(Arc<egui::mutex::Mutex<BTreeMap<(usize, ColorVision), Kept>>>);

struct Kept {
    _pixels: Arc<[u8]>,
    handle: TextureHandle,
    used_pass: u64,
}

fn texture(ctx: &egui::Context, pixels: &Pixels, vision: ColorVision) -> egui::TextureId {
    let textures = ctx.data_mut(|d| {
        d.get_temp_mut_or_default::<Textures>(egui::Id::NULL.with("cullscope-pictures")).clone()
    });
    let pass = ctx.cumulative_pass_nr();
    let mut kept = textures.0.lock();
    kept.retain(|_, k| k.used_pass + 2 >= pass);
    let key = (pixels.rgba.as_ptr() as usize, vision);
    let seen = || {
        let look = Look { theme: Theme::default(), vision };
        image(&Pixels { rgba: look.see(&pixels.rgba).into(), ..*pixels }, ctx.input(|i| i.max_texture_side))
    };
    let entry = kept.entry(key).or_insert_with(|| Kept {
        _pixels: pixels.rgba.clone(),
        handle: ctx.load_texture("picture", seen(), TextureOptions::NEAREST),
        used_pass: pass,
    });
    entry.used_pass = pass;
    entry.handle.id()
}

/// The pixels for a texture; where they are more than the GPU takes, every nth in each direction.
fn image(pixels: &Pixels, most: usize) -> ColorImage {
    let (w, h) = (pixels.width as usize, pixels.height as usize);
    let step = w.max(h).div_ceil(most.max(1)).max(1);
    if step == 1 {
        return ColorImage::from_rgba_unmultiplied([w, h], &pixels.rgba);
    }
    let rows = (0..h).step_by(step);
    let thin: Vec<u8> = rows
        .flat_map(|y| {
            (0..w).step_by(step).flat_map(move |x| (0..4).map(move |c| pixels.rgba[4 * (y * w + x) + c]))
        })
        .collect();
    ColorImage::from_rgba_unmultiplied([w.div_ceil(step), h.div_ceil(step)], &thin)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: [Vec2; 2] = [Vec2::ZERO, Vec2::splat(100.0)];

    fn dashes(points: &[Vec2], closed: bool) -> Vec<[Vec2; 2]> {
        let mut out = Vec::new();
        for_each_dash(points, closed, &[5.0, 2.5], WINDOW, |a, b| out.push([a, b]));
        out
    }

    #[test]
    fn dashes_keep_their_phase_where_the_window_cuts() {
        let inside = dashes(&[vec2(0.0, 10.0), vec2(100.0, 10.0)], false);
        assert_eq!(inside.len(), 14);
        assert_eq!(inside[1], [vec2(7.5, 10.0), vec2(12.5, 10.0)]);
        // 75 is ten periods, so the same dashes are seen.
        let cut = dashes(&[vec2(-75.0, 10.0), vec2(9e5, 10.0)], false);
        assert_eq!(cut.len(), inside.len());
        assert!(cut.iter().zip(&inside).all(|(a, b)| a[0].distance(b[0]) < 0.1 && a[1].distance(b[1]) < 0.1));
        assert!(dashes(&[vec2(-5.0, -5.0), vec2(200.0, -5.0)], false).is_empty());
        assert!(dashes(&[Vec2::ONE; 5], true).is_empty());
    }

    #[test]
    fn two_thirds_of_a_closed_line_are_dashes() {
        let square = [vec2(10.0, 10.0), vec2(90.0, 10.0), vec2(90.0, 90.0), vec2(10.0, 90.0)];
        let inked: f32 = dashes(&square, true).iter().map(|[a, b]| a.distance(*b)).sum();
        assert!((inked / 320.0 - 2.0 / 3.0).abs() < 0.02, "{inked}");
    }

    #[test]
    fn pictures_that_are_too_large_are_thinned() {
        let pixels = Pixels { width: 10, height: 4, rgba: (0..160).map(|i| i as u8).collect() };
        assert_eq!(image(&pixels, 10).size, [10, 4]);
        assert_eq!(image(&pixels, 5).size, [5, 2]);
        assert_eq!(image(&pixels, 0).size, [1, 1]);
    }
}
