//! Drawings as SVG 1.1 text: named groups for layers, one class a role, sizes in millimeters.
//!
//! The same drawing gives the same bytes: coordinates have two decimals (0.01 pt is 3.5 µm), ids come from
//! names, and nothing is dated. The recipe stands in `<metadata>`. Text stays text in a subset of our fonts
//! that the file carries, unless outlines are asked for.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::Vec2;

use crate::drawing::{Anchor, Drawing, Font, Layer, Pixels, Role, Subject, metrics};

use super::face;
use super::number::number;
use super::piece::{self, Line, Paint, Part, Piece, Shape, Stroke};
use super::png::png_pixels;
use super::theme::{HATCH_PT, HATCH_WIDTH_PT, Hatch, Look, Rgb};

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
    write(drawing, look.into(), options, !options.outline_text)
}

/// The same with or without fonts inside; our own rasterizer has them anyway.
pub(super) fn write(drawing: &Drawing, look: Look, options: &SvgOptions, embed: bool) -> String {
    let mut writer = Writer {
        look,
        outline_text: options.outline_text,
        body: String::new(),
        parts: BTreeSet::new(),
        chars: BTreeMap::new(),
    };
    writer.layers(drawing);
    let size = drawing.size_pt.max(Vec2::ONE);
    let (w, h) = (number(size.x), number(size.y));
    let mut out = String::with_capacity(writer.body.len() + 4096);
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {w} {h}\" \
         role=\"img\" aria-labelledby=\"title description\">",
        number(size.x * MM_PER_PT),
        number(size.y * MM_PER_PT),
    );
    let _ = writeln!(out, "<title id=\"title\">{}</title>", escape(&drawing.title));
    let _ = writeln!(out, "<desc id=\"description\">{}</desc>", escape(&drawing.description));
    if let Some(recipe) = options.metadata {
        let _ = writeln!(out, "<metadata id=\"recipe\">{}</metadata>", escape(recipe));
    }
    writer.style(embed, &mut out);
    writer.patterns(&mut out);
    let _ = writeln!(out, "<rect id=\"paper\" width=\"{w}\" height=\"{h}\" fill=\"{}\"/>", hex(look.paper()));
    out.push_str(&writer.body);
    out.push_str("</svg>\n");
    out
}

struct Writer {
    look: Look,
    outline_text: bool,
    body: String,
    /// What the style sheet must define.
    parts: BTreeSet<(Role, Part)>,
    /// What the fonts must have.
    chars: BTreeMap<Font, BTreeSet<char>>,
}

impl Writer {
    fn layers(&mut self, drawing: &Drawing) {
        let mut open: Option<Layer> = None;
        piece::each_piece(drawing, self.look, |item, piece, _| {
            if open != Some(item.layer) {
                self.body.push_str(if open.is_some() { "</g>\n" } else { "" });
                let _ = writeln!(self.body, "<g id=\"layer-{}\">", item.layer.name());
                open = Some(item.layer);
            }
            self.piece(piece, &subject(item.subject));
        });
        self.body.push_str(if open.is_some() { "</g>\n" } else { "" });
    }

    fn piece(&mut self, piece: &Piece, subject: &str) {
        self.parts.insert((piece.role, piece.part));
        let class = format!("class=\"{} {}\"{subject}", piece.part.name(), piece.role.name());
        let body = &mut self.body;
        match &piece.shape {
            Shape::Path { points, closed } => {
                let name = if *closed { "polygon" } else { "polyline" };
                let _ = write!(body, "<{name} {class} points=\"");
                for (i, p) in points.iter().enumerate() {
                    let gap = if i == 0 { "" } else { " " };
                    let _ = write!(body, "{gap}{},{}", number(p.x), number(p.y));
                }
                body.push_str("\"/>\n");
            }
            Shape::Circle { at, radius_pt } => {
                let _ = writeln!(
                    body,
                    "<circle {class} cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                    number(at.x),
                    number(at.y),
                    number(*radius_pt)
                );
            }
            Shape::Text(line) if self.outline_text => {
                let _ = write!(body, "<path {class} d=\"");
                for (_, glyph, x) in piece::glyphs(line) {
                    face::outline(line.font, glyph.id, Vec2::new(x, line.at.y), line.size_pt, body);
                }
                body.push_str("\"/>\n");
            }
            Shape::Text(line) => self.text(line, piece, subject),
            Shape::Image { min, max, pixels } => {
                let size = *max - *min;
                let seen = Pixels { rgba: self.look.see(&pixels.rgba).into(), ..**pixels };
                let _ = writeln!(
                    body,
                    "<image{subject} x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" \
                     preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
                     href=\"data:image/png;base64,{}\"/>",
                    number(min.x),
                    number(min.y),
                    number(size.x),
                    number(size.y),
                    BASE64.encode(png_pixels(&seen)),
                );
            }
        }
    }

