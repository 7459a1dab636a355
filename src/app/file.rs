//! A file that is written beside its place and renamed into it, so that nobody ever finds half a file.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files being written, so that an impatient Ctrl-C can take them away.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes away the files that were not finished.
pub fn discard_unfinished() {
    for path in unfinished().drain(..) {
        // Nothing better can be done with a file that refuses to go.
        let _ = fs::remove_file(path);
    }
}

/// Writes a file whole or not at all; a device or a pipe is written in place. Returns what `fill` returns:
/// `false` stands for an interruption, and the file is then not kept.
///
/// # Errors
/// If the file cannot be written, or `fill` fails.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<bool>) -> io::Result<bool> {
    // A device or pipe has no beside.
    let special = fs::metadata(path).is_ok_and(|m| !m.is_file());
    let beside = Beside::new(path, special);
    let mut to = BufWriter::with_capacity(1 << 16, fs::File::create(&beside.path)?);
    let done = fill(&mut to)?;
    to.flush()?;
    if !done {
        return Ok(false);
    }
    drop(to);
    if !special {
        fs::rename(&beside.path, path)?;
    }
    Ok(true)
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
