//! Marks as the few shapes that every reader knows how to paint.
//!
//! A role's style may need more than one shape (a halo under a line, a hatch over an area, a sign): this
//! file decides which, once, so that screen, SVG, PDF and PNG cannot disagree.

use std::borrow::Cow;

use glam::Vec2;

use crate::drawing::{Anchor, Drawing, Font, Item, Layer, Mark, Pixels, Role, metrics};

use super::theme::{Hatch, Look, Rgb, SIGN_PT, Style};

/// Why a shape is there; also its class in SVG files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Halo,
    Area,
    /// An area of the scene that is no occluder: one of thousands, so its outline is a hair.
    Face,
    /// An area in a color of its own.
    Swatch,
    /// The same, which hides what is behind it, and its edges.
    Facet,
    Edge,
    Hatch,
    Line,
    Head,
    Dot,
    Text,
    Sign,
    Image,
}

impl Part {
    pub(super) fn name(self) -> &'static str {
        match self {
            Part::Halo => "halo",
            Part::Area => "area",
            Part::Face => "face",
            Part::Swatch => "swatch",
            Part::Facet => "facet",
            Part::Edge => "edge",
            Part::Hatch => "hatch",
            Part::Line => "line",
            Part::Head => "head",
            Part::Dot => "dot",
            Part::Text => "text",
            Part::Sign => "sign",
            Part::Image => "image",
        }
    }
}

/// A line of text and where its anchor is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line<'a> {
    pub at: Vec2,
    pub text: &'a str,
    pub size_pt: f32,
    pub anchor: Anchor,
    pub font: Font,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape<'a> {
    Path { points: Cow<'a, [Vec2]>, closed: bool },
    Circle { at: Vec2, radius_pt: f32 },
    Text(Line<'a>),
    Image { min: Vec2, max: Vec2, pixels: &'a Pixels },
}

/// A line's paint; the opacity is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub color: Rgb,
    pub width_pt: f32,
    pub dash: &'static [f32],
}

/// The paint of one part of a role.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Paint {
    pub fill: Option<(Rgb, f32)>,
    pub hatch: Option<(Hatch, Rgb)>,
    pub stroke: Option<Stroke>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece<'a> {
    pub part: Part,
    pub role: Role,
    pub shape: Shape<'a>,
}

/// Width of the outlines of a scene's polygons: they are many and small.
const HAIR_PT: f32 = 0.3;
/// Width of the edges of solid surfaces.
const EDGE_PT: f32 = 0.4;

