//! Frames of the machine against plain drawing, and what its units do.

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::machine::{Allocation, Distribution, Unit};
use super::*;
use crate::geometry::{Eye, Flat, PrimId, Solid, Space, Vector, View};
use crate::method::{Entry, Of, Recorder, Settings, Unobserved, Verdict};
use crate::raster::render;
use crate::scene::Parts;

/// The method on a scene, with its memory and the state of its last frame.
#[derive(Clone)]
struct Tried<'a, S: Faces> {
    index: &'a Octree<S::Vector>,
    scene: &'a Scene<S>,
    params: &'a Params,
    memory: Memory,
    buffer: Buffer<S>,
}

impl<'a, S: Faces> Tried<'a, S> {
    fn new(index: &'a Octree<S::Vector>, scene: &'a Scene<S>, params: &'a Params) -> Self {
        let (memory, buffer) = (Memory::default(), Buffer::default());
        Self { index, scene, params, memory, buffer }
    }
    fn frame<'b>(&'b self, view: &'b View<S>) -> Frame<'b, S, ParallelHierarchicalZ> {
        let Self { index, scene, params, .. } = *self;
        Frame { index, scene, view, params, limit: None, depths_only: false }
    }
    fn cull<O: Observer<Evidence<S>>>(&mut self, view: &View<S>, watch: &mut O) -> DrawList<S> {
        let (mut memory, mut buffer) = (std::mem::take(&mut self.memory), std::mem::take(&mut self.buffer));
        let (frame, mut list) = (self.frame(view), DrawList::default());
        buffer.begin(&frame);
        ParallelHierarchicalZ::cull(&frame, &mut memory, &mut buffer, &mut list, watch);
        (self.memory, self.buffer) = (memory, buffer);
        list
    }
}

