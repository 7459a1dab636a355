//! A cell and its color cube seen from all around (Section 3.2): the Venetian blind.
//!
//! A cube knows six directions. Between them it shows its faces, each as large as it is seen, with weights
//! `|n · v|` that sum to 1. What it stands for may cover more or less. "True" is here what cells of the same
//! contents, side by side in a wall that is one cell thick, hide of what is behind them: a surface or a row
//! of slats goes on in the neighboring cell. Slats as deep as they are apart hide `min(1, tan φ)` at an angle
//! φ to them; their cube, clear along them and opaque across, covers `sin φ / (sin φ + cos φ)`.
//!
//! A wall of such cubes is a third thing: a ray that goes through the front face of one leaves it through a
//! side, and enters the next, in a share `tan` of the angle to the front of all cases.

use glam::{Vec2, vec2};

use super::evidence::FACE_NAMES;
use super::faces::held;
use super::sketch::{At, cell_of, say};
use super::space::{Projected, Window};
use crate::culling::depth::picture::finished;
use crate::drawing::{Anchor, Drawing, Layer, Mark, Role, Subject};
use crate::geometry::{Aabb, NodeId, PrimId, Vector};
use crate::raster::{CubeFaces, VEIL};
use crate::scene::{Scene, Surfaces};

/// A direction in the plane of two axes.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// The axes: at 0° one looks from the upper end of the first, at 90° of the second.
    pub axes: [usize; 2],
    pub degrees: f64,
}

impl Turn {
    /// Direction toward the eye, along the two axes.
    fn components(&self) -> [f64; 2] {
        let (sine, cosine) = self.degrees.to_radians().sin_cos();
        [cosine, sine]
    }
    /// The faces that are seen, the first axis' first, and their weights: `|n · v|`, of a sum of 1.
    pub fn faces(&self) -> [(usize, f64); 2] {
        let seen = self.components();
        let sum = seen[0].abs() + seen[1].abs();
        std::array::from_fn(|k| (2 * self.axes[k] + usize::from(seen[k] > 0.0), seen[k].abs() / sum))
    }
    /// What a cube covers.
    pub fn cube(&self, faces: &CubeFaces) -> f64 {
        self.faces().iter().map(|(face, weight)| weight * f64::from(faces.get(*face)[3])).sum()
    }
    /// What a wall of such cubes covers.
    pub fn wall(&self, faces: &CubeFaces) -> f64 {
        let [mut front, mut side] = self.faces();
        if side.1 > front.1 {
            std::mem::swap(&mut front, &mut side);
        }
        let [over, under] = [front, side].map(|(face, _)| f64::from(faces.get(face)[3]));
        over + (1.0 - over) * under * side.1 / front.1
    }
}

/// What is in a cell.
#[derive(Clone, Copy)]
pub struct Contents<'a, S: Projected> {
    pub scene: &'a Scene<S>,
    pub surfaces: Surfaces,
    pub cell: Aabb<S::Vector>,
    pub prims: &'a [PrimId],
}

impl<S: Projected> Contents<'_, S> {
    /// The share of parallel rays, `side` of them along a side of the front face, that a wall of such cells
    /// stops.
    pub fn stopped(&self, turn: &Turn, side: u32) -> f64 {
        let seen = turn.components();
        // Through the face that is seen the best: there rays move by no more than they go in.
        let front = usize::from(seen[1].abs() > seen[0].abs());
        let (axis, across, is_upper) = (turn.axes[front], turn.axes[1 - front], seen[front] > 0.0);
        let slope = seen[1 - front] / seen[front].abs();
        let toward = S::Vector::from_fn(|a| match a {
            _ if a == axis => (seen[front].signum()) as f32,
            _ if a == across => slope as f32,
            _ => 0.0,
        });
        let (window, extent) = (Window::new(&self.cell, side), f64::from(side));
        let depth_of = |height: f64| if is_upper { extent - height } else { height };
        let mut left = vec![1.0f32; S::sample_count(side)];
        for &prim in self.prims {
            let is_seen = !self.surfaces.one_sided || self.scene.is_two_sided(prim);
            if !is_seen && self.scene.normal(prim).dot(toward) <= 0.0 {
                continue;
            }
            let through = if self.surfaces.show_through(self.scene, prim) { 1.0 - VEIL } else { 0.0 };
            let corners = window.corners(self.scene, prim);
            // The cell itself, and its neighbors on both sides.
            for copy in [-1.0, 0.0, 1.0] {
                let moved = corners.map(|p| {
                    let shift = slope * depth_of(p[axis]) + copy * extent;
                    std::array::from_fn(|a| if a == across { p[a] + shift } else { p[a] })
                });
                S::cover(&moved, axis, side, |at, height| {
                    let column = if (axis + 1) % S::Vector::AXES == across {
                        at as u32 % side
                    } else {
                        at as u32 / side
                    };
                    let place = f64::from(column) + 0.5;
                    // Where it is in its own cell; what is outside of that belongs to another one.
                    let own = place - slope * depth_of(height) - copy * extent;
                    if (0.0..extent).contains(&own) {
                        left[at] *= through;
                    }
                });
            }
        }
        1.0 - left.iter().map(|l| f64::from(*l)).sum::<f64>() / left.len() as f64
    }
}

