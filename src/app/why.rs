//! Why a thing has the state it has, read from the film alone.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::stage::{Reading, SceneFacts, Staged};
use crate::drawing::Subject;
use crate::drawing::words::count;
use crate::geometry::{NodeId, ObjectId, PrimId};
use crate::method::{Event, Value, Verdict, surfaces_of};

/// A sentence of an explanation, with the step that shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Because {
    /// What happened.
    pub text: String,
    /// Where to see it.
    pub step: Option<usize>,
    /// What hides it: an object if it has a name, else a primitive; with how it is called.
    pub by: Option<(Subject, String)>,
}

fn because(text: impl Into<String>, step: Option<usize>) -> Because {
    Because { text: text.into(), step, by: None }
}

/// Ways in which an object ended that are told one by one.
const WAYS: usize = 8;

/// Why `subject` has the state it has at `step`: the conclusion first, then the evidence.
pub fn why(stage: &dyn Staged, subject: Subject, step: usize) -> Vec<Because> {
    let Some(film) = stage.film() else { return vec![] };
    match subject {
        Subject::Node(node) if node.at() < film.node_count() => why_node(stage, film, node, step),
        Subject::Prim(prim) if stage.scene().has_prim(prim) => why_prim(stage, film, prim, step),
        Subject::Object(object) => why_object(stage, film, object, step),
        Subject::Eye => vec![because(
            "This is the Eye: what culling sees with. Drag it, and the frame is culled again.",
            None,
        )],
        Subject::Plane(_) => vec![because(
            "This is a plane of the view frustum. What lies wholly behind one plane cannot be in view.",
            None,
        )],
        _ => vec![],
    }
}

/// An object is as its primitives are: how many have which state, then for what reasons, the commonest first.
fn why_object(stage: &dyn Staged, film: Reading<'_>, object: ObjectId, step: usize) -> Vec<Because> {
    let scene = stage.scene();
    let prims = scene.prims_of(object);
    // By verdict and what it rests on: how many, and the first such step.
    let mut ways = Ways::new();
    let (mut by_verdict, mut open) = (BTreeMap::<Verdict, (usize, BTreeSet<String>)>::new(), 0);
    for &prim in &prims {
        let decision = film.stamps.prim_decision(prim);
        open += usize::from(decision.is_none_or(|(at, _)| at > step));
        let Some((at, verdict)) = decision else { continue };
        if at <= step {
            by_verdict.entry(verdict).or_default().0 += 1;
        }
        let ground = film.reel.evidence_of(at - 1);
        // Without evidence, a node decided as a whole is a reason and each primitive by itself is none.
        let ground =
            ground.or_else(|| matches!(film.reel.events()[at - 1], Event::DecidedNode(..)).then_some(at - 1));
        let way = ways.entry((verdict, ground.unwrap_or(usize::MAX))).or_insert((0, at));
        (way.0, way.1) = (way.0 + 1, way.1.min(at));
    }
    for (&(verdict, ground), (_, first)) in &ways {
        if let Some(told) = by_verdict.get_mut(&verdict).filter(|_| *first <= step && is_hidden(verdict)) {
            told.1.extend(hider(scene, film, ground).map(|(_, name)| name));
        }
    }
    let told = |(verdict, (n, by)): (&Verdict, &(usize, BTreeSet<String>))| {
        let by = if by.is_empty() { String::new() } else { format!(" by {}", few(by)) };
        format!("{} {}{by}", count(*n), spoken(*verdict))
    };
    let mut states: Vec<String> = by_verdict.iter().map(told).collect();
    states.extend((open > 0).then(|| format!("{} not decided at this step", count(open))));
    let holds = counted(prims.len(), scene.prim_name());
    let mut lines =
        vec![because(format!("{} holds {holds}: {}.", called(scene, object), states.join(", ")), None)];
    reasons(scene, film, ways, &mut lines);
    lines.extend(see_through(scene, film, &prims));
    lines
}

