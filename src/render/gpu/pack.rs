//! Scene, film and marks as the words of vertex buffers.
//!
//! A triangle takes 48 bytes once a scene (three points, each with the packed look of the triangle) and 24
//! once a film (its stamp at each vertex, and its place in the order of decisions); a node takes 36 once a
//! film. No vertex is shared and nothing needs storage buffers, so GL draws it as well.

use std::ops::Range;

use glam::Vec3;

use crate::drawing::{Drawing, Layer, Mark, Role};
use crate::figure::role_of;
use crate::geometry::{NodeId, PrimId, Solid};
use crate::index::Hierarchy;
use crate::method::Verdict;
use crate::raster::srgb;
use crate::scene::Scene;
use crate::trace::{Stamp, Stamps, State};

/// Words of a triangle's corner: x, y, z, look.
pub(super) type CornerWords = [u32; 4];
/// Words of a node: least corner, greatest corner, step entered, stamp, 1 for a leaf.
pub(super) type NodeWords = [u32; 9];
/// Words of a segment: ends, then role, kind and radius.
pub(super) type SegmentWords = [u32; 7];
/// Words of an area's corner: x, y, z, role.
pub(super) type AreaWords = [u32; 4];

/// Kinds of segment, as in the shader.
const DOT: u32 = 32;
const HEAD: u32 = 64;

/// Bits of a role.
const ROLE_BITS: u32 = 5;

/// Step in the upper 27 bits (a film is capped far below), role in the lower five.
fn stamp_word(stamp: Stamp, wrong: bool) -> u32 {
    let role = if wrong && stamp.verdict != Verdict::Visible {
        Role::Wrong
    } else {
        role_of(State::Decided(stamp.verdict))
    };
    step_word(stamp.step) << ROLE_BITS | role as u32
}
/// A step that the shader can compare; what never happens stays later than every step.
pub(super) fn step_word(step: u32) -> u32 {
    step.min(NEVER)
}
/// Later than every step.
pub(super) const NEVER: u32 = (1 << (32 - ROLE_BITS)) - 1;

/// Stamps of three corners for each of `prims`; `wrong` is ascending.
pub(super) fn stamps(prims: &[PrimId], stamps: Option<&Stamps>, wrong: &[PrimId]) -> Vec<[u32; 3]> {
    let word = |p: &PrimId| {
        stamps.map_or(NEVER << ROLE_BITS, |s| stamp_word(s.prims()[p.at()], wrong.binary_search(p).is_ok()))
    };
    prims.iter().map(|p| [word(p); 3]).collect()
}

/// The triangles of a film in an order in which every state at every step is a few runs, so that a picture
/// draws no triangle that it does not show. Within a run the order is that of the decisions.
pub(super) struct Order {
    /// Role that a run ends in, and the steps of its triangles' decisions, ascending.
    runs: Vec<(u32, Vec<u32>)>,
}

impl Order {
    /// The order, and the corner numbers in it, three a triangle.
    pub fn of(stamps: &[[u32; 3]]) -> (Self, Vec<[u32; 3]>) {
        let mut keys: Vec<u64> = stamps
            .iter()
            .enumerate()
            .map(|(i, s)| u64::from(s[0].rotate_right(ROLE_BITS)) << 32 | i as u64)
            .collect();
        keys.sort_unstable();
        let mut runs: Vec<(u32, Vec<u32>)> = Vec::new();
        for key in &keys {
            let (role, step) = ((key >> (64 - ROLE_BITS)) as u32, (key >> 32) as u32 & NEVER);
            if runs.last().is_none_or(|(last, _)| *last != role) {
                runs.push((role, Vec::new()));
            }
            runs.last_mut().into_iter().for_each(|(_, steps)| steps.push(step));
        }
        let indices = keys.iter().map(|&k| [0, 1, 2].map(|c| 3 * (k as u32) + c)).collect();
        (Self { runs }, indices)
    }
    /// Ranges of triangles whose role at `step` has its bit in `shown`.
    pub fn shown(&self, step: u32, shown: u32) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = Vec::new();
        let mut at = 0;
        for (role, steps) in &self.runs {
            let decided = steps.partition_point(|&s| s <= step) as u32;
            for (role, end) in [(*role, at + decided), (Role::Scene as u32, at + steps.len() as u32)] {
                let start = std::mem::replace(&mut at, end);
                if shown >> role & 1 == 0 || start == end {
                    continue;
                }
                match ranges.last_mut() {
                    Some(last) if last.end == start => last.end = end,
                    _ => ranges.push(start..end),
                }
            }
        }
        ranges
    }
}

/// Three corners for each of `prims`, flat-shaded. `inner` are the bits of sides inside faces, by id.
pub(super) fn corners(scene: &Scene<Solid>, prims: &[PrimId], inner: &[u8]) -> Vec<[CornerWords; 3]> {
    let corner = |p: Vec3, look: u32| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), look];
    prims
        .iter()
        .map(|&prim| {
            let look = look_word(scene.color_of(prim), scene.normal(prim), inner[prim.at()])
                | u32::from(scene.is_see_through(prim)) << 28;
            let mut points = scene.prim_points(prim);
            std::array::from_fn(|_| corner(points.next().unwrap_or_default(), look))
        })
        .collect()
}

