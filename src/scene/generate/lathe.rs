//! Surfaces of revolution around any axis, along a curve, and over a grid: the finely tessellated shapes of
//! the generators.
//!
//! As everywhere here only addition, multiplication, division and square root are used.

use glam::{DVec3, DVec4};

use super::shapes::{Frame, Sink, circle};
use super::walk::spline;

/// A place on a profile: along the axis, and away from it, m.
pub(super) type Station = [f64; 2];

/// Turns a profile around the axis through `from` along the unit vector `along`. A profile that begins and
/// ends on the axis makes a closed body; seen along the axis the outside is on the left of the profile's
/// direction.
pub(super) fn lathe(sink: &mut Sink, from: DVec3, along: DVec3, profile: &[Station], sides: u32) {
    let sides = sides.max(3);
    let (u, v) = across(along);
    let spokes: Vec<DVec3> =
        (0..2 * sides).map(|k| circle(k, 2 * sides)).map(|(c, s)| u * c + v * s).collect();
    for pair in profile.windows(2) {
        let ([a, near], [b, far]) = (pair[0], pair[1]);
        for k in 0..sides as usize {
            let (left, middle, right) =
                (spokes[2 * k], spokes[2 * k + 1], spokes[(2 * k + 2) % spokes.len()]);
            let outward = middle * (b - a) + along * (near - far);
            let at = |place: f64, spoke: DVec3, radius: f64| from + along * place + spoke * radius;
            if near > 0.0 {
                sink.face(&[at(a, left, near), at(a, right, near), at(b, right, far)], outward);
            }
            if far > 0.0 {
                sink.face(&[at(a, left, near), at(b, right, far), at(b, left, far)], outward);
            }
        }
    }
}

/// Two unit vectors across `along` and across each other.
pub(super) fn across(along: DVec3) -> (DVec3, DVec3) {
    let other = if along.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    let u = along.cross(other).normalize();
    (u, along.cross(u))
}

/// The profile of a cylinder with flat ends.
pub(super) fn drum(length: f64, radius: f64, rows: u32) -> Vec<Station> {
    let mut profile = vec![[0.0, 0.0]];
    profile.extend((0..=rows).map(|k| [length * f64::from(k) / f64::from(rows), radius]));
    profile.push([length, 0.0]);
    profile
}

/// The profile of a body with round ends: `cells` stations a dome, as many along the middle, if there is one.
pub(super) fn capsule(length: f64, radius: f64, dome: f64, cells: u32) -> Vec<Station> {
    let arc = |k: u32| circle(k, 4 * cells);
    let mut profile: Vec<Station> =
        (0..=cells).map(arc).map(|(c, s)| [dome * (1.0 - c), radius * s]).collect();
    profile[0][1] = 0.0;
    let straight = length > 2.0 * dome;
    if straight {
        profile.extend(
            (1..cells).map(|k| [dome + (length - 2.0 * dome) * f64::from(k) / f64::from(cells), radius]),
        );
    }
    profile.extend(
        (0..cells + u32::from(straight)).rev().map(arc).map(|(c, s)| [length - dome * (1.0 - c), radius * s]),
    );
    if let Some(last) = profile.last_mut() {
        last[1] = 0.0;
    }
    profile
}

/// Columns and rows of a grid of about this many triangles, with `ratio` rows a column.
pub(super) fn grid(triangles: u64, ratio: f64) -> (u32, u32) {
    let columns = ((triangles as f64 / (2.0 * ratio)).sqrt() as u32).max(3);
    (columns, ((triangles as f64 / f64::from(2 * columns) + 0.5) as u32).max(3))
}

/// The surface of `point(i, j)` for `i` up to `columns` and `j` up to `rows`; each cell turns away from
/// `inside(i, j)`. Triangles without area, where points of the grid fall together, are left out.
pub(super) fn sheet(
    sink: &mut Sink,
    (columns, rows): (u32, u32),
    point: impl Fn(u32, u32) -> DVec3,
    inside: impl Fn(u32, u32) -> DVec3,
) {
    let column = |i: u32| -> Vec<DVec3> { (0..=rows).map(|j| point(i, j)).collect() };
    let mut left = column(0);
    for i in 0..columns {
        let right = column(i + 1);
        for j in 0..rows {
            let k = j as usize;
            let quad = [left[k], right[k], right[k + 1], left[k + 1]];
            let outward = (quad[0] + quad[2]) * 0.5 - inside(i, j);
            for triangle in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                if triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0] {
                    sink.face(&triangle, outward);
                }
            }
        }
        left = right;
    }
}

