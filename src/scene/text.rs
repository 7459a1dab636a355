//! Reading files with care, and the lines of old text formats.
//!
//! Only regular files are opened (a device or a pipe could feed bytes for ever), each up to a limit.
//! Files that a model names must lie in the model's folder, links followed. Cost: one copy of the file.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, BufRead, Read};
use std::path::{Component, Path, PathBuf};

use super::SceneError;

/// Reads a regular file of at most `limit` bytes.
///
/// # Errors
/// [`SceneError::Io`] if it cannot be opened or read, [`SceneError::Format`] if it is no regular file or too
/// long.
pub(super) fn read_file(path: &Path, shown: &str, limit_bytes: u64) -> Result<Vec<u8>, SceneError> {
    let io = |why| SceneError::Io { path: shown.to_owned(), why };
    let format = |why: String| SceneError::Format { path: shown.to_owned(), why };
    // Checked before opening, because opening a pipe waits for its writer.
    let kind = fs::metadata(path).map_err(io)?;
    if kind.is_dir() {
        return Err(format("is a folder, not a file".into()));
    }
    if !kind.is_file() {
        return Err(format("is a device or a pipe, not a regular file".into()));
    }
    if kind.len() > limit_bytes {
        return Err(format(format!("is {} bytes long, more than the limit of {limit_bytes}", kind.len())));
    }
    let mut bytes = Vec::with_capacity(kind.len() as usize + 1);
    File::open(path).map_err(io)?.take(limit_bytes + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > limit_bytes {
        return Err(format(format!("grew beyond the limit of {limit_bytes} bytes while it was read")));
    }
    match stand_in(&bytes) {
        Some(why) => Err(format(why.into())),
        None => Ok(bytes),
    }
}

/// What to tell of bytes that only stand for the file, or hold it in another form.
pub(super) fn stand_in(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"version https://git-lfs.github.com/spec/") {
        return Some("is a Git LFS pointer, not the file itself; `git lfs pull` brings the file");
    }
    bytes.starts_with(&[0x1f, 0x8b]).then_some("is compressed with gzip; unpack it first (`gunzip`)")
}

/// Finds the file that a model in `folder` names, or the reason why it must not be opened.
pub(super) fn beside(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let relative = PathBuf::from(name.replace('\\', "/"));
    let plain = relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if relative.as_os_str().is_empty() || !plain {
        return Err("the name leads out of the model's folder, so it was not opened".into());
    }
    inside(folder, &relative)
}

/// The full path of `relative` in `folder`, unless a link leads out of the folder.
pub(super) fn inside(folder: &Path, relative: &Path) -> Result<PathBuf, String> {
    let reason = |e: io::Error| {
        if e.kind() == io::ErrorKind::NotFound { "there is no such file".to_owned() } else { e.to_string() }
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let home = folder.canonicalize().map_err(reason)?;
    let found = folder.join(relative).canonicalize().map_err(reason)?;
    if !found.starts_with(&home) {
        return Err("it is a link out of the model's folder, so it was not opened".into());
    }
    Ok(found)
}

/// The bytes after a UTF-8 byte order mark, if there is one.
///
/// # Errors
/// What to tell if the text is UTF-16.
pub(super) fn without_mark(bytes: &[u8]) -> Result<&[u8], &'static str> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("is UTF-16 text; save it as UTF-8");
    }
    Ok(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// Logical lines of a Wavefront file with the number of their first physical line: `\` at the end
/// joins the next one on, except in comments. Line ends may be LF, CR LF or CR.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// What `rest` begins with, up to and with its first line feed, as far as it is known.
    fed: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text, fed: 0, number: 0 }
    }
    /// Bytes not yet read.
    pub(super) fn left_bytes(&self) -> usize {
        self.rest.len()
    }
    /// The next physical line, as it is, and its number.
    pub(super) fn plain(&mut self) -> Option<(usize, &'a [u8])> {
        let line = self.physical()?;
        Some((self.number, line))
    }
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        if self.fed == 0 {
            self.fed = through(self.rest, b'\n');
        }
        // Seldom is there a return before the line feed other than right before it.
        let end = through(&self.rest[..self.fed], b'\r');
        let both = end + 1 == self.fed && self.rest[end] == b'\n';
        let taken = if both { self.fed } else { end };
        let line = &self.rest[..taken];
        self.rest = &self.rest[taken..];
        self.fed -= taken;
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

