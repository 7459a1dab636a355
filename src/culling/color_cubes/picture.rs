//! What is seen of the method: cubes in their colors in the world; and how a face was made, and the sizes of
//! cells against the threshold. The image so far: [`super::so_far`]; errors by direction: [`super::turning`].

use glam::vec2;

use super::evidence::{Evidence, FACE_NAMES};
use super::faces::{Baking, held, over};
use super::sketch::{At, bytes, cell_of, patch, say};
use super::so_far::{beside, so_far};
use super::space::Projected;
use super::turning::by_direction;
use super::{Order, Params};
use crate::culling::depth::picture::{WIDTH_PT, finished};
use crate::drawing::{Anchor, Drawing, Layer, Mark, Role, Subject};
use crate::geometry::{Aabb, NodeId, Vector};

/// The pictures that are not of the world.
pub(super) const PICTURES: &[&str] = &[
    "Image so far",
    "How a face is made",
    "Sizes of cells",
    "Beside the exact picture",
    "Error by direction",
];

/// How many cubes are shown in the world, the nearest: more are too many to be drawn at every step.
const MOST_SHOWN: usize = 10_000;

/// Draws the cubes that were drawn so far in the world, the farthest first, and the note's own evidence.
pub(super) fn explain<S: Projected>(moment: At<'_, '_, S>, to: &mut Drawing<S::Vector>) {
    let eye = moment.frame.view.eye.position;
    let cubes = moment.notes.iter().filter_map(|n| if let Evidence::Cube(c) = n { Some(c) } else { None });
    let mut cubes: Vec<_> = cubes.collect();
    // The farthest first; in the paper's order they came so.
    if moment.frame.params.order == Order::Exact {
        cubes.reverse();
    }
    for cube in cubes.split_off(cubes.len().saturating_sub(MOST_SHOWN)) {
        for face in cube.facing(eye) {
            let (points, subject) = (corners(&cube.cell, face), Subject::Node(cube.node));
            if S::Vector::AXES == 2 {
                // The pattern of the cell's state would show through, and no color could be told.
                to.push(Layer::Areas, Role::Paper, subject, Mark::Area(points.clone()));
            }
            let rgba = bytes(cube.faces.get(face));
            to.push(Layer::Areas, Role::Approximated, subject, Mark::Swatch { points, rgba });
        }
    }
    if let Some(note) = moment.note {
        note.draw(moment.frame.scene, moment.frame.view, moment.frame.index.tree(), to);
    }
}

/// The corners of a face of a box in order; of an edge of flatland a band a fifth of the box wide, inside it.
fn corners<V: Vector>(cell: &Aabb<V>, face: usize) -> Vec<V> {
    let (axis, is_upper) = (face / 2, face % 2 == 1);
    let (low, high) = (cell.min.get(axis), cell.max.get(axis));
    let depth = if V::AXES == 2 { 0.2 * (high - low) } else { 0.0 };
    let (outer, inner) = if is_upper { (high, high - depth) } else { (low, low + depth) };
    let along: Vec<usize> = (0..V::AXES).filter(|a| *a != axis).collect();
    let place = |at: [f32; 2]| {
        V::from_fn(|a| match along.iter().position(|k| *k == a) {
            None if V::AXES == 2 && at[1] > 0.5 => inner,
            None => outer,
            Some(k) => cell.min.get(a) + at[k] * (cell.max.get(a) - cell.min.get(a)),
        })
    };
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(place).to_vec()
}

/// Draws picture `which`.
pub(super) fn picture<S: Projected>(moment: At<'_, '_, S>, which: usize) -> Drawing {
    match which {
        0 => so_far(moment),
        1 => making(moment),
        2 => sizes(moment),
        3 => beside(moment),
        _ => by_direction(moment),
    }
}

/// How each face of the cell at hand was made: of a leaf its samples, of an inner cell the faces of its
/// children, front over back, and their mean (Figure 3).
fn making<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let mut to = Drawing::default();
    let Some(id) = cell_of(moment) else {
        say(&mut to, vec2(0.0, 12.0), "No cell has been looked at yet.");
        return finished(to, 20.0, "No cell yet");
    };
    let tree = moment.frame.index.tree();
    let node = &tree.nodes()[id.at()];
    let is_composed = !node.is_leaf() && moment.frame.params.composes();
    let is_analytic = moment.frame.params.is_analytic();
    let way = match () {
        _ if is_composed => "composed of its children",
        _ if is_analytic => "its primitives by area; samples show where they are",
        _ => "its primitives, sampled",
    };
    let title = format!("Node {id}, level {}: {way}", node.level);
    say(&mut to, vec2(0.0, 10.0), title.clone());
    let mut y = 20.0;
    if is_composed {
        say(&mut to, vec2(0.0, 22.0), COLUMNS);
        y = 32.0;
    }
    // Next to what it is the mean of.
    let columns_pt = (1 << (S::Vector::AXES - 1)) as f32 * COLUMN_PT;
    let mean_at = COLUMNS_PT + if is_composed { columns_pt } else { SAMPLES_PT } + 12.0;
    let samples = (!is_composed).then(|| samples_of(moment, id));
    for (face, name) in FACE_NAMES.iter().enumerate().take(2 * S::Vector::AXES) {
        say(&mut to, vec2(0.0, y + 0.6 * SIDE_PT), *name);
        let height = match &samples {
            Some(samples) => sampled::<S>(&mut to, y, &samples[face], moment.frame.params),
            None => columns(moment, id, face, y, &mut to),
        };
        let mean = moment.frame.index.faces(id).get(face);
        patch(&mut to, vec2(mean_at, y), SIDE_PT, mean);
        say(&mut to, vec2(mean_at + SIDE_PT + 4.0, y + 0.6 * SIDE_PT), format!("mean: {}", words(mean)));
        y += height + 6.0;
    }
    finished(to, y, &title)
}

