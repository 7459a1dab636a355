//! Charts on a page: bars and lines, side by side, with legend and caption.
//!
//! The axis of bars begins at zero. Points in 1/72 inch, y down.

use glam::{Vec2, vec2};

use super::axis::{Axis, axes_with};
use super::page::{Entry, Page, Paper, Swatch};
use crate::drawing::{Anchor, Drawing, Font, Layer, Mark, Plot, Role, Series, Shape, Subject, metrics};

/// Width of the charts together: two columns, inside the margins of a page.
const WIDTH_PT: f32 = 490.0;
/// Height of one.
const HEIGHT_PT: f32 = 190.0;
/// Between two beside or above each other.
const GAP_PT: f32 = 8.0;
/// The most beside each other.
const COLUMNS: usize = 3;
/// Size of a chart's title and of the numbers at bars.
const TITLE_PT: f32 = 8.0;
const NUMBER_PT: f32 = 6.5;
/// The part of its group that bars fill, and the widest that one is.
const FILLED: f32 = 0.76;
const WIDEST_PT: f32 = 34.0;
/// Radius of the points of lines, and of one that stands alone.
const DOT_PT: f32 = 1.8;
const ALONE_PT: f32 = 3.0;
/// A line through more points than this has no dots: they would hide it.
const DOTS: usize = 40;

/// Charts on a page over two columns; the legend names each series once.
pub fn chart(title: &str, plots: &[Plot], caption: &str) -> Drawing {
    let (content, legend) = charts(plots);
    Page {
        paper: Paper::TwoColumns,
        title: title.to_owned(),
        legend,
        caption: caption.to_owned(),
        ..Page::default()
    }
    .compose(&content)
}

/// Charts beside and above each other, for a page over two columns, and their legend.
pub fn charts(plots: &[Plot]) -> (Drawing, Vec<Entry>) {
    let columns = plots.len().clamp(1, COLUMNS);
    let rows = plots.len().div_ceil(columns).max(1);
    let width = (WIDTH_PT - GAP_PT * (columns as f32 - 1.0)) / columns as f32;
    let mut content = Drawing {
        size_pt: vec2(WIDTH_PT, rows as f32 * (HEIGHT_PT + GAP_PT) - GAP_PT),
        ..Drawing::default()
    };
    let mut legend: Vec<Entry> = Vec::new();
    for (i, plot) in plots.iter().enumerate() {
        let min = vec2((i % columns) as f32 * (width + GAP_PT), (i / columns) as f32 * (HEIGHT_PT + GAP_PT));
        draw(&mut content, plot, [min, min + vec2(width, HEIGHT_PT)]);
        for series in plot.series.iter().filter(|s| !s.points.is_empty()) {
            let swatch = match plot.shape {
                Shape::Bars { .. } => Swatch::Area,
                _ if series.points.len() > 1 => Swatch::Line,
                _ => Swatch::Dot,
            };
            let entry = Entry { role: series.role, label: series.label.clone(), swatch };
            if !legend.contains(&entry) {
                legend.push(entry);
            }
        }
    }
    (content, legend)
}

fn draw(to: &mut Drawing, plot: &Plot, [mut min, max]: [Vec2; 2]) {
    if !plot.title.is_empty() {
        let text = metrics::elide(&plot.title, Font::Bold, TITLE_PT, max.x - min.x);
        let mark = Mark::Text {
            at: min + vec2(0.0, TITLE_PT),
            text,
            size_pt: TITLE_PT,
            anchor: Anchor::Start,
            font: Font::Bold,
        };
        to.push(Layer::Labels, Role::Ink, Subject::None, mark);
        min.y += TITLE_PT * 1.6;
    }
    match &plot.shape {
        Shape::Bars { groups, stacked } => bars(to, plot, groups, *stacked, [min, max]),
        Shape::Lines { logarithmic, ticks } => {
            let y = Axis::of(plot.y_label.clone(), values(plot).map(|p| p.1).chain([0.0]), false);
            lines(to, plot, &places(plot, *logarithmic, ticks), &y, ticks, [min, max]);
        }
        Shape::Powers => {
            let x = Axis::of(plot.x_label.clone(), values(plot).map(|p| p.0), true);
            let y = Axis::of(plot.y_label.clone(), values(plot).map(|p| p.1), true);
            lines(to, plot, &x, &y, &[], [min, max]);
        }
    }
}

/// The value of a series in a group.
fn value(series: &Series, group: usize) -> Option<f64> {
    series.points.iter().find(|p| p.0 == group as f64).map(|p| p.1).filter(|v| v.is_finite())
}

