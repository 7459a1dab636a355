//! What a film draws, by layers: where it first draws something of a deeper layer than before. Layers are
//! those of Klosowski and Silva 2000, Section 3, before the film's Eye; any film that draws has them.

use std::sync::Arc;

use crate::drawing::words::count;
use crate::geometry::{PrimId, Space};
use crate::method::{Film, Verdict, surfaces_of};
use crate::raster::Drawable;
use crate::scene::Progress;
use crate::trace::Stamps;
use crate::truth::{Unranked, layering_numbers_within};

/// Primitives at pixels that are ranked: 400 MB.
const MOST_FRAGMENTS: usize = 50_000_000;

/// A film to rank.
pub(super) struct ToLayer<S: Space> {
    pub film: Arc<dyn Film<S>>,
    pub stamps: Arc<Stamps>,
}

/// What a film draws, by layers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    /// Primitives of each layer, drawn or not; the first layer at 0.
    sizes: Vec<usize>,
    /// Layer and step of each primitive that is drawn; ascending.
    drawn: Vec<(u32, u32)>,
    /// Steps that draw something of a deeper layer than all before, with that layer; ascending in both.
    begins: Vec<(usize, u32)>,
}

/// How far a film has come in its layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InLayer {
    /// The deepest layer of which something is drawn; 0 before that.
    pub layer: u32,
    /// The deepest layer of the picture.
    pub of: u32,
    /// Primitives of the layer.
    pub prims: usize,
    /// Those of them that are drawn by now.
    pub drawn: usize,
}

impl Layers {
    /// What a film with these stamps draws of primitives with these layering numbers.
    pub fn new(numbers: &[u32], stamps: &Stamps) -> Self {
        let mut sizes = vec![0; numbers.iter().copied().max().unwrap_or(0) as usize];
        let mut drawn = Vec::new();
        // What covers no pixel is of no layer.
        for (prim, &layer) in numbers.iter().enumerate().filter(|(_, layer)| **layer > 0) {
            sizes[layer as usize - 1] += 1;
            if let Some((step, Verdict::Visible)) = stamps.prim_decision(PrimId(prim as u32)) {
                drawn.push((layer, step as u32));
            }
        }
        drawn.sort_unstable();
        let mut by_step: Vec<(u32, u32)> = drawn.iter().map(|&(layer, step)| (step, layer)).collect();
        by_step.sort_unstable();
        let mut begins: Vec<(usize, u32)> = Vec::new();
        for (step, layer) in by_step {
            match begins.last_mut() {
                Some(last) if layer <= last.1 => {}
                // One decision can draw many; the deepest of them counts.
                Some(last) if last.0 == step as usize => last.1 = layer,
                _ => begins.push((step as usize, layer)),
            }
        }
        Self { sizes, drawn, begins }
    }
    /// The first step after `step` that draws something of a deeper layer than all before it.
    pub fn next(&self, step: usize) -> Option<usize> {
        self.begins.get(self.begins.partition_point(|b| b.0 <= step)).map(|b| b.0)
    }
    /// Whether nothing is drawn that covers a pixel.
    pub fn is_empty(&self) -> bool {
        self.begins.is_empty()
    }
    /// The last such step before `step`.
    pub fn previous(&self, step: usize) -> Option<usize> {
        let before = self.begins.partition_point(|b| b.0 < step).checked_sub(1)?;
        Some(self.begins[before].0)
    }
    /// How far the film has come at a step.
    pub fn at(&self, step: usize) -> InLayer {
        let begun = self.begins.partition_point(|b| b.0 <= step).checked_sub(1);
        let layer = begun.map_or(0, |i| self.begins[i].1);
        let before = self.drawn.partition_point(|d| d.0 < layer);
        let by_now = self.drawn.partition_point(|d| *d <= (layer, step as u32));
        InLayer {
            layer,
            of: self.sizes.len() as u32,
            prims: if layer == 0 { 0 } else { self.sizes[layer as usize - 1] },
            drawn: by_now - before,
        }
    }
}

/// Runs on the worker.
pub(super) fn rank<S: Drawable>(of: &ToLayer<S>, progress: &dyn Progress) -> Result<Layers, String> {
    let (film, surfaces) = (&of.film, surfaces_of(of.film.knobs()));
    match layering_numbers_within(&**film.scene(), film.view(), surfaces, MOST_FRAGMENTS, progress) {
        Ok(numbers) => Ok(Layers::new(&numbers, &of.stamps)),
        Err(Unranked::Cancelled) => Err("the ranking was cancelled".into()),
        Err(Unranked::TooMany(found)) => Err(format!(
            "The layers of this picture were not ranked: {}s cover {} pixels in all, those behind others \
             counted, and at most {} can be ranked. An Eye with a smaller image has fewer.",
            S::PRIM,
            count(found),
            count(MOST_FRAGMENTS)
        )),
    }
}
