//! What advice leaves out, gives up, keeps apart and counts.

use super::*;
use crate::culling::Methods;
use crate::geometry::{Flat, Solid};
use crate::scene::{Quiet, random_views, samples};

/// Counts down, and cancels at zero.
struct Countdown(std::sync::atomic::AtomicUsize);

impl Progress for Countdown {
    fn report(&self, _: f32, _: &'static str) {}
    fn cancelled(&self) -> bool {
        use std::sync::atomic::Ordering::Relaxed;
        self.0.fetch_update(Relaxed, Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

fn wish(most_wrong_percent: f64) -> Wish {
    Wish { most_wrong_percent, seed: 1 }
}

fn advised<S: World>(most_wrong_percent: f64) -> Advice {
    let scene = samples::soup::<S>(3, 60);
    let views = random_views(&scene, 24, 5);
    advise(&scene, &views, wish(most_wrong_percent), &Quiet).expect("advice")
}

fn promises<S: World>(one: &Configuration) -> bool {
    let entry = crate::measure::experiment::method::<S>(&one.method).expect("a method");
    entry.is_conservative(&one.settings).expect("settings fit")
}

/// Where nothing may be wrong nothing is tried that promises nothing, and all methods that can promise are.
fn only_promises_where_nothing_may_be_wrong<S: World>() {
    let advice = advised::<S>(0.0);
    assert!(advice.trials.iter().all(|trial| trial.promises && promises::<S>(&trial.configuration)));
    let could = |entry: &&&dyn crate::method::Entry<S>| {
        promises::<S>(&defaults::<S>(**entry)) || variations::<S>(**entry).iter().any(promises::<S>)
    };
    for entry in S::methods().iter().filter(could) {
        let key = entry.card().key;
        assert!(advice.trials.iter().any(|trial| trial.configuration.method == key), "{key}");
    }
    let all = S::methods().iter().flat_map(|m| [vec![defaults::<S>(*m)], variations::<S>(*m)].concat());
    let silent = |one: &Configuration| !promises::<S>(one);
    assert!(advice.left_out > 0 && advice.left_out <= all.filter(silent).count());
    // The advised one was compared with the truth, on both halves.
    assert_eq!(advice.trials[advice.chosen].wrong_percent, Some(0.0));
    assert_eq!((advice.unseen.wrong_percent, advice.unseen.worst_percent), (0.0, 0.0));
    assert!(advice.cost[0] < advice.cost[1], "{:?}", advice.cost);
}

#[test]
fn only_what_promises_is_tried_where_nothing_may_be_wrong() {
    only_promises_where_nothing_may_be_wrong::<Flat>();
    only_promises_where_nothing_may_be_wrong::<Solid>();
}

/// Where something may be wrong all methods are tried, and each is compared with the truth.
#[test]
fn all_methods_are_tried_where_something_may_be_wrong() {
    let advice = advised::<Solid>(0.01);
    assert_eq!(advice.left_out, 0);
    for entry in Solid::methods() {
        let plain = advice.trials.iter().find(|trial| trial.configuration == defaults::<Solid>(*entry));
        let plain = plain.expect("tried");
        assert!(plain.frames > 0 && (plain.promises || plain.wrong_percent.is_some()), "{plain:?}");
    }
    assert!(advice.unseen.wrong_percent <= 0.01);
    let wrong = advice.trials.iter().filter(|trial| trial.wrong_percent > Some(0.01));
    assert!(wrong.count() > 0, "some of it is not right enough");
}

/// The views that are chosen by are not those of the check, and the other seed's are the other way round.
#[test]
fn halves_of_the_path_are_kept_apart() {
    let scene = samples::soup::<Flat>(3, 20);
    let views = random_views(&scene, 40, 5);
    let halves = |is_odd_kept| {
        let mut course = Course::new(&scene, &views, is_odd_kept);
        [true, false].map(|are_seen| {
            let frames = Frames { are_seen, most: LONGEST };
            let plan = course.plan(frames);
            // The first of each stretch does not count.
            assert_eq!(course.count(frames), plan.iter().map(|some| some.len() - 1).sum::<usize>());
            let eyes = plan.iter().flatten().map(|(_, view)| format!("{:?}", view.eye));
            eyes.collect::<std::collections::BTreeSet<_>>()
        })
    };
    let [seen, unseen] = halves(false);
    assert!(seen.len() == 20 && unseen.len() == 20 && seen.is_disjoint(&unseen));
    assert_eq!(halves(true), [unseen, seen]);
    // A single view is looked at, after itself.
    let mut alone = Course::new(&scene, &views[..1], false);
    let frames = Frames { are_seen: true, most: 1 };
    assert_eq!((alone.count(frames), alone.plan(frames)[0].len()), (1, 2));
}

/// An index that takes too long is given up, which is said; being told to stop is something else.
#[test]
fn slow_indexes_are_given_up() {
    let scene = samples::soup::<Solid>(3, 2000);
    let views = random_views(&scene, 8, 5);
    let begun = || begin(&scene, &views, wish(0.0));
    let mut halving = begun();
    let one =
        defaults::<Solid>(crate::measure::experiment::method::<Solid>("hierarchical-z").expect("known"));
    assert!(matches!(halving.add(one.clone(), 0.0, &Quiet), Ok(None)));
    let given_up = &halving.trials[0];
    assert_eq!((given_up.index_bytes, given_up.time_ms), (None, f64::INFINITY));
    assert!(!halving.wish.is_met(&Trial { wrong_percent: Some(1.0), ..given_up.clone() }));
    let stopped = begun().add(one, f64::INFINITY, &Countdown(0.into()));
    assert!(matches!(stopped, Err(ExperimentError::Cancelled)), "{stopped:?}");
}
