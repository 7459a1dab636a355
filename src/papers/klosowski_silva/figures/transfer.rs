//! Figure 6: a cell A was projected and hands its solidity on to B and C, of which C is not star-shaped; with
//! the arithmetic.

use std::sync::Arc;

use glam::{Vec2, vec2};

use super::notes::{Transfer, transfers};
use super::walked::corners;
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject};
use crate::figure::tools::{LABEL_PT, Maker, NAME_PT, Plan, TWO_COLUMNS_PT, entry, eye};
use crate::figure::{Paper, Swatch, panels};
use crate::geometry::{Aabb, Flat, NodeId};
use crate::method::Film;
use crate::papers::keys::LAYERED_PROJECTION;
use crate::scene::{SceneError, example};

/// The run of the figure.
fn run(maker: &Maker<'_>) -> Result<Arc<dyn Film<Flat>>, SceneError> {
    let scene = example("bottleneck")?;
    let pairs = [
        ("tessellation", "delaunay"),
        ("leaf-size", "10"),
        ("budget", "100%"),
        ("rules", "paper"),
        ("seed", "1"),
    ];
    Ok(maker.film(&scene, &eye(&scene, 0), LAYERED_PROJECTION, &pairs))
}

/// A picture of the three cells, wider than high.
fn frame(film: &dyn Film<Flat>, pair: &[Transfer; 2]) -> Aabb<Vec2> {
    let cells = [pair[0].from(), pair[0].to(), pair[1].to()];
    let tight = Aabb::of(cells.iter().flat_map(|&c| corners(film, c)));
    let high = tight.size().y * 1.15;
    let half = vec2((tight.size().x * 1.15).max(high * WIDER), high) * 0.5;
    Aabb { min: tight.center() - half, max: tight.center() + half }
}

