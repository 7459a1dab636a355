//! Tables and charts of a sweep, from its log alone.
//!
//! Of each frame the time is the median over the flights, with quartiles; of each configuration it is the
//! mean of its frames, and the spread goes from the fastest flight to the slowest. A configuration of which
//! a frame is missing is left out.

use std::collections::{BTreeMap, BTreeSet};

use super::log::{Judged, Log, Timed};
use super::spec::{Configuration, ErrorKind, Spec};
use crate::drawing::words::grouped;
use crate::drawing::{Curve, Role, Tradeoff, Tried};
use crate::measure::columns::column;
use crate::measure::table::{Cell, Column, Table};
use crate::measure::timing::quantile;

/// Roles of methods, in the order in which a spec names them: neighbors differ in hue and in dashes.
const ROLES: [Role; 10] = [
    Role::Ink,
    Role::Visible,
    Role::Hidden,
    Role::Eye,
    Role::Approximated,
    Role::Evidence,
    Role::FacesAway,
    Role::Partial,
    Role::Scene,
    Role::Undecided,
];

/// The role of the method that is named at a place.
pub fn role(at: usize) -> Role {
    ROLES[at % ROLES.len()]
}

/// Number of a configuration on a scene, among all of a spec.
fn number(spec: &Spec, scene: u32, configuration: u32) -> u32 {
    scene * spec.configurations.len() as u32 + configuration
}

/// The scene and the configuration with a number, as a chart has it.
pub fn of_number(spec: &Spec, number: u32) -> [usize; 2] {
    let count = spec.configurations.len().max(1);
    [number as usize / count, number as usize % count]
}

/// Median and quartiles.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_unstable_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|share| quantile(&values, share))
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

/// A configuration of which all frames are known.
struct Known<'a> {
    scene: u32,
    configuration: u32,
    judged: Vec<&'a Judged>,
    /// By frame, then by flight.
    timed: Vec<Vec<&'a Timed>>,
}

/// Of each configuration the frames that are judged and timed; `so_far`: if there is one, else if there are
/// all of them.
fn known<'a>(log: &'a Log, spec: &Spec, so_far: bool) -> Vec<Known<'a>> {
    let mut all = Vec::new();
    for scene in 0..spec.scenes.len() as u32 {
        for configuration in 0..spec.configurations.len() as u32 {
            let key = |frame, round| (scene, configuration, frame, round);
            let flights: Vec<u32> = (0..spec.repeats)
                .filter(|&r| so_far || log.is_timed(scene, configuration, spec.frames, r))
                .collect();
            let (mut judged, mut timed) = (Vec::new(), Vec::new());
            for frame in 0..spec.frames {
                let times: Vec<_> = flights.iter().filter_map(|&r| log.timed.get(&key(frame, r))).collect();
                let Some(one) = log.judged.get(&(scene, configuration, frame)) else { continue };
                if !times.is_empty() {
                    judged.push(one);
                    timed.push(times);
                }
            }
            let least = if so_far { 1 } else { spec.frames as usize };
            if judged.len() >= least && log.built.contains_key(&(scene, configuration)) {
                all.push(Known { scene, configuration, judged, timed });
            }
        }
    }
    all
}

impl Known<'_> {
    /// What tells it from others: number, scene, method, parameters.
    fn name(&self, log: &Log, spec: &Spec) -> [Cell; 4] {
        let one = &spec.configurations[self.configuration as usize];
        let params = one.label()[one.method.len()..].trim_start().to_owned();
        [
            (number(spec, self.scene, self.configuration) as usize).into(),
            scene_name(log, self.scene).as_str().into(),
            one.method.as_str().into(),
            params.as_str().into(),
        ]
    }
    fn mean(&self, of: impl Fn(&Judged) -> f64) -> f64 {
        mean(self.judged.iter().map(|judged| of(judged)))
    }
    fn sum(&self, of: impl Fn(&Judged) -> u64) -> u64 {
        self.judged.iter().map(|judged| of(judged)).sum()
    }
    /// Error of all frames together, per cent.
    fn error(&self, kind: ErrorKind) -> f64 {
        match kind {
            ErrorKind::WrongPixels => percent(self.sum(|j| j.wrong_pixels), self.sum(|j| j.pixels)),
            ErrorKind::Flip => 100.0 * self.mean(|j| j.flip),
            ErrorKind::Missed => percent(self.sum(|j| j.missed), self.sum(|j| j.visible)),
        }
    }
    /// Of each frame quartiles over the flights, of some time.
    fn frames(&self, of: impl Fn(&Timed) -> f64) -> Vec<[f64; 3]> {
        self.timed.iter().map(|flights| quartiles(flights.iter().map(|t| of(t)).collect())).collect()
    }
    /// The mean over frames of their medians.
    fn time(&self, of: impl Fn(&Timed) -> f64) -> f64 {
        mean(self.frames(of).iter().map(|q| q[1]))
    }
    /// The mean frame of the fastest flight, and of the slowest.
    fn spread(&self) -> [f64; 2] {
        let flights = self.timed.iter().map(Vec::len).min().unwrap_or(0);
        let of_flight = |r: usize| mean(self.timed.iter().map(|frame| whole(frame[r])));
        let means = (0..flights).map(of_flight);
        means.fold([f64::INFINITY, 0.0], |[low, high], ms| [low.min(ms), high.max(ms)])
    }
}

