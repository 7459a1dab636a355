//! Which primitives meet which cells.
//!
//! Klosowski and Silva 2000, Sections 3.1 and 4.1: a cell lists every primitive that is in it or meets its
//! boundary, so a primitive may be in several lists and must be drawn only once. Here a list has two parts:
//! primitives of this cell alone, which need no mark, and shared ones by a number under which they are
//! marked.
//!
//! 1. Each primitive finds the cells that it meets (Section 3.1 scan-converts it into them).
//! 2. Pairs of cell and primitive are sorted by cell into one table a kind.
//! 3. A last pass finds the most primitives of any cell, ρ_max (Section 3.1).

use super::{Cellular, Tessellation, Tried};
use crate::geometry::{CellId, PrimId};
use crate::scene::{Progress, Scene};

/// Primitives from one report of progress to the next.
const PATIENCE: usize = 1 << 14;

/// The primitives of every cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// Primitives of one cell alone, cell by cell; then the shared ones, ascending.
    prims: Vec<PrimId>,
    own_starts: Vec<u32>,
    /// Numbers of shared primitives, cell by cell.
    shared: Vec<u32>,
    shared_starts: Vec<u32>,
    most: u32,
}

impl Assignment {
    /// Assigns the live primitives of a scene. `None` when cancelled.
    pub fn new<S: Cellular>(
        scene: &Scene<S>,
        cells: &dyn Tessellation<S>,
        progress: &dyn Progress,
    ) -> Option<Self> {
        let (mut own, mut shared, mut numbered) = (Vec::new(), Vec::new(), Vec::new());
        let (mut met, mut corners, mut tried) =
            (Vec::new(), Vec::with_capacity(S::CORNERS), Tried::default());
        let mut near = CellId(0);
        for (count, &prim) in scene.live().iter().enumerate() {
            if count % PATIENCE == 0 {
                if progress.cancelled() {
                    return None;
                }
                progress.report(count as f32 / scene.live().len() as f32, "assigning primitives to cells");
            }
            // 1. Primitives of a file that follow each other are near each other: the search begins where the
            // last one ended.
            corners.clear();
            corners.extend(scene.prim_points(prim));
            met.clear();
            cells.meeting(&corners, near, &mut tried, &mut met);
            near = met[0];
            // Numbers of shared primitives count up in the order of their ids, so marks are a dense table.
            if let [cell] = met[..] {
                own.push((cell, prim));
            } else {
                shared.extend(met.iter().map(|cell| (*cell, numbered.len() as u32)));
                numbered.push(prim);
            }
        }
        // 2. Own primitives by cell first, then the shared ones: the end of the table is the list of the
        // latter.
        let (own_starts, mut prims) = by_cell(cells.count(), &own);
        prims.extend(numbered);
        let (shared_starts, shared) = by_cell(cells.count(), &shared);
        Some(Self::finish(prims, own_starts, shared, shared_starts))
    }
    fn finish(prims: Vec<PrimId>, own_starts: Vec<u32>, shared: Vec<u32>, shared_starts: Vec<u32>) -> Self {
        // 3.
        let mut made = Self { prims, own_starts, shared, shared_starts, most: 0 };
        made.most = (0..made.cells() as u32).map(|c| made.held(CellId(c))).max().unwrap_or(0);
        made
    }

    fn cells(&self) -> usize {
        self.own_starts.len() - 1
    }
    /// How many primitives meet a cell: |c|.
    #[inline]
    pub fn held(&self, cell: CellId) -> u32 {
        let of = |starts: &[u32]| starts[cell.at() + 1] - starts[cell.at()];
        of(&self.own_starts) + of(&self.shared_starts)
    }
    /// The most that meet any cell: ρ_max.
    pub fn most(&self) -> u32 {
        self.most
    }
    /// The primitives that meet this cell alone, by ascending id.
    #[inline]
    pub fn own(&self, cell: CellId) -> &[PrimId] {
        &self.prims[self.own_starts[cell.at()] as usize..self.own_starts[cell.at() + 1] as usize]
    }
    /// The primitives that meet this cell and others, as numbers of [`Assignment::all_shared`], ascending.
    #[inline]
    pub fn shared(&self, cell: CellId) -> &[u32] {
        &self.shared[self.shared_starts[cell.at()] as usize..self.shared_starts[cell.at() + 1] as usize]
    }
    /// The primitives that meet several cells, by ascending id.
    #[inline]
    pub fn all_shared(&self) -> &[PrimId] {
        &self.prims[self.own_starts[self.cells()] as usize..]
    }
    /// Every live primitive, once.
    pub fn all(&self) -> &[PrimId] {
        &self.prims
    }
    /// Pairs of a primitive and a cell that it meets.
    pub fn references(&self) -> usize {
        self.prims.len() - self.all_shared().len() + self.shared.len()
    }
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        4 * (self.prims.len() + self.own_starts.len() + self.shared.len() + self.shared_starts.len())
    }

    /// The four tables, for [`Assignment::of_tables`].
    pub fn tables(&self) -> [Vec<u32>; 4] {
        [
            self.prims.iter().map(|p| p.0).collect(),
            self.own_starts.clone(),
            self.shared.clone(),
            self.shared_starts.clone(),
        ]
    }
    /// The assignment of some tables; `None` if they do not fit the number of cells and the live primitives
    /// of the scene.
    pub fn of_tables<S: Cellular>(
        [prims, own_starts, shared, shared_starts]: [Vec<u32>; 4],
        cells: usize,
        scene: &Scene<S>,
    ) -> Option<Self> {
        // Every slice taken later must lie in its table.
        let ascending = |starts: &[u32], end: usize| {
            starts.len() == cells + 1
                && starts[0] == 0
                && starts.windows(2).all(|w| w[0] <= w[1])
                && starts[cells] as usize <= end
        };
        let prims: Vec<PrimId> = prims.into_iter().map(PrimId).collect();
        // Every live primitive once; what meets which cell is taken on trust, since checking it is building
        // it.
        let mut sorted = prims.clone();
        sorted.sort_unstable();
        let fits = sorted == scene.live()
            && ascending(&own_starts, prims.len())
            && ascending(&shared_starts, shared.len())
            && shared_starts[cells] as usize == shared.len()
            && shared.iter().all(|s| (*s as usize) < prims.len() - own_starts[cells] as usize);
        fits.then(|| Self::finish(prims, own_starts, shared, shared_starts))
    }
}

/// Sorts pairs into lists by cell, keeping their order within each.
fn by_cell<T: Copy>(cells: usize, pairs: &[(CellId, T)]) -> (Vec<u32>, Vec<T>) {
    // Counting sort: how many in each cell, where each list begins, then every pair to its place.
    let mut starts = vec![0u32; cells + 1];
    pairs.iter().for_each(|(cell, _)| starts[cell.at() + 1] += 1);
    (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
    let Some((_, first)) = pairs.first() else { return (starts, Vec::new()) };
    let (mut lists, mut next) = (vec![*first; pairs.len()], starts.clone());
    for (cell, value) in pairs {
        lists[next[cell.at()] as usize] = *value;
        next[cell.at()] += 1;
    }
    (starts, lists)
}
