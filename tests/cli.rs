//! The real program on small scenes: every subcommand, exit status, error lines, JSON keys, files.

#[path = "cli/cubes.rs"]
mod cubes;
#[path = "cli/figures.rs"]
mod figures;
#[path = "cli/gallery.rs"]
mod gallery;
#[path = "cli/motion.rs"]
mod motion;
#[path = "cli/stability.rs"]
mod stability;
#[path = "cli/sweep.rs"]
mod sweep;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use cullscope::culling::Methods;
use cullscope::geometry::{Flat, Solid};
use serde_json::Value as Json;

/// A fresh folder of this test's own with a scene of each space in it.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{test}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    fs::write(folder.join("boxes.obj"), boxes()).expect("a written scene");
    let flat = r#"{"name": "two walls", "segments": [[-4,6,4,6], [-1,3,1,3], [20,0,20,1]],
        "objects": [[0], [1], [2]], "object_names": ["back", "front", "aside"],
        "eyes": [[0,0,0,1], [0.5,0,0,1]]}"#;
    fs::write(folder.join("walls.json"), flat).expect("a written scene");
    folder
}

/// 7 × 7 boxes with gaps, 588 triangles.
fn boxes() -> String {
    let mut text = String::from("# boxes\n");
    let mut base = 0;
    for i in 0..49 {
        let (x, z) = (f64::from(i % 7) * 3.0, f64::from(i / 7) * -3.0);
        text += &format!("o box_{i}\n");
        for c in 0..8 {
            text += &format!(
                "v {} {} {}\n",
                x + f64::from(c & 1),
                f64::from(c >> 1 & 1) * 2.0,
                z - f64::from(c >> 2)
            );
        }
        for quad in [[1, 2, 4, 3], [5, 7, 8, 6], [1, 5, 6, 2], [3, 4, 8, 7], [1, 3, 7, 5], [2, 6, 8, 4]] {
            text += &format!("f {}\n", quad.map(|c| (c + base).to_string()).join(" "));
        }
        base += 8;
    }
    text
}

fn cullscope(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cullscope"))
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("the program runs")
}

/// Standard output of a call that must succeed.
fn done(folder: &Path, words: &[&str]) -> String {
    let output = cullscope(folder, words);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words:?}: {said}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Status and standard error of a call that must fail in one line, or two with the help.
