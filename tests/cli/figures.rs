//! Figures of one's own: what the explorer shows of a step, as files of the real program.

use std::path::Path;
use std::{fs, process};

use cullscope::app::{Action, Command, Export, Picture, State};
use cullscope::drawing::Subject;
use cullscope::geometry::{ObjectId, PrimId};
use cullscope::render::{Format, recipe};
use serde_json::Value as Json;

use super::{cullscope, done, folder, json, refused, shipped, with};

const OWN: [&str; 5] = ["figure", "--scene", "walls.json", "--method", "hierarchical-z"];

/// What a figure carries.
fn carried(file: &Path) -> Json {
    json(&recipe(&fs::read(file).expect("a figure")).expect("a recipe"))
}

/// The words of a command line, as a shell takes them.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut is_quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '\'' => is_quoted = !is_quoted,
            ' ' if !is_quoted => words.push(String::new()),
            c => words.last_mut().expect("a word").push(c),
        }
    }
    words
}

/// Runs the command that a figure carries in its folder; it must write the same bytes again.
fn made_again(file: &Path) {
    let before = fs::read(file).expect("a figure");
    let line = carried(file)["figure"]["command"].as_str().expect("a command").to_owned();
    fs::remove_file(file).expect("a file of our own");
    let words = words(&line);
    let words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
    done(file.parent().expect("a folder"), &words);
    assert!(fs::read(file).expect("a figure") == before, "{}: {line}", file.display());
}

#[test]
fn every_picture_of_a_step_is_written_and_made_again() {
    let here = folder("own");
    let views = ["--eye", "8.5,1,-8.5", "--target", "20,1.1,-12", "--fov", "47.3", "--size", "64x48"];
    let solid = with(&["figure", "--scene", "boxes.obj", "--method", "hierarchical-z"], &views);
    let flat = with(&OWN, &["--do", "frame:0:1", "--text", "paths"]);
    for (task, scene) in [(&flat, "walls"), (&solid, "boxes")] {
        let more = ["--first-hidden", "--picture", "all", "--paper", "column", "--out", "sub/figures"];
        let said = done(&here, &with(&with(task, &more), &["--format", "svg,pdf,png"]));
        let files: Vec<&Path> = said.lines().map(Path::new).collect();
        assert!(files.len() == 6 * 3 && files[0].to_string_lossy().contains(scene), "{said}");
        for word in ["-eye.svg", "-pseudocode.pdf", "-z-pyramid-stacked.png", "-visible-list.svg"] {
            assert!(said.contains(word), "{word}: {said}");
        }
        for file in &files {
            let carried = carried(&here.join(file));
            assert_eq!(carried["method"], "hierarchical-z");
            assert_eq!(carried["scene"], format!("../../{}", task[2]), "found from the file");
        }
        files.iter().for_each(|file| made_again(&here.join(file)));
        let mut state = State::new();
        state.apply(Command::Open(here.join(files[0]).to_string_lossy().into_owned()));
        state.block_until_idle();
        let sentence = state.sentence();
        assert!(sentence.contains("hidden") || sentence.contains("behind"), "{sentence}");
    }
    assert!(done(&here, &["figure", "--check", "sub/figures"]).contains("36 of 36 figures"));
}

