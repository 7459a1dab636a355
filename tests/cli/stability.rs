//! The real program looking for popping.

use std::fs;

use super::{cullscope, done, folder, refused, shipped};

const SLOTS: &str = "generate:failure?case=pixel-holes&dimensions=2";

/// The text of a cell of a CSV file without quotes, by row and key.
fn cell(csv: &str, row: usize, key: &str) -> String {
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let at = lines[0].iter().position(|k| *k == key).unwrap_or_else(|| panic!("no column {key}"));
    lines[row + 1][at].to_owned()
}

#[test]
fn a_method_that_draws_all_is_stable() {
    let here = folder("stable");
    let text = done(&here, &["stability", SLOTS, "--grid", "3", "--out", "found"]);
    assert!(!text.contains("flips"), "only methods that leave out what is visible pop: {text}");
    let path = fs::read_to_string(here.join("found/path.csv")).expect("a table");
    let grid = fs::read_to_string(here.join("found/grid.csv")).expect("a table");
    let methods = path.lines().filter(|line| line.contains(",0,")).count();
    assert!(methods > 0 && path.lines().count() % 2 == 1, "two views a method: {path}");
    assert_eq!(grid.lines().count() - 1, 9 * (path.lines().count() - 1) / 2, "nine places a method");
    assert!(here.join("found/pixel-holes-z-buffer.svg").exists());
    // Before the first view is none.
    assert_eq!((cell(&path, 0, "popped"), cell(&path, 1, "popped")), (String::new(), "0".into()));
    for row in 0..9 {
        let keys = ["missed", "wrong_pixels", "popped", "popped_pixels"];
        assert_eq!(keys.map(|key| cell(&grid, row, key)), ["0"; 4], "the z-buffer, place {row}");
    }
}

/// Decisions are made again by the checker, and near ones counted.
#[test]
fn decisions_are_made_again() {
    let here = folder("prove");
    let call = ["stability", SLOTS, "--method", "hierarchical-z", "--grid", "0", "--prove", "4"];
    let text = done(&here, &call);
    assert!(text.contains("claims of 2 frames made again and accepted"), "{text}");
    assert!(text.contains("within 4 ulp of flipping") && !text.contains("not accepted"), "{text}");
}

#[test]
fn a_flip_is_narrowed_to_the_test_that_decides() {
    let here = folder("flip");
    let rooms = shipped("scenes2d/rooms.json");
    let call = ["stability", &rooms, "--method", "centroid", "--grid", "0"];
    let text = done(&here, &call);
    let head = text.lines().find(|l| l.contains("between views 1 and 2: segment")).expect("a flip");
    // As near together as was asked for.
    let after = |word: &str| {
        let rest = head.split_once(word).unwrap_or_else(|| panic!("no `{word}`: {head}")).1;
        let number: String = rest.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
        number.parse::<f64>().unwrap_or_else(|e| panic!("{e}: {head}"))
    };
    let (apart, asked) = (after("within "), after("asked: "));
    assert!(0.0 < apart && apart <= asked && asked < 1e-4, "{head}");
    let line = |word: &str| {
        let found = text.lines().find(|line| line.trim_start().starts_with(word));
        found.unwrap_or_else(|| panic!("no line `{word}`: {text}"))
    };
    assert!(line("drawn").contains("visible at step"), "{text}");
    let left_out = line("left out");
    assert!(left_out.contains("over-budget at step") && left_out.contains("Compared: rank "), "{text}");
    assert_eq!(text, done(&here, &call), "it repeats");
}

#[test]
fn stability_refuses_in_one_line() {
    let here = folder("unstable");
    let clock = ["stability", SLOTS, "--method", "layered-projection", "--set", "budget=5ms"];
    assert!(refused(&here, &clock, 2).contains("differs from run to run"));
    assert!(refused(&here, &["stability", SLOTS, "--method", "centroit"], 2).contains("`centroid`"));
    assert!(refused(&here, &["stability"], 2).contains("SCENE"));
    let wrong = refused(&here, &["stability", "generate:failure?case=pixel-hole"], 2);
    assert!(wrong.contains("did you mean `pixel-holes`?"), "{wrong}");
    let taken = ["stability", SLOTS, "--method", "z-buffer", "--grid", "0", "--out", "walls.json"];
    let output = cullscope(&here, &taken);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: walls.json: "), "{output:?}");
}
