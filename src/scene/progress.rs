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
