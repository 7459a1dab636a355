//! Frames of the machine against plain drawing, and what its units do.

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::machine::{Allocation, Distribution, Unit, Volume};
use super::*;
use crate::culling::depth::Ground;
use crate::geometry::{Eye, Flat, NodeId, PrimId, Solid, Space, Vector, View};
use crate::index::Hierarchy;
use crate::method::{Entry, Of, Recorder, Settings, Unobserved, Verdict, Words};
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
        Frame { index, scene, view, params, limit: None }
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
fn reported<S: Faces>(scene: &Scene<S>, index: &Octree<S::Vector>, events: &[Event]) -> Vec<Option<Verdict>> {
    let mut reported = vec![None; scene.prim_count()];
    for event in events {
        match event {
            Event::DecidedPrim(p, v) => _ = reported[p.at()].get_or_insert(*v),
            Event::DecidedNode(node, v) if *v != Verdict::Partial => {
                for p in Hierarchy::<S>::prims(index, *node) {
                    assert_eq!(reported[p.at()].replace(*v), None, "{p} is decided once");
                }
            }
            _ => {}
        }
    }
    reported
}

/// The machine draws the plain image however structures and regions are dealt, reports what it answers, and
/// no unit does two things at a time.
fn machines<S: Faces>(make: fn([u32; 3]) -> S::Corners) {
    use Allocation::{Dynamic, Static};
    use Distribution::{Hybrid, Primitive, Structure, Subtree};
    let mut rng = Pcg32::new(6, 9);
    let scene = soup::<S>(&mut rng, 200, make);
    let cases = [
        (Hybrid, Static),
        (Structure, Static),
        (Primitive, Static),
        (Subtree, Static),
        (Hybrid, Dynamic),
        (Primitive, Dynamic),
    ];
    for (case, (distribution, allocation)) in cases.into_iter().enumerate() {
        let machine = Machine {
            processors: 3,
            renderers: 2,
            distribution,
            allocation,
            overlap: case % 2 == 0,
            query: if case % 3 == 0 { Volume::Faces } else { Volume::Sphere },
            ..Machine::default()
        };
        let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
        let params = Params { machine, cubes, check_interval: 3, ..Params::default() };
        let index = built::<S>(&scene, &params);
        let (mut tried, mut hidden, mut work) = (Tried::new(&index, &scene, &params), 0, 0);
        for view in crate::scene::random_views(&scene, 6, 4) {
            let view = View { width: 300, height: view.height.min(200), ..view };
            let (hid, worked) = frame(&mut tried, &view, case);
            (hidden, work) = (hidden + hid, work + worked);
        }
        assert!(hidden > 20 && work > 50, "case {case}: {hidden} hidden, {work} jobs");
    }
}

