//! The faces of a cell from areas, where others count samples (Section 4: "it might also be advantageous to
//! compute the RGBA value analytically").
//!
//! 1. Each primitive is clipped to the cell and projected on the face: a convex polygon, over which its
//!    height above the lower face is linear ([`Outline`]); in flatland an interval, as wide as the face.
//! 2. Where two of these overlap, one is before the other on either side of the line on which their heights
//!    are equal. So what hides a polygon is a list of convex polygons, whether primitives have an order by
//!    depth or not: those that cut each other or overlap in a ring need no other way.
//! 3. What hides it is taken off a polygon, one after the other, which leaves convex pieces; the sum of their
//!    areas is the part of the face that it shows on.
//!
//! Where more than [`MOST_PRIMS`] primitives are seen, or a polygon falls into more than [`MOST_PIECES`], it
//! takes too long, and where light comes through a primitive, shares multiply and do not add up: such faces
//! are the means of [`SIDE`]×[`SIDE`] samples.
//!
//! Cost: O(primitives² · pieces). Rounding: heights that differ by less than [`EQUAL`] are equal, and pieces
//! smaller than [`NOTHING`] are none; either is less than f32 keeps of a point.

use super::space::Outline;

/// Samples along a side of a face that is sampled in place of it.
pub const SIDE: u32 = 64;
/// Primitives of which each pair is compared.
const MOST_PRIMS: usize = 128;
/// Pieces that what shows of a primitive may fall into.
const MOST_PIECES: usize = 400;
/// Heights that are the same, in sizes of the cell.
const EQUAL: f64 = 1e-9;
/// An area that is none, in sizes of the face.
const NOTHING: f64 = 1e-13;

/// A point of the face: 0 to 1 along both axes.
type Point = [f64; 2];
/// `a·x + b·y + c`.
type Linear = [f64; 3];

/// A primitive that is seen on a face or the one across from it.
pub struct Surface {
    /// What it covers of them.
    pub outline: Outline,
    /// Its linear color in the light.
    pub color: [f32; 3],
    /// Whether it is seen from below and from above.
    pub seen: [bool; 2],
}

/// The lower and the upper face of an axis from the primitives of a cell, by ascending id. `None` where that
/// would take too long.
pub fn both_faces(surfaces: &[Surface]) -> Option<[[f32; 4]; 2]> {
    if surfaces.len() > MOST_PRIMS {
        return None;
    }
    let before = what_hides(surfaces);
    let mut faces = [[0.0; 4]; 2];
    for (face, to) in faces.iter_mut().enumerate() {
        let mut sum = [0.0_f64; 4];
        for (one, before) in surfaces.iter().zip(&before[face]).filter(|(one, _)| one.seen[face]) {
            let share = left_of(&one.outline.corners, before)?;
            (0..3).for_each(|c| sum[c] += share * f64::from(one.color[c]));
            sum[3] += share;
        }
        // Rounding may sum up the parts of a face to more than the whole.
        let most = 1.0 / sum[3].max(1.0);
        *to = sum.map(|c| (c * most) as f32);
    }
    Some(faces)
}

/// For both sides, and for each of some primitives, what others hide of it.
fn what_hides(surfaces: &[Surface]) -> [Vec<Vec<Vec<Point>>>; 2] {
    let mut before = [vec![Vec::new(); surfaces.len()], vec![Vec::new(); surfaces.len()]];
    let spans: Vec<_> = surfaces.iter().map(|s| span(&s.outline.corners)).collect();
    for (a, first) in surfaces.iter().enumerate() {
        for b in a + 1..surfaces.len() {
            if (0..2).any(|k| spans[a][k][0] >= spans[b][k][1] || spans[b][k][0] >= spans[a][k][1]) {
                continue;
            }
            let second = &surfaces[b];
            let overlap = intersection(&first.outline.corners, &second.outline.corners);
            if overlap.is_empty() {
                continue;
            }
            let gap: Linear = std::array::from_fn(|k| first.outline.height[k] - second.outline.height[k]);
            let mut hide = |from: usize, hidden: usize, hider: usize, part: &[Point]| {
                if surfaces[hider].seen[from] && !part.is_empty() {
                    before[from][hidden].push(part.to_vec());
                }
            };
            if overlap.iter().all(|p| at(gap, p).abs() <= EQUAL) {
                // Of equally near ones that of the lower id shows, as in the z-buffer.
                (0..2).for_each(|from| hide(from, b, a, &overlap));
                continue;
            }
            let [under, over] = cut(&overlap, gap);
            // Where the first is lower it is nearer to the lower face, and farther from the upper one.
            hide(0, b, a, &under);
            hide(0, a, b, &over);
            hide(1, a, b, &under);
            hide(1, b, a, &over);
        }
    }
    before
}

