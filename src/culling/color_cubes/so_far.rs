//! What has been drawn up to a step: as a list, as an image, and beside the image of the geometry.

use glam::{Vec2, vec2};

use super::Order;
use super::evidence::Evidence;
use super::sketch::{At, height_of, image, say};
use super::space::Projected;
use crate::culling::depth::picture::{WIDTH_PT, finished};
use crate::drawing::{Anchor, Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::geometry::View;
use crate::method::DrawList;
use crate::raster::{Light, Options, SEEN, StandIn, difference_color, flip_map, shade_differences};

/// What has been drawn up to a step.
pub fn drawn<S: Projected>(moment: At<'_, '_, S>) -> DrawList<S> {
    let (frame, params) = (&moment.frame, moment.frame.params);
    let in_order = params.order == Order::Paper;
    let samples = params.samples;
    let mut list = DrawList { light: Light::Fixed, in_order, samples, ..DrawList::default() };
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

/// The image of a list from a view.
fn painted<S: Projected>(moment: At<'_, '_, S>, view: &View<S>, list: &DrawList<S>) -> Vec<u8> {
    let options = Options { surfaces: moment.frame.params.surfaces, ..Options::default() };
    list.paint(moment.frame.scene, view, &options, WHITE)
}

/// What has been drawn up to the step: geometry, and cubes over it.
pub fn so_far<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let (view, list) = (moment.frame.view, drawn(moment));
    let described = format!("{} primitives and {} cubes are drawn", list.prims.len(), list.stand_ins.len());
    let mut alone = DrawList { prims: Vec::new(), ..list.clone() };
    alone.stand_ins.iter_mut().for_each(|cube| cube.after = 0);
    // One below the other in flatland, side by side in space.
    let is_line = view.height == 1;
    let width = if is_line { WIDTH_PT } else { WIDTH_PT * 0.5 - 4.0 };
    let down = height_of(view, width) + 16.0;
    let (mut to, mut y) = (Drawing::default(), 12.0 + down);
    image(&mut to, view, (vec2(0.0, 12.0), width), painted(moment, view, &list), "All that is drawn");
    let place = if is_line { vec2(0.0, y) } else { vec2(width + 8.0, 12.0) };
    image(&mut to, view, (place, width), painted(moment, view, &alone), "The cubes alone");
    y += if is_line { down } else { 0.0 };
    say(&mut to, vec2(0.0, y - 6.0), described.clone());
    finished(to, y, &described)
}

/// Pixels of an image whose differences are found before a person waits.
const MOST_PIXELS: f64 = 200_000.0;

/// A view of as much in no more pixels than that.
fn smaller<S: Projected>(view: &View<S>) -> View<S> {
    let pixels = f64::from(view.width) * f64::from(view.height);
    let by = (pixels / MOST_PIXELS).sqrt().ceil().max(1.0) as u32;
    View { width: view.width.div_ceil(by), height: view.height.div_ceil(by), ..*view }
}

/// What has been drawn up to the step, the geometry of the whole scene, and how different the two look.
pub fn beside<S: Projected>(moment: At<'_, '_, S>) -> Drawing {
    let (scene, view) = (moment.frame.scene, &smaller(moment.frame.view));
    let with_cubes = painted(moment, view, &drawn(moment));
    let (prims, samples) = (scene.live().to_vec(), moment.frame.params.samples);
    let whole = DrawList { prims, light: Light::Fixed, samples, ..DrawList::default() };
    let geometry = painted(moment, view, &whole);
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
    let mut end = legend(&mut to, place(3), width.min(260.0), &map);
    let whole = moment.frame.view;
    if view != whole {
        let text = format!(
            "Made of {} × {} pixels instead of {} × {}.",
            view.width, view.height, whole.width, whole.height
        );
        say(&mut to, vec2(place(3).x, end), text);
        end += 13.0;
    }
    let bottom = end.max(place(2).y + height_of(view, width)) + 6.0;
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

#[cfg(test)]
mod tests {
    use super::super::{ColorCubes, picture::PICTURES};
    use super::*;
    use crate::geometry::{Flat, Solid};
    use crate::method::{Entry, Film, Of, Settings};
    use crate::raster::DepthScale;
    use crate::scene::{Quiet, Scene, example, framing_view, samples};
    use std::sync::Arc;

    fn film<S: Projected>(scene: &Arc<Scene<S>>, view: &View<S>, pairs: &[(&str, &str)]) -> Arc<dyn Film<S>> {
        let run = Of::<ColorCubes>::NEW.ready(scene, &Settings::of(pairs), &Quiet);
        run.expect("settings that exist").expect("not cancelled").record(view, usize::MAX).film
    }

    /// Without cubes the image is that of the geometry, to the byte; with large ones it is not.
    #[test]
    fn with_no_cubes_nothing_differs_and_with_large_ones_much_does() {
        let scene = example("molecule").expect("an example");
        let view = View { width: 128, ..scene.paths()[0].views[0] };
        for (threshold, differs) in [("0", false), ("24", true)] {
            let film = film(&scene, &view, &[("pixel-threshold", threshold)]);
            let drawing = film.picture(film.events().len(), 3, DepthScale::Linear);
            let images: Vec<&Pixels> = drawing
                .items
                .iter()
                .filter_map(|i| if let Mark::Image { pixels, .. } = &i.mark { Some(pixels) } else { None })
                .collect();
            assert_eq!(images.len(), 4, "two images, their difference, the legend");
            assert_eq!(images[0] != images[1], differs, "threshold {threshold}");
            let is_black = images[2].rgba.chunks_exact(4).all(|p| p == [0, 0, 0, 255]);
            assert_eq!(is_black, !differs);
            let says = |text: &str| {
                drawing.items.iter().any(|i| matches!(&i.mark, Mark::Text { text: t, .. } if t == text))
            };
            assert_eq!(says("Pixels above 0.1: 0.0 %") && says("Mean over all pixels: 0.0000"), !differs);
        }
    }

    /// All pictures at some steps, in both spaces: none is empty, and none sticks out of its paper.
    #[test]
    fn every_picture_is_drawn_at_every_step() {
        fn check<S: Projected>(scene: Arc<Scene<S>>, width: u32, height: u32) {
            let view = framing_view::<S>(&scene.bounds(), width, height);
            let film = film(&scene, &view, &[("pixel-threshold", "9")]);
            let end = film.events().len();
            for step in [0, 5, end / 2, end] {
                for (which, name) in PICTURES.iter().enumerate() {
                    let drawing = film.picture(step, which, DepthScale::Linear);
                    let size = drawing.size_pt;
                    assert!(!drawing.items.is_empty() && size.min_element() > 0.0, "{name} at {step}");
                    for item in &drawing.items {
                        let Mark::Image { corners, .. } = &item.mark else { continue };
                        let is_inside =
                            corners.iter().all(|c| c.cmple(size).all() && c.cmpge(Vec2::ZERO).all());
                        assert!(is_inside, "{name} at {step}: {corners:?} of {size}");
                    }
                }
            }
        }
        check(samples::soup::<Flat>(7, 60), 96, 1);
        check(samples::soup::<Solid>(7, 60), 48, 36);
    }

    #[test]
    fn large_images_are_looked_at_in_fewer_pixels() {
        let scene = samples::soup::<Solid>(7, 10);
        let of = |width, height| {
            let small = smaller(&framing_view::<Solid>(&scene.bounds(), width, height));
            (small.width, small.height)
        };
        assert_eq!((of(124, 124), of(400, 500), of(1024, 768)), ((124, 124), (400, 500), (512, 384)));
    }
}
