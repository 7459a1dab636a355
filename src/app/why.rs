//! Why a thing has the state it has, read from the film alone.

use super::stage::{Reading, SceneFacts, Staged};
use crate::drawing::Subject;
use crate::geometry::{NodeId, PrimId};
use crate::method::{Event, Verdict};

/// A sentence of an explanation, with the step that shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Because {
    /// What happened.
    pub text: String,
    /// Where to see it.
    pub step: Option<usize>,
}

fn because(text: impl Into<String>, step: Option<usize>) -> Because {
    Because { text: text.into(), step }
}

/// Why `subject` has the state it has at `step`: the conclusion first, then the evidence.
pub fn why(stage: &dyn Staged, subject: Subject, step: usize) -> Vec<Because> {
    let Some(film) = stage.film() else { return vec![] };
    match subject {
        Subject::Node(node) if node.at() < film.node_count() => why_node(stage, film, node, step),
        Subject::Prim(prim) if stage.scene().has_prim(prim) => why_prim(stage, film, prim, step),
        Subject::Object(object) => vec![because(
            format!(
                "“{}” is an object; select one of its parts to see why.",
                stage.scene().object_name(object)
            ),
            None,
        )],
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
        Some((at, verdict)) if at > step => {
            vec![because(
                format!("At step {step} nothing is known of {name} yet. It will be {}.", spoken(verdict)),
                Some(at),
            )]
        }
        Some((at, verdict)) => {
            let mut lines =
                vec![because(format!("The {name} is {} since step {at}.", spoken(verdict)), Some(at))];
            match film.reel.events()[at - 1] {
                Event::DecidedNode(node, _) => {
                    lines.push(because(
                        format!(
                            "It lies in node {node}, which was decided as a whole, with {} others.",
                            stage.prims_below(node).saturating_sub(1)
                        ),
                        Some(at),
                    ));
                    lines.extend(evidence(film, at));
                }
                _ => lines.extend(evidence(film, at)),
            }
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
            return vec![because(text, Some(at))];
        }
        let mut lines =
            vec![because(format!("Node {node} is {} since step {at}.", spoken(verdict)), Some(at))];
        lines.extend(evidence(film, at));
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
            lines.extend(evidence(film, at));
            lines
        }
        Some((n, at, verdict)) => vec![because(
            format!("Node {node} will not be visited: node {n} above it will be {}.", spoken(verdict)),
            Some(at),
        )],
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
fn evidence(film: Reading<'_>, at: usize) -> Vec<Because> {
    let decision = at - 1;
    let noted = film.reel.evidence_of(decision);
    noted.into_iter().chain([decision]).map(|i| because(film.reel.sentence(i), Some(i + 1))).collect()
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
