//! Parameters, declared once by each method and visited by sliders, `--set`, sweeps and listings.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use super::Words;
use crate::scene::Surfaces;

/// What a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Knob {
    /// Kebab-case name, as in `--set name=value`.
    pub name: &'static str,
    /// Unit, such as `levels`, or empty.
    pub unit: &'static str,
    /// One line that says what it does.
    pub meaning: &'static str,
    /// Where it comes from, such as `Coorg and Teller 1997, Section 4`.
    pub source: &'static str,
}

impl Knob {
    /// A parameter by its name, unit, meaning and source.
    pub const fn new(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        source: &'static str,
    ) -> Self {
        Self { name, unit, meaning, source }
    }
}

/// Visits a method's parameters.
pub trait Knobs {
    /// A whole number.
    fn integer(&mut self, knob: Knob, range: RangeInclusive<u32>, value: &mut u32);
    /// A real number.
    fn real(&mut self, knob: Knob, range: RangeInclusive<f32>, value: &mut f32);
    /// On or off.
    fn switch(&mut self, knob: Knob, value: &mut bool);
    /// How much may be drawn; `ends`: whether the method can be ended at a time.
    fn budget(&mut self, knob: Knob, ends: bool, value: &mut Budget);
    /// One of several words; `value` is an index into `options`.
    fn choice(&mut self, knob: Knob, options: &'static [&'static str], value: &mut usize);
}

impl dyn Knobs + '_ {
    /// One of several words, as the value of an enum.
    pub(crate) fn words<W: Words>(&mut self, knob: Knob, value: &mut W) {
        let mut number = value.number();
        self.choice(knob, W::WORDS, &mut number);
        *value = W::ALL[number];
    }
}

/// How much may be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So many primitives.
    Count(u32),
    /// A share of the scene's primitives, 0 to 100.
    Percent(f32),
    /// Milliseconds since the frame began, above 0; enforced by the caller through a [`super::Limit`].
    Milliseconds(f32),
}

impl Budget {
    const EXPECTED: &'static str =
        "a number of primitives such as 2000, a share such as 10%, or a time such as 5ms";
    /// The number of primitives it allows of `total`: a share is rounded up; a time allows all.
    pub fn of(self, total: usize) -> usize {
        match self {
            Self::Count(n) => n as usize,
            Self::Percent(p) => (f64::from(p) * total as f64 / 100.0).ceil() as usize,
            Self::Milliseconds(_) => total,
        }
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(n) => write!(f, "{n}"),
            Self::Percent(p) => write!(f, "{p}%"),
            Self::Milliseconds(ms) => write!(f, "{ms}ms"),
        }
    }
}

impl FromStr for Budget {
    type Err = &'static str;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = Budget::EXPECTED;
        if let Some(time) = text.strip_suffix("ms") {
            return time
                .trim()
                .parse()
                .ok()
                .filter(|t: &f32| *t > 0.0 && t.is_finite())
                .map(Self::Milliseconds)
                .ok_or(expected);
        }
        match text.strip_suffix('%') {
            Some(share) => share
                .trim()
                .parse()
                .ok()
                .filter(|p| (0.0..=100.0).contains(p))
                .map(Self::Percent)
                .ok_or(expected),
            None => text.parse().map(Self::Count).map_err(|_| expected),
        }
    }
}

/// Parameters by name, as text; what is not named keeps its default.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Settings(pub BTreeMap<String, String>);

impl Settings {
    /// Settings from pairs of a key and its value.
    pub fn of(pairs: &[(&str, &str)]) -> Self {
        Self(pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect())
    }
    /// Adds `key=value`.
    ///
    /// # Errors
    /// When there is no `=` or no key.
    pub fn parse(&mut self, text: &str) -> Result<(), SettingError> {
        match text.split_once('=') {
            Some((key, value)) if !key.trim().is_empty() => {
                self.0.insert(key.trim().to_owned(), value.trim().to_owned());
                Ok(())
            }
            _ => Err(SettingError::NotAPair(text.to_owned())),
        }
    }
}

impl Settings {
    /// How a run with these settings takes the surfaces of its scene.
    pub fn surfaces(&self) -> Surfaces {
        let is = |name: &str, word: &str| self.0.get(name).is_some_and(|v| v == word);
        Surfaces { one_sided: is(BACKFACES, "true"), solid: is(SEE_THROUGH, "solid") }
    }
}

/// Why a setting was refused. Displays as one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// Not of the form `key=value`.
    #[error("`{0}` is not of the form key=value")]
    NotAPair(String),
    /// The method has no such parameter.
    #[error("`{method}` has no parameter `{key}`; it has {known}")]
    Unknown {
        /// The method.
        method: &'static str,
        /// The name given.
        key: String,
        /// The names there are.
        known: String,
    },
    /// The value does not fit.
    #[error("`{key}={value}`: expected {expected}")]
    BadValue {
        /// The parameter.
        key: &'static str,
        /// The value given.
        value: String,
        /// What it should be.
        expected: String,
    },
}

/// A parameter's value with its type, for listings.
#[derive(Clone, Debug, PartialEq)]
pub enum KnobValue {
    /// A whole number in a range.
    Integer(u32, RangeInclusive<u32>),
    /// A real number in a range.
    Real(f32, RangeInclusive<f32>),
    /// On or off.
    Switch(bool),
    /// How much may be drawn.
    Budget(Budget),
    /// One of several words, by index.
    Choice(usize, &'static [&'static str]),
}

