//! The paper's worked example, and whole frames against plain drawing.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::parts::figure_1;
use super::*;
use crate::culling::cubes::CubeNote;
use crate::culling::depth::picture::Levels;
use crate::culling::depth::{Answered, Buffer, DepthNote, Ground, Query, QueryReporter, Step};
use crate::geometry::{Flat, NodeId, PixelRect, Solid, Space, Vector, View};
use crate::method::{Context, Note, Recorder, Unobserved, Verdict};
use crate::raster::{Options, Outcome, render};
use crate::scene::Parts;

/// The method on a scene, with its memory and the state of its last frame.
#[derive(Clone)]
struct Tried<'a, S: Faces> {
    index: &'a CubeIndex<S>,
    scene: &'a Scene<S>,
    params: &'a Params,
    memory: Memory,
    tiled: Tiled<S>,
}

impl<'a, S: Faces> Tried<'a, S> {
    fn new(index: &'a CubeIndex<S>, scene: &'a Scene<S>, params: &'a Params) -> Self {
        Self { index, scene, params, memory: Memory::default(), tiled: Tiled::default() }
    }
    fn frame<'b>(&'b self, view: &'b View<S>) -> Frame<'b, S, HierarchicalZ> {
        let Self { index, scene, params, .. } = *self;
        Frame { index, scene, view, params, limit: None }
    }
    fn cull<O: Observer<Evidence<S>>>(&mut self, view: &View<S>, watch: &mut O) -> DrawList<S> {
        let (mut memory, mut tiled) = (std::mem::take(&mut self.memory), std::mem::take(&mut self.tiled));
        let (frame, mut list) = (self.frame(view), DrawList::default());
        tiled.begin(&frame);
        HierarchicalZ::cull(&frame, &mut memory, &mut tiled, &mut list, watch);
        (self.memory, self.tiled) = (memory, tiled);
        list
    }
}

fn built<S: Faces>(scene: &Arc<Scene<S>>, params: &Params) -> CubeIndex<S> {
    let index = <HierarchicalZ as Method<S>>::build(scene, params, None, &crate::scene::Quiet);
    index.expect("nothing saved").expect("not cancelled")
}