fn bars(to: &mut Drawing, plot: &Plot, groups: &[String], stacked: bool, place: [Vec2; 2]) {
    let in_group = |g: usize| plot.series.iter().filter_map(move |s| Some((s.role, value(s, g)?)));
    let height = |g: usize| {
        if stacked { in_group(g).map(|b| b.1).sum() } else { in_group(g).map(|b| b.1).fold(0.0, f64::max) }
    };
    // A tenth above the highest, for its number.
    let y = Axis::of(plot.y_label.clone(), (0..groups.len()).map(|g| height(g) * 1.1).chain([0.0]), false);
    let n = groups.len().max(1) as f32;
    let marks: Vec<(f32, String)> =
        groups.iter().enumerate().map(|(g, name)| ((g as f32 + 0.5) / n, name.clone())).collect();
    let [low, high] = axes_with(to, &marks, &plot.x_label, false, &y, place);
    let group = (high.x - low.x) / n;
    let up = |value: f64| high.y - y.place(value) * (high.y - low.y);
    for g in 0..groups.len() {
        let all: Vec<(Role, f64)> = in_group(g).collect();
        let beside = if stacked { 1 } else { all.len().max(1) } as f32;
        let width = (group * FILLED / beside).min(WIDEST_PT);
        let left = low.x + group * (g as f32 + 0.5) - width * beside / 2.0;
        let mut base = 0.0;
        for (i, (role, value)) in all.iter().enumerate() {
            let x = if stacked { left } else { left + width * i as f32 };
            let corners = [
                vec2(x, up(base)),
                vec2(x + width, up(base)),
                vec2(x + width, up(base + value)),
                vec2(x, up(base + value)),
            ];
            // The grid does not shine through.
            to.push(Layer::Areas, Role::Paper, Subject::None, Mark::Area(corners.to_vec()));
            to.push(Layer::Areas, *role, Subject::None, Mark::Area(corners.to_vec()));
            if stacked {
                base += value;
            }
            if !stacked || i + 1 == all.len() {
                let top = if stacked { base } else { *value };
                to.text(
                    Layer::Labels,
                    Role::Ink,
                    vec2(x + width / 2.0, up(top) - 2.5),
                    NUMBER_PT,
                    Anchor::Middle,
                    short(top),
                );
            }
        }
    }
}

/// A number at a bar: three digits, or its whole part.
fn short(value: f64) -> String {
    let decimals = if value == 0.0 || value >= 99.95 {
        0
    } else {
        (2.0 - value.log10().floor()).clamp(0.0, 6.0) as usize
    };
    format!("{value:.decimals$}")
}

/// The points of all series.
fn values(plot: &Plot) -> impl Iterator<Item = &(f64, f64)> {
    plot.series.iter().flat_map(|s| &s.points)
}

/// Whether a value has a place on an axis.
fn is_on(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (!axis.logarithmic || value > 0.0)
}

/// The axis along x of a chart of lines.
fn places(plot: &Plot, logarithmic: bool, ticks: &[f64]) -> Axis {
    let usable = |x: &f64| x.is_finite() && (!logarithmic || *x > 0.0);
    let xs = || values(plot).map(|p| p.0).chain(ticks.iter().copied()).filter(usable);
    let mut x = Axis::of(plot.x_label.clone(), xs().chain((!logarithmic).then_some(0.0)), logarithmic);
    if logarithmic && xs().count() > 1 {
        // The ends of the values and not whole powers of ten; a little air, so that no point lies on the
        // frame.
        (x.low, x.high) = (xs().fold(f64::INFINITY, f64::min) / 1.15, xs().fold(0.0, f64::max) * 1.15);
    }
    x
}