/// Rays along a side of a face, in flatland and in space.
const RAYS: [u32; 2] = [256, 24];
/// Primitives up to which directions are so many degrees apart; of more the truth is not looked for, which
/// would take longer than a person waits.
const FINE: (usize, usize) = (1_000, 5);
const COARSE: (usize, usize) = (10_000, 15);

/// How much of what is behind the cell at hand is covered, from all around.
pub fn by_direction<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let mut to = Drawing::default();
    let Some(id) = cell_of(moment) else {
        say(&mut to, vec2(0.0, 12.0), "No cell has been looked at yet.");
        return finished(to, 20.0, "No cell yet");
    };
    let (frame, index) = (&moment.frame, moment.frame.index);
    let prims = held(index.tree(), id);
    let (scene, surfaces) = (frame.scene, frame.params.surfaces);
    let contents = Contents { scene, surfaces, cell: index.tree().cell(id), prims: &prims };
    let title = format!("Node {id}: how much of what is behind it is covered, seen from all around");
    say(&mut to, vec2(0.0, 10.0), title.clone());
    let toward = frame.view.eye.position - contents.cell.center();
    let mut y = 26.0;
    for (axes, words) in planes::<S>(frame.view.eye.up) {
        if !words.is_empty() {
            say(&mut to, vec2(0.0, y), words);
            y += 8.0;
        }
        let angle = f64::from(toward.get(axes[1])).atan2(f64::from(toward.get(axes[0]))).to_degrees();
        let at_hand = Turn { axes, degrees: angle.rem_euclid(360.0) };
        y = chart(&mut to, y, &contents, index.faces(id), at_hand) + 14.0;
    }
    explained(&mut to, &mut y, id);
    finished(to, y, &title)
}

/// The planes in which one turns, with words for them: all around, and in space also over the top.
fn planes<S: Projected>(up: S::Vector) -> Vec<([usize; 2], &'static str)> {
    if S::Vector::AXES == 2 {
        return vec![([0, 1], "")];
    }
    let longest = |a: &usize, b: &usize| up.get(*a).abs().total_cmp(&up.get(*b).abs());
    let vertical = (0..S::Vector::AXES).max_by(longest).unwrap_or(1);
    let [first, second] = [(vertical + 1) % 3, (vertical + 2) % 3].map(|a| a.min(2));
    vec![
        ([first, second], "Turning about the vertical:"),
        ([first, vertical], "Rising over the top and down on the other side:"),
    ]
}

/// Left and right ends of charts, and how high they are.
const LEFT_PT: f32 = 34.0;
const RIGHT_PT: f32 = 470.0;
const HIGH_PT: f32 = 110.0;
const WEIGHTS_PT: f32 = 40.0;

/// A chart over 0 to 360 degrees.
struct Chart {
    top: f32,
    high: f32,
}

impl Chart {
    fn at(&self, degrees: f64, share: f64) -> Vec2 {
        let x = LEFT_PT + (RIGHT_PT - LEFT_PT) * (degrees / 360.0) as f32;
        vec2(x, self.top + self.high * (1.0 - share as f32))
    }
    /// Its frame, with words for the values 0 and 1.
    fn frame(&self, to: &mut Drawing, [low, high]: [&str; 2]) {
        let corners = [(0.0, 0.0), (360.0, 0.0), (360.0, 1.0), (0.0, 1.0)].map(|(d, s)| self.at(d, s));
        to.outline(Layer::Ground, Role::Faint, Subject::None, corners);
        for k in 1..8 {
            let x = f64::from(k) * 45.0;
            to.line(Layer::Ground, Role::Faint, Subject::None, [self.at(x, 0.0), self.at(x, 1.0)]);
        }
        for (share, text) in [(0.0, low), (1.0, high)] {
            let at = self.at(0.0, share) + vec2(-4.0, 3.0);
            to.text(Layer::Labels, Role::Ink, at, 7.5, Anchor::End, text);
        }
    }
    fn curve(&self, to: &mut Drawing, role: Role, of: impl Fn(f64) -> f64) {
        let points: Vec<Vec2> =
            (0..=180).map(|k| f64::from(2 * k)).map(|degrees| self.at(degrees, of(degrees))).collect();
        to.line(Layer::Evidence, role, Subject::None, points);
    }
}

