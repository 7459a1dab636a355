//! Drawings as PDF 1.5, which pdfTeX takes without a warning: a page each, vectors, our fonts embedded, text
//! that can be searched and copied.
//!
//! The same drawing gives the same bytes: no date is written, and the document's id is a hash of its content.
//! The recipe is an embedded file, as plain bytes, so that it can be read back without a PDF reader.

use glam::Vec2;
use krilla::SerializeSettings;
use krilla::color::rgb;
use krilla::configure::{ConfigurationBuilder, PdfVersion};
use krilla::embed::{AssociationKind, EmbeddedFile, MimeType};
use krilla::geom::{Path, PathBuilder, Point, Size, Transform};
use krilla::image::Image;
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, LineCap, LineJoin, Stroke, StrokeDash};
use krilla::surface::Surface;
use krilla::text::{Font as PdfFont, GlyphId, KrillaGlyph};
use krilla::{Data, Document};

use crate::drawing::{Drawing, Font, Pixels, metrics};

use super::RenderError;
use super::hatch::hatching;
use super::piece::{self, Line, Paint, Piece, Shape};
use super::png::enlarged;
use super::theme::{HATCH_WIDTH_PT, Hatch, Look, Rgb};

/// Name of the embedded file with the recipe.
const RECIPE_FILE: &str = "cullscope-recipe.json";
/// The longest side of a page that PDF allows.
const LONGEST_PT: f32 = 14_400.0;

/// A drawing as a PDF file.
///
/// # Errors
/// If PDF allows no page of its size, or the writer refuses it.
pub fn pdf(drawing: &Drawing, look: impl Into<Look>, metadata: Option<&str>) -> Result<Vec<u8>, RenderError> {
    pages(std::slice::from_ref(drawing), look, metadata)
}

/// Drawings as the pages of a PDF file, which has the title and the description of the first.
///
/// # Errors
/// If there is none, PDF allows no page of such a size, or the writer refuses one.
pub fn pages(
    drawings: &[Drawing],
    look: impl Into<Look>,
    metadata: Option<&str>,
) -> Result<Vec<u8>, RenderError> {
    let look = look.into();
    let first = drawings.first().ok_or_else(|| RenderError::Pdf("there is no page".into()))?;
    let configuration = ConfigurationBuilder::new()
        .with_version(PdfVersion::Pdf15)
        .finish()
        .map_err(|e| RenderError::Pdf(format!("{e:?}")))?;
    let mut document =
        Document::new_with(SerializeSettings { configuration, ..SerializeSettings::default() });
    document.set_metadata(about(first));
    let fonts = Font::ALL
        .map(|f| PdfFont::new(Data::from(metrics::font_bytes(f)), 0))
        .into_iter()
        .collect::<Option<Vec<_>>>()
        .ok_or_else(|| RenderError::Pdf("a font is unreadable".into()))?;
    for drawing in drawings {
        let size = drawing.size_pt;
        let is_allowed = size.is_finite() && size.min_element() >= 1.0 && size.max_element() <= LONGEST_PT;
        let settings = PageSettings::from_wh(size.x, size.y)
            .filter(|_| is_allowed)
            .ok_or(RenderError::Page { width_pt: size.x, height_pt: size.y })?;
        let mut page = document.start_page_with(settings);
        paint_page(page.surface(), fonts.clone(), drawing, look);
        page.finish();
    }
    if let Some(recipe) = metadata {
        document.embed_file(recipe_file(recipe));
    }
    document.finish().map_err(|e| RenderError::Pdf(format!("{e:?}")))
}

fn paint_page(surface: Surface, fonts: Vec<PdfFont>, drawing: &Drawing, look: Look) {
    let size = drawing.size_pt;
    let mut canvas = Canvas { surface, fonts, size, look };
    canvas.fill(look.paper(), 1.0);
    canvas.path(&[Vec2::ZERO, Vec2::new(size.x, 0.0), size, Vec2::new(0.0, size.y)], true);
    piece::each_piece(drawing, look, |_, piece, paint| canvas.piece(piece, paint));
    canvas.surface.finish();
}

fn about(drawing: &Drawing) -> Metadata {
    Metadata::new()
        .title(drawing.title.clone())
        .description(drawing.description.clone())
        .creator("cullscope".into())
        .language("en".into())
        .keywords(vec!["visibility culling".into(), "cullscope".into()])
}

fn recipe_file(recipe: &str) -> EmbeddedFile {
    EmbeddedFile {
        path: RECIPE_FILE.into(),
        mime_type: MimeType::new("application/json"),
        description: Some(
            "How cullscope made this figure; open the file in cullscope to go on from here.".into(),
        ),
        association_kind: AssociationKind::Source,
        data: Data::from(recipe.as_bytes().to_vec()),
        modification_date: None,
        compress: Some(false),
        location: None,
    }
}

struct Canvas<'a> {
    surface: Surface<'a>,
    fonts: Vec<PdfFont>,
    size: Vec2,
    look: Look,
}

