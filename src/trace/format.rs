//! The open trace format: a run as JSON Lines, for any program to write or read.
//!
//! Line 1 is the header, `{"trace":1,"scene":…,"method":…,"params":{…},"view":{…}}`; then one object an
//! event, `{"step":k,"frame":f,"event":"NodeClassified","line":"Visible:4",…}` with fields named by the
//! method. `step` k is the state after the first k events of its frame: it starts at 1 and ascends; steps may
//! be left out (a coarse trace leaves out the lines of pseudocode). `frame` never descends. `line` is the
//! line of pseudocode that was current. `trace.schema.json` beside this file describes each line; foreign
//! traces may use any method, events and fields. Numbers are the shortest decimals that read back as the same
//! 32-bit (else 64-bit) float, so equal runs give equal bytes; what is not finite is `null`. Cost: O(bytes),
//! one line in memory at a time.

use std::io::{self, BufRead, Read, Write};

use serde_json::{Map, Value as Json};

use super::Detail;
use crate::geometry::Space;
use crate::method::{Event, Field, Film, KnobValue, Value};

/// The version that this program writes and reads.
pub const VERSION: u64 = 1;
/// The schema of one line, as JSON Schema (draft 2020-12).
pub const SCHEMA: &str = include_str!("trace.schema.json");
/// Longest line that is read, bytes: longer ones are no events but mistakes.
const LINE_LIMIT_BYTES: usize = 16 << 20;

/// The first line of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Where the scene came from.
    pub scene: String,
    /// Key of the method.
    pub method: String,
    /// Parameters by name.
    pub params: Map<String, Json>,
    /// The view or path, as in a view file.
    pub view: Map<String, Json>,
    /// Whatever else the header says.
    pub more: Map<String, Json>,
}

/// One event of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// State after so many events of the frame.
    pub step: u64,
    /// Number of the frame, from 0.
    pub frame: u64,
    /// What happened, such as `NodeClassified`.
    pub event: String,
    /// Label of the current line of pseudocode.
    pub line: Option<String>,
    /// Operands and results.
    pub fields: Map<String, Json>,
}

/// Why a trace was refused: the 1-based line and the reason.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The bytes could not be read.
    #[error("line {line}: {why}")]
    Io {
        /// The line that could not be read.
        line: u64,
        /// The system's reason.
        why: io::Error,
    },
    /// The line does not belong to a trace.
    #[error("line {line}: {why}")]
    Bad {
        /// The first bad line.
        line: u64,
        /// What is wrong with it.
        why: String,
    },
}

impl TraceError {
    /// The 1-based line.
    pub fn line(&self) -> u64 {
        match self {
            Self::Io { line, .. } | Self::Bad { line, .. } => *line,
        }
    }
    /// The reason alone.
    pub fn why(&self) -> String {
        match self {
            Self::Io { why, .. } => why.to_string(),
            Self::Bad { why, .. } => why.clone(),
        }
    }
}

/// Writes the header line.
///
/// # Errors
/// What `to` returns.
pub fn write_header(header: &Header, to: &mut impl Write) -> io::Result<()> {
    write!(
        to,
        "{{\"trace\":{VERSION},\"scene\":{},\"method\":{}",
        Json::from(&*header.scene),
        Json::from(&*header.method)
    )?;
    write!(
        to,
        ",\"params\":{},\"view\":{}",
        Json::from(header.params.clone()),
        Json::from(header.view.clone())
    )?;
    for (key, value) in &header.more {
        write!(to, ",{}:{value}", Json::from(&**key))?;
    }
    writeln!(to, "}}")
}

/// A parameter's value as JSON: numbers and switches as such, the rest as text.
pub fn knob_json(value: &KnobValue) -> Json {
    match value {
        KnobValue::Integer(v, _) => Json::from(*v),
        // As a whole number where it is one, and otherwise with the digits of its 32 bits.
        KnobValue::Real(v, _) => v.to_string().parse().unwrap_or(Json::Null),
        KnobValue::Switch(v) => Json::from(*v),
        KnobValue::Budget(crate::method::Budget::Count(n)) => Json::from(*n),
        KnobValue::Budget(share) => Json::from(share.to_string()),
        KnobValue::Choice(..) => Json::from(value.to_string()),
    }
}

