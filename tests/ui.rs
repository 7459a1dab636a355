//! The window, driven by accessibility labels, the pointer and keys, as a person does.

use cullscope::app::{Action, Command, Dialog, Export, LookIn, ObserverCamera, Start, State, Tables, Theme};
use cullscope::drawing::{Drawing, Item, Layer, Mark, Pixels, Role, Subject};
use cullscope::figure::Paper;
use cullscope::figure::page::PT_PER_MM;
use cullscope::geometry::{Flat, NodeId, PrimId, View};
use cullscope::method::{Event, Verdict};
use cullscope::render::{PngSize, pixels, png_pixels};
use cullscope::views::window::App;
use eframe::egui::{self, Key, Modifiers, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

const FLAT: &str = "freedoom_e1m1";

fn start(scene: &str) -> Start {
    Start { scene: Some(scene.into()), fresh: true, ..Start::default() }
}

fn settle(h: &mut Harness<'_, App>) {
    for _ in 0..3 {
        h.run_steps(2);
        h.state_mut().state.block_until_idle();
    }
    h.run_steps(3);
}

fn window(scene: &str) -> Harness<'static, App> {
    let start = start(scene);
    let mut h = Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |cc| App::new(cc, start));
    settle(&mut h);
    assert!(h.state().state.film().is_some(), "{:?}", h.state().state.notices);
    h
}

fn press(h: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    h.key_press_modifiers(modifiers, key);
    settle(h);
}

fn click(h: &mut Harness<'_, App>, label: &str) {
    h.get_by_label(label).click();
    settle(h);
}

#[test]
fn buttons_step_forward_and_back_to_the_same_state() {
    let mut h = window(FLAT);
    let before = h.state().state.sentence();
    for k in 1..=4 {
        click(&mut h, "Step forward");
        assert_eq!(h.state().state.step, k);
    }
    h.get_by_label_contains("Step 4 of");
    for _ in 0..4 {
        click(&mut h, "Step back");
    }
    assert_eq!((h.state().state.step, h.state().state.sentence()), (0, before));
}

