//! What was noticed while loading, and why loading failed.

use std::collections::BTreeMap;

/// Why primitives were dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dropped {
    /// Two corners coincide or all lie on a line: no area (no length in flatland).
    Degenerate,
    /// A corner names a point that does not exist.
    OutOfRange,
    /// A corner is NaN or infinite.
    NotFinite,
    /// A corner is farther off than [`MAX_COORDINATE`](super::MAX_COORDINATE).
    TooFar,
    /// It has an area in the file's own coordinates, and none once they are rounded to 32 bits.
    Rounded,
    /// A concave polygon of more corners than are cut.
    TooLong,
    /// The line or element could not be read.
    Malformed,
}

impl Dropped {
    /// A few words for tables.
    pub fn label(self) -> &'static str {
        match self {
            Self::Degenerate => "degenerate",
            Self::OutOfRange => "out of range",
            Self::NotFinite => "not finite",
            Self::TooFar => "too far off for 32-bit coordinates",
            Self::Rounded => "too small for 32-bit coordinates here",
            Self::TooLong => "too many corners to be cut",
            Self::Malformed => "malformed",
        }
    }
}

/// What was noticed while loading a scene that loaded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of primitives dropped, by reason.
    pub dropped: BTreeMap<Dropped, usize>,
    /// One sentence each, with file and line where there is one; at most [`Report::MAX_NOTES`].
    pub notes: Vec<String>,
    /// Sentences beyond the limit.
    pub unsaid: usize,
    /// Points that went because another was at the same place, or nothing used them.
    pub merged_points: usize,
    /// Primitives that became part of a larger convex polygon by merging coplanar neighbors.
    pub merged_prims: usize,
    /// What is said of many alike, until [`Report::settle`] ends the sentence of the first with the others.
    open: BTreeMap<&'static str, Alike>,
}

/// Others of the kind of which a note tells the first.
#[derive(Clone, Debug, Default, PartialEq)]
struct Alike {
    /// Which note tells the first.
    note: usize,
    others: usize,
    /// The first few of the others.
    places: Vec<String>,
}

impl Report {
    /// Sentences kept before the rest is only counted.
    pub const MAX_NOTES: usize = 100;
    /// Others of a kind that are named.
    const PLACES: usize = 4;
    /// Notes that a refusal repeats.
    const REASONS: usize = 3;

    /// Adds a sentence.
    pub fn note(&mut self, sentence: impl Into<String>) {
        if self.notes.len() < Self::MAX_NOTES {
            self.notes.push(sentence.into());
        } else {
            self.unsaid += 1;
        }
    }
    /// Says of the first of a kind `sentence`; the others are counted, and `place` (a name, a line) tells the
    /// first few.
    pub fn note_each(
        &mut self,
        kind: &'static str,
        place: impl std::fmt::Display,
        sentence: impl FnOnce() -> String,
    ) {
        if let Some(alike) = self.open.get_mut(kind) {
            alike.others += 1;
            if alike.places.len() < Self::PLACES {
                alike.places.push(place.to_string());
            }
            return;
        }
        if self.notes.len() < Self::MAX_NOTES {
            self.open.insert(kind, Alike { note: self.notes.len(), ..Alike::default() });
        }
        self.note(sentence());
    }
    /// Ends the sentences of [`Report::note_each`]: nothing more is said of their kinds.
    pub(super) fn settle(&mut self) {
        for alike in std::mem::take(&mut self.open).into_values().filter(|a| a.others > 0) {
            let more = if alike.others > alike.places.len() { ", …" } else { "" };
            let places = alike.places.join(", ");
            self.notes[alike.note] += &format!(" (and {} more: {places}{more})", alike.others);
        }
    }
    /// Counts dropped primitives.
    pub fn drop(&mut self, why: Dropped, count: usize) {
        if count > 0 {
            *self.dropped.entry(why).or_default() += count;
        }
    }
    /// All dropped primitives.
    pub fn dropped_total(&self) -> usize {
        self.dropped.values().sum()
    }
    /// Why nothing is left, to end a sentence: how many went for which reason, and the first notes.
    pub(super) fn reasons(&self) -> String {
        let counts = self.dropped.iter().map(|(why, count)| format!("{count} {}", why.label()));
        let counts = counts.collect::<Vec<_>>().join(", ");
        let notes = self.notes.iter().take(Self::REASONS).cloned();
        let all: Vec<String> = std::iter::once(counts).chain(notes).filter(|t| !t.is_empty()).collect();
        if all.is_empty() { String::new() } else { format!(": {}", all.join("; ")) }
    }
}

/// "1 light", "2 lights", "2 meshes".
pub(super) fn counted(count: usize, thing: &str) -> String {
    let ending = if count == 1 {
        ""
    } else if thing.ends_with('h') {
        "es"
    } else {
        "s"
    };
    format!("{count} {thing}{ending}")
}

/// Why a scene was refused. Displays as one line that says what, where and why.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read.
    #[error("{path}: {why}")]
    Io {
        /// The path as given.
        path: String,
        /// The system's reason.
        why: std::io::Error,
    },
    /// The file was read but makes no sense.
    #[error("{path}:{line}: {why}")]
    Syntax {
        /// The path as given.
        path: String,
        /// 1-based line.
        line: usize,
        /// What is wrong.
        why: String,
    },
    /// The file makes no sense and there is no line to name.
    #[error("{path}: {why}")]
    Format {
        /// The path as given.
        path: String,
        /// What is wrong.
        why: String,
    },
    /// Nothing to look at.
    #[error("{scene}: it has no {prim} that can be drawn{why}")]
    Empty {
        /// The scene.
        scene: String,
        /// What a primitive is called.
        prim: &'static str,
        /// How many were dropped for which reason and the first notes, after a colon; or empty.
        why: String,
    },
    /// A reader handed over tables that do not fit.
    #[error("{scene}: internal tables do not fit: {what}")]
    Inconsistent {
        /// The scene.
        scene: String,
        /// Which.
        what: &'static str,
    },
    /// The work was cancelled.
    #[error("{0}: cancelled")]
    Cancelled(String),
}
