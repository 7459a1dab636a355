//! The traversal of one frame (Section 3).

use super::code::line;
use super::evidence::{CubeDrawn, Erring, Evidence, Settled, Sized};
use super::hiding::{ASKED_PX, Hiding};
use super::index::CubeTree;
use super::space::Projected;
use super::{Order, Params};
use crate::drawing::Subject;
use crate::geometry::{Aabb, Frustum, FrustumTest, NodeId, PrimId, Space, Vector, View};
use crate::index::{CellTree, octant_of};
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Observer, Verdict};
use crate::raster::StandIn;
use crate::scene::Scene;

/// A mark for each primitive.
#[derive(Default)]
struct Marks {
    words: Vec<u64>,
    /// A bit for each word that is not 0, so that a few marks among many are found at once.
    filled: Vec<u64>,
}

impl Marks {
    fn new(count: usize) -> Self {
        let words = count.div_ceil(64);
        Self { words: vec![0; words], filled: vec![0; words.div_ceil(64)] }
    }
    /// Marks one; whether it was marked before.
    #[inline]
    fn mark(&mut self, prim: PrimId) -> bool {
        let (at, bit) = (prim.at() / 64, 1 << (prim.at() % 64));
        let was = self.words[at] & bit != 0;
        self.words[at] |= bit;
        self.filled[at / 64] |= 1 << (at % 64);
        was
    }
    fn has(&self, prim: PrimId) -> bool {
        self.words[prim.at() / 64] >> (prim.at() % 64) & 1 == 1
    }
    /// Takes all marks off, and lists what was marked, ascending.
    fn take(&mut self, to: &mut Vec<PrimId>) {
        for block in 0..self.filled.len() {
            for at in ones(std::mem::take(&mut self.filled[block])).map(|k| 64 * block + k) {
                let first = 64 * at as u32;
                match std::mem::take(&mut self.words[at]) {
                    u64::MAX => to.extend((first..first + 64).map(PrimId)),
                    word => to.extend(ones(word).map(|k| PrimId(first + k as u32))),
                }
            }
        }
    }
    /// No primitive is marked.
    fn clear(&mut self) {
        for block in 0..self.filled.len() {
            for at in ones(std::mem::take(&mut self.filled[block])) {
                self.words[64 * block + at] = 0;
            }
        }
    }
}

/// The numbers of the bits that are set, ascending.
fn ones(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let next = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        next
    })
}

/// The size on the screen, pixels, of what has so many at depth 1. About the eye a cell has no size there,
/// and is as large as can be.
#[inline]
pub(super) fn size_at(depth: f32, side: f32, near: f32) -> f32 {
    if depth > near { side / depth } else { f32::INFINITY }
}

/// The octant of a cell in which the eye is, or to which it is nearest. Cells are disjoint, and a child is
/// before another if the planes that part it from the eye's octant are among those that part the other: so by
/// ascending number, seen from that octant, none is before one that it hides.
#[inline]
pub(super) fn nearest_octant<V: Vector>(cell: &Aabb<V>, eye: V) -> usize {
    let center = cell.center();
    (0..V::AXES).map(|a| usize::from(eye.get(a) > center.get(a)) << a).sum()
}

/// The traversal of one frame.
pub(super) struct Walk<'a, S: Projected, O> {
    index: &'a CubeTree<S>,
    tree: &'a CellTree<S::Vector>,
    scene: &'a Scene<S>,
    /// From the cells' own space: of a copy that was moved, with the eye moved the other way.
    view: View<S>,
    params: &'a Params,
    frustum: Frustum<S::Vector>,
    /// Line of sight.
    forward: S::Vector,
    /// The sum of its components without their signs: half of it times a side is how far a cell reaches along
    /// the line of sight from its center.
    spread: f32,
    /// Side of a cell of each level in pixels, were it at depth 1.
    sides: [f32; 32],
    /// What of that is half a unit of length.
    pixels_of_half: f32,
    /// Items that were drawn, or found to face away: all where that is how they are listed, else those of
    /// which no leaf alone has all.
    done: Marks,
    /// Whether what is to be drawn is listed in the end, by its marks. Its order is of no matter, unless it
    /// is the paper's; by number those that share points are near each other, as they are in the scene.
    lists_marks: bool,
    /// Items that are in some cube that was drawn; kept only where somebody listens.
    in_cubes: Marks,
    /// Whether no cell below the one that is visited is to be drawn as a cube.
    as_geometry: bool,
    /// What is drawn so far, where cells behind it are left out; and what is in cells that were, behind
    /// geometry, or cubes as well.
    hiding: Option<Hiding<'a, S>>,
    behind: [Marks; 2],
    /// Whether any is marked.
    is_marked: bool,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
}

