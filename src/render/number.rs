//! Numbers in SVG text and path data.

/// A number with at most two decimals, without trailing zeros and without a negative zero.
pub(super) fn number(x: f32) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        for (x, text) in
            [(0.0, "0"), (-0.001, "0"), (1.5, "1.5"), (100.0, "100"), (-2.345, "-2.35"), (1e6, "1000000")]
        {
            assert_eq!(number(x), text);
        }
    }
}
