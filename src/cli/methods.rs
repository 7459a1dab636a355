//! `cullscope methods`: the methods and their parameters, read from the methods themselves.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;
use serde_json::{Value as Json, json};

use super::{CliError, World, output, suggest};
use crate::geometry::{Flat, Solid};
use crate::method::{Budget, Card, Departure, Entry, Knob, KnobValue, Settings};
use crate::trace::format::knob_json;

#[derive(clap::Args)]
#[command(after_help = "Example:\n  cullscope methods --json")]
pub(super) struct Args {
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// A method as it is listed.
#[derive(Serialize)]
struct Listed {
    key: &'static str,
    name: &'static str,
    summary: &'static str,
    paper: &'static str,
    doi: &'static str,
    conservative: bool,
    spaces: Vec<&'static str>,
    params: Vec<Param>,
    departures: &'static [Departure],
}

#[derive(Serialize)]
struct Param {
    name: &'static str,
    r#type: &'static str,
    unit: &'static str,
    range: Json,
    default: Json,
    meaning: &'static str,
    source: &'static str,
}

pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let methods = all()?;
    let text = if args.json {
        json_text(&json!({ "cullscope": env!("CARGO_PKG_VERSION"), "methods": methods }))
    } else {
        table(&methods)
    };
    output::print(text.as_bytes())
}

/// The method of a space with this key.
pub(super) fn find<S: World>(key: &str) -> Result<&'static dyn Entry<S>, CliError> {
    S::method(key).ok_or_else(|| {
        let keys: Vec<_> = S::methods().iter().map(|m| m.card().key).collect();
        CliError::words("--method", format!("there is no method `{key}` in {}", S::NAME))
            .with_help(suggest::help(key, &keys, "methods"))
    })
}

/// `--set key=value`, all of them.
pub(super) fn settings(pairs: &[String]) -> Result<Settings, CliError> {
    let mut settings = Settings::default();
    for pair in pairs {
        settings.parse(pair)?;
    }
    Ok(settings)
}

/// Refuses a budget of time where the same run is to be told again.
pub(super) fn refuse_clock(knobs: &[(Knob, KnobValue)]) -> Result<(), CliError> {
    let is_time = |(_, v): &&(Knob, KnobValue)| matches!(v, KnobValue::Budget(Budget::Milliseconds(_)));
    let Some((_, time)) = knobs.iter().find(is_time) else { return Ok(()) };
    let why = "what fits into a time differs from run to run, and what is written must not";
    Err(CliError::words(format!("--set budget={time}"), why)
        .with_help("give a number of primitives; `cullscope cull` prints how many were drawn"))
}

/// Parameters by name, as JSON.
pub(super) fn params_json(knobs: &[(Knob, KnobValue)]) -> BTreeMap<&'static str, Json> {
    knobs.iter().map(|(knob, value)| (knob.name, knob_json(value))).collect()
}

/// JSON with a line break at its end.
pub(super) fn json_text(value: &impl Serialize) -> String {
    // Tables of text and numbers always serialize.
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

fn all() -> Result<Vec<Listed>, CliError> {
    let mut list: Vec<Listed> = Vec::new();
    add::<Flat>(&mut list)?;
    add::<Solid>(&mut list)?;
    Ok(list)
}

fn add<S: World>(list: &mut Vec<Listed>) -> Result<(), CliError> {
    for entry in S::methods() {
        let Card { key, name, summary, paper, doi, conservative, departures, .. } = *entry.card();
        if let Some(known) = list.iter_mut().find(|m| m.key == key) {
            known.spaces.push(S::NAME);
            continue;
        }
        let params =
            entry.knobs(&Settings::default())?.iter().map(|(knob, value)| param(knob, value)).collect();
        let spaces = vec![S::NAME];
        list.push(Listed { key, name, summary, paper, doi, conservative, spaces, params, departures });
    }
    Ok(())
}

fn param(knob: &Knob, value: &KnobValue) -> Param {
    let (r#type, range) = match value {
        KnobValue::Integer(_, range) => ("integer", json!([range.start(), range.end()])),
        KnobValue::Real(_, range) => ("real", json!([range.start(), range.end()])),
        KnobValue::Switch(_) => ("switch", json!([false, true])),
        KnobValue::Budget(_) => ("budget", json!(["0", "4294967295", "0%", "100%", "0.001ms", "3600000ms"])),
        KnobValue::Choice(_, options) => ("choice", json!(options)),
    };
    Param {
        name: knob.name,
        r#type,
        unit: knob.unit,
        range,
        default: knob_json(value),
        meaning: knob.meaning,
        source: knob.source,
    }
}

fn table(methods: &[Listed]) -> String {
    let mut text = String::new();
    for m in methods {
        let kind = if m.conservative { "conservative" } else { "not conservative" };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}: {} ({kind}; {})\n  {}\n  {}",
            m.key,
            m.name,
            m.spaces.join(", "),
            m.summary,
            m.paper
        );
        for p in &m.params {
            let range = match (p.r#type, &p.range) {
                ("integer", Json::Array(ends)) => format!("{} to {} {}", ends[0], ends[1], p.unit),
                ("real", Json::Array(ends)) => format!("{} to {} {}", ends[0], ends[1], p.unit),
                ("switch", _) => "true or false".into(),
                ("choice", Json::Array(words)) => {
                    words.iter().filter_map(Json::as_str).collect::<Vec<_>>().join(" or ")
                }
                _ => format!("N or P%, {}", p.unit),
            };
            let range = range.trim_end();
            let default = p.default.as_str().map_or_else(|| p.default.to_string(), str::to_owned);
            let _ = writeln!(text, "    --set {}={default}   {range}: {} [{}]", p.name, p.meaning, p.source);
        }
        if !m.departures.is_empty() {
            text.push_str("  where it departs from the paper, on purpose:\n");
        }
        for d in m.departures {
            let _ = writeln!(text, "    Section {}: {}: {}", d.section, d.what, d.why);
        }
        text.push('\n');
    }
    text.truncate(text.trim_end().len());
    text + "\n"
}
