//! The text of a PDF file, read as a PDF reader does: content streams, fonts and their maps to Unicode.
//!
//! Enough for the files that this program writes; no general PDF reader.

use std::collections::BTreeMap;
use std::io::Read;

/// The strings that a PDF file shows, in the order in which it shows them.
pub fn text_of(pdf: &[u8]) -> Vec<String> {
    let objects = objects(pdf);
    let plain: String = objects.values().map(|(dictionary, _)| dictionary.as_str()).collect();
    let content = objects
        .values()
        .filter_map(|(_, stream)| stream.as_deref())
        .find(|s| find(s, b" Tf").is_some() && find(s, b"Tj").is_some());
    let content = content.expect("a content stream with text");
    let mut shown = Vec::new();
    let mut map = BTreeMap::new();
    let mut i = 0;
    while i < content.len() {
        if content[i] == b'/' && content[i + 1] == b'f' {
            let name: String = content[i + 1..]
                .iter()
                .take_while(|c| c.is_ascii_alphanumeric())
                .map(|c| *c as char)
                .collect();
            let font = number_after(&plain, &format!("/{name} "))
                .and_then(|id| objects.get(&id))
                .expect("the font of a text");
            let id = number_after(&font.0, "/ToUnicode ").expect("a map to Unicode");
            map = unicode_map(&String::from_utf8_lossy(objects[&id].1.as_deref().expect("a stream")));
            i += name.len();
        } else if content[i] == b'(' {
            let (codes, end) = string(content, i + 1);
            shown.push(
                codes
                    .chunks_exact(2)
                    .map(|c| map.get(&u32::from(u16::from_be_bytes([c[0], c[1]]))).copied().unwrap_or('?'))
                    .collect(),
            );
            i = end;
        } else if content[i] == b'<' {
            let hex: String =
                content[i + 1..].iter().take_while(|c| **c != b'>').map(|c| *c as char).collect();
            let code = |k| u32::from_str_radix(&hex[k..k + 4], 16).expect("hexadecimal");
            shown
                .push((0..hex.len()).step_by(4).map(|k| map.get(&code(k)).copied().unwrap_or('?')).collect());
            i += hex.len();
        }
        i += 1;
    }
    shown
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|w| w == what)
}

fn number_after(text: &str, key: &str) -> Option<u32> {
    let rest = text.split_once(key)?.1.trim_start();
    rest.chars().take_while(char::is_ascii_digit).collect::<String>().parse().ok()
}

/// Dictionary and unpacked stream of each object.
fn objects(pdf: &[u8]) -> BTreeMap<u32, (String, Option<Vec<u8>>)> {
    let mut objects = BTreeMap::new();
    let mut from = 0;
    while let Some(at) = find(&pdf[from..], b" 0 obj").map(|i| i + from) {
        let begin = pdf[..at].iter().rposition(|c| !c.is_ascii_digit()).map_or(0, |i| i + 1);
        let id = std::str::from_utf8(&pdf[begin..at])
            .ok()
            .and_then(|s| s.parse().ok())
            .expect("the number of an object");
        let end = at + find(&pdf[at..], b"endobj").expect("the end of an object");
        let body = &pdf[at + 6..end];
        let stream = find(body, b"stream").filter(|_| find(body, b"endstream").is_some());
        let dictionary = String::from_utf8_lossy(&body[..stream.unwrap_or(body.len())]).into_owned();
        let data = stream.map(|s| {
            let data = &body[s + 6..];
            let data = &data[data.iter().take_while(|c| matches!(c, b'\r' | b'\n')).count()..];
            let mut plain = Vec::new();
            match flate2::read::ZlibDecoder::new(data).read_to_end(&mut plain) {
                Ok(_) => plain,
                Err(_) => data.to_vec(),
            }
        });
        objects.insert(id, (dictionary, data));
        from = end;
    }
    objects
}

/// The lines `<code> <unicode>` of a character map.
fn unicode_map(cmap: &str) -> BTreeMap<u32, char> {
    let pair = |line: &str| {
        let mut hex = line.split(['<', '>']).filter(|s| !s.trim().is_empty());
        let code = u32::from_str_radix(hex.next()?, 16).ok()?;
        Some((code, char::from_u32(u32::from_str_radix(hex.next()?, 16).ok()?)?))
    };
    let lines = cmap.lines().skip_while(|l| !l.ends_with("beginbfchar"));
    lines.filter(|l| l.starts_with('<')).filter_map(pair).collect()
}

/// A literal string with its escapes, and where it ends.
fn string(content: &[u8], mut i: usize) -> (Vec<u8>, usize) {
    let (mut out, mut depth) = (Vec::new(), 1);
    while i < content.len() {
        match content[i] {
            b'\\' => {
                i += 1;
                let octal = content[i..].iter().take(3).take_while(|c| (b'0'..=b'7').contains(c)).count();
                if octal > 0 {
                    out.push(
                        content[i..i + octal].iter().fold(0u32, |n, c| n * 8 + u32::from(c - b'0')) as u8
                    );
                    i += octal - 1;
                } else {
                    out.push(match content[i] {
                        b'n' => b'\n',
                        b'r' => b'\r',
                        b't' => b'\t',
                        b'b' => 8,
                        b'f' => 12,
                        c => c,
                    });
                }
            }
            b')' if depth == 1 => return (out, i),
            c => {
                depth += i32::from(c == b'(') - i32::from(c == b')');
                out.push(c);
            }
        }
        i += 1;
    }
    (out, i)
}
