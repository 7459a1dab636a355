//! Why a thing ends with the state it has, read from the film alone.
//!
//! The reasons are about the whole film, whatever step is looked at, so that they stay while one follows
//! them; only what is said first is about a step.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::hidden_by::named;
use super::stage::{HiddenBy, Reading, SceneFacts, Staged};
use crate::drawing::Subject;
use crate::drawing::words::count;
use crate::geometry::{NodeId, ObjectId, PrimId};
use crate::method::{Event, Verdict, surfaces_of};

/// A sentence of an explanation, with the step that shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Because {
    /// What happened.
    pub text: String,
    /// Where to see it.
    pub step: Option<usize>,
    /// What hides it: objects that have a name, else primitives; with how they are called.
    pub by: Vec<(Subject, String)>,
}

fn because(text: impl Into<String>, step: Option<usize>) -> Because {
    Because { text: text.into(), step, by: vec![] }
}

/// Ways in which an object ended that are told one by one.
const WAYS: usize = 8;

/// Why a thing ends as it does. Made once for a film and a thing: it may take a pass over the scene.
#[derive(Clone, Debug, Default)]
pub struct Why {
    /// The film that it was found in, and the thing.
    of: Option<(u64, Subject)>,
    /// The primitives of an object.
    prims: Vec<PrimId>,
    /// By verdict: the earliest step at which a primitive has it that something named hides, and its name.
    names: Vec<(Verdict, usize, String)>,
    reasons: Vec<Because>,
}

impl Why {
    /// Finds out about a thing.
    pub fn of(stage: &dyn Staged, subject: Subject) -> Self {
        let Some(film) = stage.film() else { return Self::default() };
        let mut why = Self { of: Some((film.serial, subject)), ..Self::default() };
        match subject {
            Subject::Node(node) if node.at() < film.node_count() => why.reasons = of_node(stage, film, node),
            Subject::Prim(prim) if stage.scene().has_prim(prim) => why.reasons = of_prim(stage, film, prim),
            Subject::Object(object) => why.find_object(stage, film, object),
            Subject::Eye => why.reasons.push(because(
                "This is the Eye: what culling sees with. Drag it, and the frame is culled again.",
                None,
            )),
            Subject::Plane(_) => why.reasons.push(because(
                "This is a plane of the view frustum. What lies wholly behind one plane cannot be in view.",
                None,
            )),
            _ => {}
        }
        why
    }
    /// Whether it is about this thing in the film that is on stage.
    pub(super) fn is_of(&self, stage: Option<&dyn Staged>, subject: Subject) -> bool {
        self.of == stage.and_then(|s| s.film()).map(|film| (film.serial, subject))
    }
    /// The reasons, what decided first.
    pub fn reasons(&self) -> &[Because] {
        &self.reasons
    }
    /// The step that decided it; of an object most of it.
    pub fn decided(&self, stage: &dyn Staged) -> Option<usize> {
        let known = self.standing(stage, usize::MAX).and_then(|known| known.step);
        known.or_else(|| self.reasons.iter().find_map(|reason| reason.step))
    }
    /// What is known at a step; `None` of what has no state.
    pub fn standing(&self, stage: &dyn Staged, step: usize) -> Option<Because> {
        let (film, scene) = (stage.film()?, stage.scene());
        match self.of?.1 {
            Subject::Node(node) if node.at() < film.node_count() => {
                Some(node_standing(stage, film, node, step))
            }
            Subject::Prim(prim) if scene.has_prim(prim) => Some(prim_standing(scene, film, prim, step)),
            Subject::Object(_) => Some(self.object_standing(scene, film, step)),
            _ => None,
        }
    }
    /// An object is as its primitives are: how many have which state, and by what those are hidden that are.
    fn object_standing(&self, scene: &dyn SceneFacts, film: Reading<'_>, step: usize) -> Because {
        let (mut by_verdict, mut open) = (BTreeMap::<Verdict, usize>::new(), 0);
        for &prim in &self.prims {
            match film.stamps.prim_decision(prim).filter(|(at, _)| *at <= step) {
                Some((_, verdict)) => *by_verdict.entry(verdict).or_default() += 1,
                None => open += 1,
            }
        }
        let told = |(&verdict, n): (&Verdict, &usize)| {
            let is_it = |known: &&(Verdict, usize, String)| known.0 == verdict && known.1 <= step;
            let names: Vec<&str> = self.names.iter().filter(is_it).map(|known| known.2.as_str()).collect();
            let by = if names.is_empty() { String::new() } else { format!(" by {}", few(&names)) };
            format!("{} {}{by}", count(*n), spoken(verdict))
        };
        let mut states: Vec<String> = by_verdict.iter().map(told).collect();
        states.extend((open > 0).then(|| format!("{} not decided at this step", count(open))));
        let holds = counted(self.prims.len(), scene.prim_name());
        because(format!("{holds}: {}.", states.join(", ")), None)
    }

