//! Figures 10 and 12 of the paper: runs of the method in flatland, read from their films.

use std::sync::Arc;

use glam::Vec2;

use super::notes::{Test, chosen, tests};
use super::setting::draw_tangent;
use crate::culling::anatomy::{Blockers, Occlusion};
use crate::drawing::{Drawing, Font, Layer, Mark, Role, Subject};
use crate::figure::tools::{COLUMN_PT, LABEL_PT, Maker, NAME_PT, Plan, TWO_COLUMNS_PT, entry, eye};
use crate::figure::{Look, Panel, Paper, Swatch, panels, world};
use crate::geometry::{Aabb, Flat, NodeId, ObjectId, PrimId};
use crate::method::Film;
use crate::papers::keys::LARGE_OCCLUDERS;
use crate::scene::{Scene, SceneError, example};
use crate::trace::Stamps;

/// Figure 10 looks at two frames in a row.
fn two_frames(maker: &Maker<'_>) -> Result<[Arc<dyn Film<Flat>>; 2], SceneError> {
    let scene = example("two_viewpoints")?;
    let mut run = maker.ready(
        &scene,
        LARGE_OCCLUDERS,
        &[("occluders", "1"), ("tree-height", "8"), ("detail-objects", "false")],
    );
    Ok([0, 1].map(|i| run.record(&eye(&scene, i), usize::MAX).film))
}

/// Whether none of a node's children was tested: it shows its own class.
fn is_deepest(film: &dyn Film<Flat>, all: &[Test], node: NodeId) -> bool {
    !film.hierarchy().children(node).any(|c| all.iter().any(|t| t.node == Some(NodeId(c))))
}

fn class_role(occlusion: Occlusion) -> Role {
    match occlusion {
        Occlusion::Full => Role::Hidden,
        Occlusion::None => Role::Visible,
        Occlusion::Partial => Role::Partial,
    }
}

fn fill(plan: &mut Plan, role: Role, node: NodeId, bounds: &Aabb<Vec2>) {
    let corners = [0, 1, 3, 2].map(|i| bounds.corner(i)).to_vec();
    plan.world.push(Layer::Areas, role, Subject::Node(node), Mark::Area(corners));
}

fn frame_10() -> Aabb<Vec2> {
    Aabb { min: Vec2::new(-8.3, -0.9), max: Vec2::new(8.3, 12.3) }
}

/// The occluder, the viewpoint and the border of the shadow.
fn shadow(plan: &mut Plan, film: &dyn Film<Flat>, wall: PrimId, name: &str) {
    let at = film.view().eye.position;
    let ends: Vec<Vec2> = film.scene().prim_points(wall).collect();
    for &end in &ends {
        plan.line(Role::Eye, at, at + (end - at) * 20.0);
    }
    plan.world.line(Layer::Emphasis, Role::Occluder, Subject::Prim(wall), ends.clone());
    plan.viewpoint(at, name);
    plan.plate((ends[0] + ends[1]) * 0.5 - Vec2::Y * 9.0 * plan.unit, NAME_PT, Font::Bold, "O");
}

/// Nodes of the three kinds that the paper names: the largest that a frame finds hidden, the largest that it
/// finds visible, and one that is partly hidden in both frames.
fn named_nodes(films: &[Arc<dyn Film<Flat>>; 2], frame: usize) -> [Option<NodeId>; 3] {
    let all = [tests(&*films[0]), tests(&*films[1])];
    let film = &films[frame];
    let area = |n: &NodeId| {
        let size = film.hierarchy().bounds(*n).size();
        size.x * size.y
    };
    let is = |frame: usize, node: NodeId, what: Occlusion| {
        all[frame].iter().any(|t| t.node == Some(node) && t.occlusion == what)
    };
    let deepest =
        || all[frame].iter().filter_map(|t| t.node).filter(|n| is_deepest(&**film, &all[frame], *n));
    let largest = |what: &dyn Fn(NodeId) -> bool| {
        deepest().filter(|n| what(*n)).max_by(|a, b| area(a).total_cmp(&area(b)).then(b.cmp(a)))
    };
    [
        largest(&|n| is(frame, n, Occlusion::Full)),
        largest(&|n| is(frame, n, Occlusion::None)),
        largest(&|n| (0..2).all(|i| is(i, n, Occlusion::Partial))),
    ]
}

/// Width of a panel of Figure 10.
const PANEL_PT: f32 = 156.0;

/// Fills the last nodes of each descent of a frame, in the role that their test gives them.
fn fill_deepest(plan: &mut Plan, film: &dyn Film<Flat>, all: &[Test], role: impl Fn(&Test) -> Role) {
    for test in all {
        if let Some(node) = test.node.filter(|&node| is_deepest(film, all, node)) {
            fill(plan, role(test), node, &film.hierarchy().bounds(node));
        }
    }
}

