//! The explorer without its window, driven by commands.

use super::recall::spoken_command;
use super::shown::Detail;
use super::*;
use crate::drawing::Subject;
use crate::geometry::{Aabb, Either, NodeId, ObjectId, PrimId, Solid, View};
use crate::method::Verdict;

/// A flatland scene that travels inside the program.
const FLAT: &str = "freedoom_e1m1";

fn opened(source: &str) -> State {
    let mut state = State::new();
    state.apply(Command::Open(source.into()));
    state.block_until_idle();
    assert!(state.film().is_some(), "{:?}", state.notices);
    state
}

/// A scene with a method.
pub(super) fn opened_with(source: &str, method: &str) -> State {
    let mut state = State::new();
    for command in [Command::Open(source.into()), Command::Method(method.into())] {
        state.apply(command);
        state.block_until_idle();
    }
    state
}

/// What a person sees that a step decides.
fn seen(state: &State) -> (usize, String, Option<u8>, crate::trace::Counts) {
    let film = state.film().expect("a film");
    (state.step, state.sentence(), state.line(), film.stamps.counts(state.step))
}

#[test]
fn a_flight_becomes_a_path_that_can_be_followed() {
    let mut state = opened(FLAT);
    let place = |state: &State| state.staged().map(|s| s.place());
    let Some(Either::Flat(start)) = state.stage.as_ref().map(|s| s.view()) else { panic!("a flat stage") };
    let paths = |state: &State| if let Some(Either::Flat(s)) = &state.stage { s.paths.len() } else { 0 };
    let before = paths(&state);
    state.apply(Action::Flight);
    state.apply(Action::Flight);
    assert_eq!(paths(&state), before, "the Eye was not moved, so there is no path");
    state.apply(Action::Flight);
    let mut flown = vec![start];
    for k in 1..5 {
        let mut view = start;
        view.eye.position.x += k as f32;
        view.eye.target.x += k as f32;
        state.apply(Command::Eye(Either::Flat(view), 7));
        flown.push(view);
    }
    state.folder = std::env::temp_dir().join(format!("cullscope-flight-{}", std::process::id()));
    std::fs::create_dir_all(&state.folder).expect("a folder of our own");
    state.apply(Action::Flight);
    let text = std::fs::read_to_string(state.folder.join(format!("{FLAT}-flight.views.json")));
    std::fs::remove_dir_all(&state.folder).expect("a folder of our own");
    let text = text.expect("a view file");
    let Some(Either::Flat(stage)) = &state.stage else { panic!("a flat stage") };
    assert_eq!(
        stage.paths.last().map(|p| (p.name.as_str(), p.views.as_slice())),
        Some(("flight", flown.as_slice()))
    );
    assert_eq!(place(&state), Some((before, 0)));
    assert!(text.contains("\"views\"") && text.matches("\"eye\"").count() == 5, "{text}");
    state.block_until_idle();
    state.apply(Command::Frame(before, 4));
    assert!(matches!(state.stage.as_ref().map(|s| s.view()), Some(Either::Flat(v)) if v == flown[4]));
}

#[test]
fn forward_and_back_is_the_same_state() {
    let mut state = opened(FLAT);
    for there_and_back in [(Action::Forward, Action::Back), (Action::Into, Action::BackInto)] {
        for detail in [Detail::Full, Detail::Coarse] {
            state.apply(Command::Detail(detail));
            state.apply(Command::GoTo(0));
            let mut passed = vec![seen(&state)];
            for _ in 0..60 {
                state.apply(there_and_back.0);
                passed.push(seen(&state));
            }
            while let Some(now) = passed.pop() {
                assert_eq!(seen(&state), now, "{there_and_back:?} {detail:?}");
                state.apply(there_and_back.1);
            }
            assert_eq!(state.step, 0);
        }
    }
}

#[test]
fn playing_reaches_the_end_and_stops() {
    let mut state = opened(FLAT);
    state.apply(Command::Speed(1000.0));
    state.apply(Action::PlayPause);
    let mut ticks = 0;
    while state.tick(0.1) {
        ticks += 1;
        assert!(ticks < 1000);
    }
    assert_eq!((state.step, state.is_playing), (state.len(), false));
    // Playing from the end begins anew.
    state.apply(Action::PlayPause);
    assert_eq!((state.step, state.is_playing), (0, true));
}

