//! The properties that the paper's algorithm promises, and its arithmetic.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::explain::Evidence;
use super::front::Front;
use super::index::node_of;
use super::{CellKind, LayeredProjection, Params};
use crate::culling::Methods;
use crate::drawing::Subject;
use crate::geometry::{CellId, Flat, PrimId, Solid, Vector, View};
use crate::index::tessellation::Cellular;
use crate::method::{
    Budget, DrawList, Event, Field, Film, Frame, Method, Recorder, Run, Settings, State, Value, Verdict,
};
use crate::raster::{Drawable, render};
use crate::scene::{Quiet, Scene, framing_view, random_views, samples};

trait World: Methods + Drawable + Cellular {}
impl<S: Methods + Drawable + Cellular> World for S {}

const KINDS: [&str; 3] = ["octree", "delaunay", "kd-tree"];
const RULES: [(&str, &str); 2] = [("rules", "paper"), ("rules", "ours")];

fn settings(pairs: &[(&str, &str)]) -> Settings {
    Settings::of(pairs)
}
fn run<S: World>(scene: &Arc<Scene<S>>, pairs: &[(&str, &str)]) -> Box<dyn Run<S>> {
    S::method("layered-projection")
        .expect("listed")
        .ready(scene, &settings(pairs), &Quiet)
        .expect("settings fit")
        .expect("not cancelled")
}

fn promises(pairs: &[(&str, &str)]) -> bool {
    let entry = Flat::method("layered-projection").expect("listed");
    entry.is_conservative(&settings(pairs)).expect("settings fit")
}

/// Views from inside and one from outside.
fn views<S: World>(scene: &Scene<S>) -> Vec<View<S>> {
    let mut views = random_views(scene, 4, 3);
    views.push(framing_view(&scene.bounds(), 64, 64));
    for view in &mut views {
        (view.width, view.height) = (64, view.height.min(64));
    }
    views
}

fn both(flat: impl Fn(&Arc<Scene<Flat>>, &'static str), solid: impl Fn(&Arc<Scene<Solid>>, &'static str)) {
    for kind in KINDS {
        (0..2).for_each(|seed| flat(&samples::soup(seed, 300), kind));
        (0..2).for_each(|seed| solid(&samples::soup(seed, 300), kind));
    }
}

fn value(fields: &[Field], name: &str) -> f64 {
    match fields.iter().find(|f| f.name == name).map(|f| &f.value) {
        Some(Value::Number(v)) => *v,
        Some(Value::Integer(v)) => *v as f64,
        Some(Value::Switch(v)) => f64::from(u8::from(*v)),
        other => panic!("{name}: {other:?}"),
    }
}

/// Replays the front from the events: each cell is taken once, and is the first of the least.
fn is_a_priority_order<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    RULES.into_iter().for_each(|rules| orders_by_priority(scene, kind, rules));
}

fn orders_by_priority<S: World>(scene: &Arc<Scene<S>>, kind: &'static str, rules: (&str, &str)) {
    let (mut requeued, mut ties, mut projected) = (0, 0, 0);
    for view in views(scene) {
        let film = run(scene, &[("tessellation", kind), ("budget", "1000"), ("leaf-size", "8"), rules])
            .record(&view, usize::MAX)
            .film;
        let mut front: Vec<(u32, f32)> = Vec::new();
        let mut taken = Vec::new();
        for event in film.events() {
            match *event {
                Event::Queued(node, solidity) => {
                    assert!(!taken.contains(&node), "{kind}: {node} was projected before");
                    requeued += usize::from(front.iter().any(|(n, _)| *n == node.0));
                    front.retain(|(n, _)| *n != node.0);
                    front.push((node.0, solidity));
                }
                Event::Entered(node) if node.0 != 0 => {
                    let least = front.iter().map(|f| f.1).fold(f32::INFINITY, f32::min);
                    let at = front.iter().position(|f| f.1 == least).expect("the front is not empty");
                    ties += usize::from(front.iter().filter(|f| f.1 == least).count() > 1);
                    assert_eq!(front.remove(at).0, node.0, "{kind}: the first of the least");
                    taken.push(node);
                }
                _ => {}
            }
        }
        assert!(front.is_empty(), "{kind}: all are taken");
        projected += taken.len();
    }
    assert!(
        projected > 50 && requeued > 20 && ties > 2,
        "{kind}, {rules:?}: {projected} projected, {requeued} put in again, {ties} ties"
    );
}

