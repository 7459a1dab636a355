//! Scale bars and axes with round numbers.

use glam::{Vec2, vec2};

use crate::drawing::{Anchor, Drawing, Layer, Mark, Role, Subject, metrics};

/// The largest of 1, 2 and 5 times a power of ten that is not above `x`; 1 where there is none.
pub fn round_below(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    // One decade lower than the logarithm says, in case it was rounded up.
    let mut best = 10f64.powi(x.log10().floor() as i32 - 1);
    for (digit, power) in [(2.0, 0), (5.0, 0), (1.0, 1), (2.0, 1), (5.0, 1), (1.0, 2)] {
        let decade = 10f64.powi(x.log10().floor() as i32 - 1 + power);
        if digit * decade <= x * (1.0 + 1e-12) {
            best = digit * decade;
        }
    }
    best
}

/// At most `most` round numbers from `low` to `high`, both included where they are round.
pub fn ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    if !(low.is_finite() && high.is_finite() && low < high && most > 0) {
        return Vec::new();
    }
    let mut step = round_below((high - low) / most as f64);
    loop {
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        if last - first < most as f64 {
            let count = (last - first).max(-1.0) as i64 + 1;
            return (0..count).map(|i| (first + i as f64) * step).collect();
        }
        step = round_below(step * 2.6);
    }
}

/// A number as a label of a scale with that step: only the decimals that the step needs, and a true minus.
pub fn tick_label(value: f64, step: f64) -> String {
    let magnitude = value.abs().max(step.abs());
    if magnitude >= 1e6 || (magnitude > 0.0 && magnitude < 1e-4) {
        return format!("{value:.1e}").replace('-', "−");
    }
    let decimals = (-step.abs().log10()).ceil().clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    let is_zero = text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") }
}

/// A power of ten: a plain number near 1, else with a raised exponent.
fn power_label(exponent: i32) -> String {
    if (-2..=3).contains(&exponent) {
        return tick_label(10f64.powi(exponent), 10f64.powi(exponent));
    }
    let digits = exponent.to_string();
    let raised = digits.chars().map(|c| match c {
        '-' => '⁻',
        d => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d.to_digit(10).unwrap_or(0) as usize],
    });
    format!("10{}", raised.collect::<String>())
}

/// Draws a bar of a round length with its label above it, its left end at `at`, no longer than `most_pt`;
/// returns the rectangle that it takes.
pub fn scale_bar(to: &mut Drawing, at: Vec2, pt_per_unit: f32, most_pt: f32, unit: &str) -> [Vec2; 2] {
    const SIZE_PT: f32 = 7.0;
    const TICK_PT: f32 = 2.5;
    let length = round_below(f64::from(most_pt) / f64::from(pt_per_unit));
    let end = at + vec2((length * f64::from(pt_per_unit)) as f32, 0.0);
    to.line(Layer::Labels, Role::Ink, Subject::None, [at, end]);
    for p in [at, end] {
        to.line(Layer::Labels, Role::Ink, Subject::None, [p - vec2(0.0, TICK_PT), p + vec2(0.0, TICK_PT)]);
    }
    let label = format!("{} {unit}", tick_label(length, length));
    let middle = (at + end) / 2.0 - vec2(0.0, TICK_PT + 2.0);
    let [a, b] =
        metrics::text_box(middle, label.trim_end(), crate::drawing::Font::Regular, SIZE_PT, Anchor::Middle);
    to.text(Layer::Labels, Role::Ink, middle, SIZE_PT, Anchor::Middle, label.trim_end());
    [a.min(at - vec2(0.0, TICK_PT)), b.max(end + vec2(0.0, TICK_PT))]
}

/// One axis of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it measures, with its unit.
    pub label: String,
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// Whether equal steps are equal factors; both ends must then be positive.
    pub logarithmic: bool,
}