#[test]
fn a_run_stops_at_breakpoints_forwards_and_backwards() {
    let mut state = opened(FLAT);
    state.apply(Command::BreakVerdict(Verdict::Outside));
    let mut stops = vec![];
    loop {
        let before = state.step;
        state.apply(Action::Run);
        if state.step == before {
            break;
        }
        stops.push(state.step);
    }
    assert!(stops.len() > 3, "{stops:?}");
    let said = |state: &State| state.notices.last().map(|n| n.text.clone()).unwrap_or_default();
    assert!(said(&state).contains("after this step"), "a run that stops nowhere says so: {}", said(&state));
    stops.pop();
    while let Some(stop) = stops.pop() {
        state.apply(Action::RunBack);
        assert_eq!(state.step, stop);
    }
    let first = state.step;
    state.apply(Action::RunBack);
    assert_eq!(state.step, first, "and stays where it is");
    state.apply(Command::GoTo(0));
    state.apply(Command::Select(Subject::Node(NodeId(3))));
    state.apply(Action::Breakpoint);
    assert!(state.breakpoints.contains(&Breakpoint::Node(NodeId(3))));
    // A playing film stops there too.
    state.breakpoints.retain(|b| matches!(b, Breakpoint::Node(_)));
    state.apply(Command::Speed(1e6));
    state.apply(Action::PlayPause);
    while state.tick(0.5) {}
    assert_eq!(state.current_subject(), Subject::Node(NodeId(3)));
}

#[test]
fn a_breakpoint_where_no_run_comes_says_so() {
    let mut state = opened("scenes2d/street.json");
    state.apply(Command::Method("frustum".into()));
    state.block_until_idle();
    let lines = state.film().expect("a film").reel.card().code.len() as u8;
    let lost = (0..lines).find(|&l| !state.reaches(l)).expect("a line that this frame never comes to");
    state.apply(Command::BreakLine(lost));
    assert!(state.notices.iter().any(|n| n.text.contains("never comes to")), "{:?}", state.notices);
    state.apply(Action::Run);
    assert_eq!(state.step, 0, "no run stops there, and none goes to the end");
    state.notices.clear();
    let reached = (0..lines).find(|&l| state.reaches(l)).expect("a line");
    state.apply(Command::BreakLine(reached));
    assert!(state.notices.is_empty(), "{:?}", state.notices);
    state.apply(Action::Run);
    assert!(state.step > 0);
}

#[test]
fn a_parameter_and_the_eye_are_culled_again_and_undone() {
    let mut state = opened(FLAT);
    let first = state.film().map(|f| f.serial);
    let events = state.len();
    state.apply(Command::Set("tree-height".into(), "3".into(), 1));
    state.apply(Command::Set("tree-height".into(), "2".into(), 1));
    state.block_until_idle();
    assert!(state.len() < events);
    assert_ne!(state.film().map(|f| f.serial), first);
    // Both changes were one gesture.
    state.apply(Action::Undo);
    state.block_until_idle();
    assert_eq!(state.len(), events);
    state.apply(Action::Redo);
    state.block_until_idle();
    assert!(state.len() < events);
    state.apply(Action::Undo);

    let before = state.stage.as_ref().expect("a stage").view();
    let Either::Flat(mut view) = before else { panic!("flatland") };
    view.eye.position.y += 1.0;
    state.apply(Command::Eye(Either::Flat(view), 2));
    assert!(state.staged().expect("a stage").is_eye_moved());
    state.apply(Action::LockEye);
    view.eye.position.y += 1.0;
    state.apply(Command::Eye(Either::Flat(view), 3));
    assert_ne!(state.stage.as_ref().expect("a stage").view(), Either::Flat(view), "a locked Eye stays");
    state.apply(Action::Undo);
    assert_eq!(state.stage.as_ref().expect("a stage").view(), before);
    view.eye.target = view.eye.position;
    state.apply(Action::LockEye);
    state.apply(Command::Eye(Either::Flat(view), 4));
    assert_eq!(state.stage.as_ref().expect("a stage").view(), before, "an Eye that cannot see is refused");
    state.block_until_idle();
}

#[test]
fn a_bad_parameter_is_told_and_the_film_stays() {
    let mut state = opened(FLAT);
    let events = state.len();
    state.apply(Command::Set("tree-height".into(), "enormous".into(), 0));
    state.block_until_idle();
    assert!(
        state.notices.iter().any(|n| n.is_error && n.text.contains("tree-height")),
        "{:?}",
        state.notices
    );
    assert_eq!(state.len(), events);
}

