//! Several pictures side by side, each with a frame and a label.

use glam::{Vec2, Vec3};

use super::{Face, Sheet, clip, project, solved};
use crate::drawing::{Anchor, Drawing, Font, Item, Layer, Mark, Role, Subject, metrics};
use crate::geometry::{Aabb, Solid, View};

/// One picture.
pub struct Panel {
    /// What it shows, on one short line below it.
    pub label: String,
    /// The picture.
    pub picture: Picture,
}

/// What a panel holds.
pub enum Picture {
    /// A flatland drawing in world coordinates, fitted to these bounds.
    Flat(Drawing<Vec2>, Aabb<Vec2>),
    /// A drawing of space, as seen by this observer; the view's size gives its proportions.
    Space(Drawing<Vec3>, View<Solid>),
    /// Pixels.
    Pixels(crate::drawing::Pixels),
    /// A drawing of space over an image that this observer sees too.
    Over(crate::drawing::Pixels, Drawing<Vec3>, View<Solid>),
    /// A drawing of space over surfaces that hide each other, as this observer sees them.
    Solved(Vec<Face>, Drawing<Vec3>, View<Solid>),
}

impl Picture {
    /// Height over width.
    fn proportion(&self) -> f32 {
        match self {
            Self::Flat(_, bounds) => bounds.size().y / bounds.size().x.max(1e-6),
            Self::Space(_, view) | Self::Over(_, _, view) | Self::Solved(_, _, view) => {
                view.height as f32 / view.width as f32
            }
            Self::Pixels(p) => p.height as f32 / p.width as f32,
        }
    }
    fn draw(&self, min: Vec2, max: Vec2) -> Drawing {
        let mut paper = Drawing::default();
        let image =
            |pixels: &crate::drawing::Pixels| Mark::Image { corners: [min, max], pixels: pixels.clone() };
        match self {
            Self::Flat(world, bounds) => Sheet::fit(bounds, min, max).place(world, &mut paper),
            Self::Space(world, observer) => project(world, observer, min, max, &mut paper),
            Self::Pixels(pixels) => paper.push(Layer::Scene, Role::Scene, Subject::None, image(pixels)),
            Self::Over(pixels, world, observer) => {
                paper.push(Layer::Ground, Role::Scene, Subject::None, image(pixels));
                project(world, observer, min, max, &mut paper);
            }
            Self::Solved(faces, world, observer) => {
                paper.items.extend(solved(faces, observer, min, max).unwrap_or_default().items);
                project(world, observer, min, max, &mut paper);
            }
        }
        clip(&mut paper, min, max);
        plate_labels(&mut paper, min, max);
        paper
    }
}

/// Space between panels, and between a panel and its label.
const GAP_PT: f32 = 10.0;
/// Size and line of labels.
const LABEL_PT: f32 = 8.0;

/// Panels in rows of `columns`, `width_pt` wide in all; every panel has the height of the tallest.
pub fn panels(width_pt: f32, columns: usize, panels: &[Panel]) -> Drawing {
    let columns = columns.clamp(1, panels.len().max(1));
    let cell_width = (width_pt - GAP_PT * (columns - 1) as f32) / columns as f32;
    let cell_height =
        panels.iter().map(|p| p.picture.proportion().clamp(0.02, 1.6) * cell_width).fold(0.0, f32::max);
    let row_height = cell_height + LABEL_PT * 1.6 + GAP_PT;
    let rows = panels.len().div_ceil(columns);
    let mut paper = Drawing {
        size_pt: Vec2::new(width_pt, rows as f32 * row_height - GAP_PT + LABEL_PT * 0.4),
        ..Drawing::default()
    };
    for (i, panel) in panels.iter().enumerate() {
        let (column, row) = ((i % columns) as f32, (i / columns) as f32);
        let min = Vec2::new(column * (cell_width + GAP_PT), row * row_height);
        let max = min + Vec2::new(cell_width, cell_height);
        // A frame in its own proportions, in the middle of its cell.
        let height = (panel.picture.proportion() * cell_width).min(cell_height);
        let inner = [Vec2::new(min.x, max.y - height), max];
        let frame =
            [inner[0], Vec2::new(inner[1].x, inner[0].y), inner[1], Vec2::new(inner[0].x, inner[1].y)];
        paper.items.extend(panel.picture.draw(inner[0], inner[1]).items);
        paper.outline(Layer::Labels, Role::Faint, Subject::None, frame);
        let text = panel.label.clone();
        let at = Vec2::new((min.x + max.x) * 0.5, max.y + LABEL_PT * 1.4);
        let mark = Mark::Text { at, text, size_pt: LABEL_PT, anchor: Anchor::Middle, font: Font::Regular };
        paper.push(Layer::Labels, Role::Ink, Subject::None, mark);
    }
    paper
}

/// Distance of the pictures of a [`grid`], points.
pub const GRID_GAP_PT: f32 = 8.0;

