//! Every listed method × both spaces × scenes × seeds keeps the promises that all methods make.
//!
//! - plain = counted = recorded: a watched run decides the same;
//! - told = answered: what the film says was kept is what was drawn;
//! - what is entered is left, the last one first;
//! - stamps = a naive fold of the events, at every step;
//! - any way to a step shows the same evidence;
//! - after the last note of a film its large state is that of the run;
//! - truth ⊆ answer, and the same image, if the method says that it is conservative;
//! - it culls at least what it culled before (culling nothing is conservative too);
//! - every certificate is accepted by the independent checker;
//! - every index keeps the contract of its trait, over degenerate scenes too;
//! - all of this in each frame of a scene that moves, whatever frame was before;
//! - what a film says is true: lines, evidence, sentences ([`spoken`]).

#[path = "conformance/spoken.rs"]
mod spoken;

use std::path::Path;
use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::drawing::Drawing;
use cullscope::geometry::{Flat, ObjectId, PrimId, Solid, Space, Vector, View};
use cullscope::method::{Entry, Event, Film, Run, Settings, Verdict};
use cullscope::raster::{Canvas, Drawable, Options, Target};
use cullscope::scene::{
    AnyScene, LoadOptions, Material, Motion, Object, Parts, Pose, Quiet, Scene, framing_view, load,
    random_views,
};
use cullscope::trace::{Stamp, Stamps};
use cullscope::truth::Truth;
use cullscope::truth::certificate::check_film;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

trait World: Methods + Drawable {}
impl<S: Methods + Drawable> World for S {}

/// Views from one seed a scene.
const VIEWS: usize = 4;
const SEEDS: [u64; 3] = [1, 2, 3];

/// Random primitives of mixed sizes, among them tiny ones and some that share planes.
fn soup<S: Space>(seed: u64, n: u32, make: fn([u32; 3]) -> S::Corners) -> Arc<Scene<S>> {
    let mut rng = Pcg32::new(seed, 71);
    let mut unit = move || (rng.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
    let (mut points, mut prims) = (Vec::new(), Vec::new());
    for k in 0..n {
        let middle = S::Vector::from_fn(|_| unit() * 20.0 - 10.0);
        let size = [0.01, 0.5, 3.0, 12.0][k as usize % 4];
        let level = if k % 5 == 0 { Some(middle.get(1).round()) } else { None };
        let first = points.len() as u32;
        for _ in 0..S::CORNERS {
            let around = S::Vector::from_fn(|_| (unit() - 0.5) * size);
            let point = middle + around;
            points.push(S::Vector::from_fn(|a| match level {
                Some(y) if a == 1 => y,
                _ => point.get(a),
            }));
        }
        prims.push(make([first, first + 1, first + 2]));
    }
    Arc::new(Scene::new(Parts::simple(&format!("soup {seed}"), points, prims)).expect("a valid scene"))
}

/// The same with every third primitive or object see-through, and every fourth with two sides.
fn glazed<S: Space>(scene: &Scene<S>, by_object: bool) -> Arc<Scene<S>> {
    let mut parts = scene.clone().into_parts();
    let first = parts.materials.len() as u32;
    for kind in 0..4 {
        let (see_through, two_sided) = (kind & 1 == 1, kind & 2 == 2);
        parts.materials.push(Material { see_through, two_sided, ..parts.materials[0].clone() });
    }
    for (at, material) in parts.prim_material.iter_mut().enumerate() {
        let which = if by_object { parts.prim_object[at].0 } else { at as u32 };
        material.0 = first + u32::from(which % 3 == 0) + 2 * u32::from(which % 4 == 0);
    }
    parts.name += ", glazed";
    Arc::new(Scene::new(parts).expect("a valid scene"))
}

fn file(path: &str) -> AnyScene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    load(&path.display().to_string(), &LoadOptions::default(), &Quiet).expect("a committed scene loads")
}

fn flat_scenes() -> Vec<Arc<Scene<Flat>>> {
    let mut scenes: Vec<_> = SEEDS.iter().map(|&s| soup::<Flat>(s, 60, |[a, b, _]| [a, b])).collect();
    scenes[2] = glazed(&scenes[2], false);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes2d");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("scenes2d").map(|e| e.expect("an entry").path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "json"));
    files.sort();
    for path in files {
        match load(&path.display().to_string(), &LoadOptions::default(), &Quiet)
            .expect("a committed scene loads")
        {
            AnyScene::Flat(scene) => scenes.push(scene),
            AnyScene::Solid(_) => panic!("{} is not flat", path.display()),
        }
    }
    scenes
}

