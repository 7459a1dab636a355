//! Figure 6: a house behind trees that are the occluders, the holes among their leaves, and the maps.

use std::sync::Arc;

use super::notes::{built, occluders};
use super::space::{Shot, plate, roles};
use super::{STACKED, counts};
use crate::culling::depth::footprint;
use crate::drawing::{Drawing, Pixels, Role};
use crate::figure::page::below;
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, Tint, entry};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{Aabb, Footprint, PixelRect, PrimId, Solid};
use crate::method::{Film, Verdict};
use crate::raster::{DepthScale, Target, render, shade, srgb_bytes};
use crate::scene::SceneError;
use crate::trace::{Stamps, State};

/// The group of the house's objects.
const HOUSE: &str = "house";
/// Thickness of the rectangle's lines, pixels.
const LINE_PX: u32 = 2;

fn film(maker: &Maker<'_>, threshold: &str) -> Result<Arc<dyn Film<Solid>>, SceneError> {
    let shot = Shot {
        source: "generate:forest?polygons=20000",
        path: "views",
        frame: 0,
        size: [512, 384],
        angle: 0.55,
        settings: &[
            ("adapt", "false"),
            ("occluder-budget", "8000"),
            ("occluder-size", "0"),
            ("map-resolution", "64"),
            ("depth", "samples"),
            ("opacity-threshold", threshold),
        ],
    };
    shot.film(maker)
}

/// The triangles of the house.
fn house(film: &dyn Film<Solid>) -> Vec<PrimId> {
    let scene = film.scene();
    let is_house = |p: &PrimId| scene.objects()[scene.object_of(*p).at()].group == HOUSE;
    scene.live().iter().copied().filter(is_house).collect()
}

/// The rectangle of the house in the image.
fn rectangle(film: &dyn Film<Solid>) -> PixelRect {
    let (scene, view) = (film.scene(), film.view());
    let parts = house(film).into_iter().map(|p| scene.prim_bounds(p));
    let bounds = parts.fold(Aabb::empty(), |sum, b| sum.union(b));
    match footprint(view, &view.projection(), &bounds) {
        Footprint::Seen(image) => image.pixels,
        _ => PixelRect::default(),
    }
}

/// The occluders' image with holes lit and the rectangle about the house; and black samples in that.
fn holes(tint: Tint<'_>, film: &dyn Film<Solid>) -> (Pixels, usize) {
    let (scene, view) = (film.scene(), film.view());
    let image = render(&**scene, view, &occluders(film));
    let mut rgba = shade(&image, &**scene, view, tint(Role::Current));
    let (r, line) = (rectangle(film), srgb_bytes(tint(Role::Partial)));
    let mut black = 0;
    for y in r.y0..r.y1 {
        for x in r.x0..r.x1 {
            let at = (y * view.width + x) as usize;
            black += usize::from(image.item[at] == Target::NONE);
            let inside =
                x >= r.x0 + LINE_PX && x + LINE_PX < r.x1 && y >= r.y0 + LINE_PX && y + LINE_PX < r.y1;
            if !inside {
                rgba[4 * at..4 * at + 4].copy_from_slice(&line);
            }
        }
    }
    (Pixels { width: view.width, height: view.height, rgba: rgba.into() }, black)
}

/// Triangles of the house that are in view, and how many of them are culled.
fn culled(film: &dyn Film<Solid>) -> [usize; 2] {
    let (stamps, end) = (Stamps::new(film), film.events().len());
    let state = |p: &PrimId| stamps.prim(*p, end);
    let all = house(film);
    let hidden = [Verdict::Hidden, Verdict::Presumed].map(State::Decided);
    let in_view = all.iter().filter(|p| state(p) != State::Decided(Verdict::Outside)).count();
    [in_view, all.iter().filter(|p| hidden.contains(&state(p))).count()]
}

/// Figure 6.
pub fn trees(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let [exact, loose] = [film(maker, "1")?, film(maker, "0.7")?];
    let film = &*exact;
    let mut colors = roles(film);
    house(film).iter().for_each(|p| colors[p.at()] = Role::Partial);
    let (pixels, black) = holes(maker.tint, film);
    let r = rectangle(film);
    let content = panels(
        TWO_COLUMNS_PT,
        2,
        &[
            plate(maker.tint, film, &colors, f32::INFINITY, [480, 360], "from above".into()),
            Panel { label: "the occluders as the Eye sees them".into(), picture: Picture::Pixels(pixels) },
        ],
    );
    let content = below(vec![content, film.picture(built(film), STACKED, DepthScale::Linear)]);
    let [in_view, at_one] = culled(film);
    let [_, at_less] = culled(&*loose);
    let caption = format!(
        "A house behind trees, generated, {} triangles; {} of what is before it, leaves, wood and ground, \
         are occluders. In their image what shows through is lit: holes of a pixel or a few among the \
         leaves. Of the house's rectangle, {} × {} pixels, {black} are black. Below the hierarchy of maps \
         of this image. From above the ground is pale, whatever became of it. Of the house's {in_view} \
         triangles in view {at_one} are culled with a threshold of 1, {at_less} with 0.7: {} \
         triangles are drawn in all, and {}.",
        film.scene().live().len(),
        occluders(film).len(),
        r.x1 - r.x0,
        r.y1 - r.y0,
        counts(film)[0],
        counts(&*loose)[0]
    );
    let legend = vec![
        entry(Role::Occluder, Swatch::Area, "occluder"),
        entry(Role::Partial, Swatch::Area, "the house, and its rectangle"),
        entry(Role::Visible, Swatch::Area, "drawn as well"),
        entry(Role::Hidden, Swatch::Area, "culled"),
        entry(Role::Outside, Swatch::Area, "outside the view"),
        entry(Role::Current, Swatch::Area, "hole: no occluder"),
        entry(Role::Eye, Swatch::Line, "the Eye and its view"),
    ];
    let title = "Zhang et al. 1997, Figure 6: a house behind trees";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_are_the_occluders_and_holes_are_few() {
        let exact = film(&Maker::gray(), "1").expect("a scene");
        let scene = exact.scene();
        let chosen = occluders(&*exact);
        let name = |p: &PrimId| scene.objects()[scene.object_of(*p).at()].name.as_str();
        let grown = chosen.iter().filter(|p| ["leaves", "wood"].contains(&name(p))).count();
        let ground = chosen.iter().filter(|p| name(p) == "meadow").count();
        assert_eq!(grown + ground, chosen.len(), "nothing of the house");
        assert!(grown > 9 * ground, "{grown} of trees, {ground} of the ground");
        let (pixels, black) = holes(&|_| [0.5; 3], &*exact);
        let r = rectangle(&*exact);
        assert!(black > 0 && (black as u64) < r.area() / 4, "{black} of {} show through", r.area());
        assert_eq!([pixels.width, pixels.height], [512, 384]);
        let loose = film(&Maker::gray(), "0.7").expect("a scene");
        let [[in_view, one], [_, less]] = [culled(&*exact), culled(&*loose)];
        assert!(one < less && less <= in_view, "{one} and {less} of {in_view}");
    }
}
