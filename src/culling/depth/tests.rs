//! Queries against brute force, and drawing one by one against drawing at once.

use std::sync::Arc;

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::planes::{Planes, middle};
use super::query::Listener;
use super::*;
use crate::geometry::dice::Dice;
use crate::geometry::{Aabb, Eye, Flat, Footprint, NodeId, PixelRect, Solid, Space, Vector, View};
use crate::raster::tests::moved_edge::{MovedEdge, any_view};
use crate::raster::{Clusters, Hears, Options, PyramidCell, Read, Target, render};
use crate::scene::{Parts, Scene, Surfaces};

fn soup<S: Space>(rng: &mut Pcg32, n: u32, make: fn([u32; 3]) -> S::Corners) -> Arc<Scene<S>> {
    let mut unit = || (rng.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
    let mut points = Vec::new();
    for k in 0..n {
        let middle = S::Vector::from_fn(|_| unit() * 20.0 - 10.0);
        let size = [0.3, 2.0, 8.0][k as usize % 3];
        points.extend((0..S::CORNERS).map(|_| middle + S::Vector::from_fn(|_| (unit() - 0.5) * size)));
    }
    let corner = |k: u32| k * S::CORNERS as u32;
    Arc::new(
        Scene::new(Parts::simple(
            "soup",
            points,
            (0..n).map(|k| make([corner(k), corner(k) + 1, corner(k) + 2])).collect(),
        ))
        .expect("valid"),
    )
}

/// Hears nothing.
struct Deaf;

impl Listener for Deaf {
    fn compares(&mut self) {}
    fn refreshes(&mut self, _: PyramidCell) {}
    fn reads(&mut self, _: Read) {}
}

impl Hears for Deaf {
    const LISTENS: bool = false;
    fn refreshes(&mut self, _: PyramidCell) {}
    fn reads(&mut self, _: Read) {}
}

/// The outside of a box: points and primitives.
type Shell<S> = fn(&Aabb<<S as Space>::Vector>) -> (Vec<<S as Space>::Vector>, Vec<<S as Space>::Corners>);

/// How many boxes were hidden, changed no pixel, and were hidden by their rectangle.
#[derive(Default)]
struct Counted {
    hidden: u32,
    unseen: u32,
    by_rectangle: u32,
}

/// A scene drawn for a view, and the plain image of it.
struct Drawn<S: Faces> {
    view: View<S>,
    buffer: Buffer<S>,
    plain: Target,
}

impl<S: Faces> Drawn<S> {
    fn new(rng: &mut Pcg32, make: fn([u32; 3]) -> S::Corners) -> Self {
        let scene = soup::<S>(rng, 60, make);
        let view = crate::scene::random_views(&scene, 1, u64::from(rng.next_u32()))[0];
        let width = 1 + rng.next_u32() % 150;
        let height = if S::CORNERS == 2 { 1 } else { 1 + rng.next_u32() % 150 };
        let view = View { width, height, ..view };
        let mut buffer = Buffer::default();
        buffer.clear(&view);
        for prims in scene.live().chunks(25) {
            buffer.step(Step::Draw { scene: &scene, prims, options: Options::default() });
        }
        let plain = render(&scene, &view, scene.live());
        assert_eq!(plain, *buffer.target());
        Self { view, buffer, plain }
    }
    /// Whether drawing the outside of a box changes a pixel. Ties go to the lower id, so a tie may show as
    /// well; both count as a change.
    fn changes(&self, bounds: &Aabb<S::Vector>, shell: Shell<S>) -> bool {
        let (points, prims) = shell(bounds);
        let outside = Scene::<S>::new(Parts::simple("shell", points, prims)).expect("valid");
        let (mut with, plain) = (self.plain.clone(), &self.plain);
        S::draw(&mut with, &outside, &self.view, outside.live(), &Options::default());
        (0..with.depth.len()).any(|i| with.depth[i] != plain.depth[i] || with.item[i] != plain.item[i])
    }
    /// Whether its planes say that a box may show at any single pixel.
    fn may_show(&self, bounds: &Aabb<S::Vector>, pixels: PixelRect, nearest: f32) -> bool {
        let planes = Planes::new(self.buffer.rays(), bounds);
        let at = |x: u32, y: u32| {
            let (middles, half) = middle(PyramidCell { level: 0, x: x as u16, y: y as u16 });
            let over = planes.over(&middles, half, nearest);
            over.meets[0] && over.up[0] >= self.plain.depth[(y * self.view.width + x) as usize]
        };
        (pixels.y0..pixels.y1).any(|y| (pixels.x0..pixels.x1).any(|x| at(x, y)))
    }
    /// Queries a box in every way.
    fn query(&mut self, bounds: &Aabb<S::Vector>, shell: Shell<S>, counted: &mut Counted) {
        let view = self.view;
        let image = match footprint(&view, &view.projection(), bounds) {
            Footprint::Seen(image) => image,
            Footprint::CrossesNear | Footprint::Outside => return,
        };
        let changed = self.changes(bounds, shell);
        let (nearest, pixels) = (image.nearest, image.pixels);
        let mut query = |whole: &Aabb<S::Vector>| {
            Query::new(&mut self.buffer, nearest, Deaf).planes(bounds, whole, pixels)
        };
        let answer = query(bounds);
        // What is drawn with it may come nearer, so less is hidden.
        let larger = Aabb { min: bounds.min, max: bounds.max + bounds.size() };
        assert!(!query(&larger).is_hidden || answer.is_hidden);
        // A pixel of the pyramid decides as it would by itself.
        assert_eq!(answer.is_hidden, !self.may_show(bounds, pixels, nearest), "{bounds:?}, pixel by pixel");
        assert!(!answer.is_hidden || !changed, "{bounds:?} is called hidden and shows");
        let by_rectangle = Query::new(&mut self.buffer, nearest, Deaf).rectangle(pixels).is_hidden;
        assert!(!by_rectangle || answer.is_hidden, "what hides the rectangle, hides the box");
        if let Footprint::Seen(sphere) = project_sphere(&view, bounds) {
            let (r, s) = (image.pixels, sphere.pixels);
            assert!(
                r.is_empty() || s.x0 <= r.x0 && s.x1 >= r.x1 && s.y0 <= r.y0 && s.y1 >= r.y1,
                "the sphere is about the box"
            );
            assert!(sphere.nearest >= image.nearest);
        }
        counted.hidden += u32::from(answer.is_hidden);
        counted.by_rectangle += u32::from(by_rectangle);
        counted.unseen += u32::from(!changed);
    }
}

/// A box that a query calls hidden changes no pixel when its outside is drawn after the rest; and of the
/// boxes that change none, most are called hidden.
fn queries_against_drawing<S: Faces>(seed: u64, make: fn([u32; 3]) -> S::Corners, shell: Shell<S>) {
    let (mut rng, mut counted) = (Pcg32::new(seed, 9), Counted::default());
    for _ in 0..60 {
        let mut drawn = Drawn::<S>::new(&mut rng, make);
        for _ in 0..40 {
            let mut unit = || (rng.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
            let middle = S::Vector::from_fn(|_| unit() * 24.0 - 12.0);
            let half = S::Vector::from_fn(|_| unit() * unit() * 3.0);
            let bounds = Aabb { min: middle - half, max: middle + half };
            drawn.query(&bounds, shell, &mut counted);
        }
    }
    let Counted { hidden, unseen, by_rectangle } = counted;
    assert!(hidden > 50 && hidden * 10 >= unseen * 8, "{hidden} of {unseen} unseen boxes are found");
    assert!(by_rectangle < hidden, "planes say more than the rectangle: {by_rectangle} of {hidden}");
}

#[test]
fn what_a_query_calls_hidden_does_not_show_in_flatland() {
    fn shell(b: &Aabb<glam::Vec2>) -> (Vec<glam::Vec2>, Vec<[u32; 2]>) {
        (b.corners().collect(), vec![[0, 1], [1, 3], [3, 2], [2, 0]])
    }
    queries_against_drawing::<Flat>(1, |[a, b, _]| [a, b], shell);
}

#[test]
fn what_a_query_calls_hidden_does_not_show_in_space() {
    fn shell(b: &Aabb<glam::Vec3>) -> (Vec<glam::Vec3>, Vec<[u32; 3]>) {
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        (b.corners().collect(), faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect())
    }
    queries_against_drawing::<Solid>(2, |c| c, shell);
}

/// Boxes of all sizes just before, at and just behind a wall that fills the image: only the last are hidden.
#[test]
fn a_wall_hides_what_lies_behind_it_only() {
    let points = [(-90.0, -90.0), (90.0, -90.0), (90.0, 90.0), (-90.0, 90.0)]
        .map(|(x, y)| Vec3::new(x, y, -10.0))
        .into();
    let scene =
        Scene::<Solid>::new(Parts::simple("a wall", points, vec![[0, 1, 2], [0, 2, 3]])).expect("valid");
    let eye = Eye {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        fov: std::f32::consts::FRAC_PI_2,
        near: 0.5,
        far: 100.0,
    };
    let clusters = Arc::new(Clusters::new(&scene, Surfaces::default(), [scene.live(), &[]]));
    let mut tiled = Tiled::<Solid>::default();
    tiled.clear(&View { eye, width: 200, height: 150 }, &clusters, scene.prim_count());
    tiled.step(TileStep::Draw(NodeId(0), true));
    let at = |x: f32| Aabb { min: Vec3::new(x, -1.0, -13.0), max: Vec3::new(x + 1.0, 1.0, -11.0) };
    assert_eq!(tiled.hides_box(&at(50.0), true, &mut Deaf), None, "beside the view");
    let through = Aabb { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) };
    assert_eq!(tiled.hides_box(&through, true, &mut Deaf), Some((false, 2.0)), "it reaches the near plane");
    for half in [0.3, 1.0, 4.0] {
        for (x, y) in [(0.0, 0.0), (-3.0, 2.0), (5.0, -4.0), (7.0, 6.0)] {
            for (depth, is_hidden) in
                [(9.95, false), (9.999, false), (10.0, false), (10.001, true), (12.0, true)]
            {
                let bounds = Aabb {
                    min: Vec3::new(x - half, y - half, -depth - half),
                    max: Vec3::new(x + half, y + half, -depth),
                };
                let told = tiled.hides_box(&bounds, true, &mut Deaf).map(|(is_hidden, _)| is_hidden);
                assert_eq!(told, Some(is_hidden), "{half} wide at ({x}, {y}), {depth} deep");
            }
        }
    }
}

/// A triangle is drawn at pixels whose centers lie beside it by up to half a grid step, as deep as its plane
/// is there, which may come nearer than its box by `DEPTH_SLACK`. Each of these pixels shows its box.
#[test]
fn a_box_shows_at_each_pixel_beside_its_triangle() {
    let (mut dice, mut pixels) = (Dice::new(10), 0);
    for _ in 0..10_000 {
        let view = any_view(&mut dice);
        let Some(moved) = MovedEdge::new(&mut dice, &view) else { continue };
        let parts = Parts::simple("beside", moved.corners.into(), vec![[0, 1, 2]]);
        let scene = Scene::<Solid>::new(parts).expect("valid");
        let mut buffer = Buffer::default();
        buffer.clear(&view);
        buffer.step(Step::Draw { scene: &scene, prims: scene.live(), options: Options::default() });
        let bounds = moved.bounds();
        let Footprint::Seen(image) = footprint(&view, &view.projection(), &bounds) else { continue };
        for &([x, y], depth) in &moved.pixels {
            pixels += 1;
            let pixel = PixelRect { x0: x, x1: x + 1, y0: y, y1: y + 1 };
            let answer = Query::new(&mut buffer, image.nearest, Deaf).planes(&bounds, &bounds, pixel);
            assert!(!answer.is_hidden, "{bounds:?} at ({x}, {y}), where it holds {depth}: {view:?}");
        }
    }
    assert!(pixels > 5000, "{pixels} pixels");
}

/// Tiles that are refreshed between draws, a window: every step, replayed one primitive at a time, leads to
/// the same image and the same pyramid.
#[test]
fn drawing_one_by_one_leads_where_drawing_at_once_does() {
    let mut rng = Pcg32::new(8, 9);
    let scene = soup::<Solid>(&mut rng, 200, |c| c);
    for (view, has_window) in
        crate::scene::random_views(&scene, 8, 2).into_iter().zip([true, false].repeat(4))
    {
        let view = View { width: 70, height: 50, ..view };
        let [mut at_once, mut one_by_one] = [(); 2].map(|()| {
            let mut buffer = Buffer::<Solid>::default();
            buffer.clear(&view);
            buffer
        });
        let window = has_window.then_some(PixelRect { x0: 10, x1: 60, y0: 0, y1: 33 });
        let options = Options { window, ..Options::default() };
        for (k, prims) in scene.live().chunks(40).enumerate() {
            let refresh = Step::Refresh(PyramidCell { level: 4, x: k as u16, y: 1 });
            at_once.step(refresh);
            one_by_one.step(refresh);
            at_once.step(Step::Draw { scene: &scene, prims, options });
            for prims in prims.chunks(1) {
                one_by_one.step(Step::Draw { scene: &scene, prims, options });
            }
            assert_eq!(at_once, one_by_one, "after {k} draws");
        }
    }
}
