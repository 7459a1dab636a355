//! Sections 6.2 and 8: what is drawn of occluders. Stand-ins that preserve occlusion against the occluders
//! themselves, and against a simplification that does not.

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
    name: "zhang-occluders",
    method: OCCLUSION_MAPS,
    scenes: &[
        "generate:building?polygons=20000",
        "generate:city?polygons=20000",
        "generate:machine-room?polygons=30000",
    ],
    title: "Zhang et al. 1997, Sections 6.2 and 8: what is drawn of occluders",
    summary: "Occluders themselves, stand-ins that preserve occlusion, and clustered vertices, which do not: \
              polygons drawn, what is culled, and what is missed",
    notes: &[
        "Means over the frames, all with the same L. Culled: of the triangles in view those that are not \
         drawn. Missed and wrong are sums over the frames that are compared with the item buffer: 0 is \
         expected of all but the clustered. The paper's simplified occluders [Cohen 1996] have error bounds \
         and do not preserve occlusion; it gives no numbers of them.",
    ],
    settings: &[("adapt", "false")],
    sweep: &SWEEP,
};

const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("occluders", "drawn of them", "", 0),
        column("occluder_leaves", "occluders", "leaves", 1),
        column("occluder_polygons", "their polygons", "triangles", 1),
        column("culled_percent", "culled", "% of those in view", 2),
        column("drawn_triangles", "drawn", "triangles", 1),
        column("missed_visible", "visible and missed", "triangles", 0),
        column("wrong_pixels", "wrong", "pixels", 0),
        column("checked_frames", "compared", "frames", 0),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// A kind and the parameters that make it. What is clustered is as coarse as what is too small for the
/// occluder database.
type Drawn = (&'static str, &'static [(&'static str, &'static str)]);

const KINDS: [Drawn; 6] = [
    ("original", &[]),
    ("merged", &[("occluders", "merged")]),
    ("largest", &[("occluders", "largest")]),
    ("inner", &[("occluders", "inner")]),
    ("clustered", &[("occluders", "clustered")]),
    ("clustered, coarse", &[("occluders", "clustered"), ("occluder-size", "40")]),
];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let about = about(scene, &path);
    let mut rows = Vec::new();
    for (i, (kind, set)) in KINDS.into_iter().enumerate() {
        let length = 1.0 / KINDS.len() as f32;
        let whole = part(progress, i as f32 * length, (i + 1) as f32 * length);
        let seen = Seen::along(scene, setup, &path.views, set, &whole)?;
        let numbers = [
            seen.mean(seen.leaves),
            seen.mean(seen.occluders),
            seen.culled_percent(),
            seen.mean(seen.drawn),
            seen.missed as f64,
            seen.wrong as f64,
            seen.checked as f64,
        ];
        rows.push(measured(&about.name, [kind.into()], numbers));
    }
    Ok((rows, about))
}

/// Of their bars.
const ROLES: [Role; 6] =
    [Role::Occluder, Role::Hidden, Role::Visible, Role::Partial, Role::Approximated, Role::Wrong];

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let groups: Vec<String> = scenes.iter().map(|s| s.0.clone()).collect();
    let plot = |y_label: &str, key: &str| Plot {
        title: String::new(),
        x_label: String::new(),
        y_label: y_label.into(),
        shape: Shape::Bars { groups: groups.clone(), stacked: false },
        series: (0..KINDS.len())
            .map(|k| {
                let role = ROLES[k];
                let of = |(i, (_, rows)): (usize, &(String, Vec<usize>))| {
                    Some((i as f64, table.number(*rows.get(k)?, key)?))
                };
                Series::new(KINDS[k].0, role, scenes.iter().enumerate().filter_map(of).collect())
            })
            .collect(),
    };
    vec![
        plot("triangles culled, % of those in view", "culled_percent"),
        plot("visible triangles missed", "missed_visible"),
    ]
}