/// What it means that some of these primitives are see-through.
fn see_through(scene: &dyn SceneFacts, film: Reading<'_>, prims: &[PrimId]) -> Option<Because> {
    let n = prims.iter().filter(|p| scene.is_see_through(**p)).count();
    let who = match (n, prims.len()) {
        (0, _) => return None,
        (n, all) if n == all => "It is".to_owned(),
        (n, _) => format!("{} of it {}", counted(n, scene.prim_name()), if n == 1 { "is" } else { "are" }),
    };
    let what = if surfaces_of(film.reel.knobs()).solid {
        "taken as opaque in this run (see-through=solid)"
    } else {
        "drawn over what is behind, hidden by what is opaque alone, and hiding nothing"
    };
    Some(because(format!("{who} see-through: {what}."), None))
}

/// How many primitives of an object ended with a verdict for a reason, and the first step of it; by verdict
/// and the event that is the reason.
type Ways = BTreeMap<(Verdict, usize), (usize, usize)>;

/// The ways in which the primitives of an object ended, the commonest first.
fn reasons(scene: &dyn SceneFacts, film: Reading<'_>, ways: Ways, lines: &mut Vec<Because>) {
    let mut ways: Vec<_> = ways.into_iter().collect();
    ways.sort_by_key(|(_, (n, at))| (Reverse(*n), *at));
    let events = film.reel.events();
    for ((verdict, ground), (n, at)) in ways.iter().take(WAYS) {
        let place = match events[at - 1] {
            Event::DecidedNode(node, _) => format!(" with node {node}"),
            _ => String::new(),
        };
        let reason = if *ground < events.len() { film.reel.sentence(*ground) } else { String::new() };
        let text = format!("{} {}{place}, at step {at}. {reason}", count(*n), spoken(*verdict));
        let by = is_hidden(*verdict).then(|| hider(scene, film, *ground)).flatten();
        lines.push(Because { by, ..because(text.trim_end(), Some(*at)) });
    }
    let more: usize = ways.iter().skip(WAYS).map(|(_, (n, _))| n).sum();
    if more > 0 {
        lines.push(because(format!("{} more for {} other reasons.", count(more), ways.len() - WAYS), None));
    }
}

/// Whether something hides what has this verdict.
fn is_hidden(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Hidden | Verdict::Presumed)
}

/// What the evidence `at` says hides the thing, if it names one.
fn hider(scene: &dyn SceneFacts, film: Reading<'_>, at: usize) -> Option<(Subject, String)> {
    if at >= film.reel.events().len() {
        return None;
    }
    let fields = film.reel.fields(at).1;
    let prim = fields.iter().find_map(|f| match f.value {
        Value::Integer(id) if f.name == "occluder_prim" => u32::try_from(id).ok().map(PrimId),
        _ => None,
    })?;
    let object = scene.has_prim(prim).then(|| scene.object_of(prim))?;
    Some(match scene.object_name(object) {
        "" => (Subject::Prim(prim), format!("{} {prim}", scene.prim_name())),
        name => (Subject::Object(object), name.to_owned()),
    })
}

/// An object by its name, or by its number.
fn called(scene: &dyn SceneFacts, object: ObjectId) -> String {
    match scene.object_name(object) {
        "" => format!("Object {object}"),
        name => format!("“{name}”"),
    }
}

/// Some names, and how many more there are.
fn few(names: &BTreeSet<String>) -> String {
    const FEW: usize = 3;
    let mut text = names.iter().take(FEW).cloned().collect::<Vec<_>>().join(" and ");
    if names.len() > FEW {
        text += &format!(" and {} more", names.len() - FEW);
    }
    text
}

fn counted(n: usize, what: &str) -> String {
    format!("{} {what}{}", count(n), if n == 1 { "" } else { "s" })
}

fn name(scene: &dyn SceneFacts, prim: PrimId) -> String {
    let object = scene.object_name(scene.object_of(prim));
    let of = if object.is_empty() { String::new() } else { format!(" of {object}") };
    format!("{} {prim}{of}", scene.prim_name())
}

