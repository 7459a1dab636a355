//! The figures of the papers: made, the same each time, equal to the files in screenshots/figures, and right
//! in a program that reads neither embedded fonts nor style sheets and smooths images: librsvg.
//!
//! `UPDATE_FIGURES=1 cargo test --test figures` writes the files anew, but for figures of steps, which
//! `tests/cli/gallery.rs` holds to what the program writes; with `FIGURES_OUT=folder` the figures are also
//! left there as PNG, to be looked at.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use cullscope::drawing::{Drawing, Mark, Pixels};
use cullscope::papers::{figure, figures, index, owns};
use cullscope::render::{PngSize, SvgOptions, Theme, pdf, png, svg};
use glam::{Vec2, vec2};
use rayon::prelude::*;

/// Every figure with its name, drawn once for all tests.
fn drawn() -> &'static [(&'static str, Drawing)] {
    static DRAWN: OnceLock<Vec<(&str, Drawing)>> = OnceLock::new();
    let tint = |role| Theme::Print.flat_linear(role);
    DRAWN.get_or_init(|| {
        let draw =
            |f: &cullscope::papers::Figure| f.drawing(&tint).unwrap_or_else(|e| panic!("{}: {e}", f.name));
        figures().map(|f| (f.name, draw(f))).collect()
    })
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("screenshots/figures")
}

#[test]
fn figures_are_what_is_shown_in_the_documentation() {
    for (name, drawing) in drawn() {
        let recipe = format!("cullscope figure {name} --theme print");
        let options = SvgOptions { metadata: Some(&recipe), ..SvgOptions::default() };
        let text = svg(drawing, Theme::Print, &options);
        let path = folder().join(name).with_extension("svg");
        if let Some(out) = std::env::var_os("FIGURES_OUT") {
            let bytes = png(drawing, Theme::Print, PngSize::Dpi(144.0), None).expect("a picture");
            fs::write(Path::new(&out).join(name).with_extension("png"), bytes)
                .expect("the picture can be written");
        }
        if std::env::var_os("UPDATE_FIGURES").is_some() {
            fs::create_dir_all(folder()).expect("the folder");
            fs::write(&path, text).expect("the figure can be written");
            continue;
        }
        let golden = fs::read_to_string(&path)
            .unwrap_or_else(|e| panic!("{}: {e}; UPDATE_FIGURES=1 writes it", path.display()));
        assert!(
            text == golden,
            "{name} differs from its file; if that is meant, UPDATE_FIGURES=1 writes it anew"
        );
    }
}

#[test]
fn the_page_of_the_gallery_lists_what_is_there() {
    let path = folder().join("README.md");
    if std::env::var_os("UPDATE_FIGURES").is_some() {
        fs::write(&path, index()).expect("the page can be written");
    }
    let page = fs::read_to_string(&path).expect("screenshots/figures/README.md");
    assert!(
        page == index(),
        "{} differs from what is listed now: UPDATE_FIGURES=1 writes it",
        path.display()
    );
    let mut there: Vec<String> =
        figures().map(|f| f.name).chain(owns().map(|o| o.name)).map(svg_name).collect();
    for name in &there {
        assert!(page.contains(&format!("]({name})")), "{name} is not on the page");
    }
    there.push("README.md".into());
    there.sort();
    let entries = fs::read_dir(folder()).expect("screenshots/figures").map(|e| e.expect("an entry"));
    let mut files: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    files.sort();
    assert_eq!(files, there, "`cullscope figure --gallery screenshots/figures` writes what is missing");
}

fn svg_name(name: &str) -> String {
    format!("{name}.svg")
}

#[test]
fn figures_are_the_same_bytes_each_time_in_every_format() {
    let tint = |role| Theme::Print.flat_linear(role);
    let figure = figure("baselines-frustum-tests").expect("a figure");
    let files = || {
        let drawing = figure.drawing(&tint).expect("a figure");
        let svg = svg(&drawing, Theme::Print, &SvgOptions::default()).into_bytes();
        [
            svg,
            pdf(&drawing, Theme::Print, None).expect("a file"),
            png(&drawing, Theme::Print, PngSize::Dpi(96.0), None).expect("a picture"),
        ]
    };
    assert!(files() == files());
}

#[test]
fn every_figure_has_a_title_a_caption_and_ink() {
    for (name, drawing) in drawn() {
        assert!(!drawing.title.is_empty() && drawing.description.len() > 60, "{name}");
        assert!(drawing.items.len() > 10 && drawing.size_pt.min_element() > 100.0, "{name}");
    }
}

