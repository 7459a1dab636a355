//! Figures 1 and 2: the traversal frozen in a seminar room and seen from outside, with the cells that were
//! projected and those that were not.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3;

use crate::drawing::{Drawing, Layer, Mark, Pixels, Role, Subject};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, Tint, entry, view};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{Frustum, NodeId, PrimId, Solid, View};
use crate::method::{Film, Verdict};
use crate::papers::keys::LAYERED_PROJECTION;
use crate::raster::{Target, render, shade};
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, load};
use crate::trace::{Stamps, State};

/// The seminar room.
pub fn room() -> Result<Arc<Scene<Solid>>, SceneError> {
    match load("generate:seminar-room", &LoadOptions::default(), &Quiet)? {
        AnyScene::Solid(scene) => Ok(scene),
        AnyScene::Flat(_) => unreachable!("the room is in space"),
    }
}

/// Number of the frame of the flight that the figures look at: by the last row, toward the board.
pub const FRAME: usize = 150;

/// Pieces of an edge that are tried by themselves.
const PIECES: usize = 48;
/// A line is seen where it is at most so much behind what is drawn there, so that lines on surfaces show.
const BEHIND: f32 = 1.002;
/// What is above this share of the room's height is left out, so that one looks in.
const CEILING: f32 = 0.92;

/// The parts of an edge that are before what the observer sees.
fn seen_parts(observer: &View<Solid>, image: &Target, [a, b]: [Vec3; 2]) -> Vec<[Vec3; 2]> {
    let projection = observer.projection();
    let at = |k: usize| a.lerp(b, k as f32 / PIECES as f32);
    let is_seen = |p: Vec3| {
        let clip = projection.clip(p);
        if clip.z < observer.eye.near {
            return false;
        }
        let (x, y) = (
            (clip.x / clip.z * 0.5 + 0.5) * image.width as f32,
            (0.5 - clip.y / clip.z * 0.5) * image.height as f32,
        );
        let inside = x >= 0.0 && y >= 0.0 && x < image.width as f32 && y < image.height as f32;
        inside && BEHIND / clip.z >= image.depth[y as usize * image.width as usize + x as usize]
    };
    let mut parts: Vec<[Vec3; 2]> = Vec::new();
    let mut open = false;
    for k in 0..PIECES {
        let seen = is_seen(at(k).midpoint(at(k + 1)));
        match parts.last_mut().filter(|_| seen && open) {
            Some(last) => last[1] = at(k + 1),
            None if seen => parts.push([at(k), at(k + 1)]),
            None => {}
        }
        open = seen;
    }
    parts
}

/// The edges of a cell.
fn edges(film: &dyn Film<Solid>, cell: NodeId) -> Vec<[Vec3; 2]> {
    let mut to = Drawing::default();
    film.hierarchy().edges(cell).unwrap_or_else(|| {
        to.bounds(Layer::Nodes, Role::Ink, Subject::None, &film.hierarchy().bounds(cell));
        let ends = to.items.iter().filter_map(|i| {
            if let Mark::Line { points, .. } = &i.mark { Some(points.clone()) } else { None }
        });
        ends.flat_map(|p| p.windows(2).map(|w| [w[0], w[1]]).collect::<Vec<_>>()).collect()
    })
}

/// An edge, whichever way it runs, bit by bit.
fn key([a, b]: [Vec3; 2]) -> [[u32; 3]; 2] {
    let bits = |p: Vec3| p.to_array().map(f32::to_bits);
    let (a, b) = (bits(a), bits(b));
    if a <= b { [a, b] } else { [b, a] }
}

/// How far a cell may reach out of the room to be shown, sideways and up or down, m: the outermost ones reach
/// the corners of a far larger cube.
const OUTSIDE_M: [f32; 2] = [0.7, 1.75];

/// Whether a cell does not reach far out of the room.
fn is_inside(film: &dyn Film<Solid>, cell: NodeId) -> bool {
    let (room, cell) = (film.scene().bounds(), film.hierarchy().bounds(cell));
    let out = (room.min - cell.min).max(cell.max - room.max);
    let [sideways, upright] = OUTSIDE_M;
    out.x <= sideways && out.z <= sideways && out.y <= upright
}

/// Cells that are shown: projected, and in view but not projected, both only where something is in them.
fn cells(film: &dyn Film<Solid>) -> [Vec<NodeId>; 2] {
    let (stamps, end) = (Stamps::new(film), film.events().len());
    let of = |verdict: Verdict| {
        let all = (1..film.hierarchy().node_count() as u32).map(NodeId);
        all.filter(|&id| {
            stamps.node(id, end) == State::Decided(verdict)
                && film.hierarchy().held(id) > 0
                && is_inside(film, id)
        })
        .collect()
    };
    [of(Verdict::Visible), of(Verdict::OverBudget)]
}

