//! What has been drawn up to a step: as a list, as an image, and beside the image of the geometry.

use glam::{Vec2, vec2};

use super::Order;
use super::evidence::Evidence;
use super::sketch::{At, height_of, image, say};
use super::space::Projected;
use crate::culling::depth::picture::{WIDTH_PT, finished};
use crate::drawing::{Anchor, Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::method::DrawList;
use crate::raster::{Light, Options, SEEN, StandIn, difference_color, flip_map, shade_differences};

/// What has been drawn up to a step.
pub fn drawn<S: Projected>(moment: At<'_, '_, S>) -> DrawList<S> {
    let (frame, params) = (&moment.frame, moment.frame.params);
    let in_order = params.order == Order::Paper;
    let mut list = DrawList { light: Light::Fixed, in_order, ..DrawList::default() };
    // What leaves share is told twice: by itself, and as a part of a cell.
    let mut is_listed = vec![false; frame.scene.prim_count()];
    for note in moment.notes {
        let told = note.drawn(frame.index, params.surfaces.one_sided).iter();
        list.prims.extend(told.filter(|prim| !std::mem::replace(&mut is_listed[prim.at()], true)));
        if let Evidence::Cube(c) = note {
            let after = list.prims.len() as u32;
            list.stand_ins.push(StandIn { node: c.node, bounds: c.cell, faces: c.faces, after });
        }
    }
    list
}

const WHITE: [f32; 3] = [1.0; 3];

/// The image of a list from the Eye.
fn painted<S: Projected>(moment: At<'_, '_, S>, list: &DrawList<S>) -> Vec<u8> {
    let frame = &moment.frame;
    let options = Options { surfaces: frame.params.surfaces, ..Options::default() };
    list.paint(frame.scene, frame.view, &options, WHITE)
}

/// What has been drawn up to the step: geometry, and cubes over it.
pub fn so_far<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let (view, list) = (moment.frame.view, drawn(moment));
    let described = format!("{} primitives and {} cubes are drawn", list.prims.len(), list.stand_ins.len());
    let mut alone = DrawList { prims: Vec::new(), ..list.clone() };
    alone.stand_ins.iter_mut().for_each(|cube| cube.after = 0);
    let width = if view.height == 1 { WIDTH_PT } else { WIDTH_PT * 0.5 - 4.0 };
    let (mut to, mut y) = (Drawing::default(), 12.0);
    for (text, list) in [("All that is drawn", &list), ("The cubes alone", &alone)] {
        image(&mut to, view, (vec2(0.0, y), width), painted(moment, list), text);
        y += height_of(view, width) + 16.0;
    }
    say(&mut to, vec2(0.0, y - 6.0), described.clone());
    finished(to, y, &described)
}

/// What has been drawn up to the step, the geometry of the whole scene, and how different the two look.
pub fn beside<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let (scene, view) = (moment.frame.scene, moment.frame.view);
    let with_cubes = painted(moment, &drawn(moment));
    let whole = DrawList { prims: scene.live().to_vec(), light: Light::Fixed, ..DrawList::default() };
    let geometry = painted(moment, &whole);
    let map = flip_map(&geometry, &with_cubes, view.width as usize, view.height as usize);
    let is_line = view.height == 1;
    let width = if is_line { WIDTH_PT } else { WIDTH_PT * 0.5 - 5.0 };
    let down = height_of(view, width) + 18.0;
    // Of space in two rows, with the legend in the fourth place.
    let place = |k: u16| match is_line {
        true => vec2(0.0, 12.0 + down * f32::from(k)),
        false => vec2((width + 10.0) * f32::from(k % 2), 12.0 + down * f32::from(k / 2)),
    };
    let mut to = Drawing::default();
    image(&mut to, view, (place(0), width), with_cubes, "Drawn so far, with cubes");
    image(&mut to, view, (place(1), width), geometry, "The geometry itself");
    image(&mut to, view, (place(2), width), shade_differences(&map), "How different they look (FLIP)");
    let legend = legend(&mut to, place(3), width.min(260.0), &map);
    let bottom = legend.max(place(2).y + height_of(view, width)) + 6.0;
    finished(to, bottom, "Beside the picture of the geometry")
}

/// What colors of differences mean, and how many there are of them. Where it ends.
fn legend(to: &mut Drawing, at: Vec2, width: f32, map: &[f32]) -> f32 {
    const STEPS: u32 = 100;
    const HIGH_PT: f32 = 12.0;
    let rgba: Vec<u8> = (0..STEPS)
        .map(|k| difference_color((k as f32 + 0.5) / STEPS as f32))
        .flat_map(|[r, g, b]| [r, g, b, 255])
        .collect();
    let pixels = Pixels { width: STEPS, height: 1, rgba: rgba.into() };
    let corners = [at, at + vec2(width, HIGH_PT)];
    to.push(Layer::Ground, Role::Paper, Subject::None, Mark::Image { corners, pixels });
    let tick = |to: &mut Drawing, share: f32, text: &str| {
        let anchor = if share == 0.0 {
            Anchor::Start
        } else if share < 1.0 {
            Anchor::Middle
        } else {
            Anchor::End
        };
        let foot = at + vec2(width * share, HIGH_PT);
        to.line(Layer::Evidence, Role::Ink, Subject::None, [foot, foot + vec2(0.0, 4.0)]);
        to.text(Layer::Labels, Role::Ink, foot + vec2(0.0, 12.0), 7.5, anchor, text);
    };
    for (share, text) in [(0.0, "0"), (SEEN as f32, "0.1"), (0.5, "0.5"), (1.0, "1")] {
        tick(to, share, text);
    }
    let pixels = map.len().max(1) as f64;
    let mean = map.iter().map(|d| f64::from(*d)).sum::<f64>() / pixels;
    let seen = map.iter().filter(|d| f64::from(**d) > SEEN).count() as f64 / pixels;
    let lines = [
        "0: alike. 1: as different as black and white.".to_owned(),
        "From 0.1 on it is seen when one flips between the two.".to_owned(),
        format!("Mean over all pixels: {mean:.4}"),
        format!("Pixels above 0.1: {:.1} %", seen * 100.0),
    ];
    let mut y = at.y + HIGH_PT + 28.0;
    for line in lines {
        say(to, vec2(at.x, y), line);
        y += 13.0;
    }
    y
}
