//! From 64-bit coordinates to 32: what is subtracted first, and what rounding costs.

use glam::{DVec3, Vec3};

use super::mesh::Mesh;
use super::report::counted;
use super::{Progress, Recenter};

/// Greatest magnitude of a coordinate, world units: a product of three of them still fits 32 bits.
pub const MAX_COORDINATE: f64 = 1e12;

/// What to subtract: nothing, unless 32-bit coordinates would lose detail. `None` when cancelled.
///
/// A model whose middle is farther away than [`FAR`] times its extent goes to the origin as a whole. Else, if
/// there are faces that rounding spoils, the middle of the bounds and the median of the faces are tried (the
/// median is where most of a model is that has a marker or another site far off), and what spoils the fewest
/// is taken if that saves more than one face in [`WORTH`]. Rounded, so that short decimals stay short.
pub(super) fn choose_origin(mesh: &Mesh, recenter: Recenter, progress: &dyn Progress) -> Option<DVec3> {
    /// At 16 extents from the origin, 4 of the 24 bits of a coordinate are spent on the distance.
    const FAR: f64 = 16.0;
    const WORTH: usize = 100;
    if recenter == Recenter::Never {
        return Some(DVec3::ZERO);
    }
    let usable = mesh.points.iter().filter(|p| p.abs().max_element() <= MAX_COORDINATE);
    let (low, high) = usable.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (center, extent) = ((low + high) * 0.5, (high - low).max_element());
    if !center.is_finite() || extent <= 0.0 {
        return Some(DVec3::ZERO);
    }
    let middle = on_grid(center, extent);
    if recenter == Recenter::Always || center.abs().max_element() > FAR * extent {
        return Some(middle);
    }
    let lost = spoiled(mesh, DVec3::ZERO, progress)?;
    if lost * WORTH < mesh.faces.len() || lost == 0 {
        return Some(DVec3::ZERO);
    }
    let mut best = (lost, DVec3::ZERO);
    for origin in [middle, median(mesh)] {
        let count = spoiled(mesh, origin, progress)?;
        if count < best.0 {
            best = (count, origin);
        }
    }
    let saved = lost - best.0;
    Some(if saved > 0 && saved * WORTH >= mesh.faces.len() { best.1 } else { DVec3::ZERO })
}

/// A point on a grid as wide as the power of two at or below `width`: the exponent bits alone.
fn on_grid(point: DVec3, width: f64) -> DVec3 {
    let grid = f64::from_bits(width.to_bits() & 0x7ff0_0000_0000_0000);
    let point = (point / grid).round() * grid;
    if point.is_finite() { point } else { DVec3::ZERO }
}

/// The median of the faces' first corners, an axis at a time; on a grid of 64 extents of the face next to it.
fn median(mesh: &Mesh) -> DVec3 {
    let at = |c: u32| mesh.points[c as usize];
    let firsts = mesh.rings().filter_map(|ring| ring.first().map(|c| at(*c)));
    let mut firsts: Vec<DVec3> = firsts.filter(|p| p.abs().max_element() <= MAX_COORDINATE).collect();
    if firsts.is_empty() {
        return DVec3::ZERO;
    }
    let half = firsts.len() / 2;
    let middle = DVec3::from_array([0, 1, 2].map(|axis| {
        firsts.select_nth_unstable_by(half, |a, b| a[axis].total_cmp(&b[axis]));
        firsts[half][axis]
    }));
    let near = mesh
        .rings()
        .filter(|ring| !ring.is_empty())
        .min_by(|a, b| {
            let distance = |ring: &[u32]| at(ring[0]).distance_squared(middle);
            distance(a).total_cmp(&distance(b))
        })
        .unwrap_or_default();
    let extent = near.iter().map(|c| (at(*c) - at(near[0])).abs().max_element()).fold(0.0, f64::max);
    if extent > 0.0 { on_grid(middle, 64.0 * extent) } else { middle }
}

/// How many faces rounding to 32 bits relative to `origin` spoils. `None` when cancelled.
pub(super) fn spoiled(mesh: &Mesh, origin: DVec3, progress: &dyn Progress) -> Option<usize> {
    let mut count = 0;
    for (k, ring) in mesh.rings().enumerate() {
        if k % 65_536 == 0 && progress.cancelled() {
            return None;
        }
        count += usize::from(is_spoiled(ring, |c| mesh.points[c as usize] - origin));
    }
    Some(count)
}

/// Whether the vector area of a polygon changes by more than an eighth when its corners are rounded to 32
/// bits.
fn is_spoiled(ring: &[u32], place: impl Fn(u32) -> DVec3) -> bool {
    let &[first, second, _, ..] = ring else { return false };
    let (start, rounded) = (place(first), place(first).as_vec3().as_dvec3());
    let sides = |c: u32| (place(c) - start, place(c).as_vec3().as_dvec3() - rounded);
    let mut before = sides(second);
    let (mut exact, mut found) = (DVec3::ZERO, DVec3::ZERO);
    for &corner in &ring[2..] {
        let next = sides(corner);
        exact += before.0.cross(next.0);
        found += before.1.cross(next.1);
        before = next;
    }
    64.0 * (found - exact).length_squared() > exact.length_squared()
}

/// What rounding costs, in words.
pub(super) fn price(points: &[DVec3], origin: DVec3, spoiled: usize, lost: usize) -> String {
    let usable = points.iter().map(|p| *p - origin).filter(|p| p.abs().max_element() <= MAX_COORDINATE);
    let shift = |p: DVec3| (p.as_vec3().as_dvec3() - p).abs().max_element();
    let greatest = usable.map(shift).fold(0.0, f64::max);
    // One digit that is not zero.
    let digits = (-greatest.max(1e-30).log10()).ceil().max(0.0) as usize;
    format!(
        "rounding to 32 bits moves points by up to {greatest:.digits$} units; that changes the area of {} by \
         more than an eighth, and takes {}",
        counted(spoiled, "face"),
        counted(lost, "triangle")
    )
}

/// 32-bit points, and which of them may be used. `+ 0.0` turns −0 into 0, so that equal points have equal
/// bits.
pub(super) fn round(points: &[DVec3], origin: DVec3) -> (Vec<Vec3>, Vec<bool>) {
    let rounded = points.iter().map(|p| {
        let p = *p - origin;
        let usable = p.abs().max_element() <= MAX_COORDINATE && p.is_finite();
        (if usable { p.as_vec3() + Vec3::ZERO } else { Vec3::ZERO }, usable)
    });
    rounded.unzip()
}
