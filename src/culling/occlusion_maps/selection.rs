//! Which leaves of the occluder database are drawn as occluders (Zhang et al. 1997, Section 5.3.2).

use super::index::Databases;
use crate::geometry::{Aabb, Frustum, FrustumTest, NodeId, Projection, Space, Vector, View, nearest_depth};
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

/// A leaf by what puts it in order.
struct Ranked {
    /// Whether it comes before all that does not.
    is_first: bool,
    /// Less is earlier.
    key: f32,
    node: NodeId,
}

/// The leaves of the occluder database in the frustum, in the order in which they are taken, as far as they
/// can be within the limit; and how many there are.
pub(crate) fn candidates<S: Drawable>(
    index: &Databases<S>,
    view: &View<S>,
    (frustum, projection): (&Frustum<S::Vector>, &Projection<S::Vector>),
    order: Order,
    limit: u32,
    known: &Known<'_>,
) -> (Vec<Candidate>, u32) {
    let mut ranked = Vec::new();
    let angle = |node: NodeId| known.angles.get(node.at()).copied().unwrap_or(0.0);
    let is_first = |node: NodeId| match order {
        Order::By(Selection::Visible) => known.drawn[node.at()],
        // What moves is in no list (Section 5.5: "no pre-processing"): it follows by its distance, as does
        // all else that the grid points do not see.
        Order::By(Selection::Grid) => angle(node) > 0.0,
        _ => false,
    };
    let key = |node: NodeId, bounds: &Aabb<S::Vector>| match order {
        Order::By(Selection::Size) => -size_of(bounds, view),
        Order::By(Selection::Grid) if is_first(node) => -angle(node),
        Order::By(Selection::Distance | Selection::Visible | Selection::Grid) => distance_of(bounds, view),
        // Larger depths are nearer.
        Order::Nearest => -nearest_depth(projection, bounds, view.eye.near),
    };
    let polygons = |node: NodeId| index.occluder_prims(node, view, projection);
    let may_be_none = index.stand_ins().is_some();
    gather(index, frustum, (NodeId(0), Frustum::<S::Vector>::ALL), &mut |node| {
        // Where nothing may be drawn for it, it is none.
        if !may_be_none || polygons(node) > 0 {
            let key = key(node, index.occluder_bounds(node));
            ranked.push(Ranked { is_first: is_first(node), key, node });
        }
    });
    let in_view = ranked.len() as u32;
    sort_first(&mut ranked, KEEPS * limit as f32, polygons);
    let found = ranked.iter().map(|r| {
        let is_kept = match order {
            // "Temporal coherence": while it is about as near as what is chosen, a set does not flicker.
            Order::By(Selection::Distance) => known.occluders[r.node.at()],
            Order::By(Selection::Visible) => r.is_first,
            _ => false,
        };
        candidate(index, view, projection, r.node, (angle(r.node), is_kept))
    });
    let mut found: Vec<Candidate> = found.collect();
    found.sort_by_key(|c| !c.is_kept);
    (found, in_view)
}

/// Leaves those that come first, in order, and hold more than `most` primitives together, or all.
fn sort_first(ranked: &mut Vec<Ranked>, most: f32, polygons: impl Fn(NodeId) -> u32) {
    // Equal ones by number, so that every run takes the same.
    let in_order = |a: &Ranked, b: &Ranked| {
        b.is_first.cmp(&a.is_first).then(a.key.total_cmp(&b.key)).then(a.node.cmp(&b.node))
    };
    // To put all in order would take longer than to draw what is chosen of them.
    let (mut count, mut sorted, mut sum) = (64, 0, 0.0);
    while sorted < ranked.len() {
        count = count.min(ranked.len());
        if count < ranked.len() {
            ranked[sorted..].select_nth_unstable_by(count - sorted, in_order);
        }
        ranked[sorted..count].sort_unstable_by(in_order);
        for at in sorted..count {
            sum += polygons(ranked[at].node) as f32;
            if sum > most {
                return ranked.truncate(at + 1);
            }
        }
        sorted = count;
        count *= 4;
    }
}

/// Frustum culling of the occluder database (Section 3, phase 1).
fn gather<S: Drawable>(
    index: &Databases<S>,
    frustum: &Frustum<S::Vector>,
    (id, planes): (NodeId, u8),
    to: &mut impl FnMut(NodeId),
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
                gather(index, frustum, (child, cutting), to);
            }
        }
        None => to(id),
    }
}

/// "The distance between the viewer and the center of an object's bounding volume."
fn distance_of<S: Space>(bounds: &Aabb<S::Vector>, view: &View<S>) -> f32 {
    (bounds.center() - view.eye.position).length()
}
/// About its solid angle.
fn size_of<S: Space>(bounds: &Aabb<S::Vector>, view: &View<S>) -> f32 {
    let across = bounds.diagonal() / distance_of(bounds, view).max(f32::MIN_POSITIVE);
    across * across
}

fn candidate<S: Drawable>(
    index: &Databases<S>,
    view: &View<S>,
    projection: &Projection<S::Vector>,
    node: NodeId,
    (angle, is_kept): (f32, bool),
) -> Candidate {
    let bounds = index.occluder_bounds(node);
    Candidate {
        node,
        distance: distance_of(bounds, view),
        size: size_of(bounds, view),
        angle,
        nearest: nearest_depth(projection, bounds, view.eye.near),
        polygons: index.occluder_prims(node, view, projection),
        is_kept,
    }
}
