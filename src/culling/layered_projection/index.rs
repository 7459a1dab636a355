//! What is built once: cells, which primitives meet which cell, and both as bytes.
//!
//! Klosowski and Silva 2000, Sections 3.1, 4.3 and 5.1: 1. divide space into cells ([`super::cells`]);
//! 2. assign to each cell the primitives that meet it, and find ρ_max, the most that meet any. Instead of
//! marking every primitive that was drawn (Section 4.1), those that meet one cell alone are kept apart: only
//! the others need a mark. To the rest of the house it is a tree of two levels: the region, and below it the
//! cells. 3. Where depths will be asked (Section 6), what cells hold is made ready to be drawn into tiles.

use std::ops::Range;
use std::sync::Arc;

use super::Params;
use super::cells::Cells;
use super::saved::{self, Key};
use crate::geometry::{Aabb, CellId, NodeId, PrimId, Space};
use crate::index::Hierarchy;
use crate::index::tessellation::{Assignment, Cellular, Tessellation};
use crate::raster::Clusters;
use crate::scene::{Part, Progress, Scene};

/// Cells and what is in them.
#[derive(Clone, Debug)]
pub struct Index<S: Cellular> {
    pub cells: Cells<S>,
    pub assignment: Assignment,
    /// Where depths are asked, what is drawn into tiles, two groups a node: of the root nothing and what
    /// several cells share, of each cell what meets it alone and what it shares.
    pub clusters: Option<Arc<Clusters>>,
    /// How many primitives of each cell hide what is behind them; all of them if there is no table.
    hiding: Option<Vec<u32>>,
    /// ρ_max: the most of any cell.
    most: u32,
    key: Key,
    bounds: Aabb<S::Vector>,
}

impl<S: Cellular> Index<S> {
    /// Builds it. `None` when cancelled.
    pub fn build(scene: &Arc<Scene<S>>, params: &Params, progress: &dyn Progress) -> Option<Self> {
        // 1. and 2.: assigning takes the larger part of the time, so it gets the larger part of the bar.
        progress.report(0.0, "dividing space into cells");
        let cells = Cells::build(scene, params, &Part { whole: progress, start: 0.0, length: 0.3 })?;
        // "A naive assignment" (Section 4.3): every cell that a primitive meets lists it.
        let assignment =
            Assignment::new(scene, cells.any(), &Part { whole: progress, start: 0.3, length: 0.6 })?;
        progress.report(0.9, "making clusters");
        Some(Self::of(scene, params, cells, assignment))
    }
    /// Builds it from bytes.
    ///
    /// # Errors
    /// Why they do not fit the scene and the parameters.
    pub fn restore(scene: &Arc<Scene<S>>, params: &Params, bytes: &[u8]) -> Result<Self, String> {
        // The key comes from what was asked for, so the bytes have to prove that they fit. ρ_max is not among
        // them: it is counted again.
        let (cells, assignment) = saved::read(bytes, &saved::key(scene, params), scene)?;
        Ok(Self::of(scene, params, cells, assignment))
    }
    fn of(scene: &Arc<Scene<S>>, params: &Params, cells: Cells<S>, assignment: Assignment) -> Self {
        // The root's box holds the scene and every cell, whichever reaches farther.
        let all = (0..cells.any().count() as u32).map(|c| cells.any().bounds(CellId(c)));
        let bounds = all.fold(scene.bounds(), |a, b| a.union(b));
        let key = saved::key(scene, params);
        let clusters = None;
        let mut made =
            Self { cells, most: assignment.most(), assignment, clusters, hiding: None, key, bounds };
        if params.asks_depths() {
            made.clusters = Some(Arc::new(made.make_ready(scene, params)));
        }
        if params.surfaces.any_through(scene) {
            // The paper knows opaque primitives only: what lets light through adds nothing to a cell's
            // solidity.
            let hides = |p: &PrimId| !params.surfaces.show_through(scene, *p);
            let of_cell = |c: u32| made.prims_of(CellId(c)).filter(hides).count() as u32;
            let hiding: Vec<u32> = (0..made.count() as u32).map(of_cell).collect();
            made.most = hiding.iter().copied().max().unwrap_or(0);
            made.hiding = Some(hiding);
        }
        made
    }
    /// 3. For [`Index::clusters`].
    fn make_ready(&self, scene: &Scene<S>, params: &Params) -> Clusters {
        let assignment = &self.assignment;
        // Of what is shared cells keep numbers.
        let shared = |cell| -> Vec<PrimId> {
            assignment.shared(cell).iter().map(|n| assignment.all_shared()[*n as usize]).collect()
        };
        let cells = || (0..self.count() as u32).map(CellId);
        let shared: Vec<Vec<PrimId>> = cells().map(shared).collect();
        let of_cells = cells().zip(&shared).flat_map(|(cell, shared)| [assignment.own(cell), &shared[..]]);
        Clusters::new(scene, params.surfaces, [&[][..], assignment.all_shared()].into_iter().chain(of_cells))
    }
    /// The primitives that meet a cell: those of it alone, then the shared ones.
    pub fn prims_of(&self, cell: CellId) -> impl Iterator<Item = PrimId> {
        let shared = self.assignment.shared(cell).iter().map(|n| self.assignment.all_shared()[*n as usize]);
        self.assignment.own(cell).iter().copied().chain(shared)
    }
    /// |c|, of the primitives that hide what is behind them.
    #[inline]
    pub fn hiding(&self, cell: CellId) -> u32 {
        self.hiding.as_ref().map_or_else(|| self.assignment.held(cell), |hiding| hiding[cell.at()])
    }
    /// ρ_max, the most such primitives that meet any cell (Section 3.1).
    pub fn most(&self) -> u32 {
        self.most
    }
    /// Number of cells.
    pub fn count(&self) -> usize {
        self.cells.any().count()
    }
}