fn refused(folder: &Path, words: &[&str], status: i32) -> String {
    let output = cullscope(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{words:?}: {said}");
    assert_eq!(output.stdout, b"", "{words:?} prints nothing");
    let lines: Vec<&str> = said.lines().filter(|l| !l.starts_with("view: ")).collect();
    assert!(lines[0].starts_with("error: ") && lines[0].matches(": ").count() >= 2, "{words:?}: {said}");
    assert!(lines.len() == 1 || (lines.len() == 2 && lines[1].starts_with("help: ")), "{words:?}: {said}");
    assert!(!said.contains("panicked") && !said.contains("internal"), "{words:?}: {said}");
    said
}

fn json(text: &str) -> Json {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

fn keys(object: &Json) -> Vec<&str> {
    object.as_object().expect("an object").keys().map(String::as_str).collect()
}

/// The view that most tests use: from the middle along a row of boxes.
const ALONG: [&str; 6] = ["--eye", "8.5,1,-8.5", "--target", "20,1,-12", "--size", "96x64"];

fn with<'a>(words: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    words.iter().chain(more).copied().collect()
}

#[test]
fn every_command_explains_itself_with_an_example() {
    let here = folder("help");
    let commands: [&[&str]; 16] = [
        &["explore"],
        &["cull"],
        &["step"],
        &["figure"],
        &["paper"],
        &["stability"],
        &["bench", "occlusion"],
        &["methods"],
        &["scene", "info"],
        &["scene", "generators"],
        &["scene", "convert"],
        &["trace", "check"],
        &["truth"],
        &["sweep"],
        &["sweep", "merge"],
        &["advise"],
    ];
    for words in commands {
        let text = done(&here, &with(words, &["--help"]));
        assert!(
            text.contains("Example") && text.contains(&format!("cullscope {}", words.join(" "))),
            "{words:?}: {text}"
        );
    }
    assert_eq!(done(&here, &["--version"]), format!("cullscope {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn methods_are_listed_with_their_parameters() {
    let here = folder("methods");
    let listed = json(&done(&here, &["methods", "--json"]));
    let methods = listed["methods"].as_array().expect("a list");
    let names: Vec<_> = methods.iter().map(|m| m["key"].as_str().expect("a key")).collect();
    let flat = Flat::methods().iter().map(|m| m.card());
    let solid = Solid::methods().iter().map(|m| m.card()).filter(|c| Flat::method(c.key).is_none());
    let cards: Vec<_> = flat.chain(solid).collect();
    assert_eq!(names, cards.iter().map(|c| c.key).collect::<Vec<_>>());
    for method in methods {
        for param in method["params"].as_array().expect("a list") {
            assert_eq!(keys(param), ["default", "meaning", "name", "range", "source", "type", "unit"]);
        }
    }
    let frustum = &methods[names.iter().position(|n| *n == "frustum").expect("a method")]["params"];
    assert_eq!((&frustum[0]["name"], &frustum[0]["default"]), (&Json::from("tree-height"), &Json::from(8)));
    assert_eq!(frustum[1]["name"], "backface-culling");
    assert!(done(&here, &["methods"]).contains("--set tree-height=8"));
}

/// The table of methods in README.md is made from their cards.
#[test]
fn the_readme_lists_the_methods() {
    let mut table = String::from("| method | what it does | source |\n|---|---|---|\n");
    let listed = json(&done(&folder("readme"), &["methods", "--json"]));
    for m in listed["methods"].as_array().expect("a list") {
        let [key, summary, paper] = ["key", "summary", "paper"].map(|k| m[k].as_str().expect("text"));
        let kind = if m["conservative"] == true { "" } else { " Not conservative." };
        table += &format!("| `{key}` | {summary}{kind} | {paper} |\n");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = fs::read_to_string(path).expect("README.md");
    assert!(readme.contains(&table), "README.md needs this table of methods:\n\n{table}");
}

#[test]
fn cull_prints_the_contract() {
    let here = folder("cull");
    let words = with(&["cull", "boxes.obj", "--method", "frustum", "--set", "tree-height=5"], &ALONG);
    let plain = json(&done(&here, &words));
    assert_eq!(
        keys(&plain),
        ["build_ms", "cullscope", "frames", "index_bytes", "method", "params", "scene", "triangles"]
    );
    assert_eq!(
        (&plain["triangles"], &plain["method"], &plain["params"]["tree-height"]),
        (&588.into(), &"frustum".into(), &5.into())
    );
    let frame = &plain["frames"][0];
    assert_eq!(keys(frame), ["counters", "cull_ms", "draw_ms", "drawn_triangles", "stages_ms", "view"]);
    assert!(
        frame["counters"]["nodes_entered"].as_u64() > Some(1)
            && frame["counters"]["planes_tested"].as_u64() > Some(1)
    );

    let full = json(&done(&here, &with(&words, &["--truth", "--ids"])));
    let frame = &full["frames"][0];
    let truth = &frame["truth"];
    let expected = [
        "coverage_ratio",
        "flip_mean",
        "missed_ids",
        "missed_triangles",
        "overdraw",
        "visible_triangles",
        "wrong_pixel_ratio",
        "wrong_pixels",
    ];
    assert_eq!(keys(truth), expected);
    let ids: Vec<u64> = frame["drawn_ids"].as_array().expect("ids").iter().filter_map(Json::as_u64).collect();
    assert_eq!(ids.len() as u64, frame["drawn_triangles"]);
    assert!(ids.is_sorted() && ids.len() < 588, "ascending, and something was culled");
    assert!(truth["visible_triangles"].as_u64() > Some(10));
    assert_eq!((&truth["missed_triangles"], &truth["wrong_pixels"]), (&0.into(), &0.into()));
    assert_eq!((truth["coverage_ratio"].as_f64(), truth["flip_mean"].as_f64()), (Some(1.0), Some(0.0)));
}

#[test]
fn a_budget_that_is_too_small_shows_in_the_truth() {
    let here = folder("budget");
    let words =
        with(&["cull", "boxes.obj", "--method", "centroid", "--set", "budget=3", "--truth", "--ids"], &ALONG);
    let truth = &json(&done(&here, &words))["frames"][0]["truth"];
    assert!(
        truth["missed_triangles"].as_u64() > Some(0) && truth["wrong_pixels"].as_u64() > Some(0),
        "{truth}"
    );
    assert_eq!(truth["missed_ids"].as_array().map(|l| l.len() as u64), truth["missed_triangles"].as_u64());
    assert!(
        truth["flip_mean"].as_f64() > Some(0.0) && truth["coverage_ratio"].as_f64() < Some(1.0),
        "{truth}"
    );
}

#[test]
fn back_faces_are_left_out_of_answer_and_truth_alike() {
    let here = folder("backface");
    let words = with(
        &["cull", "boxes.obj", "--method", "frustum", "--truth", "--set", "backface-culling=true"],
        &ALONG,
    );
    let one_sided = json(&done(&here, &words));
    let two_sided = json(&done(&here, &with(&["cull", "boxes.obj", "--method", "frustum"], &ALONG)));
    let drawn = |report: &Json| report["frames"][0]["drawn_triangles"].as_u64().expect("a count");
    assert!(drawn(&one_sided) * 3 < drawn(&two_sided) * 2);
    assert_eq!(one_sided["frames"][0]["truth"]["missed_triangles"], 0);
}

/// A scene that ships with the program.
fn shipped(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).display().to_string()
}

#[test]
fn what_stands_behind_glass_is_seen() {
    let here = folder("glass");
    let window = shipped("scenes2d/shop_window.json");
    for method in ["large-occluders", "hierarchical-z", "parallel-hierarchical-z"] {
        let seen = |surfaces: &str| {
            let words = ["cull", &window, "--method", method, "--truth", "--set", surfaces];
            let truth = &json(&done(&here, &words))["frames"][0]["truth"];
            assert_eq!(
                (&truth["missed_triangles"], &truth["wrong_pixels"]),
                (&0.into(), &0.into()),
                "{method}"
            );
            truth["visible_triangles"].as_u64()
        };
        // The scene's own facts of its first eye; where glass is a wall, the front and it are all one sees.
        assert_eq!([seen("see-through=open"), seen("see-through=solid")], [Some(12), Some(4)], "{method}");
    }
}

#[test]
fn views_come_from_files_paths_options_or_chance() {
    let here = folder("views");
    let views = r#"{"width":64,"height":48,"views":[
        {"eye":[-2,1,0.5],"target":[10,1,-6],"up":[0,1,0],"fov_y_degrees":60,"near":0.1,"far":100},
        {"eye":[9,30,-9],"target":[9,0,-9],"up":[0,1,0],"fov_y_degrees":60,"near":0.1,"far":100}]}"#;
    fs::write(here.join("path.json"), views).expect("written");
    let base = ["cull", "boxes.obj", "--method", "frustum", "--truth"];
    let words = with(&base, &["--view", "path.json", "--image", "shot.png", "--out", "two.json"]);
    assert_eq!(done(&here, &words), "", "what goes to a file is not printed as well");
    let two = json(&fs::read_to_string(here.join("two.json")).expect("the file"));
    assert_eq!(two["frames"].as_array().map(Vec::len), Some(2));
    assert_eq!(two["frames"][1]["view"], 1);
    for name in ["shot-000.png", "shot-001.png"] {
        let bytes = fs::read(here.join(name)).expect("an image a view");
        assert_eq!(&bytes[1..4], b"PNG");
        assert_eq!((&bytes[16..20], &bytes[20..24]), (&64u32.to_be_bytes()[..], &48u32.to_be_bytes()[..]));
    }
    let random = |seed| {
        json(&done(&here, &with(&base, &["--random-views", "3", "--seed", seed, "--size", "40x30", "--ids"])))
    };
    let drawn = |report: &Json| {
        report["frames"]
            .as_array()
            .expect("frames")
            .iter()
            .map(|f| f["drawn_ids"].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(drawn(&random("5")).len(), 3);
    assert_eq!(drawn(&random("5")), drawn(&random("5")));
    assert_ne!(drawn(&random("5")), drawn(&random("6")));
    // Without any, the view is chosen and printed in words that give it again.
    let chosen = cullscope(&here, &with(&base, &["--ids", "--size", "64x64"]));
    let said = String::from_utf8_lossy(&chosen.stderr).into_owned();
    let again: Vec<&str> = said.trim().strip_prefix("view: ").expect("a line").split(' ').collect();
    let first = json(&String::from_utf8_lossy(&chosen.stdout));
    assert_eq!(drawn(&first), drawn(&json(&done(&here, &with(&with(&base, &["--ids"]), &again)))));
    // A flatland scene brought a path.
    let eyes = json(&done(
        &here,
        &[
            "cull",
            "walls.json",
            "--method",
            "frustum",
            "--truth",
            "--ids",
            "--path",
            "eyes",
            "--set",
            "tree-height=3",
        ],
    ));
    assert_eq!(eyes["frames"].as_array().map(Vec::len), Some(2));
    assert_eq!(eyes["frames"][0]["drawn_ids"], json("[0,1]"));
    assert_eq!(eyes["frames"][0]["truth"]["missed_triangles"], 0);
}

#[test]
fn steps_are_written_the_same_each_time_and_check() {
    let here = folder("step");
    for (scene, more, frames) in [("boxes.obj", &ALONG[..], 1), ("walls.json", &["--path", "eyes"], 2)] {
        let words = with(&["step", scene, "--method", "frustum", "--set", "tree-height=4"], more);
        let first = done(&here, &words);
        assert_eq!(first, done(&here, &words));
        done(&here, &with(&words, &["--out", "run.jsonl"]));
        assert_eq!(fs::read_to_string(here.join("run.jsonl")).expect("written"), first);
        assert!(done(&here, &["trace", "check", "run.jsonl"]).contains("valid"));
        let mut lines = first.lines();
        let header = json(lines.next().expect("a header"));
        assert_eq!(
            (&header["trace"], &header["method"], &header["params"]["tree-height"]),
            (&1.into(), &"frustum".into(), &4.into())
        );
        assert_eq!(header["scene"], scene);
        assert!(header["view"]["views"][0]["eye"].is_array());
        let events: Vec<Json> = lines.map(json).collect();
        assert!(events.iter().any(|e| e["event"] == "NodeClassified"
            && e["line"] == "Visible:2"
            && e["far_corner_units"].is_array()));
        assert!(events.iter().all(|e| e["step"].is_u64() && e["frame"].is_u64() && e["event"].is_string()));
        let first_steps = events.iter().filter(|e| e["step"] == 1).map(|e| &e["frame"]);
        assert!(
            first_steps.eq((0..frames).map(Json::from).collect::<Vec<_>>().iter()),
            "every view is a frame"
        );
        let coarse = done(&here, &with(&words, &["--detail", "coarse"]));
        assert!(coarse.lines().count() < first.lines().count() && !coarse.contains("LineReached"));
    }
}

#[test]
fn a_bad_trace_is_refused_by_its_first_bad_line() {
    let here = folder("trace");
    let trace = done(&here, &with(&["step", "boxes.obj", "--method", "z-buffer"], &ALONG));
    let spoiled = trace.replacen("\"step\":7,", "\"step\":3,", 1);
    fs::write(here.join("bad.jsonl"), spoiled).expect("written");
    let said = refused(&here, &["trace", "check", "bad.jsonl"], 1);
    assert!(said.starts_with("error: bad.jsonl:8: "), "{said}");
    fs::write(here.join("bad.jsonl"), "").expect("written");
    assert!(refused(&here, &["trace", "check", "bad.jsonl"], 1).starts_with("error: bad.jsonl:1: "));
    refused(&here, &["trace", "check", "none.jsonl"], 1);
}

#[test]
fn a_trace_is_proven_and_an_altered_one_is_not() {
    let here = folder("prove");
    for (method, scene, more) in [
        ("frustum", "boxes.obj", &ALONG[..]),
        ("large-occluders", "boxes.obj", &["--random-views", "3", "--size", "64x48"]),
        ("large-occluders", "walls.json", &["--path", "eyes"]),
    ] {
        let trace = done(&here, &with(&["step", scene, "--method", method], more));
        fs::write(here.join("run.jsonl"), &trace).expect("written");
        let said = done(&here, &["trace", "check", "run.jsonl", "--prove"]);
        assert!(
            said.contains("valid") && said.contains("proven: ") && !said.contains("proven: 0"),
            "{method}: {said}"
        );
        // The last decision is another one, and the format still holds.
        let at = trace.rfind("\"verdict\":\"").expect("a decision");
        let altered =
            trace[..at].to_owned() + &trace[at..].replacen("\"verdict\":\"", "\"verdict\":\"not-", 1);
        fs::write(here.join("altered.jsonl"), altered).expect("written");
        done(&here, &["trace", "check", "altered.jsonl"]);
        let said = refused(&here, &["trace", "check", "altered.jsonl", "--prove"], 1);
        let line = trace[..at].matches('\n').count() + 1;
        assert!(said.contains(&format!("line {line} is not what the method tells")), "{method}: {said}");
        let cut = trace.trim_end().rfind('\n').expect("lines") + 1;
        fs::write(here.join("altered.jsonl"), &trace[..cut]).expect("written");
        refused(&here, &["trace", "check", "altered.jsonl", "--prove"], 1);
        fs::write(
            here.join("altered.jsonl"),
            trace.clone() + trace[cut..].replace("\"frame\":", "\"frame\":9").as_str(),
        )
        .expect("written");
        let said = refused(&here, &["trace", "check", "altered.jsonl", "--prove"], 1);
        assert!(said.contains("what follows"), "{method}: {said}");
    }
    fs::write(here.join("boxes.obj"), boxes().replacen("v 0 ", "v 0.5 ", 1)).expect("written");
    let trace =
        fs::read_to_string(here.join("run.jsonl")).expect("a trace").replacen("walls.json", "boxes.obj", 1);
    fs::write(here.join("other.jsonl"), trace).expect("written");
    assert!(
        refused(&here, &["trace", "check", "other.jsonl", "--prove"], 1)
            .contains("not the scene of this trace")
    );
}

#[test]
fn scenes_are_described() {
    let here = folder("info");
    let info = json(&done(&here, &["scene", "info", "boxes.obj", "--json"]));
    assert_eq!(
        (&info["triangles"], &info["live"], &info["objects"], &info["space"]),
        (&588.into(), &588.into(), &49.into(), &"space".into())
    );
    assert_eq!(info["bounds"], json("[[0.0,0.0,-19.0],[19.0,2.0,0.0]]"));
    for key in ["groups", "materials", "dropped", "memory_bytes", "sha256", "paths", "points", "notes"] {
        assert!(info.get(key).is_some(), "`{key}`: {info}");
    }
    assert!(done(&here, &["scene", "info", "walls.json"]).contains("flatland"));
    let listed = done(&here, &["scene", "generators"]);
    assert!(listed.contains("generate:building") && listed.contains("polygons="), "{listed}");
}

#[test]
fn converted_scenes_are_the_same_scenes() {
    let here = folder("convert");
    fs::write(here.join("odd.obj"), boxes() + "f 1 1 2\nusemtl nothing\nf 1 2 3 4\n").expect("written");
    done(&here, &["scene", "convert", "odd.obj", "out.obj"]);
    done(&here, &["scene", "convert", "walls.json", "out.json"]);
    let describe = |name: &str| json(&done(&here, &["scene", "info", name, "--json"]));
    for (from, to) in [("odd.obj", "out.obj"), ("walls.json", "out.json")] {
        let (from, to) = (describe(from), describe(to));
        for key in ["triangles", "live", "dropped", "bounds", "objects", "paths", "space"] {
            assert_eq!(from[key], to[key], "`{key}`");
        }
    }
    // Objects, groups, materials and what is see-through stay apart, whatever they are called.
    let text = "mtllib mixed.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\no two words\ng left wing\nusemtl a b\nf 1 2 3\n\
                o same\ng\nusemtl c\nf 1 2 3\ng same\no\nf 1 2 3\no same\ng\nf 3 2 1\n";
    fs::write(here.join("mixed.obj"), text).expect("written");
    let library = "newmtl a b\nKd 1 0 0\nnewmtl c\nKd 0 0 1\nd 0.2\n";
    fs::write(here.join("mixed.mtl"), library).expect("written");
    let said = cullscope(&here, &["scene", "convert", "mixed.obj", "again.obj"]);
    let said = String::from_utf8_lossy(&said.stderr).into_owned();
    assert!(said.contains("and on a line: 1 object (`same` as `same.2`)"));
    assert!(said.contains("`d 0.5`, since how see-through is not known: 1 material (`c`)"));
    let written = fs::read_to_string(here.join("again.obj")).expect("written");
    let lines: Vec<&str> = written.lines().filter(|l| "ogu".contains(&l[..1])).collect();
    assert_eq!(
        lines,
        ["o two words", "g left wing", "usemtl a b", "o same", "g", "usemtl c", "o same.2", "o same"]
    );
    let library = fs::read_to_string(here.join("again.mtl")).expect("written");
    assert_eq!(library, "newmtl a b\nKd 1 0 0\nnewmtl c\nKd 0 0 1\nd 0.5\n");
    let (from, to) = (describe("mixed.obj"), describe("again.obj"));
    for key in ["triangles", "live", "objects", "groups", "materials"] {
        assert_eq!(from[key], to[key], "`{key}`");
    }
    // What is drawn has the same ids.
    let ids = |scene: &str| {
        let words = with(&["cull", scene, "--method", "frustum", "--ids"], &ALONG);
        json(&done(&here, &words))["frames"][0]["drawn_ids"].clone()
    };
    assert_eq!(ids("odd.obj"), ids("out.obj"));
    done(&here, &["scene", "convert", "out.json", "again.json"]);
    assert_eq!(
        fs::read(here.join("out.json")).expect("written"),
        fs::read(here.join("again.json")).expect("written")
    );
    // Glass stays glass.
    let window = shipped("scenes2d/shop_window.json");
    done(&here, &["scene", "convert", &window, "window.json"]);
    let surfaces = |scene: &str| {
        let info = json(&done(&here, &["scene", "info", scene, "--json"]));
        [info["see_through"].as_u64(), info["two_sided"].as_u64()]
    };
    assert_eq!([surfaces(&window), surfaces("window.json")], [[Some(2); 2]; 2]);
    refused(&here, &["scene", "convert", "boxes.obj", "out.json"], 2);
    refused(&here, &["scene", "convert", "walls.json", "out.obj"], 2);
}

#[test]
fn figures_are_written_the_same_each_time() {
    let here = folder("figure");
    let listed = done(&here, &["figure", "--list"]);
    let name = listed.split_whitespace().next().expect("a figure");
    for out in ["a", "b/c"] {
        let said = done(&here, &["figure", name, "--format", "svg,pdf,png", "--theme", "dark", "--out", out]);
        assert_eq!(said.lines().count(), 3, "{said}");
    }
    for (extension, magic) in [("svg", "<"), ("pdf", "%PDF"), ("png", "\u{FFFD}PNG")] {
        let [a, b] = ["a", "b/c"]
            .map(|out| fs::read(here.join(out).join(format!("{name}.{extension}"))).expect("a figure"));
        assert!(a == b && String::from_utf8_lossy(&a).starts_with(magic), "{extension}");
    }
    let written = |text: &str| {
        done(&here, &["figure", name, "--text", text, "--out", "text"]);
        fs::read_to_string(here.join("text").join(name).with_extension("svg")).expect("a figure")
    };
    let (fonts, paths) = (written("fonts"), written("paths"));
    assert!(fonts.contains("<text") && fonts.contains("@font-face") && !fonts.contains("--text"));
    assert!(!paths.contains("<text") && !paths.contains("<style") && paths.contains("--text paths"));
    assert!(refused(&here, &["figure", &name[1..]], 2).contains(&format!("did you mean `{name}`?")));
    refused(&here, &["figure"], 2);
    refused(&here, &["figure", "--all", name], 2);
    refused(&here, &["figure", name, "--out", "boxes.obj"], 1);
}

#[test]
fn former_names_of_figures_work_and_say_the_new_one() {
    let here = folder("former");
    let output = cullscope(&here, &["figure", "large-occluders-4"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert_eq!(said, "note: figure `large-occluders-4` is called `coorg-teller-figure-4` now\n");
    assert!(here.join("coorg-teller-figure-4.svg").exists() && !here.join("large-occluders-4.svg").exists());
    let output = cullscope(&here, &["figure", "coorg-teller-figure-4"]);
    assert!(output.status.success() && output.stderr.is_empty());
}

#[test]
fn a_paper_lists_its_figures_and_tables() {
    let here = folder("contents");
    let said = done(&here, &["paper", "coorg-teller"]);
    let mut lines = said.lines();
    assert!(lines.next().is_some_and(|l| l.starts_with("Coorg and Teller. Real-Time Occlusion Culling")));
    assert_eq!(lines.next(), Some("https://doi.org/10.1145/253284.253312"));
    let (lists, departures) = said.split_once("departs from the paper").expect("it says where it departs");
    assert!(departures.contains("  Section 3.1: "), "{said}");
    let names: Vec<&str> =
        lists.lines().filter(|l| l.starts_with("  ")).filter_map(|l| l.split_whitespace().next()).collect();
    assert_eq!(names.len(), 11 + 5);
    assert!(names.contains(&"coorg-teller-figure-12") && names.contains(&"coorg-teller-table-3"), "{said}");
    // Every name that a list shows is shown by one paper.
    let listed = done(&here, &["figure", "--list"]) + &done(&here, &["paper", "--list"]);
    let papers = ["baselines", "coorg-teller", "georges", "klosowski-silva", "zhang", "chamberlain"];
    let shown: Vec<String> = papers.iter().map(|key| done(&here, &["paper", key])).collect();
    for name in listed.lines().filter_map(|l| l.split_whitespace().next()) {
        let count = shown.iter().filter(|text| text.contains(&format!("  {name} "))).count();
        assert_eq!(count, 1, "{name}");
    }
    assert!(refused(&here, &["paper", "georges-figure-1"], 2).contains("cullscope figure georges-figure-1"));
    assert!(refused(&here, &["figure", "georges-box"], 2).contains("cullscope paper georges-box"));
}

#[test]
fn words_that_are_off_have_status_2_and_a_hint() {
    let here = folder("words");
    let hinted: [(&[&str], &str); 8] = [
        (&["cull", "boxes.obj", "--method", "frustrum"], "did you mean `frustum`?"),
        (
            &["cull", "boxes.obj", "--method", "frustum", "--set", "tree-hight=3"],
            "did you mean `tree-height`?",
        ),
        (&["scene", "info", "generate:bilding"], "did you mean `building`?"),
        (&["cul"], "did you mean `cull`?"),
        (&["cull", "boxes.obj", "--metod", "frustum"], "did you mean `--method`?"),
        (&["cull", "boxes.obj"], "--method"),
        (&["cull", "walls.json", "--method", "frustum", "--path", "eye"], "did you mean `eyes`?"),
        (&["figure", "--format", "gif", "--all"], ""),
    ];
    for (words, hint) in hinted {
        let said = refused(&here, words, 2);
        assert!(said.contains(hint), "{words:?}: {said}");
    }
    let base = ["cull", "boxes.obj", "--method", "frustum"];
    let off: [&[&str]; 14] = [
        &["--set", "tree-height=0"],
        &["--set", "tree-height=many"],
        &["--set", "tree-height"],
        &["--eye", "1,2", "--target", "0,0,0"],
        &["--eye", "1,2,3", "--target", "1,2,3"],
        &["--eye", "1,2,3", "--target", "0,0,nan"],
        &["--eye", "1,2,3"],
        &["--fov", "60"],
        &["--eye", "1,2,3", "--target", "0,0,0", "--fov", "180"],
        &["--eye", "1,2,3", "--target", "0,0,0", "--near", "5", "--far", "2"],
        &["--size", "0x5"],
        &["--size", "99999x5"],
        &["--random-views", "0"],
        &["--threads", "0"],
    ];
    for words in off {
        refused(&here, &with(&base, words), 2);
    }
    refused(&here, &["cull", "walls.json", "--method", "frustum", "--size", "64x64"], 2);
    refused(&here, &["step", "walls.json", "--method", "frustum", "--detail", "some"], 2);
}

#[test]
fn work_that_fails_has_status_1_and_leaves_no_file() {
    let here = folder("work");
    fs::write(here.join("broken.obj"), "v 0 0\nf 1 2 3\n").expect("written");
    fs::write(here.join("broken.json"), "{\"segments\": [[0,0,1").expect("written");
    fs::write(here.join("page.obj"), "<html>not a model</html>").expect("written");
    fs::write(here.join("views.json"), "{\"views\": 7}").expect("written");
    let before = entries(&here);
    for scene in ["broken.obj", "broken.json", "page.obj", "none.obj", ".", "views.json"] {
        for command in ["cull", "step"] {
            refused(&here, &[command, scene, "--method", "frustum", "--out", "result"], 1);
        }
        refused(&here, &["scene", "info", scene], 1);
        refused(&here, &["scene", "convert", scene, "result.obj"], 1);
    }
    let said = refused(&here, &["cull", "box.obj", "--method", "frustum"], 1);
    assert!(said.contains("did you mean `boxes.obj`?"), "{said}");
    refused(
        &here,
        &["cull", "boxes.obj", "--method", "frustum", "--view", "views.json", "--out", "result"],
        1,
    );
    refused(
        &here,
        &["cull", "boxes.obj", "--method", "frustum", "--view", "none.json", "--out", "result"],
        1,
    );
    refused(&here, &["step", "boxes.obj", "--method", "frustum", "--out", "no/such/folder/result"], 1);
    assert_eq!(entries(&here), before);
}

fn entries(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let here = folder("pipe");
    let words = with(&["step", "boxes.obj", "--method", "z-buffer"], &ALONG);
    let mut child = Command::new(env!("CARGO_BIN_EXE_cullscope"))
        .args(&words)
        .current_dir(&here)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(
        (output.status.code(), output.stderr.as_slice()),
        (Some(0), &b""[..]),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Ctrl-C while a long run is written: status 1, one line, and no file, not even half of one.
#[cfg(unix)]
#[test]
fn ctrl_c_stops_cleanly() {
    let here = folder("interrupt");
    let before = entries(&here);
    let words = with(
        &[
            "cull",
            "boxes.obj",
            "--method",
            "frustum",
            "--truth",
            "--random-views",
            "100000",
            "--out",
            "long.json",
        ],
        &[],
    );
    let child = Command::new(env!("CARGO_BIN_EXE_cullscope"))
        .args(&words)
        .current_dir(&here)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    std::thread::sleep(std::time::Duration::from_millis(700));
    // The shell's own word: the program of that name is missing on a bare machine.
    let killed =
        Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status().expect("a shell runs");
    assert!(killed.success(), "the run was still going");
    let output = child.wait_with_output().expect("the program ends");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: interrupted: ") && said.lines().count() == 1, "{said}");
    assert_eq!(entries(&here), before);
}

#[test]
fn the_explorer_says_what_it_lacks_before_it_opens_a_window() {
    let folder = folder("explore");
    let explore = |words: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_cullscope"));
        program
            .args(words)
            .current_dir(&folder)
            .stdin(Stdio::null())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY");
        let output = program.output().expect("the program runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    for words in [&[][..], &["explore", "walls.json"]] {
        let (status, said) = explore(words);
        assert_eq!(status, Some(1), "{said}");
        let windowless = said.starts_with("error: display: there is none")
            || said.starts_with("error: explore: this program was built without");
        assert!(windowless && said.lines().nth(1).is_some_and(|l| l.starts_with("help: ")), "{said}");
    }
    for (words, status, start) in [
        (&["explore", "nowhere.obj"][..], 1, "error: nowhere.obj: there is no such file"),
        (
            &["explore", "walls.json", "--method", "frustrum"],
            2,
            "error: --method: there is no method `frustrum`",
        ),
        (&["explore", "walls.json", "--set", "height"], 2, "error: "),
        (
            &["explore", "walls.json", "--screenshot", "a.png", "--size", "big"],
            2,
            "error: --size: `big` is not of the form 1280x800",
        ),
    ] {
        let (code, said) = explore(words);
        assert_eq!((code, said.starts_with(start)), (Some(status), true), "{words:?}: {said}");
    }
}

#[test]
fn tables_of_the_paper_are_measured_and_written() {
    let here = folder("paper");
    let listed = done(&here, &["paper", "--list"]);
    assert_eq!(listed.lines().count(), 32);
    let scene = [
        "--scene",
        "generate:building?polygons=3000",
        "--frames",
        "6",
        "--size",
        "96x64",
        "--check-every",
        "3",
    ];
    let formats = ["--format", "csv,text,json,svg,pdf,png", "--out", "tables"];
    let text = done(&here, &with(&["paper", "coorg-teller-table-1"], &with(&scene, &formats)));
    assert!(text.contains("Soda") && text.contains("134,832") && text.contains("building"), "{text}");
    let read =
        |name: &str| fs::read(here.join("tables").join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let csv = String::from_utf8(read("coorg-teller-table-1.csv")).expect("UTF-8");
    let head = "source,scene,polygons,frustum_percent,frustum_objects_percent,tree_percent,occlusion_percent,\
                tree_ratio,reduction_ratio,missed_triangles,checked_views";
    assert_eq!(csv.lines().next(), Some(head));
    assert_eq!(csv.lines().nth(2), Some("paper,Soda,134832,19.7,,,2.6,,7.576923076923077,,"));
    let report: Json = json(&String::from_utf8(read("coorg-teller-table-1.json")).expect("UTF-8"));
    assert_eq!(report["rows"][0]["missed_triangles"], 0);
    assert_eq!(report["rows"][0]["checked_views"], 2);
    assert!(report["rows"][0]["frustum_percent"].as_f64() >= report["rows"][0]["occlusion_percent"].as_f64());
    assert_eq!(report["params"]["occluders"], "32");
    assert!(
        read("coorg-teller-table-1.svg").starts_with(b"<svg")
            && read("coorg-teller-table-1.pdf").starts_with(b"%PDF")
    );
    assert!(read("coorg-teller-table-1.png").starts_with(b"\x89PNG"));
    assert_eq!(fs::read_dir(here.join("tables")).expect("a folder").count(), 5, "and no unfinished file");
    assert!(refused(&here, &["paper"], 2).contains("coorg-teller-table-1"));
    assert!(
        refused(&here, &["paper", "coorg-teller-tabel-1"], 2).contains("did you mean `coorg-teller-table-1`")
    );
    assert!(refused(&here, &["paper", "coorg-teller-nodes", "--set", "occluder=3"], 2).contains("occluders"));
    refused(&here, &["paper", "coorg-teller-nodes", "--scene", "missing.obj"], 1);
    refused(&here, &["paper", "coorg-teller-nodes", "--size", "0x3"], 2);
}

/// What is drawn as color cubes is compared with an image of many samples a pixel; without cubes nothing is.
#[test]
fn color_cubes_are_compared_with_the_reference() {
    let here = folder("cubes");
    let cull = |threshold: &str| {
        let set = format!("pixel-threshold={threshold}");
        let words = ["cull", "generate:tree?polygons=3000", "--method", "color-cubes", "--path", "distances"];
        json(&done(&here, &[&words[..], &["--size", "32x32", "--truth", "--set", &set]].concat()))
    };
    let (cubes, geometry) = (cull("4"), cull("0"));
    let frames = |report: &Json| report["frames"].as_array().expect("frames").clone();
    for frame in frames(&geometry) {
        assert!(frame["drawn_stand_ins"].is_null() && frame["truth"]["flip_reference"].is_null(), "{frame}");
        assert_eq!(frame["truth"]["wrong_pixels"], 0, "{frame}");
    }
    let frames = frames(&cubes);
    let with_cubes: Vec<_> = frames.iter().filter(|f| !f["drawn_stand_ins"].is_null()).collect();
    assert!(!with_cubes.is_empty(), "{cubes}");
    for frame in with_cubes {
        let mean = frame["truth"]["flip_reference"].as_f64().expect("a number");
        let seen = frame["truth"]["flip_reference_seen_ratio"].as_f64().expect("a number");
        assert!(mean > 0.0 && mean < 0.5 && seen <= 1.0, "{frame}");
    }
}

#[test]
fn occlusion_is_measured_on_an_input_that_others_read_too() {
    let folder = folder("bench");
    fs::write(folder.join("wall.obj"), "v -2 -2 -5\nv 2 -2 -5\nv 2 2 -5\nv -2 2 -5\nf 1 2 3 4\n")
        .expect("a written file");
    // Behind the wall, before it, behind the eye, beside the wall.
    let boxes = "-0.5 -0.5 -8 0.5 0.5 -7\n-0.5 -0.5 -4 0.5 0.5 -3\n0 0 3 1 1 4\n6 -0.5 -8 7 0.5 -7\n";
    fs::write(folder.join("boxes.txt"), boxes).expect("a written file");
    let camera = "1 0 0 0  0 1 0 0  0 0 -1 -0.2  0 0 -1 0  0.1  0 0 0\n";
    fs::write(folder.join("cams.txt"), camera).expect("a written file");
    let call =
        ["bench", "occlusion", "--mesh", "wall.obj", "--boxes", "boxes.txt", "--cams", "cams.txt", "--size"];
    for method in ["hierarchical-z", "occlusion-maps", "tiles"] {
        let more = ["64x64", "--method", method, "--repeat", "2", "--dump-vis", "vis"];
        let said = done(&folder, &[&call[..], &more].concat());
        assert!(
            said.starts_with("RESULT render_ms=")
                && said.contains(" pct_occluded_of_infrustum=33.333 false=0 hash="),
            "{method}: {said}"
        );
        assert_eq!(fs::read(folder.join("vis")).expect("a written file"), [1, 0, 3, 0], "{method}");
    }
    let set = ["64x64", "--method", "tiles", "--set", "coherence=true"];
    assert!(refused(&folder, &[&call[..], &set].concat(), 2).contains("tiles have no parameters"));
    let wide = refused(&folder, &[&call[..], &["64x32"]].concat(), 1);
    assert!(wide.contains("cams.txt line 1") && wide.contains("square"), "{wide}");
    fs::write(folder.join("cams.txt"), "1 2 3\n").expect("a written file");
    assert!(refused(&folder, &[&call[..], &["64x64"]].concat(), 1).contains("expected 20 finite numbers"));
    assert!(
        refused(&folder, &[&call[..], &["64x64", "--set", "coherenc=true"]].concat(), 2).contains("coherenc")
    );
}
