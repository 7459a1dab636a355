//! The circle, the same bits on every machine: sines of system libraries differ in their last bits.

/// Cosine and sine of `k/n` of a turn, by a series: the same bits on every machine.
pub(super) fn circle(k: u32, n: u32) -> (f64, f64) {
    // Quarters apart, so that the series runs over at most an eighth of a turn on either side.
    let quarters = (u64::from(k) * 8 / u64::from(n)).div_ceil(2);
    let angle = std::f64::consts::TAU * (f64::from(k) / f64::from(n) - quarters as f64 * 0.25);
    let square = angle * angle;
    let (mut cos, mut sin, mut term) = (1.0, 1.0, 1.0);
    // cos = Σ (−x²)^i/(2i)!, sin/x = Σ (−x²)^i/(2i+1)!; at an eighth of a turn the last is below 1e-17.
    for i in 1..10 {
        let even = f64::from(2 * i);
        term *= -square / ((even - 1.0) * even);
        cos += term;
        sin += term / (even + 1.0);
    }
    let (cos, sin) = (cos, sin * angle);
    match quarters % 4 {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_circle() {
        for n in [3, 4, 8, 12, 60, 97] {
            for k in 0..n {
                let (c, s) = circle(k, n);
                let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
                assert!(
                    (c - angle.cos()).abs() < 1e-14 && (s - angle.sin()).abs() < 1e-14,
                    "{k}/{n}: {c} {s}"
                );
            }
        }
    }
}