/// What LibreOffice, MuPDF, Skia and Inkscape 1.2 leave out of a file.
#[test]
fn no_figure_needs_what_programs_do_not_read() {
    let (mut images, mut hatches) = (0, 0);
    for (name, drawing) in drawn() {
        for outline_text in [false, true] {
            let text = svg(drawing, Theme::Print, &SvgOptions { outline_text, metadata: None });
            for line in text.split("<style").skip(1).flat_map(|s| s.split("</style>").next()) {
                let rules = line.trim_start_matches('>').lines().filter(|l| !l.is_empty());
                let others: Vec<&str> = rules.filter(|l| !l.starts_with("@font-face {")).collect();
                assert!(others.is_empty(), "{name}: a rule of a style sheet paints: {others:?}");
            }
            for lost in ["<pattern", "<polygon", "clip-path"] {
                assert!(!text.contains(lost), "{name}: {lost}");
            }
            for tag in text.split('<').filter(|tag| tag.starts_with("image ")) {
                assert!(
                    tag.contains(" xlink:href=\"data:") && !tag.contains(" href="),
                    "{name}: an image is linked by href alone"
                );
                images += 1;
            }
            hatches += text.matches("class=\"hatch ").count();
            let root = text.split('>').next().unwrap_or_default();
            assert!(root.contains(" xmlns:xlink=\"http://www.w3.org/1999/xlink\""), "{name}: {root}");
        }
    }
    assert!(images > 20 && hatches > 20, "figures with images and with hatches are among them");
}

/// What librsvg paints of an SVG text at a zoom (of 96 dots an inch), with the fonts that a configuration
/// of fontconfig has.
fn painted(text: &str, zoom: f32, fonts: Option<&OsStr>) -> Pixels {
    let mut command = Command::new("rsvg-convert");
    command
        .args(["--format", "png", "--zoom", &zoom.to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped());
    command.envs(fonts.map(|file| ("FONTCONFIG_FILE", file)));
    let missing = "rsvg-convert is missing: `.ci/setup test` installs it (Debian package librsvg2-bin)";
    let mut child = command.spawn().unwrap_or_else(|e| panic!("{missing}: {e}"));
    let mut input = child.stdin.take().expect("a pipe");
    let output = std::thread::scope(|threads| {
        // A full pipe must not stop both sides.
        threads.spawn(move || input.write_all(text.as_bytes()));
        child.wait_with_output().expect("rsvg-convert ends")
    });
    assert!(output.status.success(), "rsvg-convert: {}", output.status);
    let mut reader =
        ::png::Decoder::new(std::io::Cursor::new(output.stdout)).read_info().expect("a PNG file");
    let mut rgba = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut rgba).expect("a picture");
    let kind = (info.color_type, info.bit_depth);
    assert_eq!(kind, (::png::ColorType::Rgba, ::png::BitDepth::Eight), "what librsvg writes");
    Pixels { width: info.width, height: info.height, rgba: rgba.into() }
}

/// A configuration of fontconfig with DejaVu Sans alone: the widest of the fonts that systems come with.
fn wide_fonts() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wide-fonts");
    fs::create_dir_all(&folder).expect("the folder");
    let file = folder.join("fonts.conf");
    let family = "<pattern><patelt name=\"family\"><string>DejaVu Sans</string></patelt></pattern>";
    let any = "<pattern><patelt name=\"scalable\"><bool>true</bool></patelt></pattern>";
    let text = format!(
        "<fontconfig><dir>/usr/share/fonts</dir><dir>/usr/local/share/fonts</dir><cachedir>{}</cachedir>\
         <selectfont><rejectfont>{any}</rejectfont><acceptfont>{family}</acceptfont></selectfont>\
         </fontconfig>\n",
        folder.join("cache").display()
    );
    fs::write(&file, text).expect("the configuration can be written");
    // Eight letters W of 50 px are 396 px wide in DejaVu Sans, 378 px in fonts of Arial's widths.
    let probe = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"500\" height=\"80\"><text y=\"60\" \
                 font-family=\"Inter, sans-serif\" font-size=\"50\">WWWWWWWW</text></svg>";
    let shown = painted(probe, 1.0, Some(file.as_os_str()));
    let inked = |x: &u32| (0..shown.height).any(|y| shown.rgba[4 * (y * shown.width + x) as usize + 3] > 128);
    let right = (0..shown.width).rev().find(inked).unwrap_or(0);
    assert!(
        (388..=400).contains(&right),
        "DejaVu Sans is missing: `.ci/setup test` installs it (Debian package fonts-dejavu-core); {right} px"
    );
    file
}