/// How many bytes there are up to and with the first `stop`, or all. The standard library's fast search.
fn through(mut bytes: &[u8], stop: u8) -> usize {
    bytes.skip_until(stop).unwrap_or(bytes.len())
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let first = self.physical()?;
        let number = self.number;
        if !first.ends_with(b"\\") || first.trim_ascii_start().starts_with(b"#") {
            return Some((number, Cow::Borrowed(first)));
        }
        let mut joined = first[..first.len() - 1].to_vec();
        while let Some(next) = self.physical() {
            joined.push(b' ');
            match next.strip_suffix(b"\\") {
                Some(more) => joined.extend_from_slice(more),
                None => {
                    joined.extend_from_slice(next);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    }
}

/// Splits off the first word: (word, trimmed rest).
pub(super) fn keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii())
}

/// Words of a line up to a comment.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).take_while(|w| w[0] != b'#')
}

/// A number as Rust writes them; also `nan` and `inf`, which the caller must refuse.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    short_number(word).or_else(|| std::str::from_utf8(word).ok()?.parse().ok())
}

/// A number of digits and a point whose whole and whose power of ten are exact in 64 bits: one division then
/// rounds it as it must be (Clinger, "How to Read Floating Point Numbers Accurately", 1990).
fn short_number(word: &[u8]) -> Option<f64> {
    const TENS: [f64; 19] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
        1e18,
    ];
    let digits = word.strip_prefix(b"-").unwrap_or(word);
    let (mut value, mut point) = (0u64, None);
    // Nineteen bytes cannot overflow.
    if digits.len() > 19 {
        return None;
    }
    for (at, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => value = value * 10 + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(at),
            _ => return None,
        }
    }
    let after = point.map_or(0, |at| digits.len() - 1 - at);
    if value >> 53 != 0 || digits.len() == usize::from(point.is_some()) {
        return None;
    }
    let size = value as f64 / TENS[after];
    Some(if digits.len() < word.len() { -size } else { size })
}

/// Whether a word is a number but for a comma in place of its point, as programs write it whose language
/// does.
pub(super) fn is_decimal_comma(word: &[u8]) -> bool {
    let mut parts = word.split(|b| *b == b',');
    let (Some(whole), Some(fraction), None) = (parts.next(), parts.next(), parts.next()) else {
        return false;
    };
    number(&[whole, b".", fraction].concat()).is_some()
}

/// A name for people: bytes that are not UTF-8 become `�`, control characters a space.
pub(super) fn name_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(usize, String)> {
        Lines::new(text).map(|(n, l)| (n, String::from_utf8_lossy(&l).into_owned())).collect()
    }

    #[test]
    fn lines_join_and_keep_their_numbers() {
        let got = lines(b"a\r\nb \\\nc\\\n d\n# C:\\temp\\\ne\rf\n\nlast\\");
        let want = [(1, "a"), (2, "b  c  d"), (5, "# C:\\temp\\"), (6, "e"), (7, "f"), (8, ""), (9, "last")];
        assert_eq!(got, want.map(|(n, s)| (n, s.to_owned())));
    }

    #[test]
    fn short_numbers_are_those_of_the_standard_library() {
        let words = [
            "0",
            "-0",
            "7",
            "-1.5",
            ".5",
            "5.",
            "0.1",
            "123456.789012",
            "9007199254740991",
            "9007199254740993",
            "0.000000000000000001",
            "-179769.313486231570",
            "1e5",
            "+1",
            "nan",
            ".",
            "-",
            "-.",
            "",
            "1.2.3",
            "1x",
            "12345678901234567890",
            "0.30000000000000004",
            "00001.250",
        ];
        for word in words {
            let want = word.parse::<f64>().ok().map(f64::to_bits);
            let got = number(word.as_bytes()).map(f64::to_bits);
            assert!(got == want || word == "nan", "{word}: {got:?} instead of {want:?}");
        }
    }

    #[test]
    fn names_that_lead_out_are_refused() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        for name in
            ["../Cargo.toml", "/dev/zero", "/etc/passwd", "", "scene/../../Cargo.toml", "..\\Cargo.toml"]
        {
            assert!(beside(&here, name).is_err(), "{name}");
        }
        assert!(beside(&here, "./scene/mod.rs").is_ok());
        assert_eq!(beside(&here, "nothing.mtl"), Err("there is no such file".into()));
    }
}
