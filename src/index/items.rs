//! What a tree of cells refers to: single primitives, or whole objects.

use std::ops::Range;

use crate::geometry::{Aabb, PrimId, Space};
use crate::scene::Scene;

/// What references are to: each primitive by itself, or runs of primitives of one object that follow each
/// other, such as the triangles of a sphere. An item is named by its first primitive.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Items {
    /// First primitive of each run and the one past its last, ascending; none if each is by itself.
    runs: Vec<[u32; 2]>,
}

impl Items {
    /// The runs of one object each that a scene consists of. One whose primitives are not in one piece is
    /// several runs, and so is one of which some primitives do not exist.
    pub fn objects<S: Space>(scene: &Scene<S>) -> Self {
        let mut runs: Vec<[u32; 2]> = Vec::new();
        for &prim in scene.live() {
            let follows = |run: &&mut [u32; 2]| {
                run[1] == prim.0 && scene.object_of(PrimId(run[0])) == scene.object_of(prim)
            };
            match runs.last_mut().filter(follows) {
                Some(run) => run[1] += 1,
                None => runs.push([prim.0, prim.0 + 1]),
            }
        }
        Self { runs }
    }
    /// Whether each primitive is by itself.
    #[inline]
    pub fn are_single(&self) -> bool {
        self.runs.is_empty()
    }
    /// All items of a scene, ascending.
    pub fn all<S: Space>(&self, scene: &Scene<S>) -> Vec<PrimId> {
        if self.are_single() {
            return scene.live().to_vec();
        }
        self.runs.iter().map(|run| PrimId(run[0])).collect()
    }
    /// The numbers of an item's primitives.
    #[inline]
    pub fn prims(&self, item: PrimId) -> Range<u32> {
        if self.are_single() {
            return item.0..item.0 + 1;
        }
        let [first, past] = self.runs[self.number(item)];
        first..past
    }
    /// The item that a primitive belongs to.
    pub fn of(&self, prim: PrimId) -> PrimId {
        if self.are_single() { prim } else { PrimId(self.runs[self.number(prim)][0]) }
    }
    /// How many primitives some items have.
    pub fn count(&self, items: &[PrimId]) -> usize {
        if self.are_single() { items.len() } else { items.iter().map(|&item| self.prims(item).len()).sum() }
    }
    /// Whether a number can be that of an item.
    pub fn has<S: Space>(&self, scene: &Scene<S>, item: PrimId) -> bool {
        match self.are_single() {
            true => item.at() < scene.prim_count() && scene.corners(item).is_some(),
            false => self.runs.binary_search_by_key(&item.0, |run| run[0]).is_ok(),
        }
    }
    /// Adds the primitives of some items to a list.
    #[inline]
    pub fn extend(&self, to: &mut Vec<PrimId>, items: &[PrimId]) {
        if self.are_single() {
            return to.extend_from_slice(items);
        }
        items.iter().for_each(|&item| to.extend(self.prims(item).map(PrimId)));
    }
    /// Bytes of it.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.runs)
    }
    /// Number of the object that holds a primitive, from 0; nothing of the kind if each is by itself.
    pub fn number(&self, prim: PrimId) -> usize {
        self.runs.partition_point(|run| run[0] <= prim.0) - 1
    }
    /// Boxes about the objects, by number.
    pub fn boxes<S: Space>(&self, scene: &Scene<S>) -> Vec<Aabb<S::Vector>> {
        let points = |&[first, past]: &[u32; 2]| (first..past).flat_map(|p| scene.prim_points(PrimId(p)));
        self.runs.iter().map(|run| Aabb::of(points(run))).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::geometry::{Flat, ObjectId};
    use crate::scene::{Object, Parts};

    /// Objects 0 0 1 1 1 0 of segments of which the fourth does not exist: runs 0–1, 2, 4 and 5.
    #[test]
    fn objects_are_runs_of_what_exists() {
        let points: Vec<Vec2> = (0..7).map(|x| Vec2::new(x as f32, 0.0)).collect();
        let prims = (0..6).map(|k| [k, k + 1]).collect();
        let mut parts = Parts::<Flat>::simple("row", points, prims);
        parts.prims[3] = None;
        let object = |name: &str| Object { name: name.into(), group: String::new(), motion: None };
        parts.objects = vec![object("a"), object("b")];
        parts.prim_object = [0, 0, 1, 1, 1, 0].map(ObjectId).to_vec();
        let scene = Scene::new(parts).expect("a row");
        assert_eq!(scene.live().len(), 5);
        let items = Items::objects(&scene);
        assert_eq!(items.all(&scene), [0, 2, 4, 5].map(PrimId));
        assert_eq!(items.prims(PrimId(0)), 0..2);
        assert_eq!(
            (items.of(PrimId(1)), items.of(PrimId(4)), items.number(PrimId(5))),
            (PrimId(0), PrimId(4), 3)
        );
        assert_eq!(items.count(&[PrimId(0), PrimId(4)]), 3);
        assert!(
            items.has(&scene, PrimId(2)) && !items.has(&scene, PrimId(1)) && !items.has(&scene, PrimId(3))
        );
        let mut list = Vec::new();
        items.extend(&mut list, &[PrimId(4), PrimId(0)]);
        assert_eq!(list, [4, 0, 1].map(PrimId));
        let bounds = items.boxes(&scene);
        assert_eq!((bounds[0].min.x, bounds[0].max.x), (0.0, 2.0));
        // Each by itself.
        let single = Items::default();
        assert_eq!((single.of(PrimId(4)), single.prims(PrimId(4))), (PrimId(4), 4..5));
        assert!(!single.has(&scene, PrimId(3)) && !single.has(&scene, PrimId(6)));
    }
}
