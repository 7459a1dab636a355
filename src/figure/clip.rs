//! Cuts a paper drawing to a rectangle, so that a panel of a figure keeps to its frame.
//!
//! Lines by Liang and Barsky 1984, convex areas by Sutherland and Hodgman 1974. A dot or a text stays if its
//! anchor does; a line that is cut becomes several, an arrow whose head is cut off a line.

use glam::Vec2;

use crate::drawing::{Drawing, Item, Mark};

/// Cuts every mark of `drawing` to the rectangle from `min_pt` to `max_pt`.
pub fn clip(drawing: &mut Drawing<Vec2>, min_pt: Vec2, max_pt: Vec2) {
    let frame = Frame { min: min_pt, max: max_pt };
    let items = std::mem::take(&mut drawing.items);
    for item in items {
        let (role, subject, layer) = (item.role, item.subject, item.layer);
        drawing.items.extend(frame.mark(item.mark).into_iter().map(|mark| Item {
            mark,
            role,
            subject,
            layer,
        }));
    }
}

struct Frame {
    min: Vec2,
    max: Vec2,
}

impl Frame {
    fn holds(&self, p: Vec2) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    fn mark(&self, mark: Mark<Vec2>) -> Vec<Mark<Vec2>> {
        match mark {
            Mark::Line { points, closed } if points.iter().all(|&p| self.holds(p)) => {
                vec![Mark::Line { points, closed }]
            }
            Mark::Line { mut points, closed } => {
                if closed && let Some(&first) = points.first() {
                    points.push(first);
                }
                self.pieces(&points).into_iter().map(|points| Mark::Line { points, closed: false }).collect()
            }
            Mark::Area(points) => {
                Some(self.area(points)).filter(|p| p.len() > 2).map(Mark::Area).into_iter().collect()
            }
            Mark::Swatch { points, rgba } => {
                let parts = Some(self.area(points)).filter(|p| p.len() > 2);
                parts.map(|points| Mark::Swatch { points, rgba }).into_iter().collect()
            }
            Mark::Facet { points, is_edge, rgb } => self.facet(points, is_edge, rgb),
            Mark::Arrow(a, b) if self.holds(a) && self.holds(b) => vec![Mark::Arrow(a, b)],
            Mark::Arrow(a, b) => match self.segment(a, b) {
                Some((c, d)) if d == b => vec![Mark::Arrow(c, d)],
                Some((c, d)) => vec![Mark::Line { points: vec![c, d], closed: false }],
                None => vec![],
            },
            Mark::Dot { at, .. } | Mark::Text { at, .. } if !self.holds(at) => vec![],
            mark => vec![mark],
        }
    }

    /// The part of a segment in the frame.
    fn segment(&self, a: Vec2, b: Vec2) -> Option<(Vec2, Vec2)> {
        let (mut enter, mut leave) = (0f32, 1f32);
        let d = b - a;
        for (from, along, low, high) in
            [(a.x, d.x, self.min.x, self.max.x), (a.y, d.y, self.min.y, self.max.y)]
        {
            if along == 0.0 {
                if from < low || from > high {
                    return None;
                }
                continue;
            }
            let (t0, t1) = ((low - from) / along, (high - from) / along);
            enter = enter.max(t0.min(t1));
            leave = leave.min(t0.max(t1));
        }
        let at = |t: f32, end: f32, point: Vec2| if t == end { point } else { a + d * t };
        (enter <= leave).then(|| (at(enter, 0.0, a), at(leave, 1.0, b)))
    }

    /// The connected pieces of a polyline in the frame.
    fn pieces(&self, points: &[Vec2]) -> Vec<Vec<Vec2>> {
        let mut pieces: Vec<Vec<Vec2>> = Vec::new();
        for pair in points.windows(2) {
            let Some((a, b)) = self.segment(pair[0], pair[1]) else { continue };
            match pieces.last_mut() {
                Some(last) if last.last() == Some(&a) => last.push(b),
                _ => pieces.push(vec![a, b]),
            }
        }
        pieces
    }

