//! What a film says, over every method, parameter, scene and space:
//!
//! - each line of pseudocode that the parameters have is reached in some frame, no other one ever is, and
//!   each event stands at a line that the method's card lists for its kind;
//! - each verdict but `partial` rests on evidence about the thing itself, its object, or a node around it,
//!   and what is hidden, outside or turned away rests on evidence that claims just that;
//! - sentences are sentences, and name one thing in the singular.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use cullscope::drawing::Subject;
use cullscope::geometry::{Aabb, Flat, NodeId, ObjectId, Solid, Space, Vector, View, ViewPath};
use cullscope::method::{Card, Claim, Event, Film, Verdict};
use cullscope::scene::{Parts, Scene, framing_view};
use glam::{vec2, vec3};

use super::{World, flat_scenes, ready, settings, solid_scenes, views};

/// Faults by what they are, with their number and the first one.
#[derive(Default)]
struct Faults(BTreeMap<String, (usize, String)>);

impl Faults {
    fn add(&mut self, what: String, example: impl FnOnce() -> String) {
        self.0.entry(what).and_modify(|(count, _)| *count += 1).or_insert_with(|| (1, example()));
    }
}

/// What was heard of a method.
#[derive(Default)]
struct Heard {
    /// Verdicts other than `partial`, and those of them that rest on evidence.
    verdicts: usize,
    founded: usize,
    /// Lines that belong to some parameters, and those of them that were reached with these.
    lines: usize,
    reached: usize,
}

/// The name by which a card lists an event; `None` if it stands anywhere.
fn stand<S: Space>(film: &dyn Film<S>, at: usize) -> Option<String> {
    match film.events()[at] {
        Event::Noted(_) => Some(film.kind(at).to_owned()),
        event @ (Event::DecidedNode(..) | Event::DecidedPrim(..)) => {
            Some(format!("{} {}", event.kind(), event.verdict()?.name()))
        }
        _ => None,
    }
}

fn label(card: &Card, line: Option<u8>) -> &'static str {
    line.map_or("no line", |line| card.code[usize::from(line)].label)
}

/// Lines and events of a film against the card.
fn hear_lines<S: Space>(film: &dyn Film<S>, what: &str, reached: &mut BTreeSet<u8>, faults: &mut Faults) {
    let card = film.card();
    let mut current = None;
    for (at, event) in film.events().iter().enumerate() {
        if let Event::Line(line) = *event {
            current = Some(line);
            reached.insert(line);
            if !film.has_line(line) {
                let fault =
                    format!("{} {what}: reaches {}, which it has not", card.key, label(card, current));
                faults.add(fault, || format!("event {at}"));
            }
        }
        let Some(kind) = stand(film, at) else { continue };
        let here = label(card, current);
        let listed = card.stands.iter().find(|(k, _)| *k == kind).map_or(&[][..], |(_, lines)| lines);
        if !listed.contains(&here) {
            let fault = format!("{}: {kind} stands at {here}", card.key);
            faults.add(fault, || format!("{what}, event {at}: {}", film.sentence(at)));
        }
    }
}

/// Whether a node holds a thing: it is the node, lies below it, or is a primitive of it.
fn holds<S: Space>(film: &dyn Film<S>, node: NodeId, subject: Subject) -> bool {
    let index = film.hierarchy();
    match subject {
        Subject::Node(n) => std::iter::successors(Some(n), |n| index.parent(*n)).any(|n| n == node),
        Subject::Prim(p) => index.prims(node).contains(&p),
        _ => false,
    }
}

/// Verdicts of a film against their evidence.
fn hear_evidence<S: Space>(film: &dyn Film<S>, what: &str, heard: &mut Heard, faults: &mut Faults) {
    let key = film.card().key;
    for (at, event) in film.events().iter().enumerate() {
        let Some(verdict) = event.verdict().filter(|v| *v != Verdict::Partial) else { continue };
        heard.verdicts += 1;
        let subject = film.subject(at);
        let mut fault = |text: &str| {
            let kind = format!("{key}: {} {} {text}", event.kind(), verdict.name());
            faults.add(kind, || format!("{what}, event {at}: {}", film.sentence(at)));
        };
        let Some(evidence) = film.evidence_of(at) else {
            fault("rests on nothing");
            continue;
        };
        let fits = match (film.subject(evidence), subject) {
            (about, subject) if about == subject => true,
            (Subject::Object(object), Subject::Prim(p)) => film.scene().object_of(p) == object,
            (Subject::Node(node), subject) => holds(film, node, subject),
            _ => false,
        };
        let claims = match verdict {
            Verdict::Hidden => matches!(film.claim(evidence), Some(Claim::Hidden)),
            Verdict::Outside => matches!(film.claim(evidence), Some(Claim::Outside { .. })),
            Verdict::FacesAway => matches!(film.claim(evidence), Some(Claim::FacesAway { .. })),
            _ => true,
        };
        match (fits, claims) {
            (true, true) => heard.founded += 1,
            (false, _) => fault(&format!("rests on a {} about something else", film.kind(evidence))),
            (true, false) => fault(&format!("rests on a {} that does not claim it", film.kind(evidence))),
        }
    }
}

