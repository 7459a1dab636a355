//! Motions: a scene as it is at any frame, for the price of the points that move.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DQuat, DVec3};
use sha2::{Digest, Sha256};

use super::{Parts, Pose, Scene};
use crate::geometry::{Aabb, ObjectId, Space, Vector};

impl Pose {
    /// Moves a point. In flatland the third coordinate is 0 before and ignored after.
    pub fn apply<V: Vector>(&self, point: V) -> V {
        let [x, y, z, w] = self.rotation.map(f64::from);
        let at = |a: usize| if a < V::AXES { f64::from(point.get(a)) } else { 0.0 };
        let moved = DQuat::from_xyzw(x, y, z, w) * DVec3::new(at(0), at(1), at(2))
            + DVec3::from_array(self.translation.map(f64::from));
        V::from_fn(|a| moved[a] as f32)
    }
}

impl<S: Space> Scene<S> {
    /// Frames of the longest motion; 1 where nothing moves.
    pub fn frame_count(&self) -> usize {
        self.objects().iter().filter_map(|o| o.motion.as_ref().map(|m| m.len())).max().unwrap_or(1).max(1)
    }
}

/// Scenes that are kept for another frame: one is looked at, the next is made, and a film may hold a third.
const KEPT: usize = 3;

/// A scene at any frame of its motions: the same ids, objects and materials, and only points that differ.
///
/// A frame rewrites the points that move in a scene of an earlier frame that nobody looks at any more; only
/// as long as there is none it copies the points. Where nothing moves, every frame is the scene itself.
pub struct Motion<S: Space> {
    rest: Arc<Scene<S>>,
    moving: Vec<Moving<S>>,
    /// Bounds of what does not move.
    still: Aabb<S::Vector>,
    made: Vec<Arc<Scene<S>>>,
    /// Points that the last frame wrote.
    written: usize,
}

/// An object that moves.
struct Moving<S: Space> {
    poses: Arc<[Pose]>,
    /// Its points by number, each with where it is at rest.
    points: Vec<(u32, S::Vector)>,
}

impl<S: Space> Motion<S> {
    /// The motions of a scene as it was loaded. Cost: O(primitives) if something moves.
    pub fn new(scene: &Arc<Scene<S>>) -> Self {
        let mut points: BTreeMap<ObjectId, BTreeSet<u32>> = BTreeMap::new();
        for &prim in scene.moving() {
            let corners = scene.corners(prim);
            let of_object = points.entry(scene.object_of(prim)).or_default();
            of_object.extend(corners.iter().flat_map(|c| c.as_ref()));
        }
        let moving = points.into_iter().filter_map(|(object, points)| {
            let poses = scene.objects()[object.at()].motion.clone()?;
            Some(Moving {
                poses,
                points: points.into_iter().map(|p| (p, scene.points()[p as usize])).collect(),
            })
        });
        let moving: Vec<_> = moving.collect();
        let mut still = Aabb::empty();
        if !moving.is_empty() {
            let stands = scene.live().iter().filter(|p| !scene.is_moving(**p));
            still = stands.fold(still, |b, p| b.union(scene.prim_bounds(*p)));
        }
        Self { rest: scene.clone(), moving, still, made: Vec::new(), written: 0 }
    }

    /// The scene at `frame`, each motion repeated. Where a motion leads out of the numbers, a point stays
    /// where it is at rest. Cost: O(points that move), and a copy of all points while the scenes of the last
    /// frames are all in use.
    pub fn at(&mut self, frame: usize) -> Arc<Scene<S>> {
        self.written = 0;
        if self.moving.is_empty() {
            return self.rest.clone();
        }
        if let Some(same) = self.made.iter().find(|s| s.frame == Some(frame)) {
            return same.clone();
        }
        let free = self.made.iter_mut().position(|s| Arc::get_mut(s).is_some());
        let mut scene = free.map_or_else(|| self.rest.clone(), |at| self.made.remove(at));
        if free.is_none() {
            self.written = self.rest.points.len();
        }
        // Of the scene at rest it is a copy; the tables are shared.
        let to = Arc::make_mut(&mut scene);
        to.bounds = self.still;
        for Moving { poses, points } in &self.moving {
            self.written += points.len();
            let pose = poses.get(frame % poses.len().max(1));
            for &(at, rest) in points {
                let there = pose.map_or(rest, |pose| pose.apply(rest));
                let there = if there.is_finite() { there } else { rest };
                to.points[at as usize] = there;
                to.bounds = to.bounds.union(Aabb { min: there, max: there });
            }
        }
        to.frame = Some(frame);
        to.hash = Sha256::new()
            .chain_update(self.rest.hash)
            .chain_update((frame as u64).to_le_bytes())
            .finalize()
            .into();
        self.made.push(scene.clone());
        if self.made.len() > KEPT {
            self.made.remove(0);
        }
        scene
    }
}

