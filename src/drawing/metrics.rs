//! Sizes of text in the three embedded fonts, for layout before anything is painted.
//!
//! The fonts are shipped without kerning and ligatures (`fonts/README.md`), so the length of a text is
//! the sum of its advance widths. Most programs that open an SVG file read no embedded font and put one of
//! their own in its place; layout therefore goes by a width with a reserve for that ([`width_pt`]), and only
//! where a text begins goes by its length. Lengths are in ems unless the name ends in `_pt`.
//! Cost: one binary search per character; the tables are read once.

use std::sync::OnceLock;

use glam::Vec2;
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

use super::{Anchor, Font};

/// The TrueType file of a font.
pub fn font_bytes(font: Font) -> &'static [u8] {
    match font {
        Font::Regular => include_bytes!("fonts/regular.ttf"),
        Font::Bold => include_bytes!("fonts/bold.ttf"),
        Font::Mono => include_bytes!("fonts/mono.ttf"),
    }
}

/// CSS family name of a font.
pub fn family(font: Font) -> &'static str {
    match font {
        Font::Regular | Font::Bold => "Inter",
        Font::Mono => "JetBrains Mono",
    }
}

/// The same with the families that stand in for it, in the order in which a reader tries them: those of
/// Arial's widths are narrower than ours, so nothing grows; what comes after them is held by [`width_pt`].
pub fn families(font: Font) -> &'static str {
    match font {
        Font::Regular | Font::Bold => "Inter, Arial, Helvetica, 'Liberation Sans', sans-serif",
        Font::Mono => "'JetBrains Mono', 'Liberation Mono', 'DejaVu Sans Mono', monospace",
    }
}

/// How much longer than in our font a text may be in the one that a program puts in its place. Of the fonts
/// that systems come with DejaVu Sans is the widest: sentences grow by up to 8 % in it, titles by up to 18 %.
/// The usual fonts of code are all of one width.
fn reserve(font: Font) -> f32 {
    match font {
        Font::Regular => 1.09,
        Font::Bold => 1.2,
        Font::Mono => 1.0,
    }
}

/// CSS weight of a font.
pub fn weight(font: Font) -> u16 {
    match font {
        Font::Regular | Font::Mono => 400,
        Font::Bold => 700,
    }
}

/// A glyph of a font.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Its index in the font file; 0 stands for a character that the font lacks.
    pub id: u16,
    /// How far the pen moves.
    pub advance: f32,
}

struct Table {
    glyphs: Vec<(char, Glyph)>,
    missing: Glyph,
    ascent: f32,
    descent: f32,
}

fn table(font: Font) -> &'static Table {
    static TABLES: [OnceLock<Table>; 3] = [const { OnceLock::new() }; 3];
    TABLES[font as usize].get_or_init(|| read(font_bytes(font)))
}

fn read(bytes: &[u8]) -> Table {
    let font = FontRef::new(bytes).expect("the embedded fonts are well-formed");
    let (size, location) = (Size::unscaled(), LocationRef::default());
    let metrics = font.metrics(size, location);
    let widths = font.glyph_metrics(size, location);
    let em = f32::from(metrics.units_per_em);
    let glyph = |id: skrifa::GlyphId| Glyph {
        id: id.to_u32() as u16,
        advance: widths.advance_width(id).unwrap_or(0.0) / em,
    };
    let mut glyphs: Vec<(char, Glyph)> =
        font.charmap().mappings().filter_map(|(c, id)| Some((char::from_u32(c)?, glyph(id)))).collect();
    glyphs.sort_by_key(|g| g.0);
    Table {
        glyphs,
        missing: glyph(skrifa::GlyphId::new(0)),
        ascent: metrics.ascent / em,
        descent: -metrics.descent / em,
    }
}

/// The glyph of a character; glyph 0 (a box) if the font lacks it.
pub fn glyph(font: Font, c: char) -> Glyph {
    let t = table(font);
    t.glyphs.binary_search_by_key(&c, |g| g.0).map_or(t.missing, |i| t.glyphs[i].1)
}

/// Whether a font has a character.
pub fn covers(font: Font, c: char) -> bool {
    glyph(font, c).id != 0
}

/// Height of a font above the baseline.
pub fn ascent(font: Font) -> f32 {
    table(font).ascent
}

/// Depth of a font below the baseline, positive.
pub fn descent(font: Font) -> f32 {
    table(font).descent
}

/// Length of a line of text in our font.
fn length_pt(text: &str, font: Font, size_pt: f32) -> f32 {
    text.chars().map(|c| glyph(font, c).advance).sum::<f32>() * size_pt
}

/// Width to keep free for a line of text: its length in our font and the reserve for others.
pub fn width_pt(text: &str, font: Font, size_pt: f32) -> f32 {
    length_pt(text, font, size_pt) * reserve(font)
}

/// Left end of a line of text whose anchor is at `x`.
pub fn start_pt(x: f32, text: &str, font: Font, size_pt: f32, anchor: Anchor) -> f32 {
    match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - length_pt(text, font, size_pt) / 2.0,
        Anchor::End => x - length_pt(text, font, size_pt),
    }
}

