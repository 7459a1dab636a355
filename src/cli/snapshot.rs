//! `cullscope figure --scene …`: what the explorer shows of a step as files, without its window.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::methods::{find, refuse_clock, settings};
use super::plates::{Files, write};
use super::progress::Bar;
use super::remake::wait;
use super::view::{Asked, ViewArgs};
use super::{CliError, World, scene, suggest};
use crate::app::{AnyOpened, AnyView, Command, Export, Filter, Opened, PAPERS, Picture, State, word};
use crate::drawing::words::count;
use crate::figure::Paper;
use crate::geometry::{Either, View};
use crate::method::{Settings, Verdict};
use crate::scene::{LoadOptions, Progress, Scene};
use crate::trace::Counts;

/// Words of pictures that every method has, and of all that there are.
const SHARED: [&str; 3] = ["observer", "eye", "pseudocode"];
const ALL: &str = "all";

#[derive(clap::Args)]
#[command(next_help_heading = "A step of a run, as the explorer shows it")]
pub(super) struct Snapshot {
    /// A path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME[?key=value&…]
    #[arg(long, value_name = "SCENE", requires = "method")]
    pub scene: Option<String>,
    /// A method; `cullscope methods` lists them
    #[arg(long, short, value_name = "METHOD", requires = "scene")]
    method: Option<String>,
    /// A parameter of the method; may be given several times
    #[arg(long, value_name = "KEY=VALUE", requires = "scene")]
    set: Vec<String>,
    /// After so many events
    #[arg(long, value_name = "N", group = "moment", requires = "scene")]
    step: Option<usize>,
    /// Steps from A to B, every Sth, a file each
    #[arg(long, value_name = "A..B[..S]", group = "moment", requires = "scene", value_parser = steps)]
    steps: Option<Steps>,
    /// After the last event; this is the default
    #[arg(long, group = "moment", requires = "scene")]
    last: bool,
    /// After the first event that finds something hidden
    #[arg(long, group = "moment", requires = "scene")]
    first_hidden: bool,
    /// After the first event that passes a filter of the explorer, such as `verdict:hidden under:12`
    #[arg(long = "where", value_name = "FILTER", group = "moment", requires = "scene")]
    filter: Option<String>,
    /// observer, eye, pseudocode, a picture of the method by name, or all; several with commas
    #[arg(long, value_name = "NAME", value_delimiter = ',', default_value = "observer", requires = "scene")]
    picture: Vec<String>,
    /// Size: one column of a journal (84 mm), its page (175 mm), or a slide of 16:9
    #[arg(long, value_enum, default_value = "page", requires = "scene")]
    paper: Size,
    /// Width over height of the Observer's picture [default: to fit flatland, 4:3 in space]
    #[arg(long, value_name = "RATIO", requires = "scene", value_parser = ratio)]
    aspect: Option<f32>,
    /// Surfaces of space as vectors that hide each other, not as pixels; what was culled as dashed outlines
    #[arg(long, requires = "scene")]
    vectors: bool,
    /// A command of the explorer before that, such as look-in-cut, surface-wire, select:node:4, frame:0:7
    /// (view 7 of path 0); may be given several times
    #[arg(long = "do", value_name = "COMMAND", requires = "scene")]
    commands: Vec<String>,
    #[command(flatten)]
    view: ViewArgs,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Size {
    Column,
    Page,
    Slide,
}

impl Size {
    fn paper(self) -> Paper {
        PAPERS[self as usize].1
    }
}

fn ratio(text: &str) -> Result<f32, String> {
    let parsed = match text.split_once(':') {
        Some((w, h)) => w.parse::<f32>().ok().zip(h.parse::<f32>().ok()).map(|(w, h)| w / h),
        None => text.parse().ok(),
    };
    let fits = parsed.filter(|v| (0.2..=5.0).contains(v));
    fits.ok_or_else(|| "expected a ratio from 0.2 to 5 such as 4:3 or 1.5".into())
}

/// From, to, and how many at a time.
#[derive(Clone, Copy, Debug)]
struct Steps(usize, usize, usize);

fn steps(text: &str) -> Result<Steps, String> {
    let numbers: Option<Vec<usize>> = text.split("..").map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[from, to]) if from <= to => Ok(Steps(from, to, 1)),
        Some(&[from, to, stride]) if from <= to && stride > 0 => Ok(Steps(from, to, stride)),
        _ => Err("expected steps such as 0..40 or 0..400..10".into()),
    }
}

