//! Which events are listed: `kind:node verdict:outside under:12 depth>3 -line`.
//!
//! All words must hold; a word after `-` must not hold, `+` before a word changes nothing.
//! Words without a colon are looked for in the kind, the verdict and the number of the event. Quotes hold
//! together what has spaces: `under:"wall A"`.

use std::fmt;

use super::concern::Concern;
use super::stage::{Reading, SceneFacts};
use crate::drawing::Subject;
use crate::geometry::{NodeId, ObjectId, PrimId};
use crate::method::Event;
use crate::trace::Detail;

/// A parsed filter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filter {
    terms: Vec<(bool, Term)>,
}

#[derive(Clone, Debug, PartialEq)]
enum Term {
    Kind(String),
    Verdict(String),
    Node(u32),
    Prim(u32),
    Object(u32),
    UnderNode(u32),
    UnderObject(String),
    Line(String),
    Deeper(usize),
    Shallower(usize),
    Word(String),
}

/// Why a filter makes no sense.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilterError(String);

impl fmt::Display for FilterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Filter {
    /// Reads a filter.
    ///
    /// # Errors
    /// Names the word that makes no sense and what would.
    pub fn parse(text: &str) -> Result<Self, FilterError> {
        let mut filter = Self::default();
        for word in words(text) {
            let (wanted, word) = match word.strip_prefix('-') {
                Some(rest) => (false, rest),
                None => (true, word.strip_prefix('+').unwrap_or(&word)),
            };
            if !word.is_empty() {
                filter.terms.push((wanted, Term::parse(word)?));
            }
        }
        Ok(filter)
    }
    /// The filter of all that happens to a thing; `None` of what nothing happens to.
    pub fn about(subject: Subject) -> Option<String> {
        match subject {
            Subject::Prim(prim) => Some(format!("prim:{prim}")),
            Subject::Object(object) => Some(format!("object:{object}")),
            Subject::Node(node) => Some(format!("under:{node}")),
            _ => None,
        }
    }
    /// Whether everything passes.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }
    /// Binds the filter to a film, looking up once what depends on it.
    pub fn on<'a>(&'a self, scene: &'a dyn SceneFacts, film: Reading<'a>) -> Applied<'a> {
        let ranges = self.terms.iter().map(|(_, term)| term.range(film)).collect();
        let things = self.terms.iter().map(|(_, term)| term.things(scene, film)).collect();
        Applied { filter: self, film, ranges, things }
    }
}

/// The words of a filter, without the quotes.
fn words(text: &str) -> Vec<String> {
    let (mut words, mut is_quoted) = (vec![String::new()], false);
    for c in text.chars() {
        match c {
            '"' => is_quoted = !is_quoted,
            c if c.is_whitespace() && !is_quoted => words.push(String::new()),
            c => words.last_mut().into_iter().for_each(|word| word.push(c)),
        }
    }
    words
}

impl Term {
    fn parse(word: &str) -> Result<Self, FilterError> {
        let number =
            |text: &str| text.parse().map_err(|_| FilterError(format!("`{word}`: expected a number")));
        if let Some(text) = word.strip_prefix("depth>") {
            return Ok(Self::Deeper(number(text)? as usize));
        }
        if let Some(text) = word.strip_prefix("depth<") {
            return Ok(Self::Shallower(number(text)? as usize));
        }
        let Some((key, value)) = word.split_once(':') else { return Ok(Self::Word(word.to_lowercase())) };
        match key {
            "kind" => Ok(Self::Kind(value.to_lowercase())),
            "verdict" => Ok(Self::Verdict(value.to_lowercase())),
            "node" => number(value).map(Self::Node),
            "prim" | "triangle" | "segment" => number(value).map(Self::Prim),
            "object" => number(value).map(Self::Object),
            "under" => {
                Ok(value.parse().map_or_else(|_| Self::UnderObject(value.to_lowercase()), Self::UnderNode))
            }
            "line" => Ok(Self::Line(value.to_lowercase())),
            _ => Err(FilterError(format!(
                "`{key}:` is not known; there are kind: verdict: node: prim: object: under: line: depth> \
                 depth<"
            ))),
        }
    }
    /// The things that a term names: a primitive, an object, or every object with that name.
    fn things<'a>(&self, scene: &'a dyn SceneFacts, film: Reading<'a>) -> Vec<Concern<'a>> {
        let named: Vec<Subject> = match self {
            Self::Prim(prim) => vec![Subject::Prim(PrimId(*prim))],
            Self::Object(object) => vec![Subject::Object(ObjectId(*object))],
            Self::UnderObject(name) => (0..scene.object_count() as u32)
                .map(ObjectId)
                .filter(|&o| scene.object_name(o).to_lowercase().contains(name))
                .map(Subject::Object)
                .collect(),
            _ => vec![],
        };
        named.into_iter().map(|subject| Concern::of(film, scene, subject)).collect()
    }
    /// The events from entering the node of `under:` to leaving it.
    fn range(&self, film: Reading<'_>) -> Option<(usize, usize)> {
        let Self::UnderNode(node) = self else { return None };
        let node = Some(NodeId(*node)).filter(|n| n.at() < film.node_count())?;
        let entered = film.stamps.entered_at(node)? - 1;
        Some((entered, film.moves.over(film.reel.events(), entered, Detail::Full)))
    }
}

/// Whether a name of ours, which is ASCII, has a lower-case word in it. Allocates nothing, since every event
/// is tested.
fn has(name: &str, word: &str) -> bool {
    word.is_empty() || name.as_bytes().windows(word.len()).any(|w| w.eq_ignore_ascii_case(word.as_bytes()))
}

/// A filter bound to a film.
pub struct Applied<'a> {
    filter: &'a Filter,
    film: Reading<'a>,
    ranges: Vec<Option<(usize, usize)>>,
    things: Vec<Vec<Concern<'a>>>,
}

impl Applied<'_> {
    /// Whether event `at` passes.
    pub fn passes(&self, at: usize) -> bool {
        let event = self.film.reel.events()[at];
        self.filter
            .terms
            .iter()
            .zip(self.ranges.iter().zip(&self.things))
            .all(|((wanted, term), (range, things))| self.holds(term, *range, things, at, event) == *wanted)
    }
    fn holds(
        &self,
        term: &Term,
        range: Option<(usize, usize)>,
        things: &[Concern<'_>],
        at: usize,
        event: Event,
    ) -> bool {
        let (reel, depth) = (self.film.reel, || self.film.moves.depth(at));
        let subject = reel.subject(at);
        match term {
            Term::Kind(kind) => has(reel.kind(at), kind),
            Term::Verdict(verdict) => event.verdict().is_some_and(|v| v.name().starts_with(verdict.as_str())),
            Term::Node(n) => subject == Subject::Node(NodeId(*n)),
            Term::Prim(_) | Term::Object(_) | Term::UnderObject(_) => things.iter().any(|t| t.holds(at)),
            Term::UnderNode(_) => range.is_some_and(|(from, to)| (from..to).contains(&at)),
            Term::Line(text) => match event {
                Event::Line(i) => reel.card().code[i as usize].label.to_lowercase().contains(text),
                _ => false,
            },
            Term::Deeper(d) => depth() > *d,
            Term::Shallower(d) => depth() < *d,
            Term::Word(word) => {
                has(reel.kind(at), word)
                    || event.verdict().is_some_and(|v| v.name().contains(word.as_str()))
                    || word.parse().is_ok_and(|id: u32| match subject {
                        Subject::Node(n) => n.0 == id,
                        Subject::Prim(p) => p.0 == id,
                        _ => false,
                    })
            }
        }
    }
}
