//! `cullscope figure --scene …`: what the explorer shows of a step as files, without its window.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use super::methods::{find, refuse_clock, settings};
use super::plates::{Files, write};
use super::progress::Bar;
use super::remake::wait;
use super::view::{Asked, ViewArgs};
use super::{CliError, World, output, scene, suggest};
use crate::app::{
    AnyOpened, AnyView, Command, Export, Filter, Form, Opened, Picture, RATE, SMALL_PT, Session, Stage,
    State, Steps, word,
};
use crate::drawing::words::count;
use crate::figure::Paper;
use crate::geometry::{Either, View, each};
use crate::method::{Settings, Verdict};
use crate::render::{Animation, Format};
use crate::scene::{LoadOptions, Part, Progress, Scene};
use crate::trace::Counts;

/// Words of pictures that every method has, and of all that there are.
const SHARED: [&str; 3] = ["observer", "eye", "pseudocode"];
const ALL: &str = "all";
/// In space only.
const TWIN: &str = "flatland-twin";

#[derive(clap::Args)]
#[command(next_help_heading = "A step of a run, as the explorer shows it")]
pub(super) struct Snapshot {
    /// A path to .obj, .gltf, .glb, .pdb, .xyz or a flatland .json, or generate:NAME[?key=value&…]; or a
    /// session, or a figure of ours, whose method, parameters and view then hold
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<String>,
    /// A method; `cullscope methods` lists them
    #[arg(long, short, value_name = "METHOD", requires = "scene")]
    method: Option<String>,
    /// A parameter of the method; may be given several times
    #[arg(long, value_name = "KEY=VALUE", requires = "scene")]
    set: Vec<String>,
    #[command(flatten)]
    shot: Shot,
    #[command(flatten)]
    view: ViewArgs,
}

/// Which steps, which pictures of them, and how they look.
#[derive(clap::Args)]
pub(super) struct Shot {
    /// After so many events
    #[arg(long, value_name = "N", group = "moment", requires = "scene")]
    step: Option<usize>,
    /// Steps from A to B, every Sth, a file each
    #[arg(long, value_name = "A..B[..S]", group = "moment", requires = "scene")]
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
    /// observer, eye, pseudocode, flatland-twin (of space: the level plane through the Eye, culled the same
    /// way), a picture of the method by name, or all; several with commas
    /// [default: observer]
    #[arg(long, value_name = "NAME", value_delimiter = ',', requires = "scene")]
    picture: Vec<String>,
    /// Several pictures or steps as one file
    #[arg(long = "as", value_enum, value_name = "FORM", requires = "scene")]
    form: Option<AsOne>,
    /// Steps a second of an animation [default: 10]
    #[arg(long, value_name = "N", requires = "form", value_parser = rate)]
    rate: Option<f32>,
    /// Size: column (84 mm, of a journal), page (175 mm), slide (16:9), or millimeters: 120 or 120x90
    /// [default: page]
    #[arg(long, value_name = "SIZE", requires = "scene")]
    paper: Option<Paper>,
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
}

/// How several pictures and steps are one file.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum AsOne {
    /// Beside each other on one page
    Page,
    /// Each step a page of a PDF file
    Pages,
    /// Each step a picture of an animated PNG file
    Animation,
}

fn rate(text: &str) -> Result<f32, String> {
    let (least, most) = (Animation::RATES.start(), Animation::RATES.end());
    let rate = text.parse().ok().filter(|rate| Animation::RATES.contains(rate));
    rate.ok_or_else(|| format!("expected {least} to {most} steps a second"))
}