#[test]
fn keys_step_and_play_unless_a_text_field_has_them() {
    let mut h = window(FLAT);
    press(&mut h, Modifiers::NONE, Key::ArrowRight);
    press(&mut h, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(h.state().state.step, 2);
    press(&mut h, Modifiers::NONE, Key::End);
    assert_eq!(h.state().state.step, h.state().state.len());
    press(&mut h, Modifiers::NONE, Key::Home);
    press(&mut h, Modifiers::COMMAND, Key::ArrowRight);
    let verdict = h.state().state.step;
    assert!(verdict > 1, "to the first verdict");

    // A button that has the focus must not be pressed by Space, nor moved away from by arrows.
    h.get_by_label("Step back").focus();
    h.run_steps(2);
    press(&mut h, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(h.state().state.step, verdict + 1);

    h.get_by_label("Filter events").focus();
    h.run_steps(2);
    for key in [Key::ArrowRight, Key::Home, Key::End, Key::Space, Key::N] {
        press(&mut h, Modifiers::NONE, key);
    }
    assert_eq!((h.state().state.step, h.state().state.is_playing), (verdict + 1, false));
    h.get_by_label("Filter events").type_text("verdict:outside");
    settle(&mut h);
    assert_eq!(h.state().state.filter, "verdict:outside");
    assert!(h.state().state.outline.rows().len() < h.state().state.len());
}

#[test]
fn a_key_goes_to_the_next_layer_and_the_status_names_it() {
    let mut h = window("bottleneck");
    h.state_mut().state.apply(Command::Set("budget".into(), "100%".into(), 0));
    settle(&mut h);
    press(&mut h, Modifiers::NONE, Key::Z);
    let first = h.state().state.step;
    h.get_by_label_contains("Layer 1 of ");
    press(&mut h, Modifiers::NONE, Key::Z);
    let state = &h.state().state;
    assert!(state.step > first && matches!(state.current_subject(), Subject::Prim(_) | Subject::Node(_)));
    h.get_by_label_contains("behind at least ");
    press(&mut h, Modifiers::SHIFT, Key::Z);
    assert_eq!(h.state().state.step, first);
    // In a lecture it stands in the caption.
    h.state_mut().state.apply(Action::LayoutLecture);
    settle(&mut h);
    h.get_by_label_contains("Layer 1 of ");
}

#[test]
fn it_plays_to_the_end() {
    let mut h = window(FLAT);
    h.state_mut().state.apply(Command::Speed(20_000.0));
    press(&mut h, Modifiers::NONE, Key::Space);
    for _ in 0..100 {
        h.step();
    }
    let state = &h.state().state;
    assert_eq!((state.step, state.is_playing), (state.len(), false));
}

#[test]
fn a_click_in_the_event_tree_selects_everywhere() {
    let mut h = window(FLAT);
    h.state_mut().state.apply(Command::Filter("node:1 kind:entered".into()));
    settle(&mut h);
    click(&mut h, "node 1");
    let state = &h.state().state;
    assert_eq!(state.selection, Subject::Node(NodeId(1)));
    assert!(state.sentence().contains("enters node 1"), "{}", state.sentence());
    h.get_by_label("Select the node above");
    h.get_by_label_contains("was entered at step");
}

#[test]
fn a_click_in_the_picture_selects() {
    let mut h = window(FLAT);
    press(&mut h, Modifiers::NONE, Key::End);
    let rect = h.get_by_label_contains("Observer view.").rect();
    let state = &h.state().state;
    let Some(cullscope::geometry::Either::Flat(stage)) = &state.stage else { panic!("flatland") };
    let prim = stage.scene.live()[200];
    let middle = stage.scene.prim_points(prim).fold(glam::Vec2::ZERO, |sum, p| sum + p * 0.5);
    let scale = rect.height() / (2.0 * state.observer.distance);
    let at =
        rect.center() + vec2(middle.x - state.observer.pivot[0], state.observer.pivot[1] - middle.y) * scale;
    h.hover_at(at);
    h.run_steps(1);
    h.drag_at(at);
    h.run_steps(1);
    h.drop_at(at);
    settle(&mut h);
    assert!(matches!(h.state().state.selection, Subject::Prim(_)), "{:?}", h.state().state.selection);
    h.get_by_label_contains("since step");
    // The picture has the keys now: Tab swaps the views.
    press(&mut h, Modifiers::NONE, Key::Tab);
    assert!(h.state().state.is_swapped);
}

/// What decided is in sight as soon as a thing is selected, as are the buttons below it.
#[test]
fn the_reason_is_seen_without_scrolling() {
    let mut h = window("generate:building?polygons=2000&seed=3");
    h.state_mut().state.apply(Command::Method("hierarchical-z".into()));
    settle(&mut h);
    press(&mut h, Modifiers::NONE, Key::End);
    for prim in [108, 40, 700] {
        h.state_mut().state.apply(Command::Select(Subject::Prim(PrimId(prim))));
        settle(&mut h);
        let reason = h.state().state.why.reasons()[0].text.clone();
        let (reason, below) = (h.get_by_label(&reason).rect(), h.get_by_label("Toggle breakpoint").rect());
        assert!(reason.bottom() <= below.top(), "{prim}: {reason} {below}");
        // The answer stays where it is while one goes to what it names.
        let step = h.state().state.why.reasons()[0].step.expect("a step");
        h.state_mut().state.apply(Command::GoTo(step));
        settle(&mut h);
        h.get_by_label("This is the present step.");
    }
}

#[test]
fn objects_are_listed_searched_selected_and_hidden() {
    let mut h = window(FLAT);
    press(&mut h, Modifiers::NONE, Key::End);
    click(&mut h, "Objects");
    h.get_by_label("Search objects").focus();
    h.run_steps(2);
    h.get_by_label("Search objects").type_text("sector_60");
    settle(&mut h);
    assert_eq!(h.state().state.listing.text, "sector_60");
    h.get_by_label_contains("sector_60: ").click();
    settle(&mut h);
    let Subject::Object(object) = h.state().state.selection else { panic!("an object is selected") };
    click(&mut h, "Show sector_60");
    assert!(h.state().state.unshown().contains(&object));
    h.get_by_label_contains("1 object not shown");
    click(&mut h, "Show all objects");
    assert!(h.state().state.unshown().is_empty());
}

#[test]
fn a_pixel_of_the_eye_tells_its_history() {
    let mut h = window(FLAT);
    let picture = "Eye view: the one line of pixels that the Eye sees";
    h.get_by_label(picture).click_modifiers(Modifiers::COMMAND);
    settle(&mut h);
    let [x, _] = h.state().state.pixel.at().expect("Ctrl and a click ask for the pixel");
    h.state_mut().state.apply(Command::Pixel(None));
    settle(&mut h);
    h.get_by_label(picture).click_secondary();
    settle(&mut h);
    click(&mut h, &format!("History of pixel ({x}, 0)"));
    assert_eq!(h.state().state.pixel.at(), Some([x, 0]));
    h.state_mut().state.apply(Command::Pixel(Some([3, 0])));
    settle(&mut h);
    h.get_by_label_contains("Pixel (3, 0): ");
    let layer = h.state().state.pixel.layers()[0];
    let title = layer.title(h.state().state.staged().expect("a stage"));
    click(&mut h, &title);
    assert_eq!(h.state().state.selection, Subject::Prim(layer.prim));
    h.get_by_label_contains("Pixel (3, 0): ");
}

/// The view that culling sees with, and where its eye stands on the screen.
fn flat_eye(h: &Harness<'_, App>) -> (View<Flat>, egui::Pos2, f32) {
    let rect = h.get_by_label_contains("Observer view.").rect();
    let state = &h.state().state;
    let Some(cullscope::geometry::Either::Flat(stage)) = &state.stage else { panic!("flatland") };
    let scale = rect.height() / (2.0 * state.observer.distance);
    let eye = stage.view.eye.position;
    (
        stage.view,
        rect.center() + vec2(eye.x - state.observer.pivot[0], state.observer.pivot[1] - eye.y) * scale,
        scale,
    )
}

/// Drags the Eye to the right, in steps.
fn drag_eye(h: &mut Harness<'_, App>) {
    let (_, at, _) = flat_eye(h);
    h.hover_at(at);
    h.run_steps(1);
    h.drag_at(at);
    h.run_steps(1);
    for k in 1..=5 {
        h.hover_at(at + vec2(6.0 * k as f32, 0.0));
        h.run_steps(1);
    }
    h.drop_at(at + vec2(30.0, 0.0));
    settle(h);
}

#[test]
fn the_eye_is_dragged_and_undone() {
    let mut h = window(FLAT);
    let (before, _, scale) = flat_eye(&h);
    drag_eye(&mut h);
    let (once, ..) = flat_eye(&h);
    let by = once.eye.position - before.eye.position;
    assert!(by.x > 10.0 / scale && by.y.abs() < 1e-3, "{by}");
    drag_eye(&mut h);
    assert_ne!(flat_eye(&h).0, once);
    press(&mut h, Modifiers::COMMAND, Key::Z);
    assert_eq!(flat_eye(&h).0, once, "one undo takes a whole drag back, and no other");
    press(&mut h, Modifiers::COMMAND, Key::Z);
    assert_eq!(flat_eye(&h).0, before);
}

#[test]
fn a_parameter_is_culled_again_and_undone() {
    let mut h = window(FLAT);
    let events = h.state().state.len();
    click(&mut h, "backface culling");
    assert_ne!(h.state().state.len(), events);
    press(&mut h, Modifiers::COMMAND, Key::Z);
    assert_eq!(h.state().state.len(), events);
    press(&mut h, Modifiers::COMMAND, Key::Y);
    assert_ne!(h.state().state.len(), events);
}

#[test]
fn the_palette_runs_a_command_and_names_them_all() {
    let mut h = window(FLAT);
    press(&mut h, Modifiers::COMMAND, Key::K);
    assert_eq!(h.state().state.dialog, Dialog::Palette);
    for info in Action::ALL {
        assert!(
            h.query_all_by_label_contains(info.title).next().is_some(),
            "{} is not in the palette",
            info.title
        );
    }
    h.get_by_label("Command").type_text("dark theme");
    settle(&mut h);
    press(&mut h, Modifiers::NONE, Key::Enter);
    assert_eq!((h.state().state.dialog, h.state().state.shown.theme), (Dialog::None, Theme::Dark));
}

#[test]
fn go_to_a_step_by_number() {
    let mut h = window(FLAT);
    press(&mut h, Modifiers::COMMAND, Key::G);
    h.get_by_label("Step number").type_text("123");
    settle(&mut h);
    press(&mut h, Modifiers::NONE, Key::Enter);
    // The field held 0, so 0123 or 1230 was typed; both are steps or beyond the end.
    let state = &h.state().state;
    assert_eq!(state.dialog, Dialog::None);
    assert!(state.step == 123 || state.step == state.len());
}

#[test]
fn a_broken_file_shows_an_error_and_keeps_the_scene() {
    let mut h = window(FLAT);
    press(&mut h, Modifiers::NONE, Key::ArrowRight);
    press(&mut h, Modifiers::COMMAND, Key::O);
    h.get_by_label("Path of the scene").type_text("no/such/scene.obj");
    settle(&mut h);
    press(&mut h, Modifiers::NONE, Key::Enter);
    h.get_by_label_contains("Error: no/such/scene.obj");
    let state = &h.state().state;
    assert_eq!((state.staged().map(|s| s.scene().name()), state.step), (Some("freedoom_e1m1"), 1));
}

#[test]
fn the_start_screen_opens_an_example() {
    let begin = Start { fresh: true, ..Start::default() };
    let mut h = Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |cc| App::new(cc, begin));
    settle(&mut h);
    let first = h
        .get_all_by_label_contains("Open ")
        .find(|n| n.accesskit_node().label().is_some_and(|l| l.contains(".json)")));
    first.expect("an example").click();
    settle(&mut h);
    assert!(h.state().state.film().is_some());
}

#[test]
fn layouts_dialogs_and_themes_are_shown_without_a_fault() {
    let mut h = window(FLAT);
    for action in [
        Action::LayoutLecture,
        Action::LayoutFigure,
        Action::LayoutDebug,
        Action::ThemePrint,
        Action::ScaleUp,
    ] {
        h.state_mut().state.apply(action);
        settle(&mut h);
        assert!(h.query_all_by_label_contains("Observer view").next().is_some(), "{action:?}");
    }
    for dialog in [Dialog::Keys, Dialog::Report, Dialog::About, Dialog::SaveAs, Dialog::Open] {
        h.state_mut().state.apply(Command::Dialog(dialog));
        settle(&mut h);
        press(&mut h, Modifiers::NONE, Key::Escape);
        assert_eq!(h.state().state.dialog, Dialog::None, "{dialog:?}");
    }
}

/// Colors that occur in a part of a picture, four bytes a pixel.
fn colors(rgba: &[u8], width: usize, rect: egui::Rect) -> usize {
    let inside = |i: usize| rect.contains(pos2((i % width) as f32, (i / width) as f32));
    let pixels = rgba.chunks_exact(4).enumerate().filter(|(i, _)| inside(*i)).map(|(_, p)| p);
    pixels.collect::<std::collections::BTreeSet<_>>().len()
}

#[test]
fn both_pictures_of_space_are_drawn() {
    let start = start("generate:building?polygons=2000");
    let mut h =
        Harness::builder().with_size(vec2(1280.0, 800.0)).wgpu().build_eframe(move |cc| App::new(cc, start));
    settle(&mut h);
    assert!(h.state().state.film().is_some(), "{:?}", h.state().state.notices);
    press(&mut h, Modifiers::NONE, Key::End);
    h.remove_cursor();
    h.run_steps(2);
    let image = h.render().expect("a picture");
    for view in ["Eye view.", "Observer view."] {
        let rect = h.get_by_label_contains(view).rect();
        assert!(rect.width() > 200.0 && rect.height() > 150.0);
        let colors = colors(image.as_raw(), image.width() as usize, rect);
        assert!(colors > 3, "{view} is empty: {colors} colors");
    }
}

#[test]
fn the_pseudocode_is_that_of_the_parameters_and_tells_what_was_compared() {
    let mut h = window("scenes2d/street.json");
    let faces = "faces away from the eye";
    h.state_mut().state.apply(Command::Method("frustum".into()));
    settle(&mut h);
    assert!(h.query_all_by_label_contains(faces).next().is_none(), "both sides of a segment are drawn");
    h.state_mut().state.apply(Command::Set("backface-culling".into(), "true".into(), 0));
    settle(&mut h);
    h.get_by_label_contains(faces);
    let state = &h.state().state;
    let film = state.film().expect("a film");
    let test = (0..state.len()).find(|&i| film.reel.compared(i).is_some()).expect("a test");
    let compared = film.reel.compared(test).expect("two numbers").to_string();
    h.state_mut().state.apply(Command::GoTo(test + 1));
    settle(&mut h);
    h.get_by_label(&compared);
    // Where the method departs from its paper, the line says so, and a list says why.
    h.state_mut().state.apply(Command::Method("large-occluders".into()));
    settle(&mut h);
    assert!(h.query_all_by_label_contains("paper: ").next().is_some());
    h.get_by_label_contains("Departures from the paper (");
}

/// The pixels of the part of a picture.
fn part(rgba: &[u8], width: usize, rect: egui::Rect) -> Vec<u8> {
    let inside = |i: usize| rect.contains(pos2((i % width) as f32, (i / width) as f32));
    rgba.chunks_exact(4).enumerate().filter(|(i, _)| inside(*i)).flat_map(|(_, p)| p.to_vec()).collect()
}

#[test]
fn one_looks_into_what_is_closed_and_the_figure_shows_the_same() {
    let start = start("generate:building?polygons=2000");
    let mut h =
        Harness::builder().with_size(vec2(1280.0, 800.0)).wgpu().build_eframe(move |cc| App::new(cc, start));
    settle(&mut h);
    press(&mut h, Modifiers::NONE, Key::End);
    h.remove_cursor();
    let mut pictures = vec![];
    let folder = std::env::temp_dir().join(format!("cullscope-ui-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder of our own");
    h.state_mut().state.folder = folder.clone();
    for way in LookIn::ALL {
        h.state_mut().state.apply(Command::LookIn(way));
        h.state_mut().state.notices.clear();
        h.state_mut().state.apply(Action::ExportPng);
        settle(&mut h);
        assert!(h.state().state.notices.iter().all(|n| !n.is_error), "{:?}", h.state().state.notices);
        let file = std::fs::read_dir(&folder).expect("a folder").flatten().next().expect("a figure").path();
        let figure = std::fs::read(&file).expect("a figure");
        std::fs::remove_file(&file).expect("a file of our own");
        h.state_mut().state.notices.clear();
        settle(&mut h);
        let image = h.render().expect("a picture");
        let view =
            |label: &str| part(image.as_raw(), image.width() as usize, h.get_by_label_contains(label).rect());
        pictures.push((view("Eye view."), view("Observer view."), figure));
    }
    std::fs::remove_dir_all(&folder).expect("a folder of our own");
    for (i, j) in [(0, 1), (1, 2)] {
        assert!(pictures[i].0 == pictures[j].0, "the Eye sees what it sees");
        assert!(pictures[i].1 != pictures[j].1, "the Observer looks in: {i} {j}");
        assert!(pictures[i].2 != pictures[j].2, "and so does the figure: {i} {j}");
    }
}

#[test]
fn the_picture_of_flatland_marks_what_a_step_is_about() {
    let start = start("scenes2d/street.json");
    let mut h =
        Harness::builder().with_size(vec2(1280.0, 800.0)).wgpu().build_eframe(move |cc| App::new(cc, start));
    settle(&mut h);
    h.state_mut().state.apply(Command::Method("hierarchical-z".into()));
    settle(&mut h);
    h.remove_cursor();
    let state = &h.state().state;
    let drawn = |i: &usize| matches!(state.events()[*i], Event::DecidedPrim(_, Verdict::Visible));
    let steps: Vec<usize> = (0..state.len()).filter(drawn).step_by(3).map(|i| i + 1).collect();
    assert!(steps.len() > 3);
    for step in steps {
        h.state_mut().state.apply(Command::GoTo(step));
        settle(&mut h);
        let image = h.render().expect("a picture");
        for label in ["Observer view.", "Eye view", "Timeline"] {
            let rect = h.get_all_by_label_contains(label).last().expect(label).rect();
            let pixels = part(image.as_raw(), image.width() as usize, rect);
            // The band of the mark is the only thing that is yellow.
            let is_yellow = |p: &&[u8]| p[0] > 200 && p[1] > 190 && p[2] < 120;
            let yellow = pixels.chunks_exact(4).filter(is_yellow).count();
            assert!(yellow > 15, "{label}, step {step}: {yellow}");
        }
    }
}

#[test]
fn layouts_and_sessions_keep_where_the_observer_stands() {
    let mut h = window(FLAT);
    let state = &mut h.state_mut().state;
    state.apply(Command::Select(Subject::Prim(PrimId(200))));
    let looking = ObserverCamera { distance: state.observer.distance * 0.4, ..state.observer };
    state.apply(Command::Observe(looking));
    settle(&mut h);
    for action in [Action::LayoutLecture, Action::LayoutFigure, Action::LayoutDebug, Action::ResetLayout] {
        h.state_mut().state.apply(action);
        settle(&mut h);
        assert_eq!(h.state().state.observer, looking, "{action:?}");
    }
    let file = std::env::temp_dir().join(format!("cullscope-ui-{}.session.json", std::process::id()));
    let path = file.to_string_lossy().into_owned();
    h.state_mut().state.apply(Command::SaveTo(path.clone()));
    let start = Start { session: Some(path), fresh: true, ..Start::default() };
    let mut h = Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |cc| App::new(cc, start));
    settle(&mut h);
    std::fs::remove_file(&file).expect("a file of our own");
    assert_eq!(h.state().state.observer, looking, "{:?}", h.state().state.notices);
}

/// The catalogue of failures opens its scenes, and the report says what fails.
#[test]
fn a_scene_where_methods_fail_is_opened_and_explained() {
    let mut h = window(FLAT);
    h.state_mut().state.apply(Action::Failures);
    settle(&mut h);
    click(&mut h, "Open slivers in 2D");
    let state = &h.state().state;
    let scene = state.staged().expect("a stage").scene();
    assert_eq!((scene.name(), state.dialog), ("slivers", Dialog::None));
    assert!(scene.report().notes.iter().any(|note| note.starts_with("What fails here: ")));
}

/// The chart of speed against error, and advice, from the window.
#[test]
fn methods_are_measured_and_advice_is_used() {
    let mut h = window(FLAT);
    h.state_mut().state.apply(Action::Laboratory);
    settle(&mut h);
    assert_eq!(h.state().state.dialog, Dialog::Laboratory);
    click(&mut h, "Measure");
    assert!(h.state().state.findings.chart.is_some());
    h.get_by_label(&format!("Chart: speed against error on {FLAT}"));
    click(&mut h, "Map");
    h.get_by_label("Map: stability");
    click(&mut h, "Advise");
    let advised = h.state().state.findings.advice.clone().expect("advice").configuration().clone();
    h.get_by_label(&advised.label());
    click(&mut h, "Use this");
    let state = &h.state().state;
    assert_eq!((&state.method, &state.settings), (&advised.method, &advised.settings));
    assert_eq!(state.dialog, Dialog::None);
}

#[test]
fn a_table_of_the_paper_is_measured_shown_and_stopped() {
    let mut h = window(FLAT);
    h.state_mut().state.apply(Action::Tables);
    settle(&mut h);
    assert_eq!(h.state().state.dialog, Dialog::Tables);
    click(&mut h, "Table 1: polygons drawn");
    let measured = h.state().state.measured.clone().expect("a table");
    assert_eq!(
        (measured.report.name, measured.report.scenes[0].name.as_str()),
        ("coorg-teller-table-1", FLAT)
    );
    assert_eq!(measured.report.table.number(0, "missed_triangles"), Some(0.0));
    h.get_by_label("Chart: Coorg and Teller 1997, Table 1: polygons drawn");
    h.get_by_label("134,832");
    assert!(h.query_by_label("SVG").is_some() && h.query_by_label("Stop").is_none());

    // Stopping leaves what was there, and the film.
    h.state_mut().state.apply(Command::Tables(Tables::Measure("coorg-teller-table-3")));
    assert!(h.state().state.busy().is_some());
    h.state_mut().state.apply(Command::Tables(Tables::Stop));
    settle(&mut h);
    let state = &h.state().state;
    assert!(state.busy().is_none() && state.film().is_some());
    assert_eq!(state.measured.as_ref().map(|m| m.report.name), Some("coorg-teller-table-1"));
    click(&mut h, "Close");
    assert_eq!(h.state().state.dialog, Dialog::None);
}

/// The Observer's picture of a figure as large as the one in the window, a pixel a point.
fn figure_pixels(state: &mut State, rect: egui::Rect) -> Pixels {
    let export = Export {
        paper: Paper::Custom {
            width_mm: (rect.width() + 6.0) / PT_PER_MM,
            height_mm: Some((rect.height() + 400.0) / PT_PER_MM),
        },
        aspect: Some(rect.aspect_ratio()),
        theme: state.shown.theme,
        ..Export::default()
    };
    let page = state.drawn(&export).expect("a figure");
    // The frame of the picture is the first outline among labels.
    let frame = page.items.iter().find_map(|item| match &item.mark {
        Mark::Line { points, closed: true } if item.role == Role::Faint => Some(points.clone()),
        _ => None,
    });
    let frame = frame.expect("a frame");
    let mut picture = Drawing { size_pt: frame[2] - frame[0], ..Drawing::default() };
    for item in page.items.iter().filter(|item| !matches!(item.layer, Layer::Legend | Layer::Caption)) {
        picture.items.push(Item { mark: item.mark.mapped(|p| p - frame[0]), ..item.clone() });
    }
    pixels(&picture, export.theme, PngSize::Dpi(72.0)).expect("pixels")
}

/// Share of squares of 4 × 4 pixels whose mean color differs by more than a tenth.
fn unlike(a: &[u8], b: &[u8], [width, height]: [usize; 2]) -> f32 {
    let mean = |rgba: &[u8], x: usize, y: usize| {
        let mut sum = [0u32; 3];
        for (dx, dy) in (0..16).map(|i| (i % 4, i / 4)) {
            let at = 4 * ((4 * y + dy) * width + 4 * x + dx);
            (0..3).for_each(|c| sum[c] += u32::from(rgba[at + c]));
        }
        sum.map(|s| s / 16)
    };
    // Labels are larger on screen, and rims have the window's own frame.
    let (across, down) = (width / 4, height / 4);
    let squares = (1..down - 1).flat_map(|y| (1..across - 1).map(move |x| (x, y)));
    let differs = |&(x, y): &(usize, usize)| {
        let (a, b) = (mean(a, x, y), mean(b, x, y));
        (0..3).any(|c| a[c].abs_diff(b[c]) > 25)
    };
    squares.clone().filter(differs).count() as f32 / squares.count() as f32
}

#[test]
fn a_figure_has_the_picture_of_the_screen() {
    for scene in ["scenes2d/street.json", "generate:building?polygons=3000"] {
        let start = start(scene);
        let mut h = Harness::builder()
            .with_size(vec2(1280.0, 800.0))
            .wgpu()
            .build_eframe(move |cc| App::new(cc, start));
        settle(&mut h);
        let state = &mut h.state_mut().state;
        state.apply(Action::ThemePrint);
        state.apply(Action::LayoutFigure);
        state.apply(Command::Method("hierarchical-z".into()));
        settle(&mut h);
        h.remove_cursor();
        let last = h.state().state.len();
        let mut before = None;
        for step in [0, last / 8, last / 3, 3 * last / 4, last] {
            h.state_mut().state.apply(Command::GoTo(step));
            settle(&mut h);
            let image = h.render().expect("a picture");
            let rect = h.get_by_label_contains("Observer view.").rect();
            let figure = figure_pixels(&mut h.state_mut().state, rect);
            let size = [figure.width as usize, figure.height as usize];
            assert!((figure.width as f32 - rect.width()).abs() < 2.0, "{size:?} {rect}");
            let mut screen = Vec::new();
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = rect.min + vec2(x as f32, y as f32);
                    screen.extend(image.get_pixel(at.x.round() as u32, at.y.round() as u32).0);
                }
            }
            if let Some(folder) = std::env::var_os("FIGURES_OUT") {
                for (name, rgba) in [("screen", &screen[..]), ("figure", &figure.rgba[..])] {
                    let rgba = rgba.to_vec().into();
                    let of = Pixels { width: figure.width, height: figure.height, rgba };
                    let space = if scene.starts_with("scenes2d") { "flatland" } else { "space" };
                    let path = std::path::Path::new(&folder).join(format!("{space}-{step}-{name}.png"));
                    std::fs::write(path, png_pixels(&of)).expect("a file");
                }
            }
            let share = unlike(&screen, &figure.rgba, size);
            eprintln!("{scene}, step {step}: {share}");
            assert!(share < 0.01, "{scene}, step {step}: {share} of the squares differ");
            // Another step is another picture, so that this is no accident.
            if let Some(before) = before.replace(screen) {
                assert!(unlike(&before, &figure.rgba, size) > share, "{scene}, step {step}");
            }
        }
    }
}
