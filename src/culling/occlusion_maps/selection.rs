//! Which leaves of the occluder database are drawn as occluders (Zhang et al. 1997, Section 5.3.2).

use super::index::Databases;
use crate::geometry::{Frustum, FrustumTest, NodeId, Projection, Vector, View, nearest_depth};
use crate::method::words;
use crate::raster::Drawable;

words! {
    /// By what occluders are chosen.
    pub(crate) enum Selection {
        /// The nearest to the eye (the paper).
        Distance = "distance",
        /// Those that look largest.
        Size = "size",
        /// The nearest of those that could be seen in the last frame.
        Visible = "visible",
        /// Those that look largest from the grid points about the eye, as far as they are seen from there;
        /// then the nearest of the others.
        Grid = "grid",
    }
}

/// A leaf that may become an occluder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub node: NodeId,
    /// From the eye to the middle of its box, world units.
    pub distance: f32,
    /// About the solid angle of its box: the square of its diagonal over that of its distance.
    pub size: f32,
    /// The angle under which the grid points about the eye see it, weighted; 0 where they do not.
    pub angle: f32,
    /// The depth (`1/w`) of its nearest point.
    pub nearest: f32,
    /// Primitives that are drawn of it.
    pub polygons: u32,
    /// Whether it comes before its turn: it was an occluder, or could be seen, in the last frame.
    pub is_kept: bool,
}

/// By what candidates are put in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    By(Selection),
    /// By their nearest points: with a single Z plane all before it are occluders (Section 5.2.1).
    Nearest,
}

/// What is known beforehand, by node: what was an occluder in the last frame, and what was drawn.
pub(crate) struct Known<'a> {
    pub occluders: &'a [bool],
    pub drawn: &'a [bool],
    /// By node the angles of the grid points about the eye; empty where none is asked.
    pub angles: &'a [f32],
}

/// A set that was chosen in the last frame stays while it ranks within so many times the limit.
const KEEPS: f32 = 1.25;

/// The leaves of the occluder database in the frustum, in the order in which they are taken.
pub(crate) fn candidates<S: Drawable>(
    index: &Databases<S>,
    view: &View<S>,
    (frustum, projection): (&Frustum<S::Vector>, &Projection<S::Vector>),
    order: Order,
    limit: u32,
    known: &Known<'_>,
) -> Vec<Candidate> {
    let mut found = Vec::new();
    gather(index, view, frustum, projection, (NodeId(0), Frustum::<S::Vector>::ALL), &mut found);
    let key = |c: &Candidate| match order {
        Order::By(Selection::Size) => -c.size,
        Order::By(Selection::Distance | Selection::Visible | Selection::Grid) => c.distance,
        // Larger depths are nearer.
        Order::Nearest => -c.nearest,
    };
    for c in &mut found {
        c.angle = known.angles.get(c.node.at()).copied().unwrap_or(0.0);
    }
    // Equal ones by number, so that every run takes the same. What moves is in no list (Section 5.5: "no
    // pre-processing"): it follows by its distance, as does all else that the grid points do not see.
    found.sort_by(|a, b| {
        let seen = b.angle.total_cmp(&a.angle);
        seen.then(key(a).total_cmp(&key(b))).then(a.node.cmp(&b.node))
    });
    let mut sum = 0.0;
    for c in &mut found {
        sum += c.polygons as f32;
        c.is_kept = match order {
            // "Temporal coherence": while it is about as near as what is chosen, a set does not flicker.
            Order::By(Selection::Distance) => known.occluders[c.node.at()] && sum <= KEEPS * limit as f32,
            Order::By(Selection::Visible) => known.drawn[c.node.at()],
            _ => false,
        };
    }
    found.sort_by_key(|c| !c.is_kept);
    found
}

/// Frustum culling of the occluder database (Section 3, phase 1).
fn gather<S: Drawable>(
    index: &Databases<S>,
    view: &View<S>,
    frustum: &Frustum<S::Vector>,
    projection: &Projection<S::Vector>,
    (id, planes): (NodeId, u8),
    to: &mut Vec<Candidate>,
) {
    if !index.has_occluders(id) {
        return;
    }
    let node = &index.tree().nodes()[id.at()];
    let cutting = match frustum.test(index.occluder_bounds(id), planes) {
        FrustumTest::Outside(_) => return,
        FrustumTest::Partial(cutting) => cutting,
        FrustumTest::Inside => 0,
    };
    match node.children() {
        Some(children) => {
            for child in children {
                gather(index, view, frustum, projection, (child, cutting), to);
            }
        }
        None => {
            let found = candidate(index, view, projection, id);
            // Where nothing may be drawn for it, it is none.
            to.extend((found.polygons > 0).then_some(found));
        }
    }
}

fn candidate<S: Drawable>(
    index: &Databases<S>,
    view: &View<S>,
    projection: &Projection<S::Vector>,
    node: NodeId,
) -> Candidate {
    let bounds = index.occluder_bounds(node);
    // "The distance between the viewer and the center of an object's bounding volume."
    let distance = (bounds.center() - view.eye.position).length();
    let across = bounds.diagonal() / distance.max(f32::MIN_POSITIVE);
    Candidate {
        node,
        distance,
        size: across * across,
        angle: 0.0,
        nearest: nearest_depth(projection, bounds, view.eye.near),
        polygons: index.occluder_prims(node, view, projection),
        is_kept: false,
    }
}
