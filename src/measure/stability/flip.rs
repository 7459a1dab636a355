//! Where exactly a decision flips between two views, and the test that decides there.

use super::margin::relative;
use super::seen::Watcher;
use crate::geometry::{PrimId, Vector, View};
use crate::measure::experiment::{ExperimentError, World};
use crate::measure::harness::checkpoint;
use crate::method::{Compared, Reel};
use crate::scene::Progress;
use crate::trace::Stamps;

/// Events of a frame that are recorded; decisions beyond are not told.
const MOST_EVENTS: usize = 4_000_000;
/// Halvings of the way between two views, at most.
const HALVINGS: usize = 48;

/// A place between two views at which a primitive that is visible at both begins or ceases to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The primitive.
    pub prim: PrimId,
    /// The view before, by its number in the path.
    pub after_view: usize,
    /// Where the eye stands on both sides of the flip, a number an axis: where it is drawn, where it is not.
    pub eyes: [Vec<f32>; 2],
    /// Whether it shows there; on the way between two views at which it does it may be out of sight.
    pub shows: [bool; 2],
    /// How far these are apart, world units.
    pub apart: f32,
    /// What decided on both sides, in the same order.
    pub decided: [Decided; 2],
}

/// A decision, and the evidence that it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Decided {
    /// The step of the film, from which on it holds.
    pub step: Option<usize>,
    /// Kebab-case name of the verdict, or `untold`.
    pub verdict: &'static str,
    /// What decided, in a sentence or two; empty if no evidence is told.
    pub sentence: String,
    /// The two numbers that were compared.
    pub compared: Option<Compared>,
    /// How far these are apart, as a share of the larger one.
    pub margin: Option<f64>,
}

/// Narrows the way between two neighboring views until a primitive's fate flips within `tolerance` world
/// units, or within the spacing of the numbers. Answers are those without memory; `None` where these do not
/// differ.
///
/// # Errors
/// It was cancelled.
pub fn narrowed<S: World>(
    watcher: &mut Watcher<'_, S>,
    (after_view, views): (usize, [&View<S>; 2]),
    prim: PrimId,
    tolerance: f32,
    progress: &dyn Progress,
) -> Result<Option<Flip>, ExperimentError> {
    let mut draws = |view: &View<S>| -> Result<bool, ExperimentError> {
        // Where objects move, all of the way is looked at in the frame of the first view.
        watcher.pose(after_view, progress).ok_or(ExperimentError::Cancelled)?;
        watcher.run().forget();
        Ok(watcher.run().cull(view).prims.contains(&prim))
    };
    let mut ends = [*views[0], *views[1]];
    let at_ends = [draws(&ends[0])?, draws(&ends[1])?];
    if at_ends[0] == at_ends[1] {
        return Ok(None);
    }
    for halving in 0..HALVINGS {
        checkpoint(progress, halving as f32 / HALVINGS as f32, "narrowing")?;
        let between = middle(&ends);
        let is_end = ends.iter().any(|e| e.eye.position == between.eye.position);
        if is_end && ends.iter().any(|e| e.eye.target == between.eye.target) || apart(&ends) <= tolerance {
            break;
        }
        let same_as = usize::from(draws(&between)? != at_ends[0]);
        ends[same_as] = between;
    }
    if at_ends[1] {
        ends.swap(0, 1);
    }
    let mut decided = |view: &View<S>| -> Result<(bool, Decided), ExperimentError> {
        watcher.run().forget();
        let seen = watcher.look(after_view, view, progress).ok_or(ExperimentError::Cancelled)?;
        watcher.run().forget();
        let film = watcher.run().record(view, MOST_EVENTS).film;
        let shows = seen.visible.binary_search(&prim).is_ok();
        Ok((shows, told(&*film, Stamps::new(&*film).prim_decision(prim))))
    };
    let [(shows, drawn), (shows_too, left_out)] = [decided(&ends[0])?, decided(&ends[1])?];
    let numbers = |view: &View<S>| (0..S::Vector::AXES).map(|a| view.eye.position.get(a)).collect();
    let eyes = [numbers(&ends[0]), numbers(&ends[1])];
    let (shows, decided) = ([shows, shows_too], [drawn, left_out]);
    Ok(Some(Flip { prim, after_view, eyes, shows, apart: apart(&ends), decided }))
}

/// The view halfway.
fn middle<S: World>([a, b]: &[View<S>; 2]) -> View<S> {
    let mut between = *a;
    between.eye.position = (a.eye.position + b.eye.position) * 0.5;
    between.eye.target = (a.eye.target + b.eye.target) * 0.5;
    between
}

/// How far the eyes, or what they look at, are apart.
fn apart<S: World>([a, b]: &[View<S>; 2]) -> f32 {
    let eyes = (a.eye.position - b.eye.position).length();
    eyes.max((a.eye.target - b.eye.target).length())
}

/// The decision that was made at a step.
fn told(film: &(impl Reel + ?Sized), decision: Option<(usize, crate::method::Verdict)>) -> Decided {
    let Some((step, verdict)) = decision else {
        return Decided {
            step: None,
            verdict: "untold",
            sentence: String::new(),
            compared: None,
            margin: None,
        };
    };
    let evidence = film.evidence_of(step - 1);
    let compared = evidence.and_then(|at| film.compared(at));
    Decided {
        step: Some(step),
        verdict: verdict.name(),
        sentence: evidence.map(|at| film.sentence(at)).unwrap_or_default(),
        margin: compared.as_ref().map(relative),
        compared,
    }
}