/// The rectangle that a line of text may ink, also in another font: its top left and its bottom right corner.
pub fn text_box(at: Vec2, text: &str, font: Font, size_pt: f32, anchor: Anchor) -> [Vec2; 2] {
    let width = width_pt(text, font, size_pt);
    let left = match anchor {
        Anchor::Start => at.x,
        Anchor::Middle => at.x - width / 2.0,
        Anchor::End => at.x - width,
    };
    [Vec2::new(left, at.y - ascent(font) * size_pt), Vec2::new(left + width, at.y + descent(font) * size_pt)]
}

/// Breaks a text into lines no wider than `width_pt`, at spaces and line feeds; a word that is wider by
/// itself is broken between characters, so that nothing ever sticks out. Every line has at least one
/// character, even where `max_pt` is less than that character.
pub fn wrap(text: &str, font: Font, size_pt: f32, max_pt: f32) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            let joined = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if width_pt(&joined, font, size_pt) <= max_pt {
                line = joined;
                continue;
            }
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            line = break_word(word, font, size_pt, max_pt, &mut lines);
        }
        lines.push(line);
    }
    lines
}

/// Pushes the full lines of a long word and returns what is left of it.
fn break_word(word: &str, font: Font, size_pt: f32, max_pt: f32, lines: &mut Vec<String>) -> String {
    let mut rest = String::new();
    let mut width = 0.0;
    for c in word.chars() {
        let advance = glyph(font, c).advance * size_pt * reserve(font);
        if !rest.is_empty() && width + advance > max_pt {
            lines.push(std::mem::take(&mut rest));
            width = 0.0;
        }
        rest.push(c);
        width += advance;
    }
    rest
}

/// Shortens a text with an ellipsis in its middle until it fits; paths and long names keep both ends.
pub fn elide(text: &str, font: Font, size_pt: f32, max_pt: f32) -> String {
    if width_pt(text, font, size_pt) <= max_pt {
        return text.to_owned();
    }
    let chars: Vec<char> = text.chars().collect();
    for kept in (0..chars.len()).rev() {
        let head = kept.div_ceil(2);
        let short: String =
            chars[..head].iter().chain(&['…']).chain(&chars[chars.len() - (kept - head)..]).collect();
        if width_pt(&short, font, size_pt) <= max_pt {
            return short;
        }
    }
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    #[test]
    fn the_fonts_cover_what_figures_say() {
        let european = "ÄÖÜäöüßÀÉÈÊËÇÑñçåøæœłńśźżőűčřšžğışțș¿¡«»„“”‘’–—…€£§°";
        let technical = "−·×÷±≥≤≠≈→←↑↓ρεσπλθΔΩ²³½µ∞√∑∂%‰◀▶●■□▲▼⁰¹⁴⁵⁶⁷⁸⁹";
        for font in Font::ALL {
            for c in (' '..='~').chain(european.chars()).chain(technical.chars()) {
                assert!(covers(font, c), "{font:?} lacks {c:?}");
            }
        }
    }

    #[test]
    fn widths_are_those_of_the_fonts() {
        // Mono: every advance is 600 of 1000 units.
        assert!((width_pt("i−W", Font::Mono, 10.0) - 18.0).abs() < 1e-4);
        assert_eq!(
            glyph(Font::Regular, '1').advance,
            glyph(Font::Regular, '8').advance,
            "digits are tabular"
        );
        assert!(width_pt("Visible", Font::Bold, 10.0) > width_pt("Visible", Font::Regular, 10.0));
        assert!(ascent(Font::Regular) > 0.9 && descent(Font::Regular) > 0.2);
        assert!(covers(Font::Regular, '⁻') && !covers(Font::Regular, '漢'));
    }

    #[test]
    fn wrapped_lines_fit_and_lose_nothing() {
        let mut rng = Pcg32::seed_from_u64(7);
        for _ in 0..300 {
            let n = rng.next_u32() % 60;
            let text: String =
                (0..n).map(|_| ['a', 'W', ' ', '−', 'i', ' ', 'ö'][rng.next_u32() as usize % 7]).collect();
            let max = 12.0 + (rng.next_u32() % 100) as f32;
            let lines = wrap(&text, Font::Regular, 8.0, max);
            assert!(lines.iter().all(|l| width_pt(l, Font::Regular, 8.0) <= max), "{lines:?} in {max}");
            let squeeze = |s: &str| s.chars().filter(|c| *c != ' ').collect::<String>();
            assert_eq!(squeeze(&lines.concat()), squeeze(&text));
        }
        assert_eq!(wrap("a b\nc", Font::Mono, 10.0, 100.0), ["a b", "c"]);
    }

    #[test]
    fn an_elided_text_keeps_both_ends() {
        let path = "scenes3d/very/long/path/to/a/model.obj";
        let short = elide(path, Font::Regular, 8.0, 90.0);
        assert!(width_pt(&short, Font::Regular, 8.0) <= 90.0);
        assert!(short.starts_with("scenes") && short.ends_with(".obj") && short.contains('…'), "{short}");
        assert_eq!(elide("x", Font::Regular, 8.0, 90.0), "x");
    }
}
