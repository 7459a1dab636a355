//! Sweeps: what comes out, from one run and from parts, and what an end before the end leaves.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, thread, time::Duration};

use super::{cullscope, done, folder, json, refused};
use cullscope::measure::sweep::results::TIMES;
use serde_json::Value as Json;

const SPEC: &str = r#"
frames = 3
repeats = 2
size = [64, 48]
scenes = ["boxes.obj", "walls.json"]
[[method]]
key = "z-buffer"
[[method]]
key = "frustum"
set.tree-height = [2, 4]
[[method]]
key = "hierarchical-z"
[[method]]
key = "layered-projection"
set = { tessellation = "octree", budget = ["10%", "60%"] }
[[method]]
key = "color-cubes"
set.pixel-threshold = 6
"#;
/// Configurations of it.
const COUNT: usize = 7;

fn spec(test: &str, more: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("small.toml"), SPEC.replacen("frames = 3", more, 1)).expect("a written spec");
    folder
}

/// The rows of a table of a sweep, by key.
fn rows(folder: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(folder.join(name)).expect("a table");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

/// A table without what differs from run to run.
fn counted(folder: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let mut rows = rows(folder, name);
    rows.iter_mut().for_each(|row| row.retain(|key, _| !TIMES.contains(&key.as_str())));
    rows
}

fn number(row: &BTreeMap<String, String>, key: &str) -> f64 {
    row[key].parse().unwrap_or_else(|_| panic!("{key}: {row:?}"))
}

/// What is charted is what `cull` says of the same views; what is right is said to be, and what is not.
#[test]
fn a_sweep_says_what_cull_says() {
    let folder = spec("sweep", "frames = 3");
    let said = done(&folder, &["sweep", "small.toml", "--out", "out"]);
    assert!(said.contains("layered-projection") && said.contains("budget=60%"), "{said}");
    let out = folder.join("out");
    let all = rows(&out, "configurations.csv");
    assert_eq!(all.len(), 2 * COUNT);
    let mut wrong = 0;
    for (at, row) in all.iter().enumerate() {
        assert_eq!(number(row, "number") as usize, at);
        assert!(number(row, "frame_ms") > 0.0 && number(row, "fastest_ms") <= number(row, "slowest_ms"));
        let is_exact = ["z-buffer", "frustum", "hierarchical-z"].contains(&row["method"].as_str());
        assert!(!is_exact || number(row, "wrong_pixels_percent") == 0.0, "{row:?}");
        wrong += usize::from(number(row, "wrong_pixels_percent") > 0.0);
    }
    assert!(wrong >= 2, "budgets and cubes are seen: {wrong}");
    assert!(all.iter().any(|row| row["on_front"] == "1"));
    // Any of its numbers, by a single call.
    let frames = rows(&out, "frames.csv");
    assert_eq!(frames.len(), 2 * COUNT * 3);
    for row in frames.iter().step_by(4) {
        let (scene, views) = match row["scene"].as_str() {
            "boxes" => ("boxes.obj", "out/views-0.json"),
            _ => ("walls.json", "out/views-1.json"),
        };
        let mut words = vec!["cull", scene, "--view", views, "--truth", "--method", &row["method"]];
        row["parameters"].split_whitespace().for_each(|pair| words.extend(["--set", pair]));
        let told = json(&done(&folder, &words));
        let frame = &told["frames"][number(row, "frame") as usize];
        for (key, of) in [
            ("drawn", &frame["drawn_triangles"]),
            ("visible", &frame["truth"]["visible_triangles"]),
            ("missed", &frame["truth"]["missed_triangles"]),
            ("wrong_pixels", &frame["truth"]["wrong_pixels"]),
        ] {
            assert_eq!(Some(number(row, key)), of.as_f64(), "{key} of {row:?}");
        }
        let flip = frame["truth"]["flip_mean"].as_f64().expect("a number");
        assert!((number(row, "flip_percent") - 100.0 * flip).abs() < 1e-9);
    }
    for name in ["chart.svg", "chart.pdf", "chart.png", "stages.csv", "counts.csv", "results.jsonl"] {
        assert!(fs::metadata(out.join(name)).expect(name).len() > 100, "{name}");
    }
    let page = fs::read_to_string(out.join("report.html")).expect("a report");
    assert!((0..2 * COUNT).all(|k| page.contains(&format!("data-tried=\"{k}\""))));
    assert!(page.contains("<tr data-number=\"13\">") && !page.contains("src=\"http"));
    let refusal = refused(&folder, &["sweep", "small.toml", "--out", "out"], 1);
    assert!(refusal.contains("out holds a sweep") && refusal.contains("--resume"), "{refusal}");
    // Nothing is left to do: the same comes out.
    done(&folder, &["sweep", "small.toml", "--out", "out", "--resume"]);
    assert_eq!(rows(&out, "frames.csv"), frames);
}

/// The lines of a result without its times.
fn lines(folder: &Path) -> Vec<Json> {
    let text = fs::read_to_string(folder.join("results.jsonl")).expect("a log");
    let plain = |line: &str| {
        let mut line = json(line);
        let object = line.as_object_mut().expect("an object");
        object.retain(|key, _| !key.ends_with("_ms") && key != "peak_bytes");
        line
    };
    text.lines().map(plain).collect()
}

/// Four parts as four programs, one of which is killed and goes on, give what one run gives.
#[test]
fn parts_give_what_one_run_gives() {
    let folder = spec("shards", "frames = 40");
    done(&folder, &["sweep", "small.toml", "--out", "whole"]);
    let program = |part: usize, more: &[&str]| {
        let (shard, out) = (format!("{part}/4"), format!("part-{part}"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_cullscope"));
        command.args(["sweep", "small.toml", "--shard", &shard, "--out", &out]).args(more);
        command.current_dir(&folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().expect("the program runs")
    };
    let mut killed = program(3, &[]);
    let log = folder.join("part-3/log.jsonl");
    let lines_of = || fs::read_to_string(&log).map_or(0, |text| text.lines().count());
    while lines_of() < 12 && killed.try_wait().expect("a child").is_none() {
        thread::sleep(Duration::from_millis(1));
    }
    // Whether it was in time does not matter to what must come out; that it mostly is, the lines show.
    let _ = killed.kill();
    let _ = killed.wait();
    let mut text = fs::read(&log).expect("a log");
    text.extend(b"{\"line\":\"judged\",\"sce");
    fs::write(&log, text).expect("a torn log");
    let incomplete = refused(&folder, &["sweep", "merge", "part-3", "nowhere", "--out", "merged"], 1);
    assert!(incomplete.contains("nowhere"), "{incomplete}");
    let mut children = [program(1, &[]), program(2, &[]), program(3, &["--resume"]), program(4, &[])];
    assert!(children.iter_mut().all(|child| child.wait().expect("a child").success()));
    done(&folder, &["sweep", "merge", "part-1", "part-2", "part-3", "part-4", "--out", "merged"]);
    let [whole, merged] = ["whole", "merged"].map(|name| folder.join(name));
    for name in ["configurations.csv", "frames.csv", "counts.csv"] {
        assert_eq!(counted(&whole, name), counted(&merged, name), "{name}");
    }
    assert_eq!(lines(&whole), lines(&merged));
    assert_eq!(rows(&merged, "frames.csv").len(), 2 * COUNT * 40);
}

/// A bad spec, a missing scene, a folder of another sweep, a full disk: one line, nothing lost.
#[test]
fn what_goes_wrong_is_said_in_a_line() {
    let folder = spec("sweep-errors", "frame = 3");
    let said = refused(&folder, &["sweep", "small.toml"], 1);
    assert!(
        said.contains("small.toml: line 2: `frame`") && said.contains("did you mean `frames`?"),
        "{said}"
    );
    let write = |text: &str| fs::write(folder.join("small.toml"), text).expect("a written spec");
    write(&SPEC.replace("hierarchical-z", "hierarchical-zz"));
    let said = refused(&folder, &["sweep", "small.toml"], 1);
    assert!(said.contains("line 11") && said.contains("did you mean `hierarchical-z`?"), "{said}");
    write(&SPEC.replace("walls.json", "wall.json"));
    let said = refused(&folder, &["sweep", "small.toml"], 1);
    assert!(said.contains("wall.json"), "{said}");
    assert!(!folder.join("small-sweep").exists(), "nothing is begun");
    write(&SPEC.replace("\"boxes.obj\"", "{ source = \"boxes.obj\", path = \"walk\" }"));
    let said = refused(&folder, &["sweep", "small.toml"], 1);
    assert!(said.contains("no path `walk`"), "{said}");
    assert!(refused(&folder, &["sweep", "small.toml", "--shard", "5/4"], 2).contains("2/4"));
    assert!(refused(&folder, &["sweep", "none.toml"], 1).contains("none.toml"));
    write(SPEC);
    // A file may have two blocks of 512 bytes here, as on a disk that is full.
    let full = "trap '' XFSZ; ulimit -f 2; exec \"$0\" sweep small.toml --out full";
    let output = Command::new("sh")
        .args(["-c", full, env!("CARGO_BIN_EXE_cullscope")])
        .current_dir(&folder)
        .output()
        .expect("a shell");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.starts_with("error: ") && said.contains("full/log.jsonl") && said.lines().count() == 1,
        "{said}"
    );
    done(&folder, &["sweep", "small.toml", "--out", "full", "--resume"]);
    assert_eq!(rows(&folder.join("full"), "configurations.csv").len(), 2 * COUNT);
    write(&SPEC.replace("repeats = 2", "repeats = 1"));
    let said = refused(&folder, &["sweep", "small.toml", "--out", "full", "--resume"], 1);
    assert!(said.contains("of another spec"), "{said}");
}

/// Advice on the small scene: it says what to use, checks it, and repeats.
#[test]
fn advice_is_right_and_repeats() {
    let folder = folder("advise");
    let call = ["advise", "boxes.obj", "--random-views", "12", "--size", "64x48", "--out", "a.json"];
    let said = done(&folder, &[&call[..], &["--chart", "a.svg"]].concat());
    assert!(said.starts_with("Use --method "), "{said}");
    let advice = json(&fs::read_to_string(folder.join("a.json")).expect("an advice"));
    assert_eq!(advice["unseen"]["wrong_pixels_percent"], 0.0);
    assert_eq!(advice["unseen"]["frames"], 5);
    assert!(advice["frames_flown"].as_u64() < advice["frames_of_the_grid"].as_u64());
    let tried = advice["tried"].as_array().expect("a list");
    // How many are tried depends on what their indexes cost.
    assert!(tried.len() > 3 && tried[0]["verdict"] == "advised");
    assert!(said.contains("which promise nothing"), "{said}");
    let roughly = done(&folder, &[&call[..], &["--max-wrong-pixels", "0.01"]].concat());
    assert!(!roughly.contains("which promise nothing"), "{roughly}");
    let advice = json(&fs::read_to_string(folder.join("a.json")).expect("an advice"));
    let tried = advice["tried"].as_array().expect("a list");
    assert!(tried.iter().any(|t| t["verdict"] == "not right enough"));
    assert!(fs::metadata(folder.join("a.svg")).expect("a chart").len() > 1000);
    let said = refused(&folder, &["advise", "boxes.obj", "--max-wrong-pixels", "101"], 2);
    assert!(said.contains("from 0 to 100"), "{said}");
    let said = refused(&folder, &["advise", "boxes.obj", "--chart", "a.gif"], 2);
    assert!(said.contains("svg, pdf or png"), "{said}");
    let flat = cullscope(&folder, &["advise", "walls.json", "--size", "64"]);
    assert!(flat.status.success(), "{}", String::from_utf8_lossy(&flat.stderr));
}
