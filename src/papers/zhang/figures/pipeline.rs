//! Figure 2: the two phases of a frame, each block with what it leaves of one run.

use std::sync::Arc;

use glam::{Vec2, vec2};

use super::notes::{Fate, built, fates, occluders};
use super::space::{Shot, kept, plate, seen};
use crate::drawing::{Anchor, Drawing, Font, Item, Layer, Mark, Pixels, Role, Subject};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, entry};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::Solid;
use crate::method::Film;
use crate::raster::{DepthScale, Target, render};
use crate::scene::SceneError;

/// The picture of the depth estimation buffer and that of the levels, by number.
const DEPTHS: usize = 2;
/// Blocks a phase.
const BLOCKS: usize = 5;
const GAP_PT: f32 = 10.0;
/// What begins so high over the lowest point is left out of pictures from above, m.
const CUT_M: f32 = 1.2;

const SHOT: Shot<'static> = Shot {
    source: "generate:city?polygons=60000&seed=7",
    path: "figure 8",
    frame: 235,
    size: [192, 192],
    angle: 1.0,
    settings: &[
        ("adapt", "false"),
        ("occluder-budget", "2000"),
        ("map-resolution", "64"),
        ("depth", "estimation"),
        ("depth-resolution", "32"),
    ],
};

/// Roles of all primitives by what became of them.
fn colored(film: &dyn Film<Solid>, role: impl Fn(Fate) -> Role) -> Vec<Role> {
    fates(film).into_iter().map(role).collect()
}

/// The picture in a drawing of a method.
fn picture_in(drawing: &Drawing) -> Option<Pixels> {
    drawing
        .items
        .iter()
        .find_map(|i| if let Mark::Image { pixels, .. } = &i.mark { Some(pixels.clone()) } else { None })
}

/// The first phase: the maps are made.
fn construction(maker: &Maker<'_>, film: &dyn Film<Solid>) -> Vec<Panel> {
    let size = [200, 200];
    let outside = |fate: Fate| if fate == Fate::Outside { Role::Outside } else { Role::Scene };
    let in_view = colored(film, outside);
    let mut chosen = in_view.clone();
    occluders(film).iter().for_each(|p| chosen[p.at()] = Role::Occluder);
    let from_above = |roles: &[Role], label: &str| plate(maker.tint, film, roles, CUT_M, size, label.into());
    let white = render(&**film.scene(), film.view(), &occluders(film));
    let gray = |item: &u32| if *item == Target::NONE { [0, 0, 0, 255] } else { [255; 4] };
    let rgba: Vec<u8> = white.item.iter().flat_map(gray).collect();
    let pixels = Pixels { width: white.width, height: white.height, rgba: rgba.into() };
    let depths = picture_in(&film.picture(built(film), DEPTHS, DepthScale::Logarithmic))
        .unwrap_or_else(|| pixels.clone());
    vec![
        from_above(&in_view, "1 view-frustum culling"),
        from_above(&chosen, "2 occluders chosen"),
        Panel { label: "3 drawn in white".into(), picture: Picture::Pixels(pixels) },
        Panel { label: "4 their depths estimated".into(), picture: Picture::Pixels(depths) },
        Panel { label: "5 averaged down".into(), picture: Picture::Pixels(levels(film)) },
    ]
}

/// The levels beside each other in one picture, as mipmaps are kept: level 0 is left out, level 1 takes most
/// of it.
fn levels(film: &dyn Film<Solid>) -> Pixels {
    let drawing = film.picture(built(film), 0, DepthScale::Linear);
    let all: Vec<Pixels> = drawing
        .items
        .iter()
        .filter_map(|i| if let Mark::Image { pixels, .. } = &i.mark { Some(pixels.clone()) } else { None })
        .collect();
    let side = all.first().map_or(1, |p| p.width) as usize;
    let wide = side + side / 2;
    let mut rgba = [170u8, 170, 170, 255].repeat(wide * wide);
    let (mut x0, mut y0) = (0, (wide - side) / 2);
    for (k, level) in all.iter().enumerate() {
        let (w, h) = (level.width as usize, level.height as usize);
        for y in 0..h {
            let to = ((y0 + y) * wide + x0) * 4;
            rgba[to..to + 4 * w].copy_from_slice(&level.rgba[4 * w * y..4 * w * (y + 1)]);
        }
        // The first on the left, the others below each other.
        (x0, y0) = if k == 0 { (side, y0) } else { (x0, y0 + h) };
    }
    Pixels { width: wide as u32, height: wide as u32, rgba: rgba.into() }
}

/// The second phase: the model is culled by them.
fn culling(maker: &Maker<'_>, film: &dyn Film<Solid>) -> Vec<Panel> {
    let size = [200, 200];
    let from_above = |role: &dyn Fn(Fate) -> Role, label: &str| {
        plate(maker.tint, film, &colored(film, role), CUT_M, size, label.into())
    };
    let in_view = |fate: Fate| if fate == Fate::Outside { Role::Outside } else { Role::Scene };
    let depth = |fate: Fate| match fate {
        Fate::Outside => Role::Outside,
        Fate::Occluder => Role::Occluder,
        Fate::Before => Role::Visible,
        Fate::Shows | Fate::Culled => Role::Scene,
    };
    let overlap = |fate: Fate| match fate {
        Fate::Shows => Role::Visible,
        Fate::Culled => Role::Hidden,
        other => depth(other),
    };
    vec![
        from_above(&in_view, "6 view-frustum culling"),
        from_above(&depth, "7 behind the occluders?"),
        from_above(&overlap, "8 within the maps?"),
        Panel {
            label: "9 the rest is drawn".into(),
            picture: Picture::Pixels(seen(maker.tint, film, &kept(film))),
        },
    ]
}