impl Axis {
    /// An axis that takes in all values, its ends round; an axis from 0 to 1 if there are none.
    pub fn of(label: impl Into<String>, values: impl IntoIterator<Item = f64>, logarithmic: bool) -> Self {
        let usable = |x: &f64| x.is_finite() && (!logarithmic || *x > 0.0);
        let (low, high) = values
            .into_iter()
            .filter(usable)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let label = label.into();
        if low > high {
            return Self { label, low: if logarithmic { 0.1 } else { 0.0 }, high: 1.0, logarithmic };
        }
        if logarithmic {
            let (low, high) = (10f64.powf(low.log10().floor()), 10f64.powf(high.log10().ceil()));
            return Self { label, low, high: if high > low { high } else { low * 10.0 }, logarithmic };
        }
        // Counts and times start at zero where that does not squeeze them.
        let low = if low > 0.0 && low < 0.6 * high { 0.0 } else { low };
        let span = if high > low { high - low } else { high.abs().max(1.0) };
        let step = round_below(span / 4.0);
        let (low, up) = ((low / step).floor() * step, (high / step).ceil() * step);
        Self { label, low, high: if up > low { up } else { low + span }, logarithmic }
    }

    /// An axis of equal factors that takes in all positive values, its ends 1, 2 or 5 times a power of ten
    /// and at least a factor of 10 apart.
    pub fn tight(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().filter(|x| x.is_finite() && *x > 0.0).collect();
        let mut axis = Self::of(label, values.iter().copied(), true);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(0.0, f64::max);
        let steps: Vec<f64> = axis.steps();
        axis.low = steps.iter().rev().copied().find(|s| *s <= least).unwrap_or(axis.low);
        let far = most.max(axis.low * 10.0 / (1.0 + 1e-9));
        axis.high = steps.iter().copied().find(|s| *s >= far).unwrap_or(axis.low * 10.0);
        axis
    }
    /// 1, 2 and 5 times the powers of ten between the ends of an axis of equal factors, and one beyond.
    fn steps(&self) -> Vec<f64> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        (first..=last).flat_map(|e| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(e))).collect()
    }

    /// Where a value lies between the ends: 0 to 1; outside of that where it is not on the axis.
    pub fn place(&self, value: f64) -> f32 {
        let f = |x: f64| if self.logarithmic { x.max(1e-300).log10() } else { x };
        ((f(value) - f(self.low)) / (f(self.high) - f(self.low))) as f32
    }

    /// The values with a label, and their labels.
    pub fn marks(&self, most: usize) -> Vec<(f64, String)> {
        if !self.logarithmic {
            let at = ticks(self.low, self.high, most);
            let step = if at.len() > 1 { at[1] - at[0] } else { self.high - self.low };
            return at.into_iter().map(|x| (x, tick_label(x, step))).collect();
        }
        let is_whole = |x: f64| (x.log10() - x.log10().round()).abs() < 1e-6;
        if !(is_whole(self.low) && is_whole(self.high)) {
            let inside = |x: &f64| *x >= self.low * (1.0 - 1e-9) && *x <= self.high * (1.0 + 1e-9);
            // Over several powers these alone are even.
            let is_far = self.high >= self.low * 99.0;
            let fits = |x: &f64| inside(x) && (!is_far || is_whole(*x));
            let all: Vec<f64> = self.steps().into_iter().filter(fits).collect();
            let every = all.len().div_ceil(most.max(1)).max(1);
            return all.into_iter().step_by(every).map(|x| (x, tick_label(x, x))).collect();
        }
        let (first, last) = (self.low.log10().round() as i32, self.high.log10().round() as i32);
        let every = ((last - first) as usize / most.max(1) + 1) as i32;
        (first..=last).filter(|e| (e - first) % every == 0).map(|e| (10f64.powi(e), power_label(e))).collect()
    }
}