impl Snapshot {
    /// That nothing of this form is given without its scene.
    pub fn refuse_lone(&self) -> Result<(), CliError> {
        if self.scene.is_none() && (self.view.is_asked() || self.view.image().is_some()) {
            return Err(CliError::words("--scene", "needed with views, but not given")
                .with_help("built-in figures choose their views themselves"));
        }
        Ok(())
    }
}

pub(super) fn run(args: &Snapshot, source: &str, files: &Files) -> Result<(), CliError> {
    let key = args.method.as_deref().unwrap_or_default();
    let settings = settings(&args.set)?;
    let filter = args.filter()?;
    let begin = match scene::open(source, &LoadOptions::default())? {
        Either::Flat(scene) => args.begin(&scene, key, &settings, Either::Flat, Either::Flat)?,
        Either::Solid(scene) => args.begin(&scene, key, &settings, Either::Solid, Either::Solid)?,
    };
    let bar = Bar::new();
    let mut state = State::new();
    (state.method, state.settings) = (key.to_owned(), settings);
    args.stage(&mut state, begin, &bar)?;
    let aspect = args.aspect.unwrap_or_else(|| state.fitting_aspect());
    state.observer = state.framing(aspect);
    for command in args.commands.iter().filter(|c| !c.starts_with("frame:")) {
        state.speak(command).map_err(|why| CliError::words(format!("--do {command}"), why))?;
    }
    let steps = args.steps_of(&state, filter.as_ref())?;
    let pictures = args.pictures(&state);
    files.prepare()?;
    let shown = state.own_picture;
    let digits = steps.last().map_or(1, |last| last.to_string().len());
    let wanted = steps.iter().flat_map(|step| pictures.iter().map(move |picture| (*step, *picture)));
    let all = steps.len() * pictures.len();
    for (i, (step, picture)) in wanted.enumerate() {
        bar.report(i as f32 / all as f32, "making figures");
        state.apply(Command::GoTo(step));
        state.own_picture = if let Picture::Own(which) = picture { which } else { shown };
        let export = Export {
            picture,
            paper: args.paper.paper(),
            theme: files.theme(),
            outline_text: files.outline_text(),
            aspect,
            is_vector: args.vectors,
        };
        for format in files.formats() {
            if bar.cancelled() {
                return Err(CliError::Interrupted);
            }
            let path = files.path(&state.figure_name(&export, digits), format);
            let bytes = state.figure_file(&export, format, &path.to_string_lossy());
            write(&path, &bytes.map_err(|why| CliError::work(path.display().to_string(), why))?)?;
        }
    }
    Ok(())
}

/// What the explorer begins with.
struct Begin {
    opened: AnyOpened,
    /// The Eye, where it is no view of a path.
    eye: Option<AnyView>,
    /// The path that is followed, by name.
    path: Option<String>,
}

impl Snapshot {
    /// The filter of the step that is wanted.
    fn filter(&self) -> Result<Option<Filter>, CliError> {
        let hidden = format!("verdict:{}", Verdict::Hidden.name());
        let text = self.filter.as_deref().or(self.first_hidden.then_some(hidden.as_str()));
        let parsed = text.map(Filter::parse).transpose();
        let filter = parsed.map_err(|why| CliError::words("--where", why.to_string()))?;
        match &filter {
            Some(filter) if filter.is_empty() => {
                Err(CliError::words("--where", "an empty filter names no step").with_help("give --step N"))
            }
            _ => Ok(filter),
        }
    }