fn built<S: Faces>(scene: &Arc<Scene<S>>, params: &Params) -> Octree<S::Vector> {
    let index = <ParallelHierarchicalZ as Method<S>>::build(scene, params, None, &crate::scene::Quiet);
    index.expect("nothing saved").expect("not cancelled")
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

/// What the events of a frame report of each primitive.
fn reported<S: Faces>(scene: &Scene<S>, events: &[Event]) -> Vec<Option<Verdict>> {
    let mut reported = vec![None; scene.prim_count()];
    for event in events {
        if let Event::DecidedPrim(p, v) = event {
            reported[p.at()].get_or_insert(*v);
        }
    }
    reported
}

/// The machine draws the plain image however structures and regions are dealt, reports what it answers, and
/// no unit does two things at a time.
fn machines<S: Faces>(make: fn([u32; 3]) -> S::Corners) {
    use Allocation::{Dynamic, Static};
    use Distribution::{Hybrid, Primitive, Structure};
    let mut rng = Pcg32::new(6, 9);
    let scene = soup::<S>(&mut rng, 200, make);
    let cases =
        [(Hybrid, Static), (Structure, Static), (Primitive, Static), (Hybrid, Dynamic), (Primitive, Dynamic)];
    for (case, (distribution, allocation)) in cases.into_iter().enumerate() {
        let machine = Machine {
            processors: 3,
            renderers: 2,
            distribution,
            allocation,
            overlap: case % 2 == 0,
            ..Machine::default()
        };
        let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
        let params = Params { machine, cubes, check_interval: 3, ..Params::default() };
        let index = built::<S>(&scene, &params);
        let (mut tried, mut hidden, mut work) = (Tried::new(&index, &scene, &params), 0, 0);
        for view in crate::scene::random_views(&scene, 6, 4) {
            let view = View { width: 300, height: view.height.min(200), ..view };
            let (mut recorder, mut same) = (Recorder::new(usize::MAX), tried.clone());
            let list = tried.cull(&view, &mut recorder);
            let plain = render(&scene, &view, scene.live());
            assert_eq!(render(&scene, &view, &list.prims), plain, "case {case}");
            assert_eq!(*tried.buffer.target(), plain, "case {case}: its own image");
            let again = same.cull(&view, &mut Unobserved);
            assert_eq!(list, again, "case {case}: a frame is the same again, unobserved");
            let reported = reported(&scene, &recorder.events);
            assert!(reported.iter().all(Option::is_some), "case {case}: all is reported");
            let is_drawn = |p: &PrimId| reported[p.at()] == Some(Verdict::Visible);
            let mut drawn: Vec<PrimId> = scene.live().iter().copied().filter(is_drawn).collect();
            drawn.sort_unstable();
            assert_eq!(drawn, list.ascending(), "case {case}: reported and answered");
            hidden += reported.iter().filter(|r| **r == Some(Verdict::Hidden)).count();
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
    work.iter().filter(|w| matches!(w.0, Unit::Renderer(_))).count()
}

#[test]
fn the_simulated_machine_draws_the_plain_image() {
    machines::<Flat>(|[a, b, _]| [a, b]);
    machines::<Solid>(|c| c);
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
            let cubes = Cubes { leaf_primitives: 6, ..Cubes::default() };
            let params = Params { machine, cubes, ..Params::default() };
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
            let answers =
                asked.notes.iter().filter(|n| matches!(n, Evidence::Worked(w) if w.job == Job::Answer));
            let told: Vec<u32> =
                answers.map(|n| if let Evidence::Worked(w) = n { w.count } else { 0 }).collect();
            assert!(told.contains(&0) && told.contains(&1), "one region hides it and one shows it: {told:?}");
        }
    }
}

/// Lists are in the order of Section 4.2: what covers most of the screen is drawn first, and of what was
/// invisible the structures of the fewest primitives are queried first.
#[test]
fn a_processor_draws_the_largest_first_and_queries_the_cheapest_first() {
    let mut rng = Pcg32::new(9, 9);
    let scene = soup::<Solid>(&mut rng, 300, |c| c);
    // One processor, and groups of one: no answer comes in between.
    let machine = Machine {
        processors: 1,
        distribution: Distribution::Structure,
        message: 10_000,
        farthest_first: false,
        ..Machine::default()
    };
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let params = Params { machine, cubes, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let view = crate::scene::framing_view::<Solid>(&scene.bounds(), 256, 256);
    let mut first = Recorder::new(usize::MAX);
    tried.cull(&view, &mut first);
    let mut second = Recorder::new(usize::MAX);
    tried.cull(&view, &mut second);
    let nodes = |notes: &[Evidence<Solid>], wanted: Job| -> Vec<_> {
        let of = |n: &Evidence<Solid>| match n {
            Evidence::Worked(w) if w.job == wanted => Some(w.node),
            _ => None,
        };
        notes.iter().filter_map(of).collect()
    };
    let asked = nodes(&first.notes, Job::Ask);
    let cost = asked.iter().map(|n| index.own(*n).len() + index.shared(*n).len());
    assert!(asked.len() > 10 && cost.is_sorted(), "the cheapest are queried first");
    let drawn = nodes(&second.notes, Job::DrawVisible);
    let area = drawn.iter().map(|n| {
        let held = &index.nodes()[n.at()].held;
        match crate::culling::depth::footprint(&view, &view.projection(), held) {
            crate::geometry::Footprint::Seen(image) => std::cmp::Reverse(image.pixels.area()),
            crate::geometry::Footprint::Outside => std::cmp::Reverse(0),
            crate::geometry::Footprint::CrossesNear => std::cmp::Reverse(u64::MAX),
        }
    });
    assert!(drawn.len() > 10 && area.is_sorted(), "the largest are drawn first");
}

/// Every decision rests on evidence: a structure's work, an answer, a box, or the primitive itself.
#[test]
fn every_decision_rests_on_evidence() {
    let mut rng = Pcg32::new(10, 9);
    let scene = soup::<Solid>(&mut rng, 200, |c| c);
    let settings = [("leaf-primitives", "4"), ("backface-culling", "true")];
    let settings = Settings(settings.map(|(k, v)| (k.to_owned(), v.to_owned())).into());
    let entry: &dyn Entry<Solid> = &Of::<ParallelHierarchicalZ>::NEW;
    let run = entry.ready(&scene, &settings, &crate::scene::Quiet).expect("settings fit");
    let mut run = run.expect("not cancelled");
    let (mut decisions, mut kinds) = (0, std::collections::BTreeSet::new());
    for view in crate::scene::random_views(&scene, 4, 6) {
        let view = View { width: 300, height: 200, ..view };
        let film = run.record(&view, usize::MAX).film;
        for (at, event) in film.events().iter().enumerate().filter(|(_, e)| e.verdict().is_some()) {
            let evidence = film.evidence_of(at);
            kinds.insert(evidence.map(|evidence| film.kind(evidence)));
            assert!(evidence.is_some(), "event {at}, {event:?}");
            decisions += 1;
        }
    }
    let wanted = ["VisibleDrawn", "FoundDrawn", "ObscurationTested", "OrientationTested", "PrimClassified"];
    assert!(decisions > 200 && wanted.iter().all(|k| kinds.contains(&Some(*k))), "{decisions}: {kinds:?}");
}
