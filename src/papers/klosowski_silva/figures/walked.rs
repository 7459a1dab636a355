//! Figure 7: the traversal at four moments, read from its film; and the front at any moment, for other
//! figures.

use std::sync::Arc;

use glam::{Vec2, vec2};

use super::notes::Moment;
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject, metrics};
use crate::figure::tools::{Maker, Plan, TWO_COLUMNS_PT, entry, eye};
use crate::figure::{Panel, Paper, Swatch, panels};
use crate::geometry::{Aabb, Flat, NodeId};
use crate::method::{Film, Verdict};
use crate::papers::keys::LAYERED_PROJECTION;
use crate::scene::{SceneError, example};
use crate::trace::{Stamps, State};

/// The corners of a cell of flatland, around it.
pub fn corners(film: &dyn Film<Flat>, cell: NodeId) -> Vec<Vec2> {
    let bounds = film.hierarchy().bounds(cell);
    let edges = film.hierarchy().edges(cell);
    edges.map_or_else(
        || [0, 1, 3, 2].map(|i| bounds.corner(i)).to_vec(),
        |edges| edges.iter().map(|e| e[0]).collect(),
    )
}

/// The center of the circle in a triangle, or the middle of another polygon.
fn middle(points: &[Vec2]) -> Vec2 {
    let weight =
        |i: usize| if points.len() == 3 { (points[(i + 1) % 3] - points[(i + 2) % 3]).length() } else { 1.0 };
    let sum: f32 = (0..points.len()).map(weight).sum();
    (0..points.len()).map(|i| points[i] * weight(i)).sum::<Vec2>() / sum.max(f32::MIN_POSITIVE)
}

/// Whether a box of half size `half` lies in a convex polygon.
fn holds(points: &[Vec2], at: Vec2, half: Vec2) -> bool {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|c| at + Vec2::from(c) * half);
    let side = |i: usize, p: Vec2| (points[(i + 1) % points.len()] - points[i]).perp_dot(p - points[i]);
    let all = |sign: f32| corners.iter().all(|&p| (0..points.len()).all(|i| side(i, p) * sign >= 0.0));
    all(1.0) || all(-1.0)
}

/// Size of the numbers in cells.
const NUMBER_PT: f32 = 5.5;
/// Width of a panel.
const PANEL_PT: f32 = (TWO_COLUMNS_PT - 10.0) / 2.0;
/// A cell of the front is shaded once for every quarter of solidity, so often at most.
const SHADES: usize = 6;
const A_SHADE: f32 = 0.25;
/// Cells that are projected in the four panels.
const MOMENTS: [usize; 4] = [1, 10, 26, 46];

/// The run of the figure.
fn run(maker: &Maker<'_>) -> Result<Arc<dyn Film<Flat>>, SceneError> {
    let scene = example("bottleneck")?;
    let pairs = [
        ("tessellation", "delaunay"),
        ("leaf-size", "13"),
        ("budget", "70"),
        ("rules", "paper"),
        // As in the paper's figure, which has no star-shape test.
        ("penalty", "0"),
        ("seed", "1"),
    ];
    Ok(maker.film(&scene, &eye(&scene, 0), LAYERED_PROJECTION, &pairs))
}

/// Shades an area by its solidity.
fn shade(solidity: f32) -> usize {
    ((solidity / A_SHADE) as usize).min(SHADES)
}

fn moment(film: &dyn Film<Flat>, letter: char, cells: usize) -> Panel {
    let (moment, scene) = (Moment::after(film, cells), film.scene());
    let at = film.view().eye.position;
    let frame = Aabb { min: scene.bounds().min.min(at), max: scene.bounds().max };
    let air = Vec2::splat(0.6);
    let mut plan = Plan::new(Aabb { min: frame.min - air, max: frame.max + air }, PANEL_PT);
    let stamps = Stamps::new(film);
    for id in (1..film.hierarchy().node_count() as u32).map(NodeId) {
        plan.world.outline(Layer::Ground, Role::Faint, Subject::Node(id), corners(film, id));
    }
    let area = |plan: &mut Plan, role: Role, id: NodeId| {
        plan.world.push(Layer::Areas, role, Subject::Node(id), Mark::Area(corners(film, id)));
    };
    // By id, so that a cell is drawn at the same place among the others in all four panels.
    let mut front = moment.front.clone();
    front.sort_unstable_by_key(|(id, _)| *id);
    for &(id, solidity) in &front {
        area(&mut plan, Role::Undecided, id);
        (0..shade(solidity)).for_each(|_| area(&mut plan, Role::Scene, id));
    }
    moment.projected.iter().for_each(|&id| area(&mut plan, Role::Visible, id));
    for &prim in scene.live() {
        let drawn = stamps.prim(prim, moment.step) == State::Decided(Verdict::Visible);
        let role = if drawn { Role::Ink } else { Role::Scene };
        plan.world.line(Layer::Scene, role, Subject::Prim(prim), scene.prim_points(prim).collect::<Vec<_>>());
    }
    sides_of_view(film, &mut plan);
    if let Some(&last) = moment.projected.last() {
        plan.world.outline(Layer::Emphasis, Role::Current, Subject::Node(last), corners(film, last));
    }
    let ranks = moment.projected.iter().enumerate().map(|(i, &id)| (id, (i + 1).to_string(), Font::Bold));
    let solidities = front.iter().map(|&(id, s)| (id, format!("{s:.2}"), Font::Regular));
    for (id, text, font) in ranks.chain(solidities) {
        write(&mut plan, &corners(film, id), &text, font);
    }
    plan.dot(Role::Eye, at, 3.5);
    let label = format!(
        "({letter}) {cells} cell{} projected; {} of 70 segments left",
        if cells == 1 { "" } else { "s" },
        moment.left
    );
    plan.panel(label)
}

