//! How long work reports its progress and learns that it was cancelled.

/// The listener to loading, building and all other work that a person may wait for; called often enough that
/// cancelling takes effect within about a tenth of a second.
pub trait Progress: Sync {
    /// `fraction` of the work is done (0 to 1); `what` names the stage, such as `reading faces`.
    fn report(&self, fraction: f32, what: &'static str);
    /// Whether the work should stop.
    fn cancelled(&self) -> bool;
}

/// No listener: work is never cancelled.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Progress for Quiet {
    fn report(&self, _: f32, _: &'static str) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// A part of a longer work, as a progress of its own: its 0 to 1 is reported as `start` to `start + length`.
pub struct Part<'a> {
    /// The listener to the whole.
    pub whole: &'a dyn Progress,
    /// Fraction of the whole where this part begins.
    pub start: f32,
    /// Fraction of the whole that this part is.
    pub length: f32,
}

impl<'a> Part<'a> {
    /// Part `at` of `count` equal ones.
    pub fn of(whole: &'a dyn Progress, at: usize, count: usize) -> Self {
        let length = 1.0 / count.max(1) as f32;
        Self { whole, start: at as f32 * length, length }
    }
}

impl Progress for Part<'_> {
    fn report(&self, fraction: f32, what: &'static str) {
        self.whole.report(self.start + fraction.clamp(0.0, 1.0) * self.length, what);
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}