/// What a face at depth 6 over some pixels of Figure 1 is told, as level, cell value and outcome.
fn face_at_6(pixels: PixelRect) -> (bool, Vec<(u8, f32, Outcome)>) {
    let (scene, view) = figure_1().expect("a valid scene");
    let mut buffer = Buffer::default();
    buffer.clear(&view);
    buffer.step(Step::Draw { scene: &scene, prims: scene.live(), options: Options::default() });
    buffer.refresh_all();
    let mut recorder: Recorder<Evidence<Solid>> = Recorder::new(1000);
    let reporter = QueryReporter::new(NodeId(0), None, &mut recorder);
    let is_hidden = Query::new(&mut buffer, 1.0 / 6.0, reporter).rectangle(pixels).is_hidden;
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

/// A scene with each primitive twice: of two at one place the one with the lower id shows, whichever is drawn
/// first.
fn twice<S: Space>(scene: &Scene<S>) -> Arc<Scene<S>> {
    let prims: Vec<S::Corners> = scene.live().iter().filter_map(|&p| scene.corners(p)).collect();
    let prims = [prims.clone(), prims].concat();
    Arc::new(Scene::new(Parts::simple("soup, twice", scene.points().to_vec(), prims)).expect("valid"))
}

/// Frames along a flight with jumps: each image is the plain one, and with coherence the list settles.
fn flights<S: Faces>(make: fn([u32; 3]) -> S::Corners) {
    let mut rng = Pcg32::new(5, 9);
    let scene = twice(&soup::<S>(&mut rng, 150, make));
    for (form, interval) in
        [Form::Incremental, Form::TwoPass].into_iter().flat_map(|form| [(form, 1), (form, 30)])
    {
        let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
        let params = Params { form, check_interval: interval, cubes, ..Params::default() };
        let index = built::<S>(&scene, &params);
        let mut tried = Tried::new(&index, &scene, &params);
        for view in crate::scene::random_views(&scene, 12, 3) {
            for step in 0..4 {
                let mut view = View { width: 80, height: view.height.min(60), ..view };
                view.eye.position = view.eye.position + view.eye.forward() * (0.05 * step as f32);
                view.eye.target = view.eye.position + view.eye.forward();
                let list = tried.cull(&view, &mut Unobserved);
                let plain = render(&scene, &view, scene.live());
                assert_eq!(render(&scene, &view, &list.prims), plain, "form {form:?}, interval {interval}");
                // What is worked out of the tiles is the depths of the whole image, though not all is drawn.
                let levels = tried.tiled.levels();
                assert_eq!(
                    levels.depths(),
                    plain.depth,
                    "form {form:?}, interval {interval}: its own \
                                                          depths"
                );
            }
        }
    }
}

#[test]
fn every_image_of_a_flight_with_jumps_is_the_plain_one() {
    flights::<Flat>(|[a, b, _]| [a, b]);
    flights::<Solid>(|c| c);
}

/// What begins behind every tile that it covers is neither drawn nor listed, and the image is the same.
#[test]
fn what_tiles_hide_is_not_listed() {
    let scene = soup::<Solid>(&mut Pcg32::new(6, 9), 600, |c| c);
    let cubes = Cubes { leaf_primitives: 40, ..Cubes::default() };
    let mut listed = [0; 2];
    for (primitive_test, listed) in [true, false].into_iter().zip(&mut listed) {
        let params = Params { primitive_test, cubes, ..Params::default() };
        let index = built::<Solid>(&scene, &params);
        let mut tried = Tried::new(&index, &scene, &params);
        for view in crate::scene::random_views(&scene, 6, 3) {
            let view = View { width: 80, height: 60, ..view };
            let list = tried.cull(&view, &mut Unobserved);
            assert_eq!(render(&scene, &view, &list.prims), render(&scene, &view, scene.live()));
            *listed += list.prims.len();
        }
    }
    assert!(listed[0] * 10 < listed[1] * 8, "listed with the test and without: {listed:?}");
}

/// The answer for a box over some pixels of Figure 1 whose nearest point is at a depth, with the notes before
/// it.
fn answered(pixels: PixelRect, depth: f32) -> (Vec<Evidence<Solid>>, String) {
    let (scene, view) = figure_1().expect("a valid scene");
    let mut buffer = Buffer::default();
    buffer.clear(&view);
    buffer.step(Step::Draw { scene: &scene, prims: scene.live(), options: Options::default() });
    buffer.refresh_all();
    let mut recorder: Recorder<Evidence<Solid>> = Recorder::new(1000);
    let reporter = QueryReporter::new(NodeId(7), None, &mut recorder);
    let answer = Query::new(&mut buffer, 1.0 / depth, reporter).rectangle(pixels);
    let (node, ground, bounds, is_by_planes) = (NodeId(7), Ground::Cells, scene.bounds(), false);
    let answered = Answered { node, bounds, pixels, answer, ground, is_by_planes };
    let note = Evidence::Depth(DepthNote::Answered(answered));
    let sentence = note.sentence(&Context { scene: &scene, view: &view });
    recorder.notes.push(note);
    (recorder.notes, sentence)
}

#[test]
fn an_answer_says_what_the_cell_that_decided_holds() {
    let lower = PixelRect { x0: 0, x1: 4, y0: 2, y1: 4 };
    assert_eq!(
        answered(lower, 5.0).1,
        "Node 7 may be seen: it comes as near as 5.00, and somewhere in cell (0, 1) of level 1 the farthest \
         thing drawn is at 6.00, 1.00 behind that. 2 cells were read."
    );
    let upper = PixelRect { x0: 0, x1: 2, y0: 0, y1: 1 };
    assert_eq!(
        answered(upper, 6.0).1,
        "Node 7 may be seen: it comes as near as 6.00, and the thing drawn at pixel (1, 0) is at 9.00, 3.00 \
         behind that. 3 cells were read."
    );
    let quarter = PixelRect { x0: 2, x1: 4, y0: 2, y1: 4 };
    assert_eq!(
        answered(quarter, 6.0).1,
        "Node 7 is hidden: wherever it could show, it lies behind all that is drawn. One cell was read; the \
         closest is cell (1, 1) of level 1, where it begins at depth 6.00 and the farthest thing drawn is at \
         4.00, nearer by 2.00."
    );
}

/// The picture lights the cell that the sentence names.
#[test]
fn the_cell_that_decided_is_lit() {
    // The two samples that hide it are alike: the first of them is named, and the second was read last.
    let (notes, sentence) = answered(PixelRect { x0: 0, x1: 1, y0: 0, y1: 2 }, 6.0);
    let reads = crate::culling::depth::picture::last_reads(notes.iter().rev().map(Evidence::depth));
    let named = reads.named.expect("a cell decided");
    assert_ne!(reads.all.last().map(|r| r.cell), Some(named));
    assert!(sentence.contains("the closest is pixel (0, 0), where it begins at depth 6.00"));
    assert_eq!((named.level, named.x, named.y), (0, 0, 0));
    // While the query reads it is the cell read last.
    let reads = crate::culling::depth::picture::last_reads(notes[..2].iter().rev().map(Evidence::depth));
    assert_eq!((reads.all.len(), reads.named), (2, reads.all.last().map(|r| r.cell)));
}

/// The picture of the list counts a cube that is drawn once, though it passes its check as well.
#[test]
fn a_cube_that_is_drawn_is_listed_once() {
    let mut rng = Pcg32::new(8, 9);
    let scene = soup::<Solid>(&mut rng, 200, |c| c);
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let params = Params { cubes, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let view = View { width: 80, height: 60, ..crate::scene::random_views(&scene, 1, 3)[0] };
    for frame in 0..2 {
        let mut recorder = Recorder::new(usize::MAX);
        tried.cull(&view, &mut recorder);
        let lists = super::picture::lists(&recorder.notes);
        let mut drawn: Vec<NodeId> = lists.drawn.iter().map(|(node, _)| *node).collect();
        let count = drawn.len();
        drawn.sort();
        drawn.dedup();
        assert_eq!(drawn.len(), count, "frame {frame}: each once");
        let partial = |e: &&Event| matches!(e, Event::DecidedNode(_, Verdict::Partial));
        assert_eq!(count, recorder.events.iter().filter(partial).count(), "frame {frame}: all that are seen");
        assert!(!lists.checked.is_empty() && lists.checked.len() <= count, "frame {frame}");
    }
}

/// What was hidden in the last frame is not drawn from the list, though that is checked only now and then.
#[test]
fn what_was_hidden_is_not_on_the_list() {
    let mut rng = Pcg32::new(9, 9);
    let scene = soup::<Solid>(&mut rng, 400, |c| c);
    let cubes = Cubes { leaf_primitives: 2, ..Cubes::default() };
    let params = Params { check_interval: 3, cubes, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let (mut hidden, mut unlisted, mut listed) = (Vec::new(), 0, 0);
    let start = crate::scene::random_views(&scene, 1, 5)[0];
    for step in 0..60 {
        let mut view = View { width: 80, height: 60, ..start };
        let turn = glam::Quat::from_rotation_y(0.2 * step as f32);
        view.eye.target = view.eye.position + turn * glam::Vec3::X;
        view.eye.position += glam::Vec3::new(0.0, 0.0, 3.0) * (0.3 * step as f32).sin();
        let mut recorder = Recorder::new(usize::MAX);
        tried.cull(&view, &mut recorder);
        for note in &recorder.notes {
            match note {
                Evidence::Listed(node, true) => {
                    listed += 1;
                    let above = std::iter::successors(Some(*node), |n| index.octree().parent_of(*n));
                    assert!(above.into_iter().all(|n| !hidden.contains(&n)), "node {node} in frame {step}");
                }
                Evidence::Cube(CubeNote::Unlisted { .. }) => unlisted += 1,
                _ => {}
            }
        }
        let of = |e: &Event| match e {
            Event::DecidedNode(node, Verdict::Hidden) => Some(*node),
            _ => None,
        };
        hidden = recorder.events.iter().filter_map(of).collect();
    }
    assert!(unlisted > 20 && listed > 200, "{unlisted} left the list, {listed} drawn from it");
}

/// The list is checked early when all is new, or when the farthest depth shifts; and after its interval.
#[test]
fn a_list_is_checked_early_for_the_two_reasons_of_the_paper() {
    // A room with a window: the farthest depth is that of the back wall until the eye passes the front one.
    let quad = |z: f32, half: f32| {
        [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| glam::vec3(x, y, z))
    };
    let points: Vec<_> = quad(-40.0, 90.0).into_iter().chain(quad(-5.0, 90.0)).collect();
    let prims = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let scene = Arc::new(Scene::<Solid>::new(Parts::simple("two walls", points, prims)).expect("valid"));
    let params = Params { check_interval: 4, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let mut dues = Vec::new();
    for z in [0.0, 0.0, 0.0, -6.0, -6.0, -6.0, -6.0, -6.0] {
        let position = glam::vec3(0.0, 0.0, z);
        let target = position - glam::Vec3::Z;
        let fov = std::f32::consts::FRAC_PI_2;
        let eye = crate::geometry::Eye { position, target, up: glam::Vec3::Y, fov, near: 0.5, far: 100.0 };
        let mut recorder: Recorder<Evidence<Solid>> = Recorder::new(usize::MAX);
        tried.cull(&View { eye, width: 64, height: 64 }, &mut recorder);
        dues.extend(recorder.notes.iter().filter_map(|n| match n {
            Evidence::Cube(CubeNote::Checked(check)) => Some(check.due),
            _ => None,
        }));
    }
    use crate::culling::cubes::Due::{Added, Interval, Shifted};
    assert_eq!(dues, [Some(Added), None, None, Some(Shifted), None, None, None, Some(Interval)]);
}