/// Writes a number into a cell that has room for it.
fn write(plan: &mut Plan, cell: &[Vec2], text: &str, font: Font) {
    let half = vec2(metrics::width_pt(text, font, NUMBER_PT) * 0.5 + 0.3, NUMBER_PT * 0.4) * plan.unit;
    let at = middle(cell);
    if holds(cell, at, half) {
        plan.label(at, NUMBER_PT, font, text);
    }
}

/// The two sides of the view.
fn sides_of_view(film: &dyn Film<Flat>, plan: &mut Plan) {
    let eye = &film.view().eye;
    for side in [-0.5, 0.5] {
        let end =
            eye.position + Vec2::from_angle(eye.fov * side).rotate(eye.forward()) * plan.frame.diagonal();
        plan.world.line(Layer::Frustum, Role::Eye, Subject::Eye, [eye.position, end]);
    }
}

/// What the shades mean, as a strip below the panels.
fn strip(to: &mut Drawing) {
    const WIDE: f32 = 30.0;
    const HIGH: f32 = 10.0;
    let top = to.size_pt.y + 6.0;
    to.text(
        Layer::Labels,
        Role::Ink,
        vec2(0.0, top + 8.0),
        8.0,
        Anchor::Start,
        "solidity of a cell of the front, at least:",
    );
    for level in 0..=SHADES {
        let min = vec2(160.0 + WIDE * level as f32, top);
        let corners = [min, min + vec2(WIDE, 0.0), min + vec2(WIDE, HIGH), min + vec2(0.0, HIGH)];
        for role in std::iter::once(Role::Undecided).chain(std::iter::repeat_n(Role::Scene, level)) {
            to.push(Layer::Areas, role, Subject::None, Mark::Area(corners.to_vec()));
        }
        let text = format!("{:.2}", level as f32 * A_SHADE);
        to.text(Layer::Labels, Role::Ink, min + vec2(WIDE * 0.5, 7.5), 7.0, Anchor::Middle, text);
    }
    to.size_pt.y = top + HIGH + 2.0;
}

/// Figure 7.
pub fn moments(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = run(maker)?;
    let all: Vec<Panel> =
        MOMENTS.into_iter().zip('a'..).map(|(cells, letter)| moment(&*film, letter, cells)).collect();
    let mut content = panels(TWO_COLUMNS_PT, 2, &all);
    strip(&mut content);
    let legend = vec![
        entry(Role::Visible, Swatch::Area, "projected, in this order"),
        entry(Role::Current, Swatch::Line, "projected last"),
        entry(Role::Undecided, Swatch::Area, "in the front, with its solidity"),
        entry(Role::Ink, Swatch::Line, "segment drawn"),
        entry(Role::Scene, Swatch::Line, "segment not drawn"),
        entry(Role::Eye, Swatch::Line, "the Eye and its view"),
    ];
    let caption = "The front grows from the cell of the Eye (a), always over its cell of least solidity (b). \
                   Between two thickets is a bottleneck: cells in and behind the thickets have gathered \
                   solidity and wait (c), while the front goes on through the gap and spreads behind it (d). \
                   So what is seen through the gap is drawn before what lies deep in the thickets. As in \
                   the paper's figure there is no penalty for cells that are not star-shaped. Scene \
                   bottleneck.";
    Ok(maker.page(Paper::TwoColumns, "The traversal, past a bottleneck", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_that_is_projected_was_the_least_of_the_front() {
        let film = run(&Maker::gray()).expect("a scene");
        for cells in 1..30 {
            let (before, after) = (Moment::after(&*film, cells), Moment::after(&*film, cells + 1));
            assert_eq!((before.projected.len(), after.projected.len()), (cells, cells + 1));
            let next = after.projected[cells];
            let (least, solidity) = before.front[0];
            assert!(before.front.iter().all(|(_, other)| solidity <= *other));
            assert_eq!(next, least, "cell {cells}");
            assert!(after.left <= before.left);
        }
    }

    #[test]
    fn the_bottleneck_is_passed_before_the_thickets_are_finished() {
        let film = run(&Maker::gray()).expect("a scene");
        let late = Moment::after(&*film, MOMENTS[3]);
        assert_eq!(late.projected.len(), MOMENTS[3], "the budget lasts");
        // The thickets end at 1.2.
        let top = |id| film.hierarchy().bounds(id).max.y;
        let beyond = late.projected.iter().any(|&id| top(id) > 2.0);
        let waiting = late.front.iter().any(|&(id, solidity)| solidity > 0.2 && top(id) < 1.2);
        assert!(beyond && waiting, "the front is beyond the gap, and cells before it wait");
    }

    #[test]
    fn numbers_lie_in_their_cells() {
        let cell = [vec2(0.0, 0.0), vec2(4.0, 0.0), vec2(0.0, 3.0)];
        assert!((middle(&cell) - vec2(1.0, 1.0)).length() < 1e-6, "the circle in it has radius 1");
        assert!(
            holds(&cell, vec2(1.0, 1.0), vec2(0.7, 0.7)) && !holds(&cell, vec2(1.0, 1.0), vec2(1.5, 0.2))
        );
    }
}
