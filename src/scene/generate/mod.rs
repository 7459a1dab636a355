//! Scenes made by rule: seeded, parametric, the same on every machine.
//!
//! Only addition, multiplication, division and square root are used, whose results IEEE 754 fixes; sines come
//! from a series, since those of system libraries differ in their last bits.

mod blocks;
mod box_and_objects;
mod building;
mod bust;
mod car;
mod cars;
mod city;
mod cottage;
mod creatures;
mod failure;
mod forest;
mod furniture;
mod house;
mod island;
mod lathe;
mod lone_tree;
mod machine_room;
mod machinery;
mod molecule;
mod paint;
mod plan;
mod sculpture;
mod seminar_room;
mod shapes;
mod stand;
mod street;
mod suspension;
mod swarm;
mod terrain;
mod thin_slabs;
mod tree;
mod venetian_blind;
mod walk;

pub use self::failure::{Failure, Symptom, failures};
use self::shapes::Sink;
use super::{AnyScene, LoadOptions, Part, Parts, Progress, Scene, SceneError};
use crate::geometry::Solid;

/// A parameter of a generator: a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GeneratorParam {
    /// As written in `generate:NAME?name=value`.
    pub name: &'static str,
    /// What it is if it is not given.
    pub default: u64,
    /// Least value.
    pub min: u64,
    /// Greatest value.
    pub max: u64,
    /// One line.
    pub meaning: &'static str,
}

impl GeneratorParam {
    /// Words that stand for its numbers, from the least on; empty if it has none.
    pub fn words(&self) -> &'static [&'static str] {
        if self.name == failure::CASES.0 { failure::CASES.1 } else { &[] }
    }
    /// A value as it is written.
    pub fn written(&self, value: u64) -> String {
        let word = self.words().get((value - self.min) as usize);
        word.map_or_else(|| value.to_string(), |word| (*word).to_owned())
    }
    /// The number that a text stands for, if it is one of its values.
    fn read(&self, text: &str) -> Option<u64> {
        let word = self.words().iter().position(|word| *word == text);
        let number = word.map(|at| self.min + at as u64).or_else(|| text.replace('_', "").parse().ok());
        number.filter(|n| (self.min..=self.max).contains(n))
    }
    /// What its value has to be, after `must be`.
    fn wanted(&self) -> String {
        match self.words() {
            [] => format!("a whole number from {} to {}", self.min, self.max),
            words => format!("one of {}", words.join(", ")),
        }
    }
}

/// A scene that is made by rule.
#[derive(Clone, Copy, Debug)]
pub struct Generator {
    /// As written in `generate:NAME`.
    pub name: &'static str,
    /// One line.
    pub meaning: &'static str,
    /// Its parameters.
    pub params: &'static [GeneratorParam],
    make: Make,
}

type Make = fn(&Values, &str, &LoadOptions, &dyn Progress) -> Result<Parts<Solid>, SceneError>;

/// Values of all parameters of a generator, in the order of its list.
struct Values {
    params: &'static [GeneratorParam],
    values: Vec<u64>,
}

impl Values {
    fn get(&self, name: &str) -> u64 {
        self.params.iter().position(|p| p.name == name).map_or(0, |i| self.values[i])
    }
}

static GENERATORS: &[Generator] = &[
    building::GENERATOR,
    city::GENERATOR,
    machine_room::GENERATOR,
    box_and_objects::GENERATOR,
    thin_slabs::GENERATOR,
    seminar_room::GENERATOR,
    cars::GENERATOR,
    forest::GENERATOR,
    swarm::GENERATOR,
    terrain::GENERATOR,
    lone_tree::GENERATOR,
    lone_tree::QUADRUPLING,
    molecule::GENERATOR,
    island::GENERATOR,
    venetian_blind::GENERATOR,
    bust::GENERATOR,
    suspension::GENERATOR,
    failure::GENERATOR,
];

/// All generators, by name.
pub fn generators() -> &'static [Generator] {
    GENERATORS
}

/// The scene that `generate:NAME[?key=value&…]` describes. `call` is what follows `generate:`.
pub(super) fn scene(
    call: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<AnyScene, SceneError> {
    let (generator, values, source) = understood(call)?;
    match failure::in_flatland(generator, &values, &source) {
        Some(parts) => Scene::new(parts).map(AnyScene::from),
        None => Scene::new(generate(call, options, progress)?).map(AnyScene::from),
    }
}

/// Makes the scene in space that a call describes.
pub(super) fn generate(
    call: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (generator, values, source) = understood(call)?;
    (generator.make)(&values, &source, options, &Part { whole: progress, start: 0.0, length: 0.95 })
}

/// Which generator a call names, with which values, and the whole call as it may be given again.
fn understood(call: &str) -> Result<(&'static Generator, Values, String), SceneError> {
    let fail = |why: String| SceneError::Format { path: format!("generate:{call}"), why };
    let (name, query) = call.split_once('?').unwrap_or((call, ""));
    let Some(generator) = GENERATORS.iter().find(|g| g.name == name) else {
        let known: Vec<&str> = GENERATORS.iter().map(|g| g.name).collect();
        return Err(fail(format!("there is no generator `{name}`; there are: {}", known.join(", "))));
    };
    let mut values =
        Values { params: generator.params, values: generator.params.iter().map(|p| p.default).collect() };
    for pair in query.split('&').filter(|p| !p.is_empty()) {
        let Some((key, value)) = pair.split_once('=') else {
            return Err(fail(format!("`{pair}` should read key=value")));
        };
        let Some(i) = generator.params.iter().position(|p| p.name == key) else {
            let known: Vec<&str> = generator.params.iter().map(|p| p.name).collect();
            return Err(fail(format!("`{name}` has no parameter `{key}`; it has: {}", known.join(", "))));
        };
        let param = &generator.params[i];
        let Some(number) = param.read(value) else {
            let (wanted, meaning) = (param.wanted(), param.meaning);
            return Err(fail(format!("`{key}` must be {wanted}, not `{value}` ({meaning})")));
        };
        values.values[i] = number;
    }
    let given: Vec<String> = generator
        .params
        .iter()
        .zip(&values.values)
        .map(|(p, v)| format!("{}={}", p.name, p.written(*v)))
        .collect();
    let source = format!("generate:{name}?{}", given.join("&"));
    Ok((generator, values, source))
}

/// Finest detail; a ball then has 131,072 triangles.
const MAX_DETAIL: u32 = 64;

/// The least detail at which `furnish` makes as many triangles as the budget allows for, or the finest.
fn detail_for(
    budget: u64,
    source: &str,
    progress: &dyn Progress,
    furnish: impl Fn(&mut Sink, u32),
) -> Result<u32, SceneError> {
    for detail in 1..MAX_DETAIL {
        progress.report(0.1, "planning");
        if progress.cancelled() {
            return Err(SceneError::Cancelled(source.to_owned()));
        }
        let mut count = Sink::counting();
        furnish(&mut count, detail);
        if count.triangles >= budget {
            return Ok(detail);
        }
    }
    Ok(MAX_DETAIL)
}
