//! Drawings as SVG 1.1 text: named groups for layers, sizes in millimeters.
//!
//! Paint stands in presentation attributes (SVG 1.1, 6.1) on an element, or on a group of equal ones that
//! follow each other: there are programs that read no style sheet, or no rule of two classes. Each carries
//! its part and its role as classes all the same, for authors who restyle a figure. Hatches are lines, not
//! patterns, and images are linked by `xlink:href`, for the same reason; the only thing in `<style>` is our
//! fonts, which browsers read.
//!
//! The same drawing gives the same bytes: coordinates have two decimals (0.01 pt is 3.5 µm), ids come from
//! names, and nothing is dated. The recipe stands in `<metadata>`. Text stays text in a subset of our fonts
//! that the file carries, unless outlines are asked for.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::Vec2;

use crate::drawing::{Anchor, Drawing, Font, Layer, Pixels, Subject, metrics};

use super::face;
use super::hatch::hatching;
use super::number::number;
use super::piece::{self, Line, Paint, Piece, Shape, Stroke};
use super::png::{enlarged, png_passing, png_pixels};
use super::theme::{HATCH_WIDTH_PT, Hatch, Look, Rgb};

/// Millimeters in a point.
const MM_PER_PT: f32 = 25.4 / 72.0;

/// Choices for an SVG file.
#[derive(Clone, Copy, Debug, Default)]
pub struct SvgOptions<'a> {
    /// Text becomes outlines: the same everywhere, but no longer text.
    pub outline_text: bool,
    /// The recipe that [`super::recipe`] reads back.
    pub metadata: Option<&'a str>,
}

/// A drawing as SVG text.
pub fn svg(drawing: &Drawing, look: impl Into<Look>, options: &SvgOptions) -> String {
    write(drawing, look.into(), options, true)
}

/// The same for a file, or for our own rasterizer, which has the fonts anyway.
pub(super) fn write(drawing: &Drawing, look: Look, options: &SvgOptions, is_file: bool) -> String {
    let size = drawing.size_pt.max(Vec2::ONE);
    let mut writer = Writer {
        look,
        size,
        outline_text: options.outline_text,
        is_file,
        body: String::new(),
        run: Run::default(),
        chars: BTreeMap::new(),
    };
    writer.layers(drawing);
    let (w, h) = (number(size.x), number(size.y));
    let mut out = String::with_capacity(writer.body.len() + 4096);
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"{}mm\" height=\"{}mm\" \
         viewBox=\"0 0 {w} {h}\" role=\"img\" \
         aria-labelledby=\"title description\">",
        number(size.x * MM_PER_PT),
        number(size.y * MM_PER_PT),
    );
    let _ = writeln!(out, "<title id=\"title\">{}</title>", escape(&drawing.title));
    let _ = writeln!(out, "<desc id=\"description\">{}</desc>", escape(&drawing.description));
    if let Some(recipe) = options.metadata {
        let _ = writeln!(out, "<metadata id=\"recipe\">{}</metadata>", escape(recipe));
    }
    if is_file && !options.outline_text {
        fonts(&writer.chars, &mut out);
    }
    let _ = writeln!(out, "<rect id=\"paper\" width=\"{w}\" height=\"{h}\" fill=\"{}\"/>", hex(look.paper()));
    out.push_str(&writer.body);
    out.push_str("</svg>\n");
    out
}

/// The fonts that a file carries, each with the characters that it uses.
fn fonts(chars: &BTreeMap<Font, BTreeSet<char>>, out: &mut String) {
    let mut faces = String::new();
    for (font, chars) in chars {
        if let Some(file) = face::subset(*font, chars) {
            let _ = writeln!(
                faces,
                "@font-face {{ font-family: \"{}\"; font-weight: {}; src: \
                 url(data:font/ttf;base64,{}) format(\"truetype\"); }}",
                metrics::family(*font),
                metrics::weight(*font),
                BASE64.encode(file)
            );
        }
    }
    if !faces.is_empty() {
        let _ = write!(out, "<style>\n{faces}</style>\n");
    }
}

/// Elements that follow each other and have the same attributes.
#[derive(Default)]
struct Run {
    attributes: String,
    /// The names of the elements, and what stands behind the shared attributes.
    elements: Vec<(&'static str, String)>,
}

struct Writer {
    look: Look,
    size: Vec2,
    outline_text: bool,
    /// Whether it is a file; else our own rasterizer reads it at once.
    is_file: bool,
    body: String,
    run: Run,
    /// What the fonts must have.
    chars: BTreeMap<Font, BTreeSet<char>>,
}

impl Writer {
    fn layers(&mut self, drawing: &Drawing) {
        let mut open: Option<Layer> = None;
        piece::each_piece(drawing, self.look, |item, piece, paint| {
            if open != Some(item.layer) {
                self.end_run();
                self.body.push_str(if open.is_some() { "</g>\n" } else { "" });
                // Inkscape lists as layers what says that it is one.
                let name = item.layer.name();
                let _ = writeln!(
                    self.body,
                    "<g id=\"layer-{name}\" inkscape:groupmode=\"layer\" inkscape:label=\"{name}\">"
                );
                open = Some(item.layer);
            }
            self.piece(piece, paint, &subject(item.subject));
        });
        self.end_run();
        self.body.push_str(if open.is_some() { "</g>\n" } else { "" });
    }

