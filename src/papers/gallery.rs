//! The gallery: the page that lists every figure, plate and table of the papers with what is ours of it.

use std::fmt::Write as _;

use super::paper::{Figure, Paper, Source};
use super::shown::{Ours, Own, Shown};
use super::{PAPERS, figure, table};
use crate::drawing::words::capitalized;
use crate::measure::Experiment;

/// The gallery's figures of one's own, in the order of lists.
pub fn owns() -> impl Iterator<Item = &'static Own> {
    let all = PAPERS.iter().flat_map(|paper| paper.shown).flat_map(|shown| shown.ours);
    all.filter_map(|ours| if let Ours::Own(own) = ours { Some(own) } else { None })
}

/// Width of a small picture on the page, pixels.
const THUMBNAIL_PX: u32 = 260;

/// The page that lists the gallery, as Markdown; pictures lie beside it, as SVG.
pub fn index() -> String {
    let mut page = String::from(
        "# The gallery\n\nEvery figure, plate and table of the papers that shows the algorithm, as one of \
         ours, with the command that makes it. Each picture is a link to its file.\n\n`cullscope figure \
         --gallery screenshots/figures` writes all of this folder, in the folder of the repository; \
         `cullscope figure --check screenshots/figures` makes its figures again and compares. Tables are \
         measured on the machine at hand, so they are not here; their commands print them beside the \
         paper's numbers.\n",
    );
    for paper in PAPERS {
        add(&mut page, paper);
    }
    page
}

fn add(page: &mut String, paper: &Paper) {
    let sources = paper.sources();
    // Writing to a string cannot fail.
    match &sources[..] {
        [source] => {
            let _ = write!(page, "\n## {}\n\n{}", source.title, doi(source));
        }
        _ => {
            let _ = writeln!(page, "\n## {}\n", capitalized(paper.key));
            for source in &sources {
                *page += format!("- {} {}", source.title, doi(source)).trim_end();
                *page += "\n";
            }
        }
    }
    if !paper.shown.is_empty() {
        *page += "\n| in the paper | what it shows | ours |\n|---|---|---|\n";
        for shown in paper.shown {
            let ours: Vec<String> = shown.ours.iter().map(|ours| cell(ours, shown.what)).collect();
            let ours = if ours.is_empty() { "see below".to_owned() } else { ours.join("<br>") };
            let _ = writeln!(page, "| {} | {} | {ours} |", shown.number, shown.what);
        }
    }
    let (figures, tables) = unnamed(paper);
    if !figures.is_empty() || !tables.is_empty() {
        let more = if paper.shown.is_empty() { "" } else { "More of ours:\n\n" };
        let _ = write!(page, "\n{more}| what it shows | ours |\n|---|---|\n");
        for figure in figures {
            let _ = writeln!(page, "| {} | {} |", figure.summary, drawn(figure, figure.summary));
        }
        for table in tables {
            let _ = writeln!(page, "| {} | {} |", table.summary, measured(table.name));
        }
    }
    let lacking: Vec<&Shown> = paper.shown.iter().filter(|shown| !shown.instead.is_empty()).collect();
    if !lacking.is_empty() {
        *page += "\nWhat cannot be had, and what takes its place:\n\n";
        for shown in lacking {
            let _ = writeln!(page, "- {}: {}", shown.number, shown.instead);
        }
    }
}

/// A line with the identifier as a link; nothing where there is none.
fn doi(source: &Source) -> String {
    let doi = source.doi;
    if doi.is_empty() { String::new() } else { format!("[doi:{doi}](https://doi.org/{doi})\n") }
}

/// The figures and tables of a paper that stand for none of what it shows.
fn unnamed(paper: &Paper) -> (Vec<&'static Figure>, Vec<&'static Experiment>) {
    let is_named = |name: &str| {
        paper.shown.iter().flat_map(|shown| shown.ours).any(|ours| match ours {
            Ours::Figure(of) | Ours::Table(of) => *of == name,
            Ours::Own(_) => false,
        })
    };
    let figures = paper.figures.iter().filter(|figure| !is_named(figure.name));
    (figures.collect(), paper.tables.iter().filter(|table| !is_named(table.name)).collect())
}

/// What is ours, in a cell of the page's tables.
fn cell(ours: &Ours, what: &str) -> String {
    match ours {
        Ours::Figure(name) => figure(name).map_or_else(String::new, |figure| drawn(figure, figure.summary)),
        Ours::Table(name) => table(name).map_or_else(String::new, |table| measured(table.name)),
        Ours::Own(own) => format!("{}<br>`{}`", picture(own.name, what), own.words().join(" ")),
    }
}

fn drawn(figure: &Figure, what: &str) -> String {
    format!("{}<br>`cullscope figure {}`", picture(figure.name, what), figure.name)
}

fn measured(name: &str) -> String {
    format!("`cullscope paper {name}`")
}

/// A small picture that is a link to its file.
fn picture(name: &str, what: &str) -> String {
    format!("[<img src=\"{name}.svg\" width=\"{THUMBNAIL_PX}\" alt=\"{what}\">]({name}.svg)")
}
