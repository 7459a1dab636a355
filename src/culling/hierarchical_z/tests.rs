//! The paper's worked example, and queries against brute force.

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::anatomy::figure_1;
use super::explain::Evidence;
use super::*;
use crate::culling::depth::{Outcome, hides};
use crate::geometry::{Eye, Flat, Solid};
use crate::method::{Recorder, Unobserved};
use crate::raster::{Target, render};
use crate::scene::Parts;

/// The method on a scene, with its memory and the state of its last frame.
#[derive(Clone)]
struct Tried<'a, S: Faces> {
    index: &'a Octree<S::Vector>,
    scene: &'a Scene<S>,
    params: &'a Params,
    memory: Memory,
    buffer: Buffer<S>,
    depths_only: bool,
}

impl<'a, S: Faces> Tried<'a, S> {
    fn new(index: &'a Octree<S::Vector>, scene: &'a Scene<S>, params: &'a Params) -> Self {
        let (memory, buffer) = (Memory::default(), Buffer::default());
        Self { index, scene, params, memory, buffer, depths_only: false }
    }
    fn frame<'b>(&'b self, view: &'b View<S>) -> Frame<'b, S, HierarchicalZ> {
        let Self { index, scene, params, depths_only, .. } = *self;
        Frame { index, scene, view, params, limit: None, depths_only }
    }
    fn cull<O: Observer<Evidence<S>>>(&mut self, view: &View<S>, watch: &mut O) -> DrawList<S> {
        let (mut memory, mut buffer) = (std::mem::take(&mut self.memory), std::mem::take(&mut self.buffer));
        let (frame, mut list) = (self.frame(view), DrawList::default());
        buffer.begin(&frame);
        HierarchicalZ::cull(&frame, &mut memory, &mut buffer, &mut list, watch);
        (self.memory, self.buffer) = (memory, buffer);
        list
    }
}

fn built<S: Faces>(scene: &Arc<Scene<S>>, params: &Params) -> Octree<S::Vector> {
    let index = <HierarchicalZ as Method<S>>::build(scene, params, None, &crate::scene::Quiet);
    index.expect("nothing saved").expect("not cancelled")
}

/// What a face at depth 6 over some pixels of Figure 1 is told, as level, cell value and outcome.
fn face_at_6(pixels: PixelRect) -> (bool, Vec<(u8, f32, Outcome)>) {
    let (scene, view) = figure_1().expect("a valid scene");
    let mut buffer = Buffer::default();
    buffer.clear(&view);
    buffer.draw(&scene, scene.live(), &Options::default());
    buffer.refresh_all();
    let mut recorder: Recorder<Evidence<Solid>> = Recorder::new(1000);
    let mut query = Query::new(&mut buffer, 1.0 / 6.0, Asked::new(NodeId(0), 0, &mut recorder));
    let is_hidden = query.face(0, &FaceImage::rectangle(pixels));
    let reads = recorder.notes.iter().filter_map(|n| match n {
        Evidence::Read(_, r) => Some((r.cell.level, (1.0 / r.held).round(), r.outcome)),
        _ => None,
    });
    (is_hidden, reads.collect())
}

#[test]
fn figures_1_and_2_of_georges_1995() {
    let (scene, view) = figure_1().expect("a valid scene");
    let image = render(&scene, &view, scene.live());
    let depths: Vec<f32> = image.depth.iter().map(|d| (1.0 / d).round()).collect();
    assert_eq!(depths, [4.0, 9.0, 8.0, 8.0, 4.0, 5.0, 1.0, 3.0, 6.0, 2.0, 2.0, 4.0, 2.0, 2.0, 2.0, 4.0]);
    use Outcome::{Behind, Descends, Shows};
    // Over the left column of the upper left quarter: cell 9 does not hide it, the samples 4 and 4 do.
    let left = PixelRect { x0: 0, x1: 1, y0: 0, y1: 2 };
    assert_eq!(face_at_6(left), (true, vec![(1, 9.0, Descends), (0, 4.0, Behind), (0, 4.0, Behind)]));
    // Over the upper row: sample 9 shows it.
    let upper = PixelRect { x0: 0, x1: 2, y0: 0, y1: 1 };
    assert_eq!(face_at_6(upper), (false, vec![(1, 9.0, Descends), (0, 4.0, Behind), (0, 9.0, Shows)]));
    // Over the lower half: from the root, then cell 6, whose sample 6 is not nearer, though only just.
    let lower = PixelRect { x0: 0, x1: 4, y0: 2, y1: 4 };
    assert_eq!(face_at_6(lower), (false, vec![(2, 9.0, Descends), (1, 6.0, Shows)]));
    // Over the lower right quarter: one look.
    assert_eq!(face_at_6(PixelRect { x0: 2, x1: 4, y0: 2, y1: 4 }), (true, vec![(1, 4.0, Behind)]));
}

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

