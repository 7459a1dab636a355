//! Cells behind what is drawn so far are left out. The paper names it as future work, "combining our approach
//! with some of these other methods", among them the hierarchical z-buffer (Section 6).
//!
//! Cells come front to back, so what was drawn before a cell may hide it:
//!
//! 1. geometry, as tiles ([`Tiled`]). It is drawn into them leaf by leaf, once something is asked. A cell is
//!    left out if no fragment of what it holds, and no sample of its cube, can be before what is in the
//!    tiles. So the picture stays the same, byte for byte.
//! 2. color cubes, as samples that are full ([`Saturation`]). A cell is left out if at each pixel that it can
//!    cover it lies behind geometry, or behind cubes that together let less than 1/1024 of the light through.
//!    The picture then differs by less than that in a linear channel. Proof, for one sample: what is left out
//!    begins behind the depth at which the last of those cubes is entered. If all of them show in the
//!    picture, what is behind them has less than 1/1024 of it, with the cell and without. If one of them does
//!    not, then because of geometry before it, which hides what is behind all of them as well.
//!
//! Of a primitive that several cells share each cell answers for the part in it, and for how near the whole
//! of it comes (see `raster::tiles`), so it is hidden if all of them are.
//!
//! Asked are cells that are at least [`ASKED_PX`] pixels wide: for a smaller one the question costs as much
//! as drawing it. Cost: that of drawing geometry into tiles, and of the questions.

use super::ColorCubes;
use super::code::line;
use super::evidence::{Evidence, Saturated};
use super::index::Occluders;
use super::space::Projected;
use crate::culling::depth::{
    Answer, Answered, Asking, DepthNote, Ground, Stage, TileStep, Tiled, ends, footprint,
};
use crate::geometry::{Aabb, BoxImage, Footprint, NodeId, PixelRect, Projection, View, nearest_depth};
use crate::method::{Event, Frame, Observer, State, Verdict};
use crate::raster::{CubeFaces, PyramidCell, Question, Saturation, StandIn};
use crate::scene::Scene;

/// Side on the screen from which on a cell is asked for: that of a tile.
pub(super) const ASKED_PX: f32 = 8.0;

/// What is drawn so far; empty where nobody asks.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct Drawn<S: Projected> {
    tiled: Tiled<S>,
    full: Saturation,
    behind_cubes: bool,
}

impl<S: Projected> State<S, ColorCubes> for Drawn<S> {
    // A copy of tiles and samples takes about as long as drawing this many leaves.
    const KEYFRAME_NOTES: usize = 1 << 13;
    fn begin(&mut self, frame: &Frame<'_, S, ColorCubes>) {
        let Some(occluders) = frame.index.occluders() else {
            *self = Self::default();
            return;
        };
        self.tiled.clear(frame.view, &occluders.clusters, frame.scene.prim_count());
        self.behind_cubes = frame.params.hides_behind_cubes();
        if self.behind_cubes {
            self.full.clear(frame.view);
        }
    }
    fn release(&mut self) {
        self.tiled.release();
    }
    fn apply(&mut self, _: &Scene<S>, note: &Evidence<S>) {
        match note {
            Evidence::Depth(note) => {
                if let Some(step) = note.tile_step() {
                    self.tiled.step(step);
                }
            }
            Evidence::Cube(cube) => self.put(&cube.cell, &cube.faces),
            _ => {}
        }
    }
}

impl<S: Projected> Drawn<S> {
    /// Puts a cube behind those that are drawn.
    fn put(&mut self, cell: &Aabb<S::Vector>, faces: &CubeFaces) {
        // A run and its film both come through here.
        if self.behind_cubes {
            self.full.put(cell, faces);
        }
    }
}

/// What a traversal asks.
pub(super) struct Hiding<'a, S: Projected> {
    drawn: &'a mut Drawn<S>,
    occluders: &'a Occluders<S::Vector>,
    view: &'a View<S>,
    projection: Projection<S::Vector>,
    /// Leaves that were drawn since something was asked last.
    waiting: Vec<NodeId>,
    one_sided: bool,
}

