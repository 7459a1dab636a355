//! What lies under the cursor, and the flatland Eye's one line of pixels.

use glam::Vec2;

use super::stage::Stage;
use crate::drawing::Subject;
use crate::figure;
use crate::geometry::{Flat, NodeId, PrimId};
use crate::raster::{self, Target};

impl Stage<Flat> {
    /// The segment within `reach` of a point, else the deepest node visited by `step` that holds the point.
    pub fn pick(&self, at: Vec2, reach: f32, step: usize) -> Subject {
        if let Some((prim, _)) = figure::pick_segment(&self.scene, at, reach, |_| true) {
            return Subject::Prim(prim);
        }
        let Some(recorded) = &self.recorded else { return Subject::None };
        let hierarchy = recorded.film.hierarchy();
        let holds =
            |&n: &NodeId| recorded.stamps.entered(n) as usize <= step && hierarchy.bounds(n).contains(at);
        let nodes = (0..hierarchy.node_count() as u32).map(NodeId).filter(holds);
        nodes
            .max_by_key(|&n| (hierarchy.level(n), n))
            .filter(|n| n.0 > 0)
            .map_or(Subject::None, Subject::Node)
    }
    /// For each column of the Eye's image, from left to right, the nearest segment and its view depth.
    pub fn image(&self) -> Vec<Option<(PrimId, f32)>> {
        let target = raster::render(&*self.scene, &self.view, self.scene.live());
        let cell =
            |(&item, &depth): (&u32, &f32)| (item != Target::NONE).then(|| (PrimId(item), 1.0 / depth));
        target.item.iter().zip(&target.depth).map(cell).collect()
    }
}
