//! A chart as a value: series of numbers with what they mean. `measure` makes them, `figure` puts them on
//! paper.

use super::Role;

/// One row of bars or one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What it is, for the legend.
    pub label: String,
    /// How it is painted. What was measured has a solid role, what is quoted a dashed or hatched one.
    pub role: Role,
    /// Places and values; among bars the place is the number of the group.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A series.
    pub fn new(label: impl Into<String>, role: Role, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), role, points }
    }
}

/// How the values of a chart are shown.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A group of bars for each name. The axis begins at zero.
    Bars {
        /// Names of the groups; a line break in them is kept.
        groups: Vec<String>,
        /// Whether the bars of a group stand on each other.
        stacked: bool,
    },
    /// Lines through points.
    Lines {
        /// Whether equal steps along x are equal factors.
        logarithmic: bool,
        /// The places along x that are labeled; empty: round ones.
        ticks: Vec<f64>,
    },
    /// Lines through points, with equal steps along both axes equal factors: powers are straight.
    Powers,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Above it; may be empty.
    pub title: String,
    /// What x is, with its unit; may be empty among bars.
    pub x_label: String,
    /// What y is, with its unit.
    pub y_label: String,
    /// How it is shown.
    pub shape: Shape,
    /// The numbers.
    pub series: Vec<Series>,
}

/// A configuration in a chart of speed against error.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Its number, by which a click finds it.
    pub number: u32,
    /// 0: none at all.
    pub error: f64,
    /// Milliseconds.
    pub time_ms: f64,
    /// Between which times it varied.
    pub spread_ms: [f64; 2],
    /// Error and time of single frames.
    pub frames: Vec<(f64, f64)>,
}

/// Configurations of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The method.
    pub label: String,
    /// How it is painted.
    pub role: Role,
    /// By ascending error.
    pub tried: Vec<Tried>,
    /// Whether they are one row of values of a parameter, so that a line through them says something.
    pub is_row: bool,
}

/// Speed against error: a curve for each method, and the configurations that nothing beats in both.
#[derive(Clone, Debug, PartialEq)]
pub struct Tradeoff {
    /// Above it.
    pub title: String,
    /// What the error is, with its unit.
    pub error_label: String,
    /// The methods.
    pub curves: Vec<Curve>,
}

impl Tradeoff {
    /// The Pareto front: numbers of those configurations than which no other is as fast and as right and
    /// better in one of the two; by ascending error.
    pub fn front(&self) -> Vec<u32> {
        let mut all: Vec<&Tried> = self.curves.iter().flat_map(|c| &c.tried).collect();
        all.sort_by(|a, b| {
            (a.error, a.time_ms, a.number)
                .partial_cmp(&(b.error, b.time_ms, b.number))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let mut least = f64::INFINITY;
        let mut front: Vec<&Tried> = Vec::new();
        for one in all {
            let is_equal = front.last().is_some_and(|l| (l.error, l.time_ms) == (one.error, one.time_ms));
            if one.time_ms < least || is_equal {
                least = one.time_ms;
                front.push(one);
            }
        }
        front.into_iter().map(|one| one.number).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_on_the_front_is_beaten() {
        let tried = |number, error, time_ms| Tried {
            number,
            error,
            time_ms,
            spread_ms: [time_ms; 2],
            frames: Vec::new(),
        };
        let curve = |tried| Curve { label: String::new(), role: Role::Visible, tried, is_row: true };
        let exact = curve(vec![tried(0, 0.0, 4.0), tried(1, 0.0, 9.0)]);
        let rough =
            curve(vec![tried(2, 0.1, 5.0), tried(3, 0.2, 2.0), tried(4, 0.2, 2.0), tried(5, 9.0, 1.0)]);
        let tradeoff =
            Tradeoff { title: String::new(), error_label: String::new(), curves: vec![rough, exact] };
        assert_eq!(tradeoff.front(), [0, 3, 4, 5]);
    }
}
