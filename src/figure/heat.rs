//! A map of heat: a value for each cell of a floor plan, as dots that grow with it, over the plan.
//!
//! Dots and not shades, so that the map is read in print and without color too: the area of a dot grows with
//! the value, and the largest fills its cell.

use glam::Vec2;

use crate::drawing::words::grouped;
use crate::drawing::{Anchor, Drawing, Layer, Mark, Role, Subject};

/// Width of the map on paper.
const WIDTH_PT: f32 = 340.0;
/// Greatest height of the plan on paper: a long and narrow plan is drawn narrower.
const MOST_PT: f32 = 420.0;
const EDGE_PT: f32 = 14.0;
const TEXT_PT: f32 = 9.0;

/// What is shown.
pub struct Heat<'a> {
    /// One line.
    pub title: String,
    /// What a value is, with its unit, such as `pixels popped`.
    pub what: &'static str,
    /// Columns and rows of the grid.
    pub cells: [usize; 2],
    /// Value of each cell, the row of the least y first.
    pub values: &'a [f64],
    /// Number of each cell, which its dot is about.
    pub numbers: &'a [usize],
    /// Corners of the grid in the plan, y upward: least, greatest.
    pub bounds: [Vec2; 2],
    /// Lines of the plan.
    pub plan: &'a [[Vec2; 2]],
}

/// Draws it, in paper coordinates with its size.
pub fn heat_map(heat: &Heat<'_>) -> Drawing {
    let [low, high] = heat.bounds;
    let size = (high - low).max(Vec2::splat(f32::MIN_POSITIVE));
    let scale = ((WIDTH_PT - 2.0 * EDGE_PT) / size.x).min(MOST_PT / size.y);
    let top = EDGE_PT + 2.0 * TEXT_PT;
    let at = |p: Vec2| Vec2::new(EDGE_PT + (p.x - low.x) * scale, top + (high.y - p.y) * scale);
    let most = heat.values.iter().copied().fold(0.0, f64::max);
    let mut to = Drawing { title: heat.title.clone(), ..Drawing::default() };
    to.description = format!("{}: at most {} in a cell.", heat.what, grouped(most, 0));
    to.size_pt = Vec2::new(WIDTH_PT, top + size.y * scale + 3.0 * TEXT_PT);
    to.text(Layer::Labels, Role::Ink, Vec2::new(EDGE_PT, EDGE_PT), TEXT_PT, Anchor::Start, &*heat.title);
    for line in heat.plan {
        to.line(Layer::Scene, Role::Scene, Subject::None, line.map(at));
    }
    to.outline(
        Layer::Scene,
        Role::Faint,
        Subject::None,
        [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)].map(at),
    );
    let [columns, rows] = heat.cells;
    let cell = size / Vec2::new(columns.max(1) as f32, rows.max(1) as f32);
    let full = 0.48 * cell.min_element() * scale;
    for (k, value) in heat.values.iter().enumerate().filter(|(_, value)| **value > 0.0) {
        let place = Vec2::new((k % columns) as f32 + 0.5, (k / columns) as f32 + 0.5);
        let radius_pt = (full * (value / most).sqrt() as f32).max(0.4);
        let dot = Mark::Dot { at: at(low + place * cell), radius_pt };
        let subject = Subject::Tried(heat.numbers.get(k).map_or(k, |n| *n) as u32);
        to.push(Layer::Emphasis, Role::Hidden, subject, dot);
    }
    let foot = Vec2::new(EDGE_PT, top + size.y * scale + 1.6 * TEXT_PT);
    to.text(Layer::Caption, Role::Faint, foot, TEXT_PT, Anchor::Start, &*to.description.clone());
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_a_dot_grows_with_the_value() {
        let heat = Heat {
            title: "t".into(),
            what: "pixels",
            cells: [2, 2],
            values: &[0.0, 1.0, 4.0, 0.0],
            numbers: &[2, 3, 0, 1],
            bounds: [Vec2::ZERO, Vec2::ONE],
            plan: &[[Vec2::ZERO, Vec2::ONE]],
        };
        let map = heat_map(&heat);
        let dots: Vec<(Vec2, f32)> = map
            .items
            .iter()
            .filter_map(|item| match item.mark {
                Mark::Dot { at, radius_pt } => Some((at, radius_pt)),
                _ => None,
            })
            .collect();
        let about: Vec<Subject> =
            map.items.iter().map(|i| i.subject).filter(|s| *s != Subject::None).collect();
        assert_eq!(about, [Subject::Tried(3), Subject::Tried(0)]);
        // The second cell lies right of the first, the third above it.
        assert_eq!(dots.len(), 2);
        assert!(dots[0].0.x > dots[1].0.x && dots[0].0.y > dots[1].0.y, "{dots:?}");
        assert!((dots[1].1 - 2.0 * dots[0].1).abs() < 1e-3, "{dots:?}");
        assert!(map.items.iter().all(|item| match &item.mark {
            Mark::Line { points, .. } =>
                points.iter().all(|p| p.cmpge(Vec2::ZERO).all() && p.cmple(map.size_pt).all()),
            _ => true,
        }));
    }
}
