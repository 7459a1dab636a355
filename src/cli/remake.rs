//! `cullscope figure --check`: makes every figure in a folder again, from what it carries.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::error::reason;
use super::plates::Plate;
use super::progress::Bar;
use super::{CliError, output};
use crate::app::{Action, Session, State, recipe_in};
use crate::papers;
use crate::render::{Format, Theme};
use crate::scene::Progress;

/// Time between two looks at how far the work is.
const REST: Duration = Duration::from_millis(5);
/// How a recipe of a built-in figure begins.
const BUILT_IN: &str = "cullscope figure ";

/// What became of a figure.
enum Found {
    Same,
    /// Made again, it has other bytes.
    Differs,
    /// It could not be read or made again.
    Failed(String),
    /// It is none of ours, or one that another command makes.
    Left(String),
}

pub(super) fn run(folder: &Path) -> Result<(), CliError> {
    let bar = Bar::new();
    let files = figures(folder)?;
    let (mut same, mut wrong, mut left) = (0, 0, 0);
    for (i, (path, format)) in files.iter().enumerate() {
        bar.report(i as f32 / files.len() as f32, "making figures again");
        let said = match made_again(path, *format, &bar)? {
            Found::Same => {
                same += 1;
                continue;
            }
            Found::Differs => {
                wrong += 1;
                "differs from what is made now".to_owned()
            }
            Found::Failed(why) => {
                wrong += 1;
                why
            }
            Found::Left(why) => {
                left += 1;
                format!("not checked: {why}")
            }
        };
        output::print(format!("{}: {said}\n", path.display()).as_bytes())?;
    }
    let made = files.len() - left;
    output::print(format!("{same} of {made} figures are made again as they are\n").as_bytes())?;
    if wrong == 0 {
        return Ok(());
    }
    Err(CliError::work(folder.display().to_string(), format!("{wrong} figures are not what is made now"))
        .with_help("their text has the command that makes them again"))
}

/// The files of a folder that may be figures, by name.
fn figures(folder: &Path) -> Result<Vec<(PathBuf, Format)>, CliError> {
    let failed = |e| CliError::work(folder.display().to_string(), reason(&e));
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if let Some(format) = ending.parse().ok().filter(|_| path.is_file()) {
            found.push((path, format));
        }
    }
    found.sort();
    if found.is_empty() {
        return Err(CliError::work(folder.display().to_string(), "there is no .svg, .pdf or .png in it"));
    }
    Ok(found)
}

fn made_again(path: &Path, format: Format, bar: &Bar) -> Result<Found, CliError> {
    let name = path.to_string_lossy();
    let (recipe, bytes) = match recipe_in(&name) {
        Ok(Some(carried)) => carried,
        Ok(None) => return Ok(Found::Left("it was made by another program".into())),
        // The line begins with the file.
        Err(why) => {
            let text = why.to_string();
            let why = text.strip_prefix(&format!("{name}: ")).unwrap_or(&text).to_owned();
            return Ok(Found::Failed(why));
        }
    };
    let again = if let Some(words) = recipe.strip_prefix(BUILT_IN) {
        match built_in(words, format) {
            Ok(again) => again,
            Err(why) => return Ok(Found::Failed(why)),
        }
    } else if let Some(words) = recipe.strip_prefix("cullscope ") {
        let command = words.split(' ').next().unwrap_or_default();
        return Ok(Found::Left(format!("`cullscope {command}` made it")));
    } else {
        match from_session(&recipe, &name, format, bar)? {
            Ok(again) => again,
            Err(why) => return Ok(Found::Failed(why)),
        }
    };
    Ok(if again == bytes { Found::Same } else { Found::Differs })
}

/// A built-in figure by the words of its recipe.
fn built_in(words: &str, format: Format) -> Result<Vec<u8>, String> {
    let words: Vec<&str> = words.split_whitespace().collect();
    let name = words.first().copied().unwrap_or_default();
    let after = |option: &str| words.iter().position(|w| *w == option).and_then(|at| words.get(at + 1));
    let figure = papers::figure(name).ok_or_else(|| format!("there is no figure `{name}` any more"))?;
    let theme = after("--theme").and_then(|word| Theme::ALL.into_iter().find(|t| t.name() == *word));
    let theme = theme.ok_or("its text names no theme")?;
    let plate = Plate { theme, outline_text: after("--text").is_some_and(|word| *word == "paths") };
    plate.built_in(figure, format).map_err(|e| e.to_string())
}

/// A figure of a step from the session that it carries; within, why it cannot be made.
fn from_session(
    recipe: &str,
    file: &str,
    format: Format,
    bar: &Bar,
) -> Result<Result<Vec<u8>, String>, CliError> {
    let Ok(session) = Session::parse(recipe, file) else {
        return Ok(Err("its text is no session that this program reads".into()));
    };
    let Some(made) = session.figure.clone() else {
        return Ok(Err("an earlier version made it, which did not write down how".into()));
    };
    let mut state = State::new();
    state.restore(session, Some(file));
    wait(&mut state, bar)?;
    // What is said of the scene, such as that it has changed, comes before anything is compared.
    if let Some(notice) = state.notices.first().filter(|_| state.film().is_none()) {
        return Ok(Err(notice.text.clone()));
    }
    let export = state.export_like(&made);
    Ok(export.and_then(|export| state.figure_with(&export, format, recipe)))
}

/// Waits for what is asked of the explorer.
pub(super) fn wait(state: &mut State, bar: &Bar) -> Result<(), CliError> {
    while let Some(busy) = state.busy() {
        bar.report(busy.fraction * 0.9, "recording");
        if bar.cancelled() {
            state.apply(Action::Cancel);
            return Err(CliError::Interrupted);
        }
        if !state.poll() {
            thread::sleep(REST);
        }
    }
    Ok(())
}