fn area(points: &[Vec2]) -> f32 {
    (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum::<f32>().abs() * 0.5
}

/// B and C: a cell hands much of its solidity on to one neighbor, less to another one that is not
/// star-shaped. Of all such pairs the one whose cells take most of a picture of the three, and whose arrows
/// are well apart.
fn pair(film: &dyn Film<Flat>) -> Option<[Transfer; 2]> {
    let near = |value: f64, wanted: f64| (1.0 - 2.5 * (value - wanted).abs()).max(0.02) as f32;
    let mut best: Option<(f32, [Transfer; 2])> = None;
    for group in transfers(film).iter().filter(|g| g.len() == 2) {
        for (b, c) in [(0, 1), (1, 0)] {
            let (b, c) = (&group[b], &group[c]);
            let less = b.note.along > c.note.along && c.note.along > 0.0;
            if !(b.note.star_shaped && !c.note.star_shaped && less && b.note.of_a > 0.05 && b.note.held > 0) {
                continue;
            }
            let pair = [b.clone(), c.clone()];
            let size = frame(film, &pair).size();
            let least = [b.from(), b.to(), c.to()]
                .iter()
                .map(|&n| area(&corners(film, n)))
                .fold(f32::INFINITY, f32::min);
            let score =
                least / (size.x * size.y) * near(b.note.along.into(), 0.87) * near(c.note.along.into(), 0.45);
            if best.as_ref().is_none_or(|(most, _)| score > *most) {
                best = Some((score, pair));
            }
        }
    }
    best.map(|(_, pair)| pair)
}

/// The ends of the side that two cells share.
fn shared(film: &dyn Film<Flat>, a: NodeId, b: NodeId) -> [Vec2; 2] {
    let of_b = corners(film, b);
    let both: Vec<Vec2> = corners(film, a).into_iter().filter(|p| of_b.contains(p)).collect();
    [both[0], both[1]]
}

/// The arithmetic of a transfer, in one line or two.
fn arithmetic(transfer: &Transfer, name: char) -> Vec<String> {
    let n = &transfer.note;
    let sum = format!(
        "ρ({name}) = |A| / ρ_max + (v · n({name})) ρ(A) = {} / {} + {:.2} × {:.2} = {:.2}",
        n.held,
        n.most,
        n.along,
        n.of_a,
        n.sum()
    );
    let star = if n.star_shaped {
        format!(
            "     The ray from the center of {name} to the Eye leaves through the side that it shares with \
             A: star-shaped, no penalty."
        )
    } else {
        format!(
            "     The ray from the center of {name} to the Eye leaves through another side: not star-shaped, \
             penalized: 2 × {:.2} = {:.2}.",
            n.sum(),
            n.solidity
        )
    };
    vec![sum, star]
}

/// Length of arrows.
const ARROW_PT: f32 = 52.0;
/// Width of the picture over its height, at least.
const WIDER: f32 = 1.8;

/// The middle of a triangle.
fn center(film: &dyn Film<Flat>, cell: NodeId) -> Vec2 {
    corners(film, cell).iter().sum::<Vec2>() / 3.0
}

/// Draws the side that a cell shares with A, the ray of its test, and the vectors of its arithmetic.
fn draw_transfer(plan: &mut Plan, film: &dyn Film<Flat>, transfer: &Transfer, name: char) {
    let at = film.view().eye.position;
    let to = transfer.to();
    let center = center(film, to);
    let [p, q] = shared(film, transfer.from(), to);
    plan.world.line(Layer::Emphasis, Role::Current, Subject::None, [p, q]);
    // The ray of the test, from the center to the Eye.
    plan.world.line(
        Layer::Evidence,
        if transfer.note.star_shaped { Role::Eye } else { Role::Hidden },
        Subject::None,
        [center, at],
    );
    let from = (p + q) * 0.5;
    let tip = |vector: Vec2, length_pt: f32| from + vector * length_pt * plan.unit;
    let [normal, sight] = [transfer.note.normal, transfer.note.sight]
        .map(|vector| [tip(vector, ARROW_PT), tip(vector, ARROW_PT + 9.0)]);
    for ([end, label], role, text) in
        [(normal, Role::Evidence, format!("n({name})")), (sight, Role::Eye, "v".to_owned())]
    {
        plan.world.push(Layer::Emphasis, role, Subject::None, Mark::Arrow(from, end));
        plan.plate(label, LABEL_PT, Font::Bold, &text);
    }
    plan.dot(Role::Ink, center, 2.5);
    // The name on the side away from the normal.
    let aside = (center - from).perp().normalize() * 11.0 * plan.unit;
    let away = aside.dot(normal[0] - center) < 0.0;
    plan.plate(center + if away { aside } else { -aside }, NAME_PT, Font::Bold, &name.to_string());
}

fn draw(film: &dyn Film<Flat>, pair: &[Transfer; 2]) -> Plan {
    let (at, scene) = (film.view().eye.position, film.scene());
    let mut plan = Plan::new(frame(film, pair), TWO_COLUMNS_PT);
    let cell = |n: NodeId| corners(film, n);
    for id in (1..film.hierarchy().node_count() as u32).map(NodeId) {
        plan.world.outline(Layer::Ground, Role::Faint, Subject::Node(id), cell(id));
    }
    let a = pair[0].from();
    plan.world.push(Layer::Areas, Role::Visible, Subject::Node(a), Mark::Area(cell(a)));
    for transfer in pair {
        plan.world.push(
            Layer::Areas,
            Role::Undecided,
            Subject::Node(transfer.to()),
            Mark::Area(cell(transfer.to())),
        );
    }
    for &prim in scene.live() {
        plan.world.line(
            Layer::Scene,
            Role::Scene,
            Subject::Prim(prim),
            scene.prim_points(prim).collect::<Vec<_>>(),
        );
    }
    for (transfer, name) in pair.iter().zip(['B', 'C']) {
        draw_transfer(&mut plan, film, transfer, name);
    }
    plan.plate(center(film, a), NAME_PT, Font::Bold, "A");
    // Where the ray of B leaves the picture.
    let (start, frame) = (center(film, pair[0].to()), plan.frame);
    let is_inside = |t: f32| (start.lerp(at, t) - frame.center()).abs().cmple(frame.size() * 0.5).all();
    let leaves =
        (0..1000).map(|k| k as f32 / 1000.0).take_while(|&t| is_inside(t)).last().unwrap_or_default();
    plan.plate(start.lerp(at, leaves), LABEL_PT, Font::Regular, "to the Eye");
    plan
}

/// Figure 6.
pub fn solidity(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = run(maker)?;
    let pair = pair(&*film).unwrap_or_else(|| unreachable!("the scene has such a pair; a test says so"));
    let mut content = panels(
        TWO_COLUMNS_PT,
        1,
        &[draw(&*film, &pair).panel("A has been projected; B and C are in the front.")],
    );
    for line in pair.iter().zip(['B', 'C']).flat_map(|(t, name)| arithmetic(t, name)) {
        content.size_pt.y += 12.0;
        content.text(Layer::Labels, Role::Ink, vec2(0.0, content.size_pt.y), 8.0, Anchor::Start, line);
    }
    content.size_pt.y += 6.0;
    let legend = vec![
        entry(Role::Visible, Swatch::Area, "A, projected"),
        entry(Role::Undecided, Swatch::Area, "B and C, in the front"),
        entry(Role::Current, Swatch::Line, "side shared with A"),
        entry(Role::Evidence, Swatch::Line, "its normal n"),
        entry(Role::Eye, Swatch::Line, "v, and a ray to the Eye that leaves through the shared side"),
        entry(Role::Hidden, Swatch::Line, "a ray that does not"),
    ];
    let caption = format!(
        "After A has been projected, its solidity ρ(A) is handed on, the more the better the shared side's \
         normal n agrees with the view direction v, in which the Eye looks; |A| counts the segments that \
         meet A, ρ_max is the most of any cell. B lies straight behind A; C is reached sideways, so it gets \
         less of ρ(A), but is multiplied by the penalty factor, here 2, which the paper does not give. \
         Numbers of step {} of the run on scene bottleneck.",
        pair[1].step
    );
    Ok(maker.page(Paper::TwoColumns, "Solidity is handed on", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_the_formula_and_of_the_picture() {
        let film = run(&Maker::gray()).expect("a scene");
        let pair = pair(&*film).expect("such a pair");
        for t in &pair {
            let n = &t.note;
            let sum = n.held as f32 / n.most as f32 + n.along * n.of_a;
            assert!((sum - n.sum()).abs() < 1e-5);
            let factor = if n.star_shaped { 1.0 } else { 2.0 };
            assert!((sum * factor - n.solidity).abs() < 1e-5);
            let (v, normal) = (n.sight, n.normal);
            assert!((v.dot(normal) - n.along).abs() < 1e-5);
            // The picture's normal is that of the shared side, away from A; its view direction is the Eye's.
            let [p, q] = shared(&*film, t.from(), t.to());
            let center = |cell: NodeId| center(&*film, cell);
            assert!(normal.dot(q - p).abs() < 1e-4 && normal.dot(center(t.to()) - center(t.from())) > 0.0);
            assert!((v - film.view().eye.forward()).length() < 1e-4);
        }
    }
}
