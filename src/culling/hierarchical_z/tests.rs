//! The paper's worked example, and whole frames against plain drawing.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::parts::figure_1;
use super::*;
use crate::culling::depth::{DepthNote, FaceImage, Outcome, Query, QueryReporter};
use crate::geometry::{Flat, NodeId, PixelRect, Solid, Space, Vector, View};
use crate::method::{Recorder, Unobserved};
use crate::raster::{Options, render};
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
    let reporter = QueryReporter::new(NodeId(0), [0, 0], &mut recorder);
    let mut query = Query::new(&mut buffer, 1.0 / 6.0, reporter);
    let is_hidden = query.face(0, &FaceImage::rectangle(pixels));
    let reads = recorder.notes.iter().filter_map(|n| match n {
        Evidence::Depth(DepthNote::Read(_, r)) => Some((r.cell.level, (1.0 / r.held).round(), r.outcome)),
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

/// Frames along a flight with jumps: each image is the plain one, and with coherence the list settles.
fn flights<S: Faces>(make: fn([u32; 3]) -> S::Corners) {
    let mut rng = Pcg32::new(5, 9);
    let scene = soup::<S>(&mut rng, 300, make);
    for (form, interval) in
        [Form::Incremental, Form::TwoPass].into_iter().flat_map(|form| [(form, 1), (form, 30)])
    {
        let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
        let params = Params { form, check_interval: interval, cubes, ..Params::default() };
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
                assert_eq!(render(&scene, &view, &list.prims), plain, "form {form:?}, interval {interval}");
                assert_eq!(
                    *tried.buffer.target(),
                    plain,
                    "form {form:?}, interval {interval}: its own image"
                );
                let same = bare.cull(&view, &mut Unobserved);
                assert_eq!(list, same, "form {form:?}, interval {interval}: by depths alone");
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

#[test]
fn threads_leave_no_trace() {
    let mut rng = Pcg32::new(7, 9);
    let scene = soup::<Solid>(&mut rng, 6000, |c| c);
    for form in [Form::Incremental, Form::TwoPass] {
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
            assert_eq!(pool.install(run), alone, "form {form:?}, {threads} threads");
        }
    }
}
