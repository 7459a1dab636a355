//! The import graph of the source files, and its circles.
//!
//! A file names another one in a `use` or in a path that begins with `crate`, `super`, `self`, a module below
//! it or a module that it imports. A name that a file only hands on counts for the file that defines it. What
//! a file takes from a `mod.rs` above it does not count: a folder may share what its rooms have in common.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::source::bare;

/// Segments of a path below `crate`.
type Name = Vec<String>;

/// A source file.
struct File {
    path: PathBuf,
    bare: String,
    /// What its names stand for, and the modules of which it takes every name.
    imports: BTreeMap<String, Name>,
    globs: Vec<Name>,
}

/// The source files by their module.
pub struct Imports(BTreeMap<Name, File>);

impl Imports {
    /// The imports of files, which are named by their path from the root: `src/room/file.rs`.
    pub fn of(files: &[(PathBuf, String)]) -> Self {
        let is_test = |path: &Path| {
            let names: Vec<_> = path.iter().filter_map(|n| n.to_str()).collect();
            names.contains(&"tests") || names.last().is_some_and(|n| n.ends_with("tests.rs"))
        };
        let file = |path: &Path, text: &str| File {
            path: path.to_owned(),
            bare: bare(text),
            imports: BTreeMap::new(),
            globs: Vec::new(),
        };
        let files = files.iter().filter(|(path, _)| !is_test(path));
        let mut all = Self(files.map(|(path, text)| (module(path), file(path, text))).collect());
        for module in all.0.keys().cloned().collect::<Vec<_>>() {
            let paths = paths(&all.0[&module].bare);
            // Twice, since a name may be imported below its first use.
            for path in paths.iter().chain(&paths).filter(|p| p.is_use) {
                let Some(target) = all.absolute(&module, &path.segments) else { continue };
                let file = all.0.get_mut(&module).expect("a file of the list");
                match &path.alias {
                    Some(alias) => _ = file.imports.insert(alias.clone(), target),
                    None if !file.globs.contains(&target) => file.globs.push(target),
                    None => {}
                }
            }
        }
        all
    }

    /// A path of a file below `crate`; `None` if it is another crate's, or not known to lead anywhere.
    fn absolute(&self, from: &Name, segments: &[String]) -> Option<Name> {
        let mut base = from.clone();
        let (first, rest) = segments.split_first()?;
        match first.as_str() {
            "crate" => base.clear(),
            "self" => {}
            "super" => _ = base.pop()?,
            name => {
                base.push(name.to_owned());
                if !self.0.contains_key(&base) {
                    base = self.0[from].imports.get(name)?.clone();
                }
            }
        }
        let ups = rest.iter().take_while(|s| *s == "super").count();
        base.truncate(base.len().checked_sub(ups)?);
        base.extend_from_slice(&rest[ups..]);
        Some(base)
    }

    /// The longest beginning of a path that is a module, and the rest.
    fn split<'a>(&self, path: &'a Name) -> Option<(&'a [String], &'a [String])> {
        let known = (0..=path.len()).rev().find(|n| self.0.contains_key(&path[..*n]))?;
        Some(path.split_at(known))
    }

    /// The module whose file defines what a path names, and the name.
    fn resolve(&self, path: &Name, depth: usize) -> Option<(Name, String)> {
        let (module, rest) = self.split(path)?;
        let Some(name) = rest.first().filter(|_| depth < 8) else {
            return Some((module.to_vec(), path.last().cloned().unwrap_or_default()));
        };
        let file = &self.0[module];
        let defines = |file: &File| {
            let kinds = ["fn", "struct", "enum", "const", "static", "trait", "type", "union", "macro_rules!"];
            let words = file.bare.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '!'));
            let words: Vec<&str> = words.filter(|w| !w.is_empty()).collect();
            words.windows(2).any(|w| kinds.contains(&w[0]) && w[1] == name)
        };
        let through = |target: &Name, rest: &[String]| {
            self.resolve(&target.iter().chain(rest).cloned().collect(), depth + 1)
        };
        if let Some(target) = file.imports.get(name).filter(|target| *target != path) {
            return through(target, &rest[1..]);
        }
        let glob = file.globs.iter().find(|g| self.0.get(*g).is_some_and(defines));
        glob.map_or_else(|| Some((module.to_vec(), name.clone())), |g| through(g, rest))
    }

    /// The files that each file names, with the names.
    fn arrows(&self) -> BTreeMap<&Name, BTreeMap<Name, BTreeSet<String>>> {
        let mut arrows = BTreeMap::new();
        for (module, file) in &self.0 {
            let to: &mut BTreeMap<Name, BTreeSet<String>> = arrows.entry(module).or_default();
            for path in paths(&file.bare) {
                let target = self.absolute(module, &path.segments);
                // Neither the file itself nor a folder around it.
                let beside = target.filter(|t| self.split(t).is_some_and(|(m, _)| !module.starts_with(m)));
                if let Some((there, name)) = beside.and_then(|t| self.resolve(&t, 0))
                    && !module.starts_with(&there)
                {
                    to.entry(there).or_default().insert(name);
                }
            }
        }
        arrows
    }

    /// Files that name each other, a group a line, with the arrows between them.
    pub fn circles(&self) -> Vec<String> {
        let arrows = self.arrows();
        let reach = |from: &Name| {
            let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(next) = open.pop() {
                for there in arrows[&next].keys() {
                    if seen.insert(there.clone()) {
                        open.push(there.clone());
                    }
                }
            }
            seen
        };
        let reached: BTreeMap<&Name, BTreeSet<Name>> = self.0.keys().map(|m| (m, reach(m))).collect();
        let mut circles = BTreeMap::new();
        for (module, there) in reached.iter().filter(|(module, there)| there.contains(**module)) {
            let circle: Vec<&Name> = there.iter().filter(|m| reached[*m].contains(*module)).collect();
            circles.insert(circle[0].clone(), circle);
        }
        let of = |circle: &Vec<&Name>| {
            let mut text = format!("a circle of {} files:", circle.len());
            for (from, to) in circle.iter().flat_map(|a| circle.iter().map(move |b| (*a, *b))) {
                if let Some(names) = arrows[from].get(to) {
                    let names = names.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
                    let [from, to] = [from, to].map(|m| self.0[m].path.display());
                    text += &format!("\n  {from} -> {to}: {names}");
                }
            }
            text
        };
        circles.values().map(of).collect()
    }
}

