//! What lies under the cursor. Brute force over the scene: under 10 ms for a million triangles.

use glam::{Vec2, Vec3};

use super::stage::Stage;
use crate::drawing::Subject;
use crate::geometry::{Flat, NodeId, PrimId, Solid};

impl Stage<Flat> {
    /// The segment within `reach` of a point, else the deepest node visited by `step` that holds the point.
    pub fn pick(&self, at: Vec2, reach: f32, step: usize) -> Subject {
        let near = |&prim: &PrimId| {
            let mut ends = self.scene.prim_points(prim);
            let (a, b) = (ends.next()?, ends.next()?);
            let along = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            Some(((a + (b - a) * along - at).length(), prim)).filter(|(d, _)| *d <= reach)
        };
        let nearest = self.scene.live().iter().filter_map(near).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some((_, prim)) = nearest {
            return Subject::Prim(prim);
        }
        let Some(recorded) = &self.recorded else { return Subject::None };
        let hierarchy = recorded.film.hierarchy();
        let holds = |&n: &NodeId| recorded.stamps.entered(n) as usize <= step && hierarchy.bounds(n).contains(at);
        let nodes = (0..hierarchy.node_count() as u32).map(NodeId).filter(holds);
        nodes.max_by_key(|&n| (hierarchy.level(n), n)).filter(|n| n.0 > 0).map_or(Subject::None, Subject::Node)
    }
    /// For each column of the Eye's image, from left to right, the nearest segment and its view depth.
    pub fn image(&self) -> Vec<Option<(PrimId, f32)>> {
        let view = &self.view;
        let projection = view.projection();
        let mut columns: Vec<Option<(PrimId, f32)>> = vec![None; view.width as usize];
        for &prim in self.scene.live() {
            let clip: Vec<Vec2> = self.scene.prim_points(prim).map(|p| projection.clip(p)).collect();
            let (mut a, mut b) = (clip[0], clip[1]);
            // Cut at the near plane; the image coordinate x/w and 1/w are linear along what is left.
            if a.y.max(b.y) < view.eye.near {
                continue;
            }
            for (from, to) in [(&mut a, b), (&mut b, clip[0])] {
                if from.y < view.eye.near {
                    *from = *from + (to - *from) * ((view.eye.near - from.y) / (to.y - from.y));
                }
            }
            let column = |p: Vec2| (p.x / p.y * 0.5 + 0.5) * view.width as f32;
            let (mut left, mut right) = ((column(a), 1.0 / a.y), (column(b), 1.0 / b.y));
            if left.0 > right.0 {
                (left, right) = (right, left);
            }
            let first = (left.0 - 0.5).ceil().max(0.0) as usize;
            let end = (right.0 - 0.5).ceil().clamp(0.0, view.width as f32) as usize;
            for (i, cell) in columns.iter_mut().enumerate().take(end).skip(first) {
                let t = ((i as f32 + 0.5 - left.0) / (right.0 - left.0)).clamp(0.0, 1.0);
                let depth = 1.0 / (left.1 + (right.1 - left.1) * t);
                if depth <= view.eye.far && cell.is_none_or(|(_, d)| depth < d) {
                    *cell = Some((prim, depth));
                }
            }
        }
        columns
    }
}

impl Stage<Solid> {
    /// The nearest triangle that a ray hits, of those that `wanted` accepts.
    pub fn pick(&self, origin: Vec3, direction: Vec3, near: f32, wanted: impl Fn(PrimId) -> bool) -> Option<(PrimId, f32)> {
        let mut best: Option<(PrimId, f32)> = None;
        for &prim in self.scene.live() {
            let mut corners = self.scene.prim_points(prim);
            let (Some(a), Some(b), Some(c)) = (corners.next(), corners.next(), corners.next()) else { continue };
            // Möller and Trumbore 1997.
            let (ab, ac) = (b - a, c - a);
            let p = direction.cross(ac);
            let det = ab.dot(p);
            if det == 0.0 {
                continue;
            }
            let s = origin - a;
            let u = s.dot(p) / det;
            let q = s.cross(ab);
            let v = direction.dot(q) / det;
            let t = ac.dot(q) / det;
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= near && best.is_none_or(|(_, d)| t < d) && wanted(prim) {
                best = Some((prim, t));
            }
        }
        best
    }
}
