//! From the bytes of a file to its JSON and its binary chunk (glTF 2.0, section 4).

use std::borrow::Cow;

use super::file::{Gltf, Head};
use crate::scene::text::without_mark;
use crate::scene::{Report, SceneError, json};

/// JSON text and binary chunk.
type Chunks<'a> = (&'a [u8], Option<&'a [u8]>);

/// The JSON of the file, and its binary chunk if it is a GLB.
pub(super) fn open<'a>(
    bytes: &'a [u8],
    source: &str,
    report: &mut Report,
) -> Result<(Gltf, Option<&'a [u8]>), SceneError> {
    let format = |why: String| SceneError::Format { path: source.to_owned(), why };
    let (text, chunk) =
        if bytes.starts_with(b"glTF") { split(bytes).map_err(format)? } else { (bytes, None) };
    let text = without_mark(text).map_err(|why| format(why.into()))?;
    // Padding of the chunk, which some writers make of zeros.
    let text = &text[..text.iter().rposition(|b| *b != 0).map_or(0, |e| e + 1)];
    let utf8 = String::from_utf8_lossy(text);
    if matches!(utf8, Cow::Owned(_)) {
        report.note("its JSON is not UTF-8; names are shown as far as they can be");
    }
    let read: Result<Gltf, SceneError> = json::from_slice(utf8.as_bytes(), source);
    let version = match &read {
        Ok(gltf) => gltf.asset.version(),
        // Another version has other types, which is then the better reason.
        Err(_) => serde_json::from_str::<Head>(&utf8).map(|h| h.asset.version()).unwrap_or_default(),
    };
    let major = version.split('.').next().unwrap_or_default();
    if !matches!(major, "" | "2") {
        return Err(format(format!("glTF {version} is not supported, only 2")));
    }
    let gltf = read?;
    if major.is_empty() {
        return Err(format("it does not say which version of glTF it is (`asset.version`)".into()));
    }
    Ok((gltf, chunk))
}

/// JSON text and binary chunk of a GLB container.
fn split(bytes: &[u8]) -> Result<Chunks<'_>, String> {
    fn word(bytes: &[u8], at: usize) -> Option<u32> {
        bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err("the GLB header is cut off".into());
    };
    if version != 2 {
        return Err(format!("GLB version {version} is not supported, only 2"));
    }
    if length as usize > bytes.len() {
        return Err(format!("the GLB says it has {length} bytes, but the file has {}", bytes.len()));
    }
    let bytes = &bytes[..length as usize];
    let (mut text, mut blob, mut at) = (None, None, 12);
    while let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) {
        let Some(chunk) = bytes.get(at + 8..).and_then(|rest| rest.get(..size as usize)) else {
            return Err(format!(
                "the GLB chunk at byte {at} says it has {size} bytes, but the file ends before"
            ));
        };
        match &kind.to_le_bytes() {
            b"JSON" if text.is_none() => text = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            _ => {}
        }
        // Chunks end at a multiple of four bytes. Some writers forget to pad, others to count the padding.
        at += 8 + size as usize;
        if bytes.get(at + 4..at + 8) != Some(b"BIN\0") {
            at = at.next_multiple_of(4);
        }
    }
    text.map(|t| (t, blob)).ok_or_else(|| "the GLB has no JSON chunk".into())
}