/// Draws the chart of a plane, and the weights of faces below it; where it ends.
fn chart<S: Projected>(
    to: &mut Drawing,
    top: f32,
    contents: &Contents<'_, S>,
    faces: &CubeFaces,
    at_hand: Turn,
) -> f32 {
    let axes = at_hand.axes;
    let turn = |degrees: f64| Turn { axes, degrees };
    let chart = Chart { top, high: HIGH_PT };
    chart.frame(to, ["0", "100 %"]);
    let count = contents.prims.len();
    let step = [FINE, COARSE].iter().find(|(most, _)| count <= *most).map(|(_, step)| *step);
    let rays = RAYS[S::Vector::AXES - 2];
    if let Some(step) = step {
        let truth = |degrees: usize| contents.stopped(&turn(degrees as f64), rays);
        let points = (0..=360).step_by(step).map(|d| chart.at(d as f64, truth(d))).collect::<Vec<_>>();
        to.line(Layer::Evidence, Role::Visible, Subject::None, points);
    } else {
        let text = format!("{count} {}s: too many to find the truth at each step", S::PRIM);
        say(to, chart.at(10.0, 0.9), text);
    }
    chart.curve(to, Role::Approximated, |degrees| turn(degrees).cube(faces));
    chart.curve(to, Role::Evidence, |degrees| turn(degrees).wall(faces));
    let here = [chart.at(at_hand.degrees, 0.0), chart.at(at_hand.degrees, 1.0)];
    to.line(Layer::Emphasis, Role::Eye, Subject::None, here);
    to.push(Layer::Emphasis, Role::Eye, Subject::None, Mark::Dot { at: here[1], radius_pt: 2.5 });

    let weights = Chart { top: top + HIGH_PT + 8.0, high: WEIGHTS_PT };
    weights.frame(to, ["0", "|n·v| 1"]);
    for (which, role) in [(0, Role::Ink), (1, Role::Hidden)] {
        weights.curve(to, role, |degrees| turn(degrees).faces()[which].1);
    }
    let bottom = weights.top + WEIGHTS_PT;
    for quarter in 0..4 {
        // The face that is looked at straight.
        let face = 2 * axes[quarter % 2] + usize::from(quarter < 2);
        let at = weights.at(90.0 * quarter as f64, 0.0) + vec2(0.0, 9.0);
        let text = format!("{}° {}", 90 * quarter, FACE_NAMES[face]);
        to.text(Layer::Labels, Role::Ink, at, 7.5, Anchor::Middle, text);
    }
    let truth = step.map(|_| contents.stopped(&at_hand, rays));
    let text = numbers(&at_hand, faces, truth);
    say(to, vec2(0.0, bottom + 24.0), text);
    bottom + 28.0
}

/// The values from the Eye, in words.
fn numbers(at_hand: &Turn, faces: &CubeFaces, truth: Option<f64>) -> String {
    let [(a, weight_a), (b, weight_b)] = at_hand.faces();
    let [alpha_a, alpha_b] = [a, b].map(|face| faces.get(face)[3]);
    let truth = match truth {
        Some(share) => format!("truly {:.0} %", 100.0 * share),
        None => "the truth is not looked for".into(),
    };
    format!(
        "From the Eye ({:.0}°): {truth}; its cube {:.0} % = {weight_a:.2} × {} {:.0} % + {weight_b:.2} × {} \
         {:.0} %; a wall of such cubes {:.0} %",
        at_hand.degrees,
        100.0 * at_hand.cube(faces),
        FACE_NAMES[a],
        100.0 * alpha_a,
        FACE_NAMES[b],
        100.0 * alpha_b,
        100.0 * at_hand.wall(faces)
    )
}

