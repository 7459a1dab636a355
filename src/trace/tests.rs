//! Stamps and moves against naive folds, on films of real runs.

use std::sync::Arc;

use super::*;
use crate::culling::Methods;
use crate::geometry::{Flat, NodeId, Solid, Space};
use crate::method::{Event, Film, Settings, Verdict};
use crate::scene::{Quiet, framing_view, samples};

fn film<S: Methods>(method: &str, seed: u64, n: u32, settings: &[(&str, &str)]) -> Arc<dyn Film<S>> {
    let scene = samples::soup::<S>(seed, n);
    let mut view = framing_view::<S>(&scene.bounds(), 64, 64);
    // Stand in the middle, so that some is behind the eye.
    let ahead = view.eye.forward();
    view.eye.position = scene.bounds().center();
    view.eye.target = view.eye.position + ahead;
    view.eye.near = 0.1;
    let settings = Settings::of(settings);
    let entry = S::method(method).expect("a method");
    let mut run = entry.ready(&scene, &settings, &Quiet).expect("good settings").expect("not cancelled");
    run.record(&view, usize::MAX).film
}

/// Verdicts of all primitives at a step, by going through the events one by one.
fn fold<S: Space>(film: &dyn Film<S>, step: usize) -> Vec<Option<Verdict>> {
    let mut prims = vec![None; film.scene().prim_count()];
    for event in &film.events()[..step] {
        match *event {
            Event::DecidedNode(n, v) if v != Verdict::Partial => {
                film.hierarchy().prims(n).iter().for_each(|p| _ = prims[p.at()].get_or_insert(v));
            }
            Event::DecidedPrim(p, v) => _ = prims[p.at()].get_or_insert(v),
            _ => {}
        }
    }
    prims
}

fn stamps_equal_the_fold<S: Methods>(method: &str, settings: &[(&str, &str)]) {
    let film = film::<S>(method, 4, 120, settings);
    let stamps = Stamps::new(&*film);
    for step in 0..=film.events().len() {
        let fold = fold(&*film, step);
        for &p in film.scene().live() {
            let told = match stamps.prim(p, step) {
                State::Decided(v) => Some(v),
                _ => None,
            };
            assert_eq!(told, fold[p.at()], "{method}: primitive {p} at step {step}");
        }
        let counts = stamps.counts(step);
        for v in Counts::VERDICTS {
            assert_eq!(
                counts.of(v),
                fold.iter().flatten().filter(|f| **f == v).count(),
                "{method}: {v:?} at step {step}"
            );
        }
        assert_eq!(counts.undecided, fold.iter().filter(|f| f.is_none()).count());
        let entered = film.events()[..step].iter().filter(|e| matches!(e, Event::Entered(_))).count();
        assert_eq!(counts.nodes_entered, entered);
        for node in (0..film.hierarchy().node_count() as u32).map(NodeId) {
            let was_entered = film.events()[..step].contains(&Event::Entered(node));
            assert_eq!(stamps.node(node, step) != State::Unseen, was_entered, "node {node} at step {step}");
        }
    }
    let end = stamps.counts(film.events().len());
    assert_eq!(end.undecided, 0, "{method} decides everything");
}

#[test]
fn stamps_equal_a_naive_fold_at_every_step() {
    for method in ["z-buffer", "frustum", "centroid"] {
        for backfaces in ["true", "false"] {
            stamps_equal_the_fold::<Flat>(method, &[("backface-culling", backfaces)]);
            stamps_equal_the_fold::<Solid>(method, &[("backface-culling", backfaces)]);
        }
    }
}

