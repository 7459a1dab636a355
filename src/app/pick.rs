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
        if let Some((prim, _)) = figure::pick_segment(self.posed(), at, reach, |prim| self.shows(prim)) {
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
    /// From where to where a thing reaches in the image, −1 to 1; `None` if nothing of it is before the Eye.
    pub fn extent_of(&self, subject: Subject) -> Option<(f32, f32)> {
        let corners: Vec<_> = match subject {
            Subject::Prim(prim) if prim.at() < self.scene.prim_count() => {
                self.posed().prim_points(prim).collect()
            }
            _ => self.bounds_of(subject).filter(|b| !b.is_empty())?.corners().collect(),
        };
        let (projection, near) = (self.view.projection(), self.view.eye.near);
        let clip: Vec<_> = corners.iter().map(|&p| projection.clip(p)).collect();
        let pairs = clip.iter().flat_map(|a| clip.iter().map(move |b| (*a, *b)));
        // Of each side the part that lies before the Eye.
        let before = pairs.filter(|(a, _)| a.y >= near).flat_map(|(a, b)| {
            let b = if b.y >= near { b } else { a + (b - a) * ((near - a.y) / (b.y - a.y)) };
            [a.x / a.y, b.x / b.y]
        });
        let (from, to) = before.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        (from <= 1.0 && to >= -1.0).then(|| (from.max(-1.0), to.min(1.0)))
    }
    /// What each column of the Eye's image shows, from left to right.
    pub fn image(&self) -> Vec<Column> {
        let target = raster::render(&**self.posed(), &self.view, &self.shown_prims());
        let nearest = |(&item, &depth): (&u32, &f32)| {
            let opaque = (item != Target::NONE).then(|| (PrimId(item), 1.0 / depth));
            Column { opaque, through: Vec::new() }
        };
        let mut columns: Vec<Column> = target.item.iter().zip(&target.depth).map(nearest).collect();
        let options = raster::Options::default();
        raster::look_through(
            &target,
            self.posed(),
            &self.view,
            &target.through,
            &options,
            |prim, at, depth| {
                columns[at].through.push((prim, 1.0 / depth));
            },
        );
        columns.iter_mut().for_each(|c| c.through.sort_by(|a, b| b.1.total_cmp(&a.1)));
        columns
    }
}

/// What one pixel of the flatland Eye shows: segments and their view depths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// The nearest that is opaque.
    pub opaque: Option<(PrimId, f32)>,
    /// The see-through ones before it, the farthest first.
    pub through: Vec<(PrimId, f32)>,
}
