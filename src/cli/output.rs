//! Results: to standard output, or to a file.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::builder::PossibleValue;

use super::CliError;
use crate::app;
use crate::render::Format;

/// Bytes to standard output.
pub(super) fn print(bytes: &[u8]) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|e| CliError::write("standard output", &e))
}

/// A line to standard error; a closed one is no reason to stop.
pub(super) fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Lets `fill` write to `out`, or to standard output if there is none. What `fill` says of `Ok(false)` is
/// an interruption: a file is then not kept.
pub(super) fn emit(
    out: Option<&Path>,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<bool>,
) -> Result<(), CliError> {
    let Some(path) = out else {
        let mut to = BufWriter::with_capacity(1 << 16, io::stdout().lock());
        let done = fill(&mut to).and_then(|done| to.flush().map(|()| done));
        return match done {
            Ok(true) => Ok(()),
            Ok(false) => Err(CliError::Interrupted),
            Err(e) => Err(CliError::write("standard output", &e)),
        };
    };
    write_file(path, fill)
}

/// Writes a file whole or not at all.
pub(super) fn write_file(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<bool>,
) -> Result<(), CliError> {
    match app::write_whole(path, fill) {
        Ok(true) => Ok(()),
        Ok(false) => Err(CliError::Interrupted),
        Err(e) => Err(CliError::write(&path.display().to_string(), &e)),
    }
}

/// `NAME.png` for a single image, `NAME-000.png` … for several.
pub(super) fn numbered(path: &Path, index: usize, count: usize) -> PathBuf {
    if count == 1 {
        return path.to_owned();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or_else(|| "png".into(), |e| e.to_string_lossy());
    path.with_file_name(format!("{stem}-{index:03}.{extension}"))
}

impl clap::ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }
    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()))
    }
}
