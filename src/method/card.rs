//! Who a method is: its card and its pseudocode.

/// One line of a method's pseudocode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeLine {
    /// Procedure and line, such as `Visible:4`.
    pub label: &'static str,
    /// The text, indented by two spaces a level.
    pub text: &'static str,
}

/// The number of the line with this label. Evaluated when a method's line constants are compiled, so a label
/// that its pseudocode lacks does not build.
pub(crate) const fn line(code: &[CodeLine], label: &str) -> u8 {
    let mut at = 0;
    while at < code.len() {
        if is_same(code[at].label.as_bytes(), label.as_bytes()) {
            return at as u8;
        }
        at += 1;
    }
    panic!("no line of the pseudocode has this label")
}

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    let mut at = 0;
    while at < a.len() && at < b.len() && a[at] == b[at] {
        at += 1;
    }
    at == a.len() && at == b.len()
}

/// Who a method is. Menus, captions, `cullscope methods` and the documentation all read this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Card {
    /// Stable key of files and the command line.
    pub key: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// Authors, title, venue, year; section.
    pub paper: &'static str,
    /// Digital object identifier, or empty.
    pub doi: &'static str,
    /// Whether its answer includes every visible primitive, with the default parameters.
    pub conservative: bool,
    /// Its pseudocode; `Event::Line(i)` refers to line `i`.
    pub code: &'static [CodeLine],
}