fn solid_scenes() -> Vec<Arc<Scene<Solid>>> {
    let mut scenes: Vec<_> = SEEDS.iter().map(|&s| soup::<Solid>(s, 80, |c| c)).collect();
    scenes[2] = glazed(&scenes[2], false);
    let generated = |call: &str| load(call, &LoadOptions::default(), &Quiet).expect("a building");
    if let AnyScene::Solid(scene) = generated("generate:building?polygons=1000&seed=7") {
        scenes.push(glazed(&scene, true));
    }
    for scene in [
        generated("generate:building?polygons=2000&seed=5"),
        file("scenes3d/freedoom_e1m1/freedoom_e1m1.obj"),
    ] {
        match scene {
            AnyScene::Solid(scene) => scenes.push(scene),
            AnyScene::Flat(_) => panic!("a model in space"),
        }
    }
    scenes
}

/// Parameters to run a method with: the defaults, back faces culled, and each whole number at its least.
fn settings<S: World>(entry: &dyn Entry<S>) -> Vec<Settings> {
    use cullscope::method::KnobValue;
    let mut all = vec![Settings::default()];
    for (knob, value) in entry.knobs(&Settings::default()).expect("defaults fit") {
        let text = match value {
            KnobValue::Switch(on) => (!on).to_string(),
            KnobValue::Integer(_, range) => range.start().to_string(),
            KnobValue::Real(_, range) => range.start().to_string(),
            KnobValue::Budget(_) => "0".to_owned(),
            // Every other word in turn.
            KnobValue::Choice(chosen, options) => {
                let others = options
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| *i != chosen)
                    .map(|(_, word)| (*word).to_owned());
                all.extend(others.map(|word| Settings([(knob.name.to_owned(), word)].into())));
                continue;
            }
        };
        all.push(Settings([(knob.name.to_owned(), text)].into()));
    }
    all
}

/// Small views: from outside, from random places inside, and the first of the scene's own.
fn views<S: World>(scene: &Scene<S>, seed: u64) -> Vec<View<S>> {
    let mut views = random_views(scene, VIEWS, seed);
    views.push(framing_view(&scene.bounds(), 96, 96));
    views.extend(scene.paths().first().map(|p| p.views[0]));
    for view in &mut views {
        (view.width, view.height) = (96, view.height.min(96));
    }
    views
}

fn ready<S: World>(entry: &dyn Entry<S>, scene: &Arc<Scene<S>>, settings: &Settings) -> Box<dyn Run<S>> {
    entry.ready(scene, settings, &Quiet).expect("settings fit").expect("not cancelled")
}

fn each_case<S: World>(
    scenes: &[Arc<Scene<S>>],
    mut check: impl FnMut(&dyn Entry<S>, &Arc<Scene<S>>, &Settings),
) {
    for entry in S::methods() {
        for settings in settings(*entry) {
            scenes.iter().for_each(|scene| check(*entry, scene, &settings));
        }
    }
}

fn watched_runs_decide_the_same<S: World>(scenes: &[Arc<Scene<S>>]) {
    each_case(scenes, |entry, scene, settings| {
        let what = format!("{} {settings:?} on {}", entry.card().key, scene.name());
        let views = views(scene, 1);
        let [mut plain, mut counted, mut recorded, mut capped] =
            [(); 4].map(|()| ready(entry, scene, settings));
        for view in &views {
            let list = plain.cull(view);
            assert_eq!(list, counted.count(view).0, "{what}: counted");
            let film = recorded.record(view, usize::MAX);
            assert_eq!(list, film.list, "{what}: recorded");
            assert_eq!(recorded.ended_like(&*film.film), Some(true), "{what}: the film ends as the run did");
            assert_eq!(list, capped.record(view, 5).list, "{what}: recorded in part");
            told_is_answered(&*film.film, &list.prims, &what);
            entered_is_left(film.film.events(), &what);
            if let Err(why) = check_film(&*film.film) {
                panic!("{what}: {why}");
            }
        }
        plain.forget();
        let again: Vec<_> = views.iter().map(|v| plain.cull(v)).collect();
        plain.forget();
        assert_eq!(
            again,
            views.iter().map(|v| plain.cull(v)).collect::<Vec<_>>(),
            "{what}: after forgetting"
        );
    });
}