/// The module of a file.
fn module(path: &Path) -> Name {
    let mut names: Name = path
        .iter()
        .skip(1)
        .filter_map(|n| n.to_str())
        .map(|n| n.trim_end_matches(".rs").to_owned())
        .collect();
    if names.last().is_some_and(|n| n == "mod" || n == "lib") {
        names.pop();
    }
    names
}

/// A path in code; `alias` is the name that it gets in a `use`, `None` for all names of it.
struct Mention {
    segments: Name,
    is_use: bool,
    alias: Option<String>,
}

/// Every path of two segments or more in code, and every path of a `use`.
fn paths(bare: &str) -> Vec<Mention> {
    let tokens = tokens(bare);
    let (mut found, mut i) = (Vec::new(), 0);
    while i < tokens.len() {
        if tokens[i] == "use" && tokens.get(i + 1).is_some_and(|t| *t != "<") {
            i = tree(&tokens, i + 1, &mut Vec::new(), true, &mut found);
        } else if is_word(tokens[i]) && tokens.get(i + 1) == Some(&"::") {
            i = tree(&tokens, i, &mut Vec::new(), false, &mut found);
        } else {
            i += 1;
        }
    }
    found
}

/// Reads one tree of paths below `base`, and returns the place behind it.
fn tree(tokens: &[&str], from: usize, base: &mut Name, is_use: bool, found: &mut Vec<Mention>) -> usize {
    let (mut i, depth) = (from, base.len());
    loop {
        match tokens.get(i) {
            Some(&"{") => {
                i += 1;
                while tokens.get(i).is_some_and(|t| *t != "}") {
                    let next = tree(tokens, i, base, is_use, found);
                    i = if tokens.get(next) == Some(&",") { next + 1 } else { next.max(i + 1) };
                }
                i += 1;
                break;
            }
            Some(&"*") => {
                found.push(Mention { segments: base.clone(), is_use, alias: None });
                i += 1;
                break;
            }
            Some(word) if is_word(word) => {
                base.push((*word).to_owned());
                i += 1;
                let goes_on = |t: &&str| is_word(t) || (is_use && ["{", "*"].contains(t));
                if tokens.get(i) == Some(&"::") && tokens.get(i + 1).is_some_and(goes_on) {
                    i += 1;
                    continue;
                }
                let mut alias = base.last().cloned();
                // `{self}` stands for what is before the brace.
                if base.len() > 1 && alias.as_deref() == Some("self") {
                    base.pop();
                    alias = base.last().cloned();
                }
                if is_use && tokens.get(i) == Some(&"as") {
                    alias = tokens.get(i + 1).map(|t| (*t).to_owned());
                    i += 2;
                }
                found.push(Mention { segments: base.clone(), is_use, alias });
                break;
            }
            _ => {
                i += 1;
                break;
            }
        }
    }
    base.truncate(depth);
    i
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Words, `::`, and every other mark by itself.
fn tokens(bare: &str) -> Vec<&str> {
    let (mut found, mut rest) = (Vec::new(), bare.trim_start());
    while let Some(c) = rest.chars().next() {
        let word = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let length = if rest.starts_with("::") { 2 } else { word.max(c.len_utf8()) };
        found.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    found
}

#[test]
fn a_planted_circle_is_found() {
    let made_up = |second: &str| {
        let files = [
            ("src/lib.rs", "pub mod room;"),
            ("src/room/mod.rs", "mod a; mod b; mod c; pub use b::Handed; pub struct Own;"),
            (
                "src/room/a.rs",
                "use super::{Own, Handed, b::*}; // use super::c::Comment;\nfn f() { \"super::c::Text\"; }",
            ),
            ("src/room/b.rs", second),
            (
                "src/room/c/mod.rs",
                "mod deep; use self::deep::Deep; use crate::room::a as first; fn g() { first::f() }",
            ),
            (
                "src/room/c/deep.rs",
                "pub struct Deep; use super::super::Own;\n#[cfg(test)]\nmod tests { use crate::room::b::B; }",
            ),
        ];
        Imports::of(&files.map(|(path, text)| (PathBuf::from(path), text.to_owned()))).circles()
    };
    assert_eq!(made_up("pub struct Handed; use super::Own;"), [""; 0]);
    let circle = "a circle of 3 files:\n  \
                  src/room/a.rs -> src/room/b.rs: b\n  src/room/b.rs -> src/room/c/mod.rs: g\n  \
                  src/room/c/mod.rs -> src/room/a.rs: a, f";
    assert_eq!(made_up("pub struct Handed; fn h() { super::c::g::<u8>() }"), [circle]);
    // What a folder holds counts for the folder's own imports, not for those above it.
    let deep = made_up("pub struct Handed; pub use crate::room::{c::{self, deep::{Deep as D}}, Own};");
    assert_eq!(deep.len(), 1);
    assert!(
        deep[0].contains("src/room/b.rs -> src/room/c/mod.rs") && !deep[0].contains("deep.rs ->"),
        "{deep:?}"
    );
}