    /// Adds an element; what it shares with its neighbors is written once.
    fn element(&mut self, name: &'static str, attributes: &str, rest: String) {
        if self.run.attributes != attributes {
            self.end_run();
            attributes.clone_into(&mut self.run.attributes);
        }
        self.run.elements.push((name, rest));
    }

    fn end_run(&mut self) {
        let Run { attributes, elements } = std::mem::take(&mut self.run);
        let body = &mut self.body;
        if let [(name, rest)] = &elements[..] {
            let _ = writeln!(body, "<{name}{attributes}{rest}");
        } else if !elements.is_empty() {
            let _ = writeln!(body, "<g{attributes}>");
            for (name, rest) in &elements {
                let _ = writeln!(body, "<{name}{rest}");
            }
            body.push_str("</g>\n");
        }
    }

    fn piece(&mut self, piece: &Piece, paint: &Paint, subject: &str) {
        let class = format!(" class=\"{} {}\"", piece.part.name(), piece.role.name());
        let painted = || class.clone() + &attributes(paint);
        match &piece.shape {
            Shape::Path { points, .. } if let Some((hatch, color)) = paint.hatch => {
                self.hatch(points, hatch, color, &class, subject);
            }
            Shape::Path { points, closed } => {
                let points: Vec<String> =
                    points.iter().map(|p| format!("{},{}", number(p.x), number(p.y))).collect();
                let points = points.join(" ");
                if *closed {
                    // MuPDF leaves a `<polygon>` open.
                    self.element("path", &painted(), format!("{subject} d=\"M{points}Z\"/>"));
                } else {
                    self.element("polyline", &painted(), format!("{subject} points=\"{points}\"/>"));
                }
            }
            Shape::Circle { at, radius_pt } => {
                self.element("circle", &painted(), circle(subject, *at, *radius_pt));
            }
            Shape::Text(line) if self.outline_text => {
                let mut rest = format!("{subject} d=\"");
                for (_, glyph, x) in piece::glyphs(line) {
                    face::outline(line.font, glyph.id, Vec2::new(x, line.at.y), line.size_pt, &mut rest);
                }
                rest.push_str("\"/>");
                self.element("path", &painted(), rest);
            }
            Shape::Text(line) => self.text(line, &painted(), subject),
            Shape::Image { min, max, pixels } => self.image([*min, *max], pixels, subject),
        }
    }

    fn text(&mut self, line: &Line, painted: &str, subject: &str) {
        self.chars.entry(line.font).or_default().extend(line.text.chars());
        let weight = if metrics::weight(line.font) > 400 { " font-weight=\"bold\"" } else { "" };
        let family = metrics::families(line.font);
        let anchor = match line.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        // XML readers fold spaces, and not all heed `xml:space`: an indentation is a place further right.
        let words = if line.anchor == Anchor::Start { line.text.trim_start_matches(' ') } else { line.text };
        let indentation = (line.text.len() - words.len()) as f32 * metrics::glyph(line.font, ' ').advance;
        let spaced = words.starts_with(' ') || words.ends_with(' ') || words.contains("  ");
        // MuPDF reads fonts on the element alone.
        let rest = format!(
            "{subject} x=\"{}\" y=\"{}\" font-family=\"{family}\" font-size=\"{}\"{weight}{anchor}{}>\
             {}</text>",
            number(line.at.x + indentation * line.size_pt),
            number(line.at.y),
            number(line.size_pt),
            if spaced { " xml:space=\"preserve\"" } else { "" },
            escape(words),
        );
        self.element("text", painted, rest);
    }

    /// The lines of a hatch as one path, or its dots.
    fn hatch(&mut self, points: &[Vec2], hatch: Hatch, color: Rgb, class: &str, subject: &str) {
        let found = hatching(points, hatch, [Vec2::ZERO, self.size]);
        if !found.lines.is_empty() {
            let mut rest = format!("{subject} d=\"");
            for [a, b] in &found.lines {
                let _ = write!(rest, "M{} {}L{} {}", number(a.x), number(a.y), number(b.x), number(b.y));
            }
            rest.push_str("\"/>");
            let stroke = Some(Stroke { color, width_pt: HATCH_WIDTH_PT, dash: &[] });
            let paint = Paint { fill: None, hatch: None, stroke };
            self.element("path", &format!("{class}{}", attributes(&paint)), rest);
        }
        let paint = Paint { fill: Some((color, 1.0)), hatch: None, stroke: None };
        for at in found.dots {
            self.element(
                "circle",
                &format!("{class}{}", attributes(&paint)),
                circle(subject, at, HATCH_WIDTH_PT),
            );
        }
    }