impl<'a, S: Projected> Hiding<'a, S> {
    /// For a frame whose parameters ask for it.
    pub fn new(frame: &Frame<'a, S, ColorCubes>, drawn: &'a mut Drawn<S>) -> Option<Self> {
        Some(Self {
            drawn,
            occluders: frame.index.occluders()?,
            view: frame.view,
            projection: frame.view.projection(),
            waiting: Vec::new(),
            one_sided: frame.params.surfaces.one_sided,
        })
    }
    /// Takes in a leaf whose geometry is drawn.
    pub fn add_leaf(&mut self, leaf: NodeId) {
        self.waiting.push(leaf);
    }
    /// Takes in a cube that is drawn, behind all others.
    pub fn add_cube(&mut self, cube: &StandIn<S::Vector>) {
        self.drawn.put(&cube.bounds, &cube.faces);
    }

    /// Whether a cell is hidden, and how it is left out then.
    pub fn hides<O: Observer<Evidence<S>>>(
        &mut self,
        id: NodeId,
        cell: &Aabb<S::Vector>,
        watch: &mut O,
    ) -> Option<Verdict> {
        watch.event(Event::Line(line::DRAW_WAITING));
        for leaf in std::mem::take(&mut self.waiting) {
            let one_sided = self.one_sided;
            watch.note(move || Evidence::Depth(DepthNote::Drawn(leaf, one_sided)));
            self.drawn.tiled.step(TileStep::Draw(leaf, one_sided));
        }
        watch.event(Event::Line(line::BEHIND));
        let whole = self.occluders.wholes[id.at()];
        // What is drawn of a primitive outside the cell may come nearer than the cell.
        let nearest = nearest_depth(&self.projection, &whole, self.view.eye.near);
        let near = 1.0 / self.view.eye.near;
        let decided = |is_hidden: bool, nearest: f32| Answer { is_hidden, nearest, reads: 0, decisive: None };
        let (pixels, answer, ground) = match footprint(self.view, &self.projection, cell) {
            Footprint::CrossesNear => (PixelRect::default(), decided(false, near), Ground::CrossesNear),
            Footprint::Outside => (PixelRect::default(), decided(true, near), Ground::BesideImage),
            Footprint::Seen(BoxImage { pixels, .. }) if pixels.is_empty() => {
                (pixels, decided(true, nearest), Ground::Cells)
            }
            Footprint::Seen(BoxImage { pixels, .. }) => {
                let boxes = Some([ends::<S>(cell), ends::<S>(&whole)]);
                // Exactly: a cell that is let through though it is hidden costs more than some tiles' depths.
                let question = Question { pixels, nearest, boxes, exact: true };
                let mut asking = Asking::new(&mut *watch, |_: Stage| None, Some(id));
                let is_hidden = self.drawn.tiled.hides(question, &mut asking);
                (pixels, asking.answer(is_hidden, nearest), Ground::Cells)
            }
        };
        let bounds = *cell;
        watch.note(move || {
            let answered = Answered { node: id, bounds, pixels, answer, ground, is_by_planes: true };
            Evidence::Depth(DepthNote::Answered(answered))
        });
        if answer.is_hidden {
            watch.event(Event::Line(line::LEFT_OUT));
            return Some(Verdict::Hidden);
        }
        let is_behind = self.drawn.behind_cubes && self.is_behind_cubes(id, (pixels, nearest), watch);
        is_behind.then(|| {
            watch.event(Event::Line(line::LEFT_OUT));
            Verdict::Presumed
        })
    }

    /// Whether at each of some pixels a cell is behind geometry or full samples.
    fn is_behind_cubes<O: Observer<Evidence<S>>>(
        &self,
        node: NodeId,
        (pixels, nearest): (PixelRect, f32),
        watch: &mut O,
    ) -> bool {
        watch.event(Event::Line(line::BEHIND_CUBES));
        let mut open = None;
        // Of what crosses the near plane the pixels are not known.
        if !pixels.is_empty() {
            let [columns, rows] =
                [pixels.x0 / 8..pixels.x1.div_ceil(8), pixels.y0 / 4..pixels.y1.div_ceil(4)];
            open = rows
                .flat_map(|y| columns.clone().map(move |x| [x, y].map(|n| n as u16)))
                .map(|[x, y]| PyramidCell { level: PyramidCell::TILE, x, y })
                .find(|&tile| {
                    let among = self.drawn.full.open(tile, pixels, nearest);
                    among != 0 && self.drawn.tiled.tiles().open_bounds(tile, nearest, among)[1] != 0
                });
        }
        let is_behind = !pixels.is_empty() && open.is_none();
        watch.note(move || Evidence::Saturated(Saturated { node, pixels, nearest, open, is_behind }));
        is_behind
    }
}