/// The outside of a box: points and primitives.
type Shell<S> = fn(&Aabb<<S as Space>::Vector>) -> (Vec<<S as Space>::Vector>, Vec<<S as Space>::Corners>);

/// A box that a query calls hidden changes no pixel when its outside is drawn after the rest; and of the
/// boxes that change none, most are called hidden.
fn queries_against_drawing<S: Faces>(seed: u64, make: fn([u32; 3]) -> S::Corners, shell: Shell<S>) {
    let mut rng = Pcg32::new(seed, 9);
    let (mut hidden, mut unseen, mut rectangle_hidden) = (0, 0, 0);
    for _ in 0..60 {
        let scene = soup::<S>(&mut rng, 60, make);
        let view = crate::scene::random_views(&scene, 1, u64::from(rng.next_u32()))[0];
        let view = View {
            width: 1 + rng.next_u32() % 150,
            height: if S::CORNERS == 2 { 1 } else { 1 + rng.next_u32() % 150 },
            ..view
        };
        let mut buffer = Buffer::default();
        buffer.clear(&view);
        for part in scene.live().chunks(25) {
            buffer.draw(&scene, part, &Options::default());
        }
        let drawn = render(&scene, &view, scene.live());
        assert_eq!(drawn, *buffer.target());
        for _ in 0..40 {
            let mut unit = || (rng.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
            let middle = S::Vector::from_fn(|_| unit() * 24.0 - 12.0);
            let half = S::Vector::from_fn(|_| unit() * unit() * 3.0);
            let bounds = Aabb { min: middle - half, max: middle + half };
            let told = hides(&mut buffer, &bounds, Nobody).map(|answer| answer.is_hidden);
            let image = match footprint(&view, &view.projection(), &bounds) {
                Footprint::Seen(image) => image,
                Footprint::CrossesNear => {
                    assert_ne!(told, Some(true), "{bounds:?} reaches the near plane");
                    continue;
                }
                Footprint::Outside => {
                    assert_eq!(told, None, "{bounds:?} is outside");
                    continue;
                }
            };
            let (points, prims) = shell(&bounds);
            let outside = Scene::<S>::new(Parts::simple("shell", points, prims)).expect("valid");
            let mut with = drawn.clone();
            S::draw(&mut with, &outside, &view, outside.live(), &Options::default());
            // Ties go to the lower id, so a tie may show as well; both count as a change.
            let changed = |t: &Target| {
                (0..t.depth.len()).any(|i| t.depth[i] != drawn.depth[i] || t.item[i] != drawn.item[i])
            };
            let answer = Query::new(&mut buffer, image.nearest, Nobody).faces(&bounds, &image, &view);
            assert!(!answer.is_hidden || !changed(&with), "{bounds:?} is called hidden and shows");
            assert!(
                told != Some(!answer.is_hidden) && (told.is_some() || !changed(&with)),
                "{bounds:?}: asked for at once and by parts"
            );
            let mut query = Query::new(&mut buffer, image.nearest, Nobody);
            let by_rectangle = query.face(0, &FaceImage::rectangle(image.pixels));
            assert!(!by_rectangle || answer.is_hidden, "what the rectangle hides, the faces do");
            if let Footprint::Seen(sphere) = project_sphere(&view, &bounds) {
                let (r, s) = (image.pixels, sphere.pixels);
                assert!(
                    r.is_empty() || s.x0 <= r.x0 && s.x1 >= r.x1 && s.y0 <= r.y0 && s.y1 >= r.y1,
                    "the sphere is about the box"
                );
                assert!(sphere.nearest >= image.nearest);
            }
            hidden += u32::from(answer.is_hidden);
            rectangle_hidden += u32::from(by_rectangle);
            unseen += u32::from(!changed(&with));
        }
    }
    assert!(hidden > 50 && hidden * 10 >= unseen * 8, "{hidden} of {unseen} unseen boxes are found");
    assert!(rectangle_hidden <= hidden);
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

/// Frames along a flight with jumps: each image is the plain one, and with coherence the list settles.
fn flights<S: Faces>(make: fn([u32; 3]) -> S::Corners) {
    let mut rng = Pcg32::new(5, 9);
    let scene = soup::<S>(&mut rng, 300, make);
    for (form, interval) in [(0, 1), (0, 30), (1, 1), (1, 30)] {
        let params = Params { form, check_interval: interval, leaf_primitives: 4, ..Params::default() };
        let index = built::<S>(&scene, &params);
        let mut tried = Tried::new(&index, &scene, &params);
        let mut bare = Tried { depths_only: true, ..tried.clone() };
        for view in crate::scene::random_views(&scene, 12, 3) {
            for step in 0..4 {
                let mut view = View { width: 80, height: view.height.min(60), ..view };
                view.eye.position = view.eye.position + view.eye.forward() * (0.05 * step as f32);
                view.eye.target = view.eye.position + view.eye.forward();
                let list = tried.cull(&view, &mut Unobserved);
                let plain = render(&scene, &view, scene.live());
                assert_eq!(render(&scene, &view, &list.prims), plain, "form {form}, interval {interval}");
                assert_eq!(*tried.buffer.target(), plain, "form {form}, interval {interval}: its own image");
                let same = bare.cull(&view, &mut Unobserved);
                assert_eq!(list, same, "form {form}, interval {interval}: by depths alone");
                assert!(bare.buffer.target().item.is_empty() && bare.buffer.target().depth == plain.depth);
            }
        }
    }
}

#[test]
fn every_image_of_a_flight_with_jumps_is_the_plain_one() {
    flights::<Flat>(|[a, b, _]| [a, b]);
    flights::<Solid>(|c| c);
}

/// The simulated machine draws the plain image however structures and regions are dealt, says what it
/// answers, and takes as long as its busiest unit.
fn machines<S: Faces>(make: fn([u32; 3]) -> S::Corners) {
    let mut rng = Pcg32::new(6, 9);
    let scene = soup::<S>(&mut rng, 200, make);
    for (case, (distribution, allocation)) in [(0, 0), (1, 0), (2, 0), (0, 1), (2, 1)].into_iter().enumerate()
    {
        let machine = Machine {
            processors: 3,
            renderers: 2,
            distribution,
            allocation,
            overlap: case % 2 == 0,
            ..Machine::default()
        };
        let params = Params { machine, leaf_primitives: 4, check_interval: 3, ..Params::default() };
        let index = built::<S>(&scene, &params);
        let (mut tried, mut hidden, mut work) = (Tried::new(&index, &scene, &params), 0, 0);
        for view in crate::scene::random_views(&scene, 6, 4) {
            let view = View { width: 300, height: view.height.min(200), ..view };
            let (mut recorder, mut same) = (Recorder::new(usize::MAX), tried.clone());
            let list = tried.cull(&view, &mut recorder);
            let plain = render(&scene, &view, scene.live());
            assert_eq!(render(&scene, &view, &list.prims), plain, "case {case}");
            let again = same.cull(&view, &mut Unobserved);
            assert_eq!(list, again, "case {case}: a frame is the same again, unobserved");
            let mut told = vec![None; scene.prim_count()];
            for event in &recorder.events {
                if let Event::DecidedPrim(p, v) = event {
                    told[p.at()].get_or_insert(*v);
                }
            }
            let mut drawn: Vec<PrimId> =
                scene.live().iter().copied().filter(|p| told[p.at()] == Some(Verdict::Visible)).collect();
            hidden += told.iter().filter(|t| **t == Some(Verdict::Hidden)).count();
            drawn.sort_unstable();
            assert_eq!(drawn, list.ascending(), "case {case}: told and answered");
            assert!(told.iter().all(Option::is_some), "case {case}: all is told");
            work += work_of_renderers(&recorder.notes, case);
        }
        assert!(hidden > 20 && work > 50, "case {case}: {hidden} hidden, {work} jobs");
    }
}

fn work_of_renderers<S: Faces>(notes: &[Evidence<S>], case: usize) -> usize {
    let mut work: Vec<_> = notes
        .iter()
        .filter_map(|n| if let Evidence::Worked(w) = n { Some((w.unit, w.from, w.to)) } else { None })
        .collect();
    work.sort();
    assert!(
        work.windows(2).all(|w| w[0].0 != w[1].0 || w[0].2 <= w[1].1),
        "case {case}: no unit does two things at a time"
    );
    work.iter().filter(|w| matches!(w.0, super::simulation::Unit::Renderer(_))).count()
}

#[test]
fn the_simulated_machine_draws_the_plain_image() {
    machines::<Flat>(|[a, b, _]| [a, b]);
    machines::<Solid>(|c| c);
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
    let mut buffer = Buffer::default();
    buffer.clear_depths(&View { eye, width: 200, height: 150 });
    buffer.draw(&scene, scene.live(), &Options::default());
    for half in [0.3, 1.0, 4.0] {
        for (x, y) in [(0.0, 0.0), (-3.0, 2.0), (5.0, -4.0), (7.0, 6.0)] {
            for (depth, is_hidden) in
                [(9.95, false), (9.999, false), (10.0, false), (10.001, true), (12.0, true)]
            {
                let bounds = Aabb {
                    min: Vec3::new(x - half, y - half, -depth - half),
                    max: Vec3::new(x + half, y + half, -depth),
                };
                let told = hides(&mut buffer, &bounds, Nobody).map(|a| a.is_hidden);
                assert_eq!(told, Some(is_hidden), "{half} wide at ({x}, {y}), {depth} deep");
            }
        }
    }
}

/// A structure over two regions of the screen, hidden in one and seen in the other: it is drawn whichever
/// answers last.
#[test]
fn a_structure_shows_if_one_region_says_so() {
    for side in [-1.0, 1.0] {
        let mut points: Vec<_> = [(0.0, -6.0), (0.0, 6.0), (6.0, 6.0), (6.0, -6.0)]
            .map(|(x, y)| glam::vec3(x * side, y, -5.0))
            .into();
        let mut prims = vec![[0, 1, 2], [0, 2, 3]];
        for k in 0..6 {
            let (x, first) = (k as f32 * 0.4 - 1.2, points.len() as u32);
            points.extend([(x, 0.5), (x + 0.4, 0.5), (x, 1.5)].map(|(x, y)| glam::vec3(x, y, -10.0)));
            prims.push([first, first + 1, first + 2]);
        }
        let scene = Arc::new(
            Scene::<Solid>::new(Parts::simple("a row half behind a wall", points, prims)).expect("valid"),
        );
        for (renderers, overlap) in [(1, true), (2, true), (2, false)] {
            let machine =
                Machine { processors: 2, renderers, overlap, farthest_first: false, ..Machine::default() };
            let params = Params { machine, leaf_primitives: 6, ..Params::default() };
            let index = built::<Solid>(&scene, &params);
            let (mut tried, mut asked) = (Tried::new(&index, &scene, &params), Recorder::new(usize::MAX));
            // First the row lies beyond the far plane, so that the wall is on the list alone.
            for far in [8.0, 100.0] {
                let eye = Eye {
                    position: Vec3::ZERO,
                    target: Vec3::NEG_Z,
                    up: Vec3::Y,
                    fov: std::f32::consts::FRAC_PI_2,
                    near: 0.5,
                    far,
                };
                let view = View { eye, width: 256, height: 128 };
                let list = tried.cull(&view, &mut asked);
                assert_eq!(
                    render(&scene, &view, &list.prims),
                    render(&scene, &view, scene.live()),
                    "wall at {side}, {renderers} renderers"
                );
            }
            let answers = asked
                .notes
                .iter()
                .filter(|n| matches!(n, Evidence::Worked(w) if w.job == super::simulation::Job::Answer));
            let told: Vec<u32> =
                answers.map(|n| if let Evidence::Worked(w) = n { w.count } else { 0 }).collect();
            assert!(told.contains(&0) && told.contains(&1), "one region hides it and one shows it: {told:?}");
        }
    }
}

#[test]
fn threads_leave_no_trace() {
    let mut rng = Pcg32::new(7, 9);
    let scene = soup::<Solid>(&mut rng, 6000, |c| c);
    for form in [0, 1] {
        let params = Params { form, ..Params::default() };
        let index = built::<Solid>(&scene, &params);
        let views = crate::scene::random_views(&scene, 5, 4);
        let run = || {
            let mut tried = Tried::new(&index, &scene, &params);
            views.iter().map(|view| tried.cull(view, &mut Unobserved)).collect::<Vec<_>>()
        };
        let alone = run();
        for threads in [2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            assert_eq!(pool.install(run), alone, "form {form}, {threads} threads");
        }
    }
}