/// The samples of a cell's faces.
fn samples_of<S: Projected>(moment: At<'_, '_, S>, id: NodeId) -> Vec<Vec<[f32; 4]>> {
    let (tree, params) = (moment.frame.index.tree(), moment.frame.params);
    let baking = Baking {
        scene: moment.frame.scene,
        surfaces: params.surfaces,
        side: params.face_samples,
        is_analytic: false,
        composes: true,
    };
    baking.samples(&tree.cell(id), &held(tree, id))
}

/// Side of a patch of color.
const SIDE_PT: f32 = 24.0;
/// What columns show.
const COLUMNS: &str =
    "Columns: the front child's face, below it the back one's; beside them one over the other.";
/// Where columns and samples begin, how wide a column is with the gap after it, and how wide samples are.
const COLUMNS_PT: f32 = 30.0;
const COLUMN_PT: f32 = SIDE_PT + 12.0;
const SAMPLES_PT: f32 = 60.0;

/// A coverage in words.
fn words(color: [f32; 4]) -> String {
    format!("{:.0} % covered", color[3] * 100.0)
}

/// The samples of a face; how high they are.
fn sampled<S: Projected>(to: &mut Drawing, top: f32, samples: &[[f32; 4]], params: &Params) -> f32 {
    let side = params.face_samples as usize;
    let cell = (SAMPLES_PT / side as f32).min(SIDE_PT * 0.6);
    for (at, color) in samples.iter().enumerate() {
        // Rows go up, as axes do.
        let row = if samples.len() > side { side - 1 - at / side } else { 0 };
        patch(to, vec2(COLUMNS_PT + (at % side) as f32 * cell, top + row as f32 * cell), cell, *color);
    }
    (if samples.len() > side { side as f32 * cell } else { cell }).max(SIDE_PT)
}

/// The columns of a face: the front child's face over the back one's. How high they are.
fn columns<S: Projected>(moment: At<'_, '_, S>, id: NodeId, face: usize, top: f32, to: &mut Drawing) -> f32 {
    let (axis, is_upper) = (face / 2, face % 2);
    let node = &moment.frame.index.tree().nodes()[id.at()];
    let of = |octant: usize| {
        node.child(octant).map_or([0.0; 4], |child| moment.frame.index.faces(child).get(face))
    };
    let fronts = (0..1usize << S::Vector::AXES).filter(|octant| octant >> axis & 1 == is_upper);
    for (column, octant) in fronts.enumerate() {
        let (front, back) = (of(octant), of(octant ^ 1 << axis));
        let x = COLUMNS_PT + column as f32 * COLUMN_PT;
        patch(to, vec2(x, top), SIDE_PT * 0.5, front);
        patch(to, vec2(x, top + SIDE_PT * 0.55), SIDE_PT * 0.5, back);
        patch(to, vec2(x + SIDE_PT * 0.6, top + SIDE_PT * 0.25), SIDE_PT * 0.5, over(front, back));
    }
    SIDE_PT * 1.1
}

/// The sizes of the cells that were visited so far, level by level, and the threshold.
fn sizes<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let (mut to, tree, threshold) =
        (Drawing::default(), moment.frame.index.tree(), moment.frame.params.pixel_threshold);
    // Pixels from a hundredth to ten thousand, by factors.
    let x = |size: f32| 40.0 + (size.clamp(0.01, 1e4).log10() + 2.0) / 6.0 * (WIDTH_PT - 50.0);
    let row = |level: u8| 22.0 + 9.0 * f32::from(level);
    let mut deepest = 0;
    let mut cells = 0;
    for note in moment.notes {
        let Evidence::Sized(n) = note else { continue };
        let node = &tree.nodes()[n.node.at()];
        deepest = deepest.max(node.level);
        cells += 1;
        let role = match (n.size <= threshold, node.is_leaf()) {
            (true, _) => Role::Approximated,
            (false, true) => Role::Visible,
            (false, false) => Role::Partial,
        };
        let mark = Mark::Dot { at: vec2(x(n.size), row(node.level)), radius_pt: 1.8 };
        to.push(Layer::Scene, role, Subject::Node(n.node), mark);
    }
    let bottom = row(deepest) + 8.0;
    for level in 0..=deepest {
        say(&mut to, vec2(0.0, row(level) + 3.0), format!("level {level}"));
    }
    for decade in -2..=4 {
        let at = x(10f32.powi(decade));
        to.line(Layer::Ground, Role::Faint, Subject::None, [vec2(at, 14.0), vec2(at, bottom)]);
        let text = format!("{}", 10f64.powi(decade));
        to.text(Layer::Labels, Role::Faint, vec2(at, bottom + 9.0), 7.0, Anchor::Middle, text);
    }
    if threshold > 0.0 {
        let at = x(threshold);
        to.line(Layer::Evidence, Role::Evidence, Subject::None, [vec2(at, 10.0), vec2(at, bottom)]);
        to.text(Layer::Labels, Role::Evidence, vec2(at, 8.0), 7.5, Anchor::Middle, "threshold");
    }
    say(&mut to, vec2(40.0, bottom + 20.0), "side of the cell on the screen, pixels");
    let title = format!("Sizes of {cells} cells against the threshold of {threshold} pixels");
    finished(to, bottom + 26.0, &title)
}
