//! Where another rasterizer shows another triangle than ours, and why.

use glam::{DVec2, DVec3};

use crate::geometry::{PrimId, Solid, View};
use crate::raster::Target;
use crate::scene::Scene;

/// An edge that passes a pixel's center within this distance may be snapped to either side of it: twice our
/// grid of 1/256 pixel, and as much for the other's.
const SNAP_PX: f64 = 1.0 / 64.0;
/// Depths that differ by no more, relative to the greater, are a tie for arithmetic in f32.
const TIE: f64 = 1e-5;

/// Pixels that two item buffers of a view disagree on, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disagreement {
    /// Pixels compared.
    pub pixels: usize,
    /// An edge of either triangle passes within 1/64 pixel of the center: it was snapped to another side.
    pub edges: usize,
    /// Both triangles lie at the same depth there, as far as f32 goes.
    pub ties: usize,
    /// Neither.
    pub others: usize,
}

impl Disagreement {
    /// Pixels that differ.
    pub fn total(&self) -> usize {
        self.edges + self.ties + self.others
    }
    /// Adds those of another view.
    pub fn join(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.edges += other.edges;
        self.ties += other.ties;
        self.others += other.others;
    }
}

/// Compares two item buffers of a view.
pub fn disagreement(scene: &Scene<Solid>, view: &View<Solid>, ours: &[u32], theirs: &[u32]) -> Disagreement {
    let mut all = Disagreement { pixels: ours.len(), ..Disagreement::default() };
    for (at, (&a, &b)) in ours.iter().zip(theirs).enumerate() {
        if a == b {
            continue;
        }
        let (column, row) = (at % view.width as usize, at / view.width as usize);
        let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
        let seen: Vec<Seen> = [a, b]
            .into_iter()
            .filter(|&i| i != Target::NONE)
            .map(|i| see(scene, view, PrimId(i), center))
            .collect();
        if seen.iter().any(|s| s.edge_px < SNAP_PX) {
            all.edges += 1;
        } else if let [a, b] = &seen[..]
            && (a.depth - b.depth).abs() <= TIE * a.depth.abs().max(b.depth.abs())
        {
            all.ties += 1;
        } else {
            all.others += 1;
        }
    }
    all
}

/// A triangle at a pixel's center: how near its nearest edge passes, pixels, and the inverse depth of its
/// plane there.
struct Seen {
    edge_px: f64,
    depth: f64,
}

fn see(scene: &Scene<Solid>, view: &View<Solid>, prim: PrimId, center: DVec2) -> Seen {
    let projection = view.projection();
    let rows = [0, 1, 2].map(|r| projection.rows[r].as_dvec3());
    let (half, eye) =
        (DVec2::new(f64::from(view.width), f64::from(view.height)) * 0.5, projection.eye.as_dvec3());
    let corners: Vec<DVec3> = scene.prim_points(prim).map(|p| p.as_dvec3() - eye).collect();
    let clip: Vec<DVec3> =
        corners.iter().map(|p| DVec3::new(rows[0].dot(*p), rows[1].dot(*p), rows[2].dot(*p))).collect();
    // Where the ray through the center meets the plane, `n · (t · ray) = n · corner`; t is the view depth.
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let at = DVec2::new(center.x / half.x - 1.0, 1.0 - center.y / half.y);
    let square = [rows[0].length_squared(), rows[1].length_squared()];
    let ray = rows[2] + rows[0] * (at.x / square[0]) + rows[1] * (at.y / square[1]);
    let depth = normal.dot(ray) / normal.dot(corners[0]);
    // An edge that reaches behind the eye is taken as the line that its visible part lies on.
    let mut edge_px = f64::INFINITY;
    for k in 0..3 {
        let line = clip[k].cross(clip[(k + 1) % 3]);
        // The line `line · (x, y, 1) = 0` in clip coordinates, as pixels.
        let scaled = DVec2::new(line.x / half.x, -line.y / half.y);
        let value = line.dot(DVec3::new(at.x, at.y, 1.0));
        edge_px = edge_px.min(value.abs() / scaled.length().max(f64::MIN_POSITIVE));
    }
    Seen { edge_px, depth }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::dice::Dice;
    use crate::raster::render;
    use crate::scene::{random_views, samples};

    /// What is exchanged by hand is called what it is.
    #[test]
    fn reasons_are_told_apart() {
        let scene = samples::soup::<Solid>(3, 200);
        let mut dice = Dice::new(4);
        let (mut told, mut edges) = (Disagreement::default(), 0);
        for view in random_views(&scene, 4, 9) {
            let ours = render(&scene, &view, scene.live()).item;
            assert_eq!(disagreement(&scene, &view, &ours, &ours).total(), 0);
            // A triangle far from the pixel that it is said to show in.
            let mut theirs = ours.clone();
            for _ in 0..50 {
                let at = (dice.signed(0.5) + 0.5) * (theirs.len() - 1) as f32;
                theirs[at as usize] = theirs[at as usize].wrapping_add(1) % 200;
            }
            told.join(disagreement(&scene, &view, &ours, &theirs));
            // Pixels beside an edge of the image, exchanged with their neighbor, are not within 1/64 pixel.
            edges += disagreement(&scene, &view, &ours, &theirs).edges;
        }
        assert!(told.others > 100 && edges < told.total() / 4, "{told:?}");
        assert!(told.pixels > 100_000 && told.total() <= 200);
    }

    /// Two triangles in one plane are a tie.
    #[test]
    fn coplanar_ones_are_ties() {
        use crate::geometry::Eye;
        use crate::scene::Parts;
        use glam::Vec3;
        let points = [[-3.0, -3.0], [3.0, -3.0], [0.0, 3.0], [-3.0, 2.9], [3.0, 2.9], [0.0, -3.1]];
        let points = points.map(|[x, y]| Vec3::new(x, y, -5.0 - 0.1 * x)).to_vec();
        let scene: Scene<Solid> =
            Scene::new(Parts::simple("two", points, vec![[0, 1, 2], [3, 4, 5]])).expect("a scene");
        let (position, target, up) = (Vec3::ZERO, Vec3::NEG_Z, Vec3::Y);
        let eye = Eye { position, target, up, fov: 1.0, near: 0.1, far: 100.0 };
        let view = View { eye, width: 33, height: 33 };
        let told = disagreement(&scene, &view, &[0; 33 * 33], &[1; 33 * 33]);
        assert!(told.ties > 900 && told.others == 0, "{told:?}");
    }
}