    fn text(&mut self, line: &Line, piece: &Piece, subject: &str) {
        self.chars.entry(line.font).or_default().extend(line.text.chars());
        let anchor = match line.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        // XML readers fold spaces; indentation and columns need theirs.
        let spaced = line.text.starts_with(' ') || line.text.ends_with(' ') || line.text.contains("  ");
        let _ = writeln!(
            self.body,
            "<text class=\"{} {} {}\"{subject} x=\"{}\" y=\"{}\" font-size=\"{}\"{anchor}{}>{}</text>",
            piece.part.name(),
            piece.role.name(),
            line.font.name(),
            number(line.at.x),
            number(line.at.y),
            number(line.size_pt),
            if spaced { " xml:space=\"preserve\"" } else { "" },
            escape(line.text),
        );
    }

    /// The style sheet: fonts, then one rule for each part of each role that occurs.
    fn style(&self, embed: bool, out: &mut String) {
        out.push_str("<style>\n");
        for (font, chars) in &self.chars {
            let (family, weight) = (metrics::family(*font), metrics::weight(*font));
            if let Some(file) = face::subset(*font, chars).filter(|_| embed) {
                let data = BASE64.encode(file);
                let _ = writeln!(
                    out,
                    "@font-face {{ font-family: \"{family}\"; font-weight: {weight}; src: \
                     url(data:font/ttf;base64,{data}) format(\"truetype\"); }}"
                );
            }
            let generic = if *font == Font::Mono { "monospace" } else { "sans-serif" };
            let _ = writeln!(
                out,
                ".{} {{ font-family: \"{family}\", {generic}; font-weight: {weight}; font-kerning: none; \
                 font-variant-ligatures: none; }}",
                font.name()
            );
        }
        for (role, part) in &self.parts {
            if *part != Part::Image {
                let rule = rule(*role, &piece::paint(*part, &self.look.style(*role)));
                let _ = writeln!(out, ".{}.{} {{ {rule} }}", part.name(), role.name());
            }
        }
        out.push_str("</style>\n");
    }

    fn patterns(&self, out: &mut String) {
        let hatched: Vec<Role> =
            self.parts.iter().filter(|(_, part)| *part == Part::Hatch).map(|(role, _)| *role).collect();
        if hatched.is_empty() {
            return;
        }
        out.push_str("<defs>\n");
        for role in hatched {
            let style = self.look.style(role);
            let (s, half, width, color) =
                (number(HATCH_PT), number(HATCH_PT / 2.0), number(HATCH_WIDTH_PT), hex(style.stroke));
            let _ = write!(
                out,
                "<pattern id=\"hatch-{}\" patternUnits=\"userSpaceOnUse\" width=\"{s}\" height=\"{s}\" \
                 patternTransform=\"rotate(45)\">",
                role.name()
            );
            let _ = match style.hatch {
                Hatch::None => Ok(()),
                Hatch::Diagonal => {
                    write!(out, "<path d=\"M{half} 0V{s}\" stroke=\"{color}\" stroke-width=\"{width}\"/>")
                }
                Hatch::Falling => {
                    write!(out, "<path d=\"M0 {half}H{s}\" stroke=\"{color}\" stroke-width=\"{width}\"/>")
                }
                Hatch::Cross => write!(
                    out,
                    "<path d=\"M{half} 0V{s}M0 {half}H{s}\" stroke=\"{color}\" stroke-width=\"{width}\" \
                     fill=\"none\"/>"
                ),
                Hatch::Dots => {
                    write!(out, "<circle cx=\"{half}\" cy=\"{half}\" r=\"{width}\" fill=\"{color}\"/>")
                }
            };
            out.push_str("</pattern>\n");
        }
        out.push_str("</defs>\n");
    }
}

/// The CSS declarations of a paint.
fn rule(role: Role, paint: &Paint) -> String {
    let fill = match (paint.hatch, paint.fill) {
        (Some(_), _) => format!("fill: url(#hatch-{});", role.name()),
        (None, Some((color, 1.0))) => format!("fill: {};", hex(color)),
        (None, Some((color, alpha))) => format!("fill: {}; fill-opacity: {};", hex(color), number(alpha)),
        (None, None) => "fill: none;".to_owned(),
    };
    let Some(Stroke { color, width_pt, dash }) = paint.stroke else { return format!("{fill} stroke: none;") };
    let mut rule =
        format!("{fill} stroke: {}; stroke-width: {}; stroke-linejoin: round;", hex(color), number(width_pt));
    if !dash.is_empty() {
        let lengths: Vec<String> = dash.iter().map(|d| number(*d)).collect();
        let _ = write!(rule, " stroke-dasharray: {};", lengths.join(" "));
    }
    rule
}

fn subject(subject: Subject) -> String {
    match subject {
        Subject::None => String::new(),
        Subject::Prim(id) => format!(" data-prim=\"{}\"", id.0),
        Subject::Node(id) => format!(" data-node=\"{}\"", id.0),
        Subject::Object(id) => format!(" data-object=\"{}\"", id.0),
        Subject::Plane(i) => format!(" data-plane=\"{i}\""),
        Subject::Eye => " data-eye=\"\"".to_owned(),
    }
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text for XML; characters that XML cannot hold become spaces.
fn escape(text: &str) -> String {
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
