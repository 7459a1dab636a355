//! The legend: the states that a film has, in words and with counts at the step; the same on screen and in
//! figures.

use super::state::State;
use crate::drawing::Role;
use crate::drawing::words::count;
use crate::figure::role_of;
use crate::method::Verdict;
use crate::trace::{Counts, State as Known};

/// States that the legend names, with their words.
const STATES: [(Role, &str); 10] = [
    (Role::Scene, "not decided"),
    (Role::Partial, "open, partly in view"),
    (Role::Visible, "drawn"),
    (Role::Outside, "outside"),
    (Role::FacesAway, "faces away"),
    (Role::Hidden, "hidden"),
    (Role::Approximated, "left out or replaced"),
    (Role::Occluder, "occluder"),
    (Role::Current, "this step"),
    (Role::Selected, "selected"),
];

impl State {
    /// The roles in the order in which they are named, with words and counts of primitives.
    pub fn legend(&self) -> Vec<(Role, String)> {
        self.states(true)
    }
    /// The same with or without counts.
    pub(super) fn states(&self, is_counted: bool) -> Vec<(Role, String)> {
        let Some(stage) = self.staged() else { return vec![] };
        let counts = |step| self.film().map_or(Counts::default(), |f| f.stamps.counts(step));
        let (end, here) = (counts(self.len()), counts(self.step));
        let shown = stage.evidence_roles(self.step);
        let entry = |(role, words): (Role, &str)| {
            let verdicts: Vec<Verdict> = Counts::VERDICTS
                .into_iter()
                .filter(|&v| v != Verdict::Partial && role_of(Known::Decided(v)) == role)
                .collect();
            let total: usize = verdicts.iter().map(|&v| end.of(v)).sum();
            // A state that never occurs here would only be noise.
            let is_noise =
                !verdicts.is_empty() && total == 0 && !matches!(role, Role::Visible | Role::Outside);
            if is_noise || role == Role::Occluder && !shown.contains(&role) {
                return None;
            }
            let now: usize = verdicts.iter().map(|&v| here.of(v)).sum();
            // Where nothing else is left out, it is named as what it is.
            let is_presumed = total > 0 && role == Role::Approximated && total == end.of(Verdict::Presumed);
            let words = if is_presumed { "presumed hidden" } else { words };
            Some((
                role,
                match role {
                    _ if !is_counted => words.to_owned(),
                    Role::Scene => format!("{words} {}", count(here.undecided)),
                    _ if verdicts.is_empty() => words.to_owned(),
                    _ => format!("{words} {}", count(now)),
                },
            ))
        };
        let unshown = self.unshown_words().map(|words| (Role::Paper, words));
        STATES.into_iter().filter_map(entry).chain(unshown).collect()
    }
}
