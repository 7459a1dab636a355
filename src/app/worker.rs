//! The one worker thread: loads scenes, builds indexes and records films off the thread that draws.
//!
//! Every request gets a number. Asking again cancels what was asked before, and an answer whose
//! number is no longer wanted is dropped.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;

use super::any::AnyRecorded;
use super::command::Action;
use super::findings::Map;
use super::floor::floor_map;
use super::layers::{self, Layers, ToLayer};
use super::measured::{self, Measured};
use super::open;
use super::painted::judge;
use super::stage::Recorded;
use crate::culling::Methods;
use crate::geometry::{Either, Flat, Solid, View, ViewPath, each};
use crate::measure::Stopwatch;
use crate::measure::advise::{Advice, Wish, advise};
use crate::measure::deadline::Paced;
use crate::measure::stability::{Ask, stability};
use crate::measure::sweep::{Configuration, Line, Log, Spec, fly};
use crate::method::Settings;
use crate::raster::Drawable;
use crate::scene::{AnyScene, Motion, Part, Progress, Scene};
use crate::trace::{Moves, Stamps};

/// Events that a film keeps: 10 million, about 160 MB, before it is capped.
pub const FILM_CAP_EVENTS: usize = 10_000_000;

/// A film to record.
pub struct Request<S: Methods> {
    /// The scene as it was loaded.
    pub scene: Arc<Scene<S>>,
    /// Which scene on stage it is.
    pub scene_serial: u64,
    /// Key of the method.
    pub method: String,
    /// Its parameters.
    pub settings: Settings,
    /// Views of the path before this one, which a method may remember; the one to record sees the frame of
    /// what moves that is as many.
    pub before: Vec<View<S>>,
    /// The view to record.
    pub view: View<S>,
    /// Events to keep.
    pub cap: usize,
}

/// A scene, and the path that is flown through it or the views that it is looked at from.
type Flown<S> = (Arc<Scene<S>>, ViewPath<S>);
type Looked<S> = (Arc<Scene<S>>, Vec<View<S>>);

pub(super) enum Job {
    Load {
        wanted: open::Wanted,
        views: Option<String>,
    },
    Record(Either<Request<Flat>, Request<Solid>>),
    Measure {
        name: &'static str,
        scene: Option<AnyScene>,
        settings: Settings,
    },
    /// Measures configurations on a path, and tells each line as soon as it is known.
    Sweep {
        job: Either<Flown<Flat>, Flown<Solid>>,
        spec: Box<Spec>,
    },
    /// Looks for the simplest configuration that is right enough.
    Advise {
        job: Either<Looked<Flat>, Looked<Solid>>,
        wish: Wish,
    },
    /// Looks over the floor plan for what a method does wrong.
    Map {
        job: Either<Looked<Flat>, Looked<Solid>>,
        of: Configuration,
        frames: Vec<usize>,
    },
    /// Ranks what the film draws by layers, for someone who wants to go to one.
    Layer {
        film: Either<ToLayer<Flat>, ToLayer<Solid>>,
        action: Action,
    },
}

pub(super) enum Done {
    Loaded(open::AnyOpened),
    LoadFailed(String),
    Recorded(AnyRecorded),
    RecordFailed(String),
    Measured(Box<Measured>),
    Swept,
    Advised(Box<Advice>),
    Mapped(Box<Map>),
    Layered { layers: Result<Layers, String>, action: Action },
    Cancelled,
}

/// What is being waited for.
#[derive(Clone, Debug, PartialEq)]
pub struct Busy {
    /// Such as `reading faces`.
    pub what: String,
    /// 0 to 1.
    pub fraction: f32,
}

/// Between two times that progress is shown, at least.
const REST_MS: u32 = 100;

struct Shared {
    watch: Stopwatch,
    woken_ms: AtomicU32,
    /// The request that is wanted; all others are stale.
    wanted: AtomicU64,
    fraction: AtomicU32,
    what: Mutex<&'static str>,
    /// What a sweep found since it was last asked.
    news: Mutex<Vec<Line>>,
    wake: Mutex<Option<Box<dyn Fn() + Send + Sync>>>,
}

