//! The rules of the traversal: those of the paper, and ours.
//!
//! Klosowski and Silva 2000, Figures 4 and 5 and Section 3.2. `rules` names a set of six parameters at once;
//! one of them that is set too stands as it is set.

use crate::method::{Knob, Knobs, words};

words! {
    /// Whose rules the front follows.
    pub enum Rules {
        /// Figures 4 and 5 as they are printed.
        Paper = "paper",
        /// What finds more.
        Ours = "ours",
    }
}
words! {
    /// Which cells the front grows over.
    pub enum Entering {
        /// All that are not projected, as in Figure 4.
        Everywhere = "everywhere",
        /// Of these the ones in view.
        InView = "in-view",
    }
}
words! {
    /// How much of its solidity a cell hands on.
    pub enum Transfer {
        /// v · n of it, as in Figure 5.
        Aligned = "aligned",
        /// All of it.
        Whole = "whole",
    }
}
words! {
    /// What v is.
    pub enum Sight {
        /// The direction in which the Eye looks: "the current viewing direction" (Figure 6).
        Frame = "frame",
        /// The direction from the Eye to the center of the cell.
        Cell = "cell",
    }
}
words! {
    /// How the penalty of a cell that is not star-shaped is applied.
    pub enum Penalizing {
        /// Its solidity is multiplied, as in Figure 5.
        Factor = "factor",
        /// It is added.
        Sum = "sum",
    }
}
words! {
    /// Which solidity a cell in the front keeps.
    pub enum Update {
        /// The latest, as in Figure 4.
        Latest = "latest",
        /// That which came through the face the Eye sees the cell through.
        StarShaped = "star-shaped",
    }
}
words! {
    /// How the primitives of a cell add to its solidity; no part of the rules.
    pub enum Occupancy {
        /// Each counts one, as in Section 3.2.
        Count = "count",
        /// Each counts the cosine between its normal and the way to the Eye (Section 6).
        FrontFacing = "front-facing",
    }
}

/// How the front grows and solidity is handed on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traversal {
    pub front: Entering,
    pub transfer: Transfer,
    pub sight: Sight,
    pub penalizing: Penalizing,
    /// Per cent: of a cell that holds ρ_max primitives if it is added, of the cell's own solidity if it is a
    /// factor.
    pub penalty: f32,
    pub update: Update,
}

impl Traversal {
    /// What these rules say.
    pub const fn of(rules: Rules) -> Self {
        match rules {
            Rules::Paper => Self {
                front: Entering::Everywhere,
                transfer: Transfer::Aligned,
                sight: Sight::Frame,
                penalizing: Penalizing::Factor,
                // The paper gives no factor. Twice: what matters is that a cell seen through the shared face
                // comes before one as solid that is not.
                penalty: 100.0,
                update: Update::Latest,
            },
            Rules::Ours => Self {
                front: Entering::InView,
                transfer: Transfer::Whole,
                sight: Sight::Cell,
                // Multiplying keeps empty space at solidity 0, so the front would flow around occluders at no
                // cost.
                penalizing: Penalizing::Sum,
                // A third of a full cell: enough that a cell is not taken behind an occluder, little enough
                // that it is not taken after all others.
                penalty: 30.0,
                update: Update::StarShaped,
            },
        }
    }
    /// ρ(B) with the penalty.
    #[inline]
    pub fn penalized(&self, solidity: f32) -> f32 {
        match self.penalizing {
            Penalizing::Factor => solidity * self.factor(),
            Penalizing::Sum => solidity + self.penalty / 100.0,
        }
    }
    /// What a penalty multiplies by, where it is a factor.
    pub fn factor(&self) -> f32 {
        1.0 + self.penalty / 100.0
    }
}

/// The paper, of which a parameter names the place.
const FIGURE_4: &str = "Klosowski and Silva 2000, Figure 4";
const FIGURE_5: &str = "Klosowski and Silva 2000, Figure 5";

/// Declares the rules and the parameters that follow them.
pub(super) fn knobs(rules: &mut Rules, how: &mut Traversal, knobs: &mut dyn Knobs) {
    let meaning = "sets the six parameters from `front` to `update` that are not set themselves: to Figures \
                   4 and 5 as printed, or to what finds more";
    let before = *rules;
    knobs.words(Knob::new("rules", "", meaning, "Klosowski and Silva 2000, Section 3.2"), rules);
    // The visitor set other rules: what it sets after this stands on top of theirs.
    if *rules != before {
        *how = Traversal::of(*rules);
    }
    let meaning =
        "which neighbors the front takes in: all, as in the paper, or those in view; follows `rules`";
    knobs.words(Knob::new("front", "", meaning, FIGURE_4), &mut how.front);
    let meaning = "how much of a cell's solidity its neighbor gets: v · n of it, as in the paper, or the \
                   whole; follows `rules`";
    knobs.words(Knob::new("transfer", "", meaning, FIGURE_5), &mut how.transfer);
    let meaning = "v: the direction in which the eye looks, as in the paper, or that from the eye to the \
                   center of the cell; follows `rules`";
    knobs.words(Knob::new("view-direction", "", meaning, FIGURE_5), &mut how.sight);
    let meaning = "how a cell that the eye does not see through the face it is reached by is penalized: its \
                   solidity is multiplied, as in the paper, or a sum is added; follows `rules`";
    knobs.words(Knob::new("penalty-as", "", meaning, FIGURE_5), &mut how.penalizing);
    let meaning = "that penalty: by how much of itself the solidity grows, 100 doubling it, or what is \
                   added, 100 being a full cell; 0: none; follows `rules`";
    knobs.real(Knob::new("penalty", "%", meaning, FIGURE_5), 0.0..=1000.0, &mut how.penalty);
    let meaning = "what a cell in the front keeps: the latest solidity, as in the paper, or that from the \
                   face the eye sees it through; follows `rules`";
    knobs.words(Knob::new("update", "", meaning, FIGURE_4), &mut how.update);
}