/// What is left of a polygon when others are taken off; `None` if it falls into too many pieces.
fn left_of(polygon: &[Point], others: &[Vec<Point>]) -> Option<f64> {
    let mut pieces = vec![polygon.to_vec()];
    for other in others {
        let (bounds, mut left) = (span(other), Vec::new());
        for piece in pieces {
            let own = span(&piece);
            let is_beside = (0..2).any(|k| own[k][0] >= bounds[k][1] || bounds[k][0] >= own[k][1]);
            // One that is missed is not to be parted along its sides.
            if is_beside || intersection(&piece, other).is_empty() {
                left.push(piece);
                continue;
            }
            let mut inside = piece;
            for side in sides(other) {
                let [beyond, within] = cut(&inside, side);
                if !beyond.is_empty() {
                    left.push(beyond);
                }
                inside = within;
            }
        }
        if left.len() > MOST_PIECES {
            return None;
        }
        pieces = left;
    }
    Some(pieces.iter().map(|piece| area(piece)).sum())
}

/// Least and greatest coordinate of a polygon along both axes.
fn span(polygon: &[Point]) -> [[f64; 2]; 2] {
    let mut span = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for point in polygon {
        (0..2).for_each(|k| span[k] = [span[k][0].min(point[k]), span[k][1].max(point[k])]);
    }
    span
}

fn at([a, b, c]: Linear, [x, y]: &Point) -> f64 {
    a * x + b * y + c
}

/// The area of a polygon that is gone around counterclockwise.
pub fn area(polygon: &[Point]) -> f64 {
    let Some(&[x, y]) = polygon.first() else { return 0.0 };
    // About its first corner, so that a small one far out is not lost.
    let cross = |p: &[Point]| (p[0][0] - x) * (p[1][1] - y) - (p[1][0] - x) * (p[0][1] - y);
    polygon.windows(2).map(cross).sum::<f64>() * 0.5
}

/// The sides of a convex polygon, each positive on its inner side.
fn sides(polygon: &[Point]) -> impl Iterator<Item = Linear> {
    (0..polygon.len()).map(|k| {
        let ([x, y], [to_x, to_y]) = (polygon[k], polygon[(k + 1) % polygon.len()]);
        let (a, b) = (y - to_y, to_x - x);
        [a, b, -(a * x + b * y)]
    })
}

/// What two convex polygons share; no point if that is nothing.
fn intersection(one: &[Point], other: &[Point]) -> Vec<Point> {
    let mut rest = one.to_vec();
    for side in sides(other) {
        if rest.is_empty() {
            break;
        }
        [_, rest] = cut(&rest, side);
    }
    rest
}

/// Cuts a convex polygon where a linear function is 0: where that is negative, and the rest. A part without
/// area has no point.
fn cut(polygon: &[Point], by: Linear) -> [Vec<Point>; 2] {
    let mut parts = [Vec::new(), Vec::new()];
    for (k, point) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        let [here, there] = [point, next].map(|p| at(by, p));
        if here <= 0.0 {
            parts[0].push(*point);
        }
        if here >= 0.0 {
            parts[1].push(*point);
        }
        if here < 0.0 && there > 0.0 || here > 0.0 && there < 0.0 {
            let share = here / (here - there);
            let between = [0, 1].map(|a| point[a] + share * (next[a] - point[a]));
            parts.iter_mut().for_each(|part| part.push(between));
        }
    }
    parts.map(|part| if area(&part) > NOTHING { part } else { Vec::new() })
}