    fn image(&mut self, [min, max]: [Vec2; 2], pixels: &Pixels, subject: &str) {
        let size = max - min;
        let seen = Pixels { rgba: self.look.see(&pixels.rgba).into(), ..*pixels };
        let png = if self.is_file { png_pixels } else { png_passing };
        let rest = format!(
            "{subject} x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" xlink:href=\"data:image/png;base64,{}\"/>",
            number(min.x),
            number(min.y),
            number(size.x),
            number(size.y),
            BASE64.encode(png(&enlarged(&seen, size))),
        );
        self.element("image", "", rest);
    }
}

fn circle(subject: &str, at: Vec2, radius_pt: f32) -> String {
    format!("{subject} cx=\"{}\" cy=\"{}\" r=\"{}\"/>", number(at.x), number(at.y), number(radius_pt))
}

/// A paint as presentation attributes.
fn attributes(paint: &Paint) -> String {
    let mut out = match paint.fill {
        Some((color, 1.0)) => format!(" fill=\"{}\"", hex(color)),
        Some((color, alpha)) => format!(" fill=\"{}\" fill-opacity=\"{}\"", hex(color), number(alpha)),
        None => " fill=\"none\"".to_owned(),
    };
    if let Some(Stroke { color, width_pt, dash }) = paint.stroke {
        let (color, width) = (hex(color), number(width_pt));
        let _ = write!(out, " stroke=\"{color}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"");
        if !dash.is_empty() {
            let lengths: Vec<String> = dash.iter().map(|d| number(*d)).collect();
            let _ = write!(out, " stroke-dasharray=\"{}\"", lengths.join(" "));
        }
    }
    out
}

fn subject(subject: Subject) -> String {
    match subject {
        Subject::None => String::new(),
        Subject::Prim(id) => format!(" data-prim=\"{}\"", id.0),
        Subject::Node(id) => format!(" data-node=\"{}\"", id.0),
        Subject::Object(id) => format!(" data-object=\"{}\"", id.0),
        Subject::Plane(i) => format!(" data-plane=\"{i}\""),
        Subject::Eye => " data-eye=\"\"".to_owned(),
        Subject::Tried(number) => format!(" data-tried=\"{number}\""),
    }
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text for XML; characters that XML cannot hold become spaces.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            '\t' => out.push_str("&#9;"),
            '\r' => out.push_str("&#13;"),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push(' '),
            _ => out.push(c),
        }
    }
    out
}

/// Undoes [`escape`], and what other programs write for the same characters.
fn unescape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        out.push_str(before);
        let Some((entity, tail)) = after
            .split_once(';')
            .filter(|(entity, _)| entity.chars().all(|c| c == '#' || c.is_ascii_alphanumeric()))
        else {
            out.push('&');
            rest = after;
            continue;
        };
        let number = |s: &str, radix| u32::from_str_radix(s, radix).ok().and_then(char::from_u32);
        let c = match entity {
            "amp" => Some('&'),
            "lt" => Some('<'),
            "gt" => Some('>'),
            "quot" => Some('"'),
            "apos" => Some('\''),
            _ => entity
                .strip_prefix("#x")
                .map_or_else(|| number(entity.strip_prefix('#')?, 10), |hex| number(hex, 16)),
        };
        match c {
            Some(c) => out.push(c),
            None => out.extend(["&", entity, ";"]),
        }
        rest = tail;
    }
    out.push_str(rest);
    out
}

/// The recipe in an SVG file, also when another program has written it anew.
pub(super) fn recipe(text: &str) -> Option<String> {
    text.match_indices("<metadata").find_map(|(at, _)| {
        let (tag, content) = text[at..].split_once('>')?;
        let is_ours = tag.contains("id=\"recipe\"") || tag.contains("id='recipe'");
        is_ours.then(|| content.split_once("</metadata>")).flatten().map(|(recipe, _)| unescape(recipe))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recipes_survive_other_programs() {
        let recipe_text = "{\"a\": \"<&amp;> '\u{fc}\"}\n";
        assert_eq!(unescape(&escape(recipe_text)), recipe_text);
        let rewritten = "<svg><metadata id='other'>x</metadata><metadata\n  id=\"recipe\"\n>{&#34;a&#x22;: 1 \
                         &unknown; & &apos;}</metadata></svg>";
        assert_eq!(recipe(rewritten).as_deref(), Some("{\"a\": 1 &unknown; & '}"));
        assert_eq!(recipe("<metadata id=\"recipe\">cut off"), None);
    }
}
