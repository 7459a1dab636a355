//! Section 3: the layering number ζ of every primitive beside the order in which it is projected, which is
//! meant to follow it: in flatland, and in the seminar room. The paper defines ζ and does not draw it.

use std::ops::RangeInclusive;

use glam::{Vec2, Vec3};

use super::room::{FRAME, room};
use crate::drawing::{Drawing, Layer, Pixels, Role, Subject};
use crate::figure::tools::{Maker, Plan, TWO_COLUMNS_PT, Tint, airy, entry, eye, view};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{Flat, PrimId, Solid, View};
use crate::papers::keys::LAYERED_PROJECTION;
use crate::raster::{Drawable, render, shade_with};
use crate::scene::{Scene, SceneError, Surfaces, example};
use crate::truth::{layer_correlation, layering_numbers};

/// Layers that have a color of their own.
const GROUPS: [(RangeInclusive<u32>, &str, Role); 5] = [
    (1..=1, "ζ = 1: visible", Role::Visible),
    (2..=2, "2", Role::Partial),
    (3..=3, "3", Role::Approximated),
    (4..=7, "4 to 7", Role::Hidden),
    (8..=u32::MAX, "8 and more", Role::Outside),
];
/// Pixels of flatland's line: a segment that is seen through a narrow gap has some.
const LINE_PX: u32 = 4096;
/// Side of the room's image in which layers are counted, pixels.
const SIDE_PX: u32 = 512;
/// Width of a panel.
const PANEL_PT: f32 = (TWO_COLUMNS_PT - 20.0) / 3.0;

/// The rules whose order is shown, and how they are called.
const RULES: [(&str, &str); 2] = [("paper", "the paper's rules"), ("ours", "our rules")];

/// A role for each primitive by its layer; none where it covers no pixel.
fn by_layer(layers: &[u32]) -> Vec<Option<Role>> {
    let role = |layer: &u32| GROUPS.iter().find(|(group, ..)| group.contains(layer)).map(|g| g.2);
    layers.iter().map(role).collect()
}

/// The same by the order of projection: the first are as many as are of layer 1, and so on, so an order that
/// follows the layers has the same picture; and how well it does.
fn by_order(order: &[PrimId], layers: &[u32]) -> (Vec<Option<Role>>, f64) {
    let seen: Vec<PrimId> = order.iter().copied().filter(|p| layers[p.at()] > 0).collect();
    let mut sorted: Vec<u32> = seen.iter().map(|p| layers[p.at()]).collect();
    let correlation = layer_correlation(&sorted);
    sorted.sort_unstable();
    let mut place = vec![0; layers.len()];
    for (prim, layer) in seen.into_iter().zip(sorted) {
        place[prim.at()] = layer;
    }
    (by_layer(&place), correlation)
}

/// What the panels of a scene show: by layer, then by the order of each of the rules.
struct Shown {
    label: String,
    roles: Vec<Option<Role>>,
}

fn shown<S: crate::culling::Methods + Drawable>(
    maker: &Maker<'_>,
    scene: &std::sync::Arc<Scene<S>>,
    sight: &View<S>,
    name: &str,
    leaf_size: &str,
) -> Vec<Shown> {
    let layers = layering_numbers(&**scene, sight, Surfaces::default());
    let mut all = vec![Shown { label: format!("{name}, by layer ζ"), roles: by_layer(&layers) }];
    for (rules, called) in RULES {
        let pairs = [("rules", rules), ("budget", "100%"), ("leaf-size", leaf_size), ("seed", "1")];
        let order = maker.ready(scene, LAYERED_PROJECTION, &pairs).cull(sight).prims;
        let (roles, correlation) = by_order(&order, &layers);
        all.push(Shown { label: format!("projected by {called}: {correlation:.2}"), roles });
    }
    all
}

fn flat_panel(scene: &Scene<Flat>, sight: &View<Flat>, shown: &Shown) -> Panel {
    let mut plan = Plan::new(airy(scene, sight.eye.position), PANEL_PT);
    for &prim in scene.live() {
        let role = shown.roles[prim.at()].unwrap_or(Role::Faint);
        let points: Vec<Vec2> = scene.prim_points(prim).collect();
        plan.world.line(Layer::Scene, role, Subject::Prim(prim), points);
    }
    for side in [-0.5, 0.5] {
        let ahead = Vec2::from_angle(sight.eye.fov * side).rotate(sight.eye.forward());
        let end = sight.eye.position + ahead * plan.frame.diagonal();
        plan.world.line(Layer::Frustum, Role::Eye, Subject::Eye, [sight.eye.position, end]);
    }
    plan.dot(Role::Eye, sight.eye.position, 3.0);
    plan.panel(shown.label.clone())
}