/// Draws the frame, grid and labels of a chart and returns the rectangle of its data; `min` and `max` are the
/// corners of all that it takes.
pub fn axes(to: &mut Drawing, x: &Axis, y: &Axis, min: Vec2, max: Vec2) -> [Vec2; 2] {
    let marks: Vec<(f32, String)> =
        x.marks(6).into_iter().map(|(value, text)| (x.place(value), text)).collect();
    axes_with(to, &marks, &x.label, true, y, [min, max])
}

/// Size of the labels of axes.
const SIZE_PT: f32 = 7.0;

/// As [`axes`], with these marks along x: place from 0 to 1 and label, of several lines if there are line
/// breaks in it; `grid`: with a line up from each.
pub fn axes_with(
    to: &mut Drawing,
    x_marks: &[(f32, String)],
    x_label: &str,
    grid: bool,
    y: &Axis,
    [min, max]: [Vec2; 2],
) -> [Vec2; 2] {
    let y_marks = y.marks(6);
    let widest = y_marks
        .iter()
        .map(|(_, text)| metrics::width_pt(text, crate::drawing::Font::Regular, SIZE_PT))
        .fold(0.0, f32::max);
    let lines = x_marks.iter().map(|(_, text)| text.split('\n').count()).max().unwrap_or(1);
    let below =
        SIZE_PT * (1.8 + 1.2 * (lines as f32 - 1.0)) + if x_label.is_empty() { 0.0 } else { SIZE_PT * 1.2 };
    // The label of the y axis stands above it, so that no text is turned.
    let inner = [min + vec2(widest + 4.0, SIZE_PT * 2.0), max - vec2(SIZE_PT * 1.5, below)];
    let size = (inner[1] - inner[0]).max(Vec2::ONE);
    let at = |u: f32, v: f32| vec2(inner[0].x + u * size.x, inner[1].y - v * size.y);
    for (place, text) in x_marks {
        let p = at(*place, 0.0);
        if grid {
            to.line(Layer::Ground, Role::Faint, Subject::None, [p, vec2(p.x, inner[0].y)]);
        }
        for (i, line) in text.split('\n').enumerate() {
            to.text(
                Layer::Labels,
                Role::Ink,
                p + vec2(0.0, SIZE_PT * 1.2 * (i as f32 + 1.0)),
                SIZE_PT,
                Anchor::Middle,
                line,
            );
        }
    }
    for (value, text) in &y_marks {
        let p = at(0.0, y.place(*value));
        to.line(Layer::Ground, Role::Faint, Subject::None, [p, vec2(inner[1].x, p.y)]);
        to.text(Layer::Labels, Role::Ink, p + vec2(-3.0, SIZE_PT * 0.36), SIZE_PT, Anchor::End, text.clone());
    }
    let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    to.push(Layer::Ground, Role::Ink, Subject::None, Mark::Line { points: corners.to_vec(), closed: true });
    if !x_label.is_empty() {
        to.text(
            Layer::Labels,
            Role::Ink,
            vec2(inner[1].x, max.y - SIZE_PT * 0.4),
            SIZE_PT,
            Anchor::End,
            x_label,
        );
    }
    to.text(Layer::Labels, Role::Ink, vec2(min.x, min.y + SIZE_PT), SIZE_PT, Anchor::Start, y.label.clone());
    inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers_are_round() {
        for (x, below) in [
            (1.0, 1.0),
            (1.99, 1.0),
            (2.0, 2.0),
            (4.9, 2.0),
            (5.0, 5.0),
            (9.99, 5.0),
            (0.07, 0.05),
            (1234.0, 1000.0),
            (1e-9, 1e-9),
        ] {
            let got = round_below(x);
            assert!((got / below - 1.0).abs() < 1e-9, "{x}: {got}");
        }
        assert_eq!(round_below(f64::NAN), 1.0);
        for i in 1..2000 {
            let x = 1.013f64.powi(i - 1000);
            let r = round_below(x);
            assert!(r <= x * 1.000_001 && x < r * 2.51, "{x}: {r}");
        }
    }

    #[test]
    fn ticks_are_few_and_inside() {
        assert_eq!(ticks(0.0, 10.0, 6), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        for (low, high) in [(0.0, 1.0), (-3.7, 12.2), (1e6, 1.000_01e6), (-1e-3, 1e-3), (99.0, 101.0)] {
            for most in 2..12 {
                let t = ticks(low, high, most);
                assert!(t.len() <= most && t.len() * 6 >= most, "{low}..{high}: {t:?} of {most}");
                assert!(t.iter().all(|x| *x >= low - 1e-9 && *x <= high * (1.0 + 1e-9) + 1e-9));
            }
        }
        assert!(
            ticks(1.0, 1.0, 5).is_empty()
                && ticks(f64::NAN, 1.0, 5).is_empty()
                && ticks(0.0, 1.0, 0).is_empty()
        );
    }

    /// The ends are near the values, and some values between them have labels.
    #[test]
    fn tight_axes_waste_no_room() {
        for values in [vec![0.3, 0.8], vec![3.1, 47.0], vec![1.0, 10.0], vec![0.02, 900.0], vec![5.0], vec![]]
        {
            let axis = Axis::tight("t", values.iter().copied());
            assert!(
                values.iter().all(|v| (-1e-6..=1.0 + 1e-6).contains(&axis.place(*v))),
                "{values:?} {axis:?}"
            );
            let marks = axis.marks(6);
            assert!((2..=7).contains(&marks.len()), "{values:?} {marks:?}");
            let (least, most) = (axis.low * 2.6, axis.high / 2.6);
            let is_wide = axis.high > axis.low * 10.1;
            assert!(!is_wide || values.iter().any(|v| *v <= least) && values.iter().any(|v| *v >= most));
        }
    }

    #[test]
    fn labels_have_the_decimals_they_need() {
        assert_eq!(tick_label(0.30000000000000004, 0.1), "0.3");
        assert_eq!(tick_label(-2.5, 0.5), "−2.5");
        assert_eq!(tick_label(-1e-12, 0.5), "0.0");
        assert_eq!(tick_label(200.0, 50.0), "200");
        assert_eq!(tick_label(2e7, 1e7), "2.0e7");
    }

    #[test]
    fn axes_take_in_their_values() {
        let axis = Axis::of("ms", [3.0, 47.0, f64::NAN], false);
        assert_eq!((axis.low, axis.high), (0.0, 50.0));
        assert_eq!(axis.place(25.0), 0.5);
        let log = Axis::of("s", [0.02, 3.0, 0.0], true);
        assert!((log.low - 0.01).abs() < 1e-9 && (log.high - 10.0).abs() < 1e-9);
        assert_eq!(log.marks(6).len(), 4);
        let far = Axis::of("s", [1e-9, 1e12], true).marks(5);
        assert!(far.len() <= 5 && far[0].1 == "10⁻⁹", "{far:?}");
        for empty in [
            Axis::of("", [], false),
            Axis::of("", [], true),
            Axis::of("", [7.0], false),
            Axis::of("", [10.0], true),
            Axis::of("", [0.0; 2], false),
        ] {
            assert!(empty.low < empty.high, "{empty:?}");
            assert!(!empty.marks(5).is_empty());
        }
    }

    #[test]
    fn a_scale_bar_is_no_longer_than_it_may_be() {
        for i in 1..200 {
            let mut d = Drawing::default();
            let [min, max] = scale_bar(&mut d, vec2(10.0, 20.0), 1.09f32.powi(i - 100), 80.0, "m");
            let Mark::Line { points, .. } = &d.items[0].mark else { panic!("a bar") };
            let length = points[1].x - points[0].x;
            assert!(length <= 80.01 && length > 31.0, "{length}");
            assert!(min.cmple(points[0]).all() && max.cmpge(points[1]).all());
        }
    }
}
