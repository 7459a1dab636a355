//! Forests without copies: one scene many times over, on a square that grows fourfold from level to level
//! (Section 5.2, "recursively instancing the tree model").
//!
//! A scene with 859 million triangles is neither stored nor transformed. There is one scene with its tree of
//! cells; above it stands a tree over translations:
//!
//! 1. its leaves are the scene's own tree, its nodes hold four of the next lower level, side by side on the
//!    ground, and in space nothing above them. Nodes of a level hold the same, so one cube a level is kept,
//!    composed of its children's as any other (Section 4): memory is O(levels);
//! 2. it is walked by the same rules: what is outside the frustum is culled, what is small enough is drawn as
//!    its cube, children come the nearest first;
//! 3. a copy that is moved by an offset is the scene seen from an eye that is moved back by it. [`Walk`] and
//!    the rasterizer are handed such an eye, and find what they would find in a stored copy.
//!
//! Offsets are found in 64 bits, since a square of 1,024 × 1,024 trees is 10 km wide; an eye is rounded to 32
//! bits only where it stands in a copy's space, so by 2⁻²⁴ of its distance from there at most. With a pitch
//! that is a multiple of 2⁻¹⁰, and an eye on that grid, nothing is rounded up to a distance of 8 km. Within a
//! copy all is relative to the eye, as ever.
//!
//! Cost: O(cells visited + primitives of near leaves), as a stored scene's; counts are of 64 bits, since 2²⁰
//! trees have 55 G triangles.

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use super::evidence::Evidence;
use super::faces::{Faces, composed};
use super::index::CubeTree;
use super::space::Projected;
use super::walk::{Walk, nearest_octant, pixels_at_depth_1, size_at};
use super::{ColorCubes, Order, Params};
use crate::geometry::{Aabb, Eye, Frustum, FrustumTest, NodeId, PrimId, Space, Vector, View};
use crate::index::CellNode;
use crate::method::{DrawList, Event, Observer, SettingError, Settings, Unobserved, params};
use crate::raster::{Canvas, CubeFaces, Light, Options, StandIn, Target, paint};
use crate::scene::{Progress, Scene, Surfaces};

/// How far apart copies stand is a multiple of 1/this, world units.
const PITCH_GRID: f64 = 1024.0;

/// A scene to make forests of, with the index that all copies share.
pub(crate) struct Stock<S: Space> {
    scene: Arc<Scene<S>>,
    index: CubeTree<S>,
    params: Params,
    pitch: f64,
}

impl<S: Projected> Stock<S> {
    /// Builds the index; `Ok(None)` when cancelled. Cubes are drawn in exact order, none is refused for its
    /// error, which is not known of many copies, and light comes through nothing but cubes, whatever is set.
    ///
    /// # Errors
    /// A setting that does not fit the method.
    pub fn new(
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, SettingError> {
        let params = params::<S, ColorCubes>(settings)?;
        let surfaces = Surfaces { solid: true, ..params.surfaces };
        let params = Params { order: Order::Exact, error_bound: 0.0, surfaces, ..params };
        // It fails only on a saved preprocess, and none is given.
        let index = CubeTree::build(scene, &params, None, progress).unwrap_or_default();
        Ok(index.map(|index| {
            let root = index.tree().root();
            let side = (0..S::Vector::AXES)
                .map(|a| f64::from(root.max.get(a)) - f64::from(root.min.get(a)))
                .fold(0.0, f64::max);
            let pitch = (side * PITCH_GRID).ceil() / PITCH_GRID;
            Self { scene: scene.clone(), index, params, pitch }
        }))
    }
    /// How far apart copies stand, world units: the side of the root's cell, up to the next multiple of 2⁻¹⁰.
    pub fn pitch(&self) -> f64 {
        self.pitch
    }
    /// The cell that is a copy's.
    pub fn root(&self) -> &Aabb<S::Vector> {
        self.index.tree().root()
    }
    /// The square of `4^levels` copies about the origin.
    ///
    /// # Panics
    /// If there are more than [`MOST_LEVELS`].
    pub fn forest(&self, levels: u32) -> Forest<'_, S> {
        assert!(levels <= MOST_LEVELS, "at most {MOST_LEVELS} levels");
        let own = self.index.faces(NodeId(0));
        let own: Faces = std::array::from_fn(|face| own.get(face));
        let cubes = squares::<S::Vector>(own, levels).iter().map(CubeFaces::new).collect();
        Forest { stock: self, levels, cubes }
    }
}