/// Calls `put` with each shape of a drawing, from the lowest to the topmost, with its item and its paint.
pub(super) fn each_piece(
    drawing: &Drawing,
    look: Look,
    mut put: impl FnMut(&Item<Vec2>, &Piece<'_>, &Paint),
) {
    let styles = look.styles();
    let mut found = Vec::new();
    for item in drawing.painted() {
        let style = &styles[item.role as usize];
        found.clear();
        pieces(item, style, &mut found);
        for piece in &found {
            let mut paint = paint(piece.part, style);
            if let (Part::Swatch, Mark::Swatch { rgba: [r, g, b, alpha], .. }) = (piece.part, &item.mark) {
                paint.fill = Some((look.vision.see([*r, *g, *b]), f32::from(*alpha) / 255.0));
            }
            if let (Part::Facet, Mark::Facet { rgb: Some(rgb), .. }) = (piece.part, &item.mark) {
                let color = look.vision.see(*rgb);
                // Its own color around it, so that no paper shines through between neighbors.
                paint.stroke = Some(Stroke { color, width_pt: HAIR_PT, dash: &[] });
                paint.fill = Some((color, 1.0));
            }
            put(item, piece, &paint);
        }
    }
}

/// The paint of a part of a role.
pub(super) fn paint(part: Part, style: &Style) -> Paint {
    let none = Paint { fill: None, hatch: None, stroke: None };
    let line = Stroke { color: style.stroke, width_pt: style.width_pt, dash: style.dash };
    match part {
        Part::Halo => {
            let (color, width_pt) = style.halo.unwrap_or((style.stroke, 0.0));
            Paint { stroke: Some(Stroke { color, width_pt: style.width_pt + width_pt, dash: &[] }), ..none }
        }
        Part::Area => Paint { fill: style.fill, stroke: Some(line), ..none },
        Part::Face => Paint { fill: style.fill, stroke: Some(Stroke { width_pt: HAIR_PT, ..line }), ..none },
        Part::Swatch => Paint { stroke: Some(Stroke { width_pt: HAIR_PT, ..line }), ..none },
        Part::Facet => none,
        Part::Edge => Paint { stroke: Some(Stroke { width_pt: EDGE_PT, ..line }), ..none },
        Part::Hatch => Paint { hatch: Some((style.hatch, style.stroke)), ..none },
        Part::Line => Paint { stroke: Some(line), ..none },
        Part::Head => Paint { fill: Some((style.stroke, 1.0)), ..none },
        Part::Dot => {
            let rim = (style.dot != style.stroke).then_some(Stroke {
                color: style.stroke,
                width_pt: style.width_pt.min(0.9),
                dash: &[],
            });
            Paint { fill: Some((style.dot, 1.0)), stroke: rim, ..none }
        }
        Part::Text => Paint { fill: Some((style.text, 1.0)), ..none },
        Part::Sign => Paint { fill: Some((style.sign.map_or(style.text, |s| s.1), 1.0)), ..none },
        Part::Image => none,
    }
}

/// The shapes of a mark, from the lowest to the topmost. Marks with a coordinate that is no number have none.
fn pieces<'a>(item: &'a Item<Vec2>, style: &Style, out: &mut Vec<Piece<'a>>) {
    if !finite(&item.mark) {
        return;
    }
    let mut push = |part, shape| out.push(Piece { part, role: item.role, shape });
    let halo = style.halo.is_some();
    let above = Vec2::new(0.0, -0.55 * SIGN_PT - style.width_pt / 2.0);
    let sign_at = match &item.mark {
        Mark::Line { points, closed } => {
            let path = || Shape::Path { points: Cow::Borrowed(points), closed: *closed };
            if halo {
                push(Part::Halo, path());
            }
            push(Part::Line, path());
            middle(points, *closed).map(|p| if *closed { p } else { p + above })
        }
        Mark::Area(points) => {
            let path = || Shape::Path { points: Cow::Borrowed(points), closed: true };
            if halo {
                push(Part::Halo, path());
            }
            let many = item.layer == Layer::Scene && item.role != Role::Occluder;
            push(if many { Part::Face } else { Part::Area }, path());
            if style.hatch != Hatch::None {
                push(Part::Hatch, path());
            }
            middle(points, true)
        }
        Mark::Swatch { points, rgba: _ } => {
            push(Part::Swatch, Shape::Path { points: Cow::Borrowed(points), closed: true });
            middle(points, true)
        }
        Mark::Facet { points, is_edge, rgb } => {
            facet(points, is_edge, rgb.is_some(), &mut push);
            None
        }
        Mark::Arrow(from, to) => {
            arrow(*from, *to, style, &mut push);
            Some((*from + *to) / 2.0 + above)
        }
        Mark::Dot { at, radius_pt } => {
            let circle = || Shape::Circle { at: *at, radius_pt: *radius_pt };
            if halo {
                push(Part::Halo, circle());
            }
            push(Part::Dot, circle());
            Some(*at + above - Vec2::new(0.0, *radius_pt))
        }
        Mark::Text { at, text, size_pt, anchor, font } => {
            push(
                Part::Text,
                Shape::Text(Line { at: *at, text, size_pt: *size_pt, anchor: *anchor, font: *font }),
            );
            None
        }
        Mark::Image { corners: [a, b], pixels } => {
            if pixels.width > 0
                && pixels.height > 0
                && pixels.rgba.len() == 4 * pixels.width as usize * pixels.height as usize
            {
                push(Part::Image, Shape::Image { min: a.min(*b), max: a.max(*b), pixels });
            }
            None
        }
    };
    if let (Some((sign, _)), Some(at)) = (style.sign, sign_at) {
        push(Part::Sign, Shape::Text(sign_line(sign, at)));
    }
}

/// The sign of a role, its middle at a point.
fn sign_line(sign: char, middle: Vec2) -> Line<'static> {
    // The only signs are those of the theme; a static text saves an allocation a mark.
    let text = match sign {
        '!' => "!",
        _ => "?",
    };
    // Capitals of our fonts are 0.73 em high.
    let at = middle + Vec2::new(0.0, SIGN_PT * 0.73 / 2.0);
    Line { at, text, size_pt: SIGN_PT, anchor: Anchor::Middle, font: Font::Bold }
}

