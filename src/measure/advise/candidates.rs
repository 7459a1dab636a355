//! What could be tried of a method: its own defaults, and each parameter by itself at other values.

use crate::measure::experiment::World;
use crate::measure::sweep::Configuration;
use crate::method::{Budget, Entry, KnobValue, Settings, is_of_surfaces};

/// Shares of the primitives that are tried as budgets.
const BUDGETS: [f32; 4] = [1.0, 5.0, 20.0, 50.0];
/// What is tried where 0 means that the method chooses.
const CHOSEN: [u32; 3] = [4, 32, 256];

/// A method with its defaults.
pub fn defaults<S: World>(entry: &dyn Entry<S>) -> Configuration {
    Configuration { method: entry.card().key.to_owned(), settings: Settings::default() }
}

/// Each parameter of a method by itself at other values than its default; not those that say what is drawn
/// (surfaces), and not seeds, which choose between equals.
pub fn variations<S: World>(entry: &dyn Entry<S>) -> Vec<Configuration> {
    let knobs = entry.knobs(&Settings::default()).unwrap_or_default();
    let mut all = Vec::new();
    for (knob, value) in knobs {
        if is_of_surfaces(&knob) || knob.name == "seed" {
            continue;
        }
        for word in others(&value) {
            let settings = Settings::of(&[(knob.name, &word)]);
            // Some values do not go with the defaults of others.
            if entry.knobs(&settings).is_ok() {
                all.push(Configuration { method: entry.card().key.to_owned(), settings });
            }
        }
    }
    all
}

/// Other values of a parameter: numbers half and twice as large, and four times; all other words.
fn others(value: &KnobValue) -> Vec<String> {
    match value {
        KnobValue::Integer(v, range) => {
            let all = if *v == 0 { CHOSEN } else { [v / 2, v.saturating_mul(2), v.saturating_mul(4)] };
            let mut all = all.map(|n| n.clamp(*range.start(), *range.end())).to_vec();
            all.dedup();
            all.into_iter().filter(|n| n != v).map(|n| n.to_string()).collect()
        }
        KnobValue::Real(v, range) => {
            let (low, high) = (*range.start(), *range.end());
            // Up to an end that is near, in equal steps; else by factors.
            let all = if *v == 0.0 {
                [0.1, 0.5, 2.0]
            } else if low > 0.0 && *v < 4.0 * low {
                [low, (low + v) * 0.5, v * 2.0]
            } else {
                [v * 0.5, v * 2.0, v * 4.0]
            };
            let mut all = all.map(|n| n.clamp(low, high)).to_vec();
            all.dedup();
            all.into_iter().filter(|n| n != v).map(|n| n.to_string()).collect()
        }
        KnobValue::Switch(is_on) => vec![(!is_on).to_string()],
        KnobValue::Budget(budget) => {
            let others = BUDGETS.map(Budget::Percent);
            others.into_iter().filter(|b| b != budget).map(|b| b.to_string()).collect()
        }
        KnobValue::Choice(at, options) => {
            let others = options.iter().enumerate().filter(|(k, _)| k != at);
            others.map(|(_, word)| (*word).to_owned()).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::Methods;
    use crate::geometry::Solid;

    #[test]
    fn other_values_stay_in_their_range() {
        assert_eq!(others(&KnobValue::Integer(8, 1..=24)), ["4", "16", "24"]);
        assert_eq!(others(&KnobValue::Integer(1, 1..=1)), Vec::<String>::new());
        assert_eq!(others(&KnobValue::Integer(0, 0..=100)), ["4", "32", "100"]);
        assert_eq!(others(&KnobValue::Real(1.0, 0.5..=1.0)), ["0.5", "0.75"]);
        assert_eq!(others(&KnobValue::Real(1.0, 0.0..=256.0)), ["0.5", "2", "4"]);
        assert_eq!(others(&KnobValue::Switch(true)), ["false"]);
        assert_eq!(others(&KnobValue::Budget(Budget::Percent(5.0))), ["1%", "20%", "50%"]);
        assert_eq!(others(&KnobValue::Choice(1, &["a", "b", "c"])), ["a", "c"]);
    }

    /// Whatever a method declares is tried, and everything that is tried can be run.
    #[test]
    fn all_methods_have_candidates_that_fit() {
        let mut count = 0;
        for entry in Solid::methods() {
            let all = variations::<Solid>(*entry);
            assert!(all.iter().all(|one| one.check::<Solid>().is_ok() && one.settings.0.len() == 1));
            assert!(all.iter().all(|one| !one.settings.0.contains_key("backface-culling")));
            count += all.len();
        }
        assert!(count > 80, "{count}");
    }
}
