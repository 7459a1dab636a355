//! The part of a font that a figure needs: outlines as paths, or a small font file for SVG.
//!
//! `subsetter` writes a font without a character map, since PDF has its own; browsers need one, so this file
//! puts the tables together anew with a `cmap` (format 12) and the original's `OS/2`. Cost: linear in the
//! glyphs used.

use std::collections::BTreeSet;
use std::fmt::Write;

use glam::Vec2;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::raw::TableProvider;
use skrifa::{FontRef, GlyphId, MetadataProvider, Tag};
use subsetter::GlyphRemapper;

use super::number::number;
use crate::drawing::{Font, metrics};

/// A TrueType file with the given characters only; `None` if the font has none of them.
pub(super) fn subset(font: Font, used: &BTreeSet<char>) -> Option<Vec<u8>> {
    let bytes = metrics::font_bytes(font);
    let mut remapper = GlyphRemapper::new();
    let map: Vec<(char, u16)> = used
        .iter()
        .map(|c| (*c, metrics::glyph(font, *c).id))
        .filter(|(_, id)| *id != 0)
        .map(|(c, id)| (c, remapper.remap(id)))
        .collect();
    if map.is_empty() {
        return None;
    }
    let small = subsetter::subset(bytes, 0, &remapper).ok()?;
    let (small, whole) = (FontRef::new(&small).ok()?, FontRef::new(bytes).ok()?);
    let mut tables: Vec<(Tag, Vec<u8>)> = Vec::new();
    for record in small.table_directory().table_records() {
        tables.push((record.tag(), small.table_data(record.tag())?.as_bytes().to_vec()));
    }
    for tag in [Tag::new(b"OS/2"), Tag::new(b"name")] {
        if !tables.iter().any(|t| t.0 == tag) {
            tables.push((tag, whole.table_data(tag)?.as_bytes().to_vec()));
        }
    }
    tables.push((Tag::new(b"cmap"), cmap(&map)));
    tables.sort_by_key(|t| t.0);
    // Checksums count the file's adjustment in `head` as zero, and subsetter has set its own.
    tables.iter_mut().filter(|t| t.0 == Tag::new(b"head")).for_each(|t| t.1[8..12].fill(0));
    Some(assemble(&tables))
}

/// A character map of one subtable, for Unicode in full (platform 3, encoding 10, format 12).
fn cmap(map: &[(char, u16)]) -> Vec<u8> {
    let mut out = Vec::new();
    let put32 = |out: &mut Vec<u8>, x: u32| out.extend(x.to_be_bytes());
    out.extend([0, 0, 0, 1, 0, 3, 0, 10, 0, 0, 0, 12, 0, 12, 0, 0]);
    put32(&mut out, 16 + 12 * map.len() as u32);
    put32(&mut out, 0);
    put32(&mut out, map.len() as u32);
    for (c, id) in map {
        put32(&mut out, *c as u32);
        put32(&mut out, *c as u32);
        put32(&mut out, u32::from(*id));
    }
    out
}

/// An sfnt file of the tables, which are sorted by tag.
fn assemble(tables: &[(Tag, Vec<u8>)]) -> Vec<u8> {
    let n = tables.len() as u16;
    let log = n.ilog2() as u16;
    let mut out = vec![0, 1, 0, 0];
    for x in [n, 16 << log, log, 16 * (n - (1 << log))] {
        out.extend(x.to_be_bytes());
    }
    let mut offset = 12 + 16 * tables.len();
    let mut head_at = None;
    for (tag, data) in tables {
        if *tag == Tag::new(b"head") {
            head_at = Some(offset);
        }
        out.extend(tag.to_be_bytes());
        for x in [checksum(data), offset as u32, data.len() as u32] {
            out.extend(x.to_be_bytes());
        }
        offset += data.len().next_multiple_of(4);
    }
    for (_, data) in tables {
        out.extend(data);
        out.resize(out.len().next_multiple_of(4), 0);
    }
    if let Some(at) = head_at {
        // The adjustment makes the sum of the whole file this number (OpenType, table `head`).
        let adjustment = 0xB1B0_AFBA_u32.wrapping_sub(checksum(&out));
        out[at + 8..at + 12].copy_from_slice(&adjustment.to_be_bytes());
    }
    out
}