/// Levels of a forest at most: 2³⁰ copies, whose primitives 64 bits count.
pub(crate) const MOST_LEVELS: u32 = 15;

/// Whether the children of an octant hold something: those on the ground. In space the second axis is up;
/// flatland is all ground.
fn is_on_ground<V: Vector>(octant: usize) -> bool {
    V::AXES == 2 || octant & 2 == 0
}

/// The axes along the ground.
fn ground<V: Vector>() -> [usize; 2] {
    [0, V::AXES - 1]
}

/// The faces of squares of four, of four of these, and so on, over copies with these faces.
pub(super) fn squares<V: Vector>(copy: Faces, levels: u32) -> Vec<Faces> {
    let grown = std::iter::successors(Some(copy), |cell| {
        let of = |octant: usize, face: usize| if is_on_ground::<V>(octant) { cell[face] } else { [0.0; 4] };
        Some(composed::<V>(of))
    });
    grown.skip(1).take(levels as usize).collect()
}

/// Copies of a scene on a square.
pub(crate) struct Forest<'a, S: Space> {
    stock: &'a Stock<S>,
    levels: u32,
    /// Of the nodes of each level above the copies, from the lowest up.
    cubes: Vec<CubeFaces>,
}

/// What a frame of a forest draws.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sighting<S: Space> {
    /// The primitives and cubes of all copies, one copy after the other, the nearest first. A cube over
    /// several copies has the node of the root.
    pub list: DrawList<S>,
    /// Which of them are whose.
    pub copies: Vec<Copied<S::Vector>>,
}

/// What is drawn of one copy, or one cube over several of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Copied<V> {
    /// Where the eye is in its space.
    pub eye: V,
    pub prims: Range<usize>,
    pub stand_ins: Range<usize>,
}

/// What a frame looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counted {
    /// Cells that were visited, those over several copies as well.
    pub cells: u64,
    /// References of leaves that were drawn as geometry.
    pub references: u64,
    /// Cubes and primitives that were drawn.
    pub cubes: u64,
    pub prims: u64,
    /// What all of that takes up in memory, if each copy had cells and primitives of its own (Section 3.1,
    /// the working set).
    pub bytes: u64,
}

/// Counts a frame. It looks at notes, but has nothing done for them.
#[derive(Default)]
struct Watch {
    cells: u64,
    references: u64,
}

impl<S: Projected> Observer<Evidence<S>> for Watch {
    const LISTENS: bool = false;
    fn event(&mut self, event: Event) {
        self.cells += u64::from(matches!(event, Event::Entered(_)));
    }
    fn note(&mut self, note: impl FnOnce() -> Evidence<S>) {
        if let Evidence::Geometry { references, .. } = note() {
            self.references += u64::from(references);
        }
    }
}

/// A node over copies, or a copy, as the descent meets it.
struct Met<V> {
    /// Levels above the copies.
    height: u32,
    /// Where the eye is in the space of the lowest of its copies.
    eye: V,
    /// Its cell in that space.
    cell: Aabb<V>,
    /// The planes that cut it.
    cutting: u8,
}

/// The way down from the whole square.
struct Descent<'a, S: Space> {
    forest: &'a Forest<'a, S>,
    eye: S::Vector,
    frustum: Frustum<S::Vector>,
    /// Nodes over several copies that were met.
    nodes: u64,
}

