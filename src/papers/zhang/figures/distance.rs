//! Figure 5: the distance criterion takes what is near and misses what is far and hides more.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec2, vec2};

use super::flat_film;
use super::notes::{black, occluders};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Role, Subject};
use crate::figure::page::{below, legend};
use crate::figure::tools::{LABEL_PT, Maker, Plan, TWO_COLUMNS_PT, airy};
use crate::figure::{Look, Panel, Paper, panels, world};
use crate::geometry::{Aabb, Flat, PrimId};
use crate::method::Film;
use crate::raster::DepthScale;
use crate::scene::{SceneError, example};
use crate::trace::Stamps;

/// Samples of the image, and L.
const SAMPLES: u32 = 512;
const LIMIT: &str = "100";
/// What is shown of the scene close to the eye.
const NEAR: Aabb<Vec2> = Aabb { min: Vec2::new(-4.4, -0.6), max: Vec2::new(4.4, 6.6) };
/// The objects of the paper's figure.
const NAMES: [&str; 6] = ["A", "B", "C", "D", "E", "F"];

fn film(maker: &Maker<'_>, selection: &str) -> Result<Arc<dyn Film<Flat>>, SceneError> {
    let more =
        [("selection", selection), ("depth", "estimation"), ("leaf-primitives", "1"), ("occluder-size", "0")];
    Ok(flat_film(maker, &example("figure5")?, LIMIT, SAMPLES, &more))
}

/// How many segments of each object are occluders, by name.
fn chosen(film: &dyn Film<Flat>) -> BTreeMap<&str, usize> {
    let scene = film.scene();
    let mut count = BTreeMap::new();
    for prim in occluders(film) {
        *count.entry(scene.objects()[scene.object_of(prim).at()].name.as_str()).or_default() += 1;
    }
    count
}

/// The same in words.
fn in_words(film: &dyn Film<Flat>) -> String {
    let all = chosen(film);
    all.iter().map(|(name, count)| format!("{count} of {name}")).collect::<Vec<_>>().join(", ")
}

fn panel(film: &dyn Film<Flat>, frame: Aabb<Vec2>, label: String) -> Panel {
    let (scene, stamps, end) = (film.scene(), Stamps::new(film), film.events().len());
    let mut plan = Plan::new(frame, (TWO_COLUMNS_PT - 10.0) / 2.0);
    plan.world = world(film, &stamps, end, &Look { nodes: false, ..Look::default() });
    for name in NAMES {
        let is_it = |p: &&PrimId| scene.objects()[scene.object_of(**p).at()].name == name;
        let parts = scene.live().iter().filter(is_it);
        let bounds = parts.fold(Aabb::empty(), |sum: Aabb<Vec2>, p| sum.union(scene.prim_bounds(*p)));
        let at = bounds.center() + vec2(0.0, bounds.size().y * 0.5 + 10.0 * plan.unit);
        // Those that are a dot in the picture of everything are named in the other.
        let is_large = bounds.size().max_element() > 22.0 * plan.unit;
        if is_large && at.cmpgt(frame.min).all() && at.cmplt(frame.max).all() {
            plan.plate(at, LABEL_PT, Font::Bold, name);
        }
    }
    plan.panel(label)
}

/// The finest map as a strip with a line of words.
fn strip(film: &dyn Film<Flat>, name: &str) -> Drawing {
    let picture = film.picture(film.events().len(), super::MAPS, DepthScale::Linear);
    let [black, all] = black(film);
    let mut to = Drawing { size_pt: vec2(TWO_COLUMNS_PT, 30.0), ..Drawing::default() };
    let text = format!("The finest map, {name}: {black} of {all} samples are black.");
    to.text(Layer::Labels, Role::Ink, vec2(0.0, 9.0), 8.0, Anchor::Start, text);
    let image = picture.items.into_iter().find_map(|i| match i.mark {
        Mark::Image { pixels, .. } => Some(pixels),
        _ => None,
    });
    let [a, b] = [vec2(0.0, 13.0), vec2(TWO_COLUMNS_PT, 25.0)];
    if let Some(pixels) = image {
        to.push(Layer::Scene, Role::Scene, Subject::None, Mark::Image { corners: [a, b], pixels });
    }
    to.outline(Layer::Nodes, Role::Faint, Subject::None, [a, vec2(b.x, a.y), b, vec2(a.x, b.y)]);
    to
}

/// Figure 5.
pub fn distance(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let [near, large] = [film(maker, "distance")?, film(maker, "size")?];
    let whole = airy(near.scene(), near.view().eye.position);
    let row = |film: &dyn Film<Flat>, name: &str| {
        let all = panel(film, whole, format!("{name}: everything"));
        panels(TWO_COLUMNS_PT, 2, &[all, panel(film, NEAR, format!("{name}: close to the eye"))])
    };
    let rows = [("by distance", &near), ("by size", &large)];
    let parts = rows.iter().flat_map(|(name, film)| [row(&***film, name), strip(&***film, name)]);
    let content = below(parts.collect());
    let drawn = |film: &dyn Film<Flat>| super::counts(film)[0];
    let caption = format!(
        "L = {LIMIT} segments are chosen as occluders. By distance these are {}: what is near and of many \
         segments. A and B, two segments each, are far, and none of theirs is among them, so that there is a \
         hole in the map between C, D and E; {} segments are drawn. By size, those that look largest, they \
         are {}, and {} are drawn.",
        in_words(&*near),
        drawn(&*near),
        in_words(&*large),
        drawn(&*large)
    );
    let title = "Zhang et al. 1997, Figure 5: the distance criterion misses A and B";
    Ok(maker.page(Paper::TwoColumns, title, legend(&content), caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_takes_c_d_and_e_and_misses_a_and_b() {
        let of = |selection: &str| film(&Maker::gray(), selection).expect("a scene");
        let (near, large) = (of("distance"), of("size"));
        let [by_distance, by_size] = [chosen(&*near), chosen(&*large)];
        let in_view = |name: &str| by_distance.get(name).copied().unwrap_or_default();
        assert!(["C", "D", "E"].iter().all(|name| in_view(name) > 20), "{by_distance:?}");
        assert_eq!([in_view("A"), in_view("B")], [0, 0], "{by_distance:?}");
        assert_eq!([by_size["A"], by_size["B"]], [2, 2], "{by_size:?}");
        assert!(black(&*near)[0] > black(&*large)[0], "A and B fill the hole");
    }
}
