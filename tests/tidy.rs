//! The walls of the house, checked: who may use whom, words that belong to one room, the shape of files.

mod tidy {
    pub mod circles;
    pub mod source;
}

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use cullscope::culling::Methods;
use cullscope::geometry::{Flat, Solid};
use tidy::circles::Imports;
use tidy::source::{bare, code, functions, strings};

/// Rooms with their ranks. A room uses rooms of smaller rank and itself, never a peer.
const ROOMS: &[(&str, u8)] = &[
    ("geometry", 0),
    ("scene", 1),
    ("drawing", 2),
    ("raster", 2),
    ("index", 3),
    ("method", 4),
    ("culling", 5),
    ("trace", 5),
    ("truth", 5),
    ("figure", 6),
    ("measure", 6),
    ("papers", 7),
    ("render", 7),
    ("app", 8),
    ("views", 9),
    ("cli", 9),
    ("lib", 10),
    ("main", 11),
];

/// `cli` opens the explorer, which is its only use of a peer.
const PEERS: &[(&str, &str)] = &[("cli", "views")];

/// Words that belong to certain rooms only, with the reason.
const WORDS: &[(&str, &[&str], &str)] = &[
    ("egui", &["views", "render"], "core rooms know no GUI"),
    ("wgpu", &["views", "render"], "core rooms know no GPU"),
    ("Instant", &["measure", "views"], "a kernel that reads the clock is not reproducible"),
    ("std::fs", &["scene", "cli", "app"], "only the doors touch the disk"),
    ("File::", &["scene", "cli", "app"], "only the doors touch the disk"),
    ("Color32::from_rgb", &["render"], "colors live in the theme"),
    ("thread::", &["app", "views", "cli", "measure"], "core rooms also build where there are no threads"),
];

/// What of `culling` methods share: folders that are no methods.
const SHARED: &[&str] = &["depth"];

/// Lines of code that a function may have, so that it fits on a screen.
const FUNCTION_LINES: usize = 90;
/// Characters of code that a function may have, without indentation, so that it does not fit by wide lines.
const FUNCTION_CHARS: usize = 2000;
/// Characters that a line may have.
const LINE_CHARS: usize = 110;
/// Lines that a file may have.
const FILE_LINES: usize = 900;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn walk(dir: &Path, into: &mut Vec<(PathBuf, String)>) {
    for entry in fs::read_dir(dir).expect("a readable folder").map(|e| e.expect("an entry")) {
        let path = entry.path();
        if path.is_dir() {
            walk(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).expect("a readable file");
            into.push((path.strip_prefix(root()).expect("below the root").to_owned(), text));
        }
    }
}

/// Path and text of every source file below `folder`, in order.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut all = Vec::new();
    walk(&root().join(folder), &mut all);
    all.sort();
    assert!(!all.is_empty(), "no source files in {folder}");
    all
}

fn room(path: &Path) -> String {
    let name = path.iter().nth(1).and_then(|n| n.to_str()).expect("a path in src");
    name.trim_end_matches(".rs").to_owned()
}

fn rank(room: &str) -> u8 {
    let found = ROOMS.iter().find(|(name, _)| *name == room);
    found
        .unwrap_or_else(|| {
            panic!("src/{room} is no room: give it a rank in tests/tidy.rs and a line in ARCHITECTURE.md")
        })
        .1
}

/// Every room named after `crate::`, with its line, also inside `use crate::{a::…, b::…}`.
fn rooms_used(text: &str) -> Vec<(usize, String)> {
    let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut used = Vec::new();
    for (at, _) in text.match_indices("crate::") {
        let line = text[..at].matches('\n').count() + 1;
        let rest = &text[at + 7..];
        if !rest.starts_with('{') {
            used.push((line, word(rest)));
            continue;
        }
        let mut depth = 0;
        for (i, c) in rest.char_indices() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if depth == 0 {
                break;
            }
            if depth == 1 && (c == '{' || c == ',') {
                used.push((line, word(rest[i + 1..].trim_start())));
            }
        }
    }
    used.retain(|(_, name)| ROOMS.iter().any(|(room, _)| room == name));
    used
}

