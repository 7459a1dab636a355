//! The tables and tests of the papers, measured on any scene beside the papers' own figures: Coorg and
//! Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997,
//! <https://doi.org/10.1145/253284.253312>, Section 4; Georges, "Obscuration Culling on Parallel Graphics
//! Architectures", UNC TR95-017, 1995, Section 5.2; Klosowski and Silva, "The Prioritized-Layered Projection
//! Algorithm for Visible Set Estimation", IEEE TVCG 6(2), 2000, <https://doi.org/10.1109/2945.856993>,
//! Section 5.
//!
//! An [`Experiment`] is a value: a name, and what it runs on each scene. Those of Coorg and Teller walk the
//! scene's path `figure 8` (where a scene has none, one through its middle), at
//! [`crate::geometry::WALKING_STEP_M`] a frame where the method remembers. The paper's models and machines
//! are not ours, so shares and ratios compare and milliseconds do not. Whatever is measured, the answers of a
//! method that promises to draw all that is visible are checked: the triangles that an item buffer shows and
//! the method did not draw are counted (0 expected).

mod flight;
mod georges;
mod klosowski_silva;
mod nodes;
mod occluders;
mod table_1;
mod table_2;
mod table_3;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Arc;

use serde_json::{Map, Value as Json, json};

use super::table::{Cell, Column, Table};
use crate::culling::Methods;
use crate::drawing::Plot;
use crate::drawing::words::grouped;
use crate::geometry::{Flat, Solid};
use crate::method::{KnobValue, SettingError, Settings};
use crate::raster::Drawable;
use crate::scene::{AnyScene, Part, Progress, Scene};

/// Key of the method that the paper is about, and of the one that it compares with.
const METHOD: &str = "large-occluders";
const BASELINE: &str = "frustum";

/// A space in which experiments work.
trait World: Methods + Drawable {}
impl<S: Methods + Drawable> World for S {}

/// What an experiment may be told.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Frames that are measured on each scene (at each speed, at each value of a parameter); at least 1.
    pub frames: usize,
    /// Parameters of the method; those that view-frustum culling has too are given to it as well.
    pub settings: Settings,
    /// Every how many of the measured frames the answer is compared with the truth; 0: never.
    pub check_every: usize,
    /// Size of the image, if not that of the path.
    pub size_px: Option<[u32; 2]>,
}

impl Default for Setup {
    fn default() -> Self {
        Self { frames: 240, settings: Settings::default(), check_every: 8, size_px: None }
    }
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// A parameter that the method does not have, or whose value does not fit.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Somebody stopped it.
    #[error("stopped as asked")]
    Cancelled,
}

/// A scene that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Short name.
    pub name: String,
    /// As it may be given again.
    pub source: String,
    /// Primitives.
    pub prims: usize,
    /// What they are called.
    pub prim: &'static str,
    /// The path that was walked.
    pub path: String,
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Name of the experiment.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The rows: ours first, then the paper's.
    pub table: Table,
    /// The charts.
    pub plots: Vec<Plot>,
    /// The scenes.
    pub scenes: Vec<Measured>,
    /// Digital object identifier of the paper.
    pub doi: &'static str,
    /// Parameters of the method that the experiment does not vary.
    pub params: Vec<(&'static str, String)>,
    /// Frames a scene, at most.
    pub frames: usize,
    /// What is to be known for reading the table.
    pub notes: Vec<&'static str>,
}

