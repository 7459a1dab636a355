//! Waiting: a bar on a terminal once work takes over a second, and Ctrl-C.

use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::measure::Stopwatch;
use crate::scene::Progress;

/// Raised by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);
static LISTENING: Once = Once::new();
/// Work that takes no longer shows no bar.
const PATIENCE_MS: f64 = 1000.0;
/// Parts that the bar counts.
const PARTS: u64 = 1000;

/// A bar on standard error, if that is a terminal; and the flag that Ctrl-C raises.
pub(super) struct Bar {
    watch: Stopwatch,
    bar: Option<Mutex<Option<ProgressBar>>>,
}

impl Bar {
    /// Starts to wait and to listen for Ctrl-C. The first one asks the work to stop; a second one stops
    /// at once and takes unfinished files along.
    pub fn new() -> Self {
        LISTENING.call_once(|| {
            let handler = || {
                if STOP.swap(true, Ordering::Relaxed) {
                    crate::app::discard_unfinished();
                    std::process::exit(1);
                }
            };
            // Without a handler Ctrl-C ends the program at once, which is its own kind of stop.
            let _ = ctrlc::set_handler(handler);
        });
        Self { watch: Stopwatch::start(), bar: io::stderr().is_terminal().then(Mutex::default) }
    }
}

impl Progress for Bar {
    fn report(&self, fraction: f32, what: &'static str) {
        let Some(bar) = &self.bar else { return };
        if self.watch.elapsed_ms() < PATIENCE_MS {
            return;
        }
        let mut bar = bar.lock().unwrap_or_else(PoisonError::into_inner);
        let bar = bar.get_or_insert_with(|| {
            let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template(
                "{msg} [{bar:30}] {percent:>3} %  about {eta} left (Ctrl-C stops)",
            );
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
            bar
        });
        bar.set_message(what);
        bar.set_position((f64::from(fraction.clamp(0.0, 1.0)) * PARTS as f64) as u64);
    }
    fn cancelled(&self) -> bool {
        STOP.load(Ordering::Relaxed)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) =
            self.bar.take().and_then(|b| b.into_inner().unwrap_or_else(PoisonError::into_inner))
        {
            bar.finish_and_clear();
        }
    }
}
