//! Charts of speed against error: time up, error to the right, both as powers of ten; what is exact stands in
//! a band of its own at the left, each method on its own line there, so that none hides another.
//!
//! Points in 1/72 inch, y down.

use glam::{Vec2, vec2};

use super::axis::{Axis, axes_with};
use super::page::{Entry, Page, Paper, Swatch};
use crate::drawing::{Anchor, Curve, Drawing, Font, Layer, Mark, Role, Subject, Tradeoff, Tried, metrics};

/// Width of a page's charts, height of one, and what is between two.
const WIDTH_PT: f32 = 490.0;
const HEIGHT_PT: f32 = 210.0;
const GAP_PT: f32 = 10.0;
const TITLE_PT: f32 = 8.0;
const LABEL_PT: f32 = 6.5;
const DOT_PT: f32 = 2.2;
const FRAME_PT: f32 = 0.8;
/// Radius of the ring about what is on the front.
const RING_PT: f32 = 3.8;
/// The share of the width that the band of what is exact has.
const EXACT: f32 = 0.24;

/// Where the values of a chart are: the rectangle of its data, and its axes.
struct Field {
    corners: [Vec2; 2],
    error: Axis,
    time: Axis,
    /// Methods of the chart.
    methods: usize,
}

impl Field {
    /// Where an error of a method lies along the width, 0 to 1.
    fn across(&self, method: usize, error: f64) -> f32 {
        if error <= 0.0 {
            EXACT * (method as f32 + 1.0) / (self.methods as f32 + 1.0)
        } else {
            EXACT + self.error.place(error) * (1.0 - EXACT)
        }
    }
    fn at(&self, method: usize, error: f64, time_ms: f64) -> Vec2 {
        let [low, high] = self.corners;
        let up = self.time.place(time_ms).clamp(0.0, 1.0);
        vec2(low.x + self.across(method, error) * (high.x - low.x), high.y - up * (high.y - low.y))
    }
}

/// Charts on a page over two columns, with a legend and what is to be known for reading them.
pub fn tradeoffs(title: &str, charts: &[Tradeoff], caption: &str) -> Drawing {
    let (content, legend) = tradeoff_charts(charts);
    Page {
        paper: Paper::TwoColumns,
        title: title.to_owned(),
        legend,
        caption: caption.to_owned(),
        ..Page::default()
    }
    .compose(&content)
}

/// The charts by themselves, two beside each other, and their legend.
pub fn tradeoff_charts(charts: &[Tradeoff]) -> (Drawing, Vec<Entry>) {
    let columns = charts.len().clamp(1, 2);
    let rows = charts.len().div_ceil(columns).max(1);
    let width = (WIDTH_PT - GAP_PT * (columns as f32 - 1.0)) / columns as f32;
    let size_pt = vec2(WIDTH_PT, rows as f32 * (HEIGHT_PT + GAP_PT) - GAP_PT);
    let mut content = Drawing { size_pt, ..Drawing::default() };
    let mut legend: Vec<Entry> = Vec::new();
    for (k, chart) in charts.iter().enumerate() {
        let place =
            vec2((k % columns) as f32 * (width + GAP_PT), (k / columns) as f32 * (HEIGHT_PT + GAP_PT));
        tradeoff(&mut content, chart, [place, place + vec2(width, HEIGHT_PT)]);
        for curve in &chart.curves {
            let swatch = if curve.is_row && curve.tried.len() > 1 { Swatch::Line } else { Swatch::Dot };
            let entry = Entry { role: curve.role, label: curve.label.clone(), swatch };
            // A line says more than a dot.
            match legend.iter_mut().find(|known| known.label == entry.label) {
                Some(known) if swatch == Swatch::Line => *known = entry,
                Some(_) => {}
                None => legend.push(entry),
            }
        }
    }
    (content, legend)
}

/// One chart between two corners. Each configuration is a mark with its number.
pub fn tradeoff(to: &mut Drawing, chart: &Tradeoff, [mut min, max]: [Vec2; 2]) {
    let text = metrics::elide(&chart.title, Font::Bold, TITLE_PT, max.x - min.x);
    let (at, anchor, font) = (min + vec2(0.0, TITLE_PT), Anchor::Start, Font::Bold);
    to.push(
        Layer::Labels,
        Role::Ink,
        Subject::None,
        Mark::Text { at, text, size_pt: TITLE_PT, anchor, font },
    );
    min.y += TITLE_PT * 1.6;
    let field = field(to, chart, [min, max]);
    for (method, curve) in chart.curves.iter().enumerate() {
        for &(error, time) in curve.tried.iter().flat_map(|one| &one.frames) {
            let at = field.at(method, error, time);
            to.push(Layer::Areas, Role::Faint, Subject::None, Mark::Dot { at, radius_pt: FRAME_PT });
        }
    }
    front(to, chart, &field);
    for (method, curve) in chart.curves.iter().enumerate() {
        marks(to, method, curve, &field);
    }
    names(to, chart, &field);
}

