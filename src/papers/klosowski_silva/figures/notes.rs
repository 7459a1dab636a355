//! What the figures read of the method's notes.

use glam::Vec2;

use crate::culling::layered_projection::{Evidence, Front, LayeredProjection, Transferred, node_of};
use crate::geometry::{Flat, NodeId};
use crate::method::{Film, notes};

/// The traversal at a moment: after so many cells were projected and their neighbors put into the front.
pub struct Moment {
    /// Cells in the order in which they were projected.
    pub projected: Vec<NodeId>,
    /// The front with solidities, the least solid first.
    pub front: Vec<(NodeId, f32)>,
    /// Primitives that may still be drawn.
    pub left: usize,
    /// The step of the film.
    pub step: usize,
}

impl Moment {
    /// Applies the notes of a film to a front, as the film itself does, until one more cell would be
    /// projected.
    pub fn after(film: &dyn Film<Flat>, cells: usize) -> Self {
        let mut front = Front::default();
        front.clear(film.hierarchy().node_count() - 1);
        let (mut left, mut step) = (0, 0);
        for (at, note) in notes::<Flat, LayeredProjection>(film) {
            if let Evidence::Projected(n) = note {
                if front.projected().len() == cells {
                    break;
                }
                left = n.left as usize;
            }
            note.apply(&mut front);
            step = at + 1;
        }
        let projected = front.projected().iter().map(|&cell| node_of(cell)).collect();
        let front = front.first(usize::MAX).into_iter().map(|queued| (node_of(queued.cell), queued.solidity));
        Self { projected, front: front.collect(), left, step }
    }
}

/// Operands and result of a transfer.
#[derive(Clone, Debug)]
pub struct Transfer {
    /// As the method records them.
    pub note: Transferred<Vec2>,
    /// The step of the film.
    pub step: usize,
}

impl Transfer {
    /// The cell that was projected.
    pub fn from(&self) -> NodeId {
        node_of(self.note.a)
    }
    /// The neighbor.
    pub fn to(&self) -> NodeId {
        node_of(self.note.b)
    }
}

/// The transfers of each projected cell.
pub fn transfers(film: &dyn Film<Flat>) -> Vec<Vec<Transfer>> {
    let mut groups: Vec<Vec<Transfer>> = Vec::new();
    for (at, note) in notes::<Flat, LayeredProjection>(film) {
        let Evidence::Transferred(note) = note else { continue };
        let transfer = Transfer { note: *note, step: at + 1 };
        match groups.last_mut().filter(|g| g[0].from() == transfer.from()) {
            Some(group) => group.push(transfer),
            None => groups.push(vec![transfer]),
        }
    }
    groups
}