/// Writes one frame's events; a film that was capped ends with an event `FilmCapped` that says how many
/// are missing. Returns the number of lines. Stops early, with what was written so far, when `stop` says so.
///
/// # Errors
/// What `to` returns.
pub fn write_film<S: Space>(
    film: &dyn Film<S>,
    frame: u64,
    detail: Detail,
    to: &mut impl Write,
    stop: &dyn Fn(usize) -> bool,
) -> io::Result<u64> {
    let code = film.card().code;
    let (mut line, mut written) = (None, 0);
    for (i, event) in film.events().iter().enumerate() {
        if i.is_multiple_of(4096) && stop(i) {
            return Ok(written);
        }
        if let Event::Line(at) = event {
            line = code.get(usize::from(*at)).map(|l| l.label);
        }
        if !detail.shows(event) {
            continue;
        }
        let (kind, fields) = film.fields(i);
        write_entry(to, i as u64 + 1, frame, kind, line, &fields)?;
        written += 1;
    }
    if film.lost() > 0 {
        let lost = Field { name: "lost_events", value: Value::Integer(film.lost()) };
        write_entry(to, film.events().len() as u64 + 1, frame, "FilmCapped", line, &[lost])?;
        written += 1;
    }
    Ok(written)
}

fn write_entry(
    to: &mut impl Write,
    step: u64,
    frame: u64,
    kind: &str,
    line: Option<&str>,
    fields: &[Field],
) -> io::Result<()> {
    write!(to, "{{\"step\":{step},\"frame\":{frame},\"event\":{}", Json::from(kind))?;
    if let Some(line) = line {
        write!(to, ",\"line\":{}", Json::from(line))?;
    }
    for Field { name, value } in fields {
        write!(to, ",\"{name}\":")?;
        match value {
            Value::Number(v) => write_number(to, *v)?,
            Value::Integer(v) => write!(to, "{v}")?,
            Value::Switch(v) => write!(to, "{v}")?,
            Value::Word(v) => write!(to, "{}", Json::from(&**v))?,
            Value::List(list) => {
                for (i, v) in list.iter().enumerate() {
                    to.write_all(if i == 0 { b"[" } else { b"," })?;
                    write_number(to, *v)?;
                }
                to.write_all(if list.is_empty() { b"[]" } else { b"]" })?;
            }
        }
    }
    to.write_all(b"}\n")
}

/// The shortest decimal that reads back as the same float.
fn write_number(to: &mut impl Write, v: f64) -> io::Result<()> {
    if !v.is_finite() {
        return to.write_all(b"null");
    }
    let narrow = v as f32;
    // Debug and not Display: very large and very small numbers get an exponent.
    if f64::from(narrow) == v { write!(to, "{narrow:?}") } else { write!(to, "{v:?}") }
}

/// Reads a trace line by line and refuses the first line that breaks the format.
pub struct Reader<R> {
    from: R,
    line: u64,
    /// Frame and step of the last event.
    last: Option<(u64, u64)>,
}