/// Viewpoint number `i`: nodes by their class.
fn classes(films: &[Arc<dyn Film<Flat>>; 2], i: usize) -> Panel {
    let (film, all) = (&*films[i], tests(&*films[i]));
    let mut plan = Plan::new(frame_10(), PANEL_PT);
    fill_deepest(&mut plan, film, &all, |test| class_role(test.occlusion));
    for (k, node) in named_nodes(films, i).into_iter().enumerate() {
        let Some(node) = node else { continue };
        let at = film.hierarchy().bounds(node).center();
        plan.plate(at, LABEL_PT, Font::Bold, &(k + 1).to_string());
    }
    shadow(&mut plan, film, all[0].occluder, &format!("P{}", i + 1));
    plan.panel(format!("viewpoint P{}: {} nodes tested", i + 1, all.len()))
}

/// The second viewpoint: nodes by whether their lines were kept from the first.
fn reuse(film: &dyn Film<Flat>) -> Panel {
    let all = tests(film);
    let mut plan = Plan::new(frame_10(), PANEL_PT);
    fill_deepest(&mut plan, film, &all, |test| if test.reused { Role::Approximated } else { Role::Scene });
    shadow(&mut plan, film, all[0].occluder, "P2");
    let reused = all.iter().filter(|t| t.reused).count();
    plan.panel(format!("at P2: {reused} nodes reused, {} new", all.len() - reused))
}

/// Figure 10: nodes classified for two viewpoints in a row, and what was reused.
pub(super) fn two_viewpoints(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let films = two_frames(maker)?;
    let all_panels = [classes(&films, 0), classes(&films, 1), reuse(&*films[1])];
    let content = panels(TWO_COLUMNS_PT, 3, &all_panels);
    let legend = vec![
        entry(Role::Occluder, Swatch::Line, "occluder O"),
        entry(Role::Eye, Swatch::Line, "viewpoint and border of the shadow"),
        entry(Role::Hidden, Swatch::Area, "node occluded"),
        entry(Role::Visible, Swatch::Area, "node not occluded"),
        entry(Role::Partial, Swatch::Area, "leaf partially occluded: drawn"),
        entry(Role::Approximated, Swatch::Area, "lines kept from P1"),
        entry(Role::Scene, Swatch::Area, "lines made at P2"),
    ];
    let caption = "Nodes of a kD-tree classified against a single occluder O for two viewpoints in a row; \
                   only the last nodes of each descent are filled. The descent ends where a node is occluded \
                   as a whole (such as 1) or not at all (2), so few nodes are tested. Nodes that both \
                   descents come to (such as 3) keep their supporting and separating lines, which do not \
                   depend on where the eye stands: at P2 they are only checked. Scene two_viewpoints, both \
                   eyes.";
    Ok(maker.page(Paper::TwoColumns, "One occluder, two viewpoints in a row", legend, caption, &content))
}

/// Figure 12 looks at one frame.
fn details_film(maker: &Maker<'_>, with_details: bool) -> Result<Arc<dyn Film<Flat>>, SceneError> {
    let scene = example("detail_objects")?;
    let switch = if with_details { "true" } else { "false" };
    let pairs = [("occluders", "2"), ("detail-objects", switch)];
    Ok(maker.film(&scene, &eye(&scene, 0), LARGE_OCCLUDERS, &pairs))
}

fn bounds_of(scene: &Scene<Flat>, object: ObjectId) -> Aabb<Vec2> {
    let of_it = scene.live().iter().filter(|&&p| scene.object_of(p) == object);
    of_it.fold(Aabb::empty(), |sum, &p| sum.union(scene.prim_bounds(p)))
}

/// Draws the detail objects' names, and the occluders near them that hide some; how many are hidden.
fn draw_details(plan: &mut Plan, film: &dyn Film<Flat>) -> usize {
    let scene = film.scene();
    let mut culled = 0;
    for test in tests(film).iter().filter(|t| t.occlusion == Occlusion::Full) {
        let Some(object) = test.object else { continue };
        let ends: Vec<Vec2> = scene.prim_points(test.occluder).collect();
        let one = Blockers::<Flat>::new(&ends, &[vec![0, 1]]);
        for [supporting, _] in
            one.planes(0, &bounds_of(scene, object), film.view().eye.position).iter().flatten()
        {
            draw_tangent(plan, Role::Evidence, supporting);
        }
        plan.world.line(Layer::Emphasis, Role::Occluder, Subject::Prim(test.occluder), ends);
        culled += 1;
    }
    for (i, object) in scene.objects().iter().enumerate().filter(|(_, o)| o.name.starts_with('D')) {
        let bounds = bounds_of(scene, ObjectId(i as u32));
        plan.plate(bounds.center() + Vec2::X * 15.0 * plan.unit, NAME_PT, Font::Bold, &object.name);
    }
    culled
}

