//! Source text apart from its comments and its strings.

/// What a character of a source file belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Code,
    Comment,
    /// A string or a character, with its quotes.
    Literal,
}

/// The code of a file with its strings: comments blanked, unit tests at its end cut off.
pub fn code(text: &str) -> String {
    keep(before_tests(text), |part| part != Part::Comment)
}

/// The code of a file without its strings, for whoever counts braces or follows paths.
pub fn bare(text: &str) -> String {
    keep(before_tests(text), |part| part == Part::Code)
}

/// Every string of a file's code with its line, counted from 1, as it is written and without quotes.
pub fn strings(text: &str) -> Vec<(usize, String)> {
    let text = before_tests(text);
    let (mut found, mut line) = (Vec::new(), 1);
    let mut open: Option<(usize, String)> = None;
    for (c, part) in text.chars().zip(parts(text)) {
        if part == Part::Literal {
            open.get_or_insert_with(|| (line, String::new())).1.push(c);
        } else {
            found.extend(open.take());
        }
        line += usize::from(c == '\n');
    }
    found.extend(open);
    let inside =
        |s: &str| s.trim_start_matches(['b', 'r', '#']).trim_end_matches('#').trim_matches('"').to_owned();
    found.into_iter().map(|(line, s)| (line, inside(&s))).collect()
}

fn before_tests(text: &str) -> &str {
    text.find("#[cfg(test)]\nmod tests {").map_or(text, |at| &text[..at])
}

/// The text with blanks in place of what is not kept; lines stay where they are.
fn keep(text: &str, kept: impl Fn(Part) -> bool) -> String {
    let blanked = |(c, part)| if c == '\n' || kept(part) { c } else { ' ' };
    text.chars().zip(parts(text)).map(blanked).collect()
}

/// The part that each character belongs to.
fn parts(text: &str) -> Vec<Part> {
    let chars: Vec<char> = text.chars().collect();
    let mut parts = Vec::with_capacity(chars.len());
    let mut i = 0;
    while i < chars.len() {
        let is_word_before = i > 0 && (chars[i - 1].is_alphanumeric() || chars[i - 1] == '_');
        let (part, end) = if chars[i..].starts_with(&['/', '/']) {
            (Part::Comment, i + chars[i..].iter().take_while(|c| **c != '\n').count())
        } else if chars[i..].starts_with(&['/', '*']) {
            (Part::Comment, block_comment_end(&chars, i))
        } else if let Some(end) = (!is_word_before).then(|| string_end(&chars, i)).flatten() {
            (Part::Literal, end)
        } else {
            (Part::Code, i + 1)
        };
        parts.resize(end, part);
        i = end;
    }
    parts
}

/// Block comments nest.
fn block_comment_end(chars: &[char], from: usize) -> usize {
    let (mut depth, mut i) = (0, from);
    while i < chars.len() {
        if chars[i..].starts_with(&['/', '*']) {
            (depth, i) = (depth + 1, i + 2);
        } else if chars[i..].starts_with(&['*', '/']) {
            (depth, i) = (depth - 1, i + 2);
            if depth == 0 {
                return i;
            }
        } else {
            i += 1;
        }
    }
    i
}

/// The end of the string or character that begins here; `None` if none does.
fn string_end(chars: &[char], from: usize) -> Option<usize> {
    let mut i = from;
    i += usize::from(chars[i] == 'b' || chars[i] == 'c');
    let raw = chars.get(i) == Some(&'r');
    i += usize::from(raw);
    let hashes = chars.get(i..)?.iter().take_while(|c| raw && **c == '#').count();
    i += hashes;
    let quote = *chars.get(i)?;
    if quote == '\'' && !raw {
        // A lifetime has no second quote behind one character.
        let is_char = chars.get(i + 1) == Some(&'\\') || chars.get(i + 2) == Some(&'\'');
        if !is_char {
            return None;
        }
    } else if quote != '"' {
        return None;
    }
    i += 1;
    while i < chars.len() {
        if chars[i] == '\\' && !raw {
            i += 2;
        } else if chars[i] == quote && chars[i + 1..].iter().take_while(|c| **c == '#').count() >= hashes {
            return Some(i + 1 + hashes);
        } else {
            i += 1;
        }
    }
    Some(chars.len())
}

/// A function's place: its first line and the one behind its last, counted from 0, and its name.
pub struct Function {
    pub from: usize,
    pub to: usize,
    pub name: String,
}

/// Every function with a body in text that has neither comments nor strings, nested ones too.
pub fn functions(bare: &str) -> Vec<Function> {
    let bytes = bare.as_bytes();
    let line = |at: usize| bare[..at].matches('\n').count();
    let mut found = Vec::new();
    for (at, _) in bare.match_indices("fn ") {
        let is_word = at == 0 || !(bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
        let name: String = bare[at + 3..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        // A type such as `fn (u32)` has no name.
        if !is_word || name.is_empty() {
            continue;
        }
        // Past arrays in the signature, such as `[u8; 4]`.
        let mut depth = 0;
        let body = bare[at..].char_indices().find(|(_, c)| {
            depth += i32::from("([".contains(*c)) - i32::from(")]".contains(*c));
            depth == 0 && (*c == '{' || *c == ';')
        });
        let Some((open, '{')) = body else { continue };
        let mut depth = 0;
        let close = bare[at + open..].char_indices().find(|(_, c)| {
            depth += i32::from(*c == '{') - i32::from(*c == '}');
            depth == 0
        });
        let Some((length, _)) = close else { continue };
        found.push(Function { from: line(at), to: line(at + open + length), name });
    }
    found
}

#[test]
fn comments_and_strings_are_told_apart() {
    let text = "let a = \"http://x\"; // \"no\" string\nlet b = r#\"a \"// b\"#; /* c /* d */ e */ let c = \
                '\"'; f::<'a>(b'/');\n#[cfg(test)]\nmod tests { cut }";
    assert_eq!(
        code(text).lines().map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>(),
        ["let a = \"http://x\";", "let b = r#\"a \"// b\"#; let c = '\"'; f::<'a>(b'/');"]
    );
    assert_eq!(bare(text).split_whitespace().collect::<String>(), "leta=;letb=;letc=;f::<'a>();");
    let words: Vec<_> = strings(text).into_iter().map(|(line, s)| format!("{line} {s}")).collect();
    assert_eq!(words[..2], ["1 http://x", "2 a \"// b"]);
}

#[test]
fn every_form_of_function_is_found() {
    let text = concat!(
        "pub(in crate::a) async fn one<const N: usize>(x: [u8; 4]) -> [u8; N]\nwhere\n    u8: Copy,\n{\n",
        "    fn two() {}\n}\nconst unsafe fn three() { { } }\n",
        "trait T { fn none(&self); }\nlet f: fn (u32) = g;"
    );
    let found: Vec<_> =
        functions(&bare(text)).iter().map(|f| format!("{} {}-{}", f.name, f.from, f.to)).collect();
    assert_eq!(found, ["one 0-5", "two 4-4", "three 6-6"]);
}