#[test]
fn the_caption_says_what_is_not_by_default_and_the_step_is_marked() {
    let here = folder("caption");
    let room = shipped("scenes3d/corner_hole/corner_hole.obj");
    let task = ["figure", "--scene", &room, "--method", "large-occluders", "--set", "tree-height=5"];
    done(&here, &with(&task, &["--where", "kind:nodedecided"]));
    let file = fs::read_dir(&here).expect("a folder").flatten().map(|e| e.path());
    let file = file.filter(|p| p.extension().is_some_and(|e| e == "svg")).last().expect("a figure");
    let svg = fs::read_to_string(&file).expect("a figure");
    let state = carried(&file);
    let start = svg.find("<desc").expect("a description");
    let alt = &svg[start..svg.find("</desc>").expect("its end")];
    assert!(alt.contains("tree-height 5") && alt.contains("departs from its paper"), "{alt}");
    // Nothing else of some ten parameters, and the legend in the screen's words with counts.
    assert!(!alt.contains("directions") && alt.contains("not decided") && alt.contains("drawn 0"), "{alt}");
    assert!(svg.contains("role=\"img\"") && svg.contains("<title"));
    // The node of the step has its box, and surfaces are pixels: nothing of them is a shape.
    let emphasis = svg.find("id=\"layer-emphasis\"").or_else(|| svg.find("id=\"layer-evidence\""));
    assert!(svg[emphasis.expect("marks")..].contains("current\""), "step {}", state["step"]);
    assert!(svg.contains("data-node=") && svg.contains("<image") && !svg.contains("id=\"layer-scene\""));
}

#[test]
fn the_window_writes_what_the_command_writes() {
    let here = folder("window");
    let building = shipped("scenes3d/corner_hole/corner_hole.obj");
    for source in [here.join("walls.json").to_string_lossy().into_owned(), building] {
        let mut state = State::new();
        state.folder = here.clone();
        state.apply(Command::Open(source));
        state.block_until_idle();
        state.apply(Command::Method("hierarchical-z".into()));
        state.apply(Command::Set("backface-culling".into(), "true".into(), 0));
        state.block_until_idle();
        state.apply(Command::GoTo(state.len() / 2));
        state.apply(Command::Select(Subject::Prim(PrimId(1))));
        state.apply(Action::CycleSurface);
        state.apply(Action::CycleLookIn);
        state.apply(Command::ShowWithout([1, 3, 4].map(ObjectId).into()));
        let mut camera = state.observer;
        camera.orbit(0.3, -0.2);
        camera.slide(glam::Vec2::new(0.1, -0.7));
        state.apply(Command::Observe(camera));
        state.apply(Command::Picture("visible list".into()));
        for (pictures, format) in [
            (vec![Picture::Observer], Format::Svg),
            (vec![Picture::Eye], Format::Pdf),
            (vec![Picture::Own(1)], Format::Png),
            (vec![Picture::Code], Format::Svg),
            (vec![Picture::Observer, Picture::Eye, Picture::Code], Format::Pdf),
        ] {
            state.apply(Command::Figures(Box::new(Export { pictures, ..Export::default() })));
            state.notices.clear();
            let path = written(&mut state, format);
            made_again(Path::new(&path));
            // A second one does not overwrite the first.
            state.export(format, 1.37);
            let name = state.notices[1].text.clone();
            assert!(name.contains(&format!("-2.{}", format.name())), "{name}");
        }
        // As vectors, in flatland as they are without.
        state.apply(Command::Figures(Box::new(Export { is_vector: true, ..Export::default() })));
        state.folder = here.join("vectors");
        fs::create_dir_all(&state.folder).expect("a folder");
        state.notices.clear();
        let path = written(&mut state, Format::Svg);
        made_again(Path::new(&path));
        assert!(!fs::read_to_string(&path).expect("a figure").contains("<image"), "{path}");
    }
    // What is too large for vectors is refused in a line, before it is put in order.
    let mut state = State::new();
    state.folder = here.join("vectors");
    state.apply(Command::Open("generate:building?polygons=20000".into()));
    state.block_until_idle();
    state.exporting.is_vector = true;
    state.notices.clear();
    state.export(Format::Svg, 1.37);
    let said = &state.notices[0];
    assert!(said.is_error && said.text.contains("too many for vectors"), "{said:?}");
}

/// Exports the figure that is set up; its path.
fn written(state: &mut State, format: Format) -> String {
    state.export(format, 1.37);
    while state.is_making() {
        state.poll();
    }
    let said = state.notices[0].text.clone();
    said.trim_start_matches("The figure was written to ").trim_end_matches('.').to_owned()
}

