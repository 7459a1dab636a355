//! What a sweep runs, read from TOML: scenes, methods, and the values of their parameters.
//!
//! ```toml
//! name = "how far to go"        # of the files that come out; the spec's own name by default
//! frames = 12                   # of each scene's path, evenly spaced
//! repeats = 3                   # flights that are timed
//! size = [512, 512]             # of the image, pixels
//! error = "wrong-pixels"        # of the chart: or "flip", or "missed"
//! scenes = ["generate:building", { source = "model.obj", path = "walk" }]
//!
//! [[method]]
//! key = "frustum"
//!
//! [[method]]
//! key = "a-method"
//! set = { budget = ["1%", "5%"], seed = 3 }   # a list is one configuration for each value
//! ```

use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::geometry::{MAX_SIDE_PX, Solid};
use crate::measure::experiment::World;
use crate::method::{SettingError, Settings};

/// What a sweep runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// What the result is called.
    pub name: String,
    /// Frames of each scene's path, at least 1.
    pub frames: u32,
    /// Flights that are timed, at least 1.
    pub repeats: u32,
    /// Size of the image, if not that of the path; in flatland its width alone.
    pub size_px: Option<[u32; 2]>,
    /// The error that the chart shows.
    pub error: ErrorKind,
    /// What is looked at, at least one.
    pub scenes: Vec<Place>,
    /// Methods with parameters, at least one; each is run on all scenes.
    pub configurations: Vec<Configuration>,
}

/// A scene, and where it is seen from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// A file, or the call of a generator.
    pub source: String,
    /// Name of one of its paths; its first one if there is none.
    pub path: Option<String>,
}

/// A method with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Key of the method.
    pub method: String,
    /// Parameters that it sets.
    pub settings: Settings,
}

impl Configuration {
    /// Method and parameters as they are given on the command line.
    pub fn label(&self) -> String {
        let words = self.settings.0.iter().map(|(name, value)| format!("{name}={value}"));
        std::iter::once(self.method.clone()).chain(words).collect::<Vec<_>>().join(" ")
    }
    /// Whether the method has these parameters.
    ///
    /// # Errors
    /// There is no such method or parameter, or its value does not fit.
    pub fn check<S: World>(&self) -> Result<(), SpecError> {
        let fault =
            |why: String, known: Vec<String>| SpecError { line: None, what: self.label(), why, known };
        let Some(entry) = S::method(&self.method) else {
            let known = S::methods().iter().map(|m| m.card().key.to_owned()).collect();
            let why = format!("there is no method `{}` in {}", self.method, S::NAME);
            return Err(SpecError { what: self.method.clone(), ..fault(why, known) });
        };
        entry.knobs(&self.settings).map(drop).map_err(|e: SettingError| fault(e.to_string(), Vec::new()))
    }
}

/// By what an answer is called wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorKind {
    /// Pixels of another color than the exact image's, per cent.
    #[default]
    WrongPixels,
    /// Mean LDR-FLIP between the images, per cent.
    Flip,
    /// Visible primitives that were not drawn, per cent.
    Missed,
}

impl ErrorKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::WrongPixels, Self::Flip, Self::Missed];
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::WrongPixels => "wrong-pixels",
            Self::Flip => "flip",
            Self::Missed => "missed",
        }
    }
    /// What it says at an axis, with its unit.
    pub fn label(self) -> &'static str {
        match self {
            Self::WrongPixels => "wrong pixels, %",
            Self::Flip => "mean difference (FLIP), %",
            Self::Missed => "visible primitives missed, %",
        }
    }
}

/// What is wrong with a spec.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}`{what}`: {why}", line.map(|n| format!("line {n}: ")).unwrap_or_default())]
pub struct SpecError {
    /// Line of the text, from 1, if it is known.
    pub line: Option<usize>,
    /// The key or value.
    pub what: String,
    /// What is wrong with it.
    pub why: String,
    /// What could stand there, if that is a list of words.
    pub known: Vec<String>,
}

/// Keys of a spec, of a scene, and of a method.
const KEYS: &[&str] = &["name", "frames", "repeats", "size", "error", "scenes", "method"];
const SCENE_KEYS: &[&str] = &["source", "path"];
const METHOD_KEYS: &[&str] = &["key", "set"];
/// Configurations of a spec at most: more are a slip, such as a list too many.
const MOST: usize = 10_000;