/// What sentences count.
const COUNTED: &str = "cell frame tile unit node cube segment triangle primitive polygon occluder plane \
                       line pixel edge tick message object reference ray region processor renderer part \
                       step level";

/// Why a text is no good sentence, if it is none.
fn misspoken(text: &str) -> Option<&'static str> {
    let chars: Vec<char> = text.chars().collect();
    if !chars.first().is_some_and(|c| c.is_uppercase() || c.is_numeric()) || !text.ends_with(['.', '!', '?'])
    {
        return Some("begins small or ends open");
    }
    if text.contains("  ") || ["NaN", "inf "].iter().any(|hole| text.contains(hole)) {
        return Some("has a hole in it");
    }
    if chars.windows(3).any(|c| c[0] == '.' && c[1] == ' ' && c[2].is_lowercase()) {
        return Some("goes on in lower case");
    }
    let words: Vec<&str> = text.split(|c: char| c.is_whitespace() || ".,:;()".contains(c)).collect();
    // What is counted, not what is numbered, as in "node 1 cuts".
    let counted = |word: &str| {
        ["boxes", "others", "pieces"].contains(&word)
            || word.strip_suffix('s').is_some_and(|one| COUNTED.split(' ').any(|w| w == one))
    };
    if words.windows(2).any(|pair| pair[0] == "1" && counted(pair[1])) {
        return Some("has one thing in the plural");
    }
    None
}

fn hear_sentences<S: Space>(film: &dyn Film<S>, what: &str, faults: &mut Faults) {
    for at in 0..film.events().len() {
        if matches!(film.events()[at], Event::Line(_)) {
            continue;
        }
        let text = film.sentence(at);
        if let Some(why) = misspoken(&text) {
            faults.add(format!("{}: {} {why}", film.card().key, film.kind(at)), || format!("{what}: {text}"));
        }
    }
}

fn what_is_said_is_true<S: World>(scenes: &[Arc<Scene<S>>]) {
    let (mut faults, mut table) = (Faults::default(), Vec::new());
    for entry in S::methods() {
        let (card, mut heard) = (entry.card(), Heard::default());
        for settings in settings(*entry) {
            let set: Vec<_> = settings.0.iter().map(|(key, value)| format!("{key}={value}")).collect();
            let set = set.join(" ");
            let (mut reached, mut has) = (BTreeSet::new(), BTreeSet::new());
            for (nth, scene) in scenes.iter().enumerate() {
                let mut run = ready(*entry, scene, &settings);
                let what = format!("{set} on {}", scene.name());
                let mut views = views(scene, 1);
                // Once more the same, when all that it shows is known.
                views.insert(1, views[0]);
                // Away from all of it, so that the root is outside.
                let mut away = framing_view(&scene.bounds(), 96, 96);
                away.eye.target = away.eye.position * 2.0 - away.eye.target;
                views.push(away);
                // So far away that it lies between the pixels' centers, before and after it was seen.
                let mut far = framing_view(&scene.bounds(), 96, 96);
                let toward = far.eye.target - far.eye.position;
                far.eye.position = far.eye.target - toward * 2000.0;
                far.eye.far *= 4000.0;
                views.insert(0, far);
                views.push(far);
                // More regions of the screen than a simulated machine has renderers, before anything is known
                // to be visible.
                if nth == 0 {
                    let wide = framing_view(&scene.bounds(), 700, 300);
                    views.insert(1, View { height: wide.height.min(300), ..wide });
                }
                for view in views {
                    let film = run.record(&view, usize::MAX).film;
                    has.extend((0..card.code.len() as u8).filter(|&line| film.has_line(line)));
                    hear_lines(&*film, &set, &mut reached, &mut faults);
                    hear_evidence(&*film, &what, &mut heard, &mut faults);
                    // Sentences take long: of the smaller scenes, those with the defaults, all else by turns.
                    if scene.live().len() < 200 && (set.is_empty() || nth % 3 == 0) {
                        hear_sentences(&*film, &what, &mut faults);
                    }
                }
            }
            heard.lines += has.len();
            heard.reached += has.intersection(&reached).count();
            for &line in has.difference(&reached) {
                let fault = format!("{}: {} is never reached", card.key, label(card, Some(line)));
                faults.add(fault, || format!("with {set:?}"));
            }
        }
        table.push(format!(
            "{} in {}: {} of {} verdicts rest on evidence, {} of {} lines are reached",
            card.key,
            S::NAME,
            heard.founded,
            heard.verdicts,
            heard.reached,
            heard.lines
        ));
    }
    println!("{}", table.join("\n"));
    let list: Vec<_> =
        faults.0.iter().map(|(what, (count, example))| format!("{what}: {count}, {example}")).collect();
    assert!(list.is_empty(), "{} kinds of faults:\n{}", list.len(), list.join("\n"));
}

