//! What the figures read of the method's notes.

use std::collections::BTreeMap;

use glam::{Vec2, vec2};

use crate::geometry::{Flat, NodeId, Space};
use crate::method::{Event, Field, Film, Value};

/// A number of a note.
fn number(fields: &[Field], name: &str) -> Option<f64> {
    fields.iter().find(|f| f.name == name).and_then(|f| match f.value {
        Value::Number(v) => Some(v),
        Value::Integer(v) => Some(v as f64),
        Value::Switch(v) => Some(f64::from(u8::from(v))),
        _ => None,
    })
}

/// A node of a note.
fn node(fields: &[Field], name: &str) -> NodeId {
    NodeId(number(fields, name).unwrap_or_default() as u32)
}

/// The traversal at a moment: after so many cells were projected and their neighbors put into the front.
#[derive(Default)]
pub struct Moment {
    /// Cells in the order in which they were projected.
    pub projected: Vec<NodeId>,
    /// The front, with solidities.
    pub front: BTreeMap<NodeId, f32>,
    /// Primitives that may still be drawn.
    pub left: usize,
    /// The step of the film.
    pub step: usize,
}

impl Moment {
    pub fn after<S: Space>(film: &dyn Film<S>, cells: usize) -> Self {
        let mut moment = Self::default();
        for (at, _) in film.events().iter().enumerate().filter(|(_, e)| matches!(e, Event::Noted(_))) {
            let (kind, fields) = film.fields(at);
            match kind {
                "CellSeeded" => _ = moment.front.insert(node(&fields, "node"), 0.0),
                "SolidityTransferred" if number(&fields, "keeps") == Some(1.0) => {}
                "SolidityTransferred" => {
                    moment.front.insert(
                        node(&fields, "node"),
                        number(&fields, "solidity").unwrap_or_default() as f32,
                    );
                }
                "CellProjected" if moment.projected.len() == cells => break,
                "CellProjected" => {
                    let cell = node(&fields, "node");
                    moment.front.remove(&cell);
                    moment.projected.push(cell);
                    moment.left = number(&fields, "budget_left").unwrap_or_default() as usize;
                }
                _ => {}
            }
            moment.step = at + 1;
        }
        moment
    }
}

/// Operands and result of a transfer, as its note records them.
#[derive(Clone, Debug)]
pub struct Transfer {
    fields: Vec<Field>,
    /// The step of the film.
    pub step: usize,
}

impl Transfer {
    pub fn number(&self, name: &str) -> f64 {
        number(&self.fields, name).unwrap_or_default()
    }
    pub fn from(&self) -> NodeId {
        node(&self.fields, "from_node")
    }
    pub fn to(&self) -> NodeId {
        node(&self.fields, "node")
    }
    pub fn is_star_shaped(&self) -> bool {
        self.number("star_shaped") != 0.0
    }
    pub fn vector(&self, name: &str) -> Vec2 {
        let field = self.fields.iter().find(|f| f.name == name);
        match field.map(|f| &f.value) {
            Some(Value::List(v)) if v.len() == 2 => vec2(v[0] as f32, v[1] as f32),
            _ => Vec2::ZERO,
        }
    }
}

/// The transfers of each projected cell.
pub fn transfers(film: &dyn Film<Flat>) -> Vec<Vec<Transfer>> {
    let mut groups: Vec<Vec<Transfer>> = Vec::new();
    for (at, _) in film.events().iter().enumerate().filter(|(_, e)| matches!(e, Event::Noted(_))) {
        let (kind, fields) = film.fields(at);
        if kind == "SolidityTransferred" {
            let transfer = Transfer { fields, step: at + 1 };
            match groups.last_mut().filter(|g| g[0].from() == transfer.from()) {
                Some(group) => group.push(transfer),
                None => groups.push(vec![transfer]),
            }
        }
    }
    groups
}
