//! The objects of a scene as a list: what became of each at a step, searched and sorted.

use super::stage::{SceneFacts, Staged};
use crate::geometry::{ObjectId, PrimId};
use crate::method::Verdict;
use crate::trace::State as Known;

/// An object at a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectRow {
    /// Which.
    pub id: ObjectId,
    /// Its primitives.
    pub prims: usize,
    /// Those of them that are drawn.
    pub drawn: usize,
    /// Those that are left out as hidden.
    pub hidden: usize,
    /// Those that are outside the view or turned away.
    pub outside: usize,
    /// Those of which nothing is known yet.
    pub open: usize,
}

impl ObjectRow {
    /// What it is as a whole, and a verdict with the same mark; of what is not decided none.
    pub fn state(&self) -> (&'static str, Option<Verdict>) {
        match *self {
            Self { prims, drawn, .. } if drawn == prims => ("drawn", Some(Verdict::Visible)),
            Self { drawn: 1.., .. } => ("partly drawn", Some(Verdict::Partial)),
            Self { open: 1.., .. } => ("not decided", None),
            Self { prims, outside, .. } if outside == prims => ("outside", Some(Verdict::Outside)),
            Self { prims, outside, hidden, .. } if outside + hidden == prims => {
                ("hidden", Some(Verdict::Hidden))
            }
            _ => ("left out", Some(Verdict::Approximated)),
        }
    }
}

/// What objects are sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum By {
    /// Their names.
    #[default]
    Name,
    /// How many primitives they have, the most first.
    Size,
    /// Which share of them is drawn, the most first.
    Drawn,
}

impl By {
    /// Every one, in the order of the list.
    pub const ALL: [By; 3] = [By::Name, By::Size, By::Drawn];
    /// Its title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Name => "name",
            Self::Size => "size",
            Self::Drawn => "share drawn",
        }
    }
}

/// Which objects are listed, and in which order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// What their names hold; all if empty.
    pub text: String,
    /// What they are sorted by.
    pub by: By,
    /// Whether the last come first.
    pub is_reversed: bool,
}

/// The objects that have live primitives, at a step. O(primitives).
pub fn objects(stage: &dyn Staged, step: usize) -> Vec<ObjectRow> {
    let (scene, Some(film)) = (stage.scene(), stage.film()) else { return vec![] };
    let empty = |id| ObjectRow { id: ObjectId(id), prims: 0, drawn: 0, hidden: 0, outside: 0, open: 0 };
    let mut rows: Vec<ObjectRow> = (0..scene.object_count() as u32).map(empty).collect();
    let prims = (0..film.stamps.prims().len() as u32).map(PrimId);
    for prim in prims.filter(|&prim| scene.has_prim(prim)) {
        let row = &mut rows[scene.object_of(prim).at()];
        row.prims += 1;
        match film.stamps.prim(prim, step) {
            Known::Decided(Verdict::Visible) => row.drawn += 1,
            Known::Decided(Verdict::Hidden | Verdict::Presumed) => row.hidden += 1,
            Known::Decided(Verdict::Outside | Verdict::FacesAway) => row.outside += 1,
            Known::Decided(_) => {}
            Known::Unseen | Known::Open => row.open += 1,
        }
    }
    rows.retain(|row| row.prims > 0);
    rows
}

/// The name of an object, or its number.
pub fn object_title(scene: &dyn SceneFacts, object: ObjectId) -> String {
    match scene.object_name(object) {
        "" => format!("object {object}"),
        name => name.to_owned(),
    }
}

/// A name as it is sorted: `door_9` before `door_10`.
fn sorted_as(name: &str) -> String {
    let (mut key, mut digits) = (String::new(), String::new());
    for c in name.chars().chain(['\0']) {
        if c.is_ascii_digit() {
            digits.push(c);
            continue;
        }
        if !digits.is_empty() {
            key += &format!("{:0>20}", std::mem::take(&mut digits));
        }
        key.push(c);
    }
    key
}

