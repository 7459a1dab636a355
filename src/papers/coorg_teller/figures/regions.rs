//! Regions of viewpoints: lines cut a rectangle into convex cells, within which nothing changes; neighbors
//! that are alike are joined again where that leaves them convex. Cost: O(cells · lines), and O(cells³) to
//! join.

use glam::DVec2;

use crate::geometry::Aabb;

/// A line with a positive side: `normal · (x − at) > 0`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub(super) at: DVec2,
    pub(super) normal: DVec2,
}

/// Nearer than this to a line counts as on it, in units of the rectangle's size.
const TOUCH: f64 = 1e-7;

/// The convex cells of a rectangle between lines, each counter-clockwise.
pub(super) fn cells(frame: &Aabb<DVec2>, borders: &[Border]) -> Vec<Vec<DVec2>> {
    let (a, b) = (frame.min, frame.max);
    let near = (b - a).length() * TOUCH;
    let mut cells = vec![vec![a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)]];
    for border in borders {
        let normal = border.normal.normalize();
        let cut = |cell: Vec<DVec2>| {
            let heights: Vec<f64> = cell.iter().map(|p| snapped(normal.dot(*p - border.at), near)).collect();
            if heights.iter().all(|h| *h >= 0.0) || heights.iter().all(|h| *h <= 0.0) {
                return vec![cell];
            }
            [1.0, -1.0].map(|sign| side(&cell, &heights, sign)).to_vec()
        };
        cells = cells.into_iter().flat_map(cut).collect();
    }
    cells
}

fn snapped(height: f64, near: f64) -> f64 {
    if height.abs() < near { 0.0 } else { height }
}

/// The part of a cell on one side of a line, from the heights of its corners.
fn side(cell: &[DVec2], heights: &[f64], sign: f64) -> Vec<DVec2> {
    let mut kept = Vec::new();
    for i in 0..cell.len() {
        let j = (i + 1) % cell.len();
        let (h, k) = (sign * heights[i], sign * heights[j]);
        if h >= 0.0 {
            kept.push(cell[i]);
        }
        if h * k < 0.0 {
            // From the same end in both parts and both neighbors, so that the corner has the same bits.
            let (p, q, h, k) = if cell[i].x < cell[j].x || cell[i].x == cell[j].x && cell[i].y < cell[j].y {
                (cell[i], cell[j], h.abs(), k.abs())
            } else {
                (cell[j], cell[i], k.abs(), h.abs())
            };
            kept.push(p + (q - p) * (h / (h + k)));
        }
    }
    kept
}

/// Cells with what `class` says of their middle, neighbors of one class joined; those without a class are
/// left out.
pub(super) fn regions<T: Copy + PartialEq>(
    frame: &Aabb<DVec2>,
    borders: &[Border],
    class: impl Fn(DVec2) -> Option<T>,
) -> Vec<(T, Vec<DVec2>)> {
    let near = (frame.max - frame.min).length() * TOUCH;
    let mut all: Vec<(T, Vec<DVec2>)> =
        cells(frame, borders).into_iter().filter_map(|c| Some((class(middle(&c))?, c))).collect();
    while let Some((i, j, joined)) = pair(&all, near) {
        all[i].1 = joined;
        all.remove(j);
    }
    all.into_iter().map(|(class, cell)| (class, without_straight_corners(&cell, near))).collect()
}

fn pair<T: Copy + PartialEq>(all: &[(T, Vec<DVec2>)], near: f64) -> Option<(usize, usize, Vec<DVec2>)> {
    (0..all.len()).find_map(|i| {
        (i + 1..all.len()).find_map(|j| {
            let joined = if all[i].0 == all[j].0 { union(&all[i].1, &all[j].1, near) } else { None };
            joined.map(|joined| (i, j, joined))
        })
    })
}