fn ratio(text: &str) -> Result<f32, String> {
    let parsed = match text.split_once(':') {
        Some((w, h)) => w.parse::<f32>().ok().zip(h.parse::<f32>().ok()).map(|(w, h)| w / h),
        None => text.parse().ok(),
    };
    let fits = parsed.filter(|v| (0.2..=5.0).contains(v));
    fits.ok_or_else(|| "expected a ratio from 0.2 to 5 such as 4:3 or 1.5".into())
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
    let bar = Bar::new();
    let mut state = State::new();
    let filter = args.shot.filter()?;
    if is_kept(source) {
        args.reopen(&mut state, source, &bar)?;
        return args.shot.write(&mut state, filter.as_ref(), files, &bar);
    }
    let Some(key) = args.method.as_deref() else {
        return Err(
            CliError::words("--method", "needed, but not given").with_help("`cullscope methods` lists them")
        );
    };
    let settings = settings(&args.set)?;
    let begin = match scene::open(source, &LoadOptions::default())? {
        Either::Flat(scene) => args.begin(&scene, key, &settings, Either::Flat, Either::Flat)?,
        Either::Solid(scene) => args.begin(&scene, key, &settings, Either::Solid, Either::Solid)?,
    };
    (state.method, state.settings) = (key.to_owned(), settings);
    args.shot.stage(&mut state, begin, args.view.image(), &bar)?;
    args.shot.write(&mut state, filter.as_ref(), files, &bar)
}

/// Whether a source is something that the explorer wrote: a session, or a figure.
fn is_kept(source: &str) -> bool {
    Session::is_named(source) || {
        let ending = Path::new(source).extension().map(|e| e.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| ending.parse::<Format>().is_ok())
    }
}

/// What the explorer begins with.
pub(super) struct Begin {
    pub opened: AnyOpened,
    /// The Eye, where it is no view of a path.
    pub eye: Option<AnyView>,
    /// The path that is followed, by name.
    pub path: Option<String>,
    /// The view of a path.
    pub frame: usize,
}

impl Snapshot {
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
        let twin = (S::CORNERS == 3).then_some(TWIN);
        let known: Vec<&str> =
            SHARED.into_iter().chain(twin).chain(own.iter().map(String::as_str)).chain([ALL]).collect();
        self.shot.refuse_unknown(&known, key)?;
        let (views, eye, path) = match self.view.asked(scene)? {
            Asked::Nothing => (None, None, None),
            Asked::Path(views) => (Some(views), None, None),
            Asked::Named(name) => (None, None, Some(name)),
            Asked::Single(view) => (None, Some(look(view)), None),
        };
        Ok(Begin { opened: wrap((scene.clone(), views)), eye, path, frame: 0 })
    }

    /// Opens something that the explorer wrote, with another method or other parameters if they are given.
    fn reopen(&self, state: &mut State, source: &str, bar: &Bar) -> Result<(), CliError> {
        if self.view.is_asked() || self.view.image().is_some() {
            return Err(CliError::words("--scene", format!("{source} has a view of its own"))
                .with_help("leave out the options of views, or give the scene itself"));
        }
        state.apply(Command::Open(source.to_owned()));
        recorded(state, source, bar)?;
        if let (Some(key), Some(stage)) = (&self.method, &state.stage) {
            each!(stage, s => known(s, key))?;
            state.apply(Command::Method(key.clone()));
        }
        for (name, value) in settings(&self.set)?.0 {
            state.apply(Command::Set(name, value, 0));
        }
        let (method, settings) = (state.method.clone(), state.settings.clone());
        if let Some(stage) = &state.stage {
            each!(stage, s => timeless(s, &method, &settings))?;
        }
        recorded(state, &method, bar)
    }
}

fn known<S: World>(_: &Stage<S>, key: &str) -> Result<(), CliError> {
    find::<S>(key).map(|_| ())
}

fn timeless<S: World>(_: &Stage<S>, key: &str, settings: &Settings) -> Result<(), CliError> {
    refuse_clock(&find::<S>(key)?.knobs(settings)?)
}

