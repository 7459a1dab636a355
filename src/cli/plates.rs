//! How figure files look and where they go: the options that both forms of `cullscope figure` have.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{fs, io};

use super::error::reason;
use super::progress::Bar;
use super::{CliError, output};
use crate::papers::Figure;
use crate::render::{self, Format, SvgOptions, Theme};
use crate::scene::Progress;

#[derive(clap::Args)]
pub(super) struct Files {
    /// File formats, separated by commas [default: svg; pdf for pages, png for an animation]
    #[arg(long, value_enum, value_delimiter = ',')]
    format: Vec<Format>,
    /// Colors [default: print, or those of the figure that is reopened]
    #[arg(long, value_enum)]
    theme: Option<Colors>,
    /// Letters in SVG files; PDF files carry their fonts, PNG files have none
    #[arg(long, value_enum, default_value = "fonts")]
    text: Letters,
    /// Folder for the files; it is made if it is missing
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// The name of the only file, where it has one of its own.
    #[arg(skip)]
    name: Option<&'static str>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Colors {
    Light,
    Dark,
    Print,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Letters {
    /// Text that can be found and edited; where our font is not read, in a similar one
    Fonts,
    /// Outlines: the same in every program, but no longer text
    Paths,
}

impl Files {
    /// SVG files for documents in a folder, as with no other options; with a name for the only one.
    pub fn svg_in(folder: &Path, name: Option<&'static str>) -> Self {
        Self { format: vec![Format::Svg], theme: None, text: Letters::Fonts, out: folder.to_owned(), name }
    }
    /// The theme, if one is asked for.
    pub fn theme(&self) -> Option<Theme> {
        self.theme.map(|colors| match colors {
            Colors::Light => Theme::Light,
            Colors::Dark => Theme::Dark,
            Colors::Print => Theme::Print,
        })
    }
    pub fn outline_text(&self) -> bool {
        self.text == Letters::Paths
    }
    /// Each format once; this one if none is asked for.
    pub fn formats(&self, usual: Format) -> BTreeSet<Format> {
        if self.format.is_empty() { [usual].into() } else { self.format.iter().copied().collect() }
    }
    /// Makes the folder.
    pub fn prepare(&self) -> Result<(), CliError> {
        fs::create_dir_all(&self.out).map_err(|e| {
            let taken = e.kind() == io::ErrorKind::AlreadyExists;
            let why = if taken { "this is a file, not a folder".into() } else { reason(&e) };
            CliError::work(self.out.display().to_string(), why)
        })
    }
    /// Where a file of this name goes.
    pub fn path(&self, name: &str, format: Format) -> PathBuf {
        self.out.join(format!("{}.{}", self.name.unwrap_or(name), format.name()))
    }
}

/// How a figure looks.
#[derive(Clone, Copy)]
pub(super) struct Plate {
    pub theme: Theme,
    pub outline_text: bool,
}

impl Plate {
    /// The bytes of a built-in figure.
    pub fn built_in(self, figure: &Figure, format: Format) -> Result<Vec<u8>, CliError> {
        let Self { theme, outline_text } = self;
        let drawing = figure.drawing(&|role| theme.flat_linear(role))?;
        let letters = if outline_text { " --text paths" } else { "" };
        let recipe = format!("cullscope figure {} --theme {}{letters}", figure.name, theme.name());
        if format == Format::Svg {
            let options = SvgOptions { outline_text, metadata: Some(&recipe) };
            return Ok(render::svg(&drawing, theme, &options).into_bytes());
        }
        render::export(&drawing, format, theme, &recipe)
            .map_err(|e| CliError::work(figure.name, e.to_string()))
    }
}

/// Writes built-in figures.
pub(super) fn write_built_in(figures: &[&Figure], files: &Files) -> Result<(), CliError> {
    files.prepare()?;
    let bar = Bar::new();
    let plate = Plate { theme: files.theme().unwrap_or(Theme::Print), outline_text: files.outline_text() };
    for (i, figure) in figures.iter().enumerate() {
        bar.report(i as f32 / figures.len() as f32, "making figures");
        if bar.cancelled() {
            return Err(CliError::Interrupted);
        }
        for format in files.formats(Format::Svg) {
            write(&files.path(figure.name, format), &plate.built_in(figure, format)?)?;
        }
    }
    Ok(())
}

/// Writes a file whole and prints its path.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    output::write_file(path, |to| to.write_all(bytes).map(|()| true))?;
    output::print(format!("{}\n", path.display()).as_bytes())
}
