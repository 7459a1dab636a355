//! A method along a path: what is wrong at each view, and what changes without cause from one to the next.

use super::margin::margin;
use super::seen::{Change, Seen, Watcher};
use crate::geometry::{PrimId, View};
use crate::measure::experiment::{ExperimentError, World};
use crate::measure::harness::checkpoint;
use crate::scene::{Progress, Symptom};

/// What was found at a view of a path or at a place of a grid; changes are those since the view before, or of
/// a small step away from the place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Views looked at.
    pub views: usize,
    /// Steps between two of them.
    pub steps: usize,
    /// Visible primitives.
    pub visible: usize,
    /// Visible primitives that were not drawn.
    pub missed: usize,
    /// Primitives that were drawn and do not show.
    pub kept: usize,
    /// Pixels of the images.
    pub pixels: usize,
    /// Pixels whose color is wrong.
    pub wrong_pixels: usize,
    /// What the method counted of its own work.
    pub work: u64,
    /// Primitives that became visible or ceased to be.
    pub changed: usize,
    /// Primitives that were drawn at one of two neighboring views only and are visible at both.
    pub popped: usize,
    /// Pixels that changed in the method's pictures and not in the exact ones.
    pub popped_pixels: usize,
    /// The least relative distance to the opposite result among tests that left something out; `None` where
    /// no test told both of its numbers.
    pub margin: Option<f64>,
}

impl Found {
    pub(super) fn see(&mut self, seen: &Seen) {
        self.views += 1;
        self.visible += seen.visible.len();
        self.missed += seen.missed.len();
        self.kept += seen.kept();
        self.pixels += seen.pixels();
        self.wrong_pixels += seen.wrong_pixels;
        self.work += seen.work;
    }
    pub(super) fn step(&mut self, change: &Change) {
        self.steps += 1;
        self.changed += change.changed;
        self.popped += change.popped.len();
        self.popped_pixels += change.popped_pixels;
    }
    /// Adds what was found elsewhere.
    pub fn join(&mut self, other: &Self) {
        self.views += other.views;
        self.steps += other.steps;
        self.visible += other.visible;
        self.missed += other.missed;
        self.kept += other.kept;
        self.pixels += other.pixels;
        self.wrong_pixels += other.wrong_pixels;
        self.work += other.work;
        self.changed += other.changed;
        self.popped += other.popped;
        self.popped_pixels += other.popped_pixels;
        self.margin = [self.margin, other.margin].into_iter().flatten().reduce(f64::min);
    }
    /// Whether at every view nothing visible is missing and no pixel is wrong.
    pub fn is_exact(&self) -> bool {
        self.missed == 0 && self.wrong_pixels == 0
    }
    /// How much it fails in one respect, in the unit of the symptom; `prims` are those of the scene.
    pub fn of(&self, symptom: Symptom, prims: usize) -> f64 {
        let share = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
        match symptom {
            Symptom::Kept => share(self.kept, prims * self.views),
            Symptom::Missed => share(self.missed, self.visible),
            Symptom::Wrong => share(self.wrong_pixels, self.pixels),
            Symptom::Work => self.work as f64 / (prims * self.views).max(1) as f64,
            Symptom::Popped => share(self.popped_pixels, self.pixels),
        }
    }
}

/// A view of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// What was found, with what changed since the view before.
    pub found: Found,
    /// The primitives that were drawn here or at the view before only and are visible at both, ascending.
    pub popped: Vec<PrimId>,
}

/// Follows a path, from no memory. With `margins` each frame is recorded as well, which takes longer.
///
/// # Errors
/// It was cancelled.
pub fn along<S: World>(
    watcher: &mut Watcher<'_, S>,
    views: &[View<S>],
    margins: bool,
    progress: &dyn Progress,
) -> Result<Vec<Station>, ExperimentError> {
    let (mut stations, mut before): (Vec<Station>, Option<Seen>) = (Vec::new(), None);
    let passes = if margins { 2.0 } else { 1.0 };
    watcher.run().forget();
    for (at, view) in views.iter().enumerate() {
        checkpoint(progress, at as f32 / (passes * views.len() as f32), "following the path")?;
        let seen = watcher.look(at, view, progress).ok_or(ExperimentError::Cancelled)?;
        let change = before.as_ref().map(|before| seen.since(before));
        let mut found = Found::default();
        found.see(&seen);
        change.iter().for_each(|change| found.step(change));
        stations.push(Station { found, popped: change.unwrap_or_default().popped });
        before = Some(seen);
    }
    watcher.run().forget();
    for (at, (view, station)) in views.iter().zip(&mut stations).enumerate().filter(|_| margins) {
        checkpoint(progress, 0.5 + at as f32 / (2.0 * views.len() as f32), "looking for margins")?;
        watcher.pose(at, progress).ok_or(ExperimentError::Cancelled)?;
        station.found.margin = margin(watcher.run(), view);
    }
    Ok(stations)
}
