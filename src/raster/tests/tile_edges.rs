//! Tiles cover what the reference covers, to the pixel, where edges run through pixels' centers.

use super::tiles::drawn;
use super::*;

/// A place on the grid, 256ths of a pixel.
type Grid = [i32; 2];

/// Whether a place lies to the right of an edge (1), on it (0) or to the left (−1); y is down.
fn side_of([a, b]: [Grid; 2], at: Grid) -> i32 {
    let off = |p: Grid, k: usize| i64::from(p[k] - a[k]);
    (off(b, 0) * off(at, 1) - off(b, 1) * off(at, 0)).signum() as i32
}
fn plus([a, b]: Grid, [c, d]: Grid, times: i32) -> Grid {
    [a + c * times, b + d * times]
}

/// Ways to the next center along an edge, pixels: level, upright, and slanted.
const SLOPES: [Grid; 8] = [[1, 0], [0, 1], [1, 1], [2, 1], [1, 2], [1, 3], [3, 7], [7, 3]];

/// An edge that runs through the centers of pixels, and those between its ends.
struct Tied {
    ends: [Grid; 2],
    centers: Vec<[i32; 2]>,
}

impl Tied {
    /// Some pixels long, through a pixel of an image of `size` by `size`.
    fn new(dice: &mut Dice, size: u32, long: i32) -> Self {
        let pixel = [(); 2].map(|()| dice.below(size) as i32);
        let [p, q] = SLOPES[dice.below(8) as usize];
        let way = [[p, q], [-p, q], [p, -q], [-p, -q]][dice.below(4) as usize];
        let steps = long * 256 / p.max(q);
        // The edge is any number of times as long as the way of one step: the reciprocals of its height, by
        // which windows multiply, are rounded up as well as down.
        let before = dice.below(steps as u32) as i32;
        let after = (steps - before).max(1) - dice.below(2) as i32;
        let center = pixel.map(|p| p * 256 + 128);
        let ends = [plus(center, way, -before), plus(center, way, after)];
        let inside = (-before / 256..=after / 256).filter(|j| -before < 256 * j && 256 * j < after);
        Self { ends, centers: inside.map(|j| plus(pixel, way, j)).collect() }
    }
    /// A place on one side of it: `side` is 1 or −1.
    fn beside(&self, dice: &mut Dice, side: i32) -> Grid {
        let [a, b] = self.ends;
        let e = [b[0] - a[0], b[1] - a[1]];
        let (along, off) = (dice.between(-0.2, 1.2), dice.between(0.05, 0.8) * side as f32);
        let at = |k: usize, square: i32| a[k] + (e[k] as f32 * along + square as f32 * off) as i32;
        [at(0, -e[1]), at(1, e[0])]
    }
}

/// A triangle or quadrangle in a plane of its own, corners on the grid, as triangles.
fn in_a_plane(dice: &mut Dice, size: u32, corners: &[Grid]) -> Vec<[Vec3; 3]> {
    let [right, down] = [(); 2].map(|()| f64::from(dice.signed(1.0)) / 1e6);
    let point = |&[x, y]: &Grid| {
        // Depths are linear over the image.
        let depth = 0.25 * (1.0 + right * f64::from(x) + down * f64::from(y));
        at_px(size, f64::from(x) / 256.0, f64::from(y) / 256.0, 1.0 / depth)
    };
    let at: Vec<Vec3> = corners.iter().map(point).collect();
    (2..at.len()).map(|k| [at[0], at[k - 1], at[k]]).collect()
}

/// Asserts that tiles are what the reference draws on every instruction set, and returns what it covers.
fn as_the_reference(triangles: &[[Vec3; 3]], view: &View<Solid>, what: &str) -> Vec<bool> {
    let (scene, mut truth) = (soup(triangles), Target::new(view));
    Solid::draw_reference(&mut truth, &scene, view, scene.live(), &Options::default());
    let covered: Vec<bool> = truth.item.iter().map(|&i| i != Target::NONE).collect();
    // Wider sets run on eight lanes too.
    for isa in [Isa::Portable, Isa::best()] {
        let mut tiles = drawn(&scene, view, BOTH_SIDES, isa);
        tiles.assert_claims(&truth.depth);
        let place = |at: usize| (at as u32 % view.width, at as u32 / view.width);
        let wrong = tiles.covered().iter().zip(&covered).position(|(is, should)| is != should).map(place);
        assert_eq!(wrong, None, "covered or not, {}: {what}", isa.label());
        let same = |(is, should): (&f32, &f32)| is.to_bits() == should.to_bits();
        let wrong = tiles.depths(isa).iter().zip(&truth.depth).position(|pair| !same(pair)).map(place);
        assert_eq!(wrong, None, "depth, {}: {what}", isa.label());
    }
    covered
}

/// Pineda 1988 with the top-left rule: triangles and quadrangles on both sides of an edge through centers,
/// and the same with one of its ends a grid step off; of all sizes that windows treat apart.
#[test]
fn a_center_on_an_edge_belongs_to_one_side_of_it() {
    let mut dice = Dice::new(75);
    // Up to 40, up to 256 and more pixels, in images that they mostly reach beyond.
    for (rounds, size, long) in [(240, 128, [2, 20]), (120, 120, [60, 140]), (160, 160, [260, 420])] {
        let (view, mut on_edges) = (straight_view(size, 0.1, 100.0), 0);
        for round in 0..rounds {
            let long = long[0] + dice.below((long[1] - long[0]) as u32) as i32;
            let mut edge = Tied::new(&mut dice, size, long);
            let is_tied = round % 2 == 0;
            if !is_tied {
                // Edge functions at the centers next to this end are a few steps' worth.
                let step = [[1, 0], [-1, 0], [0, 1], [0, -1]][dice.below(4) as usize];
                edge.ends[1] = plus(edge.ends[1], step, 1);
            }
            let mut owners = vec![0; (size * size) as usize];
            let mut both = Vec::new();
            for side in [1, -1] {
                let off = edge.beside(&mut dice, side);
                let [a, b] = edge.ends;
                let fourth = [off[0] + a[0] - b[0], off[1] + a[1] - b[1]];
                let corners = if round / 2 % 2 == 0 { vec![a, b, off] } else { vec![a, b, off, fourth] };
                assert_ne!(side_of(edge.ends, off), -side, "{off:?} beside {:?}", edge.ends);
                let triangles = in_a_plane(&mut dice, size, &corners);
                let covered = as_the_reference(&triangles, &view, &format!("{corners:?}"));
                owners.iter_mut().zip(covered).for_each(|(n, is)| *n += u32::from(is));
                both.extend(triangles);
            }
            as_the_reference(&both, &view, &format!("both sides of {:?}", edge.ends));
            for &[x, y] in &edge.centers {
                let is_in_image = (0..size as i32).contains(&x) && (0..size as i32).contains(&y);
                if is_tied && is_in_image {
                    on_edges += 1;
                    let count = owners[(y * size as i32 + x) as usize];
                    assert_eq!(count, 1, "owners of ({x}, {y}) on {:?}", edge.ends);
                }
            }
        }
        assert!(on_edges > rounds, "{on_edges} centers lie on edges");
    }
}