impl Canvas<'_> {
    fn fill(&mut self, [r, g, b]: Rgb, alpha: f32) {
        let opacity = NormalizedF32::new(alpha).unwrap_or(NormalizedF32::ONE);
        self.surface.set_fill(Some(Fill {
            paint: rgb::Color::new(r, g, b).into(),
            opacity,
            ..Fill::default()
        }));
        self.surface.set_stroke(None);
    }

    fn stroke(&mut self, stroke: &piece::Stroke) {
        let [r, g, b] = stroke.color;
        let dash = (!stroke.dash.is_empty()).then(|| StrokeDash { array: stroke.dash.to_vec(), offset: 0.0 });
        self.surface.set_fill(None);
        self.surface.set_stroke(Some(Stroke {
            paint: rgb::Color::new(r, g, b).into(),
            width: stroke.width_pt,
            line_cap: LineCap::Butt,
            line_join: LineJoin::Round,
            dash,
            ..Stroke::default()
        }));
    }

    fn piece(&mut self, piece: &Piece, paint: &Paint) {
        match &piece.shape {
            Shape::Path { points, closed } => {
                if let Some((color, alpha)) = paint.fill {
                    self.fill(color, alpha);
                    self.path(points, *closed);
                }
                if let Some((hatch, color)) = paint.hatch {
                    self.hatch(points, hatch, color);
                }
                if let Some(stroke) = &paint.stroke {
                    self.stroke(stroke);
                    self.path(points, *closed);
                }
            }
            Shape::Circle { at, radius_pt } => {
                let Some(path) = circle(*at, *radius_pt) else { return };
                if let Some((color, alpha)) = paint.fill {
                    self.fill(color, alpha);
                    self.surface.draw_path(&path);
                }
                if let Some(stroke) = &paint.stroke {
                    self.stroke(stroke);
                    self.surface.draw_path(&path);
                }
            }
            Shape::Text(line) => {
                if let Some((color, alpha)) = paint.fill {
                    self.fill(color, alpha);
                    self.text(line);
                }
            }
            Shape::Image { min, max, pixels } => self.image(*min, *max, pixels),
        }
    }

    fn path(&mut self, points: &[Vec2], closed: bool) {
        if let Some(path) = polygon(points, closed) {
            self.surface.draw_path(&path);
        }
    }

    fn hatch(&mut self, points: &[Vec2], hatch: Hatch, color: Rgb) {
        let found = hatching(points, hatch, [Vec2::ZERO, self.size]);
        let mut lines = PathBuilder::new();
        for [a, b] in &found.lines {
            lines.move_to(a.x, a.y);
            lines.line_to(b.x, b.y);
        }
        if let Some(path) = lines.finish() {
            self.stroke(&piece::Stroke { color, width_pt: HATCH_WIDTH_PT, dash: &[] });
            self.surface.draw_path(&path);
        }
        self.fill(color, 1.0);
        for path in found.dots.iter().filter_map(|at| circle(*at, HATCH_WIDTH_PT)) {
            self.surface.draw_path(&path);
        }
    }

    fn text(&mut self, line: &Line) {
        let start = metrics::start_pt(line.at.x, line.text, line.font, line.size_pt, line.anchor);
        let glyphs: Vec<KrillaGlyph> = line
            .text
            .char_indices()
            .map(|(i, c)| {
                let glyph = metrics::glyph(line.font, c);
                KrillaGlyph::new(
                    GlyphId::new(u32::from(glyph.id)),
                    glyph.advance,
                    0.0,
                    0.0,
                    0.0,
                    i..i + c.len_utf8(),
                    None,
                )
            })
            .collect();
        let font = self.fonts[line.font as usize].clone();
        self.surface.draw_glyphs(
            Point::from_xy(start, line.at.y),
            &glyphs,
            font,
            line.text,
            line.size_pt,
            false,
        );
    }

    fn image(&mut self, min: Vec2, max: Vec2, pixels: &Pixels) {
        let Some(size) = Size::from_wh(max.x - min.x, max.y - min.y) else { return };
        let seen = Pixels { rgba: self.look.see(&pixels.rgba).into(), ..*pixels };
        let Pixels { width, height, rgba } = enlarged(&seen, max - min);
        self.surface.push_transform(&Transform::from_translate(min.x, min.y));
        self.surface.draw_image(Image::from_rgba8(rgba.to_vec(), width, height), size);
        self.surface.pop();
    }
}

fn polygon(points: &[Vec2], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, p) in points.iter().enumerate() {
        if i == 0 {
            path.move_to(p.x, p.y);
        } else {
            path.line_to(p.x, p.y);
        }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn circle(at: Vec2, radius: f32) -> Option<Path> {
    // Four Bézier arcs; the handle length keeps the error below 0.03 % of the radius.
    let k = 0.552_284_8 * radius;
    let mut path = PathBuilder::new();
    path.move_to(at.x + radius, at.y);
    let mut out = Vec2::X;
    for _ in 0..4 {
        let next = out.perp();
        let (a, b, p) = (at + out * radius + next * k, at + next * radius + out * k, at + next * radius);
        path.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y);
        out = next;
    }
    path.close();
    path.finish()
}

/// The recipe in a PDF file that this room wrote (and that no other program has packed anew).
pub(super) fn recipe(bytes: &[u8]) -> Option<String> {
    let find = |from: usize, what: &[u8]| {
        bytes.get(from..)?.windows(what.len()).position(|w| w == what).map(|i| from + i)
    };
    let kind = find(0, b"/Type/EmbeddedFile").or_else(|| find(0, b"/Type /EmbeddedFile"))?;
    // The object's dictionary lies between the last "obj" before its type and the next "stream".
    let begin = bytes[..kind].windows(4).rposition(|w| w == b" obj")?;
    let stream = find(kind, b"stream")?;
    let dictionary = std::str::from_utf8(&bytes[begin..stream]).ok()?;
    let length: String =
        dictionary.split_once("/Length")?.1.trim_start().chars().take_while(char::is_ascii_digit).collect();
    let data = stream + b"stream".len();
    let data = data + usize::from(bytes.get(data) == Some(&b'\r'));
    let data = data + usize::from(bytes.get(data) == Some(&b'\n'));
    let end = data.checked_add(length.parse::<usize>().ok()?)?;
    String::from_utf8(bytes.get(data..end)?.to_vec()).ok()
}
