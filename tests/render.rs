//! Readers of drawings against golden files and against each other.
//!
//! `UPDATE_FIGURES=1 cargo test --test render` writes tests/figures anew; with `FIGURES_OUT=folder` the
//! pictures are written there too, to be looked at.

mod sample;

use std::path::Path;

use cullscope::drawing::{Anchor, Drawing, Layer, Mark, Pixels, Role, Subject};
use cullscope::render::{self, Look, PngSize, SvgOptions, Theme, theme::Sight};
use glam::{Vec2, vec2};
use sample::every_mark;

const RECIPE: &str = "{\"method\":\"frustum\",\"note\":\"a < b & \\\"c\\\" > d, ünï − ρ ≤ 1\\n\",\"step\":412}";

fn golden(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/figures").join(name);
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        std::fs::write(&path, text).expect("the figure can be written");
    }
    let wanted = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = text.lines().zip(wanted.lines()).position(|(a, b)| a != b).unwrap_or(text.lines().count().min(wanted.lines().count()));
    assert!(text == wanted, "{name} differs from the golden file at line {}; UPDATE_FIGURES=1 writes it anew", differs + 1);
}

fn look_at(name: &str, bytes: &[u8]) {
    if let Some(folder) = std::env::var_os("FIGURES_OUT") {
        std::fs::write(Path::new(&folder).join(name), bytes).expect("the picture can be written");
    }
}

#[test]
fn svg_is_the_golden_text() {
    let d = every_mark();
    let options = SvgOptions { metadata: Some(RECIPE), ..SvgOptions::default() };
    let text = render::svg(&d, Theme::Print, &options);
    assert_eq!(text, render::svg(&d, Theme::Print, &options));
    assert!(text.len() < 80_000, "{} bytes", text.len());
    golden("roles-print.svg", &text);
    golden("roles-dark.svg", &render::svg(&d, Theme::Dark, &options));
    let outlined = render::svg(&d, Theme::Print, &SvgOptions { outline_text: true, ..options });
    assert!(!outlined.contains("<text") && !outlined.contains("@font-face"));
    look_at("roles-outlined.svg", outlined.as_bytes());
}

#[test]
fn png_is_the_same_each_time_and_shows_every_theme() {
    let d = every_mark();
    for theme in Theme::ALL {
        let bytes = render::png(&d, theme, PngSize::Dpi(144.0), Some(RECIPE)).expect("a picture");
        assert_eq!(bytes, render::png(&d, theme, PngSize::Dpi(144.0), Some(RECIPE)).expect("a picture"));
        look_at(&format!("roles-{}.png", theme.name()), &bytes);
    }
    for sight in Sight::ALL {
        let bytes = render::png(&d, Look { theme: Theme::Print, sight }, PngSize::WidthPx(700), None).expect("a picture");
        look_at(&format!("sight-{}.png", sight.name()), &bytes);
    }
    let p = render::pixels(&d, Theme::Print, PngSize::WidthPx(420)).expect("a picture");
    assert_eq!((p.width, p.height), (420, 330));
    let at = |x: usize, y: usize| &p.rgba[4 * (y * 420 + x)..][..3];
    assert_eq!(at(2, 2), [255; 3], "paper is white");
    assert_eq!(at(330, 19), at(334, 23), "one texel is one flat cell");
    assert_ne!(at(334, 19), at(336, 19), "the next texel is another color");
}

#[test]
fn pdf_is_the_same_each_time_and_embeds_its_fonts() {
    let d = every_mark();
    let bytes = render::pdf(&d, Theme::Print, Some(RECIPE)).expect("a document");
    assert_eq!(bytes, render::pdf(&d, Theme::Print, Some(RECIPE)).expect("a document"));
    look_at("roles-print.pdf", &bytes);
    look_at("roles-dark.pdf", &render::pdf(&d, Theme::Dark, None).expect("a document"));
    let has = |what: &[u8]| bytes.windows(what.len()).any(|w| w == what);
    assert!(has(b"/FontFile2") && has(b"Inter") && has(b"JetBrainsMono"), "fonts are embedded");
    assert!(!has(b"/CreationDate") && !has(b"xmp:CreateDate"), "no date");
    assert!(has(b"/MediaBox[0 0 420 330]") || has(b"/MediaBox [0 0 420 330]"));
}

#[test]
fn recipes_come_back_from_every_format() {
    let d = every_mark();
    let svg = render::svg(&d, Theme::Light, &SvgOptions { metadata: Some(RECIPE), ..SvgOptions::default() });
    let png = render::png(&d, Theme::Light, PngSize::WidthPx(200), Some(RECIPE)).expect("a picture");
    let pdf = render::pdf(&d, Theme::Light, Some(RECIPE)).expect("a document");
    for (name, bytes) in [("svg", svg.as_bytes()), ("png", &png), ("pdf", &pdf)] {
        assert_eq!(render::recipe(bytes).as_deref(), Some(RECIPE), "{name}");
    }
    let bare = render::svg(&d, Theme::Light, &SvgOptions::default());
    assert_eq!(render::recipe(bare.as_bytes()), None);
    assert_eq!(render::recipe(&render::pdf(&d, Theme::Light, None).expect("a document")), None);
    for broken in [&b""[..], b"\x89PNG", b"%PDF-1.7", b"<metadata id=\"recipe\">", &png[..png.len() / 2], &pdf[..pdf.len() / 2], &[0xff; 40]] {
        let _ = render::recipe(broken);
    }
}

#[test]
fn odd_drawings_harm_nothing() {
    let mut d = every_mark();
    for bad in [f32::NAN, f32::INFINITY, -1e30] {
        d.line(Layer::Scene, Role::Visible, Subject::None, [vec2(bad, 0.0), Vec2::ONE]);
        d.push(Layer::Scene, Role::Wrong, Subject::None, Mark::Dot { at: Vec2::ONE, radius_pt: bad });
        d.push(Layer::Scene, Role::Hidden, Subject::None, Mark::Area(vec![vec2(bad, bad); 4]));
        d.text(Layer::Scene, Role::Ink, Vec2::ONE, bad, Anchor::Start, "x");
    }
    d.line(Layer::Scene, Role::Visible, Subject::None, []);
    d.push(Layer::Scene, Role::Wrong, Subject::None, Mark::Area(vec![Vec2::ONE; 3]));
    let pixels = Pixels { width: 4, height: 4, rgba: vec![0; 3].into() };
    d.push(Layer::Scene, Role::Ink, Subject::None, Mark::Image { corners: [Vec2::ZERO, Vec2::ONE], pixels });
    d.text(Layer::Labels, Role::Ink, vec2(9.0, 9.0), 8.0, Anchor::Start, "</text> & \u{0} ]]> 漢");
    let svg = render::svg(&d, Theme::Print, &SvgOptions::default());
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert!(render::png(&d, Theme::Print, PngSize::WidthPx(100), None).is_ok());
    for size in [PngSize::WidthPx(0), PngSize::WidthPx(u32::MAX), PngSize::Dpi(f32::NAN), PngSize::Dpi(-3.0), PngSize::Dpi(0.0)] {
        assert!(render::png(&d, Theme::Print, size, None).is_err(), "{size:?}");
    }
    assert!(render::pdf(&d, Theme::Print, None).is_ok());
    assert!(render::pdf(&Drawing::default(), Theme::Print, None).is_err());
    assert!(render::png(&Drawing::default(), Theme::Print, PngSize::WidthPx(10), None).is_err());
}
