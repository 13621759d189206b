//! Usage errors in one line: what was given, and what is allowed.

use std::process::ExitCode;

use crate::invalid::Invalid;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Prints help and version as they are, an error in one line.
pub fn report(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // A reader that closes the pipe early is no error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    eprintln!("error: {}", line(error));
    ExitCode::from(super::USAGE)
}

fn line(error: &clap::Error) -> String {
    let context = |kind| {
        error.get(kind).map(|value| match value {
            ContextValue::Strings(all) => all.join(", "),
            ContextValue::StyledStrs(all) => all
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join(", "),
            other => other.to_string(),
        })
    };
    let given = context(ContextKind::InvalidArg).unwrap_or_default();
    let value = context(ContextKind::InvalidValue).unwrap_or_default();
    let nearest = context(ContextKind::SuggestedArg)
        .map_or(";".into(), |name| format!(", did you mean '{name}'?"));
    match error.kind() {
        ErrorKind::UnknownArgument => {
            format!("unknown argument '{given}'{nearest} allowed: see 'hil-sim --help'")
        }
        ErrorKind::InvalidSubcommand => {
            let given = context(ContextKind::InvalidSubcommand).unwrap_or_default();
            Invalid::name("command", &given, super::COMMANDS).to_string()
        }
        ErrorKind::ValueValidation | ErrorKind::InvalidValue if !value.is_empty() => {
            match std::error::Error::source(error) {
                Some(source) => format!("{given}: '{value}'; allowed: {source}"),
                None => format!("{given}: '{value}'; see 'hil-sim --help'"),
            }
        }
        ErrorKind::InvalidValue => {
            format!("{given}: a value is missing; allowed: see 'hil-sim --help'")
        }
        ErrorKind::MissingRequiredArgument => {
            format!("missing argument: {given}; allowed: see 'hil-sim --help'")
        }
        ErrorKind::ArgumentConflict => format!("{given}: given more than once; allowed: once"),
        _ => error
            .to_string()
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" "),
    }
}
