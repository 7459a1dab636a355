//! Occlusion maps: they count what the image leaves empty, and what is behind all that covers it.

use super::tiles::{ROUNDS, SETS, drawn, flat_mixed, flat_size, flat_view, image, mixed, random_view, sizes};
use super::*;

/// Of each pixel of a level its black samples, counted in the image.
fn counted(maps: &Opacity, image: &Target, cell: PyramidCell) -> u32 {
    let side = 1 << maps.shift(cell.level);
    let (x, y) = (u32::from(cell.x) * side, u32::from(cell.y) * side);
    let rows = y..(y + side).min(image.height);
    let row = |y: u32| (x..(x + side).min(image.width)).map(move |x| (y * image.width + x) as usize);
    rows.flat_map(row).filter(|&at| image.item[at] == Target::NONE).count() as u32
}

fn maps_are_of_the_image<S: Drawable>(scene: &Scene<S>, view: &View<S>, round: u32) -> u32 {
    let (target, tiles) = (image(scene, view, BOTH_SIDES), drawn(scene, view, BOTH_SIDES, Isa::best()));
    let (mut maps, mut again, mut mixed) = (Opacity::default(), Opacity::default(), 0);
    let (size, shift, is_flat) = ([view.width, view.height], round % 6, S::CORNERS == 2);
    maps.clear(size, shift, is_flat);
    again.clear(size, shift, is_flat);
    maps.build(&tiles);
    again.build_from_depths(&target.depth, 1.0 / view.eye.far);
    assert!(maps == again, "masks and depths tell the same");
    for cell in (0..maps.levels()).flat_map(|level| maps.cells(level)) {
        let black = counted(&maps, &target, cell);
        assert_eq!(maps.black(cell), black, "{cell:?} of {size:?}, round {round}");
        mixed += u32::from(black > 0 && black < maps.present(cell));
    }
    mixed
}

#[test]
fn maps_count_the_pixels_that_the_image_leaves_empty() {
    let (mut dice, mut mixed_cells) = (Dice::new(91), 0);
    for round in 0..ROUNDS {
        let scene = mixed(&mut dice, 10 + round as usize * 7 % 60);
        let (width, height) = sizes(round / 2);
        let mut view = random_view(&mut dice, width, height);
        // What crosses the far plane covers pixels in tiles that it does not in the image.
        view.eye.far = 1e4;
        mixed_cells += maps_are_of_the_image(&scene, &view, round);
    }
    assert!(mixed_cells > 5_000, "{mixed_cells} pixels are neither black nor white");
    for round in 0..10 * ROUNDS {
        let (width, _) = flat_size(round);
        let scene = flat_mixed(&mut dice, 10, 1.0);
        let mut view = flat_view(&mut dice, width, 1.0);
        view.eye.far = 1e7;
        mixed_cells += maps_are_of_the_image(&scene, &view, round);
    }
    assert!(mixed_cells > 7_000, "{mixed_cells}");
}

/// Keeps what is brought up to date, and what decided.
#[derive(Default)]
struct Heard(Vec<PyramidCell>, Option<Read>);

impl Hears for Heard {
    const LISTENS: bool = true;
    fn reads(&mut self, read: Read) {
        self.1 = Some(read);
    }
    fn refreshes(&mut self, cell: PyramidCell) {
        self.0.push(cell);
    }
}

