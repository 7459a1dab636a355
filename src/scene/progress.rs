//! How long work tells how far it is, and learns that nobody wants it any more.

/// Told by loading, building and every other work that a person may wait for; asked often enough
/// that cancelling takes effect within about a tenth of a second.
pub trait Progress: Sync {
    /// `fraction` of the work is done (0 to 1); `what` names the stage, such as `reading faces`.
    fn report(&self, fraction: f32, what: &'static str);
    /// Whether the work should stop.
    fn cancelled(&self) -> bool;
}

/// Nobody waits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Progress for Quiet {
    fn report(&self, _: f32, _: &'static str) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// A part of a longer work, as a progress of its own: its 0 to 1 is told as `start` to `start + length`.
pub struct Part<'a> {
    /// Who is told.
    pub whole: &'a dyn Progress,
    /// Fraction of the whole where this part begins.
    pub start: f32,
    /// Fraction of the whole that this part is.
    pub length: f32,
}

impl Progress for Part<'_> {
    fn report(&self, fraction: f32, what: &'static str) {
        self.whole.report(self.start + fraction.clamp(0.0, 1.0) * self.length, what);
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}
