//! Figures 13 and 14: the images of three orders with a budget of a tenth, and which of their pixels are
//! wrong.

use std::sync::Arc;

use super::METHOD;
use super::room::{FRAME, room};
use crate::culling::Methods;
use crate::drawing::{Drawing, Pixels, Role};
use crate::figure::builtin::settings;
use crate::figure::coorg_teller::kit::{TWO_COLUMNS_PT, entry, page};
use crate::figure::{Panel, Paper, Picture, Swatch, Tint, panels};
use crate::geometry::{PrimId, Solid, View};
use crate::method::Settings;
use crate::raster::{render, shade, srgb_bytes, visible};
use crate::scene::{Quiet, Scene, SceneError};

/// Side of an image, pixels.
const SIDE: u32 = 240;

fn list(scene: &Arc<Scene<Solid>>, view: &View<Solid>, method: &str, settings: &Settings) -> Vec<PrimId> {
    let entry = Solid::method(method).expect("built-in figures name methods that exist");
    let run = entry.ready(scene, settings, &Quiet).expect("built-in figures use settings that exist");
    run.expect("nobody cancels a built-in figure").cull(view).prims
}

/// Figures 13 and 14.
pub fn images(tint: Tint) -> Result<Drawing, SceneError> {
    let scene = room()?;
    let view = View { width: SIDE, height: SIDE, ..scene.paths()[0].views[FRAME] };
    let paper = tint(Role::Paper);
    let exact = render(&*scene, &view, scene.live());
    let (seen, exact) = (visible(&exact), shade(&exact, &*scene, &view, paper));
    let [right, wrong] = [Role::Paper, Role::Wrong].map(|role| srgb_bytes(tint(role)));
    let picture = |rgba: Vec<u8>| Picture::Pixels(Pixels { width: SIDE, height: SIDE, rgba: rgba.into() });
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    let cells = [("leaf-size", "5")];
    let ways = [("centroid", None), ("octree", Some("octree")), ("Delaunay", Some("delaunay"))];
    for (name, tessellation) in ways {
        let drawn = match tessellation {
            None => list(&scene, &view, "centroid", &settings(&[("budget", "10%")])),
            Some(t) => list(
                &scene,
                &view,
                METHOD,
                &settings(&[&[("budget", "10%"), ("tessellation", t)][..], &cells].concat()),
            ),
        };
        let image = shade(&render(&*scene, &view, &drawn), &*scene, &view, paper);
        let same: Vec<bool> = exact.chunks_exact(4).zip(image.chunks_exact(4)).map(|(a, b)| a == b).collect();
        let share = 100.0 * same.iter().filter(|s| !**s).count() as f64 / same.len() as f64;
        let mut kept = vec![false; scene.prim_count()];
        drawn.iter().for_each(|p| kept[p.at()] = true);
        let found = 100.0 * seen.iter().filter(|p| kept[p.at()]).count() as f64 / seen.len() as f64;
        let missed = same.iter().flat_map(|&s| if s { right } else { wrong }).collect();
        upper.push(Panel {
            label: format!("{name}: {found:.0} % of what is visible"),
            picture: picture(image),
        });
        lower.push(Panel {
            label: format!("{name}: {share:.1} % of the pixels wrong"),
            picture: picture(missed),
        });
    }
    upper.extend(lower);
    let content = panels(TWO_COLUMNS_PT, 3, &upper);
    let legend = vec![entry(Role::Wrong, Swatch::Area, "wrong pixel; white ones are right")];
    let caption = format!(
        "A seminar room of {} triangles with a budget of 10 %: above what each order draws (nothing where it \
         is white), below where that differs from the image of the whole room, in which {} triangles are \
         visible. Centroid: nearest first; octree and Delaunay: prioritized layers over these cells. The \
         centroid order finds many triangles, those of near chairs, and misses large ones far away: few \
         polygons, many pixels. Frame {FRAME} of the flight, {SIDE} × {SIDE} pixels.",
        scene.live().len(),
        seen.len()
    );
    Ok(page(
        Paper::TwoColumns,
        "What a tenth of the triangles shows, and what it misses",
        legend,
        caption,
        &content,
    ))
}
