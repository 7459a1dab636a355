//! Triangles drawn at pixels whose centers lie beside them: the grid moved an edge over the centers. What is
//! said of a box has to hold there too.

use super::*;
use crate::geometry::Aabb;

/// A triangle with an edge less than half a grid step from the centers of some pixels, which lie outside; the
/// edge lies in a plane square to an axis, which is the front of the triangle's box or its back.
pub(crate) struct MovedEdge {
    /// Its corners.
    pub(crate) corners: [Vec3; 3],
    /// The pixels that it is drawn at though their centers are outside, with its depths there.
    pub(crate) pixels: Vec<([u32; 2], f32)>,
}

/// A view into any direction or along −z, from near the origin or far off.
pub(crate) fn any_view(dice: &mut Dice) -> View<Solid> {
    let far_off = [3.0, 3.0, 100.0][dice.below(3) as usize];
    let position = dice.point(far_off);
    let off = [Vec3::ZERO, dice.point(1.0)][dice.below(2) as usize];
    let fov = dice.between(0.1, 1.2) * [1.0, 2.0][dice.below(2) as usize];
    let eye =
        Eye { position, target: position + off - Vec3::Z * 1.1, up: Vec3::Y, fov, near: 0.05, far: 300.0 };
    let (width, height) = [(64, 64), (97, 53), (33, 130), (400, 40)][dice.below(4) as usize];
    View { eye, width, height }
}

impl MovedEdge {
    /// A random one, unless it would come too near or covers none of the centers.
    pub(crate) fn new(dice: &mut Dice, view: &View<Solid>) -> Option<Self> {
        let sight = Sight::new(view);
        // Centers from one on, along a way of whole pixels.
        let first = [view.width, view.height].map(|side| f64::from(dice.below(side)) + 0.5);
        let way = [(); 2].map(|()| f64::from(dice.below(7)) - 3.0);
        let count = 1 + dice.below(9);
        let long = way[0].hypot(way[1]);
        if long == 0.0 {
            return None;
        }
        // The edge lies off them to one side, on which the third corner is.
        let inward = [-way[1] / long, way[0] / long];
        let near_by = f64::from(dice.unit()) * 0.5 / 256.0;
        let at = |along: f64, off: f64| [0, 1].map(|k| first[k] + way[k] * along + inward[k] * off);
        let n = f64::from(count);
        let [a, b] = [sight.ray(at(0.0, near_by)), sight.ray(at(n, near_by))];
        let axis = dice.below(3) as usize;
        let depth = f64::from(dice.between(1.0, 20.0));
        let plane = (sight.eye[axis] + a[axis] * depth) as f32;
        let offset = f64::from(plane) - sight.eye[axis];
        let on_plane = |ray: DVec3| {
            let mut point = (sight.eye + ray * (offset / ray[axis])).as_vec3();
            point[axis] = plane;
            point
        };
        // The third corner makes its depth plane about as steep as it may be and still go through the places
        // before snapping: `1/w` changes by 1/32 of the least a pixel.
        let high = f64::from(dice.between(2.0, 25.0));
        let steep = 1.0 + high * f64::from(dice.between(-0.2, 1.1)) / 32.0;
        let third = sight.point(at(n * f64::from(dice.unit()), high), depth * steep);
        let corners = [on_plane(a), on_plane(b), third];
        let w = |p: Vec3| view.projection().depth(p);
        if !Aabb::of(corners).corners().all(|p| (0.4..200.0).contains(&w(p))) {
            return None;
        }
        let is_beside = |[x, y]: [u32; 2]| {
            let off = [f64::from(x) + 0.5 - first[0], f64::from(y) + 0.5 - first[1]];
            off[0] * way[1] == off[1] * way[0] && (off[0] * way[0] + off[1] * way[1]) >= 0.0
        };
        let (scene, mut pixels) = (soup(&[corners]), Vec::new());
        Solid::fragments(&scene, view, PrimId(0), &Options::default(), &mut |at, depth| {
            let pixel = [at as u32 % view.width, at as u32 / view.width];
            if is_beside(pixel) {
                pixels.push((pixel, depth));
            }
        });
        (!pixels.is_empty()).then_some(Self { corners, pixels })
    }
    pub(crate) fn bounds(&self) -> Aabb<Vec3> {
        Aabb::of(self.corners)
    }
}

/// A wall across the image at view depth `w` that leaves out one pixel.
pub(crate) fn wall_but_for(view: &View<Solid>, [x, y]: [u32; 2], w: f64) -> Vec<[Vec3; 3]> {
    let sight = Sight::new(view);
    let [x, y, right, down] = [x, y, view.width + 1, view.height + 1].map(f64::from);
    let parts = [
        [-1.0, x, -1.0, down],
        [x + 1.0, right, -1.0, down],
        [x, x + 1.0, -1.0, y],
        [x, x + 1.0, y + 1.0, down],
    ];
    let corner = |x: f64, y: f64| sight.point([x, y], w);
    parts
        .iter()
        .flat_map(|&[x0, x1, y0, y1]| {
            let [a, b, c, d] = [corner(x0, y0), corner(x1, y0), corner(x1, y1), corner(x0, y1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// Before a triangle stands a wall with a hole of one pixel, at which the triangle is drawn. Its box is not
/// hidden, whether the pixel's center lies beside the box by up to half a grid step, or the depth there is
/// that of the triangle's plane followed so far.
#[test]
fn a_box_shows_where_its_triangle_does() {
    let (mut dice, mut holes) = (Dice::new(76), 0);
    for _ in 0..TRIANGLES {
        let view = any_view(&mut dice);
        let Some(moved) = MovedEdge::new(&mut dice, &view) else { continue };
        let bounds = moved.bounds();
        let nearest = bounds.corners().map(|p| view.projection().depth(p)).fold(f32::MAX, f32::min);
        for &(pixel, depth) in &moved.pixels {
            holes += 1;
            let mut triangles = wall_but_for(&view, pixel, f64::from(nearest) * 0.5);
            triangles.push(moved.corners);
            let scene = soup(&triangles);
            let clusters = Clusters::new(&scene, BOTH_SIDES, [scene.live()]);
            for isa in [Isa::Portable, Isa::best()] {
                let (mut tiles, mut answers) = (Tiles::default(), Vec::new());
                tiles.clear(&view, true);
                tiles.draw(&clusters, false, isa);
                tiles.hides_all(&Boxes::new([bounds]), true, isa, &mut answers);
                let what = format!("{:?} at {pixel:?}, {depth} deep: {view:?}", moved.corners);
                assert_eq!(answers, [Answer::Visible], "{what}");
            }
        }
    }
    assert!(holes > TRIANGLES / 4, "{holes} holes");
}
const TRIANGLES: u32 = 2000;
