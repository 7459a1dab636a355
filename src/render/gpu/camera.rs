//! Where a viewport looks from.
//!
//! A viewport shows what the Eye sees or what an Observer sees; both come here as a [`SpaceCamera`], so
//! nothing in this folder can mistake one for the other. Pixels count from the top left.

use glam::{Vec2, Vec3};

use crate::geometry::{Eye, Projection, Solid, View};

/// A pinhole camera, of a shape that follows the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceCamera {
    /// Where it stands, world units.
    pub position: Vec3,
    /// A point it looks at.
    pub target: Vec3,
    /// Roughly up.
    pub up: Vec3,
    /// Whole vertical angle of view, radians.
    pub fov: f32,
    /// View depth of the near plane, > 0.
    pub near: f32,
    /// View depth of the far plane; infinite for none.
    pub far: f32,
}

impl From<Eye<Solid>> for SpaceCamera {
    fn from(eye: Eye<Solid>) -> Self {
        Self {
            position: eye.position,
            target: eye.target,
            up: eye.up,
            fov: eye.fov,
            near: eye.near,
            far: eye.far,
        }
    }
}

impl SpaceCamera {
    /// The map from world to clip space for a picture of this size; the same arithmetic that culling uses.
    pub fn projection(&self, size_px: [u32; 2]) -> Projection<Vec3> {
        let eye = Eye {
            position: self.position,
            target: self.target,
            up: self.up,
            fov: self.fov,
            near: self.near,
            far: self.far,
        };
        View::<Solid> { eye, width: size_px[0].max(1), height: size_px[1].max(1) }.projection()
    }
    /// Where a world point falls in the picture; `None` before the near plane.
    pub fn project(&self, point: Vec3, size_px: [u32; 2]) -> Option<Vec2> {
        let clip = self.projection(size_px).clip(point);
        let ndc = (clip.z >= self.near).then(|| clip.truncate() / clip.z)?;
        Some(
            Vec2::new(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5) * Vec2::new(size_px[0] as f32, size_px[1] as f32),
        )
    }
    /// Origin and unit direction of the ray through a pixel position.
    pub fn ray(&self, at_px: Vec2, size_px: [u32; 2]) -> (Vec3, Vec3) {
        let rows = self.projection(size_px).rows;
        let ndc = Vec2::new(
            at_px.x / size_px[0].max(1) as f32 * 2.0 - 1.0,
            1.0 - at_px.y / size_px[1].max(1) as f32 * 2.0,
        );
        // The rows are orthogonal; dividing by the squared length undoes their scale.
        let direction = rows[2]
            + rows[0] * (ndc.x / rows[0].length_squared())
            + rows[1] * (ndc.y / rows[1].length_squared());
        (self.position, direction.normalize())
    }
    /// Clip z is `constant + slope · depth`: 1 at the near plane, 0 at the far plane or at infinity. A
    /// floating-point buffer is then about equally fine at every depth.
    pub(super) fn reversed_depth(&self) -> [f32; 2] {
        let (near, far) = (f64::from(self.near), f64::from(self.far));
        if far.is_finite() {
            [(near * far / (far - near)) as f32, (-near / (far - near)) as f32]
        } else {
            [self.near, 0.0]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: SpaceCamera = SpaceCamera {
        position: Vec3::new(3.0, 2.0, 5.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov: 0.9,
        near: 0.1,
        far: 5000.0,
    };

    #[test]
    fn a_ray_goes_through_what_is_projected_on_its_pixel() {
        let size = [640, 360];
        for point in [Vec3::ZERO, Vec3::new(0.4, -0.3, 1.0), Vec3::new(-2.0, 0.5, -7.0)] {
            let at = CAMERA.project(point, size).expect("in front");
            let (origin, direction) = CAMERA.ray(at, size);
            let off = (point - origin).cross(direction).length();
            assert!(off < 1e-4 * (point - origin).length(), "{point}: {off}");
        }
        assert_eq!(CAMERA.project(Vec3::new(6.0, 4.0, 10.0), size), None);
    }

    #[test]
    fn depth_is_one_at_near_and_zero_at_far() {
        let z = |camera: SpaceCamera, d: f32| {
            let [constant, slope] = camera.reversed_depth();
            (constant + slope * d) / d
        };
        assert!((z(CAMERA, 0.1) - 1.0).abs() < 1e-5);
        assert!(z(CAMERA, 5000.0).abs() < 1e-9);
        let open = SpaceCamera { far: f32::INFINITY, ..CAMERA };
        assert!((z(open, 0.1) - 1.0).abs() < 1e-6 && (z(open, 1000.0) - 1e-4).abs() < 1e-9);
        // Two surfaces a millimeter apart at ten units differ by many steps of the buffer.
        let steps = z(CAMERA, 10.0).to_bits() - z(CAMERA, 10.001).to_bits();
        assert!(steps > 500, "{steps}");
    }
}
