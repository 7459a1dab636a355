//! What was noticed while loading, and why loading failed.

use std::collections::BTreeMap;

/// Why primitives were dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dropped {
    /// Two corners coincide or all lie on a line: no area (no length in flatland).
    Degenerate,
    /// A corner names a point that does not exist.
    OutOfRange,
    /// A corner is NaN, infinite or beyond what 32-bit coordinates hold.
    NotFinite,
    /// The line or element could not be read.
    Malformed,
}

impl Dropped {
    /// One word for tables.
    pub fn label(self) -> &'static str {
        match self {
            Self::Degenerate => "degenerate",
            Self::OutOfRange => "out of range",
            Self::NotFinite => "not finite",
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
}

impl Report {
    /// Sentences kept before the rest is only counted.
    pub const MAX_NOTES: usize = 100;
    /// Adds a sentence.
    pub fn note(&mut self, sentence: impl Into<String>) {
        if self.notes.len() < Self::MAX_NOTES {
            self.notes.push(sentence.into());
        } else {
            self.unsaid += 1;
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
    #[error("{scene}: it has no {prim} that can be drawn")]
    Empty {
        /// The scene.
        scene: String,
        /// What a primitive is called.
        prim: &'static str,
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