/// Where in `rows` those stand that are listed, in the order of the list.
pub fn listed(rows: &[ObjectRow], scene: &dyn SceneFacts, listing: &Listing) -> Vec<u32> {
    let wanted = listing.text.trim().to_lowercase();
    let named =
        rows.iter().enumerate().map(|(i, row)| (object_title(scene, row.id).to_lowercase(), i as u32));
    let mut found: Vec<(String, u32)> =
        named.filter(|(name, _)| name.contains(&wanted)).map(|(name, i)| (sorted_as(&name), i)).collect();
    let row = |i: u32| &rows[i as usize];
    // Shares are compared as products, so that they are exact.
    let drawn = |a: &ObjectRow, b: &ObjectRow| (b.drawn * a.prims).cmp(&(a.drawn * b.prims));
    found.sort_by(|(a_name, a), (b_name, b)| {
        let first = match listing.by {
            By::Name => std::cmp::Ordering::Equal,
            By::Size => row(*b).prims.cmp(&row(*a).prims),
            By::Drawn => drawn(row(*a), row(*b)),
        };
        first.then_with(|| a_name.cmp(b_name)).then(a.cmp(b))
    });
    if listing.is_reversed {
        found.reverse();
    }
    found.into_iter().map(|(_, i)| i).collect()
}

#[cfg(test)]
mod tests {
    use super::super::command::Action;
    use super::super::tests::opened_with as opened;
    use super::*;

    /// At every step the rows together are the counts of the legend, and a whole says what its parts are.
    #[test]
    fn the_list_counts_what_the_film_decided() {
        let state = opened("freedoom_e1m1", "large-occluders");
        let (stage, film) = (state.staged().expect("a stage"), state.film().expect("a film"));
        let mut states = std::collections::BTreeSet::new();
        for step in (0..=state.len()).step_by(97).chain([state.len()]) {
            let (rows, counts) = (objects(stage, step), film.stamps.counts(step));
            let sum = |of: fn(&ObjectRow) -> usize| rows.iter().map(of).sum::<usize>();
            assert_eq!(sum(|r| r.prims), stage.scene().live_count());
            assert_eq!(sum(|r| r.drawn), counts.of(Verdict::Visible), "step {step}");
            assert_eq!(sum(|r| r.hidden), counts.of(Verdict::Hidden), "step {step}");
            assert_eq!(sum(|r| r.outside), counts.of(Verdict::Outside), "step {step}");
            assert_eq!(sum(|r| r.open), counts.undecided, "step {step}");
            states.extend(rows.iter().map(|row| row.state().0));
        }
        assert_eq!(
            states.into_iter().collect::<Vec<_>>(),
            ["drawn", "hidden", "not decided", "outside", "partly drawn"]
        );
    }

    #[test]
    fn the_list_is_searched_and_sorted() {
        let mut state = opened("freedoom_e1m1", "frustum");
        state.apply(Action::Last);
        let stage = state.staged().expect("a stage");
        let rows = objects(stage, state.step);
        let list = |text: &str, by, is_reversed| {
            let listing = Listing { text: text.into(), by, is_reversed };
            let order = listed(&rows, stage.scene(), &listing);
            order.into_iter().map(|i| rows[i as usize]).collect::<Vec<_>>()
        };
        let all = list("", By::Size, false);
        assert!(all.len() == rows.len() && all.windows(2).all(|w| w[0].prims >= w[1].prims));
        assert!(list("", By::Size, true).windows(2).all(|w| w[0].prims <= w[1].prims));
        let share = |row: &ObjectRow| row.drawn as f64 / row.prims as f64;
        let drawn = list("", By::Drawn, false);
        assert!(drawn.windows(2).all(|w| share(&w[0]) >= share(&w[1])) && share(&drawn[0]) == 1.0);
        let name = object_title(stage.scene(), all[0].id);
        let found = list(&name.to_uppercase(), By::Name, false);
        assert!(found.contains(&all[0]) && found.len() < rows.len());
        let doors = list("door_", By::Name, false);
        let number =
            |row: &ObjectRow| object_title(stage.scene(), row.id)[5..].parse::<u32>().expect("a number");
        assert!(doors.len() > 5 && doors.windows(2).all(|w| number(&w[0]) < number(&w[1])));
        assert!(list("no object is called so", By::Name, false).is_empty());
    }
}