    /// The ways in which the primitives of an object ended, the commonest first.
    fn find_object(&mut self, stage: &dyn Staged, film: Reading<'_>, object: ObjectId) {
        self.prims = stage.scene().prims_of(object);
        let events = film.reel.events();
        // By verdict and what it rests on.
        let mut ways = BTreeMap::<(Verdict, usize), Way>::new();
        for &prim in &self.prims {
            let Some((at, verdict)) = film.stamps.prim_decision(prim) else { continue };
            let ground = film.reel.evidence_of(at - 1);
            // Without evidence, a node decided as a whole is a reason and each primitive by itself is none.
            let ground =
                ground.or_else(|| matches!(events[at - 1], Event::DecidedNode(..)).then_some(at - 1));
            let way = ways.entry((verdict, ground.unwrap_or(usize::MAX))).or_default();
            way.first = if way.prims.is_empty() { at } else { way.first.min(at) };
            way.prims.push(prim);
        }
        let mut ways: Vec<_> = ways.into_iter().collect();
        ways.sort_by_key(|(_, way)| (Reverse(way.prims.len()), way.first));
        let left = ways.split_off(ways.len().min(WAYS));
        for ((verdict, ground), way) in ways {
            self.tell_way(stage, film, verdict, ground, &way);
        }
        let more: usize = left.iter().map(|(_, way)| way.prims.len()).sum();
        if more > 0 {
            let others = counted(left.len(), "other reason");
            self.reasons.push(because(format!("{} more for {others}.", count(more)), None));
        }
        self.reasons.extend(see_through(stage.scene(), film, &self.prims));
    }

    fn tell_way(
        &mut self,
        stage: &dyn Staged,
        film: Reading<'_>,
        verdict: Verdict,
        ground: usize,
        way: &Way,
    ) {
        let (events, at) = (film.reel.events(), way.first);
        let node = match events[at - 1] {
            Event::DecidedNode(node, _) => format!(" with node {node}"),
            _ => String::new(),
        };
        let HiddenBy { text, by, is_part } = hidden_by(stage, verdict, ground, &way.prims);
        for (_, name) in &by {
            match self.names.iter_mut().find(|known| known.0 == verdict && known.2 == *name) {
                Some(known) => known.1 = known.1.min(at),
                None => self.names.push((verdict, at, name.clone())),
            }
        }
        let mut names: Vec<&str> = by.iter().map(|(_, name)| name.as_str()).collect();
        names.extend(is_part.then_some("others"));
        let names = if by.is_empty() { String::new() } else { format!(" by {}", few(&names)) };
        let reason = if ground < events.len() { film.reel.sentence(ground) } else { String::new() };
        let (n, state) = (count(way.prims.len()), spoken(verdict));
        let said = format!("{n} {state}{node}{names}, at step {}. {reason} {text}", count(at));
        self.reasons.push(Because { by, ..because(said.trim_end(), Some(at)) });
    }
}

/// How some primitives of an object ended, and the first step of it.
#[derive(Default)]
struct Way {
    prims: Vec<PrimId>,
    first: usize,
}