/// The room from above, without its ceiling.
fn room_panel(scene: &Scene<Solid>, shown: &Shown, tint: Tint) -> Panel {
    /// What is above this share of the room's height is left out.
    const CEILING: f32 = 0.92;
    let bounds = scene.bounds();
    let from = bounds.center() + Vec3::new(-0.62, 1.9, 0.72) * bounds.size().with_y(bounds.size().y * 1.6);
    let observer = view(from, bounds.center() - Vec3::Y, 38.0, [360, 328]);
    let top = bounds.min.y + bounds.size().y * CEILING;
    let below: Vec<PrimId> =
        scene.live().iter().copied().filter(|p| scene.prim_bounds(*p).min.y < top).collect();
    let color = |prim: PrimId| tint(shown.roles[prim.at()].unwrap_or(Role::Faint));
    let rgba = shade_with(&render(scene, &observer, &below), scene, &observer, tint(Role::Paper), color);
    let pixels = Pixels { width: observer.width, height: observer.height, rgba: rgba.into() };
    Panel { label: shown.label.clone(), picture: Picture::Over(pixels, Drawing::default(), observer) }
}

/// The figure.
pub fn layers(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let tint = maker.tint;
    let flat = example("bottleneck")?;
    let sight = View { width: LINE_PX, ..eye(&flat, 0) };
    let solid = room()?;
    let frame = View { width: SIDE_PX, height: SIDE_PX, ..solid.paths()[0].views[FRAME] };
    let mut all: Vec<Panel> = shown(maker, &flat, &sight, "(a) bottleneck", "5")
        .iter()
        .map(|s| flat_panel(&flat, &sight, s))
        .collect();
    let of_room = shown(maker, &solid, &frame, "(b) seminar room", "5");
    all.extend(of_room.iter().map(|s| room_panel(&solid, s, tint)));
    let content = panels(TWO_COLUMNS_PT, 3, &all);
    let mut legend: Vec<_> =
        GROUPS.iter().map(|(_, label, role)| entry(*role, Swatch::Area, label)).collect();
    legend.push(entry(Role::Faint, Swatch::Area, "covers no pixel"));
    legend.push(entry(Role::Eye, Swatch::Line, "the Eye and its view"));
    let caption = format!(
        "The layering number ζ of a primitive is the smallest rank, by distance, that it has at any pixel: 1 \
         if it is visible (Section 3). On the left it is counted at every pixel; beside it as many \
         primitives as there are of each layer have its color in the order of projection, so an order by \
         layers would give the same picture. Numbers: Kendall's rank correlation of both over pairs of \
         different layers, 1 by layers, 0 at random. Scenes bottleneck and seminar-room (frame {FRAME} of \
         the flight)."
    );
    Ok(maker.page(Paper::TwoColumns, "Layers, and the order of projection", legend, &caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_by_layers_has_the_picture_of_the_layers() {
        let layers = [2, 1, 0, 1, 3, 9];
        let order = |list: [u32; 5]| list.map(PrimId).to_vec();
        let (roles, correlation) = by_order(&order([1, 3, 0, 4, 5]), &layers);
        assert_eq!((roles, correlation), (by_layer(&layers), 1.0));
        let (roles, correlation) = by_order(&order([5, 4, 0, 3, 1]), &layers);
        assert_eq!(correlation, -1.0);
        assert_eq!((roles[5], roles[4], roles[1]), (by_layer(&[1])[0], by_layer(&[1])[0], by_layer(&[9])[0]));
        assert_eq!(roles[2], None, "what covers no pixel has no layer");
    }

    #[test]
    fn projection_follows_the_layers_better_than_chance() {
        let scene = example("bottleneck").expect("a scene");
        let sight = View { width: LINE_PX, ..eye(&scene, 0) };
        let layers = layering_numbers(&*scene, &sight, Surfaces::default());
        let [papers, ours] = RULES.map(|(rules, _)| {
            let pairs = [("rules", rules), ("budget", "100%")];
            let order = Maker::gray().ready(&scene, LAYERED_PROJECTION, &pairs).cull(&sight).prims;
            by_order(&order, &layers).1
        });
        assert!(papers > 0.0 && ours > papers + 0.1, "{papers} and {ours}");
    }
}