#[test]
fn a_broken_file_is_told_and_the_old_scene_stays() {
    let mut state = opened(FLAT);
    state.apply(Command::GoTo(20));
    let before = seen(&state);
    for source in ["no/such/file.obj", "Cargo.toml", "generate:nothing", "no.session.json"] {
        state.apply(Command::Open(source.into()));
        state.block_until_idle();
        assert!(state.notices.last().is_some_and(|n| n.is_error), "{source}: {:?}", state.notices);
        assert_eq!(seen(&state), before, "{source}");
        assert!(!state.notices.last().expect("a notice").text.contains('\n'));
    }
}

#[test]
fn stale_answers_are_dropped() {
    let mut state = opened(FLAT);
    for height in 1..12 {
        state.apply(Command::Set("tree-height".into(), height.to_string(), 0));
    }
    state.block_until_idle();
    let knobs = state.film().expect("a film").reel.knobs();
    assert!(knobs.iter().any(|(k, v)| k.name == "tree-height" && v.to_string() == "11"), "{knobs:?}");
    // What was cancelled never arrives.
    state.apply(Command::Set("tree-height".into(), "2".into(), 0));
    state.apply(Action::Cancel);
    std::thread::sleep(std::time::Duration::from_millis(100));
    state.poll();
    let knobs = state.film().expect("a film").reel.knobs();
    assert!(knobs.iter().any(|(k, v)| k.name == "tree-height" && v.to_string() == "11"), "{knobs:?}");
}

#[test]
fn why_names_the_decision_and_its_evidence() {
    let mut state = opened(FLAT);
    state.apply(Action::Last);
    let (stage, film) = (state.staged().expect("a stage"), state.film().expect("a film"));
    let mut kinds = std::collections::BTreeSet::new();
    for p in (0..400).map(PrimId).filter(|&p| stage.scene().has_prim(p)) {
        let (at, verdict) = film.stamps.prim_decision(p).expect("decided");
        kinds.insert(verdict);
        let lines = why(stage, Subject::Prim(p), state.step);
        assert!(lines.len() >= 2, "{lines:?}");
        assert!(lines[0].text.contains(spoken(verdict)), "{lines:?}");
        assert_eq!(lines[0].step, Some(at));
        // Before that step nothing is claimed.
        let early = why(stage, Subject::Prim(p), at - 1);
        assert!(early[0].text.contains("yet"), "{early:?}");
        // The reasons stay when one goes to the step of one of them.
        assert_eq!(early[1..], lines[1..]);
    }
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), [Verdict::Outside, Verdict::Visible]);
    for n in (0..film.node_count() as u32).map(NodeId) {
        assert!(!why(stage, Subject::Node(n), state.step).is_empty(), "{n}");
    }
    state.apply(Command::Select(Subject::Prim(PrimId(0))));
    state.apply(Action::Why);
    let decided = state.film().and_then(|f| f.stamps.prim_decision(PrimId(0)));
    assert_eq!(Some(state.step), decided.map(|d| d.0));
}

#[test]
fn the_event_tree_folds_filters_and_reveals() {
    let mut state = opened(FLAT);
    let all = state.len();
    assert_eq!(state.outline.rows().len(), all);
    state.apply(Action::FoldAll);
    let folded = state.outline.rows().len();
    assert!(folded < 10, "{folded}");
    state.apply(Command::GoTo(100));
    assert!(state.outline.rows().contains(&99), "the current event is shown");
    state.apply(Command::Filter("verdict:outside kind:node".into()));
    let rows = state.outline.rows();
    let outside = state.events().iter().filter(|e| e.verdict() == Some(Verdict::Outside)).count();
    assert_eq!(rows.len(), outside);
    state.apply(Command::Filter("under:3 -line".into()));
    let within = state.outline.rows().len();
    assert!(within > 0 && within < all);
    state.apply(Action::UnfoldAll);
    state.apply(Command::Filter("depth>x".into()));
    assert!(state.outline.error().is_some());
    state.apply(Command::Filter("nonsense:1".into()));
    assert!(state.outline.error().is_some_and(|e| e.to_string().contains("verdict:")));
    assert_eq!(state.outline.rows().len(), all, "a filter that makes no sense hides nothing");
}