#[test]
fn each_cell_is_projected_once_and_is_the_least_of_the_front() {
    both(is_a_priority_order, is_a_priority_order);
}

fn keeps_to_the_budget<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    for (view, rules) in views(scene).into_iter().zip(RULES.into_iter().cycle()) {
        let drawn =
            |budget: &str| run(scene, &[("tessellation", kind), ("budget", budget), rules]).cull(&view).prims;
        let all = drawn("100%");
        for budget in [0, 1, 2, 17, 100] {
            let part = drawn(&budget.to_string());
            assert_eq!(
                part,
                all[..budget.min(all.len())],
                "{kind}: a smaller budget draws the beginning of a larger one's list"
            );
        }
        assert_eq!(drawn("5%"), all[..15.min(all.len())], "{kind}");
    }
}

#[test]
fn the_budget_is_used_up_and_never_exceeded() {
    both(keeps_to_the_budget, keeps_to_the_budget);
}

fn sees_all<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    for (leaf, rules) in ["3", "20", "20", "100"].into_iter().zip(RULES.into_iter().cycle()) {
        let mut run = run(scene, &[("tessellation", kind), ("budget", "100%"), ("leaf-size", leaf), rules]);
        for view in views(scene) {
            let drawn = run.cull(&view).prims;
            assert_eq!(
                render(scene, &view, &drawn).item,
                render(scene, &view, scene.live()).item,
                "{kind}, leaf {leaf}"
            );
            assert!(
                drawn.len() < scene.live().len() || view == framing_view(&scene.bounds(), 64, 64),
                "{kind}: what is out of view is not drawn"
            );
        }
    }
}

#[test]
fn with_an_unlimited_budget_the_image_is_the_z_buffers() {
    both(sees_all, sees_all);
}

fn hands_on_solidity<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    hands_it_on(scene, kind, &[("rules", "paper")]);
    hands_it_on(scene, kind, &[]);
    hands_it_on(scene, kind, &[("transfer", "aligned"), ("update", "latest")]);
}

fn hands_it_on<S: World>(scene: &Arc<Scene<S>>, kind: &'static str, pairs: &[(&str, &str)]) {
    let view = views(scene)[4];
    let fixed = [("tessellation", kind), ("penalty", "50"), ("budget", "100%")];
    let mut run = run(scene, &[&fixed, pairs].concat());
    let knobs = run.knobs();
    let knob = |name: &str| {
        let found = knobs.iter().find(|(k, _)| k.name == name);
        found.map(|(_, v)| v.to_string()).expect("a parameter")
    };
    let film = run.record(&view, usize::MAX).film;
    let mut told = Told {
        film: &*film,
        ways: ["transfer", "update", "penalty-as"].map(knob),
        solidity: BTreeMap::new(),
        settled: BTreeSet::new(),
        front: BTreeMap::new(),
        counts: [0; 4],
    };
    for at in 0..film.events().len() {
        told.hear(at, view.eye.forward());
    }
    let [count, penalties, kept, ahead] = told.counts;
    assert!(penalties > 5 && penalties < count, "{kind}: {penalties} of {count}");
    assert_eq!(kept > 5, knob("update") == "star-shaped", "{kind}: {kept} of {count}");
    let is_frame = knob("view-direction") == "frame";
    assert!(if is_frame { ahead == count } else { ahead < count / 2 }, "{ahead} of {count}");
}

/// The numbers of a field.
fn list(fields: &[Field], name: &str) -> Vec<f64> {
    match fields.iter().find(|f| f.name == name).map(|f| &f.value) {
        Some(Value::List(list)) => list.clone(),
        other => panic!("{name}: {other:?}"),
    }
}

/// What transfers and projections of a film say, followed from event to event.
struct Told<'a, S: World> {
    film: &'a dyn Film<S>,
    /// Transfer, update and penalty-as.
    ways: [String; 3],
    /// Of projected cells, by node.
    solidity: BTreeMap<u32, f64>,
    /// Nodes that were reached through the face the Eye sees them by.
    settled: BTreeSet<u32>,
    /// What waits, with its solidity.
    front: BTreeMap<u32, f64>,
    /// Transfers; those with a penalty, those that change nothing, those along the Eye's own direction.
    counts: [usize; 4],
}