impl<R: BufRead> Reader<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// When line 1 is not a header of this version.
    pub fn new(from: R) -> Result<(Header, Self), TraceError> {
        let mut reader = Self { from, line: 0, last: None };
        let Some(mut object) = reader.object()? else {
            return Err(reader.bad("the file is empty; line 1 must be the header"));
        };
        match object.remove("trace") {
            Some(v) if v.as_u64() == Some(VERSION) => {}
            Some(v) => {
                return Err(reader.bad(format!(
                    "this is trace version {}; only version {VERSION} is known",
                    shortened(&v)
                )));
            }
            None => {
                return Err(
                    reader.bad("`trace` is missing; line 1 must be the header, such as {\"trace\":1,…}")
                );
            }
        }
        let header = Header {
            scene: reader.text(&mut object, "scene")?,
            method: reader.text(&mut object, "method")?,
            params: reader.map(&mut object, "params")?,
            view: reader.map(&mut object, "view")?,
            more: object,
        };
        Ok((header, reader))
    }

    /// The next event; `None` at the end.
    ///
    /// # Errors
    /// When the next line is not an event that may stand here.
    pub fn next_entry(&mut self) -> Result<Option<Entry>, TraceError> {
        let Some(mut object) = self.object()? else { return Ok(None) };
        let (step, frame) = (self.whole(&mut object, "step")?, self.whole(&mut object, "frame")?);
        let event = self.text(&mut object, "event")?;
        if event.is_empty() {
            return Err(self.bad("`event` is empty"));
        }
        let line = match object.contains_key("line") {
            true => Some(self.text(&mut object, "line")?),
            false => None,
        };
        match self.last {
            _ if step == 0 => return Err(self.bad("`step` is 0; the first event of a frame leads to step 1")),
            Some((f, _)) if frame < f => return Err(self.bad(format!("frame {frame} comes after frame {f}"))),
            Some((f, s)) if frame == f && step <= s => {
                return Err(self.bad(format!("step {step} comes after step {s} of the same frame")));
            }
            _ => self.last = Some((frame, step)),
        }
        if let Some((key, _)) = object.iter().find(|(_, v)| !is_field(v)) {
            return Err(
                self.bad(format!("`{key}` must be a number, a word, true, false, null or a list of numbers"))
            );
        }
        Ok(Some(Entry { step, frame, event, line, fields: object }))
    }

    /// The next line as an object; `None` at the end.
    fn object(&mut self) -> Result<Option<Map<String, Json>>, TraceError> {
        self.line += 1;
        let mut bytes = Vec::new();
        let read = (&mut self.from).take(LINE_LIMIT_BYTES as u64 + 1).read_until(b'\n', &mut bytes);
        read.map_err(|why| TraceError::Io { line: self.line, why })?;
        if bytes.is_empty() {
            return Ok(None);
        }
        if bytes.len() > LINE_LIMIT_BYTES {
            return Err(self.bad(format!("the line is longer than {LINE_LIMIT_BYTES} bytes")));
        }
        if bytes.trim_ascii().is_empty() {
            return Err(self.bad("the line is blank; each line must hold one object"));
        }
        match serde_json::from_slice(&bytes) {
            Ok(Json::Object(object)) => Ok(Some(object)),
            Ok(other) => Err(self.bad(format!("expected an object, found {}", shortened(&other)))),
            Err(e) => {
                let text = e.to_string();
                let why = text.split(" at line ").next().unwrap_or(&text);
                Err(self.bad(format!("not valid JSON: {why} (column {})", e.column())))
            }
        }
    }
    fn bad(&self, why: impl Into<String>) -> TraceError {
        TraceError::Bad { line: self.line, why: why.into() }
    }
    fn field(&self, object: &mut Map<String, Json>, key: &str) -> Result<Json, TraceError> {
        object.remove(key).ok_or_else(|| self.bad(format!("`{key}` is missing")))
    }
    fn text(&self, object: &mut Map<String, Json>, key: &str) -> Result<String, TraceError> {
        match self.field(object, key)? {
            Json::String(text) => Ok(text),
            other => Err(self.bad(format!("`{key}` must be text, not {}", shortened(&other)))),
        }
    }
    fn map(&self, object: &mut Map<String, Json>, key: &str) -> Result<Map<String, Json>, TraceError> {
        match self.field(object, key)? {
            Json::Object(map) => Ok(map),
            other => Err(self.bad(format!("`{key}` must be an object, not {}", shortened(&other)))),
        }
    }
    fn whole(&self, object: &mut Map<String, Json>, key: &str) -> Result<u64, TraceError> {
        let value = self.field(object, key)?;
        value.as_u64().ok_or_else(|| {
            self.bad(format!("`{key}` must be a whole number from 0, not {}", shortened(&value)))
        })
    }
}

fn is_field(value: &Json) -> bool {
    match value {
        Json::Object(_) => false,
        Json::Array(list) => list.iter().all(|v| v.is_number() || v.is_null()),
        _ => true,
    }
}

fn shortened(value: &Json) -> String {
    let text = value.to_string();
    if text.chars().count() <= 40 { text } else { text.chars().take(37).chain("…".chars()).collect() }
}

/// What a whole trace holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Its first line.
    pub header: Header,
    /// Number of events.
    pub events: u64,
    /// Number of frames that have events.
    pub frames: u64,
}

/// Validates a whole trace.
///
/// # Errors
/// The first bad line.
pub fn check(from: impl BufRead) -> Result<Summary, TraceError> {
    let (header, mut reader) = Reader::new(from)?;
    let (mut events, mut frames, mut last) = (0, 0, None);
    while let Some(entry) = reader.next_entry()? {
        events += 1;
        frames += u64::from(last != Some(entry.frame));
        last = Some(entry.frame);
    }
    Ok(Summary { header, events, frames })
}
