//! Usage errors in one line: what was given, and what is allowed.

use std::process::ExitCode;

use crate::invalid::Invalid;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Prints help and version as they are, an error of `program` in one line;
/// `commands` are the ones it has.
pub fn report(program: &str, commands: &[&str], error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // A reader that closes the pipe early is no error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    eprintln!("error: {}", line(program, commands, error));
    ExitCode::from(super::USAGE)
}

fn line(program: &str, commands: &[&str], error: &clap::Error) -> String {
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
            format!("unknown argument '{given}'{nearest} allowed: see '{program} --help'")
        }
        ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let all = commands.join(", ");
            format!("command: none given; allowed: {all}; see '{program} --help'")
        }
        ErrorKind::InvalidSubcommand => {
            let given = context(ContextKind::InvalidSubcommand).unwrap_or_default();
            Invalid::name("command", &given, commands).to_string()
        }
        ErrorKind::ValueValidation | ErrorKind::InvalidValue if !value.is_empty() => {
            match std::error::Error::source(error) {
                Some(source) => format!("{given}: '{value}'; allowed: {source}"),
                None => format!("{given}: '{value}'; see '{program} --help'"),
            }
        }
        ErrorKind::InvalidValue => {
            format!("{given}: a value is missing; allowed: see '{program} --help'")
        }
        ErrorKind::MissingRequiredArgument => {
            format!("missing argument: {given}; allowed: see '{program} --help'")
        }
        ErrorKind::ArgumentConflict => format!("{given}: given more than once; allowed: once"),
        _ => error
            .to_string()
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" "),
    }
}
