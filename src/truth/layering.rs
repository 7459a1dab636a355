//! Layering numbers: behind how many others a primitive is, where it is behind the fewest.
//!
//! Klosowski and Silva 2000, Section 3: order the primitives along each pixel by their distance to the eye;
//! the layering number ζ of a primitive is the smallest rank that it has over all pixels to which it
//! contributes. ζ is 1 if and only if the primitive is visible. By that definition and no other:
//!
//! 1. Each primitive gives its depth at each pixel that it covers, as the rasterizer has it.
//! 2. At each pixel these are ranked as the z-buffer would: the nearer first, at equal depth the lower id.
//! 3. Of its ranks a primitive keeps the least.
//!
//! Cost: O(pixels covered, those behind others too), twice: fragments are counted before they are kept, so
//! that what would take too much memory is refused before it takes any.

use crate::geometry::{PrimId, View};
use crate::raster::{Drawable, Options};
use crate::scene::{Part, Progress, Quiet, Scene, Surfaces};

/// A primitive at a pixel: `1/w` and its id.
type Fragment = (f32, u32);

/// Why primitives were not ranked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unranked {
    /// The work was cancelled.
    Cancelled,
    /// There are so many fragments (pairs of a primitive and a pixel that it covers), more than may be kept.
    TooMany(usize),
}

/// ζ of each primitive, by its number; 0 of those that cover no pixel. Of `surfaces` it matters whether they
/// have a back: then those that turn away are none. Every layer counts, what one can see through as well.
pub fn layering_numbers<S: Drawable>(scene: &Scene<S>, view: &View<S>, surfaces: Surfaces) -> Vec<u32> {
    layering_numbers_within(scene, view, surfaces, usize::MAX, &Quiet).unwrap_or_default()
}

/// The same, of at most so many fragments (8 bytes each) and for someone who waits.
///
/// # Errors
/// When cancelled, and where there are more.
pub fn layering_numbers_within<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    surfaces: Surfaces,
    most_fragments: usize,
    progress: &dyn Progress,
) -> Result<Vec<u32>, Unranked> {
    let frustum = view.frustum();
    let is_there = |p: &PrimId| {
        !surfaces.leave_out(scene, *p, view.eye.position) && !frustum.excludes(&scene.prim_bounds(*p))
    };
    let prims: Vec<PrimId> = scene.live().iter().copied().filter(is_there).collect();
    // 2. A counting sort by pixel, then each pixel by itself.
    let mut starts = vec![0usize; view.width as usize * view.height as usize + 1];
    let part = |start, length| Part { whole: progress, start, length };
    fragments(scene, view, &prims, &part(0.0, 0.3), &mut |at, _| starts[at + 1] += 1)?;
    (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
    let count = starts.last().copied().unwrap_or(0);
    if count > most_fragments {
        return Err(Unranked::TooMany(count));
    }
    let (mut sorted, mut next) = (vec![(0.0, 0); count], starts.clone());
    fragments(scene, view, &prims, &part(0.3, 0.3), &mut |at, fragment| {
        sorted[next[at]] = fragment;
        next[at] += 1;
    })?;
    let mut numbers = vec![0; scene.prim_count()];
    for (at, pixel) in starts.windows(2).enumerate() {
        if at.is_multiple_of(CHECKED) {
            checkpoint(&part(0.6, 0.4), at, starts.len())?;
        }
        let there: &mut [Fragment] = &mut sorted[pixel[0]..pixel[1]];
        there.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // 3.
        for (rank, (_, prim)) in there.iter().enumerate() {
            let (number, rank) = (&mut numbers[*prim as usize], rank as u32 + 1);
            *number = if *number == 0 { rank } else { rank.min(*number) };
        }
    }
    Ok(numbers)
}

/// Primitives, or pixels, between two looks at whether the work was cancelled.
const CHECKED: usize = 1024;

fn checkpoint(progress: &dyn Progress, done: usize, all: usize) -> Result<(), Unranked> {
    progress.report(done as f32 / all as f32, "ranking primitives by layers");
    if progress.cancelled() { Err(Unranked::Cancelled) } else { Ok(()) }
}

/// 1. Each primitive at each pixel that it covers.
fn fragments<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    prims: &[PrimId],
    progress: &dyn Progress,
    found: &mut dyn FnMut(usize, Fragment),
) -> Result<(), Unranked> {
    let (options, farthest) = (Options::default(), 1.0 / view.eye.far);
    for (i, prim) in prims.iter().enumerate() {
        if i.is_multiple_of(CHECKED) {
            checkpoint(progress, i, prims.len())?;
        }
        // The far plane does not cut primitives: it is a depth that nothing shows beyond.
        S::fragments(scene, view, *prim, &options, &mut |at, depth| {
            if depth >= farthest {
                found(at, (depth, prim.0));
            }
        });
    }
    Ok(())
}