/// The text of a spec with its name in it, as [`Spec::parse`] reads it whatever its file is called.
pub fn named(text: &str, spec: &Spec) -> String {
    let has_name = DeTable::parse(text).is_ok_and(|table| table.get_ref().contains_key("name"));
    // What is quoted for JSON is quoted for TOML.
    if has_name { text.to_owned() } else { format!("name = {}\n{text}", serde_json::json!(spec.name)) }
}

impl Spec {
    /// Reads a spec; `name` is what it is called where it does not say.
    ///
    /// # Errors
    /// The first thing that is wrong, with its line.
    pub fn parse(text: &str, name: &str) -> Result<Self, SpecError> {
        let reader = Reader { text };
        let table = DeTable::parse(text).map_err(|e| SpecError {
            line: e.span().map(|span| reader.line(span.start)),
            what: name.to_owned(),
            why: format!("it is not TOML: {}", e.message()),
            known: Vec::new(),
        })?;
        let all = table.get_ref();
        reader.keys(all, KEYS)?;
        let mut spec = Self {
            name: reader.string(all, "name")?.unwrap_or_else(|| name.to_owned()),
            frames: reader.integer(all, "frames", 1..=100_000)?.unwrap_or(12),
            repeats: reader.integer(all, "repeats", 1..=1000)?.unwrap_or(3),
            size_px: reader.size(all)?,
            error: reader.error(all)?,
            scenes: Vec::new(),
            configurations: Vec::new(),
        };
        for value in reader.list(all, "scenes")? {
            spec.scenes.push(reader.place(value)?);
        }
        for value in reader.list(all, "method")? {
            reader.configurations(value, &mut spec.configurations)?;
        }
        Ok(spec)
    }
    /// What tells it from another: everything that changes a result, so not what it is called.
    pub fn fingerprint(&self) -> String {
        let mut hash = sha2::Sha256::default();
        // What is printed is the whole value.
        sha2::Digest::update(&mut hash, format!("{:?}", Self { name: String::new(), ..self.clone() }));
        let digest = sha2::Digest::finalize(hash);
        digest.iter().take(8).map(|byte| format!("{byte:02x}")).collect()
    }
}

type Value<'a> = Spanned<DeValue<'a>>;

/// Reads values of a text, and knows their lines.
struct Reader<'a> {
    text: &'a str,
}

