//! What a paper is here: the methods that it is about, its figures made anew, its tables measured anew.

use super::shown::Shown;
use crate::culling::Methods;
use crate::drawing::Drawing;
use crate::figure::tools::{Maker, Tint};
use crate::geometry::Solid;
use crate::measure::Experiment;
use crate::method::Departure;
use crate::scene::SceneError;

/// A paper, or another work that figures and tables belong to. Title and DOI stand on the cards of its
/// methods.
pub struct Paper {
    /// Its kebab-case key, with which the names of its figures and tables begin.
    pub key: &'static str,
    /// Keys of the methods that it is about, one at least.
    pub methods: &'static [&'static str],
    /// All figures, plates and tables that it prints, in its own order, each once.
    pub shown: &'static [Shown],
    /// Its figures made anew, in its own order.
    pub figures: &'static [Figure],
    /// Its tables measured anew, in its own order.
    pub tables: &'static [Experiment],
}

/// What a method is cited by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Authors, title and place.
    pub title: &'static str,
    /// Digital object identifier; empty if there is none.
    pub doi: &'static str,
}

impl Paper {
    /// What its methods are cited by, each once, in the order of the methods.
    pub fn sources(&self) -> Vec<Source> {
        let mut sources: Vec<Source> = Vec::new();
        for card in self.methods.iter().filter_map(|key| Solid::method(key)).map(|entry| entry.card()) {
            let source = Source { title: card.paper, doi: card.doi };
            if !sources.contains(&source) {
                sources.push(source);
            }
        }
        sources
    }
    /// Where its methods differ from it on purpose, by key of the method, in their order.
    pub fn departures(&self) -> Vec<(&'static str, &'static [Departure])> {
        let cards = self.methods.iter().filter_map(|key| Solid::method(key)).map(|entry| entry.card());
        cards.filter(|card| !card.departures.is_empty()).map(|card| (card.key, card.departures)).collect()
    }
}

/// A figure, made by running methods on scenes; none is drawn by hand.
pub struct Figure {
    /// Its kebab-case name; also the name of its file.
    pub name: &'static str,
    /// The name that it had before figures were named by paper, which still works.
    pub former: Option<&'static str>,
    /// One line for lists.
    pub summary: &'static str,
    /// Makes it.
    pub(super) make: fn(&Maker<'_>) -> Result<Drawing, SceneError>,
}

impl Figure {
    /// Makes the figure.
    ///
    /// # Errors
    /// If its scene cannot be made.
    pub fn drawing(&self, tint: Tint) -> Result<Drawing, SceneError> {
        (self.make)(&Maker::new(tint))
    }
}