/// Pixels that a length takes up at depth 1.
pub(super) fn pixels_at_depth_1<S: Space>(view: &View<S>) -> f32 {
    // Flatland's angle is that across the image, and that of space up and down.
    let pixels = if S::Vector::AXES == 2 { view.width } else { view.height };
    (f64::from(pixels) * 0.5 / (f64::from(view.eye.fov) * 0.5).tan()) as f32
}

impl<'a, S: Projected, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    /// A frame that is yet to be walked.
    pub(super) fn new(
        (index, scene): (&'a CubeTree<S>, &'a Scene<S>),
        view: &View<S>,
        params: &'a Params,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let (tree, forward) = (index.tree(), view.eye.forward());
        let side = (0..S::Vector::AXES).map(|a| tree.root().size().get(a)).fold(0.0, f32::max);
        let pixels = pixels_at_depth_1(view);
        Self {
            index,
            tree,
            scene,
            view: *view,
            params,
            frustum: view.frustum(),
            forward,
            spread: (0..S::Vector::AXES).map(|a| forward.get(a).abs()).sum(),
            sides: std::array::from_fn(|level| side * pixels / (1u32 << level.min(31)) as f32),
            pixels_of_half: 0.5 / pixels,
            done: Marks::new(scene.prim_count()),
            lists_marks: params.order == Order::Exact && !params.surfaces.one_sided,
            in_cubes: Marks::new(if O::LISTENS { scene.prim_count() } else { 0 }),
            as_geometry: false,
            hiding: None,
            behind: Default::default(),
            is_marked: false,
            out,
            watch,
        }
    }
    /// Leaves out cells that are hidden, if it is asked to.
    pub(super) fn hiding(mut self, hiding: Option<Hiding<'a, S>>) -> Self {
        if O::LISTENS && hiding.is_some() {
            self.behind = [0, 1].map(|_| Marks::new(self.scene.prim_count()));
        }
        self.hiding = hiding;
        self
    }
    /// The whole of it.
    pub(super) fn run(&mut self) {
        self.watch.stage("visit");
        self.visit(Frustum::<S::Vector>::ALL);
    }
    /// The tree, where no other planes than these can cut its root's cell.
    pub(super) fn visit(&mut self, planes: u8) {
        let first = self.out.prims.len();
        self.render(NodeId(0), *self.tree.root(), planes);
        let (items, prims) = (self.tree.items(), &mut self.out.prims);
        if self.lists_marks && items.are_single() {
            self.done.take(prims);
        } else if self.lists_marks {
            let mut drawn = Vec::new();
            self.done.take(&mut drawn);
            items.extend(prims, &drawn);
        } else if self.params.order == Order::Exact {
            let mut marks = Marks::new(self.scene.prim_count());
            prims.drain(first..).for_each(|prim| _ = marks.mark(prim));
            marks.take(prims);
        }
    }
    /// The eye stands elsewhere and looks the same way: as if another copy of the scene were seen, of which
    /// nothing is drawn yet.
    pub(super) fn move_eye(&mut self, eye: S::Vector) {
        (self.view.eye.position, self.frustum.eye) = (eye, eye);
        // Most copies are drawn as cubes, and mark nothing.
        if std::mem::take(&mut self.is_marked) {
            self.done.clear();
            self.in_cubes.clear();
        }
    }
    /// What was drawn so far.
    pub(super) fn drawn(&mut self) -> &mut DrawList<S> {
        self.out
    }
    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }

    /// Render: a cell, and the planes that cut all cells above it.
    fn render(&mut self, id: NodeId, cell: Aabb<S::Vector>, planes: u8) {
        let node = &self.tree.nodes()[id.at()];
        self.watch.event(Event::Entered(id));
        self.line(line::RENDER);
        self.line(line::TEST);
        let test = self.frustum.test(&cell, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Node(id), &cell, planes, test)));
        let cutting = match test {
            FrustumTest::Outside(_) => {
                self.line(line::OUTSIDE);
                return self.leave(id, Verdict::Outside);
            }
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        self.line(line::CUTTING);
        let depth = self.forward.dot(cell.center() - self.view.eye.position);
        let side = self.sides[usize::from(node.level)];
        let size = size_at(depth, side, self.view.eye.near);
        if size >= ASKED_PX
            && let Some(hiding) = &mut self.hiding
            && let Some(verdict) = hiding.hides(id, &cell, self.watch)
        {
            return self.leave_hidden(id, verdict);
        }
        if self.as_geometry {
            return self.draw_or_visit(id, &cell, cutting);
        }
        self.line(line::SIZE);
        let threshold = self.params.pixel_threshold;
        self.watch.note(move || Evidence::Sized(Sized { node: id, depth, size, threshold }));
        if size <= threshold && self.is_good(id, size) {
            return self.draw_cube(id, cell);
        }
        self.as_geometry = cutting == 0 && self.needs_geometry(id, depth);
        self.draw_or_visit(id, &cell, cutting);
        self.as_geometry = false;
    }

    /// Draws a leaf, or what is to be drawn as geometry, unless cells of it can be hidden; visits the
    /// children of any other cell.
    fn draw_or_visit(&mut self, id: NodeId, cell: &Aabb<S::Vector>, cutting: u8) {
        self.line(line::LEAF);
        let is_leaf = self.tree.nodes()[id.at()].is_leaf();
        if is_leaf || self.as_geometry && self.hiding.is_none() {
            self.line(line::CALL_DRAW);
            self.line(line::DRAW);
            self.draw_geometry(id);
            self.line(line::CALL_DRAW);
            let prims = self.tree.items().count(self.tree.references(id));
            self.watch.note(move || Evidence::Geometry { node: id, references: prims as u32 });
            return self.leave(id, Verdict::Visible);
        }
        self.visit_children(id, cell, cutting);
        self.watch.event(Event::Left(id));
    }

    /// A decision about a cell and all below it ends the visit.
    fn leave(&mut self, id: NodeId, verdict: Verdict) {
        self.watch.event(Event::DecidedNode(id, verdict));
        self.watch.event(Event::Left(id));
    }

    /// Leaves out a cell, and notes what it holds.
    fn leave_hidden(&mut self, id: NodeId, verdict: Verdict) {
        if O::LISTENS {
            let marks = &mut self.behind[usize::from(verdict == Verdict::Presumed)];
            self.tree.references(id).iter().for_each(|&prim| _ = marks.mark(prim));
        }
        self.leave(id, verdict);
    }

    /// Whether a cell's cube is no more wrong than the bound says, where there is one.
    fn is_good(&mut self, id: NodeId, size: f32) -> bool {
        let Some(error) = self.index.error(id) else { return true };
        self.line(line::ERROR);
        let bound = self.params.error_bound;
        self.watch.note(move || Evidence::Erring(Erring { node: id, error, size, bound }));
        error * size * size <= bound
    }

    /// Draws a cell's color cube in place of all that it holds.
    fn draw_cube(&mut self, id: NodeId, cell: Aabb<S::Vector>) {
        self.line(line::CUBE);
        let faces = *self.index.faces(id);
        let after = self.out.prims.len() as u32;
        let cube = StandIn { node: id, bounds: cell, faces, after };
        self.out.stand_ins.push(cube);
        if let Some(hiding) = &mut self.hiding {
            hiding.add_cube(&cube);
        }
        self.watch.note(move || Evidence::Cube(CubeDrawn { node: id, cell, faces }));
        if O::LISTENS {
            // What it shares with other cells is settled with the cell above them all.
            let below = self.tree.references(id);
            self.is_marked = true;
            below.iter().for_each(|&prim| _ = self.in_cubes.mark(prim));
        }
        self.leave(id, Verdict::Approximated);
    }

    /// Whether it is a loss to look below a cell: the cells that would have to be drawn as cubes, for it to
    /// pay, are larger than the threshold, wherever they are.
    fn needs_geometry(&self, id: NodeId, depth: f32) -> bool {
        let level = self.tree.nodes()[id.at()].level;
        let from = self.index.pays_from(id);
        // A cell's farthest point lies half a side on from its center, on each axis.
        let farthest = depth + self.sides[usize::from(level)] * self.pixels_of_half * self.spread;
        from == 0 || self.sides[usize::from(from)] > self.params.pixel_threshold * farthest
    }

    fn visit_children(&mut self, id: NodeId, cell: &Aabb<S::Vector>, cutting: u8) {
        let node = &self.tree.nodes()[id.at()];
        let is_from_back = self.params.order == Order::Paper;
        self.line(if is_from_back { line::FROM_BACK } else { line::CHILDREN });
        self.watch.event(Event::DecidedNode(id, Verdict::Partial));
        let nearest = nearest_octant(cell, self.view.eye.position);
        let farthest = (1 << S::Vector::AXES) - 1 - nearest;
        for octant in (0..1 << S::Vector::AXES).map(|k| k ^ if is_from_back { farthest } else { nearest }) {
            if let Some(child) = node.child(octant) {
                self.line(line::CHILD);
                self.render(child, octant_of(cell, octant), cutting);
            }
        }
        if O::LISTENS {
            self.settle(id);
        }
    }

    /// DrawGeometry: what the leaves at and below a cell refer to, each once a frame.
    fn draw_geometry(&mut self, id: NodeId) {
        let (tree, scene) = (self.tree, self.scene);
        let node = &tree.nodes()[id.at()];
        if let Some(hiding) = &mut self.hiding {
            hiding.add_leaf(id);
        }
        let looks_at_each = self.params.surfaces.one_sided;
        if id == NodeId(0) && !looks_at_each {
            // All of the scene: nothing is left to be shared.
            self.line(line::OWN);
            return self.out.prims.extend_from_slice(scene.live());
        }
        if !node.is_leaf() {
            if self.lists_marks && self.hiding.is_none() && !O::LISTENS {
                // Leaf by leaf there is nothing to be told.
                self.is_marked = true;
                return tree.references(id).iter().for_each(|&item| _ = self.done.mark(item));
            }
            return node.children().for_each(|child| self.draw_geometry(NodeId(child)));
        }
        // The verdict about the cell is about these as well: no other one can have drawn them.
        let (own, shared) = tree.of_leaf(id);
        let items = tree.items();
        if looks_at_each {
            own.iter().flat_map(|&item| items.prims(item)).for_each(|prim| self.draw(PrimId(prim), id));
        } else {
            self.line(line::OWN);
            match self.lists_marks {
                true => own.iter().for_each(|&item| _ = self.done.mark(item)),
                false => items.extend(&mut self.out.prims, own),
            }
        }
        self.is_marked |= !shared.is_empty();
        for &item in shared {
            self.line(line::EACH);
            self.line(line::ONCE);
            let was_drawn = self.done.mark(item);
            // Where marks are what is listed, there is more to do only if somebody listens.
            if (O::LISTENS || !self.lists_marks) && !was_drawn {
                items.prims(item).for_each(|prim| self.draw(PrimId(prim), id));
            }
        }
    }

    /// Draws a primitive with a leaf, unless it faces away.
    fn draw(&mut self, prim: PrimId, id: NodeId) {
        if self.params.surfaces.one_sided {
            self.line(line::FACES_AWAY);
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            if self.scene.faces_away(prim, self.view.eye.position) {
                return self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            }
        }
        self.line(line::DRAW_PRIM);
        self.watch.note(move || Evidence::Settled(Settled::Drawn { prim, node: id }));
        self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        if !self.lists_marks {
            self.out.prims.push(prim);
        }
    }

    /// Says what became of the primitives that the children of a cell share, now that all of them are done.
    fn settle(&mut self, id: NodeId) {
        self.line(line::SHARED);
        for &prim in self.tree.shared(id) {
            let item = self.tree.items().of(prim);
            if self.done.has(item) {
                continue;
            }
            self.line(line::SETTLED);
            let settled = self.settled(prim, item, id);
            self.watch.note(move || Evidence::Settled(settled));
            let verdict = match settled {
                Settled::InCubes { .. } => Verdict::Approximated,
                Settled::BehindCubes { .. } => Verdict::Presumed,
                _ => Verdict::Hidden,
            };
            self.watch.event(Event::DecidedPrim(prim, verdict));
        }
    }

    /// What became of a primitive that several cells below one share, none of which was drawn as geometry.
    fn settled(&self, prim: PrimId, item: PrimId, node: NodeId) -> Settled {
        let [is_behind, is_behind_cubes] = [0, 1].map(|k| self.hiding.is_some() && self.behind[k].has(item));
        if self.in_cubes.has(item) {
            Settled::InCubes { prim, node }
        } else if is_behind_cubes {
            Settled::BehindCubes { prim, node }
        } else if is_behind {
            Settled::Behind { prim, node }
        } else {
            // No part of it lies in a cell that is in view.
            Settled::OutOfView { prim, node }
        }
    }
}
