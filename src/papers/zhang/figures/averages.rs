//! Figure 4: a map of 2N × 2N pixels becomes one of N × N, as a texture that is drawn at half its size.

use glam::{Vec2, vec2};

use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Pixels, Role, Subject, metrics};
use crate::figure::tools::{Maker, entry};
use crate::figure::{Paper, Swatch};
use crate::raster::{Opacity, PyramidCell};
use crate::scene::SceneError;

/// Side of a map pixel on paper.
const CELL_PT: f32 = 34.0;
/// Where the levels stand, from the left, and the top of the first.
const LEFT_PT: [f32; 3] = [0.0, 224.0, 380.0];
const TOP_PT: f32 = 20.0;
const NUMBER_PT: f32 = 8.0;

/// Which of its four samples are covered, of each pixel of a map of 4 × 4, row by row from the top.
const COVERED: [[u8; 4]; 4] = [[4, 4, 4, 0], [4, 4, 4, 4], [0, 0, 4, 4], [4, 4, 4, 2]];

/// Maps whose upper left corner is that map; the rest is covered.
fn maps() -> Opacity {
    let side = 32;
    let covered = |x: usize, y: usize| match COVERED.get(y / 2).and_then(|row| row.get(x / 2)) {
        // Half a pixel: its upper row.
        Some(2) => y.is_multiple_of(2),
        Some(count) => *count > 0,
        None => true,
    };
    let at = |i: usize| f32::from(u8::from(covered(i % side, i / side)));
    let depths: Vec<f32> = (0..side * side).map(at).collect();
    let mut maps = Opacity::default();
    maps.clear([side as u32; 2], 1, false);
    maps.build_from_depths(&depths, 0.0);
    maps
}

/// The opacity of a pixel of a level.
fn opacity(maps: &Opacity, level: u8, [x, y]: [usize; 2]) -> f64 {
    maps.opacity(PyramidCell { level, x: x as u16, y: y as u16 })
}

/// A level's corner of this map: pixels a side.
fn side(level: u8) -> usize {
    4 >> level
}

fn corner(level: u8) -> Vec2 {
    // In the middle of the height of the first.
    vec2(LEFT_PT[usize::from(level)], TOP_PT + (side(0) - side(level)) as f32 * CELL_PT * 0.5)
}

/// Text on paper, about its middle.
fn plate(to: &mut Drawing, middle: Vec2, text: String) {
    let half = vec2(metrics::width_pt(&text, Font::Regular, NUMBER_PT) * 0.5 + 1.5, NUMBER_PT * 0.6);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| middle + Vec2::from(c) * half);
    to.push(Layer::Evidence, Role::Paper, Subject::None, Mark::Area(corners.to_vec()));
    let at = middle + vec2(0.0, NUMBER_PT * 0.35);
    to.text(Layer::Labels, Role::Ink, at, NUMBER_PT, Anchor::Middle, text);
}

/// A level in gray with its numbers, and where the texture below it is looked up.
fn draw(to: &mut Drawing, maps: &Opacity, level: u8) {
    let (side, at) = (side(level), corner(level));
    let place = |x: f32, y: f32| at + vec2(x, y) * CELL_PT;
    let all: Vec<[usize; 2]> = (0..side * side).map(|i| [i % side, i / side]).collect();
    let gray = |cell: &[usize; 2]| {
        let value = (opacity(maps, level, *cell) * 255.0).round() as u8;
        [value, value, value, 255]
    };
    let rgba: Vec<u8> = all.iter().flat_map(gray).collect();
    let pixels = Pixels { width: side as u32, height: side as u32, rgba: rgba.into() };
    let corners = [at, place(side as f32, side as f32)];
    to.push(Layer::Scene, Role::Scene, Subject::None, Mark::Image { corners, pixels });
    for cell in &all {
        let [x, y] = cell.map(|v| v as f32);
        let outline = [place(x, y), place(x + 1.0, y), place(x + 1.0, y + 1.0), place(x, y + 1.0)];
        to.outline(Layer::Nodes, Role::Faint, Subject::None, outline);
        plate(to, place(x + 0.5, y + 0.5), opacity(maps, level, *cell).to_string());
    }
    if level < 2 {
        for i in 0..side * side / 4 {
            let at = place((i % (side / 2) * 2 + 1) as f32, (i / (side / 2) * 2 + 1) as f32);
            to.push(Layer::Emphasis, Role::Current, Subject::None, Mark::Dot { at, radius_pt: 4.0 });
        }
    }
    let names = ["2N × 2N: the texture", "N × N: drawn", "N/2 × N/2"];
    let name = format!("level {level}, {}", names[usize::from(level)]);
    to.text(Layer::Labels, Role::Ink, at - vec2(0.0, 6.0), 8.0, Anchor::Start, name);
}