/// Waits for a film.
fn recorded(state: &mut State, what: &str, bar: &Bar) -> Result<(), CliError> {
    wait(state, bar)?;
    match (state.film(), state.notices.iter().rev().find(|n| n.is_error)) {
        (Some(_), None) => Ok(()),
        (_, Some(notice)) => {
            // The line begins with what it is about.
            let why = notice.text.strip_prefix(&format!("{what}: ")).unwrap_or(&notice.text);
            Err(CliError::work(what, why))
        }
        (None, None) => Err(CliError::work(what, "nothing was recorded")),
    }
}

impl Shot {
    /// The filter of the step that is wanted.
    pub fn filter(&self) -> Result<Option<Filter>, CliError> {
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

    /// Puts the scene on stage, chooses the view, and records.
    pub fn stage(
        &self,
        state: &mut State,
        begin: Begin,
        size: Option<(u32, u32)>,
        bar: &Bar,
    ) -> Result<(), CliError> {
        state.put(begin.opened);
        let named = |name: String| {
            let at = state.staged()?.paths().iter().position(|(path, _)| *path == name)?;
            Some(format!("frame:{at}:0"))
        };
        let frame = (begin.frame > 0).then(|| format!("frame:0:{}", begin.frame));
        let path = begin.path.and_then(named).or(frame);
        for command in path.iter().chain(self.commands.iter().filter(|c| c.starts_with("frame:"))) {
            state.order(command).map_err(|why| CliError::words(format!("--do {command}"), why))?;
        }
        let sized = size.and_then(|size| state.stage.as_ref().map(|s| s.sized(size)));
        if let Some(eye) = begin.eye.or(sized) {
            state.see_from(&eye);
        }
        let method = state.method.clone();
        recorded(state, &method, bar)?;
        state.observer = state.framing(self.aspect.unwrap_or_else(|| state.fitting_aspect()));
        Ok(())
    }

    /// Writes the figures of a film that is there.
    pub fn write(
        &self,
        state: &mut State,
        filter: Option<&Filter>,
        files: &Files,
        bar: &Bar,
    ) -> Result<(), CliError> {
        for command in self.commands.iter().filter(|c| !c.starts_with("frame:")) {
            state.speak(command).map_err(|why| CliError::words(format!("--do {command}"), why))?;
        }
        let export = self.export(state, files)?;
        let formats = files.formats(match export.form {
            Form::Page => Format::Svg,
            Form::Pages => Format::Pdf,
            Form::Animation(_) => Format::Png,
        });
        if let Some(why) = formats.iter().find_map(|format| export.fits(*format).err()) {
            return Err(CliError::words("--format", why));
        }
        let (steps, exports) = match self.form {
            Some(_) => (vec![self.steps_of(state, filter)?[0]], vec![export]),
            None => {
                let alone = |picture: &Picture| Export { pictures: vec![*picture], ..export.clone() };
                (self.steps_of(state, filter)?, export.shown().iter().map(alone).collect())
            }
        };
        files.prepare()?;
        let digits = steps.last().map_or(1, |last| last.to_string().len());
        let all = steps.len() * exports.len() * formats.len();
        for (i, step) in steps.iter().enumerate() {
            state.apply(Command::GoTo(*step));
            for (j, export) in exports.iter().enumerate() {
                for (k, format) in formats.iter().enumerate() {
                    let path = files.path(&state.figure_name(export, digits), *format);
                    let done = ((i * exports.len() + j) * formats.len() + k) as f32 / all as f32;
                    let part = Part::of(bar, (done * all as f32) as usize, all);
                    write(&path, &made(state, export, *format, &path, &part)?)?;
                }
            }
        }
        Ok(())
    }

    /// How the figures are made: of something that was reopened as it was, but for what is given.
    fn export(&self, state: &State, files: &Files) -> Result<Export, CliError> {
        let kept = &state.exporting;
        let pictures = if self.picture.is_empty() { kept.shown().to_vec() } else { self.pictures(state)? };
        let is_new = self.form.is_some() || !self.picture.is_empty() || self.is_moment();
        Ok(Export {
            pictures,
            steps: if is_new { self.steps.filter(|_| self.form.is_some()) } else { kept.steps },
            form: match self.form {
                Some(AsOne::Page) => Form::Page,
                Some(AsOne::Pages) => Form::Pages,
                Some(AsOne::Animation) => Form::Animation(self.rate.unwrap_or(RATE)),
                None if is_new => Form::Page,
                None => kept.form,
            },
            paper: self.paper.unwrap_or(kept.paper),
            theme: files.theme().unwrap_or(kept.theme),
            outline_text: files.outline_text(),
            aspect: self.aspect.or(kept.aspect),
            is_vector: self.vectors || kept.is_vector,
        })
    }

    /// Whether a step is asked for.
    fn is_moment(&self) -> bool {
        self.step.is_some() || self.steps.is_some() || self.last || self.first_hidden || self.filter.is_some()
    }

    /// The steps that are wanted, of a film that is there.
    fn steps_of(&self, state: &State, filter: Option<&Filter>) -> Result<Vec<usize>, CliError> {
        let last = state.len();
        let one = |step: usize| Steps { from: step, to: step, stride: 1 };
        let steps = match (self.step, self.steps) {
            (Some(step), _) => one(step),
            (None, Some(steps)) => steps,
            // Of something that was reopened the step that it shows.
            (None, None) if !self.last && filter.is_none() && state.step > 0 => one(state.step),
            (None, None) => one(last),
        };
        let to = steps.to;
        if to > last {
            let option = if self.step.is_some() { "--step" } else { "--steps" };
            let run = format!("the run has {0} steps: 0 to {0}", count(last));
            return Err(CliError::words(format!("{option} {to}"), run));
        }
        let (Some(filter), Some(stage), Some(film)) = (filter, state.staged(), state.film()) else {
            return Ok(steps.all().collect());
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

    /// The pictures that are wanted, each once, in the order of menus.
    fn pictures(&self, state: &State) -> Result<Vec<Picture>, CliError> {
        let there = state.pictures();
        let known: Vec<&str> = there.iter().map(|(_, name)| name.as_str()).chain([ALL]).collect();
        self.refuse_unknown(&known, &state.method)?;
        // The twin is another run.
        let is_wanted =
            |name: &str| self.picture.iter().any(|w| word(w) == name || word(w) == ALL && name != TWIN);
        Ok(there.iter().filter(|(_, name)| is_wanted(name)).map(|(p, _)| *p).collect())
    }

    fn refuse_unknown(&self, known: &[&str], method: &str) -> Result<(), CliError> {
        match self.picture.iter().find(|name| !known.contains(&word(name).as_str())) {
            None => Ok(()),
            Some(name) => Err(CliError::words("--picture", format!("`{method}` has no picture `{name}`"))
                .with_help(suggest::help(name, known, "pictures"))),
        }
    }
}

/// The bytes of a figure, part by part.
fn made(
    state: &mut State,
    export: &Export,
    format: Format,
    path: &Path,
    progress: &dyn Progress,
) -> Result<Vec<u8>, CliError> {
    let name = path.to_string_lossy();
    let failed = |why: String| CliError::work(name.as_ref(), why);
    let recipe = state.recipe(export, format, &name);
    let mut making = state.begin(export, format, &recipe).map_err(failed)?;
    loop {
        progress.report(making.fraction(), "making figures");
        if progress.cancelled() {
            return Err(CliError::Interrupted);
        }
        if let Some(bytes) = state.go_on(&mut making).map_err(failed)? {
            let least = making.least_letters_pt();
            if least < SMALL_PT {
                let help = "a larger --paper, or fewer pictures on a page, suit it";
                output::say(&format!("note: {name}: its smallest letters are {least:.1} pt; {help}"));
            }
            return Ok(bytes);
        }
    }
}
