//! The depths of a frame as tiles ([`Tiles`]): the large state that a run changes and a film replays.
//!
//! [`Tiled::clear`] for a view, [`Tiled::draw`] what nodes hold, then [`Tiled::hides`] for what is asked.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::faces::{Faces, footprint};
use crate::geometry::{
    Aabb, BoxImage, Footprint, Frustum, NodeId, PixelRect, PrimId, Projection, Space, Vector, View,
};
use crate::raster::{
    Answer, Boxes, Clusters, Fate, Hears, How, Isa, Options, Outcome, PyramidCell, Question, Read, Tiles,
};
use crate::scene::Scene;

/// A change of the tiles. A run makes it, and a film makes it again from the note that holds its operands.
#[derive(Clone, Copy, Debug)]
pub enum TileStep {
    /// A block is brought up to date from its tiles, or a tile by exact depths.
    Refresh(PyramidCell),
    /// What a node holds, and is not drawn yet, is drawn: with fronts only, or from both sides.
    Draw(NodeId, bool),
}

/// A view with its projection and its planes, which every question about a box needs.
#[derive(Clone, Copy, Debug)]
pub struct Projected<S: Space> {
    pub view: View<S>,
    pub projection: Projection<S::Vector>,
    pub frustum: Frustum<S::Vector>,
}

/// Tiles, the view they are for, and what can be drawn into them.
#[derive(Clone, Debug, Default)]
pub struct Tiled<S: Faces> {
    projected: Option<Projected<S>>,
    tiles: Tiles,
    clusters: Arc<Clusters>,
    /// Of each primitive that nodes share whether it is drawn.
    drawn: Vec<bool>,
    fates: Vec<(PrimId, Fate)>,
}

/// Tiles of the same view with the same drawn into them.
impl<S: Faces> PartialEq for Tiled<S> {
    fn eq(&self, other: &Self) -> bool {
        // The view's projection follows from it, and fates are no state: they are what the last drawing said.
        let view = |b: &Self| b.projected.as_ref().map(|s| s.view);
        view(self) == view(other) && self.tiles == other.tiles && self.drawn == other.drawn
    }
}

