//! What a scene says about itself: what it is for, where it comes from, and facts to expect.

use crate::geometry::PrimId;

/// What a scene says about itself. Empty strings where it says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// A few words, such as `A street`.
    pub title: String,
    /// One or two sentences: what can be seen here.
    pub teaches: String,
    /// Where the data comes from.
    pub credit: String,
    /// License of the data, as an SPDX expression.
    pub license: String,
    /// Facts that hold, each checked by a test against exact visibility.
    pub expect: Vec<Expectation>,
}

/// What one eye sees. Primitives that it does not name may be either.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Expectation {
    /// Which view of the path `eyes`.
    pub eye: usize,
    /// Which frame of the motions.
    pub frame: usize,
    /// Seen at least in part.
    pub visible: Vec<PrimId>,
    /// At least partly within the angle of view, and not seen at all.
    pub hidden: Vec<PrimId>,
    /// Wholly outside the angle of view.
    pub outside: Vec<PrimId>,
}