fn lines(to: &mut Drawing, plot: &Plot, x: &Axis, y: &Axis, ticks: &[f64], place: [Vec2; 2]) {
    let marks: Vec<(f32, String)> = if ticks.is_empty() {
        x.marks(6).into_iter().map(|(value, text)| (x.place(value), text)).collect()
    } else {
        ticks.iter().map(|t| (x.place(*t), t.to_string())).collect()
    };
    let [low, high] = axes_with(to, &marks, &plot.x_label, true, y, place);
    let at = |p: &(f64, f64)| {
        vec2(low.x + x.place(p.0) * (high.x - low.x), high.y - y.place(p.1) * (high.y - low.y))
    };
    for series in &plot.series {
        let points: Vec<Vec2> =
            series.points.iter().filter(|p| is_on(x, p.0) && is_on(y, p.1)).map(at).collect();
        let radius_pt = if points.len() > 1 { DOT_PT } else { ALONE_PT };
        if points.len() > 1 {
            to.line(Layer::Evidence, series.role, Subject::None, points.clone());
        }
        for at in points.iter().copied().filter(|_| points.len() <= DOTS) {
            to.push(Layer::Emphasis, series.role, Subject::None, Mark::Dot { at, radius_pt });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(stacked: bool) -> Plot {
        Plot {
            title: "a title".into(),
            x_label: String::new(),
            y_label: "time, ms".into(),
            shape: Shape::Bars { groups: vec!["one\nscene".into(), "two".into()], stacked },
            series: vec![
                Series::new("a", Role::Visible, vec![(0.0, 30.0), (1.0, 20.0)]),
                Series::new("b", Role::Hidden, vec![(0.0, 10.0)]),
            ],
        }
    }

    /// Heights of the bars of a role, from left to right, and where they stand.
    fn heights(drawing: &Drawing, role: Role) -> Vec<(f32, f32)> {
        let bars = drawing.items.iter().filter(|i| i.role == role && i.layer == Layer::Areas);
        bars.filter_map(|i| if let Mark::Area(p) = &i.mark { Some((p[0].y - p[2].y, p[0].y)) } else { None })
            .collect()
    }

    #[test]
    fn bars_are_as_high_as_their_values_and_begin_at_zero() {
        for stacked in [false, true] {
            let drawing = chart("t", &[sample(stacked)], "c");
            let (a, b) = (heights(&drawing, Role::Visible), heights(&drawing, Role::Hidden));
            assert!(
                (a[0].0 / a[1].0 - 1.5).abs() < 1e-3 && (a[0].0 / b[0].0 - 3.0).abs() < 1e-3,
                "{a:?} {b:?}"
            );
            assert_eq!(a[0].1, a[1].1, "all begin at zero");
            let want = if stacked { a[0].1 - a[0].0 } else { a[0].1 };
            assert!((b[0].1 - want).abs() < 1e-3);
        }
        let zero = heights(&chart("t", &[sample(false)], "c"), Role::Visible)[0];
        // The zero of the axis, whose label is the lowest of its numbers.
        let labels = chart("t", &[sample(false)], "c").items.into_iter();
        let at = labels.filter_map(|i| match i.mark {
            Mark::Text { at, text, .. } if text == "0" => Some(at.y),
            _ => None,
        });
        assert!(at.into_iter().all(|y| (y - zero.1).abs() < 4.0));
    }

    /// A power is a straight line, and what has no logarithm is left out.
    #[test]
    fn powers_are_straight() {
        let points = vec![(10.0, 2.0), (1e3, 20.0), (1e7, 2000.0), (1e4, 0.0), (0.0, 5.0)];
        let series = vec![Series::new("a", Role::Visible, points)];
        let plot = Plot { shape: Shape::Powers, x_label: "n".into(), series, ..sample(false) };
        let items = chart("t", &[plot], "c").items.into_iter();
        let dots = items.filter_map(|i| match i.mark {
            Mark::Dot { at, .. } if i.layer == Layer::Emphasis => Some(at),
            _ => None,
        });
        let at: Vec<Vec2> = dots.collect();
        assert_eq!(at.len(), 3);
        let slope = |a: Vec2, b: Vec2| (b.y - a.y) / (b.x - a.x);
        assert!((slope(at[0], at[1]) - slope(at[1], at[2])).abs() < 1e-4 && at[2].y < at[1].y, "{at:?}");
        assert!(((at[2].x - at[1].x) / (at[1].x - at[0].x) - 2.0).abs() < 1e-3, "{at:?}");
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [0.0, 0.123_45, 2.6, 36.94, 134.2, 99.96].map(short),
            ["0", "0.123", "2.60", "36.9", "134", "100"]
        );
    }

    #[test]
    fn nothing_sticks_out_and_the_legend_names_each_once() {
        let lines = Plot {
            shape: Shape::Lines { logarithmic: true, ticks: vec![0.25, 1.0, 16.0] },
            x_label: "speed".into(),
            series: vec![
                Series::new("a", Role::Visible, vec![(0.25, 3.0), (16.0, 9.0)]),
                Series::new("alone", Role::Hidden, vec![(1.0, f64::NAN), (0.0, 1.0)]),
            ],
            ..sample(false)
        };
        let empty = Plot {
            series: Vec::new(),
            shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
            ..sample(false)
        };
        let drawing = chart("t", &[sample(false), sample(true), lines, empty], "A caption.");
        let inside = |p: &Vec2| {
            p.is_finite() && p.cmpge(Vec2::splat(-0.01)).all() && p.cmple(drawing.size_pt + 0.01).all()
        };
        for item in &drawing.items {
            match &item.mark {
                Mark::Line { points, .. } | Mark::Area(points) => {
                    assert!(points.iter().all(inside), "{item:?}")
                }
                Mark::Text { at, text, size_pt, anchor, font } => {
                    assert!(
                        metrics::text_box(*at, text, *font, *size_pt, *anchor).iter().all(inside),
                        "{text}"
                    );
                }
                Mark::Dot { at, .. } => assert!(inside(at)),
                _ => {}
            }
        }
        let texts = |word: &str| {
            drawing
                .items
                .iter()
                .filter(|i| matches!(&i.mark, Mark::Text { text, .. } if text == word))
                .count()
        };
        assert_eq!((texts("b"), texts("alone")), (1, 1));
    }
}