#[test]
fn a_figure_that_is_opened_is_written_again_byte_by_byte() {
    let here = folder("again");
    let views = ["--eye", "8.5,1,-8.5", "--target", "20,1.1,-12", "--fov", "47.3", "--size", "64x48"];
    let solid = with(&["figure", "--scene", "boxes.obj", "--method", "hierarchical-z"], &views);
    let flat = with(&OWN, &["--set", "backface-culling=true", "--theme", "dark"]);
    for task in [&flat, &solid] {
        for more in [
            &["--first-hidden", "--paper", "column", "--format", "svg,pdf,png"][..],
            &["--step", "9", "--picture", "eye,observer", "--as", "page", "--paper", "120x150"],
            &["--steps", "0..40..8", "--as", "page", "--text", "paths", "--aspect", "1.5"],
            &["--steps", "0..40..20", "--as", "pages"],
            &["--steps", "0..6..2", "--as", "animation", "--rate", "4", "--paper", "60"],
        ] {
            for file in done(&here, &with(task, more)).lines() {
                let file = here.join(file);
                let before = fs::read(&file).expect("a figure");
                let format: Format = file.extension().expect("one").to_string_lossy().parse().expect("one");
                let mut state = State::new();
                state.apply(Command::Open(file.to_string_lossy().into_owned()));
                state.block_until_idle();
                state.folder = here.clone();
                state.notices.clear();
                fs::remove_file(&file).expect("a file of our own");
                let path = written(&mut state, format);
                assert_eq!(Path::new(&path).file_name(), file.file_name());
                assert!(fs::read(&path).expect("a figure") == before, "{path}: {}", carried(&file)["figure"]);
                made_again(&file);
            }
        }
    }
    assert!(done(&here, &["figure", "--check", "."]).contains("14 of 14 figures"));
}

#[test]
fn several_steps_are_one_page_several_pages_or_an_animation() {
    let here = folder("several");
    let as_one = |more: &[&str]| done(&here, &with(&with(&OWN, &["--steps", "0..40..4", "--as"]), more));
    let sheet = as_one(&["page", "--picture", "observer,eye"]);
    let svg = fs::read_to_string(here.join(sheet.trim())).expect("a figure");
    for step in (0..=40).step_by(4) {
        assert!(svg.contains(&format!("step {step}: Eye view")), "{step}");
    }
    assert!(svg.contains("Steps 0 to 40, every 4th, of"), "the caption");
    // The counts of the legend are those of one step.
    assert!(svg.contains(">drawn<") && !svg.contains("drawn 0"), "the legend");
    let pages = fs::read(here.join(as_one(&["pages"]).trim())).expect("a figure");
    let count = |needle: &str| String::from_utf8_lossy(&pages).matches(needle).count();
    assert_eq!(count("/Type/Page\n") + count("/Type/Page/") + count("/Type /Page\n"), 11);
    let png = fs::read(here.join(as_one(&["animation"]).trim())).expect("a figure");
    let control = png.windows(4).position(|w| w == b"acTL").expect("an animation");
    assert_eq!(png[control + 4..control + 8], [0, 0, 0, 11]);
    // The same of a session, and of a trace.
    let mut state = State::new();
    state.apply(Command::Open(here.join("walls.json").to_string_lossy().into_owned()));
    state.block_until_idle();
    state.apply(Command::Method("hierarchical-z".into()));
    state.block_until_idle();
    state.apply(Command::GoTo(12));
    state.apply(Command::SaveTo(here.join("talk.session.json").to_string_lossy().into_owned()));
    let said = done(&here, &["figure", "--scene", "talk.session.json", "--picture", "eye"]);
    assert!(said.contains("step-12-eye.svg"), "{said}");
    let trace = ["step", "walls.json", "--method", "hierarchical-z", "--random-views", "2"];
    done(&here, &with(&trace, &["--out", "run.jsonl"]));
    let said =
        done(&here, &["trace", "figure", "run.jsonl", "--frame", "1", "--step", "12", "--out", "traced"]);
    // Views that are not the scene's are in the file, which is made again from itself.
    let traced = here.join("traced");
    let (file, before) = (here.join(said.trim()), fs::read(here.join(said.trim())).expect("a figure"));
    let line = carried(&file)["figure"]["command"].as_str().expect("a command").to_owned();
    let words = words(&line);
    done(&traced, &words[1..].iter().map(String::as_str).collect::<Vec<_>>());
    assert!(fs::read(&file).expect("a figure") == before, "{line}");
    assert!(done(&here, &["figure", "--check", "traced"]).contains("1 of 1 figures"));
    let text = fs::read_to_string(here.join("run.jsonl")).expect("a trace");
    fs::write(here.join("run.jsonl"), text.replacen("hidden", "visible", 1)).expect("a trace");
    for (words, status, what) in [
        (&["trace", "figure", "run.jsonl"][..], 1, "is not what the method tells"),
        (&["figure", "--scene", "walls.json"], 2, "--method"),
        (&["figure", "--scene", "talk.session.json", "--size", "9x9"], 2, "has a view of its own"),
        (&with(&OWN, &["--steps", "0..4", "--as", "animation", "--format", "svg"]), 2, "animations are png"),
        (&with(&OWN, &["--steps", "0..999", "--as", "page"]), 2, "the run has"),
        (&with(&OWN, &["--rate", "3"]), 2, "--as"),
        (&with(&OWN, &["--paper", "a4"]), 2, "column, page, slide"),
    ] {
        let said = refused(&here, words, status);
        assert!(said.contains(what), "{said}");
    }
}