impl<S: Faces> Tiled<S> {
    /// The groups of a node: what is its own, and what it shares with others.
    fn groups(node: NodeId) -> [usize; 2] {
        [2 * node.at(), 2 * node.at() + 1]
    }
    /// Empties them for a view. `clusters`: two groups for each node, in the order of the nodes, what is its
    /// own and what it shares with others; of a scene of `prims` primitives.
    pub fn clear(&mut self, view: &View<S>, clusters: &Arc<Clusters>, prims: usize) {
        self.tiles.clear(view, true);
        self.projected =
            Some(Projected { view: *view, projection: view.projection(), frustum: view.frustum() });
        self.clusters = clusters.clone();
        self.drawn.clear();
        self.drawn.resize(prims, false);
    }
    /// Lets go of the clusters, until they are emptied for a view.
    pub fn release(&mut self) {
        self.clusters = Arc::default();
    }
    /// Empties them for another view of the same.
    pub fn empty(&mut self, view: &View<S>) {
        let (clusters, prims) = (self.clusters.clone(), self.drawn.len());
        self.clear(view, &clusters, prims);
    }
    /// The view they are for, with its projection and planes, once there is one.
    pub fn projected(&self) -> Option<&Projected<S>> {
        self.projected.as_ref()
    }
    /// The tiles.
    pub fn tiles(&self) -> &Tiles {
        &self.tiles
    }
    /// Makes a change. Of [`TileStep::Draw`] it returns what became of each primitive that was to be drawn.
    pub fn step(&mut self, step: TileStep) -> &[(PrimId, Fate)] {
        // A run and its film both come through here, so that the same operands make the same change.
        self.fates.clear();
        match step {
            TileStep::Refresh(cell) => self.tiles.refresh(cell, Isa::best()),
            TileStep::Draw(node, one_sided) => self.draw(node, one_sided, false),
        }
        &self.fates
    }
    /// Draws of what a node holds, and is not drawn yet, what is not hidden; with fronts only, or from both
    /// sides. What became of each primitive. Where much of it is hidden that takes less time than
    /// [`TileStep::Draw`].
    pub fn draw_unhidden(&mut self, node: NodeId, one_sided: bool) -> &[(PrimId, Fate)] {
        self.fates.clear();
        self.draw(node, one_sided, true);
        &self.fates
    }
    /// Draws all that is a node's own and faces the eye, with fronts only or from both sides. What fills no
    /// vector waits: nothing may be asked before [`Tiled::settle`].
    pub fn gather(&mut self, node: NodeId, one_sided: bool) {
        self.tiles.gather(&self.clusters, Self::groups(node)[0], one_sided, Isa::best());
    }
    /// The primitives that [`Tiled::gather`] draws of a node.
    pub fn gathered_of(&self, node: NodeId) -> impl Iterator<Item = PrimId> {
        self.clusters.prims_of(Self::groups(node)[0])
    }
    /// Draws what waits. The primitives, of all that were gathered, that may show; one may be told twice.
    pub fn settle(&mut self) -> impl Iterator<Item = PrimId> {
        self.tiles.settle(&self.clusters, Isa::best())
    }
    /// A copy of the tiles in which nothing waits.
    pub fn settled(&self) -> Tiles {
        let mut tiles = self.tiles.clone();
        if tiles.waits() {
            drop(tiles.settle(&self.clusters, Isa::best()));
        }
        tiles
    }
    fn draw(&mut self, node: NodeId, one_sided: bool, tested: bool) {
        let [own, shared] = Self::groups(node);
        let groups = [(own, &[][..]), (shared, &self.drawn[..])];
        let hows = groups.map(|(group, skipped)| (group, How { one_sided, skipped, tested }));
        self.tiles.draw_groups(&self.clusters, &hows, Isa::best(), &mut self.fates);
        for (group, skipped) in groups {
            // What covers nothing, or lets light through, hides nothing: whoever draws it asks for its box.
            let apart =
                self.clusters.apart(group).iter().filter(|p| !skipped.get(p.at()).is_some_and(|d| *d));
            self.fates.extend(apart.map(|&p| (p, Fate::Apart)));
        }
        // Georges 1995, Section 3.1: what cubes share is marked when it is drawn, so that it is drawn once.
        for (prim, _) in &self.fates {
            self.drawn[prim.at()] = true;
        }
    }
    /// Whether a primitive that nodes share was drawn.
    pub fn is_drawn(&self, prim: PrimId) -> bool {
        self.drawn[prim.at()]
    }
    /// Whether something is hidden by what is drawn. What is read goes to `hears`; what changes is what
    /// [`TileStep::Refresh`] of the cells changes that it hears of.
    pub fn hides<H: Hears>(&mut self, question: Question, hears: &mut H) -> bool {
        self.tiles.hides(question, Isa::best(), hears)
    }
    /// Whether what lies in these pixels, no nearer than a depth, is behind all that covers any of them. What
    /// is read and what changes goes to `hears`, as for [`Tiled::hides`].
    pub fn is_behind<H: Hears>(&mut self, pixels: PixelRect, nearest: f32, hears: &mut H) -> bool {
        self.tiles.is_behind(pixels, nearest, Isa::best(), hears)
    }
    /// The depths of all pixels, row by row. What is known of tiles becomes exact.
    pub fn depths(&mut self) -> Vec<f32> {
        self.tiles.depths(Isa::best())
    }
    /// Whether a box is hidden by what is drawn, by its planes, and its nearest depth, `1/w`; `None` if it is
    /// out of view. One that reaches the near plane is not hidden. `exact`: where tiles do not decide, the
    /// depths of their pixels do.
    pub fn hides_box<H: Hears>(
        &mut self,
        bounds: &Aabb<S::Vector>,
        exact: bool,
        hears: &mut H,
    ) -> Option<(bool, f32)> {
        let Projected { view, projection, frustum } = self.projected.as_ref()?;
        // All planes at a time, by the bound that keeps primitives out of the image.
        if frustum.excludes(bounds) {
            return None;
        }
        match footprint(view, projection, bounds) {
            Footprint::Outside => None,
            // No finite rectangle bounds what reaches the near plane, so no tile can decide.
            Footprint::CrossesNear => Some((false, 1.0 / view.eye.near)),
            Footprint::Seen(BoxImage { pixels, nearest }) => {
                let boxes = Some([ends::<S>(bounds); 2]);
                Some((self.hides(Question { pixels, nearest, boxes, exact }, hears), nearest))
            }
        }
    }
    /// The pixels of a tile at which something that near shows; see [`Tiles::open`].
    pub fn open(&mut self, tile: PyramidCell, nearest: f32, among: u32) -> u32 {
        self.tiles.open(tile, nearest, among, Isa::best())
    }
    /// Whether each of many boxes is hidden, by planes and exactly; `None` if it is out of view.
    pub fn hides_all(&mut self, boxes: &Boxes) -> Vec<Option<bool>> {
        let mut answers = Vec::new();
        self.tiles.hides_all(boxes, true, Isa::best(), &mut answers);
        let is_hidden = |a: &Answer| (*a != Answer::Outside).then_some(*a == Answer::Hidden);
        answers.iter().map(is_hidden).collect()
    }
}

/// Least and greatest corner of a box as tiles are asked for it; flatland has a third axis of no size.
pub fn ends<S: Space>(bounds: &Aabb<S::Vector>) -> [[f32; 3]; 2] {
    let widen = |v: S::Vector| [0, 1, 2].map(|a| if a < S::Vector::AXES { v.get(a) } else { 0.0 });
    [widen(bounds.min), widen(bounds.max)]
}

/// Of the tiles that a primitive covers the one in which it comes nearest to showing, with its nearest depth
/// there; `None` if it covers no pixel.
pub fn deciding<S: Faces>(tiles: &Tiles, scene: &Scene<S>, view: &View<S>, prim: PrimId) -> Option<Read> {
    let mut nearest: BTreeMap<(u16, u16), f32> = BTreeMap::new();
    S::fragments(scene, view, prim, &Options::default(), &mut |at, depth| {
        let (x, y) = (at as u32 % view.width, at as u32 / view.width);
        let least = nearest.entry(((y / 4) as u16, (x / 8) as u16)).or_insert(depth);
        *least = least.max(depth);
    });
    let reads = nearest.into_iter().map(|((y, x), nearest)| {
        let cell = PyramidCell { level: PyramidCell::TILE, x, y };
        let held = tiles.held(cell);
        Read { cell, held, nearest, outcome: if nearest >= held { Outcome::Shows } else { Outcome::Behind } }
    });
    reads.reduce(|a, b| if b.held - b.nearest < a.held - a.nearest { b } else { a })
}