/// The axes. Errors begin at the power of ten below the least one that is not 0.
fn field(to: &mut Drawing, chart: &Tradeoff, place: [Vec2; 2]) -> Field {
    let tried = || chart.curves.iter().flat_map(|curve| &curve.tried);
    let all = |one: &Tried| one.frames.iter().map(|f| f.1).chain(one.spread_ms).collect::<Vec<_>>();
    let time = Axis::tight("time of a frame, ms", tried().flat_map(all));
    let errors = tried().flat_map(|one| one.frames.iter().map(|f| f.0).chain([one.error]));
    let error = Axis::of(chart.error_label.clone(), errors, true);
    let mut field = Field { corners: [Vec2::ZERO; 2], error, time, methods: chart.curves.len() };
    let powers = field.error.marks(5).into_iter().map(|(value, text)| (field.across(0, value), text));
    let marks: Vec<_> = std::iter::once((EXACT * 0.5, "exact".to_owned())).chain(powers).collect();
    field.corners = axes_with(to, &marks, &chart.error_label, true, &field.time, place);
    let [low, high] = field.corners;
    let x = low.x + EXACT * (high.x - low.x);
    to.line(Layer::Ground, Role::Ink, Subject::None, [vec2(x, low.y), vec2(x, high.y)]);
    field
}

/// The front as steps: what is to the right of it and above is beaten.
fn front(to: &mut Drawing, chart: &Tradeoff, field: &Field) {
    let front = chart.front();
    let curves = chart.curves.iter().enumerate();
    let all = curves.flat_map(|(method, curve)| curve.tried.iter().map(move |one| (method, one)));
    let mut on: Vec<(usize, &Tried)> = all.filter(|(_, one)| front.contains(&one.number)).collect();
    on.sort_by(|a, b| a.1.error.total_cmp(&b.1.error));
    let places: Vec<Vec2> =
        on.iter().map(|&(method, one)| field.at(method, one.error, one.time_ms)).collect();
    let mut steps = Vec::new();
    for at in &places {
        if let Some(last) = steps.last().copied() {
            let last: Vec2 = last;
            steps.push(vec2(at.x, last.y));
        }
        steps.push(*at);
    }
    if let Some(last) = steps.last().copied() {
        steps.push(vec2(field.corners[1].x, last.y));
        to.line(Layer::Areas, Role::Outside, Subject::None, steps);
    }
    for at in places {
        to.push(Layer::Scene, Role::Ink, Subject::None, Mark::Dot { at, radius_pt: RING_PT });
        to.push(Layer::Scene, Role::Paper, Subject::None, Mark::Dot { at, radius_pt: RING_PT - 0.7 });
    }
}

fn marks(to: &mut Drawing, method: usize, curve: &Curve, field: &Field) {
    let place = |one: &Tried| field.at(method, one.error, one.time_ms);
    let places: Vec<Vec2> = curve.tried.iter().map(place).collect();
    if curve.is_row {
        to.line(Layer::Evidence, curve.role, Subject::None, places.clone());
    }
    for (one, at) in curve.tried.iter().zip(places) {
        let bar = one.spread_ms.map(|ms| field.at(method, one.error, ms));
        to.line(Layer::Evidence, curve.role, Subject::None, bar);
        let subject = Subject::Tried(one.number);
        to.push(Layer::Emphasis, curve.role, subject, Mark::Dot { at, radius_pt: DOT_PT });
    }
}

