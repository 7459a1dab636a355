//! The papers: what they show, made anew, and what they measured, measured anew. One paper, one folder:
//! `figures` run methods and draw what their films say, and know no clock; `tables` run methods and take
//! times, and draw no worlds.
//!
//! A paper's numbers stand where they are compared, with its figures and tables; its title and DOI stand on
//! the card of its method. `shown` lists all that it prints, with what of that is ours: the gallery.

mod baselines;
mod chamberlain;
mod coorg_teller;
mod gallery;
mod georges;
pub mod keys;
mod klosowski_silva;
mod paper;
mod shown;
#[cfg(test)]
mod tests;
mod zhang;

pub use gallery::{index, owns};
pub use paper::{Figure, Paper, Source};
pub use shown::{Ours, Own, Shown};

use crate::measure::Experiment;

/// All papers, in the order of lists.
pub const PAPERS: &[&Paper] = &[
    &baselines::PAPER,
    &coorg_teller::PAPER,
    &georges::PAPER,
    &klosowski_silva::PAPER,
    &zhang::PAPER,
    &chamberlain::PAPER,
];

/// All figures, in the order of lists.
pub fn figures() -> impl Iterator<Item = &'static Figure> {
    PAPERS.iter().flat_map(|paper| paper.figures)
}

/// All tables, in the order of lists.
pub fn tables() -> impl Iterator<Item = &'static Experiment> {
    PAPERS.iter().flat_map(|paper| paper.tables)
}

/// The figure of this name, or the one that had it before.
pub fn figure(name: &str) -> Option<&'static Figure> {
    figures().find(|f| f.name == name).or_else(|| figures().find(|f| f.former == Some(name)))
}

/// The table of this name.
pub fn table(name: &str) -> Option<&'static Experiment> {
    tables().find(|t| t.name == name)
}