impl<S: World> Told<'_, S> {
    /// The node that is put into the front next, and with which solidity.
    fn queued_after(&self, at: usize) -> Option<(u32, f32)> {
        self.film.events()[at..].iter().find_map(|e| match e {
            Event::Queued(n, s) => Some((n.0, *s)),
            _ => None,
        })
    }
    fn hear(&mut self, at: usize, forward: S::Vector) {
        let (what, fields) = self.film.fields(at);
        let v = |name| value(&fields, name);
        if what == "CellProjected" {
            self.solidity.insert(v("node") as u32, v("solidity"));
        }
        if what != "SolidityTransferred" {
            return;
        }
        let [transfer, update, penalty_as] = self.ways.each_ref().map(String::as_str);
        assert_eq!(self.solidity[&(v("from_node") as u32)], v("from_solidity"));
        let sum = v("held") / v("rho_max") + v("alignment") * v("from_solidity");
        assert!((sum - v("transferred")).abs() <= 1e-5 && v("alignment").abs() <= 1.00001);
        assert!(transfer == "aligned" || v("alignment") == 1.0);
        let [sight, normal] = ["view_direction", "normal"].map(|name| list(&fields, name));
        let product: f64 = sight.iter().zip(&normal).map(|(a, b)| a * b).sum();
        assert!(transfer == "whole" || (product - v("alignment")).abs() < 1e-5);
        self.counts[3] += usize::from((0..S::Vector::AXES).all(|a| sight[a] == f64::from(forward.get(a))));
        // The sentence says the formula that ran.
        let sentence = self.film.sentence(at);
        assert_eq!(sentence.contains("v · n"), transfer == "aligned", "{sentence}");
        let (node, star) = (v("node") as u32, v("star_shaped") == 1.0);
        assert_eq!(sentence.contains("times the penalty factor"), penalty_as == "factor" && !star);
        let want = match penalty_as {
            _ if star => v("transferred"),
            "factor" => 1.5 * v("transferred"),
            _ => v("transferred") + 0.5,
        };
        assert!((want - v("solidity")).abs() <= 1e-6 * want.abs(), "{want}");
        let waits = self.front.get(&node).is_some_and(|s| *s <= v("solidity"));
        let stays = update == "star-shaped" && !star && (self.settled.contains(&node) || waits);
        assert_eq!(v("keeps") == 1.0, stays, "{sentence}");
        if star {
            self.settled.insert(node);
        }
        if !stays {
            self.front.insert(node, v("solidity"));
            assert_eq!(self.queued_after(at), Some((node, v("solidity") as f32)));
        }
        self.counts[0] += 1;
        self.counts[1] += usize::from(!star);
        self.counts[2] += usize::from(stays);
    }
}

#[test]
fn solidity_is_handed_on_as_in_figure_5() {
    both(hands_on_solidity, hands_on_solidity);
}

#[test]
fn figure_6_written_out() {
    // The eye looks along x through A into B and C: B lies ahead, C beside.
    fn index(n: usize) -> CellId {
        CellId(n as u32)
    }
    let scene = samples::soup::<Flat>(1, 300);
    let params = Params { tessellation: CellKind::Octree, leaf_size: 30, ..Params::default() };
    let built = LayeredProjection::build(&scene, &params, None, &Quiet);
    let built = built.expect("nothing saved").expect("not cancelled");
    let cells = built.cells.any();
    let mut view = framing_view::<Flat>(&scene.bounds(), 64, 1);
    view.eye.position = cells.center(index(0));
    view.eye.target = view.eye.position + glam::Vec2::X;
    (view.eye.near, view.eye.fov) = (0.01, 3.0);
    let (mut list, mut recorder, mut front) =
        (DrawList::default(), Recorder::new(usize::MAX), Front::default());
    let frame = Frame { index: &built, scene: &scene, view: &view, params: &params, limit: None };
    front.begin(&frame);
    LayeredProjection::cull(&frame, &mut (), &mut front, &mut list, &mut recorder);
    let handed =
        recorder.notes.iter().filter_map(|n| if let Evidence::Transferred(t) = n { Some(t) } else { None });
    let first: Vec<_> = handed.take_while(|t| t.a == index(0)).collect();
    assert!(!first.is_empty());
    for t in first {
        let share = built.assignment.held(t.a) as f32 / built.assignment.most() as f32;
        // From the cell of the eye nothing is handed on but its own share.
        assert_eq!((t.of_a, t.solidity, t.star_shaped), (0.0, share, true), "{t:?}");
        assert!(t.sight.dot(t.normal) > 0.7, "the neighbors of a square lie straight ahead of its center");
    }
}