/// Each method's name beside its fastest configuration, moved up or down where another name stands.
fn names(to: &mut Drawing, chart: &Tradeoff, field: &Field) {
    let mut labels: Vec<(Vec2, &Curve)> = Vec::new();
    for (method, curve) in chart.curves.iter().enumerate() {
        let fastest = curve.tried.iter().min_by(|a, b| a.time_ms.total_cmp(&b.time_ms));
        labels.extend(fastest.map(|one| (field.at(method, one.error, one.time_ms), curve)));
    }
    labels.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
    let mut taken: Vec<[Vec2; 2]> = Vec::new();
    let [low, high] = field.corners;
    for (at, curve) in labels {
        let width = metrics::width_pt(&curve.label, Font::Regular, LABEL_PT);
        let fits = at.x + RING_PT + 2.0 + width < high.x;
        let (anchor, dx) = if fits { (Anchor::Start, RING_PT + 2.0) } else { (Anchor::End, -RING_PT - 2.0) };
        // Nearest first, below before above.
        let steps = (0..24)
            .map(|k: i32| f32::from(k as i16 + 1).div_euclid(2.0) * if k % 2 == 0 { 1.0 } else { -1.0 });
        let places = steps.map(|k| at + vec2(dx, LABEL_PT * 0.35 + k * (LABEL_PT + 1.0)));
        let boxed = |p: Vec2| metrics::text_box(p, &curve.label, Font::Regular, LABEL_PT, anchor);
        let is_free = |p: &Vec2| {
            let [a, b] = boxed(*p);
            let inside = a.y > low.y && b.y < high.y;
            inside && taken.iter().all(|[c, d]| b.x < c.x || d.x < a.x || b.y < c.y || d.y < a.y)
        };
        let Some(place) = places.into_iter().find(is_free) else { continue };
        taken.push(boxed(place));
        to.text(Layer::Labels, curve.role, place, LABEL_PT, anchor, curve.label.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(number: u32, error: f64, time_ms: f64) -> Tried {
        let spread_ms = [time_ms * 0.9, time_ms * 1.2];
        Tried {
            number,
            error,
            time_ms,
            spread_ms,
            frames: vec![(error * 0.5, time_ms), (error * 2.0, time_ms)],
        }
    }

    fn sample() -> Tradeoff {
        let curve = |label: &str, role, tried| Curve { label: label.into(), role, tried, is_row: true };
        Tradeoff {
            title: "a scene".into(),
            error_label: "wrong pixels, %".into(),
            curves: vec![
                curve("all", Role::Ink, vec![tried(0, 0.0, 20.0)]),
                curve("exact", Role::Visible, vec![tried(1, 0.0, 5.0)]),
                curve("rough", Role::Hidden, vec![tried(2, 0.01, 4.0), tried(3, 1.0, 1.0)]),
            ],
        }
    }

    fn places(drawing: &Drawing) -> Vec<(u32, Vec2)> {
        let of = |item: &crate::drawing::Item<Vec2>| match (item.subject, &item.mark) {
            (Subject::Tried(number), Mark::Dot { at, .. }) => Some((number, *at)),
            _ => None,
        };
        let mut all: Vec<_> = drawing.items.iter().filter_map(of).collect();
        all.sort_by_key(|(number, _)| *number);
        all
    }

    /// What is exact stands left of all else; a factor of ten is the same length everywhere.
    #[test]
    fn exact_ones_stand_in_the_band_of_no_error() {
        let (drawing, legend) = tradeoff_charts(&[sample()]);
        let at: Vec<Vec2> = places(&drawing).into_iter().map(|(_, at)| at).collect();
        assert_eq!(at.len(), 4);
        assert!(at[0].x < at[1].x && at[1].x < at[2].x && at[2].x < at[3].x);
        let band = drawing.items.iter().find_map(|item| match &item.mark {
            Mark::Line { points, closed: false } if item.role == Role::Ink && item.layer == Layer::Ground => {
                Some(points[0].x)
            }
            _ => None,
        });
        assert!(band.is_some_and(|x| at[1].x < x && x < at[2].x), "{band:?}");
        assert!(at[0].y < at[1].y && at[1].y < at[2].y && at[2].y < at[3].y, "slower is higher");
        let per_power = (at[3].x - at[2].x) / 2.0;
        let field = drawing.size_pt.x * 0.9 / 4.0;
        assert!(per_power > field * 0.5 && per_power < field * 1.5, "{per_power}");
        let seconds = [(at[1].y - at[0].y) / 4f32.log10(), (at[3].y - at[2].y) / 4f32.log10()];
        assert!((seconds[0] - seconds[1]).abs() < 0.1, "{seconds:?}");
        assert_eq!(legend.len(), 3);
    }

    #[test]
    fn nothing_sticks_out_and_no_name_lies_on_another() {
        let mut crowd = sample();
        for k in 0..6 {
            let tried = vec![tried(10 + k, 0.0, 5.0)];
            let label = format!("another {k}");
            crowd.curves.push(Curve { label, role: Role::Wrong, tried, is_row: false });
        }
        let empty = Tradeoff { curves: Vec::new(), ..sample() };
        let drawing = tradeoffs("t", &[crowd, sample(), empty], "A caption.");
        let mut names: Vec<[Vec2; 2]> = Vec::new();
        for item in &drawing.items {
            let inside = |p: Vec2| {
                p.is_finite() && p.cmpge(Vec2::splat(-0.01)).all() && p.cmple(drawing.size_pt + 0.01).all()
            };
            match &item.mark {
                Mark::Line { points, .. } => assert!(points.iter().all(|p| inside(*p)), "{item:?}"),
                Mark::Dot { at, .. } => assert!(inside(*at), "{item:?}"),
                Mark::Text { at, text, size_pt, anchor, font } => {
                    let [a, b] = metrics::text_box(*at, text, *font, *size_pt, *anchor);
                    assert!(inside(a) && inside(b), "{text}");
                    if text.starts_with("another") && item.layer == Layer::Labels {
                        let apart = |[c, d]: &[Vec2; 2]| b.x < c.x || d.x < a.x || b.y < c.y || d.y < a.y;
                        assert!(names.iter().all(apart), "{text}");
                        names.push([a, b]);
                    }
                }
                _ => {}
            }
        }
        assert_eq!(names.len(), 6);
    }
}