    /// Checks the words before the work.
    fn begin<S: World>(
        &self,
        scene: &Arc<Scene<S>>,
        key: &str,
        settings: &Settings,
        wrap: fn(Opened<S>) -> AnyOpened,
        look: fn(View<S>) -> AnyView,
    ) -> Result<Begin, CliError> {
        let entry = find::<S>(key)?;
        refuse_clock(&entry.knobs(settings)?)?;
        let own: Vec<String> = entry.pictures().iter().map(|name| word(name)).collect();
        let known: Vec<&str> =
            SHARED.into_iter().chain(own.iter().map(String::as_str)).chain([ALL]).collect();
        if let Some(name) = self.picture.iter().find(|name| !known.contains(&word(name).as_str())) {
            return Err(CliError::words("--picture", format!("`{key}` has no picture `{name}`"))
                .with_help(suggest::help(name, &known, "pictures")));
        }
        let (views, eye, path) = match self.view.asked(scene)? {
            Asked::Nothing => (None, None, None),
            Asked::Path(views) => (Some(views), None, None),
            Asked::Named(name) => (None, None, Some(name)),
            Asked::Single(view) => (None, Some(look(view)), None),
        };
        Ok(Begin { opened: wrap((scene.clone(), views)), eye, path })
    }

    /// Puts the scene on stage, chooses the view, and records.
    fn stage(&self, state: &mut State, begin: Begin, bar: &Bar) -> Result<(), CliError> {
        state.put(begin.opened);
        let named = |name: String| {
            let at = state.staged()?.paths().iter().position(|(path, _)| *path == name)?;
            Some(format!("frame:{at}:0"))
        };
        let path = begin.path.and_then(named);
        for command in path.iter().chain(self.commands.iter().filter(|c| c.starts_with("frame:"))) {
            state.order(command).map_err(|why| CliError::words(format!("--do {command}"), why))?;
        }
        let sized = self.view.image().and_then(|size| state.stage.as_ref().map(|s| s.sized(size)));
        if let Some(eye) = begin.eye.or(sized) {
            state.see_from(&eye);
        }
        wait(state, bar)?;
        match (state.film(), state.notices.iter().rev().find(|n| n.is_error)) {
            (Some(_), _) => Ok(()),
            (None, Some(notice)) => Err(CliError::work(state.method.as_str(), notice.text.as_str())),
            (None, None) => Err(CliError::work(state.method.as_str(), "nothing was recorded")),
        }
    }

    /// The steps that are wanted, of a film that is there.
    fn steps_of(&self, state: &State, filter: Option<&Filter>) -> Result<Vec<usize>, CliError> {
        let last = state.len();
        let Steps(from, to, stride) = match (self.step, self.steps) {
            (Some(step), _) => Steps(step, step, 1),
            (None, Some(steps)) => steps,
            (None, None) => Steps(last, last, 1),
        };
        if to > last {
            let option = if self.step.is_some() { "--step" } else { "--steps" };
            let run = format!("the run has {0} steps: 0 to {0}", count(last));
            return Err(CliError::words(format!("{option} {to}"), run));
        }
        let (Some(filter), Some(stage), Some(film)) = (filter, state.staged(), state.film()) else {
            return Ok((from..=to).step_by(stride).collect());
        };
        let applied = filter.on(stage.scene(), film);
        (0..last).find(|&at| applied.passes(at)).map(|at| vec![at + 1]).ok_or_else(|| {
            let option = if self.first_hidden { "--first-hidden" } else { "--where" };
            let counts = film.stamps.counts(last);
            let mut there: Vec<String> = Counts::VERDICTS
                .into_iter()
                .filter(|v| counts.of(*v) > 0)
                .map(|v| format!("verdict:{}", v.name()))
                .collect();
            let kinds: BTreeSet<&str> = (0..last).map(|at| film.reel.kind(at)).collect();
            there.extend(kinds.into_iter().map(|kind| format!("kind:{kind}")));
            CliError::words(option, format!("none of the {} steps passes", count(last)))
                .with_help(format!("in this run there are {}", there.join(", ")))
        })
    }

    /// The pictures that are wanted, each once.
    fn pictures(&self, state: &State) -> Vec<Picture> {
        let is_wanted = |name: &str| self.picture.iter().any(|w| word(w) == name || word(w) == ALL);
        state.pictures().into_iter().filter(|(_, name)| is_wanted(name)).map(|(p, _)| p).collect()
    }
}
