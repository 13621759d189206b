//! Usage errors in one line: what was given, and what is allowed.

use std::process::ExitCode;

use crate::invalid::Invalid;
use crate::terminal::tell;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Exit code of anything that cannot be used.
pub const USAGE: u8 = 2;

/// Prints help and version as they are, an error of `program` in one line;
/// `commands` are the ones it has.
pub fn report(program: &str, commands: &[&str], error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // A reader that closes the pipe early is no error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    let arguments: Vec<_> = std::env::args_os()
        .skip(1)
        .map(|argument| argument.to_string_lossy().into_owned())
        .collect();
    let text = line(program, commands, &arguments, error);
    tell(format_args!("error: {}", Invalid::line(text)));
    ExitCode::from(USAGE)
}

fn line(program: &str, commands: &[&str], arguments: &[String], error: &clap::Error) -> String {
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
    let command = arguments
        .first()
        .filter(|first| commands.contains(&first.as_str()));
    let help = match command {
        Some(command) => format!("see '{program} {command} --help'"),
        None => format!("see '{program} --help'"),
    };
    let nearest = context(ContextKind::SuggestedArg)
        .map_or(";".into(), |name| format!(", did you mean '{name}'?"));
    match error.kind() {
        ErrorKind::UnknownArgument => {
            format!("unknown argument '{given}'{nearest} allowed: {help}")
        }
        ErrorKind::MissingSubcommand | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let all = commands.join(", ");
            format!("command: none given; allowed: {all}; {help}")
        }
        ErrorKind::InvalidSubcommand => {
            let given = context(ContextKind::InvalidSubcommand).unwrap_or_default();
            Invalid::name("command", &given, commands).to_string()
        }
        ErrorKind::InvalidValue if value.is_empty() => {
            format!("{given}: a value is missing; allowed: {help}")
        }
        ErrorKind::ValueValidation | ErrorKind::InvalidValue => {
            // An option comes with the name of its value: "--seed <SEED>".
            let given = given.split(' ').next().unwrap_or("");
            match std::error::Error::source(error) {
                Some(source) => format!("{given}: '{value}'; allowed: {source}"),
                None => format!("{given}: '{value}'; {help}"),
            }
        }
        ErrorKind::TooManyValues => format!("{given}: '{value}'; allowed: no value"),
        ErrorKind::MissingRequiredArgument => {
            format!("missing argument: {given}; allowed: {help}")
        }
        ErrorKind::ArgumentConflict => match context(ContextKind::PriorArg) {
            Some(other) if other != given => {
                format!("{given}: given with {other}; allowed: one of them")
            }
            _ => format!("{given}: given more than once; allowed: once"),
        },
        ErrorKind::InvalidUtf8 => {
            let mut marked = arguments.iter().filter(|text| text.contains('\u{fffd}'));
            let which = marked.next().map_or("", String::as_str);
            format!("argument: '{which}'; allowed: text in UTF-8")
        }
        _ => {
            let text = error.to_string();
            text.strip_prefix("error: ").unwrap_or(&text).to_string()
        }
    }
}