    /// The part of a facet; sides along the frame are none of its edges.
    fn facet(&self, points: Vec<Vec2>, is_edge: Vec<bool>, rgb: Option<[u8; 3]>) -> Vec<Mark<Vec2>> {
        if points.iter().all(|&p| self.holds(p)) {
            return vec![Mark::Facet { points, is_edge, rgb }];
        }
        let n = points.len();
        let mut marks = Vec::new();
        let inside = self.area(points.clone());
        if inside.len() > 2 && rgb.is_some() {
            let is_edge = vec![false; inside.len()];
            marks.push(Mark::Facet { points: inside, is_edge, rgb });
        }
        for k in (0..n).filter(|&k| is_edge[k]) {
            if let Some((a, b)) = self.segment(points[k], points[(k + 1) % n]) {
                // Two corners and a side: an edge alone.
                marks.push(Mark::Facet { points: vec![a, b], is_edge: vec![true, false], rgb: None });
            }
        }
        marks
    }

    fn area(&self, mut points: Vec<Vec2>) -> Vec<Vec2> {
        for (axis, limit, sign) in
            [(0, self.min.x, 1.0), (0, self.max.x, -1.0), (1, self.min.y, 1.0), (1, self.max.y, -1.0)]
        {
            let inside = |p: Vec2| (p[axis] - limit) * sign;
            let mut kept = Vec::with_capacity(points.len() + 1);
            for (i, &b) in points.iter().enumerate() {
                let a = points[(i + points.len() - 1) % points.len()];
                let (da, db) = (inside(a), inside(b));
                if (da < 0.0) != (db < 0.0) {
                    kept.push(a + (b - a) * (da / (da - db)));
                }
                if db >= 0.0 {
                    kept.push(b);
                }
            }
            points = kept;
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Layer, Role, Subject};

    const MIN: Vec2 = Vec2::ZERO;
    const MAX: Vec2 = Vec2::new(10.0, 10.0);

    fn clipped(mark: Mark<Vec2>) -> Vec<Mark<Vec2>> {
        let mut d = Drawing::default();
        d.push(Layer::Scene, Role::Ink, Subject::None, mark);
        clip(&mut d, MIN, MAX);
        d.items.into_iter().map(|i| i.mark).collect()
    }
    fn line(points: &[[f32; 2]], closed: bool) -> Mark<Vec2> {
        Mark::Line { points: points.iter().map(|&p| p.into()).collect(), closed }
    }

    #[test]
    fn what_is_inside_stays_as_it_is() {
        let square = line(&[[1.0, 1.0], [9.0, 1.0], [9.0, 9.0]], true);
        assert_eq!(clipped(square.clone()), [square]);
    }

    #[test]
    fn a_line_through_is_cut_at_both_ends_and_one_beside_goes() {
        assert_eq!(
            clipped(line(&[[-5.0, 5.0], [15.0, 5.0]], false)),
            [line(&[[0.0, 5.0], [10.0, 5.0]], false)]
        );
        assert_eq!(clipped(line(&[[-5.0, 11.0], [15.0, 11.0]], false)), []);
    }

    #[test]
    fn a_line_that_leaves_and_returns_becomes_two() {
        let zigzag = line(&[[5.0, 5.0], [15.0, 5.0], [15.0, 6.0], [5.0, 6.0]], false);
        assert_eq!(
            clipped(zigzag),
            [line(&[[5.0, 5.0], [10.0, 5.0]], false), line(&[[10.0, 6.0], [5.0, 6.0]], false)]
        );
    }

    #[test]
    fn an_area_keeps_the_part_inside() {
        let area = Mark::Area(vec![
            Vec2::new(5.0, 5.0),
            Vec2::new(15.0, 5.0),
            Vec2::new(15.0, 8.0),
            Vec2::new(5.0, 8.0),
        ]);
        let Some(Mark::Area(points)) = clipped(area).pop() else { panic!("an area") };
        assert_eq!(points.iter().map(|p| p.x).fold(0.0, f32::max), 10.0);
        assert_eq!(
            clipped(Mark::Area(vec![Vec2::splat(20.0), Vec2::new(30.0, 20.0), Vec2::splat(30.0)])),
            []
        );
    }

    #[test]
    fn an_arrow_without_its_head_is_a_line() {
        assert!(matches!(clipped(Mark::Arrow(Vec2::ONE, Vec2::new(20.0, 1.0)))[0], Mark::Line { .. }));
        assert!(matches!(clipped(Mark::Arrow(Vec2::new(-5.0, 1.0), Vec2::ONE))[0], Mark::Arrow(..)));
    }
}
