//! The log of a sweep: a line of JSON for each piece of its result.
//!
//! Lines may come in any order and more than once; the last one about something holds. What a crash left of
//! a last line is not read.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::spec::Spec;

/// A piece of a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "line", rename_all = "kebab-case")]
pub enum Line {
    /// What is run; the first one.
    Sweep {
        /// Version of the program.
        cullscope: String,
        /// [`Spec::fingerprint`].
        spec: String,
    },
    /// A scene was opened.
    Scene(Seen),
    /// A configuration is ready on a scene.
    Built {
        /// Number of the scene.
        scene: u32,
        /// Number of the configuration.
        configuration: u32,
        /// What building its index took, milliseconds.
        build_ms: f64,
        /// What the index takes, bytes.
        index_bytes: u64,
    },
    /// What a frame draws, and how far it is from the truth.
    Judged(Judged),
    /// What a frame took in one flight.
    Timed(Timed),
    /// The most memory that the program held while it ran a scene.
    Memory {
        /// Number of the scene.
        scene: u32,
        /// Bytes.
        peak_bytes: u64,
    },
}

/// A scene that was opened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// Its number.
    pub scene: u32,
    /// Short name.
    pub name: String,
    /// Name of the path.
    pub path: String,
    /// Primitives.
    pub prims: u64,
    /// What they are called.
    pub prim: String,
    /// Size of the image, pixels.
    pub size_px: [u32; 2],
}

/// What a frame draws, and how far it is from the truth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Number of the scene.
    pub scene: u32,
    /// Number of the configuration.
    pub configuration: u32,
    /// Number of the frame.
    pub frame: u32,
    /// Primitives drawn.
    pub drawn: u64,
    /// What is drawn in place of others.
    pub stand_ins: u64,
    /// Primitives that are visible.
    pub visible: u64,
    /// Those of them that were not drawn.
    pub missed: u64,
    /// Pixels of the image.
    pub pixels: u64,
    /// Those of another color than the exact image's.
    pub wrong_pixels: u64,
    /// Mean LDR-FLIP, 0 to 1.
    pub flip: f64,
    /// What the method counted, by name.
    pub counts: BTreeMap<String, u64>,
}

/// What a frame took in one flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timed {
    /// Number of the scene.
    pub scene: u32,
    /// Number of the configuration.
    pub configuration: u32,
    /// Number of the frame.
    pub frame: u32,
    /// Number of the flight.
    pub round: u32,
    /// From the view to the list of what is drawn, milliseconds.
    pub cull_ms: f64,
    /// From there to the image, milliseconds.
    pub draw_ms: f64,
    /// The stages of culling by name, milliseconds.
    pub stages_ms: BTreeMap<String, f64>,
}

/// What is wrong with a log.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LogError {
    /// A line is none of a sweep's.
    #[error("line {0} is no line of a sweep: {1}")]
    Line(usize, String),
    /// It is of something else.
    #[error("it is of another spec or version of cullscope, so its results do not belong to this sweep")]
    Other,
}

/// All that is known of a sweep, by number of scene, configuration, frame and round.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    head: Option<(String, String)>,
    /// Scenes.
    pub scenes: BTreeMap<u32, Seen>,
    /// Milliseconds and bytes.
    pub built: BTreeMap<(u32, u32), (f64, u64)>,
    /// Frames.
    pub judged: BTreeMap<(u32, u32, u32), Judged>,
    /// Frames in flights.
    pub timed: BTreeMap<(u32, u32, u32, u32), Timed>,
    /// Bytes.
    pub peak_bytes: BTreeMap<u32, u64>,
}

impl Line {
    /// The first line of a spec's log.
    pub fn head(spec: &Spec) -> Self {
        Self::Sweep { cullscope: env!("CARGO_PKG_VERSION").to_owned(), spec: spec.fingerprint() }
    }
    /// As text, with its line end.
    pub fn text(&self) -> String {
        // Keys are text and numbers finite, so there is nothing that JSON could not hold.
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }
}