impl Reader<'_> {
    fn line(&self, at: usize) -> usize {
        self.text[..at.min(self.text.len())].matches('\n').count() + 1
    }
    fn fault(&self, at: usize, what: &str, why: impl Into<String>) -> SpecError {
        let (line, what, why) = (Some(self.line(at)), what.to_owned(), why.into());
        SpecError { line, what, why, known: Vec::new() }
    }
    /// Whether all keys of a table are known.
    fn keys(&self, table: &DeTable<'_>, known: &[&str]) -> Result<(), SpecError> {
        let unknown = table.keys().find(|key| !known.contains(&key.get_ref().as_ref()));
        unknown.map_or(Ok(()), |key| {
            let fault = self.fault(key.span().start, key.get_ref(), "there is no such key here");
            Err(SpecError { known: known.iter().map(|&k| k.to_owned()).collect(), ..fault })
        })
    }
    fn string(&self, table: &DeTable<'_>, key: &str) -> Result<Option<String>, SpecError> {
        let Some(value) = table.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::String(text) if !text.is_empty() => Ok(Some(text.to_string())),
            _ => Err(self.fault(value.span().start, key, "expected a text in quotes")),
        }
    }
    fn integer(
        &self,
        table: &DeTable<'_>,
        key: &str,
        range: std::ops::RangeInclusive<u32>,
    ) -> Result<Option<u32>, SpecError> {
        let Some(value) = table.get(key) else { return Ok(None) };
        number(value.get_ref()).filter(|n| range.contains(n)).map(Some).ok_or_else(|| {
            let why = format!("expected a whole number from {} to {}", range.start(), range.end());
            self.fault(value.span().start, key, why)
        })
    }
    fn size(&self, table: &DeTable<'_>) -> Result<Option<[u32; 2]>, SpecError> {
        let Some(value) = table.get("size") else { return Ok(None) };
        let side = |v: &Value<'_>| number(v.get_ref()).filter(|n| (1..=MAX_SIDE_PX).contains(n));
        let sides = value
            .get_ref()
            .as_array()
            .filter(|a| a.len() == 2)
            .and_then(|a| a.iter().map(side).collect::<Option<Vec<_>>>());
        sides.map(|s| Some([s[0], s[1]])).ok_or_else(|| {
            let why = format!("expected a width and a height from 1 to {MAX_SIDE_PX} such as [512, 512]");
            self.fault(value.span().start, "size", why)
        })
    }
    fn error(&self, table: &DeTable<'_>) -> Result<ErrorKind, SpecError> {
        let Some(word) = self.string(table, "error")? else { return Ok(ErrorKind::default()) };
        ErrorKind::ALL.into_iter().find(|kind| kind.word() == word).ok_or_else(|| {
            let at = table.get("error").map_or(0, |v| v.span().start);
            let fault = self.fault(at, &word, "there is no such error");
            SpecError { known: ErrorKind::ALL.map(|kind| kind.word().to_owned()).to_vec(), ..fault }
        })
    }
    /// What stands in a list that may not be empty.
    fn list<'t, 'v>(&self, table: &'t DeTable<'v>, key: &str) -> Result<Vec<&'t Value<'v>>, SpecError> {
        let Some(value) = table.get(key) else {
            let fault = self.fault(0, key, "it is missing: a sweep needs at least one");
            return Err(SpecError { line: None, ..fault });
        };
        let list: Vec<_> = value.get_ref().as_array().into_iter().flat_map(|a| a.iter()).collect();
        if list.is_empty() {
            return Err(self.fault(value.span().start, key, "expected a list of at least one"));
        }
        Ok(list)
    }
    fn place(&self, value: &Value<'_>) -> Result<Place, SpecError> {
        let wants = || {
            let why =
                "expected a text in quotes, or a table such as { source = \"model.obj\", path = \"walk\" }";
            self.fault(value.span().start, "scenes", why)
        };
        match value.get_ref() {
            DeValue::String(source) => Ok(Place { source: source.to_string(), path: None }),
            DeValue::Table(table) => {
                self.keys(table, SCENE_KEYS)?;
                let source = self.string(table, "source")?.ok_or_else(wants)?;
                Ok(Place { source, path: self.string(table, "path")? })
            }
            _ => Err(wants()),
        }
    }
    /// The configurations of a method: one for each choice of its parameters' values.
    fn configurations(&self, value: &Value<'_>, to: &mut Vec<Configuration>) -> Result<(), SpecError> {
        let at = value.span().start;
        let Some(table) = value.get_ref().as_table() else {
            return Err(self.fault(
                at,
                "method",
                "expected tables: [[method]] with a key and, if you like, a set",
            ));
        };
        self.keys(table, METHOD_KEYS)?;
        let Some(method) = self.string(table, "key")? else {
            return Err(self.fault(at, "method", "its `key` is missing, such as key = \"frustum\""));
        };
        let mut all = vec![BTreeMap::new()];
        if let Some(set) = table.get("set") {
            let Some(values) = set.get_ref().as_table() else {
                let why = "expected a table of parameters such as { budget = [\"1%\", \"5%\"] }";
                return Err(self.fault(set.span().start, "set", why));
            };
            for (name, value) in values {
                let words = self.values(name.get_ref(), value)?;
                all = all
                    .iter()
                    .flat_map(|some: &BTreeMap<String, String>| {
                        words.iter().map(|word| {
                            let mut more = some.clone();
                            more.insert(name.get_ref().to_string(), word.clone());
                            more
                        })
                    })
                    .collect();
                if all.len() > MOST {
                    return Err(self.fault(
                        at,
                        &method,
                        format!("these are more than {MOST} configurations"),
                    ));
                }
            }
        }
        for settings in all {
            let one = Configuration { method: method.clone(), settings: Settings(settings) };
            one.check::<Solid>().map_err(|e| SpecError { line: Some(self.line(at)), ..e })?;
            if to.contains(&one) {
                return Err(self.fault(at, &one.label(), "it stands here twice"));
            }
            to.push(one);
        }
        Ok(())
    }
    /// A parameter's values as words.
    fn values(&self, name: &str, value: &Value<'_>) -> Result<Vec<String>, SpecError> {
        let word = |value: &Value<'_>| match value.get_ref() {
            DeValue::String(text) => Ok(text.to_string()),
            DeValue::Integer(number) if number.radix() == 10 => Ok(number.as_str().to_owned()),
            DeValue::Float(number) => Ok(number.as_str().to_owned()),
            DeValue::Boolean(yes) => Ok(yes.to_string()),
            _ => Err(self.fault(value.span().start, name, "expected a value, or a list of values")),
        };
        match value.get_ref() {
            DeValue::Array(list) if !list.is_empty() => list.iter().map(word).collect(),
            _ => word(value).map(|word| vec![word]),
        }
    }
}