impl<S: Projected> Descent<'_, S> {
    /// Calls `visit` with what may be in view of a node and below it, the nearest first; of what it says no
    /// to nothing below is looked at. A copy is not tested: its own root is. `corner`: the lowest copy,
    /// counted along the ground.
    fn go(
        &mut self,
        (height, corner): (u32, [u32; 2]),
        planes: u8,
        visit: &mut impl FnMut(&Met<S::Vector>) -> bool,
    ) {
        let (eye, cell) = (self.forest.eye_at(self.eye, corner), self.forest.cell(height));
        if height == 0 {
            visit(&Met { height, eye, cell, cutting: planes });
            return;
        }
        self.nodes += 1;
        self.frustum.eye = eye;
        let cutting = match self.frustum.test(&cell, planes) {
            FrustumTest::Outside(_) => return,
            FrustumTest::Partial(cutting) => cutting,
            FrustumTest::Inside => 0,
        };
        if !visit(&Met { height, eye, cell, cutting }) {
            return;
        }
        let (nearest, below) = (nearest_octant(&cell, eye), height - 1);
        let axes = ground::<S::Vector>();
        for octant in (0..1 << S::Vector::AXES).map(|k| k ^ nearest).filter(|o| is_on_ground::<S::Vector>(*o))
        {
            let lowest = |k: usize| corner[k] + ((octant as u32 >> axes[k] & 1) << below);
            self.go((below, [lowest(0), lowest(1)]), cutting, visit);
        }
    }
}

