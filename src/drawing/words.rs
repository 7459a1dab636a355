//! Numbers and names as a person reads them.

/// How much room a number has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Room {
    /// In a sentence or beside a mark: a power of ten from 100,000, with one decimal.
    Sentence,
    /// In a row of its own: a power of ten from 1,000,000, with two decimals.
    Row,
}

/// A number with as many digits as a person reads; below 0.001 it has a power of ten.
pub fn short(v: f32, room: Room) -> String {
    let (most, decimals) = match room {
        Room::Sentence => (1e5, 1),
        Room::Row => (1e6, 2),
    };
    match v.abs() {
        0.0 => "0".into(),
        a if !(1e-3..most).contains(&a) => format!("{v:.decimals$e}"),
        a if a < 1.0 => format!("{v:.3}"),
        a if a < 100.0 => format!("{v:.2}"),
        _ => format!("{v:.0}"),
    }
}

/// A number with its thousands apart.
pub fn grouped(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let (sign, text) = text.strip_prefix('-').map_or(("", text.as_str()), |t| ("−", t));
    let (whole, rest) = text.split_once('.').map_or((text, String::new()), |(w, r)| (w, format!(".{r}")));
    let mut out = String::from(sign);
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out + &rest
}

/// A count with its thousands apart.
pub fn count(n: usize) -> String {
    grouped(n as f64, 0)
}

/// `NodeClassified` as `node classified`.
pub fn spaced(kind: &str) -> String {
    let mut text = String::new();
    for c in kind.chars() {
        if c.is_uppercase() && !text.is_empty() {
            text.push(' ');
        }
        text.extend(c.to_lowercase());
    }
    text
}

/// With a capital letter.
pub fn capitalized(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_by_thousands() {
        assert_eq!((grouped(-1234567.891, 2), grouped(999.0, 0)), ("−1,234,567.89".into(), "999".into()));
        assert_eq!((count(0), count(1000)), ("0".into(), "1,000".into()));
    }

    #[test]
    fn a_number_is_as_long_as_its_room() {
        assert_eq!(
            (short(123_456.7, Room::Sentence), short(123_456.7, Room::Row)),
            ("1.2e5".into(), "123457".into())
        );
        assert_eq!(
            (short(-2.5e-4, Room::Sentence), short(-2.5e-4, Room::Row)),
            ("-2.5e-4".into(), "-2.50e-4".into())
        );
        assert_eq!(short(0.5, Room::Row), "0.500");
    }

    #[test]
    fn kinds_become_words() {
        assert_eq!(
            (spaced("NodeClassified"), capitalized("node 3")),
            ("node classified".into(), "Node 3".into())
        );
    }
}