/// Figure 12: detail objects and the occluders near them.
pub(super) fn detail_objects(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = details_film(maker, true)?;
    let scene = film.scene().clone();
    let mut plan = Plan::new(Aabb { min: Vec2::new(-6.6, -0.8), max: Vec2::new(6.6, 13.4) }, COLUMN_PT);
    let look = Look { nodes: false, evidence: false, eye: false, ..Look::default() };
    plan.world.items.extend(world(&*film, &Stamps::new(&*film), film.events().len(), &look).items);
    for &prim in &chosen(&*film) {
        let ends: Vec<Vec2> = scene.prim_points(prim).collect();
        plan.world.line(Layer::Emphasis, Role::Eye, Subject::Prim(prim), ends);
    }
    let culled = draw_details(&mut plan, &*film);
    plan.viewpoint(film.view().eye.position, "P");
    let content = panels(
        COLUMN_PT,
        1,
        &[plan.panel(format!("{culled} of 3 detail objects are culled by occluders near them."))],
    );
    let legend = vec![
        entry(Role::Eye, Swatch::Line, "occluder that is large from P"),
        entry(Role::Occluder, Swatch::Line, "occluder that is large from a detail object"),
        entry(Role::Evidence, Swatch::Line, "its supporting line with that object"),
        entry(Role::Hidden, Swatch::Line, "culled"),
        entry(Role::Visible, Swatch::Line, "drawn"),
    ];
    let caption = "Detail objects D1 to D3 and the occluders that decide them. The two occluders that look \
                   largest from the viewpoint P hide none of the three. Visibility goes both ways, so the \
                   occluders that look large from an object toward P are tried too: P lies inside both \
                   supporting lines of D1 and D2 with the walls before them. D3 is drawn. Scene \
                   detail_objects, first eye.";
    Ok(maker.page(Paper::Column, "Detail objects and the occluders near them", legend, caption, &content))
}

#[cfg(test)]
mod checks {
    use super::*;
    use crate::method::Verdict;
    use crate::trace::State;

    #[test]
    fn the_second_viewpoint_reuses_most_lines_and_they_are_those_of_the_first() {
        let films = two_frames(&Maker::gray()).expect("a scene");
        let [first, second] = [tests(&*films[0]), tests(&*films[1])];
        let wall = PrimId(0);
        assert!(
            first.iter().chain(&second).all(|t| t.occluder == wall && t.node.is_some()),
            "the wall is the only occluder"
        );
        assert!(first.iter().all(|t| !t.reused));
        for test in &second {
            let before = first.iter().any(|t| t.node == test.node);
            assert!(before || !test.reused, "{:?} was not tested before", test.node);
        }
        let reused = second.iter().filter(|t| t.reused).count();
        assert!(reused * 2 > second.len() && reused < second.len(), "{reused} of {}", second.len());
        assert!(second.len() * 2 < films[1].hierarchy().node_count(), "the tree saves most tests");
        for (node, what) in named_nodes(&films, 1).iter().zip(["full", "none", "partial"]) {
            let node = node.unwrap_or_else(|| panic!("no node is {what} at both viewpoints"));
            assert!(
                what != "partial" || second.iter().any(|t| t.node == Some(node) && t.reused),
                "node 3 is a reused one"
            );
        }
    }

    #[test]
    fn details_are_hidden_only_by_the_occluders_near_them() {
        let [with, without] =
            [true, false].map(|details| details_film(&Maker::gray(), details).expect("a scene"));
        let scene = with.scene();
        let state = |film: &Arc<dyn Film<Flat>>, object: &str| {
            let prim = *scene
                .live()
                .iter()
                .find(|&&p| scene.objects()[scene.object_of(p).at()].name == object)
                .expect("an object");
            Stamps::new(&**film).prim(prim, film.events().len())
        };
        let (hidden, visible) = (State::Decided(Verdict::Hidden), State::Decided(Verdict::Visible));
        assert_eq!(["D1", "D2", "D3"].map(|d| state(&with, d)), [hidden, hidden, visible]);
        assert_eq!(["D1", "D2", "D3"].map(|d| state(&without, d)), [visible; 3]);
        let near = tests(&*with)
            .iter()
            .filter(|t| t.object.is_some() && t.occlusion == Occlusion::Full)
            .map(|t| t.occluder)
            .collect::<Vec<_>>();
        assert!(
            near.len() == 2 && near.iter().all(|p| !chosen(&*with).contains(p)),
            "{near:?} are not chosen for the eye"
        );
    }
}
