//! Evidence: the operands of the tests that a method makes, and what it claims because of them.

use std::cmp::Ordering;
use std::fmt;

use super::event::Tallied;
use crate::drawing::Subject;
use crate::drawing::words::{self, Room};
use crate::geometry::{Aabb, Space, View};
use crate::scene::Scene;

/// A value of a note's field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A measured number.
    Number(f64),
    /// A count or an id.
    Integer(u64),
    /// Yes or no.
    Switch(bool),
    /// A word.
    Word(String),
    /// Several numbers.
    List(Vec<f64>),
}

/// An operand or result of a test, by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Snake-case name; units last, as in `margin_units`.
    pub name: &'static str,
    /// Its value.
    pub value: Value,
}

/// What a note claims of its subject: something that an independent checker can prove or refute without this
/// program's arithmetic ([`crate::truth::certificate`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Claim<V> {
    /// Its box lies outside a plane of the view volume.
    Outside {
        /// Name of the plane, such as `left`.
        plane: &'static str,
        /// Signed distance of the corner that reaches farthest in, world units, negative.
        far_corner: f64,
        /// Bound on that distance's error, world units.
        error: f64,
        /// The box.
        bounds: Aabb<V>,
    },
    /// It turns its back to the eye.
    FacesAway {
        /// Signed distance of the eye from its plane, world units, negative.
        eye_distance: f64,
    },
    /// Surfaces that are shown lie before every part of its box.
    Hidden,
}

impl<V> Claim<V> {
    /// Kebab-case name, as traces have it.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Outside { .. } => "outside",
            Self::FacesAway { .. } => "faces-away",
            Self::Hidden => "hidden",
        }
    }
}

/// The two numbers that a test compared, each by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// The one that was found, such as the distance of a corner.
    pub found: (&'static str, f64),
    /// How it relates to the other: `<`, `≤`, `=`, `≥` or `>`.
    pub sign: &'static str,
    /// The one that it is compared with, such as the margin that is needed.
    pub with: (&'static str, f64),
}

impl Compared {
    /// A number that was found against the one that it is compared with; the sign follows from both, but for
    /// equal ones.
    pub fn of(found: (&'static str, f64), with: (&'static str, f64)) -> Self {
        let sign = match found.1.partial_cmp(&with.1) {
            Some(Ordering::Less) => "<",
            Some(Ordering::Greater) => ">",
            _ => "=",
        };
        Self { found, sign, with }
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Counts are whole numbers, and look like it.
        let are_counts = [self.found.1, self.with.1].iter().all(|v| v.fract() == 0.0 && v.abs() < 1e5);
        let short = |v: f64| match are_counts {
            true => format!("{v:.0}"),
            false => words::short(v as f32, Room::Sentence),
        };
        let (found, with) = (short(self.found.1), short(self.with.1));
        write!(f, "{} {found} {} {with} {}", self.found.0, self.sign, self.with.0)
    }
}

/// What evidence is read against: a note keeps what a run found, not what any reader can look up.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a, S: Space> {
    /// The scene.
    pub scene: &'a Scene<S>,
    /// The view that was culled for.
    pub view: &'a View<S>,
}

/// A piece of evidence of a method: the operands of one test, not only its result.
pub trait Note<S: Space>: Tallied + Copy + Send + Sync + 'static {
    /// What was done, in the past tense and camel case, such as `NodeClassified`.
    fn kind(&self) -> &'static str;
    /// What the evidence is about: a node, an object or a primitive, or nothing of these.
    fn subject(&self) -> Subject;
    /// What it claims of its subject; `None` if it proves nothing by itself.
    fn claim(&self, _: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        None
    }
    /// The two numbers whose comparison gave the result; `None` if none decided.
    fn compared(&self, _: &Context<'_, S>) -> Option<Compared> {
        None
    }
    /// Operands and results by name, for the trace and the inspector. Programs read the note itself.
    fn fields(&self, context: &Context<'_, S>) -> Vec<Field>;
    /// What was done, in a sentence or two that a student understands.
    fn sentence(&self, context: &Context<'_, S>) -> String;
}