/// One frame; how many primitives were hidden, and how many jobs renderers did.
fn frame<S: Faces>(tried: &mut Tried<'_, S>, view: &View<S>, case: usize) -> (usize, usize) {
    let (scene, index) = (tried.scene, tried.index);
    let (mut recorder, mut same) = (Recorder::new(usize::MAX), tried.clone());
    let list = tried.cull(view, &mut recorder);
    let plain = render(scene, view, scene.live());
    assert_eq!(render(scene, view, &list.prims), plain, "case {case}");
    assert_eq!(*tried.buffer.target(), plain, "case {case}: its own image");
    let again = same.cull(view, &mut Unobserved);
    assert_eq!(list, again, "case {case}: a frame is the same again, unobserved");
    let reported = reported(scene, index, &recorder.events);
    assert!(reported.iter().all(Option::is_some), "case {case}: all is reported");
    let is_drawn = |p: &PrimId| reported[p.at()] == Some(Verdict::Visible);
    let mut drawn: Vec<PrimId> = scene.live().iter().copied().filter(is_drawn).collect();
    drawn.sort_unstable();
    assert_eq!(drawn, list.ascending(), "case {case}: reported and answered");
    let hidden = reported.iter().filter(|r| **r == Some(Verdict::Hidden)).count();
    (hidden, work_of_renderers(&recorder.notes, case))
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

/// Each processor's share of the primitives.
fn shares<V: Vector>(index: &Octree<V>, distribution: Distribution, processors: usize) -> Vec<usize> {
    let dealt = super::dealing::dealt(index, distribution, processors);
    dealt.iter().map(|a| a.structures.iter().map(|s| s.prims.len()).sum()).collect()
}

/// Every primitive is dealt to one processor however it is dealt; subtrees evenly, to within the largest, and
/// each to one processor.
#[test]
fn all_is_dealt_out_and_subtrees_evenly() {
    let mut rng = Pcg32::new(11, 9);
    let scene = soup::<Solid>(&mut rng, 900, |c| c);
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let index = built::<Solid>(&scene, &Params { cubes, ..Params::default() });
    let head = |node: NodeId| {
        let above = std::iter::successors(Some(node), |n| index.parent_of(*n));
        above.into_iter().find(|n| index.nodes()[n.at()].level <= 2).expect("the root")
    };
    for processors in [1, 2, 3, 4, 8] {
        for distribution in Distribution::ALL {
            let total = shares(&index, *distribution, processors).iter().sum::<usize>();
            assert_eq!(total, index.references(), "{distribution:?} to {processors}");
        }
        let (mut size, mut owner) = (std::collections::BTreeMap::new(), std::collections::BTreeMap::new());
        for (p, allotment) in
            super::dealing::dealt(&index, Distribution::Subtree, processors).iter().enumerate()
        {
            for s in &allotment.structures {
                *size.entry(head(s.node)).or_insert(0) += s.prims.len();
                assert_eq!(*owner.entry(head(s.node)).or_insert(p), p, "a subtree stays together");
            }
        }
        let shares = shares(&index, Distribution::Subtree, processors);
        let (least, most) = (shares.iter().min().expect("some"), shares.iter().max().expect("some"));
        assert!(most - least <= *size.values().max().expect("subtrees"), "{processors}: {shares:?}");
        assert!(*least > 0);
    }
}

/// What was visible on a processor is on the list of that processor in the next frame, wherever the view
/// turned meanwhile.
#[test]
fn structures_stay_with_their_processor() {
    let mut rng = Pcg32::new(12, 9);
    let scene = soup::<Solid>(&mut rng, 300, |c| c);
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let params = Params { cubes, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let mut owner = std::collections::BTreeMap::new();
    for view in crate::scene::random_views(&scene, 8, 4) {
        let mut recorder = Recorder::new(usize::MAX);
        tried.cull(&View { width: 300, height: 200, ..view }, &mut recorder);
        for note in &recorder.notes {
            if let Evidence::Worked(Worked { unit, job: Job::DrawVisible | Job::DrawFound, node, .. }) = note
            {
                assert_eq!(owner.entry(*node).or_insert(*unit), unit, "node {node}");
            }
        }
    }
    assert!(owner.len() > 40);
}

fn settings(pairs: &[(&str, &str)]) -> Settings {
    Settings(pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect())
}

/// Parameters of the sequential form are taken over or refused with a line, never ignored.
#[test]
fn parameters_are_honored_or_refused() {
    let entry: &dyn Entry<Solid> = &Of::<ParallelHierarchicalZ>::NEW;
    for (key, value) in [("form", "two-pass"), ("primitive-test", "false"), ("query", "rectangles")] {
        let refused = entry.knobs(&settings(&[(key, value)])).expect_err("refused").to_string();
        assert!(refused.contains(key) && !refused.contains('\n'), "{refused}");
    }
    let mut rng = Pcg32::new(13, 9);
    let scene = soup::<Solid>(&mut rng, 300, |c| c);
    let view = View { width: 300, height: 200, ..crate::scene::random_views(&scene, 1, 4)[0] };
    let counted = |query| {
        let pairs = settings(&[("leaf-primitives", "4"), ("query", query)]);
        let mut run =
            entry.ready(&scene, &pairs, &crate::scene::Quiet).expect("fits").expect("not cancelled");
        run.count(&view).1.named()
    };
    let (faces, sphere) = (counted("faces"), counted("sphere"));
    assert_ne!(faces["cells_read"], sphere["cells_read"]);
    let each =
        |counts: &std::collections::BTreeMap<&str, u64>| counts["ticks_asking"] / counts["boxes_transformed"];
    assert_eq!((each(&faces), each(&sphere)), (120, 10), "twelve triangles, one expression");
}

/// The work of a frame in order.
fn work<S: Faces>(notes: &[Evidence<S>]) -> Vec<Worked> {
    notes.iter().filter_map(|n| if let Evidence::Worked(w) = n { Some(*w) } else { None }).collect()
}

/// With dynamic allocation every region is drawn in, though there are few renderers, and not only when all
/// processors are done.
#[test]
fn regions_are_taken_while_processors_work() {
    let mut rng = Pcg32::new(14, 9);
    let scene = soup::<Solid>(&mut rng, 400, |c| c);
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let machine = Machine { renderers: 2, allocation: Allocation::Dynamic, ..Machine::default() };
    let params = Params { cubes, machine, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let view = crate::scene::framing_view::<Solid>(&scene.bounds(), 512, 384);
    let (mut tried, mut recorder) = (Tried::new(&index, &scene, &params), Recorder::new(usize::MAX));
    tried.cull(&view, &mut recorder);
    let work = work(&recorder.notes);
    let is_processor = |w: &&Worked| matches!(w.unit, Unit::Processor(_)) && w.job != Job::Wait;
    let image = work.iter().rposition(|w| w.job == Job::Rasterize).expect("something is drawn");
    let last = work[..=image].iter().filter(is_processor).map(|w| w.to).max().expect("processors work");
    let drawn = work.iter().filter(|w| w.job == Job::Rasterize);
    let before: std::collections::BTreeSet<u32> = drawn.filter(|w| w.to < last).map(|w| w.region).collect();
    assert!(before.len() > 8, "{before:?} of 12 before tick {last}");
    let unread = |n: &&Evidence<Solid>| match n {
        Evidence::Depth(DepthNote::Answered(a)) => a.ground == Ground::Unread && !a.answer.is_hidden,
        _ => false,
    };
    assert!(recorder.notes.iter().filter(unread).count() > 0, "what is not held counts as seen");
}

/// Farthest depths are asked for by messages that take time, and reject nothing before they have come.
#[test]
fn farthest_depths_are_asked_for_and_take_time() {
    let mut rng = Pcg32::new(15, 9);
    let scene = soup::<Flat>(&mut rng, 800, |[a, b, _]| [a, b]);
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let message = 50;
    let machine = Machine { processors: 2, message, ..Machine::default() };
    let params = Params { cubes, machine, check_interval: 1, ..Params::default() };
    let index = built::<Flat>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let mut rejected = 0;
    for view in crate::scene::random_views(&scene, 6, 4) {
        for _ in 0..2 {
            let mut recorder = Recorder::new(usize::MAX);
            tried.cull(&View { width: 500, ..view }, &mut recorder);
            let work = work(&recorder.notes);
            let of = |job| work.iter().filter(move |w| w.job == job);
            assert_eq!(of(Job::Farthest).count(), of(Job::AskFarthest).count() * 4, "each renderer");
            for asked in of(Job::AskFarthest) {
                assert_eq!(asked.to - asked.from, 10);
                assert!(of(Job::Farthest).all(|found| found.from >= message));
            }
            let first = of(Job::AskFarthest).map(|w| w.to).min().unwrap_or(u32::MAX);
            let mut now = 0;
            for note in &recorder.notes {
                match note {
                    Evidence::Worked(w) if w.job == Job::Ask => now = w.from,
                    Evidence::Depth(DepthNote::Answered(a)) if a.ground == Ground::Regions => {
                        rejected += 1;
                        assert!(now >= first.saturating_add(2 * message), "{now} after {first}");
                    }
                    _ => {}
                }
            }
        }
    }
    assert!(rejected > 0, "the shortcut rejects something");
}

/// The lists of processors are checked early in the first frame, when all is new, and again after as many
/// frames as are to pass; each check has its note, takes ticks, and follows the image.
#[test]
fn lists_are_checked_early_and_it_takes_time() {
    let mut rng = Pcg32::new(16, 9);
    let scene = soup::<Solid>(&mut rng, 300, |c| c);
    let cubes = Cubes { leaf_primitives: 4, ..Cubes::default() };
    let params = Params { cubes, check_interval: 4, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let view = crate::scene::framing_view::<Solid>(&scene.bounds(), 300, 200);
    let (mut tried, mut dues) = (Tried::new(&index, &scene, &params), Vec::new());
    for frame in 0..6 {
        let mut recorder = Recorder::new(usize::MAX);
        tried.cull(&view, &mut recorder);
        let checks = recorder.notes.iter().filter_map(|n| match n {
            Evidence::Cube(CubeNote::Checked(check)) => Some(check.due),
            _ => None,
        });
        let checks: Vec<_> = checks.collect();
        assert_eq!(checks.len(), 4, "one a processor");
        assert!(checks.iter().all(|due| *due == checks[0]));
        dues.push(checks[0]);
        let work = work(&recorder.notes);
        let finished = work.iter().filter(|w| w.job == Job::Rasterize).map(|w| w.to).max().expect("drawn");
        let rechecked: Vec<_> = work.iter().filter(|w| w.job == Job::Recheck).collect();
        assert_eq!(rechecked.is_empty(), checks[0].is_none(), "frame {frame}");
        assert!(rechecked.iter().all(|w| w.from >= finished && w.to == w.from + 120));
        let asked = work.iter().filter(|w| w.job == Job::AskFarthest && w.from >= finished).count();
        assert_eq!(asked, 4, "every processor asks for the shift of the farthest depth");
    }
    use crate::culling::cubes::Due::{Added, Interval};
    assert_eq!(dues, [Some(Added), None, None, None, Some(Interval), None]);
}

/// One note says what became of a structure, however many primitives it has: here of what a wall hides.
#[test]
fn a_structure_has_one_answer() {
    let wall = [(-90.0, -90.0), (90.0, -90.0), (90.0, 90.0), (-90.0, 90.0)];
    let mut points: Vec<_> = wall.map(|(x, y)| glam::vec3(x, y, -5.0)).into();
    let mut prims = vec![[0, 1, 2], [0, 2, 3]];
    for k in 0..400 {
        let (x, y, first) = ((k % 20) as f32 - 10.0, (k / 20) as f32 - 10.0, points.len() as u32);
        points.extend([(0.1, 0.1), (0.6, 0.1), (0.1, 0.6)].map(|(dx, dy)| glam::vec3(x + dx, y + dy, -20.0)));
        prims.push([first, first + 1, first + 2]);
    }
    let scene = Arc::new(Scene::<Solid>::new(Parts::simple("a wall", points, prims)).expect("valid"));
    let cubes = Cubes { leaf_primitives: 20, ..Cubes::default() };
    let params = Params { cubes, ..Params::default() };
    let index = built::<Solid>(&scene, &params);
    let mut tried = Tried::new(&index, &scene, &params);
    let (up, fov) = (Vec3::Y, std::f32::consts::FRAC_PI_2);
    let eye = Eye { position: Vec3::ZERO, target: Vec3::NEG_Z, up, fov, near: 0.5, far: 100.0 };
    let mut hidden = [0; 2];
    for hidden in &mut hidden {
        let mut recorder = Recorder::new(usize::MAX);
        tried.cull(&View { eye, width: 300, height: 200 }, &mut recorder);
        let count =
            |wanted: fn(&Evidence<Solid>) -> bool| recorder.notes.iter().filter(|n| wanted(n)).count();
        let asked = count(|n| matches!(n, Evidence::Worked(w) if matches!(w.job, Job::Ask | Job::Recheck)));
        let answers = count(|n| matches!(n, Evidence::Depth(DepthNote::Answered(_))));
        assert_eq!(answers, asked);
        let is_hidden = |e: &&Event| matches!(e, Event::DecidedPrim(_, Verdict::Hidden));
        *hidden = recorder.events.iter().filter(is_hidden).count();
    }
    // What the triangles behind the wall share is drawn or not by itself; most of them are a cube's alone.
    assert!(hidden[1] > 200, "{hidden:?} hidden, when the wall is known");
}

/// Of a structure whose box covers no pixel, one beside the image and one in a region that nobody holds the
/// sentence says so.
#[test]
fn an_answer_says_what_it_rests_on() {
    let scene = crate::scene::samples::soup::<Solid>(1, 4);
    let view = crate::scene::framing_view::<Solid>(&scene.bounds(), 64, 64);
    let context = crate::method::Context { scene: &scene, view: &view };
    let answer = |ground, is_hidden| {
        let answer = crate::culling::depth::Answer { is_hidden, nearest: 0.1, reads: 0, decisive: None };
        let (node, bounds, pixels) = (NodeId(3), scene.bounds(), crate::geometry::PixelRect::default());
        let is_by_planes = true;
        let note = crate::culling::depth::Answered { node, bounds, pixels, answer, ground, is_by_planes };
        crate::method::Note::<Solid>::sentence(&DepthNote::Answered(note), &context)
    };
    assert_eq!(
        answer(Ground::Cells, true),
        "The image of node 3 covers no pixel's center: nothing of it can show."
    );
    assert_eq!(
        answer(Ground::BesideImage, true),
        "The box of node 3 lies beside the image: nothing of it can show."
    );
    let unread = answer(Ground::Unread, false);
    assert!(unread.starts_with("Node 3 counts as visible") && unread.contains("held by no renderer"));
}