impl Report {
    /// Scenes and parameters in a few sentences, for under a chart.
    pub fn caption(&self) -> String {
        let scene = |m: &Measured| {
            format!("{} ({} {}s, path {})", m.name, grouped(m.prims as f64, 0), m.prim, m.path)
        };
        let scenes = self.scenes.iter().map(scene).collect::<Vec<_>>().join(", ");
        let params = self.params.iter().map(|(k, v)| format!("{k} {v}")).collect::<Vec<_>>().join(", ");
        format!("{scenes}; {params}; {} frames. {}", self.frames, self.notes.join(" "))
    }
    /// Title, table, and what is to be known, for people.
    pub fn text(&self) -> String {
        let mut lines = vec![String::new()];
        for word in self.caption().split(' ') {
            let line = lines.last_mut().filter(|l| l.chars().count() + word.chars().count() < TEXT_COLUMNS);
            match line {
                Some(line) if line.is_empty() => line.push_str(word),
                Some(line) => *line += &format!(" {word}"),
                None => lines.push(word.to_owned()),
            }
        }
        // Single frames are for charts and for other programs.
        let frame = self.table.columns.iter().position(|c| c.key == FRAME);
        let is_frame = |row: &[Cell]| frame.is_some_and(|at| matches!(row[at], Cell::Number(_)));
        let left_out = self.table.rows.iter().filter(|r| is_frame(r)).count();
        let rows = self.table.rows.iter().filter(|r| !is_frame(r)).cloned().collect();
        let table = Table { columns: self.table.columns.clone(), rows };
        if left_out > 0 {
            lines.push(format!(
                "{left_out} rows of single frames are in the formats csv and json, and in the charts."
            ));
        }
        format!("{}\n\n{}\n{}\n", self.title, table.text(), lines.join("\n"))
    }
    /// Everything, with every digit.
    pub fn json(&self) -> Json {
        let columns = self
            .table
            .columns
            .iter()
            .map(|c| json!({"key": c.key, "title": c.title, "unit": c.unit}))
            .collect::<Vec<_>>();
        let scenes = self
            .scenes
            .iter()
            .map(|m| json!({"name": m.name, "source": m.source, "primitives": m.prims, "path": m.path}));
        let params = self.params.iter().map(|(k, v)| ((*k).to_owned(), json!(v))).collect::<Map<_, _>>();
        json!({
            "cullscope": env!("CARGO_PKG_VERSION"),
            "experiment": self.name,
            "title": self.title,
            "paper_doi": self.doi,
            "scenes": scenes.collect::<Vec<_>>(),
            "params": params,
            "frames": self.frames,
            "columns": columns,
            "rows": self.table.json(),
            "notes": self.notes,
        })
    }
}

/// One of the paper's tables, or a question that it leaves open.
pub struct Experiment {
    /// Kebab-case name.
    pub name: &'static str,
    /// Title of the result.
    pub title: &'static str,
    /// One line for lists.
    pub summary: &'static str,
    /// Key of the method that it is about.
    pub method: &'static str,
    /// What it is measured on where no scene is named.
    pub scenes: &'static [&'static str],
    doi: &'static str,
    /// What else is to be known for reading the table.
    notes: &'static [&'static str],
    /// Parameters that it varies itself.
    varies: &'static [&'static str],
    sweep: &'static Sweep,
}