/// Two cells as one, if they share a border and are convex together.
fn union(a: &[DVec2], b: &[DVec2], near: f64) -> Option<Vec<DVec2>> {
    let same = |p: DVec2, q: DVec2| (p - q).length() < near;
    let edges = |c: &[DVec2]| (0..c.len()).map(|i| [c[i], c[(i + 1) % c.len()]]).collect::<Vec<_>>();
    let (ea, eb) = (edges(a), edges(b));
    let left = |from: &[[DVec2; 2]], other: &[[DVec2; 2]]| {
        from.iter()
            .copied()
            .filter(|e| !other.iter().any(|o| same(e[0], o[1]) && same(e[1], o[0])))
            .collect::<Vec<_>>()
    };
    let mut open = left(&ea, &eb);
    if open.len() == ea.len() {
        return None;
    }
    open.extend(left(&eb, &ea));
    let [start, mut at] = open.swap_remove(0);
    let mut outline = vec![start];
    while !same(at, start) {
        let next = open.iter().position(|e| same(e[0], at))?;
        outline.push(at);
        at = open.swap_remove(next)[1];
    }
    let turns_left = |i: usize| {
        let (p, q, r) = (outline[i], outline[(i + 1) % outline.len()], outline[(i + 2) % outline.len()]);
        (q - p).perp_dot(r - q) >= -near * ((q - p).length() + (r - q).length())
    };
    (open.is_empty() && (0..outline.len()).all(turns_left)).then_some(outline)
}

fn without_straight_corners(cell: &[DVec2], near: f64) -> Vec<DVec2> {
    let n = cell.len();
    let bends = |i: usize| {
        let (p, q, r) = (cell[(i + n - 1) % n], cell[i], cell[(i + 1) % n]);
        (q - p).perp_dot(r - q).abs() > near * (r - p).length()
    };
    (0..n).filter(|&i| bends(i)).map(|i| cell[i]).collect()
}

/// The middle of a cell: its center of mass.
pub(super) fn middle(cell: &[DVec2]) -> DVec2 {
    let o = cell[0];
    let (mut area, mut sum) = (0.0, DVec2::ZERO);
    for w in cell[1..].windows(2) {
        let a = (w[0] - o).perp_dot(w[1] - o);
        area += a;
        sum += ((w[0] - o) + (w[1] - o)) * (a / 3.0);
    }
    if area > 0.0 { o + sum * (1.0 / area) } else { o }
}

/// Area of a cell, square units.
pub(super) fn area(cell: &[DVec2]) -> f64 {
    cell[1..].windows(2).map(|w| (w[0] - cell[0]).perp_dot(w[1] - cell[0])).sum::<f64>() * 0.5
}

/// Whether a cell holds a point.
pub(super) fn holds(cell: &[DVec2], p: DVec2) -> bool {
    (0..cell.len()).all(|i| (cell[(i + 1) % cell.len()] - cell[i]).perp_dot(p - cell[i]) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    #[test]
    fn cells_tile_the_rectangle_and_regions_keep_their_class() {
        let mut rng = Pcg32::seed_from_u64(5);
        let mut number = |span: f64| (f64::from(rng.next_u32()) / f64::from(u32::MAX) - 0.5) * span;
        let frame = Aabb { min: DVec2::new(-4.0, -3.0), max: DVec2::new(4.0, 3.0) };
        for _ in 0..50 {
            let borders: Vec<Border> = (0..7)
                .map(|_| Border {
                    at: DVec2::new(number(6.0), number(4.0)),
                    normal: DVec2::new(number(2.0), number(2.0)),
                })
                .collect();
            let inside = |p: DVec2| borders.iter().filter(|b| b.normal.dot(p - b.at) > 0.0).count();
            let class = |p: DVec2| (inside(p) < 5).then(|| inside(p) / 2);
            let whole: f64 = cells(&frame, &borders).iter().map(|c| area(c)).sum();
            assert!((whole - 48.0).abs() < 1e-6, "{whole}");
            let all = regions(&frame, &borders, class);
            for _ in 0..200 {
                let p = DVec2::new(number(8.0), number(6.0));
                let found: Vec<usize> = all.iter().filter(|(_, c)| holds(c, p)).map(|r| r.0).collect();
                assert_eq!(found, class(p).into_iter().collect::<Vec<_>>(), "{p}");
            }
        }
    }
}