/// Toward the light. The shade depends on the plane alone and not on which side is its front, since many
/// models wind their triangles either way; the three axes get three shades.
const LIGHT: Vec3 = Vec3::new(0.36, 0.80, 0.48);
/// Shade of planes along the light.
const AMBIENT: f32 = 0.62;

/// Seven bits a channel of the sRGB color, seven of shade, one free for what is see-through, three of inner
/// sides.
fn look_word(linear: [f32; 3], normal: Vec3, inner: u8) -> u32 {
    let shade = AMBIENT + (1.0 - AMBIENT) * normal.normalize_or(LIGHT).dot(LIGHT).abs().min(1.0);
    let channels = linear.map(|c| (srgb(c) * 127.0).round() as u32);
    channels[0]
        | channels[1] << 7
        | channels[2] << 14
        | ((shade * 127.0).round() as u32) << 21
        | u32::from(inner & 7) << 29
}

/// For each primitive the bits of sides that lie inside a face: bit `i` is the side opposite corner `i`.
/// Wires leave these out, so a wall is drawn as the polygon it is.
pub(super) fn inner_sides(scene: &Scene<Solid>) -> Vec<u8> {
    let mut bits = vec![0u8; scene.prim_count()];
    let mut rim = Vec::new();
    for face in scene.faces().iter().filter(|f| f.prims.len() > 1) {
        let n = face.corners.len();
        rim.clear();
        rim.extend((0..n).map(|i| ordered(face.corners[i], face.corners[(i + 1) % n])));
        rim.sort_unstable();
        for &prim in &face.prims {
            let Some(c) = scene.corners(prim) else { continue };
            for side in 0..3 {
                let edge = ordered(c[(side + 1) % 3], c[(side + 2) % 3]);
                bits[prim.at()] |= u8::from(rim.binary_search(&edge).is_err()) << side;
            }
        }
    }
    bits
}
fn ordered(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// Nodes ordered by level, and where each level begins (one more entry than levels).
pub(super) fn nodes(stamps: &Stamps, hierarchy: &dyn Hierarchy<Solid>) -> (Vec<NodeWords>, Vec<u32>) {
    let mut ids: Vec<NodeId> = (0..hierarchy.node_count() as u32).map(NodeId).collect();
    ids.sort_by_key(|&n| hierarchy.level(n));
    let mut starts = vec![0];
    let words = ids.iter().enumerate().map(|(i, &n)| {
        while starts.len() <= hierarchy.level(n) as usize {
            starts.push(i as u32);
        }
        let (low, high) = (hierarchy.bounds(n).min, hierarchy.bounds(n).max);
        let leaf = hierarchy.children(n).is_empty();
        let [a, b] = [low, high].map(|v| v.to_array().map(f32::to_bits));
        [
            a[0],
            a[1],
            a[2],
            b[0],
            b[1],
            b[2],
            step_word(stamps.entered(n)),
            stamp_word(stamps.nodes()[n.at()], false),
            leaf.into(),
        ]
    });
    let words: Vec<_> = words.collect();
    starts.push(ids.len() as u32);
    (words, starts)
}

/// A segment between two points in a role.
pub(super) fn segment(a: Vec3, b: Vec3, role: Role) -> SegmentWords {
    words(a, b, role as u32)
}
fn words(a: Vec3, b: Vec3, word: u32) -> SegmentWords {
    let [a, b] = [a, b].map(|v| v.to_array().map(f32::to_bits));
    [a[0], a[1], a[2], b[0], b[1], b[2], word]
}

/// An area in a color of its own, instead of a role's.
const SWATCH: u32 = 1 << 31;

/// Marks by layer, in the order in which they are painted.
#[derive(Default)]
pub(super) struct MarkWords {
    /// Segments, dots and heads.
    pub segments: Vec<SegmentWords>,
    /// Triangles of areas.
    pub areas: Vec<AreaWords>,
    /// Layer, first segment, first corner of an area; ascending.
    pub layers: Vec<(Layer, u32, u32)>,
}

/// Turns marks in the world into segments and areas. Text and images are left to whoever paints over the
/// viewport: they are flat on the screen.
pub(super) fn marks(drawing: &Drawing<Vec3>) -> MarkWords {
    let mut to = MarkWords::default();
    for item in drawing.painted() {
        if to.layers.last().is_none_or(|(layer, ..)| *layer != item.layer) {
            to.layers.push((item.layer, to.segments.len() as u32, to.areas.len() as u32));
        }
        let mut polyline = |points: &[Vec3], closed: bool| {
            to.segments.extend(points.windows(2).map(|w| segment(w[0], w[1], item.role)));
            if let ([first, .., last], true) = (points, closed) {
                to.segments.push(segment(*last, *first, item.role));
            }
        };
        match &item.mark {
            Mark::Line { points, closed } => polyline(points, *closed),
            Mark::Arrow(from, end) => {
                polyline(&[*from, *end], false);
                to.segments.push(words(*from, *end, item.role as u32 | HEAD));
            }
            Mark::Dot { at, radius_pt } => {
                let radius = (radius_pt * 16.0).round().clamp(1.0, 255.0) as u32;
                to.segments.push(words(*at, *at, item.role as u32 | DOT | radius << 8));
            }
            Mark::Area(points) => {
                polyline(points, true);
                let corner = |p: Vec3| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), item.role as u32];
                for i in 2..points.len() {
                    to.areas.extend([points[0], points[i - 1], points[i]].map(corner));
                }
            }
            Mark::Swatch { points, rgba } => {
                // Without an outline: there are thousands, a few pixels large, and it would hide them.
                // In the place of a role: the color, seven bits of opacity, and a mark that says so.
                let [r, g, b, alpha] = rgba.map(u32::from);
                let color = SWATCH | (alpha >> 1) << 24 | r << 16 | g << 8 | b;
                let corner = |p: Vec3| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), color];
                for i in 2..points.len() {
                    to.areas.extend([points[0], points[i - 1], points[i]].map(corner));
                }
            }
            // Facets are in figures alone.
            Mark::Facet { .. } | Mark::Text { .. } | Mark::Image { .. } => {}
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROLE: u32 = (1 << ROLE_BITS) - 1;
    use crate::drawing::Subject;

    #[test]
    fn a_stamp_keeps_order_and_role() {
        let stamp = |step, verdict| stamp_word(Stamp { step, verdict }, false);
        assert!(
            stamp(7, Verdict::OverBudget) >> ROLE_BITS == 7
                && stamp(7, Verdict::Hidden) & ROLE == Role::Hidden as u32
        );
        assert!(stamp(Stamp::NEVER, Verdict::Partial) >> ROLE_BITS > 10_000_000);
        assert_eq!(stamp_word(Stamp { step: 3, verdict: Verdict::Outside }, true) & ROLE, Role::Wrong as u32);
        assert_eq!(
            stamp_word(Stamp { step: 3, verdict: Verdict::Visible }, true) & ROLE,
            Role::Visible as u32
        );
    }

    #[test]
    fn the_ranges_of_a_step_hold_the_triangles_that_are_shown() {
        use rand_pcg::{Pcg32, rand_core::Rng};
        let mut random = Pcg32::new(5, 7);
        let ends = [Verdict::Outside, Verdict::Hidden, Verdict::Visible, Verdict::OverBudget];
        for _ in 0..50 {
            let mut stamp = |_| {
                let (step, verdict) = (random.next_u32() % 40, ends[random.next_u32() as usize % 4]);
                [stamp_word(
                    if step < 8 {
                        Stamp { step: Stamp::NEVER, verdict: Verdict::Partial }
                    } else {
                        Stamp { step, verdict }
                    },
                    false,
                ); 3]
            };
            let stamps: Vec<_> = (0..60).map(&mut stamp).collect();
            let (order, indices) = Order::of(&stamps);
            for step in [0, 8, 20, 39, NEVER - 1] {
                let shown = random.next_u32() & 0xffff;
                let role = |w: u32| if w >> ROLE_BITS <= step { w & ROLE } else { Role::Scene as u32 };
                let expected: Vec<u32> =
                    (0..60).filter(|&i| shown >> role(stamps[i as usize][0]) & 1 == 1).collect();
                let mut found: Vec<u32> = order
                    .shown(step, shown)
                    .into_iter()
                    .flatten()
                    .map(|t| indices[t as usize][0] / 3)
                    .collect();
                found.sort_unstable();
                assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn shade_ignores_the_side_and_tells_the_axes_apart() {
        let shade = |n: Vec3| look_word([0.5; 3], n, 0) >> 21 & 127;
        assert_eq!(shade(Vec3::new(1.0, 2.0, 3.0)), shade(Vec3::new(-1.0, -2.0, -3.0)));
        let mut axes = [Vec3::X, Vec3::Y, Vec3::Z].map(shade);
        axes.sort_unstable();
        assert!(axes[0] + 4 <= axes[1] && axes[1] + 4 <= axes[2], "{axes:?}");
    }

    #[test]
    fn marks_become_segments_layer_by_layer() {
        let mut drawing = Drawing::default();
        let p = |x: f32| Vec3::new(x, 0.0, 0.0);
        drawing.push(Layer::Eye, Role::Eye, Subject::Eye, Mark::Arrow(p(0.0), p(1.0)));
        drawing.push(
            Layer::Areas,
            Role::Evidence,
            Subject::None,
            Mark::Area(vec![p(0.0), p(1.0), p(2.0), p(3.0)]),
        );
        drawing.outline(Layer::Frustum, Role::Eye, Subject::Eye, [p(0.0), p(1.0), p(2.0)]);
        let words = marks(&drawing);
        assert_eq!(words.layers, [(Layer::Areas, 0, 0), (Layer::Frustum, 4, 6), (Layer::Eye, 7, 6)]);
        assert_eq!((words.segments.len(), words.areas.len()), (9, 6));
    }
}
