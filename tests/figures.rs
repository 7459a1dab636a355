//! The figures of the papers: made, the same each time, and equal to the files in screenshots/figures.
//!
//! `UPDATE_FIGURES=1 cargo test --test figures` writes the files anew; with `FIGURES_OUT=folder` the
//! figures are also left there as PNG, to be looked at.

use std::fs;
use std::path::{Path, PathBuf};

use cullscope::papers::{figure, figures};
use cullscope::render::{PngSize, SvgOptions, Theme, pdf, png, svg};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("screenshots/figures")
}

#[test]
fn figures_are_what_is_shown_in_the_documentation() {
    let tint = |role| Theme::Print.flat_linear(role);
    for figure in figures() {
        let drawing = figure.drawing(&tint).unwrap_or_else(|e| panic!("{}: {e}", figure.name));
        let text = svg(&drawing, Theme::Print, &SvgOptions::default());
        let path = folder().join(figure.name).with_extension("svg");
        if let Some(out) = std::env::var_os("FIGURES_OUT") {
            let bytes = png(&drawing, Theme::Print, PngSize::Dpi(144.0), None).expect("a picture");
            fs::write(Path::new(&out).join(figure.name).with_extension("png"), bytes)
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
            "{} differs from its file; if that is meant, UPDATE_FIGURES=1 writes it anew",
            figure.name
        );
    }
}

#[test]
fn every_file_in_the_folder_is_a_figure() {
    for entry in fs::read_dir(folder()).expect("screenshots/figures").map(|e| e.expect("an entry").path()) {
        let stem = entry.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!(figures().any(|f| f.name == stem), "{} is no figure any more: delete it", entry.display());
    }
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
    let tint = |role| Theme::Print.flat_linear(role);
    for figure in figures() {
        let drawing = figure.drawing(&tint).expect("a figure");
        assert!(!drawing.title.is_empty() && drawing.description.len() > 60, "{}", figure.name);
        assert!(drawing.items.len() > 10 && drawing.size_pt.min_element() > 100.0, "{}", figure.name);
    }
}