fn why_prim(stage: &dyn Staged, film: Reading<'_>, prim: PrimId, step: usize) -> Vec<Because> {
    let name = name(stage.scene(), prim);
    match film.stamps.prim_decision(prim) {
        None if film.reel.lost() > 0 => vec![because(
            format!("Nothing is known of {name}: the film is capped and ends before it was decided."),
            None,
        )],
        None => vec![because(
            format!("Nothing was ever said about {name}: this method does not look at it."),
            None,
        )],
        Some((at, verdict)) => {
            let text = if at > step {
                format!("At step {step} nothing is known of {name} yet. It will be {}.", spoken(verdict))
            } else {
                format!("The {name} is {} since step {at}.", spoken(verdict))
            };
            let mut lines = vec![because(text, Some(at))];
            match film.reel.events()[at - 1] {
                Event::DecidedNode(node, _) => {
                    lines.push(because(
                        format!(
                            "It lies in node {node}, which was decided as a whole, with {} others.",
                            stage.prims_below(node).saturating_sub(1)
                        ),
                        Some(at),
                    ));
                    lines.extend(evidence(stage.scene(), film, at));
                }
                _ => lines.extend(evidence(stage.scene(), film, at)),
            }
            lines.extend(see_through(stage.scene(), film, &[prim]));
            lines
        }
    }
}

fn why_node(stage: &dyn Staged, film: Reading<'_>, node: NodeId, step: usize) -> Vec<Because> {
    if let Some((at, verdict)) = film.stamps.node_decision(node) {
        if at > step {
            let text = match film.stamps.entered_at(node) {
                Some(entered) if entered <= step => {
                    format!(
                        "Node {node} was entered at step {entered} and is not decided yet. It will be {}.",
                        spoken(verdict)
                    )
                }
                _ => format!(
                    "At step {step} node {node} has not been reached yet. It will be {}.",
                    spoken(verdict)
                ),
            };
            let mut lines = vec![because(text, Some(at))];
            lines.extend(evidence(stage.scene(), film, at));
            return lines;
        }
        let mut lines =
            vec![because(format!("Node {node} is {} since step {at}.", spoken(verdict)), Some(at))];
        lines.extend(evidence(stage.scene(), film, at));
        return lines;
    }
    // Not decided itself: some node above it was.
    let above = std::iter::successors(stage.parent(node), |&n| stage.parent(n)).find_map(|n| {
        let (at, verdict) = film.stamps.node_decision(n)?;
        (verdict != Verdict::Partial).then_some((n, at, verdict))
    });
    match above {
        Some((n, at, verdict)) if at <= step => {
            let mut lines = vec![because(
                format!(
                    "Node {node} was never visited: node {n} above it is {} as a whole since step {at}.",
                    spoken(verdict)
                ),
                Some(at),
            )];
            lines.extend(evidence(stage.scene(), film, at));
            lines
        }
        Some((n, at, verdict)) => {
            let text =
                format!("Node {node} will not be visited: node {n} above it will be {}.", spoken(verdict));
            let mut lines = vec![because(text, Some(at))];
            lines.extend(evidence(stage.scene(), film, at));
            lines
        }
        None if film.stamps.entered_at(node).is_some_and(|e| e <= step) => {
            vec![because(
                format!("Node {node} was entered; nothing was decided about it as a whole."),
                film.stamps.entered_at(node),
            )]
        }
        None => vec![because(format!("This method says nothing about node {node}."), None)],
    }
}

/// The evidence of the decision that is event `at − 1`, and the decision itself.
fn evidence(scene: &dyn SceneFacts, film: Reading<'_>, at: usize) -> Vec<Because> {
    let decision = at - 1;
    let noted = film.reel.evidence_of(decision);
    let hides = film.reel.events()[decision].verdict().is_some_and(is_hidden);
    let told = |i| {
        let by = hides.then(|| hider(scene, film, i)).flatten();
        Because { by, ..because(film.reel.sentence(i), Some(i + 1)) }
    };
    noted.into_iter().chain([decision]).map(told).collect()
}

/// A verdict in a sentence.
pub fn spoken(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Outside => "outside the view",
        Verdict::FacesAway => "turned away from the eye",
        Verdict::Hidden => "hidden",
        Verdict::Presumed => "left out as hidden, which is not proven",
        Verdict::Partial => "partly in view",
        Verdict::Visible => "drawn",
        Verdict::Approximated => "replaced by a stand-in",
        Verdict::OverBudget => "left out, the budget being spent",
    }
}
