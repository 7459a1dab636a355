//! `cullscope figure`: the papers' figures as files.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::plates::{self, Files};
use super::snapshot::{self, Snapshot};
use super::{CliError, gallery, output, remake, suggest};
use crate::papers::{self, Figure};

#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  cullscope figure coorg-teller-figure-4 --format svg,pdf --out figures\n  \
                  cullscope figure --list\n  cullscope figure --all\n  \
                  cullscope figure --scene scenes2d/street.json --method hierarchical-z --first-hidden \
                  --picture all --paper column\n  cullscope figure --check figures\n  \
                  cullscope figure --gallery gallery\n\n\
                  Every file carries how it was made: the explorer opens it where it was, and its text has \
                  the command that makes it again in its folder.\n\n\
                  For LaTeX write pdf and use \\includegraphics. With the svg package TeX sets the text: \
                  it runs out of the page, and signs like _ and % stop TeX."
)]
pub(super) struct Args {
    /// Which built-in figures; --list names them
    #[arg(value_name = "NAME", conflicts_with_all = ["all", "list"])]
    names: Vec<String>,
    /// All of them
    #[arg(long, conflicts_with = "list")]
    all: bool,
    /// List the built-in figures instead
    #[arg(long)]
    list: bool,
    /// Make every figure in a folder again, and name those that differ
    #[arg(long, value_name = "DIR", conflicts_with_all = ["names", "all", "list", "scene"])]
    check: Option<PathBuf>,
    /// Write all figures of the papers into a folder, with a page that lists what each paper shows
    #[arg(
        long,
        value_name = "DIR",
        conflicts_with_all = ["names", "all", "list", "check", "scene", "format", "theme", "text", "out"]
    )]
    gallery: Option<PathBuf>,
    #[command(flatten)]
    files: Files,
    #[command(flatten)]
    own: Snapshot,
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
    if let Some(folder) = &args.check {
        return remake::run(folder);
    }
    args.own.refuse_lone()?;
    if let Some(scene) = &args.own.scene {
        return match args.names.first() {
            None if !args.all => snapshot::run(&args.own, scene, &args.files),
            name => Err(CliError::words(name.map_or("--all", String::as_str), "cannot be used with --scene")
                .with_help("built-in figures have scenes of their own: give names, or a scene")),
        };
    }
    if let Some(folder) = &args.gallery {
        return gallery::run(folder);
    }
    plates::write_built_in(&chosen(args)?, &args.files)
}

fn chosen(args: &Args) -> Result<Vec<&'static Figure>, CliError> {
    let known: Vec<&str> = papers::figures().map(|f| f.name).collect();
    if args.all {
        return Ok(papers::figures().collect());
    }
    if args.names.is_empty() {
        return Err(CliError::words("figure", "no figure is named").with_help(format!(
            "give a NAME, --all, or --scene and --method; figures: {}",
            known.join(", ")
        )));
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