/// A wall of two polygons, bent along a vertical edge, that hides a small object only as a whole, and what
/// makes the scene large; seen from in front of the wall. From there the left polygon looks larger, from the
/// object the right one.
fn behind_a_bent_wall() -> Arc<Scene<Solid>> {
    let mut points = [[-30.0, 0.0], [0.0, 2.0], [10.0, 0.0]]
        .into_iter()
        .flat_map(|[x, z]| [-10.0, 10.0].map(|y| vec3(x, y, z)))
        .collect::<Vec<_>>();
    let mut prims = vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]];
    // The object's corners, and four faces on them.
    points.extend([[-0.5, 0.0], [0.5, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|[x, y]| vec3(x, y, -5.0 - y)));
    prims.extend([[6, 7, 8], [6, 7, 9], [6, 8, 9], [7, 8, 9]]);
    points.extend([vec3(-30.0, -30.0, -60.0), vec3(30.0, -30.0, -60.0), vec3(0.0, 40.0, -60.0)]);
    prims.push([10, 11, 12]);
    bent_wall(points, prims, [2, 2, 4, 1], vec3(0.0, 0.0, 20.0))
}

/// The same in flatland.
fn behind_a_bent_line() -> Arc<Scene<Flat>> {
    let mut points = vec![vec2(-30.0, 0.0), vec2(0.0, 2.0), vec2(10.0, 0.0)];
    points.extend([[-0.5, 0.0], [0.0, 0.5], [0.5, 0.0], [0.0, -0.5]].map(|[x, y]| vec2(x, y - 5.0)));
    points.extend([vec2(-30.0, -60.0), vec2(30.0, -60.0)]);
    let prims = vec![[0, 1], [1, 2], [3, 4], [4, 5], [5, 6], [6, 3], [7, 8]];
    bent_wall(points, prims, [1, 1, 4, 1], vec2(0.0, 20.0))
}

/// The halves of the wall, the object and the rest, so many primitives of each, from an eye that looks at the
/// origin.
fn bent_wall<S: Space>(
    points: Vec<S::Vector>,
    prims: Vec<S::Corners>,
    [left, right, object, rest]: [usize; 4],
    eye: S::Vector,
) -> Arc<Scene<S>> {
    let mut parts = Parts::simple("behind a bent wall", points, prims);
    let objects = [(0, left + right), (1, object), (2, rest)];
    parts.prim_object = objects.into_iter().flat_map(|(id, n)| vec![ObjectId(id); n]).collect();
    parts.objects = vec![parts.objects[0].clone(); objects.len()];
    let mut view = framing_view(&Aabb::of(parts.points.iter().copied()), 96, 96);
    (view.eye.position, view.eye.target) = (eye, S::Vector::default());
    (view.eye.near, view.eye.far) = (0.1, 200.0);
    parts.paths = vec![ViewPath::single(view)];
    Arc::new(Scene::new(parts).expect("a valid scene"))
}

/// A scene that no occluder hides any of: there is nothing else, and the eye sees it from its edge.
fn alone<S: Space>(prim: S::Corners) -> Arc<Scene<S>> {
    let corner = |k: usize| S::Vector::from_fn(|a| if a == k { 1.0 } else { 0.25 });
    let points: Vec<_> = (0..S::CORNERS).map(corner).collect();
    let mut parts = Parts::simple("alone", points.clone(), vec![prim]);
    let mut view = framing_view(&Aabb::of(points.iter().copied()), 96, 96);
    (view.eye.position, view.eye.target) = (points[0] + (points[0] - points[1]) * 4.0, points[0]);
    (view.eye.near, view.eye.far) = (0.1, 100.0);
    parts.paths = vec![ViewPath::single(view)];
    Arc::new(Scene::new(parts).expect("a valid scene"))
}

#[test]
fn what_is_said_is_true_in_flatland() {
    let mut scenes = flat_scenes();
    scenes.extend([behind_a_bent_line(), alone([0, 1])]);
    what_is_said_is_true(&scenes);
}
#[test]
fn what_is_said_is_true_in_space() {
    let mut scenes = solid_scenes();
    scenes.extend([behind_a_bent_wall(), alone([0, 1, 2])]);
    what_is_said_is_true(&scenes);
}