/// The room without its ceiling, as far as it was drawn.
fn drawn(film: &dyn Film<Solid>) -> Vec<PrimId> {
    let (stamps, end, scene) = (Stamps::new(film), film.events().len(), film.scene());
    let top = scene.bounds().min.y + scene.bounds().size().y * CEILING;
    let of = |p: &PrimId| {
        stamps.prim(*p, end) == State::Decided(Verdict::Visible) && scene.prim_bounds(*p).min.y < top
    };
    scene.live().iter().copied().filter(of).collect()
}

/// The Eye and its view, to a depth.
fn eye(film: &dyn Film<Solid>, depth: f32, world: &mut Drawing<Vec3>) {
    let eye = &film.view().eye;
    let rim = Frustum::corners(&film.view().projection(), eye.near, depth);
    for i in 0..4 {
        world.line(Layer::Frustum, Role::Eye, Subject::Eye, [eye.position, rim[4 + i]]);
        world.line(Layer::Frustum, Role::Eye, Subject::Eye, [rim[4 + i], rim[4 + (i + 1) % 4]]);
    }
    world.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Dot { at: eye.position, radius_pt: 3.0 });
}

fn panel(label: String, image: Vec<u8>, world: Drawing<Vec3>, observer: &View<Solid>) -> Panel {
    let pixels = Pixels { width: observer.width, height: observer.height, rgba: image.into() };
    Panel { label, picture: Picture::Over(pixels, world, *observer) }
}

/// The room from above a corner with the cells that were not projected.
fn snapshot(tint: Tint, film: &dyn Film<Solid>, name: &str) -> Panel {
    let scene = film.scene();
    let bounds = scene.bounds();
    let from = bounds.center() + Vec3::new(-0.62, 1.9, 0.72) * bounds.size().with_y(bounds.size().y * 1.6);
    let observer = view(from, bounds.center() - Vec3::Y, 38.0, [440, 400]);
    let image = render(&**scene, &observer, &drawn(film));
    let mut world = Drawing::default();
    let [projected, rest] = cells(film);
    let mut done = BTreeSet::new();
    for &cell in &rest {
        for edge in edges(film, cell) {
            if done.insert(key(edge)) {
                let parts = seen_parts(&observer, &image, edge);
                parts
                    .into_iter()
                    .for_each(|part| world.line(Layer::Nodes, Role::Approximated, Subject::Node(cell), part));
            }
        }
    }
    eye(film, 3.0, &mut world);
    let label =
        format!("{name}: {} of {} occupied cells in view wait", rest.len(), projected.len() + rest.len());
    panel(label, shade(&image, &**scene, &observer, tint(Role::Paper)), world, &observer)
}

/// Where the plane at a height along an axis cuts a cell, given by its edges, around the cut; less than three
/// points where it does not.
pub fn cut(edges: &[[Vec3; 2]], axis: Vec3, height: f32) -> Vec<Vec3> {
    let mut points = Vec::new();
    for &[a, b] in edges {
        let (low, high) = (a.dot(axis), b.dot(axis));
        if (low < height) != (high < height) {
            points.push(a.lerp(b, (height - low) / (high - low)));
        }
    }
    let middle = points.iter().sum::<Vec3>() / points.len().max(1) as f32;
    let (across, along) = axis.any_orthonormal_pair();
    let angle = |p: &Vec3| (*p - middle).dot(along).atan2((*p - middle).dot(across));
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    points
}

/// The height of the cut above the floor: that of seats.
const CUT_M: f32 = 0.5;

/// The room from straight above with the cells cut at the height of seats.
fn plan(tint: Tint, film: &dyn Film<Solid>, name: &str) -> Panel {
    let scene = film.scene();
    let (bounds, height) = (scene.bounds(), scene.bounds().min.y + CUT_M);
    // So far above that it is almost a map.
    let from = bounds.center().with_y(bounds.min.y + 80.0);
    let target = bounds.center().with_y(bounds.min.y);
    let mut observer = view(from, target, 10.2, [440, 400]);
    observer.eye.up = Vec3::NEG_Z;
    let image = render(&**scene, &observer, &drawn(film));
    let mut world = Drawing::default();
    let (stamps, end) = (Stamps::new(film), film.events().len());
    for id in (1..film.hierarchy().node_count() as u32).map(NodeId) {
        let role = match stamps.node(id, end) {
            State::Decided(Verdict::Visible) => Role::Visible,
            State::Decided(Verdict::OverBudget) => Role::Approximated,
            _ => continue,
        };
        let points = cut(&edges(film, id), Vec3::Y, height);
        if points.len() > 2 && is_inside(film, id) {
            world.push(Layer::Areas, role, Subject::Node(id), Mark::Area(points));
        }
    }
    eye(film, 3.0, &mut world);
    panel(name.to_owned(), shade(&image, &**scene, &observer, tint(Role::Paper)), world, &observer)
}