impl Shared {
    fn wake(&self) {
        if let Ok(wake) = self.wake.lock()
            && let Some(wake) = wake.as_ref()
        {
            wake();
        }
    }
}

struct Ticket {
    number: u64,
    shared: Arc<Shared>,
}

impl Progress for Ticket {
    fn report(&self, fraction: f32, what: &'static str) {
        self.shared.fraction.store(fraction.to_bits(), Ordering::Relaxed);
        if let Ok(mut now) = self.shared.what.lock() {
            *now = what;
        }
        // To draw the window takes time from the work.
        let now = self.shared.watch.elapsed_ms() as u32;
        if now.wrapping_sub(self.shared.woken_ms.load(Ordering::Relaxed)) >= REST_MS {
            self.shared.woken_ms.store(now, Ordering::Relaxed);
            self.shared.wake();
        }
    }
    fn cancelled(&self) -> bool {
        self.shared.wanted.load(Ordering::Relaxed) != self.number
    }
}

/// The thread and the way to it.
pub(super) struct Worker {
    jobs: Sender<(u64, Job)>,
    done: Receiver<(u64, Done)>,
    shared: Arc<Shared>,
    asked: u64,
    open: Option<String>,
}

impl Worker {
    pub(super) fn start() -> Self {
        let (jobs, inbox) = channel::<(u64, Job)>();
        let (outbox, done) = channel();
        let shared = Arc::new(Shared {
            watch: Stopwatch::start(),
            woken_ms: AtomicU32::new(0),
            wanted: AtomicU64::new(0),
            fraction: AtomicU32::new(0),
            what: Mutex::new(""),
            news: Mutex::default(),
            wake: Mutex::new(None),
        });
        let mine = shared.clone();
        thread::spawn(move || {
            let mut bench = Bench::default();
            for (number, job) in inbox {
                let ticket = Ticket { number, shared: mine.clone() };
                let answer = if ticket.cancelled() { Done::Cancelled } else { bench.guarded(job, &ticket) };
                if outbox.send((number, answer)).is_err() {
                    return;
                }
                mine.wake();
            }
        });
        Self { jobs, done, shared, asked: 0, open: None }
    }
    /// Called from the worker whenever there is something new to show.
    pub(super) fn set_wake(&self, wake: impl Fn() + Send + Sync + 'static) {
        if let Ok(mut slot) = self.shared.wake.lock() {
            *slot = Some(Box::new(wake));
        }
    }
    /// Asks for work; whatever was asked before is no longer wanted.
    pub(super) fn ask(&mut self, what: &str, job: Job) {
        self.asked += 1;
        self.shared.wanted.store(self.asked, Ordering::Relaxed);
        self.shared.fraction.store(0, Ordering::Relaxed);
        self.news();
        if let Ok(mut now) = self.shared.what.lock() {
            *now = "";
        }
        self.open = Some(what.to_owned());
        if self.jobs.send((self.asked, job)).is_err() {
            self.open = None;
        }
    }
    /// What a sweep found since the last time.
    pub(super) fn news(&self) -> Vec<Line> {
        self.shared.news.lock().map(|mut news| std::mem::take(&mut *news)).unwrap_or_default()
    }
    /// Nothing is wanted any more.
    pub(super) fn cancel(&mut self) {
        self.asked += 1;
        self.shared.wanted.store(self.asked, Ordering::Relaxed);
        self.open = None;
    }
    /// What is being waited for.
    pub(super) fn busy(&self) -> Option<Busy> {
        let open = self.open.as_ref()?;
        let stage = self.shared.what.lock().map_or("", |w| *w);
        let what = if stage.is_empty() { open.clone() } else { format!("{open}: {stage}") };
        Some(Busy { what, fraction: f32::from_bits(self.shared.fraction.load(Ordering::Relaxed)) })
    }
    /// The next wanted answer; with `wait`, blocks until it is there (if anything was asked).
    pub(super) fn answer(&mut self, wait: bool) -> Option<Done> {
        loop {
            let got = if wait && self.open.is_some() {
                self.done.recv().ok()?
            } else {
                self.done.try_recv().ok()?
            };
            // Answers to earlier requests are dropped.
            if got.0 == self.asked && self.open.is_some() {
                self.open = None;
                return Some(got.1);
            }
        }
    }
}

