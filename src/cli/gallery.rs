//! `cullscope figure --gallery`: all figures of the papers, and the page that lists them.

use std::path::Path;

use clap::Parser;

use super::CliError;
use super::plates::{Files, write, write_built_in};
use super::snapshot::{self, Snapshot};
use crate::papers::{self, Own};

/// The page, named so that a repository shows it below the list of files.
const PAGE: &str = "README.md";
/// How a scene begins that is no file.
const GENERATED: &str = "generate:";

/// The words of a figure of one's own, those after `cullscope`.
#[derive(Parser)]
struct Words {
    #[command(flatten)]
    own: Snapshot,
}

pub(super) fn run(folder: &Path) -> Result<(), CliError> {
    // Before the work: every command is one, and its scene is there.
    let owns = papers::owns().map(read).collect::<Result<Vec<_>, _>>()?;
    let figures: Vec<_> = papers::figures().collect();
    write_built_in(&figures, &Files::svg_in(folder, None))?;
    for (name, scene, own) in &owns {
        snapshot::run(own, scene, &Files::svg_in(folder, Some(name)))?;
    }
    write(&folder.join(PAGE), papers::index().as_bytes())
}

/// The name of a figure, its scene, and what its command says.
fn read(own: &Own) -> Result<(&'static str, &'static str, Snapshot), CliError> {
    if !own.scene.starts_with(GENERATED) && !Path::new(own.scene).is_file() {
        return Err(CliError::work(own.scene, "there is no such file here")
            .with_help("scenes of the gallery are in the repository: go to its folder"));
    }
    // To the parser of a subcommand its name is that of the program.
    let read = Words::try_parse_from(&own.words()[1..]);
    let why = |error: clap::Error| {
        error.to_string().lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
    };
    let read = read.map_err(|error| CliError::words(own.name, why(error)))?;
    Ok((own.name, own.scene, read.own))
}
