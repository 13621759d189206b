//! What the readers of TOML and JSON complain about, in the words of a person who
//! wrote the file and not of the program's types.

use crate::invalid::Invalid;

/// The same complaint: an unknown name with the nearest known one, a value with what
/// is allowed. Anything else stays as it is.
pub fn reworded(message: &str) -> Invalid {
    let known = unknown_name(message)
        .or_else(|| wrong_type(message))
        .or_else(|| wrong_length(message));
    if let Some(error) = known {
        return error;
    }
    match quoted(message, "missing field ") {
        Some((key, _)) => Invalid::line(format_args!("missing key '{key}'")),
        None => Invalid::line(message),
    }
}

/// Whether the complaint is about the key itself, not about its value.
pub fn is_about_a_key(message: &str) -> bool {
    message.starts_with("unknown field ")
}

/// "unknown field `a`, expected one of `b`, `c`", the same of variants.
fn unknown_name(message: &str) -> Option<Invalid> {
    let key = quoted(message, "unknown field ");
    let (given, rest) = key.or_else(|| quoted(message, "unknown variant "))?;
    let known: Vec<_> = rest.split('`').skip(1).step_by(2).collect();
    if known.is_empty() {
        return None;
    }
    let error = Invalid::name("key", given, &known);
    match key {
        Some(_) => Some(error),
        // The place that comes before already says whose name it is.
        None => error.to_string().strip_prefix("key: ").map(Invalid::line),
    }
}

/// "invalid type: string "x", expected f64".
fn wrong_type(message: &str) -> Option<Invalid> {
    let rest = message
        .strip_prefix("invalid type: ")
        .or_else(|| message.strip_prefix("invalid value: "))?;
    let (value, expected) = rest.rsplit_once(", expected ")?;
    let allowed = match expected {
        "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0",
        "a boolean" => "true or false",
        "a string" => "text in quotes",
        "a sequence" => "a list",
        _ if expected.starts_with("struct ") => "a table",
        other => other,
    };
    Some(Invalid::line(format_args!("{value}; allowed: {allowed}")))
}

/// "invalid length 2, expected an array of length 3".
fn wrong_length(message: &str) -> Option<Invalid> {
    let rest = message.strip_prefix("invalid length ")?;
    let (count, allowed) = rest.split_once(", expected an array of length ")?;
    Some(Invalid::line(format_args!(
        "{count} values; allowed: {allowed}"
    )))
}

/// The name in backquotes behind `start`, and what follows it.
fn quoted<'a>(message: &'a str, start: &str) -> Option<(&'a str, &'a str)> {
    message
        .strip_prefix(start)?
        .strip_prefix('`')?
        .split_once('`')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complaints_say_what_is_allowed() {
        for (from, to) in [
            (
                "unknown field `duraton_s`, expected one of `duration_s`, `cycle_ms`",
                "key: unknown 'duraton_s', did you mean 'duration_s'? allowed: duration_s, cycle_ms",
            ),
            (
                "unknown variant `xq`, expected `xy` or `yz`",
                "unknown 'xq', did you mean 'xy'? allowed: xy, yz",
            ),
            (
                "invalid type: string \"a, expected b\", expected f64",
                "string \"a, expected b\"; allowed: a number",
            ),
            (
                "invalid value: integer `-1`, expected usize",
                "integer `-1`; allowed: a whole number from 0",
            ),
            (
                "invalid length 2, expected an array of length 3",
                "2 values; allowed: 3",
            ),
            ("missing field `robot`", "missing key 'robot'"),
            ("6 values; allowed: 7", "6 values; allowed: 7"),
        ] {
            assert_eq!(reworded(from).to_string(), to);
        }
    }
}
