//! The traversal: Figures 4 and 5, once for both spaces and all tessellations.
//!
//! One frame is: 2. seed, and more seeds if wanted; 3. and 4. spread until the budget is spent or the front
//! is empty, in which case a new seed is looked for; 5. what the budget left, by queries if wanted. The
//! numbers are those of the method's steps ([`super`]).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::code::{either, line};
use super::explain::{
    Bounded, Compared, Drawn, Ended, Evidence, Origin, Projected, Queried, Seeded, Spent, Transferred,
    Unreached,
};
use super::front::Front;
use super::index::{Index, node_of};
use super::later::{Later, Projections};
use super::rest::Rest;
use super::rules::{Entering, Occupancy, Penalizing, Sight, Transfer, Update};
use super::{LayeredProjection, Params};
use crate::culling::depth::Faces;
use crate::drawing::Subject;
use crate::geometry::{Aabb, CellId, Frustum, FrustumTest, NodeId, PrimId, Vector, View};
use crate::index::Hierarchy;
use crate::index::tessellation::{Cellular, Exit, Neighbor, Tessellation};
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Frame, Limit, Observer, Verdict};
use crate::scene::Scene;

/// Primitives that are drawn between two calls of the limit, inside a cell: a full cell may hold thousands,
/// and a frame cannot end between two calls. So many that the call costs nothing beside drawing them, so few
/// that they are drawn in a small part of a millisecond.
const CHUNK: usize = 256;

/// A growing budget grows by half, at least by this many primitives. Each bound of the doubt costs
/// O(cells), so growth must be geometric for their sum to stay O(cells · log primitives); half, not double,
/// since all that is drawn beyond what was needed is waste. The least keeps a budget of 0 from growing by 0.
const LEAST_GROWTH: usize = 16;

/// Steps along the diagonal of the region for a ray that rounding took out of all cells: a step is then about
/// the size of a cell that holds anything at the default leaf size.
const STEPS_OUTSIDE: f32 = 64.0;
/// A step along a ray, of the diagonal of the cell it is in: short enough that hardly a cell on the way is
/// jumped over, and one that is loses no more than a seed.
const STEP_INSIDE: f32 = 0.25;

/// Where a cell lies in regard to the view volume.
#[derive(Clone, Copy, PartialEq)]
enum InView {
    Unknown,
    Outside,
    /// The planes that cut it; 0 if it lies inside.
    Cut(u8),
}

/// A cell as it is seen in this frame; found out once, when it is asked for.
#[derive(Clone, Copy)]
struct Aspect<V> {
    in_view: InView,
    /// Whether what follows is known.
    is_known: bool,
    /// How the way from its center to the Eye leaves it.
    exit: Exit,
    /// v, a unit vector.
    toward: V,
    /// Whether its solidity came through that exit.
    is_settled: bool,
}

/// A cell that was just projected.
#[derive(Clone, Copy)]
struct Source {
    pub cell: CellId,
    pub solidity: f32,
    /// What it adds, of ρ_max.
    share: f32,
}

/// Cells that hold something, the nearest to the Eye on top: the bits of the squared distance of their boxes,
/// which order like the number that is not negative, and among equally near ones the lower cell first.
type Nearest = BinaryHeap<Reverse<(u32, CellId)>>;

/// One frame.
pub struct Walk<'a, S: Cellular + Faces, O> {
    pub(super) index: &'a Index<S>,
    cells: &'a dyn Tessellation<S>,
    pub(super) scene: &'a Scene<S>,
    view: &'a View<S>,
    /// The direction in which the Eye looks.
    forward: S::Vector,
    frustum: Frustum<S::Vector>,
    params: &'a Params,
    pub(super) front: &'a mut Front,
    aspects: Vec<Aspect<S::Vector>>,
    /// Cells at which a new front may begin; found when one is looked for.
    nearest: Option<Nearest>,
    /// Which shared primitives are decided.
    pub(super) marks: Vec<bool>,
    /// What the budget left out of the cell in which it ended.
    pub(super) cut_off: Vec<PrimId>,
    left: usize,
    limit: Option<&'a Limit<'a>>,
    /// Primitives that were reported to `limit`, and whether it ended the frame.
    reported: usize,
    ended: bool,
    /// Cells projected so far.
    rank: u32,
    /// The depths of what is drawn, where queries or the quality ask for them.
    rest: Option<Rest<S>>,
    /// Whether the budget is spent and the rest is decided by queries.
    queries: bool,
    pub(super) out: &'a mut DrawList<S>,
    pub(super) watch: &'a mut O,
}