/// Returns whether it is behind, and whether it is behind without being hidden.
fn ask<S: Drawable>(scene: &Scene<S>, view: &View<S>, dice: &mut Dice, round: u32) -> [usize; 3] {
    let mut found = [0; 3];
    let target = image(scene, view, BOTH_SIDES);
    let mut tiles = drawn(scene, view, BOTH_SIDES, SETS[round as usize % 3]);
    for _ in 0..40 {
        let span = |dice: &mut Dice, end: u32| {
            let (a, b) = (dice.below(end), dice.below(end));
            (a.min(b), a.max(b) + 1)
        };
        let ((x0, x1), (y0, y1)) = (span(dice, view.width), span(dice, view.height));
        let pixels = PixelRect { x0, x1, y0, y1 };
        // Half of them exactly as deep as some pixel there.
        let at = |dice: &mut Dice| (y0 + dice.below(y1 - y0)) * view.width + x0 + dice.below(x1 - x0);
        let nearest =
            if dice.below(2) == 0 { target.depth[at(dice) as usize] } else { 1.0 / dice.between(0.1, 30.0) };
        let under = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y * view.width + x) as usize));
        let covered: Vec<usize> = under.filter(|&at| target.item[at] != Target::NONE).collect();
        let truth = covered.iter().all(|&at| nearest < target.depth[at]);
        let (mut before, mut heard) = (tiles.clone(), Heard::default());
        assert_eq!(tiles.is_behind(pixels, nearest, Isa::best(), &mut heard), truth, "{pixels:?}, {nearest}");
        heard.0.iter().for_each(|&cell| before.refresh(cell, Isa::best()));
        assert!(before == tiles, "what changes is heard");
        assert_eq!(heard.1.is_none_or(|r| r.nearest < r.held), truth, "the last read decides: {:?}", heard.1);
        // Zhang 1998: behind, and all covered, is hidden.
        let is_full = covered.len() as u64 == pixels.area();
        let question = Question { pixels, nearest, boxes: None, exact: true };
        assert_eq!(tiles.hides(question, Isa::best(), &mut Heard::default()), truth && is_full, "{pixels:?}");
        found[0] += usize::from(truth && is_full);
        found[1] += usize::from(truth && !is_full && !covered.is_empty());
        found[2] += usize::from(!truth);
    }
    found
}

#[test]
fn behind_is_behind_all_that_covers_a_pixel() {
    let (mut dice, mut all) = (Dice::new(92), [0; 3]);
    for round in 0..ROUNDS {
        let scene = mixed(&mut dice, 5 + round as usize * 7 % 200);
        let (width, height) = sizes(round);
        let mut view = random_view(&mut dice, width, height);
        view.eye.far = 1e4;
        let found = ask(&scene, &view, &mut dice, round);
        all.iter_mut().zip(found).for_each(|(sum, n)| *sum += n);
        let scene = flat_mixed(&mut dice, 20, 1.0);
        let mut view = flat_view(&mut dice, flat_size(round).0, 1.0);
        view.eye.far = 1e7;
        let found = ask(&scene, &view, &mut dice, round);
        all.iter_mut().zip(found).for_each(|(sum, n)| *sum += n);
    }
    assert!(all.iter().all(|&n| n > 500), "hidden, behind but not covered, not behind: {all:?}");
}

/// Zhang et al. 1997, Section 4.1: the triangle (0,0) (8,0) (0,8) covers 28 of 64 pixel centers, the other
/// half of the square 36, and both all of them: no crack, and no sample twice.
#[test]
fn two_triangles_of_a_square_cover_28_and_36_of_64_samples() {
    let place = |x: f32, y: f32| Vec3::new(x - 4.0, 4.0 - y, -4.0);
    let [a, b, c, d] = [place(0.0, 0.0), place(8.0, 0.0), place(8.0, 8.0), place(0.0, 8.0)];
    let covered = |triangles: &[[Vec3; 3]]| {
        let (scene, view) = (soup(triangles), straight_view(8, 1.0, 100.0));
        let mut maps = Opacity::default();
        maps.clear([8, 8], 3, false);
        maps.build(&drawn(&scene, &view, BOTH_SIDES, Isa::best()));
        let all = PyramidCell::default();
        (64 - maps.black(all), maps.opacity(all))
    };
    assert_eq!(covered(&[[a, d, b]]), (28, 0.4375));
    assert_eq!(covered(&[[b, d, c]]), (36, 0.5625));
    assert_eq!(covered(&[[a, d, b], [b, d, c]]), (64, 1.0));
}

#[test]
fn levels_of_a_wide_image() {
    let mut maps = Opacity::default();
    maps.clear([1920, 1080], 3, false);
    let sizes: Vec<[u32; 2]> = (0..maps.levels()).map(|l| maps.size(l)).collect();
    assert_eq!(sizes, [[240, 135], [120, 68], [60, 34], [30, 17], [15, 9], [8, 5], [4, 3]]);
    // Nothing is covered yet, and nothing counts that lies beyond the image.
    let last = PyramidCell { level: 1, x: 0, y: 67 };
    assert_eq!((maps.black(last), maps.present(last)), (16 * 8, 16 * 8));
    // The last row has one row below it: covered, its opacity is 1.
    maps.build_from_depths(&vec![1.0; 1920 * 1080], 0.5);
    assert_eq!((maps.opacity(last), maps.black(PyramidCell { level: 6, x: 3, y: 2 })), (1.0, 0));
}