/// What the lines mean.
fn explained(to: &mut Drawing, y: &mut f32, id: NodeId) {
    let lines = [
        (
            Role::Visible,
            format!("true: what cells like node {id}, side by side, hide of what is behind them"),
        ),
        (Role::Approximated, "its cube alone: its faces, each by the share that is seen of it".to_owned()),
        (Role::Evidence, "a wall of such cubes, drawn over each other".to_owned()),
        (Role::Eye, "where the Eye is".to_owned()),
        (Role::Ink, "below: the share |n·v| of the faces at 0° and 180°".to_owned()),
        (Role::Hidden, "and of those at 90° and 270°".to_owned()),
    ];
    for (role, text) in lines {
        to.line(Layer::Legend, role, Subject::None, [vec2(0.0, *y), vec2(24.0, *y)]);
        say(to, vec2(30.0, *y + 3.0), text);
        *y += 12.0;
    }
}

#[cfg(test)]
mod tests {
    use super::super::faces::{Baking, Room};
    use super::*;
    use crate::geometry::{Eye, Flat, Solid, View};
    use crate::raster::{Canvas, Options, StandIn, Target, render};
    use crate::scene::Parts;
    use glam::{vec2, vec3};

    const UNIT: Aabb<Vec2> = Aabb { min: Vec2::ZERO, max: Vec2::ONE };