fn told_is_answered<S: Space>(film: &dyn Film<S>, drawn: &[PrimId], what: &str) {
    let stamps = Stamps::new(film);
    let mut kept = drawn.to_vec();
    kept.sort_unstable();
    assert!(kept.windows(2).all(|w| w[0] < w[1]), "{what}: each primitive is drawn at most once");
    let decided = |p: &&PrimId| {
        let stamp = stamps.prims()[p.at()];
        assert_ne!(stamp.step, Stamp::NEVER, "{what}: the fate of primitive {p} is told");
        stamp.verdict == Verdict::Visible
    };
    let told: Vec<PrimId> = film.scene().live().iter().filter(decided).copied().collect();
    assert_eq!(told, kept, "{what}: told and answered");
}

fn entered_is_left(events: &[Event], what: &str) {
    let mut open = Vec::new();
    for (at, event) in events.iter().enumerate() {
        match event {
            Event::Entered(node) => open.push(*node),
            Event::Left(node) => assert_eq!(
                open.pop(),
                Some(*node),
                "{what}: event {at} leaves the node that was entered last"
            ),
            _ => {}
        }
    }
    assert_eq!(open, [], "{what}: every node is left");
}

#[test]
fn watched_runs_decide_the_same_in_flatland() {
    watched_runs_decide_the_same(&flat_scenes());
}
#[test]
fn watched_runs_decide_the_same_in_space() {
    watched_runs_decide_the_same(&solid_scenes());
}

/// Films at every step against the plainest reading of their events.
fn films_replay<S: World>(scenes: &[Arc<Scene<S>>]) {
    for entry in S::methods() {
        for scene in scenes.iter().filter(|s| s.live().len() < 200) {
            let mut run = ready(*entry, scene, &Settings::default());
            let view = views(scene, 2)[0];
            let film = run.record(&view, usize::MAX).film;
            stamps_are_the_fold(&*film);
            run.forget();
            any_way_leads_to_the_same_step(&*film, &*run.record(&view, usize::MAX).film);
        }
    }
}

fn stamps_are_the_fold<S: Space>(film: &dyn Film<S>) {
    let stamps = Stamps::new(film);
    let mut fold = vec![None; film.scene().prim_count()];
    for step in 0..=film.events().len() {
        if let Some(at) = step.checked_sub(1) {
            match film.events()[at] {
                Event::DecidedNode(n, v) if v != Verdict::Partial => {
                    film.hierarchy().prims(n).iter().for_each(|p| _ = fold[p.at()].get_or_insert(v))
                }
                Event::DecidedPrim(p, v) if v != Verdict::Partial => _ = fold[p.at()].get_or_insert(v),
                _ => {}
            }
        }
        let counts = stamps.counts(step);
        for verdict in
            [Verdict::Outside, Verdict::Hidden, Verdict::Visible, Verdict::Approximated, Verdict::OverBudget]
        {
            let folded = fold.iter().flatten().filter(|v| **v == verdict).count();
            assert_eq!(counts.of(verdict), folded, "{}: {verdict:?} at step {step}", film.card().key);
        }
        let stamped = stamps.prims().iter().map(|s| (s.step as usize <= step).then_some(s.verdict));
        assert!(stamped.eq(fold.iter().copied()), "{} at step {step}", film.card().key);
    }
}

