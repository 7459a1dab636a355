//! World to paper: an affine map in flatland, a perspective projection in space.

use glam::{Vec2, Vec3};

use crate::drawing::{Drawing, Item, Layer, Mark};
use crate::geometry::{Aabb, Projection, Solid, View};

/// Where flatland lies on paper: y of the world points up, y of the paper down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// World point in the middle of the picture.
    pub center: Vec2,
    /// Paper points a world unit.
    pub scale: f32,
    /// Paper position of `center`.
    pub middle_pt: Vec2,
}

impl Sheet {
    /// The sheet that fits `world` into the paper rectangle from `min_pt` to `max_pt`.
    pub fn fit(world: &Aabb<Vec2>, min_pt: Vec2, max_pt: Vec2) -> Self {
        let (have, want) = ((max_pt - min_pt).max(Vec2::ONE), world.size().max(Vec2::splat(1e-6)));
        Self {
            center: world.center(),
            scale: (have / want).min_element(),
            middle_pt: (min_pt + max_pt) * 0.5,
        }
    }
    /// World to paper.
    pub fn to_paper(&self, world: Vec2) -> Vec2 {
        self.middle_pt + (world - self.center) * Vec2::new(self.scale, -self.scale)
    }
    /// Paper to world.
    pub fn to_world(&self, paper: Vec2) -> Vec2 {
        self.center + (paper - self.middle_pt) * Vec2::new(1.0 / self.scale, -1.0 / self.scale)
    }
    /// Puts a world drawing on paper, after what is there. The paper keeps its size.
    pub fn place(&self, world: &Drawing<Vec2>, paper: &mut Drawing<Vec2>) {
        for item in &world.items {
            paper.items.push(Item {
                mark: map(&item.mark, &|p| self.to_paper(p)),
                role: item.role,
                subject: item.subject,
                layer: item.layer,
            });
        }
    }
}

fn map<P: Copy>(mark: &Mark<P>, f: &impl Fn(P) -> Vec2) -> Mark<Vec2> {
    let all = |points: &[P]| points.iter().map(|&p| f(p)).collect();
    match mark {
        Mark::Line { points, closed } => Mark::Line { points: all(points), closed: *closed },
        Mark::Area(points) => Mark::Area(all(points)),
        Mark::Swatch { points, rgba } => Mark::Swatch { points: all(points), rgba: *rgba },
        Mark::Facet { points, is_edge, rgb } => {
            Mark::Facet { points: all(points), is_edge: is_edge.clone(), rgb: *rgb }
        }
        Mark::Arrow(a, b) => Mark::Arrow(f(*a), f(*b)),
        Mark::Dot { at, radius_pt } => Mark::Dot { at: f(*at), radius_pt: *radius_pt },
        Mark::Text { at, text, size_pt, anchor, font } => {
            Mark::Text { at: f(*at), text: text.clone(), size_pt: *size_pt, anchor: *anchor, font: *font }
        }
        Mark::Image { corners, pixels } => Mark::Image { corners: corners.map(f), pixels: pixels.clone() },
    }
}

/// Puts a drawing of space on paper as seen by `observer`, whose image fills the rectangle from
/// `min_pt` to `max_pt`. What lies before the near plane is cut off; areas of the scene layer are
/// sorted back to front by their mean depth (the painter's algorithm: right for scenes of separate
/// convex polygons, an approximation where they interpenetrate).
pub fn project(
    world: &Drawing<Vec3>,
    observer: &View<Solid>,
    min_pt: Vec2,
    max_pt: Vec2,
    paper: &mut Drawing<Vec2>,
) {
    let camera = Camera::new(observer, min_pt, max_pt);
    let mut placed: Vec<(f32, Item<Vec2>)> = Vec::with_capacity(world.items.len());
    for item in &world.items {
        if let Some((depth, mark)) = camera.mark(&item.mark) {
            placed.push((depth, Item { mark, role: item.role, subject: item.subject, layer: item.layer }));
        }
    }
    let is_sorted = |item: &Item<Vec2>| item.layer == Layer::Scene && matches!(item.mark, Mark::Area(_));
    let (mut sorted, others): (Vec<_>, Vec<_>) = placed.into_iter().partition(|(_, item)| is_sorted(item));
    sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
    paper.items.extend(sorted.into_iter().chain(others).map(|(_, item)| item));
}