fn number(value: &DeValue<'_>) -> Option<u32> {
    value.as_integer().filter(|n| n.radix() == 10).and_then(|n| n.as_str().parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRUSTUM: &str = "[[method]]\nkey = \"frustum\"\n";

    fn parsed(text: &str) -> Result<Spec, SpecError> {
        Spec::parse(text, "spec")
    }

    #[test]
    fn lists_are_one_configuration_for_each_value() {
        let text = "frames = 7\nsize = [64, 48]\nerror = \"flip\"\n\
                    scenes = [\"generate:building\", { source = \"a.obj\", path = \"walk\" }]\n\
                    [[method]]\nkey = \"frustum\"\n\
                    set = { tree-height = [2, 4], backface-culling = [true, false] }\n\
                    [[method]]\nkey = \"centroid\"\nset.budget = \"5%\"\n";
        let spec = parsed(text).expect("a spec");
        assert_eq!((spec.name.as_str(), spec.frames, spec.repeats), ("spec", 7, 3));
        assert_eq!((spec.size_px, spec.error), (Some([64, 48]), ErrorKind::Flip));
        assert_eq!(spec.scenes[1], Place { source: "a.obj".into(), path: Some("walk".into()) });
        let labels: Vec<_> = spec.configurations.iter().map(Configuration::label).collect();
        assert_eq!(
            labels,
            [
                "frustum backface-culling=true tree-height=2",
                "frustum backface-culling=true tree-height=4",
                "frustum backface-culling=false tree-height=2",
                "frustum backface-culling=false tree-height=4",
                "centroid budget=5%",
            ]
        );
        // A copy under another name is the same spec.
        assert_eq!(Spec::parse(text, "other").expect("a spec").fingerprint(), spec.fingerprint());
        let copy = Spec::parse(&named(text, &spec), "copy").expect("a spec");
        assert_eq!((&copy.name, copy.fingerprint()), (&spec.name, spec.fingerprint()));
        assert_eq!(named(&named(text, &spec), &spec), named(text, &spec));
        assert_ne!(spec.fingerprint(), parsed(&text.replace("5%", "6%")).expect("a spec").fingerprint());
    }

    /// Line and key of what is wrong, and what could stand there.
    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let scenes = "scenes = [\"generate:building\"]\n";
        let of = |text: String| {
            let fault = parsed(&text).expect_err("not a spec");
            (fault.line, fault.what, !fault.known.is_empty())
        };
        assert_eq!(of(format!("frame = 3\n{scenes}{FRUSTUM}")), (Some(1), "frame".into(), true));
        assert_eq!(of(format!("{scenes}frames = 0\n{FRUSTUM}")), (Some(2), "frames".into(), false));
        assert_eq!(of(format!("{scenes}{FRUSTUM}sett = 1\n")), (Some(4), "sett".into(), true));
        assert_eq!(
            of(format!("{scenes}\n[[method]]\nkey = \"frustrum\"\n")),
            (Some(3), "frustrum".into(), true)
        );
        let wrong = format!("{scenes}{FRUSTUM}set.height = 3\n");
        assert_eq!(of(wrong), (Some(2), "frustum height=3".into(), false));
        assert_eq!(of(format!("{scenes}size = [3]\n{FRUSTUM}")), (Some(2), "size".into(), false));
        assert_eq!(of(format!("{scenes}error = \"flop\"\n{FRUSTUM}")), (Some(2), "flop".into(), true));
        assert_eq!(of(format!("{scenes}{FRUSTUM}{FRUSTUM}")), (Some(4), "frustum".into(), false));
        assert_eq!(of(FRUSTUM.to_owned()), (None, "scenes".into(), false));
        assert_eq!(of(scenes.to_owned()), (None, "method".into(), false));
        assert_eq!(of(format!("{scenes}x =\n")).0, Some(2));
        let message = parsed(&format!("frame = 3\n{scenes}{FRUSTUM}")).expect_err("not a spec").to_string();
        assert_eq!(message, "line 1: `frame`: there is no such key here");
    }
}