/// All of them, in the order of lists.
pub static EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "coorg-teller-table-1",
        method: METHOD,
        scenes: WALKED,
        doi: COORG_TELLER,
        title: "Coorg and Teller 1997, Table 1: polygons drawn",
        summary: "Percent of the polygons drawn after view-frustum culling and after occlusion culling",
        notes: &["Averages over views evenly spaced along the whole path."],
        varies: &[],
        sweep: &table_1::SWEEP,
    },
    Experiment {
        name: "coorg-teller-table-2",
        method: METHOD,
        scenes: WALKED,
        doi: COORG_TELLER,
        title: "Coorg and Teller 1997, Table 2: time to cull and to draw",
        summary: "Milliseconds to cull and to draw a frame, with view-frustum culling and with occlusion \
                  culling",
        notes: &[TIMES, "We draw with a software rasterizer, the paper with graphics hardware of its time."],
        varies: &[],
        sweep: &table_2::SWEEP,
    },
    Experiment {
        name: "coorg-teller-table-3",
        method: METHOD,
        scenes: WALKED,
        doi: COORG_TELLER,
        title: "Coorg and Teller 1997, Table 3: time in visibility against speed",
        summary: "Time to cull a frame against the speed of the walker, with and without planes kept from \
                  frame to frame",
        notes: &[
            TIMES,
            "Ours is all of culling, view-frustum tests and gathering included; the paper leaves out the \
             view-frustum tests.",
        ],
        varies: &["cache"],
        sweep: &table_3::SWEEP,
    },
    Experiment {
        name: "coorg-teller-nodes",
        method: METHOD,
        scenes: WALKED,
        doi: COORG_TELLER,
        title: "Coorg and Teller 1997, Section 4.1: nodes tested for occlusion",
        summary: "kD-tree nodes tested for occlusion a frame, and their share of those in the view frustum",
        notes: &[
            "Low and high are the quartiles over the frames; for the paper, the ends of the range that it \
             states for both models.",
        ],
        varies: &[],
        sweep: &nodes::SWEEP,
    },
    Experiment {
        name: "coorg-teller-occluders",
        method: METHOD,
        scenes: WALKED,
        doi: COORG_TELLER,
        title: "Coorg and Teller 1997, Section 5: how many occluders",
        summary: "Polygons drawn and time to cull against the number of occluders, fixed or by their \
                  marginal gain",
        notes: &[
            TIMES,
            "The paper has 32 occluders and states no figures for others; by marginal gain at most 64 are \
             taken.",
        ],
        varies: &["occluders", "marginal-gain"],
        sweep: &occluders::SWEEP,
    },
    Experiment {
        name: "georges-box",
        method: georges::METHOD,
        scenes: &["generate:box-and-objects"],
        doi: GEORGES,
        title: "Georges 1995, Section 5.2: a box that hides a row of objects",
        summary: "Frames a second with the objects in sight and behind the box, with obscuration culling and \
                  without",
        notes: &[
            FRAMES,
            "The paper's system has one processor; its rate behind the box is that of the monitor, about 60 \
             a second.",
        ],
        varies: &[],
        sweep: &georges::BOX,
    },
    Experiment {
        name: "georges-flight",
        method: georges::METHOD,
        scenes: &["generate:machine-room", "generate:building", "generate:city"],
        doi: GEORGES,
        title: "Georges 1995, Section 5.2: a hidden dense body",
        summary: "Time of a frame along a flight, with obscuration culling and without; the paper gains 20 \
                  to 30 percent",
        notes: &[
            FRAMES,
            "The paper's 20 to 30 percent are for frames in which the dense body is in the view frustum and \
             hidden.",
        ],
        varies: &[],
        sweep: &georges::FLIGHT,
    },
    Experiment {
        name: "georges-aliasing",
        method: georges::METHOD,
        scenes: &["generate:thin-slabs", "generate:building?polygons=20000"],
        doi: GEORGES,
        title: "What samples miss: aliasing of the z-buffer against resolution",
        summary: "Triangles that a fine image shows and obscuration culling at a coarse one does not draw",
        notes: &[
            "Fine: 2048 × 2048. What falls between the samples of the coarse image is not drawn; at its own \
             resolution nothing is missed.",
        ],
        varies: &[],
        sweep: &georges::ALIASING,
    },
    Experiment {
        name: "klosowski-silva-table-1",
        method: klosowski_silva::METHOD,
        scenes: LARGE,
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Table 1: visible coverage ratio",
        summary: "Share of the visible triangles that a budget finds, by cells and by centroid, and the \
                  worst frame's wrong pixels",
        notes: &[
            COVERED,
            "The paper's most wrong pixels are stated without a budget; they are shown at the largest.",
        ],
        varies: &["tessellation", "budget"],
        sweep: &klosowski_silva::TABLE_1,
    },
    Experiment {
        name: "klosowski-silva-frames",
        method: klosowski_silva::METHOD,
        scenes: LARGE,
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Figures 10 and 11: what budgets find, frame by frame",
        summary: "Visible triangles found and time of a frame at budgets of 1, 2, 5 and 10 percent, frame by \
                  frame",
        notes: &[
            COVERED,
            FRAMES,
            "The paper's frames are 4 times faster at 5 percent (City) and 10 times at 1 percent (5 Car \
             Body/Engine) than with everything drawn.",
        ],
        varies: &["budget"],
        sweep: &klosowski_silva::FRAMES,
    },
    Experiment {
        name: "klosowski-silva-comparison",
        method: klosowski_silva::METHOD,
        scenes: &["generate:city?polygons=500000", "generate:seminar-room"],
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Figures 12 and 15: cells and centroid compared",
        summary: "Visible triangles found, wrong pixels and time of a frame by Delaunay, octree, kD-tree and \
                  centroid, frame by frame",
        notes: &[
            COVERED,
            FRAMES,
            "The paper's centroid order has 7 to 40 percent of the pixels wrong; its Delaunay cells find \
             over 90 percent.",
        ],
        varies: &["tessellation"],
        sweep: &klosowski_silva::COMPARISON,
    },
    Experiment {
        name: "klosowski-silva-stability",
        method: klosowski_silva::METHOD,
        scenes: &["generate:city?polygons=500000", "generate:seminar-room"],
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Section 7: is the visible set stable?",
        summary: "What pops between views a step apart: triangles and pixels that change though the exact \
                  image does not",
        notes: &[
            "Between two views a walker's step apart (4.7 cm), means over the pairs. A triangle pops that is \
             visible in both views and drawn in one of them; a pixel pops that shows the same triangle in \
             both exact images and is right in one view and wrong in the other. A set changes by its share \
             of those that are in either view's set and not in both. The paper says that nothing major pops, \
             without figures.",
        ],
        varies: &["tessellation", "budget"],
        sweep: &klosowski_silva::STABILITY,
    },
    Experiment {
        name: "klosowski-silva-preprocess",
        method: klosowski_silva::METHOD,
        scenes: &["generate:city?polygons=500000", "generate:cars", "generate:city?polygons=1000000"],
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Section 5.1: preprocess",
        summary: "Time of the preprocess by stage, cells, references a triangle, and memory",
        notes: &[
            "Medians of three builds in turn, one thread. A reference takes 4 bytes; cells are all the rest \
             of the index, neighbors and normals included; the scene is all that we keep of it. Overhead: \
             cells and references against the scene; in the paper, against its triangles.",
        ],
        varies: &["tessellation", "budget"],
        sweep: &klosowski_silva::PREPROCESS,
    },
    Experiment {
        name: "klosowski-silva-overhead",
        method: klosowski_silva::METHOD,
        scenes: LARGE,
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Section 5.2.3: overhead over view-frustum culling",
        summary: "Time of the traversal beside view-frustum culling, by cells and budget, alone and as a \
                  share of a frame",
        notes: &[
            FRAMES,
            "View-frustum culling walks a kD-tree and keeps nodes whole; a frame of it is culled, and all \
             that was kept is drawn. At 100 percent all that is in view is drawn, triangle by triangle.",
        ],
        varies: &["tessellation", "budget"],
        sweep: &klosowski_silva::OVERHEAD,
    },
    Experiment {
        name: "klosowski-silva-extensions",
        method: klosowski_silva::METHOD,
        scenes: LARGE,
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Section 6: extensions",
        summary: "What each extension finds and costs: other solidities, several seeds, a wanted quality, \
                  queries for the rest",
        notes: &[COVERED, "With a quality or queries the budget is where they begin."],
        varies: &["budget", "transfer", "update", "occupancy", "seeds", "quality", "queries"],
        sweep: &klosowski_silva::EXTENSIONS,
    },
    Experiment {
        name: "klosowski-silva-deadline",
        method: klosowski_silva::METHOD,
        scenes: LARGE,
        doi: KLOSOWSKI_SILVA,
        title: "Klosowski and Silva 2000, Section 3: time-critical frames",
        summary: "How long frames take that end at a deadline, on an idle and on a loaded machine, and how \
                  far they overshoot",
        notes: &["Loaded: two more busy threads for each core. A frame is culled and drawn on one thread."],
        varies: &["budget"],
        sweep: &klosowski_silva::DEADLINE,
    },
];

