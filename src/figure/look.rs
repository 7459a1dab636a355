//! A step of a film as marks in the world: primitives and nodes by state, the Eye, the evidence.

use glam::Vec3;

use crate::drawing::{Drawing, Item, Layer, Mark, Role, Subject};
use crate::geometry::{Aabb, Frustum, NodeId, PrimId, Solid, Space, Vector, View};
use crate::index::Hierarchy;
use crate::method::{Film, Verdict};
use crate::scene::{Scene, framing_view};
use crate::trace::{Stamps, State};

/// What is shown of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The primitives, by state.
    pub prims: bool,
    /// The boxes of the nodes that were entered, by state.
    pub nodes: bool,
    /// The Eye and its frustum.
    pub eye: bool,
    /// The evidence of the current event.
    pub evidence: bool,
    /// What is marked as selected.
    pub selected: Subject,
    /// What is marked as the thing that the step is about, if the evidence does not mark it.
    pub current: Subject,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            prims: true,
            nodes: true,
            eye: true,
            evidence: true,
            selected: Subject::None,
            current: Subject::None,
        }
    }
}

/// What a state looks like.
pub fn role_of(state: State) -> Role {
    match state {
        State::Unseen => Role::Scene,
        State::Open | State::Decided(Verdict::Partial) => Role::Partial,
        State::Decided(Verdict::Outside) => Role::Outside,
        State::Decided(Verdict::FacesAway) => Role::FacesAway,
        State::Decided(Verdict::Hidden) => Role::Hidden,
        State::Decided(Verdict::Visible) => Role::Visible,
        State::Decided(Verdict::Presumed | Verdict::Approximated | Verdict::OverBudget) => Role::Approximated,
    }
}

/// Draws step `step` of a film in world coordinates.
pub fn world<S: Space>(film: &dyn Film<S>, stamps: &Stamps, step: usize, look: &Look) -> Drawing<S::Vector> {
    let mut to = Drawing::default();
    let scene = film.scene();
    if look.eye {
        eye(film, &mut to);
    }
    if look.prims {
        for &prim in scene.live() {
            let points: Vec<_> = scene.prim_points(prim).collect();
            let role = role_of(stamps.prim(prim, step));
            if points.len() > 2 {
                to.push(Layer::Scene, role, Subject::Prim(prim), Mark::Area(points));
                continue;
            }
            for points in strokes(scene, prim, points) {
                to.push(Layer::Scene, role, Subject::Prim(prim), Mark::Line { points, closed: false });
            }
        }
    }
    if look.nodes && film.hierarchy().node_count() > 1 {
        nodes(film.hierarchy(), stamps, step, &mut to);
    }
    if look.evidence {
        let from = to.items.len();
        film.explain(step, &mut to);
        if S::Vector::AXES == 2 {
            // A line cannot show two things side by side: occluders lie under the verdicts, as their rims.
            let under = |i: &&mut Item<_>| {
                i.role == Role::Occluder
                    && i.layer == Layer::Evidence
                    && matches!(i.subject, Subject::Prim(_))
            };
            to.items[from..].iter_mut().filter(under).for_each(|i| i.layer = Layer::Areas);
        }
    }
    // Evidence marks what it compares; what the sentence is about may be another thing.
    if !to.items.iter().any(|i| i.role == Role::Current && i.subject == look.current) {
        emphasized(film, look.current, Role::Current, &mut to);
    }
    emphasized(film, look.selected, Role::Selected, &mut to);
    to
}

/// A segment as it is drawn: glass, as in floor plans, by two lines on both sides of it.
fn strokes<S: Space>(scene: &Scene<S>, prim: PrimId, ends: Vec<S::Vector>) -> Vec<Vec<S::Vector>> {
    if !scene.is_see_through(prim) {
        return vec![ends];
    }
    let along = ends[1] - ends[0];
    let off = GLASS * scene.bounds().diagonal() / along.length().max(f32::MIN_POSITIVE);
    let aside = S::Vector::from_fn(|a| if a == 0 { -along.get(1) } else { along.get(0) }) * off;
    [1.0, -1.0].map(|side| ends.iter().map(|end| *end + aside * side).collect()).to_vec()
}

/// Distance of the two lines of a pane from its middle, of the scene's diagonal.
const GLASS: f32 = 0.005;

