//! Section 5.4: small holes ignored by thresholds, which count black samples of map pixels, and by area
//! closing, which measures the holes themselves. What either loses against what it saves.

use std::sync::Arc;

use super::seen::Seen;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::part;
use crate::measure::harness::path::{about, path};
use crate::measure::{Experiment, Setup, Table};
use crate::papers::keys::OCCLUSION_MAPS;
use crate::scene::{Progress, Scene};

pub const TABLE: Experiment = Experiment {
    name: "zhang-closing",
    method: OCCLUSION_MAPS,
    scenes: &["generate:forest"],
    title: "Zhang et al. 1997, Section 5.4: thresholds and area closing",
    summary: "Holes of up to n samples ignored by opacity thresholds and by area closing: triangles saved \
              and pixels lost",
    notes: &[
        "Images of 1024 × 1024 pixels, unless a size is set, and maps of at most 64 × 64, as in the paper's \
         example. A threshold of 1 − n/m_0 ignores up to n black samples of each map pixel, wherever they \
         are; closing fills holes of up to n connected samples, if only at corners. Saved: triangles that \
         are drawn where no hole is ignored, and here are not; mean over the frames. Missed and lost are \
         means over the frames that are compared with the item buffer.",
        "What thresholds do not bound shows where the walls alone are occluders: a slit of a pixel by 1,024 \
         (--scene scenes3d/slit/slit.obj --set leaf-primitives=1 --set occluder-budget=4), a hole on a \
         corner of map pixels (scenes3d/corner_hole/corner_hole.obj, 100), and gaps of flatland \
         (scenes2d/holes.json, 7).",
    ],
    settings: &[
        ("adapt", "false"),
        ("map-resolution", "64"),
        ("occluder-budget", "100000"),
        ("occluder-size", "0"),
        ("depth", "samples"),
    ],
    sweep: &SWEEP,
};

const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("way", "holes", "", 0),
        column("ignored_samples", "n", "samples", 0),
        column("culled_percent", "culled", "% of those in view", 2),
        column("saved_triangles", "saved", "triangles", 1),
        column("missed_visible", "visible and missed", "triangles", 1),
        column("wrong_pixels", "lost", "pixels", 1),
        column("checked_frames", "compared", "frames", 0),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// Samples of holes, in space and in flatland; the paper's example is 25.
const HOLES: [[u32; 5]; 2] = [[1, 4, 25, 64, 128], [1, 2, 3, 4, 8]];
/// Names of the ways: the second and the third ignore holes.
const WAYS: [&str; 3] = ["none ignored", "thresholds", "closing"];
/// Side of the image where none is set, pixels.
const SIDE: u32 = 1024;
/// Pixels along the longer side of the finest map, at most, as [`TABLE`] sets them.
const MAP: u32 = 64;

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let setup = &Setup { size_px: setup.size_px.or(Some([SIDE; 2])), ..setup.clone() };
    let path = path(scene, setup);
    let about = about(scene, &path);
    // Samples of a pixel of the finest map: a square whose side is a power of two.
    let longer = path.views[0].width.max(path.views[0].height);
    let side = (0..32).map(|k| 1 << k).find(|side| longer.div_ceil(*side) <= MAP).unwrap_or(1);
    let whole = if S::CORNERS == 2 { side } else { side * side };
    let mut ways: Vec<(usize, u32)> = vec![(0, 0)];
    for way in [1, 2] {
        ways.extend(HOLES[usize::from(S::CORNERS == 2)].map(|n| (way, n)));
    }
    let (mut rows, mut exact) = (Vec::new(), 0.0);
    for (i, &(way, n)) in ways.iter().enumerate() {
        let length = 1.0 / ways.len() as f32;
        let part = part(progress, i as f32 * length, (i + 1) as f32 * length);
        // Below a half no threshold is set.
        let threshold = 1.0 - f64::from(n.min(whole / 2)) / f64::from(whole);
        let value = if way == 1 { threshold.to_string() } else { n.to_string() };
        let set = [("opacity-threshold", value.as_str()), ("closing", value.as_str())];
        let on_top = if way == 0 { &[][..] } else { &set[way - 1..way] };
        let seen = Seen::along(scene, setup, &path.views, on_top, &part)?;
        let drawn = seen.mean(seen.drawn);
        if way == 0 {
            exact = drawn;
        }
        let of_checked = |sum: usize| sum as f64 / seen.checked.max(1) as f64;
        let numbers = [
            seen.culled_percent(),
            exact - drawn,
            of_checked(seen.missed),
            of_checked(seen.wrong),
            seen.checked as f64,
        ];
        rows.push(measured(&about.name, [WAYS[way].into(), f64::from(n).into()], numbers));
    }
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |(name, rows): (String, Vec<usize>)| {
        let series = |way: usize, role: Role| {
            // Each from where nothing is ignored.
            let of_way = rows.iter().skip(1 + (way - 1) * HOLES[0].len()).take(HOLES[0].len());
            let points = rows.iter().take(1).chain(of_way).filter_map(|&r| {
                Some((table.number(r, "saved_triangles")?, table.number(r, "wrong_pixels")?))
            });
            Series::new(WAYS[way], role, points.collect())
        };
        Plot {
            title: name,
            x_label: "triangles saved".into(),
            y_label: "pixels lost".into(),
            shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
            series: vec![series(1, Role::Approximated), series(2, Role::Hidden)],
        }
    };
    by_scene(table).into_iter().map(plot).collect()
}