fn report(wrong: &[String]) {
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn nobody_looks_uphill() {
    let mut wrong = Vec::new();
    // A room's own tests may ask the list of methods for one.
    for (path, text) in sources("src").into_iter().filter(|(path, _)| !path.ends_with("tests.rs")) {
        let here = room(&path);
        for (line, there) in rooms_used(&code(&text)) {
            let allowed = there == here
                || rank(&there) < rank(&here)
                || PEERS.contains(&(here.as_str(), there.as_str()));
            if !allowed {
                wrong.push(format!("{}:{line}: room `{here}` uses `{there}`", path.display()));
            }
        }
    }
    report(&wrong);
}

#[test]
fn the_uphill_test_sees_every_form_of_use() {
    let text = "use crate::views;\nuse crate::{app::State, cli::{a, b}, render};\nlet x = \
                crate::trace::Stamps::new();";
    let names: Vec<_> = rooms_used(text).into_iter().map(|(line, name)| format!("{line}{name}")).collect();
    assert_eq!(names, ["1views", "2app", "2cli", "2render", "3trace"]);
}

#[test]
fn words_stay_in_their_rooms() {
    let mut wrong = Vec::new();
    for (path, text) in sources("src") {
        for (i, line) in code(&text).lines().enumerate() {
            for (word, homes, why) in WORDS {
                if line.contains(word) && !homes.contains(&room(&path).as_str()) {
                    wrong.push(format!("{}:{}: `{word}`: {why}", path.display(), i + 1));
                }
            }
        }
    }
    report(&wrong);
}

#[test]
fn every_file_says_what_it_is_and_is_neither_long_nor_wide() {
    let mut wrong = Vec::new();
    for folder in ["src", "tests", "benches"] {
        for (path, text) in sources(folder) {
            if !text.starts_with("//! ") {
                wrong.push(format!("{}: no module comment", path.display()));
            }
            if text.lines().count() > FILE_LINES {
                wrong.push(format!("{}: over {FILE_LINES} lines", path.display()));
            }
            for (i, line) in text.lines().enumerate().filter(|(_, l)| l.chars().count() > LINE_CHARS) {
                wrong.push(format!("{}:{}: {} characters", path.display(), i + 1, line.chars().count()));
            }
        }
    }
    report(&wrong);
}

#[test]
fn functions_fit_on_a_screen() {
    let mut wrong = Vec::new();
    for (path, text) in sources("src") {
        let code = code(&text);
        let chars: Vec<usize> = code.lines().map(|l| l.trim().chars().count()).collect();
        for f in functions(&bare(&text)) {
            let (lines, chars) = (f.to - f.from, chars[f.from..f.to].iter().sum::<usize>());
            if lines > FUNCTION_LINES || chars > FUNCTION_CHARS {
                let place = format!("{}:{}", path.display(), f.from + 1);
                wrong.push(format!("{place}: {}: {lines} lines, {chars} characters", f.name));
            }
        }
    }
    report(&wrong);
}

#[test]
fn no_files_import_each_other() {
    report(&Imports::of(&sources("src")).circles());
}

/// Outside `culling` and `papers` a method is chosen by what its card says. Rooms below `method` know of
/// none, so a word is their own there.
#[test]
fn methods_are_named_where_they_are_at_home_only() {
    let flat = Flat::methods().iter().map(|m| m.card().key);
    let keys: BTreeSet<&str> = flat.chain(Solid::methods().iter().map(|m| m.card().key)).collect();
    let folders: Vec<String> = method_folders().iter().map(|m| format!("{m}::")).collect();
    let mut wrong = Vec::new();
    for (path, text) in sources("src") {
        let room = room(&path);
        if path.ends_with("tests.rs")
            || ["culling", "papers"].contains(&&*room)
            || rank(&room) < rank("method")
        {
            continue;
        }
        for (line, key) in strings(&text).iter().filter(|(_, s)| keys.contains(s.as_str())) {
            wrong.push(format!("{}:{line}: method `{key}`", path.display()));
        }
        for (i, line) in bare(&text).lines().enumerate() {
            for folder in folders.iter().filter(|f| line.contains(f.as_str())) {
                wrong.push(format!("{}:{}: `{folder}`", path.display(), i + 1));
            }
        }
    }
    report(&wrong);
}

/// The folders of `src/culling`.
fn method_folders() -> Vec<String> {
    fs::read_dir(root().join("src/culling"))
        .expect("src/culling")
        .map(|e| e.expect("an entry").path())
        .filter(|p| p.is_dir())
        .filter_map(|p| p.file_name().map(|n| n.to_string_lossy().into_owned()))
        .collect()
}

#[test]
fn methods_are_strangers_to_each_other() {
    let methods = method_folders();
    assert!(methods.contains(&"baseline".to_owned()));
    let mut wrong = Vec::new();
    for (path, text) in sources("src/culling") {
        let own = path.iter().nth(2).and_then(|n| n.to_str()).unwrap_or("").to_owned();
        // What methods share names none of them either.
        for other in
            methods.iter().filter(|m| methods.contains(&own) && **m != own && !SHARED.contains(&m.as_str()))
        {
            if code(&text).contains(&format!("{other}::")) {
                wrong.push(format!("{}: method `{own}` names `{other}`", path.display()));
            }
        }
    }
    report(&wrong);
}

#[test]
fn figures_know_no_clock_and_tables_draw_no_worlds() {
    let (mut wrong, mut parts) = (Vec::new(), Vec::new());
    for (path, text) in sources("src/papers") {
        // A paper's part: the folder or file in its folder.
        let part = path.iter().nth(3).and_then(|n| n.to_str()).unwrap_or("").trim_end_matches(".rs");
        let forbidden = match part {
            "figures" => "measure",
            "tables" => "figure",
            _ => continue,
        };
        let used = rooms_used(&code(&text)).into_iter().filter(|(_, room)| room == forbidden);
        wrong.extend(used.map(|(line, room)| format!("{}:{line}: {part} use `{room}`", path.display())));
        parts.push(forbidden);
    }
    assert!(parts.contains(&"measure") && parts.contains(&"figure"), "no paper has figures and tables");
    report(&wrong);
}

#[test]
fn nothing_is_left_undone() {
    // Spelled in halves so that this file does not find itself.
    let marks = [
        concat!("to", "do!("),
        concat!("unim", "plemented!("),
        concat!("FIX", "ME"),
        concat!("#[ign", "ore"),
    ];
    let mut wrong = Vec::new();
    for folder in ["src", "tests", "benches"] {
        for (path, text) in sources(folder) {
            for mark in marks.iter().filter(|m| text.contains(*m)) {
                wrong.push(format!("{}: `{mark}`", path.display()));
            }
        }
    }
    report(&wrong);
}

#[test]
fn the_map_names_every_room() {
    let map = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let missing: Vec<_> = ROOMS
        .iter()
        .filter(|(room, _)| !map.contains(&format!("`{room}`")) && !["lib", "main"].contains(room))
        .collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md does not name {missing:?}");
}

#[test]
fn the_checkout_is_small() {
    fn size(dir: &Path) -> u64 {
        let entries = fs::read_dir(dir).expect("a readable folder").map(|e| e.expect("an entry"));
        entries
            .filter(|e| !["target", ".git"].contains(&e.file_name().to_string_lossy().as_ref()))
            .map(|e| {
                let meta = e.path().symlink_metadata().expect("metadata");
                if meta.is_dir() { size(&e.path()) } else { meta.len() }
            })
            .sum()
    }
    let bytes = size(root());
    assert!(bytes < 40 << 20, "the checkout takes {bytes} bytes, over 40 MB");
}