/// The node that stands for a cell.
pub fn node_of(cell: CellId) -> NodeId {
    // 0 is the root.
    NodeId(cell.0 + 1)
}

/// The cell of a node other than the root.
pub fn cell_of(node: NodeId) -> Option<CellId> {
    node.0.checked_sub(1).map(CellId)
}

impl<S: Cellular> Hierarchy<S> for Index<S> {
    fn node_count(&self) -> usize {
        self.count() + 1
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        cell_of(node).map_or(self.bounds, |cell| self.cells.any().bounds(cell))
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        cell_of(node).map(|_| NodeId(0))
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        if node.0 == 0 { 1..self.count() as u32 + 1 } else { 0..0 }
    }
    fn level(&self, node: NodeId) -> u32 {
        u32::from(node.0 != 0)
    }
    /// Of a cell those that meet no other cell: deciding it decides them alone.
    fn prims(&self, node: NodeId) -> &[PrimId] {
        cell_of(node).map_or(self.assignment.all(), |cell| self.assignment.own(cell))
    }
    fn held(&self, node: NodeId) -> usize {
        // |c|, which solidity is about: shared primitives count in each of their cells.
        cell_of(node).map_or(self.assignment.all().len(), |cell| self.assignment.held(cell) as usize)
    }
    fn edges(&self, node: NodeId) -> Option<Vec<[<S as Space>::Vector; 2]>> {
        match &self.cells {
            Cells::Simplices(cells) => cell_of(node).map(|cell| cells.edges(cell)),
            Cells::Boxes(_) => None,
        }
    }
    fn save(&self) -> Option<Vec<u8>> {
        // Made when asked for: kept as bytes too, the tables would take twice the memory.
        Some(saved::write(&self.key, &self.cells, &self.assignment))
    }
    fn bytes(&self) -> usize {
        let clusters = self.clusters.as_ref().map_or(0, |clusters| clusters.bytes());
        self.cells.any().bytes() + self.assignment.bytes() + clusters
    }
}