/// A phase: its name, and its blocks with arrows between them; new blocks stand on gray.
fn phase(name: &str, blocks: &[Panel], new: &[usize]) -> Drawing {
    let width = (TWO_COLUMNS_PT - GAP_PT * (BLOCKS - 1) as f32) / BLOCKS as f32;
    let count = blocks.len() as f32;
    let row = panels(width * count + GAP_PT * (count - 1.0), blocks.len(), blocks);
    let top = 18.0;
    let mut to = Drawing { size_pt: vec2(TWO_COLUMNS_PT, top + row.size_pt.y + 6.0), ..Drawing::default() };
    let mark = Mark::Text {
        at: vec2(0.0, 10.0),
        text: name.into(),
        size_pt: 8.5,
        anchor: Anchor::Start,
        font: Font::Bold,
    };
    to.push(Layer::Labels, Role::Ink, Subject::None, mark);
    for &block in new {
        let a = vec2(block as f32 * (width + GAP_PT) - 3.0, top - 3.0);
        let b = vec2(a.x + width + 6.0, top + row.size_pt.y + 3.0);
        let corners = vec![a, vec2(b.x, a.y), b, vec2(a.x, b.y)];
        to.push(Layer::Ground, Role::Faint, Subject::None, Mark::Area(corners));
    }
    let moved = |p: Vec2| p + vec2(0.0, top);
    to.items.extend(row.items.into_iter().map(|i| Item { mark: i.mark.mapped(moved), ..i }));
    for block in 1..blocks.len() {
        let x = block as f32 * (width + GAP_PT);
        let y = top + width * 0.5;
        let ends = [vec2(x - GAP_PT - 2.0, y), vec2(x + 2.0, y)];
        to.push(Layer::Emphasis, Role::Evidence, Subject::None, Mark::Arrow(ends[0], ends[1]));
    }
    to
}

fn film(maker: &Maker<'_>) -> Result<Arc<dyn Film<Solid>>, SceneError> {
    SHOT.film(maker)
}

/// Figure 2.
pub fn pipeline(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = film(maker)?;
    let content = crate::figure::page::below(vec![
        phase(
            "Phase 1: the hierarchy of occlusion maps is made",
            &construction(maker, &*film),
            &[1, 2, 3, 4],
        ),
        phase("Phase 2: the model is culled by it", &culling(maker, &*film), &[1, 2]),
    ]);
    let all = fates(&*film);
    let count = |of: &[Fate]| film.scene().live().iter().filter(|p| of.contains(&all[p.at()])).count();
    let chosen = occluders(&*film).len();
    let in_view = film.scene().live().len() - count(&[Fate::Outside]);
    let caption = format!(
        "A frame of a generated city of {} triangles. Phase 1: {in_view} triangles are in view, {chosen} of \
         them are chosen as occluders, and drawn in white; a buffer of {} × {} entries keeps how far the \
         occluders of each part of the screen reach, near dark and far light; the white image is averaged \
         down. Phase 2: what is in view is compared with these depths; {} triangles are not behind, so they \
         are drawn without more ado, as is what shows of the occluders. Of the others {} lie within the \
         maps and are culled; {} do not. The occluder database is the model's \
         hierarchy without leaves that are small, redundant or complex. Pictures from above leave out roofs \
         and upper floors, and ground and floors are pale in them, whatever became of those.",
        film.scene().live().len(),
        32,
        32,
        count(&[Fate::Before]),
        count(&[Fate::Culled]),
        count(&[Fate::Shows]),
    );
    let legend = vec![
        entry(Role::Scene, Swatch::Area, "not decided yet"),
        entry(Role::Occluder, Swatch::Area, "occluder"),
        entry(Role::Visible, Swatch::Area, "fails the test: drawn"),
        entry(Role::Hidden, Swatch::Area, "culled"),
        entry(Role::Outside, Swatch::Area, "outside the view"),
        entry(Role::Faint, Swatch::Area, "around a block: new in this method"),
    ];
    let title = "Zhang et al. 1997, Figure 2: the pipeline, with one frame in it";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::role_of;
    use crate::trace::Stamps;

    #[test]
    fn every_triangle_has_the_fate_that_the_film_decides() {
        let film = film(&Maker::gray()).expect("a scene");
        let (stamps, end) = (Stamps::new(&*film), film.events().len());
        let (fates, chosen) = (fates(&*film), occluders(&*film));
        for prim in film.scene().live() {
            let want = match fates[prim.at()] {
                Fate::Outside => Role::Outside,
                Fate::Culled => Role::Hidden,
                _ => Role::Visible,
            };
            let is = role_of(stamps.prim(*prim, end));
            // Of an occluder what came nowhere nearer than what was drawn before it is known to be hidden.
            let is_left_out = fates[prim.at()] == Fate::Occluder && is == Role::Hidden;
            assert!(is == want || is_left_out, "{prim:?}: {is:?}, not {want:?}");
            assert_eq!(fates[prim.at()] == Fate::Occluder, chosen.contains(prim), "{prim:?}");
        }
        for fate in [Fate::Outside, Fate::Occluder, Fate::Before, Fate::Shows, Fate::Culled] {
            assert!(fates.contains(&fate), "{fate:?}: every block has something to show");
        }
    }
}