/// Gives objects that move points of their own, also in the faces that they are made of.
pub(super) fn split<S: Space>(parts: &mut Parts<S>) {
    let owned = owned(parts);
    let mut moved: BTreeMap<(ObjectId, u32), u32> = BTreeMap::new();
    for (corners, object) in parts.prims.iter_mut().zip(&parts.prim_object) {
        let Some(corners) = corners.as_mut().filter(|_| parts.objects[object.at()].motion.is_some()) else {
            continue;
        };
        let mut own = [0u32; 3];
        for (to, &from) in own.iter_mut().zip(corners.as_ref()) {
            *to = if owned[from as usize] {
                from
            } else {
                *moved.entry((*object, from)).or_insert_with(|| {
                    parts.points.push(parts.points[from as usize]);
                    parts.points.len() as u32 - 1
                })
            };
        }
        *corners = S::corners_from(own);
    }
    for face in &mut parts.faces {
        // A face is of one object.
        let Some(object) = face.prims.first().map(|p| parts.prim_object[p.at()]) else { continue };
        for corner in &mut face.corners {
            *corner = moved.get(&(object, *corner)).copied().unwrap_or(*corner);
        }
    }
}

/// Of each point whether primitives of one object alone use it.
fn owned<S: Space>(parts: &Parts<S>) -> Vec<bool> {
    let mut owner: Vec<Option<ObjectId>> = vec![None; parts.points.len()];
    let mut is_owned = vec![true; owner.len()];
    for (corners, &object) in parts.prims.iter().zip(&parts.prim_object) {
        for &point in corners.iter().flat_map(|c| c.as_ref()) {
            let before = owner[point as usize].replace(object);
            is_owned[point as usize] &= before.is_none_or(|b| b == object);
        }
    }
    is_owned
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, PrimId, Solid};
    use crate::scene::{Face, Object};

    fn turned(degrees: f32, translation: [f32; 3]) -> Pose {
        let half = degrees.to_radians() / 2.0;
        Pose { rotation: [0.0, 0.0, half.sin(), half.cos()], translation }
    }

    fn object(name: &str, poses: &[Pose]) -> Object {
        let motion = (!poses.is_empty()).then(|| poses.into());
        Object { name: name.into(), group: String::new(), motion }
    }

    #[test]
    fn a_moving_object_takes_its_corners_along_and_leaves_the_others() {
        let points = vec![Vec2::ZERO, Vec2::X, Vec2::new(1.0, 1.0)];
        let mut parts = Parts::<Flat>::simple("door", points, vec![[0, 1], [1, 2]]);
        let poses = [turned(0.0, [0.0; 3]), turned(90.0, [2.0, 0.0, 0.0])];
        parts.objects.push(object("leaf", &poses));
        parts.prim_object[1] = ObjectId(1);
        let scene = Arc::new(Scene::new(parts).expect("valid"));
        assert_eq!((scene.frame_count(), scene.frame()), (2, None));
        let mut motion = Motion::new(&scene);
        let posed = motion.at(3);
        let ends = |p: u32| posed.prim_points(PrimId(p)).collect::<Vec<_>>();
        assert_eq!(ends(0), [Vec2::ZERO, Vec2::X], "the wall shares a point with the leaf and stands still");
        assert!(
            ends(1)[0].distance(Vec2::new(2.0, 1.0)) < 1e-6
                && ends(1)[1].distance(Vec2::new(1.0, 1.0)) < 1e-6,
            "{:?}",
            ends(1)
        );
        assert_eq!(motion.at(2).bounds(), scene.bounds());
        assert_eq!(posed.bounds(), Aabb::of([Vec2::ZERO, Vec2::X, ends(1)[0], ends(1)[1]]));
    }

    /// A soup of objects that share points at random, of which every third moves, with faces.
    fn swarm(seed: u64, objects: u32) -> Arc<Scene<Solid>> {
        let mut dice = Dice::new(seed);
        let mut point = || Vec3::from_array(std::array::from_fn(|_| dice.below(1000) as f32 / 100.0));
        let points: Vec<Vec3> = (0..objects * 4).map(|_| point()).collect();
        let n = points.len() as u32;
        let mut prims = Vec::new();
        for o in 0..objects {
            let at = |k: u32| (o * 4 + k) % n;
            prims.extend([[at(0), at(1), at(2)], [at(0), at(2), at(4)]]);
        }
        let mut parts = Parts::<Solid>::simple("swarm", points, prims);
        parts.objects.clear();
        for o in 0..objects {
            let still = [turned(0.0, [0.0; 3])];
            let poses: Vec<Pose> =
                (0..2 + o as usize % 5).map(|f| turned(f as f32 * 31.0, [o as f32, 0.5, f as f32])).collect();
            parts.objects.push(object(
                "o",
                if o % 3 == 0 {
                    &poses
                } else if o % 3 == 1 {
                    &still
                } else {
                    &[]
                },
            ));
            let corners = vec![o * 4, o * 4 + 1, o * 4 + 2];
            parts.faces.push(Face { corners, prims: vec![PrimId(2 * o)] });
            (parts.prim_object[2 * o as usize], parts.prim_object[2 * o as usize + 1]) =
                (ObjectId(o), ObjectId(o));
        }
        Arc::new(Scene::new(parts).expect("valid"))
    }

    #[test]
    fn every_frame_is_what_its_poses_make_of_each_corner() {
        for seed in 0..20 {
            let scene = swarm(seed, 12);
            let mut motion = Motion::new(&scene);
            // Two frames at a time are looked at, so that scenes are made anew and used again.
            let mut before = motion.at(0);
            for frame in [0, 3, 1, 7, 7, 2, 40, 0] {
                let now = motion.at(frame);
                for &prim in scene.live() {
                    let of = scene.object_of(prim);
                    let pose = scene.objects()[of.at()].motion.as_ref().map(|m| m[frame % m.len()]);
                    let wanted = scene.prim_points(prim).map(|p| pose.map_or(p, |pose| pose.apply(p)));
                    assert!(now.prim_points(prim).eq(wanted), "seed {seed}, frame {frame}, {prim}");
                }
                for face in now.faces() {
                    let of_face = face.corners.iter().map(|c| now.points()[*c as usize]);
                    assert!(of_face.eq(now.prim_points(face.prims[0])), "faces go along");
                }
                let all = now.live().iter().fold(Aabb::empty(), |b, p| b.union(now.prim_bounds(*p)));
                assert_eq!((now.bounds(), now.frame()), (all, Some(frame)));
                assert_eq!(before.hash == now.hash, before.frame == now.frame);
                assert_ne!(now.hash, scene.hash);
                before = now;
            }
        }
    }

    #[test]
    fn a_frame_costs_what_moves_and_not_the_scene() {
        let scene = swarm(1, 3000);
        let mut motion = Motion::new(&scene);
        // Corners of the two thirds that have a motion; of two triangles four.
        let moving = 2000 * 4;
        let mut held = motion.at(0);
        for frame in 1..20 {
            let next = motion.at(frame);
            // The first two scenes are copies, and each is used again as soon as nobody looks at it.
            let copied = if frame == 1 { scene.points().len() } else { 0 };
            assert!((moving..=moving + copied + moving).contains(&motion.written), "{}", motion.written);
            assert!(frame == 1 || motion.written == moving, "frame {frame}: {}", motion.written);
            held = next;
        }
        assert_eq!(held.frame(), Some(19));
        let still = Motion::new(&swarm_at_rest()).at(5);
        assert_eq!((still.frame(), still.frame_count()), (None, 1));
    }

    fn swarm_at_rest() -> Arc<Scene<Solid>> {
        let mut parts = Arc::unwrap_or_clone(swarm(2, 5)).into_parts();
        parts.objects.iter_mut().for_each(|o| o.motion = None);
        Arc::new(Scene::new(parts).expect("valid"))
    }
}
