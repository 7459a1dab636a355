//! Figures 9 and 10 as counts of polygons, which are the same on every machine; the tables `zhang-frames` and
//! `zhang-stages` measure the times.

use super::counts;
use super::notes::{occluder_prims, tests};
use super::space::solid;
use crate::drawing::{Drawing, Plot, Role, Series, Shape};
use crate::figure::tools::Maker;
use crate::figure::{Paper, charts};
use crate::geometry::View;
use crate::papers::keys::OCCLUSION_MAPS;
use crate::scene::{Motion, Quiet, SceneError};

/// Frames along each path.
const FRAMES: usize = 16;
/// Side of the image, pixels.
const SIDE: u32 = 192;
/// Name, scene, L, and by how much the paper's frames of its own model are faster.
const MODELS: [(&str, &str, &str, &str); 3] = [
    ("city", "generate:city?polygons=30000&seed=7", "1200", "about 5"),
    ("machine room", "generate:machine-room?polygons=30000", "1500", "about 2"),
    ("swarm", "generate:swarm?polygons=60000", "2000", "about 5"),
];

/// Of a frame: in view, drawn, drawn as occluders, nodes tested.
type Counted = [f64; 4];

/// The frames of a model along its own path, with what moves in it.
fn flown(maker: &Maker<'_>, source: &str, limit: &str) -> Result<Vec<Counted>, SceneError> {
    let scene = solid(source)?;
    // The few polygons of a small model would hardly ever pay for the maps.
    let settings =
        [("depth", "samples"), ("occluder-size", "0"), ("adapt", "false"), ("occluder-budget", limit)];
    let mut run = maker.ready(&scene, OCCLUSION_MAPS, &settings);
    let (mut motion, views) = (Motion::new(&scene), &scene.paths()[0].views);
    let frame = |k: usize| {
        let at = k * views.len() / FRAMES;
        run.pose(&motion.at(at), &Quiet);
        let film = run.record(&View { width: SIDE, height: SIDE, ..views[at] }, usize::MAX).film;
        let [drawn, hidden, presumed, _] = counts(&*film);
        let all = [drawn + hidden + presumed, drawn, occluder_prims(&*film) as usize, tests(&*film)];
        all.map(|n| n as f64)
    };
    Ok((0..FRAMES).map(frame).collect())
}

fn all(maker: &Maker<'_>) -> Result<Vec<Vec<Counted>>, SceneError> {
    MODELS.iter().map(|(_, source, limit, _)| flown(maker, source, limit)).collect()
}

fn mean(frames: &[Counted], which: usize) -> f64 {
    frames.iter().map(|f| f[which]).sum::<f64>() / frames.len() as f64
}

/// What is culled of what is in view, per cent.
fn culled(frame: &Counted) -> f64 {
    100.0 * (1.0 - frame[1] / frame[0].max(1.0))
}

/// Figure 9.
pub fn frames(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let flown = all(maker)?;
    let line = |frames: &[Counted], label: &str, role: Role, of: &dyn Fn(&Counted) -> f64| {
        Series::new(label, role, frames.iter().enumerate().map(|(k, f)| (k as f64, of(f))).collect())
    };
    let plot = |title: String, y_label: &str, series: Vec<Series>| Plot {
        title,
        x_label: "frame".into(),
        y_label: y_label.into(),
        shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
        series,
    };
    let drawn = flown.iter().zip(MODELS).map(|(frames, (name, ..))| {
        let series = vec![
            line(frames, "without occlusion culling", Role::Outside, &|f| f[0]),
            line(frames, "with occlusion culling", Role::Visible, &|f| f[1]),
            line(frames, "drawn as occluders", Role::Occluder, &|f| f[2]),
        ];
        plot(format!("{name}: triangles drawn"), "triangles", series)
    });
    let shares = flown.iter().zip(MODELS).map(|(frames, (name, ..))| {
        let series = vec![line(frames, "culled", Role::Hidden, &culled)];
        plot(format!("{name}: culled"), "% of what is in view", series)
    });
    let (content, legend) = charts(&drawn.chain(shares).collect::<Vec<_>>());
    let of = |(frames, (name, _, _, paper)): (&Vec<Counted>, (&str, &str, &str, &str))| {
        let share = frames.iter().map(culled).sum::<f64>() / frames.len() as f64;
        let fewer = mean(frames, 0) / mean(frames, 1);
        format!("{name} {share:.0} %, {fewer:.1} times fewer triangles (paper: frames {paper} times faster)")
    };
    let each: Vec<String> = flown.iter().zip(MODELS).map(of).collect();
    let caption = format!(
        "Frame by frame along a path, on small models, as counts, which are the same on every machine; the \
         table zhang-frames measures times, with as many polygons as the paper's models. Culled in the mean, \
         and drawn: {}. The limit for occluders stays as it is. {SIDE} × {SIDE} pixels.",
        each.join("; ")
    );
    let title = "Zhang et al. 1997, Figure 9: frames with and without occlusion culling";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption, &content))
}

/// Figure 10.
pub fn stages(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let flown = all(maker)?;
    let groups = MODELS.iter().flat_map(|(name, ..)| [format!("{name}\nwithout"), format!("{name}\nwith")]);
    let share = |frames: &[Counted], which: usize| 100.0 * mean(frames, which) / mean(frames, 0);
    let bars = |which: usize| -> Vec<(f64, f64)> {
        flown.iter().enumerate().map(|(i, f)| (2.0 * i as f64 + 1.0, share(f, which))).collect()
    };
    let whole = (0..MODELS.len()).map(|i| (2.0 * i as f64, 100.0)).collect();
    let plot = Plot {
        title: String::new(),
        x_label: String::new(),
        y_label: "triangles, % of those in view".into(),
        shape: Shape::Bars { groups: groups.collect(), stacked: true },
        series: vec![
            Series::new("without: all that is in view", Role::Outside, whole),
            Series::new("drawn as occluders", Role::Occluder, bars(2)),
            Series::new("final rendering", Role::Visible, bars(1)),
        ],
    };
    let (content, legend) = charts(&[plot]);
    let of = |(frames, (name, ..)): (&Vec<Counted>, (&str, &str, &str, &str))| {
        format!("{name} {:.1} %, {:.0} nodes", share(frames, 2), mean(frames, 3))
    };
    let each: Vec<String> = flown.iter().zip(MODELS).map(of).collect();
    let caption = format!(
        "What is drawn in a mean frame, as occluders and in the end, against all that is in view. The paper \
         shows shares of time, of which occluders take 10 to 25 %; here are counts, which are the same on \
         every machine, and the table zhang-stages measures times. Occluders and nodes tested: {}. Small \
         models, {FRAMES} frames along a path, {SIDE} × {SIDE} pixels.",
        each.join("; ")
    );
    let title = "Zhang et al. 1997, Figure 10: what a frame draws, by stage";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn less_is_drawn_with_occlusion_culling_than_without() {
        let flown = all(&Maker::gray()).expect("scenes");
        for (frames, (name, ..)) in flown.iter().zip(MODELS) {
            assert_eq!(frames.len(), FRAMES);
            for [in_view, drawn, occluders, tests] in frames {
                assert!(drawn <= in_view && occluders <= in_view && *tests > 0.0, "{name}");
            }
            let [in_view, drawn, occluders] = [0, 1, 2].map(|which| mean(frames, which));
            assert!(occluders + drawn < 0.95 * in_view, "{name}: {occluders} and {drawn} of {in_view}");
        }
    }
}
