//! Hatches as clipped lines and dots: not every program that opens a figure knows patterns.
//!
//! The phase is fixed to the paper, so the hatches of neighboring areas run on into each other. Any
//! simple polygon will do. Cost: lines inside the window times corners.

use glam::{Vec2, vec2};

use super::theme::{HATCH_PT, Hatch};

/// More lines than this fill an area so densely that nothing is told; a window that is no window has them.
const MOST_LINES: i32 = 4000;

/// The lines and dots of a hatch inside a polygon, as far as they are in the window (minimum, maximum).
pub(super) struct Hatching {
    pub lines: Vec<[Vec2; 2]>,
    pub dots: Vec<Vec2>,
}

pub(super) fn hatching(points: &[Vec2], hatch: Hatch, window: [Vec2; 2]) -> Hatching {
    let mut out = Hatching { lines: Vec::new(), dots: Vec::new() };
    // Rising lines have x + y constant, falling ones x − y (y points down).
    let rising = vec2(1.0, 1.0) / f32::sqrt(2.0);
    let falling = vec2(-1.0, 1.0) / f32::sqrt(2.0);
    match hatch {
        Hatch::None => {}
        Hatch::Diagonal => scan(points, rising, window, &mut |a, b| out.lines.push([a, b])),
        Hatch::Falling => scan(points, falling, window, &mut |a, b| out.lines.push([a, b])),
        Hatch::Cross => {
            scan(points, rising, window, &mut |a, b| out.lines.push([a, b]));
            scan(points, falling, window, &mut |a, b| out.lines.push([a, b]));
        }
        Hatch::Dots => scan(points, rising, window, &mut |a, b| {
            let (from, to) = (falling.dot(a).min(falling.dot(b)), falling.dot(a).max(falling.dot(b)));
            for i in places(from, to) {
                out.dots.push(rising * rising.dot(a) + falling * at(i));
            }
        }),
    }
    out
}

/// Offset of the `i`th line of a hatch from the origin.
fn at(i: i32) -> f32 {
    (i as f32 + 0.5) * HATCH_PT
}

/// Numbers of the lines between two offsets.
fn places(from: f32, to: f32) -> std::ops::Range<i32> {
    let first = (from / HATCH_PT - 0.5).ceil() as i32;
    let last = (to / HATCH_PT - 0.5).floor() as i32;
    first..last.min(first.saturating_add(MOST_LINES)).saturating_add(1)
}

/// Calls `put` with the part inside polygon and window of each line `normal · p = at(i)`.
fn scan(points: &[Vec2], normal: Vec2, window: [Vec2; 2], put: &mut impl FnMut(Vec2, Vec2)) {
    let along = normal.perp();
    let corners = [window[0], vec2(window[1].x, window[0].y), window[1], vec2(window[0].x, window[1].y)];
    let span = |points: &[Vec2]| {
        points
            .iter()
            .map(|p| normal.dot(*p))
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    };
    let (area, seen) = (span(points), span(&corners));
    let mut cuts = Vec::new();
    for i in places(area.0.max(seen.0), area.1.min(seen.1)) {
        cuts.clear();
        crossings(points, normal, at(i), &mut cuts);
        cuts.sort_by(f32::total_cmp);
        let (mut low, mut high) = (f32::NEG_INFINITY, f32::INFINITY);
        for axis in 0..2 {
            // The window is convex: clip by its slabs.
            let (o, d) = ((normal * at(i))[axis], along[axis]);
            let (a, b) = ((window[0][axis] - o) / d, (window[1][axis] - o) / d);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        for pair in cuts.chunks_exact(2) {
            let (a, b) = (pair[0].max(low), pair[1].min(high));
            if a < b {
                put(normal * at(i) + along * a, normal * at(i) + along * b);
            }
        }
    }
}

/// Where the outline crosses the line `normal · p = offset`, measured along it; an even number of places.
fn crossings(points: &[Vec2], normal: Vec2, offset: f32, out: &mut Vec<f32>) {
    let along = normal.perp();
    for (i, p) in points.iter().enumerate() {
        let q = points[(i + 1) % points.len()];
        let (a, b) = (normal.dot(*p) - offset, normal.dot(q) - offset);
        // Half-open, so that a corner on the line counts once or twice, as it should.
        if (a < 0.0) != (b < 0.0) {
            out.push(along.dot(*p + (q - *p) * (a / (a - b))));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    const WINDOW: [Vec2; 2] = [Vec2::ZERO, Vec2::splat(100.0)];

    fn inside(points: &[Vec2], p: Vec2) -> bool {
        let mut inside = false;
        for (i, a) in points.iter().enumerate() {
            let b = points[(i + 1) % points.len()];
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
        }
        inside
    }

    #[test]
    fn lines_stay_inside_and_fill_the_area() {
        let mut rng = Pcg32::seed_from_u64(3);
        let mut next = || (rng.next_u32() % 1000) as f32 / 10.0;
        for _ in 0..200 {
            // A star around the middle is simple, and seldom convex.
            let points: Vec<Vec2> = (0..7)
                .map(|i| vec2(50.0, 50.0) + Vec2::from_angle(i as f32 * 0.897) * (5.0 + next() * 0.4))
                .collect();
            let area: f32 = (0..7).map(|i| points[i].perp_dot(points[(i + 1) % 7])).sum::<f32>().abs() / 2.0;
            let lines = hatching(&points, Hatch::Diagonal, WINDOW).lines;
            for [a, b] in &lines {
                assert!(inside(&points, (*a + *b) / 2.0), "{points:?} {a} {b}");
            }
            let hatched: f32 = lines.iter().map(|[a, b]| a.distance(*b) * HATCH_PT).sum();
            assert!((hatched - area).abs() < 0.15 * area + 40.0, "{hatched} of {area}");
        }
    }

    #[test]
    fn cost_is_bounded_by_the_window() {
        let huge = [vec2(-9e5, -9e5), vec2(9e5, -9e5), vec2(9e5, 9e5), vec2(-9e5, 9e5)];
        for hatch in [Hatch::Diagonal, Hatch::Falling, Hatch::Cross, Hatch::Dots] {
            let h = hatching(&huge, hatch, WINDOW);
            assert!(h.lines.len() < 120 && h.dots.len() < 1000, "{hatch:?}");
            assert!(h.lines.len() + h.dots.len() > 30, "{hatch:?}");
            assert!(
                h.lines
                    .iter()
                    .flatten()
                    .chain(&h.dots)
                    .all(|p| p.min_element() > -0.1 && p.max_element() < 100.1)
            );
        }
        assert!(
            hatching(&huge, Hatch::Diagonal, [Vec2::ZERO, Vec2::splat(f32::INFINITY)]).lines.len() <= 4001
        );
        assert!(hatching(&[], Hatch::Cross, WINDOW).lines.is_empty());
    }
}