fn any_way_leads_to_the_same_step<S: Space>(film: &dyn Film<S>, fresh: &dyn Film<S>) {
    let draw = |film: &dyn Film<S>, step: usize| {
        let mut drawing = Drawing::default();
        film.explain(step, &mut drawing);
        drawing
    };
    let last = film.events().len();
    let forward: Vec<_> = (0..=last).map(|step| draw(film, step)).collect();
    let mut rng = Pcg32::new(last as u64, 5);
    for _ in 0..200 {
        let step = rng.next_u32() as usize % (last + 1);
        // One film was walked from the start, the other one is only jumped about in.
        assert_eq!(draw(fresh, step), forward[step], "{} at step {step}", film.card().key);
    }
    for step in (0..=last).rev() {
        assert_eq!(draw(film, step), forward[step], "{} at step {step}, backwards", film.card().key);
    }
    for at in 0..last {
        let what = format!("{} at event {at}", film.card().key);
        assert_eq!(film.fields(at), fresh.fields(at), "{what}");
        assert!(!film.sentence(at).is_empty() && film.sentence(at) == fresh.sentence(at), "{what}");
    }
}

#[test]
fn films_replay_in_flatland() {
    films_replay(&flat_scenes());
}
#[test]
fn films_replay_in_space() {
    films_replay(&solid_scenes());
}

/// What a method culls of what cannot be seen, over all scenes of a space: these shares only rise while the
/// scenes stay the same. (Before `box_and_objects` and `thin_slabs` came in `frustum` in flatland had 0.648
/// and `large-occluders` 0.81.)
#[derive(serde::Deserialize)]
struct Floor {
    method: String,
    space: String,
    share: f64,
}

/// The rows of a space.
fn floors<S: World>() -> Vec<Floor> {
    let all: Vec<Floor> = serde_json::from_str(include_str!("floors.json")).expect("floors.json is a list");
    for row in &all {
        assert!([Flat::NAME, Solid::NAME].contains(&&*row.space), "floors.json: no space {}", row.space);
    }
    let rows: Vec<Floor> = all.into_iter().filter(|row| row.space == S::NAME).collect();
    for (i, row) in rows.iter().enumerate() {
        assert!(S::method(&row.method).is_some(), "floors.json: no method {} in {}", row.method, S::NAME);
        assert!(
            rows[..i].iter().all(|other| other.method != row.method),
            "floors.json: {} twice",
            row.method
        );
    }
    rows
}

fn nothing_visible_is_missed<S: World>(scenes: &[Arc<Scene<S>>]) {
    let (floors, mut fallen) = (floors::<S>(), Vec::new());
    for entry in S::methods() {
        let key = entry.card().key;
        let (mut unseen, mut culled) = (0, 0);
        for scene in scenes {
            let ways: [&[(&str, &str)]; 3] =
                [&[], &[("backface-culling", "true")], &[("see-through", "solid")]];
            // Where nothing is see-through, solid is nothing new.
            for pairs in &ways[..2 + usize::from(scene.has_see_through())] {
                let settings = Settings::of(pairs);
                let surfaces = settings.surfaces();
                let mut run = ready(*entry, scene, &settings);
                let promises = entry.is_conservative(&settings).expect("settings fit");
                let mut truth = Truth::new(scene, surfaces, 1, [1.0; 3]);
                for view in SEEDS.iter().flat_map(|&seed| views(scene, seed)) {
                    let list = run.cull(&view);
                    let (mut target, mut canvas) = (Target::default(), Canvas::default());
                    let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
                    list.draw((&mut target, &mut canvas), scene, &view, &options);
                    let judged = truth.judge(scene, &view, &list, (&target, &canvas));
                    if promises {
                        assert!(judged.is_exact(), "{key} on {}: {judged:?} in {view:?}", scene.name());
                        assert_eq!((judged.coverage_ratio(), judged.flip_mean), (1.0, 0.0), "{key}");
                    }
                    // The floors are of opaque scenes.
                    if !surfaces.one_sided && !scene.has_see_through() {
                        let seen_and_drawn = judged.visible.len() - judged.missed.len();
                        unseen += scene.live().len() - judged.visible.len();
                        culled += scene.live().len() - judged.visible.len() - (judged.drawn - seen_and_drawn);
                    }
                }
            }
        }
        let share = culled as f64 / unseen as f64;
        let row = floors.iter().find(|row| row.method == key);
        let Some(&Floor { share: floor, .. }) = row else {
            panic!("floors.json: `{key}` in {} needs a row; it culls {share:.3}", S::NAME)
        };
        if share < floor {
            fallen.push(format!(
                "{key} in {} culls {share:.4} of what cannot be seen, it culled {floor} before",
                S::NAME
            ));
        }
        println!("{key} in {}: {share:.4}", S::NAME);
    }
    assert!(fallen.is_empty(), "{}", fallen.join("\n"));
}