/// Finished pictures in rows of `columns`, each in the middle of its cell, the lower ends of a row in line;
/// `width_pt` wide in all.
pub fn grid(width_pt: f32, columns: usize, cells: Vec<Drawing>) -> Drawing {
    let columns = columns.clamp(1, cells.len().max(1));
    let cell = grid_cell_pt(width_pt, columns);
    let mut paper = Drawing { size_pt: Vec2::new(width_pt, -GRID_GAP_PT), ..Drawing::default() };
    let mut cells = cells.into_iter().peekable();
    while cells.peek().is_some() {
        let row: Vec<Drawing> = cells.by_ref().take(columns).collect();
        let height = row.iter().map(|drawing| drawing.size_pt.y).fold(0.0, f32::max);
        for (column, drawing) in row.into_iter().enumerate() {
            let left = column as f32 * (cell + GRID_GAP_PT) + (cell - drawing.size_pt.x) * 0.5;
            let by = Vec2::new(left, paper.size_pt.y + GRID_GAP_PT + height - drawing.size_pt.y);
            let moved = drawing.items.into_iter();
            paper.items.extend(moved.map(|item| Item { mark: item.mark.mapped(|p| p + by), ..item }));
        }
        paper.size_pt.y += GRID_GAP_PT + height;
    }
    paper
}

/// Width of a cell of a [`grid`].
pub fn grid_cell_pt(width_pt: f32, columns: usize) -> f32 {
    (width_pt - GRID_GAP_PT * (columns - 1) as f32) / columns as f32
}

/// A picture with a label on one line below it.
pub fn labelled(mut picture: Drawing, label: &str) -> Drawing {
    let size = picture.size_pt;
    let text = metrics::elide(label, Font::Regular, LABEL_PT, size.x);
    let at = Vec2::new(size.x * 0.5, size.y + LABEL_PT * 1.4);
    let mark = Mark::Text { at, text, size_pt: LABEL_PT, anchor: Anchor::Middle, font: Font::Regular };
    picture.push(Layer::Labels, Role::Ink, Subject::None, mark);
    picture.size_pt.y += LABEL_PT * 2.0;
    picture
}

/// A place for a label below those that it would lie over, or above them where there is no room.
fn apart(at: Vec2, place: impl Fn(Vec2) -> [Vec2; 2], plates: &[[Vec2; 2]], bottom: f32) -> Vec2 {
    let meets = |at: Vec2| {
        let [low, high] = place(at);
        let is_over = |p: &&[Vec2; 2]| low.cmplt(p[1]).all() && p[0].cmplt(high).all();
        plates.iter().find(is_over).copied()
    };
    let [top, end] = place(at).map(|corner| corner.y - at.y);
    for is_down in [true, false] {
        let mut moved = at;
        // Each move passes one of them.
        for _ in 0..=plates.len() {
            match meets(moved) {
                None if is_down && moved.y + end > bottom => break,
                None => return moved,
                Some([_, below]) if is_down => moved.y = below.y - top,
                Some([above, _]) => moved.y = above.y - end,
            }
        }
    }
    at
}

/// Moves the labels of evidence into the rectangle from `min_pt` to `max_pt`, below each other where they
/// would lie over each other, and puts a piece of paper under each, so that they are read over any picture.
pub fn plate_labels(drawing: &mut Drawing, min_pt: Vec2, max_pt: Vec2) {
    let items = std::mem::take(&mut drawing.items);
    let mut plates: Vec<[Vec2; 2]> = Vec::new();
    for mut item in items {
        if let Mark::Text { at, text, size_pt, anchor, font } = &mut item.mark
            && item.layer == Layer::Labels
            && item.role == Role::Evidence
        {
            let width = metrics::width_pt(text, *font, *size_pt);
            let start = metrics::start_pt(at.x, text, *font, *size_pt, *anchor) + *size_pt * 0.6;
            let air = *size_pt * 0.2;
            *anchor = Anchor::Start;
            at.x = start.min(max_pt.x - width - air).max(min_pt.x + air);
            at.y = (at.y - *size_pt * 0.5)
                .clamp(min_pt.y + *size_pt + air, (max_pt.y - air * 2.0).max(min_pt.y + *size_pt + air));
            let place = |at: Vec2| {
                [at + Vec2::new(-air, -*size_pt * 0.95), at + Vec2::new(width + air, *size_pt * 0.3)]
            };
            *at = apart(*at, place, &plates, max_pt.y);
            let [low, high] = place(*at);
            plates.push([low, high]);
            let plate = vec![low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)];
            drawing.push(Layer::Labels, Role::Paper, Subject::None, Mark::Area(plate));
        }
        drawing.items.push(item);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_lie_over_each_other() {
        for y in [20.0, 95.0] {
            let mut drawing = Drawing { size_pt: Vec2::new(200.0, 100.0), ..Drawing::default() };
            for (x, text) in [(50.0, "nearest 10.34"), (60.0, "drawn to 15.00"), (55.0, "right: 17.68 in")] {
                drawing.text(Layer::Labels, Role::Evidence, Vec2::new(x, y), 8.0, Anchor::Start, text);
            }
            plate_labels(&mut drawing, Vec2::ZERO, Vec2::new(200.0, 100.0));
            let plates: Vec<[Vec2; 2]> = drawing
                .items
                .iter()
                .filter_map(|i| if let Mark::Area(p) = &i.mark { Some([p[0], p[2]]) } else { None })
                .collect();
            assert_eq!(plates.len(), 3);
            for (i, [low, high]) in plates.iter().enumerate() {
                assert!(low.y >= 0.0 && high.y <= 100.0, "{low} {high}");
                for [a, b] in &plates[..i] {
                    assert!(!(low.cmplt(*b).all() && a.cmplt(*high).all()), "{low} {high} over {a} {b}");
                }
            }
        }
    }
}