impl fmt::Display for KnobValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(v, _) => v.fmt(f),
            Self::Real(v, _) => v.fmt(f),
            Self::Switch(v) => v.fmt(f),
            Self::Budget(v) => v.fmt(f),
            Self::Choice(v, options) => options[*v].fmt(f),
        }
    }
}

/// Collects all parameters with their values.
#[derive(Default)]
pub(crate) struct Collect(pub Vec<(Knob, KnobValue)>);

impl Knobs for Collect {
    fn integer(&mut self, knob: Knob, range: RangeInclusive<u32>, value: &mut u32) {
        self.0.push((knob, KnobValue::Integer(*value, range)));
    }
    fn real(&mut self, knob: Knob, range: RangeInclusive<f32>, value: &mut f32) {
        self.0.push((knob, KnobValue::Real(*value, range)));
    }
    fn switch(&mut self, knob: Knob, value: &mut bool) {
        self.0.push((knob, KnobValue::Switch(*value)));
    }
    fn budget(&mut self, knob: Knob, _: bool, value: &mut Budget) {
        self.0.push((knob, KnobValue::Budget(*value)));
    }
    fn choice(&mut self, knob: Knob, options: &'static [&'static str], value: &mut usize) {
        self.0.push((knob, KnobValue::Choice(*value, options)));
    }
}

/// Sets the budget, where there is one.
pub(crate) struct SetBudget(pub Budget);

impl Knobs for SetBudget {
    fn integer(&mut self, _: Knob, _: RangeInclusive<u32>, _: &mut u32) {}
    fn real(&mut self, _: Knob, _: RangeInclusive<f32>, _: &mut f32) {}
    fn switch(&mut self, _: Knob, _: &mut bool) {}
    fn budget(&mut self, _: Knob, _: bool, value: &mut Budget) {
        *value = self.0;
    }
    fn choice(&mut self, _: Knob, _: &'static [&'static str], _: &mut usize) {}
}

/// Sets parameters from text.
pub(crate) struct Apply<'a> {
    pub settings: &'a Settings,
    pub error: Option<SettingError>,
}

impl Apply<'_> {
    fn set<T: FromStr>(
        &mut self,
        knob: Knob,
        expected: impl FnOnce() -> String,
        fits: impl Fn(&T) -> bool,
        value: &mut T,
    ) {
        let Some(text) = self.settings.0.get(knob.name) else { return };
        match text.parse().ok().filter(fits) {
            Some(v) => *value = v,
            None => {
                let error =
                    SettingError::BadValue { key: knob.name, value: text.clone(), expected: expected() };
                self.error.get_or_insert(error);
            }
        }
    }
}

impl Knobs for Apply<'_> {
    fn integer(&mut self, knob: Knob, range: RangeInclusive<u32>, value: &mut u32) {
        let expected = || format!("a whole number from {} to {}", range.start(), range.end());
        self.set(knob, expected, |v| range.contains(v), value);
    }
    fn real(&mut self, knob: Knob, range: RangeInclusive<f32>, value: &mut f32) {
        let expected = || format!("a number from {} to {}", range.start(), range.end());
        self.set(knob, expected, |v| range.contains(v), value);
    }
    fn switch(&mut self, knob: Knob, value: &mut bool) {
        self.set(knob, || "true or false".into(), |_| true, value);
    }
    fn budget(&mut self, knob: Knob, ends: bool, value: &mut Budget) {
        let expected = || {
            if ends {
                Budget::EXPECTED.to_owned()
            } else {
                "a number of primitives such as 2000 or a share such as 10%: this method cannot be ended at \
                 a time"
                    .to_owned()
            }
        };
        self.set(knob, expected, |v| ends || !matches!(v, Budget::Milliseconds(_)), value);
    }
    fn choice(&mut self, knob: Knob, options: &'static [&'static str], value: &mut usize) {
        let mut word = options[*value].to_owned();
        self.set(
            knob,
            || format!("one of {}", options.join(", ")),
            |w: &String| options.contains(&w.as_str()),
            &mut word,
        );
        *value = options.iter().position(|o| *o == word).unwrap_or(*value);
    }
}

/// The parameters that every method has.
pub(crate) fn surface_knobs(knobs: &mut dyn Knobs, surfaces: &mut Surfaces) {
    let knob = Knob {
        name: BACKFACES,
        unit: "",
        meaning: "primitives have one side, but for those of a two-sided material: those that face away from \
                  the eye are neither drawn nor part of the truth",
        source: "Klosowski and Silva 2000, Section 5",
    };
    knobs.switch(knob, &mut surfaces.one_sided);
    let knob = Knob {
        name: SEE_THROUGH,
        unit: "",
        meaning: "open: glass and what has holes is drawn and hides nothing; solid: it hides what is behind \
                  it, as if it were opaque",
        source: "our own: the papers know opaque polygons only",
    };
    let mut at = usize::from(surfaces.solid);
    knobs.choice(knob, &["open", "solid"], &mut at);
    surfaces.solid = at == 1;
}

/// Whether a parameter says how surfaces are taken: what is to be seen, not how it is found.
pub fn is_of_surfaces(knob: &Knob) -> bool {
    [BACKFACES, SEE_THROUGH].contains(&knob.name)
}

/// How a run takes the surfaces of its scene, from the values of its parameters.
pub fn surfaces_of(knobs: &[(Knob, KnobValue)]) -> Surfaces {
    let words = knobs.iter().map(|(knob, value)| (knob.name.to_owned(), value.to_string()));
    Settings(words.collect()).surfaces()
}

const BACKFACES: &str = "backface-culling";
const SEE_THROUGH: &str = "see-through";