/// From the view to the image, milliseconds.
fn whole(timed: &Timed) -> f64 {
    timed.cull_ms + timed.draw_ms
}

fn percent(part: u64, all: u64) -> f64 {
    if all == 0 { 0.0 } else { 100.0 * part as f64 / all as f64 }
}

/// The error of a frame, per cent.
pub fn error_of(judged: &Judged, kind: ErrorKind) -> f64 {
    match kind {
        ErrorKind::WrongPixels => percent(judged.wrong_pixels, judged.pixels),
        ErrorKind::Flip => 100.0 * judged.flip,
        ErrorKind::Missed => percent(judged.missed, judged.visible),
    }
}

/// A scene's name; with its number of primitives where two have the same.
fn scene_name(log: &Log, scene: u32) -> String {
    let Some(seen) = log.scenes.get(&scene) else { return format!("scene {scene}") };
    let twins = log.scenes.values().filter(|other| other.name == seen.name);
    let paths = twins.clone().filter(|other| other.prims == seen.prims).count();
    match (twins.count(), paths) {
        (0 | 1, _) => seen.name.clone(),
        (_, 0 | 1) => format!("{}, {}", seen.name, grouped(seen.prims as f64, 0)),
        _ => format!("{}, {}, {}", seen.name, grouped(seen.prims as f64, 0), seen.path),
    }
}

const NUMBER: Column = column("number", "no.", "", 0);
const SCENE: Column = column("scene", "scene", "", 0);
const METHOD: Column = column("method", "method", "", 0);
const PARAMS: Column = column("parameters", "parameters", "", 0);

/// Keys of the columns whose numbers differ from run to run; all others repeat exactly.
pub const TIMES: &[&str] = &[
    "build_ms",
    "frame_ms",
    "fastest_ms",
    "slowest_ms",
    "cull_ms",
    "draw_ms",
    "on_front",
    "peak_bytes",
    "cull_ms_q1",
    "cull_ms_q3",
    "draw_ms_q1",
    "draw_ms_q3",
    "frame_ms_q1",
    "frame_ms_q3",
    "ms",
    "ms_q1",
    "ms_q3",
];