/// Figures 1 and 2.
pub fn snapshots(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let tint = maker.tint;
    let scene = room()?;
    let sight = View { width: 256, height: 256, ..scene.paths()[0].views[FRAME] };
    let run = |tessellation: &str, leaf_size: &str| {
        let cells = [("tessellation", tessellation), ("leaf-size", leaf_size)];
        maker.film(
            &scene,
            &sight,
            LAYERED_PROJECTION,
            &[&cells[..], &[("budget", "25%"), ("rules", "paper"), ("seed", "1")]].concat(),
        )
    };
    let content = panels(
        TWO_COLUMNS_PT,
        2,
        &[
            snapshot(tint, &*run("delaunay", "14"), "(a) Delaunay"),
            snapshot(tint, &*run("octree", "14"), "(b) octree"),
            plan(tint, &*run("delaunay", "7"), "(c) Delaunay, from above, cut at the height of seats"),
            plan(tint, &*run("octree", "7"), "(d) octree, the same"),
        ],
    );
    let legend = vec![
        entry(Role::Visible, Swatch::Area, "cell projected: what is in it is drawn"),
        entry(Role::Approximated, Swatch::Area, "cell in view, not projected"),
        entry(Role::Eye, Swatch::Line, "the Eye's view, as far as 3 m"),
    ];
    let caption = format!(
        "A seminar room of {} triangles; the traversal has been stopped when a quarter of them was drawn, \
         and is looked at from outside, the ceiling left out. Above: what was drawn, and the edges of \
         occupied cells that still wait, as far as no drawn triangle hides them (leaf-size 14 %). Below: all \
         cells in view where a horizontal plane cuts them (leaf-size 7 %). Cells near the Eye and empty ones \
         come first; among the chairs many wait. Cells that reach far out of the room are not shown. Frame \
         {FRAME} of the flight.",
        scene.live().len()
    );
    Ok(maker.page(Paper::TwoColumns, "What was projected, seen from outside", legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_through_a_cube_runs_around_it() {
        let cube = crate::geometry::Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let corner = |i: usize| cube.corner(i);
        let edges: Vec<[Vec3; 2]> = (0..8usize)
            .flat_map(|i| {
                [1, 2, 4].into_iter().filter(move |b| i & b == 0).map(move |b| [corner(i), corner(i | b)])
            })
            .collect();
        let points = cut(&edges, Vec3::Y, 0.25);
        assert!(points.len() == 4 && points.iter().all(|p| p.y == 0.25), "{points:?}");
        assert!((0..4).all(|i| points[i].distance(points[(i + 1) % 4]) == 1.0), "{points:?}");
        assert!(cut(&edges, Vec3::Y, 2.0).is_empty());
    }

    #[test]
    fn lines_are_cut_where_something_is_before_them() {
        let observer = view(Vec3::ZERO, Vec3::NEG_Z, 60.0, [100, 100]);
        let mut image = Target::new(&observer);
        // The left half is covered at depth 2.
        (0..100 * 100).filter(|i| i % 100 < 50).for_each(|i| image.depth[i] = 0.5);
        let parts = seen_parts(&observer, &image, [Vec3::new(-1.0, 0.0, -5.0), Vec3::new(1.0, 0.0, -5.0)]);
        assert_eq!(parts.len(), 1);
        assert!(parts[0][0].x.abs() < 0.05 && parts[0][1].x == 1.0, "{parts:?}");
        let before = seen_parts(&observer, &image, [Vec3::new(-0.5, 0.0, -1.9), Vec3::new(0.5, 0.0, -1.9)]);
        assert_eq!(before, [[Vec3::new(-0.5, 0.0, -1.9), Vec3::new(0.5, 0.0, -1.9)]]);
        assert!(
            seen_parts(&observer, &image, [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 0.0, 2.0)]).is_empty()
        );
    }
}
