//! The decisions of a path made again: by an independent checker, in f64 and exact predicates, and how many
//! of them are so near that rounding could flip them.

use super::seen::Watcher;
use crate::geometry::View;
use crate::measure::experiment::{ExperimentError, World};
use crate::measure::harness::checkpoint;
use crate::method::{Compared, Verdict};
use crate::scene::Progress;
use crate::truth::certificate::check_film;

/// Events of a frame that are recorded; a longer frame is not looked at.
const MOST_EVENTS: usize = 4_000_000;

/// What became of decisions that left something out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Proof {
    /// Frames that were looked at, and those that were too long for it.
    pub frames: [usize; 2],
    /// Claims that the checker accepted ([`check_film`]).
    pub proven: usize,
    /// Frames of which it did not accept all, by number, with its reason for the first that it did not.
    pub refused: Vec<(usize, String)>,
    /// Decisions whose evidence tells the two numbers that were compared.
    pub told: usize,
    /// Those of them whose numbers are within some units in the last place of 32 bits.
    pub near: usize,
}

/// Whether two numbers are within so many units in the last place of the larger one, in 32 bits.
fn is_within(compared: &Compared, ulps: u32) -> bool {
    let (found, with) = (compared.found.1, compared.with.1);
    let size = found.abs().max(with.abs());
    (found - with).abs() <= f64::from(ulps) * size * f64::from(f32::EPSILON)
}

/// Makes the decisions of a path's frames again, from no memory; `ulps`: how near is near.
///
/// # Errors
/// It was cancelled.
pub fn proof<S: World>(
    watcher: &mut Watcher<'_, S>,
    views: &[View<S>],
    ulps: u32,
    progress: &dyn Progress,
) -> Result<Proof, ExperimentError> {
    let mut proof = Proof::default();
    watcher.run().forget();
    for (at, view) in views.iter().enumerate() {
        checkpoint(progress, at as f32 / views.len() as f32, "making decisions again")?;
        watcher.pose(at, progress).ok_or(ExperimentError::Cancelled)?;
        let film = watcher.run().record(view, MOST_EVENTS).film;
        proof.frames[usize::from(film.lost() > 0)] += 1;
        if film.lost() > 0 {
            continue;
        }
        match check_film(&*film) {
            Ok(count) => proof.proven += count,
            Err(rejection) => proof.refused.push((at, rejection.to_string())),
        }
        let left_out = film.events().iter().enumerate().filter(|(_, event)| {
            event.verdict().is_some_and(|v| !matches!(v, Verdict::Partial | Verdict::Visible))
        });
        for (event, _) in left_out {
            let Some(compared) = film.evidence_of(event).and_then(|note| film.compared(note)) else {
                continue;
            };
            proof.told += 1;
            proof.near += usize::from(is_within(&compared, ulps));
        }
    }
    Ok(proof)
}

#[cfg(test)]
mod tests {
    use crate::geometry::Flat;
    use crate::measure::stability::{Ask, stability};
    use crate::method::Settings;
    use crate::scene::{Quiet, example};

    /// What conservative methods leave out is proven; more is near where more counts as near.
    #[test]
    fn decisions_are_proven_and_near_ones_counted() {
        use crate::culling::Methods;
        let scene = example("street").expect("an example");
        let views = scene.paths()[0].views.clone();
        for key in ["frustum", "hierarchical-z"] {
            let entry = Flat::method(key).expect("a method");
            let mut nears = Vec::new();
            for ulps in [1, 1 << 20, 1 << 24] {
                let run = entry.ready(&scene, &Settings::default(), &Quiet).expect("settings");
                let mut run = run.expect("not cancelled");
                let ask = Ask { grid: 0, flips: 0, ulps, ..Ask::default() };
                let found = stability(&scene, &mut *run, &views, &ask, &Quiet).expect("not cancelled");
                let proof = found.proof.expect("asked for");
                assert_eq!((proof.frames, proof.refused), ([views.len(), 0], Vec::new()), "{key}");
                assert!(proof.proven > 0 && proof.told > 0 && proof.near <= proof.told, "{key}");
                nears.push(proof.near);
            }
            assert!(nears.is_sorted() && nears[2] > nears[0], "{key}: {nears:?}");
        }
    }
}
