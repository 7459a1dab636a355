//! Readers of drawings against golden files and against each other.
//!
//! `UPDATE_FIGURES=1 cargo test --test render` writes tests/figures anew; with `FIGURES_OUT=folder` the
//! pictures are written there too, to be looked at.

#[path = "sample/pdf_text.rs"]
mod pdf_text;
mod sample;

use std::path::Path;

use cullscope::drawing::{Anchor, Drawing, Layer, Mark, Pixels, Role, Subject};
use cullscope::figure::{Page, Paper, axis, page::legend};
use cullscope::geometry::PrimId;
use cullscope::render::{self, Look, PngSize, SvgOptions, Theme, theme::ColorVision};
use glam::{Vec2, vec2};
use sample::every_mark;

const RECIPE: &str =
    "{\"method\":\"frustum\",\"note\":\"a < b & \\\"c\\\" > d, ünï − ρ ≤ 1\\n\",\"step\":412}";

fn golden(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/figures").join(name);
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        std::fs::write(&path, text).expect("the figure can be written");
    }
    let wanted = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = text
        .lines()
        .zip(wanted.lines())
        .position(|(a, b)| a != b)
        .unwrap_or(text.lines().count().min(wanted.lines().count()));
    assert!(
        text == wanted,
        "{name} differs from the golden file at line {}; UPDATE_FIGURES=1 writes it anew",
        differs + 1
    );
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
    for vision in ColorVision::ALL {
        let bytes = render::png(&d, Look { theme: Theme::Print, vision }, PngSize::WidthPx(700), None)
            .expect("a picture");
        look_at(&format!("vision-{}.png", vision.name()), &bytes);
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
    let mut wanted: Vec<String> = d
        .painted()
        .iter()
        .filter_map(|i| if let Mark::Text { text, .. } = &i.mark { Some(text.clone()) } else { None })
        .collect();
    let mut shown = pdf_text::text_of(&bytes);
    shown.retain(|t| t != "!");
    wanted.sort();
    shown.sort();
    assert_eq!(shown, wanted, "text can be copied from the document");
    let has = |what: &[u8]| bytes.windows(what.len()).any(|w| w == what);
    assert!(has(b"/FontFile2") && has(b"Inter") && has(b"JetBrainsMono"), "fonts are embedded");
    assert!(!has(b"/CreationDate") && !has(b"xmp:CreateDate"), "no date");
    assert!(bytes.starts_with(b"%PDF-1.5"), "pdfTeX warns of newer versions at each figure");
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
    for broken in [
        &b""[..],
        b"\x89PNG",
        b"%PDF-1.5",
        b"<metadata id=\"recipe\">",
        &png[..png.len() / 2],
        &pdf[..pdf.len() / 2],
        &[0xff; 40],
    ] {
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
    for size in [
        PngSize::WidthPx(0),
        PngSize::WidthPx(u32::MAX),
        PngSize::Dpi(f32::NAN),
        PngSize::Dpi(-3.0),
        PngSize::Dpi(0.0),
    ] {
        assert!(render::png(&d, Theme::Print, size, None).is_err(), "{size:?}");
    }
    assert!(render::pdf(&d, Theme::Print, None).is_ok());
    assert!(render::pdf(&Drawing::default(), Theme::Print, None).is_err());
    assert!(render::png(&Drawing::default(), Theme::Print, PngSize::WidthPx(10), None).is_err());
}

/// A flatland scene in every state, on a page.
fn page(paper: Paper) -> Drawing {
    let mut page = Page { paper, title: "View-frustum culling over a kD-tree".into(), ..Page::default() };
    page.caption =
        "Frustum culling of scenes2d/street.json, step 412 of 1,093: node 37 lies outside plane 2 (−3.5 m), \
                    so its 12 walls are culled without a further test. ρ = 0.75, height 8, back-face culling \
                    on."
        .into();
    let mut picture = Drawing { size_pt: vec2(228.0, 150.0), ..Drawing::default() };
    picture.title = "Step 412".into();
    let mut states = Role::STATES.into_iter().cycle();
    for i in 0..24u32 {
        let at = vec2(12.0 + (i % 6) as f32 * 36.0, 14.0 + (i / 6) as f32 * 32.0);
        let role = states.next().expect("a cycle never ends");
        let corners = vec![at, at + vec2(24.0, 2.0), at + vec2(22.0, 18.0), at + vec2(2.0, 16.0)];
        picture.push(Layer::Scene, role, Subject::Prim(PrimId(i)), Mark::Area(corners));
    }
    let eye = vec2(20.0, 130.0);
    for far in [vec2(226.0, 20.0), vec2(226.0, 130.0)] {
        picture.line(Layer::Frustum, Role::Eye, Subject::Eye, [eye, far]);
    }
    picture.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Dot { at: eye, radius_pt: 3.0 });
    picture.push(
        Layer::Evidence,
        Role::Evidence,
        Subject::Plane(2),
        Mark::Arrow(vec2(120.0, 75.0), vec2(128.0, 52.0)),
    );
    picture.outline(
        Layer::Emphasis,
        Role::Current,
        Subject::None,
        [vec2(116.0, 74.0), vec2(150.0, 74.0), vec2(150.0, 100.0), vec2(116.0, 100.0)],
    );
    axis::scale_bar(&mut picture, vec2(150.0, 146.0), 7.3, 70.0, "m");
    page.legend = legend(&picture);
    page.compose(&picture)
}