/// Boxes of the nodes entered so far. In flatland a node decided as a whole is filled; the boxes of
/// its parents are outlines.
fn nodes<S: Space>(hierarchy: &dyn Hierarchy<S>, stamps: &Stamps, step: usize, to: &mut Drawing<S::Vector>) {
    for id in (0..hierarchy.node_count() as u32).map(NodeId) {
        if stamps.entered(id) as usize > step {
            continue;
        }
        let (state, bounds) = (stamps.node(id, step), hierarchy.bounds(id));
        let role = role_of(state);
        let decided = matches!(state, State::Decided(v) if v != Verdict::Partial);
        let edges = hierarchy.edges(id);
        if decided && S::Vector::AXES == 2 {
            let corners = edges.map_or_else(
                || [0, 1, 3, 2].map(|i| bounds.corner(i)).to_vec(),
                |edges| edges.iter().map(|e| e[0]).collect(),
            );
            to.push(Layer::Areas, role, Subject::Node(id), Mark::Area(corners));
        } else if let Some(edges) = edges {
            edges.into_iter().for_each(|edge| to.line(Layer::Nodes, role, Subject::Node(id), edge));
        } else {
            to.bounds(Layer::Nodes, role, Subject::Node(id), &bounds);
        }
    }
}

fn eye<S: Space>(film: &dyn Film<S>, to: &mut Drawing<S::Vector>) {
    let view = film.view();
    let corners = Frustum::corners(&view.projection(), view.eye.near, view.eye.far);
    let rim = corners.len() / 2;
    for plane in [&corners[..rim], &corners[rim..]] {
        to.push(
            Layer::Frustum,
            Role::Eye,
            Subject::Eye,
            Mark::Line { points: plane.to_vec(), closed: rim > 2 },
        );
    }
    for i in 0..rim {
        to.line(Layer::Frustum, Role::Eye, Subject::Eye, [view.eye.position, corners[rim + i]]);
    }
    let ahead = view.eye.position + view.eye.forward() * ((view.eye.far - view.eye.near) * 0.06);
    to.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Arrow(view.eye.position, ahead));
    to.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Dot { at: view.eye.position, radius_pt: 4.0 });
}

/// An observer who looks down on a scene of space from outside, all of it in view; `aspect` is width over
/// height.
pub fn observer_above(scene: &Scene<Solid>, aspect: f32) -> View<Solid> {
    let height = 720;
    let mut view = framing_view::<Solid>(&scene.bounds(), (height as f32 * aspect) as u32, height);
    // Steeper than the framing view: a floor plan is read from above.
    let center = scene.bounds().center();
    let distance = (view.eye.position - center).length();
    view.eye.position = center + Vec3::new(0.35, 0.85, 0.55).normalize() * distance * 0.95;
    view.eye.near = distance * 0.01;
    view
}

fn emphasized<S: Space>(film: &dyn Film<S>, subject: Subject, role: Role, to: &mut Drawing<S::Vector>) {
    let scene = film.scene();
    let mut outline = |prim| {
        let points: Vec<_> = scene.prim_points(prim).collect();
        let closed = points.len() > 2;
        to.push(Layer::Emphasis, role, Subject::Prim(prim), Mark::Line { points, closed });
    };
    match subject {
        Subject::Prim(prim) if prim.at() < scene.prim_count() => outline(prim),
        // In space the outlines of all its triangles would be a web.
        Subject::Object(object) if S::Vector::AXES == 3 => {
            let prims = scene.live().iter().filter(|&&p| scene.object_of(p) == object);
            let around =
                prims.fold(Aabb::empty(), |all: Aabb<S::Vector>, &p| all.union(scene.prim_bounds(p)));
            if !around.is_empty() {
                to.bounds(Layer::Emphasis, role, subject, &around);
            }
        }
        Subject::Object(object) => {
            scene.live().iter().filter(|&&p| scene.object_of(p) == object).for_each(|&p| outline(p))
        }
        Subject::Node(node) if node.at() < film.hierarchy().node_count() => {
            to.bounds(Layer::Emphasis, role, subject, &film.hierarchy().bounds(node));
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::Methods;
    use crate::geometry::Flat;
    use crate::method::Settings;
    use crate::scene::{Quiet, samples};

    #[test]
    fn every_step_marks_once_what_it_is_about() {
        let scene = samples::soup::<Flat>(7, 60);
        let mut run = Flat::method("frustum")
            .expect("a method")
            .ready(&scene, &Settings::default(), &Quiet)
            .expect("ok")
            .expect("ok");
        let film = run.record(&framing_view(&scene.bounds(), 64, 1), usize::MAX).film;
        let stamps = Stamps::new(&*film);
        for step in 1..=film.events().len() {
            let current = film.subject(step - 1);
            if current == Subject::None {
                continue;
            }
            let marked = |look: &Look| {
                let is_it = |i: &&Item<_>| i.role == Role::Current && i.subject == current;
                world(&*film, &stamps, step, look).items.iter().filter(is_it).count()
            };
            assert_eq!(
                marked(&Look { current, ..Look::default() }),
                1,
                "once, whether by the evidence or not, at step {step}"
            );
            assert_eq!(marked(&Look { current, evidence: false, ..Look::default() }), 1, "step {step}");
            assert_eq!(marked(&Look { evidence: false, ..Look::default() }), 0, "step {step}");
        }
    }
}