const COORG_TELLER: &str = "10.1145/253284.253312";
/// Of Greene, Kass and Miller 1993; the report has none.
const GEORGES: &str = "10.1145/166117.166147";
const KLOSOWSKI_SILVA: &str = "10.1109/2945.856993";
/// What Klosowski and Silva's large models are likened to.
const LARGE: &[&str] = &["generate:city?polygons=500000", "generate:cars"];
/// How what is found was measured.
const COVERED: &str = "Along the scene's own path. Visible is what owns a pixel of the item buffer; of each \
                       frame the share of it that was drawn, then the mean over the frames. A pixel is wrong \
                       if its color differs from the exact image's.";
/// What Coorg and Teller's models are likened to.
const WALKED: &[&str] = &["generate:building", "generate:city"];
/// How times of whole frames were taken.
const FRAMES: &str = "Wall-clock times on one thread from the view to the finished image, interleaved; of \
                      each frame the median of three flights along the scene's own path.";

/// Columns of a terminal that running text takes.
const TEXT_COLUMNS: usize = 100;
/// How times were taken.
const TIMES: &str = "Wall-clock times on one thread, interleaved; of each frame the median of three rounds, \
                     then the mean over the frames of a walk, at walking speed where no other is named.";

impl Experiment {
    /// The experiment with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        EXPERIMENTS.iter().find(|e| e.name == name)
    }

    /// Whether the parameters are fine.
    ///
    /// # Errors
    /// As [`Experiment::run`].
    pub fn check(&self, settings: &Settings) -> Result<(), PaperError> {
        Ok(method::<Solid>(self.method).knobs(settings).map(drop)?)
    }

    /// Runs it on scenes, one after the other.
    ///
    /// # Errors
    /// A parameter that does not fit; or it was cancelled.
    pub fn run(
        &self,
        scenes: &[AnyScene],
        setup: &Setup,
        progress: &dyn Progress,
    ) -> Result<Report, PaperError> {
        self.check(&setup.settings)?;
        let setup = Setup { frames: setup.frames.max(1), ..setup.clone() };
        let mut table = Table::new(self.sweep.columns);
        let mut measured = Vec::new();
        for (i, scene) in scenes.iter().enumerate() {
            let n = scenes.len() as f32;
            let part = Part { whole: progress, start: i as f32 / n, length: 1.0 / n };
            let (mut rows, mut about) = match scene {
                AnyScene::Flat(scene) => (self.sweep.flat)(scene, &setup, &part)?,
                AnyScene::Solid(scene) => (self.sweep.solid)(scene, &setup, &part)?,
            };
            // Rows are told apart by the scene's name.
            if measured.iter().any(|m: &Measured| m.name == about.name) {
                about.name += &format!(", {}", grouped(about.prims as f64, 0));
                let at = table.columns.iter().position(|c| c.key == SCENE.key);
                rows.iter_mut()
                    .filter_map(|r| r.get_mut(at?))
                    .for_each(|cell| *cell = about.name.as_str().into());
            }
            table.rows.extend(rows);
            measured.push(about);
        }
        let plots = (self.sweep.plots)(&table);
        table.rows.extend((self.sweep.paper)());
        let knobs = method::<Solid>(self.method).knobs(&setup.settings)?;
        let fixed = knobs.iter().filter(|(k, _)| !self.varies.contains(&k.name));
        let params = fixed.map(|(k, v): &(_, KnobValue)| (k.name, v.to_string())).collect();
        let (name, title, notes) = (self.name, self.title, self.notes.to_vec());
        Ok(Report {
            name,
            title,
            table,
            plots,
            scenes: measured,
            doi: self.doi,
            params,
            frames: setup.frames,
            notes,
        })
    }
}