#[test]
fn a_folder_is_checked_figure_by_figure() {
    let here = folder("check");
    done(&here, &with(&OWN, &["--step", "20", "--out", "out", "--format", "svg,png"]));
    done(&here, &["figure", "coorg-teller-figure-4", "--out", "out"]);
    fs::write(here.join("out/foreign.svg"), "<svg/>").expect("written");
    let said = done(&here, &["figure", "--check", "out"]);
    assert!(said.contains("foreign.svg: not checked: it was made by another program"), "{said}");
    assert!(said.ends_with("3 of 3 figures are made again as they are\n"), "{said}");
    let svg = here.join("out/two-walls-hierarchical-z-step-20.svg");
    let text = fs::read_to_string(&svg).expect("a figure");
    fs::write(&svg, text.replacen("stroke-width=\"1", "stroke-width=\"2", 1)).expect("written");
    fs::write(here.join("out/cut.pdf"), "%PDF").expect("written");
    fs::remove_file(here.join("out/coorg-teller-figure-4.svg")).expect("a file of our own");
    let output = cullscope(&here, &["figure", "--check", "out"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("two-walls-hierarchical-z-step-20.svg: differs"), "{said}");
    assert!(said.ends_with("1 of 2 figures are made again as they are\n"), "{said}");
    // Another scene under its name is no longer what was drawn.
    let walls = fs::read_to_string(here.join("walls.json")).expect("a scene");
    fs::write(&svg, text).expect("written");
    fs::write(here.join("walls.json"), walls.replace("[-1,3,1,3]", "[-1,3,1.5,3]")).expect("written");
    let output = cullscope(&here, &["figure", "--check", "out"]);
    assert_eq!(output.status.code(), Some(1), "the scene has changed");
    assert!(String::from_utf8_lossy(&output.stdout).contains("0 of 2"));
    fs::remove_file(here.join("walls.json")).expect("a file of our own");
    let output = cullscope(&here, &["figure", "--check", "out"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("was not found"), "the scene is gone");
    refused(&here, &["figure", "--check", "none"], 1);
}

#[test]
fn words_of_figures_that_are_off_say_what_there_is() {
    let here = folder("own-words");
    let off: [(&[&str], &str); 10] = [
        (&["--do", "select:node:99999"], "no such thing"),
        (&["--picture", "piramid"], "did you mean `z-pyramid`?"),
        (&["--step", "99999"], "steps: 0 to "),
        (&["--where", "verdict:purple"], "verdict:"),
        (&["--where", "verdit:hidden"], "verdict:"),
        (&["--where", ""], "--step N"),
        (&["--set", "pixel=1"], "parameters"),
        (&["--do", "dance"], "not a command"),
        (&["--path", "eye"], "did you mean `eyes`?"),
        (&["--step", "1", "--last"], "cannot be used"),
    ];
    for (more, hint) in off {
        let said = refused(&here, &with(&OWN, more), 2);
        assert!(said.contains(hint), "{more:?}: {said}");
    }
    refused(&here, &["figure", "--scene", "walls.json"], 2);
    refused(&here, &["figure", "--method", "frustum"], 2);
    refused(&here, &["figure", "--all", "--step", "3"], 2);
    refused(&here, &["figure", "--all", "--random-views", "3"], 2);
    refused(&here, &with(&OWN, &["coorg-teller-figure-4"]), 2);
    refused(&here, &with(&OWN, &["--all"]), 2);
    refused(&here, &["figure", "--scene", "walls.json", "--method", "frustrum"], 2);
    let said = refused(&here, &with(&OWN, &["--method", "frustum"]), 2);
    assert!(said.contains("--method"), "{said}");
    assert!(fs::read_dir(&here).expect("a folder").count() == 2, "nothing was written");
}

#[test]
fn steps_are_numbered_files() {
    let here = folder("steps");
    let said = done(&here, &with(&OWN, &["--steps", "2..14..4", "--picture", "pseudocode"]));
    let names =
        ["02", "06", "10", "14"].map(|n| format!("./two-walls-hierarchical-z-step-{n}-pseudocode.svg"));
    assert_eq!(said.lines().collect::<Vec<_>>(), names);
    names.iter().for_each(|name| assert!(here.join(name).exists()));
    assert!(done(&here, &["figure", "--check", "."]).contains("4 of 4"));
    for off in ["4..2", "a..b", "1..9..0", "1"] {
        refused(&here, &with(&OWN, &["--steps", off]), 2);
    }
    assert!(refused(&here, &with(&OWN, &["--steps", "0..99999"]), 2).contains("steps: 0 to"));
}

/// The pixels of a PNG file, three numbers each, with its size.
fn pixels(file: &Path) -> (u32, u32, Vec<[u8; 3]>) {
    let reader = png::Decoder::new(std::io::BufReader::new(fs::File::open(file).expect("a picture")));
    let mut reader = reader.read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    let step = info.color_type.samples();
    (info.width, info.height, bytes.chunks_exact(step).map(|p| [p[0], p[1], p[2]]).collect())
}

/// Surfaces as vectors hide each other as pixels do: the picture is the same but for lines. What pierces each
/// other is cut, and what was culled has no surface.
#[test]
fn vectors_hide_what_is_behind() {
    let here = folder("vectors");
    for (scene, method) in [("generate:failure?case=interpenetration", "z-buffer"), ("boxes.obj", "z-buffer")]
    {
        let task =
            ["figure", "--scene", scene, "--method", method, "--do", "show-evidence", "--do", "show-eye"];
        done(&here, &with(&task, &["--format", "png,svg", "--out", "pixels"]));
        done(&here, &with(&task, &["--format", "png,svg", "--out", "vectors", "--vectors"]));
        let files = fs::read_dir(here.join("vectors")).expect("a folder").flatten().map(|e| e.path());
        for file in files {
            let plain = here.join("pixels").join(file.file_name().expect("a name"));
            if file.extension().is_some_and(|e| e == "svg") {
                let [text, other] = [&file, &plain].map(|f| fs::read_to_string(f).expect("a figure"));
                assert!(!text.contains("<image") && text.contains("facet visible"), "{scene}");
                assert!(other.contains("<image") && !other.contains("facet"), "{scene}");
                continue;
            }
            let ((w, h, a), (v, g, b)) = (pixels(&plain), pixels(&file));
            // The caption, which says nothing of it, has as much room.
            assert_eq!((w, h), (v, g), "{scene}");
            let far = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 24);
            let differ = a.iter().zip(&b).filter(|(a, b)| far((a, b))).count();
            let painted = a.iter().filter(|p| p.iter().any(|c| *c < 230)).count();
            assert!(painted > a.len() / 50 && differ < painted / 12, "{scene}: {differ} of {painted} differ");
        }
        fs::remove_dir_all(here.join("pixels")).expect("our own");
        fs::remove_dir_all(here.join("vectors")).expect("our own");
    }
    // What culled is only outlined, and it is made again as it is.
    let task = ["figure", "--scene", "boxes.obj", "--method", "frustum", "--vectors", "--out", "again"];
    let said = done(&here, &with(&task, &["--eye", "8.5,1,-8.5", "--target", "20,1.1,-12"]));
    let file = here.join(said.trim());
    let text = fs::read_to_string(&file).expect("a figure");
    assert!(text.contains("edge outside") && !text.contains("facet outside"), "{said}");
    made_again(&file);
    assert!(done(&here, &["figure", "--check", "again"]).contains("1 of 1 figures"));
    let large =
        ["figure", "--scene", "generate:building?polygons=20000", "--method", "z-buffer", "--vectors"];
    let said = refused(&here, &large, 1);
    assert!(said.contains("too many for vectors") && said.lines().count() <= 2, "{said}");
}

#[test]
fn figures_do_not_depend_on_the_number_of_threads() {
    let here = folder("threads");
    let views = ["--eye", "8.5,1,-8.5", "--target", "20,1.1,-12", "--fov", "47.3", "--size", "64x48"];
    let solid = with(&["figure", "--scene", "boxes.obj", "--method", "occlusion-maps"], &views);
    let made: Vec<Vec<Vec<u8>>> = ["1", "2"]
        .into_iter()
        .map(|threads| {
            let more = ["--picture", "all", "--last", "--format", "svg,pdf,png", "--out", threads];
            let output = process::Command::new(env!("CARGO_BIN_EXE_cullscope"))
                .args(with(&solid, &more))
                .env("RAYON_NUM_THREADS", threads)
                .current_dir(&here)
                .output()
                .expect("the program runs");
            let said = String::from_utf8(output.stdout).expect("UTF-8");
            said.lines().map(|file| fs::read(here.join(file)).expect("a figure")).collect()
        })
        .collect();
    assert!(made[0].len() >= 12 && made[0] == made[1]);
}

#[test]
fn the_flatland_twin_is_culled_by_the_same_method_from_the_same_place() {
    let here = folder("twin");
    let room = shipped("scenes3d/corner_hole/corner_hole.obj");
    let views = ["--eye", "-6,1,0.4", "--target", "0,1,0.4", "--size", "200x150"];
    let solid = with(&["figure", "--scene", "boxes.obj", "--method", "large-occluders"], &views);
    let said = done(&here, &with(&solid, &["--picture", "observer,flatland-twin", "--as", "page"]));
    let file = here.join(said.trim());
    let svg = fs::read_to_string(&file).expect("a figure");
    assert!(svg.contains("Flatland twin: what the level plane through the Eye cuts, "), "{said}");
    assert!(svg.contains(">flatland twin<"), "its label");
    made_again(&file);
    let down = ["--eye", "0,9,0", "--target", "0,0,0", "--up", "1,0,0", "--picture", "flatland-twin"];
    let task = ["figure", "--scene", &room, "--method", "frustum"];
    assert!(refused(&here, &with(&task, &down), 1).contains("straight up or down"));
    assert!(refused(&here, &with(&OWN, &["--picture", "flatland-twin"]), 2).contains("no picture"));
}