/// A row for each configuration of each scene.
pub fn configurations(log: &Log, spec: &Spec) -> Table {
    let mut table = Table::new(&[
        NUMBER,
        SCENE,
        METHOD,
        PARAMS,
        column("primitives", "primitives", "", 0),
        column("frames", "frames", "", 0),
        column("frame_ms", "frame", "ms", 3),
        column("fastest_ms", "fastest flight", "ms", 3),
        column("slowest_ms", "slowest", "ms", 3),
        column("cull_ms", "culling", "ms", 3),
        column("draw_ms", "drawing", "ms", 3),
        column("wrong_pixels_percent", "wrong pixels", "%", 4),
        column("flip_percent", "FLIP", "%", 4),
        column("missed_percent", "missed", "%", 4),
        column("missed", "missed", "", 0),
        column("visible", "visible", "a frame", 1),
        column("drawn", "drawn", "a frame", 1),
        column("stand_ins", "stand-ins", "a frame", 1),
        column("on_front", "on the front", "", 0),
        column("build_ms", "building", "ms", 1),
        column("index_bytes", "index", "bytes", 0),
        column("peak_bytes", "peak memory of the scene", "bytes", 0),
    ]);
    let fronts: Vec<u32> = charts(log, spec).iter().flat_map(Tradeoff::front).collect();
    for one in known(log, spec, false) {
        let [fastest, slowest] = one.spread();
        let (build_ms, bytes) = log.built[&(one.scene, one.configuration)];
        let mut row = one.name(log, spec).to_vec();
        let is_on = fronts.contains(&number(spec, one.scene, one.configuration));
        let peak = log.peak_bytes.get(&one.scene).map(|bytes| *bytes as f64);
        row.extend([
            log.scenes.get(&one.scene).map(|seen| seen.prims as f64).into(),
            one.judged.len().into(),
            one.time(whole).into(),
            fastest.into(),
            slowest.into(),
            one.time(|t| t.cull_ms).into(),
            one.time(|t| t.draw_ms).into(),
            one.error(ErrorKind::WrongPixels).into(),
            one.error(ErrorKind::Flip).into(),
            one.error(ErrorKind::Missed).into(),
            (one.sum(|j| j.missed) as f64).into(),
            one.mean(|j| j.visible as f64).into(),
            one.mean(|j| j.drawn as f64).into(),
            one.mean(|j| j.stand_ins as f64).into(),
            usize::from(is_on).into(),
            build_ms.into(),
            (bytes as f64).into(),
            peak.into(),
        ]);
        table.rows.push(row);
    }
    table
}

/// A row for each frame of each configuration.
pub fn frames(log: &Log, spec: &Spec) -> Table {
    let mut table = Table::new(&[
        NUMBER,
        SCENE,
        METHOD,
        PARAMS,
        column("frame", "frame", "", 0),
        column("cull_ms", "culling", "ms", 3),
        column("cull_ms_q1", "lower quartile", "ms", 3),
        column("cull_ms_q3", "upper quartile", "ms", 3),
        column("draw_ms", "drawing", "ms", 3),
        column("draw_ms_q1", "lower quartile", "ms", 3),
        column("draw_ms_q3", "upper quartile", "ms", 3),
        column("frame_ms", "frame", "ms", 3),
        column("frame_ms_q1", "lower quartile", "ms", 3),
        column("frame_ms_q3", "upper quartile", "ms", 3),
        column("drawn", "drawn", "", 0),
        column("stand_ins", "stand-ins", "", 0),
        column("visible", "visible", "", 0),
        column("missed", "missed", "", 0),
        column("wrong_pixels", "wrong pixels", "", 0),
        column("wrong_pixels_percent", "wrong pixels", "%", 4),
        column("flip_percent", "FLIP", "%", 4),
    ]);
    for one in known(log, spec, false) {
        let times = [one.frames(|t| t.cull_ms), one.frames(|t| t.draw_ms), one.frames(whole)];
        for (at, judged) in one.judged.iter().enumerate() {
            let mut row = one.name(log, spec).to_vec();
            row.push((judged.frame as usize).into());
            for of in &times {
                let [low, middle, high] = of[at];
                row.extend([middle, low, high].map(Cell::from));
            }
            let counts = [judged.drawn, judged.stand_ins, judged.visible, judged.missed, judged.wrong_pixels];
            row.extend(counts.map(|n| Cell::from(n as f64)));
            row.push(error_of(judged, ErrorKind::WrongPixels).into());
            row.push(error_of(judged, ErrorKind::Flip).into());
            table.rows.push(row);
        }
    }
    table
}

/// A row for each stage of culling of each configuration: quartiles over all frames and flights.
pub fn stages(log: &Log, spec: &Spec) -> Table {
    let mut table = Table::new(&[
        NUMBER,
        SCENE,
        METHOD,
        PARAMS,
        column("stage", "stage", "", 0),
        column("ms", "median", "ms", 4),
        column("ms_q1", "lower quartile", "ms", 4),
        column("ms_q3", "upper quartile", "ms", 4),
    ]);
    for one in known(log, spec, false) {
        let mut stages: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for timed in one.timed.iter().flatten() {
            for (name, ms) in &timed.stages_ms {
                stages.entry(name).or_default().push(*ms);
            }
        }
        for (name, all) in stages {
            let [low, middle, high] = quartiles(all);
            let mut row = one.name(log, spec).to_vec();
            row.extend([name.into(), middle.into(), low.into(), high.into()]);
            table.rows.push(row);
        }
    }
    table
}