/// Black samples in holes of at most `most`, by filling one hole after the other; samples that touch at a
/// corner are of one.
fn flooded([width, height]: [u32; 2], most: usize, black: &[bool]) -> Vec<bool> {
    let (mut filled, mut seen) = (vec![false; black.len()], vec![false; black.len()]);
    for first in 0..black.len() {
        let (mut hole, mut next) = (vec![first], 0);
        if !black[first] || std::mem::replace(&mut seen[first], true) {
            continue;
        }
        while let Some(&at) = hole.get(next) {
            next += 1;
            let (x, y) = (at as u32 % width, at as u32 / width);
            for v in y.saturating_sub(1)..(y + 2).min(height) {
                for u in x.saturating_sub(1)..(x + 2).min(width) {
                    let beside = (v * width + u) as usize;
                    if black[beside] && !std::mem::replace(&mut seen[beside], true) {
                        hole.push(beside);
                    }
                }
            }
        }
        if hole.len() <= most {
            hole.into_iter().for_each(|at| filled[at] = true);
        }
    }
    filled
}

#[test]
fn closing_fills_the_holes_that_a_flood_finds() {
    let (mut dice, mut some) = (Dice::new(97), [0, 0]);
    for round in 0..400 {
        let is_flat = round % 5 == 0;
        let (width, height) = (1 + dice.below(90), if is_flat { 1 } else { 1 + dice.below(70) });
        // From a few samples to nearly all.
        let share = dice.unit();
        let black: Vec<bool> = (0..width * height).map(|_| dice.unit() * dice.unit() > share).collect();
        let depths: Vec<f32> = black.iter().map(|b| if *b { 0.0 } else { 1.0 }).collect();
        let most = [1, 2, 5, 25, 1000][round as usize % 5];
        let filled = flooded([width, height], most, &black);
        let mut maps = Opacity::default();
        maps.clear([width, height], dice.below(4), is_flat);
        maps.fill_holes(most as u32);
        maps.build_from_depths(&depths, 0.5);
        for cell in (0..maps.levels()).flat_map(|level| maps.cells(level)) {
            let side = 1 << maps.shift(cell.level);
            let (x, y) = (u32::from(cell.x) * side, u32::from(cell.y) * side);
            let rows = y..(y + side).min(height);
            let all = rows.flat_map(|y| (x..(x + side).min(width)).map(move |x| (y * width + x) as usize));
            let (mut left, mut gone) = (0, 0);
            all.for_each(|at| {
                left += u32::from(black[at] && !filled[at]);
                gone += u32::from(filled[at]);
            });
            assert_eq!((maps.black(cell), maps.filled(cell)), (left, gone), "{cell:?}, round {round}");
            some = [some[0] + left, some[1] + gone];
        }
    }
    assert!(some.iter().all(|n| *n > 10_000), "{some:?}");
}

/// A slit askew, one sample wide, is one hole, as long as it is.
#[test]
fn a_slit_askew_is_one_hole() {
    let black = |most: u32, is_black: fn(u32, u32) -> bool| {
        let depths: Vec<f32> =
            (0..64 * 64).map(|k| if is_black(k % 64, k / 64) { 0.0 } else { 1.0 }).collect();
        let mut maps = Opacity::default();
        maps.clear([64, 64], 2, false);
        maps.fill_holes(most);
        maps.build_from_depths(&depths, 0.5);
        maps.cells(0).map(|c| maps.black(c)).sum::<u32>()
    };
    assert_eq!([63, 64].map(|most| black(most, |x, y| x == y)), [64, 0]);
    assert_eq!([63, 64].map(|most| black(most, |x, _| x == 9)), [64, 0]);
    // A hole on a corner of four map pixels is no smaller for that.
    let hole = |x: u32, y: u32| (29..35).contains(&x) && (29..35).contains(&y);
    assert_eq!([35, 36].map(|most| black(most, hole)), [36, 0]);
    assert_eq!(black(0, |_, _| true), 64 * 64);
}