    fn segments(ends: &[[f32; 4]]) -> Scene<Flat> {
        let points = ends.iter().flat_map(|[a, b, c, d]| [vec2(*a, *b), vec2(*c, *d)]).collect();
        let prims = (0..ends.len() as u32).map(|k| [2 * k, 2 * k + 1]).collect();
        Scene::new(Parts::simple("segments", points, prims)).expect("segments")
    }
    fn contents<S: Projected>(scene: &Scene<S>, cell: Aabb<S::Vector>) -> Contents<'_, S> {
        Contents { scene, surfaces: Surfaces::default(), cell, prims: scene.live() }
    }
    fn cube<S: Projected>(of: &Contents<'_, S>) -> CubeFaces {
        let (scene, surfaces) = (of.scene, of.surfaces);
        let baking = Baking { scene, surfaces, side: 4, is_analytic: false, composes: true };
        CubeFaces::new(&baking.projected(&of.cell, of.prims, &mut Room::default()))
    }

    /// Chamberlain et al. 1996, Section 3.2, as numbers: slats as deep as they are apart, φ from their plane.
    #[test]
    fn a_venetian_blind_is_seen_otherwise_than_its_cube() {
        let degrees = [0.0, 15.0, 30.0, 45.0, 60.0];
        let truths = [0.0, 0.268, 0.577, 1.0, 1.0];
        let cubes = [0.0, 0.211, 0.366, 0.5, 0.634];
        let slat = segments(&[[0.0, 0.5, 1.0, 0.5]]);
        let flat = contents(&slat, UNIT);
        let corners =
            vec![vec3(0.0, 0.5, 0.0), vec3(1.0, 0.5, 0.0), vec3(1.0, 0.5, 1.0), vec3(0.0, 0.5, 1.0)];
        let parts = Parts::simple("slat", corners, vec![[0, 1, 2], [0, 2, 3]]);
        let slat = Scene::<Solid>::new(parts).expect("a slat");
        let solid = contents(&slat, Aabb { min: vec3(0.0, 0.0, 0.0), max: vec3(1.0, 1.0, 1.0) });
        let (flat_cube, solid_cube) = (cube(&flat), cube(&solid));
        for (k, degrees) in degrees.into_iter().enumerate() {
            for axes in [[0, 1], [2, 1]] {
                let turn = Turn { axes, degrees };
                let (truth, cube) = match axes {
                    [0, 1] => (flat.stopped(&turn, 512), turn.cube(&flat_cube)),
                    _ => (solid.stopped(&turn, 256), turn.cube(&solid_cube)),
                };
                assert!((truth - truths[k]).abs() < 0.01, "{degrees}°: {truth}");
                assert!((cube - cubes[k]).abs() < 0.001, "{degrees}°: {cube}");
            }
        }
        // About the vertical the slats are edge-on, whatever the angle.
        for degrees in [0.0, 30.0, 45.0, 100.0] {
            let turn = Turn { axes: [2, 0], degrees };
            assert_eq!((solid.stopped(&turn, 64), turn.cube(&solid_cube)), (0.0, 0.0));
        }
    }

    /// B5.13: from (1, 1) both faces count alike; 30° from an axis sin and cos over their sum.
    #[test]
    fn faces_count_by_the_share_that_is_seen() {
        let faces = |degrees| Turn { axes: [0, 1], degrees }.faces();
        let near = |[(a, p), (b, q)]: [(usize, f64); 2], want: [(usize, f64); 2]| {
            assert_eq!([a, b], [want[0].0, want[1].0]);
            assert!((p - want[0].1).abs() < 5e-4 && (q - want[1].1).abs() < 5e-4, "{p} {q}");
        };
        near(faces(45.0), [(1, 0.5), (3, 0.5)]);
        near(faces(30.0), [(1, 0.634), (3, 0.366)]);
        near(faces(180.0 + 30.0), [(0, 0.634), (2, 0.366)]);
        near(faces(90.0 + 30.0), [(0, 0.366), (3, 0.634)]);
    }

    /// A line of flatland that parallel rays make, near enough: from a thousand units away.
    fn from_afar(degrees: f64, width: u32) -> View<Flat> {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let target = vec2(0.5, 0.5);
        let position = target + vec2(cosine as f32, sine as f32) * 1000.0;
        // Eight cells across.
        let eye = Eye { position, target, up: Vec2::ZERO, fov: 8e-3, near: 900.0, far: 1100.0 };
        View { eye, width, height: 1 }
    }

    /// What is true of a wall is what an image of many copies shows.
    #[test]
    fn the_truth_is_what_many_cells_side_by_side_hide() {
        for parts in [
            vec![[0.0, 0.5, 1.0, 0.5]],
            vec![[0.1, 0.2, 0.7, 0.9], [0.5, 0.1, 0.9, 0.3]],
            vec![[0.0, 0.0, 1.0, 1.0]],
        ] {
            let one = segments(&parts);
            let one = contents(&one, UNIT);
            for degrees in [10.0f64, 35.0, 60.0, 110.0, 200.0, 300.0] {
                let is_column = degrees.to_radians().cos().abs() > degrees.to_radians().sin().abs();
                let copies: Vec<[f32; 4]> = (-20..=20)
                    .map(|k| k as f32)
                    .map(|k| if is_column { [0.0, k] } else { [k, 0.0] })
                    .flat_map(|[x, y]| parts.iter().map(move |[a, b, c, d]| [a + x, b + y, c + x, d + y]))
                    .collect();
                let wall = segments(&copies);
                let view = from_afar(degrees, 4096);
                let image = render(&wall, &view, wall.live());
                let hidden = image.item.iter().filter(|item| **item != Target::NONE).count();
                let (seen, want) =
                    (hidden as f64 / 4096.0, one.stopped(&Turn { axes: [0, 1], degrees }, 512));
                // The image ends within a cell: by one of eight periods at most.
                assert!((seen - want).abs() < 0.06, "{parts:?} at {degrees}°: {seen} and {want}");
            }
        }
    }

    /// What is said of a wall of cubes is what is drawn of one.
    #[test]
    fn a_wall_of_cubes_covers_what_is_drawn_of_it() {
        let alphas = [0.2, 0.3, 0.5, 0.6];
        let faces: [[f32; 4]; 6] =
            std::array::from_fn(|face| [0.0, 0.0, 0.0, *alphas.get(face).unwrap_or(&0.0)]);
        let faces = CubeFaces::new(&faces);
        let scene = segments(&[[0.0, 0.5, 1.0, 0.5]]);
        for degrees in [0.0, 15.0, 40.0, 70.0, 200.0, 320.0] {
            let turn = Turn { axes: [0, 1], degrees };
            let [cosine, sine] = turn.components();
            let mut order: Vec<f32> = (-20..=20).map(|k| k as f32).collect();
            // The nearest first.
            if cosine.abs() > sine.abs() && sine > 0.0 || cosine.abs() <= sine.abs() && cosine > 0.0 {
                order.reverse();
            }
            let at = |k: f32| if cosine.abs() > sine.abs() { vec2(0.0, k) } else { vec2(k, 0.0) };
            let boxes: Vec<StandIn<Vec2>> = order
                .into_iter()
                .map(|k| Aabb { min: UNIT.min + at(k), max: UNIT.max + at(k) })
                .map(|bounds| StandIn { node: NodeId(0), bounds, faces, after: 0 })
                .collect();
            let view = from_afar(degrees, 4096);
            let mut canvas = Canvas::default();
            canvas.clear(&view);
            canvas.composite(&boxes, &render(&scene, &view, &[]), &view, &Options::default());
            let drawn = canvas.samples().map(|[.., left]| 1.0 - f64::from(left)).sum::<f64>() / 4096.0;
            let want = turn.wall(&faces);
            assert!((drawn - want).abs() < 0.03, "{degrees}°: {drawn} drawn, {want} said");
        }
    }
}
