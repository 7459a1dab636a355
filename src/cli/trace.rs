//! `cullscope trace check`: whether a recorded run keeps to the trace format.

use std::fs::File;
use std::io::BufReader;

use super::{CliError, error::reason, output};
use crate::trace::format;

#[derive(clap::Subcommand)]
pub(super) enum Command {
    /// Validate a trace and name its first bad line
    #[command(after_help = "Example:\n  cullscope trace check run.jsonl")]
    Check {
        /// A trace, as `cullscope step` writes it
        #[arg(value_name = "FILE")]
        file: String,
    },
}

pub(super) fn run(command: &Command) -> Result<(), CliError> {
    let Command::Check { file } = command;
    let opened = File::open(file).map_err(|e| CliError::work(file, reason(&e)))?;
    let summary = format::check(BufReader::new(opened)).map_err(|e| CliError::work(format!("{file}:{}", e.line()), e.why()))?;
    let (method, scene) = (&summary.header.method, &summary.header.scene);
    let text = format!("{file}: valid: {} events in {} frames of `{method}` on {scene}\n", summary.events, summary.frames);
    output::print(text.as_bytes())
}