fn is_reproducible<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let of_seed = |seed: &str| {
        let mut run = run(scene, &[("tessellation", kind), ("seed", seed)]);
        views(scene).iter().map(|v| run.cull(v).prims).collect::<Vec<Vec<PrimId>>>()
    };
    assert_eq!(of_seed("1"), of_seed("1"), "{kind}");
    assert_eq!(
        of_seed("1") == of_seed("2"),
        kind != "delaunay",
        "{kind}: the seed moves the points of the triangulation only"
    );
}

#[test]
fn the_same_seed_gives_the_same_order() {
    both(is_reproducible, is_reproducible);
}

fn is_reported<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let view = views(scene)[4];
    let recording = run(scene, &[("tessellation", kind), ("budget", "9"), ("backface-culling", "true")])
        .record(&view, usize::MAX);
    let film = &recording.film;
    assert_eq!(recording.list.prims.len(), 9);
    assert!(film.events().iter().any(|e| matches!(
        e,
        Event::DecidedPrim(_, Verdict::OverBudget) | Event::DecidedNode(_, Verdict::OverBudget)
    )));
    for at in 0..film.events().len() {
        assert!(!film.sentence(at).contains("NaN") && film.sentence(at).len() > 10);
    }
    assert!(film.hierarchy().held(node_of(CellId(0))) >= film.hierarchy().prims(node_of(CellId(0))).len());
}

#[test]
fn what_the_budget_leaves_out_is_reported() {
    both(is_reported, is_reported);
}

fn is_saved<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let pairs = [("tessellation", kind), ("leaf-size", "10")];
    let mut made = run(scene, &pairs);
    let saved = made.hierarchy().save().expect("there is something to save");
    let entry = S::method("layered-projection").expect("listed");
    let restore = |pairs: &[(&str, &str)], bytes: &[u8]| {
        entry.restore(scene, &settings(pairs), bytes, &Quiet).map_err(|e| e.to_string())
    };
    let mut again = restore(&pairs, &saved).expect("it fits").expect("not cancelled");
    for view in views(scene) {
        assert_eq!(made.cull(&view), again.cull(&view), "{kind}");
    }
    assert_eq!(again.hierarchy().save(), Some(saved.clone()));
    let refused = |pairs: &[(&str, &str)], bytes: &[u8]| restore(pairs, bytes).err().expect("refused");
    assert!(refused(&[("tessellation", kind)], &saved).contains("leaf-size=10"));
    for at in (0..saved.len()).step_by(saved.len() / 40) {
        let mut bad = saved.clone();
        bad[at] ^= 4;
        assert!(!refused(&pairs, &bad).is_empty());
        assert!(!refused(&pairs, &saved[..at]).is_empty());
    }
    let other = samples::soup::<S>(77, 300);
    let elsewhere = entry.restore(&other, &settings(&pairs), &saved, &Quiet).err().map(|e| e.to_string());
    assert_eq!(elsewhere.as_deref(), Some("it was made for another scene"));
}

#[test]
fn saved_cells_are_those_that_were_made_and_fit_nothing_else() {
    both(is_saved, is_saved);
}

#[test]
fn a_hole_in_the_front_is_no_hole_in_the_picture() {
    // Two clusters far apart: the front may run dry between them, and a view that sees both finds both.
    let near = samples::soup::<Solid>(1, 200);
    let mut parts = Arc::unwrap_or_clone(near).into_parts();
    let count = parts.points.len();
    parts.points.iter_mut().skip(count / 2).for_each(|p| *p += glam::Vec3::splat(500.0));
    let scene = Arc::new(Scene::<Solid>::new(parts).expect("a scene"));
    for kind in KINDS {
        sees_all(&scene, kind);
    }
}