fn checksum(data: &[u8]) -> u32 {
    data.chunks(4).fold(0u32, |sum, c| {
        let mut word = [0; 4];
        word[..c.len()].copy_from_slice(c);
        sum.wrapping_add(u32::from_be_bytes(word))
    })
}

/// Writes the outline of a glyph as SVG path data, its origin at a point on paper.
pub(super) fn outline(font: Font, glyph: u16, at: Vec2, size_pt: f32, out: &mut String) {
    let Ok(face) = FontRef::new(metrics::font_bytes(font)) else { return };
    let em = face.head().map_or(1000.0, |h| f32::from(h.units_per_em()));
    let Some(outline) = face.outline_glyphs().get(GlyphId::new(u32::from(glyph))) else { return };
    let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
    // An outline of our own fonts cannot fail to draw; if it did, the text would miss a letter.
    let _ = outline.draw(settings, &mut Pen { at, scale: size_pt / em, out });
}

struct Pen<'a> {
    at: Vec2,
    scale: f32,
    out: &'a mut String,
}

impl Pen<'_> {
    fn put(&mut self, command: char, points: &[(f32, f32)]) {
        self.out.push(command);
        for (i, (x, y)) in points.iter().enumerate() {
            let gap = if i == 0 { "" } else { " " };
            let (x, y) = (self.at.x + x * self.scale, self.at.y - y * self.scale);
            let _ = write!(self.out, "{gap}{} {}", number(x), number(y));
        }
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.put('M', &[(x, y)]);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.put('L', &[(x, y)]);
    }
    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.put('Q', &[(cx, cy), (x, y)]);
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.put('C', &[(ax, ay), (bx, by), (x, y)]);
    }
    fn close(&mut self) {
        self.out.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_subset_is_a_font_with_the_same_widths() {
        let used: BTreeSet<char> = "Culled: −3.5 ≤ ρ, Öl".chars().collect();
        for font in Font::ALL {
            let bytes = subset(font, &used).expect("the font has these characters");
            assert!(bytes.len() < 12_000, "{} bytes", bytes.len());
            let small = FontRef::new(&bytes).expect("a font");
            let em = f32::from(small.head().expect("head").units_per_em());
            let widths = small.glyph_metrics(Size::unscaled(), LocationRef::default());
            for c in &used {
                let id = small.charmap().map(*c).unwrap_or_else(|| panic!("{font:?} lost {c:?}"));
                assert_eq!(
                    widths.advance_width(id).map(|w| w / em),
                    Some(metrics::glyph(font, *c).advance),
                    "{font:?} {c:?}"
                );
                assert!(small.outline_glyphs().get(id).is_some());
            }
            assert_eq!(small.charmap().map('z'), None);
            for record in small.table_directory().table_records() {
                let mut data = small.table_data(record.tag()).expect("a table").as_bytes().to_vec();
                if record.tag() == Tag::new(b"head") {
                    data[8..12].fill(0);
                }
                assert_eq!(record.checksum(), checksum(&data), "{font:?} {}", record.tag());
            }
            assert_eq!(bytes.len() % 4, 0);
            assert_eq!(checksum(&bytes), 0xB1B0_AFBA, "the sum of the file");
        }
        assert!(subset(Font::Mono, &['漢'].into()).is_none());
    }

    #[test]
    fn outlines_lie_where_the_text_is() {
        let mut path = String::new();
        let glyph = metrics::glyph(Font::Bold, '−');
        outline(Font::Bold, glyph.id, Vec2::new(100.0, 50.0), 10.0, &mut path);
        assert!(path.starts_with('M') && path.ends_with('Z'), "{path}");
        assert!(!path.contains("NaN") && path.contains("10"), "{path}");
    }
}