#[test]
fn nothing_visible_is_missed_in_flatland() {
    nothing_visible_is_missed(&flat_scenes());
}
#[test]
fn nothing_visible_is_missed_in_space() {
    nothing_visible_is_missed(&solid_scenes());
}

/// A corner of a primitive by its number, with whole numbers at random below a bound.
type Corner<'a, V> = &'a mut dyn FnMut(&mut dyn FnMut(u32) -> f32, u32) -> V;

/// Scenes where sizes, distances or differences vanish: one primitive, all at one place, all alike, all in
/// one plane (line), and corners on a coarse grid, where dividing planes fall.
fn degenerate<S: Space>(make: fn([u32; 3]) -> S::Corners) -> Vec<Arc<Scene<S>>> {
    let mut rng = Pcg32::new(9, 71);
    let mut grid = move |n: u32| (rng.next_u32() % n) as f32;
    let mut scene = |name: &str, n: u32, corner: Corner<'_, S::Vector>| {
        let points = (0..n * S::CORNERS as u32).map(|k| corner(&mut grid, k % S::CORNERS as u32)).collect();
        let first = |k: u32| k * S::CORNERS as u32;
        let prims = (0..n).map(|k| make([first(k), first(k) + 1, first(k) + 2])).collect();
        Arc::new(Scene::new(Parts::simple(name, points, prims)).expect("a valid scene"))
    };
    let apart = |corner: u32| S::Vector::from_fn(|a| if a as u32 == corner { 1.0 } else { 0.25 });
    vec![
        scene("one primitive", 1, &mut |_, corner| apart(corner)),
        scene("one place", 40, &mut |_, _| S::Vector::splat(3e4)),
        scene("all alike", 60, &mut |_, corner| apart(corner)),
        scene("one plane", 60, &mut |grid, _| S::Vector::from_fn(|a| if a == 1 { 2.0 } else { grid(9) })),
        scene("a grid", 150, &mut |grid, _| S::Vector::from_fn(|_| grid(5))),
    ]
}

fn indices_are_well_formed<S: World>(random: &[Arc<Scene<S>>], make: fn([u32; 3]) -> S::Corners) {
    let mut scenes = degenerate(make);
    scenes.extend(random.iter().cloned());
    let mut divided = 0;
    each_case(&scenes, |entry, scene, settings| {
        let prims: Vec<_> = scene.live().iter().map(|&p| (p, scene.prim_bounds(p))).collect();
        let run = ready(entry, scene, settings);
        let fault = run.hierarchy().fault(&prims);
        assert_eq!(fault, None, "{} {settings:?} on {}", entry.card().key, scene.name());
        divided += u32::from(run.hierarchy().node_count() > 3);
    });
    assert!(divided > 50, "only {divided} indices have more than a few nodes");
}

#[test]
fn indices_are_well_formed_in_flatland() {
    indices_are_well_formed(&SEEDS.map(|s| soup::<Flat>(s, 60, |[a, b, _]| [a, b])), |[a, b, _]| [a, b]);
}
#[test]
fn indices_are_well_formed_in_space() {
    indices_are_well_formed(&SEEDS.map(|s| soup::<Solid>(s, 80, |c| c)), |c| c);
}

/// The same in objects of a few primitives each, of which two of three move through the others.
fn moving<S: Space>(scene: &Scene<S>) -> Arc<Scene<S>> {
    let mut parts = scene.clone().into_parts();
    let each = parts.prims.len().div_ceil(15);
    let pose = |k: usize, frame: usize| {
        let half = (frame * (17 + k)) as f32 * 0.02;
        let along = frame as f32 * (k as f32 - 7.0) * 0.35;
        let rotation = [0.0, 0.0, half.sin(), half.cos()];
        Pose { rotation, translation: [along, 0.2 * along, -0.3 * along] }
    };
    let object = |k: usize| Object {
        name: format!("part {k}"),
        group: String::new(),
        motion: (k % 3 != 2).then(|| (0..5 + k % 3).map(|frame| pose(k, frame)).collect()),
    };
    parts.objects = (0..15).map(object).collect();
    for (at, object) in parts.prim_object.iter_mut().enumerate() {
        *object = ObjectId((at / each) as u32);
    }
    parts.faces.clear();
    parts.name += ", moving";
    Arc::new(Scene::new(parts).expect("a valid scene"))
}

