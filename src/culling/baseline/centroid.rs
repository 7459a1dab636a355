//! `centroid`: the polygons in view, nearest centroid first, up to a budget.
//!
//! Klosowski and Silva 2000, Section 4.5, the baseline of their comparison. As there, view-frustum and
//! back-face culling come first (Section 5), and there is no spatial index. It is not conservative: what
//! lies beyond the budget is left out, visible or not. Ties are broken by id.
//! Cost: O(n) tests and a sort of the polygons in view.

use std::sync::Arc;

use super::explain::{Distance, Evidence};
use crate::drawing::{Drawing, Subject};
use crate::geometry::{self, FrustumTest, PrimId, Space, Vector, View};
use crate::index::Whole;
use crate::method::evidence::{Facing, Tested, middle};
use crate::method::{
    Budget, Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, Verdict,
    keeps_nothing, surface_knobs,
};
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub struct Centroid;

/// Parameters of [`Centroid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    budget: Budget,
    surfaces: Surfaces,
}

impl Default for Params {
    fn default() -> Self {
        // The budget at which the paper compares with it.
        Self { budget: Budget::Percent(10.0), surfaces: Surfaces::default() }
    }
}

const CODE: &[CodeLine] = &[
    CodeLine::new("Order:1", "for each polygon p of the scene"),
    CodeLine::new("Order:2", "  if p lies outside the view: skip p"),
    CodeLine::new("Order:3", "  if p faces away from the eye: skip p"),
    CodeLine::new("Order:4", "  put p into L by distance"),
    CodeLine::new("Draw:1", "for each polygon p of L, nearest first"),
    CodeLine::new("Draw:2", "  if budget is left"),
    CodeLine::new("Draw:3", "    draw p"),
    CodeLine::new("Draw:4", "  else leave p out"),
];

/// Lines that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const EACH: u8 = line(CODE, "Order:1");
    pub const IN_VIEW: u8 = line(CODE, "Order:2");
    pub const FACING: u8 = line(CODE, "Order:3");
    pub const PUT: u8 = line(CODE, "Order:4");
    pub const NEXT: u8 = line(CODE, "Draw:1");
    pub const BUDGET: u8 = line(CODE, "Draw:2");
    pub const DRAW: u8 = line(CODE, "Draw:3");
    pub const LEAVE_OUT: u8 = line(CODE, "Draw:4");
}

impl<S: Space> Method<S> for Centroid {
    type Params = Params;
    type Index = Whole<S>;
    type Memory = ();
    type State = ();
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "centroid",
        name: "Centroid ordering with a budget",
        summary: "Sorts the polygons in view by the distance of their centroids and draws the nearest ones \
                  until the budget is spent.",
        paper: "Klosowski and Silva. The Prioritized-Layered Projection Algorithm for Visible Set \
                Estimation. IEEE TVCG 6(2), 2000, Section 4.5.",
        doi: "10.1109/2945.856993",
        conservative: false,
        code: CODE,
        stands: &[
            ("PrimClassified", &["Order:2"]),
            ("OrientationTested", &["Order:3"]),
            ("CentroidRanked", &["Draw:2"]),
            ("PrimDecided outside", &["Order:2"]),
            ("PrimDecided faces-away", &["Order:3"]),
            ("PrimDecided visible", &["Draw:3"]),
            ("PrimDecided over-budget", &["Draw:4"]),
        ],
        departures: &[],
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let meaning = "how many primitives are drawn: a number, or a share of the scene such as 10%";
        let budget = Knob::new("budget", "primitives", meaning, "Klosowski and Silva 2000, Section 4.5");
        knobs.budget(budget, false, &mut params.budget);
        surface_knobs(knobs, &mut params.surfaces);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        _: &Params,
        saved: Option<&[u8]>,
        _: &dyn Progress,
    ) -> Result<Option<Whole<S>>, String> {
        // The paper "needs to sort all of the triangles in S at each frame" (Section 4.5): nothing can be
        // prepared.
        keeps_nothing(saved)?;
        Ok(Some(Whole::new(scene.clone())))
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        (): &mut (),
        (): &mut (),
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        let Frame { scene, view, params, .. } = *frame;
        watch.event(Event::FrameBegan);
        watch.stage("order");
        let mut queue = in_view(scene, view, params, watch);
        // All of it, as in the paper, though a selection of the budget's nearest would do: its cost is part
        // of what is compared. The id breaks ties, so that the order is the same everywhere.
        queue.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Of the scene's primitives, not of those in view: so budgets mean the same from view to view.
        let budget = params.budget.of(scene.live().len());
        watch.stage("draw");
        // On past the budget, so that all that is left out is decided too.
        for (rank, &(squared, prim)) in queue.iter().enumerate() {
            let fits = rank < budget;
            watch.event(Event::Line(line::NEXT));
            watch.event(Event::Line(line::BUDGET));
            watch.note(move || Evidence::Distance(Distance::of(scene, prim, squared, rank, budget)));
            watch.event(Event::Line(if fits { line::DRAW } else { line::LEAVE_OUT }));
            if fits {
                out.prims.push(prim);
            }
            watch.event(Event::DecidedPrim(prim, if fits { Verdict::Visible } else { Verdict::OverBudget }));
        }
    }
    fn is_conservative(params: &Params) -> bool {
        // Then nothing is left out.
        params.budget == Budget::Percent(100.0)
    }
    fn has_line(params: &Params, line: u8) -> bool {
        match line {
            line::FACING => params.surfaces.one_sided,
            line::DRAW => params.budget.of(1) > 0,
            line::LEAVE_OUT => params.budget != Budget::Percent(100.0),
            _ => true,
        }
    }
}

impl<S: Space> Shown<S> for Centroid {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        if let Some(note) = moment.note {
            note.draw(moment.frame.scene, moment.frame.view, to);
        }
    }
}

/// The primitives in view with the squared distance of their centroids from the eye, world units².
fn in_view<S: Space, O: Observer<Evidence<S>>>(
    scene: &Scene<S>,
    view: &View<S>,
    params: &Params,
    watch: &mut O,
) -> Vec<(f32, PrimId)> {
    let (frustum, eye) = (view.frustum(), view.eye.position);
    let mut queue = Vec::with_capacity(scene.live().len());
    // "All three algorithms perform view-frustum and backface culling" (Section 5): what is not in view would
    // spend the budget for nothing.
    for &prim in scene.live() {
        watch.event(Event::Line(line::EACH));
        watch.event(Event::Line(line::IN_VIEW));
        let bounds = scene.prim_bounds(prim);
        let planes = geometry::Frustum::<S::Vector>::ALL;
        let test = frustum.test(&bounds, planes);
        watch.note(move || Evidence::Tested(Tested::of(Subject::Prim(prim), &bounds, planes, test)));
        if matches!(test, FrustumTest::Outside(_)) {
            watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            continue;
        }
        if params.surfaces.one_sided {
            watch.event(Event::Line(line::FACING));
            watch.note(move || Evidence::Facing(Facing::of(prim)));
            if scene.faces_away(prim, eye) {
                watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
                continue;
            }
        }
        watch.event(Event::Line(line::PUT));
        // Squared, which sorts alike and rounds less.
        let toward = middle(scene, prim) - eye;
        queue.push((toward.dot(toward), prim));
    }
    queue
}
