//! The pseudocode at a step: the values that matter there, and all of it as a figure.

use super::state::State;
use crate::drawing::Drawing;
use crate::drawing::words::{Room, short};
use crate::figure::{Row, listing};
use crate::method::{Event, Value};

/// A value as a person reads it.
pub fn value(value: &Value) -> String {
    match value {
        Value::Number(v) => short(*v as f32, Room::Row),
        Value::Integer(v) => v.to_string(),
        Value::Switch(true) => "yes".into(),
        Value::Switch(false) => "no".into(),
        Value::Word(w) => w.clone(),
        Value::List(list) => list.iter().map(|v| short(*v as f32, Room::Row)).collect::<Vec<_>>().join(", "),
    }
}

impl State {
    /// The values that matter at this step: the two numbers that the evidence compared; where nothing was
    /// compared, the first of the event's own.
    pub fn values(&self) -> String {
        let (Some(film), Some(at)) = (self.film(), self.current()) else { return String::new() };
        let event = film.reel.events()[at];
        let found = film.reel.evidence_at(self.step);
        let is_line = matches!(event, Event::Line(_) | Event::FrameBegan);
        // A line that leads to a test says nothing yet: what was found before is another test's.
        let events = film.reel.events();
        let next = events[at..].iter().find(|e| !matches!(e, Event::Line(_)));
        if is_line && matches!(next, Some(Event::Noted(_))) {
            return String::new();
        }
        if let Some(compared) = found.and_then(|i| film.reel.compared(i)) {
            return compared.to_string();
        }
        let shown = if is_line { found } else { Some(at) };
        let Some(i) = shown else { return String::new() };
        let fields = film.reel.fields(i).1;
        fields
            .iter()
            .take(4)
            .map(|f| format!("{} {}", f.name.replace('_', " "), value(&f.value)))
            .collect::<Vec<_>>()
            .join(" · ")
    }

    /// The lines that the parameters have, `width_pt` wide, the current one lit.
    pub(super) fn listed(&self, width_pt: f32) -> Option<Drawing> {
        let reel = self.film()?.reel;
        let (lit, values) = (self.line(), self.values());
        let lines = reel.card().code.iter().enumerate().map(|(i, line)| (i as u8, line));
        let row = |(number, line)| Row {
            line,
            is_reached: self.reaches(number),
            lit: (lit == Some(number)).then(|| values.clone()),
        };
        let rows: Vec<Row> = lines.filter(|(i, _)| reel.has_line(*i)).map(row).collect();
        Some(listing(&rows, width_pt))
    }
}
