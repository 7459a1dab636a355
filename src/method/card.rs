//! Who a method is: its card and its pseudocode.

use super::{Knob, KnobValue};

/// One line of a method's pseudocode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeLine {
    /// Procedure and line, such as `Visible:4`.
    pub label: &'static str,
    /// The text, indented by two spaces a level.
    pub text: &'static str,
    /// What the paper's line says where this one departs from it, or empty.
    pub paper: &'static str,
}

impl CodeLine {
    /// A line as the paper has it, or as it would have it.
    pub const fn new(label: &'static str, text: &'static str) -> Self {
        Self { label, text, paper: "" }
    }
    /// A line in whose place the paper's says something else.
    pub const fn departing(label: &'static str, text: &'static str, paper: &'static str) -> Self {
        Self { label, text, paper }
    }
}

/// Where a method differs from its paper on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Departure {
    /// The section of the paper, such as `3.1`.
    pub section: &'static str,
    /// What is done instead, beginning in lower case, without a full stop.
    pub what: &'static str,
    /// Why, likewise.
    pub why: &'static str,
    /// With which parameters.
    #[serde(skip)]
    pub when: When,
}

/// With which parameters a method departs from its paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// With all.
    Always,
    /// Where this parameter has this value.
    With(&'static str, &'static str),
    /// Where it has another.
    Without(&'static str, &'static str),
}

impl Departure {
    /// Whether a run with these parameters departs so.
    pub fn holds(&self, knobs: &[(Knob, KnobValue)]) -> bool {
        let is = |name: &str, word: &str| knobs.iter().any(|(k, v)| k.name == name && v.to_string() == word);
        match self.when {
            When::Always => true,
            When::With(name, word) => is(name, word),
            When::Without(name, word) => !is(name, word),
        }
    }
}

impl Card {
    /// The sections of the paper from which it departs as `holds` says, each once, in their order.
    pub fn departing(&self, holds: impl Fn(&Departure) -> bool) -> Vec<&'static str> {
        let mut sections: Vec<&str> =
            self.departures.iter().filter(|d| holds(d)).map(|d| d.section).collect();
        sections.dedup();
        sections
    }
}

/// A sentence for captions that names these sections; nothing if there are none.
pub fn departs(key: &str, sections: &[&str]) -> String {
    match sections {
        [] => String::new(),
        [one] => format!(" {key} departs from its paper in Section {one}."),
        [first @ .., last] => {
            format!(" {key} departs from its paper in Sections {} and {last}.", first.join(", "))
        }
    }
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
    /// Its pseudocode; `Event::Line(i)` refers to line `i`. Which of the lines belong to some parameters:
    /// [`super::Method::has_line`].
    pub code: &'static [CodeLine],
    /// Kinds of events ([`super::Reel::kind`]; of a decision `NodeDecided` or `PrimDecided` with its verdict,
    /// such as `NodeDecided hidden`), and the labels of the lines at which they stand.
    pub stands: &'static [(&'static str, &'static [&'static str])],
    /// Where it differs from its paper on purpose.
    pub departures: &'static [Departure],
}