/// What the worker keeps between jobs: the built index of each space, so that a moved Eye is recorded at
/// once.
#[derive(Default)]
struct Bench {
    flat: Option<Ready<Flat>>,
    solid: Option<Ready<Solid>>,
    serial: u64,
}

struct Ready<S: Drawable> {
    scene_serial: u64,
    method: String,
    settings: Settings,
    motion: Motion<S>,
    run: Paced<S>,
    /// The views since it remembers, in the order of their frames.
    flown: Vec<View<S>>,
}

impl Bench {
    /// A fault in a method must not take the window down: it is reported like any other failure.
    fn guarded(&mut self, job: Job, ticket: &Ticket) -> Done {
        catch_unwind(AssertUnwindSafe(|| self.work(job, ticket))).unwrap_or_else(|_| {
            (self.flat, self.solid) = (None, None);
            Done::RecordFailed("the work stopped on an internal fault; what was on stage is unchanged".into())
        })
    }
    fn work(&mut self, job: Job, ticket: &Ticket) -> Done {
        match job {
            Job::Load { wanted, views } => match open::load(&wanted, views.as_deref(), ticket) {
                Ok(opened) => Done::Loaded(opened),
                Err(_) if ticket.cancelled() => Done::Cancelled,
                Err(error) => Done::LoadFailed(error),
            },
            Job::Measure { name, scene, settings } => {
                match measured::measure(name, scene, settings, ticket) {
                    Ok(measured) => Done::Measured(Box::new(measured)),
                    Err(_) if ticket.cancelled() => Done::Cancelled,
                    Err(error) => Done::RecordFailed(error),
                }
            }
            Job::Sweep { job, spec } => each!(job, flown => sweep(&flown, &spec, ticket)),
            Job::Advise { job, wish } => {
                let advice = each!(job, looked => advise(&looked.0, &looked.1, wish, ticket));
                match advice {
                    Ok(advice) => Done::Advised(Box::new(advice)),
                    Err(_) if ticket.cancelled() => Done::Cancelled,
                    Err(error) => Done::RecordFailed(error.to_string()),
                }
            }
            Job::Map { job, of, frames } => {
                match each!(job, looked => mapped(&looked, &of, frames, ticket)) {
                    Ok(map) => Done::Mapped(Box::new(map)),
                    Err(_) if ticket.cancelled() => Done::Cancelled,
                    Err(error) => Done::RecordFailed(error),
                }
            }
            Job::Layer { film, action } => match each!(film, f => layers::rank(&f, ticket)) {
                _ if ticket.cancelled() => Done::Cancelled,
                layers => Done::Layered { layers, action },
            },
            Job::Record(Either::Flat(request)) => {
                self.serial += 1;
                self.solid = None;
                record(&mut self.flat, request, self.serial, ticket, Either::Flat)
            }
            Job::Record(Either::Solid(request)) => {
                self.serial += 1;
                self.flat = None;
                record(&mut self.solid, request, self.serial, ticket, Either::Solid)
            }
        }
    }
}

/// Measures what a spec says, and tells each line of the result to whoever asked.
fn sweep<S: Methods + Drawable>((scene, path): &Flown<S>, spec: &Spec, ticket: &Ticket) -> Done {
    let all: Vec<usize> = (0..spec.configurations.len()).collect();
    let mut keep = |line: &Line| {
        if !ticket.cancelled()
            && let Ok(mut news) = ticket.shared.news.lock()
        {
            news.push(line.clone());
        }
        Ok(())
    };
    match fly((spec, 0), scene, path, &all, &mut Log::default(), &mut keep, ticket) {
        Ok(()) => Done::Swept,
        Err(_) if ticket.cancelled() => Done::Cancelled,
        Err(error) => Done::RecordFailed(error.to_string()),
    }
}

/// Cells of the grid over the floor plan along each axis, and flips that are looked into.
const GRID: usize = 20;
const FLIPS: usize = 3;