/// Why `subject` has the state it has at `step`: what is known first, then the reasons.
pub fn why(stage: &dyn Staged, subject: Subject, step: usize) -> Vec<Because> {
    let why = Why::of(stage, subject);
    why.standing(stage, step).into_iter().chain(why.reasons).collect()
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

/// What hides primitives that were left out on a ground; nothing of those that are not hidden.
fn hidden_by(stage: &dyn Staged, verdict: Verdict, ground: usize, prims: &[PrimId]) -> HiddenBy {
    let is_hidden = matches!(verdict, Verdict::Hidden | Verdict::Presumed);
    let is_known = stage.film().is_some_and(|film| ground < film.reel.events().len());
    if is_hidden && is_known {
        stage.hidden_by(ground, prims).unwrap_or_default()
    } else {
        HiddenBy::default()
    }
}

/// Some names, and how many more there are.
fn few(names: &[&str]) -> String {
    const FEW: usize = 3;
    let (told, rest) = names.split_at(names.len().min(FEW));
    match (told, rest.len()) {
        ([one], 0) => (*one).to_owned(),
        ([all @ .., last], 0) => format!("{} and {last}", all.join(", ")),
        (_, more) => format!("{} and {} more", told.join(", "), count(more)),
    }
}

fn counted(n: usize, what: &str) -> String {
    format!("{} {what}{}", count(n), if n == 1 { "" } else { "s" })
}

fn prim_standing(scene: &dyn SceneFacts, film: Reading<'_>, prim: PrimId, step: usize) -> Because {
    let name = named(scene, prim);
    match film.stamps.prim_decision(prim) {
        None if film.reel.lost() > 0 => because(
            format!("Nothing is known of {name}: the film is capped and ends before it was decided."),
            None,
        ),
        None => {
            because(format!("Nothing was ever said about {name}: this method does not look at it."), None)
        }
        Some((at, verdict)) => {
            let state = spoken(verdict);
            let text = if at > step {
                format!("At step {} nothing is known of {name} yet. It will be {state}.", count(step))
            } else {
                format!("The {name} is {state} since step {}.", count(at))
            };
            because(text, Some(at))
        }
    }
}

fn of_prim(stage: &dyn Staged, film: Reading<'_>, prim: PrimId) -> Vec<Because> {
    let Some((at, _)) = film.stamps.prim_decision(prim) else { return vec![] };
    let mut lines = evidence(stage, film, at, &[prim]);
    if let Event::DecidedNode(node, _) = film.reel.events()[at - 1] {
        let others = count(stage.prims_below(node).saturating_sub(1));
        let text = format!("It lies in node {node}, which was decided as a whole, with {others} others.");
        lines.push(because(text, Some(at)));
    }
    lines.extend(see_through(stage.scene(), film, &[prim]));
    lines
}

/// The decision that holds for a node: its own, or that of a node above it.
fn decision_of(stage: &dyn Staged, film: Reading<'_>, node: NodeId) -> Option<(NodeId, usize, Verdict)> {
    if let Some((at, verdict)) = film.stamps.node_decision(node) {
        return Some((node, at, verdict));
    }
    std::iter::successors(stage.parent(node), |&n| stage.parent(n)).find_map(|n| {
        let (at, verdict) = film.stamps.node_decision(n)?;
        (verdict != Verdict::Partial).then_some((n, at, verdict))
    })
}

fn node_standing(stage: &dyn Staged, film: Reading<'_>, node: NodeId, step: usize) -> Because {
    let entered = film.stamps.entered_at(node).filter(|&entered| entered <= step);
    let Some((by, at, verdict)) = decision_of(stage, film, node) else {
        return match entered {
            Some(entered) => because(
                format!("Node {node} was entered; nothing was decided about it as a whole."),
                Some(entered),
            ),
            None => because(format!("This method says nothing about node {node}."), None),
        };
    };
    let state = spoken(verdict);
    let [now, since] = [step, at].map(count);
    let text = match (by == node, at <= step, entered.map(count)) {
        (true, true, _) => format!("Node {node} is {state} since step {since}."),
        (true, false, Some(entered)) => {
            format!("Node {node} was entered at step {entered} and is not decided yet. It will be {state}.")
        }
        (true, false, None) => {
            format!("At step {now} node {node} has not been reached yet. It will be {state}.")
        }
        (false, true, _) => format!(
            "Node {node} was never visited: node {by} above it is {state} as a whole since step {since}."
        ),
        (false, false, _) => {
            format!("Node {node} will not be visited: node {by} above it will be {state}.")
        }
    };
    because(text, Some(at))
}

fn of_node(stage: &dyn Staged, film: Reading<'_>, node: NodeId) -> Vec<Because> {
    let Some((by, at, _)) = decision_of(stage, film, node) else { return vec![] };
    // Those of its primitives that were decided with it.
    let with_it = |p: &PrimId| film.stamps.prim_decision(*p).is_some_and(|(step, _)| step == at);
    let prims: Vec<PrimId> = stage.prims_of_node(by).into_iter().filter(with_it).collect();
    let decided = because(film.reel.sentence(at - 1), Some(at));
    evidence(stage, film, at, &prims).into_iter().chain([decided]).collect()
}

/// The evidence of the decision that is event `at − 1`, which holds for `prims`, and what hides them.
fn evidence(stage: &dyn Staged, film: Reading<'_>, at: usize, prims: &[PrimId]) -> Vec<Because> {
    let decision = film.reel.events()[at - 1].verdict();
    let Some((ground, verdict)) = film.reel.evidence_of(at - 1).zip(decision) else { return vec![] };
    let HiddenBy { text, mut by, .. } = hidden_by(stage, verdict, ground, prims);
    let hiders = (!text.is_empty()).then(|| Because { by: std::mem::take(&mut by), ..because(text, None) });
    let decides = Because { by, ..because(film.reel.sentence(ground), Some(ground + 1)) };
    [decides].into_iter().chain(hiders).collect()
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
