//! Results: to standard output, or to a file that is written beside its place and renamed into it, so that
//! nobody ever finds half a file.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::CliError;

/// Files being written, so that an impatient Ctrl-C can take them away.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> std::sync::MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes away what was not finished.
pub(super) fn discard_unfinished() {
    for path in unfinished().drain(..) {
        // Nothing better can be done with a file that refuses to go.
        let _ = fs::remove_file(path);
    }
}

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
    let name = path.display().to_string();
    // A device or pipe has no beside.
    let special = fs::metadata(path).is_ok_and(|m| !m.is_file());
    let beside = Beside::new(path, special);
    let file = fs::File::create(&beside.path).map_err(|e| CliError::write(&name, &e))?;
    let mut to = BufWriter::with_capacity(1 << 16, file);
    let done =
        fill(&mut to).and_then(|done| to.flush().map(|()| done)).map_err(|e| CliError::write(&name, &e))?;
    if !done {
        return Err(CliError::Interrupted);
    }
    drop(to);
    if !special {
        fs::rename(&beside.path, path).map_err(|e| CliError::write(&name, &e))?;
    }
    Ok(())
}

/// A file on its way; taken away when dropped, unless it was renamed first.
struct Beside {
    path: PathBuf,
    special: bool,
}

impl Beside {
    fn new(path: &Path, special: bool) -> Self {
        if special {
            return Self { path: path.to_owned(), special };
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let beside = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
        unfinished().push(beside.clone());
        Self { path: beside, special }
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        if !self.special {
            let _ = fs::remove_file(&self.path);
            unfinished().retain(|p| *p != self.path);
        }
    }
}

/// An opaque RGBA image as a PNG file.
pub(super) fn write_png(path: &Path, width: u32, height: u32, rgba: &[u8]) -> Result<(), CliError> {
    write_file(path, |to| {
        let mut encoder = png::Encoder::new(to, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        writer.write_image_data(rgba).and_then(|()| writer.finish()).map_err(io::Error::other)?;
        Ok(true)
    })
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
