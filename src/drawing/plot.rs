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