#[test]
fn a_page_is_the_golden_text() {
    let column = page(Paper::Column);
    golden(
        "page-column.svg",
        &render::svg(&column, Theme::Print, &SvgOptions { metadata: Some(RECIPE), ..SvgOptions::default() }),
    );
    for (name, paper) in [("column", Paper::Column), ("two", Paper::TwoColumns), ("slide", Paper::Slide)] {
        look_at(
            &format!("page-{name}.png"),
            &render::png(&page(paper), Theme::Print, PngSize::Dpi(200.0), None).expect("a picture"),
        );
        look_at(
            &format!("page-{name}.pdf"),
            &render::pdf(&page(paper), Theme::Print, None).expect("a document"),
        );
    }
}

#[test]
fn axes_can_be_read() {
    let mut d = Drawing { size_pt: vec2(240.0, 160.0), ..Drawing::default() };
    let (x, y) =
        (axis::Axis::of("triangles", [120.0, 2.0e6], true), axis::Axis::of("time in ms", [0.4, 37.0], false));
    let [min, max] = axis::axes(&mut d, &x, &y, Vec2::splat(4.0), vec2(236.0, 156.0));
    let at =
        |t: f64, ms: f64| vec2(min.x + x.place(t) * (max.x - min.x), max.y - y.place(ms) * (max.y - min.y));
    d.line(Layer::Scene, Role::Visible, Subject::None, [at(120.0, 0.4), at(1.3e4, 3.0), at(2.0e6, 37.0)]);
    golden("axes.svg", &render::svg(&d, Theme::Print, &SvgOptions { outline_text: true, metadata: None }));
    look_at("axes.png", &render::png(&d, Theme::Print, PngSize::Dpi(200.0), None).expect("a picture"));
}

/// A picture of each state alone, as an area and as a line, at one place.
fn states(theme: Theme, vision: ColorVision) -> Vec<(Role, Pixels)> {
    let place = [vec2(4.0, 4.0), vec2(64.0, 4.0), vec2(64.0, 34.0), vec2(4.0, 34.0)];
    let picture = |role: Role| {
        let mut d = Drawing { size_pt: vec2(68.0, 60.0), ..Drawing::default() };
        d.push(Layer::Scene, role, Subject::None, Mark::Area(place.to_vec()));
        d.line(Layer::Scene, role, Subject::None, [vec2(4.0, 48.0), vec2(64.0, 48.0)]);
        (role, render::pixels(&d, Look { theme, vision }, PngSize::Dpi(144.0)).expect("a picture"))
    };
    Role::STATES.into_iter().map(picture).collect()
}

/// How many pixels, of those from row to row, differ in lightness so that one sees it.
fn apart(a: &Pixels, b: &Pixels, rows: std::ops::Range<usize>) -> usize {
    let part = |p: &Pixels| {
        let row = 4 * p.width as usize;
        p.rgba[row * rows.start..row * rows.end].to_vec()
    };
    let (a, b) = (part(a), part(b));
    let light = |p: &[u8]| (u32::from(p[0]) * 3 + u32::from(p[1]) * 6 + u32::from(p[2])) / 10;
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
    pixels.filter(|(a, b)| light(a).abs_diff(light(b)) > 20).count()
}

#[test]
fn states_are_told_apart_without_color_in_what_is_drawn() {
    for theme in Theme::ALL {
        let shown = states(theme, ColorVision::Gray);
        let mut worst = [(usize::MAX, Role::Ink, Role::Ink); 2];
        for (i, (one, a)) in shown.iter().enumerate() {
            for (other, b) in &shown[..i] {
                for (k, rows) in [8..68, 88..104].into_iter().enumerate() {
                    let count = apart(a, b, rows);
                    worst[k] = if count < worst[k].0 { (count, *one, *other) } else { worst[k] };
                }
            }
        }
        // Areas, where the least is a sign, and lines of a point, where it is their dashes: a square
        // millimeter has 32 pixels.
        assert!(worst[0].0 > 36 && worst[1].0 > 36, "{}: {worst:?}", theme.name());
    }
}
