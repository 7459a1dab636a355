//! JSON with errors for people: file, line and what was expected.

use serde::de::DeserializeOwned;

use super::SceneError;
use super::text::without_mark;

/// Reads a value out of JSON text.
pub(super) fn from_slice<T: DeserializeOwned>(bytes: &[u8], source: &str) -> Result<T, SceneError> {
    let text =
        without_mark(bytes).map_err(|why| SceneError::Format { path: source.to_owned(), why: why.into() })?;
    serde_json::from_slice(text).map_err(|e| {
        let why = e.to_string();
        let at = format!(" at line {} column {}", e.line(), e.column());
        SceneError::Syntax {
            path: source.to_owned(),
            line: e.line().max(1),
            why: why.strip_suffix(&at).unwrap_or(&why).to_owned(),
        }
    })
}

/// A step into a value: a key of an object or a place in an array.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step<'a> {
    Key(&'a str),
    At(usize),
}

/// The 1-based line where the value at `path` begins, in text that was read before without an error.
/// As far as the path leads; for messages only.
pub(super) fn line_of(bytes: &[u8], path: &[Step]) -> usize {
    let mut scan = Scan { text: bytes, at: 0 };
    for step in path {
        let before = scan.at;
        if !scan.enter(step) {
            scan.at = before;
            break;
        }
    }
    scan.space();
    1 + bytes[..scan.at.min(bytes.len())].iter().filter(|b| **b == b'\n').count()
}

struct Scan<'a> {
    text: &'a [u8],
    at: usize,
}

impl Scan<'_> {
    fn peek(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(0)
    }
    fn space(&mut self) {
        if self.at == 0 && self.text.starts_with(b"\xef\xbb\xbf") {
            self.at = 3;
        }
        while matches!(self.peek(), b' ' | b'\t' | b'\r' | b'\n' | b',' | b':') {
            self.at += 1;
        }
    }
    /// The raw inside of a string; moves past it.
    fn string(&mut self) -> &[u8] {
        self.at += 1;
        let start = self.at;
        while self.at < self.text.len() && self.peek() != b'"' {
            self.at += 1 + usize::from(self.peek() == b'\\');
        }
        let inside = start..self.at.min(self.text.len());
        self.at += 1;
        &self.text[inside]
    }
    /// Moves past one value.
    fn skip(&mut self) {
        self.space();
        let mut depth = 0;
        while self.at < self.text.len() {
            match self.peek() {
                b'"' => {
                    self.string();
                }
                b'[' | b'{' => {
                    depth += 1;
                    self.at += 1;
                }
                b']' | b'}' => {
                    depth -= 1;
                    self.at += 1;
                }
                b' ' | b'\t' | b'\r' | b'\n' | b',' | b':' => {
                    self.space();
                    continue;
                }
                _ => {
                    while self.at < self.text.len()
                        && !matches!(self.peek(), b',' | b']' | b'}' | b' ' | b'\n' | b'\r' | b'\t')
                    {
                        self.at += 1;
                    }
                }
            }
            if depth <= 0 {
                return;
            }
        }
    }
    /// Moves to the value that a step leads to.
    fn enter(&mut self, step: &Step) -> bool {
        self.space();
        let open = self.peek();
        self.at += 1;
        match *step {
            Step::Key(key) if open == b'{' => loop {
                self.space();
                if self.peek() != b'"' {
                    return false;
                }
                if self.string() == key.as_bytes() {
                    return true;
                }
                self.skip();
            },
            Step::At(index) if open == b'[' => {
                for _ in 0..index {
                    self.space();
                    if matches!(self.peek(), b']' | 0) {
                        return false;
                    }
                    self.skip();
                }
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_values_are_found() {
        let text =
            b"{\n \"a\\\"\": [1,\n {\"b\": \"]\"}, 2],\n \"c\":\n [[0],\n  [1, -2.5e3, true],\n  [2]]\n}";
        let line = |path: &[Step]| line_of(text, path);
        assert_eq!(line(&[]), 1);
        assert_eq!(line(&[Step::Key("a\\\"")]), 2);
        assert_eq!(line(&[Step::Key("a\\\""), Step::At(1), Step::Key("b")]), 3);
        assert_eq!(line(&[Step::Key("c"), Step::At(1)]), 6);
        assert_eq!(line(&[Step::Key("c"), Step::At(2), Step::At(0)]), 7);
        assert_eq!(line(&[Step::Key("none")]), 1);
        assert_eq!(line(&[Step::Key("c"), Step::At(9)]), 5);
    }
}