/// Frames in an order in which a person may look at them.
const FRAMES: [usize; 7] = [0, 1, 2, 3, 9, 3, 0];

fn what_moves_is_followed<S: World>(scenes: &[Arc<Scene<S>>]) {
    let mut moved = 0;
    each_case(scenes, |entry, scene, settings| {
        // Large ones take their time, and say nothing new of parameters.
        if scene.live().len() > 200 && !settings.0.is_empty() {
            return;
        }
        let mut motion = Motion::new(scene);
        let first = motion.at(0);
        let [mut plain, mut counted, mut recorded, mut straight] =
            [(); 4].map(|()| ready(entry, &first, settings));
        let mut truth = Truth::new(&first, settings.surfaces(), 1, [1.0; 3]);
        let options = Options { surfaces: settings.surfaces().both_sides(), ..Options::default() };
        for (frame, view) in FRAMES.into_iter().zip(views(scene, 1).into_iter().cycle()) {
            let what = format!("{} {settings:?} on {}, frame {frame}", entry.card().key, scene.name());
            let now = motion.at(frame);
            for run in [&mut plain, &mut counted, &mut recorded] {
                assert!(run.pose(&now, &Quiet), "{what}");
            }
            let prims: Vec<_> = now.live().iter().map(|&p| (p, now.prim_bounds(p))).collect();
            assert_eq!(plain.hierarchy().fault(&prims), None, "{what}");
            let list = plain.cull(&view);
            assert_eq!(list, counted.count(&view).0, "{what}: counted");
            let film = recorded.record(&view, usize::MAX);
            assert_eq!(list, film.list, "{what}: recorded");
            assert_eq!(recorded.ended_like(&*film.film), Some(true), "{what}: the film ends as the run did");
            told_is_answered(&*film.film, &list.prims, &what);
            check_film(&*film.film).unwrap_or_else(|why| panic!("{what}: {why}"));
            let (mut target, mut canvas) = (Target::default(), Canvas::default());
            list.draw((&mut target, &mut canvas), &now, &view, &options);
            let judged = truth.judge(&now, &view, &list, (&target, &canvas));
            assert!(
                judged.is_exact() || !entry.is_conservative(settings).expect("settings fit"),
                "{what}: {judged:?} in {view:?}"
            );
            // What there was before makes no difference, once it is forgotten.
            plain.forget();
            straight.forget();
            assert!(straight.pose(&first, &Quiet) && straight.pose(&now, &Quiet), "{what}");
            assert_eq!(plain.cull(&view), straight.cull(&view), "{what}: straight there");
            counted.forget();
            recorded.forget();
            counted.cull(&view);
            recorded.cull(&view);
            moved += u32::from(now.bounds() != first.bounds());
        }
        // The last frame is that which it was built for.
        let view = views(scene, 1)[0];
        plain.forget();
        assert_eq!(plain.cull(&view), ready(entry, &first, settings).cull(&view), "{}", scene.name());
    });
    assert!(moved > 100, "only {moved} frames differ from the first in their bounds");
}

#[test]
fn what_moves_is_followed_in_flatland() {
    let mut scenes: Vec<_> =
        SEEDS.iter().map(|&s| moving(&soup::<Flat>(s, 60, |[a, b, _]| [a, b]))).collect();
    scenes[1] = glazed(&scenes[1], false);
    if let AnyScene::Flat(door) = file("scenes2d/moving_door.json") {
        scenes[2] = door;
    }
    what_moves_is_followed(&scenes);
}
#[test]
fn what_moves_is_followed_in_space() {
    let mut scenes: Vec<_> = SEEDS[..2].iter().map(|&s| moving(&soup::<Solid>(s, 80, |c| c))).collect();
    scenes[1] = glazed(&scenes[1], false);
    let generated = load("generate:building?polygons=1000&seed=7", &LoadOptions::default(), &Quiet);
    if let AnyScene::Solid(scene) = generated.expect("a building") {
        scenes.push(moving(&scene));
    }
    what_moves_is_followed(&scenes);
}