/// A surface, if it is one, and those of its sides that are edges, what follows each other as one line.
fn facet<'a>(points: &'a [Vec2], is_edge: &[bool], is_surface: bool, push: &mut impl FnMut(Part, Shape<'a>)) {
    let n = points.len();
    if is_surface {
        push(Part::Facet, Shape::Path { points: Cow::Borrowed(points), closed: true });
    }
    let Some(gap) = is_edge.iter().position(|is_edge| !is_edge) else {
        return push(Part::Edge, Shape::Path { points: Cow::Borrowed(points), closed: true });
    };
    let mut line: Vec<Vec2> = Vec::new();
    // From behind a gap, and to it again.
    for k in (1..=n).map(|k| (gap + k) % n) {
        if is_edge[k] {
            if line.is_empty() {
                line.push(points[k]);
            }
            line.push(points[(k + 1) % n]);
        } else if !line.is_empty() {
            push(Part::Edge, Shape::Path { points: Cow::Owned(std::mem::take(&mut line)), closed: false });
        }
    }
}

/// A shaft that ends inside its head, so that its butt does not show beyond the tip.
fn arrow<'a>(from: Vec2, to: Vec2, style: &Style, push: &mut impl FnMut(Part, Shape<'a>)) {
    let along = to - from;
    let length = along.length();
    if length < 1e-3 {
        return;
    }
    let unit = along / length;
    let head = (style.width_pt * 2.0 + 3.5).min(length);
    let (base, side) = (to - unit * head, unit.perp() * head * 0.36);
    let shaft = || Shape::Path { points: Cow::Owned(vec![from, to - unit * head * 0.8]), closed: false };
    if style.halo.is_some() {
        push(Part::Halo, Shape::Path { points: Cow::Owned(vec![from, to + unit]), closed: false });
    }
    push(Part::Line, shaft());
    push(Part::Head, Shape::Path { points: Cow::Owned(vec![to, base + side, base - side]), closed: true });
}

/// Where the sign of a line or area stands: the mean of a closed outline's corners, the middle of a line's
/// middle edge.
fn middle(points: &[Vec2], closed: bool) -> Option<Vec2> {
    match points {
        [] => None,
        [p] => Some(*p),
        _ if closed => Some(points.iter().sum::<Vec2>() / points.len() as f32),
        _ => {
            let i = (points.len() - 1) / 2;
            Some((points[i] + points[(i + 1).min(points.len() - 1)]) / 2.0)
        }
    }
}

fn finite(mark: &Mark<Vec2>) -> bool {
    // Beyond this no paper is; larger numbers overflow the readers' arithmetic.
    let near = |p: &Vec2| p.is_finite() && p.abs().max_element() < 1e7;
    match mark {
        Mark::Line { points, closed: _ } => points.len() > 1 && points.iter().all(near),
        Mark::Area(points) | Mark::Swatch { points, .. } => points.len() > 2 && points.iter().all(near),
        Mark::Facet { points, is_edge, .. } => {
            points.len() > 1 && points.len() == is_edge.len() && points.iter().all(near)
        }
        Mark::Arrow(a, b) => near(a) && near(b),
        Mark::Dot { at, radius_pt } => near(at) && radius_pt.is_finite() && *radius_pt > 0.0,
        Mark::Text { at, text, size_pt, .. } => {
            near(at) && !text.is_empty() && size_pt.is_finite() && *size_pt > 0.0
        }
        Mark::Image { corners, .. } => corners.iter().all(near),
    }
}

/// Glyphs of a line of text with the left end of each, in order.
pub(super) fn glyphs<'a>(line: &Line<'a>) -> impl Iterator<Item = (char, metrics::Glyph, f32)> + use<'a> {
    let (font, size_pt) = (line.font, line.size_pt);
    let mut x = metrics::start_pt(line.at.x, line.text, font, size_pt, line.anchor);
    line.text.chars().map(move |c| {
        let glyph = metrics::glyph(font, c);
        let left = x;
        x += glyph.advance * size_pt;
        (c, glyph, left)
    })
}