/// A method that every build has.
fn method<S: Methods>(key: &str) -> &'static dyn crate::method::Entry<S> {
    S::methods().iter().copied().find(|m| m.card().key == key).unwrap_or(S::methods()[0])
}

/// What an experiment does.
struct Sweep {
    columns: &'static [Column],
    /// The rows of a scene of flatland.
    flat: On<Flat>,
    /// The rows of a scene of space.
    solid: On<Solid>,
    /// The paper's rows.
    paper: fn() -> Vec<Vec<Cell>>,
    /// Charts of the measured rows; they know the paper's figures.
    plots: fn(&Table) -> Vec<Plot>,
}

/// Measures a scene.
type On<S> = fn(&Arc<Scene<S>>, &Setup, &dyn Progress) -> Result<(Vec<Vec<Cell>>, Measured), PaperError>;

/// Columns that several tables have.
const SOURCE: Column = Column { key: "source", title: "source", unit: "", decimals: 0 };
const SCENE: Column = Column { key: "scene", title: "scene", unit: "", decimals: 0 };
const MISSED: Column = Column { key: "missed_triangles", title: "missed", unit: "triangles", decimals: 0 };
/// Key of the column of tables that have a row for each frame.
const FRAME: &str = "frame";
const CHECKED: Column = Column { key: "checked_views", title: "checked", unit: "views", decimals: 0 };

const fn column(key: &'static str, title: &'static str, unit: &'static str, decimals: usize) -> Column {
    Column { key, title, unit, decimals }
}

/// The rows of each scene, in order, with its name.
fn by_scene(table: &Table) -> Vec<(String, Vec<usize>)> {
    let mut scenes: Vec<(String, Vec<usize>)> = Vec::new();
    let Some(at) = table.columns.iter().position(|c| c.key == SCENE.key) else { return scenes };
    for (r, row) in table.rows.iter().enumerate() {
        let Cell::Text(name) = &row[at] else { continue };
        match scenes.last_mut().filter(|(last, _)| last == name) {
            Some((_, rows)) => rows.push(r),
            None => scenes.push((name.clone(), vec![r])),
        }
    }
    scenes
}

/// A part of a work.
fn part(whole: &dyn Progress, start: f32, end: f32) -> Part<'_> {
    Part { whole, start, length: end - start }
}