impl<'a, S: Cellular + Faces, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    pub fn new(
        frame: &Frame<'a, S, LayeredProjection>,
        front: &'a mut Front,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let Frame { index, scene, view, params, limit, .. } = *frame;
        let unseen = Aspect {
            in_view: InView::Unknown,
            is_known: false,
            exit: Exit::Out,
            toward: S::Vector::default(),
            is_settled: false,
        };
        Self {
            index,
            cells: index.cells.any(),
            scene,
            view,
            // The last row of the projection is depth.
            forward: view.projection().rows[S::Vector::AXES - 1],
            frustum: view.frustum(),
            params,
            front,
            aspects: vec![unseen; index.count()],
            nearest: None,
            marks: vec![false; index.assignment.all_shared().len()],
            cut_off: Vec::new(),
            left: params.budget.of(scene.live().len()),
            limit,
            reported: 0,
            ended: false,
            rank: 0,
            rest: index
                .clusters
                .as_ref()
                .map(|clusters| Rest::new(view, clusters, scene.prim_count(), params.surfaces)),
            queries: false,
            out,
            watch,
        }
    }

    /// Figure 4, repeated where the front runs dry.
    pub fn run(mut self) {
        self.watch.event(Event::Entered(NodeId(0)));
        // 2. The paper places one cell in the front; more are its last extension.
        self.watch.stage("seed");
        self.line(either(line::SEED, self.grows_everywhere()));
        let mut seed = self.seed();
        if let Some(seeded) = seed {
            self.grow_from(seeded);
        }
        self.seeds_ahead();
        let mut last = None;
        while seed.is_some() {
            // 3. and 4.
            self.watch.stage(if self.queries { "rest" } else { "spread" });
            last = self.spread();
            if last.is_some() {
                break;
            }
            self.watch.stage("seed");
            seed = self.begin_again();
        }
        // 5. What no cell decided.
        self.watch.stage("rest");
        if self.queries {
            self.draw_the_shared_rest();
        }
        self.report_drawn();
        self.line(line::END);
        self.report_rest(last);
        self.watch.event(Event::DecidedNode(NodeId(0), Verdict::Partial));
        self.watch.event(Event::Left(NodeId(0)));
    }

    /// Projects cells until the front is empty, or until the budget is spent with the cell that is returned.
    fn spread(&mut self) -> Option<Source> {
        // Lines 1 and 2: the cell leaves the front where it is projected or found hidden, below.
        self.line(line::WHILE);
        while let Some((cell, solidity)) = self.front.least() {
            self.line(line::TAKE);
            // Line 3; past the budget only what the z-buffer does not hide (Section 6).
            if !self.queries || !self.is_hidden(cell, solidity) {
                self.line(line::PROJECT);
                self.project(cell, solidity);
            }
            let source = Source { cell, solidity, share: self.share(cell) };
            // Lines 4 and 5.
            self.line(line::IF_SPENT);
            if self.left == 0 && !self.goes_on() {
                self.line(line::BREAK);
                let (cells, drawn, cut_off) = (self.rank, self.out.prims.len(), self.cut_off.len() as u32);
                let drawn = drawn as u32;
                self.watch.note(|| Evidence::Spent(Spent { cell, solidity, cells, drawn, cut_off }));
                return Some(source);
            }
            self.hand_on(&source);
            self.line(line::WHILE);
        }
        None
    }
    /// Lines 6 to 10. A departure where the front keeps to the view: what is out of it is skipped like what
    /// was projected, for nothing of it is drawn, and what is in view beyond it is reached by other ways.
    fn hand_on(&mut self, source: &Source) {
        let (cells, everywhere) = (self.cells, self.grows_everywhere());
        for there in cells.neighbors(source.cell) {
            self.line(line::EACH);
            self.line(either(line::IF_DONE, everywhere));
            if self.front.is_projected(there.cell) || !everywhere && !self.is_in_view(there.cell) {
                self.line(line::CONTINUE);
                continue;
            }
            self.line(line::UPDATE);
            let update = self.update_solidity(there, source);
            self.line(either(line::ENQUEUE, self.params.how.update == Update::Latest));
            if let Some((solidity, is_star_shaped)) = update {
                self.enqueue(there.cell, solidity, is_star_shaped);
            }
        }
    }
    /// Whether the front grows over cells out of view too.
    fn grows_everywhere(&self) -> bool {
        self.params.how.front == Entering::Everywhere
    }
    #[inline]
    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }

    /// Section 6, with the budget spent: whether queries or the quality ask for more.
    fn goes_on(&mut self) -> bool {
        // A limit from outside is final.
        let Some(mut rest) = self.rest.take_if(|_| !self.ended) else { return false };
        rest.catch_up();
        if self.params.queries {
            // First the budget, then queries for the rest, which now mostly find something in front.
            self.line(line::ASK_ON);
            self.watch.stage("rest");
            (self.queries, self.left) = (true, usize::MAX);
        } else {
            // Adjust the budget until the image is as good as asked for. What could change a pixel is
            // bounded, not what does: the promise holds, and the budget is larger than it need be.
            self.line(line::GROW);
            let most = 1.0 - self.params.quality as f32 / 100.0;
            let (share, bare) = self.doubt(&mut rest, most);
            let drawn = self.out.prims.len() as u32;
            self.watch.note(|| Evidence::Bounded(Bounded { share, most, drawn }));
            for prim in bare {
                self.watch.note(|| Evidence::Drawn(Drawn { prim, cell: None }));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            }
            self.left = if share > most { (self.out.prims.len() / 2).max(LEAST_GROWTH) } else { 0 };
        }
        self.rest = Some(rest);
        self.left > 0
    }
    /// The share of the image that what is in view and not drawn could still change, bounded as close as
    /// `most` asks for; and the primitives that have no bounds in the image, which were drawn instead.
    fn doubt(&mut self, rest: &mut Rest<S>, most: f32) -> (f32, Vec<PrimId>) {
        let (index, scene, eye, planes) =
            (self.index, self.scene, self.view.eye.position, Frustum::<S::Vector>::ALL);
        let (mut doubt, mut bare) = (rest.doubt(self.view), Vec::new());
        // What meets one cell alone lies in its box.
        for cell in (0..index.count() as u32).map(CellId).filter(|c| !index.assignment.own(*c).is_empty()) {
            if !self.front.is_projected(cell) && self.is_in_view(cell) {
                doubt.of_box(&self.cells.bounds(cell));
            }
        }
        // What meets several cells may reach out of those that are left: each by itself.
        for (number, &prim) in index.assignment.all_shared().iter().enumerate() {
            let faces = || !self.params.surfaces.leave_out(scene, prim, eye);
            let outside =
                || matches!(self.frustum.test(&scene.prim_bounds(prim), planes), FrustumTest::Outside(_));
            // What the near plane may cut has no bound in the image: there are few of them, so they are
            // listed. Into the tiles they come with the first of their cells.
            if !self.marks[number] && faces() && !outside() && !doubt.of_prim(scene, prim) {
                self.marks[number] = true;
                self.out.prims.push(prim);
                bare.push(prim);
            }
        }
        (doubt.share(most), bare)
    }
    /// Whether all of a cell is hidden by what is drawn; then it leaves the front.
    fn is_hidden(&mut self, cell: CellId, solidity: f32) -> bool {
        let (node, bounds) = (node_of(cell), self.cells.bounds(cell));
        let Some(rest) = self.rest.as_mut().filter(|_| self.index.assignment.held(cell) > 0) else {
            return false;
        };
        rest.catch_up();
        // Out of view: projecting it draws nothing and lets the front grow on.
        let Some(answer) = rest.hides::<O>(&bounds) else { return false };
        self.watch.event(Event::Line(line::ASK));
        self.watch.event(Event::Entered(node));
        self.watch.note(|| Evidence::Queried(Queried { cell, solidity, answer }));
        // A hidden cell is done with, but its solidity goes on to its neighbors: they may be seen past it.
        if answer.is_hidden {
            self.watch.event(Event::Line(line::LEAVE));
            self.front.leave_out(cell);
            self.rank += 1;
            self.watch.event(Event::DecidedNode(node, Verdict::Hidden));
        }
        self.watch.event(Event::Left(node));
        answer.is_hidden
    }
    /// Draws those of the shared primitives in view that no cell drew and that are not hidden themselves.
    fn draw_the_shared_rest(&mut self) {
        // Out of view or facing away first: the z-buffer need not be read for those.
        let shared = self.index.assignment.all_shared();
        let mut open = Vec::new();
        self.line(line::SHARED);
        for number in (0..shared.len()).filter(|n| !self.marks[*n]).collect::<Vec<_>>() {
            self.marks[number] = true;
            match self.outside(shared[number], Frustum::<S::Vector>::ALL, [line::COMPARE; 2]) {
                Some(verdict) => self.watch.event(Event::DecidedPrim(shared[number], verdict)),
                None => open.push(shared[number]),
            }
        }
        let Some(rest) = &mut self.rest else { return };
        rest.catch_up();
        let (scene, view) = (self.scene, self.view);
        // What is drawn to is as far as it was found for those that show, and nearer than those that do not:
        // so before for these and after for the others, where someone listens.
        let mut before = Vec::new();
        if O::LISTENS {
            before.extend(open.iter().map(|&prim| rest.depths(scene, view, prim)));
        }
        // They are drawn together, and each is compared with what is drawn when its turn comes.
        let hidden = rest.draw_shared::<O>(scene);
        for (at, prim) in open.into_iter().enumerate() {
            let is_hidden = hidden[prim.at()];
            if !is_hidden {
                self.out.prims.push(prim);
            }
            let rest = &*rest;
            self.watch.event(Event::Line(line::COMPARE));
            self.watch.note(|| {
                // Of what lets light through the box may show where itself it does not.
                let shows = |depths: &[f32; 2]| depths[0] >= depths[1];
                let before = before.get(at).copied().flatten().filter(shows);
                let depths = if is_hidden { rest.depths(scene, view, prim) } else { before };
                Evidence::Compared(Compared { prim, depths, is_hidden })
            });
            let verdict = if is_hidden { Verdict::Hidden } else { Verdict::Visible };
            self.watch.event(Event::DecidedPrim(prim, verdict));
        }
    }

    /// Step 2: the cell that holds the Eye, or else the one closest to it (`findCell`, Section 4.2). A
    /// departure where the front keeps to the view: of the cells in view that hold something, the one whose
    /// box is closest.
    fn seed(&mut self) -> Option<Seeded> {
        let eye = self.view.eye.position;
        if let Some(cell) = self.cells.locate(eye, CellId(0)) {
            return Some(Seeded { cell, distance: 0.0, origin: Origin::Eye });
        }
        if !self.grows_everywhere() {
            return self.nearest_unreached();
        }
        // The cells fill their region: the closest one holds the region's closest point.
        let region = self.index.bounds(NodeId(0));
        let at = eye.max(region.min).min(region.max);
        let Some(cell) = self.cells.locate(at, CellId(0)) else { return self.nearest_unreached() };
        Some(Seeded { cell, distance: (eye - at).length(), origin: Origin::Closest })
    }
    /// A departure: where the front grows over faces in view only it may run dry with something in view not
    /// reached, such as where the Eye is outside of all cells. The paper ends there.
    pub(super) fn begin_again(&mut self) -> Option<Seeded> {
        // One that grows everywhere has reached all: cells hang together.
        if self.grows_everywhere() {
            return None;
        }
        self.line(line::AGAIN);
        let seed = self.nearest_unreached();
        if let Some(seeded) = seed {
            self.grow_from(seeded);
        }
        seed
    }
    /// Of the cells in view that hold something and were not projected, the one whose box is nearest. Once in
    /// a frame O(cells), then O(log cells) a cell that is passed over for good.
    fn nearest_unreached(&mut self) -> Option<Seeded> {
        let mut nearest = self.nearest.take().unwrap_or_else(|| self.by_distance());
        let found = loop {
            let Some(Reverse((squared, cell))) = nearest.pop() else { break None };
            // Neither becomes untrue later, so the cell need not be kept.
            if !self.front.is_projected(cell) && self.is_in_view(cell) {
                break Some((f32::from_bits(squared), cell));
            }
        };
        self.nearest = Some(nearest);
        let (squared, cell) = found?;
        let origin = if self.rank > 0 { Origin::Again } else { Origin::Nearest };
        Some(Seeded { cell, distance: squared.sqrt(), origin })
    }
    fn by_distance(&self) -> Nearest {
        let eye = self.view.eye.position;
        let occupied = (0..self.index.count() as u32).map(CellId);
        let keyed = occupied.filter(|cell| self.index.assignment.held(*cell) > 0).map(|cell| {
            let bounds = self.cells.bounds(cell);
            let away = eye - eye.max(bounds.min).min(bounds.max);
            Reverse((away.dot(away).to_bits(), cell))
        });
        keyed.collect::<Vec<_>>().into()
    }
    /// Puts a cell into the front for it to begin at.
    fn grow_from(&mut self, seeded: Seeded) {
        self.watch.note(move || Evidence::Seeded(seeded));
        self.enqueue(seeded.cell, 0.0, true);
    }
    /// Section 6, several seeds: on rays through points spread over the image, the first cells that hold
    /// something.
    fn seeds_ahead(&mut self) {
        // The last row of the projection is depth, so that `ray * depth` is at that view depth.
        let rows = self.view.projection().rows;
        let forward = rows[S::Vector::AXES - 1];
        for number in 1..self.params.seeds {
            self.line(line::SEEDS);
            // Through the point whose coordinates are spread over −1 to 1: the rows are orthogonal.
            let ray = (0..S::Vector::AXES - 1).fold(forward, |ray, axis| {
                let row = rows[axis];
                ray + row * ((2.0 * spread_out(number, axis) - 1.0) / row.dot(row))
            });
            if let Some((cell, distance)) = self.first_along(ray) {
                self.grow_from(Seeded { cell, distance, origin: Origin::Ray });
            }
        }
    }
    /// The first cell with primitives that steps along a ray from the Eye meet, and how far away they do.
    fn first_along(&self, ray: S::Vector) -> Option<(CellId, f32)> {
        let (region, eye) = (self.index.bounds(NodeId(0)), self.view.eye);
        // Outside of the region is no cell, and the far plane may be far beyond it.
        let [mut depth, end] = stretch_in(&region, eye.position, ray, [eye.near, eye.far]);
        let (mut near, coarse) = (CellId(0), region.diagonal() / STEPS_OUTSIDE);
        while depth < end {
            let at = self.cells.locate(self.view.eye.position + ray * depth, near);
            if let Some(cell) = at.filter(|c| self.index.assignment.held(*c) > 0) {
                return Some((cell, depth * ray.length()));
            }
            // The last cell found is where the search for the next begins: it is a neighbor or near.
            near = at.unwrap_or(near);
            depth +=
                at.map_or(coarse, |cell| STEP_INSIDE * self.cells.bounds(cell).diagonal()) / ray.length();
        }
        None
    }

    /// Line 10.
    fn enqueue(&mut self, cell: CellId, solidity: f32, is_star_shaped: bool) {
        self.front.put(cell, solidity, is_star_shaped);
        self.watch.event(Event::Queued(node_of(cell), solidity));
    }

    /// Where a cell lies in regard to the view volume; found out once a frame.
    #[inline]
    fn in_view(&mut self, cell: CellId) -> InView {
        if self.aspects[cell.at()].in_view == InView::Unknown {
            self.aspects[cell.at()].in_view = self.test(cell);
        }
        self.aspects[cell.at()].in_view
    }
    /// Whether a cell is not out of view.
    pub(super) fn is_in_view(&mut self, cell: CellId) -> bool {
        self.in_view(cell) != InView::Outside
    }
    fn test(&mut self, cell: CellId) -> InView {
        let bounds = self.cells.bounds(cell);
        let planes = Frustum::<S::Vector>::ALL;
        let test = self.frustum.test(&bounds, planes);
        self.watch
            .note(move || Evidence::Tested(Tested::of(Subject::Node(node_of(cell)), &bounds, planes, test)));
        match test {
            FrustumTest::Outside(_) => {
                self.watch.event(Event::DecidedNode(node_of(cell), Verdict::Outside));
                InView::Outside
            }
            FrustumTest::Partial(cutting) => InView::Cut(cutting),
            FrustumTest::Inside => InView::Cut(0),
        }
    }
    /// How the front sees a cell; found out once a frame, when the front reaches it.
    #[inline]
    fn look(&mut self, cell: CellId) -> Aspect<S::Vector> {
        if !self.aspects[cell.at()].is_known {
            let eye = self.view.eye.position;
            // A departure by default: v belongs to the cell. The paper has "the current viewing direction"
            // (Figure 6), and a single one says nothing near the rim of a wide view.
            let toward = match self.params.how.sight {
                Sight::Frame => self.forward,
                Sight::Cell => {
                    let way = self.cells.center(cell) - eye;
                    way * (1.0 / way.length().max(f32::MIN_POSITIVE))
                }
            };
            // The way from the center to the Eye decides about the penalty, whichever neighbor asks later.
            let exit = self.cells.exit(cell, eye);
            let old = self.aspects[cell.at()];
            self.aspects[cell.at()] = Aspect { is_known: true, exit, toward, ..old };
        }
        self.aspects[cell.at()]
    }

    /// |A| / ρ_max, or the part of it that faces the Eye (Section 6).
    fn share(&self, cell: CellId) -> f32 {
        let most = self.index.most().max(1) as f32;
        if self.params.occupancy == Occupancy::Count {
            return self.index.hiding(cell) as f32 / most;
        }
        let hides = |prim: &PrimId| !self.params.surfaces.show_through(self.scene, *prim);
        self.index.prims_of(cell).filter(hides).map(|prim| self.facing(prim)).sum::<f32>() / most
    }
    /// Section 6, front-facing triangles: the cosine of the angle between a primitive's normal and the way to
    /// the Eye, 0 if it faces away.
    fn facing(&self, prim: PrimId) -> f32 {
        let mut corners = [S::Vector::default(); 3];
        for (to, from) in corners.iter_mut().zip(self.scene.prim_points(prim)) {
            *to = from;
        }
        let (normal, way) = (S::normal(&corners[..S::CORNERS]), self.view.eye.position - corners[0]);
        (normal.dot(way) / (normal.length() * way.length()).max(f32::MIN_POSITIVE)).max(0.0)
    }

    /// Figure 5: hands the solidity of cell A on to its neighbor B. `None` if B keeps what it has.
    fn update_solidity(&mut self, b: &Neighbor<S::Vector>, a: &Source) -> Option<(f32, bool)> {
        let seen = self.look(b.cell);
        if self.params.occupancy == Occupancy::FrontFacing {
            self.line(line::COUNT);
        }
        // Line 1. As printed: through a face that the front crosses toward the Eye, solidity is taken away.
        let how = self.params.how;
        let along = match how.transfer {
            Transfer::Whole => 1.0,
            Transfer::Aligned => seen.toward.dot(b.normal),
        };
        self.line(either(line::SUM, self.params.how.transfer == Transfer::Aligned));
        let sum = a.share + along * a.solidity;
        self.line(line::IF_STAR);
        // Line 2, Section 3.2: the center of B is seen from the Eye along a ray through the shared face.
        let star_shaped = seen.exit == Exit::Ends || seen.exit == Exit::Into(a.cell);
        // Line 3. The paper does not say what the factor is; adding is a departure by default (see `rules`).
        let solidity = if star_shaped { sum } else { how.penalized(sum) };
        if !star_shaped {
            self.line(either(line::PENALTY, how.penalizing == Penalizing::Factor));
        }
        // `enqueue` of Figure 4 reinserts with the latest value. A departure by default: a value that came
        // through the face the Eye sees B through is about what is in front of B; others are detours, and the
        // least of these stands until that one comes.
        let before = self.front.solidity(b.cell);
        let keeps = how.update == Update::StarShaped
            && !star_shaped
            && (seen.is_settled || before.is_some_and(|v| v <= solidity));
        self.aspects[b.cell.at()].is_settled |= star_shaped;
        let (held, most) = (self.index.hiding(a.cell), self.index.most());
        let (cell, normal, sight) = (b.cell, b.normal, seen.toward);
        let (a, share, of_a) = (a.cell, a.share, a.solidity);
        self.line(line::RETURN);
        self.watch.note(|| {
            Evidence::Transferred(Transferred {
                a,
                b: cell,
                held,
                most,
                share,
                sight,
                normal,
                transfer: how.transfer,
                along,
                of_a,
                star_shaped,
                penalizing: how.penalizing,
                solidity,
                before,
                keeps,
            })
        });
        (!keeps).then_some((solidity, star_shaped))
    }

    /// What is left of the budget, for people: no more than there is.
    fn budget_left(&self) -> u32 {
        self.left.min(self.scene.live().len() - self.out.prims.len()) as u32
    }

    /// Draws what is in a cell and not drawn yet, as far as the budget goes.
    fn project(&mut self, cell: CellId, solidity: f32) {
        let (index, node) = (self.index, node_of(cell));
        self.watch.event(Event::Entered(node));
        self.line(line::IN_VIEW);
        let in_view = self.in_view(cell);
        let (first, rank) = (self.out.prims.len(), self.rank);
        let mut own_end = first;
        // What the cell holds alone, then what it shares if no cell before it drew that: once a frame
        // (Section 4.1).
        if let InView::Cut(cutting) = in_view {
            self.line(line::PRIMS);
            for &prim in index.assignment.own(cell) {
                self.draw(prim, cutting);
            }
            own_end = self.out.prims.len();
            for &number in index.assignment.shared(cell) {
                if !self.marks[number as usize] {
                    self.marks[number as usize] = true;
                    self.draw(index.assignment.all_shared()[number as usize], cutting);
                }
            }
            self.line(line::DRAW);
            if index.assignment.held(cell) > 0 {
                self.rest.iter_mut().for_each(|rest| rest.add(cell));
            }
        }
        self.report_drawn();
        self.rank += 1;
        let (drawn, held, left) =
            ((self.out.prims.len() - first) as u32, index.assignment.held(cell), self.budget_left());
        let (cut_off, is_in_view) = (self.cut_off.len() as u32, in_view != InView::Outside);
        self.front.project(cell);
        let next = self.front.least().map(|(_, solidity)| solidity);
        self.watch.note(|| {
            Evidence::Projected(Projected {
                cell,
                rank,
                solidity,
                next,
                held,
                drawn,
                cut_off,
                left,
                is_in_view,
            })
        });
        // One that is out of view was decided when it was looked at.
        if is_in_view {
            self.report_projected(cell, first, own_end);
        }
        self.watch.event(Event::Left(node));
    }
    /// Says of a cell, and of what was drawn with it since the first `first`, what was decided; the first
    /// `own_end` are its own.
    fn report_projected(&mut self, cell: CellId, first: usize, own_end: usize) {
        if !O::LISTENS {
            return;
        }
        for &prim in &self.out.prims[own_end..] {
            self.watch.note(|| Evidence::Drawn(Drawn { prim, cell: Some(cell) }));
            self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        }
        // What the cell holds alone is decided with it, unless the budget ended in it: then some is left out.
        let is_whole = self.cut_off.is_empty();
        if !is_whole {
            for &prim in &self.out.prims[first..own_end] {
                self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            }
        }
        let verdict = if is_whole { Verdict::Visible } else { Verdict::Partial };
        self.watch.event(Event::DecidedNode(node_of(cell), verdict));
    }

    /// Reports newly drawn primitives to the limit, which may end the frame.
    fn report_drawn(&mut self) {
        let Some(limit) = self.limit else { return };
        if self.reported < self.out.prims.len() && limit(&self.out.prims[self.reported..]) {
            (self.left, self.ended) = (0, true);
        }
        self.reported = self.out.prims.len();
    }

    /// Draws a primitive of a cell that these planes cut, unless it is outside or the budget is spent. A cell
    /// is drawn in part where the budget ends in it (Section 4.1), but whole where queries or the quality
    /// decide about the rest: those look at whole cells.
    fn draw(&mut self, prim: PrimId, cutting: u8) {
        if let Some(verdict) = self.outside(prim, cutting, [line::OUTSIDE, line::FACING]) {
            self.watch.event(Event::DecidedPrim(prim, verdict));
        } else if self.left == 0 && self.rest.is_none() {
            self.cut_off.push(prim);
        } else {
            self.left = self.left.saturating_sub(1);
            self.out.prims.push(prim);
            if self.out.prims.len() - self.reported >= CHUNK {
                self.report_drawn();
            }
        }
    }
    /// Whether a primitive lies beyond one of these planes or faces away, which is said at these lines.
    fn outside(&mut self, prim: PrimId, cutting: u8, at: [u8; 2]) -> Option<Verdict> {
        let (scene, view) = (self.scene, self.view);
        // A departure: the paper culls by the view frustum without saying at what; here cells, and primitives
        // one by one where a cell is cut.
        if cutting != 0 {
            let bounds: Aabb<S::Vector> = scene.prim_bounds(prim);
            let test = self.frustum.test(&bounds, cutting);
            if matches!(test, FrustumTest::Outside(_)) {
                self.line(at[0]);
                self.watch
                    .note(move || Evidence::Tested(Tested::of(Subject::Prim(prim), &bounds, cutting, test)));
                return Some(Verdict::Outside);
            }
        }
        if self.params.surfaces.leave_out(scene, prim, view.eye.position) {
            self.line(at[1]);
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            return Some(Verdict::FacesAway);
        }
        None
    }

    /// The same frame with as much budget as it needs from here on, for another to watch. `front` and `out`
    /// hold what this one left.
    pub(super) fn unlimited<'b, P>(
        &'b self,
        front: &'b mut Front,
        out: &'b mut DrawList<S>,
        watch: &'b mut P,
    ) -> Walk<'b, S, P> {
        Walk {
            index: self.index,
            cells: self.cells,
            scene: self.scene,
            view: self.view,
            forward: self.forward,
            frustum: self.view.frustum(),
            params: self.params,
            front,
            aspects: self.aspects.clone(),
            nearest: self.nearest.clone(),
            marks: self.marks.clone(),
            cut_off: Vec::new(),
            left: usize::MAX,
            limit: None,
            reported: 0,
            ended: false,
            rank: self.rank,
            rest: None,
            queries: false,
            out,
            watch,
        }
    }

    /// Reports of every cell and primitive that was not reached why not: it is out of view, or the budget was
    /// spent, with the cell `last`. Only if someone listens; it changes nothing.
    fn report_rest(&mut self, last: Option<Source>) {
        if last.is_none() {
            let (cells, left) = (self.rank, self.budget_left());
            self.watch.note(|| Evidence::Ended(Ended { cells, left }));
        }
        if !O::LISTENS {
            return;
        }
        let later = last.map(|last| self.later(last));
        if let (Some(later), Some(last)) = (&later, last) {
            self.report_left_out(later, last.cell);
        }
        // Cells are decided for what they hold alone; what they share is still open.
        let index = self.index;
        for (number, &prim) in index.assignment.all_shared().iter().enumerate() {
            if !self.marks[number] {
                self.report_shared(prim, later.as_ref());
            }
        }
    }
    /// What a larger budget would have drawn: goes on from the cell with which this one was spent.
    fn later(&self, last: Source) -> Later {
        let waiting = self.front.first(usize::MAX);
        let (mut front, mut seen) = (self.front.clone(), Projections::default());
        // The rest of the cell in which the budget ended comes first.
        let mut list = DrawList { prims: self.cut_off.clone(), ..DrawList::default() };
        let mut further = self.unlimited(&mut front, &mut list, &mut seen);
        further.hand_on(&last);
        while further.spread().is_none() && further.begin_again().is_some() {}
        let spent = (last.cell, last.solidity, self.cut_off.len());
        Later::of(self.index, self.scene, spent, waiting, seen, &list.prims)
    }
    /// Says of what the budget left out of the cell in which it ended, and of each cell that was not reached,
    /// how much more it would have taken.
    fn report_left_out(&mut self, later: &Later, last: CellId) {
        for prim in std::mem::take(&mut self.cut_off) {
            if let Some(left_out) = later.of_prim(prim) {
                self.watch.note(|| Evidence::LeftOut(left_out));
            }
            self.watch.event(Event::DecidedPrim(prim, Verdict::OverBudget));
        }
        for cell in (0..self.index.count() as u32).map(CellId).filter(|c| *c != last) {
            if self.front.is_projected(cell) || !self.is_in_view(cell) {
                continue;
            }
            // Of what no budget reaches all in view is empty.
            if let Some(left_out) = later.of_cell(cell) {
                self.watch.note(|| Evidence::LeftOut(left_out));
                self.watch.event(Event::DecidedNode(node_of(cell), Verdict::OverBudget));
            }
        }
    }
    /// Says of a shared primitive that no cell drew why not.
    fn report_shared(&mut self, prim: PrimId, later: Option<&Later>) {
        let (bounds, planes) = (self.scene.prim_bounds(prim), Frustum::<S::Vector>::ALL);
        let test = self.frustum.test(&bounds, planes);
        if matches!(test, FrustumTest::Outside(_)) {
            self.watch.note(move || Evidence::Tested(Tested::of(Subject::Prim(prim), &bounds, planes, test)));
            self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
        } else if let Some(left_out) = later.and_then(|later| later.of_prim(prim)) {
            self.watch.note(|| Evidence::LeftOut(left_out));
            self.watch.event(Event::DecidedPrim(prim, Verdict::OverBudget));
        } else if self.params.surfaces.leave_out(self.scene, prim, self.view.eye.position) {
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
        } else {
            // Its box may reach into view, but none of its cells does, or one of them would have drawn it.
            self.watch.note(|| Evidence::Unreached(Unreached { prim }));
            self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
        }
    }
}

