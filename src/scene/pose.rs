//! Motions: a scene as it is at one frame.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::{Pose, Scene};
use crate::geometry::{Space, Vector};

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

    /// The scene at `frame`, each motion repeated: the same ids, objects and materials. Points that a moving
    /// object shares with another one become its own. Where a motion leads out of the numbers, it is not
    /// applied.
    pub fn posed(&self, frame: usize) -> Self {
        let pose_of = |motion: &[Pose]| motion.get(frame % motion.len().max(1)).copied();
        let poses: Vec<Option<Pose>> =
            self.objects().iter().map(|o| o.motion.as_deref().and_then(pose_of)).collect();
        if poses.iter().all(Option::is_none) {
            return self.clone();
        }
        let mut parts = self.parts.clone();
        let mut moved = BTreeMap::new();
        for (prim, corners) in parts.prims.iter_mut().enumerate() {
            let object = parts.prim_object[prim];
            let (Some(pose), Some(old)) = (poses[object.at()], *corners) else { continue };
            let mut new = [0u32; 3];
            for (to, from) in new.iter_mut().zip(old.as_ref()) {
                *to = *moved.entry((object, *from)).or_insert_with(|| {
                    let here = parts.points[*from as usize];
                    let there: S::Vector = pose.apply(here);
                    parts.points.push(if there.is_finite() { there } else { here });
                    parts.points.len() as u32 - 1
                });
            }
            *corners = Some(S::corners_from(new));
        }
        for face in &mut parts.faces {
            let Some(object) = face.prims.first().map(|p| parts.prim_object[p.at()]) else { continue };
            for corner in &mut face.corners {
                *corner = moved.get(&(object, *corner)).copied().unwrap_or(*corner);
            }
        }
        let about = (*self.about).clone();
        // The tables fit as they did before: only points were added.
        Self::new(parts).map_or_else(|_| self.clone(), |scene| scene.with_about(about))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec2;

    use super::*;
    use crate::geometry::{Flat, ObjectId, PrimId};
    use crate::scene::{Object, Parts};

    #[test]
    fn a_moving_object_takes_its_corners_along_and_leaves_the_others() {
        let points = vec![Vec2::ZERO, Vec2::X, Vec2::new(1.0, 1.0)];
        let mut parts = Parts::<Flat>::simple("door", points, vec![[0, 1], [1, 2]]);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let turn = Pose { rotation: [0.0, 0.0, half, half], translation: [2.0, 0.0, 0.0] };
        let still = Pose { rotation: [0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };
        parts.objects.push(Object {
            name: "leaf".into(),
            group: String::new(),
            motion: Some(Arc::new([still, turn])),
        });
        parts.prim_object[1] = ObjectId(1);
        let scene = Scene::new(parts).expect("valid");
        assert_eq!(scene.frame_count(), 2);
        let posed = scene.posed(3);
        let ends = |p: u32| posed.prim_points(PrimId(p)).collect::<Vec<_>>();
        assert_eq!(ends(0), [Vec2::ZERO, Vec2::X], "the wall shares a point with the leaf and stands still");
        assert!(
            ends(1)[0].distance(Vec2::new(2.0, 1.0)) < 1e-6
                && ends(1)[1].distance(Vec2::new(1.0, 1.0)) < 1e-6,
            "{:?}",
            ends(1)
        );
        assert_eq!(scene.posed(2).bounds(), scene.bounds());
    }
}
