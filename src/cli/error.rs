//! Why a command failed, how it is said, and the exit status.

use std::io;

use crate::method::SettingError;
use crate::scene::SceneError;

/// Why a command failed. Displays as `WHAT: WHY`.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The words of the call are off.
    #[error("{what}: {why}")]
    Words {
        /// The option or argument.
        what: String,
        /// What is wrong with it.
        why: String,
        /// What to do instead.
        help: Option<String>,
    },
    /// The work failed.
    #[error("{what}: {why}")]
    Work {
        /// The file or the thing.
        what: String,
        /// What went wrong.
        why: String,
        /// What to do about it.
        help: Option<String>,
    },
    /// A scene or view file was refused.
    #[error(transparent)]
    Scene(SceneError),
    /// Ctrl-C.
    #[error("interrupted: stopped as asked, no file was written")]
    Interrupted,
    /// Whoever read standard output has gone; not worth a word.
    #[error("standard output: closed")]
    Closed,
}

impl CliError {
    /// The words of the call are off.
    pub(super) fn words(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Words { what: what.into(), why: why.into(), help: None }
    }
    /// The work failed.
    pub(super) fn work(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Work { what: what.into(), why: why.into(), help: None }
    }
    /// The same with a line of help.
    pub(super) fn with_help(mut self, text: impl Into<String>) -> Self {
        if let Self::Words { help, .. } | Self::Work { help, .. } = &mut self {
            *help = Some(text.into());
        }
        self
    }
    /// Standard output or a file could not be written.
    pub(super) fn write(what: &str, why: &io::Error) -> Self {
        if why.kind() == io::ErrorKind::BrokenPipe { Self::Closed } else { Self::work(what, reason(why)) }
    }
    /// Exit status: 0 if nothing needs to be said, 1 the work failed, 2 the words are off.
    pub fn status(&self) -> u8 {
        match self {
            Self::Words { .. } => 2,
            Self::Closed => 0,
            _ => 1,
        }
    }
    /// One line that says what to do about it.
    pub fn help(&self) -> Option<&str> {
        match self {
            Self::Words { help, .. } | Self::Work { help, .. } => help.as_deref(),
            _ => None,
        }
    }
    /// The whole message for standard error: one line, or two with the help.
    pub fn message(&self) -> String {
        let one_line =
            |text: &str| text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
        let mut text = format!("error: {}\n", one_line(&self.to_string()));
        if let Some(help) = self.help() {
            text += &format!("help: {}\n", one_line(help));
        }
        text
    }
}

/// The system's reason without its number.
pub(super) fn reason(why: &io::Error) -> String {
    let text = why.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled(_) => Self::Interrupted,
            other => Self::Scene(other),
        }
    }
}

impl From<SettingError> for CliError {
    fn from(error: SettingError) -> Self {
        let text = error.to_string();
        match error {
            SettingError::Unknown { method, key, known } => {
                let names: Vec<&str> = known.split(", ").collect();
                let help = super::suggest::help(&key, &names, "parameters");
                Self::words("--set", format!("`{method}` has no parameter `{key}`")).with_help(help)
            }
            _ => Self::words("--set", text),
        }
    }
}