/// World to paper.
pub(super) struct Camera {
    projection: Projection<Vec3>,
    near: f32,
    min_pt: Vec2,
    size_pt: Vec2,
}

impl Camera {
    /// What `observer` sees fills a rectangle.
    pub(super) fn new(observer: &View<Solid>, min_pt: Vec2, max_pt: Vec2) -> Self {
        let (projection, near) = (observer.projection(), observer.eye.near);
        Self { projection, near, min_pt, size_pt: max_pt - min_pt }
    }
    /// World to clip coordinates.
    pub(super) fn clip(&self, p: Vec3) -> Vec3 {
        self.projection.clip(p)
    }
    /// Clip coordinates to paper.
    pub(super) fn paper(&self, clip: Vec3) -> Vec2 {
        let image = Vec2::new(clip.x, -clip.y) / clip.z * 0.5 + Vec2::splat(0.5);
        self.min_pt + image * self.size_pt
    }
    fn point(&self, p: Vec3) -> Option<Vec2> {
        let clip = self.projection.clip(p);
        (clip.z >= self.near).then(|| self.paper(clip))
    }
    /// The part of a polygon that is not before the near plane.
    fn clipped(&self, points: &[Vec3], closed: bool) -> Vec<Vec3> {
        let clip: Vec<Vec3> = points.iter().map(|&p| self.projection.clip(p)).collect();
        let mut kept = Vec::with_capacity(clip.len() + 1);
        for (i, &b) in clip.iter().enumerate() {
            if i > 0 || closed {
                let a = clip[(i + clip.len() - 1) % clip.len()];
                if (a.z < self.near) != (b.z < self.near) {
                    kept.push(a + (b - a) * ((self.near - a.z) / (b.z - a.z)));
                }
            }
            if b.z >= self.near {
                kept.push(b);
            }
        }
        kept
    }
    /// A mark with its mean view depth; `None` if nothing of it is before the eye.
    fn mark(&self, mark: &Mark<Vec3>) -> Option<(f32, Mark<Vec2>)> {
        let lines = |points: &[Vec3], closed: bool| {
            let clip = self.clipped(points, closed);
            let depth = clip.iter().map(|c| c.z).sum::<f32>() / clip.len().max(1) as f32;
            (clip.len() >= 2).then(|| (depth, clip.iter().map(|&c| self.paper(c)).collect::<Vec<_>>()))
        };
        let depth = |p: Vec3| self.projection.depth(p);
        match mark {
            Mark::Line { points, closed } => {
                lines(points, *closed).map(|(d, points)| (d, Mark::Line { points, closed: *closed }))
            }
            Mark::Area(points) => {
                lines(points, true).filter(|(_, p)| p.len() > 2).map(|(d, p)| (d, Mark::Area(p)))
            }
            Mark::Swatch { points, rgba } => lines(points, true)
                .filter(|(_, p)| p.len() > 2)
                .map(|(d, points)| (d, Mark::Swatch { points, rgba: *rgba })),
            Mark::Arrow(a, b) => lines(&[*a, *b], false).map(|(d, p)| (d, Mark::Arrow(p[0], p[1]))),
            Mark::Dot { at, radius_pt } => {
                Some((depth(*at), Mark::Dot { at: self.point(*at)?, radius_pt: *radius_pt }))
            }
            Mark::Text { at, text, size_pt, anchor, font } => Some((
                depth(*at),
                Mark::Text {
                    at: self.point(*at)?,
                    text: text.clone(),
                    size_pt: *size_pt,
                    anchor: *anchor,
                    font: *font,
                },
            )),
            Mark::Facet { .. } | Mark::Image { .. } => None,
        }
    }
}