#[test]
fn back_undoes_forward_at_every_step() {
    let film = film::<Solid>("frustum", 5, 300, &[]);
    let (events, moves) = (film.events(), Moves::new(film.events()));
    for detail in [Detail::Full, Detail::Coarse] {
        let (mut step, mut stops) = (0, vec![0]);
        while step < events.len() {
            step = moves.forward(events, step, detail);
            stops.push(step);
        }
        for pair in stops.windows(2) {
            assert!(pair[0] < pair[1]);
            assert_eq!(moves.back(events, pair[1], detail), pair[0], "{detail:?} back from {}", pair[1]);
        }
        assert_eq!(moves.back(events, 0, detail), 0);
    }
    let lines = events.iter().filter(|e| matches!(e, Event::Line(_))).count();
    assert!(lines > 10, "coarse steps have something to pass over");
}

#[test]
fn over_passes_a_subtree_and_out_leaves_it() {
    let film = film::<Flat>("frustum", 6, 200, &[]);
    let (events, moves) = (film.events(), Moves::new(film.events()));
    for (i, event) in events.iter().enumerate() {
        let Event::Entered(node) = *event else { continue };
        let left = events.iter().position(|e| *e == Event::Left(node)).expect("every node is left");
        assert_eq!(moves.over(events, i, Detail::Full), left + 1, "over node {node}");
        assert_eq!(moves.over(events, i + 1, Detail::Full), left + 1, "over the rest of node {node}");
        assert_eq!(moves.back_over(events, left + 1, Detail::Full), i, "back over node {node}");
        assert_eq!(moves.out(events, i + 1), left + 1, "out of node {node}");
        assert_eq!(moves.back_out(events, i + 1), i);
        assert_eq!(moves.stack(events, i + 1).last(), Some(&node));
        assert_eq!(moves.stack(events, i + 1).len(), moves.depth(i) + 1);
        assert_eq!(moves.stack(events, i + 1).len(), film.hierarchy().level(node) as usize + 1);
    }
    assert_eq!(moves.over(events, 0, Detail::Full), 1, "the frame begins");
    assert_eq!(moves.out(events, events.len()), events.len());
}

#[test]
fn verdicts_are_found_forwards_and_backwards() {
    let film = film::<Flat>("frustum", 7, 200, &[]);
    let (events, moves) = (film.events(), Moves::new(film.events()));
    let mut forwards = Vec::new();
    let mut step = 0;
    while let Some(next) = moves.next(events, step, Moves::is_verdict) {
        forwards.push(next);
        step = next;
    }
    let mut backwards = vec![step];
    while let Some(previous) = moves.previous(events, step, Moves::is_verdict) {
        backwards.push(previous);
        step = previous;
    }
    backwards.reverse();
    assert_eq!(forwards, backwards);
    assert!(forwards.len() > 3 && forwards.iter().all(|&s| Moves::is_verdict(&events[s - 1])));
}

#[test]
fn the_line_is_the_last_one_reached() {
    let film = film::<Solid>("frustum", 8, 100, &[("backface-culling", "true")]);
    let (events, moves) = (film.events(), Moves::new(film.events()));
    let mut last = None;
    for (i, event) in events.iter().enumerate() {
        assert_eq!(moves.line(events, i), last);
        if let Event::Line(l) = event {
            last = Some(*l);
            assert!((*l as usize) < film.card().code.len());
        }
    }
}

#[test]
fn a_capped_film_says_so_and_can_be_stepped() {
    let scene = samples::soup::<Flat>(9, 200);
    let view = framing_view::<Flat>(&scene.bounds(), 64, 1);
    let mut run = Flat::method("frustum")
        .expect("a method")
        .ready(&scene, &Settings::default(), &Quiet)
        .expect("ok")
        .expect("ok");
    let whole = run.record(&view, usize::MAX);
    let capped = run.record(&view, 7);
    assert_eq!(capped.film.events(), &whole.film.events()[..7]);
    assert_eq!(capped.film.lost() as usize, whole.film.events().len() - 7);
    assert_eq!(capped.list, whole.list, "the answer does not depend on the film");
    let moves = Moves::new(capped.film.events());
    assert_eq!(moves.out(capped.film.events(), 2), 7, "an open node ends with the film");
    Stamps::new(&*capped.film);
}
