//! The traversal: Figures 4 and 5, once for both spaces and all tessellations.

use super::explain::{Ended, Evidence, Projected, Seeded, Transferred};
use super::front::Front;
use super::index::{Index, node_of};
use super::{Params, line};
use crate::culling::evidence::{Facing, Tested, prim_faces_away};
use crate::culling::{DrawList, Event, Observer, Verdict};
use crate::drawing::Subject;
use crate::geometry::{Aabb, CellId, Frustum, FrustumTest, NodeId, PrimId, Vector, View};
use crate::index::tessellation::{Cellular, Neighbor, Tessellation};
use crate::scene::Scene;

/// Where a cell lies in regard to the view volume.
#[derive(Clone, Copy, PartialEq)]
enum Sight {
    Unknown,
    Outside,
    /// The planes that cut it; 0 if it lies inside.
    In(u8),
}

/// One frame.
pub struct Walk<'a, S: Cellular, O> {
    index: &'a Index<S>,
    cells: &'a dyn Tessellation<S>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    frustum: Frustum<S::Vector>,
    params: &'a Params,
    front: Front,
    sights: Vec<Sight>,
    /// Which shared primitives are decided.
    marks: Vec<bool>,
    left: usize,
    /// Cells projected so far.
    rank: u32,
    out: &'a mut DrawList,
    watch: &'a mut O,
}

