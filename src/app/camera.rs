//! The Observer: where the person looks from. Never used to cull; no function that culls takes it.
//!
//! Orbit around a pivot in space; pan and zoom over the plane in flatland. World units and radians.

use glam::{Quat, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::geometry::{Aabb, Eye, Solid, View};

/// Where the person looks from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObserverCamera {
    /// What it turns around; in flatland the middle of the picture.
    pub pivot: [f32; 3],
    /// Turn about the vertical.
    pub yaw: f32,
    /// Height above the horizon.
    pub pitch: f32,
    /// Turn about the line of sight.
    pub roll: f32,
    /// Distance to the pivot; in flatland half the height of the picture, world units.
    pub distance: f32,
    /// Size of the scene, which bounds the zoom and sets the depth range.
    pub extent: f32,
}

/// Vertical angle of the Observer's view.
const FOV: f32 = 0.9;
/// Closest to the poles that an orbit comes: no flip, never stuck.
const PITCH_LIMIT: f32 = 1.55;

impl Default for ObserverCamera {
    fn default() -> Self {
        Self { pivot: [0.0; 3], yaw: 0.6, pitch: 0.95, roll: 0.0, distance: 10.0, extent: 10.0 }
    }
}

impl ObserverCamera {
    /// Frames a box of space from the present direction in a picture of this aspect (width by height): as
    /// near as every corner allows.
    pub fn frame_solid(&mut self, bounds: &Aabb<Vec3>, whole: &Aabb<Vec3>, aspect: f32) {
        let (center, turn) = (bounds.center(), self.rotation().inverse());
        self.pivot = center.to_array();
        self.extent = whole.diagonal().max(1e-3);
        let up = (FOV * 0.5).tan();
        let needed = |corner: Vec3| {
            let p = turn * (corner - center);
            p.z + (p.x.abs() / (up * aspect.max(1e-3))).max(p.y.abs() / up)
        };
        self.distance = bounds.corners().map(needed).fold(self.extent * 1e-4, f32::max) * 1.04;
    }
    /// Frames a box of flatland in a picture of this aspect (width by height).
    pub fn frame_flat(&mut self, bounds: &Aabb<Vec2>, whole: &Aabb<Vec2>, aspect: f32) {
        let (center, size) = (bounds.center(), bounds.size());
        self.pivot = [center.x, center.y, 0.0];
        self.extent = whole.diagonal().max(1e-3);
        self.distance = (size.y.max(size.x / aspect.max(1e-3)) * 0.54).max(self.extent * 1e-4);
    }
    /// Orientation of the camera: its x axis points right, y up, z back to the observer.
    pub fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.yaw)
            * Quat::from_rotation_x(-self.pitch)
            * Quat::from_rotation_z(self.roll)
    }
    /// Where it stands in space.
    pub fn position(&self) -> Vec3 {
        Vec3::from(self.pivot) + self.rotation() * Vec3::Z * self.distance
    }
    /// The same camera as a view, for drawing into a picture of this size.
    pub fn view(&self, width: u32, height: u32) -> View<Solid> {
        let near = (self.distance * 0.01).max(self.extent * 1e-5);
        let far = self.distance + self.extent * 2.0;
        let (position, up) = (self.position(), self.rotation() * Vec3::Y);
        View {
            eye: Eye { position, target: Vec3::from(self.pivot), up, fov: FOV, near, far },
            width: width.max(1),
            height: height.max(1),
        }
    }
    /// Turns around the pivot.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        self.yaw = (self.yaw + yaw).rem_euclid(std::f32::consts::TAU);
        self.pitch = (self.pitch + pitch).clamp(-PITCH_LIMIT, PITCH_LIMIT);
    }
    /// World length at the pivot of one pixel of a picture `height_px` high.
    pub fn unit_per_px(&self, height_px: f32) -> f32 {
        2.0 * self.distance * (FOV * 0.5).tan() / height_px.max(1.0)
    }
    /// Slides pivot and camera across the picture, pixels.
    pub fn pan(&mut self, by_px: Vec2, height_px: f32) {
        let unit = self.unit_per_px(height_px);
        let by = self.rotation() * Vec3::new(-by_px.x * unit, by_px.y * unit, 0.0);
        self.pivot = (Vec3::from(self.pivot) + by).to_array();
    }
    /// Comes closer (`factor` < 1) or goes away, keeping what lies under the cursor there.
    /// `cursor` is in the picture, −1..1 from left to right and bottom to top.
    pub fn zoom(&mut self, factor: f32, cursor: Vec2, aspect: f32) {
        let before = self.distance;
        self.distance = (before * factor).clamp(self.extent * 1e-4, self.extent * 20.0);
        let half = (before - self.distance) * (FOV * 0.5).tan();
        let by = self.rotation() * Vec3::new(cursor.x * half * aspect, cursor.y * half, 0.0);
        self.pivot = (Vec3::from(self.pivot) + by).to_array();
    }
    /// Slides over flatland by a world vector.
    pub fn slide(&mut self, by: Vec2) {
        self.pivot[0] += by.x;
        self.pivot[1] += by.y;
    }
    /// Zooms over flatland, keeping the world point `at` where it is.
    pub fn zoom_flat(&mut self, factor: f32, at: Vec2) {
        let before = self.distance;
        self.distance = (before * factor).clamp(self.extent * 1e-5, self.extent * 20.0);
        let kept = self.distance / before;
        let pivot = at + (Vec2::new(self.pivot[0], self.pivot[1]) - at) * kept;
        self.pivot = [pivot.x, pivot.y, 0.0];
    }
    /// Its numbers as text, every bit of them.
    pub fn numbers(&self) -> String {
        let [x, y, z] = self.pivot;
        let all = [x, y, z, self.yaw, self.pitch, self.roll, self.distance, self.extent];
        all.map(|v| v.to_string()).join(",")
    }
    /// The Observer whose [numbers](Self::numbers) these are; `None` of one that cannot see.
    pub fn parse(text: &str) -> Option<Self> {
        let all: Vec<f32> = text.split(',').map(|v| v.trim().parse().ok()).collect::<Option<_>>()?;
        let [x, y, z, yaw, pitch, roll, distance, extent] = all[..] else { return None };
        let camera = Self { pivot: [x, y, z], yaw, pitch, roll, distance, extent };
        camera.is_sound().then_some(camera)
    }
    /// Whether every number is finite and the distance positive: what a session file may hold.
    pub fn is_sound(&self) -> bool {
        let all = [self.yaw, self.pitch, self.roll, self.distance, self.extent];
        self.pivot.iter().chain(&all).all(|v| v.is_finite()) && self.distance > 0.0 && self.extent > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zoom_keeps_the_point_under_the_cursor() {
        let mut camera =
            ObserverCamera { distance: 8.0, extent: 20.0, pivot: [1.0, 2.0, 3.0], ..Default::default() };
        let (cursor, aspect) = (Vec2::new(0.4, -0.7), 1.5);
        let under = |c: &ObserverCamera| {
            let half = c.distance * (FOV * 0.5).tan();
            Vec3::from(c.pivot) + c.rotation() * Vec3::new(cursor.x * half * aspect, cursor.y * half, 0.0)
        };
        let before = under(&camera);
        camera.zoom(0.5, cursor, aspect);
        assert!((under(&camera) - before).length() < 1e-4);
        let mut flat = ObserverCamera { distance: 8.0, extent: 20.0, ..Default::default() };
        flat.zoom_flat(0.25, Vec2::new(3.0, 1.0));
        assert_eq!(flat.pivot, [2.25, 0.75, 0.0]);
    }

    #[test]
    fn orbit_stops_before_the_poles() {
        let mut camera = ObserverCamera::default();
        camera.orbit(0.0, 100.0);
        assert!(camera.view(10, 10).eye.fault().is_none());
        assert!(camera.pitch < std::f32::consts::FRAC_PI_2);
    }
}