impl<S: Projected> Forest<'_, S> {
    /// How many copies there are.
    pub fn copies(&self) -> u64 {
        1 << (2 * self.levels)
    }
    /// How many primitives all of them have.
    pub fn prims(&self) -> u64 {
        self.copies() * self.stock.scene.live().len() as u64
    }
    /// Where an eye is in the space of a copy, counted along the ground.
    fn eye_at(&self, eye: S::Vector, copy: [u32; 2]) -> S::Vector {
        let middle = 0.5 * f64::from((1u32 << self.levels) - 1);
        let mut at: [f64; 3] =
            std::array::from_fn(|a| if a < S::Vector::AXES { eye.get(a).into() } else { 0.0 });
        for (axis, number) in ground::<S::Vector>().into_iter().zip(copy) {
            at[axis] -= (f64::from(number) - middle) * self.stock.pitch;
        }
        S::Vector::from_fn(|a| at[a] as f32)
    }
    /// The cell of a node so many levels above the copies, in the space of the lowest of its copies: the same
    /// for all of them.
    fn cell(&self, height: u32) -> Aabb<S::Vector> {
        let root = *self.stock.root();
        let side = self.stock.pitch * f64::from(1u32 << height);
        let upper = |a: usize| (f64::from(root.min.get(a)) + side) as f32;
        if height == 0 { root } else { Aabb { min: root.min, max: S::Vector::from_fn(upper) } }
    }
    fn descent(&self, view: &View<S>) -> Descent<'_, S> {
        Descent { forest: self, eye: view.eye.position, frustum: view.frustum(), nodes: 0 }
    }
    /// The whole square.
    fn whole(&self) -> (u32, [u32; 2]) {
        (self.levels, [0, 0])
    }

    /// What is drawn of it from a view.
    pub fn cull(&self, view: &View<S>) -> Sighting<S> {
        self.watched(view, &mut Unobserved).0
    }
    /// The same, counted.
    pub fn count(&self, view: &View<S>) -> (Sighting<S>, Counted) {
        let mut watch = Watch::default();
        let (seen, nodes) = self.watched(view, &mut watch);
        let cells = watch.cells + nodes;
        let (cubes, prims) = (seen.list.stand_ins.len() as u64, seen.list.prims.len() as u64);
        let scene = &self.stock.scene;
        let prim_bytes = scene.memory_bytes() as f64 / scene.prim_count().max(1) as f64;
        let bytes = cells * (size_of::<CellNode>() + size_of::<CubeFaces>()) as u64
            + watch.references * size_of::<PrimId>() as u64
            + (prims as f64 * prim_bytes) as u64;
        (seen, Counted { cells, references: watch.references, cubes, prims, bytes })
    }
    /// What is drawn, and how many nodes over several copies were met; the others are told to whom it may
    /// concern.
    fn watched<O: Observer<Evidence<S>>>(&self, view: &View<S>, watch: &mut O) -> (Sighting<S>, u64) {
        let Stock { scene, index, params, pitch } = self.stock;
        let mut list = DrawList { light: Light::Fixed, ..DrawList::default() };
        let mut copies = Vec::new();
        let mut walk = Walk::new((index, scene), view, params, &mut list, watch);
        let (forward, side) = (view.eye.forward(), *pitch as f32 * pixels_at_depth_1(view));
        let mut descent = self.descent(view);
        descent.go(self.whole(), Frustum::<S::Vector>::ALL, &mut |met| {
            let out = walk.drawn();
            let (prims, stand_ins) = (out.prims.len(), out.stand_ins.len());
            if met.height == 0 {
                walk.move_eye(met.eye);
                walk.visit(met.cutting);
            } else {
                // As of any cell of the scene's own.
                let depth = forward.dot(met.cell.center() - met.eye);
                let size = size_at(depth, side * (1u32 << met.height) as f32, view.eye.near);
                if size > params.pixel_threshold {
                    return true;
                }
                let faces = self.cubes[met.height as usize - 1];
                let after = prims as u32;
                out.stand_ins.push(StandIn { node: NodeId(0), bounds: met.cell, faces, after });
            }
            let out = walk.drawn();
            let (prims, stand_ins) = (prims..out.prims.len(), stand_ins..out.stand_ins.len());
            if !(prims.is_empty() && stand_ins.is_empty()) {
                copies.push(Copied { eye: met.eye, prims, stand_ins });
            }
            false
        });
        let nodes = descent.nodes;
        (Sighting { list, copies }, nodes)
    }

    /// Draws what was seen: the primitives of each copy from where the eye is in its space, then all cubes,
    /// the nearest first. An item of the image is that of the scene, of whichever copy.
    pub fn draw(
        &self,
        seen: &Sighting<S>,
        (image, canvas): (&mut Target, &mut Canvas),
        view: &View<S>,
        options: &Options,
    ) {
        let options = Options { surfaces: self.stock.params.surfaces, ..*options };
        image.clear(view);
        for copy in seen.copies.iter().filter(|copy| !copy.prims.is_empty()) {
            let prims = &seen.list.prims[copy.prims.clone()];
            S::draw(image, &self.stock.scene, &seen_from(view, copy.eye), prims, &options);
        }
        canvas.clear(view);
        let with_cubes = seen.copies.iter().filter(|copy| !copy.stand_ins.is_empty());
        let cubes: Vec<_> =
            with_cubes.map(|copy| (copy.eye, &seen.list.stand_ins[copy.stand_ins.clone()])).collect();
        canvas.composite_copies(&cubes, image, view, &options);
    }
    /// Draws all triangles of all copies that are in view, and no cube. Returns how many.
    pub fn draw_geometry(&self, image: &mut Target, view: &View<S>, options: &Options) -> u64 {
        let Stock { scene, params, .. } = self.stock;
        let options = Options { surfaces: params.surfaces, ..*options };
        let (bounds, mut frustum, mut count) = (scene.bounds(), view.frustum(), 0);
        image.clear(view);
        self.descent(view).go(self.whole(), Frustum::<S::Vector>::ALL, &mut |met| {
            if met.height > 0 {
                return true;
            }
            frustum.eye = met.eye;
            if !frustum.excludes(&bounds) {
                S::draw(image, scene, &seen_from(view, met.eye), scene.live(), &options);
                count += scene.live().len() as u64;
            }
            false
        });
        count
    }
    /// The picture of what was seen: RGBA, sRGB-encoded, row by row.
    pub fn paint(&self, seen: &Sighting<S>, view: &View<S>, background: [f32; 3]) -> Vec<u8> {
        let (mut image, mut canvas) = (Target::default(), Canvas::default());
        self.draw(seen, (&mut image, &mut canvas), view, &Options::default());
        paint(&image, &canvas, &self.stock.scene, view, (seen.list.light, background))
    }
}

/// A view from another place that looks the same way.
fn seen_from<S: Space>(view: &View<S>, eye: S::Vector) -> View<S> {
    if eye == view.eye.position {
        return *view;
    }
    // A target as far away as the eye is from the origin is rounded by as little of its distance; twice a
    // direction is the same direction.
    let mut toward = view.eye.target - view.eye.position;
    while toward.length() < eye.length() {
        toward = toward * 2.0;
    }
    View { eye: Eye { position: eye, target: eye + toward, ..view.eye }, ..*view }
}