impl<'a, S: Cellular, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    pub fn new(index: &'a Index<S>, scene: &'a Scene<S>, view: &'a View<S>, params: &'a Params, out: &'a mut DrawList, watch: &'a mut O) -> Self {
        Self {
            index,
            cells: index.cells.any(),
            scene,
            view,
            frustum: view.frustum(),
            params,
            front: Front::new(index.count()),
            sights: vec![Sight::Unknown; index.count()],
            marks: vec![false; index.assignment.all_shared().len()],
            left: params.budget.of(scene.live().len()),
            rank: 0,
            out,
            watch,
        }
    }

    /// Figure 4.
    pub fn run(mut self) {
        self.watch.event(Event::Entered(NodeId(0)));
        let mut seed = self.seed();
        while let Some(cell) = seed {
            self.enqueue(cell, 0.0);
            if self.spread() {
                break;
            }
            seed = self.nearest_unreached();
        }
        self.tell_the_rest(seed.is_some());
        self.watch.event(Event::DecidedNode(NodeId(0), Verdict::Partial));
        self.watch.event(Event::Left(NodeId(0)));
    }

    /// Projects cells until the front is empty; whether the budget is spent.
    fn spread(&mut self) -> bool {
        let cells = self.cells;
        while let Some((cell, solidity)) = self.front.take() {
            self.watch.event(Event::Line(line::TAKE));
            self.project(cell, solidity);
            if self.left == 0 {
                self.watch.event(Event::Line(line::SPENT));
                return true;
            }
            for there in cells.neighbors(cell) {
                if self.front.is_projected(there.cell) || self.sight(there.cell) == Sight::Outside {
                    self.watch.event(Event::Line(line::SKIP));
                    continue;
                }
                let updated = self.update_solidity(there, cell, solidity);
                self.enqueue(there.cell, updated);
            }
        }
        false
    }

    /// Section 4.2: the cell that holds the Eye, or else the nearest one that is in view.
    fn seed(&mut self) -> Option<CellId> {
        let Some(cell) = self.cells.locate(self.view.eye.position, CellId(0)) else { return self.nearest_unreached() };
        self.watch.note(|| Evidence::Seeded(Seeded { cell, distance: 0.0, again: false }));
        Some(cell)
    }
    /// The nearest cell in view that holds something and was not projected. Where the front grows over faces and no number
    /// is rounded, there is one at the beginning only.
    fn nearest_unreached(&mut self) -> Option<CellId> {
        let eye = self.view.eye.position;
        let mut best: Option<(f32, CellId)> = None;
        for cell in (0..self.index.count() as u32).map(CellId) {
            if self.front.is_projected(cell) || self.index.assignment.held(cell) == 0 {
                continue;
            }
            let bounds = self.cells.bounds(cell);
            let away = eye - eye.max(bounds.min).min(bounds.max);
            let squared = away.dot(away);
            if best.is_none_or(|(least, _)| squared < least) && self.sight(cell) != Sight::Outside {
                best = Some((squared, cell));
            }
        }
        let (squared, cell) = best?;
        let again = self.rank > 0;
        self.watch.note(|| Evidence::Seeded(Seeded { cell, distance: squared.sqrt(), again }));
        Some(cell)
    }

    fn enqueue(&mut self, cell: CellId, solidity: f32) {
        self.watch.event(Event::Line(line::ENQUEUE));
        self.front.put(cell, solidity);
        self.watch.event(Event::Queued(node_of(cell), solidity));
    }

    /// Whether a cell is in view; tested once a frame.
    fn sight(&mut self, cell: CellId) -> Sight {
        if self.sights[cell.at()] == Sight::Unknown {
            let bounds = self.cells.bounds(cell);
            let planes = Frustum::<S::Vector>::ALL;
            let test = self.frustum.test(&bounds, planes);
            let frustum = &self.frustum;
            self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(node_of(cell)), frustum, &bounds, planes, test)));
            self.sights[cell.at()] = match test {
                FrustumTest::Outside(_) => Sight::Outside,
                FrustumTest::Partial(cutting) => Sight::In(cutting),
                FrustumTest::Inside => Sight::In(0),
            };
            if self.sights[cell.at()] == Sight::Outside {
                self.watch.event(Event::DecidedNode(node_of(cell), Verdict::Outside));
            }
        }
        self.sights[cell.at()]
    }

    /// Figure 5: hands the solidity of cell A on to its neighbor B.
    fn update_solidity(&mut self, b: &Neighbor<S::Vector>, a: CellId, of_a: f32) -> f32 {
        let assignment = &self.index.assignment;
        let (held, most) = (assignment.held(a), assignment.most());
        let toward = self.cells.center(b.cell) - self.view.eye.position;
        let sight = toward * (1.0 / toward.length().max(f32::MIN_POSITIVE));
        let along = if self.params.transfer == Params::WHOLE { 1.0 } else { sight.dot(b.normal).max(0.0) };
        let sum = held as f32 / most.max(1) as f32 + along * of_a;
        let star_shaped = self.cells.leaves_into(b.cell, a, self.view.eye.position);
        let solidity = if star_shaped { sum } else { sum * (1.0 + self.params.penalty as f32 / 100.0) };
        let before = self.front.solidity(b.cell);
        let (cell, normal) = (b.cell, b.normal);
        self.watch.note(|| Evidence::Transferred(Transferred { a, b: cell, held, most, sight, normal, along, of_a, star_shaped, solidity, before }));
        if !star_shaped {
            self.watch.event(Event::Line(line::PENALTY));
        }
        solidity
    }

    /// Draws what is in a cell and not drawn yet, as far as the budget goes.
    fn project(&mut self, cell: CellId, solidity: f32) {
        let (index, node) = (self.index, node_of(cell));
        self.watch.event(Event::Line(line::PROJECT));
        self.watch.event(Event::Entered(node));
        let sight = self.sight(cell);
        let (drawn, left, rank) = (self.out.prims.len(), self.left, self.rank);
        if let Sight::In(cutting) = sight {
            for &prim in index.assignment.own(cell) {
                if let Some(verdict) = self.fate(prim, cutting) {
                    self.watch.event(Event::DecidedPrim(prim, verdict));
                }
            }
            for &number in index.assignment.shared(cell) {
                if !self.marks[number as usize] {
                    self.marks[number as usize] = true;
                    let prim = index.assignment.all_shared()[number as usize];
                    let verdict = self.fate(prim, cutting).unwrap_or(Verdict::Visible);
                    self.watch.event(Event::DecidedPrim(prim, verdict));
                }
            }
        }
        self.rank += 1;
        let (drawn, held) = ((self.out.prims.len() - drawn) as u32, index.assignment.held(cell));
        self.watch.note(|| Evidence::Projected(Projected { cell, rank, solidity, held, drawn, left: (left - drawn as usize) as u32 }));
        if sight != Sight::Outside {
            self.watch.event(Event::DecidedNode(node, Verdict::Visible));
        }
        self.watch.event(Event::Left(node));
    }

    /// Draws a primitive of a cell that these planes cut, or says why not.
    fn fate(&mut self, prim: PrimId, cutting: u8) -> Option<Verdict> {
        let (scene, view) = (self.scene, self.view);
        if cutting != 0 {
            let bounds: Aabb<S::Vector> = scene.prim_bounds(prim);
            let test = self.frustum.test(&bounds, cutting);
            if matches!(test, FrustumTest::Outside(_)) {
                let frustum = &self.frustum;
                self.watch.note(move || Evidence::Tested(Tested::of(Subject::Prim(prim), frustum, &bounds, cutting, test)));
                return Some(Verdict::Outside);
            }
        }
        if self.params.backface_culling && prim_faces_away(scene, view.eye.position, prim) {
            self.watch.note(move || Evidence::Facing(Facing::of(scene, view, prim)));
            return Some(Verdict::Outside);
        }
        if self.left == 0 {
            return Some(Verdict::OverBudget);
        }
        self.left -= 1;
        self.out.prims.push(prim);
        None
    }

    /// Says of every cell and primitive that was not reached why not: it is out of view, or the budget was spent. Only if
    /// someone listens; it changes nothing.
    fn tell_the_rest(&mut self, spent: bool) {
        let (cells, left) = (self.rank, self.left as u32);
        self.watch.note(|| Evidence::Ended(Ended { cells, left, spent }));
        if !O::LISTENS {
            return;
        }
        let index = self.index;
        let count = index.count() as u32;
        for cell in (0..count).map(CellId) {
            // Of what the front did not reach without the need to stop, all in view is empty.
            if !self.front.is_projected(cell) && self.sight(cell) != Sight::Outside && spent {
                self.watch.event(Event::DecidedNode(node_of(cell), Verdict::OverBudget));
            }
        }
        for (number, &prim) in index.assignment.all_shared().iter().enumerate() {
            if !self.marks[number] {
                let verdict = self.fate_of_the_rest(prim, spent);
                self.watch.event(Event::DecidedPrim(prim, verdict));
            }
        }
    }
    /// Why a shared primitive was not reached.
    fn fate_of_the_rest(&mut self, prim: PrimId, spent: bool) -> Verdict {
        let (bounds, planes) = (self.scene.prim_bounds(prim), Frustum::<S::Vector>::ALL);
        let test = self.frustum.test(&bounds, planes);
        if matches!(test, FrustumTest::Outside(_)) {
            let frustum = &self.frustum;
            self.watch.note(move || Evidence::Tested(Tested::of(Subject::Prim(prim), frustum, &bounds, planes, test)));
            return Verdict::Outside;
        }
        // With budget left its box may reach into view, but none of its cells does: it cannot be seen, though no plane says so.
        if spent { Verdict::OverBudget } else { Verdict::Hidden }
    }
}