fn is_ended_from_outside<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let mut run = run(scene, &[("tessellation", kind), ("budget", "100%")]);
    for view in views(scene) {
        let all = run.cull(&view).prims;
        for most in [1, all.len() / 2, all.len() + 1] {
            let reported = std::cell::RefCell::new(Vec::new());
            let limit = |prims: &[PrimId]| {
                reported.borrow_mut().extend_from_slice(prims);
                reported.borrow().len() >= most
            };
            let part = run.cull_until(&view, Some(&limit)).prims;
            assert_eq!(part, all[..part.len()], "{kind}");
            assert!(part.len() >= most.min(all.len()), "{kind}: {} of {most}", part.len());
            assert_eq!(reported.into_inner(), part, "{kind}: all that was drawn was reported, once");
        }
    }
    assert!(!run.remembers());
}

#[test]
fn a_frame_can_be_ended_from_outside() {
    both(is_ended_from_outside, is_ended_from_outside);
}

fn grows_from_several_seeds<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let view = views(scene)[0];
    let film = run(scene, &[("tessellation", kind), ("seeds", "20"), ("budget", "100%")])
        .record(&view, usize::MAX)
        .film;
    let seeds = (0..film.events().len()).filter(|&at| film.fields(at).0 == "CellSeeded").count();
    assert!(seeds > 5, "{kind}: {seeds}");
    for kind_of in [("occupancy", "front-facing"), ("seeds", "20"), ("update", "latest")] {
        let drawn = run(scene, &[("tessellation", kind), ("budget", "100%"), kind_of]).cull(&view).prims;
        assert_eq!(
            render(scene, &view, &drawn).item,
            render(scene, &view, scene.live()).item,
            "{kind}, {kind_of:?}"
        );
    }
}

#[test]
fn extensions_change_the_order_and_lose_nothing() {
    both(grows_from_several_seeds, grows_from_several_seeds);
}

fn is_exact_with_queries<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let mut hidden = 0;
    for (budget, rules) in ["0", "10", "20%", "100%"].into_iter().zip(RULES.into_iter().cycle()) {
        for culled in ["false", "true"] {
            let pairs = [
                ("tessellation", kind),
                ("budget", budget),
                ("queries", "true"),
                ("backface-culling", culled),
                rules,
            ];
            let mut run = run(scene, &pairs);
            assert!(promises(&pairs), "it says so");
            for view in views(scene) {
                let (list, tally) = run.count(&view);
                hidden += tally.named().get("cells_hidden").copied().unwrap_or(0);
                let facing: Vec<PrimId> = scene
                    .live()
                    .iter()
                    .copied()
                    .filter(|p| culled == "false" || !scene.faces_away(*p, view.eye.position))
                    .collect();
                assert_eq!(
                    render(scene, &view, &list.prims).item,
                    render(scene, &view, &facing).item,
                    "{kind}, budget {budget}"
                );
                let mut once = list.ascending();
                once.dedup();
                assert_eq!(once.len(), list.prims.len(), "{kind}: drawn once");
            }
        }
    }
    assert!(hidden > 3, "{kind}: {hidden} cells hidden");
}

#[test]
fn queries_for_the_rest_make_it_exact() {
    both(is_exact_with_queries, is_exact_with_queries);
}

fn keeps_its_promise<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    let mut less = 0;
    for quality in ["50", "80", "95", "100"] {
        let mut run = run(scene, &[("tessellation", kind), ("budget", "1"), ("quality", quality)]);
        for view in views(scene) {
            let drawn = run.cull(&view).prims;
            let (image, truth) = (render(scene, &view, &drawn), render(scene, &view, scene.live()));
            let wrong = truth.wrong_pixels(&image) as f64 / truth.item.len() as f64;
            assert!(
                wrong <= 1.0 - quality.parse::<f64>().expect("a number") / 100.0,
                "{kind}, {quality}: {wrong}"
            );
            less += usize::from(wrong > 0.0);
        }
    }
    assert!(less > 0, "{kind}: some stopped early");
}

#[test]
fn no_more_pixels_are_wrong_than_the_quality_allows() {
    both(keeps_its_promise, keeps_its_promise);
}

#[test]
fn budgets_count_primitives_of_the_whole_scene() {
    assert_eq!(Budget::Percent(10.0).of(810_000), 81_000);
}