/// The depths, of those from `near` to `far`, at which a ray from `eye` is in a box; none where the first is
/// not less than the second. At depth 1 the ray has come as far as `ray` is long.
fn stretch_in<V: Vector>(bounds: &Aabb<V>, eye: V, ray: V, [near, far]: [f32; 2]) -> [f32; 2] {
    (0..V::AXES).fold([near, far], |[from, to], axis| {
        let (start, along) = (eye.get(axis), ray.get(axis));
        let (low, high) = (bounds.min.get(axis), bounds.max.get(axis));
        // A ray that runs beside this axis is between its two sides everywhere or nowhere.
        if along == 0.0 {
            return if (low..=high).contains(&start) { [from, to] } else { [to, from] };
        }
        let (a, b) = ((low - start) / along, (high - start) / along);
        [from.max(a.min(b)), to.min(a.max(b))]
    })
}

/// The radical inverse of a number, base 2 or 3 by axis (Halton): points spread evenly over 0 to 1.
fn spread_out(mut number: u32, axis: usize) -> f32 {
    // Primes for bases, so that the coordinates do not repeat together; digits are mirrored at the point.
    let base = axis as u32 + 2;
    let (mut sum, mut part) = (0.0, 1.0);
    while number > 0 {
        part /= base as f32;
        sum += part * (number % base) as f32;
        number /= base;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, vec2};

    #[test]
    fn a_ray_is_followed_inside_the_region_only() {
        let region = Aabb { min: Vec2::ZERO, max: vec2(4.0, 2.0) };
        let stretch = |eye: Vec2, ray: Vec2| stretch_in(&region, eye, ray, [0.5, 1e6]);
        assert_eq!(stretch(vec2(-1.0, 1.0), Vec2::X), [1.0, 5.0]);
        assert_eq!(stretch(vec2(1.0, 1.0), vec2(2.0, 0.0)), [0.5, 1.5], "from the near plane on");
        assert_eq!(stretch(vec2(1.0, 1.0), vec2(1.0, -1.0)), [0.5, 1.0]);
        let [from, to] = stretch(vec2(-1.0, 3.0), Vec2::X);
        assert!(from >= to, "beside the region it never enters: {from} {to}");
        let [from, to] = stretch(vec2(5.0, 1.0), Vec2::X);
        assert!(from >= to, "away from it: {from} {to}");
        let on_the_side = stretch(vec2(0.0, 0.0), Vec2::X);
        assert_eq!(on_the_side, [0.5, 4.0]);
    }
}