#[test]
fn a_session_brings_everything_back() {
    let mut state = opened(FLAT);
    let (_, frames) = state.staged().expect("a stage").paths()[0];
    state.apply(Command::Method("centroid".into()));
    state.apply(Command::Set("budget".into(), "50%".into(), 0));
    state.apply(Command::Frame(0, frames.min(3) - 1));
    state.block_until_idle();
    let Either::Flat(mut view) = state.stage.as_ref().expect("a stage").view() else { panic!("flatland") };
    view.eye.position.x += 0.123_456_7;
    state.apply(Command::Eye(Either::Flat(view), 0));
    state.block_until_idle();
    state.apply(Command::GoTo(40));
    state.apply(Action::Bookmark);
    state.apply(Command::Note(0, "here it begins".into()));
    state.apply(Command::Select(Subject::Prim(PrimId(7))));
    state.apply(Action::ThemeDark);
    state.apply(Action::LookInCut);
    state.apply(Command::Observe(ObserverCamera { yaw: 2.0, distance: 3.5, ..state.observer }));
    let stops = [Breakpoint::Verdict(Verdict::Visible), Breakpoint::Line(1), Breakpoint::Prim(PrimId(3))];
    state.breakpoints.extend(stops);
    let session = state.session();
    let again = Session::parse(&session.text(), "test").expect("its own text");
    assert_eq!(again, session);
    let mut other = State::new();
    other.restore(again, None);
    other.block_until_idle();
    assert_eq!(other.session(), session, "{:?}", other.notices);
    assert_eq!(seen(&other), seen(&state));
    assert_eq!((&other.breakpoints, other.observer), (&state.breakpoints, state.observer));
    assert!(!other.is_to_frame, "the picture must not be framed anew");
    assert!(Session::parse("{}", "x").is_err());
    assert!(
        Session::parse(&session.text().replace("\"cullscope_session\": 1", "\"cullscope_session\": 9"), "x")
            .is_err()
    );
}