/// Looks over the floor plan, and along the path for flips.
fn mapped<S: Methods + Drawable>(
    (scene, views): &Looked<S>,
    of: &Configuration,
    frames: Vec<usize>,
    ticket: &Ticket,
) -> Result<Map, String> {
    let Some(method) = S::method(&of.method) else {
        return Err(format!("there is no method `{}` in {}", of.method, S::NAME));
    };
    let first = Motion::new(scene).at(0);
    let begun = Part { whole: ticket, start: 0.0, length: 0.2 };
    let run = method.ready(&first, &of.settings, &begun).map_err(|e| e.to_string())?;
    let mut run = run.ok_or("stopped as asked")?;
    let ask = Ask { grid: GRID, flips: FLIPS, ..Ask::default() };
    let rest = Part { whole: ticket, start: 0.2, length: 0.8 };
    let found = stability(scene, &mut *run, views, &ask, &rest).map_err(|e| e.to_string())?;
    let title = format!("{}: {}", scene.name(), of.label());
    let picture = floor_map(scene, title, &found, GRID);
    Ok(Map { of: of.clone(), frames, found, picture })
}

/// A run that was stopped while it changed is of no use.
fn gone<S: Drawable>(ready: &mut Option<Ready<S>>) -> Done {
    *ready = None;
    Done::Cancelled
}

/// Records a film, on the index that is ready if it still fits.
fn record<S: Methods + Drawable>(
    ready: &mut Option<Ready<S>>,
    request: Request<S>,
    serial: u64,
    ticket: &Ticket,
    wrap: fn(Recorded<S>) -> AnyRecorded,
) -> Done {
    let fits = |r: &Ready<S>| {
        r.scene_serial == request.scene_serial && r.method == request.method && r.settings == request.settings
    };
    if !ready.as_ref().is_some_and(fits) {
        *ready = None;
        let Some(method) = S::method(&request.method) else {
            return Done::RecordFailed(format!("there is no method `{}` in {}", request.method, S::NAME));
        };
        let mut motion = Motion::new(&request.scene);
        let first = motion.at(0);
        match method.ready(&first, &request.settings, ticket) {
            Err(error) => return Done::RecordFailed(error.to_string()),
            Ok(None) => return Done::Cancelled,
            Ok(Some(run)) => {
                let run = Paced::new(run, &first);
                *ready = Some(Ready {
                    scene_serial: request.scene_serial,
                    method: request.method,
                    settings: request.settings,
                    motion,
                    run,
                    flown: Vec::new(),
                });
            }
        }
    }
    let Some(Ready { run, motion, flown, .. }) = ready else { return Done::Cancelled };
    // A film does not depend on what was looked at before: the path's earlier views make the memory anew,
    // those that are not the last ones.
    ticket.report(0.5, "recording");
    if !request.before.starts_with(flown) {
        run.forget();
        flown.clear();
    }
    // The bar says that it records, whatever that takes.
    let still = Part { whole: ticket, start: 0.5, length: 0.3 };
    if run.remembers() {
        for (frame, view) in request.before.iter().enumerate().skip(flown.len()) {
            if ticket.cancelled() {
                return Done::Cancelled;
            }
            if !run.pose(&motion.at(frame), &still) {
                return gone(ready);
            }
            run.cull(view);
            flown.push(*view);
        }
    }
    if !run.pose(&motion.at(request.before.len()), &still) {
        return gone(ready);
    }
    let recording = run.record(&request.view, request.cap);
    flown.push(request.view);
    if ticket.cancelled() {
        return Done::Cancelled;
    }
    ticket.report(0.8, "reading the film");
    let stamps = Arc::new(Stamps::new(&*recording.film));
    let moves = Arc::new(Moves::new(recording.film.events()));
    ticket.report(0.9, "comparing with the truth");
    let truth = Arc::new(judge(&*recording.film, &recording.list));
    if ticket.cancelled() {
        return Done::Cancelled;
    }
    Done::Recorded(wrap(Recorded { film: recording.film, stamps, moves, serial, layers: None, truth }))
}