/// Whether evidence about one subject may stand for a decision about another.
fn is_about<S: World>(film: &dyn Film<S>, evidence: Subject, of: Subject) -> bool {
    match (evidence, of) {
        (Subject::Object(object), Subject::Prim(prim)) => film.scene().object_of(prim) == object,
        // A cell's own list leaves out what it shares with others: its box tells whether it meets it.
        (Subject::Node(node), Subject::Prim(prim)) => {
            let (cell, prim) = (film.hierarchy().bounds(node), film.scene().prim_bounds(prim));
            S::Vector::AXES
                == (0..S::Vector::AXES)
                    .filter(|&a| cell.min.get(a) <= prim.max.get(a) && prim.min.get(a) <= cell.max.get(a))
                    .count()
        }
        _ => evidence == of,
    }
}

/// The verdicts of decisions with the kinds of what they rest on.
type Grounds = std::collections::BTreeSet<(Verdict, &'static str)>;

fn has_evidence<S: World>(scene: &Arc<Scene<S>>, kind: &'static str, verdicts: &mut Grounds) {
    let extensions: [&[(&str, &str)]; 5] = [
        &[],
        &[("rules", "paper"), ("backface-culling", "true")],
        &[("queries", "true"), ("budget", "3%")],
        &[("quality", "90"), ("budget", "0")],
        &[("budget", "100%"), ("seeds", "5"), ("backface-culling", "true")],
    ];
    for pairs in extensions {
        let mut run = run(scene, &[pairs, &[("tessellation", kind)]].concat());
        for view in views(scene) {
            let film = run.record(&view, usize::MAX).film;
            for at in 0..film.events().len() {
                let Some(verdict) = film.events()[at].verdict().filter(|v| *v != Verdict::Partial) else {
                    continue;
                };
                let place = format!("{kind}, {pairs:?}, event {at}: {}", film.sentence(at));
                let evidence = film.evidence_of(at).unwrap_or_else(|| panic!("{place}"));
                assert!(is_about(&*film, film.subject(evidence), film.subject(at)), "{place}");
                let claim = film.claim(evidence).map(|c| c.word());
                match verdict {
                    Verdict::Outside => assert_eq!(claim, Some("outside"), "{place}"),
                    Verdict::FacesAway => assert_eq!(claim, Some("faces-away"), "{place}"),
                    // Without queries only what no cell in view holds.
                    Verdict::Hidden => assert!(
                        claim == Some("hidden") || film.kind(evidence) == "PrimUnreached",
                        "{place}: {}",
                        film.sentence(evidence)
                    ),
                    _ => assert_eq!(claim, None, "{place}"),
                }
                verdicts.insert((verdict, film.kind(evidence)));
            }
        }
    }
}

#[test]
fn every_decision_rests_on_evidence_about_what_it_decides() {
    let found = std::cell::RefCell::new(Grounds::new());
    both(
        |scene, kind| has_evidence(scene, kind, &mut found.borrow_mut()),
        |scene, kind| has_evidence(scene, kind, &mut found.borrow_mut()),
    );
    let found = found.into_inner();
    for wanted in [
        (Verdict::Hidden, "CellAsked"),
        (Verdict::Visible, "CellProjected"),
        (Verdict::OverBudget, "CellLeftOut"),
        (Verdict::OverBudget, "PrimLeftOut"),
    ] {
        assert!(found.contains(&wanted), "{wanted:?} is not among {found:?}");
    }
    assert!(found.iter().any(|(_, kind)| *kind == "PrimCompared"), "{found:?}");
}

#[test]
fn keyframes_take_less_memory_than_the_film() {
    const CELLS: usize = 100_000;
    let kept = <Front as State<Solid, LayeredProjection>>::KEYFRAME_NOTES;
    // A note is an event of its own, and a line of pseudocode comes with it.
    let recorded = |note: usize| kept * (note + 2 * size_of::<Event>());
    let copy = CELLS * Front::BYTES_A_CELL;
    for note in [size_of::<Evidence<Flat>>(), size_of::<Evidence<Solid>>()] {
        assert!(copy < recorded(note), "{copy} bytes a keyframe, {} recorded", recorded(note));
    }
}

#[test]
fn a_penalty_is_a_real_number_in_its_range() {
    let knobs = |text: &str| {
        Flat::method("layered-projection").expect("listed").knobs(&settings(&[("penalty", text)]))
    };
    let printed = |text: &str| {
        let all = knobs(text).expect("it fits");
        all.into_iter().find(|(knob, _)| knob.name == "penalty").map(|(_, value)| value.to_string())
    };
    assert_eq!((printed("30"), printed("2.5")), (Some("30".into()), Some("2.5".into())));
    for text in ["-1", "1001", "NaN", "inf", "much"] {
        let error = knobs(text).expect_err("refused").to_string();
        assert_eq!(error, format!("`penalty={text}`: expected a number from 0 to 1000"));
    }
}

/// The parameters from `rules` to `update`, as the method has them with these settings.
fn rule_values(pairs: &[(&str, &str)]) -> Vec<String> {
    let names = ["rules", "front", "transfer", "view-direction", "penalty-as", "penalty", "update"];
    let all = Flat::method("layered-projection").expect("listed").knobs(&settings(pairs)).expect("they fit");
    names.map(|name| all.iter().find(|(k, _)| k.name == name).expect("listed").1.to_string()).to_vec()
}

#[test]
fn rules_set_what_is_not_set_itself() {
    let ours = ["ours", "in-view", "whole", "cell", "sum", "30", "star-shaped"];
    let papers = ["paper", "everywhere", "aligned", "frame", "factor", "100", "latest"];
    assert_eq!(
        (rule_values(&[]), rule_values(&[("rules", "ours")])),
        (ours.map(Into::into).to_vec(), ours.map(Into::into).to_vec())
    );
    assert_eq!(rule_values(&[("rules", "paper")]), papers);
    // One that is set stands, whatever the rules.
    let mut mixed = papers;
    (mixed[2], mixed[5]) = ("whole", "0");
    assert_eq!(rule_values(&[("rules", "paper"), ("transfer", "whole"), ("penalty", "0")]), mixed);
    // What a film says of its parameters makes the same run again.
    let names = ["rules", "front", "transfer", "view-direction", "penalty-as", "penalty", "update"];
    let said: Vec<(&str, &str)> = names.into_iter().zip(mixed).collect();
    assert_eq!(rule_values(&said), mixed);
}

#[test]
fn it_promises_to_miss_nothing_where_it_misses_nothing() {
    assert!(!promises(&[]) && promises(&[("budget", "100%")]) && promises(&[("queries", "true")]));
    assert!(promises(&[("quality", "100")]) && !promises(&[("quality", "99")]));
    assert!(!promises(&[("queries", "true"), ("budget", "5ms")]), "time ends queries too");
}

/// What was left out is drawn with as much more budget as its evidence says, and not with one less.
fn names_what_was_missing<S: World>(scene: &Arc<Scene<S>>, kind: &'static str) {
    const BUDGET: usize = 20;
    let mut checked = [0; 3];
    for (view, rules) in views(scene).into_iter().zip(RULES.into_iter().cycle()) {
        let mut run = run(scene, &[("tessellation", kind), ("budget", &BUDGET.to_string()), rules]);
        let film = run.record(&view, usize::MAX).film;
        run.set_budget(Budget::Percent(100.0));
        // A smaller budget draws the beginning of it, which is tested elsewhere.
        let all = run.cull(&view).prims;
        let last = (0..film.events().len()).rfind(|&at| film.kind(at) == "CellProjected").expect("one");
        for at in 0..film.events().len() {
            let (what, fields) = film.fields(at);
            if !what.ends_with("LeftOut") {
                continue;
            }
            let more = value(&fields, "budget_short") as usize;
            assert_eq!(value(&fields, "last_node"), value(&film.fields(last).1, "node"));
            let text = film.sentence(at);
            assert!(text.contains(&format!("larger by {more} ")), "{text}");
            match film.subject(at) {
                Subject::Prim(prim) => {
                    assert_eq!(all[BUDGET + more - 1], prim, "{kind}: {text}");
                    checked[0] += 1;
                }
                Subject::Node(node) => {
                    let seen = &all[..BUDGET + more];
                    let mut of_cell = film.hierarchy().prims(node).iter().filter(|p| all.contains(p));
                    assert!(of_cell.all(|p| seen.contains(p)), "{kind}: {text}");
                    let waits = fields.iter().any(|f| f.name == "place");
                    assert_eq!(waits, text.contains("waits at place"));
                    checked[if waits { 1 } else { 2 }] += 1;
                }
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(checked[0] > 10 && checked[1] + checked[2] > 3, "{kind}: {checked:?}");
}

#[test]
fn what_the_budget_left_out_says_how_much_was_missing() {
    both(names_what_was_missing, names_what_was_missing);
}

#[test]
fn a_cell_in_which_the_budget_ends_is_not_kept_whole() {
    let scene = samples::soup::<Flat>(1, 300);
    let view = views(&scene)[4];
    let mut ended = 0;
    for budget in 1..40u32 {
        let film = run(&scene, &[("budget", &budget.to_string()), ("leaf-size", "30")])
            .record(&view, usize::MAX)
            .film;
        let spent = (0..film.events().len()).find(|&at| film.kind(at) == "BudgetSpent").expect("spent");
        let fields = film.fields(spent).1;
        assert_eq!(value(&fields, "drawn") as u32, budget);
        let node = crate::geometry::NodeId(value(&fields, "node") as u32);
        let left_out = value(&fields, "left_out") as usize;
        let decided = |e: &Event| matches!(e, Event::DecidedNode(n, _) if *n == node);
        let decision = film.events()[..spent].iter().rev().find(|e| decided(e)).expect("a decision");
        let verdict = if left_out > 0 { Verdict::Partial } else { Verdict::Visible };
        assert_eq!(*decision, Event::DecidedNode(node, verdict));
        // One verdict for each of its primitives, the same as in the list.
        let stamps = crate::trace::Stamps::new(&*film);
        let over = scene.live().iter().filter(|p| {
            let over = crate::trace::State::Decided(Verdict::OverBudget);
            film.hierarchy().prims(node).contains(p) && stamps.prim(**p, film.events().len()) == over
        });
        assert!(over.count() <= left_out);
        ended += usize::from(left_out > 0);
    }
    assert!(ended > 10, "{ended}");
}

#[test]
fn an_eye_outside_begins_at_the_cell_that_the_sentence_says() {
    let scene = samples::soup::<Solid>(2, 300);
    let view = views(&scene)[4];
    for rules in RULES {
        let film = run(&scene, &[rules, ("tessellation", "octree")]).record(&view, usize::MAX).film;
        let seeded = (0..film.events().len()).find(|&at| film.kind(at) == "CellSeeded").expect("a seed");
        let (fields, text) = (film.fields(seeded).1, film.sentence(seeded));
        let away = |node: u32| {
            let bounds = film.hierarchy().bounds(crate::geometry::NodeId(node));
            let eye = view.eye.position;
            f64::from((eye - eye.max(bounds.min).min(bounds.max)).length())
        };
        let (node, distance) = (value(&fields, "node") as u32, value(&fields, "distance_units"));
        assert!((away(node) - distance).abs() < 1e-4 * distance, "{text}");
        let nearer = (1..film.hierarchy().node_count() as u32).filter(|n| away(*n) < distance * 0.9999);
        let nearer: Vec<u32> = nearer.collect();
        if rules.1 == "paper" {
            assert!(text.contains("closest to it is node") && nearer.is_empty(), "{text}");
        } else {
            assert!(text.contains("in view that hold something"), "{text}");
            let holds = |n: &u32| film.hierarchy().held(crate::geometry::NodeId(*n)) > 0;
            let outside = |n: u32| {
                film.events().contains(&Event::DecidedNode(crate::geometry::NodeId(n), Verdict::Outside))
            };
            assert!(nearer.into_iter().filter(holds).all(outside), "{text}");
        }
    }
}

/// Whether a text says such as `1 cells`.
fn is_plural_of_one(text: &str) -> bool {
    let words: Vec<&str> = text.split([' ', '.', ',', ':', ';']).collect();
    words.windows(2).any(|w| w[0] == "1" && ["cells", "segments", "triangles", "are"].contains(&w[1]))
}

#[test]
fn counts_of_one_are_singular() {
    let scene = samples::soup::<Flat>(1, 300);
    let view = views(&scene)[4];
    let film = run(&scene, &[("budget", "1"), ("leaf-size", "100"), ("tessellation", "octree")])
        .record(&view, usize::MAX)
        .film;
    for at in 0..film.events().len() {
        let text = film.sentence(at);
        assert!(!is_plural_of_one(&text), "{text}");
        for which in 0..film.pictures().len() {
            for item in film.picture(at, which, crate::raster::DepthScale::default()).items {
                let crate::drawing::Mark::Text { text, .. } = item.mark else { continue };
                assert!(!is_plural_of_one(&text), "{text}");
            }
        }
    }
    assert!((0..film.events().len()).any(|at| film.sentence(at).contains("after 1 segment.")));
}