/// A folder of our own, and in it a box of 20 units with a window-less inside, as a model without views.
fn folder_with_a_box(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("cullscope-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("models")).expect("a folder of our own");
    let mut text = String::new();
    for i in 0..8 {
        let at = |bit: i32| if i >> bit & 1 == 1 { 20 } else { 0 };
        text += &format!("v {} {} {}\n", at(0), at(1), at(2));
    }
    text += "o floor\nf 1 2 6 5\no walls\nf 1 3 4 2\nf 5 6 8 7\nf 1 5 7 3\nf 2 4 8 6\no roof\nf 3 7 8 4\n";
    std::fs::write(folder.join("models/box.obj"), text).expect("a file of our own");
    folder
}

#[test]
fn a_session_keeps_the_eye_of_a_flight() {
    let mut state = opened(FLAT);
    state.folder = std::env::temp_dir();
    state.apply(Action::Flight);
    let Some(Either::Flat(mut view)) = state.stage.as_ref().map(|s| s.view()) else { panic!("flatland") };
    view.eye.position.x += 1.0;
    state.apply(Command::Eye(Either::Flat(view), 0));
    state.apply(Action::Flight);
    let path = state.staged().map_or(0, |s| s.place().0);
    state.apply(Command::Frame(path, 1));
    state.block_until_idle();
    let _ = std::fs::remove_file(state.folder.join(format!("{FLAT}-flight.views.json")));
    let mut other = State::new();
    other.restore(state.session(), None);
    other.block_until_idle();
    assert_eq!(other.stage.as_ref().map(|s| s.view()), state.stage.as_ref().map(|s| s.view()));
}

fn solid_view(state: &State) -> View<Solid> {
    let Some(Either::Solid(stage)) = &state.stage else { panic!("a stage of space") };
    stage.view
}

#[test]
fn a_session_finds_its_scene_from_every_folder() {
    let folder = folder_with_a_box("session");
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let mut state = opened(&path("models/box.obj"));
    state.apply(Command::SaveTo(path("talk.session.json")));
    let text = std::fs::read_to_string(folder.join("talk.session.json")).expect("a session");
    assert!(text.contains("\"models/box.obj\""), "the way from the session's folder: {text}");
    let reopened = |at: &std::path::Path| {
        let mut state = State::new();
        state.apply(Command::Open(at.join("talk.session.json").to_string_lossy().into_owned()));
        state.block_until_idle();
        let name = state.staged().map(|s| s.scene().name().to_owned());
        (name, state.notices.iter().map(|n| n.text.clone()).collect::<Vec<_>>().join(" "))
    };
    // The whole folder moves.
    let moved = folder.with_extension("moved");
    let _ = std::fs::remove_dir_all(&moved);
    std::fs::rename(&folder, &moved).expect("a move");
    assert_eq!(reopened(&moved), (Some("box".into()), String::new()));
    // The scene moves beside the session and has another name: it is known by its content.
    std::fs::rename(moved.join("models/box.obj"), moved.join("crate.obj")).expect("a move");
    std::fs::write(moved.join("another.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a file");
    let (name, said) = reopened(&moved);
    assert!(name.as_deref() == Some("crate") && said.contains("by its content"), "{name:?} {said}");
    std::fs::remove_file(moved.join("crate.obj")).expect("a file of our own");
    let (name, said) = reopened(&moved);
    assert!(name.is_none() && said.contains("models/box.obj") && said.contains("was not found"), "{said}");
    std::fs::remove_dir_all(&moved).expect("a folder of our own");
}

#[test]
fn an_eye_sees_near_and_far_enough_wherever_it_is_moved() {
    let folder = folder_with_a_box("eye");
    let mut state = opened(&folder.join("models/box.obj").to_string_lossy());
    std::fs::remove_dir_all(&folder).expect("a folder of our own");
    let start = solid_view(&state);
    let bounds = Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::splat(20.0) };
    let reach = |at: glam::Vec3| bounds.corners().map(|c| (c - at).length()).fold(0.0, f32::max);
    let sees_all = |view: View<Solid>| {
        view.eye.near <= bounds.diagonal() / 900.0 && view.eye.far >= reach(view.eye.position)
    };
    assert!(sees_all(start), "{start:?}");
    let go = |state: &mut State, position: glam::Vec3| {
        let mut view = solid_view(state);
        (view.eye.position, view.eye.target) = (position, position + glam::Vec3::X);
        state.apply(Command::Eye(Either::Solid(view), 0));
        state.block_until_idle();
        let said = state.staged().and_then(|s| s.changed_depths());
        (solid_view(state), said)
    };
    // Close before the wall, where the near plane of the old frame cut everything away.
    let (inside, said) = go(&mut state, glam::Vec3::new(18.0, 10.0, 10.0));
    assert!(sees_all(inside) && said.is_none(), "{inside:?}");
    let end = state.film().expect("a film").stamps.counts(state.len());
    assert!(end.of(Verdict::Visible) >= 2, "the wall right before the Eye is kept: {end:?}");
    let (afar, said) = go(&mut state, glam::Vec3::new(-900.0, 10.0, 10.0));
    assert!(sees_all(afar) && said.is_some_and(|s| s.contains("on its path")), "{afar:?}");
    // Back in range the depths of the path are back too.
    let (back, said) = go(&mut state, start.eye.position);
    assert!((back.eye.near, back.eye.far) == (start.eye.near, start.eye.far) && said.is_none());
    state.apply(Command::Observe(ObserverCamera { distance: 400.0, ..state.observer }));
    state.apply(Action::EyeHere);
    assert!(sees_all(solid_view(&state)));
}

#[test]
fn the_depths_that_a_file_names_stay_while_the_eye_is_in_their_range() {
    let mut state = opened(FLAT);
    let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
    let (named, bounds) = (stage.view, stage.scene.bounds());
    let mut view = named;
    view.eye.position += glam::Vec2::splat(0.5);
    state.apply(Command::Eye(Either::Flat(view), 0));
    let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
    assert_eq!((stage.view.eye.near, stage.view.eye.far), (named.eye.near, named.eye.far));
    view.eye.position = bounds.max + bounds.size() * 5.0;
    state.apply(Command::Eye(Either::Flat(view), 0));
    let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
    assert!(stage.view.eye.far > (view.eye.position - bounds.min).length(), "{:?}", stage.view);
}

#[test]
fn a_layout_moves_no_camera_and_a_bookmark_brings_its_own_back() {
    let mut state = opened(FLAT);
    state.apply(Command::Select(Subject::Prim(PrimId(3))));
    let looking = ObserverCamera { distance: 2.5, pivot: [3.0, 4.0, 0.0], ..state.observer };
    state.apply(Command::Observe(looking));
    state.apply(Command::GoTo(9));
    state.apply(Action::Bookmark);
    let eye = state.stage.as_ref().map(|s| s.view());
    for layout in Layout::ALL {
        state.apply(Command::Layout(layout));
        assert!(state.observer == looking && !state.is_to_frame, "{layout:?}");
        assert_eq!(state.stage.as_ref().map(|s| s.view()), eye);
    }
    let ways: [Command; 3] = [Command::Bookmark(0), Action::Bookmark1.into(), Action::PresentNext.into()];
    for way in ways {
        state.apply(Command::GoTo(0));
        state.apply(Command::Observe(ObserverCamera { distance: 77.0, ..looking }));
        state.apply(way.clone());
        assert_eq!((state.step, state.observer), (9, looking), "{way:?}");
    }
}

#[test]
fn an_object_answers_why_and_stops_runs() {
    let folder = folder_with_a_box("object");
    let mut state = opened(&folder.join("models/box.obj").to_string_lossy());
    std::fs::remove_dir_all(&folder).expect("a folder of our own");
    state.apply(Action::Last);
    let stage = state.staged().expect("a stage");
    let walls = (0..stage.scene().object_count() as u32).map(ObjectId);
    let walls = walls.filter(|&o| stage.scene().object_name(o) == "walls").last().expect("named walls");
    let prims = stage.scene().prims_of(walls);
    assert_eq!(prims.len(), 8);
    let said = why(stage, Subject::Object(walls), state.step);
    assert!(said[0].text.starts_with("8 triangles: "), "{said:?}");
    let numbers = |text: &str| -> usize {
        text.split([' ', ',']).filter_map(|w| w.parse::<usize>().ok()).skip(1).sum()
    };
    assert_eq!(numbers(&said[0].text), 8, "every triangle is accounted for: {said:?}");
    assert!(said.len() > 1 && said[1..].iter().all(|b| b.step.is_some()), "{said:?}");
    let early = why(stage, Subject::Object(walls), 0);
    assert!(early[0].text.contains("8 not decided"), "{early:?}");
    // Runs stop where a part of it is decided, by whatever.
    state.apply(Command::Select(Subject::Object(walls)));
    state.apply(Action::Breakpoint);
    assert!(state.breakpoints.contains(&Breakpoint::Object(walls)));
    for action in [Action::Run, Action::NextOnSelected] {
        state.apply(Command::GoTo(0));
        state.apply(action);
        let film = state.film().expect("a film");
        let first = prims.iter().filter_map(|&p| film.stamps.prim_decision(p)).map(|(at, _)| at).min();
        assert!(state.step > 0 && Some(state.step) <= first, "{action:?}: {} {first:?}", state.step);
    }
    an_object_keeps_its_reasons(state, walls, &said[1..]);
}

/// Its events are listed by its name or by its number, and its reasons stay while one goes through them.
fn an_object_keeps_its_reasons(mut state: State, walls: ObjectId, said: &[Because]) {
    state.apply(Command::Filter(r#"under:"wal" under:"alls""#.into()));
    let rows = state.outline.rows().to_vec();
    assert!(!rows.is_empty());
    state.apply(Command::Filter(Filter::about(Subject::Object(walls)).expect("a filter")));
    assert_eq!(state.outline.rows(), rows);
    let reasons = state.why.reasons().to_vec();
    assert_eq!(reasons, said);
    for step in reasons.iter().filter_map(|reason| reason.step) {
        state.apply(Command::GoTo(step - 1));
        assert_eq!(state.why.reasons(), reasons);
        // What a decision rests on is an event about the object, as the decision is.
        state.apply(Action::NextOnSelected);
        assert_eq!(state.step, step);
        let film = state.film().expect("a film");
        if let Some(ground) = film.reel.evidence_of(step - 1) {
            state.apply(Action::PreviousOnSelected);
            assert!(state.step > ground && state.step < step, "{} {ground} {step}", state.step);
        }
    }
}

#[test]
fn a_filter_takes_names_with_spaces() {
    let state = opened(FLAT);
    let (stage, film) = (state.staged().expect("a stage"), state.film().expect("a film"));
    for (text, is_sound) in [(r#"under:"wall A" -line"#, true), (r#"object:"wall A""#, false)] {
        assert_eq!(Filter::parse(text).is_ok(), is_sound, "{text}");
    }
    // Within quotes it is one word, which nothing is called; without them three, of which two must not be.
    let passing = |text: &str| {
        let filter = Filter::parse(text).expect("sound");
        (0..state.len()).filter(|&at| filter.on(stage.scene(), film).passes(at)).count()
    };
    assert_eq!(passing(r#""entered node""#), 0);
    assert!(passing("entered node") > 0);
}

#[test]
fn the_subject_of_every_step_is_marked_in_flatland() {
    for method in ["hierarchical-z", "large-occluders", "centroid"] {
        let mut state = opened("scenes2d/street.json");
        state.apply(Command::Method(method.into()));
        state.block_until_idle();
        let mut marked = 0;
        for step in (1..=state.len()).step_by(7) {
            state.apply(Command::GoTo(step));
            let subject = state.current_subject();
            if !matches!(subject, Subject::Prim(_) | Subject::Node(_) | Subject::Object(_)) {
                continue;
            }
            let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
            let film = stage.recorded.as_ref().expect("a film");
            let world = crate::figure::world(&*film.film, &film.stamps, step, &state.look());
            let is_marked =
                |i: &crate::drawing::Item<_>| i.role == crate::drawing::Role::Current && i.subject == subject;
            assert!(world.items.iter().any(is_marked), "{method}, step {step}: {}", state.sentence());
            marked += 1;
        }
        assert!(marked > 10, "{method}");
    }
}

#[test]
fn a_spoiled_session_cannot_stop_the_start() {
    let good = opened(FLAT).session();
    let spoil: [fn(&mut Session); 6] = [
        |s| s.scene = "gone.obj".into(),
        |s| s.method = "no-such-method".into(),
        |s| s.step = usize::MAX,
        |s| s.selected = super::session::Picked::Node(u32::MAX),
        |s| s.place = (99, 99),
        |s| s.shown.scale = f32::NAN,
    ];
    for (i, spoil) in spoil.into_iter().enumerate() {
        let mut session = good.clone();
        spoil(&mut session);
        let mut state = State::new();
        state.start(&Start::default(), Some(session));
        state.block_until_idle();
        assert_eq!(state.stage.is_some(), i > 0, "{i}: {:?}", state.notices);
        assert!(state.shown.scale.is_finite());
    }
}

#[test]
fn every_action_runs_and_none_panics() {
    for info in Action::ALL {
        assert_eq!(spoken_command(info.name), Some(info.action.into()));
        let mut closed = State::new();
        closed.apply(info.action);
        closed.block_until_idle();
    }
    let mut state = opened(FLAT);
    state.apply(Command::Select(Subject::Node(NodeId(1))));
    // Saving under a name is asked for by a dialog, so nothing is written here.
    for info in Action::ALL.iter().filter(|i| !matches!(i.action, Action::Start)) {
        state.apply(info.action);
        state.dialog = Dialog::None;
        state.block_until_idle();
        assert!(state.step <= state.len(), "{}", info.name);
    }
}

#[test]
fn the_start_runs_its_commands_once_loaded() {
    let commands = ["method:z-buffer", "go-to:12", "select:prim:3", "theme-dark"].map(String::from).to_vec();
    let mut state = State::new();
    state.start(&Start { scene: Some(FLAT.into()), commands, ..Start::default() }, None);
    state.block_until_idle();
    assert_eq!(
        (state.method.as_str(), state.step, state.selection),
        ("z-buffer", 12, Subject::Prim(PrimId(3)))
    );
    assert_eq!(state.shown.theme, Theme::Dark);
}

#[test]
fn selections_are_remembered() {
    let mut state = opened(FLAT);
    let things = [Subject::Node(NodeId(1)), Subject::Prim(PrimId(2)), Subject::Eye];
    things.into_iter().for_each(|s| state.apply(Command::Select(s)));
    state.apply(Action::SelectBack);
    assert_eq!(state.selection, things[1]);
    state.apply(Action::SelectForward);
    assert_eq!(state.selection, things[2]);
    state.apply(Command::Select(things[1]));
    state.apply(Action::SelectParent);
    assert!(matches!(state.selection, Subject::Node(_)));
}

#[test]
fn the_image_of_flatland_shows_the_nearest_segments() {
    let state = opened(FLAT);
    let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
    let image = stage.image();
    let projection = stage.view.projection();
    let mut seen = 0;
    for (i, cell) in image.iter().enumerate().step_by(37) {
        let Some((prim, depth)) = &cell.opaque else { continue };
        seen += 1;
        // The ray through the pixel's center, met by every segment one by one.
        let x = (i as f32 + 0.5) / image.len() as f32 * 2.0 - 1.0;
        let row = projection.rows[0];
        let direction = projection.rows[1] + row * (x / row.length_squared());
        let hits = stage.scene.live().iter().filter_map(|&p| {
            let ends: Vec<_> = stage.scene.prim_points(p).collect();
            let (a, b) = (ends[0] - projection.eye, ends[1] - projection.eye);
            let along = -direction.perp_dot(a) / direction.perp_dot(b - a);
            let t = (a + (b - a) * along).dot(projection.rows[1]);
            ((0.0..=1.0).contains(&along) && t >= stage.view.eye.near).then_some((t, p))
        });
        let nearest = hits.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a hit");
        assert!((nearest.0 - depth).abs() < 1e-3 * depth, "{i}: {prim} at {depth}, {nearest:?}");
    }
    assert!(seen > 5);
}

#[test]
fn a_figure_brings_its_session_back() {
    let mut state = opened(FLAT);
    state.apply(Command::GoTo(77));
    let recipe = state.session().text();
    let svg = state.figure_with(&Export::default(), crate::render::Format::Svg, &recipe).expect("a figure");
    let path = std::env::temp_dir().join(format!("cullscope-{}.svg", std::process::id()));
    let path = path.to_string_lossy().into_owned();
    write_file(&path, &svg).expect("a file");
    let mut other = State::new();
    other.apply(Command::Open(path.clone()));
    other.block_until_idle();
    assert_eq!(other.session(), state.session(), "{:?}", other.notices);
    write_file(&path, b"<svg/>").expect("a file");
    other.apply(Command::Open(path.clone()));
    assert!(other.notices.iter().any(|n| n.is_error));
    let _ = std::fs::remove_file(path);
}

#[test]
fn what_moves_is_shown_in_the_frame_of_its_film() {
    let mut state = opened("scenes2d/moving_door.json");
    let leaf = |state: &State| {
        let Some(Either::Flat(stage)) = &state.stage else { panic!("a flat stage") };
        (stage.posed().prim_bounds(PrimId(2)), stage.recorded.as_ref().map(|r| r.film.scene().frame()))
    };
    let shown = |state: &State| state.staged().and_then(|s| s.frame_of_motion());
    // Both of its eyes are fewer than the door has frames, so there is a path that stands still.
    assert_eq!(state.staged().map(|s| s.paths()), Some(vec![("eyes".into(), 2), ("motion".into(), 10)]));
    let shut = leaf(&state).0;
    state.apply(Command::Frame(1, 9));
    state.block_until_idle();
    let (open, of_film) = leaf(&state);
    assert_eq!((of_film, shown(&state)), (Some(Some(9)), Some((9, 10))));
    // A quarter turn: what was one unit wide and flat stands upright.
    assert!(shut.size().x > 0.99 && shut.size().y < 0.01 && open.size().x < 0.01 && open.size().y > 0.99);
    // The room behind it comes into view with it: a chair is drawn that was hidden.
    state.apply(Command::Method("large-occluders".into()));
    state.block_until_idle();
    let hidden = |state: &State| {
        let film = state.film().expect("a film");
        film.stamps.counts(film.reel.events().len()).of(Verdict::Hidden)
    };
    let of_open = hidden(&state);
    state.apply(Command::Select(Subject::Object(ObjectId(2))));
    assert!(state.staged().expect("a stage").facts(state.selection).iter().any(|f| f.0 == "moves"));
    let session = state.session();
    state.apply(Action::Undo);
    state.apply(Action::Undo);
    state.block_until_idle();
    assert_eq!((leaf(&state).0, shown(&state)), (shut, Some((0, 10))), "undo shuts the door");
    state.restore(session, None);
    state.block_until_idle();
    assert_eq!((leaf(&state).0, hidden(&state)), (open, of_open), "a session opens it as far as it was");
}

#[test]
fn a_path_plays_view_by_view_and_is_one_step_of_undo() {
    let mut state = opened("scenes2d/moving_door.json");
    state.apply(Command::Frame(1, 0));
    state.block_until_idle();
    let place = |state: &State| state.staged().map(|s| s.place());
    state.apply(Action::PlayPath);
    assert!(state.is_path_playing && state.step == state.len(), "what the film decided is seen");
    for view in (1..10).chain([0, 1]) {
        assert!(state.tick(0.04) && state.tick(0.06), "it goes on");
        // The film is being recorded: nothing goes on before it is there.
        state.tick(1.0);
        state.block_until_idle();
        assert_eq!(place(&state), Some((1, view)));
        assert_eq!(state.step, state.len(), "still at the end of the film");
    }
    state.apply(Action::PlayPath);
    assert!(!state.tick(1.0) && place(&state) == Some((1, 1)));
    state.apply(Action::Undo);
    state.block_until_idle();
    assert_eq!(place(&state), Some((1, 0)), "back where it began to play");
}