/// A row for each of the method's own counts of each configuration, summed over the frames.
pub fn counts(log: &Log, spec: &Spec) -> Table {
    let mut table = Table::new(&[
        NUMBER,
        SCENE,
        METHOD,
        PARAMS,
        column("count", "count", "", 0),
        column("total", "all frames", "", 0),
        column("most", "most of a frame", "", 0),
    ]);
    for one in known(log, spec, false) {
        let mut all: BTreeMap<&str, [u64; 2]> = BTreeMap::new();
        for (name, n) in one.judged.iter().flat_map(|judged| &judged.counts) {
            let [sum, most] = all.entry(name).or_default();
            (*sum, *most) = (*sum + n, (*most).max(*n));
        }
        for (name, [sum, most]) in all {
            let mut row = one.name(log, spec).to_vec();
            row.extend([name.into(), (sum as f64).into(), (most as f64).into()]);
            table.rows.push(row);
        }
    }
    table
}

/// Whether configurations of a method differ in one parameter alone.
pub fn is_row<'a>(all: impl Iterator<Item = &'a Configuration>) -> bool {
    let all: Vec<_> = all.collect();
    let names: BTreeSet<&String> = all.iter().flat_map(|one| one.settings.0.keys()).collect();
    let differs =
        |name: &&&String| all.iter().any(|one| one.settings.0.get(**name) != all[0].settings.0.get(**name));
    names.iter().filter(differs).count() <= 1
}

/// A chart of speed against error for each scene.
pub fn charts(log: &Log, spec: &Spec) -> Vec<Tradeoff> {
    charted(&known(log, spec, false), log, spec)
}

/// The same of the frames that are known so far, while it is measured.
pub fn charts_so_far(log: &Log, spec: &Spec) -> Vec<Tradeoff> {
    charted(&known(log, spec, true), log, spec)
}

fn charted(known: &[Known<'_>], log: &Log, spec: &Spec) -> Vec<Tradeoff> {
    let methods: Vec<&str> = spec.configurations.iter().fold(Vec::new(), |mut all, one| {
        if !all.contains(&one.method.as_str()) {
            all.push(&one.method);
        }
        all
    });
    let of_scene = |scene: u32| {
        let mut curves: Vec<Curve> = methods
            .iter()
            .enumerate()
            .map(|(k, &method)| {
                let is_row = is_row(spec.configurations.iter().filter(|one| one.method == method));
                Curve { label: method.to_owned(), role: role(k), tried: Vec::new(), is_row }
            })
            .collect();
        for one in known.iter().filter(|one| one.scene == scene) {
            let method = &spec.configurations[one.configuration as usize].method;
            let times = one.frames(whole);
            let frames = one.judged.iter().zip(&times).map(|(j, q)| (error_of(j, spec.error), q[1]));
            let tried = Tried {
                number: number(spec, scene, one.configuration),
                error: one.error(spec.error),
                time_ms: one.time(whole),
                spread_ms: one.spread(),
                frames: frames.collect(),
            };
            curves.iter_mut().filter(|c| c.label == *method).for_each(|c| c.tried.push(tried.clone()));
        }
        curves.iter_mut().for_each(|c| c.tried.sort_by(|a, b| a.error.total_cmp(&b.error)));
        curves.retain(|c| !c.tried.is_empty());
        Tradeoff { title: scene_name(log, scene), error_label: spec.error.label().to_owned(), curves }
    };
    let all = (0..spec.scenes.len() as u32).map(of_scene);
    all.filter(|chart| !chart.curves.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Settings;

    /// A line through configurations says something where one parameter alone differs.
    #[test]
    fn a_row_differs_in_one_parameter() {
        let of = |pairs: &[(&str, &str)]| Configuration { method: "m".into(), settings: Settings::of(pairs) };
        let budgets = [of(&[]), of(&[("budget", "1%")]), of(&[("budget", "5%")])];
        assert!(is_row(budgets.iter()), "the default is a value as well");
        let fixed = [of(&[("cells", "a"), ("budget", "1%")]), of(&[("cells", "a"), ("budget", "5%")])];
        assert!(is_row(fixed.iter()) && is_row(fixed[..1].iter()) && is_row([].iter()));
        let star = [of(&[]), of(&[("budget", "1%")]), of(&[("cells", "a")])];
        assert!(!is_row(star.iter()));
    }
}