/// Kendall's rank correlation of layers and places, over the pairs of different layers: 1 if all lower layers
/// come first. `layers` is by place; 0 are left out. 1 where no two layers differ.
pub fn layer_correlation(layers: &[u32]) -> f64 {
    // A tree of counts by layer (Fenwick): for each triangle how many of a lower and how many of a higher
    // layer came before it. O(n log layers).
    let most = layers.iter().copied().max().unwrap_or(0) as usize;
    let (mut counts, mut seen) = (vec![0u64; most + 1], 0);
    let (mut right, mut wrong) = (0u64, 0u64);
    for &layer in layers.iter().filter(|layer| **layer > 0) {
        let up_to = |mut at: usize| {
            let mut sum = 0;
            while at > 0 {
                sum += counts[at];
                at &= at - 1;
            }
            sum
        };
        right += up_to(layer as usize - 1);
        wrong += seen - up_to(layer as usize);
        let mut at = layer as usize;
        while at <= most {
            counts[at] += 1;
            at += at & at.wrapping_neg();
        }
        seen += 1;
    }
    if right + wrong == 0 { 1.0 } else { (right as f64 - wrong as f64) / (right + wrong) as f64 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{Flat, Solid};
    use crate::raster::{render, visible};
    use crate::scene::{framing_view, random_views, samples};

    fn is_the_least_rank<S: Drawable>(seed: u64) {
        // Primitives so large that some lie behind others.
        let mut parts = Arc::unwrap_or_clone(samples::soup::<S>(seed, 200)).into_parts();
        for prim in parts.prims.iter().flatten() {
            let corners = prim.as_ref();
            let first = parts.points[corners[0] as usize];
            for &corner in corners {
                parts.points[corner as usize] = first + (parts.points[corner as usize] - first) * 6.0;
            }
        }
        let scene = Scene::new(parts).expect("a scene");
        let mut deepest = 0;
        let outside = framing_view(&scene.bounds(), 48, 48);
        for mut view in random_views(&scene, 3, 5).into_iter().chain([outside]) {
            (view.width, view.height) = (48, view.height.min(48));
            let numbers = layering_numbers(&scene, &view, Surfaces::default());
            let seen = visible(&render(&scene, &view, scene.live()));
            let first: Vec<PrimId> = scene.live().iter().copied().filter(|p| numbers[p.at()] == 1).collect();
            assert_eq!(first, seen, "ζ is 1 if and only if it is visible");
            deepest = deepest.max(numbers.iter().copied().max().unwrap_or(0));
            for &prim in scene.live() {
                assert_eq!(numbers[prim.at()], brute_force(&scene, &view, prim), "{prim}");
            }
        }
        assert!(deepest > 2, "some lie behind others: {deepest}");
    }

    /// The definition for one primitive, pixel by pixel: with which of all others it shares one, and loses.
    fn brute_force<S: Drawable>(scene: &Scene<S>, view: &View<S>, prim: PrimId) -> u32 {
        let mine = render(scene, view, &[prim]);
        let mut before = vec![0u32; mine.item.len()];
        for &other in scene.live().iter().filter(|o| **o != prim) {
            let both = render(scene, view, &[prim, other]);
            for at in (0..before.len()).filter(|at| mine.item[*at] == prim.0) {
                before[at] += u32::from(both.item[at] != prim.0);
            }
        }
        let own = (0..before.len()).filter(|at| mine.item[*at] == prim.0);
        own.map(|at| before[at] + 1).min().unwrap_or(0)
    }

    #[test]
    fn it_is_the_least_rank_over_all_pixels() {
        is_the_least_rank::<Flat>(3);
        is_the_least_rank::<Solid>(4);
    }

    #[test]
    fn more_fragments_than_may_be_kept_are_counted_and_refused() {
        let scene = samples::soup::<Solid>(7, 50);
        let view = framing_view(&scene.bounds(), 512, 512);
        let within = |most| layering_numbers_within(&*scene, &view, Surfaces::default(), most, &Quiet);
        let Err(Unranked::TooMany(count)) = within(0) else { panic!("some pixels are covered") };
        assert!(count > 50, "{count}");
        assert_eq!(within(count - 1), Err(Unranked::TooMany(count)));
        assert_eq!(within(count), Ok(layering_numbers(&*scene, &view, Surfaces::default())));
    }

    #[test]
    fn a_correlation_is_that_of_all_pairs() {
        assert_eq!(layer_correlation(&[1, 1, 2, 0, 2, 3]), 1.0, "by layers, ties either way");
        assert_eq!(layer_correlation(&[3, 2, 1]), -1.0);
        // Pairs of different layers: (2, 1) wrong, (2, 3), (1, 2), (1, 3), (2, 3) right, (3, 2) wrong.
        let layers = [2, 1, 3, 0, 2];
        let (mut right, mut wrong) = (0.0, 0.0);
        for (i, a) in layers.iter().enumerate().filter(|(_, a)| **a > 0) {
            for b in layers[i + 1..].iter().filter(|b| **b > 0 && *b != a) {
                if a < b { right += 1.0 } else { wrong += 1.0 }
            }
        }
        assert_eq!(layer_correlation(&layers), (right - wrong) / (right + wrong));
        assert_eq!(layer_correlation(&[1, 1]), 1.0);
    }
}