/// The average of four pixels of a level, in numbers.
fn arithmetic(maps: &Opacity, level: u8, [x, y]: [usize; 2]) -> String {
    let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, k]| opacity(maps, level, [2 * x + i, 2 * y + k]));
    let sum = four.map(|v| v.to_string()).join(" + ");
    format!("({sum}) / 4 = {}", opacity(maps, level + 1, [x, y]))
}

/// Figure 4.
pub fn averages(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let maps = maps();
    let mut to = Drawing::default();
    for level in 0..3 {
        draw(&mut to, &maps, level);
    }
    let middle = TOP_PT + 2.0 * CELL_PT;
    for (level, words) in [(0, "looked up at the dots"), (1, "again")] {
        let from = corner(level).x + side(level) as f32 * CELL_PT + 6.0;
        let ends = [vec2(from, middle), vec2(LEFT_PT[usize::from(level) + 1] - 6.0, middle)];
        to.push(Layer::Evidence, Role::Evidence, Subject::None, Mark::Arrow(ends[0], ends[1]));
        let at = vec2((ends[0].x + ends[1].x) * 0.5, middle - 6.0);
        to.text(Layer::Labels, Role::Ink, at, 7.5, Anchor::Middle, words);
    }
    let mut y = TOP_PT + 4.0 * CELL_PT + 6.0;
    let mut line = |text: String| {
        y += 12.0;
        to.text(Layer::Labels, Role::Ink, vec2(0.0, y), 8.0, Anchor::Start, text);
    };
    for (cell, place) in
        [([0, 0], "upper left"), ([1, 0], "upper right"), ([0, 1], "lower left"), ([1, 1], "lower right")]
    {
        line(format!("level 1, {place}: {}", arithmetic(&maps, 0, cell)));
    }
    line(format!("level 2: {}", arithmetic(&maps, 1, [0, 0])));
    to.size_pt = vec2(LEFT_PT[2] + 90.0, y + 6.0);
    let top = PyramidCell { level: 2, x: 0, y: 0 };
    let caption = format!(
        "A map of 2N × 2N pixels is drawn as a texture on a square of N × N pixels. Each of these is looked \
         up where four pixels of the texture meet, with weights α = β = 1/2: bilinear interpolation is there \
         their average, (1 − α)(1 − β) v₀ + α (1 − β) v₁ + α β v₂ + (1 − α) β v₃. What is drawn is the next \
         texture. Here 2N = 4, and the pixel at the lower right is half covered. Kept are the black samples, \
         4 a pixel of level 0: in the last pixel {} of {} are black, so that its opacity is \
         1 − {}/{} = {}.",
        maps.black(top),
        maps.present(top),
        maps.black(top),
        maps.present(top),
        maps.opacity(top)
    );
    let legend = vec![entry(Role::Current, Swatch::Dot, "where the texture is looked up")];
    let title = "Zhang et al. 1997, Figure 4: averages by texture filtering";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption, &to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_levels_are_the_worked_example() {
        let maps = maps();
        let level = |level: u8| {
            let side = side(level);
            (0..side * side).map(|i| opacity(&maps, level, [i % side, i / side])).collect::<Vec<_>>()
        };
        let finest = [1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5];
        assert_eq!(level(0), finest);
        assert_eq!(level(1), [1.0, 0.75, 0.5, 0.875]);
        assert_eq!(level(2), [25.0 / 32.0]);
        assert_eq!(arithmetic(&maps, 0, [1, 1]), "(1 + 1 + 1 + 0.5) / 4 = 0.875");
    }
}
