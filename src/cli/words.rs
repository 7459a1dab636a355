//! Errors of the argument parser, said in the one-line form of all errors.

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

use super::CliError;
use super::output;

/// Help and version go to standard output; everything else becomes an error of status 2.
pub(super) fn explain(error: &Error) -> Result<(), CliError> {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return output::print(error.to_string().as_bytes());
    }
    let get = |kind| error.get(kind).map(flat).filter(|text| !text.is_empty());
    let argument = get(ContextKind::InvalidArg);
    let name = argument.as_deref().map_or("the call", |a| a.split([' ', '=']).next().unwrap_or(a)).to_owned();
    let value = get(ContextKind::InvalidValue).unwrap_or_default();
    let made = match error.kind() {
        ErrorKind::UnknownArgument => CliError::words(name, "there is no such option here"),
        ErrorKind::InvalidSubcommand => CliError::words(
            get(ContextKind::InvalidSubcommand).unwrap_or_default(),
            "there is no such command",
        ),
        ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            CliError::words("the call", "a command is missing")
        }
        ErrorKind::MissingRequiredArgument => {
            CliError::words(argument.unwrap_or_default(), "needed here, but not given")
        }
        ErrorKind::InvalidValue if value.is_empty() => CliError::words(name, "its value is missing"),
        ErrorKind::InvalidValue => {
            let valid = get(ContextKind::ValidValue).unwrap_or_default();
            CliError::words(name, format!("`{value}` is not one of {valid}"))
        }
        ErrorKind::ValueValidation => {
            let why = std::error::Error::source(error)
                .map_or_else(|| "does not fit".to_owned(), ToString::to_string);
            CliError::words(name, format!("`{value}`: {why}"))
        }
        ErrorKind::ArgumentConflict => {
            let other = get(ContextKind::PriorArg).unwrap_or_else(|| "another option".into());
            CliError::words(name, format!("cannot be used together with {other}"))
        }
        _ => {
            let text = error.to_string();
            let first = text.lines().next().unwrap_or("not understood").trim_start_matches("error: ");
            CliError::words(name, first)
        }
    };
    Err(match tip(error) {
        Some(tip) => made.with_help(tip),
        None => made,
    })
}

fn tip(error: &Error) -> Option<String> {
    let near = [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand, ContextKind::SuggestedValue];
    let near = near.iter().find_map(|k| error.get(*k)).map(flat).filter(|t| !t.is_empty());
    let usage = error.get(ContextKind::Usage).map(flat).filter(|t| !t.is_empty());
    near.map(|near| format!("did you mean `{near}`?"))
        .or_else(|| usage.map(|u| u.split_whitespace().collect::<Vec<_>>().join(" ")))
}

fn flat(value: &ContextValue) -> String {
    match value {
        ContextValue::String(text) => text.clone(),
        ContextValue::Strings(list) => list.join(", "),
        ContextValue::StyledStr(text) => text.to_string(),
        ContextValue::StyledStrs(list) => list.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "),
        ContextValue::Number(n) => n.to_string(),
        ContextValue::Bool(b) => b.to_string(),
        _ => String::new(),
    }
}
