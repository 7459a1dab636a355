//! Objects of a wanted number of triangles to stand in rows: a knot, a bumpy ball, a vase, a twisted column.

use glam::DVec3;

use super::lathe::{grid, lathe, sheet};
use super::shapes::{Sink, circle};

/// How many kinds there are.
pub(super) const KINDS: u32 = 4;

/// A sculpture of about this many triangles inside the ball around `center`.
pub(super) fn sculpture(sink: &mut Sink, center: DVec3, radius: f64, kind: u32, triangles: u64) {
    match kind % KINDS {
        0 => knot(sink, center, radius, triangles),
        1 => bumps(sink, center, radius, triangles),
        2 => vase(sink, center, radius, triangles),
        _ => twist(sink, center, radius, triangles),
    }
}

/// The cosine and sine of `turns` whole turns' part `k/n`.
fn part(k: u32, turns: u32, n: u32) -> (f64, f64) {
    circle((u64::from(k) * u64::from(turns) % u64::from(n)) as u32, n)
}

fn knot(sink: &mut Sink, center: DVec3, radius: f64, triangles: u64) {
    let (around, along) = grid(triangles, 9.0);
    let on_curve = |k: u32| {
        let ((c2, s2), (c3, s3)) = (part(k, 2, along), part(k, 3, along));
        (DVec3::new((2.0 + c3) * c2, s3, (2.0 + c3) * s2), DVec3::new(2.0 * c2, 0.0, 2.0 * s2))
    };
    let scale = radius / 3.5;
    let point = |i: u32, j: u32| {
        let (here, ring) = on_curve(j % along);
        let ahead = (on_curve((j + 1) % along).0 - on_curve((j + along - 1) % along).0).normalize();
        let side = ahead.cross(here - ring).normalize();
        let (c, s) = circle(i % around, around);
        center + (here + (side * c + side.cross(ahead) * s) * 0.45) * scale
    };
    sheet(sink, (around, along), point, |_, j| {
        center + (on_curve(j).0 + on_curve((j + 1) % along).0) * (0.5 * scale)
    });
}

/// The columns and rows of a ball-like grid whose first and last row are points.
fn ball_grid(triangles: u64, ratio: f64) -> (u32, u32) {
    let (columns, rows) = grid(triangles, ratio);
    (columns, rows + 1)
}

fn bumps(sink: &mut Sink, center: DVec3, radius: f64, triangles: u64) {
    let (around, rows) = ball_grid(triangles, 0.5);
    let point = |i: u32, j: u32| {
        let (up, out) =
            if j == 0 || j == rows { (1.0 - 2.0 * f64::from(j / rows), 0.0) } else { circle(j, 2 * rows) };
        let (c, s) = circle(i % around, around);
        let bump = 0.8 + 0.2 * part(i % around, 6, around).0 * part(j, 5, 2 * rows).0 * out;
        center + DVec3::new(out * c, up, out * s) * (radius * bump)
    };
    sheet(sink, (around, rows), point, |_, _| center);
}

fn vase(sink: &mut Sink, center: DVec3, radius: f64, triangles: u64) {
    let (sides, rows) = ball_grid(triangles, 0.8);
    let profile: Vec<[f64; 2]> = (0..=rows)
        .map(|k| {
            let wave = part(k, 5, 4 * rows).1;
            let open = if k == 0 || k == rows { 0.0 } else { radius * (0.42 + 0.22 * wave) };
            // The first and last rows are the flat ends.
            [2.0 * radius * f64::from(k.clamp(1, rows - 1) - 1) / f64::from(rows - 2), open]
        })
        .collect();
    lathe(sink, center - DVec3::Y * radius, DVec3::Y, &profile, sides);
}

fn twist(sink: &mut Sink, center: DVec3, radius: f64, triangles: u64) {
    let (around, rows) = ball_grid(triangles, 0.8);
    let height = |j: u32| {
        DVec3::Y * (radius * (2.0 * f64::from(j.clamp(1, rows - 1) - 1) / f64::from(rows - 2) - 1.0))
    };
    let point = |i: u32, j: u32| {
        if j == 0 || j == rows {
            return center + height(j);
        }
        let (c, s) = circle(i % around, around);
        let turned = (u64::from(i % around) * 5 * u64::from(2 * rows) + u64::from(j) * u64::from(around))
            % u64::from(around * 2 * rows);
        let wave = circle(turned as u32, around * 2 * rows).0;
        center + height(j) + DVec3::new(c, 0.0, s) * (radius * (0.5 + 0.12 * wave))
    };
    // The flat ends turn away from the middle of the column, its side from its axis.
    let inside = |_: u32, j: u32| {
        if j == 0 || j + 1 == rows { center } else { center + (height(j) + height(j + 1)) * 0.5 }
    };
    sheet(sink, (around, rows), point, inside);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_the_triangles_asked_for_and_looks_outward() {
        for kind in 0..KINDS {
            for want in [1_000u64, 5_000, 20_000] {
                let mut sink = Sink::keeping(&[("m", [1.0; 3])]);
                sink.begin(|| ("a".into(), "b".into()));
                let center = DVec3::new(3.0, 2.0, -1.0);
                sculpture(&mut sink, center, 1.0, kind, want);
                assert!(
                    sink.triangles.abs_diff(want) * 100 <= want * 4,
                    "kind {kind}: {} instead of {want}",
                    sink.triangles
                );
                let mesh = sink.into_mesh();
                let triangles =
                    || mesh.corners.chunks(3).map(|c| [0, 1, 2].map(|k| mesh.points[c[k] as usize] - center));
                let volume: f64 = triangles().map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
                let unsigned: f64 = triangles().map(|[a, b, c]| (a.dot(b.cross(c)) / 6.0).abs()).sum();
                // A knot's cone from the center folds over itself; all others are stars.
                let least = if kind == 0 { 0.05 } else { 0.9 };
                assert!(volume > least * unsigned && volume > 0.1, "kind {kind}: {volume} of {unsigned}");
                assert!(mesh.points.iter().all(|p| p.distance(center) < 1.3), "kind {kind}");
            }
        }
    }
}