/// In the fonts that are there, and in the widest, which takes the place of ours on many systems.
#[test]
fn nothing_leaves_the_page_in_librsvg() {
    let wide = wide_fonts();
    let runs: Vec<_> = drawn().iter().flat_map(|f| [(f, None), (f, Some(wide.as_os_str()))]).collect();
    let leaving: Vec<String> = runs
        .into_par_iter()
        .filter_map(|((name, drawing), fonts)| {
            // The page in the middle of a larger one, without its paper: what is not transparent was painted.
            let size = drawing.size_pt;
            let text = svg(drawing, Theme::Print, &SvgOptions::default());
            let (root, body) = text.split_once('>').expect("an element");
            let start = root.find(" width=").expect("its size");
            let [x, y] = [size.x, size.y].map(|s| s * 0.15);
            let [w, h] = [size.x, size.y].map(|s| s * 1.3);
            let text = format!(
                "{} width=\"{w}\" height=\"{h}\" viewBox=\"-{x} -{y} {w} {h}\">{body}",
                &root[..start]
            );
            let shown = painted(&text, 2.0, fonts);
            let (px, py) = (shown.width as f32 / w, shown.height as f32 / h);
            let outside = |i: usize| {
                let at =
                    [(i % shown.width as usize) as f32 / px - x, (i / shown.width as usize) as f32 / py - y];
                // One pixel of the page's border may shine through.
                at[0] < -1.0 || at[1] < -1.0 || at[0] > size.x + 0.5 || at[1] > size.y + 0.5
            };
            let inked = shown.rgba.chunks_exact(4).enumerate().filter(|(_, p)| p[3] > 0);
            assert!(inked.clone().count() > 1000, "{name}: nothing is painted");
            let out = inked.filter(|(i, _)| outside(*i)).count();
            (out > 0).then(|| {
                format!(
                    "{name} ({}): {out} pixels",
                    if fonts.is_some() { "DejaVu Sans" } else { "fonts of the system" }
                )
            })
        })
        .collect();
    assert!(leaving.is_empty(), "painted outside of the page: {leaving:#?}");
}

/// Whether an image covers a point or has an edge near it.
fn covers(mark: &Mark<Vec2>, at: Vec2) -> bool {
    let Mark::Image { corners: [min, max], .. } = mark else { return false };
    at.cmpge(*min - 0.25).all() && at.cmple(*max + 0.25).all()
}

/// Cells of depth images are flat up to their edges, also where images are smoothed.
#[test]
fn grids_are_sharp_in_librsvg() {
    const PX_PER_PT: f32 = 6.0;
    let mut cells = 0;
    for (name, drawing) in drawn() {
        let mut images = Drawing { size_pt: drawing.size_pt, ..Drawing::default() };
        images.items =
            drawing.items.iter().filter(|i| matches!(i.mark, Mark::Image { .. })).cloned().collect();
        if images.items.is_empty() {
            continue;
        }
        let shown = painted(&svg(&images, Theme::Print, &SvgOptions::default()), PX_PER_PT * 0.75, None);
        let color = |at: Vec2| {
            let [x, y] = (at * PX_PER_PT).to_array().map(|p| p as usize);
            &shown.rgba[4 * (y * shown.width as usize + x)..][..3]
        };
        for (k, item) in images.items.iter().enumerate() {
            let Mark::Image { corners: [min, max], pixels } = &item.mark else { continue };
            let cell = (*max - *min) / vec2(pixels.width as f32, pixels.height as f32);
            // Of a cell of few pixels nothing can be said.
            if cell.min_element() * PX_PER_PT < 6.0 {
                continue;
            }
            let covered = |at: Vec2| images.items[k + 1..].iter().any(|above| covers(&above.mark, at));
            for (i, wanted) in pixels.rgba.chunks_exact(4).enumerate() {
                let (x, y) = (i % pixels.width as usize, i / pixels.width as usize);
                for part in [[0.5, 0.5], [0.2, 0.2], [0.8, 0.2], [0.2, 0.8], [0.8, 0.8]] {
                    let at = *min + cell * (vec2(x as f32, y as f32) + Vec2::from(part));
                    if !covered(at) {
                        assert_eq!(color(at), &wanted[..3], "{name}: image {k}, cell {x}, {y} at {part:?}");
                    }
                }
                cells += 1;
            }
        }
    }
    assert!(cells > 1000, "{cells} cells were looked at");
}
