//! `cullscope figure`: the papers' figures as files.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::{fs, io};

use super::error::reason;
use super::progress::Bar;
use super::{CliError, output, suggest};
use crate::papers::{self, Figure};
use crate::render::{self, Format, SvgOptions, Theme};
use crate::scene::Progress;

#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  cullscope figure coorg-teller-figure-4 --format svg,pdf --out figures\n  \
                  cullscope figure --list\n  cullscope figure --all\n\n\
                  For LaTeX write pdf and use \\includegraphics. With the svg package TeX sets the text: \
                  it runs out of the page, and signs like _ and % stop TeX."
)]
pub(super) struct Args {
    /// Which figures; --list names them
    #[arg(value_name = "NAME", conflicts_with_all = ["all", "list"])]
    names: Vec<String>,
    /// All of them
    #[arg(long, conflicts_with = "list")]
    all: bool,
    /// List the figures instead
    #[arg(long)]
    list: bool,
    /// File formats, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "svg")]
    format: Vec<Format>,
    /// Colors
    #[arg(long, value_enum, default_value = "print")]
    theme: Colors,
    /// Letters in SVG files; PDF files carry their fonts, PNG files have none
    #[arg(long, value_enum, default_value = "fonts")]
    text: Letters,
    /// Folder for the files; it is made if it is missing
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
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

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    if args.list {
        let mut text = String::new();
        for figure in papers::figures() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:<28} {}", figure.name, figure.summary);
        }
        return output::print(text.as_bytes());
    }
    let figures = chosen(args)?;
    let theme = match args.theme {
        Colors::Light => Theme::Light,
        Colors::Dark => Theme::Dark,
        Colors::Print => Theme::Print,
    };
    let formats: BTreeSet<Format> = args.format.iter().copied().collect();
    fs::create_dir_all(&args.out).map_err(|e| {
        let taken = e.kind() == io::ErrorKind::AlreadyExists;
        let why = if taken { "this is a file, not a folder".into() } else { reason(&e) };
        CliError::work(args.out.display().to_string(), why)
    })?;
    let bar = Bar::new();
    for (i, figure) in figures.iter().enumerate() {
        bar.report(i as f32 / figures.len() as f32, "making figures");
        if bar.cancelled() {
            return Err(CliError::Interrupted);
        }
        let drawing = figure.drawing(&|role| theme.flat_linear(role))?;
        let outline_text = args.text == Letters::Paths;
        let letters = if outline_text { " --text paths" } else { "" };
        let recipe = format!("cullscope figure {} --theme {}{letters}", figure.name, theme.name());
        for format in &formats {
            let bytes = match format {
                Format::Svg => {
                    let options = SvgOptions { outline_text, metadata: Some(&recipe) };
                    render::svg(&drawing, theme, &options).into_bytes()
                }
                Format::Pdf | Format::Png => render::export(&drawing, *format, theme, &recipe)
                    .map_err(|e| CliError::work(figure.name, e.to_string()))?,
            };
            let path = args.out.join(format!("{}.{}", figure.name, format.name()));
            output::write_file(&path, |to| to.write_all(&bytes).map(|()| true))?;
            output::print(format!("{}\n", path.display()).as_bytes())?;
        }
    }
    Ok(())
}

fn chosen(args: &Args) -> Result<Vec<&'static Figure>, CliError> {
    let known: Vec<&str> = papers::figures().map(|f| f.name).collect();
    if args.all {
        return Ok(papers::figures().collect());
    }
    if args.names.is_empty() {
        return Err(CliError::words("figure", "no figure is named")
            .with_help(format!("give a NAME or --all; figures: {}", known.join(", "))));
    }
    let find = |name: &String| {
        let missing = || {
            let help = match papers::table(name) {
                Some(table) => format!("it is a table: `cullscope paper {}` measures it", table.name),
                None => suggest::help(name, &known, "figures"),
            };
            CliError::words(name.as_str(), "there is no such figure").with_help(help)
        };
        let figure = papers::figure(name).ok_or_else(missing)?;
        if figure.name != name {
            output::say(&format!("note: figure `{name}` is called `{}` now", figure.name));
        }
        Ok(figure)
    };
    args.names.iter().map(find).collect()
}
