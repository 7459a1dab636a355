//! A drawing with everything in it, for the tests of its readers.

use cullscope::drawing::{Anchor, Drawing, Font, Layer, Mark, Pixels, Role, Subject};
use cullscope::geometry::{NodeId, PrimId};
use glam::vec2;

/// Every role as area, line, arrow, dot and text, beside a pixel picture.
pub fn every_mark() -> Drawing {
    let mut d = Drawing { size_pt: vec2(420.0, 330.0), ..Drawing::default() };
    d.title = "Every role & every mark".into();
    d.description = "A table of what roles look like.".into();
    for (i, role) in Role::ALL.into_iter().enumerate() {
        let y = 14.0 + 19.0 * i as f32;
        let prim = Subject::Prim(PrimId(i as u32));
        d.push(
            Layer::Scene,
            role,
            prim,
            Mark::Area(vec![vec2(90.0, y), vec2(130.0, y), vec2(136.0, y + 13.0), vec2(90.0, y + 13.0)]),
        );
        d.line(
            Layer::Nodes,
            role,
            Subject::Node(NodeId(i as u32)),
            [vec2(150.0, y + 10.0), vec2(170.0, y + 3.0), vec2(205.0, y + 10.0)],
        );
        d.outline(
            Layer::Nodes,
            role,
            Subject::None,
            [vec2(215.0, y), vec2(245.0, y), vec2(245.0, y + 12.0), vec2(215.0, y + 12.0)],
        );
        d.push(
            Layer::Evidence,
            role,
            Subject::Plane(1),
            Mark::Arrow(vec2(255.0, y + 10.0), vec2(295.0, y + 4.0)),
        );
        d.push(Layer::Emphasis, role, Subject::None, Mark::Dot { at: vec2(310.0, y + 6.0), radius_pt: 3.5 });
        let (text, size_pt, font) =
            (role.name().to_owned(), 9.0, [Font::Regular, Font::Bold, Font::Mono][i % 3]);
        d.push(
            Layer::Labels,
            role,
            Subject::None,
            Mark::Text { at: vec2(80.0, y + 10.0), text, size_pt, anchor: Anchor::End, font },
        );
    }
    let rgba: Vec<u8> =
        (0..8 * 8).flat_map(|i| [i as u8 * 4, (i % 8) as u8 * 30, 255 - i as u8 * 3, 255]).collect();
    let pixels = Pixels { width: 8, height: 8, rgba: rgba.into() };
    d.push(
        Layer::Areas,
        Role::Ink,
        Subject::None,
        Mark::Image { corners: [vec2(325.0, 14.0), vec2(405.0, 94.0)], pixels },
    );
    d.text(Layer::Caption, Role::Ink, vec2(405.0, 110.0), 8.0, Anchor::End, "8 × 8 texels, ρ ≥ 0.75 → kept");
    d.text(Layer::Caption, Role::Faint, vec2(365.0, 122.0), 8.0, Anchor::Middle, "−3.5 ε, π r², Öl ← ½");
    d
}