/// A closed body along a curve in the plane of local x and y, mirrored at that plane. A stop of the curve is
/// where it is, half the body's extent across the curve in the plane, and half that out of it, m.
pub(super) fn sweep(sink: &mut Sink, frame: &Frame, stops: &[DVec4], (around, rows): (u32, u32)) {
    let at = |t: f64| spline(stops.len(), |k| stops[k], t);
    let center = |j: u32| {
        let here = at(f64::from(j) / f64::from(rows));
        frame.at([here.x, here.y, 0.0])
    };
    let point = |i: u32, j: u32| {
        if j == 0 || j == rows {
            return center(j);
        }
        let (t, step) = (f64::from(j) / f64::from(rows), 0.5 / f64::from(rows));
        let (here, ahead) = (at(t), at(t + step) - at(t - step));
        let across = (frame.right * -ahead.y + DVec3::Y * ahead.x).normalize();
        let (c, s) = circle(i % around, around);
        center(j) + across * (here.z * c) + frame.away * (here.w * s)
    };
    sheet(sink, (around, rows), point, |_, j| (center(j) + center(j + 1)) * 0.5);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume enclosed by what a sink keeps: right only if every triangle looks outward.
    fn volume(shape: impl Fn(&mut Sink)) -> f64 {
        let mut sink = Sink::keeping(&[("m", [1.0; 3])]);
        sink.begin(|| ("a".into(), "b".into()));
        shape(&mut sink);
        let mesh = sink.into_mesh();
        mesh.corners
            .chunks(3)
            .map(|c| [0, 1, 2].map(|k| mesh.points[c[k] as usize]))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum()
    }

    #[test]
    fn bodies_of_revolution_enclose_their_volume() {
        let (from, along) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, -1.0, 2.0) / 3.0);
        let pi = std::f64::consts::PI;
        let cylinder = volume(|s| lathe(s, from, along, &drum(2.0, 0.5, 3), 256));
        assert!((cylinder - pi * 0.5).abs() < 1e-3, "{cylinder}");
        let ball = volume(|s| lathe(s, from, along, &capsule(2.0, 1.0, 1.0, 64), 256));
        assert!((ball - 4.0 / 3.0 * pi).abs() < 3e-3, "{ball}");
        let tank = volume(|s| lathe(s, from, DVec3::Y, &capsule(3.0, 1.0, 1.0, 64), 256));
        assert!((tank - 7.0 / 3.0 * pi).abs() < 3e-3, "{tank}");
    }

    #[test]
    fn a_body_along_a_curve_encloses_its_volume() {
        let frame = Frame { origin: DVec3::new(1.0, 2.0, 3.0), right: -DVec3::Z, away: DVec3::X };
        // A quarter of a turn: by Pappus the area of the ellipse times the length of the way of its center,
        // less what cones lack in the rows at its ends, two thirds, which are no longer than others.
        let (inner, outer, rows) = (0.2, 0.3, 400);
        let stops: Vec<DVec4> = (0..=64)
            .map(|k| circle(k, 256))
            .map(|(c, s)| DVec4::new(2.0 * c, 2.0 * s, inner, outer))
            .collect();
        let got = volume(|sink| sweep(sink, &frame, &stops, (256, rows)));
        let pi = std::f64::consts::PI;
        let whole = pi * inner * outer * pi;
        let least = whole * (1.0 - 4.0 / 3.0 / f64::from(rows));
        assert!(got > least && got < whole, "{got} instead of {least} to {whole}");
    }

    #[test]
    fn a_sheet_leaves_out_triangles_without_area() {
        let mut sink = Sink::counting();
        let point = |i: u32, j: u32| {
            let ((c, s), (up, out)) = (circle(i % 6, 6), circle(j, 8));
            DVec3::new(out * c, up, if j.is_multiple_of(4) { 0.0 } else { out * s })
        };
        sheet(
            &mut sink,
            (6, 4),
            |i, j| if j.is_multiple_of(4) { DVec3::Y * (2.0 - f64::from(j)) } else { point(i, j) },
            |_, _| DVec3::ZERO,
        );
        assert_eq!(sink.triangles, 6 * 4 * 2 - 2 * 6);
    }
}