impl Log {
    /// Reads a log of a spec, on top of what is known.
    ///
    /// # Errors
    /// It is no log, or of another spec.
    pub fn read(&mut self, text: &str, spec: &Spec) -> Result<(), LogError> {
        let whole = text.rfind('\n').map_or(0, |at| at + 1);
        let lines = text[..whole].lines().enumerate().filter(|(_, line)| !line.is_empty());
        let mut is_of_spec = whole == 0;
        for (number, line) in lines {
            let line: Line =
                serde_json::from_str(line).map_err(|e| LogError::Line(number + 1, e.to_string()))?;
            if matches!(line, Line::Sweep { .. }) {
                if line != Line::head(spec) {
                    return Err(LogError::Other);
                }
                is_of_spec = true;
            }
            self.add(line);
        }
        if is_of_spec { Ok(()) } else { Err(LogError::Other) }
    }
    /// Adds a line.
    pub fn add(&mut self, line: Line) {
        match line {
            Line::Sweep { cullscope, spec } => self.head = Some((cullscope, spec)),
            Line::Scene(seen) => _ = self.scenes.insert(seen.scene, seen),
            Line::Built { scene, configuration, build_ms, index_bytes } => {
                self.built.insert((scene, configuration), (build_ms, index_bytes));
            }
            Line::Judged(one) => {
                self.judged.insert((one.scene, one.configuration, one.frame), one);
            }
            Line::Timed(one) => {
                self.timed.insert((one.scene, one.configuration, one.frame, one.round), one);
            }
            Line::Memory { scene, peak_bytes } => {
                let most = self.peak_bytes.entry(scene).or_default();
                *most = peak_bytes.max(*most);
            }
        }
    }
    /// Whether nothing is known yet.
    pub fn is_empty(&self) -> bool {
        self.head.is_none()
    }
    /// All lines, in the order of their numbers: the same of the same results, however they came about.
    pub fn text(&self, spec: &Spec) -> String {
        let built = self.built.iter().map(|(&(scene, configuration), &(build_ms, index_bytes))| {
            Line::Built { scene, configuration, build_ms, index_bytes }
        });
        let memory = self.peak_bytes.iter().map(|(&scene, &peak_bytes)| Line::Memory { scene, peak_bytes });
        std::iter::once(Line::head(spec))
            .chain(self.scenes.values().cloned().map(Line::Scene))
            .chain(built)
            .chain(self.judged.values().cloned().map(Line::Judged))
            .chain(self.timed.values().cloned().map(Line::Timed))
            .chain(memory)
            .map(|line| line.text())
            .collect()
    }
    /// Whether all frames of a configuration on a scene are judged.
    pub fn is_judged(&self, scene: u32, configuration: u32, frames: u32) -> bool {
        (0..frames).all(|frame| self.judged.contains_key(&(scene, configuration, frame)))
    }
    /// Whether all frames of one of its flights are timed.
    pub fn is_timed(&self, scene: u32, configuration: u32, frames: u32, round: u32) -> bool {
        (0..frames).all(|frame| self.timed.contains_key(&(scene, configuration, frame, round)))
    }
    /// How many pairs of a scene and a configuration of a spec are not finished, and of how many.
    pub fn missing(&self, spec: &Spec) -> [usize; 2] {
        let pairs = || {
            (0..spec.scenes.len() as u32)
                .flat_map(|scene| (0..spec.configurations.len() as u32).map(move |c| (scene, c)))
        };
        let is_done = |&(scene, c): &(u32, u32)| {
            self.is_judged(scene, c, spec.frames)
                && (0..spec.repeats).all(|round| self.is_timed(scene, c, spec.frames, round))
        };
        [pairs().filter(|pair| !is_done(pair)).count(), pairs().count()]
    }
}
